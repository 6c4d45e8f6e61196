"""Files that are there whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from pounding.frames.errors import FrameError


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Give a temporary path beside ``path`` to write to, and move it there when the block succeeds.

    The folder is made if it is missing. Whatever fails, nothing half-written is left behind.

    Args:
        path: Where the file shall be.

    Raises:
        FrameError: The folder cannot be made or written, or the disk is full; the sentence names the file.
    """
    path = Path(path)
    # The suffix stays, because writers choose the format by it.
    part = path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield part
        os.replace(part, path)
    except OSError as error:
        raise FrameError(f"{path}: cannot be written ({error.strerror or error})") from error
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)


def clear_begun(folder: str | Path, processes: Iterable[int | None]) -> None:
    """Remove what processes that were killed had begun to write by `replacing` in a folder.

    Args:
        folder: The folder.
        processes: Their numbers.
    """
    for process in processes:
        for part in Path(folder).glob(f".*.{process}.part*"):
            with suppress(OSError):
                part.unlink(missing_ok=True)


def write_whole(path: str | Path, content: bytes) -> None:
    """Write a file in one go; raises as `replacing`."""
    with replacing(path) as part, part.open("wb") as stream:
        stream.write(content)
        stream.flush()
        # A full disk may show only when the data reach it.
        os.fsync(stream.fileno())
