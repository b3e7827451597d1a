"""Candidate poses of objects on furniture or floors of their rooms; most of them are not free."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.geometry.boxes import BoxSet, join
from home_mjx.geometry.rotations import yaw_matrix
from home_mjx.tasks.arrangements.furnished import Furnished

NUM_PLACES = 48  # candidates per object and arrangement
EDGE = 0.015  # [m], minimum distance from an object to the edge of its supporting surface
LOWEST, HIGHEST = 0.15, 1.4  # [m], range of heights of supporting surfaces above the floor


class Places(NamedTuple):
    """Candidate poses of k bodies, n each."""

    center: Float[np.ndarray, "k n 3"]  # [m]
    yaw: Float[np.ndarray, "k n"]  # [rad]
    usable: Bool[np.ndarray, "k n"]


def draw_places(house: Furnished, rng: np.random.Generator) -> Places:
    """Sample candidate poses in each object's room: on furniture for objects on furniture, otherwise on the floor.

    Supporting surfaces are tops of boxes, sampled in proportion to their area.
    """
    num = len(house.bodies)
    center = np.repeat(house.bodies.center[:, None], NUM_PLACES, axis=1)
    yaw = rng.uniform(-np.pi, np.pi, (num, NUM_PLACES))
    usable = np.zeros((num, NUM_PLACES), bool)
    stay = join([house.static, house.bodies[~house.drawn]])
    for body in np.flatnonzero(house.drawn).tolist():
        if house.lies[body]:
            center[body], usable[body] = _on_furniture(house, stay, body, yaw[body], rng)
        else:
            center[body], usable[body] = _on_floor(house, body, rng), True
    return Places(center, yaw, usable)


def _on_floor(house: Furnished, body: int, rng: np.random.Generator) -> Float[np.ndarray, "n 3"]:
    """Sample positions on the floor of the object's room, at its present height [m]."""
    room = int(house.room[body])
    cells = np.argwhere(house.grid[house.level_of(room)] == room)
    row, column = cells[rng.integers(len(cells), size=NUM_PLACES)].T
    plan = np.stack([column, row], axis=-1) + rng.uniform(size=(NUM_PLACES, 2))
    return np.c_[house.origin + plan * house.cell, np.full(NUM_PLACES, house.bodies.center[body, 2])]


def _on_furniture(
    house: Furnished, stay: BoxSet, body: int, yaw: Float[np.ndarray, " n"], rng: np.random.Generator
) -> tuple[Float[np.ndarray, "n 3"], Bool[np.ndarray, " n"]]:
    """Sample positions on tops of boxes in the object's room [m], and whether the top is large enough for each."""
    room, half = int(house.room[body]), house.bodies.half[body]
    level = house.level_of(room)
    high = stay.top - house.floor[level]
    tops = stay[(high > LOWEST) & (high < HIGHEST) & (stay.half[:, :2].min(axis=1) > half[:2].min())]
    tops = tops[house.room_at(tops.center[:, :2], level) == room]
    if not len(tops):
        return np.repeat(house.bodies.center[body : body + 1], NUM_PLACES, axis=0), np.zeros(NUM_PLACES, bool)
    area = tops.half[:, 0] * tops.half[:, 1]
    on = tops[rng.choice(len(tops), NUM_PLACES, p=area / area.sum())]
    cosine, sine = abs(np.cos(yaw - on.yaw)), abs(np.sin(yaw - on.yaw))
    extent = np.stack([cosine * half[0] + sine * half[1], sine * half[0] + cosine * half[1]], axis=-1)
    slack = on.half[:, :2] - extent - EDGE
    local = rng.uniform(-1, 1, (NUM_PLACES, 2)) * slack
    turn = np.array([yaw_matrix(y)[:2, :2] for y in on.yaw])
    plan = on.center[:, :2] + np.einsum("nij,nj->ni", turn, local)
    return np.c_[plan, on.top + half[2]], np.asarray((slack > 0).all(axis=1))
