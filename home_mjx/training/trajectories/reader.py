"""Reader of recorded episodes, without Minari."""

import json
import operator
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa

from home_mjx.errors import DatasetError, HomeMjxError
from home_mjx.training.trajectories.minari_format import (
    DATA_FOLDER,
    METADATA_FILE,
    PART_FILE,
    read_metadata,
    wrap_metadata_errors,
)

READ_ERRORS = OSError, pa.ArrowException, LookupError, ValueError, TypeError, AttributeError, ArithmeticError


class Trajectory(NamedTuple):
    """One episode of T steps.

    Attributes:
        observations: T + 1 observations by name.
        actions: T actions.
        rewards: T rewards.
        terminations: T flags; True if the task ended the episode.
        truncations: T flags; True if the time limit was reached.
        notes: Task, instruction, house, and metrics at the end.
    """

    observations: dict[str, np.ndarray]
    actions: np.ndarray
    rewards: np.ndarray
    terminations: np.ndarray
    truncations: np.ndarray
    notes: dict[str, Any]


class Trajectories:
    """Dataset on disk that can be indexed and iterated over. Files are memory-mapped, so data are read on use.

    Args:
        folder: Folder that `record` has written.

    Attributes:
        metadata: Metadata of the dataset.

    Raises:
        MissingFileError: The folder contains no dataset.
        DatasetError: Its metadata are broken.

    Example:
        >>> data = Trajectories("data/RoomNav")  # doctest: +SKIP
        >>> sum(len(episode.actions) for episode in data)  # doctest: +SKIP
        100213
    """

    def __init__(self, folder: str | Path) -> None:
        self.data = Path(folder) / DATA_FOLDER
        self.metadata = read_metadata(self.data)
        with wrap_metadata_errors(self.data / METADATA_FILE):
            spaces = json.loads(self.metadata["observation_space"])["subspaces"]
            self._shapes = {name: _parse_shape(space["shape"]) for name, space in spaces.items()}
            action = json.loads(self.metadata["action_space"])
            self._action = _parse_shape(action.get("shape", (len(action["nvec"]),) if "nvec" in action else ()))
            self._length = operator.index(self.metadata["total_episodes"])
            if not 0 <= self._length <= sys.maxsize:
                raise ValueError(f"`total_episodes` of {self._length:.3g} is out of range")

    def __len__(self) -> int:
        """Return the number of episodes."""
        return self._length

    def __iter__(self) -> Iterator[Trajectory]:
        """Iterate over all episodes in order."""
        return (self[i] for i in range(len(self)))

    def __getitem__(self, index: int) -> Trajectory:
        """Load one episode; negative indices count from the end.

        Raises:
            IndexError: The index is out of range.
            MissingFileError: The episode has no metadata file.
            DatasetError: Its file is missing or broken.
        """
        if not -len(self) <= index < len(self):
            raise IndexError(f"expected an episode from 0 to {len(self) - 1}, got {index}")
        folder = self.data / str(index % len(self))
        path = folder / PART_FILE
        try:
            with pa.memory_map(str(path)) as file:
                batch = pa.ipc.open_file(file).get_batch(0)
            batch.validate(full=True)  # because a corrupt offset would read arbitrary memory
            return self._episode(batch, read_metadata(folder))
        except HomeMjxError:
            raise
        except READ_ERRORS as error:
            hint = "Record it again, or restore the file."
            raise DatasetError(f"episode cannot be read: {error}", file=path, hint=hint) from None

    def _episode(self, batch: pa.RecordBatch, notes: dict[str, Any]) -> Trajectory:
        """Convert an episode's table and `notes`; its last row has only an observation.

        Observations that the dataset's metadata do not name are left out.
        """
        seen = batch.column("observations")
        ends = {name: batch.column(name).slice(0, len(seen) - 1) for name in Trajectory._fields[1:-1]}
        return Trajectory(
            {name: _to_array(seen.field(name), shape) for name, shape in self._shapes.items()},
            _to_array(ends["actions"], self._action),
            *(_to_array(ends[name], ()) for name in ("rewards", "terminations", "truncations")),
            notes=notes,
        )


def _parse_shape(sizes: Any) -> tuple[int, ...]:
    """Convert axis sizes to a shape; raise `TypeError` or `ValueError` if they are not sizes."""
    shape = tuple(map(operator.index, sizes))
    if min(shape, default=0) < 0:
        raise ValueError(f"shape {shape} has a negative size")
    return shape


def _to_array(column: pa.Array, shape: tuple[int, ...]) -> np.ndarray:
    """Convert a column to a NumPy array (rows, *shape), without a copy if possible; (rows,) unless it has lists."""
    if isinstance(column, pa.FixedSizeListArray):
        return column.flatten().to_numpy(zero_copy_only=False).reshape(-1, *shape)
    return column.to_numpy(zero_copy_only=False)
