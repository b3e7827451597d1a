"""Movable parts of furniture that a compiled house holds in their pose, as a list for users."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from home_mjx.core.progress.counts import plural
from home_mjx.datasets.furniture import attach_joints
from home_mjx.scene_compile.objects.fronts import keep_largest_fronts
from home_mjx.scene_compile.objects.leaves import MIN_DRAWER_OPENING, MIN_OPEN_ANGLE
from home_mjx.scene_compile.objects.placed_objects import leaf_joints, num_nodes
from home_mjx.schema.categories import FINE
from home_mjx.schema.compiled import CompiledHouse
from home_mjx.schema.house import House, Joint, Joints, Metadata
from home_mjx.schema.semantic import Semantic

JointsByObject = Mapping[int, tuple[Joint, ...]]  # by object id
FixedByObject = Mapping[int, tuple["FixedJoint", ...]]  # by object id


def object_joints(house: House, table: Joints) -> JointsByObject:
    """Return the joints of each object that has some, by object id: its own ones, else those of its model in `table`.

    Args:
        house: The house as read.
        table: `Dataset.joints`.
    """
    found, first = {}, 0
    for level in house.levels:
        for item in level.objects:
            joints = item.joints or tuple(table.get(item.model_key, ()))
            if joints:
                found[first + item.index] = joints
        first += num_nodes(level)
    return found


@dataclass(frozen=True)
class FixedJoint:
    """A joint that stays in its pose in a compiled house, or hardly opens, see `fixed_joints`."""

    joint: Joint
    is_blocked: bool = False  # it is a front that something stops


def fixed_joints(
    house: House, table: Joints, metadata: Metadata, compiled: CompiledHouse, max_fronts: int = 0
) -> FixedByObject:
    """Return the joints that do not move in a compiled house, by object id.

    These are joints without a row in its table of leaves, and fronts that hardly open there: hinged ones less than
    `MIN_OPEN_ANGLE`, drawers less than `MIN_DRAWER_OPENING`.

    Args:
        house: The house as read.
        table: `Dataset.joints`.
        metadata: The dataset's metadata.
        compiled: The house as compiled.
        max_fronts: `ArticulationOptions.max_fronts` with which it was compiled.
    """
    leaves = _leaf_joints(house, table, metadata, max_fronts)
    fixed = {}
    for object_id, joints in object_joints(house, table).items():
        moving = _moving_rows(compiled, object_id, leaves.get(object_id, ()))
        found = tuple(
            FixedJoint(joint, joint in moving)
            for joint in joints
            if joint not in moving or _is_blocked(compiled, moving[joint])
        )
        if found:
            fixed[object_id] = found
    return fixed


def _leaf_joints(house: House, table: Joints, metadata: Metadata, max_fronts: int) -> JointsByObject:
    """Return, by object id, the joints whose parts the compiler cuts out, in the order of their instances."""
    kept, _ = keep_largest_fronts(attach_joints(house, table) if max_fronts else house, metadata, max_fronts)
    return leaf_joints(kept, metadata)


def _moving_rows(compiled: CompiledHouse, object_id: int, joints: Sequence[Joint]) -> dict[Joint, int]:
    """Return the row in the table of leaves of each joint of an object; none if its leaves are shut for good."""
    rows = np.flatnonzero(compiled.instances.object_id[compiled.doors.instance] == object_id)
    order = rows[np.argsort(compiled.doors.instance[rows])].tolist()
    return dict(zip(joints, order, strict=True)) if order else {}


def _is_blocked(compiled: CompiledHouse, row: int) -> bool:
    """Return whether a leaf is a front of furniture that hardly opens, see `fixed_joints`."""
    doors = compiled.doors
    least = MIN_DRAWER_OPENING if doors.is_sliding[row] else MIN_OPEN_ANGLE
    return bool(doors.is_front[row] and doors.high[row] - doors.low[row] < least)


def object_category(house: CompiledHouse, object_id: int) -> str:
    """Return the fine category of an object; `ValueError` unless exactly one semantic row has this id."""
    (row,) = house.semantics[house.semantics[:, Semantic.OBJECT_ID] == object_id]
    return FINE[row[Semantic.FINE]]


def fixed_records(house: CompiledHouse, fixed: FixedByObject) -> list[dict[str, Any]]:
    """Return a record of each joint of `fixed_joints`.

    It has the object id, its category, the part, the kind, the range [rad] or [m], and whether something blocks it.
    """
    return [
        {
            "object": object_id,
            "category": object_category(house, object_id),
            "part": one.joint.part,
            "kind": one.joint.kind,
            "range": [one.joint.low, one.joint.high],
            "is_blocked": one.is_blocked,
        }
        for object_id, joints in fixed.items()
        for one in joints
    ]


def describe_fixed(house: CompiledHouse, fixed: FixedByObject) -> list[str]:
    """Return a line for each category with fixed joints, such as `fixed: range_oven with 2 doors, 5 knobs`.

    Fronts that something stops have lines of their own, which begin with `blocked`.
    """
    records = fixed_records(house, fixed)
    shut = _lines("fixed", [record for record in records if not record["is_blocked"]])
    return shut + _lines("blocked", [record for record in records if record["is_blocked"]])


def _lines(word: str, records: Iterable[Mapping[str, Any]]) -> list[str]:
    """Return a line for each category of records that counts their parts."""
    parts: dict[str, Counter[str]] = {}
    for record in records:
        parts.setdefault(record["category"], Counter())[record["part"].partition("_")[0]] += 1
    counts = {name: [plural(n, kind) for kind, n in sorted(found.items())] for name, found in sorted(parts.items())}
    return [f"{word}: {name} with {', '.join(words)}" for name, words in counts.items()]
