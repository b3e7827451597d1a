"""Toys, small and large."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, padded_block, rounded_box
from home_procgen.shapes.sheets import surface
from home_procgen.shapes.sweep import prism, rod, tube
from home_procgen.things.family import FurnitureFamily, design, design_kinds
from home_procgen.things.toys.balls import ball_pit
from home_procgen.things.toys.baskets import basket
from home_procgen.things.toys.playthings import blocks, teddy, toy_car, train


def rocking_horse() -> Iterator[Solid]:
    """Build a rocking horse."""
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
    yield padded_block("bright", (0.2, 0.06, 0.24), (0.0, 0.53, -0.02), 4.0, 5)
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
    """Build a two-storey doll's house with an open front."""
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
    yield rounded_box("bright_2", (0.12, 0.05, 0.16), (0.22, 0.258, 0.0), 0.01, 1)
    yield rounded_box("bright_3", (0.14, 0.06, 0.07), (-0.2, 0.018, -0.05), 0.015, 2)
    yield cylinder("wood", 0.05, 0.06, (0.2, 0.018, 0.02), sides=16)


def play_tent() -> Iterator[Solid]:
    """Build a pointed cloth tent on poles."""
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
    yield rounded_box("textile", (0.9, 0.05, 0.9), (0.0, 0.0, 0.0), 0.02, 2)


def chess() -> Iterator[Solid]:
    """Build a chessboard with pieces."""
    yield rounded_box("wood", (0.44, 0.025, 0.44), (0.0, 0.0, 0.0), 0.006, 1)
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
                yield revolve(
                    slot,
                    [(0.017, 0.0), (0.008, 0.012), (0.006, 0.6 * high), (0.012, 0.75 * high), (0.004, high)],
                    at,
                    7,
                    1,
                )


def board_game(kind: str = "draughts") -> Iterator[Solid]:
    """Build a game of draughts, or one with a track, counters and a die."""
    yield rounded_box("wood", (0.4, 0.02, 0.4), (0.0, 0.0, 0.0), 0.006, 1)
    if kind == "draughts":
        for i in range(8):
            for j in range(8):
                if (i + j) % 2 == 0:
                    yield box("cream", (0.044, 0.002, 0.044), ((i - 3.5) * 0.045, 0.0195, (j - 3.5) * 0.045))
                elif j in (0, 1, 6, 7) and (i * 5 + j) % 7:
                    at = ((i - 3.5) * 0.045, 0.02, (j - 3.5) * 0.045)
                    yield cylinder("white" if j < 2 else "red", 0.017, 0.009, at, sides=14)
        return
    yield box("cream", (0.37, 0.002, 0.37), (0.0, 0.0195, 0.0))
    for k in range(24):
        a = 2 * np.pi * k / 24
        at = (0.15 * np.cos(a), 0.0212, 0.15 * np.sin(a))
        yield cylinder(("red", "blue", "green", "yellow")[k % 4], 0.014, 0.001, at, sides=12)
        if k % 5 == 0:
            slot = ("red", "blue", "green", "yellow")[k // 5 % 4]
            yield revolve(
                slot, [(0.011, 0.0), (0.006, 0.014), (0.007, 0.02), (0.002, 0.028)], (at[0], 0.022, at[2]), 12, 2
            )
    yield rounded_box("white", (0.016, 0.016, 0.016), (0.04, 0.0215, 0.02), 0.003, 2)


SMALL_TOYS = (
    design(teddy), design(blocks), design(train), *design_kinds(toy_car, "car", "lorry", "fire"),
    *design_kinds(ball_pit, "ball", "rings", "xylophone", "robot"), design(teddy, slot="white", ears="long"),
)  # fmt: skip

LARGE_TOYS = (
    design(rocking_horse),
    design(doll_house),
    design(play_tent),
    *design_kinds(ball_pit, "playpen"),
    *design_kinds(basket, "chest"),
)


FAMILIES = (
    FurnitureFamily("toy", "toy", SMALL_TOYS),
    FurnitureFamily("large_toy", "toy", LARGE_TOYS),
    FurnitureFamily("chessboard", "chessboard", (design(chess), *design_kinds(board_game, "draughts", "track"))),
)
