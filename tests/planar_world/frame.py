"""The frame of a case as it is: near the baseline model, but of another construction and another damping."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq, least_squares

from tests.planar_world import damping
from tests.planar_world.baseline import STOREYS, Baseline, Real, baseline_of, modes
from tests.planar_world.plane_frame import Build, matrices
from tests.planar_world.structure import Structure

FITTED_MODES = 4
"""Modes on which a build is tuned; the first counts most."""
FIRST_MODE = 30.0
"""Weight of the first mode in it, over each of the others."""
PLAIN_FITTING = 2e5
"""Stiffness of end fittings where nothing is said of them [N m/rad]."""
JOINT_SCATTER, MASS_SCATTER, COLUMN_SCATTER = 0.05, 0.003, 0.01
"""Standard deviations between the joints of a frame, its floors' masses, and the stiffnesses of its storeys [-]."""
MOST_SCATTER = 1.2
"""Strength beyond which the joints of a strange construction do not scatter more [-]."""
COLUMNS_OF_A_STOREY = 1.4
"""Columns must differ by so much more than their storeys, because joints turn and share in a storey's drift [-]."""
FREQUENCY_SCATTER, MOST_OFF = 0.006, 0.012
"""Standard deviation of all frequencies together from the baseline model's, and by how much they are off at most [-]."""
RATIO_SCATTER, MODE_SCATTER = 0.10, 0.05
"""The same of all damping ratios together, and of each mode's where they have ratios of their own [-]."""


@dataclass(frozen=True)
class Style:
    """A construction that the baseline model does not know; what is None is as usual.

    Attributes:
        damping: Recipe of the damping.
        fitting: Stiffness of the columns' end fittings [N m/rad].
        foot: Factor on the joint at the table [-].
        roof: Factor on the joint at the roof [-].
        weight: Share of the weight that softens the columns [-].
    """

    damping: damping.Recipe
    fitting: float | None = None
    foot: float | None = None
    roof: float | None = None
    weight: float | None = None

    def of_strength(self, strength: float) -> Style:
        """Return the style with its differences larger or smaller: none at 0, as they are at 1 [-]."""

        def factor(value: float | None) -> float | None:
            return None if value is None else float(np.clip(value**strength, 0.35, 5))

        fitting = PLAIN_FITTING
        if self.fitting is not None:
            between = np.log(self.fitting) * strength + np.log(PLAIN_FITTING) * (1 - strength)
            fitting = max(np.exp(between), 5e3)
        weight = None if self.weight is None else float(np.clip(1 + (self.weight - 1) * strength, 0.3, 1.5))
        return Style(self.damping, float(fitting), factor(self.foot), factor(self.roof), weight)

    def build(self, joint: float) -> Build:
        """Return a build in this style with joints of a stiffness [N m/rad]."""
        foot, roof, weight = (1.0 if one is None else one for one in (self.foot, self.roof, self.weight))
        fitting = PLAIN_FITTING if self.fitting is None else self.fitting
        return Build(joint, fitting=fitting, foot=foot, roof=roof, weight=weight)


@dataclass(frozen=True)
class Frame:
    """A frame without any effect.

    Attributes:
        name: As in the project.
        style: Its construction, for the truth.
        build: The same with the scatter of this frame.
        scale: Factor on its stiffness [-].
        scatter: Of the columns' stiffnesses, before it is enlarged (storeys,) [-].
        damping: (floors, floors) [N s/m].
        ratios: Damping ratios of its modes (modes,) [-].
    """

    name: str
    style: Style
    build: Build
    scale: float
    scatter: Real
    damping: Real
    ratios: Real

    @property
    def storeys(self) -> int:
        """Number of storeys."""
        return STOREYS[self.name]

    def matrices(
        self, storeys: Real | None = None, joint: float = 1.0, rocking: float | None = None
    ) -> tuple[Real, Real]:
        """Return mass (floors, floors) [kg] and stiffness (floors, floors) [N/m], with an effect or without.

        Args:
            storeys: Factors on each storey's columns (storeys,) [-].
            joint: Factor on all joints [-].
            rocking: Stiffness against rocking of the foot [N m/rad]; it does not rock where None.
        """
        build = replace(self.build, joint=self.build.joint * joint)
        mass, stiffness = matrices(baseline_of(self.name), build, storeys, rocking)
        return mass, stiffness * self.scale

    def structure(self) -> Structure:
        """Return what is shaken when nothing is hidden."""
        mass, stiffness = self.matrices()
        return Structure(mass, self.damping, stiffness)

    def relative_change(self, storey: int, factor: float) -> float:
        """Return the change of a storey [-] as the catalogue states it, by a factor on its columns [-].

        It is the projection of the change of the stiffness matrix on the pattern of the storey in the baseline model,
        because the end fittings and the floors that bend spread the change over the neighbours.
        """
        factors = np.ones(self.storeys)
        factors[storey - 1] = factor
        change = self.matrices(storeys=factors)[1] - self.matrices()[1]
        pattern = baseline_of(self.name).patterns[storey - 1]
        return float((change * pattern).sum() / (pattern * pattern).sum())

    def columns_factor(self, storey: int, change: float) -> float:
        """Return the factor on a storey's columns [-] that makes a change of it as the catalogue states it [-]."""
        found: float = brentq(lambda factor: self.relative_change(storey, factor) - change, 0.2, 1.5)
        return found


def tuned(baseline: Baseline, build: Build) -> tuple[float, float]:
    """Return joint stiffness [N m/rad] and columns' factor [-] with which a build has the baseline frequencies.

    Columns are clear over less than a storey's height, so their factor may differ from one.
    """
    expected = baseline.frequencies()

    def misses(logarithms: Real) -> Real:
        columns = np.full(len(baseline.mass), np.exp(logarithms[1]))
        found = modes(*matrices(baseline, replace(build, joint=np.exp(logarithms[0]), columns=columns)))[0]
        upper = found[1:FITTED_MODES] / expected[1:FITTED_MODES] - 1
        weighed: Real = np.r_[FIRST_MODE * (found[0] / expected[0] - 1), upper]
        return weighed

    fitted = least_squares(misses, [np.log(3500.0), 0.05])
    return float(np.exp(fitted.x[0])), float(np.exp(fitted.x[1]))


def drawn_frame(
    name: str, rng: np.random.Generator, style: Style | None = None, strength: float = 1.0
) -> Frame:
    """Draw a frame, tuned to the baseline frequencies and then scattered.

    Args:
        name: As in the project.
        rng: Source of chance.
        style: A construction that the baseline model cannot follow; an ordinary one where None.
        strength: Of the style [-].
    """
    baseline = baseline_of(name)
    made = _ordinary(rng) if style is None else style.of_strength(strength)
    joint, columns = tuned(baseline, made.build(1.0))
    apart = JOINT_SCATTER if style is None else JOINT_SCATTER * min(strength, MOST_SCATTER)
    build, scatter = _scattered(made.build(joint), columns, apart, STOREYS[name], rng)
    scale = (1 + np.clip(rng.normal() * FREQUENCY_SCATTER, -MOST_OFF, MOST_OFF)) ** 2
    ratios = baseline.ratios * (1 + RATIO_SCATTER * np.clip(rng.normal(), -1.8, 1.8))
    recipe = damping.USUAL[rng.integers(len(damping.USUAL))] if style is None else style.damping
    mass, stiffness = matrices(baseline, build)
    stiffness = stiffness * scale
    if recipe == "joints":
        losses = _Losses.drawn(rng, STOREYS[name], style is None, strength)
        damped = _damped_by_joints(baseline, build, scale, ratios, losses)
    else:
        ratios = _ratios(recipe, ratios, modes(mass, stiffness)[0], strength, rng)
        damped = damping.modal(mass, stiffness, ratios)
    found = damping.ratios_of(mass, stiffness, damped)
    return Frame(name, replace(made, damping=recipe), build, scale, scatter, damped, found)


def _scattered(
    build: Build, columns: float, apart: float, storeys: int, rng: np.random.Generator
) -> tuple[Build, Real]:
    """Return a build whose joints, masses and columns differ from each other, and the scatter of the columns [-]."""
    joints = 1 + apart * rng.normal(size=storeys + 1)
    masses = 1 + MASS_SCATTER * rng.normal(size=storeys)
    scatter = COLUMN_SCATTER * rng.normal(size=storeys)
    factors = columns * (1 + COLUMNS_OF_A_STOREY * scatter)
    return replace(build, columns=factors, joints=joints, masses=masses), scatter


def _ratios(
    recipe: damping.Recipe, ratios: Real, frequencies: Real, strength: float, rng: np.random.Generator
) -> Real:
    """Return the damping ratios (modes,) [-] by a recipe, but for that of the joints."""
    if recipe == "caughey":
        scattered: Real = ratios * (1 + MODE_SCATTER * rng.normal(size=len(ratios)))
        return scattered
    if recipe == "mildrayleigh":
        return damping.mild_rayleigh(ratios, frequencies)
    return damping.rayleigh(ratios, frequencies, strength)


def _ordinary(rng: np.random.Generator) -> Style:
    """Return an ordinary construction; its recipe of damping is drawn later."""
    fitting = np.exp(rng.uniform(np.log(1.2e4), np.log(3e5)))
    foot, weight, roof = rng.uniform(0.75, 1.6), rng.uniform(0.85, 1.1), rng.uniform(0.85, 1.1)
    return Style("caughey", fitting=fitting, foot=foot, roof=roof, weight=weight)


@dataclass(frozen=True)
class _Losses:
    """How much of the damping is the joints' [-], and the weight of each floor's joints in it (storeys + 1,) [-]."""

    share: float
    weights: Real

    @classmethod
    def drawn(cls, rng: np.random.Generator, storeys: int, ordinary: bool, strength: float) -> _Losses:
        if ordinary:
            return cls(0.35, rng.uniform(0.6, 1.4, storeys + 1))
        return cls(min(0.6 * strength, 0.85), np.exp(rng.normal(size=storeys + 1) * 0.9 * strength))


def _damped_by_joints(baseline: Baseline, build: Build, scale: float, ratios: Real, losses: _Losses) -> Real:
    """Return a damping matrix (floors, floors) [N s/m] of which a share is the loss of each floor's joints."""
    mass, stiffness = matrices(baseline, build)
    stiffness = stiffness * scale

    def share(joints: Real) -> Real:
        changed = matrices(baseline, replace(build, joints=joints))[1] * scale
        found: Real = (changed - stiffness) / damping.SMALL
        return found

    each = []
    for floor, weight in enumerate(losses.weights):
        joints = build.joints.copy()
        joints[floor] *= 1 + damping.SMALL
        each.append((float(weight), share(joints)))
    together = share(build.joints * (1 + damping.SMALL))
    return damping.from_joints(mass, stiffness, ratios, together, each, losses.share)
