"""Baked records of houses that are exchanged: equal to those of a plain bank, in shapes that never change."""

import dataclasses
import threading
import time

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from streamed_houses import IDS, NUM_SLOTS, ids_of, run_until, write_streamed_houses

from home_mjx.audio_jax import AudioConfig, BakeOptions, LateReverbBake, Listener, SoundSource, impulse_response
from home_mjx.audio_jax.base.options import Baked
from home_mjx.audio_jax.late_reverb.lookup.lookup import lookup_late_sound
from home_mjx.errors import CapacityError, UnknownNameError
from home_mjx.houses import HouseSet, HouseStream, bakes, load_bank, register_bake
from home_mjx.raycast_render.scene.scene import make_open_scene
from home_mjx.tasks import AutoReset, EnvParams, HouseholdEnv, make_config

FEW = LateReverbBake(BakeOptions(cell_size=2.0, rays=40, max_bounces=40))
CONFIG = AudioConfig(late=Baked())
HEAD = jnp.array([1.0, 0.0, 0.0, 0.0])


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    return write_streamed_houses(tmp_path_factory.mktemp("stream"))


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(bakes, "_REGISTRY", dict(bakes._REGISTRY))


@dataclasses.dataclass(frozen=True)
class Text:
    """Record of the bake: the letters of a house's id, some of them."""

    letter: np.ndarray


class Letters:
    """A bake whose records are as long as the last digit of the house's id says."""

    name, version, options, record, unused = "letters", 1, None, Text, frozenset()

    def bake_house(self, bank, index, house):
        assert bank.house_ids[index] == house.id
        return Text(np.full(self.length(house), ord(house.id[-1]), np.int32))

    def length(self, house):
        return int(house.id[-1])

    def stack(self, records, houses, bank):
        assert bank.num_houses == NUM_SLOTS
        return jnp.stack([record.letter for record in records])


class EvenLetters(Letters):
    """The same with records of equal length."""

    def length(self, house):
        return 3


def find_ends(bank, house):
    """Return positions of a source and of a listener above the first and the last start."""
    start = bank.navigation.start[house]
    return [start[row].at[2].add(1.0) for row in (0, -1)]


def late_sound(bank, house):
    ends = find_ends(bank, house)
    return jax.jit(lookup_late_sound, static_argnums=3)(make_open_scene(bank, house), *ends, CONFIG)


def response(bank, house):
    source, listener = find_ends(bank, house)
    ends = SoundSource(source), Listener(listener, HEAD)
    scene = make_open_scene(bank, house)
    return np.asarray(jax.jit(impulse_response, static_argnums=4)(scene, *ends, jax.random.key(0), CONFIG))


def test_sound_after_swaps_is_that_of_a_plain_bank(root, tmp_path, monkeypatch):
    """To the last bit, though both bake anew; whole responses to that of the filters of another program."""
    with HouseStream(root, IDS, num_slots=NUM_SLOTS, capacity_factor=2.0, bakes=FEW) as stream:
        run_until(stream, NUM_SLOTS + 1)
        bank, ids = stream.bank, ids_of(stream.bank)
        assert stream.skipped == {}
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "other"))
    plain = load_bank(root, ids=ids, bakes=[FEW])
    for mine, theirs in zip(*(jax.tree.leaves(x.bakes["late_reverb"]) for x in (bank, plain)), strict=True):
        np.testing.assert_array_equal(mine[tuple(map(slice, theirs.shape))], theirs)
    energies = []
    for slot in range(NUM_SLOTS):
        mine, theirs = late_sound(bank, slot), late_sound(plain, slot)
        jax.tree.map(np.testing.assert_array_equal, mine, theirs)
        energies.append(float(mine.energy.sum()))
    assert len(set(energies)) == NUM_SLOTS
    assert min(energies) > 0
    np.testing.assert_allclose(response(bank, 0), response(plain, 0), rtol=0, atol=1e-6)


def test_shapes_and_memory_stay(root):
    with HouseStream(root, IDS, num_slots=NUM_SLOTS, capacity_factor=2.0, bakes=[FEW]) as stream:
        old = stream.bank
        run_until(stream, 2)
        assert old.bakes["late_reverb"].level.is_deleted()
        assert jax.tree.structure(old) == jax.tree.structure(stream.bank)
        shapes = [[(leaf.shape, leaf.dtype) for leaf in jax.tree.leaves(bank)] for bank in (old, stream.bank)]
        assert shapes[0] == shapes[1]


def test_stored_records_are_read(root, monkeypatch):
    load_bank(root, ids=IDS, bakes=[FEW])
    monkeypatch.setattr("home_mjx.audio_jax.late_reverb.bake.bake.bake_house", lambda *_: pytest.fail("baked again"))
    with HouseStream(root, IDS, num_slots=2, capacity_factor=2.0, bakes=[FEW]) as stream:
        run_until(stream, len(IDS))
        assert stream.skipped == {}


def test_records_of_equal_length_need_no_capacity(root):
    register_bake("letters", EvenLetters)
    with HouseStream(root, IDS, num_slots=NUM_SLOTS, capacity_factor=2.0, bakes=["letters"]) as stream:
        run_until(stream, len(IDS))
        letters = np.asarray(stream.bank.bakes["letters"])
        assert letters.tolist() == [[ord(name[-1])] * 3 for name in ids_of(stream.bank)]


def test_records_of_another_shape_are_skipped_and_reported(root):
    """They name the member that the bake lacks."""

    class Uneven(Letters):
        def length(self, house):
            return 3 if house.id[-1] != "7" else 4

    ids = sorted(IDS, key=lambda name: name[-1] == "7")
    with HouseStream(root, ids, num_slots=NUM_SLOTS, capacity_factor=2.0, seed=1, bakes=Uneven()) as stream:
        run_until(stream, len(IDS))
        assert set(stream.skipped) == {IDS[6]}
        assert "bake `letters`" in stream.skipped[IDS[6]]
        assert "capacity" in stream.skipped[IDS[6]]


def test_records_that_exceed_the_capacity_are_skipped_and_reported(root):
    """Those of the first houses times the factor fit."""
    houses = HouseSet(root, ids=IDS[:1]).load()
    bank = load_bank(root, ids=IDS[:1])
    small = FEW.bake_house(bank, 0, houses[0])
    capacity = FEW.capacity([small], 2.0)
    assert FEW.stack([small], houses[:1], bank, capacity).near.shape[:2] == (1, 2 * len(small.floor))
    three = {name: np.concatenate([getattr(small, name)] * 3) for name in ("near", "weight", "floor")}
    with pytest.raises(CapacityError, match=r"house 0*1 needs 3 levels, 2 fit.*capacity_factor"):
        FEW.stack([dataclasses.replace(small, **three)], houses[:1], bank, capacity)


def test_unknown_bakes_are_refused(root):
    with pytest.raises(UnknownNameError, match="unknown bake `late`"):
        HouseStream(root, IDS, num_slots=2, bakes=["late"])


def test_environments_hear_through_swaps(root):
    """The default environment with sound, in one trace."""
    config = make_config(sensors=("ear_levels",), impl="kinematic", episode_length=3)
    core, traces = HouseholdEnv(config), 0
    auto = AutoReset(core)

    def counted(params, states, actions):
        nonlocal traces
        traces += 1
        return auto.step(params, states, actions)

    step = jax.jit(counted)
    with HouseStream(root, IDS, num_slots=NUM_SLOTS, capacity_factor=2.0, bakes=core.bakes) as stream:
        states = jax.jit(auto.reset)(EnvParams(stream.bank), jax.random.split(jax.random.key(0), 4))
        end = time.monotonic() + 60
        while stream.num_swaps < 3 and time.monotonic() < end:
            states = step(EnvParams(stream.advance(states.world.house)), states, jnp.zeros((4, core.action_size)))
        assert stream.num_swaps == 3
    assert traces == 1
    assert np.isfinite(np.asarray(states.obs["ear_levels"])).all()


class MeetingLetters(Letters):
    """Bakes that wait until two houses are baked at once."""

    together = threading.Barrier(2)

    def bake_house(self, bank, index, house):
        self.together.wait(60)
        return super().bake_house(bank, index, house)


def test_several_houses_are_baked_at_once(root, monkeypatch):
    """On machines of many cores; records keep the order of the houses."""
    monkeypatch.setattr(bakes, "usable_cores", lambda: 2 * bakes.CORES_PER_BAKE)
    monkeypatch.setattr(Letters, "length", lambda self, house: 1)
    monkeypatch.setattr(Letters, "stack", lambda self, records, *_: [int(r.letter[0]) for r in records])
    ids = IDS[:2]
    houses = HouseSet(root, ids).load()
    bank = bakes.add_bakes(load_bank(root, ids=ids), houses, MeetingLetters())
    assert bank.bakes["letters"] == [ord(house_id[-1]) for house_id in ids]
