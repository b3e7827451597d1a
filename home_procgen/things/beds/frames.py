"""Bed frames for single and double beds."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box
from home_procgen.shapes.curves import arc, fillet
from home_procgen.shapes.rounded import ball, padded_block, rounded_box
from home_procgen.shapes.sweep import beam, prism, rod, tube
from home_procgen.shapes.transforms import add_mirror_images
from home_procgen.things.beds.bedding import MATTRESS_LENGTH, Cover, bedding, rails
from home_procgen.things.joinery import LegKind, legs


def platform(
    width: float = 1.6, cover: Cover = "made", kind: LegKind = "taper", head: str = "panel", pillows: int = 2
) -> Iterator[Solid]:
    """Build a bed with bedding: a low frame on legs, and a plain, slatted or caned headboard."""
    yield from legs("wood", width + 0.04, MATTRESS_LENGTH, 0.2, kind, 0.06)
    yield from rails(width, 0.18, 0.34)
    yield from bedding(width, MATTRESS_LENGTH, 0.29, cover, pillows)
    z = -MATTRESS_LENGTH / 2 - 0.045
    if head == "panel":
        yield rounded_box("wood", (width + 0.08, 0.75, 0.035), (0.0, 0.18, z), 0.012, 2)
    elif head == "slats":
        for y in (0.52, 0.66, 0.8, 0.94):
            yield rounded_box("wood", (width + 0.06, 0.08, 0.025), (0.0, y, z), 0.01, 1)
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
    """Build a bed with bedding: a padded frame, and a tall tufted, channelled or winged headboard."""
    yield from legs("wood", width, MATTRESS_LENGTH, 0.1, "block", 0.07)
    z = -MATTRESS_LENGTH / 2 - 0.07
    for s in (-1, 1):
        yield rounded_box(
            "upholstery", (0.07, 0.26, MATTRESS_LENGTH + 0.1), (s * (width / 2 + 0.03), 0.1, 0.0), 0.03, 2
        )
    yield rounded_box("upholstery", (width + 0.13, 0.26, 0.07), (0.0, 0.1, MATTRESS_LENGTH / 2 + 0.03), 0.03, 2)
    yield box("black", (width, 0.04, MATTRESS_LENGTH), (0.0, 0.22, 0.0))
    yield rounded_box("upholstery", (width + 0.14, 1.05, 0.1), (0.0, 0.1, z), 0.04, 2)
    if head == "tufted":
        for row in range(3):
            for i in range(6):
                yield padded_block(
                    "upholstery",
                    ((width + 0.08) / 6, 0.2, 0.07),
                    ((i - 2.5) * (width + 0.08) / 6, 0.5 + 0.2 * row, z + 0.05),
                    3.0,
                    3,
                )
    elif head == "channels":
        for i in range(9):
            yield padded_block(
                "upholstery", ((width + 0.1) / 9, 0.62, 0.09), ((i - 4) * (width + 0.1) / 9, 0.5, z + 0.05), 4.0, 4
            )
    else:
        yield padded_block("upholstery", (width, 0.6, 0.08), (0.0, 0.48, z + 0.05), 9.0, 6)
        yield from add_mirror_images(
            [rounded_box("upholstery", (0.08, 1.05, 0.3), (width / 2 + 0.06, 0.1, z + 0.12), 0.035, 2)]
        )
    yield from bedding(width, MATTRESS_LENGTH, 0.26, cover, pillows, 0.24)


def sleigh(width: float = 1.6, cover: Cover = "made", pillows: int = 2) -> Iterator[Solid]:
    """Build a sleigh bed with bedding and scrolled head and foot boards."""
    yield from rails(width, 0.16, 0.38)
    for z, high, out in ((-MATTRESS_LENGTH / 2 - 0.06, 1.1, -1), (MATTRESS_LENGTH / 2 + 0.06, 0.72, 1)):
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
    yield from bedding(width, MATTRESS_LENGTH, 0.33, cover, pillows)


def iron(width: float = 1.5, cover: Cover = "throw", pillows: int = 2) -> Iterator[Solid]:
    """Build an iron bed with bedding, and arched bars between posts with brass balls."""
    for z, high in ((-MATTRESS_LENGTH / 2 - 0.03, 1.12), (MATTRESS_LENGTH / 2 + 0.03, 0.8)):
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
        yield beam(
            "iron", (s * width / 2, 0.3, -MATTRESS_LENGTH / 2), (s * width / 2, 0.3, MATTRESS_LENGTH / 2), 0.03, 0.05
        )
    yield box("iron", (width - 0.02, 0.02, MATTRESS_LENGTH), (0.0, 0.29, 0.0))
    yield from bedding(width - 0.04, MATTRESS_LENGTH, 0.31, cover, pillows)


def futon_floor(width: float = 1.4, cover: Cover = "rumpled", pillows: int = 2) -> Iterator[Solid]:
    """Build a bed with bedding on a very low slatted frame."""
    for x in np.linspace(-width / 2 - 0.08, width / 2 + 0.08, 4):
        yield box("wood", (0.08, 0.1, MATTRESS_LENGTH + 0.24), (float(x), 0.0, 0.0))
    for i in range(13):
        yield rounded_box(
            "wood", (width + 0.3, 0.025, 0.1), (0.0, 0.1, (i - 6) * (MATTRESS_LENGTH + 0.12) / 12.5), 0.006, 1
        )
    yield from bedding(width, MATTRESS_LENGTH, 0.125, cover, pillows, 0.16)
