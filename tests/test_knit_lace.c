/* Lace looks as it is known to (YARN, Fig. 4): what yarn-overs and decreases do to the shape that stitches relax to. */
#include "scenes/knits.h"
#include "test.h"
#include <math.h>

static const double degree = 3.14159265358979323846 / 180.0;

static scene_knit *swatch(const char *rows, int stitches, int row_count) {
    char why[YC_MESSAGE_SIZE] = "";
    scene_knit *k = scene_knit_new(rows, stitches, row_count, NULL, why);
    CHECK(k != NULL), CHECK_TEXT(why, "");
    return k;
}

/* Feather and Fan repeats after 18 stitches: six decreases, six yarn-overs, six decreases. Of all waves of its upper
 * edge that is the strongest, and larger than half a stitch. */
TEST(knit_lace_feather_and_fan) {
    scene_knit *k = swatch(scene_feather, 36, 4);
    double amplitude, other = 0.0;
    int i;
    if (!k) return;
    amplitude = scene_knit_wave(k, 2.0);
    for (i = 1; i < 9; i++)
        if (i != 2) other = fmax(other, scene_knit_wave(k, i));
    CHECK(amplitude > 3.0 * other && amplitude > 0.5 / k->desc.wales);
    scene_knit_free(k);
}

/* Openwork Diamonds: every two rows have four yarn-overs and leave four holes; those of the first two, at the sides,
 * are drawn shut where it is cast on. Plain knitting has none. */
TEST(knit_lace_openwork_diamonds) {
    scene_knit *k = swatch(scene_stockinette, 8, 6);
    int rows, holes, before = 0;
    if (k) CHECK(scene_knit_holes(k, 0.75) == 0);
    scene_knit_free(k);
    for (rows = 4; rows <= 14; rows += 2, before = holes) {
        k = swatch(scene_diamond, 17, rows);
        if (!k) return;
        holes = scene_knit_holes(k, 0.75);
        CHECK(rows == 4 ? holes >= 6 && holes <= 8 : holes == before + 4);
        scene_knit_free(k);
    }
}

/* Flame Chevron: lines of yarn-overs run to the left for ten rows and to the right for the next ten, and the columns
 * between them lean as they do, less; the last ten rows also as they are bound off. Plain knitting stands upright. */
TEST(knit_lace_flame_chevron) {
    scene_knit *k = swatch(scene_chevron, 9, 40);
    double angle[3];
    int i;
    if (!k) return;
    for (i = 0; i < 3; i++) angle[i] = scene_knit_lean(k, 10.0 * i + 2.0, 10.0 * i + 10.0) / degree;
    for (i = 0; i < 3; i++) CHECK(fabs(angle[i]) > 2.0 && (!i || angle[i] * angle[i - 1] < 0.0));
    scene_knit_free(k);
    k = swatch(scene_stockinette, 9, 20);
    if (k) CHECK(fabs(scene_knit_lean(k, 2.0, 18.0)) < 1.0 * degree);
    scene_knit_free(k);
}
