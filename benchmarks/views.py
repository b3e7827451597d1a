"""Inputs of the GPU benchmarks: banks in files, one with all objects movable, and cameras at random positions."""

import pickle
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

EYE = 1.5  # [m] above the floor
PITCH = 15.0  # [degrees] maximum pitch up or down


def save_bank(bank, path):
    """Write a bank's arrays; only the same version of the package can read them."""
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    host = jax.tree.map(np.asarray, bank.replace(geometry=bank.geometry.replace(gpu=None)))
    Path(path).write_bytes(pickle.dumps(host))


def load_bank(path):
    """Load the bank on the host, as NumPy arrays."""
    return pickle.loads(Path(path).read_bytes())


def on_device(bank):
    """A host bank as `home_mjx.load_bank` would have made it here."""
    from home_mjx.bank.records.gpu_geometry import gpu_geometry

    bank = jax.tree.map(jnp.asarray, bank)
    if jax.default_backend() != "gpu":
        return bank
    return bank.replace(geometry=bank.geometry.replace(gpu=gpu_geometry(bank.geometry)))


def every_object_movable(bank):
    """Return the same houses with every object except the architecture as a movable body at its pose."""
    geometry = bank.geometry
    houses, size = geometry.instance_model.shape
    slots = -(-int((geometry.instance_model >= 0).sum(1).max() - 1) // 8) * 8
    row = np.minimum(np.arange(slots) + 1, size - 1)
    pose = geometry.instance_pose[:, row].copy()
    valid = (geometry.instance_model[:, row] >= 0) & (np.arange(slots) + 1 < size)
    pos = pose[..., 3].copy()
    pose[..., 3] = 0
    quat = np.broadcast_to(np.array([1, 0, 0, 0], np.float32), (houses, slots, 4))
    physics = bank.physics.replace(
        body_valid=valid,
        body_instance=np.where(valid, row, -1).astype(np.int32),
        body_pos=pos,
        body_quat=quat,
        body_from_model=pose,
    )
    # A top tree per house with its architecture alone.
    box = np.array([_world_box(geometry, house) for house in range(houses)], np.float32)
    never = np.broadcast_to(np.array([np.inf] * 3 + [-np.inf] * 3, np.float32), box.shape)
    leaf = np.tile(np.array([[~1, -1]], np.int32), (houses, 1))
    root = np.arange(houses, dtype=np.int32) + len(geometry.node_child)
    geometry = geometry.replace(
        node_box=np.concatenate([geometry.node_box, np.stack([box, never], axis=1)]),
        node_child=np.concatenate([geometry.node_child, leaf]),
        house_root=root,
    )
    return bank.replace(geometry=geometry, physics=physics)


def _world_box(geometry, house):
    low, high = geometry.model_box[geometry.instance_model[house, 0]]
    corners = np.stack(np.meshgrid(*np.stack([low, high], axis=1)), axis=-1).reshape(-1, 3)
    pose = geometry.instance_pose[house, 0]
    world = corners @ pose[:, :3].T + pose[:, 3]
    return np.concatenate([world.min(0) - 1e-4, world.max(0) + 1e-4])


def cameras(bank, num_envs, seed=0):
    """Return house, position and quaternion of one camera per environment, at a random free position of its house."""
    rng = np.random.default_rng(seed)
    house = (np.arange(num_envs) % bank.house_id.shape[0]).astype(np.int32)
    spots = [np.argwhere(region >= 0) for region in bank.navigation.region]
    chosen = np.array([spots[h][rng.integers(len(spots[h]))] for h in house])
    level, cell = chosen[:, 0], chosen[:, :0:-1]
    ground = bank.navigation.origin[house] + (cell + rng.uniform(size=cell.shape)) * bank.spec.cell
    height = bank.navigation.floor[house, level] + EYE
    yaw = rng.uniform(0, 2 * np.pi, num_envs)
    pitch = np.deg2rad(rng.uniform(-PITCH, PITCH, num_envs))
    # Horizontal and along +y at yaw 0; pitch is about the camera's x axis.
    tilt = (np.pi / 2 + pitch) / 2
    turn, lean = np.array([np.cos(yaw / 2), np.sin(yaw / 2)]), np.array([np.cos(tilt), np.sin(tilt)])
    quat = np.column_stack([turn[0] * lean[0], turn[0] * lean[1], turn[1] * lean[1], turn[1] * lean[0]])
    return house, np.column_stack([ground, height]).astype(np.float32), quat.astype(np.float32)
