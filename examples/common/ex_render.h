/* A small software renderer for finished-looking pictures: meshes and yarns under one soft key light with sky light,
 * ambient occlusion, a rim light and a studio background.  Everything is in m and in world coordinates, y up.
 *
 *     ex_scene *scene = ex_render_begin(1000, 1200, &camera, NULL);
 *     ex_render_mesh(scene, positions, vertex_count, triangles, triangle_count, NULL, NULL, &material);
 *     ex_image *image = ex_render_finish(scene);         frees the scene; NULL when memory ran out on the way
 */
#ifndef EX_RENDER_H
#define EX_RENDER_H

#include "ex_image.h"

typedef struct ex_camera {
    double eye[3], target[3], up[3];
    double fov; /* vertical, degrees */
} ex_camera;

typedef struct ex_look {
    double key[3];   /* towards the key light */
    double softness; /* the key light's size: tangent of its half angle */
    double exposure;
    double ao_radius;   /* how far ambient occlusion reaches, m: 0.08 for a garment, 3 radii for yarns */
    double ao_strength; /* 1 for garments, up to 2 for yarns */
    double background_top[3], background_bottom[3]; /* sRGB, 0..1 */
    int ground;                                     /* 1: a plane at ground_y that only catches shadows */
    double ground_y;
    int samples; /* per pixel and direction: 1, 2, 3 */
} ex_look;

/* Neutral studio: key from the upper left, ground off. */
void ex_look_default(ex_look *look);

/* Turns the key light, given for a camera in front (+z), with the camera, so that a view from any side is lit from its
 * upper left. */
void ex_look_follow(ex_look *look, const ex_camera *camera);

typedef struct ex_material {
    double front[3], back[3]; /* sRGB, 0..1 */
    double sheen;             /* velvet-like glow at grazing angles: cloth 0.3, skin 0 */
    double gloss;             /* strength of a soft highlight */
    double wire;              /* line width of the mesh overlay, m; 0 for none */
    int round; /* 2, 3, ..: every triangle becomes that many squared, curved by the normals; 0, 1: flat */
} ex_material;

/* A matte cloth of one colour with a darker back. */
void ex_material_cloth(ex_material *material, double red, double green, double blue);

/* Matte warm grey, for the mannequin. */
void ex_material_body(ex_material *material);

typedef struct ex_thread {
    int plies;     /* 0: a smooth tube; 2, 3: twisted plies */
    double pitch;  /* length of one turn, in radii */
    double groove; /* depth of the shading between plies, 0..1 */
    double fibre;  /* streaks of single fibres, 0..1 */
    double sheen;
} ex_thread;

/* Cotton: three plies, soft. */
void ex_thread_cotton(ex_thread *thread);

typedef struct ex_scene ex_scene;

/* `look` NULL stands for the default.  A NULL result, as any failure later, only makes ex_render_finish return NULL. */
ex_scene *ex_render_begin(int width, int height, const ex_camera *camera, const ex_look *look);

/* `normals` NULL: smooth ones are made from the triangles.  `colors`: sRGB per vertex instead of the material's, or
 * NULL. */
void ex_render_mesh(ex_scene *scene, const double (*positions)[3], int vertex_count, const int (*triangles)[3],
    int triangle_count, const double (*normals)[3], const double (*colors)[3], const ex_material *material);

/* Yarns: points first[i] .. first[i + 1] - 1 are line i's; a radius and an sRGB colour for each line. */
void ex_render_tubes(ex_scene *scene, const double (*points)[3], const int *first, int line_count, const double *radii,
    const double (*colors)[3], const ex_thread *thread);

ex_image *ex_render_finish(ex_scene *scene);

/* ex_render_finish and a PNG file in one; returns 1, or 0 when that failed. */
int ex_render_save(ex_scene *scene, const char *path);

/* Colour for a number between 0 and 1: blue over grey to red, for stress and strain. */
void ex_heat_color(double value, double color[3]);

#endif
