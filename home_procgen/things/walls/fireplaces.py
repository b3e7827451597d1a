"""Fireplaces."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box, cylinder
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import padded_block, rounded_box
from home_procgen.shapes.sweep import rod, tube
from home_procgen.things.family import FurnitureFamily, design, design_kinds
from home_procgen.things.joinery import corners

STOVE_HEIGHTS = (2.44, 2.64, 2.84)  # [m], tops of the pipes of stoves above the floor


def fireplace(kind: str = "mantel", top: float = STOVE_HEIGHTS[0]) -> Iterator[Solid]:
    """Build a fireplace: a mantelpiece, a brick hearth, a modern slot, or an iron stove with a pipe up to `top` [m]."""
    if kind == "stove":
        for x, z in corners(0.42, 0.34):
            yield tube("iron", [(1.15 * x, 0.0, 1.15 * z), (x, 0.14, z)], [0.02, 0.03], 8)
        yield rounded_box("iron", (0.52, 0.6, 0.44), (0.0, 0.13, 0.0), 0.03, 2)
        yield rounded_box("iron", (0.58, 0.04, 0.5), (0.0, 0.72, 0.0), 0.015, 2)
        yield rounded_box("iron", (0.38, 0.38, 0.03), (0.0, 0.26, 0.222), 0.02, 2)
        yield box("orange", (0.28, 0.22, 0.01), (0.0, 0.34, 0.236))
        yield rod("brass", (0.16, 0.4, 0.26), (0.16, 0.5, 0.26), 0.008)
        yield cylinder("iron", 0.075, top - 0.75, (0.0, 0.75, -0.08), sides=18)
        yield rounded_box("stone", (0.9, 0.03, 0.8), (0.0, 0.0, 0.06), 0.008, 1)
        return
    slot = {"mantel": "white", "brick": "masonry", "slot": "concrete"}[kind]
    wide, high, hole = (1.4, 1.15, 0.72) if kind != "slot" else (1.6, 1.1, 1.2)
    side = (wide - hole) / 2
    low, mouth = (0.05, 0.7) if kind != "slot" else (0.4, 0.36)
    for s in (-1, 1):
        yield box(slot, (side, high - 0.06, 0.32), (s * (hole + side) / 2, 0.0, 0.0))
    yield box(slot, (hole, high - 0.06 - low - mouth, 0.32), (0.0, low + mouth, 0.0))
    yield box(slot, (hole, low, 0.32), (0.0, 0.0, 0.0))
    yield box("black", (hole, mouth, 0.03), (0.0, low, -0.14))
    yield rounded_box(
        "wood" if kind == "brick" else slot, (wide + 0.14, 0.07, 0.42), (0.0, high - 0.07, 0.03), 0.015, 2
    )
    if kind != "slot":
        yield rounded_box("stone", (wide + 0.1, 0.05, 0.7), (0.0, 0.0, 0.2), 0.01, 1)
        for i in range(4):
            yield rod(
                "bark",
                (-0.2 + 0.02 * i, 0.1 + 0.045 * (i // 2), -0.06 + 0.08 * (i % 2)),
                (0.2 - 0.03 * i, 0.11 + 0.05 * (i // 2), 0.02 - 0.08 * (i % 2)),
                0.035,
                sides=8,
            )
    if kind == "mantel":
        for s in (-1, 1):
            yield rounded_box("white", (0.16, 0.72, 0.04), (s * (hole / 2 + 0.17), 0.14, 0.16), 0.012, 1)
            yield rounded_box("white", (0.2, 0.1, 0.06), (s * (hole / 2 + 0.17), 0.05, 0.17), 0.01, 1)
            yield padded_block("white", (0.2, 0.12, 0.06), (s * (hole / 2 + 0.17), 0.86, 0.17), 4.0, 4)
        yield rounded_box("white", (hole - 0.1, 0.16, 0.03), (0.0, 0.82, 0.16), 0.01, 1)
    for i in range(7 if kind == "slot" else 5):
        x = (i - 3) * 0.15 if kind == "slot" else (i - 2) * 0.07
        h = 0.14 + 0.05 * (i % 3)
        yield revolve(
            "orange" if i % 2 else "yellow",
            [(0.02, 0.0), (0.035, 0.3 * h), (0.018, 0.7 * h), (0.001, h)],
            (x, low + (0.02 if kind == "slot" else 0.14), -0.03),
            8,
            2,
        )


FIREPLACES = (
    *design_kinds(fireplace, "mantel", "brick", "stove", "slot"),
    *(design(fireplace, kind="stove", top=top) for top in STOVE_HEIGHTS[1:]),
)


FAMILIES = (FurnitureFamily("fireplace", "fireplace", FIREPLACES),)
