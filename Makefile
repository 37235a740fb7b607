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
.PHONY: help demo test lint types browser bench bench-quick stress docs clean

help:  ## list what make can do
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  make %-12s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

demo: $(READY)  ## simulate a towed cable: log, picture, report, and comparison with the closed form
	@mkdir -p out
	$(BIN)/cablemodel run $(SCENE) --log $(RUN)
	$(BIN)/cablemodel plot $(RUN) --output out/towed_cable.png
	$(BIN)/cablemodel report $(RUN) --output out/towed_cable.html
	$(BIN)/python examples/towed_cable.py

test: lint types browser  ## check style and types, then run all tests
	$(BIN)/python -m pytest

lint: $(READY_DEV)  ## check style with ruff
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(READY_DEV)  ## check types with mypy
	$(BIN)/mypy

browser:  ## install Chromium, with which tests look at the report (Debian, as root)
	@command -v chromedriver >/dev/null || { [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null \
		&& apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq \
			--no-install-recommends chromium chromium-driver >/dev/null; } \
		|| echo "No Chromium: the tests that look at the report in a browser will be skipped."

bench: $(READY_DEV)  ## measure run time against error (long)
	$(BIN)/python -m benchmarks

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
