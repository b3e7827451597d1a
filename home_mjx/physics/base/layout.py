"""Indices of agents, bodies, doors and contact slots in the template's arrays."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int


@dataclass(frozen=True)
class Layout:
    """Addresses in `qpos`, `qvel`, bodies and geoms of the template, for one environment.

    Numbers of bodies and doors are the bank's capacity: a house's unused rows count, too.
    Order of bodies: world, agents, movable bodies, doors. All except the world are dynamic bodies, which are counted
    from 0.
    Order of geoms: floor, slots of the agents, slots of the bodies, then two per agent (capsule, foot), nine per body
    (box, corners) and one per door. Each sliding leaf has `num_tray_boxes` more, which follow its own.
    An agent has 4 numbers in `qpos` and in `qvel` (x, y, z, yaw), a body 7 and 6, and a door 1 and 1. A door's
    coordinate is the angle of a hinged leaf or the displacement of a sliding one.
    Sliding leaves are the last doors.
    """

    num_agents: int
    num_bodies: int
    num_doors: int
    agent_slots: int
    body_slots: int
    num_slides: int = 0
    num_tray_boxes: int = 0

    @property
    def num_slots(self) -> int:
        """Number of contact slots of all agents and movable bodies, unused bodies included; doors have none."""
        return self.num_agents * self.agent_slots + self.num_bodies * self.body_slots

    @property
    def num_dynamic(self) -> int:
        """Number of agents, movable bodies and doors, unused ones included; the world is not counted."""
        return self.num_agents + self.num_bodies + self.num_doors

    @property
    def num_dofs(self) -> int:
        """Length of `qvel`; that of `qpos` is larger by one per movable body."""
        return 4 * self.num_agents + 6 * self.num_bodies + self.num_doors

    @property
    def agent_qpos(self) -> slice:
        """Slice of the agents in `qpos` and in `qvel`, 4 numbers each."""
        return slice(0, 4 * self.num_agents)

    @property
    def body_qpos(self) -> slice:
        """Slice of the movable bodies in `qpos`, 7 numbers each."""
        return slice(4 * self.num_agents, 4 * self.num_agents + 7 * self.num_bodies)

    @property
    def body_qvel(self) -> slice:
        """Slice of the movable bodies in `qvel`, 6 numbers each."""
        return slice(4 * self.num_agents, 4 * self.num_agents + 6 * self.num_bodies)

    @property
    def door_qpos(self) -> slice:
        """Slice of the doors in `qpos`, one number each."""
        first = 4 * self.num_agents + 7 * self.num_bodies
        return slice(first, first + self.num_doors)

    @property
    def door_qvel(self) -> slice:
        """Slice of the doors in `qvel`, one number each."""
        first = 4 * self.num_agents + 6 * self.num_bodies
        return slice(first, first + self.num_doors)

    @property
    def bodies(self) -> slice:
        """Slice of the movable bodies among the template's bodies, where 0 is the world; dynamic indices are 1 less."""
        return slice(1 + self.num_agents, 1 + self.num_agents + self.num_bodies)

    @property
    def doors(self) -> slice:
        """Slice of the doors among the template's bodies, where 0 is the world; dynamic indices are 1 less."""
        return slice(1 + self.num_agents + self.num_bodies, 1 + self.num_dynamic)

    @property
    def slots(self) -> slice:
        """Slice of the slots among the geoms: `agent_slots` of each agent, then `body_slots` of each movable body."""
        return slice(1, 1 + self.num_slots)

    @property
    def body_geoms(self) -> slice:
        """Slice of the geoms of the movable bodies, body by body: its box, then its 8 corners."""
        first = 1 + self.num_slots + 2 * self.num_agents
        return slice(first, first + 9 * self.num_bodies)

    @property
    def door_geoms(self) -> slice | Int[np.ndarray, " h"]:
        """Slice of the geoms of the doors' own boxes, one per door; their indices if sliding leaves have trays."""
        if not self.num_tray_boxes:
            return slice(self.body_geoms.stop, self.body_geoms.stop + self.num_doors)
        slide = np.maximum(np.arange(self.num_doors) - (self.num_doors - self.num_slides), 0)
        return self.body_geoms.stop + np.arange(self.num_doors) + self.num_tray_boxes * slide

    @property
    def tray_geoms(self) -> Int[np.ndarray, " t"]:
        """Indices of the geoms of trays, `num_tray_boxes` per sliding leaf."""
        first, box = self.num_doors - self.num_slides, 1 + self.num_tray_boxes
        own = self.body_geoms.stop + first + box * np.arange(self.num_slides)
        return (own[:, None] + 1 + np.arange(self.num_tray_boxes)).reshape(-1)
