"""Films of a run, MP4 or GIF, without a display."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding.experiments.errors import ExperimentError
from pounding.experiments.pictures.scenes import Stage, size_of
from pounding.extras import extra_module
from pounding.frames.drawing.pictures import plotter
from pounding.frames.files import replacing

if TYPE_CHECKING:
    from pounding.experiments.rig.motion import Motion

FRAMES_PER_SECOND = 25

GIF_WIDTH = 400
"""Width to which a GIF is scaled [pixels]; an MP4 keeps its size."""


def require() -> None:
    """See that films can be made, before anything is computed for one.

    Raises:
        MissingExtraError: imageio-ffmpeg is not installed.
    """
    extra_module("imageio_ffmpeg")


def film(
    motion: Motion,
    path: str | Path,
    *,
    start_s: float = 0.0,
    end_s: float | None = None,
    speed: float = 1.0,
    title: str = "",
    size: tuple[int, int] | None = None,
    progress: Callable[[float], None] | None = None,
) -> None:
    """Film the frames on their table.

    Args:
        motion: The run.
        path: ``.mp4`` (H.264) or ``.gif``.
        start_s: First moment [s].
        end_s: Last moment [s]; the run's end when None.
        speed: Model seconds in one second of the film.
        title: First line of the caption.
        size: Width and height [pixels].
        progress: Called with the share that is done, 0 to 1.

    Raises:
        FrameError: The machine cannot render, or the file cannot be written.
        ExperimentError: Another suffix, or an empty span of time.
        MissingExtraError: imageio-ffmpeg is not installed.
    """
    require()
    path, end = Path(path), motion.model_s if end_s is None else end_s
    if path.suffix not in (".mp4", ".gif"):
        raise ExperimentError(f"film {path}: its suffix must be .mp4 or .gif")
    times = np.arange(start_s, end + 1e-9, speed / FRAMES_PER_SECOND)
    if len(times) < 2 or start_s < 0.0 or end > motion.model_s + 1e-9:
        raise ExperimentError(
            f"film {path}: {start_s} to {end} s is not a span of the run's {motion.model_s:.3f} s"
        )
    width, height = size or size_of(motion)
    with plotter((width, height)) as scene, replacing(path) as part:
        stage = Stage(scene, motion, title=title)
        # Closed in any case, or ffmpeg would still be writing when the half-made film is removed.
        with closing(_writer(part, (width, height))) as writer:
            writer.send(None)
            for count, moment in enumerate(times):
                stage.show(float(moment))
                # A screenshot alone would show the image that was rendered last.
                scene.render()
                writer.send(np.ascontiguousarray(scene.screenshot(return_img=True)))
                if progress is not None:
                    progress((count + 1) / len(times))


def _writer(path: Path, size: tuple[int, int]) -> Any:
    write_frames = extra_module("imageio_ffmpeg").write_frames
    options: dict[str, Any] = {"fps": FRAMES_PER_SECOND, "macro_block_size": 1, "ffmpeg_log_level": "error"}
    if path.suffix == ".gif":
        palette = (
            f"scale={GIF_WIDTH}:-2:flags=lanczos,split[a][b];"
            "[a]palettegen=max_colors=64[p];[b][p]paletteuse=dither=none"
        )
        return write_frames(
            str(path),
            size,
            codec="gif",
            pix_fmt_out="pal8",
            output_params=["-filter_complex", palette],
            **options,
        )
    return write_frames(str(path), size, codec="libx264", quality=6, **options)
