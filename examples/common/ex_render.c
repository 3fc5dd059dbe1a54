#include "ex_render.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Scene ------------------------------------------------------------------------------------------------------- */

typedef struct corner {
    float position[3], normal[3], color[3]; /* colour linear */
    float wire[3];                          /* distances to the edges of the triangle that the caller gave, m */
} corner;

typedef struct knot {
    float position[3], tangent[3], side[3]; /* `side` is carried along without turning */
    float along;
} knot;

typedef struct segment {
    int knot, thread, seed;
    float radius, color[3];
} segment;

typedef struct array {
    void *data;
    int count, room;
} array;

/* One sample of the picture.  Drawing only finds what is nearest; what it looks like there is worked out afterwards,
 * once for each sample. */
typedef struct sample {
    float depth;     /* along the view direction, 0 where there is nothing */
    int item;        /* a triangle's number, or minus one minus a segment's, or NOTHING */
    float normal[3]; /* camera frame */
    float color[3];
    float sheen, gloss;
} sample;

struct ex_scene {
    int width, height, failed;
    ex_camera camera;
    ex_look look;
    double axes[3][3]; /* right, up, forward */
    double focal;      /* in samples */
    int sw, sh;        /* size in samples */
    array corners, materials, triangle_materials, knots, segments, threads;
    sample *samples;
    /* The key light's view: an orthographic depth map. */
    double light[3][3]; /* right, up, away from the light */
    double shadow_low[2], shadow_texel;
    int shadow_size;
    float *shadow;
    float *occlusion; /* one value per pixel */
    float *pixel_depth;
    double spiral[24][2];    /* unit vectors, each turned by the golden angle from the one before */
    double background[2][3]; /* linear, top and bottom */
};

enum { SHADOW_SIZE = 2048, NOTHING = 0x7fffffff };

static double dot3(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross3(double out[3], const double a[3], const double b[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static double normalize3(double a[3]) {
    double size = sqrt(dot3(a, a));
    int k;
    for (k = 0; k < 3; k++) a[k] = size > 1e-30 ? a[k] / size : k == 2;
    return size;
}

static double clamp(double x, double low, double high) { return x < low ? low : x > high ? high : x; }

static double smooth_step(double low, double high, double x) {
    double t = clamp((x - low) / (high - low), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

static double linear_of_srgb(double c) { return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4); }

static double srgb_of_linear(double c) { return c <= 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1.0 / 2.4) - 0.055; }

/* A new element at the end, or NULL and the scene marked as failed. */
static void *append(ex_scene *scene, array *a, size_t size, int count) {
    if (a->count + count > a->room) {
        int room = a->room ? a->room : 256;
        void *larger;
        while (room < a->count + count) room *= 2;
        larger = realloc(a->data, (size_t)room * size);
        if (!larger) {
            scene->failed = 1;
            return NULL;
        }
        a->data = larger;
        a->room = room;
    }
    a->count += count;
    return (char *)a->data + (size_t)(a->count - count) * size;
}

void ex_look_default(ex_look *look) {
    static const double key[3] = {-0.85, 0.80, 0.48}, top[3] = {0.93, 0.935, 0.94}, bottom[3] = {0.80, 0.805, 0.815};
    memset(look, 0, sizeof *look);
    memcpy(look->key, key, sizeof key);
    memcpy(look->background_top, top, sizeof top);
    memcpy(look->background_bottom, bottom, sizeof bottom);
    look->softness = 0.10;
    look->exposure = 1.0;
    look->ao_radius = 0.08;
    look->ao_strength = 1.0;
    look->samples = 2;
}

void ex_look_follow(ex_look *look, const ex_camera *camera) {
    double x = camera->eye[0] - camera->target[0], z = camera->eye[2] - camera->target[2], size = sqrt(x * x + z * z);
    double old[3];
    if (size < 1e-9) return;
    memcpy(old, look->key, sizeof old);
    look->key[0] = (old[0] * z + old[2] * x) / size;
    look->key[2] = (old[2] * z - old[0] * x) / size;
}

void ex_material_cloth(ex_material *material, double red, double green, double blue) {
    int k;
    memset(material, 0, sizeof *material);
    material->front[0] = red;
    material->front[1] = green;
    material->front[2] = blue;
    for (k = 0; k < 3; k++) material->back[k] = 0.78 * material->front[k];
    material->sheen = 0.25;
    material->round = 3;
}

void ex_material_body(ex_material *material) {
    ex_material_cloth(material, 0.60, 0.565, 0.535);
    material->sheen = 0.0;
    material->gloss = 0.25;
    material->round = 0;
}

void ex_thread_cotton(ex_thread *thread) {
    thread->plies = 3;
    thread->pitch = 5.0;
    thread->groove = 0.38;
    thread->fibre = 0.7;
    thread->sheen = 0.3;
}

void ex_heat_color(double value, double color[3]) {
    static const double stops[5][3] = {
        {0.16, 0.32, 0.62}, {0.45, 0.64, 0.80}, {0.90, 0.89, 0.86}, {0.90, 0.58, 0.40}, {0.68, 0.14, 0.17}};
    double t = 4.0 * clamp(value, 0.0, 1.0);
    int i = t >= 3.0 ? 3 : (int)t, k;
    for (k = 0; k < 3; k++) color[k] = stops[i][k] + (t - i) * (stops[i + 1][k] - stops[i][k]);
}

ex_scene *ex_render_begin(int width, int height, const ex_camera *camera, const ex_look *look) {
    ex_scene *scene = (ex_scene *)calloc(1, sizeof *scene);
    double up[3], key[3];
    int k;
    if (!scene) return NULL;
    scene->width = width;
    scene->height = height;
    scene->camera = *camera;
    if (look) scene->look = *look;
    else ex_look_default(&scene->look);
    scene->look.samples = scene->look.samples < 1 ? 1 : scene->look.samples;
    scene->sw = width * scene->look.samples;
    scene->sh = height * scene->look.samples;
    scene->focal = 0.5 * scene->sh / tan(camera->fov * 3.14159265358979 / 360.0);
    for (k = 0; k < 3; k++) scene->axes[2][k] = camera->target[k] - camera->eye[k];
    normalize3(scene->axes[2]);
    cross3(scene->axes[0], scene->axes[2], camera->up);
    normalize3(scene->axes[0]);
    cross3(scene->axes[1], scene->axes[0], scene->axes[2]);
    for (k = 0; k < 24; k++) {
        scene->spiral[k][0] = cos(2.399963 * k);
        scene->spiral[k][1] = sin(2.399963 * k);
    }
    for (k = 0; k < 3; k++) {
        scene->background[0][k] = linear_of_srgb(scene->look.background_top[k]);
        scene->background[1][k] = linear_of_srgb(scene->look.background_bottom[k]);
    }
    memcpy(key, scene->look.key, sizeof key);
    normalize3(key);
    memcpy(scene->look.key, key, sizeof key);
    for (k = 0; k < 3; k++) {
        scene->light[2][k] = -key[k];
        up[k] = k == (fabs(key[1]) < 0.9 ? 1 : 0);
    }
    cross3(scene->light[0], scene->light[2], up);
    normalize3(scene->light[0]);
    cross3(scene->light[1], scene->light[0], scene->light[2]);
    return scene;
}

/* Area-weighted vertex normals. */
static double (
    *make_normals(const double (*positions)[3], int vertex_count, const int (*triangles)[3], int triangle_count))[3] {
    double(*normals)[3] = (double(*)[3])calloc((size_t)vertex_count + 1, sizeof *normals);
    int t, i, k;
    if (!normals) return NULL;
    for (t = 0; t < triangle_count; t++) {
        double e[3], f[3], n[3];
        for (k = 0; k < 3; k++) {
            e[k] = positions[triangles[t][1]][k] - positions[triangles[t][0]][k];
            f[k] = positions[triangles[t][2]][k] - positions[triangles[t][0]][k];
        }
        cross3(n, e, f);
        for (i = 0; i < 3; i++)
            for (k = 0; k < 3; k++) normals[triangles[t][i]][k] += n[k];
    }
    for (i = 0; i < vertex_count; i++) normalize3(normals[i]);
    return normals;
}

/* A curved point triangle: cubic in position so that it meets the corner normals (Vlachos, Peters, Boyd and Mitchell
 * 2001, "Curved PN triangles"), linear in normal. */
static void curved_point(const double p[3][3], const double n[3][3], const double w[3], double out[3]) {
    double control[3][3][3], middle[3], mean[3];
    int i, j, k;
    for (k = 0; k < 3; k++) {
        mean[k] = (p[0][k] + p[1][k] + p[2][k]) / 3.0;
        middle[k] = 0.0;
    }
    for (i = 0; i < 3; i++)
        for (j = 0; j < 3; j++) {
            double edge[3], rise;
            for (k = 0; k < 3; k++) edge[k] = p[j][k] - p[i][k];
            rise = dot3(edge, n[i]);
            for (k = 0; k < 3; k++) {
                control[i][j][k] = p[i][k] + (edge[k] - rise * n[i][k]) / 3.0;
                if (i != j) middle[k] += control[i][j][k] / 6.0;
            }
        }
    for (k = 0; k < 3; k++) {
        double sum = (middle[k] + 0.5 * (middle[k] - mean[k])) * 6.0 * w[0] * w[1] * w[2];
        for (i = 0; i < 3; i++) {
            sum += p[i][k] * w[i] * w[i] * w[i];
            for (j = 0; j < 3; j++)
                if (i != j) sum += 3.0 * control[i][j][k] * w[i] * w[i] * w[j];
        }
        out[k] = sum;
    }
}

static void make_corner(corner *c, const double p[3][3], const double n[3][3], const double color[3][3],
    const double height[3], const double w[3], int curved) {
    double q[3], m[3];
    int i, k;
    for (k = 0; k < 3; k++) {
        q[k] = w[0] * p[0][k] + w[1] * p[1][k] + w[2] * p[2][k];
        m[k] = w[0] * n[0][k] + w[1] * n[1][k] + w[2] * n[2][k];
        c->color[k] = (float)(w[0] * color[0][k] + w[1] * color[1][k] + w[2] * color[2][k]);
    }
    if (curved) curved_point(p, n, w, q);
    normalize3(m);
    for (i = 0; i < 3; i++) {
        c->position[i] = (float)q[i];
        c->normal[i] = (float)m[i];
        c->wire[i] = (float)(w[i] * height[i]);
    }
}

static void add_triangle(
    ex_scene *scene, const double p[3][3], const double n[3][3], const double color[3][3], int rounds, int material) {
    double height[3], area[3], e[3], f[3];
    int i, j, k, flip, step;
    for (k = 0; k < 3; k++) {
        e[k] = p[1][k] - p[0][k];
        f[k] = p[2][k] - p[0][k];
    }
    cross3(area, e, f);
    for (i = 0; i < 3; i++) {
        double side[3];
        for (k = 0; k < 3; k++) side[k] = p[(i + 2) % 3][k] - p[(i + 1) % 3][k];
        height[i] = sqrt(dot3(area, area) / (dot3(side, side) + 1e-30));
    }
    for (i = 0; i < rounds; i++)
        for (j = 0; j < rounds - i; j++)
            for (flip = 0; flip < (j + 1 < rounds - i ? 2 : 1); flip++) {
                static const int offset[2][3][2] = {{{0, 0}, {1, 0}, {0, 1}}, {{1, 0}, {1, 1}, {0, 1}}};
                corner *c = (corner *)append(scene, &scene->corners, sizeof(corner), 3);
                int *m = (int *)append(scene, &scene->triangle_materials, sizeof(int), 1);
                if (!c || !m) return;
                *m = material;
                for (step = 0; step < 3; step++) {
                    double w[3];
                    w[1] = (double)(i + offset[flip][step][0]) / rounds;
                    w[2] = (double)(j + offset[flip][step][1]) / rounds;
                    w[0] = 1.0 - w[1] - w[2];
                    make_corner(c + step, p, n, color, height, w, rounds > 1);
                }
            }
}

void ex_render_mesh(ex_scene *scene, const double (*positions)[3], int vertex_count, const int (*triangles)[3],
    int triangle_count, const double (*normals)[3], const double (*colors)[3], const ex_material *material) {
    double(*own)[3] = NULL;
    ex_material *m;
    int t, i, k;
    if (!scene || scene->failed) return;
    m = (ex_material *)append(scene, &scene->materials, sizeof *m, 1);
    if (!normals) own = make_normals(positions, vertex_count, triangles, triangle_count);
    if (!m || (!normals && !own)) {
        scene->failed = 1;
        free(own);
        return;
    }
    *m = *material;
    for (k = 0; k < 3; k++) {
        m->front[k] = linear_of_srgb(material->front[k]);
        m->back[k] = linear_of_srgb(material->back[k]);
    }
    for (t = 0; t < triangle_count; t++) {
        double p[3][3], n[3][3], color[3][3];
        for (i = 0; i < 3; i++) {
            int v = triangles[t][i];
            memcpy(p[i], positions[v], sizeof p[i]);
            memcpy(n[i], normals ? normals[v] : own[v], sizeof n[i]);
            for (k = 0; k < 3; k++) color[i][k] = colors ? linear_of_srgb(colors[v][k]) : -1.0;
        }
        add_triangle(scene, (const double(*)[3])p, (const double(*)[3])n, (const double(*)[3])color,
            material->round > 1 ? material->round : 1, scene->materials.count - 1);
    }
    free(own);
}

/* Frames along a line: tangents from neighbours, a side vector carried from point to point by projection. */
static void make_knots(knot *out, const double (*points)[3], int count) {
    double side[3] = {0.0, 0.0, 0.0}, along = 0.0;
    int i, k;
    for (i = 0; i < count; i++) {
        double tangent[3], away;
        int before = i > 0 ? i - 1 : 0, after = i + 1 < count ? i + 1 : i;
        for (k = 0; k < 3; k++) tangent[k] = points[after][k] - points[before][k];
        normalize3(tangent);
        if (i == 0) side[fabs(tangent[1]) < 0.9 ? 1 : 0] = 1.0;
        away = dot3(side, tangent);
        for (k = 0; k < 3; k++) side[k] -= away * tangent[k];
        normalize3(side);
        if (i > 0) {
            double step[3];
            for (k = 0; k < 3; k++) step[k] = points[i][k] - points[i - 1][k];
            along += sqrt(dot3(step, step));
        }
        for (k = 0; k < 3; k++) {
            out[i].position[k] = (float)points[i][k];
            out[i].tangent[k] = (float)tangent[k];
            out[i].side[k] = (float)side[k];
        }
        out[i].along = (float)along;
    }
}

void ex_render_tubes(ex_scene *scene, const double (*points)[3], const int *first, int line_count, const double *radii,
    const double (*colors)[3], const ex_thread *thread) {
    ex_thread *own;
    int line, i, k;
    if (!scene || scene->failed) return;
    own = (ex_thread *)append(scene, &scene->threads, sizeof *own, 1);
    if (!own) return;
    *own = *thread;
    for (line = 0; line < line_count; line++) {
        int count = first[line + 1] - first[line], base = scene->knots.count;
        knot *knots = (knot *)append(scene, &scene->knots, sizeof *knots, count);
        segment *segments = (segment *)append(scene, &scene->segments, sizeof *segments, count > 1 ? count - 1 : 0);
        if (!knots || !segments) return;
        make_knots(knots, points + first[line], count);
        for (i = 0; i + 1 < count; i++) {
            segments[i].knot = base + i;
            segments[i].thread = scene->threads.count - 1;
            segments[i].seed = 97 * (line + 1);
            segments[i].radius = (float)radii[line];
            for (k = 0; k < 3; k++) segments[i].color[k] = (float)linear_of_srgb(colors[line][k]);
        }
    }
}

/* ---- Filling the samples ----------------------------------------------------------------------------------------- */

static void to_frame(const double axes[3][3], const double origin[3], const float p[3], double out[3]) {
    double q[3];
    int k;
    for (k = 0; k < 3; k++) q[k] = (double)p[k] - origin[k];
    for (k = 0; k < 3; k++) out[k] = dot3(axes[k], q);
}

static void turn_to_frame(const double axes[3][3], const float v[3], double out[3]) {
    static const double zero[3] = {0.0, 0.0, 0.0};
    to_frame(axes, zero, v, out);
}

/* A triangle on screen: corners in the camera frame and in samples. */
typedef struct screen_triangle {
    double view[3][3], x[3], y[3], area;
} screen_triangle;

static int project_triangle(const ex_scene *scene, const corner *c, screen_triangle *t) {
    int i;
    for (i = 0; i < 3; i++) {
        to_frame((const double(*)[3])scene->axes, scene->camera.eye, c[i].position, t->view[i]);
        if (t->view[i][2] < 1e-4) return 0;
        t->x[i] = 0.5 * scene->sw + scene->focal * t->view[i][0] / t->view[i][2];
        t->y[i] = 0.5 * scene->sh - scene->focal * t->view[i][1] / t->view[i][2];
    }
    t->area = (t->x[1] - t->x[0]) * (t->y[2] - t->y[0]) - (t->x[2] - t->x[0]) * (t->y[1] - t->y[0]);
    return fabs(t->area) > 1e-12;
}

/* Weights of the corners at a sample, right in perspective; returns the depth, or 0 outside. */
static double triangle_weights(const screen_triangle *t, double x, double y, double w[3]) {
    double depth;
    int i;
    w[0] = ((t->x[1] - x) * (t->y[2] - y) - (t->x[2] - x) * (t->y[1] - y)) / t->area;
    w[1] = ((t->x[2] - x) * (t->y[0] - y) - (t->x[0] - x) * (t->y[2] - y)) / t->area;
    w[2] = 1.0 - w[0] - w[1];
    if (w[0] < 0.0 || w[1] < 0.0 || w[2] < 0.0) return 0.0;
    for (i = 0; i < 3; i++) w[i] /= t->view[i][2];
    depth = 1.0 / (w[0] + w[1] + w[2]);
    for (i = 0; i < 3; i++) w[i] *= depth;
    return depth;
}

static void sample_ray(const ex_scene *scene, int x, int y, double ray[3]) {
    ray[0] = (x + 0.5 - 0.5 * scene->sw) / scene->focal;
    ray[1] = (0.5 * scene->sh - y - 0.5) / scene->focal;
    ray[2] = 1.0;
}

static void resolve_triangle(const ex_scene *scene, sample *s, int x, int y) {
    const corner *c = (const corner *)scene->corners.data + 3 * s->item;
    const ex_material *m =
        (const ex_material *)scene->materials.data + ((const int *)scene->triangle_materials.data)[s->item];
    double n[3] = {0.0, 0.0, 0.0}, w[3], facing[3], e[3], f[3], ray[3], turned[3], wire = 1e9;
    screen_triangle t;
    int back, i, k;
    project_triangle(scene, c, &t);
    triangle_weights(&t, x + 0.5, y + 0.5, w);
    sample_ray(scene, x, y, ray);
    for (k = 0; k < 3; k++) {
        e[k] = t.view[1][k] - t.view[0][k];
        f[k] = t.view[2][k] - t.view[0][k];
    }
    for (i = 0; i < 3; i++) {
        turn_to_frame((const double(*)[3])scene->axes, c[i].normal, turned);
        for (k = 0; k < 3; k++) n[k] += w[i] * turned[k];
    }
    cross3(facing, e, f);
    back = dot3(facing, ray) < 0.0; /* right, up, forward is a left-handed frame */
    normalize3(n);
    for (k = 0; k < 3; k++) {
        double color = w[0] * (double)c[0].color[k] + w[1] * (double)c[1].color[k] + w[2] * (double)c[2].color[k];
        if (color < 0.0) color = back ? m->back[k] : m->front[k];
        else if (back) color *= 0.7;
        s->color[k] = (float)color;
        s->normal[k] = (float)(back ? -n[k] : n[k]);
        wire = fmin(wire, w[0] * (double)c[0].wire[k] + w[1] * (double)c[1].wire[k] + w[2] * (double)c[2].wire[k]);
    }
    for (k = 0; k < 3 && wire < 0.5 * m->wire; k++) s->color[k] *= 0.35f;
    s->sheen = (float)m->sheen;
    s->gloss = (float)m->gloss;
}

static void draw_triangle(ex_scene *scene, int item) {
    screen_triangle t;
    int x, y, left, right, top, bottom;
    if (!project_triangle(scene, (const corner *)scene->corners.data + 3 * item, &t)) return;
    left = (int)clamp(floor(fmin(t.x[0], fmin(t.x[1], t.x[2])) - 0.5), 0.0, scene->sw);
    right = (int)clamp(ceil(fmax(t.x[0], fmax(t.x[1], t.x[2])) + 0.5), 0.0, scene->sw);
    top = (int)clamp(floor(fmin(t.y[0], fmin(t.y[1], t.y[2])) - 0.5), 0.0, scene->sh);
    bottom = (int)clamp(ceil(fmax(t.y[0], fmax(t.y[1], t.y[2])) + 0.5), 0.0, scene->sh);
    for (y = top; y < bottom; y++)
        for (x = left; x < right; x++) {
            sample *s = scene->samples + (size_t)y * (size_t)scene->sw + (size_t)x;
            double w[3], depth = triangle_weights(&t, x + 0.5, y + 0.5, w);
            if (depth > 0.0 && depth < (double)s->depth) {
                s->depth = (float)depth;
                s->item = item;
            }
        }
}

/* A hash of lattice points with smooth steps between them, -1..1. */
static double noise1(double x, unsigned seed) {
    double cell = floor(x), t = x - cell, value[2];
    int i;
    for (i = 0; i < 2; i++) {
        unsigned h = (unsigned)((int)cell + i) * 2654435761u ^ seed * 2246822519u;
        h ^= h >> 15;
        h *= 2246822519u;
        h ^= h >> 13;
        value[i] = (double)(h & 65535u) / 32767.5 - 1.0;
    }
    t = t * t * (3.0 - 2.0 * t);
    return value[0] + t * (value[1] - value[0]);
}

/* A segment in the camera frame, with what the rays need. */
typedef struct tube {
    double a[3], b[3], axis[3], length2, radius, aa, a_axis;
} tube;

static int place_tube(const ex_scene *scene, const segment *seg, tube *t) {
    const knot *ends = (const knot *)scene->knots.data + seg->knot;
    int k;
    t->radius = (double)seg->radius;
    to_frame((const double(*)[3])scene->axes, scene->camera.eye, ends[0].position, t->a);
    to_frame((const double(*)[3])scene->axes, scene->camera.eye, ends[1].position, t->b);
    for (k = 0; k < 3; k++) t->axis[k] = t->b[k] - t->a[k];
    t->length2 = dot3(t->axis, t->axis) + 1e-30;
    t->aa = dot3(t->a, t->a) - t->radius * t->radius;
    t->a_axis = dot3(t->a, t->axis);
    return t->a[2] > 2.0 * t->radius && t->b[2] > 2.0 * t->radius;
}

/* Nearest hit of the ray through the eye with the capsule, 0 when it misses. */
static double hit_capsule(const tube *t, const double ray[3]) {
    double rr = dot3(ray, ray), r_axis = dot3(ray, t->axis), ra = dot3(ray, t->a);
    double a = t->length2 * rr - r_axis * r_axis, b = t->a_axis * r_axis - t->length2 * ra;
    double c = t->length2 * t->aa - t->a_axis * t->a_axis, h = b * b - a * c, along = 0.0;
    const double *end;
    if (h < 0.0) return 0.0;
    if (a > 1e-12 * t->length2 * rr) {
        double depth = (-b - sqrt(h)) / a;
        along = depth * r_axis - t->a_axis;
        if (along >= 0.0 && along <= t->length2) return depth;
    }
    end = along <= 0.0 ? t->a : t->b;
    b = dot3(end, ray);
    h = b * b - rr * (dot3(end, end) - t->radius * t->radius);
    return h < 0.0 ? 0.0 : (b - sqrt(h)) / rr;
}

/* Where along the bent yarn a hit lies: the place whose cross-section, perpendicular to the tangent that turns from
 * knot to knot, goes through the hit.  Neighbouring segments agree, so nothing jumps from one to the next. */
static double tube_place(const tube *t, const double tangent[2][3], const double hit[3]) {
    double before = 0.0, after = 0.0, u;
    int k;
    for (k = 0; k < 3; k++) {
        before += (hit[k] - t->a[k]) * tangent[0][k];
        after += (t->b[k] - hit[k]) * tangent[1][k];
    }
    u = before + after;
    return fabs(u) > 1e-12 ? clamp(before / u, 0.0, 1.0) : 0.5;
}

/* The plies of a thread are shaded, not modelled: around the yarn and along it runs a phase whose whole numbers are the
 * grooves, and the normal leans away from the middle of each ply. */
static double ply_shading(
    const ex_thread *thread, double angle, double position, double detail, int seed, double lean[2]) {
    double n = thread->plies, phase = n * (angle - position / thread->pitch), w, around, forward, turn, streak, dark;
    w = 2.0 * (phase - floor(phase) - 0.5);
    around = n / 6.283185307179586;
    forward = -n / thread->pitch;
    turn = sqrt(around * around + forward * forward);
    dark = 1.0 - 0.9 * detail * thread->groove * smooth_step(0.45, 1.0, fabs(w));
    /* Single fibres run along the plies, so their streaks change fast across a ply and slowly along it. */
    streak = 0.50 * noise1(5.0 * w + 40.0 * floor(phase) + 0.30 * position, (unsigned)seed) +
        0.35 * noise1(11.0 * w - 0.5 * position, (unsigned)seed + 7u) +
        0.30 * noise1(1.7 * position, (unsigned)seed + 3u) * noise1(3.0 * w, (unsigned)seed + 5u);
    dark *= 1.0 + 0.5 * detail * thread->fibre * streak;
    turn = detail * (1.6 * thread->groove * w * fabs(w) + 0.3 * thread->fibre * streak) / turn;
    lean[0] = around * turn;
    lean[1] = forward * turn;
    return dark;
}

static void resolve_tube(const ex_scene *scene, sample *s, int x, int y) {
    const segment *seg = (const segment *)scene->segments.data + (-1 - s->item);
    const knot *ends = (const knot *)scene->knots.data + seg->knot;
    const ex_thread *thread = (const ex_thread *)scene->threads.data + seg->thread;
    double ray[3], hit[3], tangent[2][3], side[2][3], q[3], along, other[3], away, dark = 1.0, detail;
    tube t;
    int e, k;
    place_tube(scene, seg, &t);
    sample_ray(scene, x, y, ray);
    for (e = 0; e < 2; e++) {
        turn_to_frame((const double(*)[3])scene->axes, ends[e].tangent, tangent[e]);
        turn_to_frame((const double(*)[3])scene->axes, ends[e].side, side[e]);
    }
    for (k = 0; k < 3; k++) hit[k] = (double)s->depth * ray[k];
    along = tube_place(&t, (const double(*)[3])tangent, hit);
    for (k = 0; k < 3; k++) {
        q[k] = hit[k] - t.a[k] - along * t.axis[k];
        tangent[0][k] += along * (tangent[1][k] - tangent[0][k]);
        side[0][k] += along * (side[1][k] - side[0][k]);
    }
    normalize3(tangent[0]);
    away = dot3(q, tangent[0]);
    for (k = 0; k < 3; k++) q[k] -= away * tangent[0][k];
    normalize3(q);
    cross3(other, tangent[0], side[0]);
    detail = smooth_step(3.0, 9.0, t.radius * scene->focal / (double)s->depth);
    if (thread->plies > 0 && detail > 0.0) {
        double angle = atan2(dot3(q, other), dot3(q, side[0])) / 6.283185307179586, slope[3], lean[2];
        double position = ((double)ends[0].along + along * (double)(ends[1].along - ends[0].along)) / t.radius;
        dark = ply_shading(thread, angle, position, detail, seg->seed, lean);
        cross3(slope, tangent[0], q);
        for (k = 0; k < 3; k++) q[k] += lean[0] * slope[k] + lean[1] * tangent[0][k];
        normalize3(q);
    }
    for (k = 0; k < 3; k++) {
        s->normal[k] = (float)q[k];
        s->color[k] = (float)((double)seg->color[k] * dark);
    }
    s->sheen = (float)thread->sheen;
    s->gloss = 0.0f;
}

/* The part of a segment's bounding box on screen that a sphere needs. */
static void grow_box(const ex_scene *scene, const double p[3], double radius, double box[4]) {
    int axis, sign, end;
    for (axis = 0; axis < 2; axis++)
        for (sign = -1; sign < 2; sign += 2)
            for (end = -1; end < 2; end += 2) {
                double v = scene->focal * (p[axis] + sign * radius) / (p[2] + end * radius);
                v = axis ? 0.5 * scene->sh - v : 0.5 * scene->sw + v;
                box[2 * axis] = fmin(box[2 * axis], v);
                box[2 * axis + 1] = fmax(box[2 * axis + 1], v);
            }
}

static void draw_segment(ex_scene *scene, int number) {
    double box[4] = {1e30, -1e30, 1e30, -1e30}, nearest;
    int x, y, left, right, top, bottom;
    tube t;
    if (!place_tube(scene, (const segment *)scene->segments.data + number, &t)) return;
    grow_box(scene, t.a, t.radius, box);
    grow_box(scene, t.b, t.radius, box);
    left = (int)clamp(floor(box[0]), 0.0, scene->sw);
    right = (int)clamp(ceil(box[1]), 0.0, scene->sw);
    top = (int)clamp(floor(box[2]), 0.0, scene->sh);
    bottom = (int)clamp(ceil(box[3]), 0.0, scene->sh);
    nearest = fmin(t.a[2], t.b[2]) - t.radius;
    for (y = top; y < bottom; y++)
        for (x = left; x < right; x++) {
            sample *s = scene->samples + (size_t)y * (size_t)scene->sw + (size_t)x;
            double ray[3], depth;
            if ((double)s->depth < nearest) continue;
            sample_ray(scene, x, y, ray);
            depth = hit_capsule(&t, ray);
            if (depth > 0.0 && depth < (double)s->depth) {
                s->depth = (float)depth;
                s->item = -1 - number;
            }
        }
}

/* The ground has no colour of its own (-1): it shows the background, darkened by shadows. */
static void resolve_ground(const ex_scene *scene, sample *s, int x, int y) {
    double ray[3], fall, depth;
    int k;
    sample_ray(scene, x, y, ray);
    fall = ray[0] * scene->axes[0][1] + ray[1] * scene->axes[1][1] + scene->axes[2][1];
    depth = fabs(fall) > 1e-9 ? (scene->look.ground_y - scene->camera.eye[1]) / fall : 0.0;
    if (depth <= 0.0 || depth >= (double)s->depth) return;
    s->item = NOTHING;
    s->depth = (float)depth;
    s->color[0] = -1.0f;
    for (k = 0; k < 3; k++) s->normal[k] = (float)scene->axes[k][1];
}

static void draw(ex_scene *scene) {
    size_t i, count = (size_t)scene->sw * (size_t)scene->sh;
    int k, x, y;
    for (i = 0; i < count; i++) {
        scene->samples[i].depth = 1e30f;
        scene->samples[i].item = NOTHING;
    }
    for (k = 0; k < scene->triangle_materials.count; k++) draw_triangle(scene, k);
    for (k = 0; k < scene->segments.count; k++) draw_segment(scene, k);
    for (y = 0; y < scene->sh; y++)
        for (x = 0; x < scene->sw; x++) {
            sample *s = scene->samples + (size_t)y * (size_t)scene->sw + (size_t)x;
            if (scene->look.ground) resolve_ground(scene, s, x, y);
            if (s->item == NOTHING) s->depth = s->depth > 1e29f ? 0.0f : s->depth;
            else if (s->item >= 0) resolve_triangle(scene, s, x, y);
            else resolve_tube(scene, s, x, y);
        }
}

/* ---- Shadow map -------------------------------------------------------------------------------------------------- */

static void light_bounds(ex_scene *scene) {
    static const double zero[3] = {0.0, 0.0, 0.0};
    double low[2] = {1e30, 1e30}, high[2] = {-1e30, -1e30}, size;
    int pass, i, k;
    for (pass = 0; pass < 2; pass++)
        for (i = 0; i < (pass ? scene->knots.count : scene->corners.count); i++) {
            double p[3];
            to_frame((const double(*)[3])scene->light, zero,
                pass ? ((knot *)scene->knots.data)[i].position : ((corner *)scene->corners.data)[i].position, p);
            for (k = 0; k < 2; k++) {
                low[k] = fmin(low[k], p[k]);
                high[k] = fmax(high[k], p[k]);
            }
        }
    size = fmax(fmax(high[0] - low[0], high[1] - low[1]), 1e-6) * 1.02;
    for (k = 0; k < 2; k++) scene->shadow_low[k] = 0.5 * (low[k] + high[k] - size);
    scene->shadow_size = SHADOW_SIZE;
    scene->shadow_texel = size / SHADOW_SIZE;
}

static void shadow_put(ex_scene *scene, int x, int y, double depth) {
    float *s = scene->shadow + (size_t)y * (size_t)scene->shadow_size + (size_t)x;
    if (depth < (double)*s) *s = (float)depth;
}

static int shadow_range(const ex_scene *scene, double low, double high, int *end) {
    *end = (int)clamp(ceil(high + 0.5), 0.0, scene->shadow_size);
    return (int)clamp(floor(low - 0.5), 0.0, scene->shadow_size);
}

static void light_point(const ex_scene *scene, const float position[3], double out[3]) {
    static const double zero[3] = {0.0, 0.0, 0.0};
    to_frame((const double(*)[3])scene->light, zero, position, out);
    out[0] = (out[0] - scene->shadow_low[0]) / scene->shadow_texel;
    out[1] = (out[1] - scene->shadow_low[1]) / scene->shadow_texel;
}

static void shadow_triangle(ex_scene *scene, const corner *c) {
    double p[3][3], area;
    int i, x, y, left, right, top, bottom;
    for (i = 0; i < 3; i++) light_point(scene, c[i].position, p[i]);
    area = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (p[1][1] - p[0][1]);
    if (fabs(area) < 1e-12) return;
    left = shadow_range(scene, fmin(p[0][0], fmin(p[1][0], p[2][0])), fmax(p[0][0], fmax(p[1][0], p[2][0])), &right);
    top = shadow_range(scene, fmin(p[0][1], fmin(p[1][1], p[2][1])), fmax(p[0][1], fmax(p[1][1], p[2][1])), &bottom);
    for (y = top; y < bottom; y++)
        for (x = left; x < right; x++) {
            double px = x + 0.5, py = y + 0.5, w0, w1;
            w0 = ((p[1][0] - px) * (p[2][1] - py) - (p[2][0] - px) * (p[1][1] - py)) / area;
            w1 = ((p[2][0] - px) * (p[0][1] - py) - (p[0][0] - px) * (p[2][1] - py)) / area;
            if (w0 >= 0.0 && w1 >= 0.0 && w0 + w1 <= 1.0)
                shadow_put(scene, x, y, w0 * p[0][2] + w1 * p[1][2] + (1.0 - w0 - w1) * p[2][2]);
        }
}

/* Here the rays are parallel: all start in the plane z = 0 and run along z.  Lengths are in texels. */
static void shadow_segment(ex_scene *scene, const segment *seg) {
    const knot *ends = (const knot *)scene->knots.data + seg->knot;
    double a[3], b[3], axis[3], r = (double)seg->radius / scene->shadow_texel, length2, quadratic;
    int x, y, left, right, top, bottom, k;
    light_point(scene, ends[0].position, a);
    light_point(scene, ends[1].position, b);
    a[2] /= scene->shadow_texel;
    b[2] /= scene->shadow_texel;
    for (k = 0; k < 3; k++) axis[k] = b[k] - a[k];
    length2 = dot3(axis, axis) + 1e-30;
    quadratic = length2 - axis[2] * axis[2];
    left = shadow_range(scene, fmin(a[0], b[0]) - r, fmax(a[0], b[0]) + r, &right);
    top = shadow_range(scene, fmin(a[1], b[1]) - r, fmax(a[1], b[1]) + r, &bottom);
    for (y = top; y < bottom; y++)
        for (x = left; x < right; x++) {
            double qx = x + 0.5 - a[0], qy = y + 0.5 - a[1], across = qx * axis[0] + qy * axis[1], linear, h,
                   along = 0.0, z;
            linear = -across * axis[2];
            h = linear * linear - quadratic * (length2 * (qx * qx + qy * qy - r * r) - across * across);
            if (h < 0.0) continue;
            z = quadratic > 1e-12 * length2 ? (-linear - sqrt(h)) / quadratic : 0.0;
            along = across + z * axis[2];
            if (along < 0.0 || along > length2) {
                qx = x + 0.5 - (along < 0.0 ? a[0] : b[0]);
                qy = y + 0.5 - (along < 0.0 ? a[1] : b[1]);
                h = r * r - qx * qx - qy * qy;
                if (h < 0.0) continue;
                z = (along < 0.0 ? 0.0 : axis[2]) - sqrt(h);
            }
            shadow_put(scene, x, y, (a[2] + z) * scene->shadow_texel);
        }
}

static int draw_shadow_map(ex_scene *scene) {
    size_t i, count;
    int k;
    light_bounds(scene);
    count = (size_t)scene->shadow_size * (size_t)scene->shadow_size;
    scene->shadow = (float *)malloc(count * sizeof *scene->shadow);
    if (!scene->shadow) return 0;
    for (i = 0; i < count; i++) scene->shadow[i] = 1e30f;
    for (k = 0; k < scene->triangle_materials.count; k++) shadow_triangle(scene, (corner *)scene->corners.data + 3 * k);
    for (k = 0; k < scene->segments.count; k++) shadow_segment(scene, (segment *)scene->segments.data + k);
    return 1;
}

/* The depth at distance r from p in the direction `turned` plus `spiral`. */
static double shadow_look(
    const ex_scene *scene, const double p[3], const double turned[2], double r, const double spiral[2]) {
    double x = p[0] + r * (turned[0] * spiral[0] - turned[1] * spiral[1]);
    double y = p[1] + r * (turned[0] * spiral[1] + turned[1] * spiral[0]);
    int i = (int)floor(x), j = (int)floor(y);
    if (i < 0 || j < 0 || i >= scene->shadow_size || j >= scene->shadow_size) return 1e30;
    return (double)scene->shadow[(size_t)j * (size_t)scene->shadow_size + (size_t)i];
}

/* How much of the key light arrives, 0..1.  A first look finds how far the blockers are, which sets how wide the
 * shadow's edge is (percentage-closer soft shadows, Fernando 2005).  `turn` rotates the pattern of looks. */
static double key_light(const ex_scene *scene, const double world[3], const double normal[3], double turn) {
    enum { FIRST = 8, SECOND = 14 };
    double p[3], facing = dot3(normal, scene->look.key), offset, reach, sum = 0.0, seen = 0.0, turned[2];
    int i, k, blockers = 0;
    if (facing < -0.12) return 0.0;
    turned[0] = cos(turn);
    turned[1] = sin(turn);
    offset = scene->shadow_texel * (1.5 + 2.0 * (1.0 - clamp(facing, 0.0, 1.0)));
    for (k = 0; k < 3; k++) p[k] = dot3(scene->light[k], world) + offset * dot3(scene->light[k], normal);
    p[0] = (p[0] - scene->shadow_low[0]) / scene->shadow_texel;
    p[1] = (p[1] - scene->shadow_low[1]) / scene->shadow_texel;
    reach = clamp(0.25 * scene->look.softness * scene->shadow_size, 3.0, 40.0);
    for (i = 0; i < FIRST; i++) {
        double r = reach * sqrt((i + 0.5) / FIRST), d;
        d = p[2] - shadow_look(scene, p, turned, r, scene->spiral[i]);
        /* Only what lies within the cone towards the light can be a blocker: a surface does not shade itself. */
        if (d * scene->look.softness > 0.5 * scene->shadow_texel && d > 0.6 * r * scene->shadow_texel) {
            sum += d;
            blockers++;
        }
    }
    reach = blockers ? clamp(sum / blockers * scene->look.softness / scene->shadow_texel, 1.2, 60.0) : 1.2;
    for (i = 0; i < SECOND; i++) {
        double r = reach * sqrt((i + 0.5) / SECOND);
        seen += p[2] - 0.35 * r * scene->shadow_texel <= shadow_look(scene, p, turned, r, scene->spiral[i]);
    }
    return seen / SECOND;
}

/* ---- Ambient occlusion ------------------------------------------------------------------------------------------- */

static const sample *pixel_sample(const ex_scene *scene, int x, int y) {
    int n = scene->look.samples;
    return scene->samples + (size_t)(y * n + n / 2) * (size_t)scene->sw + (size_t)(x * n + n / 2);
}

static void pixel_point(const ex_scene *scene, int x, int y, double depth, double out[3]) {
    int n = scene->look.samples, column = x * n + n / 2, row = y * n + n / 2;
    out[0] = depth * (column + 0.5 - 0.5 * scene->sw) / scene->focal;
    out[1] = depth * (0.5 * scene->sh - row - 0.5) / scene->focal;
    out[2] = depth;
}

/* Looks at depths on a spiral around the pixel and sums how high the neighbours stand above the tangent plane (after
 * McGuire, Mara and Luebke 2012, "Scalable ambient obscurance"). */
static double pixel_occlusion(const ex_scene *scene, int x, int y) {
    enum { LOOKS = 18 };
    const sample *s = pixel_sample(scene, x, y);
    double p[3], n[3], radius = scene->look.ao_radius, pixels, sum = 0.0, start, turned[2];
    int i, k;
    if (s->depth <= 0.0f) return 1.0;
    pixel_point(scene, x, y, (double)s->depth, p);
    for (k = 0; k < 3; k++) n[k] = (double)s->normal[k];
    pixels = clamp(radius * scene->focal / scene->look.samples / (double)s->depth, 3.0, 180.0);
    start = 6.2831853 * (double)((x * 7 + y * 13 + (x & 3) * (y & 3) * 5) & 15) / 16.0;
    turned[0] = cos(start);
    turned[1] = sin(start);
    for (i = 0; i < LOOKS; i++) {
        double r = pixels * (i + 0.5) / LOOKS, q[3], v2, height, falloff;
        int qx = x + (int)floor(r * (turned[0] * scene->spiral[i][0] - turned[1] * scene->spiral[i][1]) + 0.5);
        int qy = y + (int)floor(r * (turned[0] * scene->spiral[i][1] + turned[1] * scene->spiral[i][0]) + 0.5);
        const sample *other;
        if (qx < 0 || qy < 0 || qx >= scene->width || qy >= scene->height) continue;
        other = pixel_sample(scene, qx, qy);
        if (other->depth <= 0.0f) continue;
        pixel_point(scene, qx, qy, (double)other->depth, q);
        for (k = 0; k < 3; k++) q[k] -= p[k];
        v2 = dot3(q, q);
        height = dot3(q, n) - 0.0015 * (double)s->depth;
        falloff = 1.0 - v2 / (radius * radius);
        if (height > 0.0 && falloff > 0.0) sum += falloff * falloff * height / sqrt(v2 + 1e-12);
    }
    return clamp(1.0 - 2.2 * scene->look.ao_strength * sum / LOOKS, 0.0, 1.0);
}

/* Smooths along rows or columns without mixing what lies at different depths. */
static void blur_occlusion(const ex_scene *scene, const float *from, float *to, int dx, int dy) {
    int x, y, i;
    for (y = 0; y < scene->height; y++)
        for (x = 0; x < scene->width; x++) {
            size_t at = (size_t)y * (size_t)scene->width + (size_t)x;
            double depth = (double)scene->pixel_depth[at], sum = 0.0, weights = 0.0;
            for (i = -3; i <= 3; i++) {
                int qx = x + i * dx, qy = y + i * dy;
                size_t other = (size_t)qy * (size_t)scene->width + (size_t)qx;
                double w;
                if (qx < 0 || qy < 0 || qx >= scene->width || qy >= scene->height) continue;
                w = fmax(0.0, 1.0 - fabs((double)scene->pixel_depth[other] - depth) / (0.15 * scene->look.ao_radius)) /
                    (1.0 + 0.15 * i * i);
                sum += w * (double)from[other];
                weights += w;
            }
            to[at] = (float)(weights > 0.0 ? sum / weights : (double)from[at]);
        }
}

static int find_occlusion(ex_scene *scene) {
    size_t count = (size_t)scene->width * (size_t)scene->height;
    float *raw = (float *)malloc(count * sizeof *raw);
    int x, y;
    scene->occlusion = (float *)malloc(count * sizeof *scene->occlusion);
    scene->pixel_depth = (float *)malloc(count * sizeof *scene->pixel_depth);
    if (!raw || !scene->occlusion || !scene->pixel_depth) {
        free(raw);
        return 0;
    }
    for (y = 0; y < scene->height; y++)
        for (x = 0; x < scene->width; x++) {
            size_t at = (size_t)y * (size_t)scene->width + (size_t)x;
            scene->pixel_depth[at] = pixel_sample(scene, x, y)->depth;
            scene->occlusion[at] = (float)pixel_occlusion(scene, x, y);
        }
    blur_occlusion(scene, scene->occlusion, raw, 1, 0);
    blur_occlusion(scene, raw, scene->occlusion, 0, 1);
    free(raw);
    return 1;
}

/* The occlusion of the pixel, or of a neighbour at the sample's own depth when the pixel shows something else. */
static double occlusion_at(const ex_scene *scene, int x, int y, double depth) {
    double best = 1e30, value = 1.0;
    int dx, dy;
    for (dy = -1; dy <= 1; dy++)
        for (dx = -1; dx <= 1; dx++) {
            int qx = x + dx, qy = y + dy;
            size_t at = (size_t)qy * (size_t)scene->width + (size_t)qx;
            double apart;
            if (qx < 0 || qy < 0 || qx >= scene->width || qy >= scene->height) continue;
            apart = fabs((double)scene->pixel_depth[at] - depth);
            apart += dx || dy ? 0.002 * depth : 0.0;
            if (apart < best) {
                best = apart;
                value = (double)scene->occlusion[at];
            }
        }
    return value;
}

/* ---- Light ------------------------------------------------------------------------------------------------------- */

static void background(const ex_scene *scene, double x, double y, double color[3]) {
    double u = x / scene->sw - 0.5, v = y / scene->sh,
           glow = 1.0 - 0.35 * smooth_step(0.15, 0.95, sqrt(u * u + (v - 0.42) * (v - 0.42)));
    int k;
    for (k = 0; k < 3; k++)
        color[k] =
            (scene->background[0][k] + (scene->background[1][k] - scene->background[0][k]) * smooth_step(0.0, 1.0, v)) *
            glow;
}

static void light_surface(const ex_scene *scene, const sample *s, const double normal[3], const double view[3],
    double key, double occlusion, double color[3]) {
    static const double key_color[3] = {1.62, 1.53, 1.42}, sky[3] = {0.44, 0.48, 0.54}, bounce[3] = {0.20, 0.18, 0.17};
    static const double rim_color[3] = {0.75, 0.82, 0.95};
    const double *to_key = scene->look.key;
    double facing = dot3(normal, to_key), nv = clamp(dot3(normal, view), 0.0, 1.0), graze = 1.0 - nv;
    double half[3], rim[3], diffuse, fill, back, highlight;
    int k;
    diffuse = clamp((facing + 0.12) / 1.12, 0.0, 1.0) * key;
    /* A weak light from the camera's right keeps the shadow side readable; the rim light comes from behind, above. */
    for (k = 0; k < 3; k++) {
        half[k] = to_key[k] + view[k];
        rim[k] = 0.75 * scene->axes[2][k] + 0.55 * scene->axes[1][k] + 0.55 * scene->axes[0][k];
    }
    normalize3(half);
    normalize3(rim);
    fill = clamp(0.5 * dot3(normal, scene->axes[0]) + 0.6 * dot3(normal, view), 0.0, 1.0) * 0.22;
    back = clamp(dot3(normal, rim) + 0.15, 0.0, 1.0) * graze * graze * 0.7;
    highlight =
        s->gloss > 0.0f && facing > 0.0 ? (double)s->gloss * pow(clamp(dot3(normal, half), 0.0, 1.0), 28.0) * key : 0.0;
    for (k = 0; k < 3; k++) {
        double up = 0.5 + 0.5 * normal[1], albedo = (double)s->color[k];
        /* Light that bounces between close bright surfaces keeps their hollows from turning grey. */
        double open = occlusion + (1.0 - occlusion) * occlusion * 0.7 * albedo;
        double ambient = (bounce[k] + (sky[k] - bounce[k]) * up + fill) * open;
        double velvet = (double)s->sheen * graze * graze * graze * (0.5 * key_color[k] * diffuse + 0.7 * ambient);
        color[k] = albedo * (key_color[k] * diffuse * (0.45 + 0.55 * open) + ambient) * 0.62 +
            velvet * (0.3 + 0.7 * albedo) + back * rim_color[k] * open * (0.25 + 0.75 * albedo) +
            highlight * key_color[k] * 0.25;
        color[k] *= scene->look.exposure;
    }
}

static void light_sample(const ex_scene *scene, int x, int y, double color[3]) {
    const sample *s = scene->samples + (size_t)y * (size_t)scene->sw + (size_t)x;
    double ray[3], world[3], normal[3], view[3], key, occlusion, turn;
    unsigned hash = ((unsigned)x * 73856093u ^ (unsigned)y * 19349663u) * 2654435761u;
    int i, k, n = scene->look.samples;
    background(scene, x + 0.5, y + 0.5, color);
    if (s->depth <= 0.0f) return;
    ray[0] = (x + 0.5 - 0.5 * scene->sw) / scene->focal;
    ray[1] = (0.5 * scene->sh - y - 0.5) / scene->focal;
    ray[2] = 1.0;
    for (k = 0; k < 3; k++) {
        world[k] = scene->camera.eye[k];
        normal[k] = view[k] = 0.0;
        for (i = 0; i < 3; i++) {
            world[k] += scene->axes[i][k] * ray[i] * (double)s->depth;
            normal[k] += scene->axes[i][k] * (double)s->normal[i];
            view[k] -= scene->axes[i][k] * ray[i];
        }
    }
    normalize3(view);
    turn = (double)(hash >> 16 & 1023u) / 1024.0 * 6.2831853;
    key = key_light(scene, world, normal, turn);
    occlusion = occlusion_at(scene, x / n, y / n, (double)s->depth);
    if (s->color[0] < 0.0f) {
        double shade = (0.45 + 0.55 * key) * (0.35 + 0.65 * occlusion);
        for (k = 0; k < 3; k++) color[k] *= shade + 0.03 * (1.0 - shade) * k;
        return;
    }
    light_surface(scene, s, normal, view, key, occlusion, color);
}

/* Straight up to 0.6, then bending towards white without ever reaching it. */
static double film(double x) { return x < 0.6 ? x : 0.6 + 0.4 * (1.0 - exp((0.6 - x) / 0.4)); }

static ex_image *develop(const ex_scene *scene) {
    ex_image *image = ex_image_new(scene->width, scene->height, 0, 0, 0);
    /* An ordered pattern instead of plain rounding, so that the background's slow gradients show no bands. */
    static const double dither[4][4] = {
        {0.03, 0.53, 0.16, 0.66}, {0.78, 0.28, 0.91, 0.41}, {0.22, 0.72, 0.09, 0.59}, {0.97, 0.47, 0.84, 0.34}};
    int n = scene->look.samples, x, y, i, j, k;
    if (!image) return NULL;
    for (y = 0; y < scene->height; y++)
        for (x = 0; x < scene->width; x++) {
            double sum[3] = {0.0, 0.0, 0.0}, color[3];
            unsigned char *out = image->rgb + 3 * ((size_t)y * (size_t)scene->width + (size_t)x);
            for (j = 0; j < n; j++)
                for (i = 0; i < n; i++) {
                    light_sample(scene, x * n + i, y * n + j, color);
                    for (k = 0; k < 3; k++) sum[k] += film(color[k]);
                }
            for (k = 0; k < 3; k++)
                out[k] =
                    (unsigned char)(255.0 * clamp(srgb_of_linear(sum[k] / (n * n)), 0.0, 0.998) + dither[y & 3][x & 3]);
        }
    return image;
}

ex_image *ex_render_finish(ex_scene *scene) {
    ex_image *image = NULL;
    if (!scene) return NULL;
    scene->samples = (sample *)calloc((size_t)scene->sw * (size_t)scene->sh, sizeof *scene->samples);
    if (scene->samples && !scene->failed && draw_shadow_map(scene)) {
        draw(scene);
        if (find_occlusion(scene)) image = develop(scene);
    }
    free(scene->samples);
    free(scene->shadow);
    free(scene->occlusion);
    free(scene->pixel_depth);
    free(scene->corners.data);
    free(scene->materials.data);
    free(scene->triangle_materials.data);
    free(scene->knots.data);
    free(scene->segments.data);
    free(scene->threads.data);
    free(scene);
    return image;
}

int ex_render_save(ex_scene *scene, const char *path) {
    ex_image *image = ex_render_finish(scene);
    int fine = image && ex_image_write_png(image, path);
    ex_image_free(image);
    return fine;
}
