"""Programs of --run in a study: short names for rows, tables and charts; the command stands on the page once."""

from __future__ import annotations

import json
import re
import shlex
import sys

import pytest
from here import measured_here

from compare.methods import named_programs

PROGRAM = """
import math, sys
step, end, grid, length, g = map(float, sys.argv[1:6])
omega = math.sqrt(g / length)
print("t,x,y")
for k in range(round(end / grid) + 1):
    swing = math.cos(omega * k * grid)
    print(k * grid, 0.3 * swing, 0.4 * swing, sep=",")
"""


@pytest.mark.parametrize(
    ("command", "name"),
    [
        ("/tmp/pendulum {x0} {y0} 0.01", "pendulum"),
        ("./rk4 {setting} data.txt", "rk4"),
        ("python3 -O 'my programs/mine.py' {setting}", "mine.py"),
        ("node leap.js {x0}", "leap.js"),
        ("julia --project=. Pendulum.jl", "Pendulum.jl"),
        ("./a_program_with_a_rather_long_name {x0}", "a_program_with_a_rather…"),
    ],
)
def test_a_program_is_called_as_its_file(command, name):
    renamed = command.replace("./rk4", "./rk4_of_mine")  # a method is called rk4
    assert named_programs([renamed]) == {name if renamed == command else "rk4_of_mine": renamed}


def test_names_go_with_commands_in_order():
    assert named_programs(["./p 1", "./p 2"], ["one", "zwei <2>"]) == {
        "one": "./p 1",
        "zwei <2>": "./p 2",
    }


def test_a_long_command_breaks_neither_table_nor_page(foucault, tmp_path, monkeypatch):
    pytest.importorskip("matplotlib")
    pytest.importorskip("numba")
    measured_here(monkeypatch)
    path = tmp_path / "harmonic.py"
    path.write_text(PROGRAM)
    program = shlex.join([sys.executable, str(path)])
    command = " ".join([program, "{setting} {t_end} {grid_step} {length} {gravity}", "x" * 3000])
    words = [
        "study",
        "paris",
        "--t-end",
        "60",
        "--methods",
        "rk4",
        "--settings",
        "0.1",
        "--out",
        tmp_path / "out",
    ]
    status, out, _ = foucault(
        *words, "--run", command, "--run", f"{command} y", "--name", "mine", "--name", "<other>"
    )
    assert status == 0
    lines = out.splitlines()
    begin = next(number for number, line in enumerate(lines) if "setting" in line)
    head = lines[begin]
    row = next(line for line in lines[begin:] if "mine" in line)
    other = next(line for line in lines[begin:] if "<oth" in line)
    # the last that a program has
    assert len(row) == len(other) == head.index("CPU") + len("CPU")
    document = json.loads((tmp_path / "out/study.json").read_text())
    assert document["programs"] == {"mine": command, "<other>": f"{command} y"}
    assert {row["method"]: row["status"] for row in document["rows"]} == {
        "rk4": "ok",
        "mine": "ok",
        "<other>": "ok",
    }
    # nobody knows in which variables a program integrates
    formulations = {row["method"]: row["formulation"] for row in document["rows"]}
    assert formulations == {"rk4": "plane", "mine": "", "<other>": ""}
    page = (tmp_path / "out/index.html").read_text()
    assert "x" * 500 not in page and "momentum" not in page.partition("Every row")[2]
    assert "<other>" not in page and "&lt;other&gt;" in page
    stored = (tmp_path / "out/rows.jsonl").read_text()
    changed = [*words[:-1], tmp_path / "out", "--run", f"{command} z", "--name", "mine"]
    assert foucault(*changed)[0] == 0
    (line,) = (tmp_path / "out/rows.jsonl").read_text().removeprefix(stored).splitlines()
    # another command of that name is measured again, and nothing else
    assert json.loads(line)["item"][0] == "mine"


def test_score_tells_the_step_that_it_chose_for_a_program(foucault, tmp_path):
    program = tmp_path / "late.py"
    program.write_text(
        'import sys\nprint("t,x,y", "0,0.3,0.4", f"60,{sys.argv[1]},0", sep="\\n")\n'
    )
    command = f"{shlex.join([sys.executable, str(program)])} {{setting}}"
    words = ("score", "paris", "--t-end", "60", "--repeats", "0", "--no-diagnosis", "--run")
    status, _, err = foucault(*words, command)
    step_s = float(re.search(r"\{setting\} is ([\d.]+) s", err)[1])
    assert status == 1
    assert 60 / step_s == pytest.approx(round(60 / step_s), rel=1e-5)
    assert "{setting}" not in foucault(*words, command, "--setting", "0.1")[2]
