"""Reports of studies, stability runs and approximations: self-contained pages, pictures, tables, CSV and JSON."""
