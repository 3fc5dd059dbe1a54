/* Knits of one yarn that fall on a sphere lie differently on it (YARN, Fig. 12). */
#include "scenes/knits.h"
#include "test.h"
#include <math.h>

static int fallen(const char *rows, int stitches, int row_count, double sphere, int most, scene_knit_drape *d) {
    const yc_yarn_material wool = scene_soft_wool();
    char why[YC_MESSAGE_SIZE] = "";
    scene_knit *k = scene_knit_new_above(rows, stitches, row_count, &wool, sphere, why);
    int i, fine;
    CHECK_TEXT(why, "");
    if (!CHECK(k != NULL)) return 0;
    *d = scene_knit_hang(k);
    CHECK_NEAR(d->shadow, 1.0, 1e-12);
    fine = CHECK_RESULT(scene_knit_fall(k, 0.0, most), YC_OK);
    for (i = 0; i < k->yarns.node_count; i++) { /* none has gone into the sphere */
        const double *c = k->centre, *x = k->x[i];
        CHECK(hypot(hypot(x[0] - c[0], x[1] - c[1]), x[2] - c[2]) > sphere - k->desc.yarn.radius);
    }
    *d = scene_knit_hang(k);
    scene_knit_free(k);
    return fine;
}

/* Stockinette's sides roll up, and what has rolled up hangs less: garter, whose rows wrap either way by turns, comes
 * down further. */
TEST(knit_drapes_by_its_fabric) {
    scene_knit_drape plain, garter;
    if (!fallen(scene_stockinette, 10, 8, 0.008, 4, &plain)) return;
    if (!fallen(scene_garter, 10, 8, 0.008, 4, &garter)) return;
    CHECK(plain.shadow < 0.8 && garter.shadow < 0.8);
    CHECK(garter.depth > 1.1 * plain.depth && garter.low[0] > 1.1 * plain.low[0]);
}
