# Two commands matter: `make demo` and `make test`. Each sets up what it needs on a machine that has
# only Python (3.11 to 3.13, with venv) and make.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
READY_DEV := $(VENV)/.ready-dev
SCENE := scenes/towed_cable.yaml
RUN := out/towed_cable.mcap

.DEFAULT_GOAL := help
.PHONY: help demo test lint types native libraries wheel test-tools bench bench-quick stress docs clean

help:  ## list what make can do
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  make %-12s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

demo: $(READY) native  ## simulate a towed cable: log, picture, and comparison with the closed form
	@mkdir -p out
	$(BIN)/cablemodel run $(SCENE) --log $(RUN)
	$(BIN)/cablemodel plot $(RUN) --output out/towed_cable.png
	$(BIN)/python examples/towed_cable.py

test: lint types libraries test-tools  ## check style and types, then run all tests
	$(BIN)/python -m pytest

lint: $(READY_DEV)  ## check style with ruff
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(READY_DEV)  ## check types with mypy
	$(BIN)/mypy

native: $(READY)  ## build this machine's library, if the kernels have changed
	@$(BIN)/python -m cablemodel_fmu.build native

libraries: $(READY_DEV)  ## build the libraries of all platforms, if the kernels have changed
	@$(BIN)/python -m cablemodel_fmu.build

wheel: libraries  ## build a wheel that holds the libraries of all platforms
	$(BIN)/python -m pip wheel --quiet --no-deps --wheel-dir dist .

# Wine and QEMU run the libraries of Windows and of Linux on ARM; without them those tests skip.
test-tools:
	@if [ "$$(uname -sm)" = "Linux x86_64" ] && [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null \
	&& ! { [ -e /usr/lib/wine/wine64 ] && command -v qemu-aarch64 >/dev/null \
	&& [ -e /usr/aarch64-linux-gnu ]; }; then \
		echo "installing wine64 and qemu-user for the tests of other platforms"; \
		{ apt-get update && apt-get install --yes --no-install-recommends \
			wine64 qemu-user libc6-arm64-cross; } >/dev/null 2>&1 \
			|| echo "that failed: the tests of other platforms will be skipped"; \
	fi

bench: $(READY_DEV)  ## measure run time against error (long)
	$(BIN)/python -m benchmarks
	$(BIN)/python -m benchmarks.fmu

bench-quick: $(READY_DEV)  ## measure a few scenes only
	$(BIN)/python -m benchmarks --quick

stress: $(READY_DEV)  ## run the stress scenes (long)
	$(BIN)/python -m pytest tests/stress -m "slow or not slow"

docs: $(READY_DEV)  ## write the generated pages of docs/ anew
	$(BIN)/python docs/write_scene_reference.py

clean:  ## remove environments, builds, caches and output
	rm -rf .venv .venv-ros build dist out *.egg-info
	rm -rf .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# The stamps keep a second call from installing again; a change of pyproject.toml does.
$(READY): pyproject.toml
	@$(MAKE) --no-print-directory $(BIN)/python
	$(BIN)/python -m pip install --quiet --editable '.[plot,fmu]'
	@touch $@

$(READY_DEV): pyproject.toml $(READY)
	$(BIN)/python -m pip install --quiet --editable '.[plot,fmu,dev]'
	@touch $@

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))' \
		|| { echo "Python 3.11 to 3.13 is needed; choose one: make PYTHON=python3.12"; exit 1; }
	$(PYTHON) -m venv $(VENV)
