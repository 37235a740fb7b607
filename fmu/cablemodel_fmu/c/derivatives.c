/* How the force on the vessel goes on in time, and how it follows the inputs of the last step.

   The kernels work on a copy of the block, which is made when it is first asked for. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cable.h"

enum { FORCE = VR_SUMMARY, TENSION = VR_SUMMARY + 6 };

/* A copy of the block's image, with room for what kernels work in; NULL: out of memory. */
static int64_t *copy_of(Cable *cable) {
    if (cable->copy == NULL) cable->copy = calloc((size_t)cable->block_words, 8);
    if (cable->copy != NULL) memcpy(cable->copy, cable->I, 8 * (size_t)cable->image_words);
    return cable->copy;
}

/* Of a change of the force: what an output changes by. Returns 0 if it is another output. */
static int output_change(Cable *cable, unsigned vr, const double force[3], double *value) {
    if (vr >= FORCE && vr < FORCE + 3) {
        *value = force[vr - FORCE];
        return 1;
    }
    if (vr != TENSION) return 0;
    /* It is the size of the force, negative where the cable pushes. */
    double now[3], tension = 0.0;
    for (unsigned i = 0; i < 3; i++) read_value(cable, FORCE + i, &now[i]);
    read_value(cable, TENSION, &tension);
    *value = 0.0;
    for (int i = 0; i < 3; i++)
        if (tension != 0.0) *value += force[i] * now[i] / tension;
    return 1;
}

/* Time derivative of an output; NULL, or what is wrong. */
const char *rate_of(Cable *cable, unsigned vr, double *value) {
    if (is_direct(cable->I)) return "no output derivatives are given by the direct solver";
    if (cable->system != NULL) return "no output derivatives are given of a system";
    if (!cable->rate_current) {
        int64_t *copy = copy_of(cable);
        if (copy == NULL) return "out of memory";
        memset(cable->rate, 0, sizeof cable->rate); /* at rest, before the first step */
        if (cable->now.last_step > 0.0)
            cablemodel_force_rate(copy, cable->block_words, cable->now.last_step, cable->rate, 3);
        cable->rate_current = 1;
    }
    return output_change(cable, vr, cable->rate, value)
               ? NULL
               : "output derivatives are those of force.top and tension.top";
}

/* What a change of an input that was set for the last step makes of the motion at its end: of
   position, velocity and acceleration, in powers of its length. */
static void add_motion(const Cable *cable, unsigned vr, double change, double motion[9]) {
    const Controls *now = &cable->now;
    const double h = now->last_step;
    const int axis = (int)vr % 3, is_position = inputs_of(vr) == POSITION_SET;
    const int extrapolated = now->input_timing == AT_START && !now->last_sloped;
    /* What a value that holds at the start changes at the end: the last value was another one. */
    const double further = extrapolated ? 1.0 + now->growth : 1.0;
    double velocity = 0.0, position = 0.0;
    if (!(now->last_driven & (VELOCITY_SET | POSITION_SET))) return;
    if (now->last_mode == BY_VELOCITY) {
        if (is_position) return;
        velocity = further * change;
        motion[axis] += 0.5 * h * velocity;
        motion[3 + axis] += velocity;
        motion[6 + axis] += velocity / h;
        return;
    }
    if (now->last_mode == BY_POSITION) {
        if (is_position) velocity = further * change / h;
        motion[axis] += h * velocity;
    } else {
        /* The cubic: a velocity at the end alone leaves the position there as it is. */
        position = is_position ? change : 0.0;
        if (!is_position) velocity = further * change;
        if (!is_position && extrapolated) position = change * h * (1.0 + 0.5 * now->growth);
        motion[axis] += position;
    }
    motion[3 + axis] += velocity;
    motion[6 + axis] += 4.0 * velocity / h - 6.0 * (position + (now->last_mode == BY_POSITION) * h *
                                                                   velocity) / (h * h);
}

/* Derivatives of outputs at the end of the last step by the inputs that were set for it, times
   `change`; NULL, or what is wrong. */
const char *response_of(Cable *cable, const unsigned unknown[], size_t unknowns,
                        const unsigned known[], size_t knowns, const double change[],
                        double response[]) {
    double motion[10] = {0}, force[3] = {0};
    if (is_direct(cable->I)) return "not provided by the direct solver";
    if (cable->system != NULL) return "not provided of a system";
    for (size_t n = 0; n < knowns; n++)
        if (!(inputs_of(known[n]) & (VELOCITY_SET | POSITION_SET)))
            return "derivatives are those by vessel.velocity and vessel.position";
    if (!(cable->now.last_step > 0.0))
        return "there are none before the first step: they depend on its length";
    motion[9] = cable->now.last_step;
    for (size_t n = 0; n < knowns; n++) add_motion(cable, known[n], change[n], motion);
    int64_t *copy = copy_of(cable);
    if (copy == NULL) return "out of memory";
    if (cablemodel_force_response(copy, cable->block_words, motion, 10, force, 3) != 0)
        return "the equations are singular here";
    for (size_t n = 0; n < unknowns; n++)
        if (!output_change(cable, unknown[n], force, &response[n]))
            return "derivatives are those of force.top and tension.top";
    return NULL;
}
