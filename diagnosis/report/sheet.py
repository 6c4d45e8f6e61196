"""The first page of a report, one sheet of paper: the verdict in plain words and what an engineer hands on with it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import msgspec

from pounding.diagnosis.decision.claims import Claim
from pounding.diagnosis.decision.diagnosis import Diagnosis
from pounding.diagnosis.report.frame_sketch import frame_sketch
from pounding.diagnosis.report.plain_words import description, headline
from pounding.diagnosis.report.report import CalibratedParameter, Report
from pounding.diagnosis.report.report_text import beside_the_verdict, next_steps, sentence

STEPS, WARNINGS, MOVED = 3, 2, 4
"""How many steps to take next, warnings and moved parameters stand on the sheet; all stand behind it."""


LETTERS = 100
"""Letters in a printed line of text."""
ROOM_MM, LINE_MM, FIGURE_MM = 190.0, 4.6, (62.0, 120.0)
"""Height that the figure has on a sheet without text and modes, what a line of them takes of it, and its bounds [mm]."""


@dataclass(frozen=True)
class ModeRow:
    """Frequency [Hz] and damping ratio of a mode: `measured` where it can be read without a model."""

    frame: str
    mode: int
    frequency: CalibratedParameter
    damping: CalibratedParameter


@dataclass(frozen=True)
class Sheet:
    """What stands on the first page.

    Attributes:
        headline: The verdict in plain words.
        sketch: The frames with the place marked, SVG.
        measured: What was measured, in a sentence.
        modes: Frequencies and damping of the frames.
        moved: What calibration moved most, in words.
        steps: What to measure next, sentences.
        warnings: The first warnings.
        more_warnings: How many more there are.
        figure_mm: Height of the figure on paper [mm].
    """

    headline: str
    sketch: str
    measured: str
    modes: tuple[ModeRow, ...]
    moved: tuple[str, ...]
    steps: tuple[str, ...]
    warnings: tuple[str, ...]
    more_warnings: int
    figure_mm: float


def sheet(diagnosis: Diagnosis, report: Report) -> Sheet:
    """Return the first page.

    Args:
        diagnosis: What was found and decided.
        report: The report with its details.
    """
    case = diagnosis.case
    effects = report.effects if report.named else ()
    channels = [
        (one.frame, one.floor) for one in case.channels if one.frame is not None and one.floor is not None
    ]
    places = [(frame, floor) for frame, floor in channels if floor > 0]
    calibration = report.calibration or ()
    rows = [one for one in calibration if one.parameter not in ("frequency_hz", "damping_ratio")]
    rows.sort(key=lambda one: -abs(one.moved() or 0.0))
    tests = [test for pair in report.apart or () for test in pair.tests]
    steps = list(dict.fromkeys([*tests, *next_steps(report), *_confirming(effects)]))[:STEPS]
    # Impacts fill the spectrum and change its first peak.
    modes, title = _modes(calibration, readable=not case.contacts), headline(report)
    text = [title, sentence(report), *beside_the_verdict(report), *report.warnings[: WARNINGS + 1], *steps]
    lines = len(modes) + sum(math.ceil(len(one) / LETTERS) for one in text) + 2 * bool(steps)
    return Sheet(
        headline=title,
        sketch=frame_sketch(case, effects, places),
        measured=_measured(diagnosis),
        modes=modes,
        moved=tuple(_in_words(one) for one in rows[:MOVED]),
        steps=tuple(steps),
        warnings=report.warnings[:WARNINGS],
        more_warnings=max(0, len(report.warnings) - WARNINGS),
        figure_mm=min(max(ROOM_MM - LINE_MM * lines, FIGURE_MM[0]), FIGURE_MM[1]),
    )


def _confirming(effects: Sequence[Claim]) -> list[str]:
    """Return a test for each effect that shows it and little else."""
    described = [description(one.effect) for one in effects]
    return [f"To confirm it: {one.told_by}" for one in described if one is not None and one.told_by]


def _measured(diagnosis: Diagnosis) -> str:
    case = diagnosis.case
    frames = " and ".join(frame.name for frame in case.frames)
    runs, channels = len(case.runs), len(case.channels)
    seconds = sum(float(run.time_s[-1] - run.time_s[0]) for run in case.runs)
    return (
        f"{frames}: {channels} channel{'s' * (channels != 1)} in {runs} run{'s' * (runs != 1)} on the shaking table, "
        f"{seconds:.3g} s in all"
    )


def _modes(calibration: tuple[CalibratedParameter, ...], readable: bool) -> tuple[ModeRow, ...]:
    """Return frequency and damping of each mode, side by side; with what was measured where it is `readable`."""
    known = {(one.parameter, one.frame, one.mode): one for one in calibration if isinstance(one.mode, int)}
    return tuple(
        ModeRow(str(frame), int(mode), one if readable else _unread(one), known["damping_ratio", frame, mode])
        for (name, frame, mode), one in known.items()
        if name == "frequency_hz" and ("damping_ratio", frame, mode) in known and isinstance(mode, int)
    )


def _unread(one: CalibratedParameter) -> CalibratedParameter:
    return msgspec.structs.replace(one, measured=msgspec.UNSET, resolution=msgspec.UNSET)


def _in_words(one: CalibratedParameter) -> str:
    """Return what became of a parameter: `storey stiffness of storey 3 of 5A +4.5 %`."""
    name = one.parameter.replace("_", " ")
    place = "" if one.where() == "the table" else f", {one.where()}"
    if one.parameter == "damping_power":
        return f"damping follows the frequency to the power {one.calibrated:.2g}{place}"
    if one.baseline == 0.0:
        return f"{name}{place}: {1e3 * one.calibrated:+.2g} ms"
    return f"{name}{place}: {100.0 * (one.calibrated / one.baseline - 1.0):+.2g} %"
