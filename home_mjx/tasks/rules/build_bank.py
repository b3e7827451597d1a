"""Task bank construction from the rows that task generators yield."""

import itertools
import logging
from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol, runtime_checkable

import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float, Int, UInt16

from home_mjx.bank.bank import HouseBank
from home_mjx.core.progress import plural, track
from home_mjx.errors import ConfigError
from home_mjx.schema.compiled import FIELD_UNIT, FIELD_UNREACHABLE
from home_mjx.tasks.base.state import Episodes
from home_mjx.tasks.rules.cell_graph import EndCells
from home_mjx.tasks.rules.declaration import columns_of, pack
from home_mjx.tasks.rules.enums import NO_WORD, Attribute, Feature, Purpose, TargetKind
from home_mjx.tasks.rules.front_ends import front_ends
from home_mjx.tasks.rules.house_view import HouseView, house_views
from home_mjx.tasks.rules.packing import pack_program, pack_sounds, pack_speech
from home_mjx.tasks.rules.program import Selector, TaskProgram, TaskStage, check_success
from home_mjx.tasks.rules.resolve import resolve_targets_on_host
from home_mjx.tasks.rules.task_bank import RowStart, TaskBank
from home_mjx.tasks.sounds.sound_events import SoundEvent

GOAL_TOLERANCE = 0.15  # [m] distance tolerance: agents move in steps and may miss the centre of a cell by this much
POINT_TOLERANCE = (
    0.125  # [m] the same for points: half a step of 0.25 m, so that 0.2 m suffices for any point of a cell
)

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class TaskRow:
    """One task of a house, as a generator yields it.

    Attributes:
        selectors: Descriptors of the objects, rooms, points or agents that the task refers to.
        stages: Stages with their conditions and transitions; an episode begins in the first one.
        goal: Descriptor whose distance from the start is the shortest-path length.
        tokens: Tokens of the instruction.
        sounds: Sounds of the task; none: the house's own source.
        start_pose: Start on the floor [m] and yaw [rad]; None: drawn at random.
        answer: Token of the correct answer to the row's question; -1 if it asks none.
        instructed_agents: Indices of the agents that receive the instruction; None: all.
        oracle: Tokens of the questions that agents may ask, each with the token of the reply.
        num_identifying_questions: Number of oracle questions, from the first, that suffice to identify the target.
        group: Key for a generator's `select_rows`, such as rows with the same question; None: ungrouped.
        paraphrases: Paraphrases of the instruction, as tokens.
        later_goals: Descriptors visited after the goal, in order; their legs are added to the shortest-path length.
    """

    selectors: Sequence[Selector]
    stages: Sequence[TaskStage]
    goal: int = 0
    tokens: Sequence[int] = field(default=())
    sounds: Sequence[SoundEvent] = field(default=())
    start_pose: tuple[Sequence[float], float] | None = None
    answer: int = NO_WORD
    instructed_agents: Sequence[int] | None = None
    oracle: Sequence[tuple[int, int]] = ()
    num_identifying_questions: int = 0
    group: Hashable = None
    paraphrases: Sequence[Sequence[int]] = ()
    later_goals: Sequence[int] = field(default=())


@runtime_checkable
class TaskGenerator(Protocol):
    """Task generator: yields the tasks of a house as rows."""

    @property
    def name(self) -> str:
        """Name of the task."""
        ...

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[TaskRow]:
        """Yield the tasks of one house in random order, all or endlessly: the caller takes as many as it needs.

        The caller waits for every row, so a generator must end where the house has no further one.
        """
        ...


@dataclass(frozen=True)
class FeasibleRow:
    """A feasible row of a house.

    Attributes:
        row: The row as its generator yielded it.
        house: Index of the house.
        task: Index of the generator.
        columns: Columns `start`, `yaw`, `length`, and `field` with one entry per descriptor.
    """

    row: TaskRow
    house: int
    task: int
    columns: dict[str, np.ndarray]


@runtime_checkable
class RowSelector(Protocol):
    """Generator that yields every task of each house and then selects among those of all houses."""

    def select_rows(self, drawn: list[FeasibleRow], num_tasks: int, random: np.random.Generator) -> list[FeasibleRow]:
        """Select the rows to keep, at most `num_tasks` per house; they may be modified copies."""
        ...


@runtime_checkable
class RowFilter(Protocol):
    """Generator that filters its rows by their descriptors, such as those of a training split."""

    def filter_rows(self, descriptors: Int[np.ndarray, "t d words"]) -> Bool[np.ndarray, " t"]:
        """Return a mask of the rows to keep; the columns of a descriptor are those of `Attribute`."""
        ...


def build_task_bank(
    bank: HouseBank,
    generators: Sequence[TaskGenerator],
    num_tasks: int,
    seed: int = 0,
    min_length: float = 1.0,
    max_length: float = np.inf,
    progress: bool | None = None,
) -> TaskBank:
    """Build a task bank with tasks of all houses.

    Args:
        bank: The houses.
        generators: Task generators.
        num_tasks: Maximum number of rows per house and generator. A generator that is `RowSelector` yields all its rows
            and then selects.
        seed: Seed of the random draws.
        min_length: Minimum shortest-path length from start to goal [m].
        max_length: Maximum shortest-path length from start to goal [m].
        progress: Show progress; None: by the rule of `home_mjx.core.progress`.

    Raises:
        ConfigError: The generators yield no row, no house has a feasible one, or the generators keep none.
    """
    drawn: list[FeasibleRow] = []
    generated = np.zeros(len(generators), int)  # number of rows that each one yielded
    fields = {}
    text = f"drawing tasks of {plural(bank.num_houses, 'house')}"
    for view in track(house_views(bank), text, "house", progress):
        random = np.random.default_rng([seed, view.house])
        rows = [
            (g, row)
            for g, generator in enumerate(generators)
            for row in _generate_rows(generator, view, random, num_tasks)
        ]
        found, fields[view.house] = _feasible_rows(bank, view, rows, random, (min_length, max_length))
        drawn += found
        generated += np.bincount([g for g, _ in rows], minlength=len(generators))
    names = tuple(generator.name for generator in generators)
    _check_generated(bank, names, generated, drawn, (min_length, max_length))
    kept = _select_rows(generators, drawn, num_tasks, np.random.default_rng([seed, bank.num_houses]))
    if len(kept) < len(drawn):
        kept, fields = _drop_unused_fields(kept, fields)
    columns = _filter_rows(generators, [_columns(one) for one in _interleave_houses(kept)])
    if not columns:
        hint = "Give more houses, or a larger `num_tasks`."
        raise ConfigError(f"none of the {len(drawn)} tasks of {', '.join(names)} is kept", hint=hint)
    return pack_task_bank(bank, columns, fields, names)


def _check_generated(
    bank: HouseBank,
    names: tuple[str, ...],
    generated: Int[np.ndarray, " g"],
    drawn: list[FeasibleRow],
    limits: tuple[float, float],
) -> None:
    """Raise `ConfigError` if no task is feasible; log the generators of a mix that add no task.

    `generated` has the number of rows that each generator yielded, `drawn` the feasible ones of all.
    """
    houses = f"{bank.num_houses} house{'s' * (bank.num_houses > 1)}"
    silent = [name for name, count in zip(names, generated, strict=True) if not count]
    if len(silent) == len(names):
        hint = "Check what `rows` looks for: these houses may have no such object or room. Give others, or more."
        raise ConfigError(f"{' and '.join(silent)} yields no row in any of {houses}", hint=hint)
    way = f"a shortest path of {limits[0]} m to {limits[1]} m"
    if not drawn:
        raise ConfigError(
            f"none of {generated.sum()} rows of {', '.join(names)} in {houses} has a goal within reach, and {way}",
            hint="Choose other path lengths, or other houses.",
        )
    lost = {names[task] for task in range(len(names)) if generated[task]} - {names[row.task] for row in drawn}
    for name in silent:
        log.warning("%s yields no row in any of %s: the mix has none of its tasks", name, houses)
    for name in sorted(lost):
        log.warning(
            "no row of %s in %s has a goal within reach, and %s: the mix has none of its tasks", name, houses, way
        )


def _generate_rows(generator: TaskGenerator, view: HouseView, random: np.random.Generator, most: int) -> list[TaskRow]:
    """Return the first `most` rows that a generator yields for a house; all rows of a `RowSelector`."""
    limit = None if isinstance(generator, RowSelector) else most
    return list(itertools.islice(generator.rows(view, random), limit))


def _select_rows(
    generators: Sequence[TaskGenerator], drawn: list[FeasibleRow], num_tasks: int, random: np.random.Generator
) -> list[FeasibleRow]:
    """Return the rows of generators that are not `RowSelector`, then those that the others select by `select_rows`."""
    kept = [one for one in drawn if not isinstance(generators[one.task], RowSelector)]
    for task, generator in enumerate(generators):
        if isinstance(generator, RowSelector):
            kept += generator.select_rows([one for one in drawn if one.task == task], num_tasks, random)
    return kept


def _filter_rows(generators: Sequence[TaskGenerator], columns: list[dict]) -> list[dict]:
    """Return the rows that their generator's `filter_rows` keeps, and all of generators that are not `RowFilter`."""
    kept = np.ones(len(columns), bool)
    tasks = np.array([column["task"] for column in columns], int)
    for task, generator in enumerate(generators):
        own = np.flatnonzero(tasks == task)
        if isinstance(generator, RowFilter) and len(own):
            kept[own] = generator.filter_rows(np.stack([columns[i]["descriptor"] for i in own.tolist()]))
    return [column for column, keep in zip(columns, kept.tolist(), strict=True) if keep]


def _drop_unused_fields(
    rows: list[FeasibleRow], fields: dict[int, np.ndarray]
) -> tuple[list[FeasibleRow], dict[int, np.ndarray]]:
    """Return rows grouped by house, and each house's fields (cells, fields) with only the columns that its rows use.

    The `field` entries of the rows are renumbered to match; -1 stays.
    """
    found, kept = [], {}
    for house, field_ in fields.items():
        own = [row for row in rows if row.house == house]
        used = np.unique([column for row in own for column in row.columns["field"].tolist() if column >= 0]).astype(int)
        place = np.full(field_.shape[1] + 1, -1, np.int16)  # index -1 selects the extra last entry, which stays -1
        place[used] = np.arange(len(used))
        kept[house] = field_[:, used]
        found += [replace(row, columns=row.columns | {"field": place[row.columns["field"]]}) for row in own]
    return found, kept


def _columns(one: FeasibleRow) -> dict:
    """Return all columns of a row by key, padded to their capacities."""
    row = one.row
    return (
        pack_program(row.selectors, row.stages)
        | pack_sounds(row.sounds, len(row.selectors))
        | pack_speech(row.answer, row.instructed_agents, row.oracle, row.num_identifying_questions)
        | pack(RowStart, {"house": one.house, "task": one.task, "tokens": row.tokens})
        | one.columns
    )


def _feasible_rows(
    bank: HouseBank,
    view: HouseView,
    rows: list[tuple[int, TaskRow]],
    random: np.random.Generator,
    limits: tuple[float, float],
) -> tuple[list[FeasibleRow], np.ndarray]:
    """Return the feasible rows of a house, and its distance fields (cells, fields), which their column `field` indexes.

    `rows` are pairs of generator index and row. `limits` are the minimum and maximum length [m] from a drawn start to
    the goal; they do not apply to given starts. `ConfigError` if a row cannot be packed, or never leads to SUCCESS.
    """
    columns = [pack_program(row.selectors, row.stages) for _, row in rows]
    for _, row in rows:
        check_success(row.stages)
    field_ = add_fields(bank, view, columns)
    nearest = field_[: len(view.graph.place)].min(axis=0, initial=FIELD_UNREACHABLE) * FIELD_UNIT
    found = []
    for (task, row), column in zip(rows, columns, strict=True):
        goal = column["field"][row.goal]
        if goal < 0 or not is_feasible(column, nearest):
            continue
        way = field_[: len(view.graph.place), goal]
        start = (
            _draw_start(view, way, random, limits)
            if row.start_pose is None
            else _prescribed_start(view, way, row.start_pose)
        )
        if start is not None:
            stops = [int(column["field"][d]) for d in (row.goal, *row.later_goals)]
            start["length"] += _sum_leg_lengths(field_[: len(view.graph.place)], stops)
            found.append(FeasibleRow(row, view.house, task, start | {"field": column["field"]}))
    return found, field_


def is_feasible(column: dict, nearest: Float[np.ndarray, " g"]) -> bool:
    """Return whether paths lead to all guides of a row's stages, agents excepted, and near enough for its conditions.

    Near enough: to `GOAL_TOLERANCE`, for points `POINT_TOLERANCE`, less than the maximum of every DISTANCE condition.

    Args:
        column: Columns of one row, with `field`.
        nearest: Minimum distance over the home cells to the target of each field [m].
    """
    field_, guide = column["field"], column["guide"]
    asked = column["feature"] == Feature.DISTANCE
    first = np.maximum(column["first"][asked], 0)
    kind = column["descriptor"][:, Attribute.KIND]
    led_to = guide[guide >= 0]
    leads = np.all((field_[led_to] >= 0) | (kind[led_to] == TargetKind.AGENT)) and np.all(field_[first] >= 0)
    tolerance = np.where(kind[first] == TargetKind.PLACE, POINT_TOLERANCE, GOAL_TOLERANCE)
    return bool(leads and np.all(nearest[field_[first]] + tolerance <= column["maximum"][asked]))


def add_fields(bank: HouseBank, view: HouseView, columns: list[dict]) -> UInt16[np.ndarray, "c g"]:
    """Compute the distance fields (cells, fields) of a house's descriptors; add their index `field` to `columns`.

    It changes `columns` (one dictionary per row) in place. Descriptors with the same end cells share a field. The index
    is -1 without end cells, and for kinds AGENT and NOTHING.
    """
    if not columns:
        return view.graph.compute_fields([])
    different, which = np.unique(np.stack([c["descriptor"] for c in columns]), axis=0, return_inverse=True)
    meanings = resolve_targets_on_host(bank, view.house, different)
    instance, room = np.asarray(meanings.instance), np.asarray(meanings.room)
    known: dict[bytes, int] = {}
    ends: list[EndCells] = []
    for at, column in enumerate(columns):
        column["field"] = columns_of(TaskProgram)["field"].empty()
        for d, kind in enumerate(column["descriptor"][:, Attribute.KIND].tolist()):
            if kind in (TargetKind.NOTHING, TargetKind.AGENT):
                continue
            use = view, column, d, instance[which[at]]
            end = front_ends(*use)
            if end is None:
                end = view.end_cells(
                    kind, instance[which[at], d], room[which[at], d], column["place"][d], *_approach_purpose(*use)
                )
            end = _keep_close_ends(column, d, end)
            key = end[0].tobytes() + end[1].tobytes()
            if len(end[0]) and key not in known:
                known[key] = len(ends)
                ends.append(end)
            column["field"][d] = known.get(key, -1)
    return view.graph.compute_fields(ends)


def _keep_close_ends(column: dict, d: int, ends: EndCells) -> EndCells:
    """Keep the end cells of descriptor `d` close enough for all its DISTANCE conditions; all cells, if none is.

    Close enough is `GOAL_TOLERANCE` less than the conditions' least maximum [m]. Otherwise a path could end at the
    nearest of several objects that is visible but not approachable closely enough.
    """
    cells, away = ends
    asked = (column["feature"] == Feature.DISTANCE) & (column["first"] == d)
    near = away + GOAL_TOLERANCE <= np.min(column["maximum"], where=asked, initial=np.inf)
    return (cells[near], away[near]) if near.any() else ends


def _approach_purpose(
    view: HouseView, column: dict, d: int, instance: Bool[np.ndarray, "d i"]
) -> tuple[Purpose, float]:
    """Return the purpose of going to descriptor `d`; and the maximum plan radius [m] of objects to put there, else 0.

    `instance` has the target instances of the row's descriptors.
    """
    feature, first, second = (column[name].tolist() for name in ("feature", "first", "second"))
    conditions = list(zip(feature, first, second, strict=True))
    put = [i for feature, i, j in conditions if feature == Feature.ON and j == d]
    if put:
        things = np.flatnonzero(instance[put].any(axis=0)).tolist()
        return Purpose.PUT, max((view.plan_radius(thing) for thing in things), default=0.0)
    about = {feature for feature, i, _ in conditions if i == d}
    if Feature.HELD in about:
        return Purpose.TAKE, 0.0
    return (Purpose.TOGGLE if Feature.SWITCHED_ON in about else Purpose.LOOK), 0.0


def _draw_start(
    view: HouseView, field_: np.ndarray, random: np.random.Generator, limits: tuple[float, float]
) -> dict | None:
    """Sample a home cell with a path to the goal within limits [m], inclusive, and away from door leaves; None if none.

    `field_` has the goal's distances from the home cells in `FIELD_UNIT`. Keys are `start`, `yaw` (uniform), `length`.
    """
    way = np.where(field_ == FIELD_UNREACHABLE, np.inf, field_ * FIELD_UNIT)
    fit = np.flatnonzero(np.isfinite(way) & (way >= limits[0]) & (way <= limits[1]) & ~view.graph.at_leaf)
    if not len(fit):
        return None
    cell = random.choice(fit)
    place = view.graph.place[cell].astype(np.float32)
    return {"start": place, "yaw": np.float32(random.uniform(-np.pi, np.pi)), "length": np.float32(way[cell])}


def _sum_leg_lengths(fields: UInt16[np.ndarray, "c g"], stops: Sequence[int]) -> np.float32:
    """Return the sum of path lengths from each of `stops` (columns of `fields`) to the next [m]; 0 for a single one.

    Each leg begins at the home cell with the least distance to its stop, the first of several.
    """
    ends = [int(np.argmin(fields[:, stop])) for stop in stops]
    return np.float32(sum(fields[a, stop] * FIELD_UNIT for a, stop in zip(ends[:-1], stops[1:], strict=True)))


def _prescribed_start(
    view: HouseView, way: UInt16[np.ndarray, " c"], pose: tuple[Sequence[float], float]
) -> dict | None:
    """Return `start`, `yaw`, `length` of a given pose; None if no path leads from it to the goal, or it is cut off.

    `way` has the goal's distances from the home cells in `FIELD_UNIT`; that of the cell nearest to the pose counts.
    """
    place, yaw = np.asarray(pose[0], np.float32), np.float32(pose[1])
    cell = np.argmin(np.linalg.norm(view.graph.place - place, axis=1))
    if way[cell] == FIELD_UNREACHABLE or view.graph.cut_off[cell]:
        return None
    return {"start": place, "yaw": yaw, "length": np.float32(way[cell] * FIELD_UNIT)}


def _interleave_houses(drawn: list[FeasibleRow]) -> list[FeasibleRow]:
    """Return the rows, first one of each house, then a second, ...: the first ones cover as many houses as possible.

    In each round houses are in ascending order; the rows of one keep theirs.
    """
    counts: dict[int, Iterator[int]] = {}
    turns = [next(counts.setdefault(row.house, itertools.count())) for row in drawn]
    return [drawn[i] for i in np.lexsort([[row.house for row in drawn], turns])]


def pack_task_bank(
    bank: HouseBank, rows: list[dict], fields: dict[int, UInt16[np.ndarray, "c g"]], names: tuple[str, ...]
) -> TaskBank:
    """Pack rows (columns by key) and distance fields (by house index) into a task bank with generators `names`.

    There must be a row, and a field array for each house of the rows. Cells of other houses are `FIELD_UNREACHABLE`.
    """
    arrays = {name: jnp.asarray(np.stack([row[name] for row in rows])) for name in rows[0]}
    count = max(1, *(f.shape[1] for f in fields.values()))  # at least one column, even if no row has a field
    whole = np.full((bank.navigation.field.shape[0], count), FIELD_UNREACHABLE, np.uint16)
    for house, field_ in fields.items():
        first = int(bank.navigation.first_cell[house])
        whole[first : first + len(field_), : field_.shape[1]] = field_
    own = {name: arrays.pop(name) for name in ("house", "start", "yaw")}
    episodes = Episodes(house=own["house"], start=own["start"], yaw=own["yaw"], columns=arrays)
    return TaskBank(rows=episodes, field=jnp.asarray(whole), names=names)
