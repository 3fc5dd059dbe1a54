/* One yarn against mechanics, drawn as a tube, and what mechanics says of it as a thin dark line over it.
 *
 *     yarn [cantilever|buckle|catenary|pendulum|bead|capstan]      all of them without a name
 *
 * cantilever  a rod clamped level under loads on its tip: the elastica
 * buckle      a rod between two pins, pressed together: Euler's load, and the elastica beyond it
 * catenary    a yarn without stiffness hangs between two pins
 * pendulum    the same, hung up at one end, swings in its lowest mode: Bernoulli's hanging chain
 * bead        a bar slides down a taut wire, on which it rests, against friction
 * capstan     a yarn is drawn over posts: tension grows as Euler's exp(mu theta)
 * Each prints a table and writes out/yarn-NAME.png. They are the scenes of tests/test_woven.c. Yarns are drawn thicker
 * than they are: where contact is not what counts, their radius is next to nothing. */
#include "common/ex_lines.h"
#include "tests/scenes/yarns.h"
#include "yarncloth.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

enum { MOST_NODES = 128, LABEL = 40, CURVE = 200 };

typedef struct lab {
    const char *name;
    int ok;
    yc_scene *scene;
    double x[MOST_NODES][3]; /* where nodes are since the last look */
    ex_lines *p;
} lab;

/* ---- runs ---- */

/* The first failure is told, later calls do nothing. */
static int fine(lab *l, yc_result result, const char *why) {
    if (l->ok && result != YC_OK) fprintf(stderr, "%s: %s: %s\n", l->name, yc_result_name(result), why), l->ok = 0;
    return l->ok;
}

static int worked(lab *l, yc_result result) { return fine(l, result, yc_scene_message(l->scene)); }

/* A new picture; a new scene. */
static int frame(lab *l, int width, int height, double x, double y, double wide) {
    free(l->p), l->p = ex_lines_new(width, height, x, y, wide);
    return fine(l, l->p ? YC_OK : YC_ERROR_MEMORY, "picture");
}

static int start(lab *l, const yc_scene_desc *settings, const yc_cloth_desc *cloth) {
    char why[YC_MESSAGE_SIZE] = "network";
    yc_scene_destroy(l->scene), l->scene = NULL;
    if (!fine(l, cloth ? yc_scene_create(NULL, settings, &l->scene, why) : YC_ERROR_MEMORY, why)) return 0;
    return worked(l, yc_scene_add_cloth(l->scene, cloth, NULL));
}

static int look(lab *l) { return l->ok && worked(l, yc_scene_positions(l->scene, 0, YC_NODE, l->x)); }

static int steps(lab *l, double h, int count) { return l->ok && worked(l, scene_steps(l->scene, h, count)) && look(l); }

static void pin(lab *l, int node) {
    if (l->ok) worked(l, scene_pin(l->scene, node));
}

static void move(lab *l, int node, double x, double y) {
    if (l->ok) worked(l, scene_move(l->scene, node, x, y, 0.0));
}

static void force_at(lab *l, int node, double force[3]) {
    force[0] = force[1] = force[2] = 0.0;
    if (l->ok) worked(l, yc_scene_pin_force(l->scene, 0, YC_NODE, node, force));
}

/* A row of the table. */
static void compare(const char *what, double simulated, double exact) {
    printf("  %-36s %12.6g %12.6g %9.5f\n", what, simulated, exact, simulated / exact);
}

/* ---- pictures ---- */

static const double steel[3] = {0.45, 0.47, 0.50}, *const exact = NULL;

/* A pin, seen from its end. */
static void peg(lab *l, double x, double y, double radius) {
    double ends[2][3] = {{0.0}};
    ends[0][0] = ends[1][0] = x, ends[0][1] = ends[1][1] = y, ends[1][2] = 1e-2 * radius;
    ex_lines_add(l->p, ends, 2, radius, steel, "");
}

/* From blue for 0 over violet to red for 1. */
static const double *shade(double share) {
    static const double stops[3][3] = {{0.30, 0.58, 0.86}, {0.70, 0.52, 0.82}, {0.93, 0.42, 0.32}};
    static double color[3];
    int i = share > 0.5, k;
    for (k = 0; k < 3; k++) color[k] = stops[i][k] + (2.0 * share - i) * (stops[i + 1][k] - stops[i][k]);
    return color;
}

static void save(lab *l, ex_image *image) {
    char path[64];
    snprintf(path, sizeof path, "out/yarn-%s.png", l->name);
    if (l->ok && !(image && ex_image_write_png(image, path))) fine(l, YC_ERROR_ARGUMENT, path);
    if (l->ok) printf("  %s\n", path);
    ex_image_free(image);
}

static void draw(lab *l, const char *title) {
    if (l->ok) save(l, ex_lines_draw(l->p, title));
}

/* ---- rods ---- */

static yc_yarn_material rod_of(double stretch, double bending, double density) {
    yc_yarn_material m = yc_yarn_material_default();
    m.stretch = stretch, m.bending = bending, m.density = density;
    return m;
}

static void cantilever(lab *l) {
    enum { PIECES = 64, STATES = 6 };
    static const double loads[STATES] = {0.0, 0.5, 1.0, 2.0, 4.0, 8.0};
    const double length = 0.1, bending = 1e-5, soft = 1e-2, unit = bending / (length * length);
    const yc_scene_desc settings = scene_statics(0.0);
    const yc_yarn_material rod = rod_of(1e4, bending, 1e-5);
    scene_net *net = scene_tip_load(PIECES, length, &rod, soft);
    double force[3], curve[CURVE + 1][3], post[2][3] = {{-0.003, 0.007, 0.0}, {-0.003, -0.007, 0.0}};
    char text[LABEL];
    int i;
    if (frame(l, 1000, 760, 0.054, -0.036, 0.138) && start(l, &settings, net ? &net->cloth : NULL)) {
        pin(l, 0), pin(l, 1);
        for (i = 0; i < STATES; i++) {
            move(l, PIECES + 1, length, -100.0 * (1.0 + loads[i] * unit / soft));
            if (!steps(l, 1e4, 3)) break;
            force_at(l, PIECES + 1, force);
            scene_elastica_shape(length, bending, force, CURVE, curve);
            snprintf(text, sizeof text, "%.1f", loads[i]);
            ex_lines_add(l->p, l->x, PIECES + 1, 1.1e-3, shade(i / (STATES - 1.0)), "");
            ex_lines_add(l->p, curve, CURVE + 1, 0.0, exact, text);
            if (!i) continue;
            snprintf(text, sizeof text, "drop/L at P L^2/EI = %.1f", -force[1] / unit);
            compare(text, -l->x[PIECES][1] / length, -curve[CURVE][1] / length);
        }
        ex_lines_add(l->p, post, 2, 3e-3, steel, "");
        draw(l, "cantilever, P L^2/EI: tubes simulated, lines the elastica");
    }
    scene_net_free(net);
}

/* Euler's elastica between two pins, as far apart as the span: half of it is clamped level in its middle. Returns its
 * force. */
static double buckled(double length, double bending, double span, double (*curve)[3]) {
    const double euler = pi * pi * bending / (length * length);
    double low = euler, high = 8.0 * euler, force[3] = {0.0, 0.0, 0.0}, half[CURVE / 2 + 1][3];
    int pass, i;
    for (pass = 0; pass < 40; pass++) {
        force[0] = -0.5 * (low + high);
        scene_elastica_shape(0.5 * length, bending, force, CURVE / 2, half);
        if (2.0 * half[CURVE / 2][0] > span) low = -force[0];
        else high = -force[0];
    }
    for (i = 0; i <= CURVE; i++) {
        const double *x = half[abs(i - CURVE / 2)];
        curve[i][0] = 0.5 * span + (i < CURVE / 2 ? -x[0] : x[0]);
        curve[i][1] = x[1] - half[CURVE / 2][1], curve[i][2] = 0.0;
    }
    return -force[0];
}

static void buckle(lab *l) {
    enum { PIECES = 64, STATES = 6 };
    static const double shorten[STATES] = {0.01, 0.1, 0.2, 0.35, 0.5, 0.65};
    const double length = 0.1, bending = 1e-5, euler = pi * pi * bending / (length * length);
    const yc_scene_desc settings = scene_statics(0.0);
    const yc_yarn_material rod = rod_of(1e4, bending, 1e-5);
    scene_chain *chain = scene_buckled(PIECES, length, shorten[0], &rod);
    double force[3], law, curve[CURVE + 1][3];
    char text[LABEL];
    int i;
    if (frame(l, 1000, 560, 0.05, 0.017, 0.124) && start(l, &settings, chain ? &chain->cloth : NULL)) {
        pin(l, 0), peg(l, 0.0, 0.0, 1.6e-3);
        for (i = 0; i < STATES; i++) {
            move(l, PIECES, length * (1.0 - shorten[i]), 0.0);
            if (!steps(l, 1e4, 3)) break;
            force_at(l, PIECES, force), law = buckled(length, bending, length * (1.0 - shorten[i]), curve);
            snprintf(text, sizeof text, "P/Euler, shorter by %.0f %%", 100.0 * shorten[i]);
            compare(text, -force[0] / euler, law / euler);
            snprintf(text, sizeof text, "\n%.2f", -force[0] / euler);
            ex_lines_add(l->p, l->x, PIECES + 1, 1e-3, shade(i / (STATES - 1.0)), "");
            ex_lines_add(l->p, curve, CURVE + 1, 0.0, exact, text);
            peg(l, l->x[PIECES][0], 0.0, 1.6e-3);
        }
        draw(l, "buckling, force over Euler's: tubes simulated, lines the elastica");
    }
    scene_chain_free(chain);
}

/* ---- hanging yarns ---- */

static void catenary(lab *l) {
    enum { PIECES = 120, STATES = 6 };
    const double length = 0.3, density = 1e-3, gravity = 9.81;
    const yc_scene_desc settings = scene_statics(gravity);
    const yc_yarn_material yarn = rod_of(1e3, 0.0, density);
    double force[3], curve[CURVE + 1][3];
    char text[LABEL];
    int i, k;
    frame(l, 1000, 580, 0.0, -0.078, 0.33);
    for (i = 0; l->ok && i < STATES; i++) {
        double span = 0.29 - 0.05 * i, a = scene_catenary(span, length), sag = a * (cosh(0.5 * span / a) - 1.0);
        scene_chain *chain = scene_hung(PIECES, length, span, &yarn);
        if (start(l, &settings, chain ? &chain->cloth : NULL)) {
            pin(l, 0), pin(l, PIECES);
            if (l->ok && worked(l, scene_settle(l->scene)) && look(l)) {
                force_at(l, PIECES, force);
                for (k = 0; k <= CURVE; k++) {
                    curve[k][0] = span * ((double)k / CURVE - 0.5);
                    curve[k][1] = a * cosh(curve[k][0] / a) - a - sag, curve[k][2] = 0.0;
                }
                ex_lines_add(l->p, l->x, PIECES + 1, 2.2e-3, shade(i / (STATES - 1.0)), "");
                ex_lines_add(l->p, curve, CURVE + 1, 0.0, exact, "");
                peg(l, -0.5 * span, 0.0, 3.5e-3), peg(l, 0.5 * span, 0.0, 3.5e-3);
                snprintf(text, sizeof text, "sag, mm, span %.0f mm", 1e3 * span);
                compare(text, -1e3 * l->x[PIECES / 2][1], 1e3 * sag);
                compare("  horizontal force, mN", 1e3 * force[0], 1e3 * density * gravity * a);
            }
        }
        scene_chain_free(chain);
    }
    draw(l, "a hanging yarn: tubes simulated, lines catenaries");
}

static void pendulum(lab *l) {
    enum { PIECES = 64, STATES = 7, STEPS = 160 };
    const double length = 0.2, swing = 0.16, period = 2.0 * pi / scene_pendulum_frequency(9.81, length);
    const double h = 0.5 * period / ((STATES - 1) * STEPS);
    const yc_yarn_material yarn = rod_of(1e4, 0.0, 1e-4);
    yc_scene_desc settings = yc_scene_desc_preset(YC_REFERENCE);
    scene_chain *chain = scene_pendulum(PIECES, length, swing, &yarn);
    double before = swing, crossing[2] = {0.0, 0.0};
    char text[LABEL];
    int i, found = 0;
    settings.tolerance = 1e-11, settings.dt_max = 1.0;
    if (frame(l, 640, 900, 0.0, -0.108, 0.165) && start(l, &settings, chain ? &chain->cloth : NULL) && look(l)) {
        pin(l, 0), peg(l, 0.0, 0.0, 3e-3);
        for (i = 0; found < 2 && i < 3 * STATES * STEPS && l->ok; i++) {
            if (i % STEPS == 0 && i < STATES * STEPS) {
                int k = i / STEPS;
                scene_chain *law = scene_pendulum(PIECES, length, swing * cos(pi * k / (STATES - 1)), &yarn);
                if (!fine(l, law ? YC_OK : YC_ERROR_MEMORY, "curve")) break;
                snprintf(text, sizeof text, "swing/L at %d/%d of a period", k, 2 * (STATES - 1));
                if (2 * k != STATES - 1) compare(text, l->x[PIECES][0] / length, law->positions[PIECES][0] / length);
                ex_lines_add(l->p, l->x, PIECES + 1, 1.2e-3, shade(k / (STATES - 1.0)), "");
                ex_lines_add(l->p, law->positions, PIECES + 1, 0.0, exact, "");
                scene_chain_free(law);
            }
            before = l->x[PIECES][0];
            if (steps(l, h, 1) && before * l->x[PIECES][0] <= 0.0)
                crossing[found++] = h * (i + before / (before - l->x[PIECES][0]));
        }
        compare("period, s", 2.0 * (crossing[1] - crossing[0]), period);
        draw(l, "a swinging yarn: tubes simulated, lines J0");
    }
    scene_chain_free(chain);
}

/* ---- yarns that slide ---- */

/* Turns about z by an angle, then so that it is seen from its right and from above: what lies along z shows. */
static void seen(double x[3], double tilt) {
    const double right = 0.4, above = 0.3;
    const double u = x[0] * cos(tilt) + x[1] * sin(tilt), v = x[1] * cos(tilt) - x[0] * sin(tilt);
    const double w = x[2] * cos(right) + u * sin(right);
    x[0] = u * cos(right) - x[2] * sin(right), x[1] = v * cos(above) - w * sin(above);
    x[2] = v * sin(above) + w * cos(above);
}

static void bead(lab *l) {
    enum { STATES = 5 };
    const double slope = 0.7, h = 5e-4, pause = 0.05, wire = 0.6e-3, bar = 1.3e-3;
    scene_bead_desc d = scene_bead_desc_default();
    const double a = 9.81 * (sin(slope) - d.friction * cos(slope));
    const yc_scene_desc settings = scene_bead_settings();
    double ends[2][3], from;
    char text[LABEL];
    scene_net *net;
    int i, k;
    d.pieces = 32, net = scene_bead(&d); /* the share 1 / (4 pieces) of friction is missing: see test_woven.c */
    if (frame(l, 1000, 700, 0.0, 0.0, 0.13) && start(l, &settings, net ? &net->cloth : NULL) &&
        worked(l, scene_bead_tilt(l->scene, slope)) && look(l)) {
        double middle[3] = {0.0, 0.0, 0.0};
        from = l->x[2][0], middle[0] = from + 0.5 * a * pause * pause * (STATES - 1) * (STATES - 1) / 2.0;
        seen(middle, slope), memcpy(l->p->at, middle, sizeof l->p->at);
        memcpy(ends, l->x, sizeof ends);
        for (k = 0; k < 2; k++) seen(ends[k], slope);
        ex_lines_add(l->p, ends, 2, wire, steel, "");
        for (i = 0; i < STATES; i++) {
            const double t = i * pause, law = 0.5 * a * t * t;
            if (i && !steps(l, h, (int)(pause / h + 0.5))) break;
            snprintf(text, sizeof text, "distance, mm, at %.0f ms", 1e3 * t);
            if (i) compare(text, 1e3 * (l->x[2][0] - from), 1e3 * law);
            snprintf(text, sizeof text, "%.0f ms", 1e3 * t);
            for (k = 0; k < 2; k++) { /* its first and last node, on top of the wire */
                memcpy(ends[k], l->x[k ? 2 + 2 * d.pieces : 3], sizeof ends[k]);
                ends[k][1] += wire + bar, seen(ends[k], slope);
            }
            ex_lines_add(l->p, ends, 2, bar, shade(i / (STATES - 1.0)), text);
            for (k = 0; k < 2; k++) {
                ends[k][0] = from + law, ends[k][1] = wire + bar, ends[k][2] = k ? -d.half : d.half;
                seen(ends[k], slope);
            }
            ex_lines_add(l->p, ends, 2, 0.0, exact, "");
        }
        draw(l, "a bar slides down a wire: bars simulated, lines a t^2 / 2");
    }
    scene_net_free(net);
}

/* Tension of each segment of the first yarn. */
static void tensions(lab *l, int count, double *out) {
    yc_yarns now;
    int i, k;
    if (!l->ok || !worked(l, yc_scene_network(l->scene, 0, &now)) || !look(l)) return;
    for (i = 0; i < count; i++) {
        const double *a = l->x[now.visit_node[i]], *b = l->x[now.visit_node[i + 1]];
        double length = 0.0;
        for (k = 0; k < 3; k++) length += (b[k] - a[k]) * (b[k] - a[k]);
        out[i] =
            now.materials[now.yarn_material[0]].stretch * (sqrt(length) / (now.visit_u[i + 1] - now.visit_u[i]) - 1.0);
    }
}

/* The yarn, coloured by its tension, over its posts, and where the soft yarn begins that draws it back. */
static ex_image *over_posts(lab *l, const scene_capstan_desc *d, const double *tension, const char *title) {
    const double yarn = 0.7e-3, post = 0.9e-3, half = 3.5e-3, loose = 5e-3;
    const double in = 1.0 - 2.0 * (yarn + post) * sin(0.5 * d->wrap / d->crossings) / d->segment; /* of their circle */
    const int n = d->crossings;
    double x[2][3], middle[2] = {0.0, 0.0};
    char text[LABEL];
    int i, k;
    if (!l->ok || !frame(l, 520, 520, 0.0, -0.002, 0.040)) return NULL;
    for (i = 1; i <= n; i++) middle[0] += l->x[i][0] / n, middle[1] += l->x[i][1] / n;
    for (i = -1; i <= n; i++) { /* segments */
        for (k = 0; k < 2; k++) {
            const double *node = l->x[i < 0 ? 0 : i + k];
            x[k][0] = node[0] - middle[0], x[k][1] = node[1] - middle[1], x[k][2] = 0.0;
            if (i < 0 && !k) x[k][1] -= loose;
            seen(x[k], 0.0);
        }
        text[0] = '\0';
        if (i == n) snprintf(text, sizeof text, "%.2f T0", tension[n] / d->tension);
        ex_lines_add(l->p, x, 2, i < 0 ? 0.4 * yarn : yarn,
            i < 0 ? steel : shade((tension[i] / d->tension - 1.0) / (exp(d->friction * d->wrap) - 1.0)), text);
    }
    for (i = 1; i <= n; i++) { /* the yarn's axis runs through the nodes */
        for (k = 0; k < 2; k++) {
            x[k][0] = in * (l->x[i][0] - middle[0]), x[k][1] = in * (l->x[i][1] - middle[1]);
            x[k][2] = k ? half : -half, seen(x[k], 0.0);
        }
        ex_lines_add(l->p, x, 2, post, steel, "");
    }
    return ex_lines_draw(l->p, title);
}

static void capstan(lab *l) {
    enum { WIDE = 520, HIGH = 520, POSTS = 8 };
    scene_capstan_desc d = scene_capstan_desc_default();
    const yc_scene_desc settings = scene_statics(0.0);
    double tension[POSTS + 1] = {0.0}, angle[POSTS + 1], curve[2][CURVE + 1];
    ex_image *image = ex_image_new(3 * WIDE, HIGH, 244, 244, 244), *shown[2] = {NULL, NULL};
    scene_net *net;
    ex_plot plot;
    char text[LABEL];
    int i;
    d.crossings = POSTS, net = scene_capstan(&d);
    if (image && start(l, &settings, net ? &net->cloth : NULL)) {
        tensions(l, POSTS + 1, tension), shown[0] = over_posts(l, &d, tension, "before");
        if (l->ok) worked(l, scene_capstan_draw(l->scene, net, &d));
        tensions(l, POSTS + 1, tension), shown[1] = over_posts(l, &d, tension, "drawn, T0 at its left end");
        for (i = 0; i <= POSTS; i++) {
            angle[i] = d.wrap * i / POSTS, tension[i] /= d.tension;
            snprintf(text, sizeof text, "T/T0 behind post %d", i);
            compare(text, tension[i], exp(d.friction * angle[i]));
        }
        for (i = 0; i <= CURVE; i++) curve[0][i] = d.wrap * i / CURVE, curve[1][i] = exp(d.friction * curve[0][i]);
        ex_plot_begin(
            &plot, image, 2 * WIDE, 0, WIDE - 16, HIGH - 8, 0.0, d.wrap, 0.0, 3.0, "tension", "theta, rad", "T / T0");
        ex_plot_curve(&plot, curve[0], curve[1], CURVE + 1, 0x202428, "exp(mu theta)");
        ex_plot_points(&plot, angle, tension, POSTS + 1, 0xc8452b, "yarn");
        for (i = 0; i < 2; i++)
            if (shown[i]) ex_image_paste(image, shown[i], i * WIDE, 0);
        save(l, image), image = NULL;
    }
    for (i = 0; i < 2; i++) ex_image_free(shown[i]);
    ex_image_free(image), scene_net_free(net);
}

int main(int argc, char **argv) {
    static const struct {
        const char *name;
        void (*run)(lab *);
    } scenes[] = {{"cantilever", cantilever}, {"buckle", buckle}, {"catenary", catenary}, {"pendulum", pendulum},
        {"bead", bead}, {"capstan", capstan}};
    int i, found = 0, ok = 1;
    for (i = 0; i < (int)(sizeof scenes / sizeof *scenes); i++) {
        lab l;
        if (argc > 1 && strcmp(argv[1], scenes[i].name) != 0) continue;
        memset(&l, 0, sizeof l), l.name = scenes[i].name, l.ok = found = 1;
        printf("%-38s %12s %12s %9s\n", l.name, "simulated", "mechanics", "ratio");
        scenes[i].run(&l);
        yc_scene_destroy(l.scene), free(l.p), ok = l.ok && ok;
    }
    if (!found) fprintf(stderr, "usage: yarn [cantilever|buckle|catenary|pendulum|bead|capstan]\n");
    return found ? !ok : 2;
}
