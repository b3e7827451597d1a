"""Agent that follows a script with ordinary actions of the environment."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from examples.story.moment import Moment
from home_mjx.navigation.path_follower import steer, turn_towards
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.specs import ACTION_NAMES, HAND_NAMES

NAMES = (*ACTION_NAMES, *HAND_NAMES)
AIMED = 0.04  # [rad], from the middle of the view
CALM = 0.6  # of the turn that is left per step: motors lag behind, so all of it would overshoot

Action = Float[np.ndarray, " n"]


@dataclass(frozen=True)
class Actor:
    """One agent of an environment with hands.

    Args:
        config: Options of the environment.
        agent: Which one.
    """

    config: EnvConfig
    agent: int

    def stand(self) -> Action:
        """It does nothing."""
        return np.zeros(len(NAMES), np.float32)

    def walk(self, moment: Moment, aim: Float[np.ndarray, " 2"], pitch: float = 0.0) -> Action:
        """Straight towards a point [m], looking up by `pitch` [rad]."""
        body, dt = self.config.agents[self.agent], self.config.timing.ctrl_dt
        action = self.stand()
        action[:4] = steer(moment.pos[self.agent], float(moment.yaw[self.agent]), aim, body.turn_rate * dt)
        action[NAMES.index("look_up")] = self._tilt(pitch - float(moment.pitch[self.agent]))
        return action

    def look(self, moment: Moment, point: Float[np.ndarray, " 3"]) -> Action:
        """Towards a point [m], on the spot."""
        body, dt = self.config.agents[self.agent], self.config.timing.ctrl_dt
        turn, tilt = self._off(moment, point)
        action = self.stand()
        action[NAMES.index("turn_left")] = np.clip(CALM * turn / (body.turn_rate * dt), -1, 1)
        action[NAMES.index("look_up")] = self._tilt(tilt)
        return action

    def use(self, moment: Moment, point: Float[np.ndarray, " 3"], command: str) -> Action:
        """Look at a point [m], and give a command of the hand once it is in view."""
        action = self.look(moment, point)
        if self.sees(moment, point):
            action[NAMES.index(command)] = 1.0
        return action

    def sees(self, moment: Moment, point: Float[np.ndarray, " 3"]) -> bool:
        """Return whether a point [m] is in the middle of the view, occluded or not."""
        return max(map(abs, self._off(moment, point))) < AIMED

    def distance(self, moment: Moment, point: Float[np.ndarray, " *p"]) -> float:
        """Return the horizontal distance from the axis of the body [m]."""
        return float(np.linalg.norm(moment.pos[self.agent, :2] - point[:2]))

    def eyes(self, moment: Moment) -> Float[np.ndarray, "3"]:
        """Return the position of the eyes [m]."""
        body = self.config.agents[self.agent]
        return moment.pos[self.agent] + np.array([0.0, 0.0, body.eye_height - body.height / 2])

    def _off(self, moment: Moment, point: Float[np.ndarray, " 3"]) -> tuple[float, float]:
        """Return the turn to the left and the tilt up that centre a point in the view [rad]."""
        rise = point[2] - self.eyes(moment)[2]
        tilt = np.arctan2(rise, self.distance(moment, point)) - moment.pitch[self.agent]
        return turn_towards(moment.pos[self.agent], float(moment.yaw[self.agent]), point), float(tilt)

    def _tilt(self, angle: float) -> float:
        """Return the part of an action that looks up by an angle [rad], or as far as one step allows."""
        return float(np.clip(angle / (self.config.max_pitch_rate * self.config.timing.ctrl_dt), -1, 1))
