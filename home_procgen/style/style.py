"""Style of one home: favourite models, wood and metal, colours of each room, and the residents' interests."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from home_mjx.schema.house import Material
from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.model_store import get_model
from home_procgen.presets import FULL_EQUIPMENT, Equipment
from home_procgen.primitives.family import FurnitureModel
from home_procgen.primitives.palette import choose_random
from home_procgen.style.object_kinds import list_models, resolve_kind
from home_procgen.textures.finishes import FINISHES

MIRRORED_FAMILIES = ("sofa", "desk", "refrigerator", "kitchen_cabinet", "shower", "bathtub", "kitchen_sink")
METAL_FINISHES = ("chrome", "steel", "brass", "iron", "black")
SOFT_FINISHES = ("upholstery", "textile", "patterned", "leather", "linen", "towel", "curtain", "sheer", "carpet", "fur")
ROOM_FINISHES = (*SOFT_FINISHES, "carpet_round", "paint", "color", "shade", "felt")
HOME_FINISHES = (
    "wood",
    "chrome",
    "steel",
    "brass",
    "iron",
    "stone",
    "marble",
    "cane",
    "ceramic",
    "opal",
    "masonry",
    "tiling",
)
FITTED_FAMILIES = (
    "kitchen_cabinet",
    "hanging_cabinet",
    "kitchen_sink",
    "dishwasher",
)  # fronts match throughout a kitchen
FRONT_FINISHES = {"wood": "wood", "paint": "paint", "color": "paint", "stone": "stone", "marble": "stone"}
MAX_FAVOURITES = 3  # maximum number of favourite models of a kind
NUM_VARIED_OPTIONS = 4  # number of models of a varied kind to try before the smallest
NUM_SMALLEST_OPTIONS = 3  # number of smallest models to try if the favourite model does not fit
VARIED_KINDS = ("double_bed", "single_bed", "plain_wardrobe", "bathtub", "plant")  # rarely twice the same in a home
FAVOURITE_PROBABILITY = 0.85  # probability that an object is one of the favourite models
INTERESTS = ("children", "music", "games", "sport", "books", "plants", "cooking", "pets", "art", "travel")

FinishMaterials = Mapping[str, Material]


@dataclass(frozen=True)
class HomeStyle:
    """Random style of a home.

    Attributes:
        rng: Source of all randomness of the home.
        materials: Favourite material of each finish.
        interests: Interests of the residents.
        clutter: Amount of small objects; 1 is average.
        equipment: Amount of optional furniture, small objects and fittings, as of `Preset`.
        has_board_railings: Whether railings have boards instead of bars.
    """

    rng: np.random.Generator
    materials: FinishMaterials
    interests: frozenset[str]
    clutter: float
    has_board_railings: bool
    equipment: Equipment = FULL_EQUIPMENT
    _favourites: dict[str, tuple[int, ...]] = field(default_factory=dict)

    @classmethod
    def draw(cls, rng: np.random.Generator, equipment: Equipment = FULL_EQUIPMENT) -> "HomeStyle":
        """Draw a random style, which draws from the same source of randomness later."""
        materials = {finish: choose_random(options, rng) for finish, options in FINISHES.items()}
        metal = choose_random(FINISHES[choose_random(METAL_FINISHES, rng)], rng)
        materials |= {finish: metal for finish in ("chrome", "brass") if rng.random() < 0.75}
        likes = frozenset(name for name in INTERESTS if rng.random() < 0.4)
        clutter = equipment.small_objects * float(rng.uniform(0.35, 1.3))
        return cls(rng, materials, likes, clutter, bool(rng.random() < 0.5), equipment)

    def draw_room_materials(self) -> FinishMaterials:
        """Draw the materials of a room: the home's, with variations of soft and painted finishes."""
        own = {f: choose_random(FINISHES[f], self.rng) for f in ROOM_FINISHES if self.rng.random() < 0.7}
        return {**self.materials, **own}

    def draw_object(self, kind: str, look: FinishMaterials | None = None) -> PlacedModel:
        """Draw an object of a kind at the origin, usually of a favourite model; see `make_object`."""
        family, numbers = resolve_kind(kind)
        if kind not in self._favourites:
            count = len(numbers) if kind in VARIED_KINDS else MAX_FAVOURITES
            self._favourites[kind] = tuple(self.rng.permutation(numbers)[:count].tolist())
        if kind in VARIED_KINDS:  # each in turn: rooms differ
            first, *later = self._favourites[kind]
            self._favourites[kind] = (*later, first)
            return self.make_object(get_model(family, first), look)
        usual = self.rng.random() < FAVOURITE_PROBABILITY
        return self.make_object(
            get_model(family, choose_random(self._favourites[kind] if usual else numbers, self.rng)), look
        )

    def object_candidates(self, kind: str, look: FinishMaterials | None = None) -> Iterator[PlacedModel]:
        """Generate an object as by `draw_object`, more of a varied kind, then objects of the smallest models."""
        for _ in range(NUM_VARIED_OPTIONS if kind in VARIED_KINDS else 1):
            yield self.draw_object(kind, look)
        for model in list_models(kind)[:NUM_SMALLEST_OPTIONS]:
            yield self.make_object(model, look)

    def make_object(self, model: FurnitureModel, look: FinishMaterials | None = None) -> PlacedModel:
        """Return a model at the origin with materials of `look` or the home; some families are mirrored at random."""
        mirrored = model.family in MIRRORED_FAMILIES and bool(self.rng.random() < 0.5)
        return PlacedModel(model, (0.0, 0.0, 0.0), mirrored=mirrored, materials=self.draw_materials(model, look))

    def draw_materials(self, model: FurnitureModel, materials: FinishMaterials | None = None) -> tuple[Material, ...]:
        """Draw a material for each slot: the home's or the room's, and a random one for other finishes.

        Args:
            model: The model whose slots are filled.
            materials: Materials of the room by finish; None for those of the home.
        """
        usual = self.materials if materials is None else materials
        seen: dict[str, Material] = {}
        found = []
        for slot, finish in model.slots.items():
            if model.family in FITTED_FAMILIES and finish in FRONT_FINISHES:
                material = usual[FRONT_FINISHES[finish]]
            elif model.family == "curtain" and finish in SOFT_FINISHES:  # one cloth for all windows of a room
                material = usual[finish]
            else:
                material = self._material(finish, usual, seen)
            found.append(_name_material(material, slot))
        return tuple(found)

    def _material(self, finish: str, usual: FinishMaterials, seen: dict[str, Material]) -> Material:
        """Return the material of one slot; `seen` holds the materials of the model's earlier slots by finish."""
        options: Sequence[Material] = FINISHES[finish]
        if finish in HOME_FINISHES:
            if finish not in seen:
                other = finish == "wood" and self.rng.random() < 0.2
                seen[finish] = choose_random(options, self.rng) if other else usual[finish]
            return seen[finish]
        if finish in ROOM_FINISHES and finish not in seen:
            seen[finish] = usual[finish] if self.rng.random() < 0.75 else choose_random(options, self.rng)
            return seen[finish]
        return choose_random(options, self.rng)


def _name_material(material: Material, slot: str) -> Material:
    """Return a material named as a slot, which keeps the model's opacity (None); five times as fast as `replace`."""
    m = material
    return Material(slot, m.diffuse, m.texture, None, m.specular, m.shininess, m.missing_file)
