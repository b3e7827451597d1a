"""The agent: encoder, recurrent core, and heads for actions and value."""

import functools
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import flax.linen as nn
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from home_mjx.core.checks import check_flag, check_known, check_number, check_type
from home_mjx.errors import ConfigError
from home_mjx.tasks.base.specs import ArraySpec
from home_mjx.training.networks.distributions import Distribution, make_distribution
from home_mjx.training.networks.encoders import Encoder, encoder_kind
from home_mjx.training.networks.text_encoders import NO_ENCODER, TOKEN_OBSERVATIONS, word_table

DTYPES = ("float32", "bfloat16")
PREDICTIONS, FOUND = "predictions", "found"  # names of the auxiliary head and of its outputs
INITIAL_LOG_SCALE = -0.5  # log std of continuous actions in [-1, 1]: a std of 0.6


@dataclass(frozen=True)
class NetworkConfig:
    """Sizes of an agent's network.

    Attributes:
        features: Size of the encoder's output.
        memory: Size of the GRU's state.
        channels: Channels of the image encoder's blocks.
        dtype: Type of image convolutions: "float32" or "bfloat16". Everything else is float32.
        goal_mask: Mark pixels of id images that the instruction names, see `mark_named_pixels`, and attend to them, see
            `QueryAttention`. If False, the network has to learn each word.
        layer_norm: Apply layer normalisation (arXiv:1607.06450) to the encoder's features, and feed them to the heads
            in addition to the memory. If False, features of many images grow until the GRU's gates saturate.
        text_encoder: Name of a user's embeddings of words, see `register_text_encoder`; "": the network learns them.

    Raises:
        ConfigError: A value is invalid.
    """

    features: int = 256
    memory: int = 512
    channels: tuple[int, ...] = (32, 64, 128)
    dtype: str = "float32"
    goal_mask: bool = True
    layer_norm: bool = True
    text_encoder: str = NO_ENCODER

    def __post_init__(self) -> None:
        check_known("dtype", [self.dtype], DTYPES)
        check_flag("network.goal_mask", self.goal_mask)
        check_flag("network.layer_norm", self.layer_norm)
        check_type("network.text_encoder", self.text_encoder, str)
        for name, value in (("features", self.features), ("memory", self.memory)):
            check_number(f"network.{name}", value, 1, integer=True)
        if not isinstance(self.channels, tuple) or not self.channels:
            raise ConfigError(f"`network.channels` must be a tuple of numbers, got {self.channels!r}")
        for value in self.channels:
            check_number("network.channels", value, 1, integer=True)


class Memory(nn.Module):
    """GRU over time (arXiv:1406.1078) whose state is reset at the start of an episode."""

    features: int

    @functools.partial(nn.scan, variable_broadcast="params", split_rngs={"params": False})
    @nn.compact
    def __call__(self, memory: Array, inputs: tuple[Array, Array]) -> tuple[Array, Array]:
        """Apply the GRU to T steps of `inputs`: features (T, N, f) and resets (T, N); return last and all memories."""
        x, begins = inputs
        return nn.GRUCell(self.features)(jnp.where(begins[:, None], 0.0, memory), x)


class RecurrentAgent(nn.Module):
    """Recurrent policy and value function.

    Attributes:
        specs: Name and spec of every observation of one agent.
        distribution: Distribution of actions.
        config: Sizes of the network.
        num_predictions: Number of outputs of the auxiliary head, which reads the memory; 0: it has none.

    Example:
        >>> agent = RecurrentAgent.from_specs(core.observation_spec, core.action_spec)  # doctest: +SKIP
        >>> net, memory = agent.init_net(jax.random.key(0)), agent.initial_memory(64)  # doctest: +SKIP
        >>> memory, params, value = agent.unroll_step(net, memory, obs, begins)  # doctest: +SKIP
    """

    specs: tuple[tuple[str, ArraySpec], ...]
    distribution: Any  # a `Distribution`
    config: NetworkConfig = field(default_factory=NetworkConfig)
    num_predictions: int = 0

    @classmethod
    def from_specs(
        cls,
        observations: Mapping[str, ArraySpec],
        action: ArraySpec,
        config: NetworkConfig | None = None,
        num_predictions: int = 0,
    ) -> "RecurrentAgent":
        """Build the agent for observations and actions, both of one agent.

        Observations of the kind `none`, see `encoder_kind`, are left out.

        Raises:
            ConfigError: No observation can be encoded, or the action spec has no distribution; or none has words for
                the text encoder, or its embeddings are invalid.
            UnknownNameError: The text encoder is not registered.
        """
        specs = tuple((name, spec) for name, spec in sorted(observations.items()) if encoder_kind(name, spec) != "none")
        if not specs:
            raise ConfigError("the agent would observe nothing", hint="Pass sensors=, such as state, goal or depth.")
        if config is not None and config.text_encoder != NO_ENCODER:
            _check_text_encoder(config.text_encoder, [name for name, _ in specs])
        return cls(specs, make_distribution(action), config or NetworkConfig(), num_predictions)

    @nn.compact
    def __call__(
        self, memory: Float[Array, "n m"], obs: dict[str, Array], begins: Bool[Array, "t n"]
    ) -> tuple[Float[Array, "n m"], Float[Array, "t n p"], Float[Array, "t n"]]:
        """Apply the network to T steps of N agents.

        Args:
            memory: Memory before the first step.
            obs: Observations (T, N, ...).
            begins: True at an episode's first observation, where the memory is reset.

        Returns:
            The memory after the last step, parameters of the distribution, and values.
        """
        dtype = jnp.dtype(self.config.dtype)
        sizes = self.config.features, self.config.channels
        seen = Encoder(self.specs, *sizes, dtype, self.config.goal_mask, self.config.text_encoder)(obs)
        seen = nn.LayerNorm()(seen) if self.config.layer_norm else seen
        memory, x = Memory(self.config.memory)(memory, (seen, begins))
        if self.num_predictions:
            self.sow("intermediates", FOUND, nn.Dense(self.num_predictions, name=PREDICTIONS)(x))
        x = jnp.concatenate([x, seen], axis=-1) if self.config.layer_norm else x
        value = nn.Dense(1, kernel_init=nn.initializers.orthogonal(1.0), name="value")
        return memory, self._policy(x), value(x)[..., 0]

    def unroll(
        self, net: Any, memory: Float[Array, "n m"], obs: dict[str, Array], begins: Bool[Array, "t n"]
    ) -> tuple[Float[Array, "n m"], Float[Array, "t n p"], Float[Array, "t n"]]:
        """Apply the network with parameters `net` to T steps; return last memory, distribution parameters, values.

        The memory is reset before each step for which `begins` is True; see `__call__`.
        """
        applied: Any = self.apply(net, memory, obs, begins)
        return applied

    def unroll_with_predictions(
        self, net: Any, memory: Float[Array, "n m"], obs: dict[str, Array], begins: Bool[Array, "t n"]
    ) -> tuple[Float[Array, "t n p"], Float[Array, "t n"], Float[Array, "t n q"]]:
        """Return distribution parameters, values, and the outputs of the auxiliary head, as `unroll`."""
        applied: Any = self.apply(net, memory, obs, begins, mutable="intermediates")
        (_, params, value), found = applied
        return params, value, found["intermediates"][FOUND][0]

    def unroll_step(
        self, net: Any, memory: Float[Array, "n m"], obs: dict[str, Array], begins: Bool[Array, " n"]
    ) -> tuple[Float[Array, "n m"], Float[Array, "n p"], Float[Array, " n"]]:
        """Apply `unroll` to a single step, without an axis of time in arguments and results."""
        memory, params, value = self.unroll(net, memory, jax.tree.map(lambda x: x[None], obs), begins[None])
        return memory, params[0], value[0]

    def initial_memory(self, num: int) -> Float[Array, "n m"]:
        """Return the zero memory of `num` agents before their first step."""
        return jnp.zeros((num, self.config.memory), jnp.float32)

    def init_net(self, key: Array) -> Any:
        """Return fresh random parameters of the network, for `unroll`."""
        obs = {name: jnp.zeros((1, 1, *spec.shape), spec.dtype) for name, spec in self.specs}
        return jax.jit(self.init)(key, self.initial_memory(1), obs, jnp.ones((1, 1), bool))

    def _policy(self, x: Array) -> Array:
        """Return distribution parameters from features: outputs of a layer, then state-independent scales."""
        distribution: Distribution = self.distribution
        small = nn.initializers.orthogonal(0.01)  # nearly uniform action probabilities at first
        outputs = nn.Dense(distribution.num_outputs, kernel_init=small, name="policy")(x)
        if not distribution.num_scales:
            return outputs
        scales = self.param("log_scale", nn.initializers.constant(INITIAL_LOG_SCALE), (distribution.num_scales,))
        return jnp.concatenate([outputs, jnp.broadcast_to(scales, (*x.shape[:-1], distribution.num_scales))], axis=-1)


def _check_text_encoder(name: str, observations: list[str]) -> None:
    """Raise `ConfigError` if no observation has words, and as `word_table` does."""
    if not set(observations) & set(TOKEN_OBSERVATIONS):
        hint = f"Add one of {', '.join(TOKEN_OBSERVATIONS)} to `sensors`."
        raise ConfigError("no observation has words for `text_encoder`", element="text_encoder", hint=hint)
    word_table(name)
