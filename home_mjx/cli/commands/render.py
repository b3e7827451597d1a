"""Write pictures of a house as seen from a point: colours, depth and ids."""

import argparse
import functools
import sys
from pathlib import Path

import numpy as np
from PIL import Image

from home_mjx.cli.output import make_folder
from home_mjx.cli.parsing import number, positive_int
from home_mjx.cli.viewpoint import add_viewpoint_arguments, stand
from home_mjx.schema.choices import CAMERA_MODELS, PRESETS
from home_mjx.viz import pictures

KINDS = ("rgb", "depth", "normal", "instance", "fine", "room", "material")
DEPTH_MAX = 10.0  # [m]
SHAPES = {"rgb": "hwc", "depth": "hwc", "normal": "hwc"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the options of `home-mjx render`."""
    add_viewpoint_arguments(parser)
    parser.add_argument("--size", type=positive_int, nargs=2, default=(640, 480), metavar=("W", "H"), help="[pixels]")
    parser.add_argument(
        "--fovy",
        type=number(low=1, high=179),
        default=75.0,
        help="vertical field of view [degrees] (default: 75)",
    )
    parser.add_argument("--preset", choices=PRESETS, default="fast", help="how colours are lit (default: fast)")
    parser.add_argument("--samples", type=positive_int, default=1, help="rays per pixel of the colours (default: 1)")
    parser.add_argument("--lens", choices=CAMERA_MODELS, default="pinhole", help="camera model (default: pinhole)")
    parser.add_argument("--out", type=Path, default=Path("pictures"), help="folder for the files (default: pictures)")


def run(args: argparse.Namespace) -> int:
    """Writes one PNG per kind."""
    import jax
    import jax.numpy as jnp

    from home_mjx.raycast_render.cameras.camera import Camera, Lens
    from home_mjx.raycast_render.images.render import render

    make_folder(args.out)
    view = stand(args)
    camera = Camera(jnp.asarray(view.position), jnp.asarray(view.head_quat), jnp.float32(np.deg2rad(args.fovy)))
    width, height = args.size
    lens = Lens(width, height, args.lens, args.samples)
    look = jax.jit(functools.partial(render, lens=lens, kinds=KINDS, preset=args.preset, depth_max=DEPTH_MAX))
    images = look(view.scene, camera)
    for kind in KINDS:
        path = args.out / f"{kind}.png"
        Image.fromarray(_colours(kind, np.asarray(images[kind]))).save(path)
        sys.stdout.write(f"{path}\n")
    return 0


def _colours(kind: str, image: np.ndarray) -> np.ndarray:
    """The image as (H, W, 3) uint8; the faces of a cube map lie below one another."""
    if image.ndim > len(SHAPES.get(kind, "hw")):
        image = np.concatenate(image)
    if kind == "rgb":
        return image
    if kind == "depth":
        return pictures.depth_colours(image[..., 0], DEPTH_MAX)
    if kind == "normal":
        return ((image + 1) * 127.5).astype(np.uint8)
    return pictures.id_colours(image)
