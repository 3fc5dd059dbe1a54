/* Cloth on bodies and on itself. */
#include "scenes/scenes.h"
#include "test.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- at rest on a body ---------------------------------------------------------------------------------------- */

static double sphere_distance(const double x[3]) {
    return sqrt(x[0] * x[0] + (x[1] + 0.03) * (x[1] + 0.03) + x[2] * x[2]) - 0.025;
}
static double plane_distance(const double x[3]) { return x[1] + 0.006; }
static double cone_distance(const double x[3]) { /* a capsule along x, radius 2 cm */
    double t = fmin(fmax((x[0] + 0.04) / 0.08, 0.0), 1.0), dx = x[0] + 0.04 - 0.08 * t, dy = x[1] + 0.025;
    return sqrt(dx * dx + dy * dy + x[2] * x[2]) - 0.02;
}
/* An upright cylinder with a flat top at y = -0.006: inside its top the distance is the height. */
static double loft_distance(const double x[3]) {
    double out = sqrt(x[0] * x[0] + x[2] * x[2]) - 0.02, above = x[1] + 0.006;
    return out <= 0.0 || above <= 0.0 ? fmax(out, above) : sqrt(out * out + above * above);
}

static const double loft_rows[2][4] = {{-0.08, 0.02, 0.02, 0.0}, {-0.006, 0.02, 0.02, 0.0}};

static double body_distance(int shape, const double x[3]) {
    return shape == 0 ? sphere_distance(x)
        : shape == 1  ? plane_distance(x)
        : shape == 2  ? cone_distance(x)
                      : loft_distance(x);
}

static void body_fill(int shape, yc_primitive *p) {
    memset(p, 0, sizeof *p);
    if (shape == 0) p->type = YC_SPHERE, p->a[1] = -0.03, p->ra = 0.025;
    if (shape == 1) p->type = YC_PLANE, p->a[1] = -0.006, p->b[1] = 1.0;
    if (shape == 2)
        p->type = YC_ROUNDED_CONE, p->a[0] = -0.04, p->b[0] = 0.04, p->a[1] = p->b[1] = -0.025, p->ra = p->rb = 0.02;
    if (shape == 3) p->type = YC_LOFT, p->section_count = 2, p->sections = loft_rows, p->exponent = 2.0;
}

/* A swatch that lies flat, centred over the origin. */
static scene_swatch *lying(scene_kind kind) {
    scene_swatch_desc d = scene_swatch_desc_default(kind);
    d.origin[0] = -0.5 * d.size[0], d.origin[2] = 0.5 * d.size[1];
    d.along_v[1] = 0.0, d.along_v[2] = -1.0;
    return scene_swatch_new(&d);
}

/* Drops it for a second of damped time; the deepest point and the fastest at the end. */
static void check_drop(int shape, scene_kind kind) {
    scene_swatch *s = lying(kind);
    const scene_swatch_desc *d = &s->desc;
    yc_scene_desc settings = yc_scene_desc_default();
    yc_primitive p;
    yc_body_desc body = yc_body_desc_default();
    yc_scene *scene = NULL;
    yc_stats stats;
    double(*x)[3], (*v)[3], deepest = HUGE_VAL, nearest = HUGE_VAL, fastest = 0.0, centre[3];
    int i, k, j, count = scene_swatch_count(s);
    body_fill(shape, &p);
    body.primitive_count = 1, body.primitives = &p, body.friction = 0.8;
    settings.mass_damping = 20.0;
    CHECK_RESULT(yc_scene_create(NULL, &settings, &scene, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_cloth(scene, &s->cloth, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_body(scene, &body, NULL), YC_OK);
    memset(&stats, 0, sizeof stats);
    for (i = 0; i < (kind == SCENE_TRIANGLES ? 100 : 30); i++)
        if (!CHECK_RESULT(yc_scene_step(scene, kind == SCENE_TRIANGLES ? 0.02 : 0.01, &stats), YC_OK)) break;
    CHECK(stats.body_contacts > 0);
    x = (double(*)[3])malloc((size_t)(count + 100) * sizeof *x),
    v = (double(*)[3])malloc((size_t)(count + 100) * sizeof *v);
    CHECK_RESULT(yc_scene_positions(scene, 0, scene_swatch_kind(s), x), YC_OK);
    CHECK_RESULT(yc_scene_velocities(scene, 0, scene_swatch_kind(s), v), YC_OK);
    for (i = 0; i < count; i++) {
        double distance = body_distance(shape, x[i]);
        deepest = fmin(deepest, distance), nearest = fmin(nearest, distance);
        fastest = fmax(fastest, sqrt(v[i][0] * v[i][0] + v[i][1] * v[i][1] + v[i][2] * v[i][2]));
    }
    if (s->vertex_count && kind != SCENE_YARNS) {
        CHECK_RESULT(yc_scene_positions(scene, 0, YC_VERTEX, x), YC_OK);
        for (i = 0; i < s->cloth.mesh.triangle_count; i++) {
            for (k = 0; k < 3; k++) centre[k] = 0.0;
            for (j = 0; j < 3; j++)
                for (k = 0; k < 3; k++) centre[k] += x[s->triangles[i][j]][k] / 3.0;
            deepest = fmin(deepest, body_distance(shape, centre)),
            nearest = fmin(nearest, body_distance(shape, centre));
        }
    }
    CHECK(deepest > 0.0); /* nothing inside the body: to be deeper than its thickness is to be deeper than that */
    if (kind == SCENE_MIXED) CHECK(nearest > 0.5 * d->yarn.radius && nearest < 1.01 * settings.thickness);
    else CHECK_NEAR(nearest, kind == SCENE_YARNS ? d->yarn.radius : settings.thickness, 5e-5); /* and it lies on it */
    if (kind == SCENE_TRIANGLES) CHECK(fastest < 5e-3);
    free(x), free(v);
    yc_scene_destroy(scene);
    scene_swatch_free(s);
}

TEST(scene_contact_triangles_rest_on_bodies) {
    int shape;
    for (shape = 0; shape < 4; shape++) check_drop(shape, SCENE_TRIANGLES);
}
TEST(scene_contact_yarns_rest_on_a_sphere) { check_drop(0, SCENE_YARNS); }
TEST(scene_contact_mixed_rests_on_a_sphere) { check_drop(0, SCENE_MIXED); }

/* ---- friction ------------------------------------------------------------------------------------------------- */

/* A swatch on a plane, gravity turned by `angle`: how far it slides from 0.2 s to 0.4 s, and its mean acceleration. */
static void slope(double angle, double friction, double *crept, double *acceleration) {
    scene_swatch *s = lying(SCENE_TRIANGLES);
    yc_scene_desc settings = yc_scene_desc_default();
    yc_primitive p;
    yc_body_desc body = yc_body_desc_default();
    yc_scene *scene = NULL;
    double mass = 1.0, before[3] = {0.0, 0.0, 0.0}, after[3] = {0.0, 0.0, 0.0}, x[36][3] = {{0.0}},
           start[36][3] = {{0.0}};
    int i;
    settings.gravity[0] = 9.81 * sin(angle), settings.gravity[1] = -9.81 * cos(angle);
    memset(&p, 0, sizeof p);
    p.type = YC_PLANE, p.b[1] = 1.0, p.a[1] = -settings.thickness;
    body.primitive_count = 1, body.primitives = &p, body.friction = friction;
    CHECK_RESULT(yc_scene_create(NULL, &settings, &scene, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_cloth(scene, &s->cloth, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_body(scene, &body, NULL), YC_OK);
    for (i = 0; i < 200; i++) {
        if (!CHECK_RESULT(yc_scene_step(scene, 2e-3, NULL), YC_OK)) break;
        if (i == 99) {
            CHECK_RESULT(yc_scene_momentum(scene, &mass, before, NULL), YC_OK);
            CHECK_RESULT(yc_scene_positions(scene, 0, YC_VERTEX, start), YC_OK);
        }
    }
    CHECK_RESULT(yc_scene_momentum(scene, &mass, after, NULL), YC_OK);
    CHECK_RESULT(yc_scene_positions(scene, 0, YC_VERTEX, x), YC_OK);
    for (i = 0, *crept = 0.0; i < 36; i++) *crept = fmax(*crept, fabs(x[i][0] - start[i][0]));
    *acceleration = (after[0] - before[0]) / mass / 0.2;
    yc_scene_destroy(scene);
    scene_swatch_free(s);
}

TEST(scene_contact_friction_angle) {
    double crept, acceleration, angle = atan(0.4);
    slope(0.75 * angle, 0.4, &crept, &acceleration);
    CHECK(crept < 1e-3 * 0.2); /* slower than slip_speed */
    slope(1.5 * angle, 0.4, &crept, &acceleration);
    CHECK_NEAR(acceleration, 9.81 * (sin(1.5 * angle) - 0.4 * cos(1.5 * angle)), 0.03 * 9.81);
    slope(0.3, 0.0, &crept, &acceleration);
    CHECK_NEAR(acceleration, 9.81 * sin(0.3), 1e-3 * 9.81);
}

/* ---- self contact --------------------------------------------------------------------------------------------- */

/* Whether the segment p q passes through the triangle a b c, by signs of volumes. */
static double volume(const double *a, const double *b, const double *c, const double *d) {
    double u[3], v[3], w[3];
    int k;
    for (k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k], w[k] = d[k] - a[k];
    return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
}

static int passes(const double *p, const double *q, const double *a, const double *b, const double *c) {
    double s = volume(a, b, c, p), t = volume(a, b, c, q), u, v, w;
    if ((s > 0.0) == (t > 0.0) || fabs(s) < 1e-14 || fabs(t) < 1e-14)
        return 0; /* a triangle of 0.3 cm^2: 1e-10 m off its plane */
    u = volume(p, q, a, b), v = volume(p, q, b, c), w = volume(p, q, c, a);
    return (u > 0.0) == (v > 0.0) && (v > 0.0) == (w > 0.0);
}

static int crossings(const scene_swatch *s, double (*x)[3]) {
    int i, j, k, m, found = 0;
    for (i = 0; i < s->cloth.mesh.triangle_count; i++)
        for (k = 0; k < 3; k++)
            for (j = 0; j < s->cloth.mesh.triangle_count; j++) {
                int p = s->triangles[i][k], q = s->triangles[i][(k + 1) % 3], shared = 0;
                for (m = 0; m < 3; m++) shared |= s->triangles[j][m] == p || s->triangles[j][m] == q;
                if (!shared)
                    found += passes(x[p], x[q], x[s->triangles[j][0]], x[s->triangles[j][1]], x[s->triangles[j][2]]);
            }
    return found;
}

/* Upright over the plane, a little curved so that it folds to one side. */
static void edge_on(void *user, const double uv[2], double out[3]) {
    (void)user;
    out[0] = uv[0] - 0.05, out[1] = uv[1] + 2e-3,
    out[2] = 0.01 * sin(40.0 * uv[1]) + 0.1 * (uv[0] - 0.05) * (uv[0] - 0.05);
}

/* Folded in an S of three layers. */
static void layers(void *user, const double uv[2], double out[3]) {
    double radius = 4e-3, flat = 0.025, arc = 3.14159265358979323846 * radius, s = uv[1];
    (void)user;
    out[0] = uv[0] - 0.05;
    if (s < flat) out[2] = s, out[1] = 0.0;
    else if (s < flat + arc)
        out[2] = flat + radius * sin((s - flat) / radius), out[1] = radius * (1.0 - cos((s - flat) / radius));
    else if (s < 2.0 * flat + arc) out[2] = flat - (s - flat - arc), out[1] = 2.0 * radius;
    else if (s < 2.0 * flat + 2.0 * arc)
        out[2] = -radius * sin((s - 2.0 * flat - arc) / radius),
        out[1] = radius * (3.0 - cos((s - 2.0 * flat - arc) / radius));
    else out[2] = s - 2.0 * flat - 2.0 * arc, out[1] = 4.0 * radius;
    out[1] += 4e-3;
}

static void check_heap(void (*place)(void *user, const double uv[2], double out[3])) {
    scene_swatch_desc d = scene_swatch_desc_default(SCENE_TRIANGLES);
    scene_swatch *s;
    yc_scene_desc settings = yc_scene_desc_default();
    yc_primitive p;
    yc_body_desc body = yc_body_desc_default();
    yc_scene *scene = NULL;
    yc_stats stats;
    double x[400][3] = {{0.0}}, v[400][3] = {{0.0}}, lowest = HUGE_VAL, fastest = 0.0;
    int i, pairs = 0;
    d.cells[0] = 12, d.cells[1] = 16, d.size[0] = 0.1, d.size[1] = 0.12;
    s = scene_swatch_new(&d);
    s->cloth.material = yc_triangle_material_default();
    scene_swatch_place(s, place, NULL);
    CHECK(crossings(s, s->positions) == 0);
    memset(&p, 0, sizeof p);
    p.type = YC_PLANE, p.b[1] = 1.0;
    body.primitive_count = 1, body.primitives = &p, body.friction = 0.5;
    settings.self_contact = 1, settings.mass_damping = 8.0;
    CHECK_RESULT(yc_scene_create(NULL, &settings, &scene, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_cloth(scene, &s->cloth, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_body(scene, &body, NULL), YC_OK);
    for (i = 0; i < 40; i++) {
        if (!CHECK_RESULT(yc_scene_step(scene, 0.01, &stats), YC_OK)) break;
        if (stats.pair_contacts > pairs) pairs = stats.pair_contacts;
        if (i % 10 == 9) {
            CHECK_RESULT(yc_scene_positions(scene, 0, YC_VERTEX, x), YC_OK);
            CHECK(crossings(s, x) == 0);
        }
    }
    CHECK(pairs > 0);
    CHECK_RESULT(yc_scene_velocities(scene, 0, YC_VERTEX, v), YC_OK);
    for (i = 0; i < s->vertex_count; i++) {
        lowest = fmin(lowest, x[i][1]);
        fastest = fmax(fastest, sqrt(v[i][0] * v[i][0] + v[i][1] * v[i][1] + v[i][2] * v[i][2]));
    }
    CHECK(lowest > 0.0);
    CHECK(fastest < 0.1);
    yc_scene_destroy(scene);
    scene_swatch_free(s);
}

TEST(scene_contact_dropped_edge_on) { check_heap(edge_on); }
TEST(scene_contact_folded_layers) { check_heap(layers); }

/* ---- yarns alone on themselves ---------------------------------------------------------------------------------- */

static scene_swatch *yarns_alone(double width, double length) {
    scene_swatch_desc d = scene_swatch_desc_default(SCENE_YARNS_ALONE);
    d.spacing = 1.5e-3, d.size[0] = width, d.size[1] = length;
    d.yarn.radius = 0.4e-3, d.yarn.bending *= 0.05; /* close: gauze would let the nodes of other cloth through */
    return scene_swatch_new(&d);
}

static double apart(const double *a, const double *b) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/* The upper one is laid where the lower one is, in the pattern; it falls half a spacing to the side. */
static void beside(void *user, const double uv[2], double out[3]) {
    (void)user;
    out[0] = uv[0] + 0.7e-3, out[1] = 3e-3, out[2] = -uv[1] + 0.6e-3;
}
static void below(void *user, const double uv[2], double out[3]) {
    (void)user;
    out[0] = uv[0], out[1] = 0.0, out[2] = -uv[1];
}

TEST(scene_contact_yarns_fall_on_yarns) {
    scene_swatch *s[2];
    yc_scene_desc settings = yc_scene_desc_default();
    yc_scene *scene = NULL;
    yc_stats stats;
    double x[2][400][3] = {{{0.0}}}, before[3], after[3], down[3] = {0.0, -0.4, 0.0}, height[2] = {0.0, 0.0}, thickness,
           nearest = HUGE_VAL;
    int i, j, k, step, count, pairs = 0;
    s[0] = yarns_alone(0.015, 0.015), s[1] = yarns_alone(0.015, 0.015), count = s[0]->yarns.node_count;
    thickness = 4.0 * s[0]->desc.yarn.radius; /* two yarns at every crossing, of either cloth */
    scene_swatch_place(s[0], below, NULL), scene_swatch_place(s[1], beside, NULL);
    settings.self_contact = 1, settings.thickness = s[0]->desc.yarn.radius;
    memset(settings.gravity, 0, sizeof settings.gravity);
    CHECK_RESULT(yc_scene_create(NULL, &settings, &scene, NULL), YC_OK);
    for (k = 0; k < 2; k++) CHECK_RESULT(yc_scene_add_cloth(scene, &s[k]->cloth, NULL), YC_OK);
    for (i = 0; i < count; i++) CHECK_RESULT(yc_scene_set_velocity(scene, 1, YC_NODE, i, down), YC_OK);
    CHECK_RESULT(yc_scene_momentum(scene, NULL, before, NULL), YC_OK);
    for (step = 0; step < 16 && CHECK(count <= 400); step++) {
        if (!CHECK_RESULT(yc_scene_step(scene, 1e-3, &stats), YC_OK)) break;
        if (stats.pair_contacts > pairs) pairs = stats.pair_contacts;
        for (k = 0; k < 2; k++) CHECK_RESULT(yc_scene_positions(scene, k, YC_NODE, x[k]), YC_OK);
        for (i = 0; i < count; i++)
            for (j = 0; j < count; j++) nearest = fmin(nearest, apart(x[0][i], x[1][j]));
    }
    CHECK(pairs > 0 && nearest > 0.7 * thickness && nearest < thickness);
    for (k = 0; k < 2; k++)
        for (i = 0; i < count; i++) height[k] += x[k][i][1] / count;
    CHECK(height[1] > height[0] + 0.6 * thickness); /* a node may lie in the middle of four others */
    CHECK_RESULT(yc_scene_momentum(scene, NULL, after, NULL), YC_OK);
    CHECK(before[1] < 0.0);
    for (k = 0; k < 3; k++) CHECK_NEAR(after[k], before[k], 1e-4 * fabs(before[1]));
    yc_scene_destroy(scene);
    scene_swatch_free(s[0]), scene_swatch_free(s[1]);
}

/* At rest nothing acts; folded in an S it comes to lie on itself and does not pass through. */
TEST(scene_contact_yarns_folded_layers) {
    scene_swatch *s = yarns_alone(0.012, 0.1);
    yc_scene_desc settings = yc_scene_desc_default();
    yc_primitive p;
    yc_body_desc body = yc_body_desc_default();
    yc_scene *scene = NULL;
    yc_stats stats;
    double x[1200][3] = {{0.0}}, energy[YC_TERM_COUNT] = {0.0}, nearest = HUGE_VAL, radius = s->desc.yarn.radius;
    int i, j, step, placed, count = s->yarns.node_count;
    memset(&p, 0, sizeof p), memset(&stats, 0, sizeof stats);
    p.type = YC_PLANE, p.b[1] = 1.0;
    body.primitive_count = 1, body.primitives = &p, body.friction = 0.5;
    settings.self_contact = 1, settings.mass_damping = 20.0, settings.thickness = radius;
    for (placed = 0; placed < 2 && CHECK(count <= 1200); placed++) {
        scene_swatch_place(s, placed ? layers : below, NULL);
        CHECK_RESULT(yc_scene_create(NULL, &settings, &scene, NULL), YC_OK);
        CHECK_RESULT(yc_scene_add_cloth(scene, &s->cloth, NULL), YC_OK);
        if (placed) CHECK_RESULT(yc_scene_add_body(scene, &body, NULL), YC_OK);
        for (step = 0; step < (placed ? 20 : 1); step++)
            if (!CHECK_RESULT(yc_scene_step(scene, 5e-3, &stats), YC_OK)) break;
        CHECK_RESULT(yc_scene_energy(scene, energy), YC_OK);
        CHECK_RESULT(yc_scene_positions(scene, 0, YC_NODE, x), YC_OK);
        yc_scene_destroy(scene), scene = NULL;
        if (!placed) CHECK_NEAR(energy[YC_TERM_PAIR], 0.0, 0.0);
    }
    CHECK(energy[YC_TERM_PAIR] > 0.0);
    for (i = 0; i < count; i++)
        for (j = 0; j < i; j++)
            if (apart(s->yarns.layout[i], s->yarns.layout[j]) > 7.0 * radius)
                nearest = fmin(nearest, apart(x[i], x[j]));
    CHECK(nearest > 0.7 * 4.0 * radius && nearest < 4.0 * radius);
    scene_swatch_free(s);
}

/* ---- a moving body -------------------------------------------------------------------------------------------- */

/* A sphere comes through the plane of a hanging swatch and pushes it out. */
TEST(scene_contact_moving_sphere_pushes) {
    scene_swatch_desc d = scene_swatch_desc_default(SCENE_TRIANGLES);
    scene_swatch *s = scene_swatch_new(&d);
    yc_scene_desc settings = yc_scene_desc_default();
    yc_primitive p;
    yc_body_desc body = yc_body_desc_default();
    yc_scene *scene = NULL;
    double x[36][3], turn[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, at[3] = {0.025, 0.015, -0.03}, furthest = -HUGE_VAL;
    int i, k;
    memset(&p, 0, sizeof p);
    p.type = YC_SPHERE, p.ra = 0.012;
    body.primitive_count = 1, body.primitives = &p;
    settings.mass_damping = 5.0;
    CHECK_RESULT(yc_scene_create(NULL, &settings, &scene, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_cloth(scene, &s->cloth, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_body(scene, &body, NULL), YC_OK);
    CHECK_RESULT(yc_scene_move_body(scene, 0, turn, at), YC_OK);
    for (i = 0; i < 6; i++) CHECK_RESULT(yc_scene_pin(scene, 0, YC_VERTEX, 30 + i, NULL), YC_OK);
    CHECK_RESULT(yc_scene_step(scene, 1e-4, NULL), YC_OK);
    for (i = 0; i < 30; i++) {
        at[2] += 1.5e-3;
        CHECK_RESULT(yc_scene_move_body(scene, 0, turn, at), YC_OK);
        if (!CHECK_RESULT(yc_scene_step(scene, 0.01, NULL), YC_OK)) break;
    }
    CHECK_RESULT(yc_scene_positions(scene, 0, YC_VERTEX, x), YC_OK);
    for (i = 0; i < 36; i++) {
        double r = 0.0;
        for (k = 0; k < 3; k++) r += (x[i][k] - at[k]) * (x[i][k] - at[k]);
        CHECK(sqrt(r) > 0.012);
        furthest = fmax(furthest, x[i][2]);
    }
    CHECK(furthest > 0.015); /* the sphere's front has reached z = 2.7 cm */
    yc_scene_destroy(scene);
    scene_swatch_free(s);
}
