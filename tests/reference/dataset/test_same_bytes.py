"""What ships has the same bytes on every machine: nothing that hardware floating point measures reaches them."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from own_project import environment_of, own_project
from same_bytes import confirmed, made_again, processor, shipped, swept
from sampled import one_in

import reference
from reference.commands.generate_all import jobs
from reference.dataset.files import read_manifest
from reference.dataset.making import AUDIT, Making, command, making_of
from reference.dataset.place import default_folder
from reference.dataset.render import render
from reference.engines.heyoka.engine import Heyoka
from reference.errors import InputError
from reference.numbers.precision import DOUBLE
from reference.numbers.table import Table
from reference.scenes.scene import load_scene
from reference.scenes.shipped import golden_root, index, seals

# tables of few and of many bits, a way close by the top, and a function, whose proof turns its boxes in doubles
SHORT = ("weightless", "separatrix", "conical", "force_free.binary64")
LONG = ("near_inverted.binary64", "nearly_conical", "barely_over")  # the same code on longer ways
# another kind of processor, as far as software can make one: no FMA in numba's code and in libm, another BLAS kernel
OTHER_PROCESSOR = {
    "NUMBA_CPU_NAME": "generic",
    "OPENBLAS_CORETYPE": "Prescott",
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-AVX2,-AVX2_Usable,-FMA_Usable,-FMA4",
}
SCRIPT = """
import sys
from same_bytes import confirmed, differing, swept, translated
taken = translated(sys.argv[1]) if sys.argv[1] else []
print(differing(sys.argv[2:]), *swept(), *confirmed(), sorted(taken), sep="\\n")
"""


def jitter(monkeypatch, share: int) -> list[str]:
    """Move every number that a run in double or long double computes by some units in the last place."""
    honest, types = Heyoka.run, []

    def moved(table: Table, prec: int) -> Table:
        def noise(value: int, place: int) -> int:
            return value + (value * (place * 7919 % 13 - 6) * share >> prec)

        rows = [
            tuple(noise(value, i + j) for j, value in enumerate(row))
            for i, row in enumerate(table.values)
        ]
        return Table(table.columns, table.bits, rows)

    def run(self, plan, *words):
        found = honest(self, plan, *words)
        types.append(str(plan.number))
        if not plan.number.hardware:
            return found
        prec = plan.number.prec
        zeros = {
            word: part._replace(table=moved(part.table, prec)) for word, part in found.zeros.items()
        }
        return replace(found, grid=moved(found.grid, prec), zeros=zeros, steps=found.steps + 1)

    monkeypatch.setattr(Heyoka, "run", run)
    # one core, so that nothing escapes to a child
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0})
    return types


@pytest.mark.parametrize(
    ("name", "share"),
    [
        *one_in(
            2, [(name, (3, 40)[(i + k) % 2]) for i, name in enumerate(SHORT) for k in range(2)]
        ),
        *(pytest.param(name, share, marks=pytest.mark.long) for name in LONG for share in (3, 40)),
    ],
)
def test_noise_in_hardware_changes_no_byte_of_what_ships(monkeypatch, name, share):
    types = jitter(monkeypatch, share)
    assert made_again(name) == shipped(name)
    assert any(word.startswith("real(") for word in types)


def test_the_noise_is_felt_where_hardware_computes_the_result_and_the_guard_writes_nothing(
    monkeypatch,
):
    paris = load_scene("paris", ["run.t_end=120", "run.digits=12"])
    rough, proof = replace_level(paris, "computed"), replace_level(paris, "enclosed")
    before = [render(reference.solve(scene)) for scene in (rough, proof)]
    types = jitter(monkeypatch, 40)
    after = [render(reference.solve(scene)) for scene in (rough, proof)]
    assert before[0] != after[0] and before[1] == after[1]
    assert types[-1] == str(DOUBLE)  # of the guard
    monkeypatch.undo()
    jitter(monkeypatch, 1 << 50)  # so wrong a guard is made again with more digits
    solution = reference.solve(proof)
    assert solution.guard.number.startswith("real(") and render(solution) == before[1]


def replace_level(scene, level):
    return scene.with_values([f"run.level={level}"])


def test_another_processor_gives_the_bytes_that_ship(tmp_path, size):
    """Its instructions are made of what numba keeps for this one; under --long all is compiled from the source."""
    from reference.enclosure.trusted.digits import sums
    from reference.engines.limbs.march import march as limbs
    from reference.engines.octet.march import march as octet

    made_again("weightless")  # what numba compiles for it is kept
    expected = [*swept(), *confirmed()]
    folders = {
        "NUMBA_CACHE_DIR": tmp_path / "numba",
        "HOME": tmp_path,
        "XDG_CACHE_HOME": tmp_path / "cache",
    }
    for function in size((sums, limbs, octet), ()):
        kept = Path(function.stats.cache_path).parent
        shutil.copytree(kept, tmp_path / "numba" / kept.name)
    path = os.pathsep.join(
        [str(Path(__file__).parents[2] / "helpers"), os.environ.get("PYTHONPATH", "")]
    )
    environment = (
        os.environ
        | OTHER_PROCESSOR
        | {"PYTHONPATH": path}
        | {key: str(at) for key, at in folders.items()}
    )
    words = [sys.executable, "-c", SCRIPT, size(processor(), ""), *size(SHORT[1:], (*SHORT, *LONG))]
    done = subprocess.run(words, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    first, *rows, taken = done.stdout.splitlines()
    assert first == "generic: []"
    assert rows == expected
    # to be fused is left to limbs alone, where sums and products are exact
    assert taken == str(size(["march ['contract']", "march []", "sums []"], []))


@cache
def manifest_of(name):
    return read_manifest(golden_root() / name)


@pytest.mark.parametrize("name", sorted(seals()))
def test_no_number_type_of_the_hardware_stands_in_what_ships(name):
    manifest = manifest_of(name)
    for run in (manifest.run, *manifest.cross_checks):
        assert re.fullmatch(r"(real|limbs)\([0-9]+\)", run.number), run
    assert set(manifest.generator) == {
        "foucault-data",
        "heyoka",
        "mpmath",
        "numba",
        "numpy",
        "python-flint",
    }


def test_the_commands_of_what_ships_make_what_ships():
    """Both `generate NAME` and `generate --all`, in place and elsewhere: proofs, audited, and confirmed as a whole.

    Of thirty days there is no confirmation.
    """
    everything = {job.name: job for job in jobs((), None)}
    elsewhere = {job.name: job for job in jobs((), Path("elsewhere"))}
    assert set(everything) == set(elsewhere) == set(index()) == set(seals())
    for name, entry in index().items():
        manifest = manifest_of(name)
        assert manifest.level == "enclosed" and AUDIT in manifest.command.split()
        for job in (everything[name], elsewhere[name]):
            scene = job.scene
            making = making_of(scene, name, job.folder)
            assert making.options_for(scene, name) == entry["options"]
            assert command(scene, name, entry["options"]) == manifest.command
        assert everything[name].folder == default_folder(scene, name) == golden_root() / name
    confirmed = {name: Making.of(manifest_of(name).command).confirm for name in index()}
    assert {name: how for name, how in confirmed.items() if how != "whole"} == {"paris_30d": "none"}


def test_options_are_read_as_they_are_written():
    for making in (
        Making(),
        Making("heyoka", audit=False),
        Making("limbs", confirm="none"),
        Making(confirm="sampled"),
    ):
        assert (
            Making.of(f"foucault generate paris {making.options} --set site.latitude=0") == making
        )


def test_without_numba_what_ships_is_refused_and_not_made_otherwise(
    monkeypatch, foucault, tmp_path
):
    monkeypatch.setitem(sys.modules, "numba", None)
    for words in (("conical",), ("conical", "--out", tmp_path / "conical")):
        status, out, err = foucault("generate", *words)
        assert (status, out) == (2, "")
        assert "--engine" in err and "numba" in err and "The engine heyoka does without." in err
    scene = load_scene("conical")
    with pytest.raises(InputError, match="numba"):
        reference.solve(scene, **making_of(scene, "conical", tmp_path).solve_options(scene))
    assert not list(tmp_path.iterdir())


KEEPING = """
import sys
from reference.scenes import shipped
for k in range(20):
    shipped.keep_seal(f"scene_{sys.argv[1]}_{k}", f"{k:064x}", "--engine limbs --audit")
"""


def test_seals_that_several_processes_keep_at_once_are_all_kept(tmp_path):
    project = own_project(tmp_path / "own", [])
    words = [[sys.executable, "-c", KEEPING, str(k)] for k in range(3)]
    processes = [
        subprocess.Popen(command, cwd=project, env=environment_of(project)) for command in words
    ]
    assert [process.wait() for process in processes] == [0] * 3
    (only,) = (project / "data/golden").iterdir()
    kept = json.loads(only.read_text())
    assert (only.name, len(kept)) == ("index.json", 60)
    assert kept["scene_2_3"] == {"seal": f"{3:064x}", "options": "--engine limbs --audit"}
