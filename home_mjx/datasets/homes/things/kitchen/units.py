"""Kitchen cabinets, sinks, cookers, hoods; floor units are 0.6 m deep and share the height of the worktop."""

from collections.abc import Callable, Iterator

import numpy as np

from home_mjx.datasets.homes.shapes.curves import fillet
from home_mjx.datasets.homes.shapes.sheets import surface
from home_mjx.datasets.homes.shapes.soft import rounded
from home_mjx.datasets.homes.shapes.swept import beam, prism, ring, rod, tube
from home_mjx.datasets.homes.shapes.turned import turned, vessel
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.joinery import BOARD, case, disc, doors, drawers, front
from home_mjx.datasets.procedural.primitives.solids import Solid, box, cylinder

DEPTH, WORKTOP = 0.6, 0.88  # [m]
FACE = DEPTH / 2 - 0.04  # [m], where fronts begin


def _body(width: float, low: float = 0.1) -> Iterator[Solid]:
    yield box("black", (width, low, DEPTH - 0.12), (0.0, 0.0, -0.05))
    yield box("paint", (width, WORKTOP - 0.04 - low, DEPTH - 0.04), (0.0, low, -0.02))


def _worktop(width: float, slot: str = "stone") -> Solid:
    return rounded(slot, (width, 0.04, DEPTH), (0.0, WORKTOP - 0.04, 0.0), 0.008, 2)


def base_unit(
    width: float = 0.6,
    style: str = "flat",
    rows: int = 0,
    count: int = 1,
    grip: tuple = ("chrome", "bar"),
    top: str = "stone",
) -> Iterator[Solid]:
    """Doors, or drawers, or a drawer above doors."""
    yield from _body(width)
    high, x = WORKTOP - 0.15, 0.003 - width / 2
    if rows == 1:
        yield from drawers("paint", width - 0.006, 0.16, (x, WORKTOP - 0.205, FACE), count, 1, style, grip)
        yield from doors("paint", width - 0.006, high - 0.165, (x, 0.105, FACE), count, style, grip, 0.8)
    elif rows:
        yield from drawers("paint", width - 0.006, high, (x, 0.105, FACE), 1, rows, style, grip, True)
    else:
        yield from doors("paint", width - 0.006, high, (x, 0.105, FACE), count, style, grip, 0.85)
    yield _worktop(width, top)


def open_unit(width: float = 0.4) -> Iterator[Solid]:
    """Open shelves with bowls and jars."""
    yield box("black", (width, 0.1, DEPTH - 0.12), (0.0, 0.0, -0.05))
    yield from case("wood", width, WORKTOP - 0.14, DEPTH - 0.04, (0.24, 0.48), (0.0, 0.1, -0.02), (), "wood")
    for k, y in enumerate((0.12, 0.36, 0.6)):
        for i in range(2):
            yield vessel(
                f"glaze_{k}", [(0.04, 0.0), (0.075, 0.05), (0.08, 0.07)], 0.005, ((i - 0.5) * 0.17, y, 0.12), 14, 2
            )
    yield _worktop(width)


def curtained(width: float = 0.8) -> Iterator[Solid]:
    """A curtain on a rod instead of doors."""
    yield box("black", (width, 0.1, DEPTH - 0.12), (0.0, 0.0, -0.05))
    yield from case("paint", width, WORKTOP - 0.14, DEPTH - 0.06, (0.36,), (0.0, 0.1, -0.03), (), "paint")
    yield rod("chrome", (-width / 2, WORKTOP - 0.08, FACE + 0.01), (width / 2, WORKTOP - 0.08, FACE + 0.01), 0.007)
    yield surface(
        "patterned",
        lambda u, v: ((u - 0.5) * (width - 0.03), 0.1 + (WORKTOP - 0.18) * v, FACE + 0.012 + 0.014 * np.sin(34 * u)),
        60,
        2,
        0.005,
    )
    yield _worktop(width, "wood")


def island(width: float = 1.4, depth: float = 0.9) -> Iterator[Solid]:
    """Panels all around, an overhanging top to sit at, a towel rail."""
    yield box("black", (width - 0.1, 0.1, depth - 0.4))
    yield box("paint", (width - 0.06, WORKTOP - 0.14, depth - 0.36), (0.0, 0.1, 0.0))
    yield rounded("stone", (width, 0.045, depth), (0.0, WORKTOP - 0.04, 0.05), 0.01, 2)
    yield from drawers(
        "paint",
        width - 0.07,
        WORKTOP - 0.16,
        (0.035 - width / 2, 0.11, (depth - 0.36) / 2),
        3,
        2,
        "shaker",
        ("brass", "cup"),
    )
    for s in (-1, 1):
        yield rounded("wood", (0.06, WORKTOP - 0.04, 0.06), (s * (width / 2 - 0.06), 0.0, depth / 2), 0.008, 1)
        yield rod("brass", (s * (width / 2 - 0.02), 0.7, -0.2), (s * (width / 2 - 0.02), 0.7, 0.2), 0.008)


def hanging(
    width: float = 0.6, height: float = 0.68, style: str = "flat", count: int = 1, grip: tuple = ("chrome", "bar")
) -> Iterator[Solid]:
    """A wall cabinet with doors."""
    yield rounded("paint", (width, height, 0.32), (0.0, 0.0, -0.01), 0.006, 1)
    if style == "glass":
        for y in (0.02, height / 2):
            for i in range(3):
                yield cylinder(f"crockery_{i}", 0.045, 0.09, ((i - 1) * width / 4, y, 0.16), sides=14)
    yield from doors(
        "paint",
        width - 0.006,
        height - 0.006,
        (0.003 - width / 2, 0.003, 0.15 + 0.06 * (style == "glass")),
        count,
        style,
        grip,
        0.15,
    )
    if style == "glass":
        for s in (-1, 1):
            yield box("paint", (0.02, height, 0.06), (s * (width / 2 - 0.01), 0.0, 0.18))
        yield box("paint", (width, 0.02, 0.06), (0.0, 0.0, 0.18))
        yield box("paint", (width, 0.02, 0.06), (0.0, height - 0.02, 0.18))


def hanging_open(width: float = 0.6, height: float = 0.68) -> Iterator[Solid]:
    """Open wall shelves with crockery, and hooks with cups below."""
    yield from case("wood", width, height - 0.08, 0.32, (0.3,), (0.0, 0.08, 0.0), (), "wood")
    for i in range(7):
        yield disc("crockery", 0.1, 0.01, (-0.2 + 0.03 * i, 0.205, -0.05 + 0.02 * i), 18)
    for i in range(3):
        yield turned(
            "glaze", [(0.04, 0.0), (0.05, 0.1), (0.045, 0.14), (0.02, 0.16)], (-0.18 + 0.18 * i, 0.4, 0.02), 14, 2
        )
        yield vessel(
            "crockery_1", [(0.03, 0.0), (0.038, 0.04), (0.036, 0.075)], 0.004, (-0.18 + 0.18 * i, 0.0, 0.08), 12, 2
        )
        yield ring("crockery_1", 0.02, 0.008, (-0.18 + 0.18 * i, 0.06, 0.122), 0, 10)


def corner_hanging(height: float = 0.68) -> Iterator[Solid]:
    """A five-sided wall cabinet for a corner."""
    outline = [(-0.3, -0.3), (0.3, -0.3), (0.3, 0.0), (0.0, 0.3), (-0.3, 0.3)]
    yield prism("paint", outline, height, (0.0, 0.0, 0.0), "top")
    yield beam("paint", (0.29, height / 2, 0.03), (0.03, height / 2, 0.29), 0.02, height - 0.02)
    yield rod("chrome", (0.185, 0.06, 0.175), (0.185, 0.2, 0.175), 0.006)


def flap(width: float = 0.9, height: float = 0.4) -> Iterator[Solid]:
    """A wide low wall cabinet whose front lifts."""
    yield rounded("paint", (width, height, 0.32), (0.0, 0.0, -0.01), 0.006, 1)
    yield from front(
        "paint",
        (width - 0.006, height - 0.006),
        (0.003 - width / 2, 0.003, 0.15),
        "flat",
        ("chrome", "bar", 0.5, 0.12),
        False,
    )


def tap(x: float, y: float, z: float, kind: str = "arc") -> Iterator[Solid]:
    """A mixer tap that reaches forward."""
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
        yield rounded("chrome", (0.03, 0.022, 0.15), (x, y + 0.09, z + 0.06), 0.008, 1)
        yield rounded("chrome", (0.02, 0.012, 0.09), (x, y + 0.132, z + 0.02), 0.005, 1)


def basin(
    slot: str, width: float, depth: float, deep: float, at: tuple[float, float, float], rim: float = 0.025
) -> Iterator[Solid]:
    """An open box whose rim is at `at` (the middle of its opening) [m]."""
    x, y, z = at
    yield box(slot, (width, 0.01, depth), (x, y - deep, z))
    for s in (-1, 1):
        yield rounded(slot, (rim, deep + 0.006, depth + 2 * rim), (x + s * (width + rim) / 2, y - deep, z), 0.006, 1)
        yield rounded(slot, (width, deep + 0.006, rim), (x, y - deep, z + s * (depth + rim) / 2), 0.006, 1)
    yield cylinder("chrome", 0.03, 0.006, (x, y - deep + 0.008, z), sides=14)


def _frame_top(width: float, hole: tuple[float, float], x: float, slot: str) -> Iterator[Solid]:
    """A worktop around a hole whose middle is at x."""
    y, (w, d) = WORKTOP - 0.04, hole
    left, right = x - w / 2 + width / 2, width / 2 - x - w / 2
    yield rounded(slot, (left, 0.04, DEPTH), (left / 2 - width / 2, y, 0.0), 0.006, 1)
    yield rounded(slot, (right, 0.04, DEPTH), (width / 2 - right / 2, y, 0.0), 0.006, 1)
    for s in (-1, 1):
        yield rounded(slot, (w, 0.04, (DEPTH - d) / 2), (x, y, s * (DEPTH + d) / 4), 0.006, 1)


def _hollow_body(width: float) -> Iterator[Solid]:
    yield box("black", (width, 0.1, DEPTH - 0.12), (0.0, 0.0, -0.05))
    for s in (-1, 1):
        yield box("paint", (BOARD, WORKTOP - 0.14, DEPTH - 0.04), (s * (width - BOARD) / 2, 0.1, -0.02))
    yield box("paint", (width, WORKTOP - 0.14, BOARD), (0.0, 0.1, BOARD - DEPTH / 2 + 0.01))
    yield box("paint", (width - 2 * BOARD, BOARD, DEPTH - 0.06), (0.0, 0.1, -0.01))
    yield box("paint", (width - 2 * BOARD, 0.1, BOARD), (0.0, WORKTOP - 0.14, FACE - BOARD / 2))


def sink_unit(width: float = 0.8, bowls: int = 1, kind: str = "arc", slot: str = "steel") -> Iterator[Solid]:
    """One or two bowls under a worktop, a tap, doors."""
    yield from _hollow_body(width)
    wide = width - 0.2
    yield from _frame_top(width, (wide, 0.42), 0.0, "stone")
    for i in range(bowls):
        step = wide / bowls
        yield from basin(slot, step - 0.06, 0.36, 0.16, ((i - (bowls - 1) / 2) * step, WORKTOP - 0.004, 0.0))
    yield from tap(0.0, WORKTOP, -0.24, kind)
    yield from doors(
        "paint",
        width - 0.006,
        WORKTOP - 0.15,
        (0.003 - width / 2, 0.105, FACE),
        2,
        "flat" if bowls == 1 else "shaker",
        ("chrome", "bar"),
        0.85,
    )


def farmhouse_sink(width: float = 0.8) -> Iterator[Solid]:
    """A deep white bowl with a front of its own, under a bridge tap."""
    yield box("black", (width, 0.1, DEPTH - 0.12), (0.0, 0.0, -0.05))
    yield box("paint", (width, 0.5, DEPTH - 0.04), (0.0, 0.1, -0.02))
    yield from doors(
        "paint", width - 0.006, 0.49, (0.003 - width / 2, 0.105, FACE), 2, "shaker", ("brass", "knob"), 0.85
    )
    yield box("stone", (width, 0.04, 0.14), (0.0, WORKTOP - 0.04, -0.23))
    yield box("paint", (width, WORKTOP - 0.64, 0.1), (0.0, 0.6, -0.25))
    yield from basin("ceramic", width - 0.1, 0.38, 0.24, (0.0, WORKTOP - 0.006, 0.075), 0.045)
    yield from tap(0.0, WORKTOP, -0.22, "bridge")


def drainer_sink(width: float = 1.0) -> Iterator[Solid]:
    """A bowl beside a ribbed drainer of pressed steel."""
    yield from _hollow_body(width)
    yield from _frame_top(width, (0.42, 0.42), -0.22, "steel")
    yield from basin("steel", 0.36, 0.36, 0.17, (-0.22, WORKTOP - 0.002, 0.0))
    for i in range(8):
        yield rounded("steel", (0.36, 0.008, 0.018), (0.24, WORKTOP - 0.003, -0.19 + 0.054 * i), 0.004, 1)
    yield from tap(-0.22, WORKTOP, -0.24, "lever")
    yield from doors(
        "paint", width - 0.006, WORKTOP - 0.15, (0.003 - width / 2, 0.105, FACE), 2, "flat", ("chrome", "bar"), 0.85
    )


def _burner(x: float, z: float, radius: float, gas: bool) -> Iterator[Solid]:
    if gas:
        yield turned(
            "iron", [(radius * 0.5, 0.0), (radius * 0.5, 0.012), (radius * 0.3, 0.018)], (x, WORKTOP, z), 14, 1
        )
        for a in range(4):
            c, s = np.cos(a * np.pi / 2), np.sin(a * np.pi / 2)
            yield beam(
                "iron",
                (x + 0.03 * c, WORKTOP + 0.026, z + 0.03 * s),
                (x + 0.11 * c, WORKTOP + 0.026, z + 0.11 * s),
                0.008,
            )
        yield ring("iron", 0.1, 0.009, (x, WORKTOP + 0.02, z), 1, 16)
    else:
        yield ring("gray", radius, 0.004, (x, WORKTOP + 0.0012, z), 1, 24)
        yield ring("gray", 0.6 * radius, 0.004, (x, WORKTOP + 0.0012, z), 1, 20)


def cooker(width: float = 0.6, gas: bool = False, doors_: int = 1, slot: str = "steel") -> Iterator[Solid]:
    """A hob above one or two ovens with glass doors and knobs."""
    yield box("black", (width - 0.02, 0.08, DEPTH - 0.1), (0.0, 0.0, -0.05))
    yield box(slot, (width, WORKTOP - 0.1, DEPTH - 0.04), (0.0, 0.08, -0.02))
    yield rounded("screen" if not gas else slot, (width, 0.02, DEPTH - 0.01), (0.0, WORKTOP - 0.02, 0.0), 0.004, 1)
    wide = width / doors_
    for i in range(doors_):
        x = (i - (doors_ - 1) / 2) * wide
        yield rounded(slot, (wide - 0.03, 0.56, 0.035), (x, 0.12, DEPTH / 2 - 0.035), 0.008, 1)
        yield box("screen", (wide - 0.14, 0.32, 0.006), (x, 0.22, DEPTH / 2 - 0.017))
        yield rod(
            "chrome",
            (x - wide / 2 + 0.06, 0.63, DEPTH / 2 + 0.025),
            (x + wide / 2 - 0.06, 0.63, DEPTH / 2 + 0.025),
            0.01,
        )
        for s in (-1, 1):
            yield rod(
                "chrome",
                (x + s * (wide / 2 - 0.08), 0.63, DEPTH / 2 - 0.02),
                (x + s * (wide / 2 - 0.08), 0.63, DEPTH / 2 + 0.02),
                0.007,
            )
    count = 5 if width < 0.8 else 7
    for i in range(count):
        yield disc("black", 0.02, 0.03, ((i - (count - 1) / 2) * width / (count + 1.5), 0.77, DEPTH / 2 - 0.04), 14)
    for i in range(4 if width < 0.8 else 6):
        yield from _burner(
            (i // 2 - (0.5 if width < 0.8 else 1.0)) * 0.27,
            (i % 2 - 0.5) * 0.25,
            0.085 - 0.02 * ((i * 3) % 4 == 2),
            gas,
        )


def oven_column(width: float = 0.6, height: float = 2.1) -> Iterator[Solid]:
    """A tall unit with an oven and a microwave at hand height."""
    yield box("black", (width, 0.1, DEPTH - 0.12), (0.0, 0.0, -0.05))
    yield box("paint", (width, height - 0.1, DEPTH - 0.04), (0.0, 0.1, -0.02))
    yield from doors("paint", width - 0.006, 0.6, (0.003 - width / 2, 0.105, FACE), 1, "flat", ("chrome", "bar"), 0.85)
    yield from doors(
        "paint", width - 0.006, height - 1.75, (0.003 - width / 2, 1.74, FACE), 1, "flat", ("chrome", "bar"), 0.2
    )
    for y, high in ((0.73, 0.58), (1.33, 0.39)):
        yield rounded("steel", (width - 0.01, high, 0.03), (0.0, y, FACE + 0.012), 0.006, 1)
        yield box("screen", (width - 0.1, 0.62 * high, 0.006), (0.0, y + 0.05, FACE + 0.027))
        yield rod("chrome", (-0.22, y + 0.78 * high, FACE + 0.06), (0.22, y + 0.78 * high, FACE + 0.06), 0.009)
        yield box("screen", (0.16, 0.04, 0.004), (0.0, y + 0.87 * high, FACE + 0.027))


def range_stove(width: float = 1.0) -> Iterator[Solid]:
    """A cast range with four doors, lidded plates and a rail."""
    yield rounded("glaze", (width, 0.78, DEPTH), (0.0, 0.06, 0.0), 0.015, 2)
    yield box("black", (width - 0.06, 0.06, DEPTH - 0.06))
    yield rounded("glaze", (width + 0.02, 0.045, DEPTH + 0.02), (0.0, WORKTOP - 0.045, 0.0), 0.015, 2)
    for i in range(2):
        for j in range(2):
            yield rounded(
                "glaze",
                (width / 2 - 0.06, 0.31, 0.03),
                ((i - 0.5) * width / 2, 0.12 + 0.36 * j, DEPTH / 2 + 0.005),
                0.012,
                1,
            )
            yield rounded("chrome", (0.03, 0.02, 0.03), ((i - 0.5) * 0.16, 0.27 + 0.36 * j, DEPTH / 2 + 0.03), 0.006, 1)
    for x in (-0.24, 0.24):
        yield turned("chrome", [(0.18, 0.0), (0.18, 0.02), (0.12, 0.06), (0.02, 0.07)], (x, WORKTOP, 0.0), 24, 2)
        yield tube(
            "iron",
            fillet(
                [
                    (x - 0.04, WORKTOP + 0.06, 0.0),
                    (x - 0.04, WORKTOP + 0.11, 0.0),
                    (x + 0.04, WORKTOP + 0.11, 0.0),
                    (x + 0.04, WORKTOP + 0.06, 0.0),
                ],
                0.02,
            ),
            0.007,
            6,
        )
    yield rod("chrome", (-width / 2, 0.82, DEPTH / 2 + 0.06), (width / 2, 0.82, DEPTH / 2 + 0.06), 0.011)


def _chimney(width: float) -> Iterator[Solid]:
    yield rounded("steel", (width, 0.06, 0.48), (0.0, 0.0, 0.0), 0.006, 1)
    slope = [(-0.24, 0.0), (0.24, 0.0), (0.02, 0.22), (-0.24, 0.22)]
    yield prism("steel", slope, width - 0.1, (0.0, 0.06, 0.0), "side")
    yield rounded("steel", (0.28, 0.5, 0.26), (0.0, 0.27, -0.11), 0.004, 1)
    yield from _switches(0.0, 0.03, 0.24)


def _glass(width: float) -> Iterator[Solid]:
    yield prism(
        "glass",
        [(width / 2 * np.cos(a), -0.24 + 0.48 * np.sin(a)) for a in np.linspace(0, np.pi, 16)],
        0.012,
        (0.0, 0.04, 0.0),
        "top",
    )
    yield rounded("steel", (width - 0.12, 0.05, 0.3), (0.0, 0.0, -0.09), 0.008, 1)
    yield cylinder("steel", 0.12, 0.6, (0.0, 0.05, -0.12), sides=20)


def _slanted(width: float) -> Iterator[Solid]:
    plate = [(-0.2, 0.0), (-0.16, 0.0), (0.2, 0.48), (0.2, 0.52), (-0.2, 0.52)]
    yield prism("black", plate, width, (0.0, 0.0, 0.0), "side")
    yield beam("screen", (0.0, 0.05, -0.115), (0.0, 0.45, 0.185), width - 0.05, 0.012)
    yield rounded("black", (0.26, 0.4, 0.22), (0.0, 0.5, -0.09), 0.004, 1)
    yield from _switches(0.0, 0.5, 0.2)


def _box(width: float) -> Iterator[Solid]:
    yield rounded("steel", (width, 0.13, 0.46), (0.0, 0.0, 0.0), 0.012, 1)
    yield box("black", (width - 0.06, 0.006, 0.3), (0.0, -0.004, 0.02))
    yield box("chrome", (0.3, 0.03, 0.02), (0.0, 0.05, 0.235))
    yield from _switches(0.0, 0.065, 0.242)


def _mantel(width: float) -> Iterator[Solid]:
    yield prism(
        "paint",
        [(-0.25, 0.0), (0.25, 0.0), (0.24, 0.12), (-0.02, 0.5), (-0.02, 0.9), (-0.25, 0.9)],
        width,
        (0.0, 0.0, 0.0),
        "side",
    )
    yield rounded("wood", (width + 0.04, 0.05, 0.54), (0.0, 0.02, 0.0), 0.012, 1)
    yield rounded("wood", (width + 0.02, 0.04, 0.28), (0.0, 0.5, -0.11), 0.012, 1)
    for i in range(5):
        yield rod("chrome", ((i - 2) * 0.16, 0.045, 0.27), ((i - 2) * 0.16, 0.045, 0.3), 0.006)


_HOOD_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "chimney": _chimney,
    "glass": _glass,
    "slanted": _slanted,
    "box": _box,
    "mantel": _mantel,
}


def hood(width: float = 0.6, kind: str = "chimney") -> Iterator[Solid]:
    """Collects vapour above a cooker."""
    yield from _HOOD_KINDS[kind](width)


def _switches(x: float, y: float, z: float) -> Iterator[Solid]:
    for i in range(4):
        yield disc("chrome", 0.01, 0.01, (x + 0.04 * (i - 1.5), y, z), 12)


def pantry(width: float = 0.6, height: float = 2.1, style: str = "shaker") -> Iterator[Solid]:
    """A tall cupboard of the depth of a kitchen."""
    yield box("black", (width, 0.1, DEPTH - 0.12), (0.0, 0.0, -0.05))
    yield box("paint", (width, height - 0.1, DEPTH - 0.04), (0.0, 0.1, -0.02))
    yield from doors("paint", width - 0.006, 1.2, (0.003 - width / 2, 0.105, FACE), 1, style, ("brass", "bar"), 0.8)
    yield from doors(
        "paint", width - 0.006, height - 1.32, (0.003 - width / 2, 1.31, FACE), 1, style, ("brass", "bar"), 0.2
    )


BASES = (
    design(base_unit), design(base_unit, width=0.8, count=2, style="shaker", grip=("brass", "knob"), top="wood"),
    design(base_unit, rows=3), design(base_unit, rows=1, style="shaker", grip=("black", "cup")), design(open_unit),
    design(curtained), design(island), design(pantry), design(base_unit, width=0.4),
    design(base_unit, width=0.8, rows=1, count=2, style="raised", grip=("brass", "ring")),
    design(base_unit, width=0.6, style="grooves", grip=("black", "slot")),
    design(base_unit, width=0.8, rows=4, grip=("black", "bar"), top="wood"),
)  # fmt: skip
WALL = (
    design(hanging), design(hanging, width=0.8, count=2, style="shaker", grip=("brass", "knob")),
    design(hanging, width=0.8, count=2, style="glass"), design(hanging_open), design(corner_hanging), design(flap),
    design(hanging, width=0.4, style="raised", grip=("brass", "knob")),
    design(hanging, width=0.6, style="grooves", grip=("black", "slot")),
)  # fmt: skip
SINKS = (
    design(sink_unit),
    design(sink_unit, width=1.0, bowls=2, kind="lever"),
    design(farmhouse_sink),
    design(drainer_sink),
    design(sink_unit, slot="ceramic", kind="bridge"),
)
COOKERS = (
    design(cooker),
    design(cooker, gas=True),
    design(oven_column),
    design(range_stove),
    design(cooker, gas=True, width=0.9, doors_=2),
    design(cooker, slot="white"),
)
HOODS = (
    design(hood),
    design(hood, kind="glass"),
    design(hood, kind="slanted"),
    design(hood, kind="box"),
    design(hood, kind="mantel", width=0.9),
)

FAMILIES = (
    Family("kitchen_cabinet", "kitchen_cabinet", BASES),
    Family("hanging_cabinet", "hanging_kitchen_cabinet", WALL),
    Family("kitchen_sink", "sink", SINKS),
    Family("cooker", "range_oven", COOKERS),
    Family("range_hood", "range_hood", HOODS),
)
