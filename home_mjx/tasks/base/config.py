"""Static options of an environment: a change of any of them compiles a new step."""

import dataclasses
import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from home_mjx.audio_jax.auralization.clips import CLIPS
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.presets import audio_preset
from home_mjx.audio_jax.contact_sounds.options import ContactSoundConfig
from home_mjx.core.checks import check_flag, check_known, check_names, check_number, check_type, names_hint
from home_mjx.errors import ConfigError
from home_mjx.physics.base.config import PhysicsConfig, PhysicsSetup
from home_mjx.raycast_render.backends.registry import find_backend
from home_mjx.raycast_render.cameras.camera import Lens, check_lens, has_intrinsics
from home_mjx.raycast_render.shaders.base import Shader, ShaderSpec, resolve_shader
from home_mjx.schema.agent import AgentBody
from home_mjx.schema.timing import Timing
from home_mjx.tasks.base.specs import ACTION_NAMES, HAND_MOVE_NAMES, HAND_NAMES, TOGGLE, DiscreteActions

PIXEL_KINDS = ("rgb", "radiance", "depth", "normal")
CAMERA_KINDS = ("intrinsics", "pose", "valid")
ID_KINDS = ("instance", "fine", "coarse", "nyu40", "room", "level", "material", "room_type", "size", "color")
VECTOR_SENSORS = ("audio", "state")
VIEW_KINDS = PIXEL_KINDS + ID_KINDS + CAMERA_KINDS
DOOR_STATES = ("open", "closed", "initial", "random")
SWITCH_STATES = ("initial", "on", "off", "random")
ARRANGEMENTS = ("initial", "random")
SENSORS = VIEW_KINDS + VECTOR_SENSORS
ACTION_KINDS = ("continuous", "discrete")
MAX_STORED = 64  # maximum number of bodies that are put into compartments at reset
MAX_SOURCES = 256  # maximum number of sound sources; each is traced for every agent
DISCRETE_CTRL_DT = 0.3  # [s], length of a step of discrete actions; a multiple of the default `sim_dt`
DEFAULT_SENSORS = ("rgb", "depth", "instance", "fine", "audio", "state")  # the task's own are added


@dataclass(frozen=True)
class AgentCamera:
    """A camera on an agent's head.

    Attributes:
        name: Camera name in observation names, as in `pixels/<name>_rgb`.
        kinds: Image kinds to compute, from `VIEW_KINDS`.
        lens: Projection model and image size.
        fovy: Vertical field of view [degrees]; for an orthographic camera the height of the image [m].
        offset: Position relative to the eyes [m]: forward, left and up in the body frame.
        yaw: Rotation to the left of straight ahead [degrees].
        pitch: Upward rotation [degrees].
        follow_pitch: If True, the camera pitches with the agent's head.
        shader: Shader of the colour image: the name of a registered one, or one with options; see `EnvConfig.shader`.

    Example:
        >>> AgentCamera("scanner", ("depth",), Lens(360, 16, "lidar"), follow_pitch=False).lens.shape
        (16, 360)
    """

    name: str
    kinds: tuple[str, ...] = ("rgb", "depth")
    lens: Lens = field(default_factory=Lens)
    fovy: float = 90.0
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    yaw: float = 0.0
    pitch: float = 0.0
    follow_pitch: bool = True
    shader: ShaderSpec = "fast"

    def __post_init__(self) -> None:
        check_names("kind of view", self.kinds, VIEW_KINDS)
        check_type("lens", self.lens, Lens)
        check_flag("follow_pitch", self.follow_pitch)
        resolve_shader(self.shader)
        if not isinstance(self.offset, tuple | list) or len(self.offset) != 3:
            raise ConfigError(f"`offset` must be three numbers, got {self.offset}")
        if not isinstance(self.name, str) or not self.name:
            raise ConfigError(f"a camera needs a name, got {self.name!r}")
        for name, value in zip(("offset",) * 3 + ("yaw", "pitch"), (*self.offset, self.yaw, self.pitch), strict=True):
            check_number(f"{name} of camera {self.name}", value)
        if "intrinsics" in self.kinds and not has_intrinsics(self.lens):
            raise ConfigError(f"camera `{self.name}` of model `{self.lens.model}` has no intrinsic matrix")
        check_number(f"fovy of camera {self.name}", self.fovy)
        limit = {"orthographic": math.inf, "fisheye": 360}.get(self.lens.model, 180)
        if not (0 < self.fovy < limit):
            raise ConfigError(f"`fovy` of camera `{self.name}` must be in (0, {limit}), got {self.fovy}")
        check_lens(self.lens, math.radians(self.fovy))


@dataclass(frozen=True)
class EnvConfig:
    """Options of an environment; the options of its task and its houses are separate records.

    Attributes:
        sensors: Observations to compute, from `SENSORS`, the task's own and registered sensors. None:
            `DEFAULT_SENSORS` and all that the task adds.
        width: Image width of the head camera [px].
        height: Image height of the head camera [px].
        fovy: Vertical field of view of the head camera [degrees].
        samples: Rays per pixel of the head camera's colour image.
        shader: Shader of the head camera's colour image: the name of a registered one, such as "fast" or "lit", or one
            with options, such as `LitShader(num_lights=2)`. Other cameras have their own, see `AgentCamera`.
        cameras: Further cameras, in addition to the `head` camera of the sensors.
        max_depth: Maximum observed depth; larger values are clipped [m].
        max_pitch_rate: Maximum rate of change of pitch [rad/s].
        max_pitch: Maximum pitch, up or down [rad].
        episode_length: Steps until truncation.
        actions: "continuous": numbers in [-1, 1], as fractions of the maximum rates. "discrete", or a `DiscreteActions`
            with options: the index of a move. If a move does not fit into the default `ctrl_dt`, that becomes 0.3 s.
        hands: If True, there are actions to pick up, put down, drop and throw objects and to turn doors.
        max_aim_angle: Maximum horizontal and vertical angle between the view centre and a hand's target [degrees]. The
            target nearest to the centre that can be reached and lifted, or placed on, is used. 0 uses the centre ray.
        speech: Further discrete actions that speak a word, in addition to the task's own. Each is `say:` or `answer:`
            and a word of the tasks' language, such as "say:yes". See `Snapshot.spoken_token`.
        doors: Door angles at reset: "open" (wide), "closed", "initial" (as in the file) or "random" (each open or
            closed, by key). Agents can push every leaf, whatever is before it, or turn it with their hands.
        fronts: The same for doors and drawers of furniture, where the houses have any that open, see
            `ArticulationOptions`.
        stored_bodies: Maximum number of movable bodies that are put into compartments at reset, random ones that fit,
            each into one of its own; see `navigation.store_bodies`.
        switches: States of lamps and appliances at reset: "initial" (lamps on, appliances off), "on", "off" or "random"
            (each by key). Hands toggle them. None: they have no states, lamps are lit and appliances silent.
        num_switch_sounds: Maximum number of appliances that are heard at once; each is traced for every agent.
        arrangement: Poses of movable bodies at reset: "initial" (as in the file) or "random". Random
            selects one of the bank's settled arrangements with room for the agents, by key; see
            `home_mjx.arrangements`.
        source_height: Height of the sound source above the floor [m].
        clip: Name of the sound that the source plays, see `home_mjx.audio_jax.clip_samples`.
        num_sources: Maximum number of simultaneous sound sources, at most 256; each is traced separately. Raised to the
            number that the task needs.
        clips: Further sounds that may be played; those of the task are added.
        contact_sounds: Contact sounds: footsteps, impacts, scrapes, doors; see `ContactSoundConfig`. None: bodies are
            silent.
        backend: Ray-casting backend; None: the fastest on this platform.
        body: Size, mass and eye height of every agent, shared with physics, cameras and ears.
        timing: Time steps, shared with physics and sound.
        physics: Number of agents, their bodies if they differ, and solver.
        audio: Room acoustics and receiver; by default the preset "balanced", which reads a bake that `make` adds.

    Raises:
        ConfigError: A value is invalid, or `physics` or `audio` has a body or timing of its own.
    """

    sensors: tuple[str, ...] | None = None
    width: int = 64
    height: int = 64
    fovy: float = 90.0
    samples: int = 1
    shader: ShaderSpec = "fast"
    cameras: tuple[AgentCamera, ...] = ()
    max_depth: float = 10.0
    max_pitch_rate: float = 1.5
    max_pitch: float = 1.0
    episode_length: int = 500
    actions: str | DiscreteActions = "continuous"
    hands: bool = False
    max_aim_angle: float = 0.0
    speech: tuple[str, ...] = ()
    doors: str = "open"
    fronts: str = "closed"
    stored_bodies: int = 0
    switches: str | None = None
    num_switch_sounds: int = 4
    arrangement: str = "initial"
    source_height: float = 1.0
    clip: str = "radio"
    num_sources: int = 1
    clips: tuple[str, ...] = ()
    contact_sounds: ContactSoundConfig | None = None
    backend: str | None = None
    body: AgentBody = field(default_factory=AgentBody)
    timing: Timing = field(default_factory=Timing)
    physics: PhysicsConfig = field(default_factory=PhysicsConfig)
    audio: AudioConfig = field(default_factory=partial(audio_preset, "balanced"))

    def __post_init__(self) -> None:
        if self.sensors is not None:
            self._set_fields(sensors=_check_name_tuple("sensors", self.sensors))
        self._set_fields(cameras=_as_tuple("cameras", self.cameras))
        if self.sensors == () and not self.cameras:
            hint = 'Name some, such as ("depth", "goal"), or leave it out for those of the task.'
            raise ConfigError("`sensors` is empty, so agents would observe nothing", hint=hint)
        self._set_fields(speech=_check_name_tuple("speech", self.speech))
        self._set_fields(clips=_check_name_tuple("clips", self.clips))
        check_known("clip", [self.clip, *self.clips], CLIPS)
        check_known("state of doors", [self.doors], DOOR_STATES)
        check_known("state of fronts", [self.fronts], DOOR_STATES)
        check_number("stored_bodies", self.stored_bodies, 0, MAX_STORED, integer=True)
        if self.switches is not None:
            check_known("state of switches", [self.switches], SWITCH_STATES)
        check_known("arrangement", [self.arrangement], ARRANGEMENTS)
        check_flag("hands", self.hands)
        find_backend(self.backend)
        resolve_shader(self.shader)
        if self.contact_sounds is not None:
            check_type("contact_sounds", self.contact_sounds, ContactSoundConfig)
        self._check_numbers()
        self._check_cameras()
        self._check_records()
        if self.discrete is not None:
            self._fit_moves(self.discrete)
        self._share_timing()

    def _set_fields(self, **values: Any) -> None:
        """Set fields of the frozen dataclass, for `__post_init__` only."""
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def _check_numbers(self) -> None:
        """Raise `ConfigError` if a number is out of its limits."""
        for name in ("width", "height", "samples", "episode_length"):
            check_number(name, getattr(self, name), 1, 2**31 - 1, integer=True)  # counters on the device have 32 bits
        check_number("num_sources", self.num_sources, 1, MAX_SOURCES, integer=True)
        check_number("num_switch_sounds", self.num_switch_sounds, 0, MAX_SOURCES, integer=True)
        limits = {
            "fovy": (4, 179.9),  # [degrees]; smaller values are probably radians
            "source_height": (0, 10),
            "max_depth": (0.01, math.inf),
            "max_pitch_rate": (0, math.inf),
            "max_pitch": (0, math.pi / 2),
            "max_aim_angle": (0, 45),
        }
        for name, (least, most) in limits.items():
            check_number(name, getattr(self, name), least, most)

    def _check_cameras(self) -> None:
        """Raise `ConfigError` unless cameras have distinct names, none of them `head`, and a possible image size."""
        if not all(isinstance(camera, AgentCamera) for camera in self.cameras):
            raise ConfigError(f"`cameras` must be AgentCameras, got {self.cameras!r}")
        names = ["head", *(camera.name for camera in self.cameras)]
        Lens(self.width, self.height, samples=self.samples)  # raises if the image is too large
        if len(set(names)) < len(names):
            text = ", ".join(names[1:])
            raise ConfigError(f"`cameras` must have distinct names other than `head`, got {text}")

    def _check_records(self) -> None:
        """Raise `ConfigError` if a nested record has a wrong type, or hands lack the looks that they need to aim."""
        if isinstance(self.actions, str):
            check_known("kind of actions", [self.actions], ACTION_KINDS)
        else:
            check_type("actions", self.actions, DiscreteActions)
        if self.hands and self.discrete is not None and self.discrete.tilt_angle is None:
            hint = "Give `actions.tilt_angle` in degrees, such as 15."
            raise ConfigError(
                "hands aim by looking up and down, which `actions` lack: its `tilt_angle` is None", hint=hint
            )
        records = {"physics": PhysicsConfig, "audio": AudioConfig, "body": AgentBody, "timing": Timing}
        for name, kind in records.items():
            check_type(name, getattr(self, name), kind)
        if isinstance(self.physics, PhysicsSetup):
            hint = "Write physics=PhysicsConfig(...), and set `body` and `timing` of the environment."
            raise ConfigError("`physics` is a PhysicsSetup, which has a body and timing of its own", hint=hint)

    def _fit_moves(self, moves: DiscreteActions) -> None:
        """Set a default `ctrl_dt` to `DISCRETE_CTRL_DT` if a move takes longer; `ConfigError` if it still does."""
        least = max(moves.min_duration(body) for body in self.agents)
        if least > self.timing.ctrl_dt == Timing().ctrl_dt:
            self._set_fields(timing=dataclasses.replace(self.timing, ctrl_dt=DISCRETE_CTRL_DT))
        if least > self.timing.ctrl_dt * (1 + 1e-9):
            raise ConfigError(
                f"a move takes {least:.3g} s at full speed, but a step is {self.timing.ctrl_dt:g} s long",
                hint="Make `ctrl_dt` longer, the moves of `actions` smaller, or the body's speeds higher.",
            )

    def _share_timing(self) -> None:
        """Replace `audio` by a copy with `timing`; raise `ConfigError` if `audio` has another one, not the default."""
        if self.audio.timing not in (self.timing, Timing()):
            raise ConfigError(
                f"`audio.timing` is {self.audio.timing}, but the environment's `timing` is {self.timing}",
                hint="Set `timing` of the environment only: sound takes it from there.",
            )
        self._set_fields(audio=dataclasses.replace(self.audio, timing=self.timing))

    @property
    def num_agents(self) -> int:
        """Number of agents per environment, including those that the task controls."""
        return self.physics.num_agents

    @property
    def agents(self) -> tuple[AgentBody, ...]:
        """The body of each agent: those of `physics.bodies`, else `body` for all."""
        return self.physics.bodies or (self.body,) * self.num_agents

    @property
    def physics_setup(self) -> PhysicsSetup:
        """Options of the physics with the body and the time steps of this environment."""
        return PhysicsSetup.compose(self.physics, self.body, self.timing)

    @property
    def num_traced_sources(self) -> int:
        """Number of traced sources: of clips, then of appliances, then of contact sounds, if any."""
        return (
            self.num_sources
            + self.num_switch_sources
            + (0 if self.contact_sounds is None else self.contact_sounds.num_sounds)
        )

    @property
    def num_switch_sources(self) -> int:
        """Number of sources of appliances: `num_switch_sounds`, or 0 without `switches`."""
        return 0 if self.switches is None else self.num_switch_sounds

    @property
    def can_toggle(self) -> bool:
        """True if hands have the action `toggle`: with `hands` and `switches`."""
        return self.hands and self.switches is not None

    def select_agents(self, num_agents: int) -> "EnvConfig":
        """Return the options restricted to the first `num_agents` agents, at most as many as there are.

        The same object is returned for all agents.

        Example:
            >>> EnvConfig(physics=PhysicsConfig(num_agents=3)).select_agents(2).num_agents
            2
        """
        if num_agents == self.num_agents:
            return self
        bodies = self.physics.bodies[:num_agents]
        return self.replace(physics=dataclasses.replace(self.physics, num_agents=num_agents, bodies=bodies))

    @property
    def discrete(self) -> DiscreteActions | None:
        """Discrete moves; None: actions are continuous."""
        if isinstance(self.actions, DiscreteActions):
            return self.actions
        return DiscreteActions() if self.actions == "discrete" else None

    @property
    def action_names(self) -> tuple[str, ...]:
        """Names of the elements of a continuous action, or of the discrete actions."""
        moves = self.discrete
        own, hands = (ACTION_NAMES, HAND_NAMES) if moves is None else (moves.move_names, HAND_MOVE_NAMES)
        toggle = (TOGGLE,) if self.can_toggle else ()
        return (*own, *(hands if self.hands else ()), *toggle, *self.speech)

    def replace(self, **changes: Any) -> "EnvConfig":
        """Return a copy with some fields changed; `audio.timing` follows `timing`, unless `changes` has `audio`."""
        return dataclasses.replace(self, **({"audio": dataclasses.replace(self.audio, timing=Timing())} | changes))

    @property
    def all_cameras(self) -> tuple[AgentCamera, ...]:
        """All cameras of an agent: the head camera if any sensor needs it, then `cameras`."""
        names = DEFAULT_SENSORS if self.sensors is None else self.sensors
        kinds = tuple(name for name in names if name in VIEW_KINDS)
        lens = Lens(self.width, self.height, samples=self.samples)
        head = AgentCamera("head", kinds, lens, self.fovy, shader=self.shader)
        return (*((head,) if kinds else ()), *self.cameras)

    @property
    def shaders(self) -> tuple[Shader, ...]:
        """Shaders of all cameras with a colour image."""
        shown = [camera for camera in self.all_cameras if "rgb" in camera.kinds or "radiance" in camera.kinds]
        return tuple(resolve_shader(camera.shader) for camera in shown)


def _as_tuple(name: str, values: Any) -> tuple:
    """Return an iterable as a tuple; `ConfigError` for others and for a single string."""
    if isinstance(values, str) or not isinstance(values, Iterable):
        raise ConfigError(f"`{name}` must be a tuple, got {values!r}", hint=names_hint(values))
    return tuple(values)


def _check_name_tuple(name: str, values: Any) -> tuple[str, ...]:
    """Return an iterable of strings as a tuple; `ConfigError` for others."""
    names = _as_tuple(name, values)
    if not all(isinstance(value, str) for value in names):
        raise ConfigError(f"`{name}` must be names, got {names!r}")
    return names
