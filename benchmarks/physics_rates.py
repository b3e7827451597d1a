"""Physics alone, by implementation and number of agents: milliseconds per control step of a batch.

    python benchmarks/physics_rates.py [--houses ROOT] [--num-houses 64] [--num-envs 4096] [--with-mjx]

Actions are drawn at each step; 20 steps are one program; medians of five calls. One JSON object a line.
"""

import argparse
import dataclasses
import json
import statistics
import time

import jax
import jax.numpy as jnp

import home_mjx
from home_mjx import HouseBank, physics
from home_mjx.bench.timing import device_name
from home_mjx.physics import PhysicsConfig, Template

STEPS, CALLS = 20, 5


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--houses")
    parser.add_argument("--num-houses", type=int, default=64)
    parser.add_argument("--num-envs", type=int, default=4096)
    parser.add_argument("--max-bodies", type=int, default=32)
    parser.add_argument("--with-mjx", action="store_true", help="MJX as well; it compiles for 20 s")
    args = parser.parse_args()
    options = {"num_houses": args.num_houses, "max_bodies": args.max_bodies, "sensors": ("state",)}
    bank = home_mjx.make("PointNav-v0", args.houses, **options).params.bank
    for impl in ("kinematic", "fused", *(("jax",) if args.with_mjx else ())):
        for houses, agents in ((without_bodies(bank), 1), (bank, 1), (bank, 4), (bank, 8)):
            record = measure(houses, PhysicsConfig(impl=impl, num_agents=agents), args.num_envs)
            record |= {"bodies": houses.spec.num_bodies, "houses": args.houses or f"{bank.num_houses} generated"}
            print(json.dumps(record | {"device": device_name()}), flush=True)


def without_bodies(bank: HouseBank) -> HouseBank:
    """The houses without movable bodies and doors."""
    arrays = {name: value[:, :0] for name, value in vars(bank.physics).items() if name.startswith(("body_", "door_"))}
    spec = dataclasses.replace(bank.spec, num_bodies=0, num_doors=0)
    return bank.replace(physics=bank.physics.replace(**arrays), spec=spec)


def measure(bank: HouseBank, config: PhysicsConfig, num_envs: int) -> dict:
    """The record of one case."""
    template, agents = Template(config, bank.spec), config.num_agents
    house = jnp.arange(num_envs) % bank.num_houses
    starts = bank.navigation.start[house][:, jnp.arange(agents) % bank.navigation.start.shape[1]]
    yaw = jnp.zeros((num_envs, agents))
    state = jax.jit(jax.vmap(lambda *args: physics.reset(template, bank, *args)))(house, starts, yaw)
    actions = jax.random.uniform(jax.random.key(1), (STEPS, num_envs, agents, 3), minval=-1.0)
    step = jax.vmap(lambda bank, *args: physics.step(template, bank, *args), (None, 0, 0, 0))

    def walk(bank, state, actions):
        return jax.lax.scan(lambda state, action: (step(bank, house, state, action), None), state, actions)[0]

    begun = time.perf_counter()
    program = jax.jit(walk).lower(bank, state, actions).compile()
    compiled, times = time.perf_counter() - begun, []
    for _ in range(CALLS + 1):  # the first one is not counted
        begun = time.perf_counter()
        state = jax.block_until_ready(program(bank, state, actions))
        times.append((time.perf_counter() - begun) / STEPS)
    seconds = statistics.median(times[1:])
    record = {"case": f"physics/{config.impl}", "agents": agents, "num_envs": num_envs, "compile_s": round(compiled, 1)}
    rate = num_envs / seconds
    record |= {"ms": round(1e3 * seconds, 3), "env_steps_per_s": round(rate)}
    return record | {"physics_steps_per_s": round(rate * config.timing.substeps)}


if __name__ == "__main__":
    main()
