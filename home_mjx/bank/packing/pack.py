"""Packs many compiled houses into the arrays of a `HouseBank`: host side, NumPy only.

Tables that rays walk are concatenated (trees get absolute indices): first what houses share, then each house's own.
The small tables are padded. Every length but the number of houses is rounded up to a size class, so that similar banks
have equal shapes and share one compiled step. Arrays are named by record and field of `bank.HouseBank`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Int

from home_mjx.bank.packing.agent_model import agent_materials, agent_model, agent_semantics
from home_mjx.bank.packing.capacity import Capacity, Counts, check_fits, rows_of, running_starts, shared_rows
from home_mjx.bank.packing.padding import pad, ragged_class
from home_mjx.bank.packing.tables import (
    Arrays,
    gloss_rows,
    material_rows,
    navigation_rows,
    pack_lights,
    pack_navigation,
    pack_physics,
    pack_planes,
    shift,
)
from home_mjx.bank.packing.texture_layers import TEXTURE_SIZE, load_textures
from home_mjx.errors import CapacityError, ConfigError
from home_mjx.scene_compile.geometry.mesh import invert
from home_mjx.schema.compiled import ARCHITECTURE, FIELD_FAR, CompiledHouse, Instances, Model
from home_mjx.schema.lighting import Gloss

LEAF_BITS = 4  # a leaf code holds `first << LEAF_BITS | count`
MAX_TRIANGLES = 2 ** (31 - LEAF_BITS)
ID_LENGTH = 32


@dataclass(frozen=True)
class Table:
    """A concatenated table: which tables it has its rows in common with, and what fills its end."""

    kind: str
    dtype: type
    fill: float | np.ndarray


TABLES: Mapping[str, Table] = {
    "geometry.triangle": Table("triangle", np.float32, 0),
    "geometry.triangle_uv": Table("triangle", np.float32, 0),
    "geometry.triangle_slot": Table("triangle", np.int32, 0),
    "geometry.triangle_part": Table("triangle", np.int32, 0),
    "geometry.node_box": Table("node", np.float32, np.array([[np.inf] * 3 + [-np.inf] * 3])),
    "geometry.node_child": Table("node", np.int32, -1),
    "geometry.model_root": Table("model", np.int32, 0),
    "geometry.model_box": Table("model", np.float32, 0),
    "geometry.material_mask": Table("material", np.int32, 0),
    "materials.albedo": Table("material", np.float32, 1),
    "materials.texture": Table("material", np.int32, -1),
    "materials.kind": Table("material", np.int32, -1),
    "materials.absorption": Table("material", np.float32, 1),
    "materials.scattering": Table("material", np.float32, 0),
    "materials.transmission": Table("material", np.float32, 0),
    "semantics": Table("semantic", np.int32, -1),
    "finish.normal": Table("triangle", np.float32, 0),
    "finish.specular": Table("material", np.float32, 0),
    "finish.shininess": Table("material", np.float32, 1),
    "finish.mirror": Table("material", np.bool_, False),
    "navigation.place": Table("cell", np.int16, 0),
    "navigation.field": Table("cell", np.uint16, FIELD_FAR),
}


@dataclass(frozen=True)
class Library:
    """What the houses of a bank share: models by key, the agent's first, and texture files, in the bank's order."""

    models: Mapping[str, Model]
    textures: tuple[str, ...]

    @classmethod
    def of(cls, houses: Sequence[CompiledHouse]) -> "Library":
        """Each model and texture of some houses once; a house's architecture is its own."""
        agent = agent_model()
        models = {agent.key: agent}
        for house in houses:
            for key in house.instances.model[ARCHITECTURE + 1 :]:
                models.setdefault(key, house.models[key])
        return cls(models, tuple(sorted({path for h in houses for path in h.materials.texture if path})))

    @cached_property
    def index(self) -> dict[str, int]:
        """Number of each model."""
        return {key: i for i, key in enumerate(self.models)}

    @cached_property
    def layer(self) -> dict[str, int]:
        """Layer of each texture; -1 of no texture."""
        return {"": -1} | {path: i for i, path in enumerate(self.textures)}

    @cached_property
    def rows(self) -> dict[str, int]:
        """Rows of the concatenated tables that come before those of the houses."""
        return shared_rows(self.models.values(), agent_materials(), agent_semantics())


@dataclass(frozen=True)
class Packed:
    """Arrays of `bank.HouseBank` by `record.field`, and the static numbers of `bank.BankSpec`."""

    arrays: Arrays
    capacity: Capacity
    cell: float  # [m]


def pack(houses: Sequence[CompiledHouse], texture_size: int = TEXTURE_SIZE) -> Packed:
    """Arrays of a bank that holds `houses` in the given order.

    Args:
        houses: At least one, all with the same navigation cell.
        texture_size: Edge of the square texture layers [px].

    Raises:
        ConfigError: No house, or houses of different navigation cells, or an id that is not short ASCII.
        CapacityError: More triangles than leaf codes can name.
        DatasetError: A texture file is missing or is no image.
    """
    if not houses:
        raise ConfigError("a bank needs at least one house")
    library, capacity = Library.of(houses), Capacity.of(houses)
    own = [rows_of(house) for house in houses]
    starts = running_starts(library.rows, own)
    check_triangles(library.rows["triangle"] + sum(rows["triangle"] for rows in own))
    parts = [
        library_rows(library),
        *(house_rows(h, library, at, capacity) for h, at in zip(houses, starts, strict=True)),
    ]
    arrays = {name: _concatenate(name, parts) for name in TABLES}
    arrays |= library_constants(library, texture_size) | house_slots(houses, library, starts, capacity)
    return Packed(arrays, capacity, float(houses[0].navigation.cell))


def pack_slots(
    houses: Sequence[CompiledHouse],
    library: Library,
    capacity: Capacity,
    stride: Counts,
    texture_size: int = TEXTURE_SIZE,
) -> Packed:
    """Arrays of a bank whose houses can be exchanged: each has room for `stride` rows of the concatenated tables.

    Args:
        houses: One per slot.
        library: Every model and texture that any house may show.
        capacity: Sizes of the padded tables.
        stride: Rows of each kind that a house may take.
        texture_size: Edge of the square texture layers [px].

    Raises:
        CapacityError: A house needs more, or there are more triangles than leaf codes can name.
    """
    starts = [slot_start(library, stride, slot) for slot in range(len(houses))]
    check_triangles(library.rows["triangle"] + len(houses) * stride["triangle"])
    parts = [library_rows(library)]
    parts += [slot_rows(h, library, capacity, stride, at) for h, at in zip(houses, starts, strict=True)]
    arrays = {name: np.concatenate([part[name] for part in parts if name in part]) for name in TABLES}
    arrays = {name: rows.astype(TABLES[name].dtype) for name, rows in arrays.items()}
    arrays |= library_constants(library, texture_size) | house_slots(houses, library, starts, capacity)
    return Packed(arrays, capacity, float(houses[0].navigation.cell))


def slot_start(library: Library, stride: Counts, slot: int) -> dict[str, int]:
    """Where the rows of a slot begin."""
    return {kind: library.rows[kind] + slot * count for kind, count in stride.items()}


def slot_rows(house: CompiledHouse, library: Library, capacity: Capacity, stride: Counts, start: Counts) -> Arrays:
    """All rows of a slot in the concatenated tables: those of the house, then padding.

    Raises:
        CapacityError: The house does not fit.
    """
    capacity.check(house)
    check_fits(house.id, rows_of(house), stride)
    rows = house_rows(house, library, start, capacity)
    return {name: pad_table(name, rows[name], stride[TABLES[name].kind]) for name in TABLES}


def pack_slot(
    house: CompiledHouse, library: Library, capacity: Capacity, stride: Counts, slot: int
) -> tuple[Arrays, dict[str, int]]:
    """What must be written into a bank of `pack_slots` to put a house into a slot, and from which row on.

    Raises:
        CapacityError: The house does not fit.
    """
    start = slot_start(library, stride, slot)
    rows = slot_rows(house, library, capacity, stride, start)
    tables = house_slots([house], library, [start], capacity)
    first = {name: start[TABLES[name].kind] for name in rows} | dict.fromkeys(tables, slot)
    return rows | tables, first


def check_triangles(count: int) -> None:
    """Raises `CapacityError` if leaf codes cannot name so many triangles."""
    if count >= MAX_TRIANGLES:
        raise CapacityError(
            f"the bank's models have {count} triangles, at most {MAX_TRIANGLES - 1} fit",
            hint="Use fewer houses in one bank.",
        )


def library_rows(library: Library) -> Arrays:
    """The first rows of each concatenated table: the library's models, then the agent's materials and semantics."""
    models = list(library.models.values())
    sizes = [{"node": len(m.tree.child), "triangle": len(m.triangle)} for m in models]
    starts = running_starts({"node": 0, "triangle": 0}, sizes)
    found = [model_tables(model, at) for model, at in zip(models, starts, strict=True)]
    geometry = {name: np.concatenate([rows[name] for rows in found]) for name in found[0]}
    agent = agent_materials()
    materials = material_rows(agent, library.layer) | gloss_rows(Gloss.matt(0), len(agent.mask))
    return geometry | materials | {"semantics": agent_semantics()}


def library_constants(library: Library, texture_size: int) -> Arrays:
    """Texture layers, and where the agent's own rows lie."""
    agent = dict.fromkeys(("agent_model", "agent_material", "agent_semantic"), np.array(0, np.int32))
    textures = {"materials.textures": load_textures(library.textures, texture_size).view("<u4")[..., 0]}
    return {f"geometry.{name}": row for name, row in agent.items()} | textures


def house_rows(house: CompiledHouse, library: Library, start: Counts, capacity: Capacity) -> Arrays:
    """A house's own rows of each concatenated table.

    Args:
        house: The house.
        library: What it shares with others.
        start: Where its rows of each kind begin.
        capacity: For the number of goals.
    """
    own = house.models[house.instances.model[ARCHITECTURE]]
    geometry = model_tables(own, start)
    child = _absolute(house.top.child, start["node"] + len(own.tree.child), 0)  # leaves hold instance indices
    geometry["geometry.node_child"] = np.concatenate([geometry["geometry.node_child"], child])
    geometry["geometry.node_box"] = np.concatenate([geometry["geometry.node_box"], house.top.box])
    materials = material_rows(house.materials, library.layer) | gloss_rows(house.gloss, len(house.materials.mask))
    rows = geometry | materials | navigation_rows(house, capacity)
    return rows | {"semantics": house.semantics}


def model_tables(model: Model, start: Counts) -> Arrays:
    """Rows of one model in the concatenated tables that begin at `start`."""
    rows = {
        "triangle": model.triangle,
        "triangle_uv": model.uv,
        "triangle_slot": model.slot,
        "triangle_part": model.part,
        "node_box": model.tree.box,
        "node_child": _absolute(model.tree.child, start["node"], start["triangle"]),
        "model_root": np.array([start["node"]], np.int32),
        "model_box": model.box[None],
    }
    return {f"geometry.{name}": values for name, values in rows.items()} | {"finish.normal": model.normal}


def _absolute(child: Int[np.ndarray, "n 2"], node: int, first: int) -> Int[np.ndarray, "n 2"]:
    """Tree codes with `node` added to inner nodes and `first` to the primitives of leaves; empty leaves stay."""
    leaf = np.where(child == -1, -1, ~(~child.astype(np.int64) + (first << LEAF_BITS)))
    return np.where(child >= 0, child + node, leaf).astype(np.int32)


def _concatenate(name: str, parts: Sequence[Arrays]) -> np.ndarray:
    table = np.concatenate([part[name] for part in parts if name in part])
    return pad_table(name, table, ragged_class(len(table)))


def pad_table(name: str, rows: np.ndarray, size: int) -> np.ndarray:
    """Rows of a concatenated table with what fills it, up to `size` rows."""
    return pad([rows], size, TABLES[name].dtype, TABLES[name].fill)[0]


def house_slots(
    houses: Sequence[CompiledHouse], library: Library, starts: Sequence[Counts], capacity: Capacity
) -> Arrays:
    """The tables that have one padded row per house.

    Args:
        houses: At least one.
        library: What they share.
        starts: Where the rows of each begin in the concatenated tables.
        capacity: Sizes of the padded tables.
    """
    materials = [at["material"] for at in starts]
    tops = [at["node"] + rows_of(h)["node"] - len(h.top.child) for h, at in zip(houses, starts, strict=True)]
    tables = {
        "geometry": {"house_root": np.array(tops, np.int32)} | _pack_instances(houses, library, starts, capacity),
        "physics": pack_physics(houses, capacity),
        "acoustics": pack_planes(houses, materials, capacity),
        "navigation": pack_navigation(houses, [at["cell"] for at in starts], capacity),
        "lights": pack_lights(houses, capacity),
    }
    arrays = {f"{record}.{name}": rows for record, table in tables.items() for name, rows in table.items()}
    return arrays | {"house_id": np.stack([_encode_id(h.id) for h in houses])}


def _pack_instances(
    houses: Sequence[CompiledHouse], library: Library, starts: Sequence[Counts], capacity: Capacity
) -> Arrays:
    instances, size = [h.instances for h in houses], capacity.instances
    pose = pad([i.pose for i in instances], size, np.float32, np.eye(3, 4))
    materials = shift([i.material for i in instances], [at["material"] for at in starts])
    semantics = shift([i.semantic for i in instances], [at["semantic"] for at in starts])
    models = [
        np.array([at["model"], *(library.index[key] for key in i.model[ARCHITECTURE + 1 :])])
        for i, at in zip(instances, starts, strict=True)
    ]
    return {
        "instance_model": pad(models, size, np.int32, -1),
        "instance_pose": pose,
        "instance_inverse": invert(pose.astype(np.float64)).astype(np.float32),
        "instance_object": pad([i.object_id for i in instances], size, np.int32, -1),
        "instance_material": pad(materials, size, np.int32, 0),
        "instance_semantic": pad(semantics, size, np.int32, 0),
        "instance_body": pad([i.body for i in instances], size, np.int32, -1),
        "object_semantic": np.stack([_object_rows(i, s, size) for i, s in zip(instances, semantics, strict=True)]),
    }


def _object_rows(instances: Instances, semantic: Int[np.ndarray, " i"], size: int) -> Int[np.ndarray, " o"]:
    """Semantic row of each object id."""
    rows = np.full(size, -1, np.int32)
    rows[instances.object_id[ARCHITECTURE + 1 :]] = semantic[ARCHITECTURE + 1 :]
    return rows


def _encode_id(house_id: str) -> np.ndarray:
    data = house_id.encode()
    if not house_id.isascii() or not 0 < len(data) <= ID_LENGTH:
        raise ConfigError(f"house id `{house_id}` must be 1 to {ID_LENGTH} ASCII characters")
    return np.frombuffer(data.ljust(ID_LENGTH, b"\0"), np.uint8)
