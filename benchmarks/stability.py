"""Measure the drift of every movable object over 10 s without agents, with boxes and with convex pieces.

    python benchmarks/stability.py [--dataset ROOT] [--houses 100] [--seconds 10]

Prints one JSON line per house and kind of collision, then the shares of objects that drift less than 2 cm.
"""

import argparse
import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from tqdm import tqdm

from home_mjx.datasets.registry import open_dataset
from home_mjx.houses.house_cache import HouseCache
from home_mjx.houses.house_set import HouseSet
from home_mjx.scene_compile.mjcf.export import OVERLAPS_FILE, to_mjcf
from home_mjx.scene_compile.mjcf.initial_overlaps import measure_rest_drift
from home_mjx.schema.categories import COLLISIONS
from home_mjx.schema.compiled import CompiledHouse

LIMIT = 0.02  # [m] maximum drift of a stable object


def houses(root: Path | None, count: int) -> Iterator[CompiledHouse]:
    """Yield the houses of a dataset, then generated ones."""
    if root is not None:
        dataset = open_dataset(root)
        yield from map(HouseCache(dataset).load, dataset.house_ids)
    yield from HouseSet(f"procedural:{count}").load(progress=True)


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--dataset", type=Path, help="root of a dataset to measure in addition")
    parser.add_argument("--houses", type=int, default=100, help="number of generated houses (default: 100)")
    parser.add_argument("--seconds", type=float, default=10.0, help="simulated time [s] (default: 10)")
    args = parser.parse_args()
    drifts: dict[str, list[float]] = {name: [] for name in COLLISIONS}
    for house in tqdm(houses(args.dataset, args.houses), unit="house"):
        for collision in COLLISIONS:
            xml, files = to_mjcf(house, collision=collision)
            drift = measure_rest_drift(xml, files, args.seconds)
            drifts[collision] += drift.values()
            overlaps = json.loads(files.get(OVERLAPS_FILE, b"[]"))
            excluded = sum(len(entry["excluded"]) for entry in overlaps)
            print(json.dumps({"house": house.id, "collision": collision, "excluded": excluded, "drift": drift}))
    for collision, values in drifts.items():
        share = np.mean(np.array(values) < LIMIT)
        print(
            f"{collision}: {share:.2%} of {len(values)} objects drift less than {100 * LIMIT:.0f} cm in "
            f"{args.seconds:g} s; median {1000 * np.median(values):.2f} mm, most {1000 * np.max(values):.1f} mm"
        )


if __name__ == "__main__":
    main()
