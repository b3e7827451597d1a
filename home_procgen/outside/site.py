"""Plot of a home: position of the street, the garden and the neighbours."""

from dataclasses import dataclass

import numpy as np

from home_procgen.floor_plan.placed import FACING
from home_procgen.floor_plan.rooms import Rect
from home_procgen.plan.home import HomePlan

LAWN = 32.0  # [m], width around the home; the horizon is beyond
GARDEN = (6.5, 10.0)  # [m], range from the home to the hedges
STREET = (8.0, 11.0)  # [m], range from the home to the street
WIDTH = 5.0  # [m], of the street
CLEAR = 2.1  # [m], minimum distance of plants from the home; unreachable, because the compiler's fence is nearer
TRIES = 12


@dataclass(frozen=True)
class Side:
    """One side of a home.

    Attributes:
        way: Outward unit direction (x, z).
        home: The box around the home [m].
        away: Distance of the street's edge or the hedge from the home [m].
    """

    way: tuple[int, int]
    home: Rect
    away: float

    def at(self, away: float) -> float:
        """Return the coordinate across the side at a distance from the home [m]."""
        x, z = self.way
        edge = (self.home.x1 if x > 0 else self.home.x0) if x else (self.home.z1 if z > 0 else self.home.z0)
        return edge + (x + z) * away

    def strip(self, lawn: Rect, wider: float) -> Rect:
        """Return the rectangle of a street along the side, widened by `wider` at both edges [m]."""
        p, q = sorted((self.at(self.away - wider), self.at(self.away + WIDTH + wider)))
        return Rect(p, lawn.z0, q, lawn.z1) if self.way[0] else Rect(lawn.x0, p, lawn.x1, q)

    def line(self, garden: Rect) -> Rect:
        """Return the line along the side of the garden, as a rectangle of zero width [m]."""
        at = self.at(self.away)
        return Rect(at, garden.z0, at, garden.z1) if self.way[0] else Rect(garden.x0, at, garden.x1, at)

    def distance(self, point: tuple[float, float]) -> float:
        """Return the distance from a point to the line [m]."""
        return abs(self.at(self.away) - point[int(self.way[0] == 0)])


@dataclass(frozen=True)
class Site:
    """A plot.

    Attributes:
        rects: Rectangles of all rooms on all storeys [m].
        home: The box around them [m].
        garden: Area inside the hedges [m].
        lawn: Area of the whole ground [m].
        sides: The four sides; the first is the street's.
    """

    rects: tuple[Rect, ...]
    home: Rect
    garden: Rect
    lawn: Rect
    sides: tuple[Side, ...]

    @classmethod
    def around(cls, rng: np.random.Generator, plan: HomePlan) -> "Site":
        """Draw a plot; the street is in front of the entrance."""
        rects = tuple(rect for level in plan.levels for room in level.rooms for rect in room.rects)
        corners = np.array(rects)
        home = Rect(*np.round([*corners[:, :2].min(0), *corners[:, 2:].max(0)], 6).tolist())
        (entrance,) = [o.placed for o in plan.levels[0].openings if o.is_door and len(o.rooms) == 1]
        first = FACING.index(FACING[entrance.quarter])
        away, street = (round(float(rng.uniform(*range_)), 2) for range_ in (GARDEN, STREET))
        ways = [FACING[(first + k) % 4] for k in range(4)]
        sides = tuple(Side(way, home, street if k == 0 else away) for k, way in enumerate(ways))
        return cls(rects, home, _grown(home, away), _grown(home, LAWN), sides)

    @property
    def street(self) -> Side:
        """The side of the street."""
        return self.sides[0]

    def spot(self, rng: np.random.Generator, radius: float) -> tuple[float, float] | None:
        """Draw a point (x, z) in the garden for a plant of a radius [m]; None if none was found."""
        street = self.street.strip(self.lawn, 1.5)
        for _ in range(TRIES):
            x, z = np.round(rng.uniform(self.garden[:2], self.garden[2:]), 3).tolist()
            edge = min(x - self.garden.x0, self.garden.x1 - x, z - self.garden.z0, self.garden.z1 - z)
            if _distance(self.home, x, z) > radius + CLEAR and _distance(street, x, z) > radius and edge > 0.5:
                return x, z
        return None


def _grown(rect: Rect, by: float) -> Rect:
    return Rect(*np.round([rect.x0 - by, rect.z0 - by, rect.x1 + by, rect.z1 + by], 6).tolist())


def _distance(rect: Rect, x: float, z: float) -> float:
    return float(np.hypot(max(rect.x0 - x, 0, x - rect.x1), max(rect.z0 - z, 0, z - rect.z1)))
