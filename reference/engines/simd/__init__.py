"""SIMD lanes, and polynomials in double precision: shared by the engines limbs and octet."""
