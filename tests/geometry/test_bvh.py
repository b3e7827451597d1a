"""The tree holds every primitive once, bounds it tightly, stays shallow, and prunes like a good tree."""

import numpy as np
import pytest

from home_mjx.errors import ConfigError, DatasetError
from home_mjx.geometry.bvh import build_tree, build_triangle_tree
from home_mjx.schema.compiled import MAX_DEPTH


def random_boxes(rng, n, spread=5.0, size=0.2):
    center = rng.uniform(-spread, spread, size=(n, 1, 3))
    return (center + rng.uniform(0, size, size=(n, 1, 3)) * np.array([[[-1.0], [1.0]]])).astype(np.float32)


def leaves_below(tree, boxes, node=0):
    """Primitives of every leaf below a node, in order; checks the node's own boxes on the way."""
    leaves = []
    for side in range(2):
        code = int(tree.child[node, side])
        if code >= 0:
            assert code > node, "children must follow their parent"
            below = leaves_below(tree, boxes, code)
        else:
            below = [list(range(~code >> 4, (~code >> 4) + (~code & 15)))]
        found = [row for leaf in below for row in leaf]
        low, high = (boxes[found, 0].min(axis=0), boxes[found, 1].max(axis=0)) if found else (np.inf, -np.inf)
        slack = 2e-6 * np.abs(boxes).max(initial=0)
        assert (tree.box[node, side, :3] <= low).all()
        assert (tree.box[node, side, 3:] >= high).all()
        np.testing.assert_allclose(tree.box[node, side, :3], low, rtol=0, atol=slack)
        np.testing.assert_allclose(tree.box[node, side, 3:], high, rtol=0, atol=slack)
        leaves += below
    return leaves


def depth(tree):
    level = np.zeros(len(tree.child), int)
    for node, codes in enumerate(tree.child):
        level[codes[codes >= 0]] = level[node] + 1
    return level.max() + 1


def assert_valid(boxes, leaf_size):
    tree, order = build_tree(boxes, leaf_size)
    leaves = leaves_below(tree, boxes[order])
    assert sorted(order) == list(range(len(boxes)))
    assert [row for leaf in leaves for row in leaf] == list(range(len(boxes)))
    assert max(len(leaf) for leaf in leaves) <= leaf_size
    assert depth(tree) <= MAX_DEPTH
    return tree


@pytest.mark.parametrize("n", [0, 1, 2, 4, 5, 16, 17, 300])
@pytest.mark.parametrize("leaf_size", [1, 4, 15])
def test_every_primitive_is_in_one_leaf_inside_tight_boxes(rng, n, leaf_size):
    assert_valid(random_boxes(rng, n), leaf_size)


def test_identical_flat_and_point_boxes(rng):
    point = np.zeros((100, 2, 3), np.float32)
    assert_valid(point, 4)
    flat = random_boxes(rng, 100)
    flat[:, :, 2] = 1.5
    assert_valid(flat, 4)


def test_exponentially_spaced_boxes_stay_within_the_depth_limit():
    # Each cheapest split of such a row cuts off only a few boxes, so without a limit the tree grows like a list.
    boxes = np.zeros((1200, 2, 3), np.float32)
    boxes[:, :, 0] = np.maximum(3.0 ** -np.arange(1200.0), 1e-36)[:, None] * 1e36
    assert_valid(boxes, 1)


def test_leaves_are_parted_only_where_it_pays(rng):
    apart = np.repeat(np.array([0.0, 50.0]), 2)[:, None, None] + random_boxes(rng, 4, spread=0.1)
    tree, order = build_tree(apart.astype(np.float32))
    leaves = leaves_below(tree, apart[order].astype(np.float32))
    assert sorted(sorted(order[leaf].tolist()) for leaf in leaves if leaf) == [[0, 1], [2, 3]]
    together = np.broadcast_to(random_boxes(rng, 1), (4, 2, 3)).copy()
    assert [len(leaf) for leaf in leaves_below(*build_tree(together)[:1], together)] == [4, 0]


def test_no_other_split_of_the_root_is_cheaper(rng):
    boxes = random_boxes(rng, 60, size=3.0)
    tree, order = build_tree(boxes)

    def half_area(rows):
        a, b, c = boxes[rows, 1].max(axis=0) - boxes[rows, 0].min(axis=0)
        return a * b + b * c + c * a

    def cost(left, right):
        return len(left) * half_area(left) + len(right) * half_area(right)

    first = [row for leaf in leaves_below(tree, boxes[order], int(tree.child[0, 0])) for row in leaf]
    found = cost(order[first], np.setdiff1d(order, order[first]))
    by_axis = [np.argsort(boxes.sum(axis=1)[:, axis]) for axis in range(3)]
    best = min(cost(rows[:k], rows[k:]) for rows in by_axis for k in range(1, 60))
    np.testing.assert_allclose(found, best, rtol=1e-5)


def test_a_query_of_the_tree_equals_brute_force_and_visits_few_nodes(rng):
    boxes = random_boxes(rng, 4000, size=0.05)
    tree, order = build_tree(boxes)
    visited = 0
    for low in rng.uniform(-5, 4.5, size=(20, 3)):
        query = np.array([low, low + 0.5])
        found, stack = set(), [0]
        while stack:
            node = stack.pop()
            visited += 1
            for side in range(2):
                box, code = tree.box[node, side].reshape(2, 3), int(tree.child[node, side])
                if (box[0] > query[1]).any() or (box[1] < query[0]).any():
                    continue
                if code >= 0:
                    stack.append(code)
                else:
                    found |= set(order[(~code >> 4) : (~code >> 4) + (~code & 15)].tolist())
        overlap = (boxes[:, 0] <= query[1]).all(axis=1) & (boxes[:, 1] >= query[0]).all(axis=1)
        assert set(np.flatnonzero(overlap).tolist()) <= found
    assert visited / 20 < 60, "about 4 boxes overlap such a query; a bad tree visits hundreds of nodes"


def test_triangle_tree_bounds_its_triangles(rng):
    triangles = (rng.uniform(-5, 5, size=(500, 1, 3)) + rng.normal(size=(500, 3, 3)) * 0.1).astype(np.float32)
    tree, order = build_triangle_tree(triangles)
    boxes = np.stack([triangles.min(axis=1), triangles.max(axis=1)], axis=1)
    leaves_below(tree, boxes[order])


def test_the_same_input_gives_the_same_tree(rng):
    boxes = random_boxes(rng, 500)
    (a, order_a), (b, order_b) = build_tree(boxes), build_tree(boxes.copy())
    np.testing.assert_array_equal(a.box, b.box)
    np.testing.assert_array_equal(a.child, b.child)
    np.testing.assert_array_equal(order_a, order_b)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_box_that_is_not_finite_is_named(rng, bad):
    boxes = random_boxes(rng, 10)
    boxes[7, 1, 0] = bad
    with pytest.raises(DatasetError, match=r"boxes\[7\]"):
        build_tree(boxes)


def test_a_box_inside_out_is_named(rng):
    boxes = random_boxes(rng, 10)
    boxes[3] = boxes[3, ::-1]
    with pytest.raises(DatasetError, match=r"boxes\[3\]"):
        build_tree(boxes)


@pytest.mark.parametrize("leaf_size", [0, 16])
def test_leaf_size_out_of_range(rng, leaf_size):
    with pytest.raises(ConfigError, match="leaf_size"):
        build_tree(random_boxes(rng, 3), leaf_size)
