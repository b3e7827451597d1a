"""Light bulbs with their light sources."""

from collections.abc import Iterator

from home_procgen.primitives.family import Bulb
from home_procgen.shapes.groups import Piece
from home_procgen.shapes.revolve import revolve


def bulb(
    y: float, power: float, x: float = 0.0, z: float = 0.0, radius: float = 0.03, light: float | None = None
) -> Iterator[Piece]:
    """Build a bulb at height y; its light source is at height `light`, by default just above it [m]."""
    yield revolve(
        "bulb",
        [
            (0.4 * radius, y - 1.4 * radius),
            (0.9 * radius, y - 0.4 * radius),
            (0.95 * radius, y + 0.2 * radius),
            (0.4 * radius, y + radius),
        ],
        (x, 0.0, z),
        12,
        2,
    )
    yield Bulb((x, y + 1.5 * radius if light is None else light, z), power)
