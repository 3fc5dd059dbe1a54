#include "knits.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const scene_stockinette = "pattern: a\nRow 1 (RS): Knit.\nRow 2 (WS): Purl.\n";
const char *const scene_garter = "pattern: a\nRow 1 (RS): Knit.\nRow 2 (WS): Knit.\n";
const char *const scene_rib = "pattern: a\nRow 1 (RS): *K1, p1, repeat from *.\nRow 2 (WS): *K1, p1, repeat from *.\n";
const char *const scene_rib2 = "pattern: a\nRow 1 (RS): *K2, p2, repeat from *.\nRow 2 (WS): *K2, p2, repeat from *.\n";

static const double pi = 3.14159265358979323846;

void scene_knit_free(scene_knit *k) {
    if (!k) return;
    yc_scene_destroy(k->scene), yc_yarns_destroy(&k->yarns), yc_chart_destroy(&k->chart);
    free(k->start), free(k->x), free(k);
}

static yc_result begin(scene_knit *k, char *message) {
    yc_scene_desc settings = yc_scene_desc_preset(YC_REFERENCE);
    yc_cloth_desc cloth = yc_cloth_desc_default();
    const yc_yarn_material *yarn = &k->desc.yarn;
    const yc_yarns *y = &k->yarns;
    double length = 2.0 * (y->visit_u[y->visit_count - 1] - y->visit_u[0]) / y->visit_count;
    yc_result result;
    k->period = length * length * sqrt(yarn->density / yarn->bending);
    memset(settings.gravity, 0, sizeof settings.gravity);
    settings.dt_max = 10.0 * k->period, settings.dt_min = 1e-6 * k->period, settings.mass_damping = 0.2 / k->period;
    settings.tolerance = 2e-3 * yarn->radius;
    settings.solver = YC_SOLVER_DIRECT;
    cloth.yarns = y, cloth.hold_network = 1;
    k->start = (double(*)[3])calloc((size_t)y->node_count, sizeof *k->start);
    k->x = (double(*)[3])calloc((size_t)y->node_count, sizeof *k->x);
    if (!k->start || !k->x) return YC_ERROR_MEMORY;
    memcpy(k->start, y->layout, (size_t)y->node_count * sizeof *k->start);
    memcpy(k->x, y->layout, (size_t)y->node_count * sizeof *k->x);
    result = yc_scene_create(NULL, &settings, &k->scene, message);
    if (result != YC_OK) return result;
    result = yc_scene_add_cloth(k->scene, &cloth, NULL);
    if (result != YC_OK && message) snprintf(message, YC_MESSAGE_SIZE, "%s", yc_scene_message(k->scene));
    return result;
}

scene_knit *scene_knit_new(const char *rows, int stitches, int row_count, const yc_yarn_material *yarn, char *message) {
    scene_knit *k = (scene_knit *)calloc(1, sizeof *k);
    yc_result result;
    if (!k) return NULL;
    k->desc = yc_knit_desc_default();
    k->desc.stitches = stitches, k->desc.rows = row_count;
    if (yarn) k->desc.yarn = *yarn;
    result = yc_chart_read(NULL, rows, strlen(rows), NULL, &k->chart, message);
    k->desc.chart = &k->chart;
    if (result == YC_OK) result = yc_knit(NULL, &k->desc, &k->yarns, message);
    if (result == YC_OK) result = yc_knit_relax(NULL, &k->yarns, &k->rest, message);
    if (result == YC_OK) result = begin(k, message);
    if (result == YC_OK) return k;
    scene_knit_free(k);
    return NULL;
}

yc_result scene_knit_settle(scene_knit *k, int most) {
    size_t bytes = (size_t)k->yarns.node_count * sizeof *k->x;
    double(*before)[3] = (double(*)[3])malloc(bytes);
    yc_result result = before ? YC_OK : YC_ERROR_MEMORY;
    yc_stats stats;
    int i;
    k->moved = HUGE_VAL;
    while (result == YC_OK && most-- > 0 && k->moved > 0.05 * k->desc.yarn.radius) {
        memcpy(before, k->x, bytes);
        result = yc_scene_step(k->scene, 10.0 * k->period, &stats);
        if (result == YC_OK) result = yc_scene_positions(k->scene, 0, YC_NODE, k->x);
        k->newton += stats.newton, k->substeps += stats.substeps, k->rejected += stats.rejected;
        k->seconds += stats.seconds;
        for (k->moved = 0.0, i = 0; i < 3 * k->yarns.node_count; i++)
            k->moved = fmax(k->moved, fabs(k->x[i / 3][i % 3] - before[i / 3][i % 3]));
    }
    free(before);
    return result;
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
