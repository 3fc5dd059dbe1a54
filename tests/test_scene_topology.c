/* Yarn networks that change while a scene runs: pull-out, fraying, snags, breaks; and that nothing else is lost. */
#include "internals.h"
#include "scenes/woven.h"
#include "test_scene.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 10 }; /* yarns each way */

/* A free plain swatch in the xy plane, its pattern's place. */
typedef struct swatch {
    yc_yarns yarns;
    yc_scene *scene;
    double mass;
} swatch;

static swatch swatch_of(const yc_host *host, int side, yc_weave_desc weave, int hold) {
    yc_scene_desc settings = yc_scene_desc_default();
    yc_cloth_desc cloth = yc_cloth_desc_default();
    swatch w;
    memset(&w, 0, sizeof w);
    weave.size[0] = side * weave.spacing[0], weave.size[1] = side * weave.spacing[1];
    memset(settings.gravity, 0, sizeof settings.gravity);
    settings.mass_damping = 20.0;
    CHECK_RESULT(yc_weave(NULL, &weave, NULL, &w.yarns, NULL), YC_OK);
    cloth.yarns = &w.yarns, cloth.hold_network = hold;
    CHECK_RESULT(yc_scene_create(host, &settings, &w.scene, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_cloth(w.scene, &cloth, NULL), YC_OK);
    CHECK_RESULT(yc_scene_momentum(w.scene, &w.mass, NULL, NULL), YC_OK);
    return w;
}

static swatch swatch_new(const yc_host *host, int side, const yc_yarn_material *yarn, double crimp, int hold) {
    yc_weave_desc weave = yc_weave_desc_default();
    weave.warp = weave.weft = *yarn, weave.crimp[0] = weave.crimp[1] = crimp;
    return swatch_of(host, side, weave, hold);
}

static void swatch_free(swatch *w) {
    yc_scene_destroy(w->scene);
    yc_yarns_destroy(&w->yarns);
}

static yc_yarn_material gripping(double preload) {
    yc_yarn_material m = yc_yarn_material_default();
    m.preload = preload;
    return m;
}

/* The node of end 0 or 1 of the k-th yarn of a family. */
static int tip_of(const yc_yarns *y, int family, int k, int end) { return scene_woven_node(y, family, k, -end); }

static void draw_node(swatch *w, int node, double dx, double dz) {
    double by[3] = {0.0, 0.0, 0.0};
    by[0] = dx, by[2] = dz;
    CHECK_RESULT(scene_woven_draw(w->scene, &w->yarns, node, by), YC_OK);
}

static void pull(swatch *w, scene_pull what, double dx) {
    double by[3] = {0.0, 0.0, 0.0};
    by[0] = dx;
    CHECK_RESULT(scene_woven_pull(w->scene, &w->yarns, what, by), YC_OK);
}

/* What holds after every step and every event. */
static int sound(const swatch *w) {
    yc_yarns now;
    double mass = 0.0, (*x)[3];
    int i, ok = CHECK_RESULT(yc_scene_network(w->scene, 0, &now), YC_OK);
    char why[YC_MESSAGE_SIZE];
    if (!ok) return 0;
    ok = CHECK_RESULT(yc_yarns_check(&now, NULL, why), YC_OK);
    if (!ok) printf("%s\n", why);
    ok = ok && CHECK(now.node_count >= w->yarns.node_count && now.yarn_count >= w->yarns.yarn_count);
    for (i = 0; ok && i < now.visit_count; i++) ok = CHECK(now.visit_layer[i] == 0 || !now.visit_held[i]);
    CHECK_RESULT(yc_scene_momentum(w->scene, &mass, NULL, NULL), YC_OK);
    ok = ok && CHECK_NEAR(mass / w->mass, 1.0, 1e-12);
    x = (double(*)[3])malloc((size_t)now.node_count * sizeof *x);
    CHECK_RESULT(yc_scene_positions(w->scene, 0, YC_NODE, x), YC_OK);
    for (i = 0; ok && i < 3 * now.node_count; i++) ok = CHECK(fabs(x[i / 3][i % 3]) < 100.0);
    free(x);
    return ok;
}

/* Brings about what is due, on its own, and compares mass and momentum; returns the number of events. */
static int change(swatch *w) {
    double mass[2], before[3], after[3], speed = 0.0;
    int i, events = w->scene->event_count;
    CHECK_RESULT(yc_scene_momentum(w->scene, &mass[0], before, NULL), YC_OK);
    for (i = 0; i < 3 * w->scene->nodes; i++) speed = fmax(speed, fabs(w->scene->velocity[i]));
    if (!CHECK_RESULT(yci_change_networks(w->scene), YC_OK)) return 0;
    yci_change_settle(w->scene, 0);
    CHECK_RESULT(yc_scene_momentum(w->scene, &mass[1], after, NULL), YC_OK);
    CHECK_NEAR(mass[1] / mass[0], 1.0, 1e-12);
    for (i = 0; i < w->scene->nodes && !w->scene->pin[i]; i++) {}
    if (i == w->scene->nodes) CHECK_NEAR_ALL(after, before, 3, 1e-12 * (mass[0] * speed + 1e-12));
    events = w->scene->event_count - events;
    w->scene->event_count = 0;
    return events;
}

static int count_events(const yc_scene *scene, yc_event_type type) {
    int i, n, found = 0;
    const yc_event *e = yc_scene_events(scene, &n);
    for (i = 0; i < n; i++) found += e[i].type == type;
    return found;
}

/* ---- pull-out ------------------------------------------------------------------------------------------------- */

/* A weft drawn out by its right end leaves the warps from left to right, and each takes its share of friction. */
static void check_pull_out(double crimp) {
    yc_yarn_material yarn = gripping(0.05);
    swatch w = swatch_new(NULL, SIDE, &yarn, crimp, 0);
    double plateau[SIDE + 1], force[3], last = 0.0;
    int tip = scene_woven_drawn(&w.yarns, SCENE_PULLOUT), weft = SIDE + SIDE / 2, step, i, n, released = 0, loose = 0,
        ok = 1;
    memset(plateau, 0, sizeof plateau);
    for (step = 1; step <= 140 && ok; step++) {
        const yc_event *e;
        yc_stats stats;
        pull(&w, SCENE_PULLOUT, 0.05 * 5e-3 * step);
        ok = CHECK_RESULT(yc_scene_step(w.scene, 5e-3, &stats), YC_OK) && sound(&w);
        e = yc_scene_events(w.scene, &n);
        CHECK(stats.events == n);
        for (i = 0; i < n; i++) {
            CHECK(e[i].cloth == 0 && e[i].yarn == weft && e[i].time >= last && e[i].time <= yc_scene_time(w.scene));
            last = e[i].time;
            if (e[i].type == YC_EVENT_RELEASE) CHECK(e[i].other == released++);
            else if (e[i].type == YC_EVENT_LOOSE) CHECK(released == SIDE), loose++;
            else CHECK(e[i].type == YC_EVENT_SPLIT && e[i].node >= w.yarns.node_count);
        }
        CHECK_RESULT(yc_scene_pin_force(w.scene, 0, YC_NODE, tip, force), YC_OK);
        plateau[released] = force[0]; /* the last before the next release */
    }
    CHECK(released == SIDE && loose == 1);
    /* Friction 0.3 times preload 0.05 N a crossing, and the compression that tension makes. Where it undulates the last
     * crossings are left several in a step, as the yarn grows longer by straightening. */
    for (i = 0; i < SIDE; i++) {
        double least = 0.3 * 0.05 * (SIDE - i);
        if (crimp > 0.0) CHECK((i > 6 && plateau[i] == 0.0) || (plateau[i] > 0.75 * least && plateau[i] < 1.5 * least));
        else CHECK(plateau[i] > least && plateau[i] < 1.35 * least + 1e-3);
    }
    CHECK_NEAR(plateau[SIDE], 0.0, 1e-4);
    swatch_free(&w);
}

TEST(scene_topology_pull_out) { check_pull_out(0.0); }
TEST(scene_topology_pull_out_of_crimped_cloth) { check_pull_out(0.06); }

/* A shirting at its true density. What is drawn out gets node after node, each in the middle of a segment: their places
 * in the layout come as close together as that, which must not count as a wave at rest. */
TEST(scene_topology_pull_out_of_shirting) {
    yc_fabric shirting;
    swatch w;
    int step, newton = 0, substeps = 0, rejected = 0, released = 0, split = 0, i, ok = 1;
    double highest = 0.0, radius;
    CHECK_RESULT(yc_fabric_get(YC_FABRIC_SHIRTING, &shirting), YC_OK);
    w = swatch_of(NULL, SIDE, shirting.weave, 0);
    radius = shirting.weave.weft.radius;
    for (step = 1; step <= 60 && ok; step++) {
        yc_stats stats;
        pull(&w, SCENE_PULLOUT, 0.02 * 5e-3 * step);
        ok = CHECK_RESULT(yc_scene_step(w.scene, 5e-3, &stats), YC_OK) && sound(&w);
        newton += stats.newton, substeps += stats.substeps, rejected += stats.rejected;
        released += count_events(w.scene, YC_EVENT_RELEASE), split += count_events(w.scene, YC_EVENT_SPLIT);
        for (i = w.scene->vertices; i < w.scene->nodes; i++) highest = fmax(highest, fabs(w.scene->z[i]));
    }
    printf("   %d sub-steps, %d rejected, Newton %.1f, highest z %.2f radii\n", substeps, rejected,
        (double)newton / substeps, highest / radius);
    CHECK(released == SIDE && split > 5);
    CHECK(rejected == 0 && newton <= 6 * substeps && highest < 2.0 * radius);
    swatch_free(&w);
}

/* The same with a network that is held, and with a secured end: nothing leaves, the force only grows. */
TEST(scene_topology_held) {
    yc_yarn_material yarn = gripping(0.01);
    int way;
    for (way = 0; way < 2; way++) {
        swatch w = swatch_new(NULL, SIDE, &yarn, 0.0, way == 0);
        int step, ok = 1;
        double force[3];
        if (way) { /* the far end of that weft; the scene's own copy, since nothing else needs another network here */
            yc_yarns *own = &w.scene->cloth[0].yarns;
            own->visit_held[own->yarn_first[SIDE + SIDE / 2]] = 2;
        }
        for (step = 1; step <= 30 && ok; step++) {
            pull(&w, SCENE_PULLOUT, 0.02 * 5e-3 * step);
            ok = CHECK_RESULT(yc_scene_step(w.scene, 5e-3, NULL), YC_OK) && sound(&w);
            CHECK(count_events(w.scene, YC_EVENT_RELEASE) == 0);
        }
        CHECK_RESULT(yc_scene_pin_force(w.scene, 0, YC_NODE, scene_woven_drawn(&w.yarns, SCENE_PULLOUT), force), YC_OK);
        CHECK(force[0] > 1.2 * SIDE * 0.3 * 0.01);
        swatch_free(&w);
    }
}

/* ---- fraying, snag -------------------------------------------------------------------------------------------- */

/* The outermost warp is drawn off the edge by its first end: all wefts slide out of it, or it out of them. */
TEST(scene_topology_fray) {
    yc_yarn_material yarn = gripping(0.01);
    swatch w = swatch_new(NULL, SIDE, &yarn, 0.0, 0);
    int step, i, n, released = 0, loose = 0, seen[SIDE] = {0}, ok = 1;
    for (step = 1; step <= 140 && ok; step++) {
        const yc_event *e;
        pull(&w, SCENE_FRAY, 0.05 * 5e-3 * step);
        ok = CHECK_RESULT(yc_scene_step(w.scene, 5e-3, NULL), YC_OK) && sound(&w);
        e = yc_scene_events(w.scene, &n);
        for (i = 0; i < n; i++) {
            if (e[i].type == YC_EVENT_RELEASE) {
                int weft = e[i].yarn > e[i].other ? e[i].yarn : e[i].other, warp = e[i].yarn + e[i].other - weft;
                if (CHECK(warp == SIDE - 1 && weft >= SIDE && !seen[weft - SIDE])) seen[weft - SIDE] = 1;
                released++;
            } else if (e[i].type == YC_EVENT_SPLIT) CHECK(e[i].yarn == SIDE - 1);
            else if (CHECK(e[i].type == YC_EVENT_LOOSE)) loose++, CHECK(e[i].yarn == SIDE - 1);
        }
    }
    CHECK(released == SIDE && loose == 1);
    swatch_free(&w);
}

/* A swatch over a mesh of CELLS x CELLS cells, whose highest row of vertices has that alpha, the others 1. */
enum { CELLS = 4, CORNERS = (CELLS + 1) * (CELLS + 1) };
typedef struct meshed {
    double positions[CORNERS][3], uv[CORNERS][2], alpha[CORNERS];
    int triangles[2 * CELLS * CELLS][3];
    yc_mesh mesh;
} meshed;

static swatch swatch_on_mesh(meshed *m, double alpha) {
    yc_weave_desc weave = yc_weave_desc_default();
    yc_scene_desc settings = yc_scene_desc_default();
    yc_cloth_desc cloth = yc_cloth_desc_default();
    swatch w;
    int i, k;
    memset(m, 0, sizeof *m), memset(&w, 0, sizeof w);
    for (i = 0; i < CORNERS; i++) {
        for (k = 0; k < 2; k++)
            m->positions[i][k] = m->uv[i][k] =
                SIDE * weave.spacing[k] * (k ? i / (CELLS + 1) : i % (CELLS + 1)) / CELLS;
        m->alpha[i] = i / (CELLS + 1) == CELLS ? alpha : 1.0;
    }
    for (i = 0; i < 2 * CELLS * CELLS; i++) {
        int a = i / 2 + i / 2 / CELLS, *t = m->triangles[i];
        t[0] = a, t[1] = i % 2 ? a + CELLS + 2 : a + 1, t[2] = i % 2 ? a + CELLS + 1 : a + CELLS + 2;
    }
    m->mesh.vertex_count = m->mesh.uv_count = CORNERS, m->mesh.triangle_count = 2 * CELLS * CELLS;
    m->mesh.positions = (const double(*)[3])m->positions, m->mesh.uv = (const double(*)[2])m->uv;
    m->mesh.triangles = (const int(*)[3])m->triangles;
    weave.warp.preload = weave.weft.preload = 0.02;
    memset(settings.gravity, 0, sizeof settings.gravity);
    settings.mass_damping = 20.0;
    CHECK_RESULT(yc_weave(NULL, &weave, &m->mesh, &w.yarns, NULL), YC_OK);
    cloth.mesh = m->mesh, cloth.yarns = &w.yarns, cloth.alpha = m->alpha;
    CHECK_RESULT(yc_scene_create(NULL, &settings, &w.scene, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_cloth(w.scene, &cloth, NULL), YC_OK);
    CHECK_RESULT(yc_scene_momentum(w.scene, &w.mass, NULL, NULL), YC_OK);
    return w;
}

/* Releases, and how many yarns have come loose. */
static void leave_mesh(double alpha, scene_pull what, int *released, int *loose) {
    meshed *m = (meshed *)malloc(sizeof *m);
    swatch w = swatch_on_mesh(m, alpha);
    int step, ok = 1;
    char why[YC_MESSAGE_SIZE];
    *released = *loose = 0;
    for (step = 1; step <= 140 && ok; step++) {
        yc_yarns now;
        pull(&w, what, 0.01 * SIDE * 2.5e-3 * step);
        ok = CHECK_RESULT(yc_scene_step(w.scene, 5e-3, NULL), YC_OK) && sound(&w);
        CHECK_RESULT(yc_scene_network(w.scene, 0, &now), YC_OK);
        if (!CHECK_RESULT(yc_yarns_check(&now, &m->mesh, why), YC_OK)) printf("   %s\n", why);
        *released += count_events(w.scene, YC_EVENT_RELEASE), *loose += count_events(w.scene, YC_EVENT_LOOSE);
    }
    swatch_free(&w), free(m);
}

/* Where alpha is 1 yarns leave cloth over a mesh as they leave yarns alone; the two wefts that lie in the row where it
 * falls to 0 go on holding the warp. */
TEST(scene_topology_leave_a_mesh) {
    int released, loose, i;
    for (i = 0; i < 4; i++) {
        int kept = i == 3 ? 2 : 0;
        leave_mesh(i % 2 ? 0.0 : 1.0, i < 2 ? SCENE_PULLOUT : SCENE_FRAY, &released, &loose);
        CHECK(released == SIDE - kept && loose == !kept);
    }
}

/* What lies of the yarns of a node between it and those before and after it, the less of both yarns, in spacings. */
static double held_by(const swatch *w, int node) {
    const yc_yarns *y = &w->scene->cloth[0].yarns;
    double least = HUGE_VAL;
    int i, k;
    for (i = 0; i < y->yarn_count; i++)
        for (k = y->yarn_first[i] + 1; k + 1 < y->yarn_first[i + 1]; k++)
            if (y->visit_node[k] == node) least = fmin(least, (w->scene->u[k + 1] - w->scene->u[k - 1]) / 5e-3);
    return least;
}

/* A crossing lifted out of the plane draws both its yarns in: they slide through their neighbours, which come closer
 * in material, and with strong yarns nothing breaks. The loop's sides are no longer than sqrt(h^2 + 1) spacings, less
 * since the crossings beside it rise too. Let go, it keeps what it has drawn in: nothing pushes that back but the
 * bending of its yarns, EI / spacing^2 = 0.5 mN, less than what the four crossings on one side hold, 2.4 mN. */
TEST(scene_topology_snag) {
    yc_yarn_material yarn = gripping(0.002);
    swatch w;
    int middle = (SIDE / 2) * SIDE + SIDE / 2, step, i, k, ok = 1;
    double hooked = 0.0, kept;
    yarn.strength = 5.0;
    w = swatch_new(NULL, SIDE, &yarn, 0.0, 0);
    for (i = 0; i < 2; i++)
        for (k = 0; k < 2; k++)
            draw_node(&w, tip_of(&w.yarns, i ? YC_WEFT : YC_WARP, 0, k), 0.0, 0.0),
                draw_node(&w, tip_of(&w.yarns, i ? YC_WEFT : YC_WARP, SIDE - 1, k), 0.0, 0.0);
    for (step = 1; step <= 140 && ok; step++) {
        if (step <= 60) draw_node(&w, middle, 0.0, 5e-3 * step / 60.0);
        if (step == 61) {
            hooked = held_by(&w, middle);
            CHECK_RESULT(yc_scene_unpin(w.scene, 0, YC_NODE, middle), YC_OK);
        }
        ok = CHECK_RESULT(yc_scene_step(w.scene, 5e-3, NULL), YC_OK) && sound(&w);
        CHECK(count_events(w.scene, YC_EVENT_BREAK) == 0);
    }
    kept = held_by(&w, middle);
    printf("   a loop of %.2f spacings keeps %.2f, at a height of %.2f\n", hooked, kept,
        w.scene->x[3 * middle + 2] / 2.5e-3);
    CHECK(hooked > 1.05 && hooked < sqrt(5.0));
    CHECK(kept - 1.0 > 0.8 * (hooked - 1.0));
    swatch_free(&w);
}

/* ---- crossings crowd ------------------------------------------------------------------------------------------ */

/* The least length of yarn between neighbouring crossings, over that at which the yarns that cross there touch. */
static double least_apart(const swatch *w, double touching) {
    yc_yarns now;
    double least = HUGE_VAL;
    int i, k, *visits;
    CHECK_RESULT(yc_scene_network(w->scene, 0, &now), YC_OK);
    visits = (int *)calloc((size_t)now.node_count, sizeof *visits);
    for (i = 0; i < now.visit_count; i++) visits[now.visit_node[i]]++;
    for (i = 0; i < now.yarn_count; i++)
        for (k = now.yarn_first[i]; k + 1 < now.yarn_first[i + 1]; k++)
            if (visits[now.visit_node[k]] > 1 && visits[now.visit_node[k + 1]] > 1)
                least = fmin(least, (now.visit_u[k + 1] - now.visit_u[k]) / touching);
    free(visits);
    return least;
}

/* Two neighbouring warps are drawn by their ends to each other's place, so that they strangle each other all along, and
 * then a weft is drawn through the cloth. */
static double crowded(double contact) {
    yc_weave_desc weave = yc_weave_desc_default();
    yc_yarn_material yarn = gripping(0.005);
    double touching = 2.0 * yarn.radius, least = HUGE_VAL;
    int step, k, ok = 1, merged = 0;
    swatch w;
    yarn.contact *= contact;
    weave.spacing[0] = weave.spacing[1] = 2.5 * touching, weave.warp = weave.weft = yarn;
    w = swatch_of(NULL, SIDE, weave, 0);
    for (step = 1; step <= 80 && ok; step++) {
        double by = weave.spacing[0] * (step < 40 ? step : 40) / 40.0;
        pull(&w, SCENE_PULLOUT, step > 40 ? 0.1 * weave.spacing[0] * (step - 40) : 0.0);
        for (k = 0; k < 4; k++)
            draw_node(&w, tip_of(&w.yarns, YC_WARP, SIDE / 2 - k / 2, k % 2), k / 2 ? by : -by, 0.0);
        ok = CHECK_RESULT(yc_scene_step(w.scene, 5e-3, NULL), YC_OK) && sound(&w);
        least = fmin(least, least_apart(&w, touching)), merged += count_events(w.scene, YC_EVENT_MERGE);
    }
    CHECK(merged == 0);
    swatch_free(&w);
    return least;
}

/* No event merges them. Contact keeps more than half of the touching distance; without it, the floor under a segment's
 * length a twentieth. */
TEST(scene_topology_crossings_stay_apart) {
    double least[3];
    least[0] = crowded(1.0), least[1] = crowded(0.0), least[2] = crowded(1e3);
    printf("   crowded crossings: %.3f touching distances apart at least, without contact %.3f, times 1000 %.3f\n",
        least[0], least[1], least[2]);
    CHECK(least[0] > 0.5 && least[1] > 0.05 && least[2] > 0.9);
    CHECK(least[1] < 0.5 && least[0] < 0.9); /* else they were not crowded */
}

/* ---- breaks --------------------------------------------------------------------------------------------------- */

/* A yarn of `pieces` segments, straight, in a scene without gravity. */
typedef struct thread {
    yc_yarn_material material;
    double layout[20][3], u[20];
    int first[2], visit_node[20], yarn_material;
    unsigned char family, held[20];
    signed char layer[20];
    yc_yarns yarns;
} thread;

static swatch thread_new(thread *t, int pieces, double length, double strength, double damping) {
    yc_scene_desc settings = yc_scene_desc_default();
    yc_cloth_desc cloth = yc_cloth_desc_default();
    swatch w;
    int i;
    memset(t, 0, sizeof *t), memset(&w, 0, sizeof w);
    t->material = yc_yarn_material_default(), t->material.strength = strength;
    for (i = 0; i <= pieces; i++) t->layout[i][0] = t->u[i] = length * i / pieces, t->visit_node[i] = i, t->held[i] = 1;
    t->first[1] = pieces + 1;
    t->yarns.node_count = t->yarns.visit_count = pieces + 1, t->yarns.yarn_count = t->yarns.material_count = 1;
    t->yarns.layout = t->layout, t->yarns.yarn_first = t->first, t->yarns.yarn_family = &t->family;
    t->yarns.yarn_material = &t->yarn_material, t->yarns.visit_node = t->visit_node, t->yarns.visit_u = t->u;
    t->yarns.visit_layer = t->layer, t->yarns.visit_held = t->held, t->yarns.materials = &t->material;
    memset(settings.gravity, 0, sizeof settings.gravity);
    settings.mass_damping = damping, settings.tolerance = 1e-9;
    w.yarns = t->yarns, cloth.yarns = &t->yarns;
    CHECK_RESULT(yc_scene_create(NULL, &settings, &w.scene, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_cloth(w.scene, &cloth, NULL), YC_OK);
    CHECK_RESULT(yc_scene_momentum(w.scene, &w.mass, NULL, NULL), YC_OK);
    return w;
}

/* Stretched by its ends it breaks once, at 2 N, and both halves fly apart with opposite momentum. */
TEST(scene_topology_break) {
    thread t;
    swatch w = thread_new(&t, 7, 0.05, 2.0, 0.0);
    int step, i, n, broken = 0;
    double before[3], after[3], middle[3], speed = 0.0;
    for (step = 1; step <= 30 && !broken; step++) {
        const yc_event *e;
        draw_node(&w, 0, -5e-5 * step, 0.0), draw_node(&w, 7, 5e-5 * step, 0.0);
        if (!CHECK_RESULT(yc_scene_step(w.scene, 1e-3, NULL), YC_OK) || !sound(&w)) break;
        e = yc_scene_events(w.scene, &n);
        for (i = 0; i < n; i++) {
            broken += e[i].type == YC_EVENT_BREAK;
            CHECK(e[i].type == YC_EVENT_BREAK && e[i].yarn == 0 && e[i].other == 1 && e[i].node == 8);
        }
        /* At 50 N stiffness it takes 4 % of 5 cm, drawn by 0.1 mm a step. */
        CHECK(!broken || abs(step - 21) <= 1);
    }
    CHECK(broken == 1);
    CHECK_RESULT(yc_scene_unpin(w.scene, 0, YC_NODE, 0), YC_OK);
    CHECK_RESULT(yc_scene_unpin(w.scene, 0, YC_NODE, 7), YC_OK);
    CHECK_RESULT(yc_scene_momentum(w.scene, NULL, before, NULL), YC_OK);
    for (step = 0; step < 20; step++) CHECK_RESULT(yc_scene_step(w.scene, 1e-3, NULL), YC_OK);
    sound(&w);
    CHECK_RESULT(yc_scene_momentum(w.scene, NULL, after, NULL), YC_OK);
    for (i = 0; i < w.scene->nodes; i++) speed = fmax(speed, fabs(w.scene->velocity[3 * i]));
    CHECK(speed > 0.1);
    CHECK_NEAR_ALL(after, before, 3, 1e-9 * w.mass);
    memcpy(middle, w.scene->x + 3 * 8, sizeof middle);
    CHECK(middle[0] < w.scene->x[3 * 9]); /* the halves are apart */
    CHECK(w.scene->cloth[0].yarns.yarn_count == 2 && w.scene->cloth[0].yarns.node_count == 10);
    CHECK_RESULT(yc_scene_step(w.scene, 1e-3, NULL), YC_OK);
    yc_scene_events(w.scene, &n);
    CHECK(n == 0);
    yc_scene_destroy(w.scene);
}

/* ---- promises ------------------------------------------------------------------------------------------------- */

/* Kicks at random places, sometimes a pin. */
static void abuse(swatch *w, uint64_t *state, int pins) {
    int node = test_random_int(state, w->scene->nodes);
    double v[3], at[3];
    test_random_array(state, -1.0, 1.0, v, 3), test_random_array(state, -2e-3, 2e-3, at, 3);
    CHECK_RESULT(yc_scene_set_velocity(w->scene, 0, YC_NODE, node, v), YC_OK);
    if (!pins) return;
    node = test_random_int(state, w->scene->nodes);
    if (w->scene->pin[node]) CHECK_RESULT(yc_scene_unpin(w->scene, 0, YC_NODE, node), YC_OK);
    else {
        yci_axpy(at, 1.0, w->scene->x + 3 * node);
        CHECK_RESULT(yc_scene_pin(w->scene, 0, YC_NODE, node, at), YC_OK);
    }
}

static yc_yarn_material fragile(void) {
    yc_yarn_material m = gripping(0.0);
    m.strength = 1.0, m.friction = 0.05;
    return m;
}

/* A step that is too rough may be refused; then all is as before it, and the next kick may be milder. */
TEST(scene_topology_abuse) {
    yc_yarn_material yarn = fragile();
    int pass, kinds[5] = {0}, refused = 0;
    for (pass = 0; pass < 4; pass++) {
        swatch w = swatch_new(NULL, 5, &yarn, pass < 2 ? 0.0 : 0.06, 0);
        uint64_t state = 11;
        int step, i, n, ok = 1;
        for (step = 0; step < 100 && ok; step++) {
            const yc_event *e;
            yc_result result;
            abuse(&w, &state, pass % 2);
            result = yc_scene_step(w.scene, 4e-3, NULL);
            refused += result != YC_OK;
            ok = CHECK(result == YC_OK || result == YC_ERROR_DIVERGED) && sound(&w);
            e = yc_scene_events(w.scene, &n);
            for (i = 0; i < n; i++) kinds[e[i].type]++;
            w.scene->event_count = 0;
            change(&w), ok = ok && sound(&w);
        }
        swatch_free(&w);
    }
    for (pass = 0; pass < 5; pass++) CHECK(kinds[pass] > 0);
    CHECK(refused < 20);
}

/* Steps `from` to `to` of a rough life with many events; returns them. */
static int live(swatch *w, int from, int to) {
    int step, n, events = 0;
    for (step = from; step < to; step++) {
        uint64_t state = (uint64_t)step + 3;
        abuse(w, &state, step % 3 == 0);
        if (!CHECK_RESULT(yc_scene_step(w->scene, 4e-3, NULL), YC_OK)) break;
        yc_scene_events(w->scene, &n);
        events += n;
    }
    return events;
}

/* A saved state brings its network along, into a scene that has another, earlier or later. */
static void check_save_and_load(double crimp) {
    yc_yarn_material yarn = fragile();
    swatch a = swatch_new(NULL, 4, &yarn, crimp, 0), b = swatch_new(NULL, 4, &yarn, crimp, 0),
           other = swatch_new(NULL, 5, &yarn, crimp, 0);
    test_saved start = test_save(a.scene), middle, end, again;
    uint64_t state = 5;
    char *bad;
    int i;
    CHECK(live(&a, 0, 15) > 3);
    middle = test_save(a.scene);
    CHECK(live(&a, 15, 50) > 3);
    end = test_save(a.scene);
    CHECK_RESULT(yc_scene_load(b.scene, middle.bytes, middle.size), YC_OK);
    sound(&b), live(&b, 15, 50);
    again = test_save(b.scene);
    CHECK(test_same(end, again));
    free(again.bytes);
    CHECK_RESULT(yc_scene_load(a.scene, start.bytes, start.size), YC_OK); /* back to what was laid */
    sound(&a), live(&a, 0, 15);
    again = test_save(a.scene);
    CHECK(test_same(middle, again));
    free(again.bytes);
    CHECK_RESULT(yc_scene_load(other.scene, middle.bytes, middle.size), YC_ERROR_PARSE);
    bad = (char *)malloc(end.size);
    for (i = 0; i < 400; i++) { /* whatever is in it, either it is a sound state or it is refused */
        size_t size = end.size;
        int k;
        memcpy(bad, end.bytes, end.size);
        for (k = 0; k < 4; k++) {
            size_t low = i % 2 ? 0 : end.size / 2; /* networks stand in the latter part */
            bad[low + (size_t)test_random_int(&state, (int)(end.size - low))] = (char)test_random_int(&state, 256);
        }
        if (i % 5 == 0) size = (size_t)test_random_int(&state, (int)size);
        if (yc_scene_load(b.scene, bad, size) == YC_OK) {
            yc_yarns now;
            CHECK_RESULT(yc_scene_network(b.scene, 0, &now), YC_OK);
            CHECK_RESULT(yc_yarns_check(&now, NULL, NULL), YC_OK);
        }
    }
    CHECK_RESULT(yc_scene_load(b.scene, end.bytes, end.size), YC_OK);
    free(bad), free(start.bytes), free(middle.bytes), free(end.bytes);
    swatch_free(&a), swatch_free(&b), swatch_free(&other);
}

TEST(scene_topology_save_and_load) { check_save_and_load(0.0); }
TEST(scene_topology_save_and_load_crimp) { check_save_and_load(0.06); }

/* An allocation that fails during a step with events, or a host that cancels it, leaves everything as it was. */
TEST(scene_topology_failing_allocations) {
    yc_yarn_material yarn = fragile();
    yc_host host = test_host_counting();
    swatch w = swatch_new(&host, 3, &yarn, 0.0, 0);
    test_saved before, after, done;
    const yc_event *e;
    int n, i, events = 0, refused = 1, step;
    for (step = 0; step < 60; step++) { /* to just before a step with several events */
        before = test_save(w.scene);
        events = live(&w, step, step + 1);
        if (events > 2) break;
        free(before.bytes);
    }
    if (!CHECK(step < 60)) {
        swatch_free(&w);
        return;
    }
    done = test_save(w.scene);
    for (n = 0; refused && n < 5000; n += 1 + n / 16) {
        yc_result result;
        uint64_t state = (uint64_t)step + 3;
        CHECK_RESULT(yc_scene_load(w.scene, before.bytes, before.size), YC_OK);
        abuse(&w, &state, step % 3 == 0);
        after = test_save(w.scene);
        test_heap_grant(n);
        result = yc_scene_step(w.scene, 4e-3, NULL);
        test_heap_grant(-1);
        refused = result == YC_ERROR_MEMORY;
        e = yc_scene_events(w.scene, &i);
        CHECK(refused ? i == 0 : i == events && e);
        if (refused) {
            test_saved now = test_save(w.scene);
            if (!CHECK(test_same(now, after))) refused = 0;
            free(now.bytes);
        } else CHECK_RESULT(result, YC_OK);
        free(after.bytes);
    }
    after = test_save(w.scene);
    CHECK(test_same(after, done) && n > 100);
    free(after.bytes), free(before.bytes), free(done.bytes);
    swatch_free(&w);
    CHECK(test_heap.live == 0);
}

TEST(scene_topology_same_bits_for_any_workers) {
    static const int workers[] = {1, 0, 3};
    yc_yarn_material yarn = fragile();
    test_saved first, other;
    int i;
    first.bytes = NULL, first.size = 0;
    for (i = 0; i < 3; i++) {
        yc_host host = test_host_threads(workers[i]);
        swatch w = swatch_new(&host, 4, &yarn, 0.0, 0);
        CHECK(live(&w, 0, 30) > 3);
        other = test_save(w.scene);
        if (i) CHECK(test_same(first, other)), free(other.bytes);
        else first = other;
        swatch_free(&w);
    }
    free(first.bytes);
}

/* ---- seams of nodes ------------------------------------------------------------------------------------------- */

/* Two swatches side by side, sewn weft end to weft end: drawn together in close_time, and kept there. */
TEST(scene_topology_seam_of_nodes) {
    yc_yarn_material yarn = gripping(0.05);
    swatch w = swatch_new(NULL, 3, &yarn, 0.0, 0);
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_seam_desc seam = yc_seam_desc_default();
    double(*place)[3] = (double(*)[3])malloc((size_t)w.yarns.node_count * sizeof *place), x[2][64][3], gap = 0.0, d[3];
    int a[3], b[3], i, step;
    CHECK(w.yarns.node_count <= 64);
    for (i = 0; i < w.yarns.node_count; i++)
        memcpy(place[i], w.yarns.layout[i], sizeof place[i]), place[i][0] += 3.1 * 2.5e-3;
    cloth.yarns = &w.yarns, cloth.yarn_positions = (const double(*)[3])place;
    CHECK_RESULT(yc_scene_add_cloth(w.scene, &cloth, NULL), YC_OK);
    for (i = 0; i < 3; i++) a[i] = tip_of(&w.yarns, YC_WEFT, i, 1), b[i] = tip_of(&w.yarns, YC_WEFT, i, 0);
    seam.cloth[1] = 1, seam.kind = YC_NODE, seam.count = 3, seam.a = a, seam.b = b, seam.close_time = 0.05;
    b[1] = w.yarns.node_count;
    CHECK_RESULT(yc_scene_add_seam(w.scene, &seam, NULL), YC_ERROR_ARGUMENT);
    CHECK(strstr(yc_scene_message(w.scene), "seam.b[1]") != NULL);
    b[1] = tip_of(&w.yarns, YC_WEFT, 1, 0);
    CHECK_RESULT(yc_scene_add_seam(w.scene, &seam, NULL), YC_OK);
    for (step = 0; step < 40; step++) {
        CHECK_RESULT(yc_scene_step(w.scene, 5e-3, NULL), YC_OK);
        for (i = 0; i < 2; i++) CHECK_RESULT(yc_scene_positions(w.scene, i, YC_NODE, x[i]), YC_OK);
    }
    for (i = 0; i < 3; i++) yci_sub(d, x[0][a[i]], x[1][b[i]]), gap = fmax(gap, yci_norm(d));
    CHECK(gap < 0.02 * 0.1 * 2.5e-3 + 1e-5);
    free(place);
    swatch_free(&w);
}
