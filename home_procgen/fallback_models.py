"""Meshes that replace missing models: a generator model of the same category, else a box."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np
from jaxtyping import Float

from home_mjx.schema.house import Material, Mesh
from home_procgen.model_store import library
from home_procgen.primitives.family import FurnitureModel
from home_procgen.primitives.palette import FINISHES
from home_procgen.primitives.solids import Solid, box, move, to_mesh
from home_procgen.things.openings.doors import door
from home_procgen.things.openings.leaves import JAMB_WIDTH

Bounds = Float[np.ndarray, "2 3"]
UNKNOWN_BOUNDS = np.array([[-0.25, 0.0, -0.25], [0.25, 0.5, 0.25]])  # [m], box of a model of unknown size and category
NUM_FRAME_SOLIDS = 3  # number of leading solids that form a door's frame
HINGE_OFFSET = 0.07  # [m], depth of the hinge behind the middle of a door
SIMILAR_CATEGORY = {  # fine category -> similar category of the generator
    "amplifier": "loudspeaker",
    "bunker_bed": "single_bed",
    "computer": "laptop",
    "cooker": "range_oven",
    "dishwasher": "washer",
    "dressing_table": "dresser",
    "dryer": "washer",
    "game_table": "dining_table",
    "range_hood_with_cabinet": "range_hood",
    "range_oven_with_hood": "range_oven",
    "stereo_set": "loudspeaker",
    "storage_bench": "bench_chair",
    "table": "dining_table",
    "whiteboard": "picture_frame",
    "workplace": "desk",
}
PLAIN_COLORS = {  # sRGB of finishes that are textured in generated datasets
    "wood": (0.55, 0.4, 0.27),
    "textile": (0.5, 0.52, 0.56),
    "upholstery": (0.5, 0.52, 0.56),
    "linen": (0.85, 0.83, 0.8),
    "carpet": (0.5, 0.45, 0.42),
    "stone": (0.65, 0.64, 0.62),
}
BOX_MATERIAL = Material("material_0", (0.7, 0.7, 0.7), None, 1.0)


def make_fallback_model(path: Path, fine: str, bounds: Bounds | None, closed: bool) -> tuple[Mesh, str]:
    """Return a generator mesh that replaces a missing model, and its description.

    Args:
        path: Path of the missing OBJ file.
        fine: Fine category of the model.
        bounds: Bounding box of the missing model; of a door, in its open state [m, Y up]; None if unknown.
        closed: Whether the mesh shows a door closed.

    Example:
        >>> mesh, words = make_fallback_model(Path("9.obj"), "chair", np.array([[-0.3, 0, -0.3], [0.3, 1, 0.3]]), False)
        >>> words, np.ptp(mesh.vertices, axis=0).round(6).tolist()
        ('a generated chair', [0.6, 1.0, 0.6])
    """
    if fine in ("door", "arch") and bounds is not None:
        return _make_opening(
            path, fine, bounds, closed
        ), f"a generated {'door' if fine == 'door' else 'frame of a door'}"
    models = [model for model in library().values() if model.fine == SIMILAR_CATEGORY.get(fine, fine)]
    target = _default_bounds(models, closed) if bounds is None else bounds
    if not models:
        return _make_box(path, target), f"a box of {_format_size(target)} m"
    model = min(models, key=lambda m: (_stretch_cost(m.size, target), m.id))
    shown = model.closed if closed and model.closed is not None else model.mesh
    return _stretch_to_bounds(path, shown, model, target), f"a generated {model.fine}"


def _default_bounds(models: Sequence[FurnitureModel], closed: bool) -> Bounds:
    if not models:
        return UNKNOWN_BOUNDS
    mesh = models[0].closed if closed and models[0].closed is not None else models[0].mesh
    return np.stack([mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)])


def _format_size(bounds: Bounds) -> str:
    return " x ".join(f"{edge:.2f}" for edge in bounds[1] - bounds[0])


def _stretch_cost(size: Float[np.ndarray, " 3"], bounds: Bounds) -> float:
    """Return the stretch that fits a model into a box: the sum of the absolute logarithms of its factors."""
    return round(float(abs(np.log((bounds[1] - bounds[0]) / size)).sum()), 9)


def _make_box(path: Path, bounds: Bounds) -> Mesh:
    (x0, y0, z0), (x1, y1, z1) = bounds.tolist()
    solid = box("box", (x1 - x0, y1 - y0, z1 - z0), ((x0 + x1) / 2, y0, (z0 + z1) / 2))
    return to_mesh(path, [solid], ["box"], (BOX_MATERIAL,))


def _stretch_to_bounds(path: Path, mesh: Mesh, model: FurnitureModel, bounds: Bounds) -> Mesh:
    """Return a generator's mesh stretched to fill a box, with plain colours instead of textures."""
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    scale = (bounds[1] - bounds[0]) / np.maximum(high - low, 1e-9)
    return replace(
        mesh,
        path=path,
        vertices=bounds[0] + (mesh.vertices - low) * scale,
        materials=_replace_images(mesh.materials, model.slots),
        normal=None,
    )


def _replace_images(materials: Sequence[Material], slots: Mapping[str, str]) -> tuple[Material, ...]:
    """Return the materials without textures, in their finish's plain colour if any; `slots` maps slots to finishes."""
    finishes = zip(materials, slots.values(), strict=True)
    return tuple(replace(m, texture=None, diffuse=PLAIN_COLORS.get(finish, m.diffuse)) for m, finish in finishes)


def _make_opening(path: Path, fine: str, bounds: Bounds, closed: bool) -> Mesh:
    """Build a door, open to -z up to the side of the box unless `closed`; for an arch, only its frame."""
    (x0, y0, z0), (x1, y1, _) = bounds.tolist()
    width, height = max(x1 - x0, 3 * JAMB_WIDTH), max(y1 - y0, 0.5)
    reach = np.clip((-z0 - HINGE_OFFSET) / (width - 2 * JAMB_WIDTH), 0.0, 1.0)
    solids = door(width, height, 0.0 if closed else float(np.arcsin(reach)))
    wanted: Iterator[Solid] = islice(solids, NUM_FRAME_SOLIDS) if fine == "arch" else solids
    pieces = [move(piece, ((x0 + x1) / 2, y0, 0.0)) for piece in wanted]
    slots = [slot for slot in ("wood", "wood_1", "chrome") if any(piece.material == slot for piece in pieces)]
    finishes = [slot.rstrip("_1") for slot in slots]
    materials = [replace(FINISHES[finish][0], name=f"material_{i}") for i, finish in enumerate(finishes)]
    return to_mesh(path, pieces, slots, _replace_images(materials, dict(zip(slots, finishes, strict=True))))
