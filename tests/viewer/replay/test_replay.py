"""Recorded episodes: states come back exactly, events and failures are found, trajectories are simulated again."""

import dataclasses
from pathlib import Path

import jax
import numpy as np
import pytest
from handmade import Furniture, shoebox

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.errors import ConfigError, DatasetError, MissingFileError
from home_mjx.tasks.env.observers import EpisodeResult, EpisodeStart, Observer, ObserverGroup, RunStart
from home_mjx.viewer.browser.live_camera import LiveCamera, PictureOptions
from home_mjx.viewer.episodes.episode import EpisodeRunner
from home_mjx.viewer.episodes.observers import FilmObserver, ShotCache
from home_mjx.viewer.replay.export import export_episode
from home_mjx.viewer.replay.page import fill_page
from home_mjx.viewer.replay.recorder import ReplayRecorder
from home_mjx.viewer.replay.session import ReplaySession
from home_mjx.viewer.replay.track import Event, blank_state, fill_state, read_replay

RED = Furniture((1.0, 0.0), (0.6, 0.6, 0.8), color=(0.9, 0.1, 0.1))
NUM_STEPS = 30


@pytest.fixture(scope="module")
def env():
    bank = HouseBank.from_compiled([shoebox(furniture=(RED,))])
    return home_mjx.make("PointNav-v0", bank, sensors=("state",), impl="kinematic", episode_length=NUM_STEPS)


@pytest.fixture(scope="module")
def recorded(env, tmp_path_factory) -> tuple[list, Path]:
    """An episode of an agent that walks ahead until it hits something."""
    runner, recorder = EpisodeRunner(env), ReplayRecorder("walk")
    recorder.on_run_start(RunStart("human", env, "episodes", 1))
    episode = runner.begin(1, jax.random.key(3), None, 0)
    recorder.on_episode_start(episode.start)
    steps = [episode.step]
    recorder.on_episode_step(episode.step)
    while not episode.step.state.done:
        steps.append(episode.advance(np.array([1, 0, 0.05, 0], np.float32)))
        recorder.on_episode_step(steps[-1])
    recorder.on_episode_end(episode.result())
    folder = tmp_path_factory.mktemp("replay")
    recorder.write(folder)
    return steps, folder / "walk.replay.npz"


def test_all_states_of_the_file_look_as_they_did(env, recorded):
    steps, path = recorded
    (track,) = read_replay(path).tracks
    assert track.num_steps == len(steps) - 1
    camera, options, blank = LiveCamera(env), PictureOptions(kind="depth", size=24), blank_state(env)
    for index in (0, 7, track.num_steps):
        state = fill_state(blank, track.at(index))
        assert np.array_equal(camera.capture(state, options), camera.capture(steps[index].state, options))
        assert np.array_equal(state.physics.qpos, steps[index].state.physics.qpos)
    assert track.series["reward"][1:] == pytest.approx([float(step.state.reward) for step in steps[1:]])
    assert path.stat().st_size < 200_000


def test_the_contact_is_where_the_agent_is_first_slowed(env, recorded):
    _, path = recorded
    (track,) = read_replay(path).tracks
    (contact,) = [event for event in track.events if event.kind == "contact"][:1]
    travelled = np.linalg.norm(np.diff(track.feet[:, :2], axis=0), axis=1)
    assert contact.step == 1 + int(np.argmax(travelled < 0.999 * travelled[0]))
    assert contact.text.startswith("touches ")
    assert track.events[-1] == Event(track.num_steps, "end", "failure")


def test_a_session_jumps_to_steps_events_and_failures(env, recorded):
    shown = []

    class Shown(Observer):
        def on_episode_step(self, step):
            shown.append((step.index, np.asarray(step.state.physics.qpos[:2]), step.episode_return))

    steps, path = recorded
    replay = read_replay(path)
    (track,) = replay.tracks
    won = dataclasses.replace(track, notes={**track.notes, "success": 1.0})
    session = ReplaySession(env, dataclasses.replace(replay, tracks=[won, track, won, track]), Shown())
    session.show(5)
    assert shown[-1][0] == 5
    assert np.array_equal(shown[-1][1], steps[5].state.physics.qpos[:2])
    assert shown[-1][2] == pytest.approx(steps[5].episode_return, abs=1e-5)
    session.go(lambda: session.find_failure(1))
    session.go(lambda: session.find_failure(1))
    assert session.number == 3
    assert session.find_failure(1) is None
    session.go(lambda: session.find_failure(-1))
    assert session.number == 1
    session.go(lambda: session.find_event(1, ("contact",)))
    first = next(event.step for event in track.events if event.kind == "contact")
    assert session.index == shown[-1][0] == first
    assert session.find_event(-1, ("contact",)) is None


def test_a_replay_of_other_houses_or_a_broken_file_is_refused(env, recorded, tmp_path):
    replay = read_replay(recorded[1])
    with pytest.raises(ConfigError, match="houses"):
        ReplaySession(env, dataclasses.replace(replay, houses=("other",)), ObserverGroup(()))
    name = next(iter(replay.tracks[0].leaves))
    with pytest.raises(DatasetError, match="differs"):
        fill_state(blank_state(env), {**replay.tracks[0].at(0), name: np.zeros(99)})
    broken = tmp_path / "broken.replay.npz"
    broken.write_bytes(recorded[1].read_bytes()[:1000])
    with pytest.raises(DatasetError, match="not a valid replay"):
        read_replay(broken)
    with pytest.raises(MissingFileError):
        read_replay(tmp_path / "missing.replay.npz")


def test_an_exported_film_is_that_of_the_episode_when_it_was_played(env, recorded, tmp_path):
    steps, path = recorded
    replay, shots = read_replay(path), ShotCache(48, 36)
    film, notes = FilmObserver(shots, "played"), replay.tracks[0].notes
    film.on_run_start(RunStart("human", env, "episodes", 1))
    film.on_episode_start(EpisodeStart(1, None, notes["house"], notes["task"], notes["instruction"], np.nan))
    for step in steps:
        film.on_episode_step(step)
    names = ("number", "task", "instruction", "house", "success", "spl", "steps", "episode_return")
    film.on_episode_end(EpisodeResult(**{name: notes[name] for name in names}))
    film.write(tmp_path)
    parts = []
    content = export_episode(env, replay, 0, ".mp4", shots, parts.append)
    assert content == (tmp_path / "played.mp4").read_bytes()
    assert parts == pytest.approx(np.arange(len(steps)) / len(steps))


def test_a_film_whose_base64_spells_a_name_of_the_page_stays_whole():
    film, text = "AAADATAmp4{{data}}", '{"title": "{{mp4}}"}'
    assert fill_page("<{{mp4}}><{{webm}}>DATA {{data}}", {"mp4": film, "webm": film, "data": text}) == (
        f"<{film}><{film}>DATA {text}"
    )
