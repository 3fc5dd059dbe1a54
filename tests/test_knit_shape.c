/* What knits do when they are left alone (after YARN, Fig. 5 and 7): stockinette curls, garter lies flat, ribs draw in.
 * Pieces of 14 stitches, of 54 mm, so that edges are never far: larger ones have a flatter middle. */
#include "scenes/knits.h"
#include "test.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

static const double degree = 3.14159265358979323846 / 180.0;

static int settled(const char *rows, int stitches, int row_count, int held, int most, scene_knit **k,
    scene_knit_shape *before, scene_knit_shape *after) {
    char why[YC_MESSAGE_SIZE] = "";
    *k = scene_knit_new(rows, stitches, row_count, NULL, why);
    CHECK_TEXT(why, "");
    if (!CHECK(*k != NULL)) return 0;
    *before = scene_knit_look(*k);
    if (held) CHECK_RESULT(scene_knit_hold(*k), YC_OK);
    if (!CHECK_RESULT(scene_knit_settle(*k, most), YC_OK)) return 0;
    *after = scene_knit_look(*k);
    return 1;
}

/* Sides towards the purl side, ends towards the knit side, and there it stays: its sides lie on it. Four loops of the
 * middle are held, since a piece this small would roll up into two scrolls, side by side. */
TEST(knit_stockinette_curls) {
    scene_knit *k;
    scene_knit_shape before, after, later;
    int i;
    if (settled(scene_stockinette, 14, 14, 1, 80, &k, &before, &after)) {
        printf("   sides %.0f %.0f, ends %.0f %.0f, middle %.0f degrees; moved by %.2f radii in the last of %d steps\n",
            after.side[0] / degree, after.side[1] / degree, after.end[0] / degree, after.end[1] / degree,
            after.flat / degree, k->moved / k->desc.yarn.radius, k->substeps);
        CHECK(before.flat < 2.0 * degree && k->moved < 0.2 * k->desc.yarn.radius);
        for (i = 0; i < 2; i++) CHECK(after.side[i] > 60.0 * degree && after.end[i] > 20.0 * degree);
        CHECK(after.flat < 30.0 * degree);
        for (i = 0; i < 4; i++) CHECK_RESULT(scene_knit_settle(k, 1), YC_OK);
        later = scene_knit_look(k);
        for (i = 0; i < 2; i++) {
            CHECK_NEAR(later.side[i], after.side[i], 2.0 * degree);
            CHECK_NEAR(later.end[i], after.end[i], 2.0 * degree);
        }
    }
    scene_knit_free(k);
}

/* Pairs of knit and purl columns fold, but not flat: they lie on each other. */
TEST(knit_wide_rib_lies_on_itself) {
    scene_knit *k;
    scene_knit_shape before, after;
    double low = HUGE_VAL, high = -HUGE_VAL;
    int i;
    if (settled(scene_rib2, 12, 8, 0, 16, &k, &before, &after)) {
        for (i = 0; i < k->yarns.node_count; i++) low = fmin(low, k->x[i][2]), high = fmax(high, k->x[i][2]);
        CHECK(after.width > 0.2 * before.width && after.width < 0.6 * before.width);
        CHECK(high - low > 8.0 * k->desc.yarn.radius); /* two layers */
    }
    scene_knit_free(k);
}

/* In Munden's loop kc is 1.3 kw. */
TEST(knit_has_the_gauge_of_its_loop) {
    char why[YC_MESSAGE_SIZE] = "";
    scene_knit *k = scene_knit_new(scene_stockinette, 9, 9, NULL, why);
    scene_knit_munden m;
    if (!CHECK(k != NULL)) return;
    m = scene_knit_gauge(k);
    CHECK(m.kc / m.kw > 1.3 / 1.2 && m.kc / m.kw < 1.3 * 1.2);
    CHECK(m.kw > 3.8 / 1.25 && m.kw < 4.2 * 1.25 && m.kc > 5.0 / 1.25 && m.kc < 5.5 * 1.25);
    scene_knit_free(k);
}

TEST(knit_garter_lies_flat) {
    scene_knit *k;
    scene_knit_shape before, after;
    int i;
    if (settled(scene_garter, 14, 14, 0, 12, &k, &before, &after)) {
        /* its outermost columns lean, by less than half of what stockinette's do */
        for (i = 0; i < 2; i++) CHECK(fabs(after.side[i]) < 50.0 * degree && fabs(after.end[i]) < 15.0 * degree);
        CHECK(after.flat < 12.0 * degree);
    }
    scene_knit_free(k);
}

TEST(knit_rib_draws_in) {
    scene_knit *k;
    scene_knit_shape before, after;
    if (settled(scene_rib, 10, 10, 0, 8, &k, &before, &after)) {
        CHECK(after.width < 0.62 * before.width && after.height > 0.9 * before.height);
        CHECK(after.flat < 20.0 * degree);
    }
    scene_knit_free(k);
}

/* Garter drawn out until its loops slip stays wider, and it is friction that keeps it so (YARN, Fig. 9): without, it
 * comes back and on, since its yarn still slides into the edges. By 5 to 10 %, and by 2 to 11 % narrower, when it is
 * drawn out or wraps a little more or less. */
TEST(knit_overstretched_stays_wide) {
    double set[2];
    int i, phase;
    for (i = 0; i < 2; i++) {
        yc_yarn_material wool = scene_soft_wool();
        double width[SCENE_PHASES];
        scene_knit *k;
        wool.friction = 0.0;
        k = scene_knit_new(scene_garter, 6, 6, &wool, NULL);
        if (!CHECK(k != NULL)) return;
        for (phase = 0; phase < SCENE_PHASES; phase++)
            if (!CHECK_RESULT(scene_knit_overstretch(k, phase, i ? 0.3 : 0.0, 0.5, &width[phase]), YC_OK)) break;
        set[i] = width[SCENE_AFTER] / width[SCENE_BEFORE] - 1.0;
        CHECK(phase == SCENE_PHASES && width[SCENE_DRAWN] > 1.3 * width[SCENE_BEFORE]);
        scene_knit_free(k);
    }
    printf("   wider by %.1f %%, without friction by %.1f %%\n", 100.0 * set[1], 100.0 * set[0]);
    CHECK(set[1] > 0.02 && set[0] < 0.01 && set[1] > set[0] + 0.05);
}
