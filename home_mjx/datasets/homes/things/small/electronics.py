"""Screens, sound, computers, telephones, and household machines."""

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from home_mjx.datasets.homes.shapes.curves import fillet, spline
from home_mjx.datasets.homes.shapes.groups import around
from home_mjx.datasets.homes.shapes.soft import ball, rounded, soft
from home_mjx.datasets.homes.shapes.swept import beam, prism, ring, rod, tube
from home_mjx.datasets.homes.shapes.turned import turned
from home_mjx.datasets.homes.things.family import Family, design
from home_mjx.datasets.homes.things.joinery import disc
from home_mjx.datasets.procedural.primitives.solids import Solid, box, cylinder, move, rotate


def television(width: float = 1.1, kind: str = "feet") -> Iterator[Solid]:
    """A flat screen on two feet, on a plate, for a wall, curved, or an old tube set."""
    if kind == "tube":
        yield rounded("black", (0.6, 0.48, 0.16), (0.0, 0.02, 0.14), 0.03, 2)
        yield prism("black", [(0.08, 0.04), (0.08, 0.48), (-0.22, 0.4), (-0.22, 0.08)], 0.5, (0.0, 0.0, 0.0), "side")
        yield soft("screen", (0.48, 0.36, 0.03), (0.0, 0.1, 0.205), 8.0, 5)
        for i in range(4):
            yield disc("gray", 0.012, 0.01, (0.12 + 0.035 * i, 0.055, 0.219), 12)
        for s in (-1, 1):
            yield rod("chrome", (0.0, 0.48, 0.0), (s * 0.22, 0.85, -0.05), 0.003, sides=5)
        yield rounded("black", (0.1, 0.03, 0.08), (0.0, 0.49, 0.0), 0.012, 1)
        return
    high, low = width * 9 / 16, 0.0 if kind == "wall" else 0.08
    yield rounded("black", (width, high, 0.03), (0.0, low, 0.0), 0.008, 2)
    yield box("screen", (width - 0.02, high - 0.02, 0.004), (0.0, low + 0.01, 0.014))
    yield rounded("black", (0.6 * width, 0.5 * high, 0.04), (0.0, low + 0.1 * high, -0.025), 0.012, 1)
    if kind == "feet":
        for s in (-1, 1):
            yield beam("black", (s * 0.34 * width, 0.012, -0.11), (s * 0.34 * width, 0.012, 0.11), 0.022, 0.02)
            yield beam("black", (s * 0.34 * width, 0.015, 0.0), (s * 0.34 * width, low + 0.02, 0.0), 0.022)
    elif kind == "plate":
        yield rounded("chrome", (0.42 * width, 0.014, 0.24), (0.0, 0.0, 0.0), 0.005, 1)
        yield rounded("chrome", (0.07, 0.1, 0.03), (0.0, 0.01, -0.015), 0.008, 1)
    else:
        yield box("iron", (0.3, 0.3, 0.02), (0.0, low + 0.3 * high, -0.055))


def laptop(open_: float = 1.85, width: float = 0.34) -> Iterator[Solid]:
    """An open laptop with keys."""
    deep = 0.66 * width
    yield rounded("gray", (width, 0.014, deep), (0.0, 0.0, 0.0), 0.005, 2)
    for row in range(5):
        for i in range(12):
            yield box(
                "black", (0.062 * width, 0.003, 0.016), ((i - 5.5) * 0.073 * width, 0.013, -0.34 * deep + 0.021 * row)
            )
    yield rounded("steel", (0.1, 0.002, 0.06), (0.0, 0.0135, 0.28 * deep), 0.001, 1)
    hinge = (0.0, 0.012, -deep / 2 + 0.004)
    lid = [
        rounded("gray", (width, 0.008, deep), (0.0, 0.012, 0.0), 0.003, 1),
        box("screen", (0.94 * width, 0.002, 0.88 * deep), (0.0, 0.0105, 0.0)),
    ]
    yield from (rotate(p, 0, -open_, hinge) for p in lid)


def computer(kind: str = "desk") -> Iterator[Solid]:
    """A screen with keyboard and mouse, one of a piece, or a tower."""
    if kind == "tower":
        yield rounded("black", (0.2, 0.44, 0.44), (0.0, 0.01, 0.0), 0.012, 1)
        yield box("glass", (0.004, 0.36, 0.36), (0.102, 0.05, 0.0))
        yield box("gray", (0.16, 0.05, 0.01), (0.0, 0.36, 0.217))
        for i in range(2):
            yield ring("blue", 0.06, 0.01, (0.0, 0.12 + 0.14 * i, 0.222), 2, 22)
        yield disc("chrome", 0.012, 0.01, (0.06, 0.42, 0.216), 12)
        return
    yield rounded("steel" if kind == "all" else "black", (0.56, 0.34, 0.03), (0.0, 0.13, -0.06), 0.01, 2)
    yield box("screen", (0.53, 0.3, 0.004), (0.0, 0.16 if kind == "all" else 0.15, -0.046))
    yield beam("steel" if kind == "all" else "black", (0.0, 0.01, -0.12), (0.0, 0.22, -0.08), 0.08, 0.012)
    yield rounded("steel" if kind == "all" else "black", (0.22, 0.012, 0.18), (0.0, 0.0, -0.1), 0.005, 1)
    yield rounded("white" if kind == "all" else "black", (0.42, 0.014, 0.13), (-0.03, 0.0, 0.13), 0.005, 1)
    for row in range(4):
        for i in range(14):
            yield box("gray", (0.022, 0.004, 0.02), ((i - 6.5) * 0.028 - 0.03, 0.013, 0.09 + 0.027 * row))
    yield soft("white" if kind == "all" else "black", (0.06, 0.03, 0.1), (0.24, 0.0, 0.13), 3.0, 5)


def _cone(r: float, x: float, y: float, z: float) -> Iterator[Solid]:
    yield ring("gray", r, 0.014, (x, y, z), 2, 24)
    yield disc("black", 0.96 * r, 0.006, (x, y, z - 0.004), 24)
    yield ball("gray", (0.3 * r, 0.3 * r, 0.02), (x, y, z), 12, 6)


def _box_speaker(kind: str) -> Iterator[Solid]:
    wide, high, deep = (0.2, 0.95, 0.28) if kind == "tower" else (0.17, 0.28, 0.2)
    yield rounded("wood", (wide, high, deep), (0.0, 0.02, 0.0), 0.008, 1)
    for k, r in enumerate((0.07, 0.07, 0.035) if kind == "tower" else (0.06, 0.03)):
        y = (0.45, 0.65, 0.83)[k] if kind == "tower" else (0.11, 0.22)[k]
        yield from _cone(r, 0.0, y, deep / 2 + 0.002)
    for x in (-0.4, 0.4):
        yield cylinder("black", 0.012, 0.02, (x * wide, 0.0, 0.3 * deep), sides=10)
        yield cylinder("black", 0.012, 0.02, (x * wide, 0.0, -0.3 * deep), sides=10)


def _sound_bar() -> Iterator[Solid]:
    yield rounded("black", (0.9, 0.06, 0.08), (0.0, 0.006, 0.0), 0.02, 3)
    for i in range(40):
        yield box("gray", (0.003, 0.045, 0.004), (-0.42 + 0.0215 * i, 0.014, 0.039))


def _ball_speaker() -> Iterator[Solid]:
    yield ball("textile", 0.11, (0.0, 0.11, 0.0), 22, 14)
    yield turned("white", [(0.06, 0.0), (0.08, 0.02), (0.06, 0.03)], sides=20, steps=1)
    yield disc("white", 0.05, 0.006, (0.0, 0.11, 0.107), 20)


def _radio() -> Iterator[Solid]:
    yield rounded("wood", (0.34, 0.2, 0.13), (0.0, 0.01, 0.0), 0.025, 3)
    yield rounded("cream", (0.3, 0.16, 0.01), (0.0, 0.03, 0.062), 0.004, 1)
    for i in range(11):
        yield box("brown", (0.006, 0.12, 0.006), (-0.13 + 0.015 * i, 0.05, 0.067))
    for y in (0.07, 0.14):
        yield disc("brass", 0.02, 0.018, (0.1, y, 0.066), 16)
    yield tube(
        "brass",
        fillet([(-0.12, 0.2, 0.0), (-0.12, 0.26, 0.0), (0.12, 0.26, 0.0), (0.12, 0.2, 0.0)], 0.03),
        0.006,
        6,
    )
    yield rod("chrome", (0.15, 0.2, -0.04), (0.24, 0.42, -0.04), 0.002, sides=5)


def _smart_speaker() -> Iterator[Solid]:
    yield turned("gray", [(0.045, 0.0), (0.05, 0.01), (0.05, 0.14), (0.046, 0.15)], sides=24, steps=1)
    yield ring("blue", 0.044, 0.005, (0.0, 0.15, 0.0), 1, 24)
    for k in range(7):
        yield ring("black", 0.0505, 0.003, (0.0, 0.025 + 0.015 * k, 0.0), 1, 24)


_SPEAKER_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "tower": partial(_box_speaker, "tower"),
    "small": partial(_box_speaker, "small"),
    "bar": _sound_bar,
    "ball": _ball_speaker,
    "radio": _radio,
    "smart": _smart_speaker,
}


def speaker(kind: str = "tower") -> Iterator[Solid]:
    """A loudspeaker: tall, small, a bar, a ball, a radio, a smart one."""
    yield from _SPEAKER_KINDS[kind]()


def stereo(kind: str = "rack") -> Iterator[Solid]:
    """A tower of sound machines with a record player, or a turntable."""
    if kind == "rack":
        for i, high in enumerate((0.14, 0.1, 0.12)):
            y = 0.01 + sum((0.15, 0.11, 0.13)[:i])
            yield rounded("black" if i % 2 else "steel", (0.43, high, 0.32), (0.0, y, 0.0), 0.006, 1)
            yield disc("chrome", 0.03, 0.025, (0.14, y + high / 2, 0.16), 20)
            yield box("screen", (0.16, 0.04, 0.004), (-0.06, y + high / 2 - 0.01, 0.16))
            for k in range(5):
                yield disc("gray", 0.007, 0.01, (-0.14 + 0.03 * k, y + 0.02, 0.16), 10)
    base = 0.4 if kind == "rack" else 0.0
    yield rounded("wood", (0.44, 0.08, 0.34), (0.0, base + 0.012, 0.0), 0.01, 1)
    yield cylinder("black", 0.15, 0.012, (-0.04, base + 0.09, 0.0), sides=32)
    for r in (0.145, 0.12, 0.09):
        yield ring("gray", r, 0.001, (-0.04, base + 0.1025, 0.0), 1, 30)
    yield cylinder("red", 0.045, 0.002, (-0.04, base + 0.102, 0.0), sides=20)
    yield cylinder("chrome", 0.02, 0.04, (0.16, base + 0.092, -0.1), sides=14)
    yield tube("chrome", [(0.16, base + 0.125, -0.1), (0.16, base + 0.125, 0.04), (0.08, base + 0.115, 0.1)], 0.005, 6)


def console(kind: str = "upright") -> Iterator[Solid]:
    """A games console with its pad."""
    slot = "black" if kind == "upright" else "white"
    if kind == "upright":
        yield rounded(slot, (0.1, 0.32, 0.22), (0.0, 0.01, 0.0), 0.02, 2)
        yield box("blue", (0.006, 0.26, 0.004), (0.02, 0.04, 0.11))
        yield rounded("gray", (0.14, 0.014, 0.2), (0.0, 0.0, 0.0), 0.006, 1)
    else:
        yield rounded(slot, (0.3, 0.07, 0.24), (0.0, 0.0, 0.0), 0.015, 2)
        yield box("black", (0.16, 0.006, 0.004), (-0.03, 0.035, 0.12))
        yield disc("green", 0.014, 0.004, (0.11, 0.035, 0.118), 16)
    x = 0.17 if kind == "upright" else 0.27
    yield soft("gray", (0.1, 0.035, 0.06), (x, 0.004, 0.05), 4.0, 5)
    for s in (-1, 1):
        yield tube("gray", [(x + s * 0.045, 0.024, 0.05), (x + s * 0.06, 0.016, 0.11)], [0.02, 0.014], 10)
        yield cylinder("black", 0.01, 0.018, (x + s * 0.022, 0.034, 0.062), sides=12)


def _dial_telephone() -> Iterator[Solid]:
    yield turned("bright", [(0.11, 0.0), (0.105, 0.03), (0.06, 0.09), (0.05, 0.1)], sides=20, steps=3)
    yield rotate(cylinder("cream", 0.05, 0.012, (0.0, 0.07, 0.045), sides=24), 0, 0.75, (0.0, 0.07, 0.045))
    for i in range(10):
        a = 0.5 + 0.5 * i
        yield rotate(
            cylinder("black", 0.008, 0.014, (0.036 * np.cos(a), 0.07, 0.045 + 0.036 * np.sin(a)), sides=10),
            0,
            0.75,
            (0.0, 0.07, 0.045),
        )
    yield tube(
        "bright",
        fillet([(-0.12, 0.115, -0.01), (-0.08, 0.15, -0.01), (0.08, 0.15, -0.01), (0.12, 0.115, -0.01)], 0.05, 4),
        0.016,
        10,
    )
    for s in (-1, 1):
        yield ball("bright", (0.032, 0.022, 0.032), (s * 0.115, 0.115, -0.01), 14, 8)


def _cordless() -> Iterator[Solid]:
    yield rounded("black", (0.09, 0.04, 0.1), (0.0, 0.0, 0.0), 0.015, 2)
    handset = [
        rounded("black", (0.05, 0.17, 0.026), (0.0, 0.02, 0.0), 0.012, 3),
        box("tint", (0.034, 0.03, 0.002), (0.0, 0.13, 0.013)),
    ]
    handset += [
        rounded("gray", (0.01, 0.008, 0.004), ((i - 1) * 0.013, 0.055 + 0.016 * j, 0.012), 0.002, 1)
        for i in range(3)
        for j in range(4)
    ]
    yield from (rotate(p, 0, -0.25, (0.0, 0.02, 0.0)) for p in handset)


def _desk_telephone() -> Iterator[Solid]:
    yield prism("black", [(-0.09, 0.0), (0.1, 0.0), (0.1, 0.02), (-0.09, 0.09)], 0.19, (0.0, 0.0, 0.0), "side")
    yield move(rotate(rounded("black", (0.05, 0.045, 0.2), (0.0, 0.0, 0.0), 0.018, 3), 0, 0.35), (-0.06, 0.065, 0.0))
    for i in range(3):
        for j in range(4):
            yield rotate(
                rounded("gray", (0.02, 0.012, 0.016), (0.0 + 0.027 * i, 0.058, -0.005 + 0.022 * j), 0.004, 1),
                0,
                0.35,
                (0.0, 0.058, 0.0),
            )


_TELEPHONE_KINDS: dict[str, Callable[..., Iterator[Solid]]] = {
    "dial": _dial_telephone,
    "cordless": _cordless,
    "desk": _desk_telephone,
}


def telephone(kind: str = "dial") -> Iterator[Solid]:
    """An old telephone with a dial, a cordless one, a desk set."""
    yield from _TELEPHONE_KINDS[kind]()


def slab(kind: str = "phone") -> Iterator[Solid]:
    """A telephone or a tablet lying face up."""
    wide, deep = (0.075, 0.155) if kind == "phone" else (0.19, 0.26)
    yield rounded("black", (wide, 0.008, deep), (0.0, 0.0, 0.0), 0.0035, 3)
    yield rounded("screen", (wide - 0.006, 0.002, deep - 0.014), (0.0, 0.0068, 0.0), 0.0008, 1)
    yield rounded("chrome", (0.002, 0.003, 0.02), (wide / 2, 0.0025, -0.2 * deep), 0.0008, 1)


def vacuum(kind: str = "canister") -> Iterator[Solid]:
    """A vacuum cleaner: on wheels, upright, a robot."""
    if kind == "robot":
        yield turned("black", [(0.16, 0.0), (0.17, 0.015), (0.17, 0.07), (0.155, 0.085)], sides=36, steps=1)
        yield cylinder("gray", 0.13, 0.003, (0.0, 0.084, 0.0), sides=30)
        yield cylinder("black", 0.04, 0.015, (0.0, 0.086, -0.03), sides=20)
        yield disc("green", 0.01, 0.006, (0.0, 0.05, 0.166), 12)
        return
    if kind == "canister":
        yield soft("bright", (0.26, 0.2, 0.38), (0.0, 0.05, 0.0), 3.5, 7)
        for s in (-1, 1):
            wheel = rotate(cylinder("black", 0.09, 0.04, (0.0, -0.02, 0.0), sides=22), 2, np.pi / 2)
            yield move(wheel, (s * 0.13, 0.09, -0.1))
        yield ball("black", 0.025, (0.0, 0.025, 0.14), 10, 6)
        hose = spline([(0.0, 0.17, 0.17), (0.0, 0.4, 0.4), (0.25, 0.6, 0.35), (0.35, 0.85, 0.1)], 6)
        yield tube("gray", hose, 0.02, 10)
        yield rod("chrome", (0.35, 0.85, 0.1), (0.4, 0.06, 0.4), 0.014)
        yield rounded("black", (0.28, 0.05, 0.1), (0.4, 0.0, 0.42), 0.015, 2)
        return
    yield rounded("black", (0.28, 0.07, 0.2), (0.0, 0.0, 0.1), 0.02, 2)
    yield from (
        rotate(p, 0, -0.2, (0.0, 0.05, 0.05))
        for p in (
            rod("bright", (0.0, 0.05, 0.05), (0.0, 0.75, 0.05), 0.02),
            turned("tint", [(0.05, 0.0), (0.055, 0.02), (0.055, 0.2), (0.04, 0.24)], (0.0, 0.75, 0.07), 20, 1),
            tube(
                "bright",
                fillet([(0.0, 0.98, 0.07), (0.0, 1.12, 0.05), (0.0, 1.12, -0.06), (0.0, 0.95, -0.03)], 0.05),
                0.016,
            ),
        )
    )


def ironing() -> Iterator[Solid]:
    """An ironing board on crossed legs."""
    shape = fillet([(-0.6, -0.17), (0.35, -0.17), (0.66, 0.0), (0.35, 0.17), (-0.6, 0.17)], 0.14, 5, True)
    yield prism("patterned", shape, 0.03, (0.0, 0.86, 0.0), "top")
    yield prism("gray", 0.94 * shape, 0.012, (0.0, 0.85, 0.0), "top")
    for s in (-1, 1):
        yield rod("chrome", (s * 0.42, 0.01, -0.13), (-s * 0.3, 0.85, -0.1), 0.011)
        yield rod("chrome", (s * 0.42, 0.01, 0.13), (-s * 0.3, 0.85, 0.1), 0.011)
        yield rod("chrome", (s * 0.42, 0.012, -0.2), (s * 0.42, 0.012, 0.2), 0.012)
    yield rounded("chrome", (0.2, 0.01, 0.24), (-0.7, 0.86, 0.0), 0.004, 1)
    yield from (move(p, (-0.1, 0.89, 0.0)) for p in iron())


def iron() -> Iterator[Solid]:
    """A flat iron."""
    sole = fillet([(-0.12, -0.055), (0.02, -0.055), (0.13, 0.0), (0.02, 0.055), (-0.12, 0.055)], 0.06, 4, True)
    yield prism("steel", sole, 0.012, plane="top")
    for k, (y, size) in enumerate(((0.012, 0.94), (0.03, 0.85), (0.048, 0.7))):
        yield prism("bright", sole * size, 0.02 if k < 2 else 0.014, (0.0, y, 0.0), "top")
    yield tube(
        "bright",
        fillet([(0.06, 0.05, 0.0), (0.03, 0.115, 0.0), (-0.1, 0.115, 0.0), (-0.1, 0.04, 0.0)], 0.05, 4),
        0.014,
        10,
    )
    yield disc("white", 0.015, 0.03, (-0.02, 0.068, -0.015), 14)


def headphones() -> Iterator[Solid]:
    """Headphones on a stand."""
    yield turned("wood", [(0.07, 0.0), (0.065, 0.015), (0.02, 0.02)], sides=20, steps=1)
    yield rod("wood", (0.0, 0.01, 0.0), (0.0, 0.26, 0.0), 0.01)
    yield tube("wood", [(-0.03, 0.262, 0.0), (0.0, 0.27, 0.0), (0.03, 0.262, 0.0)], 0.016, 10)
    yield tube(
        "black",
        [(0.085 * np.cos(a), 0.195 + 0.095 * np.sin(a), 0.0) for a in np.linspace(-0.2, np.pi + 0.2, 16)],
        0.01,
        8,
    )
    for s in (-1, 1):
        cup = turned("black", [(0.036, 0.0), (0.042, 0.01), (0.04, 0.03)], sides=18, steps=2)
        yield move(rotate(cup, 2, s * np.pi / 2), (s * 0.085, 0.165, 0.0))


def camera(kind: str = "camera") -> Iterator[Solid]:
    """A camera, or a tripod with a telescope."""
    if kind == "camera":
        yield rounded("black", (0.13, 0.08, 0.06), (0.0, 0.0, 0.0), 0.015, 2)
        yield prism("black", [(-0.03, 0.08), (0.03, 0.08), (0.02, 0.105), (-0.02, 0.105)], 0.05)
        for r, z, t in ((0.035, 0.028, 0.03), (0.03, 0.058, 0.03)):
            yield disc("black", r, t, (0.0, 0.04, z), 24)
        yield disc("glass", 0.024, 0.004, (0.0, 0.04, 0.086), 20)
        yield cylinder("chrome", 0.012, 0.012, (0.045, 0.08, 0.0), sides=14)
        return
    yield from around([rod("black", (0.0, 0.0, 0.42), (0.0, 0.95, 0.03), 0.013, 0.018)], 3)
    yield cylinder("black", 0.04, 0.09, (0.0, 0.93, 0.0), sides=14)
    for z0, z1, r in ((-0.35, -0.2, 0.018), (-0.2, 0.1, 0.03), (0.1, 0.45, 0.042)):
        yield tube("white", [(0.0, 1.1 + 0.35 * z0, z0), (0.0, 1.1 + 0.35 * z1, z1)], r, 14)
    yield tube("black", [(0.0, 1.257, 0.45), (0.0, 1.275, 0.5)], 0.047, 14)


def _of(build: object, *kinds: str) -> tuple:
    return tuple(design(build, kind=kind) for kind in kinds)  # type: ignore[arg-type]


FAMILIES = (
    Family(
        "television",
        "television",
        (design(television), design(television, kind="plate", width=0.95), design(television, kind="tube")),
    ),
    Family(
        "wall_television", "television", (design(television, kind="wall"), design(television, kind="wall", width=1.4))
    ),
    Family("laptop", "laptop", (design(laptop), design(laptop, open_=2.1, width=0.3))),
    Family("computer", "computer", _of(computer, "desk", "all")),
    Family("computer_tower", "computer", _of(computer, "tower")),
    Family("floor_speaker", "loudspeaker", _of(speaker, "tower")),
    Family("speaker", "loudspeaker", _of(speaker, "small", "bar", "ball", "radio", "smart")),
    Family("stereo_set", "stereo_set", _of(stereo, "rack", "turntable")),
    Family("playstation", "playstation", _of(console, "upright")),
    Family("xbox", "xbox", _of(console, "flat")),
    Family("telephone", "telephone", _of(telephone, "dial", "cordless", "desk")),
    Family("cellphone", "cellphone", _of(slab, "phone")),
    Family("ipad", "ipad", _of(slab, "tablet")),
    Family("vacuum_cleaner", "vacuum_cleaner", _of(vacuum, "canister", "upright", "robot")),
    Family("ironing_board", "ironing_board", (design(ironing),)),
    Family("iron", "iron", (design(iron),)),
    Family("headphones", "headphones_on_stand", (design(headphones),)),
    Family("tripod", "tripod", _of(camera, "telescope")),
)
