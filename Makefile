# Every target installs first what it needs: a fresh clone needs only Python >= 3.11, make and git.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# What is installed already: what serving and every command need, the rest of development; what is
# compiled.
SERVING := $(VENV)/.serving
DEVELOPING := $(VENV)/.developing
COMPILED := $(VENV)/.compiled
WORKERS ?= 2
PORT ?= 8000
# Bytecode is left to the first import of a module: most of it would never be read.
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile
# Each worker keeps to one half of the suite and takes from the other only when its own is done: what
# tests share (services, records, simulated light) is then made in one process and not in all.
TEST := $(BIN)/python -m pytest -n $(WORKERS) --dist worksteal
# One thread per worker: parallel work is by processes, and scores must not depend on the machine's cores.
export OMP_NUM_THREADS = 1
export OPENBLAS_NUM_THREADS = 1
export MKL_NUM_THREADS = 1
export NUMBA_NUM_THREADS = 1
# Some containers forbid bytecode. Each process would then compile what it imports, as pip left
# that to the first import: seconds for each worker, and for each process that tests start.
unexport PYTHONDONTWRITEBYTECODE

.DEFAULT_GOAL := help
.PHONY: help install serve guide test test-browser test-slow test-all coverage lint bench load mutants sizes leaderboard docs lock clean

help: ## show this list
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:[^#]*## /\t/' | expand -t 14

install: $(COMPILED) ## set up .venv with everything that development needs, pinned and hashed

$(SERVING): requirements.lock pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "Python >= 3.11 is needed; $(PYTHON) is $$($(PYTHON) --version). Set PYTHON=/path/to/python3.11." >&2; exit 1; }
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(PIP) --require-hashes -r requirements.lock
	$(PIP) --no-deps --no-build-isolation -e .
	touch $@

$(DEVELOPING): $(SERVING) requirements-dev.lock
	$(PIP) --require-hashes -r requirements.lock -r requirements-dev.lock
	touch $@

# Numerical kernels, compiled once and kept: else every first call would wait for its own.
$(COMPILED): $(DEVELOPING)
	$(BIN)/sunatlas compile --workers $(WORKERS) --quiet
	touch $@

# The guide, kept in the user's cache; quick where its pages have not changed.
guide: $(SERVING) ## build the guide (served at /guide; `make serve` builds it first)
	$(BIN)/sunatlas guide build --strict

serve: $(SERVING) ## serve page, guide and API on http://127.0.0.1:8000 (installs only what that needs)
	$(BIN)/sunatlas guide build --quiet
	$(BIN)/sunatlas serve --port $(PORT)

test: $(COMPILED) ## run the tests, the slow ones left out
	$(TEST) -m "not slow"

test-browser: $(COMPILED) ## run what walks the page in headless Chromium, slow tests too
	$(TEST) tests/api/browser

test-slow: $(COMPILED) ## run the slow tests alone
	$(TEST) -m slow

test-all: $(COMPILED) ## run every test
	$(TEST)

coverage: $(COMPILED) ## run every test and tell which lines and branches of the floors it reached
	$(TEST) --cov --cov-report=term:skip-covered --cov-report=html:out/coverage

lint: $(DEVELOPING) ## ruff, mypy (strict), the floors, prose, the guide without warnings
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python -m tools.prose
	$(BIN)/sunatlas guide build --strict --out out/guide

ASV := $(BIN)/asv
ASVCONF := --config tools/asv.conf.json
bench: $(COMPILED) ## speed and accuracy beside other code, by asv (BENCH=regex; SEED=N draws other frames)
	$(ASV) machine $(ASVCONF) --yes
	$(ASV) run $(ASVCONF) --environment existing:same --show-stderr \
		--set-commit-hash $$(git rev-parse HEAD) $(if $(BENCH),--bench "$(BENCH)")

URL ?= http://127.0.0.1:$(PORT)
load: ## 200 users for a minute on the service at URL, by Locust (`pip install locust` first)
	locust -f tools/locustfile.py --headless -H $(URL) -u 200 -r 50 -t 60s --only-summary

# In place: nothing may be changed meanwhile. `git diff` shows a mutant that a hard kill left.
mutants: $(COMPILED) ## try NUMBER=100 small faults in the code, by Cosmic Ray; list those that no test notices
	git diff --quiet
	mkdir -p out
	COVERAGE_FILE=$(CURDIR)/out/reached.coverage $(TEST) -q -m "not slow" --cov --cov-context=test --cov-report=
	$(BIN)/python -m tools.mutants draw out/mutants --number $(or $(NUMBER),100) $(if $(SEED),--seed $(SEED))
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/cosmic-ray exec out/mutants/cosmic-ray.toml out/mutants/session.sqlite
	$(BIN)/cr-report --surviving-only --show-diff out/mutants/session.sqlite
	@echo "surviving, %: $$($(BIN)/cr-rate out/mutants/session.sqlite)"

sizes: ## lines of Python and of code, by part
	@$(PYTHON) -m tools.sizes

leaderboard: $(SERVING) ## bring scores and leaderboard up to date with code and data
	$(BIN)/sunatlas leaderboard update --workers $(WORKERS)
	$(BIN)/python -m benchmark.experiments --workers $(WORKERS)
	$(BIN)/python -m api.previews

docs: $(DEVELOPING) ## renew the README's numbers and what blocks of docs/ print
	$(BIN)/python -m api.docs.documentation

# `make lock UPGRADE=--upgrade` takes the newest versions; without it, pins that still fit stay.
COMPILE := uv pip compile --quiet --python-version 3.11 --no-header --no-strip-extras pyproject.toml
LOCK := $(COMPILE) --generate-hashes --no-emit-index-url --no-annotate $(UPGRADE)
EXTRAS := --extra cluster --extra deposit --extra guide --extra serve
lock: ## renew the lock files from pyproject.toml (needs uv on the PATH)
	$(LOCK) --universal --group build --extra guide --extra serve -o requirements.lock
	$(LOCK) --universal --group dev $(EXTRAS) --constraints requirements.lock -o requirements-dev.lock
	$(PYTHON) -m tools.lock_beyond requirements.lock requirements-dev.lock
	mkdir -p out
	$(COMPILE) --upgrade --resolution lowest-direct --group build --extra guide --extra serve -o out/lowest.txt
	$(LOCK) --group checked $(EXTRAS) --constraints out/lowest.txt -o requirements-lowest.lock

clean: ## remove the virtual environment and caches
	rm -rf $(VENV) .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache .coverage out/coverage
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
