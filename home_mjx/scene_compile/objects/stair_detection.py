"""Detection of treads of stairs: straight flights with landings between them, or one curve of constant rise.

A tread is an upward surface at one height. Flights are separated by their landings, which are larger than treads.
Stairs that are neither straight nor a curve, such as those with winders in a corner, are not supported.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from home_mjx.geometry.box_fit import sample_surface
from home_mjx.geometry.cells import unique_cells
from home_mjx.geometry.rotations import plane_matrix
from home_mjx.scene_compile.objects.slopes import Slope

MIN_TREAD_NORMAL_Z = 0.95  # minimum vertical component of a tread's unit normal
MIN_CORRELATION = 0.95  # minimum correlation between height and position of the treads of a straight flight
MAX_LATERAL_SPREAD = 0.35  # maximum lateral spread of a straight flight's tread centres, as a fraction of their width
MAX_INCLINATION = 60.0  # [degrees], maximum inclination; steeper objects are ladders
MAX_START_OFFSET, MAX_END_OFFSET = 0.3, 0.4  # [m], from the first tread to a slope's start; from the last to its end
MIN_TOP_LENGTH = 0.01  # [m], minimum length of a top tread beyond a slope
SAMPLE_SPACING, SAMPLE_CELL = 0.04, 0.05  # [m], of points on treads; of cells in which only the highest are used
TREAD_HEIGHT_TOLERANCE = 0.03  # [m], heights that differ by less belong to one tread
MIN_TREAD_AREA_RATIO, MIN_LANDING_AREA_RATIO = 0.3, 1.8  # area of a tread and of a landing relative to the median
MAX_STEP_RISE = 0.4  # [m], maximum rise of a step
MAX_LANDING_GAP = 0.25  # [m], maximum gap between a landing and the adjacent treads
MIN_CURVE_TREADS = 4  # minimum number of treads of a curve
MIN_TREAD_ANGLE = 0.05  # [rad], minimum angle from tread to tread of a curve
MAX_RADIUS_DEVIATION = 0.15  # maximum relative deviation of a curve's treads from its radius
MAX_CURVE_ANGLE = np.deg2rad(330)  # maximum angle of a curve; beyond it, one end would be above the other
MIN_INNER_RADIUS_RATIO = 0.4  # minimum inner radius relative to the outer one; curves are too steep near the centre
MAX_SECTOR_ANGLE = np.deg2rad(20.0)  # maximum angle of a curve per slope
MAX_SLOPE_STEP, AGENT_AXIS_DISTANCE = 0.03, 0.1  # [m], step between slopes of a curve, this far from its edges

Polygon = Float[np.ndarray, "_ 2"]
SlopesTopWell = tuple[
    list[Slope], list[Polygon], list[Polygon]
]  # slopes, remaining top tread and well, see `StraightFlights`


@dataclass(frozen=True)
class StraightRun:
    """Consecutive straight treads in a frame rotated by `yaw`: height = `offset` + `grade` * x."""

    yaw: float
    grade: float
    offset: float
    first: float  # [m], x of its start
    last: float
    right: float  # [m], y of its right side
    left: float

    @classmethod
    def fit(cls, line: tuple[int, float, float], points: Float[np.ndarray, "n 2"]) -> "StraightRun":
        """Create a run from `_line`'s result for its treads, and their plan points [m]; `yaw` is uphill."""
        axis, rise, offset = line
        yaw = axis * np.pi / 2 + (np.pi if rise < 0 else 0.0)
        local = points @ plane_matrix(yaw)
        (first, right), (last, left) = local.min(axis=0).tolist(), local.max(axis=0).tolist()
        return cls(float(yaw), abs(rise), offset, first, last, right, left)

    def point_at(self, along: float) -> Float[np.ndarray, "2"]:
        """Return the plan point of the middle line at a local x [m]; 0 is not the start of the run, see `first`."""
        return plane_matrix(self.yaw) @ [along, (self.left + self.right) / 2]

    def start(self, low: float) -> float:
        """Return the local x [m] where the slope leaves a floor at `low` [m], within `MAX_START_OFFSET` of `first`."""
        return float(
            np.clip((low - self.offset) / self.grade, self.first - MAX_START_OFFSET, self.first + MAX_START_OFFSET)
        )

    def end(self, high: float) -> float:
        """Return the local x [m] where the slope meets a floor at `high` [m], up to `MAX_END_OFFSET` before `last`."""
        return float(np.clip((high - self.offset) / self.grade, self.last - MAX_END_OFFSET, self.last))

    def slope(self, start: float, end: float, low: float, high: float) -> Slope:
        """Return the slope between two local x, `start` and `end`, and two heights [m]."""
        return Slope(self.point_at(start), self.yaw, end - start, self.left - self.right, low, high)


@dataclass(frozen=True)
class StraightFlights:
    """Straight flights with a landing between each pair; a landing has a height and corners [m]."""

    runs: Sequence[StraightRun]
    landings: Sequence[tuple[float, Float[np.ndarray, "4 2"]]]

    def ends(self, beside: float) -> tuple[Float[np.ndarray, "2"], Float[np.ndarray, "2"]]:
        """Return plan points of the middle line, `beside` [m] before the first tread and beyond the last."""
        return self.runs[0].point_at(self.runs[0].first - beside), self.runs[-1].point_at(self.runs[-1].last + beside)

    def slopes(self, low: float, high: float) -> SlopesTopWell:
        """Return slopes and level landings from floor to floor, the rest of the top tread (maybe none), and the well.

        Flights extend from edge to edge of the landings. The well has the outlines of all slopes. `low` and `high` are
        the heights of both floors [m].
        """
        heights, found = [low, *(height for height, _ in self.landings), high], []
        for i, run in enumerate(self.runs):
            start = run.start(low) if i == 0 else _extent(self.landings[i - 1][1], run.yaw)[1][0]
            end = run.end(high) if i == len(self.landings) else _extent(self.landings[i][1], run.yaw)[0][0]
            found.append(run.slope(start, end, heights[i], heights[i + 1]))
            if i < len(self.landings):
                (first, right), (last, left) = _extent(self.landings[i][1], run.yaw)
                foot = plane_matrix(run.yaw) @ [first, (left + right) / 2]
                found.append(Slope(foot, run.yaw, last - first, left - right, heights[i + 1], heights[i + 1]))
        rest = self.runs[-1].last - end
        top = [found[-1].part(found[-1].run, found[-1].run + rest)] if rest > MIN_TOP_LENGTH else []
        return found, top, [slope.outline for slope in found]

    @property
    def is_joined(self) -> bool:
        """True if flights meet their landings in the plan, within `MAX_LANDING_GAP`; heights are not compared."""
        gaps = [run.last - _extent(box, run.yaw)[0][0] for run, (_, box) in zip(self.runs, self.landings, strict=False)]
        gaps += [
            run.first - _extent(b, run.yaw)[1][0] for run, (_, b) in zip(self.runs[1:], self.landings, strict=True)
        ]
        return all(abs(gap) < MAX_LANDING_GAP for gap in gaps)


def _extent(corners: Float[np.ndarray, "4 2"], yaw: float) -> tuple[list[float], list[float]]:
    """Return the minimum and maximum (x, y) in a frame rotated by `yaw`."""
    local = corners @ plane_matrix(yaw)
    return local.min(axis=0).tolist(), local.max(axis=0).tolist()


@dataclass(frozen=True)
class CurvedFlight:
    """Treads around a vertical axis: height = `offset` + `rise` * angle, where angles [rad] grow uphill, by `sense`."""

    center: Float[np.ndarray, "2"]  # [m]
    inner: float  # [m], inner radius
    outer: float  # [m], outer radius
    sense: float  # 1 counter-clockwise, -1 clockwise
    first: float  # [rad], start of its treads
    last: float
    rise: float  # [m/rad]
    offset: float  # [m]

    @property
    def radius(self) -> float:
        """Radius of the middle line [m]."""
        return (self.inner + self.outer) / 2

    def point(self, angle: float, radius: float) -> Float[np.ndarray, "2"]:
        """Return the plan point at a radius [m] and an angle [rad] that grows uphill: `sense` times that about +z."""
        return self.center + radius * np.array([np.cos(self.sense * angle), np.sin(self.sense * angle)])

    def yaw(self, angle: float) -> float:
        """Return the uphill direction at an angle, about +z from +x [rad]."""
        return self.sense * (angle + np.pi / 2)

    def ends(self, beside: float) -> tuple[Float[np.ndarray, "2"], Float[np.ndarray, "2"]]:
        """Return plan points of the middle line, `beside` [m] before the first tread and beyond the last."""
        found = []
        for angle, way in ((self.first, -beside), (self.last, beside)):
            up = np.array([np.cos(self.yaw(angle)), np.sin(self.yaw(angle))])
            found.append(self.point(angle, self.radius) + way * up)
        return found[0], found[1]

    def slopes(self, low: float, high: float) -> SlopesTopWell:
        """Return slopes from floor to floor, the rest of the top tread, and the well, as `StraightFlights.slopes`.

        There are enough slopes for agents to step from one to the next. The well is one polygon: the sector from the
        centre to the outer radius.
        """
        before, landing = MAX_START_OFFSET / self.radius, MAX_END_OFFSET / self.radius
        start = float(np.clip((low - self.offset) / self.rise, self.first - before, self.first + before))
        end = float(np.clip((high - self.offset) / self.rise, self.last - landing, self.last))
        width = self.outer - self.inner
        bumps = (high - low) * max(width / 2 - AGENT_AXIS_DISTANCE, 0.0) / (self.radius * MAX_SLOPE_STEP)
        angles, step = np.linspace(
            start, end, int(np.ceil(max(bumps, (end - start) / MAX_SECTOR_ANGLE, 2))) + 1, retstep=True
        )
        grade = (high - low) / (end - start) / self.radius
        found = [self._slope(a + step / 2, step, low + (a - start) * self.radius * grade, grade) for a in angles[:-1]]
        found[0], found[-1] = self._cut(found[0], step, True), self._cut(found[-1], step, False)
        corners = [(end, self.inner), (end, self.outer), (self.last, self.outer), (self.last, self.inner)]
        top = [np.array([self.point(*c) for c in corners])] if (self.last - end) * self.radius > MIN_TOP_LENGTH else []
        arc = [self.point(a, self.outer / np.cos(step / 2)) for a in angles]
        return found, top, [np.array([self.center, *arc])]

    def _slope(self, middle: float, step: float, low: float, grade: float) -> Slope:
        """Return the slope of a sector of angle `step` [rad], out to its corners.

        `low` is the height at its start on the middle line [m], `middle` its central angle [rad], `grade` its rise per
        length in the plan.
        """
        yaw, half = self.yaw(middle), self.outer * np.tan(step / 2)
        height = low + self.radius * step / 2 * grade
        foot = self.point(middle, self.radius) - half * np.array([np.cos(yaw), np.sin(yaw)])
        return Slope(foot, yaw, 2 * half, self.outer - self.inner, height - half * grade, height + half * grade)

    def _cut(self, slope: Slope, step: float, begins: bool) -> Slope:
        """Cut the first slope (`begins`) or the last to begin or end on the middle line at the height of the floor.

        `step` is the angle of one slope [rad].
        """
        beyond = (self.outer - self.radius) * np.tan(step / 2) + self.radius * (np.tan(step / 2) - step / 2)
        foot = slope.foot + beyond * slope.up if begins else slope.foot
        low, high = (beyond, 0.0) if begins else (0.0, beyond)
        grade = slope.grade
        return Slope(
            foot, slope.yaw, slope.run - beyond, slope.width, slope.low + low * grade, slope.high - high * grade
        )


def tread_triangles(triangles: Float[np.ndarray, "t 3 3"]) -> Float[np.ndarray, "n 3 3"]:
    """Return the triangles that face up and are nearly level (`MIN_TREAD_NORMAL_Z`), on which an agent can stand."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return triangles[normal[:, 2] > MIN_TREAD_NORMAL_Z * np.maximum(np.linalg.norm(normal, axis=1), 1e-12)]


def find_stair_path(
    triangles: Float[np.ndarray, "t 3 3"], upward: Float[np.ndarray, "n 3 3"]
) -> StraightFlights | CurvedFlight | None:
    """Return the path up stairs, straight flights or else a curve; None if it is neither, too steep or without treads.

    Args:
        triangles: All triangles of the stairs; straight flights are along x or y [m].
        upward: Triangles on which an agent can stand.
    """
    if not len(upward):
        return None
    normal = np.cross(upward[:, 1] - upward[:, 0], upward[:, 2] - upward[:, 0])
    line, steps = _line(upward.mean(axis=1), np.linalg.norm(normal, axis=1)), _steps(upward)
    area = _areas(steps)
    steps = [step for step, size in zip(steps, area, strict=True) if size > MIN_TREAD_AREA_RATIO * np.median(area)]
    middle = np.array([step.mean(axis=0) for step in steps])
    if (
        line is not None
        and np.ptp(middle, axis=0)[1 - line[0]] < MAX_LATERAL_SPREAD * np.ptp(upward, axis=(0, 1))[1 - line[0]]
    ):
        return StraightFlights([StraightRun.fit(line, triangles.reshape(-1, 3)[:, :2])], [])
    if len(steps) < MIN_CURVE_TREADS or np.diff(middle[:, 2]).max() > MAX_STEP_RISE:
        return None
    return _flights(steps, middle) or _curve(steps, middle)


def _steps(treads: Float[np.ndarray, "n 3 3"]) -> list[Float[np.ndarray, "_ 3"]]:
    """Return sample points [m] of the triangles `treads`, one array per tread, lowest first.

    A new tread begins where sorted heights differ by more than `TREAD_HEIGHT_TOLERANCE`, wherever the points are in
    plan. Points farther than that below the highest one of their plan cell are left out.
    """
    points = sample_surface(treads, SAMPLE_SPACING)
    cell = _plan_cells(points)[1]
    highest = np.full(cell.max() + 1, -np.inf)
    np.maximum.at(highest, cell, points[:, 2])
    points = points[points[:, 2] > highest[cell] - TREAD_HEIGHT_TOLERANCE]
    points = points[np.argsort(points[:, 2], kind="stable")]
    return np.split(points, np.flatnonzero(np.diff(points[:, 2]) > TREAD_HEIGHT_TOLERANCE) + 1)


def _areas(steps: Sequence[Float[np.ndarray, "_ 3"]]) -> Int[np.ndarray, " s"]:
    """Return the area of each tread in the plan [cells]: the number of `SAMPLE_CELL` cells with a sample point."""
    return np.array([len(_plan_cells(step)[0]) for step in steps])


def _plan_cells(points: Float[np.ndarray, "n 3"]) -> tuple[Int[np.ndarray, " u"], Int[np.ndarray, " n"]]:
    """Return `unique_cells` of the `SAMPLE_CELL` grid in plan for points [m]."""
    return unique_cells(np.floor(points[:, :2] / SAMPLE_CELL).astype(np.int64))


def _flights(steps: Sequence[Float[np.ndarray, "_ 3"]], middle: Float[np.ndarray, "n 3"]) -> StraightFlights | None:
    """Return straight flights with landings; None if a flight has one tread or is not straight, or if they do not join.

    `steps` has the sample points of each tread in the order of `_steps`, `middle` their means [m].
    """
    area = _areas(steps)
    large = np.flatnonzero(area > MIN_LANDING_AREA_RATIO * np.median(area))
    between = [k for k in large.tolist() if 0 < k < len(steps) - 1]
    runs = []
    for first, last in zip([0, *(k + 1 for k in between)], [*between, len(steps)], strict=True):
        line = _line(middle[first:last], np.ones(last - first)) if last - first > 1 else None
        if line is None:
            return None
        runs.append(StraightRun.fit(line, np.concatenate(steps[first:last])[:, :2]))
    landings = []
    for k in between:
        (x0, y0), (x1, y1) = steps[k][:, :2].min(axis=0), steps[k][:, :2].max(axis=0)
        landings.append((float(middle[k, 2]), np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])))
    found = StraightFlights(runs, landings)
    return found if found.is_joined else None


def _curve(steps: Sequence[Float[np.ndarray, "_ 3"]], middle: Float[np.ndarray, "n 3"]) -> CurvedFlight | None:
    """Return a curve of less than a full turn, its circle by least squares (Kåsa, 1976); None if it does not fit.

    Arguments as in `_flights`.
    """
    x, y = middle[:, :2].T
    (a, b, _), *_ = np.linalg.lstsq(np.c_[2 * x, 2 * y, np.ones(len(x))], x * x + y * y, rcond=None)
    center = np.array([a, b])
    away = np.linalg.norm(middle[:, :2] - center, axis=1)
    turn = np.unwrap(np.arctan2(y - b, x - a))
    sense = float(np.sign(turn[-1] - turn[0]))
    angle = sense * turn
    reach = np.linalg.norm(np.concatenate(steps)[:, :2] - center, axis=1)
    outer = float(np.quantile(reach, 0.98))
    inner = max(float(np.quantile(reach, 0.02)), MIN_INNER_RADIUS_RATIO * outer)
    first, last = 1.5 * angle[0] - 0.5 * angle[1], 1.5 * angle[-1] - 0.5 * angle[-2]
    rise, offset = np.polyfit(angle, middle[:, 2], 1)
    strays = abs(away - away.mean()).max() > MAX_RADIUS_DEVIATION * away.mean()
    steep = 2 * rise / (inner + outer) > np.tan(np.deg2rad(MAX_INCLINATION))
    if strays or steep or np.diff(angle).min() < MIN_TREAD_ANGLE or last - first > MAX_CURVE_ANGLE:
        return None
    return CurvedFlight(center, inner, outer, sense, float(first), float(last), float(rise), float(offset))


def _line(middle: Float[np.ndarray, "n 3"], weight: Float[np.ndarray, " n"]) -> tuple[int, float, float] | None:
    """Fit height = rise * position + offset to weighted tread centres [m]; None if they are not in line or too steep.

    Returns:
        Axis of the position (0 or 1), rise and offset.
    """
    away = middle - np.average(middle, axis=0, weights=weight)
    spread = np.einsum("n,na,nb->ab", weight, away, away)
    with np.errstate(divide="ignore", invalid="ignore"):
        correlation = spread[:2, 2] / np.sqrt(np.diag(spread)[:2] * spread[2, 2])
    axis = int(np.nan_to_num(abs(correlation)).argmax())
    if not abs(correlation[axis]) >= MIN_CORRELATION:
        return None
    rise = float(spread[axis, 2] / spread[axis, axis])
    if abs(rise) > np.tan(np.deg2rad(MAX_INCLINATION)):
        return None
    mean = np.average(middle, axis=0, weights=weight)
    return axis, rise, float(mean[2] - rise * mean[axis])
