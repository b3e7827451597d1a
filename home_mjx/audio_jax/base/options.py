"""Records of the sound engine's options: air, early paths, late reverberation, receivers and motion."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from home_mjx.core.checks import check_known, check_number, check_type, shorten
from home_mjx.errors import ConfigError
from home_mjx.schema.compiled import BANDS
from home_mjx.schema.timing import MAX_STEP_SECONDS

DETECTORS = ("rain", "sphere")
HEAD_RADIUS = 0.0875  # [m]
MAX_MICROPHONES = 32
MAX_MICROPHONE_DISTANCE = 1.0  # [m], maximum distance of a microphone from the head centre


@dataclass(frozen=True)
class Air:
    """Air of the whole house, which sets the speed of sound and the absorption by ISO 9613-1.

    Attributes:
        temperature: [degrees Celsius], -70 to 70.
        humidity: Relative humidity [%].
        pressure: [kPa].

    Raises:
        ConfigError: A value is out of range.
    """

    temperature: float = 20.0
    humidity: float = 50.0
    pressure: float = 101.325

    def __post_init__(self) -> None:
        check_number("temperature", self.temperature, -70, 70)
        check_number("humidity", self.humidity, 0, 100)
        check_positive("pressure", self.pressure)


@dataclass(frozen=True)
class EarlyPaths:
    """Paths that are rendered one by one: direct sound, diffraction and the shortest reflections.

    Attributes:
        num_reflections: Maximum number of reflections, the shortest first. 0 leaves them to late reverberation.
        reflection_order: Maximum order of reflections, 1 to 3. At order 1 only walls, floors and ceilings reflect; from
            order 2 on, faces of furniture, doors and bodies do as well.
        num_edges: Edges of walls, doorways and furniture that diffract direct sound, those with the shortest detour.
            0 disables diffraction; objects then transmit sound by their material's transmission coefficient.
        max_crossings: Maximum number of surface hits on the line of direct sound; it is silent from that number on.

    Raises:
        ConfigError: A value is out of range.
    """

    num_reflections: int = 8
    reflection_order: int = 1
    num_edges: int = 0
    max_crossings: int = 32

    def __post_init__(self) -> None:
        check_number("num_reflections", self.num_reflections, 0, integer=True)
        check_number("reflection_order", self.reflection_order, 1, 3, integer=True)
        check_number("num_edges", self.num_edges, 0, integer=True)
        check_number("max_crossings", self.max_crossings, 1, integer=True)


@dataclass(frozen=True)
class Traced:
    """Late reverberation by ray tracing in every step.

    Attributes:
        num_rays: Rays per source.
        num_bounces: Reflections traced per ray; later energy is extrapolated.
        octave_rays: Whether each ray carries one octave and scatters by that octave's coefficient. `num_rays` is then a
            multiple of 7 and counts the rays of all octaves. False: all octaves share one direction, drawn by their
            mean scattering, which is biased where scattering rises with frequency.
        detector: Estimator of specular energy. "rain" emits it diffusely from every hit. Its variance is low with few
            rays, and decay times are within a few per cent for scattering of at least 0.1 (-6 % at 0). "sphere" counts
            specular rays through a sphere: unbiased at any scattering, but needs thousands of rays.
        detector_radius: Minimum distance between a hit and the source, and radius of the sphere of "sphere" [m].

    Raises:
        ConfigError: A value is out of range, or `num_rays` does not suit `octave_rays`.
    """

    num_rays: int = 48
    num_bounces: int = 24
    octave_rays: bool = False
    detector: str = "rain"
    detector_radius: float = 0.5

    def __post_init__(self) -> None:
        check_number("num_rays", self.num_rays, 1, integer=True)
        check_number("num_bounces", self.num_bounces, 1, integer=True)
        check_type("octave_rays", self.octave_rays, bool)
        check_known("detector", [self.detector], DETECTORS)
        check_positive("detector_radius", self.detector_radius)
        if self.num_rays % self.num_groups:
            raise ConfigError(f"`octave_rays` needs `num_rays` to be a multiple of {len(BANDS)}, got {self.num_rays}")

    @property
    def num_groups(self) -> int:
        """Number of independent ray groups: one, or one per octave with `octave_rays`."""
        return len(BANDS) if self.octave_rays else 1


@dataclass(frozen=True)
class Baked:
    """Late reverberation looked up in the bank, see `home_mjx.houses.add_bakes`.

    `AudioConfig` checks that its other options are those with which it was baked.
    """


@dataclass(frozen=True)
class NoLate:
    """No late reverberation: responses consist of early paths."""


@dataclass(frozen=True)
class Binaural:
    """Two ears on a rigid sphere, or the measured head of a `Listener`.

    Attributes:
        head_radius: Radius of the sphere [m]. With a measured head it is only that of the diffuse field's coherence.
        ear_angle: Angle between nose and ears [degrees].
        pinna: Whether ears have pinna echoes, which distinguish up from down and front from back, see `pinna_delays`.

    Raises:
        ConfigError: A value is not a finite number, or the radius is not positive.
    """

    num_channels: ClassVar[int] = 2
    head_radius: float = HEAD_RADIUS
    ear_angle: float = 90.0
    pinna: bool = False

    def __post_init__(self) -> None:
        check_positive("head_radius", self.head_radius)
        check_number("ear_angle", self.ear_angle)
        check_type("pinna", self.pinna, bool)

    @property
    def radius(self) -> float:
        """Maximum distance of an ear from the head centre [m]."""
        return self.head_radius


@dataclass(frozen=True)
class Omni:
    """An omnidirectional microphone, whose free-field pressure is in both of two channels."""

    num_channels: ClassVar[int] = 2
    radius: ClassVar[float] = HEAD_RADIUS  # late sound sets in as early as at two ears


@dataclass(frozen=True)
class Ambisonics:
    """Four channels of first-order ambisonics at the head centre, see `ambisonic_gains`."""

    num_channels: ClassVar[int] = 4
    radius: ClassVar[float] = HEAD_RADIUS  # late sound sets in as early as at two ears


@dataclass(frozen=True)
class MicrophoneArray:
    """Omnidirectional microphones around the head centre.

    Attributes:
        positions: Positions in the head frame: +x right, +y up, -z ahead [m]; 1 to 32, each within 1 m of the centre.

    Raises:
        ConfigError: Positions are not such triples, too many, or too far away.

    Example:
        >>> MicrophoneArray(((-0.1, 0, 0), (0.1, 0, 0))).num_channels
        2
    """

    positions: Sequence[Any]

    def __post_init__(self) -> None:
        if isinstance(self.positions, str) or not isinstance(self.positions, Sequence) or not self.positions:
            hint = "For example positions=((0, 0, 0),)."
            raise ConfigError(f"`positions` must be a tuple of positions, got {shorten(self.positions)}", hint=hint)
        if len(self.positions) > MAX_MICROPHONES:
            raise ConfigError(f"expected at most {MAX_MICROPHONES} `positions`, got {len(self.positions)}")
        for place in self.positions:
            if isinstance(place, str) or not isinstance(place, Sequence) or len(place) != 3:
                raise ConfigError(f"each of `positions` needs three numbers, got {shorten(place)}")
            for number in place:
                check_number("positions", number)
        # Option files yield lists; the configuration must be hashable.
        object.__setattr__(self, "positions", tuple(tuple(float(x) for x in place) for place in self.positions))
        if self.radius > MAX_MICROPHONE_DISTANCE:
            hint = "Late reverberation differs farther apart: use a separate `Listener` there."
            raise ConfigError(f"`positions` must be within {MAX_MICROPHONE_DISTANCE} m of the head centre", hint=hint)

    @property
    def num_channels(self) -> int:
        """Number of microphones."""
        return len(self.positions)

    @property
    def radius(self) -> float:
        """Maximum distance of a microphone from the head centre [m]."""
        return max(math.hypot(*place) for place in self.positions)


@dataclass(frozen=True)
class Motion:
    """Moving sources and receivers: early paths move within a frame, with the Doppler effect at every frequency.

    Reverberation continues beyond the response. Without it, whole responses are cross-faded, see `convolve_clip_frame`.

    Attributes:
        max_audible_paths: Maximum number of audible early paths: the direct path and the strongest others. The cost of
            a frame grows with it; of 21 candidates in houses at most 7 are audible. None: all.
        tail_seconds: Reverberation beyond `response_seconds` [s], each octave at its last decay rate; rounded up to
            half responses.

    Raises:
        ConfigError: A value is out of range.
    """

    max_audible_paths: int | None = None
    tail_seconds: float = 1.5

    def __post_init__(self) -> None:
        if self.max_audible_paths is not None:
            check_number("max_audible_paths", self.max_audible_paths, 1, integer=True)
        check_number("tail_seconds", self.tail_seconds, 0, MAX_STEP_SECONDS)


LATE_VARIANTS = {"traced": Traced, "baked": Baked, "none": NoLate}
RECEIVER_VARIANTS = {"binaural": Binaural, "omni": Omni, "array": MicrophoneArray, "ambisonics": Ambisonics}
MOTION_VARIANTS = {True: Motion, False: None}


def check_positive(name: str, value: object, maximum: float = math.inf) -> None:
    """Raise `ConfigError` unless an option is a finite number above 0 and at most `maximum`.

    Example:
        >>> check_positive("pressure", 101.3)
    """
    check_number(name, value, maximum=maximum)
    if not float(value) > 0:  # pyright: ignore[reportArgumentType]
        raise ConfigError(f"`{name}` must be positive, got {value}")
