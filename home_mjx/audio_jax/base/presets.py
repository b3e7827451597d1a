"""Three choices of options, by what they cost and how wrong they are.

Errors are those of `benchmarks/acoustics.py`, in six rooms against a Monte Carlo that shares nothing with the engine,
octaves 125 to 8000 Hz; the two rooms on which the tracing of rays itself is wrong (scattering that rises with
frequency, carpet with a curtain) are named apart. They are those of the late part, with paths of first order; moving
tones, of `tests/audio_jax/motion`.
"""

from typing import Any

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.core.checks import check_known

PRESETS: dict[str, dict[str, Any]] = {
    # T30 within 2 % in even rooms and 5 % in bare ones, but -27 % where absorption is uneven and -22 to +20 % where two
    # rooms are coupled (-53 to +11 % rising scattering, -29 % carpet); EDT within 9 % (-32 %, -4 %); level within
    # 0.5 dB (-0.8 dB, -0.3 dB). Tones at 1.4 m/s: error below -50 dB. Ends after 0.5 s.
    "fast": {"motion": True, "tail_seconds": 0.0},
    # T30 within 6 % (-41 to +21 % rising scattering, -15 % carpet); EDT within 7 % (-30 %, -3 %); level within 0.6 dB
    # (-0.8, -0.3 dB). Tones as above; T30 of 0.5 to 2 s read from the waveform within 5 %.
    "balanced": {
        "motion": True,
        "num_rays": 512,
        "num_bounces": 150,
        "num_edges": 8,
        "reflection_order": 2,
        "num_reflections": 24,
    },
    # Not measured against the oracle yet; rays are those to which the others have been compared in houses.
    "reference": {
        "motion": True,
        "num_rays": 3000,
        "num_bounces": 150,
        "num_edges": 16,
        "reflection_order": 3,
        "num_reflections": 62,
    },
}


def audio_preset(name: str, **changes: Any) -> AudioConfig:
    """The options of a preset, "fast", "balanced" or "reference"; what each gets wrong stands beside it in `PRESETS`.

    Args:
        name: Of the preset.
        **changes: Options that shall differ from it.

    Raises:
        ConfigError: There is no such preset, or an option has a value that cannot be used.

    Example:
        >>> audio_preset("fast").num_rays, audio_preset("balanced", num_rays=128).num_rays
        (48, 128)
    """
    check_known("preset", [name], PRESETS)
    return AudioConfig(**{**PRESETS[name], **changes})
