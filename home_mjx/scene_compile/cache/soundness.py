"""Whether what was read from disk can be used: its indices point to what there is, and its poses are numbers.

Native code follows these indices without looking; a tree that pointed elsewhere, or in a circle, would end the process.
"""

import numpy as np
from jaxtyping import Int

from home_mjx.scene_compile.geometry.bvh import MAX_DEPTH
from home_mjx.schema.compiled import CompiledHouse, Model, Tree

LEAF_BITS, LEAF_MASK = 4, 15


def check_model(model: Model, key: str) -> None:
    """Raises `ValueError` unless it is the model of that key, with a tree over its triangles."""
    if model.key != key:
        raise ValueError(f"model is {model.key!s:.80}")
    check_tree(model.tree, len(model.triangle))
    if not np.isfinite(model.triangle).all() or np.any(model.slot < 0):
        raise ValueError("model has triangles that are no numbers, or of no material")


def check_house(house: CompiledHouse, house_id: str) -> None:
    """Raises `ValueError` unless it is the house of that id, its models sound and its indices in range.

    Args:
        house: With its models.
        house_id: Which it should be.
    """
    if house.id != house_id:
        raise ValueError(f"house is {house.id!s:.80}")
    instances, count, rows = house.instances, len(house.instances.model), len(house.materials.texture)
    check_tree(house.top, count)
    if not np.isfinite(instances.pose).all():
        raise ValueError("an instance has a pose that is no number")
    slots = [int(house.models[key].slot.max(initial=0)) for key in instances.model]
    _check_range("instances.material", instances.material, 0, rows)
    _check_range("instances.material", instances.material + np.array(slots), 0, rows)
    _check_range("instances.semantic", instances.semantic, 0, len(house.semantics))
    _check_range("instances.body", instances.body, -1, len(house.bodies.instance))
    _check_range("instances.object_id", instances.object_id, -1, 1 << 31)
    _check_range("bodies.instance", house.bodies.instance, 0, count)
    _check_range("doors.instance", house.doors.instance, 0, count)


def check_tree(tree: Tree, primitives: int) -> None:
    """Raises `ValueError` unless it is a tree of at most `MAX_DEPTH` levels, over primitives that there are.

    Nodes come after their parents, as `build_tree` has them.

    Args:
        tree: Any arrays of the right shapes.
        primitives: How many there are.

    Example:
        >>> check_tree(Tree(np.zeros((1, 2, 6)), np.array([[~(0 << 4 | 2), -1]])), primitives=2)
        >>> check_tree(Tree(np.zeros((1, 2, 6)), np.array([[0, -1]])), primitives=2)
        Traceback (most recent call last):
        ...
        ValueError: tree leads back
    """
    child, count = tree.child.astype(np.int64), len(tree.child)
    row, side = np.nonzero(child >= 0)
    inner, leaf = child[row, side], ~child[child < 0]
    if not count or inner.max(initial=0) >= count:
        raise ValueError("tree leads to nodes that there are not")
    if np.any((leaf >> LEAF_BITS) + (leaf & LEAF_MASK) > primitives):
        raise ValueError("tree leads to primitives that there are not")
    if np.any(inner <= row):
        raise ValueError("tree leads back")
    parent = np.zeros(count, np.int64)
    parent[inner] = row
    if np.count_nonzero(np.bincount(inner, minlength=count) > 1):
        raise ValueError("tree leads to a node twice")
    if count >= MAX_DEPTH and np.any(_ancestor(parent, MAX_DEPTH - 1)):
        raise ValueError("tree is too deep")


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
