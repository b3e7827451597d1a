"""Room meshes: walls with holes, and floors and ceilings with openings for stairs."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from home_mjx.geometry.mesh_pieces import MeshPiece, join_pieces, wall_pieces
from home_mjx.geometry.slabs import slab
from home_mjx.geometry.wall_prisms import WALL_EXTRA_HEIGHT, Hole, WallSegment
from home_mjx.schema.house import Material, Mesh
from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.floor_plan.rooms import PlanWall as PlanWall
from home_procgen.floor_plan.rooms import RoomPlan
from home_procgen.floor_plan.walls import (
    CEILING_DROP,
    FLOOR_TOP,
    HOLE_INSET,
    PRISM_THICKNESS,
    RoomSurfaces,
    find_wall_hole,
)
from home_procgen.plan.openings.windows import SlantedWindow
from home_procgen.plan.shape.cut_rooms import Point, outline_sides
from home_procgen.plan.shape.program import OUTDOOR_TYPES
from home_procgen.textures.recipes import repeat_uv

SKIRTING_TOP = FLOOR_TOP + 0.09  # [m], height of the top of skirting boards
RoomMeshes = tuple[Mesh, Mesh | None, Mesh | None]  # floor, ceiling, walls


def build_room_meshes(
    stem: Path,
    room: RoomPlan,
    height: float,
    openings: Sequence[PlacedModel],
    surfaces: RoomSurfaces,
    has_floor_opening: bool = False,
    has_ceiling_opening: bool = False,
) -> RoomMeshes:
    """Return floor, ceiling and walls of a room on the lowest level; outdoor rooms have only a floor.

    Args:
        stem: Path of the OBJ files without the letter of the part.
        room: The room; if its floor or ceiling is open, its last rectangle is the stairwell.
        height: Nominal height of the walls [m].
        openings: Doors and windows of the storey.
        surfaces: The materials.
        has_floor_opening: Whether stairs come up here, so that the floor has an opening.
        has_ceiling_opening: Whether stairs go up from here, so that the ceiling has an opening.
    """
    low, number = height - CEILING_DROP, stem.name.rpartition("_")[2]
    less = RoomPlan(room.type, room.rects[:-1]) if has_floor_opening or has_ceiling_opening else room
    floor = _slab(stem, "Floor", less if has_floor_opening else room, (0.0, FLOOR_TOP), surfaces.floor)
    if room.type in OUTDOOR_TYPES:
        return floor, None, None
    ceiling = _slab(stem, "Ceiling", less if has_ceiling_opening else room, (low, low + FLOOR_TOP), surfaces.ceiling)
    boards = () if surfaces.skirting is None else (surfaces.skirting,)
    extra = 0.0 if has_ceiling_opening else WALL_EXTRA_HEIGHT  # walls that show above each other must not overlap
    pieces = list(_wall_pieces(room, number, (height, extra), openings, bool(boards)))
    cladding = (surfaces.inside, surfaces.inside, surfaces.outside, *boards) * len(room.polygon)
    return floor, ceiling, _round_coordinates(join_pieces(stem.with_name(f"{stem.name}w.obj"), pieces, cladding))


def _slab(stem: Path, kind: str, room: RoomPlan, span: tuple[float, float], material: Material) -> Mesh:
    vertices, faces, uv = slab([room.polygon], *span, 0.0)  # coplanar floors must not overlap
    piece = MeshPiece(f"{kind}#0_{stem.name.rpartition('_')[2]}", vertices, faces, uv, np.zeros(len(faces), int))
    return _round_coordinates(join_pieces(stem.with_name(f"{stem.name}{kind[0].lower()}.obj"), [piece], [material]))


def _wall_pieces(
    room: RoomPlan, number: str, heights: tuple[float, float], openings: Sequence[PlacedModel], boards: bool
) -> Iterator[MeshPiece]:
    """Generate the inner and outer prism of every wall; with `boards`, the foot of the inner one has a fourth slot.

    Args:
        room: The room.
        number: Number of the room, in the names of its walls.
        heights: Nominal height of the walls, and what they are higher [m].
        openings: Doors and windows of the storey.
        boards: Whether the room has skirting boards.
    """
    sides = outline_sides(room)
    height, extra = heights
    for k, side in enumerate(sides):
        holes = tuple(hole for opening in openings if (hole := _find_hole(side, opening)) is not None)
        start, end = (np.array([x, 0.0, z]) for x, z in side)
        wall = WallSegment(start, end, height, holes, extra_height=extra, split_heights=(SKIRTING_TOP,) * boards)
        turns = (_turn(sides[k - 1], side), _turn(side, sides[(k + 1) % len(sides)]))
        for piece in wall_pieces(wall, f"0_{number}_{k}"):
            foot = boards & (piece.slot == 0) & (piece.vertices[piece.faces][..., 1].max(axis=1) < SKIRTING_TOP + 1e-6)
            yield _mitre(replace(piece, slot=np.where(foot, 3, piece.slot) + (3 + boards) * k), wall, turns)


def _turn(side: tuple[Point, Point], after: tuple[Point, Point]) -> float:
    """Return the angle from one side of an outline to the next, positive towards the room [rad]."""
    (a, b), (c, d) = np.subtract(side[1], side[0]), np.subtract(after[1], after[0])
    return float(np.arctan2(a * d - b * c, a * c + b * d))


def _mitre(piece: MeshPiece, wall: WallSegment, turns: tuple[float, float]) -> MeshPiece:
    """Extend both ends of a prism to the mitre, where that is farther: else corners that jut out have a notch.

    Args:
        piece: Prism of the wall.
        wall: The wall.
        turns: Angles from the side before, and to the side after [rad], see `_turn`.
    """
    way = (wall.end - wall.start) / wall.length
    away = piece.vertices - wall.start
    along, depth = away @ way, away @ np.cross(way, (0.0, 1.0, 0.0))
    before, after = (-depth * np.tan(turn / 2) for turn in turns)
    shift = np.where(along > wall.length, np.maximum(wall.length + after - along, 0.0), 0.0)
    shift -= np.where(along < 0, np.maximum(along + before, 0.0), 0.0)
    uv = piece.uv.copy()
    uv[..., 0] += shift[piece.faces] * np.ptp(piece.uv[..., 0], axis=1, keepdims=True).astype(bool)
    return replace(piece, vertices=piece.vertices + shift[:, None] * way, uv=uv)


def _find_hole(side: tuple[Point, Point], opening: PlacedModel) -> Hole | None:
    """Return the hole of an opening in a straight or slanted wall, as `find_wall_hole`; None if it is elsewhere."""
    start, end = side
    if start[0] == end[0] or start[1] == end[1]:
        return None if isinstance(opening, SlantedWindow) else find_wall_hole(PlanWall(start, end), opening)
    length = float(np.hypot(end[0] - start[0], end[1] - start[1]))
    way = np.subtract(end, start) / length
    away = np.array(opening.position)[[0, 2]] - start
    along, off = float(away @ way), abs(float(away[0] * way[1] - away[1] * way[0]))
    if not isinstance(opening, SlantedWindow) or off > PRISM_THICKNESS or not 0 < along < length:
        return None
    half, (low, high) = float(opening.size[0]) / 2 - HOLE_INSET, opening.box[:, 1].tolist()
    return along - half, along + half, low + HOLE_INSET, high - HOLE_INSET


def _round_coordinates(mesh: Mesh) -> Mesh:
    """Return the mesh with UVs in repeats and rounded to a micrometre, for identical files on every machine."""
    return repeat_uv(replace(mesh, vertices=np.round(mesh.vertices, 6) + 0.0), [""] * len(mesh.materials))
