"""Layers of a USD scene, checked before they are composed: paths below the scene's folder, units and up axis."""

import importlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from home_mjx.core.files import is_file, resolve_below
from home_mjx.datasets.gltf.decode.container import URI_SCHEME
from home_mjx.datasets.mjcf.files import package_root
from home_mjx.datasets.suncg.formats.json_value import Location, printable
from home_mjx.errors import DatasetError, MissingFileError
from home_mjx.geometry.meshes import Z_UP

MAX_LAYERS = 1_000  # maximum number of layers of a scene
MAX_LAYER_BYTES = 1 << 29  # [bytes], maximum size of one layer
DEFAULT_UNIT = 0.01  # [m], of layers that do not say
MIN_UNIT, MAX_UNIT = 1e-6, 1e6  # [m]
ROOT_HINT = "Name the folder that holds all files by `?root=FOLDER`, or put the file into the folder of the scene."


@dataclass(frozen=True)
class UsdScene:
    """An opened scene.

    Attributes:
        path: Its file.
        root: Folder that contains all its files.
        stage: The composed stage, `pxr.Usd.Stage`.
        frame: House from scene: metres, y up.
        layers: Files of all layers.
        notes: Elements with their irregularities.
    """

    path: Path
    root: Path
    stage: Any
    frame: Float[np.ndarray, "4 4"]
    layers: tuple[Path, ...]
    notes: dict[str, str]


def pxr(name: str) -> Any:
    """Return a module of `pxr`; `DatasetError` if usd-core is not installed."""
    try:
        return importlib.import_module(f"pxr.{name}")
    except ImportError:
        raise DatasetError("USD files need the package usd-core", hint="Run `pip install '.[usd]'`.") from None


def open_scene(path: Path, root: Path | None = None) -> UsdScene:
    """Open a scene.

    Args:
        path: Its file.
        root: Folder that contains all its files; None: see `package_root`.

    Raises:
        MissingFileError: The file is missing.
        DatasetError: usd-core is not installed, a layer is broken or leads out of the scene's folder, or the up axis is
            x or a unit out of range.
    """
    notes: dict[str, str] = {}
    folder = package_root(path) if root is None else root
    layers = tuple(_layers(path, folder, notes))
    try:
        stage = pxr("Usd").Stage.Open(str(path))
    except RuntimeError as error:
        raise _broken(path, error) from None
    return UsdScene(path, folder, stage, _frame(path, stage, notes), layers, notes)


def layer_unit(layer: Any) -> float:
    """Return the metres per unit of a layer; `DEFAULT_UNIT` if it does not say.

    Raises:
        DatasetError: The unit is out of range.
    """
    root = layer.pseudoRoot
    unit = float(root.GetInfo("metersPerUnit")) if root.HasInfo("metersPerUnit") else DEFAULT_UNIT
    if not MIN_UNIT <= unit <= MAX_UNIT:
        raise Location(Path(layer.realPath), "metersPerUnit").error(f"unit of {unit:g} m is out of range")
    return unit


def _frame(path: Path, stage: Any, notes: dict[str, str]) -> Float[np.ndarray, "4 4"]:
    """Return house from scene."""
    layer, frame = stage.GetRootLayer(), np.eye(4)
    root = layer.pseudoRoot
    up = str(root.GetInfo("upAxis")) if root.HasInfo("upAxis") else "Y"
    if up == "X":
        raise Location(path, "upAxis").error("up axis X is not legal in USD", "Set it to Y or Z.")
    if up not in ("Y", "Z"):
        notes["upAxis"] = f"up axis `{printable(up[:20])}` is unknown: y points up"
    if up == "Z":
        frame[:3, :3] = Z_UP.T
    frame[:3, :3] *= layer_unit(layer)
    return frame


def _layers(path: Path, root: Path, notes: dict[str, str]) -> Iterator[Path]:
    """Yield the files of a scene's layers, checked; missing ones that others name are noted."""
    left, seen = [path], {path}
    while left:
        file = left.pop()
        if not is_file(file):
            if file == path:
                raise MissingFileError("scene does not exist", file=file, hint="Correct the path.")
            notes[file.name] = "layer is missing: left out"
            continue
        if file.stat().st_size > MAX_LAYER_BYTES:
            raise DatasetError(f"layer has more than {MAX_LAYER_BYTES} bytes", file=file, hint="Split it.")
        yield file
        for text in _named(file):
            inner = below(root, file, text)
            if inner not in seen:
                seen.add(inner)
                left.append(inner)
        if len(seen) > MAX_LAYERS:
            raise DatasetError(f"scene has more than {MAX_LAYERS} layers", file=path, hint="Flatten it.")


def _named(file: Path) -> list[str]:
    """Return the paths of the layers that a layer names."""
    try:
        layer = pxr("Sdf").Layer.FindOrOpen(str(file))
    except RuntimeError as error:
        raise _broken(file, error) from None
    if layer is None:
        raise DatasetError("not a USD layer", file=file, hint="Fetch or export it again.")
    named = (str(text) for text in layer.GetCompositionAssetDependencies())
    return [text for text in named if text]  # references within the layer have no path


def below(root: Path, file: Path, text: str) -> Path:
    """Return the path of an asset that a layer names; `DatasetError` if it leads out of the scene's root."""
    if not text or "\0" in text or URI_SCHEME.match(text) or text.startswith(("/", "\\")):
        raise Location(file).error(f"expected a relative path, got `{printable(text[:60])}`", ROOT_HINT)
    path = resolve_below(root, file.parent, text)
    if path is None or not path.resolve().is_relative_to(root.resolve()):
        raise Location(file).error(f"`{printable(text[:60])}` leads out of the folder {root}", ROOT_HINT)
    return path


def _broken(path: Path, error: RuntimeError) -> DatasetError:
    """Return the error for a layer that USD refuses."""
    return DatasetError(f"not a USD layer: {_reason(error)}", file=path, hint="Fetch or export it again.")


def _reason(error: RuntimeError) -> str:
    """Return the end of the message of USD's library, which cannot be shown if it quotes bytes that are no text."""
    try:
        text = str(error)
    except UnicodeDecodeError:
        text = "text is not UTF-8"
    return printable(" ".join(text.split())[-200:])


def start() -> Any:
    """Return the time at which scenes are read: that of the first sample, or no time where values have none."""
    return pxr("Usd").TimeCode.EarliestTime()


def at_start(attribute: Any) -> Any:
    """Return the value of an attribute at the start of its animation; None if it has none.

    Raises:
        DatasetError: The value has another type than the schema declares.
    """
    value, expected = attribute.Get(start()), type(attribute.GetTypeName().defaultValue)
    is_number = expected is float and isinstance(value, int)
    if value is not None and not is_number and not isinstance(value, expected):
        raise attribute_place(attribute).error(f"expected a value of the type {attribute.GetTypeName()}")
    return value


def attribute_place(attribute: Any) -> Location:
    """Return the location of an attribute."""
    return Location(Path(attribute.GetStage().GetRootLayer().realPath), str(attribute.GetPath()))


def as_rows(attribute: Any, value: Any, width: int) -> Float[np.ndarray, "n w"]:
    """Return a value of an attribute as rows of numbers; no rows if it is None.

    Args:
        attribute: The attribute, for messages.
        value: A vector or a list of vectors, of `width` numbers or more, of which the first are taken.
        width: Length of the rows.

    Raises:
        DatasetError: The value has another shape, or other entries than numbers.
    """
    if value is None:
        return np.zeros((0, width))
    found = np.asarray(value)
    if found.dtype.kind not in "fiu" or found.ndim not in (1, 2) or found.shape[-1] < width:
        raise attribute_place(attribute).error(f"expected vectors of {width} numbers")
    return found.reshape(-1, found.shape[-1])[:, :width].astype(float)


@contextmanager
def located_errors(path: Path, element: str) -> Iterator[None]:
    """Raise errors of USD's library as `DatasetError` at a prim."""
    try:
        yield
    except pxr("Tf").ErrorException as error:
        raise Location(path, element).error(f"USD refuses the prim: {_reason(error)}") from None
