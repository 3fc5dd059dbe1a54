/* Woven yarns as they undulate: what a weave lays, the soft start of the tensile curve and the interchange of crimp,
 * against a unit cell and against Peirce's geometry; friction of turning; the scene's promises with both. */
#include "scenes/scenes.h"
#include "test.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double kappa = 1.125;

/* ---- swatches ------------------------------------------------------------------------------------------------- */

/* A shirting: 34 ends and 28 picks per cm, crimp 7 % in the warp and 5 % in the weft. */
static yc_weave_desc shirting(int warps, int wefts) {
    yc_weave_desc d = yc_weave_desc_default();
    d.spacing[0] = 0.01 / 34.0, d.spacing[1] = 0.01 / 28.0;
    d.size[0] = warps * d.spacing[0], d.size[1] = wefts * d.spacing[1];
    d.warp.stretch = 50.0, d.warp.bending = d.warp.crimp_bending = 2.7e-9, d.warp.friction = 0.0;
    d.weft = d.warp;
    d.crimp[YC_WARP] = 0.07, d.crimp[YC_WEFT] = 0.05;
    return d;
}

/* Long damped steps without gravity: each is a minimisation of the energy. */
static yc_scene_desc quasistatic(void) {
    yc_scene_desc d = yc_scene_desc_preset(YC_REFERENCE);
    memset(d.gravity, 0, sizeof d.gravity);
    d.dt_max = 1e3, d.dt_min = 1.0, d.mass_damping = 1.0, d.tolerance = 1e-10, d.newton_limit = 200;
    return d;
}

typedef struct woven {
    yc_weave_desc weave;
    yc_yarns yarns;
    yc_scene *scene;
    double (*x)[3];
} woven;

static woven woven_new(const yc_weave_desc *weave, const yc_scene_desc *settings, int hold_sliding) {
    woven w;
    yc_cloth_desc cloth = yc_cloth_desc_default();
    memset(&w, 0, sizeof w);
    w.weave = *weave;
    CHECK_RESULT(yc_weave(NULL, weave, NULL, &w.yarns, NULL), YC_OK);
    cloth.yarns = &w.yarns, cloth.hold_sliding = hold_sliding;
    CHECK_RESULT(yc_scene_create(NULL, settings, &w.scene, NULL), YC_OK);
    CHECK_RESULT(yc_scene_add_cloth(w.scene, &cloth, NULL), YC_OK);
    w.x = (double(*)[3])calloc((size_t)w.yarns.node_count, sizeof *w.x);
    return w;
}

static void woven_free(woven *w) {
    yc_scene_destroy(w->scene), yc_yarns_destroy(&w->yarns);
    free(w->x);
}

/* The node nearest to a place of the pattern. */
static int node_at(const woven *w, double u, double v) {
    double nearest = HUGE_VAL;
    int i, best = 0;
    for (i = 0; i < w->yarns.node_count; i++) {
        const double *at = w->yarns.layout[i];
        double d = (at[0] - u) * (at[0] - u) + (at[1] - v) * (at[1] - v);
        if (d < nearest) nearest = d, best = i;
    }
    return best;
}

/* Strain along an axis of the middle half of the cloth, ends of yarns aside. */
static double strain_of(const woven *w, int axis) {
    double from[2], to[2];
    int a, b;
    from[!axis] = to[!axis] = 0.5 * w->weave.size[!axis];
    from[axis] = 0.25 * w->weave.size[axis], to[axis] = 0.75 * w->weave.size[axis];
    a = node_at(w, from[0], from[1]), b = node_at(w, to[0], to[1]);
    return (w->x[b][axis] - w->x[a][axis]) / (w->yarns.layout[b][axis] - w->yarns.layout[a][axis]) - 1.0;
}

/* Draws the yarn ends at both sides of an axis apart by a strain of the whole; returns the force per width, N/m. */
static double pull(woven *w, int axis, double strain, yc_stats *stats) {
    double force = 0.0, length = w->weave.size[axis];
    int i;
    for (i = 0; i < w->yarns.node_count; i++) {
        double to[3], v = w->yarns.layout[i][axis];
        if (v > 1e-9 && v < length - 1e-9) continue;
        memcpy(to, w->yarns.layout[i], sizeof to);
        if (v > 1e-9) to[axis] = length * (1.0 + strain);
        CHECK_RESULT(yc_scene_pin(w->scene, 0, YC_NODE, i, to), YC_OK);
    }
    if (!CHECK_RESULT(yc_scene_step(w->scene, 1e3, stats), YC_OK)) return NAN;
    for (i = 0; i < w->yarns.node_count; i++) {
        double f[3];
        if (w->yarns.layout[i][axis] < length - 1e-9) continue;
        CHECK_RESULT(yc_scene_pin_force(w->scene, 0, YC_NODE, i, f), YC_OK);
        force += f[axis];
    }
    CHECK_RESULT(yc_scene_positions(w->scene, 0, YC_NODE, w->x), YC_OK);
    return force / w->weave.size[!axis];
}

/* ---- what is laid --------------------------------------------------------------------------------------------- */

TEST(scene_crimp_layout) {
    static const unsigned char twill[16] = {1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 1, 1, 1, 0, 0, 1};
    static const unsigned char satin[25] = {1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0};
    const unsigned char *draft[3] = {NULL, twill, satin};
    static const int repeat[3] = {2, 4, 5};
    int kind, i, k;
    for (kind = 0; kind < 3; kind++) {
        yc_weave_desc d = shirting(31, 31);
        yc_yarns y;
        double length[2] = {0.0, 0.0}, cloth[2] = {0.0, 0.0};
        d.draft = draft[kind], d.repeat[0] = d.repeat[1] = repeat[kind];
        if (!CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, NULL), YC_OK)) return;
        for (i = 0; i < y.yarn_count; i++) /* whole repeats: 30 spacings between the first and the last crossing */
            for (k = y.yarn_first[i] + 1; k + 2 < y.yarn_first[i + 1]; k++) {
                int f = y.yarn_family[i];
                const double *a = y.layout[y.visit_node[k]], *b = y.layout[y.visit_node[k + 1]];
                double p = hypot(b[0] - a[0], b[1] - a[1]), du = y.visit_u[k + 1] - y.visit_u[k];
                double dy = y.visit_layer[k + 1] * y.visit_height[k + 1] - y.visit_layer[k] * y.visit_height[k];
                CHECK_NEAR(du, sqrt(p * p + kappa * dy * dy), 1e-12 * p);
                length[f] += du, cloth[f] += p;
            }
        for (k = 0; k < 2; k++) CHECK_NEAR(length[k] / cloth[k] - 1.0, d.crimp[k], 1e-12);
        for (k = 0; k < y.visit_count; k++) CHECK((y.visit_height[k] == 0.0) == (y.visit_layer[k] == 0));
        CHECK_RESULT(yc_yarns_check(&y, NULL, NULL), YC_OK);
        y.visit_height[1] = -1e-6;
        CHECK_RESULT(yc_yarns_check(&y, NULL, NULL), YC_ERROR_ARGUMENT);
        y.visit_height[1] = NAN;
        CHECK_RESULT(yc_yarns_check(&y, NULL, NULL), YC_ERROR_ARGUMENT);
        y.visit_height[1] = 1e-5, y.visit_height[0] = 1e-5; /* a lone end */
        CHECK_RESULT(yc_yarns_check(&y, NULL, NULL), YC_ERROR_ARGUMENT);
        yc_yarns_destroy(&y);
        CHECK_NEAR(yc_weave_material(&d).density,
            d.warp.density * 1.07 / d.spacing[0] + d.weft.density * 1.05 / d.spacing[1], 1e-15);
        d.crimp[0] = -0.01;
        CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, NULL), YC_ERROR_ARGUMENT);
        d.crimp[0] = NAN;
        CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, NULL), YC_ERROR_ARGUMENT);
    }
}

/* A laid-out cloth rests, weighs what its yarns do, and falls, thrown and turned anyhow, without undulating. */
TEST(scene_crimp_rests) {
    yc_weave_desc d = shirting(6, 6);
    yc_scene_desc settings = yc_scene_desc_preset(YC_REFERENCE);
    woven w = woven_new(&d, &settings, 0);
    double terms[YC_TERM_COUNT], mass, expected = 0.0, worst = 0.0, v[3] = {0.3, 2.0, -0.4};
    yc_stats stats;
    int i, k;
    CHECK_RESULT(yc_scene_energy(w.scene, terms), YC_OK);
    for (i = 0; i < YC_TERM_COUNT; i++)
        if (i != YC_TERM_GRAVITY) CHECK_NEAR(terms[i], 0.0, 1e-25);
    for (i = 0; i < w.yarns.yarn_count; i++)
        expected += w.yarns.materials[w.yarns.yarn_material[i]].density *
            (w.yarns.visit_u[w.yarns.yarn_first[i + 1] - 1] - w.yarns.visit_u[w.yarns.yarn_first[i]]);
    CHECK_RESULT(yc_scene_momentum(w.scene, &mass, NULL, NULL), YC_OK);
    CHECK_NEAR(mass / expected, 1.0, 1e-13);
    for (i = 0; i < w.yarns.node_count; i++) CHECK_RESULT(yc_scene_set_velocity(w.scene, 0, YC_NODE, i, v), YC_OK);
    for (i = 0; i < 10; i++) CHECK_RESULT(yc_scene_step(w.scene, 1e-3, &stats), YC_OK);
    CHECK(stats.dofs == 3 * w.yarns.node_count + 3 * 36); /* two u and one z for each crossing */
    CHECK_RESULT(yc_scene_positions(w.scene, 0, YC_NODE, w.x), YC_OK);
    for (i = 0; i < w.yarns.node_count; i++)
        for (k = 0; k < 3; k++)
            worst = fmax(worst, fabs(w.x[i][k] - w.x[0][k] - w.yarns.layout[i][k] + w.yarns.layout[0][k]));
    CHECK_NEAR(worst, 0.0, 1e-11);
    woven_free(&w);
}

/* ---- tension -------------------------------------------------------------------------------------------------- */

/* The same energies on one cell of a plain weave without ends: yarn f of length l[f], height h[f], along spacing p[f],
 * under tension t in yarn 0 and none in yarn 1. Over p0, p1, and what each yarn's height gains: the other's loss, or,
 * where yarns flatten, whatever balances both with the pressure between them. */
typedef struct cell {
    double l[2], p[2], h[2], stretch, bending, tension, flattening, depth;
} cell;

static double cell_energy(const cell *c, const double q[4]) {
    double e = -c->tension * q[0], h, gain[2], d;
    int f;
    gain[0] = q[2], gain[1] = c->flattening > 0.0 ? q[3] : -q[2];
    d = -gain[0] - gain[1];
    e += 0.5 * c->flattening * d * d * (1.0 + 0.5 * (d / c->depth) * (d / c->depth));
    for (f = 0; f < 2; f++) {
        double rise = 2.0 * (c->h[f] + gain[f]);
        double s = sqrt(q[f] * q[f] + kappa * rise * rise) / c->l[f] - 1.0;
        h = 2.0 * gain[f]; /* both kinks of a cell's yarn: 2 rise / l, away from rest */
        e += 0.5 * c->stretch * c->l[f] * s * s;
        e += 3.0 * c->bending * (2.0 * h / c->l[f]) * (2.0 * h / c->l[f]) / (2.0 * c->l[f]);
    }
    return e;
}

/* Strains of both yarns' spacings under a tension. */
static void cell_solve(const yc_weave_desc *d, double tension, double strain[2]) {
    cell c;
    double q[4], size[4];
    int f, pass, i, side, count;
    c.stretch = d->warp.stretch, c.bending = d->warp.crimp_bending, c.tension = tension;
    c.flattening = 0.5 * d->warp.flattening, c.depth = 0.4 * d->warp.radius; /* two in series */
    count = c.flattening > 0.0 ? 4 : 3;
    for (f = 0; f < 2; f++) {
        c.p[f] = d->spacing[!f], c.l[f] = c.p[f] * (1.0 + d->crimp[f]);
        c.h[f] = 0.5 * sqrt((c.l[f] * c.l[f] - c.p[f] * c.p[f]) / kappa), q[f] = c.p[f];
    }
    q[2] = q[3] = 0.0, size[0] = size[1] = size[2] = 1e-5, size[3] = count > 3 ? 1e-5 : 0.0;
    for (pass = 0; pass < 400000 && size[0] + size[1] + size[2] + size[3] > 1e-13; pass++) { /* no derivatives */
        i = pass % count;
        for (side = 0; side < 2; side++) {
            double before = cell_energy(&c, q), step = side ? -size[i] : size[i];
            q[i] += step;
            if (cell_energy(&c, q) < before) {
                size[i] *= 1.5;
                break;
            }
            q[i] -= step;
        }
        if (side == 2) size[i] *= 0.5;
    }
    for (f = 0; f < 2; f++) strain[f] = q[f] / c.p[f] - 1.0;
}

/* The tensile curve of a shirting: soft while the crimp goes, stiff as straight yarns in the end. */
TEST(scene_crimp_tension) {
    yc_weave_desc d = shirting(8, 20);
    yc_scene_desc settings = quasistatic();
    woven w = woven_new(&d, &settings, 1);
    double force[13] = {0.0}, strain[13] = {0.0}, straight = d.warp.stretch / d.spacing[0], at = 0.0, slope;
    int i, most = 0;
    yc_stats stats;
    for (i = 1; i <= 12; i++) {
        double cell_strain[2];
        force[i] = pull(&w, 1, 0.008 * i, &stats), strain[i] = strain_of(&w, 1);
        if (!CHECK(force[i] > force[i - 1] && strain[i] > strain[i - 1])) break;
        most = stats.newton > most ? stats.newton : most;
        cell_solve(&d, force[i] * d.spacing[0], cell_strain);
        CHECK_NEAR(strain[i] / cell_strain[0], 1.0, 0.03); /* in the middle of a swatch with ends */
        CHECK_NEAR(strain_of(&w, 0) / cell_strain[1], 1.0, 0.03);
        if (at == 0.0 && force[i] > 490.0)
            at = strain[i - 1] + (strain[i] - strain[i - 1]) * (490.0 - force[i - 1]) / (force[i] - force[i - 1]);
    }
    CHECK(at > 0.02 && at < 0.06); /* of real shirtings under 5 N/cm */
    CHECK(force[1] / strain[1] < 0.1 * straight);
    CHECK(most <= 12);
    slope = force[12], at = strain[12];
    slope = (pull(&w, 1, 0.13, &stats) - slope) / (strain_of(&w, 1) - at);
    CHECK(slope > 0.85 * straight / 1.07 && slope < straight / 1.07);
    woven_free(&w);
}

/* Yarns that flatten: the same, each yarn with a height of its own and the curve of compression between both, as in
 * Kawabata's (1973) biaxial theory. Softer from the start, and the more the harder it is drawn. */
TEST(scene_crimp_flattening) {
    yc_weave_desc d = shirting(8, 20);
    yc_scene_desc settings = quasistatic();
    double terms[YC_TERM_COUNT], force = 0.0, rigid[2], cell_strain[2];
    woven w;
    yc_stats stats;
    int i;
    cell_solve(&d, 490.0 * d.spacing[0], rigid);
    d.warp.flattening = d.weft.flattening = 1200.0;
    w = woven_new(&d, &settings, 1);
    for (i = 1; i <= 8; i++) {
        force = pull(&w, 1, 0.01 * i, &stats);
        cell_solve(&d, force * d.spacing[0], cell_strain);
        CHECK_NEAR(strain_of(&w, 1) / cell_strain[0], 1.0, 0.03);
        CHECK_NEAR(strain_of(&w, 0) / cell_strain[1], 1.0, 0.05);
        CHECK(stats.newton <= 12);
    }
    CHECK(stats.dofs == 3 * (w.yarns.node_count - 16) + 2 * 160); /* two z for each crossing */
    CHECK_RESULT(yc_scene_energy(w.scene, terms), YC_OK);
    CHECK(terms[YC_TERM_FLATTENING] > 0.0);
    cell_solve(&d, 490.0 * d.spacing[0], cell_strain);
    CHECK(cell_strain[0] > 1.4 * rigid[0]);
    woven_free(&w);
    d.weft.flattening = 0.0; /* in series with a rigid one: as soft as one alone */
    w = woven_new(&d, &settings, 1);
    force = pull(&w, 1, 0.03, &stats);
    d.warp.flattening *= 2.0; /* the cell takes half */
    cell_solve(&d, force * d.spacing[0], cell_strain);
    CHECK_NEAR(strain_of(&w, 1) / cell_strain[0], 1.0, 0.03);
    woven_free(&w);
}

/* Peirce's (1937) geometry of a plain weave of round yarns that cannot stretch: arcs of the sum of diameters D and
 * straight pieces between them, l their length, p the spacing, h from crest to trough. Returns h and p at an angle. */
static double peirce(double l, double sum, double theta, double *p) {
    *p = (l - sum * theta) * cos(theta) + sum * sin(theta);
    return (l - sum * theta) * sin(theta) + sum * (1.0 - cos(theta));
}

/* The angle at which p (which falls with it) or h (which grows) has a value. */
static double peirce_angle(double l, double sum, double value, int of_height) {
    double low = 0.0, high = l / sum, p, h;
    int i;
    for (i = 0; i < 100; i++) {
        double theta = 0.5 * (low + high);
        h = peirce(l, sum, theta, &p);
        if (of_height ? h < value : p > value) low = theta;
        else high = theta;
    }
    return low;
}

/* Both contractions of nearly inextensible yarns under tension in one family, against that geometry. */
TEST(scene_crimp_interchange) {
    int axis, i;
    for (axis = 0; axis < 2; axis++) {
        int along = axis ? YC_WARP : YC_WEFT, across = !along;
        yc_weave_desc d = shirting(axis ? 8 : 20, axis ? 20 : 8);
        yc_scene_desc settings = quasistatic();
        double l[2], low = 0.0, high, sum = 0.0, h[2], p;
        woven w;
        d.warp.stretch = d.weft.stretch = 5e3;
        for (i = 0; i < 2; i++) l[i] = d.spacing[!i] * (1.0 + d.crimp[i]);
        for (high = fmin(l[0], l[1]), i = 0; i < 100; i++) { /* D, the sum of both heights */
            int f;
            sum = 0.5 * (low + high);
            for (f = 0; f < 2; f++) h[f] = peirce(l[f], sum, peirce_angle(l[f], sum, d.spacing[!f], 0), &p);
            if (h[0] + h[1] > sum) low = sum;
            else high = sum;
        }
        w = woven_new(&d, &settings, 1);
        for (i = 1; i <= 4; i++) {
            yc_stats stats;
            double stretched, width, force = pull(&w, axis, 0.008 * i, &stats);
            if (!CHECK(force > 0.0)) break;
            stretched = d.spacing[!along] * (1.0 + strain_of(&w, axis));
            h[along] = peirce(l[along], sum, peirce_angle(l[along], sum, stretched, 0), &p);
            peirce(l[across], sum, peirce_angle(l[across], sum, sum - h[along], 1), &width);
            /* The model's square root is Peirce's geometry for small crimp: 5 % off at a contraction of 5 %. */
            CHECK_NEAR(strain_of(&w, !axis) / (width / d.spacing[!across] - 1.0), 1.0, 0.08);
            CHECK(strain_of(&w, !axis) < -0.008 * i);
        }
        woven_free(&w);
    }
}

/* ---- friction of turning -------------------------------------------------------------------------------------- */

/* Turns the wefts of a swatch that is held by their ends, without stretching them; the moment, N m, on all. */
static double trellis(woven *w, double angle) {
    double moment = 0.0, width = w->weave.size[0];
    int i;
    for (i = 0; i < w->yarns.node_count; i++) {
        double to[3], u = w->yarns.layout[i][0];
        if (u > 1e-9 && u < width - 1e-9) continue;
        memcpy(to, w->yarns.layout[i], sizeof to);
        to[0] = u * cos(angle), to[1] += u * sin(angle);
        CHECK_RESULT(yc_scene_pin(w->scene, 0, YC_NODE, i, to), YC_OK);
    }
    CHECK_RESULT(yc_scene_step(w->scene, 1e3, NULL), YC_OK);
    for (i = 0; i < w->yarns.node_count; i++) {
        double f[3];
        if (w->yarns.layout[i][0] < width - 1e-9) continue;
        CHECK_RESULT(yc_scene_pin_force(w->scene, 0, YC_NODE, i, f), YC_OK);
        moment += width * (f[1] * cos(angle) - f[0] * sin(angle));
    }
    return moment;
}

/* A loop of shear to 8 degrees after a first quarter: the gap between both ways at 0, and the work of the loop. */
static void shear_loop(const yc_weave_desc *weave, double *gap, double *work) {
    static const double eight = 8.0 * 3.14159265358979323846 / 180.0;
    yc_scene_desc settings = quasistatic();
    woven w = woven_new(weave, &settings, 1);
    double last = 0.0, crossed[2] = {0.0, 0.0};
    int i, n = 8;
    *work = 0.0;
    for (i = 1; i <= 5 * n; i++) { /* 0, 8, 0, -8, 0, 8 degrees */
        int phase = i / n, turn = i % n, way = phase == 1 || phase == 2 ? -1 : 1;
        double from = phase == 0 || phase == 4 ? 0 : phase == 1 ? n : phase == 2 ? 0 : -n;
        double moment = trellis(&w, phase == 5 ? eight : eight * (from + way * turn) / n);
        if (i > n) *work += 0.5 * (moment + last) * eight / n * (i <= 3 * n ? -1.0 : 1.0);
        if (i == 2 * n || i == 4 * n) crossed[i == 4 * n] = moment;
        last = moment;
    }
    *gap = crossed[1] - crossed[0];
    woven_free(&w);
}

TEST(scene_crimp_shear_hysteresis) {
    yc_weave_desc d = shirting(5, 6);
    double gap, work, area = d.size[0] * d.size[1], eight = 8.0 * 3.14159265358979323846 / 180.0;
    double crossings = 30.0, moment = 0.25 * 0.02 * 2.0 / 3.0 * 72e-6 * crossings; /* mu lambda (2/3) rho of each */
    double slack = moment / (3000.0 * 72e-6 * 72e-6 * crossings);                  /* before a spring slips, rad */
    int crimped, i;
    for (crimped = 0; crimped < 2; crimped++) {
        d = shirting(5, 6);
        if (!crimped) d.crimp[0] = d.crimp[1] = 0.0;
        d.warp.shear = d.weft.shear = 4e-4;
        shear_loop(&d, &gap, &work);
        CHECK_NEAR(gap / area, 0.0, 1e-4);
        CHECK_NEAR(work / area, 0.0, 1e-4);
    }
    d.warp.friction = d.weft.friction = 0.25, d.warp.preload = 0.01, d.weft.preload = 0.03;
    d.warp.slide = d.weft.slide = 3000.0;
    for (i = 0; i < 2; i++) {
        shear_loop(&d, &gap, &work);
        CHECK_NEAR(gap / (2.0 * moment), 1.0, 0.01); /* 2HG */
        CHECK_NEAR(work / (4.0 * moment * (eight - slack)), 1.0, 0.04);
        d.warp.shear = d.weft.shear = 0.0; /* friction carries a moment on its own too */
    }
    /* Without crimp, bending over the crossings presses too (YARN 4.3). */
    d.crimp[0] = d.crimp[1] = 0.0, d.warp.shear = d.weft.shear = 4e-3;
    shear_loop(&d, &gap, &work);
    CHECK(gap > 2.0 * moment);
}

/* ---- the scene's promises ------------------------------------------------------------------------------------- */

/* Full yarns in the middle of a mesh, hybrid ones around, under gravity, hung by two corners. */
static yc_scene *mixed_new(const yc_host *host, scene_swatch *s, yc_solver solver) {
    yc_scene_desc settings = yc_scene_desc_default();
    yc_scene *scene = NULL;
    settings.solver = solver, settings.tolerance = 1e-6;
    if (yc_scene_create(host, &settings, &scene, NULL) != YC_OK) return NULL;
    if (yc_scene_add_cloth(scene, &s->cloth, NULL) == YC_OK &&
        yc_scene_pin(scene, 0, YC_VERTEX, scene_swatch_nearest(s, 0.0, s->desc.size[1]), NULL) == YC_OK &&
        yc_scene_pin(scene, 0, YC_VERTEX, scene_swatch_nearest(s, s->desc.size[0], s->desc.size[1]), NULL) == YC_OK)
        return scene;
    yc_scene_destroy(scene);
    return NULL;
}

static scene_swatch *mixed_swatch(void) {
    scene_swatch_desc d = scene_swatch_desc_default(SCENE_MIXED);
    scene_swatch *s;
    d.cells[0] = d.cells[1] = 4, d.size[0] = d.size[1] = 0.012, d.spacing = 1e-3, d.region = 0.3;
    d.yarn.preload = 0.01, d.yarn.flattening = 800.0;
    s = scene_swatch_new(&d);
    yc_yarns_destroy(&s->yarns);
    s->weave.crimp[0] = 0.06, s->weave.crimp[1] = 0.03;
    CHECK_RESULT(yc_weave(NULL, &s->weave, &s->cloth.mesh, &s->yarns, NULL), YC_OK);
    return s;
}

static char *state_of(yc_scene *scene, size_t *size) {
    char *bytes;
    CHECK_RESULT(yc_scene_save(scene, NULL, size), YC_OK);
    bytes = (char *)malloc(*size);
    CHECK_RESULT(yc_scene_save(scene, bytes, size), YC_OK);
    return bytes;
}

TEST(scene_crimp_same_bits) {
    scene_swatch *s = mixed_swatch();
    char *end[4];
    size_t size[4], middle_size;
    int i, step;
    for (i = 0; i < 4; i++) { /* one worker, backwards, three, and out of a saved state half-way */
        yc_host host = test_host_threads(i == 3 ? 1 : i == 0 ? 1 : i == 1 ? 0 : 3);
        yc_scene *scene = mixed_new(&host, s, YC_SOLVER_AUTO);
        yc_stats stats;
        for (step = 0; step < 6; step++) {
            if (step == 3) {
                char *middle = state_of(scene, &middle_size);
                if (i == 3) {
                    yc_scene_destroy(scene);
                    scene = mixed_new(&host, s, YC_SOLVER_AUTO);
                    CHECK_RESULT(yc_scene_load(scene, middle, middle_size), YC_OK);
                }
                free(middle);
            }
            CHECK_RESULT(yc_scene_step(scene, 4e-3, &stats), YC_OK);
        }
        CHECK(stats.full_nodes > 0 && stats.hybrid_nodes > 0 && stats.dofs > 3 * stats.full_nodes);
        end[i] = state_of(scene, size + i);
        yc_scene_destroy(scene);
        CHECK(size[i] == size[0] && memcmp(end[i], end[0], size[0]) == 0);
    }
    for (i = 0; i < 4; i++) free(end[i]);
    scene_swatch_free(s);
}

TEST(scene_crimp_every_failing_allocation) {
    scene_swatch *s = mixed_swatch();
    int n, done = 0;
    for (n = 0; !done && n < 2000; n++) {
        yc_host host = test_host_failing(n);
        yc_yarns y;
        yc_scene *scene = NULL;
        memset(&y, 0, sizeof y);
        if (yc_weave(&host, &s->weave, &s->cloth.mesh, &y, NULL) == YC_OK) scene = mixed_new(&host, s, YC_SOLVER_AUTO);
        if (scene) {
            yc_result result = yc_scene_step(scene, 1e-3, NULL);
            CHECK(result == YC_OK || result == YC_ERROR_MEMORY);
            done = result == YC_OK;
        }
        yc_scene_destroy(scene), yc_yarns_destroy(&y);
        CHECK(test_heap.live == 0);
    }
    CHECK(done && n > 50);
    scene_swatch_free(s);
}
