"""Toys, pets, fish, bins, baskets, umbrellas and other things that stand about."""

from collections.abc import Callable, Iterator

import numpy as np

from home_mjx.datasets.homes.shapes.curves import fillet, spline, star
from home_mjx.datasets.homes.shapes.sheets import leaf, surface
from home_mjx.datasets.homes.shapes.soft import ball, rounded, soft
from home_mjx.datasets.homes.shapes.swept import beam, prism, ring, rod, tube
from home_mjx.datasets.homes.shapes.turned import turned, vessel
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.joinery import disc
from home_mjx.datasets.procedural.primitives.solids import Solid, box, cylinder, move, rotate


def teddy(slot: str = "fur_coat", ears: str = "round") -> Iterator[Solid]:
    """A sitting bear or rabbit."""
    yield ball(slot, (0.11, 0.12, 0.1), (0.0, 0.12, 0.0), 18, 10)
    yield ball("cream", (0.07, 0.08, 0.03), (0.0, 0.12, 0.08), 14, 8)
    yield ball(slot, 0.085, (0.0, 0.29, 0.02), 18, 10)
    yield ball("cream", (0.04, 0.032, 0.03), (0.0, 0.27, 0.095), 12, 8)
    yield ball("black", 0.012, (0.0, 0.285, 0.122), 8, 6)
    for s in (-1, 1):
        yield ball("black", 0.01, (s * 0.032, 0.315, 0.093), 8, 6)
        yield tube(
            slot, [(s * 0.09, 0.2, 0.0), (s * 0.14, 0.13, 0.06), (s * 0.13, 0.1, 0.09)], [0.035, 0.034, 0.036], 10
        )
        yield tube(
            slot, [(s * 0.06, 0.05, 0.04), (s * 0.1, 0.04, 0.13), (s * 0.11, 0.045, 0.18)], [0.05, 0.045, 0.042], 10
        )
        yield ball("cream", (0.026, 0.03, 0.01), (s * 0.112, 0.05, 0.215), 10, 6)
        if ears == "round":
            yield ball(slot, (0.034, 0.034, 0.018), (s * 0.065, 0.36, 0.01), 12, 8)
        else:
            yield ball(slot, (0.022, 0.09, 0.014), (s * 0.04, 0.42, 0.0), 12, 8)


def blocks() -> Iterator[Solid]:
    """A tower of building blocks and some beside it."""
    for i, (x, y, z, turn) in enumerate(
        (
            (0.0, 0.0, 0.0, 0.1),
            (0.075, 0.0, 0.01, -0.2),
            (0.035, 0.07, 0.0, 0.3),
            (0.03, 0.14, 0.005, 0.0),
            (-0.12, 0.0, 0.09, 0.7),
            (0.16, 0.0, 0.1, 0.4),
        )
    ):
        yield rotate(rounded(f"bright_{i % 4}", (0.07, 0.07, 0.07), (x, y, z), 0.006, 1), 1, turn, (x, 0.0, z))
    yield prism("bright_2", [(-0.01, 0.21), (0.07, 0.21), (0.03, 0.26)], 0.06)
    yield cylinder("bright_1", 0.03, 0.08, (-0.04, 0.0, 0.14), sides=16)


def train() -> Iterator[Solid]:
    """A wooden train of three cars."""
    for k in range(3):
        z = -0.17 * k
        yield rounded(f"bright_{k}", (0.07, 0.025, 0.14), (0.0, 0.03, z), 0.008, 1)
        for s in (-1, 1):
            for dz in (-0.045, 0.045):
                wheel = rotate(cylinder("wood", 0.024, 0.014, (0.0, -0.007, 0.0), sides=14), 2, np.pi / 2)
                yield move(wheel, (s * 0.04, 0.024, z + dz))
        if k:
            yield (
                rounded("wood", (0.06, 0.035, 0.11), (0.0, 0.055, z), 0.006, 1)
                if k == 1
                else cylinder("wood", 0.03, 0.05, (0.0, 0.055, z), sides=16)
            )
            yield rod("black", (0.0, 0.04, z + 0.06), (0.0, 0.04, z + 0.11), 0.005, sides=6)
    yield tube("bright", [(0.0, 0.085, -0.01), (0.0, 0.085, 0.065)], 0.03, 16)
    yield rounded("bright_1", (0.07, 0.08, 0.045), (0.0, 0.055, -0.045), 0.008, 1)
    yield turned("black", [(0.01, 0.0), (0.01, 0.03), (0.018, 0.05)], (0.0, 0.11, 0.045), 12, 1)


def toy_car(kind: str = "car") -> Iterator[Solid]:
    """A car, a lorry or a fire engine."""
    if kind == "car":
        side = fillet(
            [
                (-0.12, 0.03),
                (0.12, 0.03),
                (0.12, 0.07),
                (0.07, 0.075),
                (0.03, 0.12),
                (-0.06, 0.12),
                (-0.1, 0.075),
                (-0.12, 0.07),
            ],
            0.02,
            3,
            True,
        )
        yield prism("bright", side, 0.1, (0.0, 0.0, 0.0), "side")
        yield prism(
            "screen",
            fillet([(0.055, 0.078), (0.025, 0.112), (-0.055, 0.112), (-0.085, 0.078)], 0.012, 2, True),
            0.102,
            (0.0, 0.0, 0.0),
            "side",
        )
    else:
        yield rounded("bright", (0.12, 0.1, 0.09), (0.0, 0.04, 0.1), 0.015, 2)
        yield box("screen", (0.1, 0.035, 0.006), (0.0, 0.09, 0.144))
        yield rounded("black", (0.1, 0.025, 0.3), (0.0, 0.03, -0.02), 0.005, 1)
        yield rounded("bright_1", (0.13, 0.09, 0.2), (0.0, 0.055, -0.06), 0.008, 1)
        if kind == "fire":
            for s in (-1, 1):
                yield rod("white", (s * 0.03, 0.16, -0.16), (s * 0.03, 0.18, 0.1), 0.006, sides=6)
            for i in range(7):
                yield rod(
                    "white",
                    (-0.03, 0.161 + 0.003 * i, -0.15 + 0.038 * i),
                    (0.03, 0.161 + 0.003 * i, -0.15 + 0.038 * i),
                    0.004,
                    sides=6,
                )
    for z in (-0.07, 0.075):
        for s in (-1, 1):
            wheel = rotate(cylinder("rubber", 0.032, 0.022, (0.0, -0.011, 0.0), sides=16), 2, np.pi / 2)
            yield move(wheel, (s * 0.055, 0.032, z))
            hub = rotate(cylinder("white", 0.014, 0.026, (0.0, -0.013, 0.0), sides=12), 2, np.pi / 2)
            yield move(hub, (s * 0.055, 0.032, z))


def rocking_horse() -> Iterator[Solid]:
    """A horse on rockers."""
    for s in (-1, 1):
        x = s * 0.13
        yield tube("wood", [(x, 0.02 + 0.22 * z * z, z) for z in np.linspace(-0.5, 0.5, 11)], 0.018, 8)
        for z in (-0.2, 0.2):
            yield rod("wood", (x, 0.04, 1.3 * z), (0.6 * x, 0.42, z), 0.02, 0.026)
    for z in (-0.25, 0.25):
        yield rod("wood", (-0.13, 0.04, z), (0.13, 0.04, z), 0.013)
    yield ball("wood", (0.11, 0.11, 0.28), (0.0, 0.46, 0.0), 18, 10)
    yield tube("wood", [(0.0, 0.5, 0.2), (0.0, 0.72, 0.32), (0.0, 0.76, 0.36)], [0.09, 0.06, 0.05], 12)
    yield tube("wood", [(0.0, 0.77, 0.32), (0.0, 0.66, 0.5)], [0.06, 0.035], 12)
    yield soft("bright", (0.2, 0.06, 0.24), (0.0, 0.53, -0.02), 4.0, 5)
    yield rod("wood", (-0.14, 0.7, 0.32), (0.14, 0.7, 0.32), 0.013)
    yield prism(
        "cream",
        fillet([(0.28, 0.82), (0.12, 0.6), (0.08, 0.6), (0.24, 0.84)], 0.03, 2, True),
        0.03,
        (0.0, 0.0, 0.0),
        "side",
    )
    yield tube("cream", [(0.0, 0.5, -0.27), (0.0, 0.42, -0.36), (0.0, 0.26, -0.38)], [0.02, 0.035, 0.01], 8)


def doll_house() -> Iterator[Solid]:
    """A house of two storeys with an open front."""
    for s in (-1, 1):
        yield box("white", (0.02, 0.5, 0.28), (s * 0.34, 0.0, 0.0))
        yield prism("red", [(0.0, 0.74), (s * 0.4, 0.49), (s * 0.4, 0.465), (0.0, 0.715)], 0.34)
    for y in (0.0, 0.24, 0.48):
        yield box("wood", (0.68, 0.018, 0.28), (0.0, y, 0.0))
    yield box("bright", (0.66, 0.5, 0.012), (0.0, 0.0, -0.135))
    yield box("white", (0.014, 0.22, 0.26), (0.06, 0.018, 0.0))
    yield box("white", (0.014, 0.22, 0.26), (-0.1, 0.258, 0.0))
    for x, y in ((-0.2, 0.1), (0.2, 0.1), (-0.22, 0.34), (0.12, 0.34)):
        yield box("blue", (0.08, 0.09, 0.006), (x, y, -0.127))
    yield rounded("bright_2", (0.12, 0.05, 0.16), (0.22, 0.258, 0.0), 0.01, 1)
    yield rounded("bright_3", (0.14, 0.06, 0.07), (-0.2, 0.018, -0.05), 0.015, 2)
    yield cylinder("wood", 0.05, 0.06, (0.2, 0.018, 0.02), sides=16)


def play_tent() -> Iterator[Solid]:
    """A pointed tent of cloth on poles."""
    for a in np.arange(4) * np.pi / 2 + np.pi / 4:
        yield rod("wood", (0.75 * np.cos(a), 0.0, 0.75 * np.sin(a)), (-0.06 * np.cos(a), 1.6, -0.06 * np.sin(a)), 0.014)
    for k in range(4):
        a, b = np.pi / 4 + k * np.pi / 2, np.pi / 4 + (k + 1) * np.pi / 2
        half = 0.36 if k == 0 else 1.0

        def wall(
            u: np.ndarray, v: np.ndarray, a: float = a, b: float = b, half: float = half
        ) -> tuple[np.ndarray, ...]:
            r, t = 0.72 * (1 - 0.93 * v), u * half * (1 - v) + u * v
            return r * ((1 - t) * np.cos(a) + t * np.cos(b)), 0.03 + 1.42 * v, r * ((1 - t) * np.sin(a) + t * np.sin(b))

        yield surface("patterned", wall, 6, 6, 0.008)
    yield rounded("textile", (0.9, 0.05, 0.9), (0.0, 0.0, 0.0), 0.02, 2)


def _ball() -> Iterator[Solid]:
    yield ball("bright", 0.11, (0.0, 0.11, 0.0), 24, 14)
    for a in range(3):
        yield ring("white", 0.1095, 0.006, (0.0, 0.11, 0.0), a, 30)


def _rings() -> Iterator[Solid]:
    yield turned("wood", [(0.09, 0.0), (0.09, 0.015), (0.02, 0.02)], sides=22, steps=1)
    yield rod("wood", (0.0, 0.01, 0.0), (0.0, 0.23, 0.0), 0.012)
    for i in range(5):
        yield ring(f"bright_{i}", 0.058 - 0.006 * i, 0.038, (0.0, 0.038 + 0.037 * i, 0.0), 1, 22)
    yield ball("bright", 0.022, (0.0, 0.235, 0.0), 12, 8)


def _xylophone() -> Iterator[Solid]:
    for s in (-1, 1):
        yield beam("wood", (-0.17, 0.02, s * 0.07), (0.17, 0.02, s * 0.035), 0.02, 0.03)
    for i in range(8):
        yield rounded(f"bright_{i % 6}", (0.034, 0.012, 0.2 - 0.013 * i), (-0.15 + 0.043 * i, 0.036, 0.0), 0.004, 1)
    yield rod("wood", (-0.1, 0.056, 0.05), (0.1, 0.056, -0.01), 0.004, sides=6)
    yield ball("bright_2", 0.014, (0.1, 0.06, -0.01), 10, 6)


def _robot() -> Iterator[Solid]:
    yield rounded("bright", (0.14, 0.15, 0.09), (0.0, 0.1, 0.0), 0.015, 2)
    yield rounded("gray", (0.11, 0.09, 0.08), (0.0, 0.265, 0.0), 0.015, 2)
    for s in (-1, 1):
        yield rounded("gray", (0.045, 0.1, 0.06), (s * 0.035, 0.01, 0.0), 0.008, 1)
        yield rounded("black", (0.055, 0.025, 0.09), (s * 0.037, 0.0, 0.01), 0.008, 1)
        yield tube("gray", [(s * 0.075, 0.22, 0.0), (s * 0.11, 0.19, 0.0), (s * 0.11, 0.11, 0.03)], 0.016, 8)
        yield disc("yellow", 0.016, 0.012, (s * 0.024, 0.315, 0.036), 14)
    yield rod("chrome", (0.0, 0.355, 0.0), (0.0, 0.4, 0.0), 0.003, sides=5)
    yield ball("red", 0.012, (0.0, 0.405, 0.0), 10, 6)
    for i in range(3):
        yield disc(f"bright_{i}", 0.012, 0.008, (-0.035 + 0.035 * i, 0.15, 0.043), 12)


def _playpen() -> Iterator[Solid]:
    for i in range(8):
        a, b = 2 * np.pi * i / 8, 2 * np.pi * (i + 1) / 8
        p, q = ((0.62 * np.cos(t), 0.0, 0.62 * np.sin(t)) for t in (a, b))
        yield rod("wood", p, (p[0], 0.62, p[2]), 0.018)
        yield beam("wood", (p[0], 0.6, p[2]), (q[0], 0.6, q[2]), 0.03)
        yield beam("wood", (p[0], 0.05, p[2]), (q[0], 0.05, q[2]), 0.03)
        for k in range(1, 5):
            t = k / 5
            x, z = p[0] * (1 - t) + q[0] * t, p[2] * (1 - t) + q[2] * t
            yield rod("wood", (x, 0.06, z), (x, 0.59, z), 0.007, sides=6)
    yield cylinder("textile", 0.56, 0.04, sides=8)
    for i in range(16):
        r = 0.11 * np.sqrt(i)
        yield ball(f"bright_{i % 5}", 0.045, (r * np.cos(2.4 * i), 0.085, r * np.sin(2.4 * i)), 10, 6)


_BALL_PIT_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "ball": _ball,
    "rings": _rings,
    "xylophone": _xylophone,
    "robot": _robot,
    "playpen": _playpen,
}


def ball_pit(kind: str = "ball") -> Iterator[Solid]:
    """A ball, stacking rings, a xylophone, a robot, a kite, a playpen full of balls."""
    yield from _BALL_PIT_KINDS[kind]()


def chess() -> Iterator[Solid]:
    """A chessboard with men."""
    yield rounded("wood", (0.44, 0.025, 0.44), (0.0, 0.0, 0.0), 0.006, 1)
    for i in range(8):
        for j in range(8):
            if (i + j) % 2 == 0:
                yield box("cream", (0.048, 0.002, 0.048), ((i - 3.5) * 0.048, 0.0245, (j - 3.5) * 0.048))
    for side, slot in ((1, "white"), (-1, "black")):
        for i in range(8):
            for row, high in ((3.5, 0.07 + 0.02 * (i in (3, 4))), (2.5, 0.045)):
                if (i * 7 + int(row) * 3) % 5 == 0:
                    continue
                at = ((i - 3.5) * 0.048, 0.025, side * row * 0.048)
                yield turned(
                    slot,
                    [(0.017, 0.0), (0.008, 0.012), (0.006, 0.6 * high), (0.012, 0.75 * high), (0.004, high)],
                    at,
                    7,
                    1,
                )


def _cat() -> Iterator[Solid]:
    yield turned("fur_coat", [(0.09, 0.0), (0.1, 0.06), (0.07, 0.17), (0.05, 0.23)], (0.0, 0.0, -0.02), 18, 3)
    yield ball("fur_coat", (0.055, 0.05, 0.055), (0.0, 0.28, 0.02), 16, 10)
    for s in (-1, 1):
        yield turned("fur_coat", [(0.02, 0.0), (0.002, 0.045)], (s * 0.03, 0.31, 0.01), 8, 1)
        yield tube(
            "fur_coat",
            [(s * 0.03, 0.16, 0.04), (s * 0.032, 0.02, 0.07), (s * 0.032, 0.015, 0.1)],
            [0.024, 0.018, 0.018],
            8,
        )
        yield ball("green", 0.009, (s * 0.022, 0.29, 0.066), 8, 6)
    yield ball("red", 0.007, (0.0, 0.272, 0.075), 8, 4)
    yield tube(
        "fur_coat",
        spline([(0.05, 0.02, -0.08), (0.14, 0.02, -0.06), (0.15, 0.03, 0.06)], 5),
        np.linspace(0.018, 0.01, 11),
        8,
    )


def _dog() -> Iterator[Solid]:
    yield tube(
        "fur_coat",
        [(0.0, 0.33, -0.24), (0.0, 0.34, -0.18), (0.0, 0.34, 0.14), (0.0, 0.36, 0.22)],
        [0.06, 0.095, 0.1, 0.08],
        14,
    )
    for x in (-0.055, 0.055):
        for z in (-0.19, 0.15):
            yield tube(
                "fur_coat",
                [(x, 0.3, z), (x, 0.12, z - 0.01), (x, 0.02, z), (x, 0.015, z + 0.035)],
                [0.045, 0.026, 0.024, 0.024],
                8,
            )
    yield tube("fur_coat", [(0.0, 0.38, 0.2), (0.0, 0.48, 0.28)], [0.065, 0.055], 12)
    yield ball("fur_coat", (0.065, 0.062, 0.075), (0.0, 0.5, 0.3), 16, 10)
    yield tube("fur_coat", [(0.0, 0.485, 0.34), (0.0, 0.47, 0.42)], [0.042, 0.03], 12)
    yield ball("black", 0.016, (0.0, 0.485, 0.445), 10, 6)
    for s in (-1, 1):
        yield ball("fur_coat", (0.014, 0.06, 0.032), (s * 0.068, 0.49, 0.28), 12, 8)
        yield ball("black", 0.009, (s * 0.03, 0.525, 0.362), 8, 6)
    yield tube(
        "fur_coat",
        spline([(0.0, 0.37, -0.24), (0.0, 0.48, -0.34), (0.0, 0.56, -0.33)], 4),
        np.linspace(0.024, 0.01, 9),
        8,
    )
    yield ring("red", 0.062, 0.014, (0.0, 0.435, 0.245), 1, 18)


def _dog_basket() -> Iterator[Solid]:
    yield vessel("cane", [(0.28, 0.0), (0.33, 0.06), (0.35, 0.16)], 0.03, sides=30, steps=2, stretch=0.8)
    yield soft("textile", (0.56, 0.1, 0.44), (0.0, 0.03, 0.0), 2.5, 6)
    curl = [(0.16 * np.cos(a), 0.15, 0.12 * np.sin(a)) for a in np.linspace(0.6, 5.2, 12)]
    yield tube("fur_coat", curl, np.concatenate([np.linspace(0.03, 0.075, 8), [0.07, 0.06, 0.05, 0.03]]), 10)
    yield ball("fur_coat", (0.06, 0.05, 0.065), (0.13, 0.17, 0.06), 14, 8)
    for s in (-1, 1):
        yield ball("fur_coat", (0.02, 0.04, 0.03), (0.13 + 0.05 * s, 0.18, 0.05), 10, 6)


def _cage() -> Iterator[Solid]:
    yield cylinder("gold", 0.17, 0.03, sides=26)
    for i in range(22):
        a = 2 * np.pi * i / 22
        c, s = 0.16 * np.cos(a), 0.16 * np.sin(a)
        yield tube("gold", [(c, 0.02, s), (c, 0.3, s), (0.6 * c, 0.4, 0.6 * s), (0.0, 0.44, 0.0)], 0.003, 4)
    yield ring("gold", 0.16, 0.008, (0.0, 0.3, 0.0), 1, 24)
    yield rod("wood", (-0.15, 0.16, 0.0), (0.15, 0.16, 0.0), 0.006, sides=6)
    yield ball("yellow", (0.026, 0.032, 0.042), (0.02, 0.2, 0.0), 12, 8)
    yield ball("yellow", 0.022, (0.02, 0.238, 0.02), 12, 8)
    yield ring("gold", 0.02, 0.006, (0.0, 0.46, 0.0), 2, 14)


_PET_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "cat": _cat,
    "dog": _dog,
    "basket": _dog_basket,
    "cage": _cage,
}


def pet(kind: str = "cat") -> Iterator[Solid]:
    """A sitting cat, a standing dog, a dog in its basket, a bird cage."""
    yield from _PET_KINDS[kind]()


def _one(x: float, y: float, z: float, slot: str, size: float = 1.0) -> Iterator[Solid]:
    yield ball(slot, (0.035 * size, 0.018 * size, 0.01 * size), (x, y, z), 12, 8)
    yield prism(
        slot,
        [(x - 0.03 * size, y), (x - 0.06 * size, y + 0.02 * size), (x - 0.06 * size, y - 0.02 * size)],
        0.003,
        (0.0, 0.0, z),
    )


def fish(kind: str = "tank") -> Iterator[Solid]:
    """A fish tank on a cabinet, or a bowl with a goldfish."""
    if kind == "bowl":
        yield vessel("glass", [(0.08, 0.0), (0.14, 0.08), (0.13, 0.16), (0.09, 0.2)], 0.003, sides=26, steps=3)
        yield turned("water", [(0.08, 0.006), (0.134, 0.08), (0.128, 0.15)], sides=24, steps=2)
        yield turned("cream", [(0.075, 0.006), (0.09, 0.02), (0.05, 0.03)], sides=20, steps=2)
        yield from _one(0.02, 0.09, 0.0, "orange", 1.2)
        for i in range(4):
            yield leaf("leaf", 0.1, 0.012, (-0.04, 0.02, 0.02), 1.6 * i, 1.4, 0.4, pieces=3)
        return
    yield rounded("wood", (1.0, 0.7, 0.4), (0.0, 0.02, 0.0), 0.006, 1)
    for i in range(2):
        yield rounded("wood_1", (0.48, 0.62, 0.02), ((i - 0.5) * 0.5, 0.06, 0.205), 0.004, 1)
        yield ball("chrome", 0.012, ((i - 0.5) * 0.1, 0.4, 0.225), 10, 6)
    yield box("cream", (0.96, 0.05, 0.36), (0.0, 0.725, 0.0))
    yield box("water", (0.95, 0.36, 0.35), (0.0, 0.776, 0.0))
    for s in (-1, 1):
        yield box("glass", (0.98, 0.46, 0.008), (0.0, 0.72, s * 0.186))
        yield box("glass", (0.008, 0.46, 0.364), (s * 0.486, 0.72, 0.0))
    yield rounded("black", (1.0, 0.05, 0.4), (0.0, 1.18, 0.0), 0.01, 1)
    for i in range(5):
        yield from _one(-0.3 + 0.15 * i, 0.86 + 0.06 * (i % 3), 0.08 * (-1) ** i, ("orange", "yellow", "blue")[i % 3])
    for k, x in enumerate((-0.36, -0.1, 0.3)):
        for i in range(5):
            yield leaf("leaf", 0.26, 0.02, (x, 0.77, -0.08), 1.3 * i + k, 1.45, 0.3, pieces=3)
    yield ball("gray", (0.09, 0.06, 0.07), (0.14, 0.79, -0.06), 12, 8)


def _pedal() -> Iterator[Solid]:
    yield turned("steel", [(0.15, 0.0), (0.15, 0.56)], sides=28, steps=1)
    yield turned("black", [(0.155, 0.0), (0.155, 0.03)], sides=28, steps=1)
    yield turned("steel", [(0.155, 0.56), (0.15, 0.6), (0.08, 0.64), (0.02, 0.645)], sides=28, steps=2)
    yield rounded("black", (0.07, 0.02, 0.06), (0.0, 0.01, 0.17), 0.006, 1)


def _wire() -> Iterator[Solid]:
    for y, r in ((0.005, 0.1), (0.15, 0.118), (0.3, 0.138)):
        yield ring("iron", r, 0.01, (0.0, y, 0.0), 1, 26)
    for i in range(26):
        a = 2 * np.pi * i / 26
        yield rod(
            "iron",
            (0.1 * np.cos(a), 0.0, 0.1 * np.sin(a)),
            (0.138 * np.cos(a), 0.3, 0.138 * np.sin(a)),
            0.002,
            sides=4,
        )
    yield cylinder("iron", 0.1, 0.006, sides=24)
    for i in range(4):
        yield ball("paper", 0.045, (0.045 * np.cos(2.4 * i), 0.05 + 0.04 * i, 0.045 * np.sin(2.4 * i)), 7, 5)


def _woven() -> Iterator[Solid]:
    yield vessel("cane", [(0.11, 0.0), (0.14, 0.16), (0.15, 0.32)], 0.01, sides=26, steps=2)
    yield ring("cane", 0.147, 0.018, (0.0, 0.32, 0.0), 1, 26)


def _swing() -> Iterator[Solid]:
    yield turned("plastic", [(0.13, 0.0), (0.16, 0.42)], sides=4, steps=1)
    yield prism(
        "plastic",
        fillet([(-0.12, 0.42), (0.12, 0.42), (0.1, 0.52), (0.0, 0.58), (-0.1, 0.52)], 0.04, 3, True),
        0.23,
        (0.0, 0.0, 0.0),
        "side",
    )
    yield rotate(rounded("gray", (0.17, 0.1, 0.012), (0.0, 0.44, 0.085), 0.005, 1), 0, -0.5, (0.0, 0.5, 0.08))


def _two() -> Iterator[Solid]:
    for s, slot in ((-1, "green"), (1, "blue")):
        yield rounded("gray", (0.24, 0.5, 0.34), (s * 0.125, 0.01, 0.0), 0.02, 2)
        yield rounded(slot, (0.235, 0.04, 0.34), (s * 0.125, 0.51, 0.0), 0.016, 2)
        yield box(slot, (0.1, 0.1, 0.004), (s * 0.125, 0.22, 0.17))


def _barrel() -> Iterator[Solid]:
    yield turned("plastic", [(0.16, 0.0), (0.19, 0.55), (0.2, 0.56)], sides=22, steps=1)
    yield turned("black", [(0.205, 0.56), (0.2, 0.6), (0.06, 0.64), (0.04, 0.66)], sides=22, steps=1)
    for s in (-1, 1):
        yield tube(
            "black",
            fillet(
                [(s * 0.19, 0.5, -0.05), (s * 0.24, 0.5, -0.04), (s * 0.24, 0.5, 0.04), (s * 0.19, 0.5, 0.05)], 0.02
            ),
            0.01,
            6,
        )


_BIN_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "pedal": _pedal,
    "wire": _wire,
    "woven": _woven,
    "swing": _swing,
    "two": _two,
    "barrel": _barrel,
}


def bin_(kind: str = "pedal") -> Iterator[Solid]:
    """A bin: with a pedal, of wire, woven, swinging, for paper, for two kinds, a tall barrel."""
    yield from _BIN_KINDS[kind]()


def _laundry() -> Iterator[Solid]:
    yield vessel("white", [(0.2, 0.0), (0.25, 0.28)], 0.008, sides=26, steps=1, stretch=0.75)
    for y in (0.08, 0.16, 0.24):
        for i in range(16):
            a = 2 * np.pi * i / 16
            r = 0.205 + 0.05 * y / 0.28
            yield ball("gray", (0.02, 0.012, 0.012), (r * np.cos(a), y, 0.75 * r * np.sin(a)), 6, 4)
    for i in range(5):
        yield ball(
            f"textile_{i}",
            (0.1, 0.06, 0.08),
            (0.09 * np.cos(2.4 * i), 0.26 + 0.012 * i, 0.07 * np.sin(2.4 * i)),
            10,
            6,
        )


def _hamper() -> Iterator[Solid]:
    yield vessel("cane", [(0.2, 0.0), (0.23, 0.3), (0.21, 0.6)], 0.012, sides=26, steps=2)
    yield turned("cane", [(0.225, 0.6), (0.22, 0.63), (0.08, 0.67), (0.02, 0.675)], sides=26, steps=2)
    yield tube(
        "leather",
        fillet([(-0.05, 0.66, 0.0), (-0.05, 0.71, 0.0), (0.05, 0.71, 0.0), (0.05, 0.66, 0.0)], 0.02),
        0.008,
        6,
    )


def _logs() -> Iterator[Solid]:
    yield tube(
        "iron", fillet([(-0.22, 0.4, 0.0), (-0.2, 0.03, 0.0), (0.2, 0.03, 0.0), (0.22, 0.4, 0.0)], 0.06), 0.012, 6
    )
    for z in (-0.12, 0.12):
        yield tube("iron", fillet([(-0.22, 0.4, z), (-0.2, 0.012, z), (0.2, 0.012, z), (0.22, 0.4, z)], 0.06), 0.012, 6)
    for row in range(3):
        for i in range(4 - row % 2):
            x = (i - (3 - row % 2) / 2) * 0.095
            yield rod("bark", (x, 0.085 + 0.085 * row, -0.2), (x, 0.085 + 0.085 * row, 0.2), 0.045, sides=9)
            yield rod("cream", (x, 0.085 + 0.085 * row, -0.202), (x, 0.085 + 0.085 * row, 0.202), 0.036, sides=9)


def _umbrellas() -> Iterator[Solid]:
    yield vessel("glaze", [(0.11, 0.0), (0.12, 0.05), (0.11, 0.45), (0.125, 0.5)], 0.008, sides=24, steps=2)
    for k, (x, z) in enumerate(((-0.04, 0.03), (0.05, 0.0), (0.0, -0.05))):
        yield tube(
            f"bright_{k}",
            [(0.3 * x, 0.03, 0.3 * z), (x, 0.3, z), (1.4 * x, 0.62, 1.4 * z)],
            [0.008, 0.035, 0.03],
            8,
        )
        yield tube(
            "wood",
            fillet(
                [
                    (1.4 * x, 0.6, 1.4 * z),
                    (1.7 * x, 0.84, 1.7 * z),
                    (1.7 * x + 0.07, 0.86, 1.7 * z),
                    (1.7 * x + 0.075, 0.78, 1.7 * z),
                ],
                0.04,
            ),
            0.009,
            8,
        )


def _chest() -> Iterator[Solid]:
    yield rounded("bright", (0.7, 0.36, 0.4), (0.0, 0.02, 0.0), 0.02, 2)
    yield rotate(rounded("bright_1", (0.72, 0.03, 0.42), (0.0, 0.37, 0.0), 0.012, 1), 0, -1.1, (0.0, 0.38, -0.2))
    for i in range(5):
        yield ball(f"bright_{i}", 0.075, (-0.24 + 0.12 * i, 0.4, 0.05 * (-1) ** i), 12, 8)
    yield ball("fur_coat", 0.08, (0.1, 0.44, -0.06), 14, 8)
    for i in range(2):
        yield prism("yellow", star(0.06, 0.025, 5), 0.01, (-0.18 + 0.36 * i, 0.2, 0.2))


_BASKET_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "laundry": _laundry,
    "hamper": _hamper,
    "logs": _logs,
    "umbrellas": _umbrellas,
    "chest": _chest,
}


def basket(kind: str = "laundry") -> Iterator[Solid]:
    """A laundry basket full of clothes, a log basket, a toy chest, an umbrella stand, a box of papers."""
    yield from _BASKET_KINDS[kind]()


def _of(build: object, *kinds: str) -> tuple:
    return tuple(design(build, kind=kind) for kind in kinds)  # type: ignore[arg-type]


SMALL_TOYS = (
    design(teddy), design(blocks), design(train), *_of(toy_car, "car", "lorry", "fire"),
    *_of(ball_pit, "ball", "rings", "xylophone", "robot"), design(teddy, slot="white", ears="long"),
)  # fmt: skip
LARGE_TOYS = (
    design(rocking_horse),
    design(doll_house),
    design(play_tent),
    *_of(ball_pit, "playpen"),
    *_of(basket, "chest"),
)

FAMILIES = (
    Family("toy", "toy", SMALL_TOYS),
    Family("large_toy", "toy", LARGE_TOYS),
    Family("chessboard", "chessboard", (design(chess),)),
    Family("pet", "pet", _of(pet, "cat", "dog", "basket")),
    Family("bird_cage", "pet", _of(pet, "cage")),
    Family("fish_tank", "fish_tank", _of(fish, "tank")),
    Family("fishbowl", "fishbowl", _of(fish, "bowl")),
    Family("trash_can", "trash_can", _of(bin_, "pedal", "wire", "woven", "swing", "two", "barrel")),
    Family("basket", "household_appliance", _of(basket, "laundry", "hamper", "logs", "umbrellas")),
)
