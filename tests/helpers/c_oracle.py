"""C MuJoCo with every static box in reach of every owner, as an oracle of the fused step; converged."""

import itertools
from typing import NamedTuple

import mujoco
import numpy as np
from numba import njit, types

from home_mjx.core.native.memory import pointer_to
from home_mjx.geometry.rotations import plane_matrix
from home_mjx.physics import PhysicsSetup
from home_mjx.physics.base import servo
from home_mjx.physics.base.control import YAW_INERTIA, agent_table
from home_mjx.physics.base.layout import Layout
from home_mjx.physics.base.surfaces import default_surface
from home_mjx.physics.mjx.template_mjcf import CORNER_RADIUS, template_mjcf
from home_mjx.physics.numba.chunks import sources_digest
from home_mjx.physics.numba.params import reference_surfaces, step_params
from home_mjx.physics.numba.step import load_agents, load_house, step_env
from home_mjx.physics.numba.workspace import NEWTON_STEPS, NUM_CONTACTS, allocate_workspace, free_workspace
from home_mjx.schema.mjcf import DOOR_DAMPING_RATE

floats, ints = pointer_to(types.float64), pointer_to(types.int64)
CORNERS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))


class Boxes(NamedTuple):
    pos: np.ndarray
    quat: np.ndarray
    half: np.ndarray


class Leaves(NamedTuple):
    """Of doors, as placed; the last ones slide."""

    pivot: np.ndarray
    arm: np.ndarray
    height: np.ndarray
    yaw: np.ndarray
    half: np.ndarray
    mass: np.ndarray
    range: np.ndarray
    slide: np.ndarray  # direction; 0: it turns
    tray: np.ndarray = np.zeros((0, 0, 6))  # of those that slide: centre and half extents in the leaf's frame

    @property
    def turns(self) -> np.ndarray:
        return (self.slide == 0).all(axis=1)

    @property
    def own_inertia(self) -> np.ndarray:
        square = self.half**2
        return self.mass[:, None] / 3 * (square[:, [1, 0, 0]] + square[:, [2, 2, 1]])


NO_DOORS = Leaves(*(np.zeros((0, *shape)) for shape in ((2,), (2,), (), (), (3,), (), (2,), (2,))))


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

    def __init__(
        self,
        config: PhysicsSetup,
        static: Boxes,
        bodies: Boxes,
        mass: np.ndarray,
        doors: Leaves = NO_DOORS,
        surfaces: np.ndarray | None = None,
    ):
        self.config, self.agents, self.doors = config, config.num_agents, doors
        slots, slides = len(static.pos), int((~doors.turns).sum())
        self.layout = Layout(config.num_agents, len(mass), len(doors.mass), slots, slots, slides, doors.tray.shape[1])
        self.inertia = mass[:, None] / 3 * (bodies.half[:, [1, 0, 0]] ** 2 + bodies.half[:, [2, 2, 1]] ** 2)
        self.static, self.bodies, self.mass = static, bodies, mass
        self.surfaces = np.tile(default_surface(config), (len(mass), 1)) if surfaces is None else surfaces
        self.model = self._model()
        self.data = mujoco.MjData(self.model)
        self.numbers = step_params(config)._replace(sleep=0.0)
        self.door_rows = self._door_rows()
        self.driven = np.full(self.agents, -1), np.zeros((self.agents, 7)), np.full(len(doors.mass), servo.NOT_DRIVEN)
        self.ramps = np.zeros((0, 8))
        self.table = agent_table(config, self.model.dof_M0[3 : 4 * self.agents : 4])

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
        self._add_doors(model)
        self._add_surfaces(model)
        mujoco.mj_setConst(model, mujoco.MjData(model))
        dof = self.layout.door_qvel
        model.dof_damping[dof] = DOOR_DAMPING_RATE * model.dof_M0[dof]
        return model

    def _add_surfaces(self, model) -> None:
        """MuJoCo's rules for what geoms have of their own, written into pairs: bodies have priority, agents more."""
        for pair, geoms in enumerate(zip(model.pair_geom1, model.pair_geom2, strict=True)):
            mobiles = [model.geom_bodyid[geom] - 1 for geom in geoms]
            if any(0 <= m < self.agents for m in mobiles):
                continue
            own = [self.surfaces[m - self.agents] for m in mobiles if self.agents <= m < self.agents + len(self.mass)]
            friction, *spring = np.max(own, axis=0)[:3]
            model.pair_friction[pair, :2], model.pair_solref[pair] = friction, -np.array(spring)
            model.pair_solimp[pair, [0, 2]] = np.mean(own, axis=0)[3:]

    def _add_doors(self, model) -> None:
        for h, (body, geom) in enumerate(
            zip(np.arange(model.nbody)[self.layout.doors], np.arange(model.ngeom)[self.layout.door_geoms], strict=True)
        ):
            doors = self.doors
            turned = [np.cos(doors.yaw[h] / 2), 0, 0, np.sin(doors.yaw[h] / 2)]
            model.body_pos[body] = [*doors.pivot[h], doors.height[h]]
            model.body_ipos[body] = model.geom_pos[geom] = [*doors.arm[h], 0]
            model.body_iquat[body] = model.geom_quat[geom] = turned
            model.body_mass[body], model.body_inertia[body] = doors.mass[h], doors.own_inertia[h]
            joint = model.body_jntadr[body]
            model.jnt_range[joint], model.jnt_axis[joint] = doors.range[h], [*doors.slide[h], doors.turns[h]]
            _resize(model, geom, doors.half[h])
            for t, (x, y, z, *half) in enumerate(self._tray(h), 1):
                turn = plane_matrix(doors.yaw[h])
                model.geom_pos[geom + t], model.geom_quat[geom + t] = [*(doors.arm[h] + turn @ [x, y]), z], turned
                _resize(model, geom + t, np.array(half))

    def _tray(self, h: int) -> np.ndarray:
        return (
            self.doors.tray[h - len(self.doors.mass)]
            if len(self.doors.tray) and not self.doors.turns[h]
            else np.zeros((0, 6))
        )

    def accelerations(self, qpos, qvel, action) -> tuple[np.ndarray, int]:
        """Of C MuJoCo, and how many contacts and joints at a limit it has."""
        data, config, body = self.data, self.config, self.config.body
        data.qpos[:], data.qvel[:] = qpos, qvel
        for a in range(self.agents):
            yaw, velocity = qpos[4 * a + 3], qvel[4 * a : 4 * a + 4]
            target = action[a] * [body.forward_speed, body.strafe_speed, body.turn_rate]
            turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
            force = body.mass * (turn @ target[:2] - velocity[:2]) / config.response_time
            force *= min(1.0, body.max_push_force / max(np.linalg.norm(force), 1e-9))
            torque = self.table[a, YAW_INERTIA] * (target[2] - velocity[3]) / config.response_time
            data.ctrl[3 * a : 3 * a + 3] = [*force, torque]
        data.qacc_warmstart[:] = 0
        mujoco.mj_forward(self.model, data)
        return data.qacc.copy(), data.ncon + data.nl

    def fused(
        self, qpos, qvel, action, substeps: int = 1
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, int, np.ndarray]:
        """qpos, qvel and accelerations after physics steps of the fused step; contacts; what was lost."""
        static = tuple(x.ravel() for x in self.static)
        rows = reference_surfaces(self.surfaces).ravel()
        bodies = np.ones(len(self.mass), np.int64), self.bodies.half.ravel(), self.mass, self.inertia.ravel(), rows
        out = np.zeros(len(qpos)), np.zeros(len(qvel)), np.zeros(len(qvel))
        mobiles = self.layout.num_dynamic
        self.push, self.other = np.zeros((mobiles, 4)), np.zeros(mobiles, np.int64)
        touched, lost = np.zeros(self.agents, np.int64), np.zeros(2, np.int64)
        # All of one type, so that Numba compiles once.
        numbers = type(self.numbers)(*map(float, self.numbers._replace(substeps=substeps)))
        trays = len(self.doors.tray)
        sizes = self.agents, len(self.mass), len(self.doors.mass), len(self.static.pos), trays
        table, door = self.table.ravel(), self.door_rows.ravel()
        held, grip, goal = self.driven
        control, ramps = (action.ravel(), held, grip.ravel(), goal), np.ascontiguousarray(self.ramps)
        state, report = (qpos, qvel, np.zeros(len(qvel))), (touched, lost, self.push.reshape(-1), self.other)
        count, self.newton_steps = _fused(
            numbers, sizes, (static, bodies, table, door, ramps), state, control, out, report
        )
        return *out, count, lost

    def drive(self, rng) -> None:
        """From now on hands hold bodies, doors have goals, and there are ramps; C MuJoCo does not know of them."""
        turned = rng.normal(size=(self.agents, 4))
        grip = np.c_[rng.uniform(-0.8, 0.8, (self.agents, 3)), turned / np.linalg.norm(turned, axis=-1, keepdims=True)]
        goal = np.where(
            rng.uniform(size=len(self.doors.mass)) < 0.7, rng.uniform(-2, 2, len(self.doors.mass)), servo.NOT_DRIVEN
        )
        held = rng.permutation(len(self.mass))[: self.agents] - (rng.uniform(size=self.agents) < 0.3) * 100
        self.driven = np.maximum(held, -1), grip.astype(np.float32).astype(float), goal.astype(np.float32).astype(float)

    def _door_rows(self) -> np.ndarray:
        """As the fused step takes them; inertia and inverse weight are those of C MuJoCo."""
        doors, model = self.doors, self.model
        inertia = model.dof_M0[self.layout.door_qvel]
        weight = model.body_invweight0[self.layout.doors, 0]
        box = np.c_[doors.pivot, doors.arm, doors.height, doors.yaw, doors.half]
        rows = np.c_[box, inertia, weight, doors.range, doors.slide, doors.turns]
        flat = doors.tray.reshape(len(doors.tray), 6 * doors.tray.shape[1])
        padded = np.pad(flat, ((0, 0), (0, 32 - flat.shape[1])))
        return np.concatenate([rows, padded.reshape(-1, 16)])


def _resize(model, geom, half) -> None:
    model.geom_size[geom], model.geom_rbound[geom] = half, np.linalg.norm(half, axis=-1)
    model.geom_aabb[geom] = np.concatenate([np.zeros_like(half), half], axis=-1)


def _compiled():
    digest = sources_digest()

    @njit(cache=True)
    def fused(numbers, sizes, house, state, control, out, report):
        _ = digest
        work = allocate_workspace(sizes[0], sizes[1], sizes[2], sizes[3], sizes[4])
        (pos, quat, half), (valid, size, mass, inertia, surface), table, door, ramps = house
        load_agents(work, _at(table))
        bodies = ints(valid.ctypes.data), _at(size), _at(mass), _at(inertia), _at(surface)
        load_house(work, (_at(pos), _at(half)), bodies, _at(door))
        before = _at(state[0]), _at(state[1]), _at(state[2])
        after = _at(out[0]), _at(out[1]), _at(out[2])
        action, held, grip, goal = control
        driven = _at(action), ints(held.ctypes.data), _at(grip), _at(goal)
        touched, lost, push, other = report
        said = ints(touched.ctypes.data), ints(lost.ctypes.data), _at(push), ints(other.ctypes.data)
        ground = 0.0, _at(ramps.reshape(-1)), len(ramps), _at(quat)
        step_env(work, numbers, ground, before, driven, after, said)
        count, steps = work.counts[NUM_CONTACTS], work.counts[NEWTON_STEPS]
        free_workspace(work)
        return count, steps

    return fused


@njit
def _at(array):
    return floats(array.ctypes.data)


_fused = _compiled()
