/* The matrices of bench-direct: meshes and yarn grids of a given number of vertices, with values that make each matrix
 * definite by construction, as a sum of squares. */
#define _POSIX_C_SOURCE 200809L /* NOLINT(bugprone-reserved-identifier): what POSIX prescribes */
#include "direct.h"

/* A symmetric matrix of blocks, lower triangle by rows. */
typedef struct blocks {
    int n, size;
    int *ptr, *col;
    double *values; /* size * size each, by rows */
} blocks;

typedef struct mesh {
    int n, triangles, pairs, hinges;
    double (*position)[3];
    int (*triangle)[3];
    int (*pair)[2];  /* edges, some twice */
    int (*hinge)[4]; /* the ends of an inner edge, the two vertices across it */
} mesh;

/* ---- blocks ------------------------------------------------------------------------------------------------------ */

static int order_ints(const void *a, const void *b) {
    int x = *(const int *)a, y = *(const int *)b;
    return x < y ? -1 : x > y;
}

static void blocks_make(blocks *m, int n, int size, int (*pair)[2], int pairs) {
    int i, k, kept = 0, *fill = BENCH_NEW(int, n + 1);
    m->n = n, m->size = size, m->ptr = BENCH_NEW(int, n + 1), m->col = BENCH_NEW(int, pairs + n);
    for (i = 0; i < n; i++) fill[i + 1] = 1;
    for (k = 0; k < pairs; k++) fill[1 + (pair[k][0] > pair[k][1] ? pair[k][0] : pair[k][1])]++;
    for (i = 0; i < n; i++) fill[i + 1] += fill[i];
    memcpy(m->ptr, fill, (size_t)(n + 1) * sizeof *fill);
    for (i = 0; i < n; i++) m->col[fill[i]++] = i;
    for (k = 0; k < pairs; k++) {
        int lower = pair[k][0] > pair[k][1];
        m->col[fill[pair[k][!lower]]++] = pair[k][lower];
    }
    for (i = 0; i < n; i++) {
        int begin = m->ptr[i], end = m->ptr[i + 1], last = -1;
        qsort(m->col + begin, (size_t)(end - begin), sizeof(int), order_ints);
        m->ptr[i] = kept;
        for (k = begin; k < end; k++)
            if (m->col[k] != last) last = m->col[kept++] = m->col[k];
    }
    m->ptr[n] = kept;
    m->values = BENCH_NEW(double, (size_t)kept *(size_t)(size * size));
    free(fill);
}

static void blocks_free(blocks *m) { free(m->ptr), free(m->col), free(m->values); }

/* The block at (i, j), i >= j. */
static double *blocks_at(const blocks *m, int i, int j) {
    int lo = m->ptr[i], hi = m->ptr[i + 1] - 1;
    while (lo < hi) {
        int middle = (lo + hi) / 2;
        if (m->col[middle] < j) lo = middle + 1;
        else hi = middle;
    }
    return m->values + (size_t)lo * (size_t)(m->size * m->size);
}

/* Adds y' D y for y = sum_k w[k] x(node[k]), D symmetric. */
static void blocks_add(blocks *m, int count, const int *node, const double *w, double d[3][3]) {
    int a, b, i, j;
    for (a = 0; a < count; a++)
        for (b = 0; b < count; b++) {
            double *block;
            if (node[a] < node[b]) continue;
            block = blocks_at(m, node[a], node[b]);
            for (i = 0; i < 3; i++)
                for (j = 0; j < 3; j++) block[3 * i + j] += w[a] * w[b] * d[i][j];
        }
}

/* To single numbers; with `hollow`, entry (0, 0) of the blocks off the diagonal is not there. */
static void blocks_expand(const blocks *m, int hollow, matrix *out) {
    int size = m->size, i, r, k, c;
    size_t kept = 0, most = (size_t)m->ptr[m->n] * (size_t)(size * size);
    out->n = m->n * size, out->block = size;
    out->ptr = BENCH_NEW(int, out->n + 1), out->col = BENCH_NEW(int, most), out->own = BENCH_NEW(double, most);
    for (i = 0; i < m->n; i++)
        for (r = 0; r < size; r++) {
            for (k = m->ptr[i]; k < m->ptr[i + 1]; k++)
                for (c = 0; c < (m->col[k] == i ? r + 1 : size); c++) {
                    if (hollow && m->col[k] != i && r == 0 && c == 0) continue;
                    out->col[kept] = m->col[k] * size + c;
                    out->own[kept++] = m->values[(size_t)k * (size_t)(size * size) + (size_t)(r * size + c)];
                }
            out->ptr[i * size + r + 1] = (int)kept;
        }
}

/* ---- meshes ------------------------------------------------------------------------------------------------------ */

static int order_edges(const void *a, const void *b) {
    const int *x = (const int *)a, *y = (const int *)b;
    if (x[0] != y[0]) return x[0] < y[0] ? -1 : 1;
    return x[1] < y[1] ? -1 : x[1] > y[1];
}

/* Whether d is inside the circle through a, b, c, which turn left. */
static int in_circle(const double *a, const double *b, const double *c, const double *d) {
    double ax = a[0] - d[0], ay = a[1] - d[1], bx = b[0] - d[0], by = b[1] - d[1], cx = c[0] - d[0], cy = c[1] - d[1];
    double aa = ax * ax + ay * ay, bb = bx * bx + by * by, cc = cx * cx + cy * cy;
    return ax * (by * cc - bb * cy) - ay * (bx * cc - bb * cx) + aa * (bx * cy - by * cx) > 0.0;
}

static void mesh_make(mesh *m, int jittered, int width, int height, uint64_t *seed) {
    int n = width * height, x, y, k, t = 0, records = 0, (*edge)[3], *name = BENCH_NEW(int, n);
    m->n = n, m->triangles = 2 * (width - 1) * (height - 1);
    m->position = (double(*)[3])bench_alloc((size_t)n, sizeof *m->position);
    m->triangle = (int(*)[3])bench_alloc((size_t)m->triangles, sizeof *m->triangle);
    m->pair = (int(*)[2])bench_alloc((size_t)m->triangles * 3, sizeof *m->pair);
    m->hinge = (int(*)[4])bench_alloc((size_t)m->triangles * 3, sizeof *m->hinge);
    edge = (int(*)[3])bench_alloc((size_t)m->triangles * 3, sizeof *edge);
    for (k = 0; k < n; k++) name[k] = k;
    for (k = n - 1; jittered && k > 0; k--) {
        int other = (int)bench_random(seed, 0.0, (double)k + 1.0), swap = name[k];
        name[k] = name[other], name[other] = swap;
    }
    for (k = 0; k < n; k++) {
        double *p = m->position[name[k]], most = jittered ? 0.3 : 0.0;
        x = k % width, y = k / width;
        p[0] = (double)x + bench_random(seed, -most, most);
        p[1] = (double)y + bench_random(seed, -most, most);
        p[2] = bench_random(seed, -0.2, 0.2);
    }
    for (y = 0; y + 1 < height; y++)
        for (x = 0; x + 1 < width; x++) {
            int a = name[y * width + x], b = name[y * width + x + 1];
            int c = name[(y + 1) * width + x + 1], d = name[(y + 1) * width + x];
            int other = jittered && in_circle(m->position[a], m->position[b], m->position[c], m->position[d]);
            int *first = m->triangle[t++], *second = m->triangle[t++];
            first[0] = a, first[1] = b, first[2] = other ? d : c;
            second[0] = other ? b : a, second[1] = c, second[2] = d;
        }
    for (t = 0; t < m->triangles; t++)
        for (k = 0; k < 3; k++) {
            int a = m->triangle[t][k], b = m->triangle[t][(k + 1) % 3];
            m->pair[records][0] = edge[records][0] = a > b ? a : b;
            m->pair[records][1] = edge[records][1] = a > b ? b : a;
            edge[records++][2] = m->triangle[t][(k + 2) % 3];
        }
    m->pairs = records, m->hinges = 0;
    qsort(edge, (size_t)records, sizeof *edge, order_edges);
    for (k = 0; k + 1 < records; k++)
        if (order_edges(edge[k], edge[k + 1]) == 0) {
            int *h = m->hinge[m->hinges++];
            h[0] = edge[k][0], h[1] = edge[k][1], h[2] = edge[k][2], h[3] = edge[k + 1][2];
        }
    free(edge), free(name);
}

static void mesh_free(mesh *m) { free(m->position), free(m->triangle), free(m->pair), free(m->hinge); }

/* Sums of w w' and of w w' / mass over about 25 random points of a triangle. Three points would do to make the first
 * definite. */
static void random_points(double g[3][3], double k[3][3], uint64_t *seed) {
    int count = 20 + (int)bench_random(seed, 0.0, 11.0), i, j;
    memset(g, 0, 9 * sizeof(double)), memset(k, 0, 9 * sizeof(double));
    while (count-- > 0) {
        double w[3], inverse_mass = bench_random(seed, 0.7, 1.4);
        w[0] = bench_random(seed, 0.0, 1.0), w[1] = bench_random(seed, 0.0, 1.0);
        if (w[0] + w[1] > 1.0) w[0] = 1.0 - w[0], w[1] = 1.0 - w[1];
        w[2] = 1.0 - w[0] - w[1];
        for (i = 0; i < 3; i++)
            for (j = 0; j < 3; j++) g[i][j] += w[i] * w[j], k[i][j] += w[i] * w[j] * inverse_mass;
    }
}

/* stiffness * (n n' + share (I - n n')) for the direction n of a vector. */
static void spring(double d[3][3], const double *along, double stiffness, double share) {
    double square = along[0] * along[0] + along[1] * along[1] + along[2] * along[2];
    int i, j;
    for (i = 0; i < 3; i++)
        for (j = 0; j < 3; j++)
            d[i][j] = stiffness * ((1.0 - share) * along[i] * along[j] / square + (i == j ? share : 0.0));
}

/* ---- the matrices ------------------------------------------------------------------------------------------------ */

static void make_mass(matrix *out, const mesh *m, uint64_t *seed) {
    blocks a;
    int t, i, j;
    blocks_make(&a, m->n, 1, m->pair, m->pairs);
    for (t = 0; t < m->triangles; t++) {
        double g[3][3], k[3][3];
        const int *v = m->triangle[t];
        random_points(g, k, seed);
        for (i = 0; i < 3; i++)
            for (j = 0; j < 3; j++)
                if (v[i] >= v[j]) *blocks_at(&a, v[i], v[j]) += g[i][j];
    }
    blocks_expand(&a, 0, out);
    blocks_free(&a);
}

static void make_cloth(matrix *out, const mesh *m, uint64_t *seed) {
    static const double ends[2] = {1.0, -1.0}, one = 1.0;
    blocks a;
    double d[3][3], unit[3] = {1.0, 0.0, 0.0};
    int(*pair)[2] = (int(*)[2])bench_alloc((size_t)m->pairs + (size_t)m->hinges, sizeof *pair), k, i;
    memcpy(pair, m->pair, (size_t)m->pairs * sizeof *pair);
    for (k = 0; k < m->hinges; k++) pair[m->pairs + k][0] = m->hinge[k][2], pair[m->pairs + k][1] = m->hinge[k][3];
    blocks_make(&a, m->n, 3, pair, m->pairs + m->hinges);
    for (k = 0; k < m->n; k++) spring(d, unit, bench_random(seed, 0.8, 1.2), 1.0), blocks_add(&a, 1, &k, &one, d);
    for (k = 0; k < m->pairs; k++) {
        double along[3];
        for (i = 0; i < 3; i++) along[i] = m->position[m->pair[k][0]][i] - m->position[m->pair[k][1]][i];
        spring(d, along, 500.0, 0.1), blocks_add(&a, 2, m->pair[k], ends, d);
    }
    for (k = 0; k < m->hinges; k++) {
        double w[4], normal[3], shift = bench_random(seed, -0.3, 0.3);
        w[0] = -1.0 - shift, w[1] = -1.0 + shift, w[2] = w[3] = 1.0;
        normal[0] = bench_random(seed, -0.3, 0.3), normal[1] = bench_random(seed, -0.3, 0.3), normal[2] = 1.0;
        spring(d, normal, 20.0, 0.02), blocks_add(&a, 4, m->hinge[k], w, d);
    }
    blocks_expand(&a, 0, out);
    blocks_free(&a), free(pair);
}

static void make_yarn(matrix *out, int width, int height, uint64_t *seed) {
    static const int step[6][2] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}, {2, 0}, {0, 2}};
    static const double ends[2] = {1.0, -1.0}, bend[3] = {1.0, -2.0, 1.0}, one = 1.0;
    int n = width * height, pairs = 0, k, s, pass, (*pair)[2] = (int(*)[2])bench_alloc((size_t)n * 6, sizeof *pair);
    double d[3][3], unit[3] = {1.0, 0.0, 0.0};
    blocks a;
    memset(&a, 0, sizeof a);
    for (pass = 0; pass < 2; pass++) {
        for (k = 0; k < n; k++)
            for (s = 0; s < 6; s++) {
                int x = k % width + step[s][0], y = k / width + step[s][1], node[3];
                double along[3];
                if (x >= width || y < 0 || y >= height) continue;
                node[0] = k, node[1] = y * width + x;
                if (pass == 0) {
                    memcpy(pair[pairs++], node, 2 * sizeof(int));
                    continue;
                }
                along[0] = step[s][0], along[1] = step[s][1], along[2] = bench_random(seed, -0.7, 0.7);
                if (s < 4) spring(d, along, s < 2 ? 1000.0 : 30.0, 0.1), blocks_add(&a, 2, node, ends, d);
                else {
                    node[1] = (k + node[1]) / 2, node[2] = y * width + x;
                    spring(d, along, 20.0, 1.0), blocks_add(&a, 3, node, bend, d);
                }
            }
        if (pass == 0) blocks_make(&a, n, 3, pair, pairs);
    }
    for (k = 0; k < n; k++) spring(d, unit, bench_random(seed, 0.8, 1.2), 1.0), blocks_add(&a, 1, &k, &one, d);
    blocks_expand(&a, 0, out);
    blocks_free(&a), free(pair);
}

/* Every seventh vertex has no mass of its own. */
static void make_pair(matrix *out, const mesh *m, uint64_t *seed) {
    blocks a;
    double *sum;
    size_t entries;
    int t, i, j, e;
    blocks_make(&a, m->n, 2, m->pair, m->pairs);
    for (t = 0; t < m->triangles; t++) {
        double g[3][3], k[3][3];
        const int *v = m->triangle[t];
        random_points(g, k, seed);
        for (i = 0; i < 3; i++)
            for (j = 0; j < 3; j++)
                if (v[i] >= v[j]) {
                    double *block = blocks_at(&a, v[i], v[j]);
                    block[1] += g[i][j], block[2] += g[i][j], block[3] -= k[i][j];
                }
    }
    for (i = 0; i < m->n; i++) blocks_at(&a, i, i)[0] = i % 7 ? bench_random(seed, 2.0, 20.0) : 0.0;
    blocks_expand(&a, 1, out);
    blocks_free(&a);
    entries = matrix_entries(out);
    out->ll = BENCH_NEW(double, entries), out->ldl = BENCH_NEW(double, entries), sum = BENCH_NEW(double, out->n);
    memcpy(out->ldl, out->own, entries * sizeof(double)), memcpy(out->ll, out->own, entries * sizeof(double));
    for (i = 0; i < out->n; i++)
        for (e = out->ptr[i]; e < out->ptr[i + 1] - 1; e++)
            sum[i] += fabs(out->own[e]), sum[out->col[e]] += fabs(out->own[e]);
    for (i = 0; i < out->n; i++) {
        e = out->ptr[i + 1] - 1; /* the diagonal */
        out->ll[e] = 1.1 * sum[i] + 1.0;
        if (out->own[e] == 0.0) out->ldl[e] = 10.0;
    }
    free(sum);
}

void matrix_make(matrix *m, matrix_kind kind, int jittered, int width, int height) {
    uint64_t seed = 12345;
    mesh cloth;
    size_t k;
    memset(m, 0, sizeof *m), memset(&cloth, 0, sizeof cloth);
    if (kind != MATRIX_YARN && kind != MATRIX_DENSE) mesh_make(&cloth, jittered, width, height, &seed);
    switch (kind) {
    case MATRIX_MASS: make_mass(m, &cloth, &seed); break;
    case MATRIX_CLOTH: make_cloth(m, &cloth, &seed); break;
    case MATRIX_PAIR: make_pair(m, &cloth, &seed); break;
    case MATRIX_YARN: make_yarn(m, width, height, &seed); break;
    case MATRIX_DENSE:
        m->n = width, m->block = 1, m->own = BENCH_NEW(double, (size_t)width *(size_t)width);
        for (k = 0; k < (size_t)width * (size_t)width; k++) m->own[k] = bench_random(&seed, -1.0, 1.0);
        break;
    }
    mesh_free(&cloth);
    m->kind = kind;
    if (!m->ll) m->ll = m->ldl = m->own;
    m->sides = m->n > ACCURACY_MOST ? RIGHT_SIDES : ACCURACY_SIDES;
    m->b = BENCH_NEW(double, (size_t)m->n *(size_t)m->sides);
    for (k = 0; k < (size_t)m->n * (size_t)m->sides; k++) m->b[k] = bench_random(&seed, -1.0, 1.0);
}

void matrix_free(matrix *m) {
    if (m->ll != m->own) free(m->ll), free(m->ldl);
    free(m->ptr), free(m->col), free(m->own), free(m->b);
}
