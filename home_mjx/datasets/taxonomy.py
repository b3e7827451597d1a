"""Words of other datasets for kinds of objects, mapped to fine categories; the table is `taxonomy.csv`.

Sources are `ai2thor` (ProcTHOR, Holodeck, MolmoSpaces), `future3d` (3D-FUTURE), `hssd` (HSSD and WordNet), `mpcat40`
(Matterport3D, HM3D), `replicacad` and `robocasa`. Kinds of movable parts come from words as well.
"""

import csv
import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from home_mjx.core.files import read_text
from home_mjx.schema.categories import FINE
from home_mjx.schema.house import JointKind

TABLE = Path(__file__).with_name("taxonomy.csv")
UNKNOWN = "unknown"
MIN_PART, MIN_NAME = 3, 5  # minimum length of a word or, else, of a name that is found as the start or end of a text
PART_WORD = re.compile("burner|button|drawer|door|flap|handle|knob|lever|(?<!s)lid|light|spout|switch")
MIN_UPRIGHT = 0.7  # minimum vertical component of the unit axis of a hinge that carries a door
NO_KINDS = (UNKNOWN, "empty")  # categories that are no kinds of objects
# Fine category -> coarse and NYU40 category, of those that SUNCG v2 added or that no model of furniture has.
CLASSES: Mapping[str, tuple[str, str]] = {
    "arch": ("arch", "door"),
    "ceiling": ("ceiling", "ceiling"),
    "cooker": ("kitchen_appliance", "otherprop"),
    "lounge_chair": ("chair", "chair"),
    "wall": ("wall", "wall"),
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
def vocabulary(source: str) -> Mapping[str, str]:
    """Return the fine category of each word of a source, and of the names of categories themselves.

    Example:
        >>> vocabulary("ai2thor")["tablelamp"]
        'table_lamp'
    """
    return {**{plain_word(name): name for name in FINE if name not in NO_KINDS}, **taxonomy(source)}


@cache
def find_word(source: str, text: str) -> str:
    """Return the word of `vocabulary` that a text is, begins with or ends with, the longest one; "" if there is none.

    In a text of several words the last one counts.

    Example:
        >>> find_word("ai2thor", "RoboTHOR_dining_table_jokkmokk_v"), find_word("ai2thor", "wooden sofa-0")
        ('diningtable', 'sofa')
    """
    words, plain = vocabulary(source), plain_word(text)
    if plain in words:
        return plain
    long = [word for word in words if len(word) >= (MIN_PART if word in taxonomy(source) else MIN_NAME)]
    ends = [word for word in long if plain.endswith(word)]
    starts = [word for word in long if plain.startswith(word)] if " " not in text or not ends else []
    return max((*ends, *starts), key=len, default="")


def fine_category(source: str, text: str) -> str:
    """Return the fine category of a word of a source, see `find_word`; `unknown` if there is none.

    Example:
        >>> fine_category("ai2thor", "Dresser"), fine_category("ai2thor", "Unicorn")
        ('dresser', 'unknown')
    """
    return vocabulary(source).get(find_word(source, text), UNKNOWN)


def part_kind(kind: JointKind, upright: float, *names: str) -> str:
    """Return the kind of a movable part: the last known word of the first name that has one, else by its motion.

    Slides without a word are drawers, upright hinges doors, and other hinges flaps.

    Args:
        kind: Motion of the part.
        upright: Vertical component of the joint's unit axis in the house.
        *names: Names of the joint and of what it moves, in order of priority.

    Example:
        >>> part_kind("hinge", 0.0, "stovetop_knob_center"), part_kind("slide", 0.0, "left_slide_top")
        ('knob', 'drawer')
    """
    for name in names:
        found = PART_WORD.findall(name.lower())
        if found:
            return found[-1]
    if kind == "slide":
        return "drawer"
    return "door" if abs(upright) >= MIN_UPRIGHT else "flap"
