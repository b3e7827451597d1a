"""Any MuJoCo model, stepped by C MuJoCo inside `jit`; for example a house with a robot."""

import itertools
import threading
from collections.abc import Sequence
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
from jaxtyping import Array, Float
from mujoco import rollout

from home_mjx.core.checks import check_number, check_shape
from home_mjx.core.native.fork_guard import check_not_forked
from home_mjx.core.native.host_call import register_host_call
from home_mjx.core.native.partition import varying_as
from home_mjx.core.native.vmap_call import batch_kernel, forbid_gradient
from home_mjx.core.workers import usable_cores
from home_mjx.errors import ConfigError

STATE_SPEC = mujoco.mjtState.mjSTATE_FULLPHYSICS.value  # pyright: ignore[reportAttributeAccessIssue]

_count = itertools.count()


class MujocoModel:
    """C MuJoCo stepper for environments of one model; build it once, outside of `jit`.

    A state is one vector: MuJoCo's `mjSTATE_FULLPHYSICS` (time, `qpos`, `qvel`, activations), in float32. `step` works
    under `jit`, `vmap` and `scan`, on CPUs only, and has no gradient. Environments are distributed over all cores.

    Args:
        model: A `mujoco.MjModel`; do not change it afterwards.
        substeps: Physics steps per call of `step`.

    Attributes:
        start: State at `qpos0`, at rest.
        qpos: Slice of `qpos` in a state.
        qvel: Slice of `qvel` in a state.

    Raises:
        ConfigError: `substeps` is not a whole number of at least 1.

    Example:
        >>> house = MujocoModel(robot_in_house(compiled, "robot.xml").compile(), substeps=5)  # doctest: +SKIP
        >>> states = jnp.tile(house.start, (64, 1))  # doctest: +SKIP
        >>> states, sensors = jax.jit(jax.vmap(house.step))(states, jnp.zeros((64, house.model.nu)))  # doctest: +SKIP
    """

    def __init__(self, model: Any, substeps: int = 1) -> None:
        check_number("substeps", substeps, 1, integer=True)
        self.model, self._substeps = model, substeps
        self.qpos, self.qvel = slice(1, 1 + model.nq), slice(1 + model.nq, 1 + model.nq + model.nv)
        self._data = [mujoco.MjData(model) for _ in range(usable_cores())]  # pyright: ignore[reportAttributeAccessIssue]
        self._pool, self._lock = rollout.Rollout(nthread=usable_cores()), threading.Lock()
        start = np.zeros(mujoco.mj_stateSize(model, STATE_SPEC))  # pyright: ignore[reportAttributeAccessIssue]
        mujoco.mj_getState(model, self._data[0], start, STATE_SPEC)  # pyright: ignore[reportAttributeAccessIssue]
        self.start = jnp.asarray(start, jnp.float32)
        self._target = f"home_mjx_c_model_{next(_count)}"
        register_host_call(self._target, self._run)
        self._step = forbid_gradient(batch_kernel(self._call, 0, 2), "C MuJoCo")

    def step(
        self, state: Float[Array, " s"], ctrl: Float[Array, " u"]
    ) -> tuple[Float[Array, " s"], Float[Array, " n"]]:
        """Advance one environment by `substeps` physics steps; use `vmap` for more.

        After a warning of MuJoCo, the remaining physics steps are skipped. An unstable state, such as NaN, is replaced
        by `start` unless the model disables `autoreset`. Neither is reported.

        Args:
            state: State vector, like `start`.
            ctrl: Controls of the model's actuators, the same in all physics steps.

        Returns:
            The state after the step, and MuJoCo's `sensordata` of the last physics step.

        Raises:
            ConfigError: `state` or `ctrl` does not have the model's length, the program is compiled for a platform
                other than CPU, or a gradient is requested.
            BackendError: This is a forked child of a process that has already stepped.
        """
        check_shape("state", jnp.shape(state), self.start.shape)
        check_shape("ctrl", jnp.shape(ctrl), (self.model.nu,))
        check_platform()
        after, sensors = self._step(state[None], ctrl[None])
        return after[0], sensors[0]

    def _call(self, state: Array, ctrl: Array) -> tuple[Array, ...]:
        """Call `_run` on a batch: states (e, s) and controls (e, u) to states and sensor data."""
        shapes = state.shape, (state.shape[0], self.model.nsensordata)
        results = [jax.ShapeDtypeStruct(shape, jnp.float32) for shape in shapes]
        return call_host(self._target, (ctrl.astype(jnp.float32), state.astype(jnp.float32)), results)

    def _run(self, given: Sequence[np.ndarray], results: Sequence[np.ndarray]) -> None:
        """Step all environments by C MuJoCo's threaded rollout in float64; the host function of `step`.

        `given` is controls (e, u), then states (e, s). `results` receive the states and the last sensor data. Calls on
        several threads run one after another.
        """
        ctrl, state = (x.astype(np.float64) for x in given)
        with self._lock:
            states, sensors = self._pool.rollout(
                self.model, self._data, state, ctrl[:, None], nstep=self._substeps, chunk_size=1
            )
        results[0][:], results[1][:] = (np.asarray(x)[:, -1] for x in (states, sensors))


def call_host(target: str, operands: Sequence[Array], results: Sequence[jax.ShapeDtypeStruct]) -> tuple[Array, ...]:
    """Call a host function of `register_host_call` on environments (e, ...); an empty batch gives zeros without a call.

    `results` are the shapes and types of the results. The last operand determines the size of the batch; the others may
    be shared by all environments. There is no rule for `vmap`: wrap the caller with `batch_kernel`.
    """
    if operands[-1].shape[0] == 0:
        return tuple(jnp.zeros(x.shape, x.dtype) for x in results)
    return varying_as(operands, jax.ffi.ffi_call(target, results)(*operands))


def check_platform() -> None:
    """Raise an error, while tracing, if C MuJoCo cannot run the program.

    Only JAX's default device or, without one, its default backend is checked, not the devices of arrays.

    Raises:
        ConfigError: JAX's default device is a GPU or TPU; C MuJoCo runs on the host.
        BackendError: This is a forked child of a process that has already stepped.
    """
    check_not_forked("step physics")
    device = jax.config.jax_default_device  # pyright: ignore[reportAttributeAccessIssue]
    platform = jax.default_backend() if device is None else getattr(device, "platform", device)
    if platform != "cpu":
        raise ConfigError(
            f"C MuJoCo runs on CPUs only, but this program is compiled for `{platform}` here",
            element="PhysicsConfig.impl",
            hint="Set JAX_PLATFORMS=cpu, or write `with jax.default_device(jax.devices('cpu')[0]):`",
        )
