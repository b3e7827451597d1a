"""Portable objects of a house, and receptacles for them."""

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.rules.house_view import HouseObject, HouseView

RECEPTACLE_HEIGHTS = (0.25, 1.3)  # [m], minimum and maximum height of receptacles above the floor beneath
MAX_SUPPORT_GAP = 0.03  # [m], as for `Feature.ON`
# Receptacles: coarse categories of furniture with a top that is made to carry objects.
RECEPTACLES = (
    *("table", "desk", "stand", "tv_stand", "dresser", "dressing_table", "shoes_cabinet", "kitchen_cabinet", "sofa"),
    *("bed", "ottoman", "bench_chair", "chair", "shelving", "wardrobe_cabinet", "counter", "storage_bench"),
)


@dataclass(frozen=True)
class PortableObject:
    """An object that hands can pick up."""

    object: HouseObject
    instance: int


def find_portable_objects(view: HouseView, max_mass: float, max_size: float) -> list[PortableObject]:
    """Return the objects that hands can pick up from somewhere, with nothing on or in them.

    They weigh at most `max_mass` [kg], and extend at most `max_size` [m] along x, y and z.
    """
    physics = view.bank.physics
    below = {thing.semantic(Semantic.SUPPORTER) for thing in view.objects} | {
        thing.semantic(Semantic.CONTAINER) for thing in view.objects
    }
    found = []
    for thing in view.objects:
        if thing.body < 0 or thing.object_id in below or float((thing.box[1] - thing.box[0]).max()) > max_size:
            continue
        instance = int(physics.body_instance[view.house, thing.body])
        light = float(physics.body_mass[view.house, thing.body]) <= max_mass
        if light and len(view.take_cells(instance)[0]):
            found.append(PortableObject(thing, instance))
    return found


def is_receptacle(view: HouseView, thing: HouseObject, portable_ids: Collection[int]) -> bool:
    """Return whether an object is a receptacle, not portable itself, with its top within `RECEPTACLE_HEIGHTS` [m].

    Heights are above the floor beside it. `portable_ids` are object ids; objects of several instances are not
    receptacles.
    """
    if thing.coarse not in RECEPTACLES or thing.object_id in portable_ids or view.instance_of(thing) < 0:
        return False
    floor = view.graph.floor_beside(thing.box[0], thing.box[1])
    return bool(RECEPTACLE_HEIGHTS[0] <= thing.box[1, 2] - floor <= RECEPTACLE_HEIGHTS[1])


def is_on(thing: HouseObject, other: HouseObject) -> bool:
    """Return whether `thing` is on `other` by their initial bounds, with the rule of `Feature.ON`."""
    middle, low, high = thing.box.mean(axis=0), other.box[0], other.box[1]
    over = np.all((middle[:2] >= low[:2]) & (middle[:2] <= high[:2]))
    bottom = thing.box[0, 2]
    return bool(over and other.box.mean(axis=0)[2] <= bottom <= high[2] + MAX_SUPPORT_GAP)


def box_gap(thing: HouseObject, other: HouseObject) -> float:
    """Return the minimum distance between the initial bounds of two objects [m]; 0 if they touch or overlap."""
    apart = np.maximum(thing.box[0] - other.box[1], other.box[0] - thing.box[1])
    return float(np.linalg.norm(np.maximum(apart, 0)))
