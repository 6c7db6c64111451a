"""A page in headless Chromium: what a script at its end tells."""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
import shutil
import subprocess

CHROMIUM = next(
    (
        path
        for name in ("chromium", "chromium-browser", "google-chrome")
        if (path := shutil.which(name))
    ),
    None,
)


def with_script(page, script):
    """Return a page with one more script, which its policy allows."""
    code = re.search("<script>(.*?)</script>", script, re.S)[1]
    digest = base64.b64encode(hashlib.sha256(code.encode()).digest()).decode()
    allowed = page.replace("script-src 'self'", f"script-src 'self' 'sha256-{digest}'", 1)
    return allowed.replace("</body>", script)


def in_browser(page, script, tmp_path, *flags, fragment=""):
    """Return what a script at the end of a page wrote, in a window as wide as a phone's.

    The page's time passes quickly while the worker works in ours.
    """
    path = tmp_path / "page.html"
    path.write_text(with_script(page.read_text(), script))
    done = subprocess.run(
        [CHROMIUM, *flags, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={tmp_path / 'profile'}",
         "--window-size=390,844", "--virtual-time-budget=100000000", "--dump-dom", path.as_uri() + fragment],
        capture_output=True, text=True, check=True, timeout=300,
    )  # fmt: skip
    return json.loads(html.unescape(re.search(r'<pre id="told">(.*?)</pre>', done.stdout, re.S)[1]))
