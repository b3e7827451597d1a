"""Table tops and bases shared by several kinds of table."""

from collections.abc import Iterator
from typing import Literal

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder
from home_procgen.shapes.curves import loop
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import beam, prism, ring, rod
from home_procgen.shapes.transforms import repeat_around
from home_procgen.things.joinery import LegKind, legs

TopKind = Literal["board", "round", "oval", "pill", "edge"]


def top(
    material: str, width: float, depth: float, height: float, kind: TopKind = "board", thick: float = 0.03
) -> Iterator[Solid]:
    """Build a table top with its upper surface at `height` [m]."""
    at = (0.0, height - thick, 0.0)
    if kind == "board":
        yield rounded_box(material, (width, thick, depth), at, 0.35 * thick, 2)
    elif kind == "round":
        edge = [
            (width / 2 - 0.012, 0.0),
            (width / 2, 0.4 * thick),
            (width / 2, 0.75 * thick),
            (width / 2 - 0.008, thick),
        ]
        yield revolve(material, edge, at, 36, 1)
    elif kind == "edge":
        yield rounded_box(material, (width, 0.6 * thick, depth), at, 0.2 * thick, 1)
        yield rounded_box(
            material,
            (width - 0.04, 0.4 * thick + 0.001, depth - 0.04),
            (0.0, height - 0.4 * thick, 0.0),
            0.15 * thick,
            1,
        )
    else:
        outline = loop(width, depth, 36, 2.0 if kind == "oval" else 3.2)
        yield prism(material, outline, thick, at, "top")


def four_legs(
    width: float,
    depth: float,
    height: float,
    kind: LegKind = "square",
    thick: float = 0.07,
    apron: float = 0.08,
    material: str = "wood",
) -> Iterator[Solid]:
    """Build corner legs and the apron boards between them under the top."""
    yield from legs(material, width - 0.08, depth - 0.08, height, kind, thick)
    if apron:
        for s in (-1, 1):
            yield box(material, (width - 0.08 - thick, apron, 0.02), (0.0, height - apron, s * (depth / 2 - 0.06)))
            yield box(material, (0.02, apron, depth - 0.08 - thick), (s * (width / 2 - 0.06), height - apron, 0.0))


def trestle(width: float, depth: float, height: float) -> Iterator[Solid]:
    """Build two end posts between beams, joined by a wedged bar."""
    for s in (-1, 1):
        x = s * (width / 2 - 0.25)
        yield rounded_box("wood", (0.09, 0.07, depth - 0.12), (x, 0.0, 0.0), 0.02, 1)
        yield rounded_box("wood", (0.08, 0.06, depth - 0.2), (x, height - 0.06, 0.0), 0.015, 1)
        yield rounded_box("wood", (0.07, height - 0.1, 0.16), (x, 0.05, 0.0), 0.015, 1)
        yield box("wood", (0.025, 0.1, 0.035), (x + s * 0.06, 0.26, 0.0))
    yield box("wood", (width - 0.3, 0.1, 0.035), (0.0, 0.26, 0.0))


def crossed(width: float, depth: float, height: float, material: str = "iron") -> Iterator[Solid]:
    """Build two X-shaped ends and a rail."""
    for s in (-1, 1):
        x = s * (width / 2 - 0.16)
        for a in (-1, 1):
            yield beam(material, (x, 0.018, a * (depth / 2 - 0.1)), (x, height - 0.018, -a * (depth / 2 - 0.1)), 0.05)
        for y in (0.01, height - 0.01):
            yield rounded_box(material, (0.06, 0.02, depth - 0.12), (x, y - 0.01, 0.0), 0.006, 1)
    yield beam(material, (0.16 - width / 2, height / 2, 0.0), (width / 2 - 0.16, height / 2, 0.0), 0.04)


def pedestal(radius: float, height: float, material: str = "wood", feet: int = 0) -> Iterator[Solid]:
    """Build a turned column on a round plate or curved feet."""
    if feet:
        shape = [(0.05, 0.1), (0.06, 0.2), (0.035, 0.3), (0.06, 0.45), (0.04, 0.8), (0.07, 1.0)]
        yield revolve(material, [(r, h * height) for r, h in shape], sides=16, steps=2)
        foot = [
            beam(material, (0.0, 0.14, 0.02), (0.0, 0.03, 0.75 * radius), 0.05, 0.06),
            cylinder(material, 0.03, 0.035, (0.0, 0.0, 0.75 * radius), sides=10),
        ]
        yield from (piece for piece in repeat_around(foot, feet) if isinstance(piece, Solid))
    else:
        shape = [(0.62, 0.0), (0.6, 0.02), (0.2, 0.05), (0.1, 0.12), (0.09, 0.6), (0.12, 0.9), (0.32, 1.0)]
        yield revolve(material, [(r * radius, h * height) for r, h in shape], sides=24, steps=3)


def panels(width: float, depth: float, height: float, material: str = "wood") -> Iterator[Solid]:
    """Build two full end panels and a long board between them."""
    for s in (-1, 1):
        yield rounded_box(material, (0.045, height, depth - 0.08), (s * (width / 2 - 0.1), 0.0, 0.0), 0.01, 1)
    yield box(material, (width - 0.22, 0.2, 0.025), (0.0, height - 0.24, 0.0))


def drum_base(radius: float, height: float, slats: int = 20) -> Iterator[Solid]:
    """Build a ring of slats."""
    for a in 2 * np.pi * np.arange(slats) / slats:
        yield rod(
            "wood",
            (radius * np.cos(a), 0.02, radius * np.sin(a)),
            (radius * np.cos(a), height, radius * np.sin(a)),
            0.014,
            sides=6,
        )
    yield ring("wood", radius, 0.036, (0.0, 0.018, 0.0), 1, 24)


def wire_base(radius: float, height: float, count: int = 14) -> Iterator[Solid]:
    """Build rods that lean around a waist."""
    for i in range(count):
        a, b = 2 * np.pi * i / count, 2 * np.pi * (i + 4) / count
        yield rod(
            "iron",
            (radius * np.cos(a), 0.01, radius * np.sin(a)),
            (radius * np.cos(b), height, radius * np.sin(b)),
            0.005,
            sides=5,
        )
    for y in (0.008, height - 0.006):
        yield ring("iron", radius, 0.012, (0.0, y, 0.0), 1, 24)
