"""The error of this package: an input that a frame cannot be made of."""

from pounding.errors import InputError


class FrameError(InputError):
    """A frame, mesh, option or motion that cannot be used; the message says what, where and what to do."""
