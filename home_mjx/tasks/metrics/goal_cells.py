"""Goal of an episode as cells of a storey."""

from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.navigation.grid import cell_at_feet, cell_below
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.rules.enums import Attribute, TargetKind
from home_mjx.tasks.rules.features import current_boxes
from home_mjx.tasks.rules.row_task import RowState
from home_mjx.tasks.suite.point_nav import PointNavState


def goal_cells(snapshot: Snapshot, task: Any, level: Int[Array, ""]) -> Bool[Array, "rows columns"]:
    """Return a mask of the cells of storey `level` with the present stage's goal: its rooms, objects, point or agent.

    `task` is the task's state; tasks other than PointNav and those of rows have no goal cells, nor do stages without a
    guide.
    """
    bank, house = snapshot.bank, snapshot.house
    if isinstance(task, PointNavState):
        return _point_cell(snapshot, bank.navigation.goal[house, task.goal], level)
    if not isinstance(task, RowState):
        return jnp.zeros(bank.navigation.room.shape[2:], bool)
    guide = task.program.guide[jnp.maximum(task.stage, 0)]
    meant, words = jnp.maximum(guide, 0), task.program.descriptor[guide]
    room = bank.navigation.room[house, level]
    in_room = task.targets.room[meant][jnp.maximum(room, 0)] & (room >= 0)
    someone = snapshot.feet[jnp.clip(words[Attribute.AGENT], 0, snapshot.pose.yaw.shape[0] - 1)]
    point = jnp.where(words[Attribute.KIND] == TargetKind.AGENT, someone, task.program.place[meant])
    found = in_room | _point_cell(snapshot, point, level) | _object_cells(snapshot, task.targets.instance[meant], level)
    return found & (guide >= 0)


def _point_cell(snapshot: Snapshot, point: Float[Array, "3"], level: Int[Array, ""]) -> Bool[Array, "rows columns"]:
    """Return a mask of the cell of a point on a floor [m]; all False if it is not finite or on another storey.

    A point beyond the grid counts in the nearest cell.
    """
    bank = snapshot.bank
    known = jnp.all(jnp.isfinite(point))
    at = cell_at_feet(bank, snapshot.house, jnp.where(known, point, 0.0))
    none = jnp.zeros(bank.navigation.room.shape[2:], bool)
    return none.at[at[1], at[2]].set(known & (at[0] == level))


def _object_cells(snapshot: Snapshot, meant: Bool[Array, " i"], level: Int[Array, ""]) -> Bool[Array, "rows columns"]:
    """Return a mask of a level's cells under the present bounds of objects whose middle is above that level.

    Differences at the corners of bounds are summed along both axes.
    """
    bank, house, boxes = snapshot.bank, snapshot.house, current_boxes(snapshot)
    rows, columns = bank.navigation.room.shape[2:]
    boxes = jnp.where(meant[:, None, None], boxes, 0.0)
    own = jax.vmap(lambda box: cell_below(bank, house, box.mean(axis=0))[0])(boxes)
    weight = (meant & (own == level)).astype(jnp.int32)
    at = (boxes[:, :, :2] - bank.navigation.origin[house]) / jnp.float32(bank.spec.cell)
    limits = jnp.array([columns, rows])
    low = jnp.clip(jnp.floor(at[:, 0]).astype(jnp.int32), 0, limits)
    high = jnp.clip(jnp.ceil(at[:, 1]).astype(jnp.int32), 0, limits)
    corners = jnp.zeros((rows + 1, columns + 1), jnp.int32)
    for sign, x, y in ((1, low, low), (-1, high, low), (-1, low, high), (1, high, high)):
        corners = corners.at[y[:, 1], x[:, 0]].add(sign * weight)
    return (jnp.cumsum(jnp.cumsum(corners, axis=0), axis=1) > 0)[:rows, :columns]
