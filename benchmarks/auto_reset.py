"""What automatic resets cost: milliseconds per step of a batch in which nobody, some or all end.

    python benchmarks/auto_reset.py --num-envs 4096 [--houses ROOT]

One JSON object a line. Each case is timed in turn, several times over; medians.
"""

import argparse
import json
import statistics
import time

import jax
import jax.numpy as jnp

import home_mjx
from home_mjx.bench.timing import device_name
from home_mjx.tasks import PointNav

CASES = ("plain", "nobody", "some", "all", "some, final images", "all, final images")
PER_STEP = 8  # environments that end in each step of the case `some`


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--num-envs", type=int, default=4096)
    parser.add_argument("--houses")
    parser.add_argument("--steps", type=int, default=20)
    parser.add_argument("--rounds", type=int, default=5)
    args = parser.parse_args()
    cases = {name: prepare(name, args) for name in CASES}
    times: dict[str, list[float]] = {name: [] for name in cases}
    for _ in range(args.rounds):
        for name, case in cases.items():
            times[name].append(run(case, args.steps))
    base = statistics.median(times["nobody"])
    for name, found in times.items():
        value = statistics.median(found)
        record = {"case": f"auto_reset/{name}", "value": round(value, 2), "unit": "ms", "ratio": round(value / base, 3)}
        record |= {"num_envs": args.num_envs, "device": device_name(), "houses": args.houses or "generated"}
        print(json.dumps(record), flush=True)


def prepare(name: str, args: argparse.Namespace) -> dict:
    """A compiled step and its states, those of `some` spread over their episodes so that `PER_STEP` end in each."""
    lengths = {"some": args.num_envs // PER_STEP, "all": 1}
    length = lengths.get(name.partition(",")[0], 10**6)
    # Nobody may end early: the goal is out of reach.
    env = home_mjx.make("PointNav-v0", args.houses, episode_length=length, task=PointNav(success_radius=0.0))
    keys = jax.random.split(jax.random.key(0), args.num_envs)
    actions = jax.random.uniform(jax.random.key(1), (args.num_envs, 4), jnp.float32, -1, 1)
    if name == "plain":
        reset, step = jax.vmap(env.core.reset, (None, 0)), jax.vmap(env.core.step, (None, 0, 0))
    else:
        auto = home_mjx.AutoReset(env.core, "all" if "images" in name else "cheap")
        reset, step = auto.reset, auto.step
    states = jax.jit(reset)(env.params, keys)
    if length > 1:
        age = jnp.arange(args.num_envs, dtype=jnp.int32) // PER_STEP % length
        states = states.replace(world=states.world.replace(step=age * (length < 10**6)))
    step = jax.jit(step)
    states = jax.block_until_ready(step(env.params, states, actions))
    return {"env": env, "step": step, "states": states, "actions": actions}


def run(case: dict, steps: int) -> float:
    """Milliseconds per step."""
    states = case["states"]
    start = time.perf_counter()
    for _ in range(steps):
        states = case["step"](case["env"].params, states, case["actions"])
    jax.block_until_ready(states)
    case["states"] = states
    return 1e3 * (time.perf_counter() - start) / steps


if __name__ == "__main__":
    main()
