"""Agents by name, for libraries that give and take dictionaries, and their observations as one vector."""

import warnings
from collections.abc import Mapping
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array

from home_mjx.errors import ConfigError
from home_mjx.tasks.base.specs import ArraySpec, Specs


def agent_names(num_agents: int) -> list[str]:
    """The names that PettingZoo and JaxMARL use.

    Example:
        >>> agent_names(2)
        ['agent_0', 'agent_1']
    """
    return [f"agent_{i}" for i in range(num_agents)]


def by_agent(tree: Any, names: list[str]) -> dict[str, Any]:
    """One tree per agent, of arrays whose leading axis is of agents if there are several.

    Example:
        >>> by_agent({"state": jnp.arange(2)}, ["agent_0", "agent_1"])["agent_1"]["state"].item()
        1
    """
    if len(names) == 1:
        return {names[0]: tree}
    return {name: jax.tree.map(lambda x, i=i: x[i, ...], tree) for i, name in enumerate(names)}


def of_agents(values: Mapping[str, Any], names: list[str]) -> list[Any]:
    """The values in the order of the agents.

    Raises:
        ConfigError: One is missing, or there is one of an unknown agent.
    """
    if set(values) != set(names):
        raise ConfigError(f"expected one action each of {', '.join(names)}; got {', '.join(values) or 'none'}")
    return [values[name] for name in names]


def vector_names(specs: Specs) -> tuple[str, ...]:
    """Observations of one agent that can be joined to a vector: those of float32 with one axis, images apart."""
    return tuple(name for name, spec in specs.items() if len(spec.shape) == 1 and spec.dtype == "float32")


def joined(obs: Mapping[str, Array], names: tuple[str, ...]) -> Array:
    """Observations one after the other; also of a batch."""
    return jnp.concatenate([obs[name] for name in names], axis=-1)


def joined_spec(specs: Specs) -> ArraySpec:
    """The vector of all that `vector_names` names.

    Warns:
        UserWarning: Something is left out: images, and words, whose numbers are no quantities.

    Raises:
        ConfigError: There is none.

    Example:
        >>> joined_spec({"state": ArraySpec((2,), low=0.0, high=1.0), "goal": ArraySpec((1,))}).low
        (0.0, 0.0, -inf)
    """
    names = vector_names(specs)
    if not names:
        hint = "Add `state` to sensors=, or ask for all observations with vector=False."
        raise ConfigError(f"no vector can be made of {', '.join(specs) or 'nothing'}", hint=hint)
    if others := [name for name in specs if name not in names]:
        lost = f"the vector of observations is without {', '.join(others)}, which are no vectors of float32"
        warnings.warn(f"{lost}; vector=False gives them, by name", stacklevel=3)
    low, high = (sum((tuple(specs[name].bounds()[i].tolist()) for name in names), ()) for i in (0, 1))
    return ArraySpec((len(low),), "float32", low, high, ", ".join(names))
