"""Record of what can be switched on and off in every house: lamps and appliances."""

import functools

import numpy as np
from jaxtyping import Array, Int

from home_mjx.bank.records.owners import HouseOwner
from home_mjx.core.pytree import Pytree, array
from home_mjx.schema.categories import FINE
from home_mjx.schema.compiled import ARCHITECTURE, CompiledHouse
from home_mjx.schema.semantic import Semantic

# Kinds of switchable things, and the fine categories of those that are not recognized by a light of their own.
SWITCH_CATEGORIES: dict[str, tuple[str, ...]] = {
    "lamp": (),
    "television": ("television",),
    "radio": ("loudspeaker", "stereo_set", "gramophone"),
    "water": ("sink", "kitchen_sink", "kitchen_sink_with_dishwasher", "bathtub", "shower", "shower_ceiling"),
    "kettle": ("kettle", "coffee_kettle"),
    "fan": ("ceiling_fan", "pedestal_fan"),
}
SWITCH_KINDS = tuple(SWITCH_CATEGORIES)


def switch_kinds(house: CompiledHouse) -> Int[np.ndarray, " i"]:
    """Return the index into `SWITCH_KINDS` of each instance of a house; -1: it cannot be switched.

    Instances that carry a light other than daylight are lamps, whatever their category.
    """
    fine = house.semantics[house.instances.semantic, Semantic.FINE]
    kinds = np.where(fine >= 0, _kind_of_fine()[fine], -1)
    lights = house.lights
    kinds[lights.instance[~lights.daylight]] = SWITCH_KINDS.index("lamp")
    kinds[ARCHITECTURE] = -1  # panels of rooms without a lamp have no model to point at
    return kinds


@functools.cache
def _kind_of_fine() -> Int[np.ndarray, " fine"]:
    """Return the index into `SWITCH_KINDS` of each fine category; -1 none."""
    kinds = np.full(len(FINE), -1, np.int32)
    for kind, names in enumerate(SWITCH_CATEGORIES.values()):
        kinds[[FINE.index(name) for name in names]] = kind
    return kinds


def count_switches(house: CompiledHouse) -> int:
    """Count the things of a house that can be switched."""
    return int((switch_kinds(house) >= 0).sum())


def switch_instances(at: HouseOwner) -> Int[np.ndarray, " s"]:
    """Return the instances that can be switched, ascending."""
    return np.flatnonzero(switch_kinds(at.house) >= 0).astype(np.int32)


def kinds_of_switches(at: HouseOwner) -> Int[np.ndarray, " s"]:
    """Return the index into `SWITCH_KINDS` of each of `switch_instances`."""
    return switch_kinds(at.house)[switch_instances(at)]


def switches_of_lights(at: HouseOwner) -> Int[np.ndarray, " l"]:
    """Return the row, among `switch_instances`, of the lamp that carries each light; -1: it is always on."""
    lights, instances = at.house.lights, switch_instances(at)
    row = np.full(len(at.house.instances.model), -1, np.int32)
    row[instances] = np.arange(len(instances), dtype=np.int32)
    return np.where(lights.daylight, -1, row[lights.instance])


class Switches(Pytree):
    """Things that can be switched on and off, one row each; their states are in `World.switch_on`."""

    instance: Int[Array, "h switches"] = array("-1 padding", source=switch_instances, fill=-1)
    kind: Int[Array, "h switches"] = array("index into SWITCH_KINDS; -1 padding", source=kinds_of_switches, fill=-1)
    of_light: Int[Array, "h lights"] = array(
        "row of the lamp that carries a light; -1: always on, and padding", source=switches_of_lights, fill=-1
    )
