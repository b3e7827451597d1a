"""Walls, floors, ceilings and grounds of a house as one model with one semantic part per surface."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.geometry.meshes import bounds, make_model
from home_mjx.geometry.polygons import are_inside_polygons
from home_mjx.scene_compile.architecture.floor_assignment import ClippedSurface, clip_surface, find_owner_outlines
from home_mjx.scene_compile.architecture.rooms import HouseFrame, house_rooms, world_triangles
from home_mjx.scene_compile.architecture.slabs import Slab, fit_slab, is_same_wall
from home_mjx.scene_compile.materials.surface import SurfaceMaterial, surface_material
from home_mjx.schema.compiled import Model, RoomTable
from home_mjx.schema.house import House, Mesh
from home_mjx.schema.semantic import semantic_row

ROOM_PROBE_DISTANCE = 0.15  # [m], distance beyond a wall of the points that are tested against room outlines
VISIBLE_DEPTH = 0.01  # [m], surfaces deeper than this inside a wall count as hidden
MAX_LAYER_GAP = 0.12  # [m], slabs with a smaller vertical gap are one partition, such as a ceiling and the floor above


@dataclass(frozen=True)
class ShellPart:
    """One architectural surface in the world frame: a floor, a ceiling, a ground, or a wall of one room."""

    kind: str  # floor, ceiling, wall or ground
    room: int  # room index; -1 for grounds
    level: int
    mesh: Mesh
    faces: Int[np.ndarray, " f"]  # face indices of the mesh
    triangles: Float[np.ndarray, "f 3 3"]  # [m]


@dataclass(frozen=True)
class WallPart(ShellPart):
    """A wall of one room, with its inner and outer layers."""

    slab: Slab


@dataclass(frozen=True)
class BuildingShell:
    """Architecture of a house; its instance 0."""

    parts: tuple[ShellPart, ...]
    partition: Int[np.ndarray, " q"]  # physical wall or slab of each part
    model: Model
    surfaces: tuple[SurfaceMaterial, ...]  # indexed by slot of the model
    inner_slot: Int[np.ndarray, " q"]  # slot with the largest area on each part's inner side
    outer_slot: Int[np.ndarray, " q"]  # slot with the largest area on the outer side
    semantics: Int[np.ndarray, "q columns"]
    num_meshes: int


def build_shell(frame: HouseFrame) -> BuildingShell:
    """Build walls, floors, ceilings and grounds of a house in the world frame, as a model with a part each.

    Parts are in the order of `_parts`. The model's floors and ceilings lack the areas that smaller rooms own; those of
    `parts` are complete.
    """
    house, rooms = frame.house, frame.rooms
    parts = tuple(_parts(house, frame.offset))
    partition = find_partitions(parts)
    surfaces, slots = _slots(parts, _categories(parts, partition, rooms))
    pieces = [_owned(p, parts, rooms) for p in parts]
    normals = [inner_normal(p, rooms) for p in parts]
    model = make_model(
        f"architecture_{house.id}",
        np.concatenate([p.triangles for p in pieces]),
        np.concatenate([p.uv for p in pieces]),
        np.concatenate([slot[p.triangle_index] for slot, p in zip(slots, pieces, strict=True)]),
        np.repeat(np.arange(len(parts)), [len(p.triangle_index) for p in pieces]),
    )
    return BuildingShell(
        parts=parts,
        partition=partition,
        model=model,
        surfaces=tuple(surfaces),
        inner_slot=np.array([_slot_on_side(p, s, n) for p, s, n in zip(parts, slots, normals, strict=True)]),
        outer_slot=np.array([_slot_on_side(p, s, -n) for p, s, n in zip(parts, slots, normals, strict=True)]),
        semantics=np.array([_row(p, int(i)) for p, i in zip(parts, partition, strict=True)]),
        num_meshes=len({id(p.mesh) for p in parts}),
    )


def _parts(house: House, offset: Float[np.ndarray, "3"]) -> Iterator[ShellPart]:
    """Yield the floor, ceiling and walls of each room in file order, then the grounds of all levels.

    Each wall of a room is a part of its own. Missing meshes have no part.
    """
    for index, (level, room) in enumerate(house_rooms(house)):
        for kind, mesh in (("floor", room.floor), ("ceiling", room.ceiling)):
            if mesh is not None:
                yield _part(kind, index, level, mesh, np.arange(len(mesh.faces)), offset)
        if room.walls is not None:
            for faces in room.walls.faces_by_part():
                yield _part("wall", index, level, room.walls, faces, offset)
    for level in house.levels:
        for ground in level.grounds:
            if ground.mesh is not None:
                yield _part("ground", -1, level.index, ground.mesh, np.arange(len(ground.mesh.faces)), offset)


def _part(kind: str, room: int, level: int, mesh: Mesh, faces: np.ndarray, offset: np.ndarray) -> ShellPart:
    """Return the surface of some faces of a mesh in the world frame; with its `slab` if `kind` is `wall`."""
    triangles = world_triangles(mesh, offset)[faces]
    if kind == "wall":
        return WallPart(kind, room, level, mesh, faces, triangles, fit_slab(triangles))
    return ShellPart(kind, room, level, mesh, faces, triangles)


def _owned(part: ShellPart, parts: Sequence[ShellPart], rooms: RoomTable) -> ClippedSurface:
    """Return the triangles of a part; floors and ceilings without the areas owned by smaller rooms."""
    uv = part.mesh.uv[part.faces]
    owners = []
    if part.kind in ("floor", "ceiling"):
        others = [other.room for other in parts if other.kind == part.kind and other is not part]
        owners = find_owner_outlines(part.room, others, rooms)
    if not owners:
        return ClippedSurface(part.triangles, uv, np.arange(len(part.faces)))
    return clip_surface(part.triangles, uv, 1.0 if part.kind == "floor" else -1.0, owners)


def find_partitions(parts: Sequence[ShellPart]) -> Int[np.ndarray, " q"]:
    """Return each part's partition; copies of a wall, or a ceiling and the floor above it, share one.

    Partitions count from 0 in the order of their first parts. Sharing is transitive, see `_same_partition`.
    """
    leader = list(range(len(parts)))
    for i, a in enumerate(parts):
        for j in range(i):
            if _same_partition(a, parts[j]):
                _unite(leader, i, j)
    roots = [_root(leader, i) for i in range(len(parts))]
    return np.unique(roots, return_inverse=True)[1].astype(np.int32)


def _same_partition(a: ShellPart, b: ShellPart) -> bool:
    """Return whether two parts are copies of one wall, or floors and ceilings whose bounding boxes nearly meet.

    They do if they overlap in x and y by more than `MAX_LAYER_GAP` and are less than that apart in height.
    """
    if isinstance(a, WallPart) and isinstance(b, WallPart):
        return is_same_wall(a.slab, b.slab)
    if {a.kind, b.kind} & {"wall", "ground"}:
        return False
    (low_a, high_a), (low_b, high_b) = bounds(a.triangles), bounds(b.triangles)
    common = np.minimum(high_a, high_b) - np.maximum(low_a, low_b)
    return bool((common[:2] > MAX_LAYER_GAP).all() and common[2] > -MAX_LAYER_GAP)


def _root(leader: list[int], i: int) -> int:
    """Return the representative of element `i` in a union-find forest."""
    while leader[i] != i:
        i = leader[i]
    return i


def _unite(leader: list[int], i: int, j: int) -> None:
    """Merge the sets of two elements of a union-find forest, in place; the lower representative stays."""
    a, b = _root(leader, i), _root(leader, j)
    leader[max(a, b)] = min(a, b)


def _categories(parts: Sequence[ShellPart], partition: Int[np.ndarray, " q"], rooms: RoomTable) -> list[str]:
    """Return the acoustic category of each part: its kind, or `outer_wall` for walls without rooms on both sides.

    Copies of one wall share it, so transmission is symmetric.
    """
    numbered = zip(parts, partition, strict=True)
    inner = {int(p) for part, p in numbered if isinstance(part, WallPart) and _is_inner(part, rooms)}
    walls = ["wall" if p in inner else "outer_wall" for p in partition]
    return [wall if isinstance(part, WallPart) else part.kind for part, wall in zip(parts, walls, strict=True)]


def _is_inner(part: WallPart, rooms: RoomTable) -> bool:
    """Return whether rooms are on both sides of at least half of a wall."""
    polygons = [rooms.polygon[r] for r in np.flatnonzero(rooms.level == part.level)]
    between = _indoors(part.slab, -1, polygons) & _indoors(part.slab, 1, polygons)
    return bool(between.mean() >= 0.5)


def _indoors(slab: Slab, side: int, polygons: Sequence[Float[np.ndarray, "_ 2"]]) -> Bool[np.ndarray, " p"]:
    """Return a mask of 11 points along a wall, beyond its maximum (`side` 1) or minimum (-1) across, in any polygon."""
    edge = slab.high[1] + ROOM_PROBE_DISTANCE if side > 0 else slab.low[1] - ROOM_PROBE_DISTANCE
    along = np.linspace(slab.low[0], slab.high[0], 13)[1:-1]
    points = slab.to_world(np.stack([along, np.full_like(along, edge), np.zeros_like(along)], axis=-1))[:, :2]
    return np.asarray(are_inside_polygons(polygons, points).any(axis=0))


def _slots(parts: Sequence[ShellPart], categories: Sequence[str]) -> tuple[list[SurfaceMaterial], list[np.ndarray]]:
    """Return the surfaces by slot of the joint model, and the slots of each part's faces.

    A slot is one material of one mesh in one acoustic category.
    """
    first: dict[tuple[int, int, str], int] = {}
    surfaces, slots = [], []
    for part, category in zip(parts, categories, strict=True):
        own = part.mesh.slot[part.faces]
        for slot in np.unique(own):
            key = (id(part.mesh), int(slot), category)
            if key not in first:
                first[key] = len(surfaces)
                surfaces.append(surface_material(part.mesh.materials[slot], category, _coarse(part.kind)))
        slots.append(np.array([first[id(part.mesh), int(slot), category] for slot in own]))
    return surfaces, slots


def _coarse(kind: str) -> str:
    """Return the semantic category of a kind of part; grounds are floors."""
    return "floor" if kind == "ground" else kind


def _row(part: ShellPart, partition: int) -> Int[np.ndarray, " columns"]:
    """Return the semantic row of a part."""
    name = _coarse(part.kind)
    return semantic_row(name, name, name, room=part.room, level=part.level, partition=partition)


def inner_normal(part: ShellPart, rooms: RoomTable) -> Float[np.ndarray, "3"]:
    """Return the unit world direction from a part into its room; up for floors and grounds, down for ceilings.

    A wall faces the side where more of the points of `_indoors` are in its room; if equal, its minimum side across.
    """
    if not isinstance(part, WallPart):
        return np.array([0.0, 0.0, -1.0 if part.kind == "ceiling" else 1.0])
    polygon = [rooms.polygon[part.room]]
    left, right = (_indoors(part.slab, side, polygon).mean() for side in (1, -1))
    return part.slab.to_world(np.array([0.0, 1.0 if left > right else -1.0, 0.0]))


def _slot_on_side(part: ShellPart, slots: Int[np.ndarray, " f"], toward: Float[np.ndarray, "3"]) -> int:
    """Return the slot, of `slots` per face, with the largest projected area towards unit `toward`; 0 if there is none.

    Faces behind the outermost one by `VISIBLE_DEPTH` or more are ignored; a face is as far out as its innermost corner.
    """
    normal = np.cross(part.triangles[:, 1] - part.triangles[:, 0], part.triangles[:, 2] - part.triangles[:, 0])
    height = (part.triangles @ toward).min(axis=1)
    surface = height > height.max() - VISIBLE_DEPTH
    return int(np.bincount(slots, np.maximum(normal @ toward, 0) * surface).argmax())


def has_room_behind(part: WallPart, inward: Float[np.ndarray, "3"], rooms: RoomTable) -> bool:
    """Return whether rooms of its level are beyond at least half of a wall's outer side, opposite to unit `inward`."""
    polygons = [rooms.polygon[r] for r in np.flatnonzero(rooms.level == part.level)]
    away = part.slab.to_world(np.array([0.0, 1.0, 0.0])) @ inward < 0
    return bool(_indoors(part.slab, 1 if away else -1, polygons).mean() >= 0.5)
