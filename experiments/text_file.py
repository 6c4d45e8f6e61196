"""Text of a file that a user brings: what is no plain text is refused, and a last line without an end is noticed."""

from __future__ import annotations

from pathlib import Path

from pounding.errors import InputError


def read_text(path: Path, where: str, error: type[InputError], *, fallback: str | None = None) -> str:
    """Return the text of a file in UTF-8.

    Args:
        path: The file.
        where: What the message calls it.
        error: What is raised.
        fallback: Encoding of a text that is not UTF-8; None refuses such a text.

    Raises:
        OSError: The file cannot be opened.
        InputError: The file is no plain text.
    """
    data = path.read_bytes()
    if (at := data.find(b"\0")) >= 0:
        raise error(
            f"{where} line {_line(data, at)}: there is a byte 0 in the text, as in UTF-16 and in damaged files; "
            "save it as text in UTF-8, or get it again"
        )
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as wrong:
        if fallback is None:
            line = _line(data, wrong.start)
            raise error(f"{where} line {line}: this is no text in UTF-8; save it as text in UTF-8") from None
    return data.decode(fallback)


def _line(data: bytes, at: int) -> int:
    return data.count(b"\n", 0, at) + 1


def is_ended(text: str) -> bool:
    """Return whether the last line of a text has an end; without one it may be cut inside its last number."""
    return text[-1:].isspace()
