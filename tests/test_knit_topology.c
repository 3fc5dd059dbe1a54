/* Knits that come undone while a scene runs: loops slip out in order, yarns part, and nothing else is lost. */
#include "internals.h"
#include "scenes/knits.h"
#include "test_scene.h"
#include <math.h>
#include <stdio.h>

/* What holds after every step and every event: beyond yc_yarns_check, the layers of a node are those of a stack, lone
 * visits do not slide, a stitch contact's new loop lies outside of its stack; mass stays. */
static int knit_sound(yc_scene *scene, double expected) {
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

/* Yarns without weight that soon come to rest. */
static yc_scene *calm_scene(const yc_yarns *y) {
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_scene_desc settings = yc_scene_desc_default();
    memset(settings.gravity, 0, sizeof settings.gravity);
    settings.mass_damping = 20.0, settings.dt_max = 2e-3, cloth.yarns = y;
    return test_scene_of(&settings, &cloth);
}

/* Brings about what is due, on its own: mass, positions and, where nothing is pinned, momentum stay; what energy it
 * brings is added to gain[0], what it takes to gain[1]. Its events lie behind those of the last step. */
static void knit_change(yc_scene *scene, double gain[2]) {
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
        ok = CHECK_RESULT(scene_unravel_pull(u, 4e-4, 2e-3, &stats), YC_OK) && knit_sound(u->scene, mass);
        newton += stats.newton, substeps += stats.substeps, rejected += stats.rejected;
        e = yc_scene_events(u->scene, &n);
        tell(&t, e, n);
        knit_change(u->scene, gain), ok = ok && knit_sound(u->scene, mass);
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

/* A decrease whose loop comes out lets all the loops go that it held together. */
TEST(knit_unravels_decreases) {
    static const char text[] = "pattern: a\nRow 1 (RS): k2, k3tog, k2.\n";
    scene_unravel *u = scene_unravel_new(NULL, text, 7, 1, NULL);
    double mass;
    int step, i, n, slipped = 0, parts[5] = {0}, ok = u != NULL;
    if (!CHECK(ok)) return;
    mass = mass_of(u->scene);
    for (step = 0; step < 100 && ok && slipped < 5; step++) {
        const yc_event *e;
        int slips = 0;
        ok = CHECK_RESULT(scene_unravel_pull(u, 2e-3, 1e-2, NULL), YC_OK) && knit_sound(u->scene, mass);
        e = yc_scene_events(u->scene, &n);
        for (i = 0; i < n; i++) slips += e[i].type == YC_EVENT_SLIP;
        for (i = 0; i < n && slips == 1; i++) parts[slipped] += e[i].type == YC_EVENT_PART;
        slipped += slips;
    }
    printf("   parts:");
    for (i = 0; i < 5; i++) printf(" %d", parts[i]);
    printf("; %.1f mm\n", 1e3 * u->pulled);
    CHECK(slipped == 5 && parts[0] == 4 && parts[1] == 4 && parts[2] == 12);
    scene_unravel_free(u);
}

/* ---- a chain -------------------------------------------------------------------------------------------------- */

/* A bound-off piece, its end not secured. Drawn back out of the last loop of the chain, it frees that one, whose stack
 * of an older one of the chain and a loop of the row it then leaves, and so on to the first. */
TEST(knit_unravels_chain) {
    yc_knit_desc d = yc_knit_desc_default();
    yc_yarns y;
    yc_scene *scene;
    double mass, at[3];
    int step, i, n, node, chain, slipped = 0, released = 0, parted = 0, last = 0, ok = 1;
    d.stitches = 4, d.rows = 2;
    if (!CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) return;
    y.visit_held[y.visit_count - 1] = 1;
    chain = d.stitches * (1 + 4 * d.rows);  /* its first node */
    node = y.visit_node[y.visit_count - 4]; /* between the last loop and the end that is drawn through it */
    scene = calm_scene(&y);
    if (!scene) return;
    mass = mass_of(scene);
    for (i = 0; i < d.stitches; i++) yc_scene_pin(scene, 0, YC_NODE, i, NULL); /* the first row */
    memcpy(at, y.layout[node], sizeof at);
    for (step = 0; step < 100 && ok && slipped < 4; step++) {
        const yc_event *e;
        at[0] -= 2e-3, at[2] -= 1e-3;
        CHECK_RESULT(yc_scene_pin(scene, 0, YC_NODE, node, at), YC_OK);
        ok = CHECK_RESULT(yc_scene_step(scene, 1e-2, NULL), YC_OK) && knit_sound(scene, mass);
        e = yc_scene_events(scene, &n);
        for (i = 0; i < n; i++) {
            parted += e[i].type == YC_EVENT_PART;
            if (e[i].type == YC_EVENT_RELEASE) CHECK(released++ == 0 && slipped == 0 && e[i].other == 0);
            if (e[i].type != YC_EVENT_SLIP || e[i].node < chain) continue; /* an open loop of the row may drop */
            CHECK(released == 1);
            if (slipped++) CHECK(e[i].node == last - 4);
            last = e[i].node;
        }
    }
    printf("   %d loops, %d parts, %d steps\n", slipped, parted, step);
    CHECK(released == 1 && slipped == 4 && parted >= 2 + 3 * 8 + 4);
    yc_scene_destroy(scene), yc_yarns_destroy(&y);
}

/* ---- a break -------------------------------------------------------------------------------------------------- */

/* The head of a loop is torn in the middle of a piece that is then stretched sideways: its ends slide out, the loop
 * below it is drawn open and slips out of the one below that, and so on down. */
TEST(knit_runs_where_it_breaks) {
    yc_knit_desc d = yc_knit_desc_default();
    yc_yarns y;
    yc_scene *scene;
    double mass, at[3], high = 0.0, middle, w = 1.0 / d.wales, h = 1.0 / d.courses, last = 1e3, gain[2] = {0.0, 0.0};
    int step, i, k, n, torn[2], broken = 0, slipped = 0, released = 0, ok = 1;
    d.stitches = 5, d.rows = 5, d.yarn.strength = 0.02, d.yarn.friction = 0.1;
    if (!CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) return;
    scene = calm_scene(&y);
    if (!scene) return;
    mass = mass_of(scene), middle = y.layout[2][0];
    for (i = 0; i < y.node_count; i++) high = fmax(high, y.layout[i][0]);
    for (k = 0; k < 2; k++) { /* both B of the middle loop, which row 4 is drawn through */
        double best = 1e3;
        for (torn[k] = i = 0; i < y.node_count; i++) {
            double far = hypot(y.layout[i][0] - middle - (k ? 0.15 : -0.15) * w, y.layout[i][1] - 4.2 * h);
            if (far < best) best = far, torn[k] = i;
        }
        memcpy(at, y.layout[torn[k]], sizeof at), at[0] += (k ? 2e-5 : -2e-5);
        CHECK_RESULT(yc_scene_pin(scene, 0, YC_NODE, torn[k], at), YC_OK);
    }
    CHECK_RESULT(yc_scene_step(scene, 2e-3, NULL), YC_OK);
    scene->cloth[0].yarns.materials[0].strength = 0.1; /* for once */
    knit_change(scene, gain);
    for (i = 0; i < scene->event_count; i++) {
        const yc_event *e = scene->event + i; /* bends of the layout, which is not relaxed, may straighten meanwhile */
        if (e->type == YC_EVENT_BREAK) CHECK(!broken++ && e->yarn == 0 && e->other == 1);
        else CHECK(e->type == YC_EVENT_MERGE || e->type == YC_EVENT_SPLIT);
    }
    CHECK(broken == 1);
    scene->cloth[0].yarns.materials[0].strength = 0.0, scene->event_count = 0;
    for (k = 0; k < 2; k++) CHECK_RESULT(yc_scene_unpin(scene, 0, YC_NODE, torn[k]), YC_OK);
    for (step = 0; step < 150 && ok && slipped < 2; step++) {
        const yc_event *e;
        for (i = 0; i < y.node_count; i++) {
            int side = y.layout[i][0] < 0.12 * high ? -1 : y.layout[i][0] > 0.88 * high ? 1 : 0;
            if (!side && i >= d.stitches) continue;
            memcpy(at, y.layout[i], sizeof at);
            if (i >= d.stitches) at[0] += side * 5e-5 * step;
            CHECK_RESULT(yc_scene_pin(scene, 0, YC_NODE, i, at), YC_OK);
        }
        ok = CHECK_RESULT(yc_scene_step(scene, 1e-2, NULL), YC_OK) && knit_sound(scene, mass);
        e = yc_scene_events(scene, &n);
        for (i = 0; i < n; i++) {
            CHECK(e[i].type != YC_EVENT_BREAK);
            released += e[i].type == YC_EVENT_RELEASE;
            if (e[i].type != YC_EVENT_SLIP) continue;
            CHECK(released >= 2 && y.layout[e[i].node][1] < last - 0.5 * h);
            CHECK(fabs(y.layout[e[i].node][0] - middle) < w);
            slipped++, last = y.layout[e[i].node][1];
        }
    }
    printf("   %d ends out, %d loops, %d steps\n", released, slipped, step);
    CHECK(released >= 2 && slipped == 2);
    yc_scene_destroy(scene), yc_yarns_destroy(&y);
}

/* ---- promises ------------------------------------------------------------------------------------------------- */

/* Steps of a piece that unravels; returns the events. */
static int knit_lives(scene_unravel *u, int steps) {
    int n, events = 0;
    for (; steps > 0; steps--) {
        if (!CHECK_RESULT(scene_unravel_pull(u, 2e-3, 1e-2, NULL), YC_OK)) break;
        yc_scene_events(u->scene, &n);
        events += n;
    }
    return events;
}

/* A saved state brings its network along, with the stitch contacts that are left; and the same bits for any workers. */
TEST(knit_topology_save_and_load) {
    yc_host host = test_host_threads(3);
    scene_unravel *a = scene_unravel_new(NULL, scene_stockinette, 3, 2, NULL);
    scene_unravel *b = scene_unravel_new(&host, scene_stockinette, 3, 2, NULL);
    test_saved start, middle, end, again;
    uint64_t state = 7;
    char *bad;
    int i, k;
    if (!CHECK(a && b)) return;
    start = test_save(a->scene);
    CHECK(knit_lives(a, 8) > 3);
    middle = test_save(a->scene);
    CHECK(knit_lives(a, 8) > 3);
    end = test_save(a->scene);
    CHECK(knit_lives(b, 16) > 6);
    again = test_save(b->scene);
    CHECK(!test_same(middle, end) && a->yarns.contact_count > a->scene->cloth[0].yarns.contact_count);
    free(again.bytes);
    CHECK_RESULT(yc_scene_load(b->scene, middle.bytes, middle.size), YC_OK);
    b->pulled = 8 * 2e-3, knit_lives(b, 8);
    again = test_save(b->scene);
    CHECK(test_same(end, again));
    free(again.bytes);
    CHECK_RESULT(yc_scene_load(a->scene, start.bytes, start.size), YC_OK); /* back to what was laid */
    a->pulled = 0.0, knit_lives(a, 8);
    again = test_save(a->scene);
    CHECK(test_same(middle, again));
    bad = (char *)malloc(end.size);
    for (i = 0; i < 400; i++) { /* whatever is in it, either it is a sound state or it is refused */
        size_t size = end.size;
        memcpy(bad, end.bytes, end.size);
        for (k = 0; k < 4; k++) {
            size_t low = i % 2 ? 0 : end.size / 2;
            bad[low + (size_t)test_random_int(&state, (int)(end.size - low))] = (char)test_random_int(&state, 256);
        }
        if (i % 5 == 0) size = (size_t)test_random_int(&state, (int)size);
        if (yc_scene_load(b->scene, bad, size) == YC_OK) {
            yc_yarns now;
            CHECK_RESULT(yc_scene_network(b->scene, 0, &now), YC_OK);
            CHECK_RESULT(yc_yarns_check(&now, NULL, NULL), YC_OK);
        }
    }
    free(bad), free(again.bytes), free(start.bytes), free(middle.bytes), free(end.bytes);
    scene_unravel_free(a), scene_unravel_free(b);
}

/* An allocation that fails during a step in which a loop slips leaves everything as it was. */
TEST(knit_topology_failing_allocations) {
    yc_host host = test_host_counting();
    scene_unravel *u = scene_unravel_new(&host, scene_stockinette, 2, 1, NULL);
    test_saved before, after, done;
    int n, i, step, events = 0, slipped = 0, refused = 1;
    double pulled = 0.0;
    if (!CHECK(u != NULL)) return;
    before.bytes = NULL, before.size = 0;
    for (step = 0; step < 60 && !slipped; step++) { /* to just before a step with a slip */
        const yc_event *e;
        free(before.bytes);
        before = test_save(u->scene), pulled = u->pulled;
        knit_lives(u, 1);
        e = yc_scene_events(u->scene, &events);
        for (i = 0; i < events; i++) slipped += e[i].type == YC_EVENT_SLIP;
    }
    CHECK(slipped == 1 && events >= 5);
    done = test_save(u->scene);
    for (n = 0; refused && n < 5000; n += 1 + n / 16) {
        yc_result result;
        CHECK_RESULT(yc_scene_load(u->scene, before.bytes, before.size), YC_OK);
        u->pulled = pulled;
        { /* the pin's goal is part of the state */
            double at[3];
            memcpy(at, u->from, sizeof at), at[0] += u->way * (pulled + 2e-3);
            CHECK_RESULT(yc_scene_pin(u->scene, 0, YC_NODE, u->tip, at), YC_OK);
        }
        after = test_save(u->scene);
        test_heap_grant(n);
        result = yc_scene_step(u->scene, 1e-2, NULL);
        test_heap_grant(-1);
        refused = result == YC_ERROR_MEMORY;
        yc_scene_events(u->scene, &i);
        CHECK(i == (refused ? 0 : events));
        if (refused) {
            test_saved now = test_save(u->scene);
            if (!CHECK(test_same(now, after))) refused = 0;
            free(now.bytes);
        } else CHECK_RESULT(result, YC_OK);
        free(after.bytes);
    }
    after = test_save(u->scene);
    CHECK(test_same(after, done) && n > 100);
    free(after.bytes), free(before.bytes), free(done.bytes);
    scene_unravel_free(u);
    CHECK(test_heap.live == 0);
}

/* Kicked at random, free in space: whatever comes undone, momentum and mass stay, and the network is sound. */
TEST(knit_topology_abuse) {
    yc_knit_desc d = yc_knit_desc_default();
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_scene_desc settings = yc_scene_desc_default();
    yc_yarns y;
    yc_scene *scene;
    uint64_t state = 3;
    double mass, gain[2] = {0.0, 0.0};
    int step, i, n, ok = 1, refused = 0, kinds[YC_EVENT_COUNT] = {0};
    d.stitches = 4, d.rows = 3, d.live = 1, d.yarn.strength = 0.02, d.yarn.friction = 0.05;
    if (!CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) return;
    memset(settings.gravity, 0, sizeof settings.gravity);
    settings.mass_damping = 20.0, settings.best_effort = 1, cloth.yarns = &y;
    scene = test_scene_of(&settings, &cloth);
    if (!scene) return;
    mass = mass_of(scene);
    for (step = 0; step < 60 && ok; step++) {
        int node = test_random_int(&state, scene->nodes);
        double v[3];
        const yc_event *e;
        yc_result result;
        test_random_array(&state, -8.0, 8.0, v, 3);
        CHECK_RESULT(yc_scene_set_velocity(scene, 0, YC_NODE, node, v), YC_OK);
        result = yc_scene_step(scene, 4e-3, NULL), refused += result != YC_OK;
        ok = CHECK(result == YC_OK || result == YC_ERROR_DIVERGED) && knit_sound(scene, mass);
        e = yc_scene_events(scene, &n);
        for (i = 0; i < n; i++) kinds[e[i].type]++;
        scene->event_count = 0;
        knit_change(scene, gain), ok = ok && knit_sound(scene, mass);
        for (i = 0; i < scene->event_count; i++) kinds[scene->event[i].type]++;
        scene->event_count = 0;
    }
    printf("   ");
    for (i = 0; i < YC_EVENT_COUNT; i++) printf(" %s %d", yc_event_name((yc_event_type)i), kinds[i]);
    printf("; %d refused\n", refused);
    CHECK(kinds[YC_EVENT_RELEASE] && kinds[YC_EVENT_PART] && kinds[YC_EVENT_MERGE] && kinds[YC_EVENT_BREAK]);
    CHECK(refused < 20);
    yc_scene_destroy(scene), yc_yarns_destroy(&y);
}
