/* Chapter 9: the embedding B, the kinematic filter F, the maps between independent increments and MIX's coordinates,
 * and both forms of the mass preconditioner, on patches with random yarn nodes. */

#include "internals.h"
#include "test.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- tools ------------------------------------------------------------------------------------------------------- */

typedef struct {
    int nx, ny;      /* vertices each way */
    int least, most; /* hybrid nodes per triangle */
    int bare;        /* columns of triangles without nodes, on the right */
    int shuffled;    /* nodes in random order, not triangle by triangle */
    int pinned;      /* vertices pinned: the first few of the left column */
    int thin;        /* vertex nx - 1 - bare of the first row has hardly any yarn */
    double ratio;    /* mass of a vertex against that of a triangle's nodes; 0: none where yarns are */
    double uneven;   /* powers of ten between the masses of nodes */
} mixed_options;

typedef struct {
    yci_context c;
    int vertices, nodes;
    unsigned char *state;
    int (*triangle)[3];
    double (*beta)[3];
    double *mv, *mp;
} mixed_patch;

static uint64_t mixed_state; /* every patch sets it */

static double mixed_random(double low, double high) { return test_random(&mixed_state, low, high); }

static double *mixed_vector(int count, int fill) {
    double *x = (double *)calloc((size_t)(3 * count + 1), sizeof *x);
    if (x && fill) test_random_array(&mixed_state, -1.0, 1.0, x, 3 * count);
    return x;
}

static double mixed_dot(const double *a, const double *b, int count) {
    double sum = 0.0;
    int i;
    for (i = 0; i < 3 * count; i++) sum += a[i] * b[i];
    return sum;
}

/* |a - b| / |b| in the 2-norm; b NULL: |a|. NaN comes out as a large number. */
static double mixed_error(const double *a, const double *b, int count) {
    double sum = 0.0, size = 0.0;
    int i;
    for (i = 0; i < 3 * count; i++) {
        double d = b ? a[i] - b[i] : a[i];
        sum += d * d;
        if (b) size += b[i] * b[i];
    }
    if (!(sum <= 1e300)) return 1e300;
    return b && size > 0.0 ? sqrt(sum / size) : sqrt(sum);
}

static mixed_options mixed_plain(void) {
    mixed_options o;
    memset(&o, 0, sizeof o);
    o.nx = 6, o.ny = 5, o.least = 20, o.most = 400, o.ratio = 1.0;
    return o;
}

static void mixed_swap_nodes(mixed_patch *p, int i, int j) {
    int k;
    for (k = 0; k < 3; k++) {
        int t = p->triangle[i][k];
        double b = p->beta[i][k];
        p->triangle[i][k] = p->triangle[j][k], p->triangle[j][k] = t;
        p->beta[i][k] = p->beta[j][k], p->beta[j][k] = b;
    }
}

static void mixed_make(mixed_patch *p, const mixed_options *o, const yc_host *host) {
    int x, y, half, i, k, room = 2 * (o->nx - 1) * (o->ny - 1) * o->most, thin = o->thin ? o->nx - 1 - o->bare : -1;
    memset(p, 0, sizeof *p);
    mixed_state = 1;
    yci_context_init(&p->c, host);
    p->vertices = o->nx * o->ny;
    p->state = (unsigned char *)malloc((size_t)p->vertices);
    p->triangle = (int(*)[3])malloc((size_t)(room + 1) * sizeof *p->triangle);
    p->beta = (double(*)[3])malloc((size_t)(room + 1) * sizeof *p->beta);
    for (y = 0; y + 1 < o->ny; y++)
        for (x = 0; x + 1 < o->nx - o->bare; x++)
            for (half = 0; half < 2; half++) {
                int a = y * o->nx + x, b = a + 1, c = a + o->nx, d = c + 1, count;
                count = o->least + (int)mixed_random(0.0, (double)(o->most - o->least) + 0.999);
                for (i = 0; i < count; i++) {
                    int *t = p->triangle[p->nodes];
                    double *w = p->beta[p->nodes++], r = sqrt(mixed_random(0.0, 1.0)), s = mixed_random(0.0, 1.0);
                    t[0] = half ? d : a, t[1] = half ? c : b, t[2] = half ? b : c;
                    w[0] = 1.0 - r, w[1] = r * s, w[2] = 1.0 - w[0] - w[1];
                    for (k = 0; k < 3; k++)
                        if (t[k] == thin) w[(k + 1) % 3] += 0.99 * w[k], w[k] *= 0.01;
                }
            }
    for (i = p->nodes - 1; o->shuffled && i > 0; i--) mixed_swap_nodes(p, i, (int)mixed_random(0.0, (double)i + 0.999));
    for (i = 0; i < p->vertices; i++) p->state[i] = 1;
    for (i = 0; i < o->pinned; i++) p->state[i * o->nx] = 2;
    p->mv = (double *)malloc((size_t)p->vertices * sizeof(double));
    p->mp = (double *)malloc((size_t)(p->nodes + 1) * sizeof(double));
    for (i = 0; i < p->nodes; i++) p->mp[i] = 1e-8 * mixed_random(0.1, 1.0) * pow(10.0, mixed_random(-o->uneven, 0.0));
    for (i = 0; i < p->vertices; i++) {
        int outside = i % o->nx >= o->nx - o->bare || i == thin; /* these need a mass of their own */
        double ratio = outside && o->ratio == 0.0 ? 1.0 : o->ratio;
        p->mv[i] = 1e-8 * ratio * 0.5 * (o->least + o->most) * mixed_random(0.1, 1.0);
        if (p->state[i] == 2) p->mv[i] = 0.0;
    }
}

static void mixed_unmake(mixed_patch *p) { free(p->state), free(p->triangle), free(p->beta), free(p->mv), free(p->mp); }

static yc_result mixed_create(mixed_patch *p, yci_mixed *m) {
    return yci_mixed_create(
        &p->c, p->vertices, p->state, p->nodes, (const int(*)[3])p->triangle, (const double(*)[3])p->beta, m);
}

/* B' x from the caller's own arrays; `only` the columns of t. */
static void mixed_gather(const mixed_patch *p, const yci_mixed *m, const double *x, double *v, int only) {
    double *all = mixed_vector(p->vertices, 0);
    int i, k;
    for (i = 0; i < p->nodes; i++)
        for (k = 0; k < 3; k++) yci_axpy(all + 3 * p->triangle[i][k], p->beta[i][k], x + 3 * i);
    if (!only) memcpy(v, all, (size_t)p->vertices * 3 * sizeof *v);
    else memset(v, 0, (size_t)p->vertices * 3 * sizeof *v);
    for (i = 0; only && i < m->t_count; i++) yci_copy(v + 3 * m->vertex[i], all + 3 * m->vertex[i]);
    free(all);
}

static void mixed_embed(const mixed_patch *p, const double *v, double *x) {
    int i, k;
    for (i = 0; i < p->nodes; i++) {
        x[3 * i] = x[3 * i + 1] = x[3 * i + 2] = 0.0;
        for (k = 0; k < 3; k++) yci_axpy(x + 3 * i, p->beta[i][k], v + 3 * p->triangle[i][k]);
    }
}

static int mixed_in_t(const yci_mixed *m, int vertex) {
    int i;
    for (i = 0; i < m->t_count; i++)
        if (m->vertex[i] == vertex) return 1;
    return 0;
}

/* The patches that all tests go through: plain; shuffled; pins, a bare strip and a thin vertex; few nodes. */
static mixed_options mixed_case(int which) {
    mixed_options o = mixed_plain();
    if (which == 1) o.shuffled = 1, o.least = 20, o.most = 60;
    if (which == 2) o.pinned = 3, o.bare = 2, o.nx = 8, o.thin = 1;
    if (which == 3) o.least = o.most = 20, o.pinned = 1, o.nx = 9;
    if (which == 4) o.least = o.most = 30, o.shuffled = 1, o.thin = 1, o.bare = 1, o.pinned = 2;
    return o;
}
#define MIXED_CASES 5

/* ---- kinematics -------------------------------------------------------------------------------------------------- */

TEST(mixed_products) {
    int which, i;
    for (which = 0; which < MIXED_CASES; which++) {
        mixed_options o = mixed_case(which);
        mixed_patch p;
        yci_mixed m;
        double *v, *x, *a, *b, *g;
        mixed_make(&p, &o, NULL);
        CHECK_RESULT(mixed_create(&p, &m), YC_OK);
        v = mixed_vector(p.vertices, 1), x = mixed_vector(p.nodes, 1);
        a = mixed_vector(p.nodes, 0), b = mixed_vector(p.nodes, 0), g = mixed_vector(p.vertices, 0);
        yci_mixed_embed(&m, v, a), mixed_embed(&p, v, b);
        CHECK(mixed_error(a, b, p.nodes) < 1e-15);
        yci_mixed_gather(&m, x, g); /* adds */
        CHECK(fabs(mixed_dot(a, x, p.nodes) - mixed_dot(v, g, p.vertices)) <
            1e-12 * mixed_error(a, NULL, p.nodes) * mixed_error(x, NULL, p.nodes));
        yci_mixed_gather(&m, x, g);
        free(b), b = mixed_vector(p.vertices, 0);
        mixed_gather(&p, &m, x, b, 0);
        for (i = 0; i < 3 * p.vertices; i++) g[i] *= 0.5;
        CHECK(mixed_error(g, b, p.vertices) < 1e-14);
        free(v), free(x), free(a), free(b), free(g);
        yci_mixed_destroy(&p.c, &m);
        CHECK(p.c.bytes == 0);
        mixed_unmake(&p);
    }
}

TEST(mixed_filter) {
    int which, i;
    for (which = 0; which < MIXED_CASES; which++) {
        mixed_options o = mixed_case(which);
        mixed_patch p;
        yci_mixed m;
        double *x, *y, *fx, *fy, *g, size;
        mixed_make(&p, &o, NULL);
        CHECK_RESULT(mixed_create(&p, &m), YC_OK);
        x = mixed_vector(p.nodes, 1), y = mixed_vector(p.nodes, 1), g = mixed_vector(p.vertices, 0);
        fx = mixed_vector(p.nodes, 0), fy = mixed_vector(p.nodes, 0);
        memcpy(fx, x, (size_t)p.nodes * 3 * sizeof *x), memcpy(fy, y, (size_t)p.nodes * 3 * sizeof *x);
        yci_mixed_filter(&m, fx), yci_mixed_filter(&m, fy);
        size = mixed_error(x, NULL, p.nodes);
        mixed_gather(&p, &m, fx, g, 1);
        CHECK(m.t_count > 0 && mixed_error(fx, x, p.nodes) > 1e-2);
        CHECK(mixed_error(g, NULL, p.vertices) < 1e-12 * size);                                   /* B'F = 0 */
        CHECK(fabs(mixed_dot(y, fx, p.nodes) - mixed_dot(fy, x, p.nodes)) < 1e-12 * size * size); /* F = F' */
        memcpy(y, fx, (size_t)p.nodes * 3 * sizeof *x);
        yci_mixed_filter(&m, y);
        CHECK(mixed_error(y, fx, p.nodes) < 1e-12); /* FF = F */
        /* What the triangles can do is filtered away entirely. */
        for (i = 0; i < 3 * p.vertices; i++) g[i] = mixed_in_t(&m, i / 3) ? mixed_random(-1.0, 1.0) : 0.0;
        mixed_embed(&p, g, y);
        size = mixed_error(y, NULL, p.nodes);
        yci_mixed_filter(&m, y);
        CHECK(mixed_error(y, NULL, p.nodes) < 1e-12 * size);
        free(x), free(y), free(fx), free(fy), free(g);
        yci_mixed_destroy(&p.c, &m);
        mixed_unmake(&p);
    }
}

/* T turns any p and any v outside t into (v, x) with p = B v + F x, and its transpose is its transpose. */
TEST(mixed_split) {
    int which, i;
    for (which = 0; which < MIXED_CASES; which++) {
        mixed_options o = mixed_case(which);
        mixed_patch p;
        yci_mixed m;
        double *v, *x, *v2, *x2, *r_v, *r_x, *s_v, *s_x, *q, *g, left, right;
        mixed_make(&p, &o, NULL);
        CHECK_RESULT(mixed_create(&p, &m), YC_OK);
        v = mixed_vector(p.vertices, 1), x = mixed_vector(p.nodes, 1);
        v2 = mixed_vector(p.vertices, 0), x2 = mixed_vector(p.nodes, 0), q = mixed_vector(p.nodes, 0);
        r_v = mixed_vector(p.vertices, 1), r_x = mixed_vector(p.nodes, 1), g = mixed_vector(p.vertices, 0);
        s_v = mixed_vector(p.vertices, 0), s_x = mixed_vector(p.nodes, 0);
        memcpy(v2, v, (size_t)p.vertices * 3 * sizeof *v), memcpy(x2, x, (size_t)p.nodes * 3 * sizeof *x);
        yci_mixed_split(&m, x2, v2);
        for (i = 0; i < p.vertices; i++)
            if (!mixed_in_t(&m, i)) CHECK(memcmp(v + 3 * i, v2 + 3 * i, 3 * sizeof *v) == 0);
        mixed_gather(&p, &m, x2, g, 1);
        CHECK(mixed_error(g, NULL, p.vertices) < 1e-12 * mixed_error(x, NULL, p.nodes)); /* x is filtered */
        yci_mixed_embed(&m, v2, q);
        for (i = 0; i < 3 * p.nodes; i++) q[i] += x2[i];
        CHECK(mixed_error(q, x, p.nodes) < 1e-13); /* C T = 1 on p */
        /* The fit comes back when the yarns lie where the triangles carry them, and project is the first half of T. */
        memcpy(g, v2, (size_t)p.vertices * 3 * sizeof *v);
        yci_mixed_embed(&m, v2, q);
        for (i = 0; i < m.t_count; i++) g[3 * m.vertex[i]] = 7.0;
        yci_mixed_project(&m, q, g);
        CHECK(mixed_error(g, v2, p.vertices) < 1e-12);
        memcpy(g, v, (size_t)p.vertices * 3 * sizeof *v);
        yci_mixed_project(&m, x, g);
        CHECK(mixed_error(g, v2, p.vertices) < 1e-15);
        /* <r, T s> = <T' r, s>, s without components on t. */
        for (i = 0; i < m.t_count; i++) v[3 * m.vertex[i]] = v[3 * m.vertex[i] + 1] = v[3 * m.vertex[i] + 2] = 0.0;
        memcpy(s_v, r_v, (size_t)p.vertices * 3 * sizeof *v), memcpy(s_x, r_x, (size_t)p.nodes * 3 * sizeof *x);
        yci_mixed_split_transposed(&m, s_x, s_v);
        left = mixed_dot(r_v, v2, p.vertices) + mixed_dot(r_x, x2, p.nodes);
        right = mixed_dot(s_v, v, p.vertices) + mixed_dot(s_x, x, p.nodes);
        CHECK(fabs(left - right) < 1e-12 * mixed_error(s_x, NULL, p.nodes) * mixed_error(x, NULL, p.nodes));
        for (i = 0, left = 0.0; i < m.t_count; i++) left += fabs(s_v[3 * m.vertex[i]]);
        CHECK(left == 0.0);
        free(v), free(x), free(v2), free(x2), free(r_v), free(r_x), free(s_v), free(s_x), free(q), free(g);
        yci_mixed_destroy(&p.c, &m);
        mixed_unmake(&p);
    }
}

TEST(mixed_columns) {
    mixed_options o = mixed_plain();
    mixed_patch p;
    yci_mixed m;
    int i, k;
    /* Everything is covered here: all vertices but the pinned ones carry the filter. */
    o.pinned = 2;
    mixed_make(&p, &o, NULL);
    CHECK_RESULT(mixed_create(&p, &m), YC_OK);
    CHECK(m.t_count == p.vertices - 2 && m.free_count == m.t_count && m.column_count == p.vertices);
    CHECK(!mixed_in_t(&m, 0) && !mixed_in_t(&m, o.nx) && mixed_in_t(&m, 1));
    CHECK(m.run_count == 2 * (o.nx - 1) * (o.ny - 1));
    yci_mixed_destroy(&p.c, &m);
    mixed_unmake(&p);
    /* A thin vertex leaves, a bare strip has no columns. */
    o.pinned = 0, o.thin = 1, o.bare = 2, o.nx = 8;
    mixed_make(&p, &o, NULL);
    CHECK_RESULT(mixed_create(&p, &m), YC_OK);
    CHECK(m.column_count == 6 * o.ny && m.free_count == m.column_count && m.t_count == m.free_count - 1);
    CHECK(m.vertex[m.t_count] == 5);
    yci_mixed_destroy(&p.c, &m);
    mixed_unmake(&p);
    /* Two nodes on a line in one triangle carry two of its three vertices. */
    o = mixed_plain(), o.nx = o.ny = 2, o.least = o.most = 2;
    mixed_make(&p, &o, NULL);
    p.nodes = 2;
    CHECK_RESULT(mixed_create(&p, &m), YC_OK);
    CHECK(m.t_count == 2 && m.free_count == 3 && m.column_count == 3);
    yci_mixed_destroy(&p.c, &m);
    /* A cloud of nodes on one line does no more, however many there are. */
    mixed_unmake(&p);
    o.least = o.most = 100;
    mixed_make(&p, &o, NULL);
    p.nodes = 100;
    for (i = 0; i < p.nodes; i++) {
        double s = mixed_random(0.0, 1.0);
        for (k = 0; k < 3; k++) p.beta[i][k] = k == 0 ? 0.2 + 0.5 * s : k == 1 ? 0.7 - 0.4 * s : 0.1 - 0.1 * s;
    }
    CHECK_RESULT(mixed_create(&p, &m), YC_OK);
    CHECK(m.t_count == 2 && m.free_count == 3);
    yci_mixed_destroy(&p.c, &m);
    mixed_unmake(&p);
    /* Fewer nodes than vertices over a whole patch: as many carry the filter as there are nodes, or nearly. */
    o = mixed_plain(), o.nx = o.ny = 12, o.least = 0, o.most = 1, o.shuffled = 1;
    mixed_make(&p, &o, NULL);
    p.nodes = 90;
    CHECK_RESULT(mixed_create(&p, &m), YC_OK);
    CHECK(m.t_count > 45 && m.t_count <= 90 && m.t_count < m.free_count);
    {
        double *x = mixed_vector(p.nodes, 1), *g = mixed_vector(p.vertices, 0), size = mixed_error(x, NULL, p.nodes);
        yci_mixed_filter(&m, x);
        mixed_gather(&p, &m, x, g, 1);
        CHECK(mixed_error(g, NULL, p.vertices) < 1e-11 * size);
        free(x), free(g);
    }
    yci_mixed_destroy(&p.c, &m);
    mixed_unmake(&p);
}

/* Any schedule gives the same bits. */
TEST(mixed_workers) {
    mixed_options o = mixed_case(1);
    double *z[3][2];
    int turn, i;
    for (turn = 0; turn < 3; turn++) {
        yc_host host = turn ? test_host_threads(turn == 1 ? 0 : 3) : test_host_counting();
        mixed_patch p;
        yci_mixed m;
        yci_mass_p mass;
        mixed_make(&p, &o, &host);
        CHECK(mixed_create(&p, &m) == YC_OK && yci_mass_create(&p.c, &m, &mass) == YC_OK);
        CHECK_RESULT(yci_mass_factor(&mass, p.mv, p.mp), YC_OK);
        z[turn][0] = mixed_vector(p.vertices, 1), z[turn][1] = mixed_vector(p.nodes, 1);
        yci_mixed_split_transposed(&m, z[turn][1], z[turn][0]);
        yci_mixed_split(&m, z[turn][1], z[turn][0]);
        yci_mass_apply(&mass, z[turn][0], z[turn][1], z[turn][0], z[turn][1]);
        for (i = 0; i < 2; i++)
            CHECK(memcmp(z[0][i], z[turn][i], (size_t)(i ? p.nodes : p.vertices) * 3 * sizeof(double)) == 0);
        yci_mass_destroy(&p.c, &mass), yci_mixed_destroy(&p.c, &m);
        mixed_unmake(&p);
    }
    for (i = 0; i < 6; i++) free(z[i / 2][i % 2]);
}

/* ---- mass preconditioner ----------------------------------------------------------------------------------------- */

/* Both forms on a patch, for the residual S M S z of a known z. Errors: residual of the sparse form, difference of the
 * dense one from it, error of the sparse one in the norm of the kinetic energy. */
static void mixed_compare_mass(const mixed_options *o, double error[3]) {
    mixed_patch p;
    yci_mixed m;
    yci_mass_p mass;
    yci_mass_dense dense;
    double *r_v, *r_x, *z_v, *z_x, *a_v, *a_x, *y_v, *y_x, size, e;
    int i;
    mixed_make(&p, o, NULL);
    CHECK_RESULT(mixed_create(&p, &m), YC_OK);
    CHECK(yci_mass_create(&p.c, &m, &mass) == YC_OK && yci_mass_factor(&mass, p.mv, p.mp) == YC_OK);
    CHECK(yci_mass_dense_create(&p.c, &m, &dense) == YC_OK && yci_mass_dense_factor(&dense, p.mv, p.mp) == YC_OK);
    r_v = mixed_vector(p.vertices, 1), r_x = mixed_vector(p.nodes, 1);
    z_v = mixed_vector(p.vertices, 1), z_x = mixed_vector(p.nodes, 1);
    a_v = mixed_vector(p.vertices, 0), a_x = mixed_vector(p.nodes, 0);
    y_v = mixed_vector(p.vertices, 1), y_x = mixed_vector(p.nodes, 1);
    for (i = 0; i < 3 * p.vertices; i++)
        if (p.state[i / 3] != 1) z_v[i] = 0.0;
    yci_mixed_filter(&m, z_x);
    yci_mixed_mass_multiply(&m, p.mv, p.mp, z_v, z_x, r_v, r_x); /* r = S M S z */
    yci_mass_apply(&mass, r_v, r_x, y_v, y_x);
    yci_mixed_mass_multiply(&m, p.mv, p.mp, y_v, y_x, a_v, a_x);
    size = mixed_dot(r_v, z_v, p.vertices) + mixed_dot(r_x, z_x, p.nodes);
    for (i = 0; i < 3 * p.vertices; i++) a_v[i] -= r_v[i], y_v[i] -= z_v[i];
    for (i = 0; i < 3 * p.nodes; i++) a_x[i] -= r_x[i], y_x[i] -= z_x[i];
    e = mixed_error(r_v, NULL, p.vertices) + mixed_error(r_x, NULL, p.nodes);
    error[0] = (mixed_error(a_v, NULL, p.vertices) + mixed_error(a_x, NULL, p.nodes)) / e;
    yci_mixed_mass_multiply(&m, p.mv, p.mp, y_v, y_x, a_v, a_x);
    error[2] = sqrt(fabs(mixed_dot(y_v, a_v, p.vertices) + mixed_dot(y_x, a_x, p.nodes)) / size);
    for (i = 0; i < 3 * p.vertices; i++) a_v[i] = y_v[i] + z_v[i];
    for (i = 0; i < 3 * p.nodes; i++) a_x[i] = y_x[i] + z_x[i];
    yci_mass_dense_apply(&dense, r_v, r_x, y_v, y_x);
    error[1] = yci_max(mixed_error(y_v, a_v, p.vertices), mixed_error(y_x, a_x, p.nodes));
    free(r_v), free(r_x), free(z_v), free(z_x), free(a_v), free(a_x), free(y_v), free(y_x);
    yci_mass_dense_destroy(&p.c, &dense), yci_mass_destroy(&p.c, &mass), yci_mixed_destroy(&p.c, &m);
    CHECK(p.c.bytes == 0);
    mixed_unmake(&p);
}

TEST(mixed_mass) {
    static const double ratio[10] = {1.0, 0.0, 1e-8, 1e-4, 1e-2, 1e2, 1e4, 1e8, 1e-4, 1e4};
    int which, r;
    for (which = 0; which < MIXED_CASES; which++)
        for (r = 0; r < 10; r++) {
            mixed_options o = mixed_case(which);
            double error[3];
            o.ratio = ratio[r], o.uneven = r < 8 ? 0.0 : 8.0;
            mixed_compare_mass(&o, error);
            CHECK(error[0] < 1e-9);
            CHECK(error[1] < (r < 8 ? 1e-9 : 1e-8)); /* the condition number is 1e8 and more */
            CHECK(error[2] < 1e-9);
        }
}

/* z is filtered, does not depend on the unfiltered part of r_x, P^-1 is symmetric, and arguments may share memory. */
TEST(mixed_mass_properties) {
    int which, i;
    for (which = 0; which < MIXED_CASES; which++) {
        mixed_options o = mixed_case(which);
        mixed_patch p;
        yci_mixed m;
        yci_mass_p mass;
        double *v[4], *x[4], a, b;
        mixed_make(&p, &o, NULL);
        CHECK_RESULT(mixed_create(&p, &m), YC_OK);
        CHECK(yci_mass_create(&p.c, &m, &mass) == YC_OK && yci_mass_factor(&mass, p.mv, p.mp) == YC_OK);
        for (i = 0; i < 4; i++) v[i] = mixed_vector(p.vertices, i < 2), x[i] = mixed_vector(p.nodes, i < 2);
        for (i = 0; i < 2; i++) yci_mass_apply(&mass, v[i], x[i], v[2 + i], x[2 + i]);
        a = mixed_dot(v[0], v[3], p.vertices) + mixed_dot(x[0], x[3], p.nodes);
        b = mixed_dot(v[1], v[2], p.vertices) + mixed_dot(x[1], x[2], p.nodes);
        CHECK(fabs(a - b) < 1e-11 * mixed_error(x[0], NULL, p.nodes) * mixed_error(x[3], NULL, p.nodes));
        for (i = 0; i < p.vertices; i++)
            if (p.state[i] != 1) CHECK(v[2][3 * i] == 0.0 && v[2][3 * i + 1] == 0.0 && v[2][3 * i + 2] == 0.0);
        mixed_gather(&p, &m, x[2], v[3], 1);
        CHECK(mixed_error(v[3], NULL, p.vertices) < 1e-11 * mixed_error(x[2], NULL, p.nodes));
        yci_mixed_filter(&m, x[0]);
        yci_mass_apply(&mass, v[0], x[0], v[0], x[0]);
        CHECK(mixed_error(v[0], v[2], p.vertices) < 1e-11 && mixed_error(x[0], x[2], p.nodes) < 1e-11);
        for (i = 0; i < 4; i++) free(v[i]), free(x[i]);
        yci_mass_destroy(&p.c, &mass), yci_mixed_destroy(&p.c, &m);
        mixed_unmake(&p);
    }
}

/* The paper's form inverts P = S M + u (1 - S) on every vector, filtered or not, u the mean mass of a node; and the
 * product S M S leaves out what known vertices and unfiltered displacements bring. */
TEST(mixed_mass_paper) {
    int which, i;
    for (which = 1; which < MIXED_CASES; which++) {
        mixed_options o = mixed_case(which);
        mixed_patch p;
        yci_mixed m;
        yci_mass_dense dense;
        double *v, *x, *y, *r_v, *r_x, *z_v, *z_x, unit = 0.0;
        mixed_make(&p, &o, NULL);
        CHECK_RESULT(mixed_create(&p, &m), YC_OK);
        CHECK(yci_mass_dense_create(&p.c, &m, &dense) == YC_OK && yci_mass_dense_factor(&dense, p.mv, p.mp) == YC_OK);
        v = mixed_vector(p.vertices, 1), x = mixed_vector(p.nodes, 1), y = mixed_vector(p.nodes, 0);
        r_v = mixed_vector(p.vertices, 0), r_x = mixed_vector(p.nodes, 0);
        z_v = mixed_vector(p.vertices, 0), z_x = mixed_vector(p.nodes, 0);
        yci_mixed_mass_multiply(&m, p.mv, p.mp, v, x, z_v, z_x);
        for (i = 0; i < 3 * p.vertices; i++)
            if (p.state[i / 3] != 1) v[i] = 0.0;
        memcpy(y, x, (size_t)p.nodes * 3 * sizeof *x);
        yci_mixed_filter(&m, y);
        yci_mixed_mass_multiply(&m, p.mv, p.mp, v, y, r_v, r_x);
        CHECK(mixed_error(z_v, r_v, p.vertices) < 1e-13 && mixed_error(z_x, r_x, p.nodes) < 1e-13);
        for (i = 0; i < p.nodes; i++) unit += p.mp[i] / p.nodes;
        mixed_embed(&p, v, r_x);
        for (i = 0; i < 3 * p.nodes; i++) r_x[i] = p.mp[i / 3] * (r_x[i] + x[i]); /* M's second row */
        mixed_gather(&p, &m, r_x, r_v, 0);
        for (i = 0; i < 3 * p.vertices; i++) r_v[i] = p.state[i / 3] == 1 ? r_v[i] + p.mv[i / 3] * v[i] : 0.0;
        yci_mixed_filter(&m, r_x);
        for (i = 0; i < 3 * p.nodes; i++) r_x[i] += unit * (x[i] - y[i]);
        yci_mass_dense_apply(&dense, r_v, r_x, r_v, z_x);
        CHECK(mixed_error(r_v, v, p.vertices) < 1e-10 && mixed_error(z_x, x, p.nodes) < 1e-10);
        free(v), free(x), free(y), free(r_v), free(r_x), free(z_v), free(z_x);
        yci_mass_dense_destroy(&p.c, &dense), yci_mixed_destroy(&p.c, &m);
        mixed_unmake(&p);
    }
}

/* Conjugate gradients on S M S d = r with P: one step does it, and a second polishes. */
TEST(mixed_mass_cg) {
    int which, i, k;
    for (which = 0; which < MIXED_CASES; which++) {
        mixed_options o = mixed_case(which);
        mixed_patch p;
        yci_mixed m;
        yci_mass_p mass;
        double *r_v, *r_x, *z_v, *z_x, *d_v, *d_x, *y_v, *y_x, rz, start = 0.0;
        mixed_make(&p, &o, NULL);
        CHECK_RESULT(mixed_create(&p, &m), YC_OK);
        CHECK(yci_mass_create(&p.c, &m, &mass) == YC_OK && yci_mass_factor(&mass, p.mv, p.mp) == YC_OK);
        r_v = mixed_vector(p.vertices, 1), r_x = mixed_vector(p.nodes, 1);
        z_v = mixed_vector(p.vertices, 0), z_x = mixed_vector(p.nodes, 0);
        d_v = mixed_vector(p.vertices, 0), d_x = mixed_vector(p.nodes, 0);
        y_v = mixed_vector(p.vertices, 0), y_x = mixed_vector(p.nodes, 0);
        for (i = 0; i < 3 * p.vertices; i++)
            if (p.state[i / 3] != 1) r_v[i] = 0.0;
        yci_mixed_filter(&m, r_x);
        for (k = 0, rz = 0.0; k < 3; k++) {
            double before = rz, step;
            yci_mass_apply(&mass, r_v, r_x, z_v, z_x);
            rz = mixed_dot(r_v, z_v, p.vertices) + mixed_dot(r_x, z_x, p.nodes);
            if (!k) start = rz;
            CHECK(k == 0 || fabs(rz) < 1e-18 * start);
            if (k == 2) break;
            for (i = 0; i < 3 * p.vertices; i++) d_v[i] = z_v[i] + (k ? rz / before * d_v[i] : 0.0);
            for (i = 0; i < 3 * p.nodes; i++) d_x[i] = z_x[i] + (k ? rz / before * d_x[i] : 0.0);
            yci_mixed_mass_multiply(&m, p.mv, p.mp, d_v, d_x, y_v, y_x);
            step = rz / (mixed_dot(d_v, y_v, p.vertices) + mixed_dot(d_x, y_x, p.nodes));
            for (i = 0; i < 3 * p.vertices; i++) r_v[i] -= step * y_v[i];
            for (i = 0; i < 3 * p.nodes; i++) r_x[i] -= step * y_x[i];
        }
        free(r_v), free(r_x), free(z_v), free(z_x), free(d_v), free(d_x), free(y_v), free(y_x);
        yci_mass_destroy(&p.c, &mass), yci_mixed_destroy(&p.c, &m);
        mixed_unmake(&p);
    }
}

TEST(mixed_mass_diagonal) {
    mixed_options o = mixed_case(2);
    mixed_patch p;
    yci_mixed m;
    double *v, *x, *out_v, *out_x, *d;
    int i;
    mixed_make(&p, &o, NULL);
    CHECK_RESULT(mixed_create(&p, &m), YC_OK);
    d = mixed_vector(p.vertices, 0);
    for (i = 0; i < p.vertices; i++) d[i] = p.mv[i];
    yci_mixed_mass_diagonal(&m, p.mp, d);
    v = mixed_vector(p.vertices, 0), x = mixed_vector(p.nodes, 0);
    out_v = mixed_vector(p.vertices, 0), out_x = mixed_vector(p.nodes, 0);
    for (i = 0; i < p.vertices; i++) {
        if (p.state[i] != 1) continue;
        v[3 * i + 1] = 1.0;
        yci_mixed_mass_multiply(&m, p.mv, p.mp, v, x, out_v, out_x);
        v[3 * i + 1] = 0.0;
        CHECK(fabs(out_v[3 * i + 1] - d[i]) < 1e-13 * d[i]);
    }
    free(v), free(x), free(out_v), free(out_x), free(d);
    yci_mixed_destroy(&p.c, &m);
    mixed_unmake(&p);
}

/* ---- edges ------------------------------------------------------------------------------------------------------- */

TEST(mixed_empty) {
    mixed_options o = mixed_plain();
    mixed_patch p;
    int turn, i;
    o.nx = o.ny = 3, o.least = o.most = 20;
    mixed_make(&p, &o, NULL);
    for (turn = 0; turn < 3; turn++) { /* no nodes; every vertex known; nothing at all */
        yci_mixed m;
        yci_mass_p mass;
        yci_mass_dense dense;
        double *v = mixed_vector(p.vertices, 1), *x = mixed_vector(p.nodes, 1), *z_v = mixed_vector(p.vertices, 0);
        double *z_x = mixed_vector(p.nodes, 0);
        if (turn == 0 || turn == 2) p.nodes = 0;
        if (turn == 1) p.nodes = 2 * 4 * 20, memset(p.state, 2, (size_t)p.vertices);
        if (turn == 2) p.vertices = 0;
        CHECK(mixed_create(&p, &m) == YC_OK && m.t_count == 0);
        yci_mixed_filter(&m, x), yci_mixed_project(&m, x, v);
        CHECK(yci_mass_create(&p.c, &m, &mass) == YC_OK && yci_mass_dense_create(&p.c, &m, &dense) == YC_OK);
        CHECK(yci_mass_factor(&mass, p.mv, p.mp) == YC_OK && yci_mass_dense_factor(&dense, p.mv, p.mp) == YC_OK);
        yci_mass_apply(&mass, v, x, z_v, z_x);
        for (i = 0; i < 3 * p.vertices; i++)
            CHECK(turn == 1 ? z_v[i] == 0.0 : fabs(z_v[i] * p.mv[i / 3] - v[i]) < 1e-12);
        for (i = 0; i < 3 * p.nodes; i++) CHECK(fabs(z_x[i] * p.mp[i / 3] - x[i]) < 1e-12);
        yci_mass_dense_apply(&dense, v, x, z_v, z_x);
        for (i = 0; i < 3 * p.vertices; i++)
            CHECK(turn == 1 ? z_v[i] == 0.0 : fabs(z_v[i] * p.mv[i / 3] - v[i]) < 1e-12);
        for (i = 0; i < 3 * p.nodes; i++) CHECK(fabs(z_x[i] * p.mp[i / 3] - x[i]) < 1e-12);
        yci_mixed_split_transposed(&m, x, v), yci_mixed_split(&m, x, v);
        yci_mass_dense_destroy(&p.c, &dense), yci_mass_destroy(&p.c, &mass), yci_mixed_destroy(&p.c, &m);
        CHECK(p.c.bytes == 0);
        free(v), free(x), free(z_v), free(z_x);
        if (turn == 0) p.nodes = 2 * 4 * 20;
    }
    mixed_unmake(&p);
}

TEST(mixed_refused) {
    mixed_options o = mixed_case(4);
    mixed_patch p;
    yci_mixed m;
    yci_mass_p mass;
    double keep;
    int outside;
    mixed_make(&p, &o, NULL);
    CHECK(mixed_create(&p, &m) == YC_OK && yci_mass_create(&p.c, &m, &mass) == YC_OK);
    outside = m.vertex[m.t_count], keep = p.mv[outside], p.mv[outside] = 0.0;
    CHECK(m.free_count == m.t_count + 1);
    CHECK(yci_mass_factor(&mass, p.mv, p.mp) == YC_ERROR_SINGULAR && strstr(p.c.message, "vertex") != NULL);
    p.mv[outside] = keep, p.mp[7] = 0.0;
    CHECK(yci_mass_factor(&mass, p.mv, p.mp) == YC_ERROR_SINGULAR && strstr(p.c.message, "node 7") != NULL);
    p.mp[7] = 1e-8;
    CHECK_RESULT(yci_mass_factor(&mass, p.mv, p.mp), YC_OK);
    yci_mass_destroy(&p.c, &mass), yci_mixed_destroy(&p.c, &m);
    mixed_unmake(&p);
}

TEST(mixed_out_of_memory) {
    mixed_options o = mixed_case(4);
    yc_host host = test_host_counting();
    mixed_patch p;
    int limit, done = 0, bad = 0;
    o.nx = 4, o.ny = 3;
    mixed_make(&p, &o, &host);
    for (limit = 0; !done && limit < 2000; limit++) {
        yci_mixed m;
        yci_mass_p mass;
        yci_mass_dense dense;
        yc_result result;
        test_heap_grant(limit);
        memset(&mass, 0, sizeof mass), memset(&dense, 0, sizeof dense);
        result = mixed_create(&p, &m);
        if (result == YC_OK) result = yci_mass_create(&p.c, &m, &mass);
        if (result == YC_OK) result = yci_mass_dense_create(&p.c, &m, &dense);
        if (result == YC_OK) result = yci_mass_factor(&mass, p.mv, p.mp);
        if (result == YC_OK) result = yci_mass_dense_factor(&dense, p.mv, p.mp);
        done = result == YC_OK;
        bad += !done && result != YC_ERROR_MEMORY;
        yci_mass_dense_destroy(&p.c, &dense), yci_mass_destroy(&p.c, &mass), yci_mixed_destroy(&p.c, &m);
        bad += test_heap.live != 0 || p.c.bytes != 0;
    }
    CHECK(done && limit > 40 && bad == 0);
    mixed_unmake(&p);
}
