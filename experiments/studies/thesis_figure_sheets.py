"""One function for each kind of figure: it returns the numbers behind the figure and draws it where a folder is given."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from pounding.constants import STANDARD_GRAVITY
from pounding.contact.laws import BUILT_IN
from pounding.contact.parameters import STIFFNESS_SETS, thesis_law, viscoelastic_of
from pounding.experiments import published
from pounding.experiments.campaign.cases import WINDOW_S
from pounding.experiments.campaign.dissimilarity import dissimilarity
from pounding.experiments.configurations.definition import Collision, ContactStiffness, Shaken
from pounding.experiments.pictures import at_rest, sheets
from pounding.experiments.pictures.palette import BLACK, PURPLE
from pounding.experiments.pictures.sheets import Level, Line
from pounding.experiments.rig.contact_history import ContactHistory
from pounding.experiments.rig.pounding import built, shaking
from pounding.experiments.rig.required_gap import contact_floors, required_gap
from pounding.experiments.rig.states import FREE_VIBRATION, State
from pounding.experiments.studies.chapter_5 import REFERENCE
from pounding.experiments.studies.thesis_figure_runs import (
    STEP_S,
    Quantity,
    Real,
    contact,
    moving,
    panels,
    sampled,
)
from pounding.frames.drawing.rendering import cannot_render

COMPARED_WITH = "linear_viscoelastic"
"""Law that stands in the place of the lost measurement in figure 6.10: the one that the thesis ranks first."""
STATES: dict[State, str] = {
    FREE_VIBRATION: "baseline model",
    "strong-motion": "strong motion (damping fitted)",
}
SOURCES: dict[str, tuple[str, str, str]] = {
    "experiment": ("printed, measured", BLACK, "--"),
    "numerical": ("printed, SAP2000", PURPLE, "-."),
}
"""Whose published values are marked: in words, with colour and dashes, either of which tells them apart."""
SCALES: dict[Quantity, tuple[str, float, str]] = {
    "displacement": ("displacement relative to the table", 1e3, "mm"),
    "acceleration": ("acceleration in the room", 1.0 / STANDARD_GRAVITY, "g"),
}
TIME = "time on the model's clock [s]"

Numbers = dict[str, Any]


def history_figure(
    number: str, floor: int, quantity: Quantity, folder: str | None = None, out: Path | None = None
) -> Numbers:
    """Return a floor's largest and least value [mm or g] by record and state; draw its motion, with peaks where printed.

    Args:
        number: Number of the figure.
        floor: The floor.
        quantity: What is shown.
        folder: Folder with ground motions; None for the default.
        out: Folder for the picture; None draws nothing.
    """
    shown = panels(number)
    words, factor, unit = SCALES[quantity]
    (frame,) = shown[0].frame_names
    title = f"Frame {frame}, floor {floor}: {words} (figure {number})"
    figure, axes = sheets.four_panels(_motions(shown, folder), title, x=TIME, y=f"{quantity} [{unit}]")
    numbers: Numbers = {}
    for one, axis in zip(shown, axes, strict=True):
        values = {
            state: factor * sampled(moving(one.frame_names, one.record, state, folder)[0], floor, quantity)
            for state in STATES
        }
        levels = _printed_peaks(frame, floor, one.record) if quantity == "displacement" else []
        sheets.motion(axis, _lines(values), levels)
        numbers[one.record] = {
            state: {f"max_{unit}": float(each.max()), f"min_{unit}": float(-each.min())}
            for state, each in values.items()
        }
    _finish(figure, axes, number, out)
    return numbers


def gap_figure(number: str, folder: str | None = None, out: Path | None = None) -> Numbers:
    """Return the required gaps [mm] of a pair by record and state; draw the closing motion with the printed gaps.

    Args:
        number: Number of the figure.
        folder: Folder with ground motions; None for the default.
        out: Folder for the picture; None draws nothing.
    """
    shown = panels(number)
    left, right = shown[0].frame_names
    floors = contact_floors(built(left), built(right))
    title = f"{left} beside {right}, floor {floors[0]}: closing motion without contact (figure {number})"
    figure, axes = sheets.four_panels(_motions(shown, folder), title, x=TIME, y="closing motion [mm]")
    numbers: Numbers = {}
    for one, axis in zip(shown, axes, strict=True):
        closing: dict[State, Real] = {}
        numbers[one.record] = {}
        for state in STATES:
            sides = zip(moving(one.frame_names, one.record, state, folder), floors, strict=True)
            left_m, right_m = (sampled(motion, floor, "displacement") for motion, floor in sides)
            need = required_gap(left_m, right_m, STEP_S)
            closing[state] = 1e3 * (left_m - right_m)
            numbers[one.record][state] = {
                "closing_mm": 1e3 * need.closing_m,
                "equation_4_1_mm": 1e3 * need.equation_4_1_m,
            }
        printed = published.table("4.2").loc[(left, right, floors[0])]
        levels = [
            Level(words, (printed[one.record, source],), *look) for source, (words, *look) in SOURCES.items()
        ]
        sheets.motion(axis, _lines(closing), levels)
    _finish(figure, axes, number, out)
    return numbers


def force_figure(number: str, folder: str | None = None, out: Path | None = None) -> Numbers:
    """Return the largest force [N] of each law by record; draw the forces of a pair at the gaps of the tests.

    Args:
        number: Number of the figure.
        folder: Folder with ground motions; None for the default.
        out: Folder for the picture; None draws nothing.
    """
    shown = [one for one in panels(number) if isinstance(one, Collision)]
    left, right = shown[0].frame_names
    title = f"{left} beside {right}: contact force of five laws (figure {number})"
    names = [f"{one.record}, gap {one.gap_mm:g} mm" for one in shown]
    figure, axes = sheets.four_panels(names, title, x=TIME, y="contact force [N]")
    numbers: Numbers = {}
    for one, axis in zip(shown, axes, strict=True):
        contacts = _contacts(one, BUILT_IN, folder)
        sheets.forces(axis, contacts)
        numbers[one.record] = {law: float(c.sampled()[1].max(initial=0.0)) for law, c in contacts.items()}
    _finish(figure, axes, number, out)
    return numbers


def interval_figure(number: str, folder: str | None = None, out: Path | None = None) -> Numbers:
    """Return how far each law's summed forces are from those of `COMPARED_WITH` in one interval [N]; draw them.

    Args:
        number: Number of the figure.
        folder: Folder with ground motions; None for the default.
        out: Folder for the picture; None draws nothing.
    """
    (one,) = (one for one in panels(number) if isinstance(one, Collision))
    order = (COMPARED_WITH, *(law for law in BUILT_IN if law != COMPARED_WITH))
    # Each run has its own first impact, some milliseconds from the others': intervals begin at their own touch.
    lines = [Line(law, *_first_interval(each)) for law, each in _contacts(one, order, folder).items()]
    values = {line.label: dissimilarity(line.values, lines[0].values) for line in lines}
    title = f"{one.title.partition(',')[0]}, gap {one.gap_mm:g} mm: the first impact (figure {number})"
    if out is not None:
        sheets.save(sheets.force_and_sum(lines, values, title), _file(number, out))
    return values


def stiffness_figure(number: str, folder: str | None = None, out: Path | None = None) -> Numbers:
    """Return by what the first peak force of each stiffness of Table 5.1 differs from that of the experiment's [%].

    The measured forces are lost; the run with the stiffness of the experiment stands in their place.

    Args:
        number: Number of the figure.
        folder: Folder with ground motions; None for the default.
        out: Folder for the picture; None draws nothing.
    """
    tests = [one for one in panels(number) if isinstance(one, ContactStiffness)]
    errors: dict[str, dict[str, list[float]]] = {}
    for one in tests:
        peaks = {source: _first_peak(one, source, folder) for source in one.sources}
        for source in one.sources:
            if source != REFERENCE and peaks[source] and peaks[REFERENCE]:
                by_record = errors.setdefault(source, {other.record: [] for other in tests})
                by_record[one.record].append(100.0 * (peaks[source] / peaks[REFERENCE] - 1.0))
    if out is not None:
        named = {f"{source.replace('_', ' ')}\n{_stiffness(source)}": each for source, each in errors.items()}
        title = f"15B beside 5B: first peak force, compared with {_stiffness(REFERENCE)} (figure {number})"
        sheets.save(sheets.errors_by_choice(named, title), _file(number, out))
    every = {source: np.concatenate(list(by_record.values())) for source, by_record in errors.items()}
    return {
        source: {"mean_percent": float(each.mean()), "tests": len(each)} for source, each in every.items()
    }


def pairs_figure(number: str, out: Path | None = None) -> str | None:
    """Draw the pairs on the table at rest.

    Args:
        number: Number of the figure.
        out: Folder for the picture; None draws nothing.

    Returns:
        A sentence where the machine cannot render; else None.
    """
    reason = cannot_render()
    if out is None or reason:
        return reason
    # A pair is shown once, and was tested under four records.
    pairs = list(dict.fromkeys(one.frame_names for one in panels(number)))
    groups = {
        f"({letter}) {left} beside {right}": (built(left), built(right))
        for letter, (left, right) in zip("abcde", pairs, strict=True)
    }
    at_rest.picture(groups, _file(number, out))
    return None


def _motions(shown: Sequence[Shaken], folder: str | None) -> list[str]:
    """Return what stands above the panels: each record with its peak."""
    return [f"{one.record}, {shaking(one.record, folder).pga_g:.3f} g" for one in shown]


def _lines(values: Mapping[State, Real]) -> list[Line]:
    return [Line(STATES[state], STEP_S * np.arange(len(each)), each) for state, each in values.items()]


def _printed_peaks(frame: str, floor: int, record: str) -> list[Level]:
    row = published.table("4.1").loc[(frame, floor)]
    return [
        Level(words, (row[record, source, "max"], -row[record, source, "min"]), *look)
        for source, (words, *look) in SOURCES.items()
    ]


def _contacts(one: Collision, laws: Sequence[str], folder: str | None) -> dict[str, ContactHistory]:
    return {law: contact(one.frame_names, one.record, one.gap_mm, thesis_law(law), folder) for law in laws}


def _first_interval(history: ContactHistory) -> tuple[Real, Real]:
    times, force = history.sampled()
    first = int(np.searchsorted(times, history.pulses[0][0])) - 10
    last = first + round(WINDOW_S / (times[1] - times[0]))
    return times[first:last] - times[first], force[first:last]


def _first_peak(one: ContactStiffness, source: str, folder: str | None) -> float:
    """Return the largest force of the first touch [N]; 0 where there is none."""
    history = contact(one.frame_names, one.record, one.gap_mm, viscoelastic_of(source), folder)
    return float(history.pulse(*history.pulses[0])[3].max()) if history.pulses else 0.0


def _stiffness(source: str) -> str:
    return f"{STIFFNESS_SETS[source][0] / 1e6:.4g} kN/mm"


def _file(number: str, out: Path) -> Path:
    return out / f"figure-{number.lower().replace('.', '-')}.png"


def _finish(figure: Figure, axes: Sequence[Any], number: str, out: Path | None) -> None:
    sheets.legend(figure, axes)
    if out is not None:
        sheets.save(figure, _file(number, out))
