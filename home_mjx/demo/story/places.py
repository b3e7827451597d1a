"""Where in its house the story takes place, read from the bank: the script knows no coordinates of its own."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from home_mjx.bank.bank import HouseBank
from home_mjx.errors import ConfigError
from home_mjx.schema.categories import fine_index
from home_mjx.schema.semantic import Semantic

LOOKOUT = (0.35, 2.6)  # [m], from the head of the stairs: uphill, and to the side where the table is


@dataclass(frozen=True)
class Door:
    """The leaf that has to be opened."""

    wide: float  # [rad], its angle when open
    pivot: Float[np.ndarray, "2"]  # [m]
    arm: Float[np.ndarray, "2"]  # [m], from the hinge to the middle of the leaf at angle 0
    closed: float  # [rad]
    height: float  # [m], of its middle

    def middle(self, angle: float) -> Float[np.ndarray, "3"]:
        """Of the leaf at an angle [m]."""
        c, s = np.cos(angle), np.sin(angle)
        return np.array([*(self.pivot + np.array([[c, -s], [s, c]]) @ self.arm), self.height])

    def before(self, pos: Float[np.ndarray, "3"], away: float) -> Float[np.ndarray, "2"]:
        """A point before the middle of the closed leaf, on the side of `pos`; behind it if `away` is negative [m]."""
        middle = self.middle(self.closed)[:2]
        along = middle - self.pivot
        across = np.array([-along[1], along[0]]) / np.linalg.norm(along)
        return middle + away * across * np.sign((pos[:2] - middle) @ across)


@dataclass(frozen=True)
class Stairs:
    """The flight that has to be climbed."""

    foot: Float[np.ndarray, "2"]  # [m]
    head: Float[np.ndarray, "2"]  # [m]
    up: Float[np.ndarray, "2"]  # unit direction uphill
    upstairs: float  # [m], height of the floor at its head


@dataclass(frozen=True)
class Thing:
    """A movable body."""

    body: int  # row of the house's bodies
    half: Float[np.ndarray, "3"]  # [m], half extents


@dataclass(frozen=True)
class Places:
    """The places of a house that is alone in its bank."""

    door: Door
    stairs: Stairs
    lamp: Thing
    table: Thing
    lookout: Float[np.ndarray, "2"]  # [m], at the edge of the upper floor: from there one sees all of it

    @classmethod
    def of(cls, bank: HouseBank) -> "Places":
        """The only door, the only stairs, and the lamp and the table upstairs.

        Raises:
            ConfigError: The house has no such thing, or several.
        """
        physics = bank.physics
        ramp = np.asarray(physics.ramp[0, 0], float)
        middle, up, half, height = ramp[:2], ramp[2:4], ramp[4], ramp[6] + ramp[4] * ramp[7]
        door = Door(
            wide=float(physics.door_wide[0, 0]),
            pivot=np.asarray(physics.door_pivot[0, 0]),
            arm=np.asarray(physics.door_pos[0, 0, :2] - physics.door_pivot[0, 0]),
            closed=float(physics.door_closed[0, 0]),
            height=float(physics.door_pos[0, 0, 2]),
        )
        stairs = Stairs(middle - half * up, middle + half * up, up, float(height))
        lamp, table = _thing(bank, "table_lamp"), _thing(bank, "dining_table")
        edge = np.array([-up[1], up[0]])
        side = np.sign((np.asarray(physics.body_pos[0, table.body, :2]) - stairs.head) @ edge)
        return cls(door, stairs, lamp, table, stairs.head + LOOKOUT[0] * up + LOOKOUT[1] * side * edge)


def _thing(bank: HouseBank, fine: str) -> Thing:
    rows = np.asarray(bank.semantics)
    wanted = (rows[:, Semantic.FINE] == fine_index(fine)) & (rows[:, Semantic.LEVEL] == 1)
    found = np.unique(rows[wanted & (rows[:, Semantic.MOVABLE] >= 0), Semantic.MOVABLE])
    if len(found) != 1:
        raise ConfigError(f"the story needs one movable {fine} upstairs, the house has {len(found)}")
    return Thing(int(found[0]), np.asarray(bank.physics.body_size[0, found[0]]))
