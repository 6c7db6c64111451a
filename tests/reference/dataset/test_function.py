"""The golden function of a dataset: its files, what is refused of them, forged coefficients, the motion at any time."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from forgery import seal
from golden_functions import errors
from limbs_states import states
from lines import unwrapped
from places import ROOT

pytest.importorskip("flint")

import reference
from reference import DatasetError, InputError
from reference.dataset.files import read_files, read_manifest
from reference.dataset.making import making_of
from reference.dataset.manifest import FUNCTION, MANIFEST
from reference.dataset.place import dataset_id
from reference.dataset.verify import problems_of, recompute, verify
from reference.numbers.columns import STATE
from reference.numbers.function import GoldenFunction
from reference.scenes.shipped import WITHOUT_FUNCTION, golden_root, scene_ids


@pytest.fixture(scope="module")
def solution():
    scene = reference.load_scene("paris")
    return reference.solve(
        scene, t_end="300", digits=20, level="enclosed", engine="limbs", function=True
    )


@pytest.fixture(scope="module")
def whole(solution, tmp_path_factory):
    return reference.write(solution, tmp_path_factory.mktemp("golden") / "paris")


@pytest.fixture
def folder(whole, tmp_path):
    return shutil.copytree(whole, tmp_path / "paris")


def changed(folder, change=None, data=None):
    """Change function.json and function.f64, and make hashes and seal anew."""
    said = json.loads((folder / FUNCTION[0]).read_text())
    if change is not None:
        change(said)
    texts = {FUNCTION[0]: json.dumps(said, indent=1) + "\n"}
    seal(
        folder,
        json.loads((folder / MANIFEST).read_text()),
        texts | ({FUNCTION[1]: data} if data is not None else {}),
    )


def test_it_is_written_sealed_and_verified(whole):
    files = read_files(whole)
    assert set(FUNCTION) <= set(files.manifest.files)
    assert files.manifest.command.endswith("--no-audit --confirm none --function")
    assert verify(whole).problems == []
    assert recompute(whole) == ([], [])


def test_it_leaves_the_other_files_as_they_are(whole, solution, tmp_path):
    proof = replace(solution.proof, enclosure=replace(solution.proof.enclosure, function=None))
    folder = reference.write(replace(solution, proof=proof), tmp_path / "paris")
    other = read_files(folder)
    files = read_files(whole)
    assert {name: text for name, text in files.texts.items() if name not in FUNCTION} == other.texts
    assert "--function" not in other.manifest.command
    assert other.function is None
    with_function, without = reference.load(whole), reference.load(folder)
    assert [with_function.grid.decimals(name) for name in STATE] == [
        without.grid.decimals(name) for name in STATE
    ]
    assert with_function.transits.decimals("t") == without.transits.decimals("t")


def test_solution_and_dataset_have_the_same_motion_at_times_of_any_shape(whole, solution):
    golden = reference.load(whole)
    times = np.array([[299.5, 0.0], [17.25, 300.0], [17.25, 8.0]])
    at, own = golden.at(times), solution.at(times)
    off = errors(golden.scene, golden.function, np.unique(times))
    for name in STATE:
        column = getattr(at, name)
        assert column.shape == times.shape
        assert np.array_equal(column, getattr(own, name))
        one_by_one = [getattr(golden.at(t), name) for t in times.ravel().tolist()]
        assert column.ravel().tolist() == one_by_one
        assert off[name].max() <= at.bound[name]
    assert isinstance(float(golden.at(3).x), float)
    assert at.t.tolist() == times.tolist()
    for t in (-0.1, 300.1, float("nan")):
        with pytest.raises(InputError, match=r"times from 0 to 300 s"):
            golden.at(t)


def test_without_a_function_a_dataset_is_integrated_anew_and_a_solution_refuses(
    whole, solution, tmp_path
):
    golden = reference.load(whole)
    plain = replace(golden, function=None)
    times = np.array([[299.5, 3.25], [17.25, 300.0]])
    one, other = golden.at(times), plain.at(times)
    for name in STATE:
        gap = np.abs(getattr(one, name) - getattr(other, name))
        assert gap.shape == (2, 2)
        assert (gap <= one.bound[name] + other.bound[name]).all()
        assert 0 < other.bound[name] < 1e-13
    for t in (-0.1, 300.1, float("nan")):
        with pytest.raises(InputError, match=r"times from 0 to 300 s"):
            plain.at(t)
    with pytest.raises(InputError, match="without a golden function"):
        replace(solution, proof=None).at(1.0)


def test_a_function_needs_a_proof():
    with pytest.raises(InputError, match="function"):
        reference.solve("paris", t_end="60", digits=9, level="computed", function=True)


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        (lambda said: said.update(id="other"), "id = other does not follow"),
        (lambda said: said.update(inputs="binary64"), "inputs = binary64 does not follow"),
        (lambda said: said.update(frame="upside down"), "frame = upside down does not follow"),
        (lambda said: said["units"].update({"t": "min"}), "units.t = min does not follow"),
        (lambda said: said["times"].__setitem__(-1, (299.0).hex()), "ends at 299 s, not at 300 s"),
        (lambda said: said["times"].__setitem__(5, said["times"][7]), "times must increase"),
        (lambda said: said["times"].__setitem__(0, (1.0).hex()), "times: must increase from 0"),
        (lambda said: said["times"].pop(), "function.f64 has the wrong size"),
        (lambda said: said.update(degree=20), "function.f64 has the wrong size"),
        (lambda said: said.update(components=["x", "z"]), "components: must be"),
        (lambda said: said.update(length_squared=None), "components: must be"),
        (lambda said: said["bounds"].pop("vx"), "bounds: must name"),
        (lambda said: said.update(more=1), "breaks the schema at more"),
        (lambda said: said.update(length_squared="4489"), "breaks the schema at length_squared"),
        (lambda said: said.update(length_squared=(4489.000001).hex()), "z is"),
    ],
)
def test_a_description_that_does_not_fit_is_refused(change, problem, folder):
    changed(folder, change)
    (first, *_) = problems_of(folder)
    assert problem in first


def test_files_that_do_not_belong_together_are_refused(folder):
    document = json.loads((folder / MANIFEST).read_text())
    numbers = document["files"].pop(FUNCTION[1])
    seal(folder, document, {})
    with pytest.raises(DatasetError, match="a golden function has two files, and a proof"):
        reference.load(folder)
    document["files"][FUNCTION[1]] = numbers
    changed(folder, data=np.full(numbers["bytes"] // 8, np.nan).tobytes())
    with pytest.raises(DatasetError, match="must be finite"):
        reference.load(folder)


def test_bounds_that_are_too_small_are_refused(folder):
    changed(folder, lambda said: said["bounds"].update(z="1.0e-16"))
    assert any("z is" in problem for problem in verify(folder).problems)


def test_forged_coefficients_are_found_where_the_motion_leaves_the_bound(whole, folder, size):
    """One coefficient is off by 1, 30 or 1,000 units in its last place: the seal finds each, `verify` these too."""
    files, rng = read_files(whole), np.random.default_rng(9)
    _, function = files.function
    ends = function.times
    degree, count, pieces = (
        n - 1 if i == 0 else n for i, n in enumerate(function.coefficients.shape)
    )
    inside = [
        np.unique([*rng.uniform(*ends[i : i + 2], 100), ends[i], np.nextafter(ends[i + 1], 0)])
        for i in range(pieces)
    ]
    truth = [states(files.scene.exact, times) for times in inside]
    leaving = 0
    for _ in range(size(20, 300)):
        k, j, i = (
            int(rng.integers(0, degree + 1)),
            int(rng.integers(count)),
            int(rng.integers(pieces)),
        )
        for ulps in (1, 30, 1000):
            coefficients = function.coefficients.copy()
            coefficients[k, j, i] += (
                rng.choice([-1, 1]) * ulps * np.spacing(abs(coefficients[k, j, i]))
            )
            forged = replace(function, coefficients=coefficients)
            data = np.ascontiguousarray(coefficients.transpose(2, 1, 0)).tobytes()
            folder.joinpath(FUNCTION[1]).write_bytes(data)
            assert verify(folder).problems == ["function.f64: a byte was changed (sha256 differs)"]
            at, (high, low) = forged.at(inside[i]), truth[i]
            off = {
                name: np.abs((getattr(at, name) - high[:, n]) - low[:, n]).max()
                for n, name in enumerate(STATE)
            }
            leaves = max(off[name] / forged.bound[name] for name in STATE)
            changed(folder, data=data)
            found = verify(folder).problems
            assert all(problem.startswith("function.json: t = ") for problem in found)
            leaving += leaves > 1
            assert found or leaves <= 1, (k, j, i, ulps, leaves)
            assert leaves > 0.999 or not found
    assert leaving > size(3, 50)


def test_generate_makes_it_by_default_and_not_with_no_function(foucault, tmp_path):
    scene = (
        (ROOT / "data/scenes/laboratory.toml")
        .read_text()
        .replace('id = "laboratory"', 'id = "mine"')
    )
    (tmp_path / "mine.toml").write_text(scene)
    words = (
        "generate",
        tmp_path / "mine.toml",
        "--t-end",
        "2",
        "--digits",
        "12",
        "--level",
        "enclosed",
        "--no-confirm",
    )
    for option, there in (([], True), (["--no-function"], False), (["--function"], True)):
        out = tmp_path / f"out{len(option)}{there}"
        status, _, err = foucault(*words, *option, "--out", out)
        assert status == 0, err
        assert {name for name in FUNCTION if (out / name).exists()} == (
            set(FUNCTION) if there else set()
        )
        assert ("--function" in json.loads((out / MANIFEST).read_text())["command"]) is there
    status, _, err = foucault(
        *words[:-3], "--level", "computed", "--function", "--out", tmp_path / "no"
    )
    assert (status, "--function" in err) == (2, True)


def test_what_ships_has_the_function_of_doubles():
    """`generate NAME` makes the bytes that ship: decimals have no function, doubles have one, mostly alone."""
    for name, reading, alone in (
        ("paris", "decimal", False),
        ("paris", "binary64", False),
        ("pole", "binary64", True),
    ):
        scene = reference.load_scene(name, [f"inputs={reading}"])
        making, doubles = (
            making_of(scene, dataset_id(scene), ROOT / "elsewhere"),
            reading == "binary64",
        )
        assert (making.function, making.tables) == (doubles, not alone)
        golden = reference.load(dataset_id(scene))
        assert (golden.function is not None, golden.manifest.alone) == (doubles, alone)


def test_every_scene_ships_its_function_of_doubles_or_says_how_large_it_is(foucault):
    functions = {path.parent.name: path.parent for path in golden_root().glob(f"*/{FUNCTION[1]}")}
    assert {*functions} == {f"{name}.binary64" for name in {*scene_ids()} - {*WITHOUT_FUNCTION}}
    alone = [folder for folder in functions.values() if read_manifest(folder).alone]
    files = [path for folder in alone for path in folder.iterdir()]
    files += [
        folder / name for folder in functions.values() if folder not in alone for name in FUNCTION
    ]
    assert sum(path.stat().st_size for path in files) <= 12_000_000
    _, said, _ = foucault("scenes")
    entries = re.split(r"\n(?=  \S)", said)  # a scene each, in several lines
    without = [
        entry.split()[0] for entry in entries if "without a golden function" in unwrapped(entry)
    ]
    assert without == sorted(WITHOUT_FUNCTION)


@pytest.fixture(scope="module")
def alone(solution, tmp_path_factory):
    return reference.write(solution, tmp_path_factory.mktemp("alone") / "paris", tables=False)


def test_a_function_alone_is_a_dataset_with_the_same_motion_and_transits(
    alone, whole, solution, tmp_path
):
    assert {path.name for path in alone.iterdir()} == {MANIFEST, *FUNCTION}
    files = read_files(alone)
    assert files.manifest.command.endswith("--confirm none --function --no-tables")
    assert verify(alone).problems == []
    assert recompute(alone) == ([], [])
    golden, printed = reference.load(alone), reference.load(whole)
    assert golden.function.at(7.5).x == printed.function.at(7.5).x
    assert golden.t.tolist() == printed.t.tolist()
    assert golden.directions == printed.directions
    for ours, theirs, columns in (
        (golden.grid, printed.grid, STATE),
        (golden.transits, printed.transits, ("t", "x", "y", "z", "vy")),
    ):
        for name in columns:
            bounds = zip(ours.bound(name), theirs.bound(name), strict=True)
            numbers = zip(ours.exact(name), theirs.exact(name), strict=True)
            ulp = Fraction(float(np.spacing(np.abs(ours[name]).max())))
            assert all(
                abs(a - b) <= p + q + ulp for (a, b), (p, q) in zip(numbers, bounds, strict=True)
            ), name
    assert np.abs(golden.transits["ax"] / printed.transits["ax"] - 1).max() < 1e-13
    with pytest.raises(InputError, match="a golden function, or tables"):
        reference.write(replace(solution, proof=None), tmp_path / "nothing", tables=False)


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        (
            lambda said: said["counts"].update(transits=35),
            "xdot has 36 zeros, but the manifest says 35",
        ),
        (
            lambda said: said.update(command=said["command"].replace(" --no-tables", "")),
            "command does not follow",
        ),
        (lambda said: said["scene"]["site"].update(latitude="48"), "id = paris does not follow"),
        (lambda said: said["files"].pop(FUNCTION[0]), "a golden function alone"),
    ],
)
def test_a_manifest_that_does_not_fit_a_function_alone_is_refused(change, problem, alone, tmp_path):
    folder = shutil.copytree(alone, tmp_path / "paris")
    document = json.loads((folder / MANIFEST).read_text())
    change(document)
    seal(folder, document, {})
    try:
        found = verify(folder).problems
        reference.load(folder)
    except DatasetError as error:
        found = [*found, *error.problems]
    assert any(problem in text for text in found), found


def test_tables_are_left_out_only_where_there_is_a_function(foucault, tmp_path):
    words = ("generate", "paris", "--t-end", "20", "--digits", "12", "--no-function", "--no-tables")
    status, _, err = foucault(*words, "--out", tmp_path / "no")
    assert (status, "--no-tables" in err) == (2, True)
    making = making_of(
        reference.load_scene("paris", ["site.latitude=1"]),
        "paris+site.latitude=1",
        ROOT / "elsewhere",
    )
    assert making.function and making.tables


def test_a_span_that_is_no_double_ends_at_the_double_below(tmp_path):
    scene = reference.load_scene("paris", ["run.t_end=10.1", "run.grid_step=10.1", "run.digits=12"])
    solution = reference.solve(scene, level="enclosed", function=True, engine="limbs")
    golden = reference.load(reference.write(solution, tmp_path / "tenth"))
    end = float(golden.function.times[-1])
    assert Fraction(end) <= Fraction("10.1") < Fraction(np.nextafter(end, 11))
    assert verify(tmp_path / "tenth").problems == []


def test_a_function_takes_its_coefficients_as_they_lie():
    facts = {
        "times": ["0x0.0p+0", "0x1.0p+1", "0x1.8p+1"],
        "components": ["x", "y", "z"],
        "degree": 1,
        "length_squared": None,
    }
    numbers = np.arange(12.0)
    function = GoldenFunction.of(facts, dict.fromkeys(STATE, "1e-15"), numbers.tobytes())
    at = function.at([0.0, 1.0, 2.0, 3.0])  # u = -1, 0, -1, 1
    assert at.x.tolist() == [-1.0, 0.0, -1.0, 13.0]
    assert at.z.tolist() == [-1.0, 4.0, -1.0, 21.0]
    assert at.vy.tolist() == [3.0, 3.0, 18.0, 18.0]
