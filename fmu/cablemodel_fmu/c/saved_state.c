/* The state of an instance as one piece of memory: controls, parameters, image of the block, and of
   the finer run's where errors are estimated.

   A state has the room for nodes that its instance had, which may be less or more than another has, or
   has later: the block's memory grows (room.c). Whatever takes a state takes its room.

   In memory only what is in use of an image is copied, into its own place: a master that rolls back
   does so at every step. What is written for elsewhere is whole, with a checksum, and is checked
   when it is read. */
#include <math.h>
#include <string.h>

#include "cable.h"

size_t state_bytes(const Cable *cable) {
    const int64_t finer = cable->finer == NULL ? 0 : cable->finer->image_words;
    return sizeof(Controls) + 8 * (size_t)(cable->value_words + cable->image_words + finer);
}

/* Of a state that was saved, or checked. */
size_t bytes_of_state(const void *state) { return 8 * (size_t)((const Controls *)state)->words; }

static int64_t words_of(const int64_t *image) { return header(image)->image_words; }

typedef struct {
    int64_t at, words;
} Part;
enum { TABLES = 3, OF_ALL = 9, PARTS = TABLES + 15 };

/* What of an image is in use, as in kernels/time/backup.py: what may change but for the nodes, then the
   arrays of the nodes; history and matrix are of those that are awake. Tables of the scene never
   change. */
static void parts_of(const int64_t *I, Part parts[PARTS]) {
    const int64_t size = 2 * header(I)->dimension, nodes = header(I)->nodes;
    const int64_t awake = nodes - header(I)->asleep;
    const struct {
        int64_t array, words;
    } of_nodes[PARTS - TABLES] = {
        {WORD(Header, parent), 1}, {WORD(Header, joint), 1}, {WORD(Header, edges), EDGE_WORDS}, {WORD(Header, position), size}, {WORD(Header, velocity), size},
        {WORD(Header, acceleration), size}, {WORD(Header, tension), 2}, {WORD(Header, tension_rate), 2}, {WORD(Header, rest), size},
        {WORD(Header, history), 2 * size}, {WORD(Header, diagonal), size * size}, {WORD(Header, upper), size * size},
        {WORD(Header, lower), size * size}, {WORD(Header, gradient), 4 * size}, {WORD(Header, compliance), 3}};
    parts[0] = (Part){0, header(I)->pieces + PIECE_WORDS};
    parts[1] = (Part){header(I)->cables, header(I)->cable_count * CABLE_WORDS};
    parts[2] = (Part){header(I)->bodies, header(I)->position - header(I)->bodies};
    for (int n = 0; n < PARTS - TABLES; n++) {
        const int64_t rows = n < OF_ALL ? nodes : awake;
        parts[TABLES + n] = (Part){I[of_nodes[n].array], rows * of_nodes[n].words};
    }
}

/* What is in use of an image, into the place of another one of the same model and room. */
static void copy_used(void *to, const int64_t *from) {
    if (is_direct(from)) {
        memcpy(to, from, 8 * (size_t)words_of(from));
        return;
    }
    Part parts[PARTS];
    parts_of(from, parts);
    for (int n = 0; n < PARTS; n++)
        memcpy((char *)to + 8 * parts[n].at, from + parts[n].at, 8 * (size_t)parts[n].words);
}

static const int64_t *images_in(const Cable *cable, const void *state) {
    const size_t before = sizeof(Controls) + 8 * (size_t)cable->value_words;
    return (const int64_t *)((const char *)state + before);
}

void save_state(const Cable *cable, void *to) {
    memcpy(to, &cable->now, sizeof(Controls));
    ((Controls *)to)->words = (int64_t)(state_bytes(cable) / 8);
    memcpy((char *)to + sizeof(Controls), cable->values, 8 * (size_t)cable->value_words);
    int64_t *image = (int64_t *)images_in(cable, to);
    for (; cable != NULL; image += cable->image_words, cable = cable->finer)
        copy_used(image, cable->I);
}

static uint32_t state_checksum(const void *state, size_t bytes) {
    const size_t skip = offsetof(Controls, kernels);
    return checksum((const char *)state + skip, bytes - skip);
}

/* A state as it leaves the instance: whole, what is not in use zero. The bytes may lie anywhere. */
void write_state(const Cable *cable, const void *state, char *bytes) {
    const size_t before = sizeof(Controls) + 8 * (size_t)cable->value_words;
    const int64_t *image = images_in(cable, state);
    char *at = bytes + before;
    memcpy(bytes, state, before);
    for (const Cable *one = cable; one != NULL; one = one->finer) {
        const int64_t first = is_direct(image) ? 0 : header(image)->parent;
        memcpy(at, initial_image(one), 8 * (size_t)first);
        memset(at + 8 * first, 0, 8 * (size_t)(words_of(image) - first));
        copy_used(at, image);
        at += 8 * words_of(image);
        image += words_of(image);
    }
    const int64_t sum = state_checksum(bytes, bytes_of_state(state));
    memcpy(bytes + offsetof(Controls, checksum), &sum, sizeof sum);
}

/* NULL if an image that so many words are left for is one of this block, of whatever room. */
static const char *check_image(const Cable *cable, const int64_t *image, int64_t left) {
    const int64_t *own = initial_image(cable);
    if (left < HEADER_WORDS + SCALAR_WORDS || header(image)->magic != header(own)->magic)
        return "the state is corrupted";
    if (is_direct(own))
        return left < cable->image_words || words_of(image) != cable->image_words
                   ? "the state is corrupted"
                   : check_block(image, cable->image_words, cable->block_words);
    if (!same_sizes(image, own) || words_of(image) > left || is_system(image) != is_system(own)) return "the state is corrupted";
    return check_block(image, words_of(image), header(image)->byte_count / 8);
}

/* NULL if a state that was written is whole and of this FMU. */
const char *check_state(const Cable *cable, const void *from, size_t bytes) {
    Controls then;
    const size_t before = sizeof then + 8 * (size_t)cable->value_words;
    if (bytes < before || bytes % 8 != 0) return "the state has a wrong size";
    memcpy(&then, from, sizeof then);
    if (then.magic != STATE_MAGIC) return "not a state of this FMU";
    if (then.kernels != cable->now.kernels || memcmp(then.guid, cable->now.guid, sizeof then.guid))
        return "the state belongs to another FMU";
    if (then.words != (int64_t)(bytes / 8)) return "the state has a wrong size";
    if (then.checksum != (int64_t)state_checksum(from, bytes)) return "the state is corrupted";
    const int64_t flags = then.use_scene_inputs | then.scene_inputs_given | then.unsettled |
                          then.vessel_input_given | then.has_slope;
    if (then.vessel_input < BY_VELOCITY || then.vessel_input > BY_BOTH ||
        then.input_timing < AT_END || then.input_timing > AT_START || (flags | 1) != 1 ||
        !(then.last_step >= 0.0 && then.last_step < 1e300) || !(fabs(then.growth) < 1e300) ||
        then.phase < INSTANTIATED || then.phase > TERMINATED || !(fabs(then.start_time) < 1e300))
        return "the state is corrupted";
    for (int n = 0; n < VR_STARTS; n++)
        if (!(fabs(then.start[n]) < 1e100)) return "the state is corrupted";
    const double *values = (const double *)((const char *)from + sizeof then);
    for (int64_t n = 0; n < cable->parameter_count; n++)
        if (!(values[n] >= cable->parameters[n].minimum && values[n] <= cable->parameters[n].maximum))
            return "the state is corrupted";
    for (int64_t n = 0; n < cable->inputs; n++) {
        const Input *input = inputs_in(cable, values) + n;
        if (!(fabs(input->value) < 1e100) || !(fabs(input->before) < 1e100) ||
            !(fabs(input->slope[0]) < 1e100) || !(fabs(input->slope[1]) < 1e100) ||
            !(fabs(input->slope[2]) < 1e100) || !within(input->set, 0, SET_EVER | SET_IN_RUN) ||
            !within(input->driving, 0, DROVE | WENT_ON))
            return "the state is corrupted";
    }
    if (cable->system != NULL && check_part_inputs(cable, (void *)values) != NULL)
        return "the state is corrupted";
    const int64_t *image = images_in(cable, from);
    int64_t left = (int64_t)((bytes - before) / 8);
    for (; cable != NULL; cable = cable->finer) {
        const char *problem = check_image(cable, image, left);
        if (problem != NULL) return problem;
        left -= words_of(image);
        image += words_of(image);
    }
    return left == 0 ? NULL : "the state is corrupted";
}

/* The image as it was; of nodes that there were not, nothing is left. */
static void restore_image(Cable *cable, const int64_t *from) {
    Part now[PARTS], then[PARTS];
    if (!is_direct(from) && header(from)->capacity != header(cable->I)->capacity) {
        lay_out_as(cable, from);
    } else if (!is_direct(from)) {
        parts_of(cable->I, now);
        parts_of(from, then);
        for (int n = TABLES; n < PARTS; n++)
            if (now[n].words > then[n].words)
                memset(cable->I + now[n].at + then[n].words, 0,
                       8 * (size_t)(now[n].words - then[n].words));
    }
    copy_used(cable->I, from);
}

/* Take over a state that was saved, or checked, here; another one's is refused, and nothing
   changes. */
const char *restore_state(Cable *cable, const void *from) {
    const Controls *then = from;
    if (then->magic != STATE_MAGIC) return "not a state of this FMU";
    if (then->kernels != cable->now.kernels ||
        memcmp(then->guid, cable->now.guid, sizeof then->guid))
        return "the state belongs to another FMU";
    const int64_t *image = images_in(cable, from);
    for (Cable *one = cable; one != NULL; image += words_of(image), one = one->finer)
        if (!reserve(one, header(image)->byte_count / 8, header(image)->capacity))
            return "out of memory";
    memcpy(&cable->now, from, sizeof(Controls));
    memcpy(cable->values, then + 1, 8 * (size_t)cable->value_words);
    image = images_in(cable, from);
    for (Cable *one = cable; one != NULL; image += words_of(image), one = one->finer)
        restore_image(one, image);
    outputs_changed(cable);
    return NULL;
}
