"""Table 3.1 of the thesis: frequencies and roof stiffness of the five frames, measured, SAP2000's and ours.

The ladder has three rungs: rigid joints; joints with a rotational stiffness; the same with the P-Delta effect
of gravity. On the upper two rungs one number a frame, the joints' stiffness, is fitted to the first frequency
alone, once to that of the free vibration and once to that of the sine sweep. The second and third frequency
and the roof stiffness were not fitted: they are the judge. Run it with ``pounding study table-3-1``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import Annotated, Any, Literal

import msgspec
import numpy as np
import pandas as pd
from cyclopts import Parameter
from rich.progress import Progress

from pounding import frames
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, progress_console, table
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.states import LABORATORY, first_frequency
from pounding.frames.calibration import joint_stiffness, with_joint_stiffness
from pounding.frames.definition import PlateFrame
from pounding.frames.files import write_whole

FRAMES = ("5A", "5B", "10", "15A", "15B")
CALIBRATIONS = ("free_vibration", "sweep")
BASE_PLATE_KG = 6.28
"""Weight of a base plate like a floor, 0.4 m x 0.4 m x 5 mm of steel [kg]."""

RUNGS: dict[str, tuple[Literal["calibrated", "rigid"], bool]] = {
    "rigid": ("rigid", False),
    "joints": ("calibrated", False),
    "P-Delta": ("calibrated", True),
}
"""Joints and P-Delta of each rung."""

Alternative = Callable[[PlateFrame], PlateFrame]
Step = Callable[[], None]

ALTERNATIVES: dict[str, Alternative] = {
    "baseline": lambda frame: frame,
    "mass as stated": lambda frame: _weighing(frame, 0.0),
    "mass as stated less a base plate": lambda frame: _weighing(frame, BASE_PLATE_KG),
    "columns cut at floors": lambda frame: _columns(frame, continuous=False),
    "columns 40 mm inwards along y": lambda frame: _columns(frame, inset_y_m=0.04),
}
"""What else could have been assumed; each is calibrated on the first frequency like the baseline model."""


def thesis_frame(name: str) -> PlateFrame:
    """Return a plate frame of the thesis."""
    frame = frames.load(name)
    assert isinstance(frame, PlateFrame)
    return frame


def target_hz(frame: PlateFrame, calibration: str) -> float:
    """Return the first frequency that a calibration is fitted to [Hz]."""
    published = frame.published
    first = {
        "free_vibration": published.free_vibration_hz,
        "sweep": published.sweep_hz[0] if published.sweep_hz else None,
        "unequal_pair": first_frequency(frame.name, "unequal pair") if frame.name in LABORATORY else None,
        "numerical": published.numerical_hz[0] if published.numerical_hz else None,
    }[calibration]
    if first is None:
        raise frames.FrameError(f"frame {frame.name}: nothing published to calibrate {calibration} on")
    return first


def calibrated(frame: PlateFrame, calibration: str, *, p_delta: bool = True) -> PlateFrame:
    """Return a frame with its joints fitted anew to one first frequency.

    Args:
        frame: The frame.
        calibration: `free_vibration`, `sweep`, `unequal_pair` or `numerical`.
        p_delta: Geometric stiffness of gravity.
    """
    stiffness = joint_stiffness(frame, target_hz(frame, calibration), p_delta=p_delta)
    return with_joint_stiffness(frame, stiffness, calibration)


def row(frame: PlateFrame, rung: str, calibration: str | None) -> dict[str, Any]:
    """Return what a model says of a frame: joint stiffness, three frequencies, roof stiffness.

    Args:
        frame: The frame.
        rung: A key of `RUNGS`.
        calibration: Name of the joints' calibration; None for rigid joints.
    """
    joints, p_delta = RUNGS[rung]
    reduced = frames.build(frame, joints=joints, p_delta=p_delta, calibration=calibration)
    return {
        "frame": frame.name,
        "model": rung,
        "calibration": calibration or "",
        "joint_stiffness_n_m_per_rad": frame.joint_stiffness(calibration) if calibration else None,
        **_numbers(reduced.frequencies_hz[:3], reduced.roof_stiffness_n_per_m / 1e3),
    }


def published_rows(frame: PlateFrame) -> list[dict[str, Any]]:
    """Return the measured and SAP2000's row of a frame; the measured frequencies are the sweep's."""
    known, label = frame.published, {"frame": frame.name, "calibration": ""}
    assert known.roof_stiffness_n_per_mm is not None
    assert known.numerical_roof_stiffness_n_per_mm is not None
    return [
        label | {"model": "measured"} | _numbers(known.sweep_hz, known.roof_stiffness_n_per_mm),
        label | {"model": "SAP2000"} | _numbers(known.numerical_hz, known.numerical_roof_stiffness_n_per_mm),
    ]


def ladder(*, step: Step = lambda: None) -> pd.DataFrame:
    """Return the ladder of all frames beside experiment and SAP2000, with relative errors.

    The top rung has the joints of the frame files; the rung without P-Delta is fitted to the same first
    frequency, so that both rungs are judged alike. ``step`` is called after each fit.
    """
    rows = []
    for name in FRAMES:
        frame = thesis_frame(name)
        rows += published_rows(frame) + [row(frame, "rigid", None)]
        for calibration in CALIBRATIONS:
            rows.append(row(calibrated(frame, calibration, p_delta=False), "joints", calibration))
            step()
            rows.append(row(frame, "P-Delta", calibration))
    return with_errors(pd.DataFrame(rows))


def alternatives(*, step: Step = lambda: None) -> pd.DataFrame:
    """Return the top rung of all frames under each of `ALTERNATIVES`, fitted anew, with relative errors."""
    rows = []
    for label, change in ALTERNATIVES.items():
        for name in FRAMES:
            frame = thesis_frame(name)
            rows += [entry | {"model": label} for entry in published_rows(frame)[:1]]
            for calibration in CALIBRATIONS:
                fitted = calibrated(change(frame), calibration)
                rows.append(row(fitted, "P-Delta", calibration) | {"model": label})
                step()
    data = pd.DataFrame(rows)
    data.loc[data.calibration == "", "model"] = "measured"
    return with_errors(data.drop_duplicates(["frame", "model", "calibration"]))


def with_errors(data: pd.DataFrame) -> pd.DataFrame:
    """Return the rows with each quantity's relative error against the measured row of its frame."""
    measured = data[data.model == "measured"].set_index("frame")
    for quantity in ("f1_hz", "f2_hz", "f3_hz", "roof_stiffness_n_per_mm"):
        truth = measured[quantity].loc[data.frame].to_numpy()
        data[f"error_{quantity.split('_')[0]}"] = data[quantity].to_numpy() / truth - 1.0
    return data


def scores(data: pd.DataFrame) -> pd.DataFrame:
    """Return for each model the mean size of the ten errors of f2 and f3, and the roof's mean and worst."""
    rows = []
    for (model, calibration), group in data[data.model != "measured"].groupby(
        ["model", "calibration"], sort=False
    ):
        higher, roof = group[["error_f2", "error_f3"]].to_numpy(float), group["error_roof"].to_numpy(float)
        rows.append(
            {
                "model": model,
                "calibration": calibration,
                "mean_error_f2_f3": float(np.abs(higher).mean()),
                "mean_error_f1": float(np.abs(group["error_f1"].to_numpy(float)).mean()),
                "mean_error_roof": float(np.abs(roof).mean()),
                "worst_error_roof": float(np.abs(roof).max()),
                "bias_roof": float(roof.mean()),
            }
        )
    return pd.DataFrame(rows)


def fits(*, step: Step = lambda: None) -> pd.DataFrame:
    """Return the joint stiffness of every shipped plate frame and calibration, fitted anew [N m/rad]."""
    rows = []
    for name in frames.names():
        frame = thesis_frame(name)
        for calibration, shipped in frame.joints.stiffness_n_m_per_rad.items():
            found = calibrated(frame, calibration).joint_stiffness()
            first = target_hz(frame, calibration)
            rows.append(
                {
                    "frame": name,
                    "calibration": calibration,
                    "first_hz": first,
                    "fitted_n_m_per_rad": found,
                    "frame_file_n_m_per_rad": shipped,
                }
            )
            step()
    return pd.DataFrame(rows)


def main(
    *,
    calibrate: Annotated[
        bool, Parameter(help="Fit the joints of all frame files anew.", negative=())
    ] = False,
    others: Annotated[
        bool, Parameter(name="--alternatives", help="Other masses and joints as well.", negative=())
    ] = False,
    json: options.Json = False,
    out: options.Out = None,
) -> dict[str, Any]:
    """Compare frequencies and roof stiffness of the five frames with Table 3.1, rung by rung."""
    count = 10 + 15 * calibrate + 10 * len(ALTERNATIVES) * others
    with Progress(console=progress_console(), transient=True) as progress:
        task = progress.add_task("fitting joints", total=count)
        step = partial(progress.advance, task)
        data = ladder(step=step)
        refitted = fits(step=step) if calibrate else None
        more = alternatives(step=step) if others else None
    result = stamp({"calibrate": calibrate, "alternatives": others}) | {"ladder": _records(data)}
    result["scores"] = _records(scores(data))
    if refitted is not None:
        result["fits"] = _records(refitted)
    if more is not None:
        result |= {"alternatives": _records(more), "alternative_scores": _records(scores(more))}
    if out is not None:
        write_whole(out / "table_3_1.csv", data.to_csv(index=False).encode())
    emit(result, as_json=json, show=lambda: show(result))
    return result


def show(result: dict[str, Any]) -> Iterable[Any]:
    """Return the tables of a result of `main` for a reader."""
    heads = ["model", "joint", "f1 Hz", "f2 Hz", "f3 Hz", "roof", "error f2 f3 roof %"]
    for name in FRAMES:
        entries = [entry for entry in result["ladder"] if entry["frame"] == name]
        yield table(f"{name}: joint [N m/rad], roof [N/mm]", heads, map(_cells, entries))
    yield "free, sweep: the first frequency that the joints were fitted to"
    yield _score_table("Errors against the experiment [%]", result["scores"])
    if "alternative_scores" in result:
        yield _score_table("Other assumptions, fitted alike [%]", result["alternative_scores"])
    if "fits" in result:
        heads = ["frame", "fitted to", "f1 Hz", "joint [N m/rad]", "frame file"]
        rows = [[f"{v:g}" if isinstance(v, float) else v for v in fit.values()] for fit in result["fits"]]
        yield table("Joints fitted anew", heads, rows)


def _numbers(frequencies: Iterable[float], roof: float) -> dict[str, float]:
    first, second, third = (float(f) for f in frequencies)
    return {"f1_hz": first, "f2_hz": second, "f3_hz": third, "roof_stiffness_n_per_mm": float(roof)}


def _weighing(frame: PlateFrame, less_kg: float) -> PlateFrame:
    assert frame.published.mass_kg is not None
    extra = frame.published.mass_kg - less_kg - frame.moving_mass_kg
    return frames.changed(frame, nonstructural_mass_kg=extra)


def _columns(frame: PlateFrame, **fields: Any) -> PlateFrame:
    return frames.changed(frame, columns=msgspec.structs.replace(frame.columns, **fields))


def _records(data: pd.DataFrame) -> list[dict[str, Any]]:
    return [
        {str(key): None if value == "" or pd.isna(value) else value for key, value in entry.items()}
        for entry in data.to_dict("records")
    ]


def _label(entry: dict[str, Any]) -> str:
    short = {None: "", "free_vibration": ", free", "sweep": ", sweep"}
    return f"{entry['model']}{short[entry['calibration']]}"


def _score_table(title: str, rows: list[dict[str, Any]]) -> Any:
    keys = ["mean_error_f2_f3", "mean_error_f1", "mean_error_roof", "worst_error_roof", "bias_roof"]
    heads = ["model", "f2 f3 mean", "f1 mean", "roof mean", "roof worst", "roof bias"]
    return table(title, heads, [[_label(row), *(f"{100.0 * row[key]:.2f}" for key in keys)] for row in rows])


def _cells(entry: dict[str, Any]) -> list[Any]:
    stiffness = entry["joint_stiffness_n_m_per_rad"]
    numbers = [entry[key] for key in ("f1_hz", "f2_hz", "f3_hz", "roof_stiffness_n_per_mm")]
    errors = " ".join(f"{100.0 * entry[f'error_{key}']:+.1f}" for key in ("f2", "f3", "roof"))
    return [
        _label(entry),
        "" if stiffness is None else f"{stiffness:.0f}",
        *(f"{number:.2f}" for number in numbers),
        "" if entry["model"] == "measured" else errors,
    ]


if __name__ == "__main__":
    run_script(main)
