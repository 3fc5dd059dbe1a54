/* One swatch as triangles, yarns and mixed, by changing the descriptor alone. */
#include "scenes/scenes.h"
#include "test.h"
#include <math.h>
#include <stdlib.h>

/* Hangs by its two upper corners until it rests: its lowest point, and the mean height. */
static void hang(scene_kind kind, double *lowest, double *mean) {
    scene_swatch_desc d = scene_swatch_desc_default(kind);
    scene_swatch *s;
    yc_scene_desc settings = yc_scene_desc_default();
    yc_scene *scene = NULL;
    double(*x)[3];
    int i, count;
    d.yarn.density = 2e-3; /* heavy, so that it is drawn: stretch, shear and bending all matter */
    d.yarn.stretch = 5.0, d.yarn.shear = 2e-3, d.yarn.bending = 1e-7;
    s = scene_swatch_new(&d);
    s->cloth.hold_sliding = 1;
    settings.mass_damping = 30.0;
    *lowest = HUGE_VAL, *mean = 0.0;
    count = scene_swatch_count(s), x = (double(*)[3])malloc((size_t)count * sizeof *x);
    CHECK_RESULT(yc_scene_create(NULL, &settings, &scene, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_cloth(scene, &s->cloth, NULL), YC_OK);
    CHECK_RESULT(scene_swatch_pin(scene, 0, s, 0.0, d.size[1], NULL), YC_OK);
    CHECK_RESULT(scene_swatch_pin(scene, 0, s, d.size[0], d.size[1], NULL), YC_OK);
    for (i = 0; i < 60; i++)
        if (!CHECK_RESULT(yc_scene_step(scene, 0.01, NULL), YC_OK)) break;
    CHECK_RESULT(yc_scene_positions(scene, 0, scene_swatch_kind(s), x), YC_OK);
    for (i = 0; i < count; i++) *lowest = fmin(*lowest, x[i][1]), *mean += x[i][1] / count;
    free(x);
    yc_scene_destroy(scene);
    scene_swatch_free(s);
}

TEST(scene_same_swatch_hangs_alike) {
    static const scene_kind kinds[] = {SCENE_TRIANGLES, SCENE_YARNS, SCENE_YARNS_ALONE, SCENE_MIXED, SCENE_HALF};
    double lowest[5], mean[5], sag;
    int i;
    for (i = 0; i < 5; i++) hang(kinds[i], lowest + i, mean + i);
    sag = 0.025 - mean[0]; /* flat it would have its mean at half its height */
    CHECK(sag > 5e-4);
    for (i = 1; i < 5; i++) {
        CHECK_NEAR(mean[i], mean[0], 0.2 * sag);
        CHECK_NEAR(lowest[i], lowest[0], 0.1 * fabs(lowest[0]));
    }
    CHECK_NEAR(mean[1], mean[2], 0.05 * sag); /* the mesh under full yarns changes but the pins' places */
}
