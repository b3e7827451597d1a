"""Candidate poses of objects on furniture or floors of their rooms; most of them are not free."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.geometry.boxes import BoxSet, concat_boxes
from home_mjx.geometry.rotations import yaw_matrix
from home_mjx.tasks.arrangements.house_layout import HouseLayout

NUM_CANDIDATES = 48  # candidates per object and arrangement
MIN_EDGE_MARGIN = 0.015  # [m], minimum distance from an object to the edge of its supporting surface
MIN_SURFACE_HEIGHT, MAX_SURFACE_HEIGHT = 0.15, 1.4  # [m], range of heights of supporting surfaces above the floor


class PlacementCandidates(NamedTuple):
    """Candidate poses of k bodies, n each."""

    center: Float[np.ndarray, "k n 3"]  # [m]
    yaw: Float[np.ndarray, "k n"]  # [rad]
    usable: Bool[np.ndarray, "k n"]


def sample_candidates(house: HouseLayout, rng: np.random.Generator) -> PlacementCandidates:
    """Sample candidate poses in each object's room: on furniture for objects on furniture, otherwise on the floor.

    Supporting surfaces are tops of boxes, sampled in proportion to their area. Bodies not selected get none usable.
    """
    num = len(house.bodies)
    center = np.repeat(house.bodies.center[:, None], NUM_CANDIDATES, axis=1)
    yaw = rng.uniform(-np.pi, np.pi, (num, NUM_CANDIDATES))
    usable = np.zeros((num, NUM_CANDIDATES), bool)
    stay = concat_boxes([house.static, house.bodies[~house.is_selected]])
    for body in np.flatnonzero(house.is_selected).tolist():
        if house.on_furniture[body]:
            center[body], usable[body] = _on_furniture(house, stay, body, yaw[body], rng)
        else:
            center[body], usable[body] = _on_floor(house, body, rng), True
    return PlacementCandidates(center, yaw, usable)


def _on_floor(house: HouseLayout, body: int, rng: np.random.Generator) -> Float[np.ndarray, "n 3"]:
    """Sample centres of a body [m]: uniform over its room's cells on the room's lowest level, at its present height.

    Overlaps are not excluded.
    """
    room = int(house.room[body])
    cells = np.argwhere(house.room_grid[house.level_of(room)] == room)
    row, column = cells[rng.integers(len(cells), size=NUM_CANDIDATES)].T
    plan = np.stack([column, row], axis=-1) + rng.uniform(size=(NUM_CANDIDATES, 2))
    return np.c_[house.origin + plan * house.cell, np.full(NUM_CANDIDATES, house.bodies.center[body, 2])]


def _on_furniture(
    house: HouseLayout, stay: BoxSet, body: int, yaw: Float[np.ndarray, " n"], rng: np.random.Generator
) -> tuple[Float[np.ndarray, "n 3"], Bool[np.ndarray, " n"]]:
    """Sample centres of a body on tops of boxes `stay` in its room [m], one per heading `yaw`; return whether it fits.

    Tops are between the two surface heights and wider than the body's narrow side. It fits with `MIN_EDGE_MARGIN` to
    all edges. Without such a top, all are its present centre and False.
    """
    room, half = int(house.room[body]), house.bodies.half[body]
    level = house.level_of(room)
    high = stay.top - house.floor[level]
    tops = stay[
        (high > MIN_SURFACE_HEIGHT) & (high < MAX_SURFACE_HEIGHT) & (stay.half[:, :2].min(axis=1) > half[:2].min())
    ]
    tops = tops[house.room_at(tops.center[:, :2], level) == room]
    if not len(tops):
        return np.repeat(house.bodies.center[body : body + 1], NUM_CANDIDATES, axis=0), np.zeros(NUM_CANDIDATES, bool)
    area = tops.half[:, 0] * tops.half[:, 1]
    on = tops[rng.choice(len(tops), NUM_CANDIDATES, p=area / area.sum())]
    cosine, sine = abs(np.cos(yaw - on.yaw)), abs(np.sin(yaw - on.yaw))
    extent = np.stack([cosine * half[0] + sine * half[1], sine * half[0] + cosine * half[1]], axis=-1)
    slack = on.half[:, :2] - extent - MIN_EDGE_MARGIN
    local = rng.uniform(-1, 1, (NUM_CANDIDATES, 2)) * slack
    turn = np.array([yaw_matrix(y)[:2, :2] for y in on.yaw])
    plan = on.center[:, :2] + np.einsum("nij,nj->ni", turn, local)
    return np.c_[plan, on.top + half[2]], np.asarray((slack > 0).all(axis=1))
