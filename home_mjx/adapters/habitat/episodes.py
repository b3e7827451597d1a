"""Episode files of Habitat, `.json.gz` of PointNav and ObjectNav: reading and writing, in Habitat's frame.

Records hold the JSON of the file, fields that nothing here uses included, so that a file is written as it was read.
"""

import gzip
import io
import json
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any, Protocol, runtime_checkable

from home_mjx.adapters.habitat.frames import MAX_NORM_ERROR, Quaternion, Vector
from home_mjx.core.files import as_path, read_bytes, write_durably
from home_mjx.errors import DatasetError

MAX_FILE_BYTES = 1 << 28  # [bytes], maximum size of a packed file
MAX_JSON_BYTES = 1 << 30  # [bytes], maximum size of its JSON
MAX_NUMBER = 1e6  # [m], maximum of a coordinate; larger than any scene
GZIP_MAGIC = b"\x1f\x8b"


@dataclass(frozen=True)
class NavigationGoal:
    """A goal of an episode: its JSON, with Habitat's names as attributes.

    Attributes:
        fields: JSON of the goal.
    """

    fields: Mapping[str, Any]

    @property
    def position(self) -> Vector:
        """Position in Habitat's frame [m]."""
        x, y, z = self.fields["position"]
        return (x, y, z)

    @property
    def radius(self) -> float | None:
        """Distance within which the goal is reached [m]; None: that of the task."""
        return self.fields.get("radius")


@dataclass(frozen=True)
class NavigationEpisode:
    """An episode as in Habitat's files: its JSON, with Habitat's names as attributes.

    Attributes:
        fields: JSON of the episode.
    """

    fields: Mapping[str, Any]

    @property
    def episode_id(self) -> str:
        """Id of the episode, unique in its scene."""
        return str(self.fields["episode_id"])

    @property
    def scene_id(self) -> str:
        """File or name of the scene."""
        return self.fields["scene_id"]

    @property
    def house_id(self) -> str:
        """Id of the house: the name of the scene's file without endings, `b` for `a/b.basis.glb`."""
        return PurePosixPath(self.scene_id).name.split(".")[0]

    @property
    def start_position(self) -> Vector:
        """Start on the floor in Habitat's frame [m]."""
        x, y, z = self.fields["start_position"]
        return (x, y, z)

    @property
    def start_rotation(self) -> Quaternion:
        """Rotation at the start: x, y, z, w in Habitat's frame."""
        x, y, z, w = self.fields["start_rotation"]
        return (x, y, z, w)

    @property
    def goals(self) -> tuple[NavigationGoal, ...]:
        """Goals; files of ObjectNav have them apart from the episodes, see `NavigationDataset.goals_of`."""
        return tuple(NavigationGoal(goal) for goal in self.fields.get("goals") or ())

    @property
    def info(self) -> Mapping[str, Any]:
        """Figures of the episode, such as `geodesic_distance` [m]."""
        return self.fields.get("info") or {}

    @property
    def object_category(self) -> str | None:
        """Category to find; None in episodes of PointNav."""
        return self.fields.get("object_category")

    @property
    def shortest_paths(self) -> Any:
        """Actions of shortest paths, as the file has them; None if there are none."""
        return self.fields.get("shortest_paths")


@dataclass(frozen=True)
class NavigationDataset:
    """The episodes of a file.

    Attributes:
        episodes: The episodes, in the order of the file.
        fields: Other fields of the file, such as `goals_by_category`.
    """

    episodes: tuple[NavigationEpisode, ...]
    fields: Mapping[str, Any]

    def goals_of(self, episode: NavigationEpisode) -> tuple[NavigationGoal, ...]:
        """Return an episode's goals, its own or those of its category in its scene; empty if the file has none."""
        key = f"{PurePosixPath(episode.scene_id).name}_{episode.object_category}"
        shared = self.fields.get("goals_by_category", {}).get(key, ())
        return episode.goals or tuple(NavigationGoal(goal) for goal in shared)


def read_dataset(path: str | Path) -> NavigationDataset:
    """Read an episode file, packed or not; one without episodes is joined with those of its folder `content`.

    Raises:
        MissingFileError: The file does not exist.
        DatasetError: It is not such a file, or too large, or has no episode; names the episode and the field.

    Example:
        >>> read_dataset("val.json.gz").episodes[0].start_position  # doctest: +SKIP
        (-1.2, 0.1, 3.4)
    """
    file = as_path(path, "episodes")
    fields, episodes = _read_file(file)
    if not episodes:
        parts = [_read_file(part) for part in sorted((file.parent / "content").glob("*.json.gz"))]
        episodes = [episode for _, own in parts for episode in own]
        shared = [own.get("goals_by_category", {}) for own, _ in parts]
        if any(shared):
            fields = fields | {"goals_by_category": {name: goals for own in shared for name, goals in own.items()}}
    if not episodes:
        raise DatasetError("file holds no episode", file=file, hint="Episodes are in it, or in `content` beside it.")
    return NavigationDataset(tuple(episodes), fields)


@runtime_checkable
class EpisodeFile(Protocol):
    """Content of an episode file."""

    @property
    def episodes(self) -> Sequence[NavigationEpisode]:
        """The episodes, in the order of the file."""
        ...

    @property
    def fields(self) -> Mapping[str, Any]:
        """Other fields of the file."""
        ...


def write_dataset(path: str | Path, dataset: EpisodeFile) -> None:
    """Write an episode file, packed; the same episodes give the same bytes.

    Raises:
        ConfigError: The file cannot be written.
    """
    fields = {**dataset.fields, "episodes": [dict(episode.fields) for episode in dataset.episodes]}
    with write_durably(as_path(path, "episodes"), "episodes") as file:
        file.write(gzip.compress(json.dumps(fields).encode(), mtime=0))


def _read_file(file: Path) -> tuple[dict[str, Any], list[NavigationEpisode]]:
    """Return the fields of one file, in their order, and its episodes; errors as of `read_dataset`."""
    fields = read_fields(file)
    if not isinstance(fields.get("goals_by_category", {}), dict):
        raise DatasetError("expected an object", file=file, element="goals_by_category")
    for number, episode in enumerate(fields["episodes"]):
        _check_episode(episode, file, f"episodes[{number}]")
    return fields, [NavigationEpisode(episode) for episode in fields["episodes"]]


def read_fields(file: Path) -> dict[str, Any]:
    """Return the JSON of an episode file, an object with a list `episodes`; errors as of `read_dataset`."""
    try:
        fields = json.loads(_unpack(read_bytes(file, max_bytes=MAX_FILE_BYTES), file))
    except (ValueError, RecursionError) as error:
        if isinstance(error, DatasetError):
            raise
        raise DatasetError(f"file is not JSON: {error!s:.100}", file=file) from None
    if not isinstance(fields, dict) or not isinstance(fields.get("episodes"), list):
        raise DatasetError("expected an object with a list `episodes`", file=file)
    return fields


def _unpack(data: bytes, file: Path) -> bytes:
    """Return bytes unpacked if they are gzip; `DatasetError` if they are broken or too large."""
    if not data.startswith(GZIP_MAGIC):
        return data
    try:
        with gzip.GzipFile(fileobj=io.BytesIO(data)) as packed:
            found = packed.read(MAX_JSON_BYTES + 1)
    except (OSError, EOFError, zlib.error) as error:
        raise DatasetError(f"file is broken gzip: {error}", file=file, hint="Fetch it again.") from None
    if len(found) > MAX_JSON_BYTES:
        raise DatasetError(f"file unpacks to more than {MAX_JSON_BYTES} bytes", file=file)
    return found


def check_pose(episode: Any, file: Path, element: str) -> None:
    """Raise `DatasetError` unless the JSON of an episode has an id, a scene and a start of finite numbers."""
    if not isinstance(episode, dict) or not isinstance(episode.get("scene_id"), str) or "episode_id" not in episode:
        raise DatasetError("expected an object with `episode_id` and `scene_id`", file=file, element=element)
    _check_numbers(episode, "start_position", 3, file, element)
    _check_numbers(episode, "start_rotation", 4, file, element)
    if abs(sum(value * value for value in episode["start_rotation"]) - 1) > MAX_NORM_ERROR:
        message = f"expected a rotation x, y, z, w of norm 1, got {episode['start_rotation']}"
        raise DatasetError(message, file=file, element=f"{element}.start_rotation")


def _check_episode(episode: Any, file: Path, element: str) -> None:
    """Raise `DatasetError` unless the JSON of an episode has a scene, and poses and goals of finite numbers."""
    check_pose(episode, file, element)
    info = episode.get("info") or {}
    if not isinstance(info, dict) or type(info.get("geodesic_distance", 0.0)) not in (int, float):
        raise DatasetError("expected a number `geodesic_distance`", file=file, element=f"{element}.info")
    goals = episode.get("goals") or []
    if not isinstance(goals, list) or not (goals or isinstance(episode.get("object_category"), str)):
        raise DatasetError("expected a list `goals`, or `object_category`", file=file, element=element)
    for number, goal in enumerate(goals):
        _check_numbers(goal, "position", 3, file, f"{element}.goals[{number}]")


def _check_numbers(fields: Any, name: str, count: int, file: Path, element: str) -> None:
    """Raise `DatasetError` unless a field is a list of `count` finite numbers."""
    found = fields.get(name) if isinstance(fields, dict) else None
    if not isinstance(found, list) or len(found) != count or not all(_is_finite_number(value) for value in found):
        message = f"expected {count} finite numbers, got {json.dumps(found):.60}"
        raise DatasetError(message, file=file, element=f"{element}.{name}")


def _is_finite_number(value: Any) -> bool:
    """Return whether a JSON value is a number of at most `MAX_NUMBER`; booleans and NaN are none."""
    return type(value) in (int, float) and abs(value) <= MAX_NUMBER
