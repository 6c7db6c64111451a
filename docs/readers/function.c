/* Evaluate a golden function in C: cc -O2 function.c -o function -lm && ./function FOLDER 17.25 3600
   Prints t, x, y, z, vx, vy, vz for each time; docs/format.md specifies the files and every operation. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char *contents(const char *folder, const char *name, size_t *size) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    if (!file) exit((fprintf(stderr, "%s: there is no golden function\n", path), 2));
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    char *text = malloc(*size + 1);
    *size = fread(text, 1, *size, file);
    text[*size] = 0;
    return text;
}

static const char *value(const char *json, const char *key) { /* what follows "key": */
    char quoted[64];
    snprintf(quoted, sizeof quoted, "\"%s\": ", key);
    const char *at = strstr(json, quoted);
    if (!at) exit((fprintf(stderr, "function.json has no %s\n", key), 2));
    return at + strlen(quoted);
}

int main(int argc, char **argv) {
    size_t size, bytes;
    const char *json = contents(argv[1], "function.json", &size);
    const double *c = (const double *)contents(argv[1], "function.f64", &bytes); /* of a little-endian processor */
    const char *square = value(json, "length_squared"), *text = value(json, "times");
    int degree = atoi(value(json, "degree")), series = *square == 'n' ? 3 : 2;
    size_t pieces = bytes / 8 / (size_t)(series * (degree + 1));
    double *times = malloc((pieces + 1) * sizeof *times), l2 = series == 2 ? strtod(square + 1, NULL) : 0;
    for (size_t i = 0; i <= pieces; i++) {
        char *end;
        times[i] = strtod(strchr(text, '"') + 1, &end);
        text = end + 1;
    }
    for (int n = 2; n < argc; n++) {
        double t = strtod(argv[n], NULL), x[3], v[3];
        if (!(t >= 0 && t <= times[pieces])) return fprintf(stderr, "%s: not within 0 to %.17g s\n", argv[n], times[pieces]), 2;
        size_t low = 0, high = pieces; /* times[low] <= t, and t < times[high] but at the very end */
        while (high - low > 1) {
            size_t middle = (low + high) / 2;
            if (times[middle] <= t) low = middle; else high = middle;
        }
        double a = times[low], b = times[high], w = b - a, u = ((t - a) - (b - t)) / w, y = u + u;
        for (int i = 0; i < series; i++) {
            const double *k = c + (low * (size_t)series + (size_t)i) * (size_t)(degree + 1);
            double b1 = 0, b2 = 0, d1 = 0, d2 = 0;
            for (int j = degree; j > 0; j--) {
                double b0 = (y * b1 - b2) + k[j], d0 = (y * d1 - d2) + j * k[j];
                b2 = b1, b1 = b0, d2 = d1, d1 = d0;
            }
            x[i] = (u * b1 - b2) + k[0];
            v[i] = (d1 + d1) / w;
        }
        if (series == 2) {
            x[2] = -sqrt(l2 - (x[0] * x[0] + x[1] * x[1]));
            v[2] = -(x[0] * v[0] + x[1] * v[1]) / x[2];
        }
        printf("%.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", t, x[0], x[1], x[2], v[0], v[1], v[2]);
    }
    return 0;
}
