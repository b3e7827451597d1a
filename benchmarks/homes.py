"""What homes of the second generator are like, beside SUNCG's: storeys, rooms, types, areas, twins.

    python benchmarks/homes.py [--homes 1000] [--first 0] [--root FOLDER]

Writes the homes where they are not there yet, reads them back and prints a table for docs/dataset.md.
"""

import argparse
import itertools
import sys
from collections import Counter, defaultdict
from pathlib import Path

import numpy as np
from tqdm import tqdm

from home_mjx.datasets import generate_dataset, open_dataset
from home_mjx.datasets.shapes.polygon_slab import signed_area
from home_mjx.scene_compile.architecture.rooms import extract_rooms
from home_mjx.schema.categories import ROOM_TYPES
from home_mjx.schema.compiled import Rooms

# Of SUNCG's 329,195 rooms with a label other than `Room`, in per cent.
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
# Instances in the rooms of the houses of EmbodiedQA (Das et al., 2018), by fine or coarse class: the commonest.
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
CELL, TWIN = 0.25, 0.85  # [m], of room maps, and the part that twins have in common


def room_map(rooms: Rooms) -> np.ndarray:
    """Types of the rooms of the ground floor on a grid; 0 outside."""
    here = np.flatnonzero(rooms.level == 0)
    corners = np.concatenate([rooms.polygon[r] for r in here])
    low, high = corners.min(0), corners.max(0)
    axes = [np.arange(a + CELL / 2, b, CELL) for a, b in zip(low, high, strict=True)]
    place, found = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1), None
    found = np.zeros(place.shape[:2], int)
    for r in here:
        x, y = np.moveaxis(place, -1, 0)
        inside = np.zeros(found.shape, bool)
        polygon = rooms.polygon[r]
        for (x0, y0), (x1, y1) in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
            if y0 != y1:
                inside ^= ((y0 > y) != (y1 > y)) & (x < (x1 - x0) * (y - y0) / (y1 - y0) + x0)
        found[inside] = rooms.type[r] + 1
    return found


def likeness(one: np.ndarray, other: np.ndarray) -> float:
    """Greatest part of both maps together that has the same type, over the eight ways to turn one, corners aligned."""
    best = 0.0
    for turns, flip in itertools.product(range(4), (1, -1)):
        turned = np.rot90(other, turns)[::flip]
        shape = np.maximum(one.shape, turned.shape)
        a, b = (np.zeros(shape, int) for _ in range(2))
        a[: one.shape[0], : one.shape[1]] = one
        b[: turned.shape[0], : turned.shape[1]] = turned
        best = max(best, float(((a == b) & (a > 0)).sum() / ((a > 0) | (b > 0)).sum()))
    return best


def twins(maps: list[np.ndarray]) -> tuple[int, float]:
    """Pairs that are more alike than `TWIN`, and how alike the two most alike are, if by more than half of that."""
    counts = np.array([np.bincount(m.ravel(), minlength=len(ROOM_TYPES) + 1)[1:] for m in maps])
    found, most = 0, 0.0
    for i in tqdm(range(len(maps)), desc="twins"):
        common = np.minimum(counts[i], counts[:i]).sum(1)
        total = np.maximum(counts[i].sum(), counts[:i].sum(1))
        for j in np.flatnonzero(common > 0.8 * total).tolist():
            alike = likeness(maps[i], maps[j])
            most = max(most, alike)
            found += alike > TWIN
    return found, most


def covered(held: dict[str, set[str]]) -> tuple[float, list[str]]:
    """Part of what is asked about that rooms of the same type have, and what is lacking."""
    there, total, lacking = 0, 0, []
    for kind, words in ASKED.items():
        pairs = words.split()
        for name, count in zip(pairs[::2], map(int, pairs[1::2]), strict=True):
            total += count
            there += count * (name in held[kind])
            lacking += [] if name in held[kind] else [f"{kind}: {name}"]
    return there / total, lacking


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--homes", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--root", type=Path, default=Path("homes"))
    args = parser.parse_args()
    ids = generate_dataset(args.root, range(args.first, args.first + args.homes), progress=True, version=2)
    dataset = open_dataset(args.root)
    types, areas, storeys, floors, objects, fine, maps = Counter(), defaultdict(list), [], [], [], Counter(), []
    held, shapes = defaultdict(set), defaultdict(set)
    for name in tqdm(ids, desc="read"):
        house = dataset.load_house(name)
        rooms = extract_rooms(house, np.zeros(3))
        storeys.append(len(house.levels))
        floors += [len(level.rooms) for level in house.levels]
        for kind, polygon in zip(rooms.type.tolist(), rooms.polygon, strict=True):
            types[ROOM_TYPES[kind]] += 1
            areas[ROOM_TYPES[kind]].append(signed_area(polygon))
        objects += [len(room.members) for level in house.levels for room in level.rooms]
        for level in house.levels:
            infos = {item.index: dataset.metadata.info(item.model_id) for item in level.objects}
            for room in level.rooms:
                inside = [infos[i] for i in room.members if i in infos]
                held[room.types[0]] |= {name for info in inside for name in (info.fine, info.coarse)}
                fine.update(info.fine for info in inside)
                for info in inside:
                    shapes[info.fine].add(info.model_id)
        maps.append(room_map(rooms))
    number, most = twins(maps)
    out = sys.stdout.write
    out(f"| | {args.homes:,} homes | SUNCG |\n| --- | ---: | ---: |\n")
    out(f"| storeys | {np.mean(storeys):.2f} | {LEVELS} |\n")
    out(f"| rooms of a floor | {np.mean(floors):.1f} ({min(floors)} to {max(floors)}) | {ROOMS_A_FLOOR} |\n")
    out(f"| objects of a room | {np.mean(objects):.1f} | {OBJECTS_A_ROOM} |\n")
    out(f"| pairs with more than 85 % of the same room map | {number} (most alike: {100 * most:.0f} %) | |\n\n")
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


if __name__ == "__main__":
    main()
