"""The findings of a report for the terminal."""

from __future__ import annotations

from collections.abc import Iterator

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from pounding.diagnosis.decision.claims import Parameter
from pounding.diagnosis.report.modal import contents
from pounding.diagnosis.report.report import Report
from pounding.diagnosis.report.report_text import (
    LN_BAYES,
    against_the_next,
    before_the_change,
    frequencies_in_step,
    nearest,
    number,
    percent,
    sentence,
)
from pounding.experiments.console.output import table

SPOTS, CANDIDATES = 4, 8
"""How many places of misfit and how many candidates are shown."""


def tables(report: Report) -> Iterator[RenderableType]:
    """Yield the findings of a report, the verdict in a sentence first."""
    yield Text(sentence(report))
    if said := before_the_change(report):
        yield Text(said)
    yield from _of_modal_data(report) if report.modal else _of_runs(report)
    yield Text(LN_BAYES)
    for pair in report.apart or ():
        first, other = (place.words() for place in pair.between)
        yield Text(f"to tell {first} from {other}: {' '.join(pair.tests)}")
    for warning in report.warnings:
        yield Text(f"warning: {warning}")


def _of_modal_data(report: Report) -> Iterator[RenderableType]:
    for title, heads, rows in contents(report):
        if rows:
            yield table(title, heads, rows)


def _of_runs(report: Report) -> Iterator[RenderableType]:
    yield _misfits(report)
    if contact := report.misfit.contact:
        left = f"{number(contact.before)} with the contact of the baseline model"
        if contact.after != contact.before:
            left += f", {number(contact.after)} with the contact as found"
        yield Text(
            f"{contact.impacts} held-out impacts, rms error of their forces in standard deviations (1 is expected): {left}"
        )
    if report.effects:
        yield _effects(report)
    if report.remainder is not None:
        yield Text(f"What remains: {report.remainder.statement}.")
    for beside in (*nearest(report), *frequencies_in_step(report)):
        yield Text(f"{beside[0].upper()}{beside[1:]}.")
    if report.where:
        title = "Where the baseline model disagrees most"
        spots = [
            (
                one.channel,
                one.run,
                *(f"{number(a)} to {number(b)}" for a, b in (one.window_s, one.band_hz)),
                percent(one.misfit),
            )
            for one in report.where[:SPOTS]
        ]
        yield table(title, ["channel", "run", "window [s]", "band [Hz]", "misfit"], spots)
    ranked = [
        (tried.effect, tried.where(), f"{tried.log_evidence:.1f}") for tried in report.candidates[:CANDIDATES]
    ]
    yield table("Evidence against 'nothing missing'", ["candidate", "where", "ln Bayes factor"], ranked)
    if said := against_the_next(report):
        yield Text(said)


def _effects(report: Report) -> Table:
    title = "Nearest of what was tried" if report.verdict == "unknown_effect" else "What is missing"
    rows = [
        (effect.effect, effect.where(), one.name, _size(one))
        for effect in report.effects
        for one in effect.parameters
    ]
    return table(title, ["effect", "where", "parameter", "value and standard error"], rows)


def _size(one: Parameter) -> str:
    """Return value, standard error and unit; what has no size, such as the name of a law, stands alone."""
    words = number(one.value)
    if (error := number(one.std)) != "–":
        words += f" ± {error}"
    return f"{words} {one.shown_unit}".rstrip()


def _misfits(report: Report) -> Table:
    title = "Misfit (NRMSE): rms(simulated - measured) / rms(measured)"
    held_out = report.misfit.held_out
    keys = ("before", "after", "noise_floor", "explained")
    rows = [
        (label, *(percent(getattr(misfit, key, None)) for key in keys))
        for label, misfit in (
            ("training", report.misfit.training),
            (f"held out ({held_out.run})" if held_out else "held out: none, there is a single run", held_out),
        )
    ]
    return table(title, ["runs", "before", "after", "noise floor", "explained"], rows)
