"""Portable objects of a house, and receptacles for them."""

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.rules.house_view import HouseView, Thing

TOPS = (0.25, 1.3)  # [m], minimum and maximum height of receptacles above the floor beneath
REST = 0.03  # [m], as for `Feature.ON`
# Receptacles: coarse categories of furniture with a top that is made to carry objects.
FURNITURE = (
    *("table", "desk", "stand", "tv_stand", "dresser", "dressing_table", "shoes_cabinet", "kitchen_cabinet", "sofa"),
    *("bed", "ottoman", "bench_chair", "chair", "shelving", "wardrobe_cabinet", "counter", "storage_bench"),
)


@dataclass(frozen=True)
class Portable:
    """An object that hands can pick up."""

    thing: Thing
    instance: int


def portable_things(view: HouseView, max_mass: float, max_size: float) -> list[Portable]:
    """Return the objects that hands can pick up from somewhere: light and small, with nothing on or in them.

    Args:
        view: The house.
        max_mass: Maximum mass [kg].
        max_size: Maximum extent [m].
    """
    physics = view.bank.physics
    below = {thing.word(Semantic.SUPPORTER) for thing in view.things} | {
        thing.word(Semantic.CONTAINER) for thing in view.things
    }
    found = []
    for thing in view.things:
        if thing.body < 0 or thing.object_id in below or float((thing.box[1] - thing.box[0]).max()) > max_size:
            continue
        instance = int(physics.body_instance[view.house, thing.body])
        light = float(physics.body_mass[view.house, thing.body]) <= max_mass
        if light and len(view.taken(instance)[0]):
            found.append(Portable(thing, instance))
    return found


def has_room(view: HouseView, thing: Thing, carried: Collection[int]) -> bool:
    """Return whether an object is a receptacle whose top is within reach. Portable objects are never receptacles.

    Args:
        view: The house.
        thing: The object.
        carried: Object ids of portable objects.
    """
    if thing.coarse not in FURNITURE or thing.object_id in carried or view.instance_of(thing) < 0:
        return False
    floors = view.graph.place[:, 2]
    floor = floors[floors <= thing.box[0, 2] + TOPS[0]].max(initial=-np.inf)
    return bool(TOPS[0] <= thing.box[1, 2] - floor <= TOPS[1])


def lies_on(thing: Thing, other: Thing) -> bool:
    """Return whether an object is on another one, by the rule of `Feature.ON`."""
    middle, low, high = thing.box.mean(axis=0), other.box[0], other.box[1]
    over = np.all((middle[:2] >= low[:2]) & (middle[:2] <= high[:2]))
    bottom = thing.box[0, 2]
    return bool(over and other.box.mean(axis=0)[2] <= bottom <= high[2] + REST)


def gap(thing: Thing, other: Thing) -> float:
    """Return the gap between the bounds of two objects [m]; 0 for an object and itself."""
    apart = np.maximum(thing.box[0] - other.box[1], other.box[0] - thing.box[1])
    return float(np.linalg.norm(np.maximum(apart, 0)))
