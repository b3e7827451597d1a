"""Which objects can be pushed: a few boxes that stand free on the ground floor."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from home_mjx.core.checks import check_number
from home_mjx.scene_compile.geometry.boxes import BoxSet, box_set, footprint, join, overlap
from home_mjx.scene_compile.geometry.mesh import bounds, compose, invert
from home_mjx.scene_compile.geometry.rotations import yaw_matrix, yaw_quat
from home_mjx.scene_compile.objects.masses import object_mass
from home_mjx.scene_compile.objects.place import PlacedObject
from home_mjx.schema.compiled import Bodies
from home_mjx.schema.house import Object

# Categories of what stands on the floor without being fixed to the house.
MOVABLE_COARSE = {
    *("bed", "bench_chair", "chair", "desk", "dresser", "dressing_table", "ottoman", "plant", "shoes_cabinet"),
    *("shelving", "sofa", "stand", "storage_bench", "table", "toy", "trash_can", "tv_stand", "vase"),
    "wardrobe_cabinet",
}
MOVABLE_FINE = {"container", "containers", "floor_lamp", "loudspeaker", "pedestal_fan", "trash_can"}
FIXED_FINE = {"bunker_bed", "chair_set", "fish_tank"}


@dataclass(frozen=True)
class MovableOptions:
    """Which objects become bodies.

    Attributes:
        max_bodies: Most bodies of a house; the lightest objects go first. 0: nothing moves.
        reach: A movable object stands within this of the floor [m].
        shrink: Most that each side of its box may be drawn in to stand free [m].
        seat: Least height of a box whose top is lowered to fit under something, as a chair's under a table [m].
        largest: Longest edge of a movable object [m].

    Raises:
        ConfigError: A value cannot be used.
    """

    max_bodies: int = 8
    reach: float = 0.05
    shrink: float = 0.05
    seat: float = 0.35
    largest: float = 2.6

    def __post_init__(self) -> None:
        check_number("max_bodies", self.max_bodies, 0, whole=True)
        for name in ("reach", "shrink", "seat", "largest"):
            check_number(name, getattr(self, name), 0)


@dataclass(frozen=True)
class Candidate:
    """An object that may become a body."""

    item: PlacedObject
    box: BoxSet
    mass: float


def choose_movables(
    objects: Sequence[PlacedObject],
    static: Mapping[int, BoxSet],
    walls: BoxSet,
    floor: float,
    ground_level: int,
    options: MovableOptions,
) -> tuple[list[Candidate], list[int]]:
    """The objects that become bodies, lightest first, and ids of those that cannot since they stand in something.

    Args:
        objects: All objects of the house.
        static: Boxes of each object while it cannot be moved, by object id.
        walls: Boxes of the architecture.
        floor: Height of the ground floor [m].
        ground_level: The level on it.
        options: Limits.
    """
    supports = _supports(objects)
    free = [
        Candidate(o, _on_floor(o.box, floor), object_mass(o))
        for o in objects
        if o.level == ground_level and o.object_id not in supports and _may_move(o, floor, options)
    ]
    candidates = sorted(free, key=lambda c: (c.mass, c.item.object_id))
    standing = _settle(candidates, objects, static, walls, options)
    ids = [c.item.object_id for c in standing[: options.max_bodies]]
    # Those that are left over are obstacles with boxes of their own, which may reach a little farther.
    chosen = _settle([c for c in candidates if c.item.object_id in ids], objects, static, walls, options)
    free_ids = {c.item.object_id for c in standing}
    return chosen, [c.item.object_id for c in candidates if c.item.object_id not in free_ids]


def _may_move(item: PlacedObject, floor: float, options: MovableOptions) -> bool:
    """By category, size and place: what hangs, is built in or stands outside stays."""
    if not isinstance(item.node, Object) or item.room < 0 or item.info.fine in FIXED_FINE:
        return False
    if item.info.coarse not in MOVABLE_COARSE and item.info.fine not in MOVABLE_FINE:
        return False
    low, high = bounds(item.triangles)
    return bool(abs(low[2] - floor) <= options.reach and (high - low).max() <= options.largest)


def _supports(objects: Sequence[PlacedObject], gap: float = 0.03) -> set[int]:
    """Ids of the objects that carry another one."""
    boxes = np.array([bounds(o.triangles) for o in objects]).reshape(-1, 2, 3)
    carriers = set()
    for low, high in boxes:
        middle = (low + high)[:2] / 2
        over = ((boxes[:, 0, :2] < middle) & (boxes[:, 1, :2] > middle)).all(axis=1)
        on = over & (low[2] > boxes[:, 0, 2] + gap) & (low[2] < boxes[:, 1, 2] + gap)
        carriers |= {o.object_id for o, below in zip(objects, on, strict=True) if below}
    return carriers


def _on_floor(box: BoxSet, floor: float) -> BoxSet:
    """The box with its underside on the floor."""
    low, high = floor, box.top[0]
    center, half = box.center.copy(), box.half.copy()
    center[0, 2], half[0, 2] = (low + high) / 2, (high - low) / 2
    return BoxSet(center, half, box.yaw)


def _settle(
    candidates: list[Candidate],
    objects: Sequence[PlacedObject],
    static: Mapping[int, BoxSet],
    walls: BoxSet,
    options: MovableOptions,
) -> list[Candidate]:
    """The candidates whose boxes touch nothing, drawn in a little if need be; the others stay where they are."""
    moving = list(candidates)
    while True:
        ids = {c.item.object_id for c in moving}
        fixed = join([walls, *(static[o.object_id] for o in objects if o.object_id not in ids)])
        standing: list[Candidate] = []
        for c in moving:
            box = _draw_in(c.box, join([fixed, *(s.box for s in standing)]), options)
            if box is not None:
                standing.append(Candidate(c.item, box, c.mass))
        if len(standing) == len(moving):
            return standing
        # Those that failed are obstacles now, so the rest must be looked at again.
        moving = [c for c in moving if any(s.item is c.item for s in standing)]


def _draw_in(box: BoxSet, obstacles: BoxSet, options: MovableOptions, gap: float = 1e-3) -> BoxSet | None:
    """The box drawn in until it is `gap` away from every obstacle; None if the limits do not allow it."""
    low, high = -box.half[0].copy(), box.half[0].copy()
    for i in _near(box, obstacles):
        now = _cut(box, low, high)
        if overlap(now, obstacles[i : i + 1])[0] <= -gap or obstacles.bottom[i] >= now.top[0]:
            continue
        below = obstacles.bottom[i] - gap - box.center[0, 2]
        if below - low[2] >= options.seat:
            high[2] = below
        else:
            _draw_side(box, obstacles, i, low, high, gap)
    drawn = np.maximum(box.half[0] - high, low + box.half[0])[:2]
    if (drawn > options.shrink).any() or (high - low < 0.5 * 2 * box.half[0])[:2].any():
        return None
    return _cut(box, low, high)


def _draw_side(
    box: BoxSet, obstacles: BoxSet, index: int, low: Float[np.ndarray, "3"], high: Float[np.ndarray, "3"], gap: float
) -> None:
    """Moves the one of four sides that has the shortest way to get clear of an obstacle."""
    corners = (footprint(obstacles, index) - box.center[0, :2]) @ yaw_matrix(box.yaw[0])[:2, :2]
    ways = np.array([high[:2] - corners.min(axis=0), corners.max(axis=0) - low[:2]])
    side, axis = divmod(int(ways.argmin()), 2)
    if side == 0:
        high[axis] -= ways[0, axis] + gap
    else:
        low[axis] += ways[1, axis] + gap


def _cut(box: BoxSet, low: Float[np.ndarray, "3"], high: Float[np.ndarray, "3"]) -> BoxSet:
    """The part of a box between two corners in its own frame."""
    center = box.center[0] + yaw_matrix(box.yaw[0]) @ ((low + high) / 2)
    return box_set(center, (high - low) / 2, box.yaw[0])


def _near(box: BoxSet, obstacles: BoxSet) -> list[int]:
    """Rows of the obstacles whose bounding circles and heights overlap those of a box."""
    apart = np.linalg.norm(obstacles.center[:, :2] - box.center[0, :2], axis=1)
    reach = np.linalg.norm(obstacles.half[:, :2], axis=1) + np.linalg.norm(box.half[0, :2])
    level = (obstacles.bottom < box.top[0]) & (obstacles.top > box.bottom[0])
    return np.flatnonzero((apart < reach) & level).tolist()


def make_bodies(chosen: Sequence[Candidate]) -> Bodies:
    """Bodies of the chosen objects, in the given order."""
    box = join(c.box for c in chosen)
    quat = yaw_quat(box.yaw)
    frames = [np.c_[yaw_matrix(y), c] for y, c in zip(box.yaw, box.center, strict=True)]
    inner = [compose(invert(f), c.item.pose) for f, c in zip(frames, chosen, strict=True)]
    return Bodies(
        instance=np.array([c.item.instance for c in chosen], np.int32),
        pos=box.center,
        quat=quat,
        size=box.half,
        mass=np.array([c.mass for c in chosen], float),
        from_model=np.array(inner).reshape(-1, 3, 4),
    )
