"""Room meshes: walls with holes, and floors and ceilings with openings for stairs."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from home_mjx.geometry.mesh_pieces import CUT_MATERIAL, MeshPiece, join_pieces, wall_pieces
from home_mjx.geometry.slabs import slab
from home_mjx.geometry.wall_prisms import Hole, WallSegment
from home_mjx.schema.house import Material, Mesh
from home_procgen.floor_plan.placed import PlacedFurniture
from home_procgen.floor_plan.rooms import RoomPlan
from home_procgen.floor_plan.rooms import Wall as PlanWall
from home_procgen.floor_plan.walls import CEILING_LOW, FLOOR_TOP, HALF, OUTSET, SHRINK, Surfaces, carve
from home_procgen.plan.needs.room_program import OUTDOORS
from home_procgen.plan.openings.turned import TurnedWindow
from home_procgen.plan.shape.cut_rooms import Point, sides

SKIRTING = FLOOR_TOP + 0.09  # [m], height of the top of skirting boards
Parts = tuple[Mesh, Mesh | None, Mesh | None]  # floor, ceiling, walls


def room_parts(
    stem: Path,
    room: RoomPlan,
    height: float,
    openings: Sequence[PlacedFurniture],
    surfaces: Surfaces,
    open_floor: bool = False,
    open_ceiling: bool = False,
) -> Parts:
    """Return floor, ceiling and walls of a room on the lowest level; outdoor rooms have only a floor.

    Args:
        stem: Path of the OBJ files without the letter of the part.
        room: The room; if its floor or ceiling is open, its last rectangle is the stairwell.
        height: Nominal height of the walls [m].
        openings: Doors and windows of the storey.
        surfaces: The materials.
        open_floor: Whether stairs come up here, so that the floor has an opening.
        open_ceiling: Whether stairs go up from here, so that the ceiling has an opening.
    """
    low, number = height - CEILING_LOW, stem.name.rpartition("_")[2]
    less = RoomPlan(room.type, room.rects[:-1]) if open_floor or open_ceiling else room
    floor = _slab(stem, "Floor", less if open_floor else room, (0.0, FLOOR_TOP), surfaces.floor)
    if room.type in OUTDOORS:
        return floor, None, None
    ceiling = _slab(stem, "Ceiling", less if open_ceiling else room, (low, low + FLOOR_TOP), surfaces.ceiling)
    boards = () if surfaces.skirting is None else (surfaces.skirting,)
    pieces = list(_wall_pieces(room, number, height, openings, bool(boards)))
    cladding = (surfaces.inside, CUT_MATERIAL, surfaces.outside, *boards) * len(room.polygon)
    return floor, ceiling, _rounded(join_pieces(stem.with_name(f"{stem.name}w.obj"), pieces, cladding))


def _slab(stem: Path, kind: str, room: RoomPlan, span: tuple[float, float], material: Material) -> Mesh:
    vertices, faces, uv = slab([room.polygon], *span, OUTSET)
    piece = MeshPiece(f"{kind}#0_{stem.name.rpartition('_')[2]}", vertices, faces, uv, np.zeros(len(faces), int))
    return _rounded(join_pieces(stem.with_name(f"{stem.name}{kind[0].lower()}.obj"), [piece], [material]))


def _wall_pieces(
    room: RoomPlan, number: str, height: float, openings: Sequence[PlacedFurniture], boards: bool
) -> Iterator[MeshPiece]:
    """Generate the inner and outer prism of every wall; with `boards`, the foot of the inner one has a fourth slot."""
    for k, side in enumerate(sides(room)):
        holes = tuple(hole for opening in openings if (hole := _hole(side, opening)) is not None)
        start, end = (np.array([x, 0.0, z]) for x, z in side)
        lines = (SKIRTING,) if boards else ()
        for piece in wall_pieces(WallSegment(start, end, height, holes, split_heights=lines), f"0_{number}_{k}"):
            foot = boards & (piece.slot == 0) & (piece.vertices[piece.faces][..., 1].max(axis=1) < SKIRTING + 1e-6)
            yield replace(piece, slot=np.where(foot, 3, piece.slot) + (3 + boards) * k)


def _hole(side: tuple[Point, Point], opening: PlacedFurniture) -> Hole | None:
    """Return the hole of an opening in a wall; None if the opening is not in this wall."""
    start, end = side
    if start[0] == end[0] or start[1] == end[1]:
        return None if isinstance(opening, TurnedWindow) else carve(PlanWall(start, end), opening)
    length = float(np.hypot(end[0] - start[0], end[1] - start[1]))
    way = np.subtract(end, start) / length
    away = np.array(opening.position)[[0, 2]] - start
    along, off = float(away @ way), abs(float(away[0] * way[1] - away[1] * way[0]))
    if not isinstance(opening, TurnedWindow) or off > HALF or not 0 < along < length:
        return None
    half, (low, high) = float(opening.size[0]) / 2 - SHRINK, opening.box[:, 1].tolist()
    return along - half, along + half, low + SHRINK, high - SHRINK


def _rounded(mesh: Mesh) -> Mesh:
    """Round to a micrometre, so that files are identical on every machine."""
    return replace(mesh, vertices=np.round(mesh.vertices, 6) + 0.0, uv=np.round(mesh.uv, 6) + 0.0)
