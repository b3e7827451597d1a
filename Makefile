# Everything a user or developer runs. Works on a bare machine with Python >= 3.11, git and make:
# each target first creates $(VENV) and installs the pinned versions of requirements/constraints.txt.
SHELL := bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := help

VENV ?= .venv
BIN := $(VENV)/bin
WORKERS ?= 2
SETUP := pyproject.toml requirements/constraints.txt scripts/setup_venv.sh
# Two stamps: users of `make demo` do not wait for linters and docs tools.
USER_STAMP := $(VENV)/.installed-user
DEV_STAMP := $(VENV)/.installed-dev

.PHONY: help demo test test-slow test-matrix crash fuzz soak memory garbage checkers lint types docs bench wheel clean

help:  ## show this list
	@grep -E '^[a-z-]+:.*## ' Makefile | sed -E 's/:.*## /\t/' | expand -t 14

demo: $(USER_STAMP)  ## see and hear agents in houses; SUNCG_DATA_DIR=... uses real ones
	$(BIN)/home-mjx demo $(ARGS)

# Workers begin with one half of the files each, so that what tests of a file share is made once.
test: $(DEV_STAMP)  ## fast tests
	$(BIN)/python -m pytest -n $(WORKERS) --dist worksteal -m "not slow" $(ARGS)

test-slow: $(DEV_STAMP)  ## the tests that take long
	XLA_FLAGS= $(BIN)/python -m pytest -n $(WORKERS) --dist worksteal -m slow $(ARGS)

test-matrix:  ## a short suite on every supported jax, each in a .venv-<name> of its own
	scripts/test_matrix.sh $(ARGS)

crash: $(DEV_STAMP)  ## kill every writer at each of its writes; ARGS="--kills 30" for fewer
	$(BIN)/python tests/soak/crash.py $(ARGS)

fuzz: $(DEV_STAMP)  ## read changed files for ten minutes; ARGS="--seconds 3600 --seed 2" for others
	$(BIN)/python tests/soak/fuzz.py --seconds 600 $(ARGS)

soak: $(DEV_STAMP)  ## random houses and policies, on stairs and for ten minutes; ARGS="--mode x64 --envs 8" for others
	$(BIN)/python tests/soak/stairs.py --steps 200000
	$(BIN)/python tests/soak/invariants.py --seconds 600 $(ARGS)

memory: $(DEV_STAMP)  ## whether memory grows in ten minutes of stepping; ARGS="--envs 512" for others
	$(BIN)/python tests/soak/memory.py --seconds 600 $(ARGS)

garbage: $(DEV_STAMP)  ## odd numbers in all arrays of rays and physics; ARGS="--backend cuda --scenes 10000"
	$(BIN)/python tests/soak/garbage.py --seconds 300 $(ARGS)

checkers: $(DEV_STAMP)  ## each ecosystem's own checker for every id; writes the table of docs/adapters.md
	$(BIN)/python scripts/check_adapters.py --docs $(ARGS)

lint: $(DEV_STAMP)  ## ruff, check and format
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(DEV_STAMP)  ## pyright
	$(BIN)/pyright

# Not --quiet: it would hide warnings from --strict as well.
docs: $(DEV_STAMP)  ## build the documentation into site/, warnings are errors
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict
	$(BIN)/home-mjx play AudioNav --dataset "procedural:1?seed=40" --episodes 1 --html --out site/demo

bench: $(DEV_STAMP)  ## measure; one JSON object a line into benchmarks/latest.jsonl
	$(BIN)/home-mjx bench all --json $(ARGS) | tee benchmarks/latest.jsonl

wheel: $(DEV_STAMP)  ## build the wheel, install it alone and try it from another folder
	scripts/check_wheel.sh $(BIN)/python

clean:  ## remove environments and everything generated
	rm -rf .venv .venv-* build dist site demo *.egg-info .pytest_cache .ruff_cache .hypothesis

$(USER_STAMP): $(SETUP)
	scripts/setup_venv.sh $(VENV) '.[train]'
	touch $@

$(DEV_STAMP): $(SETUP)
	scripts/setup_venv.sh $(VENV) '.[dev]'
	touch $@ $(USER_STAMP)
