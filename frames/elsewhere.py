"""Files beside a frame file: a table of modes, mass and stiffness matrices; what they hold is taken into the frame.

A frame that was read needs its files no more: modes and condensed matrices are values of its definition, and so of the
provenance of every result.
"""

from __future__ import annotations

import csv
import math
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray
from scipy.io import mmread
from scipy.sparse import csc_matrix, issparse
from scipy.sparse.linalg import splu

from pounding.frames.errors import FrameError

Real = NDArray[np.float64]

SYMMETRIC = 1e-6
"""Largest difference between a matrix and its transpose, over its largest entry."""


def inlined(tree: dict[str, Any], folder: Path, place: str) -> dict[str, Any]:
    """Return the mapping of a frame file with what its files of modes or matrices hold in the place of nothing.

    Args:
        tree: Keys of a frame file; left as it is.
        folder: Where relative paths begin: the folder of the frame file.
        place: What messages call the frame file.

    Raises:
        FrameError: A file is missing or cannot be used; the sentence names it and says what to do.
    """
    modes, matrices = tree.get("modes"), tree.get("matrices")
    if isinstance(modes, dict) and isinstance(modes.get("file"), str) and modes["file"]:
        _nothing_beside(modes, ("frequency_hz", "damping_ratio", "shapes"), f"{place}: modes")
        tree = tree | {"modes": modes | table_of_modes(folder / modes["file"])}
    if isinstance(matrices, dict) and any(matrices.get(key) for key in ("mass_file", "stiffness_file")):
        _nothing_beside(matrices, ("mass_kg", "stiffness_n_per_m", "left_out"), f"{place}: matrices")
        tree = tree | {"matrices": matrices | _matrices(matrices, folder, place)}
    return tree


def _nothing_beside(given: dict[str, Any], keys: tuple[str, ...], where: str) -> None:
    for key in keys:
        if key in given:
            raise FrameError(f"{where}.{key} is stated beside a file that holds it; leave one of the two out")


def table_of_modes(path: Path) -> dict[str, list[Any]]:
    """Return frequencies [Hz], damping ratios and shapes of a CSV with one mode a row.

    The heads are ``frequency_hz``, ``damping_ratio``, ``floor_1`` and so on up to the roof.

    Args:
        path: The file.

    Raises:
        FrameError: It cannot be read, a column is missing, or a value is no number.
    """
    try:
        with path.open(newline="", encoding="utf-8-sig") as stream:
            rows = [[cell.strip() for cell in row] for row in csv.reader(stream) if any(row)]
    except (OSError, ValueError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or error
        raise FrameError(f"table of modes {path}: {reason}; write it as CSV in UTF-8") from error
    head = rows[0] if rows else []
    needed = ["frequency_hz", "damping_ratio", *(f"floor_{floor}" for floor in range(1, len(head) - 1))]
    if len(head) < 3 or head != needed:
        raise FrameError(
            f"table of modes {path}: its first line is {','.join(head)[:100]!r}; write frequency_hz,damping_ratio,"
            "floor_1,floor_2 and so on up to the roof, then one mode a line"
        )
    values = []
    for line, row in enumerate(rows[1:], 2):
        if len(row) != len(head):
            raise FrameError(f"table of modes {path}: line {line} has {len(row)} values, needs {len(head)}")
        try:
            values.append([float(cell) for cell in row])
        except ValueError:
            raise FrameError(
                f"table of modes {path}: line {line} holds a value that is no number; give the real part of a complex shape"
            ) from None
        if not all(map(math.isfinite, values[-1])):
            raise FrameError(
                f"table of modes {path}: line {line} holds a value that is not finite; leave the mode out"
            )
    if not values:
        raise FrameError(f"table of modes {path}: it holds no mode; write one a line")
    return {
        "frequency_hz": [row[0] for row in values],
        "damping_ratio": [row[1] for row in values],
        "shapes": [row[2:] for row in values],
    }


def _matrices(given: dict[str, Any], folder: Path, place: str) -> dict[str, Any]:
    for key in ("mass_file", "stiffness_file"):
        if not isinstance(given.get(key), str):
            raise FrameError(f"{place}: matrices.{key} is missing; name a .mtx or an .npz file")
    rows = given.get("floor_rows")
    if not isinstance(rows, list) or not rows or not all(type(row) is int for row in rows):
        raise FrameError(
            f"{place}: matrices.floor_rows is missing; list the row of each floor's displacement along x, counted from 1"
        )
    mass_file, stiffness_file = folder / given["mass_file"], folder / given["stiffness_file"]
    mass, stiffness = read_matrix(mass_file, "mass"), read_matrix(stiffness_file, "stiffness")
    size = stiffness.shape[0]
    if mass.shape != stiffness.shape:
        raise FrameError(
            f"matrix {mass_file}: it has {mass.shape[0]} rows and {stiffness_file} {size}; write both from one model"
        )
    if len(set(rows)) < len(rows) or not all(1 <= row <= size for row in rows):
        raise FrameError(
            f"{place}: matrices.floor_rows must be different rows from 1 to {size}, the size of {stiffness_file}"
        )
    kept = np.array(rows) - 1
    condensed_mass, condensed = condensed_to(stiffness, mass, kept, str(stiffness_file))
    _positive(condensed, f"matrix {stiffness_file}", "hold the base and leave out what can move freely")
    _positive(condensed_mass, f"matrix {mass_file}", "give every floor a mass")
    on_floors = float(mass[kept][:, kept].sum())
    return {
        "mass_kg": condensed_mass.tolist(),
        "stiffness_n_per_m": condensed.tolist(),
        "left_out": {
            "rows": size - len(kept),
            "diagonal_mass": float(mass.diagonal().sum() - mass.diagonal()[kept].sum()),
            "added_to_floors_kg": float(condensed_mass.sum() - on_floors),
        },
    }


def read_matrix(path: Path, name: str) -> csc_matrix:
    """Return a symmetric matrix (n, n) from a MatrixMarket file or the array ``name`` of an npz file.

    Args:
        path: A file that ends in .mtx or .npz.
        name: Name of the array in an npz file.

    Raises:
        FrameError: It cannot be read, is not square, not of finite numbers, or not symmetric.
    """
    where = f"matrix {path}"
    if path.suffix not in (".mtx", ".npz"):
        raise FrameError(f"{where}: its name must end in .mtx (MatrixMarket) or .npz (numpy)")
    try:
        if path.suffix == ".mtx":
            read = mmread(path)
        else:
            with np.load(path, allow_pickle=False) as file:
                if name not in file.files:
                    raise FrameError(f"{where}: it has no array {name!r}; save it by numpy.savez({name}=...)")
                read = file[name]
        if read.ndim != 2 or read.dtype.kind not in "iuf":
            raise FrameError(f"{where}: it is no matrix of real numbers; write it as one")
        matrix = csc_matrix(read if issparse(read) else np.asarray(read, float), dtype=float)
    except (OSError, ValueError, EOFError, BadZipFile, OverflowError) as error:
        reason = getattr(error, "strerror", None) or " ".join(str(error).split())
        raise FrameError(f"{where}: it cannot be read ({reason}); write it again") from error
    rows, columns = matrix.shape
    if rows != columns or not rows:
        raise FrameError(f"{where}: it has {rows} rows and {columns} columns; write a square matrix")
    if not np.isfinite(matrix.data).all():
        raise FrameError(f"{where}: it holds a value that is not finite; correct the model it comes from")
    apart = np.abs((matrix - matrix.T).data).max(initial=0.0)
    largest = np.abs(matrix.data).max(initial=0.0)
    if apart > SYMMETRIC * largest:
        raise FrameError(
            f"{where}: it is not symmetric (an entry and its mirror image differ by {apart / largest:.2g} of the largest "
            "entry); write both halves, or a MatrixMarket file of the kind symmetric"
        )
    return csc_matrix((matrix + matrix.T) / 2.0)


def condensed_to(
    stiffness: csc_matrix, mass: csc_matrix, kept: NDArray[np.int_], where: str
) -> tuple[Real, Real]:
    """Return mass and stiffness (b, b) condensed statically (Guyan) to some rows of a large sparse system.

    Args:
        stiffness: Stiffness (n, n) [N/m].
        mass: Mass (n, n) [kg].
        kept: Rows that are kept (b,), from 0.
        where: File of the stiffness, for the message.

    Raises:
        FrameError: What is left out can move freely.
    """
    others = np.setdiff1d(np.arange(stiffness.shape[0]), kept)
    basis = np.zeros((stiffness.shape[0], len(kept)))
    basis[kept, np.arange(len(kept))] = 1.0
    if len(others):
        coupling = stiffness[others][:, kept].toarray()
        try:
            basis[others] = -splu(csc_matrix(stiffness[others][:, others])).solve(coupling)
        except RuntimeError:
            basis[others] = np.nan
    if not np.isfinite(basis).all():
        raise FrameError(
            f"matrix {where}: the rows that are no floor can move freely; hold them in the model, or leave them out"
        )
    small_mass, small = basis.T @ (mass @ basis), basis.T @ (stiffness @ basis)
    return (small_mass + small_mass.T) / 2.0, (small + small.T) / 2.0


def _positive(matrix: Real, where: str, advice: str) -> None:
    lowest, *_, highest = [*np.linalg.eigvalsh(matrix)] * 2
    if not lowest > 1e-12 * abs(highest):
        raise FrameError(f"{where}: condensed to the floors it is not positive definite; {advice}")
