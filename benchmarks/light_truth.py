"""Compare irradiances of `lit` and `baked` with a path trace at random points of homes: one JSON object per line.

    python benchmarks/light_truth.py "procedural:2?seed=4101" --points 1000 --samples 2048

The path tracer shares no code with the bake: it takes triangles of compiled houses, casts by Embree, chooses one lamp
per vertex by its unoccluded light, and ends paths by chance. Lamps are spheres of 5 cm or rectangles; light passes
glass and the models of lamps; surfaces have the mean colour of their textures; doors are as placed; nothing is movable.
Points are hits of random rays from random heights above random walkable cells, where cameras may be. Errors are
relative, of luminance, per source and in total; `noise` is the median relative difference between the halves of the
samples, times 0.5.
"""

import argparse
import dataclasses
import json
import math
import sys
import time
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh
from PIL import Image

from home_mjx.bank.bank import HouseBank
from home_mjx.houses import HouseSet, add_bakes
from home_mjx.light_probes import LightProbeBake, ProbeOptions
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.lighting import lights
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.scene.surface import semantics
from home_mjx.raycast_render.scene.types import Hit
from home_mjx.raycast_render.scene.vec import Vec
from home_mjx.raycast_render.shaders import lit
from home_mjx.raycast_render.shaders.baked import BakedShader
from home_mjx.schema.compiled import CompiledHouse, RayKind
from home_mjx.schema.semantic import Semantic

SOURCES = ("lamps", "sky", "sun")
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
BULB = 0.05  # [m]
BIAS = 1e-3  # [m]
ROULETTE_START, MAX_BOUNCES = 3, 64
CHUNK = 1 << 17


class PathTracer:
    """Triangles of one house, its lamps, sun and sky."""

    def __init__(self, house: CompiledHouse, options: lit.LitShader) -> None:
        table, pose = house.lights, house.instances.pose
        lamp = np.flatnonzero(~table.daylight & (table.intensity.max(axis=1, initial=0) > 0))
        carrier = table.instance[lamp]
        hidden = set(carrier[carrier > 0].tolist()) | set(np.flatnonzero(house.instances.body >= 0).tolist())
        color, solid = _colors(house), house.materials.mask & int(RayKind.LIGHT) > 0
        corners, albedo = [], []
        for i, key in enumerate(house.instances.model):
            model = house.models[key]
            row = house.instances.material[i] + model.slot
            keep = solid[row] & (i not in hidden)
            corners.append((model.triangle @ pose[i, :, :3].T + pose[i, :, 3])[keep])
            albedo.append(color[row][keep])
        triangles = np.concatenate(corners)
        self.albedo = np.concatenate(albedo)
        normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        self.normal = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-20)
        self.scene = rtcore_scene.EmbreeScene()
        TriangleMesh(self.scene, triangles.astype(np.float32))
        turn = pose[np.maximum(carrier, 0), :, :3]
        self.pos = np.einsum("kij,kj->ki", turn, table.pos[lamp]) + pose[np.maximum(carrier, 0), :, 3]
        self.u, self.v, self.aim = (
            np.einsum("kij,kj->ki", turn, x[lamp]) for x in (table.axis_u, table.axis_v, table.direction)
        )
        self.aim /= np.maximum(np.linalg.norm(self.aim, axis=1, keepdims=True), 1e-9)
        self.intensity, self.exponent, self.cutoff = table.intensity[lamp], table.exponent[lamp], table.cutoff[lamp]
        a, e = math.radians(options.sun_azimuth), math.radians(options.sun_elevation)
        self.to_sun = np.array([math.cos(a) * math.cos(e), math.sin(a) * math.cos(e), math.sin(e)])
        self.sun, self.sky, self.random = (
            options.sun * np.array(lights.SUN_COLOR),
            options.sky,
            np.random.default_rng(7),
        )

    def irradiance(self, pos: np.ndarray, normal: np.ndarray, samples: int) -> np.ndarray:
        """Return irradiance (points, sources, 3) with `samples` paths per point."""
        total = np.zeros((len(pos), len(SOURCES), 3))
        per = max(1, CHUNK // len(pos))
        for start in range(0, samples, per):
            count = min(per, samples - start)
            total += (
                self._paths(np.repeat(pos, count, 0), np.repeat(normal, count, 0))
                .reshape(len(pos), count, -1, 3)
                .sum(1)
            )
        return total / samples

    def _paths(self, pos: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """Return irradiance (n, sources, 3), one path per row."""
        found, alive, weight = np.zeros((len(pos), len(SOURCES), 3)), np.arange(len(pos)), np.ones((len(pos), 3))
        for bounce in range(MAX_BOUNCES):
            if len(alive) == 0:
                break
            start = pos + BIAS * normal
            found[alive, 0] += weight * self._lamps(start, normal)
            cosine = normal @ self.to_sun
            sunny = (cosine > 0) & ~self._blocked(
                start, np.broadcast_to(self.to_sun, start.shape), np.full(len(start), 1e9)
            )
            found[alive, 2] += weight * (sunny * cosine)[:, None] * self.sun
            way = self._cosine(normal)
            hit = self.scene.run(start.astype(np.float32), way.astype(np.float32), query="INTERSECT", output=1)
            seen = hit["primID"] >= 0
            found[alive[~seen], 1] += (weight * math.pi * self._sky(way))[~seen]
            albedo, facing = self.albedo[hit["primID"][seen]], self.normal[hit["primID"][seen]]
            pos, way = (start + way * hit["tfar"][:, None])[seen], way[seen]
            normal = facing * np.where((facing * way).sum(1) > 0, -1, 1)[:, None]
            alive, weight = alive[seen], weight[seen] * albedo
            if bounce >= ROULETTE_START:
                chance = np.clip(weight.max(axis=1), 0.05, 0.95)
                goes = self.random.random(len(alive)) < chance
                pos, normal, alive, weight = pos[goes], normal[goes], alive[goes], (weight / chance[:, None])[goes]
        return found

    def _lamps(self, pos: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """Return irradiance by lamps: one, chosen by its unoccluded light, and one point on it."""
        if not len(self.pos):
            return np.zeros((len(pos), 3))
        way = self.pos[None] - pos[:, None]
        square = (way**2).sum(-1)
        guess = (
            self.intensity.mean(1)
            / (square + 0.05)
            * (0.05 + np.maximum((way * normal[:, None]).sum(-1), 0) / np.sqrt(square))
        )
        guess = np.cumsum(guess, axis=1)
        k = (self.random.random((len(pos), 1)) * guess[:, -1:] > guess).sum(1).clip(0, len(self.pos) - 1)
        chance = np.diff(guess, axis=1, prepend=0)[np.arange(len(pos)), k] / guess[:, -1]
        r = self.random.random((len(pos), 2)) * 2 - 1
        target = self.pos[k] + r[:, :1] * self.u[k] + r[:, 1:] * self.v[k]
        ring = np.sqrt(1 - r[:, 0] ** 2)
        ball = np.stack([ring * np.cos(math.pi * r[:, 1]), ring * np.sin(math.pi * r[:, 1]), r[:, 0]], 1)
        target += BULB * ball * ~self.v[k].any(axis=1, keepdims=True)
        way = target - pos
        far = np.linalg.norm(way, axis=1)
        way /= far[:, None]
        out = -(way * self.aim[k]).sum(1)
        profile = np.where(out >= self.cutoff[k], np.maximum(out, 1e-6) ** self.exponent[k], 0)
        share = profile * np.maximum((way * normal).sum(1), 0) / np.maximum(far, 0.1) ** 2 / chance
        clear = ~self._blocked(pos, way, np.maximum(far - 1.1 * BULB, 1e-6))
        return self.intensity[k] * (share * clear)[:, None]

    def _blocked(self, pos: np.ndarray, way: np.ndarray, far: np.ndarray) -> np.ndarray:
        """Return whether anything is nearer than `far`."""
        found = self.scene.run(pos.astype(np.float32), way.astype(np.float32), query="DISTANCE")
        return found < far

    def _cosine(self, normal: np.ndarray) -> np.ndarray:
        """Return random directions, distributed by the cosine."""
        ball = self.random.normal(size=normal.shape)
        way = normal + ball / np.linalg.norm(ball, axis=1, keepdims=True) * 0.9999
        return way / np.linalg.norm(way, axis=1, keepdims=True)

    def _sky(self, way: np.ndarray) -> np.ndarray:
        """Return the sky's radiance."""
        high = np.sqrt(np.clip(way[:, 2:], 0, 1))
        zenith, horizon, ground = (np.array(x) for x in (lit.ZENITH_COLOR, lit.HORIZON_COLOR, lit.GROUND_COLOR))
        return np.where(way[:, 2:] >= 0, horizon + (zenith - horizon) * high, ground) * self.sky


def _colors(house: CompiledHouse) -> np.ndarray:
    """Return the mean linear colour of each material row."""
    mean = {"": np.ones(3)}
    for path in set(house.materials.texture) - {""}:
        pixels = np.asarray(Image.open(path).convert("RGBA").resize((128, 128), Image.Resampling.BOX)) / 255
        mean[path] = np.average(_linear(pixels[..., :3]).reshape(-1, 3), axis=0, weights=pixels[..., 3].ravel() + 1e-6)
    return _linear(house.materials.albedo[:, :3]) * np.stack([mean[path] for path in house.materials.texture])


def _linear(srgb: np.ndarray) -> np.ndarray:
    """Decode sRGB."""
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


class Points(NamedTuple):
    """Points of surfaces."""

    pos: np.ndarray
    normal: np.ndarray
    room: np.ndarray
    instance: np.ndarray
    triangle: np.ndarray


def random_points(house: CompiledHouse, scene, count: int) -> Points:
    """Return points of surfaces that random rays from walkable places of rooms hit."""
    rng, grid = np.random.default_rng(1), house.navigation
    cells = np.array(np.nonzero((grid.room >= 0) & (grid.region >= 0)))
    level, row, column = cells[:, rng.integers(cells.shape[1], size=4 * count)]
    plan = grid.origin + (np.stack([column, row], 1) + rng.random((len(row), 2))) * grid.cell
    height = grid.floor[level] + rng.uniform(0.3, grid.agent_height, len(row))
    origin = np.concatenate([plan, height[:, None]], 1).astype(np.float32)
    way = rng.normal(size=origin.shape).astype(np.float32)
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    hit = cast(scene, jnp.asarray(origin), jnp.asarray(way), mask=int(RayKind.LIGHT))
    room = np.asarray(semantics(scene, hit, int(Semantic.ROOM)))
    from home_mjx.raycast_render.scene.surface import face_normals

    normal = np.asarray(face_normals(scene, jnp.asarray(way), hit))
    instance = np.asarray(hit.instance)
    hidden = set(house.lights.instance[~house.lights.daylight].tolist()) - {0}
    hidden |= set(np.flatnonzero(house.instances.body >= 0).tolist())
    good = (instance >= 0) & np.asarray(hit.front) & ~np.isin(instance, list(hidden))
    pos = origin + way * np.where(instance < 0, 0, np.asarray(hit.t))[:, None]
    plan = np.floor(((pos + 0.1 * normal)[:, :2] - grid.origin) / grid.cell).astype(int)
    plan = np.clip(plan, 0, np.array(grid.room.shape[:0:-1]) - 1)
    indoors = grid.room[level, plan[:, 1], plan[:, 0]] >= 0
    good = np.flatnonzero(good & indoors)[:count]
    return Points(pos[good], normal[good], room[good], instance[good], np.asarray(hit.triangle)[good])


def lit_irradiance(scene, points: Points, options: lit.LitShader) -> jax.Array:
    """Return the irradiance of a shader (points, 3)."""
    at, up = (Vec.unpack(jnp.asarray(x, jnp.float32)) for x in points[:2])
    ones = jnp.ones(len(points.pos))
    instance, triangle, room = (jnp.asarray(x) for x in (points.instance, points.triangle, points.room))
    point = lights.ShadingPoint(at, up, up, up, ones, instance, room)
    hit = Hit(ones, instance, triangle, ones, ones, instance >= 0)
    return options.incident(scene, hit, point, None)[0].pack()


def by_source(scene, points: Points, options: lit.LitShader) -> np.ndarray:
    """Return the irradiance of `lit` (points, sources, 3)."""
    run = jax.jit(lit_irradiance, static_argnums=2)
    night = run(scene, points, dataclasses.replace(options, sun=0.0, sky=0.0))
    sky = run(scene, points, dataclasses.replace(options, sun=0.0)) - night
    return np.stack([night, sky, run(scene, points, options) - night - sky], axis=1)


def errors(found: np.ndarray, truth: np.ndarray) -> dict[str, float]:
    """Return median, 90th percentile and bias of luminance in percent; points under 2 % of the mean do not count."""
    a, b = found @ LUMINANCE, truth @ LUMINANCE
    bright = b > 0.02 * b.mean()
    off = np.abs(a[bright] / b[bright] - 1)
    return {
        "median": round(100 * float(np.median(off)), 1),
        "p90": round(100 * float(np.quantile(off, 0.9)), 1),
        "bias": round(100 * float(a.sum() / b.sum() - 1), 1),
    }


def main() -> None:
    """Measure the houses of the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("houses")
    parser.add_argument("--points", type=int, default=1000)
    parser.add_argument("--samples", type=int, default=2048)
    parser.add_argument("--keep", help="file to which points and irradiances are written (npz)")
    args = parser.parse_args()
    houses, options = HouseSet(args.houses).load(), lit.LitShader()
    plain = HouseBank.from_compiled(houses)
    bank, alone = (add_bakes(plain, houses, LightProbeBake(o)) for o in (ProbeOptions(), ProbeOptions(texels=0.0)))
    runs = {
        "lit without a bake": (plain, lit.LitShader()),
        "lit, probes alone": (alone, lit.LitShader()),
        "lit": (bank, lit.LitShader()),
        "baked": (bank, BakedShader()),
    }
    for index, house in enumerate(houses):
        nobody = jnp.zeros((0, 3)), jnp.zeros((0, 4))
        physics = plain.physics
        gone = physics.body_pos[index].at[:, 2].add(-100.0)  # nothing movable
        scenes = {
            name: (make_scene(bank, jnp.int32(index), gone, physics.body_quat[index], *nobody), shader)
            for name, (bank, shader) in runs.items()
        }
        points, start = random_points(house, scenes["lit"][0], args.points), time.perf_counter()
        tracer = PathTracer(house, options)
        halves = [tracer.irradiance(*points[:2], args.samples // 2) for _ in range(2)]
        truth = (halves[0] + halves[1]) / 2
        noise = 0.5 * np.median(
            np.abs(np.diff([h.sum(1) @ LUMINANCE for h in halves], axis=0)[0])
            / np.maximum(truth.sum(1) @ LUMINANCE, 1e-9)
        )
        sys.stderr.write(f"{time.perf_counter() - start:.0f} s of path tracing\n")
        for name, (scene, shader) in scenes.items():
            found = by_source(scene, points, shader)
            if args.keep:
                np.savez(f"{args.keep}.{index}.{name[:9]}.npz", truth=truth, found=found, **points._asdict())
            line = {"house": house.id, "shader": name, "points": len(points[0]), "noise": round(100 * float(noise), 1)}
            line["total"] = errors(found.sum(1), truth.sum(1))
            line |= {source: errors(found[:, s], truth[:, s]) for s, source in enumerate(SOURCES)}
            sys.stdout.write(json.dumps(line) + "\n")


if __name__ == "__main__":
    jax.config.update("jax_platforms", "cpu")
    main()
