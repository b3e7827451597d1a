"""Learning from an expert's advice: alone (behaviour cloning, DAgger) or in addition to rewards.

Behaviour cloning on states of the expert fails after the first mistake, because the expert never visited the states
that follow. Errors then grow with the square of the episode length. If the expert is queried in states of the student,
they grow linearly. See Ross, Gordon and Bagnell, "A Reduction of Imitation Learning and Structured Prediction to
No-Regret Online Learning", 2011 (arXiv:1011.0686). The expert is a function in the compiled step, so a query is cheap.
"""

from collections.abc import Sequence
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array

from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.experts.expert_observation import EXPERT, ExpertObservationEnv
from home_mjx.training.config import PPOConfig
from home_mjx.training.networks.distributions import Distribution
from home_mjx.training.ppo import PPO, LossFunction, TrainBatch, TrainState
from home_mjx.training.rollout import Policy

ADVICE_DECAY_FRACTION = 0.7  # fraction of the run over which the weight of advice in PPO falls to 0
EXPERT_DECAY_FRACTION = 0.5  # fraction of the run over which the expert's share of the actions falls linearly from 1
# Share of expert actions until `STUDENT_ONLY_AFTER`. With less, most states are where the network is stuck.
MIN_EXPERT_SHARE = 0.3
STUDENT_ONLY_AFTER = 0.8  # fraction of the run after which only the network acts, so that its values fit its behaviour
MAX_AGREEING_DISTANCE = 0.25  # maximum distance of a continuous action from the expert's to count as the same


class AdvisedPPO(PPO):
    """PPO with an additional cloning loss on an expert's advice, because rewards alone are sparse at first.

    The loss is PPO's plus `advice_cost` times the negative log-likelihood of the expert's action. The weight falls
    linearly to 0 (kickstarting: Schmitt et al., 2018, arXiv:1803.03835; there the teacher is a network). Arguments are
    those of `PPO`.

    Raises:
        ConfigError: As in `PPO`; or the task has no expert.

    Example:
        >>> advised = AdvisedPPO(env.core, PPOConfig(num_envs=64, advice_cost=0.5))  # doctest: +SKIP
    """

    def __init__(
        self, core: HouseholdEnv, config: PPOConfig | None = None, devices: Sequence[Any] | None = None
    ) -> None:
        own = core if isinstance(core, ExpertObservationEnv) else ExpertObservationEnv(core, teaches=True)
        super().__init__(own, config, devices)

    def current_loss(self, state: TrainState) -> LossFunction:
        """Return PPO's losses plus the cloning loss; its weight falls linearly to 0 at 70 % of its updates."""
        done = (state.updates - self.first_update).astype(jnp.float32)
        left = 1 - done / (ADVICE_DECAY_FRACTION * self.config.num_updates)
        weight = self.config.advice_cost * jnp.clip(left, 0, 1)

        def loss(net: Any, batch: TrainBatch) -> tuple[Array, dict[str, Array]]:
            """Return the sum, and its parts by name."""
            params, value, further, found = self.apply_net(net, batch)
            own, parts = self.clipped_loss(params, value, batch)
            advice, told = advice_loss(self.agent.distribution, params, batch.steps.obs[EXPERT])
            return own + weight * advice + further, parts | told | found

        return loss


def advice_loss(choose: Distribution, params: Array, advice: Array) -> tuple[Array, dict[str, Array]]:
    """Return the mean negative log-likelihood of advice, and metrics.

    These are `clone`, the same, and `agreement`, the fraction of clipped modes near the advice.
    Near is every number of the action within `MAX_AGREEING_DISTANCE`, so that discrete actions must be equal.
    """
    clone_loss = -jnp.mean(choose.log_prob(params, advice))
    apart = jnp.abs(choose.clip(choose.mode(params)) - advice).reshape(*params.shape[:-1], -1)
    same = jnp.all(apart <= MAX_AGREEING_DISTANCE, axis=-1)
    return clone_loss, {"clone": clone_loss, "agreement": jnp.mean(same.astype(jnp.float32))}


class BehaviorCloning(AdvisedPPO):
    """Learn from an expert's advice alone; the value function is learned too, so that PPO can continue from it.

    Arguments and options are PPO's; `entropy_cost`, `clip_range` and `advice_cost` have no effect here. For continuous
    actions the likelihood's gradient is that of the squared error, scaled by the learned variance.

    Raises:
        ConfigError: As in `PPO`; or the task has no expert.

    Example:
        >>> cloning = BehaviorCloning(env.core, PPOConfig(num_envs=64))  # doctest: +SKIP
        >>> state = cloning.init(env.params, jax.random.key(0))  # doctest: +SKIP
        >>> state, metrics = cloning.update(env.params, state)  # doctest: +SKIP
    """

    def behavior_policy(self, state: TrainState) -> Policy:
        """Return a policy that takes its own or, per step and row with some probability, the expert's action.

        The probability falls linearly from 1 towards 0 at `EXPERT_DECAY_FRACTION` of the updates, but not below
        `MIN_EXPERT_SHARE`. From `STUDENT_ONLY_AFTER` of the updates on it is 0.
        """
        student = self.policy(state.net)
        done = (state.updates - self.first_update).astype(jnp.float32) / self.config.num_updates
        led = jnp.where(done < STUDENT_ONLY_AFTER, jnp.clip(1 - done / EXPERT_DECAY_FRACTION, MIN_EXPERT_SHARE, 1), 0.0)

        def act(memory: Array, obs: dict[str, Array], begins: Array, keys: Array) -> tuple[Array, Array, dict]:
            """Act as the student, or in some rows as the expert."""
            memory, action, outputs = student.act(memory, obs, begins, keys)
            draw = jax.vmap(lambda key: jax.random.uniform(jax.random.fold_in(key, 1)))(keys)
            leads = (draw < led).reshape(-1, *[1] * (action.ndim - 1))
            return memory, jnp.where(leads, obs[EXPERT], action), outputs

        return student._replace(act=act)

    def current_loss(self, state: TrainState) -> LossFunction:
        """Return `loss`, which does not depend on the state."""
        return self.loss

    def loss(self, net: Any, batch: TrainBatch) -> tuple[Array, dict[str, Array]]:
        """Return the negative log-likelihood of the expert's actions plus weighted value error; and parts by name."""
        params, value, further, told = self.apply_net(net, batch)
        clone_loss, parts = advice_loss(self.agent.distribution, params, batch.steps.obs[EXPERT])
        value_loss = 0.5 * jnp.mean((value - batch.target) ** 2)
        return clone_loss + self.config.value_cost * value_loss + further, parts | told | {"value": value_loss}
