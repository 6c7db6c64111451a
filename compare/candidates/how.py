"""Three lines of each language that write a candidate's file: the header, a row, and the command that saves them."""

from __future__ import annotations

from dataclasses import dataclass

from reference import InputError
from reference.errors import did_you_mean, in_words


@dataclass(frozen=True)
class Snippet:
    """Three lines that write a candidate's file.

    Attributes:
        once: prints the header, before the loop over time.
        each: prints a row, at each output time, the release at t = 0 included; t, x, y are doubles.
        shell: runs the program and keeps its output.
        comment: begins a comment in the language.
    """

    once: str
    each: str
    shell: str
    comment: str = "//"

    def text(self) -> str:
        """Return the lines with what each is for."""
        width = max(len(self.once), len(self.each)) + 2
        mark = self.comment
        return (
            f"{self.once:{width}}{mark} once, before the loop over time\n"
            f"{self.each:{width}}{mark} at every output time, at t = 0 too\n"
            f"{self.shell}\n"
        )


_PRINTF = r'printf("%.17g,%.17g,%.17g\n", t, x, y);'

SNIPPETS = {
    "c": Snippet(r'printf("t,x,y\n");', _PRINTF, "./program > mine.csv"),
    "c++": Snippet(
        r'std::cout << "t,x,y\n" << std::setprecision(17);',
        r'std::cout << t << "," << x << "," << y << "\n";',
        "./program > mine.csv",
    ),
    "fortran": Snippet(
        "print '(a)', 't,x,y'", "print '(*(es25.17e3, :, \",\"))', t, x, y", "./program > mine.csv", "!"
    ),
    "go": Snippet(r'fmt.Println("t,x,y")', r'fmt.Printf("%.17g,%.17g,%.17g\n", t, x, y)', "./program > mine.csv"),
    "java": Snippet(
        'System.out.println("t,x,y");', 'System.out.println(t + "," + x + "," + y);', "java Program > mine.csv"
    ),
    "javascript": Snippet('console.log("t,x,y");', "console.log([t, x, y].join());", "node program.js > mine.csv"),
    "julia": Snippet('println("t,x,y")', 'println(t, ",", x, ",", y)', "julia program.jl > mine.csv", "#"),
    "matlab": Snippet(
        r"f = fopen('mine.csv', 'w'); fprintf(f, 't,x,y\n');",
        r"fprintf(f, '%.17g,%.17g,%.17g\n', t, x, y);",
        "fclose(f);",
        "%",
    ),
    "octave": Snippet(
        r"printf('t,x,y\n');", r"printf('%.17g,%.17g,%.17g\n', t, x, y);", "octave program.m > mine.csv", "%"
    ),
    "python": Snippet('print("t,x,y")', 'print(t, x, y, sep=",")', "python program.py > mine.csv", "#"),
    "numpy": Snippet(
        "rows = np.column_stack([t, x, y])",
        'np.savetxt("mine.csv", rows, delimiter=",", header="t,x,y")',
        "python program.py",
        "#",
    ),
    "r": Snippet(
        r'cat("t,x,y\n")', r'cat(sprintf("%.17g,%.17g,%.17g\n", t, x, y))', "Rscript program.R > mine.csv", "#"
    ),
    "rust": Snippet('println!("t,x,y");', 'println!("{t},{x},{y}");', "./program > mine.csv"),
}
_OTHER_NAMES = {
    "cpp": "c++", "cxx": "c++", "js": "javascript", "node": "javascript", "typescript": "javascript",
    "ts": "javascript", "py": "python", "f90": "fortran", "jl": "julia", "rs": "rust", "golang": "go", "scipy": "numpy",
}  # fmt: skip


def how(language: str) -> str:
    """Return the three lines for a language, and what a column means.

    Raises:
        InputError: the language is not known.
    """
    word = language.strip().lower()
    snippet = SNIPPETS.get(_OTHER_NAMES.get(word, word))
    if snippet is None:
        raise InputError("--how", language, in_words([*SNIPPETS]), did_you_mean(word, [*SNIPPETS], "Any text will do."))
    about = (
        "t in s; x east and y north of the suspension, in m; z, vx, vy, vz too if there: z up, so that it is negative\n"
        "below. Any times will do. Then: foucault score paris mine.csv, or have it run by --run 'COMMAND'."
    )
    return f"{snippet.text()}\n{about}"
