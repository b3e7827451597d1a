"""Small houses built by hand from boxes, so that rays, physics and sound can be tested without any dataset.

The floor's top is at z = 0, the ceiling's underside at the room's height; walls are slabs of 0.1 m around the rooms.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from home_mjx.geometry.boxes import BoxSet, concat_boxes, make_boxes
from home_mjx.geometry.diffraction_edges import exposed_edge_bits
from home_mjx.geometry.meshes import box_triangles, build_instance_tree, make_model
from home_mjx.geometry.polygons import find_smallest_room
from home_mjx.geometry.rotations import yaw_matrix, yaw_quat
from home_mjx.scene_compile.architecture.rooms import ground_floor_height
from home_mjx.scene_compile.collision.barriers import lot_bounds
from home_mjx.scene_compile.materials.surface import SurfaceMaterial, material_table
from home_mjx.scene_compile.navigation.build import build_navigation
from home_mjx.scene_compile.navigation.free_space import find_free_space
from home_mjx.scene_compile.pipeline.assemble import AGENT_SURFACES
from home_mjx.schema.compiled import Bodies, CompiledHouse, Instances, MaterialTable, Model, Planes, RoomTable
from home_mjx.schema.semantic import semantic_row

THICKNESS = 0.1  # [m], of walls, floors and ceilings
COLORS = ((0.8, 0.8, 0.75), (0.75, 0.8, 0.8), (0.8, 0.75, 0.8), (0.7, 0.8, 0.7), (0.6, 0.45, 0.3), (0.95, 0.95, 0.95))


@dataclass(frozen=True)
class Furniture:
    """A box that stands on the floor.

    Attributes:
        position: Middle of its footprint, x and y [m].
        size: Edge lengths [m].
        yaw: [rad].
        mass: [kg]; None: it cannot be moved.
        category: Coarse and fine category.
        color: sRGB, 0..1.
        friction: If it can be moved.
        restitution: If it can be moved.
    """

    position: tuple[float, float]
    size: tuple[float, float, float] = (0.5, 0.5, 0.5)
    yaw: float = 0.0
    mass: float | None = None
    category: str = "ottoman"
    color: tuple[float, float, float] = (0.7, 0.2, 0.2)
    friction: float = 0.4
    restitution: float = 0.0


@dataclass(frozen=True)
class Slab:
    """One box of the architecture."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]
    category: str  # wall, floor or ceiling
    partition: int
    room: int

    @property
    def center(self) -> np.ndarray:
        return (np.array(self.low) + self.high) / 2

    @property
    def half(self) -> np.ndarray:
        return (np.array(self.high) - self.low) / 2


def shoebox(
    size: tuple[float, float, float] = (6.0, 5.0, 3.0),
    absorption: float | np.ndarray = 0.2,
    scattering: float | np.ndarray = 0.3,
    furniture: Sequence[Furniture] = (),
) -> CompiledHouse:
    """One closed room, its middle at x = y = 0, its floor's top at z = 0.

    Args:
        size: Inner edge lengths [m].
        absorption: Energy fraction; broadcast to the six slabs (-x, +x, -y, +y, floor, ceiling) and seven octaves.
        scattering: The same.
        furniture: What stands in it.
    """
    x, y, z = size
    slabs = _shell((-x / 2, -y / 2), (x / 2, y / 2), z, room=0)
    rooms = _rooms([((-x / 2, -y / 2), (x / 2, y / 2))], z)
    planes = _room_planes((-x / 2, -y / 2), (x / 2, y / 2), z, first_row=0)
    table = _architecture_rows(slabs, absorption, scattering, 0.0)
    return build_house("shoebox", slabs, table, rooms, planes, furniture)


def two_rooms(
    size: tuple[float, float, float] = (4.0, 5.0, 3.0),
    absorption: float | np.ndarray = 0.2,
    scattering: float | np.ndarray = 0.3,
    transmission: float | np.ndarray = 0.01,
    furniture: Sequence[Furniture] = (),
    opening: float = 0.0,
) -> CompiledHouse:
    """Two rooms of one size with a wall between, |x| <= 0.05: room 0 at x < 0, room 1 at x > 0.

    Args:
        size: Inner edge lengths of each room [m].
        absorption: Energy fraction of every slab and octave; includes what is transmitted.
        scattering: Energy fraction.
        transmission: Energy fraction that the wall between lets through; its partition is 0.
        furniture: What stands in the rooms; the navigation grid covers one of them.
        opening: Width of a gap in the middle of the wall [m], from floor to ceiling.
    """
    x, y, z = size
    inner = THICKNESS / 2
    corners = [((-x - inner, -y / 2), (-inner, y / 2)), ((inner, -y / 2), (x + inner, y / 2))]
    end = y / 2 + THICKNESS, -opening / 2 if opening else y / 2 + THICKNESS
    between = Slab((-inner, -end[0], -THICKNESS), (inner, end[1], z + THICKNESS), "wall", 0, -1)
    beyond = replace(between, low=(-inner, opening / 2, -THICKNESS), high=(inner, end[0], z + THICKNESS))
    shells = [_shell(low, high, z, room=r) for r, (low, high) in enumerate(corners)]
    around = [s for shell, side in zip(shells, (1, 0), strict=True) for i, s in enumerate(shell) if i != side]
    slabs = [replace(s, partition=i) for i, s in enumerate([between, *around, *([beyond] if opening else [])])]
    rows = [[1, 0, 2, 3, 4, 5], [0, 6, 7, 8, 9, 10]]
    planes = [_room_planes(low, high, z, row) for (low, high), row in zip(corners, rows, strict=True)]
    table = _architecture_rows(slabs, absorption, scattering, transmission)
    return build_house("two_rooms", slabs, table, _rooms(corners, z), _join_planes(planes), furniture)


def build_house(
    name: str,
    slabs: Sequence[Slab],
    table: MaterialTable,
    rooms: RoomTable,
    planes: Planes,
    furniture: Sequence[Furniture] = (),
) -> CompiledHouse:
    """A house of slabs (one part and one material row each) and furniture."""
    shell = concat_boxes(make_boxes(s.center, s.half) for s in slabs)
    boxes = concat_boxes(make_boxes((*f.position, f.size[2] / 2), np.array(f.size) / 2, f.yaw) for f in furniture)
    fixed = np.array([f.mass is None for f in furniture], bool)
    models = [_architecture(slabs), *(_furniture_model(f) for f in furniture)]
    instances = _instances(models, boxes, fixed, len(slabs))
    semantics = [semantic_row(s.category, s.category, s.category, **_place(s)) for s in slabs]
    colliders = concat_boxes([shell, boxes[fixed]]).colliders(np.append(np.full(len(shell), -1), np.flatnonzero(fixed)))
    return CompiledHouse(
        id=name,
        offset=np.zeros(3),
        box=models[0].box,
        instances=instances,
        top_bvh=build_instance_tree(instances, {m.key: m for m in models}),
        materials=_join_tables(table, material_table([SurfaceMaterial(f.color, kind="wood") for f in furniture])),
        semantics=np.array([*semantics, *_furniture_rows(furniture, instances.body, rooms)]),
        colliders=colliders,
        exposed_edges=exposed_edge_bits(colliders, rooms),
        bodies=_bodies(furniture, boxes, instances.pose[1:]),
        planes=planes,
        rooms=rooms,
        navigation=build_navigation(
            name,
            rooms,
            [find_free_space(rooms, concat_boxes([shell, boxes]), fixed=concat_boxes([shell, boxes[fixed]]))],
        ),
        models={m.key: m for m in models},
        ground_floor=ground_floor_height(rooms),
        lot=lot_bounds(rooms),
        agent_materials=material_table(AGENT_SURFACES),
        report={"levels": 1, "rooms": len(rooms.type), "objects": len(furniture)},
    )


def _shell(low: tuple[float, float], high: tuple[float, float], z: float, room: int) -> list[Slab]:
    """The six slabs around a room: -x, +x, -y, +y, floor, ceiling."""
    (x0, y0), (x1, y1), t = low, high, THICKNESS
    spans = [
        ((x0 - t, y0 - t, -t), (x0, y1 + t, z + t), "wall"),
        ((x1, y0 - t, -t), (x1 + t, y1 + t, z + t), "wall"),
        ((x0 - t, y0 - t, -t), (x1 + t, y0, z + t), "wall"),
        ((x0 - t, y1, -t), (x1 + t, y1 + t, z + t), "wall"),
        ((x0 - t, y0 - t, -t), (x1 + t, y1 + t, 0), "floor"),
        ((x0 - t, y0 - t, z), (x1 + t, y1 + t, z + t), "ceiling"),
    ]
    return [Slab(a, b, category, 10 * room + i, room) for i, (a, b, category) in enumerate(spans)]


def _place(slab: Slab) -> dict[str, int]:
    return {"room": slab.room, "level": 0, "partition": slab.partition}


def _architecture(slabs: Sequence[Slab]) -> Model:
    triangles = np.concatenate([box_triangles(s.center, s.half) for s in slabs])
    part = np.repeat(np.arange(len(slabs)), 12)
    return make_model("architecture", triangles, slot=part, part=part)


def _furniture_model(item: Furniture) -> Model:
    half = np.array(item.size) / 2
    return make_model(f"box_{item.category}", box_triangles(np.array([0, 0, half[2]]), half))


def _instances(models: Sequence[Model], boxes: BoxSet, fixed: np.ndarray, num_slabs: int) -> Instances:
    count = len(fixed)
    pose = np.zeros((count + 1, 3, 4))
    pose[0, :, :3] = np.eye(3)
    for i in range(count):
        pose[i + 1, :, :3] = yaw_matrix(boxes.yaw[i])
        pose[i + 1, :2, 3] = boxes.center[i, :2]
    body = np.full(count + 1, -1)
    body[1:][~fixed] = np.arange((~fixed).sum())
    rows = np.array([0, *range(num_slabs, num_slabs + count)])
    return Instances(tuple(m.key for m in models), pose, np.arange(-1, count), rows, rows, body)


def _bodies(furniture: Sequence[Furniture], boxes: BoxSet, pose: np.ndarray) -> Bodies:
    moving = np.array([i for i, f in enumerate(furniture) if f.mass is not None], int)
    from_model = np.tile(np.eye(3, 4), (len(moving), 1, 1))
    from_model[:, 2, 3] = -boxes.half[moving, 2]
    return Bodies(
        instance=moving + 1,
        pos=boxes.center[moving],
        quat=yaw_quat(boxes.yaw[moving]),
        size=boxes.half[moving],
        mass=np.array([f.mass for f in furniture if f.mass is not None], float),
        friction=np.array([f.friction for f in furniture if f.mass is not None], float),
        restitution=np.array([f.restitution for f in furniture if f.mass is not None], float),
        from_model=from_model,
    )


def _furniture_rows(furniture: Sequence[Furniture], body: np.ndarray, rooms: RoomTable) -> list[np.ndarray]:
    rows = []
    for i, f in enumerate(furniture):
        room = int(find_smallest_room(rooms, np.arange(len(rooms.type)), np.array(f.position)))
        place = {"object_id": i, "room": room, "level": 0, "movable": int(body[i + 1])}
        rows.append(semantic_row(f.category, f.category, "otherfurniture", **place))
    return rows


def _architecture_rows(
    slabs: Sequence[Slab],
    absorption: float | np.ndarray,
    scattering: float | np.ndarray,
    transmission: float | np.ndarray,
) -> MaterialTable:
    shape = (len(slabs), 7)
    table = material_table([SurfaceMaterial(COLORS[i % len(COLORS)], category=s.category) for i, s in enumerate(slabs)])
    between = np.array([[s.room < 0] for s in slabs])
    return replace(
        table,
        absorption=np.broadcast_to(np.asarray(absorption, float), shape).copy(),
        scattering=np.broadcast_to(np.asarray(scattering, float), shape).copy(),
        transmission=np.where(between, np.broadcast_to(np.asarray(transmission, float), shape), 0.0),
    )


def _join_tables(a: MaterialTable, b: MaterialTable) -> MaterialTable:
    joined = {n: np.concatenate([getattr(a, n), getattr(b, n)]) for n in ("albedo", "mask")}
    sound = {n: np.concatenate([getattr(a, n), getattr(b, n)]) for n in ("absorption", "scattering", "transmission")}
    return MaterialTable(**joined, **sound, texture=a.texture + b.texture, kind=a.kind + b.kind)


def _rooms(corners: Sequence[tuple], height: float) -> RoomTable:
    outlines = [np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]) for (x0, y0), (x1, y1) in corners]
    count = len(outlines)
    return RoomTable(
        np.full(count, -1),
        np.zeros(count, int),
        tuple(outlines),
        np.zeros(count),
        np.full(count, height),
        np.zeros(count, int),
    )


def _room_planes(low: tuple, high: tuple, z: float, first_row: int | Sequence[int]) -> Planes:
    """The six inner surfaces of a room, in the order of `_shell`."""
    low3, high3 = np.array([*low, 0.0]), np.array([*high, z])
    center, half = (low3 + high3) / 2, (high3 - low3) / 2
    normal = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
    axis = np.repeat(np.arange(3), 2)
    u, v = np.eye(3)[(axis + 1) % 3] * half, np.eye(3)[(axis + 2) % 3] * half
    rows = np.arange(6) + first_row if isinstance(first_row, int) else np.array(first_row)
    return Planes(center - normal * half, normal, u, v, rows)


def _join_planes(planes: Sequence[Planes]) -> Planes:
    return Planes(*(np.concatenate([getattr(p, n) for p in planes]) for n in Planes.__dataclass_fields__))
