"""Contact properties by kind of material: sliding friction and restitution."""

import math
from typing import NamedTuple


class ContactProperties(NamedTuple):
    """Contact properties of a movable object."""

    friction: float  # coefficient of sliding (Coulomb) friction
    restitution: float  # ratio of the speeds after and before an impact


DEFAULT_CONTACT = ContactProperties(0.4, 0.2)  # default for materials without an entry

# Friction: sliding, dry, on wood or stone, after tables of handbooks (wood 0.2 to 0.5, metal on wood 0.2 to 0.6,
# leather on wood 0.3 to 0.5, brick on wood 0.6, rubber on concrete 0.7); glass and glaze are taken as smoother.
# Restitution: half the value of solid balls on a hard floor, since furniture is hollow and jointed (wood 0.6, steel
# 0.6, glass 0.66, hard plastic 0.69: The Physics Factbook). Soft materials do not bounce. The rounding is ours.
CONTACT_BY_KIND = {
    "bricks": ContactProperties(0.6, 0.2),
    "carpet": ContactProperties(0.6, 0.0),
    "ceramic": ContactProperties(0.35, 0.3),
    "concrete": ContactProperties(0.6, 0.2),
    "decoration stone": ContactProperties(0.5, 0.2),
    "facing stone": ContactProperties(0.5, 0.2),
    "glass": ContactProperties(0.3, 0.3),
    "grass": ContactProperties(0.6, 0.0),
    "ground": ContactProperties(0.6, 0.0),
    "laminate": ContactProperties(0.35, 0.3),
    "leather": ContactProperties(0.5, 0.1),
    "linen": ContactProperties(0.5, 0.0),
    "linoleum": ContactProperties(0.5, 0.2),
    "metal": ContactProperties(0.3, 0.3),
    "paper": ContactProperties(0.4, 0.0),
    "plant": ContactProperties(0.5, 0.1),
    "plastic": ContactProperties(0.35, 0.35),
    "stone": ContactProperties(0.5, 0.2),
    "textile": ContactProperties(0.5, 0.0),
    "tile": ContactProperties(0.35, 0.3),
    "wallpaper": ContactProperties(0.4, 0.0),
    "wood": ContactProperties(0.4, 0.3),
}
# Coarse categories whose contact material differs from their surface: furniture has wooden feet, toys are of rubber.
ON_WOODEN_FEET = ("bed", "bench_chair", "chair", "ottoman", "sofa", "storage_bench")
RUBBER_CONTACT = ContactProperties(0.7, 0.6)
MAX_BOUNCING_MASS = 5.0  # [kg], maximum mass with restitution; the joints of heavier objects absorb impacts


def contact_properties(kind: str, coarse: str, mass: float) -> ContactProperties:
    """Return the friction and restitution of an object.

    Args:
        kind: Kind of material with the largest surface, one of `MATERIAL_KINDS`; other names have `DEFAULT_CONTACT`.
        coarse: Coarse category, which overrides `kind`: a toy is of rubber, `ON_WOODEN_FEET` have the friction of wood.
        mass: Mass [kg]; above `MAX_BOUNCING_MASS` the restitution is 0.

    Example:
        >>> contact_properties("glass", "vase", 1.0), contact_properties("textile", "sofa", 40.0)
        (ContactProperties(friction=0.3, restitution=0.3), ContactProperties(friction=0.4, restitution=0.0))
    """
    own = RUBBER_CONTACT if coarse == "toy" else CONTACT_BY_KIND.get(kind, DEFAULT_CONTACT)
    friction = CONTACT_BY_KIND["wood"].friction if coarse in ON_WOODEN_FEET else own.friction
    return ContactProperties(friction, own.restitution if mass <= MAX_BOUNCING_MASS else 0.0)


def damping_ratio(restitution: float) -> float:
    """Return the damping ratio z of a contact with restitution e = exp(-pi z / sqrt(1 - z^2)).

    Args:
        restitution: Restitution e, in [0, 1); 0 and below result in 1 (critical damping).

    Example:
        >>> damping_ratio(0.0), round(damping_ratio(0.5), 3)
        (1.0, 0.215)
    """
    if restitution <= 0:
        return 1.0
    return 1 / math.hypot(1.0, math.pi / math.log(restitution))
