"""Homes as they are written, looked at by means that share nothing with the generator or the compiler.

Meshes are read from the files; doors join the rooms in front of and behind them; where one can walk is flooded over
voxels of all triangles, stairs climbed tread by tread.
"""

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import ndimage

from home_mjx.datasets import open_dataset
from home_mjx.schema.house import House, Mesh, Metadata

CELL = 0.05  # [m], of voxels
STEP_UP = 0.2  # [m], from tread to tread
TALL, CLEAR = 1.6, 0.06  # [m], of the walker; what is lower than that above the floor is stepped over
OVERHEAD = 0.45  # [m] above a tread or floor, from which on stairs and ceilings are in the way: below they are steps
LINKS = {"Hallway", "Hall", "Lobby", "Entryway", "Living_Room", "Dining_Room", "Kitchen"}


def corners(mesh: Mesh) -> np.ndarray:
    return mesh.vertices[mesh.faces].astype(float)


def upward(triangles: np.ndarray) -> np.ndarray:
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return triangles[normal[:, 1] > 0.95 * np.maximum(np.linalg.norm(normal, axis=1), 1e-12)]


def inside(triangles: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Whether points (x, z) are in a triangle, seen from above."""
    a, b, c = (triangles[:, k][:, None, [0, 2]] for k in range(3))
    sides = [
        (q[..., 0] - p[..., 0]) * (points[None, :, 1] - p[..., 1])
        - (q[..., 1] - p[..., 1]) * (points[None, :, 0] - p[..., 0])
        for p, q in ((a, b), (b, c), (c, a))
    ]
    low, high = np.min(sides, axis=0), np.max(sides, axis=0)
    return ((low >= -1e-9) | (high <= 1e-9)).any(axis=0)


@dataclass(frozen=True)
class Home:
    """A written house and its tables."""

    house: House
    metadata: Metadata

    @classmethod
    def read(cls, root, house_id: str) -> "Home":
        dataset = open_dataset(root)
        return cls(dataset.load_house(house_id), dataset.metadata)

    def fine(self, model_id: str) -> str:
        return self.metadata.info(model_id).fine

    @cached_property
    def floors(self) -> list[list[np.ndarray]]:
        """Of each level, of each room: triangles that look up."""
        return [[upward(corners(room.floor)) for room in level.rooms] for level in self.house.levels]

    def room_at(self, level: int, point: np.ndarray) -> int:
        found = [i for i, floor in enumerate(self.floors[level]) if inside(floor, point[None])[0]]
        return found[0] if found else -1

    def doors(self, level: int) -> list[tuple[int, int]]:
        """The rooms on both sides of every door; -1 is outside."""
        found = []
        for item in self.house.levels[level].objects:
            if self.fine(item.model_id) == "door":
                middle, across = item.transform[[0, 2], 3], item.transform[[0, 2], 2]
                across = across / np.linalg.norm(across)
                found.append((self.room_at(level, middle + 0.3 * across), self.room_at(level, middle - 0.3 * across)))
        return found

    def stairs(self) -> list[tuple[int, int, int]]:
        """Level, room at the foot, and room of the next level at the head: both before the stairs' front edge."""
        found = []
        for number, level in enumerate(self.house.levels):
            for item in level.objects:
                if self.fine(item.model_id) == "stairs":
                    front = item.transform[[0, 2], 2] / np.linalg.norm(item.transform[[0, 2], 2])
                    at = item.transform[[0, 2], 3] + 0.3 * front
                    found.append((number, self.room_at(number, at), self.room_at(number + 1, at)))
        return found

    def kind(self, level: int, room: int) -> str:
        return self.house.levels[level].rooms[room].types[0]

    def graph(self) -> dict[tuple[int, int], set[tuple[int, int]]]:
        """Rooms (level, index) and those that doors and stairs join them with."""
        joined: dict[tuple[int, int], set[tuple[int, int]]] = defaultdict(set)
        for number in range(len(self.house.levels)):
            for a, b in self.doors(number):
                if min(a, b) >= 0:
                    joined[number, a].add((number, b))
                    joined[number, b].add((number, a))
        for number, below, above in self.stairs():
            joined[number, below].add((number + 1, above))
            joined[number + 1, above].add((number, below))
        return joined

    def rooms(self) -> list[tuple[int, int]]:
        return [(n, i) for n, level in enumerate(self.house.levels) for i in range(len(level.rooms))]

    def entrances(self) -> list[tuple[int, int]]:
        """Rooms (level, index) with a door to the outside."""
        pairs = [(n, pair) for n in range(len(self.house.levels)) for pair in self.doors(n)]
        return [(n, max(pair)) for n, pair in pairs if min(pair) < 0]


def reachable(joined, start, through) -> set:
    """Breadth first; rooms that `through` does not hold for are entered but not left."""
    seen, front = {start}, [start]
    while front:
        front = [b for a in front if a == start or through(a) for b in joined[a] if b not in seen]
        front = list(dict.fromkeys(front))
        seen |= set(front)
    return seen


def samples(triangles: np.ndarray, spacing: float = CELL) -> Iterator[np.ndarray]:
    """Points on triangles, along their edges no farther apart than `spacing`."""
    edges = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=2).max(axis=1)
    counts = np.ceil(edges / spacing).astype(int)
    for count in np.unique(counts).tolist():
        u, v = np.meshgrid(np.arange(count + 1), np.arange(count + 1), indexing="ij")
        weight = np.stack([u, v, count - u - v], axis=-1)[u + v <= count] / max(count, 1)
        yield (weight @ triangles[counts == count]).reshape(-1, 3)


class Walker:
    """Voxels of a home."""

    def __init__(self, home: Home) -> None:
        self.home = home
        walls = [corners(r.walls) for lv in home.house.levels for r in lv.rooms if r.walls is not None]
        slabs = [corners(r.ceiling) for lv in home.house.levels for r in lv.rooms if r.ceiling is not None]
        things, stairs = [], []
        for level in home.house.levels:
            for item in level.objects:
                mesh = home.house.models[item.model_key]
                placed = corners(mesh) @ item.transform[:3, :3].T + item.transform[:3, 3]
                (stairs if home.fine(item.model_id) == "stairs" else things).append(placed)
        floors = np.concatenate([floor for rooms in home.floors for floor in rooms]).reshape(-1, 3)
        self.low = floors.min(axis=0) - 0.5
        above = np.array([0.5, TALL + 0.5, 0.5])
        self.shape = np.ceil((floors.max(axis=0) + above - self.low) / CELL).astype(int)
        self.solid = self.voxels(np.concatenate([*walls, *things]))
        self.stairs = self.voxels(np.concatenate([*stairs, *slabs]))
        self.surfaces = list(self.find_surfaces(stairs))

    def voxels(self, triangles: np.ndarray) -> np.ndarray:
        """Where some triangles are, as far as they are near floors: a garden has more of them than a home."""
        grid = np.zeros(self.shape, bool)
        low, high = triangles.min(axis=1), triangles.max(axis=1)
        near = ((high > self.low) & (low < self.low + CELL * self.shape)).all(axis=1)
        for points in samples(triangles[near]):
            place = np.floor((points - self.low) / CELL).astype(int)
            grid[tuple(place[((place >= 0) & (place < self.shape)).all(axis=1)].T)] = True
        return grid

    def find_surfaces(self, stairs: list[np.ndarray]) -> Iterator[tuple[float, np.ndarray]]:
        """Heights to stand on, and where: the floors of each level, and every tread."""
        by_height: dict[float, list[np.ndarray]] = defaultdict(list)
        for rooms in self.home.floors:
            for floor in rooms:
                by_height[round(float(floor[..., 1].mean()), 3)].append(floor)
        for one in stairs:
            for triangle in upward(one):
                by_height[round(float(triangle[:, 1].mean()), 3)].append(triangle[None])
        for height, parts in by_height.items():
            yield height, self.covered(np.concatenate(parts))

    def covered(self, triangles: np.ndarray) -> np.ndarray:
        """Columns of voxels whose middles are in one of some triangles, seen from above."""
        x, z = (self.low[k] + CELL * (np.arange(self.shape[k]) + 0.5) for k in (0, 2))
        area = np.zeros((len(x), len(z)), bool)
        for triangle in triangles:
            i, j = (np.searchsorted(v, [triangle[:, k].min(), triangle[:, k].max()]) for v, k in ((x, 0), (z, 2)))
            points = np.stack(np.meshgrid(x[i[0] : i[1]], z[j[0] : j[1]], indexing="ij"), axis=-1)
            there = inside(triangle[None], points.reshape(-1, 2)).reshape(points.shape[:2])
            area[i[0] : i[1], j[0] : j[1]] |= there
        return area

    def free(self, height: float, area: np.ndarray, radius: float) -> np.ndarray:
        """Where a walker of a radius can stand at a height."""

        def layer(z: float) -> int:
            return int(np.clip(np.floor((height + z - self.low[1]) / CELL + 1e-6), 0, self.shape[1]))

        taken = self.solid[:, layer(CLEAR + CELL) : layer(TALL)].any(axis=1)
        taken |= self.stairs[:, layer(OVERHEAD) : layer(TALL)].any(axis=1)
        # What is in a voxel is up to half a voxel nearer or farther than its middle.
        return area & (ndimage.distance_transform_edt(~taken) * CELL > radius - CELL / 2)

    def reached(self, radius: float) -> dict[tuple[int, int], float]:
        """Of every room the part of its free floor that is reached from the entrance's room [m^2]."""
        heights = [height for height, _ in self.surfaces]
        free = [self.free(height, area, radius) for height, area in self.surfaces]
        found = [np.zeros_like(cells) for cells in free]
        level, room = self.home.entrances()[0]
        ground = heights.index(min(heights, key=lambda h: abs(h - self.height(level))))
        parts, _ = ndimage.label(free[ground])
        here = self.cells(level, room)
        numbers = np.bincount(parts[here & free[ground]])
        found[ground] = parts == 1 + int(np.argmax(numbers[1:]))
        while True:
            before = sum(int(cells.sum()) for cells in found)
            for i, cells in enumerate(free):
                near = [found[j] for j, h in enumerate(heights) if abs(h - heights[i]) <= STEP_UP and found[j].any()]
                if near:
                    seed = ndimage.binary_dilation(np.any(near, axis=0)) & cells
                    found[i] = ndimage.binary_propagation(seed | found[i], mask=cells)
            if sum(int(cells.sum()) for cells in found) == before:
                break
        return {
            (n, r): float((found[self.floor_number(heights, n)] & self.cells(n, r)).sum()) * CELL**2
            for n, r in self.home.rooms()
        }

    def height(self, level: int) -> float:
        return float(self.home.floors[level][0][..., 1].mean())

    def floor_number(self, heights: list[float], level: int) -> int:
        return heights.index(min(heights, key=lambda h: abs(h - self.height(level))))

    def cells(self, level: int, room: int) -> np.ndarray:
        return self.covered(self.home.floors[level][room])


def room_map(home: Home, level: int = 0, cell: float = 0.25) -> np.ndarray:
    """Types of rooms on a grid over one level: index + 1, 0 outside."""
    points = np.concatenate([floor.reshape(-1, 3) for floor in home.floors[level]])[:, [0, 2]]
    low, high = points.min(axis=0), points.max(axis=0)
    axes = [np.arange(a + cell / 2, b, cell) for a, b in zip(low, high, strict=True)]
    place = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    found = np.zeros(len(place), int)
    for room, floor in zip(home.house.levels[level].rooms, home.floors[level], strict=True):
        found[inside(floor, place)] = KINDS.index(room.types[0]) + 1
    return found.reshape(len(axes[0]), len(axes[1]))


KINDS = (
    "Living_Room",
    "Kitchen",
    "Bedroom",
    "Child_Room",
    "Dining_Room",
    "Bathroom",
    "Toilet",
    "Hall",
    "Hallway",
    "Office",
    "Guest_Room",
    "Wardrobe",
    "Room",
    "Lobby",
    "Storage",
    "Boiler_room",
    "Balcony",
    "Loggia",
    "Terrace",
    "Entryway",
    "Garage",
    "Gym",
)


def likeness(one: np.ndarray, other: np.ndarray) -> float:
    """Greatest part of both maps together that has the same type, over the eight ways to turn one, corners aligned."""
    best = 0.0
    for turns in range(4):
        for turned in (np.rot90(other, turns), np.rot90(other, turns)[::-1]):
            shape = np.maximum(one.shape, turned.shape)
            a, b = np.zeros(shape, int), np.zeros(shape, int)
            a[: one.shape[0], : one.shape[1]] = one
            b[: turned.shape[0], : turned.shape[1]] = turned
            best = max(best, float(((a == b) & (a > 0)).sum() / ((a > 0) | (b > 0)).sum()))
    return best


def may_be_alike(one: np.ndarray, other: np.ndarray, bar: float) -> bool:
    """Whether the areas by type leave it possible that two maps are alike by more than a bar."""
    counts = [np.bincount(m.ravel(), minlength=len(KINDS) + 1)[1:] for m in (one, other)]
    common, union = np.minimum(*counts).sum(), np.maximum(counts[0].sum(), counts[1].sum())
    return bool(common > bar * union)
