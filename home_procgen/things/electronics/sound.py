"""Loudspeakers, radios, game consoles."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder, move, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve, shade
from home_procgen.shapes.rounded import ball, padded_block, rounded_box
from home_procgen.shapes.sweep import ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design, design_kinds
from home_procgen.things.joinery import bow_handle, disc


def _cone(r: float, x: float, y: float, z: float) -> Iterator[Solid]:
    yield ring("gray", r, 0.014, (x, y, z), 2, 24)
    yield disc("black", 0.96 * r, 0.006, (x, y, z - 0.004), 24)
    yield ball("gray", (0.3 * r, 0.3 * r, 0.02), (x, y, z), 12, 6)


def _box_speaker(kind: str) -> Iterator[Solid]:
    wide, high, deep = (0.2, 0.95, 0.28) if kind == "tower" else (0.17, 0.28, 0.2)
    yield rounded_box("wood", (wide, high, deep), (0.0, 0.02, 0.0), 0.008, 1)
    for k, r in enumerate((0.07, 0.07, 0.035) if kind == "tower" else (0.06, 0.03)):
        y = (0.45, 0.65, 0.83)[k] if kind == "tower" else (0.11, 0.22)[k]
        yield from _cone(r, 0.0, y, deep / 2 + 0.002)
    for x in (-0.4, 0.4):
        yield cylinder("black", 0.012, 0.02, (x * wide, 0.0, 0.3 * deep), sides=10)
        yield cylinder("black", 0.012, 0.02, (x * wide, 0.0, -0.3 * deep), sides=10)


def _sound_bar() -> Iterator[Solid]:
    yield rounded_box("black", (0.9, 0.06, 0.08), (0.0, 0.006, 0.0), 0.02, 3)
    for i in range(40):
        yield box("gray", (0.003, 0.045, 0.004), (-0.42 + 0.0215 * i, 0.014, 0.039))


def _ball_speaker() -> Iterator[Solid]:
    yield ball("textile", 0.11, (0.0, 0.11, 0.0), 22, 14)
    yield revolve("white", [(0.06, 0.0), (0.08, 0.02), (0.06, 0.03)], sides=20, steps=1)
    yield disc("white", 0.05, 0.006, (0.0, 0.11, 0.107), 20)


def _radio() -> Iterator[Solid]:
    yield rounded_box("wood", (0.34, 0.2, 0.13), (0.0, 0.01, 0.0), 0.025, 3)
    yield rounded_box("cream", (0.3, 0.16, 0.01), (0.0, 0.03, 0.062), 0.004, 1)
    for i in range(11):
        yield box("brown", (0.006, 0.12, 0.006), (-0.13 + 0.015 * i, 0.05, 0.067))
    for y in (0.07, 0.14):
        yield disc("brass", 0.02, 0.018, (0.1, y, 0.066), 16)
    yield bow_handle("brass", 0.12, (0.2, 0.26), 0.0, 0.03, 0.006, 6)
    yield rod("chrome", (0.15, 0.2, -0.04), (0.24, 0.42, -0.04), 0.002, sides=5)


def _smart_speaker() -> Iterator[Solid]:
    yield revolve("gray", [(0.045, 0.0), (0.05, 0.01), (0.05, 0.14), (0.046, 0.15)], sides=24, steps=1)
    yield ring("blue", 0.044, 0.005, (0.0, 0.15, 0.0), 1, 24)
    for k in range(7):
        yield ring("black", 0.0505, 0.003, (0.0, 0.025 + 0.015 * k, 0.0), 1, 24)


def _flat_tower() -> Iterator[Solid]:
    """Build a tall flat loudspeaker: a framed cloth panel on a broad foot."""
    yield rounded_box("black", (0.34, 0.03, 0.3), (0.0, 0.0, 0.0), 0.008, 1)
    yield rounded_box("wood", (0.32, 1.2, 0.04), (0.0, 0.03, -0.02), 0.012, 2)
    yield padded_block("textile", (0.27, 1.12, 0.02), (0.0, 0.07, 0.004), 9.0, 6)
    yield rounded_box("chrome", (0.05, 0.014, 0.004), (0.0, 0.08, 0.016), 0.002, 1)


def _pillar() -> Iterator[Solid]:
    yield revolve("black", [(0.13, 0.0), (0.13, 0.02), (0.07, 0.035)], sides=28, steps=1)
    yield revolve("textile", [(0.085, 0.03), (0.085, 0.86)], sides=28, steps=1)
    yield revolve("black", [(0.087, 0.86), (0.08, 0.9), (0.03, 0.91)], sides=28, steps=1)
    for y in (0.03, 0.45, 0.86):
        yield ring("black", 0.086, 0.01, (0.0, y, 0.0), 1, 28)


def _boom_box() -> Iterator[Solid]:
    """Build a boom box: two cones, a cassette deck between them and a handle."""
    yield rounded_box("plastic", (0.5, 0.2, 0.12), (0.0, 0.01, 0.0), 0.02, 3)
    for s in (-1, 1):
        yield from _cone(0.07, s * 0.16, 0.1, 0.062)
    yield box("screen", (0.12, 0.06, 0.004), (0.0, 0.05, 0.061))
    for k in range(6):
        yield rounded_box("gray", (0.016, 0.014, 0.02), (-0.05 + 0.02 * k, 0.21, 0.03), 0.003, 1)
    yield box("cream", (0.16, 0.02, 0.004), (0.0, 0.16, 0.06))
    yield bow_handle("chrome", 0.2, (0.18, 0.28), 0.0, 0.04, 0.009)


def _horn() -> Iterator[Solid]:
    """Build a gramophone: a wooden box, a turntable and a brass horn."""
    yield rounded_box("wood", (0.34, 0.14, 0.34), (0.0, 0.0, 0.0), 0.01, 1)
    yield rounded_box("wood", (0.37, 0.02, 0.37), (0.0, 0.0, 0.0), 0.006, 1)
    yield cylinder("black", 0.14, 0.01, (0.0, 0.145, 0.02), sides=28)
    yield cylinder("red", 0.04, 0.012, (0.0, 0.145, 0.02), sides=20)
    neck = fillet([(0.1, 0.15, 0.02), (0.0, 0.22, -0.1), (0.0, 0.34, -0.16), (0.0, 0.42, -0.1)], 0.06, 4)
    yield tube("brass", neck, np.linspace(0.01, 0.03, len(neck)), 10)
    bell = shade("brass", [(0.03, 0.0), (0.05, 0.12), (0.1, 0.22), (0.19, 0.28)], (0.0, 0.0, 0.0), 0.004, 24, 3)
    yield move(rotate(bell, 0, 0.9), (0.0, 0.41, -0.12))


_SPEAKER_KINDS = {
    "tower": partial(_box_speaker, "tower"),
    "small": partial(_box_speaker, "small"),
    "bar": _sound_bar,
    "ball": _ball_speaker,
    "radio": _radio,
    "smart": _smart_speaker,
    "flat": _flat_tower,
    "pillar": _pillar,
    "boom": _boom_box,
    "horn": _horn,
}


def speaker(kind: str = "tower") -> Iterator[Solid]:
    """Build a loudspeaker or a similar device.

    Args:
        kind: `tower`, `flat`, `pillar`, `small`, `ball`, `smart`, `bar` (sound bar), `radio`, `boom` (boom box) or
            `horn` (gramophone).
    """
    yield from _SPEAKER_KINDS[kind]()


def stereo(kind: str = "rack") -> Iterator[Solid]:
    """Build a hi-fi `rack` with a record player, or a `turntable` alone."""
    if kind == "rack":
        for i, high in enumerate((0.14, 0.1, 0.12)):
            y = 0.01 + sum((0.15, 0.11, 0.13)[:i])
            yield rounded_box("black" if i % 2 else "steel", (0.43, high, 0.32), (0.0, y, 0.0), 0.006, 1)
            yield disc("chrome", 0.03, 0.025, (0.14, y + high / 2, 0.16), 20)
            yield box("screen", (0.16, 0.04, 0.004), (-0.06, y + high / 2 - 0.01, 0.16))
            for k in range(5):
                yield disc("gray", 0.007, 0.01, (-0.14 + 0.03 * k, y + 0.02, 0.16), 10)
    base = 0.4 if kind == "rack" else 0.0
    yield rounded_box("wood", (0.44, 0.08, 0.34), (0.0, base + 0.012, 0.0), 0.01, 1)
    yield cylinder("black", 0.15, 0.012, (-0.04, base + 0.09, 0.0), sides=32)
    for r in (0.145, 0.12, 0.09):
        yield ring("gray", r, 0.001, (-0.04, base + 0.1025, 0.0), 1, 30)
    yield cylinder("red", 0.045, 0.002, (-0.04, base + 0.102, 0.0), sides=20)
    yield cylinder("chrome", 0.02, 0.04, (0.16, base + 0.092, -0.1), sides=14)
    yield tube("chrome", [(0.16, base + 0.125, -0.1), (0.16, base + 0.125, 0.04), (0.08, base + 0.115, 0.1)], 0.005, 6)


def compact_stereo() -> Iterator[Solid]:
    """Build a small stereo between two loudspeakers."""
    yield rounded_box("steel", (0.2, 0.13, 0.2), (0.0, 0.0, 0.0), 0.008, 1)
    yield box("screen", (0.12, 0.035, 0.004), (0.0, 0.08, 0.1))
    yield disc("chrome", 0.02, 0.02, (0.05, 0.035, 0.1), 18)
    for k in range(4):
        yield disc("gray", 0.006, 0.008, (-0.07 + 0.022 * k, 0.035, 0.1), 10)
    for s in (-1, 1):
        yield rounded_box("wood", (0.14, 0.22, 0.17), (s * 0.2, 0.0, 0.0), 0.006, 1)
        yield from _cone(0.05, s * 0.2, 0.075, 0.087)
        yield from _cone(0.022, s * 0.2, 0.165, 0.087)


def console(kind: str = "upright") -> Iterator[Solid]:
    """Build a game console, `upright` or `flat`, with its pad."""
    slot = "black" if kind == "upright" else "white"
    if kind == "upright":
        yield rounded_box(slot, (0.1, 0.32, 0.22), (0.0, 0.01, 0.0), 0.02, 2)
        yield box("blue", (0.006, 0.26, 0.004), (0.02, 0.04, 0.11))
        yield rounded_box("gray", (0.14, 0.014, 0.2), (0.0, 0.0, 0.0), 0.006, 1)
    else:
        yield rounded_box(slot, (0.3, 0.07, 0.24), (0.0, 0.0, 0.0), 0.015, 2)
        yield box("black", (0.16, 0.006, 0.004), (-0.03, 0.035, 0.12))
        yield disc("green", 0.014, 0.004, (0.11, 0.035, 0.118), 16)
    x = 0.17 if kind == "upright" else 0.27
    yield padded_block("gray", (0.1, 0.035, 0.06), (x, 0.004, 0.05), 4.0, 5)
    for s in (-1, 1):
        yield tube("gray", [(x + s * 0.045, 0.024, 0.05), (x + s * 0.06, 0.016, 0.11)], [0.02, 0.014], 10)
        yield cylinder("black", 0.01, 0.018, (x + s * 0.022, 0.034, 0.062), sides=12)


def handheld(slot: str = "blue") -> Iterator[Solid]:
    """Build a game console with a screen between its two grips, leaning in its dock."""
    for piece in (
        rounded_box("black", (0.17, 0.1, 0.014), (0.0, 0.02, 0.0), 0.005, 2),
        box("screen", (0.15, 0.082, 0.002), (0.0, 0.03, 0.007)),
        *(rounded_box(slot, (0.034, 0.1, 0.016), (s * 0.102, 0.02, 0.0), 0.007, 3) for s in (-1, 1)),
        *(ball("black", (0.008, 0.008, 0.006), (s * 0.102, 0.07 + 0.02 * s, 0.011), 10, 6) for s in (-1, 1)),
    ):
        yield rotate(piece, 0, -0.2, (0.0, 0.02, 0.0))
    yield rounded_box("gray", (0.18, 0.06, 0.05), (0.0, 0.0, -0.035), 0.01, 2)


def old_console(slot: str = "gray") -> Iterator[Solid]:
    """Build an old game console with a cartridge and a wired pad."""
    yield rounded_box(slot, (0.26, 0.06, 0.2), (0.0, 0.0, 0.0), 0.012, 2)
    yield rounded_box("black", (0.12, 0.07, 0.02), (0.0, 0.03, -0.02), 0.004, 1)
    for s in (-1, 1):
        yield rounded_box("red", (0.03, 0.012, 0.02), (s * 0.09, 0.056, 0.06), 0.004, 1)
    yield rounded_box("white", (0.13, 0.016, 0.06), (0.02, 0.0, 0.2), 0.006, 2)
    for k in range(3):
        yield cylinder("red", 0.008, 0.006, (0.04 + 0.02 * k, 0.014, 0.2), sides=12)
    yield tube("black", fillet([(0.0, 0.02, 0.1), (-0.06, 0.005, 0.14), (-0.02, 0.008, 0.17)], 0.02), 0.003, 6)


FAMILIES = (
    FurnitureFamily("floor_speaker", "loudspeaker", design_kinds(speaker, "tower", "flat", "pillar")),
    FurnitureFamily(
        "speaker", "loudspeaker", design_kinds(speaker, "small", "bar", "ball", "radio", "smart", "boom", "horn")
    ),
    FurnitureFamily("stereo_set", "stereo_set", (*design_kinds(stereo, "rack", "turntable"), design(compact_stereo))),
    FurnitureFamily(
        "playstation", "playstation", (*design_kinds(console, "upright"), design(handheld), design(old_console))
    ),
    FurnitureFamily(
        "xbox",
        "xbox",
        (*design_kinds(console, "flat"), design(handheld, slot="red"), design(old_console, slot="black")),
    ),
)
