"""An atlas, made once, of the datasets of Paris, of a short scene without a golden function and of one with it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

import reference
from foucault import commands
from reference.scenes.shipped import golden_root


@pytest.fixture(scope="session")
def atlas(tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("matplotlib")
    pytest.importorskip("flint")
    folder = tmp_path_factory.mktemp("atlas")
    data, out = folder / "data", folder / "pages"
    data.mkdir()
    for name in ("paris", "paris.binary64"):
        (data / name).symlink_to(golden_root() / name)
    short = reference.load_scene("hard", ["run.t_end=5", "run.digits=10", "run.level=computed"])
    reference.write(reference.solve(short), data / "hard")
    circling = reference.load_scene(
        "conical", ["inputs=binary64", "run.digits=12", "run.t_end=120"]
    )
    made = reference.solve(circling, level="enclosed", engine="limbs", function=True)
    reference.write(made, data / "conical.binary64")
    studies = folder / "studies"  # one row of one study: all of them are read by tests of their own
    studies.mkdir()
    row = {
        "method": "rk4",
        "formulation": "plane",
        "setting": 0.1,
        "kind": "step",
        "inputs": "binary64",
    }
    row |= {"status": "ok", "error_m": 1e-4, "cpu_s": 0.1}
    (studies / "paris.json").write_text(
        json.dumps({"scene": "paris", "t_end": 86400.0, "rows": [row]})
    )
    words = ["atlas", "--data", data, "--out", out, "--studies", studies]
    words += ["--files", "https://example.org/golden/", "--json"]
    done = CliRunner().invoke(commands(), list(map(str, words)), catch_exceptions=False)
    told = {page["page"]: page["bytes"] for page in json.loads(done.stdout)["pages"]}
    assert told == {
        path.name: path.stat().st_size for path in out.iterdir() if path.name != "SHA256SUMS"
    }
    return out
