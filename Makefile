# Two commands matter: `make demo` and `make test`. Each sets up what it needs on a machine that has
# only Python (3.11 to 3.13, with venv) and make.

PYTHON ?= python3
WORKERS ?= 2
TOGETHER := -n $(WORKERS) --dist loadfile --no-loadscope-reorder
# What is never imported need not be compiled; what one start of Python compiles the next one finds.
PIP := -m pip install --quiet --quiet --no-compile
unexport PYTHONDONTWRITEBYTECODE
# Installs into an environment. Uv takes seconds where pip takes a minute, and knows nothing of pip's
# settings: where it fails, pip does it.
install = $(1)/bin/python $(PIP) 'uv>=0.9,<1' \
	&& $(1)/bin/python -m uv pip install --quiet --python $(1) $(2) || $(1)/bin/python $(PIP) $(2)
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
READY_DEV := $(VENV)/.ready-dev
READY_BENCH := $(VENV)/.ready-bench
READY_DOCS := $(VENV)/.ready-docs
VENV_ROS := .venv-ros
READY_ROS := $(VENV_ROS)/.ready
TEST_ROS = $(VENV_ROS)/bin/python -m pytest $(TOGETHER) tests/interface/ros
ROS_SAYS := out/ros_tests.txt
VENV_MASTERS := .venv-masters
READY_MASTERS := $(VENV_MASTERS)/.ready
SCENE := scenes/towed_cable.yaml
RUN := out/towed_cable.mcap

.DEFAULT_GOAL := help
.PHONY: help demo demo-ros test test-all-but-ros test-ros test-ros-aside lint types browser native
.PHONY: libraries wheel release test-tools
.PHONY: bench bench-quick bench-ros count-store valgrind stress validate golden docs clean

help:  ## list what make can do
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  make %-12s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

demo: $(READY) native  ## simulate a towed cable: log, picture, report, and comparison with the closed form
	@mkdir -p out
	$(BIN)/cablemodel run $(SCENE) --log $(RUN)
	$(BIN)/cablemodel plot $(RUN) --output out/towed_cable.png
	$(BIN)/cablemodel report $(RUN) --output out/towed_cable.html
	$(BIN)/python examples/towed_cable.py

# What the tests need is made at the same time. Those of the ROS 2 node mostly wait for the clock: they
# run beside the others, go first, and are shown when both have ended.
test:  ## check style and types, then run all tests
	@$(MAKE) --no-print-directory $(READY_DEV)
	@$(MAKE) --no-print-directory -j 6 lint libraries types $(READY_ROS) $(READY_MASTERS) test-tools
	@$(MAKE) --no-print-directory --keep-going -j 2 test-ros-aside test-all-but-ros; status=$$?; \
		cat $(ROS_SAYS); exit $$status

# Threads of NumPy's own would wait for processors that other tests use, and use them meanwhile.
test-all-but-ros test-ros test-ros-aside: export OPENBLAS_NUM_THREADS ?= 1

test-all-but-ros:
	nice $(BIN)/python -m pytest $(TOGETHER)

test-ros-aside:
	@mkdir -p out
	$(TEST_ROS) >$(ROS_SAYS) 2>&1

test-ros: $(READY_ROS)  ## run the tests of the ROS 2 node only
	$(TEST_ROS)

demo-ros: $(READY_ROS)  ## tow along way-points: the ROS 2 node, and a controller with a winch
	@mkdir -p out
	$(VENV_ROS)/bin/python ros2_node/examples/waypoint_tow.py --plot out/waypoint_tow.png

bench-ros: $(READY_ROS)  ## measure the ROS 2 node: ten minutes live, an hour accelerated
	$(VENV_ROS)/bin/python ros2_node/measure.py

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

native: $(READY)  ## build this machine's library, if the kernels have changed
	@$(BIN)/python -m cablemodel_fmu.build native

libraries: $(READY_DEV)  ## build the libraries of all platforms, if the kernels have changed
	@$(BIN)/python -m cablemodel_fmu.build

wheel: libraries  ## build a wheel that holds the libraries of all platforms
	$(BIN)/python -m pip wheel --quiet --no-deps --wheel-dir dist .

release: $(READY_DEV)  ## VERSION=1.0.0: write it everywhere, test, build the wheel, commit and tag
	@git diff --quiet HEAD || { echo "There are changes that are not committed."; exit 1; }
	$(BIN)/python docs/write_version.py "$(VERSION)"
	$(MAKE) --no-print-directory test wheel
	git commit --quiet --all --message "Version $(VERSION)" && git tag "v$(VERSION)"

# Wine and QEMU run the libraries of Windows and of Linux on ARM; without them those tests skip.
test-tools: browser
	@if [ "$$(uname -sm)" = "Linux x86_64" ] && [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null \
	&& ! { [ -e /usr/lib/wine/wine64 ] && command -v qemu-aarch64 >/dev/null \
	&& [ -e /usr/aarch64-linux-gnu ]; }; then \
		echo "installing wine64 and qemu-user for the tests of other platforms"; \
		{ apt-get update && apt-get install --yes --no-install-recommends \
			wine64 qemu-user libc6-arm64-cross; } >/dev/null 2>&1 \
			|| echo "that failed: the tests of other platforms will be skipped"; \
	fi

bench: $(READY_BENCH) native valgrind  ## measure run time against error (long)
	$(BIN)/python -m benchmarks
	$(BIN)/python -m benchmarks.systems
	$(BIN)/python -m benchmarks.skips
	$(BIN)/python -m benchmarks.starts
	$(BIN)/python -m benchmarks.random_lays
	$(BIN)/python -m benchmarks.profile
	$(BIN)/python -m benchmarks.fmu

bench-quick: $(READY_BENCH) native valgrind  ## compare instruction counts with those stored, measure a few scenes
	$(BIN)/python -m benchmarks.instructions
	$(BIN)/python -m benchmarks --quick

count-store: $(READY_BENCH) native valgrind  ## store the present instruction counts
	$(BIN)/python -m benchmarks.instructions --store

# Debian's, as root; elsewhere valgrind and a C compiler must be there.
valgrind:
	@{ command -v valgrind && command -v cc; } >/dev/null || { [ "$$(id -u)" = 0 ] && apt-get update -qq \
		&& DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
			valgrind gcc libc6-dev >/dev/null; } \
		|| echo "No valgrind or no C compiler: instructions cannot be counted."

stress: $(READY_BENCH)  ## run the stress scenes (long)
	$(BIN)/python -m pytest tests/stress -m "slow or not slow"
	$(BIN)/python -m benchmarks.robustness
	$(BIN)/python -m benchmarks.stress_scenes
	$(BIN)/python -m benchmarks.soak
	$(BIN)/python -m benchmarks.slack
	$(BIN)/python -m benchmarks.random_scenes.heave
	$(BIN)/python -m benchmarks.random_scenes.estimate
	for kind in --waves --ordinary --converge ""; do \
		$(BIN)/python -m benchmarks.random_scenes $$kind || failed=1; done; exit $${failed:-0}

validate: $(READY_BENCH) native  ## compare with measurements, other programs and closed forms
	$(BIN)/python -m validation
	$(BIN)/python -m validation.jobs

golden: $(READY_DEV)  ## make the golden logs of tests/replay anew, where results have changed
	$(BIN)/python tests/replay/make_golden.py

docs: $(READY_DOCS)  ## write the generated parts of docs/ anew, and build their site into out/site
	$(BIN)/python docs/write_scene_reference.py
	$(BIN)/python docs/write_ros2_tables.py
	$(BIN)/python docs/write_constants.py
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --clean

clean:  ## remove environments, builds, caches and output
	rm -rf .venv .venv-ros .venv-masters build dist out *.egg-info
	rm -rf .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# What is installed into each environment.
FOR_USE := --editable '.[plot,analysis,export,fmu]'
FOR_DEV := --editable '.[plot,analysis,export,fmu,dev]'
FOR_BENCH := --editable '.[bench]'
FOR_DOCS := --editable '.[docs]'
FOR_ROS := --editable . --editable './ros2_node[wheels,colcon]' 'matplotlib>=3.8,<4' \
	'mujoco>=3.2,<5' 'pytest>=8,<10' 'pytest-xdist>=3.7,<4'
FOR_MASTERS := 'cofmupy>=1,<2'

# The wheels of rclpy re-execute every start of Python in their environment: they get their own.
$(READY_ROS): pyproject.toml ros2_node/setup.py
	$(call environment,$(VENV_ROS))
	$(call install,$(VENV_ROS),$(FOR_ROS))
	@touch $@

# CoFMPy wants versions of its own of what tests use. Without it its test is skipped.
$(READY_MASTERS):
	@$(PYTHON) -m venv $(VENV_MASTERS) && { $(call install,$(VENV_MASTERS),$(FOR_MASTERS)); } \
		&& touch $@ || echo "No CoFMPy: its test will be skipped."

# The stamps keep a second call from installing again; a change of pyproject.toml does.
$(READY): pyproject.toml | $(BIN)/python
	$(call install,$(VENV),$(FOR_USE))
	@touch $@

$(READY_DEV): pyproject.toml | $(BIN)/python
	$(call install,$(VENV),$(FOR_DEV))
	@touch $(READY) $@

$(READY_BENCH): pyproject.toml $(READY_DEV)
	$(call install,$(VENV),$(FOR_BENCH))
	@touch $@

$(READY_DOCS): pyproject.toml $(READY_DEV)
	$(call install,$(VENV),$(FOR_DOCS))
	@touch $@

$(BIN)/python:
	$(call environment,$(VENV))

define environment
@$(PYTHON) -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))' \
	|| { echo "Python 3.11 to 3.13 is needed; choose one: make PYTHON=python3.12"; exit 1; }
$(PYTHON) -m venv $(1)
endef
