"""Validation of rows whose objects begin in compartments of furniture (host side)."""

from collections.abc import Mapping

import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.navigation.compartments import has_room
from home_mjx.tasks.rules.enums import Feature

Columns = Mapping[str, np.ndarray]


def first_without_compartment(columns: Columns, bank: HouseBank) -> tuple[int, str] | None:
    """Return the first row that names a compartment its house lacks, and a message; None if there is none.

    Args:
        columns: Columns of rows by name, with `house`, `feature`, `minimum` and `maximum`.
        bank: Their houses. If none has compartments, no condition CONTAINED is possible.
    """
    asked = columns["feature"] == Feature.CONTAINED
    if bank.compartments.is_empty:
        rows = np.flatnonzero(asked.any(axis=1))
        return (int(rows[0]), "`contained` needs compartments, and no house has any") if len(rows) else None
    number = columns["minimum"]
    lost = asked & (number == columns["maximum"]) & ~_exists(bank, columns["house"][:, None], number)
    if not lost.any():
        return None
    row, condition = (int(i) for i in np.unravel_index(np.argmax(lost), lost.shape))
    return row, f"the house has no compartment {number[row, condition]:g}"


def stored_target_fault(bank: HouseBank, house: int, columns: Columns, instance: Bool[np.ndarray, "d i"]) -> str | None:
    """Return why a row cannot begin with its objects in the compartments that its conditions name; None: it can.

    Args:
        bank: The houses.
        house: Index of the row's house.
        columns: Columns of the row by name.
        instance: Target instances of its descriptors.
    """
    for at in np.flatnonzero(columns["feature"] == Feature.CONTAINED).tolist():
        number = float(columns["minimum"][at])
        if number == float(columns["maximum"][at]) and number >= 0:
            pair = (instance[int(columns[name][at])] for name in ("first", "second"))
            fault = _condition_fault(bank, house, number, *pair)
            if fault is not None:
                return fault
    return None


def _condition_fault(
    bank: HouseBank, house: int, number: float, things: Bool[np.ndarray, " i"], holders: Bool[np.ndarray, " i"]
) -> str | None:
    """Return why the first movable of some instances cannot begin in a compartment of others; None: it can."""
    if bank.compartments.is_empty or not _exists(bank, np.array([house]), np.array([number])).all():
        return f"the house has no compartment {number:g}"
    slot, body_of = int(number), np.asarray(bank.geometry.instance_body[house])
    leaf = int(np.asarray(bank.physics.door_instance[house])[int(bank.compartments.door[house, slot])])
    if not holders[leaf]:
        return f"compartment {slot} is not in the furniture that `contained` names"
    bodies = body_of[np.flatnonzero(things & (body_of[: len(things)] >= 0))]
    if not len(bodies):
        return f"no movable object can be in compartment {slot}"
    fits = has_room(bank, jnp.int32(house), jnp.asarray(bank.physics.body_quat[house]))
    first = int(bodies.min())
    return None if bool(fits[slot, first]) else f"compartment {slot} is too small for its object"


def _exists(bank: HouseBank, house: Int[np.ndarray, "*t"], number: np.ndarray) -> np.ndarray:
    """Return which houses have compartments of these numbers; True for negative ones, which name none."""
    door = np.asarray(bank.compartments.door)
    known = (number == np.floor(number)) & (number < door.shape[1])
    at = np.where(known & (number >= 0), number, 0).astype(int)
    return (number < 0) | (known & (door[house, at] >= 0))
