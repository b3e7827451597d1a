"""Compressed bytes of library meshes: positions, faces, texture coordinates and normals as whole numbers."""

import zlib
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int, UInt8

from home_mjx.schema.house import Material, Mesh
from home_procgen.shapes.normals import corner_normals, rounded_normals, unit_normals
from home_procgen.textures.recipes import repeat_uv, uv_scale

POSITION_DECIMALS, UV_DECIMALS = 5, 4  # of a metre, to which library meshes are rounded
COMPRESSION_LEVEL = 9
_HEAD = 3  # numbers of vertices, faces and distinct normals, before the columns
NORMAL_TOLERANCE, EXTENT_TOLERANCE = 1e-3, 2  # relative, and steps of the grid: what rounding to it changes
_PLANES = np.array([(2, 1), (0, 2), (0, 1)])  # axes of texture coordinates of faces that point along x, y and z


def round_positions(values: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n"]:
    """Return positions rounded to the grid of library meshes [m]."""
    return np.round(values, POSITION_DECIMALS) + 0.0


def round_uv(values: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n"]:
    """Return texture coordinates rounded to the grid of library meshes."""
    return np.round(values, UV_DECIMALS) + 0.0


def add_normals(mesh: Mesh) -> Mesh:
    """Return a mesh with vertex normals and without unused vertices, which OBJ files do not store."""
    used, faces = np.unique(mesh.faces, return_inverse=True)
    faces = faces.reshape(mesh.faces.shape).astype(mesh.faces.dtype)
    return replace(mesh, vertices=mesh.vertices[used], faces=faces, normal=corner_normals(mesh.vertices[used], faces))


def encode_mesh(mesh: Mesh, finishes: Iterable[str]) -> UInt8[np.ndarray, " _"]:
    """Return the compressed bytes of a library mesh: differences of neighbours, by column, lowest bytes first.

    Args:
        mesh: The mesh.
        finishes: Finish of each slot.
    """
    positions = to_grid(mesh.vertices, POSITION_DECIMALS)
    uv = to_grid(mesh.uv / uv_scale(finishes)[mesh.slot][:, None, None], UV_DECIMALS) - _predict_uv(
        positions, mesh.faces
    )
    normals, first, number = np.unique(
        rounded_normals(mesh.vertices, mesh.faces), axis=0, return_index=True, return_inverse=True
    )
    order = np.argsort(first)  # by their first corner, so that numbers of neighbours are close
    columns = (
        *positions.T,
        *normals[order].T,
        *uv.reshape(-1, 2).T,
        *(mesh.faces.reshape(-1), np.argsort(order)[number.reshape(-1)], mesh.slot),
    )
    steps = np.concatenate([np.diff(column, prepend=0) for column in columns]).astype("<i4")
    planes = (steps << 1 ^ steps >> 31).view(np.uint8).reshape(-1, 4).T  # zigzag: small steps have zero high bytes
    head = np.array([len(positions), len(mesh.faces), len(normals)], "<i4")
    return np.frombuffer(zlib.compress(head.tobytes() + planes.tobytes(), COMPRESSION_LEVEL), np.uint8)


def to_grid(values: Float[np.ndarray, "*n"], decimals: int) -> Int[np.ndarray, "*n"]:
    """Return rounded values as whole numbers."""
    return np.round(values * 10.0**decimals).astype(np.int32)


def from_grid(numbers: Int[np.ndarray, "*n"], decimals: int) -> Float[np.ndarray, "*n"]:
    """Return the rounded values of whole numbers."""
    return np.round(numbers / 10.0**decimals, decimals)


def decode_mesh(
    data: UInt8[np.ndarray, " n"], path: Path, finishes: Iterable[str], materials: Sequence[Material]
) -> Mesh:
    """Return the mesh of compressed bytes.

    Args:
        data: Result of `encode_mesh`.
        path: Path of its OBJ file.
        finishes: Finish of each slot.
        materials: Its materials.
    """
    numbers = np.frombuffer(zlib.decompress(data.tobytes()), np.uint8)
    vertices, faces, normals = numbers[: 4 * _HEAD].view("<i4").tolist()
    zigzag = np.ascontiguousarray(numbers[4 * _HEAD :].reshape(4, -1).T).view("<u4").reshape(-1)
    steps = (zigzag >> 1).astype(np.int64) ^ -(zigzag & 1).astype(np.int64)
    lengths = (*[vertices] * 3, *[normals] * 3, *[3 * faces] * 4)
    columns = [np.cumsum(column) for column in np.split(steps, np.cumsum(lengths))]
    positions, corners = np.stack(columns[:3], -1), columns[8].reshape(-1, 3)
    uv = np.stack(columns[6:8], -1).reshape(-1, 3, 2) + _predict_uv(positions, corners)
    mesh = Mesh(
        path=path,
        vertices=from_grid(positions, POSITION_DECIMALS),
        faces=corners,
        uv=from_grid(uv, UV_DECIMALS),
        slot=columns[10],
        group=np.full(faces, -1),
        materials=tuple(materials),
        normal=unit_normals(np.stack(columns[3:6], -1))[columns[9]].reshape(-1, 3, 3),
    )
    return repeat_uv(mesh, finishes)


def _predict_uv(positions: Int[np.ndarray, "v 3"], faces: Int[np.ndarray, "f 3"]) -> Int[np.ndarray, "f 3 2"]:
    """Return texture coordinates as of `project_uv` for each piece, on the grid; most meshes differ by constants."""
    start = _piece_starts(faces, len(positions))
    extent = np.maximum.reduceat(positions, start) - np.minimum.reduceat(positions, start)
    piece = np.searchsorted(start, faces[:, 0], "right") - 1
    corners = positions[faces].astype(np.int64)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.abs(normal)
    axes = _PLANES[(size >= (1 - NORMAL_TOLERANCE) * size.max(axis=1, keepdims=True)).argmax(axis=1)]
    own = np.take_along_axis(extent[piece], axes, axis=1)
    axes = np.where(own[:, :1] < own[:, 1:] - EXTENT_TOLERANCE, axes[:, ::-1], axes)
    return np.take_along_axis(corners, axes[:, None, :], axis=-1) // 10 ** (POSITION_DECIMALS - UV_DECIMALS)


def _piece_starts(faces: Int[np.ndarray, "f 3"], count: int) -> Int[np.ndarray, " p"]:
    """Return the first vertex of each run of vertices that no face connects with earlier ones."""
    reach = np.zeros(count, np.int64)
    np.maximum.at(reach, faces.min(axis=1), faces.max(axis=1))
    reach = np.maximum.accumulate(reach)
    return np.flatnonzero(np.concatenate([[True], reach[:-1] < np.arange(1, count)]))
