/* A swatch of knitting through wide ranges of its inputs: hung by its upper edge, drawn out by its lower one, brought
 * together so that it folds, let go. Every case has to converge to its tolerance; a table says what that took. The
 * inputs are those of hand-knitted wool, at rest as it is laid or with yarn that would rather be straight, and of a
 * chart with decreases; one or all of them away from there. And charts as small and as large as can be. */
#include "test_scene.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- one case ------------------------------------------------------------------------------------------------- */

typedef struct swatch {
    yc_yarns yarns;
    yc_scene *scene;
    double width, height, low; /* m; low: of the lowest node */
} swatch;

/* What ranges start from. */
enum { LAID, PRESSED, LACE, BASES };

static const char lace[] =
    "pattern: a\n"
    "Row 1 (RS): *K1, sl2-k1-p2sso, yo, k1, yo, k1, repeat from *.\nRow 2 (WS): Purl.\n"
    "Row 3 (RS): *K3tog, yo, k1, yo, p2, repeat from *.\nRow 4 (WS): *P2, ptbl, p3, repeat from *.\n";

/* Yarn turns at rest as it is laid, but for PRESSED, where it is straight. */
static int swatch_new(swatch *w, int base, const yc_knit_desc *knit, const yc_scene_desc *settings) {
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_knit_desc desc = *knit;
    yc_chart chart;
    char why[YC_MESSAGE_SIZE] = "";
    yc_yarns *y = &w->yarns;
    int i, k, ok;
    memset(w, 0, sizeof *w), memset(&chart, 0, sizeof chart);
    if (base == LACE) {
        if (!CHECK_RESULT(yc_chart_read(NULL, lace, strlen(lace), NULL, &chart, why), YC_OK)) return 0;
        desc.chart = &chart;
    }
    ok = CHECK_RESULT(yc_knit(NULL, &desc, y, why), YC_OK);
    yc_chart_destroy(&chart);
    if (!ok) return 0;
    for (i = 1; base != PRESSED && i + 1 < y->visit_count; i++) {
        const double *a = y->layout[y->visit_node[i - 1]], *b = y->layout[y->visit_node[i]],
                     *c = y->layout[y->visit_node[i + 1]];
        y->visit_turn[i] = fabs(atan2((b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]),
            (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1])));
    }
    for (i = 0; i < y->node_count; i++)
        for (k = 0; k < 2; k++) *(k ? &w->height : &w->width) = fmax(k ? w->height : w->width, y->layout[i][k]);
    cloth.yarns = y;
    return CHECK_RESULT(yc_scene_create(NULL, settings, &w->scene, why), YC_OK) &&
        CHECK_RESULT(yc_scene_add_cloth(w->scene, &cloth, NULL), YC_OK);
}

static void swatch_free(swatch *w) { yc_scene_destroy(w->scene), yc_yarns_destroy(&w->yarns); }

/* 1 at the upper edge, -1 at the lower one. */
static int side_of(const swatch *w, const yc_knit_desc *d, int node) {
    double v = w->yarns.layout[node][1];
    return v > w->height - 0.5 / d->courses ? 1 : v < 0.5 / d->courses ? -1 : 0;
}

static void draw(swatch *w, const yc_knit_desc *d, int side, double strain) {
    int i;
    for (i = 0; i < w->yarns.node_count; i++) {
        double to[3];
        memcpy(to, w->yarns.layout[i], sizeof to);
        to[1] -= strain * w->height;
        if (side_of(w, d, i) == side) CHECK_RESULT(yc_scene_pin(w->scene, 0, YC_NODE, i, to), YC_OK);
    }
}

/* Hung, drawn to 10 %, together by 10 %, let go below, all in steps of dt. */
static void run_case(int base, const yc_knit_desc *knit, double dt, test_effort *sum) {
    enum { HANG = 2, DRAW = 4, PRESS = 5, GO = 2, STEPS = HANG + DRAW + PRESS + GO };
    yc_scene_desc settings = yc_scene_desc_default();
    swatch w;
    yc_stats stats;
    int i, step, substeps = sum->substeps, rejected = sum->rejected;
    settings.gravity[1] = -9.81, settings.gravity[2] = -0.1;       /* out of its plane */
    settings.dt_max = dt, settings.tolerance = 2e-3 / knit->wales; /* the default at 5 mm */
    if (!swatch_new(&w, base, knit, &settings)) return;
    draw(&w, knit, 1, 0.0);
    for (step = 0; step < STEPS; step++) {
        if (step >= HANG && step < HANG + DRAW) draw(&w, knit, -1, 0.1 * (step - HANG + 1) / DRAW);
        else if (step >= HANG && step < HANG + DRAW + PRESS)
            draw(&w, knit, -1, 0.1 - 0.2 * (step - HANG - DRAW + 1) / PRESS);
        for (i = 0; step == HANG + DRAW + PRESS && i < w.yarns.node_count; i++)
            if (side_of(&w, knit, i) < 0) CHECK_RESULT(yc_scene_unpin(w.scene, 0, YC_NODE, i), YC_OK);
        if (!CHECK_RESULT(yc_scene_step(w.scene, dt, &stats), YC_OK)) {
            printf("   step %d: %s\n", step, yc_scene_message(w.scene));
            break;
        }
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
    WRAP,
    STITCH,
    CONTACT,
    SLIDE,
    ALL_STIFFNESS,
    FRICTION,
    TIME_STEP,
    FINE, /* all stiffness, at a time step of 0.1 ms */
    SIZE,
    RADIUS,
    GROUPS
} group;

#define MOST_VALUES 4
static const struct range {
    const char *name;
    int count;
    double value[MOST_VALUES];
} ranges[GROUPS] = {
    {"stretch, times the wool's", 4, {1e-3, 0.1, 10.0, 1e3}},
    {"bending, times the wool's", 4, {1e-3, 0.1, 10.0, 1e3}},
    {"wrap, times the wool's", 4, {1e-3, 0.1, 10.0, 1e3}},
    {"stitch, times the wool's", 4, {1e-3, 0.1, 10.0, 1e3}},
    {"contact, times the wool's", 4, {1e-3, 0.1, 10.0, 1e3}},
    {"slide, times the wool's", 4, {1e-3, 0.1, 10.0, 1e3}},
    {"all six of them", 4, {1e-3, 0.1, 10.0, 1e3}},
    {"friction", 4, {0.0, 0.1, 1.0, 2.0}},
    {"time step, s", 4, {1e-4, 3e-4, 1e-3, 5e-3}},
    {"all six, at 0.1 ms", 2, {1e-3, 1e3, 0.0, 0.0}},
    {"width of a stitch, m, and yarn", 4, {7e-5, 3e-4, 3e-3, 3e-2}}, /* of 0.3 mm to 13 cm of yarn */
    {"radius, m, alone", 4, {1e-5, 1e-4, 3e-4, 2e-3}},
};

static void change_yarn(yc_yarn_material *m, group g, double value) {
    int all = g == ALL_STIFFNESS || g == FINE;
    if (g == STRETCH || all) m->stretch *= value;
    if (g == BENDING || all) m->bending *= value;
    if (g == WRAP || all) m->wrap *= value;
    if (g == STITCH || all) m->stitch *= value;
    if (g == CONTACT || all) m->contact *= value;
    if (g == SLIDE || all) m->slide *= value;
    if (g == FRICTION) m->friction = value;
    if (g == RADIUS) m->radius = value;
}

static void run_value(int base, group g, double value, test_effort *sum) {
    yc_knit_desc d = yc_knit_desc_default();
    d.stitches = 6, d.rows = 5;
    if (g == SIZE) { /* as tight as the default */
        double times = d.wales * value;
        yc_yarn_desc wool = yc_yarn_desc_default();
        wool.fibre = YC_FIBRE_WOOL, wool.tex = 440.0 * times * times;
        d.wales /= times, d.courses /= times;
        CHECK_RESULT(yc_yarn_material_make(&wool, &d.yarn, NULL), YC_OK);
    }
    d.yarn.strength = 0.0; /* what is stiff would break */
    change_yarn(&d.yarn, g, value);
    run_case(base, &d, g == TIME_STEP ? value : g == FINE ? 1e-4 : 5e-3, sum);
}

static void run_ranges(int base) {
    static const char *const names[BASES] = {"at rest as laid", "straight at rest", "with decreases"};
    int g, i;
    printf("   %-30s %-17s  Newton a sub-step: mean, worst  rejected of sub-steps\n", names[base], "range");
    for (g = 0; g < GROUPS; g++) {
        const struct range *r = ranges + g;
        test_effort sum;
        memset(&sum, 0, sizeof sum);
        if (base != LAID && g != WRAP && (g < ALL_STIFFNESS || g == RADIUS)) continue;
        /* of stiffness, and away from the first base, the ends alone */
        for (i = 0; i < r->count; i += base == LAID && g > ALL_STIFFNESS ? 1 : r->count - 1)
            run_value(base, (group)g, r->value[i], &sum);
        printf("   %-30s %7.0e .. %-7.0e  %23.1f %6.1f  %8d of %d\n", r->name, r->value[0], r->value[r->count - 1],
            (double)sum.newton / sum.substeps, sum.worst, sum.rejected, sum.substeps);
    }
}

TEST(knit_extremes_laid) { run_ranges(LAID); }
TEST(knit_extremes_straight) { run_ranges(PRESSED); }
TEST(knit_extremes_decreases) { run_ranges(LACE); }

/* ---- charts --------------------------------------------------------------------------------------------------- */

/* A piece of a chart given as text, NULL: stockinette; laid out, and with steps > 0 hung by its first row. */
static void run_chart(const char *text, int stitches, int rows, int steps, int contacts) {
    yc_scene_desc settings = yc_scene_desc_default();
    yc_knit_desc d = yc_knit_desc_default();
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_scene *scene = NULL;
    yc_chart chart;
    yc_yarns y;
    yc_stats stats;
    char why[YC_MESSAGE_SIZE] = "";
    int i;
    memset(&chart, 0, sizeof chart);
    if (text && !CHECK_RESULT(yc_chart_read(NULL, text, strlen(text), NULL, &chart, why), YC_OK)) return;
    d.chart = text ? &chart : NULL, d.stitches = stitches, d.rows = rows, d.yarn.strength = 0.0;
    if (CHECK_RESULT(yc_knit(NULL, &d, &y, why), YC_OK)) {
        CHECK(y.contact_count == contacts);
        CHECK_RESULT(yc_yarns_check(&y, NULL, why), YC_OK);
        cloth.yarns = &y;
        if (steps) {
            CHECK_RESULT(yc_scene_create(NULL, &settings, &scene, why), YC_OK);
            CHECK_RESULT(yc_scene_add_cloth(scene, &cloth, NULL), YC_OK);
        }
        for (i = 0; steps && i < y.visit_count && i < 2; i++)
            CHECK_RESULT(yc_scene_pin(scene, 0, YC_NODE, y.visit_node[i], NULL), YC_OK);
        for (i = 0; i < steps; i++) {
            if (!CHECK_RESULT(yc_scene_step(scene, settings.dt_max, &stats), YC_OK)) break;
            CHECK(stats.correction <= settings.tolerance && stats.unfinished == 0);
        }
        yc_scene_destroy(scene), yc_yarns_destroy(&y);
    } else printf("   %s\n", why);
    yc_chart_destroy(&chart);
}

/* An old loop has two contacts with the one drawn through it, that which binds it off has two, the chain from one of
 * these to the next, and the yarn's end one with the last. */
TEST(knit_extremes_one_stitch) {
    run_chart(NULL, 1, 1, 6, 5);
    run_chart(NULL, 1, 30, 6, 63);
    run_chart("Row 1 (RS): K1.\nRow 2 (WS): P1.\n", 1, 7, 6, 17);
    run_chart(NULL, 1, 50000, 0, 100003);
}

TEST(knit_extremes_hundred_thousand_stitches) {
    run_chart(NULL, 100000, 1, 0, 2 * 100000 + 4 * 100000 - 1);
    run_chart(NULL, 300, 334, 0, 2 * 300 * 334 + 4 * 300 - 1);
}

/* Down to one stitch, by three into one and by two into one. */
TEST(knit_extremes_to_one_stitch) {
    run_chart("Row 1 (RS): K3tog, k3tog, sl2-k1-p2sso.\nRow 2 (WS): P3tog.\n", 9, 2, 6, 2 * 9 + 2 * 3 + 3);
    run_chart("Row 1 (RS): K2tog, ssk.\nRow 2 (WS): P2tog.\n", 4, 2, 6, 2 * 4 + 2 * 2 + 3);
}

/* What lies outside is refused in words that name the field and its value. */
TEST(knit_extremes_outside) {
    enum { FIELDS = 9, VALUES = 3 };
    static const char *const names[FIELDS] = {
        "stretch", "bending", "wrap", "stitch", "contact", "slide", "radius", "friction", "density"};
    double outside[VALUES] = {-1.5, NAN, HUGE_VAL};
    char why[YC_MESSAGE_SIZE] = "", start[64];
    yc_yarns y;
    int i, k;
    for (k = 0; k < FIELDS + 2; k++)
        for (i = 0; i < VALUES; i++) {
            yc_knit_desc d = yc_knit_desc_default();
            yc_yarn_material *m = &d.yarn;
            double *field[FIELDS + 2];
            field[0] = &m->stretch, field[1] = &m->bending, field[2] = &m->wrap, field[3] = &m->stitch;
            field[4] = &m->contact, field[5] = &m->slide, field[6] = &m->radius, field[7] = &m->friction;
            field[8] = &m->density, field[9] = &d.wales, field[10] = &d.courses;
            *field[k] = outside[i];
            snprintf(start, sizeof start, "knit.%s%s = %g must ", k < FIELDS ? "yarn." : "",
                k < FIELDS        ? names[k]
                    : k == FIELDS ? "wales"
                                  : "courses",
                outside[i]);
            CHECK_RESULT(yc_knit(NULL, &d, &y, why), YC_ERROR_ARGUMENT);
            if (!CHECK(!strncmp(why, start, strlen(start)))) printf("   %s, not %s\n", why, start);
        }
}

/* As tight as fabrics with names are, within what single ones differ by; and laid out so. */
TEST(knit_tightness) {
    static const yc_fabric_name names[4] = {YC_FABRIC_JERSEY, YC_FABRIC_RIB, YC_FABRIC_STOCKINETTE, YC_FABRIC_SWEATER};
    static const double tightness[4] = {16.0, 15.3, 11.0, 13.0};
    char why[YC_MESSAGE_SIZE] = "";
    yc_knit_desc d, named;
    yc_yarns y;
    int i;
    for (i = 0; i < 4; i++) {
        CHECK_RESULT(yc_knit_fabric(names[i], &named), YC_OK);
        d = named;
        CHECK_RESULT(yc_knit_tightness(&d, tightness[i], why), YC_OK);
        CHECK_NEAR(d.loop / named.loop, 1.0, 0.01);
        CHECK_NEAR(d.wales / named.wales, 1.0, 0.12), CHECK_NEAR(d.courses / named.courses, 1.0, 0.15);
        d.stitches = d.rows = 6;
        if (CHECK_RESULT(yc_knit(NULL, &d, &y, why), YC_OK)) yc_yarns_destroy(&y);
    }
    named = d;
    CHECK_RESULT(yc_knit_tightness(&d, 0.0, why), YC_ERROR_ARGUMENT);
    CHECK_TEXT(why, "tightness = 0 must be greater than 0 and finite");
    CHECK_RESULT(yc_knit_tightness(&d, HUGE_VAL, why), YC_ERROR_ARGUMENT);
    d.yarn.density = -1.0;
    CHECK_RESULT(yc_knit_tightness(&d, 14.0, why), YC_ERROR_ARGUMENT);
    CHECK_RESULT(yc_knit_tightness(NULL, 14.0, why), YC_ERROR_ARGUMENT);
    CHECK(d.loop == named.loop && d.wales == named.wales);
}

/* Let go without gravity, it curls until wrapping and bending balance: with the literal form of wrapping to the same
 * shape. Shares of its width and height as laid. */
TEST(knit_wrapping_both_forms) {
    double extent[2][3];
    int form, step, i, k;
    for (form = 0; form < 2; form++) {
        yc_scene_desc settings = yc_scene_desc_default();
        yc_knit_desc d = yc_knit_desc_default();
        double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, (*x)[3];
        swatch w;
        d.stitches = 8, d.rows = 8, d.yarn.strength = 0.0, d.yarn.wrap *= 0.2; /* it need not lie on itself */
        memset(settings.gravity, 0, sizeof settings.gravity);
        settings.mass_damping = 20.0, settings.dt_max = 0.02, settings.literal_wrap = form;
        if (!swatch_new(&w, LAID, &d, &settings)) return;
        for (step = 0; step < 25; step++)
            if (!CHECK_RESULT(yc_scene_step(w.scene, 0.02, NULL), YC_OK)) break;
        x = (double(*)[3])malloc((size_t)(2 * w.yarns.node_count) * sizeof *x); /* events may add some */
        CHECK_RESULT(yc_scene_positions(w.scene, 0, YC_NODE, x), YC_OK);
        for (i = 0; i < w.yarns.node_count; i++)
            for (k = 0; k < 3; k++) low[k] = fmin(low[k], x[i][k]), high[k] = fmax(high[k], x[i][k]);
        for (k = 0; k < 3; k++) extent[form][k] = (high[k] - low[k]) / (k ? w.height : w.width);
        printf("   %s: %.3f wide, %.3f high, %.3f deep\n", form ? "literal" : "smooth", extent[form][0],
            extent[form][1], extent[form][2]);
        free(x), swatch_free(&w);
    }
    for (k = 0; k < 3; k++) CHECK_NEAR(extent[1][k], extent[0][k], 0.04);
    CHECK(extent[0][2] > 0.1); /* it has curled */
}
