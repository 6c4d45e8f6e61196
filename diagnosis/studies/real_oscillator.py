"""A measured oscillator diagnosed: the Silverbox as it is, with its numbers rounded, and with its table gain wrong.

The case is public but not part of the project: POUNDING_CASES names the folder. Its truth is cubic stiffness. Run it
with ``pounding study real-oscillator``.
"""

from __future__ import annotations

import json as jsonlib
import os
import shutil
import tempfile
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter as Option
from matplotlib.figure import Figure
from msgspec import UNSET
from rich.progress import Progress

from pounding.diagnosis.decision.claims import Claim
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.report.report import Report
from pounding.diagnosis.workflow import diagnose
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, plain, progress_console, table
from pounding.experiments.pictures.palette import BLUE, ORANGE
from pounding.frames.files import replacing, write_whole

CASE = "real-oscillator"
OF_README = (7e9, 8e9)
"""Cubic stiffness of the oscillator [N/m^3] as the README beside the case gives it."""
GAIN = 1.2
"""Factor on the table's acceleration: the believed gain is a fifth wrong, ten standard deviations of its prior."""

Cells = list[str]
Variant = Callable[[Cells], Cells]


def _as_it_is(cells: Cells) -> Cells:
    return cells


def _microseconds(cells: Cells) -> Cells:
    return [f"{float(cells[0]):.6f}", *cells[1:]]


def _eight_decimals(cells: Cells) -> Cells:
    return [cells[0], *(f"{float(cell):.8f}" for cell in cells[1:])]


def _gain(cells: Cells) -> Cells:
    return [cells[0], f"{GAIN * float(cells[1]):.12g}", *cells[2:]]


VARIANTS: dict[str, Variant] = {
    "as it is": _as_it_is,
    "time to 1e-6 s": _microseconds,
    "8 decimals": _eight_decimals,
    "table gain x 1.2": _gain,
}
"""What is done to each row of numbers: time, table, displacement."""


def case_folder(cases: Path | None) -> Path:
    """Return the folder of the case.

    Args:
        cases: Folder with measured cases; that of POUNDING_CASES when None.

    Raises:
        CaseError: No folder is named, or the case is not in it.
    """
    named = cases or os.environ.get("POUNDING_CASES")
    if not named:
        raise CaseError(
            f"the case {CASE} is not part of the project; name the folder that holds it with --cases or POUNDING_CASES"
        )
    folder = Path(named) / CASE
    if not (folder / "case.toml").is_file():
        raise CaseError(
            f"{folder / 'case.toml'} is missing; --cases or POUNDING_CASES names the folder that holds {CASE}"
        )
    return folder


def rewrite(source: Path, target: Path, variant: Variant) -> None:
    """Copy a case with every row of numbers changed.

    Args:
        source: Folder of the case.
        target: Folder to create.
        variant: From the cells of a row to the new ones.
    """
    target.mkdir()
    shutil.copyfile(source / "case.toml", target / "case.toml")
    for file in sorted(source.glob("*.csv")):
        header, *rows = file.read_text("utf-8").splitlines()
        lines = [header, *(",".join(variant(row.split(","))) for row in rows)]
        (target / file.name).write_text("\n".join(lines) + "\n", "utf-8")


def summary(name: str, report: Report) -> dict[str, Any]:
    """Return what the study keeps of a report.

    Args:
        name: Name of the variant.
        report: What the diagnosis says of it.
    """
    held = report.misfit.held_out
    return {
        "variant": name,
        "verdict": report.verdict,
        "effects": [_effect(claim) for claim in report.effects],
        "held_out": None
        if held is None
        else {
            "before": held.before,
            "after": held.after,
            "noise_floor": held.noise_floor,
            "explained": held.share(),
        },
        "warnings": list(report.warnings),
    }


def _effect(claim: Claim) -> dict[str, Any]:
    parameters = [
        {"name": one.name, "value": one.value, "std": None if one.std is UNSET else one.std, "unit": one.unit}
        for one in claim.parameters
    ]
    return {"effect": claim.effect, "place": claim.where(), "parameters": parameters}


def main(
    *,
    cases: Annotated[Path | None, Option(help="Folder with measured cases; default: POUNDING_CASES.")] = None,
    json: options.Json = False,
    out: options.Out = None,
) -> dict[str, Any]:
    """Diagnose a measured oscillator (the Silverbox), as it is and with its numbers or its table's gain changed."""
    source = case_folder(cases)
    rows = []
    with (
        tempfile.TemporaryDirectory() as scratch,
        Progress(console=progress_console(), transient=True) as progress,
    ):
        for index, (name, variant) in enumerate(VARIANTS.items()):
            task = progress.add_task(name, total=1.0)
            folder = Path(scratch) / f"{index}"
            rewrite(source, folder, variant)

            def told(what: str, share: float, task: Any = task, name: str = name) -> None:
                progress.update(task, description=f"{name}: {what}", completed=share)

            rows.append(summary(name, diagnose(folder, progress=told)))
    result = {"case": CASE, "readme_n_per_m3": list(OF_README), "variants": rows}
    if out is not None:
        write_whole(out / "real_oscillator.json", (jsonlib.dumps(plain(result), indent=2) + "\n").encode())
        picture(rows, out / "real_oscillator.png")
    emit(result, as_json=json, show=lambda: show(result))
    return result


def show(result: dict[str, Any]) -> Iterable[Any]:
    """Return the study as a table for a reader.

    Args:
        result: What `main` returns.
    """
    low, high = result["readme_n_per_m3"]
    yield table(
        "Measured oscillator: misfit of the held-out run [%]",
        ["variant", "verdict", "before", "after", "explained"],
        [_misfits(one) for one in result["variants"]],
    )
    yield table(
        f"What is named; the README beside the case: cubic stiffness {_short(low)} to {_short(high)} N/m^3",
        ["variant", "effect", "where", "size"],
        [line for one in result["variants"] for line in _named(one)],
    )


def _misfits(one: dict[str, Any]) -> list[Any]:
    held = one["held_out"] or {}
    shares = [_percent(held.get(key)) for key in ("before", "after", "explained")]
    return [one["variant"], one["verdict"].replace("_", " "), *shares]


def _named(one: dict[str, Any]) -> list[list[Any]]:
    return [
        [
            one["variant"],
            effect["effect"].replace("_", " "),
            effect["place"],
            ", ".join(_size(size) for size in effect["parameters"]),
        ]
        for effect in one["effects"]
    ]


def _size(one: dict[str, Any]) -> str:
    value = one["value"] if isinstance(one["value"], str) else _short(one["value"])
    error = "" if one["std"] is None else f" ± {_short(one['std'], 1)}"
    return f"{value}{error} {one['unit']}"


def _short(value: float, digits: int = 3) -> str:
    return f"{value:.{digits}g}".replace("e+0", "e")


def _percent(share: float | None) -> str:
    return "–" if share is None else f"{100 * share:.1f}"


def picture(rows: Sequence[dict[str, Any]], path: Path) -> None:
    """Draw the misfit of the held-out run before and after, for each variant.

    Args:
        rows: What `summary` gives of each variant.
        path: PNG to write.
    """
    figure = Figure(figsize=(8.0, 3.0), layout="constrained")
    axes = figure.subplots()
    for shift, key, colour in ((-0.18, "before", BLUE), (0.18, "after", ORANGE)):
        shares = [100 * ((one["held_out"] or {}).get(key) or 0.0) for one in rows]
        bars = axes.barh([y + shift for y in range(len(rows))], shares, 0.34, color=colour, label=key)
        axes.bar_label(bars, fmt="%.1f", padding=3)
    axes.set_yticks(range(len(rows)), [one["variant"] for one in rows])
    axes.invert_yaxis()
    axes.margins(x=0.12)
    axes.set_xlabel("misfit of the held-out run [% of the measured rms]")
    axes.legend(frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0), title="effects in the model")
    axes.spines[["top", "right"]].set_visible(False)
    with replacing(path) as part:
        figure.savefig(part, format="png", dpi=100)


if __name__ == "__main__":
    run_script(main)
