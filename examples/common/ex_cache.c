#include "ex_cache.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- USD text ---------------------------------------------------------------------------------------------------- */

int ex_usd_begin(ex_usd *usd, const char *path, double rate) {
    memset(usd, 0, sizeof *usd);
    if (strlen(path) >= sizeof usd->path) {
        usd->failed = 1;
        return 0;
    }
    strcpy(usd->path, path);
    usd->rate = rate;
    return 1;
}

/* Temporary frame files are opened when their prim is declared. */
static int open_frames(ex_usd *usd, int prim) {
    if (usd->failed || usd->frames[prim]) {
        usd->failed = 1;
        return 0;
    }
    snprintf(usd->temporary[prim], sizeof usd->temporary[prim], "%s.%s.tmp", usd->path, prim ? "curves" : "mesh");
    usd->frames[prim] = fopen(usd->temporary[prim], "w+b");
    usd->failed = !usd->frames[prim];
    return !usd->failed;
}

int ex_usd_mesh(ex_usd *usd, int vertex_count, const int (*triangles)[3], int triangle_count) {
    if (!open_frames(usd, 0)) return 0;
    usd->vertex_count = vertex_count;
    usd->triangle_count = triangle_count;
    usd->triangles = (int(*)[3])malloc((size_t)(triangle_count + 1) * sizeof *usd->triangles);
    if (usd->triangles) memcpy(usd->triangles, triangles, (size_t)triangle_count * sizeof *triangles);
    usd->failed = !usd->triangles;
    return !usd->failed;
}

int ex_usd_curves(ex_usd *usd, const int *first, int line_count, const double *radii) {
    if (!open_frames(usd, 1)) return 0;
    usd->line_count = line_count;
    usd->first = (int *)malloc((size_t)(line_count + 1) * sizeof *usd->first);
    usd->radii = (double *)malloc((size_t)(line_count + 1) * sizeof *usd->radii);
    if (usd->first && usd->radii) {
        memcpy(usd->first, first, (size_t)(line_count + 1) * sizeof *first);
        memcpy(usd->radii, radii, (size_t)line_count * sizeof *radii);
    }
    usd->failed = !usd->first || !usd->radii;
    return !usd->failed;
}

static int put_frame(ex_usd *usd, int prim, const double (*points)[3], int count) {
    FILE *file = usd->frames[prim];
    int i;
    if (usd->failed || !file) {
        usd->failed = 1;
        return 0;
    }
    fprintf(file, "            %d: [", ++usd->frame_count[prim]);
    for (i = 0; i < count; i++)
        fprintf(file, "%s(%.6g, %.6g, %.6g)", i ? ", " : "", points[i][0], points[i][1], points[i][2]);
    fputs("],\n", file);
    usd->failed = ferror(file) != 0;
    return !usd->failed;
}

int ex_usd_mesh_frame(ex_usd *usd, const double (*positions)[3]) {
    return put_frame(usd, 0, positions, usd->vertex_count);
}

int ex_usd_curves_frame(ex_usd *usd, const double (*points)[3]) {
    return put_frame(usd, 1, points + (usd->first ? usd->first[0] : 0),
        usd->first ? usd->first[usd->line_count] - usd->first[0] : 0);
}

static void copy_frames(FILE *out, FILE *frames) {
    char block[4096];
    size_t got;
    fputs("        point3f[] points.timeSamples = {\n", out);
    rewind(frames);
    while ((got = fread(block, 1, sizeof block, frames)) > 0) fwrite(block, 1, got, out);
    fputs("        }\n", out);
}

static void put_mesh(FILE *out, const ex_usd *usd) {
    int i;
    fputs("    def Mesh \"cloth\"\n    {\n        uniform token subdivisionScheme = \"none\"\n"
          "        uniform bool doubleSided = 1\n",
        out);
    fputs("        int[] faceVertexCounts = [", out);
    for (i = 0; i < usd->triangle_count; i++) fprintf(out, "%s3", i ? ", " : "");
    fputs("]\n        int[] faceVertexIndices = [", out);
    for (i = 0; i < usd->triangle_count; i++)
        fprintf(out, "%s%d, %d, %d", i ? ", " : "", usd->triangles[i][0], usd->triangles[i][1], usd->triangles[i][2]);
    fputs("]\n", out);
    copy_frames(out, usd->frames[0]);
    fputs("    }\n", out);
}

static void put_curves(FILE *out, const ex_usd *usd) {
    int i;
    fputs("    def BasisCurves \"yarns\"\n    {\n        uniform token type = \"cubic\"\n"
          "        uniform token basis = \"catmullRom\"\n        uniform token wrap = \"pinned\"\n"
          "        int[] curveVertexCounts = [",
        out);
    for (i = 0; i < usd->line_count; i++) fprintf(out, "%s%d", i ? ", " : "", usd->first[i + 1] - usd->first[i]);
    fputs("]\n        float[] widths = [", out);
    for (i = 0; i < usd->line_count; i++) fprintf(out, "%s%.6g", i ? ", " : "", 2.0 * usd->radii[i]);
    fputs("] (\n            interpolation = \"uniform\"\n        )\n", out);
    copy_frames(out, usd->frames[1]);
    fputs("    }\n", out);
}

int ex_usd_end(ex_usd *usd) {
    FILE *out = usd->failed ? NULL : fopen(usd->path, "wb");
    int prim, frames = usd->frame_count[0] > usd->frame_count[1] ? usd->frame_count[0] : usd->frame_count[1];
    if (!out) usd->failed = 1;
    if (out) {
        fprintf(out,
            "#usda 1.0\n(\n    defaultPrim = \"scene\"\n    startTimeCode = 1\n    endTimeCode = %d\n"
            "    timeCodesPerSecond = %g\n    framesPerSecond = %g\n    metersPerUnit = 1\n    upAxis = \"Y\"\n)\n\n"
            "def Xform \"scene\"\n{\n",
            frames > 1 ? frames : 1, usd->rate, usd->rate);
        if (usd->frames[0]) put_mesh(out, usd);
        if (usd->frames[1]) put_curves(out, usd);
        fputs("}\n", out);
        usd->failed = ferror(out) != 0;
        if (fclose(out)) usd->failed = 1;
    }
    for (prim = 0; prim < 2; prim++)
        if (usd->frames[prim]) {
            fclose(usd->frames[prim]);
            usd->frames[prim] = NULL;
            remove(usd->temporary[prim]);
        }
    free(usd->triangles);
    free(usd->first);
    free(usd->radii);
    usd->triangles = NULL;
    usd->first = NULL;
    usd->radii = NULL;
    return !usd->failed;
}

/* ---- PC2 --------------------------------------------------------------------------------------------------------- */

static void put_little(FILE *file, unsigned long value) {
    int k;
    for (k = 0; k < 4; k++) fputc((int)(value >> (8 * k) & 255u), file);
}

/* The bits of an IEEE single, worked out so that the machine's own number format and byte order do not matter. */
static void put_float(FILE *file, double value) {
    unsigned long sign = value < 0.0 ? 1ul << 31 : 0ul, mantissa;
    int exponent;
    double fraction = frexp(fabs(value), &exponent);
    if (!(fraction > 0.0) || exponent < -125) {
        put_little(file, 0ul);
        return;
    }
    mantissa = (unsigned long)floor(ldexp(fraction, 24) + 0.5);
    if (mantissa >> 24) {
        mantissa >>= 1;
        exponent++;
    }
    put_little(file, sign | (unsigned long)(exponent + 126) << 23 | (mantissa & 0x7ffffful));
}

int ex_pc2_begin(ex_pc2 *pc2, const char *path, int point_count, double first_frame, double frames_per_sample) {
    memset(pc2, 0, sizeof *pc2);
    pc2->point_count = point_count;
    pc2->file = fopen(path, "wb");
    pc2->failed = !pc2->file;
    if (pc2->failed) return 0;
    fwrite("POINTCACHE2\0", 1, 12, pc2->file);
    put_little(pc2->file, 1);
    put_little(pc2->file, (unsigned long)point_count);
    put_float(pc2->file, first_frame);
    put_float(pc2->file, frames_per_sample);
    put_little(pc2->file, 0); /* the number of frames, filled in at the end */
    return 1;
}

int ex_pc2_frame(ex_pc2 *pc2, const double (*positions)[3]) {
    int i, k;
    if (pc2->failed) return 0;
    for (i = 0; i < pc2->point_count; i++)
        for (k = 0; k < 3; k++) put_float(pc2->file, positions[i][k]);
    pc2->frame_count++;
    pc2->failed = ferror(pc2->file) != 0;
    return !pc2->failed;
}

int ex_pc2_end(ex_pc2 *pc2) {
    if (!pc2->file) return 0;
    if (fseek(pc2->file, 28, SEEK_SET)) pc2->failed = 1;
    put_little(pc2->file, (unsigned long)pc2->frame_count);
    if (ferror(pc2->file)) pc2->failed = 1;
    if (fclose(pc2->file)) pc2->failed = 1;
    pc2->file = NULL;
    return !pc2->failed;
}
