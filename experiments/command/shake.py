"""`pounding shake`: one frame on the shaking table."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter
from rich.progress import Progress

from pounding import frames
from pounding.experiments.console import estimates, options
from pounding.experiments.console.output import emit, plain, progress_console, table, warn
from pounding.experiments.errors import ExperimentError
from pounding.experiments.measurements import history as measured
from pounding.experiments.output import result_folder as keeping
from pounding.experiments.pictures import films, plots
from pounding.experiments.records import Record, find
from pounding.experiments.results import dataset as results
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.ductility import ductility_sentence
from pounding.experiments.rig.pounding import built_in
from pounding.experiments.rig.shaking import Shaking
from pounding.experiments.rig.shaking import shake as run
from pounding.experiments.rig.states import FrameState, states_of
from pounding.experiments.rig.street import named
from pounding.experiments.rig.street_file import Building, Street, is_street_file, load_street
from pounding.experiments.rig.table_scale import TableScale, table_scale
from pounding.experiments.rig.turning import turning_sentence

COLUMNS_HELP = (
    "CSV of your own measured histories to plot over the run: header, first column time_s, one column per "
    "channel. A [[channel]] of a case.toml beside it (name, quantity, frame, floor, unit) describes a column; "
    "otherwise its name must, like 15B_relative_displacement_floor10_mm or table_acceleration_g (units g, "
    "m_s2, cm_s2, m, cm, mm, m_s, cm_s, mm_s). With a channel of the table's acceleration the clocks are "
    "matched by correlation."
)


def shake(
    frame: options.FrameName,
    *,
    record: Annotated[
        options.RecordName, Parameter(help="Ground motion by name (see `pounding list`) or file.")
    ],
    pga: options.Pga = None,
    state: options.State = None,
    time_factor: options.TimeFactor = None,
    joints: options.Joints = "calibrated",
    p_delta: options.PDelta = True,
    damping: options.Damping = None,
    records: options.Records = None,
    record_unit: options.RecordUnit = None,
    measured_file: Annotated[Path | None, Parameter(name="--measured", help=COLUMNS_HELP)] = None,
    out: options.Out = None,
    film: Annotated[bool, Parameter(negative=(), help="Write a film of the run to --out.")] = False,
    csv: Annotated[bool, Parameter(negative=(), help="Also write the histories as CSV to --out.")] = False,
    json: options.Json = False,
) -> None:
    """Shake a frame alone on the table and report its peaks, its stress and warnings.

    The record's time is multiplied by the factor of the frame's scale, which its file states: 1 for a building,
    sqrt(1/30) for the frames of the thesis. Of a street each building is shaken, as if it stood alone.

    Args:
        frame: Name of a shipped frame (see `pounding list`), or path of a frame file or of a street file.
    """
    if out is None and (film or csv):
        warn("--film and --csv need a folder: nothing is written without --out")
    elif film:
        films.require()
    channels = measured.read(measured_file) if measured_file else []
    street = _street(frame, measured_file)
    definitions = [frames.load(one.frame) for one in street.building]
    scale = table_scale(definitions, time_factor)
    motion = find(record, records, unit=record_unit).scaled(scale.time_factor, pga)
    states = [
        states_of([one.frame], state, motion.name, joints=joints, damping=damping)[0]
        for one in street.building
    ]
    estimates.announce(*map(estimates.of_frame, definitions))
    row = named(street, [built_in(one, joints, p_delta) for one in states])
    estimates.announce(*(estimates.of_run([reduced], motion.duration_s) for reduced in row))
    alone = not street.gap
    folders = [None if out is None else out if alone else out / reduced.name for reduced in row]
    for folder in folders:
        if folder is not None:
            keeping.prepare(folder)
    asked = {"frame" if alone else "street": frame, "record": record, "record_unit": record_unit}
    asked_values = {"pga_g": pga, "damping_ratio": damping}
    answers = []
    for reduced, chosen, folder in zip(row, states, folders, strict=True):
        of_frame = {"states": [chosen.as_dict()], "model": reduced.options}
        provenance = stamp(asked | asked_values | of_frame | scale.as_dict(), [motion])
        answers.append(_answer(reduced, motion, provenance, folder, keeping.Wish(csv, film, channels)))
    each = [result for result, _ in answers]
    result = each[0] if alone else _of_street(each)
    emit(
        result,
        as_json=json,
        show=lambda: [
            line
            for (one, done), chosen in zip(answers, states, strict=True)
            for line in _show(one, done, chosen, scale)
        ],
    )


def _street(frame: str, measured_file: Path | None) -> Street:
    """Return the street of a file, or one frame as a street without neighbours."""
    if not is_street_file(frame):
        return Street((Building(frame),), ())
    if measured_file is not None:
        raise ExperimentError(
            f"{frame} is a street, and --measured compares one frame; name one of its frames"
        )
    return load_street(frame)


def _of_street(each: list[dict[str, Any]]) -> dict[str, Any]:
    """Return one result of several buildings: what they share once, and each building's own under its name."""
    first = each[0]
    shared = {key: first[key] for key in ("schema", "software", "version", "records") if key in first}
    return shared | {
        "buildings": {
            one["frame"]: {key: value for key, value in one.items() if key not in shared} for one in each
        }
    }


def _answer(
    reduced: frames.ReducedFrame,
    motion: Record,
    provenance: dict[str, Any],
    folder: Path | None,
    wish: keeping.Wish,
) -> tuple[dict[str, Any], Shaking]:
    """Return the result of one frame's shaking, kept in a folder if there is one, and the run."""
    done = _run(reduced, motion)
    result = provenance | done.result()
    data = results.dataset(done.motion, motion, provenance=result)
    channels, shift = measured.aligned(list(wish.measured), data.time.values, data.table_acceleration.values)
    if channels:
        result["measured"] = compare(done, data, channels)
        result["measured_shift_s"] = shift
    if folder is not None:
        kept = _keep(done, data, result, folder, dataclasses.replace(wish, measured=channels))
        result |= {"files": kept.files, "film": kept.film and dataclasses.asdict(kept.film)}
        for note in kept.notes:
            warn(note)
    for warning in result["warnings"]:
        warn(warning)
    return result, done


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
    last = ["Table 4.1 max mm", "min mm"] if published else ["drift of the storey mm", "% of its height"]
    yield table(
        f"{shaken}: displacement relative to the table",
        ["floor", "max mm", "min mm", "max acceleration g", *last],
        [
            _row(peak, published.get(peak["floor"]) if published else _drift(peak))
            for peak in reversed(result["peaks"])
        ],
    )
    yield str(state)
    yield str(scale)
    if published and result["parameters"]["pga_g"] is not None:
        yield "Table 4.1 was measured at the record's own peak, not at the one asked for here."
    if done.stress is not None:
        yield f"largest von Mises stress {result['max_stress_mpa']:.0f} MPa, {done.stress.place}"
    yield from ductility_sentence(result["frame"], result["ductility"])
    yield from turning_sentence(result["frame"], result["peaks"])
    for row in result.get("measured", []):
        error = row["rms_error_ratio"]
        yield (
            f"{row['channel']}: rms of computed - measured is {error:.3f} of rms of measured"
            if error
            else row
        )
    yield f"{result['model_s']:.2f} simulated s in {result['wall_s']:.2f} s"
    yield from keeping.written(result)


def _drift(peak: dict[str, Any]) -> tuple[str, str]:
    return f"{peak['drift_mm']:.2f}", f"{peak['drift_percent']:.2f}"


def _row(peak: dict[str, Any], last: Sequence[float | str] | None) -> list[Any]:
    printed = [None, None] if last is None else [f"{value}" for value in last]
    return [
        f"{peak['floor']}",
        f"{peak['max_mm']:.2f}",
        f"{peak['min_mm']:.2f}",
        f"{peak['max_acceleration_g']:.2f}",
        *printed,
    ]
