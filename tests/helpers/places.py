"""Where things are in a checkout."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PENDULUM_C = ROOT / "tests/helpers/pendulum.c"
MISTAKEN_C = ROOT / "tests/helpers/mistaken.c"
