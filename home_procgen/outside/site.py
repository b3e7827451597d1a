"""Plot of a home: position of the street, the garden and the neighbours."""

from dataclasses import dataclass

import numpy as np

from home_procgen.floor_plan.placed_model import FRONT_DIRECTIONS
from home_procgen.floor_plan.rooms import Rect
from home_procgen.plan.home import HomePlan

LAWN_WIDTH = 32.0  # [m], width around the home; the horizon is beyond
GARDEN_WIDTH_RANGE = (6.5, 10.0)  # [m], range from the home to the hedges
STREET_DISTANCE_RANGE = (8.0, 11.0)  # [m], range from the home to the street
STREET_WIDTH = 5.0  # [m], of the street
MIN_PLANT_DISTANCE = 2.1  # [m], of plants from the home; unreachable, because the compiler's fence is nearer
MAX_SPOT_ATTEMPTS = 12


@dataclass(frozen=True)
class PlotSide:
    """One side of a home.

    Attributes:
        direction: Outward unit direction (x, z).
        home_rect: The box around the home [m].
        distance_from_home: Distance of the street's edge or the hedge from the home [m].
    """

    direction: tuple[int, int]
    home_rect: Rect
    distance_from_home: float

    def coordinate_at(self, away: float) -> float:
        """Return the x, or z on sides towards z, at a distance outward from this side of the home [m]."""
        x, z = self.direction
        edge = (
            (self.home_rect.x1 if x > 0 else self.home_rect.x0)
            if x
            else (self.home_rect.z1 if z > 0 else self.home_rect.z0)
        )
        return edge + (x + z) * away

    def street_rect(self, lawn: Rect, wider: float) -> Rect:
        """Return the rectangle of a street along the side, widened by `wider` at both edges [m]."""
        p, q = sorted(
            (
                self.coordinate_at(self.distance_from_home - wider),
                self.coordinate_at(self.distance_from_home + STREET_WIDTH + wider),
            )
        )
        return Rect(p, lawn.z0, q, lawn.z1) if self.direction[0] else Rect(lawn.x0, p, lawn.x1, q)

    def garden_line(self, garden: Rect) -> Rect:
        """Return the line of the hedge along the garden's side, as a rectangle of zero width [m]."""
        at = self.coordinate_at(self.distance_from_home)
        return Rect(at, garden.z0, at, garden.z1) if self.direction[0] else Rect(garden.x0, at, garden.x1, at)

    def distance(self, point: tuple[float, float]) -> float:
        """Return the distance from a point (x, z) to the line of the hedge or the street's edge [m]."""
        return abs(self.coordinate_at(self.distance_from_home) - point[int(self.direction[0] == 0)])


@dataclass(frozen=True)
class Plot:
    """A plot.

    Attributes:
        rects: Rectangles of all rooms on all storeys [m].
        home_rect: The box around them [m].
        garden: Area inside the hedges [m].
        lawn: Area of the whole ground [m].
        sides: The four sides; the first is the street's.
    """

    rects: tuple[Rect, ...]
    home_rect: Rect
    garden: Rect
    lawn: Rect
    sides: tuple[PlotSide, ...]

    @classmethod
    def draw(cls, rng: np.random.Generator, plan: HomePlan) -> "Plot":
        """Draw a plot; the street is in front of the entrance."""
        rects = tuple(rect for level in plan.levels for room in level.rooms for rect in room.rects)
        corners = np.array(rects)
        home = Rect(*np.round([*corners[:, :2].min(0), *corners[:, 2:].max(0)], 6).tolist())
        (entrance,) = [o.object for o in plan.levels[0].openings if o.is_door and len(o.rooms) == 1]
        first = FRONT_DIRECTIONS.index(FRONT_DIRECTIONS[entrance.quarter])
        away, street = (round(float(rng.uniform(*range_)), 2) for range_ in (GARDEN_WIDTH_RANGE, STREET_DISTANCE_RANGE))
        ways = [FRONT_DIRECTIONS[(first + k) % 4] for k in range(4)]
        sides = tuple(PlotSide(way, home, street if k == 0 else away) for k, way in enumerate(ways))
        return cls(rects, home, _expand(home, away), _expand(home, LAWN_WIDTH), sides)

    @property
    def street(self) -> PlotSide:
        """The side of the home that faces the street."""
        return self.sides[0]

    def draw_plant_spot(self, rng: np.random.Generator, radius: float) -> tuple[float, float] | None:
        """Draw a point (x, z) in the garden for a plant of a radius [m]; None if none was found."""
        street = self.street.street_rect(self.lawn, 1.5)
        for _ in range(MAX_SPOT_ATTEMPTS):
            x, z = np.round(rng.uniform(self.garden[:2], self.garden[2:]), 3).tolist()
            edge = min(x - self.garden.x0, self.garden.x1 - x, z - self.garden.z0, self.garden.z1 - z)
            if (
                _distance(self.home_rect, x, z) > radius + MIN_PLANT_DISTANCE
                and _distance(street, x, z) > radius
                and edge > 0.5
            ):
                return x, z
        return None


def _expand(rect: Rect, by: float) -> Rect:
    return Rect(*np.round([rect.x0 - by, rect.z0 - by, rect.x1 + by, rect.z1 + by], 6).tolist())


def _distance(rect: Rect, x: float, z: float) -> float:
    return float(np.hypot(max(rect.x0 - x, 0, x - rect.x1), max(rect.z0 - z, 0, z - rect.z1)))
