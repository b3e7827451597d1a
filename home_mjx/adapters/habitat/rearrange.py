"""Episode files of Habitat's rearrangement tasks: reading and writing, with poses of objects in the world frame.

Szot et al., "Habitat 2.0: Training Home Assistants to Rearrange their Habitat", 2021 (arXiv:2106.14405). Records hold
the JSON of the file, so that it is written as it was read.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from home_mjx.adapters.habitat.episodes import NavigationEpisode, check_pose, read_fields
from home_mjx.adapters.habitat.frames import NO_OFFSET, Vector
from home_mjx.core.files import as_path
from home_mjx.errors import DatasetError
from home_mjx.geometry.meshes import Z_UP

MAX_NUMBER = 1e6  # maximum magnitude of an entry of a matrix
Matrix = Float[np.ndarray, "4 4"]


@dataclass(frozen=True)
class RearrangeEpisode(NavigationEpisode):
    """An episode of rearrangement: its JSON, with Habitat's names as attributes.

    Attributes:
        fields: JSON of the episode.
    """

    @property
    def rigid_objs(self) -> tuple[tuple[str, Matrix], ...]:
        """Added objects: name of the configuration, and transform in Habitat's frame."""
        return tuple((name, np.array(matrix, float)) for name, matrix in self.fields["rigid_objs"])

    @property
    def targets(self) -> Mapping[str, Matrix]:
        """Goal of each object to move, as a transform in Habitat's frame."""
        return {name: np.array(matrix, float) for name, matrix in self.fields["targets"].items()}

    @property
    def ao_states(self) -> Mapping[str, Any]:
        """Joint values of articulated objects by link [rad] or [m], by instance."""
        return self.fields.get("ao_states") or {}

    def object_poses(self, offset: Vector = NO_OFFSET) -> tuple[tuple[str, Matrix], ...]:
        """Return the added objects in the world frame, see `pose_to_world`."""
        return tuple((name, pose_to_world(matrix, offset)) for name, matrix in self.rigid_objs)

    def target_poses(self, offset: Vector = NO_OFFSET) -> Mapping[str, Matrix]:
        """Return the goals in the world frame, see `pose_to_world`."""
        return {name: pose_to_world(matrix, offset) for name, matrix in self.targets.items()}


@dataclass(frozen=True)
class RearrangeDataset:
    """The episodes of a file; `write_dataset` writes it.

    Attributes:
        episodes: The episodes, in the order of the file.
        fields: Other fields of the file.
    """

    episodes: tuple[RearrangeEpisode, ...]
    fields: Mapping[str, Any]


def pose_to_world(matrix: Matrix, offset: Vector = NO_OFFSET) -> Matrix:
    """Return the pose of an object in the world frame: y of Habitat is z, z is -y, then `offset` [m] is added.

    The object's own frame has its z axis up as well.
    """
    turn = np.eye(4)
    turn[:3, :3] = Z_UP
    found = turn @ matrix @ turn.T
    found[:3, 3] += offset
    return found


def pose_from_world(matrix: Matrix, offset: Vector = NO_OFFSET) -> Matrix:
    """Return a pose of the world frame in Habitat's: the inverse of `pose_to_world`."""
    turn, moved = np.eye(4), matrix.copy()
    turn[:3, :3] = Z_UP
    moved[:3, 3] -= offset
    return turn.T @ moved @ turn


def read_rearrangement(path: str | Path) -> RearrangeDataset:
    """Read an episode file of rearrangement, packed or not.

    Raises:
        MissingFileError: The file does not exist.
        DatasetError: It is not such a file, or too large, or has no episode; names the episode and the field.

    Example:
        >>> read_rearrangement("rearrange.json.gz").episodes[0].target_poses()  # doctest: +SKIP
    """
    file = as_path(path, "episodes")
    fields = read_fields(file)
    if not fields["episodes"]:
        raise DatasetError("file holds no episode", file=file)
    for number, episode in enumerate(fields["episodes"]):
        _check_episode(episode, file, f"episodes[{number}]")
    return RearrangeDataset(tuple(RearrangeEpisode(episode) for episode in fields["episodes"]), fields)


def _check_episode(episode: Any, file: Path, element: str) -> None:
    """Raise `DatasetError` unless the JSON of an episode has a scene, a start, objects and goals."""
    check_pose(episode, file, element)
    objects, targets = episode.get("rigid_objs"), episode.get("targets")
    if not isinstance(objects, list) or not isinstance(targets, dict):
        message, hint = "expected a list `rigid_objs` and an object `targets`", "Files of PointNav: `read_dataset`."
        raise DatasetError(message, file=file, element=element, hint=hint)
    if not isinstance(episode.get("ao_states") or {}, dict):
        raise DatasetError("expected an object", file=file, element=f"{element}.ao_states")
    for number, item in enumerate(objects):
        place = f"{element}.rigid_objs[{number}]"
        if not isinstance(item, list) or len(item) != 2 or not isinstance(item[0], str):
            raise DatasetError("expected a name and a transform", file=file, element=place)
        _check_matrix(item[1], file, place)
    for name, matrix in targets.items():
        _check_matrix(matrix, file, f"{element}.targets[{name:.60}]")


def _check_matrix(value: Any, file: Path, element: str) -> None:
    """Raise `DatasetError` unless a value is a rigid transform: 4 rows of 4 finite numbers, and a rotation."""
    try:
        matrix = np.array(value, float)
    except (TypeError, ValueError):
        matrix = np.zeros(0)
    is_transform = matrix.shape == (4, 4) and bool((abs(matrix) < MAX_NUMBER).all())
    if not is_transform or not np.allclose(matrix[:3, :3] @ matrix[:3, :3].T, np.eye(3), atol=1e-3):
        raise DatasetError("expected a rigid transform, 4 rows of 4 numbers", file=file, element=element)
