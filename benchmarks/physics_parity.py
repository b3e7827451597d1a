"""Measure the differences between the implementations of physics within one step, on many states.

    JAX_PLATFORMS=cuda,cpu python benchmarks/physics_parity.py [--houses ROOT] [--num-states 100000] [--num-c 4096]
    JAX_PLATFORMS=cpu python benchmarks/physics_parity.py --num-states 4000 --num-mjx 500

States are from rollouts on the CPU in which agents push, throw and turn doors as in `physics_soak.py`. From each, one
control step and one physics step are computed. The fused step runs on the default device and on the CPU, MJX on the
default device, C MuJoCo on the CPU. MJX and C MuJoCo have no body sleeping, so physics steps run without it everywhere.

Prints one JSON object per line for each pair of implementations. It has quantiles over states of the largest difference
of any agent, body or door, and the share of states whose poses all differ by less than a bound. It also has the share
with equal numbers of agent contacts, and the number of states with dropped contacts, which are excluded from the rest.
`--worst` adds the states with the largest differences. `--save` stores states and `--load` reads them elsewhere.
"""

import argparse
import dataclasses
import hashlib
import itertools
import json
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from physics_soak import KINDS, obeyed, start
from tqdm import tqdm

import home_mjx
from home_mjx import HouseBank, physics
from home_mjx.core.profiling import device_name
from home_mjx.physics import PhysicsSetup, PhysicsState, Template
from home_mjx.physics.base.layout import Layout
from home_mjx.schema.timing import Timing

QUANTILES = (50, 90, 99, 99.9, 100)
BOUNDS = (0.001, 0.01, 0.1, 1.0, 10.0)  # bounds [mm] and [mrad]
POSES = ("agent_mm", "agent_mrad", "body_mm", "body_mrad", "door_mrad")
STEPS = {
    "control step": PhysicsSetup(),
    "physics step": PhysicsSetup(timing=Timing(ctrl_dt=Timing().sim_dt), sleep=False),
}


class States(NamedTuple):
    """States in random order, so that the first ones are a sample of all n."""

    house: np.ndarray  # (n)
    kind: np.ndarray  # (n), kind of its agents, an index of KINDS
    action: np.ndarray  # (n, a, 3)
    state: PhysicsState  # (n, ...)

    def rows(self, rows: Any) -> "States":
        """Select some states."""
        return jax.tree.map(lambda x: x[rows], self)


class After(NamedTuple):
    """Results of an implementation on the first states."""

    qpos: np.ndarray
    qvel: np.ndarray
    touched: np.ndarray
    lost: np.ndarray  # whether contacts were dropped


class Case(NamedTuple):
    """An implementation, and the number of states that it steps."""

    impl: str
    device: Any  # a `jax.Device`
    count: int

    @property
    def name(self) -> str:
        """Name of the implementation and device in records."""
        return f"{self.impl} on {self.device.platform}"


def main() -> None:
    """Compare and print."""
    args = arguments()
    bank = home_mjx.make("PointNav-v0", args.houses, num_houses=args.num_houses, sensors=("state",)).params.bank
    states = load(args.load, bank) if args.load else draw(bank, args)
    if args.save:
        save(args.save, bank, states)
    here = {"houses": args.houses or f"{bank.num_houses} generated", "device": device_name(), "seed": args.seed}
    for step, config in STEPS.items():
        template = template_of(bank, config, states.action.shape[1])
        done = {case: run(case, template, bank, states, args.batch) for case in cases(args, len(states.house))}
        for one, two in itertools.combinations(done, 2):
            differ, counts = compare(template, bank, states.house, done[one], done[two])
            record = {"case": "physics_parity", "step": step, "one": one.name, "two": two.name}
            print(json.dumps(record | counts | summary(differ) | here), flush=True)
            for row in worst(differ, states, args.worst):
                print(json.dumps(row), flush=True)


def arguments() -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--houses")
    parser.add_argument("--num-houses", type=int, default=64)
    parser.add_argument("--num-envs", type=int, default=1000)
    parser.add_argument("--num-agents", type=int, default=2)
    parser.add_argument("--num-states", type=int, default=100_000)
    parser.add_argument("--num-mjx", type=int, help="number of states for MJX; 0: none (default: all)")
    parser.add_argument("--num-c", type=int, default=4096, help="number of states for C MuJoCo; 0: none")
    parser.add_argument("--stride", type=int, default=2, help="control steps of a rollout between two states")
    parser.add_argument("--batch", type=int, default=4096)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--worst", type=int, default=0, help="number of states to report for each pair")
    parser.add_argument("--save", type=Path)
    parser.add_argument("--load", type=Path)
    return parser.parse_args()


def cases(args: argparse.Namespace, count: int) -> Iterator[Case]:
    """Yield the implementations to compare."""
    own, cpu = jax.devices()[0], jax.devices("cpu")[0]
    yield Case("fused", own, count)
    if own != cpu:
        yield Case("fused", cpu, count)
    for impl, device, some in (("jax", own, args.num_mjx), ("c", cpu, args.num_c)):
        if some != 0:
            yield Case(impl, device, min(some or count, count))


def draw(bank: HouseBank, args: argparse.Namespace) -> States:
    """Return every `stride`-th state of the environments' rollouts, on the CPU."""
    envs, cpu = args.num_envs, jax.devices("cpu")[0]
    kind, house = np.arange(envs) % len(KINDS), np.arange(envs) // len(KINDS) % bank.num_houses
    template = template_of(bank, PhysicsSetup(), args.num_agents)
    with jax.default_device(cpu):
        here, keys = jax.device_put(bank, cpu), jax.random.split(jax.device_put(jax.random.key(args.seed), cpu), envs)
        state = jax.jit(jax.vmap(partial(start, template), (None, 0, 0)))(here, house, keys)
        ask = jax.jit(jax.vmap(partial(obeyed, template), (None, 0, 0, 0, 0, 0, None)))
        go = jax.jit(jax.vmap(partial(advance, template), (None, 0, 0, 0)))
        actions, seen = jnp.zeros((envs, args.num_agents, 3)), []
        for at in tqdm(range(args.stride * -(-args.num_states // envs)), desc="rollouts", unit="step"):
            state, actions = ask(here, house, keys, kind, state, actions, at)
            if at % args.stride == args.stride - 1:
                seen.append(jax.tree.map(np.asarray, States(house, kind, actions, state)))
            state = go(here, house, state, actions)
    order = np.random.default_rng(args.seed).permutation(len(seen) * envs)[: args.num_states]
    return jax.tree.map(lambda *x: np.concatenate(x), *seen).rows(order)


def advance(template: Template, bank: HouseBank, house: jax.Array, state: PhysicsState, action: jax.Array):
    """Apply a control step."""
    return physics.update_hands(template, bank, house, physics.step(template, bank, house, state, action))


def template_of(bank: HouseBank, config: PhysicsSetup, num_agents: int) -> Template:
    """Return the template of an implementation."""
    return Template(dataclasses.replace(config, num_agents=num_agents), bank.spec)


def digest(bank: HouseBank) -> str:
    """Return the digest of the bank's physics arrays."""
    arrays = b"".join(np.asarray(x).tobytes() for x in jax.tree.leaves(bank.physics))
    return hashlib.blake2b(arrays).hexdigest()


def save(path: Path, bank: HouseBank, states: States) -> None:
    """Save states, and the digest of their houses."""
    parts = {"house": states.house, "kind": states.kind, "action": states.action}
    np.savez_compressed(path, bank=digest(bank), **parts, **{f"state.{k}": v for k, v in vars(states.state).items()})


def load(path: Path, bank: HouseBank) -> States:
    """Load the states of `save`."""
    with np.load(path) as file:
        kept = {name: file[name] for name in file.files}
    if str(kept["bank"]) != digest(bank):
        raise SystemExit(f"{path} is for other houses; pass the same --houses and --num-houses")
    state = {name.removeprefix("state."): value for name, value in kept.items() if name.startswith("state.")}
    return States(kept["house"], kept["kind"], kept["action"], PhysicsState(**state))


def run(case: Case, template: Template, bank: HouseBank, states: States, batch: int) -> After:
    """Step the first states, in batches of one size."""
    config = dataclasses.replace(template.config, impl=case.impl)
    own, size = Template(config, bank.spec), min(batch, case.count)
    step = jax.jit(jax.vmap(partial(physics.step_checked, own), (None, 0, 0, 0)))
    done = []
    with jax.default_device(case.device):
        here = jax.device_put(bank, case.device)
        for first in tqdm(range(0, case.count, size), desc=case.name, unit="batch"):
            some = states.rows(np.arange(first, first + size) % case.count)
            state, lost = step(here, some.house, some.state, some.action)
            full = np.any([np.asarray(x) for x in jax.tree.leaves(lost)], axis=0)
            done.append(After(np.asarray(state.qpos), np.asarray(state.qvel), np.asarray(state.contact_impulse), full))
    return After(*(np.concatenate(x)[: case.count] for x in zip(*done, strict=True)))


def compare(template: Template, bank: HouseBank, house: np.ndarray, one: After, two: After) -> tuple[dict, dict]:
    """Return the largest differences per kind and state (NaN where contacts were dropped), and counts."""
    count = min(len(one.lost), len(two.lost))
    one, two = (After(*(x[:count] for x in given)) for given in (one, two))
    valid = [np.asarray(x)[house[:count]] for x in (bank.physics.body_valid, bank.physics.door_valid)]
    differ = differences(template.layout, one, two, *valid)
    lost, same = one.lost | two.lost, np.all(one.touched == two.touched, axis=-1)
    differ = {name: np.where(lost, np.nan, value) for name, value in differ.items()}
    counts = {"states": count, "left contacts out": [int(one.lost.sum()), int(two.lost.sum())]}
    return differ, counts | {"same number of contacts": share(same[~lost])}


def differences(layout: Layout, one: After, two: After, bodies: np.ndarray, doors: np.ndarray) -> dict[str, np.ndarray]:
    """Return the largest difference by name and unit, over existing bodies (n, k) and doors (n, h)."""
    agents = np.ones((len(bodies), layout.num_agents), bool)
    pos, vel = (partial(apart, getattr(one, name), getattr(two, name)) for name in ("qpos", "qvel"))
    agent, body, door = pos(layout.agent_qpos, 4), pos(layout.body_qpos, 7), pos(layout.door_qpos, 1)
    turned = 4 * np.arcsin(np.minimum(chord(one.qpos, two.qpos, layout), np.sqrt(2)) / 2)
    agent_rate, body_rate, door_rate = vel(layout.agent_qpos, 4), vel(layout.body_qvel, 6), vel(layout.door_qvel, 1)
    return {
        "agent_mm": most(agent[..., :3], agents),
        "agent_mrad": most(agent[..., 3:], agents),
        "body_mm": most(body[..., :3], bodies),
        "body_mrad": most(turned, bodies),
        "door_mrad": most(door, doors),
        "agent_mm_per_s": most(agent_rate[..., :3], agents),
        "body_mm_per_s": most(body_rate[..., :3], bodies),
        "body_mrad_per_s": most(body_rate[..., 3:], bodies),
        "door_mrad_per_s": most(door_rate, doors),
    }


def apart(one: np.ndarray, two: np.ndarray, part: slice, width: int) -> np.ndarray:
    """Return the differences of some columns, by dynamic body (n, m, width)."""
    return (one[:, part].astype(float) - two[:, part]).reshape(len(one), -1, width)


def chord(one: np.ndarray, two: np.ndarray, layout: Layout) -> np.ndarray:
    """Return the chord lengths between the bodies' unit quaternions (n, k, 1); q and -q are equal."""
    quats = [x[:, layout.body_qpos].astype(float).reshape(len(x), -1, 7)[..., 3:] for x in (one, two)]
    a, b = (q / np.maximum(np.linalg.norm(q, axis=-1, keepdims=True), 1e-9) for q in quats)
    return np.minimum(*(np.linalg.norm(a + sign * b, axis=-1, keepdims=True) for sign in (-1, 1)))


def most(vectors: np.ndarray, there: np.ndarray) -> np.ndarray:
    """Return the largest norm of each state, in thousandths."""
    return 1e3 * np.max(np.linalg.norm(vectors, axis=-1), axis=-1, where=there, initial=0.0)


def summary(differ: dict[str, np.ndarray]) -> dict:
    """Compute quantiles of each kind, and shares of states within bounds."""
    quantiles = {}
    for name, value in differ.items():
        found = np.nanpercentile(value, QUANTILES)
        quantiles[name] = {f"{q} %": float(f"{x:.3g}") for q, x in zip(QUANTILES, found, strict=True)}
    far = np.max([differ[name] for name in POSES], axis=0)
    return {"within": {f"{bound:g}": share(far[~np.isnan(far)] < bound) for bound in BOUNDS}} | quantiles


def share(which: np.ndarray) -> float:
    """Return the share of true elements."""
    return round(float(which.mean()), 6)


def worst(differ: dict[str, np.ndarray], states: States, most: int) -> Iterator[dict]:
    """Yield the states with the largest pose differences."""
    far = np.nan_to_num(np.max([differ[name] for name in POSES], axis=0))
    for n in np.argsort(-far)[:most]:
        record = {"state": int(n), "kind": KINDS[states.kind[n]], "house": int(states.house[n])}
        yield record | {name: float(f"{value[n]:.3g}") for name, value in differ.items()}


if __name__ == "__main__":
    main()
