"""MuJoCo's parameters of the contacts of movable objects.

Contacts in MuJoCo are damped springs. One with damping ratio z throws back what hits it with e = exp(-pi z /
sqrt(1 - z^2)) of its speed: half a period of a free oscillator. A contact can only push, so in continuous time e would
be a little larger (Schwager and Poeschel 2007, "Coefficient of restitution and linear-dashpot model revisited"). In
steps of half the inverse frequency it is e again: over all phases of the step its mean is within 0.05, single
bounces within 0.2, and never above 1.

In a physics step of 0.01 s gravity gives 0.1 m/s, so that what bounces would never come to rest. Hence the impedance of
such contacts begins low: slightly pressed they are soft, and critically damped or more, and slow bounces die out.
"""

from typing import Any

import numpy as np

from home_mjx.mjcf.agent import SOLIMP, TIME_CONSTANT

TIP = 25.0  # [m/s^2]: width of the impedance's curve per square of the length of a physics step


def contact_numbers(ratio: Any, timestep: float, xp: Any = np) -> tuple[Any, Any, Any, Any]:
    """What decides about contacts of something: stiffness [1/s^2], damping [1/s], least impedance, and its width [m].

    Stiffness and damping, negated, are `solref` in MuJoCo's direct format. Of two movable objects the greater damping
    counts, as MuJoCo mixes them: the duller decides. Of its other format, time constant and damping ratio, it takes the
    means, and a ball would sink into a cushion. Of impedances it takes the means in any case.

    Args:
        ratio: Damping ratio, see `materials.contact.damping_ratio`; 1: it does not bounce.
        timestep: Length of a physics step [s].
        xp: `numpy` or `jax.numpy`.

    Example:
        >>> [float(x) for x in contact_numbers(np.ones(()), 0.01)]  # a time constant of 0.02 s
        [2500.0, 100.0, 0.9, 0.001]
    """
    constant = max(TIME_CONSTANT, 2 * timestep)  # as MuJoCo limits it
    rate = xp.full_like(ratio, 1 / constant)  # natural frequency; the same for all, as with damping 2 rate it is stable
    low = xp.where(ratio < 1, ratio * ratio / 2, SOLIMP[0])
    width = xp.where(ratio < 1, xp.full_like(ratio, max(TIP * timestep**2, SOLIMP[2])), SOLIMP[2])
    return rate * rate, 2 * ratio * rate, low, width
