/* What the scene promises whatever it is asked: refusals, failures that change nothing, reproducible bits. */
#include "scenes/scenes.h"
#include "test_scene.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- small parts ---------------------------------------------------------------------------------------------- */

/* A call was refused with this code, and its message holds every word of `words`, which are parted by '|'. */
static void refused(yc_result result, yc_result code, const char *message, const char *words, int line) {
    char text[512], *word;
    snprintf(text, sizeof text, "line %d: %s: %s (wants %s: %s)", line, yc_result_name(result), message,
        yc_result_name(code), words);
    if (!test_check(result == code, __FILE__, line, text)) return;
    snprintf(text, sizeof text, "%s", words);
    for (word = strtok(text, "|"); word; word = strtok(NULL, "|")) {
        char why[512];
        snprintf(why, sizeof why, "\"%s\" in \"%s\"", word, message);
        test_check(strstr(message, word) != NULL, __FILE__, line, why);
    }
}

/* 4 x 4 cells, alpha 1 in the middle: small, yet with full, hybrid and triangle parts. */
static scene_swatch_desc tiny(scene_kind kind) {
    scene_swatch_desc d = scene_swatch_desc_default(kind);
    d.size[0] = d.size[1] = 0.02, d.spacing = 2e-3;
    return d;
}

/* ---- refusals ------------------------------------------------------------------------------------------------- */

TEST(scene_contract_refuses_bad_settings) {
    static const struct {
        size_t offset;
        double value;
        const char *words;
    } rows[] = {
#define ROW(field, value, words) {offsetof(yc_scene_desc, field), value, words}
        ROW(gravity[0], NAN, "gravity[0]|nan"), ROW(gravity[1], INFINITY, "gravity[1]|inf"),
        ROW(gravity[2], NAN, "gravity[2]"), ROW(dt_max, 0.0, "dt_max|0"), ROW(dt_max, -1.0, "dt_max|-1"),
        ROW(dt_max, NAN, "dt_max|nan"), ROW(dt_min, 0.0, "dt_min"), ROW(dt_min, 1.0, "dt_min|1"),
        ROW(tolerance, 0.0, "tolerance|0"), ROW(tolerance, NAN, "tolerance"),
        ROW(linear_tolerance, 0.0, "linear_tolerance"), ROW(linear_tolerance, 2.0, "linear_tolerance|2"),
        ROW(stiffness_damping, -0.5, "stiffness_damping|-0.5"), ROW(mass_damping, -0.25, "mass_damping|-0.25"),
        ROW(mass_damping, NAN, "mass_damping|nan"), ROW(contact_stiffness, 0.0, "contact_stiffness"),
        ROW(thickness, 0.0, "thickness"), ROW(thickness, INFINITY, "thickness|inf"), ROW(slip_speed, 0.0, "slip_speed"),
        ROW(self_friction, -1.0, "self_friction|-1"), ROW(self_friction, 11.0, "self_friction|11")
#undef ROW
    };
    yc_scene_desc good = yc_scene_desc_default();
    yc_scene *scene = NULL, *other;
    char why[YC_MESSAGE_SIZE];
    int i;
    CHECK_RESULT(yc_scene_create(NULL, &good, &scene, NULL), YC_OK);
    for (i = 0; i < (int)(sizeof rows / sizeof rows[0]); i++) {
        yc_scene_desc bad = good, now;
        memcpy((char *)&bad + rows[i].offset, &rows[i].value, sizeof(double));
        other = scene;
        refused(yc_scene_create(NULL, &bad, &other, why), YC_ERROR_ARGUMENT, why, rows[i].words, __LINE__);
        CHECK(other == NULL);
        refused(yc_scene_tune(scene, &bad), YC_ERROR_ARGUMENT, yc_scene_message(scene), rows[i].words, __LINE__);
        now = yc_scene_desc_get(scene);
        CHECK(now.dt_max == good.dt_max && now.tolerance == good.tolerance && now.thickness == good.thickness);
        CHECK(now.solver == good.solver && now.newton_limit == good.newton_limit && now.gravity[1] == good.gravity[1]);
    }
    for (i = 0; i < 6; i++) {
        static const char *const words[] = {
            "cookie", "newton_limit|0", "linear_limit|-3", "solver|99", "solver|-1", "NULL"};
        yc_scene_desc bad = good;
        if (i == 0) bad.cookie ^= 1u;
        if (i == 1) bad.newton_limit = 0;
        if (i == 2) bad.linear_limit = -3;
        if (i == 3) bad.solver = (yc_solver)99;
        if (i == 4) bad.solver = (yc_solver)-1;
        refused(yc_scene_create(NULL, i == 5 ? NULL : &bad, &other, why), YC_ERROR_ARGUMENT, why, words[i], __LINE__);
        refused(
            yc_scene_tune(scene, i == 5 ? NULL : &bad), YC_ERROR_ARGUMENT, yc_scene_message(scene), words[i], __LINE__);
    }
    {
        yc_host half;
        memset(&half, 0, sizeof half);
        half.free = test_host_counting().free;
        refused(yc_scene_create(&half, &good, &other, why), YC_ERROR_ARGUMENT, why, "alloc|free", __LINE__);
        CHECK_RESULT(yc_scene_create(NULL, &good, NULL, why), YC_ERROR_ARGUMENT);
    }
    yc_scene_destroy(scene);
}

/* A scene with one mixed cloth, its corner pinned, a seam's worth of a second cloth, a sphere. */
typedef struct stage {
    yc_scene *scene;
    scene_swatch *first, *second;
} stage;

static stage stage_new(const yc_host *host, const yc_scene_desc *settings) {
    stage s;
    scene_swatch_desc d = tiny(SCENE_MIXED), e = tiny(SCENE_TRIANGLES);
    yc_primitive ball;
    yc_body_desc body = yc_body_desc_default();
    e.origin[0] = 0.022;
    memset(&s, 0, sizeof s);
    s.first = scene_swatch_new(&d), s.second = scene_swatch_new(&e);
    memset(&ball, 0, sizeof ball);
    ball.type = YC_SPHERE, ball.a[1] = -0.02, ball.ra = 0.015;
    body.primitive_count = 1, body.primitives = &ball;
    CHECK_RESULT(yc_scene_create(host, settings, &s.scene, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_cloth(s.scene, &s.first->cloth, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_cloth(s.scene, &s.second->cloth, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_body(s.scene, &body, NULL), YC_OK);
    CHECK_RESULT(yc_scene_pin(s.scene, 0, YC_VERTEX, 30, NULL), YC_OK);
    CHECK_RESULT(yc_scene_pin(s.scene, 1, YC_VERTEX, 35, NULL), YC_OK);
    return s;
}

static void stage_free(stage s) {
    yc_scene_destroy(s.scene);
    scene_swatch_free(s.first), scene_swatch_free(s.second);
}

static void refuse_cloths(yc_scene *scene) {
    scene_swatch_desc desc = tiny(SCENE_MIXED);
    scene_swatch *s;
    int row;
    for (row = 0; row < 46; row++) {
        yc_result code = YC_ERROR_ARGUMENT;
        const char *words = "";
        yc_cloth_desc *d;
        double grain[50], prestretch[50];
        int uvt[50][3], i, handle = 77;
        s = scene_swatch_new(&desc), d = &s->cloth;
        for (i = 0; i < 50; i++) grain[i] = 0.0, prestretch[i] = 1.0, memcpy(uvt[i], s->triangles[i], sizeof uvt[i]);
        switch (row) {
        case 0: d->cookie = 0, words = "cookie"; break;
        case 1: s->positions[7][1] = NAN, words = "positions[7][1]|nan"; break;
        case 2: s->positions[0][2] = INFINITY, words = "positions[0][2]|inf"; break;
        case 3: s->uv[5][0] = NAN, words = "uv[5][0]|nan"; break;
        case 4: s->triangles[3][1] = 36, words = "triangles[3][1]|36"; break;
        case 5: s->triangles[3][1] = -1, words = "triangles[3][1]|-1"; break;
        case 6: uvt[9][2] = 1000, d->mesh.uv_triangles = (const int(*)[3])uvt, words = "uv_triangles[9][2]|1000"; break;
        case 7: s->triangles[4][0] = s->triangles[4][1], code = YC_ERROR_TOPOLOGY, words = "triangles[4]"; break;
        case 8: s->uv[0][0] = s->uv[1][0] = s->uv[7][0], words = "triangles[0]|area"; break;
        case 9: /* one triangle turned over, in UV and on the mesh */
            i = s->triangles[8][1], s->triangles[8][1] = s->triangles[8][2], s->triangles[8][2] = i;
            words = "triangles[8]|area";
            break;
        case 10: /* turned over on the mesh alone */
            i = s->triangles[8][1], s->triangles[8][1] = s->triangles[8][2], s->triangles[8][2] = i;
            d->mesh.uv_triangles = (const int(*)[3])uvt, code = YC_ERROR_TOPOLOGY, words = "triangles[8]|wound";
            break;
        case 11: d->mesh.vertex_count = -1, words = "vertex_count|-1"; break;
        case 12: d->mesh.triangle_count = 0, words = "triangle_count|0"; break;
        case 13: d->mesh.uv_count = 2, words = "uv_count|2"; break;
        case 14: d->mesh.positions = NULL, words = "positions|NULL"; break;
        case 15: d->mesh.triangles = NULL, words = "triangles|NULL"; break;
        case 16: d->mesh.uv = NULL, words = "uv|NULL"; break;
        case 17: s->alpha[11] = 1.5, words = "alpha[11]|1.5"; break;
        case 18: s->alpha[11] = -0.125, words = "alpha[11]|-0.125"; break;
        case 19: s->alpha[35] = NAN, words = "alpha[35]|nan"; break;
        case 20: d->alpha_uniform = 2.0, words = "alpha_uniform|2"; break;
        case 21: d->material.density = 0.0, words = "material.density|0"; break;
        case 22: d->material.stretch[0] = -4.0, words = "material.stretch[0]|-4"; break;
        case 23: d->material.stretch[1] = NAN, words = "material.stretch[1]|nan"; break;
        case 24: d->material.coupling = 1e9, words = "material.coupling|1e+09"; break;
        case 25: d->material.shear = 0.0, words = "material.shear|0"; break;
        case 26: d->material.bending = -1e-6, words = "material.bending|-1e-06"; break;
        case 27: grain[13] = NAN, d->grain = grain, words = "grain[13]|nan"; break;
        case 28: prestretch[2] = 0.0, d->prestretch = prestretch, words = "prestretch[2]|0"; break;
        case 29: prestretch[2] = -1.0, d->prestretch = prestretch, words = "prestretch[2]|-1"; break;
        case 30: s->yarns.materials[0].stretch = 0.0, words = "stretch|0"; break;
        case 31: s->yarns.materials[0].bending = -1.0, words = "bending|-1"; break;
        case 32: s->yarns.materials[0].density = NAN, words = "density|nan"; break;
        case 33: s->yarns.materials[0].friction = 11.0, words = "friction|11"; break;
        case 34: s->yarns.visit_node[6] = s->yarns.node_count, words = "visit_node[6]"; break;
        case 35: s->yarns.visit_u[1] = s->yarns.visit_u[0], code = YC_ERROR_TOPOLOGY, words = "visit_u[1]"; break;
        case 36: s->yarns.visit_u[3] = NAN, words = "visit_u[3]|nan"; break;
        case 37: s->yarns.weights[4][1] += 0.5, words = "weights[4]"; break;
        case 38: s->yarns.triangle[9] = 50, words = "triangle[9]|50"; break;
        case 39: s->yarns.yarn_family[2] = 9, words = "yarn_family[2]|9"; break;
        case 40: s->yarns.yarn_material[1] = 40, words = "yarn_material[1]|40"; break;
        case 41: s->nodes[8][2] = NAN, words = "yarn_positions[8][2]|nan"; break;
        case 42: {
            int a = s->yarns.visit_node[3], b = s->yarns.visit_node[4];
            memcpy(s->nodes[b], s->nodes[a], sizeof s->nodes[b]), words = "yarn_positions|yarn 0|0 m";
            break;
        }
        case 43: d->material.coupling = -1e9, words = "coupling|-1e+09|at most"; break;
        case 44: d->yarns = NULL, memset(&d->mesh, 0, sizeof d->mesh), words = "neither"; break;
        default: d = NULL, words = "NULL"; break;
        }
        refused(yc_scene_add_cloth(scene, d, &handle), code, yc_scene_message(scene), words, 1000 + row);
        CHECK(handle == 77);
        scene_swatch_free(s);
    }
}

static void refuse_seams(yc_scene *scene) {
    static const int right[6] = {5, 11, 17, 23, 29, 35}, left[6] = {0, 6, 12, 18, 24, 30};
    int row;
    for (row = 0; row < 19; row++) {
        yc_seam_desc d = yc_seam_desc_default(), *given = &d;
        int a[6], b[6], k;
        yc_result code = YC_ERROR_ARGUMENT;
        const char *words = "";
        memcpy(a, right, sizeof a), memcpy(b, left, sizeof b);
        d.cloth[0] = 0, d.cloth[1] = 1, d.count = 6, d.a = a, d.b = b;
        switch (row) {
        case 0: d.cookie = 1, words = "cookie"; break;
        case 1: d.count = 0, words = "count|0"; break;
        case 2: d.cloth[0] = 2, words = "cloth|2"; break;
        case 3: d.cloth[1] = -1, words = "cloth|-1"; break;
        case 4: d.a = NULL, words = "a|NULL"; break;
        case 5: d.b = NULL, words = "b|NULL"; break;
        case 6: a[2] = 36, words = "a[2]|36"; break;
        case 7: b[3] = -1, words = "b[3]|-1"; break;
        case 8: d.stiffness = 0.0, words = "stiffness|0"; break;
        case 9: d.stiffness = NAN, words = "stiffness|nan"; break;
        case 10: d.close_time = -1.0, words = "close_time|-1"; break;
        case 11: d.weld_distance = -2.0, words = "weld_distance|-2"; break;
        case 12: d.weld_distance = NAN, words = "weld_distance|nan"; break;
        case 13: d.rest_angle = 4.0, words = "rest_angle|4"; break;
        case 14: d.rest_angle = NAN, words = "rest_angle|nan"; break;
        case 15: /* sewn edge to edge upside down: the right edge to another right edge, both running upwards */
            memcpy(b, right, sizeof b), code = YC_ERROR_TOPOLOGY, words = "wound";
            break;
        case 16:
            for (k = 0; k < 6; k++) b[k] = left[5 - k]; /* the left edge the wrong way round */
            code = YC_ERROR_TOPOLOGY, words = "wound";
            break;
        case 17: d.cloth[1] = 0, b[0] = a[0], words = "b[0]|itself"; break; /* a vertex sewn to itself */
        default: given = NULL, words = "NULL"; break;
        }
        refused(yc_scene_add_seam(scene, given, NULL), code, yc_scene_message(scene), words, 2000 + row);
    }
}

static void refuse_bodies(yc_scene *scene) {
    static const double sections[3][4] = {{0.0, 0.1, 0.1, 0.0}, {0.1, 0.1, 0.1, 0.0}, {0.05, 0.1, 0.1, 0.0}};
    int row;
    for (row = 0; row < 13; row++) {
        yc_body_desc d = yc_body_desc_default(), *given = &d;
        yc_primitive p;
        const char *words = "";
        memset(&p, 0, sizeof p);
        p.type = YC_SPHERE, p.ra = 1.0, d.primitive_count = 1, d.primitives = &p;
        switch (row) {
        case 0: d.cookie = 5, words = "cookie"; break;
        case 1: d.primitive_count = 0, words = "primitive_count|0"; break;
        case 2: d.primitives = NULL, words = "primitives"; break;
        case 3: p.ra = 0.0, words = "primitives[0]|ra"; break;
        case 4: p.a[1] = NAN, words = "primitives[0]|a[1]"; break;
        case 5: p.type = (yc_primitive_type)77, words = "primitives[0]|type"; break;
        case 6: p.type = YC_PLANE, words = "primitives[0]|b"; break;
        case 7: p.type = YC_BOX, p.b[0] = p.b[1] = 1.0, words = "primitives[0]|b[2]"; break;
        case 8: p.type = YC_ROUNDED_CONE, p.rb = -1.0, words = "primitives[0]|rb"; break;
        case 9:
            p.type = YC_LOFT, p.section_count = 3, p.sections = sections, p.exponent = 2.0;
            words = "primitives[0]|sections[2]";
            break;
        case 10: d.friction = -1.0, words = "friction|-1"; break;
        case 11: d.smooth_radius = NAN, words = "smooth_radius|nan"; break;
        default: given = NULL, words = "NULL"; break;
        }
        refused(yc_scene_add_body(scene, given, NULL), YC_ERROR_ARGUMENT, yc_scene_message(scene), words, 3000 + row);
    }
}

static void refuse_points(yc_scene *scene) {
    double at[3] = {0.0, NAN, 0.0}, x[200][3], still[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1},
           skew[9] = {1, 1, 0, 0, 1, 0, 0, 0, 1};
    size_t size = 1;
    int row;
    for (row = 0; row < 21; row++) {
        yc_result r = YC_OK;
        const char *words = "";
        switch (row) {
        case 0: r = yc_scene_pin(scene, 2, YC_VERTEX, 0, NULL), words = "cloth|2"; break;
        case 1: r = yc_scene_pin(scene, 0, YC_VERTEX, 36, NULL), words = "vertex|36"; break;
        case 2: r = yc_scene_pin(scene, 0, YC_VERTEX, -1, NULL), words = "vertex|-1"; break;
        case 3: r = yc_scene_pin(scene, 0, YC_NODE, 100000, NULL), words = "node|100000"; break;
        case 4: r = yc_scene_pin(scene, 1, YC_NODE, 0, NULL), words = "node|0"; break;
        case 5: r = yc_scene_pin(scene, 0, (yc_point)5, 0, NULL), words = "kind|5"; break;
        case 6: r = yc_scene_pin(scene, 0, YC_VERTEX, 30, at), words = "position[1]|nan"; break;
        case 7: r = yc_scene_unpin(scene, 0, YC_VERTEX, 3), words = "3|not pinned"; break;
        case 8: r = yc_scene_pin_force(scene, 0, YC_VERTEX, 3, x[0]), words = "3|pinned"; break;
        case 9: r = yc_scene_set_velocity(scene, 0, YC_VERTEX, 3, at), words = "velocity[1]|nan"; break;
        case 10: r = yc_scene_set_velocity(scene, 0, YC_VERTEX, 99, still), words = "vertex|99"; break;
        case 11: r = yc_scene_move_body(scene, 1, still, still), words = "body|1"; break;
        case 12: r = yc_scene_move_body(scene, 0, skew, still), words = "rotation|rows 0|2"; break;
        case 13: r = yc_scene_move_body(scene, 0, still, at), words = "translation[1]|nan"; break;
        case 14: r = yc_scene_step(scene, 0.0, NULL), words = "dt|0"; break;
        case 15: r = yc_scene_step(scene, -0.5, NULL), words = "dt|-0.5"; break;
        case 16: r = yc_scene_step(scene, NAN, NULL), words = "dt|nan"; break;
        case 17: r = yc_scene_step(scene, INFINITY, NULL), words = "dt|inf"; break;
        case 18: r = yc_scene_positions(scene, 4, YC_VERTEX, x), words = "cloth|4"; break;
        case 19: r = yc_scene_positions(scene, 0, (yc_point)9, x), words = "kind|9"; break;
        default: r = yc_scene_save(scene, x, &size), words = "size|1"; break;
        }
        refused(r, YC_ERROR_ARGUMENT, yc_scene_message(scene), words, 4000 + row);
    }
}

/* After every refusal the scene goes on like one that was never asked. */
TEST(scene_contract_refusals_change_nothing) {
    yc_scene_desc settings = yc_scene_desc_default();
    stage asked = stage_new(NULL, &settings), calm = stage_new(NULL, &settings);
    test_saved a, b;
    int part, i;
    for (part = 0; part < 4; part++) {
        if (part == 0) refuse_cloths(asked.scene);
        if (part == 1) refuse_seams(asked.scene);
        if (part == 2) refuse_bodies(asked.scene);
        if (part == 3) refuse_points(asked.scene);
        for (i = 0; i < 2; i++) {
            CHECK_RESULT(yc_scene_step(asked.scene, 2e-3, NULL), YC_OK);
            CHECK_RESULT(yc_scene_step(calm.scene, 2e-3, NULL), YC_OK);
        }
        a = test_save(asked.scene), b = test_save(calm.scene);
        CHECK(test_same(a, b));
        free(a.bytes), free(b.bytes);
    }
    stage_free(asked), stage_free(calm);
}

TEST(scene_contract_nothing_in_it) {
    yc_scene_desc settings = yc_scene_desc_default();
    yc_scene *scene = NULL;
    double terms[YC_TERM_COUNT], mass = 1.0, momentum[3], x[500][3];
    scene_swatch_desc d = tiny(SCENE_YARNS_ALONE);
    scene_swatch *s = scene_swatch_new(&d);
    CHECK_RESULT(yc_scene_create(NULL, &settings, &scene, NULL), YC_OK);
    CHECK_RESULT(yc_scene_step(scene, 0.02, NULL), YC_OK);
    CHECK_NEAR(yc_scene_time(scene), 0.02, 0.0);
    CHECK_RESULT(yc_scene_energy(scene, terms), YC_OK);
    CHECK_RESULT(yc_scene_momentum(scene, &mass, momentum, NULL), YC_OK);
    CHECK_NEAR(mass, 0.0, 0.0);
    CHECK_RESULT(yc_scene_add_cloth(scene, &s->cloth, NULL), YC_OK);
    CHECK_RESULT(yc_scene_positions(scene, 0, YC_VERTEX, x), YC_OK); /* a cloth without a mesh has none */
    CHECK_RESULT(yc_scene_stress(scene, 0, &x[0][0]), YC_OK);
    CHECK_RESULT(yc_scene_step(scene, 1e-3, NULL), YC_OK);
    yc_scene_destroy(scene);
    yc_scene_destroy(NULL);
    scene_swatch_free(s);
}

/* ---- memory --------------------------------------------------------------------------------------------------- */

/* From now on memory is granted; the blocks alive stay counted. */
static void grant_all(void) {
    test_heap_count now = test_heap;
    test_host_counting();
    test_heap = now;
}

typedef struct play {
    yc_host host;
    yc_scene *scene;
    yc_yarns yarns;
    scene_swatch *first, *second;
} play;

/* Call number `call` of a scene's life. */
static yc_result perform(play *p, int call) {
    static const int right[6] = {5, 11, 17, 23, 29, 35}, left[6] = {0, 6, 12, 18, 24, 30};
    yc_scene_desc settings = yc_scene_desc_default();
    yc_cloth_desc cloth = p->first->cloth;
    yc_seam_desc seam = yc_seam_desc_default();
    yc_body_desc body = yc_body_desc_default();
    yc_primitive ball;
    double terms[YC_TERM_COUNT], x[36][3], stress[36];
    settings.self_contact = 1, settings.thickness = 2e-4, settings.tolerance = 1e-3;
    settings.newton_limit = 5, settings.best_effort = 1; /* the contract is the subject, not the accuracy */
    memset(&ball, 0, sizeof ball);
    ball.type = YC_SPHERE, ball.a[0] = ball.a[1] = 0.01, ball.a[2] = -0.01, ball.ra = 0.01;
    body.primitive_count = 1, body.primitives = &ball;
    seam.cloth[1] = 1, seam.count = 6, seam.a = right, seam.b = left, seam.close_time = 0.0, seam.weld_distance = 0.1;
    cloth.yarns = &p->yarns, cloth.yarn_positions = NULL;
    switch (call) {
    case 0: return yc_weave(&p->host, &p->first->weave, &p->first->cloth.mesh, &p->yarns, NULL);
    case 1: return yc_scene_create(&p->host, &settings, &p->scene, NULL);
    case 2: return yc_scene_add_cloth(p->scene, &cloth, NULL);
    case 3: return yc_scene_add_cloth(p->scene, &p->second->cloth, NULL);
    case 4: return yc_scene_add_seam(p->scene, &seam, NULL);
    case 5: return yc_scene_add_body(p->scene, &body, NULL);
    case 6: return yc_scene_pin(p->scene, 0, YC_VERTEX, 30, NULL);
    case 7: return yc_scene_energy(p->scene, terms);
    case 8: return yc_scene_step(p->scene, 1e-3, NULL); /* the first sub-step welds */
    case 9: return yc_scene_positions(p->scene, 0, YC_VERTEX, x);
    case 10: return yc_scene_stress(p->scene, 0, stress);
    default: return yc_scene_step(p->scene, 1e-3, NULL);
    }
}
enum { CALLS = 12 };

TEST(scene_contract_every_failing_allocation) {
    scene_swatch_desc d = tiny(SCENE_MIXED), e = tiny(SCENE_TRIANGLES);
    play p;
    test_saved last;
    int n, done = 0;
    e.origin[0] = 0.021;
    last.bytes = NULL, last.size = 0;
    memset(&p, 0, sizeof p);
    p.first = scene_swatch_new(&d), p.second = scene_swatch_new(&e);
    for (n = 0; !done && n < 5000; n++) {
        int call, refusals = 0;
        p.host = test_host_failing(n);
        for (call = 0; call < CALLS; call++) {
            test_saved before, after;
            yc_result result;
            before.bytes = after.bytes = NULL, before.size = after.size = 0;
            if (p.scene) before = test_save(p.scene);
            result = perform(&p, call);
            if (result == YC_ERROR_MEMORY) {
                refusals++;
                CHECK(call > 1 || !p.scene);
                CHECK(call > 0 || !p.yarns.owner);
                if (call > 1) CHECK(strstr(yc_scene_message(p.scene), "memory") != NULL);
                if (p.scene) after = test_save(p.scene);
                if (!CHECK(test_same(before, after))) printf("allocation %d, call %d changed the state\n", n, call);
                grant_all();
                result = perform(&p, call); /* and now it succeeds */
            }
            free(before.bytes), free(after.bytes);
            if (!CHECK_RESULT(result, YC_OK)) {
                printf("allocation %d, call %d: %s\n", n, call, p.scene ? yc_scene_message(p.scene) : "");
                break;
            }
        }
        if (!CHECK(refusals <= 1)) done = 1;
        if (!refusals) done = 1;
        if (p.scene) {
            test_saved end = test_save(p.scene);
            if (last.bytes) CHECK(test_same(last, end)); /* whatever failed on the way, the end is the same */
            free(last.bytes);
            last = end;
        }
        yc_scene_destroy(p.scene), yc_yarns_destroy(&p.yarns);
        p.scene = NULL;
        CHECK(test_heap.live == 0);
    }
    CHECK(done && n > 100);
    free(last.bytes);
    scene_swatch_free(p.first), scene_swatch_free(p.second);
}

/* ---- steps that fail ------------------------------------------------------------------------------------------ */

TEST(scene_contract_step_that_cannot_be_done) {
    yc_scene_desc good = yc_scene_desc_default(), bad;
    stage s = stage_new(NULL, &good), calm = stage_new(NULL, &good);
    test_saved before, after;
    double time;
    int i;
    yc_stats stats;
    for (i = 0; i < 2; i++) {
        CHECK_RESULT(yc_scene_step(s.scene, 5e-3, NULL), YC_OK);
        CHECK_RESULT(yc_scene_step(calm.scene, 5e-3, NULL), YC_OK);
    }
    before = test_save(s.scene), time = yc_scene_time(s.scene);
    bad = good;
    bad.newton_limit = 1, bad.dt_min = bad.dt_max, bad.tolerance = 1e-13;
    CHECK_RESULT(yc_scene_tune(s.scene, &bad), YC_OK);
    for (i = 0; i < 3; i++) {
        CHECK_RESULT(yc_scene_step(s.scene, 0.02, &stats), YC_ERROR_DIVERGED);
        CHECK(strstr(yc_scene_message(s.scene), "Newton") != NULL);
        CHECK(yc_scene_time(s.scene) == time);
        after = test_save(s.scene);
        CHECK(test_same(before, after));
        free(after.bytes);
    }
    free(before.bytes);
    CHECK_RESULT(yc_scene_tune(s.scene, &good), YC_OK);
    before = test_save(calm.scene); /* saving makes both start afresh */
    free(before.bytes);
    CHECK_RESULT(yc_scene_step(s.scene, 0.01, NULL), YC_OK);
    CHECK_RESULT(yc_scene_step(calm.scene, 0.01, NULL), YC_OK);
    before = test_save(s.scene), after = test_save(calm.scene);
    CHECK(test_same(before, after));
    free(before.bytes), free(after.bytes);
    stage_free(s), stage_free(calm);
}

typedef struct canceller {
    int calls, cancel_at;
    double last;
} canceller;

static int count_down(void *user, double fraction) {
    canceller *c = (canceller *)user;
    CHECK(fraction > 0.0 && fraction <= 1.0);
    c->last = fraction;
    return ++c->calls == c->cancel_at;
}

TEST(scene_contract_cancel) {
    yc_scene_desc settings = yc_scene_desc_default();
    yc_host host;
    canceller c;
    stage s;
    test_saved before, after;
    memset(&host, 0, sizeof host), memset(&c, 0, sizeof c);
    host.user = &c, host.progress = count_down;
    settings.dt_max = 2e-3;
    s = stage_new(&host, &settings);
    CHECK_RESULT(yc_scene_step(s.scene, 1e-3, NULL), YC_OK);
    before = test_save(s.scene);
    c.calls = 0, c.cancel_at = 3;
    CHECK_RESULT(yc_scene_step(s.scene, 0.01, NULL), YC_ERROR_CANCELLED);
    CHECK(c.calls == 3);
    after = test_save(s.scene);
    CHECK(test_same(before, after));
    CHECK_NEAR(yc_scene_time(s.scene), 1e-3, 0.0);
    c.calls = 0, c.cancel_at = -1;
    CHECK_RESULT(yc_scene_step(s.scene, 0.01, NULL), YC_OK);
    CHECK(c.calls >= 5);
    CHECK_NEAR(c.last, 1.0, 0.0);
    CHECK_NEAR(yc_scene_time(s.scene), 0.011, 1e-17);
    free(before.bytes), free(after.bytes);
    stage_free(s);
}

/* ---- bits ----------------------------------------------------------------------------------------------------- */

/* A mixed swatch folded over itself, 8 mm apart, on a floor. */
static void folded(void *user, const double uv[2], double out[3]) {
    double radius = 4e-3, bend = 0.025, arc = 3.14159265358979323846 * radius, s = uv[0] - bend;
    (void)user;
    out[2] = -uv[1];
    if (s < 0.0) out[0] = s, out[1] = 0.0;
    else if (s < arc) out[0] = radius * sin(s / radius), out[1] = radius * (1.0 - cos(s / radius));
    else out[0] = arc - s, out[1] = 2.0 * radius;
}

static test_saved run_with_workers(int workers, yc_stats *stats) {
    yc_host host = test_host_threads(workers);
    scene_swatch_desc d = scene_swatch_desc_default(SCENE_MIXED);
    scene_swatch *s = scene_swatch_new(&d);
    yc_scene_desc settings = yc_scene_desc_default();
    yc_primitive floor;
    yc_body_desc body = yc_body_desc_default();
    yc_scene *scene = NULL;
    test_saved end;
    int step;
    memset(&floor, 0, sizeof floor);

    floor.type = YC_PLANE, floor.a[1] = -4e-3, floor.b[1] = 1.0;
    body.primitive_count = 1, body.primitives = &floor;
    settings.self_contact = 1, settings.thickness = 4.2e-3, settings.slip_speed = 0.05;
    settings.newton_limit = 5, settings.best_effort = 1; /* the contract is the subject, not the accuracy */
    scene_swatch_place(s, folded, NULL);
    CHECK_RESULT(yc_scene_create(&host, &settings, &scene, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_cloth(scene, &s->cloth, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_body(scene, &body, NULL), YC_OK);
    for (step = 0; step < 5; step++)
        if (!CHECK_RESULT(yc_scene_step(scene, 1e-3, stats), YC_OK)) break;
    end = test_save(scene);
    yc_scene_destroy(scene);
    CHECK(test_heap.live == 0);
    scene_swatch_free(s);
    return end;
}

TEST(scene_contract_same_bits_for_any_workers) {
    static const int workers[] = {1, 0, 2, 3, 8};
    test_saved first, other;
    yc_stats stats;
    int i;
    first = run_with_workers(workers[0], &stats);
    CHECK(stats.body_contacts > 0 && stats.pair_contacts > 0 && stats.hybrid_nodes > 0 && stats.full_nodes > 0);
    for (i = 1; i < 5; i++) {
        other = run_with_workers(workers[i], &stats);
        CHECK(test_same(first, other));
        free(other.bytes);
    }
    free(first.bytes);
}

TEST(scene_contract_saved_state_continues_bit_for_bit) {
    yc_scene_desc settings = yc_scene_desc_default();
    stage a, b;
    test_saved middle, end_a, end_b;
    double up[3] = {0.0, 0.025, 0.001}, turn[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1}, move[3] = {0.01, 0.0, 0.0};
    int i;
    settings.self_contact = 1, settings.thickness = 2e-4, settings.tolerance = 1e-4;
    settings.newton_limit = 5, settings.best_effort = 1; /* the contract is the subject, not the accuracy */
    a = stage_new(NULL, &settings), b = stage_new(NULL, &settings);
    CHECK_RESULT(yc_scene_pin(a.scene, 0, YC_VERTEX, 35, NULL), YC_OK); /* pins are part of the state */
    for (i = 0; i < 3; i++) {
        CHECK_RESULT(yc_scene_pin(a.scene, 0, YC_VERTEX, 30, up), YC_OK);
        CHECK_RESULT(yc_scene_step(a.scene, 7e-3, NULL), YC_OK);
        up[2] += 1e-3;
    }
    CHECK_RESULT(yc_scene_move_body(a.scene, 0, turn, move), YC_OK); /* and so is a move still to come */
    middle = test_save(a.scene);
    CHECK_RESULT(yc_scene_load(b.scene, middle.bytes, middle.size), YC_OK);
    CHECK_NEAR(yc_scene_time(b.scene), yc_scene_time(a.scene), 0.0);
    for (i = 0; i < 3; i++) {
        CHECK_RESULT(yc_scene_step(a.scene, 7e-3, NULL), YC_OK);
        CHECK_RESULT(yc_scene_step(b.scene, 7e-3, NULL), YC_OK);
    }
    end_a = test_save(a.scene), end_b = test_save(b.scene);
    CHECK(test_same(end_a, end_b));
    CHECK(!test_same(middle, end_a));
    free(middle.bytes), free(end_a.bytes), free(end_b.bytes);
    stage_free(a), stage_free(b);
}

TEST(scene_contract_load_refuses_what_it_did_not_save) {
    yc_scene_desc settings = yc_scene_desc_default();
    stage s = stage_new(NULL, &settings);
    scene_swatch_desc d = tiny(SCENE_YARNS);
    scene_swatch *alone = scene_swatch_new(&d);
    yc_scene *other = NULL;
    test_saved state, foreign, now;
    char *bad;
    int row;
    CHECK_RESULT(yc_scene_create(NULL, &settings, &other, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_cloth(other, &alone->cloth, NULL), YC_OK);
    CHECK_RESULT(yc_scene_step(s.scene, 1e-3, NULL), YC_OK);
    state = test_save(s.scene), foreign = test_save(other);
    bad = (char *)malloc(state.size + 8);
    for (row = 0; row < 9; row++) {
        double nan = NAN;
        size_t size = state.size;
        memset(bad, 0, state.size + 8);
        memcpy(bad, state.bytes, state.size);
        if (row == 0) size--;
        if (row == 1) size = 0;
        if (row == 2) size += 8;
        if (row == 3) bad[0] ^= 1;
        if (row == 4) memset(bad, 0xa5, state.size);
        if (row == 5) memset(bad, 0, state.size);
        if (row == 6)
            memcpy(bad + state.size / 4 / sizeof nan * sizeof nan, &nan, sizeof nan); /* a position or speed */
        if (row == 7)
            refused(yc_scene_load(s.scene, foreign.bytes, foreign.size), YC_ERROR_PARSE, yc_scene_message(s.scene),
                "state", 5000 + row);
        else
            refused(yc_scene_load(s.scene, row == 8 ? NULL : bad, size), YC_ERROR_PARSE, yc_scene_message(s.scene),
                "state", 5000 + row);
        now = test_save(s.scene);
        CHECK(test_same(now, state));
        free(now.bytes);
        CHECK_RESULT(yc_scene_load(s.scene, state.bytes, state.size), YC_OK);
    }
    CHECK_RESULT(yc_scene_step(s.scene, 1e-3, NULL), YC_OK);
    free(bad), free(state.bytes), free(foreign.bytes);
    yc_scene_destroy(other);
    scene_swatch_free(alone);
    stage_free(s);
}
