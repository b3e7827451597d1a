"""Rugs and mats."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from home_procgen.primitives.solids import Solid, cylinder, lathe
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import prism, rod
from home_procgen.things.family import FurnitureFamily, design


def _map_texture_once(piece: Solid) -> Solid:
    """Map the texture exactly once onto the upper side of a piece."""
    low, high = piece.box[:, [0, 2]]
    uv = (piece.vertices[piece.faces][..., [0, 2]] - low) / (high - low)
    return replace(piece, uv=uv)


def rug(width: float = 2.0, depth: float = 1.4, fringe: bool = False) -> Iterator[Solid]:
    """Build a woven rug with optional fringes at its short ends."""
    yield _map_texture_once(rounded_box("carpet", (width, 0.01, depth), (0.0, 0.0, 0.0), 0.004, 2))
    if fringe:
        for s in (-1, 1):
            for i in range(int(depth / 0.03)):
                z = (i + 0.5) * 0.03 - depth / 2
                yield rod(
                    "cream",
                    (s * width / 2, 0.004, z),
                    (s * (width / 2 + 0.06), 0.003, z + 0.006 * (-1) ** i),
                    0.003,
                    sides=4,
                )


def round_rug(radius: float = 0.8, braided: bool = False) -> Iterator[Solid]:
    """Build a round rug, plain or braided."""
    if not braided:
        yield _map_texture_once(cylinder("carpet_round", radius, 0.01, sides=48))
        return
    for i in range(9):
        yield _flat_ring(f"textile_{i % 4}", radius * i / 9, radius * (i + 1) / 9 - 0.004)


def _flat_ring(slot: str, inner: float, outer: float) -> Solid:
    return lathe(
        slot,
        [
            (max(inner, 0.005), 0.0),
            (outer, 0.0),
            (outer, 0.009),
            ((inner + outer) / 2, 0.012),
            (max(inner, 0.005), 0.009),
        ],
        closed=True,
        sides=40,
    )


def hide(length: float = 1.9) -> Iterator[Solid]:
    """Build an animal skin with four legs."""
    angle = np.linspace(0, 2 * np.pi, 61)[:-1]
    reach = (
        0.62
        + 0.2 * np.cos(2 * angle)
        + 0.2 * np.abs(np.cos(2 * (angle - np.pi / 4))) ** 6 * (1 - 0.3 * np.cos(2 * angle))
    )
    yield prism(
        "fur", np.stack([np.cos(angle) * reach, np.sin(angle) * reach * 0.9], -1) * length / 2, 0.012, plane="top"
    )
    yield prism(
        "fur",
        np.stack([np.cos(angle) * reach * 0.93, np.sin(angle) * reach * 0.84], -1) * length / 2,
        0.004,
        (0.0, 0.012, 0.0),
        "top",
    )


def tasselled(width: float = 1.9, depth: float = 1.3) -> Iterator[Solid]:
    """Build a rug with cut corners, a border and tassels."""
    cut, corner = 0.22, np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)])
    outline = [
        (float(x * (width / 2 - a)), float(z * (depth / 2 - b)))
        for k, (x, z) in enumerate(corner)
        for a, b in (((0.0, cut), (cut, 0.0)) if k % 2 == 0 else ((cut, 0.0), (0.0, cut)))
    ]
    yield prism("textile", outline, 0.008, plane="top")
    yield _map_texture_once(prism("carpet", [(0.9 * x, 0.88 * z) for x, z in outline], 0.004, (0.0, 0.008, 0.0), "top"))
    for x, z in outline:
        yield rod("cream", (0.99 * x, 0.006, 0.99 * z), (1.06 * x, 0.006, 1.07 * z), 0.005, 0.002, 6)


def mat(kind: str = "bath") -> Iterator[Solid]:
    """Build a bath mat, a doormat or a half-round mat."""
    if kind == "bath":
        yield rounded_box("towel", (0.75, 0.016, 0.5), (0.0, 0.0, 0.0), 0.007, 2)
        for i in range(5):
            yield rounded_box("towel", (0.66, 0.008, 0.05), (0.0, 0.013, (i - 2) * 0.08), 0.004, 1)
    elif kind == "door":
        yield rounded_box("rubber", (0.75, 0.01, 0.45), (0.0, 0.0, 0.0), 0.004, 1)
        yield rounded_box("soil", (0.7, 0.014, 0.4), (0.0, 0.004, 0.0), 0.004, 2)
        for i in range(3):
            yield rounded_box("rubber", (0.5 - 0.1 * i, 0.003, 0.02), (0.0, 0.0165, (i - 1) * 0.08), 0.001, 1)
    else:
        half = [(0.42 * np.cos(a), -0.2 + 0.46 * np.sin(a)) for a in np.linspace(0, np.pi, 20)]
        yield prism("textile", half, 0.014, plane="top")
        yield prism(
            "textile_1", [(0.82 * x, -0.17 + 0.82 * (z + 0.2)) for x, z in half], 0.004, (0.0, 0.014, 0.0), "top"
        )


RUGS = (
    design(rug), design(rug, width=2.4, depth=1.7, fringe=True), design(round_rug), design(round_rug, braided=True),
    design(hide), design(rug, width=1.4, depth=0.8), design(rug, width=2.8, depth=0.75, fringe=True),
    design(round_rug, radius=0.6), design(tasselled),
)  # fmt: skip

MATS = tuple(design(mat, kind=kind) for kind in ("bath", "door", "half"))


FAMILIES = (
    FurnitureFamily("rug", "rug", RUGS),
    FurnitureFamily("mat", "rug", MATS),
)
