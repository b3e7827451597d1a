"""Physics walks the diagonal steps that paths take past cells that lack only the margin."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox

import home_mjx
from home_mjx import HouseBank
from home_mjx.geometry.geodesic import distance_fields
from home_mjx.houses import load_bank
from home_mjx.navigation.grid import cell_at_feet, is_passable_cell
from home_mjx.schema.compiled import FIELD_UNIT
from home_mjx.tasks import add_expert
from home_mjx.tasks.base.state import Episodes
from home_mjx.tasks.rules.cell_graph import CellGraph
from home_mjx.training.evaluation import evaluate, expert_policy

HOUSES = ("procedural:3?preset=flat&seed=71000", "procedural:1?seed=72005")  # seeds on which nothing was tuned
NUM_EPISODES = 48
APPROACH = 0.5  # [m], before the diagonal
ROUNDING = 0.01  # [m], of distances along one path
ON_THE_WAY = 0.3  # [m], from the diagonal to the goal
SUCCESS_DISTANCE = 0.2  # [m]
SPEED, TURN = 0.1, 25  # [m] in a step; number of steps for turns


class Grid:
    """The home region of a house, its passable cells and its distances to the goals [m]; strict ones on one storey."""

    def __init__(self, bank: HouseBank, house: int) -> None:
        n, self.house, self.cell = jax.tree.map(np.asarray, bank.navigation), house, bank.spec.cell
        self.first = int(n.first_cell[house])
        rows = slice(self.first, self.first + int(n.num_cells[house]))
        self.coords, self.known = n.cell_coords[rows].astype(int), n.field[rows] * FIELD_UNIT
        self.home = np.zeros(n.room.shape[1:], bool)
        self.home[tuple(self.coords.T)] = True
        self.number = np.where(self.home, np.cumsum(self.home).reshape(self.home.shape) - 1, -1)
        self.passable = np.asarray(is_passable_cell(bank, jnp.int32(house), bank.navigation.cell[house]))
        goals = jax.vmap(lambda at: cell_at_feet(bank, jnp.int32(house), at))(bank.navigation.goal[house])
        self.strict = distance_fields(self.home, np.asarray(goals), self.cell)
        graph = CellGraph(jax.tree.map(np.asarray, bank), house)
        self.place, self.at_leaf = graph.place, graph.at_leaf

    def diagonals(self) -> np.ndarray:
        """Pairs of home cells, by number, that touch at a corner; a cell beside it is passable only."""
        found = []
        for level, y, x in self.coords:
            for dx in (-1, 1):
                here, there = (level, y, x), (level, y + 1, x + dx)
                beside = [(level, y + 1, x), (level, y, x + dx)]
                if self.home[there] and not all(self.home[c] for c in beside) and all(self.passable[c] for c in beside):
                    found += [(self.number[here], self.number[there]), (self.number[there], self.number[here])]
        return np.array(found)

    def crossing(self, begin: int, end: int, min_gain: float) -> tuple[int, int, float] | None:
        """Start cell, goal and heading of a path over a diagonal; None if none is shorter than without such steps."""
        known, step = self.known, np.hypot(self.cell, self.cell)
        ahead = abs(known[begin] - known[end] - step) < ROUNDING
        ahead &= (self.strict[begin] > known[begin] + min_gain) & (known[end] > ON_THE_WAY)
        ahead &= np.isfinite(self.strict[begin])
        if not ahead.any():
            return None
        goal = int(np.where(ahead, known[begin], np.inf).argmin())
        before = distance_fields(self.home, self.coords[[begin]], self.cell, passable=self.passable)[:, 0]
        way = np.flatnonzero((abs(before + known[begin, goal] - known[:, goal]) < ROUNDING) & (before < APPROACH))
        start = way[before[way].argmax()]
        along = distance_fields(self.home, self.coords[[start]], self.cell, passable=self.passable)[:, 0]
        if self.at_leaf[abs(along + known[:, goal] - known[start, goal]) < ROUNDING].any():
            return None  # experts go round leaves
        x, y = (self.place[end] - self.place[start])[:2]
        return int(start), goal, float(np.arctan2(y, x))


def crossings(
    bank: HouseBank, house: int, rng: np.random.Generator, count: int, min_gain: float = 2 * ROUNDING
) -> list[tuple]:
    """House, start [m], heading [rad], goal and length [m] of paths over different diagonals."""
    grid, found = Grid(bank, house), {}
    for begin, end in rng.permutation(grid.diagonals()):
        if len(found) < count and (path := grid.crossing(begin, end, min_gain)):
            start, goal, heading = path
            found.setdefault((start, goal), (house, grid.place[start], heading, goal, grid.known[start, goal]))
    return list(found.values())


def check_walks(bank: HouseBank, paths: list[tuple], impl: str, actions: str) -> None:
    """Experts arrive in time, and what they walked is the difference of the distances."""
    house, start, yaw, goal, length = (np.array(column) for column in zip(*paths, strict=True))
    rows = Episodes(
        house=jnp.asarray(house, jnp.int32),
        start=jnp.asarray(start, jnp.float32),
        yaw=jnp.asarray(yaw, jnp.float32),
        columns={"goal": jnp.asarray(goal, jnp.int32), "length": jnp.asarray(length, jnp.float32)},
    )
    options = {"sensors": ("state",), "num_agents": 1, "success_distance": SUCCESS_DISTANCE, "episode_length": 200}
    env = home_mjx.make("PointNav-v0", bank, impl=impl, actions=actions, **options).with_tasks(rows)
    figures = evaluate(add_expert(env), expert_policy, None, len(paths))
    assert figures["success"].tolist() == [1.0] * len(paths)
    gone = length - figures["distance"]
    assert (figures["walked"] < 1.1 * gone + 0.2).all()
    assert (figures["walked"] > 0.9 * gone - 0.1).all()  # a straight line is up to 8 % shorter than a path over cells
    assert (figures["episode_steps"] < 1.3 * gone / SPEED + TURN).all()


@pytest.fixture(scope="module")
def pinched() -> HouseBank:
    """A room cut in two by two blocks, of which two corners leave a gap: home cells touch there at a corner only."""
    low, high = 0.13, 0.73  # [m]: the diagonal is from (-0.05, -0.05) to (0.05, 0.05)
    right = Furniture(((low + 3.0) / 2, -(low + high) / 2), size=(3.0 - low, high - low, 1.0))
    left = Furniture((-(low + 2.2) / 2, (low + high) / 2), size=(2.2 - low, high - low, 1.0))
    return HouseBank.from_compiled([shoebox(furniture=[right, left])])


@pytest.fixture(scope="module", params=HOUSES)
def homes(request) -> HouseBank:
    return load_bank(request.param)


@pytest.mark.parametrize(
    ("impl", "actions"),
    [
        ("kinematic", "continuous"),
        ("fused", "discrete"),
        pytest.param("kinematic", "discrete", marks=pytest.mark.slow),
        pytest.param("fused", "continuous", marks=pytest.mark.slow),
    ],
)
def test_agents_pass_between_two_corners(pinched, rng, impl, actions):
    """From both sides, over the diagonal between the blocks: without it the way is more than a metre longer."""
    paths = crossings(pinched, 0, rng, NUM_EPISODES, 1.0)
    assert len(paths) > 2
    check_walks(pinched, paths, impl, actions)


@pytest.mark.slow
@pytest.mark.parametrize("impl", ["kinematic", "fused"])
def test_agents_walk_the_diagonals_of_generated_homes(homes, rng, impl):
    count = NUM_EPISODES // homes.num_houses
    paths = [path for house in range(homes.num_houses) for path in crossings(homes, house, rng, count)]
    assert len(paths) == NUM_EPISODES
    check_walks(homes, paths, impl, "continuous")
