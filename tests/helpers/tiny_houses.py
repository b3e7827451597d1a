"""Hand-made houses for the physics: a floor, a few static boxes, a few movable ones."""

from collections.abc import Sequence
from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np
from handmade import shoebox

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records import Physics
from home_mjx.scene_compile.materials.contact import damping_ratio

NUM_COLLIDERS = 16
NUM_BODIES = 4
NUM_DOORS = 2
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
    """A leaf that hangs at `pivot` and reaches from there along `yaw`, from the floor up."""

    pivot: tuple[float, float]
    width: float = 0.8
    yaw: float = 0.0
    low: float = 0.0
    high: float = 1.5
    mass: float = 12.0
    height: float = 2.0

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


def _table(rows, num, fill):
    table = np.tile(np.asarray(fill, np.float32), (num, *[1] * np.ndim(fill)))
    if rows:
        table[: len(rows)] = np.stack(rows)
    return table


def _physics(house: TinyHouse, num_bodies: int) -> dict[str, np.ndarray]:
    static, movable, doors = house.static, house.movable, house.doors
    nothing = (0.0, 0.0, 0.0)
    used = np.arange(num_bodies) < len(movable)
    return {
        "floor": np.float32(house.floor),
        "lot": np.array([[-LOT, -LOT], [LOT, LOT]], np.float32),
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
        "arrangement": np.zeros((0, num_bodies, 7), np.float32),
        "ramp": np.array([house.ramp], np.float32),
        "ramp_collider": np.array([house.ramp_collider], np.int32),
        "door_valid": np.arange(NUM_DOORS) < len(doors),
        "door_instance": np.full(NUM_DOORS, -1, np.int32),
        "door_pivot": _table([d.pivot for d in doors], NUM_DOORS, (0.0, 0.0)),
        "door_closed": _table([d.low for d in doors], NUM_DOORS, 0.0),
        "door_wide": _table([d.high for d in doors], NUM_DOORS, 0.0),
        "door_low": _table([d.low for d in doors], NUM_DOORS, 0.0),
        "door_high": _table([d.high for d in doors], NUM_DOORS, 0.0),
        "door_pos": _table([d.pos for d in doors], NUM_DOORS, nothing),
        "door_quat": _table([d.quat for d in doors], NUM_DOORS, (0.0, 0.0, 0.0, 0.0)),
        "door_size": _table([d.size for d in doors], NUM_DOORS, nothing),
        "door_mass": _table([d.mass for d in doors], NUM_DOORS, 0.0),
    }


def make_bank(houses: Sequence[TinyHouse], num_bodies: int = NUM_BODIES) -> HouseBank:
    """A bank with the physics of the given houses."""
    tables = [_physics(house, num_bodies) for house in houses]
    physics = Physics(**{name: jnp.asarray(np.stack([t[name] for t in tables])) for name in tables[0]})
    bank = HouseBank.from_compiled([shoebox()])
    return bank.replace(
        physics=physics, spec=bank.spec.replace(num_bodies=num_bodies, num_doors=NUM_DOORS, num_colliders=NUM_COLLIDERS)
    )
