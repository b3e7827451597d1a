"""Fine class -> coarse class, NYU40 class and WordNet synset, paired as in SUNCG's ModelCategoryMapping.csv."""

from home_procgen.v1.categories import CATEGORIES as BEFORE
from home_procgen.v1.categories import Category

# fine: coarse, NYU40, WordNet 3.0 offset, key
_ROWS = """
air_conditioner: air_conditioner, otherprop, n02686379, air_conditioner.n.01
arch: arch, door, n02733524, arch.n.04
baby_bed: bed, bed, n02766320, baby_bed.n.01
basketball_hoop: recreation, otherprop, n02802215, basket.n.03
bicycle: vehicle, otherprop, n02834778, bicycle.n.01
book: books, otherprop, n02870526, book.n.11
books: books, books, n02870526, book.n.11
bottle: kitchenware, otherprop, n02876657, bottle.n.01
bread: kitchenware, otherprop, n07679356, bread.n.01
bunker_bed: bed, bed, n02818832, bed.n.01
cake: kitchenware, otherprop, n02937469, cake.n.01
candle: candle, lamp, n02948072, candle.n.01
car: vehicle, otherprop, n02958343, car.n.01
cart: cart, otherfurniture, n03484083, handcart.n.01
ceiling_fan: fan, otherprop, n03320046, fan.n.01
cellphone: household_appliance, otherprop, n02992529, cellular_telephone.n.01
chessboard: toy, otherprop, n03014317, chessboard.n.01
clock: clock, otherprop, n03046257, clock.n.01
cloth: cloth, clothes, n03309808, fabric.n.01
coffee_kettle: kitchenware, otherprop, n03612814, kettle.n.01
coffee_machine: kitchen_appliance, otherprop, n03063338, coffee_maker.n.01
column: column, wall, n03074380, column.n.06
computer: computer, television, n03082979, computer.n.01
containers: kitchenware, otherprop, n03094503, container.n.01
cup: kitchenware, otherprop, n03797390, mug.n.04
curtain: curtain, curtain, n03151077, curtain.n.01
cutting_board: kitchenware, otherprop, n03025513, chopping_board.n.01
decoration: decoration, otherprop, n03169390, decoration.n.01
dishwasher: kitchen_appliance, otherprop, n03207941, dishwasher.n.01
dressing_table: dressing_table, desk, n03238586, dressing_table.n.01
drumset: music, otherprop, n03249569, drum.n.01
dryer: household_appliance, otherprop, n03251766, dryer.n.01
fireplace: fireplace, otherstructure, n03346455, fireplace.n.01
fish_tank: toy, otherprop, n02732072, aquarium.n.01
fishbowl: toy, otherprop, n03350204, fishbowl.n.02
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
knife_rack: kitchenware, otherprop, n03621377, kitchenware.n.01
ladder: household_appliance, otherprop, n03632277, ladder.n.01
lawn_mower: household_appliance, otherprop, n03649909, lawn_mower.n.01
magazines: magazines, otherprop, -, -
mailbox: mailbox, otherprop, n03710193, mailbox.n.01
microphone: music, otherprop, n03759954, microphone.n.01
mortar_and_pestle: kitchenware, otherprop, -, -
motorcycle: vehicle, otherprop, n03790512, motorcycle.n.01
outdoor_lamp: outdoor_lamp, lamp, n03636649, lamp.n.02
outdoor_seating: outdoor_seating, chair, n04161981, seat.n.03
pan: kitchenware, otherprop, n03880531, pan.n.01
partition: partition, otherstructure, n03894379, partition.n.01
pedestal_fan: fan, otherprop, n03320046, fan.n.01
pet: pet, otherprop, n01318894, pet.n.01
piano: music, otherprop, n03928116, piano.n.01
pillow: pillow, pillow, n03938244, pillow.n.01
place_setting: kitchenware, otherprop, n03953743, place_setting.n.01
plant: plant, otherprop, n00017222, plant.n.02
plates: kitchenware, otherprop, n03959485, plate.n.04
playstation: toy, otherprop, n03964744, plaything.n.01
pool: pool, otherprop, n03982060, pool.n.01
safe: safe, cabinet, n04125021, safe.n.01
shoes: shoes, picture, n04199027, shoe.n.01
soap_dish: bathroom_stuff, otherprop, n04254009, soap_dish.n.01
soap_dispenser: bathroom_stuff, otherprop, n04254120, soap_dispenser.n.01
stationary_container: household_appliance, otherprop, n03528263, home_appliance.n.01
stereo_set: music, otherprop, n04315948, stereo.n.01
storage_bench: storage_bench, chair, n02828884, bench.n.01
switch: switch, picture, n04372370, switch.n.01
table: table, table, n04379243, table.n.02
teapot: kitchenware, otherprop, n04398044, teapot.n.01
telephone: household_appliance, otherprop, n04401088, telephone.n.01
toaster: kitchen_appliance, otherprop, n04442312, toaster.n.02
toilet_paper: bathroom_stuff, otherprop, n15075141, toilet_tissue.n.01
toilet_plunger: bathroom_stuff, otherprop, n03970156, plunger.n.03
toiletries: bathroom_stuff, otherprop, n04447443, toiletry.n.01
towel_hanger: bathroom_stuff, otherprop, n03490884, hanger.n.02
towel_rack: bathroom_stuff, otherprop, n04459773, towel_rack.n.01
toy: toy, otherprop, n03964744, plaything.n.01
tricycle: toy, otherprop, n04482393, tricycle.n.01
trinket: trinket, otherprop, n02787435, bangle.n.02
tripod: tripod, otherprop, n04485082, tripod.n.01
umbrella: outdoor_cover, otherprop, n04507155, umbrella.n.01
utensil_holder: kitchenware, otherprop, n03525454, holder.n.01
vacuum_cleaner: household_appliance, otherprop, n04517823, vacuum.n.04
wall_lamp: indoor_lamp, lamp, n03636649, lamp.n.02
water_dispenser: kitchen_appliance, otherprop, n03210683, dispenser.n.01
weight_scale: household_appliance, otherprop, n04141975, scale.n.07
whiteboard: whiteboard, whiteboard, n03211616, display_panel.n.01
wood_board: wood_board, otherprop, n15101854, board.n.02
workplace: workplace, desk, -, -
xbox: toy, otherprop, n03964744, plaything.n.01
"""


def _category(row: str) -> tuple[str, Category]:
    fine, rest = row.split(": ")
    coarse, nyu40, offset, key = rest.split(", ")
    return fine, Category(coarse, nyu40, (offset, key))


CATEGORIES: dict[str, Category] = BEFORE | dict(map(_category, _ROWS.strip().splitlines()))
