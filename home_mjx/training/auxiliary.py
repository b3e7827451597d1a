"""Auxiliary losses: predictions from the memory of what the simulator knows exactly.

The direction and the distance of a source are the same whatever it plays. A memory that predicts them has features that
hold for sounds that were never heard. Mirowski et al., "Learning to navigate in complex environments", 2017
(arXiv:1611.03673), predict depth and loop closures in the same way.
"""

from collections.abc import Iterable

import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.experts.expert_observation import ExpertObservationEnv
from home_mjx.tasks.sensors.interaural_cues import SOURCE_TARGET

NUM_SOURCE_PREDICTIONS = 3  # sine and cosine of the azimuth, log(1 + distance)
NUM_PREDICTIONS = {"none": 0, "source": NUM_SOURCE_PREDICTIONS}
TARGET_SENSORS = {"none": (), "source": (SOURCE_TARGET,)}


def add_sensors(core: HouseholdEnv, names: Iterable[str]) -> HouseholdEnv:
    """Return an environment with further sensors, and with expert actions if it had them; unchanged if it has all."""
    missing = [name for name in names if name not in (core.config.sensors or ())]
    if not missing:
        return core
    more = HouseholdEnv(core.config.replace(sensors=(*(core.config.sensors or ()), *missing)), core.task)
    more.progress = core.progress
    return ExpertObservationEnv(more, core.teaches) if isinstance(core, ExpertObservationEnv) else more


def source_loss(
    predictions: Float[Array, "*b 3"], target: Float[Array, "*b 4"]
) -> tuple[Float[Array, ""], dict[str, Array]]:
    """Return the loss of predicted directions and distances, and its metrics; steps without sound do not count.

    The loss is the mean squared error of sine and cosine of the azimuth, and of log(1 + distance / 1 m). Metrics are
    `direction`, the mean error of the azimuth [rad], and `distance`, that of the distance [m].

    Example:
        >>> exact = jnp.array([[1.0, 0.0, jnp.log(3.0)]])
        >>> loss, _ = source_loss(exact, jnp.array([[1.0, 0.0, 2.0, 1.0]]))
        >>> round(float(loss), 6)
        0.0
    """
    sounds = target[..., 3]
    count = jnp.maximum(jnp.sum(sounds), 1.0)
    wanted = jnp.concatenate([target[..., :2], jnp.log1p(target[..., 2:3])], axis=-1)
    loss = jnp.sum(sounds * jnp.sum((predictions - wanted) ** 2, axis=-1)) / count
    angle = jnp.arctan2(predictions[..., 0], predictions[..., 1]) - jnp.arctan2(target[..., 0], target[..., 1])
    apart = jnp.abs(jnp.arctan2(jnp.sin(angle), jnp.cos(angle)))
    off = jnp.abs(jnp.expm1(predictions[..., 2]) - target[..., 2])
    return loss, {"direction": jnp.sum(sounds * apart) / count, "distance": jnp.sum(sounds * off) / count}
