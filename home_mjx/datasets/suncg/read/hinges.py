"""Detection of door hinges and rails by comparison of a model's open and closed variant.

SUNCG only has an open (the base model) and a closed variant (`_0`) of each door. Parts that are equal in both are the
frame. Parts that turn about a vertical line, or move along their own plane, are leaves.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import KDTree

from home_mjx.geometry.box_fit import narrowest_box, sample_surface, triangle_components
from home_mjx.geometry.cells import unique_cells
from home_mjx.geometry.rotations import plane_matrix

SAME_CORNER_DISTANCE = 2e-3  # [m], corners closer than this are equal in both variants
MAX_PART_DISTANCE = 0.03  # [m], maximum distance between parts of one leaf, such as its panel and handles
SAMPLE_SPACING = 0.05  # [m], distance of sample points on the moving surface
TARGET_SPACING = SAMPLE_SPACING / 4  # [m], distance of sample points on the target surface
MIN_TURN = np.deg2rad(5.0)  # minimum rotation of a turning leaf
MIN_SLIDE = 0.1  # [m], minimum translation of a sliding leaf
MAX_SLIDE_SKEW = 0.1  # maximum sine of the angle between a sliding leaf and its translation
TIE_TOLERANCE = 0.02  # fits whose shares differ by at most this from the best are considered equal
MAX_POINTS = 3_000_000  # maximum sample points of a variant; doors of real houses need some ten thousand
MAX_PARTS = 300  # maximum number of moving components, since all pairs are compared
MIN_FIT_SHARE = 0.9  # minimum share of a moved leaf's points on the other variant's surface


@dataclass(frozen=True)
class Hinge:
    """A door leaf with the vertical axis that it turns about, or the rail that it slides along.

    Attributes:
        leaf: Mask of the model's triangles.
        pivot: Intersection of the axis with the plan, in the model's frame [m]; any point of a sliding leaf.
        displacement: Rotation about +z, or sliding distance, to the other variant's position [rad] or [m].
        slide: Unit direction in the plan to that position; 0: the leaf turns.
    """

    leaf: Bool[np.ndarray, " t"]
    pivot: Float[np.ndarray, "2"]
    displacement: float
    slide: Float[np.ndarray, "2"] = field(default_factory=lambda: np.zeros(2))


@dataclass(frozen=True)
class HingeTable:
    """Arrays of the hinges of a door; see `Hinge`."""

    leaf: Bool[np.ndarray, "h t"]
    pivot: Float[np.ndarray, "h 2"]
    displacement: Float[np.ndarray, " h"]
    slide: Float[np.ndarray, "h 2"]

    @classmethod
    def of(cls, hinges: Sequence[Hinge], num_triangles: int) -> "HingeTable":
        """Create the table of hinges of a variant with `num_triangles` triangles."""
        return cls(
            np.array([hinge.leaf for hinge in hinges], bool).reshape(-1, num_triangles),
            np.array([hinge.pivot for hinge in hinges], float).reshape(-1, 2),
            np.array([hinge.displacement for hinge in hinges], float),
            np.array([hinge.slide for hinge in hinges], float).reshape(-1, 2),
        )

    @property
    def hinges(self) -> tuple[Hinge, ...]:
        """The hinges, one per row."""
        columns = zip(self.leaf, self.pivot, self.displacement.tolist(), self.slide, strict=True)
        return tuple(Hinge(*column) for column in columns)


def find_hinges(shown: Float[np.ndarray, "t 3 3"], other: Float[np.ndarray, "s 3 3"]) -> tuple[Hinge, ...]:
    """Find the leaves of a door with their motion from the pose in `shown` to that in `other` (triangles, Z up [m]).

    Leaves whose motion is not found are left out. Empty if no part turns or slides, if a variant is too large for a
    door, or if more than `MAX_PARTS` components moved.

    Example:
        >>> find_hinges(open_door, closed_door)[0].displacement  # doctest: +SKIP
        -1.5707963267948966
    """
    if not all(map(_is_small_enough, (shown, other))):
        return ()
    target, part = _moved(other, shown), triangle_components(shown)
    moved = np.isin(part, _moved_parts(shown, part, other))
    if not moved.any() or not len(target) or len(np.unique(part[moved])) > MAX_PARTS:
        return ()
    hinges = []
    for leaf in _leaves(shown, part, moved):
        found = _move_onto(shown[leaf], target)
        if found is not None:
            hinges.append(Hinge(leaf, *found))
    return tuple(hinges)


def _is_small_enough(triangles: Float[np.ndarray, "t 3 3"]) -> bool:
    """Return whether a variant has an estimated number of sample points below `MAX_POINTS`.

    A wrong unit of length would need billions of points.
    """
    edge = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=-1).max(axis=1)
    return bool(((edge / TARGET_SPACING + 1) ** 2).sum() / 2 < MAX_POINTS)


def _moved(triangles: Float[np.ndarray, "t 3 3"], other: Float[np.ndarray, "s 3 3"]) -> Float[np.ndarray, "m 3 3"]:
    """Return the triangles of the components that are not at the same place in the other variant."""
    part = triangle_components(triangles)
    return triangles[np.isin(part, _moved_parts(triangles, part, other))]


def _moved_parts(
    triangles: Float[np.ndarray, "t 3 3"], part: Int[np.ndarray, " t"], other: Float[np.ndarray, "s 3 3"]
) -> list[int]:
    """Return the numbers in `part` of components with a corner over 2 mm from all corners of the other variant."""
    away = KDTree(other.reshape(-1, 3)).query(triangles.reshape(-1, 3))[0].reshape(-1, 3).max(axis=1)
    return [int(p) for p in np.unique(part) if away[part == p].max() > SAME_CORNER_DISTANCE]


def _leaves(
    triangles: Float[np.ndarray, "t 3 3"], part: Int[np.ndarray, " t"], moved: Bool[np.ndarray, " t"]
) -> Iterator[Bool[np.ndarray, " t"]]:
    """Yield a mask of triangles per leaf: moved components linked by gaps of at most `MAX_PART_DISTANCE`.

    Handles thus belong to their panel.
    """
    names = np.unique(part[moved])
    trees = [KDTree(_sample(triangles[part == name], MAX_PART_DISTANCE / 2)) for name in names]
    group = np.arange(len(names))
    for i in range(len(names)):
        for j in range(i):
            if group[i] != group[j] and trees[i].count_neighbors(trees[j], MAX_PART_DISTANCE):
                group[group == group[i]] = group[j]
    for g in np.unique(group):
        yield np.isin(part, names[group == g])


def _move_onto(
    leaf: Float[np.ndarray, "t 3 3"], target: Float[np.ndarray, "s 3 3"]
) -> tuple[Float[np.ndarray, "2"], float, Float[np.ndarray, "2"]] | None:
    """Return pivot, displacement and slide (see `Hinge`) that move a leaf onto a surface; None if no motion fits.

    Each guess is refined. A motion fits if the share of the leaf's points on the surface is at least `MIN_FIT_SHARE`
    and at most `TIE_TOLERANCE` below the best. If one fits that turns by less than `MIN_TURN`, before and after
    refinement, the leaf can only slide: by the shortest shift of such guesses, or None if `_slide` rejects it.
    Otherwise it turns about the pivot that is nearest to the leaf in plan.
    """
    points, tree = _sample(leaf, SAMPLE_SPACING), KDTree(_sample(target, TARGET_SPACING))
    guesses = list(_guesses(leaf, target))
    fits = [_refine(points, tree, *guess) for guess in guesses]
    best = max((share for share, _, _ in fits), default=0.0)
    good = [
        (g, (a, s))
        for g, (share, a, s) in zip(guesses, fits, strict=True)
        if share >= max(best - TIE_TOLERANCE, MIN_FIT_SHARE)
    ]
    straight = [guess[1] for guess, fit in good if max(abs(guess[0]), abs(fit[0])) < MIN_TURN]
    if straight:  # a sliding leaf: use the shift between boxes, the smallest if several targets fit
        return _slide(points, min(straight, key=lambda shift: float(np.linalg.norm(shift))))
    # The fixed point p satisfies (1 - R) p = shift. A symmetric leaf fits several ways; the hinge is on its own edge.
    found = [(np.linalg.solve(np.eye(2) - plane_matrix(angle), shift), angle) for _, (angle, shift) in good]
    nearest = min(found, key=lambda f: np.linalg.norm(points[:, :2] - f[0], axis=1).min(), default=None)
    return None if nearest is None else (*nearest, np.zeros(2))


def _slide(
    points: Float[np.ndarray, "p 3"], shift: Float[np.ndarray, "2"]
) -> tuple[Float[np.ndarray, "2"], float, Float[np.ndarray, "2"]] | None:
    """Return mean point, distance and direction of a leaf's shift in the plan [m]; None if it is not along the leaf.

    That is a shift shorter than `MIN_SLIDE`, or whose angle to the longer side of the leaf's box has a sine above
    `MAX_SLIDE_SKEW`. The shift of a board that was taken out of its frame is across it.
    """
    way = float(np.linalg.norm(shift))
    box = narrowest_box(points)
    across = plane_matrix(-float(box.yaw[0]))[int(box.half[0, 0] >= box.half[0, 1])] @ shift
    if way < MIN_SLIDE or abs(across) > MAX_SLIDE_SKEW * way:
        return None
    return points[:, :2].mean(axis=0), way, shift / way


def _guesses(
    leaf: Float[np.ndarray, "t 3 3"], target: Float[np.ndarray, "s 3 3"]
) -> Iterator[tuple[float, Float[np.ndarray, "2"]]]:
    """Yield initial motions of a leaf in plan: rotation about the origin in -pi..pi [rad], then shift [m].

    Each moves the box (`narrowest_box`) of the leaf's largest component onto that of a component of `target`, so that
    centres coincide and edges are parallel: four quarter turns per component. Components are left out whose box differs
    by `SAMPLE_SPACING` or more in half height or in the height of its centre.
    """
    big = _largest(leaf)
    source = narrowest_box(big.reshape(-1, 3))
    part = triangle_components(target)
    for piece in (target[part == p] for p in np.unique(part)):
        box = narrowest_box(piece.reshape(-1, 3))
        if (
            abs(box.half[0, 2] - source.half[0, 2]) < SAMPLE_SPACING
            and abs(box.center[0, 2] - source.center[0, 2]) < SAMPLE_SPACING
        ):
            for quarter in range(4):
                angle = float(box.yaw[0] - source.yaw[0] + quarter * np.pi / 2)
                angle = (angle + np.pi) % (2 * np.pi) - np.pi
                yield angle, box.center[0, :2] - plane_matrix(angle) @ source.center[0, :2]


def _largest(triangles: Float[np.ndarray, "t 3 3"]) -> Float[np.ndarray, "l 3 3"]:
    """Return the connected component whose bounding box has the largest volume."""
    part = triangle_components(triangles)
    pieces: Sequence = [triangles[part == p] for p in np.unique(part)]
    return max(pieces, key=lambda piece: np.prod(np.ptp(piece.reshape(-1, 3), axis=0) + SAME_CORNER_DISTANCE))


def _refine(
    points: Float[np.ndarray, "p 3"], tree: KDTree, angle: float, shift: Float[np.ndarray, "2"], rounds: int = 20
) -> tuple[float, float, Float[np.ndarray, "2"]]:
    """Refine a motion of `points` in the plan onto those of `tree` by iterated closest points (Besl and McKay, 1992).

    Closest points are searched in space. The end is when they no longer change, or after `rounds` iterations.

    Returns:
        Share of points within `SAMPLE_SPACING` / 2 of those of `tree`, rotation about the origin [rad], and shift after
        it [m].
    """
    before = None
    for _ in range(rounds):
        _, nearest = tree.query(_put(points, angle, shift))
        if before is not None and (nearest == before).all():
            break
        angle, shift = _fit(points[:, :2], tree.data[nearest][:, :2])
        before = nearest
    away, _ = tree.query(_put(points, angle, shift))
    return float((away < SAMPLE_SPACING / 2).mean()), angle, shift


def _sample(triangles: Float[np.ndarray, "t 3 3"], spacing: float) -> Float[np.ndarray, "p 3"]:
    """Sample points of a surface, at most one per grid cell of size `spacing` [m]."""
    points = sample_surface(triangles, spacing)
    return points[unique_cells(np.floor(points / spacing).astype(np.int64))[0]]


def _put(points: Float[np.ndarray, "p 3"], angle: float, shift: Float[np.ndarray, "2"]) -> Float[np.ndarray, "p 3"]:
    """Return points rotated about +z by `angle` [rad], then shifted in plan [m]."""
    return np.c_[points[:, :2] @ plane_matrix(angle).T + shift, points[:, 2]]


def _fit(source: Float[np.ndarray, "p 2"], target: Float[np.ndarray, "p 2"]) -> tuple[float, Float[np.ndarray, "2"]]:
    """Return rotation [rad] and shift of the least-squares motion from `source` to `target` (Kabsch, 1976)."""
    middle, goal = source.mean(axis=0), target.mean(axis=0)
    a, b = source - middle, target - goal
    angle = float(np.arctan2((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum(), (a * b).sum()))
    return angle, goal - plane_matrix(angle) @ middle
