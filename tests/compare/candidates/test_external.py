"""Run somebody's program: placeholders are filled in, time and output are limited, and no process is left running."""

from __future__ import annotations

import os
import resource
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

import mpmath
import pytest
from interruption import PATIENCE_S, gone_within, interrupted
from places import ROOT
from small_scenes import make_scene

from compare.candidates.external import MARK, arguments, placeholders, run_program, timed
from reference import InputError


def python(code: str) -> list[str]:
    return [sys.executable, "-c", code]


def alive(pid: int) -> bool:
    """Whether a process runs; one that is dead and waits for its parent does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    except FileNotFoundError:
        return False


def ends_within(pid: int, seconds: float) -> bool:
    for _ in range(int(seconds / 0.05)):
        if not alive(pid):
            return True
        time.sleep(0.05)
    return False


def children_s() -> float:
    """CPU seconds of all children of this process that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def test_placeholders_are_the_scenes_own_words(paris):
    words = arguments(
        "prog {x0} --l={length} '{t_end} s' {latitude} {vx0} {inverse_flattening}", paris
    )
    assert words == ["prog", "0.3", "--l=67", "86400 s", "48.846111", "0.0", "298.257223564"]


def test_what_a_scene_gives_in_angles_is_also_there_in_metres():
    scene = make_scene(
        pendulum={"length": "2"}, release={"angle": "90", "azimuth": "0", "azimuth_rate": "90"}
    )
    known = placeholders(scene)
    assert (known["angle"], known["azimuth_rate"], known["angle_rate"]) == ("90", "90", "0")
    assert float(known["x0"]) == 2.0
    assert float(known["vy0"]) == pytest.approx(3.141592653589793, rel=1e-15)
    assert float(known["z0"]) == pytest.approx(0.0, abs=1e-15)


def test_numbers_that_follow_from_a_scene_are_filled_in_for_a_program_with_more_digits(paris):
    """A program in quadruple precision is judged by the decimal inputs, so they must not be doubles."""
    with mpmath.workdps(60):
        x0, y0 = mpmath.mpf("0.3"), mpmath.mpf("0.4")
        z0 = -mpmath.sqrt(67**2 - x0**2 - y0**2)
        assert abs(mpmath.mpf(placeholders(paris)["z0"]) - z0) < 1e-34 * 67


def test_no_shell_is_between(paris):
    assert arguments("echo $HOME ';' rm '*'", paris) == ["echo", "$HOME", ";", "rm", "*"]
    assert arguments("sh -c './a | ./b > c' '|' \\> it\\'s", paris) == [
        "sh",
        "-c",
        "./a | ./b > c",
        "|",
        ">",
        "it's",
    ]


def test_braces_that_are_no_placeholder_stay_and_doubled_ones_too(paris):
    assert arguments("awk '{print $1}' {{x0}} {x0}", paris) == ["awk", "{print $1}", "{x0}", "0.3"]


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("", "a command"),
        ("prog 'open", "balanced quotes"),
        ("prog {x1}", r"one of {x0}, {y0}"),
        ("prog {x1}", r"{grid_step}, {setting}"),
        ("prog {X0}", r"got '{X0}'"),
        ("prog {x0} | tr ' ' ,", r"without \|\. The command is run without a shell"),
        ("prog > out.csv", "without >"),
        ("prog 2>&1", "without 2>&1"),
        ("make && ./prog", "without &&"),
    ],
)
def test_a_command_that_cannot_be_filled_in_is_refused(paris, command, words):
    with pytest.raises(InputError, match=words) as caught:
        arguments(command, paris)
    assert caught.value.field == "--run"


def test_output_and_cpu_time_come_back():
    busy = "import time; b = time.process_time()\nwhile time.process_time() < b + 0.2: pass\nprint('t,x,y')"
    before, begun = children_s(), time.monotonic()
    output, cpu, wall = run_program(python(busy))
    with output:
        assert output.read() == b"t,x,y\n"
    assert 0.2 < cpu <= children_s() - before + 1e-6  # the kernel's own count, in microseconds
    assert 0 < wall <= time.monotonic() - begun


def test_children_count_in_the_cpu_time():
    busy = "import time\\nb = time.process_time()\\nwhile time.process_time() < b + 0.3: pass"
    code = f"import subprocess, sys; subprocess.run([sys.executable, '-c', \"{busy}\"])"
    output, cpu, _ = run_program(python(code))
    output.close()
    assert cpu > 0.3


def test_the_program_gets_no_input():
    output, _, _ = run_program(python("import sys; print(repr(sys.stdin.read()))"))
    with output:
        assert output.read() == b"''\n"


def test_a_program_that_is_not_there_is_said():
    with pytest.raises(InputError, match="a program that can be started"):
        run_program(["./no/such/program"])


def test_a_failure_is_said_with_the_end_of_what_it_wrote():
    code = "import sys; sys.stderr.write('x' * 5000 + ' the reason'); sys.exit(3)"
    with pytest.raises(InputError, match=r"exit status 3 .* the reason$") as caught:
        run_program(python(code))
    assert len(str(caught.value)) < 800


def test_a_signal_is_a_failure_too():
    with pytest.raises(InputError, match="exit status -11"):
        run_program(python("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)"))


PARENT = """
import signal, subprocess, sys
child = subprocess.Popen([sys.executable, "-c", "import signal; signal.pause()"])
open(sys.argv[1], "w").write(str(child.pid))
{then}
"""


def parent(tmp_path, then):
    note = tmp_path / "pid"
    return [sys.executable, "-c", PARENT.format(then=then), str(note)], note


def test_a_timeout_ends_the_program_and_its_children(tmp_path):
    words, note = parent(tmp_path, "signal.pause()")
    with pytest.raises(InputError, match=r"ends within 4 s \(--timeout\)"):
        run_program(words, timeout_s=4)
    assert ends_within(int(note.read_text()), PATIENCE_S)


def test_what_a_program_leaves_running_is_ended(tmp_path):
    words, note = parent(tmp_path, "print('done')")
    output, _, _ = run_program(words)
    output.close()
    assert ends_within(int(note.read_text()), PATIENCE_S)


DAEMON = """
import os, signal, sys, time
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        with open(sys.argv[1], "w") as note:
            note.write(f"{os.getpid()} {os.getsid(0)}")
        signal.pause()
    os._exit(0)
os.wait()
while not (os.path.exists(sys.argv[1]) and open(sys.argv[1]).read()):
    time.sleep(0.01)
"""


@pytest.mark.parametrize(("then", "late"), [("signal.pause()", True), ("print('done')", False)])
def test_what_forks_into_a_session_of_its_own_is_ended_as_well(tmp_path, then, late):
    note = tmp_path / "pid"
    words = [*python(DAEMON + then), str(note)]
    if late:
        with pytest.raises(InputError, match="--timeout"):
            run_program(words, timeout_s=4)
    else:
        run_program(words)[0].close()
    pid, session = map(int, note.read_text().split())
    assert session != os.getsid(0)
    assert not alive(pid)  # at once: nothing of it runs on when this returns


def test_nobody_elses_processes_are_ended_with_a_program():
    with subprocess.Popen(
        python("import signal; signal.pause()"), start_new_session=True
    ) as bystander:
        run_program(python("print(1)"))[0].close()
        assert alive(bystander.pid)
        bystander.kill()


def test_a_program_within_a_program_has_the_marks_of_both(monkeypatch):
    monkeypatch.setenv(MARK, "outer")
    output, _, _ = run_program(python(f"import os; print(os.environ[{MARK!r}])"))
    with output:
        outer, inner = output.read().split()
    assert outer == b"outer"
    assert len(inner) == 32


# a file with a hole, so that no disk is filled
TOO_MUCH = "import os, time; os.pwrite({stream}, b'0,0,0', 1 << 30); time.sleep({then})"


@pytest.mark.parametrize("stream", [1, 2], ids=["stdout", "stderr"])
def test_too_much_output_ends_the_program(stream):
    with pytest.raises(InputError, match="at most 1073741824 bytes of output"):
        run_program(python(TOO_MUCH.format(stream=stream, then=60)))


def test_too_much_output_counts_of_a_program_that_has_ended():
    with pytest.raises(InputError, match="bytes of output"):
        run_program(python(TOO_MUCH.format(stream=1, then=0)))


def test_repeats_are_timed_after_a_warm_up(tmp_path):
    note = tmp_path / "runs"
    output, took = timed(python(f"open({str(note)!r}, 'a').write('x'); print(1)"), repeats=2)
    output.close()
    assert note.read_text() == "xxx"
    assert (took.runs, took.warm) == (2, True)
    assert took.spread >= 0
    assert took.cpu_s > 0
    output, took = timed(python("print(1)"), repeats=0)
    output.close()
    assert (took.runs, took.warm, took.spread) == (1, False, 0.0)  # nothing warmed it up


@pytest.mark.parametrize(
    "number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.long), signal.SIGHUP]
)
def test_interrupted_nothing_of_the_program_runs_on(tmp_path, number):
    words, note = parent(tmp_path, "signal.pause()")
    command = ["score", "paris", "--run", shlex.join(words)]
    status, err, group = interrupted(
        command, lambda *_: note.exists() and note.read_text() != "", number
    )
    assert status == 128 + number
    assert b"Traceback" not in err
    if number == signal.SIGINT:
        assert err == b"foucault: stopped; the program was ended\n"
    assert ends_within(int(note.read_text()), PATIENCE_S)
    assert gone_within(group, PATIENCE_S)


@pytest.mark.skipif(
    not Path("/proc/self/environ").exists(), reason="what left the group is found in /proc"
)
@pytest.mark.parametrize(
    "program", [PARENT.format(then="signal.pause()"), DAEMON + "signal.pause()"]
)
def test_killed_it_takes_the_program_with_it(tmp_path, program):
    """Nothing can be done on SIGKILL, such as that of a server which is out of memory."""
    note = tmp_path / "pid"
    begin = "import os, sys; open(sys.argv[1] + '.leader', 'w').write(str(os.getpid()))\n"
    command = ["score", "paris", "--run", shlex.join([*python(begin + program), str(note)])]
    status, _, group = interrupted(
        command, lambda *_: note.exists() and note.read_text() != "", signal.SIGKILL
    )
    assert status == -signal.SIGKILL
    leader, child = int((tmp_path / "pid.leader").read_text()), int(note.read_text().split()[0])
    assert ends_within(leader, PATIENCE_S) and ends_within(child, PATIENCE_S)
    assert gone_within(group, PATIENCE_S)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_script_of_ones_own_that_is_ended_ends_the_program_it_runs(tmp_path, number):
    """As a method in C is run from Python, without the command line, which turns signals into exceptions itself."""
    words, note = parent(tmp_path, "signal.pause()")
    script = f"from compare.candidates.external import run_program; run_program({words!r})"
    with subprocess.Popen(
        [sys.executable, "-c", script], cwd=ROOT, stderr=subprocess.DEVNULL
    ) as process:
        deadline = time.monotonic() + PATIENCE_S
        while not (note.exists() and note.read_text()):
            assert process.poll() is None and time.monotonic() < deadline
            time.sleep(0.02)
        process.send_signal(number)
        assert process.wait(PATIENCE_S) == 128 + number
    assert ends_within(int(note.read_text()), PATIENCE_S)
