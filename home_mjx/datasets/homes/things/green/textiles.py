"""Curtains, rugs, pillows."""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from home_mjx.datasets.homes.shapes.sheets import surface
from home_mjx.datasets.homes.shapes.soft import ball, between_loops, pillow, rounded
from home_mjx.datasets.homes.shapes.swept import prism, ring, rod, tube
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.procedural.primitives.solids import Solid, box, cylinder, lathe, rotate


def _fall(
    slot: str,
    left: float,
    right: float,
    top: float,
    low: float,
    folds: float,
    deep: float,
    tie: float = 0.0,
    side: int = 0,
) -> Solid:
    """Cloth in folds between two edges; `tie` gathers it towards `side` at a third of its height."""
    width = right - left

    def place(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
        rise = np.clip(v / 0.62, 0, 1)
        gather = tie * rise**2 * (3 - 2 * rise) * (1 - 0.9 * np.clip(v - 0.62, 0, 1))
        share = u * (1 - gather) + gather * (side > 0)
        wave = deep * np.sin(2 * np.pi * folds * u) * (0.75 + 0.25 * v)
        return left + share * width, top - v * (top - low), wave + 0.2 * deep * np.sin(2 * np.pi * folds * 0.43 * u + 1)

    return surface(slot, place, int((7 if tie else 10) * folds), 8 if tie else 3, 0.006)


def _pole(width: float, y: float, slot: str = "wood", ends: str = "ball") -> Iterator[Solid]:
    yield rod(slot, (-width / 2 - 0.06, y, 0.0), (width / 2 + 0.06, y, 0.0), 0.014, sides=10)
    for s in (-1, 1):
        x = s * (width / 2 + 0.07)
        if ends == "ball":
            yield ball(slot, 0.03, (x, y, 0.0), 12, 8)
        else:
            yield rounded(slot, (0.03, 0.05, 0.05), (x, y - 0.025, 0.0), 0.006, 1)
        yield rod(slot, (s * width / 2, y, -0.1), (s * width / 2, y, 0.0), 0.008)
    for i in range(10):
        yield ring(slot, 0.02, 0.006, (-width / 2 + 0.02 + i * (width - 0.04) / 9, y - 0.008, 0.0), 0, 10)


def drapes(
    width: float = 2.0, height: float = 2.3, open_: float = 0.27, tied: bool = False, sheers: bool = False
) -> Iterator[Solid]:
    """Two lengths of cloth on a pole, to the floor, drawn aside or tied, perhaps with sheers between."""
    yield from _pole(width, height - 0.03)
    for s in (-1, 1):
        inner, outer = s * width / 2 * (1 - 2 * open_) if not tied else s * 0.04, s * width / 2
        left, right = min(inner, outer), max(inner, outer)
        yield _fall("curtain", left, right, height - 0.05, 0.01, 5 if not tied else 7, 0.035, 0.62 if tied else 0.0, s)
        if tied:
            yield tube(
                "brass",
                [
                    (s * (width / 2 - 0.34), 0.95, 0.05),
                    (s * (width / 2 - 0.1), 0.9, 0.07),
                    (s * width / 2, 0.98, -0.05),
                ],
                0.012,
                6,
            )
    if sheers:
        yield _fall("sheer", -width / 2 + 0.02, width / 2 - 0.02, height - 0.05, 0.02, 11, 0.018)


def portiere(width: float = 1.0, height: float = 2.1) -> Iterator[Solid]:
    """One length of cloth, drawn to one side."""
    yield from _pole(width, height - 0.03, "iron", "block")
    yield _fall("curtain", -width / 2, -0.05, height - 0.05, 0.01, 6, 0.04)


def cafe(width: float = 1.3, height: float = 0.75) -> Iterator[Solid]:
    """Short curtains on a rod across the lower half of a window."""
    yield from _pole(width, height - 0.02, "brass", "ball")
    for s in (-1, 1):
        yield _fall("curtain", min(s * 0.03, s * width / 2), max(s * 0.03, s * width / 2), height - 0.04, 0.0, 6, 0.022)


def valance(width: float = 1.7, height: float = 1.6) -> Iterator[Solid]:
    """A box with a scalloped cloth above short curtains."""
    yield rounded("wood", (width + 0.1, 0.05, 0.16), (0.0, height - 0.05, -0.01), 0.008, 1)
    t = np.linspace(-1, 1, 41)
    edge = [(x * (width / 2 + 0.03), height - 0.26 - 0.07 * abs(np.sin(2.5 * np.pi * x))) for x in t]
    yield prism(
        "curtain_1",
        [(width / 2 + 0.03, height - 0.05), (-width / 2 - 0.03, height - 0.05), *edge],
        0.02,
        (0.0, 0.0, 0.05),
    )
    for s in (-1, 1):
        inner, outer = s * width * 0.26, s * width / 2
        yield _fall("curtain", min(inner, outer), max(inner, outer), height - 0.08, 0.0, 5, 0.03)


def roman(width: float = 1.2, height: float = 1.5, drawn: float = 0.55) -> Iterator[Solid]:
    """A blind that folds up in broad pleats."""
    yield rounded("wood", (width, 0.04, 0.05), (0.0, height - 0.04, 0.0), 0.006, 1)
    low, folds = height * (1 - drawn), 4
    yield surface(
        "curtain",
        lambda u, v: ((u - 0.5) * width, height - 0.03 - v * (height - low - 0.1), 0.012 + 0.006 * np.sin(8 * v)),
        2,
        8,
        0.006,
    )
    for i in range(folds):
        path = [(-width / 2, low + 0.05 * i, 0.02 + 0.012 * i), (width / 2, low + 0.05 * i, 0.02 + 0.012 * i)]
        yield tube("curtain", path, 0.035, 10)
    yield rod("cream", (width / 2 - 0.05, low - 0.25, 0.04), (width / 2 - 0.05, height - 0.05, 0.02), 0.003, sides=5)


def roller(width: float = 1.1, height: float = 1.5, drawn: float = 0.6) -> Iterator[Solid]:
    """A blind on a roll."""
    yield tube("white", [(-width / 2, height - 0.04, 0.0), (width / 2, height - 0.04, 0.0)], 0.035, 14)
    low = height * (1 - drawn)
    yield surface(
        "curtain",
        lambda u, v: ((u - 0.5) * (width - 0.04), height - 0.04 - v * (height - 0.04 - low), -0.03 + 0 * u),
        2,
        4,
        0.003,
    )
    yield rounded("wood", (width - 0.04, 0.03, 0.014), (0.0, low - 0.02, -0.03), 0.005, 1)
    for s in (-1, 1):
        yield rounded("white", (0.015, 0.09, 0.09), (s * (width / 2 + 0.008), height - 0.085, -0.01), 0.006, 1)
    yield rod("cream", (width / 2 - 0.02, low + 0.1, 0.03), (width / 2 - 0.02, height - 0.05, 0.03), 0.003, sides=5)


def slats(width: float = 1.2, height: float = 1.5, upright: bool = False) -> Iterator[Solid]:
    """A Venetian blind, or upright slats on a rail."""
    yield rounded("white", (width, 0.05, 0.06), (0.0, height - 0.05, 0.0), 0.008, 1)
    if upright:
        count = int(width / 0.09)
        for i in range(count):
            x = (i + 0.5) / count * width - width / 2
            yield rotate(box("sheer", (0.085, height - 0.07, 0.003), (x, 0.02, 0.0)), 1, 0.6, (x, 0.0, 0.0))
    else:
        for i in range(int((height - 0.1) / 0.045)):
            y = 0.04 + 0.045 * i
            yield rotate(box("white", (width - 0.02, 0.003, 0.045), (0.0, y, 0.0)), 0, 0.5, (0.0, y, 0.0))
        yield rounded("white", (width - 0.02, 0.02, 0.05), (0.0, 0.0, 0.0), 0.006, 1)
        for x in (-0.35 * width, 0.35 * width):
            yield rod("white", (x, 0.01, 0.024), (x, height - 0.03, 0.024), 0.002, sides=4)
    yield rod("white", (0.45 * width, 0.5 * height, 0.04), (0.45 * width, height - 0.03, 0.04), 0.004, sides=5)


def _once(piece: Solid) -> Solid:
    """Shows a texture exactly once on the upper side of a piece."""
    low, high = piece.box[:, [0, 2]]
    uv = (piece.vertices[piece.faces][..., [0, 2]] - low) / (high - low)
    return replace(piece, uv=uv)


def rug(width: float = 2.0, depth: float = 1.4, fringe: bool = False) -> Iterator[Solid]:
    """A woven rug, perhaps with fringes at its short ends."""
    yield _once(rounded("carpet", (width, 0.01, depth), (0.0, 0.0, 0.0), 0.004, 2))
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
    """A round rug, or one of plaits."""
    if not braided:
        yield _once(cylinder("carpet_round", radius, 0.01, sides=48))
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
    """A skin with four legs."""
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


def mat(kind: str = "bath") -> Iterator[Solid]:
    """A bath mat, a doormat, or a half-round one."""
    if kind == "bath":
        yield rounded("towel", (0.75, 0.016, 0.5), (0.0, 0.0, 0.0), 0.007, 2)
        for i in range(5):
            yield rounded("towel", (0.66, 0.008, 0.05), (0.0, 0.013, (i - 2) * 0.08), 0.004, 1)
    elif kind == "door":
        yield rounded("rubber", (0.75, 0.01, 0.45), (0.0, 0.0, 0.0), 0.004, 1)
        yield rounded("soil", (0.7, 0.014, 0.4), (0.0, 0.004, 0.0), 0.004, 2)
        for i in range(3):
            yield rounded("rubber", (0.5 - 0.1 * i, 0.003, 0.02), (0.0, 0.0165, (i - 1) * 0.08), 0.001, 1)
    else:
        half = [(0.42 * np.cos(a), -0.2 + 0.46 * np.sin(a)) for a in np.linspace(0, np.pi, 20)]
        yield prism("textile", half, 0.014, plane="top")
        yield prism(
            "textile_1", [(0.82 * x, -0.17 + 0.82 * (z + 0.2)) for x, z in half], 0.004, (0.0, 0.014, 0.0), "top"
        )


def _square() -> Iterator[Solid]:
    yield pillow("patterned", (0.45, 0.15, 0.45), steps=10)


def _oblong() -> Iterator[Solid]:
    yield pillow("patterned", (0.6, 0.15, 0.36), steps=10)
    for s in (-1, 1):
        for i in range(9):
            yield rod("cream", (s * 0.29, 0.075, (i - 4) * 0.035), (s * 0.33, 0.07, (i - 4) * 0.035), 0.004, sides=5)


def _roll() -> Iterator[Solid]:
    yield tube(
        "textile",
        [(-0.3, 0.09, 0.0), (-0.28, 0.09, 0.0), (0.28, 0.09, 0.0), (0.3, 0.09, 0.0)],
        [0.07, 0.09, 0.09, 0.07],
        20,
    )
    for s in (-1, 1):
        yield ball("brass", 0.018, (s * 0.305, 0.09, 0.0), 10, 6)


def _ball() -> Iterator[Solid]:
    yield ball("textile", (0.17, 0.15, 0.17), (0.0, 0.15, 0.0), 20, 12)
    yield ball("brass", (0.02, 0.008, 0.02), (0.0, 0.3, 0.0), 10, 6)


def _heart() -> Iterator[Solid]:
    t = np.linspace(0, 2 * np.pi, 33)[:-1]
    outline = (
        np.stack([16 * np.sin(t) ** 3, -(13 * np.cos(t) - 5 * np.cos(2 * t) - 2 * np.cos(3 * t) - np.cos(4 * t))], -1)
        * 0.0135
    )
    bulge = ((0.0, 0.7), (0.012, 0.88), (0.04, 1.0), (0.08, 1.0), (0.108, 0.88), (0.12, 0.7))
    yield between_loops("bright", [np.insert(outline * size, 1, y, axis=1) for y, size in bulge])


def _pile() -> Iterator[Solid]:
    yield pillow("patterned", (0.5, 0.15, 0.5), steps=8)
    yield rotate(pillow("patterned_1", (0.44, 0.14, 0.44), (0.0, 0.125, 0.0), 8), 1, 0.5)


_CUSHION_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "square": _square,
    "oblong": _oblong,
    "roll": _roll,
    "ball": _ball,
    "heart": _heart,
    "pile": _pile,
}


def cushion(kind: str = "square") -> Iterator[Solid]:
    """Loose pillows: square, oblong, a roll, a ball, a heart, a pile."""
    yield from _CUSHION_KINDS[kind]()


CURTAINS = (
    design(drapes), design(drapes, tied=True), design(drapes, sheers=True), design(cafe), design(valance),
    design(roman), design(roller), design(slats), design(slats, upright=True, width=1.8, height=2.2),
    design(drapes, width=1.4, open_=0.22), design(drapes, width=2.6, sheers=True, open_=0.2),
    design(roman, width=0.8, height=0.9, drawn=0.45), design(portiere),
)  # fmt: skip
RUGS = (
    design(rug), design(rug, width=2.4, depth=1.7, fringe=True), design(round_rug), design(round_rug, braided=True),
    design(hide), design(rug, width=1.4, depth=0.8), design(rug, width=2.8, depth=0.75, fringe=True),
    design(round_rug, radius=0.6),
)  # fmt: skip
MATS = tuple(design(mat, kind=kind) for kind in ("bath", "door", "half"))
PILLOWS = tuple(design(cushion, kind=kind) for kind in ("square", "oblong", "roll", "ball", "heart", "pile"))

FAMILIES = (
    Family("curtain", "curtain", CURTAINS),
    Family("rug", "rug", RUGS),
    Family("mat", "rug", MATS),
    Family("pillow", "pillow", PILLOWS),
)
