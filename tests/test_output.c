/* Curves of yarns, tubes around them, finer meshes, and the region that gets yarns. */
#include "test.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- a small woven network ----------------------------------------------------------------------------------------
 * COLUMNS warps and ROWS wefts; node r * COLUMNS + c where they cross, as a plain weave. Wefts are the first yarns. */

enum { COLUMNS = 7, ROWS = 5, NODES = COLUMNS * ROWS, YARNS = COLUMNS + ROWS, VISITS = 2 * NODES };
#define SPACING 1e-3
#define RADIUS 2e-4 /* of wefts; warps have half of it */

typedef struct {
    yc_yarns yarns;
    double layout[NODES][3], u[VISITS];
    int first[YARNS + 1], material[YARNS], node[VISITS];
    unsigned char family[YARNS], held[VISITS];
    signed char layer[VISITS];
    yc_yarn_material materials[2];
} cloth;

static double row(int node) { return floor((double)node / COLUMNS); }

static void cloth_make(cloth *w) {
    int yarn, i, v = 0;
    memset(w, 0, sizeof *w);
    w->materials[0] = w->materials[1] = yc_yarn_material_default();
    w->materials[0].radius = RADIUS, w->materials[1].radius = 0.5 * RADIUS;
    for (i = 0; i < NODES; i++) w->layout[i][0] = SPACING * (i % COLUMNS), w->layout[i][1] = SPACING * row(i);
    for (yarn = 0; yarn < YARNS; yarn++) {
        int weft = yarn < ROWS, line = weft ? yarn : yarn - ROWS;
        w->first[yarn] = v, w->family[yarn] = weft ? YC_WEFT : YC_WARP, w->material[yarn] = !weft;
        for (i = 0; i < (weft ? COLUMNS : ROWS); i++, v++) {
            w->node[v] = weft ? line * COLUMNS + i : i * COLUMNS + line;
            w->u[v] = SPACING * i, w->held[v] = 1;
            w->layer[v] = (signed char)(((line + i) % 2 == 0) == weft ? 1 : -1);
        }
    }
    w->first[YARNS] = v;
    w->yarns.node_count = NODES, w->yarns.layout = w->layout;
    w->yarns.yarn_count = YARNS, w->yarns.yarn_first = w->first, w->yarns.yarn_family = w->family;
    w->yarns.yarn_material = w->material, w->yarns.visit_count = VISITS, w->yarns.visit_node = w->node;
    w->yarns.visit_u = w->u, w->yarns.visit_layer = w->layer, w->yarns.visit_held = w->held;
    w->yarns.material_count = 2, w->yarns.materials = w->materials;
}

/* One yarn alone through the given nodes. */
static void cloth_single(cloth *w, int count) {
    int i;
    cloth_make(w);
    w->yarns.node_count = w->yarns.visit_count = count, w->yarns.yarn_count = 1, w->first[1] = count;
    for (i = 0; i < count; i++) w->node[i] = i, w->layer[i] = 0, w->u[i] = SPACING * i;
}

static void bend(double (*x)[3]) {
    int i;
    for (i = 0; i < NODES; i++) {
        double u = SPACING * (i % COLUMNS), v = SPACING * row(i);
        x[i][0] = u + 0.1 * v, x[i][1] = v - 2e-4 * sin(900.0 * u), x[i][2] = 8e-4 * sin(700.0 * u + 400.0 * v);
    }
}

#define CONST3(x) ((const double(*)[3])(x))
#define CONST3I(x) ((const int(*)[3])(x))

static yc_result curves_fill(
    const yc_host *host, const cloth *w, double (*x)[3], const yc_curve_desc *desc, yc_curves *out) {
    char message[YC_MESSAGE_SIZE];
    memset(out, 0, sizeof *out);
    if (!CHECK_RESULT(yc_curves_make(host, &w->yarns, NULL, desc, out, message), YC_OK)) return YC_ERROR_ARGUMENT;
    out->first = (int *)malloc(sizeof(int) * (size_t)(out->curve_count + 1));
    out->points = (float(*)[3])malloc(sizeof(float[3]) * (size_t)(out->point_count + 1));
    out->radius = (float *)malloc(sizeof(float) * (size_t)(out->curve_count + 1));
    out->yarn = (int *)malloc(sizeof(int) * (size_t)(out->curve_count + 1));
    return yc_curves_make(host, &w->yarns, CONST3(x), desc, out, message);
}

static void curves_free(yc_curves *c) { free(c->first), free(c->points), free(c->radius), free(c->yarn); }

static void cross(double *out, const double *a, const double *b) {
    out[0] = a[1] * b[2] - a[2] * b[1], out[1] = a[2] * b[0] - a[0] * b[2], out[2] = a[0] * b[1] - a[1] * b[0];
}
static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static void difference(double *out, const double *a, const double *b) {
    int k;
    for (k = 0; k < 3; k++) out[k] = a[k] - b[k];
}
static int same_points(float (*a)[3], float (*b)[3], int count) {
    int i;
    for (i = 0; i < 3 * count; i++)
        if (a[i / 3][i % 3] != b[i / 3][i % 3]) return 0;
    return 1;
}
static void widen(double *out, const float *a) {
    int k;
    for (k = 0; k < 3; k++) out[k] = (double)a[k];
}

/* ---- curves ------------------------------------------------------------------------------------------------------ */

TEST(output_curves_pass_beside_nodes) {
    static cloth w;
    double x[NODES][3], p[3], d[3], n[3] = {0.0, -0.6, 0.8};
    yc_curve_desc desc = yc_curve_desc_default();
    yc_curves c;
    int i, yarn;
    cloth_make(&w);
    /* A flat cloth, turned about the x axis: its normal is known. */
    for (i = 0; i < NODES; i++)
        x[i][0] = w.layout[i][0], x[i][1] = 0.8 * w.layout[i][1], x[i][2] = 0.6 * w.layout[i][1];
    desc.offset = 0.9;
    if (CHECK_RESULT(curves_fill(NULL, &w, x, &desc, &c), YC_OK)) {
        CHECK(c.curve_count == YARNS && c.point_count == 2 * VISITS * 2 - 3 * YARNS && c.first[YARNS] == c.point_count);
        for (yarn = 0; yarn < YARNS; yarn++) {
            CHECK(c.yarn[yarn] == yarn);
            CHECK_NEAR((double)c.radius[yarn], w.materials[yarn >= ROWS].radius, 1e-10);
            for (i = w.first[yarn]; i < w.first[yarn + 1]; i++) {
                int k;
                widen(p, c.points[c.first[yarn] + desc.steps * (i - w.first[yarn])]);
                for (k = 0; k < 3; k++) d[k] = x[w.node[i]][k] + 0.9 * 0.75 * RADIUS * w.layer[i] * n[k];
                CHECK_NEAR_ALL(p, d, 3, 1e-9);
            }
        }
    }
    curves_free(&c);
    /* Bent, upper and lower yarn are a sum of radii apart, symmetric to the node, across both directions. */
    bend(x), desc.offset = 1.0, desc.steps = 1;
    if (CHECK_RESULT(curves_fill(NULL, &w, x, &desc, &c), YC_OK)) {
        CHECK(c.point_count == VISITS);
        for (i = 0; i < NODES; i++) {
            int line = i / COLUMNS, column = i % COLUMNS;
            double weft[3], warp[3], chord[2][3], middle[3], gap[3];
            double side = w.layer[line * COLUMNS + column];
            int k;
            widen(weft, c.points[line * COLUMNS + column]), widen(warp, c.points[NODES + column * ROWS + line]);
            difference(gap, weft, warp);
            CHECK_NEAR(sqrt(dot(gap, gap)), 1.5 * RADIUS, 1e-9);
            for (k = 0; k < 3; k++) middle[k] = 0.5 * (weft[k] + warp[k]);
            CHECK_NEAR_ALL(middle, x[i], 3, 1e-9);
            if (!line || !column || line == ROWS - 1 || column == COLUMNS - 1) continue;
            difference(chord[0], x[i + 1], x[i - 1]), difference(chord[1], x[i + COLUMNS], x[i - COLUMNS]);
            cross(n, chord[0], chord[1]);
            CHECK(side * dot(n, gap) > 0.95 * sqrt(dot(n, n) * dot(gap, gap)));
        }
    }
    curves_free(&c);
}

TEST(output_curves_side_is_the_patterns) {
    static cloth w, reversed;
    double x[NODES][3];
    yc_curve_desc desc = yc_curve_desc_default();
    yc_curves c[2];
    int i, k;
    bend(x);
    cloth_make(&w), reversed = w, reversed.yarns = w.yarns;
    reversed.yarns.visit_node = reversed.node, reversed.yarns.visit_layer = reversed.layer;
    for (i = 0; i < COLUMNS; i++) { /* the second weft runs the other way */
        reversed.node[COLUMNS + i] = w.node[2 * COLUMNS - 1 - i];
        reversed.layer[COLUMNS + i] = w.layer[2 * COLUMNS - 1 - i];
    }
    CHECK_RESULT(curves_fill(NULL, &w, x, &desc, &c[0]), YC_OK);
    CHECK_RESULT(curves_fill(NULL, &reversed, x, &desc, &c[1]), YC_OK);
    CHECK(c[0].point_count == c[1].point_count);
    for (i = 0; i < c[0].point_count; i++) {
        int same = i < c[0].first[1] || i >= c[0].first[2], other = same ? i : c[0].first[1] + c[0].first[2] - 1 - i;
        for (k = 0; k < 3; k++) CHECK_NEAR((double)c[0].points[i][k], (double)c[1].points[other][k], 1e-9);
    }
    curves_free(&c[0]), curves_free(&c[1]);
}

/* At a fold of 120 degrees the best plane of the four segments would be square to the cloth. */
TEST(output_curves_offset_outward_at_a_fold) {
    static cloth w;
    double x[NODES][3], p[3], d[3];
    yc_curve_desc desc = yc_curve_desc_default();
    yc_curves c;
    int i;
    cloth_make(&w);
    for (i = 0; i < NODES; i++) {
        double v = SPACING * (row(i) - 2.0);
        x[i][0] = SPACING * (i % COLUMNS), x[i][1] = v * cos(1.0472), x[i][2] = -fabs(v) * sin(1.0472);
    }
    desc.steps = 1;
    CHECK_RESULT(curves_fill(NULL, &w, x, &desc, &c), YC_OK);
    for (i = 2 * COLUMNS; i < 3 * COLUMNS; i++) {
        widen(p, c.points[i]), difference(d, p, x[i]);
        CHECK_NEAR(d[2], w.layer[i] * 0.75 * RADIUS, 1e-9);
        CHECK_NEAR(fabs(d[0]) + fabs(d[1]), 0.0, 1e-9);
    }
    curves_free(&c);
}

TEST(output_curves_leave_lone_visits_and_rods) {
    static cloth w;
    double x[NODES][3], p[3];
    yc_curve_desc desc = yc_curve_desc_default();
    yc_curves c;
    int i;
    cloth_make(&w), bend(x);
    for (i = 0; i < ROWS; i += 2) w.family[i] = YC_ROD;
    desc.steps = 1;
    CHECK_RESULT(curves_fill(NULL, &w, x, &desc, &c), YC_OK);
    for (i = 0; i < VISITS; i++) {
        double d[3];
        widen(p, c.points[i]), difference(d, p, x[w.node[i]]);
        CHECK_NEAR(sqrt(dot(d, d)), w.node[i] / COLUMNS % 2 ? 0.75 * RADIUS : 0.0, 1e-9);
    }
    curves_free(&c);
    cloth_single(&w, NODES);
    for (i = 0; i < NODES; i++) w.layer[i] = 1;
    CHECK_RESULT(curves_fill(NULL, &w, x, &desc, &c), YC_OK);
    for (i = 0; i < NODES; i++) widen(p, c.points[i]), CHECK_NEAR_ALL(p, x[i], 3, 1e-9);
    curves_free(&c);
}

/* Nodes on a line at random distances, over four orders of magnitude: points on the line, in order. */
TEST(output_curves_straight_stays_straight) {
    static cloth w;
    double x[NODES][3], along[3] = {0.48, -0.6, 0.64}, at = 0.0, last = -1.0;
    yc_curve_desc desc = yc_curve_desc_default();
    yc_curves c;
    uint64_t random = 7;
    int i, k;
    cloth_single(&w, NODES);
    for (i = 0; i < NODES; i++, at += pow(10.0, test_random(&random, -4.0, 0.0)))
        for (k = 0; k < 3; k++) x[i][k] = at * along[k];
    desc.steps = 64;
    CHECK_RESULT(curves_fill(NULL, &w, x, &desc, &c), YC_OK);
    CHECK(c.curve_count == 1 && c.point_count == (NODES - 1) * 64 + 1);
    for (i = 0; i < c.point_count; i++) {
        double p[3], off[3], share;
        widen(p, c.points[i]), share = dot(p, along);
        for (k = 0; k < 3; k++) off[k] = p[k] - share * along[k];
        CHECK_NEAR(sqrt(dot(off, off)), 0.0, 1e-6);
        CHECK(share > last - 1e-6);
        last = share;
    }
    CHECK_NEAR(last, dot(x[NODES - 1], along), 1e-6);
    curves_free(&c);
}

/* The turn at a node dwindles with the length of the pieces, also between long and short segments. */
TEST(output_curves_are_smooth) {
    static cloth w;
    double x[5][3] = {{0, 0, 0}, {1, 0, 0}, {1, 0.1, 0}, {2, 0.5, 1}, {2, 2, 1}}, turn[2];
    yc_curve_desc desc = yc_curve_desc_default();
    yc_curves c;
    int round, node;
    cloth_single(&w, 5);
    for (round = 0; round < 2; round++) {
        desc.steps = round ? 64 : 16, turn[round] = 0.0;
        CHECK_RESULT(curves_fill(NULL, &w, x, &desc, &c), YC_OK);
        for (node = 1; node < 4; node++) {
            double a[3], b[3], d[3], before[3], after[3], n[3], angle;
            widen(a, c.points[node * desc.steps - 1]), widen(b, c.points[node * desc.steps]);
            widen(d, c.points[node * desc.steps + 1]);
            difference(before, b, a), difference(after, d, b), cross(n, before, after);
            angle = atan2(sqrt(dot(n, n)), dot(before, after));
            if (angle > turn[round]) turn[round] = angle;
        }
        curves_free(&c);
    }
    CHECK(turn[1] < 0.12 && turn[1] < 0.35 * turn[0]);
}

TEST(output_curves_coinciding_nodes) {
    static cloth w;
    double x[NODES][3];
    yc_curve_desc desc = yc_curve_desc_default();
    yc_curves c;
    int i, k;
    cloth_make(&w);
    memset(x, 0, sizeof x);
    CHECK_RESULT(curves_fill(NULL, &w, x, &desc, &c), YC_OK);
    for (i = 0; i < c.point_count; i++)
        for (k = 0; k < 3; k++) CHECK(c.points[i][k] == 0.0f);
    curves_free(&c);
    /* There and back again, and a pair in one place. */
    cloth_single(&w, 4), x[1][0] = 1.0, x[2][0] = 1.0;
    CHECK_RESULT(curves_fill(NULL, &w, x, &desc, &c), YC_OK);
    for (i = 0; i < c.point_count; i++)
        CHECK(c.points[i][0] >= -0.2f && c.points[i][0] <= 1.2f && c.points[i][1] == 0.0f);
    curves_free(&c);
}

/* What is left is, bit for bit, a part of the whole. */
TEST(output_curves_skip_cuts) {
    static cloth w;
    unsigned char skip[NODES];
    double x[NODES][3];
    yc_curve_desc desc = yc_curve_desc_default();
    yc_curves whole, c;
    uint64_t random = 3;
    int i, curve, round, seen;
    cloth_make(&w), bend(x);
    CHECK_RESULT(curves_fill(NULL, &w, x, &desc, &whole), YC_OK);
    for (round = 0; round < 20; round++) {
        for (i = 0; i < NODES; i++) skip[i] = (unsigned char)(test_random(&random, 0.0, 1.0) < 0.05 * round);
        desc.skip = skip;
        CHECK_RESULT(curves_fill(NULL, &w, x, &desc, &c), YC_OK);
        seen = 0;
        for (curve = 0; curve < c.curve_count; curve++) {
            int from = whole.first[c.yarn[curve]], count = c.first[curve + 1] - c.first[curve], visit;
            CHECK(count > desc.steps);
            while (from < whole.point_count && !same_points(whole.points + from, c.points + c.first[curve], 1))
                from += desc.steps;
            if (!CHECK(from + count <= whole.first[c.yarn[curve] + 1])) break;
            CHECK(same_points(whole.points + from, c.points + c.first[curve], count));
            visit = w.first[c.yarn[curve]] + (from - whole.first[c.yarn[curve]]) / desc.steps;
            for (i = 0; i <= (count - 1) / desc.steps; i++) CHECK(!skip[w.node[visit + i]]);
            seen += (count - 1) / desc.steps;
        }
        for (i = 0; i + 1 < VISITS; i++) /* every segment between two nodes that are left is drawn */
            if (!skip[w.node[i]] && !skip[w.node[i + 1]] && w.u[i + 1] > w.u[i]) seen--;
        CHECK(seen == 0);
        curves_free(&c);
    }
    memset(skip, 1, sizeof skip);
    CHECK_RESULT(curves_fill(NULL, &w, x, &desc, &c), YC_OK);
    CHECK(c.curve_count == 0 && c.point_count == 0 && c.first[0] == 0);
    curves_free(&c), curves_free(&whole);
}

TEST(output_same_bits_for_any_workers) {
    static cloth w;
    double x[NODES][3];
    yc_curve_desc desc = yc_curve_desc_default();
    yc_host hosts[3];
    yc_curves c[3];
    int i;
    cloth_make(&w), bend(x);
    hosts[0] = test_host_counting(), hosts[1] = test_host_threads(0), hosts[2] = test_host_threads(3);
    for (i = 0; i < 3; i++) {
        CHECK_RESULT(curves_fill(&hosts[i], &w, x, &desc, &c[i]), YC_OK);
        CHECK(same_points(c[i].points, c[0].points, c[0].point_count));
        CHECK(test_heap.live == 0);
    }
    for (i = 0; i < 3; i++) curves_free(&c[i]);
}

TEST(output_curves_wrong_inputs) {
    static cloth w;
    double x[NODES][3];
    yc_curve_desc desc = yc_curve_desc_default(), bad;
    yc_curves c, before;
    float last_point[1][3];
    char message[YC_MESSAGE_SIZE];
    yc_host half;
    cloth_make(&w), bend(x);
    CHECK_RESULT(curves_fill(NULL, &w, x, &desc, &c), YC_OK);
    before = c, memcpy(last_point, c.points[c.point_count - 1], sizeof last_point);
#define REFUSED(yarns, nodes, descriptor, out, part) \
    CHECK_RESULT(yc_curves_make(NULL, yarns, nodes, descriptor, out, message), YC_ERROR_ARGUMENT), \
        CHECK(strstr(message, part) != NULL)
    REFUSED(NULL, CONST3(x), &desc, &c, "yarns");
    REFUSED(&w.yarns, NULL, &desc, &c, "nodes is NULL");
    REFUSED(&w.yarns, CONST3(x), NULL, &c, "descriptor");
    REFUSED(&w.yarns, CONST3(x), &desc, NULL, "out");
    bad = desc, bad.cookie = 0;
    REFUSED(&w.yarns, CONST3(x), &bad, &c, "cookie");
    bad = desc, bad.steps = 65;
    REFUSED(&w.yarns, CONST3(x), &bad, &c, "curve.steps = 65");
    bad = desc, bad.offset = NAN;
    REFUSED(&w.yarns, CONST3(x), &bad, &c, "curve.offset");
    bad = desc, bad.steps = 5;
    REFUSED(&w.yarns, CONST3(x), &bad, &c, "room for");
    c.radius = NULL;
    REFUSED(&w.yarns, CONST3(x), &desc, &c, "either all arrays");
    c.radius = before.radius, c.curve_count--;
    REFUSED(&w.yarns, CONST3(x), &desc, &c, "room for 11 curves");
    c.curve_count++, x[NODES - 1][2] = NAN;
    REFUSED(&w.yarns, CONST3(x), &desc, &c, "nodes[34]");
    x[NODES - 1][2] = 0.0, w.node[3] = NODES;
    REFUSED(&w.yarns, CONST3(x), &desc, &c, "visit_node[3]");
    w.node[3] = 3, w.materials[1].radius = 1e31;
    REFUSED(&w.yarns, CONST3(x), &desc, &c, "materials[1].radius");
#undef REFUSED
    w.materials[1].radius = RADIUS;
    memset(&half, 0, sizeof half), half.alloc = test_host_counting().alloc;
    CHECK_RESULT(yc_curves_make(&half, &w.yarns, CONST3(x), &desc, &c, NULL), YC_ERROR_ARGUMENT);
    CHECK(!memcmp(&before, &c, sizeof c) && same_points(last_point, c.points + c.point_count - 1, 1));
    curves_free(&c);
}

TEST(output_curves_out_of_memory) {
    static cloth w;
    double x[NODES][3];
    yc_curve_desc desc = yc_curve_desc_default();
    yc_curves c;
    yc_result result = YC_ERROR_MEMORY;
    int n;
    cloth_make(&w), bend(x);
    CHECK_RESULT(curves_fill(NULL, &w, x, &desc, &c), YC_OK);
    for (n = 0; n < 50 && result != YC_OK; n++) {
        yc_host host = test_host_failing(n);
        c.first[0] = -5;
        result = yc_curves_make(&host, &w.yarns, CONST3(x), &desc, &c, NULL);
        CHECK(test_heap.live == 0);
        if (result == YC_OK) break;
        if (!CHECK_RESULT(result, YC_ERROR_MEMORY)) break;
        CHECK(c.first[0] == -5);
    }
    CHECK(n > 3 && n < 50 && c.first[0] == 0);
    curves_free(&c);
}

/* ---- tubes ------------------------------------------------------------------------------------------------------- */

static yc_result tubes_fill(const yc_curves *c, int sides, yc_tubes *out) {
    memset(out, 0, sizeof *out);
    if (!CHECK_RESULT(yc_tubes_make(NULL, c, sides, out, NULL), YC_OK)) return YC_ERROR_ARGUMENT;
    out->positions = (float(*)[3])malloc(sizeof(float[3]) * (size_t)(out->vertex_count + 1));
    out->normals = (float(*)[3])malloc(sizeof(float[3]) * (size_t)(out->vertex_count + 1));
    out->triangles = (int(*)[3])malloc(sizeof(int[3]) * (size_t)(out->triangle_count + 1));
    return yc_tubes_make(NULL, c, sides, out, NULL);
}

static void tubes_free(yc_tubes *t) { free(t->positions), free(t->normals), free(t->triangles); }

/* Every half-edge once, and once the other way round. */
static int is_closed(const int (*triangles)[3], int count) {
    int a, b, found, closed = 1;
    for (a = 0; a < 3 * count && closed; a++) {
        int from = triangles[a / 3][a % 3], to = triangles[a / 3][(a + 1) % 3], same = 0;
        for (b = found = 0; b < 3 * count; b++) {
            int p = triangles[b / 3][b % 3], q = triangles[b / 3][(b + 1) % 3];
            same += p == from && q == to, found += p == to && q == from;
        }
        closed = same == 1 && found == 1;
    }
    return closed;
}

/* Area, and the volume inside by the divergence theorem. */
static double tube_measure(const yc_tubes *t, double *volume) {
    double area = 0.0;
    int i, k;
    *volume = 0.0;
    for (i = 0; i < t->triangle_count; i++) {
        double p[3][3], a[3], b[3], n[3];
        for (k = 0; k < 3; k++) widen(p[k], t->positions[t->triangles[i][k]]);
        difference(a, p[1], p[0]), difference(b, p[2], p[0]), cross(n, a, b);
        area += 0.5 * sqrt(dot(n, n)), *volume += dot(n, p[0]) / 6.0;
    }
    return area;
}

static void helix(yc_curves *c, int count, int *first, float (*points)[3], float *radius) {
    int i;
    memset(c, 0, sizeof *c);
    for (i = 0; i < count; i++) {
        double s = 6.0 * i / (count - 1) - 3.0;
        points[i][0] = (float)sin(2.0 * s), points[i][1] = (float)(0.7 * s),
        points[i][2] = (float)(cos(2.0 * s) + s * s * s / 9.0);
    }
    first[0] = 0, first[1] = count, *radius = 0.05f;
    c->curve_count = 1, c->point_count = count, c->first = first, c->points = points, c->radius = radius;
}

TEST(output_tubes_are_closed) {
    static cloth w;
    double x[NODES][3], volume;
    yc_curve_desc desc = yc_curve_desc_default();
    yc_curves c;
    yc_tubes t;
    int i, k, curve;
    cloth_make(&w), bend(x), desc.steps = 2;
    CHECK_RESULT(curves_fill(NULL, &w, x, &desc, &c), YC_OK);
    CHECK_RESULT(tubes_fill(&c, 5, &t), YC_OK);
    CHECK(t.vertex_count == 5 * c.point_count + 2 * c.curve_count && t.triangle_count == 2 * 5 * c.point_count);
    CHECK(is_closed(CONST3I(t.triangles), t.triangle_count));
    for (i = 0; i < t.triangle_count; i++) { /* each triangle faces the way its normals do */
        double p[3][3], a[3], b[3], n[3], mean[3] = {0.0, 0.0, 0.0};
        for (k = 0; k < 3; k++) {
            widen(p[k], t.normals[t.triangles[i][k]]);
            CHECK_NEAR(dot(p[k], p[k]), 1.0, 1e-6);
            mean[0] += p[k][0], mean[1] += p[k][1], mean[2] += p[k][2];
        }
        for (k = 0; k < 3; k++) widen(p[k], t.positions[t.triangles[i][k]]);
        difference(a, p[1], p[0]), difference(b, p[2], p[0]), cross(n, a, b);
        CHECK(dot(n, mean) > 0.0);
    }
    for (curve = 0; curve < c.curve_count; curve++) /* vertices are where the documentation says */
        for (i = 0; i < c.first[curve + 1] - c.first[curve]; i++)
            for (k = 0; k < 5; k++) {
                double p[3], q[3], d[3];
                widen(p, c.points[c.first[curve] + i]);
                widen(q, t.positions[5 * (c.first[curve] + i) + 2 * curve + k]), difference(d, q, p);
                CHECK_NEAR(sqrt(dot(d, d)), (double)c.radius[curve], 1e-8);
            }
    tube_measure(&t, &volume);
    CHECK(volume > 0.0);
    tubes_free(&t), curves_free(&c);
}

TEST(output_tubes_straight_area) {
    float points[4][3] = {{1, 2, 3}, {1.3f, 2, 3.4f}, {1.6f, 2, 3.8f}, {2.2f, 2, 4.6f}}, radius = 0.1f;
    int first[2] = {0, 4}, sides;
    double length = 2.0, exact = 2.0 * 3.14159265358979 * 0.1 * (length + 0.1), last = 0.0;
    yc_curves c;
    yc_tubes t;
    memset(&c, 0, sizeof c);
    c.curve_count = 1, c.point_count = 4, c.first = first, c.points = points, c.radius = &radius;
    for (sides = 8; sides <= 64; sides *= 2) {
        double volume, off;
        CHECK_RESULT(tubes_fill(&c, sides, &t), YC_OK);
        off = exact - tube_measure(&t, &volume);
        CHECK(off > 0.0 && (sides == 8 || (off < 0.27 * last && off > 0.23 * last)));
        CHECK_NEAR(volume, 3.14159265358979 * 0.01 * length, 7.0 / (sides * sides) * 0.063);
        last = off;
        tubes_free(&t);
    }
}

/* Frames turn only with the tangent: a normal moves no further than it does. */
TEST(output_tubes_frames_do_not_twist) {
    enum { COUNT = 400 };
    static float points[COUNT][3];
    float radius;
    int first[2], i;
    double worst = 0.0;
    yc_curves c;
    yc_tubes t;
    helix(&c, COUNT, first, points, &radius);
    CHECK_RESULT(tubes_fill(&c, 4, &t), YC_OK);
    for (i = 0; i + 1 < COUNT; i++) {
        double p[3], q[3], n[3], b[3], tangent[2][3], move[3], turn[3];
        int k;
        for (k = 0; k < 2; k++)
            widen(n, t.normals[4 * (i + k)]), widen(b, t.normals[4 * (i + k) + 1]), cross(tangent[k], n, b);
        widen(p, t.normals[4 * i]), widen(q, t.normals[4 * i + 4]);
        difference(move, q, p), difference(turn, tangent[1], tangent[0]);
        CHECK(sqrt(dot(move, move)) < sqrt(dot(turn, turn)) + 1e-5);
        cross(b, tangent[0], p);
        if (fabs(dot(move, b)) > worst) worst = fabs(dot(move, b));
    }
    CHECK(worst < 1e-3); /* second order in the step */
    tubes_free(&t);
}

/* Carried along a jagged curve and back, a frame is the same again: the angle between the frames of the curve and of
 * the reversed curve is the same at both ends. */
TEST(output_tubes_frames_are_reversible) {
    enum { COUNT = 12 };
    float points[2][COUNT][3], radius = 0.1f;
    int first[2] = {0, COUNT}, round, i, k;
    uint64_t random = 9;
    for (round = 0; round < 20; round++) {
        yc_curves c;
        yc_tubes t[2];
        double n[2][3], b[2][3], m[2][3];
        memset(&c, 0, sizeof c);
        c.curve_count = 1, c.point_count = COUNT, c.first = first, c.radius = &radius;
        for (i = 0; i < COUNT; i++)
            for (k = 0; k < 3; k++)
                points[1][COUNT - 1 - i][k] = points[0][i][k] = (float)(test_random(&random, -1.0, 1.0) + (k ? 0 : i));
        for (k = 0; k < 2; k++) c.points = points[k], CHECK_RESULT(tubes_fill(&c, 4, &t[k]), YC_OK);
        for (k = 0; k < 2; k++) {
            int end = k ? 4 * (COUNT - 1) : 0;
            widen(n[k], t[0].normals[end]), widen(b[k], t[0].normals[end + 1]);
            widen(m[k], t[1].normals[4 * (COUNT - 1) - end]);
        }
        CHECK_NEAR(dot(n[0], m[0]), dot(n[1], m[1]), 1e-5);
        CHECK_NEAR(dot(b[0], m[0]), dot(b[1], m[1]), 1e-5);
        for (k = 0; k < 2; k++) tubes_free(&t[k]);
    }
}

TEST(output_tubes_degenerate_curves) {
    float points[9][3] = {
        {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 0}};
    float radius[3] = {0.1f, 0.1f, 0.1f};
    int first[4] = {0, 2, 5, 9}, i, k;
    yc_curves c;
    yc_tubes t;
    memset(&c, 0, sizeof c);
    c.curve_count = 3, c.point_count = 9, c.first = first, c.points = points, c.radius = radius;
    CHECK_RESULT(tubes_fill(&c, 3, &t), YC_OK);
    CHECK(is_closed(CONST3I(t.triangles), t.triangle_count));
    for (i = 0; i < t.vertex_count; i++) {
        double n[3];
        widen(n, t.normals[i]);
        CHECK_NEAR(dot(n, n), 1.0, 1e-6);
        for (k = 0; k < 3; k++) CHECK(fabs((double)t.positions[i][k]) < 1.2);
    }
    tubes_free(&t);
    c.curve_count = c.point_count = 0, memset(&t, 0, sizeof t), t.vertex_count = 7;
    CHECK_RESULT(yc_tubes_make(NULL, &c, 3, &t, NULL), YC_OK);
    CHECK(t.vertex_count == 0 && t.triangle_count == 0);
}

TEST(output_tubes_wrong_inputs) {
    float points[20][3], radius;
    int first[2];
    char message[YC_MESSAGE_SIZE];
    yc_curves c, good;
    yc_tubes t, before;
    helix(&good, 20, first, points, &radius);
    CHECK_RESULT(tubes_fill(&good, 6, &t), YC_OK);
    before = t;
#define REFUSED(curves, sides, out, part) \
    CHECK_RESULT(yc_tubes_make(NULL, curves, sides, out, message), YC_ERROR_ARGUMENT), \
        CHECK(strstr(message, part) != NULL)
    REFUSED(NULL, 6, &t, "curves is NULL");
    REFUSED(&good, 6, NULL, "out is NULL");
    REFUSED(&good, 2, &t, "sides = 2");
    REFUSED(&good, 65, &t, "sides = 65");
    REFUSED(&good, 7, &t, "room for 122");
    c = good, c.points = NULL;
    REFUSED(&c, 6, &t, "points");
    c = good, c.curve_count = -1;
    REFUSED(&c, 6, &t, "curve_count = -1");
    c = good, c.point_count = 19;
    REFUSED(&c, 6, &t, "from 0 to 20");
    first[1] = 1;
    REFUSED(&good, 6, &t, "needs two points");
    first[1] = 20, radius = 0.0f;
    REFUSED(&good, 6, &t, "radius[0]");
    radius = 0.1f, points[4][1] = (float)NAN;
    REFUSED(&good, 6, &t, "points[4]");
    points[4][1] = 0.0f, t.normals = NULL;
    REFUSED(&good, 6, &t, "either all arrays");
    t.normals = before.normals;
    CHECK(!memcmp(&t, &before, sizeof t));
#undef REFUSED
    tubes_free(&t);
}

/* ---- finer mesh -------------------------------------------------------------------------------------------------- */

typedef struct {
    int vertex_count, triangle_count;
    double (*x)[3];
    int (*t)[3];
} surface;

static void surface_free(surface *s) { free(s->x), free(s->t); }

static surface surface_make(int vertex_count, int triangle_count) {
    surface s;
    s.vertex_count = vertex_count, s.triangle_count = triangle_count;
    s.x = (double(*)[3])calloc((size_t)vertex_count + 1, sizeof *s.x);
    s.t = (int(*)[3])calloc((size_t)triangle_count + 1, sizeof *s.t);
    return s;
}

/* n x m squares of side 1, cut in two. */
static surface surface_grid(int n, int m) {
    surface s = surface_make((n + 1) * (m + 1), 2 * n * m);
    int i, j, t = 0;
    for (i = 0; i < s.vertex_count; i++) s.x[i][0] = i % (n + 1), s.x[i][1] = floor(i / (n + 1.0));
    for (j = 0; j < m; j++)
        for (i = 0; i < n; i++, t += 2) {
            int a = j * (n + 1) + i, b = a + n + 1;
            s.t[t][0] = a, s.t[t][1] = a + 1, s.t[t][2] = b + 1;
            s.t[t + 1][0] = a, s.t[t + 1][1] = b + 1, s.t[t + 1][2] = b;
        }
    return s;
}

/* Two pyramids over a polygon of n corners: the tips have valence n, the rest 4. n = 3 to 9. */
static surface surface_gem(int n) {
    surface s = surface_make(n + 2, 2 * n);
    int i;
    for (i = 0; i < n; i++) {
        s.x[i][0] = cos(6.283185307179586 * i / n), s.x[i][1] = sin(6.283185307179586 * i / n);
        s.t[i][0] = i, s.t[i][1] = (i + 1) % n, s.t[i][2] = n;
        s.t[n + i][0] = (i + 1) % n, s.t[n + i][1] = i, s.t[n + i][2] = n + 1;
    }
    s.x[n][2] = 1.0, s.x[n + 1][2] = -1.0;
    return s;
}

static surface surface_finer(const surface *s) {
    surface out = surface_make(0, 0);
    yc_fine fine;
    memset(&fine, 0, sizeof fine);
    if (!CHECK_RESULT(yc_subdivide(NULL, NULL, s->vertex_count, CONST3I(s->t), s->triangle_count, &fine, NULL), YC_OK))
        return out;
    surface_free(&out), out = surface_make(fine.vertex_count, fine.triangle_count);
    fine.positions = out.x, fine.triangles = out.t;
    CHECK_RESULT(
        yc_subdivide(NULL, CONST3(s->x), s->vertex_count, CONST3I(s->t), s->triangle_count, &fine, NULL), YC_OK);
    return out;
}

TEST(output_subdivide_flat_grid) {
    surface s = surface_grid(5, 4), f;
    double area = 0.0;
    int i, k, edges = 5 * 5 + 6 * 4 + 5 * 4;
    for (i = 0; i < s.vertex_count; i++) s.x[i][2] = 0.3 * s.x[i][0] - 0.2 * s.x[i][1] + 7.0;
    f = surface_finer(&s);
    CHECK(f.vertex_count == s.vertex_count + edges && f.triangle_count == 4 * s.triangle_count);
    for (i = 0; i < f.vertex_count; i++) CHECK_NEAR(f.x[i][2], 0.3 * f.x[i][0] - 0.2 * f.x[i][1] + 7.0, 1e-14);
    for (i = 0; i < s.vertex_count; i++) { /* all but the corners of a regular grid stay; sides stay on their line */
        int column = i % 6, row = i / 6, corner = (column == 0 || column == 5) && (row == 0 || row == 4);
        if (!corner) CHECK_NEAR_ALL(f.x[i], s.x[i], 3, 1e-14);
        else CHECK_NEAR(f.x[i][0], column ? 4.875 : 0.125, 1e-14);
    }
    for (i = 0; i < f.triangle_count; i++) {
        double a[3], b[3], n[3];
        difference(a, f.x[f.t[i][1]], f.x[f.t[i][0]]), difference(b, f.x[f.t[i][2]], f.x[f.t[i][0]]), cross(n, a, b);
        CHECK(n[2] > 0.0);
        area += 0.5 * n[2];
        for (k = 0; k < 3 && i % 4 < 3; k++) /* the corner keeps its place in the small triangle */
            CHECK(k == i % 4 ? f.t[i][k] == s.t[i / 4][k] : f.t[i][k] >= s.vertex_count);
    }
    CHECK_NEAR(area, 20.0 - 4.0 * 0.0625, 1e-12); /* each corner loses (0, 0) (1/2, 0) (1/8, 1/8) (0, 1/2) */
    surface_free(&s), surface_free(&f);
}

/* The border is a curve of its own, the cubic B-spline: halfway between two of its points, the knot average. */
TEST(output_subdivide_border) {
    surface s = surface_grid(4, 4), f, g;
    uint64_t random = 11;
    int i, k;
    for (i = 0; i < s.vertex_count; i++)
        for (k = 0; k < 3; k++) s.x[i][k] += test_random(&random, -0.3, 0.3);
    f = surface_finer(&s);
    for (i = 0; i < s.vertex_count; i++)
        if (i % 5 % 4 && i / 5 % 4) s.x[i][2] += 10.0;
    g = surface_finer(&s);
    for (i = 0; i < s.vertex_count; i++)
        if (i % 5 % 4 == 0 || i / 5 % 4 == 0) CHECK_NEAR_ALL(f.x[i], g.x[i], 3, 0.0);
        else CHECK(g.x[i][2] > f.x[i][2] + 1.0);
    for (k = 0; k < 3; k++) CHECK_NEAR(f.x[2][k], 0.75 * s.x[2][k] + 0.125 * (s.x[1][k] + s.x[3][k]), 1e-15);
    surface_free(&s), surface_free(&f), surface_free(&g);
}

/* Where a vertex ends up after infinitely many levels (Loop): x + (mean of neighbours - x) / (1 + 3 / (8 share)). */
static void limit(const surface *s, int v, double *out) {
    double sum[3] = {0.0, 0.0, 0.0}, c, share;
    int i, k, n = 0;
    for (i = 0; i < 3 * s->triangle_count; i++)
        if (s->t[i / 3][i % 3] == v)
            for (n++, k = 0; k < 3; k++) sum[k] += s->x[s->t[i / 3][(i + 1) % 3]][k];
    c = 0.375 + 0.25 * cos(6.283185307179586 / n), share = 0.625 - c * c;
    for (k = 0; k < 3; k++) out[k] = s->x[v][k] + (sum[k] / n - s->x[v][k]) / (1.0 + 0.375 / share);
}

TEST(output_subdivide_keeps_limits) {
    uint64_t random = 5;
    int n, i, k;
    for (n = 3; n < 10; n++) {
        surface s = surface_gem(n), f;
        for (i = 0; i < s.vertex_count; i++)
            for (k = 0; k < 3; k++) s.x[i][k] += test_random(&random, -0.4, 0.4);
        f = surface_finer(&s);
        for (i = 0; i < s.vertex_count; i++) {
            double a[3], b[3];
            limit(&s, i, a), limit(&f, i, b);
            CHECK_NEAR_ALL(a, b, 3, 1e-14);
        }
        surface_free(&s), surface_free(&f);
    }
}

/* A tetrahedron becomes a smooth closed surface: Euler's number stays, and neighbouring triangles turn against each
 * other by half as much at every level. */
TEST(output_subdivide_tetrahedron_gets_smooth) {
    const double corner[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    const int faces[4][3] = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
    surface s = surface_make(4, 4);
    double last = 0.0;
    int level, i, k, m;
    memcpy(s.x, corner, sizeof corner), memcpy(s.t, faces, sizeof faces);
    for (level = 1; level <= 5; level++) {
        surface f = surface_finer(&s);
        double sharpest = 0.0, volume = 0.0;
        float(*normals)[3] = (float(*)[3])malloc(sizeof(float[3]) * (size_t)(f.vertex_count + 1));
        surface_free(&s), s = f;
        CHECK(2 * s.vertex_count - s.triangle_count == 4);
        if (level < 4) CHECK(is_closed(CONST3I(s.t), s.triangle_count));
        yc_vertex_normals(CONST3(s.x), s.vertex_count, CONST3I(s.t), s.triangle_count, normals);
        for (i = 0; i < s.triangle_count; i++) {
            double a[3], b[3], n[3], v[3];
            difference(a, s.x[s.t[i][1]], s.x[s.t[i][0]]), difference(b, s.x[s.t[i][2]], s.x[s.t[i][0]]),
                cross(n, a, b);
            volume += dot(n, s.x[s.t[i][0]]) / 6.0;
            for (k = 0; k < 3; k++) {
                widen(v, normals[s.t[i][k]]), m = s.t[i][k];
                CHECK(dot(v, s.x[m]) > 0.0); /* outward */
                cross(a, n, v);
                if (atan2(sqrt(dot(a, a)), dot(n, v)) > sharpest) sharpest = atan2(sqrt(dot(a, a)), dot(n, v));
            }
        }
        if (level > 3) CHECK(sharpest < 0.6 * last);
        CHECK(volume > 0.1 && volume < 0.21);
        last = sharpest;
        free(normals);
    }
    CHECK(last < 0.1);
    surface_free(&s);
}

/* Welded partners without triangles, and two triangles that share one vertex only, stay. */
TEST(output_subdivide_keeps_odd_vertices) {
    surface s = surface_make(6, 2), f;
    int i, k;
    for (i = 0; i < 6; i++)
        for (k = 0; k < 3; k++) s.x[i][k] = i * i + 3.0 * k * i;
    s.t[0][0] = 0, s.t[0][1] = 1, s.t[0][2] = 2, s.t[1][0] = 2, s.t[1][1] = 3, s.t[1][2] = 4;
    f = surface_finer(&s);
    CHECK(f.vertex_count == 12 && f.triangle_count == 8);
    CHECK_NEAR_ALL(f.x[2], s.x[2], 3, 0.0);
    CHECK_NEAR_ALL(f.x[5], s.x[5], 3, 0.0);
    surface_free(&f), s.triangle_count = 0;
    f = surface_finer(&s);
    CHECK(f.vertex_count == 6 && f.triangle_count == 0);
    CHECK_NEAR_ALL(f.x[0], s.x[0], 18, 0.0);
    surface_free(&s), surface_free(&f);
}

/* A point carried by a triangle is the same point on the small one, when edges are halved where they are. */
TEST(output_fine_locate) {
    surface s = surface_grid(1, 1), f;
    uint64_t random = 21;
    int i, k, m;
    s.x[3][2] = 2.0;
    f = surface_finer(&s);
    for (i = 0; i < s.vertex_count; i++) memcpy(f.x[i], s.x[i], sizeof f.x[i]);
    for (i = 0; i < 2; i++)
        for (k = 0; k < 3; k++)
            for (m = 0; m < 3; m++)
                f.x[f.t[4 * i + k][(k + 1) % 3]][m] = 0.5 * (s.x[s.t[i][k]][m] + s.x[s.t[i][(k + 1) % 3]][m]);
    for (i = 0; i < 500; i++) {
        double w[3], p[3] = {0.0, 0.0, 0.0}, q[3] = {0.0, 0.0, 0.0};
        int t = i % 2, outside = i >= 400;
        w[0] = test_random(&random, 0.0, 1.0), w[1] = test_random(&random, 0.0, 1.0 - w[0]), w[2] = 1.0 - w[0] - w[1];
        if (i < 3) w[0] = w[1] = w[2] = 0.0, w[i] = 1.0;
        if (i == 3) w[0] = 0.0, w[1] = w[2] = 0.5;
        if (outside) w[0] -= 3.0, w[1] += 3.0;
        for (k = 0; k < 9; k++) p[k % 3] += w[k / 3] * s.x[s.t[t][k / 3]][k % 3];
        yc_fine_locate(&t, w);
        CHECK(t / 4 == i % 2);
        CHECK_NEAR(w[0] + w[1] + w[2], 1.0, 1e-14);
        CHECK(outside || (w[0] >= -1e-15 && w[1] >= -1e-15 && w[2] >= -1e-15));
        for (k = 0; k < 9; k++) q[k % 3] += w[k / 3] * f.x[f.t[t][k / 3]][k % 3];
        CHECK_NEAR_ALL(p, q, 3, 1e-14);
    }
    surface_free(&s), surface_free(&f);
}

TEST(output_subdivide_wrong_inputs) {
    const int book[3][3] = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}, twice[1][3] = {{0, 1, 1}}, outside[1][3] = {{0, 1, 5}};
    const double x[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
    double positions[9][3];
    int triangles[4][3];
    char message[YC_MESSAGE_SIZE];
    yc_fine fine, before;
    memset(&fine, 0, sizeof fine), before = fine;
#define REFUSED(positions, vertex_count, triangles, triangle_count, result, part) \
    CHECK_RESULT(yc_subdivide(NULL, positions, vertex_count, triangles, triangle_count, &fine, message), result), \
        CHECK(strstr(message, part) != NULL)
    REFUSED(x, 5, book, 3, YC_ERROR_TOPOLOGY, "triangles[0], [1] and [2]");
    REFUSED(x, 5, twice, 1, YC_ERROR_TOPOLOGY, "twice");
    REFUSED(x, 5, outside, 1, YC_ERROR_ARGUMENT, "triangles[0][2] = 5");
    REFUSED(x, 5, NULL, 1, YC_ERROR_ARGUMENT, "triangles is NULL");
    REFUSED(x, 5, book, -1, YC_ERROR_ARGUMENT, "triangle_count = -1");
    REFUSED(x, -1, book, 1, YC_ERROR_ARGUMENT, "vertex_count = -1");
    CHECK(!memcmp(&fine, &before, sizeof fine));
    CHECK_RESULT(yc_subdivide(NULL, NULL, 5, book, 1, &fine, message), YC_OK);
    CHECK(fine.vertex_count == 8 && fine.triangle_count == 4 && !strcmp(message, ""));
    fine.positions = positions;
    REFUSED(x, 5, book, 1, YC_ERROR_ARGUMENT, "either both");
    fine.triangles = triangles;
    REFUSED(NULL, 5, book, 1, YC_ERROR_ARGUMENT, "positions is NULL");
    fine.vertex_count = 7;
    REFUSED(x, 5, book, 1, YC_ERROR_ARGUMENT, "room for 7");
#undef REFUSED
    CHECK_RESULT(yc_subdivide(NULL, x, 5, book, 1, NULL, NULL), YC_ERROR_ARGUMENT);
}

TEST(output_subdivide_out_of_memory) {
    surface s = surface_grid(3, 3);
    yc_result result = YC_ERROR_MEMORY;
    yc_fine fine;
    int n;
    memset(&fine, 0, sizeof fine);
    CHECK_RESULT(yc_subdivide(NULL, NULL, s.vertex_count, CONST3I(s.t), s.triangle_count, &fine, NULL), YC_OK);
    fine.positions = (double(*)[3])malloc(sizeof(double[3]) * (size_t)fine.vertex_count);
    fine.triangles = (int(*)[3])malloc(sizeof(int[3]) * (size_t)fine.triangle_count);
    fine.positions[0][2] = 77.0;
    for (n = 0; n < 50; n++) {
        yc_host host = test_host_failing(n);
        result = yc_subdivide(&host, CONST3(s.x), s.vertex_count, CONST3I(s.t), s.triangle_count, &fine, NULL);
        CHECK(test_heap.live == 0);
        if (result == YC_OK) break;
        if (!CHECK_RESULT(result, YC_ERROR_MEMORY)) break;
        CHECK(fine.positions[0][2] == 77.0);
    }
    CHECK(n > 3 && n < 50 && fine.positions[0][2] == 0.0);
    free(fine.positions), free(fine.triangles), surface_free(&s);
}

TEST(output_vertex_normals) {
    /* A flat fan with a flap of a third of its area, upright, at vertices 0 and 1; vertex 5 has a triangle without
     * area. */
    const double x[7][3] = {{0, 0, 0}, {1, 0, 0}, {0, 3, 0}, {0, 0, 1}, {5, 5, 5}, {6, 6, 6}, {9, 9, 9}};
    const int t[3][3] = {{0, 1, 2}, {0, 1, 3}, {4, 5, 5}};
    float normals[7][3];
    double n[3];
    const double flat[3] = {0, 0, 1}, both[3] = {0, -0.31622776601683794, 0.94868329805051377}, none[3] = {0, 0, 0};
    yc_vertex_normals(x, 7, t, 3, normals);
    widen(n, normals[0]), CHECK_NEAR_ALL(n, both, 3, 1e-7);
    widen(n, normals[1]), CHECK_NEAR_ALL(n, both, 3, 1e-7);
    widen(n, normals[2]), CHECK_NEAR_ALL(n, flat, 3, 1e-7);
    widen(n, normals[5]), CHECK_NEAR_ALL(n, none, 3, 0.0);
    widen(n, normals[6]), CHECK_NEAR_ALL(n, none, 3, 0.0);
}

/* ---- region ------------------------------------------------------------------------------------------------------ */

enum { SIDE = 9, REGION_V = SIDE * SIDE, REGION_T = 2 * (SIDE - 1) * (SIDE - 1), REGION_UV = SIDE * (SIDE + 1) };

/* Two pattern pieces sewn along the middle column: its vertices have two UVs, and its edges two lengths. */
typedef struct {
    yc_mesh mesh;
    double x[REGION_V][3], uv[REGION_UV][2];
    int t[REGION_T][3], uvt[REGION_T][3];
} region_mesh;

static void region_make(region_mesh *m, double jitter, uint64_t *random) {
    int i, j, k, t = 0;
    memset(m, 0, sizeof *m);
    for (j = 0; j < SIDE; j++)
        for (i = 0; i <= SIDE; i++) { /* UV column SIDE / 2 + 1 is the second piece's copy of the middle one */
            double *uv = m->uv[j * (SIDE + 1) + i];
            uv[0] = 0.1 * i + test_random(random, -jitter, jitter),
            uv[1] = 0.1 * j + test_random(random, -jitter, jitter);
        }
    for (i = 0; i < REGION_V; i++)
        for (k = 0; k < 3; k++) m->x[i][k] = test_random(random, -1.0, 1.0); /* shall not matter */
    for (j = 0; j + 1 < SIDE; j++)
        for (i = 0; i + 1 < SIDE; i++) {
            int a = j * SIDE + i, b = a + SIDE, c = j * (SIDE + 1) + i + (i >= SIDE / 2), d = c + SIDE + 1;
            m->t[t][0] = a, m->t[t][1] = a + 1, m->t[t][2] = b + 1;
            m->uvt[t][0] = c, m->uvt[t][1] = c + 1, m->uvt[t][2] = d + 1, t++;
            m->t[t][0] = a, m->t[t][1] = b + 1, m->t[t][2] = b;
            m->uvt[t][0] = c, m->uvt[t][1] = d + 1, m->uvt[t][2] = d, t++;
        }
    m->mesh.vertex_count = REGION_V, m->mesh.positions = CONST3(m->x);
    m->mesh.triangle_count = REGION_T, m->mesh.triangles = CONST3I(m->t);
    m->mesh.uv_count = REGION_UV, m->mesh.uv = (const double(*)[2])m->uv, m->mesh.uv_triangles = CONST3I(m->uvt);
}

/* Relaxes every edge until nothing changes. */
static void region_distances(const region_mesh *m, int center, double *distance) {
    int i, k, changed = 1;
    for (i = 0; i < REGION_V; i++) distance[i] = 1e30;
    distance[center] = 0.0;
    while (changed) {
        changed = 0;
        for (i = 0; i < 3 * REGION_T; i++) {
            const double *p = m->uv[m->uvt[i / 3][i % 3]], *q = m->uv[m->uvt[i / 3][(i + 1) % 3]];
            double length = sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]));
            for (k = 0; k < 2; k++) {
                int from = m->t[i / 3][(i + k) % 3], to = m->t[i / 3][(i + 1 - k) % 3];
                if (distance[from] + length < distance[to]) distance[to] = distance[from] + length, changed = 1;
            }
        }
    }
}

TEST(region_against_brute_force) {
    static region_mesh m;
    double alpha[REGION_V], distance[REGION_V];
    uint64_t random = 1;
    int round, i;
    for (round = 0; round < 60; round++) {
        int center = test_random_int(&random, REGION_V), chosen = -1;
        double radius = test_random(&random, 0.0, 1.0);
        region_make(&m, 0.02, &random);
        CHECK_RESULT(yc_region_select(NULL, &m.mesh, NULL, center, radius, alpha, &chosen, NULL), YC_OK);
        region_distances(&m, center, distance);
        CHECK(chosen == center);
        for (i = 0; i < REGION_V; i++) CHECK(alpha[i] == (distance[i] <= radius ? 1.0 : 0.0));
    }
}

TEST(region_center_and_rim) {
    static region_mesh m;
    double alpha[REGION_V], score[REGION_V], sum;
    uint64_t random = 2;
    int i, chosen;
    region_make(&m, 0.0, &random);
    for (i = 0; i < REGION_V; i++) score[i] = -5.0;
    score[40] = score[41] = 3.0;
    CHECK_RESULT(yc_region_select(NULL, &m.mesh, score, -1, 0.0, alpha, &chosen, NULL), YC_OK);
    for (i = 0, sum = 0.0; i < REGION_V; i++) sum += alpha[i];
    CHECK(chosen == 40 && alpha[40] == 1.0 && sum == 1.0);
    /* Three steps of 0.1, whose sum is a little more than 0.3, still reach. */
    CHECK_RESULT(yc_region_select(NULL, &m.mesh, score, 0, 0.3, alpha, NULL, NULL), YC_OK);
    CHECK(alpha[3] == 1.0 && alpha[4] == 0.0 && alpha[3 * SIDE] == 1.0 && alpha[4 * SIDE] == 0.0);
    CHECK_RESULT(yc_region_select(NULL, &m.mesh, score, 0, 100.0, alpha, NULL, NULL), YC_OK);
    for (i = 0, sum = 0.0; i < REGION_V; i++) sum += alpha[i];
    CHECK(sum == (double)REGION_V);
}

TEST(region_wrong_inputs) {
    static region_mesh m;
    double alpha[REGION_V], score[REGION_V];
    char message[YC_MESSAGE_SIZE];
    uint64_t random = 2;
    int chosen = 77;
    region_make(&m, 0.0, &random), memset(score, 0, sizeof score);
    alpha[0] = 42.0;
#define REFUSED(mesh, score, center, radius, alpha, part) \
    CHECK_RESULT(yc_region_select(NULL, mesh, score, center, radius, alpha, &chosen, message), YC_ERROR_ARGUMENT), \
        CHECK(strstr(message, part) != NULL)
    REFUSED(NULL, score, 0, 1.0, alpha, "mesh is NULL");
    REFUSED(&m.mesh, score, 0, 1.0, NULL, "alpha");
    REFUSED(&m.mesh, score, 0, -1.0, alpha, "radius = -1");
    REFUSED(&m.mesh, score, 0, NAN, alpha, "radius");
    REFUSED(&m.mesh, score, REGION_V, 1.0, alpha, "center = 81");
    REFUSED(&m.mesh, score, -2, 1.0, alpha, "center = -2");
    REFUSED(&m.mesh, NULL, -1, 1.0, alpha, "score");
    score[7] = NAN;
    REFUSED(&m.mesh, score, -1, 1.0, alpha, "score[7]");
    m.t[2][1] = -1;
    REFUSED(&m.mesh, score, 0, 1.0, alpha, "triangles[2][1]");
#undef REFUSED
    CHECK(alpha[0] == 42.0 && chosen == 77);
}

TEST(region_out_of_memory) {
    static region_mesh m;
    double alpha[REGION_V];
    yc_result result;
    uint64_t random = 2;
    int n;
    region_make(&m, 0.0, &random), alpha[0] = 42.0;
    for (n = 0; n < 50; n++) {
        yc_host host = test_host_failing(n);
        result = yc_region_select(&host, &m.mesh, NULL, 0, 0.3, alpha, NULL, NULL);
        CHECK(test_heap.live == 0);
        if (result == YC_OK) break;
        if (!CHECK_RESULT(result, YC_ERROR_MEMORY)) break;
        CHECK(alpha[0] == 42.0);
    }
    CHECK(n > 3 && n < 50 && alpha[0] == 1.0);
}
