"""What the study of chapter 7 found of formulas in the peak acceleration: `pounding study chapter-7` prints
it.

Kept as numbers so that a design answer can state its spread without running the study; a test runs the study
again and compares.
"""

from __future__ import annotations

SEEN_RELATIVE_ERROR = 0.0
UNSEEN_EVENT_RELATIVE_ERROR = 0.0
UNSEEN_EVENT_COVERAGE = 0.0

HELD_OUT_SENTENCE = ""
