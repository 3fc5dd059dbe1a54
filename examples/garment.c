/* The main job: a real sewing pattern becomes a draped garment with yarns where they matter, and pictures of it.
 *
 *     garment [tshirt|tanktop] [fabric=cotton|linen] [spacing=MM] [region=MM] [at=armpit|shoulder|stress]
 *
 * 1. The pieces are laid round a mannequin, sewn and draped as triangles.
 * 2. Yarns are laid over the whole pattern; they act in a region under stress, with a hybrid ring around it.
 * 3. The mixed garment relaxes.
 * Pictures and animation go to out/. Times are processor seconds of one thread. */
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
    double (*x)[3];      /* vertices */
    int (*triangles)[3]; /* welded */
    double *alpha;
    double *stress; /* N/m, at vertices */
    int center;     /* vertex in the middle of the region */
    yc_yarns yarns;
    double (*nodes)[3];
    yc_curves curves; /* of the region's yarns; their points and radii in doubles, for drawing */
    double (*points)[3], *radii;
    ex_usd film; /* the animation being written */
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
 * per width as the cloth itself. Two cloths: a stretch chambray of cotton and elastane, and a washed linen. Their
 * tension is what cloth shows before its crimp has gone, since a straight yarn has none to lose; mass, shear and
 * bending lie in the ranges of shirting and linen (Kawabata 1980). */
static yc_weave_desc fabric(const garment *g) {
    yc_weave_desc weave = yc_weave_desc_default();
    int linen = !strcmp(g->fabric, "linen");
    double mass = linen ? 0.17 : 0.115, tension = linen ? 8e3 : 4e3, shear = linen ? 75.0 : 55.0,
           bending = linen ? 35e-6 : 8e-6;
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

/* ---- 1. sewing and draping with triangles ---- */

static int add_seams(yc_scene *scene, const ex_pattern *pattern, int cloth) {
    int i, k, ok = 1;
    for (i = 0; ok && i < pattern->seam_count; i++) {
        const ex_seam *seam = pattern->seams + i;
        yc_seam_desc desc = yc_seam_desc_default();
        int *pair = calloc(2 * (size_t)seam->pair_count, sizeof *pair);
        if (!pair) return 0;
        for (k = 0; k < seam->pair_count; k++) {
            pair[k] = pattern->pairs[seam->first_pair + k][0];
            pair[seam->pair_count + k] = pattern->pairs[seam->first_pair + k][1];
        }
        desc.count = seam->pair_count, desc.a = pair, desc.b = pair + seam->pair_count;
        desc.cloth[0] = desc.cloth[1] = cloth;
        desc.close_time = 0.4, desc.weld_distance = 6e-3, desc.stiffness = 1000.0;
        ok = yc_scene_add_seam(scene, &desc, NULL) == YC_OK;
        free(pair);
    }
    return ok;
}

static yc_scene_desc draping(void) {
    yc_scene_desc settings = yc_scene_desc_default();
    settings.dt_max = 1.0 / 60.0, settings.tolerance = 1e-4, settings.newton_limit = 8, settings.best_effort = 1;
    settings.linear_tolerance = 1e-2; /* a garment at rest is asked for, not its way there */
    settings.thickness = 2.5e-3, settings.contact_stiffness = 1500.0, settings.slip_speed = 0.05;
    return settings;
}

/* One row of the table that the run prints. */
static void report(const char *what, yc_scene *scene, const yc_stats *s, int steps, const yc_stats *sum) {
    double e[YC_TERM_COUNT];
    int i;
    printf("\n%s\n", what);
    printf("  vertices %d (%d hybrid), yarn nodes %d full + %d hybrid + %d for drawing only\n", s->vertices,
        s->hybrid_vertices, s->full_nodes, s->hybrid_nodes, s->dummy_nodes);
    printf("  unknowns %d, memory %.1f MB\n", s->dofs, 1e-6 * (double)s->bytes_peak);
    printf("  %d frames in %d sub-steps: %.3f s per sub-step, %.1f Newton and %.0f MPCG iterations\n", steps,
        sum->substeps, sum->seconds / sum->substeps, (double)sum->newton / sum->substeps,
        (double)sum->linear / sum->substeps);
    printf("  assembly %.1f s, solving %.1f s, contact search %.1f s\n", sum->seconds_assembly, sum->seconds_solve,
        sum->seconds_contact);
    if (yc_scene_energy(scene, e) != YC_OK) return;
    printf("  energy, mJ:");
    for (i = 0; i < YC_TERM_COUNT; i++)
        if (e[i] != 0.0) printf("  %s %.3f", yc_term_name((yc_term)i), 1e3 * e[i]);
    printf("\n");
}

static void add_up(yc_stats *sum, const yc_stats *s) {
    sum->substeps += s->substeps, sum->rejected += s->rejected, sum->unfinished += s->unfinished,
        sum->newton += s->newton, sum->linear += s->linear;
    sum->seconds += s->seconds, sum->seconds_assembly += s->seconds_assembly, sum->seconds_solve += s->seconds_solve;
    sum->seconds_contact += s->seconds_contact;
}

static int sew(garment *g) {
    yc_scene_desc settings = draping();
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_weave_desc weave = fabric(g);
    yc_scene *scene = NULL;
    yc_stats stats, sum;
    char why[YC_MESSAGE_SIZE];
    double weight = settings.gravity[1];
    int frame, handle, ok, sewing = 24, frames = 24 + 36;
    memset(&sum, 0, sizeof sum);
    settings.gravity[1] = 0.1 * weight, settings.mass_damping = 6.0; /* pieces float while they are sewn */
    cloth.mesh = mesh_of(g, (const int(*)[3])g->pattern.triangles);
    cloth.material = yc_weave_material(&weave); /* a straight weave: yc_fit_material would find the same */
    if (yc_scene_create(NULL, &settings, &scene, why) != YC_OK) return fail("sewing", why);
    ok = add_body(scene, &g->body) && yc_scene_add_cloth(scene, &cloth, &handle) == YC_OK &&
        add_seams(scene, &g->pattern, handle);
    for (frame = 0; ok && frame < frames; frame++) {
        if (frame == sewing) {
            settings.gravity[1] = weight, settings.mass_damping = 2.0;
            ok = yc_scene_tune(scene, &settings) == YC_OK;
        }
        ok = ok && yc_scene_step(scene, 1.0 / 30.0, &stats) == YC_OK;
        ok = ok && yc_scene_positions(scene, handle, YC_VERTEX, g->x) == YC_OK;
        ok = ok && (ex_usd_mesh_frame(&g->film, (const double(*)[3])g->x) || fail("writing", "out/garment.usda"));
        add_up(&sum, &stats);
        progress(frame < sewing ? "sewing, triangles" : "draping, triangles", (double)(frame + 1) / frames);
    }
    ok = ok && yc_scene_triangles(scene, handle, g->triangles) == YC_OK &&
        yc_scene_stress(scene, handle, g->stress) == YC_OK;
    if (!ok) fail("sewing", yc_scene_message(scene));
    else if (stats.welded < g->pattern.seam_count) ok = fail("sewing", "not every seam closed");
    else report("Triangles, sewn and draped", scene, &stats, frames, &sum);
    yc_scene_destroy(scene);
    return ok;
}

/* ---- 2. and 3. yarns where they matter ---- */

static const ex_piece *piece_of(const garment *g, int vertex) {
    int i;
    for (i = 0; i < g->pattern.piece_count; i++)
        if (vertex < g->pattern.pieces[i].first_vertex + g->pattern.pieces[i].vertex_count) break;
    return g->pattern.pieces + i;
}

/* Where the region goes: the vertex of the front under most stress near the armpit, on the shoulder, or anywhere. */
static void choose(garment *g) {
    double best = -1.0;
    int i;
    for (i = 0; i < g->pattern.vertex_count; i++) {
        const double *x = g->x[i], *uv = g->pattern.uv[i];
        int armpit = x[0] > 0.05 && uv[1] > -0.3 && uv[1]<-0.18, shoulder = x[0]> 0.03 && uv[1] > -0.12;
        if (piece_of(g, i)->place != EX_PLACE_FRONT) continue;
        if ((!strcmp(g->at, "armpit") && !armpit) || (!strcmp(g->at, "shoulder") && !shoulder)) continue;
        if (g->stress[i] > best) best = g->stress[i], g->center = i;
    }
}

static int lay_yarns(garment *g, const yc_mesh *mesh) {
    yc_weave_desc weave = fabric(g);
    char why[YC_MESSAGE_SIZE];
    choose(g);
    if (yc_weave(NULL, &weave, mesh, &g->yarns, why) != YC_OK) return fail("weaving", why);
    if (yc_region_select(NULL, mesh, NULL, g->center, g->radius, g->alpha, NULL, why) != YC_OK)
        return fail("region", why);
    g->nodes = calloc((size_t)g->yarns.node_count, sizeof *g->nodes);
    return g->nodes ? 1 : fail("weaving", "out of memory");
}

/* ---- the region's yarns as curves, hybrid ring included ---- */

/* The curves of the present node positions; their arrays are made on the first call. */
static int make_curves(garment *g) {
    yc_curves *c = &g->curves;
    yc_curve_desc desc = yc_curve_desc_default();
    unsigned char *skip = calloc((size_t)g->yarns.node_count, 1);
    char why[YC_MESSAGE_SIZE] = "out of memory";
    int i, k, ok = skip != NULL;
    for (i = 0; ok && i < g->yarns.node_count; i++) {
        const int *t = g->triangles[g->yarns.triangle[i]];
        skip[i] = !(g->alpha[t[0]] > 0.0 || g->alpha[t[1]] > 0.0 || g->alpha[t[2]] > 0.0);
    }
    desc.skip = skip, desc.steps = 6;
    if (ok && !c->first) {
        ok = yc_curves_make(NULL, &g->yarns, NULL, &desc, c, why) == YC_OK;
        c->first = calloc((size_t)c->curve_count + 1, sizeof(int)),
        c->yarn = calloc((size_t)c->curve_count + 1, sizeof(int));
        c->points = calloc((size_t)c->point_count + 1, sizeof *c->points);
        c->radius = calloc((size_t)c->curve_count + 1, sizeof(float));
        g->points = calloc((size_t)c->point_count + 1, sizeof *g->points);
        g->radii = calloc((size_t)c->curve_count + 1, sizeof *g->radii);
        ok = ok && c->first && c->yarn && c->points && c->radius && g->points && g->radii;
    }
    ok = ok && yc_curves_make(NULL, &g->yarns, (const double(*)[3])g->nodes, &desc, c, why) == YC_OK;
    for (i = 0; ok && i < c->point_count; i++)
        for (k = 0; k < 3; k++) g->points[i][k] = (double)c->points[i][k];
    for (i = 0; ok && i < c->curve_count; i++) g->radii[i] = (double)c->radius[i];
    free(skip);
    return ok ? 1 : fail("curves", why);
}

static void free_curves(garment *g) {
    free(g->curves.first), free(g->curves.yarn), free(g->curves.points), free(g->curves.radius), free(g->points),
        free(g->radii);
}

/* One frame of out/region.usda: the welded mesh, and the region's yarns. */
static int film_region(garment *g, int frame) {
    int ok = make_curves(g);
    if (ok && !frame) {
        ok = ex_usd_begin(&g->film, "out/region.usda", 30.0);
        ok = ok &&
            ex_usd_mesh(&g->film, g->pattern.vertex_count, (const int(*)[3])g->triangles, g->pattern.triangle_count);
        ok = ok && ex_usd_curves(&g->film, g->curves.first, g->curves.curve_count, g->radii);
    }
    ok = ok && ex_usd_mesh_frame(&g->film, (const double(*)[3])g->x) &&
        ex_usd_curves_frame(&g->film, (const double(*)[3])g->points);
    return ok ? 1 : fail("writing", "out/region.usda");
}

static int relax(garment *g, const yc_mesh *mesh) {
    yc_scene_desc settings = draping();
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_weave_desc weave = fabric(g);
    yc_scene *scene = NULL;
    yc_stats stats, sum;
    char why[YC_MESSAGE_SIZE];
    int frame, handle, ok, frames = 18;
    memset(&sum, 0, sizeof sum);
    settings.mass_damping = 4.0;
    cloth.mesh = *mesh, cloth.yarns = &g->yarns, cloth.alpha = g->alpha, cloth.material = yc_weave_material(&weave);
    if (yc_scene_create(NULL, &settings, &scene, why) != YC_OK) return fail("relaxing", why);
    ok = add_body(scene, &g->body) && yc_scene_add_cloth(scene, &cloth, &handle) == YC_OK;
    for (frame = 0; ok && frame < frames; frame++) {
        ok = yc_scene_step(scene, 1.0 / 30.0, &stats) == YC_OK;
        ok = ok && yc_scene_positions(scene, handle, YC_VERTEX, g->x) == YC_OK;
        ok = ok && yc_scene_positions(scene, handle, YC_NODE, g->nodes) == YC_OK;
        ok = ok && film_region(g, frame);
        add_up(&sum, &stats);
        progress("relaxing, yarns and triangles", (double)(frame + 1) / frames);
    }
    if (!ok) fail("relaxing", yc_scene_message(scene));
    else report("Yarns and triangles, relaxed", scene, &stats, frames, &sum);
    yc_scene_destroy(scene);
    return ok;
}

/* ---- pictures ---- */

/* sRGB of warp, weft, and of both seen from afar: a chambray, and a linen of two flaxes. */
static const double cotton[3][3] = {{0.17, 0.27, 0.46}, {0.90, 0.89, 0.86}, {0.47, 0.56, 0.68}};
static const double linen[3][3] = {{0.62, 0.50, 0.36}, {0.90, 0.85, 0.74}, {0.76, 0.68, 0.56}};

static const double *color_of(const garment *g, int which) {
    return strcmp(g->fabric, "linen") ? cotton[which] : linen[which];
}

/* Looks at the region from the front and from its side. */
static void look_at_region(const garment *g, double distance, ex_camera *camera) {
    static const double from[3] = {0.45, 0.12, 0.885};
    int k;
    memset(camera, 0, sizeof *camera);
    for (k = 0; k < 3; k++)
        camera->target[k] = g->x[g->center][k], camera->eye[k] = camera->target[k] + distance * from[k];
    camera->up[1] = 1.0, camera->fov = 30.0;
}

static void draw_body(ex_scene *picture, const garment *g) {
    ex_material skin;
    ex_material_body(&skin);
    ex_render_mesh(picture, (const double(*)[3])g->skin.positions, g->skin.vertex_count,
        (const int(*)[3])g->skin.triangles, g->skin.triangle_count, NULL, NULL, &skin);
}

/* The triangles; with `holes` without those where yarns alone act. In the hybrid ring both are drawn, as both act. */
static void draw_cloth(ex_scene *picture, const garment *g, int holes, double wire) {
    const double *color = color_of(g, 2);
    int(*kept)[3] = calloc((size_t)g->pattern.triangle_count, sizeof *kept), i, count = 0;
    ex_material cloth;
    ex_material_cloth(&cloth, color[0], color[1], color[2]);
    cloth.wire = wire;
    for (i = 0; kept && i < g->pattern.triangle_count; i++) {
        const int *t = g->triangles[i];
        if (holes && g->alpha[t[0]] >= 1.0 && g->alpha[t[1]] >= 1.0 && g->alpha[t[2]] >= 1.0) continue;
        memcpy(kept[count++], t, sizeof *kept);
    }
    if (kept)
        ex_render_mesh(picture, (const double(*)[3])g->x, g->pattern.vertex_count, (const int(*)[3])kept, count, NULL,
            NULL, &cloth);
    free(kept);
}

static int draw_yarns(ex_scene *picture, const garment *g) {
    int i, count = g->curves.curve_count;
    double(*colors)[3] = calloc((size_t)count + 1, sizeof *colors), *radii = calloc((size_t)count + 1, sizeof *radii);
    int ok = colors && radii;
    ex_thread thread;
    ex_thread_cotton(&thread);
    for (i = 0; ok && i < count; i++) {
        memcpy(colors[i], color_of(g, g->yarns.yarn_family[g->curves.yarn[i]] == YC_WEFT), sizeof colors[i]);
        radii[i] = 1.35 * g->radii[i]; /* drawn fuller than they act: real yarns flatten and close the weave */
    }
    if (ok)
        ex_render_tubes(
            picture, (const double(*)[3])g->points, g->curves.first, count, radii, (const double(*)[3])colors, &thread);
    free(colors), free(radii);
    return ok;
}

static int save(ex_scene *picture, const char *path) {
    return ex_render_save(picture, path) ? 1 : fail("drawing", path);
}

/* The region before yarns act: triangles alone. */
static int draw_before(garment *g) {
    ex_camera camera;
    ex_scene *picture;
    look_at_region(g, 0.5, &camera);
    picture = ex_render_begin(1000, 1000, &camera, NULL);
    draw_body(picture, g), draw_cloth(picture, g, 0, 0.0);
    return save(picture, "out/region_triangles.png");
}

static int draw_after(garment *g) {
    ex_camera near, far = {{0.55, 1.28, 1.75}, {0.0, 1.1, 0.0}, {0.0, 1.0, 0.0}, 34.0};
    ex_look look;
    ex_scene *picture;
    int ok = 1;
    ex_look_default(&look);
    look.ao_radius = 2.0 * g->spacing, look.ao_strength = 1.6;
    look.key[0] = 0.75, look.key[1] = 0.65, look.key[2] = 0.9;
    look_at_region(g, 0.5, &near);
    picture = ex_render_begin(1000, 1000, &near, &look);
    draw_body(picture, g), draw_cloth(picture, g, 1, 0.0);
    ok = ok && draw_yarns(picture, g);
    ok = save(picture, "out/region_yarns.png") && ok;
    picture = ex_render_begin(1000, 1200, &far, NULL);
    draw_body(picture, g), draw_cloth(picture, g, 1, 0.0);
    ok = ok && draw_yarns(picture, g);
    ok = save(picture, "out/garment.png") && ok;
    return ok;
}

/* How near the garment comes to the body's skin: negative would be inside. */
static void report_skin(const garment *g) {
    double vertex = HUGE_VAL, center = HUGE_VAL, node = HUGE_VAL;
    int i, k;
    for (i = 0; i < g->pattern.triangle_count; i++) {
        double middle[3] = {0.0, 0.0, 0.0};
        for (k = 0; k < 9; k++) middle[k % 3] += g->x[g->triangles[i][k / 3]][k % 3] / 3.0;
        center = fmin(center, ex_body_distance(&g->body, middle));
        for (k = 0; k < 3; k++) vertex = fmin(vertex, ex_body_distance(&g->body, g->x[g->triangles[i][k]]));
    }
    for (i = 0; i < g->yarns.node_count; i++) node = fmin(node, ex_body_distance(&g->body, g->nodes[i]));
    printf("\nNearest to the skin, mm: vertices %.2f, triangle centres %.2f, yarn nodes %.2f (dummies included)\n",
        1e3 * vertex, 1e3 * center, 1e3 * node);
}

/* ---- main ---- */

static int read_arguments(garment *g, int argc, char **argv) {
    int i;
    g->name = "tshirt", g->fabric = "cotton", g->at = "armpit", g->spacing = 2.5e-3, g->radius = 0.075;
    for (i = 1; i < argc; i++) {
        const char *a = argv[i], *value = strchr(a, '=');
        double number = value ? atof(value + 1) : 0.0;
        if (!strcmp(a, "tshirt") || !strcmp(a, "tanktop")) g->name = a;
        else if (!strcmp(a, "fabric=cotton") || !strcmp(a, "fabric=linen")) g->fabric = value + 1;
        else if (!strcmp(a, "at=armpit") || !strcmp(a, "at=shoulder") || !strcmp(a, "at=stress")) g->at = value + 1;
        else if (!strncmp(a, "spacing=", 8) && number >= 0.5 && number <= 20.0) g->spacing = 1e-3 * number;
        else if (!strncmp(a, "region=", 7) && number >= 5.0 && number <= 1000.0) g->radius = 1e-3 * number;
        else {
            fprintf(stderr,
                "garment: I do not understand '%s'\nusage: garment [tshirt|tanktop] [fabric=cotton|linen] "
                "[at=armpit|shoulder|stress] [spacing=MM, 0.5 to 20] [region=MM, 5 to 1000]\n",
                a);
            return 0;
        }
    }
    return 1;
}

static int load(garment *g) {
    char error[EX_ERROR_SIZE], path[256];
    ex_placement placement;
    size_t vertices;
    snprintf(path, sizeof path, "examples/data/%s.obj", g->name);
    if (!ex_pattern_read(&g->pattern, path, error) || !ex_body_read(&g->body, "examples/data/mannequin.json", error))
        return fail("reading", error);
    vertices = (size_t)g->pattern.vertex_count;
    g->x = calloc(vertices, sizeof *g->x), g->alpha = calloc(vertices, sizeof *g->alpha),
    g->stress = calloc(vertices, sizeof *g->stress);
    g->triangles = calloc((size_t)g->pattern.triangle_count, sizeof *g->triangles);
    if (!g->x || !g->alpha || !g->stress || !g->triangles || !ex_body_mesh(&g->body, 0.012, &g->skin))
        return fail("reading", "out of memory");
    return ex_place_pattern(&g->pattern, &g->body, g->x, &placement)
        ? 1
        : fail("placing", "the body lacks arms, or memory ran out");
}

static void unload(garment *g) {
    yc_yarns_destroy(&g->yarns);
    free_curves(g);
    ex_pattern_free(&g->pattern), ex_body_free(&g->body), ex_mesh_free(&g->skin);
    free(g->x), free(g->alpha), free(g->stress), free(g->triangles), free(g->nodes);
}

int main(int argc, char **argv) {
    garment g;
    yc_mesh mesh;
    int ok;
    memset(&g, 0, sizeof g);
    if (!read_arguments(&g, argc, argv)) return 2;
    ok = load(&g);
    ok = ok && (ex_usd_begin(&g.film, "out/garment.usda", 30.0) || fail("writing", "out/garment.usda"));
    ok = ok &&
        ex_usd_mesh(&g.film, g.pattern.vertex_count, (const int(*)[3])g.pattern.triangles, g.pattern.triangle_count);
    ok = ok && sew(&g) && ex_usd_end(&g.film);
    if (ok) {
        mesh = mesh_of(&g, (const int(*)[3])g.triangles);
        ok = lay_yarns(&g, &mesh) && draw_before(&g) && relax(&g, &mesh) && draw_after(&g);
        if (ok) report_skin(&g);
    }
    ok = ok && ex_usd_end(&g.film);
    unload(&g);
    return !ok;
}
