"""Which further measurement of shaken frames would part what the data cannot, by simulation.

One of two rivals is taken for true and makes the data of a further measurement; the other predicts them with the filter that
it would have, and is allowed to bend its size and the nuisance parameters to imitate (linearised, inside their priors).
Half the squared innovations that then remain, less those of the measurement as it was, are the ln Bayes factor that the
further measurement is expected to bring.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

from pounding.diagnosis.decision.decision import Decision
from pounding.diagnosis.design.contenders import Advice, Gain, advised, contenders
from pounding.diagnosis.inference.coordinates import Coordinates
from pounding.diagnosis.inference.filtering import (
    run_filter,
    whitened_innovations,
)
from pounding.diagnosis.inference.findings import Findings, Judged
from pounding.diagnosis.inference.histories import Histories
from pounding.diagnosis.inference.refine import Fit
from pounding.diagnosis.inference.refining import widths
from pounding.diagnosis.model.kalman import Noise
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import RunData, root_mean_square
from pounding.diagnosis.model.predictor import ACCELERATION, DISPLACEMENT
from pounding.diagnosis.model.storeys import Structure
from pounding.diagnosis.settings import SETTINGS


@dataclass(frozen=True)
class Measurement:
    """A further measurement.

    Attributes:
        what: In words.
        model: The model with this measurement's channels, runs and known weights.
        noise: Of each channel in SI.
        more: Whether it is a run beside the existing one; else the same run with more channels.
    """

    what: str
    model: Model
    noise: np.ndarray
    more: bool


def rivals(found: Findings, decision: Decision) -> tuple[Judged, Judged] | None:
    """Return the best candidate and the one that is hardest to tell from it, or None where the verdict is clear."""
    if decision.verdict == "unknown_effect" or not found.judged:
        return None
    first = decision.judged if decision.named else found.judged[0]
    if decision.alike:
        return first, decision.alike[0]
    others = [
        (one.ln_bayes, one)
        for one in found.judged
        if len(one.effects) == len(first.effects) and one.places != first.places
    ]
    return contenders((first.ln_bayes, first), others, found.null, decision.named)


def advice(found: Findings, decision: Decision) -> list[Advice]:
    """Return what to say of the further measurements that would part the rivals, best first; none for a clear verdict."""
    return advised(
        rivals(found, decision), Judged.label, lambda true, other: expected(found, true.fit, other.fit)
    )


def expected(found: Findings, true: Fit, other: Fit) -> list[Gain]:
    """Return what each further measurement is expected to bring, most first.

    Args:
        found: What the search found.
        true: The rival that is taken for true.
        other: The rival that tries to imitate it.
    """
    began = perf_counter()
    now = as_it_was(found)
    # What a run of the frame as it was before says of the nuisance parameters stays known.
    before = [_normal(as_it_was(found, run), true, other, found) for run in found.reference[:1]]
    base = _sum(_normal(now, true, other, found), *before)
    left = _unexplained(base)
    gains = []
    for one in measurements(found, now):
        if perf_counter() - began > SETTINGS.design.seconds:
            break
        normal = _normal(one, true, other, found)
        total = _unexplained(_sum(normal, base) if one.more else _sum(normal, *before))
        gains.append(Gain(one.what, total - left))
    return sorted(gains, key=lambda gain: -gain.ln_bayes)


def measurements(found: Findings, now: Measurement) -> Iterator[Measurement]:
    """Yield the further measurements that are tried: channels, amplitudes, another motion, a weight on the roof."""
    model, run = now.model, now.model.observed.runs[0]
    for size, words in ((2.0, "twice"), (0.5, "half")):
        louder = replace(run, table=size * run.table)
        yield _with_run(now, louder, f"the same shaking at {words} its amplitude")
    yield _with_run(now, _other_motion(run), "broadband noise of the same peak on the table")
    structure = model.structure
    for number, frame in enumerate(structure.frames):
        mass = frame.mass.copy()
        weight = SETTINGS.design.weight * float(frame.floor_mass.sum())
        mass[-1, -1] += weight
        heavier = Structure(
            tuple(replace(f, mass=mass) if i == number else f for i, f in enumerate(structure.frames))
        )
        loaded = Model(heavier, model.observed, model.prior, model.always)
        yield Measurement(
            f"the same shaking with {weight:.2g} kg on the roof of {frame.name}", loaded, now.noise, True
        )
    yield from _channels(now)


def _channels(now: Measurement) -> Iterator[Measurement]:
    seen, known = now.model.observed, np.isfinite(now.noise)
    present = {(int(q), int(f)) for q, f in zip(seen.quantity[known], seen.floor[known], strict=True)}
    simulated = now.model.predict(np.zeros(len(now.model.std)), None, (), [0])
    for kind, words in ((ACCELERATION, "accelerometer on"), (DISPLACEMENT, "displacement sensor at")):
        for floor in range(now.model.structure.floors):
            if (kind, floor) in present:
                continue
            frame, number = now.model.structure.place(floor)
            run = seen.runs[0]
            blank = np.zeros((len(run.table), len(seen.names) + 1))
            wider = replace(
                seen,
                names=(*seen.names, "further"),
                to_si=np.append(seen.to_si, 1.0),
                quantity=np.append(seen.quantity, kind),
                floor=np.append(seen.floor, floor),
                runs=(replace(run, measured=blank),),
            )
            model = now.model.seeing(wider)
            rms = float(
                root_mean_square(model.predict(np.zeros(len(model.std)), None, (), [0]).outputs[0])[-1]
            )
            alike = np.flatnonzero(known & (seen.quantity == kind))
            share = SETTINGS.design.noise
            if len(alike):
                shown = root_mean_square(simulated.outputs[0])[alike]
                share = float(np.median(now.noise[alike] / np.maximum(shown, 1e-12)))
            what = (
                f"an {words} floor {number} of {frame}"
                if kind == ACCELERATION
                else f"a {words} floor {number} of {frame}"
            )
            yield Measurement(what, model, np.append(now.noise, min(share, 1.0) * rms), False)


def as_it_was(found: Findings, number: int | None = None) -> Measurement:
    """Return what was measured: a run, cut to `design.longest_s` of the settings.

    What is infinitely noisy was not measured; its channel stays, for effects know channels by their number.

    Args:
        found: What the search found.
        number: Number of a run that was fitted, the first training run by default.
    """
    seen, fitted = found.model.observed, found.null.fit.filtered
    number = found.training[0] if number is None else number
    run = seen.runs[number]
    samples = min(len(run.table), int(SETTINGS.design.longest_s / run.step_s))
    noise = np.asarray(fitted.noise[fitted.runs.index(number)].channel, float)
    cut = replace(
        run,
        table=run.table[:samples],
        time_s=run.time_s[:samples],
        measured=np.zeros((samples, len(noise))),
        contact=run.contact[:samples],
    )
    return Measurement("as it was", found.model.seeing(replace(seen, runs=(cut,))), noise, False)


def _with_run(now: Measurement, run: RunData, what: str) -> Measurement:
    observed = replace(now.model.observed, runs=(run,))
    return Measurement(what, now.model.seeing(observed), now.noise, True)


def _other_motion(run: RunData) -> RunData:
    """Return a run of band-limited noise with the same peak and length."""
    rng = np.random.default_rng(0)
    spectrum = np.fft.rfft(rng.standard_normal(len(run.table)))
    frequency = np.fft.rfftfreq(len(run.table), run.step_s)
    shaped = np.fft.irfft(spectrum * np.exp(-((frequency / 30.0) ** 4)), len(run.table))
    shaped *= np.sin(np.linspace(0, np.pi, len(shaped))) ** 0.5
    return replace(run, table=shaped * np.abs(run.table).max() / np.abs(shaped).max())


Normal = tuple[np.ndarray, np.ndarray, float]


def _normal(one: Measurement, true: Fit, other: Fit, found: Findings) -> Normal:
    """Return Gauss-Newton matrix, slope and sum of squares of the imitator on the data that the true rival makes."""
    model = one.model
    made = model.predict(
        model.carried(found.model, true.filtered.values), None, true.filtered.effects, [0]
    ).outputs[0]
    run = replace(model.observed.runs[0], measured=np.where(np.isfinite(one.noise), made, np.nan))
    model = model.seeing(replace(model.observed, runs=(run,)))
    known = other.filtered.noise[0]
    noise = Noise(np.asarray(known.latent), known.table, one.noise, known.discrepancy)
    filtered = run_filter(
        model, model.carried(found.model, other.filtered.values), [noise], [0], other.filtered.effects
    )
    widths_of = [
        widths(found.model, effect, found.sizes, effect.grid(found.sizes)[0]) for effect in other.effects
    ]
    coordinates = Coordinates.of(model, other.effects, other.values, widths_of, discrepancy=known.discrepancy)
    histories = Histories(model, filtered, coordinates)
    columns = histories.effect_columns(coordinates.theta(filtered.values))[0]
    # A channel that only this measurement has brings gain and delay of its own: they are no part of the other's matrix.
    shared = [j for j, parameter in enumerate(model.parameters) if not parameter.kind.startswith("channel")]
    both = np.hstack([histories.nuisance_columns()[0][:, shared], columns]).astype(float)
    residual = whitened_innovations(model, filtered)[0]
    return both.T @ both, both.T @ residual, float(residual @ residual)


def _sum(one: Normal, *others: Normal) -> Normal:
    for other in others:
        one = one[0] + other[0], one[1] + other[1], one[2] + other[2]
    return one


def _unexplained(normal: Normal) -> float:
    """Return half the squares that remain when the imitator has bent all it may."""
    gram, slope, squares = normal
    return 0.5 * float(squares - slope @ np.linalg.solve(gram + np.eye(len(gram)), slope))
