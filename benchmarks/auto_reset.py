"""Measure the cost of automatic resets: milliseconds per step of a batch in which no, few or all environments end.

    python benchmarks/auto_reset.py [--num-envs 4096] [--houses ROOT]

Prints one JSON object per line. A program is called with the same states repeatedly, so that only the number of ended
episodes differs. Cases alternate, and medians are reported.
"""

import argparse
import json
import statistics
import time

import jax
import jax.numpy as jnp

import home_mjx
from home_mjx.core.profiling import device_name
from home_mjx.tasks import Env
from home_mjx.tasks.suite import PointNav

LENGTH = 500  # length of an episode [steps]
FEW = 8  # environments whose episode ends


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--num-envs", type=int, default=4096)
    parser.add_argument("--houses")
    parser.add_argument("--calls", type=int, default=10)
    parser.add_argument("--rounds", type=int, default=7)
    args = parser.parse_args()
    # The goal's radius is zero, so that no episode ends by chance.
    env = home_mjx.make("PointNav-v0", args.houses, episode_length=LENGTH, task=PointNav(success_distance=0.0))
    cases = prepare(env, args.num_envs)
    times: dict[str, list[float]] = {name: [] for name in cases}
    for _ in range(args.rounds):
        for name, (step, states, actions) in cases.items():
            times[name].append(milliseconds(lambda: step(env.params, states, actions), args.calls))  # noqa: B023
    base = statistics.median(times["nobody"])
    for name, found in times.items():
        value = statistics.median(found)
        record = {"case": f"auto_reset/{name}", "value": round(value, 2), "unit": "ms", "ratio": round(value / base, 3)}
        record |= {"num_envs": args.num_envs, "device": device_name(), "houses": args.houses or "generated"}
        print(json.dumps(record), flush=True)


def prepare(env: Env, num_envs: int) -> dict:
    """Return compiled steps with the initial states of each case."""
    keys = jax.random.split(jax.random.key(0), num_envs)
    actions = jax.random.uniform(jax.random.key(1), (num_envs, 4), jnp.float32, -1, 1)
    cheap, full = home_mjx.AutoReset(env.core), home_mjx.AutoReset(env.core, "all")
    states = jax.jit(full.reset)(env.params, keys)
    plain, step, rendered = jax.jit(jax.vmap(env.core.step, (None, 0, 0))), jax.jit(cheap.step), jax.jit(full.step)
    states = jax.block_until_ready(plain(env.params, states.replace(info={}), actions))
    programs = {"": step, ", last images": rendered}
    ended = {"nobody": 0, "a few": FEW, "all": num_envs}
    cases = {"plain": (plain, states, actions)}
    for suffix, program in programs.items():
        for name, count in ended.items():
            age = jnp.where(jnp.arange(num_envs) < count, LENGTH - 1, 0).astype(jnp.int32)
            cases[name + suffix] = program, states.replace(world=states.world.replace(step=age)), actions
    for program, begin, _ in cases.values():
        jax.block_until_ready(program(env.params, begin, actions))
    return cases


def milliseconds(call: object, count: int) -> float:
    """Measure the time of one call [ms]."""
    start = time.perf_counter()
    for _ in range(count):
        result = call()  # type: ignore[operator]
    jax.block_until_ready(result)
    return 1e3 * (time.perf_counter() - start) / count


if __name__ == "__main__":
    main()
