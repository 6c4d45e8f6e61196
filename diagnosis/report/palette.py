"""Colours of the report: what was simulated before and after, and what stands back."""

BLUE, ORANGE, GREY = "#2b6cb0", "#dd6b20", "#4a5568"
