#include "yarns.h"
#include <math.h>
#include <stdlib.h>

static const double pi = 3.14159265358979323846;
static const double bessel_zero = 2.4048255577; /* the first of J0 */

/* ---- runs ----------------------------------------------------------------------------------------------------- */

yc_scene_desc scene_statics(double gravity) {
    yc_scene_desc d = yc_scene_desc_preset(YC_REFERENCE);
    d.gravity[0] = d.gravity[2] = 0.0, d.gravity[1] = -gravity;
    d.dt_max = 1e4, d.mass_damping = 1.0, d.tolerance = 1e-11, d.newton_limit = 400;
    return d;
}

yc_result scene_pin(yc_scene *scene, int node) { return yc_scene_pin(scene, 0, YC_NODE, node, NULL); }

yc_result scene_move(yc_scene *scene, int node, double x, double y, double z) {
    double to[3];
    to[0] = x, to[1] = y, to[2] = z;
    return yc_scene_pin(scene, 0, YC_NODE, node, to);
}

yc_result scene_steps(yc_scene *scene, double h, int steps) {
    yc_result result = YC_OK;
    for (; steps > 0 && result == YC_OK; steps--) result = yc_scene_step(scene, h, NULL);
    return result;
}

yc_result scene_settle(yc_scene *scene) {
    yc_result result = scene_steps(scene, 0.01, 4);
    return result == YC_OK ? scene_steps(scene, 1e4, 3) : result;
}

/* ---- mechanics ------------------------------------------------------------------------------------------------ */

void scene_elastica_shape(double length, double bending, const double force[3], int n, double (*points)[3]) {
    int pass, i, stage, k;
    double low = -20.0 / length, high = 0.0, h = length / n;
    points[0][0] = points[0][1] = points[0][2] = 0.0;
    for (pass = 0; pass < 60; pass++) {
        double y[4] = {0.0, 0.0, 0.0, 0.0}; /* theta, theta', x, y */
        y[1] = 0.5 * (low + high);
        for (i = 0; i < n; i++) { /* Runge and Kutta's fourth order */
            double sum[4] = {0.0, 0.0, 0.0, 0.0}, rate[4] = {0.0, 0.0, 0.0, 0.0}, at[4];
            for (stage = 0; stage < 4; stage++) {
                double c = stage == 0 ? 0.0 : stage == 3 ? h : 0.5 * h;
                for (k = 0; k < 4; k++) at[k] = y[k] + c * rate[k];
                rate[0] = at[1], rate[1] = (force[0] * sin(at[0]) - force[1] * cos(at[0])) / bending;
                rate[2] = cos(at[0]), rate[3] = sin(at[0]);
                for (k = 0; k < 4; k++) sum[k] += (stage == 1 || stage == 2 ? 2.0 : 1.0) * rate[k];
            }
            for (k = 0; k < 4; k++) y[k] += h / 6.0 * sum[k];
            points[i + 1][0] = y[2], points[i + 1][1] = y[3], points[i + 1][2] = 0.0;
        }
        if (y[1] > 0.0) high = 0.5 * (low + high);
        else low = 0.5 * (low + high);
    }
}

double scene_catenary(double span, double length) { /* Newton for span / 2a, from above: it comes down all the way */
    double ratio = length / span, x = 1.0 + 2.0 * log(2.0 * ratio);
    int i;
    for (i = 0; i < 100; i++) x -= (sinh(x) - ratio * x) / (cosh(x) - ratio);
    return 0.5 * span / x;
}

double scene_pendulum_frequency(double gravity, double length) { return 0.5 * bessel_zero * sqrt(gravity / length); }

/* ---- chains --------------------------------------------------------------------------------------------------- */

scene_chain *scene_buckled(int pieces, double length, double shorten, const yc_yarn_material *rod) {
    double from[3] = {0.0, 0.0, 0.0}, to[3] = {0.0, 0.0, 0.0};
    scene_chain *chain;
    int i;
    to[0] = length;
    chain = scene_chain_new(pieces, length, from, to, rod);
    for (i = 0; chain && i <= pieces; i++) {
        double s = (double)i / pieces;
        chain->positions[i][1] = length * sqrt(4.0 * shorten) / pi * sin(pi * s);
        chain->positions[i][0] = length * (s * (1.0 - shorten) - shorten * sin(2.0 * pi * s) / (2.0 * pi));
    }
    return chain;
}

scene_chain *scene_hung(int pieces, double length, double span, const yc_yarn_material *material) {
    double from[3] = {0.0, 0.0, 0.0}, to[3] = {0.0, 0.0, 0.0}, depth = 0.5 * sqrt(length * length - span * span);
    scene_chain *chain;
    int i;
    from[0] = -0.5 * span, to[0] = 0.5 * span;
    chain = scene_chain_new(pieces, length, from, to, material);
    for (i = 0; chain && i <= pieces; i++) chain->positions[i][1] = -depth * (1.0 - fabs(2.0 * i / pieces - 1.0));
    return chain;
}

scene_chain *scene_pendulum(int pieces, double length, double swing, const yc_yarn_material *material) {
    double from[3] = {0.0, 0.0, 0.0}, to[3] = {0.0, 0.0, 0.0}, piece = length / pieces;
    scene_chain *chain;
    int i, k;
    to[1] = -length;
    chain = scene_chain_new(pieces, length, from, to, material);
    for (i = 0; chain && i <= pieces; i++) {
        double(*x)[3] = chain->positions, z = 0.5 * bessel_zero * sqrt(1.0 - (double)i / pieces), term = 1.0, sum = 1.0;
        for (k = 1; k < 12; k++) term *= -z * z / (k * k), sum += term;
        x[i][0] = swing * length * sum;
        if (i) x[i][1] = x[i - 1][1] - sqrt(piece * piece - (x[i][0] - x[i - 1][0]) * (x[i][0] - x[i - 1][0]));
    }
    return chain;
}

/* ---- networks ------------------------------------------------------------------------------------------------- */

scene_net *scene_net_new(int nodes, int yarns, int visits) {
    scene_net *net = (scene_net *)calloc(1, sizeof *net);
    size_t n = (size_t)nodes, m = (size_t)yarns, k = (size_t)visits;
    yc_yarns *y;
    if (!net) return NULL;
    y = &net->yarns;
    net->positions = y->layout = (double(*)[3])calloc(n, sizeof *y->layout);
    y->yarn_first = (int *)calloc(m + 1, sizeof(int)), y->yarn_family = (unsigned char *)calloc(m, 1);
    y->yarn_material = (int *)calloc(m, sizeof(int)), y->visit_node = (int *)calloc(k, sizeof(int));
    y->visit_u = (double *)calloc(k, sizeof(double)), y->visit_layer = (signed char *)calloc(k, 1);
    y->visit_held = (unsigned char *)calloc(k, 1);
    y->materials = (yc_yarn_material *)calloc(m, sizeof *y->materials);
    if (!y->layout || !y->yarn_first || !y->yarn_family || !y->yarn_material || !y->visit_node || !y->visit_u ||
        !y->visit_layer || !y->visit_held || !y->materials) {
        scene_net_free(net);
        return NULL;
    }
    net->cloth = yc_cloth_desc_default();
    net->cloth.yarns = y;
    return net;
}

void scene_net_free(scene_net *net) {
    if (!net) return;
    free(net->yarns.layout), free(net->yarns.yarn_first), free(net->yarns.yarn_family), free(net->yarns.yarn_material);
    free(net->yarns.visit_node), free(net->yarns.visit_u), free(net->yarns.visit_layer), free(net->yarns.visit_held);
    free(net->yarns.materials), free(net);
}

int scene_net_node(scene_net *net, double x, double y, double z) {
    double *at = net->positions[net->yarns.node_count];
    at[0] = x, at[1] = y, at[2] = z;
    return net->yarns.node_count++;
}

void scene_net_yarn(scene_net *net, int family, const yc_yarn_material *material) {
    yc_yarns *y = &net->yarns;
    y->yarn_family[y->yarn_count] = (unsigned char)family, y->yarn_material[y->yarn_count] = y->yarn_count;
    y->materials[y->yarn_count++] = *material, y->material_count = y->yarn_count;
    y->yarn_first[y->yarn_count] = y->visit_count;
}

void scene_net_visit(scene_net *net, int node, double u, int layer, int held) {
    yc_yarns *y = &net->yarns;
    int k = y->visit_count++;
    y->visit_node[k] = node, y->visit_u[k] = u;
    y->visit_layer[k] = (signed char)layer, y->visit_held[k] = (unsigned char)held;
    y->yarn_first[y->yarn_count] = y->visit_count;
}

/* A yarn that does nothing but stretch, too thin to press anything aside. */
static yc_yarn_material thread(double stretch, double density) {
    yc_yarn_material m = yc_yarn_material_default();
    m.stretch = stretch, m.density = density, m.radius = 1e-14;
    m.bending = m.shear = m.contact = m.friction = 0.0, m.slide = 1e5;
    return m;
}

scene_net *scene_tip_load(int pieces, double length, const yc_yarn_material *rod, double soft_stretch) {
    scene_net *net = scene_net_new(pieces + 2, 2, pieces + 3);
    yc_yarn_material soft = thread(soft_stretch, 1e-12);
    double piece = length / (pieces - 0.5);
    int i;
    if (!net) return NULL;
    scene_net_yarn(net, YC_WEFT, rod);
    for (i = 0; i <= pieces; i++)
        scene_net_visit(net, scene_net_node(net, piece * (i - 0.5), 0.0, 0.0), piece * i, 0, 1);
    scene_net_yarn(net, YC_WEFT, &soft);
    scene_net_visit(net, pieces, 0.0, 0, 1);
    scene_net_visit(net, scene_net_node(net, length, -100.0, 0.0), 100.0, 0, 1);
    return net;
}

scene_bead_desc scene_bead_desc_default(void) {
    scene_bead_desc d;
    d.pieces = 4, d.length = 0.4, d.start = -0.1, d.tension = 10.0, d.half = 5e-3, d.mass = 1e-5, d.friction = 0.3;
    return d;
}

scene_net *scene_bead(const scene_bead_desc *d) {
    int i, bar = 2 * d->pieces;
    scene_net *net = scene_net_new(bar + 3, 2, bar + 4);
    yc_yarn_material wire = thread(1e5, 1e-9), rod = thread(1e3, d->mass / (2.0 * d->half));
    double shrink = 1.0 / (1.0 + d->tension / wire.stretch);
    if (!net) return NULL;
    wire.friction = rod.friction = d->friction;
    rod.bending = 1e-5;
    scene_net_node(net, -0.5 * d->length, 0.0, 0.0), scene_net_node(net, 0.5 * d->length, 0.0, 0.0);
    scene_net_node(net, d->start, 0.0, 0.0);
    scene_net_yarn(net, YC_WEFT, &wire);
    scene_net_visit(net, 0, 0.0, 0, 1);
    scene_net_visit(net, 2, shrink * (d->start + 0.5 * d->length), -1, 0);
    scene_net_visit(net, 1, shrink * d->length, 0, 1);
    scene_net_yarn(net, YC_WARP, &rod); /* towards -z: x cross -z is y, from the wire to the bar */
    for (i = 0; i <= bar; i++) {
        double u = 2.0 * d->half * i / bar;
        int middle = i == d->pieces;
        scene_net_visit(net, middle ? 2 : scene_net_node(net, d->start, 0.0, d->half - u), u, middle, 1);
    }
    return net;
}

yc_scene_desc scene_bead_settings(void) {
    yc_scene_desc d = yc_scene_desc_preset(YC_REFERENCE);
    d.dt_max = 1.0, d.newton_limit = 10000, d.tolerance = 1e-14;
    return d;
}

yc_result scene_bead_tilt(yc_scene *scene, double slope) {
    yc_scene_desc tilted = scene_bead_settings();
    yc_result result = scene_pin(scene, 0);
    tilted.gravity[0] = 9.81 * sin(slope), tilted.gravity[1] = -9.81 * cos(slope);
    if (result == YC_OK) result = scene_pin(scene, 1);
    if (result == YC_OK) result = scene_steps(scene, 1e-3, 10);
    return result == YC_OK ? yc_scene_tune(scene, &tilted) : result;
}

scene_capstan_desc scene_capstan_desc_default(void) {
    scene_capstan_desc d;
    d.crossings = 8, d.wrap = pi, d.segment = 5e-3, d.tension = 1.0, d.stretch = 1e4;
    d.friction = 0.3;
    return d;
}

scene_net *scene_capstan(const scene_capstan_desc *d) {
    int n = d->crossings, i, k;
    scene_net *net = scene_net_new(3 * n + 3, n + 2, 4 * n + 4);
    yc_yarn_material yarn = thread(d->stretch, 1e-6), post = thread(1e6, 1e-6), load = thread(d->tension, 1e-6);
    double turn = d->wrap / n, at[2] = {0.0, 0.0}, half = 2e-3, back = 0.5 * d->wrap;
    if (!net) return NULL;
    yarn.friction = post.friction = d->friction, yarn.slide = post.slide = 1e8;
    scene_net_yarn(net, YC_WEFT, &yarn);
    for (i = 0; i <= n + 1; i++) { /* it turns clockwise around the posts, which lie below it */
        double heading = 0.5 * d->wrap - turn * i;
        scene_net_visit(net, scene_net_node(net, at[0], at[1], 0.0), d->segment * i / (1.0 + d->tension / d->stretch),
            i > 0 && i <= n, i == 0 || i > n);
        at[0] += d->segment * cos(heading), at[1] += d->segment * sin(heading);
    }
    scene_net_yarn(net, YC_WEFT, &load); /* of 1 m, drawn out to 2 m */
    scene_net_visit(net, scene_net_node(net, -2.0 * cos(back), -2.0 * sin(back), 0.0), 0.0, 0, 1);
    scene_net_visit(net, 0, 1.0, 0, 1);
    for (i = 1; i <= n; i++) { /* towards -z: x cross -z is y, from the post to the yarn */
        const double *x = net->positions[i];
        scene_net_yarn(net, YC_WARP, &post);
        for (k = -1; k <= 1; k++)
            scene_net_visit(net, k ? scene_net_node(net, x[0], x[1], -k * half) : i, k * half / 1.1, k ? 0 : -1, 1);
    }
    return net;
}

yc_result scene_capstan_draw(yc_scene *scene, const scene_net *net, const scene_capstan_desc *d) {
    int n = d->crossings, i, k;
    const double *a = net->positions[n], *b = net->positions[n + 1];
    double piece = 0.2 * (n + 1) * d->tension / d->stretch, to[3]; /* of a segment */
    yc_result result = YC_OK;
    for (i = n + 2; i < net->yarns.node_count && result == YC_OK; i++) result = scene_pin(scene, i);
    for (i = 1; i <= 16 && result == YC_OK; i++) {
        for (k = 0; k < 3; k++) to[k] = b[k] + i * piece * (b[k] - a[k]);
        result = scene_move(scene, n + 1, to[0], to[1], to[2]);
        if (result == YC_OK) result = scene_steps(scene, 1.0, 1);
    }
    return result;
}
