"""Measure frames/s of images by shader at walkable places of homes: one JSON object per line, as `home-mjx bench`.

    python benchmarks/light_speed.py procedural:8 --bake     # on any machine: bakes go to $HOME_MJX_CACHE/bakes
    python benchmarks/light_speed.py procedural:8            # on a GPU, with that folder in its cache

Records of the bake are named by content, so that those made on one machine are found on another. The second command
stops if some are missing, unless it has `--bake`, which computes them first. Cameras are at random walkable places of
all homes at 1.5 m, with random yaw and up to 15 degrees of pitch. Times are medians of rounds, after a warm-up, and do
not include compilation.
"""

import argparse
import dataclasses
import json
import os
import sys
import time

os.environ.setdefault("XLA_PYTHON_CLIENT_PREALLOCATE", "false")

import jax
import jax.numpy as jnp
import numpy as np
from gpu_rays import images, scene_of, timed
from views import cameras

from benchmarks.cases.record import make_measurement
from home_mjx.bank.bank import HouseBank
from home_mjx.houses import HouseSet, add_bakes
from home_mjx.houses.bakes import read_record
from home_mjx.light_probes import LightProbeBake
from home_mjx.raycast_render.cameras.camera import Camera

NUM_CAMERAS = {"gpu": 4096, "cpu": 64}  # by default, by backend of JAX
FOV = np.deg2rad(90)
RUNS = {
    "depth+ids": (("depth", "instance", "fine"), "fast"),
    "fast": (("rgb",), "fast"),
    "lit": (("rgb",), "lit"),
    "baked": (("rgb",), "baked"),
}  # image kinds and shader


def baked_bank(houses, may_bake):
    """Return the bank of houses with baked light, of which records on disk are taken; print the time of the others."""
    missing = [house.id for house in houses if read_record(LightProbeBake(), house) is None]
    if missing and not may_bake:
        raise SystemExit(f"{len(missing)} of {len(houses)} bakes are missing, of {missing[0]} for example: use --bake")
    start = time.perf_counter()
    bank = add_bakes(HouseBank.from_compiled(houses), houses, "light_probes", progress=True)
    emit("bake", time.perf_counter() - start, "s", f"{len(houses)} homes, of which {len(missing)} were not on disk")
    return bank


def emit(case, value, unit, note, **given):
    """Print a record."""
    record = make_measurement(f"light/{case}", value, unit, note, **given)
    sys.stdout.write(json.dumps(dataclasses.asdict(record)) + "\n")
    sys.stdout.flush()


def measure(bank, name, size, num_envs):
    """Print the rate of one kind of images."""
    kinds, shader = RUNS[name]
    look, args = images(size, *kinds, shader=shader), tuple(map(jnp.asarray, cameras(bank, num_envs)))

    def one(bank, house, pos, quat):
        """Render one camera."""
        return look(bank, scene_of(bank, house, pos), Camera(pos, quat, jnp.float32(FOV)))

    start = time.perf_counter()
    program = jax.jit(jax.vmap(one, (None, 0, 0, 0))).lower(bank, *args).compile()
    compile_seconds = time.perf_counter() - start
    seconds = timed(program, bank, *args)
    note = f"{size}x{size} at walkable places of {bank.num_houses} homes; {seconds * 1e3:.3f} ms a batch"
    emit(f"{name}-{size}", num_envs / seconds, "frames/s", note, num_envs=num_envs, compile_seconds=compile_seconds)


def main():
    """Parse the command line and measure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("houses", nargs="?", default="procedural:8")
    parser.add_argument("--num-envs", type=int, help="cameras (default: 4096 on a GPU, 64 on a CPU)")
    parser.add_argument("--size", type=int, nargs="+", default=[64, 128], help="edges of images [px]")
    parser.add_argument("--run", nargs="+", default=list(RUNS), choices=list(RUNS))
    parser.add_argument("--bake", action="store_true", help="compute missing bakes")
    args = parser.parse_args()
    num_envs = args.num_envs or NUM_CAMERAS[jax.default_backend()]
    bank = baked_bank(HouseSet(args.houses).load(progress=True), args.bake)
    probes = bank.bakes["light_probes"]
    emit("bytes", sum(x.nbytes for x in jax.tree.leaves(probes)) / bank.num_houses, "B", "baked light per home, padded")
    for size in args.size:
        for name in args.run:
            measure(bank, name, size, num_envs)


if __name__ == "__main__":
    main()
