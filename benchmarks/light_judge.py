"""Judge images of rooms against a path trace by Mitsuba 3: FLIP, PSNR and SSIM of `fast`, `lit` and `baked`.

    pip install mitsuba pyoidn flip-evaluator     # Mitsuba's CPU variant needs LLVM 16 or later, DRJIT_LIBLLVM_PATH
    python benchmarks/light_judge.py --out judged  # twelve rooms of six homes; prints one JSON object per room

Writes a contact sheet per room: path trace, `baked`, `lit`, `fast`. Views are in corners of rooms, at 1.5 m. Exposures
are matched by the medians of luminance. Pixels of models that carry lamps do not count. The path trace is denoised, and
kept in the folder, so that a second run renders ours alone.

`floor` has the path trace's irradiance on our reflectances, one sample per pixel: no light could be better.
"""

import argparse
import functools
import json
import math
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
from PIL import Image
from scipy.ndimage import gaussian_filter

from home_mjx.bank.bank import HouseBank
from home_mjx.core.transforms import camera_quat
from home_mjx.houses import HouseSet, add_bakes
from home_mjx.raycast_render import Camera, Lens, Scene, Vec, make_scene, render
from home_mjx.raycast_render.lighting.lights import LUMINANCE
from home_mjx.raycast_render.lighting.texture import encode_srgb
from home_mjx.raycast_render.lighting.tone_curves import tone_map
from home_mjx.raycast_render.shaders.baked import BakedShader
from home_mjx.raycast_render.shaders.lit import LitShader, auto_exposure
from home_mjx.schema.categories import ROOM_TYPES

EYE, FOVY, PITCH = 1.5, 1.25, -0.16  # [m], [rad], [rad]
SIZE, SMALL = 256, 64  # [px]
TYPES = ("Living_Room", "Kitchen", "Bedroom", "Bathroom", "Dining_Room", "Office")
HOURS = {"day": {}, "22 h": {"hour": 22.0}}
FAR_HITS = 0.02  # [m], by which something in the path trace may be in front of our hit
CANDIDATES = 32


@dataclass(frozen=True)
class View:
    """A view of a room: index of the house, its room and type, position of the eye [m] and yaw [rad]."""

    house: int
    room: int
    type: str
    pos: np.ndarray
    yaw: float
    hour: str


@dataclass(frozen=True)
class Reflectance(LitShader):
    """Diffuse reflectance as `lit` filters it, by glass and mirrors too."""

    def incident(self, scene, hit, point, sample):
        """Return irradiance pi, and nothing specular."""
        one = jnp.ones_like(point.shininess)
        return Vec(one, one, one) * math.pi, Vec(one, one, one) * 0.0


def scene_of(bank: HouseBank, house: int) -> Scene:
    """Return a house with everything as placed, without agents."""
    nobody, physics = (jnp.zeros((0, 3)), jnp.zeros((0, 4))), bank.physics
    return make_scene(bank, jnp.int32(house), physics.body_pos[house], physics.body_quat[house], *nobody)


def camera_of(pos: np.ndarray, yaw: float) -> Camera:
    """Return the camera of a view."""
    return Camera(jnp.asarray(pos, jnp.float32), camera_quat(jnp.float32(yaw), jnp.float32(PITCH)), jnp.float32(FOVY))


@functools.lru_cache(maxsize=64)
def program(lens: Lens, kinds: tuple[str, ...], shader: object):
    """Return the compiled rendering of one camera."""
    return jax.jit(functools.partial(render, lens=lens, kinds=kinds, shader=shader, depth_max=None))


def images(bank: HouseBank, view: View, size: int, kinds: tuple[str, ...], shader: object = "fast", samples: int = 1):
    """Return images of a view by kind."""
    run = program(Lens(size, size, samples=samples), kinds, shader)
    return {k: np.asarray(v) for k, v in run(scene_of(bank, view.house), camera_of(view.pos, view.yaw)).items()}


def shader_of(kind: type, hour: str) -> LitShader:
    """Return a shader with the sun and sky of an hour."""
    return kind.from_hour(HOURS[hour]["hour"]) if HOURS[hour] else kind()


def find_view(bank: HouseBank, house: int, room: int, hour: str) -> View | None:
    """Return the view from the corner of a room that shows most things and is not blocked; None without free cells."""
    nav, cell = bank.navigation, bank.spec.cell
    rooms, origin = np.asarray(nav.room[house]), np.asarray(nav.origin[house])
    level, row, column = np.nonzero((rooms == room) & (np.asarray(nav.cell[house]) >= 0))
    if not len(row):
        return None
    places = origin + (np.stack([column, row], axis=-1) + 0.5) * cell
    whole = np.stack(np.nonzero(rooms == room)[::-1][:2], axis=-1)
    middle = origin + (whole.mean(axis=0) + 0.5) * cell
    order = np.argsort(-np.linalg.norm(places - middle, axis=1), kind="stable")
    best, kind = None, ROOM_TYPES[int(nav.room_type[house, room])]
    for k in order[:: max(1, len(order) // CANDIDATES)][:CANDIDATES]:
        pos = np.array([*places[k], np.asarray(nav.floor[house])[level[k]] + EYE], np.float64)
        view = View(house, room, kind, pos, math.atan2(*(middle - places[k])[::-1]), hour)
        seen = images(bank, view, 32, ("instance", "distance"))
        far = min(float(np.median(seen["distance"])), 6.0) + np.linalg.norm(places[k] - middle)
        score = len(np.unique(seen["instance"])) + far - 40 * (seen["distance"] < 0.8).mean()
        best = max(best or (-math.inf, view), (score, view), key=lambda pair: pair[0])
    return best[1]


def choose_views(bank: HouseBank) -> list[View]:
    """Return a view by day and one at night of every type of room; houses take turns."""
    count, views = len(bank.navigation.room_type), []
    for number, kind in enumerate(TYPES):
        for turn, hour in enumerate(HOURS):
            for house in np.roll(np.arange(count), -(number + turn * (count // 2))):
                types = np.asarray(bank.navigation.room_type[house])
                rooms = np.flatnonzero(types == ROOM_TYPES.index(kind))
                view = find_view(bank, int(house), int(rooms[0]), hour) if len(rooms) else None
                if view is not None:
                    views.append(view)
                    break
            else:
                sys.stderr.write(f"no house has a room of type {kind}\n")
    return views


def path_trace(bank: HouseBank, view: View, spp: int, gloss: bool, path: Path) -> dict[str, np.ndarray]:
    """Return the path trace of a view, from a file if it is there."""
    if path.exists():
        return dict(np.load(path))
    import mitsuba_house as tracer

    start = time.perf_counter()
    scene = tracer.build(bank, view.house, shader_of(LitShader, view.hour), view.pos, gloss)
    camera = tracer.camera_of(view.pos, view.yaw, PITCH, FOVY, SIZE)
    albedo, normal, distance = tracer.features(scene, camera)
    light = tracer.denoise(tracer.trace(scene, camera, spp), albedo, normal)
    found = {"light": light, "albedo": albedo, "distance": distance, "carriers": tracer.lamp_carriers(bank, view.house)}
    np.savez_compressed(path, **found)
    sys.stderr.write(f"{time.perf_counter() - start:.0f} s of path tracing\n")
    return found


def matt(bank: HouseBank) -> HouseBank:
    """Return the bank without gloss."""
    return bank.replace(finish=bank.finish.replace(specular=jnp.zeros_like(bank.finish.specular)))


def shrink(picture: np.ndarray, factor: int) -> np.ndarray:
    """Return means of blocks of pixels."""
    height, width = picture.shape[:2]
    return picture.reshape(height // factor, factor, width // factor, factor, -1).mean(axis=(1, 3))


def tone(light: np.ndarray, exposure: float) -> np.ndarray:
    """Return sRGB in [0, 1] of linear light, by the tone curve of `lit`."""
    return np.asarray(encode_srgb(tone_map(Vec.unpack(jnp.asarray(light, jnp.float32)), exposure).pack())) / 255.0


def median_luminance(light: np.ndarray, count: np.ndarray) -> float:
    """Return the median luminance of the pixels that count."""
    return float(np.median((light @ np.array(LUMINANCE))[count]))


def compare(reference: np.ndarray, test: np.ndarray, count: np.ndarray) -> dict[str, float]:
    """Return FLIP, PSNR [dB] and SSIM of sRGB pictures over the pixels that count."""
    import flip_evaluator

    test = np.where(count[..., None], test, reference)
    pair = (np.ascontiguousarray(x, np.float32) for x in (reference, test))
    flip = np.asarray(flip_evaluator.evaluate(*pair, "LDR", applyMagma=False)[0]).reshape(*count.shape, -1).mean(-1)
    square = ((reference - test) ** 2).mean(axis=-1)[count].mean()
    a, b = (x @ np.array([0.299, 0.587, 0.114]) for x in (reference, test))
    blur = functools.partial(gaussian_filter, sigma=1.5)
    ma, mb = blur(a), blur(b)
    va, vb, both = blur(a * a) - ma**2, blur(b * b) - mb**2, blur(a * b) - ma * mb
    ssim = (2 * ma * mb + 1e-4) * (2 * both + 9e-4) / ((ma**2 + mb**2 + 1e-4) * (va + vb + 9e-4))
    numbers = flip[count].mean(), -10 * math.log10(max(square, 1e-12)), ssim[count].mean()
    return {name: round(float(x), 3) for name, x in zip(("flip", "psnr", "ssim"), numbers, strict=True)}


def judge(plain: HouseBank, bank: HouseBank, view: View, found: dict[str, np.ndarray]) -> tuple[dict, list[np.ndarray]]:
    """Return the errors of all shaders in a view, and pictures: path trace, `baked`, `lit`, `fast`."""
    seen = images(plain, view, SIZE, ("rgb", "distance", "instance"))
    objects = np.asarray(bank.geometry.instance_object[view.house])[found["carriers"]]
    count = ~np.isin(seen["instance"], objects) & (found["distance"] > seen["distance"][..., 0] - FAR_HITS)
    light, step = found["light"], SIZE // SMALL
    exposure = float(auto_exposure(Vec.unpack(jnp.asarray(light[count][None], jnp.float32))))
    small_count = shrink(count[..., None].astype(float), step)[..., 0] > 0.99
    big, small = tone(light, exposure), tone(shrink(light, step), exposure)
    level = median_luminance(light, count)
    report: dict = {"counted": round(float(count.mean()), 3)}
    pictures = {}

    def add(name: str, bank: HouseBank, shader: LitShader, small_samples: tuple[int, ...] = (1,)) -> None:
        """Judge one shader at one sample per pixel, and small pictures at `small_samples`."""
        ours = images(bank, view, SIZE, ("radiance",), shader)["radiance"]
        own = exposure * level / median_luminance(ours, count)
        pictures[name] = tone(ours, own)
        report[name] = {"exposure": round(own / exposure, 3), "256": compare(big, pictures[name], count)}
        for samples in small_samples:
            ours = images(bank, view, SMALL, ("radiance",), shader, samples)["radiance"]
            report[name]["64" if samples == 1 else f"64, {samples} samples"] = compare(
                small, tone(ours, own), small_count
            )

    add("lit without a bake", matt(plain), shader_of(LitShader, view.hour), ())
    add("lit", matt(bank), shader_of(LitShader, view.hour))
    add("baked", matt(bank), shader_of(BakedShader, view.hour), (1, 4))
    glossy = images(bank, view, SIZE, ("radiance",), shader_of(BakedShader, view.hour))["radiance"]
    own = exposure * level / median_luminance(glossy, count)
    report["baked with gloss"] = {"256": compare(big, tone(glossy, own), count)}
    paint = images(matt(plain), view, SIZE, ("radiance",), Reflectance())["radiance"]
    floor = light * np.where(found["albedo"] > 0.02, paint / np.maximum(found["albedo"], 0.02), 1.0)
    report["floor"] = {"256": compare(big, tone(floor, exposure), count)}
    report["fast"] = {"256": compare(big, seen["rgb"] / 255.0, count)}
    report["fast"]["64"] = compare(small, images(plain, view, SMALL, ("rgb",))["rgb"] / 255.0, small_count)
    return report, [big, pictures["baked"], pictures["lit"], seen["rgb"] / 255.0]


def main() -> None:
    """Judge twelve rooms."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--homes", type=int, nargs="+", default=[9101, 9102, 9103, 9104, 9105, 9106], help="seeds")
    parser.add_argument("--spp", type=int, default=64, help="paths per pixel, before denoising")
    parser.add_argument("--gloss", action="store_true", help="gloss in the path trace; compare with `baked with gloss`")
    parser.add_argument("--out", type=Path, required=True)
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    houses = [house for seed in args.homes for house in HouseSet(f"procedural:1?seed={seed}").load()]
    plain = HouseBank.from_compiled(houses, texture_size=256)
    bank = add_bakes(plain, houses, "light_probes")
    views = choose_views(plain)
    for view in sorted(views, key=lambda view: view.hour != "day"):
        name = f"{args.homes[view.house]}-{view.type}-{view.hour.replace(' ', '')}"
        stem = args.out / f"{name}-{args.spp}{'-gloss' * args.gloss}"
        found = path_trace(plain, view, args.spp, args.gloss, stem.with_suffix(".npz"))
        report, pictures = judge(plain, bank, view, found)
        sheet = (np.concatenate(pictures, axis=1) * 255 + 0.5).astype(np.uint8)
        Image.fromarray(sheet).save(stem.with_suffix(".png"), optimize=True)
        head = {"home": args.homes[view.house], "room": view.type, "hour": view.hour, "spp": args.spp}
        print(json.dumps(head | {"gloss": args.gloss} | report), flush=True)


if __name__ == "__main__":
    main()
