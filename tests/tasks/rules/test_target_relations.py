"""Gaps between targets, and what rests on what, against loops over all pairs of instances."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.tasks.rules.features import (
    MAX_SUPPORT_GAP,
    TARGETS_PER_ROUND,
    UNREACHABLE_DISTANCE,
    target_relations,
)
from home_mjx.tasks.rules.resolve import ResolvedTargets

INSTANCES, DESCRIPTORS = 40, 4


def drawn_boxes(random: np.random.Generator) -> np.ndarray:
    """Boxes of up to 1 m; half of them stand on another one."""
    low = random.uniform(0, 4, (INSTANCES, 3))
    high = low + random.uniform(0.1, 1.0, (INSTANCES, 3))
    for top in range(INSTANCES // 2):
        under = random.integers(INSTANCES // 2, INSTANCES)
        size = high[top] - low[top]
        low[top] = [*random.uniform(low[under, :2], high[under, :2]) - size[:2] / 2, high[under, 2]]
        high[top] = low[top] + size
    return np.stack([low, high], axis=1).astype(np.float32)


def loops(instance: np.ndarray, boxes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    gap, on = np.full((DESCRIPTORS,) * 2, UNREACHABLE_DISTANCE), np.zeros((DESCRIPTORS,) * 2, bool)
    for i, j in np.ndindex(gap.shape):
        for a in np.flatnonzero(instance[i]):
            for b in np.flatnonzero(instance[j]):
                if a == b:
                    continue
                (low, high), (floor, top) = boxes[a], boxes[b]
                apart = np.maximum(np.maximum(floor - high, low - top), 0)
                gap[i, j] = min(gap[i, j], np.linalg.norm(apart))
                middle = (low + high) / 2
                over = (middle[:2] >= floor[:2]).all() and (middle[:2] <= top[:2]).all()
                on[i, j] |= over and (floor[2] + top[2]) / 2 <= low[2] <= top[2] + MAX_SUPPORT_GAP
    return gap, on


@pytest.mark.parametrize("share", [0.0, 0.05, 0.3, 1.0])
def test_relations_are_those_of_all_pairs(share):
    random, found = np.random.default_rng(int(100 * share)), jax.jit(target_relations)
    for _ in range(5):
        instance, boxes = random.random((DESCRIPTORS, INSTANCES)) < share, drawn_boxes(random)
        instance[0] = False  # a descriptor of a room
        targets = ResolvedTargets(instance=jnp.asarray(instance), room=jnp.zeros((DESCRIPTORS, 3), bool))
        gap, on = found(targets, jnp.asarray(boxes))
        expected = loops(instance, boxes)
        np.testing.assert_allclose(gap, expected[0], atol=1e-5)
        np.testing.assert_array_equal(on, expected[1])
    assert share < 1 or (instance.any(axis=0).sum() > TARGETS_PER_ROUND and on.any())


def test_environments_of_a_batch_have_as_many_rounds_as_they_need():
    random = np.random.default_rng(3)
    instance = np.stack([random.random((DESCRIPTORS, INSTANCES)) < share for share in (0, 0.02, 1.0)])
    boxes = np.stack([drawn_boxes(random) for _ in instance])
    targets = ResolvedTargets.build_unchecked(instance=jnp.asarray(instance), room=jnp.zeros((3, DESCRIPTORS, 3), bool))
    found = jax.jit(jax.vmap(target_relations))(targets, jnp.asarray(boxes))
    for number in range(len(instance)):
        gap, on = loops(instance[number], boxes[number])
        np.testing.assert_allclose(found[0][number], gap, atol=1e-5)
        np.testing.assert_array_equal(found[1][number], on)
