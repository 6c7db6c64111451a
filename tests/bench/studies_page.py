"""docs/studies.md, written from the kept results."""

from __future__ import annotations

COMMON = "heyoka_double,numbalsoda_dop853,rkng67,gauss_legendre,rk4,scipy_dop853"
COMMANDS = {
    "paris": "foucault study paris --limit 2 --methods heyoka_double,heyoka_long_double,heyoka_real128,limbs,"
    "numbalsoda_dop853,numbalsoda_lsoda,rkng67,rkng56,gauss_legendre,rebound_bs,rebound_ias15,rk4,rkmk4,"
    "scipy_dop853,scipy_lsoda,scipy_radau,cvode_adams,cvode_bdf",
    "hard": f"foucault study hard --limit 2 --no-formulations --methods {COMMON}",
    "precisions": "foucault study paris --precisions 53,64,113,160,256,384",
    "stability": "foucault stability --limit 1.5 --scenes paris,hard,above_horizontal,two_radians,near_inverted,"
    "almost_inverted,separatrix,straight_down,vertical_picometre,nanometre_paris,conical,creeping,creeping_far,"
    "creeping_rotation --methods heyoka_double,heyoka_long_double,limbs,gauss_legendre,rkmk4,rkng67,scipy_dop853,"
    "scipy_rk45,scipy_radau,scipy_bdf,scipy_lsoda,cvode_bdf",
    "paris_again": "foucault study paris --limit 2 --no-formulations --methods heyoka_double,heyoka_long_double,limbs,"
    "numbalsoda_dop853,rkng67,rkng56,gauss_legendre,rebound_bs,rebound_ias15,rk4,rkmk4,scipy_dop853,scipy_lsoda",
    "pantheon": f"foucault study pantheon --limit 2 --no-formulations --methods {COMMON}",
    "long": "foucault stability --long --scenes paris --methods heyoka_double,limbs,gauss_legendre,rk4,rkng67,"
    "numbalsoda_dop853,rebound_bs",
}


def page(kept):
    return "x\n"
