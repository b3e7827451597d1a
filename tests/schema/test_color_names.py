"""Colour spaces against published values, and palettes against the tables that Matplotlib ships."""

import numpy as np
import pytest

from benchmarks.home2017.semantics import nearest_names_srgb
from home_mjx.core.color import ciede2000, srgb_to_lab
from home_mjx.schema.color_names import COLOR_LEVELS, nearest_names, palettes

# Sharma, Wu, Dalal (2005), table 1: two CIELAB colours and their difference.
SHARMA = np.array(
    [
        (50, 2.6772, -79.7751, 50, 0, -82.7485, 2.0425), (50, 3.1571, -77.2803, 50, 0, -82.7485, 2.8615),
        (50, 2.8361, -74.0200, 50, 0, -82.7485, 3.4412), (50, -1.3802, -84.2814, 50, 0, -82.7485, 1.0),
        (50, -1.1848, -84.8006, 50, 0, -82.7485, 1.0), (50, -0.9009, -85.5211, 50, 0, -82.7485, 1.0),
        (50, 0, 0, 50, -1, 2, 2.3669), (50, -1, 2, 50, 0, 0, 2.3669),
        (50, 2.49, -0.001, 50, -2.49, 0.0009, 7.1792), (50, 2.49, -0.001, 50, -2.49, 0.0010, 7.1792),
        (50, 2.49, -0.001, 50, -2.49, 0.0011, 7.2195), (50, 2.49, -0.001, 50, -2.49, 0.0012, 7.2195),
        (50, -0.001, 2.49, 50, 0.0009, -2.49, 4.8045), (50, -0.001, 2.49, 50, 0.0011, -2.49, 4.7461),
        (50, 2.5, 0, 50, 0, -2.5, 4.3065), (50, 2.5, 0, 73, 25, -18, 27.1492),
        (50, 2.5, 0, 61, -5, 29, 22.8977), (50, 2.5, 0, 56, -27, -3, 31.9030),
        (50, 2.5, 0, 58, 24, 15, 19.4535), (50, 2.5, 0, 50, 3.1736, 0.5854, 1.0),
        (50, 2.5, 0, 50, 3.2972, 0, 1.0), (50, 2.5, 0, 50, 1.8634, 0.5757, 1.0), (50, 2.5, 0, 50, 3.2592, 0.3350, 1.0),
        (60.2574, -34.0099, 36.2677, 60.4626, -34.1751, 39.4387, 1.2644),
        (63.0109, -31.0961, -5.8663, 62.8187, -29.7946, -4.0864, 1.2630),
        (61.2901, 3.7196, -5.3901, 61.4292, 2.2480, -4.9620, 1.8731),
        (35.0831, -44.1164, 3.7933, 35.0232, -40.0716, 1.5901, 1.8645),
        (22.7233, 20.0904, -46.6940, 23.0331, 14.9730, -42.5619, 2.0373),
        (36.4612, 47.8580, 18.3852, 36.2715, 50.5065, 21.2231, 1.4146),
        (90.8027, -2.0831, 1.4410, 91.1528, -1.6435, 0.0447, 1.4441),
        (90.9257, -0.5406, -0.9208, 88.6381, -0.8985, -0.7239, 1.5381),
        (6.7747, -0.2908, -2.4247, 5.8714, -0.0985, -2.2286, 0.6377),
        (2.0776, 0.0795, -1.1350, 0.9033, -0.0636, -0.5514, 0.9082),
    ]
)  # fmt: skip
LACKING = {
    "darkgrey", "darkslategrey", "dimgrey", "fuchsia", "grey", "lightgrey", "lightslategrey", "rebeccapurple",
    "slategrey",
}  # fmt: skip
BASIC = [
    "black", "blue", "cyan", "gray", "green", "lime", "magenta", "maroon", "navy", "olive", "purple", "red", "silver",
    "teal", "white", "yellow",
]  # fmt: skip


@pytest.fixture(scope="module")
def tables():
    return pytest.importorskip("matplotlib._color_data")


def rgb(text: str) -> list[float]:
    return [int(text[i : i + 2], 16) / 255 for i in (1, 3, 5)]


@pytest.mark.parametrize("swapped", [False, True])
def test_ciede2000_is_that_of_the_published_pairs(swapped):
    a, b, wanted = SHARMA[:, :3], SHARMA[:, 3:6], SHARMA[:, 6]
    np.testing.assert_allclose(ciede2000(b, a) if swapped else ciede2000(a, b), wanted, atol=5e-5)


def test_cielab_of_the_primaries():
    """Values of Lindbloom's calculator for sRGB under D65."""
    lab = srgb_to_lab(np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0], [1, 1, 1], [0.5, 0.5, 0.5]], float))
    wanted = [
        (53.2408, 80.0925, 67.2032), (87.7347, -86.1827, 83.1793), (32.2970, 79.1875, -107.8602), (0, 0, 0),
        (100, 0, 0), (53.3890, 0, 0),
    ]  # fmt: skip
    np.testing.assert_allclose(lab, wanted, atol=0.02)


def test_palettes_are_matplotlibs(tables):
    css, xkcd = palettes()["css"], palettes()["xkcd"]
    assert [len(palettes()[level].names) for level in COLOR_LEVELS] == [16, 139, 949]
    assert {name.replace(" ", "") for name in css.names} == set(tables.CSS4_COLORS) - LACKING
    for name, color in zip(css.names, css.srgb, strict=True):
        np.testing.assert_allclose(color, rgb(tables.CSS4_COLORS[name.replace(" ", "")]), atol=1e-12)
    for name, color in zip(xkcd.names, xkcd.srgb, strict=True):
        np.testing.assert_allclose(color, rgb(tables.XKCD_COLORS[f"xkcd:{name}"]), atol=1e-12)
    assert len(set(xkcd.names)) == len(tables.XKCD_COLORS)
    assert list(palettes()["basic"].names) == BASIC
    for name, color in zip(BASIC, palettes()["basic"].srgb, strict=True):
        np.testing.assert_allclose(color, rgb(tables.CSS4_COLORS[name]), atol=1e-12)


@pytest.mark.parametrize("level", COLOR_LEVELS)
def test_each_colour_of_a_palette_has_its_own_name(level):
    palette = palettes()[level]
    first = {tuple(color): name for name, color in reversed([*zip(palette.names, palette.srgb, strict=True)])}
    wanted = [first[tuple(color)] for color in palette.srgb]  # aqua and cyan are one colour
    assert nearest_names_srgb(palette.srgb, level) == wanted
    assert nearest_names(palette.lab, level) == wanted


def test_perceived_difference_agrees_with_people_better_than_srgb():
    """XKCD's names were given by people: the last word of `olive green` says which basic colour they saw."""
    palette = palettes()["xkcd"]
    last = [name.split()[-1].replace("grey", "gray") for name in palette.names]
    rows = [i for i, word in enumerate(last) if word in BASIC and palette.names[i] not in (word, "grey")]
    words = [last[i] for i in rows]
    by_look, in_srgb = nearest_names(palette.lab[rows], "basic"), nearest_names_srgb(palette.srgb[rows], "basic")
    euclidean = np.linalg.norm(palette.lab[rows][:, None] - palettes()["basic"].lab, axis=-1).argmin(axis=1)
    agreeing = [
        np.mean([name == word for name, word in zip(names, words, strict=True)])
        for names in (by_look, [BASIC[i] for i in euclidean], in_srgb)
    ]
    assert len(rows) == 464
    np.testing.assert_allclose(agreeing, [0.42, 0.39, 0.27], atol=0.01)
