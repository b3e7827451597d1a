"""Measure the success of experts in houses that nobody tuned on, and list the rows that they fail.

    python benchmarks/experts.py Fetch-v0 Rearrange-v0 --first 130000 --houses 100 --rows 10 --out experts.jsonl

Each id is used as registered. Prints one JSON object per id: success rate with standard error, SPL, and the failed
rows. Each of these has the seed of its house, its number, the instruction, and the steps until the end. Use a GPU for
many houses, because all episodes are played in one batch.
"""

import argparse
import json
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.core.compile_cache import use_compile_cache
from home_mjx.core.profiling import device_name
from home_mjx.houses import load_bank
from home_mjx.tasks import add_expert
from home_mjx.tasks.base.state import Episodes
from home_mjx.tasks.language import detokenize
from home_mjx.training import evaluate, expert_policy
from home_procgen import generate_dataset


def main() -> None:
    """Generate the houses, and evaluate the experts of all ids in them."""
    args = parse()
    use_compile_cache()
    seeds = range(args.first, args.first + args.houses)
    with tempfile.TemporaryDirectory() as root:
        bank = load_bank(root, ids=generate_dataset(root, seeds), progress=True)
    for name in args.ids:
        line = judge(bank, name, seeds, args)
        print(json.dumps(line), flush=True)
        if args.out is not None:
            with args.out.open("a") as file:
                file.write(json.dumps(line) + "\n")


def parse() -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("ids", nargs="+", help="ids such as Fetch-v0, of tasks with sampled rows")
    parser.add_argument("--first", type=int, required=True, help="seed of the first house")
    parser.add_argument("--houses", type=int, default=100)
    parser.add_argument("--rows", type=int, default=10, help="episodes per house")
    parser.add_argument("--batch", type=int, default=1000, help="maximum number of parallel episodes")
    parser.add_argument("--out", type=Path, help="file that lines are appended to")
    return parser.parse_args()


def judge(bank: HouseBank, name: str, seeds: range, args: argparse.Namespace) -> dict[str, Any]:
    """Play all rows of one id."""
    begin = time.perf_counter()
    env = add_expert(home_mjx.make(name, bank, sensors=("state",), num_tasks=args.rows))
    rows = env.params.tasks.rows
    drawn, num = time.perf_counter(), rows.house.shape[0]
    figures = evaluate(env, expert_policy, None, num, max_batch=args.batch)
    success = figures["success"]
    return {
        "id": name,
        "device": device_name(),
        "seeds": [seeds.start, seeds.stop],
        "num": num,
        "success": round(float(success.mean()), 4),
        "stderr": round(float(success.std() / np.sqrt(num)), 4),
        "spl": round(float(figures["spl"].mean()), 4),
        "lost": [lost_row(rows, figures, seeds, row) for row in np.flatnonzero(success < 1)],
        "draw_s": round(drawn - begin, 1),
        "play_s": round(time.perf_counter() - drawn, 1),
    }


def lost_row(rows: Episodes, figures: dict[str, np.ndarray], seeds: range, row: int) -> dict[str, Any]:
    """Describe a failed row."""
    return {
        "seed": seeds[int(rows.house[row])],
        "row": int(row),
        "asked": detokenize(rows.columns["tokens"][row]),
        "steps": int(figures["episode_steps"][row]),
        "distance": round(float(figures["distance"][row]), 2) if "distance" in figures else None,
    }


if __name__ == "__main__":
    main()
