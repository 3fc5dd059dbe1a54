/* Scenes against mechanics: free flight, momentum, energy, mass, pendulum, chain, cantilever, damping. */
#include "scenes/yarns.h"
#include "test_scene.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* Iterative solvers too solve to rounding. */
static yc_scene_desc tight(void) {
    yc_scene_desc d = yc_scene_desc_preset(YC_REFERENCE);
    d.tolerance = 1e-12, d.linear_tolerance = 1e-8, d.dt_max = 1.0;
    return d;
}

/* Soft enough for steps of 0.1 ms to follow its vibrations: waves of 3 m/s. */
static void soften(scene_swatch_desc *d) { d->yarn.stretch = 3e-4, d->yarn.shear = 3e-5, d->yarn.contact = 1e-4; }

/* Where nothing is compared across kinds, those that are not mixed do with 3 x 3 cells. */
static scene_swatch_desc small(scene_kind kind) {
    scene_swatch_desc d = scene_swatch_desc_default(kind);
    if (kind == SCENE_MIXED) return d;
    d.cells[0] = d.cells[1] = 3, d.size[0] = d.size[1] = 0.03;
    return d;
}

static double energy_of(yc_scene *scene) {
    double terms[YC_TERM_COUNT], sum = 0.0;
    int i;
    CHECK_RESULT(yc_scene_energy(scene, terms), YC_OK);
    for (i = 0; i < YC_TERM_COUNT; i++) sum += terms[i];
    return sum;
}

static void set_velocities(yc_scene *scene, const scene_swatch *s, void (*velocity)(const double x[3], double v[3])) {
    double v[3];
    int i;
    for (i = 0; i < s->vertex_count; i++) {
        velocity(s->positions[i], v);
        CHECK_RESULT(yc_scene_set_velocity(scene, 0, YC_VERTEX, i, v), YC_OK);
    }
    for (i = 0; i < s->yarns.node_count; i++) {
        velocity(s->nodes[i], v);
        CHECK_RESULT(yc_scene_set_velocity(scene, 0, YC_NODE, i, v), YC_OK);
    }
}

/* ---- free fall ------------------------------------------------------------------------------------------------ */

static void thrown(const double x[3], double v[3]) {
    (void)x;
    v[0] = 0.7, v[1] = 2.0, v[2] = -0.4;
}

/* Backward Euler's own parabola: v' = (v + h g) / (1 + c h), x' = x + h v'. */
static void check_fall(scene_kind kind, double damping) {
    scene_swatch_desc d = small(kind);
    scene_swatch *s = scene_swatch_new(&d);
    yc_scene_desc settings = tight();
    yc_scene *scene;
    double v[3] = {0.7, 2.0, -0.4}, move[3] = {0.0, 0.0, 0.0}, worst = 0.0, h = 4e-3;
    double(*x)[3], (*start)[3];
    int i, k, step, count = scene_swatch_count(s);
    settings.mass_damping = damping;
    scene = test_scene_of(&settings, &s->cloth);
    x = (double(*)[3])malloc((size_t)count * sizeof *x), start = (double(*)[3])malloc((size_t)count * sizeof *x);
    if (scene) {
        set_velocities(scene, s, thrown);
        CHECK_RESULT(yc_scene_positions(scene, 0, scene_swatch_kind(s), start), YC_OK);
        for (step = 0; step < 25; step++) {
            if (!CHECK_RESULT(yc_scene_step(scene, h, NULL), YC_OK)) break;
            for (k = 0; k < 3; k++) {
                v[k] = (v[k] + h * settings.gravity[k]) / (1.0 + damping * h);
                move[k] += h * v[k];
            }
        }
        CHECK_RESULT(yc_scene_positions(scene, 0, scene_swatch_kind(s), x), YC_OK);
        for (i = 0; i < count; i++)
            for (k = 0; k < 3; k++) worst = fmax(worst, fabs(x[i][k] - start[i][k] - move[k]));
        CHECK_NEAR(worst, 0.0, 1e-11);
        CHECK_NEAR(yc_scene_time(scene), 25 * h, 1e-15);
    }
    free(x), free(start);
    yc_scene_destroy(scene);
    scene_swatch_free(s);
}

TEST(scene_physics_free_fall) {
    int kind;
    for (kind = 0; kind < SCENE_KINDS; kind++) check_fall((scene_kind)kind, 0.0);
}

TEST(scene_physics_mass_damping_decays) {
    int kind;
    for (kind = 0; kind < SCENE_KINDS; kind++) check_fall((scene_kind)kind, 30.0);
}

/* ---- momentum ------------------------------------------------------------------------------------------------- */

/* A swatch stretched, sheared and curved. */
static void deformed(void *user, const double uv[2], double out[3]) {
    (void)user;
    out[0] = 1.02 * uv[0] + 0.05 * uv[1];
    out[1] = 0.99 * uv[1] - 0.03 * uv[0];
    out[2] = 4e-3 * sin(60.0 * uv[0]) + 3e-3 * cos(45.0 * uv[1]);
}

static void spinning(const double x[3], double v[3]) {
    v[0] = 0.2 - 20.0 * x[1], v[1] = -0.1 + 20.0 * x[0], v[2] = 0.3;
}

static void check_momentum(scene_kind kind, int hold_sliding, double friction) {
    scene_swatch_desc d = small(kind);
    scene_swatch *s;
    yc_scene_desc settings = yc_scene_desc_default();
    yc_scene *scene;
    double before[3], after[3], mass, size;
    int step;
    d.yarn.friction = friction;
    s = scene_swatch_new(&d);
    memset(settings.gravity, 0, sizeof settings.gravity);
    s->cloth.hold_sliding = hold_sliding;
    scene_swatch_place(s, deformed, NULL);
    scene = test_scene_of(&settings, &s->cloth);
    if (scene) {
        set_velocities(scene, s, spinning);
        CHECK_RESULT(yc_scene_step(scene, 1e-3, NULL), YC_OK); /* the first step makes hybrid velocities consistent */
        CHECK_RESULT(yc_scene_momentum(scene, &mass, before, NULL), YC_OK);
        size = mass * 1.3; /* about the fastest point's speed */
        for (step = 0; step < 20; step++) CHECK_RESULT(yc_scene_step(scene, 2e-3, NULL), YC_OK);
        CHECK_RESULT(yc_scene_momentum(scene, NULL, after, NULL), YC_OK);
        CHECK_NEAR_ALL(after, before, 3, 1e-10 * size);
    }
    yc_scene_destroy(scene);
    scene_swatch_free(s);
}

TEST(scene_physics_linear_momentum) {
    int kind;
    for (kind = 0; kind < SCENE_KINDS; kind++) {
        check_momentum((scene_kind)kind, 1, 0.3);
        check_momentum((scene_kind)kind, 0, 0.3), check_momentum((scene_kind)kind, 0, 0.0);
    }
}

/* What backward Euler loses of the angular momentum over 20 ms. */
static double angular_loss(scene_kind kind, double h) {
    scene_swatch_desc d = small(kind);
    scene_swatch *s;
    yc_scene_desc settings = tight();
    yc_scene *scene;
    double before[3], after[3], loss = 0.0;
    int k, step, steps = (int)floor(0.02 / h + 0.5);
    memset(settings.gravity, 0, sizeof settings.gravity);
    soften(&d);
    s = scene_swatch_new(&d);
    settings.tolerance = 1e-11;
    s->cloth.hold_sliding = 1;
    scene_swatch_place(s, deformed, NULL);
    scene = test_scene_of(&settings, &s->cloth);
    if (scene) {
        set_velocities(scene, s, spinning);
        CHECK_RESULT(yc_scene_step(scene, 1e-8, NULL), YC_OK); /* makes hybrid vertices and nodes consistent */
        CHECK_RESULT(yc_scene_momentum(scene, NULL, NULL, before), YC_OK);
        for (step = 0; step < steps; step++) CHECK_RESULT(yc_scene_step(scene, h, NULL), YC_OK);
        CHECK_RESULT(yc_scene_momentum(scene, NULL, NULL, after), YC_OK);
        for (k = 0; k < 3; k++) loss += (after[k] - before[k]) * (after[k] - before[k]);
        loss = sqrt(loss) / sqrt(before[0] * before[0] + before[1] * before[1] + before[2] * before[2]);
    }
    yc_scene_destroy(scene);
    scene_swatch_free(s);
    return loss;
}

TEST(scene_physics_angular_momentum_first_order) {
    static const scene_kind kinds[] = {SCENE_TRIANGLES, SCENE_YARNS, SCENE_MIXED};
    int i;
    for (i = 0; i < 3; i++) {
        double coarse = angular_loss(kinds[i], 2e-4), fine = angular_loss(kinds[i], 1e-4);
        CHECK(coarse < 0.2);
        CHECK_NEAR(coarse / fine, 2.0, 0.2);
    }
}

/* ---- mass ----------------------------------------------------------------------------------------------------- */

static double laid_mass(const yc_yarns *y) {
    double mass = 0.0;
    int i;
    for (i = 0; i < y->yarn_count; i++)
        mass += y->materials[y->yarn_material[i]].density *
            (y->visit_u[y->yarn_first[i + 1] - 1] - y->visit_u[y->yarn_first[i]]);
    return mass;
}

TEST(scene_physics_mass_is_the_layouts_for_any_alpha) {
    scene_swatch_desc d = small(SCENE_MIXED);
    scene_swatch *s;
    yc_scene_desc settings = tight();
    uint64_t state = 7;
    int field, i;
    d.cells[0] = 4, d.cells[1] = 6; /* cells and yarns that do not line up */
    s = scene_swatch_new(&d);
    for (field = 0; field < 14; field++) {
        yc_scene *scene;
        double mass = 0.0, linear[3], expected = laid_mass(&s->yarns);
        static const double uniform[] = {0.0, 1e-4, 1e-3, 0.0099, 0.01, 0.0101, 0.5, 0.99, 0.9999, 1.0};
        for (i = 0; i < s->vertex_count; i++)
            s->alpha[i] = field < 10 ? uniform[field]
                : field == 10        ? test_random(&state, 0.0, 1.0)
                : field == 11        ? (double)test_random_int(&state, 2)
                : field == 12        ? test_random(&state, 0.0, 1e-3)
                : s->uv[i][0] > 0.02 ? 1.0
                                     : 0.0;
        scene = test_scene_of(&settings, &s->cloth);
        if (!scene) break;
        CHECK_RESULT(yc_scene_momentum(scene, &mass, linear, NULL), YC_OK);
        CHECK_NEAR(mass / expected, 1.0, 1e-13);
        CHECK_RESULT(yc_scene_step(scene, 1e-3, NULL), YC_OK);
        CHECK_RESULT(yc_scene_momentum(scene, &mass, linear, NULL), YC_OK);
        CHECK_NEAR(mass / expected, 1.0, 1e-13);
        CHECK_NEAR(linear[1] / (expected * -9.81e-3), 1.0, 1e-8); /* and gravity feels all of it */
        yc_scene_destroy(scene);
    }
    scene_swatch_free(s);
}

/* ---- energy --------------------------------------------------------------------------------------------------- */

/* Largest growth of the total energy in one step of free vibration, as a share of what there was to begin with. */
static double energy_growth(scene_kind kind, int hold_sliding, double gravity, double *lost) {
    scene_swatch_desc d = small(kind);
    scene_swatch *s;
    yc_scene_desc settings = yc_scene_desc_preset(YC_REFERENCE);
    yc_scene *scene;
    double before, start, growth = -HUGE_VAL;
    int step;
    soften(&d);
    s = scene_swatch_new(&d);
    settings.gravity[1] = -gravity, settings.dt_max = 5e-3, settings.linear_tolerance = 1e-4;
    s->cloth.hold_sliding = hold_sliding;
    scene_swatch_place(s, deformed, NULL);
    scene = test_scene_of(&settings, &s->cloth);
    if (!scene) return HUGE_VAL;
    if (gravity != 0.0) CHECK_RESULT(scene_swatch_pin(scene, 0, s, 0.0, d.size[1], NULL), YC_OK);
    set_velocities(scene, s, spinning);
    if (kind == SCENE_MIXED || kind == SCENE_HALF) CHECK_RESULT(yc_scene_step(scene, 1e-4, NULL), YC_OK);
    start = before = energy_of(scene);
    for (step = 0; step < 12; step++) {
        double after;
        if (!CHECK_RESULT(yc_scene_step(scene, 2e-3, NULL), YC_OK)) break;
        after = energy_of(scene);
        growth = fmax(growth, (after - before) / fabs(start));
        before = after;
    }
    *lost = (start - before) / fabs(start);
    yc_scene_destroy(scene);
    scene_swatch_free(s);
    return growth;
}

TEST(scene_physics_energy_never_grows) {
    static const scene_kind kinds[] = {SCENE_TRIANGLES, SCENE_YARNS, SCENE_YARNS_ALONE, SCENE_MIXED, SCENE_HALF};
    int i, hold, gravity;
    for (i = 0; i < 5; i++)
        for (hold = 0; hold < 2; hold++)
            for (gravity = 0; gravity < 2; gravity++) {
                double lost = 0.0;
                if (kinds[i] == SCENE_TRIANGLES && hold) continue;
                CHECK_NEAR(fmax(energy_growth(kinds[i], hold, 9.81 * gravity, &lost), 0.0), 0.0, 1e-9);
                CHECK(lost > 0.0);
            }
}

/* ---- pendulum ------------------------------------------------------------------------------------------------- */

/* The period of a mass at the end of one long segment, by the times between its downward crossings of the vertical. */
static double pendulum_period(double h, double length, double amplitude) {
    yc_yarn_material material = yc_yarn_material_default();
    double from[3] = {0.0, 0.0, 0.0}, to[3], crossing[8] = {0.0};
    scene_chain *chain;
    yc_scene_desc settings = yc_scene_desc_preset(YC_REFERENCE);
    yc_scene *scene;
    int step, found = 0;
    material.stretch = 1e4, material.density = 1e-4, material.bending = 0.0;
    to[0] = length * sin(amplitude), to[1] = -length * cos(amplitude), to[2] = 0.0;
    chain = scene_chain_new(1, length, from, to, &material);
    settings.tolerance = 1e-14, settings.dt_max = 1.0;
    scene = test_scene_of(&settings, &chain->cloth);
    if (scene) {
        double x[2][3] = {{0.0}}, before = to[0];
        CHECK_RESULT(yc_scene_pin(scene, 0, YC_NODE, 0, NULL), YC_OK);
        for (step = 1; found < 3 && step < 20000; step++) {
            if (!CHECK_RESULT(yc_scene_step(scene, h, NULL), YC_OK)) break;
            CHECK_RESULT(yc_scene_positions(scene, 0, YC_NODE, x), YC_OK);
            if (before > 0.0 && x[1][0] <= 0.0) crossing[found++] = h * (step - x[1][0] / (x[1][0] - before));
            before = x[1][0];
        }
    }
    yc_scene_destroy(scene);
    scene_chain_free(chain);
    return CHECK(found == 3) ? 0.5 * (crossing[2] - crossing[0]) : 0.0;
}

/* Backward Euler turns by atan(w h) in a step of an oscillation with frequency w: an error of second order in h. */
TEST(scene_physics_pendulum) {
    double length = 0.2, w = sqrt(9.81 / length), exact = 2.0 * pi / w;
    double coarse = pendulum_period(8e-3, length, 0.02), fine = pendulum_period(4e-3, length, 0.02);
    CHECK_NEAR(coarse, exact * w * 8e-3 / atan(w * 8e-3), 2e-4 * exact);
    CHECK_NEAR(fine, exact * w * 4e-3 / atan(w * 4e-3), 2e-4 * exact);
    CHECK_NEAR((coarse - exact) / (fine - exact), 4.0, 0.5);
    CHECK_NEAR(fine, exact, 1e-3 * exact);
}

/* ---- statics -------------------------------------------------------------------------------------------------- */

static int rest(yc_scene *scene) { return CHECK_RESULT(scene_settle(scene), YC_OK); }

/* The sag of a stiff yarn of 0.3 m between two pins 0.2 m apart. */
static double chain_sag(int pieces, double *pull) {
    yc_yarn_material material = yc_yarn_material_default();
    double sag = 0.0, force[3] = {0.0, 0.0, 0.0};
    scene_chain *chain;
    yc_scene_desc settings = scene_statics(9.81);
    yc_scene *scene;
    int i;
    material.stretch = 1e3, material.density = 1e-3, material.bending = 0.0;
    chain = scene_hung(pieces, 0.3, 0.2, &material);
    scene = test_scene_of(&settings, &chain->cloth);
    if (scene) {
        double(*x)[3] = (double(*)[3])malloc((size_t)(pieces + 1) * sizeof *x);
        CHECK_RESULT(yc_scene_pin(scene, 0, YC_NODE, 0, NULL), YC_OK);
        CHECK_RESULT(yc_scene_pin(scene, 0, YC_NODE, pieces, NULL), YC_OK);
        if (rest(scene)) {
            CHECK_RESULT(yc_scene_positions(scene, 0, YC_NODE, x), YC_OK);
            sag = -x[pieces / 2][1];
            for (i = 0; i <= pieces; i++) CHECK_NEAR(x[i][0], -x[pieces - i][0], 1e-9);
            CHECK_RESULT(yc_scene_pin_force(scene, 0, YC_NODE, pieces, force), YC_OK);
        }
        free(x);
    }
    *pull = force[0];
    yc_scene_destroy(scene);
    scene_chain_free(chain);
    return sag;
}

/* Against the catenary's sag and its horizontal force rho g a. */
TEST(scene_physics_hanging_chain) {
    double a = scene_catenary(0.2, 0.3), sag = a * (cosh(0.1 / a) - 1.0), force = 1e-3 * 9.81 * a, pull[2], found[2];
    found[0] = chain_sag(24, pull), found[1] = chain_sag(48, pull + 1);
    CHECK_NEAR(found[1], sag, 1e-3 * sag);
    CHECK_NEAR(pull[1], force, 2e-3 * force);
    CHECK_NEAR((found[0] - sag) / (found[1] - sag), 4.0, 0.6); /* second order in the length of a piece */
}

/* Tip of an elastica clamped level at s = 0 under its own weight: theta'' = -k (1 - s) cos(theta) for unit length, k =
 * q L^3 / EI; shooting for theta'(1) = 0. Returns the tip's drop. */
static double elastica_drop(double k, double *reach) {
    double low = -20.0, high = 0.0, drop = 0.0;
    int pass, i, n = 2000;
    for (pass = 0; pass < 80; pass++) {
        double theta = 0.0, rate = 0.5 * (low + high), h = 1.0 / n, x = 0.0;
        drop = 0.0;
        for (i = 0; i < n; i++) { /* midpoint rule */
            double s = (double)i / n, middle = theta + 0.5 * h * rate;
            double rate_middle = rate + 0.5 * h * k * (1.0 - s) * cos(theta);
            rate += h * k * (1.0 - s - 0.5 * h) * cos(middle);
            theta += h * rate_middle;
            drop -= h * sin(middle), x += h * cos(middle);
        }
        if (rate > 0.0) high = 0.5 * (low + high);
        else low = 0.5 * (low + high);
        if (reach) *reach = x;
    }
    return drop;
}

/* A yarn clamped by its first two nodes; its free length counts from the middle of the clamped piece, where the hinge
 * of the second node begins to bend. */
static double yarn_cantilever(int pieces, double k, double *reach) {
    yc_yarn_material material = yc_yarn_material_default();
    double piece = 0.1 / (pieces - 0.5), from[3] = {0.0, 0.0, 0.0}, to[3] = {0.0, 0.0, 0.0}, drop = 0.0;
    scene_chain *chain;
    yc_scene_desc settings = scene_statics(9.81);
    yc_scene *scene;
    to[0] = piece * pieces;
    material.stretch = 1e3, material.density = 1e-5;
    material.bending = material.density * 9.81 * 1e-3 / k;
    chain = scene_chain_new(pieces, piece * pieces, from, to, &material);
    scene = test_scene_of(&settings, &chain->cloth);
    if (scene) {
        double(*x)[3] = (double(*)[3])malloc((size_t)(pieces + 1) * sizeof *x);
        CHECK_RESULT(yc_scene_pin(scene, 0, YC_NODE, 0, NULL), YC_OK);
        CHECK_RESULT(yc_scene_pin(scene, 0, YC_NODE, 1, NULL), YC_OK);
        if (rest(scene)) {
            CHECK_RESULT(yc_scene_positions(scene, 0, YC_NODE, x), YC_OK);
            drop = -x[pieces][1] / 0.1, *reach = (x[pieces][0] - 0.5 * piece) / 0.1;
        }
        free(x);
    }
    yc_scene_destroy(scene);
    scene_chain_free(chain);
    return drop;
}

/* The same for a strip of right triangles one cell wide, free to twist. The hinges of a grid feel kxx + kxy along one
 * axis, kyy + kxy along the other and twice kxy across the diagonals, so a free strip bends with 0.8 D: the minimum of
 * (kxx + kxy)^2 + (kyy + kxy)^2 + 4 kxy^2. */
static double strip_cantilever(int cells, double k, double *reach) {
    scene_swatch_desc d = scene_swatch_desc_default(SCENE_TRIANGLES);
    double piece = 0.1 / (cells - 0.5), drop = 0.0;
    scene_swatch *s;
    yc_scene_desc settings = scene_statics(9.81);
    yc_scene *scene;
    int i;
    d.one_way = 1;
    d.cells[0] = cells, d.cells[1] = 1, d.size[0] = piece * cells, d.size[1] = piece;
    d.along_v[1] = 0.0, d.along_v[2] = -1.0;
    s = scene_swatch_new(&d);
    s->cloth.material.bending = s->cloth.material.density * 9.81 * 1e-3 / (0.8 * k);
    scene = test_scene_of(&settings, &s->cloth);
    if (scene) {
        for (i = 0; i < 2; i++) {
            CHECK_RESULT(yc_scene_pin(scene, 0, YC_VERTEX, i * (cells + 1), NULL), YC_OK);
            CHECK_RESULT(yc_scene_pin(scene, 0, YC_VERTEX, i * (cells + 1) + 1, NULL), YC_OK);
        }
        if (rest(scene)) {
            double(*x)[3] = (double(*)[3])malloc((size_t)s->vertex_count * sizeof *x);
            CHECK_RESULT(yc_scene_positions(scene, 0, YC_VERTEX, x), YC_OK);
            drop = -0.5 * (x[cells][1] + x[2 * cells + 1][1]) / 0.1;
            *reach = (0.5 * (x[cells][0] + x[2 * cells + 1][0]) - 0.5 * piece) / 0.1;
            free(x);
        }
    }
    yc_scene_destroy(scene);
    scene_swatch_free(s);
    return drop;
}

TEST(scene_physics_cantilever_yarn) {
    double reach = 0.0, exact_reach = 0.0, drop, exact = elastica_drop(10.0, &exact_reach);
    drop = yarn_cantilever(40, 0.05, &reach);
    CHECK_NEAR(drop, 0.05 / 8.0, 0.005 * 0.05 / 8.0); /* w = q L^4 / (8 EI) */
    drop = yarn_cantilever(40, 10.0, &reach);
    CHECK_NEAR(drop, exact, 5e-3 * exact);
    CHECK_NEAR(reach, exact_reach, 5e-3);
}

TEST(scene_physics_cantilever_strip) {
    double reach = 0.0, exact_reach = 0.0, drop, exact = elastica_drop(10.0, &exact_reach);
    drop = strip_cantilever(40, 0.05, &reach);
    CHECK_NEAR(drop, 0.05 / 8.0, 0.015 * 0.05 / 8.0);
    drop = strip_cantilever(40, 10.0, &reach);
    CHECK_NEAR(drop, exact, 0.02 * exact);
    CHECK_NEAR(reach, exact_reach, 0.02);
}

/* Pins carry the weight, whatever the mechanics below them; but enrich_all leaves triangles without weight, so that
 * there only pins on yarn nodes hold anything. */
TEST(scene_physics_pins_carry_the_weight) {
    int kind, i;
    for (kind = 0; kind < SCENE_ENRICHED; kind++) {
        scene_swatch_desc d = small((scene_kind)kind);
        scene_swatch *s = scene_swatch_new(&d);
        yc_scene_desc settings = scene_statics(9.81);
        yc_scene *scene;
        double mass = 0.0, force[3], sum[3] = {0.0, 0.0, 0.0};
        settings.dt_max = 0.02, settings.mass_damping = 20.0, settings.tolerance = 1e-9;
        scene = test_scene_of(&settings, &s->cloth);
        if (scene) {
            for (i = 0; i < 3; i++)
                CHECK_RESULT(scene_swatch_pin(scene, 0, s, d.size[0] * i / 2, d.size[1], NULL), YC_OK);
            for (i = 0; i < 60; i++)
                if (!CHECK_RESULT(yc_scene_step(scene, 0.02, NULL), YC_OK)) break;
            CHECK_RESULT(yc_scene_momentum(scene, &mass, NULL, NULL), YC_OK);
            for (i = 0; i < 3; i++) {
                int point = scene_swatch_nearest(s, d.size[0] * i / 2, d.size[1]), k;
                CHECK_RESULT(yc_scene_pin_force(scene, 0, s->vertex_count ? YC_VERTEX : YC_NODE, point, force), YC_OK);
                for (k = 0; k < 3; k++) sum[k] += force[k];
            }
            CHECK_NEAR(sum[1] / (mass * 9.81), 1.0, 0.01);
            CHECK_NEAR(sum[0] / (mass * 9.81), 0.0, 0.01);
        }
        yc_scene_destroy(scene);
        scene_swatch_free(s);
    }
}

/* ---- damping -------------------------------------------------------------------------------------------------- */

/* A swatch that spins rigidly: with and without stiffness damping it keeps the same angular momentum. */
TEST(scene_physics_stiffness_damping_spares_rotation) {
    static const scene_kind kinds[] = {SCENE_TRIANGLES, SCENE_YARNS, SCENE_MIXED};
    int i, damped, step;
    for (i = 0; i < 3; i++) {
        double spin[2], still[2], before = 0.0;
        for (damped = 0; damped < 2; damped++) {
            scene_swatch_desc d = small(kinds[i]);
            scene_swatch *s = scene_swatch_new(&d);
            yc_scene_desc settings = yc_scene_desc_preset(YC_REFERENCE);
            yc_scene *scene;
            double angular[3], terms[YC_TERM_COUNT];
            memset(settings.gravity, 0, sizeof settings.gravity);
            settings.stiffness_damping = damped ? 0.05 : 0.0, settings.dt_max = 1e-3;
            s->cloth.hold_sliding = 1;
            scene = test_scene_of(&settings, &s->cloth);
            if (scene) {
                set_velocities(scene, s, spinning);
                CHECK_RESULT(yc_scene_momentum(scene, NULL, NULL, angular), YC_OK);
                before = angular[2];
                for (step = 0; step < 50; step++) CHECK_RESULT(yc_scene_step(scene, 1e-3, NULL), YC_OK);
                CHECK_RESULT(yc_scene_momentum(scene, NULL, NULL, angular), YC_OK);
                spin[damped] = angular[2] / before;
                CHECK_RESULT(yc_scene_energy(scene, terms), YC_OK);
                still[damped] = terms[YC_TERM_KINETIC];
            } else spin[damped] = still[damped] = 0.0;
            yc_scene_destroy(scene);
            scene_swatch_free(s);
        }
        CHECK(spin[1] > 0.9);
        CHECK_NEAR(spin[1], spin[0], 0.01);
        CHECK_NEAR(still[1] / still[0], 1.0, 0.02);
    }
}

/* A mass on one piece of yarn that hangs from nothing but a pin, along its axis: backward Euler with the damper beta k,
 * step by step. */
TEST(scene_physics_stiffness_damping_of_a_spring) {
    yc_yarn_material material = yc_yarn_material_default();
    double from[3] = {0.0, 0.0, 0.0}, to[3] = {0.101, 0.0, 0.0}, x[2][3], h = 1e-3, beta = 4e-3;
    double mass, k, stretch = 1e-3, v = 0.0;
    scene_chain *chain;
    yc_scene_desc settings = tight();
    yc_scene *scene;
    int step;
    material.density = 1e-3, material.stretch = 0.3, material.bending = 0.0;
    chain = scene_chain_new(1, 0.1, from, to, &material);
    memset(settings.gravity, 0, sizeof settings.gravity);
    settings.stiffness_damping = beta;
    mass = 0.5 * 1e-3 * 0.1, k = 0.3 / 0.1;
    scene = test_scene_of(&settings, &chain->cloth);
    if (scene) {
        CHECK_RESULT(yc_scene_pin(scene, 0, YC_NODE, 0, NULL), YC_OK);
        for (step = 0; step < 40; step++) {
            if (!CHECK_RESULT(yc_scene_step(scene, h, NULL), YC_OK)) break;
            v = (v - h * k / mass * stretch) / (1.0 + h * (h + beta) * k / mass);
            stretch += h * v;
            CHECK_RESULT(yc_scene_positions(scene, 0, YC_NODE, x), YC_OK);
            CHECK_NEAR(x[1][0], 0.1 + stretch, 1e-12);
        }
    }
    yc_scene_destroy(scene);
    scene_chain_free(chain);
}

/* ... and whole cloths come to rest sooner. */
TEST(scene_physics_stiffness_damping_damps_vibration) {
    static const scene_kind kinds[] = {SCENE_TRIANGLES, SCENE_YARNS, SCENE_MIXED};
    int i, damped, step;
    for (i = 0; i < 3; i++) {
        double left[2] = {0.0, 0.0};
        for (damped = 0; damped < 2; damped++) {
            scene_swatch_desc d = small(kinds[i]);
            scene_swatch *s;
            yc_scene_desc settings = yc_scene_desc_preset(YC_REFERENCE);
            yc_scene *scene;
            soften(&d);
            s = scene_swatch_new(&d);
            memset(settings.gravity, 0, sizeof settings.gravity);
            settings.stiffness_damping = damped ? 2e-3 : 0.0;
            s->cloth.hold_sliding = 1;
            scene_swatch_place(s, deformed, NULL);
            scene = test_scene_of(&settings, &s->cloth);
            if (scene) {
                for (step = 0; step < 60; step++) CHECK_RESULT(yc_scene_step(scene, 2e-4, NULL), YC_OK);
                left[damped] = energy_of(scene);
            }
            yc_scene_destroy(scene);
            scene_swatch_free(s);
        }
        CHECK(left[1] < 0.8 * left[0]);
    }
}
