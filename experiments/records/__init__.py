"""Ground motions: what a record is, reading one from a file, and finding one by name."""

from experiments.records.catalogue import Entry, available, find, records_folder
from experiments.records.reading import read
from experiments.records.record import MODEL_TIME_FACTOR, STANDARD_GRAVITY, Record
from experiments.records.reference import REFERENCES, Reference

__all__ = [
    "MODEL_TIME_FACTOR",
    "REFERENCES",
    "STANDARD_GRAVITY",
    "Entry",
    "Record",
    "Reference",
    "available",
    "find",
    "read",
    "records_folder",
]
