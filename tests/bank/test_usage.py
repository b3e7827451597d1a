import dataclasses
from operator import attrgetter

import jax
from handmade import Furniture, shoebox, two_rooms

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records import declarations
from home_mjx.bank.usage import bank_bytes, bank_usage, planned_bytes

STOOL, DESK = Furniture((1.0, 0.5), mass=4.0), Furniture((-1.5, -1.0), category="desk")


def test_usage_adds_up_to_the_bank():
    """What is left is what rounds concatenated tables up: at most a quarter of them, and small tables' least size."""
    first = shoebox(furniture=[STOOL, DESK])
    houses = [dataclasses.replace(first, id="a"), two_rooms(), shoebox((7.0, 5.0, 3.0), furniture=[DESK])]
    taken = bank_usage(houses)
    bank = HouseBank.from_compiled(houses)
    total = sum(leaf.nbytes for leaf in jax.tree.leaves(bank))
    counted = taken.textures + sum(taken.models.values()) + sum(taken.houses.values())
    assert counted < total < 1.25 * counted + 64 * 1024
    assert taken.textures == bank.materials.textures.nbytes + bank.geometry.cutout.nbytes


def test_models_are_counted_once():
    house = shoebox(furniture=[STOOL] * 4)
    assert len(bank_usage([house]).models) == 2  # the agent and the stool
    one, two = (bank_usage([shoebox(furniture=[STOOL] * n)]).models for n in (1, 2))
    assert one == two


def test_a_models_bytes_are_those_of_its_arrays():
    house = shoebox(furniture=[STOOL])
    model = house.models[house.instances.model[1]]
    triangles, nodes = len(model.triangle), len(model.tree.child)
    rows, bank = {"triangle": triangles, "node": nodes, "model": 1}, HouseBank.from_compiled([house])
    tables = {declared.name: declared.kind for declared in declarations() if declared.kind in rows}
    assert len(tables) >= 9
    expected = sum(rows[kind] * attrgetter(name)(bank)[0].nbytes for name, kind in tables.items())
    assert bank_usage([house]).models[model.key] == expected


def test_bytes_are_known_before_a_bank_is_made():
    houses = [shoebox(furniture=[STOOL, DESK]), two_rooms()]
    planned, bank = planned_bytes(houses), HouseBank.from_compiled(houses)
    assert planned == {name: attrgetter(name)(bank).nbytes for name in planned}
    assert bank_bytes(bank) == sum(planned.values()) + bank.reset_houses.nbytes
