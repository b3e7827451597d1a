"""Memory stays flat however long environments are stepped, seen, heard and begun anew.

    python tests/soak/memory.py [--houses N] [--envs N] [--seconds S] [--seed N] [--sensors NAME ...] [--impl NAME]

Agents act at random, with auto-reset and short episodes; observations come to the host. Now and then all environments
begin anew from other keys, and the houses of a `HouseStream` are exchanged. The memory of the process, and of the GPU
if there is one, is noted after every stretch of steps. The first quarter of the time does not count: allocators fill.
One JSON object, and one on stderr every 20 s. A quarter of the looks takes what nine of ten do not fall below: in some
of them a house is on its way to its slot. Exits with 1 if the last quarter takes 1 % more than the second one.
"""

import argparse
import json
import os
import resource
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
if __name__ == "__main__":
    sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "helpers")]
    os.environ.setdefault("JAX_PLATFORMS", "cpu")

import jax  # noqa: E402
import numpy as np  # noqa: E402

MOST = 0.01  # share by which memory may grow
LEAST = 10  # [%] of the looks of a quarter
STRETCH = 50  # steps between two looks
ANEW = 5  # looks between two times that all begins anew
TOLD = 20.0  # [s] between two words of how it goes


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs and prints."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--houses", type=int, default=8)
    parser.add_argument("--envs", type=int, default=64)
    parser.add_argument("--seconds", type=float, default=400)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--sensors", nargs="+", default=["depth", "audio", "state", "goal"])
    parser.add_argument("--impl", default="fused")
    args = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder:
        record = soak(Path(folder), args)
    print(json.dumps(record))
    return int(record["failed"])


def soak(folder: Path, args: argparse.Namespace) -> dict[str, object]:
    """Steps for as long as is wanted; what memory did."""
    from home_mjx import AutoReset, EnvParams, HouseholdEnv, HouseStream
    from home_mjx.tasks import make_config
    from home_procgen import generate_dataset

    seeds = range(args.seed * 1000, args.seed * 1000 + args.houses)
    ids = generate_dataset(folder, seeds, preset="flat")
    config = make_config(sensors=tuple(args.sensors), impl=args.impl, episode_length=100, width=32, height=32)
    env, rng, looks, steps = AutoReset(HouseholdEnv(config)), np.random.default_rng(args.seed), [], 0
    reset, step = jax.jit(env.reset), jax.jit(env.step)
    with HouseStream(folder, ids, num_slots=max(2, args.houses // 2), bakes=env.bakes) as stream:
        begun = told = time.monotonic()
        while time.monotonic() - begun < args.seconds or len(looks) < 8:
            if len(looks) % ANEW == 0:
                keys = jax.random.split(jax.random.key(int(rng.integers(1 << 30))), args.envs)
                states = reset(EnvParams(stream.bank), keys)
            for _ in range(STRETCH):
                actions = rng.uniform(-1, 1, (args.envs, *env.action_spec.shape)).astype(np.float32)
                states = step(EnvParams(stream.advance(states.world.house)), states, actions)
                jax.device_get(states.obs)
            begun = begun if looks else time.monotonic()  # what compiles does not count
            looks.append(memory())
            steps += STRETCH * args.envs
            if time.monotonic() - told > TOLD:
                told = time.monotonic()
                print(json.dumps({"env_steps": steps, "bytes": looks[-1]}), file=sys.stderr, flush=True)
        swaps = stream.num_swaps
    counts = {"case": "memory", "seed": args.seed, "env_steps": steps, "swaps": swaps}
    return {**counts, **judged(looks), "seconds": round(time.monotonic() - begun, 1)}


def judged(looks: Sequence[tuple[int, int]]) -> dict[str, float]:
    """[MiB] of process and GPU in the end, the share by which they grew, and whether one of them is too much."""
    quarter = len(looks) // 4
    early, late = (np.percentile(looks[at : at + quarter], LEAST, axis=0) for at in (quarter, len(looks) - quarter))
    found: dict[str, float] = {"failed": 0}
    for name, first, last in zip(("process", "device"), early, late, strict=True):
        if last:
            found |= {f"{name}_mib": round(last / 2**20, 1), f"{name}_growth": round(last / max(first, 1) - 1, 5)}
            found["failed"] |= int(last > (1 + MOST) * first)
    return found


def memory() -> tuple[int, int]:
    """[bytes] of the process, and of the GPU's arrays (0 without one)."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    device = jax.devices()[0].memory_stats() or {}
    return pages * resource.getpagesize(), int(device.get("bytes_in_use", 0))


if __name__ == "__main__":
    sys.exit(main())
