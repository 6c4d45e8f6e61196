"""The error of this package: a case, a candidate or a hidden effect that cannot be used."""


class CaseError(ValueError):
    """A measured case that cannot be read or diagnosed; the message says what, where and what to do."""
