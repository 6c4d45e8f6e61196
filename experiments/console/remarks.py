"""What the library remarks while it works, shown on standard error where that is a terminal."""

from __future__ import annotations

import logging

from pounding.experiments.console.output import progress_console


class _Remarks(logging.Handler):
    """Prints a remark above whatever progress bar there is."""

    def emit(self, record: logging.LogRecord) -> None:
        console = progress_console()
        if console.is_terminal:
            console.print(record.getMessage(), markup=False, highlight=False)


_HANDLER = _Remarks(logging.INFO)


def show() -> None:
    """Show remarks of this package from now on; without it, as in a program of a user's, they are not shown."""
    logger = logging.getLogger("pounding")
    logger.setLevel(logging.INFO)
    logger.addHandler(_HANDLER)  # once, however often it is asked for
