"""The error of this package: a case, a candidate or a hidden effect that cannot be used."""

from pounding.errors import InputError


class CaseError(InputError):
    """A measured case that cannot be read or diagnosed; the message says what, where and what to do."""
