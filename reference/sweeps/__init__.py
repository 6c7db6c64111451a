"""Many scenes at once: `reference.sweep`, in memory or into a folder, on the cores of a machine or a cluster.

- `sweep`: the functions; `swept`: what they return; `request`: what was asked, checked.
- `values`: rows of exact values, and `axes`: from words or files; `row_constants`: what an engine takes.
- `part`: rows solved side by side; `estimate`: their errors; `promote`: rows that the solver solves, or solves again.
- `row`: the columns; `parquet`, `store`: the folder of a sweep.
- `driver`: parts run on workers that may die; `local`, `cluster`: these workers.
"""
