"""Marks of the pixels of id images that an instruction names; ids and words of one language share their names.

Learning the appearance of each word from rewards takes many examples of each object, and does not generalise to unseen
pairs of words. Agents pretrained on captioned images have a similar start (such as arXiv:2203.10421). The meaning of
word combinations, and the behaviour, are still learned.
"""

import functools

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from home_mjx.raycast_render.images.render import SEMANTIC_KINDS
from home_mjx.schema.semantic import Semantic
from home_mjx.schema.vocabulary import vocabularies
from home_mjx.tasks.language.phrases import SEMANTIC_COLUMN
from home_mjx.tasks.language.vocabulary import to_word, tokenize

NO_TOKEN = -1  # token of an id without a name


@functools.cache
def name_tokens(column: Semantic) -> Int[np.ndarray, " n"]:
    """Return for each id of a vocabulary the token of the word for its name; cached, so do not change it.

    Example:
        >>> name_tokens(Semantic.SIZE).tolist() == [
        ...     tokenize(size)[0] for size in ("tiny", "small", "normal", "large", "huge")
        ... ]
        True
    """
    return np.array([tokenize(to_word(name))[0] for name in vocabularies()[column]], np.int32)


def id_column(observation: str) -> Semantic | None:
    """Return the vocabulary of an observation `ids/...` by its name; None if its ids have no names.

    Example:
        >>> id_column("ids/head_coarse"), id_column("ids/head_instance")
        (<Semantic.COARSE: 2>, None)
    """
    found = [kind for kind in SEMANTIC_KINDS if observation.startswith("ids/") and observation.endswith(f"_{kind}")]
    column = SEMANTIC_KINDS[max(found, key=len)] if found else None
    return column if column in SEMANTIC_COLUMN.values() else None


def observed_tokens(observation: str, words: Int[Array, "*b n"]) -> Int[Array, "*b n"]:
    """Return tokens of a word observation; vocabulary ids in `goal_words` become tokens of their names, -1 if none.

    Ids beyond a vocabulary count as its last one.
    """
    if observation != "goal_words":
        return words.astype(jnp.int32)
    said = jnp.full(words.shape, NO_TOKEN, jnp.int32)
    for word, column in SEMANTIC_COLUMN.items():
        tokens, number = jnp.asarray(name_tokens(column)), words[..., word].astype(jnp.int32)
        token = jnp.where(number >= 0, tokens[jnp.clip(number, 0, len(tokens) - 1)], NO_TOKEN)
        said = said.at[..., word].set(token)
    return said


def mark_named_pixels(
    ids: Int[Array, "*b h w"], column: Semantic, said: Int[Array, "*b n"]
) -> Float[Array, "*b h w 2"]:
    """Mark pixels named by a text with two channels: 1, and a weight from 1 (first word) to 1 / n (last); else 0.

    Args:
        ids: Ids of a vocabulary; -1 is a miss, as are ids beyond the vocabulary.
        column: The vocabulary.
        said: Tokens of the text.

    Example:
        >>> ids = jnp.array([[[0, 3, -1]]])  # tiny, large, a miss
        >>> said = jnp.array([tokenize("the large bed")])
        >>> mark_named_pixels(ids, Semantic.SIZE, said)[0, 0, :, 0].tolist()
        [0.0, 1.0, 0.0]
    """
    tokens = np.append(name_tokens(column), np.int32(NO_TOKEN - 1))  # a miss has a token that no text contains
    where = said[..., None, :] == jnp.asarray(tokens)[:, None]  # (*b, names, n)
    named = jnp.any(where, axis=-1).astype(jnp.float32)
    early = 1 - jnp.argmax(where, axis=-1) / said.shape[-1]
    table = jnp.stack([named, named * early], axis=-1)
    last = len(tokens) - 1
    row = jnp.where((ids >= 0) & (ids < last), ids, last).astype(jnp.int32)
    found = jnp.take_along_axis(table, row.reshape(*ids.shape[:-2], -1, 1), axis=-2)
    return found.reshape(*ids.shape, 2)
