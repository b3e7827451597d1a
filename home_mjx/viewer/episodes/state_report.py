"""Report of one state in words and pictures: pose, room, contacts, task and status; the agent's view and the plan."""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, UInt8

from home_mjx.bank.bank import HouseBank
from home_mjx.navigation.grid import cell_at_feet, room_at_feet
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.surface import semantics
from home_mjx.scene_compile import decode_row
from home_mjx.schema.categories import ROOM_TYPES
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.base.snapshot import Snapshot, contact_semantics
from home_mjx.tasks.base.state import EnvParams, State
from home_mjx.tasks.base.status import Status
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.rules.cell_graph import CellGraph, EndCells
from home_mjx.tasks.rules.features import current_boxes
from home_mjx.tasks.sensors.cameras import agent_ids
from home_mjx.viewer.episodes.camera import CameraShot, FilmCamera, scene_without_agents
from home_mjx.viewer.episodes.goal_markers import GoalMarkers, get_goal_markers, get_instruction
from home_mjx.viewer.episodes.overlay import TopDownOverlay

NUM_DIRECTIONS = 32  # number of rays around an agent, at each height
RAY_HEIGHTS = (-0.8, -0.4, 0.0, 0.4, 0.8)  # heights of these rays from the middle of the body, in half heights
MAX_GAP = 0.1  # [m], beyond the body: a step of sliding and rounding
MAX_NEIGHBOURS = 4  # number of things beside an agent that are listed
SIDES = (  # names of directions, from ahead to the left around
    *("ahead", "ahead to the left", "to the left", "behind to the left"),
    *("behind", "behind to the right", "to the right", "ahead to the right"),
)
GOAL_HEIGHT_MARGIN = 0.1  # [m], by which a goal may lie below the floor of its cell
NOTHING, FLOOR = -1, -2  # values of `contact_partner`
TITLE_WIDTH = 10  # [characters]
COLUMNS = ("fine", "basic", "material", "room_type")  # of `decode_row`, in the order of a contact's description


class StatePictures(NamedTuple):
    """Pictures of a state.

    Attributes:
        view: The first agent's view.
        plan: Its storey from above, with goals, agents and the shortest path to the goal.
    """

    view: UInt8[np.ndarray, "h w 3"]
    plan: UInt8[np.ndarray, "_ _ 3"]


class _Facts(NamedTuple):
    """Figures of A agents and M dynamic bodies."""

    feet: Any  # (A, 3) [m]
    yaw: Any  # (A,) [rad]
    pitch: Any  # (A,) [rad]
    velocity: Any  # (A, 3)
    cell: Any  # (A, 3), level, row and column
    room: Any  # (A,); -1 outside
    in_contact: Any  # (A,)
    held: Any  # (A,)
    impulse: Any  # (M,) [N s]
    contact: Any  # (M, 3) [m]
    partner: Any  # (M,)
    body: Any  # (M, columns)
    other: Any  # (M, columns)
    boxes: Any  # (I, 2, 3), bounds of all instances [m]
    gap: Any  # (A, H, D), free distance beyond the body at heights and in directions of `_surroundings` [m]
    near: Any  # (A, H, D, columns), semantics of what is there; -1 none


def describe_state(env: Env[HouseholdEnv], state: State) -> list[str]:
    """Return the lines of a report of one environment.

    Args:
        env: The environment; its houses are those of the state.
        state: State of one environment, such as a row of `load_states`.

    Example:
        >>> print(*describe_state(env, state), sep=chr(10))  # doctest: +SKIP
    """
    facts = jax.tree.map(np.asarray, jax.jit(_facts, static_argnums=0)(env.core, env.params, state))
    house = int(state.world.house)
    lines = [_line("house", f"{env.bank.house_ids[house]} (number {house} of {env.bank.num_houses})")]
    lines += [_line("task", _describe_task(env, state))]
    for agent in range(len(facts.yaw)):
        lines += _describe_agent(env.bank, house, facts, agent)
    lines += _describe_touching_bodies(facts, len(facts.yaw))
    lines += [_line("goal", text) for text in _describe_goals(env.bank, state, facts)]
    rewards = ", ".join(f"{reward:+.3g}" for reward in np.atleast_1d(np.asarray(state.reward)))
    lines += [_line("reward", f"{rewards} in the last step")]
    metrics = ", ".join(f"{name} {float(value):.4g}" for name, value in sorted(state.metrics.items()))
    lines += [_line("metrics", metrics or "none")]
    flags = ", ".join(Status.names(int(state.status)))
    return [*lines, _line("status", flags or "no flag"), *_describe_not_a_number(state)]


def draw_state(env: Env[HouseholdEnv], state: State, width: int = 480, height: int = 360) -> StatePictures:
    """Render the first agent's view, and draw the plan of its storey with goals and the shortest path.

    Args:
        env: The environment; its houses are those of the state.
        state: State of one environment.
        width: Width of the view [px].
        height: Height of the view [px].
    """
    shot = FilmCamera(env, width, height).capture(state)
    goals = get_goal_markers(env.bank, state, shot.boxes)
    house = int(state.world.house)
    path = shortest_path(env.bank, house, _feet_of(env, shot), goals)
    overlay = TopDownOverlay(env.bank, house)
    return StatePictures(shot.view, overlay.draw(scene_without_agents(env, state), [shot], goals, path))


def shortest_path(
    bank: HouseBank, house: int, feet: Float[np.ndarray, " 3"], goals: GoalMarkers
) -> Float[np.ndarray, "n 3"]:
    """Return points on the floor along the shortest path from `feet` to goal rooms, else to the nearest goal point [m].

    Points are centres of cells; the last is in a goal room, or in the cell nearest to the goal point. There are no
    points (0, 3) without a goal or a path. `feet` is the agent's lowest point [m].
    """
    graph = CellGraph(bank, house)
    ends = find_goal_cells(graph, goals)
    return np.zeros((0, 3)) if ends is None else graph.shortest_path(feet, ends)


def find_goal_cells(graph: CellGraph, goals: GoalMarkers) -> EndCells | None:
    """Return the cells of goal rooms, else those nearest to goal points, for paths to them; None without a goal."""
    if goals.rooms.any():
        return graph.cells_in_rooms(goals.rooms)
    ends = [_cells_at(graph, np.asarray(place, np.float64)) for place in goals.places]
    if not ends:
        return None
    cells, lengths = (np.concatenate(part) for part in zip(*ends, strict=True))
    return cells, lengths


def _cells_at(graph: CellGraph, place: Float[np.ndarray, " 3"]) -> EndCells:
    """Return the cell (1,) nearest to a place on the storey below it, else anywhere, and its plan distance [m]."""
    high = place + np.array([0.0, 0.0, GOAL_HEIGHT_MARGIN])
    cells, lengths = graph.nearest_cells(high, high, 1)
    return (cells, lengths) if len(cells) else graph.nearest_cell(place)


def _facts(core: HouseholdEnv, params: EnvParams, state: State) -> _Facts:
    """Gather pose, contacts, room and surroundings of one environment's state for the report; to be jitted."""
    snapshot = core.snapshot(params, state)
    contacts, bank, house = snapshot.body_contacts, snapshot.bank, snapshot.house
    meaning, (gap, near) = contact_semantics(snapshot.scene, contacts), _surroundings(core, snapshot)
    return _Facts(
        feet=snapshot.feet,
        yaw=snapshot.pose.yaw,
        pitch=snapshot.pose.pitch,
        velocity=snapshot.velocity,
        cell=jax.vmap(lambda feet: cell_at_feet(bank, house, feet))(snapshot.feet),
        room=jax.vmap(lambda feet: room_at_feet(bank, house, feet))(snapshot.feet),
        in_contact=snapshot.in_contact,
        held=snapshot.held,
        impulse=contacts.contact_impulse,
        contact=contacts.contact_pos,
        partner=contacts.contact_partner,
        body=meaning.body,
        other=meaning.other,
        boxes=current_boxes(snapshot),
        gap=gap,
        near=near,
    )


def _surroundings(core: HouseholdEnv, snapshot: Snapshot) -> tuple[Array, Array]:
    """Return agents' free distances [m] and the semantics of obstacles there, (A, H, D) and (A, H, D, columns).

    Distances are beyond the body, inf over `MAX_GAP`, where semantics are -1; negative within the body's radius. H is
    `RAY_HEIGHTS`, D directions counter-clockwise from ahead.
    """
    agents = core.config.agents
    half = jnp.array([body.height / 2 for body in agents], jnp.float32)
    radius = jnp.array([body.radius for body in agents], jnp.float32)
    own = agent_ids(snapshot.bank, len(agents))
    angle = jnp.linspace(0.0, 2 * jnp.pi, NUM_DIRECTIONS, endpoint=False, dtype=jnp.float32)

    def of_agent(pos: Array, yaw: Array, half: Array, radius: Array, own: Array) -> tuple[Array, Array]:
        """Cast rays around one agent; return gaps (H, D) and semantic rows."""
        height = half * jnp.array(RAY_HEIGHTS, jnp.float32)
        origin = pos[None, None] + jnp.zeros((len(RAY_HEIGHTS), NUM_DIRECTIONS, 3)).at[..., 2].set(height[:, None])
        plan = jnp.stack([jnp.cos(yaw + angle), jnp.sin(yaw + angle), jnp.zeros(NUM_DIRECTIONS)], axis=-1)
        direction = jnp.broadcast_to(plan, origin.shape)
        hit = cast(snapshot.scene, origin, direction, t_max=radius + MAX_GAP, exclude=own)
        rows = jnp.stack([semantics(snapshot.scene, hit, column) for column in Semantic], axis=-1)
        return hit.t - radius, rows

    pose = snapshot.pose
    found = [of_agent(pose.pos[a], pose.yaw[a], half[a], radius[a], own[a]) for a in range(len(agents))]
    return tuple(jnp.stack(part) for part in zip(*found, strict=True))  # pyright: ignore[reportReturnType]


def _feet_of(env: Env[HouseholdEnv], shot: CameraShot) -> Float[np.ndarray, " 3"]:
    """Return the lowest point of the first agent [m]."""
    return shot.pos[0] - np.array([0.0, 0.0, env.config.agents[0].height / 2], np.float32)


def _describe_task(env: Env[HouseholdEnv], state: State) -> str:
    """Describe task, instruction, step and end of the episode."""
    instruction = get_instruction(env, state)
    over = "terminated" if bool(state.terminated) else "truncated" if bool(state.truncated) else "running"
    text = "" if instruction.text == instruction.task else f": {instruction.text}"
    step = f"step {int(state.world.step)} of {env.config.episode_length}"
    episode = int(state.world.episode)
    return f"{instruction.task}{text}; {step}, {over}" + (f", row {episode}" if episode >= 0 else "")


def _describe_agent(bank: HouseBank, house: int, facts: _Facts, agent: int) -> list[str]:
    """Return the lines of one agent: pose, room, motion, contact, things beside it, and the object in its hand."""
    forward, left, turn = facts.velocity[agent]
    pose = f"feet at {_point(facts.feet[agent])} m, yaw {np.rad2deg(facts.yaw[agent]):.0f}°"
    pose += f", pitch {np.rad2deg(facts.pitch[agent]):.0f}°"
    lines = [_line(f"agent {agent}", pose), _line("", f"in {_describe_room(bank, house, facts, agent)}")]
    lines += [_line("", f"walks {forward:.2f} m/s forward, {left:.2f} m/s left; turns {turn:.2f} rad/s left")]
    lines += [_line("", _describe_contact(facts, agent))]
    lines += [_line("", text) for text in _describe_surroundings(facts, agent)]
    if facts.held[agent] >= 0:
        body = facts.body[len(facts.yaw) + int(facts.held[agent])]
        lines += [_line("", f"holds {_name(body)} (body {int(facts.held[agent])})")]
    return lines


def _describe_room(bank: HouseBank, house: int, facts: _Facts, agent: int) -> str:
    """Describe the room, or `no room`, and the storey of an agent; both are counted from 0."""
    room, level = int(facts.room[agent]), int(facts.cell[agent][0])
    storey = f"storey {level} of {int(np.isfinite(np.asarray(bank.navigation.floor[house])).sum())}"
    if room < 0:
        return f"no room; {storey}"
    return f"{_name_room(bank, house, room)}, {storey}"


def _name_room(bank: HouseBank, house: int, room: int) -> str:
    """Return a text with the number of a room, from 0, and its first type or `no type`."""
    kind = int(bank.navigation.room_type[house, room])
    return f"room {room} ({ROOM_TYPES[kind] if kind >= 0 else 'no type'})"


def _describe_contact(facts: _Facts, agent: int) -> str:
    """Return a text on contacts of an agent besides the floor, with impulse and position."""
    if not facts.in_contact[agent]:
        return "touches nothing but the floor"
    if facts.partner[agent] == NOTHING:
        return "touches something (this physics does not record what)"
    if facts.partner[agent] == FLOOR:
        return f"touches something beside it; its strongest contact is the floor with {_strength(facts, agent)}"
    return f"touches {_partner_name(facts, agent)} with {_strength(facts, agent)}"


def _describe_surroundings(facts: _Facts, agent: int) -> list[str]:
    """Return texts on at most `MAX_NEIGHBOURS` obstacles within `MAX_GAP` beyond the body, nearest first.

    Of obstacles with equal descriptions only the nearest is listed; distances within the body are 0.
    """
    nearest: dict[str, tuple[float, int]] = {}
    for number in np.argsort(facts.gap[agent], axis=None, kind="stable"):
        at = np.unravel_index(number, facts.gap[agent].shape)
        if np.isfinite(facts.gap[agent][at]):
            nearest.setdefault(_name(facts.near[agent][at]), (float(facts.gap[agent][at]), int(at[1])))
    return [
        f"beside {name}, {max(gap, 0.0):.2f} m from the body, {_side(number)}"
        for name, (gap, number) in list(nearest.items())[:MAX_NEIGHBOURS]
    ]


def _side(number: int) -> str:
    """Return a direction of `_surroundings` in words.

    Example:
        >>> _side(0), _side(NUM_DIRECTIONS // 4), _side(NUM_DIRECTIONS - 1)
        ('ahead', 'to the left', 'ahead')
    """
    return SIDES[round(number * len(SIDES) / NUM_DIRECTIONS) % len(SIDES)]


def _describe_touching_bodies(facts: _Facts, num_agents: int) -> list[str]:
    """Return a line for each object or door whose strongest contact is an agent."""
    rows = [k for k in range(num_agents, len(facts.partner)) if 0 <= facts.partner[k] < num_agents]
    return [
        _line("contact", f"{_name(facts.body[k])} touches agent {facts.partner[k]} with {_strength(facts, k)}")
        for k in rows
    ]


def _partner_name(facts: _Facts, row: int) -> str:
    """Name the other side of a dynamic body's strongest contact: `agent` and its number, or a description."""
    partner = int(facts.partner[row])
    return f"agent {partner}" if 0 <= partner < len(facts.yaw) else _name(facts.other[row])


def _strength(facts: _Facts, row: int) -> str:
    """Format impulse and position of a dynamic body's strongest contact."""
    return f"{facts.impulse[row]:.3g} N s at {_point(facts.contact[row])} m"


def _describe_goals(bank: HouseBank, state: State, facts: _Facts) -> list[str]:
    """Return texts on the rooms and points that are goals of the current stage; none without a goal."""
    goals = get_goal_markers(bank, state, facts.boxes)
    rooms = [_name_room(bank, int(state.world.house), room) for room in np.flatnonzero(goals.rooms).tolist()]
    return rooms + [f"at {_point(place)} m" for place in goals.places]


def _describe_not_a_number(state: State) -> list[str]:
    """Return one line that names the arrays with NaN in a state, except its `info`; no line without NaN."""
    leaves = jax.tree_util.tree_leaves_with_path(state.replace(info={}))
    found = [
        jax.tree_util.keystr(place)
        for place, leaf in leaves
        if np.issubdtype(np.asarray(leaf).dtype, np.floating) and np.isnan(np.asarray(leaf)).any()
    ]
    return [_line("NaN", f"in {', '.join(found)}")] if found else []


def _name(row: np.ndarray) -> str:
    """Return a row of semantics in words, such as `wall (white, tile) of the Bathroom`; `something` if unknown."""
    known = decode_row(row)
    kind, color, material, room = (known.get(column) for column in COLUMNS)
    looks = ", ".join(str(word) for word in (color, material) if word is not None)
    return f"{kind or 'something'}{f' ({looks})' if looks else ''}{f' of the {room}' if room else ''}"


def _point(point: np.ndarray) -> str:
    """Format coordinates with two decimals."""
    return f"({', '.join(f'{value:.2f}' for value in point)})"


def _line(title: str, text: str) -> str:
    """Format a line of the report: title column, then text."""
    return f"{title:<{TITLE_WIDTH}}{text}"
