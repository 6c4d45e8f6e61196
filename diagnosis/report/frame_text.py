"""A corrected frame as the text of a frame file, with what was changed in its comments."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Any

import msgspec
import numpy as np
from scipy.linalg import eigh

from pounding.diagnosis.model.storeys import StoreyFrame
from pounding.frames import StickFrame
from pounding.frames.storey_laws import StatedLaw

WIDTH = 118


def frame_text(
    frame: StickFrame,
    baseline: StoreyFrame,
    sentence: str,
    beside: Sequence[str],
    left_out: Sequence[str] = (),
) -> str:
    """Return the text of a frame file.

    Args:
        frame: The corrected frame.
        baseline: The frame as the baseline model has it, beside which the changes are stated.
        sentence: The verdict in words.
        beside: What was found that is on no frame.
        left_out: Errors of the frame that its file cannot state.
    """
    assert frame.matrices is not None
    said = [
        f"{frame.name} by its measurements. {sentence}",
        "Made by `pounding diagnose --export-model`, for `pounding shake`, `pound` and `gap`; what it was measured on is "
        "one table, so it holds for motions of that size.",
        *_changes(frame, baseline),
    ]
    if beside:
        said.append(f"Not in this file, because it is not on the frame: {'; '.join(beside)}.")
    if left_out:
        said.append(f"Left out, an error of the frame that no frame file can state: {'; '.join(left_out)}.")
    head = [
        line
        for one in said
        for line in textwrap.wrap(one, WIDTH, initial_indent="# ", subsequent_indent="# ")
    ]
    top = {
        "kind": "stick",
        **{
            key: getattr(frame, key)
            for key in (
                "name",
                "title",
                "scale",
                "storeys",
                "storey_height_m",
                "damping_ratio",
            )
        },
        "plan_m": list(frame.plan_m),
    }
    lines = [*head, *_keys(top)]
    if frame.slab is not None:
        lines += ["", "[slab]", *_keys(msgspec.structs.asdict(frame.slab))]
    for law in frame.storey_law:
        lines += ["", "[[storey_law]]", *_keys(_law_keys(law))]
    lines += ["", "[matrices]", *_matrix("stiffness_n_per_m", frame.matrices.stiffness_n_per_m)]
    lines += _matrix("mass_kg", frame.matrices.mass_kg)
    return "\n".join(lines) + "\n"


def _changes(frame: StickFrame, baseline: StoreyFrame) -> list[str]:
    """Return how far the corrected frame is from the baseline model, storey by storey."""
    assert frame.matrices is not None
    stiffness, mass = (np.asarray(one) for one in (frame.matrices.stiffness_n_per_m, frame.matrices.mass_kg))
    above = np.tril(np.ones_like(stiffness))
    storeys = np.einsum("is,ij,js->s", above, stiffness, above) / baseline.storey_stiffness
    floors = mass.sum(axis=1) / baseline.floor_mass
    before, after = (
        np.sqrt(eigh(k, m, eigvals_only=True)[:3]) / (2 * np.pi)
        for k, m in ((baseline.stiffness, baseline.mass), (stiffness, mass))
    )
    frequencies = ", ".join(f"{one:.3f} to {other:.3f}" for one, other in zip(before, after, strict=True))
    return [
        f"Beside the baseline model: stiffness of storeys 1 to {frame.storeys} times {_list(storeys)}; mass of floors times "
        f"{_list(floors)}; lowest frequencies from {frequencies} Hz.",
    ]


def _list(values: np.ndarray) -> str:
    return " ".join(f"{one:.3f}" for one in values)


def _law_keys(law: StatedLaw) -> dict[str, Any]:
    """Return what a file says of a law: nothing of what is as usual."""
    kind = law.__struct_config__.tag
    usual = {field.name: field.default for field in msgspec.structs.fields(law)}
    stated = {key: value for key, value in msgspec.structs.asdict(law).items() if value != usual[key]}
    return {"kind": kind, **stated}


def _keys(keys: dict[str, Any]) -> list[str]:
    # TOML writes strings, numbers and lists as JSON does.
    return [
        f"{key} = {msgspec.json.encode(value).decode()}"
        for key, value in keys.items()
        if value not in (None, "")
    ]


def _matrix(key: str, rows: list[list[float]]) -> list[str]:
    return [f"{key} = [", *(f"    {msgspec.json.encode(row).decode()}," for row in rows), "]"]
