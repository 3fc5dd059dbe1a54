#define YARNCLOTH_IMPLEMENTATION
#include "yarncloth.h"
#include <stdio.h>

enum { N = 11 }; // vertices along a side

int main(void) {
    static double position[N * N][3], uv[N * N][2];
    static int triangle[2 * (N - 1) * (N - 1)][3];
    char why[YC_MESSAGE_SIZE];
    yc_scene_desc settings = yc_scene_desc_default();
    yc_cloth_desc swatch = yc_cloth_desc_default();
    yc_scene *scene;
    int i, x, y, t = 0, cloth;

    for (i = 0; i < N * N; i++) { // a square of 20 cm, flat, 1 m above the ground
        position[i][0] = uv[i][0] = 0.02 * (i % N), uv[i][1] = 0.02 * (i / N);
        position[i][1] = 1.0, position[i][2] = -uv[i][1];
    }
    for (y = 0; y + 1 < N; y++)
        for (x = 0; x + 1 < N; x++, t += 2) {
            int a = y * N + x, b = a + 1, c = a + N, d = c + 1;
            triangle[t][0] = a, triangle[t][1] = b, triangle[t][2] = d;
            triangle[t + 1][0] = a, triangle[t + 1][1] = d, triangle[t + 1][2] = c;
        }
    swatch.mesh.vertex_count = swatch.mesh.uv_count = N * N, swatch.mesh.triangle_count = t;
    swatch.mesh.positions = (const double(*)[3])position, swatch.mesh.uv = (const double(*)[2])uv;
    swatch.mesh.triangles = (const int(*)[3])triangle;

    if (yc_scene_create(NULL, &settings, &scene, why) != YC_OK) return puts(why), 1;
    yc_scene_add_cloth(scene, &swatch, &cloth);
    yc_scene_pin(scene, cloth, YC_VERTEX, 0, NULL);
    yc_scene_pin(scene, cloth, YC_VERTEX, N - 1, NULL);
    for (i = 0; i < 100; i++)
        if (yc_scene_step(scene, 0.01, NULL) != YC_OK) return puts(yc_scene_message(scene)), 1;
    yc_scene_positions(scene, cloth, YC_VERTEX, position);
    printf("the free corner hangs %.3f m below the pins\n", 1.0 - position[N * N - 1][1]);
    yc_scene_destroy(scene);
    return 0;
}
