"""Chairs."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder, rotate
from home_procgen.shapes.curves import arc, fillet, loop, spline
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import padded_block, rounded_box
from home_procgen.shapes.sheets import surface
from home_procgen.shapes.sweep import band, beam, prism, ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import LegKind, corners, legs

SEAT_HEIGHT = 0.45  # [m], height of the seat


def _posts(
    material: str, width: float, depth: float, top: float, lean: float = 0.1, bar: float = 0.036
) -> Iterator[Solid]:
    """Build front legs, and back legs that continue as reclined posts above the seat."""
    x, z = (width - bar) / 2, (depth - bar) / 2
    for side in (-x, x):
        yield beam(material, (side, 0.0, z), (side, SEAT_HEIGHT - 0.02, z), bar)
        yield beam(material, (side, 0.0, -z - 0.03), (side, SEAT_HEIGHT, -z), bar)
        yield beam(material, (side, SEAT_HEIGHT - 0.01, -z), (side, top, -z - lean), bar, 0.8 * bar)


def ladder_back(width: float = 0.44, depth: float = 0.44, top: float = 0.95, slats: int = 4) -> Iterator[Solid]:
    """Build a ladder-back chair with curved slats, a rush seat and stretchers."""
    yield from _posts("wood", width, depth, top)
    yield padded_block("cane", (width - 0.01, 0.05, depth), (0.0, SEAT_HEIGHT - 0.04, 0.0), 9.0, 4)
    for i in range(slats):
        share = (i + 1) / slats
        y, z = SEAT_HEIGHT + share * (top - SEAT_HEIGHT) - 0.05, 0.018 - depth / 2 - 0.1 * share
        path = [(x, y, z - 0.03 * (1 - (2 * x / width) ** 2)) for x in np.linspace(-1, 1, 7) * (width - 0.04) / 2]
        yield band("wood", path, 0.016, 0.055)
    for side in (-1, 1):
        for y in (0.16, 0.28):
            x = side * (width - 0.036) / 2
            yield rod("wood", (x, y, -depth / 2), (x, y, depth / 2 - 0.02), 0.01)
    yield rod("wood", (-width / 2 + 0.02, 0.3, depth / 2 - 0.018), (width / 2 - 0.02, 0.3, depth / 2 - 0.018), 0.011)


def windsor(width: float = 0.46, top: float = 0.98, spindles: int = 7) -> Iterator[Solid]:
    """Build a Windsor chair: a saddle seat on splayed turned legs, with spindles inside a bent hoop."""
    yield padded_block("wood", (width, 0.045, 0.44), (0.0, SEAT_HEIGHT - 0.045, 0.0), 4.0, 6)
    for x, z in corners(0.28, 0.28):
        yield rod("wood", (1.45 * x, 0.0, 1.45 * z), (x, SEAT_HEIGHT - 0.02, z), 0.012, 0.019, 10)
    for x in (-0.17, 0.17):
        yield rod("wood", (x, 0.2, -0.17), (x, 0.2, 0.17), 0.011)
    yield rod("wood", (-0.17, 0.2, 0.0), (0.17, 0.2, 0.0), 0.011)
    bow = arc(1.0, 0.0, np.pi, 14) * (0.21, top - SEAT_HEIGHT - 0.08) + (0.0, 0.06)
    hoop = [(0.19, 0.0), *map(tuple, bow), (-0.19, 0.0)]
    lean = [(x, SEAT_HEIGHT - 0.02 + y, -0.17 - 0.2 * y) for x, y in hoop]
    yield tube("wood", lean, 0.012)
    for s in np.linspace(-1, 1, spindles + 2)[1:-1]:
        high = top - SEAT_HEIGHT - 0.03 - (1 - np.sqrt(1 - (0.9 * s) ** 2)) * (top - SEAT_HEIGHT - 0.1)
        yield rod(
            "wood",
            (0.15 * s, SEAT_HEIGHT - 0.02, -0.17),
            (0.19 * s, SEAT_HEIGHT + high, -0.17 - 0.2 * high),
            0.006,
            sides=6,
        )


def parsons(width: float = 0.48, top: float = 1.0) -> Iterator[Solid]:
    """Build a fully upholstered chair on square legs."""
    yield from legs("wood", width, 0.5, 0.36, "square", 0.045)
    yield padded_block("upholstery", (width, 0.15, 0.54), (0.0, 0.33, 0.0), 9.0, 6)
    yield rotate(
        padded_block("upholstery", (width, top - 0.36, 0.09), (0.0, 0.38, -0.235), 9.0, 6), 0, -0.1, (0.0, 0.4, -0.235)
    )


def shell(width: float = 0.48, base: str = "dowel", padded: bool = False) -> Iterator[Solid]:
    """Build a moulded one-piece seat and back on dowels, a wire frame or a column."""
    profile = spline(
        [(0.21, 0.43), (0.17, 0.455), (0.0, 0.43), (-0.15, 0.44), (-0.2, 0.52), (-0.23, 0.66), (-0.25, 0.82)], 3
    )

    def place(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
        line = u * (len(profile) - 1)
        z, y = (np.interp(line, np.arange(len(profile)), profile[:, k]) for k in (0, 1))
        s = 2 * v - 1
        half = width / 2 * (1 - 0.28 * u**4) * (1 - 0.3 * np.clip(0.12 - u, 0, 1) / 0.12)
        return s * half, y + 0.05 * s**2 * (1 - u), z + 0.07 * s**2 * u

    yield surface("bright" if not padded else "upholstery", place, 14, 8, 0.012)
    if padded:
        yield padded_block("upholstery_1", (width - 0.08, 0.05, 0.36), (0.0, 0.425, 0.0), 5.0, 4)
    yield from _shell_base(base)


def _shell_base(base: str) -> Iterator[Solid]:
    if base == "dowel":
        for x, z in corners(0.24, 0.22):
            yield rod("wood", (1.8 * x, 0.0, 1.8 * z), (x, 0.43, z), 0.011, 0.017)
        for a in (-1, 1):
            yield rod("iron", (-0.16 * a, 0.18, -0.15), (0.13 * a, 0.4, 0.12), 0.005, sides=6)
    elif base == "column":
        yield revolve(
            "chrome", [(0.23, 0.0), (0.22, 0.015), (0.05, 0.03), (0.03, 0.08), (0.028, 0.4), (0.1, 0.43)], sides=20
        )
    else:
        for x in (-0.17, 0.17):
            path = fillet([(x, 0.43, 0.12), (1.2 * x, 0.01, 0.2), (1.2 * x, 0.01, -0.2), (x, 0.43, -0.12)], 0.04)
            yield tube("chrome", path, 0.008, 6)
        for z in (-0.12, 0.12):
            yield rod("chrome", (-0.18, 0.42, z), (0.18, 0.42, z), 0.008, sides=6)


def cantilever(width: float = 0.46) -> Iterator[Solid]:
    """Build a cantilever chair of one bent tube, with a caned seat and back."""
    x = width / 2
    side = [(0.2, 0.86, -0.24), (x, 0.5, -0.2), (x, 0.44, 0.22), (x, 0.012, 0.26), (x, 0.012, -0.24)]
    path = [*side, *[(-a, b, c) for a, b, c in side[::-1]]]
    yield tube("chrome", fillet([(0.0, 0.86, -0.24), *path[:5], *path[5:], (0.0, 0.86, -0.24)], 0.07), 0.012)
    yield rounded_box("wood", (width - 0.01, 0.024, 0.42), (0.0, 0.44, 0.01), 0.01, 1)
    yield box("cane", (width - 0.08, 0.028, 0.35), (0.0, 0.438, 0.01))
    back = rounded_box("wood", (0.42, 0.2, 0.02), (0.0, 0.62, -0.22), 0.009, 1)
    yield rotate(back, 0, -0.12, (0.0, 0.62, -0.22))
    yield rotate(box("cane", (0.36, 0.14, 0.024), (0.0, 0.65, -0.22)), 0, -0.12, (0.0, 0.62, -0.22))


def wishbone(width: float = 0.54) -> Iterator[Solid]:
    """Build a chair with a round top rail on curved back legs and a Y-shaped splat."""
    yield rounded_box("cane", (0.48, 0.035, 0.42), (0.0, SEAT_HEIGHT - 0.03, 0.02), 0.015, 2)
    rail = [(a, 0.75, b - 0.05) for a, b in arc(1.0, np.pi * 1.02, np.pi * 1.98, 14) * (width / 2, 0.2)]
    rail = [(a, 0.72 + 0.04 * np.sin(np.pi * i / 14), b) for i, (a, _, b) in enumerate(rail)]
    yield tube("wood", rail, 0.014)
    for s in (-1, 1):
        yield rod("wood", (s * 0.22, 0.0, 0.2), (s * 0.21, SEAT_HEIGHT, 0.2), 0.013, 0.018, 10)
        yield tube(
            "wood", spline([(s * 0.2, 0.0, -0.22), (s * 0.19, SEAT_HEIGHT, -0.17), (s * 0.24, 0.73, -0.12)], 5), 0.017
        )
        yield beam("wood", (0.0, 0.56, -0.205), (s * 0.07, 0.74, -0.245), 0.03, 0.01)
        yield beam("wood", (s * 0.21, 0.41, -0.18), (s * 0.21, 0.41, 0.2), 0.02, 0.03)
    yield beam("wood", (0.0, SEAT_HEIGHT - 0.02, -0.18), (0.0, 0.57, -0.207), 0.035, 0.01)


def bentwood(width: float = 0.42) -> Iterator[Solid]:
    """Build a café chair: a round seat, two nested back hoops and a ring between the legs."""
    yield cylinder("wood", width / 2, 0.03, (0.0, SEAT_HEIGHT - 0.03, 0.0), sides=24)
    yield cylinder("cane", 0.17, 0.008, (0.0, SEAT_HEIGHT - 0.004, 0.0), sides=24)
    yield ring("wood", 0.165, 0.018, (0.0, 0.22, 0.0), 1, 24)
    for x, z in ((-0.15, 0.13), (0.15, 0.13)):
        yield rod("wood", (1.15 * x, 0.0, 1.25 * z), (x, SEAT_HEIGHT - 0.02, z), 0.011, 0.016, 10)
    for half, top, bar in ((0.18, 0.88, 0.014), (0.11, 0.78, 0.011)):
        hoop = spline(
            [
                (half, SEAT_HEIGHT - 0.02, -0.13),
                (half * 1.1, 0.66, -0.18),
                (0.62 * half, top - 0.02, -0.24),
                (0.0, top, -0.25),
            ],
            4,
        )
        path = np.concatenate([hoop, hoop[-2::-1] * (-1, 1, 1)])
        yield tube("wood", path, bar)
    for s in (-1, 1):
        yield rod("wood", (s * 0.19, 0.0, -0.2), (s * 0.17, SEAT_HEIGHT, -0.12), 0.011, 0.015, 10)


def folding(width: float = 0.44) -> Iterator[Solid]:
    """Build a slatted folding chair with crossed legs."""
    for s in (-1, 1):
        x = s * width / 2
        yield beam("wood_1", (x, 0.0, 0.22), (x, 0.82, -0.24), 0.02, 0.035)
        yield beam("wood_1", (x - s * 0.024, 0.0, -0.2), (x - s * 0.024, SEAT_HEIGHT, 0.2), 0.02, 0.035)
    for i in range(6):
        yield rounded_box("wood", (width + 0.02, 0.014, 0.055), (0.0, SEAT_HEIGHT, -0.17 + 0.068 * i), 0.006, 1)
    for y in (0.66, 0.73, 0.8):
        z = 0.22 - 0.46 * y / 0.82 + 0.01
        yield beam("wood", (-width / 2, y - 0.02, z), (width / 2, y - 0.02, z), 0.012, 0.05)
    for y, z in ((0.1, 0.155), (0.1, -0.115)):
        yield rod("wood_1", (-width / 2, y, z), (width / 2, y, z), 0.009)


def medallion(width: float = 0.5) -> Iterator[Solid]:
    """Build a chair with an oval padded back in a carved frame, on turned legs."""
    yield from legs("wood", 0.48, 0.46, SEAT_HEIGHT - 0.1, "turned", 0.055)
    yield rounded_box("wood", (width, 0.06, 0.48), (0.0, SEAT_HEIGHT - 0.11, 0.0), 0.02, 2)
    yield padded_block("patterned", (width - 0.03, 0.11, 0.45), (0.0, SEAT_HEIGHT - 0.06, 0.01), 5.0, 6)
    frame = [(x, 0.76 + y, -0.245 - 0.12 * y) for x, y in loop(0.42, 0.46, 20)]
    yield tube("wood", frame, 0.02, 8, closed=True)
    oval = [(x, y) for x, y in loop(0.39, 0.43, 20)]
    yield rotate(prism("patterned", oval, 0.045, (0.0, 0.76, -0.245)), 0, -0.12, (0.0, 0.76, -0.245))
    for x in (-0.09, 0.09):
        yield beam("wood", (x, 0.4, -0.2), (x, 0.57, -0.23), 0.03)


def industrial(width: float = 0.42) -> Iterator[Solid]:
    """Build a pressed sheet metal chair with splayed legs."""
    yield rounded_box("paint", (0.36, 0.025, 0.36), (0.0, SEAT_HEIGHT - 0.025, 0.0), 0.01, 2)
    yield rounded_box("paint", (0.37, 0.05, 0.37), (0.0, SEAT_HEIGHT - 0.07, 0.0), 0.01, 1)
    for x, z in corners(0.32, 0.32):
        yield beam("paint", (1.35 * x, 0.0, 1.35 * z), (x, SEAT_HEIGHT - 0.02, z), 0.035)
    hoop = [(s * 0.17, SEAT_HEIGHT - 0.05, -0.16) for s in (-1,)]
    top = fillet([hoop[0], (-0.18, 0.84, -0.24), (0.18, 0.84, -0.24), (0.17, SEAT_HEIGHT - 0.05, -0.16)], 0.09, 4)
    yield tube("paint", top, 0.012)
    yield beam("paint", (0.0, SEAT_HEIGHT - 0.04, -0.17), (0.0, 0.83, -0.235), 0.12, 0.006)
    for a, b in (((-1, -1), (1, 1)), ((-1, 1), (1, -1))):
        yield beam("paint", (0.19 * a[0], 0.16, 0.19 * a[1]), (0.19 * b[0], 0.16, 0.19 * b[1]), 0.02, 0.006)


def plywood(width: float = 0.42) -> Iterator[Solid]:
    """Build a school chair: a steel frame with two bent plywood panels."""
    for s in (-1, 1):
        x = s * 0.19
        yield tube("iron", fillet([(x, 0.0, 0.2), (x, 0.43, 0.17), (x, 0.43, -0.17), (x, 0.82, -0.24)], 0.05), 0.011)
        yield rod("iron", (x, 0.0, -0.24), (x, 0.43, -0.1), 0.011)
    yield rod("iron", (-0.19, 0.42, 0.1), (0.19, 0.42, 0.1), 0.011)
    yield surface(
        "wood",
        lambda u, v: ((u - 0.5) * width, 0.447 - 0.02 * np.sin(np.pi * u) - 0.03 * v**6, (v - 0.5) * 0.4),
        8,
        8,
        0.012,
    )
    yield surface(
        "wood",
        lambda u, v: ((u - 0.5) * width, 0.64 + 0.2 * v, -0.19 - 0.05 * v - 0.04 * np.sin(np.pi * u)),
        8,
        3,
        0.012,
    )


def slipper(width: float = 0.5, kind: LegKind = "taper", top: float = 0.86) -> Iterator[Solid]:
    """Build a chair with a padded seat and a curved, wrap-around padded back."""
    yield from legs("wood", 0.46, 0.44, 0.34, kind, 0.045)
    yield padded_block("upholstery", (width, 0.13, 0.5), (0.0, 0.33, 0.0), 5.0, 6)

    def place(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
        angle = np.pi * (1.12 + 0.76 * u)
        return (
            width / 2 * np.cos(angle) * (1 + 0.12 * v),
            0.4 + (top - 0.4) * v - 0.08 * (2 * u - 1) ** 4 * v,
            0.02 + 0.27 * np.sin(angle) - 0.06 * v,
        )

    yield surface("upholstery", place, 14, 5, 0.05)


CHAIRS = (
    design(ladder_back), design(windsor), design(parsons), design(shell), design(shell, base="wire", width=0.5),
    design(cantilever), design(wishbone), design(bentwood), design(medallion), design(industrial), design(plywood),
    design(slipper), design(slipper, kind="sled", width=0.54, top=0.8),
    design(ladder_back, slats=2, top=0.84, width=0.46), design(folding), design(shell, base="column", padded=True),
    design(windsor, spindles=9, top=0.9, width=0.5),
)  # fmt: skip


FAMILIES = (FurnitureFamily("chair", "chair", CHAIRS),)
