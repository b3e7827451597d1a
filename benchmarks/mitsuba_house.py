"""Write one house of a bank as a scene of Mitsuba 3 and trace its paths: lamps, sky and sun of the shader `lit`.

What differs from the shaders on purpose: lamps are spheres of `BULB` with the same flux, and panels are rectangles.
Models that carry lamps and panes of glass are left out, since light passes both in the bake.
"""

import functools
import math
from dataclasses import dataclass, fields

import mitsuba as mi
import numpy as np

from home_mjx.bank.bank import HouseBank
from home_mjx.core.color import decode_srgb
from home_mjx.raycast_render.lighting import lights
from home_mjx.raycast_render.lighting.sun_and_sky import sun_redness
from home_mjx.raycast_render.lighting.texture import texture_edge
from home_mjx.raycast_render.shaders import lit
from home_mjx.schema.compiled import RayKind

BULB = 0.05  # [m], radius of lamps
MAX_DEPTH, ROULETTE_DEPTH = 9, 6  # vertices of paths: nine are eight bounces
SPP_PER_CALL = 16
SKY_WIDTH = 256  # [px]
OPAQUE_ALPHA = 128
mi.set_variant("llvm_ad_rgb")
T = mi.ScalarTransform4f


@dataclass(frozen=True)
class Soup:
    """Triangles of a house in the world, with all that light needs of them."""

    triangle: np.ndarray  # (t, 3, 3) [m]
    uv: np.ndarray  # (t, 3, 2)
    normal: np.ndarray  # (t, 3, 3) unit, of corners
    row: np.ndarray  # (t,) material
    instance: np.ndarray  # (t,)

    def take(self, rows: np.ndarray) -> "Soup":
        """Return the triangles `rows`."""
        return Soup(*(getattr(self, f.name)[rows] for f in fields(self)))


def read_soup(bank: HouseBank, house: int) -> Soup:
    """Return all triangles of a house of the bank; movable objects and doors as placed in its file."""
    g = bank.geometry
    child, root = np.asarray(g.node_child), np.asarray(g.model_root)
    corners, uv, normal = np.asarray(g.triangle), np.asarray(g.triangle_uv), np.asarray(bank.finish.normal)
    slot, first = np.asarray(g.triangle_slot), np.asarray(g.instance_material[house])
    models, poses = np.asarray(g.instance_model[house]), np.asarray(g.instance_pose[house], np.float64)
    rows, parts = functools.cache(lambda model: _triangles(child, int(root[model]))), []
    for i in np.flatnonzero(models >= 0):
        k, pose = rows(int(models[i])), poses[i]
        n = normal[k] @ np.linalg.inv(pose[:, :3])
        n /= np.maximum(np.linalg.norm(n, axis=-1, keepdims=True), 1e-12)
        side = slice(None, None, -1 if np.linalg.det(pose[:, :3]) < 0 else 1)
        t = corners[k] @ pose[:, :3].T + pose[:, 3]
        parts.append((t[:, side], uv[k][:, side], n[:, side], first[i] + slot[k], np.full(len(k), i)))
    return Soup(*(np.concatenate(x) for x in zip(*parts, strict=True)))


def _triangles(child: np.ndarray, root: int) -> np.ndarray:
    """Return the rows of all triangles below a node."""
    found, stack = [], [root]
    while stack:
        for code in child[stack.pop()].tolist():
            if code >= 0:
                stack.append(code)
            elif code != -1:
                found.extend(range(~code >> 4, (~code >> 4) + (~code & 15)))
    return np.unique(np.array(found, np.int64))


def lamp_carriers(bank: HouseBank, house: int) -> np.ndarray:
    """Return the instances that carry lamps, which the scene leaves out."""
    table = bank.lights
    carrier, daylight = np.asarray(table.instance[house]), np.asarray(table.daylight[house])
    return np.unique(carrier[(carrier > 0) & ~daylight])


def build(bank: HouseBank, house: int, options: lit.LitShader, near: np.ndarray, gloss: bool = False) -> mi.Scene:
    """Return the scene of a house under the lamps, sky and sun of `options`.

    Lamps are chosen for shadow rays by their power over the square of their distance from `near` [m]: that changes the
    noise, not the mean. With `gloss`, surfaces have the bank's specular reflectance and roughness, else they are matt.
    """
    soup, finish = read_soup(bank, house), bank.finish
    mask, albedo = np.asarray(bank.geometry.material_mask), np.asarray(bank.materials.albedo)
    seen = (mask[soup.row] & int(RayKind.LIGHT) > 0) & (albedo[soup.row, 3] >= 0.05)
    soup = soup.take(np.flatnonzero(seen & ~np.isin(soup.instance, lamp_carriers(bank, house))))
    shine, rough = np.asarray(finish.specular), np.sqrt(2 / (np.asarray(finish.shininess) + 2))
    mirror, texture = np.asarray(finish.mirror), np.asarray(bank.materials.texture)
    scene: dict = {"type": "scene"}
    for row in np.unique(soup.row):
        color = _paint(bank, int(texture[row]), albedo[row, :3])
        bsdf = {"type": "diffuse", "reflectance": color}
        if mirror[row]:
            bsdf = {"type": "conductor", "material": "none", "specular_reflectance": _rgb(albedo[row, :3])}
        elif gloss and shine[row].max() > 0:
            bsdf = _coat(color, shine[row], float(rough[row]))
        bsdf = _cut(bank, int(texture[row]), {"type": "twosided", "b": bsdf})
        scene[f"row{row}"] = _mesh(soup.take(np.flatnonzero(soup.row == row)), bsdf)
    scene |= {f"lamp{i}": lamp for i, lamp in enumerate(_lamps(bank, house, soup, near))}
    return mi.load_dict(scene | _sky_and_sun(options))


def _coat(color: dict, specular: np.ndarray, alpha: float) -> dict:
    """Return a surface with a base colour under a GGX coat of the bank's specular reflectance."""
    level = float(np.clip(specular.max(), 0.0, 0.9))
    ior = (1 + math.sqrt(level)) / (1 - math.sqrt(level))
    tint = specular / max(level, 1e-6)
    return {
        "type": "roughplastic", "distribution": "ggx", "alpha": float(np.clip(alpha, 0.03, 0.9)),
        "int_ior": float(np.clip(ior, 1.01, 30.0)), "diffuse_reflectance": color, "specular_reflectance": _rgb(tint),
    }  # fmt: skip


def _rgb(color: np.ndarray) -> dict:
    """Return a linear colour, clipped to [0, 1]."""
    return {"type": "rgb", "value": np.clip(color, 0, 1).tolist()}


def _layer(bank: HouseBank, layer: int) -> np.ndarray:
    """Return the texels of a layer."""
    textures = bank.materials.textures
    edge = texture_edge(textures)
    packed = np.asarray(textures[layer, : edge * edge]).reshape(edge, edge)
    return np.stack([packed >> shift & 255 for shift in (0, 8, 16, 24)], axis=-1).astype(np.uint8)


def _paint(bank: HouseBank, layer: int, tint: np.ndarray) -> dict:
    """Return the reflectance of a material: its colour, times its texture if it has one."""
    if layer < 0:
        return _rgb(tint)
    color = decode_srgb(_layer(bank, layer)[..., :3] / 255) * tint
    return {"type": "bitmap", "bitmap": mi.Bitmap(np.ascontiguousarray(color.astype(np.float32))), "raw": True}


def _cut(bank: HouseBank, layer: int, bsdf: dict) -> dict:
    """Return the surface with the holes of its texture."""
    alpha = np.zeros(0) if layer < 0 else _layer(bank, layer)[..., 3:]
    if not (alpha < OPAQUE_ALPHA).any():
        return bsdf
    opaque = mi.Bitmap(np.ascontiguousarray((alpha >= OPAQUE_ALPHA).astype(np.float32)))
    return {"type": "mask", "opacity": {"type": "bitmap", "bitmap": opaque, "raw": True, "filter_type": "nearest"}} | {
        "b": bsdf
    }


def _mesh(soup: Soup, bsdf: dict) -> mi.Mesh:
    """Return a mesh of triangles with one surface; v is mirrored: bitmaps begin at the top, v at the bottom."""
    number, props = len(soup.row), mi.Properties()
    props["mesh_bsdf"] = mi.load_dict(bsdf)
    mesh = mi.Mesh("m", 3 * number, number, has_vertex_normals=True, has_vertex_texcoords=True, props=props)
    params = mi.traverse(mesh)
    params["vertex_positions"] = soup.triangle.astype(np.float32).ravel()
    params["vertex_normals"] = soup.normal.astype(np.float32).ravel()
    params["vertex_texcoords"] = (np.array([0, 1]) + np.array([1, -1]) * soup.uv).astype(np.float32).ravel()
    params["faces"] = np.arange(3 * number, dtype=np.uint32)
    params.update()
    return mesh


def _lamps(bank: HouseBank, house: int, soup: Soup, near: np.ndarray) -> list[dict]:
    """Return emitters of the lamps' flux; those that would stick in a ceiling hang lower."""
    table, poses = bank.lights, np.asarray(bank.geometry.instance_pose[house], np.float64)
    get = {name: np.asarray(getattr(table, name)[house]) for name in ("instance", "daylight", "intensity", "area")}
    lit_rows = np.flatnonzero((get["instance"] >= 0) & ~get["daylight"] & (get["intensity"].max(axis=1) > 0))
    top, made = soup.triangle[soup.instance == 0].reshape(-1, 3)[:, 2], []
    for i in lit_rows:
        turn, shift = poses[get["instance"][i], :, :3], poses[get["instance"][i], :, 3]
        pos, light = turn @ np.asarray(table.pos[house, i]) + shift, get["intensity"][i]
        away = pos - near
        weight = float(light.mean() / (2 + (away[:2] ** 2).sum() + 4 * away[2] ** 2) ** 1.5 + 1e-3)
        if get["area"][i] > 0:
            u, v, aim = (turn @ np.asarray(getattr(table, n)[house, i]) for n in ("axis_u", "axis_v", "direction"))
            frame = np.eye(4)
            frame[:3] = np.stack([u, v, np.cross(u, v), pos], axis=1)
            shape = {"type": "rectangle", "to_world": T(frame), "flip_normals": bool(frame[:3, 2] @ aim < 0)}
            radiance = light / get["area"][i]
        else:
            pos[2] = min(pos[2], top[top > pos[2] - BULB].min(initial=math.inf) - 1.3 * BULB)
            shape, radiance = {"type": "sphere", "center": pos.tolist(), "radius": BULB}, light / (math.pi * BULB**2)
        emitter = {"type": "area", "sampling_weight": weight, "radiance": {"type": "rgb", "value": radiance.tolist()}}
        made.append(shape | {"emitter": emitter})
    return made


def _sky_and_sun(options: lit.LitShader) -> dict:
    """Return the sky as an environment map and the sun as a distant light; without those that are dark."""
    found: dict = {}
    redness = sun_redness(options.sun_elevation)
    if options.sky > 0:
        up = np.cos((np.arange(SKY_WIDTH // 2) + 0.5) / (SKY_WIDTH // 2) * np.pi)[:, None]
        horizon = _mix(lit.HORIZON_COLOR, lit.DUSK_COLOR, redness)
        above = horizon + (np.array(lit.ZENITH_COLOR) - horizon) * np.sqrt(np.clip(up, 0, 1))
        rows = np.where(up >= 0, above, np.array(lit.GROUND_COLOR)) * options.sky
        pixels = np.repeat(rows[:, None], SKY_WIDTH, axis=1).astype(np.float32)
        turn = T().rotate([1, 0, 0], 90)
        found["sky"] = {"type": "envmap", "bitmap": mi.Bitmap(pixels), "to_world": turn, "sampling_weight": 0.6}
    if options.sun > 0:
        azimuth, elevation = math.radians(options.sun_azimuth), math.radians(options.sun_elevation)
        flat = math.cos(elevation)
        aim = [-math.cos(azimuth) * flat, -math.sin(azimuth) * flat, -math.sin(elevation)]
        color = options.sun * _mix(lights.SUN_COLOR, lights.SUNSET_COLOR, redness)
        rgb = {"type": "rgb", "value": color.tolist()}
        found["sun"] = {"type": "directional", "direction": aim, "irradiance": rgb, "sampling_weight": 0.4}
    return found


def _mix(first: tuple[float, ...], second: tuple[float, ...], share: float) -> np.ndarray:
    """Interpolate between colours."""
    return np.array(first) + (np.array(second) - np.array(first)) * share


def camera_of(pos: np.ndarray, yaw: float, pitch: float, fovy: float, size: int) -> dict:
    """Return a square pinhole camera; angles in radians."""
    ahead = np.array([math.cos(yaw) * math.cos(pitch), math.sin(yaw) * math.cos(pitch), math.sin(pitch)])
    film = {"type": "hdrfilm", "width": size, "height": size, "pixel_format": "rgb", "rfilter": {"type": "box"}}
    pose = T().look_at(origin=pos.tolist(), target=(pos + ahead).tolist(), up=[0, 0, 1])
    return {
        "type": "perspective", "fov": math.degrees(fovy), "fov_axis": "y", "near_clip": 0.01, "to_world": pose,
        "film": film | {"component_format": "float32"},
    }  # fmt: skip


def trace(scene: mi.Scene, camera: dict, spp: int) -> np.ndarray:
    """Return linear light (size, size, 3), the mean of `spp` paths per pixel."""
    sensor = mi.load_dict(camera)
    paths = mi.load_dict({"type": "path", "max_depth": MAX_DEPTH, "rr_depth": ROULETTE_DEPTH})
    calls = [
        np.array(mi.render(scene, sensor=sensor, integrator=paths, spp=SPP_PER_CALL, seed=seed))
        for seed in range(max(1, spp // SPP_PER_CALL))
    ]
    return np.mean(calls, axis=0)


def features(scene: mi.Scene, camera: dict, spp: int = 8) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return mean albedo, normal and distance of first hits (size, size, ...), for denoising and masks."""
    aov = mi.load_dict({"type": "aov", "aovs": "a:albedo,n:sh_normal,d:depth"})
    found = np.array(mi.render(scene, sensor=mi.load_dict(camera), integrator=aov, spp=spp)).astype(np.float32)
    return found[..., -7:-4], found[..., -4:-1], found[..., -1]


def denoise(light: np.ndarray, albedo: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Return the light without noise, by Open Image Denoise; it blurs fine textures if samples are few."""
    import pyoidn

    color, albedo, normal = (np.ascontiguousarray(x, np.float32) for x in (light, np.clip(albedo, 0, 1), normal))
    return pyoidn.denoise(color, albedo=albedo, normal=normal, hdr=True)
