"""Writer of generated datasets: seeds to houses on disk, with worker processes; shared library included."""

import json
import logging
import os
import shutil
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import SupportsIndex

from home_mjx.core.files import write_synced
from home_mjx.core.paths import CACHE_VARIABLE, cache_folder
from home_mjx.core.progress import ProgressCount, plural, say
from home_mjx.core.workers import max_workers, worker_pool
from home_mjx.datasets.seeds import GENERATED_MARKER
from home_mjx.datasets.suncg.write.house import PARTIAL_PREFIX, is_house_complete
from home_mjx.errors import ConfigError, DatasetError
from home_procgen.model_library import has_intact_library, save_intact_index, write_library_tables
from home_procgen.presets import GENERATOR_VERSION, Variant

MAX_WRITING_TIME = 3600.0  # [s], of a folder; older partial folders are left over from killed writers
REMOVE_HINT = "Remove that folder: it is made again."
GENERATOR_NAME = "home_mjx"
MIN_POOL_HOUSES = 24  # fewer houses are written faster than worker processes start
log = logging.getLogger(__name__)


def write_seeds(
    root: str | Path,
    seeds: Sequence[int],
    variant: Variant,
    write_house: Callable[[Path, int], None],
    progress: bool = False,
) -> tuple[str, ...]:
    """Write one house per seed of a variant, and the tables of the shared library.

    Other arguments and errors are those of `home_procgen.generate_dataset`.

    Args:
        root: Folder of the dataset.
        seeds: Seeds of the houses.
        variant: Variant of the houses.
        write_house: Writes the house of a seed below a dataset root; called in worker processes.
        progress: Show a progress bar.
    """
    seeds = [_check_seed(seed) for seed in seeds]
    root = Path(root).expanduser().absolute()
    claim_root(root, variant)
    write_library_tables(root, variant.detail)
    names = {seed: variant.house_id(seed) for seed in seeds}
    missing = [
        seed for seed, name in names.items() if not (_has_intact_house(root, name) and has_intact_library(root, name))
    ]
    text = f"generating {plural(len(missing), 'house')}"
    if missing:
        say(f"{text} (once, then cached)" if root.parent == cache_folder().absolute() else text, progress)
    with _pool_map(len(missing)) as run, ProgressCount(text, len(missing), "house", progress) as bar:
        for _ in run(partial(write_house, root), missing):
            bar.update()
    save_intact_index(root)
    return tuple(names[seed] for seed in seeds)


def _check_seed(seed: object) -> int:
    if isinstance(seed, SupportsIndex) and not isinstance(seed, bool) and 0 <= int(seed) < 2**63:
        return int(seed)
    raise ConfigError(f"seed must be an integer from 0 to 2**63 - 1, got {seed!r}", element="seeds")


def claim_root(root: Path, variant: Variant) -> None:
    """Mark a new or empty folder as a generated dataset; `DatasetError` for other folders and other variants."""
    marker = {"generator": GENERATOR_NAME, "version": GENERATOR_VERSION, **variant.settings}
    ours = root.parent == cache_folder().absolute()
    try:
        root.mkdir(parents=True, exist_ok=True)
        # Another process may be about to mark the same new folder: its unfinished marker does not count.
        if all(path.name.startswith(f".{GENERATED_MARKER}.") for path in root.iterdir()):
            temporary = root / f".{GENERATED_MARKER}.{os.getpid()}"
            # Synced first: after a power cut the folder would otherwise have no marker and never be usable again.
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
        hint = REMOVE_HINT if ours else "Remove it or choose another folder."
        raise DatasetError(f"folder has a broken {GENERATED_MARKER}: {error}", file=root, hint=hint) from None
    if found is None:
        hint = REMOVE_HINT if ours else "Choose an empty or new folder."
        raise DatasetError("folder holds something that was not generated here", file=root, hint=hint)
    if found != marker:
        raise _other_variant(root, found, variant, ours)
    _remove_leftovers(root)


def _other_variant(root: Path, found: object, variant: Variant, ours: bool) -> DatasetError:
    """Return, without raising it, the error for a folder with the marker of another variant, or of another program."""
    marker = found if isinstance(found, dict) and found.get("generator") == GENERATOR_NAME else {}
    if not isinstance(known := marker.get("version"), int):
        hint = REMOVE_HINT if ours else "Choose another folder."
        return DatasetError(f"folder was generated by {found!r:.100}, this is {GENERATOR_NAME}", file=root, hint=hint)
    own = {key: marker[key] for key in marker if key not in ("generator", "version")} or {"preset": "home"}
    python = ", ".join(f"{key}={value!r}" for key, value in own.items())
    flags = " ".join(f"--{key} {value}" for key, value in own.items())
    message = f"folder holds houses of generator version {known}, not {GENERATOR_VERSION}"
    hint = "Choose another folder: houses of older versions can be read, but no longer be added."
    if known == GENERATOR_VERSION:
        message = f"folder holds other houses than those of `{variant.options}`"
        hint = f"Add houses like its own with `{flags}` (`{python}` in Python), or choose another folder."
    return DatasetError(message, file=root, hint=REMOVE_HINT if ours else hint)


def _remove_leftovers(root: Path) -> None:
    """Remove partial folders and markers that are older than `MAX_WRITING_TIME`, left over from killed writers."""
    for path in (*root.glob(f"{PARTIAL_PREFIX}*"), *root.glob(f".{GENERATED_MARKER}.*")):
        with suppress(OSError):  # another process may be removing it
            if time.time() - path.stat().st_mtime > MAX_WRITING_TIME:
                shutil.rmtree(path) if path.is_dir() else path.unlink()


def _has_intact_house(root: Path, house: str) -> bool:
    """Return whether a house exists as it was written; remove a damaged one, because writing keeps existing houses."""
    if is_house_complete(root, house):
        return True
    if (root / "house" / house).exists():
        log.warning("broken house %s is made again", root / "house" / house)
    for kind in ("house", "room"):  # in this order, so that no house is without its rooms
        shutil.rmtree(root / kind / house, ignore_errors=True)
    return False


@contextmanager
def _pool_map(count: int) -> Iterator:
    """Yield a `map` function for `count` houses: that of a process pool if there are many houses and cores."""
    workers = max_workers(count)
    if count < MIN_POOL_HOUSES or workers < 2:
        yield map
        return
    with worker_pool(workers, imports_main=False) as pool:
        yield partial(pool.map, chunksize=4)
