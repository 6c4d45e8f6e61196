"""`pounding pound`: two frames side by side on the table, and the impacts between them."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter
from rich.progress import Progress, TaskID

from pounding import bounds
from pounding.contact.laws import BUILT_IN
from pounding.experiments.console import estimates, options
from pounding.experiments.console.output import emit, plain, progress_console, table, warn
from pounding.experiments.output import collision_folder as collision_files
from pounding.experiments.output import result_folder as keeping
from pounding.experiments.pictures import films
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.contact_choice import ContactWish, Parameters, choose_laws, chosen_parameters
from pounding.experiments.rig.ductility import ductility_sentence
from pounding.experiments.rig.impacts import SAMPLE_RATE_HZ, THRESHOLD_N, merging_s
from pounding.experiments.rig.pounding import Pounding, built_in, rig_of, shaking
from pounding.experiments.rig.pounding import pound as run_one
from pounding.experiments.rig.required_gap import is_left_lower
from pounding.experiments.rig.states import FrameState, states_of
from pounding.experiments.rig.table_scale import TableScale, table_scale
from pounding.frames import load
from pounding.units import LENGTH

DEFAULT_LAW = "linear_viscoelastic"

HEADS = ("time s", "floor", "peak N", "N s", "approach m/s", "touches, max ms", "restitution")
"""Of the table of impacts; duration and restitution are those of single touches."""


def pound(
    left: str,
    right: str,
    *,
    gap: Annotated[
        list[float],
        Parameter(
            help="Gap at rest [mm], one for all floors or one per floor.",
            validator=options.bounded(bounds.GAP, per=LENGTH["mm"], unit="mm"),
        ),
    ],
    record: Annotated[str, Parameter(help="Ground motion by name (see `pounding list`) or file.")],
    floor: Annotated[
        list[int] | None, Parameter(help="Floor with a contact, repeatable; default: the lower frame's roof.")
    ] = None,
    law: Annotated[
        str, Parameter(help="Name of an impact law (see `pounding list`), or all.")
    ] = "linear_viscoelastic",
    parameters: Annotated[
        Parameters | None,
        Parameter(
            help="Contact parameters: the laboratory's, from the thesis' tables (printed, the default at 1:30) or its "
            "formulas (formula), or an estimate from the floors' slabs and masses (floors, the default at any other scale)."
        ),
    ] = None,
    stiffness: Annotated[
        float | None,
        Parameter(
            help="Contact stiffness [N/m; Hertz family N/m^1.5] instead of the set's.",
            validator=options.bounded(bounds.CONTACT_STIFFNESS),
        ),
    ] = None,
    restitution: Annotated[
        float | None, Parameter(help="Coefficient of restitution from which the law's damping is computed.")
    ] = None,
    radius: Annotated[
        float | None,
        Parameter(
            help="Radius of a Hertz contact [m] for --parameters floors; default: of spheres with the floors' masses.",
            validator=options.bounded(bounds.LENGTH),
        ),
    ] = None,
    tension: Annotated[bool, Parameter(negative=(), help="Let a contact pull just before it opens.")] = False,
    flip: Annotated[bool, Parameter(negative=(), help="Reverse the record's sign.")] = False,
    pga: options.Pga = None,
    state: options.State = None,
    time_factor: options.TimeFactor = None,
    joints: options.Joints = "calibrated",
    p_delta: options.PDelta = True,
    damping: options.Damping = None,
    records: options.Records = None,
    solver: options.Solver = "exudyn",
    out: options.Out = None,
    film: Annotated[
        bool, Parameter(negative=(), help="Write a film of the hardest impact to --out.")
    ] = False,
    json: options.Json = False,
) -> None:
    """Shake two frames side by side and report every impact between them.

    Args:
        left: Frame on the left (name or frame file); it moves in +x towards the right frame.
        right: Frame on the right.
    """
    definitions = [load(name) for name in (left, right)]
    scale = table_scale(definitions, time_factor)
    names = BUILT_IN if law == "all" else [law]
    wish = ContactWish(names, parameters, stiffness, restitution, radius, tension)
    chosen_set = chosen_parameters(definitions, scale, wish)
    folder = None if records is None else str(records)
    shaken = shaking(record, folder, time_factor=scale.time_factor, pga_g=pga, flip=flip)
    states = states_of([left, right], state, shaken.name, joints=joints, damping=damping)
    estimates.announce(*map(estimates.of_frame, definitions))
    pair = built_in(states[0], joints, p_delta), built_in(states[1], joints, p_delta)
    floors = floor or [(pair[0] if is_left_lower(*pair) else pair[1]).storeys]
    by_floor = {number: choose_laws(pair, number, chosen_set, wish) for number in floors}
    laws = list(zip(*(chosen for chosen, _ in by_floor.values()), strict=True))
    bases = _bases({number: said for number, (_, said) in by_floor.items()})
    gaps_m = [1e-3 * value for value in gap]
    rig_of(*pair, laws[0], gaps_m, floors)  # refuses what cannot be before anything is shown
    estimates.announce(estimates.of_run(pair, shaken.duration_s, len(laws)))
    if film and out is None:
        warn("--film needs a folder: nothing is written without --out")
    elif film:
        films.require()
    if out is not None:
        keeping.prepare(out)
    runs = []
    with _progress() as progress:
        for chosen in laws:
            bar = progress.add_task(chosen[0].name, total=shaken.duration_s)
            runs.append(
                run_one(
                    *pair,
                    shaken,
                    chosen,
                    gaps_m,
                    floors=floors,
                    progress=partial(_tell, progress, bar),
                    solver=solver,
                    merging_s=merging_s(scale.scale),
                )
            )
    asked = {
        "left": left,
        "right": right,
        "gap_mm": gap,
        "floors": floors,
        "law": law,
        "parameters": chosen_set,
        "contact": {of[0].name: vars(of[0]) if len(of) == 1 else [vars(one) for one in of] for of in laws},
        "contact_basis": bases,
        "flip": flip,
        "pga_g": pga,
        "solver": solver,
        "frames": [frame.options for frame in pair],
        "states": [one.as_dict() for one in states],
        "impact_threshold_n": THRESHOLD_N,
        "impact_merging_s": merging_s(scale.scale),
        "impact_sample_rate_hz": SAMPLE_RATE_HZ,
    }
    result = stamp(asked | scale.as_dict(), [shaken]) | {
        "runs": [run.result() | run.validity() for run in runs]
    }
    if out is not None:
        kept = _keep(runs, result, out, film)
        result |= {"files": kept.files, "film": kept.film and dataclasses.asdict(kept.film)}
        for note in kept.notes:
            warn(note)
    for run in result["runs"]:
        for sentence in run["warnings"]:
            warn(f"{run['law']}: {sentence}" if len(runs) > 1 else sentence)
    emit(result, as_json=json, show=lambda: _show(result, states, scale))


def _tell(progress: Progress, bar: TaskID, time_s: float) -> None:
    progress.update(bar, completed=time_s)


def _progress() -> Progress:
    """Return progress bars that disappear when done; none where standard error is no terminal."""
    console = progress_console()
    return Progress(console=console, transient=True, disable=not console.is_terminal)


def _keep(runs: Sequence[Pounding], result: dict[str, Any], out: Path, film: bool) -> keeping.Kept:
    with _progress() as progress:
        bar = progress.add_task("film" if film else "writing", total=1.0)

        def told(share: float) -> None:
            progress.update(bar, completed=share)

        return collision_files.keep(runs, plain(result), out, film=film, progress=told)


def _bases(by_floor: dict[int, list[str]]) -> list[str]:
    """Return what the laws rest on; what differs from floor to floor with the floor."""
    said = list(by_floor.values())
    if all(one == said[0] for one in said):
        return said[0]
    return [
        f"{sentence} (floor {number})" for number, sentences in by_floor.items() for sentence in sentences
    ]


def _together(bases: Iterable[str]) -> Iterable[str]:
    """Return what laws rest on, those that rest on the same in one sentence."""
    laws: dict[str, list[str]] = {}
    for sentence in bases:
        name, _, basis = sentence.partition(": ")
        laws.setdefault(basis, []).append(name)
    return [f"{', '.join(names)}: {basis}" for basis, names in laws.items()]


def _show(result: dict[str, Any], states: Iterable[FrameState], scale: TableScale) -> Iterable[Any]:
    for run in result["runs"]:
        title = (
            f"{run['left']} beside {run['right']}, {run['record']}, {run['law']}, gap {run['gap_mm']:g} mm"
            if isinstance(run["gap_mm"], float)
            else f"{run['left']} beside {run['right']}, {run['record']}, {run['law']}"
        )
        if run["impacts"]:
            yield table(
                title,
                HEADS,
                [_row(impact) for impact in run["impacts"]],
            )
            yield from _merged(run["impacts"])
        else:
            yield f"{title}: the floors did not touch."
        for side in ("left", "right"):
            yield from ductility_sentence(run[side], run["ductility"][side])
        yield (
            f"energy closes to {100 * run['energy_error']:.2g} %; "
            f"{run['model_s']:.1f} simulated s in {run['wall_s']:.2f} s"
        )
    yield table(
        "Largest displacement of the roofs, in mm",
        ["law", "frame", "roof +", "roof -", "peak force N", "impacts"],
        [_peak_row(run, side) for run in result["runs"] for side in ("left", "right")],
    )
    yield (
        f"Impacts as a force sensor sees them: {SAMPLE_RATE_HZ:,.0f} samples a second, {THRESHOLD_N:g} N, "
        f"touches less than {1e3 * result['parameters']['impact_merging_s']:.3g} ms apart are one."
    )
    yield from map(str, states)
    yield str(scale)
    yield from _together(result["parameters"]["contact_basis"])
    yield from keeping.written(result)


def _row(impact: dict[str, Any]) -> list[str]:
    return [
        f"{impact['time_s']:.4f}",
        f"{impact['floor']}",
        f"{impact['peak_force_n']:.0f}",
        f"{impact['impulse_n_s']:.3f}",
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


def _peak_row(run: dict[str, Any], side: str) -> list[str]:
    roof = run["peaks"][side][-1]
    force = max((impact["peak_force_n"] for impact in run["impacts"]), default=0.0)
    return [
        run["law"],
        run[side],
        f"{roof['max_mm']:.1f}",
        f"{roof['min_mm']:.1f}",
        f"{force:.0f}",
        f"{len(run['impacts'])}",
    ]
