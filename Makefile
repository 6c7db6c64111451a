# Two commands on a fresh machine with python3 (3.11 or newer) and make:
#   make golden   makes .venv of what solving needs (requirements.lock), then data/golden/paris
#   make test     adds what tests need (requirements-test.lock), then runs lint, types and tests
#   make quick    runs the tests of every day, in about a minute
#   make atlas    makes every dataset that ships and is missing, and a page over all
# And `make peers` runs the tests of the methods that want a Fortran compiler, JAX or the GPL, in an environment of its own.
PYTHON ?= python3
BIN := .venv/bin
INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile
# A lock names every package: --no-deps, so that pip looks for no newer one
LOCKED := $(INSTALL) --no-deps --require-hashes -r
PYTEST := $(BIN)/python -m pytest -q -n 2 --dist loadfile --no-loadscope-reorder
packages = $$(sed -n '/win32/d; s/==.*//p' $(1) | sort -u | wc -l)

.PHONY: golden test pytest quick atlas docs peers campaign coverage mutants studies lint lock locale clean

golden: .venv/solving
	@echo "Proving 24 h of the pendulum in Paris, and confirming the proof by a second run: one to three minutes"
	$(BIN)/foucault generate paris
	@echo "Checking what was written"
	$(BIN)/foucault verify paris

# Each worker takes whole files: what a file prepares is prepared once.
test: .venv/testing
	@$(MAKE) --no-print-directory --jobs=2 lint pytest

pytest: .venv/testing
	@echo "Running the tests: four to nine minutes on two cores"
	$(PYTEST)

# For every day, about 100 CPU seconds: model, closed forms, solver with proofs, score; not what takes longest and is
# seldom touched
SELDOM := $(patsubst %,tests/reference/solver/test_%.py,confirming extreme_scenes pushed_releases ranges \
  sampled_confirmation sections sensitivity) \
  $(patsubst %,tests/compare/score/test_%.py,baseline passages)
quick: .venv/testing
	@echo "Running the tests of every day: about a minute on two quiet cores"
	$(PYTEST) tests/reference/numbers tests/reference/model tests/reference/solver tests/compare/score $(addprefix --ignore=,$(SELDOM))

# Every dataset that ships and is missing, then the pages, of which atlas/index.html is the first; what was stopped goes on where it was
atlas: .venv/testing
	@echo "Making the golden datasets that are missing: minutes to hours on both cores"
	$(BIN)/foucault generate --all
	$(BIN)/foucault atlas --out atlas

# The cases that `make test` skips "under --long", and tests by the thousand (damaged files, faults, fuzzed inputs,
# kills) of which it runs a short form.
campaign: .venv/testing
	$(PYTEST) --long -m campaign

# The same tests, nearly twice as long: which lines and branches does none of them run?
coverage: .venv/testing
	$(PYTEST) --cov --cov-report=term-missing:skip-covered --cov-fail-under=95

# The methods that `make test` skips: numbalsoda, diffrax, rebound and native Boost, which requirements-peers.lock brings;
# GSL and SUNDIALS in C where the system has their headers. No skip counts as a pass for what the lock brings.
peers: .venv-peers/ready
	@echo "Running the tests of all methods: some minutes"
	$(subst .venv,.venv-peers,$(PYTEST)) --peers tests/compare/methods

# All pages and the public docstrings as a site, build/docs/index.html; a broken link is an error
docs: .venv/testing
	$(BIN)/python -m sphinx --quiet --fail-on-warning --keep-going -c docs . build/docs

# Do the tests notice a wrong source? Other draws: tests/mutants.py --seed 2, --module precision
mutants: .venv/testing
	@echo "Changing the source in 60 places, one at a time, and running its tests"
	$(BIN)/python tests/mutants.py

# docs/studies.md again, from new runs of every method, so in the environment of `peers`; what was stopped goes on
studies: .venv-peers/ready
	@echo "Measuring what docs/studies.md says: most of an hour, best on an idle machine"
	.venv-peers/bin/python tests/bench/studies.py

lint: .venv/testing
	@echo "Checking style and types"
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

# Python 3.11 and 3.12 read the paths in .venv in the encoding of the locale. One that lacks a letter of this folder's
# path, as C lacks ä, would end every Python of .venv as it starts; a locale that is not installed counts as C.
READABLE := import locale, os, sys; \
  encoding = "utf-8" if sys.version_info >= (3, 13) else locale.nl_langinfo(locale.CODESET); \
  path = os.fsencode(os.getcwd()).decode(encoding, "replace"); \
  advice = "This locale cannot encode the path of this folder. Run: export LC_ALL=C.UTF-8, then make again."; \
  sys.exit(advice if "\ufffd" in path else 0)
locale:
	@$(PYTHON) -c '$(READABLE)'

.venv/solving: requirements.lock pyproject.toml | locale
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "foucault needs Python 3.11 or newer; $(PYTHON) is older. Try: make PYTHON=python3.12 golden" >&2; exit 2; }
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null || \
	  { echo "$(PYTHON) has no venv module. On Debian and Ubuntu: apt install python3-venv" >&2; exit 2; }
	@echo "Creating .venv"
	@$(PYTHON) -m venv --clear .venv
	@echo "Downloading and installing $(call packages,requirements.lock) packages into .venv"
	@$(LOCKED) requirements.lock
	@echo "Installing foucault itself into .venv"
	@$(INSTALL) --no-build-isolation --no-deps -e .
	@touch $@

.venv/testing: .venv/solving requirements-test.lock
	@echo "Bringing .venv to the $(call packages,requirements-test.lock) packages that tests need"
	@$(LOCKED) requirements-test.lock
	@touch $@

.venv-peers/ready: requirements-peers.lock pyproject.toml | locale
	@command -v gfortran >/dev/null && command -v cmake >/dev/null && command -v g++ >/dev/null \
	  || { echo "numbalsoda and the native methods are compiled." \
	  "On Debian and Ubuntu: apt install gfortran g++ cmake libgsl-dev libsundials-dev" >&2; exit 2; }
	@echo "Downloading and installing $(call packages,requirements-peers.lock) packages into .venv-peers"
	@$(PYTHON) -m venv --clear .venv-peers
	@$(subst .venv,.venv-peers,$(LOCKED)) requirements-peers.lock
	@$(subst .venv,.venv-peers,$(INSTALL)) --no-build-isolation --no-deps -e .
	@touch $@

# For maintainers: pin again (needs uv). Each lock contains the one before.
PIN := uv pip compile pyproject.toml --universal --python-version 3.11 --generate-hashes \
  --no-emit-index-url --no-header --no-annotate -q --extra fast --extra enclose --extra build
lock:
	$(PIN) -o requirements.lock
	$(PIN) -c requirements.lock --extra methods --extra plot --extra test --extra docs -o requirements-test.lock
	$(PIN) -c requirements-test.lock --extra methods --extra plot --extra test --extra docs \
	  --extra methods-fortran --extra methods-gpl --extra methods-jax --extra methods-native -o requirements-peers.lock

clean:
	rm -rf .venv .venv-peers build dist .coverage .coverage.* .mypy_cache .pytest_cache .ruff_cache .hypothesis
