"""Lights and joints of objects: from the light table, and from doors whose model has an open and a closed variant."""

import hashlib
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
from jaxtyping import Float, Int

from home_mjx.datasets.kept_results import kept_result
from home_mjx.datasets.suncg.fallbacks.builtin_categories import add_builtin_categories
from home_mjx.datasets.suncg.formats.variants import SuncgMetadata, other_variant
from home_mjx.datasets.suncg.read.hinges import Hinge, HingeTable, find_hinges
from home_mjx.datasets.suncg.read.reader_state import ReaderState
from home_mjx.geometry.meshes import tree_order, triangles_z_up
from home_mjx.schema.house import House, Joint, Mesh, ObjectNode

MIN_WIDE_ANGLE = np.pi / 2  # [rad], minimum opening angle of every door; SUNCG's open variants are only half open


def attach_parts(house: House, reading: ReaderState) -> House:
    """Return the house with the lights of its objects, and the joints of its doors, found from both variants."""
    tables = add_builtin_categories(reading.tables) if reading.tolerant else reading.tables
    levels = (
        replace(level, objects=tuple(_with_parts(item, house, reading, tables) for item in level.objects))
        for level in house.levels
    )
    return replace(house, levels=tuple(levels))


def _with_parts(item: ObjectNode, house: House, reading: ReaderState, tables: SuncgMetadata) -> ObjectNode:
    """Return an object with its lights and, for a door with both variants, its joints; unchanged without any."""
    lights, joints = tables.lights_of(item.model_id, item.model_key), ()
    other = reading.other_models.get(other_variant(item.model_id, item.model_key))
    if other is not None and tables.info(item.model_id).coarse == "door":
        is_closed = item.model_key != item.model_id
        joints = find_joints(item.model_key, house.models[item.model_key], other, is_closed)
    return replace(item, lights=lights, joints=joints) if lights or joints else item


def find_joints(key: str, shown: Mesh, other: Mesh, is_closed: bool) -> tuple[Joint, ...]:
    """Find the joints of mesh `shown`, with key `key`, of a door by comparison with its other variant.

    `is_closed` means that `shown` is the closed variant. Empty if no part turns or slides.
    """
    triangles = triangles_z_up(shown), triangles_z_up(other)
    digest = hashlib.sha256(b"".join(corners.tobytes() for corners in triangles)).digest()
    return _joints(DoorVariants(key, is_closed, digest, *triangles))


@dataclass(frozen=True)
class DoorVariants:
    """A door in the variant that is shown and in the other one."""

    key: str
    is_closed: bool
    digest: bytes  # of both meshes
    shown: Float[np.ndarray, "t 3 3"] = field(compare=False)  # [m], Z up
    other: Float[np.ndarray, "s 3 3"] = field(compare=False)  # [m], Z up


@lru_cache(maxsize=256)
def _joints(door: DoorVariants) -> tuple[Joint, ...]:
    """Find the joints of a door; hinges are kept by `kept_result`, and results are cached by key and digest."""
    order = tree_order(door.shown)  # leaves are numbered in the order of the compiled model's triangles
    shown = door.shown.astype(np.float32)[order].astype(np.float64)
    inputs = shown.tobytes() + hashlib.sha256(door.other.tobytes()).digest()
    hinges = kept_result(HingeTable, inputs, lambda: HingeTable.of(find_hinges(shown, door.other), len(shown))).hinges
    return tuple(_joint(door, f"leaf_{number}", hinge, order) for number, hinge in enumerate(hinges, 1))


def _joint(door: DoorVariants, name: str, hinge: Hinge, order: Int[np.ndarray, " t"]) -> Joint:
    """Convert a hinge (Z up) to a joint (Y up) of the mesh that is shown, 0 as shown.

    It goes from closed to wide open: as far as the open variant and, for hinges, at least `MIN_WIDE_ANGLE`.
    """
    slides, turn = bool(hinge.slide.any()), float(hinge.displacement)
    closed = 0.0 if door.is_closed else turn
    reach = abs(turn) if slides else max(abs(turn), MIN_WIDE_ANGLE)
    wide = float(closed + np.sign(turn) * (1 if door.is_closed else -1) * reach)
    (x, y), (along, across) = hinge.pivot.tolist(), hinge.slide.tolist()
    return Joint(
        model_id=door.key,
        part=name,
        kind="slide" if slides else "hinge",
        axis=(along, 0.0, -across) if slides else (0.0, 1.0, 0.0),
        point=(x, 0.0, -y),
        low=min(closed, wide),
        high=max(closed, wide),
        face_ranges=_runs(np.sort(order[hinge.leaf])),
        closed=closed,
    )


def _runs(faces: Int[np.ndarray, " n"]) -> tuple[tuple[int, int], ...]:
    """Return the first and last index, inclusive, of each run of consecutive ones in `faces`: ascending, not empty."""
    ends = np.flatnonzero(np.diff(faces) > 1)
    first, last = faces[np.r_[0, ends + 1]], faces[np.r_[ends, len(faces) - 1]]
    return tuple(zip(first.tolist(), last.tolist(), strict=True))
