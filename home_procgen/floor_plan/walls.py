"""Meshes of walls with holes, floors and ceilings, as SUNCG's exporter builds them.

Each wall of a room consists of two prisms: an inner one towards the room and an outer one behind it. Each room that
shares a wall adds its own pair. Openings cut holes into every prism that they cross.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from home_mjx.geometry import wall_prisms as wall_prism
from home_mjx.geometry.wall_prisms import WALL_DEPTH, Hole, extrude_grid, wall_prisms
from home_mjx.schema.house import Material, Mesh
from home_procgen.floor_plan.placed import PlacedModel
from home_procgen.floor_plan.rooms import PlanWall, RoomPlan
from home_procgen.primitives.palette import CUT_MATERIAL
from home_procgen.primitives.solids import Solid, to_mesh

# All lengths are in metres.
PRISM_THICKNESS = WALL_DEPTH / 2  # thickness of one prism
HOLE_INSET = 0.02  # inset of a hole from the opening's bounding box
FLOOR_TOP = 0.05  # height of the floor's top; also the thickness of floors and ceilings
SLAB_OVERHANG = 0.02  # overhang of floors and ceilings beyond the wall centre-lines
CEILING_DROP = 0.01  # distance of a ceiling's underside below the nominal height


@dataclass(frozen=True)
class RoomSurfaces:
    """Materials of a room's floor, ceiling and walls, and of its skirting boards; None without skirting boards."""

    floor: Material
    ceiling: Material
    inside: Material
    outside: Material
    skirting: Material | None = None


def room_meshes(
    folder: Path, node: int, room: RoomPlan, height: float, openings: Sequence[PlacedModel], surfaces: RoomSurfaces
) -> tuple[Mesh, Mesh, Mesh]:
    """Return the floor, ceiling and wall meshes of a room.

    Args:
        folder: Folder of the OBJ files.
        node: Index of the room's node.
        room: The room.
        height: Nominal height of the walls [m].
        openings: All doors and windows of the house.
        surfaces: The materials. Walls have three each: inside, cut faces, outside.
    """
    stem, low = f"fr_0rm_{node}", height - CEILING_DROP
    floor = _slab(room, (0.0, FLOOR_TOP), f"Floor#0_{node}")
    ceiling = _slab(room, (low, low + FLOOR_TOP), f"Ceiling#0_{node}")
    prisms = [prism for k, wall in enumerate(room.walls) for prism in _prisms(wall, k, node, height, openings)]
    cladding = (surfaces.inside, CUT_MATERIAL, surfaces.outside) * len(room.walls)
    return (
        to_mesh(folder / f"{stem}f.obj", [floor], (), _numbered([surfaces.floor])),
        to_mesh(folder / f"{stem}c.obj", [ceiling], (), _numbered([surfaces.ceiling])),
        to_mesh(folder / f"{stem}w.obj", prisms, (), _numbered(cladding)),
    )


def _prisms(wall: PlanWall, number: int, node: int, height: float, openings: Sequence[PlacedModel]) -> Iterator[Solid]:
    """Generate the inner and the outer prism of one wall."""
    holes = tuple(hole for opening in openings if (hole := find_wall_hole(wall, opening)) is not None)
    start, end = (np.array([x, 0.0, z]) for x, z in (wall.start, wall.end))
    both = wall_prisms(wall_prism.WallSegment(start, end, height, holes))
    for name, prism, slot in zip(("Inside", "Outside"), both, (3 * number, 3 * number + 2), strict=True):
        slots = tuple(np.where(prism.is_large_face, slot, 3 * number + 1).tolist())
        yield Solid(prism.vertices, prism.faces, prism.uv, slots, f"Wall{name}#0_{node}_{number}")


def find_wall_hole(wall: PlanWall, opening: PlacedModel) -> Hole | None:
    """Return the hole that an opening cuts into a wall; None if the opening is not in this wall."""
    x, _, z = opening.position
    box = opening.box
    along = box[:, (0, 2)[wall.axis]]
    off = abs((x, z)[1 - wall.axis] - wall.line)
    if opening.quarter % 2 != wall.axis or off > PRISM_THICKNESS or along[1] < wall.span[0] or along[0] > wall.span[1]:
        return None
    start, end = np.sort((along - wall.start[wall.axis]) * wall.direction[wall.axis])
    return (
        float(start + HOLE_INSET),
        float(end - HOLE_INSET),
        float(box[0, 1] + HOLE_INSET),
        float(box[1, 1] - HOLE_INSET),
    )


def _slab(room: RoomPlan, depth: tuple[float, float], group: str) -> Solid:
    """Extrude the room's polygon, grown by `SLAB_OVERHANG`, upwards; its grid has u along z and v along x."""
    grown = np.array(room.rects) + SLAB_OVERHANG * np.array([-1, -1, 1, 1])
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
