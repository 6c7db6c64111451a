"""Where a library's headers are here, and of which version they are.

Looked into are the folders of the variables CPATH and CPLUS_INCLUDE_PATH, which compilers obey as well, then this
Python's environment, then the system.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import sys
import sysconfig
from dataclasses import dataclass
from pathlib import Path

SYSTEM = ("/usr/local/include", "/usr/include", "/opt/homebrew/include")


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
        """The folder of its headers; None if they are not here."""
        return next((folder for folder in include_folders() if (folder / self.header).is_file()), None)

    @property
    def missing(self) -> str | None:
        """Return None if programs that use it can be compiled here, otherwise what is missing and what brings it."""
        if compiler() is None:
            return "not installed: a C++ compiler, which the variable CXX may name"
        return None if self.folder else f"not installed: {self.header} of {self.name} ({self.brings})"

    @property
    def version(self) -> str | None:
        """Return its version as the headers have it; None if they are not here."""
        if self.folder is None:
            return None
        text = (self.folder / self.version_file).read_text(errors="replace")
        match = re.search(rf'#\s*define\s+{self.version_word}\s+"([^"]+)"', text)
        return match[1].replace("_", ".") if match else "unknown"


def compiler() -> list[str] | None:
    """Return the words that call the C++ compiler; None if there is none."""
    words = shlex.split(os.environ.get("CXX", "")) or ["c++"]
    return words if shutil.which(words[0]) else None


def include_folders() -> list[Path]:
    """Return the folders in which headers are looked for."""
    named = [os.environ.get(name, "").split(os.pathsep) for name in ("CPATH", "CPLUS_INCLUDE_PATH")]
    python = [Path(sys.prefix) / "include", Path(sysconfig.get_path("purelib")) / "libboost_headers" / "include"]
    return [*(Path(word) for words in named for word in words if word), *python, *map(Path, SYSTEM)]


def library_folders() -> list[Path]:
    """Return the folders of shared libraries that a compiler does not look into by itself, or a program does not."""
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
