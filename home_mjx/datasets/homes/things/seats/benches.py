"""Ottomans, benches, and seats for outdoors."""

from collections.abc import Iterator

import numpy as np

from home_mjx.datasets.homes.shapes.curves import fillet, spline
from home_mjx.datasets.homes.shapes.groups import mirrored
from home_mjx.datasets.homes.shapes.sheets import surface
from home_mjx.datasets.homes.shapes.soft import ball, pillow, rounded, soft
from home_mjx.datasets.homes.shapes.swept import beam, prism, rod, sweep, tube
from home_mjx.datasets.homes.shapes.turned import turned
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.joinery import LegKind, corners, legs
from home_mjx.datasets.homes.things.seats.sofas import standing
from home_mjx.datasets.procedural.primitives.solids import Solid, box, cylinder, move, rotate


def cube() -> Iterator[Solid]:
    """A padded cube with piped edges."""
    yield box("black", (0.4, 0.02, 0.4))
    yield rounded("upholstery", (0.46, 0.42, 0.46), (0.0, 0.015, 0.0), 0.03, 3)
    for y in (0.05, 0.42):
        yield tube(
            "black",
            fillet(
                [(x, y, z) for x, z in ((-0.23, -0.23), (0.23, -0.23), (0.23, 0.23), (-0.23, 0.23))], 0.03, closed=True
            ),
            0.006,
            6,
            closed=True,
        )


def pouf(radius: float = 0.3, ribs: int = 12) -> Iterator[Solid]:
    """A round knitted cushion with gores."""
    for i in range(ribs):
        angle = 2 * np.pi * i / ribs
        x, z = np.cos(angle), np.sin(angle)
        gore = [
            (0.08 * x, 0.37, 0.08 * z),
            (0.7 * radius * x, 0.345, 0.7 * radius * z),
            (radius * x, 0.2, radius * z),
            (0.7 * radius * x, 0.045, 0.7 * radius * z),
        ]
        yield tube("textile", spline(gore, 3), np.interp(np.arange(10), [0, 3, 6, 9], [0.03, 0.052, 0.075, 0.045]), 8)
    yield turned("textile", [(0.2, 0.02), (0.26, 0.1), (0.27, 0.2), (0.2, 0.34), (0.05, 0.37)], sides=20, steps=2)
    yield ball("textile", (0.05, 0.02, 0.05), (0.0, 0.39, 0.0), 10, 4)


def footstool(kind: LegKind = "turned", width: float = 0.6, fabric: str = "patterned") -> Iterator[Solid]:
    """A padded top on four legs."""
    yield from legs("wood", width - 0.06, 0.38, 0.26, kind, 0.05)
    yield rounded("wood", (width - 0.02, 0.05, 0.42), (0.0, 0.23, 0.0), 0.01, 1)
    yield soft(fabric, (width, 0.15, 0.44), (0.0, 0.27, 0.0), 6.0, 6)


def drum() -> Iterator[Solid]:
    """A round padded drum with a metal foot ring."""
    yield cylinder("brass", 0.27, 0.04, sides=28)
    yield turned("upholstery", [(0.26, 0.04), (0.28, 0.08), (0.28, 0.36), (0.25, 0.41)], sides=28, steps=2)


def tufted(width: float = 0.9) -> Iterator[Solid]:
    """A large square with a grid of pads."""
    yield from legs("wood", width - 0.1, width - 0.1, 0.12, "block", 0.06)
    yield rounded("leather", (width, 0.2, width), (0.0, 0.11, 0.0), 0.03, 1)
    step = width / 4
    for i in range(4):
        for j in range(4):
            yield soft("leather", (step, 0.14, step), ((i - 1.5) * step, 0.29, (j - 1.5) * step), 3.5, 4)


def x_stool() -> Iterator[Solid]:
    """A cushion on crossed legs."""
    for s in (-1, 1):
        for a in (-1, 1):
            yield beam("brass", (a * 0.24, 0.0, s * 0.16), (-a * 0.24, 0.4, s * 0.16), 0.022)
    yield rod("brass", (0.0, 0.2, -0.16), (0.0, 0.2, 0.16), 0.012)
    yield soft("upholstery", (0.58, 0.12, 0.42), (0.0, 0.38, 0.0), 5.0, 6)


def storage_pouf() -> Iterator[Solid]:
    """A round tub whose padded lid is set off by a gap."""
    yield cylinder("cane", 0.24, 0.3, (0.0, 0.02, 0.0), 0.26, 24)
    yield cylinder("black", 0.24, 0.03, (0.0, 0.31, 0.0), sides=24)
    yield turned("upholstery", [(0.25, 0.0), (0.27, 0.02), (0.26, 0.07), (0.2, 0.1)], (0.0, 0.335, 0.0), 24, 2)
    for angle in (0.4, 2.5, 4.6):
        yield cylinder("wood", 0.025, 0.03, (0.18 * np.cos(angle), 0.0, 0.18 * np.sin(angle)), sides=10)


def saddle() -> Iterator[Solid]:
    """A seat that sags between two ends, on splayed legs."""
    yield from legs("wood", 0.5, 0.34, 0.36, "splay", 0.05)
    yield surface("wood", lambda u, v: ((u - 0.5) * 0.56, 0.36 + 0.1 * (2 * u - 1) ** 2, (v - 0.5) * 0.38), 12, 3, 0.03)
    yield surface(
        "leather", lambda u, v: ((u - 0.5) * 0.48, 0.395 + 0.1 * (2 * u - 1) ** 2 * 0.73, (v - 0.5) * 0.34), 12, 4, 0.04
    )


def plank(width: float = 1.2, kind: LegKind = "square") -> Iterator[Solid]:
    """A thick board on legs."""
    yield from legs("wood", width - 0.1, 0.32, 0.42, kind, 0.055)
    yield rounded("wood_1", (width, 0.045, 0.36), (0.0, 0.41, 0.0), 0.015, 2)


def padded(width: float = 1.15, kind: LegKind = "hairpin") -> Iterator[Solid]:
    """A long padded seat on legs."""
    yield from legs("iron", width - 0.06, 0.36, 0.4, kind, 0.05)
    yield rounded("wood", (width - 0.02, 0.03, 0.38), (0.0, 0.38, 0.0), 0.01, 1)
    yield soft("upholstery", (width, 0.1, 0.4), (0.0, 0.39, 0.0), 14.0, 6)


def scroll_bench(width: float = 1.2) -> Iterator[Solid]:
    """An upholstered bench whose ends curl up."""
    path = fillet(
        [(-width / 2, 0.62, 0.0), (-width / 2 + 0.08, 0.4, 0.0), (width / 2 - 0.08, 0.4, 0.0), (width / 2, 0.62, 0.0)],
        0.16,
        5,
    )
    yield sweep(
        "upholstery", path, np.array([[-0.2, -0.05], [0.2, -0.05], [0.2, 0.05], [-0.2, 0.05]]), up=(0.0, 1.0, 0.0)
    )
    yield from mirrored([tube("upholstery", [(width / 2 + 0.01, 0.63, -0.2), (width / 2 + 0.01, 0.63, 0.2)], 0.06, 12)])
    yield from legs("wood", width - 0.2, 0.36, 0.37, "turned", 0.055)


def hall_bench(width: float = 1.1) -> Iterator[Solid]:
    """A seat with a slatted back and arms."""
    for s in (-1, 1):
        x = s * (width / 2 - 0.025)
        yield beam("wood", (x, 0.0, 0.19), (x, 0.64, 0.19), 0.045)
        yield beam("wood", (x, 0.0, -0.19), (x, 0.9, -0.23), 0.045)
        yield rounded("wood", (0.06, 0.03, 0.48), (x, 0.64, 0.0), 0.01, 1)
    yield rounded("wood", (width, 0.035, 0.42), (0.0, 0.42, 0.0), 0.01, 1)
    for y in (0.56, 0.85):
        yield beam("wood", (-width / 2 + 0.04, y, -0.21), (width / 2 - 0.04, y, -0.225), 0.025, 0.06)
    for i in range(9):
        x = (i - 4) * (width - 0.14) / 9
        yield beam("wood", (x, 0.56, -0.21), (x, 0.85, -0.225), 0.045, 0.012)


def chest_bench(width: float = 1.1, style: str = "panels", back: bool = False) -> Iterator[Solid]:
    """A chest to sit on, with a cushion on its lid."""
    yield rounded("wood", (width, 0.38, 0.42), (0.0, 0.03, 0.0), 0.01, 1)
    yield box("wood", (width - 0.06, 0.04, 0.36))
    if style == "panels":
        for i in range(3):
            yield rounded("wood_1", (width / 3 - 0.1, 0.24, 0.02), ((i - 1) * width / 3, 0.1, 0.21), 0.008, 1)
    else:
        for i in range(3):
            yield rounded("cane", (width / 3 - 0.04, 0.3, 0.03), ((i - 1) * width / 3, 0.06, 0.205), 0.01, 1)
            yield box("black", (0.1, 0.025, 0.01), ((i - 1) * width / 3, 0.28, 0.222))
    yield rounded("wood_1", (width + 0.03, 0.03, 0.45), (0.0, 0.41, 0.0), 0.01, 1)
    yield soft("textile", (width - 0.04, 0.07, 0.4), (0.0, 0.435, 0.01), 12.0, 6)
    if back:
        yield prism(
            "wood",
            fillet(
                [(-width / 2, 0.4), (width / 2, 0.4), (width / 2, 0.85), (0.0, 0.95), (-width / 2, 0.85)], 0.08, 4, True
            ),
            0.03,
            (0.0, 0.0, -0.2),
        )
    yield from mirrored([box("iron", (0.02, 0.03, 0.1), (width / 2 + 0.008, 0.25, 0.0))])


def park_bench(width: float = 1.5) -> Iterator[Solid]:
    """Boards on cast-iron ends."""
    for s in (-1, 1):
        x = s * (width / 2 - 0.1)
        side = [(0.26, 0.0), (0.2, 0.4), (-0.2, 0.42), (-0.36, 0.84)]
        yield tube("iron", fillet([(x, y, z) for z, y in side], 0.08), 0.02)
        yield tube(
            "iron",
            fillet([(x, 0.0, -0.28), (x, 0.42, -0.18), (x, 0.62, -0.24), (x, 0.62, 0.22), (x, 0.4, 0.2)], 0.06),
            0.018,
        )
    for z in (-0.14, -0.03, 0.08, 0.19):
        yield rounded("wood", (width, 0.03, 0.09), (0.0, 0.43, z), 0.01, 1)
    for y in (0.54, 0.66, 0.78):
        yield beam(
            "wood",
            (-width / 2, y, -0.225 - 0.38 * (y - 0.46)),
            (width / 2, y, -0.225 - 0.38 * (y - 0.46)),
            0.026,
            0.085,
        )


def adirondack(width: float = 0.74) -> Iterator[Solid]:
    """A garden chair of broad boards with a fanned back."""
    for s in (-1, 1):
        x = s * (width / 2 - 0.06)
        yield beam("wood", (x, 0.36, 0.3), (x, 0.04, -0.5), 0.03, 0.1)
        yield beam("wood", (x, 0.0, 0.3), (x, 0.55, 0.3), 0.03, 0.1)
        yield rounded("wood", (0.13, 0.025, 0.74), (s * (width / 2 - 0.04), 0.55, -0.02), 0.01, 1)
    for i in range(6):
        y, z = 0.39 - 0.05 * i, 0.26 - 0.1 * i
        yield beam("wood", (-width / 2 + 0.05, y, z), (width / 2 - 0.05, y, z), 0.09, 0.02)
    for i in range(5):
        x = (i - 2) * 0.105
        top = 1.0 - 0.035 * (i - 2) ** 2
        yield beam("wood", (x, 0.2, -0.24), (1.25 * x, top, -0.6), 0.092, 0.02)
    yield beam("wood", (-0.32, 0.56, -0.42), (0.32, 0.56, -0.42), 0.03, 0.06)


def wicker_chair(seats: int = 1) -> Iterator[Solid]:
    """A woven tub with a cushion; a loveseat if it has two seats."""
    width = 0.3 + 0.5 * seats

    def place(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
        angle = np.pi * (0.9 + 1.2 * u)
        x = np.sign(np.cos(angle)) * np.abs(np.cos(angle)) ** 0.6
        return (
            width / 2 * x * (1 + 0.06 * v),
            0.02 + v * (0.58 + 0.22 * np.sin(np.pi * u) ** 2),
            0.36 * np.sign(np.sin(angle)) * np.abs(np.sin(angle)) ** 0.6 * (1 + 0.06 * v),
        )

    yield surface("cane", place, 26, 4, 0.045)
    yield box("cane", (width - 0.1, 0.3, 0.62), (0.0, 0.02, 0.03))
    for i in range(seats):
        x = (i - (seats - 1) / 2) * 0.52
        yield soft("textile", (0.5 + 0.1 * (seats == 1), 0.12, 0.6), (x, 0.31, 0.04), 6.0, 5)
        yield standing("textile_1", (0.46, 0.42, 0.14), (x, 0.42, -0.2), 0.3)


def sunbed(width: float = 0.66) -> Iterator[Solid]:
    """A lounger with slats, a raised back, a mat and wheels."""
    for s in (-1, 1):
        x = s * (width / 2 - 0.02)
        yield beam("wood", (x, 0.3, -0.45), (x, 0.3, 0.98), 0.035, 0.06)
        yield beam("wood", (x, 0.31, -0.42), (x, 0.68, -0.98), 0.03, 0.05)
        yield beam("wood", (x, 0.0, 0.85), (x, 0.3, 0.85), 0.05)
        yield _wheel(x + s * 0.03)
    for z in np.linspace(-0.4, 0.95, 14):
        yield beam("wood", (-width / 2, 0.335, float(z)), (width / 2, 0.335, float(z)), 0.06, 0.014)
    yield rounded("textile", (width - 0.04, 0.06, 1.4), (0.0, 0.34, 0.27), 0.025, 2)
    yield rotate(
        rounded("textile", (width - 0.04, 0.06, 0.7), (0.0, 0.34, -0.77), 0.025, 2), 0, 0.58, (0.0, 0.34, -0.42)
    )
    yield rotate(pillow("textile", (0.5, 0.1, 0.24), (0.0, 0.39, -0.98)), 0, 0.58, (0.0, 0.34, -0.42))


def _wheel(x: float) -> Solid:
    wheel = rotate(cylinder("rubber", 0.13, 0.03, (0.0, -0.015, 0.0), sides=18), 2, np.pi / 2)
    return move(wheel, (x, 0.13, -0.4))


def swing(width: float = 1.5) -> Iterator[Solid]:
    """A bench that hangs from a frame with a canopy."""
    for s in (-1, 1):
        x = s * (width / 2 + 0.15)
        yield rod("iron", (x, 0.0, 0.55), (x, 1.8, 0.0), 0.025)
        yield rod("iron", (x, 0.0, -0.55), (x, 1.8, 0.0), 0.025)
        yield rod("iron", (s * width / 2, 0.58, 0.2), (s * width / 2, 1.78, 0.0), 0.008, sides=6)
        yield rod("iron", (s * width / 2, 0.9, -0.28), (s * width / 2, 1.78, 0.0), 0.008, sides=6)
    yield rod("iron", (-width / 2 - 0.2, 1.8, 0.0), (width / 2 + 0.2, 1.8, 0.0), 0.03)
    yield rounded("wood", (width, 0.04, 0.54), (0.0, 0.44, 0.0), 0.01, 1)
    yield soft("textile", (width - 0.04, 0.1, 0.52), (0.0, 0.47, 0.01), 14.0, 6)
    yield rotate(soft("textile", (width - 0.04, 0.46, 0.1), (0.0, 0.48, -0.25), 14.0, 6), 0, -0.2, (0.0, 0.48, -0.25))
    yield surface(
        "textile_1",
        lambda u, v: ((u - 0.5) * (width + 0.4), 1.82 + 0.1 * np.sin(np.pi * v), (v - 0.5) * 1.1),
        4,
        8,
        0.02,
    )


def picnic_table(width: float = 1.7) -> Iterator[Solid]:
    """A table and two benches in one."""
    for x in (-0.6, 0.6):
        for s in (-1, 1):
            yield beam("wood", (x, 0.0, s * 0.62), (x, 0.72, s * 0.25), 0.04, 0.1)
        yield beam("wood", (x + 0.045, 0.42, -0.78), (x + 0.045, 0.42, 0.78), 0.04, 0.09)
        yield beam("wood", (x + 0.045, 0.69, -0.36), (x + 0.045, 0.69, 0.36), 0.04, 0.08)
    for i in range(5):
        yield rounded("wood", (width, 0.035, 0.14), (0.0, 0.73, (i - 2) * 0.15), 0.01, 1)
    for s in (-1, 1):
        for z in (0.63, 0.77):
            yield rounded("wood", (width, 0.035, 0.13), (0.0, 0.465, s * z), 0.01, 1)


def plastic_chair() -> Iterator[Solid]:
    """A stackable garden chair of one moulding with slots in its back."""
    for x, z in corners(0.46, 0.44):
        yield beam("white", (1.12 * x, 0.0, 1.15 * z), (x, 0.62 if z > 0 else 0.44, z), 0.05, 0.035)
    yield surface(
        "white",
        lambda u, v: ((u - 0.5) * 0.46, 0.43 - 0.03 * np.sin(np.pi * u) - 0.02 * (1 - v), (v - 0.5) * 0.46),
        6,
        6,
        0.014,
    )
    for i in range(6):
        x = (i - 2.5) * 0.075
        yield beam("white", (x, 0.42, -0.22), (1.1 * x, 0.82 - 0.8 * x**2, -0.3), 0.05, 0.012)
    yield tube(
        "white",
        [(-0.23, 0.6, -0.24), (-0.22, 0.8, -0.3), (0.0, 0.86, -0.32), (0.22, 0.8, -0.3), (0.23, 0.6, -0.24)],
        0.022,
    )
    yield from mirrored(
        [tube("white", fillet([(0.24, 0.64, 0.2), (0.27, 0.65, 0.0), (0.23, 0.62, -0.24)], 0.08), 0.024)]
    )


OTTOMANS = (
    design(cube), design(pouf), design(footstool), design(drum), design(tufted), design(x_stool),
    design(storage_pouf), design(footstool, kind="splay", fabric="upholstery"),
    design(footstool, kind="sled", width=0.8, fabric="leather"), design(footstool, kind="cabriole", width=0.54),
    design(saddle),
)  # fmt: skip
BENCHES = (
    design(plank), design(padded), design(scroll_bench), design(hall_bench), design(plank, width=1.4, kind="sled"),
    design(padded, width=1.3, kind="taper"), design(park_bench), design(plank, width=1.0, kind="splay"),
)  # fmt: skip
CHESTS = (design(chest_bench), design(chest_bench, style="baskets"), design(chest_bench, back=True, width=0.95))
GARDEN = (
    design(adirondack), design(wicker_chair), design(wicker_chair, seats=2), design(sunbed), design(swing),
    design(picnic_table), design(plastic_chair), design(park_bench, width=1.3),
)  # fmt: skip

FAMILIES = (
    Family("ottoman", "ottoman", OTTOMANS),
    Family("bench", "bench_chair", BENCHES),
    Family("storage_bench", "storage_bench", CHESTS),
    Family("outdoor_seating", "outdoor_seating", GARDEN),
)
