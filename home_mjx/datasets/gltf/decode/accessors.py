"""Accessors of a glTF document as arrays: strided, normalized, sparse and without a buffer view."""

import numpy as np
from jaxtyping import Shaped

from home_mjx.datasets.gltf.decode.container import GltfDocument, offset_of
from home_mjx.datasets.suncg.formats.json_value import JsonValue

COMPONENT_TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
NUM_COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
MAX_ELEMENTS = 1 << 25  # maximum length of an accessor with data
MAX_ZEROS = 1 << 21  # maximum length of an accessor without data, whose memory no file size bounds


def read_accessor(document: GltfDocument, index: JsonValue) -> Shaped[np.ndarray, "n c"]:
    """Return an accessor's elements, one row each, as float64; as int64 if its integers are not normalized.

    Args:
        document: The document.
        index: Value that names the accessor.

    Raises:
        DatasetError: The accessor is out of range, has an unknown type, reaches beyond its view, or has values that
            are not finite.
    """
    value = document.item("accessors", index)
    width, count = _width(value), _count(value)
    kind = _component(value.member("componentType"))
    view = value.member("bufferView")
    if not view.has_value and count > MAX_ZEROS:
        raise value.error(f"accessor of {count} elements has no data, at most {MAX_ZEROS} are filled with 0")
    found = _elements(document, value, view, count, kind, width) if view.has_value else np.zeros((count, width), kind)
    if value.member("sparse").has_value:
        found = _replace(document, value.member("sparse"), found, kind)
    return _convert(value, found)


def _width(value: JsonValue) -> int:
    """Return the number of components of an accessor's elements; small matrices are errors, as scenes need none."""
    name = value.member("type")
    if name.text() not in NUM_COMPONENTS:
        raise name.error(f"expected one of {', '.join(NUM_COMPONENTS)}, got `{name.text()[:20]}`")
    return NUM_COMPONENTS[name.text()]


def _count(value: JsonValue) -> int:
    """Return the `count` of an accessor or its sparse part, from 1 to `MAX_ELEMENTS`."""
    count = value.member("count")
    if not 1 <= count.integer() <= MAX_ELEMENTS:
        raise count.error(f"expected 1 to {MAX_ELEMENTS} elements, got {count.integer()}")
    return count.integer()


def _component(value: JsonValue) -> np.dtype:
    """Return the NumPy type of a `componentType`."""
    if value.integer() not in COMPONENT_TYPES:
        raise value.error(f"expected one of {', '.join(map(str, COMPONENT_TYPES))}, got {value.integer()}")
    return np.dtype(COMPONENT_TYPES[value.integer()])


def _elements(
    document: GltfDocument, value: JsonValue, view: JsonValue, count: int, kind: np.dtype, width: int
) -> Shaped[np.ndarray, "n c"]:
    """Return `count` elements from a buffer view, at the `byteOffset` of `value`."""
    data, stride = document.view(view)
    start, size = offset_of(value), kind.itemsize * width
    stride = size if stride is None else stride
    end = start + (count - 1) * stride + size
    if stride < size or end > len(data):
        raise value.error(f"{count} elements of {size} bytes end at byte {end} of a view of {len(data)} bytes")
    return np.ndarray((count, width), kind, data, start, (stride, kind.itemsize))


def _replace(
    document: GltfDocument, sparse: JsonValue, base: Shaped[np.ndarray, "n c"], kind: np.dtype
) -> Shaped[np.ndarray, "n c"]:
    """Return a copy of `base` in which the elements of a sparse accessor replace others."""
    count, indices, values = _count(sparse), sparse.member("indices"), sparse.member("values")
    index_kind = _component(indices.member("componentType"))
    if index_kind.kind != "u":
        raise indices.member("componentType").error("expected unsigned indices")
    rows = _elements(document, indices, indices.member("bufferView"), count, index_kind, 1)[:, 0]
    if rows.max() >= len(base):
        raise indices.error(f"index {rows.max()} is beyond the {len(base)} elements of the accessor")
    found = base.copy()
    found[rows] = _elements(document, values, values.member("bufferView"), count, kind, base.shape[1])
    return found


def _convert(value: JsonValue, found: Shaped[np.ndarray, "n c"]) -> Shaped[np.ndarray, "n c"]:
    """Return floats as float64, normalized integers as float64 in 0..1 or -1..1, others as int64."""
    if found.dtype.kind == "f":
        if not np.isfinite(found).all():
            row = int(np.flatnonzero(~np.isfinite(found).all(axis=1))[0])
            raise value.error(f"element {row} is not finite")
        return found.astype(np.float64)
    if value.member("normalized").flag():
        return np.maximum(found / np.iinfo(found.dtype).max, -1.0)
    return found.astype(np.int64)
