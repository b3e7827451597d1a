"""What holds whatever agents do, in random houses, step for step.

    python tests/soak/invariants.py [--houses N] [--envs N] [--steps N] [--seconds S] [--seed N] [--impl NAME]
        [--mode MODE]

Agents that idle, act at random, hold extreme actions, or drive and turn where they touch something. After every step:
nobody is in a wall or outdoors, nothing has gone through a wall or under the floor, all numbers are finite, no thing is
faster than its limit, things that nobody touches gain no energy, and an agent that is in something counts its contacts.
Now and then states get numbers that are none: their environments end and are flagged, the others do not notice.

Modes: `plain`; `x64`, JAX's 64-bit mode; `debug_nans`, JAX's look-out for them; `no_jit`, without compiling (few steps:
it takes minutes). One JSON object; exits with 1 if something did not hold, and prints what, where and when.
"""

import argparse
import json
import os
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
MODES = {
    "plain": {},
    "x64": {"jax_enable_x64": True},
    "debug_nans": {"jax_debug_nans": True},
    "no_jit": {"jax_disable_jit": True},
}
if __name__ == "__main__":
    sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "helpers")]
    os.environ.setdefault("JAX_PLATFORMS", "cpu")

import jax  # noqa: E402
import jax.numpy as jnp  # noqa: E402
import numpy as np  # noqa: E402
from house_oracle import HouseOracle, energy, plan_of  # noqa: E402

KINDS = ("idle", "drawn", "held", "drives")
DEEP = 0.05  # [m]; an agent that is struck is as deep for a moment
NOTICED = 0.002  # [m]; an agent that is deeper in something when a physics step begins has a contact
SINK = 0.02  # [m], that things may rise as they are freed from what they were placed in
EVERY = 7  # steps between two times that numbers are broken
BROKEN = (np.nan, np.inf, -np.inf, 1e38)
SHOWN = 20


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs and prints."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--houses", type=int, default=16)
    parser.add_argument("--envs", type=int, default=64)
    parser.add_argument("--steps", type=int, default=10**9)
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--impl", default="fused")
    parser.add_argument("--mode", default="plain", choices=list(MODES))
    args = parser.parse_args(arguments)
    for name, value in MODES[args.mode].items():
        jax.config.update(name, value)
    with tempfile.TemporaryDirectory() as folder:
        bank, plans = houses(Path(folder), range(args.seed * 1000, args.seed * 1000 + args.houses))
        soak = Soak(bank, plans, args.envs, args.seed, args.impl, breaks=args.mode != "debug_nans")
        begun = time.perf_counter()
        steps = soak.run(args.steps, args.seconds)
    record = {"case": f"invariants/{args.mode}/{args.impl}", "env_steps": steps * args.envs, "episodes": soak.episodes}
    record |= {"broken": soak.broken, "flagged": soak.flagged, "faults": len(soak.faults), "seed": args.seed}
    print(json.dumps(record | {"seconds": round(time.perf_counter() - begun, 1)}))
    for fault in soak.faults[:SHOWN]:
        print(fault, file=sys.stderr)
    return int(bool(soak.faults))


def houses(folder: Path, seeds: range) -> tuple[Any, list[np.ndarray]]:
    """A bank of generated houses, and the plans of their floors."""
    from home_mjx import HouseBank
    from home_mjx.houses.house_set import HouseSet
    from home_procgen import generate_dataset

    chosen = HouseSet(folder, ids=generate_dataset(folder, seeds))
    compiled = chosen.load()
    return HouseBank.from_compiled(compiled), [plan_of(chosen.resolved_dataset, house) for house in compiled]


class Soak:
    """A batch of environments, and what did not hold so far.

    Args:
        bank: The houses.
        plans: Of each house the triangles of its floors, see `HouseOracle`; None: agents may be anywhere.
        num_envs: Environments.
        seed: Of episodes and actions.
        impl: Of the physics.
        breaks: Whether numbers are broken now and then.

    Attributes:
        faults: What did not hold.
        episodes: That have ended.
        broken: Environments whose numbers were broken.
        flagged: Steps in which contacts did not fit, by environment.
    """

    def __init__(self, bank, plans, num_envs: int, seed: int = 0, impl: str = "fused", breaks: bool = True) -> None:
        from home_mjx import AutoReset, HouseholdEnv
        from home_mjx.tasks import Status, make_config

        self.status, self.rng, self.breaks = Status, np.random.default_rng(seed), breaks
        core = HouseholdEnv(make_config(sensors=("state", "goal"), impl=impl, episode_length=200))
        self.env, self.layout = AutoReset(core).bind(bank), core.template(bank).layout
        self.body = core.config.agents[0]
        self.substep = core.config.timing.sim_dt
        self.limits = core.config.physics.max_body_speed, core.config.physics.max_body_spin
        self.physics = jax.device_get(bank.physics)
        self.houses = [HouseOracle.of(self.physics, h, plans and plans[h]) for h in range(bank.num_houses)]
        self.kind = np.arange(num_envs) % len(KINDS)
        self.step = jax.jit(self.env.step)
        self.states = jax.jit(self.env.reset)(jax.random.split(jax.random.key(seed), num_envs))
        self.actions = np.zeros((num_envs, self.env.action_size), np.float32)
        self.faults, self.episodes, self.broken, self.flagged = [], 0, 0, 0
        self.at, self.now = 0, self.seen(self.states)
        self.most = self.energies(self.now)

    def run(self, steps: int, seconds: float = float("inf")) -> int:
        """Steps on; how often."""
        end, first = np.inf, self.at
        for done in range(steps):
            end = time.perf_counter() + seconds if done == 1 else end  # what compiles does not count
            if time.perf_counter() > end:
                break
            self.act()
            if self.breaks and self.at % EVERY == EVERY - 1:
                self.break_some()
            before, self.states = self.now, self.step(self.states, jnp.asarray(self.actions))
            self.at, self.now = self.at + 1, self.seen(self.states)
            self.look(before, self.now)
        return self.at - first

    def act(self) -> None:
        """Actions of the next step, by kind."""
        drawn = self.rng.uniform(-1, 1, self.actions.shape).astype(np.float32)
        held = np.where(self.at % 20 == 0, np.sign(drawn), self.actions)
        drives = np.zeros_like(drawn)
        touching = self.now["num_contacts"].any(axis=-1)
        drives[:, 0] = np.where(touching, np.sign(drawn[:, 0]), 1)
        drives[:, 2] = np.where(touching, np.sign(drawn[:, 2]), 0)
        self.actions = np.stack([np.zeros_like(drawn), drawn, held, drives])[self.kind, np.arange(len(drawn))]

    def seen(self, states) -> dict[str, np.ndarray]:
        """What is looked at, on the host."""
        layout, found = self.layout, jax.device_get((states.physics, states.world.house, states.status, states.done))
        state, n = found[0], len(found[1])
        speeds = np.asarray(state.qvel[:, layout.body_qvel], float).reshape(n, -1, 6)
        return {
            "agents": np.asarray(state.qpos[:, layout.agent_qpos], float).reshape(n, -1, 4)[..., :3],
            "walks": np.asarray(state.qvel[:, layout.agent_qpos], float).reshape(n, -1, 4)[..., :3],
            "bodies": np.asarray(state.qpos[:, layout.body_qpos], float).reshape(n, -1, 7),
            "speed": speeds[..., :3], "spin": speeds[..., 3:], "num_contacts": np.asarray(state.num_contacts),
            "house": np.asarray(found[1]), "status": np.asarray(found[2]), "done": np.asarray(found[3]),
        }  # fmt: skip

    def energies(self, now: dict[str, np.ndarray]) -> np.ndarray:
        """The most energy [J] that what lies about in each environment may have from now on."""
        found = np.zeros(len(now["house"]))
        for h, house in enumerate(self.houses):
            own = now["house"] == h
            parts = (now[name][own] for name in ("bodies", "speed", "spin"))
            weight = 9.81 * np.where(self.physics.body_valid[h], self.physics.body_mass[h], 0).sum()
            found[own] = energy(self.physics, h, *parts, house.floor) + weight * SINK
        return found

    def look(self, before: dict[str, np.ndarray], now: dict[str, np.ndarray]) -> None:
        """Whether everything holds after a step; what has ended begins anew, and is looked at from then on."""
        self.episodes += int(now["done"].sum())
        finite = [np.isfinite(x).reshape(len(now["done"]), -1).all(axis=1) for x in self.floats()]
        self.fault("a number is not finite", ~np.all(finite, axis=0))
        lost = self.status.STATIC_BOXES | self.status.CONTACT_PAIRS | self.status.CONTACT_POINTS
        self.flagged += int(((now["status"] & lost) != 0).sum())
        self.fault("a flag is up", (now["status"] & ~int(lost)) != 0)
        speed, spin = (np.linalg.norm(now[name], axis=-1) for name in ("speed", "spin"))
        self.fault(
            "a thing is too fast", np.any((speed > 1.001 * self.limits[0]) | (spin > 1.001 * self.limits[1]), -1)
        )
        for h in range(len(self.houses)):
            own = np.flatnonzero((now["house"] == h) & ~now["done"])
            if len(own):
                self.look_at_house(h, own, before, now)
        most = self.energies(now)
        idle = (self.kind == KINDS.index("idle")) & ~now["done"]
        weight = np.array(
            [9.81 * SINK * self.physics.body_mass[h][self.physics.body_valid[h]].sum() for h in now["house"]]
        )
        self.fault("energy is gained", idle & (most - weight > self.most + 0.01))
        self.most = np.where(now["done"], most, self.most)

    def look_at_house(self, h: int, own: np.ndarray, before: dict[str, np.ndarray], now: dict[str, np.ndarray]) -> None:
        """Whether everything is where it can be, in the environments of a house."""
        house, agents, body = self.houses[h], now["agents"][own], self.body
        was, depth = (
            house.depth(seen["agents"][own], body.radius, body.height).max(axis=-1, initial=-1)
            for seen in (before, now)
        )
        self.fault("an agent is in a wall", (depth > DEEP).any(axis=-1), own)
        # Contacts are found where a physics step begins: what the last one has led into something is not among them.
        way = np.linalg.norm(now["walks"][own], axis=-1) * self.substep
        unnoticed = (np.maximum(was, depth - way) > NOTICED) & (now["num_contacts"][own] == 0)
        self.fault("an agent in something counts no contact", unnoticed.any(axis=-1), own)
        self.fault("an agent is outdoors", house.outdoors(agents).any(axis=-1), own)
        self.fault("an agent went through a wall", house.passed(before["agents"][own], agents).any(axis=-1), own)
        self.fault("an agent is under the floor", (agents[..., 2] - body.height / 2 < house.floor - DEEP).any(-1), own)
        used, places = self.physics.body_valid[h], now["bodies"][own][..., :3]
        through = house.passed(before["bodies"][own][..., :3], places) & used
        self.fault("a thing went through a wall", through.any(axis=-1), own)
        self.fault("a thing is under the floor", ((places[..., 2] < house.floor) & used).any(axis=-1), own)

    def floats(self) -> list[np.ndarray]:
        """All numbers that a policy sees, and poses."""
        state = self.states
        found = jax.device_get((state.obs, state.reward, state.metrics, state.physics.qpos, state.physics.qvel))
        return [x for x in jax.tree.leaves(found) if np.issubdtype(x.dtype, np.floating)]

    def break_some(self) -> None:
        """Some environments get numbers that are none: these end and are flagged, and the others do as they would."""
        num, rng = len(self.kind), self.rng
        chosen = rng.random(num) < 0.25
        chosen[rng.integers(num)] = True
        physics, arrays = self.states.physics, {}
        for name in ("qpos", "qvel"):
            arrays[name] = np.array(getattr(physics, name))
        for e in np.flatnonzero(chosen):
            name = "qpos" if rng.random() < 0.5 else "qvel"
            value = rng.choice(BROKEN[:3] if name == "qpos" else BROKEN)
            arrays[name][e, rng.integers(4)] = value  # of the agent: what a house does not use is at rest
        wild = self.states.replace(physics=physics.replace(**{name: jnp.asarray(x) for name, x in arrays.items()}))
        calm, broken = (self.step(states, jnp.asarray(self.actions)) for states in (self.states, wild))
        told = (np.asarray(broken.status) & int(self.status.NOT_A_NUMBER)) != 0
        self.fault("a broken number is not told", chosen & ~told)
        self.fault("a whole number is told as broken", ~chosen & told)
        self.fault("a broken environment goes on", chosen & ~np.asarray(broken.terminated))
        same = [
            (np.asarray(a) == np.asarray(b)).reshape(num, -1).all(axis=1)
            for a, b in zip(*(jax.tree.leaves((s.obs, s.reward, s.physics)) for s in (calm, broken)), strict=True)
        ]
        self.fault("a broken environment has changed another one", ~chosen & ~np.all(same, axis=0))
        finite = [
            np.isfinite(np.asarray(x)).reshape(num, -1).all(axis=1)
            for x in jax.tree.leaves((broken.obs, broken.reward))
        ]
        self.fault("a broken number is seen", ~np.all(finite, axis=0))
        self.broken += int(chosen.sum())

    def fault(self, what: str, where: np.ndarray, own: np.ndarray | None = None) -> None:
        """Notes where something does not hold."""
        envs = np.flatnonzero(where) if own is None else own[where]
        self.faults += [
            {
                "what": what,
                "env": int(e),
                "step": self.at,
                "house": int(self.now["house"][e]),
                "kind": KINDS[self.kind[e]],
            }
            for e in envs
        ]


if __name__ == "__main__":
    sys.exit(main())
