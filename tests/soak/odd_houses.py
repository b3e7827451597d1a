"""Random odd houses, and what trimesh and C MuJoCo make of them.

Rooms are concave, rounded, thin, within each other or over one another; walls have slits; things are concave prisms,
plates with holes, sheets, lines and points, at any angle; stairs stand above one another. One seed makes one house.
"""

import io
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import trimesh
from storeys import Stairs, Storey, metadata_of, stacked

from home_mjx.datasets import RoomOutline, WallOpening
from home_mjx.datasets.suncg.formats.obj import read_obj
from home_mjx.datasets.suncg.formats.texture_paths import TextureLookup
from home_mjx.datasets.suncg.write.obj import obj_text
from home_mjx.geometry.meshes import surface_areas, transform
from home_mjx.geometry.polygons import polygon_area
from home_mjx.scene_compile import compile_house, to_mjcf
from home_mjx.schema.compiled import CompiledHouse
from home_mjx.schema.house import House, Mesh, Metadata, ModelInfo, ObjectNode

SHAPES = {  # of rooms and of caps, in the unit square
    "rectangle": [(0, 0), (1, 0), (1, 1), (0, 1)],
    "L": [(0, 0), (1, 0), (1, 0.5), (0.5, 0.5), (0.5, 1), (0, 1)],
    "U": [(0, 0), (1, 0), (1, 1), (0.7, 1), (0.7, 0.4), (0.3, 0.4), (0.3, 1), (0, 1)],
    "T": [(0.3, 0), (0.7, 0), (0.7, 0.6), (1, 0.6), (1, 1), (0, 1), (0, 0.6), (0.3, 0.6)],
    "Z": [(0, 0), (0.6, 0), (0.6, 0.6), (1, 0.6), (1, 1), (0.4, 1), (0.4, 0.4), (0, 0.4)],
    "arrow": [(0, 0), (1, 0.5), (0, 1), (0.4, 0.5)],
}
HOLE = [(0.25, 0.25), (0.25, 0.6), (0.7, 0.6), (0.7, 0.25)]  # clockwise
CATEGORIES = ("trash_can", "chair", "table", "toy", "picture_frame", "rug", "window", "door", "lamp", "vase")


def odd_house(seed: int, folder: Path) -> tuple[House, Metadata]:
    """A house of one to three storeys.

    Args:
        seed: Of everything.
        folder: For the files of its models, which are written and read.
    """
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 4))
    storeys = [_storey(rng) for _ in range(count)]
    stairs = [Stairs((1.0, 2.0), float(rng.choice([0, np.pi / 2])), level=i) for i in range(count - 1)]
    house = stacked(storeys, stairs if rng.random() < 0.7 else [], f"odd_{seed}")
    models = {f"thing_{i}": _thing(rng, folder / f"thing_{i}.obj") for i in range(rng.integers(1, 6))}
    rows = {
        key: ModelInfo(key, category, category, "x") for key in models for category in [str(rng.choice(CATEGORIES))]
    }
    levels = tuple(_with_things(rng, level, list(models)) for level in house.levels)
    metadata = Metadata({**metadata_of(house).models, **rows})
    return replace(house, levels=levels, models={**house.models, **models}), metadata


def _storey(rng: np.random.Generator) -> Storey:
    """Rooms in a row, in part over one another, one perhaps inside another, with slits and doors in the walls."""
    rooms, openings, at = [], [], 0.0
    for _ in range(rng.integers(1, 4)):
        width, depth = rng.uniform(2.5, 6), rng.uniform(2.5, 6)
        corners = _outline(rng) * (width, depth) + (at, 0)
        rooms.append(RoomOutline(str(rng.choice(["Living_Room", "Kitchen", "Bedroom"])), corners.tolist()))
        a, b = corners[0], corners[1]
        start, stop = sorted(rng.uniform(0.1, 0.9, 2))
        opening = tuple(map(tuple, (a + t * (b - a) for t in (start, max(stop, start + 0.02)))))
        openings.append(WallOpening(*opening, low=float(rng.choice([0, 0.9]))))
        at += width * rng.choice([1.0, 1.0, 0.8, 1.02])
    if rng.random() < 0.2:
        rooms.append(RoomOutline("Bathroom", (np.array(SHAPES["rectangle"]) * 0.8 + 0.6).tolist()))
    return Storey(rooms, openings)


def _outline(rng: np.random.Generator) -> np.ndarray:
    if rng.random() < 0.2:  # a corner in fine segments
        angle = np.linspace(0, np.pi / 2, int(rng.integers(2, 40)))
        return np.concatenate([[(0, 0), (1, 0)], 0.5 + 0.5 * np.stack([np.cos(angle), np.sin(angle)], 1), [(0, 1)]])
    shape = np.array(SHAPES[str(rng.choice(list(SHAPES)))], float)
    return np.roll(shape if rng.random() < 0.5 else shape[::-1], rng.integers(len(shape)), axis=0)


def _thing(rng: np.random.Generator, path: Path) -> Mesh:
    """A prism over an outline, perhaps with a hole, written as an OBJ whose caps are one polygon each, and read.

    Its area, volume and bounds are those of the closed form, by trimesh.
    """
    plan, hole = np.array(SHAPES[str(rng.choice(list(SHAPES)))], float), None
    if rng.random() < 0.3:
        plan, hole = np.array(SHAPES["rectangle"], float), np.array(HOLE)
    size = rng.uniform(0.1, 1.2, 3) * (1, 1, rng.choice([1, 1, 1, 0.004, 0]))
    plan *= size[:2]
    rings = [plan] if hole is None else [plan, hole * size[:2]]
    turn = int(rng.integers(len(plan)))  # the bridge joins corners that see each other
    rings = [np.roll(ring, -turn * side, axis=0) for ring, side in zip(rings, (1, -1), strict=False)]
    lines, faces = _prism(rings, float(size[2]))
    turn = (
        np.linalg.qr(rng.normal(size=(3, 3)))[0] if rng.random() < 0.3 else np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]])
    )
    turn = turn * np.sign(np.linalg.det(turn))
    points = np.array(lines) @ turn
    path.write_text("".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist()) + "".join(faces))
    mesh = read_obj(path, TextureLookup(path.parent))
    area = polygon_area(rings[0]) - sum(polygon_area(ring) for ring in rings[1:])
    around = sum(np.linalg.norm(ring - np.roll(ring, 1, axis=0), axis=1).sum() for ring in rings)
    _compare(mesh, 2 * area + size[2] * around, area * size[2], points)
    return mesh


def _prism(rings: list[np.ndarray], height: float) -> tuple[list, list[str]]:
    """Corners, and lines of faces: both caps as one polygon each, with a bridge to the hole, and the sides."""
    points = [(x, y, z) for z in (0.0, height) for ring in rings for x, y in ring]
    half, first = len(points) // 2, 0
    cap, faces = [], []
    for ring in rings:
        own = list(range(first, first + len(ring)))
        cap += own if not cap else [cap[0], *own, own[0]]
        faces += [[i, k, k + half, i + half] for i, k in zip(own, own[1:] + own[:1], strict=True)]
        first += len(ring)
    faces += [[i + half for i in cap], cap[::-1]]
    return points, ["f " + " ".join(str(i + 1) for i in face) + "\n" for face in faces]


def _compare(mesh: Mesh, area: float, volume: float, points: np.ndarray) -> None:
    solid = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    written = trimesh.load(io.BytesIO(obj_text(mesh, "x.mtl").encode()), "obj", process=False)
    for other in (solid, written):
        assert abs(other.area - area) < 1e-4 * max(area, 0.1), f"area {other.area} of {area}"
        with np.errstate(all="ignore"):  # trimesh divides by the volume of flat things
            found = other.volume
        assert abs(found - volume) < 1e-4 * max(volume, 0.1), f"volume {found} of {volume}"
        np.testing.assert_allclose(other.bounds, [points.min(axis=0), points.max(axis=0)], atol=2e-6)


def _with_things(rng: np.random.Generator, level, keys: list[str]):
    """The level with things on its floor, in it, above it and anywhere."""
    things, first = [], len(level.rooms) + len(level.objects) + len(level.boxes)
    floor = min(room.floor.vertices[:, 1].max() for room in level.rooms)
    for number in range(rng.integers(0, 7)):
        place, yaw = np.eye(4), rng.choice([0.0, np.pi / 2, rng.uniform(-3, 3)])
        place[:3, 3] = rng.uniform(0.3, 5), floor + rng.choice([0, 0, -0.03, 0.02, 0.5]), rng.uniform(0.3, 5)
        place[0, 0] = place[2, 2] = np.cos(yaw)
        place[0, 2], place[2, 0] = np.sin(yaw), -np.sin(yaw)
        place[:3, :3] *= rng.choice([1.0, 1.0, 0.5, -1.0], 3)
        index, key = first + number, str(rng.choice(keys))
        path = f"levels[{level.index}].nodes[{index}]"
        things.append(ObjectNode(f"{level.index}_{index}", index, path, None, key, key, place))
    return replace(level, objects=(*level.objects, *things))


def check_odd_house(seed: int, folder: Path) -> None:
    """Compile a house and compare it with trimesh and C MuJoCo.

    Raises:
        HomeMjxError: It is refused.
        AssertionError: They differ.
    """
    check_exported(compile_house(*odd_house(seed, folder)))


def check_exported(compiled: CompiledHouse) -> None:
    """Its export loads in C MuJoCo, with its bodies and surfaces, and can be stepped."""
    xml, files = to_mjcf(compiled)
    model = mujoco.MjModel.from_xml_string(xml, files)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    free = model.jnt_type == mujoco.mjtJoint.mjJNT_FREE
    np.testing.assert_allclose(model.body_mass[model.jnt_bodyid[free]].sum(), compiled.bodies.mass.sum(), rtol=1e-6)
    boxes = model.geom_size[model.geom_type == mujoco.mjtGeom.mjGEOM_BOX]
    assert boxes.min(initial=1) > 0
    assert len(boxes) == len(compiled.colliders.pos) + len(compiled.bodies.mass) + len(compiled.doors.mass)
    _compare_surfaces(compiled, model, data)
    for _ in range(20):
        mujoco.mj_step(model, data)
    assert np.isfinite(data.qpos).all()
    assert data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number == 0


def _compare_surfaces(compiled: CompiledHouse, model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """The meshes of C MuJoCo have the areas and bounds of the house, as trimesh measures them."""
    found = []
    for geom in np.flatnonzero(model.geom_type == mujoco.mjtGeom.mjGEOM_MESH).tolist():
        mesh = int(model.geom_dataid[geom])
        vertices = model.mesh_vert[model.mesh_vertadr[mesh] :][: model.mesh_vertnum[mesh]]
        faces = model.mesh_face[model.mesh_faceadr[mesh] :][: model.mesh_facenum[mesh]]
        found.append((vertices @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom])[faces])
    parts = zip(compiled.instances.model, compiled.instances.pose, strict=True)
    truth = [transform(pose, compiled.models[key].triangle.astype(float)) for key, pose in parts]
    areas, corners = [], []
    for triangles in (np.concatenate(found), np.concatenate(truth)):
        own = triangles[surface_areas(triangles) > 1e-10]
        solid = trimesh.Trimesh(own.reshape(-1, 3), np.arange(3 * len(own)).reshape(-1, 3), process=False)
        areas.append(solid.area)
        corners.append(solid.bounds)
    np.testing.assert_allclose(areas[0], areas[1], rtol=1e-3)
    np.testing.assert_allclose(corners[0], corners[1], atol=0.06)  # bodies are put onto their support
