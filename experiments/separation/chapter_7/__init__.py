"""Design equations of the thesis' chapter 7, their regressions and printed rows."""
