/* The direct solver's block behind the same outputs, coefficients and steps (see cable.h). */
#include <math.h>
#include <string.h>

#include "cable.h"

#define LARGEST_COUNT (INT64_C(1) << 22)

static int within(int64_t value, int64_t low, int64_t high) {
    return value >= low && value <= high;
}

static int whole(double value, int64_t low, int64_t high) {
    return value >= (double)low && value <= (double)high && value == floor(value);
}

static const int64_t *section(const int64_t *I, int64_t index) {
    return I + I[DIRECT_O_SECTION] + index * DIRECT_SECTION_WORDS;
}

int64_t direct_nodes(const int64_t *I) {
    const int64_t *last = section(I, I[DIRECT_D_SECTIONS] - 1);
    return last[DIRECT_N_FIRST] + last[DIRECT_N_COUNT];
}

/* Sections follow one another, and all that they name is there. */
static const char *check_sections(const int64_t *I) {
    const double *M = (const double *)I;
    const int64_t bodies = I[DIRECT_D_BODIES], materials = I[DIRECT_D_MATERIALS];
    int64_t node = 0;
    int meets = I[DIRECT_D_MEETING] == 0;
    for (int64_t n = 0; n < I[DIRECT_D_SECTIONS]; n++) {
        const int64_t *row = section(I, n);
        const int rigid = row[DIRECT_N_KIND] == DIRECT_RIGID;
        if (row[DIRECT_N_FIRST] != node || !within(row[DIRECT_N_COUNT], 2, header(I)->capacity - node) ||
            !within(row[DIRECT_N_KIND], DIRECT_CABLE, DIRECT_RIGID) ||
            !within(row[DIRECT_N_MATERIAL], 0, materials - 1) ||
            !within(row[DIRECT_N_BODY], rigid ? 0 : -1, bodies - 1) ||
            !within(row[DIRECT_N_POINT], -1, bodies - 1) ||
            (rigid && (n == 0 || row[DIRECT_N_COUNT] != 2)))
            return "a section of the line is out of range";
        for (int64_t k = node + 1; k < node + row[DIRECT_N_COUNT] && !rigid; k++)
            if (!(M[I[DIRECT_O_LENGTH] + k] > 0.0)) return "an interval of the line has no length";
        if (n > 0 && I[DIRECT_D_MEETING] == node) meets = 1;
        node += row[DIRECT_N_COUNT];
    }
    if (!within(section(I, I[DIRECT_D_SECTIONS])[DIRECT_N_POINT], -1, bodies - 1) || !meets)
        return "a section of the line is out of range";
    return NULL;
}

const char *check_direct_block(const int64_t *I, int64_t image_words, int64_t block_words) {
    const double *M = (const double *)I;
    int64_t expected[DIRECT_FIRST_FREE] = {0};
    int64_t image = 0, words = 0;
    if (image_words < DIRECT_FIRST_FREE) return "the model's image is too short";
    if (header(I)->version != DIRECT_VERSION) return "not a model of this version";
    if (!direct_sizes_within(I, LARGEST_COUNT) || header(I)->capacity < 2 || header(I)->piece_count < 2 ||
        header(I)->depth_count < 1 || header(I)->time_count < 1)
        return "a size in the model is out of range";
    direct_arrange(I, expected, &image, &words);
    if (image != image_words || words != block_words || header(I)->image_words != image ||
        header(I)->byte_count != 8 * words)
        return "the model's sizes do not agree";
    for (int n = 0; n < DIRECT_FIRST_FREE; n++)
        if (expected[n] != 0 && I[n] != expected[n]) return "an offset in the model is wrong";
    if (!within(I[DIRECT_D_SECTIONS], 1, I[DIRECT_D_SECTION_CAPACITY]) ||
        !within(I[DIRECT_D_DRUM], 0, I[DIRECT_D_DRUM_CAPACITY]) ||
        !within(I[DIRECT_D_DRUM_USED], 0, I[DIRECT_D_DRUM]) ||
        !within(I[DIRECT_D_PLANAR], 0, 1) ||
        !within(I[DIRECT_D_METHOD], DIRECT_SUPERPOSITION, DIRECT_ELIMINATION) ||
        !within(I[DIRECT_D_JOINT], DIRECT_PAPER, DIRECT_MOMENT_FREE) ||
        !within(I[DIRECT_D_END], DIRECT_END_FREE, DIRECT_END_TOUCHDOWN) ||
        !within(I[DIRECT_D_CLAMPED], 0, 3) || !within(I[DIRECT_D_FLOOR], 0, 1) ||
        !within(I[DIRECT_D_RESTART], 0, 1) || !within(I[DIRECT_D_STICKS], 0, 1) ||
        !within(header(I)->piece, 1, header(I)->piece_count - 1) || !within(header(I)->live, 0, 1) ||
        !within(header(I)->current_kind, 0, 2) || (header(I)->current_kind == 1 && header(I)->depth_count != 1) ||
        !within(header(I)->payout, 0, 1) ||
        !within(header(I)->rate_live, 0, 1) || !within(header(I)->clamped, -1, 1) || header(I)->dimension != 3)
        return "a counter in the model is out of range";
    if (!(fabs(scalars(M)->time) < 1e300) || !(M[DIRECT_X_TIME_STEP] > 1e-9) ||
        !(M[DIRECT_X_SPACING] > 1e-9) || !(M[DIRECT_X_TOLERANCE] > 0.0) ||
        !(M[DIRECT_X_ALPHA] >= 0.5 && M[DIRECT_X_ALPHA] <= 1.0))
        return "a setting in the model is out of range";
    for (int64_t n = 0; n < I[DIRECT_D_MATERIALS]; n++) {
        const double *row = M + I[DIRECT_O_MATERIAL] + n * DIRECT_MATERIAL_WORDS;
        const int64_t first = header(I)->strain, last = first + header(I)->strain_words;
        if (!whole(row[DIRECT_T_TERMS], 1, header(I)->strain_words) ||
            !whole(row[DIRECT_T_OFFSET], first, last) ||
            row[DIRECT_T_OFFSET] + row[DIRECT_T_TERMS] > (double)last)
            return "a cable is out of range";
    }
    for (int64_t n = 0; n < I[DIRECT_D_DRUM]; n++) {
        const int64_t *row = I + I[DIRECT_O_DRUM] + n * DIRECT_DRUM_WORDS;
        if (!within(row[DIRECT_R_MATERIAL], 0, I[DIRECT_D_MATERIALS] - 1) ||
            !within(row[DIRECT_R_KIND], DIRECT_CABLE, DIRECT_ELASTICA) ||
            !within(row[DIRECT_R_POINT], -1, I[DIRECT_D_BODIES] - 1) ||
            !within(row[DIRECT_R_RIGID], -1, I[DIRECT_D_BODIES] - 1))
            return "a joint on the drum is out of range";
    }
    return check_sections(I);
}

/* Where a coefficient is in the block: its material's row, or its body's; 0 if it is none. */
int64_t direct_word(const int64_t *I, const Parameter *p) {
    if (p->kind == OF_BODY) {
        const int known = p->word == DIRECT_B_DRAG || p->word == DIRECT_B_DRAG_AXIAL ||
                          p->word == DIRECT_B_WEIGHT;
        if (!known || !within(p->index, 0, I[DIRECT_D_BODIES] - 1)) return 0;
        return I[DIRECT_O_BODY] + p->index * DIRECT_BODY_WORDS + p->word;
    }
    const int known = p->word == DIRECT_T_NORMAL || p->word == DIRECT_T_TANGENTIAL ||
                      p->word == DIRECT_T_ADDED || p->word == DIRECT_T_WEIGHT;
    if (p->kind != OF_CABLES || !known || !within(p->index, 0, I[DIRECT_D_MATERIALS] - 1)) return 0;
    return I[DIRECT_O_MATERIAL] + p->index * DIRECT_MATERIAL_WORDS + p->word;
}

int64_t direct_step(Cable *cable, double t_end, double *inputs) {
    return cablemodel_direct_work(cable->I, cable->block_words, DIRECT_TASK_STEP, t_end, inputs,
                                  INPUT_WORDS);
}

/* The steady state for coefficients that were set before the start. */
int64_t direct_settle(Cable *cable) {
    double none[INPUT_WORDS] = {0};
    const int64_t status = cablemodel_direct_work(
        cable->I, cable->block_words, DIRECT_TASK_EQUILIBRIUM, scalars(cable->M)->time, none, INPUT_WORDS);
    if (status != OK) return status;
    header(cable->I)->steps = header(cable->I)->rejected = 0;
    header(cable->I)->factorisations = header(cable->I)->iterations = 0;
    return OK;
}

/* Rows of the stations, whose arc lengths stand in cable->arcs, and of the bodies. */
void direct_rows(Cable *cable) {
    const int64_t n = cable->stations;
    cablemodel_direct_sample(cable->I, cable->block_words, cable->arcs, n, cable->rows,
                             STATION_WORDS * n);
    cablemodel_direct_bodies(cable->I, cable->block_words, cable->rows + STATION_WORDS * n,
                             STATION_WORDS * cable->bodies);
}

/* What a failed step says, and the arc length of its place; words of cablemodel/direct. */
double direct_failure(const Cable *cable, int64_t status, const char **problem,
                      const char **advice) {
    static const struct {
        int64_t status;
        const char *problem, *advice;
    } failures[] = {DIRECT_FAILURES};
    const int64_t *I = cable->I;
    for (int k = 0; failures[k].problem != NULL; k++)
        if (failures[k].status == status) {
            *problem = failures[k].problem;
            *advice = failures[k].advice;
        }
    double arc = 0.0;
    const int64_t last = direct_nodes(I) - 1;
    const int64_t failed = I[header(I)->failed];
    const int64_t place = failed < last ? failed : last;
    for (int64_t n = 0; n < I[DIRECT_D_SECTIONS]; n++) {
        const int64_t *row = section(I, n);
        const int64_t first = row[DIRECT_N_FIRST];
        for (int64_t k = first + 1; k < first + row[DIRECT_N_COUNT] && k <= place; k++)
            arc += cable->M[I[DIRECT_O_LENGTH] + k];
    }
    return arc;
}
