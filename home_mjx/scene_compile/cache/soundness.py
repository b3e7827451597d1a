"""Whether what was read from disk can be used: its indices point to what there is, and its poses are numbers.

Native code follows these indices without looking; a tree that pointed elsewhere, or in a circle, would end the process.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Int

from home_mjx.scene_compile.geometry.bvh import MAX_DEPTH
from home_mjx.schema.compiled import CompiledHouse, Model, Tree

LEAF_BITS, LEAF_MASK = 4, 15


def check_models(models: Mapping[str, Model]) -> None:
    """Raises `ValueError` unless they are the models of their keys, each with a tree over its triangles."""
    for key, model in models.items():
        if model.key != key:
            raise ValueError(f"model is {model.key!s:.80}")
    check_trees([model.tree for model in models.values()], [len(model.triangle) for model in models.values()])
    if models and np.concatenate([model.slot for model in models.values()]).min(initial=0) < 0:
        raise ValueError("a model has triangles of no material")


def check_house(house: CompiledHouse, house_id: str) -> None:
    """Raises `ValueError` unless it is the house of that id, its models sound and its indices in range.

    Args:
        house: With its models.
        house_id: Which it should be.
    """
    if house.id != house_id:
        raise ValueError(f"house is {house.id!s:.80}")
    instances, count, rows = house.instances, len(house.instances.model), len(house.materials.texture)
    check_trees([house.top], [count])
    if not np.isfinite(instances.pose).all():
        raise ValueError("an instance has a pose that is no number")
    slots = {key: int(model.slot.max(initial=0)) for key, model in house.models.items()}
    _check_range("instances.material", instances.material, 0, rows)
    _check_range("instances.material", instances.material + np.array([slots[key] for key in instances.model]), 0, rows)
    _check_range("instances.semantic", instances.semantic, 0, len(house.semantics))
    _check_range("instances.body", instances.body, -1, len(house.bodies.instance))
    _check_range("instances.object_id", instances.object_id, -1, 1 << 31)
    _check_range("bodies.instance", house.bodies.instance, 0, count)
    _check_range("doors.instance", house.doors.instance, 0, count)


def check_trees(trees: Sequence[Tree], primitives: Sequence[int]) -> None:
    """Raises `ValueError` unless all are trees of at most `MAX_DEPTH` levels, over primitives that there are.

    Nodes come after their parents, as `build_tree` has them. All at once: houses have many small trees.

    Args:
        trees: Any arrays of the right shapes.
        primitives: How many each is over.

    Example:
        >>> check_trees([Tree(np.zeros((1, 2, 6)), np.array([[~(0 << 4 | 2), -1]]))], primitives=[2])
        >>> check_trees([Tree(np.zeros((1, 2, 6)), np.array([[0, -1]]))], primitives=[2])
        Traceback (most recent call last):
        ...
        ValueError: a tree leads back
    """
    counts = np.array([len(tree.child) for tree in trees], np.int64)
    if not counts.all():
        raise ValueError("a tree has no root")
    child = np.concatenate([np.zeros((0, 2), np.int64), *(tree.child for tree in trees)])
    owner, root = np.repeat(np.arange(len(trees)), counts), np.repeat(np.cumsum(counts) - counts, counts)
    row, side = np.nonzero(child >= 0)
    inner = child[row, side] + root[row]
    if np.any(child[row, side] >= counts[owner[row]]):
        raise ValueError("a tree leads to nodes that there are not")
    leaf_row, side = np.nonzero(child < 0)
    leaf = ~child[leaf_row, side]
    if np.any((leaf >> LEAF_BITS) + (leaf & LEAF_MASK) > np.array(primitives, np.int64)[owner[leaf_row]]):
        raise ValueError("a tree leads to primitives that there are not")
    if np.any(inner <= row):
        raise ValueError("a tree leads back")
    if np.bincount(inner).max(initial=0) > 1:
        raise ValueError("a tree leads to a node twice")
    parent = root.copy()
    parent[inner] = row
    if np.any(_ancestor(parent, MAX_DEPTH - 1) != root):
        raise ValueError("a tree is too deep")


def _ancestor(parent: Int[np.ndarray, " n"], steps: int) -> Int[np.ndarray, " n"]:
    """What lies so many steps above each node; the root is above itself."""
    found, jump = np.arange(len(parent)), parent
    while steps:
        found = jump[found] if steps & 1 else found
        jump, steps = jump[jump], steps >> 1
    return found


def _check_range(name: str, values: Int[np.ndarray, " n"], least: int, below: int) -> None:
    if np.any((values < least) | (values >= below)):
        raise ValueError(f"`{name}` is out of range")
