"""The model shared by all houses of one capacity."""

import functools

import jax
import mujoco
import numpy as np
from mujoco import mjx

from home_mjx.bank.records import BankSpec
from home_mjx.core.native.partition import run_untraced
from home_mjx.physics.base.config import PhysicsConfig, PhysicsSetup
from home_mjx.physics.base.control import agent_table
from home_mjx.physics.base.layout import Layout
from home_mjx.physics.mjx.overflow import GeomPairs, numeric_limit
from home_mjx.physics.mjx.template_mjcf import template_mjcf
from home_mjx.schema.agent import AgentBody
from home_mjx.schema.timing import Timing


class Template:
    """The model shared by all houses of one capacity.

    Build it once, outside of any trace.

    Args:
        config: Options; a `PhysicsSetup` for other bodies or time steps than the defaults.
        spec: Capacities of the bank.

    Attributes:
        config: The options with body and time steps.

    Example:
        >>> from home_mjx.bank.records import BankSpec
        >>> spec = BankSpec(64, 8, 8, 16, 4, 0.1, 0.1, 1.6)
        >>> Template(PhysicsConfig(), spec).model.nv
        60
    """

    def __init__(self, config: PhysicsConfig, spec: BankSpec) -> None:
        is_setup = isinstance(config, PhysicsSetup)
        self.config = config = config if is_setup else PhysicsSetup.compose(config, AgentBody(), Timing())
        self.layout = Layout(
            config.num_agents,
            spec.num_bodies,
            spec.num_doors,
            config.agent_slots,
            config.body_slots,
            spec.num_slides,
            spec.num_tray_boxes,
        )
        xml = template_mjcf(config, self.layout, _jacobian(config))
        host = mujoco.MjModel.from_xml_string(xml)  # pyright: ignore[reportAttributeAccessIssue]
        self.agents = agent_table(config, host.dof_M0[3 : self.layout.agent_qpos.stop : 4])
        self._host = host
        self.pairs = GeomPairs.from_model(host)
        self.max_points = numeric_limit(host, "max_contact_points")
        self.geom_body = host.geom_bodyid - 1  # dynamic body of each geom; -1 for geoms of the world
        self.pair_bodies = self.geom_body[np.stack([host.pair_geom1, host.pair_geom2], axis=1)]

    @functools.cached_property
    def model(self) -> mjx.Model:
        """MJX model, created on first use since the fused step does not need it."""
        return run_untraced(lambda: mjx.put_model(self._host))

    @functools.cached_property
    def data(self) -> mjx.Data:
        """MJX data with the initial `qpos`, made on first use; derived fields such as `xpos` are 0."""
        return run_untraced(lambda: mjx.make_data(self.model))


def _jacobian(config: PhysicsSetup) -> str:
    """Return MuJoCo's `jacobian` option, with "auto" resolved to sparse on CPUs and dense elsewhere.

    The platform is JAX's default backend at the time of the call.
    """
    if config.jacobian != "auto":
        return config.jacobian
    return "sparse" if jax.default_backend() == "cpu" else "dense"
