"""The error of this package: an input that an experiment cannot be made of."""

from pounding.errors import InputError


class ExperimentError(InputError):
    """A record, rig, study or output that cannot be used; the message says what, where and what to do."""
