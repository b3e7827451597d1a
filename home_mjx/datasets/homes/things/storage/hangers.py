"""Coat stands and hooks."""

from collections.abc import Iterator

from home_mjx.datasets.homes.shapes.curves import fillet
from home_mjx.datasets.homes.shapes.groups import around
from home_mjx.datasets.homes.shapes.soft import ball, rounded
from home_mjx.datasets.homes.shapes.swept import prism, ring, rod, tube
from home_mjx.datasets.homes.shapes.turned import turned
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.storage.cases import garment
from home_mjx.datasets.homes.things.storage.coat_racks import branches, panel, peg_rail, ringed, scissors, valet
from home_mjx.datasets.procedural.primitives.solids import Solid


def clothes_rail() -> Iterator[Solid]:
    """A rail with clothes on hangers."""
    for s in (-1, 1):
        yield tube("iron", fillet([(s * 0.45, 0.03, -0.22), (s * 0.45, 0.03, 0.22)], 0.01), 0.014)
        yield rod("iron", (s * 0.45, 0.03, 0.0), (s * 0.45, 1.5, 0.0), 0.014)
        for z in (-0.2, 0.2):
            yield ball("rubber", 0.025, (s * 0.45, 0.025, z), 10, 6)
    yield rod("iron", (-0.5, 1.5, 0.0), (0.5, 1.5, 0.0), 0.014)
    for i in range(7):
        yield from garment(f"textile_{i % 5}", -0.33 + 0.11 * i, 1.5, 0.7 + 0.06 * (i % 4))


def coat_tree() -> Iterator[Solid]:
    """A post with bent hooks and a coat."""
    yield turned(
        "wood",
        [(0.2, 0.0), (0.19, 0.03), (0.04, 0.06), (0.025, 0.2), (0.022, 1.6), (0.03, 1.68), (0.005, 1.74)],
        sides=14,
    )
    hook = [
        tube("wood", fillet([(0.0, 1.52, 0.0), (0.0, 1.5, 0.12), (0.0, 1.62, 0.17)], 0.05), 0.01),
        ball("brass", 0.016, (0.0, 1.63, 0.17), 8, 4),
    ]
    yield from around(hook, 6)
    yield from around(
        [tube("wood", fillet([(0.0, 1.2, 0.0), (0.0, 1.18, 0.1), (0.0, 1.27, 0.14)], 0.04), 0.009)], 4, 0.4
    )
    yield _coat()


def coat_tripod() -> Iterator[Solid]:
    """Three crossed poles and a coat."""
    yield from around([rod("wood", (0.0, 0.0, 0.26), (0.1, 1.72, -0.12), 0.018, 0.013)], 3)
    yield from around(
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
    """A board with hooks that hangs on a wall, with a hat, a bag and a scarf."""
    yield rounded("wood", (width, 0.12, 0.02), (0.0, 0.62, -0.08), 0.006, 1)
    for i in range(5):
        x = (i - 2) * width / 5.5
        yield tube("iron", fillet([(x, 0.68, -0.07), (x, 0.65, -0.03), (x, 0.68, -0.005)], 0.02), 0.006, 6)
    if shelf:
        yield rounded("wood", (width, 0.022, 0.2), (0.0, 0.74, 0.0), 0.006, 1)
        yield rounded("cane", (0.28, 0.14, 0.18), (0.2, 0.762, 0.0), 0.02, 1)
    x = -width / 5.5
    yield prism(
        "textile",
        fillet([(x - 0.05, 0.66), (x + 0.05, 0.66), (x + 0.07, 0.1), (x - 0.07, 0.1)], 0.02, 2, True),
        0.04,
        (0.0, 0.0, -0.03),
    )
    yield rounded("leather", (0.28, 0.24, 0.09), (width / 5.5, 0.22, -0.02), 0.03, 2)
    yield tube(
        "leather",
        fillet([(width / 5.5 - 0.1, 0.44, -0.02), (width / 5.5, 0.68, -0.02), (width / 5.5 + 0.1, 0.44, -0.02)], 0.06),
        0.008,
        6,
    )


HANGERS = (
    design(coat_tree), design(coat_tripod), design(clothes_rail), design(hook_board),
    design(hook_board, shelf=True, width=1.0), design(valet), design(branches), design(ringed), design(peg_rail),
    design(scissors), design(panel),
)  # fmt: skip


FAMILIES = (Family("hanger", "hanger", HANGERS),)
