/* Pieces of knitting that are left to themselves: they curl, draw in or lie flat; or that are unravelled. Shared by
 * tests, benchmarks and pictures. SI units and radians. */
#ifndef SCENES_KNITS_H
#define SCENES_KNITS_H

#include "yarncloth.h"

/* Rows for yc_chart_read. */
extern const char *const scene_stockinette, *const scene_garter, *const scene_rib, *const scene_rib2;
extern const char *const scene_feather, *const scene_diamond, *const scene_chevron;

typedef struct scene_knit {
    yc_chart chart;
    yc_knit_desc desc;
    yc_yarns yarns; /* with its rest shape */
    yc_knit_rest rest;
    int elastic, first[4]; /* the first visits of what is cast on, worked and bound off, and how many there are */
    int material[3];       /* of elastic edges: the three yarns, */
    unsigned char family[3];
    yc_yarn_material materials[2]; /* the piece's and theirs */
    yc_scene *scene;
    double (*start)[3], (*x)[3]; /* [yarns.node_count], as it was put in, and after the last scene_knit_settle */
    double period;               /* s, about that of a stitch that swings */
    double sphere, centre[3];    /* m, its radius; 0: there is none */
    int newton, substeps, rejected;
    double seconds, moved; /* of the processor; m, in the last step */
} scene_knit;

/* A piece of so many stitches and rows, relaxed and at rest in the xy plane without gravity, that may lie on itself, in
 * strong air: a mass damping of 0.2 / period. yarn NULL: the default wool. NULL when memory is out or the library
 * refuses; message is NULL
 * or has YC_MESSAGE_SIZE bytes. */
scene_knit *scene_knit_new(const char *rows, int stitches, int row_count, const yc_yarn_material *yarn, char *message);
/* The same, cast on and bound off with elastic, yarns that stretch a hundred thousand times as easily: what
 * draws the piece wider draws its stitches then, not its edges. */
scene_knit *scene_knit_new_elastic(
    const char *rows, int stitches, int row_count, const yc_yarn_material *yarn, char *message);
void scene_knit_free(scene_knit *knit);

/* Holds four loops, the corners of the middle half of its width and height, as needles would. */
yc_result scene_knit_hold(scene_knit *knit);

/* Steps of ten periods until no node moves by more than a twentieth of the yarn's radius in one, or `most` are done. */
yc_result scene_knit_settle(scene_knit *knit, int most);

/* A piece of that size just above a rough sphere, on whose top it falls by its weight, along z. */
scene_knit *scene_knit_new_above(
    const char *rows, int stitches, int row_count, const yc_yarn_material *yarn, double sphere, char *message);
/* Falls, for a fiftieth of a second at a time, until no node moves faster than `speed`, m/s, on the average of that
 * time, or `most` are done. */
yc_result scene_knit_fall(scene_knit *knit, double speed, int most);

/* Six fabrics of about as many stitches, to be dropped. */
typedef struct scene_fabric {
    const char *name;
    const char *const *rows;
    int stitches;
} scene_fabric;
enum { SCENE_FABRICS = 6 };
extern const scene_fabric scene_fabrics[SCENE_FABRICS];
/* The default wool, which wraps a quarter as hard: stockinette of the other would be a scroll before it is down. */
yc_yarn_material scene_soft_wool(void);

/* How it lies on its sphere. */
typedef struct scene_knit_drape {
    double shadow; /* the area below which it lies over the one that it had flat: the drape coefficient */
    double depth;  /* m, from its highest to its lowest node */
    double low[2]; /* m, the mean of the middle third of its sides, and of its ends, below the highest node */
} scene_knit_drape;
scene_knit_drape scene_knit_hang(const scene_knit *knit);

/* Where its columns lie in the middle third of its rows, and its rows in the middle third of its columns. */
typedef struct scene_knit_shape {
    double width, height; /* m, between the outermost columns and rows, straight */
    /* how far the cloth has turned from its middle to the left, right, lower and upper edge; > 0 towards the purl side
     * at the sides, towards the knit side at the ends */
    double side[2], end[2];
    double flat; /* the range of directions in the middle half, across or along, whichever is larger */
} scene_knit_shape;
scene_knit_shape scene_knit_look(const scene_knit *knit);

/* A piece that hangs by its upper edge, of yarn that turns at rest as it is laid: what can be had of any size without
 * settling it first. `desc` is without its chart, whose text is `rows`. NULL when memory is out or the library refuses;
 * message is NULL or has YC_MESSAGE_SIZE bytes. */
typedef struct scene_curtain {
    yc_chart chart;
    yc_yarns yarns;
    yc_scene *scene;
} scene_curtain;
scene_curtain *scene_curtain_new(
    const yc_host *host, const yc_scene_desc *settings, const char *rows, const yc_knit_desc *desc, char *message);
void scene_curtain_free(scene_curtain *curtain);

/* A piece that was not bound off, in the xy plane without gravity, held where the legs of its first loops cross. At
 * rest its yarn turns as it is laid. Its end is drawn off sideways. */
typedef struct scene_unravel {
    yc_chart chart;
    yc_knit_desc desc;
    yc_yarns yarns; /* as it was put in */
    yc_scene *scene;
    double loop;         /* m of yarn in a stitch */
    int tip;             /* the node that is pulled, */
    double from[3], way; /* from there, to the right, +1, or to the left, -1 */
    double pulled;       /* m */
    double force;        /* N, on the tip, in the last step */
} scene_unravel;

/* host and message may be NULL. NULL when memory is out or the library refuses. */
scene_unravel *scene_unravel_new(const yc_host *host, const char *rows, int stitches, int row_count, char *message);
/* Draws the tip on by `distance` in `seconds`. */
yc_result scene_unravel_pull(scene_unravel *u, double distance, double seconds, yc_stats *stats);
void scene_unravel_free(scene_unravel *u);

/* kc, kw and ks of Munden (1959): courses, wales per length and loops per area times the yarn in a loop, to the powers
 * 1, 1 and 2, of a piece in its rest shape; the yarn is that of whole loops in the middle third. */
typedef struct scene_knit_munden {
    double kc, kw, ks, loop; /* loop: m */
} scene_knit_munden;
scene_knit_munden scene_knit_gauge(const scene_knit *knit);

/* Draws the outermost columns (axis 0) or rows (axis 1) apart by shares `step` of what was laid,
 * and lets the piece settle each time, until the force is `force`, N, times the rows or stitches that carry it, or the
 * curve is full. What is drawn does not narrow. The first entry is the piece as it is. */
enum { SCENE_PULL = 48 };
typedef struct scene_knit_pull {
    int count;
    double length;                            /* m, at first */
    double stretch[SCENE_PULL];               /* share of `length` */
    double force[SCENE_PULL];                 /* N, per row or stitch */
    double energy[SCENE_PULL][YC_TERM_COUNT]; /* J */
} scene_knit_pull;
yc_result scene_knit_draw(scene_knit *knit, int axis, double step, double force, scene_knit_pull *out);
/* The stretch at a force, from the first length at which it pulls; NaN where the curve ends before. */
double scene_knit_pull_at(const scene_knit_pull *pull, double force);

/* A piece of yarn without friction settles for a while, as washing and tumbling do it, and from then on its yarns rub
 * by `friction`; its outermost columns are drawn apart by about a share `stretch` of its width; they are let go, and it
 * settles again. Each call is one of these, in that order; *width receives how wide the stitches are then, m. */
enum { SCENE_BEFORE, SCENE_DRAWN, SCENE_AFTER, SCENE_PHASES };
yc_result scene_knit_overstretch(scene_knit *knit, int phase, double friction, double stretch, double *width);

/* What lace looks like, of a piece as it was put in: */
/* the amplitude, m, of a wave of `times` periods along the upper edge; */
double scene_knit_wave(const scene_knit *knit, double times);
/* how many gaps there are between yarns as thick as they are, seen from the front, that are larger than that share of a
 * stitch's area; */
int scene_knit_holes(const scene_knit *knit, double share);
/* how columns lean on the average, rad to the right, in rows from .. to - 1, in the middle half of the width. */
double scene_knit_lean(const scene_knit *knit, double from, double to);

#endif
