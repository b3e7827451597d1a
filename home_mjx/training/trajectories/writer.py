"""Writer of episodes: one folder each, created atomically."""

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

from home_mjx.core.files import convert_write_errors, write_error
from home_mjx.errors import ConfigError
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.spaces import action_space, observation_space
from home_mjx.training.trajectories.minari_format import (
    DATA_FOLDER,
    FREE_SPACE_HINT,
    METADATA_FILE,
    MINARI_VERSION,
    PART_FILE,
    count_complete_episodes,
    read_metadata,
    space_to_json,
    write_metadata,
)

NUM_WRITER_THREADS = 4  # number of writer threads; Arrow releases the GIL
EPISODES_PER_METADATA_UPDATE = 256  # episodes between metadata updates; a killed process loses at most their counts


class TrajectoryWriter:
    """Writer of a dataset; a context manager that updates the metadata on exit.

    Args:
        folder: Output folder.
        env: Environment of the episodes.
        agent: Name of the policy, for the metadata.
        omit: Names of observations to omit from the metadata; episodes must not contain them.
        resume: Continue the dataset in the folder.

    Attributes:
        episodes: Number of episodes, including those of earlier runs.
        steps: Number of steps, including those of earlier runs.

    Raises:
        ConfigError: The folder contains a dataset and `resume` is False, or a dataset of other observations or actions;
            or it cannot be written to.
        DatasetError: Metadata of the dataset to resume are broken.
    """

    def __init__(
        self, folder: Path, env: Env[HouseholdEnv], agent: str, omit: tuple[str, ...] = (), resume: bool = False
    ) -> None:
        self.data = folder / DATA_FOLDER
        self.metadata = _make_metadata(env, agent, omit)
        self.episodes = self.steps = 0
        if (self.data / METADATA_FILE).exists():
            self._resume(resume)
        with convert_write_errors("a dataset of trajectories", folder):
            self.data.mkdir(parents=True, exist_ok=True)
            self._remove_incomplete()
        self._pool, self._waiting = ThreadPoolExecutor(NUM_WRITER_THREADS), []

    def __enter__(self) -> "TrajectoryWriter":
        self._update()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._pool.shutdown()
        self._update()

    def add(self, episode: Mapping[str, Any], notes: Mapping[str, Any]) -> None:
        """Queue an episode for writing; wait for the queue after every `EPISODES_PER_METADATA_UPDATE` episodes.

        Threads write it later, so its arrays must not change.

        Args:
            episode: T + 1 `observations` by name; T `actions`, `rewards`, `terminations` and `truncations`.
            notes: Additional metadata of the episode.

        Raises:
            ConfigError: A queued episode could not be written; raised on waiting, at the latest on exit.
        """
        number, num_steps = self.episodes, len(episode["rewards"])
        notes = {"id": number, "total_steps": num_steps, **notes}
        self._waiting.append(self._pool.submit(_write_episode, self.data, number, dict(episode), notes))
        self.episodes, self.steps = number + 1, self.steps + num_steps
        if len(self._waiting) >= EPISODES_PER_METADATA_UPDATE:
            self._update()

    def _remove_incomplete(self) -> None:
        """Remove temporary folders of a killed process, and episodes with numbers from `episodes` on."""
        for left in self.data.iterdir():
            beyond = left.name.isdecimal() and int(left.name) >= self.episodes
            if beyond or (left.name.startswith(".") and left.name.endswith(".new")):
                shutil.rmtree(left) if left.is_dir() else left.unlink()

    def _update(self) -> None:
        """Wait for pending writes, raise their errors, and write the metadata with new counts and size [MB].

        The size is an estimate: that of episode 0 times the number of episodes.
        """
        waiting, self._waiting = self._waiting, []
        for done in waiting:
            _reraise(done)
        counts = {"total_episodes": self.episodes, "total_steps": self.steps}
        size = round(sum(path.stat().st_size for path in self.data.glob("0/*")) * self.episodes / 1e6, 1)
        write_metadata(self.data, self.metadata | counts | {"dataset_size": size})

    def _resume(self, resume: bool) -> None:
        """Set `episodes` and `steps` from the disk; raise `ConfigError` without `resume`, or if the metadata differ.

        Metadata that only the dataset on disk has are ignored.
        """
        if not resume:
            hint = "Add --resume to continue it, or choose another folder with --out."
            raise ConfigError("the folder contains a dataset", file=self.data, hint=hint)
        theirs = read_metadata(self.data)
        for name, ours in self.metadata.items():
            if theirs.get(name) != ours:
                hint = "Pass the same options, or choose another folder."
                raise ConfigError(f"the dataset has another `{name}`", file=self.data, hint=hint)
        self.episodes = count_complete_episodes(self.data)
        self.steps = sum(int(read_metadata(self.data / str(i))["total_steps"]) for i in range(self.episodes))


def _reraise(done: "Future[None]") -> None:
    """Wait for a write, and raise its errors in this thread, an `OSError` as `ConfigError`."""
    try:
        done.result()
    except OSError as error:
        raise write_error("an episode", Path(error.filename or DATA_FOLDER), error, FREE_SPACE_HINT) from None


def _make_metadata(env: Env[HouseholdEnv], agent: str, without: tuple[str, ...]) -> dict[str, Any]:
    """Return Minari's metadata, except the observations `without`; with the environment's spec if it can be stored."""
    seen = observation_space(env)
    seen = type(seen)({name: space for name, space in seen.spaces.items() if name not in without})
    task = env.spec.id if env.spec is not None else type(env.task).__name__
    made = {} if env.spec is None or env.spec.in_memory else {"home_mjx_env": env.spec.to_json()}
    return {
        "dataset_id": f"home_mjx/{task.rpartition('-v')[0] or task}/{agent}-v0",
        "minari_version": MINARI_VERSION,
        "data_format": "arrow",
        "jpeg_encoding": False,
        "observation_space": json.dumps(space_to_json(seen)),
        "action_space": json.dumps(space_to_json(action_space(env))),
        "algorithm_name": agent,
        **made,
    }


def _write_episode(data: Path, number: int, episode: dict[str, Any], notes: dict[str, Any]) -> None:
    """Write an episode to a temporary folder, then rename it to its number, which makes it valid.

    `OSError` passes, such as for a folder of that name that is not empty. `notes` are its metadata.
    """
    beside, place = data / f".{number}.new", data / str(number)
    beside.mkdir()
    batch = to_record_batch(episode)
    with (beside / PART_FILE).open("wb") as sink:
        with pa.ipc.new_file(sink, batch.schema) as file:
            file.write_batch(batch)
        sink.flush()
        os.fsync(sink.fileno())  # before the rename makes the episode valid
    write_metadata(beside, notes)
    beside.rename(place)


def to_record_batch(episode: Mapping[str, Any]) -> pa.RecordBatch:
    """Convert an episode to Minari's layout: one row per observation; other columns of the last row are 0.

    The episode must have at least one step. Arrays of several axes become flat lists, see `_to_column`.
    """
    seen: dict[str, np.ndarray] = episode["observations"]
    columns = {"observations": pa.StructArray.from_arrays([_to_column(x) for x in seen.values()], names=list(seen))}
    for name in ("actions", "rewards", "terminations", "truncations"):
        values = np.asarray(episode[name])
        columns[name] = _to_column(np.concatenate([values, np.zeros_like(values[:1])]))
    return pa.RecordBatch.from_pydict(columns)


def _to_column(values: np.ndarray) -> pa.Array:
    """Convert an array to an Arrow column, one row per element of the first axis; further axes become flat lists.

    Booleans in such lists become int8.
    """
    values = values.astype(np.int8) if values.dtype == bool and values.ndim > 1 else values
    if values.ndim == 1:
        return pa.array(values)
    flat = np.ascontiguousarray(values).reshape(-1)
    length = flat.size // max(len(values), 1)
    return pa.FixedSizeListArray.from_arrays(pa.array(flat), length)
