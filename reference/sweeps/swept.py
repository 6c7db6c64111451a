"""A sweep that is done: its columns as arrays, in memory or read from its folder."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain
from typing import Any

import numpy as np

from ..errors import counted, unknown
from ..numbers.columns import Framed, data_frame
from ..status import Status
from ..system.imports import missing
from .axes import WORD_FIELDS
from .part import Part, Tally
from .promote import RowAudit
from .request import Request
from .store import TRANSITS, Store


@dataclass(frozen=True, repr=False)
class Swept(Framed):
    """A sweep that is done: its columns as arrays, in memory or read from its folder.

    Attributes:
        request: the sweep: the scene, what varies, what is computed.
        store: its folder, if it has one.
        solved: its rows, if it has no folder.
        tally: counts by status and costs, of the rows that were computed now if a sweep was
            resumed.
        audit: the findings of an audit, if there was one.
        compile_s: CPU seconds of compiling.
        audit_s: CPU seconds of the audit.
        wall_s: seconds from the start to the end.
    """

    request: Request
    store: Store | None = None
    solved: Part = field(default_factory=Part, repr=False)
    tally: Tally = field(default_factory=Tally)
    audit: RowAudit | None = None
    compile_s: float = 0.0
    audit_s: float = 0.0
    wall_s: float = 0.0

    def __len__(self) -> int:
        return self.request.table.count

    def __repr__(self) -> str:
        """Return the scene, and how many rows there are of each status."""
        counts = ", ".join(f"{count} {status}" for status, count in self.counts.items())
        return f"Swept({self.request.scene.id}: {counted(len(self), 'row')}, {counts}; {self.request.solved_by})"

    def to_pandas(self) -> Any:
        """Return the rows as a pandas.DataFrame: the values of the fields, then the columns.

        Raises:
            InputError: pandas is not installed.
        """
        return data_frame(self.columns())

    @cached_property
    def counts(self) -> dict[str, int]:
        """How many rows there are of each status."""
        counts = sum(map(Counter, self._statuses()), Counter[str]())
        return dict(sorted(counts.items()))

    @property
    def first_bad(self) -> int:
        """The first row whose status is not ok; there must be one."""
        statuses = chain.from_iterable(self._statuses())
        return next(row for row, status in enumerate(statuses) if status != Status.OK.value)

    def _statuses(self) -> Iterator[Any]:
        """Yield the status of every row; a folder is read part by part, which saves memory."""
        if self.store is None:
            yield self["status"]
            return
        for part in range(self.request.parts):
            yield self.store.read(["status"], parts=[part])["status"]

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the columns."""
        return tuple(column.name for column in self.request.columns)

    def columns(self, names: Iterable[str] | None = None) -> dict[str, Any]:
        """Return columns as arrays of shape (rows,), all if no names are given."""
        chosen = list(self.names if names is None else names)
        for name in chosen:
            if name not in self.names:
                raise unknown("column", name, "a column of this sweep", self.names, "")
        if self.store is not None:
            return self.store.read(chosen)
        return {name: self.solved.columns[name] for name in chosen}

    def __getitem__(self, name: str) -> Any:
        """Return one column, shape (rows,)."""
        return self.columns([name])[name]

    def grid(self, name: str) -> Any:
        """Return a column on the grid of the axes: a DataArray if xarray is installed.

        Without it, it is an array. For a list of rows it is the column itself.
        """
        table = self.request.table
        values = self[name].reshape(table.shape)
        if table.typed is None or missing(["xarray"]):
            return values
        import xarray

        coords = {
            key: list(texts) if key in WORD_FIELDS else np.array(texts, float)
            for key, texts in table.values.items()
        }
        return xarray.DataArray(values, coords=coords, dims=list(coords), name=name)

    def transits(self) -> dict[str, Any]:
        """Return row, t_s and direction of every transit, if they were wanted.

        Raises:
            InputError: they were not.
        """
        if not self.request.run_options.times:
            expected = "a sweep with --want transit-times"
            raise unknown("transits", "transits", expected, (), "Sweep again with it.")
        if self.store is None:
            return self.solved.transits
        return self.store.read(kind=TRANSITS)

    def rows(self, most: int | None = None) -> Iterator[dict[str, Any]]:
        """Yield the first rows as dictionaries by column, with Python values; None for a missing number."""
        columns = {name: values[:most].tolist() for name, values in self.columns().items()}
        for values in zip(*columns.values(), strict=True):
            row = dict(zip(columns, values, strict=True))
            # a NaN differs from itself
            yield {name: None if value != value else value for name, value in row.items()}
