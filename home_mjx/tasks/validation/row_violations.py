"""Validation of rows as arrays (host side): the first invalid row, and the reason."""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import jax
import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.tasks.base.state import MAX_FLOOR_OFFSET, Episodes
from home_mjx.tasks.rules.enums import NUM_CONDITIONS, NUM_STAGES, SUCCESS, Attribute, Feature, TargetKind
from home_mjx.tasks.rules.program import FIRST_DESCRIPTOR_FEATURES, SECOND_DESCRIPTOR_FEATURES
from home_mjx.tasks.sounds.sound_events import VOICE_CLIP_NUMBER
from home_mjx.tasks.validation.column_ranges import DESCRIPTOR_COLUMN, Range
from home_mjx.tasks.validation.stored_targets import first_without_compartment

LENGTH_TOLERANCE = 0.1  # [m] tolerance of a file's path length, plus `RELATIVE_LENGTH_TOLERANCE`: a cell's edge
RELATIVE_LENGTH_TOLERANCE = 0.01
MAX_START_HEIGHT = 4.0  # [m] maximum height of a start above the highest floor
MAX_START_DEPTH = 1.0  # [m] maximum depth of a start below the lowest floor
SOUND_KINDS = (TargetKind.OBJECT, TargetKind.PLACE, TargetKind.AGENT)
COMPARTMENT_HINT = (
    "Give houses compiled with the `max_fronts` that the tasks were made for; `compartments_of` lists them."
)
NEIGHBOR_OFFSETS = [(row, column) for row in (-1, 0, 1) for column in (-1, 0, 1)]
Columns = Mapping[str, np.ndarray]


class Violation(NamedTuple):
    """Reason why a row is invalid.

    Attributes:
        row: Index of the row.
        field: Name of the invalid field.
        message: Description of the fault.
        hint: Advice on how to correct it.
    """

    row: int
    field: str
    message: str
    hint: str


def find_violation(
    rows: Episodes,
    bank: HouseBank,
    column_ranges: Mapping[str, Range],
    features: Float[np.ndarray, "features 2"],
    hints: Mapping[str, str],
    max_steps: float = np.inf,
) -> Violation | None:
    """Return the first fault of rows; None if all are valid.

    Args:
        rows: Any rows; columns that neither table lists are not checked.
        bank: Their houses.
        column_ranges: Ranges of the columns, see `column_ranges`.
        features: Ranges of the features, see `feature_ranges`.
        hints: Hints by name of a column, or of a feature in lower case.
        max_steps: Maximum number of steps of an episode.
    """
    columns = host_columns(rows)
    ranges = {name: column_ranges[name] for name in columns if name in column_ranges}
    ranges |= {"house": Range(0, bank.num_houses - 1, is_integer=True)}
    found = (
        _find_out_of_range(columns, ranges, hints)
        or _find_outside_grid(columns, bank)
        or _find_blocked_start(columns, bank)
    )
    if found is None and "require" in columns:
        found = next(_program_violations(columns, features, hints), None) or _find_too_long(columns, max_steps)
        found = found or _find_lost_compartment(columns, bank)
    return found


def host_columns(rows: Episodes) -> dict[str, np.ndarray]:
    """Return the columns of rows by name as NumPy arrays, those of descriptors also as `selectors.<attribute>`."""
    host = jax.tree.map(np.asarray, rows)
    columns = {"house": host.house, "start": host.start, "yaw": host.yaw, **host.columns}
    if "descriptor" in columns:
        columns |= {DESCRIPTOR_COLUMN.format(word.name.lower()): columns["descriptor"][..., word] for word in Attribute}
    return columns


def _first_true(wrong: Bool[np.ndarray, "t ..."]) -> tuple[int, ...] | None:
    """Return the index, one number per axis, of the first true element in row-major order; None without one."""
    return tuple(int(i) for i in np.unravel_index(np.argmax(wrong), wrong.shape)) if wrong.any() else None


def _find_out_of_range(columns: Columns, ranges: Mapping[str, Range], hints: Mapping[str, str]) -> Violation | None:
    """Return the first violation of the range of a column, in the order of `ranges`; None if all values are valid."""
    for name, allowed in ranges.items():
        at = _first_true(~allowed.contains(columns[name]))
        if at is not None:
            message = f"`{name}` must be {allowed}, got {columns[name][at]}"
            return Violation(at[0], name, message, hints.get(name, f"Give {allowed}."))
    return None


def _find_outside_grid(columns: Columns, bank: HouseBank) -> Violation | None:
    """Return the first start outside the grid of its house, whose edges are inside; None if none is.

    Outside is also more than `MAX_START_HEIGHT` above its highest floor, or `MAX_START_DEPTH` below its lowest.
    """
    navigation, house, start = bank.navigation, columns["house"], columns["start"]
    size = np.array(navigation.room.shape[:1:-1]) * bank.spec.cell
    low, floor = np.asarray(navigation.origin)[house], np.asarray(navigation.floor)[house]
    lowest, highest = (f(np.where(np.isfinite(floor), floor, floor[:, :1]), axis=1) for f in (np.min, np.max))
    plan, height = start[:, :2], start[:, 2]
    wrong = np.any((plan < low) | (plan > low + size), axis=1)
    at = _first_true(wrong | (height < lowest - MAX_START_DEPTH) | (height > highest + MAX_START_HEIGHT))
    if at is None:
        return None
    place = ", ".join(f"{x:g}" for x in start[at[0]])
    return Violation(at[0], "start", f"`start` ({place}) is not in its house", "Start on the floor of a room [m].")


def _find_blocked_start(columns: Columns, bank: HouseBank) -> Violation | None:
    """Return the violation of the first start that is not `is_standable`; None if there is none."""
    at = _first_true(~is_standable(bank, columns["house"], columns["start"]))
    return None if at is None else blocked_start(at[0], columns["start"][at[0]])


def blocked_start(row: int, start: Float[np.ndarray, "3"]) -> Violation:
    """Return the violation of a row whose start [m] no agent can stand at."""
    place = ", ".join(f"{x:g}" for x in start)
    return Violation(row, "start", f"no agent can stand at `start` ({place})", "Start on a free part of the floor [m].")


def is_same_length(given: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Return whether path lengths of a file are those of the shortest paths, up to the tolerances [m], inclusive.

    The relative one is of `length`, which is right.

    Example:
        >>> is_same_length(np.array([1.0, 7.5]), np.array([7.56, 7.56])).tolist()
        [False, True]
    """
    return np.abs(given - length) <= LENGTH_TOLERANCE + RELATIVE_LENGTH_TOLERANCE * length


def wrong_length(given: float, length: float) -> tuple[str, str]:
    """Return message and hint about a file's `given` path length [m], where `length` is right."""
    message = f"`length` is {given:g} m, but the shortest path from start to goal is {length:.2f} m"
    return message, f"Write {length:.2f}; or use the houses that the file was made for, compiled alike."


def _find_lost_compartment(columns: Columns, bank: HouseBank) -> Violation | None:
    """Return the first row with a condition about a compartment that its house lacks; None without one."""
    lost = first_without_compartment(columns, bank)
    return None if lost is None else Violation(lost[0], "stages", lost[1], COMPARTMENT_HINT)


def _find_too_long(columns: Columns, most_steps: float) -> Violation | None:
    """Return the first row that takes more than `most_steps` steps of TIME to succeed; None without one.

    Rows that cannot succeed in any number of steps are left out.
    """
    steps = min_steps(columns)
    at_once = dict(columns) | {"minimum": np.zeros_like(columns["minimum"])}
    late = steps > most_steps
    at = _first_true(late & np.isfinite(min_steps(at_once))) if late.any() else None
    if at is None:
        return None
    message = f"success takes at least {steps[at[0]]:g} steps of `time`, an episode has {most_steps:g}"
    return Violation(at[0], "require", message, "Set a longer episode_length, or require less `time` in the task.")


def _program_violations(
    columns: Columns, features: Float[np.ndarray, "features 2"], hints: Mapping[str, str]
) -> Iterator[Violation]:
    """Yield the first fault of each kind in conditions, descriptors without a place or agent, and sounds."""
    needs, bars = (_used_conditions(columns[name]) for name in ("require", "forbid"))
    yield from _unsatisfiable_conditions(columns, needs, features, hints)
    kind, feature = columns["selectors.kind"], columns["feature"]
    for name, group in (("first", FIRST_DESCRIPTOR_FEATURES), ("second", SECOND_DESCRIPTOR_FEATURES)):
        asked = np.isin(feature, group) & (needs | bars)
        at = _first_true(asked & (_kinds_of(kind, columns[name]) == TargetKind.NOTHING))
        if at is not None:
            what = Feature(int(feature[at])).name.lower()
            message = f"`{what}` tests descriptor {columns[name][at]}, which selects nothing"
            yield Violation(at[0], name, message, f"Set `{name}` to the index of an item of `selectors`.")
    nowhere = (kind == TargetKind.PLACE) & ~np.isfinite(columns["place"]).all(axis=-1)
    nobody = (kind == TargetKind.AGENT) & (columns["selectors.agent"] < 0)
    for wrong, name in ((nowhere, "place"), (nobody, "agent")):
        at = _first_true(wrong)
        if at is not None:
            yield Violation(at[0], "selectors", f"`selectors[{at[1]}]` has no `{name}`", f"Give its `{name}`.")
    yield from _sound_violations(columns, kind)


def _unsatisfiable_conditions(
    columns: Columns, used: Bool[np.ndarray, "t c"], features: np.ndarray, hints: Mapping[str, str]
) -> Iterator[Violation]:
    """Yield the first required condition that no value of its feature fulfils, if any."""
    feature, least, most = (columns[name] for name in ("feature", "minimum", "maximum"))
    at = _first_true(used & (np.maximum(least, features[feature, 0]) > np.minimum(most, features[feature, 1])))
    if at is not None:
        name, (low, high) = Feature(int(feature[at])).name.lower(), features[feature[at]]
        values = f"it is from {low:g} to {high:g}" if high > low else f"it is always {low:g}"
        message = f"`{name}` is never from {least[at]:g} to {most[at]:g}: {values} here"
        yield Violation(at[0], "require", message, hints.get(name, "Choose other limits `minimum` and `maximum`."))


def _sound_violations(columns: Columns, kind: np.ndarray) -> Iterator[Violation]:
    """Yield the first sound whose emitter cannot emit, the first without destination, the first voice of no agent."""
    emitter, towards, clip = (columns[f"sound_{name}"] for name in ("emitter", "destination", "clip"))
    mute = (emitter >= 0) & ~np.isin(_kinds_of(kind, emitter), SOUND_KINDS)
    lost = (emitter >= 0) & (towards >= 0) & (_kinds_of(kind, towards) == TargetKind.NOTHING)
    voiceless = (emitter >= 0) & (clip == VOICE_CLIP_NUMBER) & (_kinds_of(kind, emitter) != TargetKind.AGENT)
    for wrong, name, of in (
        (mute, "emitter", "an object, a place or an agent"),
        (lost, "destination", "a place or an object"),
    ):
        at = _first_true(wrong)
        if at is not None:
            number = columns[f"sound_{name}"][at]
            yield Violation(
                at[0], "sounds", f"`{name}` is descriptor {number}, which is not {of}", "Choose another descriptor."
            )
    at = _first_true(voiceless)
    if at is not None:
        hint = 'Only agents have a "voice": {"kind": "agent", "agent": 0}.'
        yield Violation(at[0], "sounds", f"the voice belongs to descriptor {emitter[at]}, which is not an agent", hint)


def _used_conditions(numbers: np.ndarray) -> Bool[np.ndarray, "t c"]:
    """Return which conditions have their bit in any mask of a row; negative masks have no bits."""
    asked = np.where(numbers < 0, 0, numbers).astype(int).reshape(len(numbers), -1)
    return (np.bitwise_or.reduce(asked, axis=1)[:, None] >> np.arange(NUM_CONDITIONS) & 1) == 1


def _kinds_of(kind: np.ndarray, number: np.ndarray) -> np.ndarray:
    """Return the kinds of the descriptors with these indices; NOTHING for -1."""
    found = np.take_along_axis(kind, np.maximum(number, 0).astype(int), axis=1)
    return np.where(number < 0, TargetKind.NOTHING, found)


def min_steps(columns: Columns) -> Float[np.ndarray, " t"]:
    """Return the minimum number of steps before a row can succeed: the least sum of `TIME` along its stages.

    Of several TIME conditions of a transition the longest counts. All other conditions are assumed to hold at once, and
    no forbidden one. inf if no sequence of transitions leads to success. `columns` has `require`, `next`,
    `feature` and `minimum` of the rows, see `TaskProgram`.

    Example:
        >>> columns = {"require": np.full((1, 6, 3), -1), "next": np.full((1, 6, 3), -1)}
        >>> columns |= {"feature": np.zeros((1, 8), int), "minimum": np.zeros((1, 8))}
        >>> columns["require"][0, 0, 0] = 0b10  # success needs the second condition
        >>> columns["feature"][0, 1], columns["minimum"][0, 1] = Feature.TIME, 80.0
        >>> min_steps(columns).tolist()
        [80.0]
    """
    needs, after = columns["require"], columns["next"].astype(int)
    taken = np.where(needs >= 0, 0.0, np.inf)  # minimum number of steps before each transition
    for condition in range(NUM_CONDITIONS):
        asked = (needs >= 0) & (needs.astype(int) >> condition & 1 == 1)
        time = columns["feature"][:, condition] == Feature.TIME
        wait = np.where(time, np.maximum(columns["minimum"][:, condition], 0.0), 0.0)
        taken = np.where(asked, np.maximum(taken, wait[:, None, None]), taken)
    arrived = np.full((len(needs), NUM_STAGES), np.inf)
    arrived[:, 0] = 0.0
    for _ in range(NUM_STAGES):
        left = arrived[:, :, None] + taken
        for stage in range(NUM_STAGES):
            there = np.where(after == stage, left, np.inf).min(axis=(1, 2))
            arrived[:, stage] = np.minimum(arrived[:, stage], there)
    return np.where(after == SUCCESS, arrived[:, :, None] + taken, np.inf).min(axis=(1, 2))


def is_standable(
    bank: HouseBank, house: Int[np.ndarray, " t"], start: Float[np.ndarray, "t 3"]
) -> Bool[np.ndarray, " t"]:
    """Return whether an agent can stand at each position and has paths to all goals from there.

    True in or next to a cell of the home region of house `house[i]` whose floor is within `MAX_FLOOR_OFFSET` in height.
    `start` are positions on the floor [m].
    """
    navigation = bank.navigation
    numbers, height = np.asarray(navigation.cell), np.asarray(navigation.height)
    levels, *size = numbers.shape[1:]
    first = np.asarray(navigation.first_cell)[house]
    end = first + np.asarray(navigation.num_cells)[house]
    plan = np.floor((start[:, :2] - np.asarray(navigation.origin)[house]) / bank.spec.cell)
    column, row = np.clip(plan, -2, np.array(size[::-1]) + 1).astype(int).T  # keeps integers in range
    found = np.zeros(len(house), bool)
    for level in range(levels):
        for away in NEIGHBOR_OFFSETS:
            at = row + away[0], column + away[1]
            inside = (at[0] >= 0) & (at[0] < size[0]) & (at[1] >= 0) & (at[1] < size[1])
            number = numbers[house, level, np.clip(at[0], 0, size[0] - 1), np.clip(at[1], 0, size[1] - 1)]
            near = np.abs(height[np.maximum(number, 0)] - start[:, 2]) < MAX_FLOOR_OFFSET
            found |= inside & (number >= first) & (number < end) & near
    return found
