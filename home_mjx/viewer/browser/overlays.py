"""Overlays of the 3D scene: paths, goal, distances, contacts, portals, lamps, object ids, and the navigation grid."""

from typing import TYPE_CHECKING, Any

import jax
import numpy as np
from jaxtyping import Float

from home_mjx.bank.bank import HouseBank
from home_mjx.tasks.env.observers import EpisodeStart, EpisodeStep, Observer, RunStart
from home_mjx.tasks.rules.features import current_boxes
from home_mjx.viewer.browser.live_overlays import LiveLines
from home_mjx.viewer.browser.scene.house_layers import draw_distances, draw_ids
from home_mjx.viewer.episodes.goal_markers import get_goal_markers
from home_mjx.viewer.episodes.state_report import shortest_path

if TYPE_CHECKING:
    import viser

PATH, SHORTEST, GOAL, GRID = "path", "shortest path", "goal", "navigation grid"
DISTANCES, IDS = "distances to the goal", "object ids"
CONTACTS, SOUND_PATHS, PORTALS, LAMPS = "contacts", "sound paths", "portals", "lamps"
HIDDEN = (GRID, DISTANCES, IDS, CONTACTS, SOUND_PATHS, PORTALS, LAMPS)  # at first
PATH_COLOUR, GOAL_COLOUR, GRID_COLOUR = (250, 170, 60), (60, 200, 110), (90, 150, 250)
PATH_WIDTH = 4.0  # [px]
LIFT = np.array([0.0, 0.0, 0.04])  # [m], of lines and points above the floor
MAX_PATH = 2000  # points of the path that are kept
MIN_PATH_STEP = 0.05  # [m], distance of points of the path
GOAL_RADIUS = 0.15  # [m]


class Overlays(Observer):
    """Overlays of the first agent's episode.

    Args:
        server: viser's server.

    Attributes:
        is_shown: Overlays that are shown, by name.
    """

    def __init__(self, server: "viser.ViserServer") -> None:
        self._server = server
        self.is_shown = {name: name not in HIDDEN for name in (PATH, SHORTEST, GOAL, *HIDDEN)}
        self._path: list[np.ndarray] = []
        self._is_new = True  # whether the episode's shortest path is not drawn yet
        self._handles: dict[str, Any] = {}
        self._layers: dict[str, list[Any]] = {}
        self._grid_house, self._places, self._markers = -1, np.zeros((0, 3)), []

    def on_run_start(self, start: RunStart) -> None:
        """Store the environment, and make the program for feet and boxes."""
        assert start.env is not None
        env = self._env = start.env
        self._grid_house = -1

        def look(params: Any, state: Any) -> Any:
            """Return the first agent's feet, and the bounds of all instances."""
            snapshot = env.core.snapshot(params, state)
            return snapshot.feet[0], current_boxes(snapshot)

        self._look, self._lines, self._step = jax.jit(look), LiveLines(env), None

    def on_episode_start(self, start: EpisodeStart) -> None:
        """Clear path, distances and ids."""
        self.clear()

    def clear(self) -> None:
        """Clear path, shortest path, distances and ids, before another episode or house is shown."""
        self._path, self._is_new = [], True
        for name in (DISTANCES, IDS):
            self._remove(name)

    def on_episode_step(self, step: EpisodeStep) -> None:
        """Draw path and goal of a step, and the grid of another house."""
        feet, boxes = (np.asarray(x) for x in self._look(self._env.params, step.state))
        house, goals = int(step.state.world.house), get_goal_markers(self._env.bank, step.state, boxes)
        if not self._path or np.linalg.norm(feet + LIFT - self._path[-1]) > MIN_PATH_STEP:
            self._path = [*self._path, feet + LIFT][-MAX_PATH:]
            self._draw_line(PATH, np.array(self._path), PATH_COLOUR)
        self._draw_goal(goals.places)
        if self._is_new:
            self._is_new = False
            shortest = shortest_path(self._env.bank, house, feet, goals)
            self._draw_line(SHORTEST, np.reshape(shortest, (-1, 3)) + LIFT, GOAL_COLOUR)
        self._step, self._boxes, self._goals = step, boxes, goals
        self._draw_live()
        self._draw_layers()
        if house != self._grid_house:
            self._grid_house = house
            self._draw_grid(grid_points(self._env.bank, house))

    def draw_path(self, feet: Float[np.ndarray, "n 3"]) -> None:
        """Replace the agent's path, such as that of a replayed step."""
        self._path = [point + LIFT for point in feet[-MAX_PATH:]]
        self._draw_line(PATH, np.array(self._path), PATH_COLOUR)

    def show(self, name: str, is_shown: bool) -> None:
        """Show or hide an overlay, now and in later episodes."""
        self.is_shown[name] = is_shown
        if name in (CONTACTS, SOUND_PATHS, PORTALS, LAMPS):
            self._draw_live()
        if name in (DISTANCES, IDS):
            self._remove(name)
            self._draw_layers()
        elif name in self._handles:
            self._handles[name].visible = is_shown

    def _draw_live(self) -> None:
        """Draw contacts and sound paths of the last step, those of them that are shown."""
        lines = self._lines
        found = {CONTACTS: lines.contacts, SOUND_PATHS: lines.sound_paths, PORTALS: lines.portals, LAMPS: lines.lamps}
        for name, find in found.items():
            if self.is_shown[name] and self._step is not None:
                self._draw_lines(name, *find(self._step.state))

    def _draw_layers(self) -> None:
        """Draw distances and ids, if they are shown and not drawn yet in this episode."""
        bank, house = self._env.bank, -1 if self._step is None else int(self._step.state.world.house)
        if self._step is not None and self.is_shown[DISTANCES] and DISTANCES not in self._layers:
            self._layers[DISTANCES] = [draw_distances(self._server, bank, house, self._goals)]
        if self._step is not None and self.is_shown[IDS] and IDS not in self._layers:
            self._layers[IDS] = draw_ids(self._server, bank, house, self._boxes)

    def _remove(self, name: str) -> None:
        """Remove a layer from the scene."""
        for handle in self._layers.pop(name, ()):
            handle.remove()

    def _draw_line(self, name: str, points: Float[np.ndarray, "n 3"], colour: tuple[int, int, int]) -> None:
        """Draw an overlay as lines between successive points; nothing for fewer than two."""
        self._draw_lines(name, np.stack([points[:-1], points[1:]], axis=1), colour)

    def _draw_lines(self, name: str, lines: Float[np.ndarray, "n 2 3"], colour: Any) -> None:
        """Draw an overlay as separate lines of one colour, or of one for each of their ends."""
        lines = np.asarray(lines, np.float32)
        if not len(lines):
            lines, colour = np.zeros((1, 2, 3), np.float32), PATH_COLOUR
        if name in self._handles:
            self._handles[name].remove()
        self._handles[name] = self._server.scene.add_line_segments(
            f"/overlays/{name}",
            lines,
            colors=colour,
            thickness=PATH_WIDTH,
            thickness_units="screen",
            visible=self.is_shown[name],
        )

    def _draw_goal(self, places: Float[np.ndarray, "n 3"]) -> None:
        """Draw a marker at each goal point."""
        if GOAL not in self._handles:
            visible = self.is_shown[GOAL]
            self._handles[GOAL] = self._server.scene.add_frame("/overlays/goal", show_axes=False, visible=visible)
        if np.array_equal(self._places, places):
            return
        for handle in self._markers:
            handle.remove()
        self._places, up = places, np.array([0.0, 0.0, GOAL_RADIUS])
        self._markers = [
            self._server.scene.add_icosphere(
                f"/overlays/goal/{n}", GOAL_RADIUS, color=GOAL_COLOUR, opacity=0.7, position=place + up
            )
            for n, place in enumerate(places)
        ]

    def _draw_grid(self, points: Float[np.ndarray, "n 3"]) -> None:
        """Draw the cells of a house's navigation grid."""
        size = float(self._env.bank.spec.cell) / 4
        self._handles[GRID] = self._server.scene.add_point_cloud(
            "/overlays/grid", points.astype(np.float32), GRID_COLOUR, point_size=size, visible=self.is_shown[GRID]
        )


def grid_points(bank: HouseBank, house: int) -> Float[np.ndarray, "n 3"]:
    """Return the centres of a house's navigation cells, slightly above floor or ramp [m]."""
    navigation = bank.navigation
    first, count = int(navigation.first_cell[house]), int(navigation.num_cells[house])
    level_row_column = np.asarray(navigation.cell_coords[first : first + count], np.float64)
    plan = np.asarray(navigation.origin[house]) + (level_row_column[:, :0:-1] + 0.5) * bank.spec.cell
    height = np.asarray(navigation.height[first : first + count])
    return np.column_stack([plan, height]) + LIFT
