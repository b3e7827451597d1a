"""Coat stands, hooks, pegs, panels and valets."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, cylinder, move, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import beam, prism, ring, rod, tube
from home_procgen.shapes.transforms import repeat_around
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import garment


def clothes_rail() -> Iterator[Solid]:
    """Build a rail with clothes on hangers."""
    for s in (-1, 1):
        yield tube("iron", fillet([(s * 0.45, 0.03, -0.22), (s * 0.45, 0.03, 0.22)], 0.01), 0.014)
        yield rod("iron", (s * 0.45, 0.03, 0.0), (s * 0.45, 1.5, 0.0), 0.014)
        for z in (-0.2, 0.2):
            yield ball("rubber", 0.025, (s * 0.45, 0.025, z), 10, 6)
    yield rod("iron", (-0.5, 1.5, 0.0), (0.5, 1.5, 0.0), 0.014)
    for i in range(7):
        yield from garment(f"textile_{i % 5}", -0.33 + 0.11 * i, 1.5, 0.7 + 0.06 * (i % 4))


def coat_tree() -> Iterator[Solid]:
    """Build a post with bent hooks and a coat."""
    yield revolve(
        "wood",
        [(0.2, 0.0), (0.19, 0.03), (0.04, 0.06), (0.025, 0.2), (0.022, 1.6), (0.03, 1.68), (0.005, 1.74)],
        sides=14,
    )
    hook = [
        tube("wood", fillet([(0.0, 1.52, 0.0), (0.0, 1.5, 0.12), (0.0, 1.62, 0.17)], 0.05), 0.01),
        ball("brass", 0.016, (0.0, 1.63, 0.17), 8, 4),
    ]
    yield from repeat_around(hook, 6)
    yield from repeat_around(
        [tube("wood", fillet([(0.0, 1.2, 0.0), (0.0, 1.18, 0.1), (0.0, 1.27, 0.14)], 0.04), 0.009)], 4, 0.4
    )
    yield _coat()


def coat_tripod() -> Iterator[Solid]:
    """Build three crossed poles and a coat."""
    yield from repeat_around([rod("wood", (0.0, 0.0, 0.26), (0.1, 1.72, -0.12), 0.018, 0.013)], 3)
    yield from repeat_around(
        [
            rod("wood", (0.0, 1.3, 0.0), (0.02, 1.38, 0.14), 0.009),
            rod("wood", (0.0, 1.52, 0.0), (0.02, 1.58, 0.12), 0.009),
        ],
        3,
        1.0,
    )
    yield ring("brass", 0.08, 0.012, (0.0, 0.95, 0.0), 1, 16)
    yield _coat()


def _coat() -> Solid:
    coat = [
        (0.0, 0.0),
        (0.16, -0.1),
        (0.22, -0.5),
        (0.16, -0.52),
        (0.2, -0.95),
        (-0.2, -0.95),
        (-0.16, -0.52),
        (-0.22, -0.5),
        (-0.16, -0.1),
    ]
    return prism("textile", fillet([(x, 1.56 + y) for x, y in coat], 0.03, 2, True), 0.07, (0.0, 0.0, 0.16))


def hook_board(width: float = 0.8, shelf: bool = False) -> Iterator[Solid]:
    """Build a wall board with hooks, a scarf and a bag; `shelf` adds a shelf with a basket above."""
    yield rounded_box("wood", (width, 0.12, 0.02), (0.0, 0.62, -0.08), 0.006, 1)
    for i in range(5):
        x = (i - 2) * width / 5.5
        yield tube("iron", fillet([(x, 0.68, -0.07), (x, 0.65, -0.03), (x, 0.68, -0.005)], 0.02), 0.006, 6)
    if shelf:
        yield rounded_box("wood", (width, 0.022, 0.2), (0.0, 0.74, 0.0), 0.006, 1)
        yield rounded_box("cane", (0.28, 0.14, 0.18), (0.2, 0.762, 0.0), 0.02, 1)
    x = -width / 5.5
    yield prism(
        "textile",
        fillet([(x - 0.05, 0.66), (x + 0.05, 0.66), (x + 0.07, 0.1), (x - 0.07, 0.1)], 0.02, 2, True),
        0.04,
        (0.0, 0.0, -0.03),
    )
    yield rounded_box("leather", (0.28, 0.24, 0.09), (width / 5.5, 0.22, -0.02), 0.03, 2)
    yield tube(
        "leather",
        fillet([(width / 5.5 - 0.1, 0.44, -0.02), (width / 5.5, 0.68, -0.02), (width / 5.5 + 0.1, 0.44, -0.02)], 0.06),
        0.008,
        6,
    )


def valet() -> Iterator[Solid]:
    """Build a valet stand for one suit, with a trouser bar and a tray."""
    for s in (-1, 1):
        yield beam("wood", (s * 0.2, 0.02, -0.16), (s * 0.2, 0.02, 0.16), 0.03, 0.04)
        yield rod("wood", (s * 0.2, 0.02, 0.0), (s * 0.12, 1.05, 0.0), 0.016, 0.013, 10)
    for y, x in ((0.3, 0.18), (0.62, 0.155)):
        yield rod("wood", (-x, y, 0.0), (x, y, 0.0), 0.011)
    yield rounded_box("wood", (0.26, 0.02, 0.14), (0.0, 0.86, 0.06), 0.008, 2)
    yield tube(
        "wood", fillet([(-0.24, 1.05, 0.0), (-0.08, 1.13, 0.0), (0.08, 1.13, 0.0), (0.24, 1.05, 0.0)], 0.06), 0.018
    )
    jacket = [
        (-0.05, 1.16),
        (0.05, 1.16),
        (0.24, 1.07),
        (0.27, 0.5),
        (0.2, 0.5),
        (0.2, 0.36),
        (-0.2, 0.36),
        (-0.2, 0.5),
    ]
    shape = fillet([*jacket, (-0.27, 0.5), (-0.24, 1.07)], 0.03, 2, True)
    yield prism("textile", shape, 0.05, (0.0, 0.0, -0.045))


def branches() -> Iterator[Solid]:
    """Build a trunk with branches on a round foot, with a scarf and a hat."""
    yield revolve("wood", [(0.2, 0.0), (0.2, 0.02), (0.16, 0.035)], sides=26, steps=1)
    yield tube(
        "wood", [(0.0, 0.03, 0.0), (0.01, 0.6, 0.0), (0.0, 1.2, 0.01), (0.01, 1.7, 0.0)], [0.03, 0.026, 0.02, 0.012], 10
    )
    for i in range(8):
        a, y = 2.4 * i, 0.95 + 0.09 * i
        c, s = np.cos(a), np.sin(a)
        path = [(0.0, y, 0.0), (0.1 * c, y + 0.04, 0.1 * s), (0.17 * c, y + 0.13, 0.17 * s)]
        yield tube("wood", path, [0.013, 0.011, 0.008], 8)
    hat = [(0.14, 0.0), (0.13, 0.008), (0.085, 0.01), (0.08, 0.08), (0.05, 0.1)]
    yield revolve("cane", hat, (0.01, 1.7, 0.0), 20, 2)
    scarf = [(0.1, 0.4), (0.18, 0.4), (0.17, 1.02), (0.11, 1.02)]
    yield prism("textile", scarf, 0.03, (-0.22, 0.0, 0.07))


def peg_rail(width: float = 0.9) -> Iterator[Solid]:
    """Build a rail with turned pegs, a straw hat and a bag."""
    yield rounded_box("wood", (width, 0.09, 0.022), (0.0, 0.5, -0.06), 0.008, 2)
    for i in range(6):
        x = (i - 2.5) * width / 6.4
        peg = revolve("wood", [(0.008, 0.0), (0.007, 0.05), (0.013, 0.065), (0.006, 0.075)], sides=10, steps=2)
        yield move(rotate(peg, 0, np.pi / 2 - 0.15), (x, 0.54, -0.05))
    hat = revolve("cane", [(0.16, 0.0), (0.15, 0.01), (0.09, 0.012), (0.085, 0.07), (0.05, 0.085)], sides=22, steps=2)
    yield move(rotate(hat, 0, np.pi / 2 - 0.2), (-width / 4, 0.46, -0.035))
    bag = fillet([(-0.14, 0.06), (0.14, 0.06), (0.12, 0.3), (-0.12, 0.3)], 0.05, 3, True)
    x = 0.5 * width / 6.4
    yield prism("linen", [(a + x, b) for a, b in bag], 0.06, (0.0, 0.0, -0.02))
    yield tube("linen", fillet([(x - 0.08, 0.29, -0.02), (x, 0.58, -0.02), (x + 0.08, 0.29, -0.02)], 0.04), 0.008, 6)


def scissors(width: float = 0.8) -> Iterator[Solid]:
    """Build an expanding rack of crossed laths with knobs at their ends, and a bag."""
    step, half = width / 4, 0.14
    for i in range(4):
        x = (i + 0.5) * step - width / 2
        for s in (-1, 1):
            a, b = (x - step / 2, 0.3 - s * half, -0.04 - 0.006 * s), (x + step / 2, 0.3 + s * half, -0.04 - 0.006 * s)
            yield beam("wood", a, b, 0.012, 0.03)
    for i in range(5):
        for s in (-1, 1):
            x, y = i * step - width / 2, 0.3 + s * half
            yield rod("wood", (x, y, -0.05), (x, y, 0.03), 0.008)
            yield ball("wood", 0.016, (x, y, 0.035), 10, 6)
    yield rounded_box("leather", (0.22, 0.3, 0.05), (step, 0.1, 0.02), 0.02, 2)


def panel(width: float = 0.9) -> Iterator[Solid]:
    """Build a padded panel with a hat shelf, brass hooks and an umbrella."""
    for i in range(5):
        wide = width / 5
        yield rounded_box("upholstery", (wide - 0.006, 0.95, 0.035), ((i - 2) * wide, 0.0, -0.1), 0.014, 2)
    yield rounded_box("wood", (width, 0.024, 0.26), (0.0, 0.95, 0.01), 0.008, 2)
    for s in (-1, 1):
        yield tube(
            "brass", fillet([(s * 0.36, 0.74, -0.085), (s * 0.36, 0.9, -0.07), (s * 0.36, 0.95, 0.1)], 0.08, 4), 0.009
        )
    for i in range(4):
        x = (i - 1.5) * 0.2
        yield tube("brass", fillet([(x, 0.82, -0.08), (x, 0.76, -0.03), (x, 0.81, 0.0)], 0.025), 0.007, 8)
        yield ball("brass", 0.012, (x, 0.815, 0.002), 8, 6)
    yield tube("cover", [(0.3, 0.72, -0.05), (0.3, 0.3, -0.05), (0.3, 0.06, -0.05)], [0.035, 0.03, 0.006], 10)
    yield tube(
        "wood", fillet([(0.3, 0.7, -0.05), (0.3, 0.84, -0.03), (0.34, 0.84, -0.02), (0.34, 0.78, -0.02)], 0.02), 0.007
    )
    yield cylinder("cane", 0.13, 0.1, (-0.2, 0.974, 0.0), sides=22)


def ringed() -> Iterator[Solid]:
    """Build a post with a ring of hooks and a coat above, and an umbrella ring below."""
    yield revolve("iron", [(0.19, 0.0), (0.18, 0.025), (0.03, 0.04)], sides=24, steps=1)
    yield rod("iron", (0.0, 0.03, 0.0), (0.0, 1.72, 0.0), 0.014, sides=12)
    for y, r in ((1.66, 0.15), (1.42, 0.12), (0.55, 0.15)):
        yield ring("iron", r, 0.014, (0.0, y, 0.0), 1, 28)
        yield from repeat_around([rod("iron", (0.0, y, 0.0), (0.0, y, r), 0.006)], 4)
    yield from repeat_around(
        [tube("iron", fillet([(0.0, 1.66, 0.15), (0.0, 1.6, 0.2), (0.0, 1.68, 0.22)], 0.02), 0.007, 6)], 8
    )
    yield ball("brass", 0.03, (0.0, 1.74, 0.0), 14, 8)
    coat = fillet([(-0.05, 1.6), (0.05, 1.6), (0.16, 1.45), (0.18, 0.75), (-0.18, 0.75), (-0.16, 1.45)], 0.04, 2, True)
    yield prism("textile", coat, 0.06, (0.0, 0.0, 0.2))


HANGERS = (
    design(coat_tree), design(coat_tripod), design(clothes_rail), design(hook_board),
    design(hook_board, shelf=True, width=1.0), design(valet), design(branches), design(ringed), design(peg_rail),
    design(scissors), design(panel),
)  # fmt: skip


FAMILIES = (FurnitureFamily("hanger", "hanger", HANGERS),)
