"""Surroundings of a home: roofs, lawn, street, hedges, trees and neighbours. None of them is reachable.

They use a source of randomness of their own, so that the interior does not depend on them.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from home_mjx.schema.house import Material
from home_procgen.floor_plan.placed import FACING, PlacedFurniture
from home_procgen.floor_plan.rooms import Rect
from home_procgen.outside.ground import Patch
from home_procgen.outside.models import outside_models
from home_procgen.outside.neighbours import Block, neighbours
from home_procgen.outside.roof import roofs
from home_procgen.outside.site import Site
from home_procgen.plan.home import HomePlan
from home_procgen.plan.needs.room_program import OUTDOORS
from home_procgen.primitives.palette import choose, plain, textured

PITCHES = (0.45, 0.85)  # rise per run
TILES = tuple(textured(name) for name in ("roof_1", "roof_2", "roof_3", "roof_4"))
LAWNS = (textured("grass_1"), textured("grass_2"), textured("grass_1", "#d8e0b0"))
PAVED = (textured("path_1"), textured("path_2"), textured("concrete_2"))
ASPHALT, PAVEMENT = textured("concrete_1", "#6a6a6e"), textured("concrete_2")
LEAVES = tuple(
    textured(*leaf) for leaf in (("foliage_1",), ("foliage_2",), ("foliage_3", "#d8e0c8"), ("foliage_1", "#c8d4b8"))
)
BARK = textured("wood_2", "#c8c0b8")
TREES, BUSHES = (4, 9), (2, 6)  # range of the number; the upper end is exclusive


@dataclass(frozen=True)
class Outside:
    """Surroundings of a home.

    Attributes:
        things: Objects with a model, roofs first.
        blocks: Neighbours' walls.
        grounds: Patches of ground.
    """

    things: tuple[PlacedFurniture, ...]
    blocks: tuple[Block, ...]
    grounds: tuple[Patch, ...]


def draw_outside(seed: int, plan: HomePlan, facade: Material) -> Outside:
    """Draw the surroundings of a seed's home.

    Args:
        seed: Seed of the home.
        plan: Its storeys.
        facade: Material of its outer walls.

    Example:
        >>> from home_procgen.design import draw_design
        >>> design = draw_design(7)
        >>> len(draw_outside(7, design.plan, design.surfaces[0][0].outside).grounds) >= 2
        True
    """
    rng = np.random.default_rng(np.random.SeedSequence([seed, 2, 1]))
    site = Site.around(rng, plan)
    covered = [rect for room in plan.levels[-1].rooms if room.type not in OUTDOORS for rect in room.rects]
    tiles, pitch = choose(TILES, rng), float(rng.uniform(*PITCHES))
    blocks, their_roofs = neighbours(rng, site, TILES)
    own_roofs = roofs(covered, plan.height * len(plan.levels), pitch, (tiles, facade, plain("#e4ded2")))
    return Outside(
        things=(*own_roofs, *their_roofs, *_hedges(rng, site), *_plants(rng, site)),
        blocks=blocks,
        grounds=tuple(_grounds(rng, site, plan)),
    )


def _grounds(rng: np.random.Generator, site: Site, plan: HomePlan) -> Iterator[Patch]:
    """Generate the lawn, the street with its pavement, and the paths from doors to the street."""
    yield Patch(site.lawn, 0.0, choose(LAWNS, rng))
    yield Patch(site.street.strip(site.lawn, 1.5), 0.01, PAVEMENT)
    yield Patch(site.street.strip(site.lawn, 0.0), 0.02, ASPHALT)
    paved = choose(PAVED, rng)
    for opening in plan.levels[0].openings:
        kind = opening.placed.model.fine
        if len(opening.rooms) == 1 and kind in ("door", "garage_door"):
            outward = np.array(FACING[opening.placed.quarter]) * (1 if kind == "door" else -1)
            path = _path(site, opening.placed, (int(outward[0]), int(outward[1])))
            if path is not None:
                yield Patch(path, 0.015, paved)


def _path(site: Site, door: PlacedFurniture, way: tuple[int, int]) -> Rect | None:
    """Return the path from a door to the street, or 3 m of it on other sides; None if the home itself is in the way."""
    (x, _, z), half = door.position, float(door.size[0]) / 2 + 0.1
    far = site.street.distance((x, z)) if way == site.street.way else 3.0
    ends = np.array([(x, z), (x + way[0] * far, z + way[1] * far)]) + 0.05 * np.array(way)
    low, high = ends.min(0), ends.max(0)
    across = np.abs(np.array(way[::-1])) * half
    path = Rect(*np.round([*(low - across), *(high + across)], 3).tolist())
    return None if any(_meet(path, rect) for rect in site.rects) else path


def _meet(a: Rect, b: Rect, gap: float = 0.0) -> bool:
    return min(a.x1, b.x1) - max(a.x0, b.x0) > -gap and min(a.z1, b.z1) - max(a.z0, b.z0) > -gap


def _hedges(rng: np.random.Generator, site: Site) -> Iterator[PlacedFurniture]:
    """Generate hedges along the sides of the garden without the street."""
    models, leaves = outside_models()["hedge"], (choose(LEAVES, rng),)
    tall = round(float(rng.uniform(0.8, 1.25)), 2)
    for side in site.sides[1:]:
        if rng.random() < 0.25:
            continue
        rect = side.line(site.garden)
        long = max(rect.sides)
        count = int(np.ceil(long / 14))
        number = int(np.argmin([abs(np.log(long / count / m.size[0])) for m in models]))
        model, along = models[number], int(side.way[0] != 0)
        for k in range(count):
            at = rect[along] + (k + 0.5) * long / count
            x, z = (at, rect[1]) if along == 0 else (rect[0], at)
            scale = (round(long / count / float(model.size[0]), 4), tall, 1.0)
            yield PlacedFurniture(model, (0.0, 0.0, 0.0), 0, scale, materials=leaves).at(x, 0.0, z, along)


def _plants(rng: np.random.Generator, site: Site) -> Iterator[PlacedFurniture]:
    """Generate trees, with crowns clear of the home, and bushes."""
    for kind, numbers in (("tree", TREES), ("bush", BUSHES)):
        for _ in range(int(rng.integers(*numbers))):
            model, size = choose(outside_models()[kind], rng), round(float(rng.uniform(0.8, 1.2)), 3)
            place = site.spot(rng, float(max(model.size[0], model.size[2])) / 2 * size)
            if place is not None:
                dressed = tuple(BARK if slot == "bark" else choose(LEAVES, rng) for slot in model.slots)
                one = PlacedFurniture(model, (0.0, 0.0, 0.0), 0, (size, size, size), materials=dressed)
                yield one.at(*(place[0], 0.0, place[1]), int(rng.integers(4)))
