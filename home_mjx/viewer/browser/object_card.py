"""Card of a clicked object, from the bank's semantics, and doors that a click opens or closes."""

import jax.numpy as jnp
import numpy as np

from home_mjx.bank.bank import HouseBank
from home_mjx.scene_compile import decode_row
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.base.state import State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.viewer.browser.scene.house_scene import MOVING, InstanceGroup

COLOUR_COLUMNS = ("css", "css_2", "css_3")
UNNAMED = ("empty", "unknown")  # fine categories that are called "object"
SUPPORT_PHRASES = {"floor": "stands on the floor", "wall": "is on the wall", "ceiling": "hangs from the ceiling"}


def format_card(bank: HouseBank, house: int, group: InstanceGroup, index: int) -> str:
    """Format category, size, colours, material, mass, place and a sentence of an instance as Markdown.

    Args:
        bank: The houses.
        house: Index of the house.
        group: Group of the instance.
        index: Number of the instance in the group.
    """
    known = decode_row(np.asarray(bank.semantics)[group.semantic[index]])
    colours = [str(known[name]) for name in COLOUR_COLUMNS if name in known]
    category = _words(known.get("fine", "object"))
    size = _size(bank, house, int(group.objects[index]))
    movable = int(np.asarray(bank.semantics)[group.semantic[index], Semantic.MOVABLE])
    mass = float(bank.physics.body_mass[house, movable]) if movable >= 0 else None
    room = f"{_words(known['room_type'])}, room {known.get('room')}" if "room_type" in known else None
    lines = {
        "colours": ", ".join(colours),
        "material": known.get("material"),
        "size": f"{known.get('size', '')} {size}".strip(),
        "mass": "fixed" if mass is None else f"{mass:.2f} kg",
        "room": room,
        "storey": known.get("level"),
        "object id": int(group.objects[index]),
    }
    look = " ".join([*([colours[0]] if colours else ()), category])
    made = f" of {known['material']}" if "material" in known else ""
    article = "An" if look[0] in "aeiou" else "A"
    sentence = f"{article} {look}{made} {_support(bank, house, known)}{f' in the {room}' if room else ''}."
    table = [f"| {name} | {value} |" for name, value in lines.items() if value not in (None, "")]
    return "\n".join([f"**{category}**", "", sentence, "", "| | |", "|---|---|", *table])


def find_door(bank: HouseBank, house: int, group: InstanceGroup, index: int) -> int | None:
    """Return the row in the bank's doors of an instance that is a door leaf; None for others.

    Dynamic instances are the movable bodies, then the doors, then the agents.
    """
    door = int(group.entries[index]) - bank.spec.num_bodies
    is_door = group.layer == MOVING and 0 <= door < bank.spec.num_doors
    return door if is_door and bool(bank.physics.door_valid[house, door]) else None


def toggle_door(env: Env[HouseholdEnv], state: State, door: int) -> State:
    """Return a state of one environment with a door fully open, or closed if it is nearer to open; at rest.

    Observations stay those before, until the next step. An object in the way is pushed by physics.
    """
    house, physics = int(state.world.house), env.bank.physics
    layout = env.core.template(env.bank).layout
    place = int(np.arange(len(state.physics.qpos))[layout.door_qpos][door])
    closed, wide = float(physics.door_closed[house, door]), float(physics.door_fully_open[house, door])
    angle = float(state.physics.qpos[place])
    target = wide if abs(angle - closed) <= abs(angle - wide) else closed
    qpos = state.physics.qpos.at[place].set(jnp.float32(target))
    speed = int(np.arange(len(state.physics.qvel))[layout.door_qvel][door])
    return state.replace(physics=state.physics.replace(qpos=qpos, qvel=state.physics.qvel.at[speed].set(0.0)))


def _size(bank: HouseBank, house: int, object_id: int) -> str:
    """Return width, depth and height in the object's own frame [m] as a text; "" for agents."""
    rows = np.flatnonzero(np.asarray(bank.geometry.instance_object[house]) == object_id)
    if not len(rows):
        return ""
    box = np.asarray(bank.geometry.model_box[int(bank.geometry.instance_model[house, rows[0]])])
    scale = np.linalg.norm(np.asarray(bank.geometry.instance_pose[house, rows[0]])[:, :3], axis=0)
    width, depth, height = ((box[1] - box[0]) * scale).tolist()
    return f"{width:.2f} × {depth:.2f} × {height:.2f} m"


def _support(bank: HouseBank, house: int, known: dict[str, str | int | tuple[str, ...]]) -> str:
    """Return the predicate of an object's support, such as `is on the table`."""
    for column, preposition in (("container", "in"), ("supporter", "on")):
        if column in known:
            row = int(bank.geometry.object_semantic[house, int(known[column])])  # pyright: ignore[reportArgumentType]
            holder = decode_row(np.asarray(bank.semantics[row])).get("fine", "object")
            return f"is {preposition} the {_words(holder)}"
    return SUPPORT_PHRASES.get(str(known.get("support")), "is here")


def _words(name: object) -> str:
    """Return a name in words: spaces for underscores, lower case; "object" for unnamed categories."""
    return "object" if name in UNNAMED else str(name).replace("_", " ").lower()
