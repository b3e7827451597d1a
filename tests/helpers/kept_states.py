"""A tree of arrays that can be written as a checkpoint."""

import dataclasses
from typing import Any

import jax


@dataclasses.dataclass
class Tree:
    """What a training knows, as far as checkpoints care."""

    net: Any
    updates: Any


jax.tree_util.register_dataclass(Tree, ["net", "updates"], [])
