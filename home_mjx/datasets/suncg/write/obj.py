"""OBJ and MTL text of a `Mesh` in SUNCG's dialect: one `mtllib`, blocks per group and material, v/vt/vn corners."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float, Int

from home_mjx.schema.house import Material, Mesh

DECIMALS = 6  # of metres


def obj_text(mesh: Mesh, library: str) -> str:
    """The mesh as OBJ text, with its own normals, or else flat ones.

    Args:
        mesh: What to write; faces of one group and material become one block.
        library: Name of the MTL file.
    """
    lines = [f"mtllib {library}"]
    first = np.ones(3, int)  # OBJ indices of v, vt and vn start at 1 and run on over all groups
    for name, faces in _groups(mesh):
        lines += [f"o {name}"] if name else []
        block, count = _block(mesh, faces, first)
        lines += block
        first = first + count
    return "\n".join(lines) + "\n"


def _groups(mesh: Mesh) -> Iterator[tuple[str, Int[np.ndarray, " n"]]]:
    for index in np.unique(mesh.group):
        yield (mesh.groups[index] if index >= 0 else ""), np.flatnonzero(mesh.group == index)


def _block(
    mesh: Mesh, faces: Int[np.ndarray, " n"], first: Int[np.ndarray, " 3"]
) -> tuple[list[str], Int[np.ndarray, " 3"]]:
    """Lines of some faces, and the number of v, vt and vn in them."""
    used, corner = np.unique(mesh.faces[faces], return_inverse=True)
    positions = _rounded(mesh.vertices[used])
    uvs, uv = _unique(mesh.uv[faces].reshape(-1, 2))
    normals, normal = _unique(_flat(mesh, faces) if mesh.normal is None else mesh.normal[faces].reshape(-1, 3))
    lines = [f"v {x} {y} {z}" for x, y, z in positions.tolist()]
    lines += [f"vt {u} {v}" for u, v in uvs.tolist()]
    lines += [f"vn {x} {y} {z}" for x, y, z in normals.tolist()]
    index = np.stack([corner.reshape(-1, 3), uv.reshape(-1, 3), normal.reshape(-1, 3)], -1) + first
    slot = mesh.slot[faces]
    for number in np.unique(slot):
        lines.append(f"usemtl {mesh.materials[number].name}")
        lines += ["f {}/{}/{} {}/{}/{} {}/{}/{}".format(*row) for row in index[slot == number].reshape(-1, 9).tolist()]
    return lines, np.array([len(positions), len(uvs), len(normals)])


def _flat(mesh: Mesh, faces: Int[np.ndarray, " n"]) -> Float[np.ndarray, "c 3"]:
    """The normal of each face, for its three corners."""
    corners = mesh.vertices[mesh.faces[faces]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    return np.repeat(normal / np.where(length > 0, length, 1), 3, axis=0)


def _rounded(rows: Float[np.ndarray, "n d"]) -> Float[np.ndarray, "n d"]:
    return np.round(rows, DECIMALS) + 0.0  # adding 0 turns -0 into 0


def _unique(rows: Float[np.ndarray, "n d"]) -> tuple[Float[np.ndarray, "m d"], Int[np.ndarray, " n"]]:
    """As `np.unique` by rows, whose sorting of whole rows takes five times as long."""
    rounded = _rounded(rows)
    order = np.lexsort(rounded.T[::-1])
    ordered = rounded[order]
    new = np.ones(len(rows), bool)
    new[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    inverse = np.empty(len(rows), np.int64)
    inverse[order] = np.cumsum(new) - 1
    return ordered[new], inverse


def mtl_text(materials: tuple[Material, ...]) -> str:
    """The material slots as MTL text; textures are in `../../texture/`."""
    return "\n".join(_newmtl(material) for material in materials)


def _newmtl(material: Material) -> str:
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
