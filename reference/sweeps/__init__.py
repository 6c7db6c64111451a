"""Many scenes at once: `reference.sweep`, in memory or into a folder, on the cores of a machine or a cluster.

- `sweep`: the functions; `swept`: what they return; `planning`: what was asked, checked; `request`: the result of that.
- `axes`, `lists`, `values`: what varies, as exact decimals, from words or files; `folding`: its constants and releases.
- `part`: rows solved side by side; `estimate`: their errors; `promote`, `isolated`: rows that the solver solves.
- `row`: the columns; `parquet`, `store`: the folder of a sweep.
- `driver`: parts run on workers that may die; `local`, `cluster`: these workers; `audit`: some rows solved again.
"""
