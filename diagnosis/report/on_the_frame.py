"""The run before and after on the frames themselves: VTK series, a picture, a film of both over each other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pounding import frames
from pounding.diagnosis.case.case import CaseFrame
from pounding.diagnosis.decision.diagnosis import Diagnosis
from pounding.diagnosis.model.frames import definition
from pounding.diagnosis.model.twin import reduced_frame
from pounding.diagnosis.report.making import shown_after, shown_run
from pounding.experiments.pictures import films, scenes
from pounding.experiments.pictures.series import write_series
from pounding.experiments.rig.motion import EnergyBalance, FrameMotion, Motion
from pounding.frames.drawing.rendering import cannot_render

SERIES_S, SERIES_STEP_S = 0.5, 0.02
"""The VTK series cover so long before and after the moment of the picture, in steps of this [s]: 50 states of each."""
LINES = "blue lines: before, the calibrated baseline"


@dataclass(frozen=True)
class OnTheFrame:
    """A run on the frames of the case, from left to right.

    Attributes:
        run: Name of the run.
        before: By the calibrated baseline model.
        after: By the engine, with what was found in it; None where no candidate has evidence.
        effect: What was found, in words.
    """

    run: str
    before: Motion
    after: Motion | None
    effect: str

    @property
    def title(self) -> str:
        """First lines of a caption: what is seen, before and after."""
        if self.after is None:
            return f"{self.run}: calibrated baseline"
        return f"{self.run}: with {self.effect}\n{LINES}"


def on_the_frame(diagnosis: Diagnosis, motions: Mapping[int, FrameMotion]) -> OnTheFrame:
    """Return the first held-out run (else the first one used), before and after, on the frames.

    Both know the floors; between them a frame takes the shape that its stiffness gives it.

    Args:
        diagnosis: What was found and decided.
        motions: Motion of all frames, as one body, that the engine gave with the effects in them, by number of the run.
    """
    found, judged = diagnosis.found, shown_after(diagnosis)
    run = shown_run(found)
    built = [_built(frame) for frame in diagnosis.case.frames]
    before = _apart(diagnosis, built, _calibrated(diagnosis, run))
    after = _apart(diagnosis, built, motions[run]) if run in motions else None
    words = "" if judged is None else " and ".join(one.label() for one in judged.fit.effects)
    return OnTheFrame(found.model.observed.runs[run].name.removesuffix(".csv"), before, after, words)


def _built(stated: CaseFrame) -> frames.ReducedFrame:
    rigid = stated.joints == "rigid" and stated.kind != "modal"
    return frames.build(definition(stated), joints="rigid" if rigid else "calibrated", p_delta=stated.p_delta)


def _calibrated(diagnosis: Diagnosis, run: int) -> FrameMotion:
    """Return the motion of all frames as one body in a run by the calibrated baseline model."""
    model, fit = diagnosis.found.model, diagnosis.found.baseline.fit.filtered
    (states,) = model.predict(fit.values, None, fit.effects, [run]).before
    modes = model.modes(model.assemble(fit.values, fit.effects))
    count, data = len(modes.omega), model.observed.runs[run]
    moved = states[:, :count] @ modes.floors.T
    rate = states[:, count : 2 * count] @ modes.floors.T
    times = np.arange(len(moved)) * data.step_s
    reduced = reduced_frame(model, model.assemble(fit.values, fit.effects))
    return FrameMotion(reduced, times, moved, rate, np.gradient(rate, data.step_s, axis=0), data.table)


def _apart(diagnosis: Diagnosis, built: Sequence[frames.ReducedFrame], body: FrameMotion) -> Motion:
    """Return the motion of all frames as one body as that of each frame of its own."""
    moved = []
    for number, reduced in enumerate(built):
        span, shape = diagnosis.found.model.structure.span(number), reduced.floor_shapes
        place, rate, change = (
            one[:, span] @ shape.T for one in (body.displacement_m, body.velocity_m_s, body.acceleration_m_s2)
        )
        moved.append(FrameMotion(reduced, body.time_s, place, rate, change, body.table_m_s2))
    nothing = np.zeros(len(body.time_s))
    energy = EnergyBalance(body.time_s, nothing, nothing, nothing, nothing, nothing, nothing)
    return Motion(tuple(moved), (), energy, 0.0, 0.0, len(body.time_s))


def _moment(shown: OnTheFrame) -> float:
    """Return the moment [s] at which a roof differs most before and after; of the largest displacement without an after."""
    if shown.after is None:
        return scenes.largest_moment(shown.before)
    # The integrator's own steps may differ.
    times = shown.before.frames[0].time_s
    apart = [
        _roof(one, times) - _roof(other, times)
        for one, other in zip(shown.before.frames, shown.after.frames, strict=True)
    ]
    return float(times[int(np.argmax(np.max(np.abs(apart), axis=0)))])


def _roof(frame: FrameMotion, times: np.ndarray) -> np.ndarray:
    """Return the displacement of a roof [m] at some times [s], shape (times,)."""
    return np.asarray(np.interp(times, frame.time_s, frame.displacement_m[:, frame.reduced.floor_x[-1]]))


def write_frames(shown: OnTheFrame, folder: Path, *, film: bool = False) -> bytes | None:
    """Write `before.pvd` and `after.pvd`, `on_the_frame.png` and, if asked, `before_after.mp4`; return the picture.

    The picture is None on a machine that cannot render.

    Args:
        shown: The run on the frames.
        folder: Where to write.
        film: Whether to film both over each other.

    Raises:
        FrameError: A file cannot be written.
        MissingExtraError: A film is asked for and imageio-ffmpeg is not installed.
    """
    moment = _moment(shown)
    times = np.arange(
        max(0.0, moment - SERIES_S), min(shown.before.model_s, moment + SERIES_S), SERIES_STEP_S
    )
    for name, motion in (("before", shown.before), ("after", shown.after)):
        if motion is not None:
            write_series(motion, times, folder / f"{name}.pvd")
    if cannot_render():
        return None
    top, under = (shown.before, None) if shown.after is None else (shown.after, shown.before)
    scenes.picture(top, folder / "on_the_frame.png", time_s=moment, title=shown.title, behind=under)
    if film:
        films.film(top, folder / "before_after.mp4", title=shown.title, behind=under)
    return (folder / "on_the_frame.png").read_bytes()
