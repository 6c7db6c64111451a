"""A dataset in the making, for hostile ones: changed stage by stage, with hashes, seal and what follows made to fit."""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import Any

from reference.dataset.manifest import MANIFEST, Manifest
from reference.dataset.place import dataset_id
from reference.dataset.record import Making, command, following, invariant_drift
from reference.dataset.render import derived_texts
from reference.dataset.sheets import GRID_HEADER, TRANSITS_HEADER, Sheet, scene_inputs
from reference.errors import FoucaultError
from reference.model.start import Start
from reference.numbers.columns import GRID, POSITION, VELOCITY
from reference.numbers.precision import GUARD_BITS, bits_of, fixed_decimal, rounded_up, to_fraction
from reference.scenes.scene import Scene, parse_scene
from reference.solver.rounding import exact_decimals

MADE_UP_ROWS = 1000


@dataclass
class Draft:
    """A dataset in the making.

    Attributes:
        document: of `manifest.json`, still without hashes and seal.
        texts: the other files.
        late: changes of the document after the hashes, before the seal.
        raw: changes of the manifest's bytes, after the seal.
        on_disk: changes of the folder, when everything is written.
    """

    document: dict[str, Any]
    texts: dict[str, bytes]
    late: list[Callable[[dict[str, Any]], object]] = field(default_factory=list)
    raw: list[Callable[[bytes], bytes]] = field(default_factory=list)
    on_disk: list[Callable[[Path], object]] = field(default_factory=list)

    @classmethod
    def of(cls, folder: Path) -> Draft:
        """Return the draft of a dataset."""
        texts = {path.name: path.read_bytes() for path in folder.iterdir()}
        return cls(json.loads(texts.pop(MANIFEST)), texts)

    def write(self, folder: Path) -> None:
        """Write the dataset to a new folder."""
        folder.mkdir()
        self.document["files"] = {name: record for name, record in self.document["files"].items() if name in self.texts}
        for name, data in self.texts.items():
            (folder / name).write_bytes(data)
            self.document["files"][name] = {"bytes": len(data), "sha256": hashlib.sha256(data).hexdigest()}
        for change in self.late:
            change(self.document)
        self.document["seal"] = ""
        self.document["seal"] = hashlib.sha256(_text(self.document)).hexdigest()
        data = _text(self.document)
        for edit in self.raw:
            data = edit(data)
        (folder / MANIFEST).write_bytes(data)
        for change in self.on_disk:
            change(folder)

    def sheet(self) -> Sheet:
        """Return the grid as it stands."""
        rows = [tuple(line.split(",")) for line in self.texts["grid.csv"].decode().splitlines()[1:]]
        return Sheet(GRID_HEADER, rows, {})

    def refit(self, scene: Scene | None = None) -> None:
        """Make the invariant and the page fit, where they can be computed at all."""
        try:
            scene = scene or self.scene()
            initial, drift = invariant_drift(scene, self.sheet())
            self.document["invariant"] = {"h_m2_s2": initial, "drift_m2_s2": drift}
            manifest = Manifest.model_validate({**self.document, "seal": "", "files": _PAGES})
            tables = {"grid.csv": self.sheet()}
            tables |= {"transits.csv": Sheet(TRANSITS_HEADER, [], {})} if "transits.csv" in self.texts else {}
            made = derived_texts(manifest, tables)
        except (FoucaultError, ArithmeticError, ValueError, LookupError):
            return
        self.texts |= {name: text.encode() for name, text in made.items()}

    def scene(self) -> Scene:
        """Return the scene that the document describes."""
        top = {key: self.document[key] for key in ("title", "source", "flags", "inputs")}
        return parse_scene({"id": self.document["id"].partition("+")[0], **top, **self.document["scene"]})

    def another_scene(self, *assignments: str, bound: str | None = None, rows: int | None = None) -> None:
        """Make a dataset of another scene, where the bob stays at its release; all that follows is made to fit.

        Args:
            assignments: section.key=value.
            bound: of every number; by default half a unit of its last digit.
            rows: of the grid, where they are not to be those of the scene.
        """
        named = self.scene().with_values(["run.level=computed", "run.transits=false", *assignments])
        inputs, digits = named.exact, named.run.digits
        count = rows or int(min(MADE_UP_ROWS, inputs.t_end / inputs.grid_step))
        times = (
            inputs.grid if count < MADE_UP_ROWS and rows is None else [inputs.t_end * k / count for k in range(count)]
        )
        numbers = [Fraction(text) for text in self.sheet().rows[0][1:]]
        with contextlib.suppress(FoucaultError):
            start = Start.of(inputs, bits_of(2 * digits) + GUARD_BITS)
            numbers = [to_fraction(start.ctx.mpf(part)) for part in (*start.position, *start.velocity)]
        places = {name: min(1000, digits) for name in GRID}
        decimals = {"t": min(1000, exact_decimals(tuple(times))), **places}
        state = [fixed_decimal(value, places[name]) for name, value in zip(GRID, numbers, strict=True)]
        sheet = Sheet(GRID_HEADER, [(fixed_decimal(t, decimals["t"]), *state) for t in times], {})
        follows = {name: self.document[name] for name in ("notes", "equations")}
        with contextlib.suppress(FoucaultError, ArithmeticError):
            made = following(named, "inertial", self.document["run"]["number"], sheet)
            follows = {"notes": made["notes"], "equations": made["equations"].model_dump()}
        bounds = {name: bound or rounded_up(Fraction(1, 2 * 10**place)) for name, place in places.items()}
        name = dataset_id(named)
        self.texts = {"grid.csv": sheet.csv().encode(), "certified.txt": b""}
        if named.run.transits:
            self.texts["transits.csv"] = (",".join(TRANSITS_HEADER) + "\n").encode()
        self.document.update(
            id=name,
            scene=scene_inputs(named),
            inputs=named.inputs,
            level="computed",
            digits=digits,
            decimals={"grid": decimals, "transits": {}},
            bounds={
                "position_m": max((bounds[name] for name in POSITION), key=Fraction),
                "velocity_m_s": max((bounds[name] for name in VELOCITY), key=Fraction),
                "transit_s": None,
                "grid": bounds,
                "transits": {},
            },
            counts={"grid": len(sheet.rows), "transits": 0, "possible": 0},
            transits="complete" if named.run.transits else "not asked for",
            cross_checks=[],
            command=command(named, name, Making(audit=False)),
            **follows,
        )
        self.refit(named)


def _text(document: dict[str, Any]) -> bytes:
    return (json.dumps(document, indent=1, ensure_ascii=False) + "\n").encode("utf-8", "surrogatepass")


_PAGES = {name: {"bytes": 0, "sha256": "0" * 64} for name in ("grid.csv", "certified.txt")}
