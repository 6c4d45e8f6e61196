"""Where the sensors sit, and what they and the logger make of the truth: dynamics, filter, rate, noise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.signal import bilinear, butter, lfilter, sosfilt

from pounding.diagnosis.case.case import Channel, Run
from pounding.diagnosis.case.quantities import UNITS
from pounding.diagnosis.hidden.beams import Beams

FINE_HZ = 3600.0
"""Least rate at which the truth is computed [Hz]."""

RATES_HZ = (500.0, 512.0, 600.0, 800.0, 1000.0, 1024.0)
PAIR_RATES_HZ = (1000.0, 1024.0, 2000.0)
PAIR_FINE_HZ = 8000.0
"""The same for frames that touch: an impact takes about a millisecond."""

USUAL_NOISE = 0.02
"""Noise of a response channel in the middle of what is drawn."""

FORCE_NOISE_N = 0.5
"""A force cell's noise where nothing touches [N]."""

FORCE_CELLS = 0.75
"""Share of the pairs whose contact force is measured."""

ACCELEROMETERS = 6
"""Most accelerometers on a frame."""


@dataclass(frozen=True)
class Logger:
    """How a case is recorded.

    Attributes:
        rate_hz: Samples per second.
        finer: Steps of the truth in a sample.
        noise: Standard deviation over root mean square of each response channel.
        table_noise: The same of the table channel.
        sensor_hz: Natural frequency of each channel's sensor [Hz].
        sensor_ratio: Its damping ratio; a force cell rings.
        start_s: Time of the first sample [s].
    """

    rate_hz: float
    finer: int
    noise: np.ndarray
    table_noise: float
    sensor_hz: np.ndarray
    sensor_ratio: np.ndarray
    start_s: float

    @property
    def fine_step_s(self) -> float:
        """Step of the truth [s]."""
        return 1 / (self.rate_hz * self.finer)

    def noise_of(self, channels: tuple[Channel, ...], clean: np.ndarray) -> np.ndarray:
        """Return the standard deviation of each channel's noise in a run, shape (channels,)."""
        level = np.where([channel.is_table for channel in channels], self.table_noise, self.noise)
        noise = level * np.sqrt(np.mean((clean - clean.mean(axis=0)) ** 2, axis=0))
        cells = np.array([channel.quantity == "contact_force" for channel in channels])
        return np.asarray(np.where(cells, np.maximum(noise, FORCE_NOISE_N), noise))


def place(rng: np.random.Generator, frames: Mapping[str, Beams]) -> tuple[Channel, ...]:
    """Draw the channels of a case: the table, accelerometers up each frame, one to three displacements."""
    channels = [_channel(rng, "table", "table_acceleration")]
    for name, beams in frames.items():
        count = min(beams.storeys, ACCELEROMETERS)
        between = rng.choice(np.arange(1, beams.storeys), count - 1, replace=False)
        for floor in sorted({beams.storeys, *between.tolist()}):
            channels.append(_channel(rng, f"{name}_a{floor}", "absolute_acceleration", name, floor))
        seen = rng.choice(np.arange(1, beams.storeys), rng.integers(0, 3), replace=False)
        kind = rng.choice(["relative_displacement", "absolute_displacement"], p=[0.8, 0.2])
        for floor in sorted({beams.storeys, *seen.tolist()}):
            channels.append(_channel(rng, f"{name}_d{floor}", str(kind), name, floor))
        if rng.random() < 0.15:
            floor = int(rng.integers(1, beams.storeys + 1))
            channels.append(_channel(rng, f"{name}_v{floor}", "relative_velocity", name, floor))
    if len(frames) > 1 and rng.random() < FORCE_CELLS:
        channels.append(Channel("force_1", "contact_force", str(rng.choice(["N", "kN"])), contact=1))
    return tuple(channels)


def _channel(
    rng: np.random.Generator, name: str, quantity: str, frame: str | None = None, floor: int | None = None
) -> Channel:
    units = list(UNITS[quantity])
    # SI or the first-named unit for most, any other for some.
    common = "mm" if "mm" in units else units[0]
    unit = common if rng.random() < 0.8 else str(rng.choice(units))
    return Channel(name, quantity, unit, frame=frame, floor=floor)


def logger(
    rng: np.random.Generator,
    channels: tuple[Channel, ...],
    *,
    pair: bool = False,
    noise: float | None = None,
    pair_rates_hz: tuple[float, ...] = PAIR_RATES_HZ,
    fine_hz: float = FINE_HZ,
) -> Logger:
    """Draw rate, noise and sensors of a case.

    Args:
        rng: Draws.
        channels: Channels of the case.
        pair: Whether two frames may touch.
        noise: Noise of every response channel over its root mean square [-]; drawn, channel by channel, when None.
        pair_rates_hz: Samples per second among which a pair's are drawn.
        fine_hz: Least rate at which the truth of one frame is computed [Hz].
    """
    touching = any(channel.quantity == "contact_force" for channel in channels) or pair
    rate = float(rng.choice(pair_rates_hz if touching else RATES_HZ))
    levels = np.exp(rng.uniform(np.log(0.01), np.log(0.04))) * rng.uniform(0.7, 1.4, len(channels))
    # One kind of accelerometer for table and floors; displacement sensors are as quick, but not the same.
    common = rng.uniform(1000.0, 2500.0)
    own = [
        1.0 if channel.quantity.endswith("acceleration") else rng.uniform(0.7, 1.4) for channel in channels
    ]
    table_noise = float(rng.uniform(0.005, 0.01))
    if noise is not None:
        # The table's stays in proportion, or it would drown what the others tell.
        levels, table_noise = np.full(len(channels), noise), table_noise * noise / USUAL_NOISE
    return Logger(
        rate,
        int(np.ceil((PAIR_FINE_HZ if touching else fine_hz) / rate)),
        levels,
        table_noise,
        common * np.array(own) * rng.normal(1.0, 0.03, len(channels)),
        np.array([rng.uniform(0.1, 0.4) if c.quantity == "contact_force" else 0.7 for c in channels]),
        float(rng.choice([0.0, 1 / rate, 2.5])),
    )


def sampled(truth: np.ndarray, log: Logger) -> np.ndarray:
    """Return the truth (fine samples, channels) behind sensors and anti-alias filter at the logger's rate."""
    fine_hz = log.rate_hz * log.finer
    seen = np.empty_like(truth)
    for column, (natural_hz, ratio) in enumerate(zip(log.sensor_hz, log.sensor_ratio, strict=True)):
        circular = 2 * np.pi * natural_hz
        numerator, denominator = bilinear([circular**2], [1.0, 2 * ratio * circular, circular**2], fine_hz)
        seen[:, column] = lfilter(numerator, denominator, truth[:, column])
    sections = butter(4, 0.4 * log.rate_hz, fs=fine_hz, output="sos")
    return np.asarray(sosfilt(sections, seen, axis=0)[:: log.finer])


def recorded(
    rng: np.random.Generator, clean: np.ndarray, channels: tuple[Channel, ...], log: Logger, file: str
) -> Run:
    """Return a run with its noise.

    Args:
        rng: Draws the noise.
        clean: What the sensors read without noise, in SI, shape (samples, channels).
        channels: Channels of the case, in the order of the columns.
        log: The logger.
        file: Name of the run's file.
    """
    noisy = clean + rng.standard_normal(clean.shape) * log.noise_of(channels, clean)
    time = log.start_s + np.arange(len(noisy)) / log.rate_hz
    return Run(file, None, time, 1 / log.rate_hz, noisy)
