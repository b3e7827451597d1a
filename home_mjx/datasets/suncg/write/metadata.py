"""Text of the metadata tables: categories, sizes and lights of library models."""

import csv
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.suncg.read.joints import COLUMNS
from home_mjx.schema.house import Joint, Light, Mesh, ModelInfo

# Rows 0..4 of every ModelCategoryMapping.csv.
PSEUDO_ROWS = (
    ("Empty", "empty", "empty", "0", "void", "n03284308", "empty.n.01"),
    ("Wall", "wall", "wall", "1", "wall", "n04546855", "wall.n.01"),
    ("Ceiling", "ceiling", "ceiling", "1", "ceiling", "n02990373", "ceiling.n.01"),
    ("Floor", "floor", "floor", "1", "floor", "n03365592", "floor.n.01"),
    ("Box", "unknown", "unknown", "2", "void", "n08632096", "unknown.n.01"),
)
_CATEGORY_COLUMNS = (
    "index",
    "model_id",
    "fine_grained_class",
    "coarse_grained_class",
    "empty_struct_obj",
    "nyuv2_40class",
    "wnsynsetid",
    "wnsynsetkey",
)
_SIZE_COLUMNS = ("id", "front", "nmaterials", "minPoint", "maxPoint", "aligned.dims", "index", "variantIds")
_STRUCTURE = ("partition", "stairs", "column")  # fine classes of structure, not of objects


@dataclass(frozen=True)
class LibraryModel:
    """A library model with its rows in the tables."""

    info: ModelInfo  # id, classes and front; the size follows from the mesh
    mesh: Mesh
    synset: tuple[str, str]  # WordNet offset and key
    variants: Mapping[str, Mesh] = field(default_factory=dict)  # by stem, such as `122_0`; they share slots
    lights: tuple[Light, ...] = ()
    joints: tuple[Joint, ...] = ()


def categories_csv(models: Sequence[LibraryModel]) -> str:
    """Return the text of `ModelCategoryMapping.csv`: five pseudo rows, then the models; a row's index is its label."""
    rows = [*PSEUDO_ROWS, *(_category_row(model) for model in models)]
    return _csv(_CATEGORY_COLUMNS, ((i, *row) for i, row in enumerate(rows)))


def _category_row(model: LibraryModel) -> tuple[str, ...]:
    """Return a model's cells behind the index; `empty_struct_obj` is 1 for structure, 2 for objects."""
    info = model.info
    kind = "1" if info.fine in _STRUCTURE else "2"
    return info.model_id, info.fine, info.coarse, kind, info.nyu40, *model.synset


def sizes_csv(models: Sequence[LibraryModel]) -> str:
    """Return the text of `models.csv`; variants have rows of their own, with the index of their base."""
    return _csv(
        _SIZE_COLUMNS, (row for i, model in enumerate(models, len(PSEUDO_ROWS)) for row in _size_rows(model, i))
    )


def _size_rows(model: LibraryModel, index: int) -> Iterable[tuple[Any, ...]]:
    """Yield the rows of `models.csv` of a model: its mesh, then its variants; all have the same `index`.

    Corners are in [m], but `aligned.dims` in [cm].
    """
    meshes = {model.info.model_id: model.mesh, **model.variants}
    variants = ",".join(meshes) if model.variants else ""
    front = ",".join(f"{x:g}" for x in model.info.front)
    for stem, mesh in meshes.items():
        low, high = mesh.vertices.min(0), mesh.vertices.max(0)
        extent = _triple(100 * (high - low))
        yield stem, front, len(mesh.materials), _triple(low), _triple(high), extent, index, variants


def joints_csv(models: Sequence[LibraryModel]) -> str:
    """Return the text of `joints.csv`: one row per movable part, in the order of the models.

    `Joint.closed` is not written: it is read as 0.
    """
    return _csv(COLUMNS, (_joint_row(joint) for model in models for joint in model.joints))


def _joint_row(joint: Joint) -> tuple[str, ...]:
    """Return a joint's cells in the order of `read.joints.COLUMNS`."""
    runs = " ".join(f"{first}-{last}" for first, last in joint.face_ranges)
    axis, point = (_triple(np.asarray(values)) for values in (joint.axis, joint.point))
    return joint.model_id, joint.part, joint.kind, axis, point, f"{joint.low}, {joint.high}", runs


def _triple(values: Float[np.ndarray, " 3"]) -> str:
    """Return three numbers, rounded to 6 decimals, separated by `, `."""
    return ", ".join(str(value) for value in (np.round(values, 6) + 0.0).tolist())


def _csv(header: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """Return a table as CSV without a final line feed."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([header, *rows])
    return text.getvalue().removesuffix("\n")


def lights_json(models: Sequence[LibraryModel]) -> str:
    """Return the text of `suncgModelLights.json`: lights by model id, in the model's frame, models without omitted."""
    lit = {m.info.model_id: [_light(light, m.info.model_id) for light in m.lights] for m in models if m.lights}
    return json.dumps(lit, separators=(",", ":"))


def _light(light: Light, model_id: str) -> dict[str, Any]:
    """Convert a light to JSON values; those without a value, and a dropoff of 0, are omitted."""
    entry: dict[str, Any] = {
        "type": f"{light.kind.capitalize()}Light",
        "modelId": model_id,
        "power": light.power,
        "color": "#" + "".join(f"{round(255 * x):02x}" for x in light.color),
        "position": light.position,
        "position2": light.end,
        "direction": light.direction,
        "cutoffAngle": light.cutoff,
        "dropoffRate": light.dropoff or None,
        "attenuation": [0, 0, 1],
    }
    return {key: value for key, value in entry.items() if value is not None}
