"""Where something is, in words: `storey 3 of 5B`, `channel 5B_a3`, `contact 1`, `floor 2 between 15B and 5B`."""

from __future__ import annotations

KEYS = ("frame", "storey", "floor", "channel", "contact", "left", "right")
"""What says where something is, in the order of the report."""


def in_words(
    *,
    frame: str | None = None,
    storey: int | None = None,
    floor: int | None = None,
    channel: str | None = None,
    contact: int | None = None,
    left: str | None = None,
    right: str | None = None,
) -> str:
    """Return where something is, in words; what has no place stands for all frames, and the words are empty.

    Args:
        frame: Name of the frame.
        storey: Storey, counted from 1.
        floor: Floor, counted from 1; 0 is the table.
        channel: Name of the channel, or several names separated by `, `.
        contact: Contact, counted from 1.
        left: Name of the left one of two frames.
        right: Name of the right one.
    """
    if channel is not None:
        return f"channel{'s' if ', ' in channel else ''} {channel}"
    if floor == 0:
        return "the table"
    numbered = {"storey": storey, "floor": floor, "contact": contact}
    found = [f"{key} {number}" for key, number in numbered.items() if number is not None]
    if left is not None and right is not None:
        return " ".join([*found, f"between {left} and {right}"])
    if found:
        return ", ".join(found) + (f" of {frame}" if frame and contact is None else "")
    return frame or ""
