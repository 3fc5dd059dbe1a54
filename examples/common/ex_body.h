/* The mannequin: a torso lofted through superellipses and rounded cones for the rest, smoothly united. */
#ifndef EX_BODY_H
#define EX_BODY_H

#include "ex_obj.h"

typedef struct ex_section {
    double y, half_width, half_depth, centre_z;
} ex_section;

typedef struct ex_cone {
    char name[EX_NAME_SIZE];
    double a[3], b[3]; /* a sphere of radius ra at a and one of radius rb at b, and their convex hull */
    double ra, rb;
} ex_cone;

typedef struct ex_body {
    double exponent;      /* of the superellipses */
    double blend;         /* the smooth union's reach, m */
    ex_section *sections; /* upwards */
    int section_count;
    ex_cone *cones;
    int cone_count;
} ex_body;

/* Reads mannequin.json.  Returns 1, or 0 with "path:line: what is wrong" in `error`. */
int ex_body_read(ex_body *body, const char *path, char error[EX_ERROR_SIZE]);
void ex_body_free(ex_body *body);

/* Distance to the skin, negative inside, in m; good near the skin, an estimate far away. */
double ex_body_distance(const ex_body *body, const double p[3]);

/* The same with the unit outward direction. */
double ex_body_normal(const ex_body *body, const double p[3], double normal[3]);

/* Cones by name, NULL when there is none. */
const ex_cone *ex_body_cone(const ex_body *body, const char *name);

typedef struct ex_mesh {
    double (*positions)[3];
    double (*normals)[3];
    int vertex_count;
    int (*triangles)[3];
    int triangle_count;
} ex_mesh;

/* The skin as a closed triangle mesh with cells of size h.  Returns 0 when out of memory. */
int ex_body_mesh(const ex_body *body, double h, ex_mesh *mesh);
void ex_mesh_free(ex_mesh *mesh);

#endif
