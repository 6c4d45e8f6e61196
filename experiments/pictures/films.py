"""Films of a run, MP4 or GIF, without a display."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding.cores import cores
from pounding.experiments.errors import ExperimentError
from pounding.experiments.pictures import film_images
from pounding.experiments.pictures.scenes import instants, largest_moment, setting, size_of
from pounding.extras import extra_module
from pounding.frames.drawing.rendering import cannot_render
from pounding.frames.errors import FrameError
from pounding.frames.files import replacing

if TYPE_CHECKING:
    from pounding.experiments.rig.motion import Motion

FRAMES_PER_SECOND = 25

LONGEST_S = {".mp4": 30.0, ".gif": 10.0}
"""How long a film may be, by its suffix [s]: drawing takes about as long as showing, and the colours of a GIF are
found from all its images at once."""

OVERSIZE = 1.25
"""Images are drawn larger by this factor and scaled down: their edges are smooth at a fifth of the cost of VTK's way."""

GIF_WIDTH = 640
"""Width to which a GIF is scaled [pixels]; an MP4 keeps its size."""


@dataclass(frozen=True)
class Film:
    """What a film shows.

    Attributes:
        start_s, end_s: First and last moment on the model's clock [s].
        speed: Model seconds in one second of the film.
        images: Number of images.
        run_s: How long the run is [s].
    """

    start_s: float
    end_s: float
    speed: float
    images: int
    run_s: float

    @property
    def length_s(self) -> float:
        """How long the film lasts [s]."""
        return self.images / FRAMES_PER_SECOND

    def __str__(self) -> str:
        """Say in words what is shown."""
        pace = "at its own speed" if self.speed == 1.0 else f"at {self.speed:.3g} of its speed"
        return (
            f"{self.length_s:.1f} s, {self.images} images: {self.start_s:.2f} to {self.end_s:.2f} s of the run's "
            f"{self.run_s:.2f} s, {pace}"
        )


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
    processes: int | None = None,
    behind: Motion | None = None,
) -> Film:
    """Film the frames on their table. It always writes a file, because neither axes nor a plotter can hold a film.

    A film is never longer than `LONGEST_S`: of a longer span it shows the part in whose middle is the largest
    contact force or, with none, the largest roof displacement.

    Args:
        motion: The run.
        path: ``.mp4`` (H.264) or ``.gif``.
        start_s: First moment [s].
        end_s: Last moment [s]; the run's end when None.
        speed: Model seconds in one second of the film.
        title: First line of the caption.
        size: Width and height [pixels].
        progress: Called with the share that is done, 0 to 1.
        processes: How many processes draw; as many as there are cores when None.
        behind: Another run of the same frames, drawn as blue lines.

    Returns:
        What the film shows.

    Raises:
        FrameError: The machine cannot render, or the file cannot be written.
        ExperimentError: Another suffix, or an empty span of time.
        MissingExtraError: imageio-ffmpeg is not installed.
    """
    require()
    path, end = Path(path), motion.model_s if end_s is None else end_s
    if path.suffix not in LONGEST_S:
        raise ExperimentError(f"film {path}: its suffix must be .mp4 or .gif")
    step = speed / FRAMES_PER_SECOND
    if not (step > 0.0 and start_s >= 0.0 and start_s + step <= end <= motion.model_s + 1e-9):
        raise ExperimentError(
            f"film {path}: {start_s} to {end} s is not a span of the run's {motion.model_s:.3f} s"
        )
    start, end = _shortened(motion, start_s, end, speed * LONGEST_S[path.suffix] - step)
    times = np.arange(start, end + 1e-9, step)
    reason = cannot_render()
    if reason:
        raise FrameError(reason)
    width, height = size or size_of(motion)
    drawn = round(OVERSIZE * width), round(OVERSIZE * height)
    shown = instants(motion, times, exposure_s=step, behind=behind)
    images = film_images.images(setting(motion, title=title), shown, drawn, processes or cores())
    with replacing(path) as part, closing(images):
        first = next(images)
        # Closed in any case, or ffmpeg would still be writing when the half-made film is removed.
        with closing(_writer(part, drawn, (width, height))) as writer:
            writer.send(None)
            for count, image in enumerate(chain([first], images)):
                writer.send(image)
                if progress is not None:
                    progress((count + 1) / len(times))
        _see_whole(part, path, len(times))
    return Film(float(times[0]), float(times[-1]), speed, len(times), motion.model_s)


def _see_whole(part: Path, path: Path, images: int) -> None:
    """See that a film holds all its images: ffmpeg does not tell us when the disk was full."""
    try:
        found = extra_module("imageio_ffmpeg").count_frames_and_secs(str(part))[0]
    except RuntimeError:
        found = 0
    if found != images:
        free = shutil.disk_usage(path.parent).free
        raise FrameError(
            f"film {path}: cannot be written, {found} of {images} images were kept; the disk has {free / 1e6:.3g} MB left"
        )


def _shortened(motion: Motion, start_s: float, end_s: float, longest_s: float) -> tuple[float, float]:
    """Return a span [s] no longer than asked, around the largest moment if that lies in the one given."""
    if end_s - start_s <= longest_s:
        return start_s, end_s
    start = min(max(start_s, largest_moment(motion) - longest_s / 2.0), end_s - longest_s)
    return start, start + longest_s


def _writer(path: Path, drawn: tuple[int, int], size: tuple[int, int]) -> Any:
    write_frames = extra_module("imageio_ffmpeg").write_frames
    options: dict[str, Any] = {"fps": FRAMES_PER_SECOND, "macro_block_size": 1, "ffmpeg_log_level": "fatal"}
    if path.suffix == ".gif":
        palette = (
            f"scale={GIF_WIDTH}:-2:flags=lanczos,split[a][b];"
            "[a]palettegen=max_colors=256[p];[b][p]paletteuse=dither=none"
        )
        return write_frames(
            str(path),
            drawn,
            codec="gif",
            pix_fmt_out="pal8",
            output_params=["-filter_complex", palette],
            **options,
        )
    scaled = ["-vf", f"scale={size[0]}:{size[1]}:flags=area", "-preset", "veryfast"]
    return write_frames(str(path), drawn, codec="libx264", quality=6, output_params=scaled, **options)
