"""Clocks of another rate: where an effect of table or sensors leads, rates are tried from slow to fast.

A channel whose clock is 1 % off is out of step with the others by more than a cycle before a run ends. About the right
rate nothing tells how far off it is, and the channel looks like a sensor that shows anything but the motion.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from pounding.diagnosis.effects.catalogue import Effect, loggers
from pounding.diagnosis.effects.table_and_sensors import LoggerClock, SensorClock, TableClock
from pounding.diagnosis.inference.filtering import Filtered, log_likelihood
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.settings import SETTINGS


def clocks(model: Model, start: Filtered, leading: Sequence[Effect]) -> list[tuple[Effect, np.ndarray]]:
    """Return clocks that make the data much likelier, each at its likeliest rate [-], shape (1,), the likeliest first.

    Args:
        model: The baseline model.
        start: The predictor about which they are tried.
        leading: The effects that explain most so far.
    """
    rates = _rates(model, start)
    found: list[tuple[float, Effect, np.ndarray]] = []
    for effect in _suspects(model, leading):
        likely = [_likely(model, start, effect, rate) for rate in rates]
        at = int(np.argmax(likely))
        if likely[at] > start.log_likelihood + SETTINGS.search.rescued:
            found.append((likely[at], effect, np.array([rates[at]])))
    return [(effect, values) for _, effect, values in sorted(found, key=lambda one: -one[0])]


def _rates(model: Model, start: Filtered) -> np.ndarray:
    """Return rates so close that the first mode is never out of step by more than a radian with the nearest of them."""
    longest = max(len(run.table) * run.step_s for run in model.observed.runs)
    step = 1.0 / (start.modes.omega.min() * longest)
    steps = int(np.ceil(SETTINGS.search.clock / step))
    return np.asarray(step * np.array([number for number in range(-steps, steps + 1) if number]))


def _suspects(model: Model, leading: Sequence[Effect]) -> Iterator[Effect]:
    """Return the table's clock where an effect of the table leads, else those of the channels and of their loggers.

    All clocks slow but the table's are a table's clock that is fast, as with delays.
    """
    names = model.observed.names
    if any(effect.where == "" for effect in leading):
        yield TableClock()
    led = sorted({effect.index for effect in leading if effect.where != ""})
    yield from (SensorClock(index=channel, channel=names[channel]) for channel in led)
    for members in (group for group in loggers(model) if set(group) & set(led)):
        channels = tuple(names[c] for c in members)
        yield LoggerClock(index=members[0], channel=channels[0], members=members, channels=channels)


def _likely(model: Model, start: Filtered, effect: Effect, rate: float) -> float:
    """Return the log likelihood of a clock's rate; it changes no matrix, so that the filter keeps its gain."""
    gains = start.gains
    prediction = model.predict(start.values, gains, [(effect, np.array([rate]))], start.runs)
    found = log_likelihood(model, prediction.innovations, start.filters, start.runs)
    return found if np.isfinite(found) else -np.inf
