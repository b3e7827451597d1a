"""Progress in words: who sees it, and what it says."""

import io
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jaxtyping import Float

import home_mjx
from home_mjx.cli import main
from home_mjx.core import progress
from home_mjx.core.compile_cache import describe_compile
from home_mjx.core.progress import (
    ProgressCount,
    ProgressPhase,
    bar,
    command_progress,
    counts,
    is_progress_shown,
    say,
    silence,
    track,
)
from home_mjx.errors import ConfigError
from home_mjx.houses import HouseSet, add_bakes


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture
def without_pytest(monkeypatch: pytest.MonkeyPatch):
    """As in a user's process: stderr is captured, so no terminal."""
    monkeypatch.delenv(progress.PYTEST_VARIABLE)
    monkeypatch.delenv(progress.PROGRESS_VARIABLE, raising=False)
    monkeypatch.delattr(sys, "ps1", raising=False)
    return monkeypatch


def test_tests_are_silent_and_an_argument_or_the_variable_overrides(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.delenv(progress.PROGRESS_VARIABLE, raising=False)
    with command_progress():
        assert not is_progress_shown()
        assert is_progress_shown(True)
        monkeypatch.setenv(progress.PROGRESS_VARIABLE, "1")
        assert is_progress_shown()
        assert not is_progress_shown(False)


def test_commands_prompts_and_terminals_show_it_and_pipes_do_not(without_pytest: pytest.MonkeyPatch):
    assert not is_progress_shown()
    with command_progress():
        assert is_progress_shown()
        without_pytest.setenv(progress.PROGRESS_VARIABLE, "0")
        assert not is_progress_shown()
    without_pytest.delenv(progress.PROGRESS_VARIABLE)
    assert not is_progress_shown()
    without_pytest.setattr(sys, "ps1", ">>> ", raising=False)
    assert is_progress_shown()
    without_pytest.delattr(sys, "ps1")
    without_pytest.setattr(sys, "stderr", Terminal())
    assert is_progress_shown()


def test_another_value_of_the_variable_is_refused(without_pytest: pytest.MonkeyPatch):
    without_pytest.setenv(progress.PROGRESS_VARIABLE, "yes")
    with pytest.raises(ConfigError, match="HOME_MJX_PROGRESS must be 0 or 1, got `yes`"):
        is_progress_shown()


def test_counts_are_lines_in_a_pipe(capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(counts, "DELAY", 0.0)
    monkeypatch.setattr(counts, "LINE_INTERVAL", 0.0)
    monkeypatch.setattr(counts, "LINE_SHARE", 0.0)
    with ProgressCount("loading 3 houses", 3, "house", progress=True) as count:
        count.update()
        count.describe("compiling 3 houses")
        count.update()
    assert list(track("ab", "reading", "letter", progress=True)) == ["a", "b"]
    written = capsys.readouterr()
    assert written.out == ""
    assert written.err.splitlines() == [
        "home_mjx: loading 3 houses 1/3",
        "home_mjx: compiling 3 houses 1/3",
        "home_mjx: compiling 3 houses 2/3",
        "home_mjx: reading 1/2",
        "home_mjx: reading 2/2",
    ]


def test_counts_are_bars_in_a_terminal(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(counts, "DELAY", 0.0)
    monkeypatch.setattr(sys, "stderr", Terminal())
    with ProgressCount("loading 3 houses", 3, "house", progress=True) as count:
        count.describe("compiling 3 houses")
        count.update()
    assert "compiling 3 houses:" in sys.stderr.getvalue()
    assert "1/3" in sys.stderr.getvalue()


def test_a_bar_predicts_nothing_from_compilation(monkeypatch: pytest.MonkeyPatch):
    """The first of ten units takes 100 s and each later one 1 s: at no time is more than 9 s predicted."""
    now = 0.0
    monkeypatch.setattr(bar.TickingBar, "_now", lambda self: now)
    with bar.TickingBar(desc="walking", total=10, unit=" steps", file=Terminal()) as shown:
        assert "<" not in str(shown)
        now = 100.0
        shown.update()
        for _ in range(2):
            now += 1.0
            shown.update()
            assert "<" not in str(shown)
        now += 1.0
        shown.update()
        assert str(shown).startswith("walking:  40%|")
        assert "<00:06,  1.00 steps/s]" in str(shown)


def test_long_work_is_never_silent_in_a_terminal(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(bar, "TICK", 0.02)
    monkeypatch.setattr(sys, "stderr", Terminal())
    with ProgressPhase("compiling step", progress=True):
        time.sleep(0.3)
    with ProgressCount("loading 3 houses", 3, "house", progress=True):
        time.sleep(0.3)
    written = sys.stderr.getvalue()
    assert written.count("compiling step [00:00]") >= 5
    assert written.count("loading 3 houses:   0%|") >= 5
    time.sleep(0.1)
    assert sys.stderr.getvalue() == written  # nothing comes after the end


def test_long_work_writes_lines_in_a_log(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture):
    monkeypatch.setattr(bar, "TICK", 0.05)
    monkeypatch.setattr(counts, "LINE_INTERVAL", 0.6)
    with ProgressPhase("compiling step", progress=True):
        time.sleep(1.4)
    lines = capsys.readouterr().err.splitlines()
    assert lines == ["home_mjx: compiling step", "home_mjx: compiling step", "home_mjx: compiling step (1 s)"]


def test_what_is_quick_is_not_counted(capsys: pytest.CaptureFixture):
    assert list(track(range(100), "reading", "number", progress=True)) == list(range(100))
    with silence():
        assert not say("nothing", progress=True)
    assert capsys.readouterr().err == ""


@dataclass(frozen=True)
class AreaRecord:
    value: Float[np.ndarray, " n"]


class Area:
    """A bake of one number a house."""

    name, version, options, record, unused = "area", 1, None, AreaRecord, frozenset()

    def bake_house(self, bank, index, house):
        return AreaRecord(np.float32([index]))

    def stack(self, records, houses, bank):
        return jnp.stack([record.value for record in records])


def test_it_says_what_is_made_and_compiled_once_each(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path))
    monkeypatch.setenv(progress.PROGRESS_VARIABLE, "1")
    env = home_mjx.make("PointNav-v0", "procedural:2?seed=7300&preset=flat", sensors=("goal",), impl="kinematic")
    bake = Area()
    for _ in range(2):
        add_bakes(env.bank, HouseSet("procedural:2?seed=7300&preset=flat").load(), bake)
    keys = jax.random.split(jax.random.key(0), 2)
    jax.jit(jax.vmap(env.reset)).lower(keys)
    states = jax.eval_shape(jax.vmap(env.reset), keys)
    jax.jit(jax.vmap(env.step)).lower(states, jnp.zeros((2, env.action_size)))
    lines = [line.removeprefix("home_mjx: ") for line in capsys.readouterr().err.splitlines()]
    assert lines[0] == "generating 2 houses (once, then cached)"
    assert "loading 2 houses, compiling those that are not cached 0/2" in lines
    assert [line for line in lines if not line.startswith(("generating", "loading 2"))] == [
        "moving 2 houses to the device",
        "baking area of 2 houses (once, then cached) 0/2",
        describe_compile("reset"),
        describe_compile("step"),
    ]


def test_a_batch_announces_its_step_without_its_reset(
    generated_bank: home_mjx.HouseBank, capsys: pytest.CaptureFixture
):
    env = home_mjx.make("PointNav-v0", generated_bank, sensors=("goal",), impl="kinematic", progress=True)
    batch = home_mjx.AutoReset(env.core)
    states = jax.eval_shape(batch.reset, env.params, jax.random.split(jax.random.key(0), 2))
    jax.eval_shape(batch.step, env.params, states, jnp.zeros((2, env.action_size)))
    assert [line.split(" (")[0] for line in capsys.readouterr().err.splitlines()] == [
        "home_mjx: compiling reset",
        "home_mjx: compiling step",
    ]


def test_a_command_says_what_it_does(tmp_path: Path, without_pytest: pytest.MonkeyPatch, capsys: pytest.CaptureFixture):
    without_pytest.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))
    assert main(["generate", str(tmp_path / "new"), "--seeds", "2", "--preset", "flat"]) == 0
    assert "home_mjx: generating 1 house\n" in capsys.readouterr().err
    assert main(["inspect", "--dataset", str(tmp_path / "new")]) == 0
    assert "home_mjx: compiling house 686f6d65" in capsys.readouterr().err
