/* The sparse direct solver yc_chol: accuracy, what it reports and refuses, bits whatever the workers, memory. */

static int tile_limit; /* of tiles that a small factor may have */
#define YCI_LDL_TILES tile_limit
#include "internals.h"
#include "test.h"

/* All tests here run twice, with small factors in tiles and with all of them in fronts. */
#undef TEST
#define TEST(name) \
    static void name(void); \
    void test_function_##name(void); \
    void test_function_##name(void) { \
        tile_limit = 2500, name(); \
        tile_limit = 0, name(); \
    } \
    static void name(void)
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- matrices ---------------------------------------------------------------------------------------------------- */

enum { GRID, CHAIN, ARROW, DENSE, PARTS, DIAGONAL, CLIQUES, SHAPES };
enum { CLIQUE = 12 };

/* Compressed rows, of the lower triangle unless a test says otherwise. */
typedef struct {
    int n, block, entries;
    int *ptr, *col;
    double *value;
} matrix;

/* The neighbours of node i below i, ascending. */
static int neighbours(int shape, int nodes, int i, int *out) {
    int width = (int)sqrt((double)nodes), count = 0, j;
    switch (shape) {
    case GRID: /* with one diagonal */
        if (i >= width && i % width) out[count++] = i - width - 1;
        if (i >= width) out[count++] = i - width;
        if (i % width) out[count++] = i - 1;
        break;
    case CHAIN:
        if (i) out[count++] = i - 1;
        break;
    case ARROW: /* a hub in the middle */
        if (i > nodes / 2) out[count++] = nodes / 2;
        for (j = 0; i == nodes / 2 && j < i; j++) out[count++] = j;
        break;
    case DENSE:
        for (j = 0; j < i; j++) out[count++] = j;
        break;
    case PARTS: /* two parts without a link, and lone nodes behind them */
        for (j = 13; j > 0; j -= 6) {
            int part = nodes * 2 / 5;
            if (i >= j && i < 2 * part && i / part == (i - j) / part) out[count++] = i - j;
        }
        break;
    case CLIQUES:
        for (j = i - i % CLIQUE - (i >= CLIQUE); j < i; j++) out[count++] = j;
        break;
    default: break;
    }
    return count;
}

static matrix matrix_open(int shape, int nodes, int block) {
    matrix m;
    int *near = (int *)malloc(((size_t)nodes + 1) * sizeof(int)), i, k, a, b;
    size_t room = 0;
    for (i = 0; i < nodes; i++) room += (size_t)(neighbours(shape, nodes, i, near) + 1) * (size_t)(block * block);
    m.n = nodes * block, m.block = block, m.entries = 0;
    m.ptr = (int *)malloc(((size_t)m.n + 1) * sizeof(int));
    m.col = (int *)malloc((room + 1) * sizeof(int));
    m.value = (double *)calloc(room + 1, sizeof(double));
    for (i = 0; i < nodes; i++) {
        int count = neighbours(shape, nodes, i, near);
        for (a = 0; a < block; a++) {
            m.ptr[i * block + a] = m.entries;
            for (k = 0; k < count; k++)
                for (b = 0; b < block; b++) m.col[m.entries++] = near[k] * block + b;
            for (b = 0; b <= a; b++) m.col[m.entries++] = i * block + b;
        }
    }
    m.ptr[m.n] = m.entries;
    free(near);
    return m;
}

static void matrix_close(matrix *m) { free(m->ptr), free(m->col), free(m->value); }

/* The same with the whole pattern; what stands above the diagonal is `above`. */
static matrix matrix_full(const matrix *m, double above) {
    matrix f = *m;
    int *next = (int *)calloc((size_t)m->n + 1, sizeof(int)), i, k;
    f.entries = 2 * m->entries - m->n;
    f.ptr = (int *)calloc((size_t)m->n + 1, sizeof(int));
    f.col = (int *)malloc((size_t)f.entries * sizeof(int) + 1);
    f.value = (double *)malloc((size_t)f.entries * sizeof(double) + 1);
    for (i = 0; i < m->n; i++)
        for (k = m->ptr[i]; k < m->ptr[i + 1]; k++) next[i]++, next[m->col[k]] += m->col[k] < i;
    for (i = 0; i < m->n; i++) f.ptr[i + 1] = f.ptr[i] + next[i], next[i] = f.ptr[i];
    for (i = 0; i < m->n; i++)
        for (k = m->ptr[i]; k < m->ptr[i + 1]; k++) {
            int j = m->col[k];
            f.col[next[i]] = j, f.value[next[i]++] = m->value[k];
            if (j < i) f.col[next[j]] = i, f.value[next[j]++] = above;
        }
    free(next);
    return f;
}

/* The place of (i, j) with i >= j; it must be there. */
static double *entry(const matrix *m, int i, int j) {
    int low = m->ptr[i], high = m->ptr[i + 1] - 1;
    while (low < high) {
        int middle = (low + high) / 2;
        if (m->col[middle] < j) low = middle + 1;
        else high = middle;
    }
    return m->value + low;
}

static int row_of(const matrix *m, int k) {
    int i = 0;
    while (m->ptr[i + 1] <= k) i++;
    return i;
}

/* Random entries and a diagonal that dominates them: positive definite, well conditioned. With signs (n; NULL: all
 * positive) the unknowns of a negative sign make a negative definite part, and only entries of one part count. */
static void fill_dominant(matrix *m, const signed char *sign, uint64_t seed) {
    double *sum = (double *)calloc((size_t)m->n + 1, sizeof(double));
    int i, k;
    for (i = 0; i < m->n; i++)
        for (k = m->ptr[i]; k < m->ptr[i + 1]; k++) {
            int j = m->col[k];
            m->value[k] = test_random(&seed, -1.0, 1.0);
            if (j < i && (!sign || sign[i] == sign[j])) sum[i] += fabs(m->value[k]), sum[j] += fabs(m->value[k]);
        }
    for (i = 0; i < m->n; i++) m->value[m->ptr[i + 1] - 1] = (sign ? sign[i] : 1) * (sum[i] + 0.5);
    free(sum);
}

/* A sum of springs w g g' between neighbours, w from 1 to 1e6, over a weak ground: positive definite, badly
 * conditioned, as stiffness matrices are. */
static void fill_springs(matrix *m, uint64_t seed) {
    int nodes = m->n / m->block, b = m->block, i, k, spring, p, q, unknown[2 * YCI_BLOCK_MAX];
    memset(m->value, 0, (size_t)m->entries * sizeof(double));
    for (i = 0; i < m->n; i++) m->value[m->ptr[i + 1] - 1] = 1e-3;
    for (i = 0; i < nodes; i++)
        for (k = m->ptr[i * b]; k < m->ptr[i * b + 1] && m->col[k] < i * b; k += b)
            for (spring = 0; spring < 2; spring++) {
                double w = pow(10.0, test_random(&seed, 0.0, 6.0)), g[2 * YCI_BLOCK_MAX];
                for (p = 0; p < b; p++) {
                    unknown[p] = m->col[k] + p, unknown[b + p] = i * b + p;
                    g[p] = test_random(&seed, -1.0, 1.0), g[b + p] = -g[p];
                }
                for (p = 0; p < 2 * b; p++)
                    for (q = 0; q <= p; q++) *entry(m, unknown[p], unknown[q]) += w * g[p] * g[q];
            }
}

static void scale_rows_and_columns(matrix *m, const double *d) {
    int i, k;
    for (i = 0; i < m->n; i++)
        for (k = m->ptr[i]; k < m->ptr[i + 1]; k++) m->value[k] *= d[i] * d[m->col[k]];
}

/* y = A x from the lower triangle. */
static void multiply(const matrix *m, const double *x, double *y) {
    int i, k;
    memset(y, 0, (size_t)m->n * sizeof(double));
    for (i = 0; i < m->n; i++)
        for (k = m->ptr[i]; k < m->ptr[i + 1] && m->col[k] <= i; k++) {
            y[i] += m->value[k] * x[m->col[k]];
            if (m->col[k] < i) y[m->col[k]] += m->value[k] * x[i];
        }
}

/* |b - A x| / (|A| |x| + |b|) in the maximum norm; with `scaled` that of the system whose diagonal is made 1. */
static double backward_error(const matrix *m, const double *b, const double *x, int scaled) {
    long double *r = (long double *)malloc(((size_t)m->n + 1) * 3 * sizeof(long double)), *sum = r + m->n;
    long double *s = sum + m->n, most = 0.0L, norm = 0.0L, largest = 0.0L, right = 0.0L;
    int i, k;
    for (i = 0; i < m->n; i++) {
        s[i] = scaled ? 1.0L / sqrtl(fabsl((long double)m->value[m->ptr[i + 1] - 1])) : 1.0L;
        r[i] = b[i], sum[i] = 0.0L;
    }
    for (i = 0; i < m->n; i++)
        for (k = m->ptr[i]; k < m->ptr[i + 1]; k++) {
            int j = m->col[k];
            long double v = m->value[k], size = s[i] * fabsl(v) * s[j];
            r[i] -= v * x[j], sum[i] += size;
            if (j < i) r[j] -= v * x[i], sum[j] += size;
        }
    for (i = 0; i < m->n; i++) {
        if (!(s[i] * fabsl(r[i]) <= most)) most = s[i] * fabsl(r[i]);
        norm = fmaxl(norm, sum[i]), right = fmaxl(right, s[i] * fabsl((long double)b[i]));
        largest = fmaxl(largest, fabsl((long double)x[i]) / s[i]);
    }
    free(r);
    return most == 0.0L ? 0.0 : (double)(most / (norm * largest + right));
}

static yc_chol_options options_of(yc_chol_kind kind, int block) {
    yc_chol_options options;
    yc_chol_options_default(&options);
    options.kind = kind, options.block = block;
    return options;
}

static yc_chol *analyzed(const yc_host *host, const matrix *m, yc_chol_kind kind) {
    yc_chol_options options = options_of(kind, m->block);
    yc_chol *chol = NULL;
    CHECK_RESULT(yc_chol_analyze(host, m->n, m->ptr, m->col, &options, &chol), YC_OK);
    return chol;
}

static yc_chol *factored(const yc_host *host, const matrix *m, yc_chol_kind kind) {
    yc_chol *chol = analyzed(host, m, kind);
    if (chol) CHECK_RESULT(yc_chol_factor(chol, m->value), YC_OK);
    return chol;
}

/* The worst backward error of three solves, two for random right-hand sides and one for a random solution, with every
 * set of kernels that this machine has. */
static double solve_error(const matrix *m, yc_chol_kind kind, int scaled) {
    yc_chol *chol = analyzed(NULL, m, kind);
    size_t n = (size_t)m->n;
    double *b = (double *)malloc((6 * n + 1) * sizeof(double)), *x = b + 3 * n, worst = 0.0;
    uint64_t seed = 17;
    int level, k;
    test_random_array(&seed, -1.0, 1.0, b, 2 * m->n), test_random_array(&seed, -1.0, 1.0, x, m->n);
    multiply(m, x, b + 2 * n);
    for (level = 0; chol && level < YCI_LEVELS; level++) {
        if (!(chol->ldl->kernels = yci_kernels_of(level))) continue;
        CHECK_RESULT(yc_chol_factor(chol, m->value), YC_OK);
        memcpy(x, b, 3 * n * sizeof(double));
        if (!CHECK_RESULT(yc_chol_solve(chol, x, 3, m->n), YC_OK)) break;
        for (k = 0; k < 3; k++) {
            double error = backward_error(m, b + (size_t)k * n, x + (size_t)k * n, scaled);
            if (!(error <= worst)) worst = error;
        }
    }
    yc_chol_destroy(chol);
    free(b);
    return worst;
}

/* Whatever the factor holds that has a meaning: tiles, or packed columns. */
static uint64_t factor_bits(const yc_chol *chol) {
    const yci_ldl *f = chol->ldl;
    uint64_t bits = 1, one;
    int s, i;
    for (i = 0; f->tiled && i < YCI_TILE * f->tiles.begin[f->tiles.blocks]; i++) {
        memcpy(&one, f->tiles.l + i, sizeof one);
        bits = (bits ^ one) * UINT64_C(0x100000001b3), bits ^= bits >> 29;
    }
    for (s = 0; !f->tiled && s < f->supers; s++) {
        size_t k, count = yci_packed(f->super[s].width, f->super[s].height);
        for (k = 0; k < count; k++) {
            memcpy(&one, f->panel + f->super[s].panel + k, sizeof one);
            bits = (bits ^ one) * UINT64_C(0x100000001b3), bits ^= bits >> 29;
        }
    }
    return bits;
}

static double *random_numbers(uint64_t seed, int count) {
    double *x = (double *)malloc(((size_t)count + 1) * sizeof(double));
    test_random_array(&seed, -1.0, 1.0, x, count);
    return x;
}

/* ---- accuracy ---------------------------------------------------------------------------------------------------- */

TEST(direct_meshes) {
    int shape, block;
    for (shape = 0; shape < SHAPES; shape++)
        for (block = 1; block <= YCI_BLOCK_MAX; block++) {
            matrix m = matrix_open(shape, shape == DENSE ? 40 : shape == GRID ? 225 : 150, block);
            fill_dominant(&m, NULL, 3);
            CHECK_NEAR(solve_error(&m, YC_CHOL_SPD, 0), 0.0, 1e-15);
            CHECK_NEAR(solve_error(&m, YC_CHOL_QUASIDEFINITE, 0), 0.0, 1e-15);
            matrix_close(&m);
        }
}

TEST(direct_stiff_meshes) {
    int block;
    for (block = 1; block <= YCI_BLOCK_MAX; block++) {
        matrix m = matrix_open(GRID, 400, block);
        fill_springs(&m, 3);
        CHECK_NEAR(solve_error(&m, YC_CHOL_SPD, 0), 0.0, 1e-15);
        CHECK_NEAR(solve_error(&m, YC_CHOL_SPD, 1), 0.0, 1e-15);
        matrix_close(&m);
    }
}

/* The same by the other kind, which inverts whole blocks, some with a condition of 1e9: worse, as documented, and
 * mended by refinement while the blocks are small. */
TEST(direct_stiff_blocks) {
    int block;
    for (block = 1; block <= 4; block++) {
        matrix m = matrix_open(GRID, 400, block);
        yc_chol *chol;
        double *b, *x, error = 1.0;
        fill_springs(&m, 3);
        chol = analyzed(NULL, &m, YC_CHOL_QUASIDEFINITE);
        b = random_numbers(5, m.n), x = random_numbers(5, m.n);
        if (block == 1) CHECK_NEAR(solve_error(&m, YC_CHOL_QUASIDEFINITE, 0), 0.0, 2e-15);
        CHECK(chol && yc_chol_factor(chol, m.value) == YC_OK && yc_chol_solve(chol, x, 1, m.n) == YC_OK);
        CHECK_RESULT(yc_chol_refine(chol, m.ptr, m.col, m.value, b, x, 5, &error, NULL), YC_OK);
        CHECK_NEAR(error, 0.0, 2e-15);
        CHECK_NEAR(backward_error(&m, b, x, 0), 0.0, 2e-15);
        yc_chol_destroy(chol);
        free(b), free(x);
        matrix_close(&m);
    }
}

/* D A D with D from 10^-exponent to 10^exponent, A dominant: both kinds solve it as well as A. */
static void check_graded(int shape, int nodes, int block, double exponent) {
    matrix m = matrix_open(shape, nodes, block);
    double *d = random_numbers(7, m.n);
    int i;
    for (i = 0; i < m.n; i++) d[i] = pow(10.0, exponent * d[i]);
    fill_dominant(&m, NULL, 5);
    scale_rows_and_columns(&m, d);
    CHECK_NEAR(solve_error(&m, YC_CHOL_SPD, 0), 0.0, 1e-15);
    CHECK_NEAR(solve_error(&m, YC_CHOL_SPD, 1), 0.0, 1e-15);
    CHECK_NEAR(solve_error(&m, YC_CHOL_QUASIDEFINITE, 0), 0.0, 1e-15);
    CHECK_NEAR(solve_error(&m, YC_CHOL_QUASIDEFINITE, 1), 0.0, 1e-15);
    free(d);
    matrix_close(&m);
}

/* D A D with D from 1e-7 to 1e7, a condition of 1e28 that scaling undoes: an elimination does not feel it. */
TEST(direct_graded) {
    int shape, block;
    for (shape = 0; shape < SHAPES; shape++)
        for (block = 1; block <= 5; block += 2) check_graded(shape, shape == DENSE ? 40 : 196, block, 7.0);
}

/* Hilbert matrices of 10 and 11 unknowns, whose condition is 1.6e13 and 5e14, as cliques of a chain. */
TEST(direct_hilbert) {
    int size, i, k;
    for (size = 10; size <= 11; size++) {
        matrix m = matrix_open(CLIQUES, 20 * CLIQUE, 1);
        for (i = 0; i < m.n; i++)
            for (k = m.ptr[i]; k < m.ptr[i + 1]; k++) {
                int j = m.col[k], p = i % CLIQUE, q = j % CLIQUE, inside = i / CLIQUE == j / CLIQUE;
                m.value[k] = inside && p < size ? 1.0 / (p + q + 1) : i == j ? 1.0 : 0.0;
                if (!inside && p == CLIQUE - 1) m.value[k] = -0.4;
            }
        CHECK_NEAR(solve_error(&m, YC_CHOL_SPD, 0), 0.0, 1e-15);
        CHECK_NEAR(solve_error(&m, YC_CHOL_QUASIDEFINITE, 0), 0.0, 1e-15);
        matrix_close(&m);
    }
}

/* Dense random matrices of condition 1e14: a diagonal from 1 down to 1e-14 between reflections. */
TEST(direct_condition) {
    int trial, i, j, k;
    for (trial = 0; trial < 3; trial++) {
        matrix m = matrix_open(DENSE, 40 + 10 * trial, 1);
        int n = m.n;
        double *a = (double *)calloc((size_t)(n * n), sizeof(double)), *v, *w = random_numbers(1, n);
        for (i = 0; i < n; i++) a[i * n + i] = pow(10.0, -14.0 * i / (n - 1));
        for (k = 0; k < 4; k++) { /* A - 2 v w' - 2 w v' with w = A v - (v'A v) v */
            double length = 0.0, middle = 0.0;
            v = random_numbers((uint64_t)(4 * trial + k), n);
            for (i = 0; i < n; i++) length += v[i] * v[i];
            for (i = 0; i < n; i++) v[i] /= sqrt(length);
            for (i = 0; i < n; i++)
                for (w[i] = 0.0, j = 0; j < n; j++) w[i] += a[i * n + j] * v[j];
            for (i = 0; i < n; i++) middle += v[i] * w[i];
            for (i = 0; i < n; i++) w[i] -= middle * v[i];
            for (i = 0; i < n; i++)
                for (j = 0; j < n; j++) a[i * n + j] -= 2.0 * (v[i] * w[j] + w[i] * v[j]);
            free(v);
        }
        for (i = 0; i < n; i++)
            for (j = 0; j <= i; j++) *entry(&m, i, j) = a[i * n + j];
        CHECK_NEAR(solve_error(&m, YC_CHOL_SPD, 0), 0.0, 1e-15);
        CHECK_NEAR(solve_error(&m, YC_CHOL_QUASIDEFINITE, 0), 0.0, 1e-15);
        free(a), free(w);
        matrix_close(&m);
    }
}

/* Scaled by 2^exponent, m has a solution as accurate as before, and the same to the last bit but for its exponent
 * where both factors are in tiles or both in fronts. The exponent is a multiple of 4, since blocks are equilibrated by
 * fourth roots. */
static void check_scaled(const yc_chol *chol, const matrix *m, yc_chol_kind kind, int exponent, int tiled) {
    matrix scaled = *m;
    yc_chol *other = analyzed(NULL, m, kind);
    double *x = random_numbers(4, m->n), *y = random_numbers(4, m->n);
    int i;
    scaled.value = (double *)malloc((size_t)m->entries * sizeof(double));
    for (i = 0; i < m->entries; i++) scaled.value[i] = ldexp(m->value[i], exponent);
    CHECK_RESULT(yc_chol_factor(other, scaled.value), YC_OK);
    CHECK(other->ldl->tiled == tiled);
    CHECK(yc_chol_solve(chol, x, 1, m->n) == YC_OK && yc_chol_solve(other, y, 1, m->n) == YC_OK);
    for (i = 0; i < m->n; i++) y[i] = ldexp(y[i], exponent);
    if (chol->ldl->tiled == tiled) CHECK(memcmp(x, y, (size_t)m->n * sizeof(double)) == 0);
    else CHECK_NEAR(solve_error(&scaled, kind, 0), 0.0, 1e-15);
    yc_chol_destroy(other);
    free(x), free(y), free(scaled.value);
}

/* By 2^+-500, about 1e+-150, and by 2^+-900 tiles are left to the fronts; stiff matrices are there already. */
TEST(direct_scaled) {
    static const int exponents[] = {332, -332, 500, -500, 900, -900};
    int stiff, which, block, e;
    for (stiff = 0; stiff < 2; stiff++)
        for (which = 0; which < 2; which++)
            for (block = 1; block <= 3; block += 2) {
                yc_chol_kind kind = which ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD;
                int tiles = tile_limit && !stiff && (!which || block == 1);
                matrix m = matrix_open(GRID, stiff ? 400 : 196, block);
                yc_chol *chol;
                if (stiff) fill_springs(&m, 8);
                else fill_dominant(&m, NULL, 8);
                chol = factored(NULL, &m, kind);
                CHECK(chol->ldl->tiled == tiles);
                for (e = 0; e < 6; e++) check_scaled(chol, &m, kind, exponents[e], tiles && e < 2);
                yc_chol_destroy(chol);
                matrix_close(&m);
            }
}

/* In tiles, rows and columns scaled from 1e-30 to 1e30, and some links that are subnormal. */
TEST(direct_scaled_unevenly) {
    int which, block, i, k;
    for (which = 0; which < 2; which++)
        for (block = 1; block <= 2; block++) {
            yc_chol_kind kind = which ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD;
            matrix m = matrix_open(GRID, 196, block);
            double *d = random_numbers(9, m.n);
            yc_chol *chol;
            for (i = 0; i < m.n; i++) d[i] = pow(10.0, 30.0 * d[i]);
            fill_dominant(&m, NULL, 8);
            for (i = 0; i < m.n; i++)
                for (k = m.ptr[i]; k < m.ptr[i + 1]; k++)
                    if (k % 3 == 0 && m.col[k] / block != i / block) m.value[k] = 1e-310;
            chol = factored(NULL, &m, kind);
            CHECK(chol->ldl->tiled == (tile_limit > 0));
            CHECK_NEAR(solve_error(&m, kind, 0), 0.0, 1e-15);
            scale_rows_and_columns(&m, d);
            CHECK(yc_chol_factor(chol, m.value) == YC_OK && chol->ldl->tiled == (tile_limit > 0));
            CHECK_NEAR(solve_error(&m, kind, 0), 0.0, 1e-15);
            CHECK_NEAR(solve_error(&m, kind, 1), 0.0, 1e-15);
            yc_chol_destroy(chol);
            free(d);
            matrix_close(&m);
        }
}

/* Entries from 1e-150 to 1e150, whose products reach to the ends of what is representable. */
TEST(direct_wide) { check_graded(GRID, 400, 3, 75.0); }

/* Entries that are all subnormal, the solution 1, ..., 1: 2^-1074 is their grain. */
static double subnormal_error(const matrix *m, yc_chol_kind kind, int exponent) {
    matrix tiny = *m;
    yc_chol *chol = analyzed(NULL, m, kind);
    double *x = (double *)malloc((size_t)m->n * sizeof(double)), worst = 0.0;
    int level, i, k;
    tiny.value = (double *)malloc((size_t)m->entries * sizeof(double));
    for (k = 0; k < m->entries; k++) tiny.value[k] = ldexp(floor(ldexp(m->value[k], 20)), exponent - 20);
    for (level = 0; level < YCI_LEVELS; level++) {
        if (!(chol->ldl->kernels = yci_kernels_of(level))) continue;
        for (i = 0; i < m->n; i++) x[i] = 1.0;
        if (!CHECK_RESULT(yc_chol_factor(chol, tiny.value), YC_OK)) break;
        {
            double *b = (double *)malloc((size_t)m->n * sizeof(double));
            multiply(&tiny, x, b);
            CHECK_RESULT(yc_chol_solve(chol, b, 1, m->n), YC_OK);
            for (i = 0; i < m->n; i++)
                if (!(fabs(b[i] - 1.0) <= worst)) worst = fabs(b[i] - 1.0);
            free(b);
        }
    }
    yc_chol_destroy(chol);
    free(x), free(tiny.value);
    return worst;
}

TEST(direct_subnormal) {
    yc_chol *tiny;
    int shape, block, k;
    for (shape = 0; shape < SHAPES; shape++)
        for (block = 1; block <= 3; block += 2) {
            matrix m = matrix_open(shape, shape == DENSE ? 20 : 144, block);
            fill_dominant(&m, NULL, 6);
            CHECK_NEAR(subnormal_error(&m, YC_CHOL_SPD, -1020), 0.0, 1e-12);
            CHECK_NEAR(subnormal_error(&m, YC_CHOL_SPD, -1040), 0.0, 1e-6);
            CHECK_NEAR(subnormal_error(&m, YC_CHOL_QUASIDEFINITE, -1000), 0.0, 1e-12);
            tiny = analyzed(NULL, &m, YC_CHOL_QUASIDEFINITE); /* inverses that are not representable */
            for (k = 0; k < m.entries; k++) m.value[k] = ldexp(m.value[k], -1040);
            CHECK_RESULT(yc_chol_factor(tiny, m.value), YC_ERROR_SINGULAR);
            yc_chol_destroy(tiny);
            matrix_close(&m);
        }
}

/* Subnormal entries beside a usual diagonal change nothing. */
TEST(direct_subnormal_links) {
    matrix m = matrix_open(GRID, 144, 3);
    double *x = random_numbers(2, m.n);
    yc_chol *chol;
    int i, k;
    for (i = 0; i < m.n; i++)
        for (k = m.ptr[i]; k < m.ptr[i + 1]; k++) m.value[k] = m.col[k] == i ? 2.0 : 1e-310;
    chol = factored(NULL, &m, YC_CHOL_SPD);
    CHECK_RESULT(yc_chol_solve(chol, x, 1, m.n), YC_OK);
    free(x), x = random_numbers(2, m.n);
    yc_chol_destroy(chol);
    chol = factored(NULL, &m, YC_CHOL_QUASIDEFINITE);
    {
        double *y = random_numbers(2, m.n);
        CHECK_RESULT(yc_chol_solve(chol, y, 1, m.n), YC_OK);
        for (i = 0; i < m.n; i++) CHECK(y[i] == x[i] / 2.0);
        free(y);
    }
    yc_chol_destroy(chol);
    free(x);
    matrix_close(&m);
}

/* [[H G'],[G -C]] with positive definite H and C, in any order, by unknowns and in blocks. */
TEST(direct_quasidefinite) {
    int shape, block, i;
    for (shape = 0; shape < SHAPES; shape++)
        for (block = 1; block <= YCI_BLOCK_MAX; block += shape == GRID ? 1 : 3) {
            matrix m = matrix_open(shape, shape == DENSE ? 40 : 196, block);
            signed char *sign = (signed char *)malloc((size_t)m.n);
            uint64_t seed = 5;
            for (i = 0; i < m.n; i++) sign[i] = test_random_int(&seed, 3) ? 1 : -1;
            fill_dominant(&m, sign, 12);
            CHECK_NEAR(solve_error(&m, YC_CHOL_QUASIDEFINITE, 0), 0.0, 1e-15);
            free(sign);
            matrix_close(&m);
        }
}

/* The same graded, so that H and C reach from 1e-14 to 1e14. */
TEST(direct_quasidefinite_graded) {
    int block, i;
    for (block = 1; block <= 6; block += 2) {
        matrix m = matrix_open(GRID, 196, block);
        signed char *sign = (signed char *)malloc((size_t)m.n);
        double *d = random_numbers(7, m.n);
        uint64_t seed = 5;
        for (i = 0; i < m.n; i++) sign[i] = test_random_int(&seed, 3) ? 1 : -1, d[i] = pow(10.0, 7.0 * d[i]);
        fill_dominant(&m, sign, 12);
        scale_rows_and_columns(&m, d);
        CHECK_NEAR(solve_error(&m, YC_CHOL_QUASIDEFINITE, 0), 0.0, 1e-15);
        CHECK_NEAR(solve_error(&m, YC_CHOL_QUASIDEFINITE, 1), 0.0, 1e-15);
        free(sign), free(d);
        matrix_close(&m);
    }
}

/* Nodes of 1 to 8 unknowns, or of none and 2, against dense LU. Each node is made of pairs [[0 2],[2 k]], and a 1 where
 * one is left over; weak random links join neighbours. */
static void mixed_nodes(uint64_t seed, int ordered, double k, int pairs_only) {
    enum { NODES = 64 };
    static int pair[3 * NODES][2], dim[NODES], order[NODES];
    int level, i, j, p, a, b, pairs = 0, size, near[3];
    yci_context c;
    yci_bsr m;
    yci_ldl *f = NULL;
    yc_lu *lu = NULL;
    double *dense, *work;
    for (i = 0; i < NODES; i++) {
        dim[i] = pairs_only ? 2 * test_random_int(&seed, 2) : 1 + test_random_int(&seed, YCI_BLOCK_MAX), order[i] = i;
        for (p = neighbours(GRID, NODES, i, near); p > 0;) pair[pairs][0] = i, pair[pairs++][1] = near[--p];
    }
    for (i = NODES - 1; i > 0; i--) j = test_random_int(&seed, i + 1), p = order[i], order[i] = order[j], order[j] = p;
    CHECK_RESULT(yci_context_init(&c, NULL), YC_OK);
    CHECK_RESULT(yci_bsr_create(&c, NODES, dim, (const int(*)[2])pair, (size_t)pairs, &m), YC_OK);
    size = m.off[NODES];
    dense = (double *)calloc((size_t)(size * size), sizeof(double));
    for (i = 0; i < NODES; i++)
        for (p = m.ptr[i]; p < m.ptr[i + 1]; p++)
            for (a = 0; a < dim[i]; a++)
                for (b = 0; b < dim[m.col[p]]; b++) {
                    int row = m.off[i] + a, column = m.off[m.col[p]] + b;
                    double *v = &dense[row * size + column];
                    if (column < row)
                        *v = m.col[p] != i ? test_random(&seed, -0.05, 0.05) : a % 2 && b == a - 1 ? 2.0 : 0.0;
                    if (column < row) dense[column * size + row] = *v;
                    if (column == row) *v = a % 2 ? k : a == dim[i] - 1 ? 1.0 : 0.0;
                }
    for (i = 0; i < NODES; i++)
        for (p = m.ptr[i]; p < m.ptr[i + 1]; p++)
            for (a = 0; a < dim[i]; a++)
                memcpy(m.val + m.at[p] + a * dim[m.col[p]], dense + (m.off[i] + a) * size + m.off[m.col[p]],
                    (size_t)dim[m.col[p]] * sizeof(double));
    CHECK_RESULT(yci_ldl_analyze_bsr(&c, &m, ordered ? order : NULL, 0, &f), YC_OK);
    CHECK(yc_lu_create(NULL, size, &lu) == YC_OK && yc_lu_factor(lu, dense, size) == YC_OK);
    work = (double *)malloc(yci_ldl_work(f, 2) * sizeof(double));
    for (level = 0; level < YCI_LEVELS; level++) {
        double *x = random_numbers(seed, 2 * size), *y = random_numbers(seed, 2 * size);
        if ((f->kernels = yci_kernels_of(level)) != NULL && CHECK_RESULT(yci_ldl_factor(f, m.val), YC_OK)) {
            CHECK(f->tiled == (pairs_only && tile_limit > 0));
            yci_ldl_solve(f, x, 2, size, work);
            CHECK_RESULT(yc_lu_solve(lu, y, 2, size), YC_OK);
            CHECK_NEAR_ALL(x, y, 2 * size, 1e-13);
        }
        free(x), free(y);
    }
    yci_ldl_destroy(f), yci_bsr_destroy(&c, &m), yc_lu_destroy(lu);
    free(dense), free(work);
}

TEST(direct_mixed_nodes) {
    int trial;
    for (trial = 0; trial < 6; trial++) mixed_nodes((uint64_t)trial, trial % 3, trial % 2 ? -1.0 : 0.5, 0);
}

/* Pairs without any diagonal are regular blocks. */
TEST(direct_zero_pairs) {
    int trial;
    for (trial = 0; trial < 6; trial++) mixed_nodes((uint64_t)trial, trial % 3, 0.0, 0);
    for (trial = 0; trial < 6; trial++) mixed_nodes((uint64_t)trial, trial % 3, trial % 2 ? -1.0 : 0.0, 1);
}

/* ---- sizes and shapes at the edge -------------------------------------------------------------------------------- */

TEST(direct_nothing) {
    static const int zero = 0;
    yc_chol_options options = options_of(YC_CHOL_QUASIDEFINITE, 8);
    yc_chol_statistics stats;
    yc_chol *chol = NULL;
    double error = 1.0;
    int trial;
    for (trial = 0; trial < 2; trial++) {
        CHECK_RESULT(yc_chol_analyze(NULL, 0, &zero, NULL, trial ? &options : NULL, &chol), YC_OK);
        CHECK(yc_chol_solve(chol, NULL, 1, 0) == YC_ERROR_ARGUMENT);
        CHECK(yc_chol_factor(chol, NULL) == YC_OK && yc_chol_solve(chol, NULL, 3, 0) == YC_OK);
        CHECK_RESULT(yc_chol_refine(chol, &zero, NULL, NULL, NULL, NULL, 5, &error, NULL), YC_OK);
        CHECK(error == 0.0 && yc_chol_order(chol, NULL) == YC_OK && yc_chol_stats(chol, &stats) == YC_OK);
        CHECK(stats.nonzeros == 0.0 && stats.flops == 0.0 && stats.supernodes == 0 && stats.pivots == 0);
        yc_chol_destroy(chol);
    }
}

TEST(direct_one) {
    static const int ptr[] = {0, 1}, col[] = {0}, none[] = {0, 0};
    static const double values[] = {4.0, -4.0, 0.0};
    static const yc_result spd[] = {YC_OK, YC_ERROR_NOT_SPD, YC_ERROR_NOT_SPD};
    static const yc_result indefinite[] = {YC_OK, YC_OK, YC_ERROR_SINGULAR};
    int which, k;
    for (which = 0; which < 2; which++) {
        yc_chol_options options = options_of(which ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD, 1);
        yc_chol_statistics stats;
        yc_chol *chol = NULL;
        int order = 7;
        CHECK_RESULT(yc_chol_analyze(NULL, 1, ptr, col, &options, &chol), YC_OK);
        CHECK(yc_chol_order(chol, &order) == YC_OK && order == 0);
        for (k = 0; k < 3; k++) {
            yc_result expected = which ? indefinite[k] : spd[k];
            double x = 6.0;
            CHECK_RESULT(yc_chol_factor(chol, values + k), expected);
            CHECK(yc_chol_stats(chol, &stats) == YC_OK && stats.pivots == (expected == YC_OK) && stats.nonzeros == 1.0);
            if (expected == YC_OK) CHECK(yc_chol_solve(chol, &x, 1, 1) == YC_OK && x == 6.0 / values[k]);
            else CHECK(yc_chol_solve(chol, &x, 1, 1) == YC_ERROR_ARGUMENT && x == 6.0);
        }
        yc_chol_destroy(chol);
        CHECK_RESULT(yc_chol_analyze(NULL, 1, none, NULL, &options, &chol), YC_OK); /* no entry: zero */
        CHECK_RESULT(yc_chol_factor(chol, NULL), which ? YC_ERROR_SINGULAR : YC_ERROR_NOT_SPD);
        yc_chol_destroy(chol);
    }
}

TEST(direct_diagonal) {
    int which, block, i;
    for (which = 0; which < 2; which++)
        for (block = 1; block <= YCI_BLOCK_MAX; block++) {
            matrix m = matrix_open(DIAGONAL, 100, block);
            double *x = random_numbers(4, m.n), *y = random_numbers(4, m.n);
            yc_chol *chol;
            for (i = 0; i < m.n; i++)
                m.value[m.ptr[i + 1] - 1] = ldexp(1.0, i % 40 - 20) * (which && i % 3 ? -1.0 : 1.0);
            chol = factored(NULL, &m, which ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD);
            CHECK_RESULT(yc_chol_solve(chol, x, 1, m.n), YC_OK);
            for (i = 0; i < m.n; i++) y[i] /= m.value[m.ptr[i + 1] - 1];
            for (i = 0; i < m.n; i++) CHECK(fabs(x[i] - y[i]) <= 2.0 * DBL_EPSILON * fabs(y[i]));
            yc_chol_destroy(chol);
            free(x), free(y);
            matrix_close(&m);
        }
}

/* A dense matrix is one front without padding. */
TEST(direct_dense) {
    enum { N = 200, LARGE = 400 };
    matrix m = matrix_open(DENSE, N, 1);
    yc_chol_statistics stats;
    yc_chol *chol;
    int block;
    fill_dominant(&m, NULL, 4);
    chol = factored(NULL, &m, YC_CHOL_SPD);
    CHECK_RESULT(yc_chol_stats(chol, &stats), YC_OK);
    CHECK(stats.supernodes == 1 && stats.nonzeros == N * (N + 1) / 2 && stats.pivots == N && stats.shifted == 0);
    CHECK(fabs(stats.flops / (N * (double)N * N / 3.0) - 1.0) < 0.05);
    yc_chol_destroy(chol);
    for (block = 1; block <= YCI_BLOCK_MAX; block += block < 3 ? 2 : 5) {
        matrix_close(&m);
        m = matrix_open(DENSE, (block == 1 ? N : LARGE) / block, block);
        fill_dominant(&m, NULL, 4);
        CHECK_NEAR(solve_error(&m, YC_CHOL_SPD, 0), 0.0, 1e-15);
        CHECK_NEAR(solve_error(&m, YC_CHOL_QUASIDEFINITE, 0), 0.0, 1e-15);
    }
    matrix_close(&m);
}

/* Fronts of one, two, ... columns above rows of every number modulo a vector's: an arrow whose hub is a clique. */
TEST(direct_front_sizes) {
    int size, lone, i, k;
    for (size = 1; size <= 40; size += 1 + size / 12)
        for (lone = 0; lone <= 9; lone += 3) {
            matrix m = matrix_open(DENSE, size + lone, 1);
            fill_dominant(&m, NULL, 4);
            for (i = size; i < m.n; i++) /* the last ones are tied to the clique, not to each other */
                for (k = m.ptr[i]; k < m.ptr[i + 1]; k++)
                    if (m.col[k] >= size && m.col[k] < i) m.value[k] = 0.0;
            CHECK_NEAR(solve_error(&m, YC_CHOL_SPD, 0), 0.0, 1e-15);
            CHECK_NEAR(solve_error(&m, YC_CHOL_QUASIDEFINITE, 0), 0.0, 1e-15);
            matrix_close(&m);
        }
}

/* Several right-hand sides, further apart than they are long: no others are touched, all have the same error. */
TEST(direct_right_hand_sides) {
    static const int counts[] = {0, 1, 2, 3, 4, 5, 17};
    enum { SPARE = 5, MOST = 17 };
    int which, level;
    size_t c;
    for (which = 0; which < 2; which++) {
        yc_chol_kind kind = which ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD;
        matrix m = matrix_open(GRID, 225, 3);
        yc_chol *chol;
        int ldx = m.n + SPARE, i, k;
        double *b = random_numbers(4, MOST * ldx + SPARE), *x = random_numbers(4, MOST * ldx + SPARE);
        double *work;
        fill_dominant(&m, NULL, 3);
        chol = factored(NULL, &m, kind);
        work = (double *)malloc(yc_chol_work(chol) * sizeof(double));
        for (level = 0; level < YCI_LEVELS; level++)
            for (c = 0; c < sizeof counts / sizeof counts[0]; c++) {
                if (!(chol->ldl->kernels = yci_kernels_of(level))) continue;
                memcpy(x, b, (size_t)(MOST * ldx + SPARE) * sizeof(double));
                if (c % 2) CHECK_RESULT(yc_chol_solve(chol, x + SPARE, counts[c], ldx), YC_OK);
                else CHECK_RESULT(yc_chol_solve_with(chol, x + SPARE, counts[c], ldx, work), YC_OK);
                for (k = 0; k < counts[c]; k++)
                    CHECK_NEAR(backward_error(&m, b + k * ldx + SPARE, x + k * ldx + SPARE, 0), 0.0, 1e-15);
                for (i = 0; i < MOST * ldx + SPARE; i++)
                    if (i % ldx < SPARE || i >= counts[c] * ldx) CHECK(x[i] == b[i]);
            }
        yc_chol_destroy(chol);
        free(b), free(x), free(work);
        matrix_close(&m);
    }
}

/* Lower and full patterns give the same bits, and what stands above the diagonal is not read. */
TEST(direct_lower_or_full) {
    int which, block;
    for (which = 0; which < 2; which++)
        for (block = 1; block <= YCI_BLOCK_MAX; block++) {
            yc_chol_kind kind = which ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD;
            matrix m = matrix_open(GRID, 144, block), full;
            double *x = random_numbers(4, m.n), *y = random_numbers(4, m.n), *b = random_numbers(4, m.n);
            double error[2] = {1.0, 2.0};
            yc_chol *lower, *other;
            fill_dominant(&m, NULL, 3);
            full = matrix_full(&m, NAN);
            lower = factored(NULL, &m, kind), other = factored(NULL, &full, kind);
            CHECK(factor_bits(lower) == factor_bits(other));
            CHECK(yc_chol_solve(lower, x, 1, m.n) == YC_OK && yc_chol_solve(other, y, 1, m.n) == YC_OK);
            CHECK(memcmp(x, y, (size_t)m.n * sizeof(double)) == 0);
            CHECK_RESULT(yc_chol_refine(lower, m.ptr, m.col, m.value, b, x, 2, &error[0], NULL), YC_OK);
            CHECK_RESULT(yc_chol_refine(other, full.ptr, full.col, full.value, b, y, 2, &error[1], NULL), YC_OK);
            CHECK(memcmp(x, y, (size_t)m.n * sizeof(double)) == 0 && error[0] == error[1] && error[0] < 1e-15);
            yc_chol_destroy(lower), yc_chol_destroy(other);
            free(x), free(y), free(b);
            matrix_close(&m), matrix_close(&full);
        }
}

/* A pattern with holes inside its nodes, k on the diagonal. One that is missing, for k = 0, counts as zero. */
static void holes(double k) {
    static const int ptr[] = {0, 1, 3, 5, 8}, col[] = {0, 0, 1, 0, 2, 1, 2, 3};
    static const int ptr0[] = {0, 0, 1, 2, 4}, col0[] = {0, 0, 1, 2}; /* without its diagonal */
    const double values[] = {k, 2.0, k, 3.0, k, 4.0, 5.0, k}, values0[] = {2.0, 3.0, 4.0, 5.0};
    const double a[4][4] = {{k, 2, 3, 0}, {2, k, 0, 4}, {3, 0, k, 5}, {0, 4, 5, k}};
    yc_chol_options options = options_of(YC_CHOL_QUASIDEFINITE, 2);
    yc_chol *chol = NULL;
    double x[4] = {1.0, -2.0, 3.0, 0.5}, b[4] = {1.0, -2.0, 3.0, 0.5};
    int i, j;
    CHECK_RESULT(yc_chol_analyze(NULL, 4, k == 0.0 ? ptr0 : ptr, k == 0.0 ? col0 : col, &options, &chol), YC_OK);
    CHECK_RESULT(yc_chol_factor(chol, k == 0.0 ? values0 : values), YC_OK);
    CHECK_RESULT(yc_chol_solve(chol, x, 1, 4), YC_OK);
    for (i = 0; i < 4; i++) {
        for (j = 0; j < 4; j++) b[i] -= a[i][j] * x[j];
        CHECK(fabs(b[i]) < 1e-14);
    }
    yc_chol_destroy(chol);
    CHECK_RESULT(yc_chol_analyze(NULL, 4, ptr0, col0, NULL, &chol), YC_OK);
    CHECK(yc_chol_factor(chol, values0) == YC_ERROR_NOT_SPD && strstr(yc_chol_message(chol), "pivot 0 of 4"));
    yc_chol_destroy(chol);
}

TEST(direct_holes) { holes(-1.0); }

TEST(direct_no_diagonal) { holes(0.0); }

/* Nodes whose later row reaches further left than the first, with as many entries as a whole block would give. */
TEST(direct_hole_left) {
    static const int ptr[] = {0, 1, 3, 4, 6}, col[] = {0, 0, 1, 2, 0, 3};
    static const double values[] = {4.0, 1.0, 4.0, 4.0, 1.0, 4.0};
    yc_chol_options options = options_of(YC_CHOL_SPD, 2);
    yc_chol *chol = NULL;
    double x[4] = {6.0, 9.0, 12.0, 17.0};
    CHECK_RESULT(yc_chol_analyze(NULL, 4, ptr, col, &options, &chol), YC_OK);
    CHECK_RESULT(yc_chol_factor(chol, values), YC_OK);
    CHECK_RESULT(yc_chol_solve(chol, x, 1, 4), YC_OK);
    CHECK_NEAR(4.0 * x[0] + x[1] + x[3], 6.0, 1e-14);
    CHECK_NEAR(x[0] + 4.0 * x[1], 9.0, 1e-14);
    CHECK_NEAR(4.0 * x[2], 12.0, 1e-14);
    CHECK_NEAR(x[0] + 4.0 * x[3], 17.0, 1e-14);
    yc_chol_destroy(chol);
}

/* ---- order ------------------------------------------------------------------------------------------------------- */

/* The order that was chosen, given back, makes the same factor; any order gives the solution. */
TEST(direct_order) {
    int which, shape;
    for (which = 0; which < 2; which++)
        for (shape = 0; shape < SHAPES; shape++) {
            yc_chol_kind kind = which ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD;
            int nodes = shape == DENSE ? 50 : 400, block = 1 + shape % 4, i, j, k;
            matrix m = matrix_open(shape, nodes, block);
            yc_chol_options options = options_of(kind, block);
            yc_chol_statistics stats[2];
            yc_chol *chol, *again = NULL;
            int *order = (int *)calloc((size_t)nodes, sizeof(int)), *seen = (int *)calloc((size_t)nodes, sizeof(int));
            double *x = random_numbers(4, m.n), *y = random_numbers(4, m.n);
            uint64_t seed = 31;
            fill_dominant(&m, NULL, 3);
            chol = factored(NULL, &m, kind);
            CHECK_RESULT(yc_chol_order(chol, order), YC_OK);
            for (i = 0; i < nodes; i++) CHECK(order[i] >= 0 && order[i] < nodes && !seen[order[i]]++);
            options.order = order;
            CHECK_RESULT(yc_chol_analyze(NULL, m.n, m.ptr, m.col, &options, &again), YC_OK);
            CHECK(yc_chol_stats(chol, &stats[0]) == YC_OK && yc_chol_stats(again, &stats[1]) == YC_OK);
            CHECK_NEAR(stats[1].nonzeros / stats[0].nonzeros, 1.0, 0.05); /* but for the padding of supernodes */
            CHECK_RESULT(yc_chol_factor(again, m.value), YC_OK);
            CHECK(yc_chol_solve(chol, x, 1, m.n) == YC_OK && yc_chol_solve(again, y, 1, m.n) == YC_OK);
            CHECK_NEAR_ALL(x, y, m.n, 1e-14);
            yc_chol_destroy(again);
            for (i = nodes - 1; i > 0; i--)
                j = test_random_int(&seed, i + 1), k = order[i], order[i] = order[j], order[j] = k;
            CHECK_RESULT(yc_chol_analyze(NULL, m.n, m.ptr, m.col, &options, &again), YC_OK);
            free(y), y = random_numbers(4, m.n);
            CHECK(yc_chol_factor(again, m.value) == YC_OK && yc_chol_solve(again, y, 1, m.n) == YC_OK);
            CHECK_NEAR_ALL(x, y, m.n, 1e-14);
            yc_chol_destroy(chol), yc_chol_destroy(again);
            free(order), free(seen), free(x), free(y);
            matrix_close(&m);
        }
}

static void keep_log(void *user, const char *text) { snprintf((char *)user, YC_MESSAGE_SIZE, "%s", text); }

TEST(direct_order_refused) {
    static const int wrong[][4] = {{0, 1, 2, 4}, {0, 1, 2, -1}, {0, 1, 1, 3}, {3, 2, 1, 3}, {INT_MAX, 0, 1, 2}};
    static const char *words[] = {
        "entry 3 is 4", "entry 3 is -1", "entry 2 is 1", "entry 3 is 3", "entry 0 is 2147483647"};
    matrix m = matrix_open(CHAIN, 4, 2);
    yc_chol_options options = options_of(YC_CHOL_SPD, 2);
    char text[YC_MESSAGE_SIZE];
    yc_host host = test_host_counting();
    int k;
    host.user = text, host.log = keep_log;
    for (k = 0; k < 5; k++) {
        yc_chol *chol = (yc_chol *)&m;
        options.order = wrong[k], text[0] = 0;
        CHECK_RESULT(yc_chol_analyze(&host, m.n, m.ptr, m.col, &options, &chol), YC_ERROR_ARGUMENT);
        CHECK(!chol && strstr(text, words[k]) && test_heap.live == 0);
    }
    matrix_close(&m);
}

/* Neighbours of a lower stage come first, and an order by stages throughout has the same factor: what is told is that
 * order but for the sequence of parts that do not touch. */
TEST(direct_stage) {
    enum { NODES = 400 };
    static int stage[NODES], order[NODES], place[NODES], sorted[NODES];
    int block, i, k, wrong, count;
    for (block = 1; block <= 3; block += 2) {
        matrix m = matrix_open(GRID, NODES, block);
        yc_chol_options options = options_of(YC_CHOL_SPD, block);
        yc_chol_statistics stats[2];
        yc_chol *chol = NULL;
        for (i = 0; i < NODES; i++) stage[i] = i * 7 % 5 == 0;
        options.stage = stage;
        CHECK_RESULT(yc_chol_analyze(NULL, m.n, m.ptr, m.col, &options, &chol), YC_OK);
        CHECK(yc_chol_order(chol, order) == YC_OK && yc_chol_stats(chol, &stats[0]) == YC_OK);
        yc_chol_destroy(chol), chol = NULL;
        for (i = 0; i < NODES; i++) place[order[i]] = i;
        for (wrong = 0, i = 0; i < m.n; i++)
            for (k = m.ptr[i]; k < m.ptr[i + 1]; k++) {
                int p = i / block, q = m.col[k] / block;
                wrong += (stage[p] - stage[q]) * (place[p] - place[q]) < 0;
            }
        CHECK_NEAR(wrong, 0.0, 0.0);
        for (count = 0, k = 0; k < 2; k++)
            for (i = 0; i < NODES; i++)
                if (stage[order[i]] == k) sorted[count++] = order[i];
        options.stage = NULL, options.order = sorted;
        CHECK_RESULT(yc_chol_analyze(NULL, m.n, m.ptr, m.col, &options, &chol), YC_OK);
        CHECK_RESULT(yc_chol_stats(chol, &stats[1]), YC_OK);
        CHECK_NEAR(stats[1].nonzeros / stats[0].nonzeros, 1.0, 0.05);
        yc_chol_destroy(chol), chol = NULL;
        matrix_close(&m);
    }
}

TEST(direct_stage_refused) {
    static const int stage[] = {0, 1, -1, 0};
    matrix m = matrix_open(CHAIN, 4, 2);
    yc_chol_options options = options_of(YC_CHOL_SPD, 2);
    yc_chol *chol = NULL;
    options.stage = stage;
    CHECK_RESULT(yc_chol_analyze(NULL, m.n, m.ptr, m.col, &options, &chol), YC_ERROR_ARGUMENT);
    yc_chol_destroy(chol);
    matrix_close(&m);
}

/* ---- matrices without a factor ----------------------------------------------------------------------------------- */

/* How many leading unknowns, in the order given, make a positive definite matrix. */
static int definite_part(const matrix *m, const int *unknown) {
    int n = m->n, i, j, k;
    long double *a = (long double *)calloc((size_t)n * (size_t)n + 1, sizeof(long double));
    int *place = (int *)malloc((size_t)n * sizeof(int) + 1);
    for (i = 0; i < n; i++) place[unknown[i]] = i;
    for (i = 0; i < n; i++)
        for (k = m->ptr[i]; k < m->ptr[i + 1]; k++)
            a[place[i] * n + place[m->col[k]]] = a[place[m->col[k]] * n + place[i]] = m->value[k];
    for (k = 0; k < n && a[k * n + k] > 0.0L; k++)
        for (i = k + 1; i < n; i++) {
            long double l = a[i * n + k] / a[k * n + k];
            for (j = k + 1; l != 0.0L && j <= i; j++) a[i * n + j] = a[j * n + i] -= l * a[j * n + k];
        }
    free(a), free(place);
    return k;
}

/* The unknown and the pivot that the last failure names, against statistics and order; returns the pivot. */
static int named_pivot(const yc_chol *chol, int *unknown) {
    int named = -1, pivot = -1, of = -1, k, a, n = chol->n, b = chol->block;
    int *order = (int *)malloc((size_t)n * sizeof(int) + 1);
    const char *at = strstr(yc_chol_message(chol), "at unknown ");
    yc_chol_statistics stats;
    CHECK(at && sscanf(at, "at unknown %d, pivot %d of %d", &named, &pivot, &of) == 3);
    CHECK(yc_chol_stats(chol, &stats) == YC_OK && stats.pivots == pivot && of == n && pivot >= 0 && pivot < n);
    CHECK_RESULT(yc_chol_order(chol, order), YC_OK);
    for (k = 0; k < n / b; k++)
        for (a = 0; a < b; a++) unknown[k * b + a] = order[k] * b + a;
    if (pivot >= 0 && pivot < n) CHECK(unknown[pivot] == named);
    free(order);
    return pivot;
}

/* One diagonal entry or another made too small: the column that fails is the first one that must. */
TEST(direct_not_definite) {
    static const int shapes[] = {GRID, ARROW, PARTS};
    int block, trial, level;
    for (block = 1; block <= 5; block += 2)
        for (trial = 0; trial < 12; trial++) {
            matrix m = matrix_open(shapes[trial % 3], 100 / block, block);
            int *unknown = (int *)malloc((size_t)m.n * sizeof(int)), at, i;
            uint64_t seed = (uint64_t)trial;
            double *x = random_numbers(3, m.n), *y = random_numbers(3, m.n), keep, small;
            yc_chol *chol = analyzed(NULL, &m, YC_CHOL_SPD);
            fill_dominant(&m, NULL, 5);
            at = test_random_int(&seed, m.n);
            keep = m.value[m.ptr[at + 1] - 1], small = keep * (trial < 6 ? 1e-3 : -0.1);
            for (level = 0; level < YCI_LEVELS; level++) {
                int part;
                if (!(chol->ldl->kernels = yci_kernels_of(level))) continue;
                m.value[m.ptr[at + 1] - 1] = keep;
                CHECK_RESULT(yc_chol_factor(chol, m.value), YC_OK);
                m.value[m.ptr[at + 1] - 1] = small;
                if (yc_chol_factor(chol, m.value) == YC_OK) { /* an unknown that is on its own */
                    for (i = 0; i < m.n; i++) unknown[i] = i;
                    CHECK(small > 0.0 && definite_part(&m, unknown) == m.n);
                    continue;
                }
                CHECK_RESULT(yc_chol_factor(chol, m.value), YC_ERROR_NOT_SPD);
                part = named_pivot(chol, unknown);
                CHECK(definite_part(&m, unknown) == part);
                CHECK_RESULT(yc_chol_solve(chol, x, 1, m.n), YC_ERROR_ARGUMENT);
                CHECK_RESULT(yc_chol_refine(chol, m.ptr, m.col, m.value, y, x, 1, NULL, NULL), YC_ERROR_ARGUMENT);
                for (i = 0; i < m.n; i++) CHECK(x[i] == y[i]);
            }
            yc_chol_destroy(chol);
            free(unknown), free(x), free(y);
            matrix_close(&m);
        }
}

/* A pivot that cancels is lost above 64 units of rounding of its diagonal, and not much below. */
TEST(direct_lost_pivot) {
    static const int ptr[] = {0, 1, 3}, col[] = {0, 0, 1};
    static const int order[] = {0, 1};
    int which, scale;
    for (which = 0; which < 2; which++)
        for (scale = -900; scale <= 900; scale += 300) {
            yc_chol_options options = options_of(which ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD, 1);
            yc_chol *chol = NULL;
            double values[3] = {1.0, 1.0, 1.0}, least;
            int k;
            options.order = order;
            CHECK_RESULT(yc_chol_analyze(NULL, 2, ptr, col, &options, &chol), YC_OK);
            for (k = 0; k < 3; k++) values[k] = ldexp(1.0, scale);
            for (least = 1.0; least > DBL_EPSILON; least *= 0.5) {
                values[2] = ldexp(1.0 + 0.5 * least, scale);
                if (yc_chol_factor(chol, values) != YC_OK) break;
            }
            CHECK(least < 1e-12 && least > 1e-15);
            CHECK_RESULT(yc_chol_factor(chol, values), which ? YC_ERROR_SINGULAR : YC_ERROR_NOT_SPD);
            CHECK(strstr(yc_chol_message(chol), "unknown 1, pivot 1 of 2") != NULL);
            yc_chol_destroy(chol);
        }
}

/* Free chains and grids: -1 between neighbours, their number on the diagonal. */
static void fill_free(matrix *m) {
    int i, k;
    memset(m->value, 0, (size_t)m->entries * sizeof(double));
    for (i = 0; i < m->n; i++)
        for (k = m->ptr[i]; k < m->ptr[i + 1]; k++)
            if (m->col[k] < i && m->col[k] % m->block == i % m->block)
                m->value[k] = -1.0, *entry(m, i, i) += 1.0, *entry(m, m->col[k], m->col[k]) += 1.0;
}

/* A singular matrix of the indefinite kind: the last unknown of a part is named, all before it are eliminated. */
TEST(direct_singular) {
    static const int shapes[] = {CHAIN, GRID, ARROW, DENSE, PARTS};
    int which, block, level;
    for (which = 0; which < 5; which++)
        for (block = 1; block <= 4; block++) {
            matrix m = matrix_open(shapes[which], 64, block);
            int *unknown = (int *)malloc((size_t)m.n * sizeof(int));
            yc_chol *chol = analyzed(NULL, &m, YC_CHOL_QUASIDEFINITE);
            fill_free(&m);
            for (level = 0; level < YCI_LEVELS; level++) {
                if (!(chol->ldl->kernels = yci_kernels_of(level))) continue;
                if (!CHECK_RESULT(yc_chol_factor(chol, m.value), YC_ERROR_SINGULAR)) break;
                CHECK(named_pivot(chol, unknown) == m.n - block || shapes[which] == PARTS);
            }
            yc_chol_destroy(chol);
            free(unknown);
            matrix_close(&m);
        }
}

/* ---- small factors in tiles -------------------------------------------------------------------------------------- */

/* A factor made with at most that many tiles. */
static yc_chol *factored_with(int limit, const yc_host *host, const matrix *m, yc_chol_kind kind) {
    yc_chol *chol;
    tile_limit = limit;
    chol = factored(host, m, kind);
    return chol;
}

/* Tiles are used as long as there are no more than the limit; nodes that a pair of rows does not hold whole are not for
 * them when D is made of blocks. */
TEST(direct_tiles_limit) {
    int which, block, tiles;
    for (which = 0; which < 2; which++)
        for (block = 1; block <= 3; block++) {
            yc_chol_kind kind = which ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD;
            matrix m = matrix_open(GRID, 225, block);
            yc_chol *chol;
            fill_dominant(&m, NULL, 3);
            chol = factored_with(2500, NULL, &m, kind);
            CHECK(chol->ldl->tiled == (!which || block <= 2) && (chol->ldl->tiles.blocks > 0) == chol->ldl->tiled);
            tiles = chol->ldl->tiled ? chol->ldl->tiles.begin[chol->ldl->tiles.blocks] : 2;
            CHECK(tiles == 2 || (tiles > m.n / YCI_PANEL && YCI_TILE * tiles > chol->ldl->nonzeros));
            yc_chol_destroy(chol);
            chol = factored_with(tiles, NULL, &m, kind);
            CHECK(chol->ldl->tiled == (tiles > 2));
            yc_chol_destroy(chol);
            chol = factored_with(tiles - 1, NULL, &m, kind);
            CHECK(!chol->ldl->tiled);
            yc_chol_destroy(chol);
            matrix_close(&m);
        }
}

/* Tiles and fronts give the same solutions, of any width and shape, and each of them the same bits for a right-hand
 * side whatever stands beside it. */
TEST(direct_tiles_solutions) {
    enum { MOST = 9 };
    int shape, block, which, level, count, k, limit = tile_limit;
    for (shape = 0; shape < SHAPES; shape++)
        for (block = 1; block <= YCI_BLOCK_MAX; block++)
            for (which = 0; which < (block <= 2 ? 2 : 1); which++) {
                yc_chol_kind kind = which ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD;
                matrix m = matrix_open(shape, 21 + 4 * shape, block);
                size_t bytes = (size_t)m.n * sizeof(double);
                double *b = random_numbers(4, MOST * m.n), *x = random_numbers(4, MOST * m.n);
                double *y = random_numbers(4, MOST * m.n);
                yc_chol *chol, *fronts;
                fill_dominant(&m, NULL, 3);
                chol = factored_with(limit, NULL, &m, kind), fronts = factored_with(0, NULL, &m, kind);
                CHECK_RESULT(yc_chol_solve(fronts, y, MOST, m.n), YC_OK);
                tile_limit = limit;
                for (level = 0; level < YCI_LEVELS; level++) {
                    if (!(chol->ldl->kernels = yci_kernels_of(level))) continue;
                    memcpy(x, b, MOST * bytes);
                    CHECK(yc_chol_factor(chol, m.value) == YC_OK && chol->ldl->tiled == (limit > 0));
                    for (k = 0; k < MOST; k++) CHECK_RESULT(yc_chol_solve(chol, x + k * m.n, 1, m.n), YC_OK);
                    CHECK_NEAR_ALL(x, y, MOST * m.n, 1e-13);
                    for (count = 2; count <= MOST; count++) {
                        double *z = random_numbers(4, MOST * m.n);
                        CHECK_RESULT(yc_chol_solve(chol, z, count, m.n), YC_OK);
                        CHECK(memcmp(x, z, (size_t)count * bytes) == 0);
                        free(z);
                    }
                }
                yc_chol_destroy(chol), yc_chol_destroy(fronts);
                free(b), free(x), free(y);
                matrix_close(&m);
            }
}

/* A matrix of four unknowns in one tile, by rows of its lower triangle, scaled by 2^exponent in rows and columns. */
static yc_chol *one_tile(matrix *m, const double *values, const int *exponent, yc_chol_kind kind) {
    static const int order[] = {0, 1, 2, 3};
    yc_chol_options options = options_of(kind, 1);
    yc_chol *chol = NULL;
    int i, k;
    *m = matrix_open(DENSE, 4, 1);
    for (i = 0; i < 4; i++)
        for (k = m->ptr[i]; k < m->ptr[i + 1]; k++) m->value[k] = ldexp(values[k], exponent[i] + exponent[m->col[k]]);
    options.order = order;
    CHECK_RESULT(yc_chol_analyze(NULL, 4, m->ptr, m->col, &options, &chol), YC_OK);
    return chol;
}

/* A tile whose condition is too much goes to the fronts, and so does one in which a pair is nearly singular by itself,
 * though those behind it make up for that. */
TEST(direct_tiles_ill_conditioned) {
    static const double pair[] = {1.0, -1.0, 1.00000001, 0.5, 1.0, -1.0, 1.0, 0.25, 0.5, -1.0};
    static const int none[4] = {0, 0, 0, 0};
    int which, level, limit = tile_limit;
    for (which = 0; which < 2; which++) {
        yc_chol_kind kind = which ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD;
        matrix m = matrix_open(GRID, 225, 1), small;
        yc_chol *chol;
        fill_springs(&m, 3);
        chol = factored(NULL, &m, kind);
        CHECK((chol->ldl->tiles.blocks > 0) == (limit > 0) && !chol->ldl->tiled);
        CHECK_NEAR(solve_error(&m, kind, 0), 0.0, 2e-15);
        yc_chol_destroy(chol);
        chol = one_tile(&small, pair, none, YC_CHOL_QUASIDEFINITE);
        for (level = 0; level < YCI_LEVELS; level++) {
            double b[4] = {1.0, -2.0, 3.0, 0.5}, x[4] = {1.0, -2.0, 3.0, 0.5};
            if (!(chol->ldl->kernels = yci_kernels_of(level))) continue;
            CHECK(yc_chol_factor(chol, small.value) == YC_OK && !chol->ldl->tiled);
            CHECK_RESULT(yc_chol_solve(chol, x, 1, 4), YC_OK);
            CHECK_NEAR(backward_error(&small, b, x, 0), 0.0, 1e-8);
        }
        yc_chol_destroy(chol);
        matrix_close(&m), matrix_close(&small);
    }
}

/* A chain of springs on a weak ground, whose tiles have inverses that are not accurate enough and are refined. */
TEST(direct_tiles_refined) {
    int which, k, refined = 0;
    for (which = 0; which < 2; which++) {
        yc_chol_kind kind = which ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD;
        matrix m = matrix_open(CHAIN, 200, 1);
        yc_chol *chol;
        for (k = 0; k < m.n; k++) *entry(&m, k, k) = 2.01, k ? *entry(&m, k, k - 1) = -1.0 : 0.0;
        chol = factored(NULL, &m, kind);
        if (tile_limit && !which) CHECK(chol->ldl->tiled);
        for (k = 0; chol->ldl->tiled && k < chol->ldl->tiles.blocks; k++) refined += chol->ldl->tiles.refine[k];
        CHECK_NEAR(solve_error(&m, kind, 1), 0.0, 4e-16);
        yc_chol_destroy(chol);
        matrix_close(&m);
    }
    CHECK((refined > 0) == (tile_limit > 0));
}

/* Rows and columns of one tile from 2^-500 to 2^100: products of three entries underflow, and the solution is the same
 * to the last bit, but for its exponents. */
TEST(direct_tiles_wide) {
    static const double values[] = {2.0, 0.5, 3.0, 1.0, -0.25, 2.5, 0.75, -1.0, 0.5, 4.0};
    static const int none[4] = {0, 0, 0, 0}, wide[4] = {-230, -230, 100, -500};
    int which, level, i;
    for (which = 0; which < 2; which++) {
        yc_chol_kind kind = which ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD;
        matrix m, scaled;
        yc_chol *chol = one_tile(&m, values, none, kind), *other = one_tile(&scaled, values, wide, kind);
        for (level = 0; level < YCI_LEVELS; level++) {
            double x[4] = {1.0, -2.0, 3.0, 0.5}, y[4] = {1.0, -2.0, 3.0, 0.5};
            if (!(chol->ldl->kernels = other->ldl->kernels = yci_kernels_of(level))) continue;
            CHECK(yc_chol_factor(chol, m.value) == YC_OK && yc_chol_factor(other, scaled.value) == YC_OK);
            CHECK(chol->ldl->tiled == (tile_limit > 0) && other->ldl->tiled == chol->ldl->tiled);
            for (i = 0; i < 4; i++) y[i] = ldexp(y[i], wide[i]);
            CHECK(yc_chol_solve(chol, x, 1, 4) == YC_OK && yc_chol_solve(other, y, 1, 4) == YC_OK);
            for (i = 0; i < 4; i++) y[i] = ldexp(y[i], wide[i]);
            CHECK_NEAR_ALL(x, y, 4, tile_limit ? 0.0 : 1e-15);
        }
        yc_chol_destroy(chol), yc_chol_destroy(other);
        matrix_close(&m), matrix_close(&scaled);
    }
}

/* One object goes from tiles to fronts, to a failure and back, without an allocation after the first time; what it
 * refuses it refuses in the words of one that has only fronts. */
TEST(direct_tiles_in_turn) {
    int which, block, round, k, limit = tile_limit;
    for (which = 0; which < 2; which++)
        for (block = 1; block <= 2; block++) {
            yc_chol_kind kind = which ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD;
            yc_host host = test_host_counting();
            matrix m[3];
            yc_chol *chol, *fronts;
            uint64_t bits[2] = {0, 0};
            int calls;
            for (k = 0; k < 3; k++) m[k] = matrix_open(GRID, 225, block);
            fill_dominant(&m[0], NULL, 3), fill_springs(&m[1], 3), fill_dominant(&m[2], NULL, 5);
            if (which) fill_free(&m[2]);
            else *entry(&m[2], 40, 40) *= 1e-3;
            fronts = factored_with(0, NULL, &m[0], kind);
            CHECK(yc_chol_factor(fronts, m[2].value) != YC_OK);
            chol = factored_with(limit, &host, &m[0], kind), calls = test_heap.calls;
            for (round = 0; round < 3; round++)
                for (k = 0; k < 3; k++) {
                    yc_result expected = k < 2 ? YC_OK : which ? YC_ERROR_SINGULAR : YC_ERROR_NOT_SPD;
                    double *b = random_numbers(6, m[k].n), *x = random_numbers(6, m[k].n);
                    CHECK_RESULT(yc_chol_factor(chol, m[k].value), expected);
                    CHECK(chol->ldl->tiled == (k == 0 && limit > 0));
                    if (k == 2) CHECK_TEXT(yc_chol_message(chol), yc_chol_message(fronts));
                    CHECK_RESULT(yc_chol_solve(chol, x, 1, m[k].n), k < 2 ? YC_OK : YC_ERROR_ARGUMENT);
                    if (k == 0) CHECK_NEAR(backward_error(&m[k], b, x, 0), 0.0, 1e-15);
                    if (k < 2 && round == 0) bits[k] = factor_bits(chol);
                    if (k < 2) CHECK(factor_bits(chol) == bits[k]);
                    free(b), free(x);
                }
            CHECK(test_heap.calls == calls);
            yc_chol_destroy(chol), yc_chol_destroy(fronts);
            for (k = 0; k < 3; k++) matrix_close(&m[k]);
        }
}

/* ---- shift and refinement ---------------------------------------------------------------------------------------- */

static yc_chol *shifted(const matrix *m, double shift) {
    yc_chol_options options = options_of(YC_CHOL_QUASIDEFINITE, m->block);
    yc_chol *chol = NULL;
    options.shift = shift;
    CHECK_RESULT(yc_chol_analyze(NULL, m->n, m->ptr, m->col, &options, &chol), YC_OK);
    CHECK_RESULT(yc_chol_factor(chol, m->value), YC_OK);
    return chol;
}

static int shifts(const yc_chol *chol) {
    yc_chol_statistics stats;
    CHECK_RESULT(yc_chol_stats(chol, &stats), YC_OK);
    return stats.shifted;
}

/* A free part has one pivot without an inverse, which the shift replaces; for right-hand sides in the range of the
 * matrix the solution is one of its own. */
TEST(direct_shift_singular) {
    static const int shapes[] = {CHAIN, GRID, ARROW, DENSE};
    int which, block, i;
    for (which = 0; which < 4; which++)
        for (block = 1; block <= 5; block++) {
            matrix m = matrix_open(shapes[which], 64, block);
            double *x = random_numbers(6, m.n), *b = random_numbers(5, m.n), *y = random_numbers(5, m.n), error = 1.0;
            yc_chol *chol;
            fill_free(&m);
            chol = shifted(&m, 1.0);
            CHECK(shifts(chol) == 1);
            for (i = 0; i < m.n; i++) x[i] = floor(8.0 * x[i]);
            multiply(&m, x, b);
            for (i = 0; i < m.n; i++) y[i] = b[i];
            CHECK_RESULT(yc_chol_solve(chol, y, 1, m.n), YC_OK);
            CHECK_NEAR(backward_error(&m, b, y, 0), 0.0, 1e-14);
            CHECK_RESULT(yc_chol_refine(chol, m.ptr, m.col, m.value, b, y, 3, &error, NULL), YC_OK);
            CHECK_NEAR(error, 0.0, 4e-15);
            *entry(&m, 0, 0) += 1.0; /* now regular in the first unknown of each node */
            for (i = 1; i < block; i++) *entry(&m, i, i) += 1.0;
            CHECK(yc_chol_factor(chol, m.value) == YC_OK && shifts(chol) == 0);
            yc_chol_destroy(chol);
            free(x), free(b), free(y);
            matrix_close(&m);
        }
}

/* Zeros on the diagonal that are eliminated first, of a regular matrix: the factor is that of a shifted one, and
 * refinement finds the solution of the one that was given. */
TEST(direct_shift_regular) {
    enum { N = 400, ZEROS = 5 };
    static const double shift[] = {1e-2, 1e-4, 1e-6};
    static int order[N];
    int k, i, last;
    for (i = 0, k = ZEROS; i < N; i++) order[i % 83 ? k++ : i / 83] = i;
    for (k = 0; k < 3; k++) {
        matrix m = matrix_open(GRID, N, 1);
        double *b = random_numbers(5, m.n), *x = random_numbers(5, m.n), before = 0.0, after = 1.0;
        yc_chol_options options = options_of(YC_CHOL_QUASIDEFINITE, 1);
        yc_chol *chol = NULL;
        fill_dominant(&m, NULL, 4);
        for (i = 0; i < m.n; i += 83) *entry(&m, i, i) = 0.0;
        options.order = order;
        CHECK_RESULT(yc_chol_analyze(NULL, m.n, m.ptr, m.col, &options, &chol), YC_OK);
        CHECK_RESULT(yc_chol_factor(chol, m.value), YC_ERROR_SINGULAR);
        yc_chol_destroy(chol), chol = NULL;
        options.shift = shift[k];
        CHECK_RESULT(yc_chol_analyze(NULL, m.n, m.ptr, m.col, &options, &chol), YC_OK);
        CHECK(yc_chol_factor(chol, m.value) == YC_OK && shifts(chol) == ZEROS);
        CHECK_RESULT(yc_chol_solve(chol, x, 1, m.n), YC_OK);
        CHECK_RESULT(yc_chol_refine(chol, m.ptr, m.col, m.value, b, x, 0, &before, NULL), YC_OK);
        CHECK(before > 1e-4 * shift[k] && before < shift[k]);
        CHECK_NEAR(before / backward_error(&m, b, x, 0), 1.0, 1e-3);
        for (last = 0; last < 20 && after > 2e-16; last++)
            CHECK_RESULT(yc_chol_refine(chol, m.ptr, m.col, m.value, b, x, 1, &after, NULL), YC_OK);
        CHECK(last < 10);
        CHECK_NEAR(backward_error(&m, b, x, 0), 0.0, 5e-16);
        yc_chol_destroy(chol);
        free(b), free(x);
        matrix_close(&m);
    }
}

/* Every step at least halves the error or is not taken; none of them leaves x as it is. */
TEST(direct_refine) {
    int which, steps, i, k;
    for (which = 0; which < 2; which++) {
        matrix m = matrix_open(GRID, 400, 3), near = matrix_open(GRID, 400, 3);
        double *b = random_numbers(5, m.n), *x = random_numbers(5, m.n), *y = random_numbers(5, m.n), last, error = 0.0;
        yc_chol *chol;
        double *work;
        fill_dominant(&m, NULL, 3);
        for (i = 0; i < m.n; i++)
            for (k = m.ptr[i]; k < m.ptr[i + 1]; k++) near.value[k] = m.value[k] * (1.0 + 1e-4 * ((i + m.col[k]) % 3));
        chol = factored(NULL, &near, which ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD); /* of another matrix */
        work = (double *)malloc(yc_chol_work(chol) * sizeof(double));
        CHECK_RESULT(yc_chol_solve(chol, x, 1, m.n), YC_OK);
        memcpy(y, x, (size_t)m.n * sizeof(double));
        CHECK_RESULT(yc_chol_refine(chol, m.ptr, m.col, m.value, b, x, 0, &last, work), YC_OK);
        CHECK(memcmp(x, y, (size_t)m.n * sizeof(double)) == 0 && last > 1e-6);
        CHECK_NEAR(last / backward_error(&m, b, x, 0), 1.0, 1e-6);
        for (steps = 1; steps <= 3; steps++, last = error) { /* each from the same start */
            memcpy(x, y, (size_t)m.n * sizeof(double));
            CHECK_RESULT(
                yc_chol_refine(chol, m.ptr, m.col, m.value, b, x, steps, &error, steps % 2 ? work : NULL), YC_OK);
            CHECK(error < 1e-2 * last);
            CHECK_NEAR(backward_error(&m, b, x, 0), error, 3e-16);
        }
        CHECK_RESULT(yc_chol_refine(chol, m.ptr, m.col, m.value, b, x, 50, &error, NULL), YC_OK);
        CHECK(error < 2e-16);
        memcpy(y, x, (size_t)m.n * sizeof(double));
        CHECK_RESULT(
            yc_chol_refine(chol, m.ptr, m.col, m.value, b, x, 50, NULL, NULL), YC_OK); /* nothing left to gain */
        CHECK(memcmp(x, y, (size_t)m.n * sizeof(double)) == 0);
        yc_chol_destroy(chol);
        free(b), free(x), free(y), free(work);
        matrix_close(&m), matrix_close(&near);
    }
}

/* What is no number in x makes no small error. */
TEST(direct_refine_not_finite) {
    matrix m = matrix_open(GRID, 100, 1);
    double *b = random_numbers(5, m.n), *x = random_numbers(5, m.n), error = 0.0;
    yc_chol *chol;
    int k, wrong = 0;
    fill_dominant(&m, NULL, 3);
    chol = factored(NULL, &m, YC_CHOL_SPD);
    CHECK_RESULT(yc_chol_solve(chol, x, 1, m.n), YC_OK);
    for (k = 0; k < m.n; k++) {
        double keep = x[k];
        x[k] = k % 2 ? NAN : INFINITY;
        CHECK_RESULT(yc_chol_refine(chol, m.ptr, m.col, m.value, b, x, 0, &error, NULL), YC_OK);
        wrong += error < 1e-3;
        x[k] = keep;
    }
    CHECK(wrong == 0);
    yc_chol_destroy(chol);
    free(b), free(x);
    matrix_close(&m);
}

/* ---- what is refused --------------------------------------------------------------------------------------------- */

/* Each index out of range, each row out of order, each half of a pair missing, on its own, says where. */
TEST(direct_patterns_refused) {
    matrix lower = matrix_open(GRID, 16, 1), m;
    char text[YC_MESSAGE_SIZE], words[96];
    yc_host host = test_host_counting();
    yc_chol *chol = NULL;
    int i, k, keep;
    host.user = text, host.log = keep_log;
    fill_dominant(&lower, NULL, 1);
    m = matrix_full(&lower, 0.0);
    for (k = 0; k < m.entries; k++) {
        static const int far[] = {INT_MIN, -1, 16, INT_MAX};
        keep = m.col[k];
        for (i = 0; i < 4; i++) {
            m.col[k] = far[i], text[0] = 0;
            CHECK(yc_chol_analyze(&host, m.n, m.ptr, m.col, NULL, &chol) == YC_ERROR_ARGUMENT && !chol);
            snprintf(words, sizeof words, "col[%d] is %d, n is 16", k, far[i]);
            CHECK(strstr(text, words) && test_heap.live == 0);
        }
        m.col[k] = keep;
    }
    for (i = 0; i < m.n; i++)
        for (k = m.ptr[i] + 1; k < m.ptr[i + 1]; k++) {
            keep = m.col[k], m.col[k] = m.col[k - 1], text[0] = 0;
            CHECK_RESULT(yc_chol_analyze(&host, m.n, m.ptr, m.col, NULL, &chol), YC_ERROR_ARGUMENT);
            snprintf(words, sizeof words, "row %d is not ascending: duplicate %d at col[%d]", i, m.col[k], k);
            CHECK(strstr(text, words) != NULL);
            m.col[k] = keep, keep = m.col[k - 1], m.col[k - 1] = m.col[k], m.col[k] = keep, text[0] = 0;
            CHECK_RESULT(yc_chol_analyze(&host, m.n, m.ptr, m.col, NULL, &chol), YC_ERROR_ARGUMENT);
            snprintf(words, sizeof words, "row %d is not ascending: unsorted %d at col[%d]", i, m.col[k], k);
            CHECK(strstr(text, words) != NULL);
            keep = m.col[k - 1], m.col[k - 1] = m.col[k], m.col[k] = keep;
        }
    for (i = 0; i < lower.n; i++) /* one entry above the diagonal of a lower pattern, after the diagonal */
        if (i % 4 < 3 && lower.ptr[i + 1] - lower.ptr[i] > 1) {
            k = lower.ptr[i + 1] - 1, keep = lower.col[k], lower.col[k] = i + 1;
            CHECK_RESULT(yc_chol_analyze(&host, lower.n, lower.ptr, lower.col, NULL, &chol), YC_ERROR_ARGUMENT);
            CHECK(strstr(text, "are not both there") != NULL);
            lower.col[k] = keep;
        }
    matrix_close(&lower), matrix_close(&m);
}

/* Beginnings of rows that do not ascend are found before a column is read: here the pattern has one entry only. */
TEST(direct_row_beginnings_refused) {
    static const int wrong[][3] = {{1, 1, 1}, {-1, 0, 1}, {0, -1, 1}, {0, 2, 1}, {0, 1, -1}};
    static const char *words[] = {
        "ptr[0] is 1", "ptr[0] is -1", "ptr[1] is -1, after 0", "ptr[2] is 1, after 2", "ptr[2] is -1, after 1"};
    static const int col[] = {0, 77, 77};
    char text[YC_MESSAGE_SIZE];
    yc_host host = test_host_counting();
    int k;
    host.user = text, host.log = keep_log;
    for (k = 0; k < 5; k++) {
        yc_chol *chol = NULL;
        text[0] = 0;
        CHECK_RESULT(yc_chol_analyze(&host, 2, wrong[k], col, NULL, &chol), YC_ERROR_ARGUMENT);
        CHECK(!chol && test_heap.live == 0);
        if (!strstr(text, words[k])) CHECK_TEXT(text, words[k]);
    }
}

TEST(direct_arguments_refused) {
    matrix m = matrix_open(CHAIN, 4, 3);
    char text[YC_MESSAGE_SIZE];
    yc_host host = test_host_counting(), half = test_host_counting();
    yc_chol_options options;
    yc_chol *chol = NULL;
    int k;
    host.user = text, host.log = keep_log;
    CHECK_RESULT(yc_chol_analyze(&host, m.n, m.ptr, m.col, NULL, NULL), YC_ERROR_ARGUMENT);
    CHECK(yc_chol_analyze(&host, -1, m.ptr, m.col, NULL, &chol) == YC_ERROR_ARGUMENT && strstr(text, "n is -1"));
    CHECK(yc_chol_analyze(&host, m.n, NULL, m.col, NULL, &chol) == YC_ERROR_ARGUMENT && strstr(text, "NULL"));
    CHECK(yc_chol_analyze(&host, m.n, m.ptr, NULL, NULL, &chol) == YC_ERROR_ARGUMENT && strstr(text, "NULL"));
    for (k = -1; k <= 10; k++) { /* blocks that do not divide n, or are too large */
        options = options_of(YC_CHOL_SPD, k), text[0] = 0;
        if (k >= 1 && k <= YCI_BLOCK_MAX && m.n % k == 0) continue;
        CHECK_RESULT(yc_chol_analyze(&host, m.n, m.ptr, m.col, &options, &chol), YC_ERROR_ARGUMENT);
        CHECK(!chol && strstr(text, "block is"));
    }
    for (k = -1; k < 5; k++) {
        options = options_of(YC_CHOL_SPD, 3), text[0] = 0;
        memcpy(&options.kind, &k, sizeof k);
        if (k == YC_CHOL_SPD || k == YC_CHOL_QUASIDEFINITE) continue;
        CHECK_RESULT(yc_chol_analyze(&host, m.n, m.ptr, m.col, &options, &chol), YC_ERROR_ARGUMENT);
        CHECK(!chol && strstr(text, "kind is"));
    }
    for (k = 0; k < 4; k++) {
        static const double wrong[] = {-1.0, NAN, INFINITY, -INFINITY};
        options = options_of(YC_CHOL_QUASIDEFINITE, 3), options.shift = wrong[k], text[0] = 0;
        CHECK_RESULT(yc_chol_analyze(&host, m.n, m.ptr, m.col, &options, &chol), YC_ERROR_ARGUMENT);
        CHECK(!chol && strstr(text, "shift is"));
    }
    for (k = 0; k < 2; k++) {
        half = host, text[0] = 0;
        if (k) half.alloc = NULL;
        else half.free = NULL;
        CHECK_RESULT(yc_chol_analyze(&half, m.n, m.ptr, m.col, NULL, &chol), YC_ERROR_ARGUMENT);
        CHECK(!chol && strstr(text, "both or neither"));
    }
    CHECK(test_heap.live == 0);
    matrix_close(&m);
}

/* Solves, refinement and questions with arguments out of range leave x alone; of NULL there is nothing to tell. */
TEST(direct_calls_refused) {
    matrix m = matrix_open(CHAIN, 4, 3);
    yc_chol_statistics stats;
    yc_chol *chol;
    double x[24], b[12], work[4096], error = 7.0;
    int order[4], i;
    for (i = 0; i < 24; i++) x[i] = i;
    memset(b, 0, sizeof b);
    fill_dominant(&m, NULL, 3);
    chol = analyzed(NULL, &m, YC_CHOL_SPD);
    CHECK(yc_chol_work(chol) <= 4096);
    CHECK_RESULT(yc_chol_solve(chol, x, 1, 12), YC_ERROR_ARGUMENT); /* no factor yet */
    CHECK_RESULT(yc_chol_refine(chol, m.ptr, m.col, m.value, b, x, 1, &error, NULL), YC_ERROR_ARGUMENT);
    CHECK_RESULT(yc_chol_factor(chol, NULL), YC_ERROR_ARGUMENT);
    CHECK(strstr(yc_chol_message(chol), "values is NULL") && yc_chol_factor(NULL, m.value) == YC_ERROR_ARGUMENT);
    CHECK_RESULT(yc_chol_factor(chol, m.value), YC_OK);
    CHECK(yc_chol_solve(NULL, x, 1, 12) == YC_ERROR_ARGUMENT && yc_chol_solve(chol, NULL, 1, 12) == YC_ERROR_ARGUMENT);
    CHECK(yc_chol_solve(chol, x, -1, 12) == YC_ERROR_ARGUMENT && yc_chol_solve(chol, x, 1, 11) == YC_ERROR_ARGUMENT);
    CHECK(yc_chol_solve(chol, x, 2, -12) == YC_ERROR_ARGUMENT && yc_chol_solve(chol, x, 0, 11) == YC_ERROR_ARGUMENT);
    CHECK(yc_chol_solve_with(chol, x, 1, 12, NULL) == YC_ERROR_ARGUMENT);
    CHECK(yc_chol_solve_with(NULL, x, 1, 12, work) == YC_ERROR_ARGUMENT);
    CHECK_RESULT(yc_chol_refine(NULL, m.ptr, m.col, m.value, b, x, 1, &error, NULL), YC_ERROR_ARGUMENT);
    CHECK_RESULT(yc_chol_refine(chol, NULL, m.col, m.value, b, x, 1, &error, NULL), YC_ERROR_ARGUMENT);
    CHECK_RESULT(yc_chol_refine(chol, m.ptr, NULL, m.value, b, x, 1, &error, NULL), YC_ERROR_ARGUMENT);
    CHECK_RESULT(yc_chol_refine(chol, m.ptr, m.col, NULL, b, x, 1, &error, NULL), YC_ERROR_ARGUMENT);
    CHECK_RESULT(yc_chol_refine(chol, m.ptr, m.col, m.value, NULL, x, 1, &error, NULL), YC_ERROR_ARGUMENT);
    CHECK_RESULT(yc_chol_refine(chol, m.ptr, m.col, m.value, b, NULL, 1, &error, NULL), YC_ERROR_ARGUMENT);
    CHECK_RESULT(yc_chol_refine(chol, m.ptr, m.col, m.value, b, x, -1, &error, NULL), YC_ERROR_ARGUMENT);
    CHECK(yc_chol_order(NULL, order) == YC_ERROR_ARGUMENT && yc_chol_order(chol, NULL) == YC_ERROR_ARGUMENT);
    CHECK(yc_chol_stats(NULL, &stats) == YC_ERROR_ARGUMENT && yc_chol_stats(chol, NULL) == YC_ERROR_ARGUMENT);
    CHECK(yc_chol_work(NULL) == 0 && strstr(yc_chol_message(NULL), "NULL"));
    yc_chol_options_default(NULL), yc_chol_destroy(NULL);
    for (i = 0; i < 24; i++) CHECK(x[i] == i);
    CHECK(error == 7.0 && yc_chol_solve(chol, NULL, 0, 12) == YC_OK && yc_chol_solve(chol, x, 2, 12) == YC_OK);
    yc_chol_destroy(chol);
    matrix_close(&m);
}

/* Any value that is not finite is named, the first of several, and the factor before stays; above the diagonal none is
 * read. */
TEST(direct_not_finite) {
    static const double bad[] = {NAN, INFINITY, -INFINITY};
    int block, full, i, k;
    for (block = 1; block <= 3; block += 2)
        for (full = 0; full < 2; full++) {
            matrix lower = matrix_open(GRID, 36, block), m;
            double *x = random_numbers(3, lower.n), *y = random_numbers(3, lower.n);
            yc_chol *chol;
            uint64_t bits;
            fill_dominant(&lower, NULL, 3);
            m = full ? matrix_full(&lower, NAN) : lower;
            chol = factored(NULL, &m, YC_CHOL_SPD);
            bits = factor_bits(chol);
            CHECK_RESULT(yc_chol_solve(chol, x, 1, m.n), YC_OK);
            for (k = 0; k < m.entries; k++) {
                char words[32];
                double keep = m.value[k], last = m.value[m.entries - 1];
                if (m.col[k] > row_of(&m, k)) continue;
                m.value[m.entries - 1] = k % 2 ? bad[0] : last, m.value[k] = bad[k % 3];
                snprintf(words, sizeof words, "values[%d] is", k);
                CHECK_RESULT(yc_chol_factor(chol, m.value), YC_ERROR_ARGUMENT);
                CHECK(strstr(yc_chol_message(chol), words) != NULL);
                m.value[k] = keep, m.value[m.entries - 1] = last;
            }
            CHECK(factor_bits(chol) == bits && yc_chol_solve(chol, y, 1, m.n) == YC_OK);
            for (i = 0; i < m.n; i++) CHECK(x[i] == y[i]);
            yc_chol_destroy(chol);
            free(x), free(y);
            if (full) matrix_close(&m);
            matrix_close(&lower);
        }
}

/* ---- statistics and memory --------------------------------------------------------------------------------------- */

static void *dirty_alloc(size_t size, void *user) {
    void *block = malloc(size);
    (void)user;
    return block ? memset(block, 0xff, size) : NULL; /* numbers that are none, and indices of -1 */
}
static void dirty_free(void *block, size_t size, void *user) {
    (void)size, (void)user;
    free(block);
}
static yc_host dirty_host(void) {
    yc_host host;
    memset(&host, 0, sizeof host);
    host.alloc = dirty_alloc, host.free = dirty_free;
    return host;
}

/* Nothing depends on what memory held before. */
TEST(direct_dirty_memory) {
    yc_host dirty = dirty_host();
    int which, block, shape, level, count;
    for (which = 0; which < 2; which++)
        for (shape = 0; shape < SHAPES; shape++)
            for (block = 1; block <= YCI_BLOCK_MAX; block += shape == GRID ? 1 : 3) {
                yc_chol_kind kind = which ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD;
                matrix m = matrix_open(shape, shape == DENSE ? 280 / block : 225, block);
                yc_chol *chol, *other;
                fill_dominant(&m, NULL, 3);
                chol = analyzed(NULL, &m, kind), other = analyzed(&dirty, &m, kind);
                for (level = 0; level < YCI_LEVELS; level++)
                    for (count = 1; count <= 4; count += 3) {
                        double *x = random_numbers(4, 4 * m.n), *y = random_numbers(4, 4 * m.n);
                        if ((chol->ldl->kernels = other->ldl->kernels = yci_kernels_of(level)) != NULL) {
                            CHECK(yc_chol_factor(chol, m.value) == YC_OK && yc_chol_factor(other, m.value) == YC_OK);
                            CHECK(factor_bits(chol) == factor_bits(other));
                            CHECK_RESULT(yc_chol_solve(chol, x, count, m.n), YC_OK);
                            CHECK_RESULT(yc_chol_solve(other, y, count, m.n), YC_OK);
                            CHECK(memcmp(x, y, (size_t)(4 * m.n) * sizeof(double)) == 0);
                        }
                        free(x), free(y);
                    }
                yc_chol_destroy(chol), yc_chol_destroy(other);
                matrix_close(&m);
            }
}

/* What a failed factorisation leaves in the object, infinities among it, does not reach the next one. */
TEST(direct_after_failure) {
    int which, block, level, i, k;
    for (which = 0; which < 2; which++)
        for (block = 1; block <= YCI_BLOCK_MAX; block++) {
            yc_chol_kind kind = which ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD;
            matrix m = matrix_open(GRID, 225, block), wild = matrix_open(GRID, 225, block);
            yc_chol *chol = analyzed(NULL, &m, kind), *other = analyzed(NULL, &m, kind);
            double *x = random_numbers(4, 4 * m.n), *y = random_numbers(4, 4 * m.n);
            fill_dominant(&m, NULL, 3);
            for (i = 0; i < m.n; i++)
                for (k = m.ptr[i]; k < m.ptr[i + 1]; k++)
                    wild.value[k] = m.col[k] == i ? 1e-200 : m.col[k] / block == i / block ? 0.0 : 1e200;
            for (level = 0; level < YCI_LEVELS; level++) {
                if (!(chol->ldl->kernels = other->ldl->kernels = yci_kernels_of(level))) continue;
                CHECK(yc_chol_factor(other, wild.value) != YC_OK);
                CHECK(yc_chol_factor(chol, m.value) == YC_OK && yc_chol_factor(other, m.value) == YC_OK);
                CHECK(factor_bits(chol) == factor_bits(other));
                CHECK_RESULT(yc_chol_solve(chol, x, 4, m.n), YC_OK);
                CHECK_RESULT(yc_chol_solve(other, y, 4, m.n), YC_OK);
                CHECK(memcmp(x, y, (size_t)(4 * m.n) * sizeof(double)) == 0);
            }
            yc_chol_destroy(chol), yc_chol_destroy(other);
            free(x), free(y);
            matrix_close(&m), matrix_close(&wild);
        }
}

/* Before the first factorisation nothing is eliminated or shifted, and a failed one counts only what it came to. */
TEST(direct_statistics) {
    yc_host host = dirty_host();
    matrix m = matrix_open(PARTS, 100, 1);
    yc_chol_options options = options_of(YC_CHOL_QUASIDEFINITE, 1);
    yc_chol_statistics stats;
    yc_chol *chol = NULL;
    int all, i;
    fill_free(&m);
    options.shift = 1.0;
    CHECK_RESULT(yc_chol_analyze(&host, m.n, m.ptr, m.col, &options, &chol), YC_OK);
    CHECK(yc_chol_stats(chol, &stats) == YC_OK && stats.pivots == 0);
    CHECK_NEAR(stats.shifted, 0.0, 0.0);
    CHECK_RESULT(yc_chol_factor(chol, m.value), YC_OK);
    CHECK(yc_chol_stats(chol, &stats) == YC_OK && stats.pivots == m.n);
    all = stats.shifted;
    CHECK_NEAR(all, 2.0 + m.n / 5, 0.0); /* one per part, and lone nodes, which are zero */
    chol->ldl->shift = 0.0;              /* so that the same matrix fails, at its first such pivot */
    CHECK_RESULT(yc_chol_factor(chol, m.value), YC_ERROR_SINGULAR);
    CHECK_RESULT(yc_chol_stats(chol, &stats), YC_OK);
    CHECK_NEAR(stats.shifted, 0.0, 0.0);
    for (i = 0; i < m.n; i++) *entry(&m, i, i) += 1.0;
    CHECK(yc_chol_factor(chol, m.value) == YC_OK && yc_chol_stats(chol, &stats) == YC_OK && stats.shifted == 0);
    yc_chol_destroy(chol);
    matrix_close(&m);
}

/* Bytes are those that the host has given; only the analysis and the first factorisation ask for any. */
TEST(direct_allocations) {
    int which, k;
    for (which = 0; which < 2; which++) {
        yc_host host = test_host_counting();
        matrix m = matrix_open(GRID, 400, 3);
        yc_chol *chol;
        yc_chol_statistics stats;
        double *x = random_numbers(3, 5 * m.n), *b = random_numbers(3, m.n), error;
        int calls, live;
        fill_springs(&m, 3);
        chol = factored(&host, &m, which ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD);
        calls = test_heap.calls, live = test_heap.live;
        CHECK_RESULT(yc_chol_stats(chol, &stats), YC_OK);
        CHECK(stats.bytes + (size_t)test_heap.live * 2 * YCI_COOKIE == test_heap.bytes);
        for (k = 0; k < 3; k++) {
            CHECK_RESULT(yc_chol_factor(chol, m.value), YC_OK);
            CHECK_RESULT(yc_chol_solve(chol, x, 5, m.n), YC_OK);
            CHECK_RESULT(yc_chol_refine(chol, m.ptr, m.col, m.value, b, x, 3, &error, NULL), YC_OK);
            m.value[m.entries - 1] = k ? -1e9 : NAN; /* failures ask for none either */
            CHECK(yc_chol_factor(chol, m.value) != YC_OK || which);
            m.value[m.entries - 1] = 1e9;
        }
        CHECK(test_heap.calls == calls && test_heap.live == live);
        yc_chol_destroy(chol);
        CHECK(test_heap.live == 0 && test_heap.bytes == 0);
        free(x), free(b);
        matrix_close(&m);
    }
}

/* Analysis and first factorisation with that many allocations granted; returns whether they sufficed. A factorisation
 * that had none left succeeds as soon as there is memory again. */
static int memory_round(const matrix *m, yc_chol_kind kind, int workers, int granted) {
    yc_host host = workers < 0 ? test_host_counting() : test_host_threads(workers);
    yc_chol_options options = options_of(kind, m->block);
    yc_chol *chol = (yc_chol *)&host;
    yc_chol_statistics stats;
    double *x = random_numbers(3, m->n), *b = random_numbers(3, m->n);
    yc_result result;
    int enough = 0;
    test_heap_grant(granted);
    result = yc_chol_analyze(&host, m->n, m->ptr, m->col, &options, &chol);
    if (result != YC_OK) CHECK(result == YC_ERROR_MEMORY && !chol && test_heap.live == 0 && test_heap.bytes == 0);
    else {
        int live = test_heap.live;
        result = yc_chol_factor(chol, m->value);
        enough = result == YC_OK;
        if (!enough) {
            CHECK(result == YC_ERROR_MEMORY && strstr(yc_chol_message(chol), "memory") && test_heap.live == live);
            CHECK(yc_chol_stats(chol, &stats) == YC_OK && stats.pivots == 0);
            CHECK_RESULT(yc_chol_solve(chol, x, 1, m->n), YC_ERROR_ARGUMENT);
            test_heap_grant(-1);
            CHECK_RESULT(yc_chol_factor(chol, m->value), YC_OK);
        }
        CHECK_RESULT(yc_chol_solve(chol, x, 1, m->n), YC_OK);
        CHECK_NEAR(backward_error(m, b, x, 0), 0.0, 1e-15);
        yc_chol_destroy(chol);
        CHECK(test_heap.live == 0 && test_heap.bytes == 0);
    }
    free(x), free(b);
    return enough;
}

TEST(direct_out_of_memory) {
    int which, workers, granted;
    for (which = 0; which < 2; which++)
        for (workers = -1; workers <= 0; workers++) {
            matrix m = matrix_open(GRID, 900, workers < 0 ? 1 : 3);
            fill_dominant(&m, NULL, 4);
            for (granted = 0; granted < 1000; granted++)
                if (memory_round(&m, which ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD, workers, granted)) break;
            CHECK(granted > 10 && granted < 100 && granted == test_heap.calls);
            matrix_close(&m);
        }
}

/* ---- workers ----------------------------------------------------------------------------------------------------- */

static const int worker_counts[] = {0, 1, 2, 3, 8};

/* The same bits for any number of workers and without any, of a matrix large enough for several tasks. */
TEST(direct_workers) {
    int which;
    size_t k;
    for (which = 0; which < 2; which++) {
        yc_chol_kind kind = which ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD;
        matrix m = matrix_open(GRID, which ? 3600 : 10000, 3);
        yc_chol *chol;
        double *x = random_numbers(3, 3 * m.n);
        uint64_t bits;
        fill_dominant(&m, NULL, 3);
        chol = factored(NULL, &m, kind);
        bits = factor_bits(chol);
        CHECK_RESULT(yc_chol_solve(chol, x, 3, m.n), YC_OK);
        yc_chol_destroy(chol);
        for (k = 0; k < sizeof worker_counts / sizeof worker_counts[0]; k++) {
            yc_host host = test_host_threads(worker_counts[k]);
            double *y = random_numbers(3, 3 * m.n);
            chol = factored(&host, &m, kind);
            CHECK(chol->ldl->tasks > 3 && factor_bits(chol) == bits);
            CHECK_RESULT(yc_chol_solve(chol, y, 3, m.n), YC_OK);
            CHECK(memcmp(x, y, (size_t)(3 * m.n) * sizeof(double)) == 0);
            yc_chol_destroy(chol);
            free(y);
        }
        free(x);
        matrix_close(&m);
    }
}

/* Of several bad columns, in tasks and above them, the same one is named, and the factor is as good as new after it. */
TEST(direct_workers_failure) {
    matrix m = matrix_open(GRID, 3600, 3);
    int trial, pivot[2] = {0, 0}, *unknown = (int *)malloc((size_t)m.n * sizeof(int)), i;
    uint64_t seed = 4, bits = 0;
    size_t k;
    double *keep = (double *)malloc((size_t)m.n * sizeof(double));
    fill_dominant(&m, NULL, 3);
    for (i = 0; i < m.n; i++) keep[i] = *entry(&m, i, i);
    for (trial = 0; trial < 4; trial++) {
        int bad[5], count = 1 + trial;
        for (i = 0; i < count; i++) bad[i] = test_random_int(&seed, m.n);
        for (k = 0; k < sizeof worker_counts / sizeof worker_counts[0]; k++) {
            yc_host host = test_host_threads(worker_counts[k]);
            yc_chol *chol = analyzed(&host, &m, YC_CHOL_SPD);
            CHECK(chol->ldl->tasks > 3);
            for (i = 0; i < count; i++) *entry(&m, bad[i], bad[i]) = -1.0;
            CHECK_RESULT(yc_chol_factor(chol, m.value), YC_ERROR_NOT_SPD);
            pivot[k > 0] = named_pivot(chol, unknown);
            CHECK(k == 0 || pivot[0] == pivot[1]);
            for (i = 0; i < m.n && unknown[i] != bad[0]; i++) continue;
            CHECK(pivot[k > 0] <= i && (count > 1 || pivot[k > 0] == i));
            for (i = 0; i < count; i++) *entry(&m, bad[i], bad[i]) = keep[bad[i]];
            CHECK_RESULT(yc_chol_factor(chol, m.value), YC_OK);
            if (trial == 0 && k == 0) bits = factor_bits(chol);
            CHECK(factor_bits(chol) == bits);
            yc_chol_destroy(chol);
        }
    }
    free(unknown), free(keep);
    matrix_close(&m);
}

typedef struct {
    const matrix *m;
    const yc_chol *chol;
    const double *b;
    double *x, *work, error[16];
    size_t size; /* of one work array */
    int ok[16];
} solve_job;

static void solve_body(void *arg, int begin, int end) {
    solve_job *job = (solve_job *)arg;
    const matrix *m = job->m;
    int k;
    for (k = begin; k < end; k++) {
        double *x = job->x + (size_t)(4 * k * m->n), *work = job->work + (size_t)k * job->size;
        job->ok[k] = yc_chol_solve_with(job->chol, x, 1 + k % 4, m->n, work) == YC_OK;
        job->ok[k] &= yc_chol_refine(job->chol, m->ptr, m->col, m->value, job->b + (size_t)(4 * k * m->n), x, 1,
                          &job->error[k], work) == YC_OK;
    }
}

/* Several threads solve and refine with one factor at once and get what one would have got. */
TEST(direct_threads) {
    enum { JOBS = 16 };
    int which, round, k;
    for (which = 0; which < 2; which++) {
        matrix m = matrix_open(GRID, 900, 3);
        double *b = random_numbers(3, 4 * JOBS * m.n), *first = NULL;
        yc_chol *chol;
        fill_dominant(&m, NULL, 3);
        chol = factored(NULL, &m, which ? YC_CHOL_QUASIDEFINITE : YC_CHOL_SPD);
        for (round = 0; round < 3; round++) {
            yc_host host = test_host_threads(round ? 4 : 1);
            yci_context c;
            solve_job job;
            CHECK_RESULT(yci_context_init(&c, &host), YC_OK);
            memset(&job, 0, sizeof job);
            job.m = &m, job.chol = chol, job.b = b, job.size = yc_chol_work(chol);
            job.x = (double *)malloc((size_t)(4 * JOBS * m.n) * sizeof(double));
            job.work = (double *)malloc(JOBS * job.size * sizeof(double));
            memcpy(job.x, b, (size_t)(4 * JOBS * m.n) * sizeof(double));
            yci_parallel(&c, JOBS, 1, solve_body, &job);
            for (k = 0; k < JOBS; k++) CHECK(job.ok[k] && job.error[k] < 1e-15);
            if (round) CHECK(memcmp(first, job.x, (size_t)(4 * JOBS * m.n) * sizeof(double)) == 0), free(job.x);
            else first = job.x;
            free(job.work);
        }
        yc_chol_destroy(chol);
        free(b), free(first);
        matrix_close(&m);
    }
}
