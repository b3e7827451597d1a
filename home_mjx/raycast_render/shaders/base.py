"""Interface and registry of shaders, which compute the light along a camera's rays.

A distribution adds shaders with entry points of the group `home_mjx.shaders`, whose name is the shader's and whose
object is its class.
"""

from collections.abc import Callable, Sequence
from typing import Any, ClassVar, Protocol, TypeVar, runtime_checkable

import jax.numpy as jnp
from jaxtyping import Array, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.core.checks import check_frozen_dataclass, shorten
from home_mjx.core.paths import installed
from home_mjx.errors import ConfigError, UnknownNameError, did_you_mean
from home_mjx.raycast_render.lighting.specular import CameraRays
from home_mjx.raycast_render.scene.appearance import AppearanceOverrides, scale_exposure
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.raycast_render.scene.vec import Vec

GROUP = "home_mjx.shaders"


@runtime_checkable
class Shader(Protocol):
    """Shading of colour images. A shader is a frozen dataclass: its fields are its options, with defaults.

    Both methods are for one environment and run inside `jit`. Derive from this class for its defaults.

    A shader may have a method `prepare(bank, house, look)`, see `prepare_shaders`. Environments call it at the start of
    episodes; `radiance` finds the result by `find_prepared`, and must do without it elsewhere.

    Attributes:
        name: Name for `shader=`.
        needs: Names of the bakes that it reads from `scene.bank.bakes`.
        uses: Names of the bakes that it reads where the bank has them; `make` does not add them.
        overrides: Fields of `AppearanceOverrides` about lights that change its images.

    Example:
        >>> @register_shader  # doctest: +SKIP
        ... @dataclass(frozen=True)
        ... class Flat(Shader):
        ...     name = "flat"
        ...     level: float = 0.8
        ...
        ...     def radiance(self, scene, rays):
        ...         return albedo(scene, rays.hit) * self.level
        >>> images = render(scene, camera, shader="flat")  # doctest: +SKIP
        >>> images = render(scene, camera, shader=Flat(level=0.5))  # doctest: +SKIP
    """

    name: ClassVar[str]
    needs: ClassVar[tuple[str, ...]] = ()
    uses: ClassVar[tuple[str, ...]] = ()
    overrides: ClassVar[frozenset[str]] = frozenset()

    def radiance(self, scene: Scene, rays: CameraRays) -> Vec:
        """Compute linear RGB light along rays, each channel of the image's shape, in any unit that `display` takes.

        Args:
            scene: Scene of one environment.
            rays: One ray per pixel with its first hit.
        """
        ...

    def display(self, scene: Scene, light: Vec) -> Vec:
        """Map the result of `radiance` for one sample of an image to linear display light in [0, 1].

        By default, scale it by the episode's exposure, see `scale_exposure`, and clip it.
        """
        return scale_exposure(scene.appearance, light).map(lambda x: jnp.clip(x, 0, 1))


ShaderSpec = str | Shader
Prepared = dict[str, Any]
S = TypeVar("S", bound=type)

_REGISTRY: dict[str, Callable[[], Shader]] = {}


def register_shader(shader_class: S) -> S:
    """Register a shader under its name and return it; registering the same name again replaces it.

    Args:
        shader_class: A frozen dataclass with the members of `Shader`, all of whose fields have defaults.

    Raises:
        ConfigError: The class is not such a dataclass, has no name, or its `needs` is not a tuple of names.
    """
    if not isinstance(shader_class, type):
        raise ConfigError(f"expected a class of shaders, got {shorten(shader_class)}")
    name = _check_class(shader_class)
    try:
        shader_class()
    except TypeError as error:
        hint = "Give every field a default, so that the name alone selects the shader."
        raise ConfigError(f"the shader `{name}` cannot be made without options", hint=hint) from error
    _REGISTRY[name] = shader_class
    return shader_class


def shader_names() -> tuple[str, ...]:
    """Return the sorted names of all shaders, registered here or installed as entry points.

    Example:
        >>> {"fast", "lit"} <= set(shader_names())
        True
    """
    return tuple(sorted({*_REGISTRY, *installed(GROUP)}))


def resolve_shader(spec: ShaderSpec) -> Shader:
    """Return the shader of a name with default options, or a shader as it is.

    Raises:
        UnknownNameError: No shader has this name.
        ConfigError: Neither a name nor a shader, or an option is not hashable.

    Example:
        >>> resolve_shader("lit").num_lights
        4
    """
    if isinstance(spec, str):
        return _find_class(spec)()
    if isinstance(spec, type) or not isinstance(spec, Shader):
        known = spec.__name__ if isinstance(spec, type) else "LitShader"
        hint = f"Give a name, such as `fast`, or an instance, such as {known}()."
        raise ConfigError(f"`shader` must be a name or a shader, got {shorten(spec)}", hint=hint)
    _check_class(type(spec))
    try:
        hash(spec)
    except TypeError as error:
        raise ConfigError(f"options of the shader `{spec.name}` must be numbers, text or tuples: {error}") from error
    return spec


def prepare_shaders(
    shaders: Sequence[Shader], bank: HouseBank, house: Int[Array, ""], look: AppearanceOverrides | None
) -> Prepared | None:
    """Return what shaders compute once per episode for `Scene.prepared`, see `Shader`; None if none computes anything.

    Args:
        shaders: The shaders; those without a method `prepare` compute nothing.
        bank: The bank.
        house: The environment's house.
        look: Appearance overrides of the episode.
    """
    made = {repr(x): x.prepare(bank, house, look) for x in shaders if hasattr(x, "prepare")}  # pyright: ignore
    return {name: value for name, value in made.items() if value is not None} or None


def find_prepared(scene: Scene, shader: Shader) -> Any:
    """Return what a shader has prepared for the episode; None if nothing."""
    return None if scene.prepared is None else scene.prepared.get(repr(shader))


def check_shader_bakes(shader: Shader, bank: HouseBank) -> None:
    """Raise `ConfigError` for the first bake that the shader needs and the bank does not have."""
    for name in shader.needs:
        if name not in bank.bakes:
            hint = f"Write bank = add_bakes(bank, houses, '{name}') of home_mjx.houses."
            message = f"the shader `{shader.name}` needs the bake `{name}`, which the bank does not have"
            raise ConfigError(message, hint=hint)


def _find_class(name: str) -> Callable[[], Shader]:
    """Return the registered shader class of a name, else load and register that of an entry point.

    Raise `UnknownNameError` if there is none, and the errors of `register_shader` for an unsuitable one.
    """
    if name in _REGISTRY:
        return _REGISTRY[name]
    if name not in installed(GROUP):
        raise UnknownNameError(
            f"unknown shader `{name}`",
            hint=f"{did_you_mean(name, shader_names())}. Import the module of a shader of your own first.",
        )
    return register_shader(installed(GROUP)[name].load())


def _check_class(shader_class: Any) -> str:
    """Return a shader class's `name`; raise `ConfigError` unless it is a frozen dataclass with `Shader`'s members."""
    title = shader_class.__name__
    check_frozen_dataclass("shader", shader_class)
    if not isinstance(getattr(shader_class, "name", None), str) or not shader_class.name:
        raise ConfigError(f"the shader {title} has no name", hint="Set the class attribute `name`.")
    missing = [name for name in ("radiance", "display") if not callable(getattr(shader_class, name, None))]
    if missing:
        hint = "Derive it from Shader, and define `radiance`."
        raise ConfigError(f"the shader {title} does not have the method `{missing[0]}`", hint=hint)
    needs = getattr(shader_class, "needs", None)
    if not isinstance(needs, tuple) or not all(isinstance(name, str) for name in needs):
        raise ConfigError(f"`needs` of the shader {title} must be a tuple of names, got {shorten(needs)}")
    return shader_class.name
