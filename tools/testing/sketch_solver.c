/* Independent solver for test/campaign/sketch_campaign.py: constraint equations in Cartesian coordinates of points, followed from the drawing.
   Unknowns x[1..n], x[0] = 1. A term is coefficient * f(s[drive]) * x[i] * x[j] with f = 1, cos, sin, s, s*s. A row of a gear pair
   is the sum of weight * angle of a direction, which is linear in x; its angle is counted on over turns. 80-bit arithmetic. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef long double real;

typedef struct {
    int n, terms, drives, turns;            /* turns: directions in gear rows */
    const int *row, *i, *j, *drive, *kind;
    const double *c;
    const int *turn_row;                    /* of each direction: its row, weight, and forms of 2 (n+1) coefficients */
    const double *turn_weight, *turn_form;
    double *angle;                          /* of each direction at the state that is known */
} system_t;

static real f_of(int kind, real s, int order) {
    switch (kind) {
    case 1: return order == 0 ? cosl(s) : order == 1 ? -sinl(s) : -cosl(s);
    case 2: return order == 0 ? sinl(s) : order == 1 ? cosl(s) : -sinl(s);
    case 3: return order == 0 ? s : order == 1 ? 1 : 0;
    case 4: return order == 0 ? s * s : order == 1 ? 2 * s : 2;
    default: return order == 0 ? 1 : 0;
    }
}

static void direction(const system_t *p, int k, const real *x, real *ex, real *ey) {
    const double *form = p->turn_form + 2 * k * (p->n + 1);
    *ex = *ey = 0;
    for (int m = 0; m <= p->n; m++) {
        *ex += form[m] * x[m];
        *ey += form[p->n + 1 + m] * x[m];
    }
}

static real angle_near(real ex, real ey, real known) {
    real a = atan2l(ey, ex), turn = 2 * acosl(-1);
    return a + turn * roundl((known - a) / turn);
}

/* Residuals r[0..n-1], rows of the Jacobian by x[1..n] in a[row*n + unknown - 1], and by the drives in b[row*drives + drive]. */
static void evaluate(const system_t *p, const real *s, const real *x, real *r, real *a, real *b) {
    int n = p->n;
    memset(r, 0, n * sizeof *r);
    memset(a, 0, n * n * sizeof *a);
    memset(b, 0, n * p->drives * sizeof *b);
    for (int t = 0; t < p->terms; t++) {
        int i = p->i[t], j = p->j[t], row = p->row[t];
        real f = p->c[t], g = f;
        if (p->kind[t]) {
            f *= f_of(p->kind[t], s[p->drive[t]], 0);
            g *= f_of(p->kind[t], s[p->drive[t]], 1);
            b[row * p->drives + p->drive[t]] += g * x[i] * x[j];
        }
        r[row] += f * x[i] * x[j];
        if (i) a[row * n + i - 1] += f * x[j];
        if (j) a[row * n + j - 1] += f * x[i];
    }
    for (int k = 0; k < p->turns; k++) {
        real ex, ey;
        int row = p->turn_row[k];
        const double *form = p->turn_form + 2 * k * (n + 1);
        direction(p, k, x, &ex, &ey);
        real square = ex * ex + ey * ey;
        r[row] += p->turn_weight[k] * angle_near(ex, ey, p->angle[k]);
        for (int m = 1; m <= n; m++)
            a[row * n + m - 1] += p->turn_weight[k] * (ex * form[n + 1 + m] - ey * form[m]) / square;
    }
    for (int row = 0; row < n; row++) {     /* rows of length one */
        real norm = 0;
        for (int m = 0; m < n; m++) norm += a[row * n + m] * a[row * n + m];
        norm = norm > 0 ? 1 / sqrtl(norm) : 1;
        for (int m = 0; m < n; m++) a[row * n + m] *= norm;
        for (int m = 0; m < p->drives; m++) b[row * p->drives + m] *= norm;
        r[row] *= norm;
    }
}

/* LU with row pivots; returns the sign of the determinant, 0 if singular. */
static int decompose(int n, real *a, int *pivot) {
    int sign = 1;
    for (int k = 0; k < n; k++) {
        int best = k;
        for (int m = k + 1; m < n; m++) if (fabsl(a[m * n + k]) > fabsl(a[best * n + k])) best = m;
        pivot[k] = best;
        if (best != k) {
            sign = -sign;
            for (int m = 0; m < n; m++) { real t = a[k * n + m]; a[k * n + m] = a[best * n + m]; a[best * n + m] = t; }
        }
        if (fabsl(a[k * n + k]) < 1e-17L) return 0;
        if (a[k * n + k] < 0) sign = -sign;
        for (int m = k + 1; m < n; m++) {
            if (a[m * n + k] == 0) continue;
            real q = a[m * n + k] /= a[k * n + k];
            for (int c = k + 1; c < n; c++) a[m * n + c] -= q * a[k * n + c];
        }
    }
    return sign;
}

static void back(int n, const real *a, const int *pivot, real *v) {
    for (int k = 0; k < n; k++) { real t = v[k]; v[k] = v[pivot[k]]; v[pivot[k]] = t; }
    for (int k = 0; k < n; k++) for (int m = 0; m < k; m++) v[k] -= a[k * n + m] * v[m];
    for (int k = n - 1; k >= 0; k--) {
        for (int m = k + 1; m < n; m++) v[k] -= a[k * n + m] * v[m];
        v[k] /= a[k * n + k];
    }
}

/* Largest row sum of the inverse. */
static double inverse_norm(int n, const real *a, const int *pivot) {
    real worst = 0, *sum = calloc(2 * n, sizeof *sum), *v = sum + n;
    for (int k = 0; k < n; k++) {
        memset(v, 0, n * sizeof *v);
        v[k] = 1;
        back(n, a, pivot, v);
        for (int m = 0; m < n; m++) sum[m] += fabsl(v[m]);
    }
    for (int m = 0; m < n; m++) if (sum[m] > worst) worst = sum[m];
    free(sum);
    return worst;
}

/* Follow from the state x at drives s0 to s1 along the straight line, steps at most `step` of it. Returns the part of the way that was
   reached (1: all of it) with x there; norm: that of the inverse Jacobian at the end, worst: the greatest pivot ratio met on the way. */
double follow(int n, int terms, int drives, int turns, const int *row, const int *i, const int *j, const int *drive, const int *kind,
              const double *c, const int *turn_row, const double *turn_weight, const double *turn_form, double *angle,
              const double *s0, const double *s1, double step, double *state, double *norm) {
    system_t p = {n, terms, drives, turns, row, i, j, drive, kind, c, turn_row, turn_weight, turn_form, angle};
    real *room = malloc((size_t)(4 * (n + 1) + n * n + n * drives + drives + n) * sizeof *room);
    real *x = room, *y = x + n + 1, *tangent = y + n + 1, *r = tangent + n + 1, *a = r + n, *b = a + n * n, *s = b + n * drives;
    int *pivot = malloc(n * sizeof *pivot), sign, first = 1, sign0 = 0;
    double at = 0, h = step;
    for (int m = 0; m <= n; m++) x[m] = state[m];
    *norm = INFINITY;
    while (1) {
        /* state x at `at`: tangent */
        for (int d = 0; d < drives; d++) s[d] = s0[d] + at * ((real)s1[d] - s0[d]);
        for (int it = 0; it < 3; it++) {    /* to the last digit */
            evaluate(&p, s, x, r, a, b);
            sign = decompose(n, a, pivot);
            if (!sign) goto done;
            back(n, a, pivot, r);
            real most = 0;
            for (int m = 0; m < n; m++) { x[m + 1] -= r[m]; if (fabsl(r[m]) > most) most = fabsl(r[m]); }
            if (most < 1e-15L) break;
        }
        if (first) sign0 = sign;
        first = 0;
        if (at >= 1) break;
        for (int m = 0; m < n; m++) {
            tangent[m] = 0;
            for (int d = 0; d < drives; d++) tangent[m] -= b[m * drives + d] * ((real)s1[d] - s0[d]);
        }
        back(n, a, pivot, tangent);
        real speed = 0;
        for (int m = 0; m < n; m++) if (fabsl(tangent[m]) > speed) speed = fabsl(tangent[m]);
        while (1) {
            if (at + h > 1) h = 1 - at;
            int good = speed * h < 0.1;
            if (good) {
                real to = at + h, moved = 0;
                y[0] = 1;
                for (int m = 0; m < n; m++) y[m + 1] = x[m + 1] + h * tangent[m];
                for (int d = 0; d < drives; d++) s[d] = s0[d] + to * ((real)s1[d] - s0[d]);
                good = 0;
                for (int it = 0; it < 6; it++) {
                    real most = 0;
                    evaluate(&p, s, y, r, a, b);
                    sign = decompose(n, a, pivot);
                    if (!sign) break;
                    back(n, a, pivot, r);
                    for (int m = 0; m < n; m++) { y[m + 1] -= r[m]; if (fabsl(r[m]) > most) most = fabsl(r[m]); }
                    moved += most;
                    if (moved > 0.01) break;
                    if (most < 1e-9L) { good = 1; break; }
                }
                good = good && sign == sign0;
            }
            if (good) break;
            h *= 0.5;
            if (h < 1e-7) goto done;
        }
        memcpy(x, y, (n + 1) * sizeof *x);
        at = at + h >= 1 - 1e-13 ? 1 : at + h;
        for (int k = 0; k < turns; k++) {
            real ex, ey;
            direction(&p, k, x, &ex, &ey);
            angle[k] = angle_near(ex, ey, angle[k]);
        }
        h = h * 1.6 < step ? h * 1.6 : step;
    }
    *norm = inverse_norm(n, a, pivot);
done:
    for (int m = 0; m <= n; m++) state[m] = x[m];
    free(room);
    free(pivot);
    return at;
}

/* First and second derivatives by time at a state, and the derivatives by each drive (by_drive[d*(n+1) + m]). */
int rates(int n, int terms, int drives, int turns, const int *row, const int *i, const int *j, const int *drive, const int *kind,
          const double *c, const int *turn_row, const double *turn_weight, const double *turn_form, double *angle,
          const double *at, const double *speed, const double *growth, const double *state,
          double *first, double *second, double *by_drive) {
    system_t p = {n, terms, drives, turns, row, i, j, drive, kind, c, turn_row, turn_weight, turn_form, angle};
    real *room = malloc((size_t)(4 * (n + 1) + n * n + n * drives + drives + n) * sizeof *room);
    real *x = room, *v = x + n + 1, *w = v + n + 1, *r = w + n + 1, *a = r + n, *b = a + n * n, *s = b + n * drives, *scale = s + drives;
    int *pivot = malloc(n * sizeof *pivot), good;
    for (int m = 0; m <= n; m++) x[m] = state[m];
    for (int d = 0; d < drives; d++) s[d] = at[d];
    for (int it = 0; it < 2; it++) {
        evaluate(&p, s, x, r, a, b);
        good = decompose(n, a, pivot);
        if (!good) goto done;
        back(n, a, pivot, r);
        for (int m = 0; m < n; m++) x[m + 1] -= r[m];
    }
    evaluate(&p, s, x, r, a, b);
    good = decompose(n, a, pivot);
    if (!good) goto done;
    memset(v, 0, (n + 1) * sizeof *v);
    for (int d = 0; d < drives; d++) {
        for (int m = 0; m < n; m++) w[m] = -b[m * drives + d];
        back(n, a, pivot, w);
        by_drive[d * (n + 1)] = 0;
        for (int m = 0; m < n; m++) { by_drive[d * (n + 1) + m + 1] = w[m]; v[m + 1] += w[m] * speed[d]; }
    }
    memset(w, 0, n * sizeof *w);
    memset(scale, 0, n * sizeof *scale);
    /* the rows were made of length one: their lengths again */
    {
        real *plain = calloc((size_t)n * n, sizeof *plain);
        for (int t = 0; t < terms; t++) {
            real f = c[t] * (kind[t] ? f_of(kind[t], s[drive[t]], 0) : 1);
            if (i[t]) plain[row[t] * n + i[t] - 1] += f * x[j[t]];
            if (j[t]) plain[row[t] * n + j[t] - 1] += f * x[i[t]];
            real second_part = 2 * f * v[i[t]] * v[j[t]];
            if (kind[t]) {
                int d = drive[t];
                real f1 = c[t] * f_of(kind[t], s[d], 1), f2 = c[t] * f_of(kind[t], s[d], 2);
                second_part += (f2 * speed[d] * speed[d] + f1 * growth[d]) * x[i[t]] * x[j[t]]
                    + 2 * f1 * speed[d] * (v[i[t]] * x[j[t]] + x[i[t]] * v[j[t]]);
            }
            w[row[t]] -= second_part;
        }
        for (int k = 0; k < turns; k++) {
            real ex, ey, vx, vy;
            const double *form = turn_form + 2 * k * (n + 1);
            direction(&p, k, x, &ex, &ey);
            direction(&p, k, v, &vx, &vy);
            real square = ex * ex + ey * ey;
            for (int m = 1; m <= n; m++)
                plain[turn_row[k] * n + m - 1] += turn_weight[k] * (ex * form[n + 1 + m] - ey * form[m]) / square;
            w[turn_row[k]] += 2 * turn_weight[k] * (ex * vy - ey * vx) * (ex * vx + ey * vy) / (square * square);
        }
        for (int m = 0; m < n; m++) {
            for (int q = 0; q < n; q++) scale[m] += plain[m * n + q] * plain[m * n + q];
            w[m] /= sqrtl(scale[m]);
        }
        free(plain);
    }
    back(n, a, pivot, w);
    first[0] = second[0] = 0;
    for (int m = 0; m < n; m++) { first[m + 1] = v[m + 1]; second[m + 1] = w[m]; }
done:
    free(room);
    free(pivot);
    return good;
}
