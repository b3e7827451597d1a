"""Compare the expert of PiedPiper with followers of the nearest agent and random agents, in houses of any seeds.

    python benchmarks/piper.py [--seeds 7000 7016] [--num-tasks 4] [--episodes 64] [--impl kinematic]

Followers of the nearest agent use the positions of all agents but no sound. "nearest" selects again in each step;
"loyal" keeps the agent that was nearest at first. `random` actions exclude `stopped`. Prints one JSON object per line.
"""

import argparse
import json
import tempfile
import time
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

import home_mjx
from home_mjx.navigation.grid import cell_at_feet, cell_number, row_of_cell
from home_mjx.tasks import HouseholdEnv, Snapshot, State
from home_mjx.tasks.base.snapshot import AgentPose
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.experts.cell_search import turns_to_cells
from home_mjx.tasks.experts.expert_observation import EXPERT, ExpertObservationEnv
from home_mjx.tasks.experts.path_follower import to_actions
from home_mjx.tasks.scripted_agents.pied_piper import FOLLOWER, MIN_PIPER_DISTANCE
from home_mjx.training import evaluate, expert_policy
from home_mjx.training.rollout import Policy
from home_procgen import generate_dataset

Act = Callable[[Snapshot, State], Array]


class Advised(ExpertObservationEnv):
    """Environment with the advice of another policy than the task's expert.

    Args:
        core: The environment.
        act: Function from a snapshot and the state to the follower's action, with an agent axis.
    """

    def __init__(self, core: HouseholdEnv, act: Act) -> None:
        super().__init__(core)
        self._act = act

    def _extra_observations(self, state: State, snapshot: Snapshot) -> dict[str, Array]:
        return {EXPERT: self._act(snapshot, state)}


def follow(snapshot: Snapshot, whom: Array) -> Array:
    """Return the first agent's action along the shortest path to the current position of another agent."""
    bank, house, pose = snapshot.bank, snapshot.house, snapshot.pose
    at, rooms = cell_at_feet(bank, house, snapshot.feet[whom]), bank.navigation.room[house]
    cell = bank.navigation.cell_coords[row_of_cell(cell_number(bank, house, at))].astype(jnp.int32)
    wanted = jnp.zeros(rooms.shape, bool).at[cell[0], cell[1], cell[2]].set(True)
    error, _ = turns_to_cells(snapshot, wanted, rooms == rooms[cell[0], cell[1], cell[2]], num_agents=1)
    waits = jnp.linalg.norm(pose.pos[whom] - pose.pos[FOLLOWER])[None] < MIN_PIPER_DISTANCE
    error = jnp.where(waits, 1.0, error)
    return to_actions(snapshot.config, error, -pose.pitch[:1], waits, jnp.zeros_like(waits))


def nearest_other(snapshot: Snapshot) -> Array:
    """Return the index of the agent with the smallest Euclidean distance to the first one; ties: the lower."""
    away = jnp.linalg.norm(snapshot.pose.pos - snapshot.pose.pos[FOLLOWER], axis=-1)
    return jnp.argmin(away.at[FOLLOWER].set(jnp.inf)).astype(jnp.int32)


def nearest(snapshot: Snapshot, state: State) -> Array:
    """Return the action that follows the agent that is nearest now."""
    return follow(snapshot, nearest_other(snapshot))


def loyal(snapshot: Snapshot, state: State) -> Array:
    """Return the action that follows the agent that was nearest at first, by the start poses of the episode's key."""
    begun = state.info["begun"]
    pose = AgentPose(pos=begun, yaw=snapshot.pose.yaw, pitch=snapshot.pose.pitch)
    return follow(snapshot, nearest_other(snapshot.replace(pose=pose)))


class Remembers(Advised):
    """Environment that stores the start positions of agents in `State.info`."""

    def _init(self, *args: Any, **options: Any) -> tuple[State, Snapshot]:
        state, snapshot = super()._init(*args, **options)
        return state.replace(info=state.info | {"begun": snapshot.pose.pos}), snapshot


def main() -> None:
    """Play and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--seeds", type=int, nargs=2, default=(7000, 7016), help="range of seeds, the last one excluded"
    )
    parser.add_argument("--num-tasks", type=int, default=4, help="tasks per house")
    parser.add_argument("--episodes", type=int, default=64)
    parser.add_argument("--impl", default="kinematic")
    parser.add_argument("--only", nargs="*", default=("expert", "nearest", "loyal", "random"))
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        generate_dataset(folder, range(*args.seeds))
        env = home_mjx.make(
            "PiedPiper-v0",
            folder,
            num_houses=args.seeds[1] - args.seeds[0],
            sensors=("state",),
            impl=args.impl,
            num_tasks=args.num_tasks,
        )
    cores = {
        "expert": ExpertObservationEnv(env.core),
        "nearest": Advised(env.core, nearest),
        "loyal": Remembers(env.core, loyal),
        "random": env.core,
    }
    for name in args.only:
        begin = time.perf_counter()
        policy = moving(env.core) if name == "random" else expert_policy
        found = evaluate(Env(cores[name], env.params, env.spec), policy, num_episodes=args.episodes)
        line = {key: round(float(np.mean(found[key])), 3) for key in ("success", "near", "episode_steps", "collisions")}
        error = round(float(np.std(found["success"]) / np.sqrt(args.episodes)), 3)
        own = {"policy": name, "episodes": args.episodes, "houses": env.bank.num_houses, "stderr": error}
        print(json.dumps(own | line | {"seconds": round(time.perf_counter() - begin)}), flush=True)


def moving(core: HouseholdEnv) -> Callable[[Any], Policy]:
    """Return a random policy without `stopped`, which would end the episode."""

    def act(memory: Any, obs: dict[str, Array], begins: Array, keys: Array) -> tuple[Any, Array, dict]:
        return memory, jax.vmap(lambda key: jax.random.randint(key, (), 1, core.action_size))(keys), {}

    return lambda net: Policy(act)


if __name__ == "__main__":
    main()
