"""Says when the exact solver's loop is compiled, which takes some twenty seconds, once on a machine.

The sentence goes to Python's logging, which shows nothing of it unless a program asks for it, as the command does.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any

from numba.core import event

COMPILING = "compiling the solver, once on this machine"
"""What is said."""

_logger = logging.getLogger(__name__)


class Compiling(event.Listener):
    """Logs once a process that a module is compiled; a loop that comes from numba's cache is not.

    Args:
        module: Name of the module.
    """

    def __init__(self, module: str) -> None:
        self._module, self._said = module, False

    def on_start(self, event: Any) -> None:
        """Look at what is being compiled.

        Args:
            event: numba's event, with the dispatcher that compiles.
        """
        if not self._said and event.data["dispatcher"].py_func.__module__ == self._module:
            self._said = True
            _logger.info(COMPILING)

    def on_end(self, event: Any) -> None:
        """Nothing is said at the end."""


def announce(module: str) -> None:
    """Let it be logged when a module is compiled.

    Args:
        module: Name of the module.
    """
    register: Callable[[str, event.Listener], None] = event.register
    register("numba:compile", Compiling(module))
