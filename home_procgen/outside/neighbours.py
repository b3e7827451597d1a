"""Neighbours' houses or blocks of flats: boxes with painted fronts, visible through windows."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from home_mjx.schema.house import BoxNode, Material
from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.floor_plan.rooms import Rect
from home_procgen.outside.roof import build_gable
from home_procgen.outside.site import STREET_WIDTH, Plot, PlotSide
from home_procgen.primitives.palette import choose_random, plain, textured

CITY_PROBABILITY = 0.22  # probability of blocks of flats
NEIGHBOUR_DISTANCE_RANGE = (3.0, 7.0)  # [m], range from the hedges, or the street's far edge, to the neighbours
NEIGHBOUR_GAP_RANGE = (3.5, 9.0)  # [m], range of the gap between neighbours
MIN_NEIGHBOUR_GAP = 0.8  # [m], minimum gap between neighbours
TINTS = ("#ffffff", "#f3e6cf", "#e8d3bd", "#dfe3e4", "#e9d9b4", "#d9c4b4", "#cfd8cf", "#c98f78")
FRONT_TEXTURES = {
    1: ("front_1", "front_2"),
    2: ("front_3", "front_4"),
    3: ("front_5", "front_6"),
}  # by storeys; 3: blocks
BLOCK_TOP_MATERIAL = plain("#8a8784")  # material of the tops of blocks


@dataclass(frozen=True)
class NeighbourBlock:
    """Walls of a neighbour's house.

    Attributes:
        rect: Its rectangle [m].
        height: Height of the walls [m].
        front: Material of the four walls; its image covers a whole wall.
    """

    rect: Rect
    height: float
    front: Material


def draw_neighbours(
    rng: np.random.Generator, site: Plot, tiles: Sequence[Material]
) -> tuple[tuple[NeighbourBlock, ...], tuple[PlacedModel, ...]]:
    """Draw neighbours on all sides: their walls, and their roofs; blocks of flats have none.

    Args:
        rng: Source of randomness.
        site: The plot.
        tiles: Materials of roofs.
    """
    city = rng.random() < CITY_PROBABILITY
    blocks: list[NeighbourBlock] = []
    for side in site.sides:
        for block in _draw_row(rng, site, side, city):
            taken = [site.street.street_rect(site.lawn, 1.5), *(other.rect for other in blocks)]
            if not any(_are_too_close(block.rect, rect) for rect in taken):
                blocks.append(block)
    roofs = [] if city else [_roof(rng, block, tiles) for block in blocks]
    return tuple(blocks), tuple(roofs)


def _draw_row(rng: np.random.Generator, site: Plot, side: PlotSide, city: bool) -> list[NeighbourBlock]:
    """Draw houses in a row along one side of the plot; they may be too close to those of other sides."""
    low, high = (site.home_rect[1], site.home_rect[3]) if side.direction[0] else (site.home_rect[0], site.home_rect[2])
    at, found = low - float(rng.uniform(0.0, 8.0)), []
    while at < high + 3.0:
        wide, deep = (float(rng.uniform(*r)) for r in ((9, 18) if city else (7.5, 12), (8, 11) if city else (6.5, 8.5)))
        storeys = int(rng.integers(4, 7)) if city else int(rng.choice([1, 2], p=[0.4, 0.6]))
        away = (
            side.distance_from_home
            + (STREET_WIDTH if side is site.street else 0.0)
            + float(rng.uniform(*NEIGHBOUR_DISTANCE_RANGE))
        )
        p, q = sorted((side.coordinate_at(away), side.coordinate_at(away + deep)))
        rect = (p, at, q, at + wide) if side.direction[0] else (at, p, at + wide, q)
        front = textured(choose_random(FRONT_TEXTURES[min(storeys, 3)], rng), choose_random(TINTS, rng))
        found.append(NeighbourBlock(Rect(*np.round(rect, 3).tolist()), round(2.9 * storeys + 0.6 * city, 2), front))
        at += wide + float(rng.uniform(*NEIGHBOUR_GAP_RANGE))
    return found


def _are_too_close(a: Rect, b: Rect) -> bool:
    return (
        min(a.x1, b.x1) - max(a.x0, b.x0) > -MIN_NEIGHBOUR_GAP
        and min(a.z1, b.z1) - max(a.z0, b.z0) > -MIN_NEIGHBOUR_GAP
    )


def _roof(rng: np.random.Generator, block: NeighbourBlock, tiles: Sequence[Material]) -> PlacedModel:
    x0, z0, x1, z1 = block.rect
    materials = (choose_random(tiles, rng), plain("#e0d8c8"), plain("#d8d2c4"))
    return build_gable(
        (x0 + x1) / 2, (z0 + z1) / 2, block.rect.extents, block.height, float(rng.uniform(0.5, 0.8)), materials
    )


def build_block_node(block: NeighbourBlock, index: int) -> BoxNode:
    """Return the box node of a neighbour's walls on the lowest level, from height 0 up; `index` is its node number."""
    x0, z0, x1, z1 = block.rect
    transform = np.eye(4)
    transform[:3, 3] = (x0 + x1) / 2, block.height / 2, (z0 + z1) / 2
    size = np.round([x1 - x0, block.height, z1 - z0], 4)
    # GAPS order: top, bottom, then the four walls.
    materials = (BLOCK_TOP_MATERIAL, BLOCK_TOP_MATERIAL, block.front)
    path = f"levels[0].nodes[{index}]"
    return BoxNode(
        id=f"0_{index}", index=index, path=path, bbox=None, dimensions=size, transform=transform, materials=materials
    )
