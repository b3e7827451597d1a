"""Library of models and textures shared by the houses of a bank, and the owners of its array rows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from home_mjx.bank.packing.agent_model import agent_model, agent_semantics
from home_mjx.bank.packing.capacity import cumulative_starts, shared_rows
from home_mjx.bank.packing.texture_layers import load_textures
from home_mjx.bank.records.declaration import HOUSE_AXIS, SHARED, Sizes
from home_mjx.bank.records.owners import AgentRows, Counts, HouseOwner, ModelOwner, SharedArrays, SharedOwner, TreeOwner
from home_mjx.schema.compiled import ARCHITECTURE, CompiledHouse, MaterialTable, Model
from home_mjx.schema.lighting import Gloss

Owners = dict[str, list]  # in the order of their rows, by kind of array


@dataclass(frozen=True)
class Library:
    """Shared models by key, the agent's first, and texture files, both in the order of the bank."""

    models: Mapping[str, Model]
    textures: tuple[str, ...]
    agent_materials: MaterialTable

    @classmethod
    def from_houses(cls, houses: Sequence[CompiledHouse]) -> "Library":
        """Collect each model and texture of the houses once; a house's architecture is private to it."""
        agent = agent_model()
        models = {agent.key: agent}
        for house in houses:
            for key in house.instances.model[ARCHITECTURE + 1 :]:
                models.setdefault(key, house.models[key])
        textures = {path for house in houses for path in house.materials.texture if path}
        return cls(models, tuple(sorted(textures)), houses[0].agent_materials)

    @cached_property
    def model_index(self) -> dict[str, int]:
        """Index of each model, by key."""
        return {key: i for i, key in enumerate(self.models)}

    @cached_property
    def texture_layer(self) -> dict[str, int]:
        """Layer of each texture, by path; -1 for no texture."""
        return {"": -1} | {path: i for i, path in enumerate(self.textures)}

    @cached_property
    def num_rows(self) -> dict[str, int]:
        """Rows of the library in each concatenated table, which precede those of the houses."""
        return shared_rows(self.models.values(), self.agent_materials, agent_semantics())

    def owners(self, sizes: Sizes) -> Owners:
        """Return the owners of the library's rows."""
        models = list(self.models.values())
        sizes_of = [{"node": len(m.tree.child), "triangle": len(m.triangle)} for m in models]
        starts = cumulative_starts({"node": 0, "triangle": 0}, sizes_of)
        found: Owners = {}
        for model, at in zip(models, starts, strict=True):
            for kind, owners in model_owners(model, at).items():
                found.setdefault(kind, []).extend(owners)
        materials = self.agent_materials
        agent = AgentRows(materials, agent_semantics(), Gloss.matt(len(materials.mask)))
        row = HouseOwner(agent, dict.fromkeys(self.num_rows, 0), self.model_index, self.texture_layer, sizes)
        return found | {"material": [row], "semantic": [row]}

    def shared_owners(self, texture_size: int) -> Owners:
        """Return the owner of shared arrays without rows; this reads the textures."""
        pixels = load_textures(self.textures, texture_size).view("<u4")[..., 0]
        return {SHARED: [SharedOwner(SharedArrays(pixels))]}

    def house_owners(self, house: CompiledHouse, start: Counts, sizes: Sizes) -> Owners:
        """Return the owners of a house's private rows.

        Args:
            house: The house.
            start: First row of each kind.
            sizes: CapacityAxis lengths of the bank.
        """
        own = house.models[house.instances.model[ARCHITECTURE]]
        found = model_owners(own, start)
        found["node"].append(TreeOwner(house.top_bvh, start["node"] + len(own.tree.child), 0))  # leaves hold instances
        at = HouseOwner(house, start, self.model_index, self.texture_layer, sizes)
        return found | {kind: [at] for kind in ("material", "semantic", "cell", HOUSE_AXIS)}


def model_owners(model: Model, start: Counts) -> Owners:
    """Return the owners of the rows of one model."""
    at = ModelOwner(model, start["node"])
    return {"model": [at], "triangle": [at], "node": [TreeOwner(model.tree, start["node"], start["triangle"])]}
