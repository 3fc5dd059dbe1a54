#include "woven.h"
#include <stdlib.h>
#include <string.h>

static int count_of(const yc_yarns *y, int family) {
    int i, n = 0;
    for (i = 0; i < y->yarn_count; i++) n += y->yarn_family[i] == family;
    return n;
}

int scene_woven_yarn(const yc_yarns *y, int family, int k) {
    int i;
    for (i = 0; i < y->yarn_count; i++)
        if (y->yarn_family[i] == family && k-- == 0) return i;
    return 0;
}

int scene_woven_visit(const yc_yarns *y, int family, int k, int visit) {
    int yarn = scene_woven_yarn(y, family, k);
    return visit < 0 ? y->yarn_first[yarn + 1] + visit : y->yarn_first[yarn] + visit;
}

int scene_woven_node(const yc_yarns *y, int family, int k, int visit) {
    return y->visit_node[scene_woven_visit(y, family, k, visit)];
}

int scene_woven_hook(yc_yarns *y, yc_yarns *out) {
    int visit = scene_woven_visit(y, YC_WEFT, count_of(y, YC_WEFT) / 2, count_of(y, YC_WARP) / 2 + 1);
    int node = y->visit_node[visit], i;
    *out = *y;
    out->layout = (double(*)[3])calloc((size_t)y->node_count + 1, sizeof *out->layout);
    out->visit_node = (int *)calloc((size_t)y->visit_count, sizeof *out->visit_node);
    if (!out->layout || !out->visit_node) {
        scene_woven_unhook(out);
        return 0;
    }
    memcpy(out->layout, y->layout, (size_t)y->node_count * sizeof *out->layout);
    memcpy(out->layout[y->node_count], y->layout[node], sizeof *out->layout);
    memcpy(out->visit_node, y->visit_node, (size_t)y->visit_count * sizeof *out->visit_node);
    for (i = 0; i < y->visit_count; i++) {
        if (y->visit_node[i] != node) continue;
        y->visit_layer[i] = 0, y->visit_held[i] = 1;
        if (y->visit_height) y->visit_height[i] = 0.0;
    }
    out->visit_node[visit] = out->node_count++;
    return 1;
}

void scene_woven_unhook(yc_yarns *hooked) {
    free(hooked->layout), free(hooked->visit_node);
    hooked->layout = NULL, hooked->visit_node = NULL;
}

yc_result scene_woven_draw(yc_scene *scene, const yc_yarns *y, int node, const double by[3]) {
    double at[3];
    int k;
    if (!by) return yc_scene_unpin(scene, 0, YC_NODE, node);
    for (k = 0; k < 3; k++) at[k] = y->layout[node][k] + by[k];
    return yc_scene_pin(scene, 0, YC_NODE, node, at);
}

/* Holds both ends of the warps before `to`. */
static yc_result hold_warps(yc_scene *scene, const yc_yarns *y, int to) {
    static const double nowhere[3] = {0.0, 0.0, 0.0};
    yc_result result = YC_OK;
    int i;
    for (i = 0; i < 2 * to && result == YC_OK; i++)
        result = scene_woven_draw(scene, y, scene_woven_node(y, YC_WARP, i / 2, -(i % 2)), nowhere);
    return result;
}

/* Crossings each way that are clamped at a corner: two of ten yarns, three of twenty. */
static int clamped(const yc_yarns *y) { return 1 + count_of(y, YC_WARP) / 10; }

static yc_result draw_corner(yc_scene *scene, const yc_yarns *y, const double by[3]) {
    static const double nowhere[3] = {0.0, 0.0, 0.0};
    int n = clamped(y), warps = count_of(y, YC_WARP), i;
    yc_result result = YC_OK;
    for (i = 0; i < n * n && result == YC_OK; i++) {
        result = scene_woven_draw(scene, y, scene_woven_node(y, YC_WARP, i / n, 1 + i % n), nowhere);
        if (result == YC_OK)
            result = scene_woven_draw(scene, y, scene_woven_node(y, YC_WARP, warps - 1 - i / n, -2 - i % n), by);
    }
    return result;
}

int scene_woven_drawn(const yc_yarns *y, scene_pull pull) {
    int warps = count_of(y, YC_WARP), n = clamped(y);
    switch (pull) {
    case SCENE_PULLOUT: return scene_woven_node(y, YC_WEFT, count_of(y, YC_WEFT) / 2, -1);
    case SCENE_FRAY: return scene_woven_node(y, YC_WARP, warps - 1, 0);
    case SCENE_STRIP: return scene_woven_node(y, YC_WARP, warps / 2, -1);
    case SCENE_CORNER: return scene_woven_node(y, YC_WARP, warps - n, -1 - n);
    default: return y->node_count - 1;
    }
}

yc_result scene_woven_pull(yc_scene *scene, const yc_yarns *y, scene_pull pull, const double by[3]) {
    int warps = count_of(y, YC_WARP), k;
    yc_result result;
    if (pull == SCENE_CORNER) return draw_corner(scene, y, by);
    result = hold_warps(scene, y, pull == SCENE_STRIP ? 0 : pull == SCENE_FRAY ? warps - 2 : warps);
    if (result == YC_OK) result = scene_woven_draw(scene, y, scene_woven_drawn(y, pull), by);
    if (result == YC_OK && pull == SCENE_STRIP) {
        double against[3] = {0.0, 0.0, 0.0};
        for (k = 0; k < 3 && by; k++) against[k] = -by[k];
        result = scene_woven_draw(scene, y, scene_woven_node(y, YC_WARP, warps / 2 - 1, 0), by ? against : NULL);
    }
    return result;
}
