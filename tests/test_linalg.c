/* Dense LU, sparse direct and incomplete factorisations, block-sparse products: against each other and by
 * definition. */

#include "internals.h"
#include "test.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- dense ------------------------------------------------------------------------------------------------------- */

enum { LU_SPARE = 3 }; /* rows of A and right-hand sides are that much further apart than n */

typedef struct {
    int n, lda, count, ldx;
    double *a, *b, *x;
    yc_lu *lu;
} lu_system;

/* Arrays end where the library may read last. */
static void lu_open(lu_system *s, int n, int count, const yci_kernels *kernels, uint64_t *seed) {
    size_t size, i;
    s->n = n, s->lda = s->ldx = n + LU_SPARE, s->count = count, s->lu = NULL;
    size = n ? (size_t)(n - 1) * (size_t)s->lda + (size_t)n : 0;
    s->a = (double *)malloc((size + 1) * sizeof(double)) + 1;
    for (i = 0; i < size; i++) s->a[i] = test_random(seed, -1.0, 1.0);
    size = count ? (size_t)(count - 1) * (size_t)s->ldx + (size_t)n : 0;
    s->b = (double *)malloc((size + 1) * sizeof(double)) + 1, s->x = (double *)malloc((size + 1) * sizeof(double)) + 1;
    for (i = 0; i < size; i++) s->b[i] = test_random(seed, -1.0, 1.0);
    CHECK_RESULT(yc_lu_create(NULL, n, &s->lu), YC_OK);
    if (kernels) s->lu->kernels = kernels;
}

static void lu_close(lu_system *s) {
    yc_lu_destroy(s->lu);
    free(s->a - 1), free(s->b - 1), free(s->x - 1);
}

static double lu_entry(const lu_system *s, int transposed, int i, int j) {
    return transposed ? s->a[(size_t)j * (size_t)s->lda + (size_t)i] : s->a[(size_t)i * (size_t)s->lda + (size_t)j];
}

/* Solves for b; the backward error max |b - A x| / (|A| |x| + |b|). What lies between right-hand sides must stay. */
static double lu_error(lu_system *s, int transposed) {
    double worst = 0.0, size = 0.0, sum;
    size_t all = s->count ? (size_t)(s->count - 1) * (size_t)s->ldx + (size_t)s->n : 0;
    int i, j, k;
    if (s->count) memcpy(s->x, s->b, all * sizeof(double));
    if (transposed) CHECK_RESULT(yc_lu_solve_transposed(s->lu, s->x, s->count, s->ldx), YC_OK);
    else CHECK_RESULT(yc_lu_solve(s->lu, s->x, s->count, s->ldx), YC_OK);
    for (i = 0; i < s->n; i++) {
        for (sum = 0.0, j = 0; j < s->n; j++) sum += fabs(lu_entry(s, transposed, i, j));
        size = yci_max(size, sum);
    }
    for (k = 0; k < s->count; k++) {
        const double *x = s->x + (size_t)k * (size_t)s->ldx, *b = s->b + (size_t)k * (size_t)s->ldx;
        double most = 0.0;
        for (i = 0; i < s->n; i++) most = yci_max(most, fabs(x[i]));
        for (i = 0; i < s->n; i++) {
            long double rest = b[i];
            for (j = 0; j < s->n; j++) rest -= (long double)lu_entry(s, transposed, i, j) * (long double)x[j];
            worst = yci_max(worst, (double)(fabsl(rest) / ((long double)size * most + fabsl(b[i]))));
        }
        for (i = s->n; k + 1 < s->count && i < s->ldx; i++) CHECK(x[i] == b[i]);
    }
    return worst;
}

/* max |P A - L U| / max |A|, from the factor itself; no entry of L is above 1. */
static double lu_factor_error(const lu_system *s) {
    const yc_lu *lu = s->lu;
    double worst = 0.0, most = 0.0, *sum = (double *)malloc(((size_t)s->n + 1) * sizeof(double));
    int *row = (int *)malloc(((size_t)s->n + 1) * sizeof(int)), i, j, k, steep = 0;
    for (i = 0; i < s->n; i++) row[i] = i;
    for (i = 0; i < s->n; i++) k = row[i], row[i] = row[lu->pivot[i]], row[lu->pivot[i]] = k;
    for (i = 0; i < s->n; i++) {
        const double *f = lu->f + (size_t)i * lu->ld;
        for (j = 0; j < s->n; j++) sum[j] = lu_entry(s, 0, row[i], j), most = yci_max(most, fabs(sum[j]));
        for (k = 0; k <= i; k++) {
            double l = k < i ? f[k] : 1.0;
            steep += fabs(l) > 1.0 + 1e-15;
            for (j = k; j < s->n; j++) sum[j] -= l * lu->f[(size_t)k * lu->ld + (size_t)j];
        }
        for (j = 0; j < s->n; j++) worst = yci_max(worst, fabs(sum[j]));
    }
    CHECK(steep == 0);
    free(sum), free(row);
    return worst > 0.0 ? worst / most : 0.0;
}

static void lu_size(int n, const yci_kernels *kernels, uint64_t seed) {
    lu_system s;
    int count;
    lu_open(&s, n, n < 40 || n > 70 ? 9 : n % 10, kernels, &seed);
    CHECK_RESULT(yc_lu_factor(s.lu, s.a, s.lda), YC_OK);
    CHECK(lu_factor_error(&s) < 2e-15 * (1.0 + n / 16.0));
    CHECK(lu_error(&s, 0) < 4e-16 * (1.0 + n / 256.0) && lu_error(&s, 1) < 4e-16 * (1.0 + n / 256.0));
    for (count = 0; n == 37 && count < s.count; count++) {
        lu_system some = s;
        some.count = count;
        CHECK(lu_error(&some, 0) < 4e-16 && lu_error(&some, 1) < 4e-16);
    }
    lu_close(&s);
}

TEST(dense_lu) {
    static const int sizes[] = {127, 128, 129, 200, 513};
    int level, n;
    size_t i;
    for (level = 0; level < YCI_LEVELS; level++) {
        const yci_kernels *kernels = yci_kernels_of(level);
        if (!kernels) continue;
        for (n = 0; n <= 70; n++) lu_size(n, kernels, 7 + (uint64_t)n);
        for (i = 0; i < sizeof sizes / sizeof sizes[0]; i++) lu_size(sizes[i], kernels, 99 + (uint64_t)i);
    }
}

/* Scaled rows and columns, and a condition of 1e14; 1e-310 stands for numbers that are all subnormal. */
TEST(dense_lu_scales) {
    static const double scale[] = {1e150, 1e-150, 1e300, 1e-300};
    int level, k, i, j;
    for (level = 0; level < YCI_LEVELS; level++)
        for (k = 0; k < 6; k++) {
            const yci_kernels *kernels = yci_kernels_of(level);
            uint64_t seed = 5 + (uint64_t)k;
            lu_system s;
            if (!kernels) continue;
            lu_open(&s, 83, 2, kernels, &seed);
            for (i = 0; i < s.n; i++)
                for (j = 0; j < s.n; j++)
                    s.a[(size_t)i * (size_t)s.lda + (size_t)j] *=
                        k < 4 ? scale[k] : pow(10.0, -14.0 * (k == 4 ? i : j) / (s.n - 1));
            CHECK_RESULT(yc_lu_factor(s.lu, s.a, s.lda), YC_OK);
            CHECK(lu_error(&s, 0) < 4e-16 && lu_error(&s, 1) < 4e-16);
            lu_close(&s);
        }
}

/* Pivots whose reciprocal overflows, among others: x = 1, ..., 1 is exact to the grain of subnormal numbers. */
TEST(dense_lu_subnormal) {
    int level, n, i, j;
    for (level = 0; level < YCI_LEVELS; level++)
        for (n = 1; n < 30; n += 7) {
            const yci_kernels *kernels = yci_kernels_of(level);
            uint64_t seed = 3;
            lu_system s;
            double worst = 0.0;
            if (!kernels) continue;
            lu_open(&s, n, 1, kernels, &seed);
            for (i = 0; i < n; i++) {
                for (s.b[i] = 0.0, j = 0; j < n; j++) {
                    double *at = s.a + i * s.lda + j;
                    *at = i == j ? ldexp(1.0, -1040) : i > j ? ldexp(1.0, -1045) : 0.0;
                    s.b[i] += *at;
                }
            }
            CHECK_RESULT(yc_lu_factor(s.lu, s.a, s.lda), YC_OK);
            memcpy(s.x, s.b, (size_t)n * sizeof(double));
            CHECK_RESULT(yc_lu_solve(s.lu, s.x, 1, s.ldx), YC_OK);
            for (i = 0; i < n; i++) worst = yci_max(worst, fabs(s.x[i] - 1.0));
            CHECK(worst < 1e-9);
            for (j = 0; j < n; j++)
                for (s.x[j] = 0.0, i = 0; i < n; i++) s.x[j] += s.a[i * s.lda + j];
            CHECK_RESULT(yc_lu_solve_transposed(s.lu, s.x, 1, s.ldx), YC_OK);
            for (i = 0; i < n; i++) worst = yci_max(worst, fabs(s.x[i] - 1.0));
            CHECK(worst < 1e-9);
            lu_close(&s);
        }
}

/* J. H. Wilkinson's matrix, on which the last column grows at every step, without ties between pivots. */
TEST(dense_lu_growth) {
    int level, i, j;
    for (level = 0; level < YCI_LEVELS; level++) {
        const yci_kernels *kernels = yci_kernels_of(level);
        uint64_t seed = 1;
        lu_system s;
        if (!kernels) continue;
        lu_open(&s, 41, 1, kernels, &seed);
        CHECK(yc_lu_growth(s.lu) == 0.0 && yc_lu_growth(NULL) == 0.0);
        for (i = 0; i < s.n; i++)
            for (j = 0; j < s.n; j++) s.a[i * s.lda + j] = i == j || j == s.n - 1 ? 1.0 : i > j ? -0.5 : 0.0;
        CHECK_RESULT(yc_lu_factor(s.lu, s.a, s.lda), YC_OK);
        CHECK_NEAR(yc_lu_growth(s.lu), pow(1.5, s.n - 1), 1e-6);
        lu_close(&s);
    }
}

/* Ranks that are exact in floating point: the column without a pivot is named; the next factorisation works again. */
TEST(dense_lu_singular) {
    int level, rank, i, j;
    for (level = 0; level < YCI_LEVELS; level++)
        for (rank = 0; rank < 75; rank += 1 + rank / 3) {
            const yci_kernels *kernels = yci_kernels_of(level);
            uint64_t seed = 1;
            char words[32];
            lu_system s;
            if (!kernels) continue;
            lu_open(&s, 75, 1, kernels, &seed);
            snprintf(words, sizeof words, "column %d ", rank);
            for (i = 0; i < s.n; i++)
                for (j = 0; j < s.n; j++)
                    s.a[i * s.lda + j] = j < rank && i == (7 * j + 3) % s.n ? 2.0 : j >= rank && i == 3 ? 1.0 : 0.0;
            if (!rank) s.a[3 * s.lda] = 0.0;
            CHECK(yc_lu_factor(s.lu, s.a, s.lda) == YC_ERROR_SINGULAR && strstr(yc_lu_message(s.lu), words));
            CHECK(yc_lu_solve(s.lu, s.x, 1, s.ldx) == YC_ERROR_ARGUMENT && yc_lu_rcond(s.lu) == 0.0);
            for (j = 0; j < s.n; j++) s.a[(7 * j + 3) % s.n * s.lda + j] = 2.0;
            CHECK_RESULT(yc_lu_factor(s.lu, s.a, s.lda), YC_OK);
            CHECK(lu_error(&s, 0) < 4e-16);
            lu_close(&s);
        }
}

/* An entry that is not finite anywhere leaves the previous factor; sums that overflow are no reason to refuse. */
TEST(dense_lu_finite) {
    static const double bad[] = {NAN, INFINITY, -INFINITY};
    uint64_t seed = 8;
    lu_system s;
    double keep[50];
    int i, k;
    lu_open(&s, 50, 1, NULL, &seed);
    CHECK_RESULT(yc_lu_factor(s.lu, s.a, s.lda), YC_OK);
    CHECK(lu_error(&s, 0) < 4e-16);
    memcpy(keep, s.x, sizeof keep);
    for (k = 0; k < 150; k++) {
        char words[32];
        int row = k * 7 % s.n, column = k * 11 % s.n;
        double *at = s.a + row * s.lda + column, was = *at;
        *at = bad[k % 3];
        snprintf(words, sizeof words, "a[%d][%d]", row, column);
        CHECK(yc_lu_factor(s.lu, s.a, s.lda) == YC_ERROR_ARGUMENT && strstr(yc_lu_message(s.lu), words));
        *at = was;
    }
    memcpy(s.x, s.b, sizeof keep);
    CHECK_RESULT(yc_lu_solve(s.lu, s.x, 1, s.ldx), YC_OK);
    CHECK(memcmp(keep, s.x, sizeof keep) == 0);
    for (i = 0; i < s.n; i++) s.a[i * s.lda + i] = 1e308, s.a[i * s.lda] = i ? 1e307 : 1e308;
    CHECK_RESULT(yc_lu_factor(s.lu, s.a, s.lda), YC_OK);
    lu_close(&s);
}

/* The same bits for any number of workers. */
TEST(dense_lu_workers) {
    int workers;
    double *first = NULL;
    for (workers = 0; workers < 4; workers++) {
        yc_host host = test_host_threads(workers);
        uint64_t seed = 4;
        lu_system s;
        lu_open(&s, 301, 0, NULL, &seed);
        yc_lu_destroy(s.lu);
        CHECK_RESULT(yc_lu_create(&host, s.n, &s.lu), YC_OK);
        CHECK_RESULT(yc_lu_factor(s.lu, s.a, s.lda), YC_OK);
        if (!first) {
            first = (double *)malloc((size_t)s.n * s.lu->ld * sizeof(double));
            memcpy(first, s.lu->f, (size_t)s.n * s.lu->ld * sizeof(double));
        }
        CHECK(memcmp(first, s.lu->f, (size_t)s.n * s.lu->ld * sizeof(double)) == 0);
        lu_close(&s);
    }
    free(first);
}

TEST(dense_lu_errors) {
    yc_lu *lu = NULL;
    double a[9] = {1, 2, 3, 2, 4, 6, 1, 0, 1}, x[3] = {1, 2, 3};
    CHECK(yc_lu_create(NULL, -1, &lu) == YC_ERROR_ARGUMENT && lu == NULL);
    CHECK_RESULT(yc_lu_create(NULL, 3, &lu), YC_OK);
    CHECK(yc_lu_solve(lu, x, 1, 3) == YC_ERROR_ARGUMENT && x[2] == 3);
    CHECK(yc_lu_factor(lu, a, 3) == YC_ERROR_SINGULAR && strstr(yc_lu_message(lu), "column 2"));
    CHECK(yc_lu_solve(lu, x, 1, 3) == YC_ERROR_ARGUMENT && yc_lu_rcond(lu) == 0.0);
    CHECK(yc_lu_factor(lu, a, 2) == YC_ERROR_ARGUMENT && yc_lu_factor(lu, NULL, 3) == YC_ERROR_ARGUMENT);
    a[4] = 5;
    CHECK_RESULT(yc_lu_factor(lu, a, 3), YC_OK);
    a[5] = NAN;
    CHECK(yc_lu_factor(lu, a, 3) == YC_ERROR_ARGUMENT && strstr(yc_lu_message(lu), "a[1][2]"));
    CHECK_RESULT(yc_lu_solve(lu, x, 1, 3), YC_OK); /* the earlier factor is still there */
    CHECK(yc_lu_solve(lu, x, 1, 2) == YC_ERROR_ARGUMENT && yc_lu_solve(lu, x, -1, 3) == YC_ERROR_ARGUMENT);
    yc_lu_destroy(lu);
    yc_lu_destroy(NULL);
    CHECK(yc_lu_factor(NULL, a, 3) == YC_ERROR_ARGUMENT && yc_lu_solve(NULL, x, 1, 3) == YC_ERROR_ARGUMENT);
    CHECK(yc_lu_rcond(NULL) == 0.0 && yc_lu_growth(NULL) == 0.0 && strstr(yc_lu_message(NULL), "NULL"));
}

/* The estimate against the condition of small Hilbert matrices and of the inverse itself. */
TEST(dense_lu_rcond) {
    int n, i, j;
    for (n = 1; n <= 8; n++) {
        double a[64], x[64], norm = 0.0, inverse = 0.0, exact, estimate;
        yc_lu *lu = NULL;
        for (i = 0; i < n * n; i++) a[i] = 1.0 / (i / n + i % n + 1);
        for (i = 0; i < n * n; i++) x[i] = i / n == i % n;
        CHECK(yc_lu_create(NULL, n, &lu) == YC_OK && yc_lu_factor(lu, a, n) == YC_OK);
        CHECK_RESULT(yc_lu_solve(lu, x, n, n), YC_OK);
        for (j = 0; j < n; j++) {
            double sum = 0.0, other = 0.0;
            for (i = 0; i < n; i++) sum += fabs(a[i * n + j]), other += fabs(x[j * n + i]);
            norm = yci_max(norm, sum), inverse = yci_max(inverse, other);
        }
        exact = 1.0 / (norm * inverse), estimate = yc_lu_rcond(lu);
        CHECK(estimate >= exact * (1.0 - 1e-6) && estimate <= 3.0 * exact);
        yc_lu_destroy(lu);
    }
}

/* A factorisation that overflowed leaves nothing behind for the next one. */
TEST(dense_lu_after_overflow) {
    int n, i, level;
    for (n = 17; n <= 24; n++)
        for (level = 0; level < YCI_LEVELS; level++) {
            double a[24 * 24] = {0.0}, x[24];
            yc_lu *lu = NULL;
            if (!yci_kernels_of(level) || !CHECK_RESULT(yc_lu_create(NULL, n, &lu), YC_OK)) continue;
            lu->kernels = yci_kernels_of(level);
            for (i = 0; i < n; i++) a[i * n + i] = 1.0;
            a[n - 2] = a[n + n - 2] = 1.7e308, a[n] = -1.0;
            yc_lu_factor(lu, a, n);
            a[n - 2] = a[n + n - 2] = 0.5;
            CHECK_RESULT(yc_lu_factor(lu, a, n), YC_OK);
            for (i = 0; i < n; i++) x[i] = 1.0;
            CHECK_RESULT(yc_lu_solve(lu, x, 1, n), YC_OK);
            CHECK_NEAR(x[0], 0.5, 1e-15); /* x[n - 2] is 1 */
            CHECK(yc_lu_rcond(lu) > 0.01);
            yc_lu_destroy(lu);
        }
}

TEST(dense_blocks) {
    uint64_t seed = 5;
    int n, trial, i, j, k;
    for (n = 1; n <= YCI_BLOCK_MAX; n++)
        for (trial = 0; trial < 20; trial++) {
            double a[64], inverse[64], worst = 0.0;
            for (i = 0; i < n; i++)
                for (j = 0; j <= i; j++) a[i * n + j] = a[j * n + i] = test_random(&seed, -1.0, 1.0);
            CHECK(yci_block_invert(n, a, a, inverse) > 0.0);
            for (i = 0; i < n; i++)
                for (j = 0; j < n; j++) {
                    double sum = i == j ? -1.0 : 0.0;
                    for (k = 0; k < n; k++) sum += a[i * n + k] * inverse[k * n + j];
                    worst = yci_max(worst, fabs(sum));
                }
            CHECK(worst < 1e-8);
            for (i = 0; i < n; i++) a[i * n + i] += n;
            CHECK(yci_block_invert_spd(n, a, a, n + 1, inverse));
            a[0] = -1.0;
            CHECK(!yci_block_invert_spd(n, a, a, n + 1, inverse));
        }
    { /* badly scaled pairs are regular, cancelled blocks and NaN are not */
        double pair[4] = {0, 1e-6, 1e-6, -1e6}, inverse[4], one = 4.0, lost = 2e-16;
        CHECK(yci_block_invert(2, pair, pair, inverse) > 0.1);
        CHECK(fabs(inverse[0] * 1e-18 - 1.0) < 1e-12 && fabs(inverse[1] * 1e-6 - 1.0) < 1e-12);
        CHECK(fabs(inverse[3]) < 1e-3);
        CHECK(yci_block_invert(1, &lost, &one, inverse) == 0.0 && !yci_block_invert_spd(1, &lost, &one, 1, inverse));
        pair[1] = pair[2] = NAN;
        CHECK(yci_block_invert(2, pair, pair, inverse) == 0.0);
        memset(pair, 0, sizeof pair);
        CHECK(yci_block_invert(2, pair, pair, inverse) == 0.0);
    }
}

/* ---- sparse ------------------------------------------------------------------------------------------------------ */

typedef struct linear_system {
    yci_context c;
    yci_bsr m;
    double *dense; /* off[n] x off[n] */
} linear_system;

static void system_open(
    linear_system *s, const yc_host *host, int n, const int *dim, const int (*pair)[2], size_t pairs) {
    CHECK_RESULT(yci_context_init(&s->c, host), YC_OK);
    CHECK_RESULT(yci_bsr_create(&s->c, n, dim, pair, pairs, &s->m), YC_OK);
    s->dense = NULL;
}

/* Random symmetric values; kind 1 makes them positive definite by dominance, kind 2 quasi-definite: every second
 * unknown gets a negative diagonal. */
static void system_fill(linear_system *s, int kind, uint64_t seed) {
    yci_bsr *m = &s->m;
    int i, k, a, b, size = m->off[m->n];
    for (i = 0; i < m->n; i++)
        for (k = m->ptr[i]; k < m->ptr[i + 1]; k++) {
            int j = m->col[k], mirror = yci_bsr_find(m, j, i);
            CHECK(mirror >= 0);
            for (a = 0; j <= i && a < m->dim[i]; a++)
                for (b = 0; b < m->dim[j]; b++)
                    m->val[m->at[k] + (size_t)(a * m->dim[j] + b)] =
                        m->val[m->at[mirror] + (size_t)(b * m->dim[i] + a)] = test_random(&seed, -1.0, 1.0);
        }
    free(s->dense);
    s->dense = (double *)calloc((size_t)size * (size_t)size + 1, sizeof(double));
    for (i = 0; i < m->n; i++) {
        for (a = 0; a < m->dim[i]; a++) {
            double sum = 0.0, *diagonal = &m->val[m->at[m->diag[i]] + (size_t)(a * m->dim[i] + a)];
            for (k = m->ptr[i]; k < m->ptr[i + 1]; k++)
                for (b = 0; b < m->dim[m->col[k]]; b++)
                    sum += fabs(m->val[m->at[k] + (size_t)(a * m->dim[m->col[k]] + b)]);
            *diagonal = (kind == 2 && (m->off[i] + a) % 2) ? -sum - 0.5 : sum + 0.5;
        }
        for (k = m->ptr[i]; k < m->ptr[i + 1]; k++)
            for (a = 0; a < m->dim[i]; a++)
                for (b = 0; b < m->dim[m->col[k]]; b++)
                    s->dense[(m->off[i] + a) * size + m->off[m->col[k]] + b] =
                        m->val[m->at[k] + (size_t)(a * m->dim[m->col[k]] + b)];
    }
}

static void system_close(linear_system *s) {
    yci_bsr_zero(&s->m);
    CHECK(s->m.ptr[s->m.n] == 0 || s->m.val[s->m.at[s->m.diag[0]]] == 0.0 || s->m.dim[0] == 0);
    yci_bsr_destroy(&s->c, &s->m);
    CHECK(s->c.bytes == 0);
    free(s->dense);
}

/* Product, direct solve of three right-hand sides and their like from dense LU. */
static void system_compare(linear_system *s, const int *order, int spd) {
    const yci_bsr *m = &s->m;
    int size = m->off[m->n], i, j, k, level;
    double *x = (double *)calloc(3 * (size_t)(size + 1), sizeof(double));
    double *z = (double *)malloc(3 * (size_t)(size + 1) * sizeof(double));
    double *y = (double *)malloc(3 * (size_t)(size + 1) * sizeof(double)), *work, worst = 0.0, largest = 0.0;
    uint64_t seed = 99;
    yci_ldl *f = NULL;
    yc_lu *lu = NULL;
    for (i = 0; i < 3 * (size + 1); i++) x[i] = test_random(&seed, -1.0, 1.0);
    yci_bsr_multiply(&s->c, m, x, y);
    for (i = 0; i < size; i++) {
        double sum = 0.0;
        for (j = 0; j < size; j++) sum += s->dense[i * size + j] * x[j];
        worst = yci_max(worst, fabs(sum - y[i]));
    }
    CHECK(worst < 1e-11);
    memcpy(y, x, 3 * (size_t)(size + 1) * sizeof(double));
    CHECK(yc_lu_create(NULL, size, &lu) == YC_OK && yc_lu_factor(lu, s->dense, size) == YC_OK);
    CHECK_RESULT(yc_lu_solve(lu, y, 3, size + 1), YC_OK);
    CHECK_RESULT(yci_ldl_analyze_bsr(&s->c, m, order, spd, &f), YC_OK);
    work = (double *)malloc((yci_ldl_work(f, 3) + 1) * sizeof(double));
    for (level = 0; level < YCI_LEVELS; level++) { /* every set of kernels that this machine has, one to five sides */
        int count = 1 + (level + size) % 3;
        if (!(f->kernels = yci_kernels_of(level))) continue;
        CHECK_RESULT(yci_ldl_factor(f, m->val), YC_OK);
        CHECK_RESULT(yci_ldl_factor(f, m->val), YC_OK);
        memcpy(z, x, 3 * (size_t)(size + 1) * sizeof(double));
        yci_ldl_solve(f, z, count, size + 1, work);
        for (k = 0, worst = largest = 0.0; k < count; k++)
            for (i = 0; i < size; i++) {
                worst = yci_max(worst, fabs(z[k * (size + 1) + i] - y[k * (size + 1) + i]));
                largest = yci_max(largest, fabs(y[k * (size + 1) + i]));
            }
        CHECK(worst <= 1e-10 * largest);
    }
    yc_lu_destroy(lu);
    yci_ldl_destroy(f);
    free(x), free(y), free(z), free(work);
}

/* Pairs of a named graph; returns how many. */
static size_t graph(int kind, int n, int (*pair)[2], uint64_t *seed) {
    size_t count = 0;
    int i, j, w = (int)sqrt((double)n);
    for (i = 0; i < n; i++) switch (kind) {
        case 0: /* arrow, hub first, written both ways */
            pair[count][0] = 0, pair[count++][1] = i, pair[count][0] = i, pair[count++][1] = 0;
            break;
        case 1: /* dense */
            for (j = 0; j < i; j++) pair[count][0] = j, pair[count++][1] = i;
            break;
        case 2: /* two random parts without a link, and lone nodes at the end */
            for (j = 0; j < 3; j++) {
                int half = n * 4 / 10;
                if (i >= 2 * half) break;
                pair[count][0] = i;
                pair[count++][1] = test_random_int(seed, half) + (i < half ? 0 : half);
            }
            break;
        case 3: /* chain */
            if (i) pair[count][0] = i, pair[count++][1] = i - 1;
            break;
        default: /* grid with one diagonal */
            if (i % w) pair[count][0] = i, pair[count++][1] = i - 1;
            if (i >= w) pair[count][0] = i - w, pair[count++][1] = i;
            if (i >= w && i % w) pair[count][0] = i, pair[count++][1] = i - w - 1;
        }
    return count;
}

TEST(sparse_direct) {
    static const int sizes[] = {0, 1, 2, 7, 40, 100};
    static int pair[10000][2], dim[100], order[100];
    uint64_t seed = 3;
    size_t which;
    int kind, dims, i;
    for (which = 0; which < sizeof sizes / sizeof sizes[0]; which++)
        for (kind = 0; kind < 5; kind++)
            for (dims = 0; dims < 5; dims++) {
                linear_system s;
                int n = sizes[which], quasi;
                size_t pairs = graph(kind, n, pair, &seed);
                for (i = 0; i < n; i++) {
                    static const int five[] = {0, 3, 5, 1, 8};
                    dim[i] = dims == 0 ? 1
                        : dims == 1    ? 3
                        : dims == 2    ? 3 + 2 * (i % 2)
                        : dims == 3    ? 3 * (i % 2)
                                       : five[test_random_int(&seed, 5)];
                    order[i] = n - 1 - i;
                }
                system_open(&s, NULL, n, dim, (const int(*)[2])pair, pairs);
                for (quasi = 1; quasi <= 2; quasi++) {
                    system_fill(&s, quasi, seed++);
                    system_compare(&s, quasi == 1 ? NULL : order, quasi == 1);
                    system_compare(&s, NULL, 0);
                }
                system_close(&s);
            }
}

/* A larger grid has several panels, merged supernodes and deep stacks of update matrices; its residual is the judge. */
TEST(sparse_grid) {
    enum { N = 900 };
    static int pair[3 * N][2], dim[N];
    uint64_t seed = 8;
    linear_system s;
    yci_ldl *f = NULL, *g = NULL;
    yc_host host = test_host_counting(), reversed = test_host_threads(0);
    int i, size;
    double *x, *y, *z, *work, worst = 0.0;
    size_t pairs = graph(4, N, pair, &seed);
    for (i = 0; i < N; i++) dim[i] = 3 + 2 * (i % 3 == 0);
    system_open(&s, &host, N, dim, (const int(*)[2])pair, pairs);
    system_fill(&s, 1, 4);
    size = s.m.off[N];
    x = (double *)malloc((size_t)size * sizeof(double)), y = (double *)malloc((size_t)size * sizeof(double));
    z = (double *)malloc((size_t)size * sizeof(double));
    CHECK_RESULT(yci_ldl_analyze_bsr(&s.c, &s.m, NULL, 1, &f), YC_OK);
    CHECK_RESULT(yci_ldl_factor(f, s.m.val), YC_OK);
    i = test_heap.calls;
    CHECK_RESULT(yci_ldl_factor(f, s.m.val), YC_OK); /* the first one makes room for L, the others need none */
    CHECK(test_heap.calls == i);
    work = (double *)malloc(yci_ldl_work(f, 1) * sizeof(double));
    for (i = 0; i < size; i++) z[i] = y[i] = test_random(&seed, -1.0, 1.0);
    yci_ldl_solve(f, y, 1, size, work);
    yci_bsr_multiply(&s.c, &s.m, y, x);
    for (i = 0; i < size; i++) worst = yci_max(worst, fabs(x[i] - z[i]));
    CHECK(worst < 1e-12);
    /* Blocks of the parallel loops in reverse order give the same bits. */
    s.c.host = reversed;
    CHECK_RESULT(yci_ldl_analyze_bsr(&s.c, &s.m, NULL, 1, &g), YC_OK);
    CHECK_RESULT(yci_ldl_factor(g, s.m.val), YC_OK);
    yci_ldl_solve(g, z, 1, size, work);
    CHECK(memcmp(y, z, (size_t)size * sizeof(double)) == 0);
    yci_ldl_destroy(f), yci_ldl_destroy(g);
    system_close(&s);
    CHECK(test_heap.live == 0);
    free(x), free(y), free(z), free(work);
}

/* Pairs (z, lambda) per node of the mixing constraint with a mass of zero: [[M G],[G -K]] by nodes, M = 0. */
TEST(sparse_pairs) {
    enum { N = 60, D = 6 };
    static int pair[3 * N][2], dim[N];
    uint64_t seed = 8;
    linear_system s;
    size_t pairs = graph(4, N, pair, &seed);
    int i, k, a, b, part;
    for (i = 0; i < N; i++) dim[i] = D;
    system_open(&s, NULL, N, dim, (const int(*)[2])pair, pairs);
    for (part = 0; part < 2; part++) { /* with some masses, and with none at all */
        system_fill(&s, 1, 21);
        for (i = 0; i < N; i++)
            for (k = s.m.ptr[i]; k < s.m.ptr[i + 1]; k++)
                for (a = 0; a < D; a++)
                    for (b = 0; b < D; b++) {
                        double *v = &s.m.val[s.m.at[k] + (size_t)(a * D + b)];
                        int size = s.m.off[N], same = a % 3 == b % 3, j = s.m.col[k];
                        double coupling = i == j ? 4.0 : -0.5;
                        if (a < 3 && b < 3) *v = part == 0 && i == j && same && i % 2 ? 2.0 : 0.0;
                        else if (a >= 3 && b >= 3) *v = same ? -1e3 * coupling : 0.0;
                        else *v = same ? 1e-2 * coupling : 0.0;
                        s.dense[(s.m.off[i] + a) * size + s.m.off[j] + b] = *v;
                    }
        system_compare(&s, NULL, 0);
    }
    system_close(&s);
}

TEST(sparse_refusals) {
    enum { N = 30 };
    static int pair[3 * N][2], dim[N];
    uint64_t seed = 8;
    int i, k, bad[1][2] = {{0, N}};
    linear_system s;
    yci_bsr none;
    yci_ldl *f = NULL, *g = NULL;
    size_t pairs = graph(3, N, pair, &seed);
    for (i = 0; i < N; i++) dim[i] = 1;
    system_open(&s, NULL, N, dim, (const int(*)[2])pair, pairs);
    CHECK_RESULT(yci_bsr_create(&s.c, N, dim, (const int(*)[2])bad, 1, &none), YC_ERROR_ARGUMENT);
    dim[3] = YCI_BLOCK_MAX + 1;
    CHECK(yci_bsr_create(&s.c, N, dim, (const int(*)[2])pair, pairs, &none) == YC_ERROR_ARGUMENT && none.val == NULL);
    dim[3] = 1;
    CHECK(yci_ldl_analyze_bsr(&s.c, &s.m, dim, 1, &f) == YC_ERROR_ARGUMENT && !f); /* 1, 1, ... */
    CHECK_RESULT(yci_ldl_analyze_bsr(&s.c, &s.m, NULL, 1, &f), YC_OK);
    CHECK_RESULT(yci_ldl_analyze_bsr(&s.c, &s.m, NULL, 0, &g), YC_OK);
    system_fill(&s, 2, 5);
    CHECK(yci_ldl_factor(f, s.m.val) == YC_ERROR_NOT_SPD && !f->factored);
    CHECK(yci_ldl_factor(g, s.m.val) == YC_OK && g->factored);
    for (i = 0; i < N; i++) /* a free chain: the Laplacian has a null vector */
        for (k = s.m.ptr[i]; k < s.m.ptr[i + 1]; k++)
            s.m.val[s.m.at[k]] = s.m.col[k] != i ? -1.0 : s.m.ptr[i + 1] - s.m.ptr[i] - 1;
    CHECK_RESULT(yci_ldl_factor(f, s.m.val), YC_ERROR_NOT_SPD);
    CHECK(yci_ldl_factor(g, s.m.val) == YC_ERROR_SINGULAR && strstr(s.c.message, "unknown"));
    s.m.val[s.m.at[s.m.diag[4]]] += 1.0;
    CHECK_RESULT(yci_ldl_factor(f, s.m.val), YC_OK);
    s.m.val[s.m.at[s.m.diag[7]] + 1] = NAN, s.m.val[s.m.at[s.m.diag[8]] - 1] = NAN; /* one entry and its mirror */
    CHECK_RESULT(yci_ldl_factor(f, s.m.val), YC_ERROR_NOT_SPD);
    CHECK_RESULT(yci_ldl_factor(g, s.m.val), YC_ERROR_SINGULAR);
    yci_ldl_destroy(f), yci_ldl_destroy(g);
    yci_ldl_destroy(NULL);
    system_close(&s);
}

/* A large grid with its nodes in random order, which the analysis renumbers. */
TEST(sparse_far) {
    enum { SIDE = 202, N = SIDE * SIDE };
    static int pair[3 * N][2], dim[N], name[N];
    static double x[2 * N], y[2 * N];
    uint64_t seed = 9;
    linear_system s;
    yci_ldl *f = NULL;
    double *work, worst = 0.0;
    int i, k, size;
    size_t p, q, pairs = graph(4, N, pair, &seed);
    for (i = 0; i < N; i++) name[i] = i, dim[i] = 1 + i % 2;
    for (i = N - 1; i > 0; i--) k = test_random_int(&seed, i + 1), size = name[i], name[i] = name[k], name[k] = size;
    for (p = 0; p < pairs; p++) pair[p][0] = name[pair[p][0]], pair[p][1] = name[pair[p][1]];
    system_open(&s, NULL, N, dim, (const int(*)[2])pair, pairs);
    size = s.m.off[N];
    for (i = 0; i < N; i++)
        for (k = s.m.ptr[i]; k < s.m.ptr[i + 1]; k++)
            for (p = s.m.at[k], q = s.m.at[k + 1]; p < q; p++)
                s.m.val[p] = i != s.m.col[k] ? -0.1 * (1 + (i + s.m.col[k]) % 5) : (q - p) % 3 == 1 ? 8.0 : 1.0;
    for (i = 0; i < size; i++) x[i] = test_random(&seed, -1.0, 1.0);
    yci_bsr_multiply(&s.c, &s.m, x, y);
    CHECK_RESULT(yci_ldl_analyze_bsr(&s.c, &s.m, NULL, 1, &f), YC_OK);
    CHECK_RESULT(yci_ldl_factor(f, s.m.val), YC_OK);
    work = (double *)malloc((yci_ldl_work(f, 1) + 1) * sizeof(double));
    yci_ldl_solve(f, y, 1, size, work);
    for (i = 0; i < size; i++) worst = yci_max(worst, fabs(x[i] - y[i]));
    CHECK(worst < 1e-10);
    yci_ldl_destroy(f);
    system_close(&s);
    free(work);
}

/* ---- ordering ---------------------------------------------------------------------------------------------------- */

enum { ORDER_MOST = 50000 };
typedef struct order_result {
    int order[ORDER_MOST], size[ORDER_MOST], below[ORDER_MOST], parent[ORDER_MOST];
    yci_order_fronts fronts;
    double nonzeros;
} order_result;

/* Orders a matrix: kind 0 by minimum degree, 1 by dissection, 2 by what is chosen; a permutation must come out. */
static void order_run(linear_system *s, int kind, const int *stage, order_result *r) {
    static int seen[ORDER_MOST];
    const yci_bsr *m = &s->m;
    int *room = (int *)malloc(yci_order_room(m->n, m->ptr) * sizeof(int)),
        *trial = (int *)malloc(4 * ((size_t)m->n + 1) * sizeof(int)), i, total = 0;
    r->fronts.size = r->size, r->fronts.below = r->below, r->fronts.parent = r->parent;
    if (kind == 0) yci_order_minimum_degree(m->n, m->dim, m->ptr, m->col, stage, r->order, &r->fronts, room);
    else if (kind == 1) yci_order_dissect(m->n, m->dim, m->ptr, m->col, r->order, &r->fronts, room);
    else yci_order_auto(m->n, m->dim, m->ptr, m->col, r->order, &r->fronts, room, trial);
    free(room), free(trial);
    for (i = 0; i < m->n; i++) seen[i] = 0;
    for (i = 0; i < m->n; i++) seen[r->order[i]]++;
    for (i = 0; i < m->n; i++) CHECK(seen[i] == 1);
    for (i = 0, r->nonzeros = 0.0; i < r->fronts.count; i++) {
        total += r->size[i], r->nonzeros += r->size[i] * (r->below[i] + 0.5 * (r->size[i] + 1.0));
        CHECK(r->parent[i] < 0 || (r->parent[i] > i && r->below[i] > 0));
    }
    CHECK(
        !r->fronts.known || total + (m->n && !m->dim[0]) * (m->n + 1) / 2 == m->n); /* every second without unknowns */
}

/* Permutations on graphs of all kinds; stages are kept; fill on a grid is that of a minimum-degree method, and the
 * fronts are those that the analysis finds from the order alone. */
TEST(sparse_order) {
    enum { N = 2500 };
    static int pair[4 * N][2], dim[N], stage[N];
    static order_result r;
    uint64_t seed = 1;
    int trial, kind, i;
    for (trial = 0; trial < 20; trial++) {
        linear_system s;
        yci_ldl *f = NULL, *g = NULL;
        int graph_kind = trial % 5 == 1 ? 3 : trial % 5, dims = trial / 5;
        size_t pairs = graph(graph_kind, N, pair, &seed);
        for (i = 0; i < N; i++) {
            dim[i] = dims == 0 ? 1 : dims == 1 ? i % 2 : dims == 2 ? 3 : 1 + i % 8;
            stage[i] = test_random_int(&seed, trial % 3 ? 5 : N);
        }
        system_open(&s, NULL, N, dim, (const int(*)[2])pair, pairs);
        for (kind = 0; kind < 3; kind++) {
            order_run(&s, kind, NULL, &r);
            if (graph_kind == 4 && dims % 2 == 0) CHECK(r.nonzeros < 30.0 * N);
            if (graph_kind == 3 && dims % 2 == 0) CHECK(r.nonzeros < 3.0 * N);
            CHECK(r.fronts.known == (dims == 1 || (dims < 3 && graph_kind))); /* an arrow's hub is left out */
        }
        CHECK_RESULT(yci_ldl_analyze_bsr(&s.c, &s.m, r.order, 1, &f), YC_OK);
        CHECK_RESULT(yci_ldl_analyze_bsr(&s.c, &s.m, NULL, 1, &g), YC_OK);
        /* The fronts are the same; which children are taken in first, and so the padding, is not. */
        CHECK(fabs(f->nonzeros - g->nonzeros) <= 0.05 * g->nonzeros && fabs(f->flops - g->flops) <= 0.1 * g->flops);
        yci_ldl_destroy(f), yci_ldl_destroy(g);
        order_run(&s, 0, stage, &r);
        for (i = 1; i < N; i++) CHECK(stage[r.order[i]] >= stage[r.order[i - 1]]);
        system_close(&s);
    }
}

/* Entries of L, without its diagonal, under the true minimum degree in every step. */
static int minimum_fill(const yci_bsr *m) {
    enum { MOST = 400 };
    static char edge[MOST][MOST];
    int n = m->n, step, i, j, k, total = 0;
    memset(edge, 0, sizeof edge);
    for (i = 0; i < n; i++)
        for (k = m->ptr[i]; k < m->ptr[i + 1]; k++) edge[i][m->col[k]] = 1;
    for (step = 0; step < n; step++) {
        int best = -1, least = n + 1;
        for (i = 0; i < n; i++) {
            int degree = 0;
            for (j = 0; j < n && edge[i][i]; j++) degree += edge[i][j];
            if (edge[i][i] && degree < least) best = i, least = degree;
        }
        total += least - 1;
        for (i = 0; i < n; i++)
            for (j = 0; j < n && edge[best][i]; j++) edge[i][j] |= edge[best][j];
        for (i = 0; i < n; i++) edge[i][best] = edge[best][i] = 0;
    }
    return total;
}

TEST(sparse_order_fill) {
    enum { N = 400, SIDE = 100, LARGE = SIDE * SIDE };
    static int pair[4 * LARGE][2], dim[LARGE], again[LARGE];
    static order_result r;
    uint64_t seed = 5;
    linear_system s;
    int kind, i;
    size_t pairs;
    for (i = 0; i < LARGE; i++) dim[i] = 1;
    for (kind = 2; kind <= 4; kind += 2) { /* two random parts, a grid */
        pairs = graph(kind, kind == 2 ? 200 : N, pair, &seed);
        system_open(&s, NULL, kind == 2 ? 200 : N, dim, (const int(*)[2])pair, pairs);
        order_run(&s, 0, NULL, &r);
        CHECK(r.nonzeros - s.m.n < 1.1 * minimum_fill(&s.m));
        system_close(&s);
    }
    /* Dissection of a square grid, against what George (1973) and Hoffman, Martin and Rose (1973) give for nine points:
     * 31/4 k^2 log2 k entries and 829/84 k^3 multiplications, of which a squared column count has two. */
    pairs = graph(4, LARGE, pair, &seed);
    system_open(&s, NULL, LARGE, dim, (const int(*)[2])pair, pairs);
    order_run(&s, 1, NULL, &r);
    CHECK(r.nonzeros < 31.0 / 4.0 * LARGE * log((double)SIDE) / log(2.0));
    CHECK(r.fronts.flops < 2.0 * 829.0 / 84.0 * SIDE * LARGE);
    memcpy(again, r.order, sizeof again);
    order_run(&s, 1, NULL, &r);
    CHECK(memcmp(again, r.order, sizeof again) == 0);
    system_close(&s);
}

/* Graphs that make a careless method quadratic: a star, hubs of middling degree, a chain, a chain of cliques. They have
 * no fill worth mentioning; a quadratic method would take minutes here. */
TEST(sparse_order_extremes) {
    enum { N = ORDER_MOST };
    static int pair[5 * N][2], dim[N];
    static order_result r;
    int which, kind, i, j;
    for (i = 0; i < N; i++) dim[i] = 1;
    for (which = 0; which < 4; which++) {
        linear_system s;
        size_t pairs = 0;
        for (i = 1; i < N; i++)
            for (j = 1; j <= (which == 3 ? 4 : 1); j++) {
                int other = which == 0 ? 0 : which == 1 ? i - i % 1000 : i - j;
                if (which == 1 && other == i) other = i - 1000;
                if (other >= 0 && (which != 3 || other / 5 == i / 5 || i % 5 == 0))
                    pair[pairs][0] = i, pair[pairs++][1] = other;
            }
        system_open(&s, NULL, N, dim, (const int(*)[2])pair, pairs);
        for (kind = 0; kind < 3; kind++) {
            order_run(&s, kind, NULL, &r);
            CHECK(r.nonzeros < 8.0 * N && r.fronts.flops < 50.0 * N);
        }
        system_close(&s);
    }
}

/* ---- incomplete -------------------------------------------------------------------------------------------------- */

static const yci_ic_extent everything = {0, NULL};

/* Iterations of conjugate gradients on m from 0 to a residual of 1e-8 of the first. */
static int iterations(yci_context *c, const yci_bsr *m, const yci_ic *f) {
    int size = m->off[m->n], i, k;
    double *x = (double *)calloc(5 * (size_t)size, sizeof(double)), *r = x + size, *z = r + size;
    double *p = z + size, *q = p + size;
    double rho = 0.0, first = 0.0;
    uint64_t seed = 77;
    for (i = 0; i < size; i++) r[i] = test_random(&seed, -1.0, 1.0);
    for (k = 0; k < 1000; k++) {
        double norm = 0.0, next = 0.0, pq = 0.0;
        for (i = 0; i < size; i++) norm += r[i] * r[i];
        if (k == 0) first = norm;
        if (norm <= 1e-16 * first) break;
        memcpy(z, r, (size_t)size * sizeof(double));
        if (f) yci_ic_solve(f, z);
        for (i = 0; i < size; i++) next += r[i] * z[i];
        for (i = 0; i < size; i++) p[i] = z[i] + (k ? next / rho : 0.0) * p[i];
        rho = next;
        yci_bsr_multiply(c, m, p, q);
        for (i = 0; i < size; i++) pq += p[i] * q[i];
        for (i = 0; i < size; i++) x[i] += rho / pq * p[i], r[i] -= rho / pq * q[i];
    }
    free(x);
    return k;
}

/* Grid Laplacian, each dimension coupled a little to the others, pinned weakly. */
static void grid_values(yci_bsr *m) {
    int i, k, a, b;
    for (i = 0; i < m->n; i++)
        for (k = m->ptr[i]; k < m->ptr[i + 1]; k++)
            for (a = 0; a < m->dim[i]; a++)
                for (b = 0; b < m->dim[m->col[k]]; b++)
                    m->val[m->at[k] + (size_t)(a * m->dim[m->col[k]] + b)] =
                        (a == b ? 1.0 : 0.2) * (m->col[k] == i ? m->ptr[i + 1] - m->ptr[i] - 1 + 1e-3 : -1.0);
}

TEST(sparse_incomplete) {
    enum { N = 400 };
    static int pair[3 * N][2], dim[N], order[N];
    uint64_t seed = 8;
    linear_system s;
    yci_ic *f = NULL;
    size_t pairs = graph(4, N, pair, &seed);
    int i, k, plain, better;
    for (i = 0; i < N; i++) dim[i] = 3, order[i] = i;
    system_open(&s, NULL, N, dim, (const int(*)[2])pair, pairs);
    grid_values(&s.m);
    CHECK(yci_ic_create(&s.c, &s.m, order, N, &everything, &f) == YC_OK && yci_ic_factor(f, &s.m) == YC_OK &&
        f->shift == 0.0);
    plain = iterations(&s.c, &s.m, NULL), better = iterations(&s.c, &s.m, f);
    CHECK(better * 2 < plain && better > 1);
    /* Stronger coupling makes the matrix indefinite: the diagonal is raised, or everything else given up. */
    for (k = 0; k < 2; k++) {
        for (i = 0; i < s.m.ptr[N]; i++) {
            int a, own = 0;
            for (a = 0; a < N; a++) own |= s.m.diag[a] == i;
            for (a = 0; !own && a < 9; a++) s.m.val[s.m.at[i] + (size_t)a] *= k ? 100.0 : 1.2;
        }
        CHECK_RESULT(yci_ic_factor(f, &s.m), YC_OK);
        CHECK(k ? f->diagonal_only && f->shift == 0.0 : !f->diagonal_only && f->shift > 0.0);
    }
    s.m.val[s.m.at[s.m.diag[9]]] = -1.0;
    CHECK(yci_ic_factor(f, &s.m) == YC_ERROR_NOT_SPD && strstr(s.c.message, "node 9"));
    yci_ic_destroy(f);
    CHECK(yci_ic_create(&s.c, &s.m, dim, N, &everything, &f) == YC_ERROR_ARGUMENT && f == NULL);
    yci_ic_destroy(NULL);
    system_close(&s);
}

/* A grid by lines, its rows, and by blocks: the couplings of each and no others. */
TEST(sparse_incomplete_lines) {
    enum { N = 400 };
    static int pair[3 * N][2], dim[N], order[N], line[N];
    uint64_t seed = 8;
    linear_system s;
    yci_ic_extent extent = {0, line};
    yci_ic *f = NULL;
    size_t pairs = graph(4, N, pair, &seed);
    int i, k, count, by_lines = 0;
    for (i = 0; i < N; i++) dim[i] = 3, order[i] = i, line[i] = i % 7 ? i / 20 : -1;
    system_open(&s, NULL, N, dim, (const int(*)[2])pair, pairs);
    grid_values(&s.m);
    for (i = count = 0; i < N; i++)
        for (k = s.m.ptr[i]; k < s.m.diag[i]; k++)
            count += line[i] >= 0 && line[i] == line[s.m.col[k]] && i - s.m.col[k] <= YCI_IC_LINE;
    for (k = 0; k < 2; k++) {
        CHECK_RESULT(yci_ic_create(&s.c, &s.m, order, N, &extent, &f), YC_OK);
        CHECK_RESULT(yci_ic_factor(f, &s.m), YC_OK);
        CHECK(f->ptr[N] == (k ? 0 : count) && (k || count > N / 2));
        if (k) CHECK(iterations(&s.c, &s.m, f) > by_lines);
        else by_lines = iterations(&s.c, &s.m, f);
        yci_ic_destroy(f);
        extent.fill = YCI_IC_BLOCKS, extent.line = NULL;
    }
    system_close(&s);
}

/* On a chain IC(0) is exact, whatever the order along it and the dimensions; nodes left out keep their values. */
TEST(sparse_incomplete_exact) {
    enum { N = 30 };
    static int pair[3 * N][2], dim[N], order[N];
    uint64_t seed = 8;
    linear_system s;
    yci_ic *f = NULL;
    size_t pairs = graph(3, N, pair, &seed);
    int i, run, part, size, first;
    double *x, *y, worst;
    for (run = 0; run < 2 * YCI_LEVELS; run++) {
        part = run % 2;
        if (!yci_kernels_of(run / 2)) continue;
        for (i = 0; i < N; i++) dim[i] = part ? i % 6 : 3 + 2 * (i % 2), order[i] = part ? N - 1 - i : i;
        system_open(&s, NULL, N, dim, (const int(*)[2])pair, pairs);
        system_fill(&s, 1, 5);
        size = s.m.off[N], first = s.m.off[part ? 10 : 0];
        x = (double *)malloc((size_t)size * sizeof(double)), y = (double *)malloc((size_t)size * sizeof(double));
        for (i = 0; i < size; i++) x[i] = i < first ? 0.0 : test_random(&seed, -1.0, 1.0);
        yci_bsr_multiply(&s.c, &s.m, x, y);
        for (i = 0; i < first; i++) y[i] = 7.0;
        CHECK_RESULT(yci_ic_create(&s.c, &s.m, order, part ? N - 10 : N, &everything, &f), YC_OK);
        f->kernels = yci_kernels_of(run / 2);
        CHECK_RESULT(yci_ic_factor(f, &s.m), YC_OK);
        yci_ic_solve(f, y);
        for (i = first, worst = 0.0; i < size; i++) worst = yci_max(worst, fabs(x[i] - y[i]));
        for (i = 0; i < first; i++) CHECK(y[i] == 7.0);
        CHECK(worst < 1e-13);
        yci_ic_destroy(f);
        system_close(&s);
        free(x), free(y);
    }
}

/* ---- public ------------------------------------------------------------------------------------------------------ */

TEST(sparse_chol) {
    /* [4 1 0 1; 1 5 2 0; 0 2 6 0; 1 0 0 7], lower and full, by unknowns and by pairs of unknowns */
    static const int lower_ptr[] = {0, 1, 3, 5, 7}, lower_col[] = {0, 0, 1, 1, 2, 0, 3};
    static const int full_ptr[] = {0, 3, 6, 8, 10}, full_col[] = {0, 1, 3, 0, 1, 2, 1, 2, 0, 3};
    static const int reversed[] = {3, 2, 1, 0};
    static const double lower[] = {4, 1, 5, 2, 6, 1, 7}, full[] = {4, NAN, NAN, 1, 5, NAN, 2, 6, 1, 7};
    int trial, k;
    for (trial = 0; trial < 8; trial++) {
        yc_chol_options options;
        yc_chol_statistics stats;
        yc_chol *chol = NULL;
        double x[50];
        int is_full = trial % 2;
        yc_chol_options_default(&options);
        options.block = trial & 2 ? 2 : 1, options.kind = trial & 4 ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD;
        options.order = trial & 4 && !(trial & 2) ? reversed : NULL;
        CHECK(yc_chol_analyze(
                  NULL, 4, is_full ? full_ptr : lower_ptr, is_full ? full_col : lower_col, &options, &chol) == YC_OK);
        CHECK_RESULT(yc_chol_solve(chol, x, 1, 4), YC_ERROR_ARGUMENT);
        CHECK(yc_chol_factor(chol, is_full ? full : lower) == YC_OK);
        for (k = 0; k < 10; k++) x[5 * k] = 10 * k, x[5 * k + 1] = 17 * k, x[5 * k + 2] = 22 * k, x[5 * k + 3] = 29 * k;
        for (k = 0; k < 10; k++) x[5 * k + 4] = -3.0;
        CHECK_RESULT(yc_chol_solve(chol, x, 10, 5), YC_OK);
        for (k = 0; k < 10; k++) {
            CHECK(fabs(4 * x[5 * k] + x[5 * k + 1] + x[5 * k + 3] - 10 * k) < 1e-11);
            CHECK(fabs(x[5 * k] + 5 * x[5 * k + 1] + 2 * x[5 * k + 2] - 17 * k) < 1e-11);
            CHECK(fabs(2 * x[5 * k + 1] + 6 * x[5 * k + 2] - 22 * k) < 1e-11);
            CHECK(fabs(x[5 * k] + 7 * x[5 * k + 3] - 29 * k) < 1e-11);
            CHECK(x[5 * k + 4] == -3.0);
        }
        CHECK(yc_chol_stats(chol, &stats) == YC_OK && stats.nonzeros >= 7 && stats.supernodes >= 1 && stats.bytes > 0);
        yc_chol_destroy(chol);
    }
    yc_chol_destroy(NULL);
}

static void keep_log(void *user, const char *text) { snprintf((char *)user, 256, "%s", text); }

TEST(sparse_chol_errors) {
    static const int ptr[] = {0, 1, 3, 6};
    static const int cols[][6] = {
        {0, 0, 1, 0, 1, 2}, {0, 1, 0, 0, 1, 2}, {0, 0, 1, 0, 0, 2}, {0, 0, 1, 0, 1, 3}, {0, 0, 2, 0, 1, 2}};
    static const char *words[] = {"", "unsorted", "duplicate", "col[5] is 3", "not both"};
    static double values[] = {2, 3, 2, 0, 0, 1};
    int i, none = 0;
    char text[256];
    yc_chol *chol = NULL;
    yc_chol_options options;
    yc_host host;
    memset(&host, 0, sizeof host);
    host.user = text, host.log = keep_log;
    for (i = 1; i < 5; i++) {
        CHECK(yc_chol_analyze(&host, 3, ptr, cols[i], NULL, &chol) == YC_ERROR_ARGUMENT && !chol);
        CHECK(strstr(text, words[i]) != NULL);
    }
    CHECK_RESULT(yc_chol_analyze(&host, -1, ptr, cols[0], NULL, &chol), YC_ERROR_ARGUMENT);
    CHECK_RESULT(yc_chol_analyze(&host, 3, NULL, cols[0], NULL, &chol), YC_ERROR_ARGUMENT);
    memset(&options, 0, sizeof options);
    CHECK_RESULT(yc_chol_analyze(&host, 3, ptr, cols[0], &options, &chol), YC_ERROR_ARGUMENT);
    yc_chol_options_default(&options);
    options.block = 2;
    CHECK_RESULT(yc_chol_analyze(&host, 3, ptr, cols[0], &options, &chol), YC_ERROR_ARGUMENT);
    CHECK_RESULT(yc_chol_analyze(&host, 0, &none, NULL, NULL, &chol), YC_OK);
    CHECK(yc_chol_factor(chol, NULL) == YC_OK && yc_chol_solve(chol, NULL, 1, 0) == YC_OK);
    yc_chol_destroy(chol);
    CHECK_RESULT(yc_chol_analyze(&host, 3, ptr, cols[0], NULL, &chol), YC_OK);
    CHECK(yc_chol_factor(chol, values) == YC_ERROR_NOT_SPD && strstr(yc_chol_message(chol), "unknown"));
    values[1] = 0.5;
    CHECK_RESULT(yc_chol_factor(chol, values), YC_OK);
    values[1] = NAN;
    CHECK(yc_chol_factor(chol, values) == YC_ERROR_ARGUMENT && strstr(yc_chol_message(chol), "values[1]"));
    values[1] = 3;
    yc_chol_destroy(chol);
}

/* Everything these chapters make, with that many allocations granted. Returns whether all of it was made. */
static int memory_round(int granted) {
    static const int pair[][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {1, 3}}, dim[] = {3, 1, 0, 2}, order[] = {3, 1, 0};
    static const int ptr[] = {0, 1, 3, 5}, col[] = {0, 0, 1, 1, 2};
    yc_host host = test_host_failing(granted);
    yci_context c;
    yci_bsr m;
    yci_ldl *ldl = NULL;
    yci_ic *ic = NULL;
    yc_lu *lu = NULL;
    yc_chol *chol = NULL;
    yc_result result[5];
    int i, made = 0;
    CHECK_RESULT(yci_context_init(&c, &host), YC_OK);
    result[0] = yci_bsr_create(&c, 4, dim, pair, 5, &m);
    result[1] = m.val ? yci_ldl_analyze_bsr(&c, &m, NULL, 0, &ldl) : YC_ERROR_MEMORY;
    result[2] = m.val ? yci_ic_create(&c, &m, order, 3, &everything, &ic) : YC_ERROR_MEMORY;
    result[3] = yc_lu_create(&host, 5, &lu);
    result[4] = yc_chol_analyze(&host, 3, ptr, col, NULL, &chol);
    for (i = 0; i < 5; i++) {
        CHECK(result[i] == YC_OK || result[i] == YC_ERROR_MEMORY);
        made += result[i] == YC_OK;
    }
    CHECK((result[1] == YC_OK) == (ldl != NULL) && (result[2] == YC_OK) == (ic != NULL));
    CHECK((result[3] == YC_OK) == (lu != NULL) && (result[4] == YC_OK) == (chol != NULL));
    yci_ldl_destroy(ldl), yci_ic_destroy(ic);
    yci_bsr_destroy(&c, &m);
    yc_lu_destroy(lu), yc_chol_destroy(chol);
    CHECK(test_heap.live == 0 && c.bytes == 0);
    return made == 5;
}

/* Dissection, alone on a mesh, and against minimum degree on what is none. */
TEST(sparse_order_chosen) {
    enum { N = 80 * 80 };
    static int pair[3 * N][2], dim[N];
    static order_result r;
    uint64_t seed = 8;
    int i, kind;
    size_t k, pairs;
    for (i = 0; i < N; i++) dim[i] = 5;
    for (kind = 2; kind <= 4; kind += 2) {
        linear_system s;
        pairs = graph(kind, N, pair, &seed);
        for (k = 0; k < pairs; k++) pair[k][0] ^= 1, pair[k][1] ^= 1; /* not numbered line by line */
        system_open(&s, NULL, N, dim, (const int(*)[2])pair, pairs);
        order_run(&s, 2, NULL, &r);
        system_close(&s);
    }
}

TEST(sparse_out_of_memory) {
    int granted = 0;
    while (granted < 1000 && !memory_round(granted)) granted++;
    CHECK(granted > 40 && granted == test_heap.calls);
}
