"""Several processes on one CPU: they share a mesh, agree with the leader, and collect what is split over them."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from connected_processes import finish, free_port

from home_mjx.errors import ConfigError
from home_mjx.hosts import agree, check_same, collect, connect, is_leader

PROGRAM = """
import json, sys
from home_mjx.hosts import agree, check_same, collect, connect, is_leader, local_part
process = int(sys.argv[2])
connect(sys.argv[1], 2, process, 120)
import jax, jax.numpy as jnp, numpy as np
from home_mjx.errors import ConfigError
from home_mjx.sharding import BY_ENV, REPLICATED, EnvSharding, env_index, make_mesh, mean_over_devices
sharding = EnvSharding(make_mesh())
envs, net = sharding.put_envs(np.arange(8.0)), sharding.put({"w": np.float32(2), "none": np.zeros((0, 3))}, REPLICATED)

def learn(net, x):
    moved = x * net["w"] + env_index(x.shape[0])
    return moved, {"loss": mean_over_devices(jnp.mean(x)), "none": net["none"]}

moved, parts = sharding.map(learn, (REPLICATED, BY_ENV), (BY_ENV, REPLICATED))(net, envs)
try:
    check_same(process, "numbers of updates", "Share the folder.")
    error = ""
except ConfigError as found:
    error = str(found)
check_same(3, "numbers", "")
print(json.dumps({
    "devices": jax.device_count(), "leader": is_leader(), "agreed": int(agree(np.int32(process + 5))),
    "whole": np.asarray(collect(moved)).tolist(), "own": np.asarray(local_part(moved)).tolist(),
    "loss": float(parts["loss"]), "none": list(collect(parts["none"]).shape), "error": error,
}))
"""


def run_two(program: str, folder: Path, devices: int = 1) -> list[str]:
    """Output of both processes of a program, which gets the address and its index."""
    path = folder / "program.py"
    path.write_text(program)
    env = os.environ | {"JAX_PLATFORMS": "cpu", "JAX_NUM_CPU_DEVICES": str(devices)}
    argv = [sys.executable, str(path), f"127.0.0.1:{free_port()}"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "env": env}
    started = [subprocess.Popen([*argv, str(i)], **pipes) for i in range(2)]
    return finish(started, 600)


def test_two_processes_share_a_mesh(tmp_path: Path):
    """Four devices of two processes: each part of 8 numbers is doubled, plus the index of its first environment."""
    first, second = (json.loads(out.splitlines()[-1]) for out in run_two(PROGRAM, tmp_path, devices=2))
    whole = (2 * np.arange(8.0) + np.repeat([0, 2, 4, 6], 2)).tolist()
    for told in (first, second):
        assert (told["devices"], told["agreed"], told["loss"]) == (4, 5, 3.5)
        assert told["whole"] == whole
        assert told["none"] == [0, 3]
        assert told["error"].startswith("processes have different numbers of updates: 0, 1")
    assert (first["leader"], second["leader"]) == (True, False)
    assert (first["own"], second["own"]) == (whole[:2], whole[4:6])


def test_one_process_agrees_with_itself():
    assert is_leader()
    assert agree(7) == 7
    check_same(1, "numbers", "")
    tree = {"x": np.ones(3)}
    assert collect(tree) is tree


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (("nowhere",), "coordinator is no address"),
        (("host:99:1", 2, 0), "coordinator is no address"),
        (("127.0.0.1:5000",), "needs the number of processes"),
        (("127.0.0.1:5000", 2, 2), "process must be from 0 to 1, got 2"),
        (("auto",), "cannot connect the processes"),
    ],
)
def test_wrong_arguments_are_refused(given: tuple, said: str, monkeypatch: pytest.MonkeyPatch):
    for name in [name for name in os.environ if name.startswith(("SLURM_", "OMPI_", "KUBERNETES_", "JAX_COORD"))]:
        monkeypatch.delenv(name)
    with pytest.raises(ConfigError, match=said):
        connect(*given)
