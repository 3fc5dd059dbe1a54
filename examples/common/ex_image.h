/* Pictures: 8-bit RGB images, PNG files, small text and line plots. */
#ifndef EX_IMAGE_H
#define EX_IMAGE_H

typedef struct ex_image {
    int width, height;
    unsigned char *rgb; /* rows from the top */
} ex_image;

/* A new image in one colour (0..255).  NULL when out of memory. */
ex_image *ex_image_new(int width, int height, int red, int green, int blue);
void ex_image_free(ex_image *image);

/* Writes a PNG file.  Returns 1, or 0 when the file cannot be written. */
int ex_image_write_png(const ex_image *image, const char *path);

/* Copies `source` into `image` with its top left corner at (x, y); what sticks out is cut off. */
void ex_image_paste(ex_image *image, const ex_image *source, int x, int y);

/* Blends a smooth line of the given width; colours are 0xRRGGBB. */
void ex_image_line(ex_image *image, double x0, double y0, double x1, double y1, double width, int color);
void ex_image_box(ex_image *image, int x, int y, int width, int height, int color);

/* ASCII text, letters of 5 x 7 dots of `scale` pixels; returns the width that it takes. */
int ex_image_text(ex_image *image, int x, int y, int scale, int color, const char *text);
int ex_image_text_width(int scale, const char *text);

/* A line plot in a rectangle of an image. */
typedef struct ex_plot {
    ex_image *image;
    int left, top, width, height; /* the area inside the axes */
    double x0, x1, y0, y1;
    int scale; /* of the text */
    int legend_rows;
} ex_plot;

/* Draws the frame, ticks at round numbers and the labels inside the given rectangle of the image. */
void ex_plot_begin(ex_plot *plot, ex_image *image, int x, int y, int width, int height, double x0, double x1, double y0,
    double y1, const char *title, const char *x_label, const char *y_label);
void ex_plot_curve(ex_plot *plot, const double *xs, const double *ys, int count, int color, const char *name);
void ex_plot_points(ex_plot *plot, const double *xs, const double *ys, int count, int color, const char *name);

#endif
