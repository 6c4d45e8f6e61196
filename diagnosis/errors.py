"""The error of this package: a case, a candidate or a hidden effect that cannot be used."""

from pounding.errors import InputError


class CaseError(InputError):
    """A measured case that cannot be read or diagnosed; the message says what, where and what to do.

    Attributes:
        table: The table of `case.toml` in which the fault is; empty where it is in no single table.
        index: Which of the tables of that name, from 0.
        key: The key in the table; empty where it is the table itself.
    """

    table: str = ""
    index: int = 0
    key: str = ""
