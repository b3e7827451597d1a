"""Sofas and couches."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, Vector, box, cylinder, move, rotate
from home_procgen.shapes.curves import fillet, spline
from home_procgen.shapes.rounded import ball, padded_block, pillow, rounded_box
from home_procgen.shapes.sheets import surface
from home_procgen.shapes.sweep import beam, prism, rod, sweep, tube
from home_procgen.shapes.transforms import add_mirror_images
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import LegKind, legs


def upright_pillow(material: str, size: tuple[float, float, float], at: Vector, lean: float = 0.25) -> Solid:
    """Build a pillow on its edge, tilted back by `lean` [rad].

    Args:
        material: Slot name.
        size: Width, height and thickness before the tilt [m].
        at: Point below the centre, at the height of the lowest vertex [m].
        lean: Angle of the tilt towards -z [rad].
    """
    upright = rotate(pillow(material, (size[0], size[2], size[1]), (0.0, -size[2] / 2, 0.0), 6), 0, np.pi / 2 - lean)
    lift = np.asarray(at) - (0.0, float(upright.box[0, 1]), 0.0)
    return move(upright, lift)


def _seats(
    width: float, count: int, deep: float, z: float, y: float = 0.3, thick: float = 0.16, power: float = 7.0
) -> Iterator[Solid]:
    wide = width / count
    for i in range(count):
        yield padded_block("upholstery_1", (wide - 0.006, thick, deep), ((i - (count - 1) / 2) * wide, y, z), power, 5)


def _rests(
    width: float, count: int, z: float, y: float = 0.44, high: float = 0.42, thick: float = 0.18
) -> Iterator[Solid]:
    wide = width / count
    for i in range(count):
        rest = padded_block("upholstery_1", (wide - 0.01, high, thick), ((i - (count - 1) / 2) * wide, y, z), 5.0, 5)
        yield rotate(rest, 0, -0.17, (0.0, y, z))


def track(
    width: float = 2.1, seats: int = 3, kind: LegKind = "square", arm: float = 0.14, throw: bool = True
) -> Iterator[Solid]:
    """Build a straight-armed sofa with one back cushion per seat and loose pillows."""
    yield from legs("wood", width - 0.1, 0.78, 0.13, kind, 0.05)
    yield rounded_box("upholstery", (width - 0.04, 0.2, 0.86), (0.0, 0.12, 0.0), 0.03, 1)
    yield from add_mirror_images([rounded_box("upholstery", (arm, 0.5, 0.9), ((width - arm) / 2, 0.12, 0.0), 0.035, 2)])
    yield rounded_box("upholstery", (width - 2 * arm + 0.02, 0.68, 0.17), (0.0, 0.12, -0.365), 0.04, 2)
    inner = width - 2 * arm
    yield from _seats(inner, seats, 0.7, 0.09)
    yield from _rests(inner, seats, -0.2)
    if throw:
        yield upright_pillow("patterned", (0.42, 0.42, 0.15), (0.5 * inner - 0.24, 0.46, -0.02), 0.35)
        yield upright_pillow("patterned_1", (0.4, 0.4, 0.15), (0.24 - 0.5 * inner, 0.46, -0.02), 0.35)


def chesterfield(width: float = 2.1) -> Iterator[Solid]:
    """Build a sofa with rolled arms as high as the back and rows of buttons."""
    yield from legs("wood", width - 0.16, 0.72, 0.1, "turned", 0.07)
    yield rounded_box("leather", (width - 0.1, 0.22, 0.82), (0.0, 0.09, 0.0), 0.03, 2)
    yield rounded_box("leather", (width - 0.16, 0.52, 0.16), (0.0, 0.2, -0.34), 0.03, 2)
    x = width / 2 - 0.12
    path = fillet([(-x, 0.68, 0.38), (-x, 0.68, -0.36), (x, 0.68, -0.36), (x, 0.68, 0.38)], 0.1, 4)
    yield tube("leather", path, 0.1, 12)
    yield from add_mirror_images([rounded_box("leather", (0.14, 0.5, 0.8), (x, 0.18, 0.0), 0.03, 2)])
    yield from _buttons(width)
    wide = (width - 0.4) / 2
    for s in (-1, 1):
        yield padded_block("leather", (wide - 0.006, 0.16, 0.66), (s * wide / 2, 0.29, 0.06), 8.0, 5)


def _buttons(width: float) -> Iterator[Solid]:
    for row in range(2):
        for i in range(9 - row):
            x = (i - (8 - row) / 2) * (width - 0.6) / 8
            yield ball("brass", (0.016, 0.016, 0.008), (x, 0.5 + 0.11 * row, -0.257), 8, 4)


def camelback(width: float = 1.9) -> Iterator[Solid]:
    """Build a sofa with one seat pad, a humped back, scroll arms, two bolsters and cabriole legs."""
    yield from legs("wood", width - 0.1, 0.7, 0.22, "cabriole", 0.06)
    yield rounded_box("upholstery", (width - 0.06, 0.16, 0.76), (0.0, 0.2, 0.0), 0.03, 2)
    yield padded_block("upholstery", (width - 0.3, 0.14, 0.66), (0.0, 0.34, 0.05), 12.0, 6)
    xs = np.linspace(-1, 1, 21)
    top = [
        (x * (width / 2 - 0.04), 0.78 + 0.15 * np.cos(np.pi * x) ** 2 * (np.abs(x) < 0.5) + 0.05 * (np.abs(x) > 0.9))
        for x in xs
    ]
    yield prism("upholstery", [(width / 2 - 0.04, 0.22), *top[::-1], (0.04 - width / 2, 0.22)], 0.14, (0.0, 0.0, -0.31))
    scroll = [tube("upholstery", [(width / 2 - 0.1, 0.62, 0.37), (width / 2 - 0.1, 0.62, -0.28)], 0.085, 12)]
    yield from add_mirror_images(
        [*scroll, rounded_box("upholstery", (0.1, 0.42, 0.68), (width / 2 - 0.1, 0.2, 0.02), 0.03, 1)]
    )
    for s in (-1, 1):
        yield tube("patterned", [(s * (width / 2 - 0.26), 0.56, 0.25), (s * (width / 2 - 0.26), 0.56, -0.2)], 0.085, 12)


def sectional(width: float = 2.5, chaise: float = 0.75) -> Iterator[Solid]:
    """Build an L-shaped sofa with a chaise end, low arms and many cushions."""
    yield box("black", (width - 0.1, 0.06, 0.8))
    yield rounded_box("upholstery", (width, 0.26, 0.95), (0.0, 0.05, 0.0), 0.03, 2)
    left = width / 2 - 0.46
    yield rounded_box("upholstery", (0.92, 0.26, 0.95 + chaise), (left, 0.05, chaise / 2), 0.03, 2)
    yield rounded_box("upholstery", (width, 0.62, 0.2), (0.0, 0.05, -0.375), 0.05, 2)
    yield rounded_box("upholstery", (0.2, 0.5, 0.95), (0.1 - width / 2, 0.05, 0.0), 0.05, 2)
    yield rounded_box("upholstery", (0.18, 0.5, 0.9), (width / 2 - 0.09, 0.05, -0.02), 0.05, 2)
    inner = width - 0.38 - 0.76
    for i in range(2):
        yield padded_block(
            "upholstery_1",
            (inner / 2 - 0.006, 0.16, 0.75),
            (0.2 - width / 2 + inner * (i + 0.5) / 2, 0.29, 0.09),
            8.0,
            5,
        )
    yield padded_block("upholstery_1", (0.75, 0.16, 0.75 + chaise), (left + 0.0, 0.29, 0.09 + chaise / 2), 12.0, 6)
    for i in range(3):
        yield upright_pillow("upholstery_1", (0.66, 0.46, 0.2), ((i - 1) * (width - 0.5) / 3, 0.44, -0.15), 0.25)
    yield upright_pillow("patterned", (0.42, 0.42, 0.15), (left, 0.44, 0.02), 0.4)


def corner(size: float = 2.3) -> Iterator[Solid]:
    """Build an armless corner sofa on a plinth."""
    deep, mid = 0.86, size / 2
    yield rounded_box("upholstery", (size, 0.3, deep), (0.0, 0.04, deep / 2 - mid), 0.03, 2)
    yield rounded_box("upholstery", (deep, 0.3, size - deep), (deep / 2 - mid, 0.04, deep / 2), 0.03, 2)
    yield rounded_box("upholstery", (size, 0.7, 0.2), (0.0, 0.04, 0.1 - mid), 0.06, 2)
    yield rounded_box("upholstery", (0.2, 0.7, size - 0.02), (0.1 - mid, 0.04, 0.0), 0.06, 2)
    seat = (size - 0.22) / 3
    for i in range(3):
        yield padded_block(
            "upholstery_1", (seat - 0.006, 0.13, 0.64), (0.2 - mid + (i + 0.5) * seat, 0.33, 0.53 - mid), 8.0, 5
        )
        if i:
            yield padded_block(
                "upholstery_1", (0.64, 0.13, seat - 0.006), (0.53 - mid, 0.33, 0.2 - mid + (i + 0.5) * seat), 8.0, 5
            )
            yield upright_pillow(
                "upholstery_1", (0.6, 0.38, 0.18), (0.2 - mid + (i + 0.5) * seat, 0.45, 0.26 - mid), 0.2
            )
    turned = upright_pillow("patterned", (0.5, 0.4, 0.16), (0.0, 0.45, 0.0), 0.25)
    turned = rotate(turned, 1, np.pi / 2)
    yield move(turned, (0.28 - mid, 0.0, 0.4))


def mid_century(width: float = 1.85) -> Iterator[Solid]:
    """Build a slim tufted sofa on a wooden rail with tapered legs."""
    yield from legs("wood", width - 0.3, 0.68, 0.24, "splay", 0.05)
    yield rounded_box("wood", (width - 0.06, 0.04, 0.74), (0.0, 0.23, 0.0), 0.01, 1)
    count = 3
    wide = (width - 0.1) / count
    for i in range(count):
        x = (i - 1) * wide
        yield padded_block("upholstery", (wide - 0.005, 0.16, 0.68), (x, 0.26, 0.03), 9.0, 5)
        back = padded_block("upholstery", (wide - 0.005, 0.42, 0.13), (x, 0.4, -0.28), 8.0, 5)
        yield rotate(back, 0, -0.18, (0.0, 0.4, -0.28))
        for dx in (-0.14, 0.14):
            yield ball("black", (0.012, 0.006, 0.012), (x + dx, 0.421, 0.06), 8, 4)
    arm = fillet(
        [
            (width / 2 - 0.03, 0.24, 0.3),
            (width / 2 - 0.03, 0.58, 0.3),
            (width / 2 - 0.03, 0.58, -0.34),
            (width / 2 - 0.03, 0.24, -0.3),
        ],
        0.06,
    )
    yield from add_mirror_images([tube("wood", arm, 0.018)])


def rounded_sofa(width: float = 2.2) -> Iterator[Solid]:
    """Build a kidney-shaped sofa with a back that curves around it."""

    def back(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
        angle = np.pi * (0.97 + 1.06 * u)
        return (
            width / 2 * 0.9 * np.cos(angle),
            0.12 + 0.62 * v - 0.1 * np.abs(2 * u - 1) ** 3 * v,
            0.1 + 0.5 * np.sin(angle),
        )

    yield surface("fur", back, 26, 4, 0.2)
    yield padded_block("fur", (width * 0.88, 0.34, 0.86), (0.0, 0.08, 0.1), 2.6, 8)
    for x in (-0.6, 0.0, 0.6):
        yield cylinder("wood", 0.05, 0.1, (x, 0.0, 0.14 - 0.1 * (x == 0)), sides=12)
    yield ball("textile", 0.16, (0.62, 0.55, 0.0), 14, 8)
    yield ball("textile_1", 0.13, (-0.6, 0.52, 0.08), 14, 8)


def futon(width: float = 1.9) -> Iterator[Solid]:
    """Build a folded mattress on a slatted wooden frame."""
    yield from add_mirror_images(
        [
            beam("wood", (width / 2 - 0.03, 0.05, -0.42), (width / 2 - 0.03, 0.05, 0.42), 0.05, 0.1),
            rounded_box("wood", (0.06, 0.06, 0.88), (width / 2 - 0.03, 0.52, 0.0), 0.015, 1),
        ]
    )
    for s in (-1, 1):
        for z in (-0.38, -0.13, 0.13, 0.38):
            yield beam("wood", (s * (width / 2 - 0.03), 0.08, z), (s * (width / 2 - 0.03), 0.55, z), 0.045)
    for z in np.linspace(-0.3, 0.38, 7):
        yield beam("wood", (-width / 2 + 0.05, 0.26, float(z)), (width / 2 - 0.05, 0.26, float(z)), 0.05, 0.02)
    yield rotate(
        padded_block("textile", (width - 0.14, 0.17, 0.8), (0.0, 0.27, 0.06), 9.0, 6), 0, -0.06, (0.0, 0.27, 0.0)
    )
    yield rotate(
        padded_block("textile", (width - 0.14, 0.66, 0.17), (0.0, 0.3, -0.34), 9.0, 6), 0, -0.3, (0.0, 0.3, -0.34)
    )


def settee(width: float = 1.3) -> Iterator[Solid]:
    """Build a small wooden bench with spindles, a padded seat and a padded back."""
    yield from legs("wood", width, 0.58, 0.4, "taper", 0.06)
    yield rounded_box("wood", (width, 0.06, 0.58), (0.0, 0.34, 0.0), 0.015, 1)
    yield padded_block("patterned", (width - 0.1, 0.13, 0.54), (0.0, 0.39, 0.02), 12.0, 6)
    for s in (-1, 1):
        x = s * (width / 2 - 0.03)
        yield rod("wood", (x, 0.38, 0.25), (x, 0.64, 0.27), 0.018)
        yield tube("wood", spline([(x, 0.65, 0.32), (x, 0.66, 0.0), (x, 0.63, -0.3)], 4), 0.022)
        yield rod("wood", (x, 0.38, -0.25), (x, 0.9, -0.36), 0.02)
    for i in range(12):
        x = (i - 5.5) * (width - 0.12) / 12
        yield rod("wood", (x, 0.38, -0.25), (x, 0.88, -0.355), 0.009, sides=6)
    yield rounded_box("wood", (width, 0.07, 0.035), (0.0, 0.85, -0.36), 0.015, 1)


def chaise_longue(length: float = 1.7) -> Iterator[Solid]:
    """Build a long seat with one scrolled end."""
    yield from legs("wood", 1.5, 0.6, 0.22, "turned", 0.06)
    yield rounded_box("wood", (length - 0.1, 0.06, 0.66), (0.0, 0.2, 0.0), 0.02, 1)
    yield padded_block("upholstery", (length - 0.12, 0.18, 0.66), (0.02, 0.25, 0.0), 10.0, 6)
    curve = spline([(-0.62, 0.3), (-0.78, 0.52), (-0.86, 0.78), (-0.97, 0.8), (-0.97, 0.7)], 4)
    path = [(float(x), float(y), 0.0) for x, y in curve]

    yield sweep(
        "upholstery", path, np.array([[-0.32, -0.07], [0.32, -0.07], [0.32, 0.07], [-0.32, 0.07]]), up=(0.0, 1.0, 0.0)
    )
    yield tube("patterned", [(-0.6, 0.5, 0.27), (-0.6, 0.5, -0.27)], 0.09, 12)


def modular(seats: int = 3) -> Iterator[Solid]:
    """Build low blocks side by side with thick pillows; one block is a footstool."""
    wide = 0.82
    for i in range(seats):
        x = (i - (seats - 1) / 2) * wide
        yield padded_block("upholstery", (wide - 0.008, 0.4, 0.86), (x, 0.02, 0.0), 7.0, 6)
        if i < seats - 1:
            yield padded_block("upholstery", (wide - 0.02, 0.5, 0.26), (x, 0.26, -0.32), 5.0, 6)
            yield upright_pillow("upholstery_1", (0.56, 0.42, 0.2), (x, 0.4, -0.08), 0.3)
    yield padded_block("upholstery", (0.24, 0.46, 0.8), (-(seats - 1) / 2 * wide - 0.33, 0.22, 0.02), 5.0, 5)


SOFAS = (
    design(track), design(chesterfield), design(camelback), design(sectional), design(mid_century),
    design(rounded_sofa), design(futon), design(settee), design(modular),
    design(track, width=1.7, seats=2, kind="taper", arm=0.1, throw=False), design(corner), design(chaise_longue),
    design(track, width=2.3, seats=2, kind="sled", arm=0.22),
)  # fmt: skip
FAMILIES = (FurnitureFamily("sofa", "sofa", SOFAS),)
