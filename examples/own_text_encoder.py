"""Bring your own embeddings of words: here of their letters, in place of a language model's."""

import zlib
from collections.abc import Sequence

import jax
import numpy as np

import home_mjx
from home_mjx.training import PPO, NetworkConfig, PPOConfig, register_text_encoder

FEATURES = 64


def embed_letters(words: Sequence[str]) -> np.ndarray:
    """Return the mean of random vectors of each word's trigrams, so that words with a common part are similar.

    Call the encoder of your language model here. It is called once, with all words of the language.
    """
    table = np.zeros((len(words), FEATURES), np.float32)
    for row, word in enumerate(words):
        parts = [f"<{word}>"[i : i + 3] for i in range(len(word))]
        vectors = [np.random.default_rng(zlib.crc32(part.encode())).normal(size=FEATURES) for part in parts]
        table[row] = np.mean(vectors, axis=0) if vectors else 0.0
    return table


if __name__ == "__main__":
    home_mjx.use_compile_cache()
    register_text_encoder("letters", embed_letters)
    options = {"sensors": ("state", "instruction"), "impl": "kinematic", "num_tasks": 8}
    env = home_mjx.make("InstructionFollowing-v0", "procedural:1?preset=flat", **options)
    network = NetworkConfig(features=32, memory=32, text_encoder="letters")
    config = PPOConfig(num_envs=8, num_timesteps=1024, unroll_length=16, num_minibatches=1, network=network)
    ppo = PPO(env.core, config)
    state = ppo.init(env.params, jax.random.key(0))
    for update in range(1, config.num_updates + 1):
        state, metrics = ppo.update(env.params, state)
        print(f"{update * config.batch_size:5d} steps, entropy {float(metrics['loss/entropy']):.3f}")
