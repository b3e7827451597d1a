"""Evaluate PointNav agents in houses of other datasets than those of their training.

    python benchmarks/foreign_houses.py --houses NAME=DATASET ... [--agent NAME=CHECKPOINT ...] [--episodes 64]
        [--out FILE]

Each dataset is one bank, whose houses all take part. Options are Habitat's: steps of 0.25 m and 10 degrees, success by
`stop` within 0.2 m, kinematic movement. On the same episodes of each bank play a random agent, `straight` of
`baselines.py`, which goes to the goal without regard to obstacles, the expert, and each checkpoint with its own
sensors. Prints one JSON object for each agent and dataset, and appends it to a file.
"""

import argparse
import datetime
import time
from pathlib import Path
from typing import Any

from baselines import HABITAT, ROOT, side_by_side, straight, tell

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.core.compile_cache import use_compile_cache
from home_mjx.core.profiling import device_name
from home_mjx.houses import load_bank
from home_mjx.tasks import add_expert
from home_mjx.training import evaluate, expert_policy, load_policy, summarize
from home_mjx.training.checkpoint import read_config
from home_mjx.training.evaluation import evaluation_spec, with_episodes

OPTIONS = HABITAT | {"impl": "kinematic", "episode_length": 500}


def main() -> None:
    """Play and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--houses", action="append", required=True, metavar="NAME=DATASET")
    parser.add_argument("--agent", action="append", default=[], metavar="NAME=CHECKPOINT")
    parser.add_argument("--episodes", type=int, default=64, help="episodes of each agent, at most 128")
    parser.add_argument("--out", type=Path, default=ROOT / "benchmarks" / "results" / "foreign-houses.jsonl")
    args = parser.parse_args()
    use_compile_cache()
    agents = dict(text.split("=", 1) for text in args.agent)
    for text in args.houses:
        name, dataset = text.split("=", 1)
        bank = load_bank(dataset)
        begun = time.perf_counter()
        results = played(bank, args.episodes)
        results |= {agent: trained(Path(path), bank, args.episodes) for agent, path in agents.items()}
        common = {
            "case": "foreign_houses", "dataset": name, "houses": bank.num_houses, "episodes": args.episodes,
            "options": OPTIONS, "device": device_name(), "date": f"{datetime.datetime.now(datetime.UTC):%Y-%m-%d}",
            "seconds": round(time.perf_counter() - begun, 1),
        }  # fmt: skip
        tell(args.out, [common | {"agent": agent, **figures} for agent, figures in results.items()])


def played(bank: HouseBank, num: int) -> dict[str, Any]:
    """Return the results of the agents without training; all play the same episodes."""
    env = with_episodes(home_mjx.make("PointNav-v0", bank, sensors=("state", "goal"), **OPTIONS), num)
    policy = side_by_side(env, straight(env), num)
    both = evaluate(env, lambda net: policy, None, 2 * num, max_batch=2 * num)
    expert = evaluate(add_expert(env), expert_policy, None, num)
    lengths = summarize({"length": env.params.tasks.columns["length"]})
    halves = ({name: x[part] for name, x in both.items()} for part in (slice(num), slice(num, None)))
    results = dict(zip(("random", "straight", "expert"), (*halves, expert), strict=True))
    return {name: summarize(figures) | lengths for name, figures in results.items()}


def trained(path: Path, bank: HouseBank, num: int) -> dict[str, Any]:
    """Return the results of a checkpoint on the episodes of `played`, with its own sensors."""
    spec = evaluation_spec(read_config(path).env, split=None)
    options = dict(spec.options) | (OPTIONS if spec.id == "PointNav-v0" else {})
    env = with_episodes(home_mjx.make(spec.id, bank, **options), num)
    return summarize(evaluate(env, *load_policy(path, env.core), num))


if __name__ == "__main__":
    main()
