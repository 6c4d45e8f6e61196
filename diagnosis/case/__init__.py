"""A measured case: what stands in `case.toml` and its CSV files, checked, in SI.

`reading.read_case(folder)` gives a `case.Case`; `writing.write_case` writes one.
"""
