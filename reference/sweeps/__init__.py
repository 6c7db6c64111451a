"""Many scenes at once: `reference.sweep`, in memory or into a folder, on the cores of a machine or a cluster.

- `sweep`: the functions; `swept`: what they return; `planning`: what was asked, checked; `request`: the result of that.
- `values`: rows of exact values, by `axes` from words, by `lists` from files; `row_constants`: what an engine takes.
- `part`: rows solved side by side; `estimate`: their errors; `promote`: rows that the solver solves.
- `row`: the columns; `parquet`, `store`: the folder of a sweep.
- `driver`: parts run on workers that may die; `local`, `cluster`: these workers; `resolved`: some rows solved again.
"""
