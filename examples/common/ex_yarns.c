#include "ex_yarns.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Stands so far off that all points are in the picture, in its middle. */
static ex_camera camera_for(const ex_yarns_view *v, double (*points)[3], int count) {
    ex_camera c;
    double axes[3][3], slope[2], low[2], high[2], size, distance = 0.1, wide = 0.0;
    int i, k, round;
    memset(&c, 0, sizeof c);
    c.up[1] = 1.0, c.fov = 24.0;
    slope[1] = tan(c.fov * 3.14159265358979 / 360.0), slope[0] = slope[1] * v->width / v->height;
    size = sqrt(v->from[0] * v->from[0] + v->from[1] * v->from[1] + v->from[2] * v->from[2]);
    for (k = 0; k < 3; k++) axes[2][k] = v->from[k] / size;
    size = hypot(axes[2][0], axes[2][2]);
    axes[0][0] = axes[2][2] / size, axes[0][1] = 0.0, axes[0][2] = -axes[2][0] / size;
    axes[1][0] = axes[2][1] * axes[0][2], axes[1][1] = axes[2][2] * axes[0][0] - axes[2][0] * axes[0][2],
    axes[1][2] = -axes[2][1] * axes[0][0];
    for (round = 0; round < 8; round++) {
        double widest = 0.0;
        low[0] = low[1] = HUGE_VAL, high[0] = high[1] = -HUGE_VAL;
        for (i = 0; i < count; i++) {
            double q[3] = {0.0, 0.0, 0.0};
            for (k = 0; k < 9; k++) q[k / 3] += axes[k / 3][k % 3] * (points[i][k % 3] - c.target[k % 3]);
            for (k = 0; k < 2; k++) {
                double s = q[k] / (distance - q[2]) / slope[k];
                low[k] = fmin(low[k], s), high[k] = fmax(high[k], s);
            }
        }
        for (k = 0; k < 3; k++)
            c.target[k] += 0.5 * distance *
                ((low[0] + high[0]) * slope[0] * axes[0][k] + (low[1] + high[1]) * slope[1] * axes[1][k]);
        for (k = 0; k < 2; k++) widest = fmax(widest, 0.5 * (high[k] - low[k]));
        distance *= widest / 0.94, wide = (high[0] - low[0]) * slope[0] * distance;
    }
    for (k = 0; k < 3; k++) c.target[k] += wide * (v->shift[0] * axes[0][k] + v->shift[1] * axes[1][k]);
    for (k = 0; k < 3; k++) c.eye[k] = c.target[k] + axes[2][k] * distance / v->zoom;
    return c;
}

/* What a picture needs in memory of its own. */
typedef struct {
    yc_curves curves;
    double (*nodes)[3], (*points)[3], (*colors)[3], *radii;
} drawing;

static void drawing_free(drawing *d) {
    free(d->curves.first), free(d->curves.yarn), free(d->curves.points), free(d->curves.radius);
    free(d->nodes), free(d->points), free(d->colors), free(d->radii);
}

static yc_result drawing_make(
    drawing *d, yc_scene *scene, int cloth, const yc_yarns *yarns, const yc_curve_desc *desc, char *message) {
    yc_curves *c = &d->curves;
    yc_result result = yc_curves_make(NULL, yarns, NULL, desc, c, message); /* the sizes */
    if (result != YC_OK) return result;
    c->first = calloc((size_t)c->curve_count + 1, sizeof *c->first);
    c->yarn = calloc((size_t)c->curve_count, sizeof *c->yarn);
    c->points = calloc((size_t)c->point_count, sizeof *c->points);
    c->radius = calloc((size_t)c->curve_count, sizeof *c->radius);
    d->nodes = calloc((size_t)yarns->node_count, sizeof *d->nodes);
    d->points = calloc((size_t)c->point_count, sizeof *d->points);
    d->colors = calloc((size_t)c->curve_count, sizeof *d->colors);
    d->radii = calloc((size_t)c->curve_count, sizeof *d->radii);
    if (!c->first || !c->yarn || !c->points || !c->radius || !d->nodes || !d->points || !d->colors || !d->radii) {
        snprintf(message, YC_MESSAGE_SIZE, "no memory for a picture of the yarns");
        return YC_ERROR_MEMORY;
    }
    result = yc_scene_positions(scene, cloth, YC_NODE, d->nodes);
    if (result != YC_OK) return result;
    return yc_curves_make(NULL, yarns, (const double(*)[3])d->nodes, desc, c, message);
}

/* A ball, by latitude and longitude. */
static void draw_ball(ex_scene *picture, const double *ball) {
    enum { ROUND = 64, ROWS = 32 };
    const double pi = 3.14159265358979323846;
    double(*at)[3] = calloc((size_t)(ROWS + 1) * ROUND, sizeof *at);
    int(*triangles)[3] = calloc((size_t)2 * ROWS * ROUND, sizeof *triangles), i, j;
    ex_material material;
    ex_material_body(&material);
    for (i = 0; at && i <= ROWS; i++)
        for (j = 0; j < ROUND; j++) {
            double *x = at[i * ROUND + j], around = ball[3] * sin(pi * i / ROWS);
            x[0] = ball[0] + around * sin(2.0 * pi * j / ROUND), x[1] = ball[1] - ball[3] * cos(pi * i / ROWS);
            x[2] = ball[2] + around * cos(2.0 * pi * j / ROUND);
        }
    for (i = 0; at && triangles && i < ROWS; i++)
        for (j = 0; j < ROUND; j++) {
            const int a = i * ROUND + j, b = i * ROUND + (j + 1) % ROUND, c = a + ROUND, d = b + ROUND;
            int *t = triangles[2 * a];
            t[0] = a, t[1] = b, t[2] = d, t[3] = a, t[4] = d, t[5] = c;
        }
    if (at && triangles)
        ex_render_mesh(picture, (const double(*)[3])at, (ROWS + 1) * ROUND, (const int(*)[3])triangles,
            2 * ROWS * ROUND, NULL, NULL, &material);
    free(at), free(triangles);
}

ex_image *ex_yarns_draw(yc_scene *scene, int cloth, const ex_yarns_view *view, const double (*colors)[3],
    ex_camera *camera, int keep, char *message) {
    static const double by_family[3][3] = {{0.20, 0.33, 0.56}, {0.93, 0.91, 0.87}, {0.30, 0.30, 0.30}};
    yc_curve_desc desc = yc_curve_desc_default();
    ex_image *image = NULL;
    double low = HUGE_VAL;
    yc_yarns yarns;
    drawing d;
    int i, k;
    memset(&d, 0, sizeof d);
    desc.steps = 8, desc.offset = view->fuller;
    snprintf(message, YC_MESSAGE_SIZE, "cloth %d has no yarns", cloth);
    if (yc_scene_network(scene, cloth, &yarns) == YC_OK &&
        drawing_make(&d, scene, cloth, &yarns, &desc, message) == YC_OK) {
        ex_thread thread;
        ex_look look;
        ex_scene *picture;
        for (i = 0; i < d.curves.point_count; i++) {
            for (k = 0; k < 3; k++) d.points[i][k] = (double)d.curves.points[i][k];
            if (view->z_up)
                d.points[i][1] = (double)d.curves.points[i][2], d.points[i][2] = -(double)d.curves.points[i][1];
            low = fmin(low, d.points[i][1]);
        }
        for (i = 0; i < d.curves.curve_count; i++) {
            int yarn = d.curves.yarn[i];
            memcpy(d.colors[i], colors ? colors[yarn] : by_family[yarns.yarn_family[yarn]], sizeof d.colors[i]);
            d.radii[i] = view->fuller * (double)d.curves.radius[i];
        }
        if (!keep) *camera = camera_for(view, d.points, d.curves.point_count);
        ex_look_default(&look);
        look.ao_radius = 4.0 * d.radii[0], look.ao_strength = 1.6, look.samples = 3;
        look.ground = view->ground, look.ground_y = low - d.radii[0];
        ex_thread_cotton(&thread);
        picture = ex_render_begin(view->width, view->height, camera, &look);
        ex_render_tubes(picture, (const double(*)[3])d.points, d.curves.first, d.curves.curve_count, d.radii,
            (const double(*)[3])d.colors, &thread);
        if (view->ball) draw_ball(picture, view->ball);
        image = ex_render_finish(picture);
        if (!image) snprintf(message, YC_MESSAGE_SIZE, "no memory for a picture of the yarns");
    }
    drawing_free(&d);
    return image;
}
