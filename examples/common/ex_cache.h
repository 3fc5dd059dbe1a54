/* Animated cloth and yarns for other programs: USD text, and PC2 point caches beside an OBJ.
 *
 * A USD file holds one mesh or one bundle of curves or both, with the points of every frame.  Frames are written as
 * they come, so nothing has to be kept; USD wants all frames of one prim together, hence each prim collects its frames
 * in a temporary file beside the result. */
#ifndef EX_CACHE_H
#define EX_CACHE_H

#include <stdio.h>

typedef struct ex_usd {
    char path[512], temporary[2][544];
    FILE *frames[2]; /* of the mesh and of the curves */
    double rate;
    int frame_count[2];
    int vertex_count, triangle_count;
    int (*triangles)[3];
    int line_count;
    int *first; /* of each line, and the end */
    double *radii;
    int failed;
} ex_usd;

/* Starts a file.  `rate` is in frames per second.  Every function returns 1, or 0 after any failure. */
int ex_usd_begin(ex_usd *usd, const char *path, double rate);
int ex_usd_mesh(ex_usd *usd, int vertex_count, const int (*triangles)[3], int triangle_count);
int ex_usd_curves(ex_usd *usd, const int *first, int line_count, const double *radii);
int ex_usd_mesh_frame(ex_usd *usd, const double (*positions)[3]);
int ex_usd_curves_frame(ex_usd *usd, const double (*points)[3]);
int ex_usd_end(ex_usd *usd);

/* PC2: one file with all vertices of all frames, read by mesh cache modifiers.  Little-endian on every machine. */
typedef struct ex_pc2 {
    FILE *file;
    int point_count, frame_count, failed;
} ex_pc2;

int ex_pc2_begin(ex_pc2 *pc2, const char *path, int point_count, double first_frame, double frames_per_sample);
int ex_pc2_frame(ex_pc2 *pc2, const double (*positions)[3]);
int ex_pc2_end(ex_pc2 *pc2);

#endif
