"""A floor that hits the columns of its neighbour: how soft they are there, and what they bear."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from pounding import bounds
from pounding.contact.laws import Law, LinearSpring, LinearViscoelastic
from pounding.experiments.errors import ExperimentError
from pounding.experiments.rig.contacts import Contact, column_weights
from pounding.experiments.rig.motion import Motion
from pounding.experiments.rig.required_gap import contact_floors, is_left_lower
from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.floating]


class Columns(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The columns that a floor hits, all alike, fixed to the floors below and above.

    Attributes:
        count: How many are hit.
        depth_m: Side along the impact [m].
        width_m: Other side [m].
        youngs_modulus_gpa: Modulus of the columns [GPa].
        shear_kn: Shear that one column can bear [kN]; None: not known.
        moment_kn_m: Moment that one column can bear [kN m]; None: not known.
    """

    count: int
    depth_m: float
    width_m: float
    youngs_modulus_gpa: float = 30.0
    shear_kn: float | None = None
    moment_kn_m: float | None = None

    @property
    def bending_n_m2(self) -> float:
        """E I of one column [N m^2]."""
        return 1e9 * self.youngs_modulus_gpa * self.width_m * self.depth_m**3 / 12.0

    def stiffness(self, length_m: float, share: float) -> float:
        """Return the force on all of them for a unit deflection where it acts, the ends at rest [N/m].

        Args:
            length_m: Height of the storey [m].
            share: Where it acts, from the lower end over the length [-].
        """
        return 3.0 * self.count * self.bending_n_m2 / (length_m * share * (1.0 - share)) ** 3

    def check(self, where: str) -> None:
        """Refuse values that cannot be.

        Args:
            where: What messages begin with.

        Raises:
            ExperimentError: A value beyond its bound.
        """
        for key, bound, per, unit in (
            ("count", bounds.COLUMNS, 1.0, ""),
            ("depth_m", bounds.LENGTH, 1.0, "m"),
            ("width_m", bounds.LENGTH, 1.0, "m"),
            ("youngs_modulus_gpa", bounds.MODULUS, 1.0, "GPa"),
            ("shear_kn", bounds.CONTACT_FORCE, 1e3, "kN"),
            ("moment_kn_m", bounds.MOMENT, 1e3, "kN m"),
        ):
            value = getattr(self, key)
            if value is not None:
                bound.check(value, f"{where}: {key}", ExperimentError, per=per, unit=unit)


@dataclass(frozen=True)
class Place:
    """Where a floor hits columns.

    Attributes:
        floors: Floor of the left and of the right frame; that on columns lies between two whole numbers.
        hit: Which of them is on columns, 0 or 1.
        length_m: Height of the storey that is hit [m].
        share: Height of the hit above the storey's lower floor over that [-].
    """

    floors: tuple[float, float]
    hit: int
    length_m: float
    share: float


def place_of(left: ReducedFrame, right: ReducedFrame, floor: int | None) -> Place:
    """Return where a floor of the lower frame hits the columns of the other.

    Args:
        left, right: The frames.
        floor: Floor of the lower frame; its roof when None.

    Raises:
        ExperimentError: A floor that is not there, or that faces a floor, or the open air.
    """
    try:
        facing = contact_floors(left, right, floor)
    except ExperimentError:
        facing = None
    if facing is not None:
        raise ExperimentError(
            f"floor {facing[0]} of {left.name} faces floor {facing[1]} of {right.name}, no columns; leave out 'columns'"
        )
    hit = 1 if is_left_lower(left, right) else 0
    lower, other = (left, right) if hit else (right, left)
    number = lower.storeys if floor is None else floor
    if not 1 <= number <= lower.storeys:
        raise ExperimentError(
            f"floor {number} cannot meet: frame {lower.name} has the floors 1 to {lower.storeys} beside {other.name}"
        )
    heights = np.array([0.0, *other.heights_m])
    height = float(lower.heights_m[number - 1])
    below = int(np.searchsorted(heights, height)) - 1
    length = float(heights[below + 1] - heights[below])
    share = (height - float(heights[below])) / length
    level = below + share
    return Place((number, level) if hit else (level, number), hit, length, share)


def masses_at(left: ReducedFrame, right: ReducedFrame, place: Place) -> tuple[float, float]:
    """Return the masses [kg] that meet: of the floor, and of the floors beside it as far as they bear the force.

    Args:
        left, right: The frames.
        place: Where the floor hits.
    """
    found = []
    for frame, level in zip((left, right), place.floors, strict=True):
        below, share = int(level), level - int(level)
        if not share:
            found.append(frame.mass_at(below))
            continue
        lower, upper = column_weights(share)
        found.append(upper * frame.mass_at(below + 1) + (lower * frame.mass_at(below) if below else 0.0))
    return found[0], found[1]


def softened(law: Law, place: Place, columns: Columns) -> Law:
    """Return a linear law in series with the bending of the columns, with the damping ratio that it has.

    Args:
        law: Law of the floor's edge.
        place: Where the floor hits.
        columns: The columns.

    Raises:
        ExperimentError: A law that is not linear.
    """
    if not isinstance(law, LinearSpring | LinearViscoelastic):
        raise ExperimentError(
            f"{law.name}: columns bend like a spring, in series with which only linear laws are known; take "
            "linear_viscoelastic or linear_spring"
        )
    bending = columns.stiffness(place.length_m, place.share)
    stiffness = law.stiffness * bending / (law.stiffness + bending)
    if isinstance(law, LinearViscoelastic):
        damping = law.damping * math.sqrt(stiffness / law.stiffness)
        return dataclasses.replace(law, stiffness=stiffness, damping=damping)
    return dataclasses.replace(law, stiffness=stiffness)


def hardened(law: Law, place: Place, columns: Columns) -> Law:
    """Return the law of the floor's edge alone, the inverse of `softened`: what stands there no longer bends.

    Args:
        law: A law that `softened` gave.
        place: Where the floor hits.
        columns: The columns.
    """
    assert isinstance(law, LinearSpring | LinearViscoelastic)
    bending = columns.stiffness(place.length_m, place.share)
    stiffness = law.stiffness * bending / (bending - law.stiffness)
    if isinstance(law, LinearViscoelastic):
        damping = law.damping * math.sqrt(stiffness / law.stiffness)
        return dataclasses.replace(law, stiffness=stiffness, damping=damping)
    return dataclasses.replace(law, stiffness=stiffness)


def borne(
    motion: Motion,
    contact: Contact,
    place: Place,
    columns: Columns,
    number: int,
    *,
    is_shielded: bool = False,
) -> dict[str, Any]:
    """Return what one column bears, the storey's own drift included, beside what it can.

    A column fixed at both ends that bears a force F at a above its lower end and b below its upper one has the end shears
    F b^2 (3 a + b) / L^3 and F a^2 (a + 3 b) / L^3 and the end moments F a b^2 / L^2 and F a^2 b / L^2. A drift d adds
    a shear of 12 EI d / L^3 and moments of 6 EI d / L^2.

    Args:
        motion: The run.
        contact: The contact.
        place: Where it is.
        columns: The columns.
        number: Number of the contact in the run, from 0.
        is_shielded: Whether a wall takes the blow, so that the column bears the drift alone.
    """
    history = motion.contacts[number]
    times = np.union1d(history.time_s, history.sampled()[0])
    sign = 0.0 if is_shielded else 1.0 if place.hit == 1 else -1.0
    force = sign * history.at(times)[2] / columns.count
    hit = motion.frames[contact.pair + place.hit]
    below = int(place.floors[place.hit])
    upper = hit.displacement_m[:, hit.floor(below + 1)]
    lower = hit.displacement_m[:, hit.floor(below)] if below else np.zeros_like(upper)
    drift = np.interp(times, hit.time_s, upper - lower)
    length, share, bending = place.length_m, place.share, columns.bending_n_m2
    to_lower, to_upper = column_weights(share)
    sway_shear, sway_moment = 12.0 * bending * drift / length**3, 6.0 * bending * drift / length**2
    # The force pushes along +x as a drift does; below it the two shears add, above it they work against each other.
    shears = np.abs([sway_shear + to_lower * force, sway_shear - to_upper * force])
    moments = np.abs(
        [
            sway_moment + force * length * share * (1.0 - share) ** 2,
            sway_moment - force * length * share**2 * (1.0 - share),
        ]
    )
    shear, moment = float(shears.max()) / 1e3, float(moments.max()) / 1e3
    return {
        "building": hit.name,
        "between_floors": [below, below + 1],
        "height_m": float(
            np.interp(place.floors[place.hit], range(hit.reduced.storeys + 1), [0.0, *hit.reduced.heights_m])
        ),
        "shear_kn": shear,
        "shear_of_drift_kn": float(np.abs(sway_shear).max()) / 1e3,
        "shear_capacity_kn": columns.shear_kn,
        "moment_kn_m": moment,
        "moment_of_drift_kn_m": float(np.abs(sway_moment).max()) / 1e3,
        "moment_capacity_kn_m": columns.moment_kn_m,
    }


def beyond(found: dict[str, Any]) -> list[str]:
    """Return a sentence for each capacity of a column that is passed.

    Args:
        found: What `borne` says of it.
    """
    below, above = found["between_floors"]
    where = f"a column of {found['building']} between floors {below} and {above}"
    said = []
    for what, unit in (("shear", "kn"), ("moment", "kn_m")):
        value, capacity = found[f"{what}_{unit}"], found[f"{what}_capacity_{unit}"]
        if capacity is not None and value > capacity:
            words = {"kn": "kN", "kn_m": "kN m"}[unit]
            said.append(
                f"{where} bears a {what} of {value:.4g} {words} and can bear {capacity:.4g} {words}: it breaks, and the run "
                "says nothing of what follows"
            )
    return said
