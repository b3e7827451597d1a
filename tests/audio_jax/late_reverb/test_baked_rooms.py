"""Baked late sound against the oracle, in the rooms where live tracing is wrong."""

from dataclasses import replace

import acoustic_rooms as rooms
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from decay_oracle import fly
from handmade import shoebox, two_rooms
from numpy_measures import decay_time, edt, t30
from scenes import HEAD

from home_mjx.audio_jax import (
    AudioConfig,
    BakeOptions,
    Listener,
    SoundSource,
    early_paths,
    first_order_directivity,
    impulse_response,
)
from home_mjx.audio_jax.auralization.response import late_energy
from home_mjx.audio_jax.base.filters import octave_gains
from home_mjx.audio_jax.base.options import Baked, Omni
from home_mjx.audio_jax.late_reverb.bake.bake import bake_house
from home_mjx.audio_jax.late_reverb.bake.decay_fit import Accumulator
from home_mjx.audio_jax.late_reverb.bake.late_field import LateField, stack_fields
from home_mjx.audio_jax.late_reverb.lookup.lookup import lookup_late_sound
from home_mjx.audio_jax.late_reverb.lookup.time_grid import MIN_ENERGY
from home_mjx.audio_jax.late_reverb.trace.cells import divide_rooms
from home_mjx.audio_jax.parameters import survey_room
from home_mjx.bank.bank import HouseBank
from home_mjx.errors import ConfigError
from home_mjx.raycast_render.scene.scene import make_open_scene
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import CompiledHouse

CONFIG = AudioConfig(response_seconds=2.0, receiver=Omni(), late=Baked())
look_up = jax.jit(lookup_late_sound, static_argnums=3)
DT = CONFIG.bin_seconds
METRES = DT * CONFIG.speed_of_sound
MID = 3  # 1 kHz


def scene_with(house: CompiledHouse, field: LateField) -> Scene:
    bank = HouseBank.from_compiled([house])
    rows = house.doors.bank_rows(bank.spec.num_doors, bank.spec.num_slides)
    return make_open_scene(bank.replace(bakes={"late_reverb": stack_fields([field], [rows])}), 0)


def baked(house: CompiledHouse, options: BakeOptions) -> Scene:
    return scene_with(house, bake_house(house, options))


@jax.jit
def whole_energy(scene: Scene, source: jax.Array, listener: jax.Array) -> jax.Array:
    """Histogram (k, 7) of early paths and the baked field together."""
    paths = early_paths(scene, SoundSource(source), Listener(listener, HEAD), CONFIG)
    late = look_up(scene, source, listener, CONFIG).energy
    return late.at[(paths.distance / METRES).astype(jnp.int32)].add(paths.gain**2, mode="drop")


def heard(room: rooms.KnownRoom, scene: Scene) -> np.ndarray:
    """Energies (listeners, bands, bins)."""
    source = jnp.asarray(room.source, jnp.float32)
    return np.stack([np.asarray(whole_energy(scene, source, jnp.asarray(p, jnp.float32))).T for p in room.listeners])


def means(energy: np.ndarray, read) -> np.ndarray:
    """Of a measure over listeners, per octave."""
    return np.mean([[read(band, DT) for band in one] for one in energy], axis=0)


@pytest.fixture(scope="module")
def uneven() -> tuple[rooms.KnownRoom, Scene]:
    room = rooms.uneven()
    return room, baked(room.house, BakeOptions(cell_size=1.5, rays=400, max_bounces=120))


def test_an_uneven_room_decays_as_it_should(uneven):
    """Live tracing is 24 % short at 1 kHz; level and EDT are read at single places."""
    room, scene = uneven
    ours = heard(room, scene)
    truth = fly(room.blocks, room.source, room.listeners, 2.0, particles=15_000).energy
    np.testing.assert_allclose(means(ours, t30), means(truth, t30), rtol=0.12)
    np.testing.assert_allclose(means(ours, edt), means(truth, edt), rtol=0.08)
    level = 10 * np.log10(ours.mean(axis=0).sum(axis=1) / truth.mean(axis=0).sum(axis=1))
    np.testing.assert_allclose(level, 0, atol=0.4)


@pytest.fixture(scope="module")
def even():
    """A room, and what is heard in it of a narrow source, 1 kHz over time at one of the listeners."""
    room = rooms.even()
    scene = baked(room.house, BakeOptions(cell_size=1.5, rays=400, max_bounces=80))

    @jax.jit
    def hear(quat, place):
        source = SoundSource(
            jnp.asarray(room.source, jnp.float32), quat=quat, directivity=first_order_directivity(0.5, 2.0)
        )
        return late_energy(scene, source, Listener(place, HEAD), jax.random.key(0), CONFIG)[:, 0, MID]

    return room, hear


@pytest.mark.parametrize("axis", [[1.0, 0, 0], [0, 0, -1.0]])
def test_a_narrow_source_is_as_loud_as_it_should(axis, even):
    """A cardioid squared in an even room, 1 kHz from 50 ms on, mean of all listeners: 0.5 dB."""
    room, hear = even
    one = slice(MID, MID + 1)
    blocks = replace(
        room.blocks,
        absorption=room.blocks.absorption[:, one],
        scattering=room.blocks.scattering[:, one],
        air=room.blocks.air[one],
    )
    narrow = {"axis": np.array(axis), "weight": 0.5, "exponent": 2.0}
    truth = fly(blocks, room.source, room.listeners, 1.0, particles=40_000, **narrow).energy[:, 0, 13:].sum()
    down = jnp.float32([1, 0, 0, 0])  # looks along -z
    quat = HEAD if axis[0] else down
    ours = sum(np.asarray(hear(quat, jnp.float32(p)))[13:250].sum() for p in room.listeners)
    assert 10 * np.log10(ours / truth) == pytest.approx(0, abs=0.5)


def test_what_is_read_is_as_early_as_what_rays_gave(monkeypatch):
    """Mean times of late sound between all cells of an absorbing room, within 0.5 ms.

    When whole bins before the first arrival were taken off, and what was left of them added again, all late sound was
    half a bin, 2 ms, late: EDT of a room of 0.25 s was 5 % long.
    """
    found = {}
    add = Accumulator.add

    def keep(tally, own, emitted, after, flown):
        found["heard"] = convolved(own[..., MID], emitted[MID], after[MID])
        add(tally, own, emitted, after, flown)

    monkeypatch.setattr(Accumulator, "add", keep)
    house = shoebox((6.0, 5.0, 3.0), absorption=0.5)
    scene = baked(house, BakeOptions(cell_size=1.5, rays=100, max_bounces=40))
    middle = jnp.asarray(divide_rooms(house, 1.5).center, jnp.float32)
    read = jax.vmap(jax.vmap(lambda a, b: lookup_late_sound(scene, a, b, CONFIG).energy[:, MID], (None, 0)), (0, None))
    ours, exact = np.asarray(jax.jit(read)(middle, middle)), found["heard"]
    times = [(x.sum(axis=(0, 1)) @ np.arange(x.shape[2])) / x.sum() for x in (ours, exact)]
    assert 1000 * DT * (times[0] - times[1]) == pytest.approx(0, abs=0.5)


def convolved(own: np.ndarray, emitted: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Energy (n, n, k) between cells: before gates, and what they emit into gates with what gates give to cells."""
    whole = np.zeros((*own.shape[:2], after.shape[-1]))
    whole[..., : own.shape[2]] = own
    for lag in range(emitted.shape[-1]):
        whole[..., lag:] += np.einsum("ig,gjk->ijk", emitted[..., lag], after[..., : after.shape[-1] - lag])
    return whole


def test_source_and_listener_may_change_places(uneven):
    scene = uneven[1]
    here, there = jnp.float32([-2.0, 1.0, 1.2]), jnp.float32([1.5, -0.7, 1.7])
    run = jax.jit(lambda a, b: lookup_late_sound(scene, a, b, CONFIG).energy)
    np.testing.assert_allclose(run(here, there), run(there, here), rtol=1e-4, atol=1e-9)


def test_steps_are_smooth(uneven):
    """5 cm at a time through the room: no more than 0.3 dB."""
    scene = uneven[1]
    path = jnp.stack([jnp.linspace(-2.8, 2.8, 113), jnp.full(113, 0.3), jnp.full(113, 1.5)], axis=1)
    source = jnp.float32([2.0, -1.5, 1.0])
    walk = jax.jit(jax.vmap(lambda p: jnp.sum(lookup_late_sound(scene, source, p, CONFIG).energy, axis=0)))
    level = 10 * np.log10(np.asarray(walk(path)))
    assert np.max(np.abs(np.diff(level, axis=0))) < 0.3


def test_silent_cells_do_not_weaken_a_direction(uneven):
    """A mean over cells weighted by energy: those that no ray reached have neither energy nor direction."""
    scene = uneven[1]
    late, ear = scene.bank.bakes["late_reverb"], jnp.float32([0.3, -0.2, 1.4])
    reached = jnp.arange(late.level.shape[2])[:, None, None] % 2 == 0
    record = late.replace(
        level=jnp.where(reached, late.level, jnp.float16(np.log(MIN_ENERGY))),
        comes_from=jnp.where(reached, jnp.int8([127, 0, 0]), jnp.zeros_like(late.comes_from)),
    )
    scene = scene.replace(bank=scene.bank.replace(bakes={"late_reverb": record}))
    found = look_up(scene, jnp.float32([-2.0, 1.0, 1.2]), ear, CONFIG).arrival_direction
    np.testing.assert_allclose(found, np.broadcast_to([1, 0, 0], found.shape), atol=1e-3)


def with_directions(scene: Scene, direction: list[int]) -> Scene:
    """A scene where all late sound arrives from one direction [1/127], whatever its length."""
    late = scene.bank.bakes["late_reverb"]
    record = late.replace(comes_from=jnp.broadcast_to(jnp.int8(direction), late.comes_from.shape))
    return scene.replace(bank=scene.bank.replace(bakes={"late_reverb": record}))


def test_a_mean_direction_is_at_most_1_long(uneven):
    """Noise of the bake makes it up to 1.7 long, each component being limited to 1."""
    scene = with_directions(uneven[1], [127, -127, 127])
    found = look_up(scene, jnp.float32([-2.0, 1.0, 1.2]), jnp.float32([0.3, -0.2, 1.4]), CONFIG)
    for way in (found.arrival_direction, found.emission_direction):
        np.testing.assert_allclose(np.linalg.norm(way, axis=1), 1, atol=1e-6)


@pytest.mark.parametrize("direction", [[127, -127, 127], [127, 0, 0], [-90, 90, 0], [0, 0, 127]])
def test_no_ear_receives_negative_energy(uneven, rng, direction):
    """With sound from one direction, an ear in the head's shadow had one, and its frames were not numbers.

    It was 1 of 500 environments in homes, and the training of AudioNav there diverged in its first update.
    """
    scene, config = with_directions(uneven[1], direction), AudioConfig(late=Baked())
    source, ear = jnp.float32([-2.0, 1.0, 1.2]), jnp.float32([0.3, -0.2, 1.4])
    turns = rng.normal(size=(50, 4))
    turns = jnp.float32(turns / np.linalg.norm(turns, axis=1, keepdims=True))
    narrow = SoundSource(source, quat=HEAD, directivity=first_order_directivity(0.5, 2.0))
    for one in (SoundSource(source), narrow):
        hear = jax.vmap(lambda turn, one=one: late_energy(scene, one, Listener(ear, turn), jax.random.key(0), config))
        assert float(jax.jit(hear)(turns).min()) >= 0


def test_a_field_is_small(uneven):
    assert uneven[1].bank.bakes["late_reverb"].nbytes < 150_000


def test_a_waveform_has_the_energy_of_the_field(uneven):
    """From 60 ms on, when first reflections are over; of white sound, so each octave counts by its width."""
    scene, config = uneven[1], AudioConfig(response_seconds=2.0, late=Baked(), receiver=Omni())
    source, listener = SoundSource(jnp.float32([-2.0, 1.0, 1.2])), Listener(jnp.float32([1.5, -0.7, 1.7]), HEAD)
    response = jax.jit(impulse_response, static_argnums=4)(scene, source, listener, jax.random.key(0), config)
    energy = np.asarray(look_up(scene, source.pos, listener.pos, config).energy)[15:]
    width = octave_gains(np.linspace(0, config.sample_rate / 2, 4001)).mean(axis=1)
    heard = (np.asarray(response)[:, 15 * config.bin_samples :] ** 2).sum(axis=1)
    np.testing.assert_allclose(10 * np.log10(heard / (energy @ width).sum()), 0, atol=0.5)


@pytest.mark.slow
def test_a_survey_reads_the_baked_field(uneven):
    """T30 of a waveform as that of the field's energies; a figure of eight hears a third of what is everywhere."""
    scene, config = uneven[1], AudioConfig(response_seconds=2.0, late=Baked())
    source, listener = SoundSource(jnp.float32([-2.0, 1.0, 1.2])), Listener(jnp.float32([1.5, -0.7, 1.7]), HEAD)
    found = jax.jit(survey_room, static_argnums=4)(scene, source, listener, jax.random.key(0), config)
    energy = np.asarray(whole_energy(scene, source.pos, listener.pos)).T
    np.testing.assert_allclose(found.parameters.t30[1:], [t30(band, DT) for band in energy[1:]], rtol=0.08)
    assert np.all(np.abs(np.asarray(found.lateral_fraction) - 1 / 3) < 0.2)


def test_a_bank_without_baked_sound_is_refused():
    scene = make_open_scene(HouseBank.from_compiled([shoebox()]), 0)
    with pytest.raises(ConfigError, match="add_bakes"):
        lookup_late_sound(scene, jnp.zeros(3), jnp.ones(3), CONFIG)


@pytest.mark.parametrize("loss", [15, 30, 40])
def test_sealed_rooms_are_as_far_apart_as_their_wall_says(loss, sealed):
    """L1 - L2 = R - 10 lg(S / A), ISO 16283: 13, 28 and 38 dB."""
    scene, source, listeners = sealed
    rows = scene.bank.bakes["late_reverb"].wall.astype(jnp.float32) * 10 ** (-(loss - 15) / 10)
    bank = scene.bank.replace(bakes={"late_reverb": scene.bank.bakes["late_reverb"].replace(wall=rows)})
    table = bank.materials.transmission * 10 ** (-(loss - 15) / 10)
    scene = scene.replace(bank=bank.replace(materials=bank.materials.replace(transmission=table)))
    total = [
        np.mean([np.asarray(whole_energy(scene, source, p)).sum(axis=0) for p in group], axis=0) for group in listeners
    ]
    level = 10 * np.log10(np.stack(total))
    wanted = loss - 10 * np.log10(15 / (0.1 * 94))
    np.testing.assert_allclose((level[0] - level[1])[:6], wanted, atol=1.5)


def test_where_nothing_gets_through_nothing_is_heard(sealed):
    """Of a source that is out of reach: nothing, early paths included."""
    scene, source, listeners = sealed
    late = scene.bank.bakes["late_reverb"].replace(wall=jnp.zeros_like(scene.bank.bakes["late_reverb"].wall))
    table = jnp.zeros_like(scene.bank.materials.transmission)
    bank = scene.bank.replace(bakes={"late_reverb": late}, materials=scene.bank.materials.replace(transmission=table))
    heard_there = np.asarray(whole_energy(scene.replace(bank=bank), source, listeners[1][0]))
    assert np.isfinite(heard_there).all()
    assert 0 <= heard_there.sum() < 1e-9


@pytest.fixture(scope="module")
def sealed() -> tuple[Scene, jax.Array, list]:
    """Two rooms 4 x 5 x 3 m of absorption 0.1, a wall of 15 dB between them."""
    scene = baked(
        two_rooms(absorption=0.1, transmission=10**-1.5), BakeOptions(cell_size=2.0, rays=150, max_bounces=100)
    )
    places = np.array([[-3.3, 1.0, 1.2], [-1.2, -1.5, 1.7], [-2.0, 1.9, 2.2], [-3.5, -1.8, 0.8]], np.float32)
    return scene, jnp.float32([-2.6, -0.4, 1.4]), [list(places), list(places * np.array([-1, 1, 1], np.float32))]


@pytest.fixture(scope="module")
def coupled():
    """Two rooms and a doorway, with what is baked for them, and the truth."""
    room = rooms.coupled()
    truth = fly(room.blocks, room.source, room.listeners, 2.0, particles=60_000, radius=0.5)
    return room, baked(room.house, BakeOptions(cell_size=0.8, rays=400, max_bounces=150)), truth


@pytest.mark.slow
def test_coupled_rooms_keep_both_slopes(coupled):
    """The late slope of the source's room within a tenth, where live tracing has half of it; the other room's level."""
    room, scene, heard_by_oracle = coupled
    ours, truth = heard(room, scene), heard_by_oracle.energy
    slopes = [decay_time(e[:3, MID].mean(axis=0), DT, -25, -45) for e in (ours, truth)]
    assert slopes[0] == pytest.approx(slopes[1], rel=0.12)
    for group in (slice(0, 3), slice(3, 6)):
        np.testing.assert_allclose(means(ours[group], t30)[:6], means(truth[group], t30)[:6], rtol=0.12)
        level = 10 * np.log10(ours[group].mean(axis=0).sum(axis=1) / truth[group].mean(axis=0).sum(axis=1))
        np.testing.assert_allclose(level, 0, atol=0.6)


@pytest.mark.slow
def test_sound_in_the_other_room_comes_out_of_the_doorway(coupled):
    """The first 8 ms as the oracle says, early reflections included; so does what is baked; later from everywhere."""
    room, scene, truth = coupled
    for place, way, energy in zip(room.listeners[3:], -truth.way[3:].sum(axis=1), truth.energy[3:], strict=True):
        source, ear = (jnp.asarray(x, jnp.float32) for x in (room.source, place))
        whole, bins = first_span(scene, source, ear)
        first, last = np.asarray(look_up(scene, source, ear, CONFIG).arrival_direction)[[0, -1]]
        assert np.linalg.norm(last) < 0.2
        door, away = doorway_from(place)
        exact = way[bins].sum(axis=0) / energy[:, bins].sum()
        np.testing.assert_allclose(whole @ door, exact @ door, atol=0.25)
        if away < 3:
            assert first @ door > 0.3
            assert first @ door / np.linalg.norm(first) > 0.7


@pytest.mark.slow
@pytest.mark.xfail(
    reason="walls answer within the first span: bakes have -0.38 to +0.15, and the reference 0.08 with a cosine of 0.55"
)
def test_so_does_what_is_baked_far_behind_the_doorway(coupled):
    room, scene, _ = coupled
    source, ear = (jnp.asarray(x, jnp.float32) for x in (room.source, room.listeners[-1]))
    first, (door, away) = (
        lookup_late_sound(scene, source, ear, CONFIG).arrival_direction[0],
        doorway_from(room.listeners[-1]),
    )
    assert away > 3
    assert first @ door > 0.05
    assert first @ door / np.linalg.norm(first) > 0.7


def doorway_from(place: np.ndarray) -> tuple[np.ndarray, float]:
    """Direction and distance [m]."""
    way = np.array([6.0, 0.0, 1.0]) - place
    return way / np.linalg.norm(way), float(np.linalg.norm(way))


def first_span(scene: Scene, source: jax.Array, ear: jax.Array) -> tuple[np.ndarray, slice]:
    """Mean direction of all but the direct sound in the first span, and its bins."""
    late = lookup_late_sound(scene, source, ear, CONFIG)
    paths = early_paths(scene, SoundSource(source), Listener(ear, HEAD), CONFIG)
    share, energy = np.asarray(late.span_share)[:, 0], np.asarray(late.energy).sum(axis=1)
    bins = np.flatnonzero(share > 0.01)
    whole, at = slice(int(bins[0]), int(bins[-1]) + 1), (np.asarray(paths.distance) / METRES).astype(int)
    inside = (at >= whole.start) & (at < whole.stop) & (np.arange(at.size) > 0)
    power = (np.asarray(paths.gain) ** 2).sum(axis=1)[inside]
    baked_power = energy @ share
    flow = np.asarray(late.arrival_direction)[0] * baked_power + power @ np.asarray(paths.direction)[inside]
    return flow / (baked_power + power.sum()), whole
