"""Effects of the table and of the sensors: nothing in the frame is wrong, but what is said of it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pounding.diagnosis.effects.catalogue import CATALOGUE, CHANNEL_UNIT, Effect, Quantity, Scales
from pounding.diagnosis.effects.describing import Description, history, nothing, relation, same, sine
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import Assembly
from pounding.diagnosis.model.sensitivity import Term
from pounding.diagnosis.model.storeys import Modes
from pounding.diagnosis.model.terms import Motion, channel_term, table_term
from pounding.diagnosis.model.tilt import tilt_series


@CATALOGUE.add
@dataclass(frozen=True)
class TableGain(Effect):
    """What shook the frame is (1 + x) times the table channel."""

    name = "table_gain"
    linear = True
    quantities = (Quantity("relative_change", "1"),)
    described = Description(
        r"$a_g \to (1 + x)\,a_g$",
        "a gain of all other sensors",
        history("table", "table", sine, lambda t: 1.3 * sine(t)),
        told_by="A second accelerometer of another make on the table.",
    )

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return 0.2."""
        return 0.2

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return the table's own force."""
        return [table_term(modes, motion.run.table)]

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Scale the table."""
        assembly.table_gain += float(values[0])


@CATALOGUE.add
@dataclass(frozen=True)
class TableDelay(Effect):
    """The frame was shaken later than the channel says."""

    name = "table_delay"
    linear = True
    quantities = (Quantity("delay", "ms", 1000.0),)
    described = Description(
        r"$a_g(t) \to a_g(t - \tau)$",
        "a delay of all other sensors",
        history("table", "table", sine, lambda t: sine(t - 0.06)),
        ", positive where the frame was shaken later than the channel says",
        told_by="Table and floor on one logger, or a hammer blow on the table that both record.",
    )

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return 6 ms."""
        return 0.006

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return the table's rate of change."""
        return [table_term(modes, -model.table_slope(motion.run))]

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Delay the table."""
        assembly.table_delay_s += float(values[0])


@CATALOGUE.add
@dataclass(frozen=True)
class TableTilt(Effect):
    """The table pitches by tilt times its acceleration: floors are moved by their height, and weight leans."""

    name = "table_tilt"
    linear = True
    quantities = (Quantity("tilt", "rad s^2/m"),)
    described = Description(
        r"the table pitches by $\theta = \psi\,a_g$: floors move by $h\theta$, weights lean",
        "`base_rocking`, `table_gain`",
        relation("tilt", "table accel.", "pitch", nothing, lambda x: 0.7 * x),
        told_by="Two vertical accelerometers at the ends of the table.",
    )

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return what moves the roof by a tenth of the table at the first frequency."""
        height = max(float(frame.height_m[-1]) for frame in model.structure.frames)
        return 0.3 / (height * float(scales.omega[0][0]) ** 2)

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return the inertia of the pitching floors, their leaning weight, and what sensors see of the pitch."""
        pitch, pitching, inertia, weight, seen = tilt_series(model, modes, motion.run)
        return [
            Term(-pitching, inertia, inertial=True),
            Term(pitch, weight),
            Term(pitch, output=seen),
        ]

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Tilt the table."""
        assembly.table_tilt += float(values[0])


@dataclass(frozen=True)
class ChannelEffect(Effect):
    """An effect of one channel."""

    where = "channel"


@CATALOGUE.add
@dataclass(frozen=True)
class SensorGain(ChannelEffect):
    """The channel reads (1 + x) times the truth."""

    name = "sensor_gain"
    linear = True
    quantities = (Quantity("relative_change", "1"),)
    described = Description(
        r"$y \to (1 + x)\,y$",
        "two sensors exchanged, which is tried before",
        relation("sensor", "truth", "reading", same, lambda x: 1.4 * x),
        "; a wrong polarity is $-2$; `g` typed where the cell gave `m/s^2` reads 9.81 times too much, $+8.81$, the other "
        "way round $-0.898$",
        told_by="The sensor exchanged with its neighbour: a fault of the sensor goes with it.",
    )

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return 0.2."""
        return 0.2

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return the channel itself."""
        return [channel_term(model, self.index, motion.outputs[:, self.index])]

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Scale the channel; a sensor of the wrong polarity is a gain of -2."""
        assembly.channel_gain[self.index] += float(values[0])


@CATALOGUE.add
@dataclass(frozen=True)
class SensorDelay(ChannelEffect):
    """The channel reads later than the truth."""

    name = "sensor_delay"
    linear = True
    quantities = (Quantity("delay", "ms", 1000.0),)
    described = Description(
        r"$y(t) \to y(t - \tau)$",
        "`table_delay`",
        history("sensor", "reading", sine, lambda t: sine(t - 0.06)),
        "; channels of one kind or of one frame may be late together, as a logger of their own",
        told_by="A hammer blow that all loggers record, or the sensor moved to the logger of its neighbours.",
    )

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return 6 ms."""
        return 0.006

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return the channel's rate, as it follows from the state."""
        return [channel_term(model, self.index, -motion.output_rate[:, self.index])]

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Delay the channel."""
        assembly.channel_delay_s[self.index] += float(values[0])


@CATALOGUE.add
@dataclass(frozen=True)
class LoggerDelay(ChannelEffect):
    """Several channels read late by the same time, as on a second logger: a sensor delay of each of them.

    Never early: that would be the other logger's delay, told by a table that is late too.
    """

    name = "sensor_delay"
    linear = True
    quantities = (Quantity("delay", "ms", 1000.0),)
    where = "logger"
    sign = 1
    members: tuple[int, ...] = ()
    channels: tuple[str, ...] = ()

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return 6 ms."""
        return 0.006

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return the rates of the channels."""
        return [channel_term(model, channel, -motion.output_rate[:, channel]) for channel in self.members]

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Delay the channels."""
        assembly.channel_delay_s[list(self.members)] += float(values[0])

    def entries(self) -> list[dict[str, object]]:
        """Return a sensor delay of each channel."""
        return [self.place() | {"channel": channel} for channel in self.channels]


@CATALOGUE.add
@dataclass(frozen=True)
class SensorOffset(ChannelEffect):
    """The channel reads a constant more than the truth."""

    name = "sensor_offset"
    linear = True
    quantities = (Quantity("offset", CHANNEL_UNIT),)
    described = Description(
        r"$y \to y + b$",
        "a slow drift",
        history("sensor", "reading", sine, lambda t: sine(t) + 0.5),
        told_by="A minute of record before anything moves.",
    )

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return 0.3 of the channel's rms."""
        return 0.3 * float(scales.output[self.index])

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return a constant."""
        return [channel_term(model, self.index, np.ones(len(motion.outputs)))]

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Offset the channel."""
        assembly.channel_offset[self.index] += float(values[0])
