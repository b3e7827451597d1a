"""Soak test of the physics: adversarial agents in many houses, with checks after every step.

    python benchmarks/physics_soak.py [--houses ROOT] [--num-houses 1000] [--num-envs 4096] [--steps 2500]

Six kinds of agents alternate over the environments:

- random actions at each step;
- actions held for two seconds;
- agents that chase the nearest object;
- agents that drive at full speed and turn after a contact;
- agents that pick up and throw objects, which creates heaps;
- agents that swing nearby doors and walk into them.

Doors start at random angles. Each step is checked for non-finite numbers, dropped contacts and penetration depths
(`soak_look.py`), and for dynamic bodies outside of the house or with their centre below its floor. Prints one JSON
object per line; failures name kind, environment, house, step and body, and the same arguments repeat them.

Bouncing bodies can be deep at the ends of two steps and free in between. So a step with a deep body at its start or end
is repeated physics step by physics step, which measures the duration.
"""

import argparse
import dataclasses
import functools
import json
import math
import time
from collections.abc import Sequence
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from soak_look import Boxes, boxes, look
from tqdm import tqdm

import home_mjx
from home_mjx import HouseBank, physics
from home_mjx.core.profiling import device_name
from home_mjx.navigation import door_angles
from home_mjx.physics import HandCommands, PhysicsSetup, PhysicsState, Template
from home_mjx.physics.base.doors import DoorLeaves
from home_mjx.schema.timing import Timing

KINDS = ("drawn", "held", "chases", "turns", "throws", "doors")
DEEP = 0.02  # [m] depth that must not last longer than one step
WORST = 12  # maximum number of printed failures
CHUNK = 64  # number of environments that are repeated in one batch


class Seen(NamedTuple):
    """Statistics of every environment's dynamic bodies so far; `[0]` in the house, `[1]` in other dynamic bodies."""

    now: np.ndarray  # (2, e, m) [m], current depth
    depth: np.ndarray  # (2, e, m) [m], maximum depth
    deep: np.ndarray  # (2, e, m) consecutive physics steps deeper than DEEP
    longest: np.ndarray  # (2, e, m) maximum of `deep` over spans that include a step's start or end
    when: np.ndarray  # (2, e, m) step of the maximum depth
    outside: np.ndarray  # (e, m) steps outside of the house
    below: np.ndarray  # (e, m) steps below the floor
    broken: np.ndarray  # (e) steps with non-finite numbers
    lost: np.ndarray  # (e) steps with dropped contacts


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--houses")
    parser.add_argument("--num-houses", type=int, default=1000)
    parser.add_argument("--num-envs", type=int, default=4096)
    parser.add_argument("--num-agents", type=int, default=1)
    parser.add_argument("--steps", type=int, default=2500)
    parser.add_argument(
        "--seconds", type=float, default=math.inf, help="time limit [s]; the number of completed steps is reported"
    )
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--impl", default="fused")
    parser.add_argument("--sim-dt", type=float, default=Timing().sim_dt)
    args = parser.parse_args()
    bank = home_mjx.make("PointNav-v0", args.houses, num_houses=args.num_houses, sensors=("state",)).params.bank
    timing = Timing(sim_dt=args.sim_dt)
    template = Template(PhysicsSetup(impl=args.impl, timing=timing, num_agents=args.num_agents), bank.spec)
    begun = time.perf_counter()
    house, seen, steps = soak(template, bank, args.num_envs, args.steps, args.seed, args.seconds)
    record = {"case": f"physics_soak/{args.impl}", "houses": args.houses or "generated", "num_houses": bank.num_houses}
    record |= {"agent_steps": args.num_envs * args.num_agents * steps, "num_agents": args.num_agents}
    record |= {"seconds": round(time.perf_counter() - begun, 1), "seed": args.seed, "sim_dt": args.sim_dt}
    print(json.dumps(record | {"device": device_name()}), flush=True)
    report(house, seen, template)


def soak(
    template: Template, bank: HouseBank, num_envs: int, steps: int, seed: int, seconds: float = math.inf
) -> tuple[np.ndarray, Seen, int]:
    """Return the houses of the environments, the statistics, and the number of steps."""
    kind = jnp.arange(num_envs) % len(KINDS)
    house = jnp.arange(num_envs) // len(KINDS) % bank.num_houses
    keys = jax.random.split(jax.random.key(seed), num_envs)
    state = jax.jit(jax.vmap(functools.partial(start, template, bank)))(house, keys)
    actions = jnp.zeros((num_envs, template.layout.num_agents, 3))
    # The bank is an argument, because a closure would compile it into the program.
    advance = jax.jit(jax.vmap(functools.partial(one, template), (None, 0, 0, 0, 0, 0, None)), donate_argnums=(4, 5))
    look_between = jax.jit(functools.partial(between, template))
    looker = Looker(template, bank, np.asarray(house))
    end = math.inf
    for at in tqdm(range(steps), desc="soak", unit="step", mininterval=2):
        end = time.perf_counter() + seconds if at == 1 else end  # without compilation
        if time.perf_counter() > end:
            steps = at
            break
        begun, state, actions, broken, lost = advance(bank, house, keys, kind, state, actions, jnp.int32(at))
        before = looker.seen.now.copy()
        looker.add(at, np.asarray(state.qpos), np.asarray(state.qvel), np.asarray(broken), np.asarray(lost))
        deep = np.any(np.maximum(before, looker.seen.now) > DEEP, axis=(0, 2))
        looker.seen.deep[:, ~deep] = 0
        for first in range(0, deep.sum(), CHUNK):
            # Padded to a fixed number by repetition, because another number would compile again.
            some = np.resize(np.flatnonzero(deep)[first : first + CHUNK], CHUNK)
            looks = look_between(bank, some, house, begun, actions)
            looker.time(some, before, [np.asarray(x) for x in looks])
    return looker.house, looker.seen, steps


def start(template: Template, bank: HouseBank, house: jax.Array, key: jax.Array) -> PhysicsState:
    """Reset agents to free places, with doors at random angles."""
    agents, first = template.layout.num_agents, jax.random.split(key)
    places = jax.random.choice(first[0], bank.navigation.start[house], (agents,), replace=False)
    return physics.reset(template, bank, house, places, jnp.zeros(agents), door_angles(bank, house, "random", first[1]))


def one(template: Template, bank: HouseBank, house, key, kind, state: PhysicsState, before, at):
    """Step an environment; return its state before and after, actions, and whether it broke or dropped contacts."""
    begun, actions = obeyed(template, bank, house, key, kind, state, before, at)
    state, lost = physics.step_checked(template, bank, house, begun, actions)
    state = physics.update_hands(template, bank, house, state)
    lost = functools.reduce(jnp.logical_or, jax.tree.leaves(lost))
    return begun, state, actions, physics.is_unstable(state), lost


def obeyed(template: Template, bank: HouseBank, house, key, kind, state: PhysicsState, before, at):
    """Return the state after grasp commands, and the actions of the following step."""
    drawn = jax.random.split(jax.random.fold_in(key, at), template.layout.num_agents)
    chosen = [choose(template, bank, house, k, kind, at, state, before, a) for a, k in enumerate(drawn)]
    actions, commands = (
        jnp.stack([c[0] for c in chosen]),
        jax.tree.map(lambda *x: jnp.stack(x), *[c[1] for c in chosen]),
    )
    return physics.apply_hand_commands(template, bank, house, state, commands), actions


def between(template: Template, bank: HouseBank, envs, house, state: PhysicsState, actions):
    """Return `qpos` and `qvel` of some environments after each physics step of a step (t, e, ...)."""
    timing = template.config.timing
    short = dataclasses.replace(template.config, timing=Timing(ctrl_dt=timing.sim_dt, sim_dt=timing.sim_dt))
    house, state, actions = jax.tree.map(lambda x: x[envs], (house, state, actions))
    step = jax.vmap(functools.partial(physics.step, Template(short, bank.spec), bank))

    def substep(state: PhysicsState, _: None) -> tuple[PhysicsState, tuple[jax.Array, jax.Array]]:
        state = step(house, state, actions)
        return state, (state.qpos, state.qvel)

    return jax.lax.scan(substep, state, None, length=timing.substeps)[1]


def choose(template: Template, bank: HouseBank, house, key, kind, at, state: PhysicsState, before, a: int):
    """Return agent a's action and commands, by its kind."""
    keys = jax.random.split(key, 3)
    drawn = jax.random.uniform(keys[0], (3,), minval=-1.0)
    extreme, swings = jnp.sign(drawn), at % 30 < 10
    held = jnp.where(at % 20 == 0, extreme, before[a])
    (pos,), (yaw,) = (x[a : a + 1] for x in physics.agent_pose(template, state))
    thing, to_thing = nearest(pos, physics.body_pose(template, state)[0])
    leaves = jax.tree.map(lambda x: x[house], DoorLeaves.from_physics(bank.physics))
    door, to_door = nearest(pos, leaves.moved(physics.door_angle(template, state))[0])
    touching = physics.agent_contact(template, state)[a]
    turns = jnp.where(touching & swings, before[a].at[2].set(extreme[2]), jnp.array([1.0, 0.0, 0.0]))
    after_thing, after_door = chase(to_thing, yaw), jnp.where(swings, extreme, chase(to_door, yaw))
    action = jnp.stack([drawn, held, after_thing, turns, after_thing, after_door])[kind]

    throws, swaps = (kind == KINDS.index("throws")) & (at % 5 == 0), (kind == KINDS.index("doors")) & (at % 10 == 0)
    aim = jax.random.normal(keys[1], (3,))
    commands = HandCommands(
        pick=jnp.where(throws, thing, -1),
        place=jnp.full(3, jnp.inf),
        drop=jnp.array(False),
        throw=jnp.where(throws & (state.held[a] >= 0), aim / jnp.linalg.norm(aim), 0.0),
        door=jnp.where(swaps, door, -1),
        open=jax.random.bernoulli(keys[2]),
    )
    return action, commands


def nearest(pos: jax.Array, places: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Return the index of the nearest place, and the vector to it [m]."""
    if not len(places):
        return jnp.int32(-1), jnp.ones(3)
    away = places - pos
    index = jnp.argmin(jnp.sum(away[:, :2] ** 2, axis=-1)).astype(jnp.int32)
    return index, away[index]


def chase(away: jax.Array, yaw: jax.Array) -> jax.Array:
    """Return the action towards a place that is `away` [m]."""
    cos, sin = jnp.cos(yaw), jnp.sin(yaw)
    ahead = jnp.stack([cos * away[0] + sin * away[1], cos * away[1] - sin * away[0]])
    return jnp.append(jnp.clip(3 * ahead, -1, 1), jnp.clip(jnp.arctan2(ahead[1], ahead[0]), -1, 1))


class Looker:
    """Checker of every step."""

    def __init__(self, template: Template, bank: HouseBank, house: np.ndarray) -> None:
        arrays = jax.tree.map(np.asarray, bank.physics)
        self.layout, self.house, self.floor = template.layout, house, arrays.floor.astype(np.float64)
        rises = arrays.collider_pos[..., 2] + arrays.collider_size[..., 2] > arrays.floor[:, None] + 0.01
        real = (arrays.collider_pos[..., 2] > -50) & rises
        self.static = boxes(
            arrays.collider_pos, arrays.collider_quat, np.where(real[..., None], arrays.collider_size, -1.0)
        )
        ends = [self.static.pos + sign * self.static.reach for sign in (-1, 1)]
        low, high = np.where(real[..., None], ends[0], np.inf), np.where(real[..., None], ends[1], -np.inf)
        self.low, self.high = low.min(axis=1)[house][:, None, :2], high.max(axis=1)[house][:, None, :2]
        shapes = [[body.radius, body.radius, body.height / 2] for body in template.config.agents]
        self.agents = np.tile(np.array(shapes), (len(house), 1, 1))
        self.bodies = np.where(arrays.body_valid[..., None], arrays.body_size, -1.0)[house]
        self.leaves = jax.tree.map(lambda x: np.asarray(x)[house], DoorLeaves.from_physics(bank.physics))
        self.turned = jax.jit(DoorLeaves.pose_at)
        shape = (len(house), template.layout.num_dynamic)
        whole = [np.zeros((2, *shape), kind) for kind in (float, float, int, int, int)]
        self.seen = Seen(*whole, *(np.zeros(s, int) for s in (shape, shape, shape[:1], shape[:1])))

    def add(self, at: int, qpos: np.ndarray, qvel: np.ndarray, broken: np.ndarray, lost: np.ndarray) -> None:
        """Check the end of another step."""
        seen, everywhere = self.seen, np.arange(len(self.house))
        mobile = self.look(everywhere, qpos, self.awake(qvel) | (at == 0), seen.now)
        seen.when[seen.now > seen.depth] = at
        np.maximum(seen.depth, seen.now, out=seen.depth)
        used, plan = mobile.half[..., 0] >= 0, mobile.pos[..., :2]
        seen.outside[:] += used & np.any((plan < self.low) | (plan > self.high), axis=-1)
        seen.below[:] += used & (mobile.pos[..., 2] < self.floor[self.house][:, None])
        seen.broken[:] += broken
        seen.lost[:] += lost

    def time(self, envs: np.ndarray, before: np.ndarray, looks: Sequence[np.ndarray]) -> None:
        """Update the duration of penetrations in some environments from depths before a step and its physics steps."""
        depth, deep, longest = (x[:, envs] for x in (before, self.seen.deep, self.seen.longest))
        for qpos, qvel in zip(*looks, strict=True):
            self.look(envs, qpos, self.awake(qvel), depth)
            deep = np.where(depth > DEEP, deep + 1, 0)
            longest = np.maximum(longest, deep)
        self.seen.deep[:, envs], self.seen.longest[:, envs] = deep, longest

    def look(self, envs: np.ndarray, qpos: np.ndarray, awake: np.ndarray, depth: np.ndarray) -> Boxes:
        """Update depths (2, e, m) of awake bodies in some environments; return the boxes of all dynamic bodies."""
        mobile, counts = self.mobiles(envs, qpos), (self.layout.num_agents, self.layout.num_doors)
        look(mobile, *counts, awake, self.static, self.house[envs], self.floor, depth[0], depth[1])
        return mobile

    def mobiles(self, envs: np.ndarray, qpos: np.ndarray) -> Boxes:
        """Return the boxes of agents, bodies and doors."""
        layout, n, own = self.layout, len(qpos), jax.tree.map(lambda x: x[envs], self.leaves)
        agents = qpos[:, layout.agent_qpos].reshape(n, -1, 4)
        bodies = qpos[:, layout.body_qpos].reshape(n, -1, 7)
        leaves = [np.asarray(x) for x in self.turned(own, qpos[:, layout.door_qpos])]
        upright = np.broadcast_to([1.0, 0.0, 0.0, 0.0], (*agents.shape[:2], 4))
        return boxes(
            np.concatenate([agents[..., :3], bodies[..., :3], leaves[0]], axis=1),
            np.concatenate([upright, bodies[..., 3:], leaves[1]], axis=1),
            np.concatenate([self.agents[envs], self.bodies[envs], own.size], axis=1),
        )

    def awake(self, qvel: np.ndarray) -> np.ndarray:
        """Return whether each body moves."""
        layout, n = self.layout, len(qvel)
        parts = (layout.agent_qpos, layout.body_qvel, layout.door_qvel)
        widths = (4, 6, 1)
        moves = [(qvel[:, p].reshape(n, -1, w) != 0).any(axis=-1) for p, w in zip(parts, widths, strict=True)]
        return np.concatenate(moves, axis=1)


def report(house: np.ndarray, seen: Seen, template: Template) -> None:
    """Print totals of each kind of agent, and the worst failures."""
    agents, bodies = template.layout.num_agents, template.layout.num_bodies
    columns = {
        "agents": slice(0, agents),
        "bodies": slice(agents, agents + bodies),
        "doors": slice(agents + bodies, None),
    }
    for number, kind in enumerate(KINDS):
        rows = slice(number, None, len(KINDS))
        record = {"kind": kind, "environments": len(house[rows]), "not finite": int((seen.broken[rows] > 0).sum())}
        record |= {"lost contacts": int(seen.lost[rows].sum())}
        for name, part in columns.items():
            record[name] = {key: int((getattr(seen, key)[rows, part] > 0).sum()) for key in ("outside", "below")}
            for place, where in enumerate(("in the house", "in mobiles")):
                if name == "doors" and place == 0:
                    continue  # not checked
                depth, longest = seen.depth[place, rows, part], seen.longest[place, rows, part]
                record[name][where] = {
                    "deepest [m]": round(float(depth.max(initial=0)), 4),
                    "deeper than 2 cm": int((depth > DEEP).sum()),
                    "longer than a step": int((longest > template.config.timing.substeps).sum()),
                }
        print(json.dumps(record), flush=True)
    long = np.where(seen.longest > template.config.timing.substeps, seen.depth, 0)
    failed = long.max(axis=0) + 10.0 * (seen.outside > 0) + 10.0 * (seen.below > 0)
    order = np.argsort(-failed, axis=None)[: min(WORST, int((failed > 0).sum()))]
    for env, mobile in zip(*np.unravel_index(order, failed.shape), strict=True):
        found = {"kind": KINDS[env % len(KINDS)], "env": int(env), "house": int(house[env]), "mobile": int(mobile)}
        for key in ("depth", "when", "longest"):  # in the house, and in dynamic bodies
            found[key] = [round(float(x), 4) for x in getattr(seen, key)[:, env, mobile]]
        found |= {key: int(getattr(seen, key)[env, mobile]) for key in ("outside", "below")}
        print(json.dumps(found), flush=True)


if __name__ == "__main__":
    main()
