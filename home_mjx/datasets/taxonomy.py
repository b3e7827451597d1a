"""Words of other datasets for kinds of objects, mapped to fine categories; the table is `taxonomy.csv`."""

import csv
import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from home_mjx.core.files import read_text

TABLE = Path(__file__).with_name("taxonomy.csv")
UNKNOWN = "unknown"
MIN_PART = 3  # minimum length of a word that is found as the start or the end of another one
# Fine category -> coarse and NYU40 category, of those that SUNCG v2 added or that no model of furniture has.
CLASSES: Mapping[str, tuple[str, str]] = {
    "arch": ("arch", "door"),
    "blinds": ("curtain", "blinds"),
    "counter": ("counter", "counter"),
    "door": ("door", "door"),
    "floor": ("floor", "floor"),
    "fork": ("kitchenware", "otherprop"),
    "knife": ("kitchenware", "otherprop"),
    "nightstand": ("stand", "night_stand"),
    "shower_faucet": ("bathroom_stuff", "otherprop"),
    "spoon": ("kitchenware", "otherprop"),
    "stool": ("chair", "chair"),
    "unknown": ("unknown", "void"),
    "wall_shelf": ("shelving", "shelves"),
}


@cache
def taxonomy(source: str) -> Mapping[str, str]:
    """Return the fine category of each word of a source, such as `ai2thor`; empty for unknown sources.

    Example:
        >>> taxonomy("ai2thor")["armchair"]
        'armchair'
    """
    rows = csv.DictReader(read_text(TABLE).splitlines())
    return {row["word"]: row["fine"] for row in rows if row["source"] == source}


def plain_word(text: str) -> str:
    """Return the letters of a text in lower case, which is how words are written in the table.

    Example:
        >>> plain_word("TV_Stand_221")
        'tvstand'
    """
    return re.sub(r"[^a-z]", "", text.lower().removeprefix("robothor"))


@cache
def find_word(source: str, text: str) -> str:
    """Return the word of a source that a text is, begins with or ends with, the longest one; "" if there is none.

    Example:
        >>> find_word("ai2thor", "RoboTHOR_dining_table_jokkmokk_v"), find_word("ai2thor", "wooden sofa-0")
        ('diningtable', 'sofa')
    """
    words, plain = taxonomy(source), plain_word(text)
    if plain in words:
        return plain
    long = [word for word in words if len(word) >= MIN_PART]
    for found in ([w for w in long if plain.startswith(w)], [w for w in long if plain.endswith(w)]):
        if found:
            return max(found, key=len)
    return ""


def fine_category(source: str, text: str) -> str:
    """Return the fine category of a word of a source, see `find_word`; `unknown` if there is none.

    Example:
        >>> fine_category("ai2thor", "Dresser"), fine_category("ai2thor", "Unicorn")
        ('dresser', 'unknown')
    """
    return taxonomy(source).get(find_word(source, text), UNKNOWN)
