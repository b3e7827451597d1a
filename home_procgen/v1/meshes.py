"""Meshes of walls with holes, floors and ceilings of a flat, as SUNCG's exporter builds them."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from home_mjx.geometry import wall_prisms as wall_prism
from home_mjx.geometry.wall_prisms import extrude_grid, wall_prisms
from home_mjx.schema.house import Material, Mesh
from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.floor_plan.rooms import PlanWall, RoomPlan
from home_procgen.floor_plan.walls import CEILING_DROP, FLOOR_TOP, SLAB_OVERHANG, RoomSurfaces, find_wall_hole
from home_procgen.primitives.palette import CUT_MATERIAL
from home_procgen.primitives.solids import Solid, to_mesh


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
