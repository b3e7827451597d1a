"""Colours and textures that the slots of a model may take, by finish."""

from collections.abc import Mapping
from dataclasses import replace

from home_mjx.schema.house import Material
from home_procgen.primitives.palette import FINISHES as BEFORE
from home_procgen.primitives.palette import plain, textured
from home_procgen.textures import fabrics, recipes, rugs


def _plain(colors: str) -> tuple[Material, ...]:
    return tuple(plain(color) for color in colors.split())


def _textured(*names: str) -> tuple[Material, ...]:
    return tuple(textured(name) for name in names)


_TERRY = recipes.texture_names("linen", fabrics.terry)
_RINGS = recipes.texture_names("carpet", rugs.rings)
_RUGS = tuple(
    name
    for kind in (rugs.persian, rugs.kilim, rugs.framed, rugs.steps, rugs.berber, rugs.abstract)
    for name in recipes.texture_names("carpet", kind)
)
_CANE = recipes.texture_names("paneling", fabrics.cane)
_FUR = recipes.texture_names("carpet", fabrics.fur)
_PLAIN_TEXTILES = tuple(f"textile_{n}" for n in (1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18))
_PATTERNED = tuple(f"textile_{n}" for n in range(19, 39))

FINISHES: Mapping[str, tuple[Material, ...]] = {
    **BEFORE,
    "wood": _textured(*(f"wood_{n}" for n in (1, 13, 3, 7, 2, 4, 9, 14, 6, 8, 11, 10, 16, 23, 17, 5, 15, 19))),
    "paint": _plain("#f4f2ec #e2e6e4 #2f3a46 #6f8a7c #8fa3b4 #d9c4a8 #c9857a #3f4f45 #b8b4ac #e8d8a8 #54606c #a8c0b8"),
    "upholstery": _textured(*_PLAIN_TEXTILES, *(f"leather_{n}" for n in range(1, 7))),
    "textile": _textured(*_PLAIN_TEXTILES, *_PATTERNED),
    "patterned": _textured(*_PATTERNED, *_PLAIN_TEXTILES[:6]),
    "leather": _textured(*(f"leather_{n}" for n in range(1, 7))),
    "linen": (
        *BEFORE["linen"],
        *_textured("linen_2", "linen_3", "linen_4", "linen_5", "textile_31", "textile_30", "textile_23", "textile_32"),
    ),
    "towel": _textured(*_TERRY),
    "curtain": _textured(
        *(f"textile_{n}" for n in (11, 6, 9, 27, 32, 14, 29, 10, 13, 31, 2, 35, 8)), "linen_2", "linen_3"
    ),
    "sheer": tuple(plain(color, 0.6) for color in ("#f6f4ef", "#eef1f4", "#f3ece2")),
    "carpet": _textured(*_RUGS),
    "carpet_round": _textured(*_RINGS, "carpet_25", "carpet_13"),
    "fur": _textured(*_FUR),
    "cane": _textured(*_CANE),
    "stone": _textured("stone_1", "stone_2", "stone_3", "stone_7", "stone_8", "marble_1", "marble_2", "concrete_1"),
    "marble": _textured("marble_1", "marble_2", "marble_3", "marble_4"),
    "tiling": _textured(*(f"tile_{n}" for n in (6, 7, 8, 9, 11, 12, 14, 15, 17))),
    "masonry": _textured("bricks_3", "bricks_4", "stone_5", "bricks_1", "marble_1", "stucco_1"),
    "concrete": _textured("concrete_1", "concrete_2"),
    "brass": _plain("#b8925a #c9a45c #8c6a3c #a87a4a"),
    "iron": _plain("#26282b #3a3d40 #4c463e #1c1d1f"),
    "black": _plain("#1e1f22"),
    "white": _plain("#f4f4f2"),
    "gray": _plain("#8a8e92 #6a6e72 #b4b8bb"),
    "plastic": _plain("#2b2d31 #b8403a #e9e4d8 #3f5a63 #e0b040 #5f8f7c #4a6f9a #d9d9d6"),
    "bright": _plain("#d9443c #3f7fc4 #f0c040 #4fa064 #e88a3c #8f5fb0 #e88ab0 #35a3a8"),
    "bright_other": _plain("#3f7fc4 #f0c040 #4fa064 #d9443c #8f5fb0 #e88a3c #35a3a8 #e88ab0"),
    "skin": _plain("#e0b090 #c08a66 #8a5a40 #f0cab0"),
    "ceramic": _plain("#f5f5f3"),
    "glaze": _plain("#f2eee4 #3f6f8f #b8604a #4a6a56 #d9a84a #26323c #c9b8a4 #7f94a8 #e8dcd4 #8c3f4a #6f8a7c #e4e8e8"),
    "crockery": _plain("#f6f5f1 #dfe8ee #f2e2c8 #33506a #b9c9b4 #e8b8a4 #f0d070 #4a4f54"),
    "terracotta": _plain("#b4694a #c98562 #9a5a44 #d9d4c8 #5c6064 #e8e6e0"),
    "soil": _textured("ground_1"),
    "leaf": _plain("#3f6f3c #5a8a46 #2f5a3a #6f9a52 #4a7f5a #7c9a5c"),
    "petal": _plain("#e05a6a #f2b84a #f4f0e6 #b06ac0 #f08a5a #e8a0b8"),
    "bark": _plain("#6a4f38 #8a6f52 #54402e"),
    "paper": _plain("#f2ece0 #e8e4da"),
    "cover": _plain("#8c2f2b #2f4a6b #3d5c43 #c9a24a #5a3f5e #c96a4a #26282c #e6e0d2 #4f8a8c #7c4a3a #9aa4b0 #d8b8a8"),
    "wax": _plain("#f4ecd8 #c9504a #e8e0e4 #8fa39a"),
    "rubber": _plain("#1c1c1e #2b2b2e"),
    "car": _plain("#b4282c #26405c #d8dadc #2b2d30 #5f6f5c #e0e0da #c98a2c #7c8a96"),
    "gold": _plain("#d4b05a"),
    "red": _plain("#c8403a"),
    "green": _plain("#4f9a5a"),
    "blue": _plain("#3f6fb0"),
    "yellow": _plain("#f0c84a"),
    "orange": _plain("#e8923c"),
    "brown": _plain("#8a5a34"),
    "cream": _plain("#f2e4c4"),
    "crust": _plain("#b8783c"),
    "water": (plain("#7fb4cc", opacity=0.45),),
    "glass": (plain("#9fbcc6", opacity=0.35),),
    "tint": (plain("#b0884a", opacity=0.5), plain("#4a7f6a", opacity=0.5), plain("#6a8fb0", opacity=0.45)),
    "bulb": _plain("#fff6dc"),
    "shade": _plain("#f4e6c4 #f0efe9 #d9c3a0 #e8e4dc #c9d4d0 #33383e #b8685a"),
    "opal": _plain("#fbf6e8 #f4f1e8"),
    "screen": _plain("#0d0f13"),
    "face": _plain("#f6f4ee #fbfaf6 #e8dcc0"),
    "picture": _textured(*recipes.texture_names("picture")),
    "grass": _textured("grass_2"),
    "felt": _plain("#2f6f4a #26507c #7c2f34"),
    "fur_coat": _plain("#8a6a48 #3a3430 #d9c4a0 #c98a4a #e8e4dc #6f6a66"),
}


def default_materials(slots: Mapping[str, str], number: int) -> tuple[Material, ...]:
    """Return the materials of a model where nothing else is chosen, one per slot.

    Args:
        slots: Slot name -> finish.
        number: Number of the model in its family.
    """
    options = [(FINISHES[finish], number + i * (finish != "wood")) for i, finish in enumerate(slots.values())]
    return tuple(replace(found[k % len(found)], name=f"material_{i}") for i, (found, k) in enumerate(options))
