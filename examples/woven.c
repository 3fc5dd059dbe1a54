/* Cloth that lets its yarns go, drawn yarn by yarn.
 *
 *     woven [snag|pullout|fray|strip|corner]      all of them without a name
 *
 * snag     a weft is hooked, drawn out of the cloth as a loop, and let go: the line that it leaves stays
 * pullout  a weft is drawn out by its end
 * fray     the outermost warp is peeled off a cut edge
 * strip    a strip is drawn by two neighbouring warps in opposite directions: it yields, since they slide (after MIX,
 *          Fig. 7)
 * corner   a patch is drawn at a corner and released: it keeps some of the deformation (after MIX, Fig. 6)
 * Each prints a table and writes out/woven-NAME.png; snag also woven-hooked.png, before it is let go. All are pieces
 * of an open plain weave, about two centimetres wide, on a table: u of the pattern is x, v is y, and z is up. Weight
 * does not matter at this size and is left out. */
#include "../tests/scenes/woven.h"
#include "common/ex_yarns.h"
#include "yarncloth.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double frame = 5e-3; /* s */

typedef struct piece {
    yc_weave_desc weave;
    yc_yarns yarns; /* as woven */
    yc_scene *scene;
    int ok, frames, events[YC_EVENT_COUNT], substeps, newton;
    int pulled[4], pulled_count; /* yarns in the third colour */
} piece;

/* The first failure is told, later calls do nothing. */
static int fine(piece *p, yc_result result, const char *why) {
    if (p->ok && result != YC_OK) fprintf(stderr, "woven: %s: %s\n", yc_result_name(result), why), p->ok = 0;
    return p->ok;
}

static int worked(piece *p, yc_result result) { return fine(p, result, yc_scene_message(p->scene)); }

/* ---- cloth ---- */

/* An open plain weave of the default yarn, gripped by preload: the closer and the rougher yarns lie, the more their
 * waves hold what is drawn through them, up to where it would rather break. */
static void piece_weave(piece *p, int warps, int wefts, double preload, double shear) {
    char why[YC_MESSAGE_SIZE];
    yc_yarn_material yarn = yc_yarn_material_default();
    memset(p, 0, sizeof *p);
    p->ok = 1, p->weave = yc_weave_desc_default();
    yarn.friction = 0.2, yarn.preload = preload, yarn.shear *= shear;
    yarn.slide = yarn.friction * yarn.preload / (0.2 * yarn.radius); /* lets go after a fifth of the radius */
    p->weave.warp = p->weave.weft = yarn;
    p->weave.spacing[0] = p->weave.spacing[1] = 6e-4;
    p->weave.size[0] = warps * p->weave.spacing[0], p->weave.size[1] = wefts * p->weave.spacing[1];
    fine(p, yc_weave(NULL, &p->weave, NULL, &p->yarns, why), why);
}

static void piece_free(piece *p) {
    yc_scene_destroy(p->scene);
    yc_yarns_destroy(&p->yarns);
}

static void piece_start(piece *p, const yc_yarns *yarns) {
    yc_scene_desc settings = yc_scene_desc_default();
    yc_cloth_desc cloth = yc_cloth_desc_default();
    char why[YC_MESSAGE_SIZE] = "";
    memset(settings.gravity, 0, sizeof settings.gravity);
    settings.mass_damping = 20.0;
    cloth.yarns = yarns;
    if (p->ok) fine(p, yc_scene_create(NULL, &settings, &p->scene, why), why);
    if (p->ok) worked(p, yc_scene_add_cloth(p->scene, &cloth, NULL));
}

/* Moves what a scene draws; NULL: lets it go. */
static void pull(piece *p, const yc_yarns *yarns, scene_pull what, const double by[3]) {
    if (p->ok) worked(p, scene_woven_pull(p->scene, yarns, what, by));
}

static double force_at(piece *p, int node) {
    double f[3] = {0.0, 0.0, 0.0};
    if (p->ok) worked(p, yc_scene_pin_force(p->scene, 0, YC_NODE, node, f));
    return sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
}

/* One frame; every `row`-th ends a row of the table. node < 0: no force. */
static void advance(piece *p, int row, int node) {
    yc_stats s;
    const yc_event *e;
    int i, count;
    if (!p->ok || !worked(p, yc_scene_step(p->scene, frame, &s))) return;
    if (!p->frames++) {
        printf("  nodes %d, unknowns %d, solver %s\n", s.full_nodes, s.dofs,
            s.solver == YC_SOLVER_DIRECT ? "direct" : "two-level");
        printf("  time, ms   Newton per sub-step   residual, N   force, mN");
        for (i = 0; i < YC_EVENT_COUNT; i++) printf("%10s", yc_event_name((yc_event_type)i));
        printf("\n");
    }
    p->substeps += s.substeps, p->newton += s.newton;
    e = yc_scene_events(p->scene, &count);
    for (i = 0; i < count; i++) p->events[e[i].type]++;
    if (p->frames % row) return;
    printf("  %8.0f   %19.1f   %11.1e   %9.2f", 1e3 * yc_scene_time(p->scene), (double)p->newton / p->substeps,
        s.residual, node < 0 ? 0.0 : 1e3 * force_at(p, node));
    for (i = 0; i < YC_EVENT_COUNT; i++) printf("%10d", p->events[i]);
    printf("\n");
    p->newton = p->substeps = 0;
}

/* Draws by d[] over `frames` frames; every `row`-th ends a row of the table. */
static void draw_out(piece *p, const yc_yarns *yarns, scene_pull what, const double d[3], int row, int frames) {
    int i, k;
    for (i = 1; i <= frames && p->ok; i++) {
        double now[3];
        for (k = 0; k < 3; k++) now[k] = d[k] * i / frames;
        pull(p, yarns, what, now);
        advance(p, row, scene_woven_drawn(yarns, what));
    }
}

/* A yarn in the third colour. */
static void mark(piece *p, int family, int k) {
    if (p->ok) p->pulled[p->pulled_count++] = scene_woven_yarn(&p->yarns, family, k);
}

/* ---- pictures ---- */

/* The yarns as they are now, from where `eyes` stands, or, where `keep` is 0, from where `v` says. */
static ex_image *picture_of(piece *p, const ex_yarns_view *v, ex_camera *eyes, int keep) {
    static const double colors_of[3][3] = {{0.20, 0.33, 0.56}, {0.93, 0.91, 0.87}, {0.80, 0.27, 0.17}};
    ex_image *image = NULL;
    yc_yarns now;
    double(*colors)[3];
    char why[YC_MESSAGE_SIZE] = "colours";
    int i, k;
    if (!p->ok || !worked(p, yc_scene_network(p->scene, 0, &now))) return NULL;
    colors = calloc((size_t)now.yarn_count, sizeof *colors);
    for (i = 0; colors && i < now.yarn_count; i++) {
        int which = now.yarn_family[i] == YC_WEFT;
        for (k = 0; k < p->pulled_count; k++)
            if (p->pulled[k] == i) which = 2;
        memcpy(colors[i], colors_of[which], sizeof colors[i]);
    }
    if (colors) image = ex_yarns_draw(p->scene, 0, v, (const double(*)[3])colors, eyes, keep, why);
    if (!image) fine(p, YC_ERROR_MEMORY, why);
    free(colors);
    return image;
}

static void save(piece *p, ex_image *image, const char *name) {
    char path[64];
    snprintf(path, sizeof path, "out/woven-%s.png", name);
    if (p->ok && !ex_image_write_png(image, path)) fine(p, YC_ERROR_ARGUMENT, path);
    if (p->ok) printf("  %s\n", path);
    ex_image_free(image);
}

static void draw(piece *p, const ex_yarns_view *v, const char *name) {
    ex_camera eyes;
    save(p, picture_of(p, v, &eyes, 0), name);
}

/* ---- scenes ---- */

static void snag(piece *p) {
    enum { WARPS = 36, WEFTS = 30, PULL = 50, REST = 40 };
    static const ex_yarns_view v = {900, 500, 1, {0.12, 0.62, 0.95}, 1.14, {0.0, 0.0}, 1.9, 1, NULL};
    double d[3] = {0.0, 0.0, 0.0};
    yc_yarns hooked;
    int i;
    piece_weave(p, WARPS, WEFTS, 0.02, 1.0);
    mark(p, YC_WEFT, WEFTS / 2), d[2] = 6.0 * p->weave.spacing[0];
    if (!p->ok) return;
    if (!scene_woven_hook(&p->yarns, &hooked)) {
        fine(p, YC_ERROR_MEMORY, "network");
        return;
    }
    piece_start(p, &hooked);
    draw_out(p, &hooked, SCENE_SNAG, d, 10, PULL);
    draw(p, &v, "hooked");
    pull(p, &hooked, SCENE_SNAG, NULL);
    for (i = 0; i < REST; i++) advance(p, 10, -1);
    draw(p, &v, "snag");
    scene_woven_unhook(&hooked);
}

static void pullout(piece *p) {
    enum { WARPS = 30, WEFTS = 24 };
    static const ex_yarns_view v = {1000, 480, 1, {0.2, 0.7, 0.9}, 1.0, {0.0, 0.0}, 1.9, 1, NULL};
    double d[3] = {0.0, 0.0, 0.0};
    piece_weave(p, WARPS, WEFTS, 0.02, 1.0);
    mark(p, YC_WEFT, WEFTS / 2), d[0] = 0.6 * p->weave.size[0], d[2] = 0.1 * d[0];
    piece_start(p, &p->yarns);
    draw_out(p, &p->yarns, SCENE_PULLOUT, d, 6, 60);
    draw(p, &v, "pullout");
}

static void fray(piece *p) {
    enum { WARPS = 24, WEFTS = 24 };
    static const ex_yarns_view v = {900, 700, 1, {0.3, 0.8, 0.9}, 1.0, {0.0, 0.0}, 1.9, 1, NULL};
    double d[3];
    piece_weave(p, WARPS, WEFTS, 0.02, 1.0);
    mark(p, YC_WARP, WARPS - 1), d[0] = 0.35 * p->weave.size[0], d[1] = 0.2 * d[0], d[2] = 0.1 * d[0];
    piece_start(p, &p->yarns);
    draw_out(p, &p->yarns, SCENE_FRAY, d, 6, 60);
    draw(p, &v, "fray");
}

static void strip(piece *p) {
    enum { WARPS = 10, WEFTS = 40 };
    static const ex_yarns_view v = {1100, 500, 1, {0.9, 0.8, 0.25}, 1.0, {0.0, 0.0}, 1.9, 1, NULL};
    double d[3] = {0.0, 0.0, 0.0};
    piece_weave(p, WARPS, WEFTS, 0.02, 1.0);
    mark(p, YC_WARP, WARPS / 2), mark(p, YC_WARP, WARPS / 2 - 1), d[1] = 0.15 * p->weave.size[1];
    piece_start(p, &p->yarns);
    draw_out(p, &p->yarns, SCENE_STRIP, d, 5, 50);
    draw(p, &v, "strip");
}

/* From one corner to the other. */
static double diagonal(piece *p, int side) {
    double(*x)[3], length = 0.0;
    yc_yarns now;
    if (!p->ok || !worked(p, yc_scene_network(p->scene, 0, &now))) return 0.0;
    x = calloc((size_t)now.node_count, sizeof *x);
    if (!x) fine(p, YC_ERROR_MEMORY, "positions");
    else if (worked(p, yc_scene_positions(p->scene, 0, YC_NODE, x))) {
        const double *a = x[scene_woven_node(&p->yarns, YC_WARP, 0, 1)],
                     *b = x[scene_woven_node(&p->yarns, YC_WARP, side - 1, -2)];
        length = sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
    }
    free(x);
    return length;
}

static void corner(piece *p) {
    enum { SIDE = 26, PULL = 40, BACK = 60 };
    static const ex_yarns_view v = {520, 520, 1, {0.0, 0.95, 0.1}, 1.0, {0.0, 0.0}, 1.9, 1, NULL};
    double d[3] = {0.0, 0.0, 0.0};
    ex_image *shown[2], *all;
    ex_camera eyes;
    double length[3];
    int i;
    piece_weave(p, SIDE, SIDE, 0.05, 0.1);
    if (!p->ok) return;
    piece_start(p, &p->yarns);
    length[0] = diagonal(p, SIDE);
    d[0] = d[1] = 0.2 * p->weave.size[0];
    draw_out(p, &p->yarns, SCENE_CORNER, d, 5, PULL);
    length[1] = diagonal(p, SIDE), shown[0] = picture_of(p, &v, &eyes, 0);
    pull(p, &p->yarns, SCENE_CORNER, NULL);
    for (i = 0; i < BACK; i++) advance(p, 10, -1);
    length[2] = diagonal(p, SIDE), shown[1] = picture_of(p, &v, &eyes, 1);
    if (p->ok)
        printf("  diagonal %.2f mm, drawn to %.2f mm, released %.2f mm\n", 1e3 * length[0], 1e3 * length[1],
            1e3 * length[2]);
    all = ex_image_new(2 * v.width, v.height, 255, 255, 255);
    if (!all) fine(p, YC_ERROR_MEMORY, "picture");
    for (i = 0; i < 2; i++) {
        if (all && shown[i]) ex_image_paste(all, shown[i], i * v.width, 0);
        ex_image_free(shown[i]);
    }
    save(p, all, "corner");
}

int main(int argc, char **argv) {
    static const struct {
        const char *name;
        void (*run)(piece *);
    } scenes[] = {{"snag", snag}, {"pullout", pullout}, {"fray", fray}, {"strip", strip}, {"corner", corner}};
    enum { SCENES = sizeof scenes / sizeof *scenes };
    int i, found = 0, ok = 1;
    for (i = 0; i < SCENES; i++) {
        piece p;
        if (argc > 1 && strcmp(argv[1], scenes[i].name) != 0) continue;
        found = 1;
        printf("%s\n", scenes[i].name);
        scenes[i].run(&p);
        ok = p.ok && ok;
        piece_free(&p);
    }
    if (!found) fprintf(stderr, "usage: woven [snag|pullout|fray|strip|corner]\n");
    return found ? !ok : 2;
}
