"""Plants with large leaves."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, move, rotate
from home_procgen.shapes.curves import spline
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.sheets import leaf
from home_procgen.shapes.sweep import prism, tube
from home_procgen.things.green.pots import GOLDEN_ANGLE, pot


def rosette(
    kind: str = "clay",
    count: int = 26,
    long: float = 0.5,
    wide: float = 0.07,
    radius: float = 0.14,
    rise: float = 1.3,
    droop: float = 1.4,
) -> Iterator[Solid]:
    """Build a spiral of leaves that rise from the soil: ferns, grasses, lilies."""
    high = 1.7 * radius
    yield from pot(kind, radius, high)
    for i in range(count):
        share = i / count
        yield leaf(
            "leaf",
            long * (0.6 + 0.4 * share),
            wide,
            (0.0, 0.85 * high, 0.0),
            GOLDEN_ANGLE * i,
            rise - 0.7 * (1 - share) + 0.1,
            droop * (0.7 + 0.5 * (1 - share)),
            pieces=5,
        )


def snake(kind: str = "square", count: int = 12) -> Iterator[Solid]:
    """Build a snake plant with stiff upright blades."""
    yield from pot(kind, 0.14, 0.26)
    for i in range(count):
        a, r = GOLDEN_ANGLE * i, 0.018 * np.sqrt(i)
        yield leaf("leaf", 0.5 + 0.04 * (i % 4) * 2, 0.065, (r * np.cos(a), 0.22, r * np.sin(a)), a, 1.5, 0.12, 0.7, 5)


def tree(
    kind: str = "basket", height: float = 1.6, leaves: int = 60, size: float = 0.22, stems: int = 1
) -> Iterator[Solid]:
    """Build a small tree with a trunk and a crown of leaves, such as a fig or a rubber tree."""
    radius = 0.19
    yield from pot(kind, radius, 0.34)
    for k in range(stems):
        a = 2 * np.pi * k / stems
        lean = 0.12 * (stems > 1)
        top = height - 0.12 * k
        points = spline(
            [
                (0.03 * k, 0.28, 0.0),
                (0.04 + lean * np.cos(a), 0.5 * top, lean * np.sin(a)),
                (1.6 * lean * np.cos(a), top - 0.1, 1.6 * lean * np.sin(a)),
            ],
            4,
        )
        yield tube("bark", points, np.linspace(0.026, 0.01, len(points)), 8)
        share = leaves // stems
        for i in range(share):
            t = 0.35 + 0.65 * i / share
            at = points[min(int(t * (len(points) - 1)), len(points) - 1)] + (
                0.0,
                (t * (len(points) - 1) % 1) * (top - 0.4) / len(points),
                0.0,
            )
            yield leaf(
                "leaf",
                size * (1.1 - 0.4 * t),
                0.5 * size,
                (float(at[0]), float(at[1]), float(at[2])),
                GOLDEN_ANGLE * i + k,
                0.55,
                0.9,
                1.1,
                4,
            )


def palm(kind: str = "round", fronds: int = 11, height: float = 0.9) -> Iterator[Solid]:
    """Build a palm with feathered fronds on a ringed trunk."""
    yield from pot(kind, 0.2, 0.34)
    rings = [
        (0.045 - 0.012 * t + 0.006 * (i % 2), 0.28 + (height - 0.28) * t) for i, t in enumerate(np.linspace(0, 1, 15))
    ]
    yield revolve("bark", rings, sides=10, steps=1)
    for i in range(fronds):
        yaw, long, up = GOLDEN_ANGLE * i, 0.75, 1.15 - 0.06 * (i % 5)
        t = np.linspace(0, 1, 9)
        pitch = up - 1.7 * t
        out, rise = np.cumsum(np.cos(pitch)) * long / 9, np.cumsum(np.sin(pitch)) * long / 9
        stem = [
            (float(o * np.sin(yaw)), float(height + r), float(o * np.cos(yaw))) for o, r in zip(out, rise, strict=True)
        ]
        yield tube("leaf", [(0.0, height - 0.02, 0.0), *stem], 0.006, 4)
        for k in range(2, 9):
            for s in (-1, 1):
                yield leaf(
                    "leaf", 0.26 * (1.1 - 0.06 * k), 0.035, stem[k], yaw + s * 0.85, float(pitch[k]) * 0.4, 0.8, 0.8, 2
                )


def monstera(kind: str = "cylinder", count: int = 13) -> Iterator[Solid]:
    """Build a monstera with broad notched leaves on long stalks."""
    yield from pot(kind, 0.17, 0.3)
    angle = np.linspace(0, 2 * np.pi, 29)[:-1]
    notch = 1 - 0.34 * (np.cos(9 * angle) > 0.72) * (np.abs(np.sin(angle)) > 0.3)
    outline = np.stack([0.62 * np.cos(angle) * notch, np.sin(angle) * notch * (1 - 0.25 * (np.sin(angle) < -0.9))], -1)
    for i in range(count):
        yaw, high = GOLDEN_ANGLE * i, 0.5 + 0.035 * i
        x, z = 0.3 * np.sin(yaw) * (1 - 0.02 * i), 0.3 * np.cos(yaw) * (1 - 0.02 * i)
        yield tube("leaf", spline([(0.0, 0.25, 0.0), (0.4 * x, 0.8 * high, 0.4 * z), (x, high + 0.1, z)], 3), 0.007, 5)
        size = 0.17 - 0.004 * i
        blade = prism("leaf", outline * size, 0.003, (0.0, size, 0.0))
        yield move(rotate(rotate(blade, 0, 1.05), 1, yaw), (x, high + 0.1, z))
