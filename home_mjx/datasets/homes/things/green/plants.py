"""Plants in pots."""

from collections.abc import Iterator

import numpy as np

from home_mjx.datasets.homes.shapes.curves import spline
from home_mjx.datasets.homes.shapes.sheets import leaf
from home_mjx.datasets.homes.shapes.soft import ball, rounded
from home_mjx.datasets.homes.shapes.swept import prism, rod, sweep, tube
from home_mjx.datasets.homes.shapes.turned import turned, vessel
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.joinery import legs
from home_mjx.datasets.procedural.primitives.solids import Solid, box, cylinder, move, rotate

GOLDEN = 2.399963  # [rad], angle between one leaf and the next


def pot(kind: str = "clay", radius: float = 0.15, height: float = 0.26) -> Iterator[Solid]:
    """A pot with soil, whose rim is at `height` [m]."""
    shapes = {
        "clay": [(0.68, 0.0), (0.9, 0.78), (1.0, 0.8), (1.0, 1.0)],
        "round": [(0.6, 0.0), (1.0, 0.35), (0.98, 0.7), (0.8, 1.0)],
        "cylinder": [(0.92, 0.0), (0.96, 0.05), (0.96, 1.0)],
        "basket": [(0.85, 0.0), (1.0, 0.4), (0.95, 1.0)],
        "urn": [(0.6, 0.0), (0.5, 0.08), (0.35, 0.18), (0.9, 0.6), (0.85, 0.9), (1.0, 1.0)],
    }
    slot = {"clay": "terracotta", "basket": "cane"}.get(kind, "glaze")
    if kind in ("square", "stand"):
        lift = 0.0 if kind == "square" else 0.45 * height
        wall = 0.1 * radius
        for s in (-1, 1):
            yield rounded(slot, (wall, height - lift, 1.9 * radius), (s * 0.9 * radius, lift, 0.0), 0.006, 1)
            yield rounded(slot, (1.9 * radius, height - lift, wall), (0.0, lift, s * 0.9 * radius), 0.006, 1)
        yield box("soil", (1.75 * radius, 0.85 * (height - lift), 1.75 * radius), (0.0, lift, 0.0))
        if kind == "stand":
            yield from legs("wood", 2.0 * radius, 2.0 * radius, 0.6 * height, "taper", 0.03)
        return
    steps = 1 if kind in ("clay", "cylinder") else 3
    yield vessel(slot, [(r * radius, h * height) for r, h in shapes[kind]], 0.07 * radius, sides=22, steps=steps)
    yield cylinder("soil", 0.8 * radius * min(1.0, shapes[kind][-1][0]), 0.01, (0.0, 0.86 * height, 0.0), sides=18)


def rosette(
    kind: str = "clay",
    count: int = 26,
    long: float = 0.5,
    wide: float = 0.07,
    radius: float = 0.14,
    rise: float = 1.3,
    droop: float = 1.4,
) -> Iterator[Solid]:
    """Leaves that spring from the soil in a spiral: ferns, grasses, lilies."""
    high = 1.7 * radius
    yield from pot(kind, radius, high)
    for i in range(count):
        share = i / count
        yield leaf(
            "leaf",
            long * (0.6 + 0.4 * share),
            wide,
            (0.0, 0.85 * high, 0.0),
            GOLDEN * i,
            rise - 0.7 * (1 - share) + 0.1,
            droop * (0.7 + 0.5 * (1 - share)),
            pieces=5,
        )


def snake(kind: str = "square", count: int = 12) -> Iterator[Solid]:
    """Stiff upright blades."""
    yield from pot(kind, 0.14, 0.26)
    for i in range(count):
        a, r = GOLDEN * i, 0.018 * np.sqrt(i)
        yield leaf("leaf", 0.5 + 0.04 * (i % 4) * 2, 0.065, (r * np.cos(a), 0.22, r * np.sin(a)), a, 1.5, 0.12, 0.7, 5)


def tree(
    kind: str = "basket", height: float = 1.6, leaves: int = 60, size: float = 0.22, stems: int = 1
) -> Iterator[Solid]:
    """A trunk with a crown of leaves: figs, rubber trees."""
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
                GOLDEN * i + k,
                0.55,
                0.9,
                1.1,
                4,
            )


def palm(kind: str = "round", fronds: int = 11, height: float = 0.9) -> Iterator[Solid]:
    """Feathered fronds on a ringed trunk."""
    yield from pot(kind, 0.2, 0.34)
    rings = [
        (0.045 - 0.012 * t + 0.006 * (i % 2), 0.28 + (height - 0.28) * t) for i, t in enumerate(np.linspace(0, 1, 15))
    ]
    yield turned("bark", rings, sides=10, steps=1)
    for i in range(fronds):
        yaw, long, up = GOLDEN * i, 0.75, 1.15 - 0.06 * (i % 5)
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
    """Broad notched leaves on long stalks."""
    yield from pot(kind, 0.17, 0.3)
    angle = np.linspace(0, 2 * np.pi, 29)[:-1]
    notch = 1 - 0.34 * (np.cos(9 * angle) > 0.72) * (np.abs(np.sin(angle)) > 0.3)
    outline = np.stack([0.62 * np.cos(angle) * notch, np.sin(angle) * notch * (1 - 0.25 * (np.sin(angle) < -0.9))], -1)
    for i in range(count):
        yaw, high = GOLDEN * i, 0.5 + 0.035 * i
        x, z = 0.3 * np.sin(yaw) * (1 - 0.02 * i), 0.3 * np.cos(yaw) * (1 - 0.02 * i)
        yield tube("leaf", spline([(0.0, 0.25, 0.0), (0.4 * x, 0.8 * high, 0.4 * z), (x, high + 0.1, z)], 3), 0.007, 5)
        size = 0.17 - 0.004 * i
        blade = prism("leaf", outline * size, 0.003, (0.0, size, 0.0))
        yield move(rotate(rotate(blade, 0, 1.05), 1, yaw), (x, high + 0.1, z))


def cactus(kind: str = "clay", arms: int = 2) -> Iterator[Solid]:
    """A ribbed column with arms and a flower, or a ball."""
    yield from pot(kind, 0.09, 0.14)
    angle = 2 * np.pi * np.arange(24) / 24
    section = np.stack([np.cos(angle), np.sin(angle)], -1) * (1 + 0.13 * (np.arange(24) % 2 * 2 - 1))[:, None]
    if arms:
        yield sweep(
            "leaf",
            [(0.0, y, 0.0) for y in (0.11, 0.2, 0.4, 0.5, 0.54, 0.56)],
            section * 0.055,
            [0.9, 1.0, 1.0, 0.85, 0.5, 0.12],
        )
        for s in (-1, 1)[:arms]:
            path = spline(
                [
                    (s * 0.03, 0.24 + 0.04 * s, 0.0),
                    (s * 0.11, 0.26 + 0.04 * s, 0.0),
                    (s * 0.13, 0.36, 0.0),
                    (s * 0.13, 0.43, 0.0),
                ],
                3,
            )
            yield tube("leaf", path, [0.03] * (len(path) - 2) + [0.024, 0.008], 10)
    else:
        yield sweep(
            "leaf", [(0.0, y, 0.0) for y in (0.11, 0.14, 0.19, 0.23, 0.25)], section * 0.09, [0.6, 0.95, 1.0, 0.6, 0.1]
        )
    for i in range(6):
        yield leaf("petal", 0.035, 0.02, (0.0, 0.555 if arms else 0.245, 0.0), i * np.pi / 3, 1.0, 0.8, pieces=2)


def succulents() -> Iterator[Solid]:
    """Three rosettes in a long trough."""
    yield rounded("concrete", (0.34, 0.09, 0.12), (0.0, 0.0, 0.0), 0.012, 2)
    yield box("soil", (0.3, 0.006, 0.09), (0.0, 0.088, 0.0))
    for k in range(3):
        for i in range(18):
            yield leaf(
                f"leaf_{k}",
                0.06 - 0.0018 * i,
                0.024,
                ((k - 1) * 0.1, 0.09 + 0.001 * i, 0.0),
                GOLDEN * i,
                0.3 + 0.065 * i,
                0.3,
                1.4,
                2,
            )


def hanging(kind: str = "round") -> Iterator[Solid]:
    """Trailing vines in a pot on cords, for a ceiling."""
    for piece in pot(kind, 0.14, 0.2):
        yield move(piece, (0.0, 0.62, 0.0))
    for i in range(4):
        a = 2 * np.pi * i / 4
        yield rod("cream", (0.13 * np.cos(a), 0.78, 0.13 * np.sin(a)), (0.0, 1.3, 0.0), 0.004, sides=5)
    for i in range(9):
        a = GOLDEN * i
        c, s = np.cos(a), np.sin(a)
        drop = 0.62 - 0.06 * (i % 5)
        path = spline(
            [
                (0.08 * c, 0.8, 0.08 * s),
                (0.17 * c, 0.82, 0.17 * s),
                (0.2 * c, 0.6, 0.2 * s),
                (0.19 * c, 0.8 - drop, 0.19 * s),
            ],
            3,
        )
        yield tube("leaf", path, 0.004, 4)
        for k, at in enumerate(path[1:]):
            yield leaf(
                "leaf", 0.075, 0.05, (float(at[0]), float(at[1]), float(at[2])), a + 1.4 * (-1) ** k, 0.1, 1.3, 0.8, 2
            )


def trailing(kind: str = "cylinder") -> Iterator[Solid]:
    """Vines that hang over the rim of a pot on a shelf or a stand."""
    yield turned("wood", [(0.14, 0.0), (0.03, 0.03), (0.025, 0.5), (0.13, 0.53), (0.13, 0.55)], sides=18, steps=1)
    for piece in pot(kind, 0.12, 0.18):
        yield move(piece, (0.0, 0.55, 0.0))
    for i in range(10):
        a = GOLDEN * i
        c, s = np.cos(a), np.sin(a)
        path = spline(
            [
                (0.06 * c, 0.7, 0.06 * s),
                (0.15 * c, 0.76, 0.15 * s),
                (0.19 * c, 0.55, 0.19 * s),
                (0.19 * c, 0.25 + 0.04 * (i % 4), 0.19 * s),
            ],
            3,
        )
        for k, at in enumerate(path):
            yield leaf(
                "leaf", 0.09, 0.055, (float(at[0]), float(at[1]), float(at[2])), a + 1.2 * (-1) ** k, 0.2, 1.2, 0.8, 2
            )


def orchid(kind: str = "cylinder", stems: int = 2) -> Iterator[Solid]:
    """Bent stems with flowers above broad leaves."""
    yield from pot(kind, 0.07, 0.12)
    for i in range(6):
        yield leaf("leaf", 0.2, 0.06, (0.0, 0.1, 0.0), GOLDEN * i, 0.6, 1.0, 1.2, 4)
    for k in range(stems):
        s = (-1) ** k
        path = spline([(0.0, 0.1, 0.0), (0.02 * s, 0.36, 0.02), (0.08 * s, 0.48, 0.05), (0.2 * s, 0.46, 0.1)], 4)
        yield tube("leaf", path, 0.004, 5)
        for j in range(5):
            at = path[-1 - j]
            for p in range(5):
                yield leaf(
                    "petal",
                    0.035,
                    0.028,
                    (float(at[0]), float(at[1]), float(at[2]) + 0.004),
                    2 * np.pi * p / 5,
                    0.25,
                    0.2,
                    1.1,
                    2,
                )
            yield ball("yellow", 0.007, (float(at[0]), float(at[1]) + 0.008, float(at[2]) + 0.004), 8, 4)


def flowers(kind: str = "round", count: int = 14) -> Iterator[Solid]:
    """A bush of flowers in a pot."""
    yield from pot(kind, 0.11, 0.17)
    for i in range(count):
        a, r = GOLDEN * i, 0.035 * np.sqrt(i)
        x, z, y = r * np.cos(a), r * np.sin(a), 0.34 - 0.5 * r
        yield rod("leaf", (0.3 * x, 0.14, 0.3 * z), (x, y, z), 0.003, sides=4)
        yield leaf("leaf", 0.11, 0.05, (0.4 * x, 0.18, 0.4 * z), a + 0.7, 0.8, 0.9, pieces=3)
        for p in range(6):
            yield leaf("petal", 0.038, 0.024, (x, y, z), 2 * np.pi * p / 6, 0.5, 0.4, 1.2, 2)
        yield ball("yellow", 0.01, (x, y + 0.008, z), 8, 4)


def topiary(kind: str = "square", balls: int = 2) -> Iterator[Solid]:
    """Clipped balls of small leaves on a stem."""
    yield from pot(kind, 0.16, 0.3)
    yield rod("bark", (0.0, 0.25, 0.0), (0.0, 0.6 + 0.36 * balls, 0.0), 0.018)
    for k in range(balls):
        radius, y = 0.2 - 0.045 * k, 0.62 + 0.38 * k
        yield ball("leaf_1", 0.93 * radius, (0.0, y, 0.0), 14, 9)
        for i in range(90 - 25 * k):
            t = 1 - 2 * (i + 0.5) / (90 - 25 * k)
            r = np.sqrt(1 - t * t)
            a = GOLDEN * i
            yield leaf(
                "leaf",
                0.07,
                0.045,
                (0.88 * radius * r * np.sin(a), y + 0.88 * radius * t, 0.88 * radius * r * np.cos(a)),
                a,
                float(np.arcsin(t)),
                0.3,
                pieces=2,
            )


def bamboo(kind: str = "cylinder") -> Iterator[Solid]:
    """Canes with joints in a pot of stones."""
    yield from pot(kind, 0.14, 0.3)
    for i in range(7):
        a, r = GOLDEN * i, 0.03 * np.sqrt(i)
        x, z, top = r * np.cos(a), r * np.sin(a), 1.5 - 0.12 * i
        yield rod("leaf_1", (x, 0.26, z), (1.5 * x, top, 1.5 * z), 0.012, 0.009)
        for k in range(4):
            y = 0.45 + 0.25 * k
            if y < top:
                yield cylinder(
                    "leaf_1",
                    0.015,
                    0.012,
                    (x * (1 + 0.5 * (y - 0.26) / (top - 0.26)), y, z * (1 + 0.5 * (y - 0.26) / (top - 0.26))),
                    sides=8,
                )
        for k in range(7):
            y = top - 0.09 * k
            yield leaf("leaf", 0.24, 0.035, (1.5 * x, y, 1.5 * z), GOLDEN * (i + 5 * k), 0.5, 1.0, 0.8, 3)


def herbs() -> Iterator[Solid]:
    """Three small pots of herbs on a tray."""
    yield rounded("wood", (0.42, 0.02, 0.15), (0.0, 0.0, 0.0), 0.006, 1)
    for k in range(3):
        x = (k - 1) * 0.13
        yield turned("terracotta", [(0.04, 0.02), (0.052, 0.1), (0.058, 0.1), (0.058, 0.115)], (x, 0.0, 0.0), 16, 1)
        for i in range(16):
            a, r = GOLDEN * i, 0.011 * np.sqrt(i)
            wide = (0.012, 0.035, 0.02)[k]
            yield leaf("leaf", 0.11 - 0.01 * k, wide, (x + r * np.cos(a), 0.11, r * np.sin(a)), a, 1.2, 0.8, pieces=3)


def bonsai() -> Iterator[Solid]:
    """A small bent tree with flat clouds of leaves in a dish."""
    yield rounded("glaze", (0.3, 0.06, 0.2), (0.0, 0.0, 0.0), 0.015, 2)
    yield rounded("soil", (0.26, 0.02, 0.16), (0.0, 0.05, 0.0), 0.01, 2)
    yield tube(
        "bark",
        spline([(-0.04, 0.06, 0.0), (0.02, 0.13, 0.0), (-0.04, 0.2, 0.02), (0.05, 0.28, 0.0)], 4),
        np.linspace(0.024, 0.008, 13),
        8,
    )
    for x, y, z, r in ((0.05, 0.31, 0.0, 0.085), (-0.11, 0.23, 0.02, 0.065), (0.12, 0.2, -0.02, 0.055)):
        yield rod("bark", (0.0, y - 0.05, 0.0), (x, y, z), 0.007)
        yield ball("leaf_1", (r, 0.4 * r, 0.8 * r), (x, y, z), 12, 6)
        for i in range(30):
            a, d = GOLDEN * i, r * np.sqrt(i / 30)
            yield leaf(
                "leaf",
                0.03,
                0.02,
                (x + d * np.cos(a), y + 0.35 * r * (1 - i / 40), z + 0.8 * d * np.sin(a)),
                a,
                0.7,
                0.4,
                pieces=2,
            )


PLANTS = (
    design(rosette), design(snake), design(tree), design(palm), design(monstera), design(topiary), design(bamboo),
    design(trailing), design(tree, kind="square", height=1.3, leaves=48, size=0.28, stems=3),
    design(rosette, kind="stand", count=34, long=0.6, wide=0.03, rise=1.4, droop=2.0),
    design(rosette, kind="urn", count=16, long=0.75, wide=0.14, radius=0.18, droop=1.0),
    design(palm, kind="basket", fronds=9, height=0.5),
)  # fmt: skip
SMALL = (
    design(cactus), design(succulents), design(orchid), design(flowers), design(herbs), design(bonsai),
    design(cactus, arms=0, kind="round"), design(rosette, kind="round", count=18, long=0.22, wide=0.05, radius=0.07),
    design(snake, count=7, kind="clay"), design(flowers, kind="clay", count=9),
)  # fmt: skip

FAMILIES = (
    Family("plant", "plant", PLANTS),
    Family("small_plant", "plant", SMALL),
    Family("hanging_plant", "plant", (design(hanging), design(hanging, kind="basket"))),
)
