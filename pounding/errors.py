"""The error that every package's own error is: input that cannot be used."""


class InputError(ValueError):
    """Input that cannot be used; the message is one sentence that says what, where and what to do."""
