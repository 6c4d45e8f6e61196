"""The tables `[[modal]]` and `[[peak]]` of `case.toml`, checked and in SI."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import msgspec

from pounding import bounds
from pounding.bounds import Bound
from pounding.diagnosis.case.numbers import ModalDatum, Peak
from pounding.diagnosis.case.quantities import MODAL_BOUNDS, MODAL_UNITS
from pounding.units import LENGTH

if TYPE_CHECKING:
    from pounding.diagnosis.case.case import CaseFrame
    from pounding.diagnosis.case.places import Places
    from pounding.diagnosis.errors import CaseError


SIDES = ("max", "min")


class ModalTable(msgspec.Struct, forbid_unknown_fields=True):
    """One ``[[modal]]``."""

    quantity: str
    value: float
    unit: str
    std: float
    frame: str | None = None
    mode: int | None = None
    test: str = "test"


class PeakTable(msgspec.Struct, forbid_unknown_fields=True):
    """One ``[[peak]]``."""

    run: str
    floor: int
    side: str
    value: float
    unit: str
    std: float
    frame: str | None = None


def check_modal(
    tables: Sequence[ModalTable], known: tuple[CaseFrame, ...], places: Places
) -> tuple[ModalDatum, ...]:
    """Return modal data in SI.

    Args:
        tables: The `[[modal]]` tables.
        known: Frames of the case.
        places: Where things stand in `case.toml`, for messages.

    Raises:
        CaseError: A frame, quantity, unit or mode that is not there, or a value without a positive uncertainty.
    """
    found = []
    for index, table in enumerate(tables):

        def error(what: str, key: str = "", index: int = index) -> CaseError:
            return places.error(f"modal {index + 1}: {what}", "modal", index, key)

        units = MODAL_UNITS.get(table.quantity)
        if units is None:
            raise error(
                f"unknown quantity {table.quantity!r}; use one of {', '.join(MODAL_UNITS)}", "quantity"
            )
        factor = _factor(table.unit, units, error)
        frame = _frame(table.frame, known, error)
        if (table.mode is not None) != (table.quantity == "frequency"):
            raise error("a frequency needs `mode`, counted from 1, and nothing else has one", "mode")
        if table.mode is not None and not 1 <= table.mode <= frame.storeys:
            raise error(f"mode {table.mode} is not one of {frame.name}'s {frame.storeys}", "mode")
        _check_number(MODAL_BOUNDS[table.quantity], table.value, table.std, factor, table.unit, error)
        found.append(
            ModalDatum(
                frame.name, table.quantity, table.mode, table.test, table.value * factor, table.std * factor
            )
        )
    return tuple(found)


def check_peaks(
    tables: Sequence[PeakTable], known: tuple[CaseFrame, ...], runs: Sequence[str], places: Places
) -> tuple[Peak, ...]:
    """Return peaks in SI.

    Args:
        tables: The `[[peak]]` tables.
        known: Frames of the case.
        runs: Files of the runs.
        places: Where things stand in `case.toml`, for messages.

    Raises:
        CaseError: A run, frame, floor, side or unit that is not there, or a value without a positive uncertainty.
    """
    found = []
    for index, table in enumerate(tables):

        def error(what: str, key: str = "", index: int = index) -> CaseError:
            return places.error(f"peak {index + 1}: {what}", "peak", index, key)

        if table.run not in runs:
            raise error(f"run {table.run!r} is not listed; name the file of a [[run]]", "run")
        if table.side not in SIDES:
            raise error(f"side {table.side!r} is neither 'max' (towards +x) nor 'min'", "side")
        factor = _factor(table.unit, LENGTH, error)
        frame = _frame(table.frame, known, error)
        if not 1 <= table.floor <= frame.storeys:
            raise error(f"floor {table.floor} is not on {frame.name}, which has {frame.storeys}", "floor")
        _check_number(bounds.PEAK, table.value, table.std, factor, table.unit, error)
        found.append(
            Peak(table.run, frame.name, table.floor, table.side, table.value * factor, table.std * factor)
        )
    return tuple(found)


def _factor(unit: str, units: dict[str, float], error: Callable[..., CaseError]) -> float:
    if unit not in units:
        raise error(f"unit {unit!r} does not fit; use one of {', '.join(units)}", "unit")
    return units[unit]


def _frame(name: str | None, known: tuple[CaseFrame, ...], error: Callable[..., CaseError]) -> CaseFrame:
    if name is None and len(known) == 1:
        return known[0]
    for frame in known:
        if frame.name == name:
            return frame
    raise error(f"frame {name!r} is not in the case; name one of {', '.join(f.name for f in known)}", "frame")


def _check_number(
    bound: Bound, value: float, std: float, factor: float, unit: str, error: Callable[..., CaseError]
) -> None:
    fault = bound.fault(value, "value", per=factor, unit=unit)
    if fault:
        raise error(fault, "value")
    fault = bounds.RELATIVE_STD.fault(std / value, "std, one standard deviation, over the value,")
    if fault:
        raise error(fault, "std")
