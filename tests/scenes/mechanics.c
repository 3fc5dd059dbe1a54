#include "mechanics.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
static const double weight = 9.81;
static const double tiny = 1e-9; /* m, to tell where a node of the layout lies */

/* ---- samples --------------------------------------------------------------------------------------------------- */

yc_scene_desc scene_quasistatic(void) {
    yc_scene_desc d = yc_scene_desc_preset(YC_REFERENCE);
    memset(d.gravity, 0, sizeof d.gravity);
    d.dt_max = 1e3, d.dt_min = 250.0, d.mass_damping = 1.0, d.tolerance = 1e-10, d.newton_limit = 200;
    return d;
}

scene_sample *scene_sample_new(
    const yc_weave_desc *weave, const yc_mesh *mesh, const yc_scene_desc *settings, int hold_sliding, char *message) {
    scene_sample *s = (scene_sample *)calloc(1, sizeof *s);
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_result result;
    if (message) message[0] = 0;
    if (!s) return NULL;
    s->weave = *weave;
    result = yc_weave(NULL, weave, mesh, &s->yarns, message);
    if (result == YC_OK) result = yc_scene_create(NULL, settings, &s->scene, message);
    if (result == YC_OK) {
        cloth.yarns = &s->yarns, cloth.hold_sliding = hold_sliding, cloth.hold_network = 1;
        result = yc_scene_add_cloth(s->scene, &cloth, NULL);
        if (result != YC_OK && message)
            memcpy(message, yc_scene_message(s->scene), strlen(yc_scene_message(s->scene)) + 1);
    }
    s->x = (double(*)[3])calloc((size_t)s->yarns.node_count + 1, sizeof *s->x);
    if (result != YC_OK || !s->x) {
        scene_sample_free(s);
        return NULL;
    }
    memcpy(s->x, s->yarns.layout, (size_t)s->yarns.node_count * sizeof *s->x);
    return s;
}

void scene_sample_free(scene_sample *s) {
    if (!s) return;
    yc_scene_destroy(s->scene), yc_yarns_destroy(&s->yarns);
    free(s->x), free(s);
}

yc_result scene_sample_solve(scene_sample *s, double dt) {
    yc_stats stats;
    yc_result result = yc_scene_step(s->scene, dt, &stats);
    if (result == YC_OK && stats.newton > s->newton) s->newton = stats.newton;
    return result == YC_OK ? yc_scene_positions(s->scene, 0, YC_NODE, s->x) : result;
}

int scene_sample_nearest(const scene_sample *s, double u, double v) {
    double nearest = HUGE_VAL;
    int i, best = 0;
    for (i = 0; i < s->yarns.node_count; i++) {
        double d = hypot(s->yarns.layout[i][0] - u, s->yarns.layout[i][1] - v);
        if (d < nearest) nearest = d, best = i;
    }
    return best;
}

/* Ends a test: hands out why it failed, and frees its sample. */
static yc_result finish(scene_sample *s, yc_result result, char *message) {
    if (s && result != YC_OK && message) snprintf(message, YC_MESSAGE_SIZE, "%s", yc_scene_message(s->scene));
    scene_sample_free(s);
    return result;
}

/* m, between what is laid as one. */
static double pitch(const yc_weave_desc *weave, int axis) { return weave->bundle * weave->spacing[axis]; }

static scene_sample *rectangle(const yc_weave_desc *weave, int axis, int across, int along, char *message) {
    yc_weave_desc d = *weave;
    yc_scene_desc settings = scene_quasistatic();
    if (d.grain != 0.0) settings.tolerance = 1e-8; /* larger swatches and far larger motions */
    d.size[axis] = along * pitch(weave, axis), d.size[!axis] = across * pitch(weave, !axis);
    return scene_sample_new(&d, NULL, &settings, 1, message);
}

/* ---- tension --------------------------------------------------------------------------------------------------- */

/* 1 at the end that is drawn, -1 at the other, 2 at a side, 0 elsewhere. On the bias a clamp takes in two spacings. */
static int clamp_of(const scene_sample *s, int axis, int node) {
    const double *at = s->yarns.layout[node], *size = s->weave.size;
    double grip = s->weave.grain == 0.0 ? tiny : pitch(&s->weave, 0) + pitch(&s->weave, 1);
    if (at[axis] < grip) return -1;
    if (at[axis] > size[axis] - grip) return 1;
    return at[!axis] < tiny || at[!axis] > size[!axis] - tiny ? 2 : 0;
}

/* Strain between two nodes of the middle line. */
static double middle_strain(const scene_sample *s, int axis, int along) {
    const double *size = s->weave.size;
    double from[2], to[2], width = along ? 1.0 / 6.0 : 0.25;
    int line = along ? axis : !axis, a, b;
    from[0] = to[0] = 0.5 * size[0], from[1] = to[1] = 0.5 * size[1];
    from[line] -= width * size[line], to[line] += width * size[line];
    a = scene_sample_nearest(s, from[0], from[1]), b = scene_sample_nearest(s, to[0], to[1]);
    return (s->x[b][line] - s->x[a][line]) / (s->yarns.layout[b][line] - s->yarns.layout[a][line]) - 1.0;
}

/* Equilibrium, and what holds the second clamp against `along`, per width. */
static yc_result clamp_force(scene_sample *s, int axis, const double along[2], double *force) {
    yc_result result = scene_sample_solve(s, 1e3);
    int i;
    for (*force = 0.0, i = 0; i < s->yarns.node_count && result == YC_OK; i++) {
        double f[3];
        if (clamp_of(s, axis, i) != 1) continue;
        result = yc_scene_pin_force(s->scene, 0, YC_NODE, i, f);
        *force += (f[0] * along[0] + f[1] * along[1]) / s->weave.size[!axis];
    }
    return result;
}

/* Draws the clamps apart by a strain of the whole. */
static yc_result draw(scene_sample *s, int axis, int hold_width, double strain, double *force) {
    double length = s->weave.size[axis], along[2] = {0.0, 0.0};
    yc_result result = YC_OK;
    int i;
    for (i = 0; i < s->yarns.node_count && result == YC_OK; i++) {
        double to[3];
        int clamp = clamp_of(s, axis, i);
        if (clamp == 0 || (clamp == 2 && !hold_width)) continue;
        memcpy(to, s->yarns.layout[i], sizeof to);
        to[axis] += strain * (clamp == 2 ? to[axis] : clamp > 0 ? length : 0.0);
        result = yc_scene_pin(s->scene, 0, YC_NODE, i, to);
    }
    along[axis] = 1.0;
    return result == YC_OK ? clamp_force(s, axis, along, force) : result;
}

yc_result scene_tensile_run(const scene_tensile_desc *d, scene_tensile *out, char *message) {
    scene_sample *s = rectangle(&d->weave, d->axis, d->across, d->along, message);
    yc_result result = s ? YC_OK : YC_ERROR_ARGUMENT;
    memset(out, 0, sizeof *out);
    out->count = 1;
    while (result == YC_OK && out->count < SCENE_CURVE && d->step * out->count < d->strain + 1e-12) {
        int k = out->count;
        result = draw(s, d->axis, d->hold_width, d->step * k, out->force + k);
        out->strain[k] = middle_strain(s, d->axis, 1), out->across[k] = middle_strain(s, d->axis, 0);
        if (result == YC_OK) out->count++, out->newton = s->newton;
        if (out->force[k] > d->force) break;
    }
    if (result == YC_OK && d->show) d->show(s);
    return finish(s, result, message);
}

/* The point of the curve behind a force, 0 when there is none. */
static int behind(const scene_tensile *c, double force) {
    int k = 1;
    while (k < c->count && c->force[k] < force) k++;
    return k < c->count ? k : 0;
}

double scene_tensile_slope(const scene_tensile *c, double force) {
    int k = behind(c, force);
    return k ? (c->force[k] - c->force[k - 1]) / (c->strain[k] - c->strain[k - 1]) : NAN;
}

double scene_tensile_at(const scene_tensile *c, double force) {
    int k = behind(c, force);
    return k ? c->strain[k] - (c->force[k] - force) / scene_tensile_slope(c, force) : NAN;
}

/* ---- shear ----------------------------------------------------------------------------------------------------- */

/* Turns the clamped yarns, longer by a strain, to an angle; the shear force per width. */
static yc_result turn(scene_sample *s, int axis, double strain, double angle, double *force) {
    double along[2];
    yc_result result = YC_OK;
    int i;
    for (i = 0; i < s->yarns.node_count && result == YC_OK; i++) {
        double to[3], at = s->yarns.layout[i][axis] * (1.0 + strain);
        if (abs(clamp_of(s, axis, i)) != 1) continue;
        memcpy(to, s->yarns.layout[i], sizeof to);
        to[axis] = at * cos(angle), to[!axis] += at * sin(angle);
        result = yc_scene_pin(s->scene, 0, YC_NODE, i, to);
    }
    along[axis] = -sin(angle), along[!axis] = cos(angle);
    return result == YC_OK ? clamp_force(s, axis, along, force) : result;
}

/* The strain at which the clamps pull with that tension. */
static yc_result tighten(scene_sample *s, int axis, double tension, double *strain) {
    double last = 0.0, force = 0.0, step = 5e-4;
    yc_result result = YC_OK;
    for (*strain = 0.0; result == YC_OK && force < tension && *strain < 0.2;) {
        last = force;
        result = draw(s, axis, 0, *strain += step, &force);
    }
    if (force > last) *strain -= step * (force - tension) / (force - last);
    return result;
}

yc_result scene_shear_run(const scene_shear_desc *d, scene_shear_loop *out, char *message) {
    scene_sample *s = rectangle(&d->weave, d->axis, d->across, d->along, message);
    double strain = 0.0, step = d->angle / d->steps, low = pi / 360.0, high = pi / 72.0, last = 0.0;
    double at[2][2][2]; /* branch (down, up), side (-, +), at 0.5 and 2.5 degrees */
    yc_result result = s ? YC_OK : YC_ERROR_ARGUMENT;
    int i, n = d->steps;
    memset(out, 0, sizeof *out), memset(at, 0, sizeof at);
    if (result == YC_OK && d->tension > 0.0) result = tighten(s, d->axis, d->tension, &strain);
    for (i = 1; i <= 5 * n && result == YC_OK; i++) {
        double angle = i <= n ? i * step : i <= 3 * n ? (2 * n - i) * step : (i - 4 * n) * step, force = 0.0;
        int up = i > 3 * n, side, k;
        result = turn(s, d->axis, strain, angle, &force);
        if (i == n && result == YC_OK && d->show) d->show(s);
        for (side = 0; side < 2 && i > n; side++)
            for (k = 0; k < 2; k++) { /* linear between the two steps around */
                double wanted = (side ? 1.0 : -1.0) * (k ? high : low), before = angle - (up ? step : -step);
                double t = (wanted - before) / (angle - before);
                if (t > 1e-6 && t < 1.0 + 1e-6) at[up][side][k] = last + t * (force - last);
            }
        if (i > n) out->work += 0.5 * (force + last) * (up ? step : -step);
        last = force;
    }
    out->stiffness = 0.5 * (at[1][1][1] - at[1][1][0] + at[0][0][0] - at[0][0][1]) / (high - low);
    out->hysteresis = 0.5 * (at[1][1][0] - at[0][1][0] + at[1][0][0] - at[0][0][0]);
    if (s) out->newton = s->newton;
    return finish(s, result, message);
}

/* ---- bending --------------------------------------------------------------------------------------------------- */

/* From the tip, where it hangs at `tip`, the elastica theta'' = -t cos theta turns back to the horizontal; returns
 * where, t in bending lengths, and the angle of the chord. */
static double elastica(double tip, double *angle) {
    double theta = tip, slope = 0.0, t = 0.0, h = 5e-4, x = 0.0, y = 0.0;
    for (;;) { /* the midpoint rule */
        double middle = theta + 0.5 * h * slope, slope_middle = slope - 0.5 * h * t * cos(theta);
        double next = theta + h * slope_middle;
        double part = next > 0.0 ? 1.0 : theta / (theta - next);
        x += part * h * cos(middle), y += part * h * sin(middle), t += part * h;
        if (next <= 0.0) break;
        slope -= h * (t - 0.5 * h) * cos(middle), theta = next;
    }
    *angle = atan2(y, x);
    return t;
}

double scene_elastica(double angle) {
    double low = 1e-3, high = 1.57, found, t = 0.0;
    int i;
    for (i = 0; i < 50; i++) {
        t = elastica(0.5 * (low + high), &found);
        if (found < angle) low = 0.5 * (low + high);
        else high = 0.5 * (low + high);
    }
    return t;
}

yc_result scene_cantilever_run(const scene_cantilever_desc *d, scene_cantilever *out, char *message) {
    static const double share[] = {0.1, 0.3, 0.6, 1.0};
    double p = pitch(&d->weave, d->axis), load = weight * yc_weave_material(&d->weave).density, clamp = 1.5 * p, x, y;
    scene_sample *s = rectangle(&d->weave, d->axis, d->across, (int)(d->overhang / p + 1.5), message);
    yc_result result = s ? YC_OK : YC_ERROR_ARGUMENT;
    int i, count = 0;
    memset(out, 0, sizeof *out);
    for (i = 0; s && result == YC_OK && i < s->yarns.node_count; i++) /* two crossings of each yarn */
        if (s->yarns.layout[i][d->axis] < clamp + tiny) result = yc_scene_pin(s->scene, 0, YC_NODE, i, NULL);
    for (i = 0; s && result == YC_OK && i < (int)(sizeof share / sizeof *share); i++) {
        yc_scene_desc settings = yc_scene_desc_get(s->scene);
        settings.gravity[2] = -weight * share[i];
        settings.tolerance = 1e-7; /* rounding of the tensions alone moves a tip of a soft strip by 1e-8 */
        result = yc_scene_tune(s->scene, &settings);
        if (result == YC_OK) result = scene_sample_solve(s, 1e3);
    }
    if (!s || result != YC_OK) return finish(s, result, message);
    /* Between its last two crossings that are held, the strip begins to bend: see scene_tip_load. */
    clamp -= 0.5 * p;
    for (x = y = 0.0, i = 0; i < s->yarns.node_count; i++)
        if (s->yarns.layout[i][d->axis] > s->weave.size[d->axis] - tiny)
            x += s->x[i][d->axis] - clamp, y -= s->x[i][2], count++;
    out->angle = atan2(y, x);
    if (count && out->angle > 0.0 && out->angle < 1.4) {
        out->length = (s->weave.size[d->axis] - clamp) / scene_elastica(out->angle);
        out->rigidity = load * out->length * out->length * out->length;
    }
    out->newton = s->newton;
    if (d->show) d->show(s);
    return finish(s, result, message);
}

/* ---- drape ----------------------------------------------------------------------------------------------------- */

enum { DISC = 240 }; /* corners of its outline */

scene_drape_desc scene_drape_desc_default(const yc_weave_desc *weave) {
    scene_drape_desc d;
    d.weave = *weave;
    d.radius = 0.15, d.support = 0.09, d.dt = 0.01, d.duration = 1.5, d.start = 0, d.show = NULL;
    return d;
}

typedef struct {
    double way, x, y; /* where on the outline it is cut, and where it is now */
} corner;

static int by_way(const void *a, const void *b) {
    double p = ((const corner *)a)->way, q = ((const corner *)b)->way;
    return p < q ? -1 : p > q;
}

/* The ring's share that is left of the area inside the projected outline, a polygon through the yarns' ends. */
static double shadow(const scene_sample *s, const scene_drape_desc *d, int *folds) {
    const yc_yarns *y = &s->yarns;
    corner *c = (corner *)calloc(2 * (size_t)y->yarn_count, sizeof *c);
    double area = 0.0, mean = 0.0;
    int i, n = 0, above = 0;
    if (!c) return NAN;
    for (i = 0; i < 2 * y->yarn_count; i++) {
        int node = y->visit_node[i % 2 ? y->yarn_first[i / 2 + 1] - 1 : y->yarn_first[i / 2]];
        const double *at = y->layout[node];
        if (hypot(at[0], at[1]) < d->radius * cos(pi / DISC) - tiny) continue;
        c[n].way = atan2(at[1], at[0]), c[n].x = s->x[node][0], c[n++].y = s->x[node][1];
    }
    if (n < 3) {
        free(c);
        return NAN;
    }
    qsort(c, (size_t)n, sizeof *c, by_way);
    for (i = 0; i < n; i++) {
        const corner *p = c + i, *q = c + (i + 1) % n;
        area += 0.5 * (p->x * q->y - p->y * q->x), mean += hypot(p->x, p->y) / n;
    }
    for (*folds = 0, i = 0; i <= n; i++) { /* with some play about the mean */
        double r = hypot(c[i % n].x, c[i % n].y);
        if (!above && r > 1.03 * mean) above = 1, *folds += i < n;
        if (r < 0.97 * mean) above = 0;
    }
    free(c);
    return (area - pi * d->support * d->support) / (pi * (d->radius * d->radius - d->support * d->support));
}

yc_result scene_drape_run(const scene_drape_desc *d, scene_drape *out, char *message) {
    double position[DISC + 1][3], uv[DISC + 1][2];
    int triangle[DISC][3], i, k, steps = (int)(d->duration / d->dt + 0.5);
    yc_mesh mesh;
    yc_scene_desc settings = yc_scene_desc_default();
    scene_sample *s;
    yc_result result = YC_OK;
    memset(out, 0, sizeof *out), memset(position, 0, sizeof position), memset(&mesh, 0, sizeof mesh);
    for (i = 0; i < DISC; i++) { /* only to clip the weave: yarns alone make the cloth */
        position[i][0] = d->radius * cos(2.0 * pi * i / DISC), position[i][1] = d->radius * sin(2.0 * pi * i / DISC);
        triangle[i][0] = DISC, triangle[i][1] = i, triangle[i][2] = (i + 1) % DISC;
    }
    for (i = 0; i <= DISC; i++) memcpy(uv[i], position[i], sizeof uv[i]);
    mesh.vertex_count = mesh.uv_count = DISC + 1, mesh.triangle_count = DISC;
    mesh.positions = (const double(*)[3])position, mesh.uv = (const double(*)[2])uv;
    mesh.triangles = (const int(*)[3])triangle;
    memset(settings.gravity, 0, sizeof settings.gravity);
    settings.gravity[2] = -weight, settings.dt_max = d->dt, settings.mass_damping = 8.0;
    settings.solver = YC_SOLVER_DIRECT;
    s = scene_sample_new(&d->weave, &mesh, &settings, 1, message);
    if (!s) return YC_ERROR_ARGUMENT;
    for (i = 0; i < s->yarns.node_count && result == YC_OK; i++) {
        const double *at = s->yarns.layout[i];
        double r = hypot(at[0], at[1]), way = atan2(at[1], at[0]), push[3] = {0.0, 0.0, 0.0};
        if (r < d->support) {
            result = yc_scene_pin(s->scene, 0, YC_NODE, i, NULL);
            continue;
        }
        /* A breath of all numbers of folds; the cloth picks its own. */
        for (k = 2; k <= 9; k++) push[2] += 3e-3 * cos(k * way + (1.7 + 0.4 * d->start) * k * k);
        result = yc_scene_set_velocity(s->scene, 0, YC_NODE, i, push);
    }
    for (k = 0; k < steps && result == YC_OK; k++) {
        if (k == steps - steps / 10) out->drift = shadow(s, d, &out->folds);
        result = scene_sample_solve(s, d->dt);
    }
    out->coefficient = shadow(s, d, &out->folds), out->drift -= out->coefficient;
    out->crossings = s->yarns.visit_count - s->yarns.node_count;
    if (result == YC_OK && d->show) d->show(s);
    return finish(s, result, message);
}
