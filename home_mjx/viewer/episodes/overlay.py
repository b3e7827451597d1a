"""Plan of a house during an episode: goal, path, and view cones of agents."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, UInt8
from PIL import Image, ImageDraw

from home_mjx.bank.bank import HouseBank
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.viewer.episodes.camera import VIEW_CONE_HALF_ANGLE, CameraShot
from home_mjx.viewer.episodes.goal_markers import GoalMarkers
from home_mjx.viewer.pictures.top_view import FLOOR_MARGIN, TopView, find_level

PLAN_PIXELS = 640  # length of the longer side of the house [px]
AGENT_COLOURS = ((20, 200, 90), (255, 150, 40), (190, 110, 255), (60, 200, 230))
PATH_COLOUR, GOAL_COLOUR, START_COLOUR = (40, 120, 255), (255, 205, 40), (235, 235, 235)
SHORTEST_STRIDE = 2  # [cells], distance of the dots of a shortest path
VIEW_CONE_LENGTH = 0.9  # [m] length of a view cone


class TopDownOverlay:
    """Plan of one episode's house.

    Args:
        bank: The houses.
        house: Index of the house.
    """

    def __init__(self, bank: HouseBank, house: int) -> None:
        self.bank, self.house, self.views = bank, house, {}
        self.levels: list[list[int]] = []  # of all agents, by step

    def draw(
        self,
        scene: Scene | None,
        sights: Sequence[CameraShot],
        goals: GoalMarkers,
        shortest: Float[np.ndarray, "n 3"] | None = None,
    ) -> UInt8[np.ndarray, "_ _ 3"]:
        """Draw the first agent's storey with goals, paths and agents, cropped to the extent of the rooms.

        Args:
            scene: The house without agents, to render again; None: use the previous scene, not at the first call.
            sights: All steps so far, at least one: those of the last call and later ones; the last one is the current.
            goals: The current goal.
            shortest: Points on the floor along the shortest path to the goal [m], drawn on their storey; None: no path.
        """
        self.levels += [[self._level(pos) for pos in sight.pos] for sight in sights[len(self.levels) :]]
        level = self.levels[-1][0]
        if scene is not None:
            self.views.clear()
            self.scene = scene
        if level not in self.views:
            self.views[level] = TopView(self.bank, self.scene, PLAN_PIXELS, level)
        top: TopView = self.views[level]
        picture = Image.fromarray(self._tinted(top, goals, level)).convert("RGB")
        draw = ImageDraw.Draw(picture, "RGBA")
        if shortest is not None:
            self._draw_shortest(draw, top, shortest, level)
        self._draw(draw, top, sights, goals, level)
        return top.crop(np.asarray(picture))

    def _level(self, pos: Float[np.ndarray, " 3"]) -> int:
        """Return the index of the storey whose floor is below a point [m]; a point on a floor is on the storey beneath.

        It is the lowest for points below all floors, see `find_level`.
        """
        return find_level(self.bank, self.house, pos)

    def _tinted(self, top: TopView, goals: GoalMarkers, level: int) -> UInt8[np.ndarray, "s s 3"]:
        """Return the image of storey `level` with its goal rooms tinted; unchanged without goal rooms."""
        if not goals.rooms.any():
            return top.image
        room = np.asarray(self.bank.navigation.room[self.house, level])
        size = len(top.image)
        row, column = np.mgrid[:size, :size]
        x, y = top.low[0] + (column + 0.5) / top.scale, top.low[1] + (size - row - 0.5) / top.scale
        at = np.stack([y, x], axis=-1) - np.asarray(self.bank.navigation.origin[self.house])[::-1]
        cell = np.floor(at / self.bank.spec.cell).astype(int)
        inside = np.all((cell >= 0) & (cell < room.shape), axis=-1)
        index = room[tuple(np.clip(cell, 0, np.array(room.shape) - 1).reshape(-1, 2).T)].reshape(size, size)
        meant = inside & (index >= 0) & goals.rooms[np.maximum(index, 0)]
        mixed = 0.65 * top.image + 0.35 * np.array(GOAL_COLOUR)
        return np.where(meant[..., None], mixed, top.image).astype(np.uint8)

    def _draw_shortest(
        self, draw: ImageDraw.ImageDraw, top: TopView, points: Float[np.ndarray, "n 3"], level: int
    ) -> None:
        """Draw a dot at every second point of a path, from the first, if it is on storey `level`."""
        for point in points[::SHORTEST_STRIDE]:
            if self._level(point + np.array([0, 0, FLOOR_MARGIN])) == level:
                _dot(draw, top.to_pixel(point), 2 * PLAN_PIXELS / 512, GOAL_COLOUR, GOAL_COLOUR)

    def _draw(
        self, draw: ImageDraw.ImageDraw, top: TopView, sights: Sequence[CameraShot], goals: GoalMarkers, level: int
    ) -> None:
        """Draw goals, the agents' paths, and agents with their view cones, those on storey `level` only."""
        unit = PLAN_PIXELS / 512
        for place in goals.places:
            if self._level(place + np.array([0, 0, FLOOR_MARGIN])) == level:
                _dot(draw, top.to_pixel(place), 9 * unit, None, GOAL_COLOUR)
        for agent in range(len(sights[-1].yaw)):
            path = [
                top.to_pixel(s.pos[agent])
                for s, levels in zip(sights, self.levels, strict=True)
                if levels[agent] == level
            ]
            if len(path) > 1:
                draw.line(path, fill=PATH_COLOUR, width=round(4 * unit), joint="curve")
            if agent == 0 and path:
                _dot(draw, path[0], 4 * unit, START_COLOUR, PATH_COLOUR)
            pos, yaw = sights[-1].pos[agent], float(sights[-1].yaw[agent])
            if self.levels[-1][agent] == level:
                self._look(draw, top, pos, yaw, AGENT_COLOURS[agent % len(AGENT_COLOURS)])
                _dot(draw, top.to_pixel(pos), 7 * unit, AGENT_COLOURS[agent % len(AGENT_COLOURS)], (10, 10, 10))

    def _look(self, draw: ImageDraw.ImageDraw, top: TopView, pos: np.ndarray, yaw: float, colour: tuple) -> None:
        """Draw an agent's view cone, of fixed length and angle whatever its camera, from `pos` [m] towards `yaw` [rad].

        `colour` is RGB; the cone is translucent.
        """
        half = np.deg2rad(VIEW_CONE_HALF_ANGLE)
        ends = [
            pos[:2] + VIEW_CONE_LENGTH * np.array([np.cos(yaw + a), np.sin(yaw + a)])
            for a in np.linspace(-half, half, 9)
        ]
        draw.polygon([top.to_pixel(pos), *[top.to_pixel(end) for end in ends]], fill=(*colour, 110))


def _dot(draw: ImageDraw.ImageDraw, at: tuple[float, float], radius: float, fill: tuple | None, edge: tuple) -> None:
    """Draw a disc around a pixel; `fill` None: only its edge."""
    x, y = at
    draw.ellipse(
        (x - radius, y - radius, x + radius, y + radius), fill=fill, outline=edge, width=max(2, int(radius / 3))
    )
