"""Lights of glTF scenes: units, cones, and the objects that carry them."""

from dataclasses import replace

import numpy as np
import pytest
from gltf_files import two_rooms

from home_mjx.datasets import open_dataset
from home_mjx.datasets.gltf.scene_lights import MAX_LIGHTS, SceneLight, add_lights
from home_mjx.errors import DatasetError
from home_mjx.geometry.polygons import polygon_area
from home_mjx.schema.house import Light
from home_mjx.schema.lighting import LUMENS_PER_WATT


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))


def lit(tmp_path, *lights, place=(5.7, 0.7, 1.5), rotation=(0, 0, 0, 1), nodes=None):
    """Return the flat with a node for each light, or for those of the numbers `nodes`, at one place."""
    file = two_rooms()
    file.json["extensions"] = {"KHR_lights_punctual": {"lights": list(lights)}}
    for number in range(len(lights)) if nodes is None else nodes:
        own = {"KHR_lights_punctual": {"light": number}}
        file.node(name=f"l{number}", translation=list(place), rotation=list(rotation), extensions=own)
    return open_dataset(f"gltf:{file.write(tmp_path / 'flat.glb')}").load_house("flat")


def carried(house):
    return [(o, light) for level in house.levels for o in level.objects for light in o.lights]


def test_a_point_light_has_the_watts_of_its_candelas_and_hangs_on_the_nearest_object(tmp_path):
    house = lit(tmp_path, {"type": "point", "intensity": 20 * LUMENS_PER_WATT, "color": [1, 0.5, 0]})
    ((node, light),) = carried(house)
    assert node.model_id == "dining_table"
    assert light.power == pytest.approx(80 * np.pi)
    np.testing.assert_allclose(light.color, [1, 0.735357, 0], atol=1e-5)  # 0.5 in sRGB, IEC 61966-2-1
    place = node.transform[:3, :3] @ np.array(light.position) + node.transform[:3, 3]
    np.testing.assert_allclose(place, [5.7, 0.7, 1.5], atol=1e-9)


def test_a_spot_has_the_flux_of_its_cones_and_shines_along_its_minus_z(tmp_path):
    down = (-(0.5**0.5), 0, 0, 0.5**0.5)
    spot = {"innerConeAngle": 0.3, "outerConeAngle": 1.0}
    house = lit(tmp_path, {"type": "spot", "intensity": 1e5, "spot": spot}, rotation=down)
    ((node, light),) = carried(house)
    np.testing.assert_allclose(node.transform[:3, :3] @ np.array(light.direction), [0, -1, 0], atol=1e-9)
    x = np.linspace(np.cos(1.0), 1, 200_001)  # the specification's falloff, integrated by the trapezoidal rule
    fall = np.clip((x - np.cos(1.0)) / (np.cos(0.3) - np.cos(1.0)), 0, 1) ** 2
    flux = 2 * np.pi * np.trapezoid(fall, x) * 1e5 / LUMENS_PER_WATT
    assert light.power == pytest.approx(flux, rel=1e-6)
    own = np.trapezoid(x**light.dropoff, x)
    assert own == pytest.approx(np.trapezoid(fall, x), rel=1e-6)


def test_lights_of_no_plausible_power_are_scaled_and_directional_ones_are_noted(tmp_path):
    house = lit(tmp_path, {"type": "point"}, {"type": "point", "intensity": 3}, {"type": "directional"})
    powers = [light.power for _, light in carried(house)]
    floor = sum(polygon_area(room.shape.corners) for level in house.levels for room in level.rooms)
    assert sum(powers) == pytest.approx(3.0 * floor)  # W per m^2
    assert powers[1] == pytest.approx(3 * powers[0])
    notes = {p.element: p.message for p in house.problems}
    assert "scaled" in notes["lights"]
    assert any("directional" in text for text in notes.values())


@pytest.mark.parametrize(
    ("light", "message"),
    [
        ({"type": "area"}, "expected point, spot or directional"),
        ({"type": "spot", "spot": {"outerConeAngle": 2.0}}, "up to pi/2"),
        ({"type": "spot", "spot": {"innerConeAngle": 0.9, "outerConeAngle": 0.5}}, "to that of the outer cone"),
    ],
)
def test_broken_lights_are_located(tmp_path, light, message):
    with pytest.raises(DatasetError, match=message):
        lit(tmp_path, light)


@pytest.mark.parametrize(("count", "nodes"), [(MAX_LIGHTS + 1, ()), (1, [0] * (MAX_LIGHTS + 1))])
def test_lights_are_bounded_in_the_list_and_in_the_nodes_even_dark_ones(tmp_path, count, nodes):
    with pytest.raises(DatasetError, match="more than 1000 lights"):
        lit(tmp_path, *[{"type": "directional"}] * count, nodes=nodes)


def test_both_ends_of_a_line_move_to_the_frame_of_the_object_nearest_to_its_middle(tmp_path):
    house = lit(tmp_path, {"type": "directional"})
    ends = np.array([[1.2, 0.5, 1.25], [10.2, 0.9, 1.75]])  # its first end is in the chair, its middle in the table
    line = Light("line", 5.0, (1.0, 1.0, 1.0), tuple(ends[0]), end=tuple(ends[1]))
    levels = add_lights(house.path, house.levels, house.models, [SceneLight("tube", line)])
    ((node, light),) = carried(replace(house, levels=levels))
    assert node.model_id == "dining_table"
    moved = np.array([light.position, light.end]) @ node.transform[:3, :3].T + node.transform[:3, 3]
    np.testing.assert_allclose(moved, ends, atol=1e-9)
    with pytest.raises(DatasetError, match="more than 1000 lights"):
        add_lights(house.path, house.levels, house.models, [SceneLight("tube", line)] * (MAX_LIGHTS + 1))


def test_a_spot_whose_cones_are_equal_is_uniform(tmp_path):
    spot = {"innerConeAngle": 0.8, "outerConeAngle": 0.8}
    ((_, light),) = carried(lit(tmp_path, {"type": "spot", "intensity": 1e5, "spot": spot}))
    assert light.power == pytest.approx(2 * np.pi * (1 - np.cos(0.8)) * 1e5 / LUMENS_PER_WATT)
    assert (light.dropoff, light.cutoff) == (0, 0.8)
