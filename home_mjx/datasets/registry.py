"""Registry of datasets: opens houses by the folder that holds them, or by a name such as `procedural:16?seed=0`.

Host only: nothing here loads JAX. A distribution adds a dataset with an entry point of the group `home_mjx.datasets`,
whose name is the scheme and whose object is the function that opens it.
"""

import difflib
import os
import re
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

from home_mjx.core.paths import ROOT_VARIABLE, dataset_root, installed
from home_mjx.datasets.base import Dataset
from home_mjx.errors import ConfigError, DatasetError, MissingFileError, UnknownNameError, did_you_mean

LAYOUT = "A dataset root in SUNCG's format holds house/, room/, object/, texture/ and metadata/."
GROUP = "home_mjx.datasets"  # entry points that open datasets by their scheme
SUNCG = EntryPoint("suncg", "home_mjx.datasets.suncg.dataset:open_suncg", GROUP)  # opens other folders
BUILT_IN = {  # datasets of this package, which need no entry point; `recognizes` of each tells which paths are its own
    SUNCG.name: SUNCG,
    "habitat": EntryPoint("habitat", "home_mjx.datasets.habitat.dataset:HabitatDataset", GROUP),
    "front": EntryPoint("front", "home_mjx.datasets.front.dataset:FrontDataset", GROUP),
    "gltf": EntryPoint("gltf", "home_mjx.datasets.gltf.dataset:GltfDataset", GROUP),
    "mjcf": EntryPoint("mjcf", "home_mjx.datasets.mjcf.dataset:MjcfDataset", GROUP),
    "usd": EntryPoint("usd", "home_mjx.datasets.usd.dataset:UsdDataset", GROUP),
    "procthor": EntryPoint("procthor", "home_mjx.datasets.procthor.dataset:ProcthorDataset", GROUP),
}
SCHEME = re.compile(r"([a-z][a-z0-9_+-]+):(?!//|\\)(.*)", re.DOTALL)  # two letters and more: `C:` is a drive


@dataclass(frozen=True)
class DatasetFormat:
    """A registered kind of dataset.

    Attributes:
        scheme: Prefix of names, without the colon.
        open: Open the dataset of a name, without its scheme, or of a folder.
        recognizes: Return whether a folder holds a dataset of this kind; None: folders never do.
    """

    scheme: str
    open: Callable[[str], Dataset]
    recognizes: Callable[[Path], bool] | None = None


_FORMATS: dict[str, DatasetFormat] = {}


def register_dataset(
    scheme: str, open_dataset: Callable[[str], Dataset], recognizes: Callable[[Path], bool] | None = None
) -> None:
    """Register a kind of dataset under a scheme; registering the same scheme again replaces it.

    Args:
        scheme: Lower-case prefix of names, at least two characters, such as `procthor` in `procthor:train`.
        open_dataset: Function from the text after the colon, or from the path of a folder, to a `Dataset`.
        recognizes: Function that returns whether a folder holds such a dataset, so that paths open without a scheme.

    Raises:
        ConfigError: The scheme has another form, or an argument cannot be called.

    Example:
        >>> register_dataset("boxes", lambda name: BoxDataset(int(name)))  # doctest: +SKIP
        >>> open_dataset("boxes:12").house_ids  # doctest: +SKIP
    """
    if not isinstance(scheme, str) or not SCHEME.fullmatch(f"{scheme}:"):
        raise ConfigError(f"scheme of a dataset must be a lower-case word, got {scheme!r}", hint="Such as `procthor`.")
    if not callable(open_dataset) or not (recognizes is None or callable(recognizes)):
        raise ConfigError(f"dataset `{scheme}` needs functions `open_dataset` and, optionally, `recognizes`")
    _FORMATS[scheme] = DatasetFormat(scheme, open_dataset, recognizes)


def dataset_schemes() -> tuple[str, ...]:
    """Return all schemes of datasets, registered or installed, sorted."""
    return tuple(sorted({*_FORMATS, *_installed()}))


def has_scheme(name: object) -> bool:
    """Return whether a value is a name such as `procedural:16`; False for existing paths and other types than `str`.

    The scheme need not be known.

    Example:
        >>> has_scheme("procedural:16"), has_scheme("houses/demo"), has_scheme("C:/houses")
        (True, False, False)
    """
    return isinstance(name, str) and SCHEME.fullmatch(name) is not None and not os.path.exists(name)


def open_dataset(name: str | Path | None = None) -> Dataset:
    """Open a dataset by its folder or its name.

    A path belongs to the first dataset that recognizes it, else it is a folder that is read as SUNCG's.

    Args:
        name: Folder or file of a dataset, or a scheme and what follows it, such as `procedural:16?seed=0`; None: the
            folder that the environment variable `SUNCG_DATA_DIR` names.

    Raises:
        UnknownNameError: No dataset has this scheme.
        ConfigError: The text after the scheme is not valid.
        MissingFileError: The folder does not exist or holds no house.
        DatasetError: No folder was given, or the path is a file that no dataset recognizes.

    Example:
        >>> open_dataset("procedural:2?seed=3").house_ids[0]
        '686f6d65000005000000000000000003'
    """
    if isinstance(name, str) and has_scheme(name):
        match = SCHEME.fullmatch(name)
        assert match is not None
        return find_format(match[1]).open(match[2])
    root = dataset_root() if name is None else name
    if root is None or not str(root):
        hint = f"Pass a folder, a name such as `procedural:16`, or set {ROOT_VARIABLE}. {LAYOUT}"
        raise DatasetError("no dataset root was specified", hint=hint)
    path = Path(os.path.abspath(Path(root).expanduser()))
    for known in _known_formats(path):
        if known.recognizes is not None and path.exists() and known.recognizes(path):
            return known.open(str(path))
    if not os.path.exists(path):
        hint = (_name_hint(str(name)) if name is not None else None) or f"Correct the path or {ROOT_VARIABLE}. {LAYOUT}"
        raise MissingFileError("dataset root is not a folder", file=path, hint=hint)
    if not path.is_dir():
        hint = "Name a folder, or a file of houses with its scheme, such as `procthor:PATH`."
        raise DatasetError("dataset root is not a folder, nor a file of a known format", file=path, hint=hint)
    return find_format(SUNCG.name).open(str(path))


def _name_hint(text: str) -> str | None:
    """Return a hint for a missing path that was probably meant as a name with a scheme; None for other paths.

    Example:
        >>> _name_hint("Procedual:4")
        'Names of datasets begin with a scheme and a colon: did you mean `procedural:4`?'
        >>> _name_hint("houses/demo") is None
        True
    """
    match = re.fullmatch(r"([A-Za-z_+-]{2,})(:?)(?://)?([\w?=&.-]*)", text)
    close = difflib.get_close_matches(match[1].lower(), dataset_schemes(), n=1, cutoff=0.75) if match else []
    if not match or not close:
        return None
    meant = f"{close[0]}:{match[3] or 'N'}"
    return f"Names of datasets begin with a scheme and a colon: did you mean `{meant}`?"


def find_format(scheme: str) -> DatasetFormat:
    """Return the registered kind of dataset of a scheme; register it first from an installed package if necessary.

    Raises:
        UnknownNameError: No dataset has this scheme.
        ConfigError: The package that provides it cannot be imported.
    """
    if scheme not in _FORMATS:
        found = _installed().get(scheme)
        if found is None:
            raise UnknownNameError(
                f"no dataset has the scheme `{scheme}:`", hint=did_you_mean(scheme, dataset_schemes())
            )
        opener = _loaded(found)
        _FORMATS[scheme] = DatasetFormat(scheme, opener, getattr(opener, "recognizes", None))
    return _FORMATS[scheme]


def _installed() -> dict[str, Any]:
    """Return the entry points of installed datasets by scheme, including those of this package."""
    return {**BUILT_IN, **installed(GROUP)}


def _known_formats(path: Path) -> list[DatasetFormat]:
    """Return the datasets that may recognize a path: those of this package only if it is no folder of SUNCG's."""
    own = () if (path / "house").is_dir() else BUILT_IN
    return [
        find_format(scheme) for scheme in dict.fromkeys((*_FORMATS, *own)) if scheme in own or scheme not in BUILT_IN
    ]


def _loaded(point: Any) -> Any:
    """Import the object of an entry point; raise `ConfigError` if its module or attribute cannot be imported."""
    try:
        return point.load()
    except (ImportError, AttributeError) as error:
        raise ConfigError(f"dataset `{point.name}:` of `{point.value}` cannot be loaded: {error}") from error
