"""Validation of rows as arrays: the first invalid row, and the reason."""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import jax
import numpy as np
from jaxtyping import Bool, Float

from home_mjx.bank.bank import HouseBank
from home_mjx.tasks.base.state import Episodes
from home_mjx.tasks.rules.program import OF_ONE, OF_TWO
from home_mjx.tasks.rules.words import NUM_CONDITIONS, Feature, Kind, Word
from home_mjx.tasks.sounds.row import VOICED
from home_mjx.tasks.validation.starts import can_stand
from home_mjx.tasks.validation.table import MEANT, Range
from home_mjx.tasks.validation.waiting import least_steps

STOREY = 4.0  # [m] maximum height of a start above the highest floor
BENEATH = 1.0  # [m] maximum depth of a start below the lowest floor
SOUNDING = (Kind.OBJECT, Kind.PLACE, Kind.AGENT)
Columns = Mapping[str, np.ndarray]


class Fault(NamedTuple):
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


def first_fault(
    rows: Episodes,
    bank: HouseBank,
    limits: Mapping[str, Range],
    features: Float[np.ndarray, "features 2"],
    hints: Mapping[str, str],
    most_steps: float = np.inf,
) -> Fault | None:
    """Return the first fault of rows; None if all are valid.

    Args:
        rows: Any rows; columns that neither table lists are not checked.
        bank: Their houses.
        limits: Ranges of the columns, see `limits`.
        features: Ranges of the features, see `feature_limits`.
        hints: Hints by name of a column, or of a feature in lower case.
        most_steps: Maximum number of steps of an episode.
    """
    columns = numbers_of(rows)
    ranges = {name: limits[name] for name in columns if name in limits}
    ranges |= {"house": Range(0, bank.num_houses - 1, whole=True)}
    found = _out_of_range(columns, ranges, hints) or _outside(columns, bank) or _stuck(columns, bank)
    if found is None and "needs" in columns:
        found = next(_of_programs(columns, features, hints), None) or _too_late(columns, most_steps)
    return found


def numbers_of(rows: Episodes) -> dict[str, np.ndarray]:
    """Return the columns of rows by name as NumPy arrays, those of descriptors also by word."""
    host = jax.tree.map(np.asarray, rows)
    columns = {"house": host.house, "start": host.start, "yaw": host.yaw, **host.columns}
    if "descriptor" in columns:
        columns |= {MEANT.format(word.name.lower()): columns["descriptor"][..., word] for word in Word}
    return columns


def _first(wrong: Bool[np.ndarray, "t ..."]) -> tuple[int, ...] | None:
    """Return the index of the first true element; None if there is none."""
    return tuple(int(i) for i in np.unravel_index(np.argmax(wrong), wrong.shape)) if wrong.any() else None


def _out_of_range(columns: Columns, ranges: Mapping[str, Range], hints: Mapping[str, str]) -> Fault | None:
    for name, allowed in ranges.items():
        at = _first(~allowed.holds(columns[name]))
        if at is not None:
            message = f"`{name}` must be {allowed}, got {columns[name][at]}"
            return Fault(at[0], name, message, hints.get(name, f"Give {allowed}."))
    return None


def _outside(columns: Columns, bank: HouseBank) -> Fault | None:
    """Find a start outside the grid of its house, or too far above or below its floors."""
    navigation, house, start = bank.navigation, columns["house"], columns["start"]
    size = np.array(navigation.room.shape[:1:-1]) * bank.spec.cell
    low, floor = np.asarray(navigation.origin)[house], np.asarray(navigation.floor)[house]
    lowest, highest = (f(np.where(np.isfinite(floor), floor, floor[:, :1]), axis=1) for f in (np.min, np.max))
    plan, height = start[:, :2], start[:, 2]
    wrong = np.any((plan < low) | (plan > low + size), axis=1)
    at = _first(wrong | (height < lowest - BENEATH) | (height > highest + STOREY))
    if at is None:
        return None
    place = ", ".join(f"{x:g}" for x in start[at[0]])
    return Fault(at[0], "start", f"`start` ({place}) is not in its house", "Start on the floor of a room [m].")


def _stuck(columns: Columns, bank: HouseBank) -> Fault | None:
    at = _first(~can_stand(bank, columns["house"], columns["start"]))
    return None if at is None else no_room(at[0], columns["start"][at[0]])


def no_room(row: int, start: Float[np.ndarray, "3"]) -> Fault:
    """Return the fault of a row that starts where no agent can stand."""
    place = ", ".join(f"{x:g}" for x in start)
    return Fault(row, "start", f"no agent can stand at `start` ({place})", "Start on a free part of the floor [m].")


def _too_late(columns: Columns, most_steps: float) -> Fault | None:
    steps = least_steps(columns)
    at_once = dict(columns) | {"least": np.zeros_like(columns["least"])}
    late = steps > most_steps
    at = _first(late & np.isfinite(least_steps(at_once))) if late.any() else None
    if at is None:
        return None
    message = f"success takes at least {steps[at[0]]:g} steps of `time`, an episode has {most_steps:g}"
    return Fault(at[0], "needs", message, "Set a longer episode_length, or require less `time` in the task.")


def _of_programs(
    columns: Columns, features: Float[np.ndarray, "features 2"], hints: Mapping[str, str]
) -> Iterator[Fault]:
    """Yield conditions that never hold or test nothing, incomplete descriptors, and sounds without a position."""
    needs, bars = (_bits(columns[name]) for name in ("needs", "bars"))
    yield from _never(columns, needs, features, hints)
    kind, feature = columns["meant.kind"], columns["feature"]
    for name, group in (("first", OF_ONE), ("second", OF_TWO)):
        asked = np.isin(feature, group) & (needs | bars)
        at = _first(asked & (_of(kind, columns[name]) == Kind.NOTHING))
        if at is not None:
            what = Feature(int(feature[at])).name.lower()
            message = f"`{what}` tests descriptor {columns[name][at]}, which selects nothing"
            yield Fault(at[0], name, message, f"Set `{name}` to the index of an item of `meant`.")
    nowhere = (kind == Kind.PLACE) & ~np.isfinite(columns["place"]).all(axis=-1)
    nobody = (kind == Kind.AGENT) & (columns["meant.agent"] < 0)
    for wrong, name in ((nowhere, "place"), (nobody, "agent")):
        at = _first(wrong)
        if at is not None:
            yield Fault(at[0], "meant", f"`meant[{at[1]}]` has no `{name}`", f"Give its `{name}`.")
    yield from _of_sounds(columns, kind)


def _never(
    columns: Columns, used: Bool[np.ndarray, "t c"], features: np.ndarray, hints: Mapping[str, str]
) -> Iterator[Fault]:
    """Yield required conditions that no value of their feature fulfils."""
    feature, least, most = (columns[name] for name in ("feature", "least", "most"))
    at = _first(used & (np.maximum(least, features[feature, 0]) > np.minimum(most, features[feature, 1])))
    if at is not None:
        name, (low, high) = Feature(int(feature[at])).name.lower(), features[feature[at]]
        values = f"it is from {low:g} to {high:g}" if high > low else f"it is always {low:g}"
        message = f"`{name}` is never from {least[at]:g} to {most[at]:g}: {values} here"
        yield Fault(at[0], "needs", message, hints.get(name, "Choose other limits `least` and `most`."))


def _of_sounds(columns: Columns, kind: np.ndarray) -> Iterator[Fault]:
    emitter, towards, clip = (columns[f"sound_{name}"] for name in ("emitter", "towards", "clip"))
    mute = (emitter >= 0) & ~np.isin(_of(kind, emitter), SOUNDING)
    lost = (emitter >= 0) & (towards >= 0) & (_of(kind, towards) == Kind.NOTHING)
    voiceless = (emitter >= 0) & (clip == VOICED) & (_of(kind, emitter) != Kind.AGENT)
    for wrong, name, of in (
        (mute, "emitter", "an object, a place or an agent"),
        (lost, "towards", "a place or an object"),
    ):
        at = _first(wrong)
        if at is not None:
            number = columns[f"sound_{name}"][at]
            yield Fault(
                at[0], "sounds", f"`{name}` is descriptor {number}, which is not {of}", "Choose another descriptor."
            )
    at = _first(voiceless)
    if at is not None:
        hint = 'Only agents have a "voice": {"kind": "agent", "agent": 0}.'
        yield Fault(at[0], "sounds", f"the voice belongs to descriptor {emitter[at]}, which is not an agent", hint)


def _bits(numbers: np.ndarray) -> Bool[np.ndarray, "t c"]:
    """Return which conditions are used by any transition."""
    asked = np.where(numbers < 0, 0, numbers).astype(int).reshape(len(numbers), -1)
    return (np.bitwise_or.reduce(asked, axis=1)[:, None] >> np.arange(NUM_CONDITIONS) & 1) == 1


def _of(kind: np.ndarray, number: np.ndarray) -> np.ndarray:
    """Return the kinds of the descriptors with these indices; NOTHING for -1."""
    found = np.take_along_axis(kind, np.maximum(number, 0).astype(int), axis=1)
    return np.where(number < 0, Kind.NOTHING, found)
