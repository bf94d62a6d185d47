# Everything by one word; each target sets up what it needs, in .venv, by itself.
#
#   make demo     the main job: a skin, a cut cable, the recovery
#   make test     the tests in small sizes (6 to 8 minutes)      make full    all of them (long)
#   make lint     style, types, import walls             make bench   how fast it is
#   make papers   the published figures, redrawn         make parity  the same code on boards' Python
#   make mutants  faults planted all over, and how many the tests find (long)
#   make docs     the documentation as a site, in site/     make dist     wheel and source archive, in dist/ (minutes; LOOPS=no: at once)
#   make boards   the folder to copy to a board          make page    build the page of `watch` (npm)
#   make env      only the environment, .venv         make clean    remove what these made

SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := help

BIN := .venv/bin
# The environment is made again when pyproject.toml says something else, and only then. Its Python is
# the first that is found, or another that is clearly faster: one that was built without profiles, as
# pyenv does, takes 30 % longer for the same tests (docs/decisions/0077). Its packages are
# translated by all processors together, which pip would do by one; what is no Python of today
# (templates of packages) stays as it is.
STAMP := .venv/stamp-$(shell cksum < pyproject.toml | cut -d ' ' -f 1)
WORKERS ?= 2

# A Python that is new enough says how long it takes for some lines, and where it is.
define TIMED
import sys, time, timeit, venv, ensurepip
if sys.version_info >= (3, 11):
    lines = "for number in range(50000): counts[number % 99] = str(number)"
    took = timeit.repeat(lines, "counts = {}", time.process_time, 15, 1)
    print(min(took), sys._base_executable)
endef
export TIMED

# Tests start hundreds of processes: to translate the sources anew takes up to a second in each.
unexport PYTHONDONTWRITEBYTECODE

# Two workers more than there are processors: tests that wait leave theirs to others. What many
# tests run is compiled before they start, where it is not compiled yet.
PYTEST = $(BIN)/python -m pytest --forks $$(( $(WORKERS) + 2 )) --loops $(WORKERS)

# Packages that the page is built with, as package-lock.json has them; no scripts of theirs are run.
PAGE := src/innervate/web/page
MODULES := $(PAGE)/node_modules/.package-lock.json

.PHONY: help env demo test full mutants lint bench papers boards parity docs dist wheel-check page page-check clean

help:
	@sed -n '2,/^$$/s/^# \{0,1\}//p' Makefile

$(STAMP):
	@rm -f .venv/stamp-*
	@candidates="$(or $(PYTHON),python3 python python3.14 python3.13 python3.12 python3.11)"; \
	python=$$(type -ap $$candidates | \
	  while read -r found; do "$$found" -c "$$TIMED" 2>/dev/null </dev/null || true; done | \
	  awk 'NR == 1 || $$1 < 0.85 * least { least = $$1; sub(/^[^ ]* /, ""); python = $$0 } \
	    END { print python }') || true; \
	if command -v uv >/dev/null; then \
	  echo "Setting up .venv with uv (once) ..."; \
	  uv venv --quiet --allow-existing --python "$${python:->=3.11}" .venv; \
	  uv pip install --quiet --python $(BIN)/python -e '.[all,dev]'; \
	else \
	  if [ -z "$$python" ]; then \
	    echo "innervate needs Python 3.11 or newer with its venv module (Debian, Ubuntu: apt install python3-venv);" \
	      "tried: $$candidates (choose with: make PYTHON=...)" >&2; exit 1; fi; \
	  echo "Setting up .venv with $$python and pip (once, a minute or two) ..."; \
	  "$$python" -m venv .venv; \
	  $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile -e '.[all,dev]'; \
	  $(BIN)/python -m compileall -qq -j 0 .venv/lib/python*/site-packages || true; \
	fi
	@touch $@

env: $(STAMP)

demo: $(STAMP)
	@$(BIN)/innervate demo

test: $(STAMP)
	$(PYTEST) -m "not slow" --junitxml=.mutants/suite.xml

full: $(STAMP)
	$(PYTEST) --junitxml=.mutants/suite.xml
	$(BIN)/python -m tests.mutants --workers $(WORKERS) --seed $$(date +%Y%m%d) --count 40 --least 0.7

# FAULTS="--room wire --seed 2": what tests/mutants/__main__.py takes.
mutants: $(STAMP)
	$(BIN)/python -m tests.mutants --workers $(WORKERS) $(FAULTS)

lint: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: $(STAMP)
	@$(BIN)/python -m benchmarks

papers: $(STAMP)
	@$(BIN)/innervate papers

boards: $(STAMP)
	@$(BIN)/python -m boards

parity: $(STAMP)
	@$(BIN)/python -m boards.parity

docs: $(STAMP)
	@NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict
	@echo "Written: site/. To read it with its search: $(BIN)/python -m http.server -d site"

# Without a network: what builds the wheel is in .venv already. The wheel has loops, and by cc live
# nodes, for this system and processor, compiled in some minutes; LOOPS=no leaves both out, and it
# is for any. ADDRESS is where the project lies on the web, as https://HOST/OWNER/NAME; without it
# nothing links there.
LOOPS = yes
dist: export INNERVATE_ADDRESS = $(ADDRESS)
dist: docs
	@$(BIN)/python -m build --no-isolation --sdist
ifeq ($(LOOPS),no)
	@$(BIN)/python -m build --no-isolation --wheel
else
	@$(BIN)/python -m innervate.kernel.readying build/loops
	@$(BIN)/python -m innervate.firmware.readying build/nodes
	@INNERVATE_LOOPS=build/loops INNERVATE_NODES=build/nodes $(BIN)/python -m build --no-isolation --wheel
endif

# Source archive and wheel, built, installed in environments of their own and tried there.
wheel-check: $(STAMP)
	@$(BIN)/python -m pytest -q tests/test_wheel.py -k "not all"

$(MODULES): $(PAGE)/package-lock.json
	@command -v npm >/dev/null || { echo "npm is missing (Debian, Ubuntu: apt install npm)" >&2; exit 1; }
	npm ci --prefix $(PAGE) --ignore-scripts --no-audit --no-fund --loglevel=error
	@touch $@

page: $(MODULES)
	@node $(PAGE)/build.mjs

page-check: $(MODULES)
	@built=$$(mktemp -d); trap 'rm -rf "$$built"' EXIT; node $(PAGE)/build.mjs "$$built"; \
	diff -rq "$$built" src/innervate/web/static || \
	  { echo "the bundle is not what its sources make: run \`make page\`" >&2; exit 1; }

clean:
	rm -rf $(PAGE)/node_modules
	rm -rf .venv .mutants build dist site .hypothesis .import_linter_cache .mypy_cache .pytest_cache .ruff_cache
	find src tests benchmarks boards examples -name __pycache__ -type d -prune -exec rm -rf {} +
