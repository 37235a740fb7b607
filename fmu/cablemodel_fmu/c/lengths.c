/* Lengths of the cables, set before the start, and the state at the start that belongs to them.

   What they make of the block is the kernels' (kernels/mesh/resizing.py, kernels/time/begin.py): here
   are the values, the order of the calls, and what is said. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "cable.h"

static double length_at(const Cable *cable, int64_t n, double share) {
    const Parameter *p = &cable->parameters[n];
    return p->start + share * (cable->values[n] - p->start);
}

int lengths_changed(const Cable *cable) {
    for (int64_t n = 0; n < cable->parameter_count; n++)
        if (cable->parameters[n].kind >= OF_LINE && cable->values[n] != cable->parameters[n].start)
            return 1;
    return 0;
}

int differs(const double *a, const double *b) {
    return a[0] != b[0] || a[1] != b[1] || a[2] != b[2];
}

int velocity_changed(const Cable *cable) {
    return differs(cable->now.start + 3, file_header(cable->file)->inputs + VR_VELOCITY);
}

static int position_changed(const Cable *cable) {
    return differs(cable->now.start, file_header(cable->file)->inputs + VR_POSITION);
}

/* The cables' lengths for the kernels, from a share of the way from the scene's to those set, to
   another one. */
double *lengths_between(const Cable *cable, double from, double to) {
    CableLength *row = (CableLength *)cable->lengths;
    for (int64_t n = 0; n < cable->parameter_count; n++) {
        const Parameter *p = &cable->parameters[n];
        if (p->kind < OF_LINE) continue;
        const CableRow *of = cable_of(cable->I, p->index);
        *row++ = (CableLength){
            .row = (double)p->index, .line = of->row, .winch = p->kind == OF_LINE ? -1.0 : (double)p->word,
            .first = p->start, .before = length_at(cable, n, from), .length = length_at(cable, n, to),
            .softness = of->edge.compliance, .mass = of->edge.mass - of->edge.added_mass,
            .drag = 2.0 * of->edge.drag_normal, .tension = p->factor, .counted = p->reach,
        };
    }
    return cable->lengths;
}

/* Where the tow point begins; whether that, or how fast, is not the scene's. */
static int start_moved(const Cable *cable, StartMove *move) {
    const double *scene = file_header(cable->file)->inputs, *start = cable->now.start;
    for (int i = 0; i < 3; i++) move->way[i] = start[i] - scene[VR_POSITION + i];
    memcpy(move->position, start, sizeof move->position);
    memcpy(move->velocity, start + 3, sizeof move->velocity);
    move->driven = velocity_changed(cable);
    return position_changed(cable) || velocity_changed(cable);
}

static void move_start(Cable *cable) {
    StartMove move;
    if (start_moved(cable, &move))
        cablemodel_move_start(cable->I, cable->block_words, (double *)&move, START_MOVE_WORDS);
}

/* The first line whose ends are held farther apart than it reaches, however much it stretches: see
   scene/schema.py; -1: there is none. length: of it, apart: of its ends [m]. Uses the block up. */
int64_t line_out_of_reach(Cable *cable, double *length, double *apart) {
    const int64_t *I = cable->I;
    cablemodel_place_supports(cable->I, cable->block_words);
    cablemodel_ends_apart(cable->I, cable->block_words, cable->gaps, header(I)->line_count);
    for (int64_t line = 0; line < header(I)->line_count; line++) {
        double reach = *length = 0.0;
        for (int64_t n = 0; n < header(I)->body_count; n++) {
            const Body *body = AS(Body, cable->M + header(I)->bodies + n * BODY_WORDS);
            if (body->node >= 0.0) *length += body->length, reach += body->length;
        }
        for (int64_t n = 0; n < cable->parameter_count; n++) {
            const Parameter *p = &cable->parameters[n];
            if (p->kind != OF_LINE || cable_of(I, p->index)->row != (double)line) continue;
            *length += cable->values[n];
            reach += cable->values[n] * p->reach;
        }
        *apart = cable->gaps[line];
        if (*apart > reach) return line;
    }
    return -1;
}

static int out_of_reach(Cable *cable) {
    double length, apart;
    move_start(cable);
    if (line_out_of_reach(cable, &length, &apart) < 0) return 0;
    snprintf(cable->message, sizeof cable->message,
             "the anchor is %g m from the vessel, out of reach of %g m of line", apart, length);
    return 1;
}

/* The frame in which a static shape is at rest: its velocity in the block's coordinates. */
void frame_of_rest(const Cable *cable, double frame[3]) {
    const double *velocity = cable->now.start + 3, *plane = scalars(cable->M)->plane;
    memcpy(frame, file_header(cable->file)->frame, 3 * sizeof(double));
    if (!velocity_changed(cable)) return;
    memcpy(frame, velocity, 3 * sizeof(double));
    if (header(cable->I)->dimension == 3) return;
    frame[0] = plane[0] * velocity[0] + plane[1] * velocity[1];
    frame[1] = velocity[2];
}

static int64_t solve_static(Cable *cable) {
    double frame[3];
    frame_of_rest(cable, frame);
    const int held = header(cable->I)->constraint_count > 1;
    const double friction = scalars(cable->M)->friction;
    /* A free end comes to rest without friction; it holds the line from there. */
    if (!held) scalars(cable->M)->friction = 0.0;
    const int64_t status =
        cablemodel_equilibrium(cable->I, cable->block_words, frame, header(cable->I)->dimension);
    scalars(cable->M)->friction = friction;
    if (!held) cablemodel_rest_here(cable->I, cable->block_words);
    if (status == OK) cablemodel_hold_supports(cable->I, cable->block_words);
    return status;
}

/* The calls of find_initial_state in cablemodel/solvers/finite_element/start/first_state.py. */
static int64_t find_initial_state(Cable *cable) {
    const int64_t words = cable->block_words;
    const int is_static = (cable->flags & FLAG_STATIC) != 0;
    int64_t status = OK;
    cablemodel_restore_bending(cable->I, words);
    cablemodel_place_supports(cable->I, words);
    if (!is_static) cablemodel_rest_here(cable->I, words);
    if (is_static) status = solve_static(cable);
    else {
        cablemodel_start_flow(cable->I, words);
        cablemodel_tension_from_stretch(cable->I, words);
    }
    if (status == OK && cablemodel_stabilise(cable->I, words) && is_static) status = solve_static(cable);
    cablemodel_end_search(cable->I, words);
    return status;
}

static int64_t at_rest_again(Cable *cable, double *velocity) {
    (void)velocity;
    return find_initial_state(cable);
}

/* The lengths at `to` from those at `from`, in shares of the way from the scene's to those set; and
   the start that was set. */
static int64_t stretch_line(Cable *cable, double from, double to) {
    LineFacts facts;
    StartMove move;
    memcpy(&facts, file_header(cable->file)->facts, sizeof facts);
    const int moves = from == 0.0 && start_moved(cable, &move);
    cablemodel_resize_line(cable->I, cable->block_words, lengths_between(cable, from, to), cable->length_words,
                           (double *)&facts, FACT_WORDS, (double *)&move, moves ? START_MOVE_WORDS : 0);
    return find_initial_state(cable);
}

static int moves_at_its_anchor(const Cable *cable) {
    const double *velocity = cable->now.start + 3;
    return (cable->flags & FLAG_STATIC) && header(cable->I)->constraint_count > 1 &&
           (velocity[0] != 0.0 || velocity[1] != 0.0 || velocity[2] != 0.0);
}

const Parameter *first_changed(const Cable *cable) {
    for (int64_t n = 0; n < cable->parameter_count; n++)
        if (cable->values[n] != cable->parameters[n].start) return &cable->parameters[n];
    return NULL;
}

static int touches_floor(Cable *cable) {
    const Summary *found = summary(cable);
    const double none[3] = {0};
    return found->floor_length != 0.0 || differs(found->floor_force, none);
}

/* What lies on a floor rests as it came there: such a start is not found anew. */
static const char *refuse_on_floor(Cable *cable) {
    const Parameter *changed = first_changed(cable);
    snprintf(cable->message, sizeof cable->message,
             "%s is not the scene's %g: of a line on a sea floor no start is found anew; export the scene "
             "with this value, or set it after the initialization",
             changed->name, changed->start);
    return cable->message;
}

/* What the exported start is like. */
typedef struct {
    Shape shape;
    int on_floor;
} Exported;

static Exported exported(Cable *cable) {
    Exported found = {0};
    take_exported(cable);
    outputs_changed(cable);
    found.shape = shape_of(cable);
    found.on_floor = touches_floor(cable);
    outputs_changed(cable);
    return found;
}

/* What is to be told of a static start that was found anew: its shape, and that it presses the line. */
static void judge(Cable *cable, const Exported *before, double bent) {
    const Summary *found = summary(cable);
    const double wrong = PROMISE * scalars(cable->M)->tolerance * fmax(fabs(found->tension_min), fabs(found->tension_max));
    judge_shape(cable, &before->shape, bent);
    cable->pressed = found->tension_min < -wrong ? found->tension_min : 0.0;
    outputs_changed(cable);
}

/* From the exported state, so that it does not matter in which order values were set; in one leap or,
   where that fails, in steps. */
const char *settle_line(Cable *cable) {
    int64_t status = STATICS_FAILED;
    double bent = 0.0;
    Exported before = {0};
    cable->bent = cable->stretched = cable->pressed = 0.0;
    cable->leaves = 0;
    if (first_changed(cable) == NULL && !position_changed(cable) && !velocity_changed(cable)) {
        restore_exported(cable);
        return NULL;
    }
    if ((cable->flags & FLAG_LEVEL) && first_changed(cable) == NULL) {
        restore_exported(cable);
        move_start(cable);
        return NULL;
    }
    const int judged = !is_direct(cable->I) && (cable->flags & FLAG_STATIC);
    if (judged) before = exported(cable);
    if (before.on_floor) return refuse_on_floor(cable);
    restore_exported(cable);
    if (is_direct(cable->I)) {
        if (cable->flags & FLAG_STATIC) status = direct_settle(cable);
        else status = OK;
    } else if (out_of_reach(cable)) {
        return cable->message;
    } else if (moves_at_its_anchor(cable)) {
        return "an anchored line has no steady state while the vessel moves: vessel.start_velocity "
               "must be 0";
    } else {
        for (int leaps = 1; leaps <= 16 && status != OK && status != NO_CAPACITY; leaps *= 4) {
            restore_exported(cable);
            status = OK;
            for (int n = 0; n < leaps && status == OK; n++)
                status = stretch_line(cable, (double)n / leaps, (n + 1.0) / leaps);
        }
        /* What bends far more may be another shape than the scene's: it is warned of. */
        if (judged && status == OK) {
            bent = shape_of(cable).bent;
            status = refine(cable, 0, at_rest_again, NULL);
            if (status == OK) status = refine(cable, 1, at_rest_again, NULL);
        }
    }
    if (status == OK) {
        if (!judged) return NULL;
        outputs_changed(cable);
        if (touches_floor(cable)) return refuse_on_floor(cable);
        judge(cable, &before, bent);
        const Parameter *changed = first_changed(cable);
        return judge_growth(cable, changed != NULL           ? changed->name
                                   : position_changed(cable) ? "vessel.start_position"
                                                             : "vessel.start_velocity");
    }
    if (status == NO_CAPACITY) return refuse_on_floor(cable); /* elements follow a line down to it */
    return NO_EQUILIBRIUM;
}
