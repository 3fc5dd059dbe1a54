#include "knits.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const scene_stockinette = "pattern: a\nRow 1 (RS): Knit.\nRow 2 (WS): Purl.\n";
const char *const scene_garter = "pattern: a\nRow 1 (RS): Knit.\nRow 2 (WS): Knit.\n";
const char *const scene_rib = "pattern: a\nRow 1 (RS): *K1, p1, repeat from *.\nRow 2 (WS): *K1, p1, repeat from *.\n";
const char *const scene_rib2 = "pattern: a\nRow 1 (RS): *K2, p2, repeat from *.\nRow 2 (WS): *K2, p2, repeat from *.\n";

const char *const scene_feather = "pattern: a\nRow 1 (RS): Knit.\nRow 2 (WS): Purl.\n"
                                  "Row 3 (RS): *[K2tog] 3 times, [yo, k1] 6 times, [k2tog] 3 times, repeat from *.\n"
                                  "Row 4 (WS): Knit.\n";
const char *const scene_diamond =
    "pattern: a\nRow 1 (RS): K1, *yo, ssk, k3, k2tog, yo, k1, repeat from *.\n"
    "Rows 2, 4, 6, 8, 10 and 12 (WS): Purl.\nRow 3 (RS): K1, *k1, yo, ssk, k1, k2tog, yo, k2, repeat from *.\n"
    "Row 5 (RS): K1, *k2, yo, sl1-k2tog-psso, yo, k3, repeat from *.\n"
    "Row 7 (RS): K1, *k1, k2tog, yo, k1, yo, ssk, k2, repeat from *.\n"
    "Row 9 (RS): K1, *k2tog, yo, k3, yo, ssk, k1, repeat from *.\n"
    "Row 11 (RS): K2tog, *yo, k5, yo, sl1-k2tog-psso, repeat from *, yo, k5, yo, ssk.\n";
const char *const scene_chevron = "pattern: a\nRows 1, 3, 5, 7, 9, 11, 13, 15, 17 and 19 (WS): Purl.\n"
                                  "Rows 2, 4, 6, 8 and 10 (RS): K1, *ssk, k5, yo, repeat from *, k1.\n"
                                  "Rows 12, 14, 16, 18 and 20 (RS): K1, *yo, k5, k2tog, repeat from *, k1.\n";

const scene_fabric scene_fabrics[SCENE_FABRICS] = {{"stockinette", &scene_stockinette, 18},
    {"garter", &scene_garter, 18}, {"rib 1x1", &scene_rib, 18}, {"rib 2x2", &scene_rib2, 16},
    {"feather and fan", &scene_feather, 18}, {"openwork diamonds", &scene_diamond, 17}};

yc_yarn_material scene_soft_wool(void) {
    yc_yarn_material wool = yc_knit_desc_default().yarn;
    wool.wrap *= 0.25;
    return wool;
}

static const double pi = 3.14159265358979323846;

void scene_knit_free(scene_knit *k) {
    if (!k) return;
    yc_scene_destroy(k->scene), yc_yarns_destroy(&k->yarns), yc_chart_destroy(&k->chart);
    yc_knit_rest_destroy(&k->rest);
    free(k->start), free(k->x), free(k);
}

/* Where casting on ends and binding off begins. */
static void find_edges(scene_knit *k) {
    const yc_yarns *y = &k->yarns;
    int i, j, last = y->contact_count - (4 * k->desc.stitches - 1); /* the contacts of binding off come last */
    k->first[1] = k->first[2] = y->visit_count, k->first[3] = y->visit_count;
    for (i = 0; i < y->contact_count; i++)
        for (j = 0; j < 2; j++) {
            int *first = &k->first[i < last ? 1 : 2], visit = y->contacts[i].visit[1][j];
            if (visit < *first) *first = visit;
        }
}

/* A view of the network whose first and last row have yarns of their own. */
static yc_yarns loosen(scene_knit *k) {
    yc_yarns y = k->yarns;
    int i;
    for (i = 1; i < 3; i++) y.visit_held[k->first[i] - 1] = y.visit_held[k->first[i]] = 2;
    for (i = 0; i < 3; i++) k->family[i] = YC_WEFT, k->material[i] = i != 1;
    k->materials[0] = k->materials[1] = k->desc.yarn, k->materials[1].stretch *= 1e-5;
    y.yarn_count = 3, y.yarn_first = k->first, y.yarn_family = k->family, y.yarn_material = k->material;
    y.material_count = 2, y.materials = k->materials, y.owner = NULL;
    return y;
}

/* The sphere below the middle of the piece, and weight. */
static yc_result put_sphere(scene_knit *k) {
    yc_scene_desc settings = yc_scene_desc_default();
    yc_body_desc body = yc_body_desc_default();
    yc_primitive ball;
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    int i, j;
    yc_result result;
    for (i = 0; i < k->yarns.node_count; i++)
        for (j = 0; j < 2; j++) low[j] = fmin(low[j], k->start[i][j]), high[j] = fmax(high[j], k->start[i][j]);
    memset(&ball, 0, sizeof ball);
    ball.type = YC_SPHERE, ball.ra = k->sphere, ball.a[2] = -k->sphere - 3.0 * k->desc.yarn.radius;
    for (j = 0; j < 2; j++) ball.a[j] = 0.5 * (low[j] + high[j]);
    memcpy(k->centre, ball.a, sizeof k->centre);
    body.primitive_count = 1, body.primitives = &ball, body.friction = 0.5;
    settings.gravity[1] = 0.0, settings.gravity[2] = -9.81;
    settings.dt_max = 2e-3, settings.mass_damping = 20.0, settings.stiffness_damping = 1e-3;
    settings.solver = YC_SOLVER_DIRECT;
    settings.self_contact = 1, settings.thickness = k->desc.yarn.radius;
    result = yc_scene_tune(k->scene, &settings);
    return result == YC_OK ? yc_scene_add_body(k->scene, &body, NULL) : result;
}

/* A scene of the network, which is copied, with its nodes at `at`, in place of the one that was. */
static yc_result stage(scene_knit *k, const yc_yarns *y, const double (*at)[3], char *message) {
    yc_scene_desc settings = yc_scene_desc_preset(YC_REFERENCE);
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_scene *scene = NULL;
    yc_result result;
    memset(settings.gravity, 0, sizeof settings.gravity);
    settings.dt_max = 10.0 * k->period, settings.dt_min = 1e-6 * k->period, settings.mass_damping = 0.2 / k->period;
    settings.tolerance = 2e-3 * k->desc.yarn.radius;
    settings.solver = YC_SOLVER_DIRECT;
    settings.self_contact = 1, settings.thickness = k->desc.yarn.radius;
    cloth.yarns = y, cloth.yarn_positions = at, cloth.hold_network = 1;
    result = yc_scene_create(NULL, &settings, &scene, message);
    if (result != YC_OK) return result;
    result = yc_scene_add_cloth(scene, &cloth, NULL);
    yc_scene_destroy(k->scene);
    k->scene = scene;
    if (result == YC_OK && k->sphere > 0.0) result = put_sphere(k);
    if (result != YC_OK && message) snprintf(message, YC_MESSAGE_SIZE, "%s", yc_scene_message(k->scene));
    return result;
}

static yc_result begin(scene_knit *k, char *message) {
    yc_yarns network, *y = &network;
    double length;
    find_edges(k);
    network = k->elastic ? loosen(k) : k->yarns;
    length = 2.0 * (y->visit_u[y->visit_count - 1] - y->visit_u[0]) / y->visit_count;
    k->period = length * length * sqrt(k->desc.yarn.density / k->desc.yarn.bending);
    k->start = (double(*)[3])calloc((size_t)y->node_count, sizeof *k->start);
    k->x = (double(*)[3])calloc((size_t)y->node_count, sizeof *k->x);
    if (!k->start || !k->x) return YC_ERROR_MEMORY;
    memcpy(k->start, y->layout, (size_t)y->node_count * sizeof *k->start);
    memcpy(k->x, y->layout, (size_t)y->node_count * sizeof *k->x);
    return stage(k, y, NULL, message);
}

static scene_knit *make(const char *rows, int stitches, int row_count, const yc_yarn_material *yarn, int elastic,
    double sphere, char *message) {
    scene_knit *k = (scene_knit *)calloc(1, sizeof *k);
    yc_result result;
    if (!k) return NULL;
    k->desc = yc_knit_desc_default(), k->elastic = elastic, k->sphere = sphere;
    k->desc.stitches = stitches, k->desc.rows = row_count;
    if (yarn) k->desc.yarn = *yarn;
    result = yc_chart_read(NULL, rows, strlen(rows), NULL, &k->chart, message);
    k->desc.chart = &k->chart;
    if (result == YC_OK) result = yc_knit_relax(NULL, &k->desc, &k->rest, message);
    k->desc.rest = &k->rest;
    if (result == YC_OK) result = yc_knit(NULL, &k->desc, &k->yarns, message);
    if (result == YC_OK) result = begin(k, message);
    if (result == YC_OK) return k;
    scene_knit_free(k);
    return NULL;
}

scene_knit *scene_knit_new(const char *rows, int stitches, int row_count, const yc_yarn_material *yarn, char *message) {
    return make(rows, stitches, row_count, yarn, 0, 0.0, message);
}

scene_knit *scene_knit_new_elastic(
    const char *rows, int stitches, int row_count, const yc_yarn_material *yarn, char *message) {
    return make(rows, stitches, row_count, yarn, 1, 0.0, message);
}

scene_knit *scene_knit_new_above(
    const char *rows, int stitches, int row_count, const yc_yarn_material *yarn, double sphere, char *message) {
    return make(rows, stitches, row_count, yarn, 0, sphere, message);
}

yc_result scene_knit_hold(scene_knit *k) {
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    yc_result result = YC_OK;
    int i, j, corner;
    for (i = 0; i < k->yarns.node_count; i++)
        for (j = 0; j < 2; j++) low[j] = fmin(low[j], k->start[i][j]), high[j] = fmax(high[j], k->start[i][j]);
    for (corner = 0; corner < 4 && result == YC_OK; corner++) {
        double x = low[0] + (corner & 1 ? 0.75 : 0.25) * (high[0] - low[0]), least = HUGE_VAL;
        double y = low[1] + (corner & 2 ? 0.75 : 0.25) * (high[1] - low[1]);
        for (i = j = 0; i < k->yarns.node_count; i++) {
            double far = hypot(k->start[i][0] - x, k->start[i][1] - y);
            if (far < least) least = far, j = i;
        }
        result = yc_scene_pin(k->scene, 0, YC_NODE, j, NULL);
    }
    return result;
}

/* Steps of `time`, at most so many, until nothing moves by more than `still` in one. */
static yc_result come_to_rest(scene_knit *k, double time, double still, int most) {
    size_t bytes = (size_t)k->yarns.node_count * sizeof *k->x;
    double(*before)[3] = (double(*)[3])malloc(bytes);
    yc_result result = before ? YC_OK : YC_ERROR_MEMORY;
    yc_stats stats;
    int i;
    k->moved = HUGE_VAL;
    while (result == YC_OK && most-- > 0 && k->moved > still) {
        memcpy(before, k->x, bytes);
        result = yc_scene_step(k->scene, time, &stats);
        if (result == YC_OK) result = yc_scene_positions(k->scene, 0, YC_NODE, k->x);
        k->newton += stats.newton, k->substeps += stats.substeps, k->rejected += stats.rejected;
        k->seconds += stats.seconds;
        for (k->moved = 0.0, i = 0; i < 3 * k->yarns.node_count; i++)
            k->moved = fmax(k->moved, fabs(k->x[i / 3][i % 3] - before[i / 3][i % 3]));
    }
    free(before);
    return result;
}

yc_result scene_knit_settle(scene_knit *k, int most) {
    return come_to_rest(k, 10.0 * k->period, 0.05 * k->desc.yarn.radius, most);
}

yc_result scene_knit_fall(scene_knit *k, double speed, int most) {
    const double time = 0.02;
    return come_to_rest(k, time, speed * time, most);
}

/* The area within a course of the yarn, as seen along z; holes of lace are closed by that. */
static double shadow(const scene_knit *k, double (*x)[3]) {
    enum { MOST = 256 };
    const yc_yarns *y = &k->yarns;
    const double wide = 1.0 / k->desc.courses;
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL}, cell;
    unsigned char *covered = (unsigned char *)calloc((size_t)MOST * MOST, 1);
    int i, j, v, count = 0;
    if (!covered) return NAN;
    for (i = 0; i < y->node_count; i++)
        for (j = 0; j < 2; j++) low[j] = fmin(low[j], x[i][j] - wide), high[j] = fmax(high[j], x[i][j] + wide);
    cell = fmax(high[0] - low[0], high[1] - low[1]) / (MOST - 1);
    for (v = 0; v + 1 < y->visit_count; v++) /* segments are shorter than a course */
        for (i = (int)((x[y->visit_node[v]][0] - wide - low[0]) / cell);
             i < MOST && low[0] + i * cell < x[y->visit_node[v]][0] + wide; i++)
            for (j = (int)((x[y->visit_node[v]][1] - wide - low[1]) / cell);
                 j < MOST && low[1] + j * cell < x[y->visit_node[v]][1] + wide; j++) {
                double dx = low[0] + i * cell - x[y->visit_node[v]][0], dy = low[1] + j * cell - x[y->visit_node[v]][1];
                if (dx * dx + dy * dy < wide * wide) covered[MOST * j + i] = 1;
            }
    for (i = 0; i < MOST * MOST; i++) count += covered[i];
    free(covered);
    return count * cell * cell;
}

scene_knit_drape scene_knit_hang(const scene_knit *k) {
    scene_knit_drape d;
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL}, top = -HUGE_VAL, deep = HUGE_VAL;
    int i, j, count[2] = {0, 0};
    memset(&d, 0, sizeof d);
    for (i = 0; i < k->yarns.node_count; i++) {
        for (j = 0; j < 2; j++) low[j] = fmin(low[j], k->start[i][j]), high[j] = fmax(high[j], k->start[i][j]);
        top = fmax(top, k->x[i][2]), deep = fmin(deep, k->x[i][2]);
    }
    d.shadow = shadow(k, k->x) / shadow(k, k->start), d.depth = top - deep;
    for (i = 0; i < k->yarns.node_count; i++)
        for (j = 0; j < 2; j++) { /* the outermost stitches and rows */
            const double *x = k->start[i], edge = 1.0 / (j ? k->desc.courses : k->desc.wales);
            if (x[j] > low[j] + edge && x[j] < high[j] - edge) continue;
            if (fabs(x[!j] - 0.5 * (low[!j] + high[!j])) > (high[!j] - low[!j]) / 6.0) continue;
            d.low[j] += top - k->x[i][2], count[j]++;
        }
    for (j = 0; j < 2; j++) d.low[j] /= count[j] ? count[j] : 1;
    return d;
}

/* The line of mean positions of columns (axis 0) or rows (axis 1), in the plane of that axis and z, from the layout's
 * middle third of the other axis. Turns from the middle to both ends, upward positive; and the middle's range. */
static double follow(const scene_knit *k, int axis, double turn[2], double *flat) {
    enum { MOST = 256 };
    double sum[MOST][4], low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL}, angle[MOST] = {0.0}, least,
                         largest;
    int i, j, n = axis ? k->desc.rows : k->desc.stitches, count;
    if (n > MOST) n = MOST;
    memset(sum, 0, sizeof sum);
    for (i = 0; i < k->yarns.node_count; i++)
        for (j = 0; j < 2; j++) low[j] = fmin(low[j], k->start[i][j]), high[j] = fmax(high[j], k->start[i][j]);
    for (i = 0; i < k->yarns.node_count; i++) {
        double at = (k->start[i][axis] - low[axis]) / (high[axis] - low[axis]) * n;
        double *s = sum[at < n ? (int)at : n - 1];
        if (fabs(k->start[i][!axis] - 0.5 * (low[!axis] + high[!axis])) > (high[!axis] - low[!axis]) / 6.0) continue;
        s[3] += 1.0;
        for (j = 0; j < 3; j++) s[j] += k->x[i][j];
    }
    for (i = count = 0; i < n; i++) /* pairs of neighbours, so that ribs and ridges even out */
        if (sum[i][3] > 0.0 && i + 1 < n && sum[i + 1][3] > 0.0) {
            for (j = 0; j < 3; j++) sum[count][j] = 0.5 * (sum[i][j] / sum[i][3] + sum[i + 1][j] / sum[i + 1][3]);
            count++;
        }
    for (i = 0; i + 1 < count; i++) {
        angle[i] = atan2(sum[i + 1][2] - sum[i][2], sum[i + 1][axis] - sum[i][axis]);
        while (i && angle[i] > angle[i - 1] + pi) angle[i] -= 2.0 * pi;
        while (i && angle[i] < angle[i - 1] - pi) angle[i] += 2.0 * pi;
    }
    least = largest = angle[count / 2];
    for (i = count / 4; i < count - 1 - count / 4; i++)
        least = fmin(least, angle[i]), largest = fmax(largest, angle[i]);
    *flat = largest - least;
    turn[0] = 0.5 * (least + largest) - angle[0], turn[1] = angle[count - 2] - 0.5 * (least + largest);
    return sqrt(pow(sum[count - 1][0] - sum[0][0], 2.0) + pow(sum[count - 1][1] - sum[0][1], 2.0) +
        pow(sum[count - 1][2] - sum[0][2], 2.0));
}

scene_knit_shape scene_knit_look(const scene_knit *k) {
    scene_knit_shape s;
    double flat;
    int i;
    s.width = follow(k, 0, s.side, &s.flat), s.height = follow(k, 1, s.end, &flat);
    s.flat = fmax(s.flat, flat);
    for (i = 0; i < 2; i++) s.side[i] = -s.side[i];
    return s;
}

/* ---- lace ---- */

double scene_knit_wave(const scene_knit *k, double times) {
    enum { BINS = 72 };
    double top[BINS], low = HUGE_VAL, high = -HUGE_VAL, mean = 0.0, c = 0.0, s = 0.0;
    int i;
    for (i = 0; i < k->yarns.node_count; i++) low = fmin(low, k->start[i][0]), high = fmax(high, k->start[i][0]);
    for (i = 0; i < BINS; i++) top[i] = -HUGE_VAL;
    for (i = 0; i < k->yarns.node_count; i++) {
        int at = (int)(BINS * (k->start[i][0] - low) / (high - low) * 0.9999);
        top[at] = fmax(top[at], k->start[i][1]);
    }
    for (i = 0; i < BINS; i++) mean += top[i] / BINS;
    for (i = 0; i < BINS; i++)
        c += 2.0 / BINS * (top[i] - mean) * cos(2.0 * pi * times * (i + 0.5) / BINS),
            s += 2.0 / BINS * (top[i] - mean) * sin(2.0 * pi * times * (i + 0.5) / BINS);
    return hypot(c, s);
}

int scene_knit_holes(const scene_knit *k, double share) {
    enum { MOST = 400 };
    const yc_yarns *y = &k->yarns;
    const double radius = k->desc.yarn.radius;
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL}, cell, least;
    unsigned char *covered = (unsigned char *)calloc((size_t)MOST * MOST, 1);
    int *stack = (int *)malloc((size_t)MOST * MOST * sizeof *stack), i, j, v, n[2], depth, holes = 0;
    for (i = 0; i < y->node_count; i++)
        for (j = 0; j < 2; j++) low[j] = fmin(low[j], k->start[i][j]), high[j] = fmax(high[j], k->start[i][j]);
    cell = fmax(high[0] - low[0], high[1] - low[1]) / (MOST - 1);
    least = share / (k->rest.wales * k->rest.courses * cell * cell);
    for (j = 0; j < 2; j++) n[j] = (int)((high[j] - low[j]) / cell) + 1;
    for (v = 0; covered && v + 1 < y->visit_count; v++) {
        const double *a = k->start[y->visit_node[v]], *b = k->start[y->visit_node[v + 1]];
        double dx = b[0] - a[0], dy = b[1] - a[1], square = dx * dx + dy * dy;
        int from[2], to[2];
        for (j = 0; j < 2; j++) {
            from[j] = (int)fmax(0.0, (fmin(a[j], b[j]) - radius - low[j]) / cell);
            to[j] = (int)fmin(n[j] - 1.0, (fmax(a[j], b[j]) + radius - low[j]) / cell);
        }
        for (i = from[0]; i <= to[0]; i++)
            for (j = from[1]; j <= to[1]; j++) {
                double x = low[0] + i * cell - a[0], z = low[1] + j * cell - a[1];
                double t = square > 0.0 ? fmax(0.0, fmin(1.0, (x * dx + z * dy) / square)) : 0.0;
                if (hypot(x - t * dx, z - t * dy) < radius) covered[MOST * j + i] = 1;
            }
    }
    for (v = 0; covered && stack && v < MOST * MOST; v++) { /* what the outline leaves open is no hole */
        int edge = 0, count = 0;
        if (v % MOST >= n[0] || v / MOST >= n[1] || covered[v]) continue;
        covered[v] = 1, stack[0] = v;
        for (depth = 1; depth; count++) {
            int at = stack[--depth], x = at % MOST, z = at / MOST;
            edge |= !x || !z || x == n[0] - 1 || z == n[1] - 1;
            for (i = 0; i < 4; i++) {
                int p = x + (i == 0) - (i == 1), q = z + (i == 2) - (i == 3);
                if (p < 0 || q < 0 || p >= n[0] || q >= n[1] || covered[MOST * q + p]) continue;
                covered[MOST * q + p] = 1, stack[depth++] = MOST * q + p;
            }
        }
        holes += !edge && count > least;
    }
    free(covered), free(stack);
    return holes;
}

double scene_knit_lean(const scene_knit *k, double from, double to) {
    const yc_yarns *y = &k->yarns;
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL}, d[2] = {0.0, 0.0}, height;
    int i, j;
    for (i = 0; i < y->node_count; i++)
        for (j = 0; j < 2; j++) low[j] = fmin(low[j], k->start[i][j]), high[j] = fmax(high[j], k->start[i][j]);
    height = (high[1] - low[1]) / (k->desc.rows + 1);
    for (i = 0; i < y->contact_count; i++) {
        const double *a = k->start[y->visit_node[y->contacts[i].visit[0][0]]],
                     *b = k->start[y->visit_node[y->contacts[i].visit[0][1]]];
        double row = (a[1] - low[1]) / height - 0.5;
        if (fabs(a[0] - 0.5 * (low[0] + high[0])) > 0.25 * (high[0] - low[0]) || row < from || row >= to) continue;
        d[0] += b[0] - a[0], d[1] += b[1] - a[1];
    }
    return atan2(d[0], d[1]);
}

/* ---- unravelling ---- */

void scene_unravel_free(scene_unravel *u) {
    if (!u) return;
    yc_scene_destroy(u->scene), yc_yarns_destroy(&u->yarns), yc_chart_destroy(&u->chart);
    free(u);
}

/* How the yarn turns where it is laid, which is how fibres set. */
static void set_turns(yc_yarns *y) {
    int v, i;
    for (v = 1; v + 1 < y->visit_count; v++) {
        const double *a = y->layout[y->visit_node[v - 1]], *b = y->layout[y->visit_node[v]],
                     *c = y->layout[y->visit_node[v + 1]];
        double p[3], q[3], cosine = 0.0;
        for (i = 0; i < 3; i++) p[i] = b[i] - a[i], q[i] = c[i] - b[i], cosine += p[i] * q[i];
        y->visit_turn[v] = fabs(atan2(p[0] * q[1] - p[1] * q[0], cosine));
    }
}

static yc_result hang(scene_unravel *u, const yc_host *host, char *message) {
    yc_scene_desc settings = yc_scene_desc_default();
    yc_cloth_desc cloth = yc_cloth_desc_default();
    const yc_yarns *y = &u->yarns;
    int i;
    yc_result result;
    memset(settings.gravity, 0, sizeof settings.gravity);
    settings.dt_max = 2e-3, settings.mass_damping = 20.0, settings.solver = YC_SOLVER_DIRECT;
    cloth.yarns = y;
    result = yc_scene_create(host, &settings, &u->scene, message);
    if (result != YC_OK) return result;
    result = yc_scene_add_cloth(u->scene, &cloth, NULL);
    for (i = 0; result == YC_OK && i < u->desc.stitches; i++) /* where the legs of the first row cross */
        result = yc_scene_pin(u->scene, 0, YC_NODE, i, NULL);
    if (result != YC_OK && message) snprintf(message, YC_MESSAGE_SIZE, "%s", yc_scene_message(u->scene));
    return result;
}

void scene_curtain_free(scene_curtain *c) {
    if (!c) return;
    yc_scene_destroy(c->scene), yc_yarns_destroy(&c->yarns), yc_chart_destroy(&c->chart);
    free(c);
}

scene_curtain *scene_curtain_new(
    const yc_host *host, const yc_scene_desc *settings, const char *rows, const yc_knit_desc *desc, char *message) {
    scene_curtain *c = (scene_curtain *)calloc(1, sizeof *c);
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_knit_desc d = *desc;
    yc_knit_rest rest;
    double high = -HUGE_VAL;
    int i;
    yc_result result;
    if (!c) return NULL;
    memset(&rest, 0, sizeof rest);
    result = yc_chart_read(NULL, rows, strlen(rows), NULL, &c->chart, message);
    d.chart = &c->chart, cloth.yarns = &c->yarns;
    if (result == YC_OK) result = yc_knit_relax(NULL, &d, &rest, message);
    d.rest = &rest;
    if (result == YC_OK) result = yc_knit(NULL, &d, &c->yarns, message);
    if (result == YC_OK) result = yc_scene_create(host, settings, &c->scene, message);
    if (result == YC_OK) {
        result = yc_scene_add_cloth(c->scene, &cloth, NULL);
        for (i = 0; i < c->yarns.node_count; i++) high = fmax(high, c->yarns.layout[i][1]);
        for (i = 0; i < c->yarns.node_count && result == YC_OK; i++)
            if (c->yarns.layout[i][1] > high - 0.5 / rest.courses) result = yc_scene_pin(c->scene, 0, YC_NODE, i, NULL);
        if (result != YC_OK && message) snprintf(message, YC_MESSAGE_SIZE, "%s", yc_scene_message(c->scene));
    }
    yc_knit_rest_destroy(&rest);
    if (result == YC_OK) return c;
    scene_curtain_free(c);
    return NULL;
}

scene_unravel *scene_unravel_new(const yc_host *host, const char *rows, int stitches, int row_count, char *message) {
    scene_unravel *u = (scene_unravel *)calloc(1, sizeof *u);
    const yc_yarns *y = &u->yarns;
    yc_result result;
    if (!u) return NULL;
    u->desc = yc_knit_desc_default();
    u->desc.stitches = stitches, u->desc.rows = row_count, u->desc.live = 1;
    result = yc_chart_read(NULL, rows, strlen(rows), NULL, &u->chart, message);
    u->desc.chart = &u->chart;
    if (result == YC_OK) result = yc_knit(NULL, &u->desc, &u->yarns, message);
    if (result == YC_OK) set_turns(&u->yarns), result = hang(u, host, message);
    if (result != YC_OK) {
        scene_unravel_free(u);
        return NULL;
    }
    u->tip = y->visit_node[y->visit_count - 1];
    memcpy(u->from, y->layout[u->tip], sizeof u->from);
    u->way = u->from[0] > y->layout[y->visit_node[y->visit_count - 2]][0] ? 1.0 : -1.0;
    u->loop = (y->visit_u[y->visit_count - 1] - y->visit_u[0]) / (stitches * (row_count + 1));
    return u;
}

yc_result scene_unravel_pull(scene_unravel *u, double distance, double seconds, yc_stats *stats) {
    double at[3], force[3] = {0.0, 0.0, 0.0};
    yc_result result;
    memcpy(at, u->from, sizeof at);
    at[0] += u->way * (u->pulled + distance);
    result = yc_scene_pin(u->scene, 0, YC_NODE, u->tip, at);
    if (result == YC_OK) result = yc_scene_step(u->scene, seconds, stats);
    if (result == YC_OK) result = yc_scene_pin_force(u->scene, 0, YC_NODE, u->tip, force);
    if (result == YC_OK) u->pulled += distance, u->force = u->way * force[0];
    return result;
}

scene_knit_munden scene_knit_gauge(const scene_knit *k) {
    const yc_yarns *y = &k->yarns;
    scene_knit_munden m;
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL}, sum = 0.0;
    signed char *foot = (signed char *)calloc((size_t)y->visit_count, 1); /* the new loop's visit to A: the sign */
    int i, j, count = 0;
    memset(&m, 0, sizeof m);
    if (!foot) return m;
    for (i = 0; i < y->node_count; i++)
        for (j = 0; j < 2; j++) low[j] = fmin(low[j], k->start[i][j]), high[j] = fmax(high[j], k->start[i][j]);
    for (i = 0; i < y->contact_count; i++) foot[y->contacts[i].visit[1][0]] = y->contacts[i].sign;
    for (i = 0; i + 8 < y->visit_count; i++) { /* a loop has eight visits */
        const double *x = k->start[y->visit_node[i]];
        int inside = 1;
        for (j = 0; j < 2; j++) inside &= fabs(x[j] - 0.5 * (low[j] + high[j])) < (high[j] - low[j]) / 6.0;
        if (inside && foot[i] && foot[i] == foot[i + 8]) sum += y->visit_u[i + 8] - y->visit_u[i], count++;
    }
    free(foot);
    m.loop = count ? sum / count : 0.0;
    m.kw = k->desc.wales / k->rest.scale[0] * m.loop, m.kc = k->desc.courses / k->rest.scale[1] * m.loop;
    m.ks = m.kw * m.kc;
    return m;
}

/* Which end's nodes are drawn: -1, 1, or 0 for none. */
static int drawn(const scene_knit *k, int axis, int node) {
    const double pitch = 1.0 / (axis ? k->desc.courses : k->desc.wales);
    double low = HUGE_VAL, high = -HUGE_VAL;
    int i;
    for (i = k->first[1]; i < k->first[2]; i++) { /* what is cast on or bound off sticks out */
        double at = k->start[k->yarns.visit_node[i]][axis];
        low = fmin(low, at), high = fmax(high, at);
    }
    return k->start[node][axis] < low + pitch ? -1 : k->start[node][axis] > high - pitch;
}

/* Mean place along the axis of what is drawn at both ends, and the force that holds it. */
static void ends(const scene_knit *k, const signed char *side, int axis, double at[2], double *force) {
    int i, count[2] = {0, 0};
    at[0] = at[1] = *force = 0.0;
    for (i = 0; i < k->yarns.node_count; i++) {
        double f[3];
        if (!side[i]) continue;
        at[side[i] > 0] += k->x[i][axis], count[side[i] > 0]++;
        if (yc_scene_pin_force(k->scene, 0, YC_NODE, i, f) == YC_OK) *force += 0.5 * side[i] * f[axis];
    }
    for (i = 0; i < 2; i++) at[i] /= count[i] ? count[i] : 1;
}

yc_result scene_knit_draw(scene_knit *k, int axis, double step, double force, scene_knit_pull *p) {
    signed char *side = (signed char *)calloc((size_t)k->yarns.node_count, 1);
    double at[2], carry = axis ? k->desc.stitches : k->desc.rows, sum, shift = 0.0, laid = 0.0;
    yc_result result = side ? YC_OK : YC_ERROR_MEMORY;
    int i, n;
    memset(p, 0, sizeof *p);
    for (i = 0; i < k->yarns.node_count && result == YC_OK; i++) side[i] = (signed char)drawn(k, axis, i);
    laid = axis ? k->desc.rows / k->desc.courses : k->desc.stitches / k->desc.wales;
    for (n = 0; result == YC_OK && n < SCENE_PULL; n++) {
        double before = shift;
        shift = 0.5 * step * n * laid;
        for (i = 0; i < k->yarns.node_count && result == YC_OK; i++) {
            double to[3];
            if (!side[i]) continue;
            memcpy(to, k->x[i], sizeof to), to[axis] += side[i] * (shift - before);
            result = yc_scene_pin(k->scene, 0, YC_NODE, i, to);
        }
        if (result == YC_OK) result = scene_knit_settle(k, 4);
        if (result == YC_OK) result = yc_scene_energy(k->scene, p->energy[n]);
        if (result != YC_OK) break;
        ends(k, side, axis, at, &sum);
        if (!n) p->length = at[1] - at[0];
        p->stretch[n] = (at[1] - at[0]) / p->length - 1.0, p->force[n] = sum / carry, p->count = n + 1;
        if (p->force[n] > force) break;
    }
    free(side);
    return result;
}

double scene_knit_pull_at(const scene_knit_pull *p, double force) {
    double first = 0.0;
    int n, found = 0;
    for (n = 0; n + 1 < p->count; n++) {
        double a = p->force[n], b = p->force[n + 1], s = p->stretch[n + 1] - p->stretch[n];
        if (!found && b > 0.0) found = 1, first = a < 0.0 ? p->stretch[n] + s * a / (a - b) : p->stretch[n];
        if (b >= force) return (1.0 + p->stretch[n] + s * (force - a) / (b - a)) / (1.0 + first) - 1.0;
    }
    return NAN;
}

/* The mean distance of neighbouring loops of a row where neither is among the outer sixth on any side. */
static double stitch_width(const scene_knit *k) {
    const yc_yarns *y = &k->yarns;
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL}, sum = 0.0;
    int i, j, count = 0;
    for (i = 0; i < y->node_count; i++)
        for (j = 0; j < 2; j++) low[j] = fmin(low[j], k->start[i][j]), high[j] = fmax(high[j], k->start[i][j]);
    for (i = 0; i + 8 < y->visit_count; i++) { /* a loop has eight visits */
        const int a = y->visit_node[i], b = y->visit_node[i + 8];
        double d[3];
        int inside = 1;
        for (j = 0; j < 2; j++)
            inside &= fabs(0.5 * (k->start[a][j] + k->start[b][j] - low[j] - high[j])) < (high[j] - low[j]) / 3.0;
        if (!inside || fabs(k->start[a][1] - k->start[b][1]) > 0.1 / k->desc.courses) continue;
        for (j = 0; j < 3; j++) d[j] = k->x[b][j] - k->x[a][j];
        sum += sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), count++;
    }
    return count ? sum / count : NAN;
}

/* From here on its yarns rub by that coefficient where they lie. */
static yc_result rub(scene_knit *k, double friction) {
    yc_yarn_material yarn[2];
    yc_yarns now;
    yc_result result = yc_scene_network(k->scene, 0, &now);
    int i;
    if (result != YC_OK) return result;
    for (i = 0; i < 1 + k->elastic; i++) yarn[i] = now.materials[i], yarn[i].friction = friction;
    now.materials = yarn;
    return stage(k, &now, (const double(*)[3])k->x, NULL);
}

yc_result scene_knit_overstretch(scene_knit *k, int phase, double friction, double stretch, double *width) {
    enum { STEPS = 10 };
    double(*from)[3] = (double(*)[3])malloc((size_t)k->yarns.node_count * sizeof *from);
    const double before = stitch_width(k);
    yc_result result = from ? YC_OK : YC_ERROR_MEMORY;
    int i, n;
    if (from) memcpy(from, k->x, (size_t)k->yarns.node_count * sizeof *from);
    for (n = 1; n <= STEPS && phase == SCENE_DRAWN && result == YC_OK; n++) {
        for (i = 0; i < k->yarns.node_count && result == YC_OK; i++) {
            const int side = drawn(k, 0, i);
            double to[3];
            memcpy(to, from[i], sizeof to);
            to[0] += 0.5 * side * stretch * k->desc.stitches * before * n / STEPS;
            if (side) result = yc_scene_pin(k->scene, 0, YC_NODE, i, to);
        }
        if (result == YC_OK) result = scene_knit_settle(k, n < STEPS ? 1 : 4);
    }
    for (i = 0; i < k->yarns.node_count && phase == SCENE_AFTER && result == YC_OK; i++)
        if (drawn(k, 0, i)) result = yc_scene_unpin(k->scene, 0, YC_NODE, i);
    if (phase != SCENE_DRAWN && result == YC_OK) result = scene_knit_settle(k, 30);
    if (phase == SCENE_BEFORE && result == YC_OK) result = rub(k, friction);
    *width = stitch_width(k);
    free(from);
    return result;
}
