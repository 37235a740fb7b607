/* How forces on vessels go on in time, and how they follow the inputs of the last step.

   The kernels work on a copy of the block, which is made when it is first asked for. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cable.h"

#define VESSEL_ASIDE 1e-4 /* by which vessels are moved for differences [m], [rad] */
enum { FORCE = VR_SUMMARY, TENSION = VR_SUMMARY + (int)(offsetof(Summary, top_tension) / 8) };

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

/* What is not cut stays whole: a derivative looks at what there is. */
static void keep_whole(int64_t *block) {
    double *row = (double *)(block + header(block)->cuts);
    for (int64_t n = 0; n < header(block)->cut_count; n++, row += CUT_WORDS) {
        AS(Cut, row)->time = AS(Cut, row)->tension = INFINITY;
        AS(Cut, row)->ordered = 0.0;
    }
}

/* Time derivatives of forces and moments on a system's vessels: their differences over a step that goes
   on as the last one, over a part of its length. What cannot be stepped has none. */
static const char *rate_in_system(Cable *cable, unsigned vr, double *value) {
    const int64_t place = wrench_of(cable, vr), words = WRENCH_WORDS * vessels_of(cable);
    if (place < 0) return "output derivatives are those of forces and moments on vessels";
    if (!cable->rate_current) {
        double *rates = cable->wrenches, *now = rates + words, none[INPUT_WORDS] = {0};
        const double span = AHEAD * cable->now.last_step;
        memset(rates, 0, sizeof(double) * (size_t)words); /* at rest, before the first step */
        read_wrenches(cable, cable->I, now); /* it puts lines' ends where their bodies are, to the last bit */
        int64_t *copy, status;
        do {
            copy = copy_of(cable);
            if (copy == NULL) return "out of memory";
            keep_whole(copy);
            header(copy)->factored = 0; /* the matrix is not all in the image */
            status = !(span > 0.0) ? NOT_CONVERGED
                                   : cablemodel_step(copy, cable->block_words,
                                                     scalars(cable->M)->time + span, none, INPUT_WORDS);
        } while (status == NO_CAPACITY && grow(cable));
        if (status == OK) {
            read_wrenches(cable, copy, rates);
            for (int64_t n = 0; n < words; n++) rates[n] = (rates[n] - now[n]) / span;
        }
        cable->rate_current = 1;
    }
    *value = cable->wrenches[place];
    return NULL;
}

/* Time derivative of an output; NULL, or what is wrong. */
const char *rate_of(Cable *cable, unsigned vr, double *value) {
    if (is_direct(cable->I)) return "no output derivatives are given by the direct solver";
    if (cable->system != NULL) return rate_in_system(cable, vr, value);
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

/* What a change of an input that was set for the last step makes of a place that it drives at its end:
   of position, velocity and acceleration, in powers of its length. by: what drove the place; went_on:
   the input drove the step before, too. */
static void change_at_end(const Controls *now, int64_t by, int is_position, int went_on, double change,
                          double end[3]) {
    const double h = now->last_step;
    const int extrapolated = now->input_timing == AT_START && !now->last_sloped;
    /* What a value that holds at the start changes at the end: the last value was another one. */
    const double growth = went_on ? now->growth : 0.0;
    const double further = extrapolated ? 1.0 + growth : 1.0;
    double velocity = 0.0, position = 0.0;
    end[0] = end[1] = end[2] = 0.0;
    if (by == BY_VELOCITY) {
        if (is_position) return;
        velocity = further * change;
        end[0] = 0.5 * h * velocity;
        end[1] = velocity;
        end[2] = velocity / h;
        return;
    }
    if (by == BY_POSITION) {
        if (is_position) velocity = further * change / h;
        end[0] = h * velocity;
    } else {
        /* The cubic: a velocity at the end alone leaves the position there as it is. */
        position = is_position ? change : 0.0;
        if (!is_position) velocity = further * change;
        if (!is_position && extrapolated) position = change * h * (1.0 + 0.5 * growth);
        end[0] = position;
    }
    end[1] = velocity;
    end[2] = 4.0 * velocity / h - 6.0 * (position + (by == BY_POSITION) * h * velocity) / (h * h);
}

static void add_motion(Cable *cable, unsigned vr, double change, MotionChange *motion) {
    const int axis = (int)vr % 3;
    double end[3];
    if (!(cable->now.last_driven & (VELOCITY_SET | POSITION_SET))) return;
    const int went_on = (input_at(cable, vr)->driving & WENT_ON) != 0;
    change_at_end(&cable->now, cable->now.last_mode, inputs_of(vr) == POSITION_SET, went_on, change, end);
    cable->by_place |= cable->now.last_mode != BY_VELOCITY;
    motion->position[axis] += end[0];
    motion->velocity[axis] += end[1];
    motion->acceleration[axis] += end[2];
}

/* Change the motion of a vessel, of which the last step was given some, at the present time. */
static void move_vessel(int64_t *block, const MotionInput *input, const double end[3], double share) {
    double *row = (double *)(block + header(block)->frames + input->vessel * FRAME_WORDS);
    Piece *piece = input->turning ? &AS(Frame, row)->turn_piece : &AS(Frame, row)->piece;
    Polynomial *law = AS(Polynomial, piece->data);
    const double passed = scalars((double *)block)->time - piece->start;
    law->position[input->axis] += share * (end[0] - passed * (end[1] - 0.5 * passed * end[2]));
    law->velocity[input->axis] += share * (end[1] - passed * end[2]);
    law->second[input->axis] += share * 0.5 * end[2];
}

/* Of a system: differences of what an implicit step makes of the present state, with vessels a little
   to either side. */
static const char *response_in_system(Cable *cable, const unsigned unknown[], size_t unknowns,
                                      const unsigned known[], size_t knowns, const double change[],
                                      double response[]) {
    const int64_t words = WRENCH_WORDS * vessels_of(cable);
    const double length = cable->now.last_step;
    double *sides[2] = {cable->wrenches + words, cable->wrenches + 2 * words};
    double size = 0.0, end[3];
    MotionInput input;
    for (size_t n = 0; n < unknowns; n++)
        if (wrench_of(cable, unknown[n]) < 0)
            return "derivatives are those of forces and moments on vessels";
    for (size_t n = 0; n < knowns; n++)
        if (!motion_of(cable, known[n], &input)) return "derivatives are those by inputs that move vessels";
    if (!(length > 0.0)) return "there are none before the first step: they depend on its length";
    for (size_t n = 0; n < knowns; n++) {
        if (!motion_of(cable, known[n], &input) || input.by == 0) continue;
        change_at_end(&cable->now, input.by, input.is_position, input.went_on, change[n], end);
        cable->by_place |= input.by != BY_VELOCITY;
        size += fabs(end[0]) + length * fabs(end[1]);
    }
    const double share = size > 0.0 ? VESSEL_ASIDE / size : 0.0;
    read_wrenches(cable, cable->I, sides[0]); /* as above */
    for (int side = 0; side < 2; side++) {
        int64_t *copy = copy_of(cable);
        if (copy == NULL) return "out of memory";
        for (size_t n = 0; n < knowns; n++) {
            if (!motion_of(cable, known[n], &input) || input.by == 0) continue;
            change_at_end(&cable->now, input.by, input.is_position, input.went_on, change[n], end);
            move_vessel(copy, &input, end, side == 0 ? -share : share);
        }
        if (cablemodel_wrenches_when_moved(copy, cable->block_words, length, sides[side], words) != 0)
            return "the equations are singular here";
    }
    for (size_t n = 0; n < unknowns; n++) {
        const int64_t place = wrench_of(cable, unknown[n]);
        response[n] = share > 0.0 ? (sides[1][place] - sides[0][place]) / (2.0 * share) : 0.0;
    }
    return NULL;
}

/* Derivatives of outputs at the end of the last step by the inputs that were set for it, times
   `change`; NULL, or what is wrong. */
const char *response_of(Cable *cable, const unsigned unknown[], size_t unknowns,
                        const unsigned known[], size_t knowns, const double change[],
                        double response[]) {
    MotionChange motion = {0};
    double force[3] = {0};
    if (is_direct(cable->I)) return "not provided by the direct solver";
    if (cable->system != NULL)
        return response_in_system(cable, unknown, unknowns, known, knowns, change, response);
    for (size_t n = 0; n < knowns; n++)
        if (!(inputs_of(known[n]) & (VELOCITY_SET | POSITION_SET)))
            return "derivatives are those by vessel.velocity and vessel.position";
    if (!(cable->now.last_step > 0.0))
        return "there are none before the first step: they depend on its length";
    motion.lasted = cable->now.last_step;
    for (size_t n = 0; n < knowns; n++) add_motion(cable, known[n], change[n], &motion);
    int64_t *copy = copy_of(cable);
    if (copy == NULL) return "out of memory";
    double *words = (double *)&motion;
    if (cablemodel_force_response(copy, cable->block_words, words, MOTION_CHANGE_WORDS, force, 3) != 0)
        return "the equations are singular here";
    for (size_t n = 0; n < unknowns; n++)
        if (!output_change(cable, unknown[n], force, &response[n]))
            return "derivatives are those of force.top and tension.top";
    return NULL;
}
