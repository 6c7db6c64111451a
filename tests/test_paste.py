"""docs/paste.md: what its lines print is read as it was, and the rows of its spreadsheet agree with Paris."""

from __future__ import annotations

import math
import shutil
import subprocess

import numpy as np
import pytest
from pages import of_language

from compare import judge
from compare.candidates.read import read

PAGE = "docs/paste.md"
ROWS = 61
STEP = 0.05  # s
EAST, NORTH = 0.3, 0.4  # m

# what the lines of each block take for granted, and how the block is used
MOTION = """
const at = (time) => ({ x: 0.3 * Math.cos(time), y: 0.4 * Math.cos(time) });
"""
CONSOLE = (
    MOTION
    + """
const pendulum = {
  t: 57, // the last rows of a minute
  get x() { return at(this.t).x; },
  get y() { return at(this.t).y; },
  step(seconds) { this.t += seconds; },
};
"""
)
P5 = (
    MOTION
    + """
let frameCount = 0;
let moved = 0;
const bob = {
  get x() { return 400 * at(moved).x; },
  get y() { return -400 * at(moved).y; }, // down the screen
};
const moveBob = (seconds) => { moved += seconds; };
const saveStrings = (lines) => console.log(lines.join("\\n"));
%s
while (frameCount < 600) { frameCount += 1; draw(); }
"""
)
THREE = (
    MOTION
    + """
let moved = 0;
const bob = { get position() { const { x, y } = at(moved); return { x, y: -9, z: -y }; } };
const moveBob = (seconds) => { moved += seconds; };
%s
for (let i = 0; i < 61; i += 1) animate(0.05);
console.log(rows.join("\\n"));
"""
)


def block(language, number=0):
    return of_language(PAGE, language)[number]


def printed(script):
    done = subprocess.run(["node", "-e", script], capture_output=True, text=True, check=True)
    return done.stdout


def check(text, path, z=None):
    """Check that rows are read as the motion that was printed, to the last bit."""
    path.write_text(text)
    rows = read(path)
    assert len(rows.t) >= ROWS
    assert rows.columns["x"] == pytest.approx(EAST * np.cos(rows.t), rel=1e-15, abs=1e-16)
    assert rows.columns["y"] == pytest.approx(NORTH * np.cos(rows.t), rel=1e-15, abs=1e-16)
    if z is not None:
        assert (rows.columns["z"] == z).all()


node = pytest.mark.skipif(shutil.which("node") is None, reason="Node.js is not installed")


@node
def test_the_lines_for_a_console(tmp_path):
    check(printed(CONSOLE + block("javascript", 0)), tmp_path / "rows.csv")


@node
def test_the_lines_for_p5(tmp_path):
    check(printed(P5 % block("javascript", 1)), tmp_path / "rows.csv")


@node
def test_the_lines_for_three(tmp_path):
    check(printed(THREE % block("javascript", 2)), tmp_path / "rows.csv", z=-9)


def test_the_lines_for_a_notebook(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    t = STEP * np.arange(ROWS)
    exec(block("python"), {"t": t, "x": EAST * np.cos(t), "y": NORTH * np.cos(t)})
    check((tmp_path / "pendulum.csv").read_text(), tmp_path / "rows.csv")


@pytest.mark.skipif(shutil.which("octave") is None, reason="Octave is not installed")
def test_the_lines_for_octave(tmp_path):
    given = f"t = {STEP} * (0:{ROWS - 1}); x = {EAST} * cos(t); y = {NORTH} * cos(t);\n"
    command = ["octave", "--no-gui", "--quiet", "--eval", given + block("octave")]
    subprocess.run(command, cwd=tmp_path, check=True)
    check((tmp_path / "pendulum.csv").read_text(), tmp_path / "rows.csv")


def test_the_cells_of_a_spreadsheet_are_rows_of_paris(tmp_path):
    path = tmp_path / "rows.csv"
    path.write_text(block("text"))
    score = judge(path, "paris", explain=False, tolerance=1e-12)
    assert score.verdict == "agrees" and math.isclose(read(path).t[-1], 2)
