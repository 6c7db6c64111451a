"""The first mistakes that people make, on the command line and in Python: each message says what to do."""

from __future__ import annotations

import shlex
import zipfile

import numpy as np
import pandas as pd
import pytest

import compare
import reference
from reference import InputError

FILES = {
    "mine.csv": "t,x,y\n0,0.3,0.4\n60,-0.176326733,-0.415867688\n",
    "headless.csv": "0 1\n",
    "empty.csv": "",
    "text.csv": "t,x,y\n0,a,0.4\n",
    "nan.csv": "t,x,y\n0,0.3,0.4\n60,nan,0.4\n",
    "backwards.csv": "t,x,y\n60,0.3,0.4\n0,0.3,0.4\n",
    "typo.toml": '[pendulum]\nlenght = "12"\n[release]\nangle = 5\nazimuth = 0\n',
    "float.toml": '[pendulum]\nlength = 12.3\n[release]\nangle = "5"\nazimuth = "0"\n',
    "broken.toml": '[pendulum\nlength = "12"\n',
    "both.toml": '[release]\nx = "1"\nangle = "5"\nazimuth = "0"\n',
    "nothing.toml": 'pendulum = {length = "12"}\n',
    "numbers.toml": '[pendulum]\nlength = "12,3"\n[release]\nangle = "5°"\nazimuth = "0"\n[run]\nt_end = "20 min"\n',
    "width.toml": '[release]\nx = "1"\ny = "0"\n[uncertain]\nx = "0.001"\n',
    "before.csv": "t,x,y\n-10,0.3,0.4\n60,-0.17,-0.41\n",
    "scene.yaml": "pendulum:\n  length: 12\n",
    "units.toml": '[pendulum]\ndrag = "20 min"\n[site]\nlatitude = "51.48° N"\n[release]\nangle = "5"\nazimuth = "0"\n',
    "widths.toml": '[release]\nx = "1"\ny = "0"\n[uncertain]\nlength = "5 mm"\n"release.vz" = "1"\n',
    "open.toml": '[release]\nangle = "5\nazimuth = "0"\n',
    "curly.toml": '[release]\nangle = “5”\nazimuth = "0"\n',
    "bare.toml": "[pendulum]\ndrag = 20 min\n",
    "short.toml": '[pendulum]\nlength = "0.4"\n[release]\nx = "0.5"\ny = "0"\n',
}
LINE = {  # what is typed, and what the message has to say
    "scor paris mine.csv": "Did you mean 'score'?",
    "score mine.csv": "`foucault score SCENE mine.csv`",
    "score mine.csv paris": "`foucault score SCENE mine.csv`",
    "score pari mine.csv": "Did you mean paris?",
    "score paris mien.csv": "CANDIDATE: got 'mien.csv', expected a readable file",
    "score paris": "Say what to score.",
    "score paris headless.csv": "Columns are t, x, y",
    "score paris empty.csv": "Columns are t, x, y",
    "score paris text.csv": "text.csv: line 2: x: got 'a', expected a number",
    "score paris nan.csv": "correct it, or score only the rows before it",
    "score paris backwards.csv": "Sort the rows and drop repeated times.",
    "score paris book.xlsx": "Save the sheet as CSV.",
    "score paris folder": "expected a readable file",
    "score paris mine.csv --tolerance 1mm": "'--tolerance': expected a number, without a unit",
    "score paris mine.csv --tolerance -1": "expected a positive number of metres",
    "score paris mine.csv --set site.latitude": "SECTION.KEY=VALUE, such as site.latitude=0",
    "score paris mine.csv --set site.lattitude=40": "Did you mean site.latitude or",
    "score paris mine.csv --set site.g=9.81": "Did you mean site.gravity or site.gravity_is?",
    "score paris mine.csv --set lat=40": "Did you mean site.latitude?",
    "score paris mine.csv --set site.latitude=forty": "a decimal number such as 67",
    "score paris mine.csv --set site.latitude=100": "at least -90 and at most 90",
    "score paris mine.csv --t-end 0": "expected a number above 0",
    "score paris mine.csv --t-end 1h": "Write the number alone",
    "score paris --run ./mien": "a program that can be started",
    "score paris --run false": "expected exit status 0",
    "score paris --run 'echo {x}'": "To pass {x} itself, write {{x}}.",
    "score paris --run 'echo {lat}'": "Did you mean latitude or",
    "score mine.csv --section highest": "`foucault score SCENE mine.csv`",
    "score paris mine.csv --section highest": "`foucault score SCENE --transits FILE --section WORD`",
    "score paris before.csv": "leave out rows before it",
    "show scene.yaml": "`foucault show --template` prints one",
    "show paris --uncertain length=1mm": "half of a width in m, such as ±0.001",
    "sweep paris --over latitude=0:10:5 --engine gpu": "There are heyoka, octet.",
    "sweep paris --over latitude=0:10:5 --level sure": "There are computed, self_consistent, confirmed, enclosed.",
    "score --how basic": "expected c, c++, fortran",
    "score paris mine.csv --columns t,x": "a name for each of the 3 columns",
    "score paris mine.csv --units hours": "--t-end 86400 leaves out later rows",
    "score paris mine.csv --plot error.bmp": "a path that ends in .svg, .png or .pdf",
    "show typo.toml": "Did you mean pendulum.length?",
    "show float.toml": "pendulum.length: got '12.3', expected a decimal number in quotes. Write \"12.3\" as a string",
    "show numbers.toml": "Write a decimal point, not a comma.",
    "show numbers.toml --set length=12": "Write the number alone, in s: 1200 for 20 min.",
    "show units.toml": "Write the number alone, in 1/s: 2 ln 2/1200 = 0.0011552 for a swing that halves in 20 min.",
    "show units.toml --set drag=0.001": "Write the number alone, in degrees: 51.5 for 51° 30′; south is negative.",
    "show widths.toml": "Write the number alone, in m: 0.005 for 5 mm.",
    "show widths.toml --set title=two": "uncertain.release.vz: got 'release.vz', expected an input",
    "show open.toml": 'Line 2: `angle = "5`. A quotation mark is missing.',
    "show curly.toml": 'Line 2: `angle = “5”`. Write straight quotation marks: "5".',
    "show bare.toml": "Line 2: `drag = 20 min`. Put the value in quotes.",
    "show width.toml": "uncertain.x: got 'x', expected an input on which the motion depends. Did you mean release.x?",
    "show broken.toml": "Expected ']' at the end of a table declaration (at line 1, column 10)",
    "show both.toml": "Keep one kind.",
    "show nothing.toml": "a table with x and y, or with angle and azimuth",
    "show short.toml": "To release at or above the horizontal, give angle and azimuth.",
    "show missing.toml": "`foucault scenes` lists the ids.",
    "generate paris --digits many": "expected a whole number",
    "generate paris --digits 0": "from 1 to 1000",
    "generate paris --level proven": "computed, self_consistent, confirmed or enclosed",
    "generate": "a scene, or --all. `foucault scenes` lists the scenes.",
    "generate paris --out mine.csv": "There is a file of that name: choose another name.",
    "verify folder": "Make it with `foucault generate`.",
    "verify paris2": "Did you mean paris?",
    "sweep paris": "--over KEY=…, or --rows FILE",
    "sweep paris --over lat=0:90:10": "Did you mean site.latitude?",
    "sweep paris --over site.latitude=0..90": "site.latitude=START:STOP:STEP",
    "sweep paris --over site.latitude=90:0:10": "a STEP towards STOP",
    "sweep paris --over release.angle=1,2": "by which this scene is released",
    "sweep paris --over site.latitude=@none.csv": "expected a readable file",
    "sweep paris --over site.latitude=1 --want period": "There are frequency, precession",
    "sweep --out folder": "To begin a sweep, give a scene and --over.",
    "plot paris --out picture": "a path that ends in .svg, .png or .pdf",
    "study paris --methods rk5": "Did you mean rkng56 or rk4?",
    "study paris --settings 0.1": "has no effect without --run",
    "atlas --data nowhere": "`foucault generate --all`",
    "methods all": "unexpected extra argument",
}
ROWS = {"t": [0, 60], "x": [0.3, -0.1763], "y": [0.4, -0.4158]}
INFINITE = {
    "id": "a",
    "pendulum": {"length": float("inf")},
    "release": {"angle": "5", "azimuth": "0"},
}
TYPO = {"id": "a", "pendulum": {"lenght": "12.3"}, "release": {"angle": "5", "azimuth": "0"}}
PYTHON = {
    'reference.solve("pari")': "Did you mean paris?",
    'reference.solve("paris", digits="many")': "expected a whole number",
    'reference.solve("paris", digits=20.5)': "expected a whole number",
    'reference.solve("paris", level="proven")': "'computed', 'self_consistent', 'confirmed' or 'enclosed'",
    'reference.solve("paris", t_end=-1)': "expected a number above 0",
    'reference.solve("paris", t_end="20 min")': "1200 for 20 min",
    "reference.solve(None)": "a Scene, an id, the path of a TOML file, or nested mappings",
    'reference.solve("missing.toml")': "`foucault scenes` lists the ids.",
    "reference.solve(INFINITE)": "NaN and inf are not numbers here",
    "reference.solve(TYPO)": "Did you mean pendulum.length?",
    'reference.load("pari")': "Did you mean paris?",
    'reference.load_scene("paris", "site.latitude")': "SECTION.KEY=VALUE",
    'reference.load_scene("paris", {"site.latitude": 100})': "at least -90 and at most 90",
    'reference.load_scene("paris", {"site.latitude": None})': "a decimal number such as 67",
    'reference.sweep("paris")': "--over KEY=…",
    'reference.sweep("paris", "latitude=0:10:5", workers=0)': "a whole number, 1 or more",
    'reference.sweep("paris", {"lat": [0, 10]})': "Did you mean site.latitude?",
    'reference.sweep("paris", {"site.latitude": []})': "V1,V2,…",
    'reference.sweep("paris", {"site.latitude": ["a"]})': "a decimal number such as 67",
    'reference.sweep("paris", {"site.latitude": [0]}, engine="octo")': "Did you mean octet?",
    'reference.sweep("paris", {"site.latitude": [0]}, want="period")': "There are frequency, precession",
    'reference.load_sweep("nowhere")': "the folder of a sweep",
    'reference.write("paris", "out")': "Solve the scene first. Ranges are written by write_ranges.",
    'reference.trajectory("paris", [0, 1], number="double")': "DOUBLE, LONG_DOUBLE or real(BITS)",
    'reference.load("paris").at("noon")': "times from 0 to 86400 s",
    'reference.load("paris").at(-1)': "The scene ends there: a larger run.t_end solves a longer one.",
    'compare.judge("paris", ROWS)': "call judge(rows, scene).",
    'compare.judge(ROWS, "pari")': "Did you mean paris?",
    'compare.judge({"x": [1], "y": [2]}, "paris")': "Columns are t, x, y",
    'compare.judge({"t": [0, 1], "x": [1], "y": [2, 3]}, "paris")': "of 2 numbers, as many as t has",
    'compare.judge(np.zeros((3, 3)), "paris")': "columns by name with t, x and y",
    'compare.judge(pd.DataFrame({"a": [1]}), "paris")': "Columns are t, x, y",
    'compare.judge("mien.csv", "paris")': "a readable file",
    'compare.judge(ROWS, "paris", tolerance="1mm")': "a positive number of metres",
    'compare.judge(ROWS, "paris", t_end="30")': "t_end: got '30', expected a number of seconds",
    'compare.judge(ROWS, "paris", covers="all")': "covers: got 'all', expected a share",
    'compare.judge(ROWS, "paris", transits=["8.2"])': "transits: got dtype <U3, expected an array of real numbers",
    'compare.judge(ROWS, "paris", transits=[16.4, 8.2])': "transits: got 8.19",
    'compare.judge(None, "paris")': "candidate: got 'NoneType', expected a file, a Candidate, or columns by name",
    'compare.assert_agrees("paris", [0, 60], [0.3, 0.4])': "shape (rows, 2), (rows, 3) or (rows, 6)",
    "compare.plot(42)": "a Scene, an id, the path of a TOML file",
    'compare.plot("paris").save("p.bmp")': "a path that ends in .svg, .png or .pdf",
    'compare.study("paris", methods=["rk5"])': "Did you mean rkng56 or rk4?",
    'compare.study("paris", methods="rk5")': "Did you mean rkng56 or rk4?",
    'compare.assert_agrees([0, 60], [[0.3, 0.4], [0.1, 0.2]], "paris")': "expected a Scene, an id, the path",
    "reference.load(None)": "PATH: got 'None', expected the id of a dataset, or the path of its folder",
    "reference.load(3)": "the id of a dataset",
    "reference.load_ranges(None)": "the id of a dataset",
    "compare.read(3)": "CANDIDATE: got '3', expected a readable file",
    "reference.load_sweep(3)": "folder: got '3', expected the folder of a sweep",
    "reference.parse_scene(3)": "scene: got '3', expected nested mappings",
    'reference.load_scene("paris", 3)': "SECTION.KEY=VALUE",
    'reference.sweep("paris", 3)': "KEY=START:STOP:STEP",
    'reference.sweep("paris", OVER, workers="2")': "workers: got '2', expected a whole number, 1 or more",
    'reference.sweep("paris", OVER, workers=1.5)': "a whole number, 1 or more",
    'reference.sweep("paris", OVER, audit_rows="x")': "--audit: got 'x', expected a number of rows, 0 or more",
    'reference.sweep("paris", OVER, tolerance="x")': "a number of metres, 0 or more",
    'reference.sweep("paris", OVER, level=3)': "There are computed, self_consistent",
    'reference.sweep("paris", OVER, want=3)': "There are frequency, precession",
    'reference.sweep("paris", OVER, out=3)': "out: got '3', expected a folder",
    'reference.sweep("paris", rows=pd.DataFrame({"site.latitude": [1]}))': "write rows.to_csv(FILE, index=False)",
    'reference.integrate(["a"], DECAY, [1], [0, 1], max_steps="x")': "a whole number of steps, or 0 for any number",
    'reference.integrate(["a"], DECAY, [1], [0, 1], max_steps=10**30)': "a whole number of steps",
    'reference.integrate(["a"], DECAY, None, [0, 1])': "start: got 'None', expected 1 finite number",
    'reference.integrate(["a"], DECAY, ["x"], [0, 1])': "finite number, one for each variable",
    'reference.integrate(["a"], DECAY, [float("nan")], [0, 1])': "finite number",
    'reference.integrate(["a", "a"], DECAY, [1, 1], [0, 1])': "a different name for each variable",
    "reference.integrate([1], DECAY, [1], [0, 1])": "a different name for each variable",
    "reference.integrate(None, DECAY, [1], [0, 1])": "a different name for each variable",
    "reference.integrate([], DECAY, [], [0, 1])": "a different name for each variable",
    'reference.integrate(["a"], None, [1], [0, 1])': "a function derivatives(state, functions)",
    'reference.integrate(["a"], lambda *_: None, [1], [0, 1])': "a list of rates, numbers or expressions",
    'reference.integrate(["a"], lambda *_: ["x"], [1], [0, 1])': "a list of rates, numbers or expressions",
    'reference.integrate(["a"], DECAY, [1], [0, 1], number="double")': "DOUBLE, LONG_DOUBLE or real(BITS)",
    "reference.write(SOLVED, 3)": "folder: got '3', expected the folder to write to",
    'reference.prove_ranges("paris", widths="length=±0.001")': "a mapping such as {'pendulum.length': '±0.001'}",
    'reference.sweep("paris", {"site.latitude": [0]}, level="sure")': "There are computed, self_consistent",
}


@pytest.fixture
def desk(tmp_path, monkeypatch):
    """A folder with the files that the mistakes are about."""
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "folder").mkdir()
    with zipfile.ZipFile(tmp_path / "book.xlsx", "w") as book:
        book.writestr("xl/workbook.xml", "<workbook/>")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(scope="module")
def solved():
    return reference.solve("paris", t_end=1, digits=10, level="computed")


@pytest.mark.parametrize("line", LINE)
def test_a_first_mistake_on_the_command_line_ends_with_2_and_what_to_do(desk, foucault, line):
    before = sorted(desk.rglob("*"))
    status, out, err = foucault(*shlex.split(line))
    assert (status, out) == (2, "")
    assert LINE[line] in err
    assert "Traceback" not in err
    assert sorted(desk.rglob("*")) == before


@pytest.mark.parametrize("expression", PYTHON)
def test_a_first_mistake_in_python_is_an_input_error_that_says_what_to_do(desk, solved, expression):
    names = {
        "reference": reference,
        "compare": compare,
        "np": np,
        "pd": pd,
        "ROWS": ROWS,
        "INFINITE": INFINITE,
        "TYPO": TYPO,
        "OVER": {"site.latitude": [0]},
        "DECAY": lambda state, _: [-state[0]],
        "SOLVED": solved,
    }
    with pytest.raises(InputError) as error:
        eval(expression, names)
    assert PYTHON[expression] in str(error.value)
