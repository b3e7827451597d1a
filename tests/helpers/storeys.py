"""Houses of several levels: rooms from outlines, one storey above the other, and stairs between them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from cuboids import cuboid

from home_mjx.datasets.outlines import RoomOutline, WallOpening, outline_house
from home_mjx.datasets.storeys import stack_levels
from home_mjx.schema.house import BoxNode, House, Level, Mesh, Metadata, ModelInfo, ObjectNode

UP = 2.8  # [m], from floor to floor
FLOOR = 0.05  # [m], height of the ground floor
METADATA = Metadata({"stairs": ModelInfo("stairs", "stairs", "stairs", "floor")})


@dataclass(frozen=True)
class Storey:
    """One level, in the plan (x, z) of the file."""

    rooms: Sequence[RoomOutline]
    openings: Sequence[WallOpening] = ()
    boxes: Sequence[BoxNode] = ()


@dataclass(frozen=True)
class Stairs:
    """Stairs from the level with the given index.

    Attributes:
        foot: (x, z) of the middle of its first edge [m].
        heading: Direction of the way up, from +x towards -z [rad].
        steps: Number of treads; the last is as high as the upper floor.
        run: Depth of a tread [m].
        width: [m].
        level: On which it begins.
        shape: "straight"; "corner" and "back": two flights with a landing, at right angles and beside each other;
            "curve": three quarters of a turn to the left.
    """

    foot: tuple[float, float]
    heading: float = 0.0
    steps: int = 14
    run: float = 0.25
    width: float = 0.9
    level: int = 0
    shape: str = "straight"

    @property
    def key(self) -> str:
        return f"stairs_{self.shape}_{self.steps}_{self.run}_{self.width}"


def stacked(storeys: Sequence[Storey], stairs: Sequence[Stairs] = (), house_id: str = "stacked") -> House:
    """The storeys one above the other; compile it with `METADATA`."""
    levels = [_level(storey, [s for s in stairs if s.level == i]) for i, storey in enumerate(storeys)]
    house = outline_house(house_id, storeys[0].rooms)
    models = {s.key: _mesh(s) for s in stairs}
    return replace(house, levels=stack_levels(levels, UP), models=models)


def metadata_of(house: House) -> Metadata:
    return Metadata({key: replace(METADATA.models["stairs"], model_id=key) for key in house.models})


def _level(storey: Storey, stairs: Sequence[Stairs]) -> Level:
    (plain,) = outline_house("x", storey.rooms, storey.openings, storey.boxes, UP - 0.1).levels
    first = len(plain.rooms) + len(plain.boxes)
    return replace(plain, objects=tuple(_object(s, first + i) for i, s in enumerate(stairs)))


def _object(stairs: Stairs, index: int) -> ObjectNode:
    c, s = np.cos(stairs.heading), np.sin(stairs.heading)
    transform = np.array([[c, 0, s, stairs.foot[0]], [0, 1, 0, FLOOR], [-s, 0, c, stairs.foot[1]], [0, 0, 0, 1.0]])
    return ObjectNode(f"0_{index}", index, f"levels[0].nodes[{index}]", None, stairs.key, stairs.key, transform)


def straight(stairs: Stairs) -> list[np.ndarray]:
    """Treads on solid blocks along +x, Z up."""
    rise, half, run = UP / stairs.steps, stairs.width / 2, stairs.run
    return [cuboid((run * i, -half, 0), (run * (i + 1), half, rise * (i + 1))) for i in range(stairs.steps)]


def corner(stairs: Stairs) -> list[np.ndarray]:
    """The first half of the flight along +x, a square landing, the rest along +y."""
    rise, half, run, below = UP / stairs.steps, stairs.width / 2, stairs.run, stairs.steps // 2 - 1
    blocks, edge = straight(stairs)[:below], run * below
    blocks.append(cuboid((edge, -half, 0), (edge + 2 * half, half, rise * (below + 1))))
    for i in range(stairs.steps - below - 1):
        low, high = (edge, half + run * i, 0), (edge + 2 * half, half + run * (i + 1), rise * (below + 2 + i))
        blocks.append(cuboid(low, high))
    return blocks


def back(stairs: Stairs) -> list[np.ndarray]:
    """The first half of the flight along +x, a landing, the rest along -x to the left of the first."""
    rise, half, run, below = UP / stairs.steps, stairs.width / 2, stairs.run, stairs.steps // 2 - 1
    blocks, edge, gap = straight(stairs)[:below], run * below, 0.1
    blocks.append(cuboid((edge, -half, 0), (edge + 2 * half, 3 * half + gap, rise * (below + 1))))
    for i in range(stairs.steps - below - 1):
        low, high = (edge - run * (i + 1), half + gap, 0), (edge - run * i, 3 * half + gap, rise * (below + 2 + i))
        blocks.append(cuboid(low, high))
    return blocks


def curve(stairs: Stairs) -> list[np.ndarray]:
    """Wedges around an axis to the left of the foot, 0.35 m from them."""
    inner, angle = 0.35, np.deg2rad(270) / stairs.steps
    middle = inner + stairs.width / 2

    def wedge(i: int) -> np.ndarray:
        corners = [(r, angle * (i + k) - np.pi / 2) for r, k in ((inner, 0), (inner + stairs.width, 0))]
        corners += [(r, angle * (i + k) - np.pi / 2) for r, k in ((inner + stairs.width, 1), (inner, 1))]
        plan = np.array([[r * np.cos(a), r * np.sin(a) + middle] for r, a in corners])
        return prism(plan, UP / stairs.steps * (i + 1))

    return [wedge(i) for i in range(stairs.steps)]


def prism(plan: np.ndarray, height: float) -> np.ndarray:
    """Top and sides of what stands on the ground over a convex outline, counter-clockwise."""
    top, foot = np.c_[plan, np.full(len(plan), height)], np.c_[plan, np.zeros(len(plan))]
    faces = [[top[0], top[i], top[i + 1]] for i in range(1, len(plan) - 1)]
    for i in range(len(plan)):
        k = (i + 1) % len(plan)
        faces += [[foot[i], foot[k], top[k]], [foot[i], top[k], top[i]]]
    return np.array(faces)


SHAPES = {"straight": straight, "corner": corner, "back": back, "curve": curve}


def _mesh(stairs: Stairs) -> Mesh:
    triangles = np.concatenate(SHAPES[stairs.shape](stairs))[..., [0, 2, 1]] * [1, 1, -1]
    faces = np.arange(3 * len(triangles)).reshape(-1, 3)
    zeros = np.zeros(len(faces), np.int32)
    material = outline_house("x", [RoomOutline("Room", [(0, 0), (1, 0), (1, 1)])]).levels[0].rooms[0].floor
    assert material is not None
    return Mesh(
        material.path, triangles.reshape(-1, 3), faces, np.zeros((*faces.shape, 2)), zeros, zeros, material.materials
    )
