/* Elements of chapters 6 and 7: every gradient and exact Hessian against sixth-order differences, projected Hessians
 * for definiteness, invariance under rigid motion, degenerate states, and a few closed forms. */

#include "internals.h"
#include "test.h"
#include <math.h>
#include <string.h>

/* ---- tools ------------------------------------------------------------------------------------------------------- */

typedef double (*elements_function)(const double *p, const double *q, double *g, double *h, int projected);

static uint64_t elements_state; /* every test sets it */

static double elements_random(double low, double high) { return test_random(&elements_state, low, high); }

static double elements_largest(const double *a, int n) {
    double top = 0.0;
    for (int i = 0; i < n; i++) {
        if (!(fabs(a[i]) <= top)) top = fabs(a[i]); /* a NaN stays */
    }
    return top;
}

static double elements_distance(const double *a, const double *b, int n) {
    double top = 0.0;
    for (int i = 0; i < n; i++) {
        if (!(fabs(a[i] - b[i]) <= top)) top = fabs(a[i] - b[i]);
    }
    return top;
}

static int elements_finite(const double *a, int n) {
    for (int i = 0; i < n; i++) {
        if (!(fabs(a[i]) < 1e300)) return 0;
    }
    return 1;
}

/* Sixth-order central differences with the given step, relative to the largest entry of the Hessian and to the largest
 * of the gradient (each with a thousandth of the other over or times size, for where it vanishes). */
static int elements_differences(
    elements_function f, const double *p, int n, const double *q, double size, double step, double tolerance) {
    static const double weight[3] = {45.0 / 60.0, -9.0 / 60.0, 1.0 / 60.0};
    double g[12], h[144], g2[12], dg[12], x[12], worst_g = 0.0, worst_h = 0.0, scale_h, scale_g, e, e2;
    e = f(p, q, g, h, 0);
    e2 = f(p, q, g2, NULL, 0);
    if (e != e2 || elements_distance(g, g2, n) != 0.0 || f(p, q, NULL, NULL, 1) != e) return 0;
    scale_h = elements_largest(h, n * n);
    scale_g = elements_largest(g, n) + 1e-3 * scale_h * size;
    scale_h += 1e-3 * elements_largest(g, n) / size;
    for (int i = 0; i < n; i++) {
        double de = 0.0;
        memset(dg, 0, sizeof dg);
        for (int m = 1; m <= 3; m++) {
            for (int sign = -1; sign <= 1; sign += 2) {
                double w = sign * weight[m - 1] / step;
                memcpy(x, q, sizeof(double) * (size_t)n);
                x[i] += sign * m * step;
                de += w * f(p, x, g2, NULL, 0);
                for (int j = 0; j < n; j++) dg[j] += w * g2[j];
            }
        }
        worst_g = yci_max(worst_g, fabs(de - g[i]));
        worst_h = yci_max(worst_h, elements_distance(dg, h + n * i, n));
        if (de != de) return 0;
    }
    if (worst_g <= tolerance * scale_g && worst_h <= tolerance * scale_h) return 1;
    return 0;
}

static int elements_semidefinite(const double *h, int n) {
    double top, low = test_lowest_eigenvalue(h, n, &top);
    if (!elements_finite(h, n * n)) return 0;
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < i; j++) {
            if (fabs(h[n * i + j] - h[n * j + i]) > 1e-14 * top) return 0;
        }
    }
    for (int trial = 0; trial < 5; trial++) {
        double x[12], form = 0.0, norm = 0.0;
        for (int i = 0; i < n; i++) x[i] = elements_random(-1.0, 1.0), norm += x[i] * x[i];
        for (int i = 0; i < n; i++) {
            for (int j = 0; j < n; j++) form += x[i] * h[n * i + j] * x[j];
        }
        if (form < -1e-13 * top * norm) return 0;
    }
    return low >= -1e-13 * top;
}

static void elements_rotation(double *m) {
    double a[4], s = 0.0;
    for (int i = 0; i < 4; i++) a[i] = elements_random(-1.0, 1.0), s += a[i] * a[i];
    s = 2.0 / s;
    m[0] = 1.0 - s * (a[2] * a[2] + a[3] * a[3]), m[1] = s * (a[1] * a[2] - a[0] * a[3]);
    m[2] = s * (a[1] * a[3] + a[0] * a[2]), m[3] = s * (a[1] * a[2] + a[0] * a[3]);
    m[4] = 1.0 - s * (a[1] * a[1] + a[3] * a[3]), m[5] = s * (a[2] * a[3] - a[0] * a[1]);
    m[6] = s * (a[1] * a[3] - a[0] * a[2]), m[7] = s * (a[2] * a[3] + a[0] * a[1]);
    m[8] = 1.0 - s * (a[1] * a[1] + a[2] * a[2]);
}

/* Rotates the points of q about the origin, by a random rotation, and shifts them by up to `shift`. */
static void elements_move(double *q, int points, double shift) {
    double m[9], d[3];
    elements_rotation(m);
    for (int i = 0; i < 3; i++) d[i] = elements_random(-shift, shift);
    for (int p = 0; p < points; p++) {
        double x[3];
        for (int i = 0; i < 3; i++) x[i] = d[i] + yci_dot(m + 3 * i, q + 3 * p);
        yci_copy(q + 3 * p, x);
    }
}

static void elements_scatter(double *q, int n, double size) { test_random_array(&elements_state, -size, size, q, n); }

/* Energy unchanged by a rigid motion; no net force and no net torque. */
static int elements_invariant(elements_function f, const double *p, int n, int points, const double *q, double size) {
    double g[12], h[144], moved[12], force[3] = {0.0, 0.0, 0.0}, torque[3] = {0.0, 0.0, 0.0}, e, scale, rounded;
    e = f(p, q, g, h, 0);
    scale = elements_largest(g, 3 * points);
    rounded = 1e-28 * elements_largest(h, n * n) * size * size; /* where energy and gradient vanish */
    for (int i = 0; i < points; i++) {
        double t[3];
        yci_add(force, force, g + 3 * i);
        yci_cross(t, q + 3 * i, g + 3 * i);
        yci_add(torque, torque, t);
    }
    memcpy(moved, q, sizeof(double) * (size_t)n);
    elements_move(moved, points, size);
    return fabs(f(p, moved, NULL, NULL, 0) - e) <= 1e-12 * (fabs(e) + scale * size) + rounded &&
        yci_norm(force) <= 1e-13 * scale && yci_norm(torque) <= 1e-12 * scale * size;
}

/* p[0..] in each wrapper: the element's parameters in order. */
static double elements_stretch(const double *p, const double *q, double *g, double *h, int projected) {
    return yci_yarn_stretch(q, p[0], p[1], p[2], NULL, g, h, projected);
}
static double elements_gravity(const double *p, const double *q, double *g, double *h, int projected) {
    return yci_yarn_gravity(q, p[0], p + 1, g, h, projected);
}
static double elements_bend(const double *p, const double *q, double *g, double *h, int projected) {
    return yci_yarn_bend(q, p[0], p[1], p[2], p[3], p[4], g, h, projected);
}
static double elements_shear(const double *p, const double *q, double *g, double *h, int projected) {
    return yci_yarn_shear(q, p[0], p[1], p[2], p[3], p[4], p[5], p[6], NULL, g, h, projected);
}
static double elements_crimp(const double *p, const double *q, double *g, double *h, int projected) {
    return yci_yarn_crimp(q, p[0], p[1], p[2], NULL, g, h, projected);
}
static double elements_flatten(const double *p, const double *q, double *g, double *h, int projected) {
    (void)projected; /* it is convex */
    return yci_yarn_flatten(q, p[0], p[1], p[2], p[3], p[4], g, h);
}
static double elements_kink(const double *p, const double *q, double *g, double *h, int projected) {
    return yci_yarn_kink(q, p[0], p[1], p[2], p[3], g, h, projected);
}
static double elements_turn(const double *p, const double *q, double *g, double *h, int projected) {
    yci_yarn_turn turn;
    turn.anchor = p[1], turn.k = p[2], turn.limit = p[3];
    return yci_yarn_shear(q, 0.0, 1.0, p[0], 9.0, 0.0, 0.0, 0.0, &turn, g, h, projected);
}
static double elements_contact(const double *p, const double *q, double *g, double *h, int projected) {
    (void)projected;
    return yci_yarn_contact(q, p[0], p[1], g, h);
}
static double elements_floor(const double *p, const double *q, double *g, double *h, int projected) {
    (void)projected;
    return yci_yarn_floor(q, p[0], p[1], g, h);
}
static double elements_length(const double *p, const double *q, double *g, double *h, int projected) {
    (void)projected;
    return yci_yarn_length(q, p[0], p[1], g, h);
}
static double elements_wrap(const double *p, const double *q, double *g, double *h, int projected) {
    return yci_yarn_wrap(q, p[0], p[1], g, h, projected);
}
static double elements_friction(const double *p, const double *q, double *g, double *h, int projected) {
    return yci_yarn_friction(q[0], p[0], p[1], p[2], g, h, projected);
}
/* uv[6], grain, pre-stretch, material[4], r, e_prev[3] */
static double elements_membrane(const double *p, const double *q, double *g, double *h, int projected) {
    yci_membrane rest;
    yci_triangle_rest(&rest, p, p[6], p[7]);
    return yci_triangle_membrane(q, &rest, p + 8, p[12], p[12] > 0.0 ? p + 13 : NULL, NULL, g, h, projected);
}
static double elements_hinge(const double *p, const double *q, double *g, double *h, int projected) {
    return yci_triangle_hinge(q, p[0], p[1], p[2], p[3], g, h, projected);
}

/* Three points whose edges (x1 - x0, and x2 - x1 or x2 - x0) have the given lengths and angle, in a random pose. */
static void elements_corner(double *q, int from_first, double l1, double l2, double angle) {
    double tip = from_first ? 0.0 : l1;
    yci_zero(q, 9);
    q[3] = l1, q[6] = tip + l2 * cos(angle), q[7] = l2 * sin(angle);
    elements_move(q, 3, l1);
}

/* ---- yarn -------------------------------------------------------------------------------------------------------- */

TEST(yarn_stretch) {
    static const double ratio[6] = {1e-3, 0.3, 0.999, 1.0, 1.001, 2.5};
    elements_state = 1;
    for (int trial = 0; trial < 36; trial++) {
        double size = trial % 2 ? 1e-3 : 1.0, lambda = ratio[trial % 6], du, q[8], p[3], h[64], exact[64], g[8];
        p[0] = 10.0, p[1] = trial % 3 ? 0.0 : 0.7, p[2] = 0.2;
        q[0] = q[1] = q[2] = 0.0, q[3] = size, q[4] = q[5] = 0.0;
        elements_move(q, 2, size);
        q[6] = elements_random(-1.0, 1.0) * size, du = size / lambda, q[7] = q[6] + du;
        CHECK(elements_differences(elements_stretch, p, 8, q, size, 1e-3 * size, 1e-9));
        CHECK(elements_invariant(elements_stretch, p, 8, 2, q, size));
        CHECK(fabs(yci_yarn_stretch_strain(q) - (lambda - 1.0)) < 1e-12 * lambda);
        elements_stretch(p, q, g, h, 1), elements_stretch(p, q, NULL, exact, 0);
        CHECK(elements_semidefinite(h, 8));
        if (lambda > 1.1 || (lambda >= 1.001 && p[1] == 0.0)) CHECK(elements_distance(h, exact, 64) == 0.0);
        /* What projected drops is negative: it bounds the exact one from above. */
        for (int i = 0; i < 64; i++) exact[i] = h[i] - exact[i];
        CHECK(elements_semidefinite(exact, 8));
        /* Twice as much strain from a rest state: the written formulas at one place. */
        if (p[1] == 0.0) CHECK(fabs(g[7] - 0.5 * p[0] * (1.0 - lambda * lambda)) < 1e-10 * lambda * lambda * p[0]);
    }
    for (int trial = 0; trial < 3; trial++) { /* coincident or nearly */
        double q[8] = {0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.0, 1.0}, p[3] = {10.0, 0.5, 0.1}, g[8], h[64];
        q[3] += trial == 0 ? 0.0 : trial == 1 ? 1e-300 : 1e-12;
        CHECK(fabs(elements_stretch(p, q, g, h, 0) - 5.0 * (1.0 + 0.5 * 1.21)) < 1e-9);
        CHECK(elements_largest(g, 8) < 40.0 && elements_finite(h, 64));
        elements_stretch(p, q, g, h, 1);
        CHECK(elements_semidefinite(h, 8) && elements_largest(h, 64) < 40.0);
    }
}

TEST(yarn_gravity) {
    double p[4] = {0.3, 0.1, -9.81, 0.4}, q[8], h[64];
    elements_state = 1;
    elements_scatter(q, 8, 1.0);
    CHECK(elements_differences(elements_gravity, p, 8, q, 1.0, 1e-2, 1e-11));
    elements_gravity(p, q, NULL, h, 1);
    CHECK(elements_largest(h, 64) == 0.0);
}

TEST(yarn_bend) {
    static const double angle[7] = {0.0, 1e-9, 1e-4, 0.5, 1.65, 2.5, 0.999 * YCI_PI};
    elements_state = 1;
    for (int trial = 0; trial < 56; trial++) {
        double size = trial % 2 ? 1e-3 : 1.0, theta = angle[trial % 7], q[11], p[5], h[121], exact[121], wide, step;
        int variant = trial / 7 % 4; /* plain, jamming, damped with rest angle, all */
        p[0] = 2.0 * size, p[1] = 0.0, p[2] = variant & 1 ? 0.2 : 0.0, p[3] = 0.0, p[4] = 0.0;
        if (variant & 2 && theta >= 0.5) p[1] = 0.4, p[3] = 0.6, p[4] = 0.7;
        elements_corner(q, 0, size, size * elements_random(0.5, 1.5), theta);
        q[9] = size * elements_random(-1.0, 0.0), q[10] = size * elements_random(1.0, 2.0);
        step = (theta > 3.0 ? 2e-5 : 1e-3) * size;
        CHECK(fabs(yci_yarn_bend_strain(q) - theta) < 1e-14);
        CHECK(elements_differences(elements_bend, p, 11, q, size, step, 1e-10));
        CHECK(elements_invariant(elements_bend, p, 11, 3, q, size));
        elements_bend(p, q, NULL, h, 1), elements_bend(p, q, NULL, exact, 0);
        CHECK(elements_semidefinite(h, 11));
        /* The rows of u are exact in the projected form; all of it is when straight. */
        wide = elements_largest(exact, 121);
        CHECK(elements_distance(h + 99, exact + 99, 22) <= 1e-15 * wide);
        if (theta < 1e-8) CHECK(elements_distance(h, exact, 121) <= 2e-9 * wide);
    }
}

TEST(yarn_bend_degenerate) {
    double p[5] = {3.0, 0.0, 0.0, 0.0, 0.0}, q[11] = {0}, g[11], h[121], other[11], t[3];
    elements_state = 1;
    /* Straight: 2k/du times the transverse projector on the second difference, whichever normal the rule picks. */
    for (int trial = 0; trial < 8; trial++) {
        static const double d[3] = {1.0, -2.0, 1.0};
        double worst = 0.0;
        elements_scatter(t, 3, 1.0);
        yci_scale(t, t, 1.0 / yci_norm(t));
        yci_zero(q, 11), q[10] = 2.0;
        yci_scale(q + 3, t, 1.0), yci_scale(q + 6, t, 2.0);
        CHECK(fabs(elements_bend(p, q, g, h, trial % 2)) < 1e-28);
        for (int i = 0; i < 9; i++) {
            for (int j = 0; j < 9; j++) {
                double expected = 3.0 * d[i / 3] * d[j / 3] * ((i % 3 == j % 3 ? 1.0 : 0.0) - t[i % 3] * t[j % 3]);
                worst = yci_max(worst, fabs(h[11 * i + j] - expected));
            }
        }
        CHECK(worst < 1e-13);
    }
    /* Folded back exactly: energy k pi^2/du, force 2 k pi/du (1/l1, 1/l2) in a direction that repeats. */
    yci_zero(q, 11), q[3] = 1.0, q[6] = 0.5, q[10] = 2.0;
    CHECK(fabs(elements_bend(p, q, g, h, 0) - 1.5 * YCI_PI * YCI_PI) < 1e-12);
    CHECK(elements_finite(h, 121));
    CHECK(fabs(yci_norm(g) - 3.0 * YCI_PI) < 1e-9 && fabs(yci_norm(g + 6) - 6.0 * YCI_PI) < 1e-9);
    elements_bend(p, q, other, h, 1);
    CHECK(elements_distance(g, other, 11) == 0.0 && elements_semidefinite(h, 11));
    /* Close to folded from any side: bounded by the same. */
    for (int i = 0; i < 20; i++) {
        q[7] = elements_random(-1.0, 1.0) * 1e-14, q[8] = elements_random(-1.0, 1.0) * 1e-7 * (i % 2);
        elements_bend(p, q, g, h, 0);
        CHECK(elements_finite(h, 121) && yci_norm(g) < 3.0 * YCI_PI + 1e-6 && yci_norm(g + 6) < 6.0 * YCI_PI + 1e-6);
    }
    /* Coincident nodes. */
    for (int i = 0; i < 8; i++) {
        yci_zero(q, 11), q[10] = 2.0;
        q[3] = i & 1 ? 1.0 : 0.0, q[6] = i & 2 ? q[3] : 0.5 * q[3], q[7] = i & 4 ? 1e-200 : 0.0;
        p[2] = 0.1, p[3] = 0.5, p[4] = 1.0;
        elements_bend(p, q, g, h, 0);
        CHECK(elements_finite(g, 11) && elements_finite(h, 121));
        elements_bend(p, q, g, h, 1);
        CHECK(elements_semidefinite(h, 11));
    }
}

TEST(yarn_shear) {
    static const double angle[6] = {1e-3, 0.5, 1.45, 1.6, 2.2, 0.999 * YCI_PI};
    elements_state = 1;
    for (int trial = 0; trial < 48; trial++) {
        double size = trial % 2 ? 1e-3 : 1.0, phi = angle[trial % 6], q[9], p[7], h[81], exact[81], step;
        p[0] = 2.0, p[1] = size, p[2] = 1.5, p[3] = 0.3, p[4] = trial / 6 % 2 ? 0.2 : 0.0, p[5] = 0.0, p[6] = 0.0;
        if (trial / 12 % 2) p[5] = 0.6, p[6] = 1.2;
        elements_corner(q, 1, size, size * elements_random(0.5, 1.5), phi);
        step = (phi > 3.0 || phi < 0.1 ? 4e-6 : 1e-3) * size;
        CHECK(fabs(yci_yarn_shear_strain(q) - phi) < 1e-14);
        CHECK(elements_differences(elements_shear, p, 9, q, size, step, phi > 3.0 || phi < 0.1 ? 1e-9 : 1e-10));
        CHECK(elements_invariant(elements_shear, p, 9, 3, q, size));
        elements_shear(p, q, NULL, h, 1);
        CHECK(elements_semidefinite(h, 9));
        p[2] = phi, p[5] = 0.0; /* at rest projected is exact */
        elements_shear(p, q, NULL, h, 1), elements_shear(p, q, NULL, exact, 0);
        CHECK(elements_distance(h, exact, 81) <= 1e-11 * elements_largest(exact, 81));
    }
    for (int i = 0; i < 8; i++) { /* parallel, folded, coincident */
        double q[9] = {0}, p[7] = {2.0, 1.0, 1.5, 0.3, 0.2, 0.5, 1.0}, g[9], h[81];
        q[3] = i & 1 ? 1.0 : 0.0, q[6] = i & 2 ? 0.7 * q[3] : -1.0, q[7] = i & 4 ? 1e-14 : 0.0;
        elements_shear(p, q, g, h, 0);
        CHECK(elements_finite(g, 9) && elements_finite(h, 81));
        elements_shear(p, q, g, h, 1);
        CHECK(elements_semidefinite(h, 9));
    }
}

/* A crimped segment: its points and heights, at a ratio of its length to du. */
static void elements_undulating(double *q, double size, double rise, double ratio) {
    yci_zero(q, 10);
    q[3] = size;
    elements_move(q, 2, size);
    q[6] = elements_random(-1.0, 1.0) * size, q[7] = q[6] + size * sqrt(1.0 + 1.125 * rise * rise) / ratio;
    q[8] = elements_random(-0.5, 0.5) * size, q[9] = q[8] + rise * size;
}

TEST(yarn_crimp) {
    static const double ratio[6] = {1e-3, 0.3, 0.999, 1.0, 1.001, 2.5}, rise[5] = {0.0, 1e-6, 0.3, -0.8, 40.0};
    elements_state = 1;
    for (int trial = 0; trial < 60; trial++) {
        double size = trial % 2 ? 1e-3 : 1.0, lambda = ratio[trial % 6], q[10], p[3], h[100], exact[100], g[10];
        double flat[64], slope[8];
        p[0] = 10.0, p[1] = trial % 4 ? 0.0 : 0.7, p[2] = 0.2;
        elements_undulating(q, size, rise[trial % 5], lambda);
        CHECK(elements_differences(elements_crimp, p, 10, q, size, 1e-3 * size * (1.0 + fabs(rise[trial % 5])), 1e-9));
        CHECK(elements_invariant(elements_crimp, p, 10, 2, q, size));
        CHECK(fabs(yci_yarn_crimp_strain(q) - (lambda - 1.0)) < 1e-12 * lambda);
        elements_crimp(p, q, g, h, 1), elements_crimp(p, q, NULL, exact, 0);
        CHECK(elements_semidefinite(h, 10));
        CHECK(fabs(g[8] + g[9]) <= 1e-15 * fabs(g[9])); /* heights count from anywhere */
        if (lambda > 1.1 || (lambda >= 1.001 && p[1] == 0.0)) CHECK(elements_distance(h, exact, 100) == 0.0);
        for (int i = 0; i < 20; i++) { /* what projected drops is negative */
            double x[10], dropped = 0.0;
            elements_scatter(x, 10, 1.0);
            for (int j = 0; j < 100; j++) dropped += x[j / 10] * (h[j] - exact[j]) * x[j % 10];
            CHECK(dropped >= -1e-13 * elements_largest(h, 100));
        }
        if (rise[trial % 5] != 0.0) continue;
        yci_yarn_stretch(q, p[0], p[1], p[2], NULL, slope, flat, 1); /* without a rise it is the flat segment */
        CHECK(elements_distance(g, slope, 8) <= 1e-14 * elements_largest(slope, 8) && g[8] == 0.0);
        for (int i = 0; i < 8; i++)
            CHECK(elements_distance(h + 10 * i, flat + 8 * i, 8) <= 1e-14 * elements_largest(flat, 64));
    }
    for (int trial = 0; trial < 4; trial++) { /* coincident, or one above the other */
        double q[10] = {0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.0, 1.0, 0.1, 0.1}, p[3] = {10.0, 0.5, 0.1}, g[10], h[100];
        q[9] += trial == 0 ? 0.0 : trial == 1 ? 1e-300 : trial == 2 ? 1e-12 : 0.7;
        elements_crimp(p, q, g, h, 0);
        CHECK(elements_finite(g, 10) && elements_finite(h, 100));
        elements_crimp(p, q, g, h, 1);
        CHECK(elements_semidefinite(h, 10) && elements_largest(h, 100) < 50.0);
    }
}

TEST(yarn_flatten) {
    int trial;
    for (trial = 0; trial < 20; trial++) { /* pressed and drawn apart, far beyond the depth too */
        double p[5], q[2], g[2], h[4], size = 1e-4;
        p[0] = 600.0, p[1] = size, p[2] = 0.2 * size, p[3] = trial % 2 ? 0.7 : 0.0, p[4] = 0.05 * size;
        q[0] = elements_random(-1.0, 1.0) * size, q[1] = q[0] + elements_random(0.0, 2.0) * size;
        CHECK(elements_differences(elements_flatten, p, 2, q, size, 1e-3 * size, 1e-9));
        elements_flatten(p, q, g, h, 1);
        CHECK(h[0] >= p[0] && g[0] == -g[1]);
    }
    {
        /* a fifth of the way: twice the force of the spring alone, four times its stiffness */
        double q[2] = {0.0, 0.8e-4}, g[2], h[4];
        yci_yarn_flatten(q, 600.0, 1e-4, 0.2e-4, 0.0, 0.0, g, h);
        CHECK_NEAR(g[0], 2.0 * 600.0 * 0.2e-4, 1e-12);
        CHECK_NEAR(h[0], 2400.0, 1e-8);
    }
}

TEST(yarn_kink) {
    elements_state = 1;
    for (int trial = 0; trial < 40; trial++) {
        double size = trial % 2 ? 1e-3 : 1.0, q[6], p[4], g[6], h[36], exact[36], moved[6], e, sum = 0.0, turn = 0.0;
        p[0] = 2.0 * size, p[1] = elements_random(-1.0, 1.0), p[2] = trial % 4 ? 0.0 : 0.6, p[3] = 0.3;
        for (int i = 0; i < 3; i++) q[i] = size * elements_random(-2.0, 2.0);
        q[3] = size * elements_random(-1.0, 1.0), q[4] = q[3] + size * elements_random(0.5, 1.5),
        q[5] = q[4] + size * elements_random(0.5, 1.5);
        CHECK(elements_differences(elements_kink, p, 6, q, size, 1e-3 * size, 1e-9));
        e = elements_kink(p, q, g, h, 1);
        CHECK(elements_semidefinite(h, 6));
        /* A yarn that lies higher, or slopes, as a whole is not bent: no net force, no torque. */
        for (int i = 0; i < 3; i++) {
            moved[i] = q[i] + size * (0.7 - 0.4 * (q[3 + i] - q[3]) / size), moved[3 + i] = q[3 + i];
            sum += g[i], turn += g[i] * (q[3 + i] - q[3]);
        }
        CHECK(fabs(elements_kink(p, moved, NULL, NULL, 0) - e) <= 1e-12 * e);
        CHECK(fabs(sum) + fabs(turn) / size <= 1e-12 * elements_largest(g, 3));
        p[1] = yci_yarn_kink_strain(q), p[2] = 0.0; /* at rest projected is exact */
        e = elements_kink(p, q, g, h, 1), elements_kink(p, q, NULL, exact, 0);
        CHECK(e < 1e-28 * p[0] / size && elements_largest(g, 6) < 1e-13 * elements_largest(exact, 36) * size);
        CHECK(elements_distance(h, exact, 36) <= 1e-13 * elements_largest(exact, 36));
    }
}

/* A beam over 40 supports at heights h(i): its energy by the three-moment equation, against the sum of kinks. */
static double elements_beam(double (*height)(int), double *kinks) {
    double t[41] = {0.0}, m[42] = {0.0}, low[42] = {0.0}, energy = 0.0;
    for (int i = 1; i < 40; i++) t[i] = 2.0 * height(i) - height(i - 1) - height(i + 1);
    for (int i = 1; i < 40; i++) { /* M_i-1 + 4 M_i + M_i+1 = 6 t_i, EI and du 1 */
        double pivot = 4.0 - low[i - 1];
        low[i] = 1.0 / pivot, m[i] = (6.0 * t[i] - m[i - 1]) / pivot;
    }
    for (int i = 39; i > 0; i--) m[i] -= low[i] * m[i + 1];
    *kinks = 0.0;
    for (int i = 10; i < 30; i++) { /* away from its ends */
        double q[6] = {0.0, 0.0, 0.0, -1.0, 0.0, 1.0};
        for (int k = 0; k < 3; k++) q[k] = height(i + k - 1);
        energy += 0.5 * m[i] * t[i];
        *kinks += yci_yarn_kink(q, yci_yarn_kink_factor(t[i - 1], t[i], t[i + 1]), 0.0, 0.0, 0.0, NULL, NULL, 0);
    }
    return energy;
}
static double elements_plain(int i) { return i % 2 ? 1.0 : -1.0; }
static double elements_twill(int i) { return i / 2 % 2 ? 1.0 : -1.0; }
static double elements_wave(int i) { return sin(0.1 * YCI_PI * i); }

TEST(yarn_kink_factor) {
    double exact, kinks;
    exact = elements_beam(elements_plain, &kinks), CHECK_NEAR(kinks, exact, 1e-6 * exact);
    exact = elements_beam(elements_twill, &kinks), CHECK_NEAR(kinks, exact, 1e-6 * exact);
    exact = elements_beam(elements_wave, &kinks), CHECK_NEAR(kinks, exact, 0.02 * exact);
    CHECK(yci_yarn_kink_factor(0.0, 1.0, 0.0) == 1.5 && yci_yarn_kink_factor(1.0, 0.0, -1.0) == 1.0);
    CHECK(yci_yarn_kink_factor(-9.0, 1.0, -9.0) == 3.0 && yci_yarn_kink_factor(9.0, 1.0, 9.0) == 1.0);
}

TEST(yarn_turn) {
    static const double angle[4] = {0.3, 1.45, 1.6, 2.8};
    elements_state = 1;
    for (int trial = 0; trial < 48; trial++) {
        double size = trial % 2 ? 1e-3 : 1.0, phi = angle[trial / 2 % 4], q[9], p[4], h[81], g[9], other[9], d = 0.0;
        int slips = trial % 3 == 0;
        /* A spring from phi - 0.1 that slips beyond 0.05, or 0.2, either way. */
        p[0] = 1.5, p[2] = 3.0 * size, p[3] = p[2] * (slips ? 0.05 : 0.2), p[1] = phi - p[0] + (trial % 4 ? 0.1 : -0.1);
        elements_corner(q, 1, size, size * elements_random(0.5, 1.5), phi);
        CHECK(slips || elements_differences(elements_turn, p, 9, q, size, 1e-3 * size, 1e-9)); /* no exact Hessian */
        CHECK(elements_invariant(elements_turn, p, 9, 3, q, size));
        elements_turn(p, q, g, h, 1);
        CHECK(elements_semidefinite(h, 9));
        /* The moment about the crossing is the limit, or k times the angle from the anchor: that of a shear element. */
        yci_yarn_shear(q, 1.0, 1.0, phi - 1.0, 9.0, 0.0, 0.0, 0.0, NULL, other, NULL, 0);
        d = (trial % 4 ? -1.0 : 1.0) * (slips ? p[3] : 0.1 * p[2]);
        for (int i = 0; i < 9; i++) other[i] *= d;
        CHECK(elements_distance(g, other, 9) <= 1e-12 * elements_largest(g, 9));
    }
}

TEST(yarn_contact) {
    static const double length[5] = {0.2, 0.7, 0.95, 1.0, 1.3};
    double p[2] = {5.0, 1.0}, q[2], g[2], h[4];
    elements_state = 1;
    for (int i = 0; i < 5; i++) {
        q[0] = 0.4, q[1] = 0.4 + length[i];
        if (length[i] != 1.0) CHECK(elements_differences(elements_contact, p, 2, q, 1.0, 1e-3, 1e-11));
        elements_contact(p, q, g, h, 1);
        CHECK(elements_semidefinite(h, 2));
        CHECK(length[i] >= 1.0 ? elements_largest(g, 2) < 1e-30 : g[0] > 0.0 && g[1] < 0.0);
    }
}

TEST(yarn_floor) {
    static const double length[8] = {1e-6, 0.01, 0.2, 0.5, 0.9, 0.99, 1.0, 1.3};
    double p[2] = {5.0, 1e-4}, q[2], g[2], h[4], last = HUGE_VAL, steepest = -HUGE_VAL;
    elements_state = 1;
    for (int i = 0; i < 8; i++) {
        double energy;
        q[0] = -0.3 * p[1], q[1] = q[0] + length[i] * p[1];
        if (length[i] != 1.0 && i > 0)
            CHECK(elements_differences(elements_floor, p, 2, q, p[1], 3e-3 * yci_min(length[i], 0.3) * p[1], 1e-8));
        energy = elements_floor(p, q, g, h, 1);
        if (length[i] >= 1.0) {
            CHECK(energy == 0.0 && g[0] == 0.0 && g[1] == 0.0 && elements_largest(h, 4) == 0.0);
            continue;
        }
        /* It pushes the two apart, the harder the closer they are, and is convex. */
        CHECK(energy > 0.0 && energy < last && g[0] > 0.0 && g[1] == -g[0] && g[1] > steepest && h[0] > 0.0);
        CHECK(elements_semidefinite(h, 2));
        last = energy, steepest = g[1];
    }
    for (int i = 0; i < 2000; i++) { /* convex along a line, touching included */
        double a = elements_random(1e-9, 1.2) * p[1], b = elements_random(1e-9, 1.2) * p[1], ends;
        q[0] = 0.0, q[1] = a, ends = elements_floor(p, q, NULL, NULL, 0);
        q[1] = b, ends += elements_floor(p, q, NULL, NULL, 0);
        q[1] = 0.5 * (a + b);
        CHECK(2.0 * elements_floor(p, q, NULL, NULL, 0) <= ends * (1.0 + 1e-14));
    }
    /* No jump at touching: to second order nothing. */
    q[0] = 0.0, q[1] = p[1] * (1.0 - 1e-6);
    CHECK(elements_floor(p, q, g, h, 0) < 1e-17 * p[0] * p[1] && g[0] < 1e-11 * p[0] && h[0] < 1e-5 * p[0] / p[1]);
    /* Nothing is left: refused, with derivatives that are numbers. */
    for (int i = 0; i < 2; i++) {
        q[1] = -0.5 * p[1] * i;
        CHECK(elements_floor(p, q, g, h, 0) == HUGE_VAL);
        CHECK(elements_finite(g, 2) && elements_finite(h, 4));
    }
}

TEST(yarn_friction) {
    double p[3] = {0.1, 200.0, 3.0}, q[1], g[1], h[1]; /* slips beyond 0.015 */
    for (int i = 0; i < 20; i++) {
        double s = 0.0031 * (i - 10), anchor;
        q[0] = p[0] + s;
        if (fabs(fabs(s) - 0.015) > 3e-4) CHECK(elements_differences(elements_friction, p, 1, q, 0.01, 1e-4, 1e-9));
        elements_friction(p, q, g, h, 1);
        CHECK(h[0] > 0.0 && fabs(g[0]) <= p[2]);
        for (int j = 0; j < 20; j++) { /* the parabola of the projected form lies above the energy */
            double x = p[0] + 0.0041 * (j - 10), d = x - q[0];
            double above = elements_friction(p, q, NULL, NULL, 1) + (g[0] + 0.5 * h[0] * d) * d;
            CHECK(elements_friction(p, &x, NULL, NULL, 1) <= above + 1e-15);
        }
        anchor = yci_yarn_friction_anchor(q[0], p[0], p[1], p[2]);
        CHECK(fabs(q[0] - anchor) <= 0.015 * (1.0 + 1e-12) && (fabs(s) > 0.015 || anchor == p[0]));
        /* The anchor's move leaves the force as it was. */
        CHECK(fabs(200.0 * (q[0] - anchor) - g[0]) < 1e-10);
    }
    CHECK(fabs(yci_yarn_friction(0.115 - 1e-9, 0.1, 200.0, 3.0, NULL, NULL, 0) -
              yci_yarn_friction(0.115 + 1e-9, 0.1, 200.0, 3.0, NULL, NULL, 0)) < 1e-8);
    CHECK(yci_yarn_friction(0.3, 0.1, 200.0, 0.0, g, h, 1) == 0.0 && g[0] == 0.0 && h[0] == 0.0);
    CHECK(yci_yarn_friction_anchor(0.3, 0.1, 200.0, 0.0) == 0.3);
}

TEST(yarn_compression) {
    /* A flat plain weave under tension: spacing s, layers +-R. The upper yarn pulls down by 4 T R/sqrt(s^2 + 4 R^2). */
    double spacing = 1e-3, radius = 2e-4, u = spacing / 1.05, k = 100.0, n[3] = {0.0, 0.0, 1.0};
    double tension = k * 0.05, pull = 4.0 * tension * radius / sqrt(spacing * spacing + 4.0 * radius * radius);
    double high[5][7], low[5][7], up[3], down[3], lambda, turn, best = 1e30, at = 0.0;
    const double straight[3] = {0.0, 0.0, 0.0};
    double rest[3];
    const double *highs[5], *lows[5];
    memset(high, 0, sizeof high), memset(low, 0, sizeof low);
    for (int i = 0; i < 5; i++) {
        double layer = i % 2 ? -radius : radius;
        highs[i] = high[i], lows[i] = low[i];
        high[i][0] = spacing * (i - 2), high[i][5] = layer, high[i][6] = u * i;
        low[i][1] = spacing * (i - 2), low[i][5] = -layer, low[i][6] = u * i;
    }
    yci_yarn_crossing_force(up, highs, k, 0.0, straight);
    CHECK(fabs(up[2] + pull) < 1e-12 * pull && fabs(up[0]) + fabs(up[1]) < 1e-15);
    yci_yarn_crossing_force(down, lows, 2.0 * k, 0.0, straight);
    CHECK(fabs(down[2] - 2.0 * pull) < 1e-12 * pull);
    lambda = yci_yarn_compression(down, up, n);
    CHECK(fabs(lambda - 1.5 * pull) < 1e-12 * pull);
    for (int i = 0; i <= 3000; i++) { /* the least squares of both yarns' equilibrium, by search */
        double x = pull * i / 1000.0, a = down[2] - x, b = up[2] + x;
        if (a * a + b * b < best) best = a * a + b * b, at = x;
    }
    CHECK(fabs(at - lambda) < 2e-3 * pull);
    CHECK(yci_yarn_compression(up, down, n) == 0.0);
    /* Bending alone presses too: the turn of the crossing itself and, as much again, both turns beside it. */
    turn = 2.0 * (2.0 * 1e-9 * 2.0 * atan2(2.0 * radius, spacing) / (2.0 * u)) * spacing /
        (spacing * spacing + 4.0 * radius * radius);
    yci_yarn_crossing_force(up, highs, 0.0, 1e-9, straight);
    CHECK(fabs(up[2] + 2.0 * turn) < 1e-9 * turn);
    rest[0] = rest[1] = rest[2] =
        2.0 * atan2(2.0 * radius, spacing); /* where they turn like that at rest it does not */
    yci_yarn_crossing_force(up, highs, 0.0, 1e-9, rest);
    CHECK(fabs(up[2]) < 1e-9 * turn);
    highs[0] = highs[4] = NULL;
    yci_yarn_crossing_force(up, highs, 0.0, 1e-9, straight);
    CHECK(fabs(up[2] + turn) < 1e-9 * turn);
    /* At a yarn's end only one segment pulls. */
    highs[3] = NULL;
    yci_yarn_crossing_force(up, highs, k, 1e-9, straight);
    CHECK(fabs(up[2] + 0.5 * pull) < 1e-12 * pull && up[0] < 0.0);
    highs[1] = NULL, highs[3] = high[3];
    yci_yarn_crossing_force(up, highs, k, 1e-9, straight);
    CHECK(fabs(up[2] + 0.5 * pull) < 1e-12 * pull && up[0] > 0.0);
}

TEST(yarn_length) {
    elements_state = 1;
    for (int trial = 0; trial < 10; trial++) {
        double size = trial % 2 ? 1e-3 : 1.0, q[2], p[2], h[4];
        p[0] = 3.0, p[1] = size, q[0] = 0.3 * size, q[1] = q[0] + size * (0.2 + 0.3 * trial);
        CHECK(elements_differences(elements_length, p, 2, q, size, 1e-3 * size, 1e-9));
        elements_length(p, q, NULL, h, 1);
        CHECK(elements_semidefinite(h, 2));
    }
}

/* A contact along x, with tails at angles `a` and `b` to it, turned by psi about it. */
static void elements_contact_of(double *q, double size, double a, double b, double psi) {
    yci_zero(q, 12);
    q[3] = 0.4;
    q[6] = 0.7 * cos(a), q[7] = 0.7 * sin(a);
    q[9] = 0.4 + 0.6 * cos(b), q[10] = -0.6 * sin(b) * cos(psi), q[11] = 0.6 * sin(b) * sin(psi);
    for (int i = 0; i < 12; i++) q[i] *= size;
    elements_move(q, 4, size);
}

/* Nothing is NaN where tails have no length or lie in the axis. */
static void elements_wrap_degenerate(double (*wrap)(const double *, double, double, double *, double *, int)) {
    for (int trial = 0; trial < 4; trial++) {
        double q[12], g[12], h[144];
        elements_contact_of(q, 1e-3, trial == 0 ? 0.0 : 1.0, trial == 1 ? YCI_PI : 1.0, 0.3);
        if (trial == 2) yci_copy(q + 6, q);
        if (trial == 3) yci_copy(q + 3, q);
        for (int projected = 0; projected < 2; projected++) {
            CHECK(wrap(q, 1.0, 0.5 * YCI_PI, g, h, projected) >= 0.0);
            CHECK(elements_finite(g, 12) && elements_finite(h, 144));
        }
    }
}

TEST(yarn_wrap) {
    /* Near the axis, across it, folded back; flat, wrapped, folded over. */
    static const double tilt[4] = {1e-3, 0.7, 0.5 * YCI_PI, 2.6}, psi[5] = {0.0, 1.4, -1.3, 3.1, -3.1};
    elements_state = 5;
    for (int trial = 0; trial < 160; trial++) {
        double size = trial % 2 ? 1e-3 : 1.0, a = tilt[trial / 2 % 4], b = tilt[trial / 8 % 4], turn = psi[trial / 32];
        double q[12], p[2], h[144], e;
        p[0] = 2.0, p[1] = trial % 3 ? 0.5 * YCI_PI : -0.9;
        elements_contact_of(q, size, a, b, turn);
        e = p[0] * (1.0 - sin(a) * sin(b) * cos(turn - p[1]));
        CHECK(fabs(yci_triangle_hinge_strain(q) - turn) < 1e-12);
        CHECK(fabs(elements_wrap(p, q, NULL, NULL, 0) - e) < 1e-14 * p[0]);
        CHECK(elements_differences(elements_wrap, p, 12, q, size, 1e-3 * size, 1e-9));
        CHECK(elements_invariant(elements_wrap, p, 12, 4, q, size));
        elements_wrap(p, q, NULL, h, 1);
        CHECK(elements_semidefinite(h, 12));
    }
    /* At rest, wrapped and tails across the axis, the projected form is exact; and as stiff as the literal one. */
    for (int trial = 0; trial < 8; trial++) {
        double q[12], p[4] = {2.0, 0.0, 0.0, 0.0}, h[144], exact[144], hinge[144], along[12], axis[3], tail[3];
        double form[2] = {0.0, 0.0};
        p[1] = 0.4 * trial - 1.5;
        elements_contact_of(q, 0.3, 0.5 * YCI_PI, 0.5 * YCI_PI, p[1]);
        CHECK(fabs(elements_wrap(p, q, along, NULL, 0)) < 1e-15 && elements_largest(along, 12) < 1e-13);
        elements_wrap(p, q, NULL, h, 1), elements_wrap(p, q, NULL, exact, 0), elements_hinge(p, q, NULL, hinge, 0);
        CHECK(elements_distance(h, exact, 144) <= 1e-13 * elements_largest(exact, 144));
        yci_zero(along, 12); /* a turn of one tail about the axis */
        yci_sub(axis, q + 3, q), yci_sub(tail, q + 6, q), yci_cross(along + 6, axis, tail);
        for (int i = 0; i < 144; i++) {
            form[0] += along[i / 12] * h[i] * along[i % 12], form[1] += along[i / 12] * hinge[i] * along[i % 12];
        }
        CHECK(form[0] > 0.0 && fabs(form[0] - form[1]) < 1e-12 * form[0]);
    }
    elements_wrap_degenerate(yci_yarn_wrap);
}

static double elements_wrap_literal(const double *p, const double *q, double *g, double *h, int projected) {
    return yci_yarn_wrap_literal(q, p[0], p[1], g, h, projected);
}

/* The literal form: its value, its derivatives, near flat and folded over; no NaN where a tail lies in the axis. */
TEST(yarn_wrap_literal) {
    static const double tilt[4] = {0.05, 0.7, 0.5 * YCI_PI, 2.6}, psi[5] = {0.0, 1.4, -1.3, 3.1, -3.1};
    elements_state = 5;
    for (int trial = 0; trial < 160; trial++) {
        double size = trial % 2 ? 1e-3 : 1.0, a = tilt[trial / 2 % 4], b = tilt[trial / 8 % 4], turn = psi[trial / 32];
        double q[12], p[2], h[144], d, f = 1.0, s[2] = {sin(a), sin(b)};
        p[0] = 2.0, p[1] = trial % 3 ? 0.5 * YCI_PI : -0.9;
        elements_contact_of(q, size, a, b, turn);
        d = atan2(sin(turn - p[1]), cos(turn - p[1]));
        for (int i = 0; i < 2; i++) f *= s[i] * s[i] / (s[i] * s[i] + 0.09);
        CHECK_NEAR(elements_wrap_literal(p, q, NULL, NULL, 0), f * d * d + (1.0 - f) * p[1] * p[1], 1e-11);
        CHECK(elements_differences(elements_wrap_literal, p, 12, q, size, 3e-4 * size, 1e-6));
        CHECK(elements_invariant(elements_wrap_literal, p, 12, 4, q, size));
        elements_wrap_literal(p, q, NULL, h, 1);
        CHECK(elements_semidefinite(h, 12));
    }
    elements_wrap_degenerate(yci_yarn_wrap_literal);
}

static double elements_wrap_damp(const double *p, const double *q, double *g, double *h, int projected) {
    (void)projected;
    if (g) yci_zero(g, 12);
    if (h) yci_zero(h, 144);
    return yci_yarn_wrap_damp(q, p[0], p[1], p + 2, g, h);
}

/* Its gradient is the slope of its energy; at the step's start its Hessian is exact and, at rest, that of wrapping. */
TEST(yarn_wrap_damping) {
    elements_state = 7;
    for (int trial = 0; trial < 40; trial++) {
        double size = trial % 2 ? 1e-3 : 1.0, q[12], p[5], g[12], h[144], exact[144], to[12], e[2], off = 0.0;
        p[0] = 2.0, p[1] = 0.2 * (trial % 20) - 1.9;
        if (trial < 20) elements_contact_of(q, size, 0.5 * YCI_PI, 0.5 * YCI_PI, p[1]);
        else
            elements_contact_of(
                q, size, elements_random(0.3, 2.8), elements_random(0.3, 2.8), elements_random(-3.1, 3.1));
        yci_yarn_wrap_strain(q, p[1], p + 2);
        CHECK(elements_wrap_damp(p, q, g, h, 0) == 0.0 && elements_largest(g, 12) == 0.0);
        CHECK(elements_semidefinite(h, 12));
        if (trial < 20) {
            elements_wrap(p, q, NULL, exact, 0);
            CHECK(elements_distance(h, exact, 144) <= 1e-12 * elements_largest(exact, 144));
        }
        for (int i = 0; i < 12; i++) { /* columns of the Hessian, from the gradient */
            double up[12], down[12];
            memcpy(to, q, sizeof to);
            to[i] = q[i] + 1e-5 * size, elements_wrap_damp(p, to, up, NULL, 0);
            to[i] = q[i] - 1e-5 * size, elements_wrap_damp(p, to, down, NULL, 0);
            for (int k = 0; k < 12; k++) off = fmax(off, fabs((up[k] - down[k]) / (2e-5 * size) - h[12 * i + k]));
        }
        CHECK(off <= 1e-7 * elements_largest(h, 144));
        memcpy(to, q, sizeof to), elements_move(to, 4, size); /* rigid motion is spared */
        CHECK(elements_wrap_damp(p, to, NULL, NULL, 0) < 1e-24);
        for (int i = 0; i < 12; i++) q[i] += elements_random(-0.1, 0.1) * size;
        elements_wrap_damp(p, q, g, NULL, 0), off = 0.0;
        for (int i = 0; i < 12; i++) {
            for (int k = 0; k < 2; k++)
                memcpy(to, q, sizeof to), to[i] += (k ? 1e-5 : -1e-5) * size,
                    e[k] = elements_wrap_damp(p, to, NULL, NULL, 0);
            off = fmax(off, fabs((e[1] - e[0]) / (2e-5 * size) - g[i]));
        }
        CHECK(off <= 1e-7 * elements_largest(g, 12) + 1e-9 / size * p[0]);
        CHECK(elements_invariant(elements_wrap_damp, p, 12, 4, q, size));
    }
}

/* Half the sum of squares that compression minimises. */
static double elements_stack(
    const double *lambda, int n, const double *load, const double *below, const double *above) {
    double sum = 0.0;
    for (int i = 0; i < n; i++) {
        double f = load[i] + (i ? below[i] * lambda[i - 1] : 0.0) - (i + 1 < n ? above[i] * lambda[i] : 0.0);
        sum += 0.5 * f * f;
    }
    return sum;
}

TEST(yarn_stack_compression) {
    static const double example[3] = {1.0, -1.0, 1.0}, two[2] = {3.0, -1.0};
    double ones[YCI_STACK], lambda[YCI_STACK];
    for (int i = 0; i < YCI_STACK; i++) ones[i] = 1.0;
    yci_yarn_stack_compression(lambda, 3, example, ones, ones); /* the closed form of YARN (4) gives 4/3, 2/3 */
    CHECK(fabs(lambda[0] - 1.0) < 1e-15 && lambda[1] == 0.0);
    yci_yarn_stack_compression(lambda, 2, two, ones, ones);
    CHECK(fabs(lambda[0] - 2.0) < 1e-15);
    elements_state = 9;
    for (int trial = 0; trial < 400; trial++) {
        int n = 2 + trial % (YCI_STACK - 1);
        double load[YCI_STACK], below[YCI_STACK], above[YCI_STACK], least;
        for (int i = 0; i < n; i++) {
            load[i] = elements_random(-1.0, 1.0), below[i] = elements_random(0.6, 1.0),
            above[i] = elements_random(0.6, 1.0);
        }
        yci_yarn_stack_compression(lambda, n, load, below, above);
        least = elements_stack(lambda, n, load, below, above);
        for (int i = 0; i + 1 < n; i++) { /* the conditions of Karush, Kuhn and Tucker */
            double f[2], force;
            for (int k = 0; k < 2; k++) {
                int y = i + k;
                f[k] = load[y] + (y ? below[y] * lambda[y - 1] : 0.0) - (y + 1 < n ? above[y] * lambda[y] : 0.0);
            }
            force = below[i + 1] * f[1] - above[i] * f[0];
            CHECK(lambda[i] >= 0.0 && force > -1e-13 && fabs(force * lambda[i]) < 1e-13);
        }
        for (int move = 0; move < 20; move++) { /* and nothing near by is less */
            double other[YCI_STACK];
            for (int i = 0; i + 1 < n; i++) other[i] = yci_max(0.0, lambda[i] + elements_random(-0.1, 0.1));
            CHECK(elements_stack(other, n, load, below, above) >= least - 1e-14);
        }
    }
}

/* The least of all sets of pressed contacts whose equilibrium presses: the solution, by brute force. */
TEST(yarn_stack_compression_is_the_least) {
    elements_state = 4;
    for (int trial = 0; trial < 60; trial++) {
        int n = 2 + trial % (YCI_STACK - 1);
        double load[YCI_STACK], below[YCI_STACK], above[YCI_STACK], best[YCI_STACK] = {0.0}, lambda[YCI_STACK];
        double least = HUGE_VAL;
        for (int i = 0; i < n; i++) {
            load[i] = elements_random(-1.0, 1.0), below[i] = elements_random(0.6, 1.0);
            above[i] = elements_random(0.6, 1.0);
        }
        for (int set = 0; set < 1 << (n - 1); set++) {
            double a[YCI_STACK][YCI_STACK + 1], sum, x[YCI_STACK] = {0.0};
            int at[YCI_STACK], m = 0, fits = 1;
            for (int i = 0; i + 1 < n; i++)
                if (set >> i & 1) at[m++] = i;
            for (int i = 0; i < m; i++) { /* normal equations of the contacts in the set, by elimination */
                int p = at[i];
                for (int j = 0; j < m; j++)
                    a[i][j] = at[j] == p ? above[p] * above[p] + below[p + 1] * below[p + 1]
                        : at[j] == p + 1 ? -below[p + 1] * above[p + 1]
                        : at[j] == p - 1 ? -below[p] * above[p]
                                         : 0.0;
                a[i][m] = above[p] * load[p] - below[p + 1] * load[p + 1];
            }
            for (int i = 0; i < m; i++)
                for (int r = i + 1; r < m; r++) {
                    double f = a[r][i] / a[i][i];
                    for (int j = i; j <= m; j++) a[r][j] -= f * a[i][j];
                }
            for (int i = m - 1; i >= 0; i--) {
                sum = a[i][m];
                for (int j = i + 1; j < m; j++) sum -= a[i][j] * x[at[j]];
                x[at[i]] = sum / a[i][i], fits &= x[at[i]] >= 0.0;
            }
            sum = elements_stack(x, n, load, below, above);
            if (fits && sum < least) least = sum, memcpy(best, x, sizeof best);
        }
        yci_yarn_stack_compression(lambda, n, load, below, above);
        for (int i = 0; i + 1 < n; i++) CHECK_NEAR(lambda[i], best[i], 1e-12);
    }
}

TEST(yarn_inertia) {
    double block[25], w[3] = {0.3, -0.8, 0.5}, v[3] = {-0.2, 0.1, 0.9}, x[5], c[3], form = 0.0, expected, top;
    elements_state = 1;
    memset(block, 0, sizeof block);
    yci_yarn_inertia(2.0, w, 0, 5, block), yci_yarn_inertia(3.0, v, 1, 5, block);
    elements_scatter(x, 5, 1.0);
    for (int i = 0; i < 5; i++) {
        for (int j = 0; j < 5; j++) form += 0.5 * x[i] * block[5 * i + j] * x[j];
    }
    yci_copy(c, x), yci_axpy(c, -x[3], w);
    expected = yci_dot(c, c) + 1e-3 * x[3] * x[3];
    yci_copy(c, x), yci_axpy(c, -x[4], v);
    expected += 1.5 * (yci_dot(c, c) + 1e-3 * x[4] * x[4]);
    CHECK(fabs(form - expected) < 1e-14);
    memset(block, 0, sizeof block), memset(w, 0, sizeof w);
    yci_yarn_inertia(2.0, w, 0, 5, block), yci_yarn_inertia(3.0, w, 1, 5, block);
    CHECK(test_lowest_eigenvalue(block, 5, &top) > 1e-3);
}

/* ---- triangle ---------------------------------------------------------------------------------------------------- */

TEST(triangle_membrane) {
    elements_state = 1;
    for (int trial = 0; trial < 30; trial++) {
        double size = trial % 2 ? 1e-2 : 1.0, p[16], q[9], h[81], exact[81], strain[3], stretch, m[4], margin;
        yci_membrane rest;
        static const double factor[5] = {0.3, 0.9, 1.0, 1.2, 2.0};
        p[0] = 0.1, p[1] = -0.2, p[2] = 1.1, p[3] = 0.1, p[4] = 0.3, p[5] = 0.8; /* uv */
        for (int i = 0; i < 6; i++) p[i] *= size;
        if (trial % 4 == 3) p[1] = -p[1], p[3] = -p[3], p[5] = -p[5]; /* mirrored pattern */
        p[6] = 0.7, p[7] = 0.95;
        p[8] = 40.0, p[9] = 7.0, p[10] = 25.0, p[11] = 3.0;
        p[12] = trial % 3 ? 0.0 : 0.5, p[13] = 0.02, p[14] = -0.05, p[15] = 0.04;
        /* The pattern itself, scaled, sheared a little, thrown anywhere. */
        stretch = factor[trial % 5];
        for (int i = 0; i < 3; i++) {
            q[3 * i] = stretch * (p[2 * i] + 0.1 * p[2 * i + 1]);
            q[3 * i + 1] = stretch * p[2 * i + 1], q[3 * i + 2] = 0.0;
        }
        elements_move(q, 3, size);
        CHECK(elements_differences(elements_membrane, p, 9, q, size, 1e-3 * size, 1e-11));
        CHECK(elements_invariant(elements_membrane, p, 9, 3, q, size));
        elements_membrane(p, q, NULL, h, 1), elements_membrane(p, q, NULL, exact, 0);
        CHECK(elements_semidefinite(h, 9));
        yci_triangle_rest(&rest, p, p[6], p[7]);
        yci_triangle_membrane_strain(q, &rest, strain);
        yci_zero(m, 3);
        yci_triangle_stress(m, p + 8, 1.0, strain);
        margin = m[0] * m[1] - m[2] * m[2];
        if (p[12] == 0.0 && m[0] > 0.0 && margin > 0.0) CHECK(elements_distance(h, exact, 81) == 0.0);
        for (int i = 0; i < 81; i++) exact[i] = h[i] - exact[i] + (i % 10 == 0 ? 1e-13 * fabs(h[i]) : 0.0);
        CHECK(elements_largest(exact, 81) < 1e-10 || elements_semidefinite(exact, 9));
    }
}

TEST(triangle_clamp) {
    int mixed = 0;
    elements_state = 1;
    for (int trial = 0; trial < 60; trial++) {
        double s[3], p[3], full[4], rest[4];
        elements_scatter(s, 3, 1.0);
        mixed += s[0] * s[1] < s[2] * s[2];
        yci_copy(p, s);
        yci_triangle_clamp(p);
        full[0] = p[0], full[1] = full[2] = p[2], full[3] = p[1];
        rest[0] = p[0] - s[0], rest[1] = rest[2] = p[2] - s[2], rest[3] = p[1] - s[1];
        /* The positive part: both it and what it removes are semidefinite, and their product is zero. */
        CHECK(yci_min(full[0], full[3]) >= -1e-15 && full[0] * full[3] - full[1] * full[2] >= -1e-15);
        CHECK(yci_min(rest[0], rest[3]) >= -1e-15 && rest[0] * rest[3] - rest[1] * rest[2] >= -1e-15);
        CHECK(fabs(full[0] * rest[0] + full[1] * rest[2]) + fabs(full[0] * rest[1] + full[1] * rest[3]) < 1e-15);
        CHECK(fabs(full[2] * rest[0] + full[3] * rest[2]) + fabs(full[2] * rest[1] + full[3] * rest[3]) < 1e-15);
    }
    CHECK(mixed > 10 && mixed < 50);
}

TEST(triangle_membrane_rest) {
    /* At rest: no strain, whatever the grain; the rest is the pattern times the pre-stretch. */
    double uv[6] = {0.1, 0.2, 1.3, 0.4, 0.5, 1.1}, q[9], strain[3], pull[3];
    double material[4] = {40.0, 0.0, 25.0, 3.0}, stiff[4], area = 0.5 * (1.2 * 0.9 - 0.2 * 0.4), g[9], h[81];
    yci_membrane rest;
    elements_state = 1;
    for (int i = 0; i < 6; i++) {
        double grain = 0.5 * i, factor = 0.8 + 0.1 * i, c = cos(grain), s = sin(grain);
        yci_triangle_rest(&rest, uv, grain, factor);
        CHECK(fabs(rest.area - factor * factor * area) < 1e-15);
        for (int p = 0; p < 3; p++) {
            q[3 * p] = factor * uv[2 * p], q[3 * p + 1] = factor * uv[2 * p + 1], q[3 * p + 2] = 0.0;
        }
        yci_triangle_membrane_strain(q, &rest, strain);
        CHECK(elements_largest(strain, 3) < 1e-14);
        /* Stretched by 1.1 along the grain: warp strain 0.105, no other. */
        for (int p = 0; p < 3; p++) {
            double along = 0.1 * (c * q[3 * p] + s * q[3 * p + 1]);
            q[3 * p] += along * c, q[3 * p + 1] += along * s;
        }
        yci_triangle_membrane_strain(q, &rest, pull);
        CHECK(fabs(pull[0] - 0.105) < 1e-14 && fabs(pull[1]) < 1e-14 && fabs(pull[2]) < 1e-14);
        CHECK(fabs(yci_triangle_membrane(q, &rest, material, 0.0, NULL, NULL, NULL, NULL, 0) -
                  rest.area * 20.0 * 0.105 * 0.105) < 1e-13);
    }
    /* An isotropic material does not see the grain. */
    stiff[0] = stiff[2] = 10.0, stiff[1] = 3.0, stiff[3] = 3.5;
    elements_scatter(q, 9, 1.0);
    yci_triangle_rest(&rest, uv, 0.0, 1.0);
    area = yci_triangle_membrane(q, &rest, stiff, 0.0, NULL, NULL, NULL, NULL, 0);
    yci_triangle_rest(&rest, uv, 1.1, 1.0);
    CHECK(fabs(yci_triangle_membrane(q, &rest, stiff, 0.0, NULL, NULL, NULL, NULL, 0) - area) < 1e-13 * area);
    /* A degenerate pattern triangle has no energy; collapsed positions give no NaN. */
    yci_zero(q, 9);
    yci_triangle_membrane(q, &rest, stiff, 0.0, NULL, NULL, g, h, 1);
    CHECK(elements_finite(g, 9) && elements_semidefinite(h, 9));
    uv[4] = 2.5, uv[5] = 0.6;
    yci_triangle_rest(&rest, uv, 0.0, 1.0);
    uv[4] = uv[2], uv[5] = uv[3];
    yci_triangle_rest(&rest, uv, 0.0, 1.0);
    CHECK(rest.area == 0.0 && yci_triangle_membrane(q, &rest, stiff, 0.0, NULL, NULL, g, h, 0) == 0.0);
    CHECK(elements_largest(g, 9) == 0.0 && elements_largest(h, 81) == 0.0);
}

/* A hinge of two random triangles with the given dihedral, in a random pose. */
static void elements_fold(double *q, double size, double theta) {
    double a = elements_random(0.5, 1.0), b = elements_random(0.5, 1.0);
    yci_zero(q, 12);
    q[4] = 1.0;
    q[6] = -a * cos(theta), q[7] = elements_random(-0.3, 1.3), q[8] = a * sin(theta);
    q[9] = b, q[10] = elements_random(-0.3, 1.3);
    for (int i = 0; i < 12; i++) q[i] *= size;
    elements_move(q, 4, size);
}

TEST(triangle_hinge) {
    static const double angle[8] = {0.0, 1e-9, 1e-4, 0.5, -0.5, 2.0, 0.999 * YCI_PI, -0.999 * YCI_PI};
    elements_state = 1;
    for (int trial = 0; trial < 64; trial++) {
        double size = trial % 2 ? 1e-2 : 1.0, theta = angle[trial % 8], q[12], p[4], h[144], exact[144], step;
        p[0] = 3.0, p[1] = trial / 8 % 2 ? 0.3 : 0.0, p[2] = trial / 16 % 2 ? 0.6 : 0.0, p[3] = -0.2;
        elements_fold(q, size, theta);
        step = (fabs(theta) > 3.0 ? 2e-4 : 1e-3) * size;
        CHECK(fabs(yci_triangle_hinge_strain(q) - theta) < 1e-14);
        CHECK(elements_differences(elements_hinge, p, 12, q, size, step, 1e-10));
        CHECK(elements_invariant(elements_hinge, p, 12, 4, q, size));
        elements_hinge(p, q, NULL, h, 1);
        CHECK(elements_semidefinite(h, 12));
        p[1] = theta, p[2] = 0.0;
        elements_hinge(p, q, NULL, h, 1), elements_hinge(p, q, NULL, exact, 0);
        CHECK(elements_distance(h, exact, 144) <= 1e-12 * elements_largest(exact, 144));
    }
}

TEST(triangle_hinge_wrap) {
    double q[12], p[4] = {3.0, -YCI_PI + 0.1, 0.0, 0.0}; /* theta just below pi, rest just above -pi: nearly at rest */
    elements_state = 1;
    elements_fold(q, 1.0, YCI_PI - 0.1);
    CHECK(fabs(elements_hinge(p, q, NULL, NULL, 0) - 1.5 * 0.04) < 1e-12);
    p[1] = YCI_PI - 0.1;
    elements_fold(q, 1.0, -YCI_PI + 0.1);
    CHECK(fabs(elements_hinge(p, q, NULL, NULL, 0) - 1.5 * 0.04) < 1e-12);
    /* Both wings on the side of the normal of (x0, x1, x2): positive. */
    yci_zero(q, 12), q[4] = 1.0, q[6] = -1.0, q[8] = 0.2, q[9] = 1.0, q[11] = 0.2;
    CHECK(yci_triangle_hinge_strain(q) > 0.3);
}

TEST(triangle_hinge_degenerate) {
    double p[4] = {1.0, 0.4, 0.5, -0.3}, q[12], g[12], h[144], force[3];
    elements_state = 1;
    for (int i = 0; i < 64; i++) {
        double tiny = i & 32 ? 1e-13 : 0.0;
        yci_zero(q, 12);
        q[4] = i & 1 ? 1.0 : tiny;                             /* the edge */
        q[6] = i & 2 ? -1.0 : -tiny, q[7] = i & 4 ? 0.5 : 0.0; /* a tip on the edge's line, or at x0 */
        q[9] = i & 8 ? 1.0 : tiny, q[10] = i & 16 ? 3.0 : 0.0;
        elements_hinge(p, q, g, h, 0);
        CHECK(elements_finite(g, 12) && elements_finite(h, 144));
        elements_hinge(p, q, g, h, 1);
        CHECK(elements_semidefinite(h, 12));
        force[0] = force[1] = force[2] = 0.0;
        for (int k = 0; k < 4; k++) yci_add(force, force, g + 3 * k);
        CHECK(yci_norm(force) <= 1e-12 * elements_largest(g, 12));
        /* Bounded: pi c (1 + r) over the floored height, times the floored foot. */
        if (i & 31) CHECK(elements_largest(g, 12) < 4.0 * 1e4 * 1e4 * 4.0);
    }
}

/* Rolls a flat point onto a cylinder of curvature kappa whose axis makes an angle with y. */
static void elements_roll(double *x, double u, double v, double kappa, double turn) {
    double c = cos(turn), s = sin(turn), across = c * u + s * v, along = c * v - s * u;
    x[0] = sin(kappa * across) / kappa, x[1] = along, x[2] = (1.0 - cos(kappa * across)) / kappa;
}

TEST(triangle_hinge_cylinder) {
    double bending = 2e-3, kappa = 0.05, expected = 0.5 * bending * kappa * kappa;
    /* Equilateral triangles: three hinges to every two triangles, any direction of the axis. */
    for (int turn = 0; turn < 5; turn++) {
        double energy = 0.0, area = 0.5 * sqrt(3.0), l = 1e-2;
        for (int k = 0; k < 3; k++) {
            double a = YCI_PI * k / 3.0, c = cos(a) * l, s = sin(a) * l, q[12], w = 0.5 * sqrt(3.0);
            elements_roll(q, 0.0, 0.0, kappa, 0.3 * turn), elements_roll(q + 3, c, s, kappa, 0.3 * turn);
            elements_roll(q + 6, 0.5 * c - w * s, 0.5 * s + w * c, kappa, 0.3 * turn);
            elements_roll(q + 9, 0.5 * c + w * s, 0.5 * s - w * c, kappa, 0.3 * turn);
            s = sin(a - 0.3 * turn);
            CHECK(fabs(yci_triangle_hinge_strain(q) - kappa * l * (s * s - 0.25) * 2.0 / sqrt(3.0)) < 1e-3 * kappa * l);
            energy += yci_triangle_hinge(q, bending / area, 0.0, 0.0, 0.0, NULL, NULL, 0);
        }
        CHECK(fabs(energy / (area * l * l) - expected) < 1e-6 * expected);
    }
    /* A strip of squares cut by diagonals: the hinges along the axis carry it all. */
    for (int cut = 0; cut < 2; cut++) {
        double q[12], energy, dx = 1e-2, dy = 2e-2, b = cut ? dy : 0.0;
        elements_roll(q, 0.0, 0.0, kappa, 0.0), elements_roll(q + 3, 0.0, dy, kappa, 0.0);
        elements_roll(q + 6, -dx, b, kappa, 0.0), elements_roll(q + 9, dx, dy - b, kappa, 0.0);
        energy = yci_triangle_hinge(q, bending * dy / dx, 0.0, 0.0, 0.0, NULL, NULL, 0);
        CHECK(fabs(energy - expected * dx * dy) < 1e-6 * energy);
        elements_roll(q + 3, dx, dy, kappa, 0.0), elements_roll(q + 6, 0.0, dy, kappa, 0.0);
        elements_roll(q + 9, dx, 0.0, kappa, 0.0);
        CHECK(yci_triangle_hinge(q, bending, 0.0, 0.0, 0.0, NULL, NULL, 0) < 1e-20);
    }
}

/* A rigid motion over the step leaves strong damping without a force. */
TEST(elements_rigid_undamped) {
    double q[12], with[12], without[12], uv[6] = {0.0, 0.0, 1.0, 0.0, 0.2, 0.9}, e[3], s;
    double material[4] = {40.0, 7.0, 25.0, 3.0};
    yci_membrane rest;
    elements_state = 1;
    for (int trial = 0; trial < 10; trial++) {
        elements_scatter(q, 6, 1.0), q[6] = 0.0, q[7] = 2.0;
        s = yci_yarn_stretch_strain(q), elements_move(q, 2, 1.0);
        yci_yarn_stretch(q, 10.0, 100.0, s, NULL, with, NULL, 0);
        yci_yarn_stretch(q, 10.0, 0.0, 0.0, NULL, without, NULL, 0);
        CHECK(elements_distance(with, without, 8) < 1e-11 * elements_largest(without, 8));
        elements_undulating(q, 1.0, 0.4, 0.9);
        s = yci_yarn_crimp_strain(q), elements_move(q, 2, 1.0);
        yci_yarn_crimp(q, 10.0, 100.0, s, NULL, with, NULL, 0);
        yci_yarn_crimp(q, 10.0, 0.0, 0.0, NULL, without, NULL, 0);
        CHECK(elements_distance(with, without, 10) < 1e-11 * elements_largest(without, 10));
        elements_scatter(q, 9, 1.0), q[9] = 0.0, q[10] = 2.0;
        s = yci_yarn_bend_strain(q), elements_move(q, 3, 1.0);
        yci_yarn_bend(q, 10.0, 0.0, 0.1, 100.0, s, with, NULL, 0);
        yci_yarn_bend(q, 10.0, 0.0, 0.1, 0.0, 0.0, without, NULL, 0);
        CHECK(elements_distance(with, without, 11) < 1e-11 * elements_largest(without, 11));
        s = yci_yarn_shear_strain(q), elements_move(q, 3, 1.0);
        yci_yarn_shear(q, 10.0, 1.0, 1.5, 0.5, 0.1, 100.0, s, NULL, with, NULL, 0);
        yci_yarn_shear(q, 10.0, 1.0, 1.5, 0.5, 0.1, 0.0, 0.0, NULL, without, NULL, 0);
        CHECK(elements_distance(with, without, 9) < 1e-11 * elements_largest(without, 9));
        yci_triangle_rest(&rest, uv, 0.3, 1.0);
        yci_triangle_membrane_strain(q, &rest, e), elements_move(q, 3, 1.0);
        yci_triangle_membrane(q, &rest, material, 100.0, e, NULL, with, NULL, 0);
        yci_triangle_membrane(q, &rest, material, 0.0, NULL, NULL, without, NULL, 0);
        CHECK(elements_distance(with, without, 9) < 1e-11 * elements_largest(without, 9));
        elements_scatter(q, 12, 1.0);
        s = yci_triangle_hinge_strain(q), elements_move(q, 4, 1.0);
        yci_triangle_hinge(q, 10.0, 0.3, 100.0, s, with, NULL, 0);
        yci_triangle_hinge(q, 10.0, 0.3, 0.0, 0.0, without, NULL, 0);
        CHECK(elements_distance(with, without, 12) < 1e-10 * elements_largest(without, 12));
        /* And it does damp a change of shape. */
        CHECK(yci_triangle_hinge(q, 10.0, 0.3, 100.0, s + 0.1, NULL, NULL, 0) > 4.99);
    }
}

/* The linear model of a tension or a stress: its error falls with the square of the step. */
TEST(elements_predictions_are_linear_models) {
    double q[10], dq[10], x[10], strain[3], there[3], stress[3], uv[6] = {0.0, 0.0, 1.0, 0.1, 0.2, 1.1};
    double material[4] = {3.0, 0.5, 2.0, 1.0};
    yci_membrane rest;
    elements_state = 7;
    yci_triangle_rest(&rest, uv, 0.3, 1.0);
    for (int trial = 0; trial < 10; trial++) {
        double error[3][2], h = 1e-3;
        elements_scatter(q, 10, 1.0), elements_scatter(dq, 10, 1.0);
        q[6] = 0.0, q[7] = 2.0;
        for (int half = 0; half < 2; half++, h *= 0.5) {
            for (int i = 0; i < 10; i++) dq[i] *= half ? 0.5 : h, x[i] = q[i] + dq[i];
            error[0][half] = 10.0 * (yci_yarn_stretch_strain(x) + 4.0 * (yci_yarn_stretch_strain(x) - 0.1)) -
                yci_yarn_stretch_predict(q, dq, 10.0, 4.0, 0.1);
            error[1][half] = 10.0 * (yci_yarn_crimp_strain(x) + 4.0 * (yci_yarn_crimp_strain(x) - 0.1)) -
                yci_yarn_crimp_predict(q, dq, 10.0, 4.0, 0.1);
            yci_triangle_membrane_strain(q, &rest, strain), yci_triangle_membrane_strain(x, &rest, there);
            yci_triangle_membrane_predict(q, dq, &rest, material, 4.0, strain, stress);
            for (int i = 0; i < 3; i++) strain[i] = there[i] + 4.0 * (there[i] - strain[i]);
            error[2][half] = hypot(material[0] * strain[0] + material[1] * strain[1] - stress[0],
                hypot(material[1] * strain[0] + material[2] * strain[1] - stress[1],
                    material[3] * strain[2] - stress[2]));
        }
        for (int kind = 0; kind < 3; kind++) {
            CHECK(fabs(error[kind][0]) < 1e-3);
            CHECK_NEAR(error[kind][1] / error[kind][0], 0.25, 0.02);
        }
    }
}
