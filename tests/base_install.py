"""Run every command, and `show` of every scene, where the package is installed without any extra.

    python -m venv base
    base/bin/pip install .
    base/bin/python tests/base_install.py
    base/bin/pip uninstall -y heyoka        # as on macOS and Windows, where pip has none
    base/bin/python tests/base_install.py

A command either does its work, or is refused with status 2 and one line that names the extra to install, or conda for
heyoka. No traceback.
"""

from __future__ import annotations

import shlex
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from foucault import GROUPS
from reference import load
from reference.scenes.shipped import golden_root, scene_ids

# that only extras install
MODULES = ("flint", "numba", "matplotlib", "pyarrow", "distributed", "scipy")
HEYOKA = find_spec("heyoka") is not None
PATIENCE_S = 300
DONE, DISAGREES, REFUSED = 0, 1, 2
SWEEP = "sweep paris --over site.latitude=0:90:45 --t-end 60"
STUDY = "study paris --t-end 60 --methods heyoka_double --no-formulations"


@dataclass(frozen=True)
class CommandCase:
    """A command line without `foucault`, and how it has to end.

    Attributes:
        line: the command line.
        extra: the extra for want of which it is refused.
        status: its exit status where it is not refused.
        solves: whether it is refused where heyoka is not installed.
    """

    line: str
    extra: str | None = None
    status: int = DONE
    solves: bool = False

    @property
    def wanting(self) -> str | None:
        """What a refusal has to name: an extra, or conda's name of heyoka; None if the command does its work."""
        if self.solves and not HEYOKA:
            return "conda install -c conda-forge heyoka.py"
        return self.extra and f"foucault-reference[{self.extra}]"

    def fault(self, ended: subprocess.CompletedProcess[str]) -> str:
        """Return what is wrong with how it ended; empty if nothing is."""
        expected = self.status if self.wanting is None else REFUSED
        messages = ended.stderr.strip().splitlines()
        if ended.returncode != expected:
            return f"status {ended.returncode}, expected {expected}: {' / '.join(messages[-3:])}"
        if "Traceback" in ended.stdout + ended.stderr:
            return "a traceback"
        if self.wanting is None:
            return "" if ended.stdout else "nothing printed"
        if len(messages) != 1 or ended.stdout:
            return f"more than a message: {ended.stdout[:80]} / {' / '.join(messages)}"
        return "" if self.wanting in messages[0] else f"no word of {self.wanting}: {messages[0]}"


CASES = [
    CommandCase("scenes"),
    CommandCase("show --template"),
    CommandCase("show paris --sensitivity", solves=True),
    CommandCase("show paris --equations", "enclose", solves=True),
    CommandCase("show paris --equations --set run.level=confirmed", solves=True),
    CommandCase("show paris --proved", "enclose"),
    CommandCase("show paris --uncertain length=0.001", "enclose"),
    CommandCase("show museum_gate --json"),
    CommandCase("show museum_gate --uncertain none"),
    CommandCase(
        "generate laboratory --t-end 10 --digits 15 --level confirmed --section highest",
        solves=True,
    ),
    CommandCase("generate laboratory --t-end 10", "enclose", solves=True),
    CommandCase("generate laboratory --t-end 10 --level confirmed --engine limbs", "fast"),
    CommandCase("generate museum_gate --t-end 10", "enclose"),
    CommandCase("generate --all --out all", "fast"),
    CommandCase("generate --all --out all --cluster local:1", "cluster"),
    CommandCase("verify paris museum_gate"),
    CommandCase("verify golden/laboratory"),
    CommandCase("verify golden/laboratory --recompute", solves=True),
    CommandCase("verify conical --recompute", "fast", solves=True),
    CommandCase("score paris paris.csv"),
    CommandCase("score paris paris.csv --json"),
    CommandCase("score paris off.csv", status=DISAGREES),
    CommandCase("score paris --run 'cat paris.csv' --repeats 0"),
    CommandCase("score paris --approximation mathar_item_2", status=DISAGREES, solves=True),
    CommandCase("score --suite suite --out page"),
    CommandCase("score --how python"),
    CommandCase("score paris paris.csv --plot error.svg", "plot"),
    CommandCase("score museum_gate paris.csv", "enclose"),
    CommandCase(
        "score museum_gate --transits transits.csv --section 'gate 30' --uncertain none",
        status=DISAGREES,
        solves=True,
    ),
    CommandCase("plot paris", "plot"),
    CommandCase("plot paris.csv --out path.svg", "plot"),
    CommandCase("atlas --out atlas", "plot"),
    CommandCase("methods"),
    CommandCase(STUDY, solves=True),
    CommandCase(f"{STUDY} --run 'cat paris.csv'", solves=True),
    CommandCase(f"{STUDY} --out study", solves=True),
    CommandCase("study paris --methods rk4", "methods"),
    CommandCase("stability --scenes laboratory --methods heyoka_double", solves=True),
    CommandCase(SWEEP, solves=True),
    CommandCase(f"{SWEEP} --level self_consistent", solves=True),
    CommandCase(f"{SWEEP} --level enclosed", "enclose", solves=True),
    CommandCase(f"{SWEEP} --out swept", "sweep", solves=True),
    CommandCase(f"{SWEEP} --plot swept.svg", "plot", solves=True),
    CommandCase(f"{SWEEP} --cluster local:1", "cluster", solves=True),
    CommandCase("sweep paris --rows rows.parquet", "sweep"),
    CommandCase("paper", solves=True),
    CommandCase("paper --out papers", "plot"),
    CommandCase("pend -T 1", "methods"),
    CommandCase("pend -T 1 --exact", solves=True),
]


def prepare(folder: Path) -> None:
    """Write the files that the commands read."""
    golden = load(golden_root() / "paris")
    rows = [
        f"{t!r},{x!r},{y!r}"
        for t, x, y in zip(golden.t.tolist(), golden.x.tolist(), golden.y.tolist(), strict=True)
    ]
    right = "\n".join(["t,x,y", *rows, ""])
    (folder / "suite").mkdir()
    for path in ("paris.csv", "suite/paris.csv"):
        (folder / path).write_text(right)
    (folder / "off.csv").write_text(right.replace("t,x,y", "t,y,x"))
    (folder / "transits.csv").write_text("t\n1\n")
    (folder / "rows.parquet").touch()


def main() -> int:
    """Print a line for each command, and how many faults there are; return the exit status."""
    present = [name for name in MODULES if find_spec(name) is not None]
    if present:
        print(f"This is no installation without extras: it has {', '.join(present)}.")
        return REFUSED
    cases = [*CASES, *(CommandCase(f"show {scene}") for scene in scene_ids())]
    if not HEYOKA:  # there is nothing of one's own to verify
        cases = [case for case in cases if not case.line.startswith("verify golden/")]
    untried = {name for names in GROUPS.values() for name in names} - {
        case.line.split()[0] for case in cases
    }
    faults = [f"{name}: no case runs this command" for name in sorted(untried)]
    with tempfile.TemporaryDirectory() as folder:
        prepare(Path(folder))
        for case in cases:
            start = time.perf_counter()
            fault = case.fault(ended(case.line, folder))
            outcome = f"refused, names {case.wanting}" if case.wanting else "ok"
            outcome = f"FAULT: {fault}" if fault else outcome
            print(
                f"{time.perf_counter() - start:6.1f} s  foucault {case.line}: {outcome}", flush=True
            )
            if fault:
                faults.append(f"{case.line}: {fault}")
    print(f"{len(cases)} commands, {len(faults)} faults", *faults, sep="\n")
    return 1 if faults else 0


def ended(line: str, folder: str) -> subprocess.CompletedProcess[str]:
    """Run a command in a folder, and return how it ended."""
    command = [sys.executable, "-m", "foucault", *shlex.split(line)]
    return subprocess.run(
        command, cwd=folder, capture_output=True, text=True, timeout=PATIENCE_S, check=False
    )


if __name__ == "__main__":
    sys.exit(main())
