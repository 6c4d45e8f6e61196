# Two commands for a fresh machine with Python 3.11 or newer: `make demo` and `make test`.
PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
OUT    ?= results/demo

# The linear algebra here is many small matrices: threads of the BLAS only fight with our processes.
export OMP_NUM_THREADS ?= 1
export OPENBLAS_NUM_THREADS ?= 1

# pip is not to compile all modules of all packages, which takes as long as the rest of an installation: Python compiles
# those that are used, and must be let keep them.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo test test-slow guard second-world shear-world planar-world lint types docs clean links

demo: $(VENV)/installed
	$(BIN)/pounding demo --out $(OUT)

test: $(VENV)/installed
	$(BIN)/python -m pytest -m "not slow" -n 2 --dist worksteal

# Only the files that have some are read: reading all takes half a minute.
test-slow: $(VENV)/installed
	$(BIN)/python -m pytest -m "slow and not guard" -n 2 --dist worksteal $$(grep -rl --include='test_*.py' mark.slow tests)

# Not part of .ci/run: tests of half a minute and more, then the cases, half an hour or more. Another set: make guard GUARD="--only open --workers 1".
guard: $(VENV)/installed
	$(BIN)/python -m pytest -m guard -n 2
	$(BIN)/python -m tests.guard $(GUARD)

# Not part of .ci/run either: it needs openseespy, which is no dependency (docs/diagnosis/hidden-cases.md).
second-world: $(VENV)/installed
	$(BIN)/python -m tests.second_world

# Nor this: fourteen cases of half a minute and more. Some of them: make shear-world SHEAR="friction stop".
shear-world: $(VENV)/installed
	$(BIN)/python -m tests.shear_world $(SHEAR)

# Nor this: 24 cases of plane frames in a random order, which take hours. Another set: make planar-world PLANAR="--seed 2 --out DIR --diagnose".
PLANAR ?= --out results/planar_world --diagnose
planar-world: $(VENV)/installed
	$(BIN)/python -m tests.planar_world $(PLANAR)

lint: $(VENV)/installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(VENV)/installed
	$(BIN)/mypy

docs: $(VENV)/installed
	$(BIN)/sphinx-build -q -W --keep-going -b html docs docs/_build/html

# pounding/frames and so on are links; git makes text files of them where it may not make links.
links:
	@test -d pounding/frames/ || { echo "pounding/frames is no link to frames/: this clone was made without symbolic links;\
 run 'git config core.symlinks true && rm -r pounding && git checkout -- pounding' where links are allowed" >&2; exit 1; }

$(VENV)/installed: pyproject.toml | links
	$(PYTHON) -c 'import sys; sys.exit(0 if (3, 11) <= sys.version_info[:2] <= (3, 13) else "Python 3.11, 3.12 or 3.13 is needed, this is %d.%d: name another with make PYTHON=python3.12" % sys.version_info[:2])'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile --editable ".[develop]"
	touch $@

clean:
	rm -rf $(VENV) docs/_build results .mypy_cache .ruff_cache .pytest_cache
