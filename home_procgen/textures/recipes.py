"""Recipes of all textures by name, base textures included."""

import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from jaxtyping import Float

from home_mjx.schema.house import Mesh
from home_procgen.primitives import textures as before
from home_procgen.primitives.palette import rgb
from home_procgen.primitives.textures import Canvas, Image, Rgb, draw_on
from home_procgen.textures import fabrics, outdoors, patterns, pictures, rugs

Recipe = Callable[[np.random.Generator], Rgb]
RecipeRow = tuple[Callable[..., Rgb], str] | tuple[Callable[..., Rgb], str, Mapping[str, Any]]
# A recipe's first arguments are its colours, in order; plus signs join a tuple of colours.
WOODS: tuple[RecipeRow, ...] = (
    (before.wood, "#8a5a33 #b98454"),
    (before.wood, "#5c3a22 #8a5f3c"),
    (before.wood, "#c9a875 #e8d2a8"),
    (before.wood, "#2b1d14 #4a3424"),
    (before.wood, "#d9d2c6 #efeae0"),
    (before.wood, "#6e4a3a #a86f58"),
    (patterns.knotty, "#b4834e #dcb683"),
    (patterns.knotty, "#6d4426 #9a6a42"),
    (patterns.knotty, "#8f8678 #b8b0a2"),
    (patterns.knotty, "#c8a06a #ebd0a0", {"knots": 5}),
    (patterns.knotty, "#3d2a1e #5f4633", {"bands": 10}),
    (patterns.knotty, "#7d2f22 #a9553c"),
    (patterns.knotty, "#a9a398 #d0cbc0", {"knots": 6}),
    (before.wood, "#31363a #4a5055"),
    (before.wood, "#7c8f86 #9fb0a6"),
    (before.wood, "#4a6075 #6d8399"),
    (patterns.knotty, "#9c7240 #c89c64", {"bands": 4}),
    (before.wood, "#a03c2c #c45b44"),
)
PARQUETS: tuple[RecipeRow, ...] = (
    (patterns.herringbone, "#8a5f38 #bb8d5c"),
    (patterns.herringbone, "#5b3c26 #83603f"),
    (patterns.herringbone, "#b79a72 #dbc49c", {"count": 6}),
    (patterns.basket, "#8f6238 #c0935d"),
    (patterns.basket, "#6a4327 #96683f", {"count": 6, "slats": 5}),
    (patterns.chevron, "#94683f #c09364"),
    (before.planks, "#a8763f #d3a468", {"rows": 6, "columns": 1}),
    (before.planks, "#3a2a20 #5c4637", {"rows": 7}),
)
LAMINATES: tuple[RecipeRow, ...] = (
    (before.planks, "#c4b59c #e2d6c0", {"rows": 6}),
    (before.planks, "#77695b #9c8e7e", {"rows": 7, "columns": 1}),
    (before.planks, "#d8d4cc #f0ede6", {"rows": 6}),
    (before.planks, "#55504a #7d776f", {"rows": 8}),
)
TILES: tuple[RecipeRow, ...] = (
    (patterns.subway, "#e8e8e4 #fbfbf8"),
    (patterns.subway, "#3f6f6a #6fa39c"),
    (patterns.subway, "#27405c #4b6c92"),
    (patterns.subway, "#c98f7c #e5b8a6"),
    (patterns.subway, "#2c2c2e #4a4a4e", {"grout": 0.6}),
    (patterns.mosaic, "#2f6f8f+#4f9fbf+#8fcfdf+#dff3f7"),
    (patterns.mosaic, "#d9d0c0+#b9a88c+#f2ecdf+#8f7f66"),
    (patterns.mosaic, "#f4f4f2+#e4e4e0+#c8ccca+#3c4044", {"count": 16}),
    (patterns.hexagons, "#c8c8c4 #f4f4f0"),
    (patterns.hexagons, "#4a5458 #7c888c", {"count": 8}),
    (patterns.hexagons, "#b86a48 #d99070", {"count": 5}),
    (patterns.cement, "#2f4f6f #f0ece2 #b9564a"),
    (patterns.cement, "#4f5f4a #ece6d6 #c49a3c"),
    (patterns.cement, "#6a6e72 #f2f0ec #2b2e32", {"count": 5}),
    (before.tiles, "#9a9488 #c2bcb0", {"count": 2}),
    (before.tiles, "#5c5852 #7c7870", {"count": 3}),
    (before.tiles, "#b08060 #d4a888", {"count": 5}),
    (before.tiles, "#1f4f4a #ece8dc", {"count": 6, "checker": True}),
    (patterns.shingles, "#7c3a2a #b8644a"),
    (patterns.shingles, "#3c4248 #6a7078"),
)
WALLPAPERS: tuple[RecipeRow, ...] = (
    (fabrics.damask, "#c9b99a #efe6d2"),
    (fabrics.damask, "#7f94a8 #c9d6e0"),
    (fabrics.damask, "#7a3b3f #a8656a", {"count": 4}),
    (fabrics.petals, "#f3ece0 #c7697a #7f9a6a"),
    (fabrics.petals, "#26384a #d9a05a #5f8a76"),
    (fabrics.petals, "#eef1ea #7f9fd0 #8fb08a", {"count": 30, "size": 0.03}),
    (fabrics.vines, "#f4f1e6 #86a37c"),
    (fabrics.vines, "#dfe8ea #5f8590", {"count": 5}),
    (fabrics.leaves, "#20382f #2f5f47+#4a7f5a+#7fa36a"),
    (fabrics.leaves, "#f2efe6 #a9c0a0+#c3d4b6+#8fae8c"),
    (fabrics.fans, "#1f3f4a #d9b56a"),
    (fabrics.fans, "#e6d9cc #fbf6ee"),
    (fabrics.dots, "#f6f0f2 #e8a9b4"),
    (fabrics.dots, "#eaf2f6 #8fb9d0", {"count": 8}),
    (fabrics.triangles, "#f2f0ea+#d6dde0+#a9bcc4+#e8cfa0"),
    (fabrics.triangles, "#f6e9e2+#e8c8b8+#c9a9a0+#fbf7f2", {"count": 4}),
    (fabrics.bands, "#f2ead8+#c9a98a+#f2ead8+#8fa39a"),
    (fabrics.bands, "#fbfaf6+#dfe6ea+#fbfaf6+#b9c9d4", {"count": 5}),
    (fabrics.diamonds, "#b9a890 #d8cab4 #f6f0e4"),
    (patterns.chevron, "#d4d0c8 #f4f2ee", {"count": 5}),
    (before.stripes, "#d9c4c4 #f4e8e8"),
    (before.rosettes, "#b6c4a8 #dfe8d4", {"count": 8}),
)
CARPETS: tuple[RecipeRow, ...] = (
    (before.grain, "#6f6a64 #94908a"),
    (before.grain, "#b8ac98 #d8cebc"),
    (before.grain, "#46564a #6a7c6e"),
    (before.grain, "#3a3d44 #5c6068"),
    (fabrics.fur, "#c9c2b6 #f4f0e8"),
    (fabrics.fur, "#8c7a66 #bfae98"),
    (fabrics.fur, "#3f4650 #6c7480"),
    (fabrics.melange, "#7c6f8a #a99cb6"),
    (fabrics.cord, "#a39a8c #c9c0b2", {"count": 24}),
)
RUGS: tuple[RecipeRow, ...] = (
    (rugs.persian, "#8c2b2b #23324f #c79a4a #ead9b8"),
    (rugs.persian, "#23406a #7a2430 #b98c48 #e8dcc0"),
    (rugs.persian, "#d8c9a8 #6a4a38 #3f5a52 #f2e9d4"),
    (rugs.kilim, "#a83c2c+#e0c08a+#2f4f5c+#d98c4a+#f0e6d0"),
    (rugs.kilim, "#2f3f4f+#c9d0d4+#7c8f9c+#f0eee8", {"rows": 9}),
    (rugs.framed, "#d9d2c4 #5c6f7c"),
    (rugs.framed, "#7c8a76 #e6e0d0", {"lines": 1}),
    (rugs.framed, "#2f3a4a #c9a45c", {"lines": 3}),
    (rugs.steps, "#c9644a+#e8b070+#f0e0c0+#5f8a8c+#2f4a5c"),
    (rugs.steps, "#f2f0ea+#c4c8ca+#7c8488+#f2f0ea"),
    (rugs.berber, "#efe9dc #4a4038"),
    (rugs.berber, "#d8d4d0 #8c4a3c"),
    (rugs.abstract, "#e8e2d6+#c98a6a+#6a8a8c+#2f3f4f+#d9b45c"),
    (rugs.abstract, "#3a4148+#7c8a94+#c9ccd0+#b0865c"),
    (rugs.rings, "#e6dcc8+#b97f5a+#5f7f7c"),
    (rugs.rings, "#f0eee8+#9fb0bc+#5c6f80+#dfe4e8"),
    (rugs.town, ""),
    (rugs.rings, "#e88a8a+#f4d27a+#8fc49a+#7fb4dc+#b69adc", {"count": 8}),
)
TEXTILES: tuple[RecipeRow, ...] = (
    (before.weave, "#7c7f84 #a4a7ac"),
    (before.weave, "#2c2f34 #4a4e54"),
    (before.weave, "#8f6a3c #bf965f"),
    (before.weave, "#2f5f66 #4f858c"),
    (before.weave, "#7f4a5c #a86f82"),
    (before.weave, "#c4bcae #e2dbcf"),
    (fabrics.melange, "#5a5f66 #8a8f96"),
    (fabrics.melange, "#9a8f80 #c4baab"),
    (fabrics.melange, "#3f5a4a #66806f"),
    (fabrics.melange, "#8a4a34 #b87456"),
    (fabrics.cord, "#6a4f34 #947350"),
    (fabrics.cord, "#33485c #567088"),
    (fabrics.cord, "#5c6a4a #82906c"),
    (fabrics.plaid, "#8c2b2b #2f4030 #e0c070"),
    (fabrics.plaid, "#e6dfd0 #7c8f9c #b85a4a"),
    (fabrics.plaid, "#2f4f6a #8fa9bc #f2ece0"),
    (fabrics.gingham, "#b03a3a #fbf7f2"),
    (fabrics.gingham, "#4a6f9a #fbfaf6"),
    (fabrics.houndstooth, "#2b2b2e #eeece8"),
    (fabrics.dots, "#33506a #f2eee4"),
    (fabrics.dots, "#f0e4d4 #c96a5a", {"count": 10}),
    (fabrics.bands, "#f4f0e6+#33506a+#f4f0e6+#33506a", {"count": 4}),
    (fabrics.bands, "#e8c070+#d97f5a+#7fa09a+#f2e6d0"),
    (fabrics.bands, "#d0d4d0+#8a9a94+#f2f2ee", {"count": 6}),
    (fabrics.petals, "#f6f0e6 #c9606a #7c9a6c", {"count": 22}),
    (fabrics.petals, "#e6ecf0 #6f8fc4 #7fa08a", {"count": 18}),
    (fabrics.leaves, "#f4f1e8 #5f8a6a+#86a888", {"count": 24}),
    (fabrics.knit, "#b9ad9c #e6dccd"),
    (fabrics.knit, "#6f3a44 #9c626c"),
    (fabrics.diamonds, "#3f5a6f #7f9aac #f0e8d8"),
    (patterns.chevron, "#d9a03c #f6efe0", {"count": 6, "rows": 12}),
    (fabrics.fans, "#b9566a #f4e4e0"),
    (fabrics.triangles, "#e6b84a+#4a8a8c+#e6e0d2+#c9564a", {"count": 5}),
)
LINENS: tuple[RecipeRow, ...] = (
    (before.weave, "#cdd6de #eef3f7"),
    (before.weave, "#d9c3b8 #f3e6de"),
    (before.weave, "#8fa0ae #b9c8d4"),
    (fabrics.bands, "#fbfbf9+#bccbd8+#fbfbf9", {"count": 6}),
    (fabrics.terry, "#d8d4cc #f6f4f0", {"border": True}),
    (fabrics.terry, "#4f7f8c #86b0ba", {"border": True}),
    (fabrics.terry, "#b86a5c #e0a294", {"border": True}),
    (fabrics.terry, "#5c6a5a #94a38f", {"border": True}),
    (fabrics.terry, "#3c4a66 #6c7ca0"),
    (fabrics.terry, "#c9a45c #ecd49a"),
)
LEATHERS: tuple[RecipeRow, ...] = (
    (before.grain, "#7a4a2a #a06a42", {"size": 1.5, "contrast": 0.15}),
    (before.grain, "#d9cfc0 #efe8dc", {"size": 1.5, "contrast": 0.12}),
    (before.grain, "#5c2622 #7f3c36", {"size": 1.5, "contrast": 0.15}),
    (before.grain, "#33403a #52625a", {"size": 1.5, "contrast": 0.15}),
)
STONES: tuple[RecipeRow, ...] = (
    (patterns.terrazzo, "#e6e2da #b9705a+#6f7f86+#d0b070+#4a4a4a"),
    (patterns.terrazzo, "#4c5054 #c9c4b8+#8f8a80+#a8b4b8"),
    (patterns.flagstones, "#8c857a #b8b0a2"),
    (patterns.flagstones, "#6a6258 #968c7e", {"count": 30}),
    (before.grain, "#1f2022 #4c4e52", {"size": 1.0}),
    (before.grain, "#8a7f70 #c9bda8", {"size": 1.4}),
)
MARBLES: tuple[RecipeRow, ...] = (
    (patterns.marble, "#8f9498 #f4f3f0"),
    (patterns.marble, "#c9b48c #2c2a2a"),
    (patterns.marble, "#e6e0d4 #2f4a40"),
    (patterns.marble, "#b08a6a #ecdfd0", {"veins": 2.0}),
)
OTHERS: Mapping[str, tuple[RecipeRow, ...]] = {
    "concrete": ((before.grain, "#8c8c88 #b4b4b0", {"size": 3.0}), (before.grain, "#6c6e70 #92959a", {"size": 5.0})),
    "bricks": (
        (before.bricks, "#7c4a3a #a87058"),
        (before.bricks, "#d8d4cc #f2f0ea"),
        (before.bricks, "#5a3a30 #7c5a4c"),
    ),
    "stucco": ((before.grain, "#d8c4a0 #ecdcc0", {"size": 2.0}), (before.grain, "#c4ccd0 #dfe5e8", {"size": 2.0})),
    "metal": (
        (patterns.brushed, "#a8acb0 #d4d7da"),
        (patterns.brushed, "#6a6e72 #9a9ea2"),
        (patterns.brushed, "#9a7a3c #d4b46c"),
    ),
    "paneling": (
        (patterns.boards, "#e0dcd2 #f6f4ee"),
        (patterns.boards, "#8a5f38 #b98c5c"),
        (patterns.boards, "#5f7480 #869ba6"),
        (fabrics.cane, "#5a4226 #d8b884"),
        (fabrics.cane, "#6a6a66 #e6e2d8"),
        (fabrics.cane, "#2b211a #7c6650"),
    ),
    "lnm": (
        (patterns.terrazzo, "#b9b4a4 #8f8a7c+#d4cfc0", {"count": 500}),
        (before.tiles, "#3c6a6a #e0dccc", {"count": 6, "checker": True}),
    ),
    "grass": ((fabrics.fur, "#3c5f2a #7c9c50"), (before.grain, "#4a6a34 #86a060", {"size": 1.2})),
    "ground": ((before.grain, "#5c4632 #8a7054", {"size": 1.6}), (before.grain, "#b8a47c #dcc9a2", {"size": 1.2})),
    "path": (
        (patterns.flagstones, "#7c7a74 #a8a6a0", {"count": 40}),
        (patterns.terrazzo, "#a8a49a #8c8880+#c4c0b6+#77736c", {"count": 700}),
    ),
}
PICTURES: tuple[RecipeRow, ...] = (
    (pictures.hills, "#6f9fd0 #f2e2c4 #2f5a3a"), (pictures.hills, "#e08a5a #f8dca0 #4a2f4f"),
    (pictures.hills, "#9fb8c4 #e8ecec #3f5560"), (pictures.hills, "#f0b8a0 #fbe8d4 #8a4a3c", {"rows": 7}),
    (pictures.sea, "#4f8fc4 #f6e4c0 #2f6f8f"), (pictures.sea, "#d9744a #f8d08a #3f4f6f"),
    (pictures.sea, "#a8bcc8 #eceff0 #6f8a94", {"boat": False}), (pictures.mountains, "#5f94c8 #e4eef4 #5f6874"),
    (pictures.mountains, "#e6a070 #fae0c0 #6a5468"), (pictures.forest, "#9fb0a8 #26332c"),
    (pictures.forest, "#d8b070 #5a3420", {"count": 12}), (pictures.city, "#1c2440 #7c4f6a #14182a #f8d070"),
    (pictures.city, "#8fc0e0 #f4e8d8 #4a5a6c #dfeaf0"), (pictures.bouquet, "#c4b8a4 #4a6f8a"),
    (pictures.bouquet, "#3a4440 #d8d0c0", {"blooms": 30}), (pictures.bouquet, "#e8dcd4 #b06a4a", {"blooms": 14}),
    (pictures.fruit, "#7a5c40 #d8ccb4"), (pictures.fruit, "#4a5a60 #b84a3c"),
    (pictures.portrait, "#5a4a3a #e0b090 #3a2618 #26324a"),
    (pictures.portrait, "#3f4a3c #c08a66 #1c1614 #7a2a2a", {"long_hair": True}),
    (pictures.portrait, "#c4ccd0 #8a5a40 #141210 #d8b44a"),
    (pictures.portrait, "#6a3a34 #f0cab0 #b88a4a #2f4a42", {"long_hair": True}), (pictures.atlas, "#a9c8d4 #d8c490"),
    (pictures.atlas, "#d8cbac #b08c5c"), (pictures.atlas, "#24405c #d8d4c4"),
    (pictures.grid_art, "#f4f0e4+#c8281e+#1f3f8f+#f0c020"),
    (pictures.grid_art, "#ece8e0+#2f5f5c+#d98a5a+#26282c", {"lines": 4}),
    (pictures.circles, "#f2ece0 #c9503c+#2f4f6f+#e0b040+#5f8f7c"),
    (pictures.circles, "#22262e #e8e4dc+#d8a040+#7fa0b4", {"count": 20}),
    (pictures.fields, "#c8402c #e88a30 #7a1f1c"), (pictures.fields, "#2f5f8a #1f2f4f #8fb0c4"),
    (pictures.fields, "#e8c84a #f2efe4 #c9a090"), (pictures.strokes, "#f2eee6 #2b2e34+#c9a05c+#7c8a94"),
    (pictures.strokes, "#e8ecec #d85a4a+#2f7f8c+#f0c050+#5a3f6f"), (pictures.sprig, "#f6f2e8 #4f7f56"),
    (pictures.sprig, "#f2efe8 #8a9a5a", {"pairs": 6}), (pictures.sprig, "#ecefe8 #3a5f66", {"pairs": 5}),
    (pictures.poster, "#f2c84a #c8402c #26282c"), (pictures.poster, "#26405c #f0e0c0 #e8a050", {"sides": 3}),
    (pictures.poster, "#eae4d8 #2f7f7a #26282c", {"sides": 6}), (pictures.photo, "#f8f6f2"),
    (pictures.photo, "#e8cfa4"), (pictures.animal, "#cfe4ec #b08a64"),
    (pictures.animal, "#f6dcd8 #d8d4d0", {"ears": 0.24}), (pictures.animal, "#dcecd0 #e8a04a", {"ears": 0.06}),
)  # fmt: skip
_GROUPS = {
    "wood": WOODS,
    "prkt": PARQUETS,
    "laminate": LAMINATES,
    "tile": TILES,
    "wallp": WALLPAPERS,
    "carpet": (*CARPETS, *RUGS),
    "textile": TEXTILES,
    "linen": LINENS,
    "leather": LEATHERS,
    "stone": STONES,
    "marble": MARBLES,
    **OTHERS,
    "picture": PICTURES,
    **outdoors.RECIPE_ROWS,
}


def _recipe(row: RecipeRow) -> Recipe:
    paint, colors, *options = row
    arguments = [tuple(map(rgb, word.split("+"))) if "+" in word else rgb(word) for word in colors.split()]
    return lambda rng: paint(rng, *arguments, **(options[0] if options else {}))


def _named() -> Iterator[tuple[str, Recipe]]:
    for family, rows in _GROUPS.items():
        first = 1 + sum(name.startswith(f"{family}_") and name != "wallp_0" for name in before.BASE_RECIPES)
        yield from ((f"{family}_{number}", _recipe(row)) for number, row in enumerate(rows, first))


RECIPES: Mapping[str, Recipe] = dict(_named())


def texture_names(family: str, kind: Callable[..., Rgb] | None = None) -> tuple[str, ...]:
    """Return the names of the new textures of a family, or only of those drawn by the function `kind`.

    Example:
        >>> texture_names("marble")
        ('marble_1', 'marble_2', 'marble_3', 'marble_4')
    """
    first = 1 + sum(name.startswith(f"{family}_") and name != "wallp_0" for name in before.BASE_RECIPES)
    return tuple(f"{family}_{n}" for n, row in enumerate(_GROUPS[family], first) if kind in (None, row[0]))


ALL_NAMES = (*before.BASE_RECIPES, *RECIPES)
METRES = 2  # edge of what a repeating image covers [m]
REPEATING, FITTED, PICTURE = Canvas(512, METRES), Canvas(512), Canvas(256)
_RUG_NAMES = {name for row in RUGS for name in texture_names("carpet", row[0])}
FITTED_FINISHES = ("picture", "carpet", "carpet_round")
MAX_COLORS = 256  # of an image: a palette takes a third of the bytes and of the time


def canvas_of(name: str) -> Canvas:
    """Return the canvas of a texture: rugs, fronts of houses and pictures are shown once, others repeat."""
    if name.startswith("picture_"):
        return PICTURE
    return FITTED if name in _RUG_NAMES or name.startswith("front_") else REPEATING


def repeat_uv(mesh: Mesh, finishes: Iterable[str]) -> Mesh:
    """Return a mesh whose UVs in metres become repeats of the textures; `finishes` has one finish per slot."""
    return replace(mesh, uv=np.round(mesh.uv * uv_scale(finishes)[mesh.slot][:, None, None], 6) + 0.0)


def uv_scale(finishes: Iterable[str]) -> Float[np.ndarray, " _"]:
    """Return the repeats per metre of each finish; 1 where the image is shown once."""
    return np.array([1.0 if finish in FITTED_FINISHES else 1.0 / METRES for finish in finishes])


@cache
def texture(name: str) -> Image:
    """Return the image of a texture of `ALL_NAMES`, row 0 at the top, sRGB.

    Example:
        >>> texture("marble_1").shape
        (512, 512, 3)
    """
    old = name in before.BASE_RECIPES
    rng = np.random.default_rng(list(before.BASE_RECIPES).index(name) if old else zlib.crc32(name.encode()))
    with draw_on(canvas_of(name)):
        image = (before.BASE_RECIPES if old else RECIPES)[name](rng)
    return _reduce_colors(np.round(np.clip(image, 0.0, 1.0) * 255.0).astype(np.uint8))


def _reduce_colors(image: Image) -> Image:
    """Return an image with at most `MAX_COLORS` colours: the means of cells of the colour cube."""
    pixels = image.reshape(-1, 3)
    for bits in (6, 5, 4, 3, 2):
        r, g, b = (pixels >> (8 - bits)).astype(np.int32).T
        cell = (r << 2 * bits) | (g << bits) | b
        count = np.bincount(cell, minlength=1 << 3 * bits)
        used = np.flatnonzero(count)
        if len(used) <= MAX_COLORS:
            break
    number = np.zeros(len(count), np.uint8)
    number[used] = np.arange(len(used))
    index = number[cell]
    sums = np.stack([np.bincount(index, pixels[:, i], len(used)) for i in range(3)], axis=1)
    return np.round(sums / count[used, None]).astype(np.uint8)[index].reshape(image.shape)
