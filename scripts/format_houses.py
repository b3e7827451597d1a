"""Write compiled houses as USD scenes and as houses of 3D-FRONT, to be read back for pictures of their pages."""

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from home_mjx.core.color import decode_srgb
from home_mjx.geometry.meshes import transform
from home_mjx.geometry.slabs import simplify, triangulate
from home_mjx.scene_compile.mjcf.room_file import room_file
from home_mjx.schema.categories import FINE
from home_mjx.schema.compiled import ARCHITECTURE, CompiledHouse
from home_mjx.schema.lighting import LUMENS_PER_WATT
from home_mjx.schema.semantic import Semantic

SLOPE = 0.7  # maximum vertical component of the unit normals of walls


def parts(house: CompiledHouse, instance: int) -> Iterator[tuple[np.ndarray, np.ndarray, int]]:
    """Yield world triangles, texture coordinates and the row of the material of each slot of an instance."""
    table = house.instances
    model = house.models[table.model[instance]]
    corners = transform(table.pose[instance].astype(float), model.triangle.astype(float))
    if np.linalg.det(table.pose[instance][:, :3]) < 0:
        corners = corners[:, ::-1]
    for slot in np.unique(model.slot).tolist():
        mine = model.slot == slot
        uv = model.uv[mine] if np.linalg.det(table.pose[instance][:, :3]) > 0 else model.uv[mine][:, ::-1]
        yield corners[mine], uv, int(table.material[instance]) + slot


def category(house: CompiledHouse, instance: int) -> str:
    """Return the fine category of an instance; "" for the architecture and unknown things."""
    fine = int(house.semantics[house.instances.semantic[instance], Semantic.FINE])
    return FINE[fine] if instance != ARCHITECTURE and fine >= 0 else ""


def write_usd(house: CompiledHouse, path: Path) -> Path:
    """Write a house as a `.usda` file, z up and in metres, with its images and rooms beside it; return its path."""
    lines = ['#usda 1.0\n(upAxis = "Z"; metersPerUnit = 1)\n']
    used: set[int] = set()
    for instance in range(len(house.instances.model)):
        lines.append(f'def Xform "{category(house, instance) or "part"}_{instance}" {{\n')
        for number, (corners, uv, row) in enumerate(parts(house, instance)):
            used.add(row)
            points = ",".join(f"({x:.5f},{y:.5f},{z:.5f})" for x, y, z in corners.reshape(-1, 3).tolist())
            st = ",".join(f"({u:.5f},{v:.5f})" for u, v in uv.reshape(-1, 2).tolist())
            count = len(corners)
            lines.append(
                f'def Mesh "m{number}" (prepend apiSchemas = ["MaterialBindingAPI"]) {{\n'
                f"point3f[] points = [{points}]\n"
                f"int[] faceVertexCounts = [{','.join(['3'] * count)}]\n"
                f"int[] faceVertexIndices = [{','.join(map(str, range(3 * count)))}]\n"
                f'texCoord2f[] primvars:st = [{st}] (interpolation = "faceVarying")\n'
                f"rel material:binding = </material{row}>\n}}\n"
            )
        lines.append("}\n")
    lines += [_usd_light(house, row) for row in range(len(house.lights.instance))]
    path.with_suffix(".rooms.json").write_bytes(room_file(house, has_objects=False))
    path.write_text("".join(lines) + "".join(_usd_material(house, row, path.parent) for row in sorted(used)))
    return path


def _usd_light(house: CompiledHouse, row: int) -> str:
    """Return a lamp as a `SphereLight`; "" for daylight."""
    table = house.lights
    peak = float(table.intensity[row].max())
    if table.daylight[row] or not peak:
        return ""
    place = transform(house.instances.pose[table.instance[row]].astype(float), table.pos[row].astype(float))
    return (
        f'def SphereLight "lamp{row}" {{\nbool inputs:normalize = true\n'
        f"float inputs:intensity = {4 * peak * LUMENS_PER_WATT}\n"
        f"color3f inputs:color = {tuple((table.intensity[row] / peak).tolist())}\n"
        f"double3 xformOp:translate = {tuple(place.tolist())}\n"
        'uniform token[] xformOpOrder = ["xformOp:translate"]\n}\n'
    )


def _usd_material(house: CompiledHouse, row: int, folder: Path) -> str:
    """Return a `UsdPreviewSurface` with the texture or the colour of a row of the table of materials."""
    red, green, blue = decode_srgb(house.materials.albedo[row, :3]).tolist()
    texture, reader = house.materials.texture[row], ""
    color = f"color3f inputs:diffuseColor = ({red}, {green}, {blue})"
    if texture:
        shutil.copy(texture, folder / Path(texture).name)
        color = f"color3f inputs:diffuseColor.connect = </material{row}/t.outputs:rgb>"
        reader = (
            'def Shader "t" {\nuniform token info:id = "UsdUVTexture"\n'
            f"asset inputs:file = @./{Path(texture).name}@\nfloat3 outputs:rgb\n}}\n"
        )
    return (
        f'def Material "material{row}" {{\ntoken outputs:surface.connect = </material{row}/s.outputs:surface>\n'
        f'def Shader "s" {{\nuniform token info:id = "UsdPreviewSurface"\n{color}\n'
        f"float inputs:opacity = {float(house.materials.albedo[row, 3])}\ntoken outputs:surface\n}}\n{reader}}}\n"
    )


def write_front(house: CompiledHouse, folder: Path) -> Path:
    """Write a house as a file of 3D-FRONT with models of the form of 3D-FUTURE's beside it; return its path."""
    meshes, materials, furniture, children = [], [], [], []
    for number, polygon in enumerate(house.rooms.polygon):
        shape = simplify(polygon)
        plan = shape[triangulate(shape)]
        for kind, height, row in (("Floor", house.rooms.floor, 1), ("Ceiling", house.rooms.ceiling, -1)):
            corners = np.concatenate([plan, np.full((*plan.shape[:2], 1), height[number])], axis=2)
            meshes.append(_front_mesh(f"{kind}{number}", kind, corners[:, ::row]))
    for corners, _, row in parts(house, ARCHITECTURE):
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        steep = abs(normal[:, 2]) < SLOPE * np.linalg.norm(normal, axis=1)
        if steep.any():
            meshes.append(_front_mesh(f"wall{row}", "WallInner", corners[steep]) | {"material": f"m{row}"})
            color = (255 * house.materials.albedo[row, :3]).round().tolist()
            materials.append({"uid": f"m{row}", "color": [*color, 255]})
    for instance in range(ARCHITECTURE + 1, len(house.instances.model)):
        name = category(house, instance)
        if name and name not in ("door", "arch"):
            _write_model(house, instance, folder / "3D-FUTURE-model" / f"model{instance}")
            words = name.replace("_", " ")
            piece = {"uid": f"f{instance}", "jid": f"model{instance}", "valid": True, "category": words, "title": words}
            furniture.append(piece)
            children.append({"ref": f"f{instance}", "pos": [0, 0, 0], "rot": [0, 0, 0, 1], "scale": [1, 1, 1]})
    shared = [{"ref": mesh["uid"]} for mesh in meshes if mesh["type"] == "WallInner"] + children
    rooms = [
        {"type": "OtherRoom", "children": [{"ref": f"Floor{n}"}, {"ref": f"Ceiling{n}"}, *(shared if n == 0 else [])]}
        for n in range(len(house.rooms.polygon))
    ]
    document = {
        "uid": house.id,
        "mesh": meshes,
        "material": materials,
        "furniture": furniture,
        "scene": {"room": rooms},
    }
    path = folder / "house.json"
    path.write_text(json.dumps(document))
    return path


def _front_mesh(uid: str, kind: str, corners: np.ndarray) -> dict[str, Any]:
    """Return a mesh of the building, y up."""
    flat = corners.reshape(-1, 3)[:, [0, 2, 1]] * [1, 1, -1]
    return {"uid": uid, "type": kind, "xyz": flat.ravel().tolist(), "faces": list(range(len(flat)))}


def _write_model(house: CompiledHouse, instance: int, folder: Path) -> None:
    """Write an instance, where it stands, as `raw_model.obj` with its materials and images."""
    folder.mkdir(parents=True)
    lines, looks, count = ["mtllib model.mtl"], [], 0
    for corners, uv, row in parts(house, instance):
        flat = corners.reshape(-1, 3)[:, [0, 2, 1]] * [1, 1, -1]
        lines += [f"v {x:.5f} {y:.5f} {z:.5f}" for x, y, z in flat.tolist()]
        lines += [f"vt {u:.5f} {v:.5f}" for u, v in uv.reshape(-1, 2).tolist()]
        lines.append(f"usemtl m{row}")
        corner = np.arange(count + 1, count + len(flat) + 1).reshape(-1, 3).tolist()
        lines += ["f " + " ".join(f"{k}/{k}" for k in face) for face in corner]
        count += len(flat)
        red, green, blue = house.materials.albedo[row, :3].tolist()
        texture = house.materials.texture[row]
        image = f"\nmap_Kd {Path(texture).name}" if texture else ""
        looks.append(f"newmtl m{row}\nKd {red} {green} {blue}{image}")
        if texture:
            shutil.copy(texture, folder / Path(texture).name)
    (folder / "raw_model.obj").write_text("\n".join(lines) + "\n")
    (folder / "model.mtl").write_text("\n".join(looks) + "\n")
