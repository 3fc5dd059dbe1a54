/* What woven yarns show as a whole, each with friction and without where that decides: a stretched and a skewed patch
 * keep a set (after MIX, Fig. 6), a strip drawn by two neighbouring yarns yields (MIX, Fig. 7), a snag draws a line. */
#include "test.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 1024 };
static const double frame = 5e-3, spacing = 2.5e-3;

typedef struct patch {
    yc_yarns yarns;
    yc_scene *scene;
    double x[MOST][3];
    int released;
} patch;

/* Free, in the xy plane, at rest where it was woven. */
static patch *patch_new(int warps, int wefts, const yc_yarn_material *yarn, int hold_sliding) {
    patch *p = (patch *)calloc(1, sizeof *p);
    yc_weave_desc weave = yc_weave_desc_default();
    yc_scene_desc settings = yc_scene_desc_default();
    yc_cloth_desc cloth = yc_cloth_desc_default();
    if (!p) exit(1);
    weave.spacing[0] = weave.spacing[1] = spacing;
    weave.size[0] = warps * spacing, weave.size[1] = wefts * spacing, weave.warp = weave.weft = *yarn;
    memset(settings.gravity, 0, sizeof settings.gravity);
    settings.mass_damping = 20.0;
    CHECK_RESULT(yc_weave(NULL, &weave, NULL, &p->yarns, NULL), YC_OK);
    cloth.yarns = &p->yarns, cloth.hold_sliding = hold_sliding;
    CHECK_RESULT(yc_scene_create(NULL, &settings, &p->scene, NULL), YC_OK);
    if (!CHECK_RESULT(yc_scene_add_cloth(p->scene, &cloth, NULL), YC_OK)) exit(1);
    return p;
}

static void patch_free(patch *p) {
    yc_scene_destroy(p->scene), yc_yarns_destroy(&p->yarns);
    free(p);
}

/* The node that the k-th yarn of a family visits, from its start or, where `visit` is negative, from its end. */
static int node_of(const patch *p, int family, int k, int visit) {
    const yc_yarns *y = &p->yarns;
    int i = 0;
    while (y->yarn_family[i] != family || k-- > 0) i++;
    return y->visit_node[visit < 0 ? y->yarn_first[i + 1] + visit : y->yarn_first[i] + visit];
}

static void draw(patch *p, int node, double dx, double dy, double dz) {
    double at[3];
    memcpy(at, p->yarns.layout[node], sizeof at);
    at[0] += dx, at[1] += dy, at[2] += dz;
    CHECK_RESULT(yc_scene_pin(p->scene, 0, YC_NODE, node, at), YC_OK);
}

static void let_go(patch *p, int node) { CHECK_RESULT(yc_scene_unpin(p->scene, 0, YC_NODE, node), YC_OK); }

static int advance(patch *p, int frames) {
    yc_yarns now;
    int i, n, ok = 1;
    for (; frames > 0 && ok; frames--) {
        const yc_event *e;
        ok = CHECK_RESULT(yc_scene_step(p->scene, frame, NULL), YC_OK);
        e = yc_scene_events(p->scene, &n);
        for (i = 0; i < n; i++) p->released += e[i].type == YC_EVENT_RELEASE;
    }
    CHECK_RESULT(yc_scene_network(p->scene, 0, &now), YC_OK);
    return ok && CHECK(now.node_count <= MOST) && CHECK_RESULT(yc_scene_positions(p->scene, 0, YC_NODE, p->x), YC_OK);
}

static double distance(const patch *p, int a, int b) {
    const double *x = p->x[a], *y = p->x[b];
    return sqrt((x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) + (x[2] - y[2]) * (x[2] - y[2]));
}

/* ---- sets ------------------------------------------------------------------------------------------------------- */

/* The middle weft's strain after it has been drawn by 15 % through a patch that is held all round, and let go. */
static double stretched(double friction) {
    enum { SIDE = 8 };
    yc_yarn_material yarn = yc_yarn_material_default();
    patch *p;
    double rest, strain;
    int i, k, step, ok;
    yarn.friction = friction, yarn.preload = 0.2, yarn.stretch = 5.0;
    yarn.slide = 0.3 * yarn.preload / (0.2 * yarn.radius);
    p = patch_new(SIDE, SIDE, &yarn, 0);
    ok = advance(p, 1);
    rest = distance(p, node_of(p, YC_WEFT, SIDE / 2, 0), node_of(p, YC_WEFT, SIDE / 2, -1));
    for (i = 0; i < SIDE; i++)
        for (k = 0; k < 2; k++) {
            draw(p, node_of(p, YC_WARP, i, -k), 0.0, 0.0, 0.0);
            draw(p, node_of(p, YC_WEFT, i, -k), 0.0, 0.0, 0.0);
        }
    for (step = 1; step <= 20 && ok; step++) {
        for (k = 0; k < 2; k++)
            draw(p, node_of(p, YC_WEFT, SIDE / 2, -k), (k ? 0.075 : -0.075) * SIDE * spacing * step / 20.0, 0.0, 0.0);
        ok = advance(p, 1);
    }
    for (k = 0; k < 2; k++) let_go(p, node_of(p, YC_WEFT, SIDE / 2, -k));
    if (ok) advance(p, 150);
    strain = distance(p, node_of(p, YC_WEFT, SIDE / 2, 0), node_of(p, YC_WEFT, SIDE / 2, -1)) / rest - 1.0;
    patch_free(p);
    return strain;
}

TEST(woven_figures_stretch) {
    CHECK(stretched(0.3) > 1e-3);
    CHECK(fabs(stretched(0.0)) < 1e-5);
}

/* The diagonal's strain after a patch, held at one corner, has been drawn at the other by 15 % and let go.
 * No yarn slides, since nothing would bring back one that slid without friction: what keeps is friction of turning. */
static double skewed(double friction) {
    enum { SIDE = 10 };
    yc_yarn_material yarn = yc_yarn_material_default();
    patch *p;
    double rest, strain;
    int i, k, step, ends[2], ok;
    yarn.friction = friction, yarn.preload = 0.05, yarn.shear = 2e-4;
    yarn.slide = 0.3 * yarn.preload / (0.2 * yarn.radius);
    p = patch_new(SIDE, SIDE, &yarn, 1);
    ends[0] = node_of(p, YC_WARP, 0, 1), ends[1] = node_of(p, YC_WARP, SIDE - 1, -2);
    ok = advance(p, 1);
    rest = distance(p, ends[0], ends[1]);
    for (i = 0; i < 2; i++)
        for (k = 0; k < 2; k++) draw(p, node_of(p, YC_WARP, i, k + 1), 0.0, 0.0, 0.0);
    for (step = 1; step <= 20 && ok; step++) {
        double d = 0.15 * SIDE * spacing * step / 20.0;
        for (i = 0; i < 2; i++)
            for (k = 0; k < 2; k++) draw(p, node_of(p, YC_WARP, SIDE - 1 - i, -2 - k), d, d, 0.0);
        ok = advance(p, 1);
    }
    for (i = 0; i < 2; i++)
        for (k = 0; k < 2; k++) let_go(p, node_of(p, YC_WARP, SIDE - 1 - i, -2 - k));
    if (ok) advance(p, 150);
    strain = distance(p, ends[0], ends[1]) / rest - 1.0;
    patch_free(p);
    return strain;
}

TEST(woven_figures_corner) {
    CHECK(skewed(0.3) > 0.03);
    CHECK(fabs(skewed(0.0)) < 1e-6);
}

/* ---- strip ------------------------------------------------------------------------------------------------------ */

/* Each of the two yarns leaves by what friction holds at its crossings, and what tension adds there: no more. */
TEST(woven_figures_strip) {
    enum { WARPS = 6, WEFTS = 16 };
    yc_yarn_material yarn = yc_yarn_material_default();
    double most = 0.0, last = 0.0, hold, force[3];
    patch *p;
    int a, b, step, ok = 1;
    yarn.preload = 0.02;
    p = patch_new(WARPS, WEFTS, &yarn, 0);
    hold = WEFTS * yarn.friction * yarn.preload;
    a = node_of(p, YC_WARP, WARPS / 2, -1), b = node_of(p, YC_WARP, WARPS / 2 - 1, 0);
    for (step = 1; step <= 60 && ok; step++) {
        double d = 10.0 * spacing * step / 60.0;
        draw(p, a, 0.0, d, 0.0), draw(p, b, 0.0, -d, 0.0);
        ok = advance(p, 1);
        CHECK_RESULT(yc_scene_pin_force(p->scene, 0, YC_NODE, a, force), YC_OK);
        last = sqrt(force[0] * force[0] + force[1] * force[1] + force[2] * force[2]);
        most = fmax(most, last);
    }
    CHECK(most > 0.3 * hold && most < 2.0 * hold);
    CHECK(last < 0.8 * most);
    CHECK(p->released >= WEFTS);
    patch_free(p);
}

/* ---- snag ------------------------------------------------------------------------------------------------------- */

/* A crossing lifted out of a patch that is held all round but for its weft: nodes along that weft move towards it, and
 * those of its neighbours hardly. */
TEST(woven_figures_snag) {
    enum { SIDE = 16 };
    yc_yarn_material yarn = yc_yarn_material_default();
    double moved[2] = {0.0, 0.0};
    patch *p;
    int i, k, row, step, middle = SIDE / 2, hook, ok = 1;
    yarn.preload = 0.02;
    p = patch_new(SIDE, SIDE, &yarn, 0);
    hook = node_of(p, YC_WEFT, middle, middle + 1);
    for (i = 0; i < SIDE; i++)
        for (k = 0; k < 2; k++) {
            draw(p, node_of(p, YC_WARP, i, -k), 0.0, 0.0, 0.0);
            if (i != middle) draw(p, node_of(p, YC_WEFT, i, -k), 0.0, 0.0, 0.0);
        }
    for (step = 1; step <= 40 && ok; step++) {
        draw(p, hook, 0.0, 0.0, 3.0 * spacing * step / 40.0);
        ok = advance(p, 1);
    }
    for (row = 0; row < 2; row++)
        for (i = 1; i < SIDE; i++) {
            int node = node_of(p, YC_WEFT, middle - 3 * row, i);
            moved[row] += fabs(p->x[node][0] - p->yarns.layout[node][0]);
        }
    CHECK(moved[0] > 3.0 * moved[1]);
    CHECK(moved[0] > 0.02 * SIDE * spacing);
    patch_free(p);
}
