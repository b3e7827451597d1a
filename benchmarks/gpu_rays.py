"""Measure the cost of rays on a GPU: one JSON object per line, in the form of `home-mjx bench --json`.

    python benchmarks/make_bank.py sample.pkl --dataset /path/to/suncg
    python benchmarks/warp_renderer.py sample.pkl --size 64 84 128 --out depth.npz > peer.jsonl
    python benchmarks/gpu_rays.py sample.pkl --houses "the sample house" --peer peer.jsonl --peer-depth depth.npz

Cameras are at random positions of all rooms at 1.5 m, with random yaw and up to 15 degrees of pitch. The timed program
goes from poses of objects and camera to images. Reports the median of several rounds, after a warm-up.
"""

import argparse
import dataclasses
import functools
import json
import os
import tempfile
import time
from pathlib import Path

os.environ.setdefault("XLA_PYTHON_CLIENT_PREALLOCATE", "false")

import jax
import jax.numpy as jnp
import numpy as np
from views import cameras, every_object_movable, load_bank, on_device

from benchmarks.cases.record import make_measurement
from home_mjx.core.native import nvrtc
from home_mjx.core.native.platforms import local_devices
from home_mjx.raycast_render.backends import cuda
from home_mjx.raycast_render.backends.registry import KERNEL
from home_mjx.raycast_render.cameras.camera import Camera, Lens, camera_rays
from home_mjx.raycast_render.casting.cast import cast, occluded
from home_mjx.raycast_render.images.render import render
from home_mjx.raycast_render.lighting.texture import albedo, encode_srgb
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.scene.surface import unit_normals
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.raycast_render.scene.vec import Vec
from home_mjx.raycast_render.shaders.fast import shade_headlight
from home_mjx.raycast_render.shaders.lit import LitShader

ROUNDS = 5
ROUND_SECONDS = 0.06
ID_IMAGES = ("instance", "fine", "coarse", "room", "material")


class Bench:
    """A bank, a camera in each environment, and their description."""

    def __init__(self, bank, words, num_envs, peers):
        house, self.pos, self.quat = cameras(bank, num_envs)
        self.bank, self.words, self.num_envs, self.peers = on_device(bank), words, num_envs, peers
        self.args = jnp.asarray(house), jnp.asarray(self.pos), jnp.asarray(self.quat)

    def program(self, look):
        """Compile `look(bank, scene, camera)` for all environments; return it with its compile time."""

        def one(bank, house, pos, quat):
            camera = Camera(pos, quat, jnp.float32(np.pi / 2))
            return look(bank, scene_of(bank, house, pos), camera)

        start = time.perf_counter()
        program = jax.jit(jax.vmap(one, (None, 0, 0, 0))).lower(self.bank, *self.args).compile()
        return functools.partial(program, self.bank), time.perf_counter() - start

    def seconds(self, look):
        """Measure the time of one batch and of compilation [s]."""
        program, compile_seconds = self.program(look)
        return timed(program, *self.args), compile_seconds

    def emit(self, case, value, unit, note, compile_seconds=None, peer=None):
        """Print a record."""
        found = self.peers.get(peer)
        record = make_measurement(
            f"{jax.default_backend()}/{case}",
            value,
            unit,
            f"{note}; {self.words}",
            num_envs=self.num_envs,
            compile_seconds=compile_seconds,
            peer=found and (f"{found['peer']} {found['kind']}", found["frames/s"]),
        )
        print(json.dumps(dataclasses.asdict(record)), flush=True)

    def frames(self, case, look, size, note, peer=None, rays=1):
        """Measure a look and print frames/s; return the time of a batch [s]."""
        seconds, compile_seconds = self.seconds(look)
        grays = self.num_envs * size**2 * rays / seconds / 1e9
        note = f"{size}x{size}, {note}; {grays:.2f} Grays/s, {seconds * 1e3:.3f} ms"
        self.emit(f"{case}-{size}", self.num_envs / seconds, "frames/s", note, compile_seconds, peer and (peer, size))
        return seconds


def read_peers(path, num_envs):
    """Read the output of warp_renderer.py by kind and size; it must have the same number of cameras."""
    lines = path.read_text().splitlines() if path else []
    records = [json.loads(line) for line in lines if line.startswith("{")]
    if any(record["num_envs"] != num_envs for record in records):
        raise SystemExit(f"{path} has {records[0]['num_envs']} other cameras: run both with the same --num-envs")
    return {(record["kind"], record["size"]): record for record in records}


def timed(program, *args):
    """Measure the median time of a call [s], with several calls in flight."""
    jax.block_until_ready(program(*args))
    start = time.perf_counter()
    jax.block_until_ready(program(*args))
    calls = max(2, int(ROUND_SECONDS / (time.perf_counter() - start)))
    rounds = []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        for _ in range(calls):
            result = program(*args)
        jax.block_until_ready(result)
        rounds.append((time.perf_counter() - start) / calls)
    return float(np.median(rounds))


def scene_of(bank, house, pos):
    """Build a scene with bodies at their initial poses and the agent behind the camera."""
    upright = jnp.array([[1.0, 0.0, 0.0, 0.0]], jnp.float32)
    body = bank.physics.body_pos[house], bank.physics.body_quat[house]
    return make_scene(bank, house, *body, pos[None] - jnp.array([[0.0, 0.0, 0.7]], jnp.float32), upright)


def own_body(bank):
    """Return the object id of the agent, which its own rays ignore."""
    return bank.spec.num_instances


def primary(size, backend=None):
    """Return a look that computes depth, instance and triangle."""

    def look(bank, scene, camera):
        _, direction = camera_rays(camera, Lens(size, size))
        hit = cast(scene, camera.pos, direction, exclude=own_body(bank), backend=backend)
        return hit.t, hit.instance, hit.triangle

    return look


def images(size, *kinds, shader="fast"):
    """Return a look that calls `render`."""

    def look(bank, scene, camera):
        return render(scene, camera, Lens(size, size), kinds=kinds, shader=shader, exclude=own_body(bank))

    return look


def shadowed(size):
    """Return a look that approximates a lit image: head light, and one shadow ray per hit to a lamp overhead."""

    def look(bank, scene, camera):
        origin, direction = camera_rays(camera, Lens(size, size))
        hit = cast(scene, origin, direction, exclude=own_body(bank))
        direction, hit = jax.lax.optimization_barrier((direction, hit))
        way = Vec.unpack(direction)
        lamp = (camera.pos + jnp.array([0.3, 0.2, 0.8], jnp.float32))[None, None]
        point = origin + jnp.where(jnp.isfinite(hit.t), hit.t, 0)[..., None] * direction
        dark = occluded(scene, point, lamp - point, t_min=1e-3, t_max=1.0, exclude=own_body(bank))
        light = shade_headlight(albedo(scene, hit), unit_normals(scene, way, hit), way)
        return (light * jnp.where(dark, 0.3, 1.0)).map(encode_srgb).pack(), hit.t

    return look


def scattered(bench, size, any_hit):
    """Measure incoherent rays with random origins in the rooms and random directions."""
    key = jax.random.key(0)
    shape = bench.num_envs, size * size, 3
    direction = jax.random.normal(key, shape)
    direction = direction / jnp.linalg.norm(direction, axis=-1, keepdims=True)
    pick = jax.random.randint(jax.random.key(1), shape[:2], 0, bench.num_envs // bench.bank.num_houses)
    origin = bench.args[1][pick * bench.bank.num_houses + bench.args[0][:, None]]

    def one(bank, house, pos, origin, direction):
        function = occluded if any_hit else cast
        return function(scene_of(bank, house, pos), origin, direction, mask=1)

    args = bench.bank, *bench.args[:2], origin, direction
    program = jax.jit(jax.vmap(one, (None, 0, 0, 0, 0))).lower(*args).compile()
    seconds = timed(program, *args)
    rays = bench.num_envs * size * size / seconds
    bench.emit(
        f"scattered-{'any' if any_hit else 'closest'}",
        rays,
        "rays/s",
        f"{size * size} rays per environment, random origins and directions, {'any' if any_hit else 'closest'} hit",
    )


def kernel_compilation():
    """Measure the time to compile the kernels, and to load them from the cache [s]."""
    device = local_devices("cuda")[0]
    capability = int(device.compute_capability.replace(".", ""))
    kept = os.environ.get("HOME_MJX_CACHE")
    with tempfile.TemporaryDirectory() as folder:
        os.environ["HOME_MJX_CACHE"] = folder
        for case, note in (("cold", "by NVRTC"), ("cached", "from disk")):
            start = time.perf_counter()
            nvrtc.compile_ptx(cuda.SOURCE, capability)
            record = make_measurement(
                f"gpu/kernel-compile-{case}", time.perf_counter() - start, "s", f"CUDA C to PTX {note}"
            )
            print(json.dumps(dataclasses.asdict(record)), flush=True)
    os.environ.pop("HOME_MJX_CACHE")
    if kept:
        os.environ["HOME_MJX_CACHE"] = kept
    start = time.perf_counter()
    problem = KERNEL.find_problem("cuda")
    seconds = time.perf_counter() - start
    note = f"first use in a process: PTX from disk or compiled, driver, probe; {problem or 'works'}"
    print(json.dumps(dataclasses.asdict(make_measurement("gpu/first-use", seconds, "s", note))), flush=True)


def agreement(bench, size, num_envs=256):
    """Measure the share of rays with equal instance and triangle in other backends, and the depth difference."""
    few = jax.tree.map(lambda x: x[:num_envs], bench.args)

    def prepare(bank, house, pos, quat):
        rays = camera_rays(Camera(pos, quat, jnp.float32(np.pi / 2)), Lens(size, size))
        return house, scene_of(bank, house, pos).moving, *rays

    # The same rays for all, because rounding decides between coplanar surfaces.
    args = jax.jit(jax.vmap(prepare, (None, 0, 0, 0)))(bench.bank, *few)
    found = {}
    for name in ("cuda", "xla", "cpu"):

        def one(bank, house, moving, origin, direction, name=name):
            hit = cast(Scene(bank, house, moving), origin, direction, mask=1, backend=name)
            return hit.t, hit.instance, hit.triangle

        device = jax.devices("cpu" if name == "cpu" else "cuda")[0]
        given = jax.device_put((bench.bank, *args), device)
        found[name] = jax.tree.map(np.asarray, jax.jit(jax.vmap(one, (None, 0, 0, 0, 0)))(*given))
    for name in ("xla", "cpu"):
        (t, instance, triangle), (t0, instance0, triangle0) = found[name], found["cuda"]
        same = (instance == instance0) & (triangle == triangle0)
        both = same & (instance >= 0)
        note = (
            f"share of {same.size} rays with the instance and triangle of `{name}`; {int((~same).sum())} differ, "
            f"depth apart by at most {np.abs(t[both] - t0[both]).max():.1e} m where they agree"
        )
        bench.emit(f"agreement-{name}", float(same.mean()), "share", note)


def against_peer(bench, size, path):
    """Count the pixels of the peer with the same depth, which shows that both see the same scene."""
    theirs = np.load(path)["depth"]
    program, _ = bench.program(images(size, "depth"))
    ours = np.asarray(program(*bench.args)["depth"][: len(theirs), ..., 0])
    seen = theirs > 0
    near = np.abs(np.minimum(ours, 10) - np.minimum(theirs, 10)) < 0.01
    bench.emit(
        "same-depth-as-peer",
        float(near[seen].mean()),
        "share",
        f"pixels within 1 cm of the peer's depth, {size}x{size}",
    )


def memory(bench):
    """Print the bytes of a bank's geometry per house, and of moving slots per environment."""
    geometry = bench.bank.geometry
    plain, gpu = (sum(x.nbytes for x in jax.tree.leaves(g)) for g in (geometry.replace(gpu=None), geometry.gpu))
    houses = bench.bank.num_houses
    note = f"geometry, of which {gpu / houses:.0f} as the kernel reads it"
    bench.emit("bytes-per-house", (plain + gpu) / houses, "B", note)
    slots = bench.bank.physics.body_valid.shape[1] + 1
    bench.emit(
        "bytes-per-environment", slots * (2 * 48 + 24 + 5 * 4 + 64.0), "B", f"{slots} moving slots, made at each step"
    )


def rooms(bench, sizes):
    """Run all measurements of one bank."""
    for size in sizes:
        bench.frames("primary", primary(size), size, "depth, instance and triangle", "depth")
        base = bench.frames("depth", images(size, "depth"), size, "depth image", "depth")
        if size == sizes[0]:
            for kind in ID_IMAGES:
                seconds, _ = bench.seconds(images(size, "depth", kind))
                extra = (seconds - base) * 1e3
                bench.emit(
                    f"image-{kind}-{size}", extra, "ms", f"{size}x{size}, what it costs besides depth, per batch"
                )
        colors(bench, size)
    scattered(bench, sizes[0], False)
    scattered(bench, sizes[0], True)


def colors(bench, size):
    """Measure colour images by shader."""
    bench.frames("fast-rgb", images(size, "rgb", "depth"), size, "`kernels` RGB and depth", "rgb+depth")
    note = "stand-in: primary ray, one shadow ray, texture and head light"
    bench.frames("shadowed-rgb", shadowed(size), size, note, "rgb+depth+shadows", rays=2)
    look = images(size, "rgb", "depth", shader=LitShader(num_lights=1, max_specular_depth=0, sun=0))
    note = "`lit` with one light, no bounces, no sun, and depth"
    bench.frames("lit-1", look, size, note, "rgb+depth+shadows")
    look = images(size, "rgb", "depth", shader="lit")
    bench.frames("lit", look, size, "`lit` as it is (4 lights, 2 bounces, sun), and depth")


def many_houses(bench, size, samples=16):
    """Compare one batch over all houses of the bank with batches in one house each."""
    seconds = bench.frames("resident", primary(size), size, "depth, instance and triangle, all houses at once")
    program, _ = bench.program(primary(size))
    house, pos, quat = bench.args
    alone = []
    for chosen in np.linspace(0, bench.bank.num_houses - 1, samples).astype(int):
        rows = np.flatnonzero(np.asarray(house) == chosen)
        rows = jnp.asarray(rows[np.arange(bench.num_envs) % len(rows)])
        alone.append(timed(program, house[rows], pos[rows], quat[rows]))
    ratio = np.mean(alone) / seconds
    note = f"frames/s over all houses / frames/s with all environments in one house (mean time of {samples} houses)"
    bench.emit(f"resident-ratio-{size}", float(ratio), "ratio", note)


def main():
    """Parse the command line and measure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bank", type=Path)
    parser.add_argument("--houses", required=True, help="description of the bank")
    parser.add_argument("--num-envs", type=int, default=4096)
    parser.add_argument("--size", type=int, nargs="+", default=[64, 84, 128])
    parser.add_argument("--peer", type=Path, help="output of warp_renderer.py for this bank")
    parser.add_argument("--peer-depth", type=Path, help="depth images of warp_renderer.py for this bank")
    parser.add_argument("--still", action="store_true", help="only the bank's movable objects move")
    parser.add_argument("--many", action="store_true", help="only measure the cost of many houses")
    parser.add_argument("--colors", action="store_true", help="only measure colour images")
    parser.add_argument("--check", action="store_true", help="also compare the backends")
    args = parser.parse_args()
    peers = read_peers(args.peer, args.num_envs)
    bank = load_bank(args.bank)
    words = args.houses + (", default movable objects" if args.still else ", every object movable")
    bench = Bench(bank if args.still else every_object_movable(bank), words, args.num_envs, peers)
    if args.colors:
        for size in args.size:
            colors(bench, size)
        return
    kernel_compilation()
    if args.peer_depth:
        against_peer(bench, args.size[0], args.peer_depth)
    if args.check:
        agreement(bench, args.size[0])
    memory(bench)
    if args.many:
        many_houses(bench, args.size[0])
    else:
        rooms(bench, args.size)


if __name__ == "__main__":
    main()
