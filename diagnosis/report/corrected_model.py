"""The corrected model as files that `shake`, `pound` and `gap` take: a frame file for each frame, and the table's motion.

The frames are the calibrated ones with what was found in them, as the exudyn model of the report has them: the matrices of
their floors and the laws in their storeys. What cannot stand in a frame file is refused in a sentence, and what is no part
of a frame (a sensor, the table, a contact) is said beside it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.case.writing import write_case
from pounding.diagnosis.decision.diagnosis import Diagnosis
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.inference.filtering import Filtered
from pounding.diagnosis.model.frames import definition
from pounding.diagnosis.model.laws import PlacedLaw
from pounding.diagnosis.model.model import Acting, Model
from pounding.diagnosis.model.nuisance import Assembly
from pounding.diagnosis.model.storeys import Structure
from pounding.diagnosis.model.twin import table_of
from pounding.diagnosis.report.corrected_case import corrected_case
from pounding.diagnosis.report.frame_text import frame_text
from pounding.diagnosis.report.making import corrected
from pounding.diagnosis.report.report import CorrectedModel
from pounding.experiments.rig.frame_laws import statement
from pounding.frames import Frame, PlateFrame, Slab, StickFrame
from pounding.frames.definition import Matrices
from pounding.frames.files import write_whole
from pounding.frames.storey_laws import StatedLaw

DIGITS = 12
"""Significant digits of the numbers in a frame file: a frame's lowest frequency is then right to some 1e-9."""


@dataclass(frozen=True)
class OnFrames:
    """A calibrated model with effects in it, as far as it is on the frames.

    Attributes:
        model: The baseline model.
        assembly: Its matrices, with the effects.
        laws: The laws of each frame.
        beside: Labels of the effects that are on no frame.
        left_out: Labels of the errors of a frame that its file cannot state.
    """

    model: Model
    assembly: Assembly
    laws: tuple[tuple[StatedLaw, ...], ...]
    beside: tuple[str, ...]
    left_out: tuple[str, ...]


def on_frames(
    model: Model,
    values: np.ndarray,
    effects: Sequence[tuple[Acting, np.ndarray]],
    errors: Collection[Acting] = (),
) -> OnFrames:
    """Return a model with effects as what frame files can state of it.

    Args:
        model: The baseline model.
        values: Its nuisance parameters in their own units, shape (nuisance,).
        effects: Effects that act, each with its SI parameters, shape (parameters,).
        errors: Those of them that are errors of the frame, and left out where no frame file can state them.

    Raises:
        CaseError: An effect that is on a frame and that no frame file can state.
    """
    laws: list[list[StatedLaw]] = [[] for _ in model.structure.frames]
    beside = []
    left_out: list[Acting] = []
    plain = Model(model.structure, model.observed, model.prior).assemble(values)
    for effect, numbers in (*model.always, *effects):
        label = _label(effect)
        alone = plain.copy()
        effect.apply(alone, np.asarray(numbers, float), model)
        try:
            stated = _laws(model, alone, label)
        except CaseError:
            if effect not in errors:
                raise
            left_out.append(effect)
            continue
        for frame, law in stated:
            laws[frame].append(law)
        if not alone.laws and _same_frames(alone, plain):
            beside.append(label)
    assembly = model.assemble(values, [one for one in effects if one[0] not in left_out])
    labels = tuple(_label(effect) for effect in left_out)
    return OnFrames(model, assembly, tuple(map(tuple, laws)), tuple(beside), labels)


def _label(effect: Acting) -> str:
    return str(effect.label()) if hasattr(effect, "label") else str(effect)


def _laws(model: Model, alone: Assembly, label: str) -> list[tuple[int, StatedLaw]]:
    """Return the laws of a frame that has one effect alone, each with the number of its frame."""
    if alone.extensions:
        raise CaseError(
            f"{label}: the floors move in more ways than along the shaking with it, which a stick's frame file "
            "cannot state; the report has its numbers"
        )
    return [_stated(model, placed, label) for placed in alone.laws]


def _same_frames(one: Assembly, other: Assembly) -> bool:
    """Return whether two assemblies have the same mass, stiffness and damping."""
    keys = ("mass", "stiffness", "log_damping")
    return all(np.array_equal(getattr(one, key), getattr(other, key)) for key in keys)


def _stated(model: Model, placed: PlacedLaw, label: str) -> tuple[int, StatedLaw]:
    """Return the frame of a law and the law as its file states it."""
    structure = model.structure
    for kind, index, shares in _places(structure, placed.row):
        name, number = structure.place(index)
        law = statement(placed.law, placed.parameters, (kind, number), placed.in_room, shares)
        if law is not None:
            return structure.index(name), law
    raise CaseError(
        f"{label}: its force is not one of those that a frame file can state (docs/your-own-frame.md); the report has its "
        "numbers"
    )


def _places(structure: Structure, row: np.ndarray) -> Iterator[tuple[str, int, tuple[float, ...] | None]]:
    """Yield storeys and floors along whose motion a law may act: kind, index among all, and what each drift contributes.

    Args:
        structure: The frames.
        row: What the floors' displacements contribute to the deformation that the law sees, shape (floors,).
    """
    for kind, every in (("storey", structure.drift), ("floor", np.eye(structure.floors))):
        for place in np.flatnonzero((every == row).all(axis=1)):
            yield kind, int(place), None
    shares = np.linalg.solve(structure.drift.T, row)
    index = int(np.argmax(np.abs(shares)))
    span = structure.span(structure.index(structure.place(index)[0]))
    if not np.any(np.delete(shares, span)):
        yield "storey", index, tuple(_rounded(shares[span]).tolist())


def corrected_frame(found: OnFrames, number: int, baseline: Frame, title: str = "") -> StickFrame:
    """Return a frame with what was found of it as a stick of its floors' matrices.

    Args:
        found: What was found.
        number: The frame's number.
        baseline: Its definition in the baseline model, for what no measurement changes.
        title: One line on what it is.

    Raises:
        CaseError: The baseline frame yields, which the model of the diagnosis leaves out.
    """
    if baseline.yielding is not None:
        raise CaseError(
            f"frame {baseline.name} yields by its file, and the model of the diagnosis is linear apart from what was found: "
            "it is not the frame that was measured; take the table 'yielding' out of the file"
        )
    structure, assembly = found.model.structure, found.assembly
    frame, span = structure.frames[number], structure.span(number)
    mass = _rounded(assembly.mass[span, span])
    sides = baseline.plate if isinstance(baseline, PlateFrame) else None
    return StickFrame(
        name=frame.name,
        title=title,
        scale=baseline.scale,
        storeys=frame.floors,
        storey_height_m=list(baseline.storey_heights_m),
        damping_ratio=_rounded(np.exp(assembly.log_damping[span])).tolist(),
        plan_m=(sides.length_m, sides.width_m) if sides is not None else baseline.plan_m,  # type: ignore[union-attr]
        slab=_slab(baseline),
        storey_law=list(found.laws[number]),
        matrices=Matrices(
            mass_kg=mass.tolist(), stiffness_n_per_m=_rounded(assembly.stiffness[span, span]).tolist()
        ),
    )


def _slab(baseline: Frame) -> Slab | None:
    """Return the floors' slab, of which a contact is estimated."""
    if not isinstance(baseline, PlateFrame):
        return baseline.slab
    steel = baseline.material
    return Slab(
        thickness_m=baseline.plate.thickness_m,
        youngs_modulus_gpa=steel.youngs_modulus_gpa,
        poissons_ratio=steel.poissons_ratio,
        density_kg_per_m3=steel.density_kg_per_m3,
    )


def _rounded(values: np.ndarray) -> np.ndarray:
    """Return values with `DIGITS` significant digits; matrices stay symmetric."""
    matrix = 0.5 * (values + values.T) if values.ndim == 2 else values
    return np.array([float(f"{one:.{DIGITS}g}") for one in matrix.flat]).reshape(matrix.shape)


def export_model(diagnosis: Diagnosis, file: Path, sentence: str) -> CorrectedModel:
    """Write the corrected model of a diagnosis: a file for each frame, and how the table moved in each run.

    Where sensors or table have a fault, the measurements without it are written as a case, too.

    Nothing is written where an effect cannot stand in a frame file, or where nothing in the catalogue fits; the result says
    so.

    Args:
        diagnosis: The diagnosis.
        file: The frame file; of several frames each has its name before the suffix.
        sentence: The verdict in words.

    Raises:
        FrameError: A file cannot be written.
    """
    try:
        contents = _contents(diagnosis, file, sentence)
    except CaseError as error:
        return CorrectedModel(files=(), refused=str(error))
    for path, text in contents.files.items():
        write_whole(path, text.encode())
    folder = None if contents.case is None else file.with_name(f"{file.stem}-case")
    if contents.case is not None and folder is not None:
        write_case(contents.case, folder)
    return CorrectedModel(
        files=tuple(str(path) for path in contents.files),
        beside=contents.beside,
        motions=contents.motions,
        case=None if folder is None else str(folder),
    )


@dataclass(frozen=True)
class _Contents:
    files: dict[Path, str]
    motions: tuple[str, ...]
    beside: tuple[str, ...]
    case: Case | None


def _contents(diagnosis: Diagnosis, file: Path, sentence: str) -> _Contents:
    case, conclusion = diagnosis.case, diagnosis.conclusion
    if conclusion.verdict == "unknown_effect":
        raise CaseError("nothing in the catalogue fits what is missing, so there is no corrected model")
    model, fit = _chosen(diagnosis)
    found = on_frames(model, fit.values, fit.effects, diagnosis.found.null.fit.effects)
    beside = list(found.beside)
    beside += [one.words() for one in conclusion.effects if one.contact is not None or one.left is not None]
    files: dict[Path, str] = {}
    for number, frame in enumerate(case.frames):
        made = corrected_frame(found, number, definition(frame), f"{frame.name} as measured: {case.title}")
        path = file if len(case.frames) == 1 else file.with_stem(f"{file.stem}-{frame.name}")
        files[path] = frame_text(made, model.structure.frames[number], sentence, beside, found.left_out)
    runs = [*diagnosis.found.training, *diagnosis.found.held_out]
    moved = {_table_file(file, model, run): _table_text(found, run) for run in runs}
    faults = model.assemble(np.zeros(len(model.std)), fit.effects)
    return _Contents(
        files | moved,
        tuple(str(path) for path in moved),
        (*beside, *found.left_out),
        corrected_case(case, model.observed, faults),
    )


def _chosen(diagnosis: Diagnosis) -> tuple[Model, Filtered]:
    """Return the model and the fit behind the verdict: without effects where none is named."""
    found, decision = diagnosis.found, diagnosis.decision
    if decision.named:
        return corrected(found, decision.judged)
    return found.model, found.null.fit.filtered


def _table_file(file: Path, model: Model, run: int) -> Path:
    stated = Path(model.observed.runs[run].name).with_suffix("")
    name = "-".join(part for part in stated.parts if part not in (stated.anchor, ".."))
    return file.with_name(f"{file.stem}-table-{name}.csv")


def _table_text(found: OnFrames, run: int) -> str:
    """Return the table's motion in a run, corrected for its gain, delay and clock, as `--record` takes it."""
    times, table = table_of(found.model, found.assembly, run)
    rows = [f"{t:.9g},{a:.9g}" for t, a in zip(times, table, strict=True)]
    return "\n".join(["time_s,acceleration_m_s2", *rows]) + "\n"
