"""What changes of a model do to the channels: of its nuisance parameters, of an effect, of its discrepancy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.coordinates import Coordinates
from pounding.diagnosis.inference.filtering import Filtered
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.inference.misfit import levelled, simulate
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import root_mean_square
from pounding.diagnosis.model.side_by_side import side_by_side

PROBE = 0.1
"""Prior standard deviations by which a nuisance parameter is moved to see what it does to the channels."""


@dataclass(frozen=True)
class Sight:
    """What changes of a model do to the channels of the strongest run, in units of their noise.

    Attributes:
        model, filtered: The baseline model, and the fit about which it is changed.
        run: Number of the run.
        output: Its simulated channels in SI, shape (samples, channels).
        noise: Noise of each channel in SI, shape (channels,); infinite where nothing was measured.
        nuisance: What a prior standard deviation of each nuisance parameter adds, shape (samples * channels, nuisance).
        gram: Information of it, shape (nuisance, nuisance).
        before: Information of the strongest reference run, in which effects do not act, of the same shape.
    """

    model: Model
    filtered: Filtered
    run: int
    output: np.ndarray
    noise: np.ndarray
    nuisance: np.ndarray
    gram: np.ndarray
    before: np.ndarray

    @classmethod
    def of(cls, found: Findings, filtered: Filtered) -> Sight:
        """Return what changes do about a fit."""
        run = _strongest(found.model, found.training)
        output, noise, nuisance = _columns(found, filtered, run)
        gram, before = nuisance.T @ nuisance, np.zeros((nuisance.shape[1],) * 2)
        if found.reference:
            *_, known = _columns(found, filtered, _strongest(found.model, found.reference))
            before = known.T @ known
        return cls(found.model, filtered, run, output, noise, nuisance, gram, before)

    def of_effect(self, effect: Effect, values: np.ndarray) -> float:
        """Return the rms of what an effect adds to the channel where it shows most, in units of the noise.

        Args:
            effect: The effect.
            values: Its SI parameters, shape (parameters,).
        """
        acting = [*self.filtered.effects, (effect, values)]
        with np.errstate(over="ignore", invalid="ignore"):
            changed = simulate(self.model, self.filtered.values, acting, [self.run])[0]
            change = ((changed - self.output) / self.noise).ravel()
        if not np.isfinite(change).all():
            return 0.0
        scale = self.filtered.discrepancy
        start = self.filtered.values / self.model.spread(scale)
        imitation = Coordinates.of(self.model, (), (), (), discrepancy=scale).posterior(())
        left = change - self.nuisance @ imitation.step(
            self.gram + self.before, self.nuisance.T @ change + start, start, 0.0
        )
        return float(root_mean_square(left.reshape(self.output.shape)).max())

    def discrepancy(self, frame: str | None = None) -> float:
        """Return how far the frame is from the model in ways that no parameter of a storey gives, as a share of the motion.

        It is the rms of what the discrepancy adds after all other nuisance parameters imitated what they can, over that of
        the motion, both in units of the channels' noise.

        Args:
            frame: Name of the frame whose channels count; when None all do.
        """
        ours = self.model.discrepant
        if not ours.any():
            return 0.0
        size = self.filtered.values / self.model.spread(self.filtered.discrepancy)
        added, others = self.nuisance[:, ours] @ size[ours], self.nuisance[:, ~ours]
        information = self.gram[np.ix_(~ours, ~ours)] + np.eye(int((~ours).sum()))
        left = added - others @ np.linalg.solve(information, others.T @ added)
        counted = slice(None) if frame is None else self.model.at_frame(self.model.structure.index(frame))
        left, moved = (
            each.reshape(self.output.shape)[:, counted] for each in (left, self.output / self.noise)
        )
        return float(np.sqrt(np.sum(left**2) / np.sum(moved**2)))

    def linear_share(self) -> float:
        """Return which part of the power that remains above the noise other stiffness, mass and damping would take away."""
        data = self.model.observed.runs[self.run]
        left = levelled(self.model, data.measured - self.output, data.step_s) / self.noise
        left = np.nan_to_num(left).ravel()
        fitted, *_ = np.linalg.lstsq(self.nuisance, left, rcond=1e-8)
        noise = float(np.isfinite(data.measured).sum())
        above = float(left @ left) - noise
        taken = (
            float(left @ left) - float(np.sum((left - self.nuisance @ fitted) ** 2)) - self.nuisance.shape[1]
        )
        return taken / above if above > 0 else 1.0


def _strongest(model: Model, runs: Sequence[int]) -> int:
    return max(runs, key=lambda number: float(root_mean_square(model.observed.runs[number].table)))


def _columns(found: Findings, filtered: Filtered, run: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return a run's simulated channels, their noise, and what a prior deviation of each nuisance parameter adds."""
    model = found.model
    rms = np.nan_to_num(model.observed.rms(model.observed.runs[run]), nan=np.inf)
    noise = np.nan_to_num(found.floor[0], nan=np.inf) * np.where(rms > 0, rms, np.inf)
    noise = noise * np.sqrt(model.observed.slower)
    output = simulate(model, filtered.values, filtered.effects, [run])[0]

    probes = PROBE * np.diag(model.spread(filtered.discrepancy))
    columns = np.empty((len(probes), output.size))

    def fill(number: int) -> None:
        changed = simulate(model, filtered.values + probes[number], filtered.effects, [run])[0]
        columns[number] = ((changed - output) / noise).ravel() / PROBE

    side_by_side(fill, range(len(probes)))
    return output, noise, columns.T
