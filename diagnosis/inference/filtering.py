"""The model filtered over its runs: steady filters, innovations and their likelihood, and signatures of terms."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any
from weakref import ref

import numpy as np

from pounding.diagnosis.model.kalman import Gain, Noise, SteadyFilter, steady_filter
from pounding.diagnosis.model.model import Acting, Model, Prediction
from pounding.diagnosis.model.nuisance import Assembly
from pounding.diagnosis.model.sensitivity import Term, signature_pieces
from pounding.diagnosis.model.storeys import Modes
from pounding.diagnosis.model.tangents import Along, Tangents, law_forces, tangents

AT_ONCE = 512
"""Samples whose signatures are worked out at a time: those of all terms of a long run fill the memory."""


LARGEST_SLOPE = 1e12
"""Whitened derivative from which on a simulation, or a signature, has blown up."""


class Kept:
    """A prediction that may be put away, and is made again when it is asked for: a long run's is large.

    Args:
        make: Makes it; always the same.
    """

    def __init__(self, make: Callable[[], Prediction]) -> None:
        self._make = make
        self._made: Prediction | None = None

    def __call__(self) -> Prediction:
        """Return the prediction."""
        made = self._made
        if made is None:
            self._made = made = self._make()
        return made

    def put_away(self) -> None:
        """Keep it no longer."""
        self._made = None


@dataclass(frozen=True)
class Filtered:
    """A calibrated predictor: parameter values, effects in it, noise of each run, its filters, and what they leave.

    Attributes:
        values: Nuisance parameters in their own units.
        effects: Effects that act in the runs since the reference ones, with their SI parameters.
        modes: Modes with these. run_modes: Modes of each run, those of a reference run without them.
        noise: Noise of each training run.
        filters: Steady filter of each training run.
        kept: Innovations and states of each training run, which `prediction` returns.
        log_likelihood: Log likelihood of the innovations.
        runs: Numbers of the runs used.
    """

    values: np.ndarray
    effects: tuple[tuple[Acting, np.ndarray], ...]
    modes: Modes
    run_modes: tuple[Modes, ...]
    noise: tuple[Noise, ...]
    filters: tuple[SteadyFilter, ...]
    kept: Kept
    log_likelihood: float
    runs: tuple[int, ...]

    @property
    def prediction(self) -> Prediction:
        """Innovations and states of each training run."""
        return self.kept()

    @property
    def gains(self) -> list[Gain]:
        """Filter gain of each training run."""
        return _gains(self.filters, self.run_modes)

    @property
    def discrepancy(self) -> float:
        """Scale of the model discrepancy [-]."""
        return self.noise[0].discrepancy

    def with_discrepancy(self, scale: float) -> Filtered:
        """Return the same with another scale of the model discrepancy, which is only a prior's.

        Args:
            scale: The scale [-].
        """
        return replace(self, noise=tuple(replace(one, discrepancy=scale) for one in self.noise))

    def since(self, model: Model) -> Filtered:
        """Return the same without what is of reference runs but the likelihood, which is of all."""
        since = [number for number, run in enumerate(self.runs) if model.acts(run)]
        if len(since) == len(self.runs):
            return self

        def of(series: Sequence[Any]) -> list[Any]:
            return [series[number] for number in since]

        return replace(
            self,
            run_modes=tuple(of(self.run_modes)),
            noise=tuple(of(self.noise)),
            filters=tuple(of(self.filters)),
            kept=Kept(lambda: self.prediction.of(since)),
            runs=tuple(of(self.runs)),
        )


def run_filter(
    model: Model,
    values: np.ndarray,
    noise: Sequence[Noise],
    runs: Sequence[int],
    effects: Sequence[tuple[Acting, np.ndarray]] = (),
) -> Filtered:
    """Return the filtered model with its steady filters and innovations.

    Args:
        model: The baseline model.
        values: Nuisance parameters in their own units, shape (nuisance,).
        noise: Noise of each run.
        runs: Numbers of the runs.
        effects: Effects that act, each with its SI parameters, shape (parameters,).
    """
    run_modes = tuple(modes for _, modes in model.systems(values, effects, runs))
    filters = design(model, run_modes, noise, runs)
    kept = Kept(
        partial(
            model.predict, np.array(values, float), _gains(filters, run_modes), tuple(effects), tuple(runs)
        )
    )
    return Filtered(
        values=np.array(values, float),
        effects=tuple(effects),
        modes=next((one for one, run in zip(run_modes, runs, strict=True) if model.acts(run)), run_modes[0]),
        run_modes=run_modes,
        noise=tuple(noise),
        filters=filters,
        kept=kept,
        log_likelihood=log_likelihood(model, kept().innovations, filters, runs),
        runs=tuple(runs),
    )


def _gains(filters: Sequence[SteadyFilter], run_modes: Sequence[Modes]) -> list[Gain]:
    return [Gain(steady.gain, modes) for steady, modes in zip(filters, run_modes, strict=True)]


def design(
    model: Model, modes: Sequence[Modes], noise: Sequence[Noise], runs: Sequence[int]
) -> tuple[SteadyFilter, ...]:
    """Return the steady filter of each run.

    Args:
        model: The baseline model.
        modes: Modes of each run.
        noise: Noise of each run.
        runs: Numbers of the runs.
    """
    return tuple(
        steady_filter(model.linear_system(own), one, model.observed.runs[run].step_s)
        for own, one, run in zip(modes, noise, runs, strict=True)
    )


def log_likelihood(
    model: Model,
    innovations: Sequence[np.ndarray],
    filters: Sequence[SteadyFilter],
    runs: Sequence[int],
) -> float:
    """Return the Gaussian log likelihood of the innovations, missing samples left out; -inf where the model blew up.

    Args:
        model: The baseline model.
        innovations: Innovations of each run in SI, shape (samples, channels).
        filters: Steady filter of each run.
        runs: Numbers of the runs.
    """
    total = 0.0
    white = whitened_runs(model, innovations, filters, runs)
    for series, steady, run in zip(white, filters, runs, strict=True):
        good = np.isfinite(model.observed.runs[run].measured)
        with np.errstate(over="ignore", invalid="ignore"):
            total -= 0.5 * float(np.sum(series**2))
        total -= float(np.sum(good.sum(axis=0) * np.log(np.diag(steady.factor))))
    return total if np.isfinite(total) else -np.inf


def whitened_runs(
    model: Model, series: Sequence[np.ndarray], filters: Sequence[SteadyFilter], runs: Sequence[int]
) -> list[np.ndarray]:
    """Return series of each run, (samples, channels), with the innovations' covariance divided out; zero where not measured.

    Args:
        model: The baseline model.
        series: Innovations or their derivatives of each run in SI, shape (samples, channels).
        filters: Steady filter of each run.
        runs: Numbers of the runs.
    """
    return [
        whitened(one, steady, np.isfinite(model.observed.runs[run].measured))
        for one, steady, run in zip(series, filters, runs, strict=True)
    ]


def whitened(series: np.ndarray, steady: SteadyFilter, good: np.ndarray | None = None) -> np.ndarray:
    """Return a series with the innovations' covariance divided out, of the same shape.

    Args:
        series: Innovations or their derivatives in SI, shape (samples, channels) or (samples, channels, terms).
        steady: The filter, with the covariance.
        good: Which samples were measured, shape (samples, channels); the others become zero.
    """
    factor = steady.whitening.astype(series.dtype)
    if good is not None and not good.all():
        series = np.where(good if series.ndim == 2 else good[..., None], series, 0.0)
    if series.ndim == 2:
        return np.asarray(series @ factor.T)
    return np.asarray(np.matmul(factor, series))


def run_signatures(
    model: Model, filtered: Filtered, number: int, columns: Sequence[list[Term]]
) -> np.ndarray:
    """Return whitened signatures of one run, shape (samples * channels, columns).

    Args:
        model: The baseline model.
        filtered: The filtered model.
        number: Number of the run among those of the filtered model.
        columns: For each column the terms whose signatures are summed.
    """
    whole = np.zeros((filtered.prediction.innovations[number].size, len(columns)), np.float32)
    for feedback in feedbacks(model, filtered, number):
        finite = True
        for rows, signatures in signature_pieces_of_run(model, filtered, number, columns, AT_ONCE, feedback):
            whole[rows] = signatures
            finite = finite and bool(np.all(np.abs(signatures) < LARGEST_SLOPE))
        if finite:
            break
    return whole


def feedbacks(model: Model, filtered: Filtered, number: int) -> Iterator[Tangents | None]:
    """Yield the laws that act in a run to first order, then without their answers for where signatures blow up with them.

    A filter that corrects a stuck joint may be unstable to first order. That it slips bounds it, and slopes do not see that.

    Args:
        model: The baseline model.
        filtered: The filtered model.
        number: Number of the run among those of the filtered model.
    """
    laws = tangents_of(model, filtered, number)
    yield laws
    if laws is not None:
        yield laws.unanswering()


def signature_pieces_of_run(
    model: Model,
    filtered: Filtered,
    number: int,
    columns: Sequence[list[Term]],
    piece: int,
    feedback: Tangents | None,
) -> Iterator[tuple[slice, np.ndarray]]:
    """Yield `run_signatures` of some samples at a time: which rows these are, and the rows, shape (rows, columns).

    Args:
        model: The baseline model.
        filtered: The filtered model.
        number: Number of the run among those of the filtered model.
        columns: For each column the terms whose signatures are summed.
        piece: Samples at a time.
        feedback: Forces and slopes of the laws that act; None leaves their answers out.
    """
    steady = filtered.filters[number]
    good = np.isfinite(model.observed.runs[filtered.runs[number]].measured)
    channels = good.shape[1]
    # The filter follows what faultless sensors would read; an innovation is that of the channel as it reads.
    reads = np.diag(reads_of(model, filtered, number))
    shown = steady.whitening @ reads if good.all() else reads
    first = 0
    for each in signature_pieces(steady, columns, shown, piece, feedback):
        last = first + len(each)
        seen = each if good.all() else whitened(each, steady, good[first:last])
        yield slice(first * channels, last * channels), seen.reshape(-1, each.shape[2])
        first = last


def assembly_of(
    model: Model,
    filtered: Filtered,
    number: int,
    effects: Sequence[tuple[Acting, np.ndarray]] | None = None,
) -> Assembly:
    """Return the system of a run, with the effects that act in it.

    Args:
        model: The baseline model.
        filtered: The filtered model.
        number: Number of the run among those of the filtered model.
        effects: Other effects, each with its SI parameters, shape (parameters,); those of the filtered model by default.
    """
    acting = filtered.effects if effects is None else effects
    return model.assemble(filtered.values, acting if model.acts(filtered.runs[number]) else ())


def reads_of(model: Model, filtered: Filtered, number: int) -> np.ndarray:
    """Return how much of what is true each channel reads in a run, shape (channels,).

    Args:
        model: The baseline model.
        filtered: The filtered model.
        number: Number of the run among those of the filtered model.
    """
    return np.asarray(1.0 + assembly_of(model, filtered, number).channel_gain)


def tangents_of(model: Model, filtered: Filtered, number: int) -> Tangents | None:
    """Return forces and slopes of the laws that act in a run, None where there are none.

    Args:
        model: The baseline model.
        filtered: The filtered model.
        number: Number of the run among those of the filtered model.
    """
    run, laws = filtered.runs[number], assembly_of(model, filtered, number).laws
    if not laws:
        return None
    # They are asked for several times in turn: those that were worked out last are kept, but no prediction for them.
    known = model.tangents.get(run)
    if known is None or known[0]() is not filtered.kept:
        modes = filtered.run_modes[number]
        found = tangents(laws, modes, model.linear_system(modes), _along(model, filtered, number))
        model.tangents[run] = known = ref(filtered.kept), found
    return known[1]


def forces_of(
    model: Model, filtered: Filtered, number: int, effects: Sequence[tuple[Acting, np.ndarray]]
) -> np.ndarray:
    """Return the forces of the laws that act in a run [N] with other parameters, the motion being the same.

    Args:
        model: The baseline model.
        filtered: The filtered model.
        number: Number of the run among those of the filtered model.
        effects: Its effects with these SI parameters, shape (parameters,) each.

    Returns:
        At each sample and in the middle of each substep, shape (samples, 1 + substeps, laws).
    """
    laws = assembly_of(model, filtered, number, effects).laws
    return law_forces(laws, filtered.run_modes[number], _along(model, filtered, number))


def _along(model: Model, filtered: Filtered, number: int) -> Along:
    made = filtered.prediction
    step_s = model.observed.runs[filtered.runs[number]].step_s
    return Along(made.before[number], made.after[number], made.middles[number], step_s)


def whitened_innovations(model: Model, filtered: Filtered) -> list[np.ndarray]:
    """Return the whitened innovations of each run, shape (samples * channels,)."""
    innovations = filtered.prediction.innovations
    return [white.ravel() for white in whitened_runs(model, innovations, filtered.filters, filtered.runs)]
