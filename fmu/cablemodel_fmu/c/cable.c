/* Inputs, coefficients, steps and outputs of one cable, in the words of the value references. */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "cable.h"

const int64_t *initial_image(const Cable *cable) {
    return (const int64_t *)(cable->parameters + cable->parameter_count) + file_header(cable->file)->system_words;
}

/* The first shape of a system whose start may be set, and the image of its block along that. */
const double *first_shape(const Cable *cable) {
    return (const double *)(initial_image(cable) + file_header(cable->file)->image_words);
}
const int64_t *first_image(const Cable *cable) {
    return (const int64_t *)(first_shape(cable) + file_header(cable->file)->shape_words);
}

void outputs_changed(Cable *cable) {
    cable->summary_current = cable->stations_current = cable->errors_current = 0;
    cable->rate_current = 0;
    if (cable->system != NULL) system_changed(cable->system);
    if (cable->finer != NULL) outputs_changed(cable->finer);
}

double cable_time(const Cable *cable) { return scalars(cable->M)->time + cable->now.start_time; }

/* Start values everywhere, the block at the scene's initial state. */
void restart_cable(Cable *cable) {
    take_exported(cable);
    for (int64_t n = 0; n < cable->parameter_count; n++)
        cable->values[n] = cable->parameters[n].start;
    const size_t identity = offsetof(Controls, phase);
    memset((char *)&cable->now + identity, 0, sizeof cable->now - identity);
    memset(inputs_in(cable, cable->values), 0, 8 * (size_t)(cable->value_words - cable->parameter_count));
    const double *scene = file_header(cable->file)->inputs;
    memcpy(cable->now.start, scene + VR_POSITION, 3 * sizeof(double));
    memcpy(cable->now.start + 3, scene + VR_VELOCITY, 3 * sizeof(double));
    cable->now.phase = INSTANTIATED;
    cable->now.use_scene_inputs = (cable->flags & FLAG_SCENE_INPUTS) != 0;
    cable->now.vessel_input = (cable->flags & FLAG_VESSEL_INPUT) / FLAG_VESSEL_INPUT_UNIT;
    cable->now.input_timing = (cable->flags & FLAG_AT_START) ? AT_START : AT_END;
    cable->bent = cable->stretched = cable->pressed = 0.0;
    cable->leaves = 0;
    if (cable->finer != NULL) restart_cable(cable->finer);
    if (cable->system != NULL) restart_system(cable);
    for (int n = 0; n < VR_INPUTS && cable->system == NULL; n++) input_at(cable, n)->value = scene[n];
    outputs_changed(cable);
}

static int is_parameter(const Cable *cable, unsigned vr) {
    return vr >= VR_PARAMETER && vr < VR_PARAMETER + (unsigned)cable->parameter_count;
}

/* -- inputs ------------------------------------------------------------------------------------ */

/* Which group a real variable's reference belongs to; 0: it is no input. */
int64_t inputs_of(unsigned vr) {
    if (vr >= VR_INPUTS) return 0;
    if (vr >= VR_CURRENT) return CURRENT_SET;
    if (vr >= VR_PAYOUT) return PAYOUT_SET;
    return vr >= VR_POSITION ? POSITION_SET : VELOCITY_SET;
}

/* By a value reference; NULL: it is none. */
Input *input_of(const Cable *cable, unsigned vr) {
    const int64_t n = (int64_t)vr - first_input(cable);
    return within(n, 0, cable->inputs - 1) ? input_at(cable, n) : NULL;
}

/* How many inputs go together, and the first of them. */
int64_t group_of(const Cable *cable, int64_t n, int64_t *first) {
    if (cable->system != NULL) return group_in_system(cable->system, n, first);
    *first = n < VR_PAYOUT ? n - n % 3 : n < VR_CURRENT ? VR_PAYOUT : VR_CURRENT;
    return *first == VR_PAYOUT ? 1 : 3;
}

/* Remember that the master sets an input, or a derivative of it: then it is connected. */
void mark_set(Cable *cable, unsigned vr, int derivative) {
    int64_t first = 0;
    const int64_t count = group_of(cable, (int64_t)vr - first_input(cable), &first);
    const int in_run = cable->now.phase == STEPPING && !derivative;
    for (int64_t n = first; n < first + count; n++)
        input_at(cable, n)->set |= SET_EVER | (in_run ? SET_IN_RUN : 0);
}

/* Which inputs of a line are connected. */
int64_t connected(const Cable *cable) {
    int64_t found = 0;
    for (unsigned n = 0; n < VR_INPUTS && cable->system == NULL; n++)
        if (input_at(cable, n)->set) found |= inputs_of(n);
    return found;
}

/* What drives: where the scene does, an input that is connected takes its place, unless the master
   has said, or the FMU was exported, to ignore them. */
int64_t driven(const Cable *cable) {
    if (!cable->now.use_scene_inputs) return ALL_SET;
    const int ignored = cable->now.scene_inputs_given || (cable->flags & FLAG_IGNORE);
    return ignored ? 0 : connected(cable);
}

/* Which inputs move the tow point. A master that cannot set it, and connects the position alone,
   means the position; of both, one that alone is connected moves it alone. */
int64_t vessel_input(const Cable *cable) {
    const int64_t set = connected(cable) & (VELOCITY_SET | POSITION_SET);
    if (cable->now.vessel_input == BY_BOTH && set == VELOCITY_SET) return BY_VELOCITY;
    if (cable->now.vessel_input == BY_BOTH && set == POSITION_SET) return BY_POSITION;
    const int alone = set == POSITION_SET && (input_at(cable, VR_POSITION)->set & SET_IN_RUN);
    return alone && !cable->now.vessel_input_given ? BY_POSITION : cable->now.vessel_input;
}

/* What an input reaches at the end of a step: as it was set; by the derivatives that the master has
   set; or as it went on in the last step from `before`. NULL: it did not drive then, and holds. */
double value_at_end(const Controls *now, const double *slope, double value, const double *before,
                    double dt) {
    if (now->has_slope)
        return value + dt * (slope[0] + dt * (slope[1] / 2.0 + dt * slope[2] / 6.0));
    if (now->input_timing == AT_END || before == NULL) return value;
    return value + dt / now->last_step * (value - *before);
}

/* The same of a position that goes on by a rate, which was `rate_before`. NULL: it is constant. */
double place_at_end(const Controls *now, const double *slope, double value, double rate,
                    const double *rate_before, double dt) {
    if (now->has_slope || now->input_timing == AT_END)
        return value_at_end(now, slope, value, NULL, dt);
    const double gain = rate_before != NULL ? (rate - *rate_before) / now->last_step : 0.0;
    return value + dt * (rate + 0.5 * dt * gain);
}

/* How far a velocity leads in a step by the derivatives that the master has set. */
double way_at_end(const double *slope, double value, double dt) {
    return dt * (value + dt * (slope[0] / 2.0 + dt * (slope[1] / 6.0 + dt * slope[2] / 24.0)));
}

/* Whether a velocity varies otherwise than linearly by them: then places say where it leads. */
int is_curved(const double *slope) { return slope[1] != 0.0 || slope[2] != 0.0; }

/* Which inputs of a line drove in the last step. */
static int64_t drove(const Controls *now) {
    const StepInputs *applied = &now->applied;
    return (applied->velocity_given != 0.0 ? VELOCITY_SET : 0) |
           (applied->position_given != 0.0 ? POSITION_SET : 0) |
           (applied->payout_given != 0.0 ? PAYOUT_SET : 0) |
           (applied->current_given != 0.0 ? CURRENT_SET : 0);
}

/* What an input was in the last step; NULL: it did not drive then. */
const double *before(const Input *input) { return input->driving & DROVE ? &input->before : NULL; }

/* What an input was in a step that was made, and whether it drove. */
void remember_input(Input *input, int drives) {
    input->before = input->value;
    input->driving = (input->driving & DROVE ? WENT_ON : 0) | (drives ? DROVE : 0);
}

static double at_end(Cable *cable, int n, double dt) {
    const Controls *now = &cable->now;
    const Input *x = input_at(cable, n);
    if (inputs_of((unsigned)n) == POSITION_SET) {
        const Input *v = x - VR_POSITION + VR_VELOCITY;
        if (vessel_input(cable) == BY_BOTH) return place_at_end(now, x->slope, x->value, v->value, before(v), dt);
        if (before(x) == NULL) { /* it goes on as fast as the tow point is */
            const double speed = summary(cable)->vessel_velocity[n - VR_POSITION];
            return place_at_end(now, x->slope, x->value, speed, NULL, dt);
        }
    }
    return value_at_end(now, x->slope, x->value, before(x), dt);
}

/* What is chosen by an enumeration; NULL: it is none. */
const int64_t *choice_of(Cable *cable, unsigned vr) {
    if (vr == VR_INPUT_TIMING) return &cable->now.input_timing;
    if (cable->system != NULL) return part_choice(cable, vr);
    return vr == VR_VESSEL_INPUT ? &cable->now.vessel_input : NULL;
}

void choose(Cable *cable, unsigned vr, int64_t value) {
    if (vr == VR_INPUT_TIMING) {
        cable->now.input_timing = value;
    } else if (cable->system != NULL) {
        choose_for_part(cable, vr, value);
    } else {
        cable->now.vessel_input_given |= value != cable->now.vessel_input;
        cable->now.vessel_input = value;
    }
}

/* Three derivatives of an input for the next step; NULL: it is none, or jumps. */
double *slope_of(Cable *cable, unsigned vr) {
    Input *input = input_of(cable, vr);
    return input == NULL || is_command(cable, input - input_at(cable, 0)) ? NULL : input->slope;
}

void clear_slopes(Cable *cable) {
    for (int64_t n = 0; n < cable->inputs; n++) memset(input_at(cable, n)->slope, 0, sizeof input_at(cable, n)->slope);
}

/* Whether the vessel has left the scene's schedule, by a start velocity of its own, and goes straight on
   until something drives it. */
static int goes_straight_on(const Cable *cable) {
    return !(driven(cable) & (VELOCITY_SET | POSITION_SET)) && velocity_changed(cable);
}

static void collect_inputs(Cable *cable, double dt, StepInputs *inputs) {
    memset(inputs, 0, sizeof *inputs);
    const int64_t by = vessel_input(cable), drives = driven(cable);
    if (drives & (VELOCITY_SET | POSITION_SET)) {
        inputs->velocity_given = by != BY_POSITION;
        inputs->position_given = by != BY_VELOCITY;
    }
    inputs->current_given = (drives & CURRENT_SET) != 0;
    inputs->payout_given = (drives & PAYOUT_SET) != 0;
    for (int i = 0; i < 3; i++) {
        if (inputs->velocity_given != 0.0) inputs->velocity[i] = at_end(cable, VR_VELOCITY + i, dt);
        if (inputs->position_given != 0.0) inputs->position[i] = at_end(cable, VR_POSITION + i, dt);
        if (inputs->current_given != 0.0) inputs->current[i] = at_end(cable, VR_CURRENT + i, dt);
    }
    int curved = 0;
    for (int i = 0; i < 3; i++) curved |= is_curved(input_at(cable, VR_VELOCITY + i)->slope);
    if (by == BY_VELOCITY && inputs->velocity_given != 0.0 && cable->now.has_slope && curved) {
        inputs->position_given = 1.0;
        for (int i = 0; i < 3; i++) {
            const Input *v = input_at(cable, VR_VELOCITY + i);
            inputs->position[i] = summary(cable)->vessel_position[i] + way_at_end(v->slope, v->value, dt);
        }
    }
    if (inputs->payout_given != 0.0) inputs->payout_rate = at_end(cable, VR_PAYOUT, dt);
    if (goes_straight_on(cable)) {
        inputs->velocity_given = 1.0;
        memcpy(inputs->velocity, cable->now.start + 3, sizeof inputs->velocity);
    }
}

/* How far a position that is reached after dt is from where the start goes on to. */
double distance_from(const double *start, const double *velocity, const double *reached, double dt) {
    double square = 0.0;
    for (int i = 0; i < 3; i++) {
        const double off = reached[i] - start[i] - velocity[i] * dt;
        square += off * off;
    }
    return sqrt(square);
}

/* Of the first step, by the inputs as they are set: NULL, or that it draws the tow point to another
   start than the cable's. */
const char *first_jump(Cable *cable, double dt) {
    if (cable->system != NULL) return first_jump_of_parts(cable, dt);
    StepInputs inputs;
    collect_inputs(cable, dt, &inputs);
    if (inputs.position_given == 0.0) return NULL;
    const double *start = cable->now.start;
    const double way = distance_from(start, start + 3, inputs.position, dt);
    if (!(way > JUMP_SPEED * dt)) return NULL;
    snprintf(cable->message, sizeof cable->message,
             "vessel.position draws the tow point by %g m in the first step, of %g s: the cable begins "
             "at (%g, %g, %g); %s",
             way, dt, start[0], start[1], start[2],
             cable->flags & (FLAG_MOVABLE | FLAG_LEVEL) ? "set vessel.start_position"
                                                        : "export the scene with another start");
    return cable->message;
}

int is_zero(const double *vector) { return vector[0] == 0.0 && vector[1] == 0.0 && vector[2] == 0.0; }

/* Whether a scene turns a winch at some time. */
int turns(const Cable *cable, int64_t winch) {
    const Winch *row = winch_of(cable->I, winch);
    const double *rates = cable->M + header(cable->I)->rates + RATE_WORDS * (int64_t)row->first_rate;
    for (int64_t n = 0; n < (int64_t)row->rates; n++)
        if (AS(Rate, rates + RATE_WORDS * n)->rate != 0.0) return 1;
    return 0;
}

/* The name of an input, by a number of its own, that takes the place of what the scene schedules and is 0,
   as it is from masters that hand out zeros for what is not connected. NULL: it does not, or is not. */
const char *zero_input(const Cable *cable, int64_t n) {
    const Controls *now = &cable->now;
    if (!now->use_scene_inputs || now->has_slope) return NULL;
    if (cable->system != NULL) return zero_part_input(cable, n);
    const int64_t drives = driven(cable);
    if (n == 0 && (drives & VELOCITY_SET) && vessel_input(cable) != BY_POSITION) {
        const int moves = header(cable->I)->piece_count > 2 || !is_zero(now->start + 3);
        const Input *v = input_at(cable, VR_VELOCITY);
        const double given[3] = {v[0].value, v[1].value, v[2].value};
        return moves && is_zero(given) ? "vessel.velocity" : NULL;
    }
    if (n == 1 && !is_direct(cable->I) && (drives & PAYOUT_SET))
        return input_at(cable, VR_PAYOUT)->value == 0.0 && turns(cable, 0) ? "payout.rate" : NULL;
    return NULL;
}

/* What derivatives and the next step want to know of one that was made. */
static void remember_step(Cable *cable, double dt, const StepInputs *inputs) {
    Controls *now = &cable->now;
    now->applied = *inputs;
    now->growth = now->last_step > 0.0 ? dt / now->last_step : 0.0;
    now->last_step = dt;
    now->last_mode = vessel_input(cable);
    now->last_driven = driven(cable);
    now->last_sloped = now->has_slope;
    for (unsigned n = 0; n < VR_INPUTS && cable->system == NULL; n++)
        remember_input(input_at(cable, n), (drove(now) & inputs_of(n)) != 0);
    for (int i = 0; i < 3 && cable->system == NULL && goes_straight_on(cable); i++)
        input_at(cable, VR_VELOCITY + i)->before = now->start[3 + i];
    now->has_slope = 0;
}

/* Arc length of a node from the vessel; in the words of CableModel._node_arcs. */
static double arc_of(const Cable *cable, int64_t node) {
    const Edge *edge = edge_of(cable->I, node);
    if (node <= 0) return 0.0;
    if (node == 1 && (header(cable->I)->rigid == 0 || header(cable->I)->nodes < 3)) return edge->length;
    if (node == 1) return edge_of(cable->I, 2)->start + winch_of(cable->I, 0)->paid;
    return edge->start + edge->length + winch_of(cable->I, 0)->paid;
}

void look_up(const Failure *failures, int64_t status, const char **problem, const char **advice) {
    for (; failures->problem != NULL; failures++)
        if (failures->status == status) {
            *problem = failures->problem;
            *advice = failures->advice;
        }
}

static void explain(const Cable *cable, int64_t status, char *message, size_t size) {
    const char *problem = "the step cannot be made", *advice = "ask for another step";
    static const Failure failures[] = {FAILURES};
    look_up(failures, status, &problem, &advice);
    if (cable->system != NULL) {
        explain_in_system(cable, problem, advice, message, size);
        return;
    }
    if (is_direct(cable->I)) {
        const double arc = direct_failure(cable, status, &problem, &advice);
        snprintf(message, size, "at t = %g s, %g m along the cable: %s; %s", cable_time(cable), arc,
                 problem, advice);
        return;
    }
    const int64_t last = header(cable->I)->nodes - 1;
    const int64_t failed = cable->I[header(cable->I)->failed];
    const int64_t node = failed < last ? failed : last;
    const double arc = arc_of(cable, node);
    snprintf(message, size, "at t = %g s, %g m along the cable: %s; %s", cable_time(cable), arc,
             problem, advice);
}

/* A finer run that could not make a step stays behind for good: there is no estimate then. */
int is_beside(const Cable *cable) {
    return cable->finer != NULL && scalars(cable->finer->M)->time == scalars(cable->M)->time;
}

/* To the instance's own time t_end; on failure the message says why and nothing has changed. */
int64_t step_cable(Cable *cable, double t_end, double dt, char *message, size_t size) {
    StepInputs inputs = {0};
    double *words = (double *)&inputs;
    if (cable->system == NULL) collect_inputs(cable, dt, &inputs);
    const int beside = is_beside(cable);
    if (beside && cable->system != NULL) { /* what drives it, before the last step is forgotten */
        cable->finer->now = cable->now;
        memcpy(cable->finer->values, cable->values, 8 * (size_t)cable->value_words);
    }
    const int64_t status =
        cable->system != NULL ? step_system(cable, t_end, dt)
        : is_direct(cable->I)
            ? direct_step(cable, t_end, words)
            : step_block(cable, t_end, words);
    if (status != OK) {
        explain(cable, status, message, size);
        return status;
    }
    if (beside && cable->system != NULL)
        step_system(cable->finer, t_end, dt);
    else if (beside)
        step_block(cable->finer, t_end, words);
    remember_step(cable, dt, &inputs);
    outputs_changed(cable);
    return OK;
}

const Summary *summary(Cable *cable) {
    Summary *found = &cable->summary;
    if (!cable->summary_current) {
        double *words = (double *)found;
        if (is_direct(cable->I))
            cablemodel_direct_summary(cable->I, cable->block_words, words, SUMMARY_WORDS);
        else
            cablemodel_summary(cable->I, cable->block_words, words, SUMMARY_WORDS);
        if (cable->flags & FLAG_PINNED)
            for (int i = 3; i < 6; i++) found->wrench[i] = 0.0;
        found->slack_since += cable->now.start_time;
        cable->summary_current = 1;
    }
    return found;
}

/* Whether the last step was asked to pay out, and the drum is empty. */
int is_idle(Cable *cable) {
    const StepInputs *applied = &cable->now.applied;
    return applied->payout_given != 0.0 && applied->payout_rate > 0.0 &&
           (winch_of(cable->I, 0)->at_limit > 0.0 || !(summary(cable)->drum_length > 0.0));
}

/* Whether it was asked to reel in, and the line is as short as it gets. */
int is_shortest(const Cable *cable) {
    const StepInputs *applied = &cable->now.applied;
    return applied->payout_given != 0.0 && applied->payout_rate < 0.0 && winch_of(cable->I, 0)->at_limit < 0.0;
}

/* States at the stations, then at the bodies, in rows of STATION_WORDS. */
static const double *rows(Cable *cable) {
    if (!cable->stations_current) {
        const double length = summary(cable)->line_length;
        const int64_t n = cable->stations, last = n - 1;
        for (int64_t k = 0; k < n; k++) cable->arcs[k] = length * (double)k / (double)last;
        cable->stations_current = 1;
        if (is_direct(cable->I)) {
            direct_rows(cable);
            return cable->rows;
        }
        for (int64_t j = 0; j < cable->bodies; j++) {
            /* A body on the drum (node -1) is at the tow point. */
            const int64_t node = (int64_t)cable->M[header(cable->I)->bodies + j * BODY_WORDS + WORD(Body, node)];
            const double arc = arc_of(cable, node);
            cable->arcs[n + j] = arc < length ? arc : length;
        }
        cablemodel_sample(cable->I, cable->block_words, cable->arcs, n + cable->bodies,
                          cable->rows, STATION_WORDS * (n + cable->bodies));
        if (header(cable->I)->rigid > 0) /* Bodies of finite length do not move with the cable. */
            cablemodel_bodies(cable->I, cable->block_words, cable->rows + STATION_WORDS * n,
                              STATION_WORDS * cable->bodies);
    }
    return cable->rows;
}

/* What positions [m] and the top tension [N] may be wrong by: errors of
   cablemodel/solvers/estimating.py. */
static const double *errors(Cable *cable) {
    if (cable->errors_current) return cable->errors;
    cable->errors_current = 1;
    cable->errors[0] = cable->errors[1] = NAN;
    if (!is_beside(cable)) return cable->errors;
    Cable *finer = cable->finer;
    const Summary *numbers = summary(cable), *others = summary(finer);
    const double length = fmin(numbers->line_length, others->line_length);
    enum { WORDS = STATION_WORDS * ERROR_PLACES };
    Station shapes[2][ERROR_PLACES];
    double arcs[ERROR_PLACES], largest = 0.0;
    for (int k = 0; k < ERROR_PLACES; k++)
        arcs[k] = (0.5 - 0.5 * cos(PI * k / (ERROR_PLACES - 1))) * length;
    cablemodel_sample(cable->I, cable->block_words, arcs, ERROR_PLACES, (double *)shapes[0], WORDS);
    cablemodel_sample(finer->I, finer->block_words, arcs, ERROR_PLACES, (double *)shapes[1], WORDS);
    for (int k = 0; k < ERROR_PLACES && largest == largest; k++) {
        const double *one = shapes[0][k].position, *other = shapes[1][k].position;
        double square = 0.0;
        for (int i = 0; i < 3; i++) square += (one[i] - other[i]) * (one[i] - other[i]);
        if (!(sqrt(square) <= largest)) largest = sqrt(square); /* NaN, too */
    }
    cable->errors[0] = ERROR_FACTOR * largest;
    cable->errors[1] = ERROR_FACTOR * fabs(numbers->top_tension - others->top_tension);
    return cable->errors;
}

static int is_start(const Cable *cable, unsigned vr) {
    return vr >= VR_START && vr < VR_START + VR_STARTS && !is_direct(initial_image(cable));
}

/* Of an input or a parameter, for messages; NULL of what else there is, or is not. */
const char *name_of(const Cable *cable, unsigned vr) {
    static const char *const inputs[VR_INPUTS] = INPUT_NAMES, *const starts[] = START_NAMES;
    if (vr == VR_INPUT_TIMING) return "input.timing";
    if (is_parameter(cable, vr)) return cable->parameters[vr - VR_PARAMETER].name;
    if (cable->system != NULL) return name_in_system(cable, vr);
    if (vr == VR_VESSEL_INPUT) return "vessel.input";
    if (vr < VR_INPUTS) return inputs[vr];
    return is_start(cable, vr) ? starts[vr - VR_START] : NULL;
}

const char *read_value(Cable *cable, unsigned vr, double *value) {
    if (is_parameter(cable, vr)) {
        *value = cable->values[vr - VR_PARAMETER];
        return NULL;
    }
    const Input *input = input_of(cable, vr);
    if (input != NULL) {
        *value = input->value;
        return NULL;
    }
    if (cable->system != NULL) return read_part(cable, vr, value);
    if (is_start(cable, vr)) {
        *value = cable->now.start[vr - VR_START];
        return NULL;
    }
    if (vr == VR_ZERO) {
        *value = 0.0;
        return NULL;
    }
    const char *problem = settle_cable(cable);
    if (problem != NULL) return problem;
    if (vr >= VR_SUMMARY && vr < VR_SUMMARY + SUMMARY_WORDS)
        *value = ((const double *)summary(cable))[vr - VR_SUMMARY];
    else if (vr >= VR_STATION && vr < VR_STATION + STATION_WORDS * (unsigned)cable->stations)
        *value = rows(cable)[vr - VR_STATION];
    else if (vr >= VR_BODY && vr < VR_BODY + STATION_WORDS * (unsigned)cable->bodies)
        *value = rows(cable)[STATION_WORDS * cable->stations + (vr - VR_BODY)];
    else if (cable->finer != NULL && vr >= VR_ERROR && vr < VR_ERROR + 2)
        *value = errors(cable)[vr - VR_ERROR];
    else
        return "unknown value reference";
    return NULL;
}

static void tune_edge(double *edge, const Parameter *p, double value) {
    if (AS(Edge, edge)->type != (double)p->index) return;
    const double before = edge[p->word];
    edge[p->word] = p->factor * value;
    if (p->word == WORD(Edge, added_mass)) AS(Edge, edge)->mass += edge[p->word] - before; /* in `mass` too */
}

static void tune_free_body(Cable *cable, const Parameter *p, double value) {
    double *row = cable->M + header(cable->I)->free_bodies + p->index * FREE_WORDS;
    const double weight = scalars(cable->M)->water_density * scalars(cable->M)->gravity;
    row[p->word] = p->factor * value;
    if (p->word != WORD(FreeBody, buoyancy)) return;
    AS(FreeBody, row)->buoyancy += AS(FreeBody, row)->weight;
    if (!(weight > 0.0)) return;
    /* A ball that displaces as much: fill_bodies of cablemodel/systems/tables.py. */
    const double volume = fmax(0.0, AS(FreeBody, row)->buoyancy) / weight;
    AS(FreeBody, row)->radius = fmax(SMALLEST_RADIUS, pow(0.75 * volume / PI, 1.0 / 3.0));
}

/* Write a coefficient into the block. */
static void tune(Cable *cable, const Parameter *p, double value) {
    double *M = cable->M;
    const int64_t *I = cable->I;
    if (is_direct(I)) {
        M[direct_word(I, p)] = p->factor * value;
    } else if (p->kind == OF_FREE) {
        tune_free_body(cable, p, value);
    } else if (p->kind == OF_BODY) {
        M[header(I)->bodies + p->index * BODY_WORDS + p->word] = p->factor * value;
    } else if (p->kind == OF_CABLES) {
        /* Elements that are out, and the rows from which elements are made as cable is paid out. */
        for (int64_t node = 1; node < header(I)->nodes; node++)
            if (I[header(I)->joint + node] == 0) tune_edge(M + header(I)->edges + node * EDGE_WORDS, p, value);
        for (int64_t n = 0; n < header(I)->cable_count; n++)
            tune_edge(M + header(I)->cables + n * CABLE_WORDS + WORD(CableRow, edge), p, value);
    }
    if (!is_direct(I)) header(cable->I)->asleep = header(cable->I)->has_history = 0; /* what rests may not now */
    header(cable->I)->factored = 0;
}

/* The coefficients that are set, in a block that has the scene's. */
void tune_all(Cable *cable) {
    for (int64_t n = 0; n < cable->parameter_count; n++)
        if (cable->values[n] != cable->parameters[n].start)
            tune(cable, &cable->parameters[n], cable->values[n]);
}

/* The exported state with those. */
void restore_exported(Cable *cable) {
    take_exported(cable);
    tune_all(cable);
}

static const char *check_range(Cable *cable, double value, double minimum, double maximum) {
    if (value >= minimum && value <= maximum) return NULL;
    snprintf(cable->message, sizeof cable->message,
             "the value is out of range (%g to %g are allowed)", minimum, maximum);
    return cable->message;
}

static const char *check_motion(Cable *cable, int is_position, double value) {
    if (!(fabs(value) < 1e100)) return "the value is not finite";
    const double most = is_position ? FURTHEST : FASTEST;
    return check_range(cable, value, -most, most);
}

static const char *check_start(Cable *cable, unsigned vr, double value) {
    if (cable->now.phase == STEPPING)
        return "a start is fixed: set it before the end of the initialization";
    const double *scene = file_header(cable->file)->inputs;
    const int is_position = vr < VR_START_VELOCITY;
    const double own =
        is_position ? scene[VR_POSITION + vr - VR_START] : scene[vr - VR_START_VELOCITY];
    const int along = (cable->flags & FLAG_LEVEL) && vr < VR_START + 2;
    if (!(cable->flags & FLAG_MOVABLE) && !along && value != own)
        return "this line's start is that of its given shape or floor: export the scene with "
               "another";
    return check_motion(cable, is_position, value);
}

static const char *check_parameter(Cable *cable, const Parameter *p, double value) {
    if (p->kind >= OF_LINE && cable->now.phase == STEPPING)
        return "a length is fixed: set it before the end of the initialization";
    if (value >= p->minimum && value <= p->maximum) return NULL;
    if (p->minimum == p->maximum)
        return cable->system != NULL
                   ? "this length is the scene's: a line branches off beyond, or friction holds bodies or what "
                     "was laid: export the scene with another"
                   : "this line's lengths are those of its given shape or floor: export the scene "
                     "with others";
    return check_range(cable, value, p->minimum, p->maximum);
}

const char *check_value(Cable *cable, unsigned vr, double value) {
    if (is_parameter(cable, vr)) return check_parameter(cable, &cable->parameters[vr - VR_PARAMETER], value);
    if (cable->system != NULL) {
        double minimum = 0.0, maximum = 0.0;
        const char *problem = check_part_value(cable, vr, value, &minimum, &maximum);
        return problem == NULL ? check_range(cable, value, minimum, maximum) : problem;
    }
    if (vr < VR_INPUTS) return check_motion(cable, inputs_of(vr) == POSITION_SET, value);
    if (is_start(cable, vr)) return check_start(cable, vr, value);
    double ignored;
    return read_value(cable, vr, &ignored) == NULL ? "an output cannot be set"
                                                   : "unknown value reference";
}

/* Of a value that check_value has passed. */
void write_value(Cable *cable, unsigned vr, double value) {
    Input *input = input_of(cable, vr);
    if (input != NULL) {
        if (cable->now.phase == STEPPING || value != input->value) mark_set(cable, vr, 0);
        input->value = value;
        return;
    }
    if (cable->system != NULL && !is_parameter(cable, vr)) {
        cable->now.unsettled |= set_system_start(cable, vr, value);
        return;
    }
    if (is_start(cable, vr)) {
        if (value == cable->now.start[vr - VR_START]) return;
        cable->now.start[vr - VR_START] = value;
        cable->now.unsettled = 1;
        /* Until it is set, an input is what it is at the start. */
        input = input_at(cable, vr < VR_START_VELOCITY ? vr - VR_START + VR_POSITION : vr - VR_START_VELOCITY);
        if (!input->set) input->value = value;
        return;
    }
    if (value == cable->values[vr - VR_PARAMETER]) return;
    cable->values[vr - VR_PARAMETER] = value;
    if (cable->now.phase == STEPPING) {
        tune(cable, &cable->parameters[vr - VR_PARAMETER], value);
        if (cable->finer != NULL) tune(cable->finer, &cable->parameters[vr - VR_PARAMETER], value);
        outputs_changed(cable);
    } else {
        cable->now.unsettled = 1;
    }
}
