"""A registry finds what the files of a folder declare; the two of `compare` hold all files of theirs."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib import import_module
from pkgutil import iter_modules

import lines
import pytest

from compare.approximations import APPROXIMATIONS
from compare.methods import METHODS
from reference import InputError
from reference.system.imports import Registry

INTERFACES = {
    "compare.methods": (
        "METHODS",
        {"external", "fixed_step", "library", "method", "rhs", "tableau"},
    ),
    "compare.approximations": ("APPROXIMATIONS", {"approximation", "case"}),
}
FILE = """
from types import SimpleNamespace

THINGS = tuple(SimpleNamespace(id=word, size=len(word)) for word in {words})
"""


@pytest.fixture
def package(tmp_path, monkeypatch):
    """Make a package of files that declare things, and return its name; it is forgotten after the test."""

    def make(name, **files):
        folder = tmp_path / name
        folder.mkdir()
        (folder / "__init__.py").write_text("")
        for file, words in files.items():
            (folder / f"{file}.py").write_text(
                FILE.format(words=words) if words else "nothing = True"
            )
        return name

    monkeypatch.syspath_prepend(tmp_path)
    yield make
    for name in [name for name in sys.modules if name.startswith("things_")]:
        del sys.modules[name]


def test_a_new_file_is_found_and_the_order_is_group_then_file_then_place_in_the_file(package):
    name = package("things_found", b=["later", "first"], a=["middle", "zzz"], helper=None)
    things = Registry(name, "THINGS", "thing", lambda thing: thing.size)
    assert list(things) == ["zzz", "later", "first", "middle"]
    assert things["later"].size == 5
    assert f"{name}.a" in sys.modules


def test_nothing_is_imported_before_the_first_look_up(package):
    name = package("things_later", a=["one"])
    things = Registry(name, "THINGS", "thing", lambda thing: 0)
    assert name not in sys.modules
    assert "one" in things
    assert f"{name}.a" in sys.modules


def test_one_id_in_two_files_is_refused(package):
    name = package("things_twice", a=["one"], b=["two", "one"])
    with pytest.raises(ValueError, match="declare the same id"):
        len(Registry(name, "THINGS", "thing", lambda thing: 0))


def test_an_unknown_id_is_answered_with_the_nearest_ones(package):
    things = Registry(
        package("things_near", a=["apple", "pear", "peach"]), "THINGS", "thing", lambda thing: 0
    )
    with pytest.raises(InputError, match=r"thing: got 'paer'.*Did you mean pear\?") as refused:
        things["paer"]
    assert refused.value.field == "thing"


@pytest.mark.parametrize("name", INTERFACES)
def test_every_file_of_a_folder_of_declarations_declares(name):
    variable, interface = INTERFACES[name]
    files = {module.name for module in iter_modules(import_module(name).__path__)}
    assert interface < files
    for file in files - interface:
        assert getattr(import_module(f"{name}.{file}"), variable), file


@pytest.mark.parametrize(("registry", "least"), [(METHODS, 23), (APPROXIMATIONS, 36)])
def test_ids_are_the_keys_and_may_be_typed_in_a_comma_separated_list(registry, least):
    assert len(registry) >= least
    for word, declared in registry.items():
        assert declared.id == word
        assert word.isidentifier() and word == word.lower()


def test_listing_loads_no_heavy_library():
    heavy = "heyoka flint scipy numba matplotlib rebound jax sksundae numbalsoda"
    listed = "; ".join(
        f"import {name} as m; list(m.{INTERFACES[name][0]}.values())" for name in INTERFACES
    )
    code = f"import sys; {listed}; print(set(sys.modules) & set({heavy.split()}))"
    process = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert process.stdout.strip() == "set()"


SWEEP = "sweep paris --over latitude=0,5 --t-end 60 --engine heyoka"


@pytest.mark.parametrize(
    ("line", "module", "extra"),
    [
        ("show paris --equations", "flint", "enclose"),
        ("show paris --uncertain length=±0.001", "flint", "enclose"),
        ("generate paris --t-end 60 --out there", "flint", "enclose"),
        (f"{SWEEP} --level enclosed", "flint", "enclose"),
        (f"{SWEEP} --cluster local:2", "distributed", "cluster"),
        ("generate --all --out there --cluster local:2", "distributed", "cluster"),
        ("generate --all --out there", "flint", "enclose"),
        ("generate --all --out there", "numba", "fast"),
        ("score museum_gate rows.csv", "flint", "enclose"),
        ("plot paris", "matplotlib", "plot"),
        ("pend -T 1", "numba", "methods"),
        (f"{SWEEP} --out there", "pyarrow", "sweep"),
        ("sweep paris --rows rows.parquet", "pyarrow", "sweep"),
    ],
)
def test_a_command_whose_package_is_missing_names_the_extra(
    foucault, monkeypatch, tmp_path, line, module, extra
):
    monkeypatch.setitem(sys.modules, module, None)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rows.parquet").touch()
    (tmp_path / "rows.csv").write_text("t,x,y\n0,0.3,0.4\n1,0.3,0.4\n")
    status, out, err = foucault(*line.split())
    assert (status, out) == (2, "")
    assert f"pip install 'foucault-reference[{extra}]'" in err and module in err
    told = err.splitlines()
    assert len(told) == 1 and "got" not in told[0]  # at once, and not in terms of what nobody typed
    assert not (tmp_path / "there").exists()


def test_a_scene_with_uncertain_inputs_is_shown_without_the_proof(foucault, monkeypatch):
    monkeypatch.setitem(sys.modules, "flint", None)
    status, out, err = foucault("show", "museum_gate")
    assert (status, err) == (0, "")
    assert "20 m, no drag" in out
    assert "period" in lines.part(out, "Motion over")
    (told,) = [line for line in out.splitlines() if "pip install" in line]
    assert "'foucault-reference[enclose]'" in told and "Left out" in told
    status, out, _ = foucault("show", "museum_gate", "--json")
    assert status == 0
    assert "foucault-reference[enclose]" in json.loads(out)["ranges"]["reason"]
