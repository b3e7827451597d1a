"""Script of the story: the actions of the agents in stages, and the condition that ends each stage."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from examples.story.actor import Action, Actor
from examples.story.moment import Moment
from examples.story.places import Places
from home_mjx.tasks.base.config import EnvConfig

CARRIER, WATCHER = 0, 1  # agents
NEAR = 0.15  # [m], from a point on the way
BEFORE, BEYOND, BEFORE_STAIRS = 0.75, 1.0, 0.45  # [m], from a doorway and from the ends of stairs
ARM = 0.6  # [m], from the object to pick up
EDGE = 0.25  # [m], from the edge of the table to where the lamp is put
OPEN = 0.1  # [rad], from wide open
DOWN = -0.4  # [rad], of the view while it carries: so it sees the held object
SHADE = 0.5  # of the lamp's half height above its middle: its shade is easily hit
STILL = 0.01  # [m/s] and [rad/s]


@dataclass(frozen=True)
class Stage:
    """A part of the story.

    Attributes:
        caption: What the carrier does.
        act: Its action at a moment.
        done: Whether the stage is over.
        limit: Longest time that it may take [s].
    """

    caption: str
    act: Callable[[Moment], Action]
    done: Callable[[Moment], bool]
    limit: float = 15.0


class Script:
    """The stages of the carrier, and the actions of the watcher.

    Args:
        config: Options of the environment: two agents with hands.
        places: Of the house.
    """

    def __init__(self, config: EnvConfig, places: Places) -> None:
        self.carrier, self.watcher = Actor(config, CARRIER), Actor(config, WATCHER)
        self.places = places

    def watch(self, moment: Moment) -> Action:
        """The watcher goes to its place, and then looks at the carrier."""
        if self.watcher.distance(moment, self.places.lookout) > NEAR:
            return self.watcher.walk(moment, self.places.lookout)
        return self.watcher.look(moment, moment.pos[CARRIER])

    def stages(self) -> Iterator[Stage]:
        """In their order."""
        yield from self._door()
        yield from self._stairs()
        yield from self._lamp()

    def _door(self) -> Iterator[Stage]:
        door, me = self.places.door, self.carrier
        yield self._way("goes to the door", door.middle[:2] - BEFORE * door.through)
        yield Stage(
            "opens the door",
            lambda m: me.use(m, door.middle, "turn_door"),
            lambda m: abs(float(m.door_angle[0]) - door.wide) < OPEN,
        )
        yield self._way("walks through", door.middle[:2] + BEYOND * door.through)

    def _stairs(self) -> Iterator[Stage]:
        stairs = self.places.stairs
        yield self._way("goes to the stairs", stairs.foot - BEFORE_STAIRS * stairs.up)
        climbs = self._way("climbs the stairs", stairs.head + BEFORE_STAIRS * stairs.up)
        yield replace(climbs, done=lambda m: climbs.done(m) and self.is_upstairs(m))

    def _lamp(self) -> Iterator[Stage]:
        me, lamp, table = self.carrier, self.places.lamp, self.places.table
        yield Stage(
            "goes to the lamp",
            lambda m: me.walk(m, m.body_pos[lamp.body, :2]),
            lambda m: me.distance(m, m.body_pos[lamp.body]) < ARM,
        )
        yield Stage(
            "picks it up",
            lambda m: me.use(m, m.body_pos[lamp.body] + [0.0, 0.0, SHADE * lamp.half[2]], "pick"),
            lambda m: m.held[CARRIER] == lamp.body,
        )
        yield Stage(
            "carries it to the table",
            lambda m: me.walk(m, m.body_pos[table.body, :2], DOWN),
            lambda m: me.distance(m, self.spot(m)) < ARM + EDGE,
        )
        yield Stage("puts it down", lambda m: me.use(m, self.spot(m), "pick"), lambda m: m.held[CARRIER] < 0)
        yield Stage(
            "looks at the other",
            lambda m: me.look(m, self.watcher.eyes(m)),
            lambda m: me.sees(m, self.watcher.eyes(m)) and self.stands(m),
        )

    def _way(self, caption: str, aim: Float[np.ndarray, "2"]) -> Stage:
        me = self.carrier
        return Stage(caption, lambda m: me.walk(m, aim), lambda m: me.distance(m, aim) < NEAR)

    def is_upstairs(self, moment: Moment) -> bool:
        """Return whether the carrier stands on the upper floor."""
        half = self.carrier.config.agents[CARRIER].height / 2
        return abs(float(moment.pos[CARRIER, 2]) - half - self.places.stairs.upstairs) < 0.02

    def spot(self, moment: Moment) -> Float[np.ndarray, "3"]:
        """The point of the table's top that is nearest to the carrier, well inside its edge [m]."""
        table = self.places.table
        frame = moment.body_frame[table.body]
        local = frame.T @ (moment.pos[CARRIER] - moment.body_pos[table.body])
        room = np.maximum(table.half[:2] - EDGE, 0.0)
        return moment.body_pos[table.body] + frame @ [*np.clip(local[:2], -room, room), table.half[2]]

    def stands(self, moment: Moment) -> bool:
        """Return whether the lamp stands on the table, upright and at rest."""
        lamp, table = self.places.lamp, self.places.table
        frame = moment.body_frame[table.body]
        away = frame.T @ (moment.body_pos[lamp.body] - moment.body_pos[table.body])
        on_top = abs(away[2] - lamp.half[2] - table.half[2]) < 0.01 and (abs(away[:2]) < table.half[:2]).all()
        upright = moment.body_frame[lamp.body][2, 2] > 0.999
        return bool(on_top and upright and moment.body_speed[lamp.body] < STILL)
