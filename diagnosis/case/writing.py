"""Writing a case: the folder that `read_case` reads."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import msgspec

from pounding.diagnosis.case.case import Case, CaseFrame, Channel, Contact, Prior
from pounding.diagnosis.case.csv import write_run
from pounding.diagnosis.case.numbers import ModalDatum
from pounding.diagnosis.case.places import FILE
from pounding.diagnosis.case.quantities import MODAL_UNITS
from pounding.frames.files import write_whole
from pounding.units import si


def write_case(case: Case, folder: Path | str) -> Path:
    """Write a case: its CSV files first and `case.toml` last, so that a folder with it is whole.

    Args:
        case: The case; its runs hold SI and are written in the channels' units.
        folder: Made if it is not there.

    Returns:
        The path of `case.toml`.
    """
    folder, files = Path(folder), _files(case)
    for run in case.runs:
        write_run(folder / files[run.file], run, case.channels)
    write_whole(folder / FILE, _toml(case, files).encode())
    return folder / FILE


def _files(case: Case) -> dict[str, str]:
    """Return where each run is written in the folder, by the file that the case states, which may be outside of its own."""
    found: dict[str, str] = {}
    for number, run in enumerate(case.runs, 1):
        path = Path(run.file)
        inside = not path.is_absolute() and ".." not in path.parts
        name = run.file if inside else path.name
        found[run.file] = name if name not in found.values() else f"{number}-{path.name}"
    return found


def _toml(case: Case, files: dict[str, str]) -> str:
    blocks = [_block("", {"title": case.title})]
    blocks += [_block("[[frame]]", _frame_keys(frame)) for frame in case.frames]
    blocks += [_block("[[run]]", {"file": files[run.file], "role": run.role}) for run in case.runs]
    blocks += [_block("[[channel]]", _channel_keys(channel)) for channel in case.channels]
    blocks += [_block("[[contact]]", _contact_keys(contact)) for contact in case.contacts]
    blocks += [_block("[[modal]]", _modal_keys(datum)) for datum in case.modal]
    blocks += [
        _block("[[peak]]", asdict(peak) | {"run": files[peak.run], "unit": "m"}) for peak in case.peaks
    ]
    changed = {
        name: value
        for name, value in msgspec.structs.asdict(case.prior).items()
        if value != getattr(Prior(), name)
    }
    if changed:
        blocks.append(_block("[prior]", changed))
    return "\n".join(blocks)


def _frame_keys(frame: CaseFrame) -> dict[str, Any]:
    keys: dict[str, Any] = {"name": frame.name}
    if frame.kind == "file":
        # The copy lies in another folder, from which a relative path would lead elsewhere.
        keys["file"] = str(Path(frame.file or "").resolve())
    if frame.joints != "calibrated":
        keys["joints"] = frame.joints
    if not frame.p_delta:
        keys["p_delta"] = False
    if frame.kind == "modal":
        keys |= {"storeys": frame.storeys, "storey_height_m": frame.storey_height_m}
        keys |= {"floor_mass_kg": list(frame.floor_mass_kg), "frequency_hz": list(frame.frequency_hz)}
        keys |= {"damping_ratio": list(frame.damping_ratio), "scale": frame.scale}
    return keys


def _modal_keys(datum: ModalDatum) -> dict[str, Any]:
    return asdict(datum) | {"unit": si(MODAL_UNITS[datum.quantity])}


def _channel_keys(channel: Channel) -> dict[str, Any]:
    keys = {"name": channel.name, "frame": channel.frame, "floor": channel.floor, "contact": channel.contact}
    stated = {"quantity": channel.quantity, "unit": channel.unit, "interpolation": channel.interpolation}
    return {**keys, **stated}


def _contact_keys(contact: Contact) -> dict[str, Any]:
    return {
        "left": contact.left,
        "right": contact.right,
        "floor": contact.floor,
        "gap_mm": float(f"{contact.gap_m * 1e3:.9g}"),
        "law": contact.law,
        "stiffness_n_per_m": contact.stiffness,
        "damping_n_s_per_m": contact.damping,
        "restitution": contact.restitution,
    }


def _block(header: str, keys: dict[str, Any]) -> str:
    lines = [header] if header else []
    for key, value in keys.items():
        if value is None or value == []:
            continue
        # TOML writes strings and numbers as JSON does, and lists too.
        lines.append(f"{key} = {msgspec.json.encode(value).decode()}")
    return "\n".join(lines) + "\n"
