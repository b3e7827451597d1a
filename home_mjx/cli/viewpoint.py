"""Viewpoint or listening point in one house."""

import argparse
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.packing.texture_layers import MAX_TEXTURE_SIZE
from home_mjx.cli.houses import add_house_arguments, load_compiled_house
from home_mjx.cli.parsing import number_type
from home_mjx.core.progress import plural
from home_mjx.errors import ConfigError
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.agent import AgentBody
from home_mjx.schema.compiled import RoomTable

EYE_HEIGHT = AgentBody().eye_height  # [m] above the floor
FLOOR_TOLERANCE = 0.05  # [m] a Z this far below the lowest floor still counts as on it
CEILING_CLEARANCE = 0.05  # [m] distance of a downward camera from the ceiling


@dataclass(frozen=True)
class Viewpoint:
    """One house without agents, and a head pose.

    Attributes:
        bank: Bank of the house alone.
        scene: Scene of the house, for ray casting.
        position: Position of eyes and ears [m], world frame.
        head_quat: Camera orientation, wxyz.
    """

    bank: HouseBank
    scene: Scene
    position: np.ndarray
    head_quat: np.ndarray


def add_viewpoint_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the optional `HOUSE`, `--dataset`, `--at X Y [Z]` [m] and `--yaw` [degrees from +x].

    `house`, `at` and `yaw` are None by default. `at` is a list of one or more numbers: `place_head` checks the count.
    """
    add_house_arguments(parser)
    parser.add_argument(
        "--at",
        type=number_type(),
        nargs="+",
        metavar=("X Y", "Z"),
        help="standing position [m], on the storey below Z or the lowest one (default: a start position of agents)",
    )
    parser.add_argument(
        "--yaw", type=number_type(), help="direction of view [degrees] from +x (default: the longest free path)"
    )


def place_head(args: argparse.Namespace, pitch: float = 0.0) -> Viewpoint:
    """Load the selected house onto the device and place a head at eye height above `--at`, else above its first start.

    `--at` is X and Y on the lowest storey, or on the storey below Z. The heading is `--yaw`, else the longest free
    path.
    `pitch` is the elevation of the view [degrees], up positive. Errors of `load_compiled_house` come through.

    Raises:
        ConfigError: The head would be outside of the house, Z is below all floors, or `--at` has neither two nor three
            numbers.
    """
    if args.at is not None and len(args.at) not in (2, 3):
        raise ConfigError(f"--at takes two or three numbers, got {len(args.at)}", hint="Pass X Y, or X Y Z.")
    bank = HouseBank.from_compiled([load_compiled_house(args)], MAX_TEXTURE_SIZE)
    feet = np.asarray(bank.navigation.start[0, 0]) if args.at is None else _standing_point(bank, args.at)
    yaw = longest_free_direction(bank, feet) if args.yaw is None else np.deg2rad(args.yaw)
    eyes = feet + np.array([0, 0, EYE_HEIGHT], np.float32)
    return Viewpoint(bank, _make_house_scene(bank), eyes, _camera_quat(yaw, np.deg2rad(pitch)))


def _standing_point(bank: HouseBank, at: list[float]) -> np.ndarray:
    """Return the point (3,) on the floor at X and Y of `--at` [m], on the storey below Z, else on the lowest one.

    Raises:
        ConfigError: The point is outside of the first house, or Z is below all floors.
    """
    import jax.numpy as jnp

    from home_mjx.navigation import cell_below, grid_position

    point = np.array([*at, np.inf][:3], np.float32)
    check_inside(bank, point, "--at")
    house, floors = jnp.int32(0), np.asarray(bank.navigation.floor[0])
    floors = floors[np.isfinite(floors)]
    if point[2] < floors.min() - FLOOR_TOLERANCE:
        heights = ", ".join(f"{z:.2f}" for z in floors)
        raise ConfigError(f"--at: Z {point[2]:g} is below all floors", hint=f"Pass a Z above a floor, at {heights} m.")
    place = cell_below(bank, house, jnp.asarray(point))
    place = place if len(at) == 3 else place.at[0].set(0)
    return np.array([*at[:2], grid_position(bank, house, place)[2]], np.float32)


def place_overhead_camera(args: argparse.Namespace, storey: int) -> tuple[Viewpoint, np.ndarray]:
    """Load the selected house and place a downward camera at a storey's centre, below its ceilings; image up is +y.

    `storey` is the index of a level that has rooms, from 0 at the bottom.

    Returns:
        The viewpoint, and the extent (2,) of the storey's rooms along x and y [m].

    Raises:
        ConfigError: There is no such storey.
    """
    house = load_compiled_house(args)
    levels = house.navigation.level
    if storey >= len(levels):
        raise ConfigError(
            f"--top {storey}: the house has {plural(len(levels), 'storey')}", hint=f"Pass 0 to {len(levels) - 1}."
        )
    here = np.flatnonzero((house.rooms.level == levels[storey]) & [len(p) > 0 for p in house.rooms.polygon])
    points = np.concatenate([house.rooms.polygon[room] for room in here])
    low, high = points.min(axis=0), points.max(axis=0)
    bank = HouseBank.from_compiled([house], MAX_TEXTURE_SIZE)
    camera = np.array([*(low + high) / 2, _lowest_ceiling(house.rooms, here) - CEILING_CLEARANCE], np.float32)
    return Viewpoint(bank, _make_house_scene(bank), camera, _camera_quat(np.pi / 2, -np.pi / 2)), high - low


def _lowest_ceiling(rooms: RoomTable, here: Int[np.ndarray, " n"]) -> float:
    """Return z of the lowest ceiling of rooms `here` [m]; eye height over the highest floor if no room has a ceiling.

    Ceilings at most eye height over their floor are ignored, as on balconies and terraces.
    """
    roofed = here[rooms.ceiling[here] > rooms.floor[here] + EYE_HEIGHT]
    return float(rooms.ceiling[roofed].min() if len(roofed) else rooms.floor[here].max() + EYE_HEIGHT)


def _make_house_scene(bank: HouseBank) -> Scene:
    """Build the scene of the first house of a bank at its initial poses, without agents."""
    import jax.numpy as jnp

    from home_mjx.raycast_render.scene.scene import make_scene

    house, nobody = jnp.zeros((), jnp.int32), (jnp.zeros((0, 3), jnp.float32), jnp.zeros((0, 4), jnp.float32))
    return make_scene(bank, house, bank.physics.body_pos[0], bank.physics.body_quat[0], *nobody)


def _camera_quat(yaw: float, pitch: float) -> np.ndarray:
    """Return the camera's quaternion wxyz for a yaw and a pitch [rad], see `camera_quat`."""
    import jax.numpy as jnp

    from home_mjx.core.transforms import camera_quat

    return np.asarray(camera_quat(jnp.float32(yaw), jnp.float32(pitch)))


def check_inside(bank: HouseBank, point: np.ndarray, option: str) -> None:
    """Raise `ConfigError`, naming `option`, if `point` (3,) [m] is outside the first house's extent in x and y."""
    navigation = bank.navigation
    rows, columns = np.nonzero((np.asarray(navigation.room[0]) >= 0).any(0))
    cells, origin = np.stack([columns, rows], -1), np.asarray(navigation.origin[0])
    low, high = origin + cells.min(0) * bank.spec.cell, origin + (cells.max(0) + 1) * bank.spec.cell
    if (point[:2] < low).any() or (point[:2] > high).any():
        given = f"{option} {point[0]:g} {point[1]:g} is outside of the house"
        raise ConfigError(given, hint=f"X is {low[0]:.1f} to {high[0]:.1f} m, Y {low[1]:.1f} to {high[1]:.1f} m")


def longest_free_direction(bank: HouseBank, feet: np.ndarray) -> float:
    """Return the yaw from +x [rad], of 72, of the longest straight walkable path from `feet` (3,) [m] in house 0.

    It is measured in the home region on the storey of the feet. Of equal directions the first from -pi on is returned,
    so it is -pi if none is free.
    """
    import jax.numpy as jnp

    from home_mjx.navigation import cell_at_feet

    navigation, cell = bank.navigation, bank.spec.cell
    level = int(cell_at_feet(bank, jnp.int32(0), jnp.asarray(feet, jnp.float32))[0])
    free, origin = np.asarray(navigation.region[0, level] == 0), np.asarray(navigation.origin[0])
    yaw = np.linspace(-np.pi, np.pi, 72, endpoint=False)
    reach = np.arange(1, max(free.shape)) * cell
    points = feet[:2] + reach[None, :, None] * np.stack([np.cos(yaw), np.sin(yaw)], -1)[:, None]
    index = np.floor((points - origin) / cell).astype(int)
    inside = ((index >= 0) & (index < free.shape[::-1])).all(-1)
    x, y = np.clip(index, 0, np.array(free.shape[::-1]) - 1).transpose(2, 0, 1)
    steps = np.cumprod(inside & free[y, x], axis=1).sum(1)
    return float(yaw[np.argmax(steps)])
