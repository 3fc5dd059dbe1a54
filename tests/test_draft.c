/* Tests of chapter `fabric`: drafts by name, from a loom, from weaving information files, and what is said of them. */
#include "internals.h"
#include "test.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Whether a draft is the picture: rows from above, as one looks at cloth on a table, '#' where the warp is over. */
static int is_picture(const yc_draft *d, int columns, const char *picture) {
    int rows = (int)strlen(picture) / columns, r, c;
    if (!CHECK(d->repeat[0] == columns && d->repeat[1] == rows)) return 0;
    for (r = 0; r < rows; r++)
        for (c = 0; c < columns; c++)
            if (!CHECK((picture[(rows - 1 - r) * columns + c] == '#') == (d->over[r * columns + c] != 0))) return 0;
    return 1;
}

/* Checks a call's draft, its longest floats, and frees it. */
#define DRAFT(call, columns, picture, warp, weft) \
    do { \
        yc_draft_facts facts; \
        if (!CHECK_RESULT(call, YC_OK)) break; \
        CHECK(is_picture(&draft, columns, picture)); \
        CHECK_RESULT(yc_draft_examine(NULL, &draft, &facts, NULL), YC_OK); \
        CHECK(facts.longest[0] == (warp) && facts.longest[1] == (weft) && facts.holds == 1); \
        yc_draft_destroy(&draft); \
        CHECK(draft.over == NULL && draft.owner == NULL); \
    } while (0)

TEST(draft_named) {
    yc_draft draft;
    DRAFT(yc_draft_plain(NULL, &draft, NULL), 2,
        ".#"
        "#.",
        1, 1);
    DRAFT(yc_draft_twill(NULL, 3, 1, 'Z', &draft, NULL), 4,
        ".###"
        "###."
        "##.#"
        "#.##",
        3, 3);
    DRAFT(yc_draft_twill(NULL, 2, 2, 'S', &draft, NULL), 4,
        ".##."
        "..##"
        "#..#"
        "##..",
        2, 2);
    DRAFT(yc_draft_twill(NULL, 1, 2, 'Z', &draft, NULL), 3,
        "..#"
        ".#."
        "#..",
        2, 2);
    DRAFT(yc_draft_satin(NULL, 5, 2, YC_WARP, &draft, NULL), 5,
        "##.##"
        "####."
        "#.###"
        "###.#"
        ".####",
        4, 4);
    DRAFT(yc_draft_satin(NULL, 8, 3, YC_WEFT, &draft, NULL), 8,
        ".....#.."
        "..#....."
        ".......#"
        "....#..."
        ".#......"
        "......#."
        "...#...."
        "#.......",
        7, 7);
    DRAFT(yc_draft_basket(NULL, 2, 3, &draft, NULL), 4,
        "..##"
        "..##"
        "..##"
        "##.."
        "##.."
        "##..",
        3, 2);
    DRAFT(yc_draft_rep(NULL, 2, YC_WARP, &draft, NULL), 2,
        ".#"
        ".#"
        "#."
        "#.",
        2, 1);
    DRAFT(yc_draft_rep(NULL, 3, YC_WEFT, &draft, NULL), 6,
        "...###"
        "###...",
        1, 3);
    DRAFT(yc_draft_honeycomb(NULL, 8, &draft, NULL), 8,
        ".#.###.#"
        "..#.#.#."
        "...#.#.."
        "....#..."
        "...#.#.."
        "..#.#.#."
        ".#.###.#"
        "#.#####.",
        7, 7);
    yc_draft_destroy(NULL);
}

#define REFUSED(call, code, text) \
    do { \
        yc_draft kept = draft; \
        CHECK_RESULT(call, code); \
        CHECK_TEXT(message, text); \
        CHECK(!memcmp(&draft, &kept, sizeof draft)); \
    } while (0)

TEST(draft_named_refuses) {
    char message[YC_MESSAGE_SIZE];
    yc_host half;
    yc_draft draft;
    memset(&draft, 7, sizeof draft);
    memset(&half, 0, sizeof half);
    half.free = test_host_counting().free;
    REFUSED(yc_draft_plain(NULL, NULL, message), YC_ERROR_ARGUMENT, "out must not be NULL");
    REFUSED(yc_draft_plain(&half, &draft, message), YC_ERROR_ARGUMENT,
        "host.alloc and host.free must be given both or neither");
    REFUSED(yc_draft_twill(NULL, 0, 1, 'Z', &draft, message), YC_ERROR_ARGUMENT, "over = 0 must lie in 1 .. 256");
    REFUSED(yc_draft_twill(NULL, 2, 257, 'Z', &draft, message), YC_ERROR_ARGUMENT, "under = 257 must lie in 1 .. 256");
    REFUSED(yc_draft_twill(NULL, 2, 2, 'X', &draft, message), YC_ERROR_ARGUMENT, "hand = 88 must be 'S' or 'Z'");
    REFUSED(yc_draft_satin(NULL, 4, 2, YC_WARP, &draft, message), YC_ERROR_ARGUMENT, "shafts = 4 must lie in 5 .. 256");
    REFUSED(yc_draft_satin(NULL, 5, 4, YC_WARP, &draft, message), YC_ERROR_ARGUMENT, "move = 4 must lie in 2 .. 3");
    REFUSED(yc_draft_satin(NULL, 6, 3, YC_WARP, &draft, message), YC_ERROR_ARGUMENT,
        "move = 3 and shafts = 6 have the common divisor 3");
    REFUSED(
        yc_draft_satin(NULL, 5, 2, YC_ROD, &draft, message), YC_ERROR_ARGUMENT, "face = 2 must be YC_WARP or YC_WEFT");
    REFUSED(yc_draft_basket(NULL, -1, 2, &draft, message), YC_ERROR_ARGUMENT, "ends = -1 must lie in 1 .. 256");
    REFUSED(yc_draft_basket(NULL, 2, 0, &draft, message), YC_ERROR_ARGUMENT, "picks = 0 must lie in 1 .. 256");
    REFUSED(yc_draft_rep(NULL, 1, YC_WARP, &draft, message), YC_ERROR_ARGUMENT, "length = 1 must lie in 2 .. 256");
    REFUSED(yc_draft_rep(NULL, 2, -1, &draft, message), YC_ERROR_ARGUMENT, "family = -1 must be YC_WARP or YC_WEFT");
    REFUSED(yc_draft_honeycomb(NULL, 4, &draft, message), YC_ERROR_ARGUMENT, "n = 4 must lie in 6 .. 256");
    REFUSED(yc_draft_honeycomb(NULL, 9, &draft, message), YC_ERROR_ARGUMENT, "n = 9 must be even");
}

/* The same twill by treadles that raise two shafts each, by treadles of one shaft, two pressed at a time, by a liftplan
 * and by treadles that lower shafts. */
TEST(draft_loom) {
    static const char twill[] = "#..#"
                                "..##"
                                ".##."
                                "##..";
    static const int threading[4] = {0, 1, 2, 3}, some[4] = {0, -1, 0, 1};
    static const unsigned char pairs[16] = {1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 1, 1, 1, 0, 0, 1};
    static const unsigned char singles[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    static const unsigned char others[16] = {0, 0, 1, 1, 1, 0, 0, 1, 1, 1, 0, 0, 0, 1, 1, 0};
    yc_loom loom;
    yc_draft draft;
    memset(&loom, 0, sizeof loom);
    loom.shafts = loom.treadles = loom.count[0] = loom.count[1] = 4, loom.threading = threading;
    loom.tieup = pairs, loom.treadling = singles;
    DRAFT(yc_draft_loom(NULL, &loom, &draft, NULL), 4, twill, 2, 2);
    loom.tieup = singles, loom.treadling = pairs;
    DRAFT(yc_draft_loom(NULL, &loom, &draft, NULL), 4, twill, 2, 2);
    loom.tieup = NULL;
    DRAFT(yc_draft_loom(NULL, &loom, &draft, NULL), 4, twill, 2, 2);
    loom.treadling = others, loom.sinking = 1;
    DRAFT(yc_draft_loom(NULL, &loom, &draft, NULL), 4, twill, 2, 2);
    loom.treadling = pairs, loom.threading = some, loom.shafts = loom.treadles = 2, loom.count[1] = 3, loom.sinking = 0;
    if (!CHECK_RESULT(yc_draft_loom(NULL, &loom, &draft, NULL), YC_OK)) return; /* treadling 1 1, 0 0, 0 1 */
    CHECK(is_picture(&draft, 4,
        "...#"
        "...."
        "#.##"));
    yc_draft_destroy(&draft);
}

TEST(draft_loom_refuses) {
    static const int threading[3] = {0, 1, 2};
    static const unsigned char treadling[4] = {1, 0, 0, 1};
    char message[YC_MESSAGE_SIZE];
    yc_loom good, loom;
    yc_draft draft;
    memset(&draft, 7, sizeof draft);
    memset(&good, 0, sizeof good);
    good.shafts = good.treadles = 2, good.count[0] = 3, good.count[1] = 2;
    good.threading = threading, good.treadling = treadling;
    REFUSED(yc_draft_loom(NULL, NULL, &draft, message), YC_ERROR_ARGUMENT, "loom must not be NULL");
    REFUSED(yc_draft_loom(NULL, &good, NULL, message), YC_ERROR_ARGUMENT, "out must not be NULL");
    REFUSED(
        yc_draft_loom(NULL, &good, &draft, message), YC_ERROR_ARGUMENT, "loom.threading[2] = 2 must lie in -1 .. 1");
    loom = good, loom.shafts = 0;
    REFUSED(yc_draft_loom(NULL, &loom, &draft, message), YC_ERROR_ARGUMENT, "loom.shafts = 0 must lie in 1 .. 4096");
    loom = good, loom.treadles = 4097;
    REFUSED(
        yc_draft_loom(NULL, &loom, &draft, message), YC_ERROR_ARGUMENT, "loom.treadles = 4097 must lie in 1 .. 4096");
    loom = good, loom.treadles = 1;
    REFUSED(yc_draft_loom(NULL, &loom, &draft, message), YC_ERROR_ARGUMENT,
        "loom.treadles = 1 must be shafts, 2, without a tieup");
    loom = good, loom.count[0] = 65537;
    REFUSED(
        yc_draft_loom(NULL, &loom, &draft, message), YC_ERROR_ARGUMENT, "loom.count[0] = 65537 must lie in 1 .. 65536");
    loom.count[0] = 65536, loom.count[1] = 257;
    REFUSED(yc_draft_loom(NULL, &loom, &draft, message), YC_ERROR_ARGUMENT, "loom.count[1] = 257 must lie in 1 .. 256");
    loom = good, loom.threading = NULL;
    REFUSED(yc_draft_loom(NULL, &loom, &draft, message), YC_ERROR_ARGUMENT, "loom.threading must not be NULL");
    loom = good, loom.treadling = NULL;
    REFUSED(yc_draft_loom(NULL, &loom, &draft, message), YC_ERROR_ARGUMENT, "loom.treadling must not be NULL");
}

/* Two layers that never meet, one above the other; a warp and a weft that never change sides. */
TEST(draft_examine) {
    static unsigned char layers[16] = {1, 1, 0, 1, 0, 1, 0, 0, 0, 1, 1, 1, 0, 0, 0, 1};
    static unsigned char single[1] = {1}, loose[4] = {1, 1, 1, 0};
    char message[YC_MESSAGE_SIZE];
    yc_draft_facts facts;
    yc_draft draft;
    memset(&draft, 0, sizeof draft);
    draft.repeat[0] = draft.repeat[1] = 4, draft.over = layers;
    CHECK_RESULT(yc_draft_examine(NULL, &draft, &facts, message), YC_OK);
    CHECK(!facts.holds && facts.longest[0] == 3 && facts.longest[1] == 3);
    layers[4] = 1; /* a stitch that ties the layers: a warp of the lower one passes over a weft of the upper */
    CHECK_RESULT(yc_draft_examine(NULL, &draft, &facts, message), YC_OK);
    CHECK(facts.holds);
    draft.repeat[0] = draft.repeat[1] = 2, draft.over = loose;
    CHECK_RESULT(yc_draft_examine(NULL, &draft, &facts, message), YC_OK);
    CHECK(!facts.holds && facts.longest[0] == 0 && facts.longest[1] == 0);
    draft.repeat[0] = draft.repeat[1] = 1, draft.over = single;
    CHECK_RESULT(yc_draft_examine(NULL, &draft, &facts, message), YC_OK);
    CHECK(!facts.holds && facts.longest[0] == 0);
    draft.repeat[1] = 0, facts.holds = 5;
    CHECK_RESULT(yc_draft_examine(NULL, &draft, &facts, message), YC_ERROR_ARGUMENT);
    CHECK_TEXT(message, "draft.repeat[1] = 0 must lie in 1 .. 100000000");
    draft.over = NULL;
    CHECK_RESULT(yc_draft_examine(NULL, &draft, &facts, message), YC_ERROR_ARGUMENT);
    CHECK_TEXT(message, "draft, draft.over and out must not be NULL");
    CHECK(facts.holds == 5);
}

/* ---- weaving information files ----------------------------------------------------------------------------------- */

/* Hound's tooth: a 2/2 twill, four dark and four light threads in both directions. */
static const char head[] =
    "; made by a weaving program\n"
    "[WIF]\nVersion=1.1\nDate=April 20, 1997\nDevelopers=nobody\nSource Program=Loom & Co\n\n"
    "[CONTENTS]\nCOLOR PALETTE=true\nWEAVING=true\nWARP=true\nWEFT=true\nTHREADING=true\nTREADLING=true\n\n"
    "[TEXT]\nTitle=Hound's tooth; no equals sign needed below\nfree text of [somebody]\n\n"
    "[COLOR PALETTE]\nForm=RGB\nRange=0,999\nEntries=3\n\n"
    "[COLOR TABLE]\n1=0,0,0\n2=999,999,999\n3=999,333,0 ; not used\n\n"
    "[WEAVING]\nRising Shed=true\nTreadles=4\nShafts=4\n\n"
    "[WARP]\nThreads=8\nColor=1\nUnits=centimeters\nSpacing=0.125\nThickness=0.05\n\n"
    "[WEFT]\nThreads=8\nColor=2\nUnits=Decipoints\nSpacing=72\n\n"
    "[WARP COLORS]\n5=2\n6=2\n7=2\n8=2\n\n";
static const char treadled[] = "[WEFT COLORS]\n1=1\n2=1\n3=1\n4=1\n\n"
                               "[THREADING]\n1=1\n2=2\n3=3\n4=4\n5=1\n6=2\n7=3\n8=4\n\n"
                               "[TIEUP]\n1=1,2\n2=2,3\n3=3,4\n4=1,4\n\n"
                               "[TREADLING]\n1=1\n2=2\n3=3\n4=4\n5=1\n6=2\n7=3\n8=4\n";
static const char lifted[] = "[WEFT COLORS]\n1=1\n2=1\n3=1\n4=1\n\n"
                             "[THREADING]\n1=1\n2=2\n3=3\n4=4\n5=1\n6=2\n7=3\n8=4\n\n"
                             "[LIFTPLAN]\n1=1,2\n2=2,3\n3=3,4\n4=1,4\n5=1,2\n6=2,3\n7=3,4\n8=1,4\n";
static const char tooth[] = "#..##..#"
                            "..##..##"
                            ".##..##."
                            "##..##.."
                            "#..##..#"
                            "..##..##"
                            ".##..##."
                            "##..##..";

/* Reads a text from a block of just its size, so that sanitizers see a step beyond its end. */
static yc_result read_wif(const char *a, const char *b, yc_draft *out, char *message) {
    size_t length = strlen(a) + strlen(b);
    char *text = (char *)malloc(length + 1), *tight = (char *)malloc(length + !length);
    yc_result result;
    strcpy(text, a), strcat(text, b);
    memcpy(tight, text, length);
    result = yc_draft_wif(NULL, tight, length, out, message);
    free(text), free(tight);
    return result;
}

/* head + tail, each `old` (unless it is "") replaced by `fresh`; valid until the next call. */
static const char *edited(const char *tail, const char *old, const char *fresh) {
    static char text[8192];
    char source[4096];
    const char *at = source, *found;
    strcpy(source, head), strcat(source, tail);
    text[0] = 0;
    for (; *old && (found = strstr(at, old)) != NULL; at = found + strlen(old))
        strncat(text, at, (size_t)(found - at)), strcat(text, fresh);
    strcat(text, at);
    CHECK(!*old || at != source); /* else the test has an old text that is not there */
    return text;
}

TEST(draft_wif) {
    yc_weave_desc d = yc_weave_desc_default();
    yc_yarn_material colours[3];
    yc_draft draft;
    char message[YC_MESSAGE_SIZE];
    int variant, k;
    for (variant = 0; variant < 5; variant++) {
        const char *text = variant < 2 ? head
            : variant == 2             ? edited(treadled, "\n", "\r\n")
            : variant == 3             ? edited(lifted, "\n", "\r")
                                       : edited(treadled, "[", "  [ ");
        if (!CHECK_RESULT(read_wif(text,
                              variant == 0       ? treadled
                                  : variant == 1 ? lifted
                                                 : "",
                              &draft, message),
                YC_OK) ||
            !CHECK_TEXT(message, ""))
            return;
        CHECK(is_picture(&draft, 8, tooth));
        CHECK(draft.colour_count == 3 && draft.order_count[0] == 8 && draft.order_count[1] == 8);
        for (k = 0; k < 8; k++) CHECK(draft.order[0][k] == (k >= 4) && draft.order[1][k] == (k >= 4));
        CHECK(draft.colours[1][2] == 1.0f && draft.colours[0][0] == 0.0f &&
            fabsf(draft.colours[2][1] - 1.0f / 3) < 1e-6f);
        CHECK_NEAR(draft.spacing[0], 1.25e-3, 1e-12);
        CHECK_NEAR(draft.thickness[0], 0.5e-3, 1e-12);
        CHECK_NEAR(draft.spacing[1], 2.54e-3, 1e-12); /* 72 of 720 to the inch */
        CHECK(draft.thickness[1] == 0.0);
        if (variant < 4) yc_draft_destroy(&draft);
    }
    for (k = 0; k < 3; k++) colours[k] = yc_yarn_material_default(), colours[k].density *= k + 1;
    yc_draft_use(&draft, &d);
    d.material_count = 3, d.materials = colours;
    CHECK_NEAR(d.spacing[0], 1.25e-3, 1e-12);
    CHECK_NEAR(yc_weave_material(&d).density, 22.5e-6 / 1.25e-3 + 22.5e-6 / 2.54e-3, 1e-12);
    {
        yc_yarns y;
        memset(&y, 0, sizeof y);
        d.size[0] = d.size[1] = 0.04;
        if (CHECK_RESULT(yc_weave(NULL, &d, NULL, &y, message), YC_OK)) {
            for (k = 0; k < 32; k++) CHECK(y.yarn_material[k] == 3 + (k % 8 >= 4));
            CHECK(y.visit_layer[y.yarn_first[1] + 1] == 1 && y.visit_layer[y.yarn_first[2] + 1] == -1);
            yc_yarns_destroy(&y);
        }
    }
    yc_draft_destroy(&draft);
}

/* What files may say in other ways. */
TEST(draft_wif_variants) {
    yc_draft draft;
    if (CHECK_RESULT(
            read_wif("\xef\xbb\xbf[weaving]\nshafts = 2\ntreadles\t=2\nRISING SHED=No\n[Warp]\nThreads=3\n",
                "[wEFT]\nThreads=2\nColor=4,1,2,3\n[threading]\n1=1\n2=2\n3=0\n[tieup]\n1=1,\n2=2\n[Treadling]\n"
                "1=1 , 2\n2=2\n2=\n[TREADLING]\n2=1",
                &draft, NULL),
            YC_OK)) { /* warp 3 is on no shaft and stays up */
        CHECK(is_picture(&draft, 3,
            ".##"
            "..#"));
        CHECK(draft.order_count[0] == 0 && !draft.order[0] && draft.order_count[1] == 1 && draft.order[1][0] == 3);
        CHECK(draft.colour_count == 4 && !draft.colours && draft.spacing[0] == 0.0);
        yc_draft_destroy(&draft);
    }
    /* a warp on two shafts, a liftplan beside treadles, symbols for colours, lengths of single threads */
    if (CHECK_RESULT(read_wif(edited(lifted, "Form=RGB", "Form=Symbol"),
                         "[TREADLING]\n1=1\n[TIEUP]\n1=4\n[THREADING]\n3=1,3\n"
                         "[WARP SPACING]\n1=0.25\n[WEFT THICKNESS]\n1=.5\n2=1.5\n",
                         &draft, NULL),
            YC_OK)) {
        CHECK(draft.over[0] && draft.over[2] && draft.over[8 + 2] && !draft.over[8]);
        CHECK(!draft.colours && draft.colour_count == 3 && draft.order[0][7] == 1);
        CHECK_NEAR(draft.spacing[0], (7 * 1.25e-3 + 2.5e-3) / 8.0, 1e-12);
        CHECK_NEAR(draft.thickness[1], 0.0254 / 720.0, 1e-12);
        yc_draft_destroy(&draft);
    }
    if (CHECK_RESULT(read_wif(edited(treadled, "3=999,333,0 ; not used\n", ""), "", &draft, NULL), YC_OK)) {
        CHECK(draft.colour_count == 3 && draft.colours[2][0] == 0.0f);
        yc_draft_destroy(&draft);
    }
    if (CHECK_RESULT(read_wif(edited(treadled, "Entries=3", "Units=none"), "", &draft, NULL), YC_OK)) {
        CHECK(draft.colour_count == 3);
        yc_draft_destroy(&draft);
    }
    /* picks that lift nothing: one left out, one that says so */
    if (CHECK_RESULT(
            read_wif(edited(treadled, "7=3\n8=4\n", "8=0\n"), "[THREADING]\n7=3\n8=4\n", &draft, NULL), YC_OK)) {
        CHECK(draft.over[5 * 8 + 1] && !draft.over[6 * 8 + 2] && !draft.over[7 * 8 + 3]);
        yc_draft_destroy(&draft);
    }
}

TEST(draft_wif_refuses) {
    static const char *const edits[][3] = {
        {"Shafts=4", "", "wif: Shafts is missing in [WEAVING]"},
        {"[WARP]\nThreads=8", "[WARP]", "wif: Threads is missing in [WARP]"},
        {"[WEFT]\nThreads=8", "[WEFT]", "wif: Threads is missing in [WEFT]"},
        {"[THREADING]", "[X]", "wif: [THREADING] is missing"},
        {"[TREADLING]", "[X]", "wif: [TREADLING] and [LIFTPLAN] are missing"},
        {"[TIEUP]", "[X]", "wif: [TIEUP] and [LIFTPLAN] are missing"},
        {"Treadles=4", "Treadles=0", "wif: Treadles is missing in [WEAVING]"},
        {"Threads=8", "Threads=65536", "wif: 65536 warps by 65536 wefts are more than 16777216"},
        {"Shafts=4", "Shafts=4097", "wif line 33: expected a number of shafts in 1 .. 4096, found \"4097\""},
        {"Shafts=4", "Shafts=3", "wif line 64: expected a shaft in 0 .. 3, found \"4\""},
        {"Treadles=4", "Treadles=3", "wif line 74: expected a treadle in 1 .. 3, found \"4\""},
        {"[WEAVING]", "[WEAVING", "wif line 30: expected a section's name in brackets, found \"[WEAVING\""},
        {"Rising Shed=true", "Rising Shed=maybe", "wif line 31: expected true or false, found \"maybe\""},
        {"Shafts=4", "Shafts=four", "wif line 33: expected a number, found \"four\""},
        {"Shafts=4", "Shafts=", "wif line 33: expected a number of shafts, found \"\""},
        {"Shafts=4", "Shafts 4", "wif line 33: expected key=value, found \"Shafts 4\""},
        {"Shafts=4", "Shafts=1e3", "wif line 33: expected a number, found \"1e3\""},
        {"Shafts=4", "Shafts=4.5", "wif line 33: expected a number of shafts in 1 .. 4096, found \"4.5\""},
        {"Shafts=4", "Shafts=-4", "wif line 33: expected a number of shafts in 1 .. 4096, found \"-4\""},
        {"Units=Decipoints", "Units=ells", "wif line 45: expected Decipoints, Inches or Centimeters, found \"ells\""},
        {"Spacing=72", "Spacing=-1", "wif line 46: expected a length above 0, found \"-1\""},
        {"Spacing=72", "Spacing=", "wif line 46: expected a length above 0, found \"\""},
        {"Range=0,999", "Range=9,9", "wif line 22: expected two numbers, the second greater, found \"9,9\""},
        {"3=999,333,0", "3=999,333", "wif line 28: expected three numbers in the palette's range, found \"999,333\""},
        {"3=999,333,0", "3=999,1000,0",
            "wif line 28: expected three numbers in the palette's range, found \"999,1000,0\""},
        {"Entries=3", "Entries=2", "wif line 28: expected a colour in 1 .. 2, found \"3\""},
        {"1=0,0,0\n", "", "wif: colour 1 of [WARP] is not in [COLOR TABLE]"},
        {"Color=1\n", "\n", "wif: thread 1 has no colour in [WARP COLORS], [WARP] no Color"},
        {"Color=2\n", "Color=4\n", "wif: colour 4 of [WEFT] is not in [COLOR TABLE]"},
        {"5=2\n6", "5=4\n6", "wif line 49: expected a colour in 1 .. 3, found \"4\""},
        {"5=2\n6", "=2\n6", "wif line 49: expected a thread, found \"\""},
        {"5=2\n6", "9=2\n6", "wif line 49: expected a thread in 1 .. 8, found \"9\""},
    };
    char message[YC_MESSAGE_SIZE], plain[64];
    yc_draft draft;
    int i;
    memset(&draft, 7, sizeof draft);
    for (i = 0; i < (int)(sizeof edits / sizeof edits[0]); i++)
        REFUSED(read_wif(edited(treadled, edits[i][0], edits[i][1]), "", &draft, message), YC_ERROR_PARSE, edits[i][2]);
    /* cut off */
    REFUSED(yc_draft_wif(NULL, edited(treadled, "", ""), strlen(head) + strlen(treadled) - 9, &draft, message),
        YC_ERROR_PARSE, "wif: [TREADLING] ends with weft 6 of 8; 0 would say that it lifts nothing");
    REFUSED(read_wif(edited(lifted, "8=1,4\n", ""), "", &draft, message), YC_ERROR_PARSE,
        "wif: [LIFTPLAN] ends with weft 7 of 8; 0 would say that it lifts nothing");
    REFUSED(read_wif(edited(lifted, "7=3\n8=4\n", ""), "", &draft, message), YC_ERROR_PARSE,
        "wif: [THREADING] ends with warp 6 of 8; 0 would say that it lifts nothing");
    REFUSED(read_wif("", "", &draft, message), YC_ERROR_PARSE, "wif: Shafts is missing in [WEAVING]");
    REFUSED(yc_draft_wif(NULL, NULL, 0, &draft, message), YC_ERROR_ARGUMENT, "text must not be NULL");
    REFUSED(yc_draft_wif(NULL, "", 0, NULL, message), YC_ERROR_ARGUMENT, "out must not be NULL");
    memcpy(plain, "[WARP]\nThreads=1\0Threads", 24); /* a zero is a byte like others */
    CHECK_RESULT(yc_draft_wif(NULL, plain, 24, &draft, message), YC_ERROR_PARSE);
}

/* Every allocation refused in turn, as in test_fabric.c. */
TEST(draft_out_of_memory) {
    static const int threading[2] = {0, 1};
    static const unsigned char treadling[4] = {1, 0, 0, 1};
    yc_loom loom;
    int maker, n;
    memset(&loom, 0, sizeof loom);
    loom.shafts = loom.treadles = loom.count[0] = loom.count[1] = 2;
    loom.threading = threading, loom.treadling = treadling;
    for (maker = 0; maker < 5; maker++) {
        yc_draft draft, before;
        memset(&draft, 7, sizeof draft);
        before = draft;
        for (n = 0; n < 20; n++) {
            yc_host host = test_host_failing(n);
            char message[YC_MESSAGE_SIZE];
            const char *text = maker < 3 ? NULL : edited(maker == 3 ? treadled : lifted, "", "");
            yc_result result = maker == 0 ? yc_draft_satin(&host, 5, 2, YC_WARP, &draft, message)
                : maker == 1              ? yc_draft_loom(&host, &loom, &draft, message)
                : maker == 2              ? yc_draft_basket(&host, 2, 2, &draft, message)
                                          : yc_draft_wif(&host, text, strlen(text), &draft, message);
            if (result == YC_OK) break;
            CHECK(test_refused_memory(result, message) && !memcmp(&draft, &before, sizeof draft));
        }
        CHECK(n >= 1 && n < 20 && test_heap.live == 1);
        yc_draft_destroy(&draft);
        CHECK(test_heap.live == 0 && test_heap.bytes == 0);
    }
    for (n = 0; n < 20; n++) {
        static unsigned char plain[4] = {1, 0, 0, 1};
        yc_host host = test_host_failing(n);
        yc_draft draft;
        yc_draft_facts facts;
        yc_result result;
        memset(&draft, 0, sizeof draft);
        draft.repeat[0] = draft.repeat[1] = 2, draft.over = plain, facts.holds = 7;
        result = yc_draft_examine(&host, &draft, &facts, NULL);
        CHECK(test_heap.live == 0);
        if (result == YC_OK) break;
        CHECK_RESULT(result, YC_ERROR_MEMORY);
        CHECK(facts.holds == 7);
    }
    CHECK(n == 2);
}
