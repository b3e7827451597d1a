"""Contact properties by kind of material: sliding friction and restitution."""

import math
from typing import NamedTuple


class Contact(NamedTuple):
    """Contact properties of a movable object."""

    friction: float  # coefficient of sliding (Coulomb) friction
    restitution: float  # ratio of the speeds after and before an impact


USUAL = Contact(0.4, 0.2)  # default for materials without an entry

# Friction: sliding, dry, on wood or stone, after tables of handbooks (wood 0.2 to 0.5, metal on wood 0.2 to 0.6,
# leather on wood 0.3 to 0.5, brick on wood 0.6, rubber on concrete 0.7); glass and glaze are taken as smoother.
# Restitution: half the value of solid balls on a hard floor, since furniture is hollow and jointed (wood 0.6, steel
# 0.6, glass 0.66, hard plastic 0.69: The Physics Factbook). Soft materials do not bounce. The rounding is ours.
CONTACTS = {
    "bricks": Contact(0.6, 0.2),
    "carpet": Contact(0.6, 0.0),
    "ceramic": Contact(0.35, 0.3),
    "concrete": Contact(0.6, 0.2),
    "decoration stone": Contact(0.5, 0.2),
    "facing stone": Contact(0.5, 0.2),
    "glass": Contact(0.3, 0.3),
    "grass": Contact(0.6, 0.0),
    "ground": Contact(0.6, 0.0),
    "laminate": Contact(0.35, 0.3),
    "leather": Contact(0.5, 0.1),
    "linen": Contact(0.5, 0.0),
    "linoleum": Contact(0.5, 0.2),
    "metal": Contact(0.3, 0.3),
    "paper": Contact(0.4, 0.0),
    "plant": Contact(0.5, 0.1),
    "plastic": Contact(0.35, 0.35),
    "stone": Contact(0.5, 0.2),
    "textile": Contact(0.5, 0.0),
    "tile": Contact(0.35, 0.3),
    "wallpaper": Contact(0.4, 0.0),
    "wood": Contact(0.4, 0.3),
}
# Coarse categories whose contact material differs from their surface: furniture has wooden feet, toys are of rubber.
ON_WOODEN_FEET = ("bed", "bench_chair", "chair", "ottoman", "sofa", "storage_bench")
RUBBER = Contact(0.7, 0.6)
HEAVY = 5.0  # [kg], maximum mass with restitution; the joints of heavier objects absorb impacts


def contact_of(kind: str, coarse: str, mass: float) -> Contact:
    """Return the friction and restitution of an object.

    Args:
        kind: Kind of material with the largest surface, one of `MATERIAL_KINDS`, or "".
        coarse: Coarse category.
        mass: Mass [kg].

    Example:
        >>> contact_of("glass", "vase", 1.0), contact_of("textile", "sofa", 40.0)
        (Contact(friction=0.3, restitution=0.3), Contact(friction=0.4, restitution=0.0))
    """
    own = RUBBER if coarse == "toy" else CONTACTS.get(kind, USUAL)
    friction = CONTACTS["wood"].friction if coarse in ON_WOODEN_FEET else own.friction
    return Contact(friction, own.restitution if mass <= HEAVY else 0.0)


def damping_ratio(restitution: float) -> float:
    """Return the damping ratio z of a contact with restitution e = exp(-pi z / sqrt(1 - z^2)), see `mjcf.contact`.

    Args:
        restitution: Restitution e, in [0, 1).

    Example:
        >>> damping_ratio(0.0), round(damping_ratio(0.5), 3)
        (1.0, 0.215)
    """
    if restitution <= 0:
        return 1.0
    return 1 / math.hypot(1.0, math.pi / math.log(restitution))
