/* The main job: a real sewing pattern becomes a draped garment with yarns where they matter, and pictures of it.
 *
 *     garment [tshirt|tanktop] [fabric=cotton|linen] [spacing=MM] [region=MM] [at=armpit|shoulder|stress]
 *
 * 1. The pieces are laid round a mannequin, sewn and draped as triangles.
 * 2. Yarns are laid over the whole pattern; they act in a region under stress, with a hybrid ring around it.
 * 3. The mixed garment relaxes.
 * Pictures and animation go to out/. */
#include "common/ex_body.h"
#include "common/ex_cache.h"
#include "common/ex_obj.h"
#include "common/ex_place.h"
#include "common/ex_render.h"
#include "yarncloth.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct garment {
    const char *name, *fabric, *at;
    double spacing, radius; /* of yarns, of the region, m */
    ex_body body;
    ex_mesh skin;
    ex_pattern pattern;
    double (*x)[3];         /* vertices */
    int (*triangles)[3];    /* welded */
    double *alpha;
    yc_yarns yarns;
    double (*nodes)[3];
    yc_curves curves;
    double *alpha_of_node;
} garment;

static int fail(const char *what, const char *why) {
    fprintf(stderr, "garment: %s: %s\n", what, why);
    return 0;
}

static void progress(const char *what, double share) {
    int i, full = (int)(share * 40.0 + 0.5);
    fprintf(stderr, "\r%-28s [", what);
    for (i = 0; i < 40; i++) fputc(i < full ? '#' : '.', stderr);
    fprintf(stderr, "] %3.0f %%%s", 100.0 * share, share >= 1.0 ? "\n" : "");
    fflush(stderr);
}

/* ---- what the garment is made of ---- */

/* A plain weave at a gauge of `spacing` that stands for a finer cloth: as heavy, as stiff in tension, shear and bending
 * per width as the cloth itself. Tension is what the cloth shows once its crimp has gone (Kawabata's range for shirting and for linen), for a
 * straight yarn has none to lose. Sources: ranges after Kawabata 1980; Hearle, Grosberg and Backer 1969. */
static yc_weave_desc fabric(const garment *g) {
    yc_weave_desc weave = yc_weave_desc_default();
    int linen = !strcmp(g->fabric, "linen");
    double mass = linen ? 0.17 : 0.115, tension = linen ? 8e3 : 4e3, shear = linen ? 75.0 : 55.0, bending = linen ? 35e-6 : 8e-6;
    yc_yarn_material yarn = yc_yarn_material_default();
    yarn.density = 0.5 * mass * g->spacing;
    yarn.stretch = tension * g->spacing;
    yarn.bending = bending * g->spacing;
    yarn.shear = shear * g->spacing / 4.0;
    yarn.radius = 0.22 * g->spacing;
    yarn.contact = 0.1 * yarn.stretch;
    weave.spacing[0] = weave.spacing[1] = g->spacing;
    weave.warp = weave.weft = weave.rod = yarn;
    weave.rod.density = 2.0 * yarn.density, weave.rod.bending = 8.0 * yarn.bending;
    return weave;
}

static int add_body(yc_scene *scene, const ex_body *body) {
    int i, count = body->cone_count + 1;
    yc_primitive *p = calloc((size_t)count, sizeof *p);
    double(*sections)[4] = calloc((size_t)body->section_count, sizeof *sections);
    yc_body_desc desc = yc_body_desc_default();
    yc_result result = YC_ERROR_MEMORY;
    if (p && sections) {
        for (i = 0; i < body->section_count; i++) {
            sections[i][0] = body->sections[i].y, sections[i][1] = body->sections[i].half_width;
            sections[i][2] = body->sections[i].half_depth, sections[i][3] = body->sections[i].centre_z;
        }
        p[0].type = YC_LOFT, p[0].section_count = body->section_count, p[0].sections = (const double(*)[4])sections;
        p[0].exponent = body->exponent;
        for (i = 0; i < body->cone_count; i++) {
            p[i + 1].type = YC_ROUNDED_CONE, p[i + 1].ra = body->cones[i].ra, p[i + 1].rb = body->cones[i].rb;
            memcpy(p[i + 1].a, body->cones[i].a, sizeof p->a), memcpy(p[i + 1].b, body->cones[i].b, sizeof p->b);
        }
        desc.primitives = p, desc.primitive_count = count, desc.smooth_radius = body->blend, desc.friction = 0.25;
        result = yc_scene_add_body(scene, &desc, NULL);
    }
    free(p), free(sections);
    return result == YC_OK;
}

static yc_mesh mesh_of(const garment *g, const int (*triangles)[3]) {
    yc_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    mesh.vertex_count = g->pattern.vertex_count, mesh.positions = (const double(*)[3])g->x;
    mesh.triangle_count = g->pattern.triangle_count, mesh.triangles = triangles;
    mesh.uv_count = g->pattern.uv_count, mesh.uv = (const double(*)[2])g->pattern.uv;
    mesh.uv_triangles = (const int(*)[3])g->pattern.uv_triangles;
    return mesh;
}

/* ---- sewing and draping with triangles ---- */

static int sew(garment *g, ex_usd *film) {
    yc_scene_desc settings = yc_scene_desc_default();
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_weave_desc weave = fabric(g);
    yc_scene *scene = NULL;
    yc_stats stats;
    char why[YC_MESSAGE_SIZE];
    double gravity = settings.gravity[1], *stress = calloc((size_t)g->pattern.vertex_count, sizeof *stress);
    int i, frame, handle, ok = 0, sewing = 30, frames = 30 + 36;
    clock_t start = clock();
    settings.thickness = 2.5e-3, settings.contact_stiffness = 1500.0, settings.mass_damping = 6.0, settings.tolerance = 1e-4, settings.dt_max = 1.0 / 60.0;
    settings.gravity[1] = 0.1 * gravity;
    cloth.mesh = mesh_of(g, (const int(*)[3])g->pattern.triangles);
    cloth.material = yc_weave_material(&weave);
    if (!stress || yc_scene_create(NULL, &settings, &scene, why) != YC_OK) return fail("sewing", stress ? why : "out of memory");
    if (!add_body(scene, &g->body) || yc_scene_add_cloth(scene, &cloth, &handle) != YC_OK) goto done;
    for (i = 0; i < g->pattern.seam_count; i++) {
        const ex_seam *seam = g->pattern.seams + i;
        yc_seam_desc desc = yc_seam_desc_default();
        int *pair = calloc(2 * (size_t)seam->pair_count, sizeof *pair), k;
        if (!pair) goto done;
        for (k = 0; k < seam->pair_count; k++)
            pair[k] = g->pattern.pairs[seam->first_pair + k][0], pair[seam->pair_count + k] = g->pattern.pairs[seam->first_pair + k][1];
        desc.count = seam->pair_count, desc.a = pair, desc.b = pair + seam->pair_count, desc.close_time = 0.4;
        desc.cloth[0] = desc.cloth[1] = handle, desc.weld_distance = 6e-3, desc.stiffness = 1000.0;
        ok = yc_scene_add_seam(scene, &desc, NULL) == YC_OK;
        free(pair);
        if (!ok) goto done;
    }
    for (ok = 1, frame = 0; ok && frame < frames; frame++) {
        if (frame == sewing) settings.gravity[1] = gravity, settings.mass_damping = 2.0, ok = yc_scene_tune(scene, &settings) == YC_OK;
        ok = ok && yc_scene_step(scene, 1.0 / 30.0, &stats) == YC_OK && yc_scene_positions(scene, handle, YC_VERTEX, g->x) == YC_OK;
        if (ok && film) ok = ex_usd_mesh_frame(film, (const double(*)[3])g->x);
        if (getenv("DBG")) printf("%d: sub %d rej %d newton %d corr %.2e asm %.2f solve %.2f contact %.2f total %.2f touch %d weld %d\n", frame, stats.substeps, stats.rejected, stats.newton, stats.correction, stats.seconds_assembly, stats.seconds_solve, stats.seconds_contact, stats.seconds, stats.body_contacts, stats.welded);
        progress(frame < sewing ? "sewing" : "draping", (double)(frame + 1) / frames);
    }
    ok = ok && yc_scene_triangles(scene, handle, g->triangles) == YC_OK && yc_scene_stress(scene, handle, stress) == YC_OK;
    if (ok) {
        memcpy(g->alpha, stress, (size_t)g->pattern.vertex_count * sizeof *stress); /* for the choice of a region */
        printf("triangles: %d vertices, %d unknowns, %d of %d seams welded, %.1f s\n", stats.vertices, stats.dofs, stats.welded,
            g->pattern.seam_count, (double)(clock() - start) / CLOCKS_PER_SEC);
    }
    if (getenv("DBG")) for (i = 0; i < g->pattern.seam_count; i++) {
        const ex_seam *seam = g->pattern.seams + i; int k;
        printf("seam %s %s:", g->pattern.edges[seam->edge_a].name, g->pattern.edges[seam->edge_b].name);
        for (k = 0; k < seam->pair_count; k++) { int *q = g->pattern.pairs[seam->first_pair + k]; double d = 0; int c; for (c = 0; c < 3; c++) d += (g->x[q[0]][c]-g->x[q[1]][c])*(g->x[q[0]][c]-g->x[q[1]][c]); printf(" %.1f", 1e3 * sqrt(d)); }
        printf("\n");
    }
done:
    if (!ok) fail("sewing", yc_scene_message(scene));
    yc_scene_destroy(scene), free(stress);
    return ok;
}

int main(int argc, char **argv) {
    garment g;
    char error[EX_ERROR_SIZE], path[256];
    ex_camera camera = {{0.45, 1.3, 1.6}, {0.0, 1.12, 0.0}, {0, 1, 0}, 34.0};
    ex_placement placement;
    ex_scene *picture;
    ex_material cloth, skin;
    memset(&g, 0, sizeof g);
    (void)argc, (void)argv;
    g.name = "tshirt", g.fabric = "cotton", g.spacing = 2.5e-3;
    snprintf(path, sizeof path, "examples/data/%s.obj", g.name);
    if (!ex_pattern_read(&g.pattern, path, error) || !ex_body_read(&g.body, "examples/data/mannequin.json", error)) return fail("reading", error), 1;
    g.x = calloc((size_t)g.pattern.vertex_count, sizeof *g.x);
    g.triangles = calloc((size_t)g.pattern.triangle_count, sizeof *g.triangles);
    g.alpha = calloc((size_t)g.pattern.vertex_count, sizeof *g.alpha);
    ex_place_pattern(&g.pattern, &g.body, g.x, &placement);
    printf("placed: clearance %.3f gap %.3f\n", placement.clearance, placement.seam_gap);
    if (!sew(&g, NULL)) return 1;
    ex_body_mesh(&g.body, 0.012, &g.skin);
    ex_material_cloth(&cloth, 0.75, 0.3, 0.2), ex_material_body(&skin);
    picture = ex_render_begin(800, 960, &camera, NULL);
    ex_render_mesh(picture, (const double(*)[3])g.skin.positions, g.skin.vertex_count, (const int(*)[3])g.skin.triangles, g.skin.triangle_count, NULL, NULL, &skin);
    ex_render_mesh(picture, (const double(*)[3])g.x, g.pattern.vertex_count, (const int(*)[3])g.triangles, g.pattern.triangle_count, NULL, NULL, &cloth);
    ex_render_save(picture, "out/drape.png");
    return 0;
}
