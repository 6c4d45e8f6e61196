"""`pounding new-case`: a measured case from a logger's CSV files."""

from __future__ import annotations

from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from pounding import units
from pounding.diagnosis.case.drafting import Standing, draft, header_of, time_unit
from pounding.diagnosis.case.places import FILE
from pounding.diagnosis.case.time_stamps import TIME
from pounding.diagnosis.errors import CaseError
from pounding.experiments.console import options
from pounding.experiments.console.output import printer
from pounding.experiments.output import result_folder
from pounding.frames import load
from pounding.frames.files import write_whole

PAIR = 2
"""Frames that a case has at most."""


def new_case(
    *files: Path,
    frame: Annotated[
        list[str],
        Parameter(
            negative=(),
            help="Name of a shipped frame, or your own frame file; give both of two that may touch, from left to right.",
        ),
    ],
    out: Annotated[
        Path, Parameter(help="Folder of the case; created if missing.", validator=options.writable_folder)
    ],
) -> None:
    """Write a measured case from CSV files: what each column measures is guessed from its name and marked as a guess.

    The CSV files are copied into the folder beside case.toml. Nothing is overwritten.

    Args:
        files: CSV files of the runs, of one header: the time in s or ms first, then one column for each sensor.
    """
    if not files:
        raise CaseError("no CSV file was given; name the file of each run")
    if (out / FILE).exists():
        raise CaseError(f"{out / FILE} is there already; name another folder, or remove it first")
    headers = [header_of(file) for file in files]
    _check_alike(files, headers)
    standing = _standing(frame)
    copies = {file.name: _with_time(file, header) for file, header in zip(files, headers, strict=True)}
    copies |= {Path(one).name: Path(one).read_bytes() for one in frame if _is_file(one)}
    missing = _missing(out, copies)
    result_folder.prepare(out)
    for name in missing:
        write_whole(out / name, copies[name])
    names = [file.name for file in files]
    text = draft(standing, names, headers[0][1:])
    write_whole(out / FILE, text.encode())
    printer().print(f"written: {out / FILE}; check each line that says 'guess'", markup=False, soft_wrap=True)
    printer().print(_next_step(out), markup=False, soft_wrap=True)


def _is_file(frame: str) -> bool:
    return Path(frame).suffix == ".toml"


def _standing(frames: list[str]) -> list[Standing]:
    if len(frames) > PAIR:
        raise CaseError(f"{len(frames)} frames were given; a case has one, or two that may touch")
    definitions = [load(one) for one in frames]
    names = [definition.name for definition in definitions]
    if len(set(names)) < len(names):
        raise CaseError(f"both frames are called {names[0]!r}; give one of them another name in its file")
    return [
        Standing(definition.name, definition.storeys, Path(one).name if _is_file(one) else None)
        for definition, one in zip(definitions, frames, strict=True)
    ]


def _check_alike(files: tuple[Path, ...], headers: list[list[str]]) -> None:
    for number, file in enumerate(files):
        if file.name in [other.name for other in files[:number]]:
            raise CaseError(f"two files are called {file.name}; a case has all in one folder, so rename one")
        missing = [name for name in headers[0][1:] if name not in headers[number]]
        if missing:
            raise CaseError(
                f"{file.name} has no column {missing[0]!r} that {files[0].name} has; a case has one header"
            )


def _missing(out: Path, copies: dict[str, bytes]) -> list[str]:
    """Return the names of the files that are still to be copied; refuse to copy over another file."""
    if FILE in copies:
        raise CaseError(f"a file is called {FILE}, as the case itself will be; rename yours")
    there = [name for name in copies if (out / name).exists()]
    for name in there:
        if not (out / name).is_file() or (out / name).read_bytes() != copies[name]:
            raise CaseError(
                f"{out / name} is there already and would be changed; name another folder by --out"
            )
    return [name for name in copies if name not in there]


def _with_time(file: Path, header: list[str]) -> bytes:
    """Return the file's bytes with the first column called as a case calls it, and in its unit."""
    content = file.read_bytes()
    factor = units.TIME[time_unit(header[0]) or units.si(units.TIME)]
    if factor == 1.0:
        return content if header[0] == TIME else TIME.encode() + content[content.index(b",") :]
    first, *rows = content.splitlines(keepends=True)
    return b"".join([TIME.encode() + first[first.index(b",") :], *(_in_seconds(row, factor) for row in rows)])


def _in_seconds(row: bytes, factor: float) -> bytes:
    """Return a row with its time multiplied, all digits kept: to how many of them a logger writes says how exact it is."""
    time, comma, others = row.partition(b",")
    try:
        seconds = Decimal(time.decode().strip(' \t"')) * Decimal(str(factor))
    except (InvalidOperation, UnicodeDecodeError):
        return row  # An empty line, or a fault that is told where the case is read.
    return f"{seconds:f}".encode() + comma + others


def _next_step(out: Path) -> str:
    from pounding.diagnosis.case.reading import read_case

    try:
        read_case(out)
    except CaseError as error:
        return f"still to do: {error}"
    return f"{out} can be read; next: pounding diagnose {out} --out DIR"
