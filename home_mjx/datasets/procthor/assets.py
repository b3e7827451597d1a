"""Kind and size of AI2-THOR's models: from its asset database if there is one, else typical ones of the kind."""

import csv
import hashlib
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from importlib.util import find_spec
from pathlib import Path

from home_mjx.core.files import is_file, read_bytes, read_text
from home_mjx.datasets.suncg.formats.json_value import JsonValue, read_json
from home_mjx.datasets.taxonomy import find_word, plain_word
from home_mjx.errors import DatasetError, MissingFileError

Edges = tuple[float, float, float]
FILE = "asset-database.json"
TYPICAL = Path(__file__).with_name("typical_sizes.csv")
FOOT = 0.3048  # [m]
WORKTOP_HEIGHT = 0.94  # [m]
MIN_EDGE = 0.004  # [m], of the box of a model; a compact disc is thinner
MAX_EDGE = 20.0  # [m]


@dataclass(frozen=True)
class ThorAsset:
    """What is known of a model.

    Attributes:
        word: Its kind, a word of the taxonomy; "" if unknown.
        size: Extents of its box along x, y, z [m].
        is_known: Whether the database has it; else the size is the typical one of its kind.
    """

    word: str
    size: Edges | None
    is_known: bool


@dataclass(frozen=True)
class AssetTable:
    """Models of a database.

    Attributes:
        path: The database; None: there is none.
        rows: Kind and size by name of the model.
        digest: Digest of the file.
    """

    path: Path | None
    rows: Mapping[str, ThorAsset]
    digest: bytes

    def find(self, asset: str, kind: str) -> ThorAsset:
        """Return what is known of a model.

        Args:
            asset: Its name, such as `Dresser_315_1`.
            kind: Kind of the object in the house, such as `Dresser`.
        """
        found = self.rows.get(asset)
        if found is not None:
            return found
        word = find_word("ai2thor", kind) or find_word("ai2thor", asset)
        return ThorAsset(word, named_size(asset) or typical_sizes().get(word), False)


def named_size(asset: str) -> Edges | None:
    """Return the size of a worktop [m], whose name has its width and depth in feet; None for other models.

    Example:
        >>> tuple(round(edge, 2) for edge in named_size("Countertop_L_6x8"))
        (1.83, 0.94, 2.44)
    """
    found = re.fullmatch(r"Countertop_[A-Za-z]+_(\d{1,2})x(\d{1,2})", asset)
    return None if found is None else (max(int(found[1]), 1) * FOOT, WORKTOP_HEIGHT, max(int(found[2]), 1) * FOOT)


@cache
def typical_sizes() -> Mapping[str, Edges]:
    """Return the median extents of the models of each kind [m]."""
    rows = csv.DictReader(read_text(TYPICAL).splitlines())
    return {row["word"]: (float(row["x"]), float(row["y"]), float(row["z"])) for row in rows}


def find_database(named: Path | None, houses: Path) -> Path | None:
    """Return the path of the asset database; None if there is none.

    It is `named`, else beside the houses or in a folder `databases` near them, else in the installed package
    `procthor`, which is not imported.

    Raises:
        MissingFileError: `named` does not exist.
    """
    if named is not None:
        path = named / FILE if named.is_dir() else named
        if not is_file(path):
            raise MissingFileError("asset database is missing", file=path, hint="It is `asset-database.json`.")
        return path
    folder = houses if houses.is_dir() else houses.parent
    places = [folder, folder / "databases", folder.parent / "databases"]
    spec = find_spec("procthor")
    places += [Path(place) / "databases" for place in (spec.submodule_search_locations or ())] if spec else []
    return next((place / FILE for place in places if is_file(place / FILE)), None)


def read_assets(path: Path | None) -> AssetTable:
    """Read an asset database; without one, the table is empty.

    Raises:
        DatasetError: The file is broken; the message names the element.
    """
    if path is None:
        return AssetTable(None, {}, b"")
    return _read(path, path.stat().st_mtime_ns)


@lru_cache(maxsize=4)
def _read(path: Path, stamp: int) -> AssetTable:
    document = read_json(path)
    if not isinstance(document.data, dict):
        raise DatasetError("expected an object with a list of models for each kind", file=path)
    rows = {}
    for kind in document.data:
        word = find_word("ai2thor", kind) or plain_word(kind)
        for row in document.member(kind).entries():
            rows[row.member("assetId").text()] = ThorAsset(word, _edges(row.member("boundingBox")), True)
    return AssetTable(path, rows, hashlib.sha256(read_bytes(path)).digest())


def _edges(box: JsonValue) -> Edges:
    x, y, z = (box.member(axis).number() for axis in "xyz")
    if not all(0 <= edge <= MAX_EDGE and math.isfinite(edge) for edge in (x, y, z)):
        raise box.error(f"expected extents between 0 and {MAX_EDGE:g} m")
    return max(x, MIN_EDGE), max(y, MIN_EDGE), max(z, MIN_EDGE)
