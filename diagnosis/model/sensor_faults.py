"""Gain, delay, clock and offset that an assembly gives the sensors: taken from what they read, or put on what they would."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pounding.diagnosis.model.nuisance import Assembly
from pounding.diagnosis.model.observations import RunData
from pounding.diagnosis.model.shifting import shift

SHIFTED = 2_000_000
"""About how many samples of delayed channels are kept: 16 MB."""

NUDGE = 1e-3
"""Share of a sampling step over which a rate is taken."""


class SensorFaults:
    """The channels of some runs without the faults of their sensors; what was asked for last is kept.

    Args:
        runs: The runs as measured.
    """

    def __init__(self, runs: Sequence[RunData]) -> None:
        self._runs = runs
        self._shifted: dict[tuple[int, int, float, float], np.ndarray] = {}
        self._last: dict[int, tuple[bytes, np.ndarray]] = {}

    def removed(self, assembly: Assembly, number: int) -> np.ndarray:
        """Return what the sensors of a run would have read without their faults [SI], shape (samples, channels).

        Args:
            assembly: Says the faults.
            number: Number of the run.
        """
        faults = (
            assembly.channel_gain,
            assembly.channel_offset,
            assembly.channel_delay_s,
            assembly.channel_clock,
        )
        key = np.concatenate(faults).tobytes()
        last = self._last.get(number)
        if last is None or last[0] != key:
            # Slopes and searches of effects leave the sensors alone.
            self._last[number] = last = key, self._corrected(assembly, number)
        return last[1]

    def added(self, assembly: Assembly, number: int, outputs: np.ndarray, *, late: bool) -> np.ndarray:
        """Return true outputs as the sensors of a run read them [SI], shape (samples, channels).

        Args:
            assembly: Says the faults.
            number: Number of the run.
            outputs: Without faults, shape (samples, channels); changed in place.
            late: Whether delays and clocks count; a filter follows channels that were put in step.
        """
        if late:
            for channel in _untimely(assembly):
                delay_s, clock = _timing(assembly, channel)
                outputs[:, channel] = shift(
                    outputs[:, channel],
                    self._runs[number].step_s,
                    -delay_s * (1 + clock),
                    -clock / (1 + clock),
                )
        return np.asarray(outputs * (1.0 + assembly.channel_gain) + assembly.channel_offset)

    def rates(self, assembly: Assembly, number: int) -> np.ndarray:
        """Return by how much what a channel reads in step changes with its delay [SI/s], shape (samples, channels).

        Args:
            assembly: Says the faults.
            number: Number of the run.
        """
        run = self._runs[number]
        each = []
        for channel, series in enumerate(run.measured.T):
            delay_s, clock = _timing(assembly, channel)
            near = NUDGE * run.step_s
            early, late = (shift(series, run.step_s, delay_s + by, clock) for by in (near, -near))
            each.append((early - late) / (2 * near))
        return np.column_stack(each)

    def _corrected(self, assembly: Assembly, number: int) -> np.ndarray:
        measured = self._runs[number].measured
        untimely = _untimely(assembly)
        if len(untimely):
            measured = measured.copy()
            for channel in untimely:
                measured[:, channel] = self._retimed(number, int(channel), *_timing(assembly, channel))
        return np.asarray((measured - assembly.channel_offset) / (1 + assembly.channel_gain))

    def _retimed(self, number: int, channel: int, delay_s: float, clock: float) -> np.ndarray:
        key = (number, channel, delay_s, clock)
        moved = self._shifted.get(key)
        if moved is None:
            run = self._runs[number]
            moved = shift(run.measured[:, channel], run.step_s, delay_s, clock)
            if clock > 0.0:
                # What a fast clock would have shown at the end was never recorded.
                moved[int(np.ceil(len(moved) / (1 + clock))) :] = np.nan
            if (len(self._shifted) + 1) * len(moved) > SHIFTED:
                self._shifted.clear()
            self._shifted[key] = moved
        return moved


def _untimely(assembly: Assembly) -> np.ndarray:
    """Return the channels that are late or have a clock of another rate."""
    return np.asarray(np.flatnonzero((assembly.channel_delay_s != 0.0) | (assembly.channel_clock != 0.0)))


def _timing(assembly: Assembly, channel: int) -> tuple[float, float]:
    return float(assembly.channel_delay_s[channel]), float(assembly.channel_clock[channel])
