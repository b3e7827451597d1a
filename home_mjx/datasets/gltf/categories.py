"""Categories of nodes by the words in their names, from the table `categories.csv`."""

import csv
import re
from collections.abc import Mapping
from functools import cache
from importlib.resources import files

from home_mjx.schema.house import Metadata, ModelInfo

ARCHITECTURE = ("wall", "floor", "ceiling", "roof", "column")  # fine categories that are parts of the house
STRUCTURE = "structure"  # model id of architecture that is no wall, floor or ceiling
WORD = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")


@cache
def _rows() -> tuple[dict[str, str], ...]:
    """Return the rows of the table."""
    text = files("home_mjx.datasets.gltf").joinpath("categories.csv").read_text(encoding="utf-8")
    return tuple(csv.DictReader(text.splitlines()))


@cache
def category_words() -> Mapping[str, str]:
    """Return the fine category of each word, or of several with spaces."""
    return {words: row["fine"] for row in _rows() for words in row["words"].split("/")}


@cache
def category_metadata() -> Metadata:
    """Return the metadata of all models: a model's id is its fine category."""
    return Metadata({row["fine"]: ModelInfo(row["fine"], row["fine"], row["coarse"], row["nyu40"]) for row in _rows()})


def find_category(name: str) -> str:
    """Return the fine category that a name tells: by its longest run of known words, the last of equal ones.

    Example:
        >>> find_category("Kitchen_DiningTable.001"), find_category("Cube.003")
        ('dining_table', '')
    """
    words = [word.lower() for word in WORD.findall(name)][:20]
    runs = [
        (stop - start, stop, " ".join(words[start:stop])) for stop in range(len(words) + 1) for start in range(stop)
    ]
    found = [(length, stop, category_words()[text]) for length, stop, text in runs if text in category_words()]
    return max(found)[2] if found else ""
