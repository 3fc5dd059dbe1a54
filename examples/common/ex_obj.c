#include "ex_obj.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct reader {
    ex_pattern *pattern;
    const char *path;
    int line;
    char *error;
    int vertex_room, uv_room, triangle_room, piece_room, edge_room, seam_room, pair_room;
} reader;

static int fail(reader *r, const char *format, ...) {
    int used;
    va_list args;
    if (r->error[0]) return 0;
    used = snprintf(r->error, EX_ERROR_SIZE, "%.120s:%d: ", r->path, r->line);
    va_start(args, format);
    vsnprintf(r->error + used, (size_t)(EX_ERROR_SIZE - used), format, args);
    va_end(args);
    return 0;
}

/* Room for one more element in a growing array; NULL stands for out of memory and leaves the array as it was. */
static void *grow(void *array, int count, int *room, size_t size) {
    void *larger = array;
    if (count == *room) {
        int wanted = *room ? 2 * *room : 64;
        larger = realloc(array, (size_t)wanted * size);
        if (larger) *room = wanted;
    }
    return larger;
}

#define EX_GROW(r, type, array, count, room) \
    do { \
        void *larger_ = grow((array), (count), &(room), sizeof *(array)); \
        if (!larger_) return fail((r), "out of memory"); \
        (array) = (type)larger_; \
    } while (0)

static char *next_word(char **at) {
    char *word = *at, *end;
    while (*word == ' ' || *word == '\t') word++;
    if (!*word || *word == '\n' || *word == '\r') return NULL;
    for (end = word; *end && *end != ' ' && *end != '\t' && *end != '\n' && *end != '\r';) end++;
    *at = *end ? end + 1 : end;
    *end = 0;
    return word;
}

static int read_numbers(reader *r, char *at, double *out, int wanted) {
    int k;
    for (k = 0; k < wanted; k++) {
        char *end, *word = next_word(&at);
        if (!word) return fail(r, "%d numbers expected, %d found", wanted, k);
        out[k] = strtod(word, &end);
        if (*end) return fail(r, "'%.30s' is not a number", word);
    }
    return 1;
}

static int find_piece(const ex_pattern *p, const char *name) {
    int i;
    for (i = 0; i < p->piece_count; i++)
        if (!strcmp(p->pieces[i].name, name)) return i;
    return -1;
}

static int find_edge(const ex_pattern *p, int piece, const char *name) {
    int i;
    for (i = 0; i < p->edge_count; i++)
        if (p->edges[i].piece == piece && !strcmp(p->edges[i].name, name)) return i;
    return -1;
}

static int copy_name(reader *r, char out[EX_NAME_SIZE], const char *word) {
    if (!word) return fail(r, "a name is missing");
    if (strlen(word) >= EX_NAME_SIZE)
        return fail(r, "the name '%.40s' is longer than %d characters", word, EX_NAME_SIZE - 1);
    strcpy(out, word);
    return 1;
}

static int read_piece_name(reader *r, char **at, int *piece) {
    const char *word = next_word(at);
    *piece = 0;
    if (!word) return fail(r, "a piece name is missing");
    *piece = find_piece(r->pattern, word);
    return *piece >= 0 ? 1 : fail(r, "there is no piece '%.40s' above this line", word);
}

static int read_object(reader *r, char *at) {
    ex_pattern *p = r->pattern;
    ex_piece *piece;
    const char *name = next_word(&at);
    EX_GROW(r, ex_piece *, p->pieces, p->piece_count, r->piece_room);
    piece = &p->pieces[p->piece_count];
    memset(piece, 0, sizeof *piece);
    if (!copy_name(r, piece->name, name)) return 0;
    if (find_piece(p, piece->name) >= 0) return fail(r, "a second piece is called '%s'", piece->name);
    piece->first_vertex = p->vertex_count;
    piece->first_triangle = p->triangle_count;
    p->piece_count++;
    return 1;
}

static int read_index(reader *r, char **word, int count, const char *what, int *index) {
    char *end;
    long value = strtol(*word, &end, 10);
    *index = 0;
    if (end == *word) return fail(r, "'%.30s' is not a %s number", *word, what);
    if (value < 1 || value > count) return fail(r, "%s %ld does not exist (%d so far)", what, value, count);
    *index = (int)value - 1;
    *word = end;
    return 1;
}

static int read_face(reader *r, char *at) {
    ex_pattern *p = r->pattern;
    int corner, first = p->piece_count ? p->pieces[p->piece_count - 1].first_vertex : 0;
    int v[3], vt[3];
    if (!p->piece_count) return fail(r, "a face before the first 'o' line");
    for (corner = 0; corner < 3; corner++) {
        char *word = next_word(&at);
        if (!word) return fail(r, "a face needs three corners");
        if (!read_index(r, &word, p->vertex_count, "vertex", &v[corner])) return 0;
        if (v[corner] < first) return fail(r, "vertex %d belongs to another piece", v[corner] + 1);
        if (*word++ != '/') return fail(r, "a corner must be VERTEX/UV");
        if (!read_index(r, &word, p->uv_count, "uv", &vt[corner])) return 0;
        if (*word && *word != '/') return fail(r, "'%.20s' after a corner", word);
    }
    if (next_word(&at)) return fail(r, "only triangles are read");
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) return fail(r, "a triangle uses a vertex twice");
    if (p->triangle_count == r->triangle_room) {
        int room = r->triangle_room;
        EX_GROW(r, int(*)[3], p->uv_triangles, p->triangle_count, room);
    }
    EX_GROW(r, int(*)[3], p->triangles, p->triangle_count, r->triangle_room);
    memcpy(p->triangles[p->triangle_count], v, sizeof v);
    memcpy(p->uv_triangles[p->triangle_count++], vt, sizeof vt);
    return 1;
}

static int read_place(reader *r, char *at) {
    static const char *const names[] = {"none", "front", "back", "sleeve_l", "sleeve_r"};
    const char *word;
    int piece, i;
    if (!read_piece_name(r, &at, &piece)) return 0;
    word = next_word(&at);
    for (i = 0; word && i < 5; i++)
        if (!strcmp(word, names[i])) {
            r->pattern->pieces[piece].place = (ex_place)i;
            return 1;
        }
    return fail(r, "'%.30s' is not a place", word ? word : "");
}

static int read_edge(reader *r, char *at) {
    ex_pattern *p = r->pattern;
    ex_edge *edge;
    char *word;
    int room = 0;
    EX_GROW(r, ex_edge *, p->edges, p->edge_count, r->edge_room);
    edge = &p->edges[p->edge_count];
    memset(edge, 0, sizeof *edge);
    if (!read_piece_name(r, &at, &edge->piece) || !copy_name(r, edge->name, next_word(&at))) return 0;
    if (find_edge(p, edge->piece, edge->name) >= 0)
        return fail(r, "piece '%s' has two edges '%s'", p->pieces[edge->piece].name, edge->name);
    p->edge_count++;
    while ((word = next_word(&at)) != NULL) {
        int v;
        if (!read_index(r, &word, p->vertex_count, "vertex", &v)) return 0;
        if (v < p->pieces[edge->piece].first_vertex)
            return fail(r, "vertex %d is not of piece '%s'", v + 1, p->pieces[edge->piece].name);
        EX_GROW(r, int *, edge->vertices, edge->count, room);
        edge->vertices[edge->count++] = v;
    }
    return edge->count >= 2 ? 1 : fail(r, "an edge needs two vertices");
}

static int read_seam(reader *r, char *at) {
    ex_pattern *p = r->pattern;
    ex_seam *seam;
    const char *word;
    int side, edge[2], k, reverse;
    for (side = 0; side < 2; side++) {
        int piece;
        if (!read_piece_name(r, &at, &piece)) return 0;
        word = next_word(&at);
        edge[side] = word ? find_edge(p, piece, word) : -1;
        if (edge[side] < 0) return fail(r, "piece '%s' has no edge '%.30s'", p->pieces[piece].name, word ? word : "");
    }
    word = next_word(&at);
    reverse = word && !strcmp(word, "reverse");
    if (!reverse && (!word || strcmp(word, "forward") != 0)) return fail(r, "a seam ends in 'reverse' or 'forward'");
    if (p->edges[edge[0]].count != p->edges[edge[1]].count)
        return fail(r, "the seam joins %d vertices with %d", p->edges[edge[0]].count, p->edges[edge[1]].count);
    EX_GROW(r, ex_seam *, p->seams, p->seam_count, r->seam_room);
    seam = &p->seams[p->seam_count++];
    seam->edge_a = edge[0];
    seam->edge_b = edge[1];
    seam->first_pair = p->pair_count;
    seam->pair_count = p->edges[edge[0]].count;
    for (k = 0; k < seam->pair_count; k++) {
        EX_GROW(r, int(*)[2], p->pairs, p->pair_count, r->pair_room);
        p->pairs[p->pair_count][0] = p->edges[edge[0]].vertices[k];
        p->pairs[p->pair_count++][1] = p->edges[edge[1]].vertices[reverse ? seam->pair_count - 1 - k : k];
    }
    return 1;
}

static int read_line(reader *r, char *at) {
    ex_pattern *p = r->pattern;
    const char *word = next_word(&at);
    if (!word) return 1;
    if (!strcmp(word, "v")) {
        EX_GROW(r, double(*)[3], p->positions, p->vertex_count, r->vertex_room);
        if (!p->piece_count) return fail(r, "a vertex before the first 'o' line");
        return read_numbers(r, at, p->positions[p->vertex_count++], 3);
    }
    if (!strcmp(word, "vt")) {
        EX_GROW(r, double(*)[2], p->uv, p->uv_count, r->uv_room);
        return read_numbers(r, at, p->uv[p->uv_count++], 2);
    }
    if (!strcmp(word, "f")) return read_face(r, at);
    if (!strcmp(word, "o")) return read_object(r, at);
    if (!strcmp(word, "#")) {
        word = next_word(&at);
        if (word && !strcmp(word, "edge")) return read_edge(r, at);
        if (word && !strcmp(word, "seam")) return read_seam(r, at);
        if (word && !strcmp(word, "place")) return read_place(r, at);
    }
    return 1;
}

int ex_pattern_read(ex_pattern *pattern, const char *path, char error[EX_ERROR_SIZE]) {
    char text[8192];
    reader r;
    FILE *file = fopen(path, "rb");
    int i;
    memset(pattern, 0, sizeof *pattern);
    memset(&r, 0, sizeof r);
    r.pattern = pattern;
    r.path = path;
    r.error = error;
    error[0] = 0;
    if (!file) return fail(&r, "cannot be opened");
    while (!error[0] && fgets(text, (int)sizeof text, file)) {
        r.line++;
        if (!strchr(text, '\n') && !feof(file)) fail(&r, "the line is longer than %d characters", (int)sizeof text - 2);
        else read_line(&r, text);
    }
    fclose(file);
    if (!error[0] && !pattern->triangle_count) fail(&r, "no triangles");
    if (error[0]) {
        ex_pattern_free(pattern);
        return 0;
    }
    for (i = 0; i < pattern->piece_count; i++) {
        ex_piece *piece = &pattern->pieces[i];
        int last = i + 1 == pattern->piece_count;
        piece->vertex_count = (last ? pattern->vertex_count : piece[1].first_vertex) - piece->first_vertex;
        piece->triangle_count = (last ? pattern->triangle_count : piece[1].first_triangle) - piece->first_triangle;
    }
    return 1;
}

void ex_pattern_free(ex_pattern *pattern) {
    int i;
    for (i = 0; i < pattern->edge_count; i++) free(pattern->edges[i].vertices);
    free(pattern->positions);
    free(pattern->uv);
    free(pattern->triangles);
    free(pattern->uv_triangles);
    free(pattern->pieces);
    free(pattern->edges);
    free(pattern->seams);
    free(pattern->pairs);
    memset(pattern, 0, sizeof *pattern);
}

void ex_pattern_vertex_uv(const ex_pattern *pattern, double (*uv)[2]) {
    int t, k;
    for (t = 0; t < pattern->triangle_count; t++)
        for (k = 0; k < 3; k++)
            memcpy(uv[pattern->triangles[t][k]], pattern->uv[pattern->uv_triangles[t][k]], 2 * sizeof(double));
}

int ex_obj_write(const char *path, const double (*positions)[3], int vertex_count, const int (*triangles)[3],
    int triangle_count, const double (*uv)[2], int uv_count, const int (*uv_triangles)[3]) {
    FILE *file = fopen(path, "wb");
    int i, failed;
    if (!file) return 0;
    for (i = 0; i < vertex_count; i++)
        fprintf(file, "v %.6f %.6f %.6f\n", positions[i][0], positions[i][1], positions[i][2]);
    for (i = 0; uv && i < uv_count; i++) fprintf(file, "vt %.6f %.6f\n", uv[i][0], uv[i][1]);
    for (i = 0; i < triangle_count; i++) {
        const int *v = triangles[i];
        if (uv) {
            const int *t = uv_triangles[i];
            fprintf(file, "f %d/%d %d/%d %d/%d\n", v[0] + 1, t[0] + 1, v[1] + 1, t[1] + 1, v[2] + 1, t[2] + 1);
        } else {
            fprintf(file, "f %d %d %d\n", v[0] + 1, v[1] + 1, v[2] + 1);
        }
    }
    failed = ferror(file);
    return !fclose(file) && !failed;
}

int ex_obj_write_lines(const char *path, const double (*positions)[3], const int *first, int line_count) {
    FILE *file = fopen(path, "wb");
    int i, k, failed;
    if (!file) return 0;
    for (i = first[0]; i < first[line_count]; i++)
        fprintf(file, "v %.6f %.6f %.6f\n", positions[i][0], positions[i][1], positions[i][2]);
    for (k = 0; k < line_count; k++)
        for (i = first[k]; i + 1 < first[k + 1]; i++) fprintf(file, "l %d %d\n", i - first[0] + 1, i - first[0] + 2);
    failed = ferror(file);
    return !fclose(file) && !failed;
}
