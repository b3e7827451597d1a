"""Impulse response as a value that a notebook shows: its level over time in each channel."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from home_mjx.core.notebook_html import format_curves, format_table

SIZE = (480, 160)  # [px]
MIN_LEVEL = -80.0  # [dB] below the loudest sample
WINDOW = 0.002  # [s], of the levels' mean
EDC_RANGE = (-5.0, -25.0)  # [dB], of the decay curve, over which T20 is fitted (ISO 3382-1)


@dataclass(frozen=True)
class ResponseView:
    """View of an impulse response of C channels and L samples.

    Attributes:
        response: Pressure.
        sample_rate: [Hz].

    Example:
        >>> ResponseView(impulse_response(...), 16000)  # doctest: +SKIP
    """

    response: Float[np.ndarray, "c l"]
    sample_rate: float

    @property
    def decay_curve(self) -> Float[np.ndarray, "c l"]:
        """Energy decay curve by backward integration (Schroeder, 1965) [dB]; 0 at the start."""
        energy = np.cumsum(np.asarray(self.response, np.float64)[:, ::-1] ** 2, axis=1)[:, ::-1]
        return 10 * np.log10(np.maximum(energy / np.maximum(energy[:, :1], 1e-30), 1e-12))

    @property
    def t20(self) -> Float[np.ndarray, " c"]:
        """Broadband reverberation time T20 of each channel [s]; NaN if the decay is too short."""
        return np.array([self._fit(curve) for curve in self.decay_curve])

    def _fit(self, curve: Float[np.ndarray, " l"]) -> float:
        """Return the time of 60 dB on the line through a decay curve's `EDC_RANGE`."""
        inside = np.flatnonzero((curve <= EDC_RANGE[0]) & (curve >= EDC_RANGE[1]))
        if len(inside) < 2 or curve[-1] > EDC_RANGE[1]:
            return float("nan")
        slope = np.polyfit(inside / self.sample_rate, curve[inside], 1)[0]
        return float(-60.0 / slope)

    def _repr_html_(self) -> str:
        """Return levels and decay curves over time, and T20."""
        response = np.asarray(self.response, np.float64)
        width = max(round(WINDOW * self.sample_rate), 1)
        count = response.shape[1] // width
        power = (response[:, : count * width].reshape(len(response), count, width) ** 2).mean(axis=2)
        level = np.maximum(10 * np.log10(np.maximum(power, 1e-30) / max(power.max(), 1e-30)), MIN_LEVEL)
        time = np.arange(count) * width / self.sample_rate
        curves = {f"channel {n}": row for n, row in enumerate(level)}
        curves |= {f"decay {n}": np.maximum(row[::width][:count], MIN_LEVEL) for n, row in enumerate(self.decay_curve)}
        facts = {"channels": len(response), "length": f"{response.shape[1] / self.sample_rate:.2f} s"}
        facts["T20"] = ", ".join(f"{t:.2f} s" for t in self.t20)
        return format_table("Impulse response", facts) + format_curves("level [dB] over time [s]", time, curves, SIZE)
