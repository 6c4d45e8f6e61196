"""The report as files: `report.json`, a self-contained `report.html` and its figures."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import jinja2

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.decision.diagnosis import Diagnosis
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.model.forked import meanwhile
from pounding.diagnosis.report.details import detailed
from pounding.diagnosis.report.figures import figures
from pounding.diagnosis.report.loops import loops
from pounding.diagnosis.report.making import Made
from pounding.diagnosis.report.modal import contents, drawing
from pounding.diagnosis.report.on_the_frame import on_the_frame, write_frames
from pounding.diagnosis.report.report import Report
from pounding.diagnosis.report.report_text import (
    LN_BAYES,
    against_the_next,
    assumptions,
    before_the_change,
    beside_the_verdict,
    next_steps,
    number,
    percent,
    sentence,
)
from pounding.diagnosis.report.sheet import sheet
from pounding.diagnosis.settings import SETTINGS
from pounding.experiments.output.html import LOADER
from pounding.frames.errors import FrameError
from pounding.frames.files import write_whole

Pictures = Mapping[str, bytes]
"""PNG by name."""


def write_report(diagnosis: Diagnosis, made: Made, folder: Path, *, film: bool = False) -> Report:
    """Write the files of the report on runs, `report.json` last; each appears whole or not at all.

    Args:
        diagnosis: The diagnosis.
        made: The report and what was simulated for it.
        folder: The folder; it is made if it is missing.
        film: Whether to film the run before and after over each other.

    Returns:
        The report as written: with what `pounding.diagnosis.report.details.detailed` adds.

    Raises:
        CaseError: The folder cannot be made or written.
        FrameError: VTK files, picture or film cannot be written.
        MissingExtraError: A film is asked for and imageio-ffmpeg is not installed.
    """
    loop = loops(diagnosis)
    report = detailed(diagnosis, made, loop)
    first = sheet(diagnosis, report)
    shown = on_the_frame(diagnosis, made.motions)
    draw = partial(figures, diagnosis, report, made.outputs, loop, first.figure_mm)
    with meanwhile(draw, diagnosis.found.is_light) as drawn:
        picture = write_frames(shown, folder, film=film)
        pictures = drawn()
    if picture is not None:
        pictures["on_the_frame"] = picture
    case, stated = diagnosis.case, assumptions(diagnosis.case, report, len(diagnosis.found.model.std))
    _write(
        folder,
        case,
        report,
        pictures,
        "report.html.jinja",
        sheet=first,
        next_steps=next_steps(report, figures=True),
        against_the_next=against_the_next(report),
        assumptions=stated,
        frame_run=shown.run,
        settings=SETTINGS.report,
    )
    made_now = [*(f"{name}.png" for name in pictures), *(["after.pvd"] if shown.after else [])]
    forget(folder, [*made_now, *(["before_after.mp4"] if film else [])])
    return report


SOMETIMES = ("force_over_drift.png", "on_the_frame.png", "after.pvd", "before_after.mp4")
"""Files that not every report has."""


def forget(folder: Path, written: Sequence[str]) -> None:
    """Remove what a former report left in a folder and the present one does not have.

    Args:
        folder: The folder.
        written: Names of the files that were written now.
    """
    for name in SOMETIMES:
        if name not in written:
            (folder / name).unlink(missing_ok=True)


def write_modal_report(case: Case, report: Report, folder: Path) -> None:
    """Write the files of the report on modal data, `report.json` last; each appears whole or not at all.

    Args:
        case: The case.
        report: The report.
        folder: The folder; it is made if it is missing.

    Raises:
        CaseError: The folder cannot be made or written.
    """
    pictures = {"numbers": drawing(report.modal or ())}
    _write(folder, case, report, pictures, "modal.html.jinja", tables=contents(report))


def _write(folder: Path, case: Case, report: Report, pictures: Pictures, template: str, **more: Any) -> None:
    page = _page(template, case=case, report=report, pictures=pictures, **more)
    files = {f"{name}.png": picture for name, picture in pictures.items()}
    files |= {"report.html": page.encode(), "report.json": report.json().encode()}
    try:
        for name, content in files.items():
            write_whole(folder / name, content)
    except FrameError as error:
        raise CaseError(str(error)) from error


def _page(template: str, *, report: Report, pictures: Pictures, **more: Any) -> str:
    """Return a report as one HTML page that needs no other file."""
    environment = jinja2.Environment(
        # The look of all reports is that of the experiments' room.
        loader=jinja2.ChoiceLoader([jinja2.FileSystemLoader(Path(__file__).parent), LOADER]),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
    )
    environment.filters |= {"number": number, "percent": percent}
    embedded = {name: base64.b64encode(picture).decode() for name, picture in pictures.items()}
    return environment.get_template(template).render(
        report=report,
        sentence=sentence(report),
        beside=beside_the_verdict(report),
        before_the_change=before_the_change(report),
        ln_bayes=LN_BAYES,
        pictures=embedded,
        **more,
    )
