"""What notebooks show: plans, tables and curves, read back."""

import base64
import io
import re

import numpy as np
import pytest
from generated import flat_id, generate_flats
from handmade import two_rooms
from PIL import Image

from home_mjx.bank.bank import HouseBank
from home_mjx.core.notebook_html import format_curves, format_plan, format_table
from home_mjx.datasets.registry import open_dataset
from home_mjx.viewer.pictures.response_view import ResponseView


def image_of(html: str) -> np.ndarray:
    data = re.search(r"base64,([^\"]+)", html)
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(data[1]))))


def test_a_plan_has_north_up_and_a_colour_for_each_room():
    rooms = np.full((4, 6), -1)
    rooms[1, 1:4], rooms[2, 1:3] = 0, 1  # room 1 is north of room 0
    image = image_of(format_plan(rooms, "a <plan>"))
    assert image.shape == (2, 3, 3)
    assert (image[1] == image[1, 0]).all()
    assert not np.array_equal(image[0, 0], image[1, 0])
    assert (image[0, 2] == 255).all()
    assert "a &lt;plan&gt;" in format_plan(rooms, "a <plan>")
    assert format_plan(np.full((2, 2), -1), "none") == ""


def test_curves_fill_their_frame():
    html = format_curves("t", np.array([2.0, 3.0, 4.0]), {"a": np.array([1.0, np.nan, 3.0])}, (100, 50))
    assert 'points="0.0,50.0 100.0,0.0"' in html
    assert "x 2 to 4, y 1 to 3" in html


def test_a_bank_shows_its_rooms_and_area():
    html = HouseBank.from_compiled([two_rooms()])._repr_html_()
    assert "<td>rooms of the first storey</td><td>2</td>" in html
    area = float(re.search(r">(\d+) m² a house", html)[1])
    assert 10 < area < 40
    assert len(np.unique(image_of(html).reshape(-1, 3), axis=0)) >= 2


def test_results_have_mean_and_error():
    pytest.importorskip("flax", reason="needs the extra `train`")
    from home_mjx.training.evaluation import Results

    html = Results({"success": np.array([1.0, 0.0, 1.0, 0.0]), "spl": np.array([np.nan])})._repr_html_()
    assert "<td>success</td><td>0.500 ± 0.250</td>" in html
    assert "<td>spl</td><td>unknown</td>" in html
    assert "&lt;" in format_table("<", {})


def test_the_decay_of_exponential_noise_is_its_own():
    rate, t60 = 16_000, 0.5
    time = np.arange(rate) / rate
    noise = np.random.default_rng(0).normal(size=(2, rate)) * 10 ** (-3 * time / t60)
    view = ResponseView(noise, rate)
    assert view.t20 == pytest.approx([t60, t60], rel=0.03)
    assert view.decay_curve[:, 0] == pytest.approx(0.0)
    html = view._repr_html_()
    assert html.count("<polyline") == 4
    assert np.isnan(ResponseView(np.ones((1, 100)), rate).t20).all()


def test_a_house_shows_its_rooms_and_plan(tmp_path):
    generate_flats(tmp_path, [0])
    house = open_dataset(tmp_path).load_house(flat_id(0))
    html = house._repr_html_()
    assert f"<b>House {house.id}</b>" in html
    for level in house.levels:
        assert html.count("objects</td>") == sum(len(level.rooms) for level in house.levels)
        floors = [room.floor for room in level.rooms if room.floor is not None]
        assert html.count("<path") >= len(floors) > 1
        assert html.count("M") >= sum(len(floor.faces) for floor in floors)
    widths = [float(text.split('"')[0]) for text in html.split('<svg width="')[1:]]
    assert widths
    assert max(widths) <= 180
