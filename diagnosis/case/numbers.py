"""Numbers of a case that are no histories: modal data (`[[modal]]`) and peaks (`[[peak]]`), with standard deviations."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ModalDatum:
    """A measured frequency [Hz], roof stiffness [N/m] or mass [kg] of a frame, with its standard deviation.

    `mode` counts from 1 and is None but for frequencies. `test` is the name of the test that it comes from.
    """

    frame: str
    quantity: str
    mode: int | None
    test: str
    value: float
    std: float


@dataclass(frozen=True)
class Peak:
    """Largest displacement of a floor relative to the table [m] towards +x (``max``) or -x (``min``, positive too)."""

    run: str
    frame: str
    floor: int
    side: str
    value: float
    std: float
