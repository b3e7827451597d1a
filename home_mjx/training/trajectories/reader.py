"""Reads episodes back, without Minari."""

import json
import operator
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa

from home_mjx.errors import DatasetError, HomeMjxError
from home_mjx.training.trajectories.layout import DATA, METADATA, PART, broken_metadata, read_metadata


class Trajectory(NamedTuple):
    """One episode of T steps.

    Attributes:
        observations: By name, T + 1 each.
        actions: T.
        rewards: T.
        terminations: T; the task has ended the episode.
        truncations: T; the time was up.
        notes: Task, instruction, house, metrics at the end.
    """

    observations: dict[str, np.ndarray]
    actions: np.ndarray
    rewards: np.ndarray
    terminations: np.ndarray
    truncations: np.ndarray
    notes: dict[str, Any]


class Trajectories:
    """A data set on disk, to be indexed and iterated over. Arrays lie in the files: nothing is read before its use.

    Args:
        folder: What `record` has written to.

    Attributes:
        metadata: Of the whole.

    Raises:
        MissingFileError: There is no data set.
        DatasetError: Its metadata are broken.

    Example:
        >>> data = Trajectories("data/RoomNav")  # doctest: +SKIP
        >>> sum(len(episode.actions) for episode in data)  # doctest: +SKIP
        100213
    """

    def __init__(self, folder: str | Path) -> None:
        self.data = Path(folder) / DATA
        self.metadata = read_metadata(self.data)
        with broken_metadata(self.data / METADATA):
            spaces = json.loads(self.metadata["observation_space"])["subspaces"]
            self._shapes = {name: _shape(space["shape"]) for name, space in spaces.items()}
            action = json.loads(self.metadata["action_space"])
            self._action = _shape(action.get("shape", (len(action["nvec"]),) if "nvec" in action else ()))
            self._length = operator.index(self.metadata["total_episodes"])
            if not 0 <= self._length <= sys.maxsize:
                raise ValueError(f"there cannot be {self._length:.3g} episodes")

    def __len__(self) -> int:
        """Episodes."""
        return self._length

    def __iter__(self) -> Iterator[Trajectory]:
        """All episodes in order."""
        return (self[i] for i in range(len(self)))

    def __getitem__(self, index: int) -> Trajectory:
        """An episode.

        Raises:
            IndexError: There is none of that number.
            DatasetError: Its file is broken.
        """
        if not -len(self) <= index < len(self):
            raise IndexError(f"there are episodes 0 to {len(self) - 1}, asked for {index}")
        folder = self.data / str(index % len(self))
        path = folder / PART
        try:
            with pa.memory_map(str(path)) as file:
                batch = pa.ipc.open_file(file).get_batch(0)
            batch.validate(full=True)  # else a made-up offset would be followed anywhere
            return self._episode(batch, read_metadata(folder))
        except (
            OSError,
            pa.ArrowException,
            LookupError,
            ValueError,
            TypeError,
            AttributeError,
            ArithmeticError,
        ) as error:
            if isinstance(error, HomeMjxError):
                raise
            hint = "Record it again, or restore the file."
            raise DatasetError(f"episode cannot be read: {error}", file=path, hint=hint) from None

    def _episode(self, batch: pa.RecordBatch, notes: dict[str, Any]) -> Trajectory:
        seen = batch.column("observations")
        ends = {name: batch.column(name).slice(0, len(seen) - 1) for name in Trajectory._fields[1:-1]}
        return Trajectory(
            {name: _array(seen.field(name), shape) for name, shape in self._shapes.items()},
            _array(ends["actions"], self._action),
            *(_array(ends[name], ()) for name in ("rewards", "terminations", "truncations")),
            notes=notes,
        )


def _shape(sizes: Any) -> tuple[int, ...]:
    """Raises `TypeError` or `ValueError` unless they are sizes of axes."""
    shape = tuple(map(operator.index, sizes))
    if min(shape, default=0) < 0:
        raise ValueError(f"there is no shape {shape}")
    return shape


def _array(column: pa.Array, shape: tuple[int, ...]) -> np.ndarray:
    """A column as NumPy's array of these elements, without a copy where that can be."""
    if isinstance(column, pa.FixedSizeListArray):
        return column.flatten().to_numpy(zero_copy_only=False).reshape(-1, *shape)
    return column.to_numpy(zero_copy_only=False)
