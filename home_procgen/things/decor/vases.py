"""Vases, empty or with flowers."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, cylinder
from home_procgen.shapes.curves import loop, spline
from home_procgen.shapes.revolve import vessel
from home_procgen.shapes.rounded import ball, join_loops
from home_procgen.shapes.sheets import leaf
from home_procgen.shapes.sweep import tube
from home_procgen.things.family import FurnitureFamily, design

VASE_SHAPES = {
    "amphora": [(0.05, 0.0), (0.1, 0.12), (0.11, 0.2), (0.05, 0.3), (0.045, 0.34), (0.07, 0.37)],
    "bottle": [(0.07, 0.0), (0.085, 0.05), (0.08, 0.14), (0.025, 0.22), (0.022, 0.33), (0.03, 0.34)],
    "trumpet": [(0.05, 0.0), (0.02, 0.02), (0.03, 0.08), (0.05, 0.22), (0.11, 0.32)],
    "globe": [(0.04, 0.0), (0.11, 0.08), (0.1, 0.16), (0.045, 0.2), (0.05, 0.215)],
    "cylinder": [(0.06, 0.0), (0.06, 0.28)],
    "hourglass": [(0.08, 0.0), (0.085, 0.05), (0.04, 0.14), (0.075, 0.24), (0.085, 0.28)],
    "floor": [(0.12, 0.0), (0.15, 0.1), (0.18, 0.4), (0.1, 0.62), (0.08, 0.7), (0.11, 0.74)],
}


def vase(kind: str = "amphora", slot: str = "glaze", stems: int = 0) -> Iterator[Solid]:
    """Build a turned vase, empty or with flowers."""
    shape = VASE_SHAPES[kind]
    yield vessel(slot, shape, 0.005, sides=24, steps=1 if kind == "cylinder" else 4)
    if slot in ("glass", "tint"):
        yield (
            cylinder("water", 0.85 * shape[1][0], 0.45 * shape[-1][1], (0.0, 0.008, 0.0), sides=20)
            if kind == "cylinder"
            else ball("water", (0.09, 0.05, 0.09), (0.0, 0.07, 0.0), 18, 10)
        )
    yield from flowers(stems, shape[-1][1], shape[-1][0])


def flowers(stems: int, top: float, mouth: float) -> Iterator[Solid]:
    """Build stems with blossoms and leaves that rise from a vase's mouth."""
    for i in range(stems):
        a, r = 2.4 * i, 0.045 * np.sqrt(i) + 0.02
        tip = (r * np.cos(a) * 1.6, top + 0.26 - 0.35 * r, r * np.sin(a) * 1.6)
        foot = (0.4 * mouth * np.cos(a), 0.5 * top, 0.4 * mouth * np.sin(a))
        yield tube("leaf", [foot, (0.6 * mouth * np.cos(a), top, 0.6 * mouth * np.sin(a)), tip], 0.003, 4)
        yield leaf("leaf", 0.12, 0.03, (0.5 * tip[0], top + 0.07, 0.5 * tip[2]), a, 0.9, 1.0, pieces=3)
        for k in range(2):
            for p in range(6):
                yield leaf(
                    f"petal_{i % 3}",
                    0.045 - 0.012 * k,
                    0.028,
                    tip,
                    np.pi * (p / 3 + k / 6),
                    0.35 + 0.6 * k,
                    0.5,
                    1.2,
                    2,
                )
        yield ball("yellow", 0.01, (tip[0], tip[1] + 0.008, tip[2]), 8, 4)


def twigs(kind: str = "floor") -> Iterator[Solid]:
    """Build a tall vase with branches or pampas grass."""
    yield from vase(kind)
    top = VASE_SHAPES[kind][-1][1]
    for i in range(9):
        a = 2.4 * i
        tip = (0.22 * np.cos(a), top + 0.5 - 0.03 * (i % 4), 0.22 * np.sin(a))
        path = spline([(0.0, 0.4 * top, 0.0), (0.03 * np.cos(a), top, 0.03 * np.sin(a)), tip], 4)
        yield tube("bark", path, 0.004, 5)
        yield tube(
            "cream",
            np.array([path[-3], path[-2], tip, (1.25 * tip[0], tip[1] + 0.05, 1.25 * tip[2])]),
            [0.012, 0.03, 0.022, 0.003],
            7,
        )


def ribbed(square: bool = False) -> Iterator[Solid]:
    """Build a fluted vase, or a twisted square one."""
    if square:
        base = loop(0.16, 0.16, 16, 5.0)
        loops = []
        for k, y in enumerate(np.linspace(0, 0.3, 13)):
            t = 0.12 * k
            turn = np.array([[np.cos(t), -np.sin(t)], [np.sin(t), np.cos(t)]])
            loops.append(np.insert(base @ turn.T * (0.8 + 0.3 * np.sin(2.4 * y / 0.3)), 1, y, axis=1))
        inner = [np.stack([0.8 * p[:, 0], np.maximum(p[:, 1], 0.01), 0.8 * p[:, 2]], -1) for p in loops[::-3]]
        yield join_loops("glaze", [*loops, *inner])
        return
    angle = 2 * np.pi * np.arange(36) / 36
    flute = 1 + 0.07 * (np.arange(36) % 2)
    profile = spline([(0.06, 0.0), (0.09, 0.08), (0.08, 0.2), (0.05, 0.26), (0.07, 0.3)], 3)
    loops = [np.stack([r * flute * np.cos(angle), np.full(36, y), r * flute * np.sin(angle)], -1) for r, y in profile]
    inner = [np.stack([0.85 * p[:, 0], np.maximum(p[:, 1], 0.012), 0.85 * p[:, 2]], -1) for p in loops[::-2]]
    yield join_loops("glaze", [*loops, *inner])


def twin_handles() -> Iterator[Solid]:
    """Build an urn on a foot with two handles."""
    yield vessel(
        "terracotta",
        [(0.07, 0.0), (0.03, 0.04), (0.1, 0.16), (0.11, 0.24), (0.05, 0.32), (0.06, 0.36)],
        0.006,
        sides=24,
        steps=3,
    )
    for s in (-1, 1):
        yield tube(
            "terracotta",
            spline([(s * 0.105, 0.23, 0.0), (s * 0.17, 0.3, 0.0), (s * 0.11, 0.36, 0.0), (s * 0.05, 0.33, 0.0)], 4),
            0.011,
            8,
        )


VASES = (
    *(design(vase, kind=kind) for kind in ("amphora", "bottle", "trumpet", "hourglass")),
    design(vase, kind="globe", slot="glass", stems=9), design(vase, kind="cylinder", slot="glass", stems=6),
    design(twigs), design(ribbed), design(ribbed, square=True), design(twin_handles),
    design(vase, kind="amphora", stems=12), design(vase, kind="bottle", slot="tint", stems=1),
)  # fmt: skip


FAMILIES = (FurnitureFamily("vase", "vase", VASES),)
