"""`pounding shake`: one frame on the shaking table."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter
from rich.progress import Progress

from pounding import frames
from pounding.experiments.console import estimates, options
from pounding.experiments.console.output import emit, plain, progress_console, table, warn
from pounding.experiments.measurements import history as measured
from pounding.experiments.output import result_folder as keeping
from pounding.experiments.pictures import films, plots
from pounding.experiments.records import Record, find
from pounding.experiments.results import dataset as results
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.ductility import ductility_sentence
from pounding.experiments.rig.shaking import Shaking
from pounding.experiments.rig.shaking import shake as run
from pounding.experiments.rig.states import FrameState, states_of
from pounding.experiments.rig.table_scale import TableScale, table_scale

COLUMNS_HELP = (
    "CSV of your own measured histories to plot over the run: header, first column time_s, one column per "
    "channel. A [[channel]] of a case.toml beside it (name, quantity, frame, floor, unit) describes a column; "
    "otherwise its name must, like 15B_relative_displacement_floor10_mm or table_acceleration_g (units g, "
    "m_s2, cm_s2, m, cm, mm, m_s, cm_s, mm_s). With a channel of the table's acceleration the clocks are "
    "matched by correlation."
)


def shake(
    frame: str,
    *,
    record: Annotated[str, Parameter(help="Ground motion by name (see `pounding list`) or file.")],
    pga: options.Pga = None,
    state: options.State = None,
    time_factor: options.TimeFactor = None,
    joints: options.Joints = "calibrated",
    p_delta: options.PDelta = True,
    damping: options.Damping = None,
    records: options.Records = None,
    measured_file: Annotated[Path | None, Parameter(name="--measured", help=COLUMNS_HELP)] = None,
    out: options.Out = None,
    film: Annotated[bool, Parameter(negative=(), help="Write a film of the run to --out.")] = False,
    csv: Annotated[bool, Parameter(negative=(), help="Also write the histories as CSV to --out.")] = False,
    json: options.Json = False,
) -> None:
    """Shake a frame alone on the table and report its peaks, its stress and warnings.

    The record's time is multiplied by the factor of the frame's scale, which its file states: 1 for a building,
    sqrt(1/30) for the frames of the thesis.

    Args:
        frame: Name of a shipped frame (see `pounding list`) or path of a frame file.
    """
    if out is None and (film or csv):
        warn("--film and --csv need a folder: nothing is written without --out")
    elif film:
        films.require()
    channels = measured.read(measured_file) if measured_file else []
    definition = frames.load(frame)
    scale = table_scale([definition], time_factor)
    motion = find(record, records).scaled(scale.time_factor, pga)
    (chosen,) = states_of([frame], state, motion.name, joints=joints, damping=damping)
    estimates.announce(estimates.of_frame(definition))
    reduced = frames.build(
        definition,
        joints=joints,
        p_delta=p_delta,
        damping=chosen.damping_ratio,
        calibration=chosen.calibration,
    )
    estimates.announce(estimates.of_run([reduced], motion.duration_s))
    if out is not None:
        keeping.prepare(out)
    done = _run(reduced, motion)
    asked = {
        "frame": frame,
        "record": record,
        "pga_g": pga,
        "damping_ratio": damping,
        "states": [chosen.as_dict()],
        "model": reduced.options,
    }
    result = stamp(asked | scale.as_dict(), [motion]) | done.result()
    data = results.dataset(done.motion, motion, provenance=result)
    channels, shift = measured.aligned(channels, data.time.values, data.table_acceleration.values)
    if channels:
        result["measured"] = compare(done, data, channels)
        result["measured_shift_s"] = shift
    if out is not None:
        kept = _keep(done, data, result, out, keeping.Wish(csv, film, channels))
        result |= {"files": kept.files, "film": kept.film and asdict(kept.film)}
        for note in kept.notes:
            warn(note)
    for warning in result["warnings"]:
        warn(warning)
    emit(result, as_json=json, show=lambda: _show(result, done, chosen, scale))


def compare(done: Shaking, data: Any, channels: list[measured.Channel]) -> list[dict[str, Any]]:
    """Return the comparison of the run with each measured channel for which the run has a history.

    A warning names a channel without a history in the run (of another frame, of a contact).

    Args:
        done: The run.
        data: Its histories as a dataset.
        channels: Measured channels on the run's clock.
    """
    compared = []
    for channel in channels:
        values = plots.simulated(data, channel, done.reduced.name)
        if values is None:
            warn(f"column {channel.name}: this run has no {channel.quantity} of {channel.frame}, not shown")
        else:
            compared.append(measured.misfit(channel, data.time.values, values))
    return compared


def _run(reduced: frames.ReducedFrame, record: Record) -> Shaking:
    with Progress(console=progress_console(), transient=True) as progress:
        bar = progress.add_task(f"shaking {reduced.name}", total=record.duration_s)
        return run(reduced, record, progress=lambda time_s: progress.update(bar, completed=time_s))


def _keep(done: Shaking, data: Any, result: dict[str, Any], out: Path, wish: keeping.Wish) -> keeping.Kept:
    with Progress(console=progress_console(), transient=True) as progress:
        bar = progress.add_task("writing", total=1.0)
        return keeping.keep(
            done,
            data,
            plain(result),
            out,
            wish=wish,
            progress=lambda what, share: progress.update(bar, description=what, completed=share),
        )


def _show(result: dict[str, Any], done: Shaking, state: FrameState, scale: TableScale) -> Iterable[Any]:
    published = keeping.published_peaks(result["frame"], result["record"]) if scale.is_laboratory else {}
    shaken = f"Frame {result['frame']}, {result['record']}, {result['pga_g']:.3f} g"
    yield table(
        f"{shaken}: displacement relative to the table",
        ["floor", "max mm", "min mm", "max acceleration g", "Table 4.1 max mm", "min mm"],
        [_row(peak, published.get(peak["floor"])) for peak in reversed(result["peaks"])],
    )
    yield str(state)
    yield str(scale)
    if published and result["parameters"]["pga_g"] is not None:
        yield "Table 4.1 was measured at the record's own peak, not at the one asked for here."
    if done.stress is not None:
        yield f"largest von Mises stress {result['max_stress_mpa']:.0f} MPa, {done.stress.place}"
    yield from ductility_sentence(result["frame"], result["ductility"])
    for row in result.get("measured", []):
        error = row["rms_error_ratio"]
        yield (
            f"{row['channel']}: rms of computed - measured is {error:.3f} of rms of measured"
            if error
            else row
        )
    yield f"{result['model_s']:.2f} simulated s in {result['wall_s']:.2f} s"
    yield from keeping.written(result)


def _row(peak: dict[str, Any], published: tuple[float, float] | None) -> list[Any]:
    printed = [None, None] if published is None else [f"{value:g}" for value in published]
    return [
        f"{peak['floor']}",
        f"{peak['max_mm']:.2f}",
        f"{peak['min_mm']:.2f}",
        f"{peak['max_acceleration_g']:.2f}",
        *printed,
    ]
