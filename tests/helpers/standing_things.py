"""What things in written homes touch and what they are in: from the files alone, piece by piece.

A piece is a connected part of a model's mesh. Its upright bounding box holds it, so pieces whose boxes are apart are
apart; the boxes of slanting pieces are larger than these, never smaller.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from walked_homes import Home, corners

TOUCH = 0.005  # [m]
FREE = {"door", "window", "stairs", "fence", "garage_door"}  # parts of the building


@dataclass(frozen=True)
class Thing:
    """An object of a level, and the boxes of its pieces [m]."""

    name: str
    fine: str
    room: int
    pieces: np.ndarray  # (p, 2, 3)

    @property
    def box(self) -> np.ndarray:
        return np.stack([self.pieces[:, 0].min(axis=0), self.pieces[:, 1].max(axis=0)])


@lru_cache(maxsize=2000)
def pieces_of(key: int, faces: bytes, count: int) -> np.ndarray:
    """The piece of each vertex."""
    del key
    edges = np.frombuffer(faces, np.int64).reshape(-1, 3)[:, [0, 1, 1, 2]].reshape(-1, 2)
    graph = coo_matrix((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(count, count))
    return connected_components(graph, directed=False)[1]


def things(home: Home, number: int) -> list[Thing]:
    level, found = home.house.levels[number], []
    owner = {i: room.index for room in level.rooms for i in room.members}
    for item in (item for item in level.objects if item.index in owner):  # without what is outside
        mesh = home.house.models[item.model_key]
        points, faces = mesh.vertices, mesh.faces.astype(np.int64)
        label = pieces_of(id(mesh), faces.tobytes(), len(points))
        world = points @ item.transform[:3, :3].T + item.transform[:3, 3]
        order = np.argsort(label, kind="stable")
        starts = np.flatnonzero(np.diff(label[order], prepend=-1))
        boxes = np.stack([f.reduceat(world[order], starts, axis=0) for f in (np.minimum, np.maximum)], axis=1)
        found.append(Thing(item.model_id, home.fine(item.model_id), owner[item.index], boxes))
    return found


def overlaps(found: list[Thing], tolerance: float = TOUCH) -> list[tuple[str, str, float]]:
    """Pairs of things that are deeper in one another than a tolerance [m]."""
    boxes, bad = np.array([t.box for t in found]), []
    for i, one in enumerate(found):
        depth = np.minimum(boxes[i, 1], boxes[i + 1 :, 1]) - np.maximum(boxes[i, 0], boxes[i + 1 :, 0])
        for j in (i + 1 + np.flatnonzero((depth > tolerance).all(axis=1))).tolist():
            other = found[j]
            a, b = one.pieces[:, None], other.pieces[None]
            deep = (np.minimum(a[:, :, 1], b[:, :, 1]) - np.maximum(a[:, :, 0], b[:, :, 0])).min(axis=-1).max()
            if deep > tolerance:
                bad.append((one.name, other.name, round(float(deep), 4)))
    return bad


def floating(home: Home, number: int, found: list[Thing]) -> list[str]:
    """Names of things that neither stand on a floor or a thing, nor touch a wall, a splashback or a ceiling."""
    level = home.house.levels[number]
    walls = np.concatenate([flat(corners(room.walls)) for room in level.rooms if room.walls is not None])
    floors = np.concatenate([flat(corners(room.floor)) for room in level.rooms if room.floor is not None])
    ceilings = [flat(corners(room.ceiling)) for room in level.rooms if room.ceiling is not None]
    building = np.concatenate([walls, floors, *ceilings])
    pieces = np.concatenate([t.pieces for t in found])
    owner = np.repeat(np.arange(len(found)), [len(t.pieces) for t in found])
    panels = np.concatenate([building[:0], *(t.pieces for t in found if "splashback" in t.name)])
    bad = []
    for i, thing in enumerate(found):
        low, high = thing.box[0] - TOUCH, thing.box[1] + TOUCH
        backs = building if "splashback" in thing.name else np.concatenate([building, panels])
        if thing.fine in FREE or ((backs[:, 0] <= high) & (backs[:, 1] >= low)).all(axis=1).any():
            continue
        under = (owner != i) & (abs(pieces[:, 1, 1] - thing.box[0, 1]) < TOUCH)
        under &= ((pieces[:, 0] < high) & (pieces[:, 1] > low))[:, [0, 2]].all(axis=1)
        if not under.any():
            bad.append(thing.name)
    return bad


def flat(triangles: np.ndarray) -> np.ndarray:
    """Boxes around triangles: of walls, floors and ceilings these are thin."""
    return np.stack([triangles.min(axis=1), triangles.max(axis=1)], axis=1)
