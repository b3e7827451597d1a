"""Writes episodes, one folder each, that is there as a whole or not at all."""

import json
import os
import shutil
from collections.abc import Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
import pyarrow as pa

from home_mjx.adapters.spaces import action_space, observation_space
from home_mjx.core.files import unwritable
from home_mjx.errors import ConfigError
from home_mjx.tasks.env.bound import BoundEnv
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.training.trajectories.layout import (
    DATA,
    FREE_SPACE,
    METADATA,
    MINARI_VERSION,
    PART,
    num_complete,
    read_metadata,
    space_json,
    write_metadata,
)

THREADS = 4  # Arrow writes without Python's lock
PER_METADATA = 256  # episodes between two writes of the whole's metadata: what a killed process does not count


class Writer:
    """Writes a data set; a context that brings its metadata up to date when it is left.

    Args:
        folder: Where to.
        env: What the episodes are of.
        agent: Who acts, for the metadata.
        without: Observations that are not kept.
        resume: Go on with what the folder holds.

    Attributes:
        episodes: Written so far, those of earlier runs included.
        steps: Alike.

    Raises:
        ConfigError: The folder holds a data set and `resume` is False, or one of other observations or actions.
    """

    def __init__(
        self, folder: Path, env: BoundEnv[HouseholdEnv], agent: str, without: tuple[str, ...] = (), resume: bool = False
    ) -> None:
        self.data, self.without = folder / DATA, without
        self.metadata = _metadata(env, agent, without)
        self.episodes = self.steps = 0
        if (self.data / METADATA).exists():
            self._take_up(resume)
        self.data.mkdir(parents=True, exist_ok=True)
        self._sweep()
        self._pool, self._waiting = ThreadPoolExecutor(THREADS), []

    def __enter__(self) -> "Writer":
        self._update()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._pool.shutdown()
        self._update()

    def add(self, episode: Mapping[str, Any], notes: Mapping[str, Any]) -> None:
        """Writes an episode, soon.

        Args:
            episode: T + 1 `observations` by name; T `actions`, `rewards`, `terminations` and `truncations`.
            notes: For its own metadata.
        """
        number, num_steps = self.episodes, len(episode["rewards"])
        notes = {"id": number, "total_steps": num_steps, **notes}
        self._waiting.append(self._pool.submit(_write_episode, self.data, number, dict(episode), notes))
        self.episodes, self.steps = number + 1, self.steps + num_steps
        if len(self._waiting) >= PER_METADATA:
            self._update()

    def _sweep(self) -> None:
        """Removes what a killed process left: what was not whole, and episodes behind one that was not."""
        for left in self.data.iterdir():
            beyond = left.name.isdecimal() and int(left.name) >= self.episodes
            if beyond or (left.name.startswith(".") and left.name.endswith(".new")):
                shutil.rmtree(left) if left.is_dir() else left.unlink()

    def _update(self) -> None:
        """Waits for what is being written and counts it."""
        waiting, self._waiting = self._waiting, []
        for done in waiting:
            _raised(done)
        counts = {"total_episodes": self.episodes, "total_steps": self.steps}
        size = round(sum(path.stat().st_size for path in self.data.glob("0/*")) * self.episodes / 1e6, 1)
        write_metadata(self.data, self.metadata | counts | {"dataset_size": size})

    def _take_up(self, resume: bool) -> None:
        """Counts what is there."""
        if not resume:
            hint = "Add --resume to go on with it, or choose another folder by --out."
            raise ConfigError("the folder holds a data set", file=self.data, hint=hint)
        theirs = read_metadata(self.data)
        for name, ours in self.metadata.items():
            if theirs.get(name) != ours:
                hint = "Give the same options, or another folder."
                raise ConfigError(f"the data set has another `{name}`", file=self.data, hint=hint)
        self.episodes = num_complete(self.data)
        self.steps = sum(int(read_metadata(self.data / str(i))["total_steps"]) for i in range(self.episodes))


def _raised(done: "Future[None]") -> None:
    """Errors of another thread are raised in this one."""
    try:
        done.result()
    except OSError as error:
        raise unwritable("an episode", Path(error.filename or DATA), error, FREE_SPACE) from None


def _metadata(env: BoundEnv[HouseholdEnv], agent: str, without: tuple[str, ...]) -> dict[str, Any]:
    """What Minari wants to know, and what the environment was made of."""
    seen = observation_space(env)
    seen = type(seen)({name: space for name, space in seen.spaces.items() if name not in without})
    task = env.spec.id if env.spec is not None else type(env.task).__name__
    made = {} if env.spec is None or env.spec.in_memory else {"home_mjx_env": env.spec.to_json()}
    return {
        "dataset_id": f"home_mjx/{task.rpartition('-v')[0] or task}/{agent}-v0",
        "minari_version": MINARI_VERSION,
        "data_format": "arrow",
        "jpeg_encoding": False,
        "observation_space": json.dumps(space_json(seen)),
        "action_space": json.dumps(space_json(action_space(env))),
        "algorithm_name": agent,
        **made,
    }


def _write_episode(data: Path, number: int, episode: dict[str, Any], notes: dict[str, Any]) -> None:
    """Beside its place first; the folder's name is what makes it count."""
    beside, place = data / f".{number}.new", data / str(number)
    beside.mkdir()
    batch = as_batch(episode)
    with (beside / PART).open("wb") as sink:
        with pa.ipc.new_file(sink, batch.schema) as file:
            file.write_batch(batch)
        sink.flush()
        os.fsync(sink.fileno())  # before its folder's name makes it count
    write_metadata(beside, notes)
    beside.rename(place)


def as_batch(episode: Mapping[str, Any]) -> pa.RecordBatch:
    """An episode as Minari lays it out: one row per observation; the last row has no action, its numbers are 0."""
    seen: dict[str, np.ndarray] = episode["observations"]
    columns = {"observations": pa.StructArray.from_arrays([_column(x) for x in seen.values()], names=list(seen))}
    for name in ("actions", "rewards", "terminations", "truncations"):
        values = np.asarray(episode[name])
        columns[name] = _column(np.concatenate([values, np.zeros_like(values[:1])]))
    return pa.RecordBatch.from_pydict(columns)


def _column(values: np.ndarray) -> pa.Array:
    """Numbers as they are; arrays flat, as lists of one length."""
    values = values.astype(np.int8) if values.dtype == bool and values.ndim > 1 else values
    if values.ndim == 1:
        return pa.array(values)
    flat = np.ascontiguousarray(values).reshape(-1)
    length = flat.size // max(len(values), 1)
    return pa.FixedSizeListArray.from_arrays(pa.array(flat), length)
