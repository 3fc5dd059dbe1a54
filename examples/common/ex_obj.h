/* Garment patterns and plain meshes in Wavefront OBJ files.
 *
 * A pattern file is an ordinary OBJ (any program opens it) that says more in comments:
 *     o PIECE                                  starts a piece; its vertices and faces follow
 *     # place PIECE front|back|sleeve_l|sleeve_r|none
 *     # edge PIECE EDGE VERTEX VERTEX ...      vertex numbers of the file, from 1
 *     # seam PIECE EDGE PIECE EDGE reverse|forward
 * `v` is where the piece lies (m), `vt` its pattern coordinates: the rest shape (m). */
#ifndef EX_OBJ_H
#define EX_OBJ_H

#define EX_ERROR_SIZE 256
#define EX_NAME_SIZE 32

typedef enum ex_place { EX_PLACE_NONE, EX_PLACE_FRONT, EX_PLACE_BACK, EX_PLACE_SLEEVE_L, EX_PLACE_SLEEVE_R } ex_place;

typedef struct ex_piece {
    char name[EX_NAME_SIZE];
    ex_place place;
    int first_vertex, vertex_count;
    int first_triangle, triangle_count;
} ex_piece;

typedef struct ex_edge {
    char name[EX_NAME_SIZE];
    int piece;
    int *vertices; /* along the outline */
    int count;
} ex_edge;

typedef struct ex_seam {
    int edge_a, edge_b;
    int first_pair, pair_count;
} ex_seam;

typedef struct ex_pattern {
    double (*positions)[3];
    int vertex_count;
    double (*uv)[2];
    int uv_count;
    int (*triangles)[3];    /* into positions */
    int (*uv_triangles)[3]; /* into uv */
    int triangle_count;
    ex_piece *pieces;
    int piece_count;
    ex_edge *edges;
    int edge_count;
    ex_seam *seams;
    int seam_count;
    int (*pairs)[2]; /* vertices sewn together, seam after seam */
    int pair_count;
} ex_pattern;

/* Reads a pattern.  Returns 1, or 0 with "path:line: what is wrong" in `error`; then `pattern` is empty. */
int ex_pattern_read(ex_pattern *pattern, const char *path, char error[EX_ERROR_SIZE]);
void ex_pattern_free(ex_pattern *pattern);

/* The uv of every vertex.  A pattern vertex has one uv because pieces are separate. */
void ex_pattern_vertex_uv(const ex_pattern *pattern, double (*uv)[2]);

/* Writes triangles, with uv when `uv` is not NULL.  Returns 1, or 0 when the file cannot be written. */
int ex_obj_write(const char *path, const double (*positions)[3], int vertex_count, const int (*triangles)[3],
    int triangle_count, const double (*uv)[2], int uv_count, const int (*uv_triangles)[3]);

/* Writes polylines as pairs of points, which every reader takes.  first[i] .. first[i + 1] - 1 are line i's points. */
int ex_obj_write_lines(const char *path, const double (*positions)[3], const int *first, int line_count);

#endif
