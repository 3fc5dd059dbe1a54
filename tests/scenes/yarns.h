/* Networks of a few yarns made by hand, for tests against mechanics, benchmarks and pictures, and the mechanics. As in
 * scenes.h, a maker returns NULL when memory is out, and what it made is freed by the function beside it. */
#ifndef SCENES_YARNS_H
#define SCENES_YARNS_H

#include "scenes.h"

/* Backward Euler over a step far longer than any vibration is a minimisation of the energy. Gravity along -y. */
yc_scene_desc scene_statics(double gravity);

/* Lets a yarn fall for a moment, then comes to rest. */
yc_result scene_settle(yc_scene *scene);

/* Of the yarn nodes of the first cloth; the first holds one where it is. */
yc_result scene_pin(yc_scene *scene, int node);
yc_result scene_move(yc_scene *scene, int node, double x, double y, double z);
yc_result scene_steps(yc_scene *scene, double h, int steps);

/* The shape of a rod clamped level at the origin, under a force on its tip, as n + 1 points from there: EI theta'' = fx
 * sin(theta) - fy cos(theta), theta(0) = 0, theta'(length) = 0, by shooting for the one that bends down throughout. */
void scene_elastica_shape(double length, double bending, const double force[3], int n, double (*points)[3]);

/* A rod between two nodes to be pinned, brought together by that share of its length: half a wave of about that
 * length, upwards. */
scene_chain *scene_buckled(int pieces, double length, double shorten, const yc_yarn_material *rod);

/* A yarn between two nodes to be pinned, as far apart as the span, symmetric to x = 0; it starts as a V. */
scene_chain *scene_hung(int pieces, double length, double span, const yc_yarn_material *material);

/* The a of its catenary y = a cosh(x / a): 2 a sinh(span / 2 a) = length. */
double scene_catenary(double span, double length);

/* A yarn hung up at node 0 in the shape of its lowest mode, J0 of j times the root of the height, whose lower end
 * stands aside by `swing` of the length; and the frequency of Bernoulli's hanging chain, j / 2 sqrt(g / length), rad/s,
 * j the first zero of J0. */
scene_chain *scene_pendulum(int pieces, double length, double swing, const yc_yarn_material *material);
double scene_pendulum_frequency(double gravity, double length);

/* A network in the making: nodes, then one yarn after another, visit by visit. */
typedef struct scene_net {
    yc_cloth_desc cloth; /* ready for yc_scene_add_cloth once every yarn has its visits */
    yc_yarns yarns;
    double (*positions)[3]; /* [yarns.node_count], where nodes start; also their layout */
} scene_net;

/* Room for that many; a material for each yarn. */
scene_net *scene_net_new(int nodes, int yarns, int visits);
void scene_net_free(scene_net *net);

/* Adds a node, a yarn, a visit of the last yarn; the first returns its number. A visit slides where `held` is 0. */
int scene_net_node(scene_net *net, double x, double y, double z);
void scene_net_yarn(scene_net *net, int family, const yc_yarn_material *material);
void scene_net_visit(scene_net *net, int node, double u, int layer, int held);

/* A cantilever and what pulls at its tip: a yarn of `pieces` segments along x, its first two nodes to be pinned, free
 * over `length` from the middle of the first segment, where the hinge of the second node begins to bend; and a much
 * softer yarn of one segment from its last node, pieces, to node pieces + 1, at rest 100 m below. Moving that node down
 * loads the tip by a force that keeps its direction to 1e-3 and is read at that pin. */
scene_net *scene_tip_load(int pieces, double length, const yc_yarn_material *rod, double soft_stretch);

/* A bead on a wire. The wire, node 0 to 1, lies along x from -length/2 to length/2 under a tension; the bead is a stiff
 * bar of 2 * pieces segments across it, along z, whose middle, node 2, lies on the wire at x = start. Gravity presses
 * the bar on the wire along -y; only the wire slides, with the friction given. */
typedef struct scene_bead_desc {
    int pieces;
    double length, start, tension; /* m, m, N */
    double half, mass;             /* of the bar: m from its middle to an end, kg in all */
    double friction;
} scene_bead_desc;
scene_bead_desc scene_bead_desc_default(void);
scene_net *scene_bead(const scene_bead_desc *desc);

/* Settings of its scene, and a start: settles the bead with gravity across the wire, whose ends it pins, then tilts
 * gravity towards +x by an angle. */
yc_scene_desc scene_bead_settings(void);
yc_result scene_bead_tilt(yc_scene *scene, double slope);

/* A yarn over a row of crossings, turning by the same angle at each. Nodes 0 and crossings + 1 are its ends. Every
 * crossing 1 .. crossings is carried by a taut stiff yarn along z. Node 0 is drawn back by a soft yarn to node
 * crossings + 2, whose pull hardly changes when the yarn slides by less than a millimetre. That node and all behind it
 * are to be pinned, and crossings + 1 moved. */
typedef struct scene_capstan_desc {
    int crossings;
    double wrap;    /* rad, all turns together */
    double segment; /* m, between crossings, and to the ends */
    double tension; /* N, of the yarn at the start, and of the soft yarn throughout */
    double stretch; /* N, EA of the yarn */
    double friction;
} scene_capstan_desc;
scene_capstan_desc scene_capstan_desc_default(void);
scene_net *scene_capstan(const scene_capstan_desc *desc);

/* Draws it over all posts against the nearly constant pull, until it slides everywhere. */
yc_result scene_capstan_draw(yc_scene *scene, const scene_net *net, const scene_capstan_desc *desc);

#endif
