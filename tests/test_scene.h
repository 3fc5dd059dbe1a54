/* What tests of scenes share. Include it behind test.h; functions are static, so that a file which holds a private copy
 * of the implementation (internals.h) calls that one. */
#ifndef TEST_SCENE_H
#define TEST_SCENE_H

#include "test.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A scene with one cloth; NULL after a failed check. */
static inline yc_scene *test_scene_of(const yc_scene_desc *desc, const yc_cloth_desc *cloth) {
    yc_scene *scene = NULL;
    char why[YC_MESSAGE_SIZE];
    if (!CHECK_RESULT(yc_scene_create(NULL, desc, &scene, why), YC_OK)) return NULL;
    if (CHECK_RESULT(yc_scene_add_cloth(scene, cloth, NULL), YC_OK)) return scene;
    yc_scene_destroy(scene);
    return NULL;
}

typedef struct test_saved {
    char *bytes; /* to be freed */
    size_t size;
} test_saved;

static inline test_saved test_save(yc_scene *scene) {
    test_saved s;
    s.bytes = NULL, s.size = 0;
    CHECK_RESULT(yc_scene_save(scene, NULL, &s.size), YC_OK);
    s.bytes = (char *)malloc(s.size);
    CHECK_RESULT(yc_scene_save(scene, s.bytes, &s.size), YC_OK);
    return s;
}

/* Whether the yarn nodes of the first cloth, as it is now, are within a kilometre. */
static inline int test_is_finite(yc_scene *scene) {
    yc_yarns now;
    int i, k, finite = yc_scene_network(scene, 0, &now) == YC_OK;
    double(*x)[3] = finite ? (double(*)[3])malloc((size_t)now.node_count * sizeof *x) : NULL;
    finite = x && yc_scene_positions(scene, 0, YC_NODE, x) == YC_OK;
    for (i = 0; finite && i < now.node_count; i++)
        for (k = 0; k < 3; k++) finite = finite && fabs(x[i][k]) < 1e3;
    free(x);
    return finite;
}

/* What cases of some kind took; worst is Newton iterations a sub-step, the mean over a step. */
typedef struct test_effort {
    int cases, substeps, newton, rejected;
    double worst;
} test_effort;

/* Adds a step, which must have come to its tolerance. */
static inline void test_effort_add(test_effort *sum, const yc_stats *stats, double tolerance) {
    CHECK(stats->correction <= tolerance && stats->unfinished == 0);
    sum->substeps += stats->substeps, sum->rejected += stats->rejected, sum->newton += stats->newton;
    sum->worst = fmax(sum->worst, (double)stats->newton / stats->substeps);
}

static inline int test_same(test_saved a, test_saved b) {
    return a.size == b.size && (!a.size || memcmp(a.bytes, b.bytes, a.size) == 0);
}

#endif
