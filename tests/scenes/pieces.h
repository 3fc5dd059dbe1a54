/* Pattern pieces that knits are cut to. Shared by tests and pictures. SI units and radians. */
#ifndef SCENES_PIECES_H
#define SCENES_PIECES_H

#include "yarncloth.h"

/* A mesh that lies in the xy plane. */
typedef struct scene_piece {
    yc_mesh mesh; /* its arrays are these: */
    double (*positions)[3], (*uv)[2];
    int (*triangles)[3], (*uv_triangles)[3];
} scene_piece;

/* All are NULL when memory is out. New: arrays are zero. */
scene_piece *scene_piece_new(int vertices, int uvs, int triangles);
scene_piece *scene_piece_disc(double radius, int rings);
/* n times so many cells. */
scene_piece *scene_piece_rectangle(double width, double height, int n);
/* Two halves of such a rectangle, side by side, welded where they meet: two islands of the pattern, one mesh. */
scene_piece *scene_piece_halves(double width, double height, int n);
void scene_piece_free(scene_piece *piece);
double scene_piece_area(const scene_piece *piece);

#endif
