/* The state at the start that belongs to the values set: what it is judged by, of a line (lengths.c) or a
   system (system_start.c). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cable.h"

#define HALVINGS_OF_RATE 20 /* to a part in a million: what is coupled at all differs by more */

/* How far a shape is from what its elements can follow. */
Shape shape_of(const Cable *cable) {
    Shape found = {0};
    cablemodel_worst_of_shape(cable->I, cable->block_words, (double *)&found, sizeof found / 8);
    found.bent /= BENT;
    return found;
}

/* What is to be told of a start that was found anew, where the exported one was not like that. bent: by how
   much it was when it was found, on the exported elements. */
void judge_shape(Cable *cable, const Shape *before, double bent) {
    const Shape now = shape_of(cable);
    bent = fmax(bent, now.bent);
    cable->bent = bent > fmax(FAR_TOO_BENT, before->bent) ? bent : 0.0;
    cable->stretched = now.stretched > fmax(LARGE_STRAIN, before->stretched) ? now.stretched : 0.0;
}

static int64_t halve_bent(Cable *cable) {
    const int64_t nodes = header(cable->I)->nodes;
    double *bends = malloc(8 * (size_t)nodes);
    if (bends == NULL) return NO_CAPACITY;
    cablemodel_measure_bends(cable->I, cable->block_words, bends, nodes);
    const int64_t found = cablemodel_halve_bent(cable->I, cable->block_words, bends, nodes, BENT);
    free(bends);
    return found;
}

/* Finer where a line bends too much, or where it meets the floor, and at rest again: start/refinement.py.
   What fails leaves the mesh to the run. */
int64_t refine(Cable *cable, int at_floor, int64_t (*rest)(Cable *, double *), double *velocity) {
    for (int round = 0; round < REFINEMENTS; round++) {
        if (!at_floor && header(cable->I)->nodes > LARGEST_STATIC_MESH) break;
        int64_t found, *at_rest = copy_of_image(cable);
        if (at_rest == NULL) return NO_CAPACITY;
        while ((found = at_floor ? cablemodel_refine_at_floor(cable->I, cable->block_words)
                                 : halve_bent(cable)) == NO_CAPACITY) {
            give_back(cable, at_rest);
            free(at_rest);
            if (!grow(cable) || (at_rest = copy_of_image(cable)) == NULL) return NO_CAPACITY;
        }
        if (found != NOTHING && !at_floor) cablemodel_restore_bending(cable->I, cable->block_words);
        if (found != NOTHING && rest(cable, velocity) != OK) {
            give_back(cable, at_rest);
            found = NOTHING;
        }
        free(at_rest);
        if (found == NOTHING) break;
    }
    return OK;
}

int64_t *copy_of_image(const Cable *cable) {
    int64_t *copy = malloc(8 * (size_t)cable->image_words);
    if (copy != NULL) memcpy(copy, cable->I, 8 * (size_t)cable->image_words);
    return copy;
}

void give_back(Cable *cable, const int64_t *image) {
    memcpy(cable->I, image, 8 * (size_t)cable->image_words);
}

/* How many small motions about a start grow by themselves by more than a rate [1/s], as `stays` of
   cablemodel/solvers/finite_element/start/unstable_start.py looks at it. -1: it cannot be told. */
static int64_t count_above(Cable *cable, double rate) {
    double frame[3], none[1];
    const int64_t words = cablemodel_count_leaving(cable->I, cable->block_words, rate, none, 0);
    int64_t found = -1, *kept = copy_of_image(cable);
    double *work = malloc(8 * (size_t)words);
    if (kept != NULL && work != NULL) {
        frame_of_rest(cable, frame);
        cablemodel_stop_flow(cable->I, cable->block_words, frame, header(cable->I)->dimension);
        found = cablemodel_count_leaving(cable->I, cable->block_words, rate, work, words);
        give_back(cable, kept);
    }
    free(work);
    free(kept);
    return found;
}

static double slowest_growth(const Cable *cable) {
    return SLOWEST / scalars(cable->M)->period;
}

/* 0: none grows by a rate that matters. */
int64_t count_growing(Cable *cable) {
    return count_above(cable, slowest_growth(cable));
}

/* Whether what grows fastest swings: a pair of motions does. Nothing but foils feeds a swing; without
   them two that grow alike fall, either way. */
static int swings_up(Cable *cable) {
    if (header(cable->I)->foil_count == 0) return 0;
    double low = slowest_growth(cable), high = 2.0 * low;
    while (count_above(cable, high) > 0) low = high, high *= 2.0;
    for (int n = 0; n < HALVINGS_OF_RATE; n++) {
        const double middle = sqrt(low * high);
        *(count_above(cable, middle) > 0 ? &low : &high) = middle;
    }
    const int64_t found = count_above(cable, low);
    return found > 0 && found % 2 == 0;
}

/* Why a start that was found anew, which the line leaves by itself, is none to begin with; NULL: it is
   warned of, as the exported one is left, too, or as it swings up: the library looks for another one
   where a start falls. */
const char *refuse_growth(Cable *cable, const char *changed) {
    cable->leaves = (cable->flags & FLAG_LEAVES) ? AS_EXPORTED : swings_up(cable) ? SWINGS_UP : 0;
    if (cable->leaves) return NULL;
    snprintf(cable->message, sizeof cable->message,
             "%s is not the scene's: the start that is found with it falls by itself; export the scene with this "
             "value, where another one is looked for", changed);
    return cable->message;
}

/* The same of any that was found anew. */
const char *judge_growth(Cable *cable, const char *changed) {
    return count_growing(cable) == 0 ? NULL : refuse_growth(cable, changed);
}

static const char *find_start(Cable *cable) {
    return cable->system != NULL ? settle_system(cable) : settle_line(cable);
}

/* The finer run at the same values; one that has no start there is left behind. */
static void settle_finer(Cable *cable) {
    Cable *finer = cable->finer;
    memcpy(finer->values, cable->values, 8 * (size_t)cable->value_words);
    memcpy(finer->now.start, cable->now.start, sizeof finer->now.start);
    if (find_start(finer) == NULL) return;
    restore_exported(finer);
    scalars(finer->M)->time = scalars(cable->M)->time - 1.0;
}

/* The state at the start for the values set. */
const char *settle_cable(Cable *cable) {
    if (!cable->now.unsettled) return NULL;
    outputs_changed(cable);
    const char *problem = find_start(cable);
    cable->now.unsettled = problem != NULL;
    if (problem == NULL && cable->finer != NULL) settle_finer(cable);
    return problem;
}
