"""Primitives of a glTF mesh as triangles with texture coordinates, normals and material slots."""

import importlib
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from jaxtyping import Float, Int, Shaped

from home_mjx.datasets.gltf.decode.accessors import read_accessor
from home_mjx.datasets.gltf.decode.container import GltfDocument
from home_mjx.datasets.gltf.decode.materials import MaterialReader, TexturedMaterial, tinted
from home_mjx.datasets.gltf.decode.skins import Binding, SkinReader
from home_mjx.datasets.suncg.formats.json_value import MAX_COORDINATE, JsonValue
from home_mjx.errors import install_hint
from home_mjx.schema.house import Material, Mesh

DRACO = "KHR_draco_mesh_compression"
TRIANGLES, STRIP, FAN = 4, 5, 6
MAX_TRIANGLES = 10_000_000  # maximum sum over the meshes of a document
WIDTHS = {
    "COLOR": (3, 4),
    "TANGENT": (4,),
    "TEXCOORD": (2,),
    "JOINTS": (4,),
    "WEIGHTS": (4,),
}  # of rows of attributes; others: 3
MAX_ROWS = 1 << 27  # maximum number of rows of accessors that are read, and of morph targets that are added
KEPT_ACCESSORS = 8  # number of the last accessors that are kept, since primitives share them
MAX_TARGETS = 1_000  # maximum number of morph targets of a mesh
MAX_SETS = 4  # maximum number of sets of joints and weights
USED = ("POSITION", "NORMAL", "TEXCOORD_", "COLOR_0", "JOINTS_", "WEIGHTS_")  # starts of names of attributes
COLOR_STEPS = (16, 8, 4, 2)  # levels per channel to which vertex colours are rounded
MAX_COLORS = 64  # maximum number of material slots that the vertex colours of a primitive become

Attributes = dict[str, np.ndarray]


@dataclass
class MeshReader:
    """Reader of a document's meshes, each read once, in its own frame and units.

    Attributes:
        document: The document.
        materials: Reader of its materials.
        notes: Elements with the reason why they are not shown.
        bindings: Joints of the vertices of meshes that skins may move, by number of the mesh.
    """

    document: GltfDocument
    materials: MaterialReader
    notes: dict[str, str] = field(default_factory=dict)
    bindings: dict[int, Binding] = field(default_factory=dict)
    _read: dict[int, Mesh | None] = field(default_factory=dict)
    _accessors: dict[int, np.ndarray] = field(default_factory=dict)
    _total: int = 0
    _rows: int = 0

    @cached_property
    def skins(self) -> SkinReader:
        """Reader of the document's skins."""
        return SkinReader(self.document)

    def mesh(self, index: JsonValue) -> Mesh | None:
        """Return the mesh that a node names; None if it has no triangles of any area.

        Raises:
            DatasetError: Indices, accessors or materials are invalid, or the document has too many triangles.
        """
        value, number = self.document.item("meshes", index), index.integer()
        if number not in self._read:
            weights = _weights(value)
            primitives = value.member("primitives").entries()
            parts = [part for p in primitives if (part := self._primitive(p, weights)) is not None]
            self._read[number] = _join(self.document, parts) if parts else None
            bound = [part.binding for part in parts if part.binding is not None]
            if bound and len(bound) == len(parts):
                self.bindings[number] = _join_bindings(bound)
        return self._read[number]

    def _primitive(self, value: JsonValue, weights: list[float]) -> "_Part | None":
        """Return the triangles of a primitive; None, with a note, if there are none."""
        if _is_empty(value):
            self.notes[value.element] = "primitive without positions is not shown"
            return None
        attributes, index = self._vertices(value)
        if any(weights):
            attributes = self._morphed(value, attributes, weights)
        corners = self._triangles(value, index, len(attributes["POSITION"]))
        if corners is None:
            return None
        self._total += len(corners)
        if self._total > MAX_TRIANGLES:
            raise value.error(f"meshes have more than {MAX_TRIANGLES} triangles", "Simplify them.")
        a, b, c = self._corners(value, attributes["POSITION"], corners)
        flat = (np.cross(b - a, c - a) == 0).all(axis=1)
        if flat.any():
            self.notes[value.element] = f"{int(flat.sum())} triangles without area are left out"
        return _part(self.materials.material(value.member("material")), attributes, corners[~flat])

    def _corners(
        self, value: JsonValue, position: Float[np.ndarray, "v 3"], corners: Int[np.ndarray, "t 3"]
    ) -> Float[np.ndarray, "3 t 3"]:
        """Return the positions of the corners of triangles; raise unless they are below `MAX_COORDINATE`."""
        found = position[corners].transpose(1, 0, 2)
        if not (abs(found) <= MAX_COORDINATE).all():
            raise value.error(f"expected coordinates up to {MAX_COORDINATE:g}, got {abs(found).max():g}")
        return found

    def _vertices(self, value: JsonValue) -> tuple[Attributes, Int[np.ndarray, " i"] | None]:
        """Return the attributes of a primitive's vertices, and its indices; None: vertices are in order."""
        packed = value.member("extensions")
        packed = packed.member(DRACO) if packed.has_value else packed
        if packed.has_value:
            attributes, index = _unpack_draco(self.document, packed)
        else:
            named, listed = value.member("attributes"), value.member("indices")
            used = [k for k in _keys(named) if k.startswith(USED)]
            attributes = {key: self._elements(named.member(key)) for key in used}
            index = self._elements(listed)[:, 0] if listed.has_value else None
        self._check(value, attributes)
        return attributes, index

    def _elements(self, index: JsonValue) -> Shaped[np.ndarray, "n c"]:
        """Return an accessor's elements, which must not be changed."""
        number = index.integer()
        if number not in self._accessors:
            rows = read_accessor(self.document, index)
            self._count_rows(index, len(rows))
            if len(self._accessors) >= KEPT_ACCESSORS:
                self._accessors.pop(next(iter(self._accessors)))
            self._accessors[number] = rows
        return self._accessors[number]

    def _count_rows(self, value: JsonValue, count: int) -> None:
        """Count rows that are read or added; raise the value's error beyond `MAX_ROWS`."""
        self._rows += count
        if self._rows > MAX_ROWS:
            raise value.error(f"meshes read more than {MAX_ROWS} rows of accessors", "Use fewer or smaller accessors.")

    def _morphed(self, value: JsonValue, attributes: Attributes, weights: list[float]) -> Attributes:
        """Return attributes of vertices with the positions and normals of morph targets added, by their weights."""
        targets = value.member("targets")
        listed = targets.entries() if targets.has_value else []
        if len(listed) != len(weights) or len(listed) > MAX_TARGETS:
            message = f"mesh has {len(weights)} weights, its primitive {len(listed)} targets; at most {MAX_TARGETS}"
            raise value.error(message)
        moved = dict(attributes)
        for target, weight in zip(listed, weights, strict=True):
            for key in ("POSITION", "NORMAL"):
                if weight and key in moved and target.member(key).has_value:
                    rows = self._elements(target.member(key))
                    self._count_rows(target, len(rows))
                    if rows.shape != moved[key].shape:
                        raise target.error(f"{key} has the shape {rows.shape}, that of the mesh {moved[key].shape}")
                    moved[key] = moved[key] + weight * rows
        if not all(np.isfinite(moved[key]).all() for key in ("POSITION", "NORMAL") if key in moved):
            raise value.error("morph targets move vertices beyond all limits")
        return moved

    def _check(self, value: JsonValue, attributes: Attributes) -> None:
        """Raise `DatasetError` unless attributes have positions of three coordinates and one length."""
        position = attributes.get("POSITION")
        if position is None or position.shape[1] != 3:
            raise value.error("primitive has no POSITION of three coordinates")
        for name, rows in attributes.items():
            width = next((w for start, w in WIDTHS.items() if name.startswith(start)), (3,))
            if len(rows) != len(position) or rows.shape[1] not in width:
                raise value.error(f"{name} has the shape {rows.shape}, POSITION {position.shape}")

    def _triangles(self, value: JsonValue, index: np.ndarray | None, count: int) -> Int[np.ndarray, "t 3"] | None:
        """Return the vertex indices of a primitive's triangles; None, with a note, for points, lines and none."""
        mode = value.member("mode").integer() if value.member("mode").has_value else TRIANGLES
        if mode not in range(7):
            raise value.member("mode").error(f"expected a mode of 0 to 6, got {mode}")
        index = np.arange(count) if index is None else index
        if index.dtype.kind != "i" or index.max(initial=0) >= count or index.min(initial=0) < 0:
            raise value.error(f"index is beyond the {count} vertices")
        if mode < TRIANGLES or len(index) < 3:
            self.notes[value.element] = "points and lines are not shown" if mode < TRIANGLES else "no triangle"
            return None
        return split_triangles(index, mode)


def _weights(value: JsonValue) -> list[float]:
    """Return the weights of morph targets of a mesh; [] without any."""
    weights = value.member("weights")
    return [weight.number() for weight in weights.entries()] if weights.has_value else []


def _is_empty(value: JsonValue) -> bool:
    """Return whether a primitive has no positions, which are not in compressed data either, so that it is skipped."""
    packed = value.member("extensions")
    is_packed = packed.has_value and packed.member(DRACO).has_value
    return not is_packed and "POSITION" not in _keys(value.member("attributes"))


def split_triangles(index: Int[np.ndarray, " i"], mode: int) -> Int[np.ndarray, "t 3"]:
    """Return the triangles of a list, a strip or a fan of vertex indices, wound as glTF's specification has it.

    Example:
        >>> split_triangles(np.arange(4), STRIP).tolist(), split_triangles(np.arange(4), FAN).tolist()
        ([[0, 1, 2], [1, 3, 2]], [[1, 2, 0], [2, 3, 0]])
    """
    if mode == TRIANGLES:
        return index[: len(index) // 3 * 3].reshape(-1, 3)
    if mode == FAN:
        return np.stack([index[1:-1], index[2:], np.full(len(index) - 2, index[0])], axis=1)
    odd = np.arange(len(index) - 2) % 2
    return np.stack([index[:-2], index[np.arange(len(odd)) + 1 + odd], index[np.arange(len(odd)) + 2 - odd]], axis=1)


@dataclass(frozen=True)
class _Part:
    """Triangles of one primitive."""

    corners: Float[np.ndarray, "t 3 3"]
    uv: Float[np.ndarray, "t 3 2"]
    normal: Float[np.ndarray, "t 3 3"] | None
    slot: Int[np.ndarray, " t"]
    materials: tuple[Material, ...]
    binding: Binding | None = None


def _part(found: TexturedMaterial, attributes: Attributes, corners: Int[np.ndarray, "t 3"]) -> _Part:
    """Return the triangles of a primitive with its material, one slot per vertex colour."""
    uv = attributes.get(f"TEXCOORD_{found.uv_set}")
    uv = np.zeros((*corners.shape, 2)) if uv is None else uv[corners]
    uv = uv @ found.uv_matrix[:2, :2].T + found.uv_matrix[:2, 2]
    uv = uv * [1, -1] + [0, 1]  # the records have v = 0 below
    slot, materials = np.zeros(len(corners), int), (found.material,)
    if "COLOR_0" in attributes and len(corners):
        slot, colors = round_colors(attributes["COLOR_0"][corners, :3].mean(axis=1))
        materials = tuple(tinted(found.material, color) for color in colors)
    normal = attributes["NORMAL"][corners] if "NORMAL" in attributes else None
    return _Part(
        attributes["POSITION"][corners], uv, normal, slot, materials, _binding(attributes, corners.reshape(-1))
    )


def _binding(attributes: Attributes, corners: Int[np.ndarray, " c"]) -> Binding | None:
    """Return the joints of corners, of all sets that have joints and weights; None without any."""
    sets = [k for i in range(MAX_SETS) if {k := f"JOINTS_{i}", f"WEIGHTS_{i}"} <= attributes.keys()]
    if not sets:
        return None
    joint = np.concatenate([attributes[name][corners] for name in sets], axis=1).astype(int)
    weight = np.concatenate([attributes[name.replace("JOINTS", "WEIGHTS")][corners] for name in sets], axis=1)
    return Binding(joint, weight.astype(float))


def _join_bindings(bound: list[Binding]) -> Binding:
    """Return the joints of the vertices of several primitives, with weight 0 in place of missing sets."""
    width = max(one.joint.shape[1] for one in bound)
    pad = [((0, 0), (0, width - one.joint.shape[1])) for one in bound]
    joint = np.concatenate([np.pad(one.joint, p) for one, p in zip(bound, pad, strict=True)])
    return Binding(joint, np.concatenate([np.pad(one.weight, p) for one, p in zip(bound, pad, strict=True)]))


def round_colors(colors: Float[np.ndarray, "t 3"]) -> tuple[Int[np.ndarray, " t"], Float[np.ndarray, "k 3"]]:
    """Return the slot of each face and the mean colour of each slot: faces of nearly equal colours share one."""
    colors = np.clip(colors, 0, 1)
    slot = np.zeros(len(colors), int)
    for steps in COLOR_STEPS:
        levels = np.round(np.sqrt(colors) * steps).astype(int) @ [(steps + 1) ** 2, steps + 1, 1]
        slot = np.unique(levels, return_inverse=True)[1].reshape(-1)
        if slot.max() < MAX_COLORS:
            break
    weight = np.bincount(slot)
    return slot, np.stack([np.bincount(slot, colors[:, k]) / weight for k in range(3)], axis=1)


def _join(document: GltfDocument, parts: list[_Part]) -> Mesh:
    """Join primitives to one mesh without shared vertices; slots are in their order."""
    first = np.cumsum([0, *(len(p.materials) for p in parts)])
    corners = np.concatenate([p.corners for p in parts])
    normal = None
    if all(p.normal is not None for p in parts):
        normal = np.concatenate([p.normal for p in parts if p.normal is not None])
    return Mesh(
        path=document.path,
        vertices=corners.reshape(-1, 3),
        faces=np.arange(corners.size // 3).reshape(-1, 3),
        uv=np.concatenate([p.uv for p in parts]),
        slot=np.concatenate([p.slot + start for p, start in zip(parts, first, strict=False)]),
        group=np.full(len(corners), -1),
        materials=tuple(m for p in parts for m in p.materials),
        normal=normal,
    )


def _keys(value: JsonValue) -> list[str]:
    """Return the keys of a JSON object."""
    value.member("")  # raises unless it is an object
    return list(value.data)


def _unpack_draco(document: GltfDocument, packed: JsonValue) -> tuple[Attributes, Int[np.ndarray, " i"]]:
    """Return attributes and indices of a primitive that is compressed by Draco.

    Raises:
        DatasetError: DracoPy is not installed, or cannot decode the data.
    """
    try:
        draco: Any = importlib.import_module("DracoPy")
    except ImportError:
        raise packed.error(f"{DRACO} needs DracoPy, which is not installed", install_hint("gltf")) from None
    try:
        mesh = draco.decode(bytes(document.view(packed.member("bufferView"))[0]))
        named = packed.member("attributes")
        used = [key for key in _keys(named) if key.startswith(USED)]
        found = {k: mesh.get_attribute_by_unique_id(named.member(k).integer())["data"] for k in used}
        return {k: rows if k.startswith("JOINTS") else _as_float(rows) for k, rows in found.items()}, np.asarray(
            mesh.faces, np.int64
        ).reshape(-1)
    except (RuntimeError, ValueError, TypeError, AttributeError, KeyError) as error:
        raise packed.error(f"Draco data cannot be decoded: {error}") from None


def _as_float(rows: np.ndarray) -> np.ndarray:
    """Return decoded rows as float64; colours of integer types become 0..1."""
    rows = np.asarray(rows)
    return rows / np.iinfo(rows.dtype).max if rows.dtype.kind == "u" else rows.astype(np.float64)
