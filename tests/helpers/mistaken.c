/* A Foucault pendulum as somebody might write it, with the mistakes that its options name. It shares nothing with the
 * project: plain double, x'' = F - r (v.v + r.F)/l^2 or a linear law, a classical Runge-Kutta method or Euler's.
 * Options: key=value. Prints t,x,y,z. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static double l = 67, g = 9.80665, lat = 45, rate = 7.292115e-5, radius = 6378137, invf = 298.257223564, drag = 0;
static double xs = 1, ys = 0, vx0 = 0, vy0 = 0, stars = 0, tend = 600, out = 2, h = 0.01;
static double half = 1, north_factor = 1, up_factor = 1, corlat = 1e9, turnby = 0, point = 0;
static double scale = 1, tscale = 1, toffset = 0, zsign = 1, zshift = 0;
static double xsign = 1, ysign = 1, fast = 1, outward = -1, gtimes = 1, ltimes = 1, ratetimes = 1, counts_ends = 0;
static int model = 0;   /* 0 sphere, 1 linear, 2 linear in the angle, 3 linear with the centrifugal force */
static int reading = 0; /* 0 centrifugal force added, 1 none, 2 effective g */
static int method = 4;  /* 4 Runge-Kutta, 3 velocity Verlet, 2 midpoint, 1 Euler, 0 semi-implicit Euler, 5 position first */
static int decimals = -1, swap = 0, reversed = 0, single = 0;
static double north, up, cnorth, cup, cy, cz;

static void force(const double *r, const double *v, double *f) {
    f[0] = 2 * half * (cup * v[1] - cnorth * v[2]) - drag * v[0];
    f[1] = -2 * half * cup * v[0] - drag * v[1] + cy;
    f[2] = 2 * half * cnorth * v[0] - drag * v[2] + cz - g;
    if (reading != 1) {
        double q = -r[1] * up + r[2] * north; /* distance from the axis through the pivot, times the rate */
        f[0] += rate * rate * r[0];
        f[1] -= up * q;
        f[2] += north * q;
    }
    if (point != 0) {
        double c = sqrt(r[0] * r[0] + r[1] * r[1] + (r[2] + radius) * (r[2] + radius));
        double k = g * radius * radius / (c * c * c);
        f[0] -= k * r[0];
        f[1] -= k * r[1];
        f[2] += g - k * (r[2] + radius);
    }
}

static void rates(const double *s, double *d) {
    const double *v = s + 3;
    int i;
    for (i = 0; i < 3; i++) d[i] = v[i];
    if (model == 0) {
        double f[3], lam = 0;
        force(s, v, f);
        for (i = 0; i < 3; i++) lam += v[i] * v[i] + s[i] * f[i];
        for (i = 0; i < 3; i++) d[3 + i] = f[i] - s[i] * lam / (l * l);
        return;
    }
    d[3] = -g / l * s[0] + 2 * half * cup * v[1] - drag * v[0];
    d[4] = -g / l * s[1] - 2 * half * cup * v[0] - drag * v[1];
    if (model == 3) {
        d[3] += rate * rate * s[0];
        d[4] += up * up * s[1] + up * l * north + cy;
    }
    d[2] = d[5] = 0;
}

static void step(double *s) {
    double a[6], b[6], c[6], d[6], m[6];
    int i;
    rates(s, a);
    if (method == 1) {
        for (i = 0; i < 6; i++) s[i] += h * a[i];
    } else if (method == 0) {
        for (i = 3; i < 6; i++) s[i] += h * a[i];
        for (i = 0; i < 3; i++) s[i] += h * s[3 + i];
    } else if (method == 5) {
        for (i = 0; i < 3; i++) s[i] += h * s[3 + i];
        rates(s, a);
        for (i = 3; i < 6; i++) s[i] += h * a[i];
    } else if (method == 3) {
        for (i = 3; i < 6; i++) s[i] += h / 2 * a[i];
        for (i = 0; i < 3; i++) s[i] += h * s[3 + i];
        rates(s, a);
        for (i = 3; i < 6; i++) s[i] += h / 2 * a[i];
    } else if (method == 2) {
        for (i = 0; i < 6; i++) m[i] = s[i] + h / 2 * a[i];
        rates(m, b);
        for (i = 0; i < 6; i++) s[i] += h * b[i];
    } else {
        for (i = 0; i < 6; i++) m[i] = s[i] + h / 2 * a[i];
        rates(m, b);
        for (i = 0; i < 6; i++) m[i] = s[i] + h / 2 * b[i];
        rates(m, c);
        for (i = 0; i < 6; i++) m[i] = s[i] + h * c[i];
        rates(m, d);
        for (i = 0; i < 6; i++) s[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
    }
}

int main(int argc, char **argv) {
    struct { const char *name; double *value; } keys[] = {
        {"l", &l}, {"g", &g}, {"lat", &lat}, {"rate", &rate}, {"radius", &radius}, {"invf", &invf}, {"drag", &drag},
        {"x0", &xs}, {"y0", &ys}, {"vx0", &vx0}, {"vy0", &vy0}, {"stars", &stars}, {"tend", &tend}, {"out", &out},
        {"h", &h}, {"half", &half}, {"north", &north_factor}, {"up", &up_factor}, {"corlat", &corlat},
        {"turnby", &turnby}, {"point", &point}, {"scale", &scale}, {"tscale", &tscale}, {"toffset", &toffset},
        {"zsign", &zsign}, {"zshift", &zshift}, {"xsign", &xsign}, {"ysign", &ysign}, {"fast", &fast},
        {"outward", &outward}, {"gtimes", &gtimes}, {"ltimes", &ltimes}, {"ratetimes", &ratetimes},
        {"counts_ends", &counts_ends}};
    struct { const char *name; int *value; } flags[] = {
        {"model", &model}, {"reading", &reading}, {"method", &method}, {"decimals", &decimals}, {"swap", &swap},
        {"reversed", &reversed}, {"single", &single}};
    int i, k;
    for (i = 1; i < argc; i++) {
        char *eq = strchr(argv[i], '=');
        int known = 0;
        if (!eq) return 2;
        for (k = 0; k < (int)(sizeof keys / sizeof *keys); k++)
            if (!strncmp(argv[i], keys[k].name, eq - argv[i]) && keys[k].name[eq - argv[i]] == 0)
                *keys[k].value = atof(eq + 1), known = 1;
        for (k = 0; k < (int)(sizeof flags / sizeof *flags); k++)
            if (!strncmp(argv[i], flags[k].name, eq - argv[i]) && flags[k].name[eq - argv[i]] == 0)
                *flags[k].value = atoi(eq + 1), known = 1;
        if (!known) return 2;
    }
    g *= gtimes, l *= ltimes, rate *= ratetimes;
    if (counts_ends != 0) fast = 1 + counts_ends * out / tend;
    double p = lat * M_PI / 180, cp = (corlat < 1e8 ? corlat : lat) * M_PI / 180;
    double f = invf > 1e8 ? 0 : 1 / invf, e2 = f * (2 - f);
    double axis = radius / sqrt(1 - e2 * sin(p) * sin(p)) * cos(p);
    north = rate * cos(p), up = rate * sin(p);
    cnorth = north_factor * rate * cos(cp), cup = up_factor * rate * sin(cp);
    if (outward >= 0) axis = outward * cos(p); /* a sphere of its own */
    if (reading == 0) cy = -rate * rate * axis * sin(p), cz = rate * rate * axis * cos(p);
    double s[6] = {xs, ys, 0, vx0 + stars * cup * ys, vy0 - stars * cup * xs, 0};
    if (model == 2) {
        double rho = sqrt(xs * xs + ys * ys), stretch = l * asin(rho / l) / rho;
        s[0] *= stretch, s[1] *= stretch;
    }
    if (model == 0) {
        s[2] = -sqrt(l * l - xs * xs - ys * ys);
        s[5] = -(s[0] * s[3] + s[1] * s[4]) / s[2];
    }
    if (zshift < 0) zshift = l; /* from its own lowest point */
    long rows = (long)floor(tend / out + 0.5), many = (long)floor(out / h + 0.5);
    double *all = malloc(sizeof(double) * 3 * (rows + 1));
    for (long row = 0; row <= rows; row++) {
        double x = s[0], y = s[1], z = s[2];
        if (model == 2) {
            double rho = sqrt(x * x + y * y), shrink = rho > 0 ? l * sin(rho / l) / rho : 1;
            x *= shrink, y *= shrink;
        }
        if (model != 0) z = -sqrt(l * l - x * x - y * y);
        x *= xsign, y *= ysign;
        all[3 * row] = swap ? y : x, all[3 * row + 1] = swap ? x : y, all[3 * row + 2] = zsign * z + zshift;
        if (row < rows)
            for (long j = 0; j < many; j++) step(s);
    }
    printf("t,x,y,z\n");
    for (long row = 0; row <= rows; row++) {
        double *r = all + 3 * (reversed ? rows - row : row), t = row * out * fast / tscale + toffset;
        if (single)
            printf("%.9g,%.9g,%.9g,%.9g\n", (float)t, (float)r[0], (float)r[1], (float)r[2]);
        else if (decimals >= 0)
            printf("%.17g,%.*f,%.*f,%.*f\n", t, decimals, scale * r[0], decimals, scale * r[1], decimals, scale * r[2]);
        else
            printf("%.17g,%.17g,%.17g,%.17g\n", t, scale * r[0], scale * r[1], scale * r[2]);
    }
    return 0;
}
