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

TRIAL = """
import sys
import vtkmodules.vtkRenderingOpenGL2
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow
ball, mapper, actor, room, window = vtkSphereSource(), vtkPolyDataMapper(), vtkActor(), vtkRenderer(), vtkRenderWindow()
mapper.SetInputConnection(ball.GetOutputPort())
actor.SetMapper(mapper)
room.AddActor(actor)
window.SetOffScreenRendering(1)
window.SetSize(64, 64)
window.AddRenderer(room)
window.Render()
seen = vtkUnsignedCharArray()
window.GetRGBACharPixelData(0, 0, 63, 63, 1, seen)
sys.exit(0 if vtk_to_numpy(seen)[:, :3].std() > 1 else 3)
"""
"""Draws a ball, as VTK does it for pyvista, which itself takes a second to begin."""


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
