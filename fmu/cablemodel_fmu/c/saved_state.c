/* The state of an instance as one piece of memory: controls, parameters, image of the block, and of
   the finer run's where errors are estimated. */
#include <math.h>
#include <string.h>

#include "cable.h"

size_t state_bytes(const Cable *cable) {
    const int64_t finer = cable->finer == NULL ? 0 : cable->finer->image_words;
    return sizeof(Controls) + 8 * (size_t)(cable->parameter_count + cable->image_words + finer);
}

static uint32_t state_checksum(const void *state, size_t bytes) {
    const size_t skip = offsetof(Controls, kernels);
    return checksum((const char *)state + skip, bytes - skip);
}

void save_state(const Cable *cable, void *to) {
    char *at = to;
    const size_t parameters = 8 * (size_t)cable->parameter_count;
    memcpy(at, &cable->now, sizeof(Controls));
    memcpy(at + sizeof(Controls), cable->values, parameters);
    at += sizeof(Controls) + parameters;
    memcpy(at, cable->I, 8 * (size_t)cable->image_words);
    if (cable->finer != NULL)
        memcpy(at + 8 * cable->image_words, cable->finer->I,
               8 * (size_t)cable->finer->image_words);
}

/* What leaves the instance has a checksum. The bytes may lie anywhere. */
void seal_state(const Cable *cable, void *state) {
    const int64_t sum = state_checksum(state, state_bytes(cable));
    memcpy((char *)state + offsetof(Controls, checksum), &sum, sizeof sum);
}

/* NULL if a saved state is whole and of this FMU. */
const char *check_state(const Cable *cable, const void *from, size_t bytes) {
    Controls then;
    if (bytes != state_bytes(cable)) return "the state has a wrong size";
    memcpy(&then, from, sizeof then);
    if (then.magic != STATE_MAGIC || then.words != cable->now.words) return "not a state of this FMU";
    if (then.kernels != cable->now.kernels || memcmp(then.guid, cable->now.guid, sizeof then.guid))
        return "the state belongs to another FMU";
    if (then.checksum != (int64_t)state_checksum(from, bytes)) return "the state is corrupted";
    if (then.vessel_input < BY_VELOCITY || then.vessel_input > BY_BOTH ||
        then.input_timing < AT_END || then.input_timing > AT_START ||
        (then.use_scene_inputs | 1) != 1 || (then.unsettled | 1) != 1 ||
        (then.has_slope | 1) != 1 || (then.scene_inputs_given | 1) != 1 || (then.vessel_input_given | 1) != 1 ||
        (then.set | ALL_SET) != ALL_SET || !(then.last_step >= 0.0 && then.last_step < 1e300) ||
        !(fabs(then.growth) < 1e300) ||
        then.phase < INSTANTIATED || then.phase > TERMINATED || !(fabs(then.start_time) < 1e300))
        return "the state is corrupted";
    for (int n = 0; n < VR_INPUTS; n++)
        if (!(fabs(then.input[n]) < 1e100) || !(fabs(then.before[n]) < 1e100) ||
            !(fabs(then.slope[n][0]) < 1e100) || !(fabs(then.slope[n][1]) < 1e100) ||
            !(fabs(then.slope[n][2]) < 1e100))
            return "the state is corrupted";
    for (int n = 0; n < VR_STARTS; n++)
        if (!(fabs(then.start[n]) < 1e100)) return "the state is corrupted";
    const double *values = (const double *)((const char *)from + sizeof then);
    for (int64_t n = 0; n < cable->parameter_count; n++)
        if (!(values[n] >= cable->parameters[n].minimum && values[n] <= cable->parameters[n].maximum))
            return "the state is corrupted";
    const int64_t *image = (const int64_t *)(values + cable->parameter_count);
    for (; cable != NULL; image += cable->image_words, cable = cable->finer) {
        if (image[I_MAGIC] != cable->I[I_MAGIC]) return "the state is corrupted";
        const char *problem = check_block(image, cable->image_words, cable->block_words);
        if (problem != NULL) return problem;
    }
    return NULL;
}

/* Take over a state that was saved, or checked, here; another one's is refused, and nothing
   changes. */
const char *restore_state(Cable *cable, const void *from) {
    const Controls *then = from;
    if (then->magic != STATE_MAGIC || then->words != cable->now.words)
        return "not a state of this FMU";
    if (then->kernels != cable->now.kernels ||
        memcmp(then->guid, cable->now.guid, sizeof then->guid))
        return "the state belongs to another FMU";
    const char *at = from;
    const size_t parameters = 8 * (size_t)cable->parameter_count;
    memcpy(&cable->now, at, sizeof(Controls));
    memcpy(cable->values, at + sizeof(Controls), parameters);
    at += sizeof(Controls) + parameters;
    memcpy(cable->I, at, 8 * (size_t)cable->image_words);
    if (cable->finer != NULL)
        memcpy(cable->finer->I, at + 8 * cable->image_words,
               8 * (size_t)cable->finer->image_words);
    outputs_changed(cable);
    return NULL;
}
