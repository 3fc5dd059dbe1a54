/* Pieces of knitting that are left to themselves: they curl, draw in or lie flat; or that are unravelled. Shared by
 * tests, benchmarks and pictures. SI units and radians. */
#ifndef SCENES_KNITS_H
#define SCENES_KNITS_H

#include "yarncloth.h"

/* Rows for yc_chart_read. */
extern const char *const scene_stockinette, *const scene_garter, *const scene_rib, *const scene_rib2;

typedef struct scene_knit {
    yc_chart chart;
    yc_knit_desc desc;
    yc_yarns yarns; /* with its rest shape */
    yc_knit_rest rest;
    yc_scene *scene;
    double (*start)[3], (*x)[3]; /* [yarns.node_count], as it was put in, and after the last scene_knit_settle */
    double period;               /* s, about that of a stitch that swings */
    int newton, substeps, rejected;
    double seconds, moved; /* of the processor; m, in the last step */
} scene_knit;

/* A piece of so many stitches and rows, relaxed and at rest in the xy plane without gravity, in strong air: a mass
 * damping of 0.2 / period. yarn NULL: the default wool. NULL when memory is out or the library refuses; message is NULL
 * or has YC_MESSAGE_SIZE bytes. */
scene_knit *scene_knit_new(const char *rows, int stitches, int row_count, const yc_yarn_material *yarn, char *message);
void scene_knit_free(scene_knit *knit);

/* Steps of ten periods until no node moves by more than a twentieth of the yarn's radius in one, or `most` are done. */
yc_result scene_knit_settle(scene_knit *knit, int most);

/* Where its columns lie in the middle third of its rows, and its rows in the middle third of its columns. */
typedef struct scene_knit_shape {
    double width, height; /* m, between the outermost columns and rows, straight */
    /* how far the cloth has turned from its middle to the left, right, lower and upper edge; > 0 towards the purl side
     * at the sides, towards the knit side at the ends */
    double side[2], end[2];
    double flat; /* the range of directions in the middle half, across or along, whichever is larger */
} scene_knit_shape;
scene_knit_shape scene_knit_look(const scene_knit *knit);

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

#endif
