"""The report on a case: one object, written to `report.json` and read from there, of which pages and tables are made.

Its fields are the keys of docs/diagnosis/case-format.md and docs/diagnosis/reports.md. What a report may lack is unset; what
it has but knows no number for is None, as everything that is not finite.
"""

from __future__ import annotations

import math

import msgspec
from msgspec import UNSET, Struct, UnsetType

from pounding.diagnosis.decision.claims import Candidate, Claim
from pounding.diagnosis.decision.conclusion import ContactMisfit
from pounding.diagnosis.decision.confidence import Basis
from pounding.diagnosis.decision.decision import NAMED, Verdict
from pounding.diagnosis.design.detectability import Detectability
from pounding.diagnosis.design.distinguishing_tests import Distinction
from pounding.diagnosis.inference.misfit_map import Spot
from pounding.diagnosis.settings import SETTINGS

SCHEMA = 2

LOGARITHMS = ("frame_damping", "mode_damping", "joint_stiffness", "contact_stiffness", "contact_damping")
"""Parameters of the baseline model whose priors are those of a logarithm of a factor."""


class Misfit(Struct, frozen=True, kw_only=True):
    """Medians over the channels of rms(simulated - measured) / rms(measured).

    Attributes:
        before: Of the baseline model, its nuisance parameters calibrated.
        after: Of the exudyn model with the effects in it; with the likeliest candidate in it where none is named.
        noise_floor: What a perfect model would leave.
        explained: Share of the misfit above the noise floor that the effects explain; None where none is above it, and where
            nothing is missing.
    """

    before: float | None
    after: float | None
    noise_floor: float | None
    explained: float | UnsetType | None = UNSET

    def share(self) -> float | None:
        """Return the share of the misfit above the noise floor that the effects explain, or None where none is above it.

        What ends below the floor, which is estimated, explains all of it and no more.
        """
        before, after, noise = self.before, self.after, self.noise_floor
        if before is None or after is None or noise is None:
            return None
        if not before > SETTINGS.report.explainable * noise:
            return None
        return min((before - after) / (before - noise), 1.0)


def _from_to(misfit: Misfit) -> str:
    """Return a misfit before and after, in words: `2.5 % -> 1.2 %`."""
    return " -> ".join(
        "unknown" if share is None else f"{100 * share:.3g} %" for share in (misfit.before, misfit.after)
    )


class HeldOutMisfit(Misfit, frozen=True, kw_only=True):
    """The same over the runs that were not used, whose names are in `run`."""

    run: str


class Misfits(Struct, frozen=True, kw_only=True):
    """The misfit over the runs that were used, over those held out (None without any), and of held-out impacts."""

    training: Misfit | None
    held_out: HeldOutMisfit | None
    contact: ContactMisfit | UnsetType = UNSET

    def __repr__(self) -> str:
        kinds = {"training": self.training, "held out": self.held_out}
        said = [f"{kind} {_from_to(misfit)}" for kind, misfit in kinds.items() if misfit is not None]
        said += [] if self.contact is UNSET else ["held-out impacts too"]
        return f"Misfits({', '.join(said) or 'none'})"

    @property
    def judged(self) -> Misfit | None:
        """That by which a verdict is judged: of the held-out runs if there are any."""
        return self.held_out or self.training


class ChannelMisfit(Struct, frozen=True, kw_only=True):
    """The misfit of one channel, on the held-out runs if there are any."""

    channel: str
    before: float | None
    after: float | None
    noise_floor: float | None


class Threshold(Struct, frozen=True, kw_only=True):
    """What an effect needs for a verdict: an ln Bayes factor, and a share of some channel's noise."""

    log_evidence: float
    share_of_noise: float


class Thresholds(Threshold, frozen=True, kw_only=True):
    """The same, and for effects that absorb what every baseline frame has wrong.

    Attributes:
        absorbing: What these effects need.
        false_alarms: Share of the cases without an effect in which one is named or something is said to remain; unset for a
            pair.
        nulls: The simulated cases without an effect that say how much is needed; many candidates may ask for more evidence.
        standard_errors: How far from none a size must be that may have either sign, in standard errors.
    """

    absorbing: Threshold
    false_alarms: float | UnsetType = UNSET
    nulls: str | UnsetType = UNSET
    standard_errors: float | UnsetType = UNSET


class File(Struct, frozen=True, kw_only=True):
    """A file that was read, and its SHA-256."""

    name: str
    sha256: str


class Origin(Struct, frozen=True, kw_only=True):
    """Where a report comes from: the software, what it was asked, its priors, and the files that it read.

    Attributes:
        reference: Names of the runs of the frame as it was before: what is said is what changed since.
    """

    software: str
    version: str
    libraries: dict[str, str]
    python: str
    command: str
    prior: dict[str, float]
    files: tuple[File, ...]
    reference: tuple[str, ...] = ()


class CorrectedModel(Struct, frozen=True, kw_only=True):
    """The corrected model as files.

    Attributes:
        files: The files that were written, the frames' first; none where it was refused.
        motions: Those of them that hold the table's motion in a run.
        beside: What was found that is on no frame, or an error of it that no file can state, and so in none of the files.
        case: Folder with the case without the faults of its sensors and its table; None where these have none.
        refused: Why nothing was written.
    """

    files: tuple[str, ...]
    motions: tuple[str, ...] = ()
    beside: tuple[str, ...] = ()
    case: str | None = None
    refused: str | None = None


class ModalRow(Struct, frozen=True, kw_only=True):
    """A modal datum in SI: as measured, by the baseline model, with the effects, and predicted from the others.

    Attributes:
        surprise: Its distance from that prediction in standard deviations.
    """

    frame: str
    quantity: str
    mode: int | None
    test: str
    measured: float
    std: float
    baseline: float | None
    fitted: float | None
    predicted: float | None
    surprise: float | None


class Remainder(Struct, frozen=True, kw_only=True):
    """The misfit that remains when everything claimed is in the model.

    Attributes:
        p_value: Probability of so much by chance.
        linear: Whether it is of the kind that a linear model makes.
        size: Its share of the motion.
        statement: The same in a sentence.
        within: Whether the calibrated baseline model leaves something, but no more than the case's `model_error` allows.
    """

    p_value: float | None
    linear: bool | None
    size: float | None
    statement: str
    within: bool = False


class LoopMeasure(Struct, frozen=True, kw_only=True):
    """A measure of a loop of force over drift, from -1 to 1: as measured, by the law, standard error of the difference."""

    measured: float
    law: float
    std: float


class Shape(Struct, frozen=True, kw_only=True):
    """The shape of what was found, beside the catalogue's and the measured loop's.

    Attributes:
        statement: What is said of it.
        frame, storey: Where the loop is; unset without one.
        fullness: Which part of the force goes with the drift's rate, a correlation.
        bend: Which part of it goes with the drift's cube beyond the drift, a correlation.
    """

    statement: str
    frame: str | UnsetType = UNSET
    storey: int | UnsetType = UNSET
    fullness: LoopMeasure | UnsetType = UNSET
    bend: LoopMeasure | UnsetType = UNSET


class CalibratedParameter(Struct, frozen=True, kw_only=True):
    """A parameter of the baseline model after calibration, as a factor or in its unit, with its standard deviations.

    `measured` is what can be read from the measurements without a model, `resolution` how finely; unset where nothing can.
    `corrected` is that of a frequency with what was found in the frame's stiffness and mass.
    """

    parameter: str
    baseline: float
    calibrated: float
    std: float | None
    prior_std: float | None
    frame: str | None = None
    storey: int | None = None
    floor: int | UnsetType = UNSET
    mode: int | UnsetType = UNSET
    channel: str | UnsetType = UNSET
    contact: int | UnsetType = UNSET
    measured: float | UnsetType = UNSET
    resolution: float | UnsetType = UNSET
    corrected: float | UnsetType = UNSET

    def __repr__(self) -> str:
        std = "" if self.std is None else f" ± {self.std:.2g}"
        return f"CalibratedParameter({self.parameter} of {self.where()}: {self.baseline:.4g} -> {self.calibrated:.4g}{std})"

    def where(self) -> str:
        """Return the place in words, for a table's cell."""
        keys = ("storey", "floor", "mode", "channel", "contact")
        words = [f"{key} {value}" for key in keys if isinstance(value := getattr(self, key), int | str)]
        return " of ".join([*words, *([self.frame] if self.frame else [])]) or "the table"

    def moved(self) -> float | None:
        """Return by how many prior standard deviations it moved; None where it has no prior of its own."""
        return None if self.prior_std is None else _departure(self) / self.prior_std


def _departure(one: CalibratedParameter) -> float:
    """Return by how much a parameter departs, as a logarithm where its prior is of one."""
    if one.baseline and one.parameter in LOGARITHMS:
        return math.log(one.calibrated / one.baseline)
    return one.calibrated - one.baseline


class Report(Struct, frozen=True, kw_only=True):
    """What is said of a case: of shaken frames, of two that pound, or of modal data alone.

    Attributes:
        verdict: `nothing_missing`, `effect_named`, `effect_class` or `unknown_effect`.
        confidence: Probability that it is right; None where a method states none.
        confidence_basis: What stands behind that figure.
        effects: What is missing, the likeliest first; the best that was tried for an unknown effect.
        misfit: How far the model is from the measurements before and after.
        where: Where the baseline model disagrees most.
        candidates: Every effect that was tried, the likeliest first.
        remainder: The misfit that remains with the effects in the model; None where it was not looked at.
        calibration: What became of the baseline model's parameters; None where it was not looked at.
        warnings: Sentences.
        modal: Every modal datum; of cases with modal data alone.
        advice: Sentences on further measurements.
        advice_evidence: The ln Bayes factor that each is expected to bring.
        shape: What is said of the shape of what was found; of a report that is written to a folder.
        model: The corrected model as files, where it was asked for.
        channels, smallest_detectable, apart, thresholds, origin: Details of a report that is written to a folder.
    """

    schema: int = SCHEMA
    verdict: Verdict
    confidence: float | None
    effects: tuple[Claim, ...]
    misfit: Misfits
    where: tuple[Spot, ...]
    candidates: tuple[Candidate, ...]
    warnings: tuple[str, ...]
    confidence_basis: Basis | UnsetType = UNSET
    remainder: Remainder | None = None
    calibration: tuple[CalibratedParameter, ...] | None = None
    modal: tuple[ModalRow, ...] | UnsetType = UNSET
    advice: tuple[str, ...] | UnsetType = UNSET
    advice_evidence: tuple[float, ...] | UnsetType = UNSET
    shape: Shape | UnsetType = UNSET
    channels: tuple[ChannelMisfit, ...] | UnsetType = UNSET
    smallest_detectable: tuple[Detectability, ...] | UnsetType = UNSET
    apart: tuple[Distinction, ...] | UnsetType = UNSET
    thresholds: Thresholds | UnsetType = UNSET
    origin: Origin | UnsetType = UNSET
    model: CorrectedModel | UnsetType = UNSET

    def __repr__(self) -> str:
        effects = ", ".join(effect.words() for effect in self.effects) or "no effect"
        sure = "none stated" if self.confidence is None else f"{self.confidence:.2g}"
        return f"Report({self.verdict!r}, {effects}, confidence {sure})"

    @property
    def named(self) -> bool:
        """Whether it says what is missing, alone or as one of a class."""
        return self.verdict in NAMED

    def json(self) -> str:
        """Return the report as the text of a `report.json`."""
        return msgspec.json.format(msgspec.json.encode(self), indent=2).decode() + "\n"
