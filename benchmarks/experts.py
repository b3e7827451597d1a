"""Measure the success of experts in houses that nobody tuned on, and list the rows that they fail.

    python benchmarks/experts.py Fetch-v0 Rearrange-v0 --first 130000 --houses 100 --rows 10 --out experts.jsonl
    python benchmarks/experts.py PointNav-v0 RoomNav-v0 --first 500000 --storeys 2 --impl fused kinematic

Each id is used with discrete actions and `stop` where it has them. With `--storeys` the houses are the first homes from
the seed `--first` on that have at least so many storeys. Prints one JSON object per id and implementation: success rate
with standard error, SPL, percentiles 50, 90, 99 and 100 of the steps, success by the storey of the start, and the
failed rows. Each of these has its house, its number, the instruction, and the steps until the end. Use a GPU for many
houses, because all episodes are played in one batch. `--prepare` only writes and compiles the houses.
"""

import argparse
import itertools
import json
import os
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.core.compile_cache import use_compile_cache
from home_mjx.core.profiling import device_name
from home_mjx.core.progress import say
from home_mjx.datasets import Dataset, open_dataset
from home_mjx.errors import HomeMjxError
from home_mjx.houses import compile_dataset, load_bank
from home_mjx.houses.house_cache import load_compiled
from home_mjx.tasks import Env, HouseholdEnv, add_expert, sample_episodes
from home_mjx.tasks.base.state import Episodes
from home_mjx.tasks.language import detokenize
from home_mjx.training import evaluate, expert_policy
from home_procgen.plan.shape.program import draw_program

MIN_LENGTH = 3.0  # [m], shortest episodes of PointNav


def main() -> None:
    """Compile the houses, and evaluate the experts of all ids in them."""
    args = parse()
    use_compile_cache()
    dataset, ids = choose(args.first, args.houses, args.storeys)
    if args.prepare:
        compile_dataset(dataset, ids, workers=args.workers, progress=True)
        return
    try:
        bank = load_bank(dataset, ids=ids, progress=True)
    except HomeMjxError:
        bank = load_bank(dataset, ids=usable(dataset, ids), progress=True)
    for name in args.ids:
        say(f"sampling episodes of {name}", True)
        begin = time.perf_counter()
        env = with_rows(bank, name, args.rows, args.length)
        drawn = round(time.perf_counter() - begin, 1)
        for impl in args.impl:
            line = {"id": name, "first": args.first, "draw_s": drawn, **judge(with_impl(env, impl), args.batch)}
            print(json.dumps(line), flush=True)
            if args.out is not None:
                with args.out.open("a") as file:
                    file.write(json.dumps(line) + "\n")


def parse() -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("ids", nargs="*", help="ids such as Fetch-v0, PointNav-v0 among them")
    parser.add_argument("--first", type=int, required=True, help="seed of the first house")
    parser.add_argument("--houses", type=int, default=100)
    parser.add_argument("--storeys", type=int, default=0, help="only homes with as many storeys; 0: flats")
    parser.add_argument("--impl", nargs="+", default=["fused"], help="implementations of physics")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="processes that compile houses")
    parser.add_argument("--prepare", action="store_true", help="compile the houses and stop")
    parser.add_argument("--rows", type=int, default=10, help="episodes per house")
    parser.add_argument("--length", type=int, help="maximum number of steps; left out: as registered")
    parser.add_argument("--batch", type=int, default=1000, help="maximum number of parallel episodes")
    parser.add_argument("--out", type=Path, help="file that lines are appended to")
    return parser.parse_args()


def choose(first: int, count: int, storeys: int) -> tuple[Dataset, list[str]]:
    """Return generated houses and their ids, from a seed on."""
    seeds: list[int] = []
    for seed in itertools.count(first):
        if len(seeds) == count:
            break
        if storeys == 0 or planned_storeys(seed) >= storeys:
            seeds.append(seed)
    preset = "" if storeys else "&preset=flat"
    dataset = open_dataset(f"procedural:{seeds[-1] + 1 - first}?seed={first}{preset}")
    return dataset, [dataset.house_ids[seed - first] for seed in seeds]


def planned_storeys(seed: int) -> int:
    """Return the number of storeys that the home of a seed is planned with; a rare home without a plan gets others."""
    return draw_program(np.random.default_rng(np.random.SeedSequence([seed, 2]))).num_storeys


def usable(dataset: Dataset, ids: list[str]) -> list[str]:
    """Return the ids of houses that compile, and print the others."""
    kept = []
    for house_id in ids:
        try:
            load_compiled(dataset, house_id)
        except HomeMjxError as error:
            print(f"left out: {house_id}: {error}", file=sys.stderr, flush=True)
        else:
            kept.append(house_id)
    return kept


def with_rows(bank: HouseBank, name: str, rows: int, length: int | None = None) -> Env[HouseholdEnv]:
    """Return the environment of an id with its expert and `rows` episodes for each house, of at most `length` steps."""
    limit = {} if length is None else {"episode_length": length}
    sampled = {"PointNav-v0": {"actions": "discrete", "stop": True}, "Exploration-v0": {}}
    if name in sampled:
        env = home_mjx.make(name, bank, sensors=("state",), **sampled[name], **limit)
        return add_expert(env.with_tasks(sample_episodes(bank, rows * bank.num_houses, min_length=MIN_LENGTH)))
    return add_expert(home_mjx.make(name, bank, num_tasks=rows, sensors=("state",), **limit))


def with_impl(env: Env[HouseholdEnv], impl: str) -> Env[HouseholdEnv]:
    """Return an environment with another implementation of physics, and the same houses and episodes."""
    config = replace(env.core.config, physics=replace(env.core.config.physics, impl=impl))
    return add_expert(Env(HouseholdEnv(config, env.core.task), env.params, env.spec))


def judge(env: Env[HouseholdEnv], batch: int) -> dict[str, Any]:
    """Play all rows of an environment."""
    begin, bank, tasks, impl = time.perf_counter(), env.bank, env.params.tasks, env.core.config.physics.impl
    rows = tasks if isinstance(tasks, Episodes) else tasks.rows
    num = rows.house.shape[0]
    say(f"playing {num} episodes, {impl}", True)
    figures = evaluate(env, expert_policy, None, num, max_batch=batch)
    success, storeys = figures["success"], start_storeys(bank, rows)
    by_storey = {
        int(k): [round(float(success[storeys == k].mean()), 4), int((storeys == k).sum())] for k in np.unique(storeys)
    }
    return {
        "impl": impl,
        "device": device_name(),
        "houses": bank.num_houses,
        "num": num,
        "success": round(float(success.mean()), 4),
        "stderr": round(float(success.std() / np.sqrt(num)), 4),
        "spl": round(float(figures["spl"].mean()), 4) if "spl" in figures else None,
        "steps": np.percentile(figures["episode_steps"], [50, 90, 99, 100]).astype(int).tolist(),
        "by_storey": by_storey,
        "lost": [lost_row(bank, rows, figures, int(row)) for row in np.flatnonzero(success < 1)],
        "play_s": round(time.perf_counter() - begin, 1),
    }


def start_storeys(bank: HouseBank, rows: Episodes) -> np.ndarray:
    """Return the storey that each episode starts on."""
    floors = np.asarray(bank.navigation.floor)[np.asarray(rows.house)]
    return np.argmin(np.abs(np.asarray(rows.start)[:, 2:3] - floors), axis=1)


def lost_row(bank: HouseBank, rows: Episodes, figures: dict[str, np.ndarray], row: int) -> dict[str, Any]:
    """Describe a failed row."""
    tokens = rows.columns.get("tokens")
    return {
        "house": bank.house_ids[int(rows.house[row])],
        "row": row,
        "start": np.asarray(rows.start)[row].round(2).tolist(),
        "asked": None if tokens is None else detokenize(tokens[row]),
        "steps": int(figures["episode_steps"][row]),
        **{name: round(float(figures[name][row]), 2) for name in ("distance", "coverage") if name in figures},
    }


if __name__ == "__main__":
    main()
