"""Files with hostile names in a suite: every form for CI servers stays what it is, and none of them is a command."""

from __future__ import annotations

import re
from xml.etree import ElementTree

NAMES = [
    "<script>alert(1)<", 'a"onload="alert(1)', "=cmd|calc", "@SUM(1)", "-2+3", "+1+1", "\x1b[31mred",
    "\x1b]0;title\x07", "a\nb", "a\r\n::error::injected", "::error::x", "::stop-commands::tok", "a%0A::error::x",
    "##[error]x", "|pipe|x|",
    "`tick`![i](http:x)", "\u202egpj", "\ufffe", "\uffff", "nbsp\u00a0x", "x]]>y", "<!--<script>", "tab\tx", "{{7*7}}",
    "${7*7}", "%s%n", "at_rest", "a" * 200, "'; DROP", "&lt;b&gt;", b"\xff\xfe".decode("utf-8", "surrogateescape"),
    "\x7f\x9b31m", "\u2028line",
]  # fmt: skip


def commands(out):
    """The workflow commands that GitHub's runner finds on stdout: it takes none while they are stopped."""
    found, token = [], None
    for line in re.split(r"\r\n|[\r\n]", out):
        name = match[1] if (match := re.match(r"\s*::([\w-]+)", line)) else "##" if "##[" in line else None
        if token is not None:
            token = None if line == f"::{token}::" else token
        elif name == "stop-commands":
            token = line.removeprefix("::stop-commands::")
        elif name is not None:
            found.append(line)
    return found


def test_no_name_is_a_command_and_every_form_is_well_formed(foucault, tmp_path, monkeypatch, tally):
    folder, junit, summary = tmp_path / "suite", tmp_path / "junit.xml", tmp_path / "summary.md"
    folder.mkdir()
    for name in NAMES:
        (folder / f"{name}.csv").write_text("t,x,y\n0,0,0\n60,0,0\n")
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(summary))
    monkeypatch.chdir(folder)  # so that lines begin with the names
    words = ("--suite", ".", "--out", tmp_path / "page", "--junit", junit, "--github", "--no-diagnosis")
    status, out, err = foucault("score", *words)
    assert status == 2 and "Traceback" not in err
    assert "::error::x.csv was not judged" in out
    annotations = commands(out)
    assert len(annotations) == len(NAMES)
    assert all(re.match(r"::error (file=[^:,]*,)?title=[^:,]*::", line) for line in annotations)
    assert not re.search(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u202e]", out)
    assert len(list(ElementTree.parse(junit).iter("testcase"))) == len(NAMES)
    text = re.sub(r"```.*?```", "", summary.read_text(), flags=re.S)
    rows = [line for line in text.splitlines() if line.startswith("|")]
    assert len(rows) == len(NAMES) + 2 and {len(re.findall(r"(?<!\\)\|", row)) for row in rows} == {7}
    outside = re.sub(r"`[^`\n]*`", "", text)
    assert not re.search(r"<(?!/?details>|/?summary>)|^\|.*!\[", outside, re.M)
    page = (tmp_path / "page/index.html").read_text()
    assert "<script>alert" not in page and "<!--<" not in page and 'a"onload' not in page
    tally(f"hostile names: {len(NAMES)}, no command among {len(annotations)} annotations")
