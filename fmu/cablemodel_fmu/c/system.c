/* A system behind the FMI functions: what drives its bodies, vessels, winches and cuts.

   A model file has a section of it: how many lines there are; a row of each input, of what moves each
   vessel, of each number of a vessel's start, of each line and of each body; and of each row of the
   cable table, 2 times its line, and 1 where the tree goes backward along it
   (cablemodel/systems/built.py). Inputs are in the order of the block's tables: 12 words of each
   vessel, 6 of each body, 1 of each foil and of each cut. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "system.h"

/* -- what a file must be ---------------------------------------------------------------------------- */

static int pieces_fit(const int64_t *I, const double *row) {
    const double last = (double)header(I)->frame_piece_count;
    return whole(row[0], 0, header(I)->frame_piece_count) && whole(row[1], 0, header(I)->frame_piece_count) &&
           row[0] + row[1] <= last;
}

/* The parts of a block of a system: what its tables name is there. */
const char *check_parts(const int64_t *I) {
    const double *M = (const double *)I;
    const int64_t last = header(I)->nodes - 1;
    const int64_t responses = 1 + RAO_WORDS * header(I)->wave_count; /* of each heading */
    if (header(I)->dimension != 3 || header(I)->sleep != 0)
        return "a counter in the model is out of range";
    for (int64_t n = 0; n < header(I)->constraint_count; n++) {
        const double *row = M + header(I)->constraints + n * CONSTRAINT_WORDS;
        if (AS(Constraint, row)->kind == (double)HELD_BY_FRAME && !whole(AS(Constraint, row)->frame, 0, header(I)->frame_count - 1))
            return "a constraint is at no vessel";
    }
    for (int64_t n = 0; n < header(I)->frame_count; n++) {
        const double *row = M + header(I)->frames + n * FRAME_WORDS;
        if (!pieces_fit(I, row + WORD(Frame, first)) || !pieces_fit(I, row + WORD(Frame, turn_first)) ||
            !whole(AS(Frame, row)->raos, 0, header(I)->rao_words) ||
            !whole(AS(Frame, row)->headings, AS(Frame, row)->raos != 0.0, header(I)->rao_words) ||
            AS(Frame, row)->raos - 1.0 + AS(Frame, row)->headings * (double)responses > (double)header(I)->rao_words)
            return "a vessel's motion is out of range";
    }
    for (int64_t n = 0; n < header(I)->free_count; n++) {
        const double *row = M + header(I)->free_bodies + n * FREE_WORDS;
        if (!whole(AS(FreeBody, row)->node, 0, last) || !whole(AS(FreeBody, row)->first_foil, 0, header(I)->foil_count) ||
            !whole(AS(FreeBody, row)->foil_count, 0, header(I)->foil_count) ||
            !whole(AS(FreeBody, row)->hull, HULL_NONE, HULL_CYLINDER) ||
            AS(FreeBody, row)->first_foil + AS(FreeBody, row)->foil_count > (double)header(I)->foil_count)
            return "a free body is out of range";
    }
    for (int64_t n = 0; n < header(I)->arm_count; n++) {
        const double *row = M + header(I)->arms + n * ARM_WORDS;
        if (!whole(AS(Arm, row)->node, 0, last) || !whole(AS(Arm, row)->body, -1, header(I)->free_count - 1))
            return "a body's point is out of range";
    }
    for (int64_t n = 0; n < header(I)->closure_count; n++) {
        const double *row = M + header(I)->closures + n * CLOSURE_WORDS;
        if (!whole(AS(Closure, row)->node, -1, last) || !whole(AS(Closure, row)->other, -1, last) ||
            !whole(AS(Closure, row)->body, -1, header(I)->free_count - 1) ||
            (AS(Closure, row)->body < 0.0 && (AS(Closure, row)->other < 0.0 || AS(Closure, row)->clamp != 0.0)))
            return "a cycle is closed at no node";
    }
    for (int64_t n = 0; n < header(I)->foil_count; n++) {
        const double *row = M + header(I)->foils + n * FOIL_WORDS;
        if (!whole(AS(Foil, row)->rows, 2, header(I)->foil_words / FOIL_ROW_WORDS) ||
            !whole(AS(Foil, row)->table, 0, header(I)->foil_words - FOIL_ROW_WORDS * (int64_t)AS(Foil, row)->rows))
            return "a foil is out of range";
    }
    for (int64_t n = 0; n < header(I)->foot_count; n++)
        if (!whole(M[header(I)->feet + n * FOOT_WORDS + WORD(Foot, body)], 0, header(I)->free_count - 1))
            return "a body's foot is out of range";
    for (int64_t n = 0; n < header(I)->cut_count; n++) {
        const double *row = M + header(I)->cuts + n * CUT_WORDS;
        if (!whole(AS(Cut, row)->segment, 0, header(I)->cable_count - 1) ||
            !whole(AS(Cut, row)->side, CUT_WITHIN, CUT_END))
            return "a cut is out of range";
    }
    return NULL;
}


/* The first shape, and the image of the block along it. */
const char *check_first_shape(const Cable *cable) {
    const double *words = first_shape(cable);
    const int64_t *own = initial_image(cable), *I = first_image(cable);
    const int64_t count = file_header(cable->file)->shape_words;
    const char *const wrong = "the first shape is out of range";
    const FirstShape *shape = AS(FirstShape, words);
    if (count < SHAPE_WORDS || !whole(shape->lines, header(own)->line_count, header(own)->line_count) ||
        !whole(shape->bodies, header(own)->free_count, header(own)->free_count) ||
        !whole(shape->items, 1, count) || !whole(shape->most, 2, count))
        return wrong;
    const int64_t lines = header(own)->line_count, bodies = header(own)->free_count;
    const int64_t items = (int64_t)shape->items, most = (int64_t)shape->most;
    if (SHAPE_WORDS + STRING_LINE_WORDS * lines + STRING_ITEM_WORDS * items + STRING_BODY_WORDS * bodies +
            2 * STRING_END_WORDS * lines + 7 * most != count)
        return wrong;
    for (int64_t n = 0; n < count; n++)
        if (!(fabs(words[n]) < 1e100)) return wrong;
    int64_t masses = bodies + lines * (STRING_PARTS + 1), cables = 0, lengths = 0;
    for (int64_t n = 0; n < items; n++) {
        const StringItem *item = string_items(words) + n;
        if (!whole(item->line, n == 0 ? 0 : (int64_t)item[-1].line, lines - 1) ||
            !(item->body != 0.0 || item->length > 0.0))
            return wrong;
        cables += item->body == 0.0;
    }
    for (int64_t line = 0; line < lines; line++) { /* each has a cable */
        int found = 0;
        for (int64_t n = 0; n < items; n++)
            found |= string_items(words)[n].line == (double)line && string_items(words)[n].body == 0.0;
        if (!found) return wrong;
    }
    for (int64_t n = 0; n < cable->parameter_count; n++) lengths += cable->parameters[n].kind == OF_LINE;
    for (int64_t n = 0; n < 2 * lines; n++) {
        const StringEnd *end = string_ends(words) + n;
        const int64_t others[] = {0, header(own)->constraint_count, bodies, lines};
        if (!whole(end->kind, STRING_FREE, STRING_ON_LINE) ||
            (end->kind != STRING_FREE && !whole(end->other, 0, others[(int)end->kind] - 1)))
            return wrong;
        masses += end->kind == STRING_ON_LINE;
    }
    if (masses > most || cables != lengths || !same_sizes(I, own) || !is_system(I)) return wrong;
    return check_block(I, file_header(cable->file)->first_words, header(I)->byte_count / 8);
}

static const char *check_section(const System *s, int64_t segments) {
    const int64_t named = named_rows(s);
    for (int64_t n = 0; n < named; n++) {
        const PartRow *row = s->rows + n;
        if (row->name[sizeof row->name - 1] != 0) return "a part's name is too long";
        if (!(row->minimum <= row->start && row->start <= row->maximum) ||
            !(fabs(row->minimum) < 1e100) || !(fabs(row->maximum) < 1e100))
            return "a start value is out of range";
    }
    for (int64_t n = s->inputs; n < s->inputs + s->vessels; n++)
        if (!whole(s->rows[n].start, BY_VELOCITY, BY_BOTH)) return "a start value is out of range";
    for (int64_t line = 0; line < s->lines; line++) {
        int found = 0;
        for (int64_t n = 0; n < segments; n++) found |= s->segments[n] >> 1 == line;
        if (!found) return "a line has no cable";
    }
    for (int64_t n = 0; n < segments; n++)
        if (!within(s->segments[n], 0, 2 * s->lines - 1)) return "a cable is of no line";
    return NULL;
}

/* Of the section in the file, for the image of a block that has passed check_block. */
const char *load_system(Cable *cable, const int64_t *section, int64_t words, const int64_t *I) {
    System *s = cable->system = calloc(1, sizeof *s);
    if (s == NULL) return "out of memory";
    s->lines = section[0];
    s->vessels = header(I)->frame_count;
    s->bodies = header(I)->free_count;
    s->foils = header(I)->foil_count;
    s->winches = header(I)->winch_count;
    s->cuts = header(I)->cut_count;
    cable->inputs = s->inputs = OF_VESSEL * s->vessels + OF_FREE_BODY * s->bodies + s->foils + s->winches + s->cuts;
    s->rows = (const PartRow *)(section + 1);
    const int64_t named = named_rows(s);
    if (!within(s->lines, 1, header(I)->cable_count) || words != 1 + ROW_WORDS * named + header(I)->cable_count)
        return "the sizes do not agree";
    s->segments = section + 1 + ROW_WORDS * named;
    const char *problem = check_section(s, header(I)->cable_count);
    if (problem != NULL) return problem;
    s->applied = s->vessels * FRAME_INPUTS + s->bodies * OF_FREE_BODY + s->foils + 2 * s->winches + s->cuts;
    cable->value_words = cable->parameter_count + WORDS_OF_INPUT * s->inputs +
                         s->vessels * (int64_t)(sizeof(Choice) / 8) + START_WORDS * s->vessels + s->applied;
    s->outputs = s->lines * (LINE_OUTPUTS + STATION_OUTPUTS * cable->stations) +
                 s->bodies * BODY_OUTPUTS + s->vessels * VESSEL_OUTPUTS +
                 s->winches * WINCH_OUTPUTS + s->cuts;
    if (header(I)->floor_kind != 0) s->outputs += s->lines * FLOOR_OUTPUTS;
    if (cable->flags & FLAG_ESTIMATE) s->outputs += s->lines * LINE_ERRORS + s->bodies * BODY_ERRORS;
    const size_t samples = (size_t)(s->lines * (2 + cable->stations));
    s->told = calloc((size_t)s->inputs + 1, 1);
    s->values = calloc((size_t)s->outputs, sizeof(double));
    s->counts = calloc((size_t)s->lines, sizeof(int64_t));
    s->nodes = calloc(samples, sizeof(double));
    s->fractions = calloc(samples, sizeof(double));
    s->samples = calloc(samples, sizeof(Station));
    s->parts = calloc((size_t)(s->bodies + s->vessels) + 1, sizeof(PartMotion));
    s->motion = calloc((size_t)(s->vessels * FRAME_INPUTS) + 1, sizeof(double));
    s->own = calloc((size_t)(s->vessels * FRAME_INPUTS) + 1, sizeof(double));
    s->forces = calloc((size_t)(s->bodies * OF_FREE_BODY) + 1, sizeof(double));
    s->angles = calloc((size_t)s->foils + 1, sizeof(double));
    s->rates = calloc((size_t)(2 * s->winches) + 1, sizeof(double));
    s->orders = calloc((size_t)s->cuts + 1, sizeof(double));
    s->kept = calloc((size_t)(header(I)->position - header(I)->frames) + 1, sizeof(double));
    cable->wrenches = calloc((size_t)(3 * WRENCH_WORDS * s->vessels) + 1, sizeof(double));
    if (cable->wrenches == NULL || s->told == NULL || s->values == NULL || s->counts == NULL ||
        s->nodes == NULL || s->fractions == NULL || s->samples == NULL || s->parts == NULL ||
        s->motion == NULL || s->forces == NULL || s->angles == NULL || s->rates == NULL ||
        s->orders == NULL || s->own == NULL || s->kept == NULL ||
        !reserve_elements(cable, header(I)->capacity))
        return "out of memory";
    return NULL;
}

/* Memory for what is read of so many nodes' elements; 0: there is none. */
int reserve_elements(Cable *cable, int64_t capacity) {
    System *s = cable->system;
    const size_t elements = (size_t)capacity;
    Element *own = realloc(s->elements, elements * sizeof(Element));
    if (own != NULL) s->elements = own;
    double *ranges = realloc(s->ranges, 3 * elements * sizeof(double));
    if (ranges != NULL) s->ranges = ranges;
    return own != NULL && ranges != NULL;
}

void free_system(System *s) {
    if (s == NULL) return;
    void *const all[] = {s->told, s->values, s->elements, s->counts, s->nodes, s->fractions,
                         s->samples, s->parts, s->motion, s->forces, s->angles, s->rates,
                         s->orders, s->kept, s->own, s->ranges};
    for (size_t n = 0; n < sizeof all / sizeof all[0]; n++) free(all[n]);
    free(s);
}

/* -- inputs -------------------------------------------------------------------------------------- */

static Choice *choices_in(const Cable *cable, const void *values) {
    return (Choice *)(inputs_in(cable, values) + cable->inputs);
}

static VesselStart *starts_in(const Cable *cable, const void *values) {
    return (VesselStart *)(choices_in(cable, values) + cable->system->vessels);
}

/* What the kernels were given in the last step: FRAME_INPUTS words of each vessel, force and torque on
   each body, deflections (NaN: not given), of each winch whether its rate is given, and that, cuts
   that were ordered. cablemodel_fmu/recording.py reads it. */
static double *applied_in(const Cable *cable, const void *values) {
    return (double *)(starts_in(cable, values) + cable->system->vessels);
}

/* Whether an input orders something, and does not vary. */
int is_command(const Cable *cable, int64_t n) {
    return cable->system != NULL && n >= cable->system->inputs - cable->system->cuts;
}

static Choice *choice(const Cable *cable, unsigned vr) {
    const int64_t n = (int64_t)vr - VR_SYSTEM_CHOICE;
    if (!within(n, 0, cable->system->vessels - 1)) return NULL;
    return choices_in(cable, cable->values) + n;
}

int64_t *part_choice(const Cable *cable, unsigned vr) {
    Choice *found = choice(cable, vr);
    return found == NULL ? NULL : &found->by;
}

void choose_for_part(Cable *cable, unsigned vr, int64_t value) {
    Choice *found = choice(cable, vr);
    found->given |= value != found->by;
    found->by = value;
}

/* -- starts of vessels --------------------------------------------------------------------------- */

VesselStart *vessel_starts(const Cable *cable) { return starts_in(cable, cable->values); }

/* One number of them, by its value reference; NULL: it is none. */
static double *start_number(const Cable *cable, unsigned vr) {
    const int64_t n = (int64_t)vr - VR_SYSTEM_START;
    if (!within(n, 0, START_WORDS * cable->system->vessels - 1)) return NULL;
    return (double *)vessel_starts(cable) + n;
}

VesselStart scene_start(const Cable *cable, int64_t vessel) {
    VesselStart found;
    const PartRow *rows = cable->system->rows + first_start(cable->system) + START_WORDS * vessel;
    for (int64_t n = 0; n < START_WORDS; n++) ((double *)&found)[n] = rows[n].start;
    return found;
}

/* Whether a vessel begins at another velocity than the scene's: then it leaves the scene's schedule,
   and goes straight on until something drives it. */
int velocity_set(const Cable *cable, int64_t vessel) {
    const VesselStart scene = scene_start(cable, vessel);
    return differs(vessel_starts(cable)[vessel].velocity, scene.velocity);
}

void name_vessel(const Cable *cable, int64_t vessel, char *name, size_t size) {
    const char *variable = cable->system->rows[cable->system->inputs + vessel].name; /* NAME.input */
    size_t length = strlen(variable);
    while (length > 0 && variable[length] != '.') length--;
    snprintf(name, size, "%.*s", (int)length, variable);
}

/* The first angle of a start that was set to more than a turn, in words; NULL: there is none. */
const char *more_than_a_turn(Cable *cable) {
    const double turn = 2.0 * PI;
    const PartRow *rows = cable->system->rows + first_start(cable->system);
    for (int64_t n = 0; n < cable->system->vessels; n++)
        for (int i = 0; i < 3; i++) {
            const double angle = vessel_starts(cable)[n].attitude[i];
            const PartRow *row = rows + START_WORDS * n + (START_WORDS - 3) + i;
            if (angle == row->start || !(fabs(angle) > turn)) continue;
            snprintf(cable->message, sizeof cable->message,
                     "%s is %g rad, more than a turn: was it meant in degrees?", row->name, angle);
            return cable->message;
        }
    return NULL;
}

/* Of a value that is allowed; whether it is another one than before. Until an input of the vessel is set,
   it is what it is at the start. */
int set_system_start(Cable *cable, unsigned vr, double value) {
    static const int64_t groups[] = {AT_POSITION, AT_VELOCITY, AT_ATTITUDE};
    double *number = start_number(cable, vr);
    const int64_t n = (int64_t)vr - VR_SYSTEM_START, of_vessel = n % START_WORDS;
    if (*number == value) return 0;
    *number = value;
    const int64_t place = OF_VESSEL * (n / START_WORDS) + groups[of_vessel / 3] + of_vessel % 3;
    Input *input = input_at(cable, place);
    if (!input->set) input->value = value;
    const int64_t first_rate = OF_VESSEL * (n / START_WORDS) + AT_RATE;
    for (int64_t rate = first_rate; rate < first_rate + 3; rate++) {
        input = input_at(cable, rate);
        if (!input->set) input->value = velocity_set(cable, n / START_WORDS) ? 0.0 : cable->system->rows[rate].start;
    }
    return 1;
}

void restart_system(Cable *cable) {
    System *s = cable->system;
    memset(s->told, 0, (size_t)s->inputs);
    for (int64_t n = 0; n < s->inputs; n++) input_at(cable, n)->value = s->rows[n].start;
    for (int64_t n = 0; n < s->vessels; n++)
        choices_in(cable, cable->values)[n].by = (int64_t)s->rows[s->inputs + n].start;
    for (int64_t n = 0; n < s->vessels; n++) starts_in(cable, cable->values)[n] = scene_start(cable, n);
    s->current = 0;
}

/* Of a state that comes from elsewhere. */
const char *check_part_inputs(const Cable *cable, void *values) {
    const System *s = cable->system;
    for (int64_t n = 0; n < s->inputs; n++) {
        const Input *input = inputs_in(cable, values) + n;
        const PartRow *row = s->rows + n;
        if (!(input->value >= row->minimum && input->value <= row->maximum)) return "an input is out of range";
    }
    const Choice *choices = choices_in(cable, values);
    const double *starts = (const double *)starts_in(cable, values), *applied = applied_in(cable, values);
    for (int64_t n = 0; n < START_WORDS * s->vessels; n++) {
        const PartRow *row = s->rows + first_start(s) + n;
        if (!(starts[n] >= row->minimum && starts[n] <= row->maximum)) return "a start is out of range";
    }
    for (int64_t n = 0; n < s->vessels; n++)
        if (!within(choices[n].by, BY_VELOCITY, BY_BOTH) || !within(choices[n].given, 0, 1) ||
            !whole((AS(const FrameInput, applied) + n)->given, 0, GIVEN_ALL))
            return "a choice is out of range";
    return NULL;
}

/* Of an input, of what moves a vessel, or of its start; NULL of what else there is, or is not. */
const char *name_in_system(const Cable *cable, unsigned vr) {
    const System *s = cable->system;
    if (start_number(cable, vr) != NULL) return s->rows[first_start(s) + (vr - VR_SYSTEM_START)].name;
    if (input_of(cable, vr) != NULL) return s->rows[vr - VR_SYSTEM_INPUT].name;
    return choice(cable, vr) != NULL ? s->rows[s->inputs + (vr - VR_SYSTEM_CHOICE)].name : NULL;
}

const char *check_part_value(const Cable *cable, unsigned vr, double value, double *minimum,
                             double *maximum) {
    const PartRow *row = cable->system->rows;
    if (start_number(cable, vr) != NULL) {
        row += first_start(cable->system) + (vr - VR_SYSTEM_START);
        if (cable->now.phase == STEPPING)
            return "a start is fixed: set it before the end of the initialization";
        if (!(cable->flags & FLAG_MOVABLE) && value != row->start)
            return "friction holds bodies, or what was laid, at this start: export the scene with another";
    } else if (input_of(cable, vr) == NULL) {
        const int known = vr >= VR_SYSTEM_OUTPUT && vr - VR_SYSTEM_OUTPUT < cable->system->outputs;
        return known ? "an output cannot be set" : "unknown value reference";
    }
    if (input_of(cable, vr) != NULL) row += vr - VR_SYSTEM_INPUT;
    if (!(fabs(value) < 1e100)) return "the value is not finite";
    *minimum = row->minimum;
    *maximum = row->maximum;
    return NULL;
}

/* As group_of: a vessel's and a body's, by threes. */
int64_t group_in_system(const System *s, int64_t n, int64_t *first) {
    const int64_t vectors = OF_VESSEL * s->vessels + OF_FREE_BODY * s->bodies;
    *first = n < vectors ? n - n % 3 : n;
    return n < vectors ? 3 : 1;
}

/* Whether an input drives, where the choice of what moves its vessel allows it: as `driven`. */
static int drives(const Cable *cable, int64_t n) {
    if (!cable->now.use_scene_inputs) return 1;
    if (cable->now.scene_inputs_given || (cable->flags & FLAG_IGNORE)) return 0;
    return input_at(cable, n)->set != 0;
}

/* Which inputs move a vessel: as `vessel_input`. */
static int64_t moved_by(const Cable *cable, int64_t vessel) {
    const Input *own = input_at(cable, OF_VESSEL * vessel);
    const Choice *choice = choices_in(cable, cable->values) + vessel;
    const int place = (own[AT_POSITION].set | own[AT_ATTITUDE].set) & SET_IN_RUN;
    const int alone = place && !own[AT_VELOCITY].set && !own[AT_RATE].set;
    return alone && !choice->given ? BY_POSITION : choice->by;
}

/* Of both, one that alone is connected moves place or attitude alone. */
static int chosen(const Cable *cable, int64_t vessel, int64_t group) {
    const Input *own = input_at(cable, OF_VESSEL * vessel);
    const int64_t by = moved_by(cable, vessel);
    const int is_place = group == AT_POSITION || group == AT_ATTITUDE;
    if (by != BY_BOTH) return (by == BY_POSITION) == is_place;
    return own[group].set || !own[is_place ? group + AT_VELOCITY : group - AT_VELOCITY].set;
}

/* Once of a group of inputs that is set and does nothing: what says so, the name of what moves its
   vessel, or "": use_scene_inputs. NULL: it does something, or was told before. */
const char *ignored_part_input(Cable *cable, unsigned vr) {
    System *s = cable->system;
    int64_t first = 0;
    if (input_of(cable, vr) == NULL) return NULL;
    const int64_t n = (int64_t)vr - VR_SYSTEM_INPUT;
    group_of(cable, n, &first);
    if ((s->told[first] & TOLD_IGNORED) || !input_at(cable, n)->set) return NULL;
    const char *why = NULL;
    if (!drives(cable, n)) why = "";
    else if (n < OF_VESSEL * s->vessels && cable->now.phase == STEPPING &&
             !chosen(cable, n / OF_VESSEL, first % OF_VESSEL))
        why = s->rows[s->inputs + n / OF_VESSEL].name;
    if (why != NULL) s->told[first] |= TOLD_IGNORED;
    return why;
}

/* -- steps --------------------------------------------------------------------------------------- */

static double at_end(const Cable *cable, int64_t n, double dt) {
    const Input *input = input_at(cable, n);
    return value_at_end(&cable->now, input->slope, input->value, before(input), dt);
}

/* The same of a place or an angle that moves a vessel without its rate, at the speed that it has.
   Angles go the shorter way. */
static double moved_at_end(const Controls *now, const Input *x, int turning, double speed, double dt) {
    if (before(x) == NULL) return place_at_end(now, x->slope, x->value, speed, NULL, dt);
    const double way = x->value - x->before, turn = 2.0 * PI;
    const double from = turning ? x->value - remainder(way, turn) : x->before;
    return value_at_end(now, x->slope, x->value, &from, dt);
}

/* How vessels move as a step begins, for those whose place goes on so. */
static void look_at_frames(Cable *cable) {
    cablemodel_frame_motion(cable->I, cable->block_words, cable->system->own,
                            FRAME_INPUTS * cable->system->vessels);
}

/* Where velocities and rates lead whose derivatives say that they do not vary linearly, as places and
   attitudes that are not given; which of these are now. */
static int64_t curved_way(const Cable *cable, const Input *own, int64_t given, double dt,
                          FrameInput *motion, const FrameInput *moves) {
    const struct {
        int64_t rate, given_rate, given_place;
        double *to;
        const double *from;
    } ways[] = {{AT_VELOCITY, GIVEN_VELOCITY, GIVEN_POSITION, motion->position, moves->position},
                {AT_RATE, GIVEN_RATE, GIVEN_ATTITUDE, motion->attitude, moves->attitude}};
    int64_t more = 0;
    for (int k = 0; k < 2 && cable->now.has_slope; k++) {
        const Input *rate = own + ways[k].rate;
        int curved = 0;
        for (int i = 0; i < 3; i++) curved |= is_curved(rate[i].slope);
        if (!curved || !(given & ways[k].given_rate) || (given & ways[k].given_place)) continue;
        more |= ways[k].given_place;
        for (int i = 0; i < 3; i++)
            ways[k].to[i] = ways[k].from[i] + way_at_end(rate[i].slope, rate[i].value, dt);
    }
    return more;
}

/* A vessel's motion for a step, and whether any is given. */
static int collect_motion(const Cable *cable, int64_t vessel, double dt, FrameInput *motion) {
    static const struct {
        int64_t group, given, rate;
    } groups[] = {{AT_POSITION, GIVEN_POSITION, AT_VELOCITY},
                  {AT_ATTITUDE, GIVEN_ATTITUDE, AT_RATE},
                  {AT_VELOCITY, GIVEN_VELOCITY, 0},
                  {AT_RATE, GIVEN_RATE, 0}};
    const int64_t first = OF_VESSEL * vessel;
    const Input *own = input_at(cable, first);
    double *const ends[] = {motion->position, motion->attitude, motion->velocity, motion->attitude_rate};
    const FrameInput *moves = AS(const FrameInput, cable->system->own) + vessel;
    int64_t given = 0;
    for (int k = 0; k < 4; k++) {
        const int64_t group = groups[k].group, rate = groups[k].rate;
        if (!drives(cable, first + group) || !chosen(cable, vessel, group)) continue;
        given |= groups[k].given;
        const int beside = rate != 0 && chosen(cable, vessel, rate) && drives(cable, first + rate);
        for (int64_t i = 0; i < 3; i++) {
            const Input *x = own + group + i, *v = own + rate + i;
            const int turning = group == AT_ATTITUDE;
            const double speed = turning ? moves->attitude_rate[i] : moves->velocity[i];
            ends[k][i] =
                beside      ? place_at_end(&cable->now, x->slope, x->value, v->value, before(v), dt)
                : rate != 0 ? moved_at_end(&cable->now, x, turning, speed, dt)
                            : at_end(cable, first + group + i, dt);
        }
    }
    given |= curved_way(cable, own, given, dt, motion, moves);
    if (velocity_set(cable, vessel)) { /* nothing else drives it: it goes straight on */
        if (!(given & (GIVEN_POSITION | GIVEN_VELOCITY))) {
            given |= GIVEN_VELOCITY;
            memcpy(motion->velocity, vessel_starts(cable)[vessel].velocity, sizeof motion->velocity);
        }
        if (!(given & (GIVEN_ATTITUDE | GIVEN_RATE))) given |= GIVEN_RATE;
    }
    motion->given = (double)given;
    return given != 0;
}

/* As first_jump, of all vessels and driven ends, in place and attitude. */
const char *first_jump_of_parts(Cable *cable, double dt) {
    System *s = cable->system;
    FrameInput *motion = AS(FrameInput, s->motion);
    look_at_frames(cable);
    for (int64_t n = 0; n < s->vessels; n++) {
        const int64_t first = OF_VESSEL * n;
        const VesselStart *start = vessel_starts(cable) + n;
        double rate[3] = {0};
        for (int64_t i = 0; i < 3 && !velocity_set(cable, n); i++) rate[i] = s->rows[first + AT_RATE + i].start;
        memset(motion, 0, sizeof *motion);
        collect_motion(cable, n, dt, motion);
        const int64_t given = (int64_t)motion->given;
        const double way = given & GIVEN_POSITION
                               ? distance_from(start->position, start->velocity, motion->position, dt)
                               : 0.0;
        const double turn = given & GIVEN_ATTITUDE
                                ? distance_from(start->attitude, rate, motion->attitude, dt)
                                : 0.0;
        const int far = way > JUMP_SPEED * dt;
        if (!far && !(turn > JUMP_RATE * dt)) continue;
        const double *from = far ? start->position : start->attitude;
        char name[96];
        name_vessel(cable, n, name, sizeof name);
        snprintf(cable->message, sizeof cable->message,
                 "%s draws it by %g %s in the first step, of %g s: it begins at (%g, %g, %g); set "
                 "%s.start_%s",
                 s->rows[first + (far ? AT_POSITION : AT_ATTITUDE)].name, far ? way : turn,
                 far ? "m" : "rad", dt, from[0], from[1], from[2], name, far ? "position" : "attitude");
        return cable->message;
    }
    return NULL;
}

/* Whether an input drives in a step that begins now. */
static int in_use(const Cable *cable, int64_t n) {
    const int64_t vessel = n / OF_VESSEL, group = n % OF_VESSEL / 3 * 3;
    return drives(cable, n) && (vessel >= cable->system->vessels || chosen(cable, vessel, group));
}

/* As zero_input: velocities of vessels, then rates of winches. */
const char *zero_part_input(const Cable *cable, int64_t n) {
    const System *s = cable->system;
    const int64_t winch = n - s->vessels;
    const int64_t first = winch < 0 ? OF_VESSEL * n + AT_VELOCITY : s->inputs - s->cuts - s->winches + winch;
    double given[3] = {0};
    if (winch >= s->winches || !drives(cable, first)) return NULL;
    for (int64_t i = 0; i < (winch < 0 ? 3 : 1); i++) given[i] = input_at(cable, first + i)->value;
    if (!is_zero(given)) return NULL;
    if (winch >= 0) return turns(cable, winch) ? s->rows[first].name : NULL;
    const Frame *row = AS(Frame, cable->M + header(cable->I)->frames + FRAME_WORDS * n);
    const int moves = row->count > 1.0 || !is_zero(vessel_starts(cable)[n].velocity);
    return moves && in_use(cable, first) ? s->rows[first].name : NULL;
}

/* What is given for a step, in the words of the kernel `drive`; returns whether anything drives, by
   the rule of SystemModel.step. */
static int collect_parts(const Cable *cable, double dt) {
    System *s = cable->system;
    const int64_t *I = cable->I;
    int any = 0;
    memset(s->motion, 0, sizeof(double) * (size_t)(s->vessels * FRAME_INPUTS));
    for (int64_t n = 0; n < s->vessels; n++) {
        any |= collect_motion(cable, n, dt, AS(FrameInput, s->motion) + n);
        const double *row = cable->M + header(I)->frames + n * FRAME_WORDS;
        any |= AS(Frame, row)->live != (double)LIVE_NOT || AS(Frame, row)->turn_live != (double)LIVE_NOT;
    }
    int64_t input = OF_VESSEL * s->vessels;
    for (int64_t n = 0; n < s->bodies; n++)
        for (int64_t i = 0; i < OF_FREE_BODY; i++, input++) {
            double *force = s->forces + OF_FREE_BODY * n + i;
            *force = drives(cable, input) ? at_end(cable, input, dt) : 0.0;
            /* One that acts still is let go. */
            const double *row = cable->M + header(I)->free_bodies + n * FREE_WORDS;
            any |= *force != 0.0 || AS(FreeBody, row)->force.last[i] != 0.0;
        }
    for (int64_t n = 0; n < s->foils; n++, input++) {
        s->angles[n] = AS(Foil, cable->M + header(I)->foils + n * FOIL_WORDS)->deflection.last;
        if (!drives(cable, input)) continue;
        s->angles[n] = at_end(cable, input, dt);
        any = 1;
    }
    for (int64_t n = 0; n < s->winches; n++, input++) {
        const int given = drives(cable, input);
        s->rates[2 * n] = (double)given;
        s->rates[2 * n + 1] = given ? at_end(cable, input, dt) : 0.0;
        any |= given || winch_of(I, n)->live != (double)LIVE_NOT;
    }
    for (int64_t n = 0; n < s->cuts; n++, input++) {
        const double *row = cable->M + header(I)->cuts + n * CUT_WORDS;
        const double value = input_at(cable, input)->value;
        const int due = drives(cable, input) && value > 0.5 && !(AS(Cut, row)->done < 1e300);
        s->orders[n] = due && AS(Cut, row)->ordered == 0.0 ? 1.0 : 0.0;
        any |= s->orders[n] != 0.0;
    }
    return any;
}

/* Once of each winch and way: the name of its rate, where the last step was asked to pay out by it, and
   its drum is empty; or to reel in, and its line is as short as it gets. NULL: of no other one. */
const char *idle_winch(Cable *cable, int *inward) {
    System *s = cable->system;
    const int64_t first = s->inputs - s->cuts - s->winches;
    for (int64_t n = 0; n < s->winches; n++) {
        const Winch *winch = winch_of(cable->I, n);
        const double rate = s->rates[2 * n] != 0.0 ? s->rates[2 * n + 1] : 0.0;
        const int told = rate < 0.0 ? TOLD_SHORTEST : TOLD_IDLE;
        if (rate * winch->at_limit <= 0.0 || (s->told[first + n] & told)) continue;
        s->told[first + n] |= (char)told;
        *inward = rate < 0.0;
        return s->rows[first + n].name;
    }
    return NULL;
}

/* What a step has applied, into the words of `applied_in`. */
static void remember_applied(Cable *cable) {
    const System *s = cable->system;
    double *to = applied_in(cable, cable->values);
    const int64_t first_foil = OF_VESSEL * s->vessels + OF_FREE_BODY * s->bodies;
    for (int64_t n = 0; n < s->foils; n++)
        if (!drives(cable, first_foil + n)) s->angles[n] = NAN;
    const struct {
        const double *from;
        int64_t words;
    } parts[] = {{s->motion, s->vessels * FRAME_INPUTS}, {s->forces, s->bodies * OF_FREE_BODY},
                 {s->angles, s->foils}, {s->rates, 2 * s->winches}, {s->orders, s->cuts}};
    for (size_t n = 0; n < sizeof parts / sizeof parts[0]; to += parts[n++].words)
        memcpy(to, parts[n].from, sizeof(double) * (size_t)parts[n].words);
}

/* On failure nothing has changed. */
int64_t step_system(Cable *cable, double t_end, double dt) {
    System *s = cable->system;
    double none[INPUT_WORDS] = {0};
    look_at_frames(cable);
    const int driven = collect_parts(cable, dt);
    const int64_t payout = header(cable->I)->payout;
    const size_t bytes = sizeof(double) * (size_t)(header(cable->I)->position - header(cable->I)->frames);
    if (driven) {
        memcpy(s->kept, cable->M + header(cable->I)->frames, bytes);
        cablemodel_drive(cable->I, cable->block_words, t_end, s->motion, FRAME_INPUTS * s->vessels,
                         s->forces, OF_FREE_BODY * s->bodies, s->angles, s->foils, s->rates, 2 * s->winches,
                         s->orders, s->cuts);
    }
    const int64_t status = step_block(cable, t_end, none);
    if (status != OK) {
        if (driven) memcpy(cable->M + header(cable->I)->frames, s->kept, bytes);
        header(cable->I)->payout = payout;
        return status;
    }
    for (int64_t n = 0; n < s->inputs; n++) remember_input(input_at(cable, n), in_use(cable, n));
    remember_applied(cable);
    return OK;
}

const char *read_part(Cable *cable, unsigned vr, double *value) {
    const double *start = start_number(cable, vr);
    if (start != NULL) {
        *value = *start;
        return NULL;
    }
    if (vr < VR_SYSTEM_OUTPUT || vr - VR_SYSTEM_OUTPUT >= cable->system->outputs)
        return "unknown value reference";
    const char *problem = settle_cable(cable);
    if (problem != NULL) return problem;
    *value = system_outputs(cable)[vr - VR_SYSTEM_OUTPUT];
    return NULL;
}

void system_changed(System *system) { system->current = 0; }

/* -- for derivatives ----------------------------------------------------------------------------- */

int64_t vessels_of(const Cable *cable) { return cable->system->vessels; }

/* Which component of a vessel's motion an input is, and by what the last step was given of it.
   Returns 0 of another input. */
int motion_of(const Cable *cable, unsigned vr, MotionInput *found) {
    const System *s = cable->system;
    const int64_t n = (int64_t)vr - VR_SYSTEM_INPUT;
    if (!within(n, 0, OF_VESSEL * s->vessels - 1)) return 0;
    const int64_t group = n % OF_VESSEL / 3 * 3;
    found->vessel = n / OF_VESSEL;
    found->axis = n % 3;
    found->turning = group == AT_ATTITUDE || group == AT_RATE;
    found->is_position = group == AT_POSITION || group == AT_ATTITUDE;
    found->went_on = (input_at(cable, n)->driving & WENT_ON) != 0;
    const Input *own = input_at(cable, OF_VESSEL * found->vessel);
    const int by_place = own[found->turning ? AT_ATTITUDE : AT_POSITION].driving & DROVE;
    const int by_rate = own[found->turning ? AT_RATE : AT_VELOCITY].driving & DROVE;
    found->by = by_place && by_rate ? BY_BOTH : by_place ? BY_POSITION : by_rate ? BY_VELOCITY : 0;
    return 1;
}
