#include "ex_lines.h"
#include "ex_render.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double field = 12.0; /* degrees, vertical */

ex_lines *ex_lines_new(int width, int height, double x, double y, double wide) {
    ex_lines *p = calloc(1, sizeof *p);
    if (p) p->width = width, p->height = height, p->at[0] = x, p->at[1] = y, p->wide = wide;
    return p;
}

void ex_lines_add(ex_lines *p, double (*points)[3], int count, double radius, const double *color, const char *label) {
    int line = p->count;
    if (line == EX_LINES_COUNT || p->first[line] + count > EX_LINES_POINTS) return;
    memcpy(p->points + p->first[line], points, (size_t)count * sizeof *points);
    p->first[line + 1] = p->first[line] + count, p->radii[line] = color ? radius : 0.0, p->count++;
    if (color) memcpy(p->colors[line], color, sizeof p->colors[line]);
    snprintf(p->labels[line], EX_LINES_LABEL, "%s", label);
}

static double eye_of(const ex_lines *p) {
    return 0.5 * p->wide * p->height / p->width / tan(field * 3.14159265358979 / 360.0);
}

static void pixel(const ex_lines *p, const double x[3], double out[2]) {
    double scale = p->width / p->wide / (1.0 - x[2] / eye_of(p));
    out[0] = 0.5 * p->width + scale * (x[0] - p->at[0]), out[1] = 0.5 * p->height - scale * (x[1] - p->at[1]);
}

static void write_label(ex_image *image, const char *label, const double at[2]) {
    if (label[0] == '\n')
        ex_image_text(
            image, (int)at[0] - ex_image_text_width(2, label + 1) / 2, (int)at[1] + 18, 2, 0x404448, label + 1);
    else ex_image_text(image, (int)at[0] + 14, (int)at[1] - 6, 2, 0x404448, label);
}

ex_image *ex_lines_draw(const ex_lines *p, const char *title) {
    static const double top[3] = {0.975, 0.975, 0.97}, bottom[3] = {0.90, 0.905, 0.91};
    ex_camera camera;
    ex_thread smooth;
    ex_scene *scene;
    ex_image *image;
    ex_look look;
    double a[2], b[2];
    int line, i;
    memset(&camera, 0, sizeof camera), memset(&smooth, 0, sizeof smooth);
    memcpy(camera.target, p->at, sizeof p->at), memcpy(camera.eye, p->at, sizeof p->at);
    camera.eye[2] = eye_of(p), camera.up[1] = 1.0, camera.fov = field;
    ex_look_default(&look);
    memcpy(look.background_top, top, sizeof top), memcpy(look.background_bottom, bottom, sizeof bottom);
    look.samples = 3, look.ao_radius = 0.01 * p->wide, smooth.sheen = 0.2;
    look.key[2] = 1.2; /* more from in front */
    scene = ex_render_begin(p->width, p->height, &camera, &look);
    for (line = 0; line < p->count; line++) {
        int first[2] = {0, 0};
        first[1] = p->first[line + 1] - p->first[line];
        if (p->radii[line] > 0.0)
            ex_render_tubes(scene, p->points + p->first[line], first, 1, p->radii + line, p->colors + line, &smooth);
    }
    image = ex_render_finish(scene);
    for (line = 0; image && line < p->count; line++) {
        for (i = p->first[line] + 1; p->radii[line] == 0.0 && i < p->first[line + 1]; i++) {
            pixel(p, p->points[i - 1], a), pixel(p, p->points[i], b);
            ex_image_line(image, a[0], a[1], b[0], b[1], 1.8, 0x202428);
        }
        pixel(p, p->points[p->first[line + 1] - 1], a), write_label(image, p->labels[line], a);
    }
    if (image) ex_image_text(image, 24, p->height - 36, 2, 0x404448, title);
    return image;
}
