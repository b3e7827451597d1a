"""Fine class -> coarse class, NYU40 class and WordNet synset, as SUNCG's ModelCategoryMapping.csv pairs them."""

from typing import NamedTuple


class Category(NamedTuple):
    """The classes of one kind of model."""

    coarse: str
    nyu40: str
    synset: tuple[str, str]  # WordNet 3.0 offset and key


_FURNITURE = ("n03405725", "furniture.n.01")
_CABINET = ("n02933112", "cabinet.n.01")
_APPLIANCE = ("n02729837", "appliance.n.02")
_TABLE = ("n04379243", "table.n.02")

CATEGORIES: dict[str, Category] = {
    "armchair": Category("chair", "chair", ("n02738535", "armchair.n.01")),
    "bathtub": Category("bathtub", "bathtub", ("n02808440", "bathtub.n.01")),
    "bench_chair": Category("bench_chair", "chair", ("n02828884", "bench.n.01")),
    "bookshelf": Category("shelving", "bookshelf", ("n02871439", "bookshelf.n.01")),
    "chair": Category("chair", "chair", ("n03001627", "chair.n.01")),
    "chandelier": Category("indoor_lamp", "lamp", ("n03005285", "chandelier.n.01")),
    "coffee_table": Category("table", "table", ("n03063968", "coffee_table.n.01")),
    "desk": Category("desk", "desk", ("n03179701", "desk.n.01")),
    "dining_table": Category("table", "table", _TABLE),
    "door": Category("door", "door", ("n03221720", "door.n.01")),
    "double_bed": Category("bed", "bed", ("n03225988", "double_bed.n.01")),
    "dresser": Category("dresser", "dresser", ("n03015254", "chest_of_drawers.n.01")),
    "fence": Category("fence", "otherstructure", ("n02788148", "bannister.n.02")),
    "floor_lamp": Category("indoor_lamp", "lamp", ("n03367059", "floor_lamp.n.01")),
    "hanger": Category("hanger", "cabinet", _FURNITURE),
    "hanging_kitchen_cabinet": Category("hanging_kitchen_cabinet", "counter", _CABINET),
    "kitchen_cabinet": Category("kitchen_cabinet", "counter", _CABINET),
    "laptop": Category("computer", "television", ("n03642806", "laptop.n.01")),
    "loudspeaker": Category("music", "otherprop", ("n03691459", "loudspeaker.n.01")),
    "microwave": Category("kitchen_appliance", "otherprop", ("n03761084", "microwave.n.02")),
    "mirror": Category("mirror", "mirror", ("n03773035", "mirror.n.01")),
    "office_chair": Category("chair", "chair", ("n04373894", "swivel_chair.n.01")),
    "ottoman": Category("ottoman", "otherprop", ("n03380724", "footstool.n.01")),
    "picture_frame": Category("picture_frame", "picture", ("n03931765", "picture_frame.n.01")),
    "range_hood": Category("kitchen_appliance", "otherprop", _APPLIANCE),
    "range_oven": Category("kitchen_appliance", "otherprop", _APPLIANCE),
    "refrigerator": Category("kitchen_appliance", "refridgerator", ("n04070727", "refrigerator.n.01")),
    "rug": Category("rug", "floor_mat", ("n04118021", "rug.n.01")),
    "shelving": Category("shelving", "shelves", ("n04190052", "shelf.n.01")),
    "shoes_cabinet": Category("shoes_cabinet", "cabinet", _CABINET),
    "shower": Category("shower", "shower_curtain", ("n04208936", "shower.n.01")),
    "single_bed": Category("bed", "bed", ("n02818832", "bed.n.01")),
    "sink": Category("sink", "sink", ("n04223580", "sink.n.01")),
    "sofa": Category("sofa", "sofa", ("n04256520", "sofa.n.01")),
    "stairs": Category("stairs", "otherstructure", ("n04298308", "stairway.n.01")),
    "stand": Category("stand", "night_stand", _FURNITURE),
    "table_lamp": Category("indoor_lamp", "lamp", ("n04380533", "table_lamp.n.01")),
    "television": Category("television", "television", ("n04405907", "television_receiver.n.01")),
    "toilet": Category("toilet", "toilet", ("n04446276", "toilet.n.01")),
    "trash_can": Category("trash_can", "otherprop", ("n02946921", "can.n.01")),
    "tv_stand": Category("tv_stand", "cabinet", _FURNITURE),
    "vase": Category("vase", "otherprop", ("n04522168", "vase.n.01")),
    "wardrobe_cabinet": Category("wardrobe_cabinet", "cabinet", _CABINET),
    "washer": Category("household_appliance", "otherprop", ("n04554684", "washer.n.03")),
    "window": Category("window", "window", ("n04587648", "window.n.01")),
}
