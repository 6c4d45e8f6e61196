"""What contact refuses."""


class ContactError(ValueError):
    """A law, a parameter or a collision that cannot be; the message says what to change."""
