"""Mass and contact properties of furniture: shells of their material, clipped to the mass range of the category."""

import numpy as np
from jaxtyping import Float

from home_mjx.geometry.meshes import surface_areas
from home_mjx.scene_compile.objects.placed_objects import PlacedObject
from home_mjx.schema.contact_materials import ContactProperties, contact_properties

# Mass per visible surface area [kg/m^2]: density times thickness; boards have two sides, so half their thickness.
# Densities are handbook values (particle board 700, steel 7850, glass 2500, stoneware 2400, granite 2700,
# polypropylene 910 kg/m^3); thicknesses are our estimates for typical furniture.
AREAL_DENSITY = {
    "bricks": 1900 * 0.02,
    "carpet": 2.0,
    "ceramic": 2400 * 0.006,
    "concrete": 2300 * 0.02,
    "decoration stone": 2700 * 0.01,
    "facing stone": 2700 * 0.01,
    "glass": 2500 * 0.003,
    "grass": 0.2,
    "ground": 2.0,
    "laminate": 700 * 0.009,
    "leather": 5.0,
    "linen": 4.0,
    "metal": 7850 * 0.0008,
    "paper": 3.0,
    "plant": 0.2,
    "plastic": 910 * 0.002,
    "stone": 2700 * 0.01,
    "textile": 4.0,  # cloth over 10 cm of foam of 30 kg/m^3, and a share of the frame
    "tile": 2400 * 0.006,
    "wood": 700 * 0.009,
}
DEFAULT_AREAL_DENSITY = 5.0  # [kg/m^2], default for other materials

# Minimum and maximum mass [kg] by category: our estimates from everyday furniture, since we had no dataset of masses.
MASS_RANGES = {
    "armchair": (10.0, 40.0),
    "bed": (30.0, 120.0),
    "bench_chair": (8.0, 30.0),
    "bookshelf": (20.0, 90.0),
    "chair": (3.0, 12.0),
    "coffee_table": (5.0, 35.0),
    "desk": (15.0, 60.0),
    "dining_table": (15.0, 60.0),
    "dresser": (25.0, 90.0),
    "dressing_table": (20.0, 70.0),
    "floor_lamp": (2.0, 12.0),
    "office_chair": (8.0, 20.0),
    "ottoman": (3.0, 20.0),
    "plant": (2.0, 20.0),
    "refrigerator": (40.0, 120.0),
    "shelving": (8.0, 60.0),
    "shoes_cabinet": (10.0, 40.0),
    "sofa": (30.0, 110.0),
    "stand": (4.0, 25.0),
    "storage_bench": (10.0, 35.0),
    "table": (8.0, 50.0),
    "toy": (0.3, 15.0),
    "trash_can": (0.5, 6.0),
    "tv_stand": (12.0, 60.0),
    "vase": (0.5, 10.0),
    "wardrobe_cabinet": (60.0, 250.0),
    "washer": (50.0, 80.0),
}
DEFAULT_MASS_RANGE = (0.5, 100.0)  # [kg], default for other categories


def mass_range(fine: str, coarse: str) -> tuple[float, float]:
    """Return the minimum and maximum mass [kg] of the fine category, else of the coarse one, else the default."""
    return MASS_RANGES.get(fine) or MASS_RANGES.get(coarse) or DEFAULT_MASS_RANGE


def object_mass(item: PlacedObject) -> float:
    """Return the mass of an object [kg]: areas times areal densities, clipped to the range of its category."""
    areal = [AREAL_DENSITY.get(s.kind, DEFAULT_AREAL_DENSITY) for s in item.surfaces]
    low, high = mass_range(item.info.fine, item.info.coarse)
    return float(np.clip(slot_areas(item) @ areal, low, high))


def slot_areas(item: PlacedObject) -> Float[np.ndarray, " s"]:
    """Return the area of each material slot of an object [m^2]."""
    return np.bincount(item.model.slot, surface_areas(item.triangles), minlength=len(item.slots))


def object_contact(item: PlacedObject, mass: float) -> ContactProperties:
    """Return friction and restitution; they depend on category, mass [kg] and the material of the largest area."""
    kinds = [surface.kind for surface in item.surfaces]
    names, row = np.unique(kinds, return_inverse=True)
    area = np.bincount(row, slot_areas(item))
    return contact_properties(str(names[area.argmax()]), item.info.coarse, mass)
