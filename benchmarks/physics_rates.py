"""Measure physics alone, by implementation and number of agents: milliseconds per control step of a batch.

    python benchmarks/physics_rates.py [--houses ROOT] [--num-houses 64] [--num-envs 4096] [--with-mjx] [--curves]

Actions are random at each step; 20 steps are one program; medians of five calls. Prints one JSON object per line.
`--curves` adds measurements by number of bodies: with everything asleep and an idle agent, and with falling bodies,
dropped from 1 m at the start of each call.
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
from home_mjx.core.profiling import device_name
from home_mjx.physics import PhysicsSetup, Template

STEPS, CALLS = 20, 5
COUNTS = (0, 1, 2, 4, 8, 16, 32)  # numbers of bodies of the curve
DROP = 1.0  # [m] drop height


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--houses")
    parser.add_argument("--num-houses", type=int, default=64)
    parser.add_argument("--num-envs", type=int, default=4096)
    parser.add_argument("--max-bodies", type=int, default=32)
    parser.add_argument("--curves", action="store_true", help="also measure by number of bodies, at rest and falling")
    parser.add_argument("--with-mjx", action="store_true", help="also measure MJX, which compiles for 20 s")
    args = parser.parse_args()
    options = {"num_houses": args.num_houses, "max_bodies": args.max_bodies, "sensors": ("state",)}
    bank = home_mjx.make("PointNav-v0", args.houses, **options).params.bank
    cases = [(with_bodies(bank, 0, 0), 1, "drawn"), (bank, 1, "drawn"), (bank, 4, "drawn"), (bank, 8, "drawn")]
    for impl in ("kinematic", "fused", *(("jax",) if args.with_mjx else ())):
        for houses, agents, kind in cases + (curve(bank) if args.curves and impl == "fused" else []):
            record = measure(houses, PhysicsSetup(impl=impl, num_agents=agents), args.num_envs, kind)
            record |= {"bodies": houses.spec.num_bodies, "doors": houses.spec.num_doors}
            record |= {"houses": args.houses or f"{bank.num_houses} generated", "device": device_name()}
            print(json.dumps(record), flush=True)


def curve(bank: HouseBank) -> list[tuple[HouseBank, int, str]]:
    """Return cases with other numbers of bodies and agents, at rest or falling."""
    counts = [count for count in COUNTS if count <= bank.spec.num_bodies]
    bodies = [(with_bodies(bank, count, 0), 1, "drawn") for count in counts]
    return [*bodies, (bank, 2, "drawn"), (bank, 1, "rest"), (bank, 1, "falling")]


def with_bodies(bank: HouseBank, bodies: int, doors: int) -> HouseBank:
    """Return the houses with their first bodies and doors only."""
    counts = {"body_": bodies, "door_": doors}
    arrays = {
        name: value[:, :count]
        for prefix, count in counts.items()
        for name, value in vars(bank.physics).items()
        if name.startswith(prefix)
    }
    spec = dataclasses.replace(bank.spec, num_bodies=bodies, num_doors=doors)
    return bank.replace(physics=bank.physics.replace(**arrays), spec=spec)


def measure(bank: HouseBank, config: PhysicsSetup, num_envs: int, kind: str) -> dict:
    """Return the record of one case: random actions, all bodies at rest, or all bodies falling."""
    template, agents = Template(config, bank.spec), config.num_agents
    house = jnp.arange(num_envs) % bank.num_houses
    starts = bank.navigation.start[house][:, jnp.arange(agents) % bank.navigation.start.shape[1]]
    yaw = jnp.zeros((num_envs, agents))
    state = jax.jit(jax.vmap(lambda *args: physics.reset(template, bank, *args)))(house, starts, yaw)
    actions = jax.random.uniform(jax.random.key(1), (STEPS, num_envs, agents, 3), minval=-1.0)
    actions = actions if kind == "drawn" else jnp.zeros_like(actions)
    step = jax.vmap(lambda bank, *args: physics.step(template, bank, *args), (None, 0, 0, 0))

    def walk(bank, state, actions):
        state = dropped(template, state) if kind == "falling" else state
        return jax.lax.scan(lambda state, action: (step(bank, house, state, action), None), state, actions)[0]

    begun = time.perf_counter()
    program = jax.jit(walk).lower(bank, state, actions).compile()
    compiled, times = time.perf_counter() - begun, []
    for _ in range(CALLS + 1):  # the first call is not counted; during it all bodies come to rest
        begun = time.perf_counter()
        state = jax.block_until_ready(program(bank, state, actions))
        times.append((time.perf_counter() - begun) / STEPS)
    seconds = statistics.median(times[1:])
    record = {
        "case": f"physics/{config.impl}",
        "agents": agents,
        "does": kind,
        "num_envs": num_envs,
        "compile_s": round(compiled, 1),
    }
    rate = num_envs / seconds
    record |= {"ms": round(1e3 * seconds, 3), "env_steps_per_s": round(rate)}
    return record | {"physics_steps_per_s": round(rate * config.timing.substeps)}


def dropped(template: Template, state: physics.PhysicsState) -> physics.PhysicsState:
    """Return a state with all bodies `DROP` higher, and awake."""
    height, speed = (
        slice(part.start + 2, part.stop, step)
        for part, step in ((template.layout.body_qpos, 7), (template.layout.body_qvel, 6))
    )
    return state.replace(qpos=state.qpos.at[:, height].add(DROP), qacc=state.qacc.at[:, speed].set(-9.81))


if __name__ == "__main__":
    main()
