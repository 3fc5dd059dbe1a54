/* Knits that are left to themselves, drawn yarn by yarn.
 *
 *     knit [curl|rib|garter|lace|unravel|piece|sphere|plastic]      all of them without a name
 *
 * curl    stockinette: its sides roll towards the purl side, its ends towards the knit side (after YARN, Fig. 7), until
 *         they lie on it; four loops of its middle are held, without which it would roll up into two scrolls
 * rib     knit and purl columns by turns: they draw in (YARN, Fig. 5)
 * garter  knit rows on both sides: it lies flat
 * lace    decreases, whose loops are stacked, and yarn-overs, which leave holes
 * unravel garter that is not bound off; its end is drawn off sideways, and it comes undone loop by loop (YARN, Fig. 13)
 * piece   the sleeve of a T-shirt, cut from stockinette and sewn up: its yarns end at the outline, or in the rod of the
 *         seam; edges that hang free roll up
 * sphere  six fabrics of one yarn and about as many stitches, fallen on spheres of 3 cm (YARN, Fig. 12): minutes
 * plastic garter that has settled, is drawn out and let go: loops have slipped, and it stays wider (YARN, Fig. 9)
 * All but the piece are cast on and worked with one yarn of wool; all but that one and unravel are bound off. All but
 * unravel are laid in their rest shape, and then let their contacts unwrap. Each prints a line and writes
 * out/knit-NAME.png, as seen from the right side. Weight acts on the sphere only. */
#include "common/ex_obj.h"
#include "common/ex_yarns.h"
#include "tests/scenes/knits.h"
#include "tests/scenes/pieces.h"
#include "yarncloth.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct piece {
    const char *name;
    const char *const *rows;
    int stitches, row_count, held, most; /* most: steps */
    double from[3];                      /* towards the camera */
} piece;

static const char *const openwork =
    "pattern: a\nRow 1 (RS): K1, *yo, ssk, k3, k2tog, yo, k1, repeat from *.\nRow 2 (WS): Purl.\n"
    "Row 3 (RS): K1, *k1, yo, ssk, k1, k2tog, yo, k2, repeat from *.\nRow 4 (WS): Purl.\n"
    "Row 5 (RS): K1, *k2, yo, sl1-k2tog-psso, yo, k3, repeat from *.\nRow 6 (WS): Purl.\n";

static const piece pieces[] = {{"curl", &scene_stockinette, 16, 18, 1, 40, {0.35, 0.4, 1.0}},
    {"rib", &scene_rib, 20, 20, 0, 12, {0.1, 0.2, 1.0}}, {"garter", &scene_garter, 18, 22, 0, 12, {0.1, 0.2, 1.0}},
    {"lace", &openwork, 17, 18, 0, 8, {0.0, 0.1, 1.0}}};

static int save(yc_scene *scene, const ex_yarns_view *view, const double (*colors)[3], const char *name, char *why) {
    ex_camera camera;
    char path[64];
    ex_image *image = ex_yarns_draw(scene, 0, view, colors, &camera, 0, why);
    snprintf(path, sizeof path, "out/knit-%s.png", name);
    if (image && !ex_image_write_png(image, path)) snprintf(why, YC_MESSAGE_SIZE, "%s cannot be written", path);
    ex_image_free(image);
    return !why[0];
}

static int run(const piece *p) {
    const double degree = 3.14159265358979323846 / 180.0;
    char why[YC_MESSAGE_SIZE] = "";
    scene_knit *k = scene_knit_new(*p->rows, p->stitches, p->row_count, NULL, why);
    scene_knit_shape flat, now;
    ex_yarns_view view;
    yc_result result = YC_OK;
    if (!k) {
        fprintf(stderr, "knit: %s: %s\n", p->name, why);
        return 0;
    }
    flat = scene_knit_look(k);
    if (p->held) result = scene_knit_hold(k);
    if (result == YC_OK) result = scene_knit_settle(k, p->most);
    if (result != YC_OK) snprintf(why, sizeof why, "%s", yc_scene_message(k->scene));
    else {
        now = scene_knit_look(k);
        printf(
            "%-7s %2d x %2d  width %.2f and height %.2f of flat; sides turn %4.0f %4.0f, ends %4.0f %4.0f, the middle "
            "%3.0f degrees; %d sub-steps, %.1f Newton iterations each, %.1f s\n",
            p->name, p->stitches, p->row_count, now.width / flat.width, now.height / flat.height, now.side[0] / degree,
            now.side[1] / degree, now.end[0] / degree, now.end[1] / degree, now.flat / degree, k->substeps,
            (double)k->newton / k->substeps, k->seconds);
        fflush(stdout);
        memset(&view, 0, sizeof view);
        view.width = 1000, view.height = 900, view.zoom = 0.95, view.fuller = 1.0;
        memcpy(view.from, p->from, sizeof view.from);
        save(k->scene, &view, NULL, p->name, why);
    }
    if (why[0]) fprintf(stderr, "knit: %s: %s\n", p->name, why);
    scene_knit_free(k);
    return !why[0];
}

static int unravel(void) {
    enum { STITCHES = 10, ROWS = 8, LOOPS = 14 };
    char why[YC_MESSAGE_SIZE] = "";
    scene_unravel *u = scene_unravel_new(NULL, scene_garter, STITCHES, ROWS, why);
    yc_result result = YC_OK;
    double most = 0.0, seconds = 0.0;
    int slipped = 0, substeps = 0, newton = 0, i, n;
    while (u && result == YC_OK && slipped < LOOPS && u->pulled < 1.0) {
        const yc_event *e;
        yc_stats stats;
        result = scene_unravel_pull(u, 2e-3, 1e-2, &stats);
        e = yc_scene_events(u->scene, &n);
        for (i = 0; i < n && result == YC_OK; i++) slipped += e[i].type == YC_EVENT_SLIP;
        substeps += stats.substeps, newton += stats.newton, seconds += stats.seconds;
        if (u->force > most) most = u->force;
    }
    if (result != YC_OK) snprintf(why, sizeof why, "%s", yc_scene_message(u->scene));
    if (u && result == YC_OK) {
        ex_yarns_view view;
        printf("unravel %2d x %2d  %d loops out, %.0f mm drawn, at most %.2f N; %d sub-steps, %.1f Newton iterations "
               "each, %.1f s\n",
            STITCHES, ROWS, slipped, 1e3 * u->pulled, most, substeps, (double)newton / substeps, seconds);
        fflush(stdout);
        memset(&view, 0, sizeof view);
        view.width = 1200, view.height = 700, view.zoom = 2.4, view.fuller = 1.0;
        view.shift[0] = -0.31 * u->way, view.from[1] = 0.15, view.from[2] = 1.0;
        save(u->scene, &view, NULL, "unravel", why);
    }
    if (why[0]) fprintf(stderr, "knit: unravel: %s\n", why);
    scene_unravel_free(u);
    return !why[0];
}

/* The left sleeve of a T-shirt, rolled up to a tube and welded where its seam under the arm is. NULL: see `why`. */
static scene_piece *sleeve(char *why) {
    const double pi = 3.14159265358979323846;
    ex_pattern pattern;
    char error[EX_ERROR_SIZE];
    scene_piece *tube = NULL;
    double wide = 0.0;
    int i, k, s, p = 0;
    if (!ex_pattern_read(&pattern, "examples/data/tshirt.obj", error)) {
        snprintf(why, YC_MESSAGE_SIZE, "%s", error);
        return NULL;
    }
    while (p + 1 < pattern.piece_count && pattern.pieces[p].place != EX_PLACE_SLEEVE_L) p++;
    tube = scene_piece_new(
        pattern.pieces[p].vertex_count, pattern.pieces[p].vertex_count, pattern.pieces[p].triangle_count);
    if (!tube) snprintf(why, YC_MESSAGE_SIZE, "no memory for a sleeve");
    for (i = 0; tube && i < tube->mesh.triangle_count; i++)
        for (k = 0; k < 3; k++) {
            const int t = pattern.pieces[p].first_triangle + i;
            const int v = pattern.triangles[t][k] - pattern.pieces[p].first_vertex;
            tube->triangles[i][k] = tube->uv_triangles[i][k] = v;
            memcpy(tube->uv[v], pattern.uv[pattern.uv_triangles[t][k]], sizeof tube->uv[v]);
            wide = fmax(wide, 2.0 * fabs(tube->uv[v][0]));
        }
    for (i = 0; tube && i < tube->mesh.vertex_count; i++) { /* the seam to the front */
        double angle = 2.0 * pi * tube->uv[i][0] / wide + 0.85 * pi;
        tube->positions[i][0] = 0.5 * wide / pi * sin(angle), tube->positions[i][2] = 0.5 * wide / pi * cos(angle);
        tube->positions[i][1] = tube->uv[i][1];
    }
    for (s = 0; tube && s < pattern.seam_count; s++) {
        const ex_seam *seam = &pattern.seams[s];
        if (pattern.edges[seam->edge_a].piece != p || pattern.edges[seam->edge_b].piece != p) continue;
        for (k = seam->first_pair; k < seam->first_pair + seam->pair_count; k++)
            for (i = 0; i < 3 * tube->mesh.triangle_count; i++)
                if (tube->triangles[i / 3][i % 3] == pattern.pairs[k][1] - pattern.pieces[p].first_vertex)
                    tube->triangles[i / 3][i % 3] = pattern.pairs[k][0] - pattern.pieces[p].first_vertex;
    }
    ex_pattern_free(&pattern);
    return tube;
}

static int cut_piece(void) {
    enum { STEPS = 4 };
    char why[YC_MESSAGE_SIZE] = "";
    scene_piece *mesh = sleeve(why);
    yc_yarn_desc wool = yc_yarn_desc_default();
    yc_knit_desc d = yc_knit_desc_default();
    yc_scene_desc settings = yc_scene_desc_default();
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_scene *scene = NULL;
    yc_knit_rest rest;
    yc_yarns y;
    yc_result result;
    double(*colors)[3] = NULL, seconds = 0.0;
    int i, n, substeps = 0, newton = 0, rods = 0;
    if (!mesh) {
        fprintf(stderr, "knit: piece: %s\n", why);
        return 0;
    }
    memset(&y, 0, sizeof y), memset(&rest, 0, sizeof rest);
    wool.fibre = YC_FIBRE_WOOL, wool.tex = 1500.0;
    d.mesh = &mesh->mesh, d.wales = 120.0, d.courses = 160.0;
    result = yc_yarn_material_make(&wool, &d.yarn, why);
    d.rod = d.yarn;
    if (result == YC_OK) result = yc_knit_relax(NULL, &d, &rest, why);
    d.rest = &rest;
    if (result == YC_OK) result = yc_knit(NULL, &d, &y, why);
    if (result == YC_OK) result = yc_scene_create(NULL, &settings, &scene, why);
    if (result == YC_OK) {
        memset(settings.gravity, 0, sizeof settings.gravity);
        settings.mass_damping = 20.0, settings.dt_max = 2e-3, settings.solver = YC_SOLVER_DIRECT;
        cloth.mesh = mesh->mesh, cloth.yarns = &y, cloth.alpha_uniform = 1.0;
        result = yc_scene_tune(scene, &settings);
        if (result == YC_OK) result = yc_scene_add_cloth(scene, &cloth, NULL);
        for (n = 0; n < STEPS && result == YC_OK; n++) {
            yc_stats stats;
            result = yc_scene_step(scene, 5e-3, &stats);
            substeps += stats.substeps, newton += stats.newton, seconds += stats.seconds;
        }
        if (result != YC_OK) snprintf(why, sizeof why, "%s", yc_scene_message(scene));
    }
    if (result == YC_OK) colors = (double(*)[3])calloc((size_t)y.yarn_count, sizeof *colors);
    if (colors) {
        static const double by_rod[2][3] = {{0.93, 0.91, 0.87}, {0.60, 0.16, 0.14}};
        ex_yarns_view view;
        for (i = 0; i < y.yarn_count; i++) {
            memcpy(colors[i], by_rod[y.yarn_family[i] == YC_ROD], sizeof colors[i]);
            if (y.yarn_family[i] == YC_ROD) rods += y.yarn_first[i + 1] - y.yarn_first[i];
        }
        printf("piece   %d stitch contacts, %d yarns, %d ends in the seam; %d sub-steps, %.1f Newton iterations each, "
               "%.1f s\n",
            y.contact_count, y.yarn_count, rods, substeps, (double)newton / substeps, seconds);
        fflush(stdout);
        memset(&view, 0, sizeof view);
        view.width = 1000, view.height = 800, view.zoom = 0.95, view.fuller = 1.0;
        view.from[0] = 0.1, view.from[1] = 0.3, view.from[2] = 1.0;
        save(scene, &view, (const double(*)[3])colors, "piece", why);
    }
    if (why[0]) fprintf(stderr, "knit: piece: %s\n", why);
    yc_scene_destroy(scene);
    yc_knit_rest_destroy(&rest), yc_yarns_destroy(&y);
    free(colors), scene_piece_free(mesh);
    return !why[0];
}

/* The same camera for all. */
static int sphere(void) {
    enum { WIDE = 640, HIGH = 560, ROWS = 16 };
    static const double radius = 0.016;
    static const double colors[SCENE_FABRICS][1][3] = {{{0.93, 0.91, 0.87}}, {{0.74, 0.34, 0.27}}, {{0.30, 0.43, 0.62}},
        {{0.27, 0.50, 0.47}}, {{0.85, 0.66, 0.33}}, {{0.60, 0.45, 0.60}}}; /* a piece is one yarn */
    const yc_yarn_material wool = scene_soft_wool();
    ex_image *image = ex_image_new(3 * WIDE, 2 * HIGH, 255, 255, 255);
    char why[YC_MESSAGE_SIZE] = "";
    int i, j;
    for (i = 0; i < SCENE_FABRICS && image && !why[0]; i++) {
        const scene_fabric *f = &scene_fabrics[i];
        scene_knit *k = scene_knit_new_above(*f->rows, f->stitches, ROWS, &wool, radius, why);
        scene_knit_drape d;
        ex_yarns_view view;
        ex_camera camera;
        ex_image *panel = NULL;
        double ball[4];
        if (k && scene_knit_fall(k, 0.02, 10) != YC_OK) snprintf(why, sizeof why, "%s", yc_scene_message(k->scene));
        if (!k || why[0]) {
            scene_knit_free(k);
            break;
        }
        d = scene_knit_hang(k);
        printf("sphere  %-18s %2d x %2d  shadow %.2f of flat, %.1f mm deep; %d sub-steps, %.1f Newton iterations each, "
               "%.1f s\n",
            f->name, f->stitches, ROWS, d.shadow, 1e3 * d.depth, k->substeps, (double)k->newton / k->substeps,
            k->seconds);
        fflush(stdout);
        memset(&view, 0, sizeof view), memset(&camera, 0, sizeof camera);
        ball[0] = k->centre[0], ball[1] = k->centre[2], ball[2] = -k->centre[1], ball[3] = radius;
        view.width = WIDE, view.height = HIGH, view.z_up = 1, view.fuller = 1.0, view.ball = ball;
        camera.up[1] = 1.0, camera.fov = 24.0;
        for (j = 0; j < 3; j++) camera.target[j] = ball[j];
        camera.eye[0] = ball[0] + 0.055, camera.eye[1] = ball[1] + 0.1, camera.eye[2] = ball[2] + 0.135;
        panel = ex_yarns_draw(k->scene, 0, &view, colors[i], &camera, 1, why);
        if (panel) {
            ex_image_text(panel, (WIDE - ex_image_text_width(2, f->name)) / 2, HIGH - 30, 2, 0x404040, f->name);
            ex_image_paste(image, panel, i % 3 * WIDE, i / 3 * HIGH);
        }
        ex_image_free(panel), scene_knit_free(k);
    }
    if (image && !why[0] && !ex_image_write_png(image, "out/knit-sphere.png"))
        snprintf(why, sizeof why, "out/knit-sphere.png cannot be written");
    ex_image_free(image);
    if (why[0]) fprintf(stderr, "knit: sphere: %s\n", why);
    return !why[0];
}

/* The same camera for all; lines stand where its middle rows end at first. */
static int plastic(void) {
    enum { WIDE = 660, HIGH = 480, STITCHES = 10, ROWS = 10 };
    static const char *const name[SCENE_PHASES] = {"settled", "drawn out", "let go"};
    static const double color[1][3] = {{0.74, 0.34, 0.27}}; /* a piece is one yarn */
    yc_yarn_material wool = scene_soft_wool();
    const double friction = wool.friction, far = 0.122;
    ex_image *image = ex_image_new(SCENE_PHASES * WIDE, HIGH, 255, 255, 255);
    char why[YC_MESSAGE_SIZE] = "";
    double width[SCENE_PHASES] = {0.0}, line[2] = {0.0, 0.0};
    scene_knit *k;
    int i, phase;
    wool.friction = 0.0;
    k = scene_knit_new(scene_garter, STITCHES, ROWS, &wool, why);
    if (!image) snprintf(why, sizeof why, "no memory for the picture");
    for (phase = 0; k && image && phase < SCENE_PHASES && !why[0]; phase++) {
        ex_yarns_view view;
        ex_camera camera;
        ex_image *panel = NULL;
        char text[64];
        if (scene_knit_overstretch(k, phase, friction, 0.5, &width[phase]) != YC_OK) {
            snprintf(why, sizeof why, "%s", yc_scene_message(k->scene));
            break;
        }
        memset(&view, 0, sizeof view), memset(&camera, 0, sizeof camera);
        view.width = WIDE, view.height = HIGH, view.fuller = 1.0;
        camera.up[1] = 1.0, camera.fov = 24.0;
        camera.target[0] = 0.5 * STITCHES / k->rest.wales, camera.target[1] = 0.5 * ROWS / k->rest.courses;
        memcpy(camera.eye, camera.target, sizeof camera.eye), camera.eye[2] += far;
        for (i = 0; i < k->yarns.node_count && phase == SCENE_BEFORE; i++) {
            const double x = k->x[i][0] - camera.target[0];
            if (fabs(k->start[i][1] - camera.target[1]) > 0.15 * ROWS / k->rest.courses) continue;
            line[0] = fmin(line[0], x), line[1] = fmax(line[1], x);
        }
        panel = ex_yarns_draw(k->scene, 0, &view, color, &camera, 1, why);
        snprintf(text, sizeof text, "%s: stitches of %.2f mm", name[phase], 1e3 * width[phase]);
        if (panel) {
            for (i = 0; i < 2; i++) {
                const double at =
                    0.5 * WIDE + 0.5 * HIGH * line[i] / (far * tan(0.5 * 24.0 * 3.14159265358979 / 180.0));
                ex_image_line(panel, at, 20.0, at, HIGH - 50.0, 1.5, 0x404040);
            }
            ex_image_text(panel, (WIDE - ex_image_text_width(2, text)) / 2, HIGH - 30, 2, 0x404040, text);
            ex_image_paste(image, panel, phase * WIDE, 0);
        }
        ex_image_free(panel);
    }
    if (k && image && !why[0])
        printf("plastic %2d x %2d  drawn out by %.0f %%, then wider by %.1f %%; %d sub-steps, %.1f Newton iterations "
               "each, %.1f s\n",
            STITCHES, ROWS, 100.0 * (width[SCENE_DRAWN] / width[SCENE_BEFORE] - 1.0),
            100.0 * (width[SCENE_AFTER] / width[SCENE_BEFORE] - 1.0), k->substeps, (double)k->newton / k->substeps,
            k->seconds);
    if (image && !why[0] && !ex_image_write_png(image, "out/knit-plastic.png"))
        snprintf(why, sizeof why, "out/knit-plastic.png cannot be written");
    ex_image_free(image), scene_knit_free(k);
    if (why[0]) fprintf(stderr, "knit: plastic: %s\n", why);
    return !why[0];
}

int main(int argc, char **argv) {
    int i, n = (int)(sizeof pieces / sizeof *pieces), found = 0, fine = 1;
    for (i = 0; i < n; i++)
        if (argc < 2 || strcmp(argv[1], pieces[i].name) == 0) found++, fine &= run(pieces + i);
    if (argc < 2 || strcmp(argv[1], "unravel") == 0) found++, fine &= unravel();
    if (argc < 2 || strcmp(argv[1], "piece") == 0) found++, fine &= cut_piece();
    if (argc < 2 || strcmp(argv[1], "sphere") == 0) found++, fine &= sphere();
    if (argc < 2 || strcmp(argv[1], "plastic") == 0) found++, fine &= plastic();
    if (!found)
        fprintf(stderr, "knit: %s is none of curl, rib, garter, lace, unravel, piece, sphere, plastic\n", argv[1]);
    return !(found && fine);
}
