"""The prediction of `benchmarks/weak_scaling.py`: greatest of normal numbers, what is measured, and what only adds."""

import math

import pytest

from benchmarks.weak_scaling import DEVICES_PER_HOST, LATENCY, expected_maximum, predict

ONE = {"devices": 1, "update_s": 0.5, "averages": 8, "average_s": 0.0, "gradient_bytes": 10e6, "batch_per_device": 1000}
MOST = ONE | {"devices": 8, "update_s": 0.55, "average_s": 1e-3}


@pytest.mark.parametrize(("num", "exact"), [(1, 0.0), (2, 1 / math.sqrt(math.pi)), (3, 1.5 / math.sqrt(math.pi))])
def test_greatest_of_normal_numbers(num: int, exact: float):
    assert expected_maximum(num) == pytest.approx(exact, abs=0.01)


def test_the_model_repeats_its_measurements():
    for line in (ONE, MOST):
        found = predict([ONE, MOST], line["devices"], 40e9)
        assert found["steps_per_second"] == pytest.approx(line["devices"] * 1000 / line["update_s"])


def test_hosts_add_their_averages_and_a_longer_wait():
    """By hand, of 64 devices: eight hosts in a ring, and the deviation that explains 42 ms of waiting for one of 8."""
    found = predict([ONE, MOST], 8 * DEVICES_PER_HOST, 40e9)
    ring = 14 * (10e6 / 8 / 40e9 + LATENCY)
    assert found["averages_s"] == pytest.approx(8 * (1e-3 + ring))
    assert found["wait_s"] == pytest.approx(0.042 / 1.4236 * 2.344, rel=0.02)  # tables of order statistics
    assert found["efficiency"] == pytest.approx(0.5 / (0.5 + found["averages_s"] + found["wait_s"]))


def test_a_prediction_needs_one_device():
    with pytest.raises(ValueError, match="one device"):
        predict([MOST], 16, 40e9)
