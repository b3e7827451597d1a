"""Colours and materials of surfaces whose answer is known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from home_mjx.core.color import srgb_to_lab
from home_mjx.errors import ConfigError, DatasetError
from home_mjx.scene_compile.materials.surface import SurfaceMaterial
from home_mjx.scene_compile.semantics.appearance import (
    MAX_SHADE_DISTANCE,
    SemanticOptions,
    TexturedTriangles,
    compute_appearance,
    dominant_colors,
    surface_colors,
)
from home_mjx.schema.material_kinds import CATEGORY_KINDS, HOME_TEXTURE_KINDS, MATERIAL_KINDS, TEXTURE_KINDS

QUAD = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], float)  # texture coordinates of a whole image
DEFAULT = SemanticOptions()
RED, WHITE = (255, 0, 0), (255, 255, 255)


def skin(areas: list[float], surfaces: list[SurfaceMaterial], uv: np.ndarray = QUAD) -> TexturedTriangles:
    """Two triangles per surface, of the given areas together."""
    half = np.repeat(np.array(areas) / 2, 2)
    return TexturedTriangles(
        half, np.tile(uv, (len(areas), 1, 1)), np.repeat(np.arange(len(areas)), 2), tuple(surfaces)
    )


@pytest.fixture
def picture(tmp_path):
    """A function that writes an image of colour rows, top row first."""

    def write(name: str, rows: list[list[tuple]]) -> str:
        Image.fromarray(np.array(rows, np.uint8)).save(tmp_path / f"{name}.png")
        return str(tmp_path / f"{name}.png")

    return write


def css(item: TexturedTriangles, options: SemanticOptions = DEFAULT) -> tuple[str, ...]:
    return compute_appearance(item, options).colors["css"]


def test_colours_come_by_area():
    surfaces = [SurfaceMaterial((1, 0, 0)), SurfaceMaterial((0, 0, 1)), SurfaceMaterial((0, 0.5, 0))]
    assert css(skin([1.0, 3.0, 0.5], surfaces)) == ("blue", "red")
    assert css(skin([1.0, 3.0, 0.5], surfaces), SemanticOptions(share=0.1)) == ("blue", "red", "green")


def test_the_foremost_colour_is_named_even_if_none_covers_enough():
    grays = [SurfaceMaterial((x, 0.9 - x, x)) for x in np.linspace(0, 0.9, 12)]
    assert len(css(skin([1.0] * 12, grays), SemanticOptions(share=1.0))) == 1


def test_a_pattern_gives_its_colours_and_not_their_mean(picture):
    chequered = picture("chequers", [[RED] * 8 + [WHITE] * 8] * 8 + [[WHITE] * 8 + [RED] * 8] * 8)
    assert set(css(skin([1.0], [SurfaceMaterial(texture=chequered)]))) == {"red", "white"}


def test_a_grain_gives_one_colour(picture):
    rng = np.random.default_rng(0)
    grain = picture("wood_1", (np.array([139, 69, 19]) + rng.integers(-15, 15, (32, 32, 1))).tolist())
    assert css(skin([1.0], [SurfaceMaterial(texture=grain)])) == ("saddle brown",)


def test_only_the_part_of_an_image_that_is_used_counts(picture):
    """The upper half is red: v = 1 is the top of an image."""
    halves = picture("halves", [[RED] * 4] * 2 + [[(0, 0, 255)] * 4] * 2)
    for low, high, name in ((0.5, 1.0, "red"), (0.0, 0.5, "blue"), (7.5, 8.0, "red"), (-1.0, -0.5, "blue")):
        uv = QUAD * [1, high - low] + [0, low]
        assert css(skin([1.0], [SurfaceMaterial(texture=halves)], uv)) == (name,)


def test_the_diffuse_colour_multiplies_the_image_in_linear_light(picture):
    gray = picture("gray", [[(188, 188, 188)] * 2] * 2)  # half of white in linear light
    lab, weight = surface_colors(skin([1.0], [SurfaceMaterial((0.735356983, 0.0, 1.0), texture=gray)]))
    expected = srgb_to_lab(np.array([[0.5371, 0.0, 0.7369]]))
    np.testing.assert_allclose(np.average(lab, axis=0, weights=weight), expected[0], atol=0.2)


def test_clear_surfaces_count_by_their_opacity(picture):
    glass, frame = SurfaceMaterial((0, 0, 1), opacity=0.1), SurfaceMaterial((1, 0, 0))
    assert css(skin([2.0, 1.0], [glass, frame])) == ("red",)
    assert css(skin([1.0], [SurfaceMaterial((0, 0, 1), opacity=0.0)])) == ("blue",)
    leaf = picture("leaf_1", [[(0, 128, 0, 255), (255, 0, 0, 0)]] * 2)
    assert css(skin([1.0], [SurfaceMaterial(texture=leaf)])) == ("green",)


@given(
    st.lists(st.tuples(*[st.floats(0, 1)] * 3, st.floats(0.01, 1)), min_size=1, max_size=30),
)
def test_dominant_colours_part_the_weight(colors):
    """Shares add up to one and fall; each colour is a mean of given ones, so within their hull's bounds."""
    lab, weight = srgb_to_lab(np.array(colors)[:, :3]), np.array(colors)[:, 3]
    found, share = dominant_colors(lab, weight)
    assert share.sum() == pytest.approx(1)
    assert (np.diff(share) <= 1e-12).all()
    np.testing.assert_allclose(share @ found, np.average(lab, axis=0, weights=weight), atol=1e-6)
    assert (found >= lab.min(axis=0) - 1e-6).all()
    assert (found <= lab.max(axis=0) + 1e-6).all()


@given(st.floats(0, 1), st.floats(0, 1), st.floats(0, 1))
def test_shades_of_one_colour_are_one(red, green, blue):
    base = srgb_to_lab(np.array([[red, green, blue]]))
    shades = base + np.random.default_rng(0).uniform(-1, 1, (20, 3)) * MAX_SHADE_DISTANCE / 8
    assert len(dominant_colors(shades, np.ones(20))[0]) == 1


def test_material_is_the_texture_of_the_largest_area(picture):
    wood, cloth = picture("wood_3", [[RED]]), picture("textile_2_1", [[RED]])
    plain = SurfaceMaterial(kind="metal")
    item = skin(
        [2.0, 3.0, 1.5, 7.0],
        [SurfaceMaterial(texture=wood), SurfaceMaterial(texture=cloth), SurfaceMaterial(texture=wood), plain],
    )
    look = compute_appearance(item, SemanticOptions())
    assert (look.materials, look.is_textured) == (("wood",), True)
    shared = compute_appearance(item, SemanticOptions(material="share"))
    assert shared.materials == ("wood", "textile")
    assert compute_appearance(item, SemanticOptions(material="share", share=0.24)).materials == ("wood",)
    assert compute_appearance(item, SemanticOptions(material="share", share=0.5)).materials == ()


def test_what_no_texture_tells_is_usual_for_the_category():
    look = compute_appearance(
        skin([1.0, 2.0], [SurfaceMaterial(kind="metal"), SurfaceMaterial(kind="glass")]), SemanticOptions()
    )
    assert (look.materials, look.is_textured) == (("glass",), False)
    assert compute_appearance(skin([1.0], [SurfaceMaterial()]), SemanticOptions()).materials == ()
    assert (
        compute_appearance(skin([1.0], [SurfaceMaterial(kind="metal")]), SemanticOptions(material="share")).materials
        == ()
    )


def test_a_users_picture_tells_no_material(picture):
    user, wood = picture("123", [[RED]]), picture("wood_1", [[RED]])
    item = skin([9.0, 1.0], [SurfaceMaterial(texture=user), SurfaceMaterial(texture=wood)])
    assert compute_appearance(item, SemanticOptions()).materials == ("wood",)


def test_the_twenty_families_of_the_paper_are_a_subset_of_the_one_table():
    assert len(HOME_TEXTURE_KINDS) == 20
    assert len(set(HOME_TEXTURE_KINDS.values())) == 15
    assert HOME_TEXTURE_KINDS.items() <= TEXTURE_KINDS.items()
    assert set(TEXTURE_KINDS.values()) | set(CATEGORY_KINDS.values()) == set(MATERIAL_KINDS)


def test_a_broken_texture_is_named(tmp_path):
    path = tmp_path / "wood_1.jpg"
    path.write_bytes(b"no image")
    with pytest.raises(DatasetError, match=r"wood_1\.jpg"):
        compute_appearance(skin([1.0], [SurfaceMaterial(texture=str(path))]), SemanticOptions())


@pytest.mark.parametrize("options", [{"material": "most"}, {"share": 0.0}, {"share": 1.5}])
def test_unknown_rules_are_refused(options):
    with pytest.raises(ConfigError):
        SemanticOptions(**options)
