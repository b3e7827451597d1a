"""From what generators write to a task bank."""

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

ROOM = 0.15  # [m]: who walks in steps comes no nearer to the middle of a cell


@dataclass(frozen=True)
class Row:
    """One task of a house as a generator writes it.

    Attributes:
        meant: What it speaks of.
        stages: What must hold, and what comes next.
        goal: Descriptor whose distance from the start is the length of the shortest path.
        tokens: Its instruction.
        sounds: What sounds; none: the house's own source.
        pose: Start on the floor [m] and yaw [rad]; None: drawn at random.
        answer: Token of the right answer to its question; -1: there is none to answer.
        told: Numbers of the agents that are told what is to be done; None: all.
        oracle: Tokens of questions that agents may ask, and of what is replied.
        ask: How many of these, from the first, tell apart what is meant.
        group: For a generator's `choose`, such as rows that ask the same; None: none.
        wordings: Other instructions that say the same.
        then: Descriptors that are gone to after the goal, whose ways count to the length as well.
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
    """Writes tasks of a house."""

    @property
    def name(self) -> str:
        """Of the task."""
        ...

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[Row]:
        """Tasks of one house, in an order drawn at random, as many as it has; none if it has none."""
        ...


@dataclass(frozen=True)
class Drawn:
    """A row of a house that can be done.

    Attributes:
        row: As its generator has written it.
        house: Index of the house.
        task: Number of the generator.
        own: Columns: start, yaw, length, and the field of each descriptor.
    """

    row: Row
    house: int
    task: int
    own: dict[str, np.ndarray]


@runtime_checkable
class Choosing(Protocol):
    """A generator that writes all tasks that a house has, and then chooses among those of all houses."""

    def choose(self, drawn: list[Drawn], num_tasks: int, random: np.random.Generator) -> list[Drawn]:
        """Which rows to keep, at most `num_tasks` per house; they may be changed."""
        ...


@runtime_checkable
class Keeping(Protocol):
    """A generator that keeps some of its rows alone, by what they speak of, such as those to train with."""

    def keeps(self, descriptors: Int[np.ndarray, "t d words"]) -> Bool[np.ndarray, " t"]:
        """Which rows to keep. Columns of descriptors are those of `Word`."""
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
    """Draws tasks of all houses.

    Args:
        bank: The houses.
        generators: Of tasks.
        num_tasks: Rows per house and generator, where the house has so many. A generator that is `Choosing` writes all
            and then keeps some.
        seed: Of the draw.
        least: Least shortest path from start to goal [m].
        most: Greatest one [m].
        progress: Show a progress bar.

    Raises:
        ConfigError: No house has a task.
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
        hint = "Choose other lengths, or other houses."
        raise ConfigError(f"no house has a task of {', '.join(names)} with a way of {least} m to {most} m", hint=hint)
    kept = _chosen(generators, drawn, num_tasks, np.random.default_rng([seed, bank.num_houses]))
    if len(kept) < len(drawn):
        kept, fields = _used(kept, fields)
    columns = _kept(generators, [_columns(one) for one in _in_turns(kept)])
    if not columns:
        hint = "Give more houses, or a larger `num_tasks`."
        raise ConfigError(f"of {len(drawn)} tasks of {', '.join(names)} none is kept", hint=hint)
    return packed(bank, columns, fields, names)


def _some(generator: Generator, view: HouseView, random: np.random.Generator, most: int) -> list[Row]:
    limit = None if isinstance(generator, Choosing) else most
    return list(itertools.islice(generator.rows(view, random), limit))


def _chosen(
    generators: Sequence[Generator], drawn: list[Drawn], num_tasks: int, random: np.random.Generator
) -> list[Drawn]:
    """Those that generators keep which choose."""
    kept = [one for one in drawn if not isinstance(generators[one.task], Choosing)]
    for task, generator in enumerate(generators):
        if isinstance(generator, Choosing):
            kept += generator.choose([one for one in drawn if one.task == task], num_tasks, random)
    return kept


def _kept(generators: Sequence[Generator], columns: list[dict]) -> list[dict]:
    """The rows that their generators keep."""
    kept = np.ones(len(columns), bool)
    tasks = np.array([column["task"] for column in columns], int)
    for task, generator in enumerate(generators):
        own = np.flatnonzero(tasks == task)
        if isinstance(generator, Keeping) and len(own):
            kept[own] = generator.keeps(np.stack([columns[i]["descriptor"] for i in own.tolist()]))
    return [column for column, keep in zip(columns, kept.tolist(), strict=True) if keep]


def _used(rows: list[Drawn], fields: dict[int, np.ndarray]) -> tuple[list[Drawn], dict[int, np.ndarray]]:
    """Rows with the fields that they use alone."""
    found, kept = [], {}
    for house, field_ in fields.items():
        own = [row for row in rows if row.house == house]
        used = np.unique([column for row in own for column in row.own["field"].tolist() if column >= 0]).astype(int)
        place = np.full(field_.shape[1] + 1, -1, np.int16)  # the last one, which -1 means, stays -1
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
    """A house's tasks that can be done, and the fields of what they mean."""
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
    """Whether there is a way to all that stages lead to, and as near to it as conditions ask.

    Args:
        column: Of one task.
        nearest: How near one can come to what each field leads to [m].
    """
    field_, guide = column["field"], column["guide"]
    asked = column["feature"] == Feature.DISTANCE
    first = np.maximum(column["first"][asked], 0)
    kind = column["descriptor"][:, Word.KIND]
    led_to = guide[guide >= 0]
    leads = np.all((field_[led_to] >= 0) | (kind[led_to] == Kind.AGENT)) and np.all(field_[first] >= 0)
    return bool(leads and np.all(nearest[field_[first]] + ROOM <= column["most"][asked]))


def padded(tokens: Sequence[int]) -> Int[np.ndarray, " n"]:
    """Tokens of an instruction, filled up.

    Raises:
        ConfigError: There are too many.
    """
    if len(tokens) > NUM_TOKENS:
        raise ConfigError(f"an instruction has room for {NUM_TOKENS} words, got {len(tokens)}")
    whole = np.zeros(NUM_TOKENS, np.int16)
    whole[: len(tokens)] = tokens
    return whole


def add_fields(bank: HouseBank, view: HouseView, columns: list[dict]) -> UInt16[np.ndarray, "c g"]:
    """Distances of a house's cells to what its tasks' descriptors mean; adds `field` to their columns.

    What several descriptors mean alike has one field. What cannot be reached has none: -1.
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
    """Of the cells that ways to descriptor `d` end at those that are as near to it as conditions ask; all, if none is.

    Without that a way could end at the nearest of several things, which can be seen but not come near enough to.
    """
    cells, away = ends
    asked = (column["feature"] == Feature.DISTANCE) & (column["first"] == d)
    near = away + ROOM <= np.min(column["most"], where=asked, initial=np.inf)
    return (cells[near], away[near]) if near.any() else ends


def _use(view: HouseView, column: dict, d: int, instance: Bool[np.ndarray, "d i"]) -> tuple[Use, float]:
    """What agents go to what descriptor `d` means for; if to put something there, its radius [m]."""
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
    """A start at random among cells whose way to the goal is neither too short nor too long; None: there is none."""
    way = np.where(field_ == FIELD_FAR, np.inf, field_ * FIELD_UNIT)
    fit = np.flatnonzero(np.isfinite(way) & (way >= limits[0]) & (way <= limits[1]) & ~view.graph.at_leaf)
    if not len(fit):
        return None
    cell = random.choice(fit)
    place = view.graph.place[cell].astype(np.float32)
    return {"start": place, "yaw": np.float32(random.uniform(-np.pi, np.pi)), "length": np.float32(way[cell])}


def _ways_between(fields: UInt16[np.ndarray, "c g"], stops: Sequence[int]) -> np.float32:
    """Ways from where one field leads to, on to where the next one does [m]."""
    ends = [int(np.argmin(fields[:, stop])) for stop in stops]
    return np.float32(sum(fields[a, stop] * FIELD_UNIT for a, stop in zip(ends[:-1], stops[1:], strict=True)))


def _posed(view: HouseView, way: UInt16[np.ndarray, " c"], pose: tuple[Sequence[float], float]) -> dict | None:
    """A start that a row says; None: there is no way from there."""
    place, yaw = np.asarray(pose[0], np.float32), np.float32(pose[1])
    cell = np.argmin(np.linalg.norm(view.graph.place - place, axis=1))
    if way[cell] == FIELD_FAR or view.graph.cut_off[cell]:
        return None
    return {"start": place, "yaw": yaw, "length": np.float32(way[cell] * FIELD_UNIT)}


def _in_turns(drawn: list[Drawn]) -> list[Drawn]:
    """In an order in which houses take turns, so that the first rows are of as many houses as there are."""
    counts: dict[int, Iterator[int]] = {}
    turns = [next(counts.setdefault(row.house, itertools.count())) for row in drawn]
    return [drawn[i] for i in np.lexsort([[row.house for row in drawn], turns])]


def packed(
    bank: HouseBank, rows: list[dict], fields: dict[int, UInt16[np.ndarray, "c g"]], names: tuple[str, ...]
) -> TaskBank:
    """Columns of rows, and the fields of their houses, as one task bank."""
    arrays = {name: jnp.asarray(np.stack([row[name] for row in rows])) for name in rows[0]}
    count = max(1, *(f.shape[1] for f in fields.values()))  # rows may mean nothing that is anywhere
    whole = np.full((bank.navigation.field.shape[0], count), FIELD_FAR, np.uint16)
    for house, field_ in fields.items():
        first = int(bank.navigation.first_cell[house])
        whole[first : first + len(field_), : field_.shape[1]] = field_
    own = {name: arrays.pop(name) for name in ("house", "start", "yaw")}
    episodes = Episodes(house=own["house"].astype(jnp.int32), start=own["start"], yaw=own["yaw"], columns=arrays)
    return TaskBank(rows=episodes, field=jnp.asarray(whole), names=names)
