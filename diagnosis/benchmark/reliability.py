"""Whether the stated confidence holds: fitted to some cases of a benchmark, judged on the others.

``python -m pounding.diagnosis.benchmark.reliability FOLDER --first N --fit PAIRS.jsonl`` writes the features of the first N
finished cases for `diagnosis.benchmark.fitting`; with ``--skip N --picture FILE`` the others' confidence, by the calibration
that is shipped now, is put beside the share that was right.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from pounding.diagnosis.benchmark.pictures import draw_reliability
from pounding.diagnosis.benchmark.scoring import Judged, judge
from pounding.diagnosis.benchmark.summary import reliability, shown
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.report.reading import report_from
from pounding.diagnosis.report.report import Report
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.frames.files import write_whole

Finished = tuple[int, dict[str, Any], Report]
"""Number of a case in its set, its truth, and the report on it."""


def finished(folder: Path) -> list[Finished]:
    """Return number, truth and report of the finished cases of a benchmark's folder, in the order of the set.

    Raises:
        CaseError: There is none, or one of the files is none.
    """
    found = [one for path in sorted((folder / "cases").glob("*.json")) if (one := _finished(path))]
    if not found:
        raise CaseError(
            f"{folder}: no finished case of a benchmark; run `pounding diagnose --benchmark N --out` first"
        )
    return sorted(found, key=lambda one: one[0])


def _finished(path: Path) -> Finished | None:
    """Return what a file keeps of a case, or None of one that failed."""
    try:
        kept = json.loads(path.read_text(encoding="utf-8"))
        values = kept["values"]
        if not values:
            return None
        number, truth, text = int(kept["case"]["index"]), json.loads(values["truth"]), values["report"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise CaseError(
            f"{path}: is no finished case of a benchmark ({type(error).__name__}: {error}); "
            "take it away, or run the benchmark again"
        ) from error
    return number, truth, report_from(text, str(path))


def lines(cases: Sequence[Finished]) -> list[str]:
    """Return features with ``right`` of cases as `confidence.read_pairs` has them; of contacts those that stand alone."""
    written = []
    for _, truth, report in cases:
        behind = report.confidence_basis.behind() if report.confidence_basis else ()
        if len(behind) == 1:
            written.append(json.dumps(asdict(behind[0]) | {"right": shown(judge(truth, report))}))
    return written


def main(
    folder: Path,
    /,
    *,
    first: int | None = None,
    skip: int = 0,
    fit: Annotated[
        Path | None, Parameter(help="Where the features go, a line a case.", validator=options.writable_file)
    ] = None,
    picture: Annotated[
        Path | None,
        Parameter(help="Where the reliability diagram goes, as PNG.", validator=options.writable_file),
    ] = None,
) -> None:
    """Write the features of finished cases, or judge the shipped confidence on them.

    Args:
        folder: The benchmark's folder.
        first: Only so many cases of the set.
        skip: Leave out so many cases of the set.
    """
    cases = [one for one in finished(folder) if skip <= one[0] and (first is None or one[0] < first)]
    if fit is not None:
        write_whole(fit, ("\n".join(lines(cases)) + "\n").encode())
    rows = reliability([_restated(truth, report) for _, truth, report in cases])
    for row in rows:
        if row["stated"] is not None:
            right = row["right_as_shown"]
            print(
                f"confidence {row['confidence'][0]:.1f} to {row['confidence'][1]:.1f}: stated {row['stated']:.2f}, "
                f"right {right['share']:.2f} ({right['hits']} of {right['cases']})"
            )
    if picture is not None:
        draw_reliability(rows, picture)


def _restated(truth: dict[str, Any], report: Report) -> Judged:
    """Return a judged case with the confidence that the shipped calibration states."""
    judged = judge(truth, report)
    return (
        replace(judged, confidence=report.confidence_basis.confidence())
        if report.confidence_basis
        else judged
    )


if __name__ == "__main__":
    run_script(main)
