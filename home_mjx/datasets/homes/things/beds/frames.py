"""Beds for one and for two, cots and bunks."""

from collections.abc import Iterator

import numpy as np

from home_mjx.datasets.homes.shapes.curves import arc, fillet
from home_mjx.datasets.homes.shapes.groups import mirrored
from home_mjx.datasets.homes.shapes.sheets import surface
from home_mjx.datasets.homes.shapes.soft import ball, rounded, soft
from home_mjx.datasets.homes.shapes.swept import beam, prism, rod, tube
from home_mjx.datasets.homes.shapes.turned import turned
from home_mjx.datasets.homes.things.beds.bedding import Cover, bedding
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.joinery import LegKind, drawers, legs
from home_mjx.datasets.procedural.primitives.solids import Solid, box, cylinder, move, rotate

LENGTH = 2.0  # [m], of a mattress


def _rails(width: float, low: float, high: float, slot: str = "wood") -> Iterator[Solid]:
    """A frame around the mattress and the board that carries it."""
    z = LENGTH / 2 + 0.02
    yield from mirrored([rounded(slot, (0.035, high - low, 2 * z + 0.03), (width / 2 + 0.02, low, 0.0), 0.008, 1)])
    yield rounded(slot, (width + 0.07, high - low, 0.035), (0.0, low, z), 0.008, 1)
    yield box(slot, (width, 0.03, 2 * z - 0.01), (0.0, high - 0.08, 0.0))


def platform(
    width: float = 1.6, cover: Cover = "made", kind: LegKind = "taper", head: str = "panel", pillows: int = 2
) -> Iterator[Solid]:
    """A low frame on legs with a plain, slatted or caned headboard."""
    yield from legs("wood", width + 0.04, LENGTH, 0.2, kind, 0.06)
    yield from _rails(width, 0.18, 0.34)
    yield from bedding(width, LENGTH, 0.29, cover, pillows)
    z = -LENGTH / 2 - 0.045
    if head == "panel":
        yield rounded("wood", (width + 0.08, 0.75, 0.035), (0.0, 0.18, z), 0.012, 2)
    elif head == "slats":
        for y in (0.52, 0.66, 0.8, 0.94):
            yield rounded("wood", (width + 0.06, 0.08, 0.025), (0.0, y, z), 0.01, 1)
        for x in (-0.42, 0.42):
            yield box("wood", (0.06, 0.85, 0.03), (x * width, 0.18, z - 0.01))
    else:
        yield tube(
            "wood",
            fillet([(-width / 2, 0.18, z), (-width / 2, 1.0, z), (width / 2, 1.0, z), (width / 2, 0.18, z)], 0.1),
            0.022,
        )
        yield box("cane", (width - 0.02, 0.5, 0.014), (0.0, 0.46, z))


def upholstered(width: float = 1.6, cover: Cover = "folded", head: str = "tufted", pillows: int = 2) -> Iterator[Solid]:
    """Padded all around, with a tall tufted, channelled or winged headboard."""
    yield from legs("wood", width, LENGTH, 0.1, "block", 0.07)
    z = -LENGTH / 2 - 0.07
    for s in (-1, 1):
        yield rounded("upholstery", (0.07, 0.26, LENGTH + 0.1), (s * (width / 2 + 0.03), 0.1, 0.0), 0.03, 2)
    yield rounded("upholstery", (width + 0.13, 0.26, 0.07), (0.0, 0.1, LENGTH / 2 + 0.03), 0.03, 2)
    yield box("black", (width, 0.04, LENGTH), (0.0, 0.22, 0.0))
    yield rounded("upholstery", (width + 0.14, 1.05, 0.1), (0.0, 0.1, z), 0.04, 2)
    if head == "tufted":
        for row in range(3):
            for i in range(6):
                yield soft(
                    "upholstery",
                    ((width + 0.08) / 6, 0.2, 0.07),
                    ((i - 2.5) * (width + 0.08) / 6, 0.5 + 0.2 * row, z + 0.05),
                    3.0,
                    3,
                )
    elif head == "channels":
        for i in range(9):
            yield soft(
                "upholstery", ((width + 0.1) / 9, 0.62, 0.09), ((i - 4) * (width + 0.1) / 9, 0.5, z + 0.05), 4.0, 4
            )
    else:
        yield soft("upholstery", (width, 0.6, 0.08), (0.0, 0.48, z + 0.05), 9.0, 6)
        yield from mirrored([rounded("upholstery", (0.08, 1.05, 0.3), (width / 2 + 0.06, 0.1, z + 0.12), 0.035, 2)])
    yield from bedding(width, LENGTH, 0.26, cover, pillows, 0.24)


def sleigh(width: float = 1.6, cover: Cover = "made", pillows: int = 2) -> Iterator[Solid]:
    """Scrolled head and foot boards."""
    yield from _rails(width, 0.16, 0.38)
    for z, high, out in ((-LENGTH / 2 - 0.06, 1.1, -1), (LENGTH / 2 + 0.06, 0.72, 1)):
        profile = fillet(
            [(z, 0.06), (z - 0.03 * out, 0.55 * high), (z + 0.02 * out, high - 0.05), (z + 0.14 * out, high)], 0.2, 5
        )
        back = profile
        normal = np.gradient(back, axis=0)[:, ::-1] * (1, -1)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        outline = np.concatenate([back + 0.025 * normal, (back - 0.025 * normal)[::-1]])
        yield prism("wood", outline, width + 0.1, (0.0, 0.0, 0.0), "side")
        for s in (-1, 1):
            yield prism("wood", outline, 0.05, (s * (width / 2 + 0.06), 0.0, 0.0), "side")
            yield box("wood", (0.09, 0.1, 0.09), (s * (width / 2 + 0.03), 0.0, z))
    yield from bedding(width, LENGTH, 0.33, cover, pillows)


def iron(width: float = 1.5, cover: Cover = "throw", pillows: int = 2) -> Iterator[Solid]:
    """Arched bars between iron posts with brass balls."""
    for z, high in ((-LENGTH / 2 - 0.03, 1.12), (LENGTH / 2 + 0.03, 0.8)):
        for s in (-1, 1):
            yield rod("iron", (s * width / 2, 0.0, z), (s * width / 2, high - 0.12, z), 0.018)
            yield ball("brass", 0.032, (s * width / 2, high - 0.1, z), 12, 8)
        bow = [(x, y, z) for x, y in arc(1.0, 0.0, np.pi, 14) * (width / 2, 0.2) + (0.0, high - 0.16)]
        yield tube("iron", bow, 0.013)
        yield rod("iron", (-width / 2, 0.36, z), (width / 2, 0.36, z), 0.014)
        for i in range(9):
            x = (i - 4) * width / 9.5
            yield rod(
                "iron",
                (x, 0.36, z),
                (x, high - 0.16 + 0.2 * np.sqrt(max(1 - (2 * x / width) ** 2, 0)), z),
                0.007,
                sides=6,
            )
    for s in (-1, 1):
        yield beam("iron", (s * width / 2, 0.3, -LENGTH / 2), (s * width / 2, 0.3, LENGTH / 2), 0.03, 0.05)
    yield box("iron", (width - 0.02, 0.02, LENGTH), (0.0, 0.29, 0.0))
    yield from bedding(width - 0.04, LENGTH, 0.31, cover, pillows)


def four_poster(width: float = 1.7, cover: Cover = "made", pillows: int = 2, canopy: bool = True) -> Iterator[Solid]:
    """Four tall posts with rails above, and drapes at the head."""
    yield from _rails(width, 0.26, 0.42)
    x, z = width / 2 + 0.02, LENGTH / 2 + 0.02
    for sx in (-x, x):
        for sz in (-z, z):
            shape = [(0.045, 0.0), (0.05, 0.45), (0.028, 0.55), (0.04, 0.9), (0.028, 1.5), (0.03, 2.02)]
            yield turned("wood", shape, (sx, 0.0, sz), 12, 2)
    for s in (-1, 1):
        yield beam("wood", (s * x, 2.04, -z), (s * x, 2.04, z), 0.05)
        yield beam("wood", (-x, 2.04, s * z), (x, 2.04, s * z), 0.05)
    yield rounded("wood", (width, 0.7, 0.04), (0.0, 0.42, -z), 0.01, 1)
    yield from bedding(width, LENGTH, 0.37, cover, pillows)
    if canopy:
        for s in (-1, 1):
            yield surface(
                "sheer",
                lambda u, v, s=s: (s * (x - 0.02 - 0.01 * np.cos(36 * u)), 0.06 + 1.95 * v, -z + 0.03 + 0.4 * u),
                36,
                2,
                0.008,
            )


def storage_bed(width: float = 1.6, cover: Cover = "rumpled", pillows: int = 2) -> Iterator[Solid]:
    """A box with drawers below and shelves in its headboard."""
    yield rounded("wood", (width + 0.06, 0.36, LENGTH + 0.06), (0.0, 0.02, 0.0), 0.01, 1)
    yield box("black", (width - 0.1, 0.03, LENGTH - 0.1))
    yield from (
        rotate(p, 1, np.pi / 2)
        for p in drawers("wood_1", 1.5, 0.28, (-0.75, 0.06, width / 2 + 0.03), 2, 1, "flat", ("chrome", "bar"))
    )
    yield from (
        rotate(p, 1, -np.pi / 2)
        for p in drawers("wood_1", 1.5, 0.28, (-0.75, 0.06, width / 2 + 0.03), 2, 1, "flat", ("chrome", "bar"))
    )
    z = -LENGTH / 2 - 0.13
    for y in (0.02, 0.6, 1.0):
        yield box("wood", (width + 0.06, 0.025, 0.22), (0.0, y, z))
    for x in (-0.5, 0.0, 0.5):
        yield box("wood", (0.025, 1.0, 0.22), (x * (width + 0.03), 0.02, z))
    yield box("wood_1", (width + 0.04, 1.0, 0.015), (0.0, 0.02, z - 0.1))
    for i in range(6):
        yield box(f"cover_{i + 1}", (0.03, 0.22, 0.15), (-0.6 + 0.034 * i, 0.625, z + 0.01))
    yield from bedding(width, LENGTH, 0.36, cover, pillows)


def round_bed(radius: float = 1.05) -> Iterator[Solid]:
    """A round mattress in a padded ring with a curved back."""
    yield cylinder("black", radius - 0.1, 0.08, sides=36)
    yield turned(
        "upholstery", [(radius - 0.04, 0.06), (radius, 0.1), (radius, 0.26), (radius - 0.04, 0.3)], sides=40, steps=1
    )
    yield turned(
        "linen",
        [(radius - 0.08, 0.28), (radius - 0.05, 0.34), (radius - 0.05, 0.42), (radius - 0.1, 0.46)],
        sides=40,
        steps=1,
    )

    def back(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
        angle = np.pi * (1.2 + 0.6 * u)
        return radius * np.cos(angle), 0.1 + (0.75 + 0.1 * np.sin(np.pi * u)) * v, radius * np.sin(angle)

    yield surface("upholstery", back, 24, 5, 0.12)
    yield turned(
        "linen_2",
        [(radius * 0.9, 0.45), (radius * 0.93, 0.48), (radius * 0.5, 0.5), (0.1, 0.51)],
        (0.0, 0.0, 0.06),
        36,
        2,
    )
    for x in (-0.36, 0.36):
        yield soft("linen_1", (0.6, 0.16, 0.4), (x, 0.48, -0.6), 3.0, 6)


def futon_floor(width: float = 1.4, cover: Cover = "rumpled", pillows: int = 2) -> Iterator[Solid]:
    """A mattress on a very low slatted frame."""
    for x in np.linspace(-width / 2 - 0.08, width / 2 + 0.08, 4):
        yield box("wood", (0.08, 0.1, LENGTH + 0.24), (float(x), 0.0, 0.0))
    for i in range(13):
        yield rounded("wood", (width + 0.3, 0.025, 0.1), (0.0, 0.1, (i - 6) * (LENGTH + 0.12) / 12.5), 0.006, 1)
    yield from bedding(width, LENGTH, 0.125, cover, pillows, 0.16)


def captain(width: float = 0.9, cover: Cover = "made") -> Iterator[Solid]:
    """A bed of boards with three sides and drawers, against a wall."""
    yield rounded("wood", (width + 0.06, 0.38, LENGTH + 0.06), (0.0, 0.0, 0.0), 0.01, 1)
    yield from (
        rotate(p, 1, np.pi / 2)
        for p in drawers("wood_1", 1.9, 0.3, (-0.95, 0.05, width / 2 + 0.03), 3, 1, "flat", ("brass", "knob"))
    )
    for z, high in ((-LENGTH / 2 - 0.04, 0.92), (LENGTH / 2 + 0.04, 0.62)):
        yield rounded("wood", (width + 0.08, high, 0.03), (0.0, 0.0, z), 0.01, 1)
    yield rounded("wood", (0.03, 0.72, LENGTH + 0.08), (-width / 2 - 0.035, 0.0, 0.0), 0.01, 1)
    yield from bedding(width, LENGTH, 0.38, cover, 1, 0.18, seed=4)


def day_bed(width: float = 0.9) -> Iterator[Solid]:
    """Rails of spindles on three sides, pillows along the wall."""
    for x, z, w in ((-width / 2 - 0.02, 0.0, LENGTH),):
        yield beam("wood", (x, 0.85, -w / 2), (x, 0.85, w / 2), 0.04)
        for i in range(16):
            zz = (i - 7.5) * w / 16
            yield rod("wood", (x, 0.3, zz + z), (x, 0.84, zz + z), 0.01, sides=6)
    for s in (-1, 1):
        z = s * (LENGTH / 2 + 0.02)
        yield beam("wood", (-width / 2, 0.72, z), (width / 2, 0.72, z), 0.04)
        for i in range(7):
            x = (i - 3) * width / 7.5
            yield rod("wood", (x, 0.3, z), (x, 0.71, z), 0.01, sides=6)
        for x in (-width / 2 - 0.02, width / 2 + 0.02):
            yield turned(
                "wood", [(0.02, 0.0), (0.03, 0.3), (0.022, 0.6), (0.03, 0.74), (0.02, 0.8)], (x, 0.0, z), 10, 2
            )
    yield from _rails(width, 0.2, 0.36)
    yield from bedding(width, LENGTH, 0.31, "throw", 1, 0.18)
    for z in (-0.3, 0.25, 0.75):
        piece = rotate(soft("patterned", (0.5, 0.44, 0.16), (0.0, 0.0, 0.0), 3.0, 5), 1, np.pi / 2)
        piece = rotate(piece, 2, 0.25)
        yield move(piece, (-width / 2 + 0.14, 0.545, z))


def car_bed(width: float = 0.9) -> Iterator[Solid]:
    """A racing car for a child."""
    side = [
        (-1.1, 0.12),
        (-1.12, 0.5),
        (-0.95, 0.66),
        (-0.6, 0.6),
        (-0.2, 0.52),
        (0.6, 0.46),
        (1.05, 0.34),
        (1.12, 0.18),
        (1.1, 0.12),
    ]
    yield from mirrored([prism("red", [(z, y) for z, y in side], 0.05, (width / 2 + 0.03, 0.0, 0.0), "side")])
    yield rounded("red", (width + 0.1, 0.24, 0.06), (0.0, 0.12, 1.08), 0.025, 2)
    yield rounded("red", (width + 0.1, 0.62, 0.06), (0.0, 0.12, -1.08), 0.025, 2)
    yield box("black", (width, 0.2, 2.1), (0.0, 0.06, 0.0))
    for z in (-0.7, 0.68):
        for s in (-1, 1):
            for slot, r, w in (("rubber", 0.19, 0.09), ("chrome", 0.1, 0.1)):
                wheel = rotate(cylinder(slot, r, w, (0.0, -w / 2, 0.0), sides=20), 2, np.pi / 2)
                yield move(wheel, (s * (width / 2 + 0.06), 0.19, z))
    for s in (-1, 1):
        yield ball("yellow", (0.09, 0.06, 0.03), (s * 0.3, 0.28, 1.1), 12, 6)
        yield box("red", (0.04, 0.2, 0.16), (s * 0.34, 0.72, -1.06))
    yield rounded("red", (width, 0.03, 0.24), (0.0, 0.9, -1.06), 0.012, 1)
    yield from bedding(width - 0.06, 1.96, 0.24, "made", 1, 0.16, seed=6)


def house_bed(width: float = 0.9) -> Iterator[Solid]:
    """A child's bed in the frame of a little house."""
    x, z = width / 2 + 0.02, LENGTH / 2 + 0.02
    for sz in (-z, 0.0, z):
        yield beam("wood", (-x, 1.25, sz), (0.02, 1.68, sz), 0.045)
        yield beam("wood", (x, 1.25, sz), (-0.02, 1.68, sz), 0.045)
    for sx in (-x, x):
        for sz in (-z, z):
            yield beam("wood", (sx, 0.0, sz), (sx, 1.27, sz), 0.05)
        yield beam("wood", (sx, 1.24, -z), (sx, 1.24, z), 0.045)
    yield beam("wood", (0.0, 1.67, -z), (0.0, 1.67, z), 0.045)
    yield from _rails(width, 0.16, 0.3)
    for i in range(9):
        yield rod("wood", (-x, 0.3, (i - 4) * 0.22), (-x, 0.6, (i - 4) * 0.22), 0.012, sides=6)
    yield beam("wood", (-x, 0.6, -z), (-x, 0.6, z), 0.04)
    yield from bedding(width, LENGTH, 0.24, "made", 1, 0.14, seed=7)


def crib(width: float = 0.66, length: float = 1.26, kind: str = "bars") -> Iterator[Solid]:
    """A cot with bars all around, or a sleigh one, or a round one on wheels."""
    x, z, high = width / 2, length / 2, 0.92
    for sx in (-x, x):
        for y in (0.24, high - 0.06):
            yield beam("wood", (sx, y, -z), (sx, y, z), 0.03, 0.05)
        count = 15
        for i in range(count):
            yield rod(
                "wood",
                (sx, 0.24, (i - (count - 1) / 2) * length / count),
                (sx, high - 0.06, (i - (count - 1) / 2) * length / count),
                0.008,
                sides=6,
            )
    for s in (-1, 1):
        if kind == "bars":
            for sx in (-x, x):
                yield beam("wood", (sx, 0.0, s * z), (sx, high, s * z), 0.045)
            yield rounded("wood", (width, 0.62, 0.022), (0.0, 0.24, s * z), 0.008, 1)
        else:
            curve = fillet([(s * z, 0.0), (s * z, 0.7), (s * (z + 0.12), 1.02)], 0.3, 5)
            outline = np.concatenate([curve + np.array([0.016, 0.0]), (curve - np.array([0.016, 0.0]))[::-1]])
            yield prism("wood", outline, width + 0.04, (0.0, 0.0, 0.0), "side")
    yield box("wood", (width - 0.02, 0.02, length - 0.02), (0.0, 0.32, 0.0))
    yield rounded("linen", (width - 0.05, 0.12, length - 0.05), (0.0, 0.34, 0.0), 0.03, 2)
    yield soft("linen_2", (width - 0.1, 0.06, 0.6), (0.0, 0.45, 0.22), 6.0, 6)
    yield ball("fur_coat", (0.06, 0.07, 0.05), (0.1, 0.53, -0.35), 12, 8)
    yield ball("fur_coat", 0.045, (0.1, 0.62, -0.35), 12, 8)


def cradle() -> Iterator[Solid]:
    """A basket on rockers with a hood."""

    def side(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
        angle = 2 * np.pi * u * 0.998
        return (0.2 + 0.06 * v) * np.cos(angle), 0.24 + 0.3 * v, (0.38 + 0.07 * v) * np.sin(angle)

    yield surface("cane", side, 32, 3, 0.02)
    yield prism(
        "wood",
        np.asarray([(0.2 * np.cos(a), 0.38 * np.sin(a)) for a in np.linspace(0, 2 * np.pi, 24, endpoint=False)]),
        0.02,
        (0.0, 0.24, 0.0),
        "top",
    )
    yield soft("linen", (0.36, 0.1, 0.7), (0.0, 0.26, 0.0), 3.0, 6)
    yield soft("linen_2", (0.4, 0.06, 0.45), (0.0, 0.34, 0.14), 3.0, 5)
    yield surface(
        "textile",
        lambda u, v: (
            0.265 * np.cos(np.pi * u),
            0.54 + 0.26 * np.sin(np.pi * u) * np.cos(0.9 * v),
            -0.45 + 0.36 * v + 0.06 * np.sin(np.pi * u),
        ),
        12,
        5,
        0.012,
    )
    for z in (-0.26, 0.26):
        yield tube("wood", [(x, 0.02 + 0.35 * x**2, z) for x in np.linspace(-0.34, 0.34, 11)], 0.016)
        for s in (-1, 1):
            yield rod("wood", (s * 0.2, 0.035, z), (s * 0.16, 0.25, z), 0.013)


def bunk(width: float = 0.95, slide: bool = False, desk: bool = False) -> Iterator[Solid]:
    """Two storeys with a ladder and guard rails; a desk or a slide instead of the lower bed."""
    x, z = width / 2 + 0.02, LENGTH / 2 + 0.02
    for sx in (-x, x):
        for sz in (-z, z):
            yield beam("wood", (sx, 0.0, sz), (sx, 1.72, sz), 0.07)
        for y in (1.28, 1.48, 1.68):
            yield beam("wood", (sx, y, -z), (sx, y, z if sx < 0 or y < 1.3 else z - 0.45), 0.025, 0.09)
    for sz in (-z, z):
        for y in (0.32, 1.28, 1.5, 1.68):
            yield beam("wood", (-x, y, sz), (x, y, sz), 0.025, 0.09)
    yield box("wood", (width, 0.03, 2 * z - 0.04), (0.0, 1.28, 0.0))
    yield from bedding(width - 0.06, LENGTH - 0.04, 1.31, "made", 1, 0.13, seed=8)
    if desk:
        yield rounded("wood_1", (width, 0.03, 1.3), (-0.1, 0.72, -0.3), 0.008, 1)
        yield from (move(p, (0.0, 0.0, 0.8)) for p in drawers("wood_1", 0.7, 0.9, (-0.35, 0.1, 0.0), 1, 3))
        yield box("wood", (width - 0.1, 1.0, 0.3), (-0.05, 0.02, 0.65))
    else:
        for sx in (-x, x):
            yield beam("wood", (sx, 0.32, -z), (sx, 0.32, z), 0.025, 0.12)
        yield box("wood", (width, 0.03, 2 * z - 0.04), (0.0, 0.3, 0.0))
        yield from bedding(width - 0.06, LENGTH - 0.04, 0.33, "rumpled", 1, 0.13, seed=9)
    if slide:
        yield surface(
            "bright", lambda u, v: (x + 0.03 + 1.35 * u, 1.3 * (1 - u) ** 1.25 + 0.02, z - 0.45 + 0.4 * v), 12, 3, 0.02
        )
        for dz in (0.0, 0.4):
            yield tube(
                "bright",
                [(x + 0.03 + 1.35 * u, 1.3 * (1 - u) ** 1.25 + 0.09, z - 0.45 + dz) for u in np.linspace(0, 1, 9)],
                0.03,
            )
    for dz in (0.06, 0.4):
        yield beam(
            "wood",
            (x + 0.26, 0.0, -z + dz) if slide else (x + 0.26, 0.0, z - dz),
            (x + 0.03, 1.66, -z + dz) if slide else (x + 0.03, 1.66, z - dz),
            0.035,
        )
    for i in range(5):
        y = 0.25 + 0.26 * i
        at = x + 0.26 - 0.23 * y / 1.66
        a, b = (-z + 0.06, -z + 0.4) if slide else (z - 0.4, z - 0.06)
        yield rod("wood", (at, y, a), (at, y, b), 0.015)


DOUBLE = (
    design(platform), design(upholstered), design(sleigh), design(iron), design(four_poster), design(storage_bed),
    design(upholstered, head="channels", cover="throw"),
    design(platform, head="slats", kind="block", cover="rumpled"),
    design(platform, head="cane", kind="splay", cover="aside", width=1.5), design(round_bed), design(futon_floor),
    design(upholstered, head="wings", cover="aside", width=1.8), design(upholstered, cover="rumpled", width=1.4),
)  # fmt: skip
SINGLE = (
    design(platform, width=0.9, pillows=1), design(captain), design(day_bed),
    design(iron, width=0.95, pillows=1, cover="rumpled"), design(house_bed),
    design(upholstered, width=0.9, pillows=1, cover="throw"), design(car_bed), design(sleigh, width=0.9, pillows=1),
    design(platform, width=0.9, pillows=1, head="slats", cover="aside", kind="square"),
    design(futon_floor, width=0.9, pillows=1),
)  # fmt: skip
COTS = (design(crib), design(crib, kind="sleigh"), design(cradle), design(crib, width=0.72, length=1.4))
BUNKS = (design(bunk), design(bunk, desk=True), design(bunk, slide=True))

FAMILIES = (
    Family("double_bed", "double_bed", DOUBLE),
    Family("single_bed", "single_bed", SINGLE),
    Family("baby_bed", "baby_bed", COTS),
    Family("bunker_bed", "bunker_bed", BUNKS),
)
