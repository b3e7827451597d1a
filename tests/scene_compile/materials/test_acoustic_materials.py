"""The acoustic tables and the way from a texture and a category to a row."""

import json
from pathlib import Path

import numpy as np
import pyroomacoustics
import pytest

from home_mjx.scene_compile.materials import acoustic as am
from home_mjx.schema.material_kinds import CATEGORY_KINDS, TEXTURE_KINDS

FAMILIES = ["", *TEXTURE_KINDS, *TEXTURE_KINDS.values(), *CATEGORY_KINDS.values(), "unheard_of"]
CATEGORIES = [*am.PARTITION_ROWS, *CATEGORY_KINDS, "unheard_of"]


def test_absorption_equals_pyroomacoustics_copy_of_vorlaenders_table():
    """Every row that both have is the same."""
    path = Path(pyroomacoustics.__file__).parent / "data" / "materials.json"
    groups = json.loads(path.read_text(encoding="utf-8"))["absorption"]
    theirs = {name: row["coeffs"] for group in groups.values() for name, row in group.items()}
    ours = am.absorption_table()
    # our gypsum board is the plain one of Resonance Audio, theirs a perforated absorber
    common = (set(theirs) & set(ours)) - {"gypsum_board"}
    assert len(common) > 55
    for name in common:
        np.testing.assert_allclose(ours[name][: len(theirs[name])], theirs[name], err_msg=name)


def test_every_name_leads_to_a_row_of_energy_fractions():
    """Nothing is lost between the mapping and the tables, and no surface creates energy."""
    for family in FAMILIES:
        for category in CATEGORIES:
            absorption, scatter, transmission = am.acoustic_properties(family, category)
            for value in (absorption, scatter, transmission):
                assert value.shape == (7,)
                assert np.all((value > 0) & (value <= 1)), (family, category)
            assert np.all(transmission <= absorption), (family, category)


@pytest.mark.parametrize(
    ("category", "loss"),
    [
        ("wall", [17, 31, 33, 40, 38, 36, 36]),
        ("outer_wall", [32, 34, 40, 47, 55, 61, 61]),
        ("floor", [23, 32, 36, 45, 49, 56, 56]),
        ("window", [18, 21, 26, 31, 33, 22, 22]),
        ("door", [14, 19, 23, 18, 17, 21, 21]),
    ],
)
def test_partitions_lose_the_table_value_whatever_faces_them(category, loss):
    """Even tiles, which absorb less than a stud wall lets through."""
    for family in FAMILIES:
        transmission = am.acoustic_properties(family, category)[2]
        np.testing.assert_allclose(-10 * np.log10(transmission), loss, rtol=1e-6)


@pytest.mark.parametrize(
    ("family", "category", "slot", "row"),
    [
        ("", "wall", "", "gypsum_board"),
        ("linen", "ceiling", "", "ceiling_plasterboard"),  # HoME hung a curtain there
        ("bricks", "wall", "", "brick_bare"),
        ("prkt", "floor", "", "parquet_on_concrete"),
        ("wood", "floor", "", "stage_floor"),
        ("carpet", "floor", "", "carpet_soft_10mm"),
        ("textile", "sofa", "", "chairs_upholstered_cloth"),
        ("leather", "sofa", "", "chairs_upholstered_leather"),
        ("wood", "sofa", "", "wood_1.6cm"),
        ("", "curtain", "", "curtains_cotton_0.5"),
        ("", "table", "glass_1", "glass_3mm"),
        ("", "table", "", "wood_1.6cm"),
    ],
)
def test_surfaces_sound_like_what_they_are_made_of(family, category, slot, row):
    assert am.absorption_name(family, category, slot) == row


def test_scattering_follows_the_reference_values():
    """Reference values of the rule for depths of 1, 5 and 30 cm, 125 .. 4000 Hz."""
    expected = {
        0.01: [0.05, 0.05, 0.06, 0.09, 0.12, 0.17],
        0.05: [0.07, 0.10, 0.14, 0.19, 0.27, 0.38],
        0.3: [0.17, 0.23, 0.33, 0.47, 0.66, 0.94],
    }
    for depth, values in expected.items():
        np.testing.assert_allclose(am.scattering_coefficients(depth)[:6], values, atol=0.006)
