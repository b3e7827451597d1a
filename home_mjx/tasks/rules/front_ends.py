"""Ends of paths to furniture with fronts, and to what is behind them (host side)."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Bool

from home_mjx.tasks.rules.cell_graph import EndCells
from home_mjx.tasks.rules.enums import Feature
from home_mjx.tasks.rules.house_view import HouseView

NO_CELLS: EndCells = (np.zeros(0, int), np.zeros(0))


def front_ends(view: HouseView, column: Mapping, d: int, instance: Bool[np.ndarray, "d i"]) -> EndCells | None:
    """Return end cells of paths to descriptor `d` of a row, if conditions are about its fronts or its compartment.

    To an object that begins in a compartment, and to the furniture around it, these are `HouseView.stored_cells`; to
    other furniture with a condition OPEN those from which a hand opens its first front. None: it is about neither.

    Args:
        view: The house.
        column: Columns of the row.
        d: Number of the descriptor.
        instance: Target instances of all descriptors.
    """
    names = ("feature", "first", "second", "minimum", "maximum")
    rows = list(zip(*(column[name].tolist() for name in names), strict=True))
    for feature, first, second, minimum, maximum in rows:
        if feature == Feature.CONTAINED and minimum == maximum and d in (first, second):
            return _stored_ends(view, np.flatnonzero(instance[first]), int(minimum))
    if any(feature == Feature.OPEN and first == d for feature, first, *_ in rows):
        return _open_ends(view, np.flatnonzero(instance[d]))
    return None


def _stored_ends(view: HouseView, things: np.ndarray, compartment: int) -> EndCells:
    """Return the cells from which the first movable of some instances can be taken out of a compartment."""
    count = view.bank.compartments.door.shape[1]
    bodies = [int(i) for i in things if view.bank.geometry.instance_body[view.house, i] >= 0]
    if not bodies or not 0 <= compartment < count or int(view.bank.compartments.door[view.house, compartment]) < 0:
        return NO_CELLS
    return view.stored_cells(bodies[0], compartment)


def _open_ends(view: HouseView, instances: np.ndarray) -> EndCells | None:
    """Return the cells from which a hand opens the first front of furniture; None if no instance has any."""
    ids = set(view.bank.geometry.instance_object[view.house, instances].tolist())
    things = [thing for thing in view.all_objects if thing.object_id in ids]
    leaves = [leaf for thing in things for leaf in view.fronts_of(thing)[:1]]
    return view.open_cells(leaves[0]) if leaves else None
