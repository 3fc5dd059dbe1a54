/* Knits that come undone while a scene runs: loops slip out in order, yarns part, and nothing else is lost. */
#include "internals.h"
#include "scenes/knits.h"
#include "test_scene.h"
#include <math.h>
#include <stdio.h>

/* What holds after every step and every event: beyond yc_yarns_check, the layers of a node are those of a stack, lone
 * visits do not slide, a stitch contact's new loop lies outside of its stack; mass stays. */
static int sound(yc_scene *scene, double expected) {
    yc_yarns now;
    char why[YC_MESSAGE_SIZE] = "";
    double mass = 0.0;
    int i, k, ok, *count, *sum;
    memset(&now, 0, sizeof now);
    if (!CHECK_RESULT(yc_scene_network(scene, 0, &now), YC_OK)) return 0;
    ok = CHECK_RESULT(yc_yarns_check(&now, NULL, why), YC_OK);
    if (!ok) printf("%s\n", why);
    count = (int *)calloc(2 * (size_t)now.node_count, sizeof *count), sum = count + now.node_count;
    for (i = 0; i < now.visit_count; i++) count[now.visit_node[i]]++;
    for (i = 0; ok && i < now.visit_count; i++) {
        int n = count[now.visit_node[i]], layer = now.visit_layer[i];
        if (n > 1) ok = CHECK(abs(layer) < n && (layer + n) % 2 == 1), sum[now.visit_node[i]] |= 1 << (layer + n - 1);
        else ok = CHECK(layer == 0 && now.visit_held[i]);
    }
    for (i = 0; ok && i < now.node_count; i++)
        for (k = 0; ok && k < count[i] && count[i] > 1; k++) ok = CHECK(sum[i] >> 2 * k & 1);
    for (i = 0; ok && i < 2 * now.contact_count; i++) {
        int fresh = now.contacts[i / 2].visit[1][i % 2];
        ok = CHECK(abs(now.visit_layer[fresh]) == count[now.visit_node[fresh]] - 1);
    }
    for (i = 0; ok && i < 3 * scene->nodes; i++) ok = CHECK(fabs(scene->x[i]) < 100.0);
    CHECK_RESULT(yc_scene_momentum(scene, &mass, NULL, NULL), YC_OK);
    free(count);
    return ok && CHECK_NEAR(mass / expected, 1.0, 1e-12);
}

static double mass_of(yc_scene *scene) {
    double mass = 0.0;
    CHECK_RESULT(yc_scene_momentum(scene, &mass, NULL, NULL), YC_OK);
    return mass;
}

/* Brings about what is due, on its own: mass, positions and, where nothing is pinned, momentum stay; what energy it
 * brings is added to gain[0], what it takes to gain[1]. Its events lie behind those of the last step. */
static void change(yc_scene *scene, double gain[2]) {
    double mass[2], before[3], after[3], speed = 0.0, terms[2][YC_TERM_COUNT], sum = 0.0;
    int i;
    CHECK_RESULT(yc_scene_momentum(scene, &mass[0], before, NULL), YC_OK);
    CHECK_RESULT(yc_scene_energy(scene, terms[0]), YC_OK);
    for (i = 0; i < 3 * scene->nodes; i++) speed = fmax(speed, fabs(scene->velocity[i]));
    if (!CHECK_RESULT(yci_change_networks(scene), YC_OK)) return;
    yci_change_settle(scene, 0);
    CHECK_RESULT(yc_scene_momentum(scene, &mass[1], after, NULL), YC_OK);
    CHECK_RESULT(yc_scene_energy(scene, terms[1]), YC_OK);
    CHECK_NEAR(mass[1] / mass[0], 1.0, 1e-12);
    for (i = 0; i < scene->nodes && !scene->pin[i]; i++) {}
    if (i == scene->nodes) CHECK_NEAR_ALL(after, before, 3, 1e-12 * (mass[0] * speed + 1e-12));
    for (i = 0; i < YC_TERM_COUNT; i++) sum += terms[1][i] - terms[0][i];
    gain[sum < 0.0] += sum;
}

/* ---- a live row ----------------------------------------------------------------------------------------------- */

typedef struct tally {
    int slipped, parted, last, stitches;
} tally;

static void tell(tally *t, const yc_event *e, int n) {
    int i;
    for (i = 0; i < n; i++) {
        CHECK(e[i].type == YC_EVENT_SLIP || e[i].type == YC_EVENT_PART || e[i].type == YC_EVENT_MERGE ||
            e[i].type == YC_EVENT_SPLIT);
        t->parted += e[i].type == YC_EVENT_PART;
        if (e[i].type != YC_EVENT_SLIP) continue;
        if (t->slipped && t->slipped < t->stitches) CHECK(e[i].node == t->last - 8); /* numbered along the yarn */
        t->slipped++, t->last = e[i].node;
    }
}

/* Draws the end of a piece until its last row has gone: loop by loop, from the end on. */
static void unravel(const char *rows, int stitches, int row_count, double share) {
    char why[YC_MESSAGE_SIZE] = "";
    scene_unravel *u = scene_unravel_new(NULL, rows, stitches, row_count, why);
    double mass, most = 0.0, mean = 0.0, expected, gain[2] = {0.0, 0.0}, terms[YC_TERM_COUNT], work = 0.0, start = 0.0;
    int step, ok = u != NULL, newton = 0, substeps = 0, rejected = 0, i;
    tally t = {0, 0, 0, 0};
    if (!CHECK(ok)) {
        printf("%s\n", why);
        return;
    }
    t.stitches = stitches, mass = mass_of(u->scene);
    CHECK_RESULT(yc_scene_energy(u->scene, terms), YC_OK);
    for (i = 0; i < YC_TERM_COUNT; i++) start += terms[i];
    for (step = 0; step < 600 && ok && t.slipped < stitches; step++) {
        const yc_event *e;
        yc_stats stats;
        int n;
        ok = CHECK_RESULT(scene_unravel_pull(u, 4e-4, 2e-3, &stats), YC_OK) && sound(u->scene, mass);
        newton += stats.newton, substeps += stats.substeps, rejected += stats.rejected;
        e = yc_scene_events(u->scene, &n);
        tell(&t, e, n);
        change(u->scene, gain), ok = ok && sound(u->scene, mass);
        tell(&t, u->scene->event + n, u->scene->event_count - n);
        most = fmax(most, fabs(u->force)), mean += fabs(u->force), work += u->force * 4e-4;
    }
    mean /= step;
    expected = stitches * (u->loop - 1.0 / u->desc.wales); /* the place where it comes out moves away from the tip */
    printf(
        "   %d loops, %.1f mm drawn, %.1f expected; %.3f N, at most %.3f; events took %.2g J and gave %.2g of %.2g J, "
        "work %.2g J; %d sub-steps, %d rejected, Newton %.1f\n",
        t.slipped, 1e3 * u->pulled, 1e3 * expected, mean, most, -gain[1], gain[0], start, work, substeps, rejected,
        (double)newton / substeps);
    CHECK(t.slipped == stitches && t.parted == 4 * stitches);
    CHECK(fabs(u->pulled - expected) < share * expected);
    CHECK(most < 0.5 && mean > 5e-3);
    scene_unravel_free(u);
}

TEST(knit_unravels_stockinette) { unravel(scene_stockinette, 8, 4, 0.2); }
TEST(knit_unravels_garter) { unravel(scene_garter, 4, 3, 0.3); }
TEST(knit_unravels_rib) { unravel(scene_rib, 4, 3, 0.3); }
