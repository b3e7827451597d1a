"""One house in C MuJoCo: its model, and the index maps between the model and the state."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import mujoco
import numpy as np
from jaxtyping import Float

from home_mjx.physics.base.layout import Layout
from home_mjx.physics.base.state import FLOOR, NOTHING, STATIC
from home_mjx.physics.mujoco.contact_impulses import ContactReport, collect_contacts

OVERFLOW_WARNINGS = ("CONTACTFULL", "CNSTRFULL")  # MuJoCo's warnings about dropped contacts


class HouseStepResult(NamedTuple):
    """An environment after a physics step."""

    qpos: Float[np.ndarray, " q"]
    qvel: Float[np.ndarray, " v"]
    qacc: Float[np.ndarray, " v"]
    contacts: ContactReport
    has_overflow: bool  # contacts were dropped


class MujocoHouse:
    """Stepper for environments of one house; thread-safe.

    Args:
        model: A `mujoco.MjModel` whose floor is the geom `floor`.
        layout: Layout of the state.
        names: Name of each dynamic body, in the state's order; "" if the house has none. The sizes of its joints match
            the state's layout.
        static: Static box index of each static geom, by its name.
    """

    def __init__(self, model: Any, layout: Layout, names: Sequence[str], static: Mapping[str, int]) -> None:
        self.model, self._layout = model, layout
        self._spare: list[Any] = []  # pool of unused `mujoco.MjData`
        self._qpos, self._dofs = np.zeros(model.nq, int), np.zeros(model.nv, int)  # state index of each model element
        owner = np.full(model.nbody, NOTHING)
        q = v = 0
        for mobile, name in enumerate(names):
            nq, nv = _state_sizes(layout, mobile)
            if name:
                body = model.body(name)
                joint = body.jntadr[0]
                self._qpos[model.jnt_qposadr[joint] + np.arange(nq)] = q + np.arange(nq)
                self._dofs[model.jnt_dofadr[joint] + np.arange(nv)] = v + np.arange(nv)
                owner[body.id] = mobile
            q, v = q + nq, v + nv
        named = {"floor": FLOOR} | {geom: STATIC - number for geom, number in static.items()}
        self._owner = owner[model.geom_bodyid]
        for name, code in named.items():
            self._owner[model.geom(name).id] = code

    def step(
        self,
        qpos: Float[np.ndarray, " q"],
        qvel: Float[np.ndarray, " v"],
        qacc: Float[np.ndarray, " v"],
        applied: Float[np.ndarray, " v"],
    ) -> HouseStepResult:
        """Advance by one physics step; arrays are as in `PhysicsState`, and `qacc` is the solver's warm start.

        Bodies that the house does not have keep their state, with `qacc` 0. With NaN or infinite `qpos`, `qvel` or
        `applied`, the given arrays are returned, without contacts; else the result is new. `qacc` must be finite, and
        is not checked. `applied` are the forces on all joints [N], [N m]; those on missing bodies are ignored.
        """
        if not all(np.isfinite(x).all() for x in (qpos, qvel, applied)):  # MuJoCo would write a log file
            mobiles = self._layout.num_dynamic
            zeros, nothing = np.zeros(mobiles), np.full(mobiles, NOTHING)
            none = ContactReport(np.zeros(self._layout.num_agents, int), zeros, zeros, np.zeros((mobiles, 3)), nothing)
            return HouseStepResult(qpos, qvel, qacc, none, False)
        data = self._take()
        try:
            data.qpos[:], data.qvel[:] = qpos[self._qpos], qvel[self._dofs]
            data.qacc_warmstart[:], data.qfrc_applied[:] = qacc[self._dofs], applied[self._dofs]
            mujoco.mj_step(self.model, data)  # pyright: ignore[reportAttributeAccessIssue]
            after = qpos.copy(), qvel.copy(), np.zeros_like(qacc)
            after[0][self._qpos] = data.qpos
            after[1][self._dofs], after[2][self._dofs] = data.qvel, data.qacc
            touched = collect_contacts(data, self._owner, self._layout, self.model.opt.timestep)
            return HouseStepResult(*after, touched, _has_overflow(data))
        finally:
            self._spare.append(data)

    def initial_poses(self, qpos: Float[np.ndarray, " q"]) -> Float[np.ndarray, " q"]:
        """Return a copy of `qpos` with the agents, bodies and doors of the house at `qpos0`; unused rows are kept.

        In `qpos0`, agents are at the world's origin; so are movable bodies, except in models of exported houses.
        """
        after = qpos.copy()
        after[self._qpos] = self.model.qpos0
        return after

    def _take(self) -> Any:
        """Remove and return a spare `MjData`, or a new one if none is left; the caller puts it back in `_spare`.

        A spare one contains an earlier step, also of another environment.
        """
        try:
            return self._spare.pop()
        except IndexError:
            return mujoco.MjData(self.model)  # pyright: ignore[reportAttributeAccessIssue]


def _state_sizes(layout: Layout, mobile: int) -> tuple[int, int]:
    """Return a dynamic body's number of elements in the state's `qpos` and `qvel`; its index is not checked."""
    if mobile < layout.num_agents:
        return 4, 4
    return (7, 6) if mobile < layout.num_agents + layout.num_bodies else (1, 1)


def _has_overflow(data: Any) -> bool:
    """Return whether MuJoCo has dropped contacts (`OVERFLOW_WARNINGS`) since the last call on this `mujoco.MjData`.

    Reset these warning counters.
    """
    warnings = [data.warning[getattr(mujoco.mjtWarning, f"mjWARN_{name}")] for name in OVERFLOW_WARNINGS]  # pyright: ignore[reportAttributeAccessIssue]
    full = any(warning.number for warning in warnings)
    for warning in warnings:
        warning.number = 0
    return full
