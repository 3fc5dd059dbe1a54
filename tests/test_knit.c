/* Knits in scenes: forces are the slopes of the energy, with stacks too; nothing is lost or gained by stepping. */
#include "internals.h"
#include "test_scene.h"
#include <math.h>

/* A piece with decreases, whose stacks have up to five yarns. */
static int lace(yc_knit_desc *d, yc_chart *chart, yc_yarns *y) {
    static const char text[] = "pattern: a\nRow 1 (RS): k1, k3tog, yo, k1, yo, k2tog, k1.\nRow 2 (WS): Purl.\n";
    char why[YC_MESSAGE_SIZE] = "";
    *d = yc_knit_desc_default();
    if (!CHECK_RESULT(yc_chart_read(NULL, text, sizeof text - 1, NULL, chart, why), YC_OK)) return 0;
    d->chart = chart, d->stitches = 8, d->rows = 2;
    if (CHECK_RESULT(yc_knit(NULL, d, y, why), YC_OK)) return 1;
    yc_chart_destroy(chart);
    return 0;
}

static yc_scene_desc calm(void) {
    yc_scene_desc d = yc_scene_desc_preset(YC_REFERENCE);
    memset(d.gravity, 0, sizeof d.gravity);
    d.dt_min = 1e-9, d.newton_limit = 25;
    return d;
}

/* E by the unknowns at the model's state, and its gradient. */
static double potential(yc_scene *s, const double *dof, int mode) {
    double unused;
    memcpy(s->model->dof, dof, (size_t)yci_system_size(&s->model->system) * sizeof *dof);
    yci_dofs_set(s, dof);
    if (mode == YCI_HESSIAN) yci_predict(s, NULL, 1.0);
    return yci_potential(s, mode, &unused);
}

/* Of the damping's Hessian only the semidefinite part is there. */
static void slopes(double rate) {
    yc_knit_desc d;
    yc_chart chart;
    yc_yarns y;
    yc_scene_desc settings = calm();
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_scene *s;
    yci_model *m;
    uint64_t seed = 5;
    double *dof, *g, *h, *ahead, largest = 0.0, worst = 0.0, largest_h = 0.0, worst_h = 0.0;
    int i, k, size, trial, stacked = 0;
    if (!lace(&d, &chart, &y)) return;
    for (i = 0; i < y.visit_count; i++) y.visit_turn[i] = 0.3;
    settings.gravity[1] = -9.81, settings.solver = YC_SOLVER_DIRECT;
    cloth.yarns = &y;
    s = test_scene_of(&settings, &cloth);
    if (!s || !CHECK_RESULT(yci_scene_build(s), YC_OK)) return;
    m = s->model, size = yci_system_size(&m->system);
    for (i = 0; i < m->system.a.n; i++) stacked += m->system.a.dim[i] > 5;
    CHECK(stacked > 8 && m->wrap_count > 60 && m->length_count > 60);
    dof = (double *)malloc(4 * (size_t)size * sizeof *dof), g = dof + size, h = g + size, ahead = h + size;
    for (i = 0; i < 3 * s->nodes; i++) s->x[i] += test_random(&seed, -2e-4, 2e-4); /* off the plane */
    m->h = 1e-3, m->convex = 0.0;
    yci_keep(s), yci_compress(s), yci_masses(s);
    m->rate = rate, yci_strains(s);
    for (i = 0; i < m->rub_count; i++) CHECK(m->rub[i].limit >= 0.0), m->rub[i].limit = 1e3; /* nothing slips */
    yci_dofs_get(s, s->x, s->u, s->z, m->dof_n), memcpy(m->dof_free, m->dof_n, (size_t)size * sizeof *dof);
    for (i = 0; i < size; i++) dof[i] = m->dof_n[i] + test_random(&seed, -3e-6, 3e-6);
    potential(s, dof, YCI_HESSIAN);
    memcpy(g, m->gradient, (size_t)size * sizeof *g);
    for (trial = 0; trial < 40; trial++) { /* along random directions of a few unknowns */
        const double step = 2e-9;
        double slope = 0.0, e[2], *way = ahead;
        for (i = 0; i < size; i++) way[i] = test_random(&seed, -1.0, 1.0) * (i % 7 == trial % 7);
        yci_bsr_multiply(&s->c, &m->system.a, way, h);
        for (i = 0; i < size; i++) slope += g[i] * way[i], largest = fmax(largest, fabs(g[i]));
        for (k = 0; k < 2; k++) {
            for (i = 0; i < size; i++) m->right[i] = dof[i] + (k ? step : -step) * way[i];
            e[k] = potential(s, m->right, YCI_GRADIENT);
            for (i = 0; i < size; i++)
                m->direction[i] = (k ? m->direction[i] : 0.0) + (k ? 1.0 : -1.0) * m->gradient[i];
        }
        worst = fmax(worst, fabs((e[1] - e[0]) / (2.0 * step) - slope));
        for (i = 0; i < size; i++) {
            largest_h = fmax(largest_h, fabs(h[i]));
            worst_h = fmax(worst_h, fabs(m->direction[i] / (2.0 * step) - h[i]));
        }
        potential(s, dof, YCI_HESSIAN);
    }
    CHECK(worst < 1e-6 * largest && worst_h < (rate > 0.0 ? 1e-2 : 1e-6) * largest_h);
    if (rate > 0.0) { /* where nothing has moved since, it costs nothing */
        double moved = yci_assemble_kind(s, YCI_WRAP, YCI_ENERGY), damped;
        m->rate = 0.0, damped = moved - yci_assemble_kind(s, YCI_WRAP, YCI_ENERGY);
        m->rate = rate, yci_strains(s);
        CHECK(damped > 0.0 && damped > 100.0 * fabs(yci_assemble_kind(s, YCI_WRAP, YCI_ENERGY) - moved + damped));
    }
    free(dof);
    yc_scene_destroy(s), yc_yarns_destroy(&y), yc_chart_destroy(&chart);
}

TEST(knit_slopes_of_the_energy) { slopes(0.0), slopes(3.0); }

/* Every yarn term but these is of weaves. */
TEST(knit_energies) {
    yc_knit_desc d = yc_knit_desc_default();
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_scene_desc settings = calm();
    yc_yarns y;
    yc_scene *s;
    double terms[YC_TERM_COUNT], expected = 0.0;
    int i, k;
    d.stitches = 6, d.rows = 6;
    if (!CHECK_RESULT(yc_knit(NULL, &d, &y, NULL), YC_OK)) return;
    for (i = 0; i < y.contact_count; i++) /* flat, a quarter turn away: k_w L for both pairs */
        for (k = 0; k < 2; k++)
            expected += d.yarn.wrap * fabs(y.visit_u[y.contacts[i].visit[k][1]] - y.visit_u[y.contacts[i].visit[k][0]]);
    cloth.yarns = &y;
    s = test_scene_of(&settings, &cloth);
    if (!s) return;
    CHECK_RESULT(yc_scene_energy(s, terms), YC_OK);
    CHECK_NEAR(terms[YC_TERM_WRAP], expected, 1e-9 * expected);
    CHECK(terms[YC_TERM_STITCH] == 0.0 && terms[YC_TERM_SHEAR] == 0.0 && terms[YC_TERM_SLIDE] == 0.0);
    CHECK(terms[YC_TERM_STRETCH] < 1e-20 && terms[YC_TERM_BENDING] > 0.0);
    CHECK_RESULT(yc_scene_step(s, 1e-3, NULL), YC_OK);
    CHECK_RESULT(yc_scene_energy(s, terms), YC_OK);
    CHECK(terms[YC_TERM_STITCH] > 0.0 && terms[YC_TERM_SLIDE] > 0.0 && terms[YC_TERM_KINETIC] > 0.0);
    yc_scene_destroy(s), yc_yarns_destroy(&y);
}

/* Free in space: momentum, the same bits for any workers, and a saved state that continues. */
static void keep(int hold) {
    yc_knit_desc d;
    yc_chart chart;
    yc_yarns y;
    yc_cloth_desc cloth = yc_cloth_desc_default();
    yc_scene_desc settings = calm();
    yc_host host = test_host_threads(3);
    yc_scene *s[3] = {NULL, NULL, NULL};
    double mass = 1.0, p[3] = {1.0, 1.0, 1.0}, terms[YC_TERM_COUNT], speed;
    test_saved state[3], middle;
    int i, k;
    if (!lace(&d, &chart, &y)) return;
    cloth.yarns = &y;
    cloth.hold_sliding = hold;
    for (i = 0; i < 3; i++) {
        CHECK_RESULT(yc_scene_create(i == 1 ? &host : NULL, &settings, &s[i], NULL), YC_OK);
        if (!CHECK_RESULT(yc_scene_add_cloth(s[i], &cloth, NULL), YC_OK)) return;
    }
    for (k = 0; k < 3; k++)
        for (i = 0; i < 2; i++) {
            CHECK_RESULT(yc_scene_step(s[i], 1e-3, NULL), YC_OK);
            if (k != 1 || i) continue;
            middle = test_save(s[0]);
            CHECK_RESULT(yc_scene_load(s[2], middle.bytes, middle.size), YC_OK);
            free(middle.bytes);
        }
    CHECK_RESULT(yc_scene_step(s[2], 1e-3, NULL), YC_OK);
    for (i = 0; i < 3; i++) state[i] = test_save(s[i]);
    CHECK(test_same(state[0], state[1]) && test_same(state[0], state[2]));
    CHECK_RESULT(yc_scene_momentum(s[0], &mass, p, NULL), YC_OK);
    CHECK_RESULT(yc_scene_energy(s[0], terms), YC_OK);
    speed = sqrt(2.0 * terms[YC_TERM_KINETIC] / mass);
    CHECK(speed > 1e-3 && yci_norm(p) < (hold ? 1e-6 : 0.1) * mass * speed);
    for (i = 0; i < 3; i++) free(state[i].bytes), yc_scene_destroy(s[i]);
    yc_yarns_destroy(&y), yc_chart_destroy(&chart);
}

TEST(knit_keeps_momentum_and_bits) { keep(1), keep(0); }
