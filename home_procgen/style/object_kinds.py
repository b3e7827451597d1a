"""Kinds of objects that recipes ask for: model families, or subsets of a family with the same purpose."""

from collections.abc import Mapping

from home_procgen.model_store import family_numbers, get_model
from home_procgen.primitives.family import FurnitureModel

# Kind -> family and model numbers.
_KINDS: Mapping[str, tuple[str, str]] = {
    "bar_stool": ("stool", "1 2 3 4"),
    "low_stool": ("stool", "5"),
    "corner_sofa": ("sofa", "11"),
    "plain_sofa": ("sofa", "1 2 3 4 5 6 7 8 9 10 12 13"),
    "corner_desk": ("desk", "5"),
    "corner_wardrobe": ("wardrobe", "6"),
    "corner_shelf": ("shelving", "4"),
    "corner_bathtub": ("bathtub", "4"),
    "corner_wall_cabinet": ("hanging_cabinet", "5"),
    "corner_tv_stand": ("tv_stand", "5"),
    "corner_toilet": ("toilet", "9"),
    "plain_toilet": ("toilet", "1 2 3 4 6 7 8 10"),
    "bidet": ("toilet", "5"),
    "two_seater": ("sofa", "3 5 7 8 10 12"),
    "garden_chair": ("outdoor_seating", "1 2 7"),
    "garden_bench": ("outdoor_seating", "3 8"),
    "lounger": ("outdoor_seating", "4"),
    "swing": ("outdoor_seating", "5"),
    "picnic_table": ("outdoor_seating", "6"),
    "plain_desk": ("desk", "1 2 3 4 6 7 8 9 10 11 12 13 14"),
    "small_desk": ("desk", "2 4 8 10 12 13"),
    "plain_wardrobe": ("wardrobe", "1 2 3 4 5 7 8 9 11 12 13"),
    "glass_cabinet": ("wardrobe", "10"),
    "low_tv_stand": ("tv_stand", "1 2 4 6 7 8 9 10 11 12"),
    "flat_screen": ("television", "1 2 4 5 6"),
    "toy_shelf": ("bookshelf", "4 9 11"),
    "wall_shelf": ("shelving", "1 7 8 11"),
    "plate_shelf": ("shelving", "12"),
    "rack": ("shelving", "2 3 10"),
    "open_shelf": ("shelving", "3 9"),
    "pegboard": ("shelving", "5"),
    "wine_rack": ("shelving", "6"),
    "coat_stand": ("hanger", "1 2 6 7 8"),
    "clothes_rail": ("hanger", "3"),
    "coat_hooks": ("hanger", "4 5 9 10 11"),
    "bar_cart": ("cart", "1 2"),
    "trolley": ("cart", "3"),
    "base_cabinet": ("kitchen_cabinet", "1 2 3 4 5 6 9 10 11 12"),
    "wide_cabinet": ("kitchen_cabinet", "2 6 10 12"),
    "narrow_cabinet": ("kitchen_cabinet", "5 9"),
    "island": ("kitchen_cabinet", "7"),
    "pantry": ("kitchen_cabinet", "8"),
    "wall_cabinet": ("hanging_cabinet", "1 2 3 4 6 7 8 9 10 11 12 14"),
    "door_cabinet": ("hanging_cabinet", "1 2 3 6 7 8 9 10"),
    "end_shelf": ("hanging_cabinet", "13"),
    "stove": ("cooker", "1 2 4 5 6 7 8 9 10 11"),
    "wide_fridge": ("refrigerator", "2 4"),
    "fridge": ("refrigerator", "1 2 3 4 7 8 9 11"),
    "slim_fridge": ("refrigerator", "1 3 7 8 10"),
    "small_fridge": ("refrigerator", "5 6"),
    "knife_block": ("knife_rack", "1 2"),
    "knife_rail": ("knife_rack", "3"),
    "utensil_jar": ("utensil_holder", "1 3"),
    "utensil_rail": ("utensil_holder", "2"),
    "small_basin": ("basin", "1 5"),
    "vanity": ("basin", "2 3 4 6"),
    "plain_bathtub": ("bathtub", "1 2 3 6 7 8 9 10 11"),
    "hot_tub": ("bathtub", "5"),
    "towel_rail": ("towel_rack", "1 2 5 6 7 8 10"),
    "towel_stand": ("towel_rack", "3 4 9"),
    "ironing_board": ("ironing_board", "1 3"),
    "microphone": ("microphone", "1 2"),
    "water_dispenser": ("water_dispenser", "1 2"),
    "paper_holder": ("toilet_paper", "1 4 5 6 7 8"),
    "paper_stand": ("toilet_paper", "2 3 9 10"),
    "wall_toiletries": ("toiletries", "4"),
    "set_toiletries": ("toiletries", "1 2 3"),
    "standing_mirror": ("mirror", "8"),
    "wall_mirror": ("mirror", "1 2 3 4 5 9 10 11"),
    "tall_mirror": ("mirror", "5 10"),
    "bath_mirror": ("mirror", "1 2 3 6 7 11"),
    "indoor_wall_lamp": ("wall_lamp", "1 2 3 4 5 6 8 10 11"),
    "round_lamp": ("wall_lamp", "1 2 3 6 8 11"),
    "wall_cooler": ("air_conditioner", "1"),
    "standing_cooler": ("air_conditioner", "2 3"),
    "floor_fan": ("stand_fan", "1 3"),
    "table_fan": ("stand_fan", "2"),
    "long_curtain": ("curtain", "1 2 3 9 10 11 13"),
    "cafe_curtain": ("curtain", "4"),
    "short_curtain": ("curtain", "4 5 6 7 8 12"),
    "large_rug": ("rug", "1 2 3 4 5 9"),
    "round_rug": ("rug", "3 4 8"),
    "runner": ("rug", "6 7"),
    "floor_vase": ("vase", "7"),
    "table_vase": ("vase", "1 2 3 4 5 6 8 9 10 11 12"),
    "slim_plant": ("plant", "2 3 6 7 9"),
    "magazine_rack": ("magazines", "2"),
    "magazine": ("magazines", "1 3"),
    "radio": ("speaker", "3 4 5 6 7"),
    "soundbar": ("speaker", "2"),
    "box_speaker": ("speaker", "1"),
    "desk_lamp": ("table_lamp", "8 9 12"),
    "bedside_lamp": ("table_lamp", "1 2 3 4 5 6 7 10 11"),
    "floor_basket": ("basket", "1 2 5 6 7 8"),
    "log_basket": ("basket", "3"),
    "umbrella_stand": ("basket", "4"),
    "paper_bin": ("trash_can", "2 3 7"),
    "kitchen_bin": ("trash_can", "1 4 5 8 9 10"),
    "garage_bin": ("trash_can", "5 6"),
    "upright_piano": ("piano", "1"),
    "garden_lamp": ("outdoor_lamp", "3 4"),
    "bunk": ("bunker_bed", "1 2 3"),
    "stove_fire": ("fireplace", "3 5 6"),
    "low_hood": ("range_hood", "1 2 3 4 5 6 7 8 9 10"),
    "hood": ("range_hood", "11 12 13 14 15 16 17 18 19 20"),
    "high_hood": ("range_hood", "21 22 23 24 25 26 27 28 29 30"),
    "mantel": ("fireplace", "1 2 4"),
    "spice_rack": ("containers", "3"),
    "small_gym": ("gym", "3 5 6 10"),
    "wall_whiteboard": ("whiteboard", "1 2 3"),
    "pool_table": ("game_table", "1 2 3"),
    "toy_animal": ("toy", "1 11"),
    "floor_toy": ("toy", "1 2 3 4 5 6 7 8 9 10 11"),
}


def resolve_kind(kind: str) -> tuple[str, tuple[int, ...]]:
    """Return the family of a kind and its model numbers; a family's own name selects all; `KeyError` for other names.

    Example:
        >>> resolve_kind("low_stool")
        ('stool', (5,))
    """
    if kind not in _KINDS:
        return kind, tuple(family_numbers(kind))
    family, numbers = _KINDS[kind]
    return family, tuple(map(int, numbers.split()))


def list_models(kind: str) -> list[FurnitureModel]:
    """Return the models of a kind in ascending order of footprint.

    Example:
        >>> [model.id for model in list_models("low_stool")]
        ['home_stool_5']
    """
    family, numbers = resolve_kind(kind)
    return sorted((get_model(family, n) for n in numbers), key=lambda model: float(model.size[0] * model.size[2]))
