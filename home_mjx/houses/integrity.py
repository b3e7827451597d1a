"""Integrity checks of records read from disk: indices are in range and poses are finite.

Native code follows these indices without bounds checks; an invalid or cyclic tree would crash the process.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Int

from home_mjx.schema.compiled import BVH, MAX_DEPTH, CompiledHouse, Model
from home_mjx.schema.lighting import MAP_NAMES

LEAF_BITS, LEAF_MASK = 4, 15


def check_models(models: Mapping[str, Model]) -> None:
    """Validate that models have the keys they are stored under, valid trees over their triangles, and slots >= 0.

    Keys are not compared with the models' content. For trees see `check_trees`.

    Raises:
        ValueError: A key, tree or material slot is invalid.
    """
    for key, model in models.items():
        if model.key != key:
            raise ValueError(f"model has the key {model.key!s:.80}")
    check_trees([model.tree for model in models.values()], [len(model.triangle) for model in models.values()])
    if models and np.concatenate([model.slot for model in models.values()]).min(initial=0) < 0:
        raise ValueError("a model has triangles without a material")


def check_house(house: CompiledHouse, house_id: str) -> None:
    """Validate a house's id, top tree, finite poses and indices in range; not its models, see `check_models`.

    `house.models` must have every model of its instances, else `KeyError`.

    Raises:
        ValueError: One of these checks fails.
    """
    if house.id != house_id:
        raise ValueError(f"house has the id {house.id!s:.80}")
    instances, count, rows = house.instances, len(house.instances.model), len(house.materials.texture)
    check_trees([house.top_bvh], [count])
    if not np.isfinite(instances.pose).all():
        raise ValueError("an instance has a pose that is not finite")
    slots = {key: int(model.slot.max(initial=0)) for key, model in house.models.items()}
    _check_range("instances.material", instances.material, 0, rows)
    _check_range("instances.material", instances.material + np.array([slots[key] for key in instances.model]), 0, rows)
    maps = house.materials.maps
    _check_range("materials.maps.row", maps.row, 0, rows)
    if len(maps.images) != len(MAP_NAMES) * len(maps.row):
        raise ValueError(f"{len(maps.row)} rows of maps have {len(maps.images)} images")
    _check_range("instances.semantic", instances.semantic, 0, len(house.semantics))
    _check_range("instances.body", instances.body, -1, len(house.bodies.instance))
    _check_range("instances.object_id", instances.object_id, -1, 1 << 31)
    _check_range("bodies.instance", house.bodies.instance, 0, count)
    _check_range("doors.instance", house.doors.instance, 0, count)


def check_trees(trees: Sequence[BVH], num_primitives: Sequence[int]) -> None:
    """Validate that trees have a root, at most `MAX_DEPTH` levels, only existing nodes and primitives, and no cycle.

    No node may have two parents. All trees are checked at once, since houses have many small ones.

    Args:
        trees: Trees with arrays of the right shapes.
        num_primitives: Number of primitives of each tree.

    Raises:
        ValueError: A tree is invalid.

    Example:
        >>> check_trees([BVH(np.zeros((1, 2, 6)), np.array([[~(0 << 4 | 2), -1]]))], num_primitives=[2])
        >>> check_trees([BVH(np.zeros((1, 2, 6)), np.array([[0, -1]]))], num_primitives=[2])
        Traceback (most recent call last):
        ...
        ValueError: a tree is too deep, or has a cycle
    """
    if not trees:
        return
    counts = np.array([len(tree.child) for tree in trees], np.intp)
    if not counts.all():
        raise ValueError("a tree has no root")
    code, first = np.concatenate([tree.child for tree in trees]).ravel(), np.cumsum(counts) - counts
    if np.any(np.maximum.reduceat(code, 2 * first) >= counts):
        raise ValueError("a tree refers to missing nodes")
    leaf, inner = ~code, code >= 0
    if np.any(np.maximum.reduceat(((leaf >> LEAF_BITS) + (leaf & LEAF_MASK)) * ~inner, 2 * first) > num_primitives):
        raise ValueError("a tree refers to missing primitives")
    link = np.flatnonzero(inner)
    target = code[link] + np.repeat(first, np.add.reduceat(inner, 2 * first, dtype=np.intp))
    _check_levels(link >> 1, target, int(counts.sum()))


def _check_levels(node: Int[np.ndarray, " n"], below: Int[np.ndarray, " n"], count: int) -> None:
    """Raise `ValueError` if a node has two parents, or is not below a root within `MAX_DEPTH` levels.

    Args:
        node: Parent of each link, counted over all trees.
        below: Child of each link.
        count: Number of nodes of all trees.
    """
    if np.bincount(below).max(initial=0) > 1:
        raise ValueError("a tree refers to a node twice")
    above = np.full(count + 1, count)  # the extra entry is the parent of all roots and of itself
    above[below] = node
    for _ in range(MAX_DEPTH.bit_length() - 1):  # MAX_DEPTH is a power of two
        above = above.take(above)
    if np.any(above != count):
        raise ValueError("a tree is too deep, or has a cycle")


def _check_range(name: str, values: Int[np.ndarray, " n"], least: int, below: int) -> None:
    """Raise `ValueError` unless all values are in [least, below)."""
    if np.any((values < least) | (values >= below)):
        raise ValueError(f"`{name}` is out of range")
