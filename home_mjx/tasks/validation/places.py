"""Feasibility of user-written rows in their house (host side)."""

import numpy as np
from jaxtyping import UInt16

from home_mjx.bank.bank import HouseBank
from home_mjx.schema.compiled import FIELD_UNIT, FIELD_UNREACHABLE
from home_mjx.tasks.rules.build import is_feasible
from home_mjx.tasks.rules.house_view import HouseView
from home_mjx.tasks.rules.meaning import resolve_targets_on_host
from home_mjx.tasks.rules.words import Attribute, TargetKind
from home_mjx.tasks.validation.faults import Violation, blocked_start
from home_mjx.tasks.validation.starts import is_standable

RESOLVED_KINDS = (TargetKind.OBJECT, TargetKind.ROOM)


def find_infeasible(
    bank: HouseBank, view: HouseView, rows: list[dict[str, np.ndarray]], fields: UInt16[np.ndarray, "c g"]
) -> Violation | None:
    """Return the first infeasible row of a house; None if all are feasible.

    Feasible: the house has its targets, an agent can stand at its start, and paths lead close enough to its targets.

    Args:
        bank: The houses.
        view: The house.
        rows: Columns of its rows, with `field`.
        fields: Distances of its cells, as returned by `add_fields`.
    """
    descriptor = np.stack([row["descriptor"] for row in rows])
    means = resolve_targets_on_host(bank, view.house, descriptor)
    there = np.any(means.instance, axis=-1) | np.any(means.room, axis=-1)
    lost = np.isin(descriptor[..., Attribute.KIND], RESOLVED_KINDS) & ~there
    home = view.graph.place
    nearest = fields[: len(home)].min(axis=0, initial=FIELD_UNREACHABLE) * FIELD_UNIT
    stands = is_standable(bank, np.full(len(rows), view.house), np.stack([row["start"] for row in rows]))
    for number, row in enumerate(rows):
        if not stands[number]:
            return blocked_start(number, row["start"])
        if lost[number].any():
            name = f"selectors[{np.argmax(lost[number])}]"
            return Violation(
                number, name, "the house has no such object or room", "`HouseView.things` lists its objects."
            )
        if not is_feasible(row, nearest):
            message = "no path leads to a target of the task, or none close enough to it"
            return Violation(number, "selectors", message, "Choose another goal, or a greater `maximum` of `distance`.")
    return None
