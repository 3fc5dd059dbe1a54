/* What tests of scenes share. Include it behind test.h; functions are static, so that a file which holds a private copy
 * of the implementation (internals.h) calls that one. */
#ifndef TEST_SCENE_H
#define TEST_SCENE_H

#include "test.h"
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

static inline int test_same(test_saved a, test_saved b) {
    return a.size == b.size && (!a.size || memcmp(a.bytes, b.bytes, a.size) == 0);
}

#endif
