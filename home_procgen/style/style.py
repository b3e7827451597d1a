"""Style of one home: favourite models, wood and metal, colours of each room, and the residents' interests."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from home_mjx.schema.house import Material
from home_procgen.floor_plan.placed import PlacedFurniture
from home_procgen.primitives.family import Furniture
from home_procgen.primitives.palette import choose
from home_procgen.style.kinds import choices, models_of
from home_procgen.things import get_model
from home_procgen.things.finishes import FINISHES

HANDED = ("sofa", "desk", "refrigerator", "kitchen_cabinet", "shower", "bathtub", "kitchen_sink")
METALS = ("chrome", "steel", "brass", "iron", "black")
SOFT = ("upholstery", "textile", "patterned", "leather", "linen", "towel", "curtain", "sheer", "carpet", "fur")
OF_ROOMS = (*SOFT, "carpet_round", "paint", "color", "shade", "felt")
OF_HOMES = ("wood", "chrome", "steel", "brass", "iron", "stone", "marble", "cane", "ceramic", "opal", "masonry")
FITTED = ("kitchen_cabinet", "hanging_cabinet", "kitchen_sink", "dishwasher")  # fronts match throughout a kitchen
FRONTS = {"wood": "wood", "paint": "paint", "color": "paint", "stone": "stone", "marble": "stone"}
FAVOURITES = 3  # maximum number of favourite models of a kind
SMALLEST = 3  # number of smallest models to try if the favourite model does not fit
USUAL = 0.85  # probability that an object is one of the favourite models
INTERESTS = ("children", "music", "games", "sport", "books", "plants", "cooking", "pets", "art", "travel")

Look = Mapping[str, Material]


@dataclass(frozen=True)
class Style:
    """Random style of a home.

    Attributes:
        rng: Source of all randomness of the home.
        materials: Favourite material of each finish.
        interests: Interests of the residents.
        clutter: Amount of small objects; 1 is average.
        boarded: Whether railings have boards instead of bars.
    """

    rng: np.random.Generator
    materials: Look
    interests: frozenset[str]
    clutter: float
    boarded: bool
    _favourites: dict[str, tuple[int, ...]] = field(default_factory=dict)

    @classmethod
    def draw(cls, rng: np.random.Generator) -> "Style":
        """Draw a random style."""
        materials = {finish: choose(options, rng) for finish, options in FINISHES.items()}
        metal = choose(FINISHES[choose(METALS, rng)], rng)
        materials |= {finish: metal for finish in ("chrome", "brass") if rng.random() < 0.75}
        likes = frozenset(name for name in INTERESTS if rng.random() < 0.4)
        return cls(rng, materials, likes, float(rng.uniform(0.35, 1.3)), bool(rng.random() < 0.5))

    def look(self) -> Look:
        """Draw the materials of a room: the home's, with variations of soft and painted finishes."""
        own = {f: choose(FINISHES[f], self.rng) for f in OF_ROOMS if self.rng.random() < 0.7}
        return {**self.materials, **own}

    def object(self, kind: str, look: Look | None = None) -> PlacedFurniture:
        """Draw an object of a kind at the origin, usually of a favourite model."""
        family, numbers = choices(kind)
        if kind not in self._favourites:
            self._favourites[kind] = tuple(self.rng.permutation(numbers)[:FAVOURITES].tolist())
        usual = self.rng.random() < USUAL
        return self.instance(get_model(family, choose(self._favourites[kind] if usual else numbers, self.rng)), look)

    def options(self, kind: str, look: Look | None = None) -> Iterator[PlacedFurniture]:
        """Generate an object as by `object`, then objects of the smallest models of the kind."""
        yield self.object(kind, look)
        for model in models_of(kind)[:SMALLEST]:
            yield self.instance(model, look)

    def instance(self, model: Furniture, look: Look | None = None) -> PlacedFurniture:
        """Return a model at the origin with materials. Families with a left and a right side are mirrored at random."""
        mirrored = model.family in HANDED and bool(self.rng.random() < 0.5)
        return PlacedFurniture(model, (0.0, 0.0, 0.0), mirrored=mirrored, materials=self.dress(model, look))

    def dress(self, model: Furniture, look: Look | None = None) -> tuple[Material, ...]:
        """Draw a material for each slot: the home's or the room's, and a random one for other finishes.

        Args:
            model: The model whose slots are filled.
            look: Materials of the room by finish; None for those of the home.
        """
        usual = self.materials if look is None else look
        seen: dict[str, Material] = {}
        found = []
        for slot, finish in model.slots.items():
            fitted = model.family in FITTED and finish in FRONTS
            material = usual[FRONTS[finish]] if fitted else self._material(finish, usual, seen)
            found.append(_named(material, slot))
        return tuple(found)

    def _material(self, finish: str, usual: Look, seen: dict[str, Material]) -> Material:
        """Return the material of one slot; `seen` holds the materials of the model's earlier slots by finish."""
        options: Sequence[Material] = FINISHES[finish]
        if finish in OF_HOMES:
            if finish not in seen:
                other = finish == "wood" and self.rng.random() < 0.2
                seen[finish] = choose(options, self.rng) if other else usual[finish]
            return seen[finish]
        if finish in OF_ROOMS and finish not in seen:
            seen[finish] = usual[finish] if self.rng.random() < 0.75 else choose(options, self.rng)
            return seen[finish]
        return choose(options, self.rng)


def _named(material: Material, slot: str) -> Material:
    """Return an opaque material with a slot's name; built field by field in a fifth of the time of `replace`."""
    m = material
    return Material(slot, m.diffuse, m.texture, None, m.specular, m.shininess, m.missing_file)
