"""Outline of a shoe sole (x, z) [m] with its toe towards +z."""

from home_procgen.shapes.curves import spline

SOLE = spline(
    [
        (0.0, 0.14),
        (0.038, 0.1),
        (0.042, 0.04),
        (0.03, -0.04),
        (0.034, -0.1),
        (0.0, -0.13),
        (-0.03, -0.1),
        (-0.028, -0.04),
        (-0.038, 0.05),
        (-0.034, 0.11),
    ],
    2,
)
