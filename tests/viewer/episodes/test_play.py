"""Episodes that are played and filmed, against the environment itself."""

import io
import json
import re
import subprocess
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest
from full_disk import full_disk
from generated import generate_flats
from PIL import Image

from home_mjx.cli import main
from home_mjx.core.files import write_all_or_none
from home_mjx.errors import ConfigError, HomeMjxError
from home_mjx.registry import EnvSpec, find_spec
from home_mjx.tasks.env.observers import EpisodeResult, ObserverGroup
from home_mjx.viewer.episodes.observers import FilmObserver, ResultsObserver, ShotCache
from home_mjx.viewer.episodes.run import PlayOptions, run_play
from home_mjx.viewer.episodes.video import LEGEND, VideoWriter, compose_frame, fit_image


def film_of(path: Path) -> np.ndarray:
    ffmpeg = imageio_ffmpeg.get_ffmpeg_exe()
    told = subprocess.run([ffmpeg, "-i", str(path)], capture_output=True, text=True, check=False).stderr
    width, height = (int(x) for x in re.search(r"Video:.* (\d+)x(\d+)", told).groups())
    command = [ffmpeg, "-loglevel", "error", "-i", str(path), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    data = subprocess.run(command, capture_output=True, check=True).stdout
    return np.frombuffer(data, np.uint8).reshape(-1, height, width, 3)


def test_frames_have_even_sides_and_keep_what_they_show(rng: np.random.Generator):
    view, plan = rng.integers(0, 255, (60, 81, 3), np.uint8), np.full((200, 100, 3), 90, np.uint8)
    picture = compose_frame(view, plan, "go " * 100, "step", success=True)
    assert [side % 2 for side in picture.shape[:2]] == [0, 0]
    assert np.array_equal(picture[34:94, 8:89], view)
    assert fit_image(plan, 50, 40).shape == (40, 50, 3)
    assert np.array_equal(fit_image(plan, 50, 40)[20, 25], [90, 90, 90])


def test_a_frame_names_the_marks_of_its_plan():
    """Below the plan, in the colours of its marks: a ring for the goal, discs for path and agent."""
    view = np.zeros((360, 480, 3), np.uint8)
    picture = compose_frame(view, np.zeros((640, 640, 3), np.uint8), "go to the sound", "step")
    beside = picture[34:394, 496:976].astype(int)
    for _, colour, _ in LEGEND:
        row, column = np.nonzero(np.abs(beside - colour).max(axis=2) < 60)
        assert len(row) >= 4
        assert row.min() > 330
        assert np.ptp(column) < 16


def test_a_film_runs_in_real_time_with_sound_and_never_slower_than_can_be_followed(tmp_path: Path):
    silent, heard = VideoWriter(0.3), VideoWriter(0.3, 16000)
    assert (silent.fps, heard.fps) == (6.0, pytest.approx(1 / 0.3))
    picture = np.zeros((64, 64, 3), np.uint8)
    for film in (silent, heard):
        film.add(picture)
        film.add_final(picture + 200)
        film.write(tmp_path, "film")
        frames = film_of(tmp_path / "film.mp4")
        assert len(frames) == len(film.frames) == 1 + round(1.5 * film.fps)
        assert (frames[0].mean() < 20, frames[-1].mean() > 180) == (True, True)
    assert sum(sound.shape[1] for sound in heard.sounds) == 16000 * 0.3 * len(heard.frames)


def test_a_film_with_sound_has_a_stereo_stream_as_long_as_its_frames(tmp_path: Path, rng: np.random.Generator):
    film, picture = VideoWriter(0.3, 16000), np.zeros((64, 64, 3), np.uint8)
    for _ in range(10):
        film.add(picture, rng.normal(size=(2, 4800)).astype(np.float32) * [[1.0], [0.1]])
    film.add_final(picture)
    film.write(tmp_path, "film")
    ffmpeg = imageio_ffmpeg.get_ffmpeg_exe()
    told = subprocess.run(
        [ffmpeg, "-i", str(tmp_path / "film.mp4")], capture_output=True, text=True, check=False
    ).stderr
    assert re.search(r"Audio: aac.* 16000 Hz, stereo", told)
    assert re.search(r"Video: h264.* 3\.33 fps", told)
    command = [ffmpeg, "-loglevel", "error", "-i", str(tmp_path / "film.mp4"), "-f", "f32le", "-"]
    heard = np.frombuffer(subprocess.run(command, capture_output=True, check=True).stdout, np.float32).reshape(-1, 2)
    assert len(heard) / 16000 == pytest.approx(0.3 * len(film.frames), abs=0.2)
    left, right = np.sqrt(np.mean(heard[:48000] ** 2, axis=0))
    assert left > 5 * right > 0


@pytest.mark.parametrize("size", [0, 1000, 50_000, 10**7])
def test_a_full_disk_leaves_all_of_a_film_or_nothing(tmp_path: Path, rng: np.random.Generator, size: int):
    """Half a film was left, or one without its picture and its outcomes."""
    film, results = FilmObserver(ShotCache(), "film"), ResultsObserver("film", lambda line: None)
    film.video = VideoWriter(0.3)
    film.video.add_final(np.zeros((64, 64, 3), np.uint8))
    film.video.ends = [rng.integers(0, 255, (200, 300, 3), np.uint8)]  # a picture much larger than the film
    results.on_episode_end(EpisodeResult(1, "PointNav", "", "a", 1.0, 1.0, 2, 3.0))

    def write() -> None:
        with write_all_or_none(tmp_path, "film") as folder:
            ObserverGroup((film, results)).write(folder)

    if size == 10**7:
        write()
        assert {path.suffix for path in tmp_path.iterdir()} == {".mp4", ".png", ".jsonl"}
        return
    with full_disk(size), pytest.raises(HomeMjxError, match="writ") as raised:
        write()
    assert raised.value.hint
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("changes", "words"),
    [({"agent": "nobody"}, "unknown agent"), ({"agent": "trained"}, "checkpoint"), ({"checkpoint": Path("x")}, "x")],
)
def test_what_does_not_go_together_is_refused(changes: dict, words: str):
    with pytest.raises(ConfigError, match=words if words != "x" else "checkpoint"):
        run_play(PlayOptions(EnvSpec("PointNav-v0", "home_mjx.tasks.suite:PointNav"), **changes))


def test_a_task_must_be_named(capsys: pytest.CaptureFixture):
    assert main(["play"]) == 2
    assert "expected a task" in capsys.readouterr().err


@pytest.fixture(scope="module")
def houses(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("play")
    generate_flats(root, range(2))
    return root


@pytest.mark.slow
def test_an_expert_is_filmed(houses: Path, tmp_path: Path):
    spec = find_spec("RoomNav-v0")
    spec = EnvSpec(spec.id, spec.entry_point, {**spec.options, "sensors": ("audio",), "num_tasks": 4}, str(houses), 2)
    options = PlayOptions(spec, episodes=2, out=tmp_path, width=64, height=48)
    lines: list[str] = []
    outcomes = run_play(options, lines.append)
    assert [outcome.success for outcome in outcomes] == [1.0, 1.0]
    assert lines == [outcome.format_line() for outcome in outcomes]
    assert all(outcome.spl > 0.8 for outcome in outcomes)
    kept = [json.loads(line) for line in (tmp_path / "RoomNav-v0_expert.jsonl").read_text().splitlines()]
    assert [line["steps"] for line in kept] == [outcome.steps for outcome in outcomes]
    frames = film_of(tmp_path / "RoomNav-v0_expert.mp4")
    held = 2 * round(1.5 / 0.3)
    assert len(frames) == sum(outcome.steps + 1 for outcome in outcomes) + held
    assert frames[0, 40:80, 10:70].std() > 10  # the agent sees something
    assert not np.array_equal(frames[0, 40:80, 80:140], frames[-held // 2, 40:80, 80:140])  # and gets on
    with Image.open(tmp_path / "RoomNav-v0_expert.png") as ends:
        assert ends.width >= frames.shape[2]


@pytest.mark.slow
def test_a_person_plays_by_lines_of_keys(houses: Path, capsys: pytest.CaptureFixture):
    spec = find_spec("RoomNav-v0")
    spec = EnvSpec(spec.id, spec.entry_point, {**spec.options, "sensors": ("state",), "num_tasks": 4}, str(houses), 2)
    (outcome,) = run_play(PlayOptions(spec, "human", episodes=1), lambda line: None, io.StringIO("aa ww"))
    assert outcome.steps == 3  # stopped: the rest is not played
    told = capsys.readouterr().out
    assert "space stop" in told
    assert "step 2 of" in told
    (given_up,) = run_play(PlayOptions(spec, "human", episodes=1), lambda line: None, io.StringIO("wwq"))
    assert (given_up.steps, given_up.success) == (2, 0.0)
