"""Surroundings of a home: roofs, lawn, street, hedges, trees and neighbours. None of them is reachable.

They use a source of randomness of their own, so that the interior does not depend on them.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from home_mjx.geometry.mesh_pieces import MeshPiece, join_pieces
from home_mjx.geometry.slabs import slab
from home_mjx.schema.house import GroundNode, Material
from home_procgen.floor_plan.placed_model import FRONT_DIRECTIONS, PlacedModel
from home_procgen.floor_plan.rooms import Rect
from home_procgen.outside.models import outside_models
from home_procgen.outside.neighbours import NeighbourBlock, draw_neighbours
from home_procgen.outside.roof import build_roofs
from home_procgen.outside.site import Plot
from home_procgen.plan.home import HomePlan
from home_procgen.plan.shape.program import OUTDOOR_TYPES
from home_procgen.primitives.palette import choose_random, plain, textured
from home_procgen.textures.recipes import repeat_uv

PITCH_RANGE = (0.45, 0.85)  # rise per run
TILES = tuple(textured(name) for name in ("roof_1", "roof_2", "roof_3", "roof_4"))
LAWNS = (textured("grass_1"), textured("grass_2"), textured("grass_1", "#d8e0b0"))
PATH_MATERIALS = (textured("path_1"), textured("path_2"), textured("concrete_2"))
ASPHALT, PAVEMENT = textured("concrete_1", "#6a6a6e"), textured("concrete_2")
LEAVES = tuple(
    textured(*leaf) for leaf in (("foliage_1",), ("foliage_2",), ("foliage_3", "#d8e0c8"), ("foliage_1", "#c8d4b8"))
)
BARK = textured("wood_2", "#c8c0b8")
TREE_COUNT_RANGE, BUSH_COUNT_RANGE = (4, 9), (2, 6)  # range of the number; the upper end is exclusive

UNDERSIDE_HEIGHT = -0.1  # [m], height of the undersides of all slabs


@dataclass(frozen=True)
class GroundPatch:
    """A rectangle of ground.

    Attributes:
        rect: The rectangle [m].
        top: Height of its surface [m]; walls begin at 0.
        material: Material of its surface.
    """

    rect: Rect
    top: float
    material: Material


@dataclass(frozen=True)
class Surroundings:
    """Surroundings of a home.

    Attributes:
        objects: Objects with a model, roofs first.
        blocks: Neighbours' walls.
        grounds: Patches of ground.
    """

    objects: tuple[PlacedModel, ...]
    blocks: tuple[NeighbourBlock, ...]
    grounds: tuple[GroundPatch, ...]


def draw_surroundings(seed: int, plan: HomePlan, facade: Material) -> Surroundings:
    """Draw the surroundings of a seed's home, with its own roof, neighbours, hedges, plants and ground.

    Args:
        seed: Seed of the home.
        plan: Its storeys.
        facade: Material of its outer walls.

    Example:
        >>> from home_procgen.design import draw_design
        >>> design = draw_design(7)
        >>> len(draw_surroundings(7, design.plan, design.surfaces[0][0].outside).grounds) >= 2
        True
    """
    rng = np.random.default_rng(np.random.SeedSequence([seed, 2, 1]))
    site = Plot.draw(rng, plan)
    covered = [rect for room in plan.levels[-1].rooms if room.type not in OUTDOOR_TYPES for rect in room.rects]
    tiles, pitch = choose_random(TILES, rng), float(rng.uniform(*PITCH_RANGE))
    blocks, their_roofs = draw_neighbours(rng, site, TILES)
    own_roofs = build_roofs(covered, plan.height * len(plan.levels), pitch, (tiles, facade, plain("#e4ded2")))
    return Surroundings(
        objects=(*own_roofs, *their_roofs, *_hedges(rng, site), *_plants(rng, site)),
        blocks=blocks,
        grounds=tuple(_grounds(rng, site, plan)),
    )


def _grounds(rng: np.random.Generator, site: Plot, plan: HomePlan) -> Iterator[GroundPatch]:
    """Generate the lawn, the street with its pavement, and the paths from doors to the street."""
    yield GroundPatch(site.lawn, 0.0, choose_random(LAWNS, rng))
    yield GroundPatch(site.street.street_rect(site.lawn, 1.5), 0.01, PAVEMENT)
    yield GroundPatch(site.street.street_rect(site.lawn, 0.0), 0.02, ASPHALT)
    paved = choose_random(PATH_MATERIALS, rng)
    for opening in plan.levels[0].openings:
        kind = opening.object.model.fine
        if len(opening.rooms) == 1 and kind in ("door", "garage_door"):
            outward = np.array(FRONT_DIRECTIONS[opening.object.quarter]) * (1 if kind == "door" else -1)
            path = _path(site, opening.object, (int(outward[0]), int(outward[1])))
            if path is not None:
                yield GroundPatch(path, 0.015, paved)


def _path(site: Plot, door: PlacedModel, way: tuple[int, int]) -> Rect | None:
    """Return the path from a door to the street, or 3 m of it on other sides; None if the home itself is in the way."""
    (x, _, z), half = door.position, float(door.size[0]) / 2 + 0.1
    far = site.street.distance((x, z)) if way == site.street.direction else 3.0
    ends = np.array([(x, z), (x + way[0] * far, z + way[1] * far)]) + 0.05 * np.array(way)
    low, high = ends.min(0), ends.max(0)
    across = np.abs(np.array(way[::-1])) * half
    path = Rect(*np.round([*(low - across), *(high + across)], 3).tolist())
    return None if any(_rects_overlap(path, rect) for rect in site.rects) else path


def _rects_overlap(a: Rect, b: Rect, gap: float = 0.0) -> bool:
    return min(a.x1, b.x1) - max(a.x0, b.x0) > -gap and min(a.z1, b.z1) - max(a.z0, b.z0) > -gap


def _hedges(rng: np.random.Generator, site: Plot) -> Iterator[PlacedModel]:
    """Generate hedges along the three sides of the garden without the street; each side has one at random."""
    models, leaves = outside_models()["hedge"], (choose_random(LEAVES, rng),)
    tall = round(float(rng.uniform(0.8, 1.25)), 2)
    for side in site.sides[1:]:
        if rng.random() < 0.25:
            continue
        rect = side.garden_line(site.garden)
        long = max(rect.extents)
        count = int(np.ceil(long / 14))
        number = int(np.argmin([abs(np.log(long / count / m.size[0])) for m in models]))
        model, along = models[number], int(side.direction[0] != 0)
        for k in range(count):
            at = rect[along] + (k + 0.5) * long / count
            x, z = (at, rect[1]) if along == 0 else (rect[0], at)
            scale = (round(long / count / float(model.size[0]), 4), tall, 1.0)
            yield PlacedModel(model, (0.0, 0.0, 0.0), 0, scale, materials=leaves).moved_to(x, 0.0, z, along)


def _plants(rng: np.random.Generator, site: Plot) -> Iterator[PlacedModel]:
    """Generate trees, with crowns clear of the home, and bushes, in random numbers and sizes."""
    for kind, numbers in (("tree", TREE_COUNT_RANGE), ("bush", BUSH_COUNT_RANGE)):
        for _ in range(int(rng.integers(*numbers))):
            model, size = choose_random(outside_models()[kind], rng), round(float(rng.uniform(0.8, 1.2)), 3)
            place = site.draw_plant_spot(rng, float(max(model.size[0], model.size[2])) / 2 * size)
            if place is not None:
                dressed = tuple(BARK if slot == "bark" else choose_random(LEAVES, rng) for slot in model.slots)
                one = PlacedModel(model, (0.0, 0.0, 0.0), 0, (size, size, size), materials=dressed)
                yield one.moved_to(*(place[0], 0.0, place[1]), int(rng.integers(4)))


def build_ground_node(patch: GroundPatch, index: int, folder: Path) -> GroundNode:
    """Return the node of a patch on the lowest level.

    Args:
        patch: The patch.
        index: Index of the node in its level.
        folder: Folder of the house's meshes.
    """
    x0, z0, x1, z1 = patch.rect
    outline = np.array([(x0, z0), (x1, z0), (x1, z1), (x0, z1)])
    stem = f"fr_0gd_{index}"
    piece = MeshPiece(f"Ground#0_{index}", *slab([outline], UNDERSIDE_HEIGHT, patch.top, 0.0), np.zeros(12, int))
    mesh = repeat_uv(join_pieces(folder / f"{stem}f.obj", [piece], [patch.material]), ("ground",))
    return GroundNode(
        id=f"0_{index}", index=index, path=f"levels[0].nodes[{index}]", bbox=None, model_id=stem, mesh=mesh
    )
