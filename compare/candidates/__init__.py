"""Read the candidates that are judged: a program's output in any of the formats, or the program itself, run here."""
