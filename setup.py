"""What pyproject.toml cannot say: on a package index the README stands without links to files of the repository."""

import re
from pathlib import Path

from setuptools import setup

RELATIVE = r"\((?!https?:)[^)]*\)"
"""The target of a link or picture that is a file or a heading of the repository, which an index page does not have."""


def described(readme: str) -> str:
    """Return a README without its own pictures (and their captions), and with the words alone of links to its own files.

    Args:
        readme: The README in Markdown.
    """
    without = re.sub(rf"!\[[^\]]*\]{RELATIVE}\n+\*[^*]*\*\n+", "", readme)
    return re.sub(rf"!?\[([^\]]*)\]{RELATIVE}", r"\1", without)


if __name__ == "__main__":
    text = described((Path(__file__).parent / "README.md").read_text(encoding="utf-8"))
    setup(long_description=text, long_description_content_type="text/markdown")
