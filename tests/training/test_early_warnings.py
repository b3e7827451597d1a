"""Early warnings: each sign of failure is told once, and healthy runs are left alone."""

import jax.numpy as jnp
import numpy as np
import pytest

pytest.importorskip("flax", reason="needs the extra `train`")

from home_mjx.training.early_warnings import EarlyWarnings, dead_units


def told(lines: list[dict[str, float]]) -> list[str]:
    said: list[str] = []
    warnings = EarlyWarnings(said.append)
    for number, line in enumerate(lines, 1):
        warnings.on_log({"steps": number, **line})
    return said


def healthy(count: int) -> list[dict[str, float]]:
    """Lines of a run that converges: entropy and value loss fall as success rises."""
    shares = np.linspace(0, 1, count)
    return [
        {"loss/entropy": 1.8 * (1 - s) + 0.02, "loss/value": 0.5 * (1 - s) + 0.01, "success": s, "dead_units": 0.1}
        for s in shares
    ]


def test_a_healthy_run_is_left_alone():
    assert told(healthy(200)) == []


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"loss/entropy": 0.01, "success": 0.1}, "entropy"),
        ({"loss/value": 80.0}, "value loss"),
        ({"loss/policy": float("nan")}, "not finite"),
        ({"dead_units": 0.9}, "90 %"),
    ],
)
def test_each_sign_is_told_once_until_it_has_gone(change: dict[str, float], word: str):
    lines = healthy(40)
    for place in (20, 21, 22, 30):
        lines[place] = lines[place] | change
    said = told(lines)
    assert [text.split(":")[0] for text in said] == ["after 21 steps", "after 31 steps"]
    assert all(word in text for text in said)


def test_dead_units_are_those_that_do_not_vary(rng):
    memory = rng.normal(size=(64, 10)).astype(np.float32)
    memory[:, :3] = [0.0, 1.0, -0.5]
    assert float(dead_units(jnp.asarray(memory))) == pytest.approx(0.3)
