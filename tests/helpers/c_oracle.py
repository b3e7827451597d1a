"""C MuJoCo with every static box in reach of every owner, as an oracle of the fused step; converged."""

import itertools
from typing import NamedTuple

import mujoco
import numpy as np
from numba import njit, types

from home_mjx.core.native.memory import pointer_to
from home_mjx.physics import PhysicsConfig
from home_mjx.physics.base.layout import Layout
from home_mjx.physics.native.numbers import numbers_of
from home_mjx.physics.native.step import load_agents, load_house, step_env
from home_mjx.physics.native.work import NEWTON_STEPS, NUM_CONTACTS, free_work, make_work
from home_mjx.physics.reference.template_mjcf import CORNER_RADIUS, template_mjcf

floats, ints = pointer_to(types.float64), pointer_to(types.int64)
CORNERS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))


class Boxes(NamedTuple):
    pos: np.ndarray
    quat: np.ndarray
    half: np.ndarray


def two_geoms(first: str, second: str) -> tuple:
    """A model of two free geoms, given by their attributes."""
    text = "".join(f'<body><freejoint/><geom name="{n}" {g}/></body>' for n, g in (("a", first), ("b", second)))
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{text}</worldbody></mujoco>")
    return model, mujoco.MjData(model)


def place(model, data, geom: int, pos, quat, half) -> None:
    """Moves a geom of `two_geoms`; half extents: of a box, or None."""
    if half is not None:
        model.geom_size[geom], model.geom_rbound[geom], model.geom_aabb[geom, 3:] = half, np.linalg.norm(half), half
    data.qpos[7 * geom : 7 * geom + 7] = np.r_[pos, quat]


def contacts_of(data) -> np.ndarray:
    """Rows of position, distance and normal, sorted."""
    rows = [np.r_[c.pos, c.dist, c.frame[:3]] for c in data.contact]
    return ordered(np.array(rows).reshape(-1, 7))


def ordered(rows: np.ndarray) -> np.ndarray:
    return rows[np.lexsort(np.round(rows, 6).T[::-1])]


class Oracle:
    """One environment as C MuJoCo and the fused step see it."""

    def __init__(self, config: PhysicsConfig, static: Boxes, bodies: Boxes, mass: np.ndarray):
        self.config, self.agents = config, config.num_agents
        self.layout = Layout(config.num_agents, len(mass), len(static.pos), len(static.pos))
        self.inertia = mass[:, None] / 3 * (bodies.half[:, [1, 0, 0]] ** 2 + bodies.half[:, [2, 2, 1]] ** 2)
        self.static, self.bodies, self.mass = static, bodies, mass
        self.model = self._model()
        self.data = mujoco.MjData(self.model)
        self.numbers = numbers_of(config, float(self.model.dof_M0[3]))

    def _model(self):
        model = mujoco.MjModel.from_xml_string(template_mjcf(self.config, self.layout, "dense"))
        model.opt.iterations, model.opt.ls_iterations, model.opt.tolerance = 100, 100, 1e-14
        model.geom_pos[0, 2] = 0
        for row in np.arange(model.ngeom)[self.layout.slots].reshape(-1, len(self.static.pos)):
            model.geom_pos[row], model.geom_quat[row] = self.static.pos, self.static.quat
            _resize(model, row, self.static.half)
        first = 1 + self.layout.num_slots + 2 * self.agents
        for k, half in enumerate(self.bodies.half):
            body, geom, q = 1 + self.agents + k, first + 9 * k, 4 * self.agents + 7 * k
            model.body_mass[body], model.body_inertia[body] = self.mass[k], self.inertia[k]
            model.body_pos[body], model.body_quat[body] = self.bodies.pos[k], self.bodies.quat[k]
            model.qpos0[q : q + 7] = np.r_[self.bodies.pos[k], self.bodies.quat[k]]
            _resize(model, geom, half)
            model.geom_pos[geom + 1 : geom + 9] = CORNERS * (half - CORNER_RADIUS)
        mujoco.mj_setConst(model, mujoco.MjData(model))
        return model

    def accelerations(self, qpos, qvel, action) -> tuple[np.ndarray, int]:
        """Of C MuJoCo, and how many contacts it has."""
        data, config = self.data, self.config
        data.qpos[:], data.qvel[:] = qpos, qvel
        for a in range(self.agents):
            yaw, velocity = qpos[4 * a + 3], qvel[4 * a : 4 * a + 4]
            target = action[a] * [config.forward_speed, config.strafe_speed, config.turn_rate]
            turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
            force = config.body.mass * (turn @ target[:2] - velocity[:2]) / config.response_time
            force *= min(1.0, config.push_force / max(np.linalg.norm(force), 1e-9))
            torque = self.numbers.yaw_inertia * (target[2] - velocity[3]) / config.response_time
            data.ctrl[3 * a : 3 * a + 3] = [*force, torque]
        data.qacc_warmstart[:] = 0
        mujoco.mj_forward(self.model, data)
        return data.qacc.copy(), data.ncon

    def fused(
        self, qpos, qvel, action, substeps: int = 1
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, int, np.ndarray]:
        """qpos, qvel and accelerations after physics steps of the fused step; contacts; what was lost."""
        static = (*(x.ravel() for x in self.static), np.ones(len(self.mass), np.int64))
        house = (*static, self.bodies.half.ravel(), self.mass, self.inertia.ravel())
        out = np.zeros(len(qpos)), np.zeros(len(qvel)), np.zeros(len(qvel))
        touched, lost = np.zeros(self.agents, np.int64), np.zeros(2, np.int64)
        numbers = self.numbers._replace(substeps=float(substeps))
        sizes = self.agents, len(self.mass), len(self.static.pos)
        count, self.newton_steps = _fused(
            numbers, sizes, house, (qpos, qvel, np.zeros(len(qvel))), action.ravel(), out, touched, lost
        )
        return *out, count, lost


def _resize(model, geom, half) -> None:
    model.geom_size[geom], model.geom_rbound[geom] = half, np.linalg.norm(half, axis=-1)
    model.geom_aabb[geom] = np.concatenate([np.zeros_like(half), half], axis=-1)


@njit
def _fused(numbers, sizes, house, state, action, out, touched, lost):
    work = make_work(sizes[0], sizes[1], sizes[2])
    load_agents(work, numbers)
    pos, quat, half, valid, size, mass, inertia = house
    load_house(work, _at(pos), _at(quat), _at(half), ints(valid.ctypes.data), _at(size), _at(mass), _at(inertia))
    before = _at(state[0]), _at(state[1]), _at(state[2])
    after = _at(out[0]), _at(out[1]), _at(out[2])
    step_env(work, numbers, 0.0, before, _at(action), after, ints(touched.ctypes.data), ints(lost.ctypes.data))
    count, steps = work.counts[NUM_CONTACTS], work.counts[NEWTON_STEPS]
    free_work(work)
    return count, steps


@njit
def _at(array):
    return floats(array.ctypes.data)
