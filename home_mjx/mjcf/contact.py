"""MuJoCo parameters of the contacts of movable objects.

Contacts in MuJoCo are damped springs. In half a period of a free oscillator, a damping ratio z results in the
restitution e = exp(-pi z / sqrt(1 - z^2)). A contact can only push, so in continuous time e would be slightly larger
(Schwager and Poeschel 2007, "Coefficient of restitution and linear-dashpot model revisited"). With steps of half the
inverse frequency it is e again: averaged over all phases of the step within 0.05, single bounces within 0.2, never
above 1.

In a physics step of 0.01 s gravity adds 0.1 m/s, so that a bouncing object would never come to rest. Therefore the
impedance of such contacts begins low: at small penetration they are soft and at least critically damped, so that slow
bounces decay.
"""

from typing import Any

import numpy as np

from home_mjx.mjcf.agent import SOLIMP, TIME_CONSTANT

IMPEDANCE_WIDTH_RATE = 25.0  # [m/s^2], width of the impedance transition per squared length of a physics step


def contact_parameters(ratio: Any, timestep: float, xp: Any = np) -> tuple[Any, Any, Any, Any]:
    """Return contact parameters: stiffness [1/s^2], damping [1/s], minimum impedance and transition width [m].

    Stiffness and damping, negated, are `solref` in MuJoCo's direct format. For a contact of two movable objects, MuJoCo
    mixes these by maximum damping, so the object with less restitution dominates. In its other format (time constant
    and damping ratio), it would take the means, and a ball would sink into a cushion. Impedances are always averaged.

    Args:
        ratio: Damping ratio, see `sound_materials.in_contact.damping_ratio`; 1: no restitution.
        timestep: Length of a physics step [s].
        xp: `numpy` or `jax.numpy`.

    Example:
        >>> [float(x) for x in contact_parameters(np.ones(()), 0.01)]  # a time constant of 0.02 s
        [2500.0, 100.0, 0.9, 0.001]
    """
    constant = max(TIME_CONSTANT, 2 * timestep)  # the minimum that MuJoCo allows
    rate = xp.full_like(ratio, 1 / constant)  # natural frequency; equal for all ratios, stable up to damping 2 rate
    low = xp.where(ratio < 1, ratio * ratio / 2, SOLIMP[0])
    width = xp.where(ratio < 1, xp.full_like(ratio, max(IMPEDANCE_WIDTH_RATE * timestep**2, SOLIMP[2])), SOLIMP[2])
    return rate * rate, 2 * ratio * rate, low, width
