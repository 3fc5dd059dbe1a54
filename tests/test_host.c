/* Names of results, memory, parallel loops, vectors and the one-sided law. */

#include "internals.h"
#include "test.h"
#include <math.h>
#include <string.h>

TEST(host_result_names) {
    CHECK_TEXT(yc_result_name(YC_OK), "YC_OK");
    CHECK_TEXT(yc_result_name(YC_ERROR_SINGULAR), "YC_ERROR_SINGULAR");
    CHECK_TEXT(yc_result_name(YC_ERROR_CANCELLED), "YC_ERROR_CANCELLED");
    CHECK_TEXT(yc_result_name((yc_result)-9), "unknown yc_result");
    CHECK_TEXT(yc_result_name((yc_result)1), "unknown yc_result");
    CHECK_TEXT(yc_event_name(YC_EVENT_LOOSE), "loose");
    CHECK_TEXT(yc_event_name(YC_EVENT_COUNT), "unknown yc_event_type");
    CHECK_TEXT(yc_term_name(YC_TERM_COUNT), "unknown yc_term");
    CHECK_TEXT(yc_version(), YC_VERSION);
}

/* Blocks are zeroed, aligned to 64 bytes, counted, and go back with their size, which the host checks. */
TEST(host_memory) {
    yc_host host = test_host_counting();
    yci_context c;
    unsigned char *block[20];
    volatile size_t most = (size_t)-1; /* what no compiler may see through */
    int i, k;
    CHECK_RESULT(yci_context_init(&c, &host), YC_OK);
    for (i = 0; i < 20; i++) {
        block[i] = YCI_NEW(&c, unsigned char, 7 * i);
        if (!CHECK(block[i] != NULL && ((size_t)block[i] & 63) == 0)) return;
        for (k = 0; k < 7 * i; k++) CHECK(block[i][k] == 0);
        memset(block[i], 0xa5, (size_t)(7 * i));
    }
    CHECK(c.bytes == 7 * 190 && c.peak == 7 * 190 && test_heap.live == 20);
    for (i = 0; i < 20; i++) yci_free(&c, block[(7 * i) % 20]);
    yci_free(&c, NULL);
    CHECK(c.bytes == 0 && c.peak == 7 * 190 && test_heap.live == 0 && test_heap.bytes == 0);
    CHECK(yci_alloc(&c, most / 4, 8) == NULL && yci_alloc(&c, 1, most) == NULL);
    host = test_host_failing(0);
    CHECK_RESULT(yci_context_init(&c, &host), YC_OK);
    CHECK(YCI_NEW(&c, double, 3) == NULL && c.bytes == 0);
}

TEST(host_wants_both_or_neither) {
    yc_host host = test_host_counting();
    yci_context c;
    host.free = NULL;
    CHECK_RESULT(yci_context_init(&c, &host), YC_ERROR_ARGUMENT);
    host = test_host_counting(), host.alloc = NULL;
    CHECK_RESULT(yci_context_init(&c, &host), YC_ERROR_ARGUMENT);
}

typedef struct {
    int visits[100], grain, bad;
} visited;

static void visit(void *arg, int begin, int end) {
    visited *v = (visited *)arg;
    int i;
    if (begin % v->grain || end - begin > v->grain) v->bad = 1;
    for (i = begin; i < end; i++) v->visits[i]++;
}

/* Every index once, in blocks whose bounds do not depend on the workers. */
TEST(host_parallel) {
    static const int grains[] = {1, 7, 50, 100, 1000};
    int workers, count, g, i;
    for (workers = -1; workers < 4; workers++)
        for (count = 0; count <= 100; count += 25)
            for (g = 0; g < 5; g++) {
                yc_host host = test_host_threads(workers < 0 ? 0 : workers);
                yci_context c;
                visited v;
                memset(&v, 0, sizeof v);
                v.grain = grains[g];
                CHECK_RESULT(yci_context_init(&c, workers < 0 ? NULL : &host), YC_OK);
                yci_parallel(&c, count, v.grain, visit, &v);
                for (i = 0; i < 100; i++) CHECK(v.visits[i] == (i < count));
                CHECK(!v.bad);
            }
}

/* Each derivative is that of the one before it; nothing jumps at 0 and at delta. */
TEST(vec_one_sided) {
    double delta = 0.3, h = 1e-5, t;
    int i;
    for (i = -20; i < 60; i++) {
        double a[3], b[3], c[3];
        t = 0.0201 * i;
        yci_one_sided(t - h, delta, &a[0], &a[1], &a[2]);
        yci_one_sided(t, delta, &b[0], &b[1], &b[2]);
        yci_one_sided(t + h, delta, &c[0], &c[1], &c[2]);
        CHECK_NEAR((c[0] - a[0]) / (2.0 * h), b[1], 1e-9);
        CHECK_NEAR((c[1] - a[1]) / (2.0 * h), b[2], 2e-5);
        CHECK(b[0] >= 0.0 && b[1] >= 0.0 && b[2] >= 0.0 && b[2] <= 1.0 && a[1] <= b[1] && b[1] <= c[1]);
        CHECK(t > 0.0 || (b[0] == 0.0 && b[1] == 0.0 && b[2] == 0.0));
    }
    for (i = 0; i < 2; i++) {
        double before[3], after[3], at = i ? delta : 0.0;
        yci_one_sided(at - 1e-12, delta, &before[0], &before[1], &before[2]);
        yci_one_sided(at + 1e-12, delta, &after[0], &after[1], &after[2]);
        CHECK_NEAR_ALL(before, after, 3, 1e-11);
    }
}

TEST(vec_perpendicular_and_angles) {
    uint64_t state = 3;
    int i;
    for (i = 0; i < 200; i++) {
        double t[3], p[3], a = test_random(&state, -YCI_PI, YCI_PI), b = test_random(&state, -YCI_PI, YCI_PI), d;
        test_random_array(&state, -1.0, 1.0, t, 3);
        if (i < 3) yci_zero(t, 3), t[i] = 1e-6;
        yci_perpendicular(p, t);
        CHECK_NEAR(yci_norm(p), 1.0, 1e-14);
        CHECK_NEAR(yci_dot(p, t), 0.0, 1e-15);
        d = yci_angle_difference(a, b);
        CHECK(d >= -YCI_PI && d <= YCI_PI);
        CHECK_NEAR(cos(d), cos(a - b), 1e-14);
        CHECK_NEAR(sin(d), sin(a - b), 1e-14);
    }
}
