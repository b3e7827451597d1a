"""Kitchen sinks and taps."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box, cylinder
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import rod, tube
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import BOARD_THICKNESS, doors
from home_procgen.things.kitchen.cabinets import BASE_DEPTH, FRONT_Z, WORKTOP_HEIGHT


def tap(x: float, y: float, z: float, kind: str = "arc") -> Iterator[Solid]:
    """Build a mixer tap with its spout towards +z."""
    if kind == "arc":
        path = fillet([(x, y, z), (x, y + 0.3, z), (x, y + 0.3, z + 0.17), (x, y + 0.2, z + 0.18)], 0.09, 6)
        yield tube("chrome", path, 0.011)
        yield cylinder("chrome", 0.022, 0.05, (x, y, z), sides=14)
        yield rod("chrome", (x + 0.02, y + 0.04, z), (x + 0.075, y + 0.06, z), 0.006)
    elif kind == "bridge":
        for s in (-1, 1):
            yield cylinder("brass", 0.016, 0.06, (x + s * 0.09, y, z), sides=12)
            for a in range(2):
                dx, dz = (0.03, 0.0) if a else (0.0, 0.03)
                yield rod(
                    "brass", (x + s * 0.09 - dx, y + 0.075, z - dz), (x + s * 0.09 + dx, y + 0.075, z + dz), 0.006
                )
        yield rod("brass", (x - 0.09, y + 0.05, z), (x + 0.09, y + 0.05, z), 0.011)
        yield tube(
            "brass",
            fillet([(x, y + 0.05, z), (x, y + 0.22, z), (x, y + 0.22, z + 0.16), (x, y + 0.15, z + 0.16)], 0.07, 5),
            0.011,
        )
    else:
        yield cylinder("chrome", 0.02, 0.13, (x, y, z), sides=14)
        yield rounded_box("chrome", (0.03, 0.022, 0.15), (x, y + 0.09, z + 0.06), 0.008, 1)
        yield rounded_box("chrome", (0.02, 0.012, 0.09), (x, y + 0.132, z + 0.02), 0.005, 1)


def basin(
    slot: str, width: float, depth: float, deep: float, at: tuple[float, float, float], rim: float = 0.025
) -> Iterator[Solid]:
    """Build an open box basin; `at` is the centre of its opening at rim height [m]."""
    x, y, z = at
    yield box(slot, (width, 0.01, depth), (x, y - deep, z))
    for s in (-1, 1):
        yield rounded_box(
            slot, (rim, deep + 0.006, depth + 2 * rim), (x + s * (width + rim) / 2, y - deep, z), 0.006, 1
        )
        yield rounded_box(slot, (width, deep + 0.006, rim), (x, y - deep, z + s * (depth + rim) / 2), 0.006, 1)
    yield cylinder("chrome", 0.03, 0.006, (x, y - deep + 0.008, z), sides=14)


def _frame_top(width: float, hole: tuple[float, float], x: float, slot: str) -> Iterator[Solid]:
    """Build a worktop around a hole centred at x."""
    y, (w, d) = WORKTOP_HEIGHT - 0.04, hole
    left, right = x - w / 2 + width / 2, width / 2 - x - w / 2
    yield rounded_box(slot, (left, 0.04, BASE_DEPTH), (left / 2 - width / 2, y, 0.0), 0.006, 1)
    yield rounded_box(slot, (right, 0.04, BASE_DEPTH), (width / 2 - right / 2, y, 0.0), 0.006, 1)
    for s in (-1, 1):
        yield rounded_box(slot, (w, 0.04, (BASE_DEPTH - d) / 2), (x, y, s * (BASE_DEPTH + d) / 4), 0.006, 1)


def _hollow_body(width: float) -> Iterator[Solid]:
    yield box("black", (width, 0.1, BASE_DEPTH - 0.12), (0.0, 0.0, -0.05))
    for s in (-1, 1):
        yield box(
            "paint",
            (BOARD_THICKNESS, WORKTOP_HEIGHT - 0.14, BASE_DEPTH - 0.04),
            (s * (width - BOARD_THICKNESS) / 2, 0.1, -0.02),
        )
    yield box(
        "paint", (width, WORKTOP_HEIGHT - 0.14, BOARD_THICKNESS), (0.0, 0.1, BOARD_THICKNESS - BASE_DEPTH / 2 + 0.01)
    )
    yield box("paint", (width - 2 * BOARD_THICKNESS, BOARD_THICKNESS, BASE_DEPTH - 0.06), (0.0, 0.1, -0.01))
    yield box(
        "paint",
        (width - 2 * BOARD_THICKNESS, 0.1, BOARD_THICKNESS),
        (0.0, WORKTOP_HEIGHT - 0.14, FRONT_Z - BOARD_THICKNESS / 2),
    )


def sink_unit(width: float = 0.8, bowls: int = 1, kind: str = "arc", slot: str = "steel") -> Iterator[Solid]:
    """Build a sink cabinet with one or two bowls, a tap and doors."""
    yield from _hollow_body(width)
    wide = width - 0.2
    yield from _frame_top(width, (wide, 0.42), 0.0, "stone")
    for i in range(bowls):
        step = wide / bowls
        yield from basin(slot, step - 0.06, 0.36, 0.16, ((i - (bowls - 1) / 2) * step, WORKTOP_HEIGHT - 0.004, 0.0))
    yield from tap(0.0, WORKTOP_HEIGHT, -0.24, kind)
    yield from doors(
        "paint",
        width - 0.006,
        WORKTOP_HEIGHT - 0.15,
        (0.003 - width / 2, 0.105, FRONT_Z),
        2,
        "flat" if bowls == 1 else "shaker",
        ("chrome", "bar"),
        0.85,
    )


def farmhouse_sink(width: float = 0.8) -> Iterator[Solid]:
    """Build a deep white apron-front sink under a bridge tap."""
    yield box("black", (width, 0.1, BASE_DEPTH - 0.12), (0.0, 0.0, -0.05))
    yield box("paint", (width, 0.5, BASE_DEPTH - 0.04), (0.0, 0.1, -0.02))
    yield from doors(
        "paint", width - 0.006, 0.49, (0.003 - width / 2, 0.105, FRONT_Z), 2, "shaker", ("brass", "knob"), 0.85
    )
    yield box("stone", (width, 0.04, 0.14), (0.0, WORKTOP_HEIGHT - 0.04, -0.23))
    yield box("paint", (width, WORKTOP_HEIGHT - 0.64, 0.1), (0.0, 0.6, -0.25))
    yield from basin("ceramic", width - 0.1, 0.38, 0.24, (0.0, WORKTOP_HEIGHT - 0.006, 0.075), 0.045)
    yield from tap(0.0, WORKTOP_HEIGHT, -0.22, "bridge")


def drainer_sink(width: float = 1.0) -> Iterator[Solid]:
    """Build a sink beside a ribbed drainer of pressed steel."""
    yield from _hollow_body(width)
    yield from _frame_top(width, (0.42, 0.42), -0.22, "steel")
    yield from basin("steel", 0.36, 0.36, 0.17, (-0.22, WORKTOP_HEIGHT - 0.002, 0.0))
    for i in range(8):
        yield rounded_box("steel", (0.36, 0.008, 0.018), (0.24, WORKTOP_HEIGHT - 0.003, -0.19 + 0.054 * i), 0.004, 1)
    yield from tap(-0.22, WORKTOP_HEIGHT, -0.24, "lever")
    yield from doors(
        "paint",
        width - 0.006,
        WORKTOP_HEIGHT - 0.15,
        (0.003 - width / 2, 0.105, FRONT_Z),
        2,
        "flat",
        ("chrome", "bar"),
        0.85,
    )


SINKS = (
    design(sink_unit),
    design(sink_unit, width=1.0, bowls=2, kind="lever"),
    design(farmhouse_sink),
    design(drainer_sink),
    design(sink_unit, slot="ceramic", kind="bridge"),
)


FAMILIES = (FurnitureFamily("kitchen_sink", "sink", SINKS),)
