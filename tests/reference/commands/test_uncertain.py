"""`--uncertain` in generate and show."""

import json

import lines
import pytest
from typer.testing import CliRunner

from reference.commands import app

BOX = ["--uncertain", "pendulum.length=±0.001", "--uncertain", "latitude=+-0.001"]


def run(*words):
    return CliRunner().invoke(app, [str(word) for word in words])


def test_generate_writes_ranges(tmp_path):
    done = run("generate", "paris", "--t-end", "120", *BOX, "--out", tmp_path / "out")
    assert done.exit_code == 0, done.output
    told = lines.unwrapped(done.output)
    assert "for every pendulum.length ±0.001 m site.latitude ±0.001 degrees grid 3 rows" in told
    assert "transits 14 level enclosed period 16.43" in told
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [
        "grid.csv",
        "ranges.json",
        "transits.csv",
    ]
    done = run("generate", "paris", "--t-end", "120", *BOX, "--out", tmp_path / "out", "--json")
    assert json.loads(done.stdout)["transits"] == 14


def test_show_tells_period_and_first_transits():
    done = run("show", "paris", "--set", "run.t_end=120", *BOX)
    shown = lines.part(done.output, "Ranges over 120 s for all values")
    assert "period 16.43" in shown
    assert "transit 1 8.2177" in shown
    assert "A transit is a turning point in x." in shown
    # the estimate stands first
    assert shown.index("estimate") < shown.index("proved")
    assert "Which input limits the period" in shown
    assert "pendulum.length ±0.001 m ±0.00012 s 99.6 %" in shown
    assert "pendulum.length m 0.1226" in shown
    ranges = json.loads(run("show", "paris", "--set", "run.t_end=120", *BOX, "--json").stdout)[
        "ranges"
    ]
    low, high = map(float, ranges["limits"]["pendulum.length"]["s_per_unit"])
    assert low < high < low + 1e-9
    assert low == pytest.approx(16.4356 / 2 / 67, rel=1e-4)  # of small swings
    assert sum(limit["share"] for limit in ranges["limits"].values()) == pytest.approx(1)
    assert [float(end) for end in ranges["first_transits_s"][0]] == pytest.approx(
        [8.2178, 8.2178], abs=3e-4
    )


@pytest.mark.parametrize(
    "words, status, told",
    [
        (["--uncertain", "length"], 2, "expected KEY=±WIDTH"),
        (["--uncertain", "length=1mm"], 2, "expected half of a width"),
        (["--uncertain", "lenght=±0.001"], 2, "an input on which the motion depends"),
        (
            ["--uncertain", "length=±1", "--uncertain", "length=±2"],
            2,
            "expected one width of length",
        ),
        ([*BOX, "--level", "confirmed"], 2, "enclosed, because inputs are uncertain"),
        ([*BOX, "--digits", "20"], 2, "has no effect while inputs are uncertain"),
        ([*BOX, "--function"], 2, "has no effect while inputs are uncertain"),
        ([*BOX, "--all"], 2, "with --all"),
        (["--uncertain", "x0=±3"], 3, "too uncertain: the proof reaches only t ="),
    ],
)
def test_what_is_wrong_is_told_and_nothing_is_written(tmp_path, words, status, told):
    scene = [] if "--all" in words else ["paris", "--t-end", "3600"]
    done = run("generate", *scene, *words, "--out", tmp_path / "out")
    assert done.exit_code == status or getattr(done.exception, "exit_status", None) == status
    assert told in done.output or told in str(done.exception)
    assert list(tmp_path.iterdir()) == []
