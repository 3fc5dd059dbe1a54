#include "ex_image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

ex_image *ex_image_new(int width, int height, int red, int green, int blue) {
    ex_image *image = (ex_image *)malloc(sizeof *image);
    size_t i, count = (size_t)width * (size_t)height;
    if (!image) return NULL;
    image->width = width;
    image->height = height;
    image->rgb = (unsigned char *)malloc(count * 3);
    if (!image->rgb) {
        free(image);
        return NULL;
    }
    for (i = 0; i < count; i++) {
        image->rgb[3 * i] = (unsigned char)red;
        image->rgb[3 * i + 1] = (unsigned char)green;
        image->rgb[3 * i + 2] = (unsigned char)blue;
    }
    return image;
}

void ex_image_free(ex_image *image) {
    if (image) free(image->rgb);
    free(image);
}

/* ---- Deflate: greedy matches with one step of lookahead, one block of fixed or fitted Huffman codes --------------- */

typedef struct bits {
    unsigned char *out;
    size_t used, room;
    unsigned long hold;
    int held, failed;
} bits;

static void put_byte(bits *b, unsigned value) {
    if (b->used == b->room) {
        size_t room = b->room ? 2 * b->room : 65536;
        unsigned char *larger = (unsigned char *)realloc(b->out, room);
        if (!larger) {
            b->failed = 1;
            return;
        }
        b->out = larger;
        b->room = room;
    }
    b->out[b->used++] = (unsigned char)(value & 255u);
}

static void put_bits(bits *b, unsigned value, int count) {
    b->hold |= (unsigned long)value << b->held;
    for (b->held += count; b->held >= 8; b->held -= 8) {
        put_byte(b, (unsigned)(b->hold & 255u));
        b->hold >>= 8;
    }
}

static const unsigned short LENGTH_BASE[29] = {
    3, 4, 5, 6, 7, 8, 9, 10, 11, 13, 15, 17, 19, 23, 27, 31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258};
static const unsigned char LENGTH_EXTRA[29] = {
    0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0};
static const unsigned short DISTANCE_BASE[30] = {1, 2, 3, 4, 5, 7, 9, 13, 17, 25, 33, 49, 65, 97, 129, 193, 257, 385,
    513, 769, 1025, 1537, 2049, 3073, 4097, 6145, 8193, 12289, 16385, 24577};

enum { LITERALS = 286, DISTANCES = 30, WINDOW = 32768, HASH_SIZE = 32768 };

static int length_code(int length) {
    int code = 28;
    while (LENGTH_BASE[code] > length) code--;
    return code;
}

static int distance_code(int distance) {
    int code = 29;
    while (DISTANCE_BASE[code] > distance) code--;
    return code;
}

/* Huffman code lengths of at most `limit` bits.  Merging the two rarest repeatedly; when the tree gets too deep the
 * counts are flattened and it is built again. */
static void huffman_lengths(const unsigned *count, int symbols, int limit, unsigned char *length) {
    unsigned weight[2 * LITERALS], flatten = 0;
    int parent[2 * LITERALS], i, deepest;
    do {
        int nodes = symbols, alive = 0;
        deepest = 0;
        for (i = 0; i < symbols; i++) {
            weight[i] = count[i] ? (count[i] >> flatten) + 1u : 0u;
            parent[i] = -1;
            alive += weight[i] > 0u;
        }
        while (alive > 1) {
            int a = -1, b = -1;
            for (i = 0; i < nodes; i++) {
                if (!weight[i] || parent[i] >= 0) continue;
                if (a < 0 || weight[i] < weight[a]) {
                    b = a;
                    a = i;
                } else if (b < 0 || weight[i] < weight[b]) {
                    b = i;
                }
            }
            weight[nodes] = weight[a] + weight[b];
            parent[nodes] = -1;
            parent[a] = parent[b] = nodes++;
            alive--;
        }
        for (i = 0; i < symbols; i++) {
            int depth = 0, node = i;
            for (; parent[node] >= 0; node = parent[node]) depth++;
            length[i] = (unsigned char)(weight[i] && !depth ? 1 : depth);
            deepest = depth > deepest ? depth : deepest;
        }
        flatten += 2;
    } while (deepest > limit);
}

/* Canonical codes, bits in the order in which deflate sends them. */
static void huffman_codes(const unsigned char *length, int symbols, unsigned *code) {
    unsigned next = 0;
    int bit, i, k;
    for (bit = 1; bit <= 15; bit++) {
        for (i = 0; i < symbols; i++)
            if (length[i] == bit) {
                for (code[i] = 0, k = 0; k < bit; k++) code[i] |= (next >> k & 1u) << (bit - 1 - k);
                next++;
            }
        next <<= 1;
    }
}

typedef struct token {
    unsigned short length, distance; /* distance 0: `length` is a literal byte */
} token;

static int match_length(const unsigned char *a, const unsigned char *b, size_t room) {
    int n = 0, most = room < 258 ? (int)room : 258;
    while (n < most && a[n] == b[n]) n++;
    return n;
}

static size_t find_tokens(const unsigned char *data, size_t size, token *out, int *head, int *chain) {
    size_t at = 0, used = 0, k;
    for (k = 0; k < HASH_SIZE; k++) head[k] = -1;
    while (at < size) {
        int best = 0, best_distance = 0, tries = 24, candidate = -1, step;
        if (at + 3 < size) {
            unsigned hash = (data[at] * 506832829u ^ data[at + 1] * 2654435u ^ data[at + 2] * 40503u) >> 4;
            candidate = head[hash % HASH_SIZE];
        }
        for (; candidate >= 0 && at - (size_t)candidate < WINDOW && tries-- > 0;
             candidate = chain[candidate % WINDOW]) {
            int n = match_length(data + candidate, data + at, size - at);
            if (n > best) {
                best = n;
                best_distance = (int)(at - (size_t)candidate);
            }
        }
        if (best < 4 || (best == 4 && best_distance > 4096)) best = 1;
        out[used].length = (unsigned short)(best == 1 ? data[at] : best);
        out[used++].distance = (unsigned short)(best == 1 ? 0 : best_distance);
        for (step = 0; step < best; step++, at++)
            if (at + 3 < size) {
                unsigned hash = (data[at] * 506832829u ^ data[at + 1] * 2654435u ^ data[at + 2] * 40503u) >> 4;
                chain[at % WINDOW] = head[hash % HASH_SIZE];
                head[hash % HASH_SIZE] = (int)at;
            }
    }
    return used;
}

/* One block of up to 65,000 tokens with its own codes; the code lengths are sent without run lengths (0..15 as they
 * are), which costs some hundred bytes a block and saves a table of special cases. */
static void put_block(bits *b, const token *t, size_t count, int last) {
    static const unsigned char order[19] = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
    unsigned literals[LITERALS], distances[DISTANCES], meta[19], literal_code[LITERALS], distance_codes[DISTANCES],
        meta_code[19];
    unsigned char literal_length[LITERALS], distance_length[DISTANCES], meta_length[19];
    size_t k;
    int i;
    memset(literals, 0, sizeof literals);
    memset(distances, 0, sizeof distances);
    memset(meta, 0, sizeof meta);
    literals[256] = 1;
    distances[0] = distances[1] = 1; /* a decoder may refuse an incomplete code */
    for (k = 0; k < count; k++) {
        literals[t[k].distance ? 257 + length_code(t[k].length) : t[k].length]++;
        if (t[k].distance) distances[distance_code(t[k].distance)]++;
    }
    huffman_lengths(literals, LITERALS, 15, literal_length);
    huffman_lengths(distances, DISTANCES, 15, distance_length);
    for (i = 0; i < LITERALS; i++) meta[literal_length[i]]++;
    for (i = 0; i < DISTANCES; i++) meta[distance_length[i]]++;
    huffman_lengths(meta, 19, 7, meta_length);
    huffman_codes(literal_length, LITERALS, literal_code);
    huffman_codes(distance_length, DISTANCES, distance_codes);
    huffman_codes(meta_length, 19, meta_code);
    put_bits(b, (unsigned)last, 1);
    put_bits(b, 2, 2);
    put_bits(b, LITERALS - 257, 5);
    put_bits(b, DISTANCES - 1, 5);
    put_bits(b, 19 - 4, 4);
    for (i = 0; i < 19; i++) put_bits(b, meta_length[order[i]], 3);
    for (i = 0; i < LITERALS + DISTANCES; i++) {
        int length = i < LITERALS ? literal_length[i] : distance_length[i - LITERALS];
        put_bits(b, meta_code[length], meta_length[length]);
    }
    for (k = 0; k < count; k++) {
        if (t[k].distance) {
            int l = length_code(t[k].length), d = distance_code(t[k].distance), extra = d < 2 ? 0 : d / 2 - 1;
            put_bits(b, literal_code[257 + l], literal_length[257 + l]);
            put_bits(b, (unsigned)(t[k].length - LENGTH_BASE[l]), LENGTH_EXTRA[l]);
            put_bits(b, distance_codes[d], distance_length[d]);
            put_bits(b, (unsigned)(t[k].distance - DISTANCE_BASE[d]), extra);
        } else {
            put_bits(b, literal_code[t[k].length], literal_length[t[k].length]);
        }
    }
    put_bits(b, literal_code[256], literal_length[256]);
}

static int zlib_pack(bits *b, const unsigned char *data, size_t size) {
    token *tokens = (token *)malloc((size + 1) * sizeof *tokens);
    int *head = (int *)malloc(HASH_SIZE * sizeof *head), *chain = (int *)malloc(WINDOW * sizeof *chain);
    unsigned long s1 = 1, s2 = 0;
    size_t i, count = 0, first;
    int fine = tokens && head && chain;
    if (fine) {
        put_byte(b, 0x78);
        put_byte(b, 0x9c);
        count = find_tokens(data, size, tokens, head, chain);
        for (first = 0; first == 0 || first < count; first += 65000)
            put_block(b, tokens + first, count - first < 65000 ? count - first : 65000, first + 65000 >= count);
        put_bits(b, 0, 7);
        for (i = 0; i < size; i++) {
            s1 = (s1 + data[i]) % 65521u;
            s2 = (s2 + s1) % 65521u;
        }
        put_byte(b, (unsigned)(s2 >> 8));
        put_byte(b, (unsigned)s2);
        put_byte(b, (unsigned)(s1 >> 8));
        put_byte(b, (unsigned)s1);
    }
    free(tokens);
    free(head);
    free(chain);
    return fine && !b->failed;
}

/* ---- PNG --------------------------------------------------------------------------------------------------------- */

static void big_endian(unsigned char *out, unsigned long value) {
    out[0] = (unsigned char)(value >> 24 & 255u);
    out[1] = (unsigned char)(value >> 16 & 255u);
    out[2] = (unsigned char)(value >> 8 & 255u);
    out[3] = (unsigned char)(value & 255u);
}

static unsigned long crc_update(unsigned long crc, const unsigned char *data, size_t size) {
    size_t i;
    int k;
    for (i = 0; i < size; i++) {
        crc ^= data[i];
        for (k = 0; k < 8; k++) crc = crc & 1u ? 0xedb88320ul ^ crc >> 1 : crc >> 1;
    }
    return crc;
}

static void png_chunk(FILE *file, const char *type, const unsigned char *data, size_t size) {
    unsigned char word[4];
    unsigned long crc = crc_update(0xfffffffful, (const unsigned char *)type, 4);
    big_endian(word, (unsigned long)size);
    fwrite(word, 1, 4, file);
    fwrite(type, 1, 4, file);
    if (size) fwrite(data, 1, size, file);
    big_endian(word, crc_update(crc, data, size) ^ 0xfffffffful);
    fwrite(word, 1, 4, file);
}

static int paeth(int a, int b, int c) {
    int p = a + b - c, pa = abs(p - a), pb = abs(p - b), pc = abs(p - c);
    return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
}

/* Each row takes the predictor that leaves the smallest differences. */
static void filter_row(
    const unsigned char *row, const unsigned char *above, int bytes, unsigned char *out, unsigned char *trial) {
    long best = -1;
    int type, i;
    for (type = 0; type < 5; type++) {
        long sum = 0;
        trial[0] = (unsigned char)type;
        for (i = 0; i < bytes; i++) {
            int a = i >= 3 ? row[i - 3] : 0, b = above ? above[i] : 0, c = above && i >= 3 ? above[i - 3] : 0;
            int guess = type == 1 ? a : type == 2 ? b : type == 3 ? (a + b) / 2 : type == 4 ? paeth(a, b, c) : 0;
            int rest = (row[i] - guess) & 255;
            trial[i + 1] = (unsigned char)rest;
            sum += rest < 128 ? rest : 256 - rest;
        }
        if (best < 0 || sum < best) {
            best = sum;
            memcpy(out, trial, (size_t)bytes + 1);
        }
    }
}

int ex_image_write_png(const ex_image *image, const char *path) {
    static const unsigned char signature[8] = {137, 'P', 'N', 'G', 13, 10, 26, 10};
    unsigned char header[13], *raw, *trial;
    int bytes = 3 * image->width, y, fine;
    bits b;
    FILE *file;
    memset(&b, 0, sizeof b);
    raw = (unsigned char *)calloc((size_t)image->height, (size_t)bytes + 1);
    trial = (unsigned char *)malloc((size_t)bytes + 1);
    fine = raw && trial;
    for (y = 0; fine && y < image->height; y++) {
        const unsigned char *row = image->rgb + (size_t)y * (size_t)bytes;
        filter_row(row, y ? row - bytes : NULL, bytes, raw + (size_t)y * ((size_t)bytes + 1), trial);
    }
    fine = fine && zlib_pack(&b, raw, ((size_t)bytes + 1) * (size_t)image->height);
    file = fine ? fopen(path, "wb") : NULL;
    fine = file != NULL;
    if (file) {
        big_endian(header, (unsigned long)image->width);
        big_endian(header + 4, (unsigned long)image->height);
        header[8] = 8;
        header[9] = 2;
        header[10] = header[11] = header[12] = 0;
        fwrite(signature, 1, 8, file);
        png_chunk(file, "IHDR", header, 13);
        png_chunk(file, "IDAT", b.out, b.used);
        png_chunk(file, "IEND", NULL, 0);
        fine = !ferror(file);
        fine = !fclose(file) && fine;
    }
    free(raw);
    free(trial);
    free(b.out);
    return fine;
}

/* ---- Drawing ----------------------------------------------------------------------------------------------------- */

static void blend(ex_image *image, int x, int y, int color, double cover) {
    unsigned char *p;
    int k;
    if (x < 0 || y < 0 || x >= image->width || y >= image->height) return;
    p = image->rgb + 3 * ((size_t)y * (size_t)image->width + (size_t)x);
    for (k = 0; k < 3; k++) {
        int target = color >> (16 - 8 * k) & 255;
        p[k] = (unsigned char)(p[k] + cover * (target - p[k]) + 0.5);
    }
}

void ex_image_paste(ex_image *image, const ex_image *source, int x, int y) {
    int i, j;
    for (j = 0; j < source->height; j++)
        for (i = 0; i < source->width; i++)
            if (x + i >= 0 && x + i < image->width && y + j >= 0 && y + j < image->height)
                memcpy(image->rgb + 3 * ((size_t)(y + j) * (size_t)image->width + (size_t)(x + i)),
                    source->rgb + 3 * ((size_t)j * (size_t)source->width + (size_t)i), 3);
}

void ex_image_line(ex_image *image, double x0, double y0, double x1, double y1, double width, int color) {
    double reach = 0.5 * width + 1.0, dx = x1 - x0, dy = y1 - y0, length2 = dx * dx + dy * dy;
    int left = (int)floor(fmin(x0, x1) - reach), right = (int)ceil(fmax(x0, x1) + reach);
    int top = (int)floor(fmin(y0, y1) - reach), bottom = (int)ceil(fmax(y0, y1) + reach), x, y;
    left = left < 0 ? 0 : left;
    top = top < 0 ? 0 : top;
    right = right > image->width ? image->width : right;
    bottom = bottom > image->height ? image->height : bottom;
    for (y = top; y < bottom; y++)
        for (x = left; x < right; x++) {
            double px = x + 0.5 - x0, py = y + 0.5 - y0, s = length2 > 0.0 ? (px * dx + py * dy) / length2 : 0.0, cover;
            s = s < 0.0 ? 0.0 : s > 1.0 ? 1.0 : s;
            px -= s * dx;
            py -= s * dy;
            cover = 0.5 * width + 0.5 - sqrt(px * px + py * py);
            if (cover > 0.0) blend(image, x, y, color, cover > 1.0 ? 1.0 : cover);
        }
}

void ex_image_box(ex_image *image, int x, int y, int width, int height, int color) {
    int i, j;
    for (j = y; j < y + height; j++)
        for (i = x; i < x + width; i++) blend(image, i, j, color, 1.0);
}

/* Five columns of seven dots, the lowest bit on top, for the characters from space to '~'. */
static const unsigned char FONT[95][5] = {{0x00, 0x00, 0x00, 0x00, 0x00}, {0x00, 0x00, 0x5f, 0x00, 0x00},
    {0x00, 0x07, 0x00, 0x07, 0x00}, {0x14, 0x7f, 0x14, 0x7f, 0x14}, {0x24, 0x2a, 0x7f, 0x2a, 0x12},
    {0x23, 0x13, 0x08, 0x64, 0x62}, {0x36, 0x49, 0x55, 0x22, 0x50}, {0x00, 0x05, 0x03, 0x00, 0x00},
    {0x00, 0x1c, 0x22, 0x41, 0x00}, {0x00, 0x41, 0x22, 0x1c, 0x00}, {0x14, 0x08, 0x3e, 0x08, 0x14},
    {0x08, 0x08, 0x3e, 0x08, 0x08}, {0x00, 0x50, 0x30, 0x00, 0x00}, {0x08, 0x08, 0x08, 0x08, 0x08},
    {0x00, 0x60, 0x60, 0x00, 0x00}, {0x20, 0x10, 0x08, 0x04, 0x02}, {0x3e, 0x51, 0x49, 0x45, 0x3e},
    {0x00, 0x42, 0x7f, 0x40, 0x00}, {0x42, 0x61, 0x51, 0x49, 0x46}, {0x21, 0x41, 0x45, 0x4b, 0x31},
    {0x18, 0x14, 0x12, 0x7f, 0x10}, {0x27, 0x45, 0x45, 0x45, 0x39}, {0x3c, 0x4a, 0x49, 0x49, 0x30},
    {0x01, 0x71, 0x09, 0x05, 0x03}, {0x36, 0x49, 0x49, 0x49, 0x36}, {0x06, 0x49, 0x49, 0x29, 0x1e},
    {0x00, 0x36, 0x36, 0x00, 0x00}, {0x00, 0x56, 0x36, 0x00, 0x00}, {0x08, 0x14, 0x22, 0x41, 0x00},
    {0x14, 0x14, 0x14, 0x14, 0x14}, {0x00, 0x41, 0x22, 0x14, 0x08}, {0x02, 0x01, 0x51, 0x09, 0x06},
    {0x32, 0x49, 0x79, 0x41, 0x3e}, {0x7e, 0x11, 0x11, 0x11, 0x7e}, {0x7f, 0x49, 0x49, 0x49, 0x36},
    {0x3e, 0x41, 0x41, 0x41, 0x22}, {0x7f, 0x41, 0x41, 0x22, 0x1c}, {0x7f, 0x49, 0x49, 0x49, 0x41},
    {0x7f, 0x09, 0x09, 0x09, 0x01}, {0x3e, 0x41, 0x49, 0x49, 0x7a}, {0x7f, 0x08, 0x08, 0x08, 0x7f},
    {0x00, 0x41, 0x7f, 0x41, 0x00}, {0x20, 0x40, 0x41, 0x3f, 0x01}, {0x7f, 0x08, 0x14, 0x22, 0x41},
    {0x7f, 0x40, 0x40, 0x40, 0x40}, {0x7f, 0x02, 0x0c, 0x02, 0x7f}, {0x7f, 0x04, 0x08, 0x10, 0x7f},
    {0x3e, 0x41, 0x41, 0x41, 0x3e}, {0x7f, 0x09, 0x09, 0x09, 0x06}, {0x3e, 0x41, 0x51, 0x21, 0x5e},
    {0x7f, 0x09, 0x19, 0x29, 0x46}, {0x46, 0x49, 0x49, 0x49, 0x31}, {0x01, 0x01, 0x7f, 0x01, 0x01},
    {0x3f, 0x40, 0x40, 0x40, 0x3f}, {0x1f, 0x20, 0x40, 0x20, 0x1f}, {0x3f, 0x40, 0x38, 0x40, 0x3f},
    {0x63, 0x14, 0x08, 0x14, 0x63}, {0x07, 0x08, 0x70, 0x08, 0x07}, {0x61, 0x51, 0x49, 0x45, 0x43},
    {0x00, 0x7f, 0x41, 0x41, 0x00}, {0x02, 0x04, 0x08, 0x10, 0x20}, {0x00, 0x41, 0x41, 0x7f, 0x00},
    {0x04, 0x02, 0x01, 0x02, 0x04}, {0x40, 0x40, 0x40, 0x40, 0x40}, {0x00, 0x01, 0x02, 0x04, 0x00},
    {0x20, 0x54, 0x54, 0x54, 0x78}, {0x7f, 0x48, 0x44, 0x44, 0x38}, {0x38, 0x44, 0x44, 0x44, 0x20},
    {0x38, 0x44, 0x44, 0x48, 0x7f}, {0x38, 0x54, 0x54, 0x54, 0x18}, {0x08, 0x7e, 0x09, 0x01, 0x02},
    {0x0c, 0x52, 0x52, 0x52, 0x3e}, {0x7f, 0x08, 0x04, 0x04, 0x78}, {0x00, 0x44, 0x7d, 0x40, 0x00},
    {0x20, 0x40, 0x44, 0x3d, 0x00}, {0x7f, 0x10, 0x28, 0x44, 0x00}, {0x00, 0x41, 0x7f, 0x40, 0x00},
    {0x7c, 0x04, 0x18, 0x04, 0x78}, {0x7c, 0x08, 0x04, 0x04, 0x78}, {0x38, 0x44, 0x44, 0x44, 0x38},
    {0x7c, 0x14, 0x14, 0x14, 0x08}, {0x08, 0x14, 0x14, 0x18, 0x7c}, {0x7c, 0x08, 0x04, 0x04, 0x08},
    {0x48, 0x54, 0x54, 0x54, 0x20}, {0x04, 0x3f, 0x44, 0x40, 0x20}, {0x3c, 0x40, 0x40, 0x20, 0x7c},
    {0x1c, 0x20, 0x40, 0x20, 0x1c}, {0x3c, 0x40, 0x30, 0x40, 0x3c}, {0x44, 0x28, 0x10, 0x28, 0x44},
    {0x0c, 0x50, 0x50, 0x50, 0x3c}, {0x44, 0x64, 0x54, 0x4c, 0x44}, {0x00, 0x08, 0x36, 0x41, 0x00},
    {0x00, 0x00, 0x7f, 0x00, 0x00}, {0x00, 0x41, 0x36, 0x08, 0x00}, {0x08, 0x04, 0x08, 0x10, 0x08}};

int ex_image_text_width(int scale, const char *text) { return (int)strlen(text) * 6 * scale; }

int ex_image_text(ex_image *image, int x, int y, int scale, int color, const char *text) {
    int width = ex_image_text_width(scale, text), column, row;
    for (; *text; text++, x += 6 * scale) {
        int c = (unsigned char)*text;
        c = c < 32 || c > 126 ? '?' : c;
        for (column = 0; column < 5; column++)
            for (row = 0; row < 7; row++)
                if (FONT[c - 32][column] >> row & 1)
                    ex_image_box(image, x + column * scale, y + row * scale, scale, scale, color);
    }
    return width;
}

/* ---- Plots ------------------------------------------------------------------------------------------------------- */

enum { INK = 0x303640, FAINT = 0xe4e6ea };

static double plot_x(const ex_plot *plot, double x) {
    return plot->left + plot->width * (x - plot->x0) / (plot->x1 - plot->x0);
}

static double plot_y(const ex_plot *plot, double y) {
    return plot->top + plot->height * (plot->y1 - y) / (plot->y1 - plot->y0);
}

/* The smallest of 1, 2, 5 times a power of ten that cuts the range into at most `most` parts. */
static double round_step(double range, int most) {
    double step = pow(10.0, floor(log10(range / most)));
    if (range / step > most) step *= 2.0;
    if (range / step > most) step *= 2.5;
    if (range / step > most) step *= 2.0;
    return step;
}

static void plot_ticks(ex_plot *plot, int vertical) {
    double low = vertical ? plot->y0 : plot->x0, high = vertical ? plot->y1 : plot->x1;
    double step = round_step(high - low, (vertical ? plot->height : plot->width) / (vertical ? 40 : 70) + 1);
    int s = plot->scale, tick, last = (int)floor(high / step + 1e-9);
    for (tick = (int)ceil(low / step - 1e-9); tick <= last; tick++) {
        double value = tick * step;
        char text[32];
        snprintf(text, sizeof text, "%g", value);
        if (vertical) {
            double y = plot_y(plot, value);
            ex_image_line(plot->image, plot->left, y, plot->left + plot->width, y, 1.0, FAINT);
            ex_image_text(
                plot->image, plot->left - 6 * s - ex_image_text_width(s, text) + s, (int)y - 3 * s, s, INK, text);
        } else {
            double x = plot_x(plot, value);
            ex_image_line(plot->image, x, plot->top, x, plot->top + plot->height, 1.0, FAINT);
            ex_image_text(
                plot->image, (int)x - ex_image_text_width(s, text) / 2, plot->top + plot->height + 5 * s, s, INK, text);
        }
    }
}

void ex_plot_begin(ex_plot *plot, ex_image *image, int x, int y, int width, int height, double x0, double x1, double y0,
    double y1, const char *title, const char *x_label, const char *y_label) {
    int s = height >= 360 ? 2 : 1;
    plot->image = image;
    plot->scale = s;
    plot->legend_rows = 0;
    plot->left = x + 52 * s;
    plot->top = y + 30 * s;
    plot->width = width - 66 * s;
    plot->height = height - 62 * s;
    plot->x0 = x0;
    plot->x1 = x1 > x0 ? x1 : x0 + 1.0;
    plot->y0 = y0;
    plot->y1 = y1 > y0 ? y1 : y0 + 1.0;
    plot_ticks(plot, 0);
    plot_ticks(plot, 1);
    ex_image_line(image, plot->left, plot->top, plot->left, plot->top + plot->height, s, INK);
    ex_image_line(
        image, plot->left, plot->top + plot->height, plot->left + plot->width, plot->top + plot->height, s, INK);
    ex_image_text(image, plot->left + (plot->width - ex_image_text_width(s, title)) / 2, y + 6 * s, s, INK, title);
    ex_image_text(image, x + 6 * s, y + 18 * s, s, INK, y_label);
    ex_image_text(
        image, plot->left + plot->width - ex_image_text_width(s, x_label), y + height - 11 * s, s, INK, x_label);
}

static void plot_legend(ex_plot *plot, int color, const char *name) {
    int s = plot->scale, y = plot->top + 4 * s + 11 * s * plot->legend_rows;
    if (!name) return;
    ex_image_line(plot->image, plot->left + 8 * s, y + 3.5 * s, plot->left + 22 * s, y + 3.5 * s, 2.0 * s, color);
    ex_image_text(plot->image, plot->left + 28 * s, y, s, INK, name);
    plot->legend_rows++;
}

static int plot_inside(const ex_plot *plot, double x, double y) {
    return x >= plot->x0 && x <= plot->x1 && y >= plot->y0 && y <= plot->y1;
}

void ex_plot_curve(ex_plot *plot, const double *xs, const double *ys, int count, int color, const char *name) {
    int i;
    for (i = 0; i + 1 < count; i++)
        if (plot_inside(plot, xs[i], ys[i]) && plot_inside(plot, xs[i + 1], ys[i + 1]))
            ex_image_line(plot->image, plot_x(plot, xs[i]), plot_y(plot, ys[i]), plot_x(plot, xs[i + 1]),
                plot_y(plot, ys[i + 1]), 1.5 * plot->scale, color);
    plot_legend(plot, color, name);
}

void ex_plot_points(ex_plot *plot, const double *xs, const double *ys, int count, int color, const char *name) {
    int i;
    for (i = 0; i < count; i++)
        if (plot_inside(plot, xs[i], ys[i]))
            ex_image_line(plot->image, plot_x(plot, xs[i]), plot_y(plot, ys[i]), plot_x(plot, xs[i]),
                plot_y(plot, ys[i]), 4.0 * plot->scale, color);
    plot_legend(plot, color, name);
}
