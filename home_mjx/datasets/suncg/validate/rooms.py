"""Rules on positions: overlapping rooms, objects outside of rooms, doors off walls."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from scipy import ndimage

from home_mjx.datasets.suncg.read.missing_parts import OPENING_CATEGORIES
from home_mjx.datasets.suncg.validate.context import ValidationContext
from home_mjx.datasets.suncg.validate.footprint import FootprintGrid, Triangles, upward_faces
from home_mjx.schema.house import GroundNode, Level, Mesh, ObjectNode, RoomNode

MAX_WALL_DISTANCE = 0.15  # [m], maximum distance: one and a half wall thicknesses
MAX_EDGES = 20_000  # maximum edges of a level's walls; real levels have a few hundred


def check_rooms(subject: ValidationContext) -> None:
    """Report overlapping rooms, objects outside of rooms, doors off walls and models without categories."""
    for level in subject.house.levels:
        rooms = [(room, area) for room in level.rooms if (area := footprint(room)) is not None]
        if rooms:
            areas = [area for _, area in rooms]
            areas += [area for ground in level.grounds if (area := footprint(ground)) is not None]
            raster = FootprintGrid.around(areas)
            _check_overlap(subject, rooms, raster)
            _check_outside(subject, level, areas, raster)
        edges = _wall_edges([room.walls for room in level.rooms if room.walls is not None])
        for item in level.objects:
            _check_category(subject, item, edges)


def footprint(node: RoomNode | GroundNode) -> Triangles | None:
    """Return upward faces of floor or ground, else ceiling, else the walls' box, in plan (x, z); None without."""
    slabs = (node.floor, node.ceiling) if isinstance(node, RoomNode) else (node.mesh,)
    for mesh in slabs:
        if mesh is not None and len(area := upward_faces(mesh)):
            return area
    if not isinstance(node, RoomNode) or node.walls is None:
        return None
    (x0, _, z0), (x1, _, z1) = node.walls.vertices.min(0), node.walls.vertices.max(0)
    return np.array([[[x0, z0], [x1, z0], [x1, z1]], [[x0, z0], [x1, z1], [x0, z1]]])


def _check_overlap(
    subject: ValidationContext, rooms: Sequence[tuple[RoomNode, Triangles]], raster: FootprintGrid
) -> None:
    """Report rooms that share an area wider than the overlap of two floors' outsets, with the first room that has it.

    Shared cells count if all four neighbours of one of them are shared with that room too.
    """
    owner = np.full(raster.shape, -1)
    for number, (room, area) in enumerate(rooms):
        mask = raster.mask(area)
        for other in np.unique(owner[mask & (owner >= 0)]):
            both = mask & (owner == other)
            if ndimage.binary_erosion(both).any():  # thin strips are the outsets of two floors
                message = f"{both.sum() * raster.step**2:.1f} m² are also in {rooms[other][0].path}"
                subject.report("room-overlap", room.path, message)
        owner[mask & (owner < 0)] = number


def _check_outside(subject: ValidationContext, level: Level, areas: Sequence[Triangles], raster: FootprintGrid) -> None:
    """Report objects and boxes whose origin is farther than about `MAX_WALL_DISTANCE` from all areas in plan.

    The distance is |x| + |z| in whole cells of the raster, rounded up.
    """
    covered = np.any([raster.mask(area) for area in areas], axis=0)
    cells = int(np.ceil(MAX_WALL_DISTANCE / raster.step))
    near = ndimage.binary_dilation(covered, iterations=cells)
    for node in (*level.objects, *level.boxes):
        if not raster.at(near, node.transform[[0, 2], 3]):
            subject.report("outside-rooms", node.path, "its origin is outside all rooms and grounds")


def _wall_edges(walls: Sequence[Mesh]) -> Float[np.ndarray, "e 2 2"]:
    """Return the first `MAX_EDGES` edges of the walls' upward faces in plan: edges, ends, (x, z) [m]."""
    tops = np.concatenate([np.zeros((0, 3, 2)), *(upward_faces(mesh) for mesh in walls)])
    return np.stack([tops, np.roll(tops, -1, axis=1)], axis=2).reshape(-1, 2, 2)[:MAX_EDGES]


def _check_category(subject: ValidationContext, item: ObjectNode, edges: Float[np.ndarray, "e 2 2"]) -> None:
    """Report an object without a category, and a door, window or arch whose origin is far from the walls.

    Far means more than `MAX_WALL_DISTANCE` in plan. Nothing is reported without metadata.
    """
    if subject.metadata is None:
        return
    info = subject.metadata.info(item.model_id)
    if info.coarse == "unknown":
        subject.report("unknown-model", f"{item.path}.modelId", f"model `{item.model_id}` has no category")
    if info.coarse in OPENING_CATEGORIES and len(edges):
        distance = _distance(edges, item.transform[[0, 2], 3])
        if distance > MAX_WALL_DISTANCE:
            subject.report("door-off-wall", item.path, f"{info.coarse} {distance:.2f} m away from the nearest wall")


def _distance(edges: Float[np.ndarray, "e 2 2"], point: Float[np.ndarray, "2"]) -> float:
    """Return the distance from a point (x, z) to the nearest of `edges`, which are not empty [m]."""
    start, way = edges[:, 0], edges[:, 1] - edges[:, 0]
    along = ((point - start) * way).sum(-1) / np.maximum((way**2).sum(-1), 1e-12)
    return float(np.linalg.norm(start + np.clip(along, 0, 1)[:, None] * way - point, axis=-1).min())
