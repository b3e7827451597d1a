"""Material kinds, derived from the texture's name, else from transparency and the object's category."""

from home_mjx.schema.categories import texture_family
from home_mjx.schema.house import Material

# The 20 families of Planner 5D textures in HoME's paper, named as in its code.
HOME_TEXTURE_KINDS = {
    "beam": "wood",
    "bricks": "bricks",
    "carpet": "carpet",
    "decorstone": "decoration stone",
    "facing_stone": "facing stone",
    "laminate": "laminate",
    "leather": "leather",
    "linen": "linen",
    "lnm": "linoleum",
    "paneling": "wood",
    "path": "stone",
    "potang": "potang",
    "prkt": "wood",
    "solo": "wood",
    "stone": "stone",
    "stucco": "stucco",
    "textile": "textile",
    "tile": "tile",
    "wallp": "wallpaper",
    "wood": "wood",
}

# Families without a name in HoME.
TEXTURE_KINDS = HOME_TEXTURE_KINDS | {
    "concrete": "concrete",
    "flower": "plant",
    "foliage": "plant",
    "front": "stucco",
    "glass": "glass",
    "grass": "grass",
    "ground": "ground",
    "leaf": "plant",
    "leaves": "plant",
    "marble": "stone",
    "metal": "metal",
    "roof": "tile",
    "spruce": "plant",
}

# Untextured slots: the usual material of the visible surface, by coarse category.
CATEGORY_KINDS = {
    "air_conditioner": "plastic",
    "arch": "wood",
    "bathtub": "ceramic",
    "bed": "textile",
    "bench_chair": "wood",
    "books": "paper",
    "candle": "plastic",
    "ceiling": "paint",
    "chair": "wood",
    "column": "concrete",
    "computer": "plastic",
    "curtain": "textile",
    "desk": "wood",
    "door": "wood",
    "dresser": "wood",
    "dressing_table": "wood",
    "fan": "plastic",
    "fence": "metal",
    "fireplace": "stone",
    "floor": "concrete",
    "garage_door": "metal",
    "grill": "metal",
    "gym_equipment": "metal",
    "hanging_kitchen_cabinet": "wood",
    "heater": "metal",
    "household_appliance": "metal",
    "indoor_lamp": "metal",
    "kitchen_appliance": "metal",
    "kitchen_cabinet": "wood",
    "kitchen_set": "wood",
    "kitchenware": "ceramic",
    "magazines": "paper",
    "mailbox": "metal",
    "mirror": "glass",
    "music": "wood",
    "ottoman": "textile",
    "outdoor_lamp": "metal",
    "partition": "wood",
    "person": "textile",
    "pet": "textile",
    "picture_frame": "wood",
    "pillow": "textile",
    "plant": "plant",
    "roof": "tile",
    "rug": "carpet",
    "safe": "metal",
    "shelving": "wood",
    "shoes": "leather",
    "shoes_cabinet": "wood",
    "shower": "ceramic",
    "sink": "ceramic",
    "sofa": "textile",
    "stairs": "wood",
    "stand": "wood",
    "storage_bench": "wood",
    "table": "wood",
    "table_and_chair": "wood",
    "television": "plastic",
    "toilet": "ceramic",
    "toy": "plastic",
    "trash_can": "plastic",
    "tv_stand": "wood",
    "vase": "ceramic",
    "vehicle": "metal",
    "wall": "paint",
    "wardrobe_cabinet": "wood",
    "whiteboard": "plastic",
    "window": "plastic",
    "wood_board": "wood",
    "workplace": "wood",
}

MATERIAL_KINDS = tuple(sorted({*TEXTURE_KINDS.values(), *CATEGORY_KINDS.values()}))


def material_kind(material: Material, coarse: str) -> str:
    """Return the kind of a resolved material slot, one of `MATERIAL_KINDS`; "" if unknown.

    A texture name, even of a missing image, decides alone: by its family, "" for a family not in `TEXTURE_KINDS`.
    Otherwise opacity below 1 means glass, except on curtains and plants. The rest follows from the coarse category by
    `CATEGORY_KINDS`.

    Args:
        material: Material of the slot after overrides.
        coarse: Coarse category of the object, or "wall", "floor", "ceiling".
    """
    if material.texture_name:
        return TEXTURE_KINDS.get(texture_family(material.texture_name), "")
    if material.opacity is not None and material.opacity < 1 and coarse not in ("curtain", "plant"):
        return "glass"
    return CATEGORY_KINDS.get(coarse, "")
