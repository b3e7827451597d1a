"""Plates and place settings."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box, cylinder, move, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import vessel
from home_procgen.shapes.rounded import ball, padded_block, rounded_box
from home_procgen.shapes.sweep import prism, tube
from home_procgen.things.family import FurnitureFamily, design, design_kinds


def _stack_plates() -> Iterator[Solid]:
    for i in range(6):
        yield vessel(
            "crockery",
            [(0.06, 0.0), (0.09, 0.004), (0.13, 0.02)],
            0.004,
            (0.002 * (-1) ** i, 0.0085 * i, 0.0),
            24,
            1,
        )


def _bowls() -> Iterator[Solid]:
    for i in range(4):
        yield vessel(
            "glaze",
            [(0.035, 0.0), (0.04, 0.008), (0.07, 0.03), (0.08, 0.055)],
            0.004,
            (0.0, 0.018 * i, 0.002 * (-1) ** i),
            22,
            2,
        )


def _rack() -> Iterator[Solid]:
    for s in (-1, 1):
        yield tube("chrome", fillet([(-0.17, 0.006, s * 0.08), (0.17, 0.006, s * 0.08)], 0.01), 0.005, 6)
    for i in range(8):
        x = -0.15 + 0.043 * i
        yield tube(
            "chrome", fillet([(x, 0.006, -0.08), (x, 0.1, -0.02), (x, 0.1, 0.02), (x, 0.006, 0.08)], 0.03), 0.003, 5
        )
        if i in (0, 1, 2, 4, 5):
            plate = rotate(
                vessel("crockery", [(0.05, 0.0), (0.075, 0.004), (0.105, 0.016)], 0.004, sides=22, steps=1),
                2,
                -1.42,
            )
            yield move(plate, (x + 0.01, 0.112, 0.0))


def _platter() -> Iterator[Solid]:
    yield vessel("crockery", [(0.08, 0.0), (0.11, 0.005), (0.15, 0.022)], 0.004, sides=28, steps=2, stretch=0.66)
    for i in range(5):
        yield ball("red" if i % 2 else "green", 0.026, (-0.07 + 0.035 * i, 0.03, 0.015 * (-1) ** i), 10, 6)


def _plate_set() -> Iterator[Solid]:
    yield vessel("crockery", [(0.06, 0.0), (0.09, 0.004), (0.13, 0.016)], 0.004, sides=26, steps=1)
    yield vessel("crockery", [(0.05, 0.0), (0.07, 0.004), (0.1, 0.014)], 0.004, (0.0, 0.006, 0.0), 24, 1)
    yield from _cutlery(-0.16, 0.17)


_PLATES_KINDS = {
    "stack": _stack_plates,
    "bowls": _bowls,
    "rack": _rack,
    "platter": _platter,
    "set": _plate_set,
}


def plates(kind: str = "stack") -> Iterator[Solid]:
    """Build a `stack` of plates, stacked `bowls`, plates in a `rack`, a `platter` or a `set` with cutlery."""
    yield from _PLATES_KINDS[kind]()


def _cutlery(left: float, right: float) -> Iterator[Solid]:
    """Build a fork to the left, and a knife and a spoon to the right."""
    yield rounded_box("steel", (0.011, 0.003, 0.12), (left, 0.0, 0.03), 0.001, 1)
    yield rounded_box("steel", (0.024, 0.003, 0.03), (left, 0.0, -0.045), 0.001, 1)
    for i in range(4):
        yield box("steel", (0.003, 0.002, 0.04), (left - 0.0095 + 0.0063 * i, 0.0005, -0.078))
    yield rounded_box("steel", (0.014, 0.005, 0.1), (right, 0.0, 0.05), 0.002, 1)
    yield prism(
        "steel",
        [(right - 0.008, 0.0), (right + 0.008, 0.0), (right + 0.008, -0.08), (right, -0.11), (right - 0.006, -0.09)],
        0.002,
        plane="top",
    )
    yield rounded_box("steel", (0.01, 0.003, 0.12), (right + 0.035, 0.0, 0.03), 0.001, 1)
    yield ball("steel", (0.019, 0.004, 0.03), (right + 0.035, 0.004, -0.055), 12, 6)


def setting(mat: str = "round") -> Iterator[Solid]:
    """Build a place setting: a mat with plates, cutlery, a glass and a napkin; or a breakfast on a tray."""
    if mat == "tray":
        yield rounded_box("wood", (0.42, 0.012, 0.3), (0.0, 0.0, 0.0), 0.005, 2)
        for s in (-1, 1):
            yield rounded_box("wood", (0.014, 0.03, 0.3), (s * 0.203, 0.008, 0.0), 0.005, 2)
        yield from (move(p, (-0.06, 0.012, 0.03)) for p in plates("bowls"))
        yield vessel("glaze", [(0.03, 0.0), (0.036, 0.05), (0.036, 0.085)], 0.003, (0.12, 0.012, -0.05), 18, 1)
        yield rounded_box("linen", (0.08, 0.012, 0.12), (0.12, 0.012, 0.06), 0.004, 1)
        return
    if mat == "round":
        yield cylinder("cane", 0.19, 0.004, sides=30)
    else:
        yield rounded_box("textile", (0.44, 0.004, 0.32), (0.0, 0.0, 0.0), 0.002, 1)
    yield from (move(p, (0.0, 0.004, 0.0)) for p in plates("set"))
    yield vessel("glass", [(0.028, 0.0), (0.032, 0.04), (0.036, 0.11)], 0.002, (0.14, 0.004, -0.13), 16, 1)
    yield (
        rounded_box("linen", (0.07, 0.008, 0.16), (-0.03, 0.024, 0.0), 0.003, 1)
        if mat == "round"
        else padded_block("textile_1", (0.09, 0.016, 0.09), (0.0, 0.024, 0.0), 3.0, 3)
    )


FAMILIES = (
    FurnitureFamily("plates", "plates", design_kinds(plates, "stack", "bowls", "rack", "platter", "set")),
    FurnitureFamily(
        "place_setting", "place_setting", (design(setting), design(setting, mat="cloth"), design(setting, mat="tray"))
    ),
)
