/* Pictures of the yarns of a cloth without a mesh, as tubes, over and under visible. */
#ifndef EX_YARNS_H
#define EX_YARNS_H

#include "ex_render.h"
#include "yarncloth.h"

typedef struct ex_yarns_view {
    int width, height;  /* pixels */
    int z_up;           /* 0: y is up */
    double from[3];     /* towards the camera, y up whatever z_up says */
    double zoom;        /* 1: all yarns just fit */
    double shift[2];    /* of what is in the middle, to the right and up, in widths of what is drawn */
    double fuller;      /* radii as drawn over those that act, to close the weave to the eye */
    int ground;         /* 1: a floor that catches shadows, just below */
    const double *ball; /* centre, in the picture's coordinates (y up), and radius of one below the cloth; NULL: none */
} ex_yarns_view;

/* colors   [yarn_count of yc_scene_network], sRGB, 0..1; NULL: warps blue, wefts cream
 * camera   receives where it stands; with `keep` nonzero it stands there already
 * message  YC_MESSAGE_SIZE bytes: why the result, to be freed, is NULL */
ex_image *ex_yarns_draw(yc_scene *scene, int cloth, const ex_yarns_view *view, const double (*colors)[3],
    ex_camera *camera, int keep, char *message);

#endif
