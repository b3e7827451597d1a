"""Card of a clicked object, from the bank's semantics and materials."""

from collections.abc import Mapping

import numpy as np

from home_mjx.bank.bank import HouseBank
from home_mjx.scene_compile import decode_row
from home_mjx.schema.categories import FINE
from home_mjx.schema.semantic import Semantic
from home_mjx.viewer.browser.markdown import escape_markdown, format_table
from home_mjx.viewer.browser.scene.house_scene import InstanceGroup
from home_mjx.viewer.browser.scene.models import find_triangles

COLOUR_COLUMNS = ("css", "css_2", "css_3")
SHOWN_BANDS, FIRST_OCTAVE = (0, 3, 6), 125  # octaves of absorption that are shown; centre of the first one [Hz]
UNNAMED = ("empty", "unknown")  # fine categories that are called "object"
SUPPORT_PHRASES = {"floor": "stands on the floor", "wall": "is on the wall", "ceiling": "hangs from the ceiling"}


def format_card(
    bank: HouseBank, house: int, group: InstanceGroup, index: int, condition: Mapping[str, str] | None = None
) -> str:
    """Format category, size, colours, material, mass, absorption, place and a sentence of an instance as Markdown.

    Args:
        bank: The houses.
        house: Index of the house.
        group: Group of the instance.
        index: Number of the instance in the group.
        condition: Further lines by name, such as those of `describe_condition`; None: none.
    """
    known = decode_row(np.asarray(bank.semantics)[group.semantic[index]])
    colours = [str(known[name]) for name in COLOUR_COLUMNS if name in known]
    category = _words(known.get("fine", "object"))
    size = _size(bank, house, int(group.objects[index]))
    movable = int(np.asarray(bank.semantics)[group.semantic[index], Semantic.MOVABLE])
    mass = float(bank.physics.body_mass[house, movable]) if movable >= 0 else None
    room = f"{_words(known['room_type'])}, room {known.get('room')}" if "room_type" in known else None
    lines = {
        "colours": ", ".join(colours),
        "material": known.get("material"),
        "size": f"{known.get('size', '')} {size}".strip(),
        "mass": "fixed" if mass is None else f"{mass:.2f} kg",
        "absorption": describe_absorption(bank, house, int(group.objects[index])),
        "support": known.get("support"),
        "room": room,
        "storey": known.get("level"),
        "object id": int(group.objects[index]),
        **(condition or {}),
    }
    look = " ".join([*([colours[0]] if colours else ()), category])
    made = f" of {known['material']}" if "material" in known else ""
    article = "An" if look[0] in "aeiou" else "A"
    sentence = f"{article} {look}{made} {_support(bank, house, known)}{f' in the {room}' if room else ''}."
    table = format_table({name: value for name, value in lines.items() if value not in (None, "")})
    return "\n".join([f"**{escape_markdown(category)}**", "", escape_markdown(sentence), "", table])


def name_object(fine: int) -> str:
    """Return the words of a fine category, by its index; "object" if it is unknown."""
    return _words(FINE[fine] if fine >= 0 else "object")


def describe_absorption(bank: HouseBank, house: int, object_id: int) -> str:
    """Return the energy fractions that an object's surfaces absorb, by area; "" for agents."""
    rows = np.flatnonzero(np.asarray(bank.geometry.instance_object[house]) == object_id)
    if not len(rows):
        return ""
    model, first = (int(x[house, rows[0]]) for x in (bank.geometry.instance_model, bank.geometry.instance_material))
    triangle = find_triangles(bank, model)
    corners = np.asarray(bank.geometry.triangle)[triangle]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    absorbed = np.asarray(bank.materials.absorption)[first + np.asarray(bank.geometry.triangle_slot)[triangle]]
    mean = np.average(absorbed, axis=0, weights=np.maximum(area, 1e-12))
    shares = " / ".join(f"{100 * mean[band]:.0f}" for band in SHOWN_BANDS)
    return f"{shares} % at {' / '.join(str(FIRST_OCTAVE * 2**band) for band in SHOWN_BANDS)} Hz"


def _size(bank: HouseBank, house: int, object_id: int) -> str:
    """Return width, depth and height in the object's own frame [m] as a text; "" for agents."""
    rows = np.flatnonzero(np.asarray(bank.geometry.instance_object[house]) == object_id)
    if not len(rows):
        return ""
    box = np.asarray(bank.geometry.model_box[int(bank.geometry.instance_model[house, rows[0]])])
    scale = np.linalg.norm(np.asarray(bank.geometry.instance_pose[house, rows[0]])[:, :3], axis=0)
    width, depth, height = ((box[1] - box[0]) * scale).tolist()
    return f"{width:.2f} × {depth:.2f} × {height:.2f} m"


def _support(bank: HouseBank, house: int, known: dict[str, str | int | tuple[str, ...]]) -> str:
    """Return the predicate of an object's support, such as `is on the table`."""
    for column, preposition in (("container", "in"), ("supporter", "on")):
        if column in known:
            row = int(bank.geometry.object_semantic[house, int(known[column])])  # pyright: ignore[reportArgumentType]
            holder = decode_row(np.asarray(bank.semantics[row])).get("fine", "object")
            return f"is {preposition} the {_words(holder)}"
    return SUPPORT_PHRASES.get(str(known.get("support")), "is here")


def _words(name: object) -> str:
    """Return a name in words: spaces for underscores, lower case; "object" for unnamed categories."""
    return "object" if name in UNNAMED else str(name).replace("_", " ").lower()
