"""TRUSTED. Sections of a motion: zeros of affine forms of position and velocity (THEOREM.md, section 13)."""

from fractions import Fraction
from json import loads
from typing import Any

from flint import arb, arb_poly, ctx

from .balls import UNIT, Vector, add, ball, cross, demand, dot, size, times, upper
from .bound import SceneBalls, state
from .course import FINISHED, Course
from .enclosed_transits import Scan, Slope
from .printed import check_rows
from .shapes import Covered, EnclosedPassage, ProvedSections

HEADER, WAYS = "k,t,direction,x,y,z,vx,vy,vz,bound", {"highest": -1, "lowest": 1}


def form(balls: SceneBalls, word: str) -> tuple[Vector, Vector, arb]:
    """Return the form a·r + b·v - d of a section's word, in the axes of the proof."""
    kind, _, azimuth = word.partition(" ")
    zero, (sin, cos) = [arb(0)] * 3, ball(Fraction(azimuth.removesuffix("@0") or 0) / 180).sin_cos_pi()
    along, rest = balls.turned([cos, sin, arb(0)], 1), [UNIT] * 3
    if kind != "gate":
        return zero, along if kind == "turn" else times(-1, balls.c), arb(0)
    if azimuth.endswith("@0"):
        return balls.turned([-sin, cos, arb(0)], 1), zero, arb(0)
    for _ in range(balls.prec):
        pull = add(balls.c, times(-1, cross(balls.omega, cross(balls.omega, rest))))
        demand(dot(pull, pull) > 0, "so fast a rotation singles out no rest position, which the gate goes through")
        rest = times(1 / dot(pull, pull).sqrt(), pull)
    return (across := cross(along, balls.c)), zero, dot(across, rest)


class Form(Slope):
    """The form, times h, lies in f ± off on a piece, and its rate in f' ± off'."""

    def __init__(self, covered: Covered, a: Vector, b: Vector, d: arb) -> None:
        piece, (eta, u, bend), h = covered.piece, covered.tube, covered.piece.k.h
        terms = zip([*times(h, a), *b], [*piece.p, *piece.v], strict=True)
        f = sum((arb_poly(g) * x for x, g in terms if not x.is_zero()), -h * d * arb_poly([piece.unit]))
        off, more = (arb(0, upper(size(a) * h * x + size(b) * y)) for x, y in ((eta, u), (u, bend)))
        self.covered, self.piece, self.centre = covered, piece, ball(piece.step.centre)
        self.forms, self.tube = ((f, off), (f.derivative(), more)), covered.tube._replace(u=off.rad())
        # at rest, of a velocity alone
        self.slow, self.flat = all(x.is_zero() for x in [*a, d, *piece.balls.release[1]]), False

    def row(self, s: arb) -> Vector:
        """Return the state over the length."""
        turned, (r, v) = self.piece.balls.turned, state(self.covered, s)
        return [*turned(r, -1), *turned(times(1 / self.piece.k.h, v), -1)]


class Sections:
    """Scans a course for the passages of sections."""

    def __init__(self, course: Course, words: tuple[str, ...]) -> None:
        self.course, self.words = course, words
        with ctx.workprec(course.balls.prec):
            forms = [form(course.balls, word) for word in words]
        self.scans = [Scan(course.balls, lambda covered, f=f: Form(covered, *f), EnclosedPassage) for f in forms]
        course.followers.append(self)

    def advance(self, covered: Covered) -> None:
        """Take the next step's tube."""
        demand(not self.course.open, "a tube comes from the course alone, while it takes a step")
        for scan in self.scans:
            scan.advance(covered)

    def finish(self, proved: Any) -> ProvedSections:
        """Return the passages in the course, whose result is `proved`."""
        right = proved in FINISHED and proved.times is self.course.times
        demand(right and {scan.time for scan in self.scans} == {proved.times[-1]}, "the proof is of another course")
        found = [(word, WAYS.get(word), scan.finish()) for word, scan in zip(self.words, self.scans, strict=True)]
        kept = {
            w: tuple(z for z in zeros if not way or z.parity != "one" or z.direction == way) for w, way, zeros in found
        }
        FINISHED.add(sections := ProvedSections(proved, kept))
        return sections


def check_sections(texts: Any, sections: Any, proved: Any) -> None:
    """Demand that sections.csv and the manifest state the passages that were proved, of just these sections."""
    manifest, (header, *lines) = loads(texts["manifest.json"]), texts["sections.csv"].splitlines()
    right = sections in FINISHED and sections.proved is proved and header == f"section,{HEADER}"
    rows, said, least = list[Any](), manifest["sections"], manifest["sections"]["bounds"]
    demand(right and "; ".join(sections.passages) == manifest["scene"]["run"]["sections"], "misprint: other sections")
    for word, zeros in sections.passages.items():
        ones, others = ([z for z in zeros if (z.parity == "one") is single] for single in (True, False))
        rows += [(word, [k, z.t, z.direction, z.x, z.y, z.z, z.vx, z.vy, z.vz]) for k, z in enumerate(ones, 1)]
        for z, part in zip(others, said["possible"][word], strict=True):
            low, high = max(z.t.low, Fraction(0)), min(z.t.high, proved.times[-1])
            inside = Fraction(part["from_s"]) <= low and high <= Fraction(part["to_s"])
            demand(inside and part["parity"] == z.parity, "misprint: a possible passage")
    cells = [line.partition(",") for line in lines]
    demand([cell[0] for cell in cells] == [row[0] for row in rows], "misprint: other sections")
    text = "\n".join([HEADER, *(cell[2] for cell in cells)])
    check_rows(text, HEADER, [row[1] for row in rows], {name: Fraction(x) for name, x in least.items()})
