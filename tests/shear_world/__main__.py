"""Hide effects in shear buildings, diagnose them, and print a table (`make shear-world`; a quarter of an hour or more).

Not part of the tests. The buildings, laws, motions, integration and files are those of this folder and of SciPy; of
the project only the diagnosis itself is used, once a case has been written. docs/diagnosis/hidden-cases.md has what it
found.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from pathlib import Path

from pounding.diagnosis.report.report import Report
from pounding.diagnosis.workflow import diagnose
from tests.shear_world.cases import CASES, Hidden
from tests.shear_world.making import make

HEAD = ("case", "hidden", "verdict", "found", "misfit: before, after (noise) [%]", "CPU [s]")


def main() -> None:
    """Make and diagnose the cases that are named, all without a name."""
    asked = _arguments()
    if unknown := [name for name in asked.names if name not in CASES]:
        sys.exit(f"shear_world: no case {unknown[0]!r}; there are {', '.join(CASES)}")
    print(_row(HEAD), _row(["---"] * len(HEAD)), sep="\n", flush=True)
    for name in asked.names or CASES:
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch) if asked.out is None else asked.out / name
            folder.mkdir(parents=True, exist_ok=True)
            hidden = make(folder, name, CASES[name], asked.seed)
            begun = _cpu_s()
            report = diagnose(folder)
            spent = _cpu_s() - begun
        verdict = report.verdict.replace("_", " ")
        print(
            _row([name, told(hidden), verdict, found(report, hidden), misfit(report), f"{spent:.0f}"]),
            flush=True,
        )


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.shear_world", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"cases: {', '.join(CASES)}")
    parser.add_argument("--seed", type=int, default=1, help="which frames, motions and noise are drawn")
    parser.add_argument("--out", type=Path, help="folder for the cases, which are thrown away without it")
    return parser.parse_args()


def _cpu_s() -> float:
    """Return the CPU time [s] of this process and of those that it has waited for."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def _row(cells: tuple[str, ...] | list[str]) -> str:
    return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"


def told(hidden: Hidden) -> str:
    """Return what was hidden, in words."""
    if not hidden.effect:
        return "nothing"
    where = f":{hidden.place}" if hidden.place else ""
    values = [f"{name} {_range(value)}" for name, value in hidden.truth.items()]
    return f"`{hidden.effect}{where}` {', '.join([*values, hidden.words] if hidden.words else values)}"


def found(report: Report, hidden: Hidden) -> str:
    """Return the effects of a report with their sizes, beside the truth where it is the effect that was hidden."""
    said = []
    for claim in report.effects:
        where = next((f":{place}" for place in (claim.storey, claim.floor, claim.channel) if place), "")
        true = hidden.truth if claim.effect == hidden.effect else {}
        sizes = [
            one.words() + (f" (truth {_range(true[one.name])})" if one.name in true else "")
            for one in claim.parameters
        ]
        alike = f", one of {len(claim.members)} alike" if len(claim.members) > 1 else ""
        said.append(f"`{claim.effect}{where}` {', '.join(sizes)}{alike}")
    return "; ".join(said) or "-"


def misfit(report: Report) -> str:
    """Return the misfit of the held-out run before and after, and what noise would leave [%]."""
    judged = report.misfit.judged
    if judged is None:
        return "-"
    before, after, noise = (
        "?" if share is None else f"{100 * share:.3g}"
        for share in (judged.before, judged.after, judged.noise_floor)
    )
    return f"{before}, {after} ({noise})"


def _range(values: tuple[float, ...]) -> str:
    return " to ".join(f"{value:.3g}" for value in values)


if __name__ == "__main__":
    main()
