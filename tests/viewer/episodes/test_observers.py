"""Observers: the order of their events, also after errors, and one that is plugged in from a user's file."""

import importlib
import io
from pathlib import Path

import pytest

import home_mjx
from home_mjx.cli import main
from home_mjx.errors import ConfigError, UnknownNameError
from home_mjx.tasks.env.observers import (
    EpisodeResult,
    Observer,
    ObserverGroup,
    find_observer,
    register_observer,
    resolve_observers,
)
from home_mjx.viewer.episodes import camera
from home_mjx.viewer.episodes.run import PlayOptions, run_play

LENGTH = 4  # steps of an episode
USERS_FILE = '''
from home_mjx import Observer, register_observer

seen = []

class Lengths(Observer):
    """Number of steps of each episode."""

    def on_run_start(self, start):
        seen.append((start.name, start.unit, start.total, start.env.bank.num_houses > 0))

    def on_episode_end(self, result):
        seen.append(result.steps)

    def write(self, folder):
        (folder / "lengths.txt").write_text(str(seen[1:]))

    def close(self):
        seen.append("closed")

register_observer("lengths", Lengths)
'''


class Recorder(Observer):
    """Appends the name of each event."""

    def __init__(self, events: list | None = None, label: str = "", fails_in: str = "") -> None:
        self.events, self.label, self.fails_in = [] if events is None else events, label, fails_in

    def _add(self, event: str) -> None:
        self.events.append(f"{self.label}{event}")
        if event.split()[0] == self.fails_in:
            raise ValueError(self.label)

    def on_run_start(self, start) -> None:
        self._add(f"run {start.total}")

    def on_update(self, count) -> None:
        self._add(f"update {count}")

    def on_episode_start(self, start) -> None:
        self._add(f"start {start.number}")

    def on_episode_step(self, step) -> None:
        assert (step.action is None) == (step.index == 0)
        assert int(step.state.world.step) == step.index
        self._add(f"step {step.index}")

    def on_episode_end(self, result) -> None:
        self._add(f"end {result.steps}")

    def write(self, folder) -> None:
        self._add("write")
        (folder / "recorded.txt").write_text("recorded")

    def close(self) -> None:
        self._add("close")


@pytest.fixture(scope="module")
def env(generated_bank):
    return home_mjx.make(
        "PointNav-v0", generated_bank, sensors=("state",), impl="kinematic", actions="discrete", episode_length=LENGTH
    )


@pytest.fixture(autouse=True)
def _played_here(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> None:
    """Episodes are of `env`, and nobody renders images."""
    if "env" in request.fixturenames:
        env = request.getfixturevalue("env")
        monkeypatch.setattr("home_mjx.viewer.episodes.run.make", lambda spec: env)
        monkeypatch.setattr(camera.FilmCamera, "capture", None)


def options(**changes: object) -> PlayOptions:
    return PlayOptions(home_mjx.registry.find_spec("PointNav-v0"), **({"agent": "random", "episodes": 2} | changes))


def steps_of(number: int, num: int = LENGTH) -> list[str]:
    return [f"start {number}", *(f"step {index}" for index in range(num + 1)), f"end {num}", "update 1"]


def test_events_come_in_order_and_nothing_is_rendered_that_nobody_looks_at(env):
    recorder = Recorder()
    run_play(options(), lambda line: None, observers=[recorder])
    assert recorder.events == ["run 2", *steps_of(1), *steps_of(2), "close"]


def test_an_episode_that_a_person_gives_up_has_an_end(env, capsys: pytest.CaptureFixture):
    recorder = Recorder()
    run_play(options(agent="human", episodes=1), lambda line: None, io.StringIO("wq"), [recorder])
    assert recorder.events == ["run 1", *steps_of(1, 1), "close"]
    assert capsys.readouterr().out.count("you   step") == 2


def test_an_error_closes_all_and_leaves_no_file(env, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    events: list[str] = []
    observers = [Recorder(events, "a "), Recorder(events, "b ", "step")]
    monkeypatch.setattr("home_mjx.viewer.episodes.run._own_observers", lambda *args: ())
    with pytest.raises(ValueError, match="b"):
        run_play(options(out=tmp_path), observers=observers)
    assert events == ["a run 2", "b run 2", "a start 1", "b start 1", "a step 0", "b step 0", "b close", "a close"]
    assert list(tmp_path.iterdir()) == []


def test_an_observer_from_a_users_file(env, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """By name, from the command line."""
    (tmp_path / "my_lengths.py").write_text(USERS_FILE)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr("home_mjx.viewer.episodes.run._own_observers", lambda *args: ())
    out = tmp_path / "out"
    arguments = ["--agent", "random", "--episodes", "2", "--import", "my_lengths", "--observe", "lengths"]
    assert main(["play", "PointNav", *arguments, "--out", str(out)]) == 0
    seen = importlib.import_module("my_lengths").seen
    assert seen == [("random", "episodes", 2, True), LENGTH, LENGTH, "closed"]
    assert (out / "lengths.txt").read_text() == f"[{LENGTH}, {LENGTH}]"


def test_closing_goes_on_after_an_error():
    events: list[str] = []
    group = ObserverGroup([Recorder(events, "a "), Recorder(events, "b ", "close"), Recorder(events, "c ")])
    with pytest.raises(ValueError, match="b"), group:
        pass
    assert events == ["c close", "b close", "a close"]
    with pytest.raises(KeyError), group:  # the error of the run is not hidden by one of closing
        raise KeyError


def test_names_are_looked_up_and_mistakes_are_named():
    register_observer("recorder", Recorder)
    own = Recorder()
    made, same = resolve_observers(["recorder", own])
    assert (type(made), same) == (Recorder, own)
    assert made is not find_observer("recorder")
    with pytest.raises(UnknownNameError, match=r"unknown observer `recordr`.*`recorder`"):
        find_observer("recordr")
    with pytest.raises(ConfigError, match="expected an observer"):
        resolve_observers([Recorder])
    with pytest.raises(ConfigError, match="needs a name"):
        register_observer("", Recorder)
    register_observer("nothing", lambda: None)
    with pytest.raises(ConfigError, match="expected an observer"):
        find_observer("nothing")


def test_an_empty_observer_takes_every_event():
    class Nothing(Observer):
        pass

    nothing = Nothing()
    nothing.on_episode_end(EpisodeResult(1, "PointNav", "", "a", 1.0, 1.0, 2, 3.0))
    nothing.on_log({"steps": 1})
    nothing.close()
    assert isinstance(nothing, Observer)
