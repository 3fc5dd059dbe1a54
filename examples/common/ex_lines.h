/* Pictures of curves as smooth tubes, seen from in front, with thin dark lines and labels drawn over them. */
#ifndef EX_LINES_H
#define EX_LINES_H

#include "ex_image.h"

enum { EX_LINES_POINTS = 8192, EX_LINES_COUNT = 96, EX_LINES_LABEL = 32 };

typedef struct ex_lines {
    int width, height, count, first[EX_LINES_COUNT + 1];
    double at[2], wide; /* m: what stands in the middle of the picture, and what its width shows where z is 0 */
    double points[EX_LINES_POINTS][3], radii[EX_LINES_COUNT], colors[EX_LINES_COUNT][3];
    char labels[EX_LINES_COUNT][EX_LINES_LABEL];
} ex_lines;

/* Cleared, to be freed; NULL when out of memory. */
ex_lines *ex_lines_new(int width, int height, double x, double y, double wide);

/* Adds a tube, or, with a color (sRGB, 0..1) of NULL, a thin dark line over all tubes. Lines without room are left out.
 * The label is written to the right of the last point, or below it where it begins with a new line. */
void ex_lines_add(
    ex_lines *lines, double (*points)[3], int count, double radius, const double *color, const char *label);

/* With the title in a lower corner. To be freed; NULL when out of memory. */
ex_image *ex_lines_draw(const ex_lines *lines, const char *title);

#endif
