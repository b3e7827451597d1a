"""A point in one house from which to look or listen."""

import argparse
from dataclasses import dataclass

import numpy as np

from home_mjx.cli.houses import add_house_arguments, compile_named_house
from home_mjx.raycast_render.types import Scene
from home_mjx.scene_compile.bank import HouseBank

EYE_HEIGHT = 1.5  # [m]


@dataclass(frozen=True)
class Viewpoint:
    """One house without agents, and where the head is.

    Attributes:
        bank: The house alone.
        scene: As rays see it.
        position: Of the eyes and ears [m], world frame.
        head_quat: Camera orientation, wxyz.
    """

    bank: HouseBank
    scene: Scene
    position: np.ndarray
    head_quat: np.ndarray


def add_viewpoint_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds `HOUSE`, `--suncg`, `--at` and `--yaw`."""
    add_house_arguments(parser)
    parser.add_argument(
        "--at", type=float, nargs=2, metavar=("X", "Y"), help="where to stand [m] (default: where an agent would start)"
    )
    parser.add_argument("--yaw", type=float, help="direction of view [degrees] from +x (default: to the middle)")


def stand(args: argparse.Namespace) -> Viewpoint:
    """Puts the named house on the device and a head in it."""
    import jax.numpy as jnp

    from home_mjx.raycast_render import make_scene
    from home_mjx.tasks.pose import camera_quat

    bank = HouseBank.from_compiled([compile_named_house(args)])
    start = np.asarray(bank.navigation.start[0, 0])
    feet = start if args.at is None else np.array([*args.at, start[2]], np.float32)
    house, nobody = jnp.zeros((), jnp.int32), (jnp.zeros((0, 3), jnp.float32), jnp.zeros((0, 4), jnp.float32))
    scene = make_scene(bank, house, bank.physics.body_pos[0], bank.physics.body_quat[0], *nobody)
    yaw = np.arctan2(-feet[1], -feet[0]) if args.yaw is None else np.deg2rad(args.yaw)
    quat = camera_quat(jnp.float32(yaw), jnp.zeros((), jnp.float32))
    return Viewpoint(bank, scene, feet + np.array([0, 0, EYE_HEIGHT], np.float32), np.asarray(quat))
