"""Visual model of agents: a capsule with a visor on its front side (+x)."""

import numpy as np
from jaxtyping import Float, Int

from home_mjx.geometry.meshes import box_triangles, make_model
from home_mjx.schema.agent import AgentBody
from home_mjx.schema.compiled import Model
from home_mjx.schema.semantic import semantic_row

RADIUS, HEIGHT = AgentBody().radius, AgentBody().height  # [m]; scenes scale the model to other bodies
VISOR_CENTER = (0.09, 0.0, AgentBody().eye_height - HEIGHT / 2)  # [m], at eye height
VISOR_SIZE = (0.07, 0.12, 0.06)  # [m]
SEGMENTS = 16  # around the axis
RINGS = 4  # per hemisphere


def agent_model() -> Model:
    """Build the agent's library model: origin mid-capsule, Z up, facing +x; material slots body and visor."""
    body = _capsule()
    visor = box_triangles(np.array(VISOR_CENTER), np.array(VISOR_SIZE) / 2)
    slot = np.repeat([0, 1], [len(body), len(visor)])
    return make_model("agent", np.concatenate([body, visor]), slot=slot)


def agent_semantics() -> Int[np.ndarray, "1 columns"]:
    """Return the semantic row shared by all agents; the instance of a hit identifies the agent."""
    return semantic_row("person", "person", "person")[None]


def _capsule() -> Float[np.ndarray, "t 3 3"]:
    """Build the triangles of a capsule along z, counter-clockwise outwards."""
    angle = np.linspace(-np.pi / 2, 0, RINGS + 1)
    radius = RADIUS * np.cos(np.concatenate([angle, -angle[::-1]]))
    shift = np.repeat([-1, 1], RINGS + 1) * (HEIGHT / 2 - RADIUS)
    z = RADIUS * np.sin(np.concatenate([angle, -angle[::-1]])) + shift
    turn = np.arange(SEGMENTS) * 2 * np.pi / SEGMENTS
    xy = radius[:, None, None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    points = np.concatenate([xy, np.broadcast_to(z[:, None, None], (*xy.shape[:2], 1))], axis=-1)
    lower, upper = points[:-1], points[1:]
    lower_next, upper_next = np.roll(lower, -1, axis=1), np.roll(upper, -1, axis=1)
    quads = [[lower, lower_next, upper_next], [lower, upper_next, upper]]
    triangles = np.concatenate([np.stack(q, axis=2).reshape(-1, 3, 3) for q in quads])
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return triangles[np.linalg.norm(normal, axis=1) > 1e-9]
