"""`--calibrate`: how often verdicts are right on this very rig under these very records, by simulating both.

Null and rivals take turns at being the truth. Each case has nuisance parameters drawn from their priors, the effect at about
its fitted size, the noise as estimated, and is diagnosed by the same search. What was found and whether it was right is
kept in a file, a line with a checksum for each, so that an interrupted calibration goes on and a finished one costs nothing.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from time import monotonic

import msgspec
import numpy as np

from pounding.diagnosis.decision.beyond_errors import search_beyond_errors
from pounding.diagnosis.decision.conclusion import Conclusion
from pounding.diagnosis.decision.confidence import Features, SimulatedTruth, features_from, fit, shipped
from pounding.diagnosis.decision.false_alarms import alarms_of, of_nulls
from pounding.diagnosis.decision.nulls import Shown, drawn, shown, with_data_of
from pounding.diagnosis.decision.verdict import decide, features
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.findings import Findings, Judged, best
from pounding.diagnosis.inference.search import Progress
from pounding.diagnosis.inference.tails import FalseAlarms
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import root_mean_square
from pounding.diagnosis.settings import SETTINGS
from pounding.experiments.console.estimates import remaining
from pounding.experiments.results.provenance import software_version
from pounding.extras import extra_module
from pounding.frames.files import sealed, tell_damage, unsealed, write_whole

WORKERS = 2


@dataclass(frozen=True)
class Outcome:
    """One simulated case: what was true, what the verdict rested on, whether it was right."""

    number: int
    truth: str
    right: bool
    features: Features
    null: Shown | None = None
    """What the search found where nothing is missing, on a frame that stands alone."""


def calibrate(
    simulate: Callable[[int], Outcome],
    path: Path,
    progress: Progress = lambda what, share: None,
    *,
    cases: int = SETTINGS.calibration.cases,
    minutes: float = SETTINGS.calibration.minutes,
    workers: int = WORKERS,
) -> list[Outcome]:
    """Return the outcomes of simulated cases on the rig of a diagnosis, those kept in a file first.

    Args:
        simulate: Returns the outcome of the case of a number, the same whenever it is asked for.
        path: File that keeps outcomes, named after rig, records, candidates and software (`fingerprint`).
        progress: Called with what is being done and the share that is done.
        cases: How many cases.
        minutes: When to stop with what is there.
        workers: Processes; one where candidates are the user's own, whose code lives in this process.
    """
    joblib = extra_module("joblib")
    path.parent.mkdir(parents=True, exist_ok=True)
    done = read_outcomes(path)
    if path.is_file() and path.read_bytes() != (good := b"".join(map(_line, done))):
        write_whole(path, good)
    known = {one.number for one in done}
    missing = [number for number in range(cases) if number not in known]
    began = monotonic()
    with joblib.Parallel(n_jobs=workers) as parallel, path.open("ab") as kept:
        while missing and monotonic() - began < 60 * minutes:
            spent = monotonic() - began
            left = remaining(spent, len(done) - len(known), len(missing), 60 * minutes - spent)
            progress(f"calibrating on this rig, {len(done)} of {cases} cases{left}", len(done) / cases)
            numbers, missing = missing[:workers], missing[workers:]
            for outcome in parallel(joblib.delayed(simulate)(number) for number in numbers):
                done.append(outcome)
                kept.write(_line(outcome))
            kept.flush()
    return sorted(done, key=lambda one: one.number)


def calibrated(
    found: Findings,
    folder: Path,
    simulate: Callable[[int], Outcome],
    drawn_from: Sequence[str],
    progress: Progress,
) -> list[Outcome]:
    """Return the outcomes of a diagnosis' calibration, kept in a folder under the hash of all that they depend on.

    Args:
        found: What the search found on the measured data.
        folder: Where the file is kept.
        simulate: Returns the outcome of a case.
        drawn_from: What the cases hide, and contacts as stated, in words.
        progress: Called with what is being done and the share that is done.
    """
    own = any(hasattr(one, "source") for one in found.candidates)
    path = folder / f"calibration-{fingerprint(found, drawn_from)}.jsonl"
    return calibrate(simulate, path, progress, workers=1 if own else WORKERS)


def fingerprint(found: Findings, drawn_from: Sequence[str]) -> str:
    """Return a hash of rig, records, candidates, what was found and software."""
    digest = hashlib.sha256(software_version().encode())
    for frame in found.model.structure.frames:
        digest.update(
            np.ascontiguousarray(frame.mass).tobytes() + np.ascontiguousarray(frame.stiffness).tobytes()
        )
    for run in found.model.observed.runs:
        for series in (run.table, run.measured, run.contact):
            digest.update(np.ascontiguousarray(series).tobytes())
    digest.update(" ".join(sorted(one.label() for one in found.candidates)).encode())
    digest.update(" ".join(drawn_from).encode())
    digest.update(repr(found.model.prior).encode())
    digest.update(repr((found.reference, found.model.always)).encode())
    return digest.hexdigest()[:12]


def read_outcomes(path: Path) -> list[Outcome]:
    """Return the outcomes of a file.

    A line that is damaged does not count, which is told, nor does one that an interruption cut off: its case is simulated
    anew.
    """
    if not path.is_file():
        return []
    lines = path.read_bytes().splitlines(keepends=True)
    found = [_outcome(line) for line in lines]
    if any(one is None and line.endswith(b"\n") for one, line in zip(found, lines, strict=True)):
        tell_damage(path)
    return [one for one in found if one is not None]


def _line(outcome: Outcome) -> bytes:
    return sealed(json.dumps(asdict(outcome)).encode())


def _outcome(line: bytes) -> Outcome | None:
    content = unsealed(line)
    if content is None:
        return None
    try:
        entry = json.loads(content)
        return msgspec.convert(entry | {"features": features_from(entry["features"])}, Outcome)
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return None


def hypotheses(found: Findings) -> list[Judged]:
    """Return the null model and the best single candidates of the catalogue."""
    single = [one for one in found.judged if len(one.effects) == 1 and not one.effects[0].rival]
    return [found.null, *single[: SETTINGS.calibration.rivals]]


def turn(number: int, rivals: int) -> int:
    """Return whose turn it is in a case: 0, nothing missing, in every third; from 1, the rivals in the others."""
    return 0 if number % 3 == 0 or rivals == 0 else 1 + (number - number // 3 - 1) % rivals


def simulate_and_judge(found: Findings, number: int) -> Outcome:
    """Return the outcome of the case of a number, the same whenever it is asked for."""
    tried = hypotheses(found)
    truth = tried[turn(number, len(tried) - 1)]
    model = simulated(found, truth, np.random.default_rng([number, 20261121]))
    effects = found.candidates
    again = search_beyond_errors(model, effects, found.fitted, found.held_out)
    decision = decide(again)
    right = decision.verdict == "nothing_missing"
    if truth.effects:
        claimed = [one.places for one in (decision.judged, *decision.alike)]
        right = decision.named and truth.places in claimed
    null = None if truth.effects else shown(again)
    return Outcome(number, truth.label(), right, features(again, decision), null)


def false_alarms(found: Findings, outcomes: Sequence[Outcome]) -> FalseAlarms | None:
    """Return what raises false alarms on this rig; None where too few nulls were simulated, or two frames touch.

    Args:
        found: What the search found on the measured data.
        outcomes: The simulated cases.
    """
    nulls = [one.null for one in outcomes if one.null is not None]
    if len(nulls) < SETTINGS.calibration.least_nulls:
        return None
    alarms = of_nulls(
        alarms_of(found).rate,
        [max(one.ordinary, one.absorbing) for one in nulls],
        [one.left for one in nulls],
        f"{len(nulls)} nulls simulated on this rig, under its records, with the discrepancy found",
    )
    return replace(alarms, candidates=alarms_of(found).candidates)


def simulated(found: Findings, truth: Judged, rng: np.random.Generator) -> Model:
    """Return the rig with simulated data: parameters drawn, noise as estimated, dropouts where they were measured.

    Args:
        found: What the search found.
        truth: The effects that are in the data.
        rng: Random numbers for nuisance parameters, sizes and noise.
    """
    nuisance = drawn(found.model, rng, truth.fit.filtered.discrepancy)
    return with_data_of(found.model, nuisance, scattered(truth, rng), noise_shares(found), rng)


def noise_shares(found: Findings) -> tuple[np.ndarray, float]:
    """Return the noise over the root mean square of each channel, shape (channels,), and of the table, as estimated."""
    filtered = best(found).fit.filtered
    noise, first = filtered.noise[0], found.model.observed.runs[filtered.runs[0]]
    rms = root_mean_square(first.measured)
    known = np.isfinite(noise.channel) & (rms > 0)
    # What a fit takes for noise may be what its model lacks.
    channel = np.fmin(noise.channel, first.largest_noise)
    table = min(noise.table, first.largest_table_noise)
    share = np.where(known, channel / np.where(rms > 0, rms, 1.0), 0.0)
    return share, table / float(root_mean_square(first.table))


def scattered(truth: Judged, rng: np.random.Generator) -> list[tuple[Effect, np.ndarray]]:
    """Return effects of about their fitted size, each with its SI parameters, shape (parameters,).

    Errors of the frame that the null model has act as well.
    """
    acting = []
    for effect, values in zip(truth.fit.effects, truth.fit.values, strict=True):
        changed = np.array(values, float)
        changed[effect.amplitude] *= np.exp(SETTINGS.calibration.size_scatter * rng.standard_normal())
        acting.append((effect, changed))
    return acting


def stated(conclusion: Conclusion, outcomes: Sequence[Outcome]) -> Conclusion:
    """Return a conclusion with the confidence, and what stands behind it, after a calibration on its rig."""
    right = sum(one.right for one in outcomes)
    source = (
        f"{len(outcomes)} cases simulated on this rig and its records, of which {right} were diagnosed rightly; "
        f"before them: {shipped().source}"
    )
    learnt = fit([(one.features, one.right) for one in outcomes], source, around=shipped())
    truths = dict.fromkeys(one.truth for one in outcomes)
    simulated_cases = [[one.right for one in outcomes if one.truth == truth] for truth in truths]
    behind = msgspec.structs.replace(
        conclusion.basis,
        calibration=source,
        simulated=tuple(
            SimulatedTruth(truth=truth, right=sum(each), cases=len(each))
            for truth, each in zip(truths, simulated_cases, strict=True)
        ),
    )
    return replace(conclusion, confidence=behind.confidence(learnt), basis=behind)
