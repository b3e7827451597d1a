"""Where Minari keeps what, and its spaces as text.

A data set is a folder: `data/metadata.json`, and for episode i `data/i/part-0.arrow` and `data/i/metadata.json`. See
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

DATA, METADATA, PART = "data", "metadata.json", "part-0.arrow"
FREE_SPACE = "Free some space, then go on with --resume; or name another folder."
MAX_BYTES = 1 << 28  # of metadata: limits of images of 8 megapixels
MINARI_VERSION = "0.5.4"  # whose layout this is; the first with images that are not JPEG


def space_json(space: gymnasium.Space) -> dict[str, Any]:
    """A space as Minari's metadata has it.

    Raises:
        ConfigError: It is of a kind that no environment here has.

    Example:
        >>> space_json(gymnasium.spaces.Discrete(6))
        {'type': 'Discrete', 'dtype': 'int64', 'start': 0, 'n': 6}
    """
    if isinstance(space, gymnasium.spaces.Dict):
        return {"type": "Dict", "subspaces": {name: space_json(part) for name, part in space.spaces.items()}}
    if isinstance(space, gymnasium.spaces.Box):
        limits = {"low": space.low.tolist(), "high": space.high.tolist()}
        return {"type": "Box", "dtype": str(space.dtype), "shape": list(space.shape), **limits}
    if isinstance(space, gymnasium.spaces.Discrete):
        return {"type": "Discrete", "dtype": "int64", "start": int(space.start), "n": int(space.n)}
    if isinstance(space, gymnasium.spaces.MultiDiscrete):
        numbers = {"nvec": space.nvec.tolist(), "start": space.start.tolist()}
        return {"type": "MultiDiscrete", "dtype": str(space.dtype), **numbers}
    raise ConfigError(f"Minari has no text for {space}")


def read_metadata(folder: Path) -> dict[str, Any]:
    """The metadata of a data set or an episode.

    Raises:
        MissingFileError: There is none.
        DatasetError: It is broken.
    """
    path = folder / METADATA
    if not path.exists():
        hint = "Give the folder that `home-mjx record` has written to."
        raise MissingFileError("there is no data set", file=path, hint=hint)
    with broken_metadata(path):
        content = json.loads(read_text(path, most=MAX_BYTES))
        if not isinstance(content, dict):
            raise ValueError("they are no object with names")
        return content


@contextmanager
def broken_metadata(path: Path) -> Iterator[None]:
    """Where metadata cannot be read, or lack something, the block raises `DatasetError`."""
    try:
        yield
    except HomeMjxError:
        raise
    except (ValueError, LookupError, TypeError, AttributeError, ArithmeticError, RecursionError) as error:
        reason = f"`{error.args[0]}` is missing" if type(error) is KeyError else str(error)
        raise DatasetError(f"metadata are broken: {reason}", file=path, hint="Restore the file.") from None


def write_metadata(folder: Path, content: dict[str, Any]) -> None:
    """Writes metadata in one move, so that a killed process, or a power cut, leaves the old ones or the new ones.

    Raises:
        ConfigError: They cannot be written.
    """
    with write_durably(folder / METADATA, "metadata", FREE_SPACE) as file:
        file.write(json.dumps(content, default=_plain).encode())


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value.tolist()


def num_complete(data: Path) -> int:
    """Episodes 0, 1, ... that are whole on disk: an episode's folder appears under its number when it is whole.

    Example:
        >>> num_complete(Path("nowhere"))
        0
    """
    count = 0
    while (data / str(count) / METADATA).exists():
        count += 1
    return count
