"""How fast agents learn, and how well: trains in some houses, plays whole episodes in others, beside random agents.

    python benchmarks/learning.py CASE [--houses ROOT] [--frames 30e6] [--seconds 60] [--seed 0] [--out FOLDER]

`range` and `depth` are PointNav as Habitat has it: moves of 0.25 m and 10 degrees, success within 0.2 m and with
`stop`; `blind` is the same without eyes. The learning rate falls until `--frames`; training ends at `--seconds` if that
comes first, without the time of compiling. One JSON object a line: the run, then each evaluation.
"""

import argparse
import dataclasses
import json
import time
from pathlib import Path
from typing import Any

import jax

import home_mjx
from home_mjx.bench.timing import device_name
from home_mjx.cli.learning.train import assignments
from home_mjx.tasks.base.options import override
from home_mjx.training import (
    PPO,
    PPOConfig,
    evaluate,
    random_policy,
    summary,
)
from home_mjx.training.progress import Clock, Sums
from home_mjx.training.records import Records

POINT_NAV = {"actions": "discrete", "impl": "kinematic", "stop": True, "success_radius": 0.2}
LOOKS = ("depth", "coarse", "color")
CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "range": ("PointNav-v0", POINT_NAV | {"sensors": ("lidar", "goal")}),
    "depth": ("PointNav-v0", POINT_NAV | {"sensors": ("depth", "goal")}),
    "blind": ("PointNav-v0", POINT_NAV | {"sensors": ("goal",)}),
    "room": ("RoomNav-v0", {"impl": "kinematic", "sensors": ("depth", "room", "goal_words")}),
    "object": ("ObjectNav-v0", {"impl": "kinematic", "sensors": ("depth", "coarse", "goal_words")}),
    "sentence": ("InstructionFollowing-v0", {"impl": "kinematic", "sensors": (*LOOKS, "instruction")}),
    "unread": ("InstructionFollowing-v0", {"impl": "kinematic", "sensors": LOOKS}),
}  # fmt: skip
SHOWN = (
    "success",
    "spl",
    "return",
    "length",
    "steps_per_second",
    "loss/entropy",
    "loss/kl",
    "loss/clipped",
    "grad_norm",
)
NUM_LINES = 60


def main() -> None:
    """Trains, evaluates and prints."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", choices=CASES)
    parser.add_argument("--houses")
    parser.add_argument("--num-houses", type=int, default=256, help="to train in")
    parser.add_argument("--held-out", type=int, default=100, help="houses to be evaluated in")
    parser.add_argument("--episodes", type=int, default=1000)
    parser.add_argument("--frames", type=float, default=30e6)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, help="folder for `metrics.jsonl` and `curves.png`")
    parser.add_argument("--ppo", action="append", default=[], metavar="NAME=VALUE", help="an option of PPOConfig")
    parser.add_argument("--greedy", action="store_true", help="evaluate the likeliest actions, too")
    args = parser.parse_args()
    env_id, options = CASES[args.case]
    env = home_mjx.make(env_id, args.houses, split="train", num_houses=args.num_houses, **options)
    held_out = home_mjx.make(env_id, args.houses, split="val", num_houses=args.held_out, **options)
    ppo = PPO(env.core, config_of(args))
    state, run = learn(ppo, env.params, args)
    common = {"case": f"learning/{args.case}", "seed": args.seed, "device": device_name()}
    print(json.dumps(common | run | {"houses": env.bank.num_houses, "ppo": plain(ppo.config)}), flush=True)
    policies = {"trained": (ppo.policy, state.net), "random": (random_policy(env.core), None)}
    if args.greedy:
        policies["greedy"] = (lambda net: ppo.policy(net, greedy=True), state.net)
    for name, (policy, net) in policies.items():
        begun = time.perf_counter()
        found = summary(evaluate(held_out, policy, net, args.episodes, seed=1))
        record = {"agent": name, "held_out": held_out.bank.num_houses, "episodes": args.episodes, **found}
        print(json.dumps(common | record | {"seconds": round(time.perf_counter() - begun, 1)}), flush=True)


def config_of(args: argparse.Namespace) -> PPOConfig:
    """Options of the training."""
    options = {"num_timesteps": int(args.frames)} | assignments(args.ppo)
    return override({"": PPOConfig()}, options)[""]


def learn(ppo: PPO, params: Any, args: argparse.Namespace) -> tuple[Any, dict[str, Any]]:
    """Updates until frames or seconds are over."""
    out = args.out or Path("runs") / f"learning-{args.case}-{args.seed}"
    out.mkdir(parents=True, exist_ok=True)
    clock, sums, size, num = Clock({}), Sums(), ppo.config.batch_size, ppo.config.num_updates
    params = jax.device_put(params, ppo.whole)
    state = ppo.init(params, jax.random.key(args.seed))
    update = ppo.update.lower(params, state).compile()
    line: dict[str, Any] = {}
    with Records(out, 0) as records:
        clock.start(0)
        for i in range(1, num + 1):
            state, metrics = update(params, state)
            sums.add(metrics)
            over = clock.seconds + time.perf_counter() - clock.time > args.seconds
            if i % max(1, num // NUM_LINES) == 0 or i == num or over:
                line = {"steps": i * size, **clock.lap(i * size), **sums.means()}
                records.add(line)
                print({name: round(line[name], 4) for name in ("steps", *SHOWN) if name in line}, flush=True)
            if over:
                break
        records.draw()
    names = ("steps", "seconds", "compile_seconds", *SHOWN)
    return state, {name: line[name] for name in names if name in line}


def plain(config: PPOConfig) -> dict[str, Any]:
    """The options as JSON has them."""
    return dataclasses.asdict(config)


if __name__ == "__main__":
    main()
