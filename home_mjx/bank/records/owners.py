"""Owners of rows of a bank's arrays: the arguments of the sources of declarations."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import cast

import numpy as np
from jaxtyping import Int, UInt32

from home_mjx.schema.compiled import BVH, CompiledHouse, MaterialTable, Model
from home_mjx.schema.lighting import Gloss

Counts = Mapping[str, int]  # rows by kind


@dataclass(frozen=True)
class TreeOwner:
    """A BVH with node 0 at row `node` of the bank; its leaves count primitives from `first` on."""

    record: BVH
    node: int
    first: int


@dataclass(frozen=True)
class ModelOwner:
    """A model with its BVH at row `node` and its triangles at row `triangle` of the bank."""

    record: Model
    node: int
    triangle: int


@dataclass(frozen=True)
class AgentRows:
    """Rows of agents in the tables of materials and semantics."""

    materials: MaterialTable
    semantics: Int[np.ndarray, "q columns"]
    gloss: Gloss


@dataclass(frozen=True)
class HouseOwner:
    """A house at its rows in a bank.

    Attributes:
        record: The house; or the agents' rows, for the tables of materials and semantics.
        start: First row of each kind.
        model_index: Index of each library model, by key.
        texture_layer: Layer of each texture, by path; -1 for "".
        cutouts: Paths of textures with cut-out texels.
        sizes: Lengths of the bank's axes, by name.
    """

    record: CompiledHouse | AgentRows
    start: Counts
    model_index: Mapping[str, int]
    texture_layer: Mapping[str, int]
    cutouts: frozenset[str]
    sizes: Counts

    @property
    def house(self) -> CompiledHouse:
        """The record as a house; only valid for arrays without agents' rows."""
        return cast(CompiledHouse, self.record)

    @property
    def door_row(self) -> Int[np.ndarray, " n"]:
        """Row of each leaf along the house's own padded `doors` axis: hinged from 0, sliding in the last `slides`."""
        return self.house.doors.bank_rows(self.sizes["doors"], self.sizes["slides"])


@dataclass(frozen=True)
class SharedArrays:
    """Values shared by all houses of a bank."""

    textures: UInt32[np.ndarray, "layers texels"]
    cutout: UInt32[np.ndarray, "layers edge words"]
    agent: int = 0  # agents come first in the library, and in the tables of materials and semantics


@dataclass(frozen=True)
class SharedOwner:
    """The owner of shared arrays."""

    record: SharedArrays
