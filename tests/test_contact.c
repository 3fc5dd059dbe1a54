/* Bodies, closest points, elements of contact, the broad phase and the step limit: against sampling, differences and
 * brute force. */
#include "internals.h"
#include "test.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A mannequin of 1.66 m, y up, z to the front: a loft for the torso (height, half width, half depth, centre z)... */
static const double torso[14][4] = {{0.74, 0.15, 0.085, 0.03}, {0.81, 0.176, 0.101, 0.016}, {0.87, 0.162, 0.109, 0.015},
    {0.93, 0.148, 0.103, 0.03}, {0.99, 0.137, 0.093, 0.045}, {1.05, 0.1245, 0.087, 0.049}, {1.11, 0.129, 0.092, 0.049},
    {1.17, 0.1395, 0.0975, 0.043}, {1.23, 0.156, 0.1065, 0.037}, {1.28, 0.158, 0.098, 0.022},
    {1.32, 0.14, 0.085, 0.012}, {1.36, 0.11, 0.066, 0.008}, {1.4, 0.07, 0.054, 0.02}, {1.45, 0.052, 0.06, 0.045}};

/* ... and rounded cones for the rest: ax ay az bx by bz ra rb */
static const double cones[24][8] = {{-0.155, 1.315, 0.012, -0.265, 1.216, 0.02, 0.062, 0.054},
    {-0.265, 1.216, 0.02, -0.355, 1.118, 0.053, 0.054, 0.044}, {-0.355, 1.118, 0.053, -0.43, 1.025, 0.16, 0.046, 0.033},
    {-0.43, 1.025, 0.16, -0.505, 0.945, 0.25, 0.033, 0.03}, {-0.095, 0.78, 0.03, -0.128, 0.53, 0.042, 0.09, 0.06},
    {-0.128, 0.53, 0.042, -0.157, 0.41, 0.01, 0.06, 0.055}, {-0.157, 0.41, 0.01, -0.183, 0.14, 0.015, 0.056, 0.034},
    {-0.183, 0.08, 0.0, -0.186, 0.045, 0.09, 0.036, 0.03}, {0.155, 1.315, 0.012, 0.265, 1.216, 0.02, 0.062, 0.054},
    {0.265, 1.216, 0.02, 0.355, 1.118, 0.053, 0.054, 0.044}, {0.355, 1.118, 0.053, 0.43, 1.025, 0.16, 0.046, 0.033},
    {0.43, 1.025, 0.16, 0.505, 0.945, 0.25, 0.033, 0.03}, {0.095, 0.78, 0.03, 0.128, 0.53, 0.042, 0.09, 0.06},
    {0.128, 0.53, 0.042, 0.157, 0.41, 0.01, 0.06, 0.055}, {0.157, 0.41, 0.01, 0.183, 0.14, 0.015, 0.056, 0.034},
    {0.183, 0.08, 0.0, 0.186, 0.045, 0.09, 0.036, 0.03}, {-0.072, 1.215, 0.075, -0.078, 1.25, 0.06, 0.07, 0.06},
    {-0.1, 1.34, 0.01, -0.165, 1.315, 0.012, 0.052, 0.058}, {-0.085, 0.84, -0.02, -0.08, 0.9, -0.01, 0.095, 0.085},
    {0.072, 1.215, 0.075, 0.078, 1.25, 0.06, 0.07, 0.06}, {0.1, 1.34, 0.01, 0.165, 1.315, 0.012, 0.052, 0.058},
    {0.085, 0.84, -0.02, 0.08, 0.9, -0.01, 0.095, 0.085}, {0.0, 1.38, 0.015, 0.0, 1.47, 0.055, 0.054, 0.052},
    {0.0, 1.515, 0.068, 0.0, 1.585, 0.055, 0.068, 0.074}};

/* ---- helpers ----------------------------------------------------------------------------------------------------- */

static void set(double *out, double x, double y, double z) { out[0] = x, out[1] = y, out[2] = z; }

/* A rotation by rows, from a random axis and angle. */
static void random_rotation(uint64_t *seed, double *r) {
    double axis[3], angle = test_random(seed, -3.0, 3.0), c = cos(angle), s = sin(angle);
    int i, j;
    do test_random_array(seed, -1.0, 1.0, axis, 3);
    while (yci_norm(axis) < 0.1);
    yci_scale(axis, axis, 1.0 / yci_norm(axis));
    for (i = 0; i < 3; i++)
        for (j = 0; j < 3; j++) r[3 * i + j] = (i == j ? c : 0.0) + (1.0 - c) * axis[i] * axis[j];
    r[1] -= s * axis[2], r[2] += s * axis[1], r[3] += s * axis[2];
    r[5] -= s * axis[0], r[6] -= s * axis[1], r[7] += s * axis[0];
}

static int body_of(yci_context *c, const yc_primitive *primitives, int count, double smooth, yci_body_sdf *body) {
    yc_body_desc desc = yc_body_desc_default();
    desc.primitives = primitives, desc.primitive_count = count, desc.smooth_radius = smooth;
    return yci_body_init(c, &desc, body) == YC_OK;
}

static int mannequin(yci_context *c, yci_body_sdf *body) {
    int i, count = (int)(sizeof cones / sizeof cones[0]);
    yc_primitive p[64];
    memset(p, 0, sizeof p);
    p[0].type = YC_LOFT, p[0].exponent = 2.3;
    p[0].sections = torso, p[0].section_count = (int)(sizeof torso / sizeof torso[0]);
    for (i = 0; i < count; i++) {
        yc_primitive *q = p + 1 + i;
        q->type = YC_ROUNDED_CONE;
        yci_copy(q->a, cones[i]), yci_copy(q->b, cones[i] + 3);
        q->ra = cones[i][6], q->rb = cones[i][7];
    }
    return body_of(c, p, count + 1, 0.03, body);
}

/* Largest difference between the analytic gradient and central differences, relative to 1. */
static double gradient_error(const yci_body_sdf *body, const double *x, double h) {
    double n[3], m[3], y[3], worst = 0.0, plus, minus;
    int i;
    yci_body_distance(body, x, n);
    for (i = 0; i < 3; i++) {
        yci_copy(y, x);
        y[i] = x[i] + h, plus = yci_body_distance(body, y, m);
        y[i] = x[i] - h, minus = yci_body_distance(body, y, m);
        worst = yci_max(worst, fabs((plus - minus) / (2.0 * h) - n[i]));
    }
    return worst;
}

/* Moves x along the gradient to the surface; returns how far it then is from it. */
static double to_surface(const yci_body_sdf *body, double *x) {
    double n[3], d = 1.0;
    int i;
    for (i = 0; i < 60; i++) {
        d = yci_body_distance(body, x, n);
        yci_axpy(x, -0.8 * d / yci_max(yci_dot(n, n), 0.25), n);
    }
    return fabs(yci_body_distance(body, x, n));
}

/* ---- bodies ------------------------------------------------------------------------------------------------------ */

TEST(contact_body_primitives) {
    yci_context c;
    yci_body_sdf body;
    yc_primitive p;
    double x[3], n[3], d;
    uint64_t seed = 1;
    int i;
    CHECK_RESULT(yci_context_init(&c, NULL), YC_OK);

    memset(&p, 0, sizeof p);
    p.type = YC_SPHERE, p.a[0] = 0.5, p.ra = 0.25;
    CHECK(body_of(&c, &p, 1, 0.0, &body));
    set(x, 0.5, 2.0, 0.0);
    CHECK(fabs(yci_body_distance(&body, x, n) - 1.75) < 1e-15 && fabs(n[1] - 1.0) < 1e-15);
    set(x, 0.5, 0.0, 0.0);
    CHECK(fabs(yci_body_distance(&body, x, n) + 0.25) < 1e-15 && fabs(yci_norm(n) - 1.0) < 1e-15);
    yci_body_free(&c, &body);

    memset(&p, 0, sizeof p);
    p.type = YC_PLANE, p.b[1] = 3.0, p.a[1] = 1.0;
    CHECK(body_of(&c, &p, 1, 0.0, &body));
    set(x, 100.0, 0.25, -7.0);
    CHECK(fabs(yci_body_distance(&body, x, n) + 0.75) < 1e-15 && fabs(n[1] - 1.0) < 1e-15);
    CHECK(yci_body_bound(&body, x) <= 0.0);
    yci_body_free(&c, &body);

    memset(&p, 0, sizeof p);
    p.type = YC_BOX, set(p.b, 1.0, 2.0, 3.0), p.ra = 0.5;
    CHECK(body_of(&c, &p, 1, 0.0, &body));
    set(x, 3.0, 0.0, 0.0), CHECK(fabs(yci_body_distance(&body, x, n) - 2.0) < 1e-15 && fabs(n[0] - 1.0) < 1e-15);
    set(x, 0.2, 0.0, 0.0), CHECK(fabs(yci_body_distance(&body, x, n) + 0.8) < 1e-15 && fabs(n[0] - 1.0) < 1e-15);
    set(x, -3.5, 5.5, 0.0);
    CHECK(fabs(yci_body_distance(&body, x, n) - (5.0 - 0.5)) < 1e-14 && fabs(n[0] + 0.6) < 1e-14);
    yci_body_free(&c, &body);

    memset(&p, 0, sizeof p);
    p.type = YC_ROUNDED_CONE, p.b[1] = 2.0, p.ra = p.rb = 0.5;
    CHECK(body_of(&c, &p, 1, 0.0, &body));
    set(x, 2.0, 1.0, 0.0), CHECK(fabs(yci_body_distance(&body, x, n) - 1.5) < 1e-15 && fabs(n[0] - 1.0) < 1e-15);
    set(x, 0.0, 3.0, 0.0), CHECK(fabs(yci_body_distance(&body, x, n) - 0.5) < 1e-15 && fabs(n[1] - 1.0) < 1e-15);
    set(x, 0.0, 1.0, 0.0);
    CHECK(fabs(yci_body_distance(&body, x, n) + 0.5) < 1e-15 && fabs(yci_norm(n) - 1.0) < 1e-12);
    yci_body_free(&c, &body);

    /* Rounded cones are unions of spheres: compare with many of them, nested and pointed ones too. */
    for (i = 0; i < 40; i++) {
        int j, k;
        memset(&p, 0, sizeof p);
        p.type = YC_ROUNDED_CONE;
        test_random_array(&seed, -1.0, 1.0, p.a, 3), test_random_array(&seed, -1.0, 1.0, p.b, 3);
        p.ra = test_random(&seed, 0.01, 1.0), p.rb = i % 4 == 0 ? 0.0 : test_random(&seed, 0.0, 1.0);
        if (i == 7) yci_copy(p.b, p.a);
        if (i == 8) yci_copy(p.b, p.a), p.rb = p.ra;
        CHECK(body_of(&c, &p, 1, 0.0, &body));
        for (k = 0; k < 50; k++) {
            double best = 1e9, y[3];
            test_random_array(&seed, -2.0, 2.0, x, 3);
            for (j = 0; j <= 2000; j++) {
                double t = j / 2000.0;
                yci_copy(y, x);
                yci_axpy(y, t - 1.0, p.a), yci_axpy(y, -t, p.b);
                best = yci_min(best, yci_norm(y) - (1.0 - t) * p.ra - t * p.rb);
            }
            d = yci_body_distance(&body, x, n);
            CHECK(d < best + 1e-12 && d > best - 1e-5);
            CHECK(fabs(yci_norm(n) - 1.0) < 1e-12 && gradient_error(&body, x, 1e-6) < 1e-5);
            CHECK(yci_body_bound(&body, x) <= yci_max(d, 0.0) + 1e-12);
        }
        yci_body_free(&c, &body);
    }
    CHECK(c.bytes == 0);
}

/* A loft whose sections vary much more than a body's, against points of its surface, caps included. */
TEST(contact_body_loft) {
    static const double stack[4][4] = {
        {0.0, 0.20, 0.10, 0.00}, {0.3, 0.15, 0.12, 0.03}, {0.5, 0.05, 0.05, 0.10}, {0.9, 0.10, 0.07, -0.05}};
    enum { POINTS = 30000 };
    double *cloud = (double *)malloc(sizeof(double) * 3 * POINTS), n[3], m[3], x[3], low = 9.0, high = 0.0, step = 0.0;
    double off = 0.0;
    uint64_t seed = 5;
    int i, j, round, flat = 0, creased = 0;
    yci_context c;
    yci_body_sdf body;
    yc_primitive p;
    CHECK_RESULT(yci_context_init(&c, NULL), YC_OK);
    for (round = 0; round < 3; round++) {
        memset(&p, 0, sizeof p);
        p.type = YC_LOFT, p.exponent = round == 0 ? 2.0 : round == 1 ? 2.3 : 6.0;
        p.sections = stack, p.section_count = 4;
        set(p.a, 0.01, -0.2, 0.02);
        CHECK(body_of(&c, &p, 1, 0.0, &body));
        /* Points of the surface as the public text defines it; d is nearly zero there. */
        for (i = 0; i < POINTS; i++) {
            double y = i % 4 ? test_random(&seed, 0.0, 0.9) : i % 8 ? 0.0 : 0.9, s[4], angle, cx, cz, f, t;
            double inner = i % 4 ? 1.0 : test_random(&seed, 0.0, 1.0);
            for (j = 0; j < 2 && y >= stack[j + 1][0]; j++) {}
            t = (y - stack[j][0]) / (stack[j + 1][0] - stack[j][0]);
            s[1] = stack[j][1] + t * (stack[j + 1][1] - stack[j][1]);
            s[2] = stack[j][2] + t * (stack[j + 1][2] - stack[j][2]);
            s[3] = stack[j][3] + t * (stack[j + 1][3] - stack[j][3]);
            angle = test_random(&seed, 0.0, 6.2831853), cx = cos(angle), cz = sin(angle);
            f = pow(pow(fabs(cx) / s[1], p.exponent) + pow(fabs(cz) / s[2], p.exponent), 1.0 / p.exponent);
            set(cloud + 3 * i, p.a[0] + inner * cx / f, p.a[1] + y, p.a[2] + s[3] + inner * cz / f);
            off = yci_max(off, fabs(yci_body_distance(&body, cloud + 3 * i, n)) / yci_min(s[1], s[2]));
        }
        for (i = 0; i < 400; i++) {
            double best = 1e9, d, e;
            test_random_array(&seed, -0.7, 0.7, x, 3);
            x[1] += 0.25;
            d = yci_body_distance(&body, x, n);
            for (j = 0; j < POINTS; j++) {
                yci_sub(m, x, cloud + 3 * j);
                best = yci_min(best, yci_dot(m, m));
            }
            best = sqrt(best);
            if (d > 0.02) low = yci_min(low, d / best), high = yci_max(high, d / best);
            if (d < 0.0) CHECK(-d < 1.5 * best + 0.01);
            CHECK(yci_body_bound(&body, x) <= yci_max(d, 0.0) + 1e-12);
            if (fabs(x[0] - p.a[0]) > 1e-3 && gradient_error(&body, x, 1e-6) > 1e-4) creased++;
            /* Lipschitz, over short and long steps */
            for (j = 0; j < 20; j++) {
                double y[3], size = j < 10 ? 1e-3 : 0.2;
                test_random_array(&seed, -size, size, m, 3);
                yci_add(y, x, m);
                e = fabs(yci_body_distance(&body, y, n) - d) / yci_norm(m);
                step = yci_max(step, e);
                if (e > 1.25) flat++;
            }
        }
        yci_body_free(&c, &body);
    }
    CHECK(low > 0.6 && high < 1.03);
    CHECK(step < 1.6 && flat < 240);
    CHECK(creased < 24);
    CHECK(off < 0.015);
    free(cloud);
    CHECK(c.bytes == 0);
}

/* A flat bar: its caps, its inside, where it is only as deep as its smaller half size, and two blended spheres. */
TEST(contact_body_depth) {
    static const double bar[2][4] = {{0.0, 0.3, 0.1, 0.0}, {1.0, 0.3, 0.1, 0.0}};
    yci_context c;
    yci_body_sdf body;
    yc_primitive p[2];
    double x[3], y[3], n[3], d, least = 9.0, most = 0.0, deepest = 0.0;
    uint64_t seed = 13;
    int i, j, inward = 0;
    CHECK_RESULT(yci_context_init(&c, NULL), YC_OK);
    memset(p, 0, sizeof p);
    p[0].type = YC_LOFT, p[0].exponent = 2.5, p[0].sections = bar, p[0].section_count = 2;
    CHECK(body_of(&c, p, 1, 0.0, &body));
    for (i = -1; i <= 1; i += 2)
        for (j = 0; j < 2; j++) {
            set(x, 0.05, (j ? 1.0 : 0.0) + 0.02 * i, 0.01);
            d = yci_body_distance(&body, x, n);
            CHECK(fabs(d - 0.02 * i * (j ? 1 : -1)) < 1e-15 && fabs(n[1] - (j ? 1.0 : -1.0)) < 1e-15);
        }
    for (i = 0; i < 2000; i++) {
        set(x, test_random(&seed, -0.3, 0.3), 0.5, test_random(&seed, -0.1, 0.1));
        if (i % 2) yci_scale(x, x, 0.02), x[1] = 0.5;
        d = yci_body_distance(&body, x, n);
        least = yci_min(least, yci_norm(n)), most = yci_max(most, yci_norm(n)), deepest = yci_min(deepest, d);
        inward += n[0] * x[0] + n[2] * x[2] <= 0.0;
        CHECK(gradient_error(&body, x, 1e-7) < 1e-3 || yci_norm(x) < 1e-3);
        test_random_array(&seed, -1e-4, 1e-4, y, 3);
        yci_add(y, y, x);
        CHECK(fabs(yci_body_distance(&body, y, n) - d) < 2.5e-4);
    }
    CHECK(deepest >= -0.105 && least > 0.1 && most < 1.3 && inward == 0);
    set(x, 0.0, 0.5, 0.0);
    CHECK(fabs(yci_body_distance(&body, x, n) + 0.1) < 1e-15 && yci_norm(n) < 1.0);
    yci_body_free(&c, &body);
    memset(p, 0, sizeof p);
    p[0].type = p[1].type = YC_SPHERE, p[0].ra = p[1].ra = 0.5;
    CHECK(body_of(&c, p, 2, 0.2, &body)); /* twice the same: a quarter of the blend is added */
    for (i = 0; i < 100; i++) {
        test_random_array(&seed, -0.7, 0.7, x, 3);
        d = yci_body_distance(&body, x, n);
        CHECK(fabs(d - (yci_norm(x) - 0.55)) < 1e-14 && yci_body_bound(&body, x) <= yci_max(d, 0.0));
    }
    set(x, 0.52, 0.0, 0.0);
    CHECK(yci_body_bound(&body, x) <= 0.0);
    yci_body_free(&c, &body);
    CHECK(c.bytes == 0);
}

TEST(contact_body_mannequin) {
    yci_context c;
    yci_body_sdf body;
    double x[3], y[3], n[3], m[3], shortest = 9.0, longest = 0.0, step = 0.0, worst = 0.0, d, e;
    uint64_t seed = 9;
    int i, j, weak = 0, creased = 0, total = 0;
    CHECK_RESULT(yci_context_init(&c, NULL), YC_OK);
    CHECK(mannequin(&c, &body));
    for (i = 0; i < 4000; i++) {
        test_random_array(&seed, -0.5, 0.5, x, 3);
        x[1] = test_random(&seed, 0.0, 1.7);
        if (fabs(yci_body_distance(&body, x, n)) > 0.3) continue;
        if (to_surface(&body, x) > 1e-6) continue;
        total++;
        test_random_array(&seed, -1.0, 1.0, m, 3);
        yci_axpy(x, 0.01 / yci_norm(m), m); /* near the surface, both sides */
        d = yci_body_distance(&body, x, n), e = yci_norm(n);
        shortest = yci_min(shortest, e), longest = yci_max(longest, e);
        if (e < 0.6) weak++;
        if (gradient_error(&body, x, 1e-7) > 1e-4) creased++;
        for (j = 0; j < 10; j++) {
            test_random_array(&seed, -1.0, 1.0, m, 3);
            yci_scale(m, m, (j < 5 ? 1e-5 : 0.02) / yci_norm(m));
            yci_add(y, x, m);
            step = yci_max(step, fabs(yci_body_distance(&body, y, n) - d) / yci_norm(m));
        }
    }
    CHECK(total > 2000);
    CHECK(longest <= 1.2 && step <= 1.2);
    CHECK(shortest > 0.3 && weak <= total / 200); /* creases between arm and chest, between the thighs */
    CHECK(creased <= total / 100);
    /* Far away the distance neither exceeds the true one nor collapses. */
    for (i = 0; i < 300; i++) {
        double far = i < 150 ? 3.0 : 1000.0, lower = 0.0;
        test_random_array(&seed, -1.0, 1.0, x, 3);
        yci_scale(x, x, far / yci_norm(x));
        d = yci_body_distance(&body, x, n);
        for (j = 0; j < 3; j++) {
            double gap = yci_max(yci_max(body.lo[j] - x[j], x[j] - body.hi[j]), 0.0);
            lower += gap * gap;
        }
        CHECK(d > sqrt(lower) - 0.04 && d < far + 2.0 && yci_norm(n) > 0.6 && yci_norm(n) < 1.2);
    }
    /* Skipping shapes by their boxes changes nothing. */
    for (i = 0; i < 2000; i++) {
        double keep[6];
        yci_primitive *q;
        test_random_array(&seed, -0.8, 0.8, x, 3);
        x[1] += 0.8;
        d = yci_body_distance(&body, x, n);
        e = 1e300;
        for (j = 0; j < body.primitive_count; j++) {
            double bound, other, h;
            q = body.primitive + j;
            memcpy(keep, q->lo, sizeof q->lo);
            bound = yci_bounds_squared(q->lo, q->hi, x);
            other = yci_primitive_distance(q, body.section, x, bound, m);
            h = yci_max(0.03 - fabs(e - other), 0.0) / 0.03;
            e = yci_min(e, other) - 0.25 * 0.03 * h * h;
        }
        worst = yci_max(worst, fabs(d - e));
    }
    CHECK(worst < 1e-14);
    yci_body_free(&c, &body);
    CHECK(c.bytes == 0);
}

/* A moved body is the same body seen from elsewhere, and its motion is that of its material points. */
TEST(contact_body_pose) {
    yci_context c;
    yci_body_sdf still, moved;
    double r[9], t[3], p[3], x[3], n[3], m[3], y[3], last[9], place[3];
    uint64_t seed = 3;
    int i, j;
    CHECK_RESULT(yci_context_init(&c, NULL), YC_OK);
    CHECK(mannequin(&c, &still) && mannequin(&c, &moved));
    random_rotation(&seed, last), test_random_array(&seed, -1.0, 1.0, place, 3);
    yci_body_move(&moved, last, place);
    random_rotation(&seed, r), test_random_array(&seed, -1.0, 1.0, t, 3);
    yci_body_move(&moved, r, t);
    for (i = 0; i < 200; i++) {
        test_random_array(&seed, -0.5, 0.5, p, 3);
        p[1] += 1.0;
        for (j = 0; j < 3; j++) x[j] = yci_dot(r + 3 * j, p) + t[j], y[j] = yci_dot(last + 3 * j, p) + place[j];
        CHECK(fabs(yci_body_distance(&still, p, n) - yci_body_distance(&moved, x, m)) < 1e-12);
        for (j = 0; j < 3; j++) CHECK(fabs(yci_dot(r + 3 * j, n) - m[j]) < 1e-8);
        yci_body_motion(&moved, x, m);
        yci_sub(y, x, y), yci_sub(y, y, m);
        CHECK(yci_norm(y) < 1e-13);
        CHECK(yci_body_bound(&moved, x) <= yci_max(yci_body_distance(&moved, x, m), 0.0));
    }
    yci_body_free(&c, &still), yci_body_free(&c, &moved);
    CHECK(c.bytes == 0);
}

static int refused_body(yci_context *c, const yc_body_desc *desc, const char *word) {
    yci_body_sdf body, before;
    memset(&body, 0x5a, sizeof body);
    before = body;
    if (yci_body_init(c, desc, &body) != YC_ERROR_ARGUMENT) return 0;
    return strstr(c->message, word) != NULL && !memcmp(&body, &before, sizeof body) && c->bytes == 0;
}

TEST(contact_body_refuses) {
    static const double good[2][4] = {{0.0, 0.1, 0.1, 0.0}, {0.5, 0.1, 0.1, 0.0}};
    const double nan_ = sqrt(-1.0), infinite = 1e200 * 1e200;
    double bad[2][4];
    yci_context c;
    yci_body_sdf body;
    yc_body_desc desc = yc_body_desc_default();
    yc_primitive p[2];
    yc_host host;
    int i, j;
    CHECK_RESULT(yci_context_init(&c, NULL), YC_OK);
    CHECK(desc.friction == 0.3 && desc.smooth_radius == 0.0 && desc.primitive_count == 0 && !desc.primitives);
    memset(p, 0, sizeof p);
    p[0].type = YC_SPHERE, p[0].ra = 1.0;
    p[1] = p[0];
    desc.primitive_count = 2, desc.primitives = p;
    CHECK_RESULT(yci_body_init(&c, &desc, &body), YC_OK);
    yci_body_free(&c, &body);
#define REFUSED(change, word, undo) (change, CHECK(refused_body(&c, &desc, word)), undo)
    REFUSED(desc.cookie++, "cookie", desc.cookie--);
    REFUSED(desc.primitive_count = 0, "primitive_count is 0", desc.primitive_count = 2);
    REFUSED(desc.primitive_count = -4, "primitive_count is -4", desc.primitive_count = 2);
    REFUSED(desc.primitives = NULL, "primitives is NULL", desc.primitives = p);
    REFUSED(desc.smooth_radius = -1.0, "smooth_radius is -1", desc.smooth_radius = 0.0);
    REFUSED(desc.smooth_radius = nan_, "smooth_radius", desc.smooth_radius = 0.0);
    REFUSED(desc.friction = -0.1, "friction is -0.1", desc.friction = 0.3);
    REFUSED(desc.friction = 10.5, "friction is 10.5", desc.friction = 0.3);
    REFUSED(p[1].type = (yc_primitive_type)(YC_LOFT + 1), "primitives[1].type", p[1].type = YC_SPHERE);
    REFUSED(p[1].a[2] = nan_, "primitives[1].a[2]", p[1].a[2] = 0.0);
    REFUSED(p[1].a[1] = infinite, "primitives[1].a[1] is inf", p[1].a[1] = 0.0);
    REFUSED(p[1].ra = 0.0, "primitives[1].ra is 0", p[1].ra = 1.0);
    REFUSED(p[1].ra = -2.0, "primitives[1].ra is -2", p[1].ra = 1.0);
    p[1].type = YC_ROUNDED_CONE;
    REFUSED(p[1].rb = -2.0, "primitives[1].rb is -2", p[1].rb = 1.0);
    REFUSED(p[1].rb = nan_, "primitives[1].rb", p[1].rb = 1.0);
    REFUSED(p[1].ra = p[1].rb = 0.0, "primitives[1].ra + rb", p[1].ra = p[1].rb = 1.0);
    REFUSED(p[1].b[0] = infinite, "primitives[1].b[0] is inf", p[1].b[0] = 1.0);
    p[1].type = YC_BOX;
    REFUSED(p[1].b[1] = 0.0, "primitives[1].b[1] is 0", p[1].b[1] = 2.0);
    REFUSED(p[1].b[2] = -1.0, "primitives[1].b[2] is -1", p[1].b[2] = 2.0);
    REFUSED(p[1].ra = 1.5, "primitives[1].ra is 1.5", p[1].ra = 0.0);
    REFUSED(p[1].ra = nan_, "primitives[1].ra", p[1].ra = 0.0);
    p[1].type = YC_PLANE;
    REFUSED(set(p[1].b, 0.0, 0.0, 0.0), "primitives[1].b is 0", set(p[1].b, 0.0, 1.0, 0.0));
    p[1].type = YC_LOFT, p[1].exponent = 2.0, p[1].section_count = 2;
    REFUSED((void)0, "primitives[1].sections is NULL", p[1].sections = good);
    REFUSED(p[1].section_count = 1, "section_count is 1", p[1].section_count = 2);
    REFUSED(p[1].exponent = 1.9, "exponent is 1.9", p[1].exponent = 2.0);
    REFUSED(p[1].exponent = nan_, "exponent", p[1].exponent = 2.0);
    for (i = 0; i < 2; i++)
        for (j = 0; j < 4; j++) {
            char word[80];
            memcpy(bad, good, sizeof bad);
            bad[i][j] = nan_;
            p[1].sections = (const double(*)[4])bad;
            snprintf(word, sizeof word, "primitives[1].sections[%d][%d]", i, j);
            CHECK(refused_body(&c, &desc, word));
        }
    memcpy(bad, good, sizeof bad), bad[1][0] = 0.0;
    CHECK(refused_body(&c, &desc, "sections[1][0] (height) is 0"));
    memcpy(bad, good, sizeof bad), bad[1][2] = 0.0;
    CHECK(refused_body(&c, &desc, "sections[1][2] (half depth) is 0"));
    p[1].sections = good;
#undef REFUSED
    for (i = 0; i < 10; i++) {
        host = test_host_failing(i);
        CHECK_RESULT(yci_context_init(&c, &host), YC_OK);
        if (yci_body_init(&c, &desc, &body) == YC_OK) break;
        CHECK(test_heap.live == 0 && c.bytes == 0);
    }
    CHECK(i == 2);
    yci_body_free(&c, &body);
    CHECK(test_heap.live == 0 && c.bytes == 0);
}

/* ---- closest points ---------------------------------------------------------------------------------------------- */

static double relative(const double *x, const double *w, int count, double *rel) {
    int i;
    set(rel, 0.0, 0.0, 0.0);
    for (i = 0; i < count; i++) yci_axpy(rel, w[i], x + 3 * i);
    return yci_norm(rel);
}

/* Sampling on a grid, then again around its best point. `kind` as in a pair. */
static double sampled(int kind, const double *x) {
    double best = 1e9, cs = 0.5, ct = 0.5, half = 0.5;
    int i, j, level;
    for (level = 0; level < 6; level++) {
        double ns = cs, nt = ct;
        for (i = 0; i <= 20; i++)
            for (j = 0; j <= 20; j++) {
                double s = yci_clamp(cs + half * (i - 10) / 10.0, 0.0, 1.0);
                double t = yci_clamp(ct + half * (j - 10) / 10.0, 0.0, 1.0);
                double w[4], rel[3], d;
                if (kind == YCI_EDGE_EDGE) w[0] = 1.0 - s, w[1] = s, w[2] = t - 1.0, w[3] = -t;
                else {
                    if (s + t > 1.0) t = 1.0 - s;
                    w[0] = 1.0, w[1] = s + t - 1.0, w[2] = -s, w[3] = -t;
                }
                d = relative(x, w, 4, rel);
                if (d < best) best = d, ns = s, nt = t;
            }
        cs = ns, ct = nt, half *= 0.3;
    }
    return best;
}

static double closest(int kind, const double *x, double *n, double *w) {
    yci_pair pair;
    int i;
    for (i = 0; i < 4; i++) pair.node[i] = i;
    pair.kind = kind, pair.thickness = 0.0;
    return yci_pair_distance(&pair, x, n, w);
}

TEST(contact_closest_points) {
    uint64_t seed = 11;
    int round, i, j, kind;
    for (round = 0; round < 4000; round++) {
        double x[12], y[12], n[3], w[4], rel[3], d, e, sum = 0.0, m[3], v[4], slack;
        for (i = 0; i < 4; i++) test_random_array(&seed, -1.0, 1.0, x + 3 * i, 3);
        kind = round % 2;
        for (i = 0; round % 7 == 3 && i < 3; i++) x[9 + i] = x[6 + i] + x[3 + i] - x[i];   /* parallel edges */
        for (i = 0; round % 13 == 3 && i < 3; i++) x[9 + i] = 0.5 * (x[3 + i] + x[6 + i]); /* in line */
        for (i = 0; round % 17 == 3 && i < 12; i++) x[i] = floor(2.0 * x[i]);              /* ties of all kinds */
        if (round % 11 == 3) yci_copy(x + 9, x + 6);                                       /* degenerate */
        slack = 1e-12;
        if (round % 5 == 3) { /* nearly parallel: the crossing is given up below an angle of 1e-5 */
            double tilt = pow(10.0, -test_random(&seed, 3.0, 9.0));
            for (i = 0; i < 3; i++) x[9 + i] = x[6 + i] + x[3 + i] - x[i] + test_random(&seed, -tilt, tilt);
            slack = 5e-5;
        }
        d = closest(kind, x, n, w);
        e = sampled(kind, x);
        CHECK(d <= e + slack && d > e - 2e-3);
        for (i = 0; i < 4; i++) {
            sum += w[i];
            CHECK((i < yci_pair_side(kind) ? w[i] : -w[i]) > -1e-12 && fabs(w[i]) < 1.0 + 1e-12);
        }
        CHECK(fabs(sum) < 1e-14 && fabs(yci_norm(n) - 1.0) < 1e-12);
        CHECK(fabs(relative(x, w, 4, rel) - d) < 1e-10);
        yci_axpy(rel, -d, n);
        CHECK(yci_norm(rel) < 1e-10);
        /* the same whichever way the nodes are listed */
        memcpy(y, x, sizeof y);
        if (kind == YCI_EDGE_EDGE)
            for (i = 0; i < 6; i++) y[i] = x[6 + i], y[6 + i] = x[i];
        else
            for (i = 0; i < 3; i++) y[3 + i] = x[6 + i], y[6 + i] = x[9 + i], y[9 + i] = x[3 + i];
        CHECK(fabs(closest(kind, y, m, v) - d) <= slack);
        if (kind == YCI_EDGE_EDGE) {
            for (i = 0; i < 3; i++) y[i] = x[3 + i], y[3 + i] = x[i], y[6 + i] = x[6 + i], y[9 + i] = x[9 + i];
            CHECK(fabs(closest(kind, y, m, v) - d) <= slack);
        }
        e = yci_closest_point_point(x, x + 3, n, w);
        yci_sub(rel, x, x + 3);
        CHECK(fabs(e - yci_norm(rel)) < 1e-15 && w[0] + w[1] == 0.0);
    }
    /* Touching: a direction all the same, of length one. */
    for (kind = 0; kind < 3; kind++)
        for (round = 0; round < 6; round++) {
            double x[12], n[3], w[4], d;
            memset(x, 0, sizeof x);
            if (round == 1) x[6] = 1.0, x[10] = 1.0; /* point on a corner; edges that share an end */
            if (round == 2) x[0] = -1.0, x[3] = 1.0, x[7] = -1.0, x[10] = 1.0; /* crossing edges */
            if (round == 3) x[3] = 1.0, x[9] = 1.0;                            /* edges in one */
            if (round == 4) x[3] = -1.0, x[6] = 1.0, x[10] = 1.0;              /* point on an edge */
            if (round == 5)
                for (j = 0; j < 12; j++) x[j] = 1e-160 * j;
            d = closest(kind, x, n, w);
            CHECK(d >= 0.0 && d < 2.5 && fabs(yci_norm(n) - 1.0) < 1e-12);
        }
}

/* ---- elements ---------------------------------------------------------------------------------------------------- */

static double pair_energy(int kind, const double *x, double thickness, double k, double *gradient, double *hessian) {
    double n[3], w[4], g[3], h[9], lambda, energy, d = closest(kind, x, n, w);
    energy = yci_contact_normal(d, n, thickness, k, &lambda, g, h);
    memset(gradient, 0, sizeof(double) * 12), memset(hessian, 0, sizeof(double) * 144);
    yci_contact_spread(yci_pair_nodes(kind), w, g, h, gradient, hessian);
    return energy;
}

/* Sixth-order central differences. */
static const double stencil[3] = {0.75, -0.15, 1.0 / 60.0};

TEST(contact_elements) {
    uint64_t seed = 21;
    int round, i, j, k, kind, compared = 0;
    for (round = 0; round < 600; round++) {
        double x[12], g[12], h[144], other[12], scratch[144], far, worst = 0.0, size = 0.0, stiffness = 50.0;
        int near_kink = 0;
        kind = round % 3;
        for (i = 0; i < 4; i++) test_random_array(&seed, -0.5, 0.5, x + 3 * i, 3);
        CHECK(pair_energy(kind, x, 1.0, stiffness, g, h) >= 0.0);
        far = 1.0 - closest(kind, x, other, scratch); /* the law is only C2 at both ends of its share, d at 0 */
        near_kink = fabs(far) < 0.01 || fabs(far - YCI_CONTACT_SHARE) < 0.01 || far > 0.99;
        CHECK(test_lowest_eigenvalue(h, kind == YCI_POINT_POINT ? 6 : 12, NULL) > -1e-10);
        for (i = 0; i < (kind == YCI_POINT_POINT ? 6 : 12); i++) {
            double slope = 0.0, keep = x[i], step = 1e-3, once[12], w[4], v[4], n[3];
            closest(kind, x, n, w);
            for (j = 1; j <= 3; j++)
                for (k = -1; k <= 1; k += 2) {
                    x[i] = keep + k * j * step;
                    slope += k * stencil[j - 1] * pair_energy(kind, x, 1.0, stiffness, once, scratch) / step;
                    closest(kind, x, n, v);
                    for (far = 0.0; far < 3.5; far += 1.0) /* a vertex, edge or face took over: only C1 there */
                        if ((fabs(w[(int)far]) < 1e-14) != (fabs(v[(int)far]) < 1e-14)) near_kink = 1;
                }
            x[i] = keep;
            other[i] = slope;
            size = yci_max(size, fabs(g[i]));
            worst = yci_max(worst, fabs(slope - g[i]));
        }
        CHECK(other[0] == other[0]);
        if (near_kink || size < 1e-3) continue;
        compared++;
        CHECK(worst < 1e-6 * (1.0 + size));
    }
    CHECK(compared > 300);

    /* One point against the mannequin, as a scene uses it. */
    {
        yci_context c;
        yci_body_sdf body;
        CHECK(yci_context_init(&c, NULL) == YC_OK && mannequin(&c, &body));
        for (round = 0; round < 300; round++) {
            double x[3], n[3], m[3], y[3], g[3], h[9], u[3], lambda, slope, hs[9], gs[3], ls;
            test_random_array(&seed, -0.3, 0.3, x, 3);
            x[1] += 1.1;
            if (to_surface(&body, x) > 1e-9 || gradient_error(&body, x, 1e-4) > 1e-3) continue;
            yci_contact_normal(yci_body_distance(&body, x, n), n, 0.003, 1e3, &lambda, g, h);
            CHECK(lambda > 0.0 && test_lowest_eigenvalue(h, 3, NULL) > -1e-9);
            for (i = 0; i < 3; i++) {
                for (slope = 0.0, j = 1; j <= 3; j++)
                    for (k = -1; k <= 1; k += 2) {
                        yci_copy(y, x);
                        y[i] += k * j * 1e-5;
                        slope += k * stencil[j - 1] / 1e-5 *
                            yci_contact_normal(yci_body_distance(&body, y, m), m, 0.003, 1e3, &ls, gs, hs);
                    }
                CHECK(fabs(slope - g[i]) < 1e-2 * lambda);
            }
            yci_body_motion(&body, x, u);
            CHECK(yci_norm(u) == 0.0);
        }
        yci_body_free(&c, &body);
    }
}

TEST(contact_friction) {
    uint64_t seed = 31;
    int round, i, j, k, r;
    double g[3], h[9], u[3], n[3], once[3], more[9];
    for (round = 0; round < 400; round++) {
        double eps = 0.01, limit = 3.0, length = round % 4 == 0 ? 0.002 : 0.05, energy, slip;
        do test_random_array(&seed, -1.0, 1.0, n, 3);
        while (yci_norm(n) < 0.1);
        yci_scale(n, n, 1.0 / yci_norm(n));
        test_random_array(&seed, -length, length, u, 3);
        energy = yci_contact_friction(u, n, limit, eps, g, h);
        CHECK(energy >= 0.0 && fabs(yci_dot(g, n)) < 1e-14 && yci_norm(g) <= limit * (1.0 + 1e-14));
        CHECK(test_lowest_eigenvalue(h, 3, NULL) > -1e-10);
        slip = sqrt(yci_max(yci_dot(u, u) - yci_dot(u, n) * yci_dot(u, n), 0.0));
        if (slip > eps) CHECK(fabs(yci_norm(g) - limit) < 1e-12);
        else CHECK(fabs(yci_norm(g) - limit * slip / eps) < 1e-12);
        if (fabs(slip - eps) < 1e-3) continue;
        for (i = 0; i < 3; i++) {
            double slope = 0.0, row[3] = {0.0, 0.0, 0.0}, keep = u[i], step = 1e-4;
            for (j = 1; j <= 3; j++)
                for (k = -1; k <= 1; k += 2) {
                    u[i] = keep + k * j * step;
                    slope += k * stencil[j - 1] / step * yci_contact_friction(u, n, limit, eps, once, more);
                    yci_axpy(row, k * stencil[j - 1] / step, once);
                }
            u[i] = keep;
            CHECK(fabs(slope - g[i]) < 1e-7 * limit);
            for (r = 0; r < 3; r++) CHECK(fabs(row[r] - h[3 * r + i]) < 1e-6 * limit / eps);
        }
    }
    set(u, 0.0, 0.0, 0.0), set(n, 0.0, 1.0, 0.0);
    CHECK(yci_contact_friction(u, n, 2.0, 0.1, g, h) == 0.0 && yci_norm(g) == 0.0 && h[0] == 20.0 && h[4] == 0.0);
    CHECK(yci_contact_friction(u, n, 0.0, 0.1, g, h) == 0.0 && h[0] == 0.0);
}

/* ---- broad phase ------------------------------------------------------------------------------------------------- */

typedef struct {
    yci_pairs_input in;
    double *x, *triangle_radius, *edge_radius, *point_radius;
    int *triangle, *edge, *point;
    unsigned char *sphere;
} soup;

static void *zeroed(int count, size_t size) { return calloc((size_t)count + 1, size); }

static void soup_new(soup *s, int nodes, int triangles, int edges, int points) {
    memset(s, 0, sizeof *s);
    s->x = (double *)zeroed(3 * nodes, sizeof(double));
    s->triangle = (int *)zeroed(3 * triangles, sizeof(int)), s->edge = (int *)zeroed(2 * edges, sizeof(int));
    s->point = (int *)zeroed(points, sizeof(int)), s->sphere = (unsigned char *)zeroed(points, 1);
    s->triangle_radius = (double *)zeroed(triangles, sizeof(double));
    s->edge_radius = (double *)zeroed(edges, sizeof(double));
    s->point_radius = (double *)zeroed(points, sizeof(double));
    s->in.node_count = nodes, s->in.triangle_count = triangles, s->in.edge_count = edges, s->in.point_count = points;
    s->in.x = s->x, s->in.triangle = s->triangle, s->in.edge = s->edge, s->in.point = s->point;
    s->in.triangle_radius = s->triangle_radius, s->in.edge_radius = s->edge_radius;
    s->in.point_radius = s->point_radius, s->in.sphere = s->sphere;
}

static void soup_free(soup *s) {
    free(s->x), free(s->triangle), free(s->edge), free(s->point), free(s->sphere);
    free(s->triangle_radius), free(s->edge_radius), free(s->point_radius);
}

/* Small triangles here and there; every fifth much larger when `mixed`. Edges are those of the triangles, and every
 * node is a point. */
static void soup_random(soup *s, uint64_t *seed, int triangles, double box, int mixed) {
    int i, j, k;
    double centre[3];
    soup_new(s, 3 * triangles, triangles, 3 * triangles, 3 * triangles);
    for (i = 0; i < triangles; i++) {
        double size = mixed && i % 5 == 0 ? 0.5 : 0.05;
        test_random_array(seed, 0.0, box, centre, 3);
        for (j = 0; j < 3; j++) {
            test_random_array(seed, -size, size, s->x + 9 * i + 3 * j, 3);
            yci_axpy(s->x + 9 * i + 3 * j, 1.0, centre);
            s->triangle[3 * i + j] = s->point[3 * i + j] = 3 * i + j;
            s->edge[6 * i + 2 * j] = 3 * i + j, s->edge[6 * i + 2 * j + 1] = 3 * i + (j + 1) % 3;
            s->edge_radius[3 * i + j] = test_random(seed, 0.0, 0.02);
            s->point_radius[3 * i + j] = test_random(seed, 0.0, 0.02);
            s->sphere[3 * i + j] = (unsigned char)((i + j) % 2);
        }
        s->triangle_radius[i] = test_random(seed, 0.0, 0.02);
        k = mixed && i ? 3 * (i - 1) : 3 * i; /* some share a node */
        s->triangle[3 * i] = k;
    }
    s->in.margin = 0.01;
}

static int compare(const void *a, const void *b) {
    const yci_pair *p = (const yci_pair *)a, *q = (const yci_pair *)b;
    return yci_pair_before(p, q) ? -1 : yci_pair_before(q, p) ? 1 : 0;
}

static void sort(int *k, int count) {
    int i, j, t;
    for (i = 0; i < count; i++)
        for (j = i + 1; j < count; j++)
            if (k[j] < k[i]) t = k[i], k[i] = k[j], k[j] = t;
}

/* Every pair tried; the canonical order written out anew. */
static int brute_force(const yci_pairs_input *in, yci_pair *out) {
    int i, j, r, t, kind, count = 0, limit[2];
    for (kind = 0; kind < 3; kind++) {
        limit[0] = kind == YCI_EDGE_EDGE ? in->edge_count : in->point_count;
        limit[1] = kind == YCI_POINT_TRIANGLE ? in->triangle_count : limit[0];
        for (i = 0; i < limit[0]; i++)
            for (j = kind == YCI_POINT_TRIANGLE ? 0 : i + 1; j < limit[1]; j++) {
                yci_pair p;
                double n[3], w[4];
                p.kind = kind;
                if (kind == YCI_POINT_TRIANGLE) {
                    p.node[0] = in->point[i];
                    for (r = 0; r < 3; r++) p.node[1 + r] = in->triangle[3 * j + r];
                    sort(p.node + 1, 3);
                    p.thickness = in->point_radius[i] + in->triangle_radius[j];
                    if (p.node[0] == p.node[1] || p.node[0] == p.node[2] || p.node[0] == p.node[3]) continue;
                } else if (kind == YCI_EDGE_EDGE) {
                    for (r = 0; r < 2; r++) p.node[r] = in->edge[2 * i + r], p.node[2 + r] = in->edge[2 * j + r];
                    sort(p.node, 2), sort(p.node + 2, 2);
                    if (p.node[2] < p.node[0])
                        for (r = 0; r < 2; r++) t = p.node[r], p.node[r] = p.node[2 + r], p.node[2 + r] = t;
                    p.thickness = in->edge_radius[i] + in->edge_radius[j];
                    if (p.node[0] == p.node[2] || p.node[0] == p.node[3]) continue;
                    if (p.node[1] == p.node[2] || p.node[1] == p.node[3]) continue;
                } else {
                    if (!in->sphere || !in->sphere[i] || !in->sphere[j]) continue;
                    p.node[0] = in->point[i], p.node[1] = in->point[j], p.node[2] = p.node[3] = -1;
                    sort(p.node, 2);
                    p.thickness = in->point_radius[i] + in->point_radius[j];
                }
                if (yci_pair_distance(&p, in->x, n, w) >= p.thickness + in->margin) continue;
                if (in->exclude && in->exclude(in->exclude_user, &p)) continue;
                out[count++] = p;
            }
    }
    qsort(out, (size_t)count, sizeof *out, compare);
    return count;
}

static int same(const yci_pair *a, const yci_pair *b, int count) {
    int i;
    for (i = 0; i < count; i++)
        if (memcmp(a[i].node, b[i].node, sizeof a[i].node) || a[i].kind != b[i].kind ||
            a[i].thickness < b[i].thickness || a[i].thickness > b[i].thickness)
            return 0;
    return 1;
}

static void swap(void *a, void *b, size_t size) {
    char keep[64];
    memcpy(keep, a, size), memcpy(a, b, size), memcpy(b, keep, size);
}

/* Lists items, and the nodes within them, in another order. */
static void soup_shuffle(soup *s, uint64_t *seed) {
    int i, j, t;
    for (i = s->in.triangle_count - 1; i > 0; i--) {
        j = (int)test_random(seed, 0.0, i + 0.999);
        swap(s->triangle + 3 * i, s->triangle + 3 * j, 3 * sizeof(int));
        swap(s->triangle_radius + i, s->triangle_radius + j, sizeof(double));
        t = s->triangle[3 * i], s->triangle[3 * i] = s->triangle[3 * i + 2], s->triangle[3 * i + 2] = t;
    }
    for (i = s->in.edge_count - 1; i > 0; i--) {
        j = (int)test_random(seed, 0.0, i + 0.999);
        swap(s->edge + 2 * i, s->edge + 2 * j, 2 * sizeof(int));
        swap(s->edge_radius + i, s->edge_radius + j, sizeof(double));
        t = s->edge[2 * i], s->edge[2 * i] = s->edge[2 * i + 1], s->edge[2 * i + 1] = t;
    }
    for (i = s->in.point_count - 1; i > 0; i--) {
        j = (int)test_random(seed, 0.0, i + 0.999);
        swap(s->point + i, s->point + j, sizeof(int));
        swap(s->point_radius + i, s->point_radius + j, sizeof(double));
        swap(s->sphere + i, s->sphere + j, 1);
    }
}

TEST(contact_pairs_find) {
    enum { MOST = 400000 };
    yci_pair *brute = (yci_pair *)malloc(sizeof(yci_pair) * MOST);
    uint64_t seed = 41;
    int round, count, kinds[3], i;
    for (round = 0; round < 8; round++) {
        yci_context c, other;
        yc_host host = test_host_counting(), workers = test_host_threads(round % 2 ? 3 : 0);
        yci_pairs pairs, again;
        soup s;
        double *rest = NULL;
        memset(&pairs, 0, sizeof pairs), memset(&again, 0, sizeof again);
        CHECK_RESULT(yci_context_init(&c, &host), YC_OK);
        CHECK_RESULT(yci_context_init(&other, &workers), YC_OK);
        soup_random(&s, &seed, 200 + 20 * round, round == 7 ? 0.1 : 0.5 + 0.2 * round, round % 2);
        if (round == 3) s.in.sphere = NULL;
        if (round == 4)
            for (i = 0; i < 30; i++) s.x[3 * i] += 1e7; /* strays */
        if (round >= 5) {
            rest = (double *)malloc(sizeof(double) * 3 * (size_t)s.in.node_count);
            for (i = 0; i < 3 * s.in.node_count; i++) rest[i] = s.x[i] + test_random(&seed, -0.02, 0.02);
            s.in.exclude = yci_pairs_exclude_rest, s.in.exclude_user = rest;
        }
        count = brute_force(&s.in, brute);
        CHECK(count <= MOST);
        CHECK_RESULT(yci_pairs_find(&c, &s.in, &pairs), YC_OK);
        CHECK(pairs.count == count && same(pairs.pair, brute, count));
        CHECK_RESULT(yci_pairs_find(&other, &s.in, &again), YC_OK); /* in another order, or by three */
        CHECK(again.count == count && same(again.pair, brute, count));
        soup_shuffle(&s, &seed);
        CHECK_RESULT(yci_pairs_find(&c, &s.in, &again), YC_OK);
        CHECK(again.count == count && same(again.pair, brute, count));
        for (kinds[0] = kinds[1] = kinds[2] = i = 0; i < count; i++) kinds[brute[i].kind]++;
        CHECK(kinds[0] > 0 && kinds[1] > 0 && (kinds[2] > 0 || round == 3));
        yci_pairs_free(&c, &pairs), yci_pairs_free(&c, &again);
        soup_free(&s);
        free(rest);
    }
    free(brute);
}

TEST(contact_pairs_edge_cases) {
    yci_context c;
    yc_host host;
    yci_pairs pairs, before;
    soup s;
    uint64_t seed = 43;
    int i;
    memset(&pairs, 0, sizeof pairs);
    CHECK_RESULT(yci_context_init(&c, NULL), YC_OK);
    soup_new(&s, 0, 0, 0, 0);
    CHECK(yci_pairs_find(&c, &s.in, &pairs) == YC_OK && pairs.count == 0);
    yci_pairs_free(&c, &pairs);
    soup_free(&s);

    /* All nodes in one place, no extent at all, and the same item listed twice. */
    soup_new(&s, 6, 2, 2, 2);
    for (i = 0; i < 6; i++) s.triangle[i] = i;
    s.edge[0] = 0, s.edge[1] = 1, s.edge[2] = 3, s.edge[3] = 4, s.point[0] = s.point[1] = 3;
    s.sphere[0] = s.sphere[1] = 1;
    CHECK(yci_pairs_find(&c, &s.in, &pairs) == YC_OK && pairs.count == 0);
    s.in.margin = 1e-3;
    CHECK(yci_pairs_find(&c, &s.in, &pairs) == YC_OK && pairs.count == 2);
    s.point_radius[1] = 0.25; /* of what is listed twice the thicker one stays */
    CHECK(yci_pairs_find(&c, &s.in, &pairs) == YC_OK && pairs.count == 2 && pairs.pair[0].thickness == 0.25);
    s.point_radius[0] = 0.5;
    CHECK(yci_pairs_find(&c, &s.in, &pairs) == YC_OK && pairs.count == 2 && pairs.pair[0].thickness == 0.5);
    s.x[4] = sqrt(-1.0);
    before = pairs;
    CHECK(yci_pairs_find(&c, &s.in, &pairs) == YC_ERROR_ARGUMENT && strstr(c.message, "node 1"));
    CHECK(pairs.pair == before.pair && pairs.count == 2);
    yci_pairs_free(&c, &pairs);
    soup_free(&s);
    CHECK(c.bytes == 0);

    /* One triangle that is a thousand times larger than the others does not fill the memory. */
    soup_random(&s, &seed, 1000, 5.0, 0);
    for (i = 0; i < 9; i++) s.x[i] *= 1000.0;
    CHECK(yci_pairs_find(&c, &s.in, &pairs) == YC_OK && c.peak < 20000000);
    yci_pairs_free(&c, &pairs);
    soup_free(&s);

    /* Every allocation may fail; then nothing changes and nothing leaks. */
    soup_random(&s, &seed, 300, 0.2, 1);
    host = test_host_counting();
    CHECK_RESULT(yci_context_init(&c, &host), YC_OK);
    CHECK(yci_pairs_find(&c, &s.in, &pairs) == YC_OK && test_heap.live == 1);
    for (i = 0; i < 100; i++) {
        before = pairs;
        test_heap_grant(i);
        if (yci_pairs_find(&c, &s.in, &pairs) == YC_OK) break;
        CHECK(test_heap.live == 1 && pairs.pair == before.pair && pairs.count == before.count);
        CHECK(strstr(c.message, "out of memory") != NULL);
    }
    CHECK(i > 10 && i < 100);
    yci_pairs_free(&c, &pairs);
    CHECK(test_heap.live == 0 && c.bytes == 0);
    soup_free(&s);
}

/* ---- step limit -------------------------------------------------------------------------------------------------- */

/* Does the edge pq pass through the triangle abc? By signed volumes, for points in general position. */
static double volume(const double *a, const double *b, const double *c, const double *d) {
    double u[3], v[3], w[3];
    yci_sub(u, b, a), yci_sub(v, c, a), yci_sub(w, d, a);
    yci_cross(u, u, v);
    return yci_dot(u, w);
}

static int intersections(const soup *s, const double *x) {
    int i, j, count = 0;
    for (i = 0; i < s->in.edge_count; i++)
        for (j = 0; j < s->in.triangle_count; j++) {
            const int *e = s->edge + 2 * i, *t = s->triangle + 3 * j;
            const double *p = x + 3 * e[0], *q = x + 3 * e[1], *a = x + 3 * t[0], *b = x + 3 * t[1], *c = x + 3 * t[2];
            double u, v, w;
            if (e[0] == t[0] || e[0] == t[1] || e[0] == t[2] || e[1] == t[0] || e[1] == t[1] || e[1] == t[2]) continue;
            if ((volume(a, b, c, p) > 0.0) == (volume(a, b, c, q) > 0.0)) continue;
            u = volume(p, q, a, b), v = volume(p, q, b, c), w = volume(p, q, c, a);
            if ((u > 0.0 && v > 0.0 && w > 0.0) || (u < 0.0 && v < 0.0 && w < 0.0)) count++;
        }
    return count;
}

/* A few loose triangles that start apart and are thrown at each other. */
TEST(contact_pair_step_limit) {
    enum { TRIANGLES = 16, NODES = 3 * TRIANGLES };
    uint64_t seed = 51;
    int round, i, j, sample, crossed = 0, would_cross = 0, shortened = 0;
    yci_context c;
    CHECK_RESULT(yci_context_init(&c, NULL), YC_OK);
    for (round = 0; round < 30; round++) {
        soup s;
        yci_pairs pairs;
        double dx[3 * NODES], y[3 * NODES], done = 0.0;
        memset(&pairs, 0, sizeof pairs);
        soup_random(&s, &seed, TRIANGLES, 0.2, 0);
        for (i = 0; i < TRIANGLES; i++) /* apart by construction: each in a cell of its own */
            for (j = 0; j < 9; j++) {
                int cell[3];
                cell[0] = i % 4, cell[1] = i / 4 % 2, cell[2] = i / 8;
                s.x[9 * i + j] = 0.1 * cell[j % 3] + test_random(&seed, 0.005, 0.095);
            }
        for (i = 0; i < NODES; i++) s.edge_radius[i] = s.point_radius[i] = 0.001;
        for (i = 0; i < TRIANGLES; i++) s.triangle_radius[i] = 0.001;
        s.in.margin = 0.05;
        CHECK(intersections(&s, s.x) == 0);
        for (i = 0; i < 3 * NODES; i++) dx[i] = test_random(&seed, -0.3, 0.3);
        for (sample = 1; sample <= 20; sample++) {
            for (i = 0; i < 3 * NODES; i++) y[i] = s.x[i] + dx[i] * sample / 20.0;
            would_cross += intersections(&s, y) > 0;
        }
        for (i = 0; i < 40 && done < 1.0; i++) {
            double t, largest = 0.0, n[3], w[4], close = 1e9;
            CHECK_RESULT(yci_pairs_find(&c, &s.in, &pairs), YC_OK);
            for (j = 0; j < NODES; j++) largest = yci_max(largest, yci_norm(dx + 3 * j));
            for (j = 0; j < 3 * NODES; j++) y[j] = dx[j] * yci_min(1.0 - done, 0.5 * s.in.margin / largest);
            t = yci_pair_step_limit(pairs.pair, pairs.count, s.x, y);
            CHECK(t > 0.0 && t <= 1.0);
            shortened += t < 1.0;
            for (j = 0; j < pairs.count; j++)
                close = yci_min(close, yci_pair_distance(pairs.pair + j, s.x, n, w) / pairs.pair[j].thickness);
            if (close < 0.05) break; /* from here on the floor rules, and the penalty is what holds */
            for (sample = 1; sample <= 5; sample++) {
                double z[3 * NODES];
                for (j = 0; j < 3 * NODES; j++) z[j] = s.x[j] + t * y[j] * sample / 5.0;
                crossed += intersections(&s, z);
                if (sample == 5) {
                    CHECK(yci_pairs_drift(NODES, s.x, z) <= 0.5 * s.in.margin * (1.0 + 1e-12));
                    for (j = 0; j < pairs.count; j++)
                        CHECK(yci_pair_distance(pairs.pair + j, z, n, w) >=
                            0.599 * yci_pair_distance(pairs.pair + j, s.x, n, w));
                    memcpy(s.x, z, sizeof z);
                }
            }
            done += t * yci_min(1.0 - done, 0.5 * s.in.margin / largest);
        }
        yci_pairs_free(&c, &pairs);
        soup_free(&s);
    }
    CHECK(would_cross > 50 && crossed == 0 && shortened > 50);
    {
        double x[6] = {0.0, 0.0, 0.0, 1.0, 0.0, 0.0}, dx[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
        yci_pair pair;
        pair.node[0] = 0, pair.node[1] = 1, pair.node[2] = pair.node[3] = -1;
        pair.kind = YCI_POINT_POINT, pair.thickness = 0.5;
        CHECK(yci_pair_step_limit(&pair, 1, x, dx) == 1.0 && yci_pair_step_limit(&pair, 0, x, dx) == 1.0);
        dx[0] = 4.0;
        CHECK(fabs(yci_pair_step_limit(&pair, 1, x, dx) - 0.1) < 1e-15);
        x[3] = 0.0;
        CHECK(fabs(yci_pair_step_limit(&pair, 1, x, dx) - 0.0025) < 1e-15);
    }
    CHECK(c.bytes == 0);
}
