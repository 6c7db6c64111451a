"""Compiled libraries: the folder and version of their headers, and what they write to stdout and stderr.

Looked into are the folders of the variables CPATH and CPLUS_INCLUDE_PATH, which compilers obey as
well, then this Python's environment, then the system. What they write is captured below Python's
own streams, but only in a process that was started to run methods, as descriptors belong to the
whole process: in a user's process libraries print where they like.
"""

from __future__ import annotations

import ctypes
import os
import re
import shlex
import shutil
import sys
import sysconfig
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

SYSTEM = ("/usr/local/include", "/usr/include", "/opt/homebrew/include")

isolated = False  # set in a process that was started to run methods


@dataclass(frozen=True)
class Library:
    """A library of C or C++.

    Attributes:
        name: as its authors write it.
        header: file that a program includes first.
        version_file: the header that holds its version, in quotes after `version_word`.
        version_word: the macro.
        brings: what installs it.
    """

    name: str
    header: str
    version_file: str
    version_word: str
    brings: str

    @property
    def folder(self) -> Path | None:
        """The folder of its headers; None if it is not installed."""
        return next(
            (folder for folder in include_folders() if (folder / self.header).is_file()), None
        )

    @property
    def missing(self) -> str | None:
        """Return None if programs that use it can be compiled here, otherwise what is missing and how to install it."""
        if compiler() is None:
            return "not installed: a C++ compiler, which the variable CXX may name"
        return (
            None if self.folder else f"not installed: {self.header} of {self.name} ({self.brings})"
        )

    @property
    def version(self) -> str | None:
        """Return its version according to its headers; None if it is not installed."""
        if self.folder is None:
            return None
        text = (self.folder / self.version_file).read_text(errors="replace")
        match = re.search(rf'#\s*define\s+{self.version_word}\s+"([^"]+)"', text)
        return match[1].replace("_", ".") if match else "unknown"


def compiler() -> list[str] | None:
    """Return the command line of the C++ compiler, split into words; None if no compiler is found."""
    words = shlex.split(os.environ.get("CXX", "")) or ["c++"]
    return words if shutil.which(words[0]) else None


def include_folders() -> list[Path]:
    """Return the folders in which headers are looked for."""
    named = [os.environ.get(name, "").split(os.pathsep) for name in ("CPATH", "CPLUS_INCLUDE_PATH")]
    python = [
        Path(sys.prefix) / "include",
        Path(sysconfig.get_path("purelib")) / "libboost_headers" / "include",
    ]
    return [*(Path(word) for words in named for word in words if word), *python, *map(Path, SYSTEM)]


def library_folders() -> list[Path]:
    """Return the folders of shared libraries that a compiler, or a compiled program, does not search by default."""
    named = os.environ.get("LIBRARY_PATH", "").split(os.pathsep)
    return [*(Path(word) for word in named if word), Path(sys.prefix) / "lib"]


BOOST = Library(
    "Boost",
    "boost/numeric/odeint.hpp",
    "boost/version.hpp",
    "BOOST_LIB_VERSION",
    "apt install libboost-dev, or pip install 'foucault-reference[methods-native]'",
)
GSL = Library(
    "GSL",
    "gsl/gsl_odeiv2.h",
    "gsl/gsl_version.h",
    "GSL_VERSION",
    "apt install libgsl-dev",
)
SUNDIALS = Library(
    "SUNDIALS",
    "sundials/sundials_context.h",  # since version 6
    "sundials/sundials_config.h",
    "SUNDIALS_VERSION",
    "apt install libsundials-dev, 6 or newer",
)


def quoted(output: bytes | bytearray) -> str:
    """Return what a library printed on one line, cut to 300 characters, to be quoted in a message."""
    return " ".join(output.decode(errors="replace").split())[:300]


@contextmanager
def captured() -> Iterator[bytearray]:
    """Redirect the file descriptors of stdout and stderr to a file while a library runs; one at a time.

    What other threads print meanwhile is captured too. In a user's process nothing is. All of it is
    in what is yielded when the context has ended.
    """
    output = bytearray()
    if not isolated:
        yield output
        return
    with tempfile.TemporaryFile() as handle:
        sys.stdout.flush()
        sys.stderr.flush()
        originals = [(descriptor, os.dup(descriptor)) for descriptor in (1, 2)]
        try:
            for descriptor, _ in originals:
                os.dup2(handle.fileno(), descriptor)
            yield output
        finally:
            ctypes.CDLL(None).fflush(None)  # empties the buffers of C's own streams
            for descriptor, original in originals:
                os.dup2(original, descriptor)
                os.close(original)
            handle.seek(0)
            output += handle.read()
