"""Movable parts of furniture that a compiled house holds in their pose, as a list for users."""

from collections import Counter
from collections.abc import Mapping
from typing import Any

from home_mjx.core.progress.counts import plural
from home_mjx.scene_compile.objects.doors import moves_in_plan
from home_mjx.scene_compile.objects.placed_objects import num_nodes
from home_mjx.schema.categories import FINE
from home_mjx.schema.compiled import CompiledHouse
from home_mjx.schema.house import House, Joint, Joints
from home_mjx.schema.semantic import Semantic

JointsByObject = Mapping[int, tuple[Joint, ...]]  # by object id


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


def fixed_joints(house: House, table: Joints, compiled: CompiledHouse) -> JointsByObject:
    """Return the joints that do not move in a compiled house, by object id: those without a row in its table of leaves.

    Arguments are those of `object_joints`, and the house as compiled.
    """
    moving = Counter(compiled.instances.object_id[compiled.doors.instance].tolist())
    fixed = {}
    for object_id, joints in object_joints(house, table).items():
        if not moving[object_id]:
            fixed[object_id] = joints
        elif moving[object_id] < len(joints):
            fixed[object_id] = tuple(joint for joint in joints if not moves_in_plan(joint))
    return fixed


def object_category(house: CompiledHouse, object_id: int) -> str:
    """Return the fine category of an object; `ValueError` unless exactly one semantic row has this id."""
    (row,) = house.semantics[house.semantics[:, Semantic.OBJECT_ID] == object_id]
    return FINE[row[Semantic.FINE]]


def fixed_records(house: CompiledHouse, fixed: JointsByObject) -> list[dict[str, Any]]:
    """Return a record of each joint of `fixed_joints`: object id, category, part, kind and range [rad] or [m]."""
    return [
        {
            "object": object_id,
            "category": object_category(house, object_id),
            "part": joint.part,
            "kind": joint.kind,
            "range": [joint.low, joint.high],
        }
        for object_id, joints in fixed.items()
        for joint in joints
    ]


def describe_fixed(house: CompiledHouse, fixed: JointsByObject) -> list[str]:
    """Return a line for each category with fixed joints, such as `fixed: range_oven with 2 doors, 5 knobs`."""
    parts: dict[str, Counter[str]] = {}
    for record in fixed_records(house, fixed):
        parts.setdefault(record["category"], Counter())[record["part"].partition("_")[0]] += 1
    counts = {name: [plural(n, kind) for kind, n in sorted(found.items())] for name, found in sorted(parts.items())}
    return [f"fixed: {name} with {', '.join(words)}" for name, words in counts.items()]
