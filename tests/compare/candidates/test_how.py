"""The three lines of each language, run where the language is here: what they write is read, to the last bit."""

from __future__ import annotations

import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from compare.candidates.how import SNIPPETS, how
from compare.candidates.read import read
from compare.score.judge import judge
from reference import InputError, load

# a program around the lines: its file, its text, and how a row is written in it
PROGRAMS = {
    "c": (
        "program.c",
        "#include <stdio.h>\nint main(void) {{ double r[][3] = {{{rows}}}; {once}\nfor (int k = 0; k < {n}; k++) "
        "{{ double t = r[k][0], x = r[k][1], y = r[k][2];\n{each}\n}} }}\n",
        "{{{}, {}, {}}}",
    ),
    "c++": (
        "program.cc",
        "#include <iostream>\n#include <iomanip>\nint main() {{ double r[][3] = {{{rows}}};\n{once}\n"
        "for (auto &a : r) {{ double t = a[0], x = a[1], y = a[2];\n{each}\n}} }}\n",
        "{{{}, {}, {}}}",
    ),
    "fortran": (
        "program.f90",
        "program p\ndouble precision :: r(3,{n}), t, x, y\ninteger :: k\nr = reshape([{rows}], [3, {n}])\n{once}\n"
        "do k = 1, {n}\nt = r(1,k); x = r(2,k); y = r(3,k)\n{each}\nend do\nend program\n",
        "{}, {}, {}",
    ),
    "go": (
        "program.go",
        'package main\nimport "fmt"\nfunc main() {{ r := [][3]float64{{{rows}}}\n{once}\nfor _, a := range r '
        "{{ t, x, y := a[0], a[1], a[2]\n{each}\n}} }}\n",
        "{{{}, {}, {}}}",
    ),
    "java": (
        "Program.java",
        "class Program {{ public static void main(String[] a) {{ double[][] r = {{{rows}}};\n{once}\n"
        "for (double[] b : r) {{ double t = b[0], x = b[1], y = b[2];\n{each}\n}} }} }}\n",
        "{{{}, {}, {}}}",
    ),
    "javascript": (
        "program.js",
        "{once}\nfor (const [t, x, y] of [{rows}]) {{\n{each}\n}}\n",
        "[{}, {}, {}]",
    ),
    "julia": ("program.jl", "{once}\nfor (t, x, y) in [{rows}]\n{each}\nend\n", "({}, {}, {})"),
    "octave": (
        "program.m",
        "{once}\nfor r = [{rows}]'\nt = r(1); x = r(2); y = r(3);\n{each}\nend\n",
        "{}, {}, {};",
    ),
    "matlab": (
        "program.m",
        "{once}\nfor r = [{rows}]'\nt = r(1); x = r(2); y = r(3);\n{each}\nend\n{shell}\n",
        "{}, {}, {};",
    ),
    "python": ("program.py", "{once}\nfor t, x, y in [{rows}]:\n    {each}\n", "({}, {}, {})"),
    "numpy": (
        "program.py",
        "import numpy as np\nt, x, y = np.array([{rows}]).T\n{once}\n{each}\n",
        "({}, {}, {})",
    ),
    "r": (
        "program.R",
        "{once}\nfor (a in list({rows})) {{ t <- a[1]; x <- a[2]; y <- a[3]\n{each}\n}}\n",
        "c({}, {}, {})",
    ),
    "rust": (
        "program.rs",
        "fn main() {{ let r: [[f64; 3]; {n}] = [{rows}];\n{once}\nfor [t, x, y] in r {{\n{each}\n}} }}\n",
        "[{}, {}, {}]",
    ),
}
PYTHON = shlex.quote(sys.executable)
COMPILE = {
    "c": "cc program.c -o program",
    "c++": "c++ program.cc -o program",
    "fortran": "gfortran -ffree-line-length-none program.f90 -o program",
    "go": "go build -o program program.go",
    "java": "javac Program.java",
    "rust": "rustc program.rs",
}
RUN = {
    "matlab": "octave program.m",
    "octave": "octave program.m",
    "python": f"{PYTHON} program.py",
    "numpy": f"{PYTHON} program.py",
    "java": "java -cp . Program",
}
NEEDS = {
    "c": "cc", "c++": "c++", "fortran": "gfortran", "go": "go", "java": "javac", "javascript": "node", "julia": "julia",
    "octave": "octave", "matlab": "octave", "r": "Rscript", "rust": "rustc",
}  # fmt: skip
ALWAYS = ("c", "javascript", "numpy", "python")  # the others take seconds to compile: under --long


def double_precision(number):
    """Return a number as a literal of Fortran's double precision."""
    text = repr(number)
    return text.replace("e", "d") if "e" in text else f"{text}d0"


CASES = [one if one in ALWAYS else pytest.param(one, marks=pytest.mark.long) for one in SNIPPETS]


@pytest.mark.parametrize("language", CASES)
def test_the_lines_of_a_language_write_what_is_read_back(language, tmp_path, monkeypatch):
    tool = NEEDS.get(language)
    if tool is not None and shutil.which(tool) is None:
        pytest.skip(f"{tool} is not installed")
    golden = load("paris.binary64")
    rows = [
        (0.0, 0.3, 0.4),
        (60.0, float(golden.x[1]), float(golden.y[1])),
        (86400 - 1 / 3, 1e-5 / 3, -1e-300),
    ]
    file, frame, row = PROGRAMS[language]
    literal = double_precision if language == "fortran" else repr
    texts = [row.format(*map(literal, numbers)) for numbers in rows]
    snippet = SNIPPETS[language]
    program = frame.format(
        once=snippet.once,
        each=snippet.each,
        shell=snippet.shell,
        n=len(rows),
        rows=", ".join(texts).replace(";,", ";"),
    )
    (tmp_path / file).write_text(program)
    monkeypatch.chdir(tmp_path)
    if language in COMPILE:
        subprocess.run(shlex.split(COMPILE[language]), check=True, capture_output=True)
    command, *_ = snippet.shell.partition(" > ")
    done = subprocess.run(
        shlex.split(RUN.get(language, command)), check=True, capture_output=True, text=True
    )
    path = Path("mine.csv")
    if not path.exists():
        path.write_text(done.stdout)
    found = read(path)
    columns = zip(
        found.t.tolist(), found.columns["x"].tolist(), found.columns["y"].tolist(), strict=True
    )
    if language == "numpy":  # savetxt prints 19 digits of its own accord
        assert path.read_text().startswith("# t,x,y\n")
    assert [*columns] == rows
    assert found.conventions == ()
    path.write_text("".join(path.read_text().splitlines(keepends=True)[:3]))
    assert judge(path, "paris", tolerance=1e-12, explain=False).agrees


def test_every_language_is_three_lines_and_can_be_run_here_or_elsewhere():
    assert set(SNIPPETS) == set(PROGRAMS)
    for language in SNIPPETS:
        lines, _, about = how(language).partition("\n\n")
        assert len(lines.splitlines()) == 3
        assert max(map(len, lines.splitlines())) < 120
        assert "x east and y north" in about
    assert how("JS") == how("javascript") and how("cpp") == how("c++")


def test_another_language_is_answered_with_those_that_are_known(foucault):
    status, out, _ = foucault("score", "--how", "rust")
    assert (status, out.splitlines()[0].split("  ")[0]) == (0, 'println!("t,x,y");')
    with pytest.raises(InputError, match="expected c, c\\+\\+, fortran"):
        how("cobol")
