"""Change one statement of docs/theorem at a time: does Coq still accept the proofs?

    python tests/theorem_mutants.py              some minutes
    python tests/theorem_mutants.py "(4.3)"      only those with this in their reason

The changes are in docs/theorem/mutations.toml. A change that is still proved shows slack in a statement. It is listed,
and the status is 1 if the file does not say why the statement leaves it.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "helpers"))
import theorem


def main(part: str = "") -> int:
    """Try every change whose reason contains `part`; return the status."""
    unexplained = 0
    with tempfile.TemporaryDirectory() as folder:
        base = Path(folder) / "base"
        base.mkdir()
        for name in theorem.order():
            shutil.copy(theorem.THEOREM / f"{name}.v", base)
            start = time.perf_counter()
            done = theorem.compile_file(name, base)
            if done.returncode != 0:
                print(f"{name}.v does not compile as it is: {done.stderr}", file=sys.stderr)
                return 2
            print(f"{name}.v compiles, {time.perf_counter() - start:.1f} s", flush=True)

        for change in [change for change in theorem.changes() if part in change.why]:
            failing = theorem.refused_in(change, base, Path(folder))
            if failing is None:
                unexplained += not change.slack
                verdict = f"STILL PROVED, {change.slack or 'and mutations.toml does not say why'}"
            else:
                verdict = f"refused in {failing}.v"
            print(f"{change.file}: {change.why}: {verdict}", flush=True)
    return int(unexplained > 0)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
