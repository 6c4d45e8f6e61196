"""The error that every package's own error is: input that cannot be used; and Ctrl-C inside another language."""


class InputError(ValueError):
    """Input that cannot be used; the message is one sentence that says what, where and what to do."""


def heed_interruption(error: BaseException) -> None:
    """Raise KeyboardInterrupt if an error is what an engine made of a Ctrl-C that came while it was calling Python.

    Args:
        error: What the engine raised.
    """
    cause: BaseException | None = error
    while cause is not None:
        if isinstance(cause, KeyboardInterrupt):
            raise KeyboardInterrupt from None
        cause = cause.__cause__ or cause.__context__
