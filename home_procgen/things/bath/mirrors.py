"""Mirrors."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from home_procgen.primitives.solids import Solid, box, rotate
from home_procgen.shapes.curves import loop
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import beam, prism, rod, tube
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.movable_parts import panel


def _framed_mirror(kind: str, width: float, height: float) -> Iterator[Solid]:
    rim = {"frame": 0.035, "shelf": 0.02, "ornate": 0.08}[kind]
    yield box("mirror", (width - rim, height - rim, 0.01), (0.0, rim / 2, -0.008))
    slot = "gold" if kind == "ornate" else "wood"
    for s in (-1, 1):
        yield rounded_box(slot, (rim, height, 0.03), (s * (width - rim) / 2, 0.0, 0.0), 0.012, 2)
        yield rounded_box(slot, (width - rim, rim, 0.03), (0.0, (height - rim) * (s + 1) / 2, 0.0), 0.012, 2)
    if kind == "shelf":
        yield rounded_box(slot, (width, 0.02, 0.13), (0.0, 0.0, 0.05), 0.006, 1)
        yield revolve("glaze", [(0.02, 0.0), (0.03, 0.03), (0.016, 0.08), (0.02, 0.1)], (0.18, 0.02, 0.05), 12, 2)
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
    yield rounded_box("white", (width, height, 0.12), (0.0, 0.0, 0.0), 0.005, 1)
    for i in range(2):
        pane = box("mirror", (width / 2 - 0.01, height - 0.02, 0.008), ((i - 0.5) * width / 2, 0.01, 0.062))
        knob = ball("chrome", 0.01, ((i - 0.5) * 0.06, 0.12, 0.072), 10, 6)
        yield from panel("right" if i else "left", pane, knob)
    yield rounded_box("chrome", (0.3, 0.03, 0.06), (0.0, height, 0.05), 0.01, 2)


def _standing_mirror(width: float, height: float) -> Iterator[Solid]:
    for s in (-1, 1):
        yield beam("wood", (s * (width / 2 + 0.03), 0.02, 0.0), (s * (width / 2 + 0.03), 1.3, 0.0), 0.035)
        yield beam("wood", (s * (width / 2 + 0.03), 0.02, -0.22), (s * (width / 2 + 0.03), 0.02, 0.22), 0.04, 0.04)
    tilted = [box("mirror", (width - 0.04, 1.44, 0.01), (0.0, 0.16, 0.0))]
    for s in (-1, 1):
        tilted.append(rounded_box("wood", (0.035, 1.5, 0.03), (s * (width - 0.03) / 2, 0.13, -0.004), 0.01, 1))
        tilted.append(rounded_box("wood", (width, 0.035, 0.03), (0.0, 0.13 + 1.465 * (s + 1) / 2, -0.004), 0.01, 1))
    yield from (rotate(p, 0, -0.12, (0.0, 0.85, 0.0)) for p in tilted)


_MIRROR_KINDS = {
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
    """Build a wall mirror (frame, ornate, oval, round, sun, arch, shelf, cabinet) or a freestanding mirror."""
    yield from _MIRROR_KINDS[kind](width, height)


def mirror_tiles(columns: int = 2, rows: int = 3, size: float = 0.28) -> Iterator[Solid]:
    """Build rows of small square mirrors."""
    for i in range(columns):
        for j in range(rows):
            at = ((i - (columns - 1) / 2) * (size + 0.02), j * (size + 0.02), 0.0)
            yield rounded_box("black", (size, size, 0.02), at, 0.005, 1)
            yield box("mirror", (size - 0.02, size - 0.02, 0.004), (at[0], at[1] + 0.01, 0.011))


MIRRORS = (
    design(mirror), design(mirror, kind="oval"), design(mirror, kind="round", width=0.55),
    design(mirror, kind="sun", width=0.4), design(mirror, kind="arch", height=1.2), design(mirror, kind="shelf"),
    design(mirror, kind="cabinet", height=0.65), design(mirror, kind="standing", width=0.5),
    design(mirror, kind="ornate", width=0.8, height=1.0), design(mirror, width=0.45, height=1.3), design(mirror_tiles),
)  # fmt: skip


FAMILIES = (FurnitureFamily("mirror", "mirror", MIRRORS),)
