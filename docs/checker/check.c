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

   5. ZEROS OF XDOT.  A printed time t stands for I = [t - u/2, t + u/2], u one unit of its last digit. If N =
   t - v_x(t) / a_x(I) lies in I, and 0 is not in a_x(I), then xdot has exactly one zero in I, and it lies in N
   (mean value theorem). Everywhere else `no_zero` shows that xdot has the sign that the rows before and after demand.  */

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
#define NAMES 20          /* columns of a table */
#define HAND_OVER 0.984375 /* s at which the next step begins: a printed time and its half unit lie in one step */
_Static_assert(LDBL_MIN_EXP < -16000, "bounds are long doubles, and must not underflow");

/* FLINT's numbers are 0 and ready for use where the memory is: what is `static` below needs no arb_init. */

/* ------------------------------------------------------------------------------------------------ verdicts and texts */

static jmp_buf with_more_bits;
static char doubt[1000];

static void stop(int status, const char *format, ...) {
    va_list list;
    va_start(list, format);
    vprintf(format, list);
    exit(status);
}

#define wrong(...) stop(1, "WRONG: " __VA_ARGS__)
#define no_dataset(...) stop(2, "not a dataset: " __VA_ARGS__)

/* An interval is too wide to decide: the run begins again, with more bits. */
static void undecided(const char *format, ...) {
    va_list list;
    va_start(list, format);
    vsnprintf(doubt, sizeof doubt, format, list);
    longjmp(with_more_bits, 1);
}

static const char *folder;

/* The text of a file, or NULL where there is none. */
static char *text_of(const char *name) {
    char path[5000];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    if (file == NULL)
        return NULL;
    fseek(file, 0, SEEK_END);
    long size = ftell(file);
    char *text = calloc(size + 1, 1);
    rewind(file);
    if (text == NULL || fread(text, 1, size, file) != (size_t)size || strlen(text) != (size_t)size)
        no_dataset("%s cannot be read\n", path);
    fclose(file);
    return text;
}

/* A JSON document as pairs, "scene.run.t_end" or "possible.0.parity" and a text. */
typedef struct {
    const char *name;
    char *key[5000], *value[5000];
    long count;
} document;

/* The value of a key, or NULL. */
static const char *maybe(const document *d, const char *format, ...) {
    char key[500];
    va_list list;
    va_start(list, format);
    vsnprintf(key, sizeof key, format, list);
    for (long i = 0; i < d->count; i++)
        if (strcmp(d->key[i], key) == 0)
            return d->value[i];
    return NULL;
}

static const char *get(const document *d, const char *key) {
    const char *value = maybe(d, "%s", key);
    if (value == NULL)
        no_dataset("%s has no %s\n", d->name, key);
    return value;
}

/* Reads the one form of JSON that datasets have: a line for each value, indented by one blank for each level. */
static document *read_document(const char *name) {
    char path[NAMES][100] = {""}, *line = text_of(name), *rest;
    long item[NAMES + 1] = {0};
    size_t depth = 0;
    document *d = line ? calloc(1, sizeof *d) : NULL;
    for (; d != NULL && *line; line = rest) {
        rest = line + strcspn(line, "\n");
        char *first = line + strspn(line, " "), *last = rest - 1, *quote = NULL;
        int closes = *first == '}' || *first == ']', is_key = 0;
        d->name = name;
        if (*rest)
            *rest++ = 0;
        depth -= closes;
        if ((size_t)(first - line) != depth || depth + 2 > NAMES || strchr(line, '\\') || last < first)
            no_dataset("%s is not indented as datasets are: %.40s\n", name, line);
        if (closes)
            continue;
        last -= *last == ',';
        if (*first == '"') {
            quote = strchr(first + 1, '"');
            is_key = quote != NULL && quote[1] == ':' && quote[2] == ' ' && quote - first < 100;
        }
        if (is_key)
            snprintf(path[depth], 100, "%.*s", (int)(quote - first - 1), first + 1);
        else
            snprintf(path[depth], 100, "%ld", item[depth]++);
        if (is_key)
            first = quote + 3;
        last[1] = 0;
        if (*first == '{' || *first == '[')
            item[depth + 1] = 0;
        depth += first == last && (*first == '{' || *first == '[');
        if (strchr("{}[]", *first) && last - first < 2)
            continue;
        first += *first == '"';
        *last = *last == '"' ? 0 : *last;
        char key[500] = "";
        for (size_t i = 1; i <= depth; i++)
            snprintf(key + strlen(key), 500 - strlen(key), "%s%s", i > 1 ? "." : "", path[i]);
        if (strchr(first, '"') || maybe(d, "%s", key) || d->count == 5000)
            no_dataset("%s: %s comes twice, or has a \" in it\n", name, key);
        d->key[d->count] = strcpy(calloc(strlen(key) + 1, 1), key);
        d->value[d->count++] = first;
    }
    return d;
}

/* A table of texts, with that of its doubles, if any. */
typedef struct table {
    const char *name;
    char *head[NAMES];
    long rows, columns;
    char **cells;
    struct table *doubles;
    double widest;                    /* distance of a printed number from the true one, in units of its last digit */
    long digits[NAMES];               /* most significant digits of a column */
} table;

static char *cell(const table *t, long row, long column) {
    return t->cells[row * t->columns + column];
}

static table *read_table(const char *name, const char *header) {
    char *text = text_of(name), *at = text;
    table *t = text ? calloc(1, sizeof *t) : NULL;
    size_t lines = 0, head = strlen(header);
    if (t == NULL)
        return NULL;
    t->name = name;
    if (strncmp(text, header, head) != 0 || text[head] != '\n')
        no_dataset("%s: the first line must be %s\n", name, header);
    for (char *c = text; *c; c++)
        lines += *c == '\n';
    for (const char *c = header; c; c = strchr(c + 1, ','))
        t->columns++;
    t->cells = calloc(lines * t->columns, sizeof(char *));
    for (size_t i = 0; *at; i++) {
        char **place = i < (size_t)t->columns ? t->head + i : t->cells + i - t->columns;
        *place = at;
        at += strcspn(at, ",\n");
        if (*at != ((i + 1) % t->columns ? ',' : '\n'))
            no_dataset("%s: line %ld has not %ld numbers\n", name, (long)i / t->columns + 1, t->columns);
        *at++ = 0;
    }
    t->rows = lines - 1;
    return t;
}

/* ----------------------------------------------------------------------------------------------------- exact numbers */

static fmpz_t ten_to;

static void power_of_ten(long n) {
    fmpz_set_ui(ten_to, 10);
    fmpz_pow_ui(ten_to, ten_to, n);
}

/* The exact value of a decimal such as -7.29e-5. */
static void decimal(fmpq_t value, const char *text) {
    char digits[3000], *to = digits;
    size_t mantissa = strcspn(text, "eE");
    const char *point = strchr(text, '.');
    long exponent = text[mantissa] ? strtol(text + mantissa + 1, NULL, 10) : 0;
    if (point != NULL)
        exponent -= text + mantissa - point - 1;
    for (const char *at = text + (*text == '+'); at < text + mantissa && at < text + 2900; at++)
        if (at != point)
            *to++ = *at;
    *to = 0;
    int is_short = strlen(text) < 2900 && labs(exponent) < 5000 && strspn(text, "+-.0123456789eE") == strlen(text);
    if (!is_short || fmpz_set_str(fmpq_numref(value), digits, 10) != 0)
        no_dataset("\"%s\" is not a number\n", text);
    fmpz_one(fmpq_denref(value));
    power_of_ten(labs(exponent));
    if (exponent < 0)
        fmpq_div_fmpz(value, value, ten_to);
    else
        fmpq_mul_fmpz(value, value, ten_to);
}

static void exact_double(fmpq_t value, double x) {
    static arf_t exact;
    arf_set_d(exact, x);
    arf_get_fmpq(value, exact);
}

static document *manifest;
static int as_doubles;

/* An input of the scene: the decimal itself, or the double next to it; 0 where it is not given. */
static void input(fmpq_t value, const char *key) {
    const char *text = maybe(manifest, "scene.%s", key);
    decimal(value, text ? text : "0");
    if (as_doubles && text)
        exact_double(value, strtod(text, NULL));
}

/* Bounds are long doubles, sums and products of such numbers >= 0, none below 1e-4900: each operation is right to 2^-63 of
   its result, and no bound takes 10^8 of them. Where one is used it is multiplied by UP. */
#define UP (1 + 1e-9L)

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

static long double size(arb_srcptr a) {
    return sqrtl(up(a) * up(a) + up(a + 1) * up(a + 1) + up(a + 2) * up(a + 2));
}

/* Makes x wider by r. */
static void widen(arb_t x, long double r) {
    static mag_t m;
    int exponent;
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
static int never, from_zero, from_double_zero;    /* xdot = 0 for ever; at the release; d xdot/dt = 0 there as well */

static void ball(arb_t x, const char *key) {
    static fmpq_t value;
    input(value, key);
    arb_set_fmpq(x, value, bits + 64);
}

static void sine_cosine(arb_t s, arb_t k, const char *key) {
    static fmpq_t degrees;
    static fmpz_t half_turn;
    fmpz_set_ui(half_turn, 180);
    input(degrees, key);
    fmpq_div_fmpz(degrees, degrees, half_turn);
    arb_sin_cos_pi_fmpq(s, k, degrees, bits + 64);
}

static void cross(arb_ptr out, arb_srcptr a, arb_srcptr b, slong p) {
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        arb_mul(out + i, a + j, b + k, p);
        arb_submul(out + i, a + k, b + j, p);
    }
}

static int all_zero(arb_srcptr a) {
    return arb_is_zero(a) && arb_is_zero(a + 1) && arb_is_zero(a + 2);
}

/* Omega, R and c. Where g is effective it contains the centrifugal force at the suspension, as if that were on the axis. */
static void read_site(void) {
    static arb_t f, t;
    slong p = bits + 64;
    const char *kind = get(manifest, "scene.site.gravity_is");
    ball(length, "pendulum.length");
    ball(drag, "pendulum.drag");
    ball(gravity, "site.gravity");
    ball(rate, "site.rotation_rate");
    sine_cosine(sine, cosine, "site.latitude");
    arb_zero(f);
    if (strcmp(get(manifest, "scene.site.inverse_flattening"), "inf") != 0) {
        ball(f, "site.inverse_flattening");
        arb_inv(f, f, p);
    }
    arb_sub_ui(t, f, 2, p);
    arb_mul(t, t, f, p);                          /* -e^2, e the eccentricity */
    arb_mul(t, t, sine, p);
    arb_mul(t, t, sine, p);
    arb_add_ui(t, t, 1, p);
    arb_rsqrt(t, t, p);
    ball(radius, "site.equatorial_radius");
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
    arb_mul(t, rate, rate, p);
    arb_mul(t, t, radius, p);
    arb_mul(c + 1, t, sine, p);
    arb_neg(c + 1, c + 1);
    arb_mul(c + 2, t, cosine, p);
    arb_sub(c + 2, c + 2, gravity, p);
    _arb_vec_scalar_div(c, c, 3, length, p);
}

/* The release over the length: x, y, vx, vy below the suspension, or angle from straight down, azimuth from east, rates. */
static void read_release(void) {
    static arb_t s, k, sa, ka, t;
    slong p = bits + 64;
    arb_struct *x = begin_r, *v = begin_v;
    if (maybe(manifest, "scene.release.angle") == NULL) {
        ball(x, "release.x");
        ball(x + 1, "release.y");
        ball(v, "release.vx");
        ball(v + 1, "release.vy");
        arb_mul(t, length, length, p);
        arb_submul(t, x, x, p);
        arb_submul(t, x + 1, x + 1, p);
        arb_sqrt(t, t, p);
        arb_neg(x + 2, t);
        arb_mul(v + 2, x, v, p);
        arb_addmul(v + 2, x + 1, v + 1, p);
        arb_div(v + 2, v + 2, t, p);
        _arb_vec_scalar_div(x, x, 3, length, p);
        _arb_vec_scalar_div(v, v, 3, length, p);
        return;
    }
    sine_cosine(s, k, "release.angle");
    sine_cosine(sa, ka, "release.azimuth");
    arb_mul(x, s, ka, p);
    arb_mul(x + 1, s, sa, p);
    arb_neg(x + 2, k);
    ball(t, "release.angle_rate");
    arb_mul(v, t, k, p);
    arb_mul(v + 1, v, sa, p);
    arb_mul(v, v, ka, p);
    arb_mul(v + 2, t, s, p);
    ball(t, "release.azimuth_rate");
    arb_submul(v, t, x + 1, p);
    arb_addmul(v + 1, t, x, p);
    arb_const_pi(t, p);
    arb_div_ui(t, t, 180, p);
    _arb_vec_scalar_mul(v, v, 3, t, p);
}

/* What the exact inputs say of xdot. It is 0 for ever in the plane x = 0 without rotation (reflect x: the solution is
   unique), and at rest where the force, c - Omega x (Omega x r), is along the cord. */
static void decide_zeros(void) {
    static arb_struct a[3], b[3];
    int at_rest = all_zero(begin_v);
    cross(a, omega, begin_r, bits);
    cross(b, omega, a, bits);
    _arb_vec_sub(b, c, b, 3, bits);
    cross(a, begin_r, b, bits);
    from_zero = arb_is_zero(begin_v);
    from_double_zero = at_rest && arb_is_zero(begin_r);
    never = (at_rest && all_zero(a)) || (arb_is_zero(rate) && arb_is_zero(begin_r) && from_zero);
}

/* ------------------------------------------------------------------------------------------------------------- curves */

/* A curve of polynomials in s: components 0-2 are r, 3-5 are A, 6 is Omega.r; then the lengths of the coefficients of r and
   A, and their sums from an order on. */
typedef struct {
    arb_ptr x[7];
    long double *r, *a, *sum_r, *sum_a;
    slong order;
} curve;

static slong highest;                             /* order of q */
static double h;                                  /* length of the step, of 20 bits */
static fmpq_t step_begin, step_next, step_end;    /* in s; the next step begins at step_next, a little before the end */
static curve q, rough, column[6];                 /* rough is q in few bits, for the columns */
static long double z[6], u_r, u_a;                /* bounds of zeta and of u = (u_r, u_a) on the step */
static long double error_r, error_a;              /* bounds of r - p and A - K on the step */
static long double size_c, size_omega, size_drag;
static arb_ptr powers;
static arb_struct next_x[6];

static void make_curve(curve *u) {
    long double **lengths[] = {&u->r, &u->a, &u->sum_r, &u->sum_a};
    for (int i = 0; i < 7; i++)
        u->x[i] = _arb_vec_init(highest + 2);
    for (int i = 0; i < 4; i++)
        *lengths[i] = calloc(highest + 3, sizeof(long double));
}

/* t += or -= the coefficient n of the product of a and b. */
static void product(arb_t t, int minus, arb_srcptr a, arb_srcptr b, slong n, slong p) {
    arb_dot(t, t, minus, a, 1, b + n, -1, n + 1, p);
}

/* t = the coefficient n of F(q) if u = q, else of the linearised L u + B(u, q) + B(q, u). */
static void field(arb_ptr t, const curve *u, slong n, slong p) {
    const curve *y = u == &q ? &q : &rough;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        arb_zero(t + i);
        product(t + i, 0, u->x[3 + j], y->x[k], n, p);
        product(t + i, 1, u->x[3 + k], y->x[j], n, p);
        if (u != &q) {
            product(t + i, 0, y->x[3 + j], u->x[k], n, p);
            product(t + i, 1, y->x[3 + k], u->x[j], n, p);
        }
        arb_mul(t + 3 + i, u->x[j] + n, c + k, p);
        arb_submul(t + 3 + i, u->x[k] + n, c + j, p);
        arb_addmul(t + 3 + i, u->x[3 + j] + n, omega + k, p);
        arb_submul(t + 3 + i, u->x[3 + k] + n, omega + j, p);
        if (arb_is_zero(drag))
            continue;
        arb_set(t + 6, u->x[3 + i] + n);
        product(t + 6, 0, u->x[6], y->x[i], n, p);
        if (u != &q)
            product(t + 6, 0, y->x[6], u->x[i], n, p);
        arb_submul(t + 3 + i, t + 6, drag, p);
    }
}

/* What follows from the first six components of the coefficient n. */
static void complete(curve *u, slong n, slong p) {
    arb_struct r[3] = {u->x[0][n], u->x[1][n], u->x[2][n]}, a[3] = {u->x[3][n], u->x[4][n], u->x[5][n]};
    if (!arb_is_zero(drag))
        arb_dot(u->x[6] + n, NULL, 0, omega, 1, r, 1, 3, p);
    u->r[n] = size(r);
    u->a[n] = size(a);
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
            arb_swap(u->x[i] + n + 1, t + i);
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

static arb_mat_t frame, at_end, inverse, change;

static double entry(const arb_mat_t m, int i, int j) {
    return arf_get_d(arb_midref(arb_mat_entry(m, i, j)), ARF_RND_NEAR);
}

/* Rows of r count in units of 1, those of A in units of w. */
static double unit(int row) {
    return row < 3 ? 1 : w;
}

/* Whether the frame has an inverse, with a condition number of some hundreds. */
static int is_good(void) {
    double a = 0, b = 0;
    if (!arb_mat_inv(inverse, frame, COLUMN_BITS))
        return 0;
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < 6; j++) {
            a += pow(entry(frame, i, j) / unit(i), 2);
            b += pow(entry(inverse, i, j) * unit(j), 2);
        }
    }
    return a * b < 1e5;
}

/* Orthonormal columns, the widest direction of the set first (Gram and Schmidt, twice); and their inverse. */
static void orthogonal_frame(void) {
    int is_done[6] = {0};
    for (int n = 0; n < 6; n++) {
        int widest = -1;
        long double most = 0;
        for (int j = 0; j < 6; j++) {
            long double width = 0;
            for (int i = 0; i < 6; i++)
                width = fmaxl(width, fabs(entry(at_end, i, j) / unit(i)) * z[j]);
            if (!is_done[j] && (widest < 0 || width > most)) {
                most = width;
                widest = j;
            }
        }
        is_done[widest] = 1;
        double x[6], square = 0;
        for (int i = 0; i < 6; i++)
            x[i] = entry(at_end, i, widest) / unit(i);
        for (int k = 0; k < 2 * n; k++) {
            double along = 0;
            for (int i = 0; i < 6; i++)
                along += x[i] * entry(frame, i, k % n) / unit(i);
            for (int i = 0; i < 6; i++)
                x[i] -= along * entry(frame, i, k % n) / unit(i);
        }
        for (int i = 0; i < 6; i++)
            square += x[i] * x[i];
        for (int i = 0; i < 6; i++)
            arb_set_d(arb_mat_entry(frame, i, n), unit(i) * x[i] / sqrt(square));
    }
    if (!arb_mat_inv(inverse, frame, COLUMN_BITS))
        undecided("the set of possible motions cannot be put into a frame at t = %g", fmpq_get_d(step_begin));
}

/* Puts the set at the end of the step, and the jump to its rounded centre, into a new frame. Any frame is right; a good one
   keeps the set narrow. */
static void next_frame(const long double *jump) {
    long double wider[6] = {0};
    for (int j = 0; j < 6; j++) {
        for (int i = 0; i < 6; i++) {
            arb_ptr e = arb_mat_entry(at_end, i, j);
            arb_dot(e, NULL, 0, column[j].x[i], 1, powers, 1, column[j].order + 1, COLUMN_BITS);
            arb_set_d(arb_mat_entry(frame, i, j), entry(at_end, i, j));
        }
    }
    if (!is_good())
        orthogonal_frame();
    arb_mat_mul(change, inverse, at_end, COLUMN_BITS);
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < 6; j++) {
            wider[i] += up(arb_mat_entry(change, i, j)) * z[j];
            wider[i] += up(arb_mat_entry(inverse, i, j)) * ((j < 3 ? u_r : u_a) + jump[j]);
        }
    }
    for (int i = 0; i < 6; i++)
        z[i] = wider[i] * UP;
}

/* The printed transits: their table, exact times, half a unit of the last digit, and the next one. */
static table *transits;
static fmpq *times;
static fmpq_t half;
static long next;

static void set_length(double x) {
    int exponent;
    double part = frexp(fmin(0.99 * x, fmin(4 / (w + (double)size_omega), 8 / (double)size_drag)), &exponent);
    h = ldexp(floor(ldexp(part, 20)), exponent - 20);
    exact_double(step_next, h * HAND_OVER);
    fmpq_add(step_next, step_next, step_begin);
    exact_double(step_end, h);
    fmpq_add(step_end, step_end, step_begin);
    if (transits && transits->rows && h * (1 - HAND_OVER) < 4 * fmpq_get_d(half))
        stop(1, "not proved: the times of transits have too few digits for steps of %g s\n", h);
}

static void start(void) {
    static arb_struct a[6];
    read_site();
    read_release();
    decide_zeros();
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
    arb_mat_zero(frame);
    for (int i = 0; i < 6; i++) {
        arb_set_d(arb_mat_entry(frame, i, i), unit(i));
        z[i] = bound_of(arb_radref(a + i)) / unit(i) * UP;
        mag_zero(arb_radref(a + i));
        arb_swap(q.x[i], a + i);
    }
    fmpq_zero(step_begin);
    set_length(1 / w);
}

/* Makes q, the columns and the bounds on [step_begin, step_end]. Returns a good length for the next step. */
static double step(void) {
    double better = 1;
    long double added = 0, zr = 0, za = 0, defect = 0, drags = size_drag * size_omega;
    for (int tries = 0; tries < 60; tries++) {
        defect = expand(&q, bits, -INFINITY);
        double excess = bits + log2l(beyond(&q));
        better = exp2(fmax(-9, fmin(2, -excess / highest)));
        if (excess < 9 && (excess > -20 || fmpq_sgn(step_begin) > 0 || tries > 20))
            break;
        set_length(h * better);
    }
    for (int i = 0; i < 7; i++)
        for (slong n = 0; n <= highest; n++)
            arb_set_round(rough.x[i] + n, q.x[i] + n, COLUMN_BITS);
    for (int j = 0; j < 6; j++) {
        for (int i = 0; i < 6; i++)
            arb_set(column[j].x[i], arb_mat_entry(frame, i, j));
        added += z[j] * expand(column + j, COLUMN_BITS, -36);
        zr += z[j] * column[j].sum_r[0];
        za += z[j] * column[j].sum_a[0];
    }
    added += defect + h * (za * zr + drags * zr * zr / w);
    u_r = added * expl(h * (size_c + w * w + drags * (1 + q.sum_r[0] + zr)) / (2 * w) * UP) * UP;
    u_a = w * u_r;
    error_r = zr + u_r;
    error_a = za + u_a;
    return h * fmin(1.2, better);
}

/* The next step begins at the rounded end of this one. */
static void go_on(double length_of_next) {
    static arb_t x;
    long double jump[6];
    arb_set_d(x, HAND_OVER);
    _arb_vec_set_powers(powers, x, highest + 1, bits);
    for (int i = 0; i < 6; i++) {
        arb_dot(x, NULL, 0, q.x[i], 1, powers, 1, q.order + 1, bits);
        jump[i] = bound_of(arb_radref(x));
        mag_zero(arb_radref(x));
        arb_swap(next_x + i, x);
    }
    next_frame(jump);
    for (int i = 0; i < 6; i++)
        arb_swap(q.x[i], next_x + i);
    fmpq_set(step_begin, step_next);
    set_length(length_of_next);
}

/* ------------------------------------------------------------------------------------------------- the motion in balls */

enum { R = 0, A = 3, V = 6, A1 = 9, R2 = 12, A2 = 15, R3 = 18, ALL = 21 };

/* out = r x c + a x Omega - gamma (a + s). */
static void turning(arb_ptr out, arb_srcptr r, arb_srcptr a, arb_srcptr s, slong p) {
    static arb_struct t[3];
    cross(out, r, c, p);
    cross(t, a, omega, p);
    _arb_vec_add(out, out, t, 3, p);
    _arb_vec_add(t, a, s, 3, p);
    _arb_vec_scalar_mul(t, t, 3, drag, p);
    _arb_vec_sub(out, out, t, 3, p);
}

/* out += factor a x b. */
static void add_cross(arb_ptr out, int factor, arb_srcptr a, arb_srcptr b, slong p) {
    static arb_struct t[3];
    cross(t, a, b, p);
    for (int i = 0; i < 3; i++)
        arb_addmul_si(out + i, t + i, factor, p);
}

/* r, A, v, A', r'', A'', r''' at a time s of the step, or at all times of an interval s: (1) and its derivatives. */
static void motion(arb_ptr m, const arb_t s, slong p) {
    static arb_struct t[3], along[2];
    _arb_vec_set_powers(powers, s, q.order + 1, p);
    for (int i = 0; i < 6; i++) {
        arb_dot(m + i, NULL, 0, q.x[i], 1, powers, 1, q.order + 1, p);
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

/* The s of a time: of an interval t, or of an exact one, which then is left in t. */
static void local(arb_t s, arb_t t, const fmpq_t exact) {
    static arb_t begin;
    static arf_t step;
    if (exact != NULL)
        arb_set_fmpq(t, exact, bits + 64);
    arf_set_d(step, h);
    arb_set_fmpq(begin, step_begin, bits + 64);
    arb_sub(s, t, begin, bits + 64);
    arb_div_arf(s, s, step, bits + 64);
}

static int sign_of(const arb_t x) {
    return arb_is_positive(x) - arb_is_negative(x);
}

/* ---------------------------------------------------------------------------------------------------- printed numbers */

static int is_enclosed;    /* else the last digit may be off by a unit, not a half */

static long places(const char *text) {
    const char *point = strchr(text, '.');
    return point ? (long)strlen(point + 1) : 0;
}

/* Proves that a double, in 17 digits and as a hexfloat, is the nearest to x; or, within the bound of 0, to the decimal. */
static void prove_double(const table *t, long row, long col, const arb_t x, const char *decimals, const char *bound) {
    static arb_t low, high, y;
    char *rest, again[40];
    const char *text = cell(t, row, col), *hex = NULL;
    for (long i = 0; i < t->columns; i++)
        if (strncmp(t->head[i], t->head[col], strlen(t->head[col])) == 0 && strstr(t->head[i], "_hex"))
            hex = cell(t, row, i);
    double d = strtod(hex, &rest), other = strtod(decimals, NULL);
    snprintf(again, sizeof again, "%.16e", d);
    if (*rest || !isfinite(d) || strcmp(again, text) != 0)
        wrong("%s, row %ld: %s: %s and %s are not the same\n", t->name, row + 1, t->head[col], text, hex);
    if (fabs(other) <= strtod(bound, NULL) && d == other)
        return;
    arb_set_d(y, d);
    arb_set_d(low, nextafter(d, -INFINITY));
    arb_set_d(high, nextafter(d, INFINITY));
    arb_add(low, low, y, ARF_PREC_EXACT);
    arb_add(high, high, y, ARF_PREC_EXACT);
    arb_mul_2exp_si(y, x, 1);
    if (arb_lt(y, low) || arb_gt(y, high))
        wrong("%s, row %ld: %s = %s is not the nearest double\n", t->name, row + 1, t->head[col], text);
    if (!arb_ge(y, low) || !arb_le(y, high))
        undecided("%s, row %ld: %s = %s may not be the nearest double", t->name, row + 1, t->head[col], text);
}

/* Proves that a printed number is within half a unit of its last digit, and within `bound`, of all of x. */
static void prove(table *t, long row, long col, const arb_t x, const char *bound) {
    static arb_t off, most;
    static fmpq_t value, unit_part;
    char kind[NAMES] = "";
    const char *text = cell(t, row, col), *name = t->head[col];
    strncat(kind, t->name, strcspn(t->name, "."));
    const char *promised = maybe(manifest, "decimals.%s.%s", kind, name);
    if (atol(promised ? promised : get(manifest, "digits")) != places(text))
        wrong("%s, row %ld: %s = %s has another number of decimals than promised\n", t->name, row + 1, name, text);
    decimal(value, text);
    power_of_ten(places(text));
    fmpq_mul_fmpz(value, value, ten_to);          /* an integer */
    arb_mul_fmpz(off, x, ten_to, bits + 64);
    arb_sub_fmpz(off, off, fmpq_numref(value), bits + 64);
    arb_abs(off, off);
    decimal(value, bound);
    power_of_ten(places(text));
    fmpq_mul_fmpz(value, value, ten_to);
    fmpq_set_si(unit_part, 1, is_enclosed ? 2 : 1);
    arb_set_fmpq(most, fmpq_cmp(value, unit_part) < 0 ? value : unit_part, bits);
    double about = arf_get_d(arb_midref(off), ARF_RND_NEAR), wide = (double)bound_of(arb_radref(off));
    if (arb_gt(off, most))
        wrong("%s, row %ld: %s = %s is off by %.6f units of its last digit (its bound is %s)\n", t->name, row + 1, name, text,
              about, bound);
    if (!arb_le(off, most))
        undecided("%s, row %ld: %s = %s is off by %.6f +- %.2g units of its last digit", t->name, row + 1, name, text, about,
                  wide);
    t->widest = fmax(t->widest, about + wide);
    long significant = strlen(text + strspn(text, "-0.")) - (strcspn(text, ".") > strspn(text, "-0") && places(text));
    t->digits[col] = significant > t->digits[col] ? significant : t->digits[col];
    if (t->doubles)
        prove_double(t->doubles, row, col, x, text, bound);
}

/* ------------------------------------------------------------------------------------------------------ the two tables */

static table *grid;
static arb_struct here[ALL];                      /* the motion at a time, or in an interval */
static int sign;                                  /* that xdot must have now; 0 where no row says it yet */

/* The exact time of a row of the grid: multiples of grid_step, and at last t_end. A last multiple that misses t_end by no
   more than the rounding of inputs to doubles is none. */
static int grid_time(fmpq_t t, long row) {
    static fmpq_t rest;
    fmpq_mul_si(t, grid_step, row);
    fmpq_sub(rest, end, t);
    fmpq_mul_2exp(rest, rest, 30);
    int is_last = fmpq_sgn(rest) <= 0 || (row > 0 && fmpq_cmp(rest, grid_step) < 0);
    if (is_last)
        fmpq_set(t, end);
    return is_last;
}

/* The bound of a column. */
static const char *bound_of_column(const table *t, long col) {
    const char *bound = maybe(manifest, "bounds.%s.%s", t == grid ? "grid" : "transits", t->head[col]);
    return bound ? bound : "0";
}

static void check_grid_row(const fmpq_t t, long row) {
    static arb_t s, time;
    static fmpq_t printed;
    if (row >= grid->rows)
        wrong("grid.csv: row %ld is missing\n", row + 1);
    decimal(printed, cell(grid, row, 0));
    if (!fmpq_equal(printed, t))
        wrong("grid.csv, row %ld: t = %s is not the time of this row\n", row + 1, cell(grid, row, 0));
    local(s, time, t);
    prove(grid, row, 0, time, "1");
    motion(here, s, bits);
    for (int i = 0; i < 6; i++) {
        arb_mul(s, here + (i < 3 ? R + i : V + i - 3), length, bits + 64);
        prove(grid, row, i + 1, s, bound_of_column(grid, i + 1));
    }
}

static int sign_at(const arf_t s, slong p) {
    static arb_t x;
    arb_set_arf(x, s);
    motion(here, x, p);
    return sign_of(here + V);
}

/* Proves that xdot has its sign on [a, b], but for xdot = 0 at the release itself: by the mean value theorem, or as it has the
   sign at both ends and is monotone; at the release, as it is 0 there and its first derivative that is not has the sign. */
static void no_zero(const arf_t a, const arf_t b, int depth) {
    static arb_t s, v;
    static arf_t step;
    arf_t middle;
    if (arf_cmp(a, b) >= 0)
        return;
    arf_init(middle);
    arf_add(middle, a, b, bits, ARF_RND_NEAR);
    arf_mul_2exp_si(middle, middle, -1);
    int found = sign_at(middle, bits / 2);
    if (sign == 0)
        sign = found;
    if (found == -sign && found != 0)
        wrong("transits.csv: xdot has the sign %+d at t = %.17g: a transit beside it is missing, too many, or wrong\n", found,
              fmpq_get_d(step_begin) + h * arf_get_d(middle, ARF_RND_NEAR));
    arb_set(v, here + V);
    arb_set_interval_arf(s, a, b, bits);
    motion(here, s, bits / 2);
    arf_set_d(step, h);
    arb_sub_arf(s, s, middle, bits);
    arb_mul_arf(s, s, step, bits);
    arb_addmul(v, s, here + R2, bits);
    int bend = sign_of(here + R2), is_release = fmpq_is_zero(step_begin) && arf_is_zero(a) && from_zero;
    int done = sign_of(v) == sign || (is_release && (bend == sign || (from_double_zero && sign_of(here + R3) == sign)));
    done = sign != 0 && (done || (bend != 0 && sign_at(a, bits) == sign && sign_at(b, bits) == sign));
    if (!done && depth == MOST_DEPTH)
        undecided("transits.csv: a zero of xdot near t = %.17g cannot be excluded",
                  fmpq_get_d(step_begin) + h * arf_get_d(middle, ARF_RND_NEAR));
    if (!done) {
        no_zero(a, middle, depth + 1);
        no_zero(middle, b, depth + 1);
    }
    arf_clear(middle);
}

static long next_possible;
static fmpq_t clear_from;                         /* what is before this time is done */

/* Proves that xdot has no zero from `left` to the interval I of the row `next`, and one in that. */
static void check_transit(const arf_t left) {
    static arb_t t, s, n, interval, first, last;
    static arf_t begin;
    static fmpq_t low, high;
    const char *word = cell(transits, next, 2), *text = cell(transits, next, 1);
    int direction = strcmp(word, "+1") == 0 ? 1 : -1;
    if (atol(cell(transits, next, 0)) != next + 1 || sign == direction || (direction < 0 && strcmp(word, "-1") != 0))
        wrong("transits.csv, row %ld: number or direction is wrong\n", next + 1);
    sign = -direction;
    fmpq_sub(low, times + next, half);
    fmpq_add(high, times + next, half);
    local(first, interval, low);
    local(last, t, high);
    arb_union(interval, interval, t, bits + 64);
    if (!arb_is_nonnegative(first))
        undecided("transits.csv, row %ld: t = %s may be before the release", next + 1, text);
    arb_get_ubound_arf(begin, first, bits);
    no_zero(left, begin, 0);
    local(s, interval, NULL);
    motion(here, s, bits);
    arb_set(n, here + R2);
    if (sign_of(n) == -direction)
        wrong("transits.csv, row %ld: the direction is wrong, or there is no transit\n", next + 1);
    if (sign_of(n) == 0)
        undecided("transits.csv, row %ld: xdot may have no single zero at t = %s", next + 1, text);
    local(s, t, times + next);
    motion(here, s, bits);
    arb_div(n, here + V, n, bits);
    arb_sub(n, t, n, bits + 64);                  /* N of 5. */
    prove(transits, next, 1, n, cell(transits, next, 8));
    arb_set_fmpq(t, end, bits + 64);
    local(s, n, NULL);
    if (arb_gt(n, t))
        wrong("transits.csv, row %ld: t = %s is after the end of the run\n", next + 1, text);
    if (!arb_gt(s, first) || !arb_lt(s, last) || !arb_is_positive(n) || !arb_le(n, t))
        undecided("transits.csv, row %ld: t = %s is at the edge of its last digit, or of the run", next + 1, text);
    motion(here, s, bits);
    arb_srcptr x[] = {here + R, here + R + 1, here + R + 2, here + V + 1, here + R2};
    for (int i = 0; i < 5; i++) {
        arb_mul(t, x[i], length, bits + 64);
        prove(transits, next, 3 + i, t, bound_of_column(transits, 3 + i));
    }
    fmpq_set(clear_from, high);
    sign = direction;
    next++;
}

/* The next interval that may hold more transits: nothing is proved inside, and the sign after it follows from its parity. */
static int possible(fmpq_t from, fmpq_t to) {
    const char *a = maybe(manifest, "possible.%ld.from_s", next_possible);
    const char *b = maybe(manifest, "possible.%ld.to_s", next_possible);
    if (a == NULL || b == NULL)
        return 0;
    decimal(from, a);
    decimal(to, b);
    return 1;
}

static void check_zeros_of_step(void) {
    static fmpq_t from, to;
    static arf_t left, right;
    static fmpq_t row_end;
    static arb_t s, t;
    for (;;) {
        local(s, t, clear_from);
        arb_get_lbound_arf(left, s, bits);
        if (arf_sgn(left) < 0)
            arf_zero(left);
        int is_possible = possible(from, to) && fmpq_cmp(from, step_next) < 0;
        fmpq_add(row_end, half, next < transits->rows ? times + next : end);
        int is_row = next < transits->rows && fmpq_cmp(row_end, step_end) < 0;
        if (is_row && (!is_possible || fmpq_cmp(times + next, from) < 0)) {
            check_transit(left);
            continue;
        }
        if (!is_possible)
            break;
        local(s, t, from);
        arb_get_ubound_arf(right, s, bits);
        no_zero(left, right, 0);
        const char *parity = maybe(manifest, "possible.%ld.parity", next_possible++);
        if (parity == NULL || fmpq_cmp(from, to) >= 0 || fmpq_cmp(from, clear_from) < 0)
            wrong("manifest.json: possible.%ld is no interval, or not in order\n", next_possible - 1);
        if (sign == 0 && strcmp(parity, "unknown") != 0)
            undecided("manifest.json: the parity of possible.%ld cannot be proved", next_possible - 1);
        sign *= (strcmp(parity, "even") == 0) - (strcmp(parity, "odd") == 0);
        fmpq_set(clear_from, to);
    }
    local(s, t, fmpq_cmp(end, step_next) < 0 ? end : step_next);
    arb_get_ubound_arf(right, s, bits);
    no_zero(left, right, 0);
}

/* --------------------------------------------------------------------------------------------------- the other files */

#define GRID "t,x,y,z,vx,vy,vz"
#define GRID_BINARY64 GRID ",t_hex,x_hex,y_hex,z_hex,vx_hex,vy_hex,vz_hex"
#define TRANSITS "k,t,direction,x,y,z,vy,ax,bound"
#define TRANSITS_BINARY64 TRANSITS ",t_hex,x_hex,y_hex,z_hex,vy_hex,ax_hex"

static void same(const document *d, const char *key, const char *format, ...) {
    char text[1000];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    if (strcmp(get(d, key), text) != 0)
        wrong("%s: %s is %s and not %s\n", d->name, key, text, get(d, key));
}

/* h of a printed row in m^2/s^2: v^2/2 + g z - rate^2/2 (x^2 + axis^2), axis = R - y sin + z cos. */
static void invariant(arb_t out, long row) {
    static arb_struct x[6];
    static arb_t axis;
    static fmpq_t value;
    slong p = bits + 64;
    for (int i = 0; i < 6; i++) {
        decimal(value, cell(grid, row, i + 1));
        arb_set_fmpq(x + i, value, p);
    }
    arb_set(axis, radius);
    arb_submul(axis, x + 1, sine, p);
    arb_addmul(axis, x + 2, cosine, p);
    arb_mul(axis, axis, axis, p);
    arb_addmul(axis, x, x, p);
    arb_mul(axis, axis, rate, p);
    arb_mul(axis, axis, rate, p);
    arb_dot(out, NULL, 0, x + 3, 1, x + 3, 1, 3, p);
    arb_sub(out, out, axis, p);
    arb_mul_2exp_si(out, out, -1);
    arb_addmul(out, gravity, x + 2, p);
}

static void check_invariant(void) {
    static arb_t h_of_row;
    static table t = {.name = "manifest.json", .columns = 1, .head = {"h"}};
    char *text = (char *)get(manifest, "invariant.h_m2_s2");
    t.cells = &text;
    invariant(h_of_row, 0);
    prove(&t, 0, 0, h_of_row, "1");
}

static void check_digits(const table *t, long col) {
    long digits = atol(get(manifest, "digits"));
    if (t->digits[col] > 0 && t->digits[col] != digits && t->digits[col] != digits + 1)
        wrong("%s: %s has %ld significant digits, not %ld\n", t->name, t->head[col], t->digits[col], digits);
}

static void check_largest(const char *key, double a, double b, double d) {
    if (strtod(get(manifest, key), NULL) != fmax(a, fmax(b, d)))
        wrong("manifest.json: %s is not the largest bound of its columns\n", key);
}

/* The digits and the largest bounds that the manifest promises. */
static void check_manifest(void) {
    double b[7], largest = 0;
    for (long col = 1; col < 7; col++) {
        check_digits(grid, col);
        b[col] = strtod(bound_of_column(grid, col), NULL);
    }
    check_largest("bounds.position_m", b[1], b[2], b[3]);
    check_largest("bounds.velocity_m_s", b[4], b[5], b[6]);
    if (transits == NULL || transits->rows == 0)
        return;
    check_digits(transits, 1);
    check_digits(transits, 7);
    for (long row = 0; row < transits->rows; row++)
        largest = fmax(largest, strtod(cell(transits, row, 8), NULL));
    check_largest("bounds.transit_s", largest, largest, largest);
    check_largest("bounds.transits.t", largest, largest, largest);
}

static void check_vectors(document *d, table *t, const char *list, const char *number) {
    char key[200];
    for (long i = 0; t && maybe(d, "%s.%ld.%s", list, i, number); i++) {
        long row = atol(maybe(d, "%s.%ld.%s", list, i, number)) - 1;
        if (row < 0 || row >= t->rows)
            wrong("vectors.json: %s.%ld is none of %s\n", list, i, t->name);
        for (long col = 0; col < t->columns; col++) {
            const char *name = t->head[col], *text = cell(t, row, col);
            const char *hex = maybe(d, "%s.%ld.values.%s.hexfloat", list, i, name);
            snprintf(key, sizeof key, "%s.%ld.%s", list, i, name);
            if (strcmp(name, "direction") == 0)
                same(d, key, "%d", atoi(text));
            if (!maybe(manifest, "decimals.%s.%s", t == grid ? "grid" : "transits", name))
                continue;
            snprintf(key, sizeof key, "%s.%ld.values.%s.decimal", list, i, name);
            same(d, key, "%s", text);
            double right = strtod(t->doubles ? cell(t->doubles, row, col) : text, NULL);
            if (hex == NULL || strtod(hex, NULL) != right)
                wrong("vectors.json: %s.%ld: the hexfloat of %s is wrong\n", list, i, name);
            snprintf(key, sizeof key, "%s.%ld.values.%s.bound", list, i, name);
            const char *bound = col == 0 ? "0" : t == transits && col == 1 ? cell(t, row, 8) : NULL;
            same(d, key, "%s", bound ? bound : bound_of_column(t, col));
        }
    }
}

/* Demands a text in certified.txt, after the last one that was found. */
static void expect(const char *format, ...) {
    static char *text, part[100000];
    va_list list;
    va_start(list, format);
    vsnprintf(part, sizeof part, format, list);
    if (text == NULL)
        text = text_of("certified.txt");
    text = text ? strstr(text, part) : NULL;
    if (text == NULL)
        wrong("certified.txt has not, or not in this place: %s\n", part);
    text += strlen(part) - 1;
}

/* The numbers on the page for people. */
static void check_page(void) {
    long rows = transits ? transits->rows : 0, last = grid->rows - 1;
    int width = 0;
    expect("%s. ", get(manifest, "level"));
    for (long i = 0; i < manifest->count; i++)
        if (strncmp(manifest->key[i], "scene.", 6) == 0)
            expect("  %-26s %s\n", manifest->key[i] + 6, manifest->value[i]);
    for (int i = 1; i < 7; i++)
        width = fmax(width, fmax(strlen(cell(grid, 0, i)), strlen(cell(grid, last, i))));
    for (long row = 0; row <= last; row += last > 0 ? last : 1) {
        expect("at t = %s s\n", cell(grid, row, 0));
        for (int i = 1; i < 7; i++)
            expect("\n  %-3s %*s\n", grid->head[i], width, cell(grid, row, i));
    }
    expect("position %s m, on every velocity %s m/s\n", get(manifest, "bounds.position_m"), get(manifest, "bounds.velocity_m_s"));
    for (int i = 1; i < 7; i++)
        expect(" %s %s%s", grid->head[i], bound_of_column(grid, i), i < 6 ? "," : "\n");
    expect("Transits (xdot = 0, t > 0): %ld (%s)\n", rows, get(manifest, "transits"));
    for (long row = 0; row < rows; row += rows > 1 ? rows - 1 : 1)
        expect("t = %s s, direction %s, bound %s s\n", cell(transits, row, 1), cell(transits, row, 2), cell(transits, row, 8));
    if (rows > 0)
        expect("  largest bound on a time %s s\n", get(manifest, "bounds.transit_s"));
    for (long i = 0; maybe(manifest, "possible.%ld.from_s", i); i++)
        expect("[%s, %s] s (%s number", maybe(manifest, "possible.%ld.from_s", i), maybe(manifest, "possible.%ld.to_s", i),
               maybe(manifest, "possible.%ld.parity", i));
}

/* ---------------------------------------------------------------------------------------------------------------- run */

/* Room for numbers of this many bits; that of an attempt with fewer bits is not given back. */
static void prepare(slong more) {
    bits = more;
    highest = bits * 9 / 20 + 8;
    make_curve(&q);
    make_curve(&rough);
    for (int i = 0; i < 6; i++)
        make_curve(column + i);
    powers = _arb_vec_init(highest + 2);
    arb_mat_init(frame, 6, 6);
    arb_mat_init(at_end, 6, 6);
    arb_mat_init(inverse, 6, 6);
    arb_mat_init(change, 6, 6);
    fmpq_zero(clear_from);
    next = next_possible = sign = 0;
    grid->widest = 0;
    if (transits)
        transits->widest = 0;
}

/* From the release to the end of the run. Returns the number of steps. */
static long run(void) {
    static fmpq_t t;
    long row = 0, steps = 0;
    int is_last = 0;
    start();
    for (; !is_last; steps++) {
        double length_of_next = step();
        for (; !is_last; row++) {
            int last_one = grid_time(t, row);
            if (fmpq_cmp(t, step_next) > 0)
                break;
            check_grid_row(t, row);
            is_last = last_one;
        }
        if (transits && !never)
            check_zeros_of_step();
        go_on(length_of_next);
    }
    if (row != grid->rows)
        wrong("grid.csv: row %ld is too many\n", row + 1);
    if (transits && next != transits->rows)
        wrong("transits.csv: row %ld is too many\n", next + 1);
    return steps;
}

static void read_transits(void) {
    transits = read_table("transits.csv", TRANSITS);
    if (transits == NULL)
        no_dataset("no transits.csv\n");
    transits->doubles = read_table("transits.binary64.csv", TRANSITS_BINARY64);
    times = calloc(transits->rows + 1, sizeof(fmpq));
    power_of_ten(transits->rows ? places(cell(transits, 0, 1)) : 0);
    fmpq_set_si(half, 1, 2);
    fmpq_div_fmpz(half, half, ten_to);
    for (long i = 0; i < transits->rows; i++)
        decimal(times + i, cell(transits, i, 1));
    for (long i = 1; i < transits->rows; i++)
        if (fmpq_cmp(times + i, times + i - 1) <= 0)
            wrong("transits.csv, row %ld: not after the row before\n", i + 1);
}

int main(int count, char **words) {
    folder = count == 2 ? words[1] : "";
    manifest = read_document("manifest.json");
    grid = read_table("grid.csv", GRID);
    if (count != 2 || manifest == NULL || grid == NULL || grid->rows == 0)
        no_dataset("usage: check FOLDER, with manifest.json and grid.csv in it\n");
    document *vectors = read_document("vectors.json");
    grid->doubles = read_table("grid.binary64.csv", GRID_BINARY64);
    as_doubles = strcmp(get(manifest, "inputs"), "binary64") == 0;
    if (!as_doubles && strcmp(get(manifest, "inputs"), "decimal") != 0)
        no_dataset("inputs must be decimal or binary64\n");
    is_enclosed = strcmp(get(manifest, "level"), "enclosed") == 0;
    input(end, "run.t_end");
    input(grid_step, "run.grid_step");
    if (strcmp(get(manifest, "scene.run.transits"), "true") == 0)
        read_transits();
    double numbers = 6.0 * (grid->rows + (transits ? transits->rows : 0));
    double swings = fmpq_get_d(end) * sqrt(strtod(get(manifest, "scene.site.gravity"), NULL) /
                                           strtod(get(manifest, "scene.pendulum.length"), NULL));
    slong long_run = fmax(0, 2 * (ilogb(swings + 1) - 15));
    volatile slong more = 46 + ilogb(numbers) + long_run + 10 * atol(get(manifest, "digits")) / 3;    /* a guess */
    if (setjmp(with_more_bits) && (more = more * 7 / 5) > MOST_BITS)
        wrong("not proved with %ld bits: %s\n", (long)bits, doubt);
    prepare(more);
    long steps = run();
    const char *word = !transits ? "not asked for" : never ? "xdot is identically zero" : "complete";
    same(manifest, "transits", "%s", next_possible ? "undecided intervals" : word);
    same(manifest, "counts.grid", "%ld", grid->rows);
    same(manifest, "counts.transits", "%ld", transits ? transits->rows : 0);
    same(manifest, "counts.possible", "%ld", next_possible);
    same(manifest, "digits", "%s", get(manifest, "scene.run.digits"));
    check_manifest();
    check_invariant();
    check_page();
    if (vectors) {
        check_vectors(vectors, grid, "states", "row");
        check_vectors(vectors, transits, "transits", "k");
    }
    printf("%s: %s, inputs %s, %ld steps of order %ld with %ld bits\n", folder, get(manifest, "level"), get(manifest, "inputs"),
           steps, (long)highest, (long)bits);
    printf("  grid.csv      %6ld rows, widest distance %.6f units of the last digit\n", grid->rows, grid->widest);
    if (transits)
        printf("  transits.csv  %6ld rows, widest distance %.6f; %s\n", transits->rows, transits->widest,
               get(manifest, "transits"));
    printf("  the doubles, vectors.json, certified.txt and the numbers of manifest.json agree\nevery printed number is proved\n");
    return 0;
}
