"""Bounding volume hierarchy over a house's static instances."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float, Int

from home_mjx.geometry.bvh import build_tree
from home_mjx.geometry.meshes import bounds, transform
from home_mjx.schema.compiled import BVH, Instances, Model

INSTANCE_BOX_MARGIN = 1e-4  # [m], margin of boxes; rays intersect instances in local frames, with other rounding errors


def build_instance_tree(
    instances: Instances, models: Mapping[str, Model], doors: Int[np.ndarray, " h"] | None = None
) -> BVH:
    """Build a tree with one static instance per leaf; leaves hold instance indices.

    Args:
        instances: Instances of a house; movable bodies are omitted.
        models: Models by key.
        doors: Instances of door leaves, which are omitted as well; None without doors.
    """
    static = np.setdiff1d(np.flatnonzero(instances.body < 0), [] if doors is None else doors)
    boxes = np.array([instance_box(instances.pose[i], models[instances.model[i]].box) for i in static])
    tree, order = build_tree(boxes + np.array([[-INSTANCE_BOX_MARGIN], [INSTANCE_BOX_MARGIN]]), leaf_size=1)
    leaf = (tree.child < 0) & (tree.child != -1)
    first = np.where(leaf, ~tree.child >> 4, 0)
    return BVH(tree.box, np.where(leaf, ~(static[order[first]] << 4 | 1), tree.child).astype(np.int32))


def instance_box(pose: Float[np.ndarray, "3 4"], box: Float[np.ndarray, "2 3"]) -> Float[np.ndarray, "2 3"]:
    """Return the world bounds of a model's box [m]."""
    corners = np.stack(np.meshgrid(*box.astype(np.float64).T), axis=-1).reshape(-1, 3)
    return bounds(transform(pose, corners))
