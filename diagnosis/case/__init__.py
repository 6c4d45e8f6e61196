"""A measured case: what stands in `case.toml` and its CSV files, checked, in SI."""
