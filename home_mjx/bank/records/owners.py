"""Who owns rows of a bank's arrays: what the sources of declarations are given."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import cast

import numpy as np
from jaxtyping import Int, UInt32

from home_mjx.schema.compiled import CompiledHouse, MaterialTable, Model, Tree
from home_mjx.schema.lighting import Gloss

Counts = Mapping[str, int]  # rows by kind


@dataclass(frozen=True)
class TreeAt:
    """A tree whose node 0 is row `node` of the bank; its leaves count primitives from `first` on."""

    record: Tree
    node: int
    first: int


@dataclass(frozen=True)
class ModelAt:
    """A model whose tree begins at row `node` of the bank."""

    record: Model
    node: int


@dataclass(frozen=True)
class AgentRows:
    """What agents have of the tables that houses fill."""

    materials: MaterialTable
    semantics: Int[np.ndarray, "q columns"]
    gloss: Gloss


@dataclass(frozen=True)
class HouseAt:
    """A house in a bank.

    Attributes:
        record: The house; of the tables of materials and semantics also the agents' rows.
        start: Row at which its rows of each kind begin.
        model: Number of each library model, by key.
        layer: Layer of each texture, by path; -1 of "".
        sizes: Of the bank, by axis.
    """

    record: CompiledHouse | AgentRows
    start: Counts
    model: Mapping[str, int]
    layer: Mapping[str, int]
    sizes: Counts

    @property
    def house(self) -> CompiledHouse:
        """The record, where agents have none."""
        return cast(CompiledHouse, self.record)

    @property
    def door_row(self) -> Int[np.ndarray, " n"]:
        """Row of each leaf of the house among a bank's doors, of which the last slide."""
        return self.house.doors.rows(self.sizes["doors"], self.sizes["slides"])


@dataclass(frozen=True)
class SharedRows:
    """What all houses of a bank share."""

    textures: UInt32[np.ndarray, "layers texels"]
    agent: int = 0  # agents come first in the library, and in the tables of materials and semantics


@dataclass(frozen=True)
class Shared:
    """The owner of what all houses share."""

    record: SharedRows
