"""Plant pots."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box, cylinder
from home_procgen.shapes.revolve import vessel
from home_procgen.shapes.rounded import rounded_box
from home_procgen.things.joinery import legs

GOLDEN_ANGLE = 2.399963  # [rad], golden angle between successive leaves


def pot(kind: str = "clay", radius: float = 0.15, height: float = 0.26) -> Iterator[Solid]:
    """Build a pot with soil and its rim at `height` [m]."""
    shapes = {
        "clay": [(0.68, 0.0), (0.9, 0.78), (1.0, 0.8), (1.0, 1.0)],
        "round": [(0.6, 0.0), (1.0, 0.35), (0.98, 0.7), (0.8, 1.0)],
        "cylinder": [(0.92, 0.0), (0.96, 0.05), (0.96, 1.0)],
        "basket": [(0.85, 0.0), (1.0, 0.4), (0.95, 1.0)],
        "urn": [(0.6, 0.0), (0.5, 0.08), (0.35, 0.18), (0.9, 0.6), (0.85, 0.9), (1.0, 1.0)],
    }
    slot = {"clay": "terracotta", "basket": "cane"}.get(kind, "glaze")
    if kind in ("square", "stand"):
        lift = 0.0 if kind == "square" else 0.45 * height
        wall = 0.1 * radius
        for s in (-1, 1):
            yield rounded_box(slot, (wall, height - lift, 1.9 * radius), (s * 0.9 * radius, lift, 0.0), 0.006, 1)
            yield rounded_box(slot, (1.9 * radius, height - lift, wall), (0.0, lift, s * 0.9 * radius), 0.006, 1)
        yield box("soil", (1.75 * radius, 0.85 * (height - lift), 1.75 * radius), (0.0, lift, 0.0))
        if kind == "stand":
            yield from legs("wood", 2.0 * radius, 2.0 * radius, 0.6 * height, "taper", 0.03)
        return
    steps = 1 if kind in ("clay", "cylinder") else 3
    yield vessel(slot, [(r * radius, h * height) for r, h in shapes[kind]], 0.07 * radius, sides=22, steps=steps)
    yield cylinder("soil", 0.8 * radius * min(1.0, shapes[kind][-1][0]), 0.01, (0.0, 0.86 * height, 0.0), sides=18)
