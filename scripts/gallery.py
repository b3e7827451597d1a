"""Draw the gallery of the docs: generated houses by default, any dataset on request.

python scripts/gallery.py                                   docs/images/gallery_*.png
python scripts/gallery.py --dataset ROOT --out local/gallery  images of another dataset, not for the docs
"""

import argparse
import dataclasses
import functools
import tempfile
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
from PIL import Image

from home_mjx.core.transforms import camera_quat, quat_matrix
from home_mjx.houses import load_bank
from home_mjx.raycast_render.cameras.camera import Camera, Lens
from home_mjx.raycast_render.images.noise import kinect_depth, stereo_depth
from home_mjx.raycast_render.images.render import render
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.shaders.lit import LitShader
from home_mjx.tasks.arrangements import with_arrangements
from home_mjx.tasks.variation.ranges import Variation
from home_mjx.tasks.variation.sample import CameraOffsets, sample_variation
from home_mjx.viewer.pictures import pictures
from home_procgen import generate_dataset

SEEDS = (3, 11, 20, 42)
EYE = 1.5  # [m] camera height above the floor
SIZE = (320, 240)
FINE = LitShader(ao_radius=0.8, max_specular_depth=3)
FAR = 8.0  # [m] depth that is drawn darkest
PICTURES = ("presets", "kinds", "cameras", "moved", "rooms", "arrangements", "variation", "sensors", "outside")


class Studio:
    """One house and its views."""

    def __init__(self, bank, house) -> None:
        self.bank, self.house = bank, jnp.int32(house)
        self.bodies = np.array(bank.physics.body_pos[house])
        self.turns = np.array(bank.physics.body_quat[house])
        self.rng = np.random.default_rng(house)

    def scene(self):
        """Build the scene of the house with its bodies at `bodies`."""
        nobody = jnp.zeros((0, 3), jnp.float32), jnp.zeros((0, 4), jnp.float32)
        return make_scene(self.bank, self.house, jnp.asarray(self.bodies), jnp.asarray(self.turns), *nobody)

    def draw(self, camera, lens, kinds=("rgb",), shader="fast", depth_max=None, drawn=None):
        """Render images to the host; `drawn` applies an episode's variation."""
        scene = self.scene() if drawn is None else self.scene().replace(appearance=drawn.appearance)
        images = look(lens, kinds, shader, depth_max)(scene, camera)
        return {kind: np.asarray(image) for kind, image in images.items()}

    def views(self, count, tries=40):
        """Return cameras that see many and different objects."""
        found, seen = [], set()
        scored = [self._score(self._somewhere()) for _ in range(tries)]
        for _, camera, things in sorted(scored, key=lambda s: -s[0]):
            if len(things - seen) >= 2 or not found:
                found.append(camera)
                seen |= things
            if len(found) == count:
                break
        return found

    def _somewhere(self):
        starts = np.asarray(self.bank.navigation.start[self.house])
        pos = starts[self.rng.integers(len(starts))] + [0, 0, EYE]
        return camera(pos, self.rng.uniform(-np.pi, np.pi), -0.12)

    def _score(self, camera):
        images = self.draw(camera, Lens(32, 24), ("instance", "depth"))
        ids, counts = np.unique(images["instance"], return_counts=True)
        things = {int(i) for i, n in zip(ids, counts, strict=True) if i >= 0 and n >= 6}
        depth = np.clip(images["depth"], 0, 10)
        return len(things) + 1.5 * np.median(depth) - 6 * (depth < 0.8).mean(), camera, things


@functools.cache
def look(lens, kinds, shader, depth_max):
    """Return a compiled program per lens and shader."""
    return jax.jit(functools.partial(render, lens=lens, kinds=kinds, shader=shader, depth_max=depth_max))


def camera(pos, yaw, pitch=0.0, fovy=1.25):
    """Build a camera at a point with yaw and pitch [rad]."""
    return Camera(jnp.asarray(pos, jnp.float32), camera_quat(jnp.float32(yaw), jnp.float32(pitch)), jnp.float32(fovy))


def panels(*rows):
    """Compose a sheet of captioned images."""
    return pictures.compose_sheet([[pictures.add_caption(image, name) for name, image in row] for row in rows])


def presets(studios, samples):
    """Draw the shaders side by side."""
    rows = []
    for studio in studios[:2]:
        view = studio.views(1)[0]
        fast = studio.draw(view, Lens(*SIZE, samples=4))["rgb"]
        one = studio.draw(view, Lens(*SIZE), shader="lit")["rgb"]
        lit = studio.draw(view, Lens(*SIZE, samples=samples), shader=FINE)["rgb"]
        rows.append([("fast", fast), ("lit, one sample", one), (f"lit, {samples} samples, dark corners", lit)])
    return panels(*rows)


def kinds(studio, samples):
    """Draw every kind of image of one view."""
    view = studio.views(1)[0]
    names = ("depth", "normal", "albedo", "instance", "fine", "coarse", "nyu40", "room", "material", "partition")
    images = studio.draw(view, Lens(*SIZE), names)
    shown = {"rgb": studio.draw(view, Lens(*SIZE, samples=samples), shader=FINE)["rgb"]}
    shown["depth"] = pictures.colour_depth(np.minimum(images["depth"][..., 0], FAR), FAR)
    noisy = np.asarray(kinect_depth(jax.random.key(0), jnp.asarray(images["depth"])))[..., 0]
    shown["depth of a Kinect"] = np.where(
        np.isinf(noisy)[..., None], np.uint8(0), pictures.colour_depth(np.minimum(noisy, FAR), FAR)
    )
    shown["normal"] = ((images["normal"] + 1) * 127.5).astype(np.uint8)
    shown["albedo"] = (255 * np.clip(images["albedo"], 0, 1) ** (1 / 2.2)).astype(np.uint8)
    shown |= {name: pictures.colour_ids(images[name]) for name in names[3:]}
    items = list(shown.items())
    return panels(items[:4], items[4:8], items[8:12])


def sensors(studio, samples):
    """Draw noise of depth cameras, tone curves, and faults of lenses in one view."""
    view = studio.views(1)[0]
    depth = jnp.asarray(studio.draw(view, Lens(*SIZE), ("depth",))["depth"])
    key = jax.random.key(0)
    read = {"Kinect": kinect_depth(key, depth), "stereo camera": stereo_depth(key, depth, view.fovy)}
    shown = [("depth", pictures.colour_depth(np.minimum(np.asarray(depth)[..., 0], FAR), FAR))]
    for name, image in read.items():
        image = np.asarray(image)[..., 0]
        colored = pictures.colour_depth(np.minimum(image, FAR), FAR)
        shown.append((name, np.where(np.isinf(image)[..., None], np.uint8(0), colored)))
    curves = [
        (curve, studio.draw(view, Lens(*SIZE, samples=samples), shader=LitShader(tone_curve=curve))["rgb"])
        for curve in ("reinhard", "agx")
    ]
    lens = Lens(*SIZE, samples=16, vignette=1.0, shutter=0.5, readout=0.5)
    turned = camera(view.pos, heading(view)[0] - 0.25, heading(view)[1])
    moving = jax.jit(functools.partial(render, lens=lens, kinds=("rgb",), shader="lit"))
    image = np.asarray(moving(studio.scene(), view, before=turned)["rgb"])
    return panels(shown, [*curves, ("vignette, turn of 14 degrees a step", image)])


def outside(studio):
    """Draw a house and its lawn from outdoors, plain and with clouds, haze and grass, and a room at night."""
    low, high = extent(studio)
    corner, middle = low - np.array([2.0, 9.0]), (low + high) / 2
    yaw = float(np.arctan2(*(middle - corner)[::-1]))
    view, lawn = (camera([*corner, EYE], yaw + turn, pitch) for turn, pitch in ((0.35, 0.12), (0.5, -0.25)))
    plain, room = LitShader(exposure=0.8), studio.views(1)[0]  # exposed for daylight
    full = dataclasses.replace(plain, clouds=0.45, haze=0.0015, grass=True)
    draw = functools.partial(studio.draw, lens=Lens(*SIZE, samples=4))
    shown = [
        (name, draw(where, shader=shader)["rgb"])
        for name, where, shader in (
            ("lit", view, plain),
            ("clouds, haze and grass", view, full),
            ("night", room, "night"),
            ("lit", lawn, plain),
            ("clouds, haze and grass", lawn, full),
            ("night, outdoors", view, "night"),
        )
    ]
    return panels(shown[:3], shown[3:])


def heading(view):
    """Return yaw and pitch of a camera [rad]."""
    turn = np.array(quat_matrix(view.quat))
    return np.arctan2(-turn[1, 2], -turn[0, 2]), np.arcsin(-turn[2, 2])


def cameras(studio, samples):
    """Draw the lenses: panorama, cube map, plan, lidar."""
    pos = np.asarray(studio.views(1)[0].pos)
    draw = functools.partial(studio.draw, shader=FINE)
    around = draw(camera(pos, 0.0), Lens(640, 320, "panorama", samples=samples))["rgb"]
    cube = draw(camera(pos, 0.0), Lens(160, 160, "cube", samples=samples))["rgb"]
    cube = np.concatenate([np.concatenate(cube[:3], axis=1), np.concatenate(cube[3:], axis=1)])
    plan = studio.draw(above(studio), Lens(320, 320, "orthographic", samples=4))["rgb"]
    scan = studio.draw(camera(pos, 0.0), Lens(640, 32, "lidar", elevation=(-30, 30)), ("distance",))["distance"][..., 0]
    scan = pictures.colour_depth(np.minimum(np.repeat(scan, 4, axis=0), FAR), FAR)
    return panels(
        [("panorama", around)],
        [("cube map: front, right, back; left, up, down", cube), ("orthographic, from 2.2 m above the floor", plan)],
        [("lidar, 640 x 32 beams, distance", scan)],
    )


def arrangements(studios, samples):
    """Draw the house with the most movable objects, as authored and in three arrangements."""
    bank, settled = with_arrangements(studios[0].bank, 3, jax.random.key(0), progress=True)
    studio = studios[int(settled.moved.sum(axis=1).argmax())]
    placed, shown = (studio.bodies, studio.turns), []
    lens = Lens(400, 400, "orthographic", samples=samples)
    poses = np.asarray(bank.physics.arrangement_pose[studio.house])
    for name, *pose in [
        ("as placed", *placed),
        *((f"arrangement {i}", p[:, :3], p[:, 3:]) for i, p in enumerate(poses)),
    ]:
        studio.bodies, studio.turns = pose
        shown.append((name, studio.draw(above(studio), lens)["rgb"]))
    studio.bodies, studio.turns = placed
    return panels(shown[:2], shown[2:])


def above(studio):
    """Return a camera that sees the whole plan, below the ceiling."""
    low, high = extent(studio)
    top = [*((low + high) / 2), float(studio.bank.physics.floor[studio.house]) + 2.2]
    return camera(top, np.pi / 2, -np.pi / 2, max(high - low) + 0.6)


def extent(studio):
    """Return the corners of the rooms in x and y [m]."""
    navigation, cell = studio.bank.navigation, studio.bank.spec.cell
    inside = np.argwhere(np.asarray(navigation.room[studio.house]) >= 0)[:, -2:][:, ::-1]
    origin = np.asarray(navigation.origin[studio.house])
    return origin + inside.min(axis=0) * cell, origin + (inside.max(axis=0) + 1) * cell


def moved(studio, samples):
    """Draw a view before and after a piece of furniture moves; its shadow moves with it."""
    valid = np.asarray(studio.bank.physics.body_valid[studio.house])
    size = np.asarray(studio.bank.physics.body_size[studio.house])
    body = int(np.argmax(np.where(valid & (size.max(axis=1) < 0.5), size.prod(axis=1), -1)))
    place = studio.bodies[body].copy()
    starts = np.asarray(studio.bank.navigation.start[studio.house])
    away = starts[np.argsort(abs(np.linalg.norm(starts[:, :2] - place[:2], axis=1) - 2.4))[0], :2]
    toward = np.array([*(away - place[:2]), 0.0])
    aim = np.arctan2(*(place[:2] - away)[::-1])
    view = camera([*away, EYE], aim, -0.45)
    lens = Lens(*SIZE, samples=samples)
    before = studio.draw(view, lens, ("rgb", "instance"), FINE)
    studio.bodies[body] = place + 0.7 * toward / np.linalg.norm(toward)
    after = studio.draw(view, lens, ("rgb", "instance"), FINE)
    studio.bodies[body] = place
    return panels(
        [("before", before["rgb"]), ("0.7 m nearer", after["rgb"])],
        [("before", pictures.colour_ids(before["instance"])), ("after", pictures.colour_ids(after["instance"]))],
    )


def varied(studio, samples):
    """Draw one view unchanged, with one range of variation each, and in four episodes with all ranges."""
    view, lens = studio.views(1)[0], Lens(*SIZE, samples=samples)
    alone = {
        "lamps of other rooms": {"lamps": 0.4, "daylight": 0.0},
        "daylight": {"daylight": (0.0, 0.4)},
        "colors": {"colors": 0.5},
        "textures": {"textures": 1.0},
        "camera": {"camera_height": (-0.6, -0.3), "camera_pitch": (5.0, 15.0), "camera_fovy": (-20.0, 20.0)},
    }
    whole = {"lamps": 0.7, "lamp_gain": (0.5, 2.0), "daylight": (0.0, 1.5), "sun_azimuth": (0.0, 360.0)}
    whole |= {"colors": (0.0, 0.5), "textures": 0.3, "camera_height": (-0.4, 0.2), "camera_pitch": (-10.0, 10.0)}
    episodes = [(name, ranges, seed) for seed, (name, ranges) in enumerate(alone.items(), 1)]
    episodes += [(f"all, episode {seed}", whole, seed) for seed in range(3)]
    num_rooms = studio.bank.lights.ambient.shape[1]
    shown = [("as the house has it", studio.draw(view, lens, shader=FINE)["rgb"])]
    for name, ranges, seed in episodes:
        drawn = sample_variation(Variation.of(**ranges), jax.random.key(seed), num_rooms)
        mount = drawn.camera_offsets or CameraOffsets()
        rise, tilt, wider = (0.0 if x is None else float(x) for x in (mount.height, mount.pitch, mount.fovy))
        yaw, pitch = heading(view)
        own = camera(np.asarray(view.pos) + np.array([0, 0, rise]), yaw, pitch + tilt, float(view.fovy) + wider)
        shown.append((name, studio.draw(own, lens, shader=FINE, drawn=drawn)["rgb"]))
    return panels(shown[:3], shown[3:6], shown[6:])


def rooms(studios, samples):
    """Draw rooms of different houses."""
    lens = Lens(*SIZE, samples=samples)
    shown = [
        [(f"house {i}", studio.draw(view, lens, shader=FINE)["rgb"]) for view in studio.views(3)]
        for i, studio in enumerate(studios[:3])
    ]
    return panels(*shown)


def main():
    """Draw all images."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--dataset", type=Path, help="dataset root (default: generated houses)")
    parser.add_argument("--out", type=Path, default=Path("docs/images"))
    parser.add_argument("--samples", type=int, default=9, help="rays per pixel of lit images")
    parser.add_argument("--only", nargs="*", default=list(PICTURES))
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        root = args.dataset or folder
        ids = None if args.dataset else generate_dataset(Path(folder), SEEDS)
        bank = load_bank(root, ids=ids, num_houses=len(SEEDS))
    studios = [Studio(bank, house) for house in range(bank.num_houses)]
    drawn = {
        "presets": lambda: presets(studios, args.samples),
        "kinds": lambda: kinds(studios[0], args.samples),
        "cameras": lambda: cameras(studios[-1], args.samples),
        "moved": lambda: moved(studios[0], args.samples),
        "rooms": lambda: rooms(studios, args.samples),
        "arrangements": lambda: arrangements(studios, args.samples),
        "variation": lambda: varied(studios[0], args.samples),
        "sensors": lambda: sensors(studios[0], args.samples),
        "outside": lambda: outside(studios[0]),
    }
    args.out.mkdir(parents=True, exist_ok=True)
    for name in args.only:
        sheet = Image.fromarray(drawn[name]())
        path = args.out / f"gallery_{name}.png"
        sheet.save(path, optimize=True)
        print(path, f"{path.stat().st_size / 1024:.0f} kB")


if __name__ == "__main__":
    main()
