"""Physical bounds of what files and options may state: one table for every reader.

A value beyond its bound is a slip of the pen, a wrong unit or a damaged file: no building and no model of one has it. The
bounds hold buildings at full scale and models of 1:100. What a bound cannot see (a frame that buckles, a floor that the
frame does not have) is checked where it is read.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from pounding.errors import InputError

LARGEST_SHOWN = 1e308
"""Whole numbers beyond this cannot be written as a decimal fraction."""


@dataclass(frozen=True)
class Bound:
    """Range of a physical quantity.

    Attributes:
        low, high: Least and largest value, both allowed, in `unit`.
        unit: Unit; empty for counts and ratios.
        why: Why nothing real lies beyond, in words.
    """

    low: float
    high: float
    unit: str
    why: str

    def fault(self, value: float, what: str, *, per: float = 1.0, unit: str | None = None) -> str:
        """Return the sentence on a value out of bounds, empty for one within.

        Args:
            value: The value in `unit`, or in the unit of the file.
            what: What the value is, the subject of the sentence.
            per: `unit` of the bound for one unit of the file.
            unit: Unit of the file; the bound's own when None.
        """
        low, high = self.low / per, self.high / per
        if low <= value <= high:  # false for NaN
            return ""
        shown = f" {self.unit if unit is None else unit}".rstrip()
        number = f"{value:.6g}" if not abs(value) > LARGEST_SHOWN else "larger than any number"
        return f"{what} is {number}{shown}; it must be {low:.6g} to {high:.6g}{shown}: {self.why}"

    def check(
        self,
        value: float,
        what: str,
        error: type[InputError] = InputError,
        *,
        per: float = 1.0,
        unit: str | None = None,
    ) -> None:
        """Raise the sentence of `fault`, if there is one, as an error.

        Args:
            value: The value in `unit`, or in the unit of the file.
            what: What the value is, the subject of the sentence.
            error: What is raised.
            per: `unit` of the bound for one unit of the file.
            unit: Unit of the file; the bound's own when None.

        Raises:
            InputError: The value is not within the bounds, or is not a number.
        """
        fault = self.fault(value, what, per=per, unit=unit)
        if fault:
            raise error(fault)

    def beyond(self, values: Iterable[float] | np.ndarray[Any, Any]) -> int | None:
        """Return the index of the first of many values that is out of bounds, None for none; NaN counts as a gap.

        Args:
            values: Values in `unit`, shape (n,).
        """
        array = np.asarray(values, float)
        bad = np.flatnonzero((array < self.low) | (array > self.high))
        return int(bad[0]) if bad.size else None


# Dimensions.
LENGTH = Bound(1e-3, 1e3, "m", "sides and storeys lie between a model's block and the tallest building")
THICKNESS = Bound(1e-5, 100.0, "m", "plates lie between a foil and a block")
AREA = Bound(1e-8, 1e4, "m^2", "areas lie between a model's rubber dot and the largest floor")
OFFSET = Bound(-1e3, 1e3, "m", "a place on a floor lies within the largest building")
GAP = Bound(0.0, 100.0, "m", "floors overlap below it and cannot meet beyond")
SCALE = Bound(1e-3, 1.0, "", 'a model is smaller than its building, and a model of 1:30 has scale = "1:30"')
TIME_FACTOR = Bound(
    1e-2, 10.0, "", "a record keeps its time at full scale, 1, and a model of 1:30 has the root of 1/30"
)
HEIGHT = Bound(0.1, 2e3, "m", "buildings lie between a model and the tallest ever planned")

# Materials and elements.
MODULUS = Bound(1e-6, 2e3, "GPa", "stiffness of materials lies between a gel's and diamond's")
DENSITY = Bound(0.1, 1e5, "kg/m^3", "density lies between an aerogel's and a few times lead's")
STRESS = Bound(1e-3, 1e5, "MPa", "strength of materials lies between a gel's and a whisker's")
MASS = Bound(1e-6, 1e9, "kg", "the tallest building weighs 5e8 kg")
BUILDING_MASS = Bound(1e-6, 1e10, "kg", "the tallest building weighs 5e8 kg")
ADDED_MASS = Bound(-1e9, 1e9, "kg", "the tallest building weighs 5e8 kg")
STIFFNESS = Bound(1e-3, 1e15, "N/m", "storeys lie between a thread and a solid block of rock")
CONTACT_STIFFNESS = Bound(
    1.0, 1e15, "N/m or N/m^1.5", "contacts lie between a rubber pad and two solid blocks of rock"
)
STOREY_SHEAR = Bound(1e-3, 1e12, "N", "storeys yield between the weight of a feather and that of a mountain")
ROTATIONAL_STIFFNESS = Bound(1e-6, 1e18, "N m/rad", "joints lie between a hinge and a solid block of rock")
DASHPOT = Bound(0.0, 1e12, "N s/m", "the largest dampers built have some 1e8 N s/m")
DAMPING_PERCENT = Bound(1e-3, 99.0, "%", "frames lose something in each cycle, and sway")
FACTOR = Bound(1e-3, 1e3, "", "a change by more than a thousand makes another frame: state that frame")
WEIGHT_FACTOR = Bound(0.0, 1e3, "", "a centrifuge makes the weight some hundred times larger")

# Motions and tests.
FREQUENCY = Bound(1e-3, 1e3, "Hz", "frames sway between the slowest building and a block on a table")
STEP = Bound(
    1e-6, 0.2, "s", "earthquakes are recorded at 5 samples a second or more; is the time in another unit?"
)
DURATION = Bound(
    1e-3, 7200.0, "s", "the longest earthquakes on record take some 600 s; is the time in another unit?"
)
CLOCK = Bound(-1e7, 1e7, "s", "no clock of a test is further from its zero")
GROUND = Bound(-1e4, 1e4, "m/s^2", "the largest peak on record is some 4 g; is it in another unit?")
PGA = Bound(1e-6, 100.0, "g", "the largest peak on record is some 4 g")
ACCELERATION = Bound(-1e5, 1e5, "m/s^2", "sensors read up to some 10,000 g in impacts")
VELOCITY = Bound(-1e3, 1e3, "m/s", "no frame moves faster than sound")
DISPLACEMENT = Bound(-1e3, 1e3, "m", "no frame moves by more than the tallest building's height")
SWAY = Bound(0.0, 100.0, "m", "no building sways so far")
PEAK = Bound(1e-9, 1e3, "m", "no sensor resolves less, and no building is taller")
FORCE = Bound(-1e12, 1e12, "N", "no contact carries more than the weight of a hundred towers")

FREQUENCY_RATIO = Bound(0.05, 20.0, "", "floors turn about as fast as they sway, within a factor of a few")
INERTIA = Bound(1e-12, 1e13, "kg m^2", "floors lie between a model's block and the largest one")
STIFFNESS_RATIO = Bound(0.0, 1e3, "", "0 is a wall that bends, 30 nearly a shear frame")

# Counts.
STOREYS = Bound(1, 200, "", "the tallest building has some 160 storeys")
KNEE = Bound(0.1, 100.0, "", "1 is a round knee, and 30 is as good as a sharp one")
MESH_NODES = Bound(4, 1e6, "", "a mesh beyond that does not fit into a computer")
SAMPLES = Bound(0, 2e6, "", "an hour at 500 samples a second has fewer")
SEED = Bound(0, 2**53, "", "a seed is a whole number from 0")
PARAMETER = Bound(1e-15, 1e15, "in SI", "a typical size is an order of magnitude of something real")
PRIOR = Bound(1e-6, 1e2, "", "a standard deviation, 1e-4 for what is known")
MODEL_ERROR = Bound(1e-6, 0.5, "", "a share of the motion: 0.05 is 5 %")
RELATIVE_STD = Bound(1e-6, 1e2, "", "state how uncertain the number is as a share of it")
WORKERS = Bound(0, 1024, "", "more processes than cores gain nothing")
FALSE_ALARMS = Bound(
    1e-3, 0.5, "", "the nulls that are kept say nothing of rarer ones, and a coin is right as often as not"
)
PERIOD = Bound(0.0, 100.0, "s", "buildings sway faster than once in 100 s")
LEVELS = Bound(3, 1e4, "", "a curve needs some points, and each takes a run of every record")
MOMENT = Bound(1e-6, 1e12, "N m", "columns bear moments between a model's and those of the widest pier")
COLUMNS = Bound(1, 1e4, "", "a floor hits one column or more, and fewer than a forest")
CONTACT_FORCE = Bound(
    1e-3, 1e12, "N", "contacts press between the weight of a feather and that of a mountain"
)
DRIFT = Bound(1e-6, 1.0, "", "storeys drift less than their height")
EVALUATIONS = Bound(3, 1e5, "", "a search begins with both ends of the range, and each setting takes a run")
CASES = Bound(1, 1e6, "", "each case takes some ten seconds")

# What may be asked of a computer.
WORK = Bound(0.0, 7.0, "days", "nobody waits longer; ask for less")
