"""The dialect of a text: what separates its fields, which mark its decimals have, how its times are written.

A text is taken apart in one way from its first row to its last. `split` gives the fields of a line,
`plain` the number in a field. `reading.js` has the same rules for the pages that read files in the
browser.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

MAX_BYTES = 1 << 30
MAX_LINE = 1 << 20
MAX_LINES = 4_000_000
MARKS = frozenset("#%!/")  # with which a comment begins
COMMENT = re.compile(r"(?:[#%!]|//)\s*(.*)")
RULE = "-=+|:_ \t"  # characters of a line drawn below a header, as in Markdown
EMPTY = ' \t,;|"'  # characters of a line without a field
SEPARATORS = (",", ";", "\t", "|", "")  # the last is white space
NUMBER = re.compile(r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+|[0-9]*,[0-9]+)([eEdD][+-]?[0-9]+)?")
NOT_FINITE = re.compile(r"[+-]?(nan|inf|infinity)", re.IGNORECASE)
FORTRAN = re.compile(r"(?<=[0-9.])[dD](?=[+-]?[0-9])")
# never read, but no word either
HEXFLOAT = re.compile(r"[+-]?0x[\da-f]+(\.[\da-f]*)?p[+-]?\d+", re.IGNORECASE)
# thousands, or a decimal mark before three digits
GROUPED = re.compile(r"[+-]?[1-9][0-9]{0,2}([,.][0-9]{3})+")
THOUSANDS = re.compile(r"[+-]?[0-9]{1,3}([,.'’ \u00a0\u202f][0-9]{3})+([.,][0-9]*)?")
# how no program prints a whole number, but the digits after a comma
PADDED = re.compile(r"[+-]?0[0-9]+")
MISSING = ("", "na", "n/a", "#n/a", "null", "none")  # of a field without a number, in small letters
APART = re.compile(r"\s{2,}|\t")
BEFORE_BRACKET = re.compile(r"(?<!\s)\s+(?=[(\[{])")
QUOTED_WORD = re.compile(r"""(?:"[^"]*"|[^"\s])+""")
# [hours:]minutes:seconds, and a date before it; two numbers alone may be hours and minutes
CLOCK = re.compile(r"(?:([0-9]+):)?([0-5]?[0-9]):([0-5]?[0-9](?:[.,][0-9]+)?)")
MOMENT = re.compile(
    r"([0-9]{4})-([0-9]{2})-([0-9]{2})[T ]([0-9]{2}):([0-9]{2}):([0-9]{2}(?:[.,][0-9]+)?)"
    r"\s*(?:[Zz]|([+-])([0-9]{2}):?([0-9]{2}))?"
)


def is_number(text: str) -> bool:
    """Return True for a number as C and Fortran print it (NaN and inf too), not for forms that only Python reads."""
    return NUMBER.fullmatch(text) is not None or NOT_FINITE.fullmatch(text) is not None


def is_clock(text: str) -> bool:
    """Return True for hours:minutes:seconds, with or without a date before it."""
    return CLOCK.fullmatch(text) is not None or MOMENT.fullmatch(text) is not None


def says_nothing(line: str) -> bool:
    """Return True for a line without fields, or one drawn with dashes or similar marks."""
    text = line.strip()
    return not text.strip(EMPTY) or ("---" in text and not text.strip(RULE))


def is_missing(text: str) -> bool:
    """Return True for a field that marks a missing number."""
    return text.lower() in MISSING


def _unquoted(field: str) -> str:
    """Return a field without white space around it and without a pair of quotes."""
    text = field.strip()
    quoted = len(text) > 1 and text[0] == text[-1] == '"'
    return text[1:-1].replace('""', '"').strip() if quoted else text


def split(line: str, separator: str) -> list[str]:
    """Return the fields of a line.

    A field in quotes may hold the separator, which is white space if empty.
    """
    if line.count('"') % 2:
        line = line.replace('"', "")  # an inch, or a field that goes on in the next line
    if '"' not in line:
        fields = line.split(separator or None)
        return [field.strip() for field in fields]
    if not separator:
        return [_unquoted(word) for word in QUOTED_WORD.findall(line)]
    mark = re.escape(separator)
    fields = re.findall(f'((?:"[^"]*"|[^"{mark}])*){mark}', line + separator)
    return [_unquoted(field) for field in fields]


def possible_separators(line: str) -> list[tuple[str, float]]:
    """Return the separators under which most fields of a line are numbers, each with their share, the likeliest first.

    Fields that say that there is no number do not count. Of equal shares the first of `SEPARATORS`
    is the likelier.
    """
    found = []
    for separator in SEPARATORS:
        if separator not in line:
            continue
        fields = [field for field in split(line, separator) if not is_missing(field)]
        numbers = [
            is_number(field) or is_clock(field) or bool(HEXFLOAT.fullmatch(field))
            for field in fields
        ]
        share = sum(numbers) / max(1, len(fields))
        if share > 0.5:
            found.append((separator, share))
    return sorted(found, key=lambda one: -one[1])


def words(line: str) -> list[list[str]]:
    """Return the ways to take a header apart, the most likely first.

    Separators at its end add no word.
    """
    ways = [split(line, separator) for separator in SEPARATORS if separator and separator in line]
    ways += [APART.split(line.strip()), split(BEFORE_BRACKET.sub("", line), ""), split(line, "")]
    return [without_end(way) for way in ways]


def without_end(fields: list[str]) -> list[str]:
    """Return fields without the empty ones at the end; the first is kept."""
    end = len(fields)
    while end > 1 and not fields[end - 1].strip():
        end -= 1
    return fields[:end]


def without_label(names: list[str]) -> list[str]:
    """Return the names in a header without a label such as "Columns:" before them."""
    first, *others = names
    is_label = first.endswith(":") and not any(name.endswith(":") for name in others)
    return others if is_label and others else names


def doubtful_number(columns: Sequence[Sequence[str]], commas_separate: bool) -> str | None:
    """Return a number whose mark may be decimal or may separate thousands.

    None if the numbers decide it.

    A mark is decimal as soon as one number has it where thousands are not separated: in 0,5 or
    12.25, not in 1,250. If no number decides it, a point is taken as decimal, unless commas are
    decimal or the column contains whole numbers.

    Args:
        columns: numbers as they are written.
        commas_separate: whether commas stand between the columns: then nobody writes points between
            thousands.
    """
    examples: dict[str, str] = {}
    proven: set[str] = set()
    whole_beside_point = False
    for column in columns:
        marked = [number for number in column if "," in number or "." in number]
        grouped = [number for number in marked if GROUPED.fullmatch(number)]
        for number in grouped:
            examples.setdefault("," if "," in number else ".", number)
        for number in marked if len(marked) > len(grouped) else ():
            if not GROUPED.fullmatch(number):
                proven.add("," if "," in number else ".")
        whole_beside_point = whole_beside_point or bool(0 < len(grouped) < len(column))
    if "," in examples and "," not in proven:
        return examples[","]
    if "." not in examples or "." in proven:
        return None
    commas = "," in proven
    return examples["."] if commas or (whole_beside_point and not commas_separate) else None


def plain(number: str) -> str:
    """Return a number with a point and an e, as Python and C read it."""
    return FORTRAN.sub("e", number.replace(",", "."))


def padded(fields: Sequence[str]) -> str | None:
    """Return the first whole number with leading zeros, or None."""
    return next((field for field in fields if PADDED.fullmatch(field)), None)
