"""Ground motions: what a record is, reading one from a file, and finding one by name."""

from pounding.experiments.records.catalogue import Entry, available, file_of, find, records_folder
from pounding.experiments.records.reading import read
from pounding.experiments.records.record import Record
from pounding.experiments.records.reference import RECORDS, REFERENCES, Reference

__all__ = [
    "RECORDS",
    "REFERENCES",
    "Entry",
    "Record",
    "Reference",
    "available",
    "file_of",
    "find",
    "read",
    "records_folder",
]
