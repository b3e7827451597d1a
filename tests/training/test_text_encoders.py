"""Embeddings that users bring: the network reads them, does not change them, and refuses wrong ones."""

import importlib.util
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

pytest.importorskip("flax", reason="needs the extra `train`")

from home_mjx.errors import ConfigError, UnknownNameError
from home_mjx.tasks.base.specs import ArraySpec
from home_mjx.tasks.language.vocabulary import all_words, tokenize
from home_mjx.training import NetworkConfig, RecurrentAgent, register_text_encoder
from home_mjx.training.networks.sensor_encoders import WordEncoder
from home_mjx.training.networks.text_encoders import word_table

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "own_text_encoder.py"
SPECS = {"instruction": ArraySpec((4,), "int32", 0, 32767), "goal_words": ArraySpec((3,), "int32", -1, 32767)}
MOVES = ArraySpec((), "int32", 0, 3)


@pytest.fixture(autouse=True)
def letters():
    """The example's encoder, registered."""
    spec = importlib.util.spec_from_file_location("own_text_encoder", EXAMPLE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    register_text_encoder("letters", module.embed_letters)
    return module.embed_letters


def apply(text_encoder: str, texts: tuple[str, ...]) -> np.ndarray:
    words = jnp.array([tokenize(text) for text in texts], jnp.int32)
    encoder = WordEncoder(blank=0, text_encoder=text_encoder)
    return np.asarray(encoder.apply(encoder.init(jax.random.key(0), words), words))


def test_the_network_sees_words_by_the_users_embeddings_alone():
    """Words of equal embeddings are the same to it, others are not; learned embeddings differ for any two words."""
    register_text_encoder("kinds", lambda words: np.array([[w in ("red", "blue"), 1.0] for w in words], np.float32))
    red, blue, chair = apply("kinds", ("red table", "blue table", "chair table"))
    assert np.array_equal(red, blue)
    assert not np.allclose(red, chair)
    assert not np.allclose(*apply("", ("red table", "blue table")))


def test_similar_words_are_similar_in_the_example(letters):
    """By the cosine of their rows: a common part counts."""
    table = letters(all_words())
    row = {word: table[i] / max(np.linalg.norm(table[i]), 1e-9) for i, word in enumerate(all_words())}
    assert row["living_room"] @ row["dining_room"] > 0.3 > abs(row["living_room"] @ row["chair"])
    assert np.array_equal(table, letters(all_words()))


def test_embeddings_are_no_parameters_and_other_ids_keep_their_own():
    agent = RecurrentAgent.from_specs(SPECS, MOVES, NetworkConfig(8, 8, (4,), text_encoder="letters"))
    net = agent.init_net(jax.random.key(0))["params"]["Encoder_0"]
    told, ids = net["WordEncoder_1"], net["WordEncoder_0"]
    assert told["projection"]["kernel"].shape == (64, 64)
    assert "Embed_0" not in told
    assert "Embed_0" in ids
    assert ids.keys() & {"projection"} == set()


def test_wrong_encoders_are_refused():
    network = NetworkConfig(8, 8, (4,), text_encoder="leters")
    with pytest.raises(UnknownNameError, match=r"Did you mean `letters`.*--import"):
        RecurrentAgent.from_specs(SPECS, MOVES, network)
    with pytest.raises(ConfigError, match="no observation has words"):
        RecurrentAgent.from_specs({"goal": ArraySpec((3,))}, MOVES, NetworkConfig(text_encoder="letters"))
    for name, result in (("short", np.zeros((3, 2))), ("nan", np.full((len(all_words()), 2), np.nan))):
        register_text_encoder(name, lambda words, result=result: result)
        with pytest.raises(ConfigError, match=f"text encoder `{name}` must return"):
            word_table(name)
    with pytest.raises(ConfigError, match="needs a name"):
        register_text_encoder("", len)
