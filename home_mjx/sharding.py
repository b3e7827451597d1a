"""Environments over devices: the mesh, the partition specs of parameters and states, and collectives.

A mesh has one axis, `ENV_AXIS`. Environments are split over it: states, observations, actions, keys and everything else
with a leading environment axis. Networks and optimizers are replicated. Houses are replicated too, or each device holds
houses of its own. Specs are prefixes of pytrees, so this module does not depend on records of the environment.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

import jax
import jax.numpy as jnp
import numpy as np
from jax.sharding import AxisType, Mesh, NamedSharding, PartitionSpec
from jaxtyping import Array, Int

from home_mjx.errors import ConfigError

ENV_AXIS = "envs"  # mesh axis over which environments are split
REPLICATED = PartitionSpec()
BY_ENV = PartitionSpec(ENV_AXIS)
# jaxlib 0.11 ends in a segmentation fault when it compiles a `shard_map` over several devices with an argument that has
# no elements: a pass replaces the argument by a constant, and Shardy then crashes where it removes unused arguments.
EMPTY_ARGUMENTS_CRASH = jax.__version_info__[:2] == (0, 11)

T = TypeVar("T")


def make_mesh(devices: Sequence[Any] | None = None, axis_type: AxisType = AxisType.Auto) -> Mesh:
    """Return a mesh with the axis `ENV_AXIS` over `devices`, or all of JAX's.

    `AxisType.Explicit` gives results whose types have their sharding.
    """
    return Mesh(np.array(jax.devices() if devices is None else list(devices)), (ENV_AXIS,), axis_types=(axis_type,))


@dataclass(frozen=True)
class EnvSharding:
    """Sharding of environments over the devices of a mesh.

    Attributes:
        mesh: Mesh of `make_mesh`, with Auto or Explicit axes.
        split_houses: Each device holds houses of its own, see `put_params`; False: every device holds all houses.

    Example:
        >>> sharding = EnvSharding(make_mesh())
        >>> reset = sharding.map_envs(jax.vmap(env.core.reset, (None, 0)))  # doctest: +SKIP
        >>> states = reset(sharding.put_params(env.params), sharding.put_envs(keys))  # doctest: +SKIP
    """

    mesh: Mesh
    split_houses: bool = False

    @property
    def num_devices(self) -> int:
        """Number of devices."""
        return self.mesh.size

    @property
    def params(self) -> PartitionSpec:
        """Spec of `EnvParams` and banks: replicated; with `split_houses`, split over a leading axis of devices."""
        return BY_ENV if self.split_houses else REPLICATED

    def named(self, specs: Any) -> Any:
        """Return the shardings of a pytree of partition specs on the mesh."""
        return jax.tree.map(lambda spec: NamedSharding(self.mesh, spec), specs, is_leaf=_is_spec)

    def put(self, tree: T, specs: Any) -> T:
        """Put arrays on the devices; `specs` is a prefix of their pytree.

        With several processes each has the whole arrays, equal in all, and puts its parts on its own devices.
        """
        if self.mesh.is_multi_process and not any(map(_is_traced, jax.tree.leaves(tree))):
            return jax.tree.map(lambda part, x: jax.tree.map(partial(_put_parts, part), x), self.named(specs), tree)
        return jax.device_put(tree, self.named(specs))

    def with_shardings(self, shapes: T, specs: Any) -> T:
        """Return the shapes of arrays, such as those of `jax.eval_shape`, with shardings; `specs` as for `put`."""

        def sharded(sharding: NamedSharding, part: Any) -> Any:
            return jax.tree.map(lambda x: jax.ShapeDtypeStruct(x.shape, x.dtype, sharding=sharding), part)

        return jax.tree.map(sharded, self.named(specs), shapes)

    def put_envs(self, tree: T) -> T:
        """Split arrays with a leading environment axis over the devices.

        Raises:
            ConfigError: The number of environments is not a multiple of the devices.
        """
        for leaf in jax.tree.leaves(tree):
            self.check_num_envs(leaf.shape[0])
        return self.put(tree, BY_ENV)

    def put_params(self, params: Any) -> Any:
        """Put `EnvParams`, or a bank, on the devices.

        Args:
            params: The parameters; with `split_houses` a sequence of them, one per device. Their banks have the same
                `spec` and shapes, and their tasks the same number of rows. States then have local house indices.

        Raises:
            ConfigError: There is not one per device, or they differ in shapes or static data.
        """
        if not self.split_houses:
            return self.put(params, REPLICATED)
        if len(params) != self.num_devices:
            raise ConfigError(f"expected parameters of {self.num_devices} devices, got {len(params)}")
        try:
            stacked = jax.tree.map(lambda *leaves: np.stack([np.asarray(leaf) for leaf in leaves]), *params)
        except ValueError as error:
            hint = "Their banks must have equal shapes, as those of houses in the same size classes have."
            raise ConfigError(f"parameters of the devices differ: {error}", hint=hint) from error
        return self.put(stacked, BY_ENV)

    def local(self, params: T) -> T:
        """Return this device's parameters, inside a function of `map`, without the device axis of `split_houses`."""
        return jax.tree.map(lambda x: x[0], params) if self.split_houses else params

    def map(self, function: Callable[..., Any], in_specs: Any, out_specs: Any) -> Any:
        """Compile a function that runs on each device with its part of the arguments; nothing is exchanged implicitly.

        Args:
            function: Function of local arrays; it calls `local` for its parameters.
            in_specs: Partition spec per argument, each a prefix of its pytree: `params`, `BY_ENV` or `REPLICATED`.
            out_specs: Partition specs of the results.

        Returns:
            A function jitted over the mesh, with the shardings of `out_specs`.
        """
        mapped = self._map_filled if EMPTY_ARGUMENTS_CRASH else self._map_all
        # Explicit, because otherwise arrays without elements change their sharding from input to output.
        return jax.jit(mapped(function, tuple(in_specs), out_specs), out_shardings=self.named(out_specs))

    def _map_all(self, function: Callable[..., Any], in_specs: tuple, out_specs: Any) -> Callable[..., Any]:
        """Return `jax.shard_map` of a function."""
        # Without `check_vma=False` JAX asks for annotations that the environment's loops do not have.
        return jax.shard_map(function, mesh=self.mesh, in_specs=in_specs, out_specs=out_specs, check_vma=False)

    def _map_filled(self, function: Callable[..., Any], in_specs: tuple, out_specs: Any) -> Callable[..., Any]:
        """Return `_map_all` of a function, but with arguments and constants without elements made on each device."""

        def spread(*args: Any) -> Any:
            leaves, tree = jax.tree.flatten(args)
            specs = jax.tree.leaves(jax.tree.broadcast(in_specs, args, is_leaf=_is_spec), is_leaf=_is_spec)
            filled = [i for i, leaf in enumerate(leaves) if not _is_empty(leaf)]
            shapes = {
                i: (NamedSharding(self.mesh, specs[i]).shard_shape(leaf.shape), leaf.dtype)
                for i, leaf in enumerate(leaves)
                if _is_empty(leaf)
            }

            def run(*parts: Array) -> Any:
                local = {i: jnp.zeros(*shape) for i, shape in shapes.items()} | dict(zip(filled, parts, strict=True))
                given = jax.tree.unflatten(tree, [local[i] for i in range(len(leaves))])
                return _make_empty_constants(function)(*given)

            mapped = self._map_all(run, tuple(specs[i] for i in filled), out_specs)
            return mapped(*(leaves[i] for i in filled))

        return spread

    def map_envs(self, function: Callable[..., Any]) -> Any:
        """Compile `function(params, *arrays)`, such as a batch's step, over the devices.

        All arrays and results have a leading environment axis.
        """
        mapped = self.map(lambda params, given: function(self.local(params), *given), (self.params, BY_ENV), BY_ENV)
        return jax.jit(lambda params, *given: mapped(params, given))

    def check_num_envs(self, num_envs: int) -> None:
        """Raise `ConfigError` unless environments split evenly over the devices."""
        if num_envs % self.num_devices:
            message = f"`num_envs` must be a multiple of the {self.num_devices} devices, got {num_envs}"
            raise ConfigError(message, hint="Or use fewer devices, such as jax.devices()[:1].")


def _is_traced(leaf: Any) -> bool:
    """Return whether an array has no values yet, because its function is being traced."""
    return isinstance(leaf, jax.core.Tracer)  # pyright: ignore[reportAttributeAccessIssue]


def _put_parts(sharding: NamedSharding, x: Any) -> Array:
    """Return an array over the devices of several processes; each process passes the whole, and nothing is sent.

    Arrays that are over these devices already stay.
    """
    if isinstance(x, jax.Array) and not x.is_fully_addressable:
        return jax.device_put(x, sharding)
    whole = np.asarray(x)
    return jax.make_array_from_callback(whole.shape, sharding, lambda index: whole[index])


def _is_spec(node: Any) -> bool:
    """Return whether a node of a pytree is a partition spec."""
    return isinstance(node, PartitionSpec)


def _is_empty(leaf: Any) -> bool:
    """Return whether an array has no elements; False for typed keys, which cannot be made of zeros."""
    return leaf.size == 0 and not jnp.issubdtype(leaf.dtype, jax.dtypes.extended)


def _make_empty_constants(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function that makes anew all arrays without elements that `function` captures.

    `jax.shard_map` passes captured arrays as arguments.
    """

    def made(*args: Any) -> Any:
        program, shape = jax.make_jaxpr(function, return_shape=True)(*args)
        constants = [jnp.zeros(x.shape, x.dtype) if _is_empty(x) else x for x in program.consts]
        run = jax.core.eval_jaxpr  # pyright: ignore[reportAttributeAccessIssue]
        results = run(program.jaxpr, constants, *jax.tree.leaves(args))
        return jax.tree.unflatten(jax.tree.structure(shape), results)

    return made


def env_index(num_local: int) -> Int[Array, ""]:
    """Return the global index of this device's first of `num_local` environments, inside `EnvSharding.map`."""
    return jax.lax.axis_index(ENV_AXIS) * num_local


def mean_over_devices(tree: T) -> T:
    """Average arrays over the devices, inside `EnvSharding.map`."""
    return jax.lax.pmean(tree, ENV_AXIS)


def sum_over_devices(tree: T) -> T:
    """Sum arrays over the devices, inside `EnvSharding.map`."""
    return jax.lax.psum(tree, ENV_AXIS)
