"""The tables of `case.toml` as structs."""

from __future__ import annotations

import msgspec

from pounding.diagnosis.case.case import Prior
from pounding.diagnosis.case.number_tables import ModalTable, PeakTable


class FrameTable(msgspec.Struct, forbid_unknown_fields=True):
    """One ``[[frame]]``."""

    name: str = ""
    file: str | None = None
    storeys: int | None = None
    storey_height_m: float | None = None
    floor_mass_kg: list[float] | None = None
    frequency_hz: list[float] | None = None
    damping_ratio: list[float] | None = None
    joints: str | None = None
    p_delta: bool | None = None
    scale: str | float | None = None


class RunTable(msgspec.Struct, forbid_unknown_fields=True):
    """One ``[[run]]``."""

    file: str
    role: str | None = None


class ChannelTable(msgspec.Struct, forbid_unknown_fields=True):
    """One ``[[channel]]``."""

    name: str
    quantity: str
    unit: str
    frame: str | None = None
    floor: int | None = None
    contact: int | None = None
    interpolation: str | None = None


class ContactTable(msgspec.Struct, forbid_unknown_fields=True):
    """One ``[[contact]]``."""

    left: str
    right: str
    floor: int
    gap_mm: float
    law: str
    stiffness_n_per_m: float
    damping_n_s_per_m: float | None = None
    restitution: float | None = None


class Description(msgspec.Struct, forbid_unknown_fields=True):
    """The whole of `case.toml`."""

    frame: list[FrameTable]
    run: list[RunTable] = []
    channel: list[ChannelTable] = []
    title: str = ""
    modal: list[ModalTable] = []
    peak: list[PeakTable] = []
    contact: list[ContactTable] = []
    prior: Prior = Prior()
