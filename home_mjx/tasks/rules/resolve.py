"""Resolution of a row's descriptors to instances and rooms of a house; on the device and, batched, from the host."""

import functools
import operator

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.core.pytree import Pytree
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.rules.enums import ANY, NUM_DESCRIPTORS, Attribute, TargetKind

# Columns of the semantic table by word; an object matches if any of them has the word's value. Room types are bits.
SEMANTIC_COLUMNS = {
    Attribute.FINE: (Semantic.FINE,),
    Attribute.COARSE: (Semantic.COARSE,),
    Attribute.COLOR: (Semantic.COLOR, Semantic.COLOR_2, Semantic.COLOR_3),
    Attribute.MATERIAL: (Semantic.MATERIAL,),
    Attribute.SIZE: (Semantic.SIZE,),
    Attribute.OBJECT_ID: (Semantic.OBJECT_ID,),
    Attribute.ROOM: (Semantic.ROOM,),
}
SUPPORT_COLUMNS = {Attribute.ON: Semantic.SUPPORTER, Attribute.IN: Semantic.CONTAINER}


class ResolvedTargets(Pytree):
    """Resolved targets of d descriptors in a house."""

    instance: Bool[Array, "d i"]  # target instances of objects
    room: Bool[Array, "d r"]  # target rooms


def resolve_targets(bank: HouseBank, house: Int[Array, ""], descriptor: Int[Array, "d words"]) -> ResolvedTargets:
    """Resolve descriptors, rows with the columns of `Attribute`, to masks of the house's instances and rooms.

    Relations such as ON are those of the compiled house, not of the present poses.
    """
    geometry, labels = bank.geometry, bank.navigation.room_labels[house]
    known = geometry.instance_object[house] >= 0
    rows = jnp.where(known[:, None], bank.semantics[geometry.instance_semantic[house]], ANY)
    return ResolvedTargets(instance=_match_instances(rows, known, descriptor), room=_match_rooms(labels, descriptor))


def _match_instances(
    rows: Int[Array, "i columns"], known: Bool[Array, " i"], descriptor: Int[Array, "d words"]
) -> Bool[Array, "d i"]:
    """Return which instances of objects have all values of each descriptor of kind OBJECT; False for other kinds."""
    fits = known[None] & (descriptor[:, Attribute.KIND, None] == TargetKind.OBJECT)
    for word, columns in SEMANTIC_COLUMNS.items():
        value = descriptor[:, word, None]
        same = functools.reduce(operator.or_, [rows[None, :, column] == value for column in columns])
        fits = fits & ((value == ANY) | same)
    kind = descriptor[:, Attribute.ROOM_TYPE, None]
    fits = fits & ((kind == ANY) | _has_label(rows[None, :, Semantic.ROOM_LABELS], kind))
    return _filter_supported(rows, fits, descriptor)


def _filter_supported(
    rows: Int[Array, "i columns"], fits: Bool[Array, "d i"], descriptor: Int[Array, "d words"]
) -> Bool[Array, "d i"]:
    """Keep the instances that are on or in a target of another descriptor.

    That descriptor's own words `ON` and `IN` are ignored: relations are not nested.
    """
    found = fits
    for word, column in SUPPORT_COLUMNS.items():
        other = descriptor[:, word]
        carries = (rows[:, None, Semantic.OBJECT_ID] == rows[None, :, column]) & (rows[None, :, column] != ANY)
        chosen = jnp.take(fits, jnp.clip(other, 0, NUM_DESCRIPTORS - 1), axis=0)  # targets of that descriptor
        carried = jnp.matmul(chosen.astype(jnp.float32), carries.astype(jnp.float32)) > 0  # sums of 0 and 1
        found = found & ((other[:, None] == ANY) | carried)
    return found


def _has_label(labels: Int[Array, "..."], kind: Int[Array, "..."]) -> Bool[Array, "..."]:
    """Return whether bit masks of `schema.categories.room_labels` have label number `kind`; 0 and -1 have none.

    A negative `kind` counts as 0.
    """
    return (labels > 0) & ((labels >> jnp.maximum(kind, 0)) & 1 == 1)


def _match_rooms(labels: Int[Array, " r"], descriptor: Int[Array, "d words"]) -> Bool[Array, "d r"]:
    """Return which rooms have all values of each descriptor of kind ROOM; False for others, and where `labels` is 0."""
    kind, number = descriptor[:, Attribute.ROOM_TYPE, None], descriptor[:, Attribute.ROOM, None]
    fits = (descriptor[:, Attribute.KIND, None] == TargetKind.ROOM) & (labels[None] > 0)
    fits = fits & ((kind == ANY) | _has_label(labels[None], kind))
    return fits & ((number == ANY) | (jnp.arange(labels.shape[0])[None] == number))


def resolve_targets_on_host(bank: HouseBank, house: int, descriptors: np.ndarray) -> ResolvedTargets:
    """Resolve the descriptors of many rows (t, d, words) of one house; NumPy masks with a leading axis of rows."""
    room = 1 << (len(descriptors) - 1).bit_length()  # a power of two, as every size is compiled separately
    whole = np.full((room, *descriptors.shape[1:]), ANY, np.int32)
    whole[: len(descriptors)] = descriptors
    return jax.tree.map(lambda x: np.asarray(x)[: len(descriptors)], _resolve_many(bank, jnp.int32(house), whole))


_resolve_many = jax.jit(
    jax.vmap(resolve_targets, (None, None, 0))
)  # at module level, so that it is compiled once for all houses
