"""The exact runs behind the counterparts of the thesis' figures: frames alone, pairs without contact, contacts."""

from __future__ import annotations

import re
from functools import cache
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from pounding.contact.laws import Law
from pounding.experiments.configurations.definition import Shaken
from pounding.experiments.configurations.library import experiments
from pounding.experiments.errors import ExperimentError
from pounding.experiments.rig.contact_history import ContactHistory
from pounding.experiments.rig.motion import FrameMotion
from pounding.experiments.rig.pounding import built, built_in, pound, shaking
from pounding.experiments.rig.rig import Rig
from pounding.experiments.rig.states import State, states_of

Real = NDArray[np.floating[Any]]
Quantity = Literal["displacement", "acceleration"]

STEP_S = 1e-3
"""Spacing of the drawn and compared motions [s]."""


def panels(number: str) -> list[Shaken]:
    """Return the named experiments that a figure of the thesis shows, in the order of its panels (a), (b), ...

    Args:
        number: Number of the figure, such as `4.3`.

    Raises:
        ExperimentError: No experiment says that it is shown there.
    """
    label = re.compile(rf"{re.escape(number)}(\(\w\))?")
    shown = [
        (figure, one)
        for one in experiments().values()
        for figure in one.figures
        if label.fullmatch(figure) and isinstance(one, Shaken)
    ]
    if not shown:
        raise ExperimentError(f"no experiment of the library is shown in figure {number}")
    return [one for _, one in sorted(shown, key=lambda pair: pair[0])]


@cache
def moving(frames: tuple[str, ...], record: str, state: State, folder: str | None) -> tuple[FrameMotion, ...]:
    """Return how frames move that do not touch.

    Args:
        frames: Names of the frames on the table, from left to right.
        record: Name of the ground motion.
        state: Their state.
        folder: Folder with ground motions; None for the default.
    """
    rig = Rig([built_in(own) for own in states_of(frames, state, record)])
    return tuple(rig.run(shaking(record, folder), solver="exact").frames)


def sampled(motion: FrameMotion, floor: int, quantity: Quantity) -> Real:
    """Return a floor's displacement relative to the table [m], or its acceleration in the room [m/s^2], at every `STEP_S`.

    Args:
        motion: The frame's motion.
        floor: Number of the floor.
        quantity: What is sampled.
    """
    times = np.arange(0.0, motion.time_s[-1], STEP_S)
    if quantity == "displacement":
        return np.asarray(motion.sampled(times)[0][:, motion.floor(floor)])
    return np.interp(times, motion.time_s, motion.floor_acceleration(floor))


def contact(
    pair: tuple[str, ...], record: str, gap_mm: float, law: Law, folder: str | None
) -> ContactHistory:
    """Return the contact of two baseline frames at the roof of the lower one.

    Args:
        pair: Left and right frame.
        record: Name of the ground motion.
        gap_mm: Gap at rest [mm].
        law: The impact law.
        folder: Folder with ground motions; None for the default.
    """
    left, right = (built(name) for name in pair)
    return pound(left, right, shaking(record, folder), law, 1e-3 * gap_mm, solver="exact").motion.contacts[0]
