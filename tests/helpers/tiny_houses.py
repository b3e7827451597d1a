"""Hand-made houses for the physics: a floor, a few static boxes, a few movable ones."""

from collections.abc import Sequence
from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np
from handmade import shoebox

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records import Physics
from home_mjx.schema.contact_materials import damping_ratio

NUM_COLLIDERS = 16
NUM_BODIES = 4
NUM_DOORS = 3  # of which the last slides in banks that have sliding doors
LOT = 50.0  # [m], half of an edge


@dataclass(frozen=True)
class Box:
    pos: tuple[float, float, float]
    size: tuple[float, float, float]  # half extents
    yaw: float = 0.0
    mass: float = 0.0
    roll: float = 0.0  # about x, before the yaw
    friction: float = 0.4
    restitution: float = 0.0

    @property
    def quat(self) -> np.ndarray:
        (cy, sy), (cr, sr) = ((np.cos(a / 2), np.sin(a / 2)) for a in (self.yaw, self.roll))
        return np.array([cy * cr, cy * sr, sy * sr, sy * cr])

    @property
    def inertia(self) -> np.ndarray:
        x, y, z = np.square(self.size)
        return self.mass / 3 * np.array([y + z, x + z, x + y])


@dataclass(frozen=True)
class Door:
    """A leaf that hangs at `pivot`, or slides, and reaches from there along `yaw`, from the floor up."""

    pivot: tuple[float, float]
    width: float = 0.8
    yaw: float = 0.0
    low: float = 0.0
    high: float = 1.5
    mass: float = 12.0
    height: float = 2.0
    slides: bool = False  # along itself, away from the pivot

    @property
    def axis(self) -> np.ndarray:
        return self.slides * np.array([np.cos(self.yaw), np.sin(self.yaw)])

    @property
    def origin(self) -> np.ndarray:
        """What its bank calls the pivot."""
        return self.pos[:2] if self.slides else np.array(self.pivot)

    @property
    def pos(self) -> np.ndarray:
        along = self.width / 2 * np.array([np.cos(self.yaw), np.sin(self.yaw)])
        return np.array([*(self.pivot + along), self.height / 2 + 0.01])

    @property
    def quat(self) -> np.ndarray:
        return np.array([np.cos(self.yaw / 2), 0, 0, np.sin(self.yaw / 2)])

    @property
    def size(self) -> np.ndarray:
        return np.array([self.width, 0.04, self.height]) / 2


@dataclass(frozen=True)
class TinyHouse:
    static: Sequence[Box] = ()
    movable: Sequence[Box] = ()
    doors: Sequence[Door] = ()
    ramp: Sequence[float] = (0, 0, 1, 0, -1, -1, 0, 0)  # a row of `Physics.ramp`
    ramp_collider: int = -1  # its row of `static`
    floor: float = 0.0

    @property
    def door_rows(self) -> list[int]:
        """Rows of the doors in a bank."""
        return [NUM_DOORS - 1 if door.slides else h for h, door in enumerate(self.doors)]


def _table(rows, num, fill, at=None):
    table = np.tile(np.asarray(fill, np.float32), (num, *[1] * np.ndim(fill)))
    if rows:
        table[np.arange(len(rows)) if at is None else at] = np.stack(rows)
    return table


def _doors(house: TinyHouse, slides: bool) -> dict[str, np.ndarray]:
    nothing, rows, valid = (0.0, 0.0, 0.0), house.door_rows, np.isin(np.arange(NUM_DOORS), house.door_rows)

    def table(values, fill):
        return _table(values, NUM_DOORS, fill, rows)

    axes = table([d.axis for d in house.doors], (0.0, 0.0))
    if slides and not valid[-1]:
        axes[-1] = 1, 0  # as in a bank, whose padding slides where its doors do
    return {
        "door_valid": valid,
        "door_instance": np.full(NUM_DOORS, -1, np.int32),
        "door_pivot": table([d.origin for d in house.doors], (0.0, 0.0)),
        "door_slide": axes,
        "door_closed": table([d.low for d in house.doors], 0.0),
        "door_fully_open": table([d.high for d in house.doors], 0.0),
        "door_low": table([d.low for d in house.doors], 0.0),
        "door_high": table([d.high for d in house.doors], 0.0),
        "door_pos": table([d.pos for d in house.doors], nothing),
        "door_quat": table([d.quat for d in house.doors], (0.0, 0.0, 0.0, 0.0)),
        "door_size": table([d.size for d in house.doors], nothing),
        "door_mass": table([d.mass for d in house.doors], 0.0),
        "tray_pos": np.zeros((int(slides), 0, 3), np.float32),
        "tray_size": np.zeros((int(slides), 0, 3), np.float32),
    }


def _physics(house: TinyHouse, num_bodies: int) -> dict[str, np.ndarray]:
    static, movable = house.static, house.movable
    nothing = (0.0, 0.0, 0.0)
    used = np.arange(num_bodies) < len(movable)
    return {
        "floor": np.float32(house.floor),
        "fence_rectangle": np.array([[-LOT, -LOT], [LOT, LOT]], np.float32),
        "collider_pos": _table([b.pos for b in static], NUM_COLLIDERS, (0.0, 0.0, -100.0)),
        "collider_quat": _table([b.quat for b in static], NUM_COLLIDERS, (1.0, 0.0, 0.0, 0.0)),
        "collider_size": _table([b.size for b in static], NUM_COLLIDERS, nothing),
        "collider_object": np.full(NUM_COLLIDERS, -1, np.int32),
        "body_valid": used,
        "body_instance": np.where(used, np.arange(num_bodies) + 1, -1).astype(np.int32),
        # Padding that would break the solver if it were ever used.
        "body_pos": _table([b.pos for b in movable], num_bodies, nothing),
        "body_quat": _table([b.quat for b in movable], num_bodies, (0.0, 0.0, 0.0, 0.0)),
        "body_size": _table([b.size for b in movable], num_bodies, nothing),
        "body_mass": _table([b.mass for b in movable], num_bodies, 0.0),
        "body_friction": _table([b.friction for b in movable], num_bodies, 0.0),
        "body_damping_ratio": _table([damping_ratio(b.restitution) for b in movable], num_bodies, 0.0),
        "body_inertia": _table([b.inertia for b in movable], num_bodies, nothing),
        "body_from_model": np.tile(np.eye(3, 4, dtype=np.float32), (num_bodies, 1, 1)),
        "arrangement_pose": np.zeros((0, num_bodies, 7), np.float32),
        "ramp": np.array([house.ramp], np.float32),
        "ramp_collider": np.array([house.ramp_collider], np.int32),
    }


def make_bank(houses: Sequence[TinyHouse], num_bodies: int = NUM_BODIES) -> HouseBank:
    """A bank with the physics of the given houses."""
    slides = any(door.slides for house in houses for door in house.doors)
    tables = [_physics(house, num_bodies) | _doors(house, slides) for house in houses]
    physics = Physics(**{name: jnp.asarray(np.stack([t[name] for t in tables])) for name in tables[0]})
    bank = HouseBank.from_compiled([shoebox()] * len(houses))  # as many, since indices are clipped to the bank's
    counts = {"num_bodies": num_bodies, "num_doors": NUM_DOORS, "num_slides": int(slides)}
    return bank.replace(physics=physics, spec=bank.spec.replace(**counts))
