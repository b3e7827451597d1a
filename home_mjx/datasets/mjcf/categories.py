"""Categories of bodies by their names, in the conventions of RoboCasa and MolmoSpaces or by words."""

import json
import re
from collections.abc import Mapping
from pathlib import Path

from home_mjx.core.files import is_file, read_text
from home_mjx.datasets.gltf.categories import WORD, category_words, find_category
from home_mjx.datasets.suncg.formats.json_value import JsonValue
from home_mjx.datasets.taxonomy import UNKNOWN, fine_category, plain_word, vocabulary
from home_mjx.errors import DatasetError

MAX_METADATA_BYTES = 1 << 26  # [bytes], maximum size of a file of MolmoSpaces
ROBOCASA = re.compile(r"(.+?)_(?:[a-z]+_group_.*|room_main)")  # <kind>_<n>_<group>_group_main, <kind>_room_main
MIN_END = 4  # minimum length of a word with which a longer one ends
MOLMO_ROOM = re.compile(r"room_[0-9]+")


def metadata_path(scene: Path) -> Path:
    """Return the path of MolmoSpaces' metadata of a scene, which scenes with a ceiling share with those without."""
    return scene.with_name(f"{scene.stem.removesuffix('_ceiling')}_metadata.json")


def read_body_words(scene: Path) -> Mapping[str, str]:
    """Return MolmoSpaces' word for each body from the metadata beside a scene; empty if there is none.

    Raises:
        DatasetError: The metadata are not JSON, or a category is not a text.
    """
    path = metadata_path(scene)
    if not is_file(path):
        return {}
    try:
        value = JsonValue(path, "", json.loads(read_text(path, max_bytes=MAX_METADATA_BYTES)))
    except (ValueError, RecursionError) as error:
        if isinstance(error, DatasetError):
            raise
        raise DatasetError(f"not valid JSON: {error}", file=path, hint="Fetch it again.") from None
    objects = value.member("objects")
    objects.member("")  # raises unless it is an object
    words = {name: objects.member(name).member("category") for name in objects.data}
    return {name: word.text() for name, word in words.items() if word.has_value}


def body_category(name: str, word: str = "") -> str:
    """Return the fine category of a body; "" if neither its name nor MolmoSpaces' word is known.

    Example:
        >>> body_category("counter_corner_2_main_group_main"), body_category("stack_1_left_group_base_main")
        ('counter', 'kitchen_cabinet')
        >>> body_category("Desk_lamp"), body_category("hingecabinet2"), body_category("room_3"), body_category("body7")
        ('table_lamp', 'kitchen_cabinet', 'floor', '')
    """
    if word and (fine := fine_category("ai2thor", word)) != UNKNOWN:
        return fine
    if MOLMO_ROOM.fullmatch(name):
        return "floor"
    kind = robocasa_kind(name)
    return _longest_run(kind) if kind else find_category(name) or _word_end(name)


def robocasa_kind(name: str) -> str:
    """Return the kind of a fixture from its name; "" for other names.

    Example:
        >>> robocasa_kind("wall_left_backing_room_main"), robocasa_kind("cab_2_left_group_main")
        ('wall_left_backing', 'cab_2')
    """
    found = ROBOCASA.fullmatch(name)
    return found[1] if found else ""


def is_backing(name: str) -> bool:
    """Return whether a body is the second, outer layer of a wall or floor of RoboCasa."""
    return "backing" in robocasa_kind(name).split("_")


def _word_end(name: str) -> str:
    """Return the fine category of the longest word that the last word of a name, or its singular, ends with."""
    words = [word.lower() for word in WORD.findall(name)]
    last = {words[-1], words[-1].removesuffix("s")} if words else set()
    ends = [word for word in category_words() if len(word) >= MIN_END and any(text.endswith(word) for text in last)]
    return category_words()[max(ends, key=len)] if ends else ""


def _longest_run(kind: str) -> str:
    """Return the fine category of the longest run of words that RoboCasa's table has, the last of equal ones."""
    words, known = [plain_word(word) for word in WORD.findall(kind)][:20], vocabulary("robocasa")
    runs = [(stop - start, stop, "".join(words[start:stop])) for stop in range(len(words) + 1) for start in range(stop)]
    found = [(length, stop, known[text]) for length, stop, text in runs if text in known]
    return max(found)[2] if found else ""
