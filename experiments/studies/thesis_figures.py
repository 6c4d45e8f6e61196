"""Counterparts of the thesis' figures 3.14 to 3.18, 4.2 to 4.10, 4.13 to 4.17, 5.9, 6.7 to 6.10 and E.1 to E.5.

The thesis' curves stood in figures and are lost; their peaks are printed in Tables 4.1 and 4.2 and stand in the panels.
Motion without contact is drawn by the baseline model, to which nothing is fitted, and in the state of strong motion, whose
damping is fitted to Table 4.1. All runs are exact. Run it with ``pounding study thesis-figures --out DIR``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import cache, partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from pounding.constants import STANDARD_GRAVITY
from pounding.contact.laws import BUILT_IN, Law
from pounding.contact.parameters import STIFFNESS_SETS, thesis_law, viscoelastic_of
from pounding.experiments import published
from pounding.experiments.campaign.cases import chapter_5, chapter_6
from pounding.experiments.campaign.dissimilarity import dissimilarity
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, progress_console, table
from pounding.experiments.pictures import scenes, sheets
from pounding.experiments.pictures.sheets import Level, Line
from pounding.experiments.records import Record
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.motion import ContactHistory, FrameMotion
from pounding.experiments.rig.pounding import built, built_in, pound, shaking
from pounding.experiments.rig.required_gap import contact_floors, required_gap
from pounding.experiments.rig.rig import Rig
from pounding.experiments.rig.states import FREE_VIBRATION, State, states_of
from pounding.experiments.studies.chapter_5 import REFERENCE
from pounding.experiments.studies.table_4_1 import RECORDS
from pounding.frames.drawing.rendering import cannot_render

STEP_S = 1e-3
"""Spacing of the drawn and compared motions [s]."""
WINDOW_S = 0.03
"""Length of the interval of figure 6.10 [s]: it holds the first impact."""
STATES: tuple[State, ...] = (FREE_VIBRATION, "strong-motion")
WORDS: dict[State, str] = {
    FREE_VIBRATION: "baseline model",
    "strong-motion": "strong motion (damping fitted)",
}
SOURCES: dict[str, tuple[str, str]] = {
    "experiment": ("printed, measured", "#b3262e"),
    "numerical": ("printed, SAP2000", "#3a7d44"),
}


class FrameFloor(NamedTuple):
    """A floor of a frame that shakes alone."""

    frame: str
    floor: int


DISPLACEMENTS = {
    "4.3": FrameFloor("5A", 5),
    "4.4": FrameFloor("5B", 5),
    "4.5": FrameFloor("10", 5),
    "4.6": FrameFloor("10", 10),
    "4.7": FrameFloor("15A", 15),
    "4.8": FrameFloor("15B", 5),
    "4.9": FrameFloor("15B", 10),
    "4.10": FrameFloor("15B", 15),
}
ACCELERATIONS = {
    "E.1": FrameFloor("5A", 5),
    "E.2": FrameFloor("5B", 5),
    "E.3": FrameFloor("10", 10),
    "E.4": FrameFloor("15A", 15),
    "E.5": FrameFloor("15B", 15),
}
GAPS = {
    "4.13": ("5A", "5B"),
    "4.14": ("15B", "10"),
    "4.15": ("15B", "5B"),
    "4.16": ("10", "5B"),
    "4.17": ("15A", "15B"),
}
FORCES = {"6.7": ("10", "5B"), "6.8": ("15B", "5B"), "6.9": ("15B", "10")}
PAIRS = ("4.14", "4.15", "4.16", "4.13", "4.17")
"""The pairs of figures 3.14 to 3.18 and 4.2, in their order, by the figure of their gaps."""
INTERVAL = ("15B", "5B", "northridge")
"""The test of figure 6.10."""


def main(
    *, out: options.Out = None, records: options.Records = None, json: options.Json = False
) -> dict[str, Any]:
    """Draw the counterpart of each figure of the thesis that shows a test, a motion, a gap or a force.

    Args:
        out: Folder for the pictures; without it only the numbers behind them are printed.
    """
    folder = None if records is None else str(records)
    motions = [shaking(name, folder) for name in RECORDS]
    result = stamp({"step_s": STEP_S, "window_s": WINDOW_S}, motions)
    work: dict[str, Callable[[], Any]] = {}
    for number, roof in DISPLACEMENTS.items():
        work[number] = partial(displacement_figure, number, roof, motions, out)
    for number, roof in ACCELERATIONS.items():
        work[number] = partial(acceleration_figure, number, roof, motions, out)
    for number, pair in GAPS.items():
        work[number] = partial(gap_figure, number, pair, motions, out)
    for number, pair in FORCES.items():
        work[number] = partial(force_figure, number, pair, folder, out)
    work |= {
        "6.10": partial(interval_figure, folder, out),
        "5.9": partial(stiffness_figure, folder, out),
        "4.2": partial(pairs_figure, out),
    }
    with progress_console().status("") as status:
        for place, (number, make) in enumerate(work.items(), 1):
            status.update(f"figure {number} ({place} of {len(work)})")
            result[f"figure_{number}"] = make()
    emit(result, as_json=json, show=lambda: show(result))
    return result


def displacement_figure(number: str, roof: FrameFloor, motions: Iterable[Record], out: Path | None) -> Any:
    """Return a floor's peaks [mm] by record and state, and draw its motion with the printed peaks.

    Args:
        number: Number of the figure.
        roof: The floor.
        motions: The four ground motions at model scale.
        out: Folder for the picture; None draws nothing.
    """
    motions = list(motions)
    rows = published.table("4.1").loc[(roof.frame, roof.floor)]
    title = f"Frame {roof.frame}, floor {roof.floor}: displacement relative to the table (figure {number})"
    figure, axes = sheets.four_panels(_named(motions), title, x=TIME, y="displacement [mm]")
    numbers: dict[str, Any] = {}
    for record, axis in zip(motions, axes, strict=True):
        lines = [
            _line(state, _alone(roof.frame, record, state), roof.floor, "displacement") for state in STATES
        ]
        levels = [
            Level(words, (rows[record.name, source, "max"], -rows[record.name, source, "min"]), colour)
            for source, (words, colour) in SOURCES.items()
        ]
        sheets.motion(axis, lines, levels)
        numbers[record.name] = {
            state: {"max_mm": float(line.values.max()), "min_mm": float(-line.values.min())}
            for state, line in zip(STATES, lines, strict=True)
        }
    sheets.legend(figure, axes)
    _keep(figure, number, out)
    return numbers


def acceleration_figure(number: str, roof: FrameFloor, motions: Iterable[Record], out: Path | None) -> Any:
    """Return a roof's largest acceleration in the room [g] by record and state, and draw it; as `displacement_figure`.

    Args:
        number: Number of the figure.
        roof: The roof.
        motions: The four ground motions at model scale.
        out: Folder for the picture; None draws nothing.
    """
    motions = list(motions)
    title = f"Frame {roof.frame}, roof: acceleration in the room (figure {number})"
    figure, axes = sheets.four_panels(_named(motions), title, x=TIME, y="acceleration [g]")
    numbers: dict[str, Any] = {}
    for record, axis in zip(motions, axes, strict=True):
        lines = [
            _line(state, _alone(roof.frame, record, state), roof.floor, "acceleration") for state in STATES
        ]
        sheets.motion(axis, lines)
        numbers[record.name] = {
            state: {"max_g": float(np.abs(line.values).max())}
            for state, line in zip(STATES, lines, strict=True)
        }
    sheets.legend(figure, axes)
    _keep(figure, number, out)
    return numbers


def gap_figure(number: str, pair: tuple[str, str], motions: Iterable[Record], out: Path | None) -> Any:
    """Return the required gaps [mm] of a pair by record and state, and draw the closing motion with the printed gaps.

    Args:
        number: Number of the figure.
        pair: Left and right frame.
        motions: The four ground motions at model scale.
        out: Folder for the picture; None draws nothing.
    """
    motions = list(motions)
    left, right = (built(name) for name in pair)
    floors = contact_floors(left, right)
    printed = published.table("4.2").loc[(*pair, floors[0])]
    title = f"{pair[0]} beside {pair[1]}, floor {floors[0]}: closing motion without contact (figure {number})"
    figure, axes = sheets.four_panels(_named(motions), title, x=TIME, y="closing motion [mm]")
    numbers: dict[str, Any] = {}
    for record, axis in zip(motions, axes, strict=True):
        lines, numbers[record.name] = [], {}
        for state in STATES:
            sides = zip(_apart(pair, record, state), floors, strict=True)
            left_m, right_m = (_moved(motion, floor, "displacement") for motion, floor in sides)
            need = required_gap(left_m, right_m, STEP_S)
            numbers[record.name][state] = {
                "closing_mm": 1e3 * need.closing_m,
                "equation_4_1_mm": 1e3 * need.equation_4_1_m,
            }
            times = STEP_S * np.arange(len(left_m))
            lines.append(Line(WORDS[state], times, 1e3 * (left_m - right_m)))
        levels = [
            Level(words, (printed[record.name, source],), colour)
            for source, (words, colour) in SOURCES.items()
        ]
        sheets.motion(axis, lines, levels)
    sheets.legend(figure, axes)
    _keep(figure, number, out)
    return numbers


def force_figure(number: str, pair: tuple[str, str], folder: str | None, out: Path | None) -> Any:
    """Return the largest force [N] of each law by record, and draw the forces of a pair at the gaps of the tests.

    Args:
        number: Number of the figure.
        pair: Left and right frame.
        folder: Folder with ground motions; None for the default.
        out: Folder for the picture; None draws nothing.
    """
    tests = [test for test in chapter_6() if (test.left, test.right) == pair]
    title = f"{pair[0]} beside {pair[1]}: contact force of five laws (figure {number})"
    names = [f"{test.record}, gap {test.gap_mm:g} mm" for test in tests]
    figure, axes = sheets.four_panels(names, title, x=TIME, y="contact force [N]")
    numbers: dict[str, Any] = {}
    for test, axis in zip(tests, axes, strict=True):
        contacts = {
            law: _contact(pair, test.record, test.gap_mm, thesis_law(law), folder) for law in BUILT_IN
        }
        sheets.forces(axis, contacts)
        numbers[test.record] = {
            law: float(contact.sampled()[1].max(initial=0.0)) for law, contact in contacts.items()
        }
    sheets.legend(figure, axes)
    _keep(figure, number, out)
    return numbers


def interval_figure(folder: str | None, out: Path | None) -> Any:
    """Return how far each law's summed forces are from the linear viscoelastic law's in one interval [N], and draw them.

    The measured force of figure 6.10 is lost; the law that the thesis ranks first stands in its place.

    Args:
        folder: Folder with ground motions; None for the default.
        out: Folder for the picture; None draws nothing.
    """
    test = next(one for one in chapter_6() if (one.left, one.right, one.record) == INTERVAL)
    order = ("linear_viscoelastic", *(law for law in BUILT_IN if law != "linear_viscoelastic"))
    pair = (test.left, test.right)
    found = {law: _contact(pair, test.record, test.gap_mm, thesis_law(law), folder) for law in order}
    # Each run has its own first impact, some milliseconds from the others': intervals begin at their own touch.
    lines = [Line(law, *_first_interval(contact)) for law, contact in found.items()]
    values = {line.label: dissimilarity(line.values, lines[0].values) for line in lines}
    title = (
        f"{pair[0]} beside {pair[1]}, {test.record}, gap {test.gap_mm:g} mm: the first impact (figure 6.10)"
    )
    if out is not None:
        sheets.save(sheets.force_and_sum(lines, values, title), _file("6.10", out))
    return values


def _first_interval(contact: ContactHistory) -> tuple[Any, Any]:
    times, force = contact.sampled()
    first = int(np.searchsorted(times, contact.pulses[0][0])) - 10
    last = first + round(WINDOW_S / (times[1] - times[0]))
    return times[first:last] - times[first], force[first:last]


def stiffness_figure(folder: str | None, out: Path | None) -> Any:
    """Return by what the first peak force of each stiffness of Table 5.1 differs from that of the experiment's [%].

    The measured forces of figure 5.9 are lost; the run with the stiffness of the experiment stands in their place.

    Args:
        folder: Folder with ground motions; None for the default.
        out: Folder for the picture; None draws nothing.
    """
    errors: dict[str, dict[str, list[float]]] = {}
    for test in chapter_5():
        peaks = {}
        for source in STIFFNESS_SETS:
            contact = _contact(
                (test.left, test.right), test.record, test.gap_mm, viscoelastic_of(source), folder
            )
            peaks[source] = float(contact.pulse(*contact.pulses[0])[3].max()) if contact.pulses else np.nan
        for source, peak in peaks.items():
            if source != REFERENCE and np.isfinite(peak) and np.isfinite(peaks[REFERENCE]):
                by_record = errors.setdefault(source, {name: [] for name in RECORDS})
                by_record[test.record].append(100.0 * (peak / peaks[REFERENCE] - 1.0))
    named = {
        f"{source.replace('_', ' ')}\n{STIFFNESS_SETS[source][0] / 1e6:.4g} kN/mm": values
        for source, values in errors.items()
    }
    reference = f"{STIFFNESS_SETS[REFERENCE][0] / 1e6:.4g} kN/mm"
    title = f"15B beside 5B: first peak force, compared with the stiffness of the experiment, {reference} (figure 5.9)"
    if out is not None:
        sheets.save(sheets.errors_by_choice(named, title), _file("5.9", out))
    return {
        source: {
            "mean_percent": float(np.mean(every)),
            "mean_size_percent": float(np.mean(np.abs(every))),
            "tests": len(every),
        }
        for source, by_record in errors.items()
        for every in [np.concatenate(list(by_record.values()))]
    }


def pairs_figure(out: Path | None) -> Any:
    """Draw the five pairs on the table, at rest (figures 3.14 to 3.18 and 4.2).

    Args:
        out: Folder for the picture; None draws nothing.

    Returns:
        A sentence where the machine cannot render; else None.
    """
    if out is None:
        return None
    if sentence := cannot_render():
        return sentence
    groups = {
        f"({letter}) {left} beside {right}": (built(left), built(right))
        for letter, (left, right) in zip("abcde", (GAPS[number] for number in PAIRS), strict=True)
    }
    scenes.at_rest(groups, _file("4.2", out))
    return None


TIME = "time on the model's clock [s]"


@cache
def _alone(frame: str, record: Record, state: State) -> FrameMotion:
    (own,) = states_of((frame,), state, record.name)
    return Rig([built_in(own)]).run(record, solver="exact").frames[0]


@cache
def _apart(pair: tuple[str, str], record: Record, state: State) -> list[FrameMotion]:
    frames = [built_in(own) for own in states_of(pair, state, record.name)]
    return list(Rig(frames).run(record, solver="exact").frames)


def _moved(motion: FrameMotion, floor: int, quantity: str) -> Any:
    """Return the displacement [m] or the acceleration in the room [m/s^2] of a floor at every `STEP_S`."""
    times = np.arange(0.0, motion.time_s[-1], STEP_S)
    if quantity == "displacement":
        return motion.sampled(times)[0][:, motion.floor(floor)]
    return np.interp(times, motion.time_s, motion.floor_acceleration(floor))


def _line(state: State, motion: FrameMotion, floor: int, quantity: str) -> Line:
    values = _moved(motion, floor, quantity) * (1e3 if quantity == "displacement" else 1.0 / STANDARD_GRAVITY)
    return Line(WORDS[state], STEP_S * np.arange(len(values)), values)


def _contact(
    pair: tuple[str, str], record: str, gap_mm: float, law: Law, folder: str | None
) -> ContactHistory:
    left, right = (built(name) for name in pair)
    return pound(left, right, shaking(record, folder), law, 1e-3 * gap_mm, solver="exact").motion.contacts[0]


def _named(motions: Iterable[Record]) -> list[str]:
    return [f"{record.name}, {record.pga_g:.3f} g" for record in motions]


def _file(number: str, out: Path) -> Path:
    return out / f"figure-{number.lower().replace('.', '-')}.png"


def _keep(figure: Any, number: str, out: Path | None) -> None:
    if out is not None:
        sheets.save(figure, _file(number, out))


def show(result: Mapping[str, Any]) -> Iterable[Any]:
    """Return a table of the numbers behind the figures for a reader."""
    rows = []
    for key, numbers in result.items():
        if key.startswith("figure_") and isinstance(numbers, dict):
            rows += [[key.removeprefix("figure_"), name, _shown(value)] for name, value in numbers.items()]
    yield table("Numbers behind the figures", ["figure", "record, law or stiffness", "ours"], rows)
    yield "The peaks and gaps that are printed in the thesis stand in Tables 4.1 and 4.2, and in the panels."


def _shown(value: Any) -> str:
    if not isinstance(value, Mapping):
        return f"{value:.4g} N"
    return ", ".join(
        f"{key.replace('_', ' ')}: {_shown(one) if isinstance(one, Mapping) else format(one, '.4g')}"
        for key, one in value.items()
    )


if __name__ == "__main__":
    run_script(main)
