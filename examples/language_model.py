"""Let a language model play through text: its view, its task, and the actions from which it chooses."""

import itertools
from collections.abc import Callable

import jax

import home_mjx
from home_mjx.tasks.language import describe, detokenize

MAX_STEPS = 12
MAX_TRIES = 3  # replies without an action, after which the episode ends


def play(env: home_mjx.Env, model: Callable[[str], str], key: jax.Array) -> float:
    """Play one episode with a function from a prompt to a reply; return the success metric."""
    reset, step = jax.jit(env.reset), jax.jit(env.step)
    state, names, note = reset(key), env.core.action_names, ""
    for _ in range(MAX_STEPS):
        task = detokenize(state.obs["instruction"])
        seen = describe(env.core.snapshot(env.params, state))
        prompt = f"{note}{seen}\nYour task is to: {task}.\nActions: {', '.join(names)}.\n> "
        chosen = None
        for _ in range(MAX_TRIES):
            reply = model(prompt).strip().lower()
            chosen = next((i for i, name in enumerate(names) if name.lower() in reply), None)
            if chosen is not None:
                break
            prompt = f"Nothing happens.\n{prompt}"
        if chosen is None:
            break
        print(f"{prompt}{names[chosen]}\n")
        state = step(state, chosen)
        if bool(state.done):
            break
    return float(state.metrics["success"])


def make_stub() -> Callable[[str], str]:
    """Return a stand-in for a model: it walks, and turns every fourth step or close to an object; call yours here."""
    turns = itertools.count()

    def reply(prompt: str) -> str:
        """Answer a prompt with the name of an action."""
        is_clear = ", ahead)" not in prompt or " (0." not in prompt
        return "I move_forward." if is_clear and next(turns) % 4 else "I turn_left."

    return reply


if __name__ == "__main__":
    house = home_mjx.make(
        "InstructionFollowing-v0", "procedural:2", sensors=("instruction",), impl="kinematic", num_tasks=4
    )
    print("success", play(house, make_stub(), jax.random.key(1)))
