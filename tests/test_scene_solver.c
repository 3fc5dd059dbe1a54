/* The solvers against each other, in the papers' scenes. */
#include "scenes/knits.h"
#include "scenes/scenes.h"
#include "test.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SMOOTHERS = YC_SMOOTHER_NONE + 1 };

typedef struct swing {
    int levels;
    yc_smoother smoother;
    double dt, stretch, linear_tolerance; /* stretch: times the swing's own */
    const yc_host *host;
} swing;

static swing swing_of(int levels, yc_smoother smoother) {
    swing w = {0, YC_SMOOTHER_INCOMPLETE, 1e-4, 1.0, 1e-6, NULL};
    w.levels = levels, w.smoother = smoother;
    return w;
}

/* One step of the swing (MIX Fig. 2) after a few that have brought it into motion; positions of all yarn nodes. */
static double (*swing_step(swing w, yc_stats *stats, int *count))[3] {
    scene_swatch *s = scene_swing(SCENE_MIXED, 5);
    yc_scene_desc settings = yc_scene_desc_preset(YC_REFERENCE);
    yc_scene *scene = NULL;
    double(*x)[3];
    int i;
    s->yarns.materials[0].stretch *= w.stretch;
    settings.linear_tolerance = w.linear_tolerance, settings.linear_limit = 20000, settings.dt_max = 1.0;
    settings.solver = w.levels == 2 ? YC_SOLVER_TWO_LEVEL : YC_SOLVER_ONE_LEVEL, settings.smoother = w.smoother;
    settings.tolerance = 1e-10;
    CHECK_RESULT(yc_scene_create(w.host, &settings, &scene, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_cloth(scene, &s->cloth, NULL), YC_OK);
    for (i = 0; i <= s->desc.cells[0]; i++) CHECK_RESULT(yc_scene_pin(scene, 0, YC_VERTEX, i, NULL), YC_OK);
    for (i = 0; i < 4; i++) CHECK_RESULT(yc_scene_step(scene, w.dt, stats), YC_OK);
    *count = s->yarns.node_count;
    x = (double(*)[3])malloc((size_t)*count * sizeof *x);
    CHECK_RESULT(yc_scene_positions(scene, 0, YC_NODE, x), YC_OK);
    yc_scene_destroy(scene);
    scene_swatch_free(s);
    return x;
}

static double per_newton(const yc_stats *stats) { return (double)stats->linear / (double)stats->newton; }

/* Every smoother, alone and with the coarse space, and on three workers bit for bit. */
TEST(scene_solver_all_give_the_same_step) {
    double(*x)[3], (*y)[3], (*expected)[3];
    swing w = swing_of(2, YC_SMOOTHER_INCOMPLETE);
    yc_stats stats;
    yc_host three = test_host_threads(3);
    int k, count;
    w.linear_tolerance = 1e-8;
    expected = swing_step(w, &stats, &count);
    for (w.levels = 1; w.levels <= 2; w.levels++)
        for (k = 0; k < SMOOTHERS; k++) {
            w.smoother = (yc_smoother)k;
            w.host = NULL, x = swing_step(w, &stats, &count);
            w.host = &three, y = swing_step(w, &stats, &count);
            CHECK_NEAR_ALL(&x[0][0], &expected[0][0], 3 * count, 1e-9);
            CHECK(memcmp(x, y, (size_t)count * sizeof *x) == 0);
            CHECK(stats.solver == (w.levels == 2 ? YC_SOLVER_TWO_LEVEL : YC_SOLVER_ONE_LEVEL));
            free(x), free(y);
        }
    free(expected);
}

/* Yarns that slide, in a net: every smoother comes where the direct factor does. */
TEST(scene_solver_smoothers_are_direct_on_yarns) {
    double(*x)[3], (*expected)[3] = NULL;
    int levels, k, step;
    for (levels = 0; levels <= 2; levels++)
        for (k = 0; k < (levels ? SMOOTHERS : 1); k++) {
            scene_swatch *s = scene_swing(SCENE_YARNS_ALONE, 1);
            yc_scene_desc settings = yc_scene_desc_preset(YC_REFERENCE);
            yc_scene *scene = NULL;
            settings.tolerance = 1e-10, settings.linear_tolerance = 1e-8, settings.linear_limit = 20000;
            settings.solver = levels == 2 ? YC_SOLVER_TWO_LEVEL : levels ? YC_SOLVER_ONE_LEVEL : YC_SOLVER_DIRECT;
            settings.smoother = (yc_smoother)k;
            CHECK_RESULT(yc_scene_create(NULL, &settings, &scene, NULL), YC_OK);
            CHECK_RESULT(yc_scene_add_cloth(scene, &s->cloth, NULL), YC_OK);
            CHECK_RESULT(scene_swatch_pin(scene, 0, s, 0.0, 0.0, NULL), YC_OK);
            for (step = 0; step < 2; step++) CHECK_RESULT(yc_scene_step(scene, 1e-3, NULL), YC_OK);
            x = (double(*)[3])malloc((size_t)s->yarns.node_count * sizeof *x);
            CHECK_RESULT(yc_scene_positions(scene, 0, YC_NODE, x), YC_OK);
            if (expected) CHECK_NEAR_ALL(&x[0][0], &expected[0][0], 3 * s->yarns.node_count, 1e-8);
            if (expected) free(x);
            else expected = x;
            yc_scene_destroy(scene), scene_swatch_free(s);
        }
    free(expected);
}

/* What a scene of this kind says to a solver and a smoother. */
static void check_refused(
    scene_kind kind, yc_solver solver, yc_smoother smoother, yc_result expected, const char *name) {
    scene_swatch_desc d = scene_swatch_desc_default(kind);
    scene_swatch *s = scene_swatch_new(&d);
    yc_scene_desc settings = yc_scene_desc_default();
    yc_scene *scene = NULL;
    char why[YC_MESSAGE_SIZE] = "";
    yc_result result;
    settings.solver = solver, settings.smoother = smoother;
    result = yc_scene_create(NULL, &settings, &scene, why);
    if (scene) {
        CHECK_RESULT(yc_scene_add_cloth(scene, &s->cloth, NULL), YC_OK);
        result = yc_scene_step(scene, 1e-3, NULL);
        snprintf(why, sizeof why, "%s", yc_scene_message(scene));
    }
    CHECK(result == expected && strstr(why, name));
    yc_scene_destroy(scene), scene_swatch_free(s);
}

TEST(scene_solver_names_what_it_refuses) {
    const yc_result no = YC_ERROR_ARGUMENT;
    check_refused(SCENE_YARNS, YC_SOLVER_DIRECT, YC_SMOOTHER_LINE, no, "scene.smoother");
    check_refused(SCENE_YARNS, YC_SOLVER_AUTO, YC_SMOOTHER_NONE, no, "scene.smoother");
    check_refused(SCENE_YARNS, YC_SOLVER_TWO_LEVEL, (yc_smoother)SMOOTHERS, no, "scene.smoother");
    check_refused(SCENE_YARNS, (yc_solver)(YC_SOLVER_ONE_LEVEL + 1), YC_SMOOTHER_INCOMPLETE, no, "scene.solver");
    check_refused(SCENE_TRIANGLES, YC_SOLVER_ONE_LEVEL, YC_SMOOTHER_LINE, no, "YC_SMOOTHER_LINE");
    check_refused(SCENE_TRIANGLES, YC_SOLVER_ONE_LEVEL, YC_SMOOTHER_BLOCK, YC_OK, "");
    check_refused(SCENE_HALF, YC_SOLVER_DIRECT, YC_SMOOTHER_INCOMPLETE, no, "scene.solver");
}

/* MIX's own regime: Y = 1e7, 0.1 ms. */
TEST(scene_solver_mass_in_its_regime) {
    yc_stats none, mass, dense;
    double(*a)[3], (*b)[3], (*c)[3];
    int count;
    a = swing_step(swing_of(1, YC_SMOOTHER_NONE), &none, &count);
    b = swing_step(swing_of(1, YC_SMOOTHER_MASS), &mass, &count);
    c = swing_step(swing_of(1, YC_SMOOTHER_MASS_DENSE), &dense, &count);
    CHECK(5.0 * per_newton(&mass) <= per_newton(&none));
    CHECK_NEAR((double)dense.linear, (double)mass.linear, (double)mass.newton);
    CHECK_NEAR_ALL(&c[0][0], &b[0][0], 3 * count, 1e-8);
    free(a), free(b), free(c);
}

TEST(scene_solver_two_level_when_stiff) {
    yc_stats two, mass;
    double(*a)[3], (*b)[3];
    swing w = swing_of(2, YC_SMOOTHER_INCOMPLETE);
    int count;
    w.dt = 2e-3, w.stretch = 10.0;
    a = swing_step(w, &two, &count);
    w.levels = 1, w.smoother = YC_SMOOTHER_MASS;
    b = swing_step(w, &mass, &count);
    CHECK(per_newton(&two) <= per_newton(&mass));
    CHECK_NEAR_ALL(&a[0][0], &b[0][0], 3 * count, 1e-7);
    free(a), free(b);
}

/* Steps of a knit that hangs; the nodes afterwards. */
static double (*curtain_steps(yc_solver solver, int stitches, double dt, int steps, yc_stats *stats, int *count))[3] {
    yc_scene_desc settings = yc_scene_desc_default();
    yc_knit_desc knit = yc_knit_desc_default();
    char why[YC_MESSAGE_SIZE] = "";
    double(*x)[3] = NULL;
    scene_curtain *curtain;
    settings.solver = solver, settings.dt_max = dt, settings.tolerance = 1e-7;
    knit.stitches = knit.rows = stitches;
    curtain = scene_curtain_new(NULL, &settings, scene_stockinette, &knit, why);
    memset(stats, 0, sizeof *stats);
    if (!CHECK(curtain != NULL)) return NULL;
    while (steps-- > 0) CHECK_RESULT(yc_scene_step(curtain->scene, dt, stats), YC_OK);
    *count = curtain->yarns.node_count;
    x = (double(*)[3])malloc((size_t)*count * sizeof *x);
    CHECK_RESULT(yc_scene_positions(curtain->scene, 0, YC_NODE, x), YC_OK);
    scene_curtain_free(curtain);
    return x;
}

/* A step of 1 ms from where the yarns' wrapping is out of balance, which takes line searches: by incomplete factors in
 * about as many iterations of Newton's method as by direct ones, and few of conjugate gradients each. Without fill,
 * course by course or with shifts from 1e-3 up these are 60 and more. */
TEST(scene_solver_knit_two_levels_are_direct) {
    yc_stats direct, two;
    double(*a)[3], (*b)[3];
    int count = 0;
    a = curtain_steps(YC_SOLVER_DIRECT, 12, 1e-3, 3, &direct, &count);
    b = curtain_steps(YC_SOLVER_TWO_LEVEL, 12, 1e-3, 3, &two, &count);
    CHECK(two.solver == YC_SOLVER_TWO_LEVEL && two.substeps == 1);
    CHECK(two.newton <= 2 * direct.newton && two.linear <= 20 * two.newton);
    if (a && b) CHECK_NEAR_ALL(&a[0][0], &b[0][0], 3 * count, 1e-6);
    free(a), free(b);
}

/* A knit above the limit of direct solves. */
TEST(scene_solver_knit_large) {
    yc_stats stats;
    int count = 0;
    double(*x)[3] = curtain_steps(YC_SOLVER_AUTO, 71, 1e-4, 1, &stats, &count);
    CHECK(count > 20000 && stats.solver == YC_SOLVER_TWO_LEVEL && stats.substeps == 1 && stats.rejected == 0);
    CHECK(stats.correction <= 1e-7 && stats.newton <= 12 && stats.linear <= 12 * stats.newton);
    free(x);
}

/* MIX Fig. 3: an enriched patch moves like full yarns whose u is held. */
static void check_shear(yc_solver solver, yc_smoother smoother, int steps) {
    scene_swatch_desc d = scene_swatch_desc_default(SCENE_ENRICHED);
    scene_swatch *s[2];
    yc_scene *scene[2] = {NULL, NULL};
    double(*x[2])[3], moved = 0.0;
    int i, k, step;
    d.cells[0] = d.cells[1] = 3, d.size[0] = d.size[1] = 0.03;
    for (i = 0; i < 2; i++) {
        yc_scene_desc settings = yc_scene_desc_preset(YC_REFERENCE);
        d.kind = i ? SCENE_YARNS : SCENE_ENRICHED;
        s[i] = scene_swatch_new(&d);
        s[i]->cloth.hold_sliding = 1;
        settings.tolerance = 1e-10, settings.linear_tolerance = 1e-8, settings.solver = i ? YC_SOLVER_DIRECT : solver;
        settings.smoother = i ? YC_SMOOTHER_INCOMPLETE : smoother;
        settings.dt_max = 1.0, settings.linear_limit = 20000;
        CHECK_RESULT(yc_scene_create(NULL, &settings, &scene[i], NULL), YC_OK);
        CHECK_RESULT(yc_scene_add_cloth(scene[i], &s[i]->cloth, NULL), YC_OK);
        CHECK_RESULT(scene_shear(scene[i], 0, s[i], 0.0), YC_OK);
        x[i] = (double(*)[3])malloc((size_t)s[i]->yarns.node_count * sizeof *x[i]);
    }
    for (step = 1; step <= steps; step++)
        for (i = 0; i < 2; i++) {
            CHECK_RESULT(scene_shear(scene[i], 0, s[i], 0.01 * step / steps), YC_OK);
            if (!CHECK_RESULT(yc_scene_step(scene[i], 1e-3, NULL), YC_OK)) step = steps;
        }
    for (i = 0; i < 2; i++) CHECK_RESULT(yc_scene_positions(scene[i], 0, YC_NODE, x[i]), YC_OK);
    CHECK_NEAR_ALL(&x[0][0][0], &x[1][0][0], 3 * s[0]->yarns.node_count, 1e-6 * d.size[0]);
    for (i = 0; i < s[0]->yarns.node_count; i++)
        for (k = 0; k < 3; k++) moved = fmax(moved, fabs(x[0][i][k] - s[0]->nodes[i][k]));
    CHECK(moved > 4e-3);
    for (i = 0; i < 2; i++) free(x[i]), yc_scene_destroy(scene[i]), scene_swatch_free(s[i]);
}

TEST(scene_solver_enriched_equals_yarns) { check_shear(YC_SOLVER_TWO_LEVEL, YC_SMOOTHER_INCOMPLETE, 50); }
TEST(scene_solver_enriched_equals_yarns_by_mass) { check_shear(YC_SOLVER_ONE_LEVEL, YC_SMOOTHER_MASS, 10); }

/* Default settings, a swatch hung by two corners: the work of its first 0.1 s. */
TEST(scene_solver_effort_stays_in_bounds) {
    static const scene_kind kinds[] = {SCENE_TRIANGLES, SCENE_YARNS, SCENE_YARNS_ALONE, SCENE_MIXED};
    int i, step;
    for (i = 0; i < 4; i++) {
        scene_swatch_desc d = scene_swatch_desc_default(kinds[i]);
        scene_swatch *s;
        yc_scene_desc settings = yc_scene_desc_default();
        yc_scene *scene = NULL;
        yc_stats stats;
        int newton = 0, linear = 0, substeps = 0, rejected = 0;
        if (kinds[i] != SCENE_MIXED) d.cells[0] = d.cells[1] = 3, d.size[0] = d.size[1] = 0.03;
        s = scene_swatch_new(&d);
        CHECK_RESULT(yc_scene_create(NULL, &settings, &scene, NULL), YC_OK);
        CHECK_RESULT(yc_scene_add_cloth(scene, &s->cloth, NULL), YC_OK);
        CHECK_RESULT(scene_swatch_pin(scene, 0, s, 0.0, d.size[1], NULL), YC_OK);
        CHECK_RESULT(scene_swatch_pin(scene, 0, s, d.size[0], d.size[1], NULL), YC_OK);
        for (step = 0; step < 20; step++) {
            CHECK_RESULT(yc_scene_step(scene, 5e-3, &stats), YC_OK);
            newton += stats.newton, linear += stats.linear, substeps += stats.substeps, rejected += stats.rejected;
        }
        CHECK(newton <= 20 * substeps);
        CHECK(rejected <= 2);
        CHECK(linear <= 60 * newton);
        yc_scene_destroy(scene);
        scene_swatch_free(s);
    }
}

/* A flap of yarns held along one edge swings down: segments turn by a third of a radian in a step, which the tension
 * of a linear step would forbid. At 1 ms free flight and the tension of the step before leave one iteration to do. The
 * last step is longer than the whole swing. */
TEST(scene_solver_turning_yarns_take_few_iterations) {
    static const double h[] = {1e-3, 5e-3, 0.1};
    int i, k, step;
    for (i = 0; i < 3; i++) {
        scene_swatch_desc d = scene_swatch_desc_default(SCENE_YARNS_ALONE);
        scene_swatch *s;
        yc_scene_desc settings = yc_scene_desc_default();
        yc_scene *scene = NULL;
        yc_stats stats;
        int newton = 0, substeps = 0, rejected = 0, steps = i < 2 ? 20 : 3;
        d.size[0] = d.size[1] = 0.04, d.spacing = 2e-3, d.along_v[1] = 0.0, d.along_v[2] = -1.0;
        s = scene_swatch_new(&d);
        settings.dt_max = h[i];
        CHECK_RESULT(yc_scene_create(NULL, &settings, &scene, NULL), YC_OK);
        CHECK_RESULT(yc_scene_add_cloth(scene, &s->cloth, NULL), YC_OK);
        for (k = 0; k < s->yarns.node_count; k++)
            if (s->yarns.layout[k][1] < d.spacing) CHECK_RESULT(yc_scene_pin(scene, 0, YC_NODE, k, NULL), YC_OK);
        for (step = 0; step < steps; step++) {
            if (!CHECK_RESULT(yc_scene_step(scene, h[i], &stats), YC_OK)) break;
            newton += stats.newton, substeps += stats.substeps, rejected += stats.rejected;
        }
        CHECK(2 * newton <= (i < 1 ? 3 : i < 2 ? 8 : 40) * substeps);
        CHECK(rejected <= (i < 2 ? 0 : 4));
        yc_scene_destroy(scene);
        scene_swatch_free(s);
    }
}
