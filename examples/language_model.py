"""Let a language model play through text: its view, its task, and the actions from which it chooses."""

import itertools
import re
from collections.abc import Callable

import jax

import home_mjx
from home_mjx.tasks.language import describe, detokenize

MAX_STEPS = 40
NEAR = 0.8  # [m]
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
    """Return a stand-in for a model: it goes to an object that the task names, else it looks around; call yours here.

    Like a model it knows nothing but the prompt.
    """
    turns = itertools.count(1)

    def reply(prompt: str) -> str:
        """Answer a prompt with the name of an action."""
        wanted = re.findall(r"Your task is to: (.*)\.", prompt)[-1].split()
        for name, distance, side in re.findall(r"([\w]+) \d+ \(([\d.]+) m, (\w+)\)", prompt):
            if name in wanted:
                near = "stop" if float(distance) < NEAR else "move_forward"
                return f"I {near if side == 'ahead' else f'turn_{side}'}."
        return "I move_forward." if next(turns) % 8 == 0 else "I turn_left."

    return reply


if __name__ == "__main__":
    house = home_mjx.make(
        "InstructionFollowing-v0", "procedural:2", sensors=("instruction",), impl="kinematic", num_tasks=4
    )
    print("success", play(house, make_stub(), jax.random.key(1)))
