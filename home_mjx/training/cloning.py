"""An expert's advice: alone (behaviour cloning, DAgger), or beside rewards.

Cloning what an expert does where the expert gets to goes wrong at the first mistake, which leads to where the expert
has never been: errors grow with the square of an episode's length. Asked for advice at every state of the student's
own way, they grow linearly: Ross, Gordon and Bagnell, "A Reduction of Imitation Learning and Structured Prediction to
No-Regret Online Learning", 2011 (arXiv:1011.0686). Here the expert is a function in the compiled step: advice is free.
"""

from collections.abc import Sequence
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array

from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.experts.teacher import EXPERT, WithExpert
from home_mjx.training.config import PPOConfig
from home_mjx.training.networks.distributions import Distribution
from home_mjx.training.ppo import PPO, Batch, Loss, TrainState
from home_mjx.training.rollout import Policy

ADVISED = 0.7  # part of the run in which PPO is advised
LED = 0.5  # part of the run in which the expert acts ever less often, at first always
LEAST = 0.3  # share of the actions that stay the expert's for long: else all that is seen is where the network is stuck
ALONE = 0.8  # part of the run after which it acts alone: the value, with which PPO may go on, is then of its own ways
AGREES = 0.25  # farthest that a continuous action may be from the expert's to count as the same


class Advised(PPO):
    """PPO that an expert advises wherever it gets to, less and less: rewards alone are silent for long.

    The loss is PPO's, plus how unlikely the network finds what the expert would do, times `advice_cost`, which falls
    linearly to nothing (kickstarting: Schmitt et al., 2018, arXiv:1803.03835; there the teacher is a network).

    Args:
        core: The environment's functions.
        config: Options.
        devices: Where to train; all of JAX's by default.

    Raises:
        ConfigError: As of `PPO`; or no expert is known for the task.

    Example:
        >>> advised = Advised(env.core, PPOConfig(num_envs=64, advice_cost=0.5))  # doctest: +SKIP
    """

    def __init__(
        self, core: HouseholdEnv, config: PPOConfig | None = None, devices: Sequence[Any] | None = None
    ) -> None:
        super().__init__(core if isinstance(core, WithExpert) else WithExpert(core), config, devices)

    def loss_now(self, state: TrainState) -> Loss:
        """PPO's loss, and the advice at the weight that it has by now."""
        left = 1 - state.updates.astype(jnp.float32) / (ADVISED * self.config.num_updates)
        weight = self.config.advice_cost * jnp.clip(left, 0, 1)

        def loss(net: Any, batch: Batch) -> tuple[Array, dict[str, Array]]:
            params, value = self.read(net, batch)
            own, parts = self.clipped_loss(params, value, batch)
            advice, told = told_apart(self.agent.distribution, params, batch.steps.obs[EXPERT])
            return own + weight * advice, parts | told

        return loss


def told_apart(choose: Distribution, params: Array, advice: Array) -> tuple[Array, dict[str, Array]]:
    """How unlikely advice is, and the part of it that is what the network would most likely do."""
    clone_loss = -jnp.mean(choose.log_prob(params, advice))
    apart = jnp.abs(choose.clip(choose.mode(params)) - advice).reshape(*params.shape[:-1], -1)
    same = jnp.all(apart <= AGREES, axis=-1)
    return clone_loss, {"clone": clone_loss, "agreement": jnp.mean(same.astype(jnp.float32))}


class Cloning(Advised):
    """Learns from an expert's advice; what PPO needs besides, the value, is learned too, so that PPO can go on.

    Options are PPO's; `entropy_cost`, `clip_range` and `advice_cost` mean nothing here. Of continuous actions the
    likelihood's gradient is that of the squared error, scaled by the spread that is learned.

    Args:
        core: The environment's functions.
        config: Options.
        devices: Where to train; all of JAX's by default.

    Raises:
        ConfigError: As of `PPO`; or no expert is known for the task.

    Example:
        >>> cloning = Cloning(env.core, PPOConfig(num_envs=64))  # doctest: +SKIP
        >>> state = cloning.init(env.params, jax.random.key(0))  # doctest: +SKIP
        >>> state, metrics = cloning.update(env.params, state)  # doctest: +SKIP
    """

    def behaviour(self, state: TrainState) -> Policy:
        """The expert, at first always, then less and less often, at last never; else the network."""
        student = self.policy(state.net)
        done = state.updates.astype(jnp.float32) / self.config.num_updates
        led = jnp.where(done < ALONE, jnp.clip(1 - done / LED, LEAST, 1), 0.0)

        def act(memory: Array, obs: dict[str, Array], begins: Array, keys: Array) -> tuple[Array, Array, dict]:
            memory, action, outputs = student.act(memory, obs, begins, keys)
            draw = jax.vmap(lambda key: jax.random.uniform(jax.random.fold_in(key, 1)))(keys)
            leads = (draw < led).reshape(-1, *[1] * (action.ndim - 1))
            return memory, jnp.where(leads, obs[EXPERT], action), outputs

        return student._replace(act=act)

    def loss_now(self, state: TrainState) -> Loss:
        """The same at every time."""
        return self.loss

    def loss(self, net: Any, batch: Batch) -> tuple[Array, dict[str, Array]]:
        """How unlikely the network finds the expert's actions, and the value's error."""
        params, value = self.read(net, batch)
        clone_loss, parts = told_apart(self.agent.distribution, params, batch.steps.obs[EXPERT])
        value_loss = 0.5 * jnp.mean((value - batch.target) ** 2)
        return clone_loss + self.config.value_cost * value_loss, parts | {"value": value_loss}
