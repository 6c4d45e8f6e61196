"""A page that shows what a command wrote: pictures where there are some, and links to all other files."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import NamedTuple
from urllib.parse import quote

from pounding.frames.files import write_whole

IMAGES = (".png", ".gif")

_STYLE = (
    "body{font:16px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#222;background:#fff}"
    "img{max-width:100%;height:auto;border:1px solid #ddd}figure{margin:1rem 0}figcaption{color:#555}"
    "h2{margin-top:2.5rem}code{background:#f2f2f2;padding:0 .2rem}"
)


class Section(NamedTuple):
    """A part of the page.

    Attributes:
        title: Its heading.
        words: What the files show.
        folder: Folder with the files; its subfolders are left out.
        command: What makes the same on its own.
    """

    title: str
    words: str
    folder: Path
    command: str


def write_index(title: str, sections: Sequence[Section], path: Path) -> None:
    """Write the page; an existing one is replaced only when the new one is whole.

    Args:
        title: Heading of the page.
        sections: Its parts; one whose folder is not there is left out.
        path: File to write; links are relative to its folder.

    Raises:
        FrameError: The file cannot be written.
    """
    parts = [_section(one, path.parent) for one in sections if one.folder.is_dir()]
    page = (
        f"<!doctype html><html lang='en'><meta charset='utf-8'><title>{escape(title)}</title><style>{_STYLE}</style>"
        f"<h1>{escape(title)}</h1>{''.join(parts)}</html>\n"
    )
    write_whole(path, page.encode())


def _section(section: Section, base: Path) -> str:
    files = sorted(
        path for path in section.folder.iterdir() if path.is_file() and not path.name.startswith(".")
    )
    pictures = [path for path in files if path.suffix in IMAGES]
    others = [path for path in files if path.suffix not in IMAGES]
    shown = "".join(
        f"<figure><img src='{_link(path, base)}' alt='{escape(path.stem)}' loading='lazy'>"
        f"<figcaption>{escape(path.name)}</figcaption></figure>"
        for path in pictures
    )
    linked = ", ".join(f"<a href='{_link(path, base)}'>{escape(path.name)}</a>" for path in others)
    return (
        f"<h2>{escape(section.title)}</h2><p>{escape(section.words)}</p><p><code>{escape(section.command)}</code></p>"
        f"{f'<p>Files: {linked}</p>' if linked else ''}{shown}"
    )


def _link(path: Path, base: Path) -> str:
    return quote(path.relative_to(base).as_posix())
