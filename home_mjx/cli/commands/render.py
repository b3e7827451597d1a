"""Render images of a house from a viewpoint: colours, depth, normals and ids."""

import argparse
import functools
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from home_mjx.cli.houses import load_compiled_house
from home_mjx.cli.learning.arguments import add_import_option, add_sensors_option, import_modules
from home_mjx.cli.output import make_folder
from home_mjx.cli.parsing import number_type, parse_path, positive_int_type
from home_mjx.cli.viewpoint import Viewpoint, add_viewpoint_arguments, place_head, place_overhead_camera
from home_mjx.core.checks import check_known
from home_mjx.core.progress import show_compile
from home_mjx.errors import ConfigError
from home_mjx.schema.categories import CAMERA_MODELS
from home_mjx.tasks.base.config import ID_KINDS, PIXEL_KINDS
from home_mjx.viewer.pictures import pictures

if TYPE_CHECKING:
    from home_mjx.raycast_render.scene.types import Scene

KINDS = ("rgb", "depth", "normal", "instance", "fine", "room", "material")
IMAGE_KINDS = (*PIXEL_KINDS, *ID_KINDS)
DEPTH_MAX = 10.0  # [m] depth of the last colour
DEFAULT_FOVY = 75.0  # [degrees] default vertical field of view
STOREY_MARGIN = 0.4  # [m] margin around a storey
CUT_WALL_GREY = np.uint8(40)  # grey level of walls that the plan cuts
IMAGE_AXES = {"rgb": "hwc", "depth": "hwc", "normal": "hwc"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the viewpoint of `add_viewpoint_arguments` and the options of `home-mjx render`.

    `--pitch` is from -90 to 90 degrees and `--fovy` from 1 to 179, both None by default. `--top` is the index of a
    storey, 0 without a value; None if absent. `--size W H` is in pixels (640 480). `--samples` is from 1 (1).

    `--shader` (`fast`) and `--sensors`, the kinds of images, are names that `run` checks. `--lens` is one of
    `CAMERA_MODELS` or None. `--import` is as in `add_import_option`, and `--out` the path of a folder (`pictures`).
    """
    add_viewpoint_arguments(parser)
    parser.add_argument("--pitch", type=number_type(-90, 90), help="elevation of the view [degrees] (default: 0)")
    parser.add_argument(
        "--top",
        type=_parse_storey,
        nargs="?",
        const=0,
        metavar="STOREY",
        help="plan of a storey, seen from below its ceiling (default: the lowest, 0)",
    )
    parser.add_argument(
        "--size",
        type=positive_int_type,
        nargs=2,
        default=(640, 480),
        metavar=("W", "H"),
        help="size of the images [pixels] (default: 640 480)",
    )
    parser.add_argument(
        "--fovy",
        type=number_type(low=1, high=179),
        help="vertical field of view [degrees] (default: 75)",
    )
    parser.add_argument(
        "--shader", default="fast", metavar="NAME", help="shader of the colours, such as fast or lit (default: fast)"
    )
    add_import_option(parser)
    add_sensors_option(parser, f"kinds of images (default: {','.join(KINDS)})")
    parser.add_argument("--samples", type=positive_int_type, default=1, help="rays per pixel for colours (default: 1)")
    parser.add_argument("--lens", choices=CAMERA_MODELS, help="camera model (default: pinhole)")
    parser.add_argument(
        "--out", type=parse_path, default=Path("pictures"), help="folder for the files (default: pictures)"
    )


def run(args: argparse.Namespace) -> int:
    """Write `KIND.png` into the folder `--out` for each kind of image, print the paths, and return 0.

    Existing files are replaced; a kind that is named twice is drawn once. With `--top`, walls that the plan cuts are
    dark grey in `rgb`. An unknown kind or shader raises `ConfigError`.
    """
    import jax
    import jax.numpy as jnp

    from home_mjx.raycast_render.cameras.camera import Camera, Lens, camera_rays
    from home_mjx.raycast_render.images.render import render
    from home_mjx.raycast_render.shaders.base import resolve_shader
    from home_mjx.viewer.pictures.media import write_png
    from home_mjx.viewer.pictures.top_view import is_in_wall

    import_modules(args.modules)
    kinds = tuple(dict.fromkeys(args.sensors or KINDS))
    check_known("kind of image", kinds, IMAGE_KINDS)
    shader = resolve_shader(args.shader)
    make_folder(args.out)
    view, fovy, model = _place_camera(args)
    scene = _add_bakes(args, view, shader.needs)
    camera = Camera(jnp.asarray(view.position), jnp.asarray(view.head_quat), jnp.float32(fovy))
    width, height = args.size
    lens = Lens(width, height, model, args.samples)
    look = jax.jit(functools.partial(render, lens=lens, kinds=kinds, shader=shader, depth_max=DEPTH_MAX))
    with show_compile("the renderer"):
        images = {kind: np.asarray(image) for kind, image in look(scene, camera).items()}
    if (
        args.top is not None and "rgb" in images
    ):  # The camera is inside the cut walls and sees the floor below; draw them dark.
        cut = np.asarray(is_in_wall(scene, camera_rays(camera, lens)[0]))
        images["rgb"] = np.where(cut[..., None], CUT_WALL_GREY, images["rgb"])
    for kind in kinds:
        path = args.out / f"{kind}.png"
        write_png(path, _to_colours(kind, images[kind]))
        sys.stdout.write(f"{path}\n")
    return 0


def _place_camera(args: argparse.Namespace) -> tuple[Viewpoint, float, str]:
    """Return the camera's viewpoint, `fovy` [rad] and model; with `--top`, orthographic with `fovy` in [m].

    With `--top` the image shows the whole storey with a margin of at least `STOREY_MARGIN`.

    Raises:
        ConfigError: `--top` is combined with an option of the viewpoint or has no such storey, or the camera is outside
            of the house.
    """
    if args.top is None:
        return place_head(args, args.pitch or 0.0), np.deg2rad(args.fovy or DEFAULT_FOVY), args.lens or "pinhole"
    given = [f"--{name}" for name in ("at", "yaw", "pitch", "fovy", "lens") if getattr(args, name) is not None]
    if given:
        raise ConfigError(f"{given[0]} cannot be combined with --top", hint="--top frames the whole storey.")
    view, (x, y) = place_overhead_camera(args, args.top)
    width, height = args.size
    return view, max(y, x * height / width) + 2 * STOREY_MARGIN, "orthographic"


def _add_bakes(args: argparse.Namespace, view: Viewpoint, names: tuple[str, ...]) -> "Scene":
    """Return the scene with the named bakes, cached or computed now; unchanged without names."""
    from home_mjx.houses.bakes import add_bakes

    if not names:
        return view.scene
    return view.scene.replace(bank=add_bakes(view.bank, [load_compiled_house(args)], names))


def _parse_storey(text: str) -> int:
    """Parse the index of a storey, from 0; raise `ArgumentTypeError` for other texts."""
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"expected the number of a storey from 0, got `{text}`")
    return int(text)


def _to_colours(kind: str, image: np.ndarray) -> np.ndarray:
    """Convert an image to colours (H, W, 3) uint8: (H, W, c) of rgb, depth and normals, (H, W) of ids.

    Colours (uint8) are unchanged. Depth is mapped by `colour_depth`, bright at 0 and dark from `DEPTH_MAX` on. A normal
    component n becomes (n + 1) 127.5, rounded down. All other kinds are ids, mapped by `colour_ids`. A cube map has its
    faces on one more leading axis; they are stacked vertically.
    """
    if image.ndim > len(IMAGE_AXES.get(kind, "hw")):
        image = np.concatenate(image)
    if kind == "rgb":
        return image
    if kind == "depth":
        return pictures.colour_depth(image[..., 0], DEPTH_MAX)
    if kind == "normal":
        return ((image + 1) * 127.5).astype(np.uint8)
    return pictures.colour_ids(image)
