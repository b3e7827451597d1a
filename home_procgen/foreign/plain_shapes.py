"""Plain shapes of small things that the library of furniture lacks."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from home_mjx.schema.house import Mesh
from home_procgen.primitives.palette import plain
from home_procgen.primitives.solids import box, lathe, to_mesh

# Word of AI2-THOR -> shape and colour.
SHAPES: Mapping[str, tuple[str, str]] = {
    "apple": ("ball", "#b23a32"),
    "baseballbat": ("disc", "#a9763f"),
    "basketball": ("ball", "#c9682c"),
    "butterknife": ("slab", "#b4b8bb"),
    "cd": ("disc", "#c4c6c8"),
    "creditcard": ("slab", "#3f5a8a"),
    "dishsponge": ("slab", "#d8c84a"),
    "dumbbell": ("slab", "#2b2d31"),
    "egg": ("ball", "#efe4d2"),
    "fork": ("slab", "#b4b8bb"),
    "keychain": ("slab", "#8a8e92"),
    "knife": ("slab", "#8a8e92"),
    "ladle": ("slab", "#8c9094"),
    "lettuce": ("ball", "#5f8a46"),
    "pen": ("slab", "#26405c"),
    "pencil": ("slab", "#d9a04a"),
    "potato": ("ball", "#a8804e"),
    "remotecontrol": ("slab", "#1e1f22"),
    "soapbar": ("slab", "#e8e0e4"),
    "spatula": ("slab", "#3a3d40"),
    "spoon": ("slab", "#b4b8bb"),
    "tennisracket": ("disc", "#3f5a8a"),
    "tomato": ("ball", "#c8403a"),
    "watch": ("slab", "#4c463e"),
}
NUM_RINGS, NUM_SIDES = 8, 14


def plain_shape(word: str) -> Mesh:
    """Return a shape of 0.1 m, its base around the origin, in the colour of a thing of `SHAPES`.

    Example:
        >>> np.ptp(plain_shape("apple").vertices, axis=0).round(3).tolist()[1]
        0.1
    """
    kind, color = SHAPES[word]
    if kind == "slab":
        solid = box("color", (0.1, 0.1, 0.1))
    elif kind == "disc":
        solid = lathe("color", [(0.05, 0.0), (0.05, 0.1)], sides=NUM_SIDES)
    else:
        angles = np.linspace(-np.pi / 2, np.pi / 2, NUM_RINGS + 1)
        rings = [(float(0.05 * np.cos(a)), float(0.05 + 0.05 * np.sin(a))) for a in angles]
        solid = lathe("color", rings[1:-1], sides=NUM_SIDES)
    return to_mesh(Path("object") / f"plain_{word}.obj", [solid], ["color"], (plain(color, slot="material_0"),))
