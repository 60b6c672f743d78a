# Needs python3 (3.10 to 3.13), make and, the first time, a package index. PYTHON=... picks another Python.
.DEFAULT_GOAL := help
.PHONY: help setup demo test lint lock clean

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
LOCKED := --require-hashes --no-deps --no-build-isolation -r requirements.lock
DEPENDENCIES := $(VENV)/dependencies.stamp
SETUP := $(VENV)/setup.stamp

# A sourced ROS installation or another environment of ROS wheels must not leak into this one.
unexport PYTHONPATH PYTHONHOME LD_LIBRARY_PATH _ROS_WHEELS_BOOTSTRAP_COMPLETE
export AMENT_PREFIX_PATH := $(CURDIR)/$(VENV)
export VIRTUAL_ENV := $(CURDIR)/$(VENV)

help:  ## Show this list.
	@sed -n 's/^\([a-z]*\):.*## /  make \1|/p' Makefile | awk -F'|' '{printf "%-14s%s\n", $$1, $$2}'

setup: $(SETUP)  ## Install everything into .venv (the other targets do it, too).

demo: $(SETUP)  ## Drive the demo scenario over Fast DDS; ends with its bag and report below runs/.
	@$(BIN)/omni_vehicle run demo --out runs/demo-$$(date +%Y%m%d-%H%M%S)

test: $(SETUP)  ## Run all tests: what starts no nodes in two processes, then the graphs one after the other.
	@$(BIN)/python -m pytest -m 'not graph' --numprocesses 2 --dist loadfile
	@$(BIN)/python -m pytest -m graph

lint: $(SETUP)  ## Check style and types.
	@$(BIN)/ruff check .
	@$(BIN)/mypy

lock: $(SETUP)  ## Lock anew what requirements.in names.
	$(BIN)/uv pip compile --quiet --upgrade --generate-hashes --universal --python-version 3.10 \
	  --custom-compile-command 'make lock' requirements.in --output-file requirements.lock

clean:  ## Remove .venv and all caches; runs/ stays.
	rm -rf $(VENV) build install log *.egg-info .hypothesis .import_linter_cache .mypy_cache .pytest_cache .ruff_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

$(DEPENDENCIES): requirements.lock
	@command -v '$(PYTHON)' >/dev/null || { echo 'No $(PYTHON) here: install Python 3.10 to 3.13, or name one with PYTHON=...' >&2; exit 1; }
	@'$(PYTHON)' scripts/check_python.py
	@echo 'Setting up $(VENV) from requirements.lock: half a minute, downloads aside ...'
	@'$(PYTHON)' -m venv --clear $(VENV)
	@touch $(VENV)/COLCON_IGNORE
# From the lock: uv, ten times as fast as pip, and setuptools, which builds the one package (empy) without a wheel.
	@sed -n -e '/^setuptools==/,/# via/p' -e '/^uv==/,/# via/p' requirements.lock > $(VENV)/bootstrap.lock
	@$(BIN)/python -m pip --disable-pip-version-check -qq install --require-hashes -r $(VENV)/bootstrap.lock
# pip knows indexes and proxies (pip.conf) that uv does not.
	@$(BIN)/uv pip install --quiet $(LOCKED) --compile-bytecode \
	  || $(BIN)/python -m pip -qq install --use-pep517 $(LOCKED)
	@touch $@

$(SETUP): $(DEPENDENCIES) setup.py setup.cfg scripts/link_package.sh
	@sh scripts/link_package.sh $(VENV)
	@echo 'Compiling the physics ...'
	@$(BIN)/python -m omni_vehicle_ros.model.warm
	@touch $@
