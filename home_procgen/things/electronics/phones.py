"""Telephones and tablets."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder, move, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import prism, tube
from home_procgen.things.family import FurnitureFamily, design_kinds


def _dial_telephone() -> Iterator[Solid]:
    yield revolve("bright", [(0.11, 0.0), (0.105, 0.03), (0.06, 0.09), (0.05, 0.1)], sides=20, steps=3)
    yield rotate(cylinder("cream", 0.05, 0.012, (0.0, 0.07, 0.045), sides=24), 0, 0.75, (0.0, 0.07, 0.045))
    for i in range(10):
        a = 0.5 + 0.5 * i
        yield rotate(
            cylinder("black", 0.008, 0.014, (0.036 * np.cos(a), 0.07, 0.045 + 0.036 * np.sin(a)), sides=10),
            0,
            0.75,
            (0.0, 0.07, 0.045),
        )
    yield tube(
        "bright",
        fillet([(-0.12, 0.115, -0.01), (-0.08, 0.15, -0.01), (0.08, 0.15, -0.01), (0.12, 0.115, -0.01)], 0.05, 4),
        0.016,
        10,
    )
    for s in (-1, 1):
        yield ball("bright", (0.032, 0.022, 0.032), (s * 0.115, 0.115, -0.01), 14, 8)


def _cordless() -> Iterator[Solid]:
    yield rounded_box("black", (0.09, 0.04, 0.1), (0.0, 0.0, 0.0), 0.015, 2)
    handset = [
        rounded_box("black", (0.05, 0.17, 0.026), (0.0, 0.02, 0.0), 0.012, 3),
        box("tint", (0.034, 0.03, 0.002), (0.0, 0.13, 0.013)),
    ]
    handset += [
        rounded_box("gray", (0.01, 0.008, 0.004), ((i - 1) * 0.013, 0.055 + 0.016 * j, 0.012), 0.002, 1)
        for i in range(3)
        for j in range(4)
    ]
    yield from (rotate(p, 0, -0.25, (0.0, 0.02, 0.0)) for p in handset)


def _desk_telephone() -> Iterator[Solid]:
    yield prism("black", [(-0.09, 0.0), (0.1, 0.0), (0.1, 0.02), (-0.09, 0.09)], 0.19, (0.0, 0.0, 0.0), "side")
    yield move(
        rotate(rounded_box("black", (0.05, 0.045, 0.2), (0.0, 0.0, 0.0), 0.018, 3), 0, 0.35), (-0.06, 0.065, 0.0)
    )
    for i in range(3):
        for j in range(4):
            yield rotate(
                rounded_box("gray", (0.02, 0.012, 0.016), (0.0 + 0.027 * i, 0.058, -0.005 + 0.022 * j), 0.004, 1),
                0,
                0.35,
                (0.0, 0.058, 0.0),
            )


_TELEPHONE_KINDS = {
    "dial": _dial_telephone,
    "cordless": _cordless,
    "desk": _desk_telephone,
}


def telephone(kind: str = "dial") -> Iterator[Solid]:
    """Build a telephone: rotary dial, cordless or desk."""
    yield from _TELEPHONE_KINDS[kind]()


def _phone_on_its_face() -> Iterator[Solid]:
    yield rounded_box("screen", (0.07, 0.002, 0.148), (0.0, 0.0, 0.0), 0.0008, 1)
    yield rounded_box("bright", (0.078, 0.01, 0.158), (0.0, 0.0015, 0.0), 0.004, 3)
    yield rounded_box("black", (0.026, 0.003, 0.034), (-0.018, 0.011, -0.05), 0.0012, 2)
    for z in (-0.058, -0.042):
        yield cylinder("glass", 0.005, 0.001, (-0.018, 0.0138, z), sides=14)


def _phone_with_keys() -> Iterator[Solid]:
    yield rounded_box("gray", (0.05, 0.016, 0.12), (0.0, 0.0, 0.0), 0.006, 3)
    yield rounded_box("tint", (0.04, 0.002, 0.04), (0.0, 0.0155, -0.032), 0.0008, 1)
    for i in range(3):
        for j in range(4):
            yield rounded_box("white", (0.011, 0.003, 0.007), ((i - 1) * 0.013, 0.015, 0.006 + 0.012 * j), 0.001, 1)


def _tablet_on_stand() -> Iterator[Solid]:
    lean = [*_screen(0.17, 0.24)]
    yield from (move(rotate(p, 0, -1.15), (0.0, 0.11, 0.0)) for p in (rotate(q, 0, np.pi) for q in lean))
    yield prism("gray", [(-0.1, 0.0), (0.06, 0.0), (0.05, 0.01), (-0.02, 0.06), (-0.03, 0.055)], 0.1, plane="side")


def _reader() -> Iterator[Solid]:
    yield rounded_box("cover", (0.13, 0.006, 0.18), (0.0, 0.0, 0.0), 0.002, 2)
    yield rounded_box("white", (0.122, 0.008, 0.17), (0.0, 0.006, 0.0), 0.003, 2)
    yield box("paper", (0.092, 0.001, 0.122), (0.0, 0.0138, -0.012))
    for i in range(9):
        yield box("gray", (0.078 - 0.02 * (i % 4 == 3), 0.0008, 0.004), (0.0, 0.0145, -0.06 + 0.012 * i))


def slab(kind: str = "phone") -> Iterator[Solid]:
    """Build a mobile phone or a tablet: lying face up, on its face, with keys, on a stand, or a reader."""
    yield from _SLAB_KINDS[kind]()


def _screen(wide: float = 0.075, deep: float = 0.155) -> Iterator[Solid]:
    yield rounded_box("black", (wide, 0.008, deep), (0.0, 0.0, 0.0), 0.0035, 3)
    yield rounded_box("screen", (wide - 0.006, 0.002, deep - 0.014), (0.0, 0.0068, 0.0), 0.0008, 1)
    yield rounded_box("chrome", (0.002, 0.003, 0.02), (wide / 2, 0.0025, -0.2 * deep), 0.0008, 1)


_SLAB_KINDS = {
    "phone": _screen,
    "face": _phone_on_its_face,
    "keys": _phone_with_keys,
    "tablet": partial(_screen, 0.19, 0.26),
    "stand": _tablet_on_stand,
    "reader": _reader,
}

FAMILIES = (
    FurnitureFamily("telephone", "telephone", design_kinds(telephone, "dial", "cordless", "desk")),
    FurnitureFamily("cellphone", "cellphone", design_kinds(slab, "phone", "face", "keys")),
    FurnitureFamily("ipad", "ipad", design_kinds(slab, "tablet", "stand", "reader")),
)
