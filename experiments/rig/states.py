"""States of the frames of the laboratory: the stiffness and damping that a frame had in one kind of test.

The thesis prints several first frequencies for the same frame. A state says which of them the joints are calibrated on and
which damping ratio all modes have. `states.toml` beside this module is the list; the numbers come from the printed tables,
but for the damping of strong motion, which is fitted to Table 4.1.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any, Literal, get_args

import msgspec

from pounding import frames
from pounding.experiments.errors import ExperimentError
from pounding.toml_text import shown, tree_of

State = Literal["free-vibration", "sweep", "strong-motion"]
"""Free vibration is the baseline model; `strong-motion` depends on what else stands on the table."""

Frequency = Literal["free vibration", "sweep", "unequal pair"]
"""Where a first frequency is printed: twice in Table 3.1, and in Table 7.2 for models of pairs of unequal height."""

FREE_VIBRATION: State = "free-vibration"
FREQUENCIES: tuple[Frequency, ...] = get_args(Frequency)
LABORATORY = ("5A", "5B", "10", "15A", "15B")
"""Frames that were built and tested; the other shipped ones were not."""


class _Data(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Common to everything that is read from the file."""


class _Place(_Data, frozen=True, kw_only=True):
    """Where numbers are printed: a table of the thesis, and the heading of its column where a row is a frame."""

    table: str
    column: tuple[str, str] | None = None


class _Frequencies(_Place, frozen=True, kw_only=True):
    """First frequencies: their place, the calibration of the joints on them in the frame files, and what they are."""

    joints: str
    words: str


class Configuration(_Data, frozen=True, kw_only=True):
    """What stands on the table in a test, and which first frequency each frame then has in strong motion.

    Attributes:
        frames: Names of the frames.
        frequencies: Where the first frequency of each is printed.
        under: The only record under which this holds; any record when None.
    """

    frames: tuple[str, ...]
    frequencies: tuple[Frequency, ...]
    under: str | None = None

    def __post_init__(self) -> None:
        if len(self.frames) != len(self.frequencies):
            raise ValueError(f"{' beside '.join(self.frames)}: one frequency for each frame is needed")


class StrongMotion(_Data, frozen=True, kw_only=True):
    """The state of strong motion.

    Attributes:
        damping_ratio: Of all modes of all frames [-].
        fitted_to: The data to which the damping ratio is fitted.
        fitted_by: The command that fits it.
        configurations: First frequencies by what stands on the table.
    """

    damping_ratio: float
    fitted_to: str
    fitted_by: str
    configurations: tuple[Configuration, ...]


class _Table(_Data, frozen=True, kw_only=True):
    """The whole file."""

    frequencies: dict[Frequency, _Frequencies]
    damping: _Place
    strong_motion: StrongMotion


@dataclass(frozen=True)
class FrameState:
    """The state of a frame in a run.

    Attributes:
        frame: The frame as it was asked for, a name or a file.
        state: Its state; None where it is as its file has it, or has rigid joints.
        calibration: Calibration of its joints; None for the default of its file.
        first_hz: Printed first frequency on which the joints are calibrated [Hz]; None without a state.
        damping_ratio: Damping ratio of all modes [-]; None for that of its file.
        source: Where stiffness and damping come from, in words.
    """

    frame: str
    state: State | None
    calibration: str | None
    first_hz: float | None
    damping_ratio: float | None
    source: str

    def as_dict(self) -> dict[str, Any]:
        """Return it as it stands in results, units in the keys."""
        return {
            "frame": self.frame,
            "state": self.state,
            "calibration": self.calibration,
            "first_frequency_hz": self.first_hz,
            "damping_ratio": self.damping_ratio,
            "source": self.source,
        }

    def __str__(self) -> str:
        return in_words(self.as_dict())


def in_words(state: Mapping[str, Any]) -> str:
    """Return `FrameState.as_dict` in words: the frame, its state, and where stiffness and damping come from."""
    named = [state["frame"], *([state["state"]] if state["state"] else [])]
    return f"{', '.join(named)}: {state['source']}"


def states_of(
    names: Sequence[str],
    state: State | None = None,
    record: str | None = None,
    *,
    joints: Literal["calibrated", "rigid"] = "calibrated",
    damping: float | None = None,
) -> tuple[FrameState, ...]:
    """Return the state of each frame that stands on the table.

    Args:
        names: One frame, or two in either order: names, or frame files.
        state: The state; None for free vibration, and for frames that have no states as their files say.
        record: Name of the ground motion; None where there is none.
        joints: `calibrated` or `rigid`; rigid joints have no state.
        damping: Damping ratio of all modes [-] in the place of the state's.

    Raises:
        ExperimentError: A frame has no states, or not this one in this configuration; or a state with rigid joints.
        FrameError: There is no such frame.
    """
    if state is not None and joints == "rigid":
        raise ExperimentError(
            "a state is a calibration of the joints, and rigid joints have none; give --state or --joints rigid"
        )
    foreign = [name for name in names if name not in LABORATORY]
    for name in foreign:
        frames.load(name)  # whose sentence on a name that is not known is the better one
    if state is not None and foreign:
        raise ExperimentError(
            f"frame {shown(foreign[0])} has no state {state!r}: only the frames of the laboratory have states "
            f"({', '.join(LABORATORY)}); leave out --state, a frame file has its own joints and damping"
        )
    chosen: Sequence[Frequency | None]
    if joints == "rigid":
        chosen = [None] * len(names)
    elif state == "strong-motion":
        chosen = strong_frequencies(names, record)
    else:
        frequency: Frequency = "sweep" if state == "sweep" else "free vibration"
        chosen = [frequency if name in LABORATORY else None for name in names]
    return tuple(
        _in_state(name, state, frequency, joints, damping)
        for name, frequency in zip(names, chosen, strict=True)
    )


def strong_frequencies(names: Sequence[str], record: str | None = None) -> tuple[Frequency, ...]:
    """Return where the first frequency of each frame in strong motion is printed.

    Args:
        names: The frames on the table, in either order.
        record: Name of the ground motion; None where there is none.

    Raises:
        ExperimentError: The thesis has no test of these frames together.
    """
    listed = _table().strong_motion.configurations
    same = [one for one in listed if sorted(one.frames) == sorted(names)]
    # What holds under one record alone goes before what holds under any.
    for one in sorted(same, key=lambda found: found.under is None):
        if one.under in (None, record):
            printed = dict(zip(one.frames, one.frequencies, strict=True))
            return tuple(printed[name] for name in names)
    known = dict.fromkeys(" beside ".join(one.frames) for one in listed if len(one.frames) > 1)
    raise ExperimentError(
        f"{' beside '.join(names)} has no strong-motion state, because the thesis has no such test; "
        f"its pairs are {', '.join(known)} (take --state sweep or free-vibration)"
    )


def first_frequency(frame: str, frequency: Frequency) -> float:
    """Return a first frequency of a frame of the laboratory as the thesis prints it [Hz].

    Args:
        frame: Name of the frame.
        frequency: Where it is printed.
    """
    place = _table().frequencies[frequency]
    if place.column is None:
        return _of_heights(place.table)[round(1e3 * frames.load(frame).floor_heights_m[-1])]
    return float(_printed(place.table).loc[frame, place.column])


def strong_motion() -> StrongMotion:
    """Return the state of strong motion as the file has it."""
    return _table().strong_motion


def _in_state(
    name: str, state: State | None, frequency: Frequency | None, joints: str, damping: float | None
) -> FrameState:
    """Return a frame whose first frequency is printed somewhere, or with rigid joints, or of no laboratory."""
    if name not in LABORATORY:
        stiffness = "stiffness as in its file"
        if joints == "rigid":
            is_stick = isinstance(frames.load(name), frames.StickFrame)
            stiffness = f"{stiffness} (a stick has no joints)" if is_stick else "rigid joints"
        return FrameState(name, None, None, None, damping, f"{stiffness}, {_asked(damping)}")
    ratio, words = _damping(name, state, damping)
    if frequency is None:
        return FrameState(name, None, None, None, ratio, f"rigid joints, {words}")
    place, first = _table().frequencies[frequency], first_frequency(name, frequency)
    source = f"{first:g} Hz, {place.words} (Table {place.table}); {words}"
    return FrameState(name, state or FREE_VIBRATION, place.joints, first, ratio, source)


def _damping(name: str, state: State | None, asked: float | None) -> tuple[float, str]:
    """Return the damping ratio of a frame of the laboratory [-], and where it comes from."""
    if asked is not None:
        return asked, _asked(asked)
    if state == "strong-motion":
        strong = _table().strong_motion
        words = f"fitted to {strong.fitted_to} by `{strong.fitted_by}`"
        return strong.damping_ratio, f"damping {100 * strong.damping_ratio:g} %, {words}"
    place = _table().damping
    percent = float(_printed(place.table).loc[name, place.column])
    return round(percent / 100.0, 8), f"damping {percent:g} %, of free vibration (Table {place.table})"


def _asked(damping: float | None) -> str:
    return "damping as in its file" if damping is None else f"damping {100 * damping:g} %, as asked"


def _printed(number: str) -> Any:
    # The tables load pandas, which the command's help need not wait for.
    from pounding.experiments import published

    return published.table(number)


@cache
def _of_heights(number: str) -> dict[int, float]:
    """Return the highest first frequency [Hz] that a table of chapter 7 lists for each height [mm]: without added masses."""
    rows, found = _printed(number), dict[int, float]()
    for side in ("tall", "short"):
        for height, frequency in zip(rows[f"{side}_height_mm"], rows[f"{side}_frequency_hz"], strict=True):
            found[int(height)] = max(found.get(int(height), 0.0), float(frequency))
    return found


@cache
def _table() -> _Table:
    content = (resources.files(__package__) / "states.toml").read_bytes()
    try:
        return msgspec.convert(tree_of(content, "states.toml", ExperimentError), _Table)
    except msgspec.ValidationError as error:
        raise ExperimentError(f"states.toml: {error}") from error
