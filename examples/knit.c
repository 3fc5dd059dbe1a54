/* Knits that are left to themselves, drawn yarn by yarn.
 *
 *     knit [curl|rib|garter|lace|unravel]      all of them without a name
 *
 * curl    stockinette: its sides roll towards the purl side, its ends towards the knit side (after YARN, Fig. 7);
 *         drawn while it rolls, which only weight or the cloth itself would stop
 * rib     knit and purl columns by turns: they draw in (YARN, Fig. 5)
 * garter  knit rows on both sides: it lies flat
 * lace    decreases, whose loops are stacked, and yarn-overs, which leave holes
 * unravel garter that is not bound off; its end is drawn off sideways, and it comes undone loop by loop (YARN, Fig. 13)
 * Each is cast on and worked with one yarn of wool; the first four are bound off, are given their rest shape, and then
 * let their contacts unwrap. Each prints a line and writes out/knit-NAME.png, as seen from the right side. Weight is
 * left out. */
#include "common/ex_yarns.h"
#include "tests/scenes/knits.h"
#include "yarncloth.h"
#include <stdio.h>
#include <string.h>

typedef struct piece {
    const char *name;
    const char *const *rows;
    int stitches, row_count, most; /* steps */
    double from[3];                /* towards the camera */
} piece;

static const char *const openwork =
    "pattern: a\nRow 1 (RS): K1, *yo, ssk, k3, k2tog, yo, k1, repeat from *.\nRow 2 (WS): Purl.\n"
    "Row 3 (RS): K1, *k1, yo, ssk, k1, k2tog, yo, k2, repeat from *.\nRow 4 (WS): Purl.\n"
    "Row 5 (RS): K1, *k2, yo, sl1-k2tog-psso, yo, k3, repeat from *.\nRow 6 (WS): Purl.\n";

static const piece pieces[] = {{"curl", &scene_stockinette, 20, 22, 2, {0.35, 0.4, 1.0}},
    {"rib", &scene_rib, 20, 20, 12, {0.1, 0.2, 1.0}}, {"garter", &scene_garter, 18, 22, 12, {0.1, 0.2, 1.0}},
    {"lace", &openwork, 17, 18, 8, {0.0, 0.1, 1.0}}};

static int save(yc_scene *scene, const ex_yarns_view *view, const char *name, char *why) {
    ex_camera camera;
    char path[64];
    ex_image *image = ex_yarns_draw(scene, 0, view, NULL, &camera, 0, why);
    snprintf(path, sizeof path, "out/knit-%s.png", name);
    if (image && !ex_image_write_png(image, path)) snprintf(why, YC_MESSAGE_SIZE, "%s cannot be written", path);
    ex_image_free(image);
    return !why[0];
}

static int run(const piece *p) {
    const double degree = 3.14159265358979323846 / 180.0;
    char why[YC_MESSAGE_SIZE] = "";
    scene_knit *k = scene_knit_new(*p->rows, p->stitches, p->row_count, NULL, why);
    scene_knit_shape flat, now;
    ex_yarns_view view;
    yc_result result = YC_OK;
    if (!k) {
        fprintf(stderr, "knit: %s: %s\n", p->name, why);
        return 0;
    }
    flat = scene_knit_look(k);
    result = scene_knit_settle(k, p->most);
    if (result != YC_OK) snprintf(why, sizeof why, "%s", yc_scene_message(k->scene));
    else {
        now = scene_knit_look(k);
        printf(
            "%-7s %2d x %2d  width %.2f and height %.2f of flat; sides turn %4.0f %4.0f, ends %4.0f %4.0f, the middle "
            "%3.0f degrees; %d sub-steps, %.1f Newton iterations each, %.1f s\n",
            p->name, p->stitches, p->row_count, now.width / flat.width, now.height / flat.height, now.side[0] / degree,
            now.side[1] / degree, now.end[0] / degree, now.end[1] / degree, now.flat / degree, k->substeps,
            (double)k->newton / k->substeps, k->seconds);
        fflush(stdout);
        memset(&view, 0, sizeof view);
        view.width = 1000, view.height = 900, view.zoom = 0.95, view.fuller = 1.0;
        memcpy(view.from, p->from, sizeof view.from);
        save(k->scene, &view, p->name, why);
    }
    if (why[0]) fprintf(stderr, "knit: %s: %s\n", p->name, why);
    scene_knit_free(k);
    return !why[0];
}

static int unravel(void) {
    enum { STITCHES = 10, ROWS = 8, LOOPS = 14 };
    char why[YC_MESSAGE_SIZE] = "";
    scene_unravel *u = scene_unravel_new(NULL, scene_garter, STITCHES, ROWS, why);
    yc_result result = YC_OK;
    double most = 0.0, seconds = 0.0;
    int slipped = 0, substeps = 0, newton = 0, i, n;
    while (u && result == YC_OK && slipped < LOOPS && u->pulled < 1.0) {
        const yc_event *e;
        yc_stats stats;
        result = scene_unravel_pull(u, 2e-3, 1e-2, &stats);
        e = yc_scene_events(u->scene, &n);
        for (i = 0; i < n && result == YC_OK; i++) slipped += e[i].type == YC_EVENT_SLIP;
        substeps += stats.substeps, newton += stats.newton, seconds += stats.seconds;
        if (u->force > most) most = u->force;
    }
    if (result != YC_OK) snprintf(why, sizeof why, "%s", yc_scene_message(u->scene));
    if (u && result == YC_OK) {
        ex_yarns_view view;
        printf("unravel %2d x %2d  %d loops out, %.0f mm drawn, at most %.2f N; %d sub-steps, %.1f Newton iterations "
               "each, %.1f s\n",
            STITCHES, ROWS, slipped, 1e3 * u->pulled, most, substeps, (double)newton / substeps, seconds);
        fflush(stdout);
        memset(&view, 0, sizeof view);
        view.width = 1200, view.height = 700, view.zoom = 2.4, view.fuller = 1.0;
        view.shift[0] = -0.31 * u->way, view.from[1] = 0.15, view.from[2] = 1.0;
        save(u->scene, &view, "unravel", why);
    }
    if (why[0]) fprintf(stderr, "knit: unravel: %s\n", why);
    scene_unravel_free(u);
    return !why[0];
}

int main(int argc, char **argv) {
    int i, n = (int)(sizeof pieces / sizeof *pieces), found = 0, fine = 1;
    for (i = 0; i < n; i++)
        if (argc < 2 || strcmp(argv[1], pieces[i].name) == 0) found++, fine &= run(pieces + i);
    if (argc < 2 || strcmp(argv[1], "unravel") == 0) found++, fine &= unravel();
    if (!found) fprintf(stderr, "knit: %s is none of curl, rib, garter, lace, unravel\n", argv[1]);
    return !(found && fine);
}
