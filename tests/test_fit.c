/* Triangle materials fitted to weaves: what is known in closed form, the laboratory's tests, and a sheet beside its
 * yarns. */
#include "scenes/mechanics.h"
#include "test.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double degree = 3.14159265358979323846 / 180.0;

static yc_weave_desc weave_of(yc_fabric_name name) {
    yc_fabric f;
    CHECK_RESULT(yc_fabric_get(name, &f), YC_OK);
    return f.weave;
}

static int fit_weave(const yc_weave_desc *weave, double strain, yc_triangle_material *m, yc_fit *fit) {
    char why[YC_MESSAGE_SIZE] = "?";
    int held = CHECK_RESULT(yc_fit_material(NULL, weave, strain, m, fit, why), YC_OK);
    return held & CHECK_TEXT(why, "");
}

/* A weave without crimp is what yc_weave_material adds up, but for Green's strain, which is larger than the yarns' by
 * half of its square: (1 + e)^-1 of the stiffness at a stretch e. So it is with other spacings, materials and drafts,
 * and in bundles. */
TEST(fit_straight) {
    static const unsigned char twill[16] = {1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 1, 1, 1, 0, 0, 1};
    const double strain = 1e-3;
    int k, f;
    for (k = 0; k < 3; k++) {
        yc_weave_desc d = yc_weave_desc_default();
        yc_triangle_material m, known;
        yc_fit fit;
        d.spacing[0] = 1.5e-3, d.warp.stretch = 80.0, d.warp.bending = 5e-9, d.weft.shear = 6e-3;
        if (k == 1) d.draft = twill, d.repeat[0] = d.repeat[1] = 4;
        if (k == 2) d.bundle = 3, d.grain = 0.7, d.size[0] = 1.0, d.edge[0] = YC_EDGE_SELVEDGE;
        known = yc_weave_material(&d);
        if (!fit_weave(&d, strain, &m, &fit)) return;
        for (f = 0; f < 2; f++) CHECK_NEAR(m.stretch[f] / known.stretch[f], 1.0, strain);
        CHECK_NEAR(m.coupling / known.stretch[0], 0.0, 1e-6);
        CHECK_NEAR(m.shear / known.shear, 1.0, 1e-5);
        CHECK_NEAR(m.bending / known.bending, 1.0, 1e-3);
        CHECK_NEAR(fit.bending[0] * d.spacing[1] / d.weft.bending, 1.0, 1e-3);
        CHECK_NEAR(fit.bending[1] * d.spacing[0] / d.warp.bending, 1.0, 1e-3);
        CHECK(m.density == known.density && fit.strain == strain && fit.newton > 0);
        for (f = 0; f < YC_FIT_BEND_U; f++) CHECK(fit.test[f] < 2e-4);
    }
}

/* Along both axes the sheet pulls as the cloth does in the laboratory's tension test at small strain, with what that
 * test narrows it by; and it bends as the yarns do, less what crimp makes them longer. Swatches are such that the test
 * measures over whole repeats; of a satin they are not uniform over as many. */
static void laboratory(yc_fabric_name name, int across, int along, double tolerance) {
    yc_weave_desc d = weave_of(name);
    yc_triangle_material m;
    yc_fit fit;
    scene_tensile_desc t;
    scene_tensile curve;
    int axis;
    d.warp.friction = d.weft.friction = 0.0;
    if (!fit_weave(&d, 2e-3, &m, &fit)) return;
    memset(&t, 0, sizeof t);
    t.weave = d, t.across = across, t.along = along, t.step = 1e-3, t.force = 1e3, t.strain = 2e-3;
    for (axis = 0; axis < 2; axis++) {
        double force, bent = axis ? d.warp.bending / d.spacing[0] : d.weft.bending / d.spacing[1];
        t.axis = axis;
        if (!CHECK_RESULT(scene_tensile_run(&t, &curve, NULL), YC_OK) || !CHECK(curve.count == 3)) return;
        force = m.stretch[axis] * curve.strain[1] + m.coupling * curve.across[1];
        printf("   axis %d: sheet %.5g, test %.5g N/m at a strain of %.3g, %.3g across\n", axis,
            force / curve.strain[1], curve.force[1] / curve.strain[1], curve.strain[1], curve.across[1]);
        CHECK_NEAR(force / curve.force[1], 1.0, tolerance);
        CHECK_NEAR(fit.bending[axis] / bent * (1.0 + d.crimp[!axis]), 1.0, 0.02);
    }
    CHECK(fit.residual < 0.25 && fit.test[YC_FIT_SHEAR] < 1e-3);
}

TEST(fit_shirting) { laboratory(YC_FABRIC_SHIRTING, 65, 25, 0.01); }
TEST(fit_linen) { laboratory(YC_FABRIC_LINEN, 65, 25, 0.01); }
TEST(fit_denim) { laboratory(YC_FABRIC_DENIM, 65, 25, 0.03); }
TEST(fit_satin) { laboratory(YC_FABRIC_SATIN, 61, 31, 0.06); }

/* The trellis in two sizes: the border's share falls as 1 / n, and a little faster under tension. */
TEST(fit_shear) {
    yc_weave_desc weave = weave_of(YC_FABRIC_SHIRTING);
    yc_triangle_material m;
    scene_shear_desc d;
    scene_shear_loop loop[2];
    int k;
    weave.warp.friction = weave.weft.friction = 0.0;
    if (!fit_weave(&weave, 0.02, &m, NULL)) return;
    memset(&d, 0, sizeof d);
    d.weave = weave, d.angle = 4.0 * degree, d.steps = 8, d.tension = 9.81;
    for (k = 0; k < 2; k++) {
        d.across = d.along = k ? 16 : 8;
        if (!CHECK_RESULT(scene_shear_run(&d, loop + k, NULL), YC_OK)) return;
    }
    printf("   sheet %.5g, trellis %.5g, %.5g N/m\n", m.shear, loop[0].stiffness, loop[1].stiffness);
    CHECK_NEAR((2.0 * loop[1].stiffness - loop[0].stiffness) / m.shear, 1.0, 0.03);
}

/* ---- a sheet beside its yarns ------------------------------------------------------------------------------------ */

#define FIT_CELLS_U 26
#define FIT_CELLS_V 10
#define FIT_VERTICES ((FIT_CELLS_U + 1) * (FIT_CELLS_V + 1))
#define FIT_TRIANGLES (2 * FIT_CELLS_U * FIT_CELLS_V)

/* Vertices row by row, and triangles with alternating diagonals. */
static void fit_mesh(const double size[2], double (*x)[3], double (*uv)[2], int (*triangles)[3]) {
    int i, j, t = 0;
    for (i = 0; i < FIT_VERTICES; i++) {
        const int row = i / (FIT_CELLS_U + 1);
        uv[i][0] = x[i][0] = size[0] * (i % (FIT_CELLS_U + 1)) / FIT_CELLS_U;
        uv[i][1] = x[i][1] = size[1] * row / FIT_CELLS_V, x[i][2] = 0.0;
    }
    for (j = 0; j < FIT_CELLS_V; j++)
        for (i = 0; i < FIT_CELLS_U; i++) {
            int a = j * (FIT_CELLS_U + 1) + i, b = a + 1, c = a + FIT_CELLS_U + 1, d = c + 1, flip = (i + j) & 1, k;
            int both[2][3];
            both[0][0] = a, both[0][1] = b, both[0][2] = flip ? c : d;
            both[1][0] = flip ? b : a, both[1][1] = d, both[1][2] = c;
            for (k = 0; k < 6; k++) triangles[t + k / 3][k % 3] = both[k / 3][k % 3];
            t += 2;
        }
}

/* Pulls a sheet by its lower and upper side to a strain: force per width, and the strain of the middle. */
static int fit_pull(const yc_triangle_material *m, const double size[2], double strain, double *force, double *middle) {
    static double x[FIT_VERTICES][3], uv[FIT_VERTICES][2];
    static int triangles[FIT_TRIANGLES][3];
    yc_scene_desc settings = scene_quasistatic();
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_scene *scene;
    int i, low = 3 * (FIT_CELLS_U + 1) + FIT_CELLS_U / 2, high = 7 * (FIT_CELLS_U + 1) + FIT_CELLS_U / 2, held = 1;
    fit_mesh(size, x, uv, triangles);
    cloth.mesh.vertex_count = cloth.mesh.uv_count = FIT_VERTICES, cloth.mesh.triangle_count = FIT_TRIANGLES;
    cloth.mesh.positions = (const double(*)[3])x, cloth.mesh.uv = (const double(*)[2])uv;
    cloth.mesh.triangles = (const int(*)[3])triangles, cloth.material = *m;
    if (!CHECK_RESULT(yc_scene_create(NULL, &settings, &scene, NULL), YC_OK)) return 0;
    held &= CHECK_RESULT(yc_scene_add_cloth(scene, &cloth, NULL), YC_OK);
    for (i = 0; i < FIT_VERTICES && held; i++) {
        double to[3] = {x[i][0], x[i][1] * (1.0 + strain), 0.0};
        if (i > FIT_CELLS_U && i < FIT_VERTICES - FIT_CELLS_U - 1) continue;
        held &= CHECK_RESULT(yc_scene_pin(scene, 0, YC_VERTEX, i, to), YC_OK);
    }
    held = held && CHECK_RESULT(yc_scene_step(scene, 1e3, NULL), YC_OK);
    for (*force = 0.0, i = FIT_VERTICES - FIT_CELLS_U - 1; i < FIT_VERTICES && held; i++) {
        double f[3];
        held &= CHECK_RESULT(yc_scene_pin_force(scene, 0, YC_VERTEX, i, f), YC_OK);
        *force += f[1] / size[0];
    }
    held = held && CHECK_RESULT(yc_scene_positions(scene, 0, YC_VERTEX, x), YC_OK);
    *middle = (x[high][1] - x[low][1]) / (uv[high][1] - uv[low][1]) - 1.0;
    yc_scene_destroy(scene);
    return held;
}

/* A strip of the fitted sheet and one of yarns are drawn between clamps: the work that their middles take up to a
 * strain differs by what the residual says, for crimped yarns and sheet alike narrow. */
TEST(fit_sheet_beside_yarns) {
    yc_weave_desc d = weave_of(YC_FABRIC_SHIRTING);
    yc_triangle_material m;
    yc_fit fit;
    scene_tensile_desc t;
    scene_tensile curve;
    double size[2], strain[5], force[5], yarn_work = 0.0, off = 0.0, sum = 0.0, work = 0.0;
    int k, i = 1;
    d.warp.friction = d.weft.friction = 0.0;
    if (!fit_weave(&d, 0.02, &m, &fit)) return;
    memset(&t, 0, sizeof t);
    t.weave = d, t.axis = 1, t.across = 65, t.along = 25, t.step = 1e-3, t.force = 1e4, t.strain = 0.022;
    if (!CHECK_RESULT(scene_tensile_run(&t, &curve, NULL), YC_OK)) return;
    size[0] = t.across * d.spacing[0], size[1] = t.along * d.spacing[1];
    strain[0] = force[0] = 0.0;
    for (k = 1; k < 5; k++) {
        double share;
        if (!fit_pull(&m, size, 5e-3 * k, force + k, strain + k)) return;
        work += 0.5 * (force[k] + force[k - 1]) * (strain[k] - strain[k - 1]);
        for (; i + 1 < curve.count && curve.strain[i] < strain[k]; i++)
            yarn_work += 0.5 * (curve.force[i] + curve.force[i - 1]) * (curve.strain[i] - curve.strain[i - 1]);
        share = strain[k] - curve.strain[i - 1]; /* of the curve's next piece; its force there, linear in between */
        share = yarn_work + share * (curve.force[i - 1] + 0.5 * share * scene_tensile_slope(&curve, curve.force[i]));
        if (!CHECK(curve.strain[i] >= strain[k])) return;
        off += (work - share) * (work - share), sum += share * share;
        printf(
            "   at a strain of %.4f: sheet %.4g N/m, %.4g J/m^2, yarns %.4g J/m^2\n", strain[k], force[k], work, share);
    }
    printf("   off by %.4f, residual %.4f\n", sqrt(off / sum), fit.test[YC_FIT_PULL_V]);
    CHECK(sqrt(off / sum) < 1.5 * fit.test[YC_FIT_PULL_V]);
    CHECK(fabs(force[4] / strain[4] / yc_weave_material(&d).stretch[1] - 1.0) > 0.9); /* which knows of no crimp */
}

/* The wider the range, the stiffer and the worse the fit of a cloth whose crimp goes. */
TEST(fit_range) {
    yc_weave_desc d = weave_of(YC_FABRIC_SHIRTING);
    yc_triangle_material small, usual, wide, same;
    yc_fit fit[4];
    int i;
    if (!fit_weave(&d, 1e-3, &small, fit) || !fit_weave(&d, 0.0, &usual, fit + 1)) return;
    if (!fit_weave(&d, 0.05, &wide, fit + 2) || !fit_weave(&d, 0.02, &same, fit + 3)) return;
    CHECK(small.stretch[1] < usual.stretch[1] && usual.stretch[1] < wide.stretch[1]);
    CHECK(fit[0].test[YC_FIT_PULL_V] < 2e-3 && fit[1].test[YC_FIT_PULL_V] < 0.03 && fit[2].test[YC_FIT_PULL_V] > 0.05);
    CHECK(small.coupling > 0.1 * small.stretch[1]); /* crimp goes from one family to the other */
    for (i = 0; i < 2; i++) CHECK(usual.stretch[i] == same.stretch[i]);
    CHECK(usual.coupling == same.coupling && usual.shear == same.shear && usual.bending == same.bending);
    CHECK(usual.density == same.density && fit[1].strain == 0.02);
}

TEST(fit_wrong_inputs) {
    yc_weave_desc good = yc_weave_desc_default(), d;
    yc_triangle_material m;
    yc_fit fit;
    yc_host half;
    char why[YC_MESSAGE_SIZE];
    m.shear = 42.0, fit.residual = 43.0;
    memset(&half, 0, sizeof half), half.free = test_host_counting().free;
#define FIT_REFUSED(host, desc, strain, out, part) \
    CHECK_RESULT(yc_fit_material(host, desc, strain, out, &fit, why), YC_ERROR_ARGUMENT), CHECK_TEXT(why, part)
    FIT_REFUSED(NULL, NULL, 0.0, &m, "desc and out must not be NULL");
    FIT_REFUSED(NULL, &good, 0.0, NULL, "desc and out must not be NULL");
    FIT_REFUSED(&half, &good, 0.0, &m, "host.alloc and host.free must be given both or neither");
    FIT_REFUSED(NULL, &good, -0.01, &m, "strain = -0.01 must lie in [0, 0.2]");
    FIT_REFUSED(NULL, &good, 0.21, &m, "strain = 0.21 must lie in [0, 0.2]");
    FIT_REFUSED(NULL, &good, NAN, &m, "strain = nan must lie in [0, 0.2]");
    d = good, d.cookie = 0;
    FIT_REFUSED(NULL, &d, 0.0, &m, "weave.cookie: not made by yc_weave_desc_default()");
    d = good, d.spacing[1] = -1.0;
    FIT_REFUSED(NULL, &d, 0.0, &m, "weave.spacing[1] = -1 must be greater than 0");
    {
        static const unsigned char draft[65] = {1};
        d = good, d.draft = draft, d.repeat[0] = 65, d.repeat[1] = 1;
        FIT_REFUSED(NULL, &d, 0.0, &m, "weave.repeat[0] = 65 must be at most 64 for a fit");
    }
#undef FIT_REFUSED
    CHECK(m.shear == 42.0 && fit.residual == 43.0);
}

/* Memory runs out at each allocation up to where the second scene stands, and then at every 29th: all is given back. */
TEST(fit_out_of_memory) {
    yc_weave_desc d = yc_weave_desc_default();
    yc_triangle_material m;
    yc_fit fit;
    yc_host host = test_host_counting();
    int n, calls;
    if (!CHECK_RESULT(yc_fit_material(&host, &d, 0.0, &m, &fit, NULL), YC_OK)) return;
    calls = test_heap.calls;
    printf("   %d allocations\n", calls);
    CHECK(test_heap.live == 0);
    m.shear = 42.0, fit.residual = 43.0;
    for (n = 0; n < calls; n += n < calls / 7 ? 1 : 29) {
        char why[YC_MESSAGE_SIZE] = "";
        host = test_host_failing(n);
        if (!test_refused_memory(yc_fit_material(&host, &d, 0.0, &m, &fit, why), why)) break;
    }
    CHECK(n >= calls && m.shear == 42.0 && fit.residual == 43.0);
}
