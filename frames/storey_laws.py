"""Forces in storeys and on floors beyond a frame's linear stiffness and damping: what `[[storey_law]]` in its file states.

Each opposes the drift of its storey, the displacement of the floor above less that of the floor below; drag opposes the
motion of its floor. The forces are defined in `pounding.experiments.rig.storey_forces`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import get_args

import msgspec

from pounding import bounds
from pounding.bounds import Bound
from pounding.frames.errors import FrameError

POSITIVE = Bound(1e-15, 1e15, "", "with less there is no such force")
EITHER_SIGN = Bound(-1e15, 1e15, "", "nothing real is so large")


class _Stated(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, tag_field="kind"):
    """Base of all laws: immutable, and a key that is not known is an error."""


class Friction(_Stated, frozen=True, tag="friction"):
    """A joint that sticks and slides.

    Attributes:
        storey: The storey, from 1.
        force_n: Force while it slides [N].
        sticking_stiffness_n_per_m: Stiffness while it sticks [N/m].
        sticking_damping_n_s_per_m: Damping while it sticks [N s/m].
        half_worn_m_per_s: Rate of sliding at which half of the force has worn away [m/s]; infinite: nothing wears it.
        breakaway_share: What breaks it loose beyond the sliding force, as a share of that [-].
    """

    storey: int
    force_n: float
    sticking_stiffness_n_per_m: float
    sticking_damping_n_s_per_m: float = 0.0
    half_worn_m_per_s: float = math.inf
    breakaway_share: float = 0.0


class DahlFriction(_Stated, frozen=True, tag="dahl_friction"):
    """Friction that builds up over a drift and never quite sticks.

    Attributes:
        storey: The storey, from 1.
        force_n: Force while it slides [N].
        build_up_mm: Drift in which it would be reached at the stiffness with which it starts [mm].
    """

    storey: int
    force_n: float
    build_up_mm: float


class Damper(_Stated, frozen=True, tag="damper"):
    """A viscous damper.

    Attributes:
        storey: The storey, from 1.
        damping_n_s_per_m: Force over the drift's rate [N s/m], at the rate `at_m_per_s` where the power is not one;
            negative where the frame has less damping than its modes' ratios.
        power: Power of the rate [-]; one below the first is nearly linear below 5 % of the rate `at_m_per_s`.
        at_m_per_s: The rate at which a damper of another power is as strong as the linear one [m/s].
    """

    storey: int
    damping_n_s_per_m: float
    power: float = 1.0
    at_m_per_s: float = 0.1


class QuadraticDamper(_Stated, frozen=True, tag="quadratic_damper"):
    """A damper whose force grows with the square of the drift's rate.

    Attributes:
        storey: The storey, from 1.
        damping_n_s2_per_m2: Its coefficient [N s^2/m^2].
    """

    storey: int
    damping_n_s2_per_m2: float


class Cubic(_Stated, frozen=True, tag="cubic"):
    """A spring whose force is the cube of the drift.

    Attributes:
        storey: The storey, from 1.
        stiffness_n_per_m3: Its coefficient [N/m^3]; negative where the storey softens.
    """

    storey: int
    stiffness_n_per_m3: float


class Hysteresis(_Stated, frozen=True, tag="hysteresis"):
    """A part of the storey's stiffness that yields with a rounded knee (Bouc 1967, Wen 1976).

    Attributes:
        storey: The storey, from 1.
        yield_force_n: Force at which the part yields [N].
        stiffness_n_per_m: Elastic stiffness of the part [N/m], which the storey's own stiffness contains.
        sharpness: Exponent of the knee [-]; 1 is round, 30 as good as sharp.
        unloading: How it unloads [-]: 0 elastic until its force changes sign (Bouc and Wen), 1 rounding from where it turns
            (Masing's rule, Menegotto and Pinto).
    """

    storey: int
    yield_force_n: float
    stiffness_n_per_m: float
    sharpness: float = 30.0
    unloading: float = 0.0


class Loosening(_Stated, frozen=True, tag="loosening"):
    """A change of the storey's stiffness that grows in proportion to the time.

    Attributes:
        storey: The storey, from 1.
        stiffness_change_n_per_m: The whole change [N/m]; negative where the storey loosens.
        whole_at_s: Time since the run began at which it is reached [s]; the end of the run when None.
        drift_shares: How much each storey's drift, from the lowest, contributes to the deformation of what loosens [-]: the
            columns of a storey also bend where the joints at their ends turn. The storey's own drift alone when None; where
            they are stated, they alone say what is deformed, and `storey` says whose columns loosen.
    """

    storey: int
    stiffness_change_n_per_m: float
    whole_at_s: float | None = None
    drift_shares: tuple[float, ...] | None = None


class Bumper(_Stated, frozen=True, tag="bumper"):
    """A stop on one side of the drift.

    Attributes:
        storey: The storey, from 1.
        gap_mm: Drift at which it is met [mm]; negative where it is met by a drift to -x.
        stiffness_n_per_m: Its stiffness [N/m], at a depth of 1 mm where its power is not one.
        loss_s_per_m: Share by which the force is larger while the stop is pressed, and smaller while it is let go, for a
            rate of 1 m/s, at a depth of 1 mm where `dashpot` is not 0 [s/m].
        power: Power of the depth [-].
        dashpot: How the loss comes [-]: 0 with the depth (Hunt and Crossley 1975), 1 at once, as that of a dashpot beside
            the spring (Kelvin and Voigt).
    """

    storey: int
    gap_mm: float
    stiffness_n_per_m: float
    loss_s_per_m: float = 0.0
    power: float = 1.0
    dashpot: float = 0.0


class Drag(_Stated, frozen=True, tag="drag"):
    """Drag of the air on a floor.

    Attributes:
        floor: The floor, from 1.
        coefficient_n_s2_per_m2: Force over the square of the rate [N s^2/m^2]; at a rate of 0.3 m/s where the power is
            not two.
        power: Power of the rate [-].
        air_at_rest: 1: the air rests in the room; 0: it moves with the table; any number beside and between.
    """

    floor: int
    coefficient_n_s2_per_m2: float
    power: float = 2.0
    air_at_rest: float = 1.0


StatedLaw = (
    Friction | DahlFriction | Damper | QuadraticDamper | Cubic | Hysteresis | Loosening | Bumper | Drag
)

BOUNDS: dict[str, Bound] = {
    "force_n": POSITIVE,
    "sticking_stiffness_n_per_m": POSITIVE,
    "sticking_damping_n_s_per_m": Bound(0.0, 1e15, "", "a joint that sticks does not gain energy"),
    "half_worn_m_per_s": Bound(1e-9, math.inf, "", "with less there is no such force"),
    "breakaway_share": Bound(-0.95, 10.0, "", "a joint breaks loose at some force of its own size"),
    "build_up_mm": Bound(1e-6, 1e6, "", "friction builds up over some drift"),
    "yield_force_n": POSITIVE,
    "stiffness_n_per_m": POSITIVE,
    "sharpness": bounds.KNEE,
    "unloading": Bound(0.0, 1.0, "", "0 is Bouc and Wen's way, 1 Masing's"),
    "whole_at_s": Bound(1e-3, 1e6, "", "the change takes some part of a run"),
    "gap_mm": Bound(-1e5, 1e5, "", "no storey drifts so far"),
    "loss_s_per_m": Bound(-1e3, 1e3, "", "a stop loses a share of its force"),
    "dashpot": Bound(-0.5, 1.0, "", "0 is a loss that grows with the depth, 1 one that is there at once"),
    "power": Bound(0.1, 10.0, "", "forces grow with a small power"),
    "at_m_per_s": Bound(1e-9, 1e6, "", "a storey drifts at some rate"),
    "coefficient_n_s2_per_m2": POSITIVE,
    "drift_shares": Bound(-100.0, 100.0, "", "a storey contributes a share near 1, and its neighbours less"),
    "air_at_rest": Bound(
        -10.0, 10.0, "", "1 is air at rest in the room, and 0 air that moves with the table"
    ),
}
"""Range of each key; of those not listed either sign is possible."""


KINDS: dict[str, type[StatedLaw]] = {str(kind.__struct_config__.tag): kind for kind in get_args(StatedLaw)}
"""Each law by the `kind` of its table."""


def check(name: str, laws: Sequence[StatedLaw], storeys: int) -> None:
    """Refuse a law that a frame cannot have.

    Args:
        name: What messages call the frame.
        laws: The laws in its file.
        storeys: Number of its storeys.

    Raises:
        FrameError: A storey or floor that is not there, or a value that cannot be.
    """
    for number, law in enumerate(laws, 1):
        where = f"{name}: storey_law {number}"
        for key in law.__struct_fields__:
            value = getattr(law, key)
            if key in ("storey", "floor"):
                if not 1 <= value <= storeys:
                    raise FrameError(f"{where}: {key} is {value}, must be 1 to {storeys}")
            elif key == "drift_shares":
                _check_shares(f"{where}: {key}", value, storeys)
            elif value is not None:
                BOUNDS.get(key, EITHER_SIGN).check(value, f"{where}: {key}", FrameError)


def _check_shares(where: str, shares: tuple[float, ...] | None, storeys: int) -> None:
    if shares is None:
        return
    if len(shares) != storeys:
        raise FrameError(f"{where} must have {storeys} numbers, one for each storey, and has {len(shares)}")
    for share in shares:
        BOUNDS["drift_shares"].check(share, where, FrameError)
    if not any(shares):
        raise FrameError(f"{where} are all 0, so that nothing loosens; state 1 for the storey's own drift")
