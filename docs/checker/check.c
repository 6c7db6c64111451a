/* Proves every printed number of a golden dataset, or says which one is wrong.

       cc -O2 -o check check.c -lflint -lmpfr -lgmp -lm                  (FLINT 3)
       cc -O2 -o check check.c -lflint-arb -lflint -lmpfr -lgmp -lm      (FLINT 2.9 and Arb, Debian 12)
       ./check data/golden/paris

   Exit status: 0 every number is proved; 1 one is wrong, or could not be proved; 2 this is not a dataset.

   Nothing is taken from the solver that made the dataset, neither code nor radii nor steps. The inputs in
   manifest.json are the question, the other numbers the answer to be examined. What has to be believed: this file,
   FLINT's balls (an `arb_t` is an interval that surely contains the number meant), the C compiler, and the model:

       r'' = c - Omega x (Omega x r) - 2 Omega x r' - gamma r' + (a force along r),    |r| = 1,               (0)

   x east, y north, z up; lengths divided by that of the cord; c is gravity and the centrifugal force at the
   suspension; Omega turns with the Earth; gamma is the drag.

   1. THE SYSTEM.  Put v = r' and A = r x v - (Omega.r) r. Then, exactly,

       r' = A x r,      A' = r x c + A x Omega - gamma (A + (Omega.r) r).                                     (1)

   Proof. A x r = (r x v) x r = v, as |r| = 1 and r.v = 0. H = A + Omega = r x (v + Omega x r) is the angular momentum
   about the suspension, seen from axes that do not turn. It changes by the torque r x c - gamma r x v, and turning axes
   add H x Omega = A x Omega. Finally r x v = A + (Omega.r) r. []
   So (1) is quadratic: F(y) = L y + B(y, y) for y = (r, A), with L y = (0, r x c + A x Omega - gamma A).

   2. THE BOUND.  Let q = (p, K) be any curve of polynomials, d1 = p' - K x p and d2 = K' - (second line of (1) at q)
   its defects. Put e = r - p, g = A - K, and measure (e, g) by E = |e|^2 + |g|^2 / w^2, with a number w > 0. Then

       sqrt E(t) <= (sqrt E(0) + t max(|d1| + |d2|/w)) exp(nu t),
       nu = (|c| + w^2 + gamma |Omega| (1 + max|p|)) / (2w).                                                  (2)

   Proof. e' = g x r + K x e - d1;  g' = e x c + g x Omega - gamma (g + (Omega.e) r + (Omega.p) e) - d2.
   e.(K x e) = 0, g.(g x Omega) = 0, w^2 e.(g x r) = -w^2 g.(e x r). Hence (w^2/2) E' <= |g| |e| (|c - w^2 r| +
   gamma |Omega| (1 + |p|)) - gamma |g|^2 + w^2 |e| |d1| + |g| |d2|. For the true motion |r| = 1, and |g| |e| <= w E / 2;
   so (sqrt E)' <= nu sqrt E + |d1| + |d2|/w, and Gronwall's lemma gives (2). []
   Nothing is assumed about sizes; the true motion exists for all time, because its energy bounds |A|.

   3. SIX DIRECTIONS.  (2) alone would grow by exp(nu t) over the whole run. So on each step the true motion is written

       y = q + M zeta + u,     |zeta_j| <= z_j constant,   u(0) = 0,                                          (3)

   with six columns M_j = (P_j, Q_j) of polynomials, solutions of the linearised equation but for rounding. For each zeta
   the curve q + M zeta has by (1) exactly the defects

       d1 + sum zeta_j R1_j - (Q zeta) x (P zeta),     d2 + sum zeta_j R2_j + gamma (Omega.P zeta) (P zeta),

   R_j = M_j' - L M_j - B(M_j, q) - B(q, M_j). So (2) bounds u by what one step adds, and only M, which is known, grows.
   At a time s the set (3) is put into a new set of the same form: with a new frame G = M^(0) and the new start q^(0),
   z^_i = sum_j |G^-1 M(s)|_ij z_j + sum_k |G^-1|_ik (bound of u_k + |q(s) - q^(0)|_k). Steps overlap a little.

   4. DEFECTS COST NOTHING.  Coefficients come from y_{n+1} = h F(y)_n / (n+1) (time s in [0, 1] on a step of length h),
   computed in balls from exact y_0 ... y_n; y_{n+1} is the ball's centre. So its radius, times n+1, bounds the
   coefficient n of the defect. Orders beyond the last are bounded by sums of products of norms (`beyond`).

   5. ZEROS OF XDOT, and of other forms F = a.r + b.v - d with constant a, b, d.  A printed time t stands for
   I = [t - u/2, t + u/2], u one unit of its last digit. If N = t - F(t) / F'(I) lies in I, and 0 is not in F'(I), then F
   has exactly one zero in I, and it lies in N (mean value theorem). Everywhere else `no_zero` shows that F has the sign
   that the rows before and after demand; or, where zeros of one direction alone count, that F is not 0 or goes the other way.

   6. REST.  Hanging at rest, r = G / |G| with G = c - Omega x (Omega x r). A ball that contains r contains it after this
   map too, and begins as [-1, 1] in each direction.

   7. READING.  A folder may hold anything. Files and numbers are read through a `cursor`, which does not pass the end of its
   text, and cells of tables through `cell`, which refuses a row or column that is not there. What the program does not
   expect it refuses: another form of a number, a line without end, a key of a JSON document that nothing asked for.  */

#if __has_include(<flint/arb.h>)
#include <flint/arb.h>
#include <flint/arb_mat.h>
#else
#include <arb.h>
#include <arb_mat.h>
#endif
#include <flint/fmpq.h>
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST_BITS 4000
#define MOST_DEPTH 100    /* of halvings */
#define COLUMN_BITS 53
#define MOST_ORDER (MOST_BITS * 9 / 20 + 8)
#define MOST_STEPS 1e7
#define MOST_KEYS 5000    /* of a JSON document */
#define MOST_NESTED 10    /* brackets of a JSON document */
#define MOST_DIGITS 1000  /* significant ones */
#define MOST_PLACES 2900  /* characters of a number */
#define MOST_EXPONENT 500 /* an input is 0, or its size is from 1e-500 to 1e500 */
#define COLUMNS 20        /* at most, of a table that is proved */
#define TEXTS 8
#define MOST_FORMS 40     /* xdot and sections */
#define HAND_OVER 0.984375 /* s at which the next step begins: a printed time and its half unit lie in one step */
_Static_assert(LDBL_MIN_EXP < -16000, "bounds are long doubles, and must not underflow");

/* FLINT's numbers are 0 and ready for use where the memory is: what is `static` below needs no arb_init. */

/* ------------------------------------------------------------------------------------------------ verdicts and texts */

#define stop(status, ...) (printf(__VA_ARGS__), exit(status))
#define wrong(...) stop(1, "WRONG: " __VA_ARGS__)
#define no_dataset(...) stop(2, "not a dataset: " __VA_ARGS__)

static const char *folder;

/* A formatted text; it lasts until TEXTS more are made. */
static const char *text(const char *format, ...) {
    static char texts[TEXTS][5000];
    static int n;
    va_list list;
    n = (n + 1) % TEXTS;
    va_start(list, format);
    int size = vsnprintf(texts[n], sizeof texts[n], format, list);
    va_end(list);
    if (size < 0 || size >= (int)sizeof texts[n])
        no_dataset("it has a text that is too long: %.40s ...\n", texts[n]);
    return texts[n];
}

static jmp_buf with_more_bits;
static char doubt[5000] = "these are too many digits";

/* An interval is too wide to decide: the run begins again, with more bits. */
#define undecided(...) (snprintf(doubt, sizeof doubt, __VA_ARGS__), longjmp(with_more_bits, 1))

/* Memory for a number of things, filled with 0. */
static void *memory(size_t count, size_t size) {
    void *all = calloc(count + 1, size);
    if (all == NULL)
        no_dataset("it does not fit into the memory\n");
    return all;
}

/* A text that lasts. */
static char *copy(const char *from, size_t size) {
    char *to = memory(size, 1);
    memcpy(to, from, size);
    return to;
}

static const char *lasting(const char *from) {
    return copy(from, strlen(from));
}

/* ----------------------------------------------------------------------------------------------------------- a cursor */

#define FIGURES "0123456789"

/* A place in a text. All files and numbers are read by the functions below, and none of them passes the end. */
typedef struct {
    const char *name, *begin, *at, *end;
} cursor;

static cursor reading(const char *name, const char *all) {
    return (cursor){.name = name, .begin = all, .at = all, .end = all + strlen(all)};
}

static int at_end_of(const cursor *c) {
    return c->at == c->end;
}

/* Whether a mark comes next. */
static int sees(const cursor *c, const char *mark) {
    size_t size = strlen(mark);
    return (size_t)(c->end - c->at) >= size && memcmp(c->at, mark, size) == 0;
}

/* Goes past a mark, if it comes next. */
static int pass(cursor *c, const char *mark) {
    if (!sees(c, mark))
        return 0;
    c->at += strlen(mark);
    return 1;
}

/* Goes past characters that are all in `set`. Returns how many. */
static long pass_all(cursor *c, const char *set) {
    const char *from = c->at;
    while (c->at < c->end && strchr(set, *c->at))
        c->at++;
    return c->at - from;
}

/* Goes past a sign, if there is one. Returns whether it is a minus. */
static int pass_sign(cursor *c) {
    int minus = pass(c, "-");
    if (!minus)
        pass(c, "+");
    return minus;
}

/* Goes to the next character that is in `set`, or to the end. Returns what is before it. */
static char *take(cursor *c, const char *set) {
    const char *from = c->at;
    while (c->at < c->end && !strchr(set, *c->at))
        c->at++;
    return copy(from, c->at - from);
}

static void demand(cursor *c, const char *mark) {
    if (pass(c, mark))
        return;
    long line = 1;
    for (const char *before = c->begin; before < c->at; before++)
        line += *before == '\n';
    const char *wanted = *mark == '\n' ? "the end of the line" : mark;
    const char *instead = text("%.40s", take(c, "\n"));
    no_dataset("%s, line %ld: %s should be here, not \"%s\"\n", c->name, line, wanted, instead);
}

/* -------------------------------------------------------------------------------------------------------------- files */

/* A JSON document as pairs, "scene.run.t_end" or "possible.0.parity" and a text; and which of them were asked for. */
typedef struct {
    const char *name;
    const char *key[MOST_KEYS], *value[MOST_KEYS];
    char asked_for[MOST_KEYS];
    long count;
} document;

static document *manifest;

/* The place of a key, or -1. */
static long place_of(const document *d, const char *key) {
    for (long i = 0; i < d->count; i++)
        if (strcmp(d->key[i], key) == 0)
            return i;
    return -1;
}

/* The value of a key, or NULL. */
static const char *maybe(document *d, const char *key) {
    long i = place_of(d, key);
    if (i < 0)
        return NULL;
    d->asked_for[i] = 1;
    return d->value[i];
}

static const char *get(document *d, const char *key) {
    const char *value = maybe(d, key);
    if (value == NULL)
        no_dataset("%s has no %s\n", d->name, key);
    return value;
}

/* What a file contains, or NULL where there is none. What the manifest lists must be there. */
static const char *contents(const char *name) {
    char *all = NULL;
    size_t room = 0;
    FILE *file = fopen(text("%s/%s", folder, name), "rb");
    if (file == NULL && manifest && place_of(manifest, text("files.%s.bytes", name)) >= 0)
        no_dataset("%s is in the list of manifest.json, and cannot be opened\n", name);
    if (file == NULL)
        return NULL;
    ssize_t size = getdelim(&all, &room, 0, file);        /* all of it, or up to a byte 0, with a 0 behind */
    if (size <= 0 || !feof(file) || all[size - 1] == 0)
        no_dataset("%s cannot be read, is empty, or has a byte 0\n", name);
    fclose(file);
    return all;
}

static void add_pair(document *d, const char *key, const char *value) {
    if (place_of(d, key) >= 0)
        no_dataset("%s: %s comes twice\n", d->name, key);
    if (d->count == MOST_KEYS)
        no_dataset("%s has more than %d keys\n", d->name, MOST_KEYS);
    d->key[d->count] = lasting(key);
    d->value[d->count] = value;
    d->count++;
}

static void pass_space(cursor *c) {
    pass_all(c, " \n");
}

static char *quoted(cursor *c) {
    demand(c, "\"");
    char *inside = take(c, "\"\n");
    demand(c, "\"");
    return inside;
}

static void read_value(document *d, const char *key, cursor *c, int depth);

/* Reads what is in brackets, after the first: items with names, or items that are numbered from 0. */
static void read_items(document *d, const char *key, cursor *c, int depth, int has_names, const char *last) {
    const char *prefix = lasting(*key ? text("%s.", key) : "");
    if (depth == MOST_NESTED)
        no_dataset("%s has more than %d brackets in one another\n", d->name, MOST_NESTED);
    pass_space(c);
    if (pass(c, last))
        return;
    for (long item = 0;; item++) {
        pass_space(c);
        const char *name = has_names ? quoted(c) : text("%ld", item);
        const char *inner = lasting(text("%s%s", prefix, name));
        if (has_names)
            demand(c, ": ");
        read_value(d, inner, c, depth + 1);
        pass_space(c);
        if (pass(c, last))
            return;
        demand(c, ",");
    }
}

/* A number, true, false or null. */
static char *bare(cursor *c) {
    char *value = take(c, ", \n]}");
    int is_word = strcmp(value, "true") == 0 || strcmp(value, "false") == 0 || strcmp(value, "null") == 0;
    cursor inside = reading(c->name, value);
    pass_sign(&inside);
    int is_number = pass_all(&inside, FIGURES ".eE+-") > 0 && at_end_of(&inside);
    if (!is_word && !is_number)
        no_dataset("%s: \"%.60s\" is no value\n", c->name, value);
    return value;
}

/* Reads the value of a key, at whose begin the cursor is. */
static void read_value(document *d, const char *key, cursor *c, int depth) {
    if (pass(c, "{"))
        read_items(d, key, c, depth, 1, "}");
    else if (pass(c, "["))
        read_items(d, key, c, depth, 0, "]");
    else
        add_pair(d, key, sees(c, "\"") ? quoted(c) : bare(c));
}

/* Reads JSON without escapes; NULL where there is no such file. */
static document *read_document(const char *name) {
    const char *all = contents(name);
    if (all == NULL)
        return NULL;
    document *d = memory(1, sizeof *d);
    d->name = name;
    if (strchr(all, '\\'))
        no_dataset("%s has a \\ in it\n", name);
    cursor c = reading(name, all);
    read_value(d, "", &c, 0);
    demand(&c, "\n");
    if (!at_end_of(&c))
        no_dataset("%s goes on after its end\n", name);
    return d;
}

/* A table of texts, with that of its doubles, if any. */
typedef struct table {
    const char *name;                 /* "grid.csv" */
    const char *decimals, *bounds;    /* where the manifest has those of its columns */
    long rows, columns;
    long first;                       /* the place of column 0: 1 in sections.csv, where the word is column -1 */
    const char **heads, **cells;
    struct table *doubles;
    double widest;                    /* distance of a printed number from the true one, in units of its last digit */
    long digits[COLUMNS];             /* most significant digits of a column */
    fmpq bound[COLUMNS];              /* largest bound of a column */
} table;

static void demand_column(const table *t, long column) {
    if (column + t->first < 0 || column + t->first >= t->columns)
        no_dataset("%s has no column %ld\n", t->name, column);
}

static const char *head(const table *t, long column) {
    demand_column(t, column);
    return t->heads[column + t->first];
}

static const char *cell(const table *t, long row, long column) {
    demand_column(t, column);
    if (row < 0 || row >= t->rows)
        no_dataset("%s has no row %ld\n", t->name, row + 1);
    return t->cells[row * t->columns + column + t->first];
}

/* The column of a name, or -1. */
static long column_of(const table *t, const char *name) {
    for (long i = 0; i < t->columns; i++)
        if (strcmp(t->heads[i], name) == 0)
            return i;
    return -1;
}

/* Reads one line into `to`: as many cells as the table has columns. */
static void read_line(const table *t, cursor *c, const char **to) {
    for (long i = 0; i < t->columns; i++) {
        to[i] = take(c, ",\n");
        demand(c, i + 1 < t->columns ? "," : "\n");
    }
}

/* Reads a table: a header, and then lines of as many cells, each with its end. NULL where there is no such file. */
static table *read_table(const char *name, const char *header) {
    const char *all = contents(name);
    if (all == NULL)
        return NULL;
    table *t = memory(1, sizeof *t);
    long lines = 0;
    t->name = lasting(name);
    t->columns = 1;
    for (const char *c = header; *c; c++)
        t->columns += *c == ',';
    for (const char *c = all; *c; c++)
        lines += *c == '\n';
    cursor c = reading(t->name, all);
    if (!sees(&c, text("%s\n", header)))
        no_dataset("%s: the first line must be %s\n", name, header);
    t->heads = memory(t->columns, sizeof *t->heads);
    t->cells = memory(lines * t->columns, sizeof *t->cells);
    read_line(t, &c, t->heads);
    for (; t->rows < lines - 1; t->rows++)
        read_line(t, &c, t->cells + t->rows * t->columns);
    if (!at_end_of(&c))
        no_dataset("%s: the last line has no end\n", name);
    return t;
}

/* A table, with that of its doubles, which has columns more. */
static table *read_tables(const char *kind, const char *header, const char *more) {
    table *t = read_table(text("%s.csv", kind), header);
    if (t == NULL)
        no_dataset("no %s.csv\n", kind);
    t->decimals = lasting(text("decimals.%s", kind));
    t->bounds = lasting(text("bounds.%s", kind));
    t->doubles = read_table(text("%s.binary64.csv", kind), text("%s,%s", header, more));
    if (t->doubles && t->doubles->rows != t->rows)
        wrong("%s has %ld rows, and %s %ld\n", t->name, t->rows, t->doubles->name, t->doubles->rows);
    return t;
}

/* ----------------------------------------------------------------------------------------------------- exact numbers */

static fmpz_t ten_to;

static void power_of_ten(long n) {
    fmpz_set_ui(ten_to, 10);
    fmpz_pow_ui(ten_to, ten_to, n);
}

/* A whole number from 0 to `most`, which has at most nine figures. */
static long whole(const char *name, const char *printed, long most) {
    cursor c = reading(name, printed);
    long figures = pass_all(&c, FIGURES);
    int is_whole = figures > 0 && figures <= 9 && at_end_of(&c);
    long value = is_whole ? strtol(printed, NULL, 10) : -1;
    if (value < 0 || value > most)
        no_dataset("%s is %s, and not a whole number from 0 to %ld\n", name, printed, most);
    return value;
}

/* Goes past an exponent after e or E, if there is one. Returns it, or MOST_PLACES where it is too large, or no number. */
static long pass_exponent(cursor *c) {
    if (!pass(c, "e") && !pass(c, "E"))
        return 0;
    int minus = pass_sign(c);
    const char *begin = c->at;
    long figures = pass_all(c, FIGURES);
    if (figures < 1 || figures > 9)
        return MOST_PLACES;
    long size = strtol(begin, NULL, 10);
    return minus ? -size : size;
}

/* The exact value of a decimal such as -7.29e-5. */
static void decimal(fmpq_t value, const char *printed) {
    cursor c = reading("number", printed);
    int minus = pass_sign(&c);
    const char *before = c.at;
    long figures_before = pass_all(&c, FIGURES);
    pass(&c, ".");
    const char *after = c.at;
    long figures_after = pass_all(&c, FIGURES);      /* 0 without a point: `before` has them all */
    long exponent = pass_exponent(&c);
    long figures = figures_before + figures_after;
    if (!at_end_of(&c) || figures < 1 || figures > MOST_PLACES || labs(exponent) >= MOST_PLACES)
        no_dataset("\"%.60s\" is not a number\n", printed);
    fmpz_set_str(fmpq_numref(value), text("%.*s%.*s", (int)figures_before, before, (int)figures_after, after), 10);
    fmpz_one(fmpq_denref(value));
    exponent -= figures_after;
    power_of_ten(labs(exponent));
    if (exponent < 0)
        fmpq_div_fmpz(value, value, ten_to);
    else
        fmpq_mul_fmpz(value, value, ten_to);
    if (minus)
        fmpq_neg(value, value);
}

static long places(const char *printed) {
    const char *point = strchr(printed, '.');
    return point ? (long)strlen(point + 1) : 0;
}

/* The exact value of a number of a table: figures, a point between figures if at all, and a sign only if it is negative. */
static void printed_value(fmpq_t value, const char *name, const char *printed) {
    cursor c = reading(name, printed);
    int minus = pass(&c, "-");
    int is_zero_before = sees(&c, "0");
    long before = pass_all(&c, FIGURES);
    int has_point = pass(&c, ".");
    long after = pass_all(&c, FIGURES);
    int is_number = before > 0 && (after > 0) == has_point && at_end_of(&c) && !(is_zero_before && before > 1);
    if (is_number)
        decimal(value, printed);
    if (!is_number || (minus && fmpq_sgn(value) >= 0))
        no_dataset("%s: \"%.60s\" is not a number as a table has it\n", name, printed);
}

/* The exact value of a finite double. */
static void exact_double(fmpq_t value, double x) {
    static arf_t exact;
    if (!isfinite(x))
        no_dataset("it has a number that no double holds\n");
    arf_set_d(exact, x);
    arf_get_fmpq(value, exact);
}

/* The double of a hexfloat such as -0x1.6fa76f9d5e5b1p-2, of which no digit may be lost. */
static double hexfloat(const char *name, const char *printed) {
    cursor c = reading(name, printed);
    int minus = pass(&c, "-");
    int is_small = sees(&c, "0x0.");
    const char *significand = c.at;
    int has_begin = pass(&c, "0x0.") || pass(&c, "0x1.");
    long figures = pass_all(&c, FIGURES "abcdef");
    int has_exponent = sees(&c, "p+") || sees(&c, "p-");
    long size = c.at - significand;
    pass(&c, "p");
    const char *exponent = c.at;
    pass_sign(&c);
    long exponent_figures = pass_all(&c, FIGURES);
    int is_short = figures <= 13 && exponent_figures <= 4;
    if (!has_begin || figures < 1 || !has_exponent || exponent_figures < 1 || !is_short || !at_end_of(&c))
        no_dataset("%s: \"%.60s\" is not a hexfloat\n", name, printed);
    double exact = strtod(text("%.*s", (int)size, significand), NULL);
    int power = (int)strtol(exponent, NULL, 10);
    double value = ldexp(exact, power);
    if (!isfinite(value) || ldexp(value, -power) != exact || (value < DBL_MIN) != is_small)
        no_dataset("%s: no double is written as %.60s\n", name, printed);
    return minus ? -value : value;
}

static int as_doubles;

/* An input of the scene: the decimal itself, or the double next to it. It must be 0, or of a size that bounds can have. */
static void input(fmpq_t value, const char *key) {
    static fmpq_t most, size;
    const char *given = get(manifest, text("scene.%s", key));
    decimal(value, given);
    if (as_doubles)
        exact_double(value, strtod(given, NULL));
    if (fmpq_is_zero(value))
        return;
    power_of_ten(MOST_EXPONENT);
    fmpq_set_fmpz(most, ten_to);
    fmpq_abs(size, value);
    if (fmpq_cmp(size, most) > 0)
        no_dataset("%s is above 1e%d\n", key, MOST_EXPONENT);
    fmpq_inv(most, most);
    if (fmpq_cmp(size, most) < 0)
        no_dataset("%s is below 1e-%d\n", key, MOST_EXPONENT);
}

/* An input that must be `least` at least, or above it. */
static void input_from(fmpq_t value, const char *key, long least, int above) {
    static fmpq_t limit;
    input(value, key);
    fmpq_set_si(limit, least, 1);
    int order = fmpq_cmp(value, limit);
    if (order < 0 || (above && order == 0))
        no_dataset("%s must be %s %ld\n", key, above ? "above" : "at least", least);
}

/* An input that may be left out: then it is 0. */
static void input_or_0(fmpq_t value, const char *key) {
    if (maybe(manifest, text("scene.%s", key)))
        input(value, key);
    else
        fmpq_zero(value);
}

/* Bounds are long doubles, sums and products of such numbers >= 0. Each operation is right to 2^-63 of its result, and no
   bound takes 10^8 of them: where one is used it is multiplied by UP. Where a result underflows, what is lost is below
   2^-16400, and below 2^-10000 by the time it counts, for inputs, w and h are no smaller and no larger than doubles and
   1e+-500 are: TINY is added for it. No decimal of a table is so long that this could be seen. */
#define UP (1 + 1e-9L)
#define TINY 0x1p-10000L

static long double bound_of(const mag_t m) {
    if (mag_cmp_2exp_si(m, 16000) >= 0)
        return INFINITY;
    if (mag_cmp_2exp_si(m, -16000) <= 0)
        return mag_is_zero(m) ? 0 : ldexpl(1, -16000);
    return ldexpl(MAG_MAN(m), MAG_EXP(m) - MAG_BITS);
}

/* |x|, rounded up. */
static long double up(const arb_t x) {
    static mag_t m;
    arb_get_mag(m, x);
    return bound_of(m);
}

/* |a|, by hypotl, in which no square underflows. */
static long double size(arb_srcptr a) {
    return hypotl(hypotl(up(a), up(a + 1)), up(a + 2));
}

/* Makes x wider by r. */
static void widen(arb_t x, long double r) {
    static mag_t m;
    int exponent = 0;
    mag_set_d(m, (double)frexpl(r * UP, &exponent) * (double)UP);
    mag_mul_2exp_si(m, m, exponent);
    arb_add_error_mag(x, m);
}

/* ------------------------------------------------------------------------------------------------- the scene in balls */

static slong bits;                                /* of all balls that follow, and 64 more for what they begin with */
static fmpq_t end, grid_step;                     /* of the run, in s */
static arb_t length, radius, gravity, rate, drag, sine, cosine;
static arb_struct omega[3], c[3], begin_r[3], begin_v[3];
static double w;                                  /* a power of two */
static int at_rest, never;                        /* at the release; xdot = 0 for ever */

static void ball(arb_t x, const char *key) {
    static fmpq_t value;
    input(value, key);
    arb_set_fmpq(x, value, bits + 64);
}

static void ball_or_0(arb_t x, const char *key) {
    static fmpq_t value;
    input_or_0(value, key);
    arb_set_fmpq(x, value, bits + 64);
}

static void ball_from(arb_t x, const char *key, long least, int above) {
    static fmpq_t value;
    input_from(value, key, least, above);
    arb_set_fmpq(x, value, bits + 64);
}

static void sine_cosine(arb_t s, arb_t k, fmpq_t degrees) {
    static fmpz_t half_turn;
    fmpz_set_ui(half_turn, 180);
    fmpq_div_fmpz(degrees, degrees, half_turn);
    arb_sin_cos_pi_fmpq(s, k, degrees, bits + 64);
}

static void sine_cosine_of(arb_t s, arb_t k, const char *key) {
    static fmpq_t degrees;
    input(degrees, key);
    sine_cosine(s, k, degrees);
}

/* out += factor a x b. */
static void add_cross(arb_ptr out, int factor, arb_srcptr a, arb_srcptr b, slong p) {
    static arb_t t;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        arb_mul(t, a + j, b + k, p);
        arb_submul(t, a + k, b + j, p);
        arb_addmul_si(out + i, t, factor, p);
    }
}

static void cross(arb_ptr out, arb_srcptr a, arb_srcptr b, slong p) {
    _arb_vec_zero(out, 3);
    add_cross(out, 1, a, b, p);
}

/* Omega, R and c. Where g is effective it contains the centrifugal force at the suspension, as if that were on the axis. */
static void read_site(void) {
    static arb_t f, t;
    slong p = bits + 64;
    const char *kind = get(manifest, "scene.site.gravity_is");
    ball_from(length, "pendulum.length", 0, 1);
    ball_from(drag, "pendulum.drag", 0, 0);       /* (2) drops a term that has its sign */
    ball_from(gravity, "site.gravity", 0, 0);
    ball(rate, "site.rotation_rate");
    sine_cosine_of(sine, cosine, "site.latitude");
    arb_zero(f);
    if (strcmp(get(manifest, "scene.site.inverse_flattening"), "inf") != 0) {
        ball_from(f, "site.inverse_flattening", 1, 1);
        arb_inv(f, f, p);
    }
    arb_sub_ui(t, f, 2, p);
    arb_mul(t, t, f, p);                          /* -e^2, e the eccentricity */
    arb_mul(t, t, sine, p);
    arb_mul(t, t, sine, p);
    arb_add_ui(t, t, 1, p);
    arb_rsqrt(t, t, p);
    ball_from(radius, "site.equatorial_radius", 0, 0);
    arb_mul(radius, radius, t, p);                /* to the Earth's axis along the normal */
    ball(t, "site.altitude");
    arb_add(radius, radius, t, p);
    arb_mul(radius, radius, cosine, p);
    if (strcmp(kind, "effective") == 0)
        arb_zero(radius);
    else if (strcmp(kind, "ellipsoid") != 0)
        no_dataset("gravity_is must be ellipsoid or effective\n");
    arb_mul(omega + 1, rate, cosine, p);
    arb_mul(omega + 2, rate, sine, p);
    arb_mul(t, rate, radius, p);
    arb_mul(c + 1, t, omega + 2, p);
    arb_neg(c + 1, c + 1);
    arb_mul(c + 2, t, omega + 1, p);
    arb_sub(c + 2, c + 2, gravity, p);
    _arb_vec_scalar_div(c, c, 3, length, p);
}

/* Whether x vx + y vy = 0 exactly, so that the bob of a release by x and y moves neither up nor down. */
static int pushed_sideways(void) {
    static fmpq_t a, b, c, d;
    input(a, "release.x");
    input_or_0(b, "release.vx");
    input(c, "release.y");
    input_or_0(d, "release.vy");
    fmpq_mul(a, a, b);
    fmpq_addmul(a, c, d);
    return fmpq_is_zero(a);
}

/* The release over the length: x, y, vx, vy below the suspension, or angle from straight down, azimuth from east, rates. */
static void read_release(void) {
    static arb_t s, k, sa, ka, t;
    slong p = bits + 64;
    arb_struct *x = begin_r, *v = begin_v;
    if (maybe(manifest, "scene.release.angle") == NULL) {
        ball(x, "release.x");
        ball(x + 1, "release.y");
        ball_or_0(v, "release.vx");
        ball_or_0(v + 1, "release.vy");
        arb_mul(t, length, length, p);
        arb_dot(t, t, 1, x, 1, x, 1, 2, p);
        arb_sqrt(t, t, p);
        arb_neg(x + 2, t);
        arb_dot(v + 2, NULL, 0, x, 1, v, 1, 2, p);
        arb_div(v + 2, v + 2, t, p);
        if (pushed_sideways())
            arb_zero(v + 2);
        _arb_vec_scalar_div(x, x, 3, length, p);
        _arb_vec_scalar_div(v, v, 3, length, p);
        return;
    }
    sine_cosine_of(s, k, "release.angle");
    sine_cosine_of(sa, ka, "release.azimuth");
    arb_mul(x, s, ka, p);
    arb_mul(x + 1, s, sa, p);
    arb_neg(x + 2, k);
    ball_or_0(t, "release.angle_rate");
    arb_mul(v, t, k, p);
    arb_mul(v + 1, v, sa, p);
    arb_mul(v, v, ka, p);
    arb_mul(v + 2, t, s, p);
    ball_or_0(t, "release.azimuth_rate");
    arb_submul(v, t, x + 1, p);
    arb_addmul(v + 1, t, x, p);
    arb_const_pi(t, p);
    arb_div_ui(t, t, 180, p);
    _arb_vec_scalar_mul(v, v, 3, t, p);
}

/* g = c - Omega x (Omega x r), the force at rest. */
static void force_at(arb_ptr g, arb_srcptr r) {
    static arb_struct a[3];
    cross(a, omega, r, bits + 64);
    _arb_vec_set(g, c, 3);
    add_cross(g, -1, omega, a, bits + 64);
}

/* Whether xdot is 0 for ever, as the exact inputs say: in the plane x = 0 without rotation (reflect x: the solution is
   unique), and at rest where the force is along the cord. */
static void decide_never(void) {
    static arb_struct a[3], b[3];
    at_rest = _arb_vec_is_zero(begin_v, 3);
    force_at(b, begin_r);
    cross(a, begin_r, b, bits);
    never = (at_rest && _arb_vec_is_zero(a, 3)) || (arb_is_zero(rate) && arb_is_zero(begin_r) && arb_is_zero(begin_v));
}

/* A form F = a.r + b.v - d, and where it may be zero: around a printed time by half a unit of its last digit, or in a
   printed interval. */
typedef struct {
    fmpq_t from, to;
    long row;
    const char *parity;                           /* NULL for a printed time */
} event;

typedef struct {
    const char *word, *possible;                  /* "xdot", or that of a section; where the manifest has its intervals */
    table *t;
    long first, rows;                             /* of the table, from its row `first` on */
    arb_struct a[3], b[3], d[1];
    int one_way;                                  /* the direction of the zeros that count; 0 for both */
    int from_zero, from_double_zero;              /* F = 0 at the release; dF/dt = 0 there as well */
    event *events;
    long all, next, intervals;                    /* events, those that are done, intervals among all */
    int sign;                                     /* that F must have now; 0 where no row says it yet */
    fmpq_t clear_from;                            /* what is before this time is done */
} form;

static form forms[MOST_FORMS];
static int count_of_forms;

/* a, b, d of a word, azimuths from east to north; and what the exact inputs say of F at the release. In the meridian plane
   nothing at rest is pulled to the east. */
static void make_form(form *f) {
    static arb_struct along[3], rest[3];
    static arb_t s;
    static fmpq_t azimuth;
    const char *space = strchr(f->word, ' ');
    const char *angle = space ? space + 1 : "0";  /* xdot is turn 0 */
    decimal(azimuth, text("%.*s", (int)strcspn(angle, "@"), angle));
    sine_cosine(along + 1, along, azimuth);
    arb_zero(along + 2);
    _arb_vec_zero(f->a, 3);
    _arb_vec_zero(f->b, 3);
    arb_zero(f->d);
    if (strncmp(f->word, "turn ", 5) == 0 || strcmp(f->word, "xdot") == 0)
        _arb_vec_set(f->b, along, 3);
    else if (strncmp(f->word, "gate ", 5) != 0)
        _arb_vec_neg(f->b, c, 3);
    else if (strstr(f->word, "@0")) {
        arb_neg(f->a, along + 1);
        arb_set(f->a + 1, along);
    } else {
        cross(f->a, along, c, bits + 64);
        for (int i = 0; i < 3; i++)
            arb_zero_pm_one(rest + i);
        for (long n = 0; n < bits; n++) {
            force_at(along, rest);
            arb_dot(s, NULL, 0, along, 1, along, 1, 3, bits + 64);
            arb_rsqrt(s, s, bits + 64);
            if (!arb_is_finite(s))
                undecided("there may be no rest position for %s", f->word);
            _arb_vec_scalar_mul(rest, along, 3, s, bits + 64);
        }
        arb_dot(f->d, NULL, 0, f->a, 1, rest, 1, 3, bits + 64);
    }
    arb_dot(s, f->d, 1, f->a, 1, begin_r, 1, 3, bits);
    arb_dot(s, s, 1, f->b, 1, begin_v, 1, 3, bits);
    f->one_way = (strcmp(f->word, "lowest") == 0) - (strcmp(f->word, "highest") == 0);
    f->from_zero = arb_is_zero(s);
    f->from_double_zero = at_rest && arb_is_zero(begin_r) && _arb_vec_is_zero(f->a, 3) && _arb_vec_is_zero(f->b + 1, 2);
}

/* ------------------------------------------------------------------------------------------------------------- curves */

/* A curve of polynomials in s: coefficients of r, A and Omega.r; the lengths of those of r and A, and their sums from an
   order on. */
typedef struct {
    arb_struct x[MOST_ORDER + 2][7];
    long double r[MOST_ORDER + 3], a[MOST_ORDER + 3], sum_r[MOST_ORDER + 3], sum_a[MOST_ORDER + 3];
    slong order;
} curve;

static slong highest;                             /* order of q */
static double h;                                  /* length of the step, of 20 bits */
static fmpq_t step_begin, step_next;              /* in s; the next step begins at step_next, a little before the end */
static curve q, rough, column[6];                 /* rough is q in few bits, for the columns */
static long double z[6], u_r;                     /* bounds of zeta and of u = (u_r, w u_r) on the step */
static long double error_r, error_a;              /* bounds of r - p and A - K on the step */
static long double size_c, size_omega, size_drag;
static arb_struct powers[MOST_ORDER + 2];

/* out = r x c + a x Omega - gamma (a + s). */
static void turning(arb_ptr out, arb_srcptr r, arb_srcptr a, arb_srcptr s, slong p) {
    _arb_vec_add(out, a, s, 3, p);
    _arb_vec_scalar_mul(out, out, 3, drag, p);
    _arb_vec_neg(out, out, 3);
    add_cross(out, 1, r, c, p);
    add_cross(out, 1, a, omega, p);
}

/* t += or -= the coefficient n of the product of component i of a and j of b. */
static void product(arb_t t, int minus, const curve *a, int i, const curve *b, int j, slong n, slong p) {
    arb_dot(t, t, minus, a->x[0] + i, 7, b->x[n] + j, -7, n + 1, p);
}

/* t = the coefficient n of F(q) if u = q, else of the linearised L u + B(u, q) + B(q, u). */
static void field(arb_ptr t, const curve *u, slong n, slong p) {
    static arb_struct along[3];
    const curve *y = u == &q ? &q : &rough;
    _arb_vec_zero(t, 3);
    _arb_vec_zero(along, 3);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        for (int both = 0; both <= (u != &q); both++) {
            const curve *a = both ? y : u, *b = both ? u : y;
            product(t + i, 0, a, 3 + j, b, k, n, p);
            product(t + i, 1, a, 3 + k, b, j, n, p);
            if (!arb_is_zero(drag))
                product(along + i, 0, a, 6, b, i, n, p);
        }
    }
    turning(t + 3, u->x[n], u->x[n] + 3, along, p);
}

/* What follows from the first six components of the coefficient n. */
static void complete(curve *u, slong n, slong p) {
    if (!arb_is_zero(drag))
        arb_dot(u->x[n] + 6, NULL, 0, omega, 1, u->x[n], 1, 3, p);
    u->r[n] = size(u->x[n]);
    u->a[n] = size(u->x[n] + 3);
}

/* The component i at the time s whose powers are in `powers`. */
static void at_powers(arb_t out, const curve *u, int i, slong p) {
    arb_dot(out, NULL, 0, u->x[0] + i, 7, powers, 1, u->order + 1, p);
}

/* Bounds the orders of h (L u + ...) from that of u on by products of lengths: |a x b| <= |a| |b|. */
static long double beyond(const curve *u) {
    slong m = u->order;
    int both = u != &q;
    long double first = 0, second = u->r[m] * size_c + u->a[m] * (size_omega + size_drag);
    for (slong i = m > q.order ? m - q.order : 0; i <= m; i++) {
        first += u->a[i] * q.sum_r[m - i] + both * u->r[i] * q.sum_a[m - i];
        second += (1 + both) * size_drag * size_omega * u->r[i] * q.sum_r[m - i];
    }
    return h * (first + second / w);
}

/* Expands u from its coefficients of order 0 to the order `highest`, or until they are below 2^least of the first. Returns a
   bound of |d1| + |d2|/w on the step. Coefficients need p bits after the point, not p significant ones. */
static long double expand(curve *u, slong p, double least) {
    static arb_struct t[7];
    static arf_t step;
    long double defect = 0, last = 0, first;
    slong n = 0;
    arf_set_d(step, h);
    complete(u, 0, p);
    first = u->r[0] + u->a[0] / w;
    for (; n < highest; n++) {
        long double now = u->r[n] + u->a[n] / w;
        double smaller = fmax(log2l(fmaxl(now, last) / first), -p);
        last = now;
        if (n > 8 && smaller < least)
            break;
        slong enough = fmax(32, p + 8 + fmin(0, smaller));
        field(t, u, n, enough);
        for (int i = 0; i < 6; i++) {
            arb_mul_arf(t + i, t + i, step, enough);
            arb_div_ui(t + i, t + i, n + 1, enough);
            defect += (n + 1) * bound_of(arb_radref(t + i)) / (i < 3 ? 1 : w);
            mag_zero(arb_radref(t + i));
            arb_swap(u->x[n + 1] + i, t + i);
        }
        complete(u, n + 1, enough);
    }
    u->order = n;
    u->sum_r[n + 1] = u->sum_a[n + 1] = 0;
    for (; n >= 0; n--) {
        u->sum_r[n] = u->sum_r[n + 1] + u->r[n];
        u->sum_a[n] = u->sum_a[n + 1] + u->a[n];
    }
    return defect + beyond(u);
}

/* -------------------------------------------------------------------------------------------------------------- steps */

static arb_mat_t frame, at_end, inverse;

static double entry(const arb_mat_t m, int i, int j) {
    return arf_get_d(arb_midref(arb_mat_entry(m, i, j)), ARF_RND_NEAR);
}

/* Rows of r count in units of 1, those of A in units of w. */
static double unit(int row) {
    return row < 3 ? 1 : w;
}

static double dot(const double *a, const double *b) {
    double sum = 0;
    for (int i = 0; i < 6; i++)
        sum += a[i] * b[i];
    return sum;
}

/* Puts the set at the end of the step, and the jump to its rounded centre, into a new frame. Any frame is right; a good one
   keeps the set narrow: the columns themselves, or, where one has nearly fallen into the span of others, orthonormal ones
   (Gram and Schmidt, twice), the widest direction of the set first. */
static void next_frame(const long double *jump) {
    double x[6][6], *done[6], least = 1;
    long double width[6], wider[6] = {0};
    for (int j = 0; j < 6; j++) {
        for (int i = 0; i < 6; i++) {
            at_powers(arb_mat_entry(at_end, i, j), column + j, i, COLUMN_BITS);
            x[j][i] = entry(at_end, i, j) / unit(i);
            arb_set_d(arb_mat_entry(frame, i, j), entry(at_end, i, j));
        }
        width[j] = sqrt(dot(x[j], x[j])) * z[j];
    }
    for (int n = 0; n < 6; n++) {
        int widest = 0;
        for (int j = 1; j < 6; j++)
            if (width[j] > width[widest])
                widest = j;
        width[widest] = -1;
        done[n] = x[widest];
        double before = sqrt(dot(done[n], done[n]));
        for (int k = 0; k < 2 * n; k++) {
            double part = dot(done[n], done[k % n]);
            for (int i = 0; i < 6; i++)
                done[n][i] -= part * done[k % n][i];
        }
        double after = sqrt(dot(done[n], done[n]));
        least = fmin(least, after / before);
        for (int i = 0; i < 6; i++)
            done[n][i] /= after;
    }
    for (int i = 0; least < 0.01 && i < 6; i++)
        for (int n = 0; n < 6; n++)
            arb_set_d(arb_mat_entry(frame, i, n), unit(i) * done[n][i]);
    if (!arb_mat_inv(inverse, frame, COLUMN_BITS))
        undecided("the set of possible motions cannot be put into a frame at t = %g", fmpq_get_d(step_begin));
    arb_mat_mul(at_end, inverse, at_end, COLUMN_BITS);
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < 6; j++) {
            wider[i] += up(arb_mat_entry(at_end, i, j)) * z[j];
            wider[i] += up(arb_mat_entry(inverse, i, j)) * (unit(j) * u_r + jump[j]);
        }
    }
    for (int i = 0; i < 6; i++)
        z[i] = wider[i] * UP + TINY;
}

static table no_transits = {.name = "transits.csv"}, *transits = &no_transits, *sections;
static fmpq_t half;                               /* a unit of the last digit of the times of zeros */

static void set_length(double x) {
    int exponent = 0;
    double part = frexp(fmin(0.99 * x, fmin(4 / (w + (double)size_omega), 8 / (double)size_drag)), &exponent);
    h = ldexp(floor(ldexp(part, 20)), exponent - 20);
    if (!isfinite(h) || h <= 0)
        undecided("there is no step after t = %g", fmpq_get_d(step_begin));
    exact_double(step_next, h * HAND_OVER);
    fmpq_add(step_next, step_next, step_begin);
    if (h * (1 - HAND_OVER) < 4 * fmpq_get_d(half))
        stop(1, "not proved: the times of zeros have too few digits for steps of %g s\n", h);
}

static void start(void) {
    static arb_struct a[6];
    read_site();
    read_release();
    decide_never();
    for (int i = 0; i < count_of_forms; i++)
        make_form(forms + i);
    cross(a + 3, begin_r, begin_v, bits + 64);
    arb_dot(a, NULL, 0, omega, 1, begin_r, 1, 3, bits + 64);
    for (int i = 0; i < 3; i++)
        arb_submul(a + 3 + i, a, begin_r + i, bits + 64);
    _arb_vec_set(a, begin_r, 3);
    size_c = size(c) * UP;
    size_omega = size(omega) * UP;
    size_drag = up(drag);
    long double fast = size_c + (size(begin_v) + size_omega) * (size(begin_v) + size_omega);
    w = fast > 0 ? ldexp(1, ilogbl(fast) / 2) : 1;
    if (!isfinite(fast) || !isfinite(w) || w < DBL_MIN)
        undecided("the forces or the release have no size that a double holds");
    arb_mat_zero(frame);
    for (int i = 0; i < 6; i++) {
        arb_set_d(arb_mat_entry(frame, i, i), unit(i));
        z[i] = bound_of(arb_radref(a + i)) / unit(i) * UP + TINY;
        mag_zero(arb_radref(a + i));
        arb_swap(q.x[0] + i, a + i);
    }
    fmpq_zero(step_begin);
    set_length(1 / w);
}

/* Makes q, the columns and the bounds on [step_begin, step_end]. Returns a good length for the next step. */
static double step(void) {
    double better = 1;
    long double added = TINY, zr = 0, za = 0, defect = 0, drags = size_drag * size_omega;
    for (int tries = 0; tries < 60; tries++) {
        defect = expand(&q, bits, -INFINITY);
        double excess = bits + log2l(beyond(&q));
        better = exp2(fmax(-9, fmin(2, -excess / highest)));
        if (excess < 9 && (excess > -20 || fmpq_sgn(step_begin) > 0 || tries > 20))
            break;
        set_length(h * better);
    }
    if (h * MOST_STEPS < fmpq_get_d(end))
        stop(1, "not proved: this takes more than %g steps\n", MOST_STEPS);
    for (slong n = 0; n <= highest; n++)
        _arb_vec_set_round(rough.x[n], q.x[n], 7, COLUMN_BITS);
    for (int j = 0; j < 6; j++) {
        for (int i = 0; i < 6; i++)
            arb_set(column[j].x[0] + i, arb_mat_entry(frame, i, j));
        added += z[j] * expand(column + j, COLUMN_BITS, -36);
        zr += z[j] * column[j].sum_r[0];
        za += z[j] * column[j].sum_a[0];
    }
    added += defect + h * (za * zr + drags * zr * zr / w);
    u_r = added * expl(h * (size_c + w * w + drags * (1 + q.sum_r[0] + zr)) / (2 * w) * UP) * UP;
    error_r = zr + u_r;
    error_a = za + w * u_r;
    return h * fmin(1.2, better);
}

/* The next step begins at the rounded end of this one. */
static void go_on(double length_of_next) {
    static arb_struct x[6];
    long double jump[6];
    arb_set_d(x, HAND_OVER);
    _arb_vec_set_powers(powers, x, highest + 1, bits);
    for (int i = 0; i < 6; i++) {
        at_powers(x + i, &q, i, bits);
        jump[i] = bound_of(arb_radref(x + i));
        mag_zero(arb_radref(x + i));
    }
    next_frame(jump);
    _arb_vec_set(q.x[0], x, 6);
    fmpq_set(step_begin, step_next);
    set_length(length_of_next);
}

/* ------------------------------------------------------------------------------------------------- the motion in balls */

enum { R = 0, A = 3, V = 6, A1 = 9, R2 = 12, A2 = 15, R3 = 18, ALL = 21 };

/* r, A, v, A', r'', A'', r''' at a time s of the step, or at all times of an interval s: (1) and its derivatives. */
static void motion(arb_ptr m, const arb_t s, slong p) {
    static arb_struct t[3], along[2];
    _arb_vec_set_powers(powers, s, q.order + 1, p);
    for (int i = 0; i < 6; i++) {
        at_powers(m + i, &q, i, p);
        widen(m + i, i < 3 ? error_r : error_a);
    }
    cross(m + V, m + A, m + R, p);
    arb_dot(along, NULL, 0, omega, 1, m + R, 1, 3, p);
    arb_dot(along + 1, NULL, 0, omega, 1, m + V, 1, 3, p);
    _arb_vec_scalar_mul(t, m + R, 3, along, p);
    turning(m + A1, m + R, m + A, t, p);
    cross(m + R2, m + A1, m + R, p);
    add_cross(m + R2, 1, m + A, m + V, p);
    _arb_vec_scalar_mul(t, m + V, 3, along, p);
    _arb_vec_scalar_addmul(t, m + R, 3, along + 1, p);
    turning(m + A2, m + V, m + A1, t, p);
    cross(m + R3, m + A2, m + R, p);
    add_cross(m + R3, 2, m + A1, m + V, p);
    add_cross(m + R3, 1, m + A, m + R2, p);
}

/* The derivative k of a form, from r, v, r'', r''' at `m`. */
static void value(arb_t out, const form *f, int k, arb_srcptr m, slong p) {
    static const int place[] = {R, V, R2, R3};
    arb_dot(out, k ? NULL : f->d, 1, f->a, 1, m + place[k], 1, 3, p);
    arb_dot(out, out, 1, f->b, 1, m + place[k + 1], 1, 3, p);
    arb_neg(out, out);
}

/* The s of a time. */
static void local(arb_t s, const arb_t t) {
    static arb_t begin;
    static arf_t step;
    arf_set_d(step, h);
    arb_set_fmpq(begin, step_begin, bits + 64);
    arb_sub(s, t, begin, bits + 64);
    arb_div_arf(s, s, step, bits + 64);
}

static void local_exact(arb_t s, const fmpq_t t) {
    arb_set_fmpq(s, t, bits + 64);
    local(s, s);
}

/* ---------------------------------------------------------------------------------------------------- printed numbers */

static table *grid;
static fmpq_t most_off;    /* units of the last digit: 1/2 at level enclosed, else 1 */

/* The printed bound of a number. */
static const char *bound_for(const table *t, long row, long col) {
    if (t == grid && col == 0)
        return "0";                               /* times of the grid are exact */
    if (t != grid && col == 1)
        return cell(t, row, t->columns - t->first - 1);
    return get(manifest, text("%s.%s", t->bounds, head(t, col)));
}

/* Demands the digits after the point that the manifest promises. */
static void check_places(const table *t, long row, long col) {
    const char *key = t->decimals ? text("%s.%s", t->decimals, head(t, col)) : "digits";
    const char *printed = cell(t, row, col);
    if (whole(key, get(manifest, key), MOST_PLACES) != places(printed))
        wrong("%s, row %ld: %s = %s has another number of decimals than promised\n", t->name, row + 1, head(t, col), printed);
}

/* Significant digits: all but the zeros before. */
static long significant(const char *printed) {
    long count = 0;
    for (const char *c = printed; *c; c++)
        count += *c >= '0' && *c <= '9' && (count > 0 || *c != '0');
    return count;
}

/* Proves that a double, in 17 digits and as a hexfloat, is the nearest to x, or to a number that is no further from x than
   `units` of the decimal's last digit. */
static void prove_double(const table *t, long row, long col, const arb_t x, const arb_t units, long decimals) {
    static arf_t low, high;
    static arb_t near, slack;
    const char *name = head(t, col), *printed = cell(t, row, col);
    const char *hex = cell(t, row, column_of(t, text("%s_hex", name)));
    double d = hexfloat(t->name, hex);
    if (strcmp(text("%.16e", d), printed) != 0)
        wrong("%s, row %ld: %s: %s and %s are not the same\n", t->name, row + 1, name, printed, hex);
    power_of_ten(decimals);
    arb_div_fmpz(slack, units, ten_to, bits);
    arb_set(near, x);
    arb_add_error(near, slack);
    arb_get_lbound_arf(low, near, bits + 64);
    arb_get_ubound_arf(high, near, bits + 64);
    double least = arf_get_d(low, ARF_RND_NEAR);
    double most = arf_get_d(high, ARF_RND_NEAR);
    if (!(least <= d && d <= most))
        wrong("%s, row %ld: %s = %s is not the nearest double\n", t->name, row + 1, name, printed);
}

/* What check_columns needs to know of the numbers of a column. */
static void note(table *t, long col, const char *printed, const fmpq_t bound, double off) {
    long digits = significant(printed);
    if (t->digits[col] < digits)
        t->digits[col] = digits;
    if (fmpq_cmp(t->bound + col, bound) < 0)
        fmpq_set(t->bound + col, bound);
    t->widest = fmax(t->widest, off);
}

/* Proves that a printed number is within half a unit of its last digit, and within `bound`, of all of x. */
static void prove(table *t, long row, long col, const arb_t x, const char *bound) {
    static arb_t off, limit;
    static fmpq_t value, promised, units;
    const char *printed = cell(t, row, col), *name = head(t, col);
    check_places(t, row, col);
    printed_value(value, t->name, printed);
    decimal(promised, bound);
    power_of_ten(places(printed));
    fmpq_mul_fmpz(units, promised, ten_to);
    arb_set_fmpq(limit, fmpq_cmp(units, most_off) < 0 ? units : most_off, bits);
    arb_set_fmpq(off, value, bits + 64);
    arb_sub(off, x, off, bits + 64);
    arb_mul_fmpz(off, off, ten_to, bits + 64);
    arb_abs(off, off);
    double about = arf_get_d(arb_midref(off), ARF_RND_NEAR);
    double wide = (double)bound_of(arb_radref(off));
    const char *what = text("%s, row %ld: %s = %s is off by %.6f +- %.2g units of its last digit (its bound is %s)", t->name,
                            row + 1, name, printed, about, wide, bound);
    if (arb_gt(off, limit))
        wrong("%s\n", what);
    if (!arb_le(off, limit))
        undecided("%s", what);
    note(t, col, printed, promised, about + wide);
    if (t->doubles)
        prove_double(t->doubles, row, col, x, limit, places(printed));
}

/* Demands that a table of doubles repeats what is not a number to be proved: k, direction, bound. */
static void check_repeated(const table *t) {
    for (long col = 0; t->doubles && col < t->columns; col++) {
        if (column_of(t->doubles, text("%s_hex", head(t, col))) >= 0)
            continue;
        for (long row = 0; row < t->rows; row++)
            if (strcmp(cell(t->doubles, row, col), cell(t, row, col)) != 0)
                wrong("%s, row %ld: %s is not that of %s\n", t->doubles->name, row + 1, head(t, col), t->name);
    }
}

/* ---------------------------------------------------------------------------------------------------------- the tables */

static arb_struct here[ALL];                      /* the motion at a time, or in an interval */

/* There are rows at the multiples of grid_step, and at last at t_end. A last multiple that misses t_end by no more than the
   rounding of inputs to doubles is none. */
static void count_rows(void) {
    static fmpq_t steps, tiny;
    static fmpz_t last;
    fmpq_div(steps, end, grid_step);
    fmpq_set_si(tiny, 1, 1L << 30);
    fmpq_sub(steps, steps, tiny);
    fmpz_cdiv_q(last, fmpq_numref(steps), fmpq_denref(steps));
    if (grid->rows < 2 || fmpz_cmp_si(last, grid->rows - 1) != 0)
        wrong("grid.csv has %ld rows, and should have one at each grid_step and at t_end\n", grid->rows);
}

/* Whether the release as it is given lies exactly between the printed number and the next one, which no ball can tell. */
static int is_tie(const char *name, const char *printed) {
    static fmpq_t off, given;
    if (maybe(manifest, text("scene.release.%s", name)) == NULL)
        return 0;
    input(given, text("release.%s", name));
    printed_value(off, "grid.csv", printed);
    fmpq_sub(off, off, given);
    fmpq_abs(off, off);
    power_of_ten(places(printed));
    fmpq_mul_fmpz(off, off, ten_to);
    return fmpz_is_one(fmpq_numref(off)) && fmpz_equal_si(fmpq_denref(off), 2);
}

static void check_grid_row(const fmpq_t t, long row) {
    static arb_t s, exactly;
    static fmpq_t printed, usual;
    fmpq_set(usual, most_off);
    check_places(grid, row, 0);
    printed_value(printed, "grid.csv", cell(grid, row, 0));
    if (!fmpq_equal(printed, t))
        wrong("grid.csv, row %ld: t = %s is not the time of this row\n", row + 1, cell(grid, row, 0));
    arb_set_fmpq(s, t, bits + 64);
    if (grid->doubles)
        prove_double(grid->doubles, row, 0, s, exactly, 0);
    local(s, s);
    motion(here, s, bits);
    for (int i = 0; i < 6; i++) {
        arb_mul(s, here + (i < 3 ? R + i : V + i - 3), length, bits + 64);
        check_places(grid, row, i + 1);
        if (row == 0 && is_tie(head(grid, i + 1), cell(grid, row, i + 1)))
            fmpq_set_si(most_off, 500001, 1000000);
        prove(grid, row, i + 1, s, bound_for(grid, row, i + 1));
        fmpq_set(most_off, usual);
    }
}

/* Adds the rows of a form: each time with half a unit of its last digit on both sides. */
static void add_rows(form *f) {
    static fmpq_t time, unit;
    if (f->rows == 0)
        return;
    power_of_ten(places(cell(f->t, f->first, 1)));
    fmpq_set_si(unit, 1, 2);
    fmpq_div_fmpz(unit, unit, ten_to);
    if (fmpq_cmp(unit, half) > 0)
        fmpq_set(half, unit);
    for (long i = 0; i < f->rows; i++) {
        event *e = f->events + f->all++;
        e->row = f->first + i;
        printed_value(time, f->t->name, cell(f->t, e->row, 1));
        fmpq_sub(e->from, time, unit);
        fmpq_add(e->to, time, unit);
        if (strcmp(cell(f->t, e->row, 0), text("%ld", i + 1)) != 0)
            wrong("%s, row %ld: its number is wrong\n", f->t->name, e->row + 1);
    }
}

/* Adds the intervals that a form has in the manifest, of which there may be MOST_KEYS. */
static void add_intervals(form *f) {
    for (; maybe(manifest, text("%s.%ld.from_s", f->possible, f->intervals)); f->intervals++) {
        const char *name = lasting(text("%s.%ld", f->possible, f->intervals));
        event *e = f->events + f->all++;
        e->row = f->intervals;
        e->parity = get(manifest, text("%s.parity", name));
        printed_value(e->from, name, get(manifest, text("%s.from_s", name)));
        printed_value(e->to, name, get(manifest, text("%s.to_s", name)));
        if (strcmp(e->parity, "odd") != 0 && strcmp(e->parity, "even") != 0 && strcmp(e->parity, "unknown") != 0)
            wrong("manifest.json: %s.parity is %s, and not odd, even or unknown\n", name, e->parity);
        if (fmpq_cmp(e->to, end) > 0)
            wrong("manifest.json: %s ends after the run\n", name);
    }
}

static int by_time(const void *a, const void *b) {
    return fmpq_cmp(((const event *)a)->from, ((const event *)b)->from);
}

/* Demands that rows and intervals are after the release, do not overlap, and that rows are in the order of time. */
static void check_order(const form *f) {
    static fmpq_t time;
    long row = f->first;
    fmpq_zero(time);
    for (long i = 0; i < f->all; i++) {
        const event *e = f->events + i;
        if (fmpq_cmp(time, e->from) > 0 || fmpq_cmp(e->from, e->to) >= 0)
            wrong("%s %ld begins before the release, or before the end of the last, or is empty\n",
                  e->parity ? "manifest.json: possible interval" : text("%s, row", f->t->name), e->row + 1);
        if (e->parity == NULL && e->row != row++)
            wrong("%s, row %ld: out of order\n", f->t->name, e->row + 1);
        fmpq_set(time, e->to);
    }
}

/* Adds a form with its rows of a table, and its intervals in the manifest. */
static void add_form(const char *word, const char *possible, table *t, long first, long rows) {
    form *f = forms + count_of_forms;
    if (count_of_forms == MOST_FORMS)
        no_dataset("sections: more than %d\n", MOST_FORMS - 1);
    for (int i = 0; i < count_of_forms; i++)
        if (strcmp(forms[i].word, word) == 0)
            no_dataset("sections: %s comes twice\n", word);
    *f = (form){.word = word, .possible = possible, .t = t, .first = first, .rows = rows};
    f->events = memory(rows + MOST_KEYS, sizeof(event));
    add_rows(f);
    add_intervals(f);
    qsort(f->events, f->all, sizeof(event), by_time);
    check_order(f);
    count_of_forms++;
}

/* Demands the word of a section: highest, lowest, turn 30, gate -12.5, gate 30@0. */
static void check_word(const char *word) {
    cursor c = reading("run.sections", word);
    int is_extreme = pass(&c, "highest") || pass(&c, "lowest");
    int is_gate = sees(&c, "gate ");
    int has_azimuth = pass(&c, "gate ") || pass(&c, "turn ");
    int is_right = is_extreme || has_azimuth;
    if (has_azimuth) {
        pass(&c, "-");
        is_right = pass_all(&c, FIGURES) > 0;
        if (pass(&c, "."))
            is_right = is_right && pass_all(&c, FIGURES) > 0;
    }
    if (is_gate)
        pass(&c, "@0");
    if (!is_right || !at_end_of(&c))
        no_dataset("run.sections: \"%.60s\" is no section\n", word);
}

/* Adds the section of a word, whose rows begin at `row`. Returns how many there are. */
static long add_section(const char *word, long row) {
    const char *key = lasting(text("sections.counts.%s", word));
    check_word(word);
    long count = whole(key, get(manifest, key), sections->rows);
    for (long i = row; i < row + count; i++)
        if (i >= sections->rows || strcmp(cell(sections, i, -1), word) != 0)
            wrong("sections.csv, row %ld: this should be one of %ld of %s\n", i + 1, count, word);
    add_form(word, lasting(text("sections.possible.%s", word)), sections, row, count);
    return count;
}

/* Adds the sections that a scene asks for, "highest; gate 90": their rows follow one another. */
static void add_sections(const char *words) {
    cursor c = reading("run.sections", words);
    long row = 0;
    do
        row += add_section(take(&c, ";"), row);
    while (pass(&c, "; "));
    if (!at_end_of(&c))
        no_dataset("run.sections: \"%.60s\" has no space after a semicolon\n", words);
    if (row != sections->rows)
        wrong("sections.csv has %ld rows, the manifest %ld\n", sections->rows, row);
}

/* ------------------------------------------------------------------------------------------------------ zeros of forms */

static int sign_at(const form *f, const arf_t s, slong p) {
    static arb_t x;
    arb_set_arf(x, s);
    motion(here, x, p);
    value(x, f, 0, here, p);
    return arb_sgn_nonzero(x);
}

/* Signs of F, F' and F'' that are proved on all of [a, b]; 0 where none is. */
static void signs_on(int *signs, const form *f, const arf_t a, const arf_t b) {
    static arb_t s, x;
    arb_set_interval_arf(s, a, b, bits);
    motion(here, s, bits / 2);
    for (int k = 0; k < 3; k++) {
        value(x, f, k, here, bits / 2);
        signs[k] = arb_sgn_nonzero(x);
    }
}

/* Whether F is 0 at a, because that is the release. */
static int begins_at_zero(const form *f, const arf_t a) {
    return fmpq_is_zero(step_begin) && arf_is_zero(a) && f->from_zero;
}

/* Whether F is proved to have its sign on [a, b], but for F = 0 at the release itself: as all its values there have it; or as
   it has the sign at both ends and is monotone; at the release, as it is 0 there and its first derivative that is not has
   it. The first sign that is found is F's, where no row says it yet. */
static int has_its_sign(form *f, const int *signs, const arf_t a, const arf_t b, const arf_t middle, double time) {
    int found = sign_at(f, middle, bits / 2);
    if (f->sign == 0)
        f->sign = found;
    int sign = f->sign;
    if (sign == 0)
        return 0;
    int is_bent_away = signs[1] == sign || (f->from_double_zero && signs[2] == sign);
    int is_proved = signs[0] == sign || (begins_at_zero(f, a) && is_bent_away);
    if (!is_proved && found != -sign && signs[1] != 0) {
        int left = sign_at(f, a, bits);
        int right = sign_at(f, b, bits);
        is_proved = left == sign && right == sign;
        if (left == -sign || right == -sign)
            found = -sign;
    }
    if (found == -sign)
        wrong("%s: %s has the sign %+d at t = %.17g: a zero beside it is missing or wrong\n", f->t->name, f->word, found, time);
    return is_proved;
}

/* Whether F, of which zeros of one direction count, is proved to have none on [a, b]: it is not 0 there, or goes the other
   way on all of it, or begins at 0 and is monotone. */
static int has_no_passage(const form *f, const int *signs, const arf_t a, const arf_t b, double time) {
    int one_way = f->one_way;
    if (signs[0] != 0 || signs[1] == -one_way || (begins_at_zero(f, a) && signs[1] != 0))
        return 1;
    if (signs[1] == one_way && sign_at(f, a, bits) == -one_way && sign_at(f, b, bits) == one_way)
        wrong("%s: %s has a zero near t = %.17g that is not printed\n", f->t->name, f->word, time);
    return 0;
}

/* Proves that F has no zero that counts on [a, b]: as a whole, or on its halves. */
static void keeps_sign(form *f, const arf_t a, const arf_t b, int depth) {
    static arf_t middles[MOST_DEPTH + 1];
    arf_struct *middle = middles[depth];
    int signs[3];
    arf_add(middle, a, b, bits, ARF_RND_NEAR);
    arf_mul_2exp_si(middle, middle, -1);
    double time = fmpq_get_d(step_begin) + h * arf_get_d(middle, ARF_RND_NEAR);
    signs_on(signs, f, a, b);
    if (f->one_way ? has_no_passage(f, signs, a, b, time) : has_its_sign(f, signs, a, b, middle, time))
        return;
    if (depth == MOST_DEPTH)
        undecided("%s: a zero of %s near t = %.17g cannot be excluded", f->t->name, f->word, time);
    keeps_sign(f, a, middle, depth + 1);
    keeps_sign(f, middle, b, depth + 1);
}

/* Proves that F has no zero that counts between two times of the step. */
static void no_zero(form *f, const fmpq_t from, const fmpq_t to) {
    static arb_t s;
    static arf_t a, b;
    if (fmpq_cmp(from, to) >= 0)
        return;
    local_exact(s, from);
    arb_get_lbound_arf(a, s, bits);
    if (arf_sgn(a) < 0)
        arf_zero(a);
    local_exact(s, to);
    arb_get_ubound_arf(b, s, bits);
    keeps_sign(f, a, b, 0);
}

/* The direction that is printed of a zero: it must be one that counts, and other than that of the zero before. */
static int printed_direction(const form *f, long row) {
    const char *word = cell(f->t, row, 2);
    int direction = strcmp(word, "+1") == 0 ? 1 : -1;
    if (direction < 0 && strcmp(word, "-1") != 0)
        wrong("%s, row %ld: the direction is wrong\n", f->t->name, row + 1);
    if (f->sign == direction || f->one_way == -direction)
        wrong("%s, row %ld: the direction is wrong\n", f->t->name, row + 1);
    return direction;
}

/* Proves that F has one zero in I, which is around a printed time t. Then n is N of 5. */
static void prove_time(arb_t n, const form *f, const event *e, int direction) {
    static arb_t t, s, first, last;
    static fmpq_t time;
    const char *printed = cell(f->t, e->row, 1), *name = f->t->name;
    local_exact(first, e->from);
    local_exact(last, e->to);
    arb_union(s, first, last, bits + 64);         /* I */
    decimal(time, printed);
    arb_set_fmpq(t, time, bits + 64);
    for (int twice = 0; twice < 2; twice++) {     /* the second time from the middle of N, over N: far narrower */
        motion(here, s, bits);
        value(n, f, 1, here, bits);
        if (arb_sgn_nonzero(n) == -direction)
            wrong("%s, row %ld: the direction is wrong, or there is no zero\n", name, e->row + 1);
        if (arb_sgn_nonzero(n) == 0)
            undecided("%s, row %ld: %s may have no single zero at t = %s", name, e->row + 1, f->word, printed);
        local(s, t);
        motion(here, s, bits);
        value(s, f, 0, here, bits);
        arb_div(n, s, n, bits);
        arb_sub(n, t, n, bits + 64);              /* N */
        prove(f->t, e->row, 1, n, bound_for(f->t, e->row, 1));
        local(s, n);
        if (!arb_gt(s, first) || !arb_lt(s, last))
            undecided("%s, row %ld: t = %s is at the edge of its last digit", name, e->row + 1, printed);
        arb_get_mid_arb(t, n);
    }
}

/* Demands that a zero is after the release, and not after the end of the run. */
static void check_within_run(const form *f, long row, const arb_t time) {
    static arb_t last;
    const char *printed = cell(f->t, row, 1);
    arb_set_fmpq(last, end, bits + 64);
    if (arb_gt(time, last))
        wrong("%s, row %ld: t = %s is after the end of the run\n", f->t->name, row + 1, printed);
    if (!arb_is_positive(time) || !arb_le(time, last))
        undecided("%s, row %ld: t = %s is at the edge of the run", f->t->name, row + 1, printed);
}

/* Proves that F has one zero in the interval of a printed time, and what is printed of it. */
static void check_passage(form *f, const event *e) {
    static arb_t time, s, x;
    static const int of_transit[] = {R, R + 1, R + 2, V + 1, R2}, of_section[] = {R, R + 1, R + 2, V, V + 1, V + 2};
    int is_transit = f->t == transits;
    int direction = printed_direction(f, e->row);
    prove_time(time, f, e, direction);
    check_within_run(f, e->row, time);
    local(s, time);
    motion(here, s, bits);
    for (int i = 0; i < (is_transit ? 5 : 6); i++) {
        arb_mul(x, here + (is_transit ? of_transit[i] : of_section[i]), length, bits + 64);
        prove(f->t, e->row, 3 + i, x, bound_for(f->t, e->row, 3 + i));
    }
    f->sign = f->one_way ? 0 : direction;
}

/* Inside an interval nothing is proved, and the sign after it follows from its parity. */
static void check_zeros_of_step(form *f) {
    for (; f->next < f->all && fmpq_cmp(f->events[f->next].from, step_next) < 0; f->next++) {
        const event *e = f->events + f->next;
        no_zero(f, f->clear_from, e->from);
        fmpq_set(f->clear_from, e->to);
        if (e->parity == NULL) {
            check_passage(f, e);
            continue;
        }
        if (f->sign == 0 && strcmp(e->parity, "unknown") != 0)
            undecided("manifest.json: the parity of %s.%ld cannot be proved", f->possible, e->row);
        f->sign *= (strcmp(e->parity, "even") == 0) - (strcmp(e->parity, "odd") == 0);
    }
    no_zero(f, f->clear_from, fmpq_cmp(end, step_next) < 0 ? end : step_next);
    if (fmpq_cmp(f->clear_from, step_next) < 0)
        fmpq_set(f->clear_from, step_next);
}

/* --------------------------------------------------------------------------------------------------- the other files */

static void same(document *d, const char *key, const char *expected) {
    if (strcmp(get(d, key), expected) != 0)
        wrong("%s: %s is %s, and should be %s\n", d->name, key, get(d, key), expected);
}

/* Demands that each key was asked for, or begins with one of the words, after which NULL stands. */
static void nothing_else(const document *d, const char *const *not_looked_at) {
    for (long i = 0; i < d->count; i++) {
        int is_known = d->asked_for[i];
        for (const char *const *word = not_looked_at; *word && !is_known; word++)
            is_known = strncmp(d->key[i], *word, strlen(*word)) == 0;
        if (!is_known)
            wrong("%s has %s, which does not belong there\n", d->name, d->key[i]);
    }
}

/* h of the first row in m^2/s^2: v^2/2 + g z - rate^2/2 (x^2 + axis^2), axis = R - y sin + z cos. Without rotation it is a
   decimal, and may be printed from exactly half a unit away, which no ball can tell: a millionth of a unit is allowed more. */
static void check_invariant(void) {
    static table t = {.name = "manifest.json", .rows = 1, .columns = 1};
    static arb_struct x[6], axis[2];
    static arb_t sum;
    static fmpq_t value;
    slong p = bits + 64;
    const char *name = "h", *printed = get(manifest, "invariant.h_m2_s2");
    for (int i = 0; i < 6; i++) {
        printed_value(value, "grid.csv", cell(grid, 0, i + 1));
        arb_set_fmpq(x + i, value, p);
    }
    arb_set(axis, x);
    arb_set(axis + 1, radius);
    arb_submul(axis + 1, x + 1, sine, p);
    arb_addmul(axis + 1, x + 2, cosine, p);
    _arb_vec_scalar_mul(axis, axis, 2, rate, p);
    arb_dot(sum, NULL, 0, x + 3, 1, x + 3, 1, 3, p);
    arb_dot(sum, sum, 1, axis, 1, axis, 1, 2, p);
    arb_mul_2exp_si(sum, sum, -1);
    arb_addmul(sum, gravity, x + 2, p);
    t.heads = &name;
    t.cells = &printed;
    fmpq_zero(t.bound);
    fmpq_set_si(most_off, 500001, 1000000);
    prove(&t, 0, 0, sum, "1");
}

/* The digits of columns, and the largest of their bounds. */
static void check_columns(const table *t, long first, long last, const char *key) {
    static fmpq_t largest, said;
    long digits = whole("digits", get(manifest, "digits"), MOST_DIGITS);
    fmpq_zero(largest);
    for (long col = first; col <= last; col++) {
        if (fmpq_cmp(largest, t->bound + col) < 0)
            fmpq_set(largest, t->bound + col);
        if (t->digits[col] > 0 && t->digits[col] != digits && t->digits[col] != digits + 1)
            wrong("%s: %s has %ld significant digits, not %ld\n", t->name, head(t, col), t->digits[col], digits);
    }
    decimal(said, get(manifest, key));
    if (!fmpq_equal(said, largest))
        wrong("manifest.json: %s is not the largest bound of its columns\n", key);
}

static const char *const units[][2] = {{"t", "s"},   {"x", "m"},    {"y", "m"},    {"z", "m"},
                                       {"vx", "m/s"}, {"vy", "m/s"}, {"vz", "m/s"}, {"ax", "m/s^2"}};

/* In which units, axes, level and format the numbers are meant. */
static void check_meaning(void) {
    const char *kind = get(manifest, "scene.site.gravity_is");
    const char *up_is = strcmp(kind, "effective") == 0 ? "z up along the plumb line" : "z up";
    same(manifest, "frame", text("topocentric, axes x east, y north, %s, origin at the suspension, z < 0 below it", up_is));
    same(manifest, "units.t", "s");
    same(manifest, "units.x, y, z", "m");
    same(manifest, "units.vx, vy, vz", "m/s");
    same(manifest, "units.ax", "m/s^2");
    same(manifest, "units.bound", "s");
    same(manifest, "units.angles", "degrees");
    same(manifest, "digits", get(manifest, "scene.run.digits"));
    same(manifest, "level", get(manifest, "scene.run.level"));
}

/* Of a table without rows the manifest may have the decimals, which no number has to keep. */
static void ask_for_decimals(const table *t) {
    for (long col = -t->first; col < t->columns - t->first; col++)
        maybe(manifest, text("%s.%s", t->decimals, head(t, col)));
}

static void check_manifest(void) {
    const char *word = transits == &no_transits ? "not asked for" : never ? "xdot is identically zero" : "complete";
    long intervals = transits == &no_transits ? 0 : forms[0].intervals;
    check_meaning();
    same(manifest, "transits", intervals ? "undecided intervals" : word);
    same(manifest, "counts.grid", text("%ld", grid->rows));
    same(manifest, "counts.transits", text("%ld", transits->rows));
    same(manifest, "counts.possible", text("%ld", intervals));
    check_columns(grid, 1, 3, "bounds.position_m");
    check_columns(grid, 4, 6, "bounds.velocity_m_s");
    if (sections && sections->rows)
        check_columns(sections, 1, 1, "sections.bounds.t");
    if (transits->rows) {
        check_columns(transits, 1, 1, "bounds.transit_s");
        check_columns(transits, 1, 1, "bounds.transits.t");
        check_columns(transits, 7, 7, "bounds.transits.ax");
    } else {
        same(manifest, "bounds.transit_s", "null");
        ask_for_decimals(transits);
    }
    if (sections && sections->rows == 0)
        ask_for_decimals(sections);
}

/* The number of one vector, which repeats that of a table. */
static void check_vector_number(document *d, const char *place, const table *t, long row, long col) {
    const char *name = head(t, col);
    double expected = strtod(cell(t, row, col), NULL);
    if (t->doubles)
        expected = hexfloat(t->doubles->name, cell(t->doubles, row, column_of(t->doubles, text("%s_hex", name))));
    same(d, text("%s.values.%s.decimal", place, name), cell(t, row, col));
    same(d, text("%s.values.%s.bound", place, name), bound_for(t, row, col));
    if (hexfloat(d->name, get(d, text("%s.values.%s.hexfloat", place, name))) != expected)
        wrong("vectors.json: the hexfloat of %s, %s is wrong\n", place, name);
}

/* The states or transits in vectors.json: each repeats a row of a table, whose number it has. Flags are words. */
static void check_list(document *d, const table *t, const char *list, const char *number) {
    for (long i = 0; maybe(d, text("%s.%ld.%s", list, i, number)); i++) {
        const char *place = lasting(text("%s.%ld", list, i));
        const char *key = lasting(text("%s.%s", place, number));
        long row = whole(key, get(d, key), t->rows) - 1;
        if (t == transits)
            same(d, text("%s.direction", place), *cell(t, row, 2) == '+' ? "1" : "-1");
        for (long col = 0; col < t->columns; col++)
            if (place_of(manifest, text("%s.%s", t->decimals, head(t, col))) >= 0)
                check_vector_number(d, place, t, row, col);
        for (long flag = 0; maybe(d, text("%s.flags.%ld", place, flag)); flag++)
            continue;
    }
}

/* vectors.json: what it repeats of the manifest, and of the tables. */
static void check_vectors(document *d) {
    static const char *const repeated[] = {"schema_version", "id", "level", "digits", "inputs", "frame", NULL};
    static const char *const not_looked_at[] = {"notes.", NULL};
    for (const char *const *key = repeated; *key; key++)
        same(d, *key, get(manifest, *key));
    for (long i = 0; i < manifest->count; i++)
        if (strncmp(manifest->key[i], "scene.", 6) == 0)
            same(d, manifest->key[i], manifest->value[i]);
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        same(d, text("columns.%s", units[i][0]), units[i][1]);
    check_list(d, grid, "states", "row");
    check_list(d, transits, "transits", "k");
    nothing_else(d, not_looked_at);
}

/* Demands a line in certified.txt, or the begin of one, after the last one that was found. */
static void expect(const char *begin, const char *rest) {
    static const char *at;
    const char *line = lasting(text("\n%s%s", begin, rest));
    if (at == NULL)
        at = contents("certified.txt");
    at = at ? strstr(at, line) : NULL;
    if (at == NULL)
        wrong("certified.txt has not, or not in this place: %s%s\n", begin, rest);
    at += strlen(line) - 1;                       /* the end of a line is the begin of the next */
}

static void expect_line(const char *line) {
    expect(line, "\n");
}

/* A state on the page for people. */
static void expect_state(const char *title, long row, int width) {
    expect_line(text("%s at t = %s s", title, cell(grid, row, 0)));
    for (int i = 1; i < 7; i++)
        expect_line(text("  %-3s %*s", head(grid, i), width, cell(grid, row, i)));
}

static void expect_states(void) {
    long last = grid->rows - 1;
    int width = 0;
    for (int i = 1; i < 7; i++)
        width = fmax(width, fmax(strlen(cell(grid, 0, i)), strlen(cell(grid, last, i))));
    expect_state("State", 0, width);
    expect_state(strcmp(get(manifest, "level"), "enclosed") == 0 ? "Certified state" : "State", last, width);
}

static void expect_bounds(void) {
    const char *line = "  by column:";
    for (int i = 1; i < 7; i++)
        line = lasting(text("%s%s %s %s", line, i > 1 ? "," : "", head(grid, i), bound_for(grid, 0, i)));
    expect_line(text("Bound on every position %s m, on every velocity %s m/s", get(manifest, "bounds.position_m"),
                     get(manifest, "bounds.velocity_m_s")));
    expect_line(line);
}

static void expect_transit(const char *which, long row) {
    expect_line(text("  %-5s t = %s s, direction %s, bound %s s", which, cell(transits, row, 1), cell(transits, row, 2),
                     cell(transits, row, 8)));
}

static void expect_transits(void) {
    long rows = transits->rows;
    expect_line(text("Transits (xdot = 0, t > 0): %ld (%s)", rows, get(manifest, "transits")));
    if (rows > 0) {
        expect_transit("first", 0);
        expect_transit("last", rows - 1);
        expect_line(text("  largest bound on a time %s s", get(manifest, "bounds.transit_s")));
    }
    for (long i = 0; maybe(manifest, text("possible.%ld.from_s", i)); i++)
        expect_line(text("  possible transit in [%s, %s] s (%s number of zeros): not decided",
                         get(manifest, text("possible.%ld.from_s", i)), get(manifest, text("possible.%ld.to_s", i)),
                         get(manifest, text("possible.%ld.parity", i))));
}

/* The numbers on the page for people. */
static void check_page(void) {
    expect(text("Level: %s. ", get(manifest, "level")), "");
    expect_line(text("Inputs are read as: %s", get(manifest, "inputs")));
    for (long i = 0; i < manifest->count; i++)
        if (strncmp(manifest->key[i], "scene.", 6) == 0)
            expect_line(text("  %-26s %s", manifest->key[i] + 6, manifest->value[i]));
    expect_states();
    expect_bounds();
    expect_transits();
    for (int i = 0; i < count_of_forms; i++)
        if (forms[i].t == sections)
            expect_line(text("Passages in sections.csv: %ld of %s", forms[i].rows, forms[i].word));
}

/* ------------------------------------------------------------------------------------------------------ the question */

/* Whether a key has one of two values. */
static int chooses(const char *key, const char *first, const char *second) {
    const char *given = get(manifest, key);
    if (strcmp(given, first) != 0 && strcmp(given, second) != 0)
        no_dataset("%s must be %s or %s\n", key, first, second);
    return strcmp(given, first) == 0;
}

static void must_not_be_there(const char *name) {
    if (contents(name))
        wrong("%s is there, and the scene does not ask for it\n", name);
}

static void read_transits(void) {
    if (chooses("scene.run.transits", "true", "false")) {
        transits = read_tables("transits", "k,t,direction,x,y,z,vy,ax,bound", "t_hex,x_hex,y_hex,z_hex,vy_hex,ax_hex");
        add_form("xdot", "possible", transits, 0, transits->rows);
        return;
    }
    must_not_be_there("transits.csv");
    must_not_be_there("transits.binary64.csv");
}

static void read_sections(void) {
    const char *words = maybe(manifest, "scene.run.sections");
    if (words == NULL) {
        must_not_be_there("sections.csv");
        return;
    }
    sections = read_table("sections.csv", "section,k,t,direction,x,y,z,vx,vy,vz,bound");
    if (sections == NULL)
        no_dataset("no sections.csv\n");
    sections->decimals = "sections.decimals";
    sections->bounds = "sections.bounds";
    sections->first = 1;                          /* so that columns count as in transits.csv */
    add_sections(words);
}

/* Reads all but the vectors and the page. The scene is read again for each number of bits. */
static void read_dataset(void) {
    if (strcmp(get(manifest, "schema_version"), "3") != 0)
        no_dataset("schema_version is %s: this program reads format 3\n", get(manifest, "schema_version"));
    as_doubles = chooses("inputs", "binary64", "decimal");
    input_from(end, "run.t_end", 0, 1);
    input_from(grid_step, "run.grid_step", 0, 1);
    fmpq_zero(half);
    grid = read_tables("grid", "t,x,y,z,vx,vy,vz", "t_hex,x_hex,y_hex,z_hex,vx_hex,vy_hex,vz_hex");
    count_rows();
    bits = COLUMN_BITS;
    read_site();
    read_release();
    read_transits();
    read_sections();
}

/* Half a unit of the last digit at the level `enclosed`, a unit at those below. */
static void read_level(void) {
    static const char *const below[] = {"computed", "self_consistent", "confirmed", NULL};
    const char *level = get(manifest, "level");
    int is_known = strcmp(level, "enclosed") == 0;
    fmpq_set_si(most_off, 1, is_known ? 2 : 1);
    for (const char *const *word = below; *word; word++)
        is_known = is_known || strcmp(level, *word) == 0;
    if (!is_known)
        no_dataset("level is %s\n", level);
}

/* Bits that should do: for the rounding of all numbers, for the growth of errors, and for the digits. */
static slong guessed_bits(void) {
    double numbers = 6.0 * (grid->rows + transits->rows + (sections ? sections->rows : 0));
    double pull = strtod(get(manifest, "scene.site.gravity"), NULL) / strtod(get(manifest, "scene.pendulum.length"), NULL);
    double swings = fmpq_get_d(end) * sqrt(pull);
    long digits = whole("digits", get(manifest, "digits"), MOST_DIGITS);
    double most = fmin(MOST_BITS + 1, 16 + ilogb(numbers) + 2 * fmax(15, ilogb(swings + 1)));
    return most + 10 * digits / 3;
}

/* ---------------------------------------------------------------------------------------------------------------- run */

static void begin_again(table *t) {
    t->widest = 0;
    for (int i = 0; i < COLUMNS; i++) {
        t->digits[i] = 0;
        fmpq_zero(t->bound + i);
    }
}

static void begin_all_again(void) {
    begin_again(grid);
    begin_again(transits);
    if (sections)
        begin_again(sections);
    for (form *f = forms; f < forms + count_of_forms; f++) {
        f->next = 0;
        f->sign = 0;
        fmpq_zero(f->clear_from);
    }
}

/* From the release to the end of the run. Returns the number of steps. */
static long run(void) {
    static fmpq_t t;
    long row = 0, steps = 0;
    start();
    for (; row < grid->rows; steps++) {
        double length_of_next = step();
        for (; row < grid->rows; row++) {
            fmpq_mul_si(t, grid_step, row);
            if (row == grid->rows - 1)
                fmpq_set(t, end);
            if (fmpq_cmp(t, step_next) > 0)
                break;
            check_grid_row(t, row);
        }
        for (int i = 0; i < count_of_forms; i++)
            if (forms[i].t != transits || !never)
                check_zeros_of_step(forms + i);
        go_on(length_of_next);
    }
    for (form *f = forms; f < forms + count_of_forms; f++)
        if (f->next != f->all)
            wrong("%s has a zero, or manifest.json an interval, after the end of the run, or where xdot = 0 for ever\n",
                  f->t->name);
    return steps;
}

static void report(long steps, int has_vectors) {
    printf("%s: %s, inputs %s, %ld steps of order %ld with %ld bits\n", folder, get(manifest, "level"), get(manifest, "inputs"),
           steps, (long)highest, (long)bits);
    printf("  grid.csv      %6ld rows, widest distance %.6f units of the last digit\n", grid->rows, grid->widest);
    if (transits != &no_transits)
        printf("  transits.csv  %6ld rows, widest distance %.6f; %s\n", transits->rows, transits->widest,
               get(manifest, "transits"));
    if (sections)
        printf("  sections.csv  %6ld rows, widest distance %.6f\n", sections->rows, sections->widest);
    printf("  %s%scertified.txt and the numbers of manifest.json agree\n",
           grid->doubles || transits->doubles ? "the doubles, " : "", has_vectors ? "vectors.json, " : "");
    printf("every printed number is proved\n");
}

int main(int count, char **words) {
    static const char *const not_looked_at[] = {"seal", "id", "title", "source", "flags.", "notes.", "invariant.drift_m2_s2",
                                                "equations.", "run.", "cross_checks.", "enclosure", "generator.", "command",
                                                "files.", NULL};
    if (count != 2)
        no_dataset("usage: check FOLDER, with manifest.json in it\n");
    folder = words[1];
    manifest = read_document("manifest.json");
    if (manifest == NULL)
        no_dataset("usage: check FOLDER, with manifest.json in it\n");
    document *vectors = read_document("vectors.json");
    read_dataset();
    arb_mat_init(frame, 6, 6);
    arb_mat_init(at_end, 6, 6);
    arb_mat_init(inverse, 6, 6);
    bits = guessed_bits();
    if (setjmp(with_more_bits))
        bits = bits * 7 / 5;
    if (bits > MOST_BITS)
        wrong("not proved with %d bits: %s\n", MOST_BITS, doubt);
    highest = bits * 9 / 20 + 8;
    read_level();
    begin_all_again();
    long steps = run();
    check_repeated(grid);
    check_repeated(transits);
    check_manifest();
    check_invariant();
    check_page();
    if (vectors)
        check_vectors(vectors);
    nothing_else(manifest, not_looked_at);
    report(steps, vectors != NULL);
    return 0;
}
