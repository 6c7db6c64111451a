# Two commands on a fresh machine with python3 (3.11 or newer) and make:
#   make golden   sets up .venv from requirements.lock and makes data/golden/paris
#   make test     sets up .venv and runs lint, types and tests
PYTHON ?= python3
BIN := .venv/bin

.PHONY: golden test campaign lint lock clean

golden: .venv/ready
	$(BIN)/foucault generate paris
	$(BIN)/foucault verify paris

test: lint
	$(BIN)/python -m pytest -q -n 2 --cov --cov-report=term-missing:skip-covered --cov-fail-under=95

# Tests by the thousand (damaged files, forgeries, fuzzed inputs, kills): `make test` runs a short form of each.
campaign: .venv/ready
	$(BIN)/python -m pytest -q tests/campaigns --long

lint: .venv/ready
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

.venv/ready: requirements.lock pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "foucault needs Python 3.11 or newer; $(PYTHON) is older. Try: make PYTHON=python3.12 golden" >&2; exit 2; }
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null || \
	  { echo "$(PYTHON) has no venv module. On Debian and Ubuntu: apt install python3-venv" >&2; exit 2; }
	$(PYTHON) -m venv --clear .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-build-isolation --no-deps -e .
	touch $@

# For maintainers: pin again (needs uv).
lock:
	uv pip compile pyproject.toml --universal --python-version 3.11 --extra enclose --extra methods --extra plot --extra test --extra build \
	  --generate-hashes --no-emit-index-url --no-header --no-annotate -q -o requirements.lock

clean:
	rm -rf .venv build dist .coverage .coverage.* .mypy_cache .pytest_cache .ruff_cache .hypothesis
