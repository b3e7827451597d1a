"""Check generated homes, and compare their statistics with SUNCG's.

    python benchmarks/homes.py [--homes 1000] [--first 0] [--every 20] [--seconds 500] [--workers N] [--root FOLDER]

Writes homes with N processes, checks each (`home_checks.py`) and appends a line for it to `FOLDER.jsonl`. It can be
stopped at any time and continued. Prints the results, and a table for docs/dataset.md. `--compare N` instead writes the
same homes with N processes into `FOLDER-N` and compares digests. Needs only the package and, from the clone,
`tests/helpers`.
"""

import argparse
import itertools
import json
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from contextlib import contextmanager
from functools import lru_cache, partial
from pathlib import Path

import numpy as np
from home_checks import Record, check_home, digest, unpacked
from tqdm import tqdm

from home_mjx.core.workers import usable_cores, worker_pool
from home_mjx.datasets import open_dataset
from home_mjx.datasets.base import Dataset
from home_mjx.datasets.suncg.formats.asset_library import AssetLibrary
from home_procgen import dataset_writer, generate_dataset
from home_procgen.generate import write_home
from home_procgen.presets import Variant

# Shares of SUNCG's 329,195 rooms with a label other than `Room` [%].
SUNCG = {
    "Bedroom": 20.8,
    "Bathroom": 15.5,
    "Toilet": 13.4,
    "Kitchen": 11.1,
    "Living_Room": 7.8,
    "Office": 5.8,
    "Dining_Room": 5.0,
    "Garage": 3.8,
    "Hallway": 3.1,
    "Hall": 2.4,
    "Balcony": 1.7,
    "Child_Room": 1.6,
    "Gym": 1.5,
    "Wardrobe": 1.1,
    "Storage": 1.0,
    "Guest_Room": 0.9,
    "Terrace": 0.8,
    "Entryway": 0.7,
    "Lobby": 0.7,
    "Loggia": 0.5,
    "Boiler_room": 0.3,
}
# Most frequent instances in the rooms of EmbodiedQA's houses (Das et al., 2018), by fine or coarse class.
ASKED = {
    "Bedroom": """wardrobe_cabinet 1832 bed 1773 chair 1151 table_lamp 1074 rug 930 curtain 912 television 907
        picture_frame 724 dresser 614 desk 596 dressing_table 551 plant 468 air_conditioner 458 laptop 450
        floor_lamp 450 ottoman 431 tv_stand 429 mirror 418 table 391 wall_lamp 370 computer 352 sofa 251 hanger 238
        vase 219 bunker_bed 198""",
    "Living_Room": """chair 1803 sofa 1344 table 1310 plant 934 television 657 rug 624 curtain 614 picture_frame 594
        tv_stand 461 floor_lamp 412 vase 407 loudspeaker 363 ottoman 332 wall_lamp 241 fireplace 220 stereo_set 185
        fish_tank 183 air_conditioner 160 clock 159""",
    "Kitchen": """chair 3118 table 606 refrigerator 576 kettle 475 plant 438 cup 436 microwave 423 plates 405
        coffee_machine 350 knife_rack 344 cutting_board 322 curtain 312 food_processor 307 utensil_holder 282
        fruit_bowl 280 picture_frame 257 rug 255 pan 250 trash_can 228 water_dispenser 217 range_hood 211 sofa 188
        bottle 171 dishwasher 120 range_oven 116""",
    "Dining_Room": """chair 5408 table 1130 plant 783 cup 608 plates 506 curtain 425 picture_frame 424 rug 404 sofa 376
        vase 277 refrigerator 269""",
    "Bathroom": """toilet 1715 sink 1384 shower 899 bathtub 861 towel_rack 741 rug 632 mirror 517 wardrobe_cabinet 378
        plant 312 hanger 296 wall_lamp 289 partition 288 curtain 232 washer 168 trash_can 139""",
    "Garage": "car 446 garage_door 356 motorcycle 255 wall_lamp 58 plant 47",
    "Gym": "gym_equipment 567 table 56 chair 43",
    "Balcony": "fence 123 chair 90 outdoor_lamp 64 wall_lamp 44",
}
LEVELS, ROOMS_A_FLOOR, OBJECTS_A_ROOM = 1.28, 8.1, 14.1
ALIKE = 0.85  # minimum common share of the room maps of homes that count as alike


def likeness(one: np.ndarray, other: np.ndarray) -> float:
    """Compute the largest common share of two room maps over eight orientations, corners aligned."""
    best = 0.0
    for turns, flip in itertools.product(range(4), (1, -1)):
        turned = np.rot90(other, turns)[::flip]
        shape = np.maximum(one.shape, turned.shape)
        a, b = (np.zeros(shape, int) for _ in range(2))
        a[: one.shape[0], : one.shape[1]] = one
        b[: turned.shape[0], : turned.shape[1]] = turned
        best = max(best, float(((a == b) & (a > 0)).sum() / ((a > 0) | (b > 0)).sum()))
    return best


def alike(maps: list[np.ndarray]) -> tuple[int, int, float]:
    """Return the number of pairs with equal maps, of pairs more alike than `ALIKE`, and the largest likeness."""
    most_types = max(int(m.max()) for m in maps)
    counts = np.array([np.bincount(m.ravel(), minlength=most_types + 1)[1:] for m in maps])
    found, most = [0, 0], 0.0
    for i in tqdm(range(len(maps)), desc="twins"):
        common = np.minimum(counts[i], counts[:i]).sum(1)
        total = np.maximum(counts[i].sum(), counts[:i].sum(1))
        for j in np.flatnonzero(common > 0.8 * total).tolist():
            part = likeness(maps[i], maps[j])
            most = max(most, part)
            found[0] += part == 1.0
            found[1] += part > ALIKE
    return found[0], found[1], most


def covered(held: dict[str, set[str]]) -> tuple[float, list[str]]:
    """Return the share of classes in questions that rooms of the same type contain, and the missing ones."""
    there, total, lacking = 0, 0, []
    for kind, words in ASKED.items():
        pairs = words.split()
        for name, count in zip(pairs[::2], map(int, pairs[1::2]), strict=True):
            total += count
            there += count * (name in held[kind])
            lacking += [] if name in held[kind] else [f"{kind}: {name}"]
    return there / total, lacking


def look(records: Path, root: Path, seeds: Sequence[int], every: int, seconds: float, workers: int) -> list[Record]:
    """Return the records of the homes, including earlier ones; `workers` processes run until the time limit."""
    deadline = time.time() + seconds
    root.parent.mkdir(parents=True, exist_ok=True)
    known = {r["seed"]: r for r in map(json.loads, records.read_text().splitlines())} if records.exists() else {}
    generate_dataset(root, seeds[:1])  # writes the tables
    lacking = [s for s in seeds if s not in known or (s % every == 0 and "drift" not in known[s])]
    one = partial(look_at, root.absolute(), every, deadline)
    with records.open("a") as file, mapper(min(workers, len(lacking))) as run:
        for record in tqdm(run(one, lacking), desc="homes", total=len(seeds), initial=len(seeds) - len(lacking)):
            if record is not None:
                known[record["seed"]] = record
                file.write(json.dumps(record) + "\n")
                file.flush()
    return [known[seed] for seed in seeds if seed in known]


Job = Callable[[int], Record | None]


@contextmanager
def mapper(workers: int) -> Iterator[Callable[[Job, list[int]], Iterator[Record | None]]]:
    """Start `workers` processes and yield their unordered `map`."""
    if workers < 2:
        yield map
        return
    with worker_pool(workers) as pool:
        yield lambda job, seeds: (done.result() for done in as_completed(pool.submit(job, seed) for seed in seeds))


def look_at(root: Path, every: int, deadline: float, seed: int) -> Record | None:
    """Write and check a home; return None after the time limit."""
    if time.time() > deadline:
        return None
    start = time.process_time()
    write_home(root, seed)
    spent = time.process_time() - start
    return check_home(opened(root), seed, seed % every == 0) | {"written": round(spent, 3)}


@lru_cache(maxsize=1)
def library(root: Path) -> AssetLibrary:
    """Return the models that this process has read."""
    return AssetLibrary(root)


def opened(root: Path) -> Dataset:
    """Open the dataset in its current state, because it lists its homes only once."""
    dataset = open_dataset(root)
    dataset.assets = library(root)
    return dataset


def report(found: list[Record]) -> None:
    """Print the violations."""
    out, deep = sys.stdout.write, [r for r in found if "drift" in r]
    out(f"{len(found)} homes, {found[0]['seed']} to {found[-1]['seed']}; {len(deep)} walked, compiled and simulated\n")
    for key in ("findings", "links", "shut", "floating", "overlaps"):
        out(f"{key}: {sum(len(r[key]) for r in found)} {[(r['seed'], r[key]) for r in found if r[key]][:20]}\n")
    out(f"homes without exactly one entrance: {sum(r['entrances'] != 1 for r in found)}\n")
    out(f"rooms that are not reached: {[(r['seed'], r['unreached']) for r in deep if any(r['unreached'].values())]}\n")
    rooms = sum(sum(r["floors"]) for r in deep)
    out(f"  of {rooms} rooms, {sum(r['storeys'] > 1 for r in deep)} homes with stairs\n")
    stuck = [(r["seed"], r["stuck"]) for r in deep if r["stuck"]]
    out(f"hinges: {sum(r['hinges'] for r in deep)}, stuck: {stuck}\n")
    drift = sorted(((r["drift"], r["seed"]) for r in deep), reverse=True)
    out(f"free bodies: {sum(r['free'] for r in deep)}, most drift [m]: {drift[:5]}\n")
    spent: Counter[str] = Counter()
    for record in found:
        spent.update(record["times"])
    out(f"seconds: { {name: round(value, 1) for name, value in spent.items()} }\n")
    cost = [r["written"] for r in found if "written" in r]
    if cost:
        out(f"processor seconds to draw and write a home: mean {np.mean(cost):.2f}, most {max(cost):.2f}\n")


def table(found: list[Record]) -> None:
    """Print statistics, next to SUNCG's."""
    types, areas, fine = Counter(), defaultdict(list), Counter()
    held, shapes = defaultdict(set), defaultdict(set)
    for record in found:
        for kind, area in zip(record["rooms"], record["areas"], strict=True):
            types[kind] += 1
            areas[kind].append(area)
        for kind, things in record["held"].items():
            for name, coarse, model in (thing.split("/") for thing in things):
                held[kind] |= {name, coarse}
                shapes[name].add(model)
                fine[name] += 1
    storeys, floors = [r["storeys"] for r in found], [n for r in found for n in r["floors"]]
    twins, similar, most = alike([unpacked(r["map"]) for r in found])
    out = sys.stdout.write
    out(f"| | {len(found):,} homes | SUNCG |\n| --- | ---: | ---: |\n")
    out(f"| storeys | {np.mean(storeys):.2f} | {LEVELS} |\n")
    out(f"| rooms of a floor | {np.mean(floors):.1f} ({min(floors)} to {max(floors)}) | {ROOMS_A_FLOOR} |\n")
    out(f"| objects of a room | {np.mean([n for r in found for n in r['objects']]):.1f} | {OBJECTS_A_ROOM} |\n")
    out(f"| pairs with the same room map | {twins} | |\n")
    out(f"| pairs with more than 85 % of it | {similar} (most alike: {100 * most:.1f} %) | |\n\n")
    out("| Room | Part of all rooms [%] | SUNCG [%] | Area [m²], 10th, 50th and 90th percentile |\n")
    out("| --- | ---: | ---: | --- |\n")
    for kind, count in types.most_common():
        low, middle, high = np.quantile(areas[kind], [0.1, 0.5, 0.9])
        part = 100 * count / types.total()
        out(f"| `{kind}` | {part:.1f} | {SUNCG.get(kind, 0):.1f} | {low:.1f}, {middle:.1f}, {high:.1f} |\n")
    out(f"\n{len(fine)} fine categories, {sum(map(len, shapes.values()))} models, ")
    out(f"storeys {dict(sorted(Counter(storeys).items()))}\n")
    out("shapes: " + ", ".join(f"{name} {len(shapes[name])}" for name, _ in fine.most_common(40)) + "\n")
    share, lacking = covered(held)
    out(f"of the commonest instances of EmbodiedQA, {100 * share:.1f} % are of categories in rooms of their type; ")
    out(f"not: {', '.join(lacking) or 'none'}\n")


def compare(root: Path, found: list[Record], workers: int) -> None:
    """Write the homes again with worker processes, and count those whose files differ."""
    dataset_writer.max_workers = lambda count: min(count, workers)  # as on a machine with this number of cores
    start = time.monotonic()
    generate_dataset(root, [r["seed"] for r in found], progress=True)
    spent = time.monotonic() - start
    differ = [r["seed"] for r in found if digest(root, Variant().house_id(r["seed"])) != r["sha256"]]
    sys.stdout.write(f"{len(found)} homes by {workers} processes in {spent:.1f} s; other bytes: {differ}\n")


def main() -> None:
    """Check homes, and print the results."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--homes", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--root", type=Path, default=Path("homes"))
    parser.add_argument(
        "--every", type=int, default=20, help="walk, compile and simulate homes whose seed is a multiple of this"
    )
    parser.add_argument("--seconds", type=float, default=float("inf"), help="time limit of checking [s]")
    parser.add_argument(
        "--workers", type=int, default=usable_cores(), help="number of processes (default: number of cores)"
    )
    parser.add_argument(
        "--compare", type=int, default=0, help="number of processes that write the homes again, for a comparison"
    )
    args = parser.parse_args()
    records, seeds = args.root.with_suffix(".jsonl"), range(args.first, args.first + args.homes)
    if args.compare:
        found = look(records, args.root, seeds, args.every, 0.0, 1)
        compare(args.root.with_name(f"{args.root.name}-{args.compare}"), found, args.compare)
        return
    found = look(records, args.root, seeds, args.every, args.seconds, args.workers)
    if found:
        report(found)
        if len(found) == len(seeds):
            table(found)


if __name__ == "__main__":
    main()
