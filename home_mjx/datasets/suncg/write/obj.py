"""OBJ and MTL text of a `Mesh` in SUNCG's dialect: one `mtllib`, blocks per group and material, v/vt/vn corners."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Float, Int, Real

from home_mjx.schema.house import Material, Mesh

DECIMALS = 6  # decimals of coordinates [m]


def obj_text(mesh: Mesh, library: str) -> str:
    """Format a mesh as OBJ that names the MTL `library`; normals are flat if it has none.

    Faces of one group and material are one block, in the order of `face_order`. Vertices are those that faces of the
    group use, in order of their index. Coordinates are rounded to `DECIMALS`.
    """
    group = mesh.group[:, None].repeat(3, axis=1).reshape(-1)  # of every corner
    used, vertex = _unique(group, mesh.faces.reshape(-1, 1))
    uvs, uv = _unique(group, rounded(mesh.uv.reshape(-1, 2)))
    normal = np.repeat(_flat(mesh), 3, axis=0) if mesh.normal is None else mesh.normal.reshape(-1, 3)
    normals, toward = _unique(group, rounded(normal))
    index = np.stack([vertex, uv, toward], axis=-1).reshape(-1, 9) + 1  # OBJ indices start at 1, over all groups
    lines = [f"mtllib {library}\n"]
    for number in np.unique(mesh.group).tolist():
        lines += [f"o {mesh.groups[number]}\n"] if number >= 0 and mesh.groups[number] else []
        lines.append(_rows("v %r %r %r\n", rounded(mesh.vertices[_of(number, used)[:, 0]])))
        lines += [_rows("vt %r %r\n", _of(number, uvs)), _rows("vn %r %r %r\n", _of(number, normals))]
        lines += _faces(mesh, mesh.group == number, index)
    return "".join(lines)


def face_order(mesh: Mesh) -> Int[np.ndarray, " f"]:
    """Return the face index of each `f` line of the OBJ text: by group, then by material, else in mesh order."""
    return np.lexsort((mesh.slot, mesh.group))


def _faces(mesh: Mesh, own: Bool[np.ndarray, " f"], index: Int[np.ndarray, "f 9"]) -> Iterator[str]:
    """Yield a `usemtl` line and the `f` lines of each material of the group with the mask `own`."""
    for slot in np.unique(mesh.slot[own]).tolist():
        yield f"usemtl {mesh.materials[slot].name}\n"
        yield _rows("f %d/%d/%d %d/%d/%d %d/%d/%d\n", index[own & (mesh.slot == slot)])


def _rows(line: str, rows: Real[np.ndarray, "n d"]) -> str:
    """Return the rows as text: each fills the printf format `line`."""
    return (line * len(rows)) % tuple(rows.reshape(-1).tolist())


def _flat(mesh: Mesh) -> Float[np.ndarray, "f 3"]:
    """Compute the unit normal of each face; 0 if it has no area."""
    corners = mesh.vertices[mesh.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    return normal / np.where(length > 0, length, 1)


def rounded(rows: Float[np.ndarray, "n d"]) -> Float[np.ndarray, "n d"]:
    """Return numbers rounded to `DECIMALS`, without negative zeros."""
    return np.round(rows, DECIMALS) + 0.0  # adding 0 turns -0 into 0


def _unique(
    group: Int[np.ndarray, " n"], rows: Real[np.ndarray, "n d"]
) -> tuple[tuple[Int[np.ndarray, " m"], Real[np.ndarray, "m d"]], Int[np.ndarray, " n"]]:
    """Return the distinct rows of each group in order, with their groups, and the index of each row among them.

    The result is that of `np.unique` by rows, which sorts whole rows and takes five times as long.
    """
    order = np.lexsort((*rows.T[::-1], group))
    ordered, groups = rows[order], group[order]
    new = np.ones(len(rows), bool)
    new[1:] = (ordered[1:] != ordered[:-1]).any(axis=1) | (groups[1:] != groups[:-1])
    inverse = np.empty(len(rows), np.int64)
    inverse[order] = np.cumsum(new) - 1
    return (groups[new], ordered[new]), inverse


def _of(number: int, found: tuple[Int[np.ndarray, " m"], Real[np.ndarray, "m d"]]) -> Real[np.ndarray, "k d"]:
    """Return the rows of group `number` from a result of `_unique`; empty if it has none."""
    groups, rows = found
    return rows[slice(*np.searchsorted(groups, [number, number + 1]).tolist())]


def mtl_text(materials: tuple[Material, ...]) -> str:
    """Return material slots as MTL text in order; textures are named as `../../texture/<file name>`."""
    return "\n".join(_newmtl(material) for material in materials)


def _newmtl(material: Material) -> str:
    """Return the MTL statements of a material; missing colour and opacity are written as white and opaque.

    The name of a missing texture is not written.
    """
    color = " ".join(f"{x:.6g}" for x in material.diffuse or (1.0, 1.0, 1.0))
    opacity = 1.0 if material.opacity is None else material.opacity
    lines = [f"newmtl {material.name}", "illum 2", f"d {opacity:g}", f"Kd {color}"]
    if material.shininess is not None:
        lines.append(f"Ns {material.shininess:g}")
    if material.specular is not None:
        lines.append("Ks " + " ".join(f"{x:.6g}" for x in material.specular))
    if material.texture is not None:
        lines.append(f"map_Kd ../../texture/{material.texture.name}")
    return "\n".join(lines) + "\n"
