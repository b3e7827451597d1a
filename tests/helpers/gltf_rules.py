"""Rules of the glTF 2.0 specification, checked on a GLB file: what the Khronos validator reports as errors or hints."""

import json
import struct
from collections.abc import Iterator
from typing import Any

import numpy as np

DTYPES = {5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
REFERENCES = {  # entry of a list: (its member, list that the member indexes)
    "accessors": (("bufferView", "bufferViews"),),
    "bufferViews": (("buffer", "buffers"),),
    "images": (("bufferView", "bufferViews"),),
    "nodes": (("mesh", "meshes"), ("camera", "cameras"), ("children", "nodes")),
    "scenes": (("nodes", "nodes"),),
    "textures": (("source", "images"),),
}


def split(data: bytes) -> tuple[dict[str, Any], bytes]:
    """Return the JSON document and the binary chunk of a GLB file, whose header and lengths must fit."""
    magic, version, length, size, kind = struct.unpack_from("<4sIIII", data)
    assert (magic, version, length, kind, size % 4) == (b"glTF", 2, len(data), 0x4E4F534A, 0)
    rest, kind = struct.unpack_from("<II", data, 20 + size)
    assert (kind, rest % 4, 28 + size + rest) == (0x004E4942, 0, len(data))
    return json.loads(data[20 : 20 + size]), data[28 + size :]


def find_faults(root: dict[str, Any], chunk: bytes) -> list[str]:
    """Return a line for each violated rule; empty if the file keeps all of them."""
    return [*_references(root), *_accessors(root, chunk), *_meshes(root, chunk), *_nodes(root), *_materials(root)]


def _uses(root: dict[str, Any]) -> Iterator[tuple[str, str, int]]:
    """Yield all references: place, list and index."""
    for key, members in REFERENCES.items():
        for i, entry in enumerate(root.get(key, [])):
            for name, target in members:
                value = entry.get(name, [])
                for index in value if isinstance(value, list) else [value]:
                    yield f"{key}[{i}].{name}", target, index
    for i, mesh in enumerate(root["meshes"]):
        for part in mesh["primitives"]:
            yield f"meshes[{i}]", "materials", part["material"]
            for index in (part["indices"], *part["attributes"].values()):
                yield f"meshes[{i}]", "accessors", index
    for i, material in enumerate(root["materials"]):
        for texture in _textures(material):
            yield f"materials[{i}]", "textures", texture["index"]
    yield "scene", "scenes", root["scene"]


def _textures(material: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the references of a material to textures."""
    return [v for owner in (material, material["pbrMetallicRoughness"]) for k, v in owner.items() if "Texture" in k]


def _references(root: dict[str, Any]) -> Iterator[str]:
    used: dict[str, set[int]] = {}
    parents: dict[int, int] = {}
    for place, target, index in _uses(root):
        used.setdefault(target, set()).add(index)
        if not 0 <= index < len(root.get(target, [])):
            yield f"{place}: no {target}[{index}]"
        if target == "nodes":
            parents[index] = parents.get(index, 0) + 1
    yield from (f"nodes[{i}] has {n} parents" for i, n in parents.items() if n != 1)
    for key, value in root.items():
        if isinstance(value, list) and key != "extensionsUsed":
            yield from (f"{key}[{i}] is unused" for i in range(len(value)) if i not in used.get(key, ()))
            if not value:
                yield f"{key} is empty"


def _values(root: dict[str, Any], chunk: bytes, index: int) -> np.ndarray:
    accessor = root["accessors"][index]
    view = root["bufferViews"][accessor["bufferView"]]
    width = WIDTHS[accessor["type"]]
    data = chunk[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
    return np.frombuffer(data, DTYPES[accessor["componentType"]], accessor["count"] * width).reshape(-1, width)


def _accessors(root: dict[str, Any], chunk: bytes) -> Iterator[str]:
    if root["buffers"] != [{"byteLength": len(chunk)}]:
        yield "buffers: not the chunk alone"
    for i, view in enumerate(root["bufferViews"]):
        if view["byteOffset"] % 4 or view["byteOffset"] + view["byteLength"] > len(chunk):
            yield f"bufferViews[{i}] is not aligned, or beyond its buffer"
    for i, accessor in enumerate(root["accessors"]):
        found = _values(root, chunk, i)
        if not np.isfinite(found).all():
            yield f"accessors[{i}] is not finite"
        if "min" in accessor and not np.array_equal([accessor["min"], accessor["max"]], [found.min(0), found.max(0)]):
            yield f"accessors[{i}]: bounds do not fit"


def _meshes(root: dict[str, Any], chunk: bytes) -> Iterator[str]:
    for i, mesh in enumerate(root["meshes"]):
        for k, part in enumerate(mesh["primitives"]):
            place, names = f"meshes[{i}].primitives[{k}]", part["attributes"]
            index = _values(root, chunk, part["indices"]).reshape(-1, 3)
            counts = {root["accessors"][a]["count"] for a in names.values()}
            if (
                len(counts) != 1
                or index.max() >= min(counts)
                or not {"min", "max"} <= set(root["accessors"][names["POSITION"]])
            ):
                yield f"{place}: indices or bounds do not fit"
            if (index == np.roll(index, 1, axis=1)).any():
                yield f"{place}: triangle with equal corners"
            if abs(np.linalg.norm(_values(root, chunk, names["NORMAL"]), axis=1) - 1).max() > 1e-4:
                yield f"{place}: normal is not of unit length"
            if bool(_textures(root["materials"][part["material"]])) != ("TEXCOORD_0" in names):
                yield f"{place}: texture and coordinates do not fit"
            targets = {root["bufferViews"][root["accessors"][a]["bufferView"]].get("target") for a in names.values()}
            own = root["bufferViews"][root["accessors"][part["indices"]]["bufferView"]].get("target")
            if targets != {34962} or own != 34963:
                yield f"{place}: views lack their targets"


def _nodes(root: dict[str, Any]) -> Iterator[str]:
    for i, node in enumerate(root["nodes"]):
        matrix = np.array(node.get("matrix", np.eye(4).T.ravel())).reshape(4, 4).T
        sides = matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0)
        if "matrix" in node and (np.array_equal(matrix, np.eye(4)) or not np.array_equal(matrix[3], [0, 0, 0, 1])):
            yield f"nodes[{i}]: matrix is the default, or not affine"
        if abs(sides.T @ sides - np.eye(3)).max() > 1e-4:
            yield f"nodes[{i}]: matrix has shear"
        if "rotation" in node and abs(np.linalg.norm(node["rotation"]) - 1) > 1e-6:
            yield f"nodes[{i}]: quaternion is not of unit length"
        lights = node.get("extensions", {}).get("KHR_lights_punctual")
        if lights and not lights["light"] < len(root["extensions"]["KHR_lights_punctual"]["lights"]):
            yield f"nodes[{i}]: no such light"
    if set(root.get("extensions", {})) - set(root.get("extensionsUsed", ())):
        yield "extensionsUsed lacks an extension"


def _materials(root: dict[str, Any]) -> Iterator[str]:
    for i, material in enumerate(root["materials"]):
        shade = material["pbrMetallicRoughness"]
        values = [*shade["baseColorFactor"], shade["metallicFactor"], shade["roughnessFactor"]]
        values += material.get("emissiveFactor", [])
        if len(values) not in (6, 9) or not all(0 <= value <= 1 for value in values):
            yield f"materials[{i}]: factor is out of range"
        if material.get("alphaMode", "OPAQUE") not in ("OPAQUE", "MASK", "BLEND"):
            yield f"materials[{i}]: unknown alpha mode"
    for i, image in enumerate(root.get("images", [])):
        if image["mimeType"] not in ("image/png", "image/jpeg"):
            yield f"images[{i}]: unknown format"
