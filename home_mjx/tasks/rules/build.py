"""Task bank construction from the rows that task generators yield."""

import itertools
from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol, runtime_checkable

import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float, Int, UInt16
from tqdm import tqdm

from home_mjx.bank.bank import HouseBank
from home_mjx.errors import ConfigError
from home_mjx.schema.compiled import FIELD_FAR, FIELD_UNIT
from home_mjx.tasks.base.state import Episodes
from home_mjx.tasks.communication.talk import NONE, written_talk
from home_mjx.tasks.rules.fields import Ends
from home_mjx.tasks.rules.house_view import HouseView, house_views
from home_mjx.tasks.rules.meaning import means_on_host
from home_mjx.tasks.rules.program import Meant, Stage, check_success, written
from home_mjx.tasks.rules.task_bank import TaskBank
from home_mjx.tasks.rules.words import NUM_DESCRIPTORS, NUM_TOKENS, Feature, Kind, Use, Word
from home_mjx.tasks.sounds.row import Sound, written_sounds

ROOM = 0.15  # [m] distance tolerance: agents move in steps and may miss the centre of a cell by this much


@dataclass(frozen=True)
class Row:
    """One task of a house, as a generator yields it.

    Attributes:
        meant: Descriptors of the objects, rooms, points or agents that the task refers to.
        stages: Stages with their conditions and transitions; an episode begins in the first one.
        goal: Descriptor whose distance from the start is the shortest-path length.
        tokens: Tokens of the instruction.
        sounds: Sounds of the task; none: the house's own source.
        pose: Start on the floor [m] and yaw [rad]; None: drawn at random.
        answer: Token of the correct answer to the row's question; -1 if it asks none.
        told: Indices of the agents that receive the instruction; None: all.
        oracle: Tokens of the questions that agents may ask, each with the token of the reply.
        ask: Number of oracle questions, from the first, that suffice to identify the target.
        group: Key for a generator's `choose`, such as rows with the same question; None: ungrouped.
        wordings: Paraphrases of the instruction, as tokens.
        then: Descriptors visited after the goal, in order; their legs are added to the shortest-path length.
    """

    meant: Sequence[Meant]
    stages: Sequence[Stage]
    goal: int = 0
    tokens: Sequence[int] = field(default=())
    sounds: Sequence[Sound] = field(default=())
    pose: tuple[Sequence[float], float] | None = None
    answer: int = NONE
    told: Sequence[int] | None = None
    oracle: Sequence[tuple[int, int]] = ()
    ask: int = 0
    group: Hashable = None
    wordings: Sequence[Sequence[int]] = ()
    then: Sequence[int] = field(default=())


@runtime_checkable
class Generator(Protocol):
    """Task generator: yields the tasks of a house as rows."""

    @property
    def name(self) -> str:
        """Name of the task."""
        ...

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[Row]:
        """Yield the tasks of one house, in random order and as many as it has."""
        ...


@dataclass(frozen=True)
class Drawn:
    """A feasible row of a house.

    Attributes:
        row: The row as its generator yielded it.
        house: Index of the house.
        task: Index of the generator.
        own: Columns `start`, `yaw`, `length`, and `field` with one entry per descriptor.
    """

    row: Row
    house: int
    task: int
    own: dict[str, np.ndarray]


@runtime_checkable
class Choosing(Protocol):
    """Generator that yields every task of each house and then selects among those of all houses."""

    def choose(self, drawn: list[Drawn], num_tasks: int, random: np.random.Generator) -> list[Drawn]:
        """Select the rows to keep, at most `num_tasks` per house; they may be modified copies."""
        ...


@runtime_checkable
class Keeping(Protocol):
    """Generator that filters its rows by their descriptors, such as those of a training split."""

    def keeps(self, descriptors: Int[np.ndarray, "t d words"]) -> Bool[np.ndarray, " t"]:
        """Return a mask of the rows to keep; the columns of a descriptor are those of `Word`."""
        ...


def build_task_bank(
    bank: HouseBank,
    generators: Sequence[Generator],
    num_tasks: int,
    seed: int = 0,
    least: float = 1.0,
    most: float = np.inf,
    progress: bool = False,
) -> TaskBank:
    """Build a task bank with tasks of all houses.

    Args:
        bank: The houses.
        generators: Task generators.
        num_tasks: Maximum number of rows per house and generator. A generator that is `Choosing` yields all its rows
            and then selects.
        seed: Seed of the random draws.
        least: Minimum shortest-path length from start to goal [m].
        most: Maximum shortest-path length from start to goal [m].
        progress: Show a progress bar.

    Raises:
        ConfigError: No house has a feasible task, or the generators keep none.
    """
    drawn: list[Drawn] = []
    fields = {}
    for view in tqdm(house_views(bank), desc="tasks", unit="house", disable=not progress):
        random = np.random.default_rng([seed, view.house])
        rows = [(g, row) for g, generator in enumerate(generators) for row in _some(generator, view, random, num_tasks)]
        found, fields[view.house] = _of_house(bank, view, rows, random, (least, most))
        drawn += found
    names = tuple(generator.name for generator in generators)
    if not drawn:
        hint = "Choose other path lengths, or other houses."
        raise ConfigError(
            f"no house has a task of {', '.join(names)} with a shortest path of {least} m to {most} m", hint=hint
        )
    kept = _chosen(generators, drawn, num_tasks, np.random.default_rng([seed, bank.num_houses]))
    if len(kept) < len(drawn):
        kept, fields = _used(kept, fields)
    columns = _kept(generators, [_columns(one) for one in _in_turns(kept)])
    if not columns:
        hint = "Give more houses, or a larger `num_tasks`."
        raise ConfigError(f"none of the {len(drawn)} tasks of {', '.join(names)} is kept", hint=hint)
    return packed(bank, columns, fields, names)


def _some(generator: Generator, view: HouseView, random: np.random.Generator, most: int) -> list[Row]:
    limit = None if isinstance(generator, Choosing) else most
    return list(itertools.islice(generator.rows(view, random), limit))


def _chosen(
    generators: Sequence[Generator], drawn: list[Drawn], num_tasks: int, random: np.random.Generator
) -> list[Drawn]:
    """Apply `choose` of the generators that are `Choosing`; keep the rows of all others."""
    kept = [one for one in drawn if not isinstance(generators[one.task], Choosing)]
    for task, generator in enumerate(generators):
        if isinstance(generator, Choosing):
            kept += generator.choose([one for one in drawn if one.task == task], num_tasks, random)
    return kept


def _kept(generators: Sequence[Generator], columns: list[dict]) -> list[dict]:
    """Apply `keeps` of the generators that are `Keeping`; keep the rows of all others."""
    kept = np.ones(len(columns), bool)
    tasks = np.array([column["task"] for column in columns], int)
    for task, generator in enumerate(generators):
        own = np.flatnonzero(tasks == task)
        if isinstance(generator, Keeping) and len(own):
            kept[own] = generator.keeps(np.stack([columns[i]["descriptor"] for i in own.tolist()]))
    return [column for column, keep in zip(columns, kept.tolist(), strict=True) if keep]


def _used(rows: list[Drawn], fields: dict[int, np.ndarray]) -> tuple[list[Drawn], dict[int, np.ndarray]]:
    """Drop distance fields that no row uses, and renumber the rows' `field` columns."""
    found, kept = [], {}
    for house, field_ in fields.items():
        own = [row for row in rows if row.house == house]
        used = np.unique([column for row in own for column in row.own["field"].tolist() if column >= 0]).astype(int)
        place = np.full(field_.shape[1] + 1, -1, np.int16)  # index -1 selects the extra last entry, which stays -1
        place[used] = np.arange(len(used))
        kept[house] = field_[:, used]
        found += [replace(row, own=row.own | {"field": place[row.own["field"]]}) for row in own]
    return found, kept


def _columns(one: Drawn) -> dict:
    row = one.row
    own = one.own | {"house": one.house, "task": one.task, "tokens": padded(row.tokens)}
    sounds = written_sounds(row.sounds, len(row.meant))
    return written(row.meant, row.stages) | sounds | own | written_talk(row.answer, row.told, row.oracle, row.ask)


def _of_house(
    bank: HouseBank,
    view: HouseView,
    rows: list[tuple[int, Row]],
    random: np.random.Generator,
    limits: tuple[float, float],
) -> tuple[list[Drawn], np.ndarray]:
    """Return the feasible rows of a house, and the distance fields of their descriptors."""
    columns = [written(row.meant, row.stages) for _, row in rows]
    for _, row in rows:
        check_success(row.stages)
    field_ = add_fields(bank, view, columns)
    nearest = field_[: len(view.graph.place)].min(axis=0, initial=FIELD_FAR) * FIELD_UNIT
    found = []
    for (task, row), column in zip(rows, columns, strict=True):
        goal = column["field"][row.goal]
        if goal < 0 or not can_be_done(column, nearest):
            continue
        way = field_[: len(view.graph.place), goal]
        start = _start(view, way, random, limits) if row.pose is None else _posed(view, way, row.pose)
        if start is not None:
            stops = [int(column["field"][d]) for d in (row.goal, *row.then)]
            start["length"] += _ways_between(field_[: len(view.graph.place)], stops)
            found.append(Drawn(row, view.house, task, start | {"field": column["field"]}))
    return found, field_


def can_be_done(column: dict, nearest: Float[np.ndarray, " g"]) -> bool:
    """Return whether all guide descriptors are reachable, as closely as the distance conditions require.

    Args:
        column: Columns of one row, with `field`.
        nearest: Minimum distance over the home cells to the target of each field [m].
    """
    field_, guide = column["field"], column["guide"]
    asked = column["feature"] == Feature.DISTANCE
    first = np.maximum(column["first"][asked], 0)
    kind = column["descriptor"][:, Word.KIND]
    led_to = guide[guide >= 0]
    leads = np.all((field_[led_to] >= 0) | (kind[led_to] == Kind.AGENT)) and np.all(field_[first] >= 0)
    return bool(leads and np.all(nearest[field_[first]] + ROOM <= column["most"][asked]))


def padded(tokens: Sequence[int]) -> Int[np.ndarray, " n"]:
    """Pad the tokens of an instruction with 0 to `NUM_TOKENS`.

    Raises:
        ConfigError: There are more than `NUM_TOKENS` tokens.
    """
    if len(tokens) > NUM_TOKENS:
        raise ConfigError(f"an instruction has at most {NUM_TOKENS} words, got {len(tokens)}")
    whole = np.zeros(NUM_TOKENS, np.int16)
    whole[: len(tokens)] = tokens
    return whole


def add_fields(bank: HouseBank, view: HouseView, columns: list[dict]) -> UInt16[np.ndarray, "c g"]:
    """Compute the distance fields of a house's descriptors, and add the column `field` to its rows.

    Descriptors with the same end cells share a field. -1 if a descriptor has no end cell, or is an agent or nothing.
    """
    if not columns:
        return view.graph.fields([])
    different, which = np.unique(np.stack([c["descriptor"] for c in columns]), axis=0, return_inverse=True)
    meanings = means_on_host(bank, view.house, different)
    instance, room = np.asarray(meanings.instance), np.asarray(meanings.room)
    known: dict[bytes, int] = {}
    ends: list[Ends] = []
    for at, column in enumerate(columns):
        column["field"] = np.full(NUM_DESCRIPTORS, -1, np.int16)
        for d, kind in enumerate(column["descriptor"][:, Word.KIND].tolist()):
            if kind in (Kind.NOTHING, Kind.AGENT):
                continue
            use = view, column, d, instance[which[at]]
            end = view.ends(kind, instance[which[at], d], room[which[at], d], column["place"][d], *_use(*use))
            end = _near_enough(column, d, end)
            key = end[0].tobytes() + end[1].tobytes()
            if len(end[0]) and key not in known:
                known[key] = len(ends)
                ends.append(end)
            column["field"][d] = known.get(key, -1)
    return view.graph.fields(ends)


def _near_enough(column: dict, d: int, ends: Ends) -> Ends:
    """Keep the end cells of descriptor `d` that meet its distance conditions; all, if none does.

    Otherwise a path could end at the nearest of several objects that is visible but not approachable closely enough.
    """
    cells, away = ends
    asked = (column["feature"] == Feature.DISTANCE) & (column["first"] == d)
    near = away + ROOM <= np.min(column["most"], where=asked, initial=np.inf)
    return (cells[near], away[near]) if near.any() else ends


def _use(view: HouseView, column: dict, d: int, instance: Bool[np.ndarray, "d i"]) -> tuple[Use, float]:
    """Return the purpose of going to descriptor `d`, and the plan radius of an object to be put there [m]."""
    feature, first, second = (column[name].tolist() for name in ("feature", "first", "second"))
    conditions = list(zip(feature, first, second, strict=True))
    put = [i for feature, i, j in conditions if feature == Feature.ON and j == d]
    if put:
        things = np.flatnonzero(instance[put].any(axis=0)).tolist()
        return Use.PUT, max((view.radius(thing) for thing in things), default=0.0)
    taken = any(feature == Feature.HELD and i == d for feature, i, _ in conditions)
    return (Use.TAKE if taken else Use.LOOK), 0.0


def _start(
    view: HouseView, field_: np.ndarray, random: np.random.Generator, limits: tuple[float, float]
) -> dict | None:
    """Draw a random start cell whose path length to the goal is within limits; None if there is no such cell."""
    way = np.where(field_ == FIELD_FAR, np.inf, field_ * FIELD_UNIT)
    fit = np.flatnonzero(np.isfinite(way) & (way >= limits[0]) & (way <= limits[1]) & ~view.graph.at_leaf)
    if not len(fit):
        return None
    cell = random.choice(fit)
    place = view.graph.place[cell].astype(np.float32)
    return {"start": place, "yaw": np.float32(random.uniform(-np.pi, np.pi)), "length": np.float32(way[cell])}


def _ways_between(fields: UInt16[np.ndarray, "c g"], stops: Sequence[int]) -> np.float32:
    """Return the sum of path lengths from the target of each field to that of the next [m]."""
    ends = [int(np.argmin(fields[:, stop])) for stop in stops]
    return np.float32(sum(fields[a, stop] * FIELD_UNIT for a, stop in zip(ends[:-1], stops[1:], strict=True)))


def _posed(view: HouseView, way: UInt16[np.ndarray, " c"], pose: tuple[Sequence[float], float]) -> dict | None:
    """Return the start that a row prescribes; None if no path leads from there to the goal."""
    place, yaw = np.asarray(pose[0], np.float32), np.float32(pose[1])
    cell = np.argmin(np.linalg.norm(view.graph.place - place, axis=1))
    if way[cell] == FIELD_FAR or view.graph.cut_off[cell]:
        return None
    return {"start": place, "yaw": yaw, "length": np.float32(way[cell] * FIELD_UNIT)}


def _in_turns(drawn: list[Drawn]) -> list[Drawn]:
    """Interleave the rows of different houses, so that the first rows cover as many houses as possible."""
    counts: dict[int, Iterator[int]] = {}
    turns = [next(counts.setdefault(row.house, itertools.count())) for row in drawn]
    return [drawn[i] for i in np.lexsort([[row.house for row in drawn], turns])]


def packed(
    bank: HouseBank, rows: list[dict], fields: dict[int, UInt16[np.ndarray, "c g"]], names: tuple[str, ...]
) -> TaskBank:
    """Pack the columns of rows and the distance fields of their houses into a task bank."""
    arrays = {name: jnp.asarray(np.stack([row[name] for row in rows])) for name in rows[0]}
    count = max(1, *(f.shape[1] for f in fields.values()))  # at least one column, even if no row has a field
    whole = np.full((bank.navigation.field.shape[0], count), FIELD_FAR, np.uint16)
    for house, field_ in fields.items():
        first = int(bank.navigation.first_cell[house])
        whole[first : first + len(field_), : field_.shape[1]] = field_
    own = {name: arrays.pop(name) for name in ("house", "start", "yaw")}
    episodes = Episodes(house=own["house"].astype(jnp.int32), start=own["start"], yaw=own["yaw"], columns=arrays)
    return TaskBank(rows=episodes, field=jnp.asarray(whole), names=names)
