"""The tables that `pounding pound` prints: impacts, roofs, and what they rest on."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from pounding.experiments.console.output import table
from pounding.experiments.output import result_folder as keeping
from pounding.experiments.rig.ductility import ductility_sentence
from pounding.experiments.rig.impacts import SAMPLE_RATE_HZ, THRESHOLD_N
from pounding.experiments.rig.states import FrameState
from pounding.experiments.rig.table_scale import TableScale
from pounding.experiments.rig.turning import turning_sentence
from pounding.units import force_unit

HEADS = ("time s", "floor", "peak {unit}", "{unit} s", "approach m/s", "touches, max ms", "restitution")
"""Of the table of impacts; duration and restitution are those of single touches."""


def tables(result: dict[str, Any], states: Iterable[FrameState], scale: TableScale) -> Iterable[Any]:
    """Return what a person reads of runs with contacts: tables and sentences.

    Args:
        result: What `pounding pound --json` prints.
        states: The frames' states.
        scale: Their scale.
    """
    for run in result["runs"]:
        yield from _impacts(run)
        for side, name in zip(run["peaks"], run["buildings"], strict=True):
            yield from ductility_sentence(name, run["ductility"][side])
            yield from turning_sentence(name, run["peaks"][side])
        yield (
            f"energy closes to {100 * run['energy_error']:.2g} %; "
            f"{run['model_s']:.1f} simulated s in {run['wall_s']:.2f} s"
        )
    unit = _unit(impact for run in result["runs"] for impact in run["impacts"])
    heads = ["frame", "roof + mm", "roof - mm", "drift %", "accel. g", f"peak {unit}", "impacts"]
    several = len(result["runs"]) > 1
    yield table(
        "Largest displacement of the roof, drift of a storey, acceleration of a floor, force",
        ["law", *heads] if several else heads,
        [[run["law"], *row] if several else row for run in result["runs"] for row in _peak_rows(run, unit)],
    )
    for run in result["runs"]:
        yield from _columns(run)
    yield (
        f"Impacts as a force sensor sees them: {SAMPLE_RATE_HZ:,.0f} samples a second, {THRESHOLD_N:g} N, "
        f"touches less than {1e3 * result['parameters']['impact_merging_s']:.3g} ms apart are one."
    )
    yield from dict.fromkeys(map(str, states))  # one building may stand twice
    yield str(scale)
    yield from _together(result["parameters"]["contact_basis"])
    yield from keeping.written(result)


def _impacts(run: dict[str, Any]) -> Iterable[Any]:
    title = f"{' beside '.join(run['buildings'])}, {run['record']}, {run['law']}"
    if isinstance(run["gap_mm"], float):
        title += f", gap {run['gap_mm']:g} mm"
    if not run["impacts"]:
        yield f"{title}: the floors did not touch."
        return
    # Of a pair everybody knows who touched.
    between = [] if len(run["buildings"]) == 2 else [[_between(impact)] for impact in run["impacts"]]
    unit = _unit(run["impacts"])
    heads = [head.format(unit=unit) for head in HEADS]
    rows = [_row(impact, unit) for impact in run["impacts"]]
    if between:
        yield table(
            title, ["between", *heads], [[*who, *row] for who, row in zip(between, rows, strict=True)]
        )
    else:
        yield table(title, heads, rows)
    yield from _merged(run["impacts"])


def _columns(run: dict[str, Any]) -> Iterable[Any]:
    if "columns" in run:
        yield table(
            "What one column that is hit bears at most, by blow and drift together; what the largest drift of its storey in "
            "this run makes alone; what it can bear",
            [
                "building",
                "floors",
                "height m",
                "shear kN",
                "by drift",
                "can bear",
                "moment kN m",
                "by drift",
                "can bear",
            ],
            [
                [
                    one["building"],
                    "{} to {}".format(*one["between_floors"]),
                    f"{one['height_m']:.3g}",
                    f"{one['shear_kn']:.4g}",
                    f"{one['shear_of_drift_kn']:.4g}",
                    _known(one["shear_capacity_kn"]),
                    f"{one['moment_kn_m']:.4g}",
                    f"{one['moment_of_drift_kn_m']:.4g}",
                    _known(one["moment_capacity_kn_m"]),
                ]
                for one in run["columns"]
            ],
        )


def _known(capacity: float | None) -> str:
    return "–" if capacity is None else f"{capacity:.4g}"


def _between(impact: dict[str, Any]) -> str:
    return f"{impact['left']} and {impact['right']}"


def _together(bases: Iterable[str]) -> Iterable[str]:
    """Return what laws rest on, those that rest on the same in one sentence."""
    laws: dict[str, list[str]] = {}
    for sentence in bases:
        name, _, basis = sentence.partition(": ")
        laws.setdefault(basis, []).append(name)
    return [f"{', '.join(dict.fromkeys(names))}: {basis}" for basis, names in laws.items()]


def _unit(impacts: Iterable[dict[str, Any]]) -> str:
    return force_unit(max((one["peak_force_n"] for one in impacts), default=0.0))[0]


def _force(value_n: float, unit: str, digits: int = 0) -> str:
    """Return a force, or an impulse, with so many digits of N; kN of buildings have none."""
    return f"{value_n / 1e3:.0f}" if unit == "kN" else f"{value_n:.{digits}f}"


def _row(impact: dict[str, Any], unit: str) -> list[str]:
    return [
        f"{impact['time_s']:.4f}",
        f"{impact['floor']:g}" + (f" at y = {impact['y_m']:g} m" if impact["y_m"] else ""),
        _force(impact["peak_force_n"], unit),
        _force(impact["impulse_n_s"], unit, 3),
        f"{impact['approach_velocity_m_s']:.3f}",
        f"{impact['touches']}, {impact['longest_touch_ms']:.2f}",
        " ".join(map(_ratio, impact["touch_restitutions"])),
    ]


def _merged(impacts: Iterable[dict[str, Any]]) -> Iterable[str]:
    """Say of each impact of several touches what it is as a whole, which is no property of the contact."""
    for impact in impacts:
        if impact["touches"] > 1:
            yield (
                f"The impact at {impact['time_s']:.4f} s is merged from {impact['touches']} touches; from the first "
                f"touch to the last parting: {impact['duration_ms']:.2f} ms, restitution "
                f"{_ratio(impact['restitution'])}."
            )


def _ratio(restitution: float | None) -> str:
    return "–" if restitution is None else f"{restitution:.2f}"


def _peak_rows(run: dict[str, Any], unit: str) -> Iterable[list[str]]:
    """Return one row a frame, with the impacts that it took part in."""
    for side, name in zip(run["peaks"], run["buildings"], strict=True):
        peaks = run["peaks"][side]
        roof = peaks[-1]
        own = [
            impact["peak_force_n"] for impact in run["impacts"] if name in (impact["left"], impact["right"])
        ]
        yield [
            name,
            f"{roof['max_mm']:.1f}",
            f"{roof['min_mm']:.1f}",
            f"{max(peak['drift_percent'] for peak in peaks):.2f}",
            f"{max(peak['max_acceleration_g'] for peak in peaks):.2f}",
            _force(max(own, default=0.0), unit),
            f"{len(own)}",
        ]
