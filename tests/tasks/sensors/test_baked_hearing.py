"""An environment whose late sound is baked: what agents hear, doors open and shut, and what is refused."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from generated import generate_flats
from handmade import Slab, _architecture_rows, _room_planes, _rooms, _shell, build_house, shoebox
from parted import parted

from home_mjx import HouseBank, HouseholdEnv
from home_mjx.audio_jax import AudioConfig, BakeOptions, LateReverbBake, Listener, SoundSource
from home_mjx.audio_jax.auralization.envelope import energy_envelope
from home_mjx.audio_jax.base.options import Baked, Traced
from home_mjx.audio_jax.late_reverb.bake.bake import bake_house
from home_mjx.audio_jax.late_reverb.lookup.energy_balance import effective_openings
from home_mjx.audio_jax.late_reverb.lookup.lookup import lookup_late_sound
from home_mjx.errors import ConfigError
from home_mjx.houses import add_bakes
from home_mjx.houses.bakes import bake_entry
from home_mjx.houses.house_set import HouseSet
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.tasks import make_config
from home_mjx.tasks.env.checks import check_bank

FEW = BakeOptions(cell_size=2.0, rays=40, max_bounces=40)
BAKED = AudioConfig(late=Baked())
OPTIONS = {"impl": "kinematic", "sensors": ("audio", "ear_levels"), "actions": "discrete"}


@pytest.fixture(autouse=True, scope="module")
def own_cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("HOME_MJX_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="module")
def room():
    return shoebox((5.0, 4.0, 2.6), absorption=0.1)


@pytest.fixture(scope="module")
def bank(room):
    return add_bakes(HouseBank.from_compiled([room]), [room], LateReverbBake(FEW))


def test_a_step_hears_baked_sound(bank):
    """Levels are those of many rays within 1.5 dB, and the waveform is not silent."""

    def heard(audio, sensors=OPTIONS["sensors"]):
        env = HouseholdEnv(make_config(audio=replace(BAKED, **audio), **OPTIONS | {"sensors": sensors})).bind(bank)
        reset, step = parted(env.core)
        state = reset(env.params, jax.random.key(3))
        return np.asarray(step(env.params, state, 0).obs["ear_levels"]), np.asarray(state.obs.get("audio"))

    levels, audio = heard({})
    assert np.isfinite(audio).all()
    assert np.abs(audio).max() > 1e-3
    traced, _ = heard({"late": Traced(num_rays=500, num_bounces=80)}, ("ear_levels",))
    loud = traced > traced.max() - 40
    np.testing.assert_allclose(levels[loud], traced[loud], atol=1.5)


@pytest.mark.parametrize("sensor", ["audio", "stft", "log_mel", "ear_levels"])
def test_each_sensor_that_hears_requests_the_bake(sensor):
    for late, names in ((Baked(), ["late_reverb"]), (Traced(), [])):
        env = HouseholdEnv(make_config(audio=AudioConfig(late=late), **OPTIONS | {"sensors": (sensor,)}))
        assert [bake.name for bake in env.bakes] == names


def test_it_is_baked_once(bank, room, monkeypatch):
    assert bake_entry(LateReverbBake(FEW), room).is_file()
    monkeypatch.setattr("home_mjx.audio_jax.late_reverb.bake.bake.bake_house", lambda *_: pytest.fail("baked again"))
    again = add_bakes(HouseBank.from_compiled([room]), [room], LateReverbBake(FEW))
    assert all(
        map(np.array_equal, jax.tree.leaves(again.bakes["late_reverb"]), jax.tree.leaves(bank.bakes["late_reverb"]))
    )
    other = replace(room, materials=replace(room.materials, absorption=room.materials.absorption * 0.5))
    assert bake_entry(LateReverbBake(FEW), other) != bake_entry(LateReverbBake(FEW), room)


def test_machines_with_and_without_gpu_share_records(room, monkeypatch):
    entry = bake_entry(LateReverbBake(FEW), room)
    monkeypatch.setattr(jax, "default_backend", lambda: "gpu")
    assert bake_entry(LateReverbBake(FEW), room) == entry


def test_wrong_banks_are_refused(bank, room):
    with pytest.raises(ConfigError, match="add_bakes"):
        HouseholdEnv(make_config(audio=BAKED, **OPTIONS)).bind(HouseBank.from_compiled([room]))
    with pytest.raises(ConfigError, match="the bank holds houses"):
        add_bakes(bank, [replace(room, id="another")], LateReverbBake(FEW))


def test_furniture_that_is_moved_before_every_episode_is_told(bank, monkeypatch, caplog):
    """What has been baked does not know of it; whatever else an environment does to a house is no such matter."""
    monkeypatch.setattr("home_mjx.tasks.env.checks.check_arrangements", lambda _: None)
    check_bank(make_config(audio=BAKED, arrangement="random", **OPTIONS), bank, (LateReverbBake(FEW),))
    assert "furniture as in the files" in caplog.text
    caplog.clear()
    check_bank(make_config(audio=BAKED, **OPTIONS), bank, (LateReverbBake(FEW),))
    check_bank(make_config(arrangement="random", **OPTIONS), bank)
    assert not caplog.records


def test_levels_need_no_exceptions_of_dtype_or_rank(bank):
    scene = scene_of(bank, None)
    head = Listener(jnp.float32([1, 1, 1.5]), jnp.float32([0.5, 0.5, -0.5, -0.5]))
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        run = jax.jit(energy_envelope, static_argnums=4)
        found = run(scene, SoundSource(jnp.float32([-1, -1, 1])), head, jax.random.key(0), BAKED)
    assert np.isfinite(np.asarray(found.energy)).all()


def test_rooms_that_take_nothing_and_rooms_without_a_ceiling_are_baked(room):
    """The one rings for as long as air lets it, the other is heard from the walls that there are: both are finite."""
    low, high = (-2.5, -2.0), (2.5, 2.0)
    away = Slab((-9.0, -9.0, -50.0), (9.0, 9.0, -49.0), "ceiling", 5, 0)
    slabs = [*_shell(low, high, 2.6, 0)[:5], away]
    rows, planes = _architecture_rows(slabs, 0.1, 0.3, 0.0), _room_planes(low, high, 2.6, 0)
    roofless = build_house("roofless", slabs, rows, _rooms([(low, high)], 2.6), planes)
    fields = [bake_house(house, FEW) for house in (room, shoebox((5.0, 4.0, 2.6), absorption=0.0), roofless)]
    level = [np.exp(field.level.astype(float)).sum(axis=2).mean(axis=(0, 1)) for field in fields]
    assert all(np.isfinite(getattr(field, name)).all() for field in fields for name in ("level", "shape", "loss"))
    assert np.all(level[1] > 1.2 * level[0])  # at 8 kHz air takes most
    assert np.all(level[1][:3] > 4 * level[0][:3])
    assert np.all(level[2] < 0.6 * level[0])
    assert np.all(level[2] > 1e-3)


def scene_of(bank, angle):
    nobody = jnp.zeros((0, 3), jnp.float32), jnp.zeros((0, 4), jnp.float32)
    return make_scene(
        bank, jnp.int32(0), bank.physics.body_pos[0], bank.physics.body_quat[0], *nobody, door_angle=angle
    )


@pytest.fixture(scope="module")
def house(tmp_path_factory):
    """A generated one."""
    root = tmp_path_factory.mktemp("generated")
    return HouseSet(root, generate_flats(root, range(1))).load()[0]


@pytest.mark.slow
def test_shutting_a_door_makes_the_next_room_quiet(house):
    """By 8 dB or more (a hollow leaf has 14 dB at 125 Hz); half open it is in between; the own room gets no quieter."""
    bank = add_bakes(HouseBank.from_compiled([house]), [house], LateReverbBake(BakeOptions(rays=60, max_bounces=60)))
    physics, portals = bank.physics, house.navigation.portals
    inner = np.flatnonzero((portals.room >= 0).all(axis=1) & (portals.leaf[:, 0] >= 0))
    portal = int(inner[np.argmax(portals.width[inner])])
    source, listener = (_in_room(house, room) for room in portals.room[portal])
    wide, closed = physics.door_fully_open[0], physics.door_closed[0]
    leaf = int(house.doors.bank_rows(bank.spec.num_doors, bank.spec.num_slides)[portals.leaf[portal, 0]])
    assert float(effective_openings(scene_of(bank, wide))[leaf]) == pytest.approx(1.0, abs=1e-3)
    assert float(effective_openings(scene_of(bank, closed))[leaf]) == pytest.approx(0.0, abs=1e-3)

    @jax.jit
    def levels(share):
        scene = scene_of(bank, closed + share * (wide - closed))
        return [jnp.sum(lookup_late_sound(scene, source, p, BAKED).energy, axis=0) for p in (listener, source + 0.3)]

    (far, near), (half, _), (shut, own) = [
        [10 * np.log10(np.asarray(x)) for x in levels(jnp.float32(share))] for share in (1.0, 0.3, 0.0)
    ]
    assert np.all(shut < far - 8)
    assert np.all(half < far)
    assert np.all(half > shut)
    assert np.all(own > near - 0.2)


def _in_room(house, room):
    """A point that is farthest from the walls of a room, at the height of ears."""
    from scipy.ndimage import distance_transform_edt

    navigation = house.navigation
    level = int(np.argmax((navigation.room == room).any(axis=(1, 2))))
    bordered = np.pad(navigation.room[level] == room, 1)  # the edge of the grid is a wall, too
    inside = np.asarray(distance_transform_edt(bordered))[1:-1, 1:-1]
    row, column = np.unravel_index(np.argmax(inside), inside.shape)
    plan = navigation.origin + (np.array([column, row]) + 0.5) * navigation.cell
    return jnp.asarray([*plan, house.rooms.floor[room] + 1.5], jnp.float32)
