"""Dictionaries by agent name, and observations of one agent as one vector."""

import warnings
from collections.abc import Mapping
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array

from home_mjx.errors import ConfigError
from home_mjx.tasks.base.specs import ArraySpec, Specs


def agent_names(num_agents: int) -> list[str]:
    """Return the agent names of PettingZoo and JaxMARL.

    Example:
        >>> agent_names(2)
        ['agent_0', 'agent_1']
    """
    return [f"agent_{i}" for i in range(num_agents)]


def split_by_agent(tree: Any, names: list[str]) -> dict[str, Any]:
    """Split a tree into one tree per agent: with several, arrays lose their leading agent axis; one gets `tree` itself.

    Example:
        >>> split_by_agent({"state": jnp.arange(2)}, ["agent_0", "agent_1"])["agent_1"]["state"].item()
        1
    """
    if len(names) == 1:
        return {names[0]: tree}
    return {name: jax.tree.map(lambda x, i=i: x[i, ...], tree) for i, name in enumerate(names)}


def ordered_values(values: Mapping[str, Any], names: list[str]) -> list[Any]:
    """Return the values by agent name in the order of `names`.

    Raises:
        ConfigError: A value is missing, or belongs to an unknown agent.
    """
    if set(values) != set(names):
        raise ConfigError(f"expected one action each of {', '.join(names)}; got {', '.join(values) or 'none'}")
    return [values[name] for name in names]


def vector_observations(specs: Specs) -> tuple[str, ...]:
    """Return the names of the observations of one agent that can be joined to a vector: float32 with one axis."""
    return tuple(name for name, spec in specs.items() if len(spec.shape) == 1 and spec.dtype == "float32")


def join_vectors(obs: Mapping[str, Array], names: tuple[str, ...]) -> Array:
    """Concatenate the observations `names`, in this order, along the last axis, and ignore others; batches too."""
    return jnp.concatenate([obs[name] for name in names], axis=-1)


def vector_spec(specs: Specs) -> ArraySpec:
    """Return the spec, with bounds per element, of all `vector_observations` of one agent joined to a vector.

    Warns:
        UserWarning: Observations are omitted: images, and words, whose ids are not quantities.

    Raises:
        ConfigError: No observation can be joined.

    Example:
        >>> vector_spec({"state": ArraySpec((2,), low=0.0, high=1.0), "goal": ArraySpec((1,))}).low
        (0.0, 0.0, -inf)
    """
    names = vector_observations(specs)
    if not names:
        hint = "Add `state` to sensors=, or get all observations with vector=False."
        raise ConfigError(f"no vector observation among: {', '.join(specs) or 'none'}", hint=hint)
    if others := [name for name in specs if name not in names]:
        lost = f"the observation vector omits {', '.join(others)}, which are not float32 vectors"
        warnings.warn(f"{lost}; vector=False returns them by name", stacklevel=3)
    low, high = (sum((tuple(specs[name].bounds()[i].tolist()) for name in names), ()) for i in (0, 1))
    return ArraySpec((len(low),), "float32", low, high, ", ".join(names))
