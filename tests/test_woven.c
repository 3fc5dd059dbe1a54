/* Yarns against mechanics: modulus, elastica, buckling, the swing of a hanging yarn, a bead on a wire, a yarn around
 * posts. Each against the analytic value and against the law of the discrete model, which tells the order. */
#include "scenes/yarns.h"
#include "test_scene.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static void pin(yc_scene *scene, int node) { CHECK_RESULT(scene_pin(scene, node), YC_OK); }

static void move(yc_scene *scene, int node, double x, double y, double z) {
    CHECK_RESULT(scene_move(scene, node, x, y, z), YC_OK);
}

static int advance(yc_scene *scene, double dt, int steps) { return CHECK_RESULT(scene_steps(scene, dt, steps), YC_OK); }

/* The force of a pin, and where the nodes of a small network are. */
static void pull_at(yc_scene *scene, int node, double force[3]) {
    memset(force, 0, 3 * sizeof(double));
    CHECK_RESULT(yc_scene_pin_force(scene, 0, YC_NODE, node, force), YC_OK);
}
static double size_of(const double a[3]) { return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]); }

#define MOST_NODES 64
static void place_of(yc_scene *scene, int node, double x[3]) {
    double all[MOST_NODES][3];
    CHECK_RESULT(yc_scene_positions(scene, 0, YC_NODE, all), YC_OK);
    memcpy(x, all[node], sizeof all[node]);
}
static double speed_of(yc_scene *scene, int node) {
    double all[MOST_NODES][3];
    CHECK_RESULT(yc_scene_velocities(scene, 0, YC_NODE, all), YC_OK);
    return all[node][0];
}

/* ---- stretch -------------------------------------------------------------------------------------------------- */

static double stretched_force(double stretch, int pieces, double strain) {
    yc_yarn_material material = yc_yarn_material_default();
    double from[3] = {0.0, 0.0, 0.0}, to[3] = {0.1, 0.0, 0.0}, force[2][3] = {{0.0}};
    scene_chain *chain;
    yc_scene_desc settings = scene_statics(0.0);
    yc_scene *scene;
    material.stretch = stretch;
    chain = scene_chain_new(pieces, 0.1, from, to, &material);
    scene = test_scene_of(&settings, &chain->cloth);
    if (scene) {
        pin(scene, 0), move(scene, pieces, 0.1 * (1.0 + strain), 0.0, 0.0);
        if (advance(scene, 1e4, 1)) pull_at(scene, 0, force[0]), pull_at(scene, pieces, force[1]);
        CHECK_NEAR(force[0][0], -force[1][0], 1e-9 * stretch);
    }
    yc_scene_destroy(scene);
    scene_chain_free(chain);
    return force[1][0];
}

/* EA times the strain, exactly, whatever the number of pieces. */
TEST(woven_stretch_modulus) {
    int pieces;
    for (pieces = 1; pieces < 8; pieces += 3) {
        CHECK_NEAR(stretched_force(50.0, pieces, 0.02), 50.0 * 0.02, 1e-8);
        CHECK_NEAR(stretched_force(3.7, pieces, 0.3), 3.7 * 0.3, 1e-8);
    }
}

/* ---- elastica ------------------------------------------------------------------------------------------------- */

/* How far the tip is off in x and y, as a share of the length, where the load has drawn it down by 0.7 of it. */
static void tip_error(int pieces, double error[2]) {
    double length = 0.1, shape[401][3], force[3], x[3];
    const double *tip = shape[400];
    yc_yarn_material rod = yc_yarn_material_default();
    yc_scene_desc settings = scene_statics(0.0);
    scene_net *net;
    yc_scene *scene;
    int i;
    rod.stretch = 1e4, rod.bending = 1e-5;
    net = scene_tip_load(pieces, length, &rod, 1e-2);
    scene = test_scene_of(&settings, &net->cloth);
    error[0] = error[1] = HUGE_VAL;
    if (scene) {
        pin(scene, 0), pin(scene, 1);
        for (i = 1; i <= 4; i++) {
            move(scene, pieces + 1, length, -100.0 - 12.5 * i, 0.0);
            if (!advance(scene, 1e4, 1)) break;
        }
        advance(scene, 1e4, 1);
        pull_at(scene, pieces + 1, force), place_of(scene, pieces, x);
        scene_elastica_shape(length, rod.bending, force, 400, shape);
        CHECK(tip[1] < -0.7 * length && tip[1] > -0.72 * length);
        error[0] = (x[0] - tip[0]) / length, error[1] = (x[1] - tip[1]) / length;
    }
    yc_scene_destroy(scene);
    scene_net_free(net);
}

/* Second order: 5.0e-3, 1.2e-3 and 2.8e-4 of the length for 8, 16 and 32 pieces. */
TEST(woven_elastica) {
    double error[3][2];
    int i;
    for (i = 0; i < 3; i++) tip_error(8 << i, error[i]);
    CHECK_NEAR(error[2][1], 0.0, 4e-4);
    CHECK_NEAR(error[2][0], 0.0, 1e-4);
    CHECK_NEAR(error[0][1] / error[1][1], 4.0, 0.6);
    CHECK_NEAR(error[1][1] / error[2][1], 4.0, 0.4);
}

/* ---- buckling ------------------------------------------------------------------------------------------------- */

/* A rod between two pins without moment, brought together by 1 % and 2 % of its length: the force at 0 by a straight
 * line through both. */
static double buckling_force(int pieces, double length, double bending) {
    static const double shorten[2] = {1e-2, 2e-2};
    double force[2][3] = {{0.0}};
    yc_yarn_material rod = yc_yarn_material_default();
    yc_scene_desc settings = scene_statics(0.0);
    scene_chain *chain;
    yc_scene *scene;
    int i;
    rod.stretch = 1e4, rod.bending = bending;
    chain = scene_buckled(pieces, length, shorten[0], &rod);
    scene = test_scene_of(&settings, &chain->cloth);
    if (scene) {
        pin(scene, 0);
        for (i = 0; i < 2; i++) {
            move(scene, pieces, length * (1.0 - shorten[i]), 0.0, 0.0);
            if (!advance(scene, 1e4, 2)) break;
            pull_at(scene, pieces, force[i]);
        }
    }
    yc_scene_destroy(scene);
    scene_chain_free(chain);
    return -(2.0 * force[0][0] - force[1][0]);
}

/* Euler's load pi^2 EI / L^2. A chain of n hinges has sin^2(pi / 2n) for (pi / 2n)^2 in it: second order, 1.3 %, 0.32 %
 * and 0.08 % below for 8, 16 and 32 pieces. */
TEST(woven_euler_load) {
    double length = 0.1, bending = 1e-5, exact = pi * pi * bending / (length * length), error[3];
    int i;
    for (i = 0; i < 3; i++) {
        double half = 0.5 * pi / (8 << i), law = sin(half) * sin(half) / (half * half);
        double found = buckling_force(8 << i, length, bending) / exact;
        CHECK_NEAR(found, law, 1e-4);
        error[i] = found - 1.0;
    }
    CHECK_NEAR(error[2], 0.0, 1e-3);
    CHECK_NEAR(error[0] / error[1], 4.0, 0.2);
    CHECK_NEAR(error[1] / error[2], 4.0, 0.4);
}

/* ---- a hanging yarn swings ------------------------------------------------------------------------------------ */

/* By how much a yarn without bending, hung up at one end, swings a step, rad, from three passages of its lower end
 * through the vertical. */
static double swing_turn(int pieces, double length, double h) {
    yc_yarn_material material = yc_yarn_material_default();
    double x[3], crossing[3] = {0.0}, before = 1.0;
    yc_scene_desc settings = yc_scene_desc_preset(YC_REFERENCE);
    scene_chain *chain;
    yc_scene *scene;
    int step, found = 0;
    material.stretch = 1e4, material.density = 1e-4, material.bending = 0.0;
    chain = scene_pendulum(pieces, length, 0.01, &material);
    settings.tolerance = 1e-11, settings.dt_max = 1.0;
    scene = test_scene_of(&settings, &chain->cloth);
    if (scene) {
        pin(scene, 0);
        for (step = 1; found < 3 && step < 4000 && advance(scene, h, 1); step++) {
            place_of(scene, pieces, x);
            if (before * x[0] <= 0.0) crossing[found++] = step - x[0] / (x[0] - before);
            before = x[0];
        }
    }
    yc_scene_destroy(scene);
    scene_chain_free(chain);
    return CHECK(found == 3) ? 2.0 * pi / (crossing[2] - crossing[0]) : 0.0;
}

/* Its frequency: backward Euler turns by atan(w h) a step, which is taken out. */
static double swing_frequency(int pieces, double length, double h) { return tan(swing_turn(pieces, length, h)) / h; }

/* Second order: 0.4 %, 0.1 % and 0.02 % low for 8, 16 and 32 pieces. */
TEST(woven_hanging_swing) {
    double exact = scene_pendulum_frequency(9.81, 0.2), error[3];
    int i;
    for (i = 0; i < 3; i++) error[i] = swing_frequency(8 << i, 0.2, 2e-3) / exact - 1.0;
    CHECK_NEAR(error[2], 0.0, 5e-4);
    CHECK_NEAR(error[0] / error[1], 4.0, 0.3);
    CHECK_NEAR(error[1] / error[2], 4.0, 0.3);
}

/* ---- lumped or consistent mass -------------------------------------------------------------------------------- */

enum { MOST_PIECES = 32 };

/* The frequency of a chain of equal pieces, of length and mass 1 in all, from its shape x[0 .. pieces] by Rayleigh's
 * quotient. `consistent`: a piece's mass has a third at each node and a sixth between both; lumped, a half at each. */
static double chain_frequency(int pieces, const double *tension, const double *x, int consistent) {
    double stiffness = 0.0, mass = 0.0, l = 1.0 / pieces;
    int i;
    for (i = 0; i < pieces; i++) {
        double a = x[i], b = x[i + 1];
        stiffness += tension[i] / l * (b - a) * (b - a);
        mass += consistent ? l / 3.0 * (a * a + a * b + b * b) : 0.5 * l * (a * a + b * b);
    }
    return sqrt(stiffness / mass);
}

/* A wave of n pieces along a tight chain of wave speed 1: sines are modes of both matrices. Over 2 pi / wavelength. */
static double wave_error(int n, int consistent) {
    double tension[MOST_PIECES], x[MOST_PIECES + 1];
    int i;
    for (i = 0; i <= n; i++) x[i] = sin(2.0 * pi * i / n);
    for (i = 0; i < n; i++) tension[i] = 1.0;
    return chain_frequency(n, tension, x, consistent) / (2.0 * pi) - 1.0;
}

/* The lowest mode of a hung chain, whose load is lumped: inverse iteration, where what is below a piece is its load. */
static double hung_error(int n, int consistent) {
    double tension[MOST_PIECES], x[MOST_PIECES + 1], load[MOST_PIECES + 2], l = 1.0 / n;
    int pass, i;
    for (i = 0; i <= n; i++) x[i] = i * l;
    for (i = 0; i < n; i++) tension[i] = (n - i - 0.5) * l;
    for (pass = 0; pass < 60; pass++) {
        memset(load, 0, sizeof load);
        for (i = 0; i < n; i++) {
            load[i] += consistent ? l / 6.0 * (2.0 * x[i] + x[i + 1]) : 0.5 * l * x[i];
            load[i + 1] += consistent ? l / 6.0 * (x[i] + 2.0 * x[i + 1]) : 0.5 * l * x[i + 1];
        }
        for (i = n; i > 1; i--) load[i - 1] += load[i];
        for (i = 0; i < n; i++) x[i + 1] = x[i] + load[i + 1] * l / tension[i];
        for (i = 0; i <= n; i++) x[i] /= x[n];
    }
    return chain_frequency(n, tension, x, consistent) / (0.5 * 2.4048255577) - 1.0;
}

/* Waves of n pieces come out low with lumped mass, and high by as much with consistent mass, by (pi / n)^2 / 6: 1.6 %
 * at 10. Backward Euler, w h -> atan(w h), takes that much at 28 steps a period and more at fewer. At a free end
 * consistent mass is ten times better: the lowest frequency of a hung chain of 2, 4, 8 pieces is 6.4 %, 1.8 %, 0.46 %
 * low with lumped mass, 0.64 %, 0.18 %, 0.05 % high with the other. The library's chain swings as the lumped one, to
 * within what is left of its other modes. */
TEST(woven_mass_lumped_or_consistent) {
    static const double low[3] = {0.0635, 0.0180, 0.0046}, high[3] = {0.0064, 0.0018, 0.0005};
    double exact = scene_pendulum_frequency(9.81, 0.2);
    int n, k;
    for (n = 5; n <= 20; n *= 2) {
        double law = pi * pi / (6.0 * n * n);
        CHECK_NEAR(wave_error(n, 0), -law, 0.03 * law);
        CHECK_NEAR(wave_error(n, 1), law, 0.03 * law);
    }
    for (n = 14; n <= 56; n *= 2) { /* steps a period */
        double turn = 2.0 * pi / n, taken = 1.0 - swing_turn(32, 0.2, turn / exact) / turn;
        CHECK_NEAR(taken, 1.0 - atan(turn) / turn, 1e-3);
        CHECK((taken > 0.016) == (n <= 28));
    }
    for (k = 0; k < 3; k++) {
        CHECK_NEAR(hung_error(2 << k, 0), -low[k], 1e-4);
        CHECK_NEAR(hung_error(2 << k, 1), high[k], 1e-4);
        CHECK_NEAR(hung_error(2 << k, 0), swing_frequency(2 << k, 0.2, 2e-3) / exact - 1.0, 2e-3);
    }
}

/* ---- a bead on a wire ----------------------------------------------------------------------------------------- */

/* Settles the bead, tilts gravity, and lets it go for 20 ms, in which what the tilt has set off dies out, and for
 * `time` more. Returns how far it came in all and its mean acceleration at last. */
static double bead_run(const scene_bead_desc *d, double slope, double time, double *acceleration) {
    yc_scene_desc settings = scene_bead_settings();
    scene_net *net = scene_bead(d);
    yc_scene *scene;
    double h = 1e-3, v, x[3] = {0.0}, moved = 0.0;
    scene = test_scene_of(&settings, &net->cloth);
    *acceleration = HUGE_VAL;
    if (scene) {
        CHECK_RESULT(scene_bead_tilt(scene, slope), YC_OK);
        place_of(scene, 2, x), moved = -x[0];
        advance(scene, h, 20), v = speed_of(scene, 2);
        advance(scene, h, (int)floor(time / h + 0.5)), *acceleration = (speed_of(scene, 2) - v) / time;
        place_of(scene, 2, x), moved += x[0];
    }
    yc_scene_destroy(scene);
    scene_net_free(net);
    return moved;
}

/* The wire carries all of the bead's weight W at the crossing, the bar hands down W less what its own node there
 * weighs, a share of 1/(2 pieces); compression is the mean of both. So friction is that of mu (1 - 1/(4 pieces)): a
 * first-order error. */
TEST(woven_bead_on_a_wire) {
    double slope = 0.7, error[3], found;
    int i;
    for (i = 0; i < 3; i++) {
        scene_bead_desc d = scene_bead_desc_default();
        double law, exact = 9.81 * (sin(slope) - d.friction * cos(slope));
        d.pieces = 4 << i;
        law = d.friction * (1.0 - 0.25 / d.pieces);
        bead_run(&d, slope, 0.02, &found);
        CHECK_NEAR(found, 9.81 * (sin(slope) - law * cos(slope)), 1e-3 * exact);
        error[i] = found / exact - 1.0;
    }
    CHECK_NEAR(error[2], 0.0, 0.01);
    CHECK_NEAR(error[0] / error[1], 2.0, 0.1);
    CHECK_NEAR(error[1] / error[2], 2.0, 0.1);
}

TEST(woven_bead_sticks) {
    scene_bead_desc d = scene_bead_desc_default();
    double law = d.friction * (1.0 - 0.25 / d.pieces), found, angle = atan(1.01 * law);
    CHECK_NEAR(bead_run(&d, atan(0.99 * law), 0.05, &found), 0.0, 1e-9);
    CHECK_NEAR(found, 0.0, 1e-9);
    CHECK(bead_run(&d, angle, 0.05, &found) > 2e-5);
    CHECK_NEAR(found, 9.81 * 0.01 * law * cos(angle), 1e-2 * 9.81 * 0.01 * law);
}

/* ---- a yarn around posts -------------------------------------------------------------------------------------- */

/* The ratio of both pulls, drawn over all posts. */
static double capstan_ratio(const scene_capstan_desc *d) {
    scene_net *net = scene_capstan(d);
    yc_scene_desc settings = scene_statics(0.0);
    yc_scene *scene = test_scene_of(&settings, &net->cloth);
    double first[3] = {1.0, 0.0, 0.0}, last[3] = {0.0, 0.0, 0.0};
    int n = d->crossings;
    if (scene) {
        CHECK_RESULT(scene_capstan_draw(scene, net, d), YC_OK);
        pull_at(scene, n + 2, first), pull_at(scene, n + 1, last);
    }
    yc_scene_destroy(scene);
    scene_net_free(net);
    return size_of(last) / size_of(first);
}

/* Where a yarn with pulls T and T' turns by t, compression is (T + T') sin(t/2) and T' - T what friction holds: T'/T =
 * (1 + s) / (1 - s), s = mu sin(t/2). Of n equal turns the power n is Euler's exp(mu n t), to second order in t. */
TEST(woven_capstan) {
    double error[3];
    int i;
    for (i = 0; i < 3; i++) {
        scene_capstan_desc d = scene_capstan_desc_default();
        double s, law, found, exact = exp(d.friction * d.wrap);
        d.crossings = 4 << i;
        s = d.friction * sin(0.5 * d.wrap / d.crossings), law = pow((1.0 + s) / (1.0 - s), d.crossings);
        found = capstan_ratio(&d);
        CHECK_NEAR(found, law, 5e-4 * law);
        error[i] = found / exact - 1.0;
    }
    CHECK_NEAR(error[2], 0.0, 2e-3);
    CHECK_NEAR(error[0] / error[1], 4.0, 0.4);
}
