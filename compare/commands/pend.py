"""`foucault pend`: run the paper's program foucPend, with the same switches."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

Text = str | None


def command(
    x: Annotated[Text, typer.Option("-x", metavar="M", help="East position at time zero, m [0].")] = None,
    y: Annotated[Text, typer.Option("-y", metavar="M", help="North position at time zero, m [0].")] = None,
    length: Annotated[Text, typer.Option("-l", metavar="M", help="Cord length, m [67].")] = None,
    velocity: Annotated[Text, typer.Option("-v", metavar="M/S", help="East velocity at time zero, m/s [0].")] = None,
    latitude: Annotated[Text, typer.Option("-L", metavar="DEG", help="Geodetic latitude, degrees [48.846111].")] = None,
    duration: Annotated[Text, typer.Option("-T", metavar="S", help="Duration, s [86400].")] = None,
    step: Annotated[Text, typer.Option("-t", metavar="S", help="Time step, s [0.1].")] = None,
    skip: Annotated[
        Text, typer.Option("-s", metavar="N", help="Number of steps from one snapshot to the next [1].")
    ] = None,
    gravity: Annotated[Text, typer.Option("-g", metavar="M/S2", help="Gravity, m/s² [9.80665].")] = None,
    rate: Annotated[
        Text, typer.Option("-O", "-0", metavar="RAD/S", help="Angular speed of the Earth, rad/s [7.292115e-5].")
    ] = None,
    flattening: Annotated[
        Text,
        typer.Option("-f", metavar="1/F", help="Inverse flattening of the Earth, or inf for a sphere [298.257223564]."),
    ] = None,
    altitude: Annotated[Text, typer.Option("-h", metavar="M", help="Altitude of the suspension, m [0].")] = None,
    radius: Annotated[
        Text, typer.Option("-r", metavar="M", help="Equatorial radius of the Earth, m [6.378137e6].")
    ] = None,
    order: Annotated[
        Text, typer.Option("-R", metavar="4|5|6", help="Integrator: 4 Runge-Kutta, 5 RKN-G 5(6), 6 RKN-G 6(7) [4].")
    ] = None,
    approximations: Annotated[
        Text,
        typer.Option(
            "-a", metavar="BITS", help="Leave out 1: the off-diagonal elements; 2: the terms in Ω²; 3: both [0]."
        ),
    ] = None,
    exact: Annotated[bool, typer.Option("--exact", help="Print the same lines from the reference.")] = False,
) -> None:
    """Run the paper's program foucPend.

    It integrates at a fixed step and prints snapshots and transits.
    """
    from ..foucpend import Options, lines

    typed = {
        "x": x,
        "y": y,
        "l": length,
        "v": velocity,
        "L": latitude,
        "T": duration,
        "t": step,
        "s": skip,
        "g": gravity,
        "O": rate,
        "f": flattening,
        "h": altitude,
        "r": radius,
        "R": order,
        "a": approximations,
    }
    options = Options.parse({switch: value for switch, value in typed.items() if value is not None}, exact)
    output = lines(options)
    while block := [line for _, line in zip(range(4096), output, strict=False)]:
        sys.stdout.write("\n".join(block) + "\n")
