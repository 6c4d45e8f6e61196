"""The result folders of `pounding shake` and `pounding pound`: which files they hold, and writing them."""
