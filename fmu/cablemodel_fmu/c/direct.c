/* The direct solver's block behind the same outputs, coefficients and steps (see cable.h). */
#include <math.h>
#include <string.h>

#include "cable.h"

#define LEAST_SETTING 1e-9 /* time step [s] and node spacing [m] of a model file, at least */

static const int64_t *section(const int64_t *I, int64_t index) {
    return I + own_header(I)->sections + index * DIRECT_SECTION_WORDS;
}

int64_t direct_nodes(const int64_t *I) {
    const int64_t *last = section(I, own_header(I)->section_count - 1);
    return AS(Section, last)->first + AS(Section, last)->count;
}

/* Sections follow one another, and all that they name is there. */
static const char *check_sections(const int64_t *I) {
    const double *M = (const double *)I;
    const int64_t bodies = own_header(I)->body_count, materials = own_header(I)->material_count;
    int64_t node = 0;
    int meets = own_header(I)->meeting == 0;
    for (int64_t n = 0; n < own_header(I)->section_count; n++) {
        const int64_t *row = section(I, n);
        const int rigid = AS(Section, row)->kind == DIRECT_RIGID;
        if (AS(Section, row)->first != node || !within(AS(Section, row)->count, 2, header(I)->capacity - node) ||
            !within(AS(Section, row)->kind, DIRECT_CABLE, DIRECT_RIGID) ||
            !within(AS(Section, row)->material, 0, materials - 1) ||
            !within(AS(Section, row)->body, rigid ? 0 : -1, bodies - 1) ||
            !within(AS(Section, row)->point, -1, bodies - 1) ||
            (rigid && (n == 0 || AS(Section, row)->count != 2)))
            return "a section of the line is out of range";
        for (int64_t k = node + 1; k < node + AS(Section, row)->count && !rigid; k++)
            if (!(M[own_header(I)->length + k] > 0.0)) return "an interval of the line has no length";
        if (n > 0 && own_header(I)->meeting == node) meets = 1;
        node += AS(Section, row)->count;
    }
    if (!within(AS(Section, section(I, own_header(I)->section_count))->point, -1, bodies - 1) || !meets)
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
    if (!within(own_header(I)->section_count, 1, own_header(I)->section_capacity) ||
        !within(own_header(I)->drum_count, 0, own_header(I)->drum_capacity) ||
        !within(own_header(I)->drum_used, 0, own_header(I)->drum_count) ||
        !within(own_header(I)->planar, 0, 1) ||
        !within(own_header(I)->method, DIRECT_SUPERPOSITION, DIRECT_ELIMINATION) ||
        !within(own_header(I)->joint, DIRECT_PAPER, DIRECT_MOMENT_FREE) ||
        !within(own_header(I)->end, DIRECT_END_FREE, DIRECT_END_TOUCHDOWN) ||
        !within(own_header(I)->clamped, 0, 3) || !within(own_header(I)->floor, 0, 1) ||
        !within(own_header(I)->restart, 0, 1) || !within(own_header(I)->sticks, 0, 1) ||
        !within(header(I)->piece, 1, header(I)->piece_count - 1) || !within(header(I)->live, 0, 1) ||
        !within(header(I)->current_kind, 0, 2) || (header(I)->current_kind == 1 && header(I)->depth_count != 1) ||
        !within(header(I)->payout, 0, 1) ||
        !check_winches(I, 1, 2) || header(I)->dimension != 3)
        return "a counter in the model is out of range";
    if (!(fabs(scalars(M)->time) < 1e300) || !(own_scalars(M)->time_step > LEAST_SETTING) ||
        !(own_scalars(M)->spacing > LEAST_SETTING) || !(own_scalars(M)->tolerance > 0.0) ||
        !(own_scalars(M)->alpha >= 0.5 && own_scalars(M)->alpha <= 1.0))
        return "a setting in the model is out of range";
    for (int64_t n = 0; n < own_header(I)->material_count; n++) {
        const double *row = M + own_header(I)->materials + n * DIRECT_MATERIAL_WORDS;
        const int64_t first = header(I)->strain, last = first + header(I)->strain_words;
        if (!whole(AS(Material, row)->terms, 1, header(I)->strain_words) ||
            !whole(AS(Material, row)->offset, first, last) ||
            AS(Material, row)->offset + AS(Material, row)->terms > (double)last)
            return "a cable is out of range";
    }
    for (int64_t n = 0; n < own_header(I)->drum_count; n++) {
        const int64_t *row = I + own_header(I)->drum + n * DIRECT_DRUM_WORDS;
        if (!within(AS(DrumRow, row)->material, 0, own_header(I)->material_count - 1) ||
            !within(AS(DrumRow, row)->kind, DIRECT_CABLE, DIRECT_ELASTICA) ||
            !within(AS(DrumRow, row)->point, -1, own_header(I)->body_count - 1) ||
            !within(AS(DrumRow, row)->rigid, -1, own_header(I)->body_count - 1))
            return "a joint on the drum is out of range";
    }
    return check_sections(I);
}

/* Where a coefficient is in the block: its material's row, or its body's; 0 if it is none. */
int64_t direct_word(const int64_t *I, const Parameter *p) {
    if (p->kind == OF_BODY) {
        const int known = p->word == WORD(RigidBody, drag) || p->word == WORD(RigidBody, drag_axial) ||
                          p->word == WORD(RigidBody, weight);
        if (!known || !within(p->index, 0, own_header(I)->body_count - 1)) return 0;
        return own_header(I)->bodies + p->index * DIRECT_BODY_WORDS + p->word;
    }
    const int known = p->word == WORD(Material, normal) || p->word == WORD(Material, tangential) ||
                      p->word == WORD(Material, added_mass) || p->word == WORD(Material, weight);
    if (p->kind != OF_CABLES || !known || !within(p->index, 0, own_header(I)->material_count - 1)) return 0;
    return own_header(I)->materials + p->index * DIRECT_MATERIAL_WORDS + p->word;
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

/* What a failed step says, and the arc length of its place; words of cablemodel/solvers/direct. */
double direct_failure(const Cable *cable, int64_t status, const char **problem,
                      const char **advice) {
    static const Failure failures[] = {DIRECT_FAILURES};
    const int64_t *I = cable->I;
    look_up(failures, status, problem, advice);
    double arc = 0.0;
    const int64_t last = direct_nodes(I) - 1;
    const int64_t failed = I[header(I)->failed];
    const int64_t place = failed < last ? failed : last;
    for (int64_t n = 0; n < own_header(I)->section_count; n++) {
        const int64_t *row = section(I, n);
        const int64_t first = AS(Section, row)->first;
        for (int64_t k = first + 1; k < first + AS(Section, row)->count && k <= place; k++)
            arc += cable->M[own_header(I)->length + k];
    }
    return arc;
}
