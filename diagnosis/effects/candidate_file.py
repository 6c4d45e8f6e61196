"""A user's own candidates: plain functions with units in a Python file, compiled and checked before anything is run.

    def slack_tie(d, v, t, stiffness: "N/m" = 2e4, slack: "mm" = (0.1, 3.0)):
        '''A tie in the storey that pulls once its slack is used up.'''
        return stiffness * (d - slack) if d > slack else 0.0

The first argument says where the force acts: `d`, the drift of a storey [m], or `u`, a floor's displacement relative to
the table [m]; `v` is its rate [m/s], `t` the time since the run began [s]. The function returns the force [N] that
opposes it, proportional to its first parameter. Annotations are units, defaults typical sizes or ranges in these units;
the function itself gets SI.
"""

from __future__ import annotations

import inspect
import os
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from itertools import product
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

import numpy as np

from pounding import bounds
from pounding.calling import PARAMETERS, with_parameters
from pounding.diagnosis.effects.catalogue import CATALOGUE, Effect
from pounding.diagnosis.errors import CaseError
from pounding.experiments.rig.laws import Law
from pounding.extras import MissingExtraError, extra_module
from pounding.toml_text import shown

PLACES = {"d": "storey", "u": "floor"}
"""Where a force acts, by the name of the first argument."""
TRIED = (
    np.array([-0.05, -5e-3, -5e-4, -1e-5, 0.0, 1e-5, 5e-4, 5e-3, 0.05]),
    np.array([-1.0, -0.1, -1e-3, 0.0, 1e-3, 0.1, 1.0]),
    np.array([0.0, 0.3, 7.0]),
)
"""Drifts [m], rates [m/s] and times [s] at which a function is tried: those of frames of this size."""
MOST_OF_A_UNIT = 60
"""Characters of a unit; what is longer is no unit."""
_POWER = r"(?: *(?:\*\*|\^) *-?\d{1,2}+(?:\.\d{1,3}+)?)?"
UNIT = re.compile(rf"(?:[^\W\d]++{_POWER}|\){_POWER}|\*(?!\*)|[1°%(/ ])+")
"""Names with small exponents, products, quotients and brackets: towers of powers would take for ever."""


@dataclass(frozen=True)
class UserParameter:
    """A parameter: name, unit as written, SI per unit, and its typical sizes in SI, one or the ends of a range."""

    name: str
    unit: str
    to_si: float
    sizes: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class UserForce:
    """A user's function.

    Attributes:
        name, what: Its name and the first line of its docstring.
        where: ``storey`` or ``floor``.
        parameters: Its parameters, the first its size.
        either_sign: Whether the first parameter may be negative.
        law: The compiled function.
    """

    name: str
    what: str
    where: str
    parameters: tuple[UserParameter, ...]
    either_sign: bool
    law: Law


def read_candidates(
    path: Path | str, trying: Callable[[str], None] = lambda where: None
) -> list[UserForce | type[Effect]]:
    """Return what a candidates file asks for: its functions, compiled and checked, and effects that it imports.

    Functions whose names begin with an underscore are the file's own business. An effect of the catalogue that is not tried
    by default is tried where the file has its class; one that is tried anyway is passed over.

    Args:
        path: Python file of the user's. Code that never ends hangs this process: see `candidate_trial.try_out`.
        trying: Called with the place and name of each function before it is compiled and tried.

    Raises:
        CaseError: The file is missing or cannot be run, or a function lacks units, does not compile, is not finite, is
            not proportional to its first parameter or does not return a force.
        MissingExtraError: pint is not installed.
    """
    path = Path(path)
    _units()  # Without pint nothing of the file can be read.
    module = _module(path)
    found: list[UserForce | type[Effect]] = []
    for name, thing in list(vars(module).items()):
        if isinstance(thing, type) and issubclass(thing, Effect) and thing in CATALOGUE.optional():
            found.append(thing)
            continue
        with _user_code(f"{path}: {name} cannot be read"):
            function = getattr(thing, "py_func", thing)
            if (
                not name.startswith("_")
                and isinstance(function, FunctionType)
                and function.__module__ == module.__name__
            ):
                where = f"{path} line {function.__code__.co_firstlineno}: {name}"
                trying(where)
                found.append(_force(where, name, function))
    if not found:
        raise CaseError(
            f"{path} holds no candidate; write a function such as "
            '`def tie(d, v, t, stiffness: "N/m" = 2e4)` that returns the force in N that opposes the drift d, or import an '
            "effect of the catalogue that is not tried by default"
        )
    return found


@contextmanager
def _user_code(what: str) -> Iterator[None]:
    """Turn whatever a user's code raises into a sentence, but Ctrl-C; also its own exceptions and `sys.exit`.

    Args:
        what: What was done with it, the beginning of the sentence.
    """
    try:
        yield
    except (KeyboardInterrupt, CaseError, MissingExtraError):
        raise
    except BaseException as error:
        reason = " ".join(str(error).split())
        raise CaseError(f"{what}: {type(error).__name__}{reason and ': '}{reason}") from error


def _module(path: Path) -> ModuleType:
    if not os.path.isfile(path):
        raise CaseError(f"{path}: there is no such file of candidates; give --candidates a Python file")
    if path.suffix != ".py":
        raise CaseError(f"{path} is not a Python file; its name must end in .py")
    module = ModuleType("candidates_of_the_user")
    module.__file__ = str(path)
    with _user_code(f"{path} cannot be run"):
        try:
            # Not by import, which would leave a folder of compiled code beside the file.
            code = compile(path.read_bytes(), str(path), "exec")
        except SyntaxError as error:
            raise CaseError(f"{path} line {error.lineno or 1}: {error.msg}; correct the file there") from None
        exec(code, module.__dict__)
    return module


def _force(where: str, name: str, function: FunctionType) -> UserForce:
    place, parameters = _signature(where, function)
    force = UserForce(
        name=name,
        what=(inspect.getdoc(function) or "").partition("\n")[0],
        where=place,
        parameters=parameters,
        either_sign=bool(getattr(function, "either_sign", False)),
        law=_compiled(where, function, len(parameters)),
    )
    _check_numbers(where, force)
    _check_units(where, function, parameters)
    return force


def _signature(where: str, function: FunctionType) -> tuple[str, tuple[UserParameter, ...]]:
    arguments = list(inspect.signature(function).parameters.values())
    names = [argument.name for argument in arguments]
    if len(names) < 3 or names[0] not in PLACES or names[1:3] != ["v", "t"]:
        raise CaseError(
            f"{where} takes ({', '.join(names)}); the first three arguments must be d (drift) or u (displacement of a "
            "floor), v and t; begin the name of a helper function with an underscore"
        )
    if not 1 <= len(names) - 3 <= PARAMETERS:
        raise CaseError(
            f"{where} has {len(names) - 3} parameters after d, v, t; it may have 1 to {PARAMETERS}"
        )
    return PLACES[names[0]], tuple(_parameter(where, argument) for argument in arguments[3:])


def _parameter(where: str, argument: inspect.Parameter) -> UserParameter:
    name, unit = argument.name, argument.annotation
    if unit is inspect.Parameter.empty or not isinstance(unit, str):
        raise CaseError(f'{where}: parameter {name!r} has no unit; write it as {name}: "N/m" = 2e4')
    unit = unit.strip("'\" ")
    if argument.default is inspect.Parameter.empty:
        raise CaseError(
            f"{where}: parameter {name!r} has no typical size; give it one as its default, "
            f'{name}: "{unit}" = 2.0, or a range, {name}: "{unit}" = (0.5, 4.0)'
        )
    to_si, default = _to_si(where, name, unit).magnitude, shown(argument.default)
    try:
        sizes = tuple(float(size) * to_si for size in np.atleast_1d(argument.default))
    except (TypeError, ValueError, OverflowError):
        sizes = ()
    if len(sizes) not in (1, 2) or not np.all(np.isfinite(sizes)) or not np.all(sizes):
        raise CaseError(
            f"{where}: the typical size of {name!r} is {default}; "
            "write a number other than 0, or a range of two of them"
        )
    for size in sizes:
        bounds.PARAMETER.check(abs(size), f"{where}: the typical size {default} of {name!r}", CaseError)
    if len(sizes) == 2 and sizes[0] >= sizes[1]:
        raise CaseError(f"{where}: the range of {name!r} must go from low to high, not {default}")
    return UserParameter(name, unit, float(to_si), sizes)


@cache
def _units() -> Any:
    """Return pint's registry of units; one for all, since quantities of two do not mix."""
    return extra_module("pint").UnitRegistry()


def _to_si(where: str, name: str, unit: str) -> Any:
    """Return one of a unit as a quantity in SI."""
    units = _units()
    told = f'{where}: the unit "{shown(unit)[1:-1]}" of {name!r} is not understood; write it like "N s/m" or "mm"'
    if len(unit) > MOST_OF_A_UNIT or not UNIT.fullmatch(unit):
        raise CaseError(told)
    with _user_code(told):
        return (1.0 * units.parse_expression(unit) * units.dimensionless).to_base_units()


def _compiled(where: str, function: Callable[..., float], count: int) -> Law:
    law = Law(with_parameters(function, count), cache=False)
    try:
        law.compile()
    except Exception as error:
        # The first line names numba's own pipeline, the next what it stumbled on.
        lines = [line.strip(" -") for line in str(error).splitlines() if line.strip()] or [repr(error)]
        reason = next((line for line in lines if not line.startswith("Failed in nopython")), lines[0])
        raise CaseError(
            f"{where} does not compile: {reason}; use numbers, math and numpy functions of numbers, and mark "
            "helper functions with numba.njit"
        ) from None
    return law


def _check_numbers(where: str, force: UserForce) -> None:
    """Refuse a function that is not finite, does nothing, or is not proportional to its first parameter."""
    x, v, t = (axis.ravel() for axis in np.meshgrid(*TRIED, indexing="ij"))
    moved = False
    for values in product(*(parameter.sizes for parameter in force.parameters)):
        one, two = (force.law.along((factor * values[0], *values[1:]), x, v, t) for factor in (1.0, 2.0))
        bad = np.flatnonzero(~np.isfinite(one))
        if len(bad):
            k = bad[0]
            at = f"{'d' if force.where == 'storey' else 'u'} = {x[k]:g} m, v = {v[k]:g} m/s, t = {t[k]:g} s"
            raise CaseError(f"{where} gives {one[k]:g} at {at}; it must give a finite force everywhere")
        if not np.allclose(two, 2 * one, rtol=1e-6, atol=1e-9 * float(np.abs(one).max())):
            raise CaseError(
                f"{where}: the force is not proportional to the first parameter, {force.parameters[0].name!r}; "
                "put the one first that says how strong the effect is"
            )
        moved = moved or bool(np.any(one))
    if not moved:
        raise CaseError(f"{where} gives no force for motions up to 50 mm and 1 m/s at its typical parameters")


def _check_units(where: str, function: Callable[..., Any], parameters: Sequence[UserParameter]) -> None:
    """Refuse a function that does not return newtons when it is given quantities with units."""
    quantities = [
        parameter.sizes[0] / parameter.to_si * _to_si(where, parameter.name, parameter.unit)
        for parameter in parameters
    ]
    pint, units = extra_module("pint"), _units()
    metre, second, newton = units.metre, units.second, units.newton
    for x, v, t in product((0.05, -0.05), (1.0, -1.0), (7.0,)):
        try:
            result = function(x * metre, v * metre / second, t * second, *quantities)
        except pint.DimensionalityError as error:
            if str(error.units2) in ("dimensionless", ""):
                return  # A function of plain numbers, such as math.sqrt, which knows no units: nothing to learn here.
            raise CaseError(f"{where} does not fit its units: {error}") from error
        except Exception:
            return  # What compiles need not work on quantities.
        plain = not isinstance(result, pint.Quantity)
        if (result if plain else result.magnitude) == 0.0:
            continue  # Nothing has no unit: `max(v, 0.0)` loses it.
        if plain or not result.check(newton):
            given = "a plain number" if plain else f"{result.to_base_units().units:~}"
            raise CaseError(
                f"{where} returns {given} where a force in N is wanted; check the parameters' units"
            )
