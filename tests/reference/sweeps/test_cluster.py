"""Sweeps on dask.distributed: lost workers cost nothing, a row that kills its worker is found, the bytes are equal."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
from dataclasses import replace
from pathlib import Path

import poisoned_sweep
import pytest
from interruption import PATIENCE_S, gone_within, interrupted, members

from reference import InputError, load_scene, load_sweep
from reference.sweeps.request import Settings
from reference.sweeps.sweep import checked_request, run

pytestmark = [
    pytest.mark.filterwarnings("ignore"),
    pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="kills processes"),
]
ROWS = 46


def asked(out):
    scene = load_scene("paris", ["run.t_end=30"])
    whole = checked_request(
        scene, ["site.latitude=-90:90:4"], None, out, Settings(audit=0, engine="heyoka")
    )
    return replace(whole, rows_per_part=8)


@pytest.fixture(scope="module", autouse=True)
def libraries():
    # here and not above, where whatever collects tests would wait for it
    pytest.importorskip("distributed")
    pytest.importorskip("pyarrow")


@pytest.fixture(scope="module")
def cluster(pytestconfig):
    """Workers in processes that are started again: one of them, as each costs seconds to start."""
    import dask
    import distributed

    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 1, "distributed.deploy.lost-worker-timeout": 1e7}),
        distributed.LocalCluster(
            n_workers=2 if pytestconfig.getoption("--long") else 1,
            threads_per_worker=1, dashboard_address=None, silence_logs=50,
        ) as cluster,
    ):  # fmt: skip
        yield cluster


def test_a_killed_worker_costs_nothing_and_the_bytes_are_those_of_one_thread(cluster, tmp_path):
    from reference.sweeps.cluster import on_cluster
    from reference.sweeps.driver import drive
    from reference.sweeps.store import Store

    here, there, killed, done = tmp_path / "here", tmp_path / "there", [], [0]
    run(asked(here), here, workers=1)
    request = asked(there)
    store = Store.begun(there, request)
    with on_cluster(request, there, cluster.scheduler_address) as executor:

        def report(rows: int) -> None:
            done[0] += rows
            if done[0] >= 16 and not killed:
                killed.extend(nanny.pid for nanny in cluster.workers.values())
                os.kill(killed[0], signal.SIGKILL)

        tally = drive(request, store.missing(), executor, store.save, report)
    assert killed
    assert tally.counts == {"ok": ROWS}
    assert done == [ROWS]
    parts = sorted(path.name for path in (here / "rows").iterdir())
    assert [path.name for path in sorted((there / "rows").glob("part-*"))] == parts
    assert all(
        (here / "rows" / name).read_bytes() == (there / "rows" / name).read_bytes()
        for name in parts
    )
    assert load_sweep(there).counts == {"ok": ROWS}


def test_if_the_scheduler_is_lost_what_is_done_stays_and_the_same_command_goes_on(tmp_path):
    import distributed

    from reference.sweeps.cluster import ClusterError

    folder = tmp_path / "out"
    with distributed.LocalCluster(
        n_workers=1,
        threads_per_worker=1,
        processes=False,
        protocol="tcp://",
        dashboard_address=None,
        silence_logs=50,
    ) as lost:

        def report(rows: int) -> None:
            if rows:
                lost.close()

        with pytest.raises(ClusterError, match="the same command resumes"):
            run(asked(folder), folder, cluster=lost.scheduler_address, report=report)
    done = len(list((folder / "rows").glob("part-*")))
    assert done > 0
    assert run(asked(folder), folder, workers=1).counts == {"ok": ROWS}


# thirty seconds of workers that start; test_store.py has the row by itself in every run
@pytest.mark.long
def test_a_row_that_kills_its_worker_crashes_alone(cluster, tmp_path, monkeypatch):
    from reference.sweeps import cluster as module

    monkeypatch.setattr(module, "compute", poisoned_sweep.compute)
    monkeypatch.setattr(cluster.scheduler, "allowed_failures", 0)
    swept = run(asked(tmp_path / "out"), tmp_path / "out", cluster=cluster.scheduler_address)
    assert swept.counts == {"crashed": 1, "ok": ROWS - 1}
    assert swept["status"][poisoned_sweep.POISON] == "crashed"
    assert "alone as well" in swept["reason"][poisoned_sweep.POISON]


def test_other_versions_are_refused_before_any_work(cluster, tmp_path, monkeypatch):
    from distributed import versions

    here = versions.get_package_info
    monkeypatch.setattr(versions, "get_package_info", lambda names: here(names) | {"heyoka": "1.0"})
    with pytest.raises(
        InputError, match=r"heyoka \d.* on tcp:.*, expected heyoka 1\.0, as on this machine"
    ):
        run(asked(tmp_path / "out"), tmp_path / "out", cluster=cluster.scheduler_address)
    assert list((tmp_path / "out/rows").iterdir()) == []


def test_a_worker_that_comes_later_with_other_versions_does_no_work(cluster):
    """It is asked with each part; here it is the client that has changed since it checked all."""
    from reference.sweeps.cluster import scheduler_at

    with scheduler_at(cluster.scheduler_address) as scheduler:
        assert scheduler.submit(abs, -1).result() == 1
        scheduler.versions["heyoka"] = "1.0"
        with pytest.raises(
            InputError, match=r"heyoka \d.* on tcp:.*, expected heyoka 1\.0, as on this machine"
        ):
            scheduler.submit(abs, -1).result()


@pytest.mark.parametrize(
    ("address", "said"),
    [
        ("here", r"tcp://HOST:PORT"),
        ("http://127.0.0.1:1", r"tcp://HOST:PORT"),
        ("local:none", r"local:N"),
        ("local:0", r"local:N"),
        # waits for 10 s
        pytest.param("tcp://127.0.0.1:1", "a scheduler that answers", marks=pytest.mark.long),
    ],
)
def test_a_wrong_address_is_named(tmp_path, address, said):
    with pytest.raises(InputError, match=said):
        run(asked(tmp_path / "out"), tmp_path / "out", cluster=address)


@pytest.mark.long
def test_a_scheduler_without_workers_is_named(tmp_path):
    import distributed

    with (
        distributed.LocalCluster(n_workers=0, dashboard_address=None, silence_logs=50) as empty,
        pytest.raises(InputError, match="a scheduler with workers"),
    ):
        run(asked(tmp_path / "out"), tmp_path / "out", cluster=empty.scheduler_address)


@pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl makes the certificate")
def test_a_cluster_that_is_started_here_leaves_nothing_behind_and_tls_is_dasks_own(
    tmp_path, monkeypatch
):
    import dask

    from reference.sweeps.cluster import scheduler_at

    key, certificate = str(tmp_path / "key.pem"), str(tmp_path / "certificate.pem")
    command = [
        "openssl",
        "req",
        "-x509",
        "-newkey",
        "rsa:2048",
        "-nodes",
        "-keyout",
        key,
        "-out",
        certificate,
    ]
    subprocess.run([*command, "-subj", "/CN=sweep", "-days", "2"], check=True, capture_output=True)
    names = [
        "ca-file",
        *(f"{who}.{what}" for who in ("client", "scheduler", "worker") for what in ("cert", "key")),
    ]
    given = {
        f"distributed.comm.tls.{name}": key if name.endswith("key") else certificate
        for name in names
    }
    encrypted, scratch = {"distributed.comm.require-encryption": True}, tmp_path / "scratch"
    scratch.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(scratch))
    with dask.config.set(encrypted | given), scheduler_at("local:1") as local:
        address = local.client.scheduler.address
        assert address.startswith("tls://127.0.0.1:")
        assert list(scratch.iterdir())
        with scheduler_at(address) as remote:
            assert remote.submit(sum, [1, 2]).result() == 3
        with (
            dask.config.set(dict.fromkeys(given)),
            pytest.raises(InputError, match="certificates in dask's configuration"),
            scheduler_at(address),
        ):
            pass
    assert not list(scratch.iterdir())
    with (
        dask.config.set(encrypted),
        pytest.raises(InputError, match="dask can start processes"),
        scheduler_at("local:1"),
    ):
        pass


def test_two_clusters_on_a_machine_do_not_warn_of_each_other(recwarn):
    from reference.sweeps.cluster import scheduler_at

    with scheduler_at("local:1"), scheduler_at("local:1"):
        pass
    assert not [warning for warning in recwarn if "already in use" in str(warning.message)]


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="counts processes in /proc")
def test_ctrl_c_prints_one_sentence_and_what_a_killed_sweep_left_is_removed(tmp_path, monkeypatch):
    """A terminal sends it to the workers too, here while they import what they need."""
    monkeypatch.setenv("TMPDIR", str(tmp_path / "tmp"))
    (tmp_path / "tmp").mkdir()
    out = str(tmp_path / "out")
    words = [
        "sweep",
        "paris",
        "--over",
        "latitude=0:90:0.05",
        "--t-end",
        "20000",
        "--engine",
        "heyoka",
    ]
    words += ["--audit", "0", "--cluster", "local:2", "--out", out]
    of_dask = (tmp_path / "tmp").glob
    interrupted(
        words, lambda *_: any(of_dask("*/dask-scratch-space")), signal.SIGKILL, whole_group=True
    )
    assert any(of_dask("*/dask-scratch-space"))
    both_workers = 4  # with the command itself, and what multiprocessing starts to clear up
    status, err, group = interrupted(
        words, lambda group, _: members(group) >= both_workers, whole_group=True
    )
    *notices, line = err.decode().splitlines()
    assert status == 130, err.decode()
    # how long it will take, on a slow machine
    assert all(": about " in notice for notice in notices)
    assert (
        line
        == f"foucault: stopped; finished rows are in {out}: `foucault sweep --out {out}` resumes"
    )
    assert gone_within(group, PATIENCE_S)
    assert not any(of_dask("*/dask-scratch-space"))
