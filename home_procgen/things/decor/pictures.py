"""Pictures in frames, on canvas, on cloth."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from home_procgen.primitives.solids import Solid, box, move, picture_uv, rotate
from home_procgen.shapes.curves import loop
from home_procgen.shapes.rounded import ball, join_loops, rounded_box
from home_procgen.shapes.sweep import beam, prism, rod, tube
from home_procgen.things.family import FurnitureFamily, design


def picture(
    width: float = 0.6, height: float = 0.45, rim: float = 0.03, mount: float = 0.0, slot: str = "wood"
) -> Iterator[Solid]:
    """Build a picture in a moulded frame, with an optional pale mount."""
    inner = rim + mount
    if mount:
        yield box("paper", (width - rim, height - rim, 0.01), (0.0, rim / 2, -0.008))
        yield move(moulding("paper", width - 2 * rim, height - 2 * rim, mount), (0.0, rim, -0.006))
    yield picture_uv(
        box("picture", (width - 2 * inner + 0.002, height - 2 * inner + 0.002, 0.006), (0.0, inner - 0.001, 0.0))
    )
    yield moulding(slot, width, height, rim)


def moulding(slot: str, width: float, height: float, rim: float) -> Solid:
    """Build a mitred frame with a profile of a step at the picture, a hollow and a rounded rim [m]."""
    profile = [(0.0, -0.013), (0.0, 0.004), (0.12, 0.011), (0.3, 0.013), (0.45, 0.009), (0.6, 0.004), (0.75, 0.003)]
    profile += [(0.8, 0.006), (0.94, 0.006), (1.0, 0.002), (1.0, -0.013)]
    corner = np.array([(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)])
    loops = [
        np.insert(corner * (width / 2 - share * rim, height / 2 - share * rim), 1, front, axis=1)
        for share, front in profile
    ]
    flat = join_loops(slot, loops, closed=True)
    return move(rotate(flat, 0, np.pi / 2), (0.0, height / 2, 0.0))


def gallery(count: int = 3) -> Iterator[Solid]:
    """Build a group of pictures."""
    places = {
        3: ((-0.5, 0.0, 0.44, 0.6), (0.0, 0.0, 0.44, 0.6), (0.5, 0.0, 0.44, 0.6)),
        5: (
            (-0.36, 0.3, 0.5, 0.38),
            (0.2, 0.34, 0.44, 0.34),
            (-0.44, 0.0, 0.3, 0.26),
            (-0.02, 0.0, 0.4, 0.28),
            (0.44, 0.0, 0.34, 0.3),
        ),
    }
    for i, (x, y, w, h) in enumerate(places[count]):
        for piece in picture(w, h, 0.022, 0.04 if count == 3 else 0.03 * (i % 2), "black" if count == 3 else "wood"):
            material = f"picture_{i}" if piece.material == "picture" else piece.material
            yield replace(move(piece, (x, y, 0.0)), material=material)


def canvas(width: float = 0.9, height: float = 0.6) -> Iterator[Solid]:
    """Build an unframed canvas."""
    yield rounded_box("paper", (width, height, 0.03), (0.0, 0.0, -0.004), 0.006, 2)
    yield picture_uv(box("picture", (width - 0.006, height - 0.006, 0.006), (0.0, 0.003, 0.01)))
    for s in (-1, 1):
        yield rod("chrome", (s * 0.3, height - 0.02, -0.02), (0.0, height + 0.04, -0.016), 0.0015, sides=4)
    yield ball("chrome", 0.006, (0.0, height + 0.042, -0.014), 8, 4)


def scroll(width: float = 0.45, height: float = 1.1) -> Iterator[Solid]:
    """Build a cloth painting between two rods."""
    yield box("cream", (width, height, 0.004), (0.0, 0.0, -0.004))
    yield picture_uv(box("picture", (width - 0.1, 0.62 * height, 0.004), (0.0, 0.2 * height, 0.0)))
    for y in (0.0, height):
        yield rod("wood", (-width / 2 - 0.03, y, 0.0), (width / 2 + 0.03, y, 0.0), 0.014)
    for s in (-1, 1):
        yield rod("leather", (s * width / 3, height + 0.01, -0.004), (0.0, height + 0.12, -0.008), 0.002, sides=4)


def triptych(width: float = 1.3, height: float = 0.8) -> Iterator[Solid]:
    """Build one picture over three canvases."""
    for i in range(3):
        third = width / 3
        for piece in canvas(third - 0.03, height):
            if piece.material in ("picture", "paper"):
                uv = piece.uv * (1 / 3, 1.0) + np.array([i / 3, 0.0])
                yield replace(move(piece, ((i - 1) * third, 0.0, 0.0)), uv=uv)


def poster(width: float = 0.5, height: float = 0.7) -> Iterator[Solid]:
    """Build a poster that hangs between two pairs of laths."""
    yield picture_uv(box("picture", (width, height, 0.003)))
    for y in (0.0, height):
        for z in (-0.008, 0.008):
            yield rounded_box("wood", (width + 0.02, 0.024, 0.01), (0.0, y - 0.012, z), 0.003, 1)
    for s in (-1, 1):
        yield rod("black", (s * width / 2.2, height + 0.01, 0.0), (0.0, height + 0.14, -0.006), 0.0015, sides=4)


def oval_picture(width: float = 0.4, height: float = 0.5) -> Iterator[Solid]:
    """Build an oval portrait in a gilded frame."""
    flat = prism("picture", loop(width, height, 32), 0.01, (0.0, height / 2, 0.0))
    yield picture_uv(flat)
    for r, t, slot in ((1.0, 0.02, "gold"), (1.1, 0.012, "gold")):
        yield tube(
            slot,
            np.insert(loop(width * r, height * r, 36) + np.array([0.0, height / 2]), 2, 0.004, axis=1),
            t,
            8,
            closed=True,
        )


def easel(width: float = 0.18, height: float = 0.24) -> Iterator[Solid]:
    """Build a small picture frame for a table."""
    frame = list(picture(width, height, 0.02, 0.015))
    yield from (rotate(p, 0, -0.2) for p in frame)
    yield beam("wood", (0.0, 0.15, -0.06), (0.0, 0.0, -0.13), 0.04, 0.006)


PICTURES = (
    design(picture), design(picture, width=0.5, height=0.7, mount=0.06, slot="black"),
    design(picture, width=1.0, height=0.7, rim=0.07, slot="gold"), design(gallery), design(gallery, count=5),
    design(canvas), design(oval_picture), design(picture, width=0.4, height=0.4, mount=0.05),
    design(canvas, width=0.5, height=0.9), design(picture, width=1.2, height=0.5, rim=0.025, slot="white"),
    design(scroll),
    design(triptych), design(poster),
)  # fmt: skip


FAMILIES = (
    FurnitureFamily("picture", "picture_frame", PICTURES),
    FurnitureFamily("photo", "picture_frame", (design(easel), design(easel, width=0.24, height=0.18))),
)
