"""Fitting the confidence to finished cases of a benchmark.

Run ``python -m pounding.diagnosis.benchmark.fitting PAIRS.jsonl NOTE``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from pounding.diagnosis.decision.confidence import FILE, read_pairs, refitted, write_calibration
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script


def main(
    pairs: Path,
    source: str,
    /,
    *,
    verdict: Annotated[tuple[str, ...], Parameter(help="Fit this kind of verdict only; repeatable.")] = (),
    out: Annotated[
        Path,
        Parameter(
            help="Where it goes; by default it replaces what the package ships.",
            validator=options.writable_file,
        ),
    ] = FILE,
) -> None:
    """Fit the confidence to finished cases.

    Args:
        pairs: Features with `right`, as `pounding.diagnosis.benchmark.reliability --fit` writes them.
        source: Where the coefficients of all verdicts come from, for the reader of a report.
    """
    write_calibration(refitted(read_pairs(pairs), source, verdict), out)


if __name__ == "__main__":
    run_script(main)
