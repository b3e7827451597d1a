"""Measure learning: train in some houses, and evaluate whole episodes in others, together with random agents.

    python benchmarks/learning.py CASE [--houses ROOT] [--frames 30e6] [--clone 0] [--seconds 60] [--out FOLDER]

PointNav has Habitat's options: moves of 0.25 m and 10 degrees, success within 0.2 m and with `stopped`. The other tasks
are used as registered. `--clone` steps of cloning an expert come first, then `--frames` of PPO, over which its learning
rate falls. `--seconds` limits the training time without compilation. Prints one JSON object per line: the run, then
each evaluation. The folder has the layout of `home-mjx train`: its checkpoint can be played and evaluated.
"""

import argparse
import contextlib
import dataclasses
import fcntl
import json
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import jax.numpy as jnp
import numpy as np

import home_mjx
from home_mjx.core.jsonable import parse_assignments
from home_mjx.core.profiling import device_name
from home_mjx.registry import find_spec
from home_mjx.tasks.base.options import override_options
from home_mjx.tasks.metrics import chance_accuracy, prior_accuracy
from home_mjx.training import (
    Policy,
    PPOConfig,
    RunConfig,
    evaluate,
    evaluation_spec,
    load_policy,
    random_policy,
    summarize,
    train,
)
from home_mjx.training.checkpoint import CHECKPOINT_FILE, CLONED_FILE
from home_mjx.training.metrics_log import read_lines

EYES = ("depth", "coarse", "prev_action")
WORDS = (*EYES, "color", "size", "room_type")  # sensors of the properties in sentences and questions


@dataclass(frozen=True)
class Case:
    """Training case and its evaluations.

    Attributes:
        env: Id of the environment.
        options: Options of the training.
        judged: Options of further evaluations by name, such as held-out sounds.
        taken: Observation that is replaced by its minimum in one more evaluation of the same agent.
    """

    env: str
    options: dict[str, Any]
    judged: dict[str, dict[str, Any]] = field(default_factory=dict)
    taken: str | None = None


def point(*sensors: str) -> Case:
    """Return a case of PointNav."""
    options = {"actions": "discrete", "impl": "kinematic", "stop": True, "success_distance": 0.2, "sensors": sensors}
    return Case("PointNav-v0", options)


def task(
    name: str, *sensors: str, judged: dict[str, dict[str, Any]] | None = None, taken: str | None = None, **options: Any
) -> Case:
    """Return a case of a row task."""
    return Case(f"{name}-v0", {"impl": "kinematic", "sensors": sensors, **options}, judged or {}, taken)


UNHEARD = {"unheard": {"clip_split": "unheard"}}
SEEN = {"combinations": "seen"}
NEW = {"new": {"combinations": "new"}}
CASES = {
    "range": point("lidar", "state", "goal"),
    "depth": point("depth", "goal"),
    "blind": point("goal"),
    "sound": task("AudioNav", "depth", "log_mel", "prev_action", judged=UNHEARD, taken="log_mel"),
    "deaf": task("AudioNav", "depth", "prev_action"),
    "room": task("RoomNav", *EYES, "room", "goal_words"),
    "object": task("ObjectNav", *EYES, "goal_words"),
    "sentence": task(
        "InstructionFollowing", *WORDS, "instruction", judged=NEW, taken="instruction", combinations="seen"
    ),
    "unread": task("InstructionFollowing", *WORDS, judged=NEW, combinations="seen"),
    "piper": task("PiedPiper", *EYES, "log_mel", judged=UNHEARD, taken="log_mel"),
    "question": task("HouseQA", *WORDS, "instruction"),
    "attribute": task("HouseQA", *WORDS, "instruction", kinds=("color", "location")),
    "unseen": task("HouseQA", "prev_action", "instruction"),
}


def main() -> None:
    """Train, evaluate and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", choices=CASES)
    parser.add_argument("--houses")
    parser.add_argument("--num-houses", type=int, default=256, help="number of training houses")
    parser.add_argument("--held-out", type=int, default=100, help="number of evaluation houses")
    parser.add_argument("--episodes", type=int, default=1000)
    parser.add_argument("--frames", type=float, default=30e6)
    parser.add_argument("--algorithm", default="ppo", help="as in home-mjx train")
    parser.add_argument("--clone", type=float, default=0, help="environment steps of cloning an expert before PPO")
    parser.add_argument("--start", help="checkpoint or agent.npz of the initial network")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, help="folder of the run")
    parser.add_argument("--env", action="append", default=[], metavar="NAME=VALUE", help="an option of the environment")
    parser.add_argument("--ppo", action="append", default=[], metavar="NAME=VALUE", help="an option of PPOConfig")
    parser.add_argument("--turn", type=Path, help="lock file; runs that share it train one at a time")
    parser.add_argument("--random", type=int, default=1, help="0: without random agents")
    parser.add_argument("--greedy", action="store_true", help="also evaluate the most likely actions")
    args = parser.parse_args()
    run, out = run_of(args), args.out or Path("runs") / f"learning-{args.case}-{args.seed}"
    out.mkdir(parents=True, exist_ok=True)
    train(run, out, device_lock=in_turn(args.turn))
    common = {"case": f"learning/{args.case}", "seed": args.seed, "device": device_name()}
    print(json.dumps(common | last_line(out) | {"houses": run.env.num_houses, "run": plain(run)}), flush=True)
    for name, options in {"held out": {}, **CASES[args.case].judged}.items():
        env, taken = held_out(run, args, options), CASES[args.case].taken
        trained, net = load_policy(out / CHECKPOINT_FILE, env.core)
        policies = {"trained": (trained, net)}
        if args.random:
            policies["random"] = (random_policy(env.core), None)
        if taken:
            low = float(np.min(env.core.observation_spec[taken].low))
            policies[f"without {taken}"] = (without(trained, taken, low), net)
        if (out / CLONED_FILE).exists():
            policies["cloned"] = (trained, load_policy(out / CLONED_FILE, env.core)[1])
        if args.greedy:
            policies["greedy"] = load_policy(out / CHECKPOINT_FILE, env.core, greedy=True)
        for agent, (policy, own) in policies.items():
            begun = time.perf_counter()
            found = summarize(evaluate(env, policy, own, args.episodes, seed=1))
            record = {"agent": agent, "judged": name, "held_out": env.bank.num_houses, "episodes": args.episodes}
            print(json.dumps(common | record | found | {"seconds": round(time.perf_counter() - begun, 1)}), flush=True)
        if env.spec and env.spec.id == "HouseQA-v0":
            asked = home_mjx.make(run.env).params.tasks, env.params.tasks
            print(
                json.dumps(common | {"prior": prior_accuracy(*asked), "chance": chance_accuracy(asked[1])}), flush=True
            )


@contextlib.contextmanager
def in_turn(path: Path | None) -> Iterator[None]:
    """Hold a lock while training, so that runs that compile or evaluate do not affect the training time."""
    if path is None:
        yield
        return
    with path.open("w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def run_of(args: argparse.Namespace) -> RunConfig:
    """Return the run configuration of the corresponding `home-mjx train` command."""
    case = CASES[args.case]
    known = find_spec(case.env)
    env = dataclasses.replace(
        known,
        options={**known.options, **case.options, **parse_assignments(args.env)},
        houses=args.houses,
        num_houses=args.num_houses,
        split="train",
    )
    ppo = override_options({"": PPOConfig()}, {"num_timesteps": int(args.frames)} | parse_assignments(args.ppo))[""]
    return RunConfig(env, ppo, args.seed, args.algorithm, args.start, int(args.clone), args.seconds)


def held_out(run: RunConfig, args: argparse.Namespace, options: dict[str, Any]) -> Any:
    """Make the environment in held-out houses."""
    env = evaluation_spec(run.env, "val", args.held_out)
    return home_mjx.make(dataclasses.replace(env, options={**env.options, **options}))


def without(trained: Callable[[Any], Policy], name: str, low: float) -> Callable[[Any], Policy]:
    """Return the same agent with one observation replaced by its minimum."""

    def policy_of(net: Any) -> Policy:
        policy = trained(net)
        return policy._replace(
            act=lambda memory, obs, *rest: policy.act(memory, obs | {name: jnp.full_like(obs[name], low)}, *rest)
        )

    return policy_of


def last_line(out: Path) -> dict[str, Any]:
    """Return the last metrics of the training."""
    return read_lines(out / "metrics.jsonl")[-1]


def plain(run: RunConfig) -> dict[str, Any]:
    """Return the run in JSON form."""
    options = {name: value for name, value in run.env.options.items() if isinstance(value, str | int | float | tuple)}
    ppo = dataclasses.asdict(run.ppo)
    return {
        "env": run.env.id,
        "options": options,
        "ppo": ppo,
        "algorithm": run.algorithm,
        "clone_timesteps": run.clone_timesteps,
    }


if __name__ == "__main__":
    main()
