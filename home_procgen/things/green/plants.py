"""Families of all plants."""

from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.green.flowering_plants import cactus, flowers, orchid, succulents
from home_procgen.things.green.foliage_plants import monstera, palm, rosette, snake, tree
from home_procgen.things.green.topiary_plants import bamboo, bonsai, herbs, topiary
from home_procgen.things.green.trailing_plants import hanging, trailing

PLANTS = (
    design(rosette), design(snake), design(tree), design(palm), design(monstera), design(topiary), design(bamboo),
    design(trailing), design(tree, kind="square", height=1.3, leaves=48, size=0.28, stems=3),
    design(rosette, kind="stand", count=34, long=0.6, wide=0.03, rise=1.4, droop=2.0),
    design(rosette, kind="urn", count=16, long=0.75, wide=0.14, radius=0.18, droop=1.0),
    design(palm, kind="basket", fronds=9, height=0.5),
)  # fmt: skip

SMALL_PLANTS = (
    design(cactus), design(succulents), design(orchid), design(flowers), design(herbs), design(bonsai),
    design(cactus, arms=0, kind="round"), design(rosette, kind="round", count=18, long=0.22, wide=0.05, radius=0.07),
    design(snake, count=7, kind="clay"), design(flowers, kind="clay", count=9),
)  # fmt: skip


FAMILIES = (
    FurnitureFamily("plant", "plant", PLANTS),
    FurnitureFamily("small_plant", "plant", SMALL_PLANTS),
    FurnitureFamily("hanging_plant", "plant", (design(hanging), design(hanging, kind="basket"))),
)
