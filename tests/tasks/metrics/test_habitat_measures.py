"""Habitat's measures, written again from its documentation in NumPy, over walks in homes of 1, 2 and 3 storeys.

The definitions are those of Anderson et al., "On Evaluation of Embodied Navigation Agents", 2018 (arXiv:1807.06757),
and of Habitat's configuration reference. Nothing here reads a metric, a distance or a path length of the package: only
positions that agents observe, actions, contacts, and which cells of the houses can be walked.

- distance to goal: length of the shortest path from the agent to the goal [m];
- success: the agent has called `stop`, and its distance to the goal is within the success distance;
- SPL: success times l / max(l, p), with the distance l at the start and the length p of the agent's path;
- soft SPL: the same with max(0, 1 - d / l) instead of success, with the distance d at the end;
- collisions: number of forward moves that an obstacle blocked; turns and stops beside one do not count.
"""

from dataclasses import dataclass

import gymnasium
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from parted import parted
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import KDTree
from storey_homes import homes_bank

import home_mjx
from home_mjx.adapters.gymnasium import GymVectorEnv
from home_mjx.tasks import add_expert, sample_episodes

HOMES = ("one storey", "straight", "corner", "above one another")
NUM, STEPS = 48, 60
SUCCESS_DISTANCE = 0.6  # [m], so that some walks succeed
STOP, FORWARD, LEFT, RIGHT = range(4)
CELL_TOLERANCE = 0.12  # [m], paths of a grid are known to about a cell
MAX_STAIR_RISE = 0.35  # [m], between cells beside one another


class WalkableGraph:
    """Shortest paths over the walkable cells of a house: 8 neighbours, no cut corners, stairs from storey to storey."""

    def __init__(self, bank, house):
        navigation = bank.navigation
        first, count = int(navigation.first_cell[house]), int(navigation.num_cells[house])
        number = np.asarray(navigation.cell[house]) - first
        free = (number >= 0) & (number < count)
        at = np.argwhere(free)
        index = np.full(free.shape, -1)
        index[free] = np.arange(len(at))
        height = np.asarray(navigation.height)[np.asarray(navigation.cell[house])[free]]
        plan = np.asarray(navigation.origin[house]) + (at[:, :0:-1] + 0.5) * bank.spec.cell
        self.place = np.column_stack([plan, height])
        pairs = []
        for level, row, column in np.argwhere(free):
            for storey in range(len(free)):
                for dy in (-1, 0, 1):
                    for dx in (-1, 0, 1):
                        y, x = row + dy, column + dx
                        if not (0 <= y < free.shape[1] and 0 <= x < free.shape[2]) or not free[storey, y, x]:
                            continue
                        if dy and dx and not (free[storey, row, x] and free[storey, y, column]):
                            continue
                        pairs.append((index[level, row, column], index[storey, y, x]))
        a, b = np.array(pairs).T
        near = (np.abs(height[a] - height[b]) <= MAX_STAIR_RISE) & (a != b)
        a, b = a[near], b[near]
        length = np.maximum(np.linalg.norm(self.place[a] - self.place[b], axis=1), 1e-6)
        self.ways = csr_matrix((length, (a, b)), shape=(len(at),) * 2)
        self.tree = KDTree(self.place)

    def distances(self, goal, points):
        """Lengths of the shortest paths from points to a goal [m]: the nearest cells, and the way to them."""
        from_goal = dijkstra(self.ways, indices=self.tree.query(goal)[1])
        away, cells = self.tree.query(points, k=9)
        return (away + from_goal[cells]).min(axis=-1)


@dataclass
class Walks:
    """What an outsider records: N walks of T steps."""

    bank: object
    house: np.ndarray  # (N,)
    goal: np.ndarray  # (N, 3) [m]
    feet: np.ndarray  # (T + 1, N, 3) [m]
    action: np.ndarray  # (T, N)
    touched: np.ndarray  # (T, N)
    ended: np.ndarray  # (T + 1, N), over after this many steps
    metrics: dict  # name -> (T + 1, N)


@pytest.fixture(scope="module", params=["kinematic", pytest.param("fused", marks=pytest.mark.slow)])
def walks(request):
    """Every other walker follows the expert most of the time, the others turn and go at random and stop sometimes."""
    bank = homes_bank(HOMES)
    short, long = (sample_episodes(bank, NUM // 2, seed, **limits) for seed, limits in enumerate(LIMITS))
    rows = jax.tree.map(lambda a, b: jnp.concatenate([a, b]), short, long)
    options = {"actions": "discrete", "stop": True, "success_distance": SUCCESS_DISTANCE, "sensors": ("state",)}
    env = home_mjx.make("PointNav-v0", bank, impl=request.param, episode_length=STEPS, **options)
    env = add_expert(env).with_tasks(rows)
    reset, step = parted(env.core, batched=True)
    state = reset(env.params, jax.random.split(jax.random.key(0), NUM), None, jnp.arange(NUM))
    random = np.random.default_rng(0)
    states, actions = [jax.device_get(state)], []
    for _ in range(STEPS):
        drawn = random.choice([STOP, FORWARD, LEFT, RIGHT], NUM, p=[0.02, 0.58, 0.2, 0.2])
        follows = (np.arange(NUM) % 2 == 0) & (random.random(NUM) < 0.9)
        actions.append(np.where(follows, states[-1].obs["expert"], drawn).astype(np.int32))
        state = step(env.params, state, jnp.asarray(actions[-1]))
        states.append(jax.device_get(state))
    return Walks(
        bank,
        np.asarray(rows.house),
        np.asarray(bank.navigation.goal)[rows.house, rows.columns["goal"]],
        np.stack([s.obs["state"][:, :3] for s in states]) - [0, 0, env.config.body.height / 2],
        np.stack(actions),
        np.stack([s.obs["state"][:, 9] > 0.5 for s in states[1:]]),
        np.maximum.accumulate(np.stack([s.terminated | s.truncated for s in states])),
        {name: np.stack([s.metrics[name] for s in states]) for name in states[0].metrics},
    )


LIMITS = {"min_length": 0.3, "max_length": 4.0}, {"min_length": 4.0}


@pytest.fixture(scope="module")
def distance(walks):
    """Distances to the goal (T + 1, N) by the outsider's graph [m]."""
    graphs = [WalkableGraph(walks.bank, house) for house in range(len(HOMES))]
    each = [graphs[h].distances(walks.goal[i], walks.feet[:, i]) for i, h in enumerate(walks.house)]
    return np.stack(each, axis=1)


@pytest.fixture(scope="module")
def counted(walks):
    """Steps that count (T, N): those of a running episode, the last one included."""
    return ~walks.ended[:-1]


def test_walks_are_of_every_kind(walks, counted):
    """Otherwise the comparisons below would show little."""
    height = np.where(walks.ended, walks.feet[0, :, 2], walks.feet[..., 2])
    success = walks.metrics["success"].max(axis=0)
    assert 0.2 < success.mean() < 0.9
    assert np.ptp(height, axis=0).max() > 1.0  # somebody uses stairs
    assert (walks.touched & counted).any(axis=0).sum() > 5
    assert walks.ended[-1].all()
    assert not walks.ended[-2].all()  # some walk until time is up


def test_distance_to_goal(walks, distance):
    running = np.vstack([~walks.ended[:1], ~walks.ended[:-1]])
    error = np.abs(walks.metrics["distance"] - distance)
    bound = CELL_TOLERANCE + 0.02 * distance
    assert (error <= bound)[running].all(), np.argwhere((error > bound) & running)[:5]


def test_success(walks, counted):
    """`stop` within the success distance, by the distance that the agent is paid for."""
    near = walks.metrics["distance"][1:] <= SUCCESS_DISTANCE
    succeeded = (walks.action == STOP) & near & counted
    np.testing.assert_array_equal(walks.metrics["success"][1:][counted], succeeded[counted])


def test_spl_and_soft_spl(walks, counted):
    steps = np.linalg.norm(np.diff(walks.feet, axis=0), axis=-1)
    walked = np.cumsum(np.where(counted, steps, 0), axis=0)
    start, left = walks.metrics["distance"][0], walks.metrics["distance"][1:]
    ratio = start / np.maximum(start, walked)
    soft = np.maximum(0, 1 - left / start)
    for name, wanted in (("spl", walks.metrics["success"][1:] * ratio), ("soft_spl", soft * ratio)):
        np.testing.assert_allclose(walks.metrics[name][1:][counted], wanted[counted], atol=2e-4, err_msg=name)
    assert all(np.isfinite(x).all() for x in walks.metrics.values())


def test_spl_by_the_outsiders_own_distances(walks, distance, counted):
    """With no number of the package: the mean over episodes, to the accuracy of a grid."""
    last = np.argmax(walks.ended, axis=0)
    at = np.arange(NUM)
    steps = np.linalg.norm(np.diff(walks.feet, axis=0), axis=-1)
    walked = np.sum(np.where(counted, steps, 0), axis=0)
    called = walks.action[last - 1, at] == STOP
    clear = np.abs(distance[last, at] - SUCCESS_DISTANCE) > CELL_TOLERANCE  # the distance leaves no doubt
    success = called & (distance[last, at] <= SUCCESS_DISTANCE)
    ratio = distance[0] / np.maximum(distance[0], walked)
    np.testing.assert_array_equal(walks.metrics["success"][last, at][clear], success[clear])
    assert clear.mean() > 0.7
    np.testing.assert_allclose((success * ratio)[clear].mean(), walks.metrics["spl"][last, at][clear].mean(), atol=0.03)


def test_collisions(walks, counted):
    """Moves in contact, no turns; whoever is kept from walking its 25 cm has touched something."""
    collided = walks.touched & counted & (walks.action == FORWARD)
    np.testing.assert_array_equal(walks.metrics["collisions"][1:][counted], np.cumsum(collided, axis=0)[counted])
    assert (walks.touched & counted & ~collided).any()  # turns and stops beside an obstacle
    moved = np.linalg.norm(np.diff(walks.feet, axis=0)[..., :2], axis=-1)
    kept = (walks.action == FORWARD) & (moved < 0.1) & counted
    assert walks.touched[kept].all()
    assert kept.any()


def test_gymnasium_counts_the_same_returns_and_lengths():
    """`RecordEpisodeStatistics`: r is the sum of the rewards of an episode, l the number of its steps."""
    options = {"impl": "kinematic", "sensors": ("state",), "episode_length": 4, "houses": homes_bank(HOMES)}
    env = gymnasium.wrappers.vector.RecordEpisodeStatistics(GymVectorEnv(3, **options))
    env.reset(seed=0)
    total, length = np.zeros(3), np.zeros(3)
    for _ in range(9):
        _, reward, terminated, truncated, info = env.step(env.action_space.sample())
        total, length = total + reward, length + 1
        done = terminated | truncated
        if done.any():
            np.testing.assert_allclose(info["episode"]["r"][done], total[done], rtol=1e-6)
            np.testing.assert_array_equal(info["episode"]["l"][done], length[done])
            assert (truncated == (length == 4))[done & ~terminated].all()
            assert not (terminated & truncated).any()
        total, length = np.where(done, 0, total), np.where(done, 0, length)
