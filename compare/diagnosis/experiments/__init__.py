"""A program that is run again with other numbers: what each run isolates, and what explains the files of all."""
