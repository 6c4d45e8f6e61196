"""What must hold between the keys of `case.toml`: frames, channels and contacts that fit each other."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from pounding import bounds
from pounding.bounds import Bound
from pounding.diagnosis.case.case import REFERENCE, Case, CaseFrame, Channel, Contact, Prior
from pounding.diagnosis.case.number_tables import check_modal, check_peaks
from pounding.diagnosis.case.place import in_words
from pounding.diagnosis.case.quantities import (
    ABSOLUTE,
    LAWS,
    OF_A_CONTACT,
    OF_THE_TABLE,
    UNDAMPED_LAWS,
    UNITS,
)
from pounding.diagnosis.errors import CaseError
from pounding.errors import InputError
from pounding.frames.definition import PlateFrame
from pounding.frames.errors import FrameError
from pounding.frames.floors import level_floors
from pounding.frames.loading import load
from pounding.frames.scale import LOWEST_STOREY_M, known_scale
from pounding.scale import FULL_SCALE, Scale, scale_of
from pounding.spelling import did_you_mean
from pounding.toml_text import key_meant, shown
from pounding.units import LENGTH, named

if TYPE_CHECKING:
    from pounding.diagnosis.case.places import Places
    from pounding.diagnosis.case.tables import ChannelTable, ContactTable, Description, FrameTable
    from pounding.frames.definition import Frame

ROLES = ("training", "held_out", REFERENCE)
OWN = ("storeys", "storey_height_m", "floor_mass_kg", "frequency_hz", "damping_ratio")
"""Keys of a frame that is given by its masses and modes."""
OF_PLATES = ("base_stiffness", "joint_stiffness")
"""Priors of frames of plates and columns whose joints turn."""
JOINTS = ("calibrated", "rigid")
INTERPOLATIONS = ("zoh", "linear")


def check(described: Description, folder: Path, places: Places) -> tuple[Case, list[tuple[str, str | None]]]:
    """Return the case without its runs, and the runs' files and roles.

    Whether something of use is measured at all is left to `check_what_is_measured`.

    Args:
        described: The tables of `case.toml`.
        folder: Folder of the case, from which files are found.
        places: Where things stand in `case.toml`, for messages.

    Raises:
        CaseError: Two keys contradict each other, or a value is outside its meaning.
    """
    known = tuple(_frame(table, i, folder, places) for i, table in enumerate(described.frame))
    _unique([frame.name for frame in known], "frame", places)
    _check_scales(known, places)
    _unique([run.file for run in described.run], "run", places)
    _unique([channel.name for channel in described.channel], "channel", places)
    contacts = tuple(_contact(table, i, known, places) for i, table in enumerate(described.contact))
    channels = tuple(
        _channel(table, i, known, len(contacts), places) for i, table in enumerate(described.channel)
    )
    if described.run:
        _check_roles(described, places)
    for name, value in msgspec.structs.asdict(described.prior).items():
        bound = bounds.MODEL_ERROR if name == "model_error" else bounds.PRIOR
        fault = bound.fault(value, f"[prior] {name}")
        if fault:
            raise places.error(fault, "prior", 0, name)
        if name in OF_PLATES and value != getattr(Prior(), name) and not any(map(_has_joints, known)):
            what = f"[prior] {name} is that of plates and columns whose joints turn, and no frame here has any; leave it out"
            raise places.error(what, "prior", 0, name)
    case = Case(
        described.title or folder.resolve().name, folder, known, (), channels, contacts, described.prior,
        modal=check_modal(described.modal, known, places),
        peaks=check_peaks(described.peak, known, [run.file for run in described.run], places),
    )  # fmt: skip
    return case, [(run.file, run.role) for run in described.run]


def _unique(names: list[str], table: str, places: Places) -> None:
    for index, name in enumerate(names):
        if not name.isprintable():
            what = f"{table} {shown(name)} holds a character that cannot be printed; leave it out"
            raise places.error(what, table, index)
        if name in names[:index]:
            raise places.error(f"{table} {name!r} stands there twice; rename or remove one", table, index)


def _frame(table: FrameTable, index: int, folder: Path, places: Places) -> CaseFrame:
    def error(what: str, key: str = "") -> CaseError:
        return places.error(f"frame {table.name or table.file or index + 1!r}: {what}", "frame", index, key)

    own = {key: getattr(table, key) for key in OWN}
    given = [key for key, value in own.items() if value is not None]
    if table.scale is not None and not given:
        raise error("`scale` belongs to a frame of masses and modes; a frame file states its own", "scale")
    if table.file is not None:
        if given:
            raise error(f"{given[0]!r} stands beside `file`; keep one of the two", given[0])
        path = Path(table.file) if Path(table.file).is_absolute() else folder / table.file
        if not path.is_file():
            raise error(f"{path} is not there; correct `file`", "file")
        definition = _load(path, error)
        if definition.yielding is not None:
            what = "states `yielding`, and the baseline model is linear; leave that out, yielding is looked for as an effect"
            raise error(f"{path} {what}", "file")
        return CaseFrame(
            table.name or definition.name, definition.storeys, file=path, **_options(table, error)
        )
    if not table.name:
        raise error("the key 'name' is missing; add it")
    if not given:
        return CaseFrame(table.name, _load(table.name, error).storeys, **_options(table, error))
    for key in ("joints", "p_delta"):
        if getattr(table, key) is not None:
            raise error(f"`{key}` belongs to a frame of plates and columns, not beside {given[0]!r}", key)
    return _baseline_frame(table, given, error)


def _check_scales(known: Sequence[CaseFrame], places: Places) -> None:
    """Refuse frames of two scales: they would stand on one table under one record."""
    scales = [(frame.name, scale) for frame in known if (scale := _known_scale(frame)) is not None]
    for index, (name, scale) in enumerate(scales):
        first, other = scales[0]
        if not scale.is_near(other):
            what = f"frame {first!r} ({other}) and frame {name!r} ({scale}) are of two scales; give both the same"
            raise places.error(what, "frame", index, "scale")


def _known_scale(frame: CaseFrame) -> Scale | None:
    if frame.kind != "modal":
        return known_scale(load(frame.file or frame.name))
    if frame.scale is not None:
        return scale_of(frame.scale, "scale", CaseError)
    return FULL_SCALE if (frame.storey_height_m or 0.0) >= LOWEST_STOREY_M else None


def _has_joints(frame: CaseFrame) -> bool:
    """Return whether a frame is of plates and columns whose joints turn."""
    if frame.kind == "modal" or frame.joints == "rigid":
        return False
    return isinstance(load(frame.file or frame.name), PlateFrame)


def _options(table: FrameTable, error: Callable[..., CaseError]) -> dict[str, Any]:
    if table.joints not in (None, *JOINTS):
        raise error(f"joints is {table.joints!r}; write 'calibrated' or 'rigid'", "joints")
    return {"joints": table.joints or "calibrated", "p_delta": table.p_delta is not False}


def _load(frame: str | Path, error: Callable[..., CaseError]) -> Frame:
    try:
        return load(frame)
    except FrameError as wrong:
        key = "file" if isinstance(frame, Path) else "name"
        own = (
            ""
            if key == "file"
            else ". A frame of your own needs storeys, floor_mass_kg, frequency_hz, ..., or file."
        )
        raise error(f"{wrong}{own}", key) from None


def _baseline_frame(table: FrameTable, given: list[str], error: Callable[..., CaseError]) -> CaseFrame:
    for key in OWN:
        if key not in given:
            raise error(f"the key {key!r} is missing; a frame of one's own needs it beside {given[0]!r}")
    storeys, height = table.storeys or 0, table.storey_height_m or 0.0
    masses, frequencies = tuple(table.floor_mass_kg or ()), tuple(table.frequency_hz or ())
    ratios = tuple(table.damping_ratio or ())
    _within(storeys, "storeys", bounds.STOREYS, error)
    _within(height, "storey_height_m", bounds.LENGTH, error)
    if len(masses) != storeys:
        what = f"floor_mass_kg has {len(masses)} values; give {storeys}, one a floor"
        raise error(what, "floor_mass_kg")
    for mass in masses:
        _within(mass, "floor_mass_kg", bounds.MASS, error)
    for frequency in frequencies:
        _within(frequency, "frequency_hz", bounds.FREQUENCY, error)
    rising = all(low < high for low, high in pairwise((0.0, *frequencies, math.inf)))
    if not 1 <= len(frequencies) <= storeys or not rising:
        what = (
            f"frequency_hz holds {list(frequencies)}; give 1 to {storeys} frequencies above 0, lowest first"
        )
        raise error(what, "frequency_hz")
    if len(ratios) != len(frequencies) or not all(0 < ratio < 1 for ratio in ratios):
        what = f"damping_ratio holds {list(ratios)}; give a fraction above 0 and below 1 for each of the frequencies"
        raise error(what, "damping_ratio")
    if table.scale is not None:
        try:
            scale_of(table.scale, "scale")
        except InputError as wrong:
            raise error(str(wrong), "scale") from None
    return CaseFrame(table.name, storeys, None, height, masses, frequencies, ratios, scale=table.scale)


def _within(value: float, key: str, bound: Bound, error: Callable[..., CaseError]) -> None:
    fault = bound.fault(value, key)
    if fault:
        raise error(fault, key)


def _channel(
    table: ChannelTable, index: int, known: tuple[CaseFrame, ...], contacts: int, places: Places
) -> Channel:
    def error(what: str, key: str = "") -> CaseError:
        return places.error(f"channel {table.name!r}: {what}", "channel", index, key)

    if table.name in ("", "time_s"):
        raise error("that name cannot be a channel's; give it another", "name")
    if table.quantity not in UNITS:
        raise error(f"unknown quantity {table.quantity!r}{suggest(table.quantity, list(UNITS))}", "quantity")
    units = UNITS[table.quantity]
    unit = table.unit if table.unit in units else named(table.unit)
    if unit not in units:
        raise error(
            f"unit {table.unit!r} is none of {table.quantity}'s; use one of {', '.join(units)}", "unit"
        )
    table = msgspec.structs.replace(table, unit=unit)
    channel = _placed(table, known, contacts, error)
    if table.interpolation is None:
        return channel
    if table.interpolation not in INTERPOLATIONS:
        end = suggest(table.interpolation, list(INTERPOLATIONS))
        raise error(f"unknown interpolation {table.interpolation!r}{end}", "interpolation")
    if not channel.is_table_acceleration:
        what = "interpolation says what the table does between samples; state it of the table's acceleration only"
        raise error(what, "interpolation")
    return replace(channel, interpolation=table.interpolation)


def _placed(
    table: ChannelTable, known: tuple[CaseFrame, ...], contacts: int, error: Callable[..., CaseError]
) -> Channel:
    if table.quantity in OF_THE_TABLE:
        return Channel(table.name, table.quantity, table.unit)
    if table.quantity in OF_A_CONTACT:
        if table.contact is None or not 1 <= table.contact <= contacts:
            lists = f"the case lists {contacts} [[contact]]" + (", counted from 1" if contacts else "")
            what = (
                f"a {table.quantity} needs the number of its contact, contact = 1; {lists}"
                if table.contact is None
                else f"contact {table.contact} is not there; {lists}"
            )
            raise error(what, "contact")
        return Channel(table.name, table.quantity, table.unit, contact=table.contact)
    return _floor_channel(table, known, error)


def _floor_channel(
    table: ChannelTable, known: tuple[CaseFrame, ...], error: Callable[..., CaseError]
) -> Channel:
    name = table.frame if table.frame is not None or len(known) > 1 else known[0].name
    if name is None:
        raise error("the key 'frame' is missing; add the frame that it sits on")
    frame = next((frame for frame in known if frame.name == name), None)
    if frame is None:
        raise error(f"frame {name!r} is not in the case{suggest(name, [f.name for f in known])}", "frame")
    if table.floor is None:
        raise error("the key 'floor' is missing; add the floor that it sits on")
    lowest = 0 if table.quantity in ABSOLUTE else 1
    if not lowest <= table.floor <= frame.storeys:
        what = f"floor {table.floor} is not on {name}, which has {frame.storeys}"
        if table.floor == 0:
            what = f"{table.quantity} of floor 0, the table, is zero by definition"
        raise error(f"{what}; give a floor from {lowest} to {frame.storeys}", "floor")
    return Channel(table.name, table.quantity, table.unit, frame=name, floor=table.floor)


def _contact(table: ContactTable, index: int, known: tuple[CaseFrame, ...], places: Places) -> Contact:
    def error(what: str, key: str = "") -> CaseError:
        return places.error(f"contact {index + 1}: {what}", "contact", index, key)

    by_name = {frame.name: frame for frame in known}
    for key, name in (("left", table.left), ("right", table.right)):
        if name not in by_name:
            raise error(f"{key} = {name!r} is no frame of the case{suggest(name, list(by_name))}", key)
    if table.left == table.right:
        raise error(f"{table.left!r} cannot touch itself; name two frames", "right")
    highest = min(by_name[table.left].storeys, by_name[table.right].storeys)
    if not 1 <= table.floor <= highest:
        raise error(f"floor {table.floor} is not on both frames; give one from 1 to {highest}", "floor")
    _check_level(table.floor, by_name[table.left], by_name[table.right], error)
    if table.law not in LAWS:
        raise error(f"unknown law {table.law!r}{suggest(table.law, list(LAWS))}", "law")
    fault = bounds.GAP.fault(table.gap_mm, "gap_mm", per=LENGTH["mm"], unit="mm")
    if fault:
        raise error(fault, "gap_mm")
    _within(table.stiffness_n_per_m, "stiffness_n_per_m", bounds.CONTACT_STIFFNESS, error)
    damping, restitution = table.damping_n_s_per_m, table.restitution
    if damping is not None:
        _within(damping, "damping_n_s_per_m", bounds.DASHPOT, error)
    if restitution is not None and not 0 < restitution <= 1:
        raise error(f"restitution is {restitution:g}; it lies above 0 and up to 1", "restitution")
    if table.law not in UNDAMPED_LAWS and (damping is None) == (restitution is None):
        raise error("give one of damping_n_s_per_m and restitution")
    return Contact(
        table.left, table.right, table.floor, table.gap_mm * 1e-3, table.law,
        table.stiffness_n_per_m, damping, restitution,
    )  # fmt: skip


def _check_level(floor: int, left: CaseFrame, right: CaseFrame, error: Callable[..., CaseError]) -> None:
    heights = [_floor_heights_m(frame) for frame in (left, right)]
    level = level_floors(*heights)
    if (floor, floor) in level:
        return
    others = ", ".join(str(one) for one, other in level if one == other)
    places = [
        f"{in_words(frame=frame.name, floor=floor)} at {height[floor - 1]:.4g} m"
        for frame, height in zip((left, right), heights, strict=True)
    ]
    end = f"give one of {others}" if others else "no floors of equal number are level on these two"
    raise error(f"{places[0]} and {places[1]} are not level and cannot touch; {end}", "floor")


def _floor_heights_m(frame: CaseFrame) -> list[float]:
    if frame.storey_height_m is not None:
        return [frame.storey_height_m * number for number in range(1, frame.storeys + 1)]
    return load(frame.file or frame.name).floor_heights_m


def _check_roles(described: Description, places: Places) -> None:
    for index, run in enumerate(described.run):
        if run.role is not None and run.role not in ROLES:
            end = suggest(run.role, list(ROLES))
            raise places.error(f"run {run.file!r}: unknown role {run.role!r}{end}", "run", index, "role")
    if all(run.role == "held_out" for run in described.run):
        what = "every run is held out, so there is nothing to learn from; leave the role out of one"
        raise places.error(what, "run", 0, "role")
    before = next((index for index, run in enumerate(described.run) if run.role == REFERENCE), None)
    if before is not None:
        _check_references(described, before, places)


def _check_references(described: Description, index: int, places: Places) -> None:
    """Refuse what cannot stand beside reference runs, of which `index` is the first."""
    since = {run.role for run in described.run} - {REFERENCE}
    what = ""
    if not since:
        what = (
            "every run is a reference, so there is no run in which something could have changed; add one without that role, "
            "or leave the role out to diagnose these runs themselves"
        )
    elif since == {"held_out"}:
        what = "every run but the references is held out, so there is nothing to learn from; leave the role out of one"
    elif described.contact:
        what = (
            "a reference run cannot stand beside a [[contact]]; give each frame's runs alone as a case of their own, "
            "or leave the role out"
        )
    elif described.modal:
        what = (
            "a reference run cannot stand beside [[modal]], as nothing says whether these numbers are from before or since; "
            "leave one of the two out"
        )
    if what:
        raise places.error(f"run {described.run[index].file!r}: {what}", "run", index, "role")


def check_what_is_measured(channels: Sequence[Channel], places: Places) -> None:
    """Refuse channels of which none says how the table moved, or none how a frame answered.

    Args:
        channels: The channels of a case with runs.
        places: Where things stand in `case.toml`, for messages.

    Raises:
        CaseError: Such a channel is missing.
    """
    if not any(channel.is_table for channel in channels):
        what = "no channel says how the table moved; add one of table_acceleration or table_displacement"
        raise places.error(what)
    if all(channel.is_table for channel in channels):
        raise places.error("no channel measures a frame; add at least one of its response")


def suggest(word: str, known: list[str]) -> str:
    """Return the end of a sentence: the known words that the word is a part of, else the nearest one and all of them."""
    of_it = [item for item in known if word.lower() in item.lower().split("_")]
    if len(of_it) > 1:
        return f"; say which: {', '.join(of_it)}"
    question = did_you_mean(key_meant(word, known), repr)
    near = f"{question} Allowed are" if question else "use one of"
    return f"; {near} {', '.join(known)}"
