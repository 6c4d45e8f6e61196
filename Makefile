# Two commands for a fresh machine with Python 3.11 or newer: `make demo` and `make test`.
PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
OUT    ?= results/demo

# The linear algebra here is many small matrices: threads of the BLAS only fight with our processes.
export OMP_NUM_THREADS ?= 1
export OPENBLAS_NUM_THREADS ?= 1

.PHONY: demo test test-slow lint types docs clean

demo: $(VENV)/installed
	$(BIN)/pounding demo --out $(OUT)

test: $(VENV)/installed
	$(BIN)/python -m pytest -m "not slow" -n 2

test-slow: $(VENV)/installed
	$(BIN)/python -m pytest -m slow -n 2

lint: $(VENV)/installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(VENV)/installed
	$(BIN)/mypy

docs: $(VENV)/installed
	rm -rf docs/reference
	$(BIN)/sphinx-build -q -W --keep-going -b html docs docs/_build/html

$(VENV)/installed: pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit(0 if (3, 11) <= sys.version_info[:2] <= (3, 13) else "Python 3.11, 3.12 or 3.13 is needed, this is %d.%d: name another with make PYTHON=python3.12" % sys.version_info[:2])'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable ".[develop]"
	touch $@

clean:
	rm -rf $(VENV) docs/_build results .mypy_cache .ruff_cache .pytest_cache
