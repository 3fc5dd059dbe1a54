/* A swatch of yarns alone through wide ranges of its inputs: pulled by its ends, brought together so that it folds
 * under gravity, let go. Every case has to converge to its tolerance; a table says what that took. The inputs are those
 * of the default yarn, without crimp and with it, and of the woven presets, one or all of them away from there. And the
 * tensile test at three time steps. */
#include "scenes/scenes.h"
#include "test_scene.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- one case ------------------------------------------------------------------------------------------------- */

typedef struct swatch {
    yc_weave_desc weave;
    yc_yarns yarns;
    yc_scene *scene;
} swatch;

/* What ranges start from: the default yarn, straight and 2.5 mm apart, or with crimp, where heights must fit the
 * radius, 0.3 mm; behind these the woven presets, with theirs. */
enum { STRAIGHT, CRIMPED, SHIRTING, BASES = SHIRTING + 4 };

static yc_weave_desc weave_of(int base) {
    yc_weave_desc d = yc_weave_desc_default();
    if (base >= SHIRTING) {
        yc_fabric f;
        if (CHECK_RESULT(yc_fabric_get((yc_fabric_name)(YC_FABRIC_SHIRTING + base - SHIRTING), &f), YC_OK)) d = f.weave;
        d.warp.strength = d.weft.strength = 0.0; /* stiff yarns, drawn to 4 %, would break */
        return d;
    }
    d.spacing[0] = d.spacing[1] = base == CRIMPED ? 3e-4 : 2.5e-3;
    d.crimp[0] = base == CRIMPED ? 0.06 : 0.0, d.crimp[1] = base == CRIMPED ? 0.04 : 0.0;
    return d;
}

/* 10 x 10 crossings. `pressed`: the share of a spacing by which its halves stand closer than they were woven. */
static int swatch_new(swatch *w, const yc_weave_desc *weave, const yc_scene_desc *settings, double pressed) {
    yc_cloth_desc cloth = yc_cloth_desc_default();
    char why[YC_MESSAGE_SIZE];
    double(*x)[3];
    int i, ok;
    memset(w, 0, sizeof *w);
    w->weave = *weave;
    w->weave.size[0] = 10.0 * weave->spacing[0], w->weave.size[1] = 10.0 * weave->spacing[1];
    if (!CHECK_RESULT(yc_weave(NULL, &w->weave, NULL, &w->yarns, why), YC_OK)) return 0;
    x = (double(*)[3])malloc((size_t)w->yarns.node_count * sizeof *x);
    for (i = 0; x && i < w->yarns.node_count; i++) {
        memcpy(x[i], w->yarns.layout[i], sizeof *x);
        x[i][0] += (x[i][0] < 0.5 * w->weave.size[0] ? 0.5 : -0.5) * pressed * weave->spacing[0];
    }
    cloth.yarns = &w->yarns, cloth.yarn_positions = (const double(*)[3])x;
    ok = CHECK_RESULT(yc_scene_create(NULL, settings, &w->scene, why), YC_OK) &&
        CHECK_RESULT(yc_scene_add_cloth(w->scene, &cloth, NULL), YC_OK);
    free(x);
    return ok;
}

static void swatch_free(swatch *w) { yc_scene_destroy(w->scene), yc_yarns_destroy(&w->yarns); }

/* -1 at the yarn ends at u = 0, 1 at those opposite, 0 elsewhere. */
static int side_of(const swatch *w, int node) {
    double u = w->yarns.layout[node][0], width = w->weave.size[0];
    return u < 1e-6 * width ? -1 : u > (1.0 - 1e-6) * width ? 1 : 0;
}

static void draw(swatch *w, double strain) {
    int i;
    for (i = 0; i < w->yarns.node_count; i++) {
        double to[3];
        memcpy(to, w->yarns.layout[i], sizeof to);
        to[0] += side_of(w, i) * 0.5 * strain * w->weave.size[0];
        if (side_of(w, i)) CHECK_RESULT(yc_scene_pin(w->scene, 0, YC_NODE, i, to), YC_OK);
    }
}

/* To 4 %, together by 10 %, and one side let go, in steps of dt. */
static void run_case(const yc_weave_desc *weave, double dt, test_effort *sum) {
    yc_scene_desc settings = yc_scene_desc_default();
    swatch w;
    yc_stats stats;
    int i, step, substeps = sum->substeps, rejected = sum->rejected;
    settings.gravity[1] = 0.0, settings.gravity[2] = -9.81;
    settings.dt_max = dt, settings.tolerance = 4e-3 * weave->spacing[0]; /* the default at 2.5 mm */
    for (step = swatch_new(&w, weave, &settings, 0.0) ? 0 : 30; step < 30; step++) {
        if (step < 12) draw(&w, 0.04 * (step + 1) / 12.0);
        else if (step < 24) draw(&w, 0.04 - 0.14 * (step - 11) / 12.0);
        for (i = 0; step == 24 && i < w.yarns.node_count; i++)
            if (side_of(&w, i) > 0) CHECK_RESULT(yc_scene_unpin(w.scene, 0, YC_NODE, i), YC_OK);
        if (!CHECK_RESULT(yc_scene_step(w.scene, dt, &stats), YC_OK)) break;
        test_effort_add(sum, &stats, settings.tolerance);
    }
    CHECK(test_is_finite(w.scene));
    CHECK(sum->rejected - rejected <= sum->substeps - substeps);
    sum->cases++;
    swatch_free(&w);
}

/* ---- ranges --------------------------------------------------------------------------------------------------- */

typedef enum group {
    STRETCH,
    BENDING,
    SHEAR,
    CONTACT,
    SLIDE,
    FLATTENING,
    ALL_STIFFNESS,
    RADIUS,
    RADIUS_ALONE,
    FRICTION,
    FRICTION_PRELOAD,
    TIME_STEP,
    FINE, /* all stiffness, at a time step of 0.1 ms */
    GROUPS
} group;

#define MOST_VALUES 5
static const struct range {
    const char *name;
    int count;
    double value[MOST_VALUES];
} ranges[GROUPS] = {
    {"stretch, times the preset", 4, {1e-3, 0.1, 10.0, 1e3, 0.0}},
    {"bending, times the preset", 4, {1e-3, 0.1, 10.0, 1e3, 0.0}},
    {"shear, times the preset", 4, {1e-3, 0.1, 10.0, 1e3, 0.0}},
    {"contact, times the preset", 4, {1e-3, 0.1, 10.0, 1e3, 0.0}},
    {"slide, times the preset", 4, {1e-3, 0.1, 10.0, 1e3, 0.0}},
    {"flattening, times preset", 4, {1e-3, 0.1, 10.0, 1e3, 0.0}},
    {"all six of them", 4, {1e-3, 0.1, 10.0, 1e3, 0.0}},
    {"radius, m, spacing with it", 4, {1e-5, 1e-4, 1e-3, 1e-2, 0.0}},
    {"radius, m, alone", 4, {1e-5, 1e-4, 1e-3, 1e-2, 0.0}},
    {"friction", 4, {0.0, 0.3, 1.0, 2.0, 0.0}},
    {"friction, preload 20 mN", 4, {0.0, 0.3, 1.0, 2.0, 0.0}},
    {"time step, s", 5, {1e-6, 1e-4, 1e-3, 5e-3, 0.1}},
    {"all six, at 0.1 ms", 2, {1e-3, 1e3, 0.0, 0.0, 0.0}},
};

static void change_yarn(yc_yarn_material *m, group g, double value) {
    int all = g == ALL_STIFFNESS || g == FINE;
    if (g == STRETCH || all) m->stretch *= value;
    if (g == BENDING || all) m->bending *= value, m->crimp_bending *= value;
    if (g == SHEAR || all) m->shear *= value;
    if (g == CONTACT || all) m->contact *= value;
    if (g == SLIDE || all) m->slide *= value;
    if (g == FLATTENING || all) m->flattening *= value;
    if (g == RADIUS || g == RADIUS_ALONE) m->radius = value;
    if (g == FRICTION || g == FRICTION_PRELOAD) m->friction = value;
    if (g == FRICTION_PRELOAD) m->preload = 0.02;
}

/* The default yarn keeps its shape: for ranges of flattening it gets what it has in a shirting. */
static void run_value(group g, int base, double value, test_effort *sum) {
    yc_weave_desc d = weave_of(base);
    int k;
    if (g == RADIUS)
        for (k = 0; k < 2; k++) d.spacing[k] *= value / d.warp.radius;
    if (g == FLATTENING && base < SHIRTING) d.warp.flattening = d.weft.flattening = weave_of(SHIRTING).warp.flattening;
    change_yarn(&d.warp, g, value), change_yarn(&d.weft, g, value);
    run_case(&d, g == TIME_STEP ? value : g == FINE ? 1e-4 : 5e-3, sum);
}

static void run_range(int g, int base) {
    const struct range *r = ranges + g;
    test_effort sum;
    int i, step = base < SHIRTING ? 1 : r->count - 1; /* of presets the ends alone */
    memset(&sum, 0, sizeof sum);
    for (i = 0; i < r->count; i += step) run_value((group)g, base, r->value[i], &sum);
    printf("   %-27s %7.0e .. %-7.0e  %23.1f %6.1f  %8d of %d\n", r->name, r->value[0], r->value[r->count - 1],
        (double)sum.newton / sum.substeps, sum.worst, sum.rejected, sum.substeps);
}

static void run_ranges(int base) {
    static const char *const names[BASES] = {"without crimp", "with crimp", "shirting", "linen", "denim", "satin"};
    int g;
    printf("   %-27s %-17s  Newton a sub-step: mean, worst  rejected of sub-steps\n", names[base], "range");
    for (g = 0; g < GROUPS; g++)
        if (base != STRAIGHT || g != FLATTENING) run_range(g, base); /* straight yarns do not flatten */
}

TEST(woven_extremes_straight) { run_ranges(STRAIGHT); }
TEST(woven_extremes_crimped) { run_ranges(CRIMPED); }
TEST(woven_extremes_shirting) { run_ranges(SHIRTING); }
TEST(woven_extremes_linen) { run_ranges(SHIRTING + 1); }
TEST(woven_extremes_denim) { run_ranges(SHIRTING + 2); }
TEST(woven_extremes_satin) { run_ranges(SHIRTING + 3); }

/* Yarns that start with a segment pressed by 4 N, as where a mesh is creased, and whose crossings slide freely: it
 * loses energy by handing its rest length on, for which a direction would take more than there is. */
TEST(woven_extremes_creased) {
    yc_weave_desc d = weave_of(STRAIGHT);
    yc_scene_desc settings = yc_scene_desc_default();
    swatch w;
    int step, newton = 0, substeps = 0, rejected = 0;
    d.warp.density = 1.4e-4, d.warp.stretch = 10.0, d.warp.bending = 2e-8, d.warp.shear = 0.034;
    d.warp.radius = 5.5e-4, d.warp.contact = 1.0, d.weft = d.warp;
    settings.gravity[1] = 0.0, settings.dt_max = 1.0 / 60.0, settings.tolerance = 1e-4, settings.mass_damping = 4.0;
    for (step = swatch_new(&w, &d, &settings, 0.4) ? 0 : 8; step < 8; step++) {
        yc_stats stats;
        if (!CHECK_RESULT(yc_scene_step(w.scene, 1.0 / 60.0, &stats), YC_OK)) break;
        newton += stats.newton, substeps += stats.substeps, rejected += stats.rejected;
    }
    printf("   creased: %d sub-steps, %d rejected, %d Newton iterations\n", substeps, rejected, newton);
    CHECK(test_is_finite(w.scene));
    CHECK(rejected == 0 && newton <= 20);
    swatch_free(&w);
}

/* Long steps without friction: that yarns slide through one another costs less than rounding, so the matrix has no
 * factor, and what Newton's method corrects is noise. */
TEST(woven_extremes_free_sliding) {
    static const double tolerance[3] = {1e-6, 1e-8, 1e-10};
    yc_weave_desc d = weave_of(STRAIGHT);
    yc_scene_desc settings = yc_scene_desc_preset(YC_REFERENCE);
    int i, k, step;
    d.warp.friction = d.weft.friction = 0.0;
    settings.dt_max = 1e3, settings.dt_min = 100.0, settings.mass_damping = 1.0;
    memset(settings.gravity, 0, sizeof settings.gravity);
    for (k = 0; k < 3; k++) {
        swatch w;
        int newton = 0, rejected = 0;
        settings.tolerance = tolerance[k];
        for (step = swatch_new(&w, &d, &settings, 0.0) ? 1 : 7; step <= 6; step++) {
            yc_stats stats;
            double force = 0.0, f[3];
            draw(&w, 0.01 * step);
            if (!CHECK_RESULT(yc_scene_step(w.scene, 1e3, &stats), YC_OK)) break;
            newton += stats.newton, rejected += stats.rejected;
            for (i = 0; i < w.yarns.node_count; i++)
                if (side_of(&w, i) > 0) yc_scene_pin_force(w.scene, 0, YC_NODE, i, f), force += f[0];
            CHECK_NEAR(force, 10.0 * d.weft.stretch * 0.01 * step, 1e-5);
        }
        printf(
            "   free sliding to %g m: %d Newton iterations, %d rejected sub-steps\n", tolerance[k], newton, rejected);
        CHECK(newton <= 200 && rejected <= 3);
        swatch_free(&w);
    }
}

static int count_to_thousand(void *user, double fraction) {
    (void)fraction;
    return ++*(int *)user == 1000;
}

/* A step whose sub-steps go on failing ends: here one iteration is hardly ever enough. */
TEST(woven_extremes_work_of_a_step_is_bounded) {
    yc_host host;
    yc_weave_desc d = weave_of(STRAIGHT);
    yc_scene_desc settings = yc_scene_desc_default();
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_scene *scene = NULL;
    yc_yarns yarns;
    int calls = 0;
    memset(&host, 0, sizeof host);
    host.progress = count_to_thousand, host.user = &calls;
    d.size[0] = d.size[1] = 10.0 * d.spacing[0];
    settings.dt_max = 0.1, settings.dt_min = 1e-9, settings.newton_limit = 1, settings.tolerance = 1e-7;
    if (!CHECK_RESULT(yc_weave(NULL, &d, NULL, &yarns, NULL), YC_OK)) return;
    cloth.yarns = &yarns;
    CHECK_RESULT(yc_scene_create(&host, &settings, &scene, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_cloth(scene, &cloth, NULL), YC_OK);
    CHECK_RESULT(yc_scene_pin(scene, 0, YC_NODE, 0, NULL), YC_OK);
    CHECK_RESULT(yc_scene_step(scene, 0.1, NULL), YC_ERROR_DIVERGED);
    CHECK(calls > 2 && calls < 100);
    yc_scene_destroy(scene), yc_yarns_destroy(&yarns);
}

/* What lies outside is refused in words that name the field and its value. */
TEST(woven_extremes_outside) {
    enum { FIELDS = 8, VALUES = 3 };
    static const char *const names[FIELDS] = {
        "stretch", "bending", "shear", "contact", "slide", "flattening", "radius", "friction"};
    double outside[VALUES] = {-1.5, NAN, HUGE_VAL};
    int i, k, family;
    for (family = 0; family < 2; family++)
        for (k = 0; k < FIELDS; k++)
            for (i = 0; i < VALUES; i++) {
                yc_weave_desc d = weave_of(STRAIGHT);
                yc_yarn_material *m = family == YC_WARP ? &d.warp : &d.weft;
                double *field[FIELDS];
                char why[YC_MESSAGE_SIZE] = "", start[64];
                yc_yarns y;
                field[0] = &m->stretch, field[1] = &m->bending, field[2] = &m->shear, field[3] = &m->contact;
                field[4] = &m->slide, field[5] = &m->flattening, field[6] = &m->radius, field[7] = &m->friction;
                *field[k] = outside[i];
                snprintf(start, sizeof start, "weave.%s.%s = %g must ", family == YC_WARP ? "warp" : "weft", names[k],
                    outside[i]);
                CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, why), YC_ERROR_ARGUMENT);
                if (!CHECK(!strncmp(why, start, strlen(start)))) printf("   %s, not %s\n", why, start);
            }
}

/* ---- the time step -------------------------------------------------------------------------------------------- */

/* Drawn to 3 % in 50 ms and held for as long: the force on one side, N. */
static double tensile_force(int base, double dt) {
    yc_weave_desc d = weave_of(base);
    yc_scene_desc settings = yc_scene_desc_default();
    swatch w;
    double force = 0.0, f[3];
    int i, step, steps = (int)(0.05 / dt + 0.5);
    settings.dt_max = dt, settings.tolerance = 1e-8, settings.mass_damping = 100.0;
    for (step = swatch_new(&w, &d, &settings, 0.0) ? 1 : 2 * steps; step <= 2 * steps; step++) {
        if (step <= steps) draw(&w, 0.03 * step / steps);
        if (!CHECK_RESULT(yc_scene_step(w.scene, dt, NULL), YC_OK)) break;
    }
    for (i = 0; i < w.yarns.node_count; i++)
        if (side_of(&w, i) > 0 && CHECK_RESULT(yc_scene_pin_force(w.scene, 0, YC_NODE, i, f), YC_OK)) force += f[0];
    swatch_free(&w);
    return force;
}

/* With crimp, where wefts straighten and warps give way; without, it would be EA times the strain at any step. */
TEST(woven_extremes_same_tension_at_any_step) {
    static const double dt[3] = {1e-4, 1e-3, 5e-3};
    double force[3];
    int base, i;
    for (base = CRIMPED; base <= SHIRTING; base++) {
        for (i = 0; i < 3; i++) force[i] = tensile_force(base, dt[i]);
        printf("   tensile test, %s: %.5g, %.5g, %.5g N at 0.1, 1, 5 ms a step\n",
            base == CRIMPED ? "crimped" : "shirting", force[0], force[1], force[2]);
        CHECK(force[0] > 0.0);
        for (i = 1; i < 3; i++) CHECK_NEAR(force[i] / force[0], 1.0, 0.01);
    }
}
