"""What contact refuses."""

from pounding.errors import InputError


class ContactError(InputError):
    """A law, a parameter or a collision that cannot be; the message says what to change."""
