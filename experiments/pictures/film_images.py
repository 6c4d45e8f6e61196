"""The images of a film, drawn by some processes side by side, each in a plotter of its own.

Each process draws every n-th image and waits until it is taken, so that the images in memory are as few as the
processes, however long the film. A process that is left alone ends with its next image, because nobody takes it.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import tempfile
from collections.abc import Generator, Sequence
from contextlib import ExitStack
from types import TracebackType
from typing import Self

from pounding.experiments.pictures.scenes import Instant, Setting, Stage
from pounding.frames.drawing.pictures import bare_plotter, image
from pounding.frames.errors import FrameError

ONE_THREAD = ("LP_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Each process takes one core: Mesa's software renderer and the BLAS would else take all of them each."""

PIPE = 1 << 20
"""Size of the pipe from a process [bytes], where the system lets it be chosen."""


def images(
    setting: Setting, instants: Sequence[Instant], size: tuple[int, int], processes: int
) -> Generator[bytes]:
    """Yield the images of some instants in their order, as bytes of red, green and blue.

    Args:
        setting: What is the same in all of them.
        instants: What differs.
        size: Width and height [pixels].
        processes: How many processes draw.

    Raises:
        FrameError: A process died.
    """
    count = min(processes, len(instants))
    with ExitStack() as stack:
        drawers = [
            stack.enter_context(_Drawer(setting, instants[first::count], size)) for first in range(count)
        ]
        for number in range(len(instants)):
            yield drawers[number % count].image()


class _Drawer:
    """A process that draws images."""

    def __init__(self, setting: Setting, instants: Sequence[Instant], size: tuple[int, int]) -> None:
        self._bytes = 3 * size[0] * size[1]
        # Files without a name: nothing of them stays, however this process ends.
        with tempfile.TemporaryFile() as task:
            pickle.dump((setting, instants, size), task, protocol=5)
            task.seek(0)
            self._errors = tempfile.TemporaryFile()  # noqa: SIM115 (closed with the process)
            self._process = subprocess.Popen(
                [sys.executable, "-m", __name__],
                stdin=task,
                stdout=subprocess.PIPE,
                stderr=self._errors,
                env=dict(os.environ)
                | dict.fromkeys(ONE_THREAD, "1")
                | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
                # Ctrl-C is for the process that waits for the images; it ends this one.
                start_new_session=True,
                pipesize=PIPE,
            )

    def __enter__(self) -> Self:
        return self

    def image(self) -> bytes:
        """Return the next image; `FrameError` if there is none."""
        assert self._process.stdout is not None
        drawn = self._process.stdout.read(self._bytes)
        if len(drawn) < self._bytes:
            self._process.wait()
            self._errors.seek(0)
            said = self._errors.read().decode(errors="replace").strip().splitlines()
            reason = said[-1] if said else f"exit status {self._process.returncode}"
            raise FrameError(f"no film: the process that draws its images ended ({reason})")
        return drawn

    def __exit__(
        self, _kind: type[BaseException] | None, _error: BaseException | None, _trace: TracebackType | None
    ) -> None:
        assert self._process.stdout is not None
        self._process.kill()
        self._process.wait()
        self._process.stdout.close()
        self._errors.close()


def draw() -> None:
    """Draw the images that standard input asks for, and write them to standard output."""
    setting, instants, size = pickle.load(sys.stdin.buffer)
    with os.fdopen(os.dup(1), "wb", buffering=0) as taken:
        # What a graphics library may print is no part of an image.
        os.dup2(2, 1)
        with bare_plotter(size) as scene:
            stage = Stage(scene, setting)
            for instant in instants:
                stage.show(instant)
                left = image(scene).data.cast("B")
                while left:
                    left = left[taken.write(left) :]


if __name__ == "__main__":
    draw()
