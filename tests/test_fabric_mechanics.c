/* Woven fabrics in the tests of textile laboratories: what the presets do beside what is measured on real ones, and a
 * shirting beside what its yarns alone would do. bench-woven does the same at length. */
#include "scenes/mechanics.h"
#include "test.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

static const double degree = 3.14159265358979323846 / 180.0;

static yc_fabric shirting(void) {
    yc_fabric f;
    memset(&f, 0, sizeof f);
    CHECK_RESULT(yc_fabric_get(YC_FABRIC_SHIRTING, &f), YC_OK);
    return f;
}

static int within(double value, const double range[2]) { return value >= range[0] && value <= range[1]; }

/* The slope at the end of a curve whose linearity LT lies between 0.6 and 0.8, (2/LT - 1) force / extension. */
static int ends_within(const scene_tensile *curve, const yc_fabric *f) {
    double range[2], slope = scene_tensile_slope(curve, f->tension);
    range[0] = (2.0 / 0.8 - 1.0) * f->tension / f->extension[1];
    range[1] = (2.0 / 0.6 - 1.0) * f->tension / f->extension[0];
    printf("   %s: ends with %.3g kN/m, of %.3g to %.3g\n", f->name, 1e-3 * slope, 1e-3 * range[0], 1e-3 * range[1]);
    return within(slope, range);
}

/* The instrument itself: a strip whose tip hangs at 41.5 degrees reaches out by two bending lengths (Peirce 1930), a
 * stiff one sinks by w L^4 / (8 B), and steeper is longer. */
TEST(fabric_mechanics_elastica) {
    double stiff = scene_elastica(1e-2);
    CHECK_NEAR(scene_elastica(41.5 * degree), 2.0, 5e-3);
    CHECK_NEAR(stiff * stiff * stiff / 8.0, 1e-2, 2e-5);
    CHECK(scene_elastica(60.0 * degree) > scene_elastica(50.0 * degree) + 0.1);
}

/* Every fabric of the presets that is woven weighs what is measured on such cloth, as laid and as simulated. */
TEST(fabric_mechanics_mass) {
    yc_scene_desc settings = scene_quasistatic();
    int name;
    for (name = YC_FABRIC_SHIRTING; name <= YC_FABRIC_SATIN; name++) {
        yc_fabric f;
        scene_sample *s;
        double mass, area;
        CHECK_RESULT(yc_fabric_get((yc_fabric_name)name, &f), YC_OK);
        f.weave.size[0] = 40 * f.weave.spacing[0], f.weave.size[1] = 40 * f.weave.spacing[1];
        area = f.weave.size[0] * f.weave.size[1];
        s = scene_sample_new(&f.weave, NULL, &settings, 1, NULL);
        if (!CHECK(s != NULL)) return;
        CHECK_RESULT(yc_scene_momentum(s->scene, &mass, NULL, NULL), YC_OK);
        CHECK(within(mass / area, f.mass));
        /* Half spacings at the ends of yarns have no crimp or half of it. */
        CHECK_NEAR(mass / area / yc_weave_material(&f.weave).density, 1.0, 3e-3);
        scene_sample_free(s);
    }
}

/* The tensile curve starts soft, where the crimp goes and yarns flatten, and its extension is that of real shirtings;
 * yarns that keep their shape make it stiffer, and without crimp it is the straight line of the yarns. */
TEST(fabric_mechanics_tension) {
    yc_fabric f = shirting();
    scene_tensile_desc d;
    scene_tensile curve;
    double straight = f.weave.warp.stretch / f.weave.spacing[0], soft;
    int k;
    memset(&d, 0, sizeof d);
    d.weave = f.weave, d.axis = 1, d.across = 64, d.along = 16, d.step = 2e-3, d.force = 560.0, d.strain = 0.1;
    if (!CHECK_RESULT(scene_tensile_run(&d, &curve, NULL), YC_OK)) return;
    for (k = 2; k < curve.count; k++) /* ever stiffer */
        CHECK((curve.force[k] - curve.force[k - 1]) / (curve.strain[k] - curve.strain[k - 1]) >
            (curve.force[k - 1] - curve.force[k - 2]) / (curve.strain[k - 1] - curve.strain[k - 2]));
    soft = scene_tensile_at(&curve, f.tension);
    CHECK(within(soft, f.extension) && ends_within(&curve, &f));
    CHECK(scene_tensile_slope(&curve, f.tension) > 2.5 * curve.force[1] / curve.strain[1]);
    CHECK(curve.across[curve.count - 1] < -0.005); /* the wefts take up what the warps lose */
    CHECK(curve.force[1] / curve.strain[1] < 0.05 * straight);
    d.weave.warp.flattening = d.weave.weft.flattening = 0.0; /* what bends the crimp gives the start alone */
    if (!CHECK_RESULT(scene_tensile_run(&d, &curve, NULL), YC_OK)) return;
    CHECK(curve.force[1] / curve.strain[1] > 0.05 * straight && curve.force[1] / curve.strain[1] < 0.1 * straight);
    CHECK(scene_tensile_slope(&curve, f.tension) > 2.5 * curve.force[1] / curve.strain[1]);
    CHECK(scene_tensile_at(&curve, f.tension) < 0.7 * soft);
    d.weave.crimp[YC_WARP] = d.weave.crimp[YC_WEFT] = 0.0, d.step = 1e-3;
    if (!CHECK_RESULT(scene_tensile_run(&d, &curve, NULL), YC_OK)) return;
    for (k = 1; k < curve.count; k++) CHECK_NEAR(curve.force[k] / curve.strain[k] / straight, 1.0, 0.02);
}

/* On the bias the yarns turn instead of stretching: a modulus near four times the shear stiffness, far below either
 * yarn's. */
TEST(fabric_mechanics_bias) {
    yc_fabric f = shirting();
    scene_tensile_desc d;
    scene_tensile curve;
    double shear, modulus;
    f.weave.warp.friction = f.weave.weft.friction = 0.0;
    shear = yc_weave_material(&f.weave).shear;
    memset(&d, 0, sizeof d);
    d.weave = f.weave, d.weave.grain = 45.0 * degree, d.axis = 1, d.across = 12, d.along = 36;
    d.step = 5e-3, d.force = 1e3, d.strain = 0.01;
    if (!CHECK_RESULT(scene_tensile_run(&d, &curve, NULL), YC_OK) || !CHECK(curve.count == 3)) return;
    modulus = curve.force[1] / curve.strain[1];
    CHECK(modulus > 3.2 * shear && modulus < 4.4 * shear);
}

/* Shear under tension: stiffness as the weave's material says and as is measured; a loop with friction that is as wide
 * as is measured, none without friction; and it is narrower in a satin of the same yarns, which cross over in two
 * places of five. */
TEST(fabric_mechanics_shear) {
    yc_fabric f = shirting();
    scene_shear_desc d;
    scene_shear_loop loop, satin_loop;
    yc_draft satin;
    memset(&d, 0, sizeof d);
    d.weave = f.weave, d.axis = 0, d.across = d.along = 10, d.tension = 9.81, d.angle = 8.0 * degree, d.steps = 16;
    d.weave.warp.friction = d.weave.weft.friction = 0.0;
    if (!CHECK_RESULT(scene_shear_run(&d, &loop, NULL), YC_OK)) return;
    CHECK(within(loop.stiffness, f.shear));
    CHECK_NEAR(loop.stiffness / yc_weave_material(&f.weave).shear, 0.93, 0.04); /* less at the border */
    CHECK_NEAR(loop.hysteresis, 0.0, 1e-3);
    CHECK_NEAR(loop.work, 0.0, 1e-3);
    d.weave = f.weave;
    if (!CHECK_RESULT(scene_shear_run(&d, &loop, NULL), YC_OK)) return;
    CHECK(within(loop.stiffness, f.shear));
    CHECK(within(loop.hysteresis, f.hysteresis));
    CHECK(loop.work > 0.5 * loop.hysteresis * 4.0 * d.angle / 2.0);
    if (!CHECK_RESULT(yc_draft_satin(NULL, 5, 2, YC_WARP, &satin, NULL), YC_OK)) return;
    d.weave.draft = satin.over, d.weave.repeat[0] = satin.repeat[0], d.weave.repeat[1] = satin.repeat[1];
    d.weave.crimp[0] *= 0.4, d.weave.crimp[1] *= 0.4; /* as high over two crossings of five */
    if (CHECK_RESULT(scene_shear_run(&d, &satin_loop, NULL), YC_OK))
        CHECK(satin_loop.hysteresis < 0.5 * loop.hysteresis && satin_loop.hysteresis > 0.35 * loop.hysteresis);
    yc_draft_destroy(&satin);
}

/* The work of the loop is what friction takes: twice its moment for every turn by an angle, the moment mu N (2/3) rho
 * of what presses each crossing at rest: without tension the state adds little. */
TEST(fabric_mechanics_loop) {
    yc_fabric f = shirting();
    scene_shear_desc d;
    scene_shear_loop loop;
    const yc_yarn_material *m = &f.weave.warp;
    double moment = m->friction * m->preload * 2.0 / 3.0 * m->radius / (f.weave.spacing[0] * f.weave.spacing[1]), slack;
    memset(&d, 0, sizeof d);
    d.weave = f.weave, d.across = d.along = 10, d.angle = 8.0 * degree, d.steps = 16;
    if (!CHECK_RESULT(scene_shear_run(&d, &loop, NULL), YC_OK)) return;
    slack = 2.0 / 3.0 * m->friction * m->preload / (m->slide * m->radius); /* rad, before it yields */
    CHECK_NEAR(slack, 0.01, 1e-6);
    CHECK_NEAR(loop.hysteresis / (2.0 * moment), 1.0, 0.05);
    CHECK_NEAR(loop.work / (4.0 * moment * (d.angle - slack)), 1.0, 0.05);
}

/* Weaves of the same yarns: they hold against turning where they change sides, at half of the places in a twill 2/2, at
 * two of five in a satin; preload likewise. */
TEST(fabric_mechanics_weaves) {
    static const double share[] = {1.0, 0.5, 0.4};
    yc_fabric f = shirting();
    yc_draft draft[3];
    double stiffness[3] = {0.0, 0.0, 0.0}, hysteresis[3] = {0.0, 0.0, 0.0};
    int k, rough;
    memset(draft, 0, sizeof draft);
    CHECK_RESULT(yc_draft_plain(NULL, draft, NULL), YC_OK);
    CHECK_RESULT(yc_draft_twill(NULL, 2, 2, 'Z', draft + 1, NULL), YC_OK);
    CHECK_RESULT(yc_draft_satin(NULL, 5, 2, YC_WARP, draft + 2, NULL), YC_OK);
    for (k = 0; k < 3; k++)
        for (rough = 0; rough < 2; rough++) {
            scene_shear_desc d;
            scene_shear_loop loop;
            memset(&d, 0, sizeof d);
            d.weave = f.weave, d.weave.draft = draft[k].over;
            d.weave.crimp[0] *= share[k], d.weave.crimp[1] *= share[k]; /* as high where they cross over */
            d.weave.repeat[0] = draft[k].repeat[0], d.weave.repeat[1] = draft[k].repeat[1];
            if (!rough) d.weave.warp.friction = d.weave.weft.friction = 0.0;
            d.across = d.along = 20, d.angle = 4.0 * degree, d.steps = 8;
            if (!CHECK_RESULT(scene_shear_run(&d, &loop, NULL), YC_OK)) continue;
            if (rough) hysteresis[k] = loop.hysteresis;
            else {
                stiffness[k] = loop.stiffness;
                CHECK_NEAR(loop.stiffness / yc_weave_material(&d.weave).shear, 0.96, 0.04);
            }
        }
    for (k = 1; k < 3; k++) {
        CHECK_NEAR(stiffness[k] / stiffness[0], share[k], 0.02);
        CHECK_NEAR(hysteresis[k] / hysteresis[0], share[k], 0.03);
    }
    for (k = 0; k < 3; k++) yc_draft_destroy(draft + k);
}

/* The cantilever finds the rigidity that the yarns give, less what crimp makes them longer, for strips that reach out
 * little and far. */
TEST(fabric_mechanics_bending) {
    static const double reach[] = {1.4, 2.0, 2.6};
    yc_fabric f = shirting();
    scene_cantilever_desc d;
    scene_cantilever c;
    int axis, k;
    memset(&d, 0, sizeof d);
    d.weave = f.weave, d.across = 2;
    for (axis = 0; axis < 2; axis++)
        for (k = 0; k < 3; k++) {
            const yc_yarn_material *m = axis ? &f.weave.warp : &f.weave.weft;
            double rigidity = m->bending / f.weave.spacing[!axis];
            d.axis = axis, d.overhang = reach[k] * cbrt(rigidity / (9.81 * yc_weave_material(&f.weave).density));
            if (!CHECK_RESULT(scene_cantilever_run(&d, &c, NULL), YC_OK)) return;
            CHECK(within(c.rigidity, f.bending[!axis]));
            CHECK_NEAR(c.rigidity / rigidity * (1.0 + f.weave.crimp[!axis]), 1.0, 0.02);
        }
}

/* The other woven presets beside what is measured on their kind, on the smallest swatches of whole repeats that still
 * tell; for the extension of denim and satin, and for the latter's modulus, see bench-woven. */
static void measure(yc_fabric_name name, int repeat, int sheared, int modulus) {
    yc_fabric f;
    scene_shear_desc s;
    scene_cantilever_desc b;
    scene_tensile_desc t;
    scene_shear_loop loop[2];
    double g, width;
    int axis;
    CHECK_RESULT(yc_fabric_get(name, &f), YC_OK);
    memset(&s, 0, sizeof s), memset(&b, 0, sizeof b), memset(&t, 0, sizeof t);
    s.weave = b.weave = t.weave = f.weave;
    s.across = s.along = sheared, s.tension = 9.80665, s.angle = 8.0 * degree, s.steps = 16;
    b.across = repeat;
    t.across = 64, t.along = 16, t.step = 2e-3, t.force = f.tension, t.strain = 0.1;
    for (axis = 0; axis < 2; axis++) {
        const yc_yarn_material *m = axis ? &f.weave.warp : &f.weave.weft;
        double rigidity = m->bending / f.weave.spacing[!axis];
        scene_cantilever c;
        scene_tensile curve;
        s.axis = b.axis = t.axis = axis;
        b.overhang = 2.0 * cbrt(rigidity / (9.81 * yc_weave_material(&f.weave).density));
        if (!CHECK_RESULT(scene_shear_run(&s, loop + axis, NULL), YC_OK)) return;
        if (!CHECK_RESULT(scene_cantilever_run(&b, &c, NULL), YC_OK)) return;
        CHECK(within(c.rigidity, f.bending[!axis]));
        CHECK_NEAR(c.rigidity / rigidity * (1.0 + f.weave.crimp[!axis]), 1.0, 0.02);
        printf("   %s: B %.3g uN m\n", f.name, 1e6 * c.rigidity);
        if (!modulus) continue;
        if (!CHECK_RESULT(scene_tensile_run(&t, &curve, NULL), YC_OK)) return;
        CHECK(ends_within(&curve, &f));
    }
    g = 0.5 * (loop[0].stiffness + loop[1].stiffness), width = 0.5 * (loop[0].hysteresis + loop[1].hysteresis);
    printf("   %s: G %.3g, 2HG %.3g N/m\n", f.name, g, width);
    CHECK(within(g, f.shear));
    CHECK(within(width, f.hysteresis));
}

TEST(fabric_mechanics_linen) { measure(YC_FABRIC_LINEN, 2, 8, 1); }
TEST(fabric_mechanics_denim) { measure(YC_FABRIC_DENIM, 4, 8, 1); }
TEST(fabric_mechanics_satin) { measure(YC_FABRIC_SATIN, 5, 10, 0); }

/* A small disc drapes: in folds, its shadow between the support's and its own; the softer the yarns, the less of it. */
TEST(fabric_mechanics_drape) {
    yc_fabric f = shirting();
    scene_drape_desc d;
    scene_drape stiff, soft;
    int family;
    f.weave.warp.friction = f.weave.weft.friction = 0.0, f.weave.crimp[0] = f.weave.crimp[1] = 0.0;
    f.weave.bundle = 36;
    d = scene_drape_desc_default(&f.weave);
    d.duration = 0.4, d.dt = 0.02;
    if (!CHECK_RESULT(scene_drape_run(&d, &stiff, NULL), YC_OK)) return;
    CHECK(stiff.coefficient > 0.3 && stiff.coefficient < 0.8 && stiff.folds >= 3);
    for (family = 0; family < 2; family++) {
        yc_yarn_material *m = family ? &d.weave.weft : &d.weave.warp;
        m->bending *= 0.2, m->shear *= 0.2;
    }
    if (!CHECK_RESULT(scene_drape_run(&d, &soft, NULL), YC_OK)) return;
    CHECK(soft.coefficient < stiff.coefficient - 0.1);
}

/* Of a shirting of n by n yarns or bundles: shear, the loop's width, without tension and with, mass per area, and
 * bending. */
static void bundled(int n, int bundle, double value[6]) {
    yc_fabric f = shirting();
    yc_scene_desc settings = scene_quasistatic();
    scene_sample *s;
    scene_shear_desc d;
    scene_shear_loop loop;
    scene_cantilever_desc b;
    scene_cantilever c;
    int k;
    f.weave.bundle = bundle;
    memset(&d, 0, sizeof d), memset(&b, 0, sizeof b), memset(value, 0, 6 * sizeof *value);
    d.weave = b.weave = f.weave, d.across = d.along = n, d.angle = 8.0 * degree, d.steps = 16;
    for (k = 0; k < 2; k++, d.tension = 100.0) {
        if (!CHECK_RESULT(scene_shear_run(&d, &loop, NULL), YC_OK)) return;
        value[2 * k] = loop.stiffness, value[2 * k + 1] = loop.hysteresis;
    }
    b.axis = 1, b.across = 4, b.overhang = 0.03;
    if (CHECK_RESULT(scene_cantilever_run(&b, &c, NULL), YC_OK)) value[5] = c.rigidity;
    f.weave.size[0] = 48 * f.weave.spacing[0], f.weave.size[1] = 48 * f.weave.spacing[1];
    s = scene_sample_new(&f.weave, NULL, &settings, 1, NULL);
    if (CHECK(s != NULL) && CHECK_RESULT(yc_scene_momentum(s->scene, value + 4, NULL, NULL), YC_OK))
        value[4] /= f.weave.size[0] * f.weave.size[1];
    scene_sample_free(s);
}

/* Single yarns and bundles of four. The border's share falls as 1 / n and is taken off by two swatches. Of bundles it
 * is larger, 12 % of 2HG at n = 6: their free ends beyond the last crossing are longer, against what bends them, and
 * give way instead of turning. What is left of that is 4 % of G where no tension helps; the rest agrees within 1 %. */
TEST(fabric_mechanics_bundles) {
    static const char *const names[6] = {"G", "2HG", "G under 100 N/m", "2HG under 100 N/m", "mass", "B"};
    double value[2][2][6];
    int i, k;
    for (k = 0; k < 2; k++)
        for (i = 0; i < 2; i++) bundled(i ? 12 : 6, k ? 4 : 1, value[k][i]);
    for (i = 0; i < 6; i++) {
        double single = 2.0 * value[0][1][i] - value[0][0][i], four = 2.0 * value[1][1][i] - value[1][0][i];
        printf("   %s: of n = 6, 12 yarns %.5g, %.5g, bundles %.5g, %.5g, the border off x %.4f\n", names[i],
            value[0][0][i], value[0][1][i], value[1][0][i], value[1][1][i], four / single);
        CHECK_NEAR(four / single, 1.0, i == 0 ? 0.05 : 0.01);
    }
}

/* Denim of 20 by 20 buckles on the way: corrections fell by 4 % an iteration while the Hessian lacked its negative
 * part. */
TEST(fabric_mechanics_shear_near_buckling) {
    yc_fabric f;
    scene_shear_desc d;
    scene_shear_loop loop;
    char why[YC_MESSAGE_SIZE] = "";
    CHECK_RESULT(yc_fabric_get(YC_FABRIC_DENIM, &f), YC_OK);
    memset(&d, 0, sizeof d);
    d.weave = f.weave, d.axis = 1, d.across = d.along = 20, d.tension = 9.81, d.angle = 8.0 * degree, d.steps = 16;
    if (!CHECK_RESULT(scene_shear_run(&d, &loop, why), YC_OK)) printf("   %s\n", why);
    printf("   denim, 20 x 20: at most %d iterations\n", loop.newton);
    CHECK(loop.newton < 100);
}
