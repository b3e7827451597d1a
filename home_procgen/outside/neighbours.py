"""Neighbours' houses or blocks of flats: boxes with painted fronts, visible through windows."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from home_mjx.schema.house import BoxNode, Material
from home_procgen.floor_plan.placed import PlacedFurniture
from home_procgen.floor_plan.rooms import Rect
from home_procgen.outside.roof import gable
from home_procgen.outside.site import WIDTH, Side, Site
from home_procgen.primitives.palette import choose, plain, textured

CITY = 0.22  # probability of blocks of flats
BEHIND = (3.0, 7.0)  # [m], range from the hedges, or the street's far edge, to the neighbours
APART = (3.5, 9.0)  # [m], range of the gap between neighbours
GAP = 0.8  # [m], minimum gap between neighbours
TINTS = ("#ffffff", "#f3e6cf", "#e8d3bd", "#dfe3e4", "#e9d9b4", "#d9c4b4", "#cfd8cf", "#c98f78")
FRONTS = {1: ("front_1", "front_2"), 2: ("front_3", "front_4"), 3: ("front_5", "front_6")}  # by storeys; 3: blocks
FLAT = plain("#8a8784")  # material of the tops of blocks


@dataclass(frozen=True)
class Block:
    """Walls of a neighbour's house.

    Attributes:
        rect: Its rectangle [m].
        height: Height of the walls [m].
        front: Material of the four walls; its image covers a whole wall.
    """

    rect: Rect
    height: float
    front: Material


def neighbours(
    rng: np.random.Generator, site: Site, tiles: Sequence[Material]
) -> tuple[tuple[Block, ...], tuple[PlacedFurniture, ...]]:
    """Return blocks on all sides, and their roofs.

    Args:
        rng: Source of randomness.
        site: The plot.
        tiles: Materials of roofs.
    """
    city = rng.random() < CITY
    blocks: list[Block] = []
    for side in site.sides:
        for block in _row(rng, site, side, city):
            taken = [site.street.strip(site.lawn, 1.5), *(other.rect for other in blocks)]
            if not any(_meet(block.rect, rect) for rect in taken):
                blocks.append(block)
    roofs = [] if city else [_roof(rng, block, tiles) for block in blocks]
    return tuple(blocks), tuple(roofs)


def _row(rng: np.random.Generator, site: Site, side: Side, city: bool) -> list[Block]:
    """Return houses in a row along one side of the plot."""
    low, high = (site.home[1], site.home[3]) if side.way[0] else (site.home[0], site.home[2])
    at, found = low - float(rng.uniform(0.0, 8.0)), []
    while at < high + 3.0:
        wide, deep = (float(rng.uniform(*r)) for r in ((9, 18) if city else (7.5, 12), (8, 11) if city else (6.5, 8.5)))
        storeys = int(rng.integers(4, 7)) if city else int(rng.choice([1, 2], p=[0.4, 0.6]))
        away = side.away + (WIDTH if side is site.street else 0.0) + float(rng.uniform(*BEHIND))
        p, q = sorted((side.at(away), side.at(away + deep)))
        rect = (p, at, q, at + wide) if side.way[0] else (at, p, at + wide, q)
        front = textured(choose(FRONTS[min(storeys, 3)], rng), choose(TINTS, rng))
        found.append(Block(Rect(*np.round(rect, 3).tolist()), round(2.9 * storeys + 0.6 * city, 2), front))
        at += wide + float(rng.uniform(*APART))
    return found


def _meet(a: Rect, b: Rect) -> bool:
    return min(a.x1, b.x1) - max(a.x0, b.x0) > -GAP and min(a.z1, b.z1) - max(a.z0, b.z0) > -GAP


def _roof(rng: np.random.Generator, block: Block, tiles: Sequence[Material]) -> PlacedFurniture:
    x0, z0, x1, z1 = block.rect
    materials = (choose(tiles, rng), plain("#e0d8c8"), plain("#d8d2c4"))
    return gable((x0 + x1) / 2, (z0 + z1) / 2, block.rect.sides, block.height, float(rng.uniform(0.5, 0.8)), materials)


def block_node(block: Block, index: int) -> BoxNode:
    """Return the node of a block on the lowest level."""
    x0, z0, x1, z1 = block.rect
    transform = np.eye(4)
    transform[:3, 3] = (x0 + x1) / 2, block.height / 2, (z0 + z1) / 2
    size = np.round([x1 - x0, block.height, z1 - z0], 4)
    # GAPS order: top, bottom, then the four walls.
    materials = (FLAT, FLAT, block.front)
    path = f"levels[0].nodes[{index}]"
    return BoxNode(
        id=f"0_{index}", index=index, path=path, bbox=None, dimensions=size, transform=transform, materials=materials
    )
