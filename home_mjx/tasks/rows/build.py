"""From what generators write to a task bank."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import jax.numpy as jnp
import numpy as np

from home_mjx.bank.bank import HouseBank
from home_mjx.errors import ConfigError
from home_mjx.schema.compiled import FIELD_FAR, FIELD_UNIT
from home_mjx.tasks.base.state import Episodes
from home_mjx.tasks.rows.house_view import HouseView, house_views
from home_mjx.tasks.rows.meaning import means_on_host
from home_mjx.tasks.rows.program import Meant, Stage, written
from home_mjx.tasks.rows.task_bank import TaskBank
from home_mjx.tasks.rows.words import NUM_DESCRIPTORS, NUM_TOKENS, Kind, Word


@dataclass(frozen=True)
class Row:
    """One task of a house as a generator writes it.

    Attributes:
        meant: What it speaks of.
        stages: What must hold, and what comes next.
        goal: Descriptor whose distance from the start is the length of the shortest path.
        tokens: Its instruction.
    """

    meant: Sequence[Meant]
    stages: Sequence[Stage]
    goal: int = 0
    tokens: Sequence[int] = field(default=())


class Generator(Protocol):
    """Writes tasks of a house."""

    @property
    def name(self) -> str:
        """Of the task."""
        ...

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[Row]:
        """Tasks of one house, in an order drawn at random, as many as it has; none if it has none."""
        ...


def build_task_bank(
    bank: HouseBank,
    generators: Sequence[Generator],
    num_tasks: int,
    seed: int = 0,
    least: float = 1.0,
    most: float = np.inf,
) -> TaskBank:
    """Draws tasks of all houses.

    Args:
        bank: The houses.
        generators: Of tasks.
        num_tasks: Rows per house and generator, where the house has so many.
        seed: Of the draw.
        least: Least shortest path from start to goal [m].
        most: Greatest one [m].

    Raises:
        ConfigError: No house has a task.
    """
    drawn: list[dict] = []
    fields = []
    for view in house_views(bank):
        random = np.random.default_rng([seed, view.house])
        rows = [(g, row) for g, generator in enumerate(generators) for row in _some(generator, view, random, num_tasks)]
        found, field_ = _of_house(bank, view, rows, random, (least, most))
        drawn += found
        fields.append(field_)
    if not drawn:
        names = ", ".join(generator.name for generator in generators)
        raise ConfigError(f"no house has a task of {names} with a way of {least} m to {most} m")
    return _packed(bank, drawn, fields, tuple(generator.name for generator in generators))


def _some(generator: Generator, view: HouseView, random: np.random.Generator, most: int) -> list[Row]:
    rows = generator.rows(view, random)
    return [row for row, _ in zip(rows, range(most), strict=False)]


def _of_house(
    bank: HouseBank,
    view: HouseView,
    rows: list[tuple[int, Row]],
    random: np.random.Generator,
    limits: tuple[float, float],
) -> tuple[list[dict], np.ndarray]:
    """Columns of a house's tasks that can be done, and the fields of what they mean."""
    columns = [written(row.meant, row.stages) for _, row in rows]
    if not columns:
        return [], view.graph.fields([])
    meanings = means_on_host(bank, view.house, np.stack([c["descriptor"] for c in columns]))
    known: dict[bytes, int] = {}
    ends: list = []
    for at, column in enumerate(columns):
        column["field"] = np.full(NUM_DESCRIPTORS, -1, np.int16)
        for d in range(NUM_DESCRIPTORS):
            kind = int(column["descriptor"][d, Word.KIND])
            if kind in (Kind.NOTHING, Kind.AGENT):
                continue
            end = view.ends(kind, meanings.instance[at, d], meanings.room[at, d], column["place"][d])
            key = end[0].tobytes() + end[1].tobytes()
            if len(end[0]) and key not in known:
                known[key] = len(ends)
                ends.append(end)
            column["field"][d] = known.get(key, -1)
    field_ = view.graph.fields(ends)
    found = []
    for (task, row), column in zip(rows, columns, strict=True):
        goal = column["field"][row.goal]
        start = None if goal < 0 else _start(view, field_[: len(view.graph.place), goal], random, limits)
        if start is not None:
            tokens = np.zeros(NUM_TOKENS, np.int16)
            tokens[: len(row.tokens)] = row.tokens
            found.append(column | start | {"house": view.house, "task": task, "tokens": tokens})
    return found, field_


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


def _packed(bank: HouseBank, drawn: list[dict], fields: list[np.ndarray], names: tuple[str, ...]) -> TaskBank:
    """All rows, in an order in which houses take turns, and the fields of all houses beside one another."""
    seen: dict[int, int] = {}
    turn = [seen.setdefault(row["house"], 0) or 0 for row in drawn]
    for at, row in enumerate(drawn):
        turn[at] = seen[row["house"]]
        seen[row["house"]] += 1
    order = np.lexsort([[row["house"] for row in drawn], turn])
    arrays = {name: jnp.asarray(np.stack([drawn[i][name] for i in order])) for name in drawn[0]}
    whole = np.full((bank.navigation.field.shape[0], max(f.shape[1] for f in fields)), FIELD_FAR, np.uint16)
    for house, field_ in enumerate(fields):
        first = int(bank.navigation.first_cell[house])
        whole[first : first + len(field_), : field_.shape[1]] = field_
    own = {name: arrays.pop(name) for name in ("house", "start", "yaw")}
    rows = Episodes(house=own["house"].astype(jnp.int32), start=own["start"], yaw=own["yaw"], columns=arrays)
    return TaskBank(rows=rows, field=jnp.asarray(whole), names=names)
