"""docs/theorem: Coq accepts every proof, which rests on the axioms of the real numbers alone."""

from __future__ import annotations

import re
import shutil
import subprocess

import pytest
import theorem
from pages import of_language
from places import ROOT

TEXT = (ROOT / "reference/enclosure/THEOREM.md").read_text(encoding="utf-8")
_, _, CHECKED = TEXT.partition("## 15. What Coq has checked")
SOURCES = {
    path.stem: path.read_text(encoding="utf-8") for path in sorted(theorem.THEOREM.glob("*.v"))
}
ALLOWED = {
    "ClassicalDedekindReals.sig_forall_dec",
    "ClassicalDedekindReals.sig_not_dec",
    "Classical_Prop.classic",
    "FunctionalExtensionality.functional_extensionality_dep",
}


@pytest.fixture(scope="module")
def compiled(tmp_path_factory):
    """The folder of the compiled files, and what was printed."""
    lacking = theorem.missing()
    if lacking is not None:
        pytest.skip(f"no {lacking}: {theorem.INSTALL}")
    if shutil.which("make") is None:
        pytest.skip("make is not installed")
    build = tmp_path_factory.mktemp("theorem")
    command = ["make", "--no-print-directory", "-C", theorem.THEOREM, f"BUILD={build}"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return build, done.stdout


def named_theorems():
    """Yield the file and the name of each theorem in the table of section 15."""
    for line in re.findall(r"^\| `\w+` \|.*$", CHECKED, re.M):
        file, *names = re.findall(r"`(\w+)`", line)
        for name in names:
            yield file, name


def test_coq_accepts_every_proof_and_needs_the_axioms_of_the_reals_alone(compiled):
    _, printed = compiled
    axioms = {*re.findall(r"^([\w.]+)\s*:", printed, re.M)} - {"Axioms"}
    assert axioms == ALLOWED
    theorems = re.findall(r"^Print Assumptions (\w+)\.", SOURCES["Assumptions"], re.M)
    assert printed.count("Axioms:") == len(theorems)


def test_a_wrong_statement_is_refused(compiled, tmp_path):
    base, _ = compiled
    (change,) = (one for one in theorem.changes() if one.why == "(4.3): K for K²")
    assert theorem.refused_in(change, base, tmp_path) == change.file


def test_no_proof_is_left_out_and_nothing_is_assumed():
    words = r"\b(Admitted|admit|Axioms?|Parameters?|Conjecture|Abort|give_up|bypass_check)\b"
    found = {}
    for name, text in SOURCES.items():
        code = re.sub(r"\(\*.*?\*\)", "", text, flags=re.S)
        found[name] = re.findall(words, code)
    assert {name: words for name, words in found.items() if words} == {}


def test_the_theorem_s_table_names_theorems_of_the_files_whose_assumptions_are_printed():
    named = [*named_theorems()]
    assert len(named) > 30
    for file, name in named:
        assert re.search(rf"^(Theorem|Lemma) {name}\b", SOURCES[file], re.M), (file, name)
    together = re.findall(r"@(\w+)", SOURCES["Assumptions"])
    assert [name for _, name in named] == together


def test_the_page_shows_theorem_c_as_it_is_proved():
    (statement,) = of_language("docs/theorem/README.md", "text")
    assert statement in SOURCES["Section4_TheoremC"]


def test_every_file_is_compiled_by_make():
    assert sorted(theorem.order()) == sorted(SOURCES)


def test_each_change_of_a_statement_is_of_one_place_of_its_file():
    changes = theorem.changes()
    assert len(changes) >= 30
    for change in changes:
        assert change.changed() != SOURCES[change.file]
