"""Office chairs."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, cylinder, move, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import padded_block, rounded_box
from home_procgen.shapes.sheets import surface
from home_procgen.shapes.sweep import band, beam, ring, rod, tube
from home_procgen.shapes.transforms import add_mirror_images, repeat_around
from home_procgen.things.family import FurnitureFamily, design


def _star(material: str, reach: float = 0.3, casters: bool = True) -> Iterator[Solid]:
    arm = [beam(material, (0.0, 0.09, 0.02), (0.0, 0.065, reach), 0.045, 0.03)]
    if casters:
        arm += [rotate(cylinder("black", 0.03, 0.036, (0.0, 0.0, 0.0), sides=12), 2, np.pi / 2)]
        arm[1] = move(arm[1], (0.018, 0.03, reach - 0.02))
    yield from (piece for piece in repeat_around(arm, 5) if isinstance(piece, Solid))


def task(width: float = 0.5, mesh_back: bool = False, arms: bool = True, high: bool = False) -> Iterator[Solid]:
    """Build a swivel chair on castors with a padded or mesh back."""
    yield from _star("black")
    yield cylinder("chrome", 0.025, 0.34, (0.0, 0.08, 0.0), sides=12)
    yield rounded_box("black", (0.2, 0.05, 0.2), (0.0, 0.4, 0.0), 0.02, 1)
    yield padded_block("upholstery", (width, 0.09, 0.5), (0.0, 0.44, 0.02), 5.0, 6)
    yield beam("black", (0.0, 0.42, -0.18), (0.0, 0.62, -0.27), 0.08, 0.025)
    top = 0.72 if high else 0.5

    def place(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
        s = 2 * u - 1
        wide = (width / 2 - 0.02) * (1 - 0.2 * v**3)
        return s * wide, 0.54 + top * v, -0.24 - 0.08 * v - 0.03 * np.sin(np.pi * v) + 0.06 * s**2

    yield surface("gray" if mesh_back else "upholstery", place, 8, 8, 0.012 if mesh_back else 0.05)
    if mesh_back:
        up, across = np.arange(6) / 5, np.arange(1, 6) / 5
        u = np.concatenate([0 * up, across, 0 * across + 1, 1 - across[:4]])
        v = np.concatenate([up, 0 * across + 1, 1 - across, 0 * across[:4]])
        rim = np.stack(np.broadcast_arrays(*place(u, v)), -1)
        yield tube("black", rim, 0.014, 6, closed=True)
    if arms:
        yield from add_mirror_images(
            [
                beam("black", (0.24, 0.46, -0.02), (0.29, 0.66, -0.02), 0.04, 0.025),
                rounded_box("black", (0.07, 0.03, 0.26), (0.29, 0.66, 0.02), 0.012, 2),
            ]
        )
    if high:
        yield padded_block("upholstery_1", (0.26, 0.14, 0.07), (0.0, 1.12, -0.33), 3.0, 5)


def executive() -> Iterator[Solid]:
    """Build a tall leather chair with a quilted back and padded arms."""
    yield from _star("wood", 0.32)
    yield cylinder("chrome", 0.03, 0.3, (0.0, 0.08, 0.0), sides=12)
    yield padded_block("leather", (0.54, 0.14, 0.54), (0.0, 0.38, 0.02), 5.0, 6)
    for i in range(4):
        y = 0.5 + 0.17 * i
        yield padded_block("leather", (0.52 - 0.02 * i, 0.19, 0.13), (0.0, y, -0.24 - 0.025 * i), 3.5, 5)
    yield from add_mirror_images(
        [
            tube(
                "wood",
                fillet([(0.24, 0.42, 0.1), (0.31, 0.5, 0.18), (0.31, 0.66, 0.14), (0.31, 0.66, -0.24)], 0.06),
                0.018,
            ),
            padded_block("leather", (0.07, 0.05, 0.26), (0.31, 0.665, -0.04), 3.0, 4),
        ]
    )


def gamer() -> Iterator[Solid]:
    """Build a racing seat with side bolsters, a headrest and stripes."""
    yield from _star("black", 0.33)
    yield cylinder("chrome", 0.028, 0.32, (0.0, 0.08, 0.0), sides=12)
    yield padded_block("black", (0.4, 0.1, 0.5), (0.0, 0.4, 0.02), 6.0, 5)
    yield from add_mirror_images([padded_block("bright", (0.09, 0.15, 0.5), (0.22, 0.39, 0.02), 3.0, 5)])
    back = [
        padded_block("black", (0.34, 0.8, 0.1), (0.0, 0.5, -0.24), 6.0, 5),
        padded_block("bright", (0.28, 0.14, 0.08), (0.0, 1.1, -0.2), 4.0, 5),
        padded_block("bright", (0.3, 0.16, 0.09), (0.0, 0.6, -0.19), 4.0, 5),
    ]
    back += list(add_mirror_images([padded_block("bright", (0.08, 0.74, 0.13), (0.2, 0.5, -0.21), 3.0, 5)]))
    yield from (rotate(piece, 0, -0.14, (0.0, 0.5, -0.24)) for piece in back)
    yield from add_mirror_images(
        [
            beam("black", (0.27, 0.42, -0.02), (0.31, 0.66, -0.02), 0.05, 0.025),
            rounded_box("black", (0.08, 0.03, 0.26), (0.31, 0.66, 0.02), 0.012, 2),
        ]
    )


def banker() -> Iterator[Solid]:
    """Build a wooden swivel chair with a bent arm rail and slats."""
    yield from _star("wood", 0.3)
    yield revolve("wood", [(0.035, 0.08), (0.05, 0.14), (0.03, 0.22), (0.03, 0.4)], sides=12)
    yield padded_block("wood", (0.5, 0.05, 0.46), (0.0, 0.42, 0.02), 4.0, 6)
    rail = [(0.29 * np.cos(a), 0.7, 0.02 + 0.29 * np.sin(a)) for a in np.linspace(np.pi * 0.93, np.pi * 2.07, 15)]
    yield band("wood", rail, 0.06, 0.025)
    for a in np.linspace(np.pi * 1.0, np.pi * 2.0, 10):
        yield rod(
            "wood",
            (0.22 * np.cos(a), 0.45, 0.02 + 0.2 * np.sin(a)),
            (0.285 * np.cos(a), 0.7, 0.02 + 0.285 * np.sin(a)),
            0.008,
            sides=6,
        )


def stool_on_wheels() -> Iterator[Solid]:
    """Build a round swivel stool with a foot ring."""
    yield from _star("chrome", 0.24)
    yield cylinder("chrome", 0.025, 0.38, (0.0, 0.08, 0.0), sides=12)
    yield ring("chrome", 0.17, 0.02, (0.0, 0.2, 0.0))
    yield revolve("upholstery", [(0.15, 0.0), (0.18, 0.02), (0.18, 0.07), (0.15, 0.09)], (0.0, 0.44, 0.0), 20, 2)


def shell_on_wheels() -> Iterator[Solid]:
    """Build a moulded shell with arms on a wooden star base."""
    yield from _star("wood", 0.28)
    yield cylinder("chrome", 0.024, 0.34, (0.0, 0.08, 0.0), sides=12)

    def place(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
        s = 2 * u - 1
        back = np.clip((v - 0.45) / 0.55, 0.0, 1.0)
        x = s * (0.27 + 0.03 * np.sin(np.pi * v) - 0.05 * back**3)
        y = 0.43 + 0.42 * back**1.3 + 0.16 * s**4 * (1 - back) + 0.02 * s**2
        return x, y, 0.24 - 0.46 * np.minimum(v / 0.5, 1.0) - 0.1 * back + 0.09 * s**2 * back

    yield surface("bright", place, 12, 14, 0.012)
    yield padded_block("upholstery", (0.4, 0.04, 0.36), (0.0, 0.44, 0.03), 4.0, 5)


def saddle() -> Iterator[Solid]:
    """Build a high stool with a saddle-shaped seat and a low back."""
    yield from _star("chrome", 0.26)
    yield cylinder("chrome", 0.026, 0.44, (0.0, 0.08, 0.0), sides=12)

    def place(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
        s, t = 2 * u - 1, 2 * v - 1
        return 0.21 * s, 0.56 - 0.07 * s**2 + 0.06 * t**2, 0.19 * t * (1 - 0.15 * s**2)

    yield surface("leather", place, 10, 10, 0.05)
    yield beam("chrome", (0.0, 0.5, -0.1), (0.0, 0.74, -0.24), 0.03, 0.012)
    yield padded_block("leather", (0.3, 0.16, 0.06), (0.0, 0.68, -0.25), 3.0, 6)


def ribbed() -> Iterator[Solid]:
    """Build a 1950s chair with thin ribbed cushions in an aluminium frame."""
    yield from _star("chrome", 0.3)
    yield cylinder("chrome", 0.024, 0.34, (0.0, 0.08, 0.0), sides=12)
    yield beam("chrome", (-0.2, 0.42, 0.0), (0.2, 0.42, 0.0), 0.05, 0.025)
    for i in range(9):
        z = 0.23 - 0.055 * i
        yield rounded_box("leather", (0.46, 0.035, 0.05), (0.0, 0.44 + 0.01 * (i < 2), z), 0.016, 2)
    for i in range(10):
        y = 0.5 + 0.052 * i
        yield rounded_box("leather", (0.46, 0.047, 0.03), (0.0, y, -0.25 - 0.012 * i), 0.014, 2)
    for s in (-1, 1):
        side = [(s * 0.24, 0.45, 0.26), (s * 0.24, 0.45, -0.24), (s * 0.24, 1.03, -0.38)]
        yield tube("chrome", fillet(side, 0.06, 4), 0.013)
        arm = [(s * 0.24, 0.44, 0.14), (s * 0.28, 0.64, 0.12), (s * 0.28, 0.65, -0.16), (s * 0.24, 0.6, -0.28)]
        yield tube("chrome", fillet(arm, 0.05, 4), 0.011)


OFFICE = (
    design(task), design(task, mesh_back=True), design(executive), design(gamer), design(banker),
    design(stool_on_wheels), design(task, arms=False, width=0.46), design(task, mesh_back=True, high=True),
    design(shell_on_wheels), design(saddle), design(ribbed),
)  # fmt: skip


FAMILIES = (FurnitureFamily("office_chair", "office_chair", OFFICE),)
