"""One declaration makes an array: it is packed, exchanged in streams, counted and documented."""

import dataclasses
import re
import runpy
from pathlib import Path

import jax
import numpy as np
import pytest
from handmade import Furniture, shoebox, two_rooms
from jaxtyping import Array, Float, Int
from streamed_houses import IDS, ids_of, run_until, write_streamed_houses

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.packing import pack
from home_mjx.bank.packing.capacity import AXES, axis_lengths, capacity_of, slot_stride
from home_mjx.bank.packing.pack import check_house_fits
from home_mjx.bank.records import Finish, Physics, declarations
from home_mjx.bank.records.bank_arrays import RECORDS, get_array
from home_mjx.bank.records.declaration import ROW_KINDS
from home_mjx.bank.usage import bank_usage, planned_bytes
from home_mjx.core.pytree import array
from home_mjx.errors import CapacityError
from home_mjx.houses import load_bank
from home_mjx.houses.stream import HouseStream

STOOL = Furniture((1.0, 0.5), size=(0.4, 0.6, 0.5), mass=4.0)
ROOT = Path(__file__).resolve().parent.parent.parent


def volumes(at):
    return 8 * at.house.bodies.size.prod(axis=1)


class MorePhysics(Physics):
    body_volume: Float[Array, "h bodies"] = array("[m^3]; -1 padding", source=volumes, fill=-1)


class MoreFinish(Finish):
    stops: Int[Array, " material"] = array("Ray bits", source="materials.mask", fill=9, dtype=np.int16)


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    return write_streamed_houses(tmp_path_factory.mktemp("stream"))


@pytest.fixture
def more(monkeypatch):
    """Two arrays more: one of houses, one of materials."""
    monkeypatch.setitem(RECORDS, "physics", MorePhysics)
    monkeypatch.setitem(RECORDS, "finish", MoreFinish)


def check(bank):
    physics, finish = bank.physics, bank.finish
    valid, size = np.asarray(physics.body_valid), np.asarray(physics.body_size)
    np.testing.assert_allclose(physics.body_volume, np.where(valid, 8 * size.prod(axis=2), -1), rtol=1e-6)
    assert valid.any()
    assert finish.stops.dtype == np.int16
    used = np.asarray(finish.stops) != 9
    np.testing.assert_array_equal(np.asarray(finish.stops)[used], np.asarray(bank.geometry.material_mask)[used])
    assert 0 < used.sum() < used.size


def test_a_declared_array_is_packed_and_counted(more):
    houses = [shoebox(furniture=[STOOL, STOOL]), two_rooms()]
    bank = HouseBank.from_compiled(houses)
    check(bank)
    planned = planned_bytes(houses)
    assert planned["physics.body_volume"] == bank.physics.body_volume.nbytes
    assert planned["finish.stops"] == bank.finish.stops.nbytes


def test_a_declared_array_counts_as_its_houses(monkeypatch):
    houses = [shoebox(furniture=[STOOL, STOOL])]
    before = bank_usage(houses).houses[houses[0].id]
    monkeypatch.setitem(RECORDS, "physics", MorePhysics)
    monkeypatch.setitem(RECORDS, "finish", MoreFinish)
    bodies, materials = capacity_of(houses)["bodies"], len(houses[0].materials.mask)
    assert bank_usage(houses).houses[houses[0].id] == before + 4 * bodies + 2 * materials


def test_a_declared_array_is_exchanged_in_a_stream(more, root):
    with HouseStream(root, IDS, num_slots=4, capacity_factor=2.0) as stream:
        check(stream.bank)
        run_until(stream, 5)
        check(stream.bank)
        plain = load_bank(root, ids=ids_of(stream.bank))
        np.testing.assert_array_equal(stream.bank.physics.body_volume, plain.physics.body_volume)


def test_every_array_of_a_bank_is_declared_or_derived():
    bank = HouseBank.from_compiled([shoebox(furniture=[STOOL])])
    paths = [jax.tree_util.keystr(path).lstrip(".") for path, _ in jax.tree_util.tree_flatten_with_path(bank)[0]]
    assert set(paths) - {declared.name for declared in declarations()} == {"reset_houses"}


def test_arrays_have_the_shape_dtype_and_fill_that_they_are_declared_with():
    houses = [shoebox(furniture=[STOOL, STOOL]), two_rooms()]
    bank, lengths = HouseBank.from_compiled(houses), axis_lengths(capacity_of(houses)) | {"h": 2}
    for declared in declarations():
        values = np.asarray(get_array(bank, declared.key))
        assert values.dtype == declared.dtype, declared.name
        assert values.ndim == len(declared.axes), declared.name
        for length, axis in zip(values.shape, declared.axes, strict=True):
            assert length == (int(axis) if axis.isdigit() else lengths.get(axis, length)), declared.name


def test_axes_are_known():
    """A name that is no axis would only be found when a bank is packed."""
    known = {*AXES, *ROW_KINDS, "h", "doors", "rooms_and_none", "bands", "columns", "id_bytes"}
    known |= {"layers", "texels", "edge", "words"}
    assert {axis for declared in declarations() for axis in declared.axes if not axis.isdigit()} <= known


def test_values_that_do_not_fit_their_axes_are_refused(monkeypatch):
    class Wrong(Physics):
        body_corner: Float[Array, "h bodies 2"] = array("[m]", source="bodies.size")

    monkeypatch.setitem(RECORDS, "physics", Wrong)
    with pytest.raises(CapacityError, match=r"\(1, 1, 3\).*physics\.body_corner.*declared with.*bodies"):
        HouseBank.from_compiled([shoebox(furniture=[STOOL])])


def test_object_ids_may_have_gaps():
    house = shoebox(furniture=[STOOL, STOOL])
    ids = dataclasses.replace(house.instances, object_id=np.array([-1, 40, 7]))
    rows = np.asarray(HouseBank.from_compiled([dataclasses.replace(house, instances=ids)]).geometry.object_semantic)[0]
    assert np.flatnonzero(rows >= 0).tolist() == [7, 40]


def test_the_documented_table_is_that_of_the_schema():
    table = runpy.run_path(str(ROOT / "scripts" / "bank_table.py"))["rows"]()
    written = (ROOT / "docs" / "bank.md").read_text().split("## The table")[1]
    assert re.findall(r"^\| `.*$", written, re.MULTILINE) == table


def test_a_house_beyond_the_capacity_is_refused_with_the_numbers(monkeypatch):
    houses = [shoebox(furniture=[STOOL] * count) for count in (8, 9)]
    capacity, stride = capacity_of(houses[:1]), slot_stride(houses, 1.0)
    check_house_fits(houses[0], capacity, stride)
    with pytest.raises(CapacityError, match=r"house \S+ needs 9 bodies, 8 fit"):
        check_house_fits(houses[1], capacity, stride)
    bank = HouseBank.from_compiled(houses[:1])
    count = len(bank.geometry.triangle)
    monkeypatch.setattr(pack, "MAX_TRIANGLES", 50)
    with pytest.raises(CapacityError, match=r"have \d+ triangles, at most 49 fit") as caught:
        HouseBank.from_compiled(houses[:1])
    assert 50 <= int(re.findall(r"have (\d+)", str(caught.value))[0]) <= count
