"""Draw the contact sheets of homes for the docs: plans, every category with its shapes, and both levels of detail.

python scripts/home_pictures.py [--out docs/images] [--first SEED]
"""

import argparse
from collections import defaultdict
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from home_mjx.schema.house import Material
from home_procgen.design import HomeDesign, draw_design
from home_procgen.model_store import library, library_model
from home_procgen.primitives.detail import DETAILS
from home_procgen.primitives.family import FurnitureModel
from home_procgen.textures.recipes import texture

CELL, COLUMNS = 52, 30  # size of an object's image [px], and objects per row
PLAN, PLANS, ACROSS = 180, 48, 8  # size of a plan [px], number of plans, and plans per row
SHARP = 2  # supersampling factor along both axes
DETAIL_FAMILIES = (
    *("chair", "sofa", "double_bed", "plant", "curtain", "bookshelf", "toilet", "cup", "desk", "cooker"),
    *("table_lamp", "dresser", "window", "door", "towel_rack", "office_chair"),
)
DETAIL_CELL, PAIRS = 80, 8  # size of an image [px], and models per row
LIGHT = np.array([0.4, 0.8, 0.45])
FLOORS = ("#e8d9c0", "#d3e2ea", "#dfe8d2", "#ead7d7", "#e2dcea", "#ece6cc")


def color_of(material: Material) -> np.ndarray:
    """Return the mean colour of a material, in sRGB."""
    color = np.array(material.diffuse or (1.0, 1.0, 1.0))
    return color if material.texture is None else color * texture(material.texture.stem).mean(axis=(0, 1)) / 255


def picture_of(model: FurnitureModel, cell: int = CELL) -> Image.Image:
    """Draw a model from above its front, farthest triangles first; `cell` is the size of the image [px]."""
    yaw, pitch, size = -0.55, 0.4, cell * SHARP
    turn = np.array([[np.cos(yaw), 0, np.sin(yaw)], [0, 1, 0], [-np.sin(yaw), 0, np.cos(yaw)]])
    nod = np.array([[1, 0, 0], [0, np.cos(pitch), -np.sin(pitch)], [0, np.sin(pitch), np.cos(pitch)]])
    corners = model.mesh.vertices[model.mesh.faces] @ (nod @ turn).T
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    scale = 0.9 * size / np.ptp(np.stack([low, high])[:, :2], axis=0).max()
    flat = (corners[..., :2] - (low + high)[:2] / 2) * (scale, -scale) + size / 2
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    shade = 0.5 + 0.5 * np.clip(normal @ LIGHT, 0, 1)
    colors = np.stack([color_of(m) for m in model.mesh.materials])[model.mesh.slot] * shade[:, None]
    image = Image.new("RGB", (size, size), "white")
    draw = ImageDraw.Draw(image)
    for k in np.argsort(corners[..., 2].mean(axis=1)).tolist():
        if normal[k, 2] > 0:
            draw.polygon([(x, y) for x, y in flat[k].tolist()], tuple((255 * colors[k]).astype(int).tolist()))
    return image.resize((cell, cell), Image.Resampling.LANCZOS)


def sheet_of_things() -> Image.Image:
    """Draw a sheet with every fine category, its name, and its shapes."""
    shapes: dict[str, list[FurnitureModel]] = defaultdict(list)
    for model in library().values():
        shapes[model.fine].append(model)
    cells = [cell for fine in sorted(shapes) for cell in (fine, *shapes[fine])]
    page = Image.new("RGB", (COLUMNS * CELL, -(-len(cells) // COLUMNS) * CELL), "white")
    draw = ImageDraw.Draw(page)
    for k, cell in enumerate(cells):
        x, y = k % COLUMNS * CELL, k // COLUMNS * CELL
        if isinstance(cell, str):
            draw.rectangle((x, y, x + CELL - 1, y + CELL - 1), "#e9eef2")
            draw.multiline_text((x + 2, y + 4), cell.replace("_", "\n"), "black", font_size=10, spacing=1)
        else:
            page.paste(picture_of(cell), (x, y))
    return page


def sheet_of_details() -> Image.Image:
    """Draw the first two models of some families at full detail and, to its right, at low detail."""
    models = [model_id for family in DETAIL_FAMILIES for model_id in (f"home_{family}_1", f"home_{family}_2")]
    pair = len(DETAILS) * DETAIL_CELL
    page = Image.new("RGB", (PAIRS * pair, -(-len(models) // PAIRS) * DETAIL_CELL), "white")
    for k, model_id in enumerate(models):
        for j, detail in enumerate(DETAILS):
            place = k % PAIRS * pair + j * DETAIL_CELL, k // PAIRS * DETAIL_CELL
            page.paste(picture_of(library_model(model_id, detail), DETAIL_CELL), place)
    return page


def plan_of(design: HomeDesign) -> Image.Image:
    """Draw the lowest storey of a home from above: rooms with their furniture."""
    size = PLAN * SHARP
    image = Image.new("RGB", (size, size), "white")
    draw, level = ImageDraw.Draw(image), design.plan.levels[0]
    corners = np.concatenate([room.polygon for room in level.rooms])
    low, high = corners.min(axis=0), corners.max(axis=0)
    scale, middle = 0.92 * size / (high - low).max(), (low + high) / 2

    def on_page(points: np.ndarray) -> list[tuple[float, float]]:
        return [(float(x), float(y)) for x, y in (points - middle) * scale + size / 2]

    kinds = sorted({room.type for room in level.rooms})
    for room in level.rooms:
        draw.polygon(on_page(room.polygon), FLOORS[kinds.index(room.type) % len(FLOORS)], "black", 3)
    for item, _ in design.objects[0]:
        if item.box[0, 1] < 1.0 and item.model.fine not in ("rug", "switch"):
            (x0, y0), (x1, y1) = on_page(item.box[:, [0, 2]])
            fill = {"window": "white", "door": None}.get(item.model.fine, "#c9b89f")
            draw.rectangle((x0, y0, x1, y1), fill, "#c07830" if fill is None else "#8a7a64")
    for room in level.rooms:
        x0, z0, x1, z1 = max(room.rects, key=lambda rect: rect.extents[0] * rect.extents[1])
        (place,) = on_page(np.array([[(x0 + x1) / 2, (z0 + z1) / 2]]))
        draw.text(place, room.type.replace("_", "\n"), "#202020", font_size=13, anchor="mm", align="center")
    return image.resize((PLAN, PLAN), Image.Resampling.LANCZOS)


def sheet_of_plans(first: int) -> Image.Image:
    """Draw the ground floors of some homes."""
    page = Image.new("RGB", (ACROSS * PLAN, PLANS // ACROSS * PLAN), "white")
    for k in range(PLANS):
        page.paste(plan_of(draw_design(first + k)), (k % ACROSS * PLAN, k // ACROSS * PLAN))
    return page


def main() -> None:
    """Write both sheets."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("docs/images"))
    parser.add_argument("--first", type=int, default=0, help="seed of the first home")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    sheet_of_things().save(args.out / "home_things.jpg", quality=50, optimize=True)
    sheet_of_details().save(args.out / "home_details.jpg", quality=80, optimize=True)
    sheet_of_plans(args.first).quantize(48).save(args.out / "home_plans.png", optimize=True)


if __name__ == "__main__":
    main()
