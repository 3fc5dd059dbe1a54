#include "scenes.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *scene_kind_name(scene_kind kind) {
    static const char *const names[] = {"triangles", "yarns", "yarns alone", "mixed", "half", "enriched"};
    return names[kind];
}

scene_swatch_desc scene_swatch_desc_default(scene_kind kind) {
    scene_swatch_desc d;
    memset(&d, 0, sizeof d);
    d.kind = kind;
    d.cells[0] = d.cells[1] = 5;
    d.size[0] = d.size[1] = 0.05;
    d.spacing = 2.5e-3;
    d.yarn = yc_yarn_material_default();
    d.region = 0.15;
    d.along_u[0] = d.along_v[1] = 1.0;
    return d;
}

static void place_flat(void *user, const double uv[2], double out[3]) {
    const scene_swatch_desc *d = (const scene_swatch_desc *)user;
    int k;
    for (k = 0; k < 3; k++) out[k] = d->origin[k] + uv[0] * d->along_u[k] + uv[1] * d->along_v[k];
}

void scene_swatch_place(
    scene_swatch *swatch, void (*place)(void *user, const double uv[2], double out[3]), void *user) {
    int i;
    for (i = 0; i < swatch->vertex_count; i++) place(user, swatch->uv[i], swatch->positions[i]);
    for (i = 0; i < swatch->yarns.node_count; i++) place(user, swatch->yarns.layout[i], swatch->nodes[i]);
}

static void fill_mesh(scene_swatch *s) {
    const scene_swatch_desc *d = &s->desc;
    int nu = d->cells[0], nv = d->cells[1], x, y, t = 0;
    for (y = 0; y <= nv; y++)
        for (x = 0; x <= nu; x++) {
            int i = y * (nu + 1) + x;
            double u = d->size[0] * x / nu, v = d->size[1] * y / nv;
            s->uv[i][0] = u, s->uv[i][1] = v;
            s->alpha[i] = fabs(u / d->size[0] - 0.5) < d->region && fabs(v / d->size[1] - 0.5) < d->region ? 1.0 : 0.0;
        }
    for (y = 0; y < nv; y++)
        for (x = 0; x < nu; x++, t += 2) {
            int a = y * (nu + 1) + x, b = a + 1, c = a + nu + 1, e = c + 1, flip = !d->one_way && ((x + y) & 1);
            int first[3], second[3];
            first[0] = a, first[1] = b, first[2] = flip ? c : e;
            second[0] = flip ? b : a, second[1] = e, second[2] = c;
            memcpy(s->triangles[t], first, sizeof first), memcpy(s->triangles[t + 1], second, sizeof second);
        }
}

scene_swatch *scene_swatch_new(const scene_swatch_desc *desc) {
    scene_swatch *s = (scene_swatch *)calloc(1, sizeof *s);
    int triangles = 2 * desc->cells[0] * desc->cells[1], vertices = (desc->cells[0] + 1) * (desc->cells[1] + 1);
    yc_mesh *mesh;
    if (!s) return NULL;
    s->desc = *desc;
    s->cloth = yc_cloth_desc_default(), s->weave = yc_weave_desc_default();
    s->weave.spacing[0] = s->weave.spacing[1] = desc->spacing;
    s->weave.size[0] = desc->size[0], s->weave.size[1] = desc->size[1];
    s->weave.warp = s->weave.weft = desc->yarn;
    s->cloth.material = yc_weave_material(&s->weave);
    mesh = &s->cloth.mesh;
    if (desc->kind != SCENE_YARNS_ALONE) {
        s->vertex_count = vertices;
        s->positions = (double(*)[3])calloc((size_t)vertices, sizeof *s->positions);
        s->uv = (double(*)[2])calloc((size_t)vertices, sizeof *s->uv);
        s->triangles = (int(*)[3])calloc((size_t)triangles, sizeof *s->triangles);
        s->alpha = (double *)calloc((size_t)vertices, sizeof *s->alpha);
        if (!s->positions || !s->uv || !s->triangles || !s->alpha) goto failed;
        fill_mesh(s);
        mesh->vertex_count = mesh->uv_count = vertices, mesh->triangle_count = triangles;
        mesh->positions = (const double(*)[3])s->positions, mesh->uv = (const double(*)[2])s->uv;
        mesh->triangles = (const int(*)[3])s->triangles;
    }
    scene_swatch_place(s, place_flat, &s->desc);
    if (desc->kind != SCENE_TRIANGLES) {
        if (yc_weave(NULL, &s->weave, s->vertex_count ? mesh : NULL, &s->yarns, s->message) != YC_OK) goto failed;
        s->nodes = (double(*)[3])calloc((size_t)s->yarns.node_count + 1, sizeof *s->nodes);
        if (!s->nodes) goto failed;
        scene_swatch_place(s, place_flat, &s->desc);
        s->cloth.yarns = &s->yarns;
        s->cloth.yarn_positions = (const double(*)[3])s->nodes;
    }
    if (desc->kind == SCENE_YARNS) s->cloth.alpha_uniform = 1.0;
    if (desc->kind == SCENE_HALF) s->cloth.alpha_uniform = 0.5;
    if (desc->kind == SCENE_MIXED) s->cloth.alpha = s->alpha;
    if (desc->kind == SCENE_ENRICHED) s->cloth.enrich_all = 1;
    return s;
failed:
    scene_swatch_free(s);
    return NULL;
}

void scene_swatch_free(scene_swatch *s) {
    if (!s) return;
    yc_yarns_destroy(&s->yarns);
    free(s->positions), free(s->uv), free(s->triangles), free(s->alpha), free(s->nodes);
    free(s);
}

yc_point scene_swatch_kind(const scene_swatch *s) { return s->yarns.node_count ? YC_NODE : YC_VERTEX; }
int scene_swatch_count(const scene_swatch *s) { return s->yarns.node_count ? s->yarns.node_count : s->vertex_count; }

int scene_swatch_nearest(const scene_swatch *s, double u, double v) {
    int i, best = 0, count = s->vertex_count ? s->vertex_count : s->yarns.node_count;
    double nearest = HUGE_VAL;
    for (i = 0; i < count; i++) {
        const double *at = s->vertex_count ? s->uv[i] : s->yarns.layout[i];
        double distance = (at[0] - u) * (at[0] - u) + (at[1] - v) * (at[1] - v);
        if (distance < nearest) nearest = distance, best = i;
    }
    return best;
}

yc_result scene_swatch_pin(
    yc_scene *scene, int cloth, const scene_swatch *s, double u, double v, const double *position) {
    return yc_scene_pin(scene, cloth, s->vertex_count ? YC_VERTEX : YC_NODE, scene_swatch_nearest(s, u, v), position);
}

/* ---- a single yarn -------------------------------------------------------------------------------------------- */

scene_chain *scene_chain_new(
    int pieces, double length, const double from[3], const double to[3], const yc_yarn_material *material) {
    scene_chain *s = (scene_chain *)calloc(1, sizeof *s);
    size_t n = (size_t)pieces + 1;
    yc_yarns *y;
    int i, k;
    if (!s) return NULL;
    y = &s->yarns;
    s->material = *material;
    s->positions = (double(*)[3])calloc(n, sizeof *s->positions);
    y->layout = (double(*)[3])calloc(n, sizeof *y->layout);
    y->yarn_first = (int *)calloc(2, sizeof(int)), y->yarn_family = (unsigned char *)calloc(1, 1);
    y->yarn_material = (int *)calloc(1, sizeof(int)), y->visit_node = (int *)calloc(n, sizeof(int));
    y->visit_u = (double *)calloc(n, sizeof(double)), y->visit_layer = (signed char *)calloc(n, 1);
    y->visit_held = (unsigned char *)calloc(n, 1);
    if (!s->positions || !y->layout || !y->yarn_first || !y->yarn_family || !y->yarn_material || !y->visit_node ||
        !y->visit_u || !y->visit_layer || !y->visit_held) {
        scene_chain_free(s);
        return NULL;
    }
    y->node_count = y->visit_count = pieces + 1, y->yarn_count = y->material_count = 1, y->materials = &s->material;
    y->yarn_first[1] = pieces + 1, y->yarn_family[0] = YC_WEFT;
    for (i = 0; i <= pieces; i++) {
        double share = (double)i / pieces;
        for (k = 0; k < 3; k++) s->positions[i][k] = from[k] + share * (to[k] - from[k]);
        y->layout[i][0] = y->visit_u[i] = share * length;
        y->visit_node[i] = i, y->visit_held[i] = 1;
    }
    s->cloth = yc_cloth_desc_default();
    s->cloth.yarns = y, s->cloth.yarn_positions = (const double(*)[3])s->positions;
    return s;
}

void scene_chain_free(scene_chain *s) {
    if (!s) return;
    free(s->positions), free(s->yarns.layout), free(s->yarns.yarn_first), free(s->yarns.yarn_family);
    free(s->yarns.yarn_material), free(s->yarns.visit_node), free(s->yarns.visit_u), free(s->yarns.visit_layer);
    free(s->yarns.visit_held), free(s);
}

/* ---- the papers' scenes --------------------------------------------------------------------------------------- */

static scene_swatch_desc swing_desc(scene_kind kind, int cells, double size, double stretch) {
    scene_swatch_desc d = scene_swatch_desc_default(kind);
    double radius = 0.25e-3, area = 3.14159265358979323846 * radius * radius;
    d.spacing = 1e-3;
    d.cells[0] = d.cells[1] = cells;
    d.size[0] = d.size[1] = size;
    d.yarn.radius = radius;
    d.yarn.stretch = stretch * 1e7 * area, d.yarn.density = 1000.0 * area, d.yarn.bending = 1e-9, d.yarn.shear = 1e-3;
    d.along_v[1] = 0.0, d.along_v[2] = -1.0; /* it lies flat, then swings about its edge v = 0 */
    return d;
}

scene_swatch *scene_swing(scene_kind kind, int cells) {
    scene_swatch_desc d = swing_desc(kind, cells, 10.0 * 1e-3 * cells, 1.0);
    return scene_swatch_new(&d);
}

scene_swatch *scene_swing_sized(int cells, double size, double region, double stretch) {
    scene_swatch_desc d = swing_desc(SCENE_MIXED, cells, size, stretch);
    scene_swatch *s;
    d.region = region + 1e-6;
    s = scene_swatch_new(&d);
    if (!s) return NULL;
    yc_yarns_destroy(&s->yarns);
    s->weave.crimp[0] = s->weave.crimp[1] = 0.05;
    if (yc_weave(NULL, &s->weave, &s->cloth.mesh, &s->yarns, s->message) == YC_OK) return s;
    scene_swatch_free(s);
    return NULL;
}

yc_result scene_shear(yc_scene *scene, int cloth, const scene_swatch *s, double displacement) {
    const yc_yarns *y = &s->yarns;
    double low = HUGE_VAL, high = -HUGE_VAL, middle = 0.5 * s->desc.size[0];
    int i, k;
    yc_result result = YC_OK;
    for (i = 0; i < y->node_count; i++) low = fmin(low, y->layout[i][0]), high = fmax(high, y->layout[i][0]);
    for (i = 0; i < y->node_count && result == YC_OK; i++) {
        double at[3], share;
        if (y->layout[i][0] > low + 1e-9 && y->layout[i][0] < high - 1e-9) continue;
        share = y->layout[i][0] < middle ? -0.5 : 0.5;
        for (k = 0; k < 3; k++)
            at[k] = s->desc.origin[k] + y->layout[i][0] * s->desc.along_u[k] +
                (y->layout[i][1] + share * displacement) * s->desc.along_v[k];
        result = yc_scene_pin(scene, cloth, YC_NODE, i, at);
    }
    return result;
}
