/* Read a golden dataset in C, as doubles from hexfloats: cc -O2 golden.c -o golden && ./golden data/golden/paris */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char line[1 << 14], manifest[1 << 20];

static FILE *opened(const char *folder, const char *name) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return fopen(path, "r");
}

static void read_row(double *row) { /* the numbers between the commas of a line */
    for (char *cell = strtok(line, ","); cell; cell = strtok(NULL, ",")) *row++ = strtod(cell, NULL);
}

int main(int argc, char **argv) {
    const char *names[] = {"x", "y", "z", "vx", "vy", "vz"};
    double row[64], largest = 0; /* t to vz, then t_hex to vz_hex: row[7] to row[13] */
    long rows = -1, transits = -1; /* the header is no row */
    const char *folder = argc > 1 ? argv[1] : ".";
    FILE *file = opened(folder, "grid.binary64.csv"), *json = opened(folder, "manifest.json");
    if (!file || !json) return fprintf(stderr, "%s: no golden dataset with doubles\n", folder), 2;
    for (; fgets(line, sizeof line, file); rows++) read_row(row);
    fread(manifest, 1, sizeof manifest - 1, json);
    printf("grid %ld\nt %.17g\n", rows, row[7]);
    const char *at = strstr(manifest, "\"bounds\"");
    for (int i = 0; i < 6; i++) { /* the columns' bounds stand there in this order */
        char key[16];
        snprintf(key, sizeof key, "\"%s\": \"", names[i]);
        at = strstr(at, key) + strlen(key);
        printf("%s %.17g %g\n", names[i], row[8 + i], strtod(at, NULL));
    }
    if (!(file = opened(folder, "transits.csv"))) return 0; /* of a scene without transits */
    for (; fgets(line, sizeof line, file); transits++, largest = row[8] > largest ? row[8] : largest) read_row(row);
    printf("transits %ld %g\n", transits, largest);
    return 0;
}
