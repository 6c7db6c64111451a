"""A sweep that is done: its columns as arrays, in memory or read from its folder."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import unknown
from ..status import Status
from ..system.imports import missing
from .axes import Grid
from .driver import Tally
from .promote import Audit
from .request import Request
from .values import TEXTS

if TYPE_CHECKING:
    from .store import Store


@dataclass(frozen=True)
class Swept:
    """A sweep that is done.

    Attributes:
        request: what was asked for.
        tally: counts by status and costs; of the rows that were computed now, where a folder was gone on with.
        audit: what solving a sample again has found, if it was done.
        store: its folder, if it has one.
        compile_s: CPU seconds of compiling.
        wall_s: seconds from the start to the end.
    """

    request: Request
    tally: Tally = field(default_factory=Tally)
    audit: Audit | None = None
    store: Store | None = None
    compile_s: float = 0.0
    wall_s: float = 0.0
    kept: dict[str, Any] = field(default_factory=dict, repr=False)
    listed: dict[str, Any] = field(default_factory=dict, repr=False)

    def __len__(self) -> int:
        return self.request.table.count

    @cached_property
    def counts(self) -> dict[str, int]:
        """How many rows there are of each status."""
        words, counts = np.unique(self["status"].astype(str), return_counts=True)
        return dict(zip(words.tolist(), counts.tolist(), strict=True))

    @property
    def first_bad(self) -> int:
        """The first row that is not ok; only where there is one."""
        return int(np.argmax(self["status"] != Status.OK.value))

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the columns."""
        return tuple(column.name for column in self.request.columns)

    def columns(self, names: Iterable[str] | None = None) -> dict[str, Any]:
        """Return columns as arrays of shape (rows,), all if no names are given; `pandas.DataFrame` takes them."""
        chosen = list(self.names if names is None else names)
        for name in chosen:
            if name not in self.names:
                raise unknown("column", name, "a column of this sweep", self.names, "")
        if self.store is not None:
            return self.store.read(chosen)
        return {name: self.kept[name] for name in chosen}

    def __getitem__(self, name: str) -> Any:
        """Return one column, shape (rows,)."""
        return self.columns([name])[name]

    def grid(self, name: str) -> Any:
        """Return a column on the grid of the axes: an xarray.DataArray where xarray is installed, else an array.

        Of a list of rows it is the column itself.
        """
        table = self.request.table
        values = self[name].reshape(table.shape)
        if not isinstance(table, Grid) or missing(["xarray"]):
            return values
        import xarray

        coords = {key: list(texts) if key in TEXTS else np.array(texts, float) for key, texts in table.values.items()}
        return xarray.DataArray(values, coords=coords, dims=list(coords), name=name)

    def transits(self) -> dict[str, Any]:
        """Return row, t_s and direction of every transit, if they were wanted.

        Raises:
            InputError: they were not.
        """
        if not self.request.wanted.times:
            raise unknown("transits", "transits", "a sweep with --want transit-times", (), "Sweep again with it.")
        return self.store.read(kind="transits") if self.store is not None else self.listed

    def rows(self, most: int | None = None) -> Iterator[dict[str, Any]]:
        """Yield the first rows, each as a mapping from column to Python value; None where there is no number."""
        count = len(self) if most is None else min(most, len(self))
        columns = {name: values[:count].tolist() for name, values in self.columns().items()}
        for i in range(count):
            yield {
                name: None if isinstance(values[i], float) and values[i] != values[i] else values[i]
                for name, values in columns.items()
            }
