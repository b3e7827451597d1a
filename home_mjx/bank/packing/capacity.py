"""Capacity of a bank's arrays: axis lengths per house, rows of the concatenated tables, and their size classes.

Few distinct lengths let similar banks share one compiled step.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from home_mjx.bank.records.bank_arrays import ID_LENGTH
from home_mjx.bank.records.declaration import Sizes
from home_mjx.bank.records.lights import count_glowing
from home_mjx.bank.records.owners import Counts
from home_mjx.bank.records.switches import count_switches
from home_mjx.errors import CapacityError
from home_mjx.schema.compiled import ARCHITECTURE, NUM_BANDS, CompiledHouse, MaterialTable, Model
from home_mjx.schema.semantic import Semantic

GRID_BLOCK = 32  # [cells]
FIXED_LENGTHS: Sizes = {"bands": NUM_BANDS, "columns": len(Semantic), "id_bytes": ID_LENGTH}


@dataclass(frozen=True)
class CapacityAxis:
    """An axis of a bank's arrays that is padded to one length for all houses.

    Attributes:
        required: Returns the length that a house needs.
        smallest: Lengths are multiples of this by a power of two.
        block: If set, lengths are multiples of this instead.
        set_by_compiler: A compiler option determines the length, not the house.
        optional: The length is 0 if no house needs any; programs then contain no code for its items.
    """

    required: Callable[[CompiledHouse], int]
    smallest: int = 1
    block: int | None = None
    set_by_compiler: bool = False
    optional: bool = False

    def round_up(self, count: int) -> int:
        """Return the length of this axis for `count` items: a size class, or the next multiple of `block` if set.

        For no items it is 0 if the axis is optional or has blocks, else `smallest`.
        """
        if self.optional and not count:
            return 0
        return size_class(count, self.smallest) if self.block is None else -(-count // self.block) * self.block


AXES: Mapping[str, CapacityAxis] = {
    # Agents use the object ids from `instances` on, so every object's id must be below it.
    "instances": CapacityAxis(lambda h: max(len(h.instances.model), 1 + int(h.instances.object_id.max())), 32),
    "bodies": CapacityAxis(lambda h: len(h.bodies.mass), 8, optional=True),
    "arrangements": CapacityAxis(lambda h: 0, optional=True),  # added to complete banks
    "hinged_leaves": CapacityAxis(lambda h: int((~h.doors.is_sliding).sum()), 8, optional=True),
    "slides": CapacityAxis(lambda h: int(h.doors.is_sliding.sum()), 2, optional=True),
    "fronts": CapacityAxis(lambda h: int(h.doors.is_front.sum()), 8, optional=True),
    "compartments": CapacityAxis(lambda h: len(h.compartments.leaf), 8, optional=True),
    "tray_boxes": CapacityAxis(lambda h: h.doors.num_tray_boxes, optional=True),
    "ramps": CapacityAxis(lambda h: len(h.ramps.slope), 1),
    "colliders": CapacityAxis(lambda h: len(h.colliders.pos), 64),
    "planes": CapacityAxis(lambda h: len(h.planes.material), 16),
    "starts": CapacityAxis(lambda h: len(h.navigation.start), 256, set_by_compiler=True),
    "goals": CapacityAxis(lambda h: len(h.navigation.goal), 8, set_by_compiler=True),
    "rooms": CapacityAxis(lambda h: len(h.rooms.type), 16),
    "lights": CapacityAxis(lambda h: len(h.lights.instance), 16),
    "glowing": CapacityAxis(count_glowing, 8, optional=True),
    "switches": CapacityAxis(count_switches, 8, optional=True),
    "portals": CapacityAxis(lambda h: len(h.navigation.portals.width), 16),
    "levels": CapacityAxis(lambda h: len(h.navigation.region)),
    "grid_rows": CapacityAxis(lambda h: h.navigation.region.shape[1], block=GRID_BLOCK),
    "grid_columns": CapacityAxis(lambda h: h.navigation.region.shape[2], block=GRID_BLOCK),
}


def required_lengths(house: CompiledHouse) -> dict[str, int]:
    """Return the length that a house needs on each axis of `AXES`, before rounding up."""
    return {name: axis.required(house) for name, axis in AXES.items()}


def capacity_of(houses: Sequence[CompiledHouse], capacity_factor: float = 1.0) -> dict[str, int]:
    """Return lengths of `AXES`, rounded up to size classes, for houses up to `capacity_factor` times the largest.

    There must be a house. The largest is found per axis. The factor does not apply to axes whose length a compiler
    option determines.
    """
    found = [required_lengths(house) for house in houses]
    largest = {name: max(counts[name] for counts in found) for name in AXES}
    growth = {name: 1.0 if axis.set_by_compiler else capacity_factor for name, axis in AXES.items()}
    return {name: axis.round_up(int(np.ceil(largest[name] * growth[name]))) for name, axis in AXES.items()}


def axis_lengths(capacity: Sizes) -> dict[str, int]:
    """Return a copy of `capacity`, the lengths of `AXES`, with `FIXED_LENGTHS`, `doors` and `rooms_and_none` added.

    Doors are hinged leaves plus slides; `rooms_and_none` is rooms + 1. Numbers of rows and houses are not included.
    """
    doors = capacity["hinged_leaves"] + capacity["slides"]
    return {**FIXED_LENGTHS, **capacity, "doors": doors, "rooms_and_none": capacity["rooms"] + 1}


def house_rows(house: CompiledHouse) -> dict[str, int]:
    """Count a house's own rows in each of `ROW_KINDS`; of models, only its architecture, which is private.

    Nodes include those of its top-level BVH; cells, the extrapolated ones.
    """
    own = house.models[house.instances.model[ARCHITECTURE]]
    return model_rows([own]) | {
        "node": len(own.tree.child) + len(house.top_bvh.child),
        "material": len(house.materials.mask),
        "semantic": len(house.semantics),
        "cell": len(house.navigation.field) + len(house.navigation.extrapolated.field),
    }


def model_rows(models: Iterable[Model]) -> dict[str, int]:
    """Count the rows of models in the tables `model`, `triangle` and `node`."""
    models = list(models)
    nodes, triangles = sum(len(m.tree.child) for m in models), sum(len(m.triangle) for m in models)
    return {"model": len(models), "triangle": triangles, "node": nodes}


def shared_rows(models: Iterable[Model], materials: MaterialTable, semantics: np.ndarray) -> dict[str, int]:
    """Count the rows by `ROW_KINDS` that precede those of houses: library models, agents' materials and semantics."""
    return model_rows(models) | {"material": len(materials.mask), "semantic": len(semantics), "cell": 0}


def slot_stride(houses: Sequence[CompiledHouse], capacity_factor: float) -> dict[str, int]:
    """Return the rows by kind reserved per house: `ragged_class` of `capacity_factor` times the largest, rounded down.

    There must be a house. The largest is found per kind; `model` is always 1.
    """
    found = [house_rows(house) for house in houses]
    largest = {kind: max(rows[kind] for rows in found) for kind in found[0]}
    return {k: 1 if k == "model" else ragged_class(int(n * capacity_factor)) for k, n in largest.items()}


def check_fits(house_id: str, needed: Counts, available: Counts) -> None:
    """Raise `CapacityError` for the first row kind or axis of which a house needs more than is available.

    `available` must have every key of `needed`; equal numbers fit.
    """
    for kind, count in needed.items():
        if count > available[kind]:
            raise CapacityError(
                f"house {house_id} needs {count} {kind.replace('_', ' ')}, {available[kind]} fit",
                hint="Use a larger `capacity_factor`, or leave the house out.",
            )


def cumulative_starts(first: Counts, rows: Iterable[Counts]) -> list[dict[str, int]]:
    """Return each house's first row by table, for houses one after another from `first` on; `rows` has their counts.

    Tables that `first` lacks are left out.
    """
    starts, at = [], dict(first)
    for counts in rows:
        starts.append(dict(at))
        at = {kind: at[kind] + counts[kind] for kind in at}
    return starts


def size_class(count: int, smallest: int) -> int:
    """Return the smallest `smallest * 2**n`, n >= 0, of at least `count`; `smallest` must be at least 1.

    Example:
        >>> size_class(44, 32), size_class(3, 8)
        (64, 8)
    """
    size = smallest
    while size < count:
        size *= 2
    return size


def ragged_class(count: int) -> int:
    """Return the capacity of a concatenated table: `count` rounded up to a multiple of a step, at least one.

    The step is the smallest 64 * 2**n that is at least `count` / 8, so at most 25 % are added from 256 on.

    Example:
        >>> ragged_class(1000), ragged_class(102_076)
        (1024, 114688)
    """
    step = 64
    while step * 8 < count:
        step *= 2
    return -(-max(count, 1) // step) * step
