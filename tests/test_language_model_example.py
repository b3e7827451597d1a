"""The example in which a language model plays: its prompts, odd replies, and that words alone lead to success."""

import importlib.util
from pathlib import Path

import jax
import pytest

import home_mjx

EXAMPLE = Path(__file__).resolve().parents[1] / "examples" / "language_model.py"
PROMPT = "You are in the bedroom. You see {}.\nYour task is to: walk to the plant.\nActions: stop, turn_left.\n> "


@pytest.fixture(scope="module")
def example():
    spec = importlib.util.spec_from_file_location("language_model", EXAMPLE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    ("seen", "action"),
    [
        ("a green plant 169 (0.5 m, right)", "turn_right"),
        ("a red chair 7 (0.4 m, ahead) and a green plant 169 (2.5 m, left)", "turn_left"),
        ("a green plant 169 (2.5 m, ahead)", "move_forward"),
        ("a green plant 169 (0.5 m, ahead)", "stop"),
        ("a red chair 7 (0.4 m, ahead)", "turn_left"),
    ],
)
def test_the_stub_acts_on_the_text(example, seen: str, action: str):
    assert action in example.make_stub()(PROMPT.format(seen))


@pytest.mark.slow
def test_a_model_plays_by_words_alone(example, capsys: pytest.CaptureFixture):
    """The stub, that knows only the prompts, finds objects; replies without an action end an episode after a few."""
    options = {"sensors": ("instruction",), "impl": "kinematic", "num_tasks": 8, "max_parts": 1}
    env = home_mjx.make("InstructionFollowing-v0", "procedural:1?preset=flat", **options)
    asked = []
    assert example.play(env, lambda prompt: asked.append(prompt) or "I dance.", jax.random.key(0)) == 0.0
    assert len(asked) == example.MAX_TRIES
    assert asked[-1].startswith("Nothing happens.")
    assert all("Your task is to: " in prompt and "Actions: " in prompt for prompt in asked)
    assert all(name in asked[0] for name in env.core.action_names)
    found = [example.play(env, example.make_stub(), jax.random.key(seed)) for seed in range(6)]
    assert sum(found) >= 1
    assert "> move_forward" in capsys.readouterr().out
