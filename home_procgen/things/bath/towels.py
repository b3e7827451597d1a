"""Towel racks and hooks."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from home_procgen.primitives.solids import Solid, box, move, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, padded_block, rounded_box
from home_procgen.shapes.sheets import sheet
from home_procgen.shapes.sweep import prism, ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.joinery import disc


def drape_towel(slot: str, width: float, x: float, y: float, z: float, front: float, back: float) -> Solid:
    """Build a towel folded over a bar along x at height y [m]."""
    path = [
        (z + 0.018, y - front),
        (z + 0.018, y - 0.4 * front),
        (z + 0.016, y),
        (z, y + 0.016),
        (z - 0.016, y),
        (z - 0.018, y - back),
    ]
    rows = [
        np.array([(x + s * width / 2, h, d + 0.003 * np.sin(9 * s + 5 * h)) for s in np.linspace(-1, 1, 9)])
        for d, h in path
    ]
    return sheet(slot, np.stack(rows), 0.01)


def _towel_bar(kind: str) -> Iterator[Solid]:
    for k in range(1 if kind == "bar" else 2):
        y, z = 0.5 + 0.1 * k, -0.01 + 0.0 * k if kind == "bar" else 0.05 - 0.06 * k
        yield rod("chrome", (-0.3, y, z), (0.3, y, z), 0.009)
        yield drape_towel(f"towel_{k}" if k else "towel", 0.4 - 0.06 * k, 0.04 * k, y, z, 0.42, 0.36)
    for s in (-1, 1):
        yield rounded_box("chrome", (0.045, 0.15, 0.012), (s * 0.3, 0.48, -0.08), 0.005, 1)
        for k in range(1 if kind == "bar" else 2):
            y, z = 0.5 + 0.1 * k, -0.01 if kind == "bar" else 0.05 - 0.06 * k
            yield rod("chrome", (s * 0.3, y, -0.075), (s * 0.3, y, z), 0.008)


def _heated() -> Iterator[Solid]:
    for s in (-1, 1):
        yield rod("white", (s * 0.25, 0.0, 0.0), (s * 0.25, 1.1, 0.0), 0.018, sides=12)
        for y in (0.12, 0.98):
            yield rod("chrome", (s * 0.25, y, -0.06), (s * 0.25, y, 0.0), 0.012)
    for group in range(3):
        for i in range(5):
            yield rod(
                "white",
                (-0.25, 0.06 + 0.37 * group + 0.05 * i, 0.01),
                (0.25, 0.06 + 0.37 * group + 0.05 * i, 0.01),
                0.012,
            )
    yield drape_towel("towel", 0.4, 0.0, 0.97, 0.03, 0.4, 0.3)


def _ladder() -> Iterator[Solid]:
    for s in (-1, 1):
        yield rod("wood", (s * 0.24, 0.0, 0.16), (s * 0.2, 1.6, -0.16), 0.018, sides=10)
    for i in range(5):
        y = 0.25 + 0.3 * i
        w, z = 0.24 - 0.04 * y / 1.6, 0.16 - 0.32 * y / 1.6
        yield rod("wood", (-w, y, z), (w, y, z), 0.014)
        if i in (2, 4):
            yield drape_towel(f"towel_{i}", 0.34, 0.0, y, z, 0.3, 0.2)


def _stand() -> Iterator[Solid]:
    for s in (-1, 1):
        yield tube("brass", fillet([(s * 0.3, 0.01, -0.12), (s * 0.3, 0.01, 0.12)], 0.01), 0.012)
        yield rod("brass", (s * 0.3, 0.01, 0.0), (s * 0.3, 0.85, 0.0), 0.012)
    for y, z in ((0.83, 0.0), (0.62, 0.07), (0.4, -0.07)):
        yield rod("brass", (-0.3, y, z), (0.3, y, z), 0.01)
    yield drape_towel("towel", 0.42, 0.0, 0.83, 0.0, 0.42, 0.36)
    yield drape_towel("towel_1", 0.3, 0.08, 0.62, 0.07, 0.3, 0.2)
    for s in (-1, 1):
        for y, z in ((0.62, 0.07), (0.4, -0.07)):
            yield rod("brass", (s * 0.3, y, 0.0), (s * 0.3, y, z), 0.008)


def _shelved() -> Iterator[Solid]:
    """Build a rod shelf with folded towels and a bar below."""
    for s in (-1, 1):
        yield rounded_box("chrome", (0.014, 0.12, 0.22), (s * 0.3, 0.42, 0.0), 0.005, 1)
    for k in range(5):
        yield rod("chrome", (-0.3, 0.53, 0.09 - 0.045 * k), (0.3, 0.53, 0.09 - 0.045 * k), 0.006)
    for i in range(3):
        yield padded_block(f"towel_{i}", (0.3 - 0.02 * i, 0.06, 0.2), (-0.1, 0.536 + 0.055 * i, 0.0), 5.0, 5)
    yield move(
        rotate(
            revolve("towel", [(0.05, 0.0), (0.055, 0.02), (0.055, 0.17), (0.05, 0.19)], sides=16, steps=1), 0, np.pi / 2
        ),
        (0.17, 0.59, -0.095),
    )
    yield rod("chrome", (-0.3, 0.45, 0.08), (0.3, 0.45, 0.08), 0.008)
    yield drape_towel("towel_1", 0.36, 0.05, 0.45, 0.08, 0.4, 0.34)


def _swinging() -> Iterator[Solid]:
    """Build a towel rack of three arms hinged at the wall."""
    yield rounded_box("chrome", (0.04, 0.22, 0.014), (0.0, 0.4, -0.2), 0.005, 1)
    yield rod("chrome", (0.0, 0.4, -0.18), (0.0, 0.6, -0.18), 0.009)
    for k, turn in enumerate((-0.55, 0.0, 0.55)):
        y = 0.43 + 0.07 * k
        end = (0.4 * np.sin(turn), y, -0.18 + 0.4 * np.cos(turn))
        yield rod("chrome", (0.0, y, -0.18), end, 0.008)
        towel = (rotate(drape_towel(f"towel_{k}", 0.24, 0.0, 0.0, 0.0, 0.3, 0.26), 1, turn - np.pi / 2),)
        yield from (move(p, (0.24 * np.sin(turn), y, -0.18 + 0.24 * np.cos(turn))) for p in towel)


def _rolls() -> Iterator[Solid]:
    """Build a column of rings with rolled towels."""
    for s in (-1, 1):
        yield rod("brass", (s * 0.09, 0.0, -0.09), (s * 0.09, 0.8, -0.09), 0.007)
    for k in range(4):
        y = 0.09 + 0.2 * k
        yield ring("brass", 0.08, 0.01, (0.0, y, -0.06), 2, 24)
        yield ring("brass", 0.08, 0.01, (0.0, y, 0.06), 2, 24)
        yield rod("brass", (0.0, y - 0.08, -0.06), (0.0, y - 0.08, 0.06), 0.004, sides=6)
        yield move(
            rotate(
                revolve(f"towel_{k % 3}", [(0.06, 0.0), (0.066, 0.02), (0.066, 0.24), (0.06, 0.26)], sides=18, steps=1),
                0,
                np.pi / 2,
            ),
            (0.0, y, -0.09),
        )


def _pole() -> Iterator[Solid]:
    """Build a pole with bent arms around it on a round foot."""
    yield revolve("iron", [(0.16, 0.0), (0.155, 0.018), (0.02, 0.03)], sides=24, steps=1)
    yield rod("iron", (0.0, 0.02, 0.0), (0.0, 1.05, 0.0), 0.012, sides=10)
    yield ball("iron", 0.022, (0.0, 1.06, 0.0), 12, 8)
    for k in range(3):
        y, s = 0.6 + 0.2 * k, (-1) ** k
        yield tube(
            "iron",
            fillet(
                [
                    (0.0, y, 0.0),
                    (s * 0.05, y, 0.0),
                    (s * 0.05, y + 0.0, 0.0),
                    (s * 0.3, y, 0.0),
                    (s * 0.3, y + 0.04, 0.0),
                ],
                0.015,
            ),
            0.008,
        )
        yield drape_towel(f"towel_{k}", 0.2, s * 0.17, y, 0.0, 0.34, 0.28)


def _warmer() -> Iterator[Solid]:
    """Build a heated flat plate with bars before it."""
    yield rounded_box("black", (0.5, 0.95, 0.02), (0.0, 0.0, -0.06), 0.008, 2)
    for y in (0.3, 0.75):
        for s in (-1, 1):
            yield rod("chrome", (s * 0.22, y, -0.05), (s * 0.22, y, 0.02), 0.008)
        yield tube("chrome", [(-0.25, y, 0.02), (0.25, y, 0.02)], 0.01, 10)
    yield drape_towel("towel", 0.4, 0.0, 0.75, 0.02, 0.38, 0.3)
    yield disc("blue", 0.008, 0.004, (0.2, 0.05, -0.05), 12)


_TOWEL_RACK_KINDS = {
    "bar": partial(_towel_bar, "bar"),
    "double": partial(_towel_bar, "double"),
    "heated": _heated,
    "ladder": _ladder,
    "stand": _stand,
    "shelf": _shelved,
    "swing": _swinging,
    "rolls": _rolls,
    "pole": _pole,
    "plate": _warmer,
}


def towel_rack(kind: str = "bar") -> Iterator[Solid]:
    """Build a towel rack: bars, a heated frame, a ladder, a stand, a shelf, swing arms, rings, a pole or a plate."""
    yield from _TOWEL_RACK_KINDS[kind]()


def towel_hook(kind: str = "ring") -> Iterator[Solid]:
    """Build towels on rings, hooks, straps or arms, or a robe on a hook."""
    if kind in _HOOKS:
        yield from _HOOKS[kind]()
        return
    if kind == "ring":
        yield rounded_box("chrome", (0.05, 0.05, 0.02), (0.0, 0.4, -0.05), 0.008, 2)
        yield rod("chrome", (0.0, 0.425, -0.045), (0.0, 0.425, -0.01), 0.008)
        yield ring("chrome", 0.08, 0.012, (0.0, 0.34, -0.005), 2, 24)
        yield drape_towel("towel", 0.13, 0.0, 0.265, -0.005, 0.26, 0.2)
        return
    yield rounded_box("wood", (0.4, 0.07, 0.018), (0.0, 0.62, -0.06), 0.006, 1)
    for i in range(3):
        x = (i - 1) * 0.13
        yield tube("brass", fillet([(x, 0.66, -0.05), (x, 0.63, -0.01), (x, 0.66, 0.01)], 0.02), 0.006, 6)
    folds = fillet([(-0.03, 0.65), (0.03, 0.65), (0.1, 0.3), (0.11, 0.02), (-0.11, 0.02), (-0.1, 0.3)], 0.03, 3, True)
    if kind == "robe":
        yield prism("towel", folds, 0.07, (0.0, 0.0, -0.012))
        for s in (-1, 1):
            yield tube(
                "towel", [(s * 0.06, 0.52, 0.0), (s * 0.15, 0.36, 0.0), (s * 0.17, 0.14, 0.0)], [0.04, 0.05, 0.055], 10
            )
        yield tube("towel_1", [(-0.09, 0.32, 0.03), (0.0, 0.31, 0.04), (0.03, 0.1, 0.04)], 0.012, 6)
    else:
        for i in (0, 2):
            yield prism(f"towel_{i}", [(0.7 * x + (i - 1) * 0.13, y) for x, y in folds], 0.05, (0.0, 0.0, -0.012))


def _strap() -> Iterator[Solid]:
    """Build a leather loop on a knob with a towel through it."""
    yield disc("brass", 0.02, 0.02, (0.0, 0.52, -0.02), 18)
    yield tube(
        "leather", fillet([(0.0, 0.53, -0.01), (-0.05, 0.36, 0.0), (0.05, 0.36, 0.0), (0.0, 0.53, -0.01)], 0.03), 0.007
    )
    yield drape_towel("towel", 0.09, 0.0, 0.36, 0.0, 0.3, 0.26)


def _knobs() -> Iterator[Solid]:
    """Build a board with four knobs, towels on two of them."""
    yield rounded_box("paint", (0.5, 0.09, 0.02), (0.0, 0.5, -0.05), 0.008, 2)
    for i in range(4):
        knob = revolve("ceramic", [(0.012, 0.0), (0.01, 0.02), (0.026, 0.035), (0.018, 0.05)], sides=14, steps=2)
        yield move(rotate(knob, 0, np.pi / 2), ((i - 1.5) * 0.13, 0.545, -0.041))
    cloth = fillet(
        [(0.0, 0.56), (0.03, 0.52), (0.06, 0.1), (0.05, 0.06), (-0.05, 0.06), (-0.06, 0.1), (-0.03, 0.52)],
        0.02,
        3,
        True,
    )
    for i, x in enumerate((-0.195, 0.065)):
        yield prism(f"towel_{i}", [(x + a, b) for a, b in cloth], 0.03, (0.0, 0.0, -0.022))


def _frame() -> Iterator[Solid]:
    """Build a square ring of flat bars with a towel."""
    yield rounded_box("black", (0.06, 0.06, 0.012), (0.0, 0.42, -0.05), 0.004, 1)
    yield box("black", (0.02, 0.02, 0.05), (0.0, 0.44, -0.022))
    for y in (0.24, 0.45):
        yield box("black", (0.22, 0.014, 0.014), (0.0, y, 0.0))
    for s in (-1, 1):
        yield box("black", (0.014, 0.196, 0.014), (s * 0.103, 0.254, 0.0))
    yield drape_towel("towel", 0.17, 0.0, 0.25, 0.0, 0.24, 0.2)


def _arm() -> Iterator[Solid]:
    """Build a towel arm that is open at one end."""
    yield disc("chrome", 0.03, 0.012, (-0.14, 0.42, -0.06), 20)
    yield tube("chrome", fillet([(-0.14, 0.42, -0.05), (-0.14, 0.42, 0.02), (0.16, 0.42, 0.02)], 0.02), 0.009)
    yield ball("chrome", 0.014, (0.165, 0.42, 0.02), 12, 6)
    yield drape_towel("towel", 0.2, 0.02, 0.42, 0.02, 0.36, 0.3)


def _branch() -> Iterator[Solid]:
    """Build twig-like hooks on a bent rod."""
    yield tube("brass", [(-0.24, 0.5, -0.03), (-0.1, 0.53, -0.03), (0.08, 0.5, -0.03), (0.24, 0.54, -0.03)], 0.01)
    for i, x in enumerate((-0.2, -0.06, 0.08, 0.2)):
        yield tube("brass", fillet([(x, 0.5, -0.03), (x, 0.47, 0.01), (x, 0.51, 0.03)], 0.015), 0.006)
        yield disc("brass", 0.014, 0.008, (x, 0.515, -0.044), 12)
        if i % 2:
            yield prism(
                f"towel_{i}",
                fillet([(x - 0.02, 0.5), (x + 0.02, 0.5), (x + 0.06, 0.08), (x - 0.06, 0.08)], 0.015, 3, True),
                0.035,
            )


_HOOKS = {"strap": _strap, "knobs": _knobs, "frame": _frame, "arm": _arm, "branch": _branch}


RACKS = ("bar", "heated", "ladder", "stand", "double", "shelf", "swing", "rolls", "pole", "plate")

FAMILIES = (
    FurnitureFamily("towel_rack", "towel_rack", design_kinds(towel_rack, *RACKS)),
    FurnitureFamily("towel_hanger", "towel_hanger", design_kinds(towel_hook, "ring", "hooks", "robe", *_HOOKS)),
)
