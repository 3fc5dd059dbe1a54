/* Knits cut to the pieces of a pattern: what is left at outlines, rods along seams, and that such pieces can be
 * worn. */
#include "examples/common/ex_obj.h"
#include "scenes/knits.h"
#include "scenes/pieces.h"
#include "test.h"
#include "test_scene.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

static double apart(const double *a, const double *b) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/* Whether a node lies on an edge of its triangle that no other triangle of the same island has (1), or that two islands
 * share (2). */
static int on_outline(const yc_yarns *y, const yc_mesh *mesh, int node) {
    const int *t = mesh->uv_triangles[y->triangle[node]], *at = mesh->triangles[y->triangle[node]];
    int i, k, j, found = 0;
    for (k = 0; k < 3; k++) {
        int a = t[k], b = t[(k + 1) % 3], p = at[k], q = at[(k + 1) % 3], same = 0, welded = 0;
        if (y->weights[node][(k + 2) % 3] > 1e-12) continue;
        for (i = 0; i < mesh->triangle_count; i++)
            for (j = 0; j < 3; j++) {
                const int *u = mesh->uv_triangles[i], *v = mesh->triangles[i];
                same += u[j] == b && u[(j + 1) % 3] == a, welded += v[j] == q && v[(j + 1) % 3] == p;
            }
        if (!same) found = welded ? 2 : 1;
    }
    return found;
}

/* What holds for all knits over a mesh. Returns the length of yarn. */
static double check_piece(const yc_yarns *y, const yc_knit_desc *d) {
    const yc_mesh *mesh = d->mesh;
    char message[YC_MESSAGE_SIZE];
    int *visits = (int *)calloc((size_t)y->node_count, sizeof(int));
    int *rod = (int *)calloc((size_t)y->node_count, sizeof(int));
    int *named = (int *)calloc((size_t)y->visit_count, sizeof(int));
    int i, k, c, loose = 0, sharp = 0, unnamed = 0, strange = 0, off = 0, far = 0;
    double length = 0.0;
    CHECK_RESULT(yc_yarns_check(y, mesh, message), YC_OK);
    CHECK_TEXT(message, "");
    CHECK(y->material_count == (d->rod.density > 0.0 ? 2 : 1));
    for (i = 0; i < y->yarn_count; i++)
        for (k = y->yarn_first[i]; k < y->yarn_first[i + 1]; k++)
            visits[y->visit_node[k]]++, rod[y->visit_node[k]] += y->yarn_family[i] == YC_ROD;
    for (i = 0; i < y->contact_count; i++)
        for (k = 0; k < 4; k++) named[y->contacts[i].visit[k / 2][k % 2]]++;
    /* A place of k + 1 yarns is that of k contacts, each with its own old loop and all with the new one; or legs cross
     * there. */
    for (i = 0; i < y->contact_count; i++)
        for (k = 0; k < 4; k++) {
            int v = y->contacts[i].visit[k / 2][k % 2];
            strange += named[v] != (k / 2 ? visits[y->visit_node[v]] - 1 : 1) || rod[y->visit_node[v]];
        }
    for (k = 0; k < y->visit_count; k++) unnamed += visits[y->visit_node[k]] > 2 && !named[k];
    for (i = 0; i < y->yarn_count; i++) {
        int first = y->yarn_first[i], last = y->yarn_first[i + 1] - 1, crossings = 0,
            is_rod = y->yarn_family[i] == YC_ROD;
        CHECK(y->yarn_material[i] == is_rod && (is_rod || y->yarn_family[i] == YC_WEFT));
        for (k = first; k <= last; k++) {
            int node = y->visit_node[k], lone = visits[node] == 1, end = k == first || k == last;
            crossings += named[k] > 0;
            strange += y->visit_layer[k] != 0 ? lone || rod[node] : visits[node] == 2 && !rod[node];
            if (!end) strange += !y->visit_held[k] != (!lone && !is_rod) && d->edge == 0;
            else if (!is_rod) {
                int edge = on_outline(y, mesh, node);
                off += !edge, strange += (edge == 2 && d->rod.density > 0.0) != (rod[node] == 1);
                strange += y->visit_held[k] != (edge == 1 && d->edge == YC_EDGE_SELVEDGE ? 2 : 1);
            }
            if (k > first && !is_rod) {
                double chord = apart(y->layout[node], y->layout[y->visit_node[k - 1]]);
                double du = y->visit_u[k] - y->visit_u[k - 1];
                far += fabs(du - chord) > 1e-12;
            }
            if (!end) sharp += y->visit_turn[k] > 0.5 * PI;
        }
        if (!is_rod) loose += !crossings, length += y->visit_u[last];
    }
    CHECK(unnamed == 0);
    CHECK(strange == 0);
    CHECK(off == 0);
    CHECK(loose == 0);
    CHECK(far == 0);
    CHECK(sharp <= y->node_count / 1000);
    for (i = 0, far = 0; i < y->node_count; i++) {
        const int *t = mesh->uv_triangles[y->triangle[i]];
        double place[3] = {0.0, 0.0, 0.0};
        for (k = 0; k < 3; k++) {
            far += y->weights[i][k] < 0.0;
            for (c = 0; c < 2; c++) place[c] += y->weights[i][k] * mesh->uv[t[k]][c];
        }
        far += apart(place, y->layout[i]) > 1e-9;
    }
    CHECK(far == 0);
    free(visits), free(rod), free(named);
    return length;
}

static int count_rods(const yc_yarns *y) {
    int i, count = 0;
    for (i = 0; i < y->yarn_count; i++) count += y->yarn_family[i] == YC_ROD;
    return count;
}

/* Metres of yarn in a stitch of a piece of its own. */
static double stitch_length(const yc_knit_desc *desc) {
    yc_knit_desc d = *desc;
    yc_yarns y;
    double length;
    d.mesh = NULL, d.stitches = 60, d.rows = 60, d.live = 1;
    if (!CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) return 0.0;
    length = y.visit_u[y.visit_count - 1] / (60.0 * 61.0);
    yc_yarns_destroy(&y);
    return length;
}

/* Whether not a byte of it has changed. */
static int untouched(const yc_yarns *y, const yc_yarns *kept) {
    return !memcmp((const char *)y, (const char *)kept, sizeof *y);
}

TEST(knit_piece_disc) {
    scene_piece *disc = scene_piece_disc(0.1, 12);
    yc_knit_desc d = yc_knit_desc_default();
    double area = scene_piece_area(disc), loops = area * d.wales * d.courses, stitch;
    int n;
    d.mesh = &disc->mesh;
    stitch = stitch_length(&d);
    for (n = 0; n < 4; n++) {
        const double grains[4] = {0.0, PI / 6.0, PI / 2.0, -1.0};
        yc_yarns y;
        double length, along = 0.0, across = 0.0;
        int i, k;
        d.grain = grains[n];
        if (!CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) break;
        length = check_piece(&y, &d);
        CHECK_NEAR(y.contact_count / (2.0 * loops), 1.0, 0.04); /* those that the outline cuts are gone */
        CHECK_NEAR(length / (loops * stitch), 1.0, 0.02);
        CHECK(y.contact_count < 2.0 * loops && count_rods(&y) == 0);
        for (i = 0; i < y.yarn_count; i++) /* rows run along the grain */
            for (k = 0; k < 2; k++) {
                const double *p = y.layout[y.visit_node[y.yarn_first[i]]];
                const double *q = y.layout[y.visit_node[y.yarn_first[i + 1] - 1]];
                double way[2];
                way[0] = cos(d.grain), way[1] = sin(d.grain);
                *(k ? &across : &along) += fabs(way[k] * (q[0] - p[0]) + (k ? -way[0] : way[1]) * (q[1] - p[1]));
            }
        CHECK(along > 10.0 * across);
        yc_yarns_destroy(&y);
    }
    scene_piece_free(disc);
}

/* A ring, whose rows fall into two; gauges and outlines that nodes lie on; loops of another length. */
TEST(knit_piece_shapes) {
    scene_piece *disc = scene_piece_disc(0.08, 8), *exact = scene_piece_rectangle(20.0 / 220.0, 20.0 / 300.0, 5), *thin;
    yc_knit_desc d = yc_knit_desc_default();
    yc_yarns y;
    double length;
    int i;
    disc->mesh.triangles += 6 * 4 * 4, disc->mesh.uv_triangles += 6 * 4 * 4, disc->mesh.triangle_count -= 6 * 4 * 4;
    d.mesh = &disc->mesh;
    for (i = 0; i < 3; i++) {
        d.grain = 0.4 * i;
        if (!CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) continue;
        check_piece(&y, &d);
        CHECK_NEAR(y.contact_count / (2.0 * 0.75 * 3.1 * 0.08 * 0.08 * d.wales * d.courses), 1.0, 0.12);
        yc_yarns_destroy(&y);
    }
    d.mesh = &exact->mesh, d.grain = 0.0;
    if (CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) {
        length = check_piece(&y, &d);
        CHECK(y.contact_count == 2 * 20 * 19); /* all columns */
        yc_yarns_destroy(&y);
        d.loop = 1.1 * length / 400.0;
        if (CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) {
            CHECK_NEAR(check_piece(&y, &d), length, 1e-9); /* heavier yarn */
            CHECK_NEAR(length * y.materials[0].density / (400.0 * d.loop * d.yarn.density), 0.97, 0.03);
            yc_yarns_destroy(&y);
        }
        d.loop = 0.0;
    }
    d.edge = YC_EDGE_SELVEDGE;
    if (CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) check_piece(&y, &d), yc_yarns_destroy(&y);
    d.edge = YC_EDGE_CUT;
    thin = scene_piece_rectangle(0.2, 0.008, 9); /* two courses, turned */
    d.mesh = &thin->mesh;
    for (i = 0; i < 4; i++) {
        d.grain = 0.5 * i;
        if (CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) check_piece(&y, &d), yc_yarns_destroy(&y);
    }
    scene_piece_free(disc), scene_piece_free(exact), scene_piece_free(thin);
}

/* Charts are repeated over the piece, whatever they are; stacks go or stay as a whole. */
TEST(knit_piece_charts) {
    static const char twisted[] = "Row 1 (RS): Knit.\nRow 2 (WS): [ptbl] 1 times, *ptbl, p1, repeat from *.";
    const char *const rows[5] = {scene_garter, scene_rib2, scene_feather, scene_diamond, twisted};
    scene_piece *disc = scene_piece_disc(0.07, 6);
    int i, k, stacks;
    for (i = 0; i < 5; i++) {
        yc_knit_desc d = yc_knit_desc_default();
        yc_chart chart;
        yc_yarns y;
        char message[YC_MESSAGE_SIZE];
        d.mesh = &disc->mesh, d.grain = 0.3, d.chart = &chart;
        if (!CHECK_RESULT(yc_chart_read(NULL, rows[i], strlen(rows[i]), NULL, &chart, message), YC_OK)) continue;
        if (CHECK_RESULT(yc_knit(NULL, &d, &y, message), YC_OK)) {
            check_piece(&y, &d);
            CHECK_NEAR(y.contact_count / (2.0 * scene_piece_area(disc) * d.wales * d.courses), 1.0, 0.2);
            for (k = 0, stacks = 0; k < y.visit_count; k++) stacks += y.visit_layer[k] > 1;
            CHECK((stacks > 0) == (i == 2 || i == 3));
            yc_yarns_destroy(&y);
        }
        yc_chart_destroy(&chart);
    }
    scene_piece_free(disc);
}

TEST(knit_piece_shirt) {
    ex_pattern pattern;
    scene_piece shirt;
    char error[EX_ERROR_SIZE];
    yc_knit_desc d = yc_knit_desc_default();
    yc_yarns y;
    double loops;
    if (!CHECK(ex_pattern_read(&pattern, "examples/data/tshirt.obj", error))) return;
    memset(&shirt, 0, sizeof shirt);
    shirt.uv = pattern.uv, shirt.uv_triangles = pattern.uv_triangles;
    shirt.mesh.vertex_count = pattern.vertex_count, shirt.mesh.positions = (const double(*)[3])pattern.positions;
    shirt.mesh.uv_count = pattern.uv_count, shirt.mesh.uv = (const double(*)[2])pattern.uv;
    shirt.mesh.triangle_count = pattern.triangle_count;
    shirt.mesh.triangles = (const int(*)[3])pattern.triangles;
    shirt.mesh.uv_triangles = (const int(*)[3])pattern.uv_triangles;
    d.mesh = &shirt.mesh, d.wales = 110.0, d.courses = 150.0;
    loops = scene_piece_area(&shirt) * d.wales * d.courses;
    if (CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) {
        CHECK_NEAR(check_piece(&y, &d) / (loops * stitch_length(&d)), 1.0, 0.02);
        CHECK_NEAR(y.contact_count / (2.0 * loops), 1.0, 0.04);
        yc_yarns_destroy(&y);
    }
    ex_pattern_free(&pattern);
}

/* Two halves, their rod, and the scene that pulls them apart. */
TEST(knit_piece_seam) {
    scene_piece *halves = scene_piece_halves(0.06, 0.03, 4);
    yc_knit_desc d = yc_knit_desc_default();
    yc_scene_desc settings = yc_scene_desc_default();
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_scene *scene = NULL;
    yc_yarns y, now;
    double(*x)[3], (*to)[3], mass, length, force[2] = {0.0, 0.0}, middle = 0.0;
    int i, k, n, tied = 0, changes = 0;
    memset(&now, 0, sizeof now);
    d.mesh = &halves->mesh;
    d.rod.density = 0.0;
    if (!CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) return;
    check_piece(&y, &d);
    CHECK(count_rods(&y) == 0);
    yc_yarns_destroy(&y);
    d.rod = d.yarn;
    if (!CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) return;
    length = check_piece(&y, &d);
    CHECK(count_rods(&y) == 1);
    for (i = 0; i < y.yarn_count; i++) {
        if (y.yarn_family[i] != YC_ROD) continue;
        tied = y.yarn_first[i + 1] - y.yarn_first[i];
        n = y.yarn_first[i + 1] - 1;
        length += y.visit_u[n];
        CHECK(y.visit_u[n] > 0.75 * 0.03 && y.visit_u[n] <= 0.03 + 1e-12);
        for (k = n - tied + 2; k <= n; k++) CHECK(y.visit_u[k] - y.visit_u[k - 1] > 1e-4);
    }
    CHECK(tied > 14 && tied < 60); /* of 2 x 9 courses, each at least once */
    cloth.mesh = halves->mesh, cloth.yarns = &y, cloth.alpha_uniform = 1.0;
    memset(settings.gravity, 0, sizeof settings.gravity);
    settings.mass_damping = 20.0, settings.dt_max = 2e-3, settings.solver = YC_SOLVER_DIRECT;
    scene = test_scene_of(&settings, &cloth);
    x = (double(*)[3])calloc((size_t)y.node_count + 1000, sizeof *x);
    to = (double(*)[3])calloc((size_t)y.node_count + 1000, sizeof *to);
    if (!CHECK(scene && x && to)) {
        free(x), free(to);
        return;
    }
    CHECK_RESULT(yc_scene_positions(scene, 0, YC_NODE, to), YC_OK);
    CHECK_RESULT(yc_scene_momentum(scene, &mass, NULL, NULL), YC_OK);
    CHECK_NEAR(mass / (length * d.yarn.density), 1.0, 1e-9);
    for (n = 0; n < 3; n++) {
        for (i = 0; i < y.node_count; i++) {
            double at[3];
            if (to[i][0] > 0.003 && to[i][0] < 0.057) continue;
            memcpy(at, to[i], sizeof at);
            at[0] += to[i][0] > 0.03 ? 2e-3 * (n + 1) : 0.0;
            CHECK_RESULT(yc_scene_pin(scene, 0, YC_NODE, i, at), YC_OK);
        }
        if (!CHECK_RESULT(yc_scene_step(scene, 0.02, NULL), YC_OK)) break;
        yc_scene_events(scene, &k);
        changes += k;
        CHECK_RESULT(yc_scene_network(scene, 0, &now), YC_OK);
        CHECK_RESULT(yc_yarns_check(&now, &halves->mesh, NULL), YC_OK);
    }
    CHECK(changes > 0); /* cut ends slip out, and what has changed still lies on the mesh */
    CHECK_RESULT(yc_scene_positions(scene, 0, YC_NODE, x), YC_OK);
    for (i = 0; i < y.node_count; i++) {
        double f[3] = {0.0, 0.0, 0.0};
        if (to[i][0] > 0.003 && to[i][0] < 0.057) continue;
        CHECK_RESULT(yc_scene_pin_force(scene, 0, YC_NODE, i, f), YC_OK);
        force[to[i][0] > 0.03] += f[0];
    }
    CHECK(force[1] > 5e-3 && fabs(force[0] + force[1]) < 0.2 * force[1]); /* through the seam */
    for (i = 0; i < now.yarn_count; i++) {
        if (now.yarn_family[i] != YC_ROD) continue;
        CHECK(now.yarn_first[i + 1] - now.yarn_first[i] == tied);
        for (k = now.yarn_first[i]; k < now.yarn_first[i + 1]; k++) {
            int others = 0, v;
            for (v = 0; v < now.visit_count; v++) others += v != k && now.visit_node[v] == now.visit_node[k];
            CHECK(others == 1); /* every end is still tied */
            middle += x[now.visit_node[k]][0] / tied;
            if (k > now.yarn_first[i])
                CHECK(apart(x[now.visit_node[k]], x[now.visit_node[k - 1]]) <
                    1.05 * (now.visit_u[k] - now.visit_u[k - 1]));
        }
    }
    CHECK_NEAR(middle, 0.033, 5e-3);
    yc_scene_destroy(scene);
    yc_yarns_destroy(&y);
    free(x), free(to);
    scene_piece_free(halves);
}

TEST(knit_piece_refuses) {
    scene_piece *disc = scene_piece_disc(0.02, 2), *tiny = scene_piece_rectangle(0.003, 0.002, 1);
    yc_chart chart;
    yc_knit_desc d;
    yc_mesh bad;
    yc_yarns y, kept;
    yc_scene_desc settings = yc_scene_desc_default();
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_scene *scene = NULL;
    double alpha[19];
    int i;
    char message[YC_MESSAGE_SIZE];
    memset(&y, 7, sizeof y);
    kept = y;
#define REFUSED(change, code, text) \
    do { \
        d = yc_knit_desc_default(); \
        d.mesh = &disc->mesh; \
        change; \
        CHECK_RESULT(yc_knit(NULL, &d, &y, message), code); \
        CHECK_TEXT(message, text); \
        CHECK(untouched(&y, &kept)); \
    } while (0)
    REFUSED(d.grain = HUGE_VAL, YC_ERROR_ARGUMENT, "knit.grain = inf must be finite");
    REFUSED(d.edge = (yc_edge)2, YC_ERROR_ARGUMENT, "knit.edge = 2 is none of yc_edge");
    REFUSED(d.round = 1, YC_ERROR_ARGUMENT, "knit.round = 1: what pieces are cut from is knitted flat");
    REFUSED(d.live = 1, YC_ERROR_ARGUMENT, "knit.live = 1: pieces are cut, and have no row that is last");
    REFUSED(d.rod.radius = 0.0, YC_ERROR_ARGUMENT, "knit.rod.radius = 0 must be greater than 0");
    REFUSED((bad = disc->mesh, bad.uv = NULL, d.mesh = &bad), YC_ERROR_ARGUMENT, "mesh.uv must not be NULL");
    REFUSED(d.mesh = &tiny->mesh, YC_ERROR_ARGUMENT,
        "knit.wales = 220, courses = 300: the piece of mesh.triangles[0] is too small for a loop");
    REFUSED((d.wales = 1e6, d.courses = 1e5), YC_ERROR_ARGUMENT,
        "knit.wales = 1e+06, courses = 100000: the rectangle around the piece of mesh.triangles[0] takes about "
        "1.6e+08 loops, more than 25000000");
    if (CHECK_RESULT(yc_chart_read(NULL, "Row 1 (RS): k2, *k2tog, repeat from *.", 38, NULL, &chart, message), YC_OK)) {
        REFUSED(d.chart = &chart, YC_ERROR_ARGUMENT,
            "knit.chart: no number of stitches from 15 on, which the piece of mesh.triangles[0] takes, fits its rows "
            "and is left after them");
        yc_chart_destroy(&chart);
    }
    memcpy(disc->uv[8], disc->uv[0], sizeof disc->uv[8]); /* a vertex of the rim in the middle */
    disc->uv[8][0] -= 0.002;
    d = yc_knit_desc_default(), d.mesh = &disc->mesh;
    CHECK(yc_knit(NULL, &d, &y, message) != YC_OK && untouched(&y, &kept));
    scene_piece_free(disc), scene_piece_free(tiny);
#undef REFUSED
    disc = scene_piece_disc(0.02, 2);
    d.mesh = &disc->mesh;
    for (i = 0; i < 19; i++) alpha[i] = i == 7 ? 0.5 : 1.0;
    if (CHECK_RESULT(yc_scene_create(NULL, &settings, &scene, NULL), YC_OK) &&
        CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) {
        cloth.mesh = disc->mesh, cloth.yarns = &y;
        CHECK_RESULT(yc_scene_add_cloth(scene, &cloth, NULL), YC_ERROR_ARGUMENT);
        CHECK_TEXT(yc_scene_message(scene), "cloth.alpha_uniform = 0 must be 1: a knit does not mix with triangles");
        cloth.alpha = alpha;
        CHECK_RESULT(yc_scene_add_cloth(scene, &cloth, NULL), YC_ERROR_ARGUMENT);
        CHECK_TEXT(yc_scene_message(scene), "cloth.alpha[7] = 0.5 must be 1: a knit does not mix with triangles");
        alpha[7] = 1.0, cloth.enrich_all = 1;
        CHECK_RESULT(yc_scene_add_cloth(scene, &cloth, NULL), YC_ERROR_ARGUMENT);
        CHECK_TEXT(yc_scene_message(scene), "cloth.enrich_all = 1: a knit does not mix with triangles");
        cloth.enrich_all = 0;
        CHECK_RESULT(yc_scene_add_cloth(scene, &cloth, NULL), YC_OK);
        yc_yarns_destroy(&y);
    }
    yc_scene_destroy(scene);
    scene_piece_free(disc);
}

TEST(knit_piece_out_of_memory) {
    scene_piece *halves = scene_piece_halves(0.06, 0.03, 2);
    yc_chart chart;
    yc_knit_desc d = yc_knit_desc_default();
    yc_yarns y, kept;
    char message[YC_MESSAGE_SIZE];
    int n;
    memset(&y, 7, sizeof y);
    kept = y;
    if (!CHECK_RESULT(yc_chart_read(NULL, scene_diamond, strlen(scene_diamond), NULL, &chart, message), YC_OK)) return;
    d.mesh = &halves->mesh, d.chart = &chart;
    for (n = 0; n < 400; n++) {
        yc_host host = test_host_failing(n);
        yc_result result = yc_knit(&host, &d, &y, message);
        if (result == YC_OK) break;
        CHECK(test_refused_memory(result, message) && untouched(&y, &kept));
    }
    CHECK(n >= 50 && n < 400 && test_heap.live == 1);
    yc_yarns_destroy(&y);
    CHECK(test_heap.live == 0 && test_heap.bytes == 0);
    yc_chart_destroy(&chart);
    scene_piece_free(halves);
}

/* T-shirt cotton, a sweater's and a hand-knitted wool: a piece of each weighs what such a fabric does, and rolls up,
 * which is all that wrapping makes of it. */
TEST(knit_piece_fabrics) {
    static const yc_fabric_name names[3] = {YC_FABRIC_JERSEY, YC_FABRIC_SWEATER, YC_FABRIC_STOCKINETTE};
    int i, k, n;
    for (i = 0; i < 3; i++) {
        yc_knit_desc d;
        yc_fabric fabric;
        yc_scene_desc settings = yc_scene_desc_default();
        yc_cloth_desc cloth = yc_cloth_desc_default();
        yc_scene *scene;
        scene_piece *piece;
        yc_yarns y;
        double(*x)[3], mass, most = 0.0, period;
        CHECK_RESULT(yc_knit_fabric(names[i], &d), YC_OK);
        CHECK_RESULT(yc_fabric_get(names[i], &fabric), YC_OK);
        piece = scene_piece_rectangle(6.0 / d.wales, 6.0 / d.courses, 2);
        d.mesh = &piece->mesh;
        if (!CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) return;
        CHECK(check_piece(&y, &d) > 0.0);
        period = 6.3 * sqrt(d.yarn.density / d.yarn.bending) / (d.wales * d.wales);
        memset(settings.gravity, 0, sizeof settings.gravity);
        settings.solver = YC_SOLVER_DIRECT, settings.mass_damping = 0.2 / period, settings.dt_max = period;
        settings.tolerance = 1e-3 / d.wales;
        cloth.mesh = piece->mesh, cloth.yarns = &y, cloth.alpha_uniform = 1.0, cloth.hold_network = 1;
        scene = test_scene_of(&settings, &cloth);
        x = (double(*)[3])calloc((size_t)y.node_count, sizeof *x);
        if (!CHECK(scene && x)) {
            free(x);
            return;
        }
        CHECK_RESULT(yc_scene_momentum(scene, &mass, NULL, NULL), YC_OK);
        CHECK_NEAR(mass / scene_piece_area(piece), 0.5 * (fabric.mass[0] + fabric.mass[1]), 0.2 * fabric.mass[1]);
        CHECK_RESULT(yc_scene_step(scene, 5.0 * period, NULL), YC_OK);
        CHECK_RESULT(yc_scene_positions(scene, 0, YC_NODE, x), YC_OK);
        for (k = 0; k < y.node_count; k++)
            for (n = 0; n < 2; n++) most = fmax(most, fabs(x[k][n] - y.layout[k][n]));
        CHECK(most < 6.0 / d.wales);
        yc_scene_destroy(scene);
        yc_yarns_destroy(&y);
        free(x), scene_piece_free(piece);
    }
}
