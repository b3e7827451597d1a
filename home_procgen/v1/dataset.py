"""Writes a dataset of generated houses."""

import json
import logging
import os
import shutil
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import NamedTuple, SupportsIndex

from tqdm import tqdm

from home_mjx.core.files import write_synced
from home_mjx.core.paths import CACHE_VARIABLE, cache_folder
from home_mjx.core.workers import usable_cores, worker_pool
from home_mjx.datasets.seeds import GENERATED_MARKER, house_id
from home_mjx.datasets.suncg.write.house import PARTIAL_PREFIX, is_house_complete, write_house, write_library
from home_mjx.datasets.suncg.write.metadata import LibraryModel
from home_mjx.errors import ConfigError, DatasetError
from home_mjx.schema.house import ModelInfo
from home_procgen.primitives.family import FurnitureModel
from home_procgen.primitives.textures import BASE_RECIPES, base_texture
from home_procgen.v1.build import build_house
from home_procgen.v1.categories import CATEGORIES, Category
from home_procgen.v1.furniture import library

LEFTOVER_SECONDS = 3600.0  # no folder takes so long to write
VERSION = 1  # raise it whenever the same seed would give another file
REMOVE = "Remove that folder: it is made again."
POOL_FROM = 24  # houses; fewer are made faster than worker processes start

log = logging.getLogger(__name__)


class Generator(NamedTuple):
    """One generator of houses."""

    version: int
    library: Callable[[Path], None]  # writes what all houses share below a dataset root
    write: Callable[[Path, int], None]  # the house of a seed below a dataset root
    serves: Callable[[Path, str], bool]  # whether what a house uses of the library is there


def generate_dataset(root: str | Path, seeds: Sequence[int], progress: bool = False) -> tuple[str, ...]:
    """Writes one house per seed, and the shared library, in SUNCG's on-disk format.

    A seed always gives the same files, byte for byte. Existing files are kept, so an interrupted call can be
    repeated and a dataset can grow; only what differs from what was written is written again. Many houses are
    written by worker processes: a script that asks for them needs the usual `if __name__ == "__main__":`.

    Args:
        root: Folder of the dataset; made if missing.
        seeds: Non-negative integers.
        progress: Show a progress bar.

    Returns:
        The house ids, in the order of the seeds.

    Raises:
        ConfigError: A seed is not an integer from 0 to 2**63 - 1.
        DatasetError: `root` cannot be written, or holds something else.

    Example:
        >>> ids = generate_dataset("houses", range(8))  # doctest: +SKIP
    """
    return write_seeds(root, seeds, Generator(VERSION, _write_library, _write, lambda _root, _house: True), progress)


def write_seeds(
    root: str | Path, seeds: Sequence[int], generator: Generator, progress: bool = False
) -> tuple[str, ...]:
    """Writes one house per seed by a generator; arguments and errors are those of `generate_dataset`."""
    seeds = [_checked(seed) for seed in seeds]
    root = Path(root).expanduser().absolute()
    _claim(root, generator.version)
    generator.library(root)
    names = {seed: house_id(seed) for seed in seeds}
    missing = [seed for seed, name in names.items() if not (_is_whole(root, name) and generator.serves(root, name))]
    with _mapper(len(missing)) as run, tqdm(total=len(missing), disable=not progress, unit="house") as bar:
        for _ in run(partial(generator.write, root), missing):
            bar.update()
    return tuple(names[seed] for seed in seeds)


def _write_library(root: Path) -> None:
    models = [library_model(model) for model in library().values()]
    write_library(root, models, {name: base_texture(name) for name in BASE_RECIPES})


def _checked(seed: object) -> int:
    if isinstance(seed, SupportsIndex) and not isinstance(seed, bool) and 0 <= int(seed) < 2**63:
        return int(seed)
    raise ConfigError(f"seed must be an integer from 0 to 2**63 - 1, got {seed!r}", element="seeds")


def _claim(root: Path, version: int = VERSION) -> None:
    """Marks a new or empty folder as ours; refuses any other that is not."""
    marker = {"generator": "home_mjx", "version": version}
    ours = root.parent == cache_folder().absolute()
    try:
        root.mkdir(parents=True, exist_ok=True)
        # Another process may be about to mark the same new folder: its unfinished marker does not count.
        if all(path.name.startswith(f".{GENERATED_MARKER}.") for path in root.iterdir()):
            temporary = root / f".{GENERATED_MARKER}.{os.getpid()}"
            # On the disk first: after a power cut the folder would else be nobody's, for ever.
            write_synced(temporary, json.dumps(marker).encode())
            temporary.replace(root / GENERATED_MARKER)
        found = (
            json.loads((root / GENERATED_MARKER).read_text(encoding="utf-8"))
            if (root / GENERATED_MARKER).exists()
            else None
        )
    except OSError as error:
        hint = f"Set {CACHE_VARIABLE} to a folder of yours." if ours else "Choose another folder."
        raise DatasetError(f"folder cannot be used: {error}", file=root, hint=hint) from None
    except (ValueError, RecursionError) as error:
        hint = REMOVE if ours else "Remove it or choose another folder."
        raise DatasetError(f"folder has a broken {GENERATED_MARKER}: {error}", file=root, hint=hint) from None
    if found is None:
        hint = REMOVE if ours else "Choose an empty or new folder."
        raise DatasetError("folder holds something that was not generated here", file=root, hint=hint)
    if found != marker:
        hint = REMOVE if ours else "Remove it or choose another folder."
        raise DatasetError(f"folder was generated by {found!r:.100}, this is {marker}", file=root, hint=hint)
    _sweep(root)


def _sweep(root: Path) -> None:
    """Removes what killed writers have left."""
    for path in (*root.glob(f"{PARTIAL_PREFIX}*"), *root.glob(f".{GENERATED_MARKER}.*")):
        with suppress(OSError):  # another process may be at it
            if time.time() - path.stat().st_mtime > LEFTOVER_SECONDS:
                shutil.rmtree(path) if path.is_dir() else path.unlink()


def _is_whole(root: Path, house: str) -> bool:
    """Whether a house exists as it was written. Another is removed, because writing keeps existing houses."""
    if is_house_complete(root, house):
        return True
    if (root / "house" / house).exists():
        log.warning("broken house %s is made again", root / "house" / house)
    for kind in ("house", "room"):  # so that none is ever seen without its rooms
        shutil.rmtree(root / kind / house, ignore_errors=True)
    return False


def library_model(model: FurnitureModel, categories: Mapping[str, Category] = CATEGORIES) -> LibraryModel:
    """A model with its rows in the metadata tables.

    Args:
        model: The model.
        categories: By fine class.
    """
    category = categories[model.fine]
    variants = {f"{model.id}_0": model.closed} if model.closed is not None else {}
    info = ModelInfo(model.id, model.fine, category.coarse, category.nyu40)
    return LibraryModel(info, model.mesh, category.synset, variants, model.lights, model.joints)


def _write(root: Path, seed: int) -> None:
    write_house(root, build_house(seed))


@contextmanager
def _mapper(count: int) -> Iterator:
    """A `map` for `count` houses: worker processes if that pays."""
    workers = min(usable_cores(), count)
    if count < POOL_FROM or workers < 2:
        yield map
        return
    with worker_pool(workers) as pool:
        yield partial(pool.map, chunksize=4)
