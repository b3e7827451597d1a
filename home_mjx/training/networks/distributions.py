"""Distributions of actions by action spec; their parameters are the output of a policy."""

import math
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.errors import ConfigError
from home_mjx.tasks.base.specs import ArraySpec

HALF_LOG_TAU = 0.5 * math.log(2 * math.pi)


@runtime_checkable
class Distribution(Protocol):
    """Interface of a distribution for PPO. Leading axes of parameters and actions are free, except in `sample`."""

    @property
    def num_outputs(self) -> int:
        """Number of parameters that depend on the state, which the policy network returns; `num_scales` follow."""
        ...

    @property
    def num_scales(self) -> int:
        """Number of state-independent parameters, which follow the outputs."""
        ...

    def sample(self, params: Array, key: Array) -> Array:
        """Sample one action from parameters (p,); it is not yet clipped."""
        ...

    def mode(self, params: Array) -> Array:
        """Return the most likely action of parameters (..., p), not yet clipped; leading axes are kept."""
        ...

    def log_prob(self, params: Array, action: Array) -> Array:
        """Return the natural log of the joint probability or density of a sampled action, not yet clipped."""
        ...

    def entropy(self, params: Array) -> Array:
        """Return the entropy of actions before clipping [nats]."""
        ...

    def clip(self, action: Array) -> Array:
        """Return the valid action that the environment takes for a sampled one."""
        ...


@dataclass(frozen=True)
class Gaussian:
    """Independent normal distributions; actions beyond the limits are clipped before the environment takes them.

    Parameters are means, then logarithms of standard deviations, which do not depend on the state.

    Attributes:
        low: Minimum of each number of an action.
        high: Maximum of each number of an action.
    """

    low: tuple[float, ...]
    high: tuple[float, ...]

    @property
    def num_outputs(self) -> int:
        """Number of means."""
        return len(self.low)

    @property
    def num_scales(self) -> int:
        """Number of log standard deviations; they are clipped to -5 .. 0.5 before use."""
        return len(self.low)

    def sample(self, params: Float[Array, " p"], key: Array) -> Float[Array, " n"]:
        """Sample one action, which may exceed the limits."""
        mean, scale = self._mean_and_scale(params)
        return mean + scale * jax.random.normal(key, mean.shape)

    def mode(self, params: Float[Array, "*b p"]) -> Float[Array, "*b n"]:
        """Return the mean, which may exceed the limits."""
        return self._mean_and_scale(params)[0]

    def log_prob(self, params: Float[Array, "*b p"], action: Float[Array, "*b n"]) -> Float[Array, "*b"]:
        """Return the joint log density of an action before clipping."""
        mean, scale = self._mean_and_scale(params)
        return jnp.sum(-0.5 * ((action - mean) / scale) ** 2 - jnp.log(scale) - HALF_LOG_TAU, axis=-1)

    def entropy(self, params: Float[Array, "*b p"]) -> Float[Array, "*b"]:
        """Return the joint entropy of the action before clipping [nats]."""
        return jnp.sum(jnp.log(self._mean_and_scale(params)[1]) + HALF_LOG_TAU + 0.5, axis=-1)

    def clip(self, action: Float[Array, "*b n"]) -> Float[Array, "*b n"]:
        """Return an action clipped to `low` .. `high`."""
        return jnp.clip(action, jnp.asarray(self.low), jnp.asarray(self.high))

    def _mean_and_scale(self, params: Array) -> tuple[Array, Array]:
        """Return means, then standard deviations: exp of the last half of `params`, clipped to -5 .. 0.5 beforehand."""
        mean, log_scale = jnp.split(params, 2, axis=-1)
        return mean, jnp.exp(jnp.clip(log_scale, -5.0, 0.5))


@dataclass(frozen=True)
class Categorical:
    """One choice, or several independent ones; parameters are the logits of all choices, concatenated.

    Attributes:
        sizes: Number of options of each choice.
        is_single: An action is a number, without an axis of choices.
    """

    sizes: tuple[int, ...]
    is_single: bool = False
    num_scales: int = 0

    @property
    def num_outputs(self) -> int:
        """Number of logits, summed over choices."""
        return sum(self.sizes)

    def sample(self, params: Float[Array, " p"], key: Array) -> Array:
        """Sample one int32 option, from 0, per choice."""
        keys = jax.random.split(key, len(self.sizes))
        return self._stack_choices(
            [jax.random.categorical(k, x) for k, x in zip(keys, self._logits(params), strict=True)]
        )

    def mode(self, params: Float[Array, "*b p"]) -> Array:
        """Return the most likely option, an int32 from 0, of each choice; the first one of equals."""
        return self._stack_choices([jnp.argmax(x, axis=-1) for x in self._logits(params)])

    def log_prob(self, params: Float[Array, "*b p"], action: Array) -> Float[Array, "*b"]:
        """Return the joint log probability of an action's choices, integers from 0."""
        chosen = action[..., None] if self.is_single else action
        logits = self._logits(params)
        return sum(
            (jnp.take_along_axis(x, chosen[..., i : i + 1], axis=-1)[..., 0] for i, x in enumerate(logits)),
            start=jnp.zeros(params.shape[:-1]),
        )

    def entropy(self, params: Float[Array, "*b p"]) -> Float[Array, "*b"]:
        """Return the joint entropy of all choices [nats]."""
        each = [-jnp.sum(jnp.exp(x) * x, axis=-1) for x in self._logits(params)]
        return sum(each, start=jnp.zeros(params.shape[:-1]))

    def clip(self, action: Array) -> Array:
        """Return the action unchanged, because every choice is valid."""
        return action

    def _logits(self, params: Array) -> list[Array]:
        """Return normalised log probabilities of the options of each choice."""
        ends = [int(end) for end in np.cumsum(self.sizes)[:-1]]
        return [jax.nn.log_softmax(x) for x in jnp.split(params, ends, axis=-1)]

    def _stack_choices(self, choices: list[Array]) -> Array:
        """Stack choices along a last int32 axis, which a single one does not have."""
        joined = jnp.stack(choices, axis=-1).astype(jnp.int32)
        return joined[..., 0] if self.is_single else joined


def make_distribution(spec: ArraySpec) -> Gaussian | Categorical:
    """Return the distribution for one agent's actions: categorical for integers, Gaussian for float32 vectors.

    Raises:
        ConfigError: The spec is neither int32 from 0 of rank at most 1 nor a float32 vector.

    Example:
        >>> make_distribution(ArraySpec((), "int32", 0, 5))
        Categorical(sizes=(6,), is_single=True, num_scales=0)
    """
    low, high = spec.bounds()
    if spec.dtype == "int32" and len(spec.shape) <= 1 and not np.any(low):
        return Categorical(tuple(int(x) + 1 for x in np.atleast_1d(high)), is_single=not spec.shape)
    if spec.dtype == "float32" and len(spec.shape) == 1:
        return Gaussian(tuple(float(x) for x in low), tuple(float(x) for x in high))
    raise ConfigError(f"no distribution is known for actions {spec.dtype} {spec.shape} from {spec.low}")
