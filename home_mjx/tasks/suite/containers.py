"""Tasks about things inside of furniture: bring one out of its container."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool

from home_mjx.bank.bank import HouseBank
from home_mjx.errors import ConfigError
from home_mjx.navigation.compartments import compartment_at, has_room
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.language.phrases import identify_objects, minimal_identifying_words, noun_phrase
from home_mjx.tasks.rules.enums import Attribute, Feature
from home_mjx.tasks.rules.house_view import HouseObject, HouseView
from home_mjx.tasks.rules.program import Condition, Selector
from home_mjx.tasks.rules.task_bank import TaskBank
from home_mjx.tasks.suite.portable_objects import PortableObject, find_portable_objects
from home_mjx.tasks.suite.rearrangement import Fetch, Words

# Words for what is put elsewhere: its room is another one then.
LASTING_ATTRIBUTES = (Attribute.COLOR, Attribute.SIZE, Attribute.MATERIAL)
# Gap between a hidden object and the sides of its compartment [m]: rays that end 2 cm before an object count as sight.
HIDING_CLEARANCE = 0.025
ROOM_COLUMNS = [Semantic.ROOM, Semantic.LEVEL, Semantic.ROOM_TYPE, Semantic.ROOM_LABELS]


@dataclass(frozen=True)
class StoredObject(PortableObject):
    """An object that begins inside of furniture.

    Attributes:
        compartment: Index of its compartment along those of the house.
        container: The furniture.
        container_words: Words that identify the furniture.
    """

    compartment: int
    container: HouseObject
    container_words: Words

    @property
    def condition(self) -> Condition:
        """The condition that descriptor 0 is in its first compartment, that of descriptor 2: so an episode begins."""
        at = float(self.compartment)
        return Condition(Feature.CONTAINED, 0, 2, minimum=at, maximum=at)


def store_objects(
    view: HouseView, things: Sequence[tuple[PortableObject, Words]], random: np.random.Generator
) -> Iterator[tuple[StoredObject, Words]]:
    """Yield objects inside of furniture that words identify, each in each piece of it once, in a random compartment.

    Hands can open the front before it and take the object out, see `HouseView.stored_cells`. It is hidden while the
    front is shut. Objects are described as if they were in the room of the furniture.
    """
    fits = _fitting_compartments(view)
    holders = [thing for thing in view.objects if view.compartments_of(thing)]
    for holder, words in identify_objects(view.objects, holders, random):
        for thing, own in things:
            for slot in random.permutation(view.compartments_of(holder)).tolist():
                if fits[slot, thing.object.body] and len(view.stored_cells(thing.instance, slot)[0]):
                    yield _store(view, thing, slot, holder, words), own
                    break


def _fitting_compartments(view: HouseView) -> Bool[np.ndarray, "c k"]:
    """Return which compartments of a house have room for which bodies, so that these are hidden; none that has one."""
    bank, house = view.bank, jnp.int32(view.house)
    if bank.compartments.is_empty:
        return np.zeros((0, bank.spec.num_bodies), bool)
    fits = np.asarray(has_room(bank, house, jnp.asarray(bank.physics.body_quat[view.house]), HIDING_CLEARANCE))
    shut, places = (jnp.asarray(x[view.house]) for x in (bank.physics.door_closed, bank.physics.body_pos))
    within = np.asarray(compartment_at(bank, house, shut, places))
    taken = within[np.asarray(bank.physics.body_valid[view.house])]
    return fits & ~np.isin(np.arange(len(fits)), taken)[:, None]


def _store(view: HouseView, thing: PortableObject, slot: int, holder: HouseObject, words: Words) -> StoredObject:
    """Return an object as it is in a compartment of furniture: with its bounds and room."""
    semantics = thing.object.semantics.copy()
    semantics[ROOM_COLUMNS] = holder.semantics[ROOM_COLUMNS]
    there = replace(thing.object, box=view.compartment_box(slot), semantics=semantics)
    return StoredObject(there, thing.instance, slot, holder, words)


@dataclass(frozen=True)
class FetchFromContainer(Fetch):
    """Take an object out of furniture, and bring it to another object, into a room, or to the start of the episode."""

    def task_bank(self, bank: HouseBank) -> TaskBank:
        """Return the rows; see `RowTask.task_bank`.

        Raises:
            ConfigError: No house has furniture that opens; or as `RowTask.task_bank`.
        """
        if bank.compartments.is_empty:
            hint = "Give max_fronts=24, and houses whose furniture has joints."
            raise ConfigError("FetchFromContainer needs furniture that opens, and no house has any", hint=hint)
        return super().task_bank(bank)

    def _choose_objects(self, view: HouseView, random: np.random.Generator) -> Sequence[tuple[PortableObject, Words]]:
        """Return objects inside of furniture, see `store_objects`."""
        return list(store_objects(view, self._describe_lasting(view, random), random))

    def _describe_lasting(self, view: HouseView, random: np.random.Generator) -> list[tuple[PortableObject, Words]]:
        """Return portable objects with words that identify them wherever they are."""
        found = []
        for thing in find_portable_objects(view, self.max_mass, self.max_size):
            alone = minimal_identifying_words(view.objects, thing.object, LASTING_ATTRIBUTES)
            if alone:
                found.append((thing, alone[int(random.integers(len(alone)))]))
        return found

    def _say(self, thing: PortableObject, words: Words) -> str:
        """Return the noun phrase of an object, with the furniture that it is inside of."""
        return noun_phrase(words, container=noun_phrase(_stored(thing).container_words))

    def _others(self, thing: PortableObject) -> Sequence[Selector]:
        """Return the descriptor of the furniture."""
        return (Selector.objects_with(_stored(thing).container_words),)

    def _forbid(self, thing: PortableObject) -> tuple[Condition, ...]:
        """Return the condition that the object is in its first compartment."""
        return (_stored(thing).condition,)


def _stored(thing: PortableObject) -> StoredObject:
    """Return an object of `store_objects`, by its type; `TypeError` for others."""
    if not isinstance(thing, StoredObject):
        raise TypeError(f"{thing} is in no compartment")
    return thing
