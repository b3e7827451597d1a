"""How large a bank's tables are: sizes of the padded ones, and rows that houses take of the concatenated ones."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np

from home_mjx.bank.packing.padding import ragged_class, size_class
from home_mjx.errors import CapacityError
from home_mjx.schema.compiled import ARCHITECTURE, CompiledHouse, MaterialTable, Model

Counts = Mapping[str, int]  # rows by kind of table

GRID_BLOCK = 32  # [cells]
# of what is rounded up to a power of two times this
SMALLEST = {
    "instances": 32,
    "bodies": 8,
    "colliders": 64,
    "planes": 16,
    "starts": 256,
    "goals": 8,
    "rooms": 16,
    "levels": 1,
    "portals": 16,
    "lights": 16,
}
DRAWN = ("starts", "goals")  # their number is an option of the compiler, not of the house


@dataclass(frozen=True)
class Capacity:
    """Sizes of the padded tables of each house; all but those of the grid are `SMALLEST` times a power of two."""

    instances: int
    bodies: int
    colliders: int
    planes: int
    starts: int
    goals: int
    rooms: int
    lights: int
    portals: int
    levels: int
    grid_rows: int
    grid_columns: int

    @classmethod
    def of(cls, houses: Sequence[CompiledHouse], headroom: float = 1.0) -> "Capacity":
        """The sizes that hold each of some houses, and others up to `headroom` times as large."""
        largest = {f.name: max(needs(house)[f.name] for house in houses) for f in fields(cls)}
        growth = {name: 1.0 if name in DRAWN else headroom for name in largest}
        wanted = {name: int(np.ceil(count * growth[name])) for name, count in largest.items()}
        return cls(**{name: _rounded(name, count) for name, count in wanted.items()})

    def check(self, house: CompiledHouse) -> None:
        """Raises `CapacityError` if a house does not fit."""
        check_fits(house.id, needs(house), {f.name: getattr(self, f.name) for f in fields(self)})


def _rounded(name: str, count: int) -> int:
    return size_class(count, SMALLEST[name]) if name in SMALLEST else -(-count // GRID_BLOCK) * GRID_BLOCK


def needs(house: CompiledHouse) -> dict[str, int]:
    """What a house needs of each field of `Capacity`."""
    levels, rows, columns = house.navigation.region.shape
    return {
        # Agents take the object ids from `instances` on, so every object's id must lie below it.
        "instances": max(len(house.instances.model), 1 + int(house.instances.object_id.max())),
        "bodies": len(house.bodies.mass),
        "colliders": len(house.colliders.pos),
        "planes": len(house.planes.material),
        "starts": len(house.navigation.start),
        "goals": len(house.navigation.goal),
        "rooms": len(house.rooms.type),
        "lights": len(house.lights.instance),
        "portals": len(house.navigation.portals.width),
        "levels": levels,
        "grid_rows": rows,
        "grid_columns": columns,
    }


def rows_of(house: CompiledHouse) -> dict[str, int]:
    """Rows that a house takes of each kind of concatenated table, besides the models that it shares with others."""
    own = house.models[house.instances.model[ARCHITECTURE]]
    return model_rows([own]) | {
        "node": len(own.tree.child) + len(house.top.child),
        "material": len(house.materials.mask),
        "semantic": len(house.semantics),
        "cell": len(house.navigation.field),
    }


def model_rows(models: Iterable[Model]) -> dict[str, int]:
    """Rows that models take."""
    models = list(models)
    nodes, triangles = sum(len(m.tree.child) for m in models), sum(len(m.triangle) for m in models)
    return {"model": len(models), "triangle": triangles, "node": nodes}


def shared_rows(models: Iterable[Model], materials: MaterialTable, semantics: np.ndarray) -> dict[str, int]:
    """Rows that come before those of all houses: the library's models, and the agent's materials and semantics."""
    return model_rows(models) | {"material": len(materials.mask), "semantic": len(semantics), "cell": 0}


def row_stride(houses: Sequence[CompiledHouse], headroom: float) -> dict[str, int]:
    """Rows of each kind of table that hold each of some houses, and others up to `headroom` times as large."""
    found = [rows_of(house) for house in houses]
    largest = {kind: max(rows[kind] for rows in found) for kind in found[0]}
    return {kind: 1 if kind == "model" else ragged_class(int(count * headroom)) for kind, count in largest.items()}


def check_fits(house_id: str, needed: Counts, available: Counts) -> None:
    """Raises `CapacityError` for the first kind of which a house needs more than there is."""
    for kind, count in needed.items():
        if count > available[kind]:
            raise CapacityError(
                f"house {house_id} needs {count} {kind.replace('_', ' ')}, {available[kind]} fit",
                hint="Leave more head room, or leave the house out.",
            )


def running_starts(first: Counts, rows: Iterable[Counts]) -> list[dict[str, int]]:
    """Where the rows of each house begin if houses follow each other."""
    starts, at = [], dict(first)
    for counts in rows:
        starts.append(dict(at))
        at = {kind: at[kind] + counts[kind] for kind in at}
    return starts
