"""What ships, made again in a process of its own, whose environment stands for another processor."""

from __future__ import annotations

import re
from ast import literal_eval
from collections.abc import Iterable
from hashlib import sha256
from typing import Any

# what leaves the order or the rounding of floating-point operations to the compiler, in LLVM's language
FREEDOMS = re.compile(r"\b(fast|reassoc|nsz|arcp|contract|afn|fmuladd)\b")
COUNTED = ("x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s", "transits", "t_first_s", "t_last_s")


def swept() -> list[str]:
    """Return what octet finds of eight latitudes, without what passes through arctan2 and arcsin."""
    import reference

    over = ["site.latitude=10:80:10"]
    rows = reference.sweep(
        reference.load_scene("paris", ["run.t_end=600"]), over=over, engine="octet"
    )
    return [f"{name} {rows[name].tolist()}" for name in COUNTED]


def confirmed() -> list[str]:
    """Return the hashes of the files of a dataset at the level confirmed, of two runs and no proof."""
    import reference
    from reference.dataset.render import render

    texts = render(
        reference.solve(reference.load_scene("paris"), t_end="600", digits=20, level="confirmed")
    )
    return [f"{file} {sha256(text.encode()).hexdigest()}" for file, text in texts.items()]


def made_again(name: str) -> dict[str, str | bytes]:
    """Return the files of a dataset that ships, made as `generate NAME` makes it."""
    import reference
    from reference.dataset.making import making_of
    from reference.dataset.place import default_folder
    from reference.dataset.render import render
    from reference.scenes.scene import load_scene

    scene_id, doubles, _ = name.partition(".binary64")
    scene = load_scene(scene_id, ["inputs=binary64"] if doubles else [])
    making = making_of(scene, name, default_folder(scene, name))
    return render(reference.solve(scene, **making.solve_options(scene)), name, tables=making.tables)


def shipped(name: str) -> dict[str, str | bytes]:
    """Return the files of a dataset that ships."""
    from reference.scenes.shipped import golden_root

    files = {path.name: path.read_bytes() for path in (golden_root() / name).iterdir()}
    return {name: data if name.endswith(".f64") else data.decode() for name, data in files.items()}


def differing(names: Iterable[str]) -> str:
    """Return the kind of processor that numba compiles for, and the scenes that do not come out as they ship."""
    import numba

    return (
        f"{numba.config.CPU_NAME}: {[name for name in names if made_again(name) != shipped(name)]}"
    )


def processor() -> str:
    """Return what numba writes on the code that it keeps for the processor of this process."""
    from numba.core.registry import cpu_target

    return repr(cpu_target.target_context.codegen().magic_tuple())


def translated(kept_for: str) -> list[str]:
    """Have numba take code that it keeps for another processor, and make instructions for its own from it.

    What numba keeps stands there in LLVM's language, too. Making that anew would take ten times as long, and it is the
    same for every processor as far as it leaves nothing to the compiler. Returns a list that grows: each function that
    was taken, and what it leaves.
    """
    from llvmlite import binding
    from numba.core.codegen import CPUCodegen, CPUCodeLibrary

    taken: list[str] = []
    honest = CPUCodeLibrary._unserialize.__func__

    def take(cls: Any, codegen: Any, kept: Any) -> Any:
        name, _, (_, bitcode) = kept
        freedoms = sorted({*FREEDOMS.findall(str(binding.parse_bitcode(bitcode)))})
        taken.append(f"{name} {freedoms}")
        return honest(cls, codegen, (name, "bitcode", bitcode))

    CPUCodeLibrary._unserialize = classmethod(take)
    CPUCodegen.magic_tuple = lambda _: literal_eval(kept_for)
    return taken
