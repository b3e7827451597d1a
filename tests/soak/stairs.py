"""Who walks in homes with stairs stays on floors and stairs, whatever it does, in every implementation.

    python tests/soak/stairs.py [--homes N] [--envs N] [--steps N] [--seed N] [--impl NAME]

Homes of 2 and 3 storeys, drawn at random with their implementation (kinematic or fused, if none is named). Agents walk
at random, hold extreme actions, or go from goal to goal down the distance field, so that they take the stairs. After
every step: the feet are on a surface of the grids, in a room, and have risen or sunk by no more than stairs would have
it for the way in the plan. One JSON object; exits with 1 if something did not hold, and prints where.
"""

import argparse
import json
import os
import secrets
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
if __name__ == "__main__":
    sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "helpers")]
    os.environ.setdefault("JAX_PLATFORMS", "cpu")

import jax  # noqa: E402
import jax.numpy as jnp  # noqa: E402
import numpy as np  # noqa: E402

FAULTS = "gap", "outside", "rise", "nan"
KINDS = 3  # of agents: at random, held, from goal to goal
GAP = 0.15  # [m], of feet above or below the floor or ramp under them: a foot is round
STEEPEST = 1.2  # of stairs: rise per way in the plan
SETTLES = 0.06  # [m], by which a step's height may differ beside that
CHUNK = 50  # steps of one call
SHOWN = 20


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs and prints."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--homes", type=int, default=6)
    parser.add_argument("--envs", type=int, default=96)
    parser.add_argument("--steps", type=int, default=100_000, help="steps of all environments together")
    parser.add_argument("--seed", type=int, default=secrets.randbelow(1000), help="of homes and walks; default: drawn")
    parser.add_argument("--impl", choices=["kinematic", "fused", "c", "jax"])
    args = parser.parse_args(arguments)
    rng = np.random.default_rng(args.seed)
    impl = args.impl or str(rng.choice(["kinematic", "fused"]))
    begun = time.perf_counter()
    bank = homes(args.seed, args.homes)
    found = soak(bank, impl, args.envs, -(-args.steps // args.envs), rng)
    record = {"case": f"stairs/{impl}", "seed": args.seed, "storeys": storeys(bank), **found[0]}
    print(json.dumps(record | {"seconds": round(time.perf_counter() - begun, 1)}))
    for fault in found[1][:SHOWN]:
        print(fault, file=sys.stderr)
    return int(bool(found[1]))


def homes(seed: int, count: int) -> Any:
    """A bank of generated homes with stairs."""
    from home_mjx import HouseBank
    from home_mjx.houses.house_set import HouseSet
    from home_mjx.houses.selection import HouseFilter

    name = f"procedural:{4 * count}?seed={100_000 + 1000 * seed}"
    chosen = HouseSet(name, num_houses=count, filter=HouseFilter(levels=(2, 3)))
    return HouseBank.from_compiled(chosen.load())


def storeys(bank: Any) -> list[int]:
    """How many storeys each home has."""
    return np.isfinite(np.asarray(bank.navigation.floor)).sum(axis=1).tolist()


def soak(bank: Any, impl: str, num_envs: int, steps: int, rng: np.random.Generator) -> tuple[dict, list[dict]]:
    """Steps on; what was seen, and what did not hold."""
    from home_mjx import physics
    from home_mjx.physics import PhysicsConfig, Template, agent_pose

    template = Template(PhysicsConfig(impl=impl), bank.spec)
    half = template.config.agents[0].height / 2
    house = jnp.asarray(np.arange(num_envs) % bank.num_houses, jnp.int32)
    first = rng.integers(bank.navigation.start.shape[1], size=num_envs)
    kind = jnp.asarray(np.arange(num_envs) // bank.num_houses % KINDS)
    start = bank.navigation.start[house, first]
    state = jax.vmap(lambda h, p: physics.reset(template, bank, h, p[None], jnp.zeros(1)))(house, start)

    def one(house, kind, state, goal, drawn, change):
        pos, yaw = (x[0] for x in agent_pose(template, state))
        feet = pos.at[2].add(-half)
        way = downhill(bank, house, goal, feet)
        turn = (jnp.arctan2(way[1], way[0]) - yaw + jnp.pi) % (2 * jnp.pi) - jnp.pi
        walk = jnp.stack([jnp.where(jnp.abs(turn) < 0.6, 1.0, 0.0), jnp.float32(0), jnp.clip(turn / 0.157, -1, 1)])
        action = jnp.stack([drawn, jnp.sign(drawn), walk])[kind]
        state = physics.step(template, bank, house, state, action[None])
        after = agent_pose(template, state)[0][0].at[2].add(-half)
        gap, room = surface(bank, house, after)
        rise, plan = jnp.abs(after[2] - feet[2]), jnp.linalg.norm((after - feet)[:2])
        wrong = jnp.stack(
            [jnp.abs(gap) > GAP, room < 0, rise > STEEPEST * plan + SETTLES, ~jnp.all(jnp.isfinite(after))]
        )
        there = jnp.linalg.norm(after - bank.navigation.goal[house, goal]) < 0.4
        return state, jnp.where(there | change, change_of(goal, bank), goal), wrong, after

    @jax.jit
    def run(state, goal, drawn, change):
        def step(carry, x):
            state, goal, wrong, after = jax.vmap(one)(house, kind, *carry, *x)
            return (state, goal), (wrong, after)

        return jax.lax.scan(step, (state, goal), (drawn, change))

    goal = jnp.asarray(rng.integers(bank.navigation.goal.shape[1], size=num_envs), jnp.int32)
    faults, levels = [], np.zeros((num_envs, bank.navigation.floor.shape[1]), bool)
    floor = np.asarray(bank.navigation.floor)[np.asarray(house)]
    for chunk in range(-(-steps // CHUNK)):
        drawn = rng.uniform(-1, 1, (CHUNK // 10, num_envs, 3)).astype(np.float32).repeat(10, axis=0)
        drawn[..., 0] = abs(drawn[..., 0])
        change = rng.random((CHUNK, num_envs)) < 0.003
        (state, goal), (wrong, after) = run(state, goal, jnp.asarray(drawn), jnp.asarray(change))
        wrong, after = np.asarray(wrong), np.asarray(after)
        levels |= (abs(after[..., 2:] - floor) < 0.1).any(axis=0)
        faults += [
            {"fault": FAULTS[k], "env": int(e), "house": int(house[e]), "kind": int(kind[e]),
             "step": chunk * CHUNK + int(t), "feet": after[t, e].round(3).tolist()}
            for t, e, k in np.argwhere(wrong)
        ]  # fmt: skip
    climbed = int((levels.sum(axis=1) > 1).sum())
    return {"env_steps": num_envs * CHUNK * -(-steps // CHUNK), "climbed": climbed, "faults": len(faults)}, faults


def change_of(goal: Any, bank: Any) -> Any:
    """Another goal of the house."""
    return (goal + 7) % bank.navigation.goal.shape[1]


def downhill(bank: Any, house: Any, goal: Any, feet: Any) -> Any:
    """Direction in the plan to the neighbouring cell that is nearest to the goal."""
    from home_mjx.navigation.grid import cell_at_feet, continue_levels, grid_position, is_home_cell, row_of_cell

    place = cell_at_feet(bank, house, feet)
    numbers = bank.navigation.cell[house]
    place = bank.navigation.cell_coords[row_of_cell(numbers[place[0], place[1], place[2]])].astype(jnp.int32)
    offsets = jnp.asarray([(0, y, x) for y in range(-2, 3) for x in range(-2, 3)], jnp.int32)
    around = jnp.clip(place[None] + offsets, 0, jnp.asarray(numbers.shape, jnp.int32)[None] - 1)
    around = continue_levels(bank, house, place, around)
    cell = numbers[around[:, 0], around[:, 1], around[:, 2]]
    far = bank.navigation.field[row_of_cell(cell), goal].astype(jnp.int32)
    best = around[jnp.argmin(jnp.where(is_home_cell(bank, house, cell), far, 1 << 20))]
    return (grid_position(bank, house, best) - feet)[:2]


def surface(bank: Any, house: Any, feet: Any) -> tuple[Any, Any]:
    """Height of the feet above the cell on which they are, and its room."""
    from home_mjx.navigation.grid import cell_at_feet, grid_position

    cell = cell_at_feet(bank, house, feet)
    return feet[2] - grid_position(bank, house, cell)[2], bank.navigation.room[house, cell[0], cell[1], cell[2]]


if __name__ == "__main__":
    sys.exit(main())
