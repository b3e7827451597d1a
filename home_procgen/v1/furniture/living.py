"""Electronics, lamps and small things."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.family import Bulb, VariantFamily, make_slots, make_variant
from home_procgen.primitives.solids import Solid, box, cushion, cylinder, lathe, move, picture_uv, rotate


def television(width: float) -> Iterator[Solid]:
    """A flat screen on a foot."""
    high = width * 9 / 16
    yield cushion("black", (0.36 * width, 0.02, 0.22), bevel=0.006)
    yield box("black", (0.08, 0.09, 0.03), (0.0, 0.02, -0.01))
    yield cushion("black", (width, high, 0.045), (0.0, 0.1, 0.0), 0.01)
    yield box("screen", (width - 0.04, high - 0.04, 0.004), (0.0, 0.12, 0.0235))


def radio(width: float) -> Iterator[Solid]:
    """A table radio: body, two round grilles, a dial, a handle."""
    high, deep = 0.55 * width, 0.35 * width
    yield cushion("wood", (width, high, deep), bevel=0.015)
    for side in (-1, 1):
        grille = rotate(cylinder("black", 0.17 * width, 0.012, sides=16), 0, np.pi / 2)
        yield move(grille, (side * 0.27 * width, high / 2, deep / 2))
    yield box("chrome", (0.14 * width, 0.3 * high, 0.01), (0.0, 0.4 * high, deep / 2 + 0.002))
    yield box("chrome", (0.6 * width, 0.012, 0.02), (0.0, high + 0.02, 0.0))
    for side in (-1, 1):
        yield box("chrome", (0.012, 0.03, 0.02), (side * 0.29 * width, high - 0.005, 0.0))


def speaker(width: float, height: float, depth: float) -> Iterator[Solid]:
    """A floor loudspeaker with two cones."""
    yield box("wood", (width, height, depth))
    for y, radius in ((0.4 * height, 0.38 * width), (0.75 * height, 0.24 * width)):
        yield move(rotate(cylinder("black", radius, 0.015, sides=16), 0, np.pi / 2), (0.0, y, depth / 2))


def laptop(width: float) -> Iterator[Solid]:
    """An open laptop."""
    deep = 0.66 * width
    yield box("steel", (width, 0.016, deep))
    yield box("black", (0.9 * width, 0.002, 0.5 * deep), (0.0, 0.016, -0.1 * deep))
    hinge = (0.0, 0.014, -deep / 2 + 0.004)
    yield rotate(box("steel", (width, deep, 0.008), hinge), 0, -0.25, hinge)
    yield rotate(box("screen", (0.94 * width, 0.9 * deep, 0.003), (0.0, 0.03, hinge[2] + 0.005)), 0, -0.25, hinge)


def _shade(low: float, high: float, height: float, y: float) -> Solid:
    """A hollow lampshade: a thin cone ring."""
    wall = 0.006
    profile = [(low, 0.0), (high, height), (high - wall, height), (low - wall, 0.0)]
    return lathe("shade", profile, (0.0, y, 0.0), closed=True)


def _bulb(y: float, radius: float = 0.035) -> Solid:
    return lathe(
        "bulb", [(0.4 * radius, -radius), (radius, -0.3 * radius), (0.6 * radius, radius)], (0.0, y, 0.0), sides=10
    )


def floor_lamp(height: float, shade: float) -> Iterator[Solid | Bulb]:
    """A pole on a round foot with a shade."""
    yield cylinder("chrome", 0.15, 0.025, top=0.13)
    yield cylinder("chrome", 0.014, height - 0.2, (0.0, 0.02, 0.0), sides=8)
    yield _shade(shade, 0.7 * shade, 0.3, height - 0.3)
    yield _bulb(height - 0.15)
    yield Bulb((0.0, height - 0.08, 0.0), 40.0)


def table_lamp(height: float, base: float) -> Iterator[Solid | Bulb]:
    """A turned base with a shade."""
    body = [(base, 0.0), (base, 0.02), (0.4 * base, 0.05), (0.9 * base, 0.35 * height), (0.2 * base, 0.55 * height)]
    yield lathe("ceramic", body)
    yield cylinder("chrome", 0.008, 0.3 * height, (0.0, 0.5 * height, 0.0), sides=6)
    yield _shade(1.7 * base, 1.1 * base, 0.4 * height, 0.6 * height)
    yield _bulb(0.8 * height)
    yield Bulb((0.0, 0.8 * height + 0.06, 0.0), 25.0)


def pendant(drop: float, radius: float) -> Iterator[Solid | Bulb]:
    """A lamp that hangs from the ceiling by a rod."""
    yield cylinder("chrome", 0.06, 0.03, (0.0, drop - 0.03, 0.0))
    yield cylinder("chrome", 0.008, drop - 0.15, (0.0, 0.13, 0.0), sides=6)
    yield _shade(radius, 0.5 * radius, 0.16, 0.0)
    yield _bulb(0.07)
    yield Bulb((0.0, 0.02, 0.0), 60.0)


def ceiling_lamp(radius: float) -> Iterator[Solid | Bulb]:
    """A flat bowl under the ceiling."""
    yield lathe("shade", [(0.4 * radius, 0.0), (0.85 * radius, 0.03), (radius, 0.09)], sides=20)
    yield cylinder("chrome", 1.02 * radius, 0.02, (0.0, 0.09, 0.0), sides=20)
    yield Bulb((0.0, -0.03, 0.0), 60.0)


def rug(width: float, depth: float) -> Iterator[Solid]:
    """A rectangular rug with a border."""
    border = 0.12
    yield box("carpet", (width - 2 * border, 0.01, depth - 2 * border))
    for side in (-1, 1):
        yield box("carpet_1", (width, 0.01, border), (0.0, 0.0, side * (depth - border) / 2))
        yield box("carpet_1", (border, 0.01, depth - 2 * border), (side * (width - border) / 2, 0.0, 0.0))


def round_rug(radius: float) -> Iterator[Solid]:
    """A round rug of two rings."""
    yield cylinder("carpet", 0.7 * radius, 0.01, sides=32)
    yield lathe(
        "carpet_1", [(0.7 * radius, 0.0), (radius, 0.0), (radius, 0.01), (0.7 * radius, 0.01)], closed=True, sides=32
    )


def picture(width: float, height: float) -> Iterator[Solid]:
    """A framed picture for a wall."""
    rim = 0.03
    yield picture_uv(box("picture", (width - 2 * rim, height - 2 * rim, 0.012), (0.0, rim, -0.004)))
    for side in (-1, 1):
        yield box("wood", (rim, height, 0.024), (side * (width - rim) / 2, 0.0, 0.0))
        yield box("wood", (width - 2 * rim, rim, 0.024), (0.0, (height - rim) * (side + 1) / 2, 0.0))


def vase(height: float) -> Iterator[Solid]:
    """A turned vase."""
    profile = [(0.3, 0.0), (0.42, 0.3), (0.36, 0.55), (0.16, 0.8), (0.24, 1.0), (0.18, 1.0), (0.1, 0.78)]
    yield lathe("ceramic", [(0.55 * r * height, h * height) for r, h in profile])


def trash_can(radius: float, height: float) -> Iterator[Solid]:
    """A tapering bin with a lid."""
    yield cylinder("plastic", 0.8 * radius, height - 0.04, top=radius)
    yield cylinder("black", radius + 0.008, 0.03, (0.0, height - 0.04, 0.0))
    yield cylinder("black", 0.03, 0.01, (0.0, height - 0.01, 0.0), sides=8)


FAMILIES = (
    VariantFamily(
        "television",
        "television",
        television,
        make_slots("black", "screen"),
        (make_variant(width=0.95), make_variant(width=1.2)),
    ),
    VariantFamily(
        "radio",
        "loudspeaker",
        radio,
        make_slots("wood", "chrome", "black"),
        (make_variant(width=0.32), make_variant(width=0.4)),
    ),
    VariantFamily(
        "speaker",
        "loudspeaker",
        speaker,
        make_slots("wood", "black"),
        (make_variant(width=0.24, height=0.9, depth=0.28),),
    ),
    VariantFamily("laptop", "laptop", laptop, make_slots("steel", "black", "screen"), (make_variant(width=0.34),)),
    VariantFamily(
        "floor_lamp",
        "floor_lamp",
        floor_lamp,
        make_slots("chrome", "shade", "bulb"),
        (make_variant(height=1.6, shade=0.22), make_variant(height=1.45, shade=0.18)),
    ),
    VariantFamily(
        "table_lamp",
        "table_lamp",
        table_lamp,
        make_slots("ceramic", "chrome", "shade", "bulb"),
        (make_variant(height=0.45, base=0.08), make_variant(height=0.36, base=0.065)),
    ),
    VariantFamily(
        "pendant", "chandelier", pendant, make_slots("chrome", "shade", "bulb"), (make_variant(drop=0.6, radius=0.22),)
    ),
    VariantFamily(
        "ceiling_lamp",
        "chandelier",
        ceiling_lamp,
        make_slots("chrome", "shade"),
        (make_variant(radius=0.2), make_variant(radius=0.16)),
    ),
    VariantFamily(
        "rug",
        "rug",
        rug,
        make_slots("carpet", "carpet_1"),
        (make_variant(width=2.0, depth=1.4), make_variant(width=2.4, depth=1.7), make_variant(width=0.9, depth=0.6)),
    ),
    VariantFamily("round_rug", "rug", round_rug, make_slots("carpet", "carpet_1"), (make_variant(radius=0.8),)),
    VariantFamily(
        "picture",
        "picture_frame",
        picture,
        make_slots("wood", "picture"),
        (
            make_variant(width=0.8, height=0.6),
            make_variant(width=0.5, height=0.7),
            make_variant(width=0.45, height=0.45),
        ),
    ),
    VariantFamily("vase", "vase", vase, make_slots("ceramic"), (make_variant(height=0.32), make_variant(height=0.22))),
    VariantFamily(
        "trash_can", "trash_can", trash_can, make_slots("plastic", "black"), (make_variant(radius=0.14, height=0.4),)
    ),
)
