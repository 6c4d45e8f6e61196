"""`pounding demo`: from the frames' geometry to a collision and to a missing effect that is found, in a few minutes."""

from __future__ import annotations

import json as jsonlib
import time
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.progress import Progress
from rich.text import Text

from pounding import frames
from pounding.contact import thesis_law
from pounding.diagnosis.report import figures as report
from pounding.experiments.command.diagnose import diagnose
from pounding.experiments.command.hide import hide
from pounding.experiments.command.pound import pound
from pounding.experiments.command.shake import shake
from pounding.experiments.console import options
from pounding.experiments.console.output import printer, progress_console, warn
from pounding.experiments.errors import ExperimentError
from pounding.experiments.output import collision_folder, result_folder
from pounding.experiments.output import result_folder as keeping
from pounding.experiments.output.index_page import Section, write_index
from pounding.experiments.pictures.films import film, require
from pounding.experiments.pictures.scenes import picture
from pounding.experiments.records import Record, find
from pounding.experiments.rig.pounding import Pounding
from pounding.experiments.rig.pounding import pound as run_pair
from pounding.experiments.rig.required_gap import pair_gap
from pounding.experiments.studies import laboratory, table_3_1
from pounding.extras import MissingExtraError
from pounding.frames.drawing.pictures import mesh_picture, modes_picture
from pounding.frames.drawing.vtk import write_modes
from pounding.frames.errors import FrameError
from pounding.scale import THESIS

FRAMES = ("5A", "5B", "10", "15A", "15B")
PAIR = ("15B", "5B")
SHARE_OF_REQUIRED_GAP = 0.8
"""The gaps of the thesis are between 0.67 and 0.98 of the required gaps of the same frames."""

HIDDEN, STRENGTH, HIDDEN_S = "coulomb_friction:3", 6.0, 6.0
"""What is hidden in frame 5A: friction in its third storey, its signal-to-noise ratio, and the length of the runs [s]."""

MOTIONS = ("elcentro", "elcentro-peer180")
"""The El Centro of the tests if the user has it, else the one that an installed package contains, under its own name."""


def demo(
    *,
    out: Annotated[
        Path,
        Parameter(help="Folder for pictures, films and VTK files.", validator=options.writable_folder),
    ] = Path("results/demo"),
    records: options.Records = None,
) -> None:
    """Build, test and shake the five frames, let two collide, find a hidden effect; print published values beside ours."""
    console = printer()
    began = time.perf_counter()
    keeping.prepare(out)
    motion = _motion(records)
    filmed = _can_film()
    for title, step in (
        ("1. Five frames from steel plate to Table 3.1", lambda: table_3_1.main(out=out / "table-3-1")),
        ("2. Their meshes and mode shapes", lambda: draw_frames(out / "frames")),
        ("3. Tested as the laboratory did", lambda: laboratory.main(out=out / "laboratory")),
        (
            f"4. 15B alone on the table under {motion.name}",
            lambda: shake("15B", record=motion.name, records=records, out=out / "shaking", film=filmed),
        ),
        (
            f"5. {PAIR[0]} beside {PAIR[1]}, five impact laws",
            lambda: collide(motion, records, out / "pounding", filmed),
        ),
        ("6. An effect is hidden in a frame, found and named", lambda: find_hidden(out / "missing-effect")),
    ):
        console.rule(Text(title, style="bold"))
        step()
    write_index("pounding demo", _sections(out, motion.name), out / "index.html")
    console.print(f"\nAll of it in {time.perf_counter() - began:.0f} s.")
    console.print(
        f"Open {out / 'index.html'} in a browser: it shows the pictures and links the films and VTK files."
    )


def draw_frames(folder: Path) -> None:
    """Write each frame's modes as VTK, and one frame's mesh and modes as pictures."""
    keeping.prepare(folder)
    for name in FRAMES:
        write_modes(frames.build(frames.load(name)), folder / f"modes-{name}.vtu")
    reduced = frames.build(frames.load("10"))
    _drawn(lambda: mesh_picture(reduced, folder / "mesh-10.png"))
    _drawn(lambda: modes_picture(reduced, folder / "modes-10.png"))
    printer().print(f"written: {len(FRAMES)} files of modes for ParaView and two pictures in {folder}")


def collide(motion: Record, records: Path | None, folder: Path, filmed: bool = True) -> None:
    """Let the pair collide at a share of its required gap: numbers, plots, a film where `filmed`.

    Args:
        motion: Record at model scale.
        records: Folder with ground motions; None for the default.
        folder: Where numbers, plots and the film go.
        filmed: Whether a film is made.
    """
    left, right = (frames.build(frames.load(name)) for name in PAIR)
    needed_mm = 1e3 * pair_gap(left, right, motion).closing_m
    gap_mm = round(SHARE_OF_REQUIRED_GAP * needed_mm, 1)
    printer().print(
        f"without contact the floors would close by {needed_mm:.1f} mm: the gap is set to {gap_mm} mm"
    )
    pound(*PAIR, gap=[gap_mm], record=motion.name, law="all", records=records, out=folder)
    run = _viscoelastic(left, right, motion, gap_mm)
    title = f"{PAIR[0]} beside {PAIR[1]}, {motion.name}, gap {gap_mm:g} mm"
    _drawn(lambda: picture(run.motion, folder / "collision.png", title=title))
    if not filmed:
        return
    hardest = max(run.impacts, key=lambda impact: impact.peak_force_n)
    start, end = max(0.0, hardest.time_s - 0.2), min(run.motion.model_s, hardest.time_s + 0.3)
    with Progress(console=progress_console(), transient=True) as progress:
        bar = progress.add_task("film of the collision", total=1.0)
        _drawn(
            lambda: film(
                run.motion, folder / "collision.mp4", start_s=start, end_s=end, speed=0.1, title=title,
                progress=lambda share: progress.update(bar, completed=share),
            )
        )  # fmt: skip


def find_hidden(folder: Path) -> None:
    """Hide an effect in measurements of frame 5A, and let the diagnosis find it.

    Args:
        folder: Where the measured case and the report go; a case that is there already is diagnosed again.
    """
    case, truth = folder / "case", folder / "truth.json"
    if not (truth.exists() and (case / "case.toml").exists()):
        hide(
            HIDDEN,
            frame=["5A"],
            visibility=STRENGTH,
            duration=HIDDEN_S,
            motions="artificial",
            seed=1,
            out=case,
            truth=truth,
        )
    diagnose(case, out=folder / "report")
    (effect,) = jsonlib.loads(truth.read_text(encoding="utf-8"))["effects"]
    (force,) = effect["parameters"]
    printer().print(
        f"What was hidden: {effect['effect'].replace('_', ' ')} of {force['value']:.3f} {force['unit']} in storey "
        f"{effect['storey']} of {effect['frame']} ({truth})"
    )


def _sections(out: Path, record: str) -> list[Section]:
    """Return the parts of the page: what each step shows, and the command for it alone."""
    left, right = PAIR
    return [
        Section(
            "Frames",
            "Five steel frames from plate and column elements: mesh and mode shapes of the frame with ten storeys.",
            out / "frames",
            "pounding modal 10",
            {
                "mesh-10.png": "The mesh of frame 10 from plate and column elements.",
                "modes-10.png": "The first modes of frame 10 with their frequencies [Hz], enlarged.",
            },
        ),
        Section(
            "Table 3.1",
            "First three frequencies and roof stiffness of the frames beside the published values.",
            out / "table-3-1",
            "pounding study table-3-1",
        ),
        Section(
            "Tests of the laboratory",
            "Free vibration, sweep and push of each frame, read as the laboratory read them.",
            out / "laboratory",
            "pounding study laboratory",
            {
                "laboratory.png": "Frame 15B: free vibration, its half-power bandwidth, and the answer to a sine sweep."
            },
        ),
        Section(
            f"15B under {record}",
            "The frame with fifteen storeys alone on the table: motion, spectra, largest stress.",
            out / "shaking",
            f"pounding shake 15B --record {record} --out DIR",
            result_folder.CAPTIONS,
        ),
        Section(
            f"{left} beside {right}",
            "Two frames with too small a gap: contact force of five impact laws, and a film of the hardest impact.",
            out / "pounding",
            f"pounding pound {left} {right} --gap MM --record {record} --law all --out DIR",
            collision_folder.CAPTIONS,
        ),
        Section(
            "The missing effect",
            "Friction was hidden in the third storey of frame 5A. The report says what the model lacks and where.",
            out / "missing-effect" / "report",
            "pounding diagnose CASE --out DIR",
            report.CAPTIONS,
        ),
    ]


def _viscoelastic(
    left: frames.ReducedFrame, right: frames.ReducedFrame, motion: Record, gap_mm: float
) -> Pounding:
    run = run_pair(left, right, motion, thesis_law("linear_viscoelastic"), 1e-3 * gap_mm)
    if not run.impacts:
        raise ExperimentError(
            f"{PAIR[0]} and {PAIR[1]} did not touch at a gap of {gap_mm} mm: nothing to film"
        )
    return run


def _motion(folder: Path | None) -> Record:
    try:
        return find(MOTIONS[0], folder).scaled(THESIS.time_factor)
    except ExperimentError:
        motion = find(MOTIONS[1], folder).scaled(THESIS.time_factor)
        warn(
            f"the tests' own record '{MOTIONS[0]}' is not here (see pounding list): taking '{MOTIONS[1]}', "
            f"the same earthquake in another processing ({motion.pga_g:.3f} g), so its peaks cannot be "
            "compared with Table 4.1"
        )
        return motion


def _can_film() -> bool:
    """Return whether films can be made; where not, say so."""
    try:
        require()
    except MissingExtraError as error:
        warn(f"{error}; the demonstration goes on without them")
        return False
    return True


def _drawn(draw: Callable[[], object]) -> None:
    """Draw, or print one sentence that this machine cannot draw, and continue."""
    try:
        draw()
    except FrameError as error:
        warn(str(error))
