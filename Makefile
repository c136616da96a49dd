# Needs Python 3.11 or later with pip, make and git. Each target sets up .venv by
# itself from a hashed lock (requirements/); a second call finds it done.

PYTHON ?= python3
OUT ?= out/study
WORKERS ?= 2
BIN := $(if $(filter Windows_NT,$(OS)),.venv/Scripts,.venv/bin)
UV := $(BIN)/python -m uv
COMPILE := $(UV) pip compile --quiet --universal --python-version 3.11 \
	--generate-hashes --no-annotate --no-emit-index-url --no-emit-find-links \
	--custom-compile-command "make lock"
BASE := pyproject.toml requirements/build.in
# Bytecode is kept, whatever the caller's habit: rewriting 5,000 asserts takes a worker
# half a minute.
PYTEST := PYTHONDONTWRITEBYTECODE= $(BIN)/python -m pytest
# A file stays in one worker: what its tests share is made once. Files keep the order
# that tests/conftest.py gives them, which xdist would change.
WORKERS_BY_FILE := -n $(WORKERS) --dist loadfile --no-loadscope-reorder
SEED ?=

export UV_PYTHON_DOWNLOADS = never

.PHONY: help study test test-all check bench page lock clean base dev bench-env

help:
	@echo "make study     run the experiment, write $(OUT)/report.html"
	@echo "make test      run the tests that are quick, in about 3 minutes"
	@echo "make test-all  run every test with branch coverage; SEED=1 shuffles them"
	@echo "make check     formatting, lint, types, import order, documentation"
	@echo "make bench     measure speed, beside two peers"
	@echo "make page      fetch the libraries of the page that costeer drive shows"
	@echo "make lock      pin every dependency anew"
	@echo "make clean     remove results, caches and .venv"

study: base
	$(BIN)/costeer study --out $(OUT)

test: dev
	$(PYTEST) $(WORKERS_BY_FILE)

# Coverage makes a long test several times as slow: it gets more time here.
test-all: dev
	$(PYTEST) $(WORKERS_BY_FILE) -m "not gpu and not browser" -o timeout=1800 \
		$(if $(SEED),--shuffle $(SEED)) --cov --cov-report= --cov-fail-under=0
	$(PYTEST) -m browser --cov --cov-append --cov-report=term:skip-covered

check: dev
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy --strict src
	$(BIN)/lint-imports --no-logo
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet --site-dir out/site

bench: bench-env
	$(BIN)/costeer bench

base dev:
	@$(PYTHON) requirements/install.py $@

bench-env:
	@$(PYTHON) requirements/install.py bench

page: base
	$(BIN)/python requirements/page.py

lock: dev
	$(COMPILE) requirements/installer.in -o requirements/installer.lock
	$(COMPILE) $(BASE) --extra jax --extra train --extra drive --extra can --extra lsl \
		--extra cluster --extra sensitivity --extra gym --extra fmu --extra dev -o requirements/dev.lock
	$(COMPILE) $(BASE) -c requirements/dev.lock -o requirements/base.lock
	$(COMPILE) $(BASE) -c requirements/dev.lock --extra bench -o requirements/bench.lock
	$(COMPILE) requirements/page.in -o requirements/page.lock
	@! grep -nE 'https?://' requirements/*.lock page/package-lock.json

clean:
	rm -rf .venv out site .coverage .coverage.* .hypothesis .mypy_cache .pytest_cache \
		.ruff_cache .import_linter_cache
	find src tests -name __pycache__ -type d -prune -exec rm -rf {} +
