"""`pounding gap`: the clearance that two frames need under a record."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter
from rich.console import RenderableType

from pounding import frames
from pounding.experiments.console import estimates, options
from pounding.experiments.console.output import emit, table, warn
from pounding.experiments.records import find
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.required_gap import fine_step
from pounding.experiments.rig.states import FrameState, states_of
from pounding.experiments.rig.table_scale import TableScale, table_scale
from pounding.experiments.separation import pictures
from pounding.experiments.separation.gaps.gap import gap_answer, history
from pounding.experiments.separation.report import write_report

Floor = Annotated[int | None, Parameter(help="Floor of the lower frame; default: its roof.")]
Report = Annotated[
    Path | None,
    Parameter(
        help="HTML file to write: the answer with its picture, self-contained.",
        validator=options.writable_file,
    ),
]


def gap(
    left: str,
    right: str,
    *,
    record: str,
    pga: options.Pga = None,
    floor: Floor = None,
    state: options.State = None,
    time_factor: options.TimeFactor = None,
    joints: options.Joints = "calibrated",
    p_delta: options.PDelta = True,
    damping: options.Damping = None,
    records: options.Records = None,
    report: Report = None,
    json: options.Json = False,
) -> None:
    """Compute the gap that keeps two frames apart under a record, beside the gaps by the codes' rules.

    The required gap is the largest closing motion of an exact run without contact. All lengths are those of
    the frames, whose scale their files state.

    Args:
        left: Frame on the left, a name or a frame file; it moves in +x towards the right one.
        right: Frame on the right.
        record: Name or file of the ground motion.
    """
    definitions = [frames.load(name) for name in (left, right)]
    scale = table_scale(definitions, time_factor)
    motion = find(record, records).scaled(scale.time_factor, pga)
    states = states_of([left, right], state, motion.name, joints=joints, damping=damping)
    estimates.announce(*map(estimates.of_frame, definitions))
    built = [
        frames.build(
            definition, joints=joints, p_delta=p_delta, damping=one.damping_ratio, calibration=one.calibration
        )
        for definition, one in zip(definitions, states, strict=True)
    ]
    step_s = motion.step_s / fine_step(motion.step_s)
    estimates.announce(estimates.of_gap(built, motion.duration_s, step_s))
    answer = gap_answer(
        built[0],
        built[1],
        motion,
        floor=floor,
        own_peak=pga is None and scale.is_laboratory,
        length_scale=scale.scale.buildings_length,
    )
    asked = {
        "left": left,
        "right": right,
        "record": record,
        "pga_g": pga,
        "floor": floor,
        "joints": joints,
        "p_delta": p_delta,
        "damping_ratio": [frame.damping_ratio for frame in built],
        "states": [one.as_dict() for one in states],
        **scale.as_dict(),
    }
    result = stamp(asked, [motion]) | answer
    if report is not None:
        times, one, other = history(built[0], built[1], motion, floor=floor)
        write_report("gap", result, report, pictures.gap_history(times, one, other, result))
    emit(result, as_json=json, show=lambda: _tables(result, states, scale))
    for sentence in result["warnings"]:
        warn(sentence)


def _tables(
    result: dict[str, Any], states: Iterable[FrameState], scale: TableScale
) -> Iterable[RenderableType | str]:
    spread, published = result["spread"], result["published"]
    rows = [
        ["required gap (closing motion)", f"{result['required_gap_mm']:.2f}", f"at {result['time_s']:.3f} s"],
        ["... least and largest", f"{spread['low_mm']:.2f} to {spread['high_mm']:.2f}", spread["basis"]],
        ["... frames on swapped sides", f"{result['reversed_mm']:.2f}", "or the record with the other sign"],
        ["equation 4.1 (either way)", f"{result['equation_4_1_mm']:.2f}", "counts opening like closing"],
    ]
    if published:
        rows.append(["measured", f"{published['experiment_mm']:g}", published["source"]])
        rows.append(["SAP2000 model of the thesis", f"{published['numerical_mm']:g}", published["source"]])
    title = (
        f"{result['left']} beside {result['right']}, floor {result['floor']}, {result['record']} "
        f"({result['pga_g']:.3f} g)"
    )
    yield table(title, ["", "mm", ""], rows)
    yield from map(str, states)
    yield str(scale)
    yield table(
        "Rules, from the peaks of this run",
        ["rule", "gap mm", "applies", "mind"],
        [
            [r["name"], _mm(r["gap_mm"]), "yes" if r["in_range"] else "no", r["reason"]]
            for r in result["rules"]
        ],
    )


def _mm(value: float | None) -> str | None:
    return None if value is None else f"{value:.2f}"
