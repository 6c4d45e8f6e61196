"""Whether this machine can draw at all, and through which window of VTK."""

from __future__ import annotations

import os
import subprocess
import sys
from functools import cache

WINDOW = "VTK_DEFAULT_OPENGL_WINDOW"
"""VTK's variable for the kind of window; without a display it would try X first and complain."""

KINDS = ("vtkEGLRenderWindow", "vtkOSOpenGLRenderWindow")
"""Windows that need no display: EGL, and Mesa's software renderer."""

TRIAL = (
    "import pyvista; p = pyvista.Plotter(off_screen=True, window_size=(64, 64));"
    "p.add_mesh(pyvista.Sphere(), color='red'); image = p.screenshot(return_img=True);"
    "import sys; sys.exit(0 if image.std() > 1 else 3)"
)


@cache
def cannot_render() -> str | None:
    """Return why this machine cannot render, in one sentence, or None if it can.

    Tried once in a process of its own, because a graphics library that is missing may kill the process.
    """
    with_display = os.environ.get("DISPLAY") or sys.platform in ("darwin", "win32")
    kinds = [os.environ.get(WINDOW)] if os.environ.get(WINDOW) or with_display else list(KINDS)
    reason = ""
    for kind in kinds:
        environment = dict(os.environ) | ({WINDOW: kind} if kind else {})
        try:
            trial = subprocess.run(
                [sys.executable, "-c", TRIAL], env=environment, capture_output=True, text=True, timeout=120
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            reason = str(error)
            continue
        if trial.returncode == 0:
            if kind:
                os.environ[WINDOW] = kind
            return None
        reason = (trial.stderr.strip().splitlines() or [f"exit status {trial.returncode}"])[-1]
    return (
        f"no pictures: this machine cannot render off screen ({reason.strip()[:200]}); on Debian or Ubuntu "
        "install libegl1, libgl1 and libxrender1, or libosmesa6"
    )
