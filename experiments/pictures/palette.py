"""Colours that the colour-blind tell apart too (Okabe and Ito 2008), from dark to light in a grey print.

In a report of the diagnosis black is what was measured, blue what the calibrated model gives, orange the model with what was
found, green the baseline.
"""

BLACK, BLUE, ORANGE, GREEN, GREY = "#000000", "#0072b2", "#e69f00", "#009e73", "#4a5568"
VERMILION, PURPLE, SKY = "#d55e00", "#cc79a7", "#56b4e9"
