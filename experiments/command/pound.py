"""`pounding pound`: two frames side by side on the table, and the impacts between them."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import msgspec
from cyclopts import Parameter
from rich.progress import Progress, TaskID

from pounding import bounds
from pounding.contact.floors import is_hertz
from pounding.contact.laws import BUILT_IN, law_class
from pounding.experiments.console import estimates, options
from pounding.experiments.console.collision_tables import tables
from pounding.experiments.console.output import emit, plain, progress_console, warn
from pounding.experiments.errors import ExperimentError
from pounding.experiments.output import collision_folder as collision_files
from pounding.experiments.output import result_folder as keeping
from pounding.experiments.pictures import films
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.column_hits import beyond, borne
from pounding.experiments.rig.contact_choice import Parameters
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.impacts import SAMPLE_RATE_HZ, THRESHOLD_N, all_impacts, merging_s
from pounding.experiments.rig.pounding import Pounding, shaking
from pounding.experiments.rig.rig import Rig
from pounding.experiments.rig.states import states_of
from pounding.experiments.rig.street import Basis, built_row, chosen_sets, named, street_contacts
from pounding.experiments.rig.street_file import (
    DEFAULT_LAW,
    Building,
    Gap,
    Street,
    is_street_file,
    load_street,
)
from pounding.experiments.rig.table_scale import TableScale, table_scale
from pounding.frames import load
from pounding.units import LENGTH

if TYPE_CHECKING:
    from pounding.experiments.records import Record
    from pounding.frames.reduction.reduced_frame import ReducedFrame


def pound(
    left: options.FrameName,
    right: options.FrameName | None = None,
    *,
    record: Annotated[
        options.RecordName, Parameter(help="Ground motion by name (see `pounding list`) or file.")
    ],
    gap: Annotated[
        list[float] | None,
        Parameter(
            negative=(),
            help="Gap at rest [mm], one for all floors or one per floor.",
            validator=options.bounded(bounds.GAP, per=LENGTH["mm"], unit="mm"),
        ),
    ] = None,
    floor: Annotated[
        list[int] | None,
        Parameter(negative=(), help="Floor with a contact, repeatable; default: the lower frame's roof."),
    ] = None,
    law: Annotated[
        options.LawName | None,
        Parameter(help="Name of an impact law (see `pounding list`), or all; default: linear_viscoelastic."),
    ] = None,
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
    record_unit: options.RecordUnit = None,
    solver: options.Solver = "exudyn",
    out: options.Out = None,
    film: Annotated[
        bool, Parameter(negative=(), help="Write a film of the hardest impact to --out.")
    ] = False,
    json: options.Json = False,
) -> None:
    """Shake two frames side by side, or the buildings of a street, and report every impact between them.

    Args:
        left: Frame on the left (name or frame file); it moves in +x towards the right frame. Or, alone, a street file:
            buildings in a row with their gaps and contacts (see `pounding new-street`).
        right: Frame on the right.
    """
    contact = Gap(
        tuple(gap or ()),
        tuple(floor or ()),
        0.0,
        law or DEFAULT_LAW,
        parameters,
        stiffness,
        restitution,
        radius,
        tension,
    )
    streets = _streets(left, right, contact, law)
    names = [building.frame for building in streets[0].building]
    definitions = [load(name) for name in names]
    scale = table_scale(definitions, time_factor)
    sets = [chosen_sets(street, definitions, scale) for street in streets]
    folder = None if records is None else str(records)
    shaken = shaking(record, folder, time_factor=scale.time_factor, pga_g=pga, flip=flip, unit=record_unit)
    states = states_of(names, state, shaken.name, joints=joints, damping=damping)
    estimates.announce(*map(estimates.of_frame, definitions))
    row = named(streets[0], built_row(streets[0], states, joints, p_delta))
    # The contacts refuse what cannot be before anything is shown.
    standing = _standing(streets, sets, row)
    rigs = [Rig(row, one.contacts) for one in standing]
    estimates.announce(estimates.of_run(row, shaken.duration_s, len(rigs)))
    _prepare(out, film)
    runs = _run(rigs, standing, shaken, scale, solver)
    asked = {
        **_asked(left, right, standing),
        "contact_basis": _bases([basis for one in standing for basis in one.bases], row),
        "flip": flip,
        "pga_g": pga,
        "record_unit": record_unit,
        "solver": solver,
        "frames": [frame.options for frame in row],
        "states": [one.as_dict() for one in states],
        "impact_threshold_n": THRESHOLD_N,
        "impact_merging_s": merging_s(scale.scale),
        "impact_sample_rate_hz": SAMPLE_RATE_HZ,
    }
    result = stamp(asked | scale.as_dict(), [shaken]) | {
        "runs": [_as_dict(run, one) for run, one in zip(runs, standing, strict=True)]
    }
    if out is not None:
        result |= _kept(runs, result, out, film)
    _warn(result)
    emit(result, as_json=json, show=lambda: tables(result, states, scale))


def _streets(left: str, right: str | None, contact: Gap, law: str | None) -> list[Street]:
    """Return what stands on the table: a street, or a pair once for each law."""
    if is_street_file(left):
        if right is not None or contact != Gap(()) or law is not None:
            raise ExperimentError(
                f"{left} is a street file, which has its own buildings, gaps, floors and contacts; give it alone, without a "
                "second frame, --gap, --floor, --law or other options of the contact"
            )
        return [load_street(left)]
    if right is None:
        load(left)  # whose sentence on what is no frame is the better one
        raise ExperimentError(
            f"{left} is one frame; give a second one beside it, or a street file (pounding new-street writes one)"
        )
    if not contact.gaps_mm:
        raise ExperimentError("two frames need their gap at rest; give --gap with a length in mm")
    each = _of_all_laws(contact) if law == "all" else [contact]
    pair = Building(left), Building(right)
    return [Street(pair, (one,)) for one in each]


def _of_all_laws(contact: Gap) -> list[Gap]:
    """Return a contact once for each law, with those of the stated numbers for which that has a use."""
    if contact.stiffness is not None:
        raise ExperimentError(
            "--law all: one stiffness cannot be that of laws in N/m and of laws in N/m^1.5; leave --stiffness out, or name "
            "one law"
        )
    found = []
    for name in BUILT_IN:
        law, one = law_class(name), msgspec.structs.replace(contact, law=name)
        if not law.damped:
            one = msgspec.structs.replace(one, restitution=None, tension=False)
        found.append(one if is_hertz(name) else msgspec.structs.replace(one, radius_m=None))
    return found


class _Standing(NamedTuple):
    """What stands on the table for one run.

    Attributes:
        street: The buildings with their gaps.
        parameters: The parameter set of each gap.
        contacts: The contacts.
        bases: What the numbers of each contact rest on.
    """

    street: Street
    parameters: list[Parameters | None]
    contacts: list[Contact]
    bases: list[Basis]


def _standing(
    streets: Sequence[Street], sets: Sequence[list[Parameters | None]], row: Sequence[ReducedFrame]
) -> list[_Standing]:
    return [
        _Standing(street, chosen, *street_contacts(street, row, chosen))
        for street, chosen in zip(streets, sets, strict=True)
    ]


def _prepare(out: Path | None, film: bool) -> None:
    """See before the runs that they can be kept and filmed."""
    if film and out is None:
        warn("--film needs a folder: nothing is written without --out")
    elif film:
        films.require()
    if out is not None:
        keeping.prepare(out)


def _run(
    rigs: Sequence[Rig],
    standing: Sequence[_Standing],
    shaken: Record,
    scale: TableScale,
    solver: options.Solver,
) -> list[Pounding]:
    runs = []
    with _progress() as progress:
        for rig, one in zip(rigs, standing, strict=True):
            laws = ", ".join({gap.law for gap in one.street.gap})
            told = partial(_tell, progress, progress.add_task(laws, total=shaken.duration_s))
            motion = rig.run(shaken, progress=told, solver=solver)
            runs.append(Pounding(shaken, motion, all_impacts(motion, merging_s=merging_s(scale.scale))))
    return runs


def _progress() -> Progress:
    """Return progress bars that disappear when done; none where standard error is no terminal."""
    console = progress_console()
    return Progress(console=console, transient=True, disable=not console.is_terminal)


def _tell(progress: Progress, bar: TaskID, time_s: float) -> None:
    progress.update(bar, completed=time_s)


def _asked(left: str, right: str | None, standing: Sequence[_Standing]) -> dict[str, Any]:
    """Return the parameters of a result that say what stands on the table."""
    first = standing[0]
    laws = [[vars(contact.law) for contact in one.contacts] for one in standing]
    floors = [basis.floor for basis in first.bases]
    if right is None:
        return {
            "street": left,
            **msgspec.to_builtins(first.street),
            "floors": floors,
            "parameters": first.parameters,
            "contact": laws[0],
        }
    gap = first.street.gap[0]
    return {
        "left": left,
        "right": right,
        "gap_mm": gap.gaps_mm,
        "floors": floors,
        "law": "all" if len(standing) > 1 else gap.law,
        "parameters": first.parameters[0],
        "contact": {
            one.street.gap[0].law: own[0] if len(own) == 1 else own
            for one, own in zip(standing, laws, strict=True)
        },
    }


def _bases(bases: Sequence[Basis], row: Sequence[ReducedFrame]) -> list[str]:
    """Return what the laws rest on; what differs from place to place with the place."""
    said = list(dict.fromkeys(basis.sentence for basis in bases))
    laws = {sentence.partition(": ")[0] for sentence in said}
    if len(said) == len(laws):
        return said
    return [f"{basis.sentence} ({_place(basis, row)})" for basis in bases]


def _place(basis: Basis, row: Sequence[ReducedFrame]) -> str:
    place = f"floor {basis.floor}" + (f", y = {basis.y_m:g} m" if basis.y_m else "")
    return place if len(row) == 2 else f"{row[basis.pair].name} and {row[basis.pair + 1].name}, {place}"


def _as_dict(run: Pounding, standing: _Standing) -> dict[str, Any]:
    """Return what is told of a run, with what columns that are hit have borne."""
    columns = [
        borne(run.motion, contact, *basis.hit, number)
        for number, (contact, basis) in enumerate(zip(standing.contacts, standing.bases, strict=True))
        if basis.hit is not None
    ]
    found = run.result() | run.validity()
    if columns:
        found["columns"] = columns
        found["warnings"] += [sentence for one in columns for sentence in beyond(one)]
    return found


def _kept(runs: Sequence[Pounding], result: dict[str, Any], out: Path, film: bool) -> dict[str, Any]:
    """Write the runs, and return what a result says of the files."""
    with _progress() as progress:
        bar = progress.add_task("film" if film else "writing", total=1.0)

        def told(share: float) -> None:
            progress.update(bar, completed=share)

        kept = collision_files.keep(runs, plain(result), out, film=film, progress=told)
    for note in kept.notes:
        warn(note)
    return {"files": kept.files, "film": kept.film and dataclasses.asdict(kept.film)}


def _warn(result: dict[str, Any]) -> None:
    for run in result["runs"]:
        for sentence in run["warnings"]:
            warn(f"{run['law']}: {sentence}" if len(result["runs"]) > 1 else sentence)
