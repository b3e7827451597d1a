"""Pans and pots."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve, vessel
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import tube
from home_procgen.things.family import FurnitureFamily, design_kinds


def _frying_pan() -> Iterator[Solid]:
    yield vessel("iron", [(0.11, 0.0), (0.13, 0.01), (0.14, 0.045)], 0.004, sides=28, steps=2)
    yield tube("black", [(0.135, 0.04, 0.0), (0.2, 0.055, 0.0), (0.33, 0.065, 0.0)], [0.008, 0.011, 0.012], 8)


def _cooking_pot() -> Iterator[Solid]:
    yield vessel("steel", [(0.11, 0.0), (0.115, 0.01), (0.115, 0.14)], 0.004, sides=28, steps=1)
    yield revolve("steel", [(0.118, 0.14), (0.11, 0.15), (0.03, 0.168), (0.012, 0.17)], sides=28, steps=1)
    yield revolve("black", [(0.01, 0.17), (0.01, 0.18), (0.022, 0.19), (0.012, 0.2)], sides=14, steps=1)
    for s in (-1, 1):
        yield tube(
            "black",
            fillet(
                [
                    (s * 0.113, 0.11, -0.035),
                    (s * 0.155, 0.115, -0.03),
                    (s * 0.155, 0.115, 0.03),
                    (s * 0.113, 0.11, 0.035),
                ],
                0.02,
            ),
            0.007,
        )


def _wok() -> Iterator[Solid]:
    yield vessel("iron", [(0.04, 0.0), (0.1, 0.02), (0.16, 0.09)], 0.004, sides=28, steps=3)
    yield tube("wood", [(0.155, 0.085, 0.0), (0.2, 0.1, 0.0), (0.31, 0.12, 0.0)], [0.008, 0.012, 0.013], 8)
    yield tube(
        "iron",
        fillet([(-0.155, 0.085, -0.03), (-0.19, 0.1, -0.025), (-0.19, 0.1, 0.025), (-0.155, 0.085, 0.03)], 0.02),
        0.005,
    )


def _casserole() -> Iterator[Solid]:
    yield revolve("bright", [(0.11, 0.0), (0.125, 0.02), (0.13, 0.11)], sides=28, steps=2, stretch=0.8)
    yield revolve(
        "bright", [(0.135, 0.11), (0.13, 0.125), (0.06, 0.145), (0.015, 0.15)], sides=28, steps=2, stretch=0.8
    )
    yield revolve("brass", [(0.01, 0.148), (0.01, 0.16), (0.02, 0.17), (0.01, 0.178)], sides=14, steps=1)
    for s in (-1, 1):
        yield rounded_box("bright", (0.045, 0.018, 0.08), (s * 0.14, 0.085, 0.0), 0.008, 2)


_PAN_KINDS = {
    "frying": _frying_pan,
    "pot": _cooking_pot,
    "wok": _wok,
    "casserole": _casserole,
}


def pan(kind: str = "frying") -> Iterator[Solid]:
    """Build a frying pan, a pot with a lid, a wok or a casserole."""
    yield from _PAN_KINDS[kind]()


FAMILIES = (FurnitureFamily("pan", "pan", design_kinds(pan, "frying", "pot", "wok", "casserole")),)
