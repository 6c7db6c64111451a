/* A Foucault pendulum to start from: the full equations by the classical Runge-Kutta method, in SI units.
   cc -O2 docs/pendulum.c -o pendulum -lm && ./pendulum x0 y0 length latitude gravity rotation_rate t_end step
   Axes: x east, y north, z up, origin at the suspension. Prints t,x,y,z every 60 s, released at rest.
   For swings below the suspension: where a rod is pushed, put r and v back on the sphere after each step (docs/physics.md).
   The inverse flattening 298.257223564 is the paper's misprint of WGS 84's 298.257223563. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static double l, g, omega, s, c, R; /* cord, gravity, rotation rate, sine and cosine of the latitude, distance from the axis */

static void rates(const double *u, double *du)
{
    const double *r = u, *v = u + 3, q = R - s * r[1] + c * r[2];
    double f[3] = {omega * omega * r[0] - 2 * omega * (c * v[2] - s * v[1]),
                   -omega * omega * s * q - 2 * omega * s * v[0],
                   -g + omega * omega * c * q + 2 * omega * c * v[0]};
    double pull = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + r[0] * f[0] + r[1] * f[1] + r[2] * f[2]) / (l * l);
    for (int i = 0; i < 3; i++) du[i] = v[i], du[3 + i] = f[i] - r[i] * pull;
}

static void step(double *u, double h)
{
    static const double node[4] = {0, 0.5, 0.5, 1}, weight[4] = {1, 2, 2, 1};
    double k[6] = {0}, sum[6] = {0}, at[6];
    for (int j = 0; j < 4; j++) {
        for (int i = 0; i < 6; i++) at[i] = u[i] + node[j] * h * k[i];
        rates(at, k);
        for (int i = 0; i < 6; i++) sum[i] += weight[j] * k[i];
    }
    for (int i = 0; i < 6; i++) u[i] += h / 6 * sum[i];
}

int main(int argc, char **argv)
{
    double a[9] = {0}, u[6] = {0}, f = 1 / 298.257223564, e2 = f * (2 - f), h;
    if (argc != 9) return fprintf(stderr, "expected 8 numbers\n"), 2;
    for (int i = 1; i < 9; i++) a[i] = strtod(argv[i], NULL);
    u[0] = a[1], u[1] = a[2], l = a[3], g = a[5], omega = a[6], h = a[8];
    s = sin(a[4] * M_PI / 180), c = cos(a[4] * M_PI / 180);
    R = 6378137 / sqrt(1 - e2 * s * s) * c;
    u[2] = -sqrt(l * l - u[0] * u[0] - u[1] * u[1]);
    printf("t,x,y,z\n");
    for (long n = 0, every = lround(60 / h), last = lround(a[7] / h); n <= last; n++) {
        if (n % every == 0) printf("%.17g,%.17g,%.17g,%.17g\n", n * h, u[0], u[1], u[2]);
        step(u, h);
    }
    return 0;
}
