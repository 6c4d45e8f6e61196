"""The thesis' studies, one script each with `main(...)`: run by `pounding study`, by `python -m` and by the tests."""
