"""What the documentation says of an effect, kept with the effect: a row of the catalogue and a sketch."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from pounding.experiments.rig.laws import Law

Function = Callable[[np.ndarray], np.ndarray]
Curves = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Abscissa, what the baseline model has over it, and what is true, each of one shape."""
CYCLES = 2.0
"""Cycles of the motion along which a law is drawn."""


@dataclass(frozen=True)
class Sketch:
    """What an effect does, drawn beside where it sits.

    Attributes:
        mark: What is in colour on a frame of three storeys: ``storey``, ``floor``, ``floors``, ``joints``, ``rock``,
            ``frame``, ``plan``, ``table``, ``tilt`` or ``sensor``.
        across, up: Names of the axes.
        curves: Makes the curves; nothing is computed before it is called.
    """

    mark: str
    across: str
    up: str
    curves: Callable[[], Curves]


@dataclass(frozen=True)
class Description:
    """An effect's row in the catalogue, in Markdown.

    Attributes:
        equation: What it does.
        taken_for: With which other effects it is easily confused.
        sketch: Its picture.
        remark: What is said after the names and units of its parameters.
        plain: The finding in plain words for a report, with `{where}` and `{size}`, which is that of its first parameter
            without its sign; one sentence, or two where that parameter is negative and where it is positive.
        told_by: A test that shows it and little else, a sentence; empty where there is none.
        shapes: What is said of the law where a parameter of its shape, which is refined and not reported, is below the
            catalogue's value, and where it is above.
    """

    equation: str
    taken_for: str
    sketch: Sketch
    remark: str = ""
    plain: tuple[str, ...] = ()
    told_by: str = ""
    shapes: Mapping[str, tuple[str, str]] = field(default_factory=dict)


def relation(mark: str, across: str, up: str, baseline: Function, true: Function) -> Sketch:
    """Return the sketch of one quantity over another, both from -1 to 1.

    Args:
        mark: Place that is in colour on the frame (see `Sketch`).
        across, up: Names of the axes.
        baseline: The curve of the baseline model.
        true: The curve of a frame that has the effect.
    """
    x = np.linspace(-1.0, 1.0, 101)
    return Sketch(mark, across, up, lambda: (x, baseline(x), true(x)))


def history(mark: str, up: str, baseline: Function, true: Function, across: str = "time") -> Sketch:
    """Return the sketch of a quantity over time from 0 to 1.

    Args:
        mark: Place that is in colour on the frame (see `Sketch`).
        up: Name of the upright axis.
        baseline: The curve of the baseline model.
        true: The curve of a frame that has the effect.
        across: Name of the other axis.
    """
    t = np.linspace(0.0, 1.0, 800)
    return Sketch(mark, across, up, lambda: (t, baseline(t), true(t)))


def loop(law: Law, *parameters: float) -> Sketch:
    """Return the sketch of a storey's force over its drift along a growing sine, the law with the storey's own spring."""

    def curves() -> Curves:
        time = np.linspace(0.0, 1.0, 800)
        drift = sine(time) * (0.55 + 0.45 * time)
        return drift, drift, drift + law.along(parameters, drift, np.gradient(drift, time), time)

    return Sketch("storey", "drift", "force", curves)


def sine(time: np.ndarray) -> np.ndarray:
    """Return the motion that sketches show, shape (samples,), at times (samples,) between 0 and 1."""
    return np.asarray(np.sin(2 * np.pi * CYCLES * time))


def nothing(x: np.ndarray) -> np.ndarray:
    """Return zeros, shape (samples,): what a baseline model has of an effect that it lacks."""
    return np.zeros_like(x)


def same(x: np.ndarray) -> np.ndarray:
    """Return x itself, shape (samples,)."""
    return x
