"""The taste of one home: its favourite models, its wood and metal, the colours of each room, who lives there."""

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
FITTED = ("kitchen_cabinet", "hanging_cabinet", "kitchen_sink", "dishwasher")  # alike all over a kitchen
FRONTS = {"wood": "wood", "paint": "paint", "color": "paint", "stone": "stone", "marble": "stone"}
FAVOURITES = 3  # models of a kind that a home has, at most
SMALLEST = 3  # models that are tried where the favourite one does not fit
USUAL = 0.85  # part of a home's things that are favourites
INTERESTS = ("children", "music", "games", "sport", "books", "plants", "cooking", "pets", "art", "travel")

Look = Mapping[str, Material]


@dataclass(frozen=True)
class Style:
    """Favourites of a home.

    Attributes:
        rng: Source of all that is drawn for the home.
        materials: Favourite material of each finish.
        interests: What those who live there like.
        clutter: How many small things lie around; 1 is usual.
        boarded: Whether railings are of boards.
    """

    rng: np.random.Generator
    materials: Look
    interests: frozenset[str]
    clutter: float
    boarded: bool
    _favourites: dict[str, tuple[int, ...]] = field(default_factory=dict)

    @classmethod
    def draw(cls, rng: np.random.Generator) -> "Style":
        """A style at random."""
        materials = {finish: choose(options, rng) for finish, options in FINISHES.items()}
        metal = choose(FINISHES[choose(METALS, rng)], rng)
        materials |= {finish: metal for finish in ("chrome", "brass") if rng.random() < 0.75}
        likes = frozenset(name for name in INTERESTS if rng.random() < 0.4)
        return cls(rng, materials, likes, float(rng.uniform(0.35, 1.3)), bool(rng.random() < 0.5))

    def look(self) -> Look:
        """The colours of a room: those of the home, or others, for what is soft or painted."""
        own = {f: choose(FINISHES[f], self.rng) for f in OF_ROOMS if self.rng.random() < 0.7}
        return {**self.materials, **own}

    def object(self, kind: str, look: Look | None = None) -> PlacedFurniture:
        """A thing of a kind at the origin: mostly of a favourite model."""
        family, numbers = choices(kind)
        if kind not in self._favourites:
            self._favourites[kind] = tuple(self.rng.permutation(numbers)[:FAVOURITES].tolist())
        usual = self.rng.random() < USUAL
        return self.instance(get_model(family, choose(self._favourites[kind] if usual else numbers, self.rng)), look)

    def options(self, kind: str, look: Look | None = None) -> Iterator[PlacedFurniture]:
        """A thing as by `object`, then some of the smallest models of the kind."""
        yield self.object(kind, look)
        for model in models_of(kind)[:SMALLEST]:
            yield self.instance(model, look)

    def instance(self, model: Furniture, look: Look | None = None) -> PlacedFurniture:
        """A model at the origin, dressed; left and right are swapped sometimes where that makes a difference."""
        mirrored = model.family in HANDED and bool(self.rng.random() < 0.5)
        return PlacedFurniture(model, (0.0, 0.0, 0.0), mirrored=mirrored, materials=self.dress(model, look))

    def dress(self, model: Furniture, look: Look | None = None) -> tuple[Material, ...]:
        """A material for each slot: those of the home and of the room, and what is left at random.

        Args:
            model: Whose slots.
            look: Of the room; None: of the home.
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
        """The material of one slot; `seen` holds what slots of the same model have, by finish."""
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
    """The material of a slot, opaque; made field by field, which takes a fifth of the time of `replace`."""
    m = material
    return Material(slot, m.diffuse, m.texture, None, m.specular, m.shininess, m.missing_file)
