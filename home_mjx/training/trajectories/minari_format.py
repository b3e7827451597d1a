"""Folder layout of Minari datasets, and their JSON form of spaces.

A dataset is a folder: `data/metadata.json`, and for episode i `data/i/part-0.arrow` and `data/i/metadata.json`. See
https://minari.farama.org/content/dataset_standards.
"""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np

from home_mjx.core.files import read_text, write_durably
from home_mjx.errors import ConfigError, DatasetError, HomeMjxError, MissingFileError

DATA_FOLDER, METADATA_FILE, PART_FILE = "data", "metadata.json", "part-0.arrow"
FREE_SPACE_HINT = "Free some space, then continue with --resume; or choose another folder."
MAX_METADATA_BYTES = 1 << 28  # maximum size of metadata [bytes]; enough for the limits of 8-megapixel images
RESET_KEY, ROW = "reset_key", "row"  # names in episodes' metadata: from these an episode can be simulated again
MINARI_VERSION = "0.5.4"  # version of this layout; the first with images that are not JPEG


def space_to_json(space: gymnasium.Space) -> dict[str, Any]:
    """Convert a space to the JSON form of Minari's metadata.

    Raises:
        ConfigError: The space is of a type that no environment here uses.

    Example:
        >>> space_to_json(gymnasium.spaces.Discrete(6))
        {'type': 'Discrete', 'dtype': 'int64', 'start': 0, 'n': 6}
    """
    if isinstance(space, gymnasium.spaces.Dict):
        return {"type": "Dict", "subspaces": {name: space_to_json(part) for name, part in space.spaces.items()}}
    if isinstance(space, gymnasium.spaces.Box):
        limits = {"low": space.low.tolist(), "high": space.high.tolist()}
        return {"type": "Box", "dtype": str(space.dtype), "shape": list(space.shape), **limits}
    if isinstance(space, gymnasium.spaces.Discrete):
        return {"type": "Discrete", "dtype": "int64", "start": int(space.start), "n": int(space.n)}
    if isinstance(space, gymnasium.spaces.MultiDiscrete):
        numbers = {"nvec": space.nvec.tolist(), "start": space.start.tolist()}
        return {"type": "MultiDiscrete", "dtype": str(space.dtype), **numbers}
    raise ConfigError(f"Minari cannot represent the space {space}")


def read_metadata(folder: Path) -> dict[str, Any]:
    """Read `metadata.json` in the folder of a dataset or an episode.

    Raises:
        MissingFileError: The metadata file does not exist.
        DatasetError: The file is broken.
    """
    path = folder / METADATA_FILE
    if not path.exists():
        hint = "Pass a folder that `home-mjx record` has written."
        raise MissingFileError("there is no dataset", file=path, hint=hint)
    with wrap_metadata_errors(path):
        content = json.loads(read_text(path, max_bytes=MAX_METADATA_BYTES))
        if not isinstance(content, dict):
            raise ValueError("they are not a JSON object")
        return content


@contextmanager
def wrap_metadata_errors(path: Path) -> Iterator[None]:
    """Convert errors of malformed content in the block to a `DatasetError` that names the metadata file.

    `HomeMjxError`, `OSError` and other kinds pass unchanged.
    """
    try:
        yield
    except HomeMjxError:
        raise
    except (ValueError, LookupError, TypeError, AttributeError, ArithmeticError, RecursionError) as error:
        reason = f"`{error.args[0]}` is missing" if type(error) is KeyError else str(error)
        raise DatasetError(f"metadata are broken: {reason}", file=path, hint="Restore the file.") from None


def write_metadata(folder: Path, content: dict[str, Any]) -> None:
    """Write metadata atomically, so that a killed process or a power cut leaves either the old or the new version.

    Raises:
        ConfigError: The file cannot be written.
    """
    with write_durably(folder / METADATA_FILE, "metadata", FREE_SPACE_HINT) as file:
        file.write(json.dumps(content, default=_to_plain).encode())


def _to_plain(value: Any) -> Any:
    """Convert a NumPy number or array to Python numbers or lists, for JSON; others raise `AttributeError`."""
    return value.item() if isinstance(value, np.generic) else value.tolist()


def count_complete_episodes(data: Path) -> int:
    """Count the complete episodes 0, 1, ... in a folder, up to the first that is missing or has no metadata.

    Example:
        >>> count_complete_episodes(Path("nowhere"))
        0
    """
    count = 0
    while (data / str(count) / METADATA_FILE).exists():
        count += 1
    return count
