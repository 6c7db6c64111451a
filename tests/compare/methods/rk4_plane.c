/* The classical Runge-Kutta method for Mathar (43), as the paper's program does it: fixed step, x, y and their
 * rates in m, all in binary64. Written by hand and not generated, so that it checks and times what is generated.
 * Arguments: l g latitude(rad) omega R x y h rows steps-per-row. Output: x y after every row, in hexadecimal, and
 * on the last line the CPU seconds of the loop. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double l, g, omega, R, sp, cp;

static void rates(const double s[4], double d[4])
{
    const double x = s[0], y = s[1], vx = s[2], vy = s[3];
    const double z2 = l * l - x * x - y * y, z = sqrt(z2), z3 = z2 * z, z4 = z2 * z2;
    const double area = x * vy - y * vx, swing = l * l * (vx * vx + vy * vy) - area * area;
    const double bx = x * swing + x * g * z3
        + omega * (-2 * z4 * sp * vy + 2 * y * vy * cp * z3)
        + omega * omega * (-x * z4 * sp * sp + x * cp * (y * sp - R) * z3);
    const double by = y * swing + y * g * z3
        + omega * (2 * z4 * sp * vx - 2 * y * vx * cp * z3)
        + omega * omega * (z4 * (-y + R * sp + 2 * y * cp * cp) - z3 * cp * (R * y + (z2 - y * y) * sp));
    const double scale = 1 / (z4 * l * l);
    d[0] = vx;
    d[1] = vy;
    d[2] = scale * (-(y * y + z2) * bx + y * x * by);
    d[3] = scale * (y * x * bx - (x * x + z2) * by);
}

static void step(double s[4], double h)
{
    double k1[4], k2[4], k3[4], k4[4], t[4];
    rates(s, k1);
    for (int i = 0; i < 4; i++) t[i] = s[i] + h / 2 * k1[i];
    rates(t, k2);
    for (int i = 0; i < 4; i++) t[i] = s[i] + h / 2 * k2[i];
    rates(t, k3);
    for (int i = 0; i < 4; i++) t[i] = s[i] + h * k3[i];
    rates(t, k4);
    for (int i = 0; i < 4; i++) s[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
}

int main(int argc, char **argv)
{
    if (argc != 11) return 2;
    l = atof(argv[1]);
    g = atof(argv[2]);
    sp = sin(atof(argv[3]));
    cp = cos(atof(argv[3]));
    omega = atof(argv[4]);
    R = atof(argv[5]);
    double s[4] = {atof(argv[6]), atof(argv[7]), 0, 0};
    const double h = atof(argv[8]);
    const long rows = atol(argv[9]), steps = atol(argv[10]);
    const clock_t begun = clock();
    for (long row = 0; row < rows; row++) {
        for (long i = 0; i < steps; i++) step(s, h);
        printf("%a %a\n", s[0], s[1]);
    }
    printf("%.6f\n", (double)(clock() - begun) / CLOCKS_PER_SEC);
    return 0;
}
