# make demo: the paper's case from nothing.  make test: the whole suite.  make lint, format, build, clean.
# make docs: the manual, in build/site; make docs-outputs: its commands' outputs, made again.
# make coverage: the whole suite, and what of the Python and of the C it leaves out.
# make dist: sdist and a wheel for each Python here, each tried in an empty environment.
# make tournament: laws on 22 robots, hours; goes on where it was stopped; docs/measured/tournament.md.
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

C_FILES := $(sort $(shell find src tests -name '*.[ch]' -o -name '*.cpp'))
# Tests that drive the kernel and its binding: those that gcov counts, on code as it is written.
C_TESTS := $(foreach name,arguments batch binding bounds compilers control controller errors followers \
  forward_dynamics forward_kinematics inverse_dynamics kernel_errors loop mass_matrix mimic rounding \
  sincos slack unsound_input,$(shell find tests -name test_$(name).py))
COVERED := build/coverage
PACKAGES := $(abspath $(VENV))/lib/python*/site-packages
PARALLEL := -n auto --dist worksteal

.DELETE_ON_ERROR:
.PHONY: demo test lint format build coverage coverage-python coverage-c dist docs docs-outputs tournament fuzz clean

demo: $(VENV)/.installed
	$(BIN)/modrobust simulate lwa4p-paper --scenario 1

test: $(VENV)/.installed-test
	$(BIN)/python -m pytest $(PARALLEL)

lint: $(VENV)/.installed-test
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/clang-format --dry-run --Werror $(C_FILES)

format: $(VENV)/.installed-test
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .
	$(BIN)/clang-format -i $(C_FILES)

coverage: coverage-python coverage-c

# The whole suite; its command-line runs and pytest's workers count too.
coverage-python: $(VENV)/.installed-test
	rm -rf $(COVERED)/python*
	mkdir -p $(COVERED)
	PYTHONPATH=tools $(BIN)/coverage run -m pytest -p patient_workers $(PARALLEL)
	$(BIN)/coverage combine --quiet
	$(BIN)/coverage report --fail-under=0 --show-missing > $(COVERED)/python.txt
	$(BIN)/coverage report
	@echo "What of the Python is left out: $(COVERED)/python.txt"

# The extension once more, in an environment of its own that borrows the other packages.
coverage-c: $(VENV)/.installed-test
	rm -rf $(COVERED)/c $(COVERED)/c.txt
	$(BIN)/python -m venv $(COVERED)/c
	ls -d $(PACKAGES) $(PACKAGES)/cmeel.prefix/lib/python*/site-packages > $(COVERED)/borrowed.pth
	mv $(COVERED)/borrowed.pth $(COVERED)/c/lib/python*/site-packages
	PATH="$(abspath $(BIN)):$$PATH" $(COVERED)/c/bin/python -m pip install --quiet --no-deps \
	  --no-build-isolation --config-settings=build-dir=$(COVERED)/c/objects \
	  --config-settings=cmake.build-type=Debug \
	  --config-settings=cmake.define.MODROBUST_COVERAGE=ON .
	PYTHONPATH=tools $(COVERED)/c/bin/python -m pytest --quiet -p patient_workers $(PARALLEL) \
	  -k "not a_build_computes" $(C_TESTS)
	$(BIN)/gcovr --root . --filter src/ --exclude-throw-branches --merge-lines \
	  --merge-mode-functions=separate --txt-metric line --txt-metric branch \
	  --fail-under-line 98 --fail-under-branch 92 --txt $(COVERED)/c.txt $(COVERED)/c/objects; \
	  status=$$?; cut -c 1-98 $(COVERED)/c.txt; exit $$status
	@echo "What of the C and C++ is left out: $(COVERED)/c.txt"

build: $(VENV)/.tools
	rm -rf dist
	$(BIN)/pip wheel --quiet --no-deps --no-build-isolation --wheel-dir dist .

dist: $(VENV)/.installed-test
	$(BIN)/python tools/dist.py

docs: $(VENV)/.installed-docs
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict

docs-outputs: $(VENV)/.installed-test
	PYTHONPATH=tests $(BIN)/python tools/manual_outputs.py

tournament: $(VENV)/.installed-test
	$(BIN)/python benchmarks/tournament.py --page

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
