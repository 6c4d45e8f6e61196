"""What to measure next: detectable sizes, tests that distinguish effects, further measurements."""
