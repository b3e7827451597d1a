"""The lights of houses: of lamps as the dataset lists them, of windows, and of rooms that have none."""

import numpy as np
import pytest
from handmade import shoebox

from home_mjx.geometry.meshes import box_triangles, make_model
from home_mjx.geometry.polygons import find_innermost_point, is_inside_polygon
from home_mjx.scene_compile.lighting.lights import (
    LightOptions,
    LightSource,
    _aim,
    build_lights,
    compute_ambient_irradiance,
    find_lamp_sources,
)
from home_mjx.scene_compile.objects.placed_objects import PlacedObject
from home_mjx.schema.house import Light, Material, ModelInfo, ObjectNode

PLAIN = (Material("a"),)


def placed(lights=(), fine="chandelier", pose=None, slots=PLAIN, room=0, half=(0.1, 0.1, 0.1)):
    """An object of one box, with lights."""
    model = make_model("m", box_triangles(np.zeros(3), np.array(half, float)))
    pose = np.eye(3, 4) if pose is None else pose
    node = ObjectNode("0_1", 1, "levels[0].nodes[1]", None, "m", "m", np.eye(4), lights=tuple(lights))
    info = ModelInfo("m", fine, fine)
    return PlacedObject(node, info, model, model, (), slots, pose, 1, 0, room, instance=4)


def point(x=0.0, y=0.0, z=0.0, power=10.0, kind="point", **more):
    return Light(kind, power, (1.0, 1.0, 1.0), (x, y, z), **more)


def flux_of(source, steps=400):
    """Numeric integral of the profile over all directions."""
    cosine = (np.arange(-steps, steps) + 0.5) / steps
    shape = np.where(cosine >= source.cutoff, np.maximum(cosine, 1e-12) ** source.exponent, 0)
    return 2 * np.pi * shape.sum() / steps * source.intensity


@pytest.mark.parametrize(
    "light",
    [
        point(),
        point(kind="spot", direction=(0, -1, 0), cutoff=1.57, dropoff=2.0),
        point(kind="spot", direction=(1, -1, 0), cutoff=0.5, dropoff=0.0),
        point(kind="spot", direction=(1, -1, 0), cutoff=2.0, dropoff=0.0),
        point(kind="spot", direction=(0, 0, 1), cutoff=3.14, dropoff=3.0),
        point(kind="line", direction=(0, -1, 0), cutoff=1.57, dropoff=1.0, end=(1.0, 0.0, 0.0)),
    ],
)
def test_all_power_is_given_off(light):
    item = placed([light])
    (source,) = find_lamp_sources(item)
    np.testing.assert_allclose(flux_of(source), 10.0, rtol=0.02)


def test_a_spot_whose_file_has_no_direction_or_zeros_shines_down():
    for direction in (None, (0.0, 0.0, 0.0)):
        np.testing.assert_allclose(_aim(point(kind="spot", direction=direction)), [0, 0, -1], atol=1e-12)


def test_lights_stand_in_the_model_s_frame_z_up():
    light = point(0.1, 0.2, 0.3, kind="line", end=(0.5, 0.2, 0.3), direction=(0.0, 0.0, 1.0), cutoff=1.0)
    item = placed([light])
    (source,) = find_lamp_sources(item)
    np.testing.assert_allclose(source.pos, [0.3, -0.3, 0.2])
    np.testing.assert_allclose(source.axis_u, [0.2, 0, 0])
    np.testing.assert_allclose(source.direction, [0, -1, 0])
    assert source.cutoff == pytest.approx(np.cos(1.0))
    assert source.instance == 4


def test_the_bulbs_of_a_chandelier_count_once():
    ring = [point(0.2 * np.cos(a), 0.0, 0.2 * np.sin(a)) for a in np.arange(6)]
    item = placed([*ring, point(3.0), point(0.0, kind="spot", direction=(0, -1, 0))])
    sources = list(find_lamp_sources(item))
    assert sorted(float(s.flux[0]) for s in sources) == [10.0, 10.0, 60.0]
    middle = np.mean([light.position for light in ring], axis=0)
    np.testing.assert_allclose(next(s for s in sources if s.flux[0] == 60).pos, [middle[0], -middle[2], 0], atol=1e-12)


GLASS = (Material("pane", (0.2, 0.6, 0.7), None, 0.5),)


@pytest.mark.parametrize(("y", "side"), [(2.55, -1), (-2.55, 1)])
def test_windows_shine_into_their_room(y, side):
    """A pane of 1.2 x 1 m and 1 cm in a wall of the shoebox, seen from either side."""
    rooms = shoebox().rooms
    pose = np.concatenate([np.eye(3), [[0.5], [y], [1.5]]], axis=1)
    item = placed(fine="window", pose=pose, slots=GLASS, half=(0.6, 0.005, 0.5), room=-1)
    lights = build_lights([item], rooms, LightOptions(room_power=0.0))
    assert lights.daylight.tolist() == [True]
    np.testing.assert_allclose(lights.direction, [[0, side, 0]])
    np.testing.assert_allclose(lights.area, 1.2)
    assert (lights.room.tolist(), lights.instance.tolist()) == ([0], [4])
    linear = ((np.array([0.2, 0.6, 0.7]) + 0.055) / 1.055) ** 2.4
    np.testing.assert_allclose(lights.intensity[0], 1.2 * (1 - 0.5 * (1 - linear)), rtol=1e-6)


@pytest.mark.parametrize("change", ["between rooms", "outdoors", "opaque", "no window"])
def test_what_is_no_window_to_the_open_gives_no_daylight(change):
    y = {"between rooms": 0.0, "outdoors": 8.0}.get(change, 2.55)
    pose = np.concatenate([np.eye(3), [[0.5], [y], [1.5]]], axis=1)
    slots = (Material("pane", (0.2, 0.6, 0.7), None, 1.0),) if change == "opaque" else GLASS
    fine = "vase" if change == "no window" else "window"
    item = placed(fine=fine, pose=pose, slots=slots, half=(0.6, 0.005, 0.5))
    lights = build_lights([item], shoebox().rooms, LightOptions(room_power=0.0))
    assert len(lights.room) == 0
    assert (lights.ambient[1:] == 0).all()


def test_rooms_without_a_lamp_get_a_light_under_their_ceiling():
    rooms = shoebox((4.0, 5.0, 2.6)).rooms
    lights = build_lights([], rooms, LightOptions(room_power=3.0))
    assert lights.room.tolist() == [0]
    np.testing.assert_allclose(lights.pos[0], [0, 0, 2.55], atol=0.2)
    assert lights.direction[0].tolist() == [0, 0, -1]
    np.testing.assert_allclose(np.pi * lights.intensity[0], 3.0 * 20, rtol=1e-6)
    lamp = placed([point()])
    assert len(build_lights([lamp], rooms, LightOptions()).room) == 1


def test_reflected_light_is_the_sum_of_the_reflections():
    rooms = shoebox((4.0, 5.0, 2.5)).rooms
    source = LightSource(np.zeros(3), np.array([30.0, 20.0, 10.0]), 0, 0)
    day = LightSource(np.zeros(3), np.array([7.0, 7.0, 7.0]), 0, 0, daylight=True)
    ambient = compute_ambient_irradiance([source, day], rooms)
    surface = 2 * 20 + 18 * 2.5
    bounced = sum(0.4**n for n in range(1, 60))
    np.testing.assert_allclose(ambient[1, 0], source.flux / surface * bounced, rtol=1e-6)
    np.testing.assert_allclose(ambient[1, 1], day.flux / surface * bounced, rtol=1e-6)
    np.testing.assert_allclose(ambient[0, 0], ambient[1, 0])


def test_the_middle_of_a_bent_room_lies_in_it():
    polygon = np.array([[0, 0], [6, 0], [6, 1.2], [1.2, 1.2], [1.2, 6], [0, 6]], float)
    assert not is_inside_polygon(polygon, (polygon.min(0) + polygon.max(0)) / 2)
    found = find_innermost_point(polygon)
    assert is_inside_polygon(polygon, found)
    assert min(abs(found - polygon).max(axis=1)) > 0.4


def test_houses_have_a_light_in_every_room_and_lamps_within_them(generated_bank):
    bank = generated_bank
    for house in range(bank.num_houses):
        instance = np.asarray(bank.lights.instance[house])
        real = instance >= 0
        assert real.sum() >= 3
        room = np.asarray(bank.lights.room[house])[real]
        daylight = np.asarray(bank.lights.daylight[house])[real]
        types = np.asarray(bank.navigation.room_type[house])
        assert set(room[~daylight]) >= set(range(int((types >= 0).sum())))
        assert daylight.any()
        ambient = np.asarray(bank.lights.ambient[house])
        assert (ambient[1 + np.unique(room), 0] > 0).all()
