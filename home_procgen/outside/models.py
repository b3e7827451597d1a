"""Library models outside the home: roofs, trees, bushes, hedges. They have few triangles because they are far away."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TypeVar

import numpy as np

from home_mjx.schema.house import Material
from home_procgen.primitives.family import FurnitureModel, Meshes
from home_procgen.primitives.palette import plain, textured
from home_procgen.primitives.solids import Solid, box, cylinder, lathe, to_mesh
from home_procgen.shapes.normals import corner_normals
from home_procgen.textures.recipes import repeat_uv

T = TypeVar("T")
MODEL_PITCH = 0.65  # rise per run of the models' roofs
EAVES_OVERHANG, EDGE_THICKNESS = 0.4, 0.14  # [m], overhang of a roof, and thickness of its edge
ROOF_SLOTS = ("tiles", "gable", "eaves")  # material slots
ROOF_SIZES = ((5.0, 4.0), (8.0, 6.0), (12.0, 9.0), (16.0, 8.0), (20.0, 12.0))  # [m], lengths along the ridge and across
SLOT_MATERIALS: Mapping[str, Material] = {
    "tiles": textured("roof_1"),
    "gable": plain("#e8e2d4"),
    "eaves": plain("#d8d2c4"),
    "leaf": textured("foliage_1"),
    "bark": textured("wood_2"),
}


def gable_roof(length: float, across: float) -> Solid:
    """Return a roof with its ridge along x, flat underneath so that its eaves stay above the ceilings.

    Args:
        length: Length of the walls below, along the ridge [m].
        across: Length of the walls below, across the ridge [m].
    """
    x, z = length / 2 + EAVES_OVERHANG, across / 2 + EAVES_OVERHANG
    profile = np.array(
        [(-z, 0.0), (z, 0.0), (z, EDGE_THICKNESS), (0.0, EDGE_THICKNESS + MODEL_PITCH * z), (-z, EDGE_THICKNESS)]
    )
    vertices = np.array([(end, y, w) for end in (-x, x) for w, y in profile])
    sides = [(i, (i + 1) % 5) for i in range(5)]
    faces = [f for a, b in sides for f in ((a, b, b + 5), (a, b + 5, a + 5))]
    faces += [(0, 4, 3), (0, 3, 1), (1, 3, 2), (5, 8, 9), (5, 6, 8), (6, 7, 8)]
    names = ["eaves"] * 4 + ["tiles"] * 4 + ["eaves"] * 2 + ["gable"] * 6
    outward = np.array(faces)[:, ::-1]
    corners = vertices[outward]
    slope = corners[..., 2] * np.hypot(1.0, MODEL_PITCH)
    upright = np.array([name == "gable" for name in names])[:, None]
    uv = np.where(upright[..., None], corners[..., [2, 1]], np.stack([corners[..., 0], slope], -1))
    slots = tuple(ROOF_SLOTS.index(name) for name in names)
    return Solid(vertices, outward, uv, slots)


def round_tree(height: float, wide: float) -> Iterator[Solid]:
    """Generate a tree with a round crown, of a total height and a crown width [m], its trunk from y = 0 up."""
    low = 0.3 * height
    yield cylinder("bark", 0.05 * wide, low + 0.15 * height, top=0.03 * wide, sides=6)
    middle, half = (low + height) / 2, (height - low) / 2
    profile = [(0.5 * wide * np.sin(a), middle - half * np.cos(a)) for a in np.linspace(0.35, np.pi - 0.3, 6)]
    yield lathe("leaf", profile, sides=9)
    for turn, up in ((0.4, 0.1), (2.5, -0.05), (4.6, 0.15)):
        at = (0.26 * wide * np.cos(turn), middle - 0.3 * half + up * height, 0.26 * wide * np.sin(turn))
        part = [(0.3 * wide * np.sin(a), 0.5 * half * (1 - np.cos(a))) for a in np.linspace(0.4, np.pi - 0.4, 5)]
        yield lathe("leaf", part, at, sides=8)


def fir(height: float, wide: float) -> Iterator[Solid]:
    """Generate a fir, of a height and a width [m], as cones of branches, one above the other."""
    yield cylinder("bark", 0.04 * wide, 0.25 * height, sides=6)
    for k in range(4):
        low, high = (0.12 + 0.2 * k) * height, min(0.12 + 0.2 * k + 0.36, 1.0) * height
        yield lathe("leaf", [((0.5 - 0.11 * k) * wide, low), (0.2 * (0.5 - 0.11 * k) * wide, high - 0.02)], sides=9)


def bush(height: float, wide: float) -> Iterator[Solid]:
    """Generate a bush, of a height and a width [m], with leaves from the ground up."""
    for x, z, size in ((0.0, 0.0, 1.0), (0.28, 0.1, 0.7), (-0.22, 0.2, 0.75), (0.02, -0.3, 0.65)):
        part = [(0.32 * size * wide * np.sin(a), 0.5 * size * height * (1 - np.cos(a))) for a in (0.6, 1.4, 2.1, 2.8)]
        yield lathe("leaf", part, (x * wide, 0.0, z * wide), sides=8)


def hedge(length: float, height: float) -> Iterator[Solid]:
    """Generate a hedge along x as one box 0.6 m thick, of a length and a height [m]."""
    yield box("leaf", (length, height, 0.6))


def _model(
    name: str, number: int, fine: str, solids: Iterable[Solid], slots: Sequence[str], smooth: bool
) -> FurnitureModel:
    pieces, key = list(solids), f"outside_{name}_{number}"
    materials = tuple(replace(SLOT_MATERIALS[slot], name=f"material_{i}") for i, slot in enumerate(slots))
    mesh = repeat_uv(to_mesh(Path("object") / key / f"{key}.obj", pieces, slots, materials), slots)
    if smooth:
        mesh = replace(mesh, normal=corner_normals(mesh.vertices, mesh.faces))
    parts = np.stack([piece.box for piece in pieces])
    return FurnitureModel(key, name, fine, {slot: slot for slot in slots}, parts, lambda: Meshes(mesh))


@cache
def outside_models() -> Mapping[str, tuple[FurnitureModel, ...]]:
    """Return the models by family; building them is cached.

    Example:
        >>> list(outside_models())
        ['roof', 'tree', 'bush', 'hedge']
    """
    leaves = ("leaf",)
    trees = (round_tree(5.0, 4.0), round_tree(7.5, 4.6), fir(8.0, 3.6), round_tree(3.4, 2.4), fir(5.0, 2.6))
    bushes, hedges = (bush(1.0, 1.4), bush(1.5, 1.6)), (hedge(4.0, 1.4), hedge(8.0, 1.5), hedge(12.0, 1.5))
    roofs = (_model("roof", i, "roof", [gable_roof(*size)], ROOF_SLOTS, False) for i, size in _numbered(ROOF_SIZES))
    return {
        "roof": tuple(roofs),
        "tree": tuple(_model("tree", i, "plant", solids, ("bark", "leaf"), True) for i, solids in _numbered(trees)),
        "bush": tuple(_model("bush", i, "plant", solids, leaves, True) for i, solids in _numbered(bushes)),
        "hedge": tuple(_model("hedge", i, "plant", solids, leaves, False) for i, solids in _numbered(hedges)),
    }


def _numbered(items: Iterable[T]) -> Iterator[tuple[int, T]]:
    return enumerate(items, 1)
