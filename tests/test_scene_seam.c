/* Sewing: drawing together, welding, hanging by the seam, rods. */
#include "scenes/scenes.h"
#include "test.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Two pieces side by side in the upright plane, the right edge of the first to the left edge of the second, `gap` m
 * apart; the second is `ease` times as tall. Held along the upper edge of the first. */
typedef struct sewn {
    yc_scene *scene;
    scene_swatch *piece[2];
    int a[6], b[6]; /* right edge of the first, left edge of the second */
} sewn;

static sewn sewn_new(double gap, double ease, double gravity) {
    sewn s;
    scene_swatch_desc d = scene_swatch_desc_default(SCENE_TRIANGLES);
    yc_scene_desc settings = yc_scene_desc_default();
    int i;
    memset(&s, 0, sizeof s);
    s.piece[0] = scene_swatch_new(&d);
    d.origin[0] = d.size[0] + gap, d.size[1] *= ease;
    s.piece[1] = scene_swatch_new(&d);
    for (i = 0; i < 36; i++) s.piece[1]->positions[i][2] = 1e-3 * sin(200.0 * s.piece[1]->uv[i][1]); /* may buckle */
    settings.gravity[1] = -gravity, settings.mass_damping = 30.0;
    CHECK_RESULT(yc_scene_create(NULL, &settings, &s.scene, NULL), YC_OK);
    for (i = 0; i < 2; i++) CHECK_RESULT(yc_scene_add_cloth(s.scene, &s.piece[i]->cloth, NULL), YC_OK);
    for (i = 0; i < 6; i++) {
        CHECK_RESULT(yc_scene_pin(s.scene, 0, YC_VERTEX, 30 + i, NULL), YC_OK);
        s.a[i] = 6 * i + 5, s.b[i] = 6 * i;
    }
    return s;
}

static yc_result sew(sewn *s, double close_time) {
    yc_seam_desc seam = yc_seam_desc_default();
    seam.cloth[1] = 1, seam.count = 6, seam.a = s->a, seam.b = s->b, seam.close_time = close_time,
    seam.stiffness = 20.0;
    return yc_scene_add_seam(s->scene, &seam, NULL);
}

static void sewn_free(sewn s) {
    yc_scene_destroy(s.scene);
    scene_swatch_free(s.piece[0]), scene_swatch_free(s.piece[1]);
}

static void check_sewn(double ease) {
    sewn s = sewn_new(0.01, ease, 9.81);
    double x[36][3], y[36][3], after[3], mass, mass_before, top[3], sum = 0.0;
    yc_scene_desc settings = yc_scene_desc_get(s.scene);
    yc_stats stats;
    int i, k, welded_at = -1, triangles[50][3];
    CHECK_RESULT(sew(&s, 0.2), YC_OK);
    CHECK_RESULT(yc_scene_momentum(s.scene, &mass_before, NULL, NULL), YC_OK);
    for (i = 0; i < 75; i++) {
        settings.tolerance =
            1e-9; /* forces are read at the end: 1e-5 m of a cloth of 1e4 N/m is more than its weight */
        if (ease > 1.0 && welded_at >= 0 && i > welded_at + 5) break;
        if (ease == 1.0 && i == 70) CHECK_RESULT(yc_scene_tune(s.scene, &settings), YC_OK);
        if (!CHECK_RESULT(yc_scene_step(s.scene, 0.02, &stats), YC_OK)) break;
        if (stats.welded && welded_at < 0) welded_at = i;
    }
    CHECK(welded_at >= 9 && welded_at < 40); /* not before close_time */
    CHECK_RESULT(yc_scene_positions(s.scene, 0, YC_VERTEX, x), YC_OK);
    CHECK_RESULT(yc_scene_positions(s.scene, 1, YC_VERTEX, y), YC_OK);
    for (i = 0; i < 6; i++)
        for (k = 0; k < 3; k++) CHECK_NEAR(x[s.a[i]][k], y[s.b[i]][k], 0.0);
    CHECK_RESULT(yc_scene_momentum(s.scene, &mass, after, NULL), YC_OK);
    CHECK_NEAR(mass / mass_before, 1.0, 1e-13);
    for (i = 0; i < 6; i++) {
        CHECK_RESULT(yc_scene_pin_force(s.scene, 0, YC_VERTEX, 30 + i, top), YC_OK);
        sum += top[1];
    }
    if (ease == 1.0) CHECK_NEAR(sum / (mass * 9.81), 1.0, 0.05); /* all of it hangs on the first piece's pins */
    for (i = 0; i < 36; i++) CHECK(y[i][1] > -0.08 && y[i][1] < 0.065);
    CHECK_RESULT(yc_scene_triangles(s.scene, 1, triangles), YC_OK);
    for (i = 0; i < 50; i++)
        for (k = 0; k < 3; k++) CHECK(triangles[i][k] == s.piece[1]->triangles[i][k]); /* between cloths: left alone */
    sewn_free(s);
}

TEST(scene_seam_welds_and_holds) { check_sewn(1.0); }
TEST(scene_seam_eased) { check_sewn(1.15); }

/* Linear momentum is untouched by drawing together and welding. */
TEST(scene_seam_keeps_momentum) {
    sewn s = sewn_new(0.004, 1.0, 0.0);
    double before[3], after[3], v[3] = {0.0, 0.0, 0.2}, zero[3] = {0.0, 0.0, 0.0};
    yc_stats stats;
    int i;
    yc_scene_desc settings = yc_scene_desc_get(s.scene);
    settings.mass_damping = 0.0, settings.tolerance = 1e-8;
    CHECK_RESULT(yc_scene_tune(s.scene, &settings), YC_OK);
    CHECK_RESULT(sew(&s, 0.01), YC_OK);
    for (i = 0; i < 6; i++) CHECK_RESULT(yc_scene_unpin(s.scene, 0, YC_VERTEX, 30 + i), YC_OK);
    for (i = 0; i < 36; i++) CHECK_RESULT(yc_scene_set_velocity(s.scene, 1, YC_VERTEX, i, i % 2 ? v : zero), YC_OK);
    CHECK_RESULT(yc_scene_momentum(s.scene, NULL, before, NULL), YC_OK);
    for (i = 0; i < 20; i++) CHECK_RESULT(yc_scene_step(s.scene, 5e-3, &stats), YC_OK);
    CHECK(stats.welded == 1);
    CHECK_RESULT(yc_scene_momentum(s.scene, NULL, after, NULL), YC_OK);
    CHECK_NEAR_ALL(after, before, 3, 1e-9 * before[2]);
    sewn_free(s);
}

/* One mesh of two islands whose middle column is shared on the mesh and split in UV, as an OBJ has it: the weave runs a
 * rod along the weld and ties both sides' yarns to it. */
typedef struct welded_piece {
    double positions[55][3], uv[60][2], alpha[55];
    int triangles[80][3], uv_triangles[80][3];
    yc_mesh mesh;
} welded_piece;

static void welded_piece_fill(welded_piece *p) {
    int x, y, i, t = 0;
    memset(p, 0, sizeof *p);
    for (y = 0; y < 5; y++) {
        for (x = 0; x < 11; x++) {
            i = 11 * y + x;
            p->positions[i][0] = 0.01 * x, p->positions[i][1] = 0.01 * y;
            p->alpha[i] = x >= 4 && x <= 6 && y >= 1 && y <= 3 ? 1.0 : 0.0;
        }
        for (x = 0; x < 12; x++) { /* six columns of each island, the right one 5 cm further off in the pattern */
            p->uv[12 * y + x][0] = x < 6 ? 0.01 * x : 0.01 * (x - 1) + 0.05;
            p->uv[12 * y + x][1] = 0.01 * y;
        }
    }
    for (y = 0; y < 4; y++)
        for (x = 0; x < 10; x++, t += 2) {
            int a = 11 * y + x, b = 12 * y + (x < 5 ? x : x + 1), k;
            int own[2][3] = {{0, 1, 12}, {0, 12, 11}}, pattern[2][3] = {{0, 1, 13}, {0, 13, 12}};
            for (k = 0; k < 3; k++) {
                p->triangles[t][k] = a + own[0][k], p->triangles[t + 1][k] = a + own[1][k];
                p->uv_triangles[t][k] = b + pattern[0][k], p->uv_triangles[t + 1][k] = b + pattern[1][k];
            }
        }
    p->mesh.vertex_count = 55, p->mesh.triangle_count = 80, p->mesh.uv_count = 60;
    p->mesh.positions = (const double(*)[3])p->positions, p->mesh.uv = (const double(*)[2])p->uv;
    p->mesh.triangles = (const int(*)[3])p->triangles, p->mesh.uv_triangles = (const int(*)[3])p->uv_triangles;
}

static void check_rod(int all_yarns) {
    welded_piece p;
    yc_weave_desc weave = yc_weave_desc_default();
    yc_yarns yarns;
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_scene_desc settings = yc_scene_desc_default();
    yc_scene *scene = NULL;
    yc_stats stats;
    double(*x)[3], mass, laid = 0.0, longest = 0.0;
    int i, k, rod = -1, tied = 0;
    welded_piece_fill(&p);
    memset(&yarns, 0, sizeof yarns);
    if (!CHECK_RESULT(yc_weave(NULL, &weave, &p.mesh, &yarns, NULL), YC_OK)) return;
    for (i = 0; i < yarns.yarn_count; i++)
        if (yarns.yarn_family[i] == YC_ROD) {
            CHECK(rod < 0);
            rod = i;
        }
    if (CHECK(rod >= 0)) {
        for (k = yarns.yarn_first[rod]; k < yarns.yarn_first[rod + 1];
             k++) { /* each visit of the rod ties a weft's end */
            int node = yarns.visit_node[k], j, others = 0;
            for (i = 0; i < yarns.yarn_count; i++)
                for (j = yarns.yarn_first[i]; i != rod && j < yarns.yarn_first[i + 1]; j++)
                    if (yarns.visit_node[j] == node) {
                        others++;
                        CHECK(yarns.yarn_family[i] == YC_WEFT);
                        CHECK(j == yarns.yarn_first[i] || j == yarns.yarn_first[i + 1] - 1);
                        CHECK(yarns.visit_held[j] != 0);
                    }
            CHECK(others <= 1);
            tied += others;
        }
        CHECK(tied == 2 * 16); /* 16 wefts of each island */
    }
    cloth.mesh = p.mesh, cloth.yarns = &yarns, cloth.alpha = all_yarns ? NULL : p.alpha;
    cloth.alpha_uniform = all_yarns;
    cloth.material = yc_weave_material(&weave);
    settings.mass_damping = 10.0;
    CHECK_RESULT(yc_scene_create(NULL, &settings, &scene, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_cloth(scene, &cloth, NULL), YC_OK);
    for (i = 0; i < yarns.yarn_count; i++)
        laid += yarns.materials[yarns.yarn_material[i]].density *
            (yarns.visit_u[yarns.yarn_first[i + 1] - 1] - yarns.visit_u[yarns.yarn_first[i]]);
    CHECK_RESULT(yc_scene_momentum(scene, &mass, NULL, NULL), YC_OK);
    CHECK_NEAR(mass / laid, 1.0, 1e-13);
    for (i = 0; i < 5; i++) CHECK_RESULT(yc_scene_pin(scene, 0, YC_VERTEX, 11 * i, NULL), YC_OK); /* by its left edge */
    for (i = 0; i < 15; i++)
        if (!CHECK_RESULT(yc_scene_step(scene, 0.01, &stats), YC_OK)) break;
    x = (double(*)[3])malloc((size_t)yarns.node_count * sizeof *x);
    CHECK_RESULT(yc_scene_positions(scene, 0, YC_NODE, x), YC_OK);
    for (i = 0; i < yarns.yarn_count; i++) /* no tie has opened: no segment is longer than it should be */
        for (k = yarns.yarn_first[i]; k + 1 < yarns.yarn_first[i + 1]; k++) {
            const double *a = x[yarns.visit_node[k]], *b = x[yarns.visit_node[k + 1]];
            double d =
                sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
            longest = fmax(longest, d / (yarns.visit_u[k + 1] - yarns.visit_u[k]));
        }
    CHECK(longest < 1.1);
    CHECK(all_yarns ? !stats.hybrid_nodes : stats.hybrid_nodes && stats.full_nodes && stats.dummy_nodes);
    free(x);
    yc_scene_destroy(scene);
    yc_yarns_destroy(&yarns);
}

TEST(scene_seam_rod_ties_yarns) { check_rod(1); }
TEST(scene_seam_rod_ties_mixed) { check_rod(0); }
