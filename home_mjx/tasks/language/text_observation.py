"""Text observations for language models, in the form of ALFWorld (arXiv:2010.03768)."""

import functools
import math
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Int

from home_mjx.core.checks import check_number
from home_mjx.core.transforms import camera_quat
from home_mjx.navigation.grid import room_at_feet
from home_mjx.raycast_render.cameras.camera import Camera, Lens
from home_mjx.raycast_render.images.render import render
from home_mjx.schema.semantic import Semantic
from home_mjx.schema.vocabulary import vocabularies
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.language.vocabulary import to_word
from home_mjx.tasks.sensors.cameras import agent_ids, eye_position

VIEW, VIEW_ANGLE = Lens(64, 64), 90.0  # [pixels], [degrees] of the view that is described
MIN_PIXELS = 4  # minimum number of pixels of an object that is named
MAX_NAMED = 12  # maximum number of named objects, nearest first
AHEAD_ANGLE = 15.0  # [degrees], maximum angle from straight ahead that counts as ahead


def describe(snapshot: Snapshot, agent: int = 0) -> str:
    """Describe what an agent sees as text: its room, objects with number, distance and direction, and its hand (host).

    A number is the object's id, so that it is the same in all steps. Objects are those of the view ahead, 90 degrees
    wide, nearest first.

    Args:
        snapshot: One environment, not a batch, such as `env.core.snapshot(env.params, state)`.
        agent: Number of the agent.

    Raises:
        ConfigError: There is no such agent.

    Example:
        >>> describe(env.core.snapshot(env.params, state))  # doctest: +SKIP
        'You are in the kitchen. You see a white stove 12 (1.4 m, left) and a red chair 7 (2.0 m, ahead).'
    """
    check_number("agent", agent, 0, snapshot.config.num_agents - 1, integer=True)
    seen = jax.device_get(_look(snapshot, agent))
    room = _name(Semantic.ROOM_TYPE, int(seen["in_room"]))
    text = f"You are in the {room}." if room else "You are outside of any room."
    named = _named_objects(seen)
    text += f" You see {_enumerate(named)}." if named else " You see nothing but walls."
    held = _phrase(seen["held"])
    return f"{text} You hold {held}." if held else text


@functools.partial(jax.jit, static_argnums=1)
def _look(snapshot: Snapshot, agent: int) -> dict[str, Array]:
    """Return images of the view ahead by kind, the type of the agent's room, and the semantics of what it holds."""
    bank, pose, config = snapshot.bank, snapshot.pose, snapshot.config
    angle = jnp.deg2rad(jnp.float32(VIEW_ANGLE))
    camera = Camera(eye_position(config, pose)[agent], camera_quat(pose.yaw[agent], jnp.zeros(())), angle)
    own = agent_ids(bank, config.num_agents)[agent]
    kinds = ("instance", "distance", "fine", "color")
    images = render(snapshot.scene, camera, VIEW, kinds=kinds, exclude=own, depth_max=config.max_depth)
    room, held = room_at_feet(bank, snapshot.house, snapshot.feet[agent]), snapshot.held[agent]
    kind = jnp.where(room < 0, -1, bank.navigation.room_type[snapshot.house, jnp.maximum(room, 0)].astype(jnp.int32))
    row = snapshot.scene.moving.semantic[jnp.maximum(held, 0)]
    return {**images, "in_room": kind, "held": jnp.where(held < 0, -1, bank.semantics[row])}


def _named_objects(seen: dict[str, Any]) -> list[str]:
    """Return a phrase for each object with enough pixels, nearest first."""
    ids, found = seen["instance"], []
    for number in np.unique(ids[ids >= 0]).tolist():
        where = ids == number
        if where.sum() < MIN_PIXELS:
            continue
        row = np.full(len(Semantic), -1)
        row[Semantic.FINE], row[Semantic.COLOR] = (
            np.bincount(seen[x][where] + 1).argmax() - 1 for x in ("fine", "color")
        )
        distance = float(seen["distance"].reshape(ids.shape)[where].min())
        noun = _phrase(row) or "a person"
        found.append((distance, f"{noun} {number} ({distance:.1f} m, {_direction(where)})"))
    return [text for _, text in sorted(found)[:MAX_NAMED]]


def _direction(where: np.ndarray) -> str:
    """Return `left`, `ahead` or `right` for the mean column of the pixels of a mask."""
    half = where.shape[1] / 2
    column = np.nonzero(where)[1].mean() + 0.5
    angle = math.degrees(math.atan((half - column) / half * math.tan(math.radians(VIEW_ANGLE / 2))))
    return "ahead" if abs(angle) <= AHEAD_ANGLE else ("left" if angle > 0 else "right")


def _phrase(row: Int[np.ndarray, " columns"]) -> str:
    """Return article, colour and fine category of a semantic row, such as `a red chair`; "" if it has no category."""
    noun = _name(Semantic.FINE, int(row[Semantic.FINE]))
    words = " ".join(word for word in (_name(Semantic.COLOR, int(row[Semantic.COLOR])), noun) if word)
    return f"{'an' if words[:1] in tuple('aeiou') else 'a'} {words}" if noun else ""


def _name(column: Semantic, number: int) -> str:
    """Return the word of a number of a column; "" for none."""
    return "" if number < 0 else to_word(vocabularies()[column][number])


def _enumerate(parts: list[str]) -> str:
    """Join phrases by commas, the last one by `and`."""
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}"
