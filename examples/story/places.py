"""Places of the story in its house, read from the bank, so that the script contains no coordinates."""

from dataclasses import dataclass

import jax
import numpy as np
from jaxtyping import Float

from home_mjx.bank.bank import HouseBank
from home_mjx.errors import ConfigError
from home_mjx.physics.base.doors import DoorLeaves
from home_mjx.schema.categories import fine_index
from home_mjx.schema.semantic import Semantic

LOOKOUT = (0.35, 2.6)  # [m], from the head of the stairs: uphill, and to the side where the table is


@dataclass(frozen=True)
class Door:
    """The leaf that has to be opened."""

    wide: float  # [rad], its angle when open
    middle: Float[np.ndarray, "3"]  # [m], of the closed leaf
    through: Float[np.ndarray, "2"]  # unit direction through the doorway, to the side where the stairs are


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
    sound: Float[np.ndarray, "3"]  # [m], just above the loudspeaker
    lookout: Float[np.ndarray, "2"]  # [m], at the edge of the upper floor: from there one sees all of it

    @classmethod
    def of(cls, bank: HouseBank) -> "Places":
        """The only door, the only stairs, the lamp and the table upstairs, the loudspeaker below.

        Raises:
            ConfigError: The house has no such thing, or several.
        """
        physics = bank.physics
        ramp = np.asarray(physics.ramp[0, 0], float)
        middle, up, half, height = ramp[:2], ramp[2:4], ramp[4], ramp[6] + ramp[4] * ramp[7]
        stairs = Stairs(middle - half * up, middle + half * up, up, float(height))
        door = _door(bank, stairs.foot)
        lamp, table = _thing(bank, "table_lamp", 1), _thing(bank, "dining_table", 1)
        speaker = _thing(bank, "loudspeaker", 0)
        sound = np.asarray(physics.body_pos[0, speaker.body]) + np.array([0.0, 0.0, speaker.half[2] + 0.1])
        edge = np.array([-up[1], up[0]])
        side = np.sign((np.asarray(physics.body_pos[0, table.body, :2]) - stairs.head) @ edge)
        lookout = stairs.head + LOOKOUT[0] * up + LOOKOUT[1] * side * edge
        return cls(door, stairs, lamp, table, sound, lookout)


def _door(bank: HouseBank, beyond: Float[np.ndarray, "2"]) -> Door:
    """The first leaf, to be walked through to where a point [m] is."""
    leaf = jax.tree.map(lambda x: x[0, 0], DoorLeaves.from_physics(bank.physics))
    middle = np.asarray(leaf.pose_at(bank.physics.door_closed[0, 0])[0])
    along = middle[:2] - np.asarray(leaf.pivot)
    across = np.array([-along[1], along[0]]) / np.linalg.norm(along)
    return Door(float(bank.physics.door_fully_open[0, 0]), middle, across * np.sign((beyond - middle[:2]) @ across))


def _thing(bank: HouseBank, fine: str, level: int) -> Thing:
    rows = np.asarray(bank.semantics)
    wanted = (rows[:, Semantic.FINE] == fine_index(fine)) & (rows[:, Semantic.LEVEL] == level)
    found = np.unique(rows[wanted & (rows[:, Semantic.MOVABLE] >= 0), Semantic.MOVABLE])
    if len(found) != 1:
        raise ConfigError(f"the story needs one movable {fine} on level {level}, there are {len(found)}")
    return Thing(int(found[0]), np.asarray(bank.physics.body_size[0, found[0]]))
