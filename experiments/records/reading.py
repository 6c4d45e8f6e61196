"""One door for all formats of a ground motion."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from pounding.experiments.errors import ExperimentError
from pounding.experiments.records.agencies import read_at2, read_knet, read_v2
from pounding.experiments.records.columns import read_columns
from pounding.experiments.records.record import Record
from pounding.experiments.records.reference import REFERENCES
from pounding.experiments.text_file import read_text

_KNET = tuple(f".{part}{number}" for part in ("ew", "ns", "ud") for number in ("", "1", "2"))
_READERS: dict[str, Callable[[Path, str], Record]] = {
    ".at2": read_at2,
    ".v2": read_v2,
    ".v2c": read_v2,
    **dict.fromkeys(_KNET, read_knet),
}
_COLUMNS = (".csv", ".txt", ".tsv", ".dat")
SUFFIXES = (*_COLUMNS[:1], *_READERS, *_COLUMNS[1:])
"""File name endings that can be read, in lower case, in the order in which a name is looked for."""


def read(path: Path | str, unit: str | None = None) -> Record:
    """Read a ground motion; the ending of the file's name says the format.

    Args:
        path: `.AT2` (PEER), `.V2` and `.V2c` (CSMIP, COSMOS), `.EW`, `.NS`, `.UD` and so on (K-NET, KiK-net),
            otherwise two columns of text (`.csv`, `.txt`, `.tsv`, `.dat`).
        unit: Unit of acceleration where a two-column file does not name it; `--record-unit` of the command.

    Returns:
        The record in m/s^2, named by the file's stem; `kobe.csv` gives `kobe-file`, because the names of
        the tests' motions are only given by `find`, which checks them.

    Raises:
        ExperimentError: A file that is not there, of no known format, or broken; the message says where.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise ExperimentError(f"{path}: '{path.suffix}' is no known format; use {', '.join(SUFFIXES)}")
    if unit is not None and suffix in _READERS:
        raise ExperimentError(f"{path}: a {suffix} file states its own unit; leave out the unit '{unit}'")
    try:
        # Names of stations in headers may be in Latin-1, in which every byte is a character.
        text = read_text(path, str(path), ExperimentError, fallback="latin-1")
    except OSError as error:
        raise ExperimentError(f"{path}: cannot be read ({error.strerror})") from None
    record = _READERS[suffix](path, text) if suffix in _READERS else read_columns(path, text, unit)
    if record.pga_m_s2 == 0.0:
        raise ExperimentError(
            f"{path}: the acceleration is zero throughout; a motion needs a peak above zero"
        )
    return record.renamed(f"{path.stem}-file") if path.stem.lower() in REFERENCES else record
