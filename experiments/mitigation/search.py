"""The best setting of each measure, by a search that stays within bounds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from scipy.optimize import direct

from pounding.contact.rubber import FLAT
from pounding.experiments.errors import ExperimentError
from pounding.experiments.mitigation.measures import LINKING, NAMES, SHIELDING, Measure, measures
from pounding.experiments.mitigation.response import Response, response, worst
from pounding.experiments.mitigation.standing import Standing
from pounding.experiments.records import Record
from pounding.experiments.rig.frame_laws import refuse_laws

Objective = Literal["acceleration", "drift", "force"]

UNUSABLE = 1e12
"""Cost of a block that is pressed just flat, beyond any acceleration, drift or force."""

EDGE = 0.02
"""A best setting nearer to a bound than this share of the range is said to lie there [-]."""


@dataclass(frozen=True)
class Tried:
    """A measure with one setting, and what it leaves.

    Attributes:
        values: The settings' values.
        shares: Where they lie between their bounds, 0 to 1.
        response: The worst over the records.
    """

    values: tuple[float, ...]
    shares: tuple[float, ...]
    response: Response


@dataclass(frozen=True)
class Answer:
    """What a measure can do.

    Attributes:
        measure: The measure.
        best: Its best setting.
        tried: All settings tried.
    """

    measure: Measure
    best: Tried
    tried: list[Tried] = field(repr=False)

    @property
    def at_bound(self) -> list[str]:
        """Names of the settings whose best value lies at a bound of the search: more, or less, might be better still."""
        return [
            setting.name
            for setting, share in zip(self.measure.settings, self.best.shares, strict=True)
            if not EDGE < share < 1.0 - EDGE
        ]


def cost(found: Response, objective: Objective) -> float:
    """Return what a search makes small; infinite where a bumper is pressed flat, for it would not last.

    Args:
        found: The response.
        objective: ``acceleration`` of the floors, ``drift`` of the storeys, or ``force`` of contacts and links.
    """
    if found.compression > FLAT:
        return np.inf
    if objective == "force":
        return max(found.peak_force_n, found.link_force_n)
    return found.drift if objective == "drift" else found.acceleration_g


def compare(
    street: Standing,
    records: Sequence[Record],
    *,
    names: Sequence[str] = (),
    objective: Objective = "acceleration",
    evaluations: int = 25,
    progress: Callable[[str, int], None] | None = None,
) -> list[Answer]:
    """Return what each measure can do for a street under records, the street as it is first, and alone if nothing touches.

    Args:
        street: The street.
        records: The shakings at its scale; of each response the worst counts.
        names: Names of the measures; all when empty.
        objective: What is made small.
        evaluations: About how many settings of a measure are tried.
        progress: Called with the measure's name and the number of its settings that are tried.

    Raises:
        ExperimentError: A building yields, or a run grows without bound.
    """
    refuse_laws(street.frames)
    _refuse_no_room(street)
    _refuse_links_off_the_middle(street, names)
    wished = names or possible(street)
    _refuse_impossible(street, wished)
    with ThreadPoolExecutor() as pool:

        def respond(standing: Standing) -> Response:
            return worst(pool.map(lambda record: response(standing, record), records))

        as_it_is = respond(street)
        answers = []
        for measure in measures(street, as_it_is.required_gap_mm):
            # Where nothing touches there is nothing to do.
            wanted = as_it_is.touches > 0 and measure.name in wished
            if measure.name == "none" or wanted:
                told = _Told(measure.name, progress)
                answers.append(_best(measure, respond, objective, evaluations, told))
    return answers


def possible(street: Standing) -> tuple[str, ...]:
    """Return the names of the measures that a street can have: links and dampers stand between floors that face each other.

    Args:
        street: The street.
    """
    if street.hits:
        return tuple(name for name in NAMES if name not in LINKING)
    return tuple(name for name in NAMES if name != SHIELDING)


def _refuse_impossible(street: Standing, names: Sequence[str]) -> None:
    can = possible(street)
    for name in names:
        if name not in can:
            why = (
                "floors hit columns, and links stand between floors that face each other"
                if street.hits
                else "no gap states columns that a floor hits"
            )
            raise ExperimentError(f"measure {name}: {why}; name others by --measure ({', '.join(can)})")


def _refuse_no_room(street: Standing) -> None:
    if any(contact.gap_m <= 0.0 for contact in street.contacts):
        raise ExperimentError(
            "floors that lie against each other leave no room for a measure between them; give every gap more than 0 mm, "
            "also beside its bumper"
        )


def _refuse_links_off_the_middle(street: Standing, names: Sequence[str]) -> None:
    if any(contact.y_m for contact in street.contacts) and (not names or set(names) & set(LINKING)):
        others = ", ".join(name for name in possible(street) if name not in LINKING)
        raise ExperimentError(
            f"contacts off the middle cannot stand beside links, for linked buildings do not twist here; leave y_m out, or "
            f"name the other measures ({others}) by --measure"
        )


class _Told:
    def __init__(self, name: str, progress: Callable[[str, int], None] | None) -> None:
        self._name, self._progress, self._count = name, progress, 0

    def __call__(self) -> None:
        self._count += 1
        if self._progress is not None:
            self._progress(self._name, self._count)


def _best(
    measure: Measure,
    respond: Callable[[Standing], Response],
    objective: Objective,
    evaluations: int,
    told: Callable[[], None],
) -> Answer:
    tried: list[Tried] = []

    def of(shares: Sequence[float]) -> float:
        values = tuple(
            setting.at(float(share)) for setting, share in zip(measure.settings, shares, strict=True)
        )
        found = Tried(values, tuple(map(float, shares)), respond(measure.apply(values)))
        tried.append(found)
        told()
        # A search wants finite numbers: the flatter, the worse.
        found_cost = cost(found.response, objective)
        return found_cost if np.isfinite(found_cost) else UNUSABLE * found.response.compression

    if measure.settings:
        # The ends of the range first, for DIRECT comes near to them only; then it divides what promises most.
        for end in (0.0, 1.0):
            of([end] * len(measure.settings))
        direct(of, [(0.0, 1.0)] * len(measure.settings), maxfun=max(1, evaluations - 2), locally_biased=True)
    else:
        of(())
    # Of blocks that are all pressed flat, the least flat one.
    return Answer(
        measure, min(tried, key=lambda one: (cost(one.response, objective), one.response.compression)), tried
    )
