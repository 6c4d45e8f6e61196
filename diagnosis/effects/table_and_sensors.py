"""Effects of the table and of the sensors: nothing in the frame is wrong, but what is said of it is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from pounding.diagnosis.effects.bases import Departure, LoggerEffect
from pounding.diagnosis.effects.catalogue import CATALOGUE, CHANNEL_UNIT, Effect, Quantity, Scales
from pounding.diagnosis.effects.describing import Description, history, nothing, relation, same, sine
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import CHANNEL_DELAY, Assembly
from pounding.diagnosis.model.sensitivity import Term
from pounding.diagnosis.model.storeys import Modes
from pounding.diagnosis.model.terms import Motion, channel_term, table_term
from pounding.diagnosis.model.tilt import tilt_series
from pounding.diagnosis.settings import SETTINGS


@CATALOGUE.add
@dataclass(frozen=True)
class TableGain(Departure):
    """What shook the frame is (1 + x) times the table channel."""

    name = "table_gain"
    parameter = "table_gain"
    typical = 0.2
    quantities = (Quantity("relative_change", "1", symbol="x"),)
    described = Description(
        r"$a_g \to (1 + x)\,a_g$",
        "a gain of all other sensors",
        history("table", "table", sine, lambda t: 1.3 * sine(t)),
        told_by="A second accelerometer of another make on the table.",
        plain=(
            "the table moved {size} less than its record says",
            "the table moved {size} more than its record says",
        ),
    )


@CATALOGUE.add
@dataclass(frozen=True)
class TableDelay(Departure):
    """The frame was shaken later than the channel says."""

    name = "table_delay"
    parameter = "table_delay"
    typical = 0.006
    quantities = (Quantity("delay", "ms", 1000.0, symbol=r"\tau"),)
    described = Description(
        r"$a_g(t) \to a_g(t - \tau)$",
        "a delay of all other sensors",
        history("table", "table", sine, lambda t: sine(t - 0.06)),
        ", positive where the frame was shaken later than the channel says",
        told_by="Table and floor on one logger, or a hammer blow on the table that both record.",
        plain=(
            "the table moved {size} earlier than its record says",
            "the table moved {size} later than its record says",
        ),
    )


@CATALOGUE.add
@dataclass(frozen=True)
class TableClock(Effect):
    """The clock of the table's channel runs at (1 + x) times the true rate, and was right when the run began."""

    name = "table_clock_rate"
    linear = True
    default = False
    typical = 0.01
    quantities = (Quantity("relative_change", "1", symbol="x"),)
    described = Description(
        r"$a_g(t) \to a_g((1 + x)\,t)$",
        "a clock of all other sensors, `table_gain` where the table no longer fits the floors at all",
        history("table", "table", sine, lambda t: sine(0.94 * t)),
        ", negative where the table's clock is slow",
        told_by="A hammer blow on the table at the begin and one at the end that all loggers record.",
        plain=(
            "the clock of the table's record is {size} slow",
            "the clock of the table's record is {size} fast",
        ),
    )

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return the table's rate of change times the time since the run began."""
        since = motion.run.step_s * np.arange(len(motion.table_slope))
        return [table_term(modes, since * motion.table_slope)]

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Change the rate of the table's clock."""
        assembly.table_clock += float(values[0])


@CATALOGUE.add
@dataclass(frozen=True)
class TableTilt(Effect):
    """The table pitches by tilt times its acceleration: floors are moved by their height, and weight leans."""

    name = "table_tilt"
    linear = True
    absorbing = True
    quantities = (Quantity("tilt", "rad s^2/m", symbol=r"\psi"),)
    described = Description(
        r"the table pitches by $\theta = \psi\,a_g$: floors move by $h\theta$, weights lean",
        "`base_rocking`, `table_gain`",
        relation("tilt", "table accel.", "pitch", nothing, lambda x: 0.7 * x),
        told_by="Two vertical accelerometers at the ends of the table.",
        plain=("the table pitches as it is shaken, by {size}",),
    )

    def law_error(self, model: Model, values: np.ndarray, scales: Scales) -> float:
        """Return that of any effect on a frame: a pitching table bends all frames on it."""
        del model, values, scales
        return SETTINGS.refinement.law_error

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


@CATALOGUE.add
@dataclass(frozen=True)
class SensorGain(Departure):
    """The channel reads (1 + x) times the truth."""

    name = "sensor_gain"
    where = "channel"
    parameter = "channel_gain"
    typical = 0.2
    quantities = (Quantity("relative_change", "1", symbol="x"),)
    described = Description(
        r"$y \to (1 + x)\,y$",
        "two sensors exchanged, which is tried before",
        relation("sensor", "truth", "reading", same, lambda x: 1.4 * x),
        "; a wrong polarity is $-2$; `g` typed where the cell gave `m/s^2` reads 9.81 times too much, $+8.81$, the other "
        "way round $-0.898$",
        told_by="The sensor exchanged with its neighbour: a fault of the sensor goes with it.",
        plain=("{where} reads {size} too little", "{where} reads {size} too much"),
    )


@CATALOGUE.add
@dataclass(frozen=True)
class SensorDelay(Departure):
    """The channel reads later than the truth."""

    name = "sensor_delay"
    where = "channel"
    parameter = CHANNEL_DELAY
    typical = 0.006
    quantities = (Quantity("delay", "ms", 1000.0, symbol=r"\tau"),)
    described: ClassVar[Description | None] = Description(
        r"$y(t) \to y(t - \tau)$",
        "`table_delay`",
        history("sensor", "reading", sine, lambda t: sine(t - 0.06)),
        "; channels of one kind or of one frame may be late together, as a logger of their own",
        told_by="A hammer blow that all loggers record, or the sensor moved to the logger of its neighbours.",
        plain=("{where} reads {size} early", "{where} reads {size} late"),
    )


@CATALOGUE.add
@dataclass(frozen=True)
class LoggerDelay(LoggerEffect, SensorDelay):
    """Several channels read late by the same time, as on a second logger: a sensor delay of each of them.

    Never early: that would be the other logger's delay, told by a table that is late too.
    """

    sign = 1


@CATALOGUE.add
@dataclass(frozen=True)
class SensorClock(Effect):
    """The clock of the channel runs at (1 + x) times the true rate, and was right when the run began.

    The search tries it where an effect of table or sensors leads: a clock that is far off makes a channel look as
    if it showed something else altogether, and no score about the right rate tells how far off it is.
    """

    name = "clock_rate"
    where = "channel"
    linear = True
    default = False
    typical = 0.01
    quantities = (Quantity("relative_change", "1", symbol="x"),)
    described: ClassVar[Description | None] = Description(
        r"$y(t) \to y(t / (1 + x))$",
        "`sensor_delay`, and `sensor_gain` where the channel no longer fits the others at all",
        history("sensor", "reading", sine, lambda t: sine(t / 0.94)),
        ", negative where the clock is slow; channels of one kind or of one frame may share a clock",
        told_by="A hammer blow at the begin and one at the end that all loggers record.",
        plain=("the clock of {where} is {size} slow", "the clock of {where} is {size} fast"),
    )

    @property
    def places(self) -> tuple[int, ...]:
        """The channels that share the clock."""
        return (self.index,)

    def terms(self, model: Model, modes: Modes, motion: Motion, shape: tuple[float, ...]) -> list[Term]:
        """Return each channel's rate times the time since the run began."""
        since = motion.run.step_s * np.arange(len(motion.output_rate))
        return [channel_term(model, one, -since * motion.output_rate[:, one]) for one in self.places]

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Change the rate of the clock."""
        assembly.channel_clock[list(self.places)] += float(values[0])


@CATALOGUE.add
@dataclass(frozen=True)
class LoggerClock(LoggerEffect, SensorClock):
    """Several channels share a clock of another rate, as on a second logger: a sensor's clock of each of them."""


@CATALOGUE.add
@dataclass(frozen=True)
class SensorOffset(Departure):
    """The channel reads a constant more than the truth."""

    name = "sensor_offset"
    where = "channel"
    parameter = "channel_offset"
    quantities = (Quantity("offset", CHANNEL_UNIT, symbol="b"),)
    described = Description(
        r"$y \to y + b$",
        "a slow drift",
        history("sensor", "reading", sine, lambda t: sine(t) + 0.5),
        told_by="A minute of record before anything moves.",
        plain=("{where} reads {size} too little", "{where} reads {size} too much"),
    )

    def size(self, model: Model, scales: Scales, shape: tuple[float, ...]) -> float:
        """Return 0.3 of the channel's rms."""
        return 0.3 * float(scales.output[self.index])
