"""Finding a ground motion by name: the user's folder first, then installed packages, never a substitute."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from pounding.experiments.errors import ExperimentError
from pounding.experiments.records.packaged import PACKAGED, how_to_get, is_installed, load_packaged
from pounding.experiments.records.reading import SUFFIXES, read
from pounding.experiments.records.record import Record
from pounding.experiments.records.reference import REFERENCES, verified
from pounding.spelling import did_you_mean, nearest

VARIABLE = "POUNDING_RECORDS"


@dataclass(frozen=True)
class Entry:
    """One line of the list of motions.

    Attributes:
        name: By which `find` finds it.
        title: What it is.
        found: File or package, or None if it is missing or no good.
        note: How to get it, or why the file that is there may not be called so; empty if all is well.
    """

    name: str
    title: str
    found: str | None
    note: str = ""


def records_folder(folder: Path | str | None = None) -> Path | None:
    """Return the folder of records: the argument, else that of POUNDING_RECORDS, else None.

    Raises:
        ExperimentError: A folder is named that is not there.
    """
    said = str(folder) if folder is not None else os.environ.get(VARIABLE, "")
    if not said:
        return None
    path = Path(said).expanduser()
    if not path.is_dir():
        whence = "--records" if folder is not None else VARIABLE
        raise ExperimentError(f"folder of records '{said}' (from {whence}) is not there")
    return path


def find(name: str, folder: Path | str | None = None, *, unit: str | None = None) -> Record:
    """Return a ground motion by name.

    The folder is looked through first, for a file whose stem is the name in any case (`kobe.csv`,
    `KOBE.AT2`), then the installed packages. A path to a file works too. The names elcentro, hachinohe,
    northridge and kobe are given only to what passes `reference.verified`.

    Args:
        name: Name of a motion, stem of a file in the folder, or path of a file.
        folder: Where files are; default: the environment variable POUNDING_RECORDS.
        unit: Unit of acceleration for two-column files that do not name it.

    Raises:
        ExperimentError: Nothing of that name, more than one file of that name, a broken file, the wrong
            motion under a reserved name, or a unit for a motion of a package. The message says where to get the
            right one.
    """
    file, plain = file_of(name, folder), name.strip().lower()
    if file is not None:
        return _checked(file.stem.lower(), read(file, unit))
    if plain in PACKAGED and unit is not None:
        raise ExperimentError(
            f"record '{plain}' is installed with its unit; leave out the unit '{unit}', which is for files"
        )
    if plain in PACKAGED:
        return load_packaged(plain)
    raise ExperimentError(_missing(name, records_folder(folder)))


def file_of(name: str, folder: Path | str | None = None) -> Path | None:
    """Return the file from which `find` reads a ground motion; None if it is in no file of the user's.

    Args:
        name: Name of a motion, stem of a file in the folder, or path of a file.
        folder: Where files are; default: the environment variable POUNDING_RECORDS.

    Raises:
        ExperimentError: More than one file of that name, or a folder that is not there.
    """
    if Path(name).suffix.lower() in SUFFIXES:
        return Path(name)
    base = records_folder(folder)
    files = _files(base).get(name.strip().lower(), []) if base else []
    if len(files) > 1:
        names = ", ".join(file.name for file in files)
        raise ExperimentError(f"record '{name}' is ambiguous in {base}: {names}; keep one of them")
    return files[0] if files else None


def available(folder: Path | str | None = None) -> list[Entry]:
    """Return every motion known here: the four of the tests, packaged ones, then the user's own files.

    A file that is there but may not be called by its reserved name is listed with the reason.

    Raises:
        ExperimentError: A folder is named that is not there.
    """
    base = records_folder(folder)
    files = _files(base) if base else {}
    entries = [_reserved(name, base) for name in REFERENCES]
    for name, packaged in PACKAGED.items():
        there = is_installed(name) and name not in files
        note = "" if there or name in files else how_to_get(name)
        entries.append(Entry(name, packaged.title, packaged.package if there else None, note))
    for name, paths in files.items():
        if name not in REFERENCES:
            note = "" if len(paths) == 1 else f"ambiguous: {', '.join(path.name for path in paths)}"
            entries = [entry for entry in entries if entry.name != name]
            entries.append(Entry(name, f"file {paths[0].name}", None if note else str(paths[0]), note))
    return entries


def _checked(name: str, record: Record) -> Record:
    return verified(name, record) if name in REFERENCES else record


def _reserved(name: str, base: Path | None) -> Entry:
    title = REFERENCES[name].title
    try:
        return Entry(name, title, find(name, base).source)
    except ExperimentError as error:
        return Entry(name, title, None, str(error))


def _files(base: Path) -> dict[str, list[Path]]:
    """Return the readable files of a folder by lower-case stem."""
    found: dict[str, list[Path]] = {}
    for path in sorted(base.iterdir()):
        if path.is_file() and path.suffix.lower() in SUFFIXES:
            found.setdefault(path.stem.lower(), []).append(path)
    return found


def _missing(name: str, base: Path | None) -> str:
    plain = name.strip().lower()
    where = f"was not found in {base}" if base else "was not found, as no folder of records is given"
    if plain in REFERENCES:
        reference = REFERENCES[plain]
        return (
            f"record '{plain}' {where}: put {reference.title} ({reference.samples} samples,"
            f" {reference.step_s} s, {reference.pga_g:.3f} g) into a folder as {plain}.csv with the columns"
            f" time_s,acceleration_m_s2 and name the folder by --records or {VARIABLE}; {reference.obtain}"
        )
    known = list(dict.fromkeys([*REFERENCES, *PACKAGED, *(_files(base) if base else ())]))
    hint = did_you_mean(nearest(plain, known)) or f"known are {', '.join(known)}"
    return f"record '{name}' {where}: {hint}"
