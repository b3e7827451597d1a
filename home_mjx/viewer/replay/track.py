"""Recorded episodes: what their states need to be shown again, and the file that holds them (host only)."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import jax
import numpy as np
from jaxtyping import Float

from home_mjx.core.files import convert_write_errors, read_arrays
from home_mjx.errors import ConfigError, DatasetError
from home_mjx.tasks.base.state import State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv

SUFFIX = ".replay.npz"
CONTENT, HINT = "replay", "Pass a file of `home-mjx play --replay`, or a folder of `home-mjx record`."
NOTES = "notes"  # array with the JSON of everything but arrays
UNKEPT = (".obs", ".info", ".world.sensor_states")  # paths of leaves that are not needed to show a state
SOUND = ".world.sensor_states['audio'].frame"  # but this one is: what the agent hears

Leaves = dict[str, np.ndarray]


class Event(NamedTuple):
    """Event of an episode.

    Attributes:
        step: Number of the step.
        kind: One of `events.KINDS`.
        text: Description.
    """

    step: int
    kind: str
    text: str


@dataclass(frozen=True)
class Track:
    """Episode of T steps, with all states.

    Attributes:
        notes: Texts and figures: `number`, `house`, `task`, `instruction`, `success`, `spl`.
        leaves: Leaves of the states by path: (T + 1, ...), or (1, ...) if all are equal.
        actions: Actions of all agents, (T, ...).
        series: Figures by name, (T + 1,): `reward` of each step, metrics of the task.
        feet: Lowest point of the first agent [m].
        events: Events in order.
    """

    notes: dict[str, Any]
    leaves: Leaves
    actions: np.ndarray
    series: dict[str, np.ndarray]
    feet: Float[np.ndarray, "t1 3"]
    events: tuple[Event, ...] = ()

    @property
    def num_steps(self) -> int:
        """Number of steps T."""
        return len(self.feet) - 1

    @property
    def is_failure(self) -> bool:
        """True if the episode ended without success."""
        return self.notes.get("success", 0.0) <= 0

    def at(self, index: int) -> Leaves:
        """Return the leaves of the state after step `index`; 0 is the reset."""
        return {name: np.asarray(values[index if len(values) > 1 else 0]) for name, values in self.leaves.items()}


@dataclass(frozen=True)
class Replay:
    """Recorded episodes of one environment.

    Attributes:
        agent: Name of the agent.
        spec: JSON of the environment's spec; None: its houses were in memory.
        houses: Ids of the environment's houses.
        tracks: The episodes.
    """

    agent: str
    spec: str | None
    houses: tuple[str, ...]
    tracks: list[Track] = field(default_factory=list)


def keep_leaves(state: State) -> Leaves:
    """Return the leaves of a state of one environment that are needed to show it, by path."""
    found = jax.tree_util.tree_leaves_with_path(jax.device_get(state))
    named = ((jax.tree_util.keystr(path), np.asarray(leaf)) for path, leaf in found)
    return {name: leaf for name, leaf in named if _is_kept(name)}


def stack_leaves(steps: Sequence[Leaves]) -> Leaves:
    """Return leaves of successive states with a leading axis, of length 1 for leaves that do not change.

    Example:
        >>> stacked = stack_leaves([{"a": np.zeros(2), "b": np.ones(1)}, {"a": np.ones(2), "b": np.ones(1)}])
        >>> stacked["a"].shape, stacked["b"].shape
        ((2, 2), (1, 1))
    """
    stacked = {name: np.stack([step[name] for step in steps]) for name in steps[0]}
    return {name: x[:1] if (x == x[:1]).all() else x for name, x in stacked.items()}


def blank_state(env: Env[HouseholdEnv]) -> State:
    """Return a state of one environment with all leaves 0, as NumPy arrays; nothing is compiled."""
    shapes = jax.eval_shape(env.core.reset, env.params, jax.random.key(0))
    return jax.tree.map(lambda x: np.zeros(x.shape, x.dtype), shapes)


def fill_state(blank: State, leaves: Leaves) -> State:
    """Return the state with the given leaves; what is not kept is 0.

    Raises:
        DatasetError: The leaves are those of another environment.
    """

    def pick(path: Any, leaf: np.ndarray) -> np.ndarray:
        """Return the recorded leaf, or the blank one if it is not kept."""
        name = jax.tree_util.keystr(path)
        found = leaves.get(name) if _is_kept(name) else leaf
        if found is None or found.shape != leaf.shape or found.dtype != leaf.dtype:
            raise DatasetError(f"the replay is of another environment or version: `{name}` differs", hint=HINT)
        return found

    return jax.tree_util.tree_map_with_path(pick, blank)


def write_replay(path: Path, replay: Replay) -> None:
    """Write a replay as one compressed file.

    Raises:
        ConfigError: It cannot be written.
    """
    arrays, episodes = {}, []
    for number, track in enumerate(replay.tracks):
        groups = {"leaves": track.leaves, "series": track.series, "own": {"actions": track.actions, "feet": track.feet}}
        names = {group: list(values) for group, values in groups.items()}
        for group, values in groups.items():
            arrays |= {f"{number}.{group}.{n}": x for n, x in enumerate(values.values())}
        episodes.append({"notes": track.notes, "names": names, "events": track.events})
    notes = {"agent": replay.agent, "spec": replay.spec, "houses": replay.houses, "episodes": episodes}
    with convert_write_errors(CONTENT, path), path.open("wb") as file:
        np.savez_compressed(file, **{NOTES: np.frombuffer(json.dumps(notes).encode(), np.uint8), **arrays})


def read_replay(path: Path) -> Replay:
    """Read the file of `write_replay`.

    Raises:
        MissingFileError: The file is missing.
        DatasetError: The file is broken.
    """
    (raw,) = read_arrays(path, [NOTES], CONTENT, HINT)
    try:
        notes = json.loads(raw.tobytes())
        episodes, known = notes["episodes"], (str(notes["agent"]), notes["spec"], tuple(notes["houses"]))
        tracks = [_read_track(path, number, episode) for number, episode in enumerate(episodes)]
    except (ValueError, LookupError, TypeError, AttributeError) as error:
        if isinstance(error, DatasetError):
            raise
        raise DatasetError(f"replay is broken: {error}", file=path, hint=HINT) from None
    return Replay(*known, tracks)


def _read_track(path: Path, number: int, episode: Mapping[str, Any]) -> Track:
    """Return one episode of the file."""
    groups = {}
    for group, names in episode["names"].items():
        arrays = read_arrays(path, [f"{number}.{group}.{n}" for n in range(len(names))], CONTENT, HINT)
        groups[group] = dict(zip(names, arrays, strict=True))
    events = tuple(Event(int(step), str(kind), str(text)) for step, kind, text in episode["events"])
    return Track(dict(episode["notes"]), groups["leaves"], series=groups["series"], events=events, **groups["own"])


def spec_text(env: Env[HouseholdEnv]) -> str | None:
    """Return the JSON of an environment's spec; None if it exists in memory only."""
    return None if env.spec is None or env.spec.in_memory else env.spec.to_json()


def check_houses(replay: Replay, houses: Sequence[str]) -> None:
    """Raise `ConfigError` unless the environment's houses are those of the replay."""
    if replay.houses != tuple(houses):
        hint = "Read the dataset that the episodes were recorded in."
        raise ConfigError(f"the replay's houses are not those of the environment: {replay.houses[:3]}", hint=hint)


def _is_kept(name: str) -> bool:
    """Return whether a leaf is needed to show a state."""
    return name == SOUND or not name.startswith(UNKEPT)
