"""Towels, mirrors, paper, soap and other small things of bathrooms."""

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from home_mjx.datasets.homes.shapes.curves import fillet, loop
from home_mjx.datasets.homes.shapes.sheets import sheet, surface
from home_mjx.datasets.homes.shapes.soft import ball, rounded, soft
from home_mjx.datasets.homes.shapes.swept import beam, prism, ring, rod, tube
from home_mjx.datasets.homes.shapes.turned import turned, vessel
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.joinery import corners
from home_mjx.datasets.procedural.primitives.solids import Solid, box, cylinder, move, rotate


def draped(slot: str, width: float, x: float, y: float, z: float, front: float, back: float) -> Solid:
    """A towel folded over a bar along x at height y [m]."""
    path = [
        (z + 0.018, y - front),
        (z + 0.018, y - 0.4 * front),
        (z + 0.016, y),
        (z, y + 0.016),
        (z - 0.016, y),
        (z - 0.018, y - back),
    ]
    rows = [
        np.array([(x + s * width / 2, h, d + 0.003 * np.sin(9 * s + 5 * h)) for s in np.linspace(-1, 1, 9)])
        for d, h in path
    ]
    return sheet(slot, np.stack(rows), 0.01)


def _towel_bar(kind: str) -> Iterator[Solid]:
    for k in range(1 if kind == "bar" else 2):
        y, z = 0.5 + 0.1 * k, -0.01 + 0.0 * k if kind == "bar" else 0.05 - 0.06 * k
        yield rod("chrome", (-0.3, y, z), (0.3, y, z), 0.009)
        yield draped(f"towel_{k}" if k else "towel", 0.4 - 0.06 * k, 0.04 * k, y, z, 0.42, 0.36)
    for s in (-1, 1):
        yield rounded("chrome", (0.045, 0.15, 0.012), (s * 0.3, 0.48, -0.08), 0.005, 1)
        for k in range(1 if kind == "bar" else 2):
            y, z = 0.5 + 0.1 * k, -0.01 if kind == "bar" else 0.05 - 0.06 * k
            yield rod("chrome", (s * 0.3, y, -0.075), (s * 0.3, y, z), 0.008)


def _heated() -> Iterator[Solid]:
    for s in (-1, 1):
        yield rod("white", (s * 0.25, 0.0, 0.0), (s * 0.25, 1.1, 0.0), 0.018, sides=12)
        for y in (0.12, 0.98):
            yield rod("chrome", (s * 0.25, y, -0.06), (s * 0.25, y, 0.0), 0.012)
    for group in range(3):
        for i in range(5):
            yield rod(
                "white",
                (-0.25, 0.06 + 0.37 * group + 0.05 * i, 0.01),
                (0.25, 0.06 + 0.37 * group + 0.05 * i, 0.01),
                0.012,
            )
    yield draped("towel", 0.4, 0.0, 0.97, 0.03, 0.4, 0.3)


def _ladder() -> Iterator[Solid]:
    for s in (-1, 1):
        yield rod("wood", (s * 0.24, 0.0, 0.16), (s * 0.2, 1.6, -0.16), 0.018, sides=10)
    for i in range(5):
        y = 0.25 + 0.3 * i
        w, z = 0.24 - 0.04 * y / 1.6, 0.16 - 0.32 * y / 1.6
        yield rod("wood", (-w, y, z), (w, y, z), 0.014)
        if i in (2, 4):
            yield draped(f"towel_{i}", 0.34, 0.0, y, z, 0.3, 0.2)


def _stand() -> Iterator[Solid]:
    for s in (-1, 1):
        yield tube("brass", fillet([(s * 0.3, 0.01, -0.12), (s * 0.3, 0.01, 0.12)], 0.01), 0.012)
        yield rod("brass", (s * 0.3, 0.01, 0.0), (s * 0.3, 0.85, 0.0), 0.012)
    for y, z in ((0.83, 0.0), (0.62, 0.07), (0.4, -0.07)):
        yield rod("brass", (-0.3, y, z), (0.3, y, z), 0.01)
    yield draped("towel", 0.42, 0.0, 0.83, 0.0, 0.42, 0.36)
    yield draped("towel_1", 0.3, 0.08, 0.62, 0.07, 0.3, 0.2)
    for s in (-1, 1):
        for y, z in ((0.62, 0.07), (0.4, -0.07)):
            yield rod("brass", (s * 0.3, y, 0.0), (s * 0.3, y, z), 0.008)


_TOWEL_RACK_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "bar": partial(_towel_bar, "bar"),
    "double": partial(_towel_bar, "double"),
    "heated": _heated,
    "ladder": _ladder,
    "stand": _stand,
}


def towel_rack(kind: str = "bar") -> Iterator[Solid]:
    """A bar with a towel, a ladder, a heated frame, a ring, a free stand."""
    yield from _TOWEL_RACK_KINDS[kind]()


def towel_hook(kind: str = "ring") -> Iterator[Solid]:
    """A ring or hooks with towels, or a robe on a hook."""
    if kind == "ring":
        yield rounded("chrome", (0.05, 0.05, 0.02), (0.0, 0.4, -0.05), 0.008, 2)
        yield rod("chrome", (0.0, 0.425, -0.045), (0.0, 0.425, -0.01), 0.008)
        yield ring("chrome", 0.08, 0.012, (0.0, 0.34, -0.005), 2, 24)
        yield draped("towel", 0.13, 0.0, 0.265, -0.005, 0.26, 0.2)
        return
    yield rounded("wood", (0.4, 0.07, 0.018), (0.0, 0.62, -0.06), 0.006, 1)
    for i in range(3):
        x = (i - 1) * 0.13
        yield tube("brass", fillet([(x, 0.66, -0.05), (x, 0.63, -0.01), (x, 0.66, 0.01)], 0.02), 0.006, 6)
    folds = fillet([(-0.03, 0.65), (0.03, 0.65), (0.1, 0.3), (0.11, 0.02), (-0.11, 0.02), (-0.1, 0.3)], 0.03, 3, True)
    if kind == "robe":
        yield prism("towel", folds, 0.07, (0.0, 0.0, -0.012))
        for s in (-1, 1):
            yield tube(
                "towel", [(s * 0.06, 0.52, 0.0), (s * 0.15, 0.36, 0.0), (s * 0.17, 0.14, 0.0)], [0.04, 0.05, 0.055], 10
            )
        yield tube("towel_1", [(-0.09, 0.32, 0.03), (0.0, 0.31, 0.04), (0.03, 0.1, 0.04)], 0.012, 6)
    else:
        for i in (0, 2):
            yield prism(f"towel_{i}", [(0.7 * x + (i - 1) * 0.13, y) for x, y in folds], 0.05, (0.0, 0.0, -0.012))


def _framed_mirror(kind: str, width: float, height: float) -> Iterator[Solid]:
    rim = {"frame": 0.035, "shelf": 0.02, "ornate": 0.08}[kind]
    yield box("mirror", (width - rim, height - rim, 0.01), (0.0, rim / 2, -0.008))
    slot = "gold" if kind == "ornate" else "wood"
    for s in (-1, 1):
        yield rounded(slot, (rim, height, 0.03), (s * (width - rim) / 2, 0.0, 0.0), 0.012, 2)
        yield rounded(slot, (width - rim, rim, 0.03), (0.0, (height - rim) * (s + 1) / 2, 0.0), 0.012, 2)
    if kind == "shelf":
        yield rounded(slot, (width, 0.02, 0.13), (0.0, 0.0, 0.05), 0.006, 1)
        yield turned("glaze", [(0.02, 0.0), (0.03, 0.03), (0.016, 0.08), (0.02, 0.1)], (0.18, 0.02, 0.05), 12, 2)
    if kind == "ornate":
        for i in range(8):
            yield ball(slot, 0.03, ((i - 3.5) * width / 8, height - 0.01 + 0.05 * np.cos((i - 3.5) / 2.6), 0.0), 10, 6)
        for x, y in ((-1, 0.04), (1, 0.04), (-1, height - 0.04), (1, height - 0.04)):
            yield ball(slot, (0.055, 0.055, 0.025), (x * (width / 2 - 0.04), y, 0.012), 12, 8)


def _rounded_mirror(kind: str, width: float, height: float) -> Iterator[Solid]:
    high = width if kind != "oval" else height
    yield prism("mirror", loop(width, high, 36), 0.01, (0.0, high / 2, -0.006))
    yield tube(
        "wood" if kind == "oval" else "brass",
        np.insert(loop(width, high, 36) + np.array([0.0, high / 2]), 2, 0.0, axis=1),
        0.018,
        8,
        closed=True,
    )
    if kind == "round":
        yield tube(
            "leather",
            [(-0.42 * width, 0.78 * width, 0.0), (0.0, 1.3 * width, 0.0), (0.42 * width, 0.78 * width, 0.0)],
            0.01,
            6,
        )
        yield ball("brass", 0.025, (0.0, 1.3 * width, 0.0), 10, 6)
    if kind == "sun":
        for i in range(24):
            a = 2 * np.pi * i / 24
            reach = 0.62 + 0.2 * (i % 2)
            c, s = np.cos(a), np.sin(a)
            yield rod(
                "gold",
                (0.51 * width * c, width / 2 + 0.51 * width * s, 0.0),
                (reach * width * c, width / 2 + reach * width * s, 0.0),
                0.016,
                0.003,
                6,
            )


def _arched_mirror(width: float, height: float) -> Iterator[Solid]:
    outline = [
        (-width / 2, 0.0),
        (width / 2, 0.0),
        *[(width / 2 * np.cos(a), height - width / 2 + width / 2 * np.sin(a)) for a in np.linspace(0, np.pi, 15)],
    ]
    yield prism("mirror", outline, 0.01, (0.0, 0.0, -0.006))
    yield tube("iron", np.insert(np.asarray(outline), 2, 0.0, axis=1), 0.014, 8, closed=True)
    yield rod("iron", (0.0, 0.01, 0.004), (0.0, height - 0.01, 0.004), 0.006)
    for y in (0.35, 0.65):
        yield rod("iron", (-width / 2, y * height, 0.004), (width / 2, y * height, 0.004), 0.006)


def _mirror_cabinet(width: float, height: float) -> Iterator[Solid]:
    yield rounded("white", (width, height, 0.12), (0.0, 0.0, 0.0), 0.005, 1)
    for i in range(2):
        yield box("mirror", (width / 2 - 0.01, height - 0.02, 0.008), ((i - 0.5) * width / 2, 0.01, 0.062))
        yield ball("chrome", 0.01, ((i - 0.5) * 0.06, 0.12, 0.072), 10, 6)
    yield rounded("chrome", (0.3, 0.03, 0.06), (0.0, height, 0.05), 0.01, 2)


def _standing_mirror(width: float, height: float) -> Iterator[Solid]:
    for s in (-1, 1):
        yield beam("wood", (s * (width / 2 + 0.03), 0.02, 0.0), (s * (width / 2 + 0.03), 1.3, 0.0), 0.035)
        yield beam("wood", (s * (width / 2 + 0.03), 0.02, -0.22), (s * (width / 2 + 0.03), 0.02, 0.22), 0.04, 0.04)
    tilted = [box("mirror", (width - 0.04, 1.44, 0.01), (0.0, 0.16, 0.0))]
    for s in (-1, 1):
        tilted.append(rounded("wood", (0.035, 1.5, 0.03), (s * (width - 0.03) / 2, 0.13, -0.004), 0.01, 1))
        tilted.append(rounded("wood", (width, 0.035, 0.03), (0.0, 0.13 + 1.465 * (s + 1) / 2, -0.004), 0.01, 1))
    yield from (rotate(p, 0, -0.12, (0.0, 0.85, 0.0)) for p in tilted)


_MIRROR_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "frame": partial(_framed_mirror, "frame"),
    "shelf": partial(_framed_mirror, "shelf"),
    "ornate": partial(_framed_mirror, "ornate"),
    "oval": partial(_rounded_mirror, "oval"),
    "round": partial(_rounded_mirror, "round"),
    "sun": partial(_rounded_mirror, "sun"),
    "arch": _arched_mirror,
    "cabinet": _mirror_cabinet,
    "standing": _standing_mirror,
}


def mirror(width: float = 0.6, height: float = 0.8, kind: str = "frame") -> Iterator[Solid]:
    """For a wall: framed, oval, round with a strap, a sun, arched, with a shelf, a cabinet; or free-standing."""
    yield from _MIRROR_KINDS[kind](width, height)


def mirror_tiles(columns: int = 2, rows: int = 3, size: float = 0.28) -> Iterator[Solid]:
    """Small square mirrors in rows."""
    for i in range(columns):
        for j in range(rows):
            at = ((i - (columns - 1) / 2) * (size + 0.02), j * (size + 0.02), 0.0)
            yield rounded("black", (size, size, 0.02), at, 0.005, 1)
            yield box("mirror", (size - 0.02, size - 0.02, 0.004), (at[0], at[1] + 0.01, 0.011))


def _roll(x: float, y: float, z: float) -> Solid:
    return turned("white", [(0.055, 0.0), (0.055, 0.1)], (x, y, z), 22, 1)


def _paper_holder() -> Iterator[Solid]:
    yield rounded("chrome", (0.05, 0.05, 0.012), (0.08, 0.09, -0.07), 0.005, 1)
    yield tube("chrome", fillet([(0.08, 0.115, -0.065), (0.08, 0.115, 0.0), (-0.08, 0.115, 0.0)], 0.02), 0.006)
    yield move(rotate(_roll(0.0, -0.05, 0.0), 2, np.pi / 2), (0.0, 0.115, 0.0))
    yield surface(
        "white", lambda u, v: ((u - 0.5) * 0.098, 0.115 - 0.115 * v, 0.056 + 0.006 * np.sin(3 * v)), 3, 5, 0.002
    )


def _paper_stand() -> Iterator[Solid]:
    yield turned("chrome", [(0.09, 0.0), (0.085, 0.012), (0.01, 0.02)], sides=22, steps=1)
    yield rod("chrome", (0.0, 0.01, 0.0), (0.0, 0.6, 0.0), 0.008)
    for i in range(3):
        yield _roll(0.0, 0.03 + 0.105 * i, 0.0)
    yield ball("chrome", 0.016, (0.0, 0.61, 0.0), 10, 6)
    yield tube("chrome", fillet([(0.0, 0.52, 0.0), (0.1, 0.52, 0.0), (0.1, 0.52, 0.01)], 0.01), 0.006)


def _paper_basket() -> Iterator[Solid]:
    yield vessel("cane", [(0.14, 0.0), (0.16, 0.06), (0.16, 0.14)], 0.008, sides=24, steps=1)
    for i in range(3):
        a = 2 * np.pi * i / 3
        yield _roll(0.075 * np.cos(a), 0.012, 0.075 * np.sin(a))
        yield _roll(0.065 * np.cos(a + 1), 0.114, 0.065 * np.sin(a + 1))


_PAPER_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "wall": _paper_holder,
    "stand": _paper_stand,
    "basket": _paper_basket,
}


def paper(kind: str = "wall") -> Iterator[Solid]:
    """A roll on a holder, on a stand, or a pile of rolls."""
    yield from _PAPER_KINDS[kind]()


def soap(kind: str = "pump") -> Iterator[Solid]:
    """A pump bottle, or a foam one."""
    shape = (
        [(0.034, 0.0), (0.037, 0.01), (0.035, 0.1), (0.014, 0.13)]
        if kind == "pump"
        else [(0.03, 0.0), (0.04, 0.05), (0.03, 0.1), (0.016, 0.12)]
    )
    yield turned("glaze" if kind == "pump" else "tint", shape, sides=20, steps=2)
    yield cylinder("chrome", 0.017, 0.02, (0.0, 0.12, 0.0), sides=14)
    yield rod("chrome", (0.0, 0.13, 0.0), (0.0, 0.165, 0.0), 0.006)
    yield tube("chrome", fillet([(0.0, 0.165, -0.012), (0.0, 0.17, 0.03), (0.0, 0.16, 0.05)], 0.01), 0.007)


def soap_dish() -> Iterator[Solid]:
    """A bar of soap on an oval dish."""
    yield vessel("crockery", [(0.035, 0.0), (0.045, 0.008), (0.06, 0.025)], 0.004, sides=26, steps=2, stretch=0.7)
    yield soft("bright", (0.075, 0.026, 0.045), (0.0, 0.01, 0.0), 3.0, 5)


def _bottles() -> Iterator[Solid]:
    for i, (r, h) in enumerate(((0.03, 0.2), (0.034, 0.17), (0.025, 0.13))):
        yield turned(
            f"bright_{i}", [(r, 0.0), (r, 0.8 * h), (0.5 * r, 0.86 * h)], (-0.075 + 0.075 * i, 0.0, 0.0), 16, 1
        )
        yield turned("white", [(0.55 * r, 0.85 * h), (0.5 * r, h)], (-0.075 + 0.075 * i, 0.0, 0.0), 14, 1)
    yield rounded("white", (0.035, 0.13, 0.02), (0.03, 0.0, 0.05), 0.009, 2)


def _brushes() -> Iterator[Solid]:
    yield vessel("glaze", [(0.035, 0.0), (0.038, 0.1)], 0.004, sides=20, steps=1)
    for i in range(3):
        a = 2 * np.pi * i / 3 + 0.4
        foot, tip = (0.0, 0.012, 0.0), (0.045 * np.cos(a), 0.18, 0.045 * np.sin(a))
        yield rod(f"bright_{i}", foot, tip, 0.0045, 0.0035, 6)
        yield move(rounded("white", (0.012, 0.024, 0.02), (0.0, -0.012, 0.0), 0.003, 1), tip)
    yield rounded("blue", (0.035, 0.012, 0.13), (0.085, 0.0, 0.0), 0.005, 2)


def _tray() -> Iterator[Solid]:
    yield vessel("brass", [(0.13, 0.0), (0.135, 0.02)], 0.004, sides=28, steps=1, stretch=0.6)
    yield rounded("tint", (0.05, 0.06, 0.03), (-0.05, 0.005, 0.0), 0.006, 2)
    yield turned("gold", [(0.012, 0.065), (0.014, 0.09)], (-0.05, 0.0, 0.0), 12, 1)
    yield turned("glass", [(0.02, 0.005), (0.03, 0.03), (0.012, 0.06)], (0.03, 0.0, 0.01), 16, 2)
    yield ball("gold", 0.014, (0.03, 0.075, 0.01), 10, 6)
    yield turned("bright", [(0.012, 0.005), (0.012, 0.06)], (0.08, 0.0, -0.01), 12, 1)


def _caddy() -> Iterator[Solid]:
    for y in (0.0, 0.3):
        yield rounded("chrome", (0.26, 0.008, 0.1), (0.0, y, 0.0), 0.003, 1)
        for z in (-0.05, 0.05):
            yield rod("chrome", (-0.13, y + 0.06, z), (0.13, y + 0.06, z), 0.004, sides=6)
    for s in (-1, 1):
        yield tube(
            "chrome",
            fillet([(s * 0.13, 0.0, -0.045), (s * 0.13, 0.55, -0.045), (0.0, 0.62, -0.045)], 0.06),
            0.005,
            6,
        )
    for i in range(4):
        yield turned(
            f"bright_{i}",
            [(0.025, 0.0), (0.026, 0.13), (0.012, 0.15), (0.012, 0.18)],
            (-0.08 + 0.055 * i, 0.308 if i % 2 else 0.008, 0.0),
            14,
            1,
        )


_TOILETRIES_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "bottles": _bottles,
    "brushes": _brushes,
    "tray": _tray,
    "caddy": _caddy,
}


def toiletries(kind: str = "bottles") -> Iterator[Solid]:
    """Bottles and tubes, tooth brushes in a cup, a tray with perfume, a caddy."""
    yield from _TOILETRIES_KINDS[kind]()


def plunger(kind: str = "plunger") -> Iterator[Solid]:
    """A rubber plunger, or a brush in its holder."""
    if kind == "plunger":
        yield turned("red", [(0.075, 0.0), (0.08, 0.02), (0.06, 0.06), (0.02, 0.09), (0.018, 0.11)], sides=22, steps=2)
        yield rod("wood", (0.0, 0.1, 0.0), (0.0, 0.5, 0.0), 0.012, sides=10)
    else:
        yield vessel("chrome", [(0.05, 0.0), (0.052, 0.3)], 0.004, sides=22, steps=1)
        yield rod("chrome", (0.0, 0.05, 0.0), (0.0, 0.42, 0.0), 0.008)
        yield cylinder("chrome", 0.045, 0.01, (0.0, 0.31, 0.0), sides=20)
        yield ball("black", 0.014, (0.0, 0.425, 0.0), 10, 6)


def scale() -> Iterator[Solid]:
    """A flat scale with a dial."""
    yield rounded("glass", (0.31, 0.02, 0.31), (0.0, 0.014, 0.0), 0.01, 2)
    for x, z in corners(0.24, 0.24):
        yield cylinder("chrome", 0.02, 0.016, (x, 0.0, z), sides=14)
    yield rounded("black", (0.1, 0.006, 0.05), (0.0, 0.032, -0.09), 0.002, 1)
    yield cylinder("chrome", 0.04, 0.003, (-0.07, 0.034, 0.03), sides=18)
    yield cylinder("chrome", 0.04, 0.003, (0.07, 0.034, 0.03), sides=18)


def dryer() -> Iterator[Solid]:
    """A hair dryer lying on its side."""
    yield tube(
        "bright",
        [(-0.09, 0.045, 0.0), (-0.06, 0.045, 0.0), (0.02, 0.045, 0.0), (0.1, 0.045, 0.0), (0.14, 0.045, 0.0)],
        [0.035, 0.045, 0.043, 0.032, 0.03],
        14,
    )
    yield tube("black", [(0.14, 0.045, 0.0), (0.17, 0.045, 0.0)], [0.033, 0.022], 14)
    yield tube("bright", [(-0.03, 0.04, 0.03), (-0.01, 0.026, 0.1), (0.0, 0.022, 0.17)], [0.022, 0.02, 0.018], 12)
    yield tube("black", [(0.0, 0.022, 0.17), (0.0, 0.006, 0.24), (-0.08, 0.006, 0.28), (-0.16, 0.006, 0.24)], 0.005, 6)


MIRRORS = (
    design(mirror), design(mirror, kind="oval"), design(mirror, kind="round", width=0.55),
    design(mirror, kind="sun", width=0.4), design(mirror, kind="arch", height=1.2), design(mirror, kind="shelf"),
    design(mirror, kind="cabinet", height=0.65), design(mirror, kind="standing", width=0.5),
    design(mirror, kind="ornate", width=0.8, height=1.0), design(mirror, width=0.45, height=1.3), design(mirror_tiles),
)  # fmt: skip


def _of(build: object, *kinds: str) -> tuple:
    return tuple(design(build, kind=kind) for kind in kinds)  # type: ignore[arg-type]


FAMILIES = (
    Family("towel_rack", "towel_rack", _of(towel_rack, "bar", "heated", "ladder", "stand", "double")),
    Family("towel_hanger", "towel_hanger", _of(towel_hook, "ring", "hooks", "robe")),
    Family("mirror", "mirror", MIRRORS),
    Family("toilet_paper", "toilet_paper", _of(paper, "wall", "stand", "basket")),
    Family("soap_dispenser", "soap_dispenser", _of(soap, "pump", "foam")),
    Family("soap_dish", "soap_dish", (design(soap_dish),)),
    Family("toiletries", "toiletries", _of(toiletries, "bottles", "brushes", "tray", "caddy")),
    Family("plunger", "toilet_plunger", _of(plunger, "plunger", "brush")),
    Family("scale", "weight_scale", (design(scale),)),
    Family("hair_dryer", "hair_dryer", (design(dryer),)),
)
