/* A Foucault pendulum as a student would write it: classical RK4, full or linear equations, and mistakes to order.
   cc -O2 pendulum.c -lm && ./a.out FAULT x0 y0 length latitude gravity rotation radius inverse_flattening t_end step every */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static double l, g, omega, s, c, R, hor = 1.0;
static int linear = 0;

static void rates(const double *u, double *du)
{
    const double *r = u, *v = u + 3;
    double q = R - s * r[1] + c * r[2], w = 2 * omega, f[3], pull;
    int i;
    f[0] = omega * omega * r[0] - w * (hor * c * v[2] - s * v[1]);
    f[1] = -omega * omega * s * q - w * s * v[0];
    f[2] = -g + omega * omega * c * q + w * hor * c * v[0];
    pull = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + r[0] * f[0] + r[1] * f[1] + r[2] * f[2]) / (l * l);
    for (i = 0; i < 3; i++) {
        du[i] = v[i];
        du[3 + i] = f[i] - r[i] * pull;
    }
    if (linear) { /* x'' = -g/l x + 2 Omega sin(lat) y', y'' = -g/l y - 2 Omega sin(lat) x' */
        du[3] = -g / l * r[0] + w * s * v[1];
        du[4] = -g / l * r[1] - w * s * v[0];
        du[2] = du[5] = 0;
    }
}

static void step(double *u, double h)
{
    static const double node[4] = {0, 0.5, 0.5, 1}, weight[4] = {1, 2, 2, 1};
    double k[6] = {0}, sum[6] = {0}, at[6];
    int i, j;
    for (j = 0; j < 4; j++) {
        for (i = 0; i < 6; i++) at[i] = u[i] + node[j] * h * k[i];
        rates(at, k);
        for (i = 0; i < 6; i++) sum[i] += weight[j] * k[i];
    }
    for (i = 0; i < 6; i++) u[i] += h / 6 * sum[i];
}

int main(int argc, char **argv)
{
    const char *fault = argc > 12 ? argv[1] : "";
    double a[13] = {0}, u[6] = {0}, lat, e2, f, h, wander = 0;
    long n, every, steps;
    if (argc < 13) return fprintf(stderr, "too few arguments\n"), 2;
    for (n = 2; n < 13; n++) a[n] = strtod(argv[n], NULL);
    u[0] = a[2], u[1] = a[3], l = a[4], lat = a[5], g = a[6], omega = a[7], R = a[8], f = 1 / a[9], h = a[11];
#define IS(name) (strcmp(fault, name) == 0)
    if (IS("gravity")) g += 2e-5;
    if (IS("solar_day")) omega = 2 * M_PI / 86400;
    if (IS("mean_sphere")) f = 0, R = 6371000;
    if (IS("length")) l += 1e-3;
    if (IS("release")) u[0] += 1e-3;
    if (IS("swapped")) u[0] = a[3], u[1] = a[2];
    if (IS("vertical_only")) hor = 0;
    if (IS("linear")) linear = 1;
    lat *= M_PI / 180;
    if (IS("geocentric")) lat = atan((1 - f) * (1 - f) * tan(lat));
    s = sin(lat), c = cos(lat), e2 = f * (2 - f), R = R * c / sqrt(1 - e2 * s * s);
    u[2] = -sqrt(l * l - u[0] * u[0] - u[1] * u[1]);
    steps = lround(a[10] / h), every = lround(a[12]);
    printf("t,x,y,z,vx,vy,vz\n");
    for (n = 0; n <= steps; n++) {
        if (n % every == 0)
            printf("%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", n * h, u[0] + wander, u[1], u[2], u[3], u[4], u[5]);
        if (IS("random")) wander += 1e-6 * (rand() / (double)RAND_MAX - 0.5);
        step(u, h);
    }
    return 0;
}
