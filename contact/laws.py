"""The impact laws: one definition each for numpy, for plots and for exudyn.

A law is a frozen dataclass: its fields are its parameters and `compression` is its formula while the
bodies touch. The formula is written with the operations of `xp` (``where``, ``power``, ``sqrt``,
``maximum``) instead of numpy's own, so that the same line is evaluated on arrays, on floats, and is
recorded symbolically by the engine. A law of one's own is a few lines, and is then known by its name
everywhere (rig, command, plots)::

    @dataclass(frozen=True)
    class Progressive(Law):
        stiffness: float  # [N/m^2]

        name: ClassVar[str] = "progressive"
        unit: ClassVar[str] = "N/m^2"

        def compression(self, deformation, rate, approach, xp):
            return self.stiffness * xp.power(deformation, 2.0)

Signs: deformation is how far the bodies overlap [m], rate its time derivative [m/s] (positive while
they approach), force is positive in compression [N].
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np

from pounding.contact.damping import hertz_damp_ratio
from pounding.contact.errors import ContactError
from pounding.toml_text import meant


class FloatOperations:
    """The operations a law may use, on plain floats: ten times quicker there than numpy's."""

    power = staticmethod(math.pow)
    sqrt = staticmethod(math.sqrt)

    @staticmethod
    def where(condition: bool, yes: float, no: float) -> float:
        """Return `yes` or `no`.

        Args:
            condition: What is asked.
            yes: The value where it holds.
            no: The value elsewhere.
        """
        return yes if condition else no

    @staticmethod
    def maximum(first: float, second: float) -> float:
        """Return the larger one."""
        return first if first > second else second


LAWS: dict[str, type[Law]] = {}
"""All laws by name, the package's five first, then those that the user added."""


@dataclass(frozen=True)
class Law:
    """What all laws share: no force unless the bodies touch, and no pull unless it is asked for.

    `tension` is the switch for the pull that a dashpot exerts just before the bodies separate: the
    printed formulas of the viscoelastic laws allow it, unglued surfaces cannot carry it. Off by default.
    """

    name: ClassVar[str] = ""
    unit: ClassVar[str] = "N/m"
    latches: ClassVar[bool] = False  # does the formula need the velocity at first touch?
    damped: ClassVar[bool] = True  # does an impact lose energy?
    listed: ClassVar[bool] = True  # is it known by its name, with a stiffness alone?

    stiffness: float
    tension: bool = False

    def __init_subclass__(cls, **keywords: Any) -> None:
        super().__init_subclass__(**keywords)
        if cls.name and cls.listed:
            LAWS[cls.name] = cls

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, float | int) and not math.isfinite(value):
                raise ContactError(f"{self.name}: {field.name} is {value}; give a finite number")
        if self.stiffness <= 0:
            raise ContactError(
                f"{self.name}: stiffness is {self.stiffness:g} {self.unit}; it must be positive "
                "(leave the contact out if nothing shall touch)"
            )

    def compression(self, deformation: Any, rate: Any, approach: Any, xp: Any) -> Any:
        """Formula of the law while the bodies touch [N]; `approach` is the rate at first touch [m/s].

        Args:
            deformation: How far the bodies overlap [m], above 0; a number or an array.
            rate: Its time derivative [m/s].
            approach: Velocity at first touch [m/s].
            xp: Where ``where``, ``power``, ``sqrt`` and ``maximum`` come from: numpy, or operations on floats
                or symbols.
        """
        raise NotImplementedError

    def force(self, deformation: Any, rate: Any, approach: Any = 0.0, xp: Any = np) -> Any:
        """Contact force, positive in compression [N].

        Args:
            deformation: How far the bodies overlap [m], negative while they are apart; a number or an array.
            rate: Its time derivative [m/s], broadcast against the deformation.
            approach: Velocity at first touch [m/s], broadcast too.
            xp: As in `compression`.
        """
        pressed = self.compression(xp.maximum(deformation, 0.0), rate, approach, xp)
        if not self.tension:
            pressed = xp.maximum(pressed, 0.0)
        return xp.where(deformation > 0.0, pressed, 0.0)

    def stored_energy(self, deformation: Any) -> Any:
        """Elastic energy [J] at `deformation` [m]: the law's own spring, loaded without haste."""
        depth = np.maximum(np.asarray(deformation, dtype=float), 0.0)
        nodes, weights = np.polynomial.legendre.leggauss(12)
        points = 0.5 * depth[..., None] * (nodes + 1.0)
        force = self.compression(points, np.zeros_like(points), np.ones_like(points), np)
        return 0.5 * depth * (force @ weights)


@dataclass(frozen=True)
class LinearSpring(Law):
    """Hooke's law; no loss (thesis eq. 2.4). stiffness [N/m]."""

    name: ClassVar[str] = "linear_spring"
    damped: ClassVar[bool] = False

    def compression(self, deformation: Any, rate: Any, approach: Any, xp: Any) -> Any:
        """Spring [N], eq. 2.4."""
        return self.stiffness * deformation


@dataclass(frozen=True)
class LinearViscoelastic(Law):
    """Spring and dashpot side by side, after Kelvin and Voigt (thesis eq. 2.5).

    stiffness [N/m], damping [N s/m].
    """

    damping: float = 0.0

    name: ClassVar[str] = "linear_viscoelastic"

    def __post_init__(self) -> None:
        super().__post_init__()
        _not_negative(self, "damping", "N s/m")

    def compression(self, deformation: Any, rate: Any, approach: Any, xp: Any) -> Any:
        """Spring and dashpot [N], eq. 2.5."""
        return self.stiffness * deformation + self.damping * rate


@dataclass(frozen=True)
class Hertz(Law):
    """Hertz' contact of a sphere and a plane; no loss (thesis eq. 2.9). stiffness [N/m^1.5]."""

    name: ClassVar[str] = "hertz"
    unit: ClassVar[str] = "N/m^1.5"
    damped: ClassVar[bool] = False

    def compression(self, deformation: Any, rate: Any, approach: Any, xp: Any) -> Any:
        """Spring [N], eq. 2.9."""
        return self.stiffness * xp.power(deformation, 1.5)


@dataclass(frozen=True)
class NonlinearViscoelastic(Law):
    """Hertz' spring with a dashpot that acts while the bodies approach (Jankowski; thesis eq. 2.12, 2.13).

    stiffness [N/m^1.5], damping_ratio [-], reduced_mass m_i m_j / (m_i + m_j) [kg].
    """

    damping_ratio: float = 0.0
    reduced_mass: float = 1.0

    name: ClassVar[str] = "nonlinear_viscoelastic"
    unit: ClassVar[str] = "N/m^1.5"

    def __post_init__(self) -> None:
        super().__post_init__()
        _not_negative(self, "damping_ratio", "")
        if self.reduced_mass <= 0:
            raise ContactError(f"{self.name}: reduced_mass is {self.reduced_mass:g} kg; it must be positive")

    def compression(self, deformation: Any, rate: Any, approach: Any, xp: Any) -> Any:
        """Spring and one-way dashpot [N], eq. 2.12 and 2.13."""
        dashpot = 2.0 * self.damping_ratio * math.sqrt(self.stiffness * self.reduced_mass)
        return self.stiffness * xp.power(deformation, 1.5) + dashpot * xp.power(
            deformation, 0.25
        ) * xp.maximum(rate, 0.0)


@dataclass(frozen=True)
class HertzDamp(Law):
    """Hertz' spring with a dashpot that grows as the spring does (thesis eq. 2.15 to 2.18).

    stiffness [N/m^1.5], restitution [-], formula ``"ye"`` (eq. 2.18) or ``"muthukumar"`` (eq. 2.17).
    The damping refers to the velocity at first touch; below `slowest_approach` [m/s] that one is used
    instead, for the formula divides by it and two floors that lie against each other have none.
    """

    restitution: float = 1.0
    formula: str = "ye"
    slowest_approach: float = 1e-3

    name: ClassVar[str] = "hertz_damp"
    unit: ClassVar[str] = "N/m^1.5"
    latches: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        hertz_damp_ratio(self.restitution, self.formula)  # refuses what cannot be
        if self.slowest_approach <= 0:
            raise ContactError(
                f"{self.name}: slowest_approach is {self.slowest_approach:g} m/s; it must be positive"
            )

    def compression(self, deformation: Any, rate: Any, approach: Any, xp: Any) -> Any:
        """Spring and dashpot [N], eq. 2.15 and 2.16."""
        ratio = hertz_damp_ratio(self.restitution, self.formula)
        relative = rate / xp.maximum(approach, self.slowest_approach)
        return self.stiffness * xp.power(deformation, 1.5) * (1.0 + ratio * relative)


BUILT_IN = tuple(LAWS)
"""Names of the package's five laws, in the order of the thesis."""

DAMPED = tuple(name for name in BUILT_IN if LAWS[name].damped)
"""Those of them in which an impact loses energy."""


def names() -> list[str]:
    """Names of all laws known, the package's five first, then those that the user added."""
    return list(LAWS)


def law_class(name: str) -> type[Law]:
    """Law of that name; `ContactError` names the known ones otherwise."""
    try:
        return LAWS[name]
    except KeyError:
        raise ContactError(f"no impact law is called {name!r}{meant(name, names())}") from None


def _not_negative(law: Law, field: str, unit: str) -> None:
    value = getattr(law, field)
    if value < 0:
        raise ContactError(f"{law.name}: {field} is {f'{value:g} {unit}'.strip()}; it would create energy")
