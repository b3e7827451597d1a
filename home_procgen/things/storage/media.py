"""TV stands."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box, cylinder
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import prism, rod
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import BOARD_THICKNESS, book_row, corners, drawers, front, legs, open_case


def tv_low(
    width: float = 1.6, height: float = 0.5, depth: float = 0.42, layout: str = "doors", kind: str = "taper"
) -> Iterator[Solid]:
    """Build a low TV stand with doors, drawers, open niches or slats."""
    foot = 0.14 if kind != "plinth" else 0.05
    if kind == "plinth":
        yield box("black", (width - 0.06, foot, depth - 0.08), (0.0, 0.0, -0.02))
    else:
        yield from legs("wood", width - 0.1, depth - 0.04, foot, kind, 0.05)  # type: ignore[arg-type]
    z, high = depth / 2 - BOARD_THICKNESS, height - foot - 0.03
    yield from open_case(
        "wood",
        width,
        height - foot,
        depth,
        (0.5 * high,) if layout == "niches" else (),
        (0.0, foot, 0.0),
        (1 / 3, 2 / 3),
        "wood_1",
    )
    third = width / 3
    if layout == "niches":
        yield rounded_box("black", (0.4, 0.05, 0.26), (0.0, foot + 0.022, 0.0), 0.008, 1)
        yield from book_row(third / 2 + 0.04, foot + 0.022, third - 0.08, 0.14, 0.0, 2)
        yield rounded_box("cane", (third - 0.08, 0.13, 0.3), (-third, foot + 0.022, 0.0), 0.02, 1)
    else:
        style = {"doors": "flat", "slats": "slats", "cane": "cane", "shaker": "shaker"}[layout]
        for i in (0, 2):
            yield from front(
                "wood_1",
                (third - 0.01, high),
                (0.005 - width / 2 + i * third, foot + 0.015, z),
                style,  # type: ignore[arg-type]
                ("brass", "knob", 0.88 if i == 0 else 0.12, 0.5),
                opens="left" if i == 0 else "right",
            )
        yield from drawers(
            "wood_1",
            third - 0.01,
            high / 2,
            (0.005 - third / 2, foot + 0.015 + high / 2, z),
            1,
            1,
            "flat",
            ("brass", "knob"),
        )
        yield rounded_box("black", (0.36, 0.05, 0.26), (0.0, foot + 0.022, 0.0), 0.008, 1)


def media_wall(width: float = 2.2, height: float = 1.9) -> Iterator[Solid]:
    """Build a low TV stand with a shelf tower at each end, with books and a vase, and a bridge above."""
    yield from tv_low(width, 0.48, 0.42, "doors", "plinth")
    for s in (-1, 1):
        yield from open_case(
            "wood", 0.42, height - 0.48, 0.32, (0.36, 0.72, 1.06), (s * (width / 2 - 0.21), 0.48, -0.05), (), "wood_1"
        )
        yield from book_row(s * (width / 2 - 0.21) - 0.17, 0.86, 0.32, 0.28, -0.05, 4 + s)
        yield revolve(
            "glaze", [(0.04, 0.0), (0.07, 0.06), (0.03, 0.16), (0.04, 0.2)], (s * (width / 2 - 0.21), 0.5, -0.03), 14, 2
        )
    yield box("wood", (width, 0.03, 0.34), (0.0, height, -0.05))


def glass_media(width: float = 1.2) -> Iterator[Solid]:
    """Build three glass shelves on chrome tubes, with two media players."""
    for y in (0.1, 0.3, 0.5):
        yield rounded_box("glass", (width, 0.012, 0.42), (0.0, y, 0.0), 0.004, 1)
    for x, z in corners(width - 0.16, 0.32):
        yield rod("chrome", (x, 0.0, z), (x, 0.52, z), 0.022, sides=12)
    yield rounded_box("black", (0.43, 0.06, 0.28), (-0.2, 0.113, 0.0), 0.008, 1)
    yield rounded_box("black", (0.3, 0.05, 0.24), (0.25, 0.313, 0.0), 0.008, 1)


def corner_tv(width: float = 1.2) -> Iterator[Solid]:
    """Build a five-sided low corner cabinet."""
    outline = [(-0.6, 0.22), (-0.35, -0.26), (0.35, -0.26), (0.6, 0.22), (0.6, 0.28), (-0.6, 0.28)]
    for y, t in ((0.05, 0.03), (0.28, 0.02), (0.5, 0.03)):
        yield prism("wood", outline, t, (0.0, y, 0.0), "top")
    for x, z in ((-0.57, 0.25), (0.57, 0.25), (-0.33, -0.23), (0.33, -0.23)):
        yield rounded_box("wood", (0.05, 0.5, 0.05), (x, 0.0, z), 0.008, 1)
    yield box("wood_1", (0.66, 0.45, 0.015), (0.0, 0.06, -0.245))
    yield rounded_box("black", (0.43, 0.06, 0.28), (0.0, 0.082, 0.02), 0.008, 1)
    yield from front("wood_1", (0.54, 0.19), (-0.55, 0.305, 0.26), "flat", ("chrome", "knob", 0.9, 0.5), opens="left")
    yield from front("wood_1", (0.54, 0.19), (0.01, 0.305, 0.26), "flat", ("chrome", "knob", 0.1, 0.5), opens="right")


def pipe_media(width: float = 1.4) -> Iterator[Solid]:
    """Build two boards on an iron pipe frame, with books and a media player between them."""
    for y in (0.14, 0.46):
        yield rounded_box("wood", (width, 0.04, 0.4), (0.0, y, 0.0), 0.008, 1)
    for x in (-width / 2 + 0.12, 0.0, width / 2 - 0.12):
        for z in (-0.14, 0.14):
            yield rod("iron", (x, 0.0, z), (x, 0.46, z), 0.016, sides=10)
            yield cylinder("iron", 0.035, 0.012, (x, 0.0, z), sides=14)
            yield cylinder("iron", 0.03, 0.012, (x, 0.18, z), sides=12)
    yield rounded_box("black", (0.43, 0.06, 0.28), (0.34, 0.18, 0.0), 0.008, 1)
    yield from book_row(-0.5, 0.18, 0.4, 0.24, 0.0, 12)


def shuttered(width: float = 1.7, height: float = 0.52) -> Iterator[Solid]:
    """Build a round-ended TV stand with sliding slatted shutters on slim legs."""
    foot, deep = 0.18, 0.42
    yield from legs("wood", width - 0.3, deep - 0.08, foot, "taper", 0.04)
    for y in (foot, height - 0.024):
        ends = fillet([(x * width / 2, z * deep / 2) for x, z in ((-1, -1), (1, -1), (1, 1), (-1, 1))], 0.15, 5, True)
        yield prism("wood", ends, 0.024, (0.0, y, 0.0), "top")
    yield box("wood", (width - 0.3, height - foot - 0.04, deep - 0.06), (0.0, foot + 0.02, -0.02))
    count = int((width - 0.3) / 0.036)
    for i in range(count):
        x = (i + 0.5 - count / 2) * 0.036
        yield rod("wood_1", (x, foot + 0.024, 0.2), (x, height - 0.024, 0.2), 0.014, sides=6)
    for x in (-0.06, 0.06):
        yield rounded_box("brass", (0.02, 0.1, 0.016), (x, foot + 0.12, 0.212), 0.006, 1)


def cubes(width: float = 1.2) -> Iterator[Solid]:
    """Build crates of different heights side by side, one with books, one with a basket."""
    third = width / 3
    for i, high in enumerate((0.38, 0.5, 0.38)):
        x = (i - 1) * third
        yield from open_case("wood" if i != 1 else "paint", third - 0.004, high, 0.4, (), (x, 0.03, 0.0), (), "wood_1")
        for s in (-1, 1):
            yield cylinder("black", 0.02, 0.03, (x + s * (third / 2 - 0.05), 0.0, 0.14), sides=12)
            yield cylinder("black", 0.02, 0.03, (x + s * (third / 2 - 0.05), 0.0, -0.14), sides=12)
    yield from book_row(-third * 1.5 + 0.04, 0.052, third - 0.09, 0.26, 0.02, 5)
    yield rounded_box("cane", (third - 0.08, 0.22, 0.32), (third, 0.052, 0.02), 0.03, 2)
    yield rounded_box("black", (third - 0.06, 0.07, 0.28), (0.0, 0.052, 0.02), 0.008, 1)


MEDIA = (
    design(tv_low), design(tv_low, layout="niches", kind="plinth", width=1.4), design(media_wall),
    design(glass_media), design(corner_tv), design(pipe_media),
    design(tv_low, layout="slats", kind="sled", width=1.8), design(tv_low, layout="cane", kind="splay", width=1.5),
    design(tv_low, layout="shaker", kind="block", height=0.6),
    design(tv_low, layout="niches", kind="hairpin", width=1.3), design(shuttered), design(cubes),
)  # fmt: skip


FAMILIES = (FurnitureFamily("tv_stand", "tv_stand", MEDIA),)
