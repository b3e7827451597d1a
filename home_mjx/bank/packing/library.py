"""Library of models and textures shared by the houses of a bank, the owners of its array rows, and the agent model."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from home_mjx.bank.packing.capacity import cumulative_starts, shared_rows
from home_mjx.bank.packing.texture_layers import cutout_bits, load_textures
from home_mjx.bank.records.declaration import HOUSE_AXIS, SHARED, Sizes
from home_mjx.bank.records.owners import AgentRows, Counts, HouseOwner, ModelOwner, SharedArrays, SharedOwner, TreeOwner
from home_mjx.core.images import has_cut_outs
from home_mjx.geometry.meshes import box_triangles, make_model
from home_mjx.schema.agent import AgentBody
from home_mjx.schema.compiled import ARCHITECTURE, CompiledHouse, MaterialTable, Model
from home_mjx.schema.lighting import Gloss
from home_mjx.schema.semantic import semantic_row

Owners = dict[str, list]  # in the order of their rows, by kind of array
RADIUS, HEIGHT = AgentBody().radius, AgentBody().height  # [m]; scenes scale the model to other bodies
VISOR_CENTER = (0.09, 0.0, AgentBody().eye_height - HEIGHT / 2)  # [m], at eye height
VISOR_SIZE = (0.07, 0.12, 0.06)  # [m]
SEGMENTS = 16  # around the axis
RINGS = 4  # per hemisphere


@dataclass(frozen=True)
class Library:
    """Shared models by key, the agent's first, and texture files, both in the order of the bank."""

    models: Mapping[str, Model]
    textures: tuple[str, ...]
    agent_materials: MaterialTable

    @classmethod
    def from_houses(cls, houses: Sequence[CompiledHouse]) -> "Library":
        """Collect the houses' models, except architecture, and textures once; agent materials are the first house's.

        There must be a house. Models are in order of first use, textures sorted by path. Of models of one key, the
        first is kept.
        """
        agent = agent_model()
        models = {agent.key: agent}
        for house in houses:
            for key in house.instances.model[ARCHITECTURE + 1 :]:
                models.setdefault(key, house.models[key])
        textures = {path for house in houses for path in house.materials.texture if path}
        return cls(models, tuple(sorted(textures)), houses[0].agent_materials)

    @cached_property
    def model_index(self) -> dict[str, int]:
        """Row of each model among the bank's models, by key; the agent's is 0."""
        return {key: i for i, key in enumerate(self.models)}

    @cached_property
    def texture_layer(self) -> dict[str, int]:
        """Layer of each texture, by path; -1 for no texture."""
        return {"": -1} | {path: i for i, path in enumerate(self.textures)}

    @cached_property
    def cutouts(self) -> frozenset[str]:
        """Paths of textures with a texel of alpha below `MIN_OPAQUE_ALPHA`, at the files' own sizes.

        The first access reads all texture files and decodes those with alpha; see `has_cut_outs` for its errors.
        """
        return frozenset(path for path in self.textures if has_cut_outs(Path(path)))

    @cached_property
    def num_rows(self) -> dict[str, int]:
        """Rows of the library in each concatenated table, which precede those of the houses."""
        return shared_rows(self.models.values(), self.agent_materials, agent_semantics())

    def owners(self, sizes: Sizes) -> Owners:
        """Return the owners, by kind, of the shared rows, which begin at 0: models, agents' materials and semantics.

        Textures are not included, see `shared_owners`.
        """
        models = list(self.models.values())
        sizes_of = [{"node": len(m.tree.child), "triangle": len(m.triangle)} for m in models]
        starts = cumulative_starts({"node": 0, "triangle": 0}, sizes_of)
        found: Owners = {}
        for model, at in zip(models, starts, strict=True):
            for kind, owners in model_owners(model, at).items():
                found.setdefault(kind, []).extend(owners)
        materials = self.agent_materials
        agent = AgentRows(materials, agent_semantics(), Gloss.matt(len(materials.mask)))
        row = HouseOwner(
            agent, dict.fromkeys(self.num_rows, 0), self.model_index, self.texture_layer, frozenset(), sizes
        )
        return found | {"material": [row], "semantic": [row]}

    def shared_owners(self, texture_size: int) -> Owners:
        """Read all textures at edge `texture_size` [px]; return {`SHARED`: [owner of texels and cut-outs]}."""
        layers = load_textures(self.textures, texture_size)
        return {SHARED: [SharedOwner(SharedArrays(layers.view("<u4")[..., 0], cutout_bits(layers, texture_size)))]}

    def house_owners(self, house: CompiledHouse, start: Counts, sizes: Sizes) -> Owners:
        """Return the owners of a house's private rows, by kind; `start` has its first row of each of `ROW_KINDS`.

        These are its architecture, top-level BVH, materials, semantics, cells, and its row along `HOUSE_AXIS`.
        """
        own = house.models[house.instances.model[ARCHITECTURE]]
        found = model_owners(own, start)
        found["node"].append(TreeOwner(house.top_bvh, start["node"] + len(own.tree.child), 0))  # leaves hold instances
        at = HouseOwner(house, start, self.model_index, self.texture_layer, self.cutouts, sizes)
        return found | {kind: [at] for kind in ("material", "semantic", "cell", HOUSE_AXIS)}


def model_owners(model: Model, start: Counts) -> Owners:
    """Return the owners of one model's rows, by kind; `start` has its first rows of `node` and `triangle`."""
    at = ModelOwner(model, start["node"], start["triangle"])
    return {"model": [at], "triangle": [at], "node": [TreeOwner(model.tree, start["node"], start["triangle"])]}


def agent_model() -> Model:
    """Build the agent's library model: origin mid-capsule, Z up, facing +x; material slots 0 (body) and 1 (visor)."""
    body = _capsule()
    visor = box_triangles(np.array(VISOR_CENTER), np.array(VISOR_SIZE) / 2)
    slot = np.repeat([0, 1], [len(body), len(visor)])
    return make_model("agent", np.concatenate([body, visor]), slot=slot)


def agent_semantics() -> Int[np.ndarray, "1 columns"]:
    """Return the semantic row that all agents share."""
    return semantic_row("person", "person", "person")[None]


def _capsule() -> Float[np.ndarray, "t 3 3"]:
    """Build a capsule of `RADIUS` and total `HEIGHT` [m], along z, centred; triangles counter-clockwise from outside.

    Triangles without an area, at the poles, are left out.
    """
    angle = np.linspace(-np.pi / 2, 0, RINGS + 1)
    radius = RADIUS * np.cos(np.concatenate([angle, -angle[::-1]]))
    shift = np.repeat([-1, 1], RINGS + 1) * (HEIGHT / 2 - RADIUS)
    z = RADIUS * np.sin(np.concatenate([angle, -angle[::-1]])) + shift
    turn = np.arange(SEGMENTS) * 2 * np.pi / SEGMENTS
    xy = radius[:, None, None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    points = np.concatenate([xy, np.broadcast_to(z[:, None, None], (*xy.shape[:2], 1))], axis=-1)
    lower, upper = points[:-1], points[1:]
    lower_next, upper_next = np.roll(lower, -1, axis=1), np.roll(upper, -1, axis=1)
    quads = [[lower, lower_next, upper_next], [lower, upper_next, upper]]
    triangles = np.concatenate([np.stack(q, axis=2).reshape(-1, 3, 3) for q in quads])
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return triangles[np.linalg.norm(normal, axis=1) > 1e-9]
