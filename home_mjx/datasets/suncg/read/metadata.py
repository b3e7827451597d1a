"""Reader of the metadata tables: categories, sizes and lights of the models."""

import csv
import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from home_mjx.core.files import is_file, read_text
from home_mjx.datasets.suncg.formats.json_value import JsonValue, Location, read_json
from home_mjx.datasets.suncg.formats.variants import SuncgMetadata
from home_mjx.schema.house import Light, LightKind, ModelInfo

CATEGORIES = "ModelCategoryMapping.csv"
SIZES = "models.csv"
LIGHTS = "suncgModelLights.json"
DEFAULT_FRONT = ModelInfo("").front
LIGHT_KINDS: dict[str, LightKind] = {"PointLight": "point", "SpotLight": "spot", "LineLight": "line"}


def read_metadata(folder: Path, tolerant: bool = False) -> SuncgMetadata:
    """Read the tables of `<root>/metadata`; only the category table is required, and if `tolerant`, none is.

    Raises:
        DatasetError: The category table is missing, or a row of any table is broken.
    """
    named = SuncgMetadata(
        {} if tolerant and not is_file(folder / CATEGORIES) else _read_categories(folder / CATEGORIES)
    )
    sized = _read_sizes(folder / SIZES, named) if (folder / SIZES).is_file() else {}
    lights = _read_lights(folder / LIGHTS) if (folder / LIGHTS).is_file() else {}
    return SuncgMetadata({**named.models, **sized}, lights)


def _read_categories(path: Path) -> dict[str, ModelInfo]:
    """Read the category table, without sizes, by model id; empty categories are unknown (`void` for NYU40)."""
    hint = "Fetch the `metadata` archive of the dataset: categories come from this table."
    columns = ("model_id", "fine_grained_class", "coarse_grained_class", "nyuv2_40class")
    models: dict[str, ModelInfo] = {}
    for place, (model_id, fine, coarse, nyu40, front) in read_rows(path, columns, hint, ("front",)):
        _check_new(model_id, models, place)
        facing = parse_triple(front, place) if front else DEFAULT_FRONT
        models[model_id] = ModelInfo(model_id, fine or "unknown", coarse or "unknown", nyu40 or "void", front=facing)
    return models


def _read_sizes(path: Path, named: SuncgMetadata) -> dict[str, ModelInfo]:
    """Read sizes [m] and fronts; a front of the category table takes precedence.

    Variants that this table lacks inherit the categories of their base.
    """
    models: dict[str, ModelInfo] = {}
    for place, (model_id, front, low, high) in read_rows(path, ("id", "front", "minPoint", "maxPoint"), None):
        _check_new(model_id, models, place)
        (x0, y0, z0), (x1, y1, z1) = parse_triple(low, place), parse_triple(high, place)
        # `aligned.dims` is not used: it belongs to the model rotated to its front.
        dims = (x1 - x0, y1 - y0, z1 - z0)
        info = named.info(model_id)
        facing = (
            parse_triple(front, place) if info.front == DEFAULT_FRONT else info.front
        )  # v2's category table is more accurate
        models[model_id] = replace(info, model_id=model_id, dims=dims, front=facing, low=(x0, y0, z0))
    return models


def _check_new(model_id: str, models: dict[str, ModelInfo], place: Location) -> None:
    """Raise `DatasetError` if the table already has a row of this model."""
    if model_id in models:
        raise place.error(f"model `{model_id}` has two rows", "Keep one of them.")


def parse_triple(text: str, place: Location) -> tuple[float, float, float]:
    """Parse three finite numbers separated by commas; raise `DatasetError` at `place` otherwise."""
    try:
        x, y, z = (float(word) for word in text.split(","))
    except ValueError:
        x = y = z = math.nan
    if not math.isfinite(x + y + z):
        raise place.error(f"expected three finite numbers, got `{text[:60]}`")
    return x, y, z


def read_rows(
    path: Path, columns: tuple[str, ...], hint: str | None, optional: tuple[str, ...] = ()
) -> Iterator[tuple[Location, list[str]]]:
    """Yield place and cells of each row of a CSV file: `columns`, then `optional` ones, which are "" if missing.

    Raises:
        DatasetError: The file cannot be read, a column is missing, or a row is broken.
    """
    table = csv.reader(read_text(path, hint).splitlines(), strict=True)
    try:
        header = next(table, [])
        missing = [column for column in columns if column not in header]
        if missing:
            raise Location(path, "line 1").error(f"table lacks the column(s) {', '.join(missing)}", hint)
        for row in table:
            place = Location(path, f"line {table.line_num}")
            if len(row) != len(header):
                raise place.error(f"expected {len(header)} cells, got {len(row)}", "The file may be truncated.")
            cells = dict(zip(header, row, strict=True))
            yield place, [cells.get(column, "") for column in (*columns, *optional)]
    except csv.Error as error:
        raise Location(path, f"line {table.line_num}").error(f"not valid CSV: {error}") from None


def _read_lights(path: Path) -> dict[str, tuple[Light, ...]]:
    """Read the lights of all models by stem of an OBJ."""
    document = read_json(path)
    if not isinstance(document.data, dict):
        raise document.error("expected an object of lists of lights by model id")
    return {key: tuple(_light(value) for value in document.member(key).entries()) for key in document.data}


def _light(value: JsonValue) -> Light:
    """Read one light, in the model's frame; `dropoff` is 0 if absent, other optional fields are None."""
    kind = value.member("type").text()
    if kind not in LIGHT_KINDS:
        raise value.member("type").error(f"unknown light `{kind}`", f"Known: {', '.join(LIGHT_KINDS)}.")
    cutoff, dropoff = value.member("cutoffAngle"), value.member("dropoffRate")
    return Light(
        kind=LIGHT_KINDS[kind],
        power=value.member("power").number(),
        color=value.member("color").color(),
        position=_point(value.member("position")),
        direction=_optional_point(value.member("direction")),
        cutoff=cutoff.number() if cutoff.has_value else None,
        dropoff=dropoff.number() if dropoff.has_value else 0.0,
        end=_optional_point(value.member("position2")),
    )


def _point(value: JsonValue) -> tuple[float, float, float]:
    """Read a point [m]."""
    x, y, z = value.vector(3).tolist()
    return x, y, z


def _optional_point(value: JsonValue) -> tuple[float, float, float] | None:
    """Read a point; None if null."""
    return _point(value) if value.has_value else None
