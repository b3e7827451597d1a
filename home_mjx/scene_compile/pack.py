"""Packs many compiled houses into the arrays of a `HouseBank`: host side, NumPy only.

Geometry is concatenated (trees get absolute indices), small tables are padded. Every length but the number of houses
is rounded up to a size class, so that similar banks have equal shapes and share one compiled step.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from home_mjx.errors import CapacityError, ConfigError
from home_mjx.scene_compile.agent_model import agent_materials, agent_model, agent_semantics
from home_mjx.scene_compile.compiled import CompiledHouse, Instances, Model, Tree
from home_mjx.scene_compile.mesh import invert
from home_mjx.scene_compile.pack_tables import Arrays, pack_materials, pack_navigation, pack_physics, pack_planes, shift
from home_mjx.scene_compile.padding import concatenate, pad, size_class
from home_mjx.scene_compile.textures import TEXTURE_SIZE

LEAF_BITS = 4  # a leaf code holds `first << LEAF_BITS | count`
MAX_TRIANGLES = 2 ** (31 - LEAF_BITS)
ID_LENGTH = 32


@dataclass(frozen=True)
class Packed:
    """Arrays by record and field of `bank.HouseBank`, and the static capacities of `bank.BankSpec`."""

    geometry: Arrays
    materials: Arrays
    semantics: Int[np.ndarray, "q 8"]
    physics: Arrays
    acoustics: Arrays
    navigation: Arrays
    house_id: np.ndarray
    capacity: Mapping[str, int]
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
    # The agent's own rows come first, so they lie at 0 in every bank.
    materials = [agent_materials(), *(h.materials for h in houses)]
    semantics = [agent_semantics(), *(h.semantics for h in houses)]
    material_start = np.cumsum([len(m.mask) for m in materials])[:-1]
    semantic_start = np.cumsum([len(s) for s in semantics])[:-1]
    tables = pack_materials(materials, texture_size)
    geometry = _pack_geometry(houses, material_start, semantic_start)
    geometry["material_mask"] = tables.pop("mask")
    physics, acoustics, navigation = pack_physics(houses), pack_planes(houses, material_start), pack_navigation(houses)
    sizes = {
        "num_instances": geometry["instance_model"],
        "num_bodies": physics["body_mass"],
        "num_colliders": physics["collider_pos"],
        "num_planes": acoustics["plane_valid"],
        "num_starts": navigation["start"],
        "num_goals": navigation["goal"],
    }
    return Packed(
        geometry=geometry,
        materials=tables,
        semantics=concatenate(semantics, np.int32, -1),
        physics=physics,
        acoustics=acoustics,
        navigation=navigation,
        house_id=np.stack([_encode_id(h.id) for h in houses]),
        capacity={name: array.shape[1] for name, array in sizes.items()},
        cell=float(houses[0].navigation.cell),
    )


def _library(houses: Sequence[CompiledHouse]) -> dict[str, Model]:
    """Each model once, the agent first; the order of the rest is that of first use."""
    agent = agent_model()
    models = {agent.key: agent}
    for house in houses:
        for key in house.instances.model:
            models.setdefault(key, house.models[key])
    return models


def _pack_geometry(
    houses: Sequence[CompiledHouse], material_start: Int[np.ndarray, " h"], semantic_start: Int[np.ndarray, " h"]
) -> Arrays:
    library = _library(houses)
    models = list(library.values())
    index = {key: i for i, key in enumerate(library)}
    instances = _pack_instances([h.instances for h in houses], index, material_start, semantic_start)
    agent = dict.fromkeys(("agent_model", "agent_material", "agent_semantic"), np.array(0, np.int32))
    return _pack_models(models) | _pack_trees(models, [h.top for h in houses]) | instances | agent


def _pack_models(library: Sequence[Model]) -> Arrays:
    count = sum(len(m.triangle) for m in library)
    if count >= MAX_TRIANGLES:
        raise CapacityError(
            f"the bank's models have {count} triangles, at most {MAX_TRIANGLES - 1} fit",
            hint="Use fewer houses in one bank.",
        )
    return {
        "triangle": concatenate([m.triangle for m in library], np.float32, 0),
        "triangle_uv": concatenate([m.uv for m in library], np.float32, 0),
        "triangle_slot": concatenate([m.slot for m in library], np.int32, 0),
        "triangle_part": concatenate([m.part for m in library], np.int32, 0),
        "model_box": concatenate([m.box[None] for m in library], np.float32, 0),
    }


def _pack_trees(models: Sequence[Model], tops: Sequence[Tree]) -> Arrays:
    """The trees of all models, then those of all houses; the leaves of the latter keep their instance indices."""
    trees = [*(m.tree for m in models), *tops]
    first = np.cumsum([0, *(len(m.triangle) for m in models)])[:-1].tolist() + [0] * len(tops)
    root = np.cumsum([0, *(len(t.child) for t in trees)])[:-1]
    child = [_absolute(t.child, r, f) for t, r, f in zip(trees, root.tolist(), first, strict=True)]
    never = np.array([[np.inf] * 3 + [-np.inf] * 3])
    return {
        "node_box": concatenate([t.box for t in trees], np.float32, never),
        "node_child": concatenate(child, np.int32, -1),
        "model_root": concatenate([root[: len(models)]], np.int32, 0),
        "house_root": root[len(models) :].astype(np.int32),
    }


def _absolute(child: Int[np.ndarray, "n 2"], node: int, first: int) -> Int[np.ndarray, "n 2"]:
    """Tree codes with `node` added to inner nodes and `first` to the primitives of leaves; empty leaves stay."""
    leaf = np.where(child == -1, -1, ~(~child.astype(np.int64) + (first << LEAF_BITS)))
    return np.where(child >= 0, child + node, leaf)


def _pack_instances(
    instances: Sequence[Instances],
    model_index: Mapping[str, int],
    material_start: Int[np.ndarray, " h"],
    semantic_start: Int[np.ndarray, " h"],
) -> Arrays:
    # Agents take the object ids from `size` on, so every object's id must lie below it.
    size = size_class(max(max(len(i.model), 1 + int(i.object_id.max())) for i in instances), 32)
    pose = pad([i.pose for i in instances], size, np.float32, np.eye(3, 4))
    return {
        "instance_model": pad([np.array([model_index[k] for k in i.model]) for i in instances], size, np.int32, -1),
        "instance_pose": pose,
        "instance_inverse": invert(pose.astype(np.float64)).astype(np.float32),
        "instance_object": pad([i.object_id for i in instances], size, np.int32, -1),
        "instance_material": pad(shift([i.material for i in instances], material_start), size, np.int32, 0),
        "instance_semantic": pad(shift([i.semantic for i in instances], semantic_start), size, np.int32, 0),
        "instance_body": pad([i.body for i in instances], size, np.int32, -1),
    }


def _encode_id(house_id: str) -> np.ndarray:
    data = house_id.encode()
    if not house_id.isascii() or not 0 < len(data) <= ID_LENGTH:
        raise ConfigError(f"house id `{house_id}` must be 1 to {ID_LENGTH} ASCII characters")
    return np.frombuffer(data.ljust(ID_LENGTH, b"\0"), np.uint8)
