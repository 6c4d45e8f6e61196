"""The Tab key: scripts for bash, zsh and fish that offer names known to the program, and files beside them."""

from __future__ import annotations

import re
from typing import Any, Literal

from cyclopts import App

Frames = Literal["5A", "5B", "8", "10", "12", "15A", "15B"]
Records = Literal[
    "elcentro",
    "hachinohe",
    "northridge",
    "kobe",
    "elcentro-peer180",
    "elcentro-chopra",
    "sylmar-syl360",
    "elcentro-array7-230",
    "beverlyhills-mul279",
    "coolwater-ln",
    "hollywood-pel180",
]
Laws = Literal["linear_spring", "linear_viscoelastic", "hertz", "nonlinear_viscoelastic", "hertz_damp", "all"]

_NAMES = r"(5A 5B 8 10 12 15A 15B|elcentro hachinohe [\w -]+)"
"""Frames or records as a script lists them: in their place a file can stand, too."""


class Command(App):
    """A command whose Tab key offers files beside names, where cyclopts offers the names alone."""

    def generate_completion(self, **asked: Any) -> str:
        """Return the script for a shell.

        Args:
            asked: What `App.generate_completion` takes.
        """
        script = super().generate_completion(**asked)
        # bash: files where no name begins with what was typed.
        script = script.replace("\ncomplete -F ", "\ncomplete -o default -F ")
        # fish: -x and -f leave files out.
        script = re.sub(rf"-x -a '{_NAMES}'", r"-r -F -a '\1'", script)
        script = re.sub(rf"-f -a '{_NAMES}'", r"-F -a '\1'", script)
        # zsh: of an option or a place, and in a function.
        script = re.sub(rf":\({_NAMES}\)", r":{compadd -- \1; _files}", script)
        return re.sub(r"(compadd -- '(?:5A|elcentro)' [^\n]+)", r"\1; _files", script)
