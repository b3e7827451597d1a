"""How an object slides and bounces."""

import numpy as np

from home_mjx.scene_compile.materials.contact import Contact, contact_of
from home_mjx.scene_compile.objects.masses import slot_areas
from home_mjx.scene_compile.objects.place import PlacedObject


def object_contact(item: PlacedObject, mass: float) -> Contact:
    """Friction and restitution of an object of this mass [kg]: those of the material that covers most of it."""
    kinds = [surface.kind for surface in item.surfaces]
    names, row = np.unique(kinds, return_inverse=True)
    area = np.bincount(row, slot_areas(item))
    return contact_of(str(names[area.argmax()]), item.info.coarse, mass)
