"""Hand-made findings: problems of several kinds, each on several kinds of data."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from itertools import permutations
from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import pytest

from pounding.diagnosis import Decision, Findings, decide
from pounding.diagnosis.decision.false_alarms import of_nulls
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.discrepancy import SCALES
from pounding.diagnosis.inference.filtering import Filtered, run_filter
from pounding.diagnosis.inference.findings import BesideLatentForce, Judged
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.model.model import Model
from tests.diagnosis.models import measured

CHANNELS = 5
NULLS = of_nulls(0.05, [30.0] * 100, [1.15] * 100, "nulls that are all alike")
"""An effect needs an ln Bayes factor of 30, and something remains beyond 1.15 noise floors."""


@cache
def bench() -> tuple[Model, Filtered]:
    """Return a model that leaves nothing of a real frame, and a filter with which nothing in its data is odd."""
    model = measured()
    model.prior = msgspec.structs.replace(model.prior, model_error=1e-6)
    filtered = run_filter(model, np.zeros(len(model.std)), starting_noise(model, (0, 1), 0.01), (0, 1))
    return model, filtered.with_discrepancy(float(SCALES[0]))


@cache
def effect(name: str, place: int | None = None) -> Effect:
    """Return an effect of the catalogue, or a rival, at a storey or floor of the bench."""
    return next(
        one for one in candidates(bench()[0]) if one.name == name and place in (None, one.storey, one.floor)
    )


@cache
def rival() -> Effect:
    """Return something that is outside the catalogue."""
    return next(one for one in candidates(bench()[0]) if one.rival)


@dataclass(frozen=True)
class Data:
    """What was measured: the noise as a share of each channel, whether a run was held out, channels that were dead."""

    noise: float
    held_out: bool = True
    dead: tuple[int, ...] = ()

    def misfits(self, over: float) -> np.ndarray:
        """Return misfits that are so many times the noise floor, shape (2, channels)."""
        found = np.full((2, CHANNELS), over * self.noise)
        found[:, list(self.dead)] = np.nan
        if not self.held_out:
            found[1] = np.nan
        return found


@dataclass(frozen=True)
class Tried:
    """A candidate: its effects, its ln Bayes factor, and how many times the noise floor its misfit is.

    Its sizes vary between windows by so much of themselves.
    """

    effects: tuple[Callable[[], Effect], ...]
    ln_bayes: float
    over: float
    between: float = 0.0


@dataclass(frozen=True)
class Problem:
    """Findings, and what must be said of them.

    Attributes:
        null: Misfit of the baseline model over the noise floor.
        tried: The candidates.
        verdict: The verdict.
        behind: The number of the candidate behind it, None for the baseline model.
        alike: The numbers of candidates that cannot be told from it.
    """

    null: float
    tried: tuple[Tried, ...]
    verdict: str
    behind: int | None = None
    alike: tuple[int, ...] = ()


def of(name: str, place: int | None = None) -> Callable[[], Effect]:
    return lambda: effect(name, place)


CUBIC, FRICTION, MASS = of("cubic_stiffness", 2), of("coulomb_friction", 2), of("added_mass", 3)
ALL = of("all_cubic_stiffness")
NEXT = of("cubic_stiffness", 3)
OTHER_FLOOR = of("coulomb_friction", 3)

PROBLEMS = {
    "nothing was tried and nothing is left": Problem(1.0, (), "nothing_missing"),
    "a candidate with little evidence": Problem(1.05, (Tried((CUBIC,), 5.0, 1.0),), "nothing_missing"),
    "much evidence that takes nothing out of the noise": Problem(
        1.02, (Tried((CUBIC,), 500.0, 1.02),), "nothing_missing"
    ),
    "a candidate whose size varies between windows as much as it is": Problem(
        1.05, (Tried((CUBIC,), 500.0, 1.0, between=0.5),), "nothing_missing"
    ),
    "a second effect whose size varies between windows as much as it is": Problem(
        6.0,
        (Tried((CUBIC, MASS), 9000.0, 1.0, between=0.5), Tried((CUBIC,), 4000.0, 1.5)),
        "effect_named",
        1,
    ),
    "one effect explains everything": Problem(
        4.0, (Tried((CUBIC,), 5000.0, 1.0), Tried((FRICTION,), 400.0, 3.0)), "effect_named", 0
    ),
    "two effects that the data cannot tell apart": Problem(
        4.0, (Tried((CUBIC,), 5000.0, 1.0), Tried((FRICTION,), 4997.0, 1.0)), "effect_class", 0, (1,)
    ),
    "much is left and nothing was tried": Problem(3.0, (), "unknown_effect"),
    "much is left that no candidate touches": Problem(
        3.0, (Tried((CUBIC,), 5.0, 2.99),), "unknown_effect", 0
    ),
    "the best candidate leaves the larger part": Problem(
        6.0, (Tried((CUBIC,), 5000.0, 4.0),), "unknown_effect", 0
    ),
    "something outside the catalogue is clearly better": Problem(
        4.0, (Tried((rival,), 5000.0, 1.0), Tried((CUBIC,), 4500.0, 1.1)), "unknown_effect", 0
    ),
    "something outside the catalogue is likelier and explains no more": Problem(
        4.0, (Tried((rival,), 5000.0, 1.9), Tried((CUBIC,), 4500.0, 2.0)), "effect_named", 1
    ),
    "a law that is not quite ours, and leaves some": Problem(
        6.0, (Tried((CUBIC,), 5000.0, 2.0),), "effect_named", 0
    ),
    "something outside the catalogue is hardly better": Problem(
        4.0, (Tried((rival,), 5002.0, 1.0), Tried((CUBIC,), 5000.0, 1.0)), "effect_named", 1
    ),
    "two effects at once, in two places": Problem(
        6.0, (Tried((CUBIC, MASS), 9000.0, 1.0), Tried((CUBIC,), 4000.0, 4.0)), "effect_named", 0
    ),
    "a second effect that adds little": Problem(
        4.0, (Tried((CUBIC, MASS), 5020.0, 1.0), Tried((CUBIC,), 5000.0, 1.0)), "effect_named", 1
    ),
    "a law in all storeys and the same in one, which explains little of what is left": Problem(
        9.0, (Tried((ALL, CUBIC), 9000.0, 2.0), Tried((ALL,), 4000.0, 3.0)), "effect_named", 1
    ),
    "a law in all storeys and the same in one, which explains nearly all that is left": Problem(
        9.0, (Tried((ALL, CUBIC), 9000.0, 1.0), Tried((ALL,), 4000.0, 4.0)), "effect_named", 0
    ),
    "one law in two storeys that meet": Problem(
        6.0, (Tried((CUBIC, NEXT), 9000.0, 1.0), Tried((CUBIC,), 4000.0, 4.0)), "unknown_effect", 0
    ),
    "a second law in the same storey that explains what the first leaves": Problem(
        6.0, (Tried((CUBIC, FRICTION), 9000.0, 1.0), Tried((CUBIC,), 4000.0, 4.0)), "effect_named", 0
    ),
    "a second law in the same storey that only mends the first": Problem(
        30.0, (Tried((CUBIC, FRICTION), 9000.0, 1.8), Tried((CUBIC,), 4000.0, 2.0)), "effect_named", 1
    ),
    "two laws in two storeys that meet": Problem(
        6.0, (Tried((CUBIC, OTHER_FLOOR), 9000.0, 1.0), Tried((CUBIC,), 4000.0, 4.0)), "effect_named", 0
    ),
}
DATA = {
    "quiet": Data(0.01),
    "noisy": Data(0.3),
    "a single run": Data(0.02, held_out=False),
    "a dead channel": Data(0.02, dead=(1,)),
}


def judged(data: Data, tried: Tried, filtered: Filtered) -> Judged:
    effects = tuple(one() for one in tried.effects)
    values = [np.ones(len(one.quantities)) for one in effects]
    # As far from none as the evidence says, and as constant as it is.
    share = 1.0 / np.sqrt(2.0 * tried.ln_bayes) if tried.ln_bayes > 0.0 else 1.0
    fit: Any = SimpleNamespace(
        effects=effects,
        values=values,
        std=[np.hypot(share, tried.between) * one for one in values],
        filtered=filtered,
        log_posterior=tried.ln_bayes,
    )
    misfits = data.misfits(tried.over)
    return Judged(fit, tried.ln_bayes, (tried.over * data.noise,) * 2, misfits)


def findings(problem: Problem, data: Data, filtered: Filtered | None = None) -> Findings:
    """Return findings as a search would have made them."""
    model, usual = bench()
    null = judged(data, Tried((), 0.0, problem.null), filtered or usual)
    found = [judged(data, one, filtered or usual) for one in problem.tried]
    nothing: Any = None
    made = Findings(
        model, null, nothing, nothing, (0,), (1,) if data.held_out else (),
        sorted(found, key=lambda one: -one.ln_bayes), data.misfits(1.0), false_alarms=NULLS,
    )  # fmt: skip
    # No data made these fits: what the first one's law gets wrong is worth a tenth of its evidence.
    for one, other in permutations(found, 2):
        asked = tuple((each.fit.effects, each.fit.log_posterior) for each in (one, other))
        made.beside_latent_force[asked] = BesideLatentForce(other.ln_bayes - 1.1 * one.ln_bayes)
    return made


def decided(problem: Problem, data: Data) -> tuple[Findings, Decision]:
    found = findings(problem, data)
    return found, decide(found)


def allow(monkeypatch: pytest.MonkeyPatch, model_error: float) -> None:
    """Let the model of the bench leave that share of the motion."""
    model, _ = bench()
    prior = msgspec.structs.replace(model.prior, model_error=model_error)
    monkeypatch.setattr(model, "prior", prior)
