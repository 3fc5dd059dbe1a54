/* The tests by which textile laboratories tell fabrics apart, made on weaves of yarns alone: tension, shear under
 * tension, the cantilever and the drape of a disc. All are quasi-static: a step is so long that it minimises the
 * energy. Shared by tests and benchmarks. SI units; forces and moments are per width of cloth. */
#ifndef SCENES_MECHANICS_H
#define SCENES_MECHANICS_H

#include "yarncloth.h"

/* A swatch without a mesh, flat in the xy plane, and its scene. */
typedef struct scene_sample {
    yc_weave_desc weave;
    yc_yarns yarns;
    yc_scene *scene;
    double (*x)[3]; /* [yarns.node_count], where nodes are since the last scene_sample_solve */
    int newton;     /* most iterations of a step so far */
    char message[YC_MESSAGE_SIZE];
} scene_sample;

/* Long steps without gravity, each a minimisation to 1e-10 m. */
yc_scene_desc scene_quasistatic(void);

/* The weave over its own rectangle, of `size`, or clipped by a mesh; yarns do not slide where hold_sliding is set.
 * NULL when memory is out or the library refuses; *message, YC_MESSAGE_SIZE bytes or NULL, says why. */
scene_sample *scene_sample_new(
    const yc_weave_desc *weave, const yc_mesh *mesh, const yc_scene_desc *settings, int hold_sliding, char *message);
void scene_sample_free(scene_sample *sample);

/* A step, and x. */
yc_result scene_sample_solve(scene_sample *sample, double dt);

/* The node nearest to a place of the pattern. */
int scene_sample_nearest(const scene_sample *sample, double u, double v);

/* Called with a sample where it is deformed most, for a picture of it. */
typedef void (*scene_show)(const scene_sample *sample);

/* ---- tension -------------------------------------------------------------------------------------------------- */

#define SCENE_CURVE 256

typedef struct scene_tensile_desc {
    yc_weave_desc weave;
    int axis;          /* 0: along u, the wefts; 1: along v, the warps. With a grain of pi/4 the bias */
    int across, along; /* crossings of the swatch, where the grain is 0; else it is as large as that makes it */
    int hold_width;    /* nonzero: the swatch keeps its width, as a wide and short one does. Only with a grain of 0 */
    double step;       /* of the strain */
    double force;      /* N/m, at which the test ends */
    double strain;     /* or at this strain of the whole */
    scene_show show;   /* NULL: none */
} scene_tensile_desc;

/* Strain of the middle, along and across, and force; the first point is 0. */
typedef struct scene_tensile {
    int count, newton;
    double strain[SCENE_CURVE], across[SCENE_CURVE], force[SCENE_CURVE];
} scene_tensile;

/* Both ends of the swatch are clamped and drawn apart; what is measured is the middle third of the length. */
yc_result scene_tensile_run(const scene_tensile_desc *desc, scene_tensile *out, char *message);

/* The strain at a force, linear in between; NAN when the curve does not reach it. */
double scene_tensile_at(const scene_tensile *curve, double force);

/* The slope of the curve, N/m, at a force, from the two points around it. */
double scene_tensile_slope(const scene_tensile *curve, double force);

/* ---- shear ---------------------------------------------------------------------------------------------------- */

typedef struct scene_shear_desc {
    yc_weave_desc weave;
    int axis;          /* the yarns that are clamped and turned: along u or v */
    int across, along; /* crossings */
    double tension;    /* N/m, along them */
    double angle;      /* rad, of the loop */
    int steps;         /* from 0 to there */
    scene_show show;   /* NULL: none */
} scene_shear_desc;

typedef struct scene_shear_loop {
    double stiffness;  /* N/m per rad, from 0.5 to 2.5 degrees of the branches that lead outwards, both ways */
    double hysteresis; /* N/m, between both branches at 0.5 degrees, both ways: 2HG */
    double work;       /* J/m^2, of the loop */
    int newton;
} scene_shear_loop;

/* A trellis: the clamps of the yarns along the axis keep their distance and move along a circle, out to the angle, to
 * its opposite and back. The moment about it, over the area, is the shear force per width without the share of the
 * tension. */
yc_result scene_shear_run(const scene_shear_desc *desc, scene_shear_loop *out, char *message);

/* ---- bending -------------------------------------------------------------------------------------------------- */

typedef struct scene_cantilever_desc {
    yc_weave_desc weave;
    int axis;        /* of the strip: yarns along u or v bend */
    int across;      /* its yarns */
    double overhang; /* m */
    scene_show show; /* NULL: none */
} scene_cantilever_desc;

typedef struct scene_cantilever {
    double rigidity; /* N m */
    double angle;    /* rad, of the line from the clamp to the tip below the horizontal */
    double length;   /* m, Peirce's bending length (rigidity / weight)^(1/3) */
    int newton;
} scene_cantilever;

/* A strip that reaches out of a clamp hangs under its own weight; the rigidity is that of the elastica whose tip hangs
 * at the same angle. */
yc_result scene_cantilever_run(const scene_cantilever_desc *desc, scene_cantilever *out, char *message);

/* Length over bending length of a heavy elastica whose tip is seen from its clamp at an angle, rad, in (0, 1.4). */
double scene_elastica(double angle);

/* ---- drape ---------------------------------------------------------------------------------------------------- */

typedef struct scene_drape_desc {
    yc_weave_desc weave;
    double radius, support; /* m */
    double dt, duration;    /* s, of a damped motion from flat to rest */
    int start;              /* 0, 1, ...: other first pushes, from which other folds form */
    scene_show show;        /* NULL: none */
} scene_drape_desc;
scene_drape_desc scene_drape_desc_default(const yc_weave_desc *weave); /* 30 cm on 18 cm */

typedef struct scene_drape {
    double coefficient; /* share of the ring's area that its shadow has kept */
    double drift;       /* of the coefficient over the last tenth of the duration */
    int crossings, folds;
} scene_drape;

/* The disc is held flat over the support, as if between two plates, and the ring around it falls. Folds vary from start
 * to start, as they do from hanging to hanging in the laboratory (Kenkare et al. 2008), where the mean counts. */
yc_result scene_drape_run(const scene_drape_desc *desc, scene_drape *out, char *message);

#endif
