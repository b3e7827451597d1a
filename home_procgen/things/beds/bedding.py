"""Mattresses in their rails, pillows and covers, smooth or rumpled."""

from collections.abc import Iterator
from typing import Literal

import numpy as np

from home_procgen.primitives.solids import Solid, box, move, rotate
from home_procgen.shapes.rounded import join_grids, padded_block, pillow, rounded_box
from home_procgen.shapes.transforms import add_mirror_images

Cover = Literal["made", "folded", "rumpled", "aside", "throw", "bare"]

MATTRESS_LENGTH = 2.0  # [m], length of a mattress


def bedding(
    width: float,
    length: float,
    base: float,
    cover: Cover = "made",
    pillows: int = 2,
    thick: float = 0.2,
    z: float = 0.0,
    seed: int = 1,
) -> Iterator[Solid]:
    """Build a mattress with its head towards -z, with pillows and a cover.

    Args:
        width: Width of the mattress [m].
        length: Length of the mattress [m].
        base: Height of the underside of the mattress [m].
        cover: State of the cover.
        pillows: Number of pillows side by side.
        thick: Thickness of the mattress [m].
        z: Centre of the mattress along z [m].
        seed: Seed of the folds.
    """
    rng = np.random.default_rng(seed)
    yield rounded_box("linen", (width, thick, length), (0.0, base, z), 0.05, 3)
    top, wide = base + thick, width / max(pillows, 1)
    for i in range(pillows):
        turn = float(rng.normal(0, 0.25 if cover in ("rumpled", "aside") else 0.01))
        case = pillow(
            "linen_1", (min(0.7, wide - 0.05), 0.17, 0.44), (0.0, 0.0, 0.0), 8, 0.35 if cover != "made" else 0.1
        )
        case = rotate(rotate(case, 0, -0.12), 1, turn)
        lift = (float((i - (pillows - 1) / 2) * wide), top - 0.02 - float(case.box[0, 1]), z - length / 2 + 0.28)
        yield move(case, lift)
    if cover != "bare":
        yield _cover(cover, width, length, top, base, z, rng)
    if cover == "folded":
        yield padded_block("linen_1", (width + 0.04, 0.05, 0.3), (0.0, top + 0.02, z - length / 2 + 0.72), 9.0, 6)
    if cover == "throw":
        yield _throw(width, top, base, z + length / 2 - 0.5, 0.5)


def _cover(
    kind: str, width: float, length: float, top: float, base: float, z: float, rng: np.random.Generator
) -> Solid:
    """Build a duvet from below the pillows to the foot, hanging over three sides."""
    start = {"made": 0.62, "folded": 0.78, "rumpled": 0.8, "aside": 0.7, "throw": 0.58}[kind]
    n, m = (22, 26) if kind in ("rumpled", "aside") else (14, 18)
    u, v = np.meshgrid(np.linspace(-1, 1, m + 1), np.linspace(0, 1, n + 1))
    fall = min(0.26, top - base + 0.06)
    half = width / 2
    across = u * (half + fall)
    side = np.clip(np.abs(across) - half - 0.03, 0, None)
    along = start + v * (length - start + fall * 0.8)
    foot = np.clip(along - length - 0.03, 0, None)
    drop = np.hypot(side, foot)
    x = np.clip(across, -half - 0.03, half + 0.03)
    zz = z - length / 2 + np.minimum(along, length + 0.03) + 0.15 * foot
    puff = 0.045 * (1 - np.clip(drop / 0.04, 0, 1)) + 0.012 * np.cos(np.pi * u * 2.5) * np.cos(np.pi * v * 3) * (
        drop == 0
    )
    waves = np.zeros_like(u)
    if kind in ("rumpled", "aside"):
        for _ in range(9):
            a, b, c, d = rng.uniform(-1, 1, 4)
            waves += 0.016 * np.cos(7 * (a * u + b * v * 2) + 6 * c) * (0.5 + abs(d))
        waves += 0.07 * np.exp(-(((u - 0.35) / 0.35) ** 2) - ((v - 0.22) / 0.2) ** 2)
        puff = puff + np.abs(waves) * (drop == 0)
        zz = zz + (0.18 * np.sin(2.2 * u + 0.6) + 0.05 * np.sin(9 * u)) * (1 - v) ** 2
    if kind == "aside":
        turned = np.clip((u - 0.1 - 0.8 * v) / 0.5, 0, 1) * (u > 0.0)
        x, puff = x - 0.75 * turned * (half + 0.03) * u, puff + 0.1 * turned * (1 - turned) * 2 + 0.05 * turned
        drop = drop * (1 - turned)
    y = top + puff - drop
    x = x + np.sign(u) * ((0.02 + 0.012 * np.sin(16 * v)) * (side > 0) + 0.15 * side)
    upper = np.stack([x, y, zz], -1)
    inward = np.stack([-0.02 * np.sign(u) * (side > 0), -0.035 * (drop == 0) - 0.004, -0.02 * (foot > 0)], -1)
    return join_grids("linen_2", upper[:, ::-1], (upper + inward)[:, ::-1])


def _throw(width: float, top: float, base: float, z: float, deep: float) -> Solid:
    """Build a blanket across the foot of the bed."""
    u, v = np.meshgrid(np.linspace(-1, 1, 21), np.linspace(0, 1, 9))
    half = width / 2 + 0.045
    across = u * (half + 0.2)
    drop = np.clip(np.abs(across) - half, 0, None)
    x = np.clip(across, -half, half)
    y = top + 0.062 - drop + 0.006 * np.cos(9 * u + 3 * v) * (drop == 0)
    points = np.stack([x, y, z - deep / 2 + v * deep + 0.02 * np.sin(5 * u)], -1)
    under = points - np.stack([0.014 * np.sign(u) * (drop > 0), 0.014 * (drop == 0), 0 * u], -1)
    return join_grids("textile", points[:, ::-1], under[:, ::-1])


def rails(width: float, low: float, high: float, slot: str = "wood") -> Iterator[Solid]:
    """Build a frame around the mattress and its base board."""
    z = MATTRESS_LENGTH / 2 + 0.02
    yield from add_mirror_images(
        [rounded_box(slot, (0.035, high - low, 2 * z + 0.03), (width / 2 + 0.02, low, 0.0), 0.008, 1)]
    )
    yield rounded_box(slot, (width + 0.07, high - low, 0.035), (0.0, low, z), 0.008, 1)
    yield box(slot, (width, 0.03, 2 * z - 0.01), (0.0, high - 0.08, 0.0))
