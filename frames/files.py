"""Files that are there whole or not at all, and kept results whose damage is noticed.

What is being written has a hidden name with the computer and the process in it, ending in `.part`, and gets its own name
when it is whole. What a process left behind that was killed is removed by the next one that writes in the same folder.
"""

from __future__ import annotations

import hashlib
import os
import platform
import re
import shutil
import signal
import sys
import tempfile
import threading
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

from pounding.frames.errors import FrameError

PART = re.compile(r"\..+\.(?P<host>[^.]+)\.(?P<process>\d+)\.part(\..*)?")


class DamageWarning(UserWarning):
    """A kept result is damaged: it is not used, and made anew."""


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
    part = part_of(path)
    missing = [folder for folder in path.parents if not folder.exists()]
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        _clear_once(path.parent)
        yield part
        os.replace(part, path)
    except OSError as error:
        raise FrameError(f"{path}: cannot be written ({error.strerror or error})") from error
    finally:
        with uninterrupted():
            _remove(part)
            for made in missing:  # unless there is something in it now
                with suppress(OSError):
                    made.rmdir()


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Let Ctrl-C and a request to end wait until a short block has ended; in other threads they do not arrive."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    received: list[int] = []
    handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    # One that was not installed from Python could not be put back.
    handlers = {number: handler for number, handler in handlers.items() if handler is not None}
    for number in handlers:
        signal.signal(number, lambda number, _frame: received.append(number))
    try:
        yield
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
        for came in received:
            signal.raise_signal(came)


@contextmanager
def scratch(folder: str | Path | None = None, name: str = "pounding") -> Iterator[Path]:
    """Give an empty folder that is removed at the end, with what is in it unless that was moved away.

    Args:
        folder: Where it is made; the folder of the system for temporary files when None.
        name: Part of its name.

    Raises:
        OSError: It cannot be made.
        FrameError: A file in it cannot be written; the sentence names it as if the folder were `name` in `folder`.
    """
    parent = Path(folder or tempfile.gettempdir())
    parent.mkdir(parents=True, exist_ok=True)
    _clear_once(parent)
    made = Path(tempfile.mkdtemp(dir=parent, prefix=f".{name}.", suffix=f".{_host()}.{os.getpid()}.part"))
    try:
        yield made
    except FrameError as error:
        if folder is not None:
            # The hidden folder is gone when the sentence is read; what it was made for has a name that the user knows.
            error.args = (str(error).replace(str(made), str(parent / name)),)
        raise
    finally:
        with uninterrupted():
            _remove(made)


def part_of(path: Path) -> Path:
    """Return the hidden name of a file that this thread of this process is writing."""
    # The suffix stays, because writers choose the format by it.
    return path.with_name(f".{path.stem}.{threading.get_ident()}.{_host()}.{os.getpid()}.part{path.suffix}")


def clear_stale(folder: str | Path) -> None:
    """Remove what processes of this computer had begun to write in a folder and that are no longer alive."""
    for part, process in _parts(folder):
        if not _alive(process):
            _remove(part)


def tried_folder(folder: str | Path) -> None:
    """Try whether files can be written into a folder, before work starts; nothing of the trial stays.

    Args:
        folder: The folder; it need not be there.

    Raises:
        FrameError: It cannot be made or written.
    """
    folder = Path(folder)
    made: list[Path] = []
    with uninterrupted():
        try:
            for place in reversed([one for one in (folder, *folder.parents) if not one.exists()]):
                place.mkdir()
                made.append(place)
            with tempfile.TemporaryFile(dir=folder) as stream:
                stream.write(b"0")
        except (OSError, ValueError) as error:  # a zero byte in a name is no OSError
            reason = getattr(error, "strerror", None) or error
            raise FrameError(f"folder {folder}: cannot be written ({reason}); choose another") from error
        finally:
            for place in reversed(made):
                with suppress(OSError):
                    place.rmdir()


def tried_file(path: str | Path) -> None:
    """Try whether a file can be written, before work starts; nothing of the trial stays.

    Args:
        path: The file; it need not be there, nor its folder.

    Raises:
        FrameError: It is a folder, or its folder cannot be made or written.
    """
    if os.path.isdir(path):
        raise FrameError(f"file {path}: cannot be written (it is a folder); choose another")
    tried_folder(Path(path).parent)


def clear_begun(folder: str | Path, processes: Iterable[int | None]) -> None:
    """Remove what processes that were killed just now had begun to write in a folder.

    Args:
        folder: The folder.
        processes: Their numbers.
    """
    numbers = set(processes)
    for part, process in _parts(folder):
        if process in numbers:
            _remove(part)


def write_whole(path: str | Path, content: bytes) -> None:
    """Write a file in one go; raises as `replacing`."""
    with replacing(path) as part, part.open("wb") as stream:
        stream.write(content)
        stream.flush()
        # A full disk may show only when the data reach it.
        os.fsync(stream.fileno())


_HEAD = b'{"sha256": "%s", "content": '
_TAIL = b"}\n"


def write_entry(path: str | Path, content: bytes) -> None:
    """Keep a result with a checksum, in one go; raises as `replacing`.

    Args:
        path: The file; it is JSON if the content is.
        content: The result.
    """
    write_whole(path, sealed(content))


def read_entry(path: str | Path) -> bytes | None:
    """Return what `write_entry` kept; None if it is not there or damaged, and a `DamageWarning` in the latter case.

    The checksum finds what a disk or a hand has changed. It is no signature: whoever means to can make one that fits.
    """
    try:
        whole = Path(path).read_bytes()
    except OSError:
        return None
    content = unsealed(whole)
    if content is None:
        tell_damage(path)
    return content


def sealed(content: bytes) -> bytes:
    """Return a result with its checksum before it, and a line's end after it."""
    return _HEAD % _checksum(content) + content + _TAIL


def unsealed(whole: bytes) -> bytes | None:
    """Return what `sealed` was given; None where that is not what it had returned."""
    content = whole[len(_HEAD % _checksum(b"")) : -len(_TAIL)]
    return content if whole == sealed(content) else None


def tell_damage(path: str | Path) -> None:
    """Warn that a kept result is damaged."""
    warnings.warn(f"{path} is damaged: what it kept is made anew", DamageWarning, stacklevel=2)


def _checksum(content: bytes) -> bytes:
    return hashlib.sha256(content).hexdigest().encode()


def _parts(folder: str | Path) -> Iterator[tuple[Path, int]]:
    """Find what processes of this computer have begun to write; those of others cannot be asked whether they live."""
    with suppress(OSError):
        for path in Path(folder).iterdir():
            found = PART.fullmatch(path.name)
            if found and found["host"] == _host():
                yield path, int(found["process"])


@cache
def _host() -> str:
    return re.sub(r"[^A-Za-z0-9-]", "-", platform.node()) or "-"


@cache
def _clear_once(folder: Path) -> None:
    clear_stale(folder)


def _alive(process: int) -> bool:
    if sys.platform == "win32":  # where asking like this would end the process
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (PermissionError, OverflowError):
        return True
    return True


def _remove(part: Path) -> None:
    with suppress(OSError):
        if part.is_dir():
            shutil.rmtree(part, ignore_errors=True)
        else:
            part.unlink(missing_ok=True)
