"""Compile houses on all cores and save them as one bank: `python benchmarks/make_bank.py OUT --generate 64`."""

import argparse
import os
import tempfile
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

os.environ.setdefault("JAX_PLATFORMS", "cpu")

from views import save_bank

from home_mjx.datasets.registry import open_dataset
from home_mjx.houses import load_bank
from home_mjx.houses.house_cache import HouseCache
from home_procgen import generate_dataset


def compile_some(root, ids):
    """Fill the cache of compiled houses."""
    cache = HouseCache(open_dataset(root))
    for house_id in ids:
        cache.load(house_id)


def main():
    """Parse the command line and save the bank."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--generate", type=int, help="number of generated houses")
    parser.add_argument("--dataset", type=Path, help="dataset of the houses")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    args = parser.parse_args()
    root = args.dataset or Path(tempfile.mkdtemp())
    ids = open_dataset(root).house_ids if args.dataset else generate_dataset(root, range(args.generate))
    compile_some(root, ids[:1])  # warms up the compiler once
    with ProcessPoolExecutor(args.jobs) as pool:
        list(pool.map(partial(compile_some, root), [ids[i :: args.jobs] for i in range(args.jobs)]))
    save_bank(load_bank(root, ids=ids), args.out)


if __name__ == "__main__":
    main()
