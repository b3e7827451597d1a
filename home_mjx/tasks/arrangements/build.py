"""Generation of arrangements for a bank's houses, cached on disk."""

import hashlib
import logging
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.core.array_store import READ_ERRORS, read_entry, write_entry
from home_mjx.core.checks import check_number
from home_mjx.core.paths import cache_folder
from home_mjx.core.progress import track
from home_mjx.geometry.rotations import yaw_quat
from home_mjx.tasks.arrangements.candidates import sample_candidates
from home_mjx.tasks.arrangements.house_layout import HouseLayout
from home_mjx.tasks.arrangements.placement import choose_candidates
from home_mjx.tasks.arrangements.settling import has_moved, settle_bodies
from home_mjx.tasks.arrangements.visual_check import find_level_candidates

VERSION = 1  # of the cache entries; increment it whenever the same bank and key yield other arrangements
MAX_SETTLING_ROUNDS = 3  # maximum number of rounds that restore objects which did not stay, and settle again

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class ArrangementCounts:
    """Counts of bodies by outcome, per house h and arrangement p.

    Attributes:
        moved: Objects at a new pose.
        unmoved: Selected objects at their initial pose: no candidate was free, or they did not come to rest there.
        shifted: Other bodies that settling moved by more than `settling.MAX_SHIFT`, or turned by more than
            `settling.MAX_TURN`.
        unsettled: Bodies of any size that are still moving after the last round.
    """

    moved: Int[np.ndarray, "h p"]
    unmoved: Int[np.ndarray, "h p"]
    shifted: Int[np.ndarray, "h p"]
    unsettled: Int[np.ndarray, "h p"]


def with_arrangements(
    bank: HouseBank, num_arrangements: int, key: Array, progress: bool | None = None
) -> tuple[HouseBank, ArrangementCounts]:
    """Return a bank with new arrangements of the bodies of its houses instead of its own; on the host, once per bank.

    Small objects (`house_layout.MAX_MASS`, `MAX_SIZE`) that support no others move within their rooms: objects on
    furniture to other furniture, objects on the floor to other floor. They stay clear of doors, passages and goals, and
    never disconnect the home region. Physics then settles all bodies for `settling.SETTLE_SECONDS`. A body that still
    moves then counts as unsettled, with a warning in the log. Results are kept on disk.

    Args:
        bank: The houses.
        num_arrangements: Number of arrangements per house.
        key: Random key; equal keys yield equal arrangements of equal banks.
        progress: Show progress; None: by the rule of `home_mjx.core.progress`.

    Returns:
        The bank, whose resets sample an arrangement with `EnvConfig(arrangement="random")`; and counts of bodies
        by outcome.

    Raises:
        ConfigError: `num_arrangements` is not a whole number of at least 1.

    Example:
        >>> bank, settled = with_arrangements(bank, 8, jax.random.key(0))  # doctest: +SKIP
        >>> env = home_mjx.make("PointNav-v0", bank, arrangement="random")  # doctest: +SKIP
    """
    check_number("num_arrangements", num_arrangements, 1, integer=True)
    words = np.asarray(jax.random.key_data(key) if jnp.issubdtype(key.dtype, jax.dtypes.prng_key) else key)
    entry = _entry(bank, num_arrangements, words)
    try:
        arrays, _ = read_entry(entry)
        poses, settled = (
            jnp.asarray(_check_poses(arrays.pop("poses"), bank, num_arrangements)),
            ArrangementCounts(**arrays),
        )
        return _replace_arrangements(bank, poses), settled
    except FileNotFoundError:
        pass
    except READ_ERRORS as error:
        log.warning("rebuilding the broken cache entry %s: %s", entry, error)
    poses, settled = _generate(bank, num_arrangements, words, progress)
    try:
        write_entry(entry, {"poses": np.asarray(poses), **vars(settled)}, {})
    except OSError as error:
        log.warning("arrangements are not cached: %s", error)
    return _replace_arrangements(bank, poses), settled


def _check_poses(poses: np.ndarray, bank: HouseBank, num: int) -> np.ndarray:
    """Return cached poses unchanged if they are float32 (houses, `num`, bodies, 7) of the bank: position, quaternion.

    Raises:
        ValueError: The shape or dtype is wrong, or a pose is not finite.
    """
    places, bodies = bank.physics.body_pos.shape[:2]
    if poses.shape != (places, num, bodies, 7) or poses.dtype != np.float32 or not np.isfinite(poses).all():
        raise ValueError(f"expected finite float32 poses {(places, num, bodies, 7)}, got {poses.dtype} {poses.shape}")
    return poses


def _replace_arrangements(bank: HouseBank, poses: Float[Array, "h p k 7"]) -> HouseBank:
    """Return the bank with other arrangements: poses of all bodies (xyz [m], quaternion wxyz)."""
    return bank.replace(physics=bank.physics.replace(arrangement_pose=poses))


def _entry(bank: HouseBank, num_arrangements: int, words: np.ndarray) -> Path:
    """Return the cache file, which may not exist: a hash of the bank's arrays, count, the key's `words` and backend."""
    name = hashlib.sha256(repr((VERSION, num_arrangements, words.tolist(), jax.default_backend())).encode())
    read = (bank.physics, bank.navigation, bank.semantics, bank.geometry.triangle, bank.geometry.instance_pose)
    for array in jax.tree.leaves(jax.device_get(read)):
        name.update(np.asarray(array).tobytes())
    return cache_folder() / "arrangements" / f"{name.hexdigest()}.zip"


def _generate(bank: HouseBank, num: int, words: np.ndarray, progress: bool | None) -> tuple[Array, ArrangementCounts]:
    """Place objects, settle, restore to initial poses those that do not rest as placed, repeat; return poses, counts.

    Poses are (houses, num, bodies, 7): position [m], quaternion wxyz. `words` are the words of the random key.
    """
    placed = jnp.concatenate([bank.physics.body_pos, bank.physics.body_quat], axis=-1)
    placed = jnp.repeat(placed[:, None], num, axis=1)
    put, moved, kept = _place(bank, num, words, progress)
    poses, still = settle_bodies(_replace_arrangements(bank, put), progress)
    for _ in range(MAX_SETTLING_ROUNDS):
        wrong = moved & (has_moved(put, poses) | ~still)
        if not wrong.any():
            break
        put, moved, kept = jnp.where(wrong[..., None], placed, put), moved & ~wrong, kept | wrong
        poses, still = settle_bodies(_replace_arrangements(bank, put), progress)
    used = bank.physics.body_valid[:, None]
    restless, shifted = ~still & used, has_moved(placed, poses) & ~moved & used
    counts = {"moved": moved, "unmoved": kept, "shifted": shifted, "unsettled": restless}
    settled = ArrangementCounts(**{name: np.asarray(x.sum(axis=-1), np.int32) for name, x in counts.items()})
    if settled.unsettled.any():
        log.warning("%d bodies do not come to rest in %d arrangements", restless.sum(), num * bank.num_houses)
    return jnp.where(used[..., None], poses, placed), settled


def _place(
    bank: HouseBank, num: int, words: np.ndarray, progress: bool | None
) -> tuple[Float[Array, "h p k 7"], Bool[Array, "h p k"], Bool[Array, "h p k"]]:
    """Return unsettled poses without overlaps (xyz [m], wxyz), and masks: bodies moved, selected bodies left in place.

    Padding (k) keeps its poses and is in no mask.
    """
    host = jax.device_get(bank)
    placed = np.concatenate([host.physics.body_pos, host.physics.body_quat], axis=-1)
    poses = np.repeat(placed[:, None], num, axis=1)
    moved = np.zeros(poses.shape[:3], bool)
    kept = np.zeros(poses.shape[:3], bool)
    for house, house_id in enumerate(track(bank.house_ids, "arranging objects", "house", progress)):
        furnished, used = HouseLayout.from_bank(host, house), host.physics.body_valid[house]
        seeds = [np.random.default_rng([*words.tolist(), zlib.crc32(house_id.encode()), p]) for p in range(num)]
        for p, found in enumerate(_arrange_house(bank, house, furnished, seeds)):
            boxes, elsewhere = found
            pose = np.concatenate([boxes.center, yaw_quat(boxes.yaw)], axis=-1)
            poses[house, p, used] = np.where(elsewhere[:, None], pose, poses[house, p, used])
            moved[house, p, used], kept[house, p, used] = elsewhere, furnished.is_selected & ~elsewhere
    return jnp.asarray(poses), jnp.asarray(moved), jnp.asarray(kept)


def _arrange_house(bank: HouseBank, house: int, furnished: HouseLayout, seeds: list[np.random.Generator]) -> list[Any]:
    """Return per generator of `seeds` the boxes of a house's k bodies, some at new poses, and a mask of these."""
    many = [sample_candidates(furnished, rng) for rng in seeds]
    usable = find_level_candidates(bank, house, furnished, many)
    drawn = np.flatnonzero(furnished.is_selected)
    return [
        choose_candidates(furnished, places._replace(usable=u), rng.permutation(drawn))
        for places, u, rng in zip(many, usable, seeds, strict=True)
    ]
