"""Histories as a term of the inference: whitened innovations of the steady filter, run by run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from weakref import ref

import numpy as np

from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.coordinates import Coordinates
from pounding.diagnosis.inference.filtering import (
    LARGEST_SLOPE,
    Filtered,
    forces_of,
    run_filter,
    run_signatures,
    tangents_of,
    whitened_innovations,
    whitened_runs,
)
from pounding.diagnosis.inference.motions import motion_of, motions
from pounding.diagnosis.inference.posterior import PIECE, Likelihood, add_products, product
from pounding.diagnosis.model.model import Acting, Model
from pounding.diagnosis.model.sensitivity import Term
from pounding.diagnosis.model.side_by_side import side_by_side
from pounding.diagnosis.model.terms import nuisance_terms
from pounding.diagnosis.settings import SETTINGS


class Histories(Likelihood):
    """The runs' innovations about a filtered model, whose gains stay while a step is judged.

    Were gain and innovation covariance to follow the parameters, a likelihood with too large a latent force would be
    improved by modes that shrink it rather than by ones that fit.
    """

    def __init__(
        self,
        model: Model,
        filtered: Filtered,
        coordinates: Coordinates,
        nuisance_columns: list[np.ndarray] | None = None,
        gram: np.ndarray | None = None,
    ) -> None:
        """Take the model, its filter at the parameters in question, and how these follow from theta.

        Args:
            model: The baseline model.
            filtered: The filtered model.
            coordinates: Nuisance parameters and effects.
            nuisance_columns: For each run whitened signatures of the nuisance parameters, shape (samples * channels,
                nuisance), from a filter near this one, which are good enough.
            gram: Products of these columns, shape (nuisance, nuisance).
        """
        self.model, self.filtered, self.coordinates = model, filtered, coordinates
        self._fresh = nuisance_columns is None
        self._columns = nuisance_columns
        self._effects: tuple[bytes, list[np.ndarray]] | None = None
        self._gram = gram
        if nuisance_columns is not None:
            self._hold()

    @property
    def log_normaliser(self) -> float:
        """Log likelihood of the innovations beyond half their sum of squares."""
        return self.filtered.log_likelihood + self._half_squares(self.filtered.prediction.innovations)

    def cost(self, theta: np.ndarray) -> float:
        """Return half the sum of squares of the whitened innovations, with the filter's gains as they are."""
        nuisance, acting = self.coordinates.nuisance(theta), self.coordinates.acting(theta)
        if self._is_here(nuisance, acting):
            return self._half_squares(self.filtered.prediction.innovations)
        gains = self.filtered.gains
        return self._half_squares(
            self.model.predict(nuisance, gains, acting, self.filtered.runs, whole=False).innovations
        )

    def slope_from(self, theta: np.ndarray, there: np.ndarray) -> np.ndarray:
        """Return the slope of innovations at another point by the signatures at theta; gains are the filter's."""
        coordinates = self.coordinates
        gains = self.filtered.gains
        innovations = self.model.predict(
            coordinates.nuisance(there), gains, coordinates.acting(there), self.filtered.runs, whole=False
        ).innovations
        slope = np.zeros(len(theta))
        with np.errstate(over="ignore", invalid="ignore"):
            for white, (_, nuisance, own) in zip(self._white(innovations), self.columns(theta), strict=True):
                residual = white.ravel()
                slope += np.concatenate([product(nuisance, residual), product(own, residual)])
        return slope

    def _is_here(self, nuisance: np.ndarray, acting: Sequence[tuple[Acting, np.ndarray]]) -> bool:
        """Return whether the filter was run with just these parameters."""
        own = self.filtered.effects
        return (
            np.array_equal(nuisance, self.filtered.values)
            and len(own) == len(acting)
            and all(
                one[0] == other[0] and np.array_equal(one[1], other[1])
                for one, other in zip(own, acting, strict=True)
            )
        )

    def _half_squares(self, innovations: Sequence[np.ndarray]) -> float:
        # A trial step may well blow up: it costs infinitely much, and is not taken.
        with np.errstate(over="ignore", invalid="ignore"):
            return sum(0.5 * float(np.sum(white**2)) for white in self._white(innovations))

    def _white(self, series: Sequence[np.ndarray]) -> list[np.ndarray]:
        return whitened_runs(self.model, series, self.filtered.filters, self.filtered.runs)

    def blocks(self, theta: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Yield whitened innovations and signatures of each run."""
        for residual, nuisance, own in self.columns(theta):
            yield residual, np.hstack([nuisance, own])

    def columns(self, theta: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Yield whitened innovations (n,) and signatures (n, nuisance), (n, effects' coordinates) of each run.

        Args:
            theta: Nuisance parameters and effects in units of their priors, shape (parameters,).
        """
        residuals = whitened_innovations(self.model, self.filtered)
        yield from zip(residuals, self.nuisance_columns(), self.effect_columns(theta), strict=True)

    def settled(self, theta: np.ndarray) -> Histories | None:
        """Return the term with the filter run again at `theta`, None if that is much less likely."""
        filtered = run_filter(
            self.model,
            self.coordinates.nuisance(theta),
            self.filtered.noise,
            self.filtered.runs,
            self.coordinates.acting(theta),
        )
        if filtered.log_likelihood < self.filtered.log_likelihood - SETTINGS.refinement.worse:
            return None
        # The nuisance parameters' signatures are good for one step more, and needed here no more.
        kept = (self._columns, self._gram) if self._fresh else (None, None)
        self._columns = self._gram = self._effects = None
        return Histories(self.model, filtered, self.coordinates, *kept)

    def fresh(self) -> Histories:
        """Return the term with the nuisance parameters' signatures of its own filter, itself if it has no others."""
        return self if self._fresh else Histories(self.model, self.filtered, self.coordinates)

    def normal_equations(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return information and slope of the data; what the nuisance parameters have among themselves is kept."""
        own = len(self.coordinates.scale)
        gram, slope = np.zeros((len(theta), len(theta))), np.zeros(len(theta))
        if self._gram is None:
            self._gram = np.zeros((own, own))
            for columns in self.nuisance_columns():
                add_products(self._gram, np.zeros(own), columns, np.zeros(len(columns)))
        gram[:own, :own] = self._gram
        residuals = whitened_innovations(self.model, self.filtered)
        effects = self.effect_columns(theta)
        for residual, nuisance, acting in zip(residuals, self.nuisance_columns(), effects, strict=True):
            wide = acting.astype(float)
            both = np.column_stack([wide, residual])
            gram[own:, own:] += wide.T @ wide
            slope[own:] += wide.T @ residual
            crossed = np.zeros((own, both.shape[1]))
            for first in range(0, len(nuisance), PIECE):
                crossed += nuisance[first : first + PIECE].astype(float).T @ both[first : first + PIECE]
            gram[:own, own:] += crossed[:, :-1]
            slope[:own] += crossed[:, -1]
        gram[own:, :own] = gram[:own, own:].T
        return gram, slope

    def nuisance_columns(self) -> list[np.ndarray]:
        """Return whitened signatures of the nuisance parameters in units of their priors, (samples * channels, nuisance)."""
        if self._columns is None:
            self._hold()
            self._columns = side_by_side(self._nuisance_columns, range(len(self.filtered.runs)))
        return self._columns

    def _nuisance_columns(self, number: int) -> np.ndarray:
        """Return those of one run, whose terms are much memory, too, and are needed for nothing else."""
        model, filtered = self.model, self.filtered
        terms = nuisance_terms(model, filtered.run_modes[number], motion_of(model, filtered, number))
        columns = run_signatures(model, filtered, number, terms)
        columns *= self.coordinates.scale.astype(columns.dtype)
        return columns

    def _hold(self) -> None:
        """Let no others keep such signatures, the larger part of a diagnosis' memory: who asks makes them again."""
        other = self.model.histories()
        if isinstance(other, Histories) and other is not self:
            other._let_go()
        self.model.histories = ref(self)

    def _let_go(self) -> None:
        """Keep the signatures no longer; those that are made when they are asked for again are this filter's own."""
        if self._columns is not None:
            self._fresh, self._columns, self._gram = True, None, None

    def effect_columns(self, theta: np.ndarray) -> list[np.ndarray]:
        """Return for each run whitened signatures of the effects' coordinates, (samples * channels, coordinates).

        Args:
            theta: Nuisance parameters and effects in units of their priors, shape (parameters,).
        """
        key = theta[len(self.coordinates.scale) :].tobytes()
        if self._effects is None or self._effects[0] != key:
            self._effects = key, self._effect_columns(theta)
        return self._effects[1]

    def _effect_columns(self, theta: np.ndarray) -> list[np.ndarray]:
        model, filtered, coordinates = self.model, self.filtered, self.coordinates
        found = [
            np.zeros((series.size, len(coordinates.start)), np.float32)
            for series in filtered.prediction.innovations
        ]
        slopes = coordinates.slopes(theta)
        terms: dict[int, list[list[Term]]] = {}
        first = 0
        for effect in coordinates.effects:
            for j in range(first, first + len(effect.quantities)):
                if effect.linear:
                    terms[j] = self._linear_terms(effect)
                    continue
                acting, delta = self._nudged(theta, j)
                slopes[j] = 1.0
                by_force = self._law_terms(acting, delta)
                if by_force is not None:
                    terms[j] = by_force
                    continue
                for store, column in zip(found, self._difference(acting, delta), strict=True):
                    store[:, j] = column
            first += len(effect.quantities)
        which = list(terms)
        for number, store in enumerate(found):
            groups = [terms[j][number] for j in which]
            if any(groups):
                store[:, which] = run_signatures(model, filtered, number, groups) * slopes[which].astype(
                    np.float32
                )
        return found

    def _linear_terms(self, effect: Effect) -> list[list[Term]]:
        """Return the terms of a linear effect in each run.

        As the nuisance parameters' columns are made: two that mean the same must not differ by an approximation.
        """
        model, filtered = self.model, self.filtered
        both = zip(filtered.runs, filtered.run_modes, motions(model, filtered), strict=True)
        return [
            effect.terms(model, modes, motion, ()) if model.acts(run) else [] for run, modes, motion in both
        ]

    def _nudged(self, theta: np.ndarray, number: int) -> tuple[tuple[tuple[Acting, np.ndarray], ...], float]:
        """Return the effects as they act with a little more of one of their coordinates, and how much more."""
        delta = self.coordinates.nudge(theta, number)
        moved = theta.copy()
        moved[len(self.coordinates.scale) + number] += delta
        return self.coordinates.acting(moved), delta

    def _law_terms(
        self, acting: tuple[tuple[Acting, np.ndarray], ...], delta: float
    ) -> list[list[Term]] | None:
        """Return the terms of a small change that is one of laws alone, in each run; None where it changes more.

        As above: what yields of a storey and the storey's stiffness are nearly the same, and a valley lies between them.
        """
        model, filtered = self.model, self.filtered
        here, there = (model.assemble(filtered.values, one) for one in (filtered.effects, acting))
        if not here.differs_in_laws_alone(there):
            return None
        found: list[list[Term]] = []
        for number, innovations in enumerate(filtered.prediction.innovations):
            laws = tangents_of(model, filtered, number) if model.acts(filtered.runs[number]) else None
            if laws is None:
                found.append([])
                continue
            # A law's force opposes the motion.
            change = (laws.forces - forces_of(model, filtered, number, acting)) / delta
            found.append([Term(np.zeros(len(innovations)), change=change)])
        return found

    def _difference(self, acting: Sequence[tuple[Acting, np.ndarray]], delta: float) -> list[np.ndarray]:
        """Return for each run the whitened derivative by a small change of the effects that act, (n,)."""
        filtered = self.filtered
        prediction = self.model.predict(filtered.values, filtered.gains, acting, filtered.runs, whole=False)
        both = zip(filtered.prediction.innovations, prediction.innovations, strict=True)
        with np.errstate(over="ignore", invalid="ignore"):
            columns = [
                white.ravel() for white in self._white([(here - there) / delta for here, there in both])
            ]
        # A model that blows up at the small change has no slope there.
        return [one if np.all(np.abs(one) < LARGEST_SLOPE) else np.zeros_like(one) for one in columns]
