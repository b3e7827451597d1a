"""Switches and sockets."""

from collections.abc import Callable, Iterator
from functools import partial

from home_procgen.primitives.solids import Solid, box, rotate
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import ring
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.joinery import disc


def _rockers(count: int) -> Iterator[Solid]:
    for i in range(count):
        x = (i - (count - 1) / 2) * 0.071
        yield rounded_box("white", (0.058, 0.062, 0.004), (x, 0.01, 0.003), 0.002, 2)
        tilted = rounded_box("white", (0.05, 0.056, 0.008), (x, 0.013, 0.003), 0.002, 2)
        yield rotate(tilted, 0, 0.06 * (-1) ** i, (x, 0.041, 0.003))
        yield box("blue", (0.006, 0.002, 0.001), (x, 0.018, 0.0085))


def _outlets(count: int, earthed: bool = False) -> Iterator[Solid]:
    for i in range(count):
        x = (i - (count - 1) / 2) * 0.071
        yield ring("white", 0.024, 0.005, (x, 0.041, 0.002), 2, 22)
        yield disc("gray", 0.022, 0.001, (x, 0.041, 0.002), 20)
        for s in (-1, 1):
            yield disc("black", 0.0035, 0.002, (x + s * 0.0095, 0.041, 0.0025), 10)
            if earthed:
                yield box("brass", (0.005, 0.004, 0.004), (x, 0.039 + s * 0.02, 0.002))


def _dimmer() -> Iterator[Solid]:
    yield disc("white", 0.024, 0.02, (0.0, 0.041, 0.001), 26)
    yield box("gray", (0.002, 0.014, 0.001), (0.0, 0.046, 0.021))


def _thermostat() -> Iterator[Solid]:
    yield disc("gray", 0.034, 0.018, (0.0, 0.041, 0.001), 28)
    yield disc("screen", 0.028, 0.002, (0.0, 0.041, 0.018), 26)
    yield box("orange", (0.02, 0.008, 0.001), (0.0, 0.037, 0.02))


def _toggle() -> Iterator[Solid]:
    yield rounded_box("white", (0.014, 0.03, 0.004), (0.0, 0.026, 0.002), 0.002, 1)
    yield rotate(
        rounded_box("white", (0.008, 0.022, 0.01), (0.0, 0.036, 0.004), 0.003, 2), 0, -0.5, (0.0, 0.041, 0.004)
    )
    for y in (0.012, 0.066):
        yield disc("chrome", 0.004, 0.003, (0.0, y + 0.002, 0.002), 12)


def _turning() -> Iterator[Solid]:
    """Build an old-fashioned rotary switch: a round base and a wing knob."""
    yield disc("cream", 0.036, 0.014, (0.0, 0.041, -0.004), 28)
    yield disc("black", 0.014, 0.008, (0.0, 0.041, 0.01), 18)
    yield rotate(rounded_box("black", (0.01, 0.034, 0.02), (0.0, 0.024, 0.02), 0.004, 2), 2, 0.6, (0.0, 0.041, 0.02))


def _touch() -> Iterator[Solid]:
    yield rounded_box("black", (0.08, 0.08, 0.004), (0.0, 0.001, 0.003), 0.0015, 1)
    for x in (-0.018, 0.018):
        for y in (0.024, 0.058):
            yield ring("gray", 0.008, 0.001, (x, y, 0.005), 2, 20)
    yield disc("blue", 0.003, 0.001, (0.0, 0.041, 0.0045), 10)


def _chargers() -> Iterator[Solid]:
    yield from _outlets(1)
    for x in (0.052, 0.064):
        yield box("black", (0.006, 0.014, 0.002), (x, 0.034, 0.0015))


_PLATE_WIDTHS = {"double": 0.15, "sockets": 0.15, "triple": 0.222, "three_sockets": 0.222, "chargers": 0.15}
_KINDS: dict[str, Callable[[], Iterator[Solid]]] = {
    "switch": partial(_rockers, 1), "double": partial(_rockers, 2), "triple": partial(_rockers, 3), "dimmer": _dimmer,
    "thermostat": _thermostat, "toggle": _toggle, "turning": _turning, "touch": _touch,
    "socket": partial(_outlets, 1), "sockets": partial(_outlets, 2), "earthed": partial(_outlets, 1, True),
    "three_sockets": partial(_outlets, 3), "chargers": _chargers,
}  # fmt: skip


def switch(kind: str = "switch") -> Iterator[Solid]:
    """Build switches, a dimmer, a thermostat, or sockets and chargers, on a plate."""
    if kind != "turning":
        yield rounded_box("white", (_PLATE_WIDTHS.get(kind, 0.082), 0.082, 0.01), (0.0, 0.0, -0.003), 0.004, 2)
    yield from _KINDS[kind]()


SWITCHES = ("switch", "double", "dimmer", "thermostat", "triple", "toggle", "turning", "touch")

FAMILIES = (
    FurnitureFamily("switch", "switch", design_kinds(switch, *SWITCHES)),
    FurnitureFamily(
        "socket", "switch", design_kinds(switch, "socket", "sockets", "earthed", "three_sockets", "chargers")
    ),
)
