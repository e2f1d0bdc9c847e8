# make demo: the paper's case from nothing.  make test: the whole suite.  make lint, build, clean.
# make docs: the manual, in build/site; make docs-outputs: its commands' outputs, made again.
# make fuzz: both fuzz targets for FUZZ_SECONDS each; what they learn and find stays in build/fuzz.
PYTHON ?= python3
VENV := .venv
export PIP_DISABLE_PIP_VERSION_CHECK := 1
BIN := $(VENV)/bin
FUZZ_SECONDS ?= 1800
# What the compiled part and the metadata depend on; Python sources are read in place.
NATIVE := pyproject.toml CMakeLists.txt src/_kernel.cpp $(wildcard src/modrobust/kernel/*.[ch]) \
          src/modrobust/kernel/flags.txt
REQUIRES := import tomllib; \
  print(*tomllib.load(open("pyproject.toml", "rb"))["build-system"]["requires"], sep="\n")
DOCS := import tomllib; \
  print(*tomllib.load(open("pyproject.toml", "rb"))["project"]["optional-dependencies"]["docs"], sep="\n")

.DELETE_ON_ERROR:
.PHONY: demo test lint format build docs docs-outputs fuzz clean

demo: $(VENV)/.installed
	$(BIN)/modrobust simulate lwa4p-paper --scenario 1

test: $(VENV)/.installed-test
	$(BIN)/python -m pytest

lint: $(VENV)/.installed-test
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy

format: $(VENV)/.installed-test
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

build: $(VENV)/.tools
	rm -rf dist
	$(BIN)/pip wheel --quiet --no-deps --no-build-isolation --wheel-dir dist .

docs: $(VENV)/.installed-docs
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet --strict

docs-outputs: $(VENV)/.installed-test
	PYTHONPATH=tests $(BIN)/python tools/manual_outputs.py

fuzz: $(VENV)/.installed-test
	$(BIN)/python tests/fuzz/readers_fuzz.py build/fuzz/readers --seconds $(FUZZ_SECONDS)
	PYTHONPATH=tests $(BIN)/python tests/fuzz/kernel_target.py build/fuzz/kernel \
	  -max_total_time=$(FUZZ_SECONDS)

clean:
	rm -rf $(VENV) build dist

# The build tools go into the environment, so that a rebuild takes seconds.
$(VENV)/.tools: pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -c '$(REQUIRES)' > $(VENV)/requires.txt
	$(BIN)/pip install --quiet --requirement $(VENV)/requires.txt cmake ninja
	touch $@

$(VENV)/.installed: $(VENV)/.tools $(NATIVE)
	$(BIN)/pip install --quiet --no-build-isolation --editable .
	touch $@

$(VENV)/.installed-test: $(VENV)/.tools $(NATIVE)
	$(BIN)/pip install --quiet --no-build-isolation --editable '.[test]'
	touch $@ $(VENV)/.installed

# The manual reads the package's sources; it needs nothing of the package itself.
$(VENV)/.installed-docs: $(VENV)/.tools pyproject.toml
	$(BIN)/python -c '$(DOCS)' > $(VENV)/docs.txt
	$(BIN)/pip install --quiet --requirement $(VENV)/docs.txt
	touch $@
