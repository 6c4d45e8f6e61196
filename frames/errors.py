"""The error of this package: a frame that cannot be used."""


class FrameError(ValueError):
    """A frame, mesh or model that cannot be used; the message says what, where and what to do."""
