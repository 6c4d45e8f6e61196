"""Functions that sweeps in the tests run, in a module that worker processes can import."""

import os
import signal
import time
from pathlib import Path

import numpy as np
import xarray as xr

from pounding.experiments.sweeps.store import StoreError
from pounding.frames.files import replacing


def square(x, y=0.0, offset=0.0):
    return {"sum": x**2 + y + offset, "label": f"x={x}"}


def noted(x, log, pause_s=0.0):
    """Work for a while and leave one line for each case that was finished."""
    time.sleep(pause_s)
    with Path(log).open("a") as file:
        file.write(f"{x}\n")
    return {"twice": 2.0 * x}


def picky(x):
    if x == 3:
        raise ValueError("three is not wanted")
    return {"value": 1.0 * x}


def deadly(x):
    if x == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    return {"value": 1.0 * x}


def dies_once(x, mark):
    """Be killed the first time a case is run, as by the out-of-memory killer."""
    flag = Path(mark) / str(x)
    if x % 5 == 0 and not flag.exists():
        flag.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return {"value": 1.0 * x}


def history(x):
    time_s = np.arange(4) * 0.1
    data = xr.DataArray(x * time_s, {"time": time_s}, ("time",), attrs={"units": "m"})
    if x == 2:
        raise RuntimeError("no motion")
    return {"displacement": data, "peak_m": float(data.max())}


def bulky(x, log):
    """Return some 40 kB, and leave one line for each case that was run."""
    with Path(log).open("a") as file:
        file.write(f"{x}\n")
    return {"numbers": xr.DataArray(x + np.arange(2000) / 7.0, dims="sample")}


def heeding_ctrl_c():
    """Let a child process heed Ctrl-C even where this one was started in the background and ignores it."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def writes_while_the_disk_fills(x, folder):
    """Be stopped in the middle of a file, because the other case finds no room."""
    begun = Path(folder) / "begun.json"
    if x == 0:
        with replacing(begun) as part:
            part.write_text("half")
            time.sleep(60.0)
    while not list(Path(folder).glob(".begun.*")):
        time.sleep(0.01)
    raise StoreError("no room")
