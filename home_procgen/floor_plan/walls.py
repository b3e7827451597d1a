"""Meshes of walls with holes, floors and ceilings, as SUNCG's exporter builds them.

Each wall of a room is two prisms: an inner one towards the room and an outer one behind it. Rooms that share a wall
each bring their own pair. Openings carve holes into every prism that they cross.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from home_mjx.geometry import wall_prisms as wall_prism
from home_mjx.geometry.wall_prisms import WALL_DEPTH, Hole, extrude_grid, wall_prisms
from home_mjx.schema.house import Material, Mesh
from home_procgen.floor_plan.placed import PlacedFurniture
from home_procgen.floor_plan.rooms import RoomPlan, Wall
from home_procgen.primitives.palette import CUT
from home_procgen.primitives.solids import Solid, to_mesh

# All in metres.
HALF = WALL_DEPTH / 2  # thickness of one prism
SHRINK = 0.02  # of a hole against the opening's bounding box
FLOOR_TOP = 0.05  # also the thickness of floors and ceilings
OUTSET = 0.02  # of floors and ceilings beyond the centre-lines
CEILING_LOW = 0.01  # of a ceiling's underside below the nominal height


@dataclass(frozen=True)
class Surfaces:
    """The materials of a room's floor, ceiling and walls, and of skirting boards if it has some."""

    floor: Material
    ceiling: Material
    inside: Material
    outside: Material
    skirting: Material | None = None


def room_meshes(
    folder: Path, node: int, room: RoomPlan, height: float, openings: Sequence[PlacedFurniture], surfaces: Surfaces
) -> tuple[Mesh, Mesh, Mesh]:
    """Floor, ceiling and walls of a room.

    Args:
        folder: Where the OBJs will be.
        node: Index of the room's node.
        room: The room.
        height: Nominal height of the walls [m].
        openings: All doors and windows of the house.
        surfaces: The materials. Walls have three each: inside, cut faces, outside.
    """
    stem, low = f"fr_0rm_{node}", height - CEILING_LOW
    floor = _slab(room, (0.0, FLOOR_TOP), f"Floor#0_{node}")
    ceiling = _slab(room, (low, low + FLOOR_TOP), f"Ceiling#0_{node}")
    prisms = [prism for k, wall in enumerate(room.walls) for prism in _prisms(wall, k, node, height, openings)]
    cladding = (surfaces.inside, CUT, surfaces.outside) * len(room.walls)
    return (
        to_mesh(folder / f"{stem}f.obj", [floor], (), _numbered([surfaces.floor])),
        to_mesh(folder / f"{stem}c.obj", [ceiling], (), _numbered([surfaces.ceiling])),
        to_mesh(folder / f"{stem}w.obj", prisms, (), _numbered(cladding)),
    )


def _prisms(wall: Wall, number: int, node: int, height: float, openings: Sequence[PlacedFurniture]) -> Iterator[Solid]:
    """The inner and the outer prism of one wall."""
    holes = tuple(hole for opening in openings if (hole := carve(wall, opening)) is not None)
    start, end = (np.array([x, 0.0, z]) for x, z in (wall.start, wall.end))
    both = wall_prisms(wall_prism.WallSegment(start, end, height, holes))
    for name, prism, slot in zip(("Inside", "Outside"), both, (3 * number, 3 * number + 2), strict=True):
        slots = tuple(np.where(prism.is_large_face, slot, 3 * number + 1).tolist())
        yield Solid(prism.vertices, prism.faces, prism.uv, slots, f"Wall{name}#0_{node}_{number}")


def carve(wall: Wall, opening: PlacedFurniture) -> Hole | None:
    """The hole that an opening makes in a wall, or None if it is not in this wall."""
    x, _, z = opening.position
    box = opening.box
    along = box[:, (0, 2)[wall.axis]]
    off = abs((x, z)[1 - wall.axis] - wall.line)
    if opening.quarter % 2 != wall.axis or off > HALF or along[1] < wall.span[0] or along[0] > wall.span[1]:
        return None
    start, end = np.sort((along - wall.start[wall.axis]) * wall.direction[wall.axis])
    return float(start + SHRINK), float(end - SHRINK), float(box[0, 1] + SHRINK), float(box[1, 1] - SHRINK)


def _slab(room: RoomPlan, depth: tuple[float, float], group: str) -> Solid:
    """The room's polygon, grown by `OUTSET`, extruded upwards; its grid has u along z and v along x."""
    grown = np.array(room.rects) + OUTSET * np.array([-1, -1, 1, 1])
    xs, zs = np.unique(grown[:, [0, 2]]), np.unique(grown[:, [1, 3]])
    z, x = np.meshgrid((zs[1:] + zs[:-1]) / 2, (xs[1:] + xs[:-1]) / 2, indexing="ij")
    keep = np.zeros(z.shape, bool)
    for x0, z0, x1, z1 in grown:
        keep |= (x0 < x) & (x < x1) & (z0 < z) & (z < z1)
    points, faces, _ = extrude_grid(zs, xs, keep, depth)
    vertices = points[:, [1, 2, 0]]
    uv = vertices[faces][..., [0, 2]] - room.polygon.min(0)
    return Solid(vertices, faces, uv, (0,) * len(faces), group)


def _numbered(materials: Sequence[Material]) -> tuple[Material, ...]:
    return tuple(replace(material, name=f"material_{i}") for i, material in enumerate(materials))
