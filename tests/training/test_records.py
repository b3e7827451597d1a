"""What a run leaves: lines that a resumed run continues, TensorBoard's events, a picture."""

import json
import struct
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

pytest.importorskip("tensorboardX", reason="needs the extra `train`")

from tensorboardX.proto import event_pb2

from home_mjx.tasks.env.observers import ObserverGroup, RunStart
from home_mjx.training.metrics_log import CurvesPlot, MetricsLog, TensorBoardLog, read_lines
from home_mjx.training.progress import MetricMeans


def records_of(folder: Path, steps: int = 0) -> ObserverGroup:
    log = MetricsLog(folder, steps)
    group = ObserverGroup((log, TensorBoardLog(folder / "tensorboard", steps), CurvesPlot(log)))
    group.on_run_start(RunStart("ppo", None, "steps", 1000, steps))
    return group


def test_a_resumed_run_goes_on_after_its_checkpoint(tmp_path: Path):
    with records_of(tmp_path) as records:
        for steps in (100, 200, 300):
            records.on_log({"steps": steps, "success": steps / 1000, "spl": float("nan")})
    with (tmp_path / "metrics.jsonl").open("a") as file:
        file.write('{"steps": 400, "succ')  # killed here
    with records_of(tmp_path, steps=200) as records:
        records.on_log({"steps": 250, "success": 0.5})
        records.on_checkpoint(tmp_path / "checkpoint.npz", 250)
    lines = [json.loads(line) for line in (tmp_path / "metrics.jsonl").read_text().splitlines()]
    assert lines == [
        {"steps": 100, "success": 0.1},
        {"steps": 200, "success": 0.2},
        {"steps": 250, "success": 0.5},
    ]
    image = np.asarray(Image.open(tmp_path / "curves.png").convert("L"))
    assert (image < 200).sum() > 1000
    assert sorted(steps_of(tmp_path / "tensorboard")) == [100, 200, 250, 300]


def steps_of(folder: Path) -> list[int]:
    """Steps of the scalars `episode/success`, read by the record format: length, checksum, event, checksum."""
    steps = []
    for path in folder.iterdir():
        data, at = path.read_bytes(), 0
        while at < len(data):
            (size,) = struct.unpack_from("<Q", data, at)
            event = event_pb2.Event.FromString(data[at + 12 : at + 12 + size])
            steps += [event.step for value in event.summary.value if value.tag == "episode/success"]
            at += 16 + size
    return steps


def test_a_broken_line_ends_the_file(tmp_path: Path):
    (tmp_path / "metrics.jsonl").write_text('{"steps": 1}\n{"ste')
    assert read_lines(tmp_path / "metrics.jsonl") == [{"steps": 1}]
    assert read_lines(tmp_path / "none.jsonl") == []


def test_means_are_over_updates_and_over_episodes():
    sums = MetricMeans()
    sums.add({"loss/value": 1.0, "episode/episodes": 3.0, "episode/success": 3.0})
    sums.add({"loss/value": 2.0, "episode/episodes": 1.0, "episode/success": 0.0})
    assert sums.means() == {"loss/value": 1.5, "episodes": 4.0, "success": 0.75}
    sums.add({"loss/value": 5.0, "episode/episodes": 0.0, "episode/success": 0.0})
    assert sums.means() == {"loss/value": 5.0, "episodes": 0.0}
