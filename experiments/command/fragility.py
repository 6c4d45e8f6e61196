"""`pounding fragility`: how likely the floors of a street touch, over many records."""

from __future__ import annotations

import json as json_text
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import msgspec
import numpy as np
from cyclopts import Parameter
from numpy.typing import NDArray
from rich.progress import Progress

from pounding import bounds
from pounding.experiments.console import options
from pounding.experiments.console.fragility_tables import tables
from pounding.experiments.console.output import emit, plain, progress_console
from pounding.experiments.console.street_input import LinearStreet, linear_street
from pounding.experiments.errors import ExperimentError
from pounding.experiments.fragility.capacity import Limit, passing, touching_intensities
from pounding.experiments.fragility.intensity import Intensity
from pounding.experiments.fragility.pictures import Curve, Sample, drawn, fragilities
from pounding.experiments.fragility.samples import of_limit, of_touching
from pounding.experiments.fragility.sweeping import Motions, passing_by_sweep, street_text
from pounding.experiments.output import result_folder as keeping
from pounding.experiments.records.code_spectra import FORMS
from pounding.experiments.records.code_spectra import target as spectrum
from pounding.experiments.records.sets import FEMA_SETS, refuse_twice
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.street_file import Street
from pounding.frames.files import replacing, write_whole
from pounding.units import LENGTH

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pounding.experiments.records import Record
    from pounding.experiments.records.code_spectra import Target
    from pounding.experiments.rig.contacts import Contact

BEYOND = 4.0
"""Levels reach from the weakest intensity at which a record brings floors together to so many times the strongest [-]."""


def fragility(
    street: str,
    *,
    record: Annotated[
        list[options.RecordName] | None,
        Parameter(negative=(), show_choices=False, help="Ground motion by name or file, repeatable."),
    ] = None,
    set_: Annotated[
        str | None,
        Parameter(name="--set", help=f"Set of ground motions: a folder of files, or {', '.join(FEMA_SETS)}."),
    ] = None,
    period: Annotated[
        float | None,
        Parameter(
            help="Period of the spectral acceleration [s]; default: the longest first period of the buildings. 0: peak "
            "ground acceleration.",
            validator=options.bounded(bounds.PERIOD),
        ),
    ] = None,
    gap: Annotated[
        list[float] | None,
        Parameter(
            negative=(),
            help="Gap of all neighbours [mm], repeatable, a curve each; default: the street's own gaps.",
            validator=options.bounded(bounds.GAP, per=LENGTH["mm"], unit="mm"),
        ),
    ] = None,
    force: Annotated[
        float | None, Parameter(help="Also the probability of a contact force above this [kN].")
    ] = None,
    drift: Annotated[
        float | None, Parameter(help="Also the probability of a storey drift above this [% of the height].")
    ] = None,
    target: Annotated[
        str | None,
        Parameter(
            help="Design spectrum to which the records are brought, for the gap that they ask for: "
            f"{'; '.join(FORMS.values())}."
        ),
    ] = None,
    levels: Annotated[
        int,
        Parameter(
            help="Levels of the intensity for --force and --drift.",
            validator=options.bounded(bounds.LEVELS),
        ),
    ] = 12,
    seed: options.Seed = 0,
    workers: options.Workers = None,
    kept: Annotated[
        Path | None,
        Parameter(
            help="Folder for the finished runs of --force and --drift; an interrupted call goes on from it.",
            validator=options.writable_folder,
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        Parameter(
            help="Address of a dask.distributed scheduler, on which the runs of --force and --drift go."
        ),
    ] = None,
    time_factor: options.TimeFactor = None,
    damping: options.Damping = None,
    records: options.Records = None,
    record_unit: options.RecordUnit = None,
    out: options.Out = None,
    json: options.Json = False,
) -> None:
    """Compute how likely neighbours touch at an intensity of the shaking, as a lognormal fragility over many records.

    Until the first touch linear buildings move in proportion to the shaking, so that one run of a record says at which
    intensity it brings the floors together. Limits of force and drift take runs with contact at several levels.

    Args:
        street: Street file (`pounding new-street` writes one).
    """
    limits = _limits(force, drift)
    sweeping = _Sweeping(kept, workers, scheduler)
    sweeping.refuse_without(limits)
    aim = None if target is None else spectrum(target)
    row = linear_street(street, time_factor, damping)
    motions = _motions(record or (), set_, records, row.scale.time_factor, record_unit)
    shakings = _several(motions.read())
    neighbours = _neighbours(row, gap)
    if out is not None:
        keeping.prepare(out)
    factors = None if aim is None else _factors(aim, row, shakings)
    intensity = Intensity(max(_first_periods_s(row)) if period is None else period or None)
    shaken = _Shaken(motions, shakings, np.array([intensity.of(one) for one in shakings]))
    found = _found(row, neighbours, shaken, limits, levels, sweeping)
    axis_g, curves = drawn(_samples(neighbours, limits, found), len(shakings), seed)
    asked = {
        **row.as_dict(),
        "set": set_,
        "record_unit": record_unit,
        "gap_mm": gap,
        "period_s": intensity.period_s,
        "target": aim and aim.words,
        "force_kn": force,
        "drift_percent": drift,
        "levels_g": found.levels_g if limits else None,
        "seed": seed,
    }
    result = stamp(asked, shakings) | {
        "intensity": intensity.words,
        "fragilities": [_as_dict(curve) for curve in curves],
        "per_record": _per_record(shaken, found),
    }
    if factors is not None:
        smallest_mm = [one.smallest_gap_mm for one in neighbours]
        result["at_target"] = _at_target(factors, shaken.strengths_g, found.touching_g, smallest_mm)
    if out is not None:
        touching = [(neighbours[0].smallest_gap_mm, value) for value in found.touching_g[0]]
        result["files"] = _keep(result, fragilities(curves, axis_g, intensity.words, touching), out)
    emit(result, as_json=json, show=lambda: tables(result, row.scale))


def _limits(force_kn: float | None, drift_percent: float | None) -> list[Limit]:
    found = []
    if force_kn is not None:
        bounds.CONTACT_FORCE.check(force_kn, "--force", per=1e3, unit="kN")
        found.append(Limit("force", 1e3 * force_kn))
    if drift_percent is not None:
        bounds.DRIFT.check(drift_percent, "--drift", per=0.01, unit="%")
        found.append(Limit("drift", 0.01 * drift_percent))
    return found


@dataclass(frozen=True)
class _Sweeping:
    """How the runs of limits go as a sweep, where that is asked for.

    Attributes:
        folder: Where finished runs are kept, or None.
        workers: Processes; one a core when None.
        scheduler: Address of a dask.distributed scheduler, or None.
    """

    folder: Path | None
    workers: int | None
    scheduler: str | None

    @property
    def is_asked(self) -> bool:
        """Whether the runs are to be kept, or to go elsewhere."""
        return bool(self.folder or self.scheduler)

    def refuse_without(self, limits: Sequence[Limit]) -> None:
        """Raise ExperimentError where it is asked for and there is no limit."""
        if self.is_asked and not limits:
            raise ExperimentError(
                "--kept and --scheduler are for the runs of --force or --drift; touching takes one run a record, here"
            )


def _motions(
    names: Sequence[str], set_name: str | None, folder: Path | None, time_factor: float, unit: str | None
) -> Motions:
    return Motions(
        tuple(map(_place, names)),
        set_name and _place(set_name),
        None if folder is None else str(folder.resolve()),
        time_factor,
        unit,
    )


def _place(name: str) -> str:
    """Return a file or folder with its whole path: workers stand elsewhere. Other names stay."""
    path = Path(name)
    return str(path.resolve()) if path.exists() else name


def _several(found: list[Record]) -> list[Record]:
    if len(found) < 2:
        raise ExperimentError(
            f"{len(found) or 'no'} record was found; a fragility needs several: give --set (a folder, or "
            f"{', '.join(FEMA_SETS)}), or --record more than once"
        )
    refuse_twice(found)
    return found


class _Neighbours(NamedTuple):
    """The street with one set of gaps, and the curve that is drawn of it."""

    label: str
    street: Street
    contacts: list[Contact]

    @property
    def smallest_gap_mm(self) -> float:
        return min(1e3 * contact.gap_m for contact in self.contacts)


def _neighbours(row: LinearStreet, gaps_mm: Sequence[float] | None) -> list[_Neighbours]:
    """Return the street with each gap that is asked for, or as it is."""
    asked = [(f"floors touch, gap {value:g} mm", _with_gap(row.street, value)) for value in gaps_mm or ()]
    found = [
        _Neighbours(label, street, row.contacts(street)[0])
        for label, street in asked or [("floors touch", row.street)]
    ]
    if not all(contact.gap_m > 0.0 for one in found for contact in one.contacts):
        raise ExperimentError("floors that lie against each other touch at any intensity; give gaps above 0")
    return found


def _with_gap(street: Street, gap_mm: float) -> Street:
    gaps = tuple(msgspec.structs.replace(one, gap_mm=gap_mm) for one in street.gap)
    return msgspec.structs.replace(street, gap=gaps)


def _factors(aim: Target, row: LinearStreet, shakings: Sequence[Record]) -> NDArray[np.float64]:
    """Return what each record's acceleration is multiplied by to meet the design spectrum [-]."""
    firsts = _first_periods_s(row)
    ends = min(firsts), max(firsts)
    return np.array([aim.factor(one, ends, row.scale.time_factor) for one in shakings])


def _first_periods_s(row: LinearStreet) -> list[float]:
    return [1.0 / float(frame.frequencies_hz[0]) for frame in row.frames]


class _Shaken(NamedTuple):
    """The records, where they come from, and the intensity of each as it is [g]."""

    motions: Motions
    records: list[Record]
    strengths_g: NDArray[np.float64]


class _Found(NamedTuple):
    """What the runs say.

    Attributes:
        touching_g: Intensity at which each record brings floors together, for each set of gaps (sets, records) [g].
        levels_g: Levels of the intensity (m,) [g].
        passed: Whether each record at each level passes each limit (limits, records, levels).
    """

    touching_g: NDArray[np.float64]
    levels_g: NDArray[np.float64]
    passed: NDArray[np.bool_]


def _found(
    row: LinearStreet,
    neighbours: Sequence[_Neighbours],
    shaken: _Shaken,
    limits: Sequence[Limit],
    levels: int,
    sweeping: _Sweeping,
) -> _Found:
    """Run each record once for the floors' touching and, where there are limits, at each level with contact."""
    count = len(shaken.records)
    with Progress(console=progress_console(), transient=True) as progress:
        bar = progress.add_task("records", total=count * (1 + levels * bool(limits)))

        def told(done: int) -> None:
            progress.update(bar, completed=done)

        touching_g = touching_intensities(
            row.frames,
            [one.contacts for one in neighbours],
            shaken.records,
            shaken.strengths_g,
            progress=told,
        )
        levels_g = np.geomspace(touching_g.min(), BEYOND * touching_g.max(), levels)
        passed = np.zeros((0, count, levels), bool)
        if limits and not sweeping.is_asked:
            passed = passing(
                row.frames,
                neighbours[0].contacts,
                shaken.records,
                levels_g / shaken.strengths_g[:, None],
                limits,
                workers=sweeping.workers,
                progress=lambda done: told(count + done),
            )
    if sweeping.is_asked:
        passed = _passed_by_sweep(row, neighbours[0].street, shaken, limits, levels_g, sweeping)
    return _Found(touching_g, levels_g, passed)


def _passed_by_sweep(
    row: LinearStreet,
    street: Street,
    shaken: _Shaken,
    limits: Sequence[Limit],
    levels_g: NDArray[np.float64],
    sweeping: _Sweeping,
) -> NDArray[np.bool_]:
    return passing_by_sweep(
        shaken.motions,
        shaken.records,
        shaken.strengths_g,
        levels_g,
        limits,
        street_text(street, row.states, row.parameters),
        folder=sweeping.folder,
        workers=sweeping.workers,
        scheduler=sweeping.scheduler,
    )


def _samples(neighbours: Sequence[_Neighbours], limits: Sequence[Limit], found: _Found) -> list[Sample]:
    return [
        *(of_touching(one.label, own) for one, own in zip(neighbours, found.touching_g, strict=True)),
        *(of_limit(limit, one, found.levels_g) for limit, one in zip(limits, found.passed, strict=True)),
    ]


def _as_dict(curve: Curve) -> dict[str, Any]:
    return {
        "of": curve.label,
        "median_g": curve.fit.median_g,
        "beta": curve.fit.beta,
        "seen_g": curve.seen_g,
        "seen": curve.seen,
    }


def _per_record(shaken: _Shaken, found: _Found) -> list[dict[str, Any]]:
    return [
        {"record": one.name, "intensity_g": strength, "touching_g": own}
        for one, strength, own in zip(shaken.records, shaken.strengths_g, found.touching_g.T, strict=True)
    ]


def _at_target(factors: Any, strengths: Any, touching: Any, gaps_mm: Sequence[float]) -> dict[str, Any]:
    """Return what the records brought to the target ask for: the gap at which the floors just touch is in proportion."""
    needed_mm = factors * strengths / touching[0] * gaps_mm[0]
    return {
        "factors": factors,
        "required_gap_mm": needed_mm,
        "median_mm": float(np.median(needed_mm)),
        "of_84_percent_mm": float(np.quantile(needed_mm, 0.84)),
        "largest_mm": float(needed_mm.max()),
        "touching": [
            {"gap_mm": gap, "records": int(np.sum(factors * strengths > own))}
            for gap, own in zip(gaps_mm, touching, strict=True)
        ],
    }


def _keep(result: dict[str, Any], figure: Figure, out: Path) -> list[str]:
    with replacing(out / "fragility.png") as part:
        figure.savefig(part, dpi=100)
    write_whole(out / "fragility.json", (json_text.dumps(plain(result), indent=2) + "\n").encode())
    return ["fragility.png", "fragility.json"]
