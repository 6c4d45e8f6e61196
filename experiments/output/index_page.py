"""A page that shows what a command wrote: pictures where there are some, and links to all other files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple
from urllib.parse import quote

from pounding.experiments.output.html import TEMPLATES
from pounding.frames.files import write_whole

IMAGES = (".png", ".gif")


class Section(NamedTuple):
    """A part of the page.

    Attributes:
        title: Its heading.
        words: What the files show.
        folder: Folder with the files; its subfolders are left out, which hold what a series file opens.
        command: What makes the same on its own.
        captions: What a picture shows, by the name of its file.
    """

    title: str
    words: str
    folder: Path
    command: str
    captions: Mapping[str, str] = {}


def write_index(title: str, sections: Sequence[Section], path: Path) -> None:
    """Write the page; an existing one is replaced only when the new one is whole.

    Args:
        title: Heading of the page.
        sections: Its parts; one whose folder is not there is left out.
        path: File to write; links are relative to its folder.

    Raises:
        FrameError: The file cannot be written.
    """
    parts = []
    for section in sections:
        if section.folder.is_dir():
            files = sorted(
                one for one in section.folder.iterdir() if one.is_file() and not one.name.startswith(".")
            )
            images = [one for one in files if one.suffix in IMAGES]
            others = [one for one in files if one.suffix not in IMAGES]
            links = {
                "images": [
                    one | {"caption": section.captions.get(one["name"], one["name"])}
                    for one in _links(images, path.parent)
                ],
                "files": _links(others, path.parent),
            }
            parts.append({"title": section.title, "words": section.words, "command": section.command} | links)
    page = TEMPLATES.get_template("index.html").render(title=title, parts=parts)
    write_whole(path, page.encode())


def _links(files: Iterable[Path], base: Path) -> list[dict[str, str]]:
    return [{"name": one.name, "link": quote(one.relative_to(base).as_posix())} for one in files]
