/* Linear systems out of running scenes, and how fast conjugate gradients converge on them. Include internals.h first:
 * this reaches behind the public functions, as nothing else of the scenes does. */
#ifndef SYSTEMS_H
#define SYSTEMS_H

#include "scenes.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The swing of scenes.h, crimped, which falls onto a ball while it swings: yarns slide, touch and undulate. All but the
 * outermost cells have yarns, those inside of these full ones. */
typedef struct system_desc {
    int cells;         /* along each side, two triangles each; at least 4 */
    int per_triangle;  /* yarn nodes on each triangle */
    double stretch;    /* times the swing's, whose yarns are as soft as those of MIX: 1e7 Pa */
    double time, step; /* s, when the system is taken, and the steps until then */
} system_desc;

static inline system_desc system_desc_default(void) {
    system_desc d = {8, 100, 1.0, 0.08, 4e-3};
    return d;
}

typedef struct system_scene {
    scene_swatch *swatch;
    yc_scene *scene;
    double *right, *expected; /* of the system at hand: the right side, and what solves it, in A's layout */
    double h;
    char message[YC_MESSAGE_SIZE];
} system_scene;

static inline void system_scene_free(system_scene *s) {
    if (!s) return;
    yc_scene_destroy(s->scene), scene_swatch_free(s->swatch);
    free(s->right), free(s->expected), free(s);
}

/* The scene at the time it is wanted. NULL when memory is out; scene is NULL, and the message says why, when it cannot
 * come there. */
static inline system_scene *system_scene_new(const system_desc *d) {
    system_scene *s = (system_scene *)calloc(1, sizeof *s);
    yc_scene_desc settings = yc_scene_desc_default();
    yc_body_desc body = yc_body_desc_default();
    yc_primitive ball;
    yc_result result;
    double size = d->cells * sqrt(2.0 * d->per_triangle) * 1e-3;
    int i, steps = (int)floor(d->time / d->step + 0.5);
    if (!s) return NULL;
    s->swatch = scene_swing_sized(d->cells, size, 0.5 - 1.5 / d->cells, d->stretch);
    if (!s->swatch) {
        free(s);
        return NULL;
    }
    memset(&ball, 0, sizeof ball);
    ball.type = YC_SPHERE, ball.ra = 0.03;
    ball.a[0] = 0.5 * size, ball.a[1] = -ball.ra - 0.005, ball.a[2] = -0.5 * size;
    body.primitive_count = 1, body.primitives = &ball;
    result = yc_scene_create(NULL, &settings, &s->scene, s->message);
    if (result == YC_OK) result = yc_scene_add_cloth(s->scene, &s->swatch->cloth, NULL);
    if (result == YC_OK) result = yc_scene_add_body(s->scene, &body, NULL);
    for (i = 0; i <= d->cells && result == YC_OK; i++) result = yc_scene_pin(s->scene, 0, YC_VERTEX, i, NULL);
    for (i = 0; i < steps && result == YC_OK; i++) result = yc_scene_step(s->scene, d->step, NULL);
    if (result == YC_OK) return s;
    if (s->scene) snprintf(s->message, sizeof s->message, "%s", yc_scene_message(s->scene));
    yc_scene_destroy(s->scene), s->scene = NULL;
    return s;
}

/* Makes the scene's system anew for a solver, and assembles and factors it where the step of s->h begins. */
static inline yc_result system_prepare(system_scene *s, yc_solver solver, yc_smoother smoother) {
    yc_scene *scene = s->scene;
    double scale;
    yc_result result;
    scene->desc.solver = solver, scene->desc.smoother = smoother;
    result = yci_build_system(scene, scene->model);
    if (result != YC_OK) return result;
    yci_masses(scene);
    yci_potential(scene, YCI_HESSIAN, &scale);
    return yci_system_factor(&scene->model->system);
}

/* Shares of the starting error whose iterations are counted. */
enum { SYSTEM_MARKS = 3 };
static const double system_mark[SYSTEM_MARKS] = {1e-1, 1e-2, 1e-4};

/* The error of d in velocity, relative to its change in the step: of yarns or of vertices, whichever is worse. */
static inline double system_error(const yci_system *a, const double *d, const double *expected) {
    double error[2] = {0.0, 0.0}, change[2] = {0.0, 0.0};
    int i, k;
    for (i = 0; i < a->a.n; i++)
        for (k = a->a.off[i]; k < a->a.off[i + 1]; k++) {
            error[a->is_yarn[i]] += (d[k] - expected[k]) * (d[k] - expected[k]);
            change[a->is_yarn[i]] += expected[k] * expected[k];
        }
    for (k = 0; k < 2; k++) error[k] = change[k] > 0.0 ? sqrt(error[k] / change[k]) : 0.0;
    return fmax(error[0], error[1]);
}

/* The iterations of yci_system_mpcg to each mark, -1 where `limit` of them do not get there; the same arithmetic, with
 * a look at every iterate. */
static inline int system_converge(system_scene *s, int limit, int at[SYSTEM_MARKS]) {
    yci_system *a = &s->scene->model->system;
    int size = yci_system_size(a), i, k, mark = 0;
    double *q = (double *)calloc(6 * (size_t)size, sizeof *q), *z = q + size, *dir = z + size, *y = dir + size;
    double *r = y + size, *d = r + size, rz = 0.0, last = 1.0;
    for (k = 0; k < SYSTEM_MARKS; k++) at[k] = -1;
    if (!q) return 0;
    memcpy(r, s->right, (size_t)size * sizeof *r);
    yci_system_reduce(a, r);
    if (a->solver == YC_SOLVER_TWO_LEVEL) {
        yci_coarse_add(&a->coarse, &a->a, r, q);
        yci_system_multiply(a, q, y);
        for (i = 0; i < size; i++) r[i] -= y[i];
    }
    for (k = 0; k <= limit; k++) {
        double error, curvature;
        yci_system_expand(a, q, d);
        error = system_error(a, d, s->expected);
        while (mark < SYSTEM_MARKS && error <= system_mark[mark]) at[mark++] = k;
        if (mark == SYSTEM_MARKS || k == limit) break;
        yci_system_precondition(a, r, z, y);
        rz = yci_vector_dot(r, z, size);
        for (i = 0; i < size; i++) dir[i] = z[i] + rz / last * dir[i];
        last = rz;
        yci_system_multiply(a, dir, y);
        curvature = yci_vector_dot(dir, y, size);
        if (!(curvature > 0.0)) break;
        for (i = 0; i < size; i++) q[i] += rz / curvature * dir[i], r[i] -= rz / curvature * y[i];
    }
    free(q);
    return mark == SYSTEM_MARKS;
}

/* Takes the system of the first Newton iteration of a step of h, for the change of velocity as in MIX (11), and solves
 * it as far as rounding lets it. The scene stays within that step; take others, or free it. */
static inline yc_result system_take(system_scene *s, double h) {
    yc_scene *scene = s->scene;
    yci_model *m = scene->model;
    yc_result result;
    int i, size;
    if (m->h > 0.0) yci_restore(scene);
    s->h = m->h = h, m->rate = 0.0;
    yci_fit_vertices(scene, scene->x);
    yci_keep(scene);
    yci_compress(scene);
    yci_predict(scene, NULL, 1.0);
    yci_prescribe(scene, 1.0);
    result = yci_search(scene);
    if (result != YC_OK) return result;
    size = yci_system_size(&m->system);
    yci_masses(scene);
    yci_dofs_get(scene, scene->x, scene->u, scene->z, m->dof);
    memcpy(m->dof_n, m->dof, (size_t)size * sizeof(double));
    yci_dofs_get(scene, scene->velocity, scene->slide, scene->rise, m->dof_free);
    for (i = 0; i < size; i++) m->direction[i] = h * m->dof_free[i], m->dof_free[i] = m->dof_n[i] + m->direction[i];
    m->convex = 1.0, m->shift = 0.0, m->searching = 0;
    result = system_prepare(s, YC_SOLVER_TWO_LEVEL, YC_SMOOTHER_INCOMPLETE);
    free(s->right), free(s->expected);
    s->right = (double *)calloc((size_t)size, sizeof(double));
    s->expected = (double *)calloc((size_t)size, sizeof(double));
    if (result != YC_OK || !s->right || !s->expected) return result != YC_OK ? result : YC_ERROR_MEMORY;
    yci_bsr_multiply(&scene->c, &m->system.a, m->direction, s->right);
    for (i = 0; i < size; i++) s->right[i] = -m->gradient[i] - s->right[i];
    memcpy(s->expected, s->right, (size_t)size * sizeof(double));
    yci_system_mpcg(&m->system, s->expected, s->expected, 1e-11, 0.0, 20000);
    return YC_OK;
}

#endif
