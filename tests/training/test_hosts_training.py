"""Training by two processes, each with one device of a shared mesh: one run, one checkpoint, resumed after a kill."""

import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from connected_processes import finish, free_port

pytest.importorskip("flax", reason="needs the extra `train`")

from home_mjx.training.metrics_log import read_lines

pytestmark = pytest.mark.slow
OPTIONS = (
    *("PointNav", "--dataset", "procedural:200?preset=flat", "--houses", "1", "--sensors", "goal"),
    *("--held-out", "1", "--episodes", "1"),
    *("--env", "impl=kinematic", "--num-envs", "8", "--ppo", "unroll_length=4", "--ppo", "num_minibatches=2"),
    *("--ppo", "num_epochs=1", "--ppo", "memory=16", "--ppo", "features=16", "--steps", "96"),
)


def start_two(out: Path, *more: str) -> list[subprocess.Popen]:
    """Both processes of a run of three updates."""
    env = os.environ | {"JAX_PLATFORMS": "cpu", "JAX_NUM_CPU_DEVICES": "1"}
    argv = [sys.executable, "-m", "home_mjx.cli", "train", *OPTIONS, "--out", str(out), *more]
    argv += ["--coordinator", f"127.0.0.1:{free_port()}", "--processes", "2", "--process"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "env": env}
    return [subprocess.Popen([*argv, str(i)], **pipes) for i in range(2)]


def arrays(path: Path) -> dict[str, np.ndarray]:
    with np.load(path) as file:
        return {name: file[name] for name in file.files}


def test_two_processes_train_as_two_devices_and_resume_after_a_kill(tmp_path: Path):
    whole, killed, alone = (tmp_path / name for name in ("whole", "killed", "alone"))
    first, second = finish(start_two(whole), 1200)
    assert f"home-mjx evaluate {whole}" in first
    assert "evaluate" not in second
    assert [line["steps"] for line in read_lines(whole / "metrics.jsonl")] == [32, 64, 96]

    processes = start_two(killed)
    while not (killed / "checkpoint.npz").exists() and processes[0].poll() is None:
        time.sleep(0.05)
    assert (killed / "checkpoint.npz").exists()
    assert processes[0].poll() is None, "ended before it could be killed"
    for process in processes[::-1]:  # a host is lost, and with it the run
        process.kill()
        process.communicate()
    finish(start_two(killed, "--resume"), 1200)

    env = os.environ | {"JAX_PLATFORMS": "cpu", "JAX_NUM_CPU_DEVICES": "2"}
    argv = [sys.executable, "-m", "home_mjx.cli", "train", *OPTIONS, "--out", str(alone)]
    subprocess.run(argv, env=env, check=True, capture_output=True)
    reference = arrays(whole / "checkpoint.npz")
    for folder in (killed, alone):
        for name, array in arrays(folder / "checkpoint.npz").items():
            if name != "config":
                np.testing.assert_array_equal(array, reference[name], err_msg=f"{folder.name} {name}")
