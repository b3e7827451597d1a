"""Armchairs."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder, move, rotate
from home_procgen.shapes.curves import fillet, spline
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, padded_block, pillow, rounded_box
from home_procgen.shapes.sheets import surface
from home_procgen.shapes.sweep import band, beam, prism, rod, tube
from home_procgen.shapes.transforms import add_mirror_images, repeat_around
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import LegKind, legs


def club(width: float = 0.86, depth: float = 0.84) -> Iterator[Solid]:
    """Build a low, rounded club chair whose arms are as high as its back."""
    yield from legs("wood", 0.54, 0.5, 0.12, "taper", 0.05)

    def place(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
        angle = np.pi * (0.86 + 1.28 * u)
        bulge = 1 + 0.05 * np.sin(np.pi * v)
        return (width / 2 - 0.08) * np.cos(angle) * bulge, 0.1 + 0.6 * v, (depth / 2 - 0.08) * np.sin(angle) * bulge

    yield surface("upholstery", place, 22, 5, 0.13)
    yield padded_block("upholstery", (0.58, 0.2, 0.62), (0.0, 0.1, 0.05), 8.0, 4)
    yield padded_block("upholstery_1", (0.56, 0.16, 0.62), (0.0, 0.29, 0.06), 6.0, 6)


def wing(width: float = 0.78, tufts: bool = True) -> Iterator[Solid]:
    """Build a wing chair with a high back, side wings and rolled arms."""
    yield from legs("wood", 0.68, 0.66, 0.2, "turned", 0.055)
    yield padded_block("upholstery", (0.64, 0.2, 0.66), (0.0, 0.19, 0.02), 9.0, 4)
    yield padded_block("upholstery", (0.54, 0.14, 0.58), (0.0, 0.36, 0.06), 6.0, 6)
    yield rotate(
        padded_block("upholstery", (0.6, 0.76, 0.14), (0.0, 0.38, -0.28), 8.0, 6), 0, -0.12, (0.0, 0.38, -0.28)
    )
    panel = [
        (0.36, 0.2),
        (0.36, 0.6),
        (0.2, 0.66),
        (-0.12, 0.66),
        (-0.17, 0.8),
        (-0.16, 1.04),
        (-0.34, 1.08),
        (-0.4, 1.04),
        (-0.34, 0.2),
    ]
    yield from add_mirror_images(
        [prism("upholstery", fillet(panel, 0.05, 3, closed=True), 0.07, (0.33, 0.0, 0.0), "side")]
    )
    yield from add_mirror_images([tube("upholstery", [(0.35, 0.62, 0.34), (0.35, 0.62, -0.14)], 0.065, 12)])
    if tufts:
        for x in (-0.15, 0.0, 0.15):
            for y in (0.7, 0.88):
                yield ball("brass", 0.012, (x, y, -0.245 - 0.12 * (y - 0.38)), 8, 4)


def lounge(width: float = 0.7) -> Iterator[Solid]:
    """Build a lounge chair: a wooden frame with open arms and two loose cushions."""
    for s in (-1, 1):
        x = s * (width / 2 - 0.025)
        yield rod("wood", (x, 0.0, 0.36), (x, 0.56, 0.26), 0.018, 0.024, 10)
        yield rod("wood", (x, 0.0, -0.36), (x, 0.5, -0.2), 0.018, 0.024, 10)
        yield band("wood", spline([(x, 0.57, 0.34), (x, 0.59, 0.1), (x, 0.55, -0.3)], 4), 0.055, 0.024)
        yield beam("wood", (x, 0.36, 0.3), (x, 0.27, -0.28), 0.03, 0.05)
        yield beam("wood", (x - s * 0.06, 0.26, -0.24), (x - s * 0.06, 0.82, -0.44), 0.03, 0.04)
    for i in range(6):
        y = 0.36 + 0.085 * i
        yield beam("wood", (-0.28, y, -0.255 - 0.357 * (y - 0.26)), (0.28, y, -0.255 - 0.357 * (y - 0.26)), 0.012, 0.03)
    yield rotate(padded_block("upholstery", (0.58, 0.13, 0.58), (0.0, 0.33, 0.03), 6.0, 6), 0, -0.13, (0.0, 0.33, 0.0))
    yield rotate(padded_block("upholstery", (0.56, 0.5, 0.13), (0.0, 0.4, -0.22), 6.0, 6), 0, -0.34, (0.0, 0.4, -0.22))


def track_arm(width: float = 0.84, kind: LegKind = "block") -> Iterator[Solid]:
    """Build a boxy armchair with straight arms and two thick cushions."""
    yield from legs("wood", width - 0.06, 0.76, 0.12, kind, 0.05)
    yield padded_block("upholstery", (width - 0.26, 0.2, 0.8), (0.0, 0.11, 0.02), 12.0, 4)
    yield from add_mirror_images(
        [rounded_box("upholstery", (0.14, 0.5, 0.84), ((width - 0.14) / 2, 0.11, 0.0), 0.03, 2)]
    )
    yield rounded_box("upholstery", (width - 0.2, 0.7, 0.16), (0.0, 0.11, -0.34), 0.04, 2)
    yield padded_block("upholstery_1", (width - 0.29, 0.17, 0.66), (0.0, 0.29, 0.1), 7.0, 6)
    yield _back_cushion(width)


def _back_cushion(width: float) -> Solid:
    cushion = rotate(pillow("upholstery_1", (width - 0.3, 0.19, 0.46), (0.0, -0.095, 0.0)), 0, np.pi / 2 - 0.22)
    return move(cushion, (0.0, 0.66, -0.19))


def egg(width: float = 0.82) -> Iterator[Solid]:
    """Build an egg chair: a moulded shell on a swivel star base."""
    profile = spline([(0.3, 0.4), (0.18, 0.34), (-0.1, 0.34), (-0.28, 0.5), (-0.36, 0.8), (-0.34, 1.06)], 4)

    def place(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
        line = u * (len(profile) - 1)
        z, y = (np.interp(line, np.arange(len(profile)), profile[:, k]) for k in (0, 1))
        s = 2 * v - 1
        curl = 0.36 * np.abs(s) ** 3 * np.clip(u * 1.4, 0, 1)
        half = 0.28 + 0.13 * np.sin(np.pi * np.clip(u * 1.15, 0, 1))
        return np.sin(1.25 * s) / np.sin(1.25) * half, y + 0.16 * s**4 * (1 - u) - 0.08 * s**4 * u, z + curl

    yield surface("upholstery", place, 18, 14, 0.05)
    yield padded_block("upholstery", (0.46, 0.11, 0.44), (0.0, 0.36, 0.03), 3.5, 6)
    yield cylinder("chrome", 0.03, 0.33, (0.0, 0.02, 0.0), sides=12)
    yield from repeat_around([beam("chrome", (0.0, 0.02, 0.0), (0.0, 0.012, 0.3), 0.05, 0.024)], 4, np.pi / 4)


def rocker(width: float = 0.62) -> Iterator[Solid]:
    """Build a slatted rocking chair on curved runners."""
    for s in (-1, 1):
        x = s * width / 2
        runner = [(x, 0.02 + 0.28 * (z / 0.62) ** 2 * 0.55, z) for z in np.linspace(-0.5, 0.4, 11)]
        yield band("wood", runner, 0.035, 0.03)
        yield rod("wood", (x, 0.05, 0.22), (x, 0.62, 0.24), 0.016, 0.02, 10)
        yield rod("wood", (x, 0.06, -0.22), (x * 0.9, 1.06, -0.4), 0.02, 0.016, 10)
        yield band("wood", spline([(x, 0.63, 0.3), (x, 0.65, 0.0), (x * 0.95, 0.62, -0.3)], 4), 0.06, 0.022)
    yield padded_block("wood", (width + 0.02, 0.04, 0.5), (0.0, 0.4, 0.0), 6.0, 5)
    yield padded_block("patterned", (width - 0.1, 0.07, 0.44), (0.0, 0.43, 0.01), 5.0, 5)
    for y in (1.0, 0.52):
        z = -0.22 - 0.18 * (y - 0.06)
        yield beam("wood", (-0.29, y, z), (0.29, y, z), 0.02, 0.07)
    for i in range(7):
        x = -0.21 + 0.07 * i
        yield rod("wood", (x, 0.52, -0.302), (x, 1.0, -0.39), 0.008, sides=6)


def sling(width: float = 0.66) -> Iterator[Solid]:
    """Build a leather sling chair between steel hoops."""
    for s in (-1, 1):
        x = s * width / 2
        path = [(x, 0.012, 0.34), (x, 0.58, 0.3), (x, 0.58, -0.38), (x, 0.012, -0.3)]
        yield tube("chrome", fillet([*path], 0.08, 4, closed=True), 0.012, 8, closed=True)
    for y, z in ((0.4, 0.33), (0.58, -0.34), (0.012, -0.28)):
        yield rod("chrome", (-width / 2, y, z), (width / 2, y, z), 0.01)
    profile = spline([(0.34, 0.41), (0.05, 0.33), (-0.2, 0.34), (-0.36, 0.6), (-0.46, 0.84)], 3)
    line = np.arange(len(profile))
    yield surface(
        "leather",
        lambda u, v: ((v - 0.5) * (width - 0.05), *(np.interp(u * line[-1], line, profile[:, k]) for k in (1, 0))),
        14, 3, 0.018,
    )  # fmt: skip
    for s in (-1, 1):
        yield beam("leather", (s * width / 2, 0.6, -0.24), (s * width / 2, 0.6, 0.24), 0.05, 0.008)


def barrel(width: float = 0.74) -> Iterator[Solid]:
    """Build a barrel chair: a round tub with upright channels on a round plinth."""
    yield cylinder("black", 0.26, 0.06, sides=24)
    yield revolve("upholstery", [(0.3, 0.06), (0.34, 0.1), (0.34, 0.3), (0.3, 0.34)], sides=24, steps=1)
    yield revolve("upholstery", [(0.27, 0.33), (0.3, 0.36), (0.3, 0.42), (0.24, 0.45)], (0.0, 0.0, 0.03), 24, 2)
    for i in range(15):
        angle = np.pi * (0.96 + 1.08 * i / 14)
        x, z = 0.33 * np.cos(angle), 0.33 * np.sin(angle)
        yield tube(
            "upholstery", [(x, 0.1, z), (1.08 * x, 0.7, 1.08 * z), (1.06 * x, 0.74, 1.06 * z)], [0.042, 0.042, 0.03], 8
        )


def bergere(width: float = 0.7) -> Iterator[Solid]:
    """Build a carved wooden frame with an upholstered back, seat and arm pads."""
    yield from legs("wood", 0.62, 0.58, 0.34, "cabriole", 0.05)
    yield rounded_box("wood", (0.66, 0.06, 0.6), (0.0, 0.33, 0.0), 0.02, 2)
    yield padded_block("patterned", (0.58, 0.14, 0.56), (0.0, 0.37, 0.02), 5.0, 6)
    frame = fillet(
        [(-0.3, 0.42, -0.27), (-0.3, 0.98, -0.36), (0.0, 1.06, -0.37), (0.3, 0.98, -0.36), (0.3, 0.42, -0.27)], 0.12, 4
    )
    yield tube("wood", frame, 0.022)
    yield rotate(
        padded_block("patterned", (0.54, 0.56, 0.09), (0.0, 0.42, -0.27), 7.0, 6), 0, -0.15, (0.0, 0.42, -0.27)
    )
    arm = [
        tube(
            "wood",
            spline(
                [(0.31, 0.66, -0.3), (0.34, 0.67, 0.0), (0.33, 0.64, 0.16), (0.33, 0.5, 0.14), (0.31, 0.38, 0.2)], 4
            ),
            0.02,
        )
    ]
    yield from add_mirror_images([*arm, padded_block("patterned", (0.055, 0.04, 0.22), (0.335, 0.675, -0.06), 3.0, 4)])


def recliner(width: float = 0.9) -> Iterator[Solid]:
    """Build an overstuffed recliner with a raised footrest."""
    yield box("black", (0.7, 0.08, 0.6))
    yield from add_mirror_images(
        [
            padded_block("leather", (0.2, 0.56, 0.86), (0.36, 0.06, 0.0), 5.0, 6),
            padded_block("leather", (0.22, 0.14, 0.8), (0.36, 0.52, 0.0), 3.0, 5),
        ]
    )
    yield padded_block("leather", (0.54, 0.22, 0.6), (0.0, 0.26, 0.1), 5.0, 6)
    for y, h in ((0.34, 0.36), (0.66, 0.36)):
        yield rotate(padded_block("leather", (0.56, h, 0.22), (0.0, y, -0.3), 4.0, 6), 0, -0.25, (0.0, 0.42, -0.3))
    yield rotate(padded_block("leather", (0.54, 0.12, 0.4), (0.0, 0.3, 0.62), 5.0, 5), 0, 0.2, (0.0, 0.3, 0.5))
    yield from add_mirror_images([beam("iron", (0.2, 0.12, 0.3), (0.2, 0.28, 0.6), 0.02)])


def bean_bag(width: float = 0.85) -> Iterator[Solid]:
    """Build a bean bag with a seat dent."""

    def place(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
        angle, lift = 2 * np.pi * u, np.pi * (v - 0.5)
        wide = np.cos(lift) ** 0.7 * (1 + 0.04 * np.sin(5 * angle))
        top = np.where(v > 0.5, 0.42 + 0.3 * (1 - 0.9 * np.sin(angle)) / 1.9, 0.3)
        dent = (
            0.12
            * np.exp(-(((wide * np.cos(angle)) / 0.5) ** 2) - ((wide * np.sin(angle) - 0.2) / 0.45) ** 2)
            * (v > 0.5)
        )
        return width / 2 * wide * np.cos(angle), 0.3 + top * np.sin(lift) - dent, width / 2 * wide * np.sin(angle)

    u, v = np.meshgrid(np.arange(18) / 18, np.linspace(0, 1, 11), indexing="ij")
    points = np.stack(place(u, v), -1)
    points[:, [0, -1]] = points[:, [0, -1]].mean(0)
    yield _closed_skin("textile", points)


def _closed_skin(material: str, points: np.ndarray) -> Solid:
    """Build a closed solid from columns of points around the vertical axis that share their first and last points."""
    from home_procgen.shapes.rounded import weld

    n, m = points.shape[:2]
    i, j = np.arange(n)[:, None], np.arange(m - 1)
    a, b = i * m + j, (i + 1) % n * m + j
    faces = np.concatenate([np.stack([a, a + 1, b], -1).reshape(-1, 3), np.stack([b, a + 1, b + 1], -1).reshape(-1, 3)])
    return weld(material, points.reshape(-1, 3), faces)


ARMCHAIRS = (
    design(club), design(wing), design(lounge), design(track_arm), design(egg), design(rocker), design(sling),
    design(barrel), design(bergere), design(recliner), design(bean_bag), design(track_arm, width=0.78, kind="splay"),
)  # fmt: skip


FAMILIES = (FurnitureFamily("armchair", "armchair", ARMCHAIRS),)
