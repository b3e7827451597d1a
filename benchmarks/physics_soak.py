"""Soak of the physics: agents do their worst in many houses, and every step is looked at.

    python benchmarks/physics_soak.py [--houses ROOT] [--num-houses 1000] [--num-envs 4096] [--steps 2500]

Four kinds of agents, a quarter of the environments each: actions drawn at each step, actions held for two seconds,
agents that chase the nearest body, and agents that drive at full speed and turn when they touch something. Looked for
after every step: numbers that are not finite, agents and bodies outside of the house or below its floor, depths of
agents and bodies in static boxes, lost contacts. Depths come from a formula of their own (the separating axis
theorem), not from the contacts. One JSON object a line; failures name kind, environment, house, step and mobile.
"""

import argparse
import functools
import json
import time
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

import home_mjx
from home_mjx import HouseBank, physics
from home_mjx.bench.timing import device_name
from home_mjx.core.transforms import quat_matrix
from home_mjx.physics import PhysicsConfig, PhysicsState, Template
from home_mjx.schema.timing import Timing

KINDS = ("drawn", "held", "chases", "turns")
DEEP = 0.02  # [m], that may not last longer than one step
WORST = 10  # failures that are printed


class Seen(NamedTuple):
    """Of every environment so far."""

    depth: jax.Array  # (e m) [m], deepest
    deep: jax.Array  # (e m) steps on end deeper than DEEP
    longest: jax.Array  # (e m) most of them
    when: jax.Array  # (e m) step of the deepest
    outside: jax.Array  # (e m) steps outside of the house
    below: jax.Array  # (e m) steps below the floor
    broken: jax.Array  # (e) steps that were not finite
    lost: jax.Array  # (e) steps in which contacts were lost


def main() -> None:
    """Runs and prints."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--houses")
    parser.add_argument("--num-houses", type=int, default=1000)
    parser.add_argument("--num-envs", type=int, default=4096)
    parser.add_argument("--steps", type=int, default=2500)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--impl", default="fused")
    parser.add_argument("--sim-dt", type=float, default=Timing().sim_dt)
    args = parser.parse_args()
    bank = home_mjx.make("PointNav-v0", args.houses, num_houses=args.num_houses, sensors=("state",)).params.bank
    template = Template(PhysicsConfig(impl=args.impl, timing=Timing(sim_dt=args.sim_dt)), bank.spec)
    begun = time.perf_counter()
    house, seen = soak(template, bank, args.num_envs, args.steps, args.seed)
    record = {"case": f"physics_soak/{args.impl}", "houses": args.houses or "generated", "num_houses": bank.num_houses}
    record |= {"agent_steps": args.num_envs * args.steps, "seconds": round(time.perf_counter() - begun, 1)}
    print(json.dumps(record | {"seed": args.seed, "sim_dt": args.sim_dt, "device": device_name()}), flush=True)
    report(np.asarray(house), jax.tree.map(np.asarray, seen))


def soak(template: Template, bank: HouseBank, num_envs: int, steps: int, seed: int) -> tuple[jax.Array, Seen]:
    """The houses of the environments, and what was seen."""
    kind = jnp.arange(num_envs) % len(KINDS)
    house = jnp.arange(num_envs) // len(KINDS) % bank.num_houses
    key = jax.random.key(seed)
    pick = jax.random.randint(key, (num_envs,), 0, bank.navigation.start.shape[1])
    state = jax.vmap(functools.partial(physics.reset, template, bank))(
        house, bank.navigation.start[house, pick][:, None], jnp.zeros((num_envs, 1))
    )
    mobiles = 1 + bank.spec.num_bodies
    none, zero = jnp.zeros((num_envs, mobiles), jnp.int32), jnp.zeros(num_envs, jnp.int32)
    seen = Seen(none.astype(jnp.float32), none, none, none, none, none, zero, zero)
    actions = jnp.zeros((num_envs, 1, 3))

    def one(bank: HouseBank, carry: tuple, at: jax.Array) -> tuple[tuple, None]:
        state, seen, actions = carry
        actions = jax.vmap(functools.partial(choose, template))(
            jax.random.split(jax.random.fold_in(key, at), num_envs), kind, jnp.full(num_envs, at), state, actions
        )
        advance = functools.partial(physics.step_checked, template, bank)
        state, lost = jax.vmap(advance)(house, state, actions)
        return (state, look(template, bank, house, state, lost, seen, at), actions), None

    run = jax.jit(lambda bank, carry: jax.lax.scan(functools.partial(one, bank), carry, jnp.arange(steps))[0])
    return house, jax.block_until_ready(run(bank, (state, seen, actions)))[1]


def choose(template: Template, key: jax.Array, kind: jax.Array, at: jax.Array, state: PhysicsState, before: jax.Array):
    """An agent's next action."""
    drawn = jax.random.uniform(key, (1, 3), minval=-1.0)
    extreme = jnp.sign(drawn)
    held = jnp.where(at % 20 == 0, extreme, before)
    pos, yaw = physics.agent_pose(template, state)
    bodies = physics.body_pose(template, state)[0]
    away = bodies[:, :2] - pos[0, :2]
    nearest = away[jnp.argmin(jnp.sum(away**2, axis=-1))] if len(bodies) else jnp.ones(2)
    cos, sin = jnp.cos(yaw[0]), jnp.sin(yaw[0])
    ahead = jnp.stack([cos * nearest[0] + sin * nearest[1], cos * nearest[1] - sin * nearest[0]])
    chases = jnp.concatenate([jnp.clip(3 * ahead, -1, 1), jnp.clip(jnp.arctan2(ahead[1], ahead[0])[None], -1, 1)])[None]
    touching = physics.agent_contact(template, state)[0]
    straight = jnp.array([[1.0, 0.0, 0.0]])
    turns = jnp.where(touching & (at % 30 < 10), before.at[0, 2].set(extreme[0, 2]), straight)
    return jnp.stack([drawn, held, chases, turns])[kind]


def look(template: Template, bank: HouseBank, house: jax.Array, state: PhysicsState, lost, seen: Seen, at) -> Seen:
    """What was seen after another step."""
    depth, outside, below = jax.vmap(functools.partial(look_at, template, bank))(house, state)
    deep = jnp.where(depth > DEEP, seen.deep + 1, 0)
    return Seen(
        depth=jnp.maximum(seen.depth, depth),
        deep=deep,
        longest=jnp.maximum(seen.longest, deep),
        when=jnp.where(depth > seen.depth, at, seen.when),
        outside=seen.outside + outside,
        below=seen.below + below,
        broken=seen.broken + jax.vmap(physics.is_broken)(state),
        lost=seen.lost + functools.reduce(jnp.logical_or, jax.tree.leaves(lost)),
    )


def look_at(template: Template, bank: HouseBank, house: jax.Array, state: PhysicsState):
    """Of each mobile of an environment: depth in static boxes [m], whether it is outside, whether below the floor."""
    arrays = jax.tree.map(lambda x: x[house], bank.physics)
    body = template.config.body
    agent_pos, _ = physics.agent_pose(template, state)
    body_pos, body_quat = physics.body_pose(template, state)
    middle = jnp.concatenate([agent_pos, body_pos])
    axes = jax.vmap(quat_matrix)(jnp.concatenate([jnp.array([[1.0, 0, 0, 0]]), body_quat]))
    # An agent is round: its box is what lies within its radius along every direction.
    half = jnp.concatenate([jnp.array([[body.radius, body.radius, body.height / 2]]), arrays.body_size])
    used = jnp.concatenate([jnp.ones(1, bool), arrays.body_valid])
    rises = arrays.collider_pos[:, 2] + arrays.collider_size[:, 2] > arrays.floor + 0.01
    others = jax.vmap(quat_matrix)(arrays.collider_quat)

    each = jax.vmap(jax.vmap(overlap, (None, None, None, 0, 0, 0)), (0, 0, 0, None, None, None))
    depths = each(middle, axes, half, arrays.collider_pos, others, arrays.collider_size)
    capsule = jax.vmap(functools.partial(capsule_depth, body), (None, 0, 0, 0))
    agent = capsule(agent_pos[0], arrays.collider_pos, others, arrays.collider_size)
    depths = jnp.where(rises[None], depths.at[0].set(agent), 0.0)
    depth = jnp.where(used, jnp.maximum(depths.max(axis=1), 0.0), 0.0)
    real = (arrays.collider_pos[:, 2] > -50) & rises
    low = jnp.where(real[:, None], arrays.collider_pos - arrays.collider_size, jnp.inf).min(axis=0)
    high = jnp.where(real[:, None], arrays.collider_pos + arrays.collider_size, -jnp.inf).max(axis=0)
    outside = used & jnp.any((middle[:, :2] < low[:2]) | (middle[:, :2] > high[:2]), axis=1)
    bottom = middle[:, 2] - jnp.concatenate([half[:1, 2], jnp.sum(jnp.abs(axes[1:, 2]) * half[1:], axis=1)])
    return depth, outside, used & (bottom < arrays.floor - DEEP)


def overlap(pos, axes, half, other_pos, other_axes, other_half):
    """How far two boxes would have to be moved apart along the best of the 15 separating axes [m]."""
    # Sums of products: XLA's small matrix products are slow on CPUs.
    between, no = other_pos - pos, jnp.float32(1e-3)
    crosses = jnp.cross(axes.T[:, None], other_axes.T[None]).reshape(9, 3)
    length = jnp.linalg.norm(crosses, axis=1)
    along = jnp.concatenate([axes.T, other_axes.T, crosses / jnp.maximum(length, no)[:, None]])  # (15, 3)
    own = jnp.sum(jnp.abs(jnp.sum(along[:, :, None] * axes, axis=1)) * half, axis=1)
    other = jnp.sum(jnp.abs(jnp.sum(along[:, :, None] * other_axes, axis=1)) * other_half, axis=1)
    over = own + other - jnp.abs(jnp.sum(along * between, axis=1))
    return jnp.where(jnp.concatenate([jnp.ones(6, bool), length > no]), over, jnp.inf).min()


def capsule_depth(body, pos, box_pos, box_axes, box_half):
    """How deep an upright capsule is in a box [m]: its radius less the distance of points on its axis."""
    heights = jnp.linspace(-1, 1, 33) * (body.height / 2 - body.radius)
    points = pos[None] + heights[:, None] * jnp.array([0.0, 0.0, 1.0])
    local = jnp.sum((points - box_pos)[:, :, None] * box_axes, axis=1)
    beyond = jnp.linalg.norm(jnp.maximum(jnp.abs(local) - box_half, 0.0), axis=-1)
    inside = (box_half - jnp.abs(local)).min(axis=-1)
    return jnp.max(jnp.where(beyond > 0, body.radius - beyond, body.radius + inside))


def report(house: np.ndarray, seen: Seen) -> None:
    """Prints totals of each kind of agent, and the worst failures."""
    for number, kind in enumerate(KINDS):
        part = jax.tree.map(lambda x, n=number: x[n :: len(KINDS)], seen)
        record = {"kind": kind, "environments": len(part.depth), "not finite": int((part.broken > 0).sum())}
        record |= {"lost contacts": int(part.lost.sum())}
        for name, columns in (("agents", slice(0, 1)), ("bodies", slice(1, None))):
            depth = part.depth[:, columns]
            record[name] = {
                "outside": int((part.outside[:, columns] > 0).sum()),
                "below the floor": int((part.below[:, columns] > 0).sum()),
                "deepest [m]": round(float(depth.max()), 4),
                "deeper than 2 cm": int((depth > DEEP).sum()),
                "longer than a step": int((part.longest[:, columns] > 1).sum()),
                "share": round(float((part.longest[:, columns] > 1).mean()), 6),
            }
        print(json.dumps(record), flush=True)
    order = np.argsort(-(seen.depth + 10 * (seen.outside > 0) + 10 * (seen.below > 0)), axis=None)[:WORST]
    for env, mobile in zip(*np.unravel_index(order, seen.depth.shape), strict=True):
        found = {"kind": KINDS[env % len(KINDS)], "env": int(env), "house": int(house[env]), "mobile": int(mobile)}
        found |= {name: round(float(getattr(seen, name)[env, mobile]), 4) for name in ("depth", "when", "longest")}
        found |= {name: int(getattr(seen, name)[env, mobile]) for name in ("outside", "below")}
        print(json.dumps(found), flush=True)


if __name__ == "__main__":
    main()
