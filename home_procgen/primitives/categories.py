"""Fine class -> coarse class, NYU40 class and WordNet synset, paired as in SUNCG's ModelCategoryMapping.csv."""

from typing import NamedTuple

# fine: coarse, NYU40, WordNet 3.0 offset, key
_ROWS = """
air_conditioner: air_conditioner, otherprop, n02686379, air_conditioner.n.01
arch: arch, door, n02733524, arch.n.04
armchair: chair, chair, n02738535, armchair.n.01
baby_bed: bed, bed, n02766320, baby_bed.n.01
basketball_hoop: recreation, otherprop, n02802215, basket.n.03
bathtub: bathtub, bathtub, n02808440, bathtub.n.01
bench_chair: bench_chair, chair, n02828884, bench.n.01
bicycle: vehicle, otherprop, n02834778, bicycle.n.01
book: books, otherprop, n02870526, book.n.11
books: books, books, n02870526, book.n.11
bookshelf: shelving, bookshelf, n02871439, bookshelf.n.01
bottle: kitchenware, otherprop, n02876657, bottle.n.01
bread: kitchenware, otherprop, n07679356, bread.n.01
bunker_bed: bed, bed, n02818832, bed.n.01
cake: kitchenware, otherprop, n02937469, cake.n.01
candle: candle, lamp, n02948072, candle.n.01
car: vehicle, otherprop, n02958343, car.n.01
cart: cart, otherfurniture, n03484083, handcart.n.01
ceiling_fan: fan, otherprop, n03320046, fan.n.01
cellphone: household_appliance, otherprop, n02992529, cellular_telephone.n.01
chair: chair, chair, n03001627, chair.n.01
chandelier: indoor_lamp, lamp, n03005285, chandelier.n.01
chessboard: toy, otherprop, n03014317, chessboard.n.01
clock: clock, otherprop, n03046257, clock.n.01
cloth: cloth, clothes, n03309808, fabric.n.01
coffee_kettle: kitchenware, otherprop, n03612814, kettle.n.01
coffee_machine: kitchen_appliance, otherprop, n03063338, coffee_maker.n.01
coffee_table: table, table, n03063968, coffee_table.n.01
column: column, wall, n03074380, column.n.06
computer: computer, television, n03082979, computer.n.01
containers: kitchenware, otherprop, n03094503, container.n.01
cup: kitchenware, otherprop, n03797390, mug.n.04
curtain: curtain, curtain, n03151077, curtain.n.01
cutting_board: kitchenware, otherprop, n03025513, chopping_board.n.01
decoration: decoration, otherprop, n03169390, decoration.n.01
desk: desk, desk, n03179701, desk.n.01
dining_table: table, table, n04379243, table.n.02
dishwasher: kitchen_appliance, otherprop, n03207941, dishwasher.n.01
door: door, door, n03221720, door.n.01
double_bed: bed, bed, n03225988, double_bed.n.01
dresser: dresser, dresser, n03015254, chest_of_drawers.n.01
dressing_table: dressing_table, desk, n03238586, dressing_table.n.01
drumset: music, otherprop, n03249569, drum.n.01
dryer: household_appliance, otherprop, n03251766, dryer.n.01
fence: fence, otherstructure, n02788148, bannister.n.02
fireplace: fireplace, otherstructure, n03346455, fireplace.n.01
fish_tank: toy, otherprop, n02732072, aquarium.n.01
fishbowl: toy, otherprop, n03350204, fishbowl.n.02
floor_lamp: indoor_lamp, lamp, n03367059, floor_lamp.n.01
food: kitchenware, otherprop, n00021265, food.n.01
food_processor: kitchen_appliance, otherprop, n03378174, food_processor.n.01
fruit_bowl: kitchenware, otherprop, n02880940, bowl.n.03
game_table: recreation, otherprop, n04379243, table.n.02
garage_door: garage_door, door, -, -
glass: kitchenware, otherprop, n03438257, glass.n.02
grill: grill, otherprop, n03459591, grill.n.02
guitar: music, otherprop, n03467517, guitar.n.01
gym_equipment: gym_equipment, otherprop, n04285146, sports_equipment.n.01
hair_dryer: bathroom_stuff, otherprop, n03483316, hand_blower.n.01
hanger: hanger, cabinet, n03405725, furniture.n.01
hanging_kitchen_cabinet: hanging_kitchen_cabinet, counter, n02933112, cabinet.n.01
headphones_on_stand: household_appliance, otherprop, n03528263, home_appliance.n.01
heater: heater, otherprop, n03508101, heater.n.01
helmet: household_appliance, otherprop, n03513137, helmet.n.02
household_appliance: household_appliance, otherprop, n03528263, home_appliance.n.01
ipad: household_appliance, otherprop, n03528263, home_appliance.n.01
iron: household_appliance, otherprop, n03584829, iron.n.04
ironing_board: household_appliance, otherprop, n03586090, ironing_board.n.01
jug: kitchenware, otherprop, n03603722, jug.n.01
kettle: kitchenware, otherprop, n03612814, kettle.n.01
keyboard: music, otherprop, n03085013, computer_keyboard.n.01
kitchen_cabinet: kitchen_cabinet, counter, n02933112, cabinet.n.01
knife_rack: kitchenware, otherprop, n03621377, kitchenware.n.01
ladder: household_appliance, otherprop, n03632277, ladder.n.01
laptop: computer, television, n03642806, laptop.n.01
lawn_mower: household_appliance, otherprop, n03649909, lawn_mower.n.01
loudspeaker: music, otherprop, n03691459, loudspeaker.n.01
magazines: magazines, otherprop, -, -
mailbox: mailbox, otherprop, n03710193, mailbox.n.01
microphone: music, otherprop, n03759954, microphone.n.01
microwave: kitchen_appliance, otherprop, n03761084, microwave.n.02
mirror: mirror, mirror, n03773035, mirror.n.01
mortar_and_pestle: kitchenware, otherprop, -, -
motorcycle: vehicle, otherprop, n03790512, motorcycle.n.01
office_chair: chair, chair, n04373894, swivel_chair.n.01
ottoman: ottoman, otherprop, n03380724, footstool.n.01
outdoor_lamp: outdoor_lamp, lamp, n03636649, lamp.n.02
outdoor_seating: outdoor_seating, chair, n04161981, seat.n.03
pan: kitchenware, otherprop, n03880531, pan.n.01
partition: partition, otherstructure, n03894379, partition.n.01
pedestal_fan: fan, otherprop, n03320046, fan.n.01
pet: pet, otherprop, n01318894, pet.n.01
piano: music, otherprop, n03928116, piano.n.01
picture_frame: picture_frame, picture, n03931765, picture_frame.n.01
pillow: pillow, pillow, n03938244, pillow.n.01
place_setting: kitchenware, otherprop, n03953743, place_setting.n.01
plant: plant, otherprop, n00017222, plant.n.02
plates: kitchenware, otherprop, n03959485, plate.n.04
playstation: toy, otherprop, n03964744, plaything.n.01
pool: pool, otherprop, n03982060, pool.n.01
range_hood: kitchen_appliance, otherprop, n02729837, appliance.n.02
range_oven: kitchen_appliance, otherprop, n02729837, appliance.n.02
refrigerator: kitchen_appliance, refridgerator, n04070727, refrigerator.n.01
rug: rug, floor_mat, n04118021, rug.n.01
safe: safe, cabinet, n04125021, safe.n.01
shelving: shelving, shelves, n04190052, shelf.n.01
shoes: shoes, picture, n04199027, shoe.n.01
shoes_cabinet: shoes_cabinet, cabinet, n02933112, cabinet.n.01
shower: shower, shower_curtain, n04208936, shower.n.01
single_bed: bed, bed, n02818832, bed.n.01
sink: sink, sink, n04223580, sink.n.01
soap_dish: bathroom_stuff, otherprop, n04254009, soap_dish.n.01
soap_dispenser: bathroom_stuff, otherprop, n04254120, soap_dispenser.n.01
sofa: sofa, sofa, n04256520, sofa.n.01
stairs: stairs, otherstructure, n04298308, stairway.n.01
stand: stand, night_stand, n03405725, furniture.n.01
stationary_container: household_appliance, otherprop, n03528263, home_appliance.n.01
stereo_set: music, otherprop, n04315948, stereo.n.01
storage_bench: storage_bench, chair, n02828884, bench.n.01
switch: switch, picture, n04372370, switch.n.01
table: table, table, n04379243, table.n.02
table_lamp: indoor_lamp, lamp, n04380533, table_lamp.n.01
teapot: kitchenware, otherprop, n04398044, teapot.n.01
telephone: household_appliance, otherprop, n04401088, telephone.n.01
television: television, television, n04405907, television_receiver.n.01
toaster: kitchen_appliance, otherprop, n04442312, toaster.n.02
toilet: toilet, toilet, n04446276, toilet.n.01
toilet_paper: bathroom_stuff, otherprop, n15075141, toilet_tissue.n.01
toilet_plunger: bathroom_stuff, otherprop, n03970156, plunger.n.03
toiletries: bathroom_stuff, otherprop, n04447443, toiletry.n.01
towel_hanger: bathroom_stuff, otherprop, n03490884, hanger.n.02
towel_rack: bathroom_stuff, otherprop, n04459773, towel_rack.n.01
toy: toy, otherprop, n03964744, plaything.n.01
trash_can: trash_can, otherprop, n02946921, can.n.01
tricycle: toy, otherprop, n04482393, tricycle.n.01
trinket: trinket, otherprop, n02787435, bangle.n.02
tripod: tripod, otherprop, n04485082, tripod.n.01
tv_stand: tv_stand, cabinet, n03405725, furniture.n.01
umbrella: outdoor_cover, otherprop, n04507155, umbrella.n.01
utensil_holder: kitchenware, otherprop, n03525454, holder.n.01
vacuum_cleaner: household_appliance, otherprop, n04517823, vacuum.n.04
vase: vase, otherprop, n04522168, vase.n.01
wall_lamp: indoor_lamp, lamp, n03636649, lamp.n.02
wardrobe_cabinet: wardrobe_cabinet, cabinet, n02933112, cabinet.n.01
washer: household_appliance, otherprop, n04554684, washer.n.03
water_dispenser: kitchen_appliance, otherprop, n03210683, dispenser.n.01
weight_scale: household_appliance, otherprop, n04141975, scale.n.07
whiteboard: whiteboard, whiteboard, n03211616, display_panel.n.01
window: window, window, n04587648, window.n.01
wood_board: wood_board, otherprop, n15101854, board.n.02
workplace: workplace, desk, -, -
xbox: toy, otherprop, n03964744, plaything.n.01
"""


class Category(NamedTuple):
    """Classes of one kind of model."""

    coarse: str
    nyu40: str
    synset: tuple[str, str]  # WordNet 3.0 offset and key


def _category(row: str) -> tuple[str, Category]:
    fine, rest = row.split(": ")
    coarse, nyu40, offset, key = rest.split(", ")
    return fine, Category(coarse, nyu40, (offset, key))


CATEGORIES: dict[str, Category] = dict(map(_category, _ROWS.strip().splitlines()))
