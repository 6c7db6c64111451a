"""Many scenes at once: `reference.sweep`, in memory or into a folder, on local cores or a cluster.

- `sweep`: the functions, and what they return; `request`: the request of a sweep, checked.
- `axes`: rows of exact values, from words or files; `row_constants`: what an engine takes.
- `part`: rows solved side by side; `estimate`: their errors; `highest_points`: frequency and
  precession of rows.
- `promote`: rows that the solver solves, or solves again; `scene_swing`: a scene as a single row.
- `parquet`: the columns, and files of them; `store`: the folder of a sweep.
- `driver`: parts run on workers that may die, on this machine; `cluster`: on others.
"""
