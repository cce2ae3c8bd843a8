# Every target installs first when needed: a fresh clone needs only Python >= 3.11, make and git.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
PEERS := $(VENV)/.peers
WORKERS ?= 2
PORT ?= 8000
# One thread per worker: parallel work is by processes, and scores must not depend on the machine's cores.
export OMP_NUM_THREADS = 1
export OPENBLAS_NUM_THREADS = 1
export MKL_NUM_THREADS = 1
export NUMBA_NUM_THREADS = 1

.DEFAULT_GOAL := help
.PHONY: help install serve test lint bench leaderboard docs lock clean

help: ## show this list
	@grep -hE '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:[^#]*## /\t/' | expand -t 14

install: $(STAMP) ## set up .venv from the pinned, hashed lock file

$(STAMP): requirements.lock pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "Python >= 3.11 is needed; $(PYTHON) is $$($(PYTHON) --version). Set PYTHON=/path/to/python3.11." >&2; exit 1; }
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	touch $@

serve: $(STAMP) ## serve the page and the API on http://127.0.0.1:8000
	$(BIN)/sunatlas serve --port $(PORT) --times

test: $(STAMP) ## run the tests
	$(BIN)/python -m pytest -n $(WORKERS)

lint: $(STAMP) ## ruff, mypy (strict), the floors
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

$(PEERS): $(STAMP) requirements-peers.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements-peers.lock
	touch $@

bench: $(PEERS) ## speed and accuracy beside peers, as ratios measured in the same run
	$(BIN)/python -m tests.speed.simulator
	$(BIN)/python -m tests.speed.extractors
	$(BIN)/python -m tests.speed.service

leaderboard: $(STAMP) ## bring scores and leaderboard up to date with code and data
	$(BIN)/sunatlas leaderboard update --workers $(WORKERS)

docs: $(STAMP) ## regenerate the generated parts of docs/
	$(BIN)/python -m api.docs.documentation

lock: $(STAMP) ## renew both lock files from pyproject.toml (needs uv on the PATH)
	uv pip compile --universal --python-version 3.11 --extra dev --generate-hashes \
		--no-emit-index-url --no-header -o requirements.lock pyproject.toml
	uv pip compile --universal --python-version 3.11 --extra peers --constraints requirements.lock \
		--generate-hashes --no-emit-index-url --no-header -o requirements-peers.lock pyproject.toml

clean: ## remove the virtual environment and caches
	rm -rf $(VENV) .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
