"""The taste of one house: which models and materials it prefers, so that its furniture goes together."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from home_mjx.schema.house import Material
from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.primitives.family import FurnitureModel
from home_procgen.primitives.palette import FINISHES, choose_random
from home_procgen.v1.furniture import family_models

_STRETCHED = ("rug", "round_rug", "picture", "wardrobe", "dresser", "dining_table", "sofa", "double_bed")
_HANDED = ("sofa", "desk", "refrigerator", "kitchen_cabinet", "shower", "bathtub")


@dataclass(frozen=True)
class Style:
    """Favourites of a house."""

    rng: np.random.Generator
    models: Mapping[str, FurnitureModel]
    materials: Mapping[str, Material]

    @classmethod
    def draw(cls, rng: np.random.Generator) -> "Style":
        """A style at random."""
        models = {family: choose_random(options, rng) for family, options in family_models().items()}
        return cls(rng, models, {finish: choose_random(options, rng) for finish, options in FINISHES.items()})

    def object(self, family: str) -> PlacedModel:
        """An object of a family at the origin: mostly the favourite model."""
        favourite = self.rng.random() < 0.7
        return self._instance(self.models[family] if favourite else choose_random(family_models()[family], self.rng))

    def choices(self, family: str) -> Iterator[PlacedModel]:
        """An object as by `object`, then one of every model of the family, smaller ones first."""
        yield self.object(family)
        for model in sorted(family_models()[family], key=lambda model: float(model.size[0])):
            yield self._instance(model)

    def _instance(self, model: FurnitureModel) -> PlacedModel:
        """A model at the origin, sometimes stretched or mirrored."""
        family = model.family
        wide, deep = np.round(self.rng.uniform(0.92, 1.08, 2), 2).tolist() if family in _STRETCHED else (1.0, 1.0)
        mirrored = family in _HANDED and bool(self.rng.random() < 0.5)
        return PlacedModel(model, (0.0, 0.0, 0.0), 0, (wide, 1.0, deep), mirrored, materials=self.dress(model))

    def dress(self, model: FurnitureModel) -> tuple[Material, ...]:
        """A material per slot: often the favourite of its finish, and mostly the same in all slots of one finish."""
        last: dict[str, Material] = {}
        materials = []
        for slot, finish in model.slots.items():
            if finish not in last or finish == "book" or self.rng.random() < 0.25:
                favourite = finish != "book" and self.rng.random() < 2 / 3
                last[finish] = self.materials[finish] if favourite else choose_random(FINISHES[finish], self.rng)
            materials.append(replace(last[finish], name=slot, opacity=None))
        return tuple(materials)
