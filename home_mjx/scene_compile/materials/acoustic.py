"""Acoustic properties of surfaces: absorption, scattering and transmission per octave, by texture and category.

Absorption coefficients are from Vorländer, Auralization, 2008 (source V in the table, through Pyroomacoustics'
copy; the rows of HoME are among them) and from Resonance Audio (source R). Transmission losses are handbook values of
partitions. Values at 8 kHz that the sources lack repeat the 4 kHz ones.
"""

import csv
import functools
from collections.abc import Mapping
from importlib import resources
from types import MappingProxyType

import numpy as np
from jaxtyping import Float

from home_mjx.schema.compiled import BANDS

# Row of the absorption table by texture family or material kind, independent of the category.
FAMILY_ROWS = {
    "beam": "wood_1.6cm",
    "bricks": "brick_bare",
    "carpet": "carpet_soft_10mm",
    "ceramic": "ceramic_tiles",
    "concrete": "concrete_floor",
    "decorstone": "limestone_wall",
    "decoration stone": "limestone_wall",
    "facing_stone": "ceramic_tiles",
    "facing stone": "ceramic_tiles",
    "glass": "glass_3mm",
    "grass": "carpet_hairy",
    "ground": "hard_surface",
    "laminate": "parquet_on_concrete",
    "leather": "chairs_upholstered_leather",
    "linen": "curtains_cotton_0.33",
    "linoleum": "linoleum_on_concrete",
    "lnm": "linoleum_on_concrete",
    "marble": "marble_floor",
    "metal": "metal",
    "paneling": "wood_panel",
    "paper": "curtains_cotton_0.33",
    "path": "concrete_floor",
    "plant": "curtains_cotton_0.33",
    "plastic": "hard_surface",
    "potang": "wooden_lining",
    "prkt": "parquet_on_concrete",
    "solo": "wood_1.6cm",
    "stone": "concrete_floor",
    "stucco": "plaster_rough",
    "textile": "curtains_cotton_0.33",
    "tile": "ceramic_tiles",
    "wood": "wood_1.6cm",
}

# Row of the absorption table by category, for surfaces without an entry for their texture.
CATEGORY_ROWS = {
    "wall": "gypsum_board",
    "outer_wall": "brickwork",
    "floor": "stage_floor",
    "ceiling": "ceiling_plasterboard",
    "ground": "hard_surface",
    "window": "glass_window",
    "door": "wooden_door",
    "garage_door": "metal",
    "curtain": "curtains_cotton_0.5",
    "rug": "carpet_soft_10mm",
    "person": "audience_0.72_m2",
    "pet": "curtains_cotton_0.33",
    "plant": "curtains_cotton_0.33",
    "mirror": "glass_3mm",
    "column": "concrete_floor",
    "fireplace": "brick_bare",
    "kitchen_appliance": "metal",
    "household_appliance": "metal",
    "bathtub": "ceramic_tiles",
    "sink": "ceramic_tiles",
    "toilet": "ceramic_tiles",
    "shower": "ceramic_tiles",
}

# Categories whose cloth textures are upholstery, not a printed pattern.
UPHOLSTERED = ("sofa", "armchair", "chaisse_lounge", "ottoman", "pillow", "bed", "baby_bed", "single_bed", "double_bed")
# Texture families that barely change absorption; the row of the category is used.
THIN_FACINGS = ("", "default", "wallp", "wallpaper", "paint")
CLOTH = ("linen", "textile", "leather")
# Rows of texture families on floors only.
FLOOR_ROWS = {"wood": "stage_floor", "solo": "stage_floor", "textile": "carpet_thin", "linen": "carpet_thin"}
SLOT_WORDS = {"glass": "glass_3mm", "mirror": "glass_3mm", "chrome": "metal", "metal": "metal", "steel": "metal"}

# Row of the transmission table by category. A house has one kind of partition per category, independent of its
# surface material, so that transmission through a wall is the same in both directions.
PARTITION_ROWS = {
    "wall": "stud_wall",
    "outer_wall": "brick_4_inch",
    "floor": "wood_joist_floor",
    "ceiling": "wood_joist_floor",
    "ground": "concrete_slab_8_inch",
    "window": "glass_single",
    "door": "hollow_wood_door",
    "garage_door": "metal_door",
}

SMOOTH_DEPTH, DEFAULT_DEPTH, DEEP_DEPTH = 0.01, 0.05, 0.3  # [m], structure depths for scattering
STRUCTURE_DEPTH = {
    **dict.fromkeys((*PARTITION_ROWS, "mirror", "picture_frame", "whiteboard", "rug"), SMOOTH_DEPTH),
    **dict.fromkeys(("shelving", "bookshelf", "plant"), DEEP_DEPTH),
}
DETOUR_LENGTH = 0.1  # [m], path difference of sound that bends around a piece of furniture
SPEED_OF_SOUND = 343.2  # [m/s], at 20 degrees Celsius


@functools.cache
def absorption_table() -> Mapping[str, Float[np.ndarray, " bands"]]:
    """Return random-incidence absorption coefficients per octave by name, energy fractions 0..1."""
    return _read_table("acoustic_absorption.csv")


@functools.cache
def transmission_loss_table() -> Mapping[str, Float[np.ndarray, " bands"]]:
    """Return transmission loss of partitions per octave by name [dB]."""
    return _read_table("acoustic_transmission_loss.csv")


def _read_table(name: str) -> Mapping[str, Float[np.ndarray, " bands"]]:
    """Return a table of the package with one value per band, read-only, by the names of its rows."""
    text = (resources.files("home_mjx.scene_compile.materials") / name).read_text(encoding="utf-8")
    columns = [f"{band:g}" for band in BANDS]
    return MappingProxyType(
        {row["name"]: np.array([float(row[c]) for c in columns]) for row in csv.DictReader(text.splitlines())}
    )


def scattering_coefficients(depth: float) -> Float[np.ndarray, " bands"]:
    """Return scattering coefficients per octave of a structure `depth` metres deep, by the rule of the BRAS benchmark.

    s(f) = 0.5 sqrt(depth / wavelength), within [0.05, 0.99].
    """
    wavelength = SPEED_OF_SOUND / np.array(BANDS)
    return np.clip(0.5 * np.sqrt(depth / wavelength), 0.05, 0.99)


def detour_transmission(detour: float) -> Float[np.ndarray, " bands"]:
    """Return the energy fraction per octave that bends around an obstacle, by Maekawa's insertion loss 10 lg(3 + 20 N).

    N = 2 detour / wavelength is the Fresnel number, and `detour` the additional length of the bent path [m].
    """
    wavelength = SPEED_OF_SOUND / np.array(BANDS)
    return 1 / (3 + 40 * detour / wavelength)


def absorption_name(texture_family: str, category: str, slot_name: str = "") -> str:
    """Return the name of the `absorption_table` row that `acoustic_properties` uses for the same arguments.

    The first that is known counts: slot name, curtain, upholstery, `FLOOR_ROWS`, texture family, category, wood. The
    family does not count for thin facings, nor for cloth on architecture.

    Example:
        >>> absorption_name("wallp", "wall"), absorption_name("textile", "sofa"), absorption_name("wood", "floor")
        ('gypsum_board', 'chairs_upholstered_cloth', 'stage_floor')
    """
    architecture = category in ("wall", "outer_wall", "ceiling", "floor")
    slot = next((row for word, row in SLOT_WORDS.items() if word in slot_name.lower()), None)
    if slot is not None or category == "curtain":
        return slot or CATEGORY_ROWS["curtain"]
    if category in UPHOLSTERED and texture_family in ("", *CLOTH):
        return "chairs_upholstered_leather" if texture_family == "leather" else "chairs_upholstered_cloth"
    if category == "floor" and texture_family in FLOOR_ROWS:
        return FLOOR_ROWS[texture_family]
    printed = texture_family in THIN_FACINGS or (architecture and texture_family in CLOTH)
    row = None if printed else FAMILY_ROWS.get(texture_family)
    return row or CATEGORY_ROWS.get(category, "wood_1.6cm")


def acoustic_properties(
    texture_family: str, category: str, slot_name: str = ""
) -> tuple[Float[np.ndarray, " bands"], Float[np.ndarray, " bands"], Float[np.ndarray, " bands"]]:
    """Return the acoustic properties of a surface, per octave 125 .. 8000 Hz.

    Args:
        texture_family: Texture name without numbers, such as "wallp" or "prkt", or a material kind such as
            "wallpaper"; "" or an unknown name falls back to the category.
        category: Fine or coarse category of the object, or "wall", "outer_wall", "floor", "ceiling", "ground".
        slot_name: Name of the material slot, such as "glass" or "chrome".

    Returns:
        Absorption, scattering and transmission, energy fractions 0..1. Absorption includes the transmitted energy and
        is never below it. Partitions transmit according to their table row; other surfaces transmit the energy that
        bends around them, see `detour_transmission`.
    """
    absorption = absorption_table()[absorption_name(texture_family, category, slot_name)]
    depth = STRUCTURE_DEPTH.get(category, DEFAULT_DEPTH)
    if category in PARTITION_ROWS:
        transmission = 10 ** (-transmission_loss_table()[PARTITION_ROWS[category]] / 10)
        return np.maximum(absorption, transmission), scattering_coefficients(depth), transmission
    return absorption.copy(), scattering_coefficients(depth), np.minimum(detour_transmission(DETOUR_LENGTH), absorption)
