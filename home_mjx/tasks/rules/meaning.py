"""Which instances and rooms of a house a row's descriptors mean; on the host and on the device alike."""

import functools
import operator

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.core.pytree import Pytree
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.rules.words import ANY, NUM_DESCRIPTORS, Kind, Word

# Columns of the semantic table, any of which must have the value of a word.
COLUMNS = {
    Word.FINE: (Semantic.FINE,),
    Word.COARSE: (Semantic.COARSE,),
    Word.COLOR: (Semantic.BASIC, Semantic.BASIC_2, Semantic.BASIC_3),
    Word.MATERIAL: (Semantic.MATERIAL,),
    Word.SIZE: (Semantic.SIZE,),
    Word.ROOM_TYPE: (Semantic.ROOM_TYPE,),
    Word.OBJECT_ID: (Semantic.OBJECT,),
    Word.ROOM: (Semantic.ROOM,),
}
BELOW = {Word.ON: Semantic.SUPPORTER, Word.IN: Semantic.CONTAINER}


class Means(Pytree):
    """What each of d descriptors means in a house."""

    instance: Bool[Array, "d i"]  # instances of objects
    room: Bool[Array, "d r"]


def means(bank: HouseBank, house: Int[Array, ""], descriptor: Int[Array, "d words"]) -> Means:
    """What a row's descriptors mean in a house, as the house was compiled.

    Args:
        bank: The houses.
        house: Index of the house.
        descriptor: Columns are those of `Word`.
    """
    geometry, types = bank.geometry, bank.navigation.room_type[house]
    known = geometry.instance_object[house] >= 0
    rows = jnp.where(known[:, None], bank.semantics[geometry.instance_semantic[house]], ANY)
    return Means(instance=_instances(rows, known, descriptor), room=_rooms(types, descriptor))


def _instances(
    rows: Int[Array, "i columns"], known: Bool[Array, " i"], descriptor: Int[Array, "d words"]
) -> Bool[Array, "d i"]:
    fits = known[None] & (descriptor[:, Word.KIND, None] == Kind.OBJECT)
    for word, columns in COLUMNS.items():
        value = descriptor[:, word, None]
        same = functools.reduce(operator.or_, [rows[None, :, column] == value for column in columns])
        fits = fits & ((value == ANY) | same)
    return _resting(rows, fits, descriptor)


def _resting(
    rows: Int[Array, "i columns"], fits: Bool[Array, "d i"], descriptor: Int[Array, "d words"]
) -> Bool[Array, "d i"]:
    """Those that are on or in what another descriptor means, which itself rests on nothing."""
    found = fits
    for word, column in BELOW.items():
        other = descriptor[:, word]
        carries = (rows[:, None, Semantic.OBJECT] == rows[None, :, column]) & (rows[None, :, column] != ANY)
        chosen = jnp.take(fits, jnp.clip(other, 0, NUM_DESCRIPTORS - 1), axis=0)  # what that descriptor means
        carried = jnp.any(chosen[:, :, None] & carries[None], axis=1)
        found = found & ((other[:, None] == ANY) | carried)
    return found


def _rooms(types: Int[Array, " r"], descriptor: Int[Array, "d words"]) -> Bool[Array, "d r"]:
    kind, number = descriptor[:, Word.ROOM_TYPE, None], descriptor[:, Word.ROOM, None]
    fits = (descriptor[:, Word.KIND, None] == Kind.ROOM) & (types[None] != ANY)
    fits = fits & ((kind == ANY) | (types[None] == kind))
    return fits & ((number == ANY) | (jnp.arange(types.shape[0])[None] == number))


def means_on_host(bank: HouseBank, house: int, descriptors: np.ndarray) -> Means:
    """The same of many rows at once, as NumPy arrays with a leading axis of rows."""
    room = 1 << (len(descriptors) - 1).bit_length()  # few different sizes: each is compiled
    whole = np.full((room, *descriptors.shape[1:]), ANY, np.int32)
    whole[: len(descriptors)] = descriptors
    return jax.tree.map(lambda x: np.asarray(x)[: len(descriptors)], _many(bank, jnp.int32(house), whole))


_many = jax.jit(jax.vmap(means, (None, None, 0)))  # here, so that it is compiled once for all houses
