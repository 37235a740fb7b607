/* Lengths of the cables, set before the start, and the state at the start that belongs to them.

   What cablemodel/solvers/finite_element/start makes of a scene's lengths is made of new ones here: the elements of a
   cable keep their number and are scaled with it, and so is the first shape, from which the kernels
   find the static equilibrium. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cable.h"

double length_at(const Cable *cable, int64_t n, double share) {
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

static int velocity_changed(const Cable *cable) {
    return differs(cable->now.start + 3, (const double *)cable->file + F_INPUTS + VR_VELOCITY);
}

static int position_changed(const Cable *cable) {
    return differs(cable->now.start, (const double *)cable->file + F_INPUTS + VR_POSITION);
}

static int leaves_plane(const Cable *cable, const double *vector) {
    const double *plane = scalars(cable->M)->plane;
    return header(cable->I)->dimension == 2 && plane[0] * vector[1] - plane[1] * vector[0] != 0.0;
}

/* The tow point to the start that was set, at the velocity that was set, and the line with it; an
   anchor stays. Until something drives it the vessel goes on so. */
static void move_start(Cable *cable) {
    double *M = cable->M, way[3];
    int64_t *I = cable->I;
    const double *scene = (const double *)cable->file + F_INPUTS, *start = cable->now.start;
    if (!position_changed(cable) && !velocity_changed(cable)) return;
    for (int i = 0; i < 3; i++) way[i] = start[i] - scene[VR_POSITION + i];
    if ((header(I)->constraint_count > 1 && leaves_plane(cable, way)) ||
        (velocity_changed(cable) && leaves_plane(cable, start + 3)))
        cablemodel_to_three_dimensions(I, cable->block_words);
    for (int i = 0; i < 3; i++) {
        scalars(M)->origin[i] += way[i];
        scalars(M)->shift[i] += way[i];
    }
    for (int64_t n = 0; n < header(I)->constraint_count; n++) {
        double *row = M + header(I)->constraints + n * CONSTRAINT_WORDS;
        if (AS(Constraint, row)->kind != (double)HELD_BY_ANCHOR) continue;
        if (header(I)->dimension == 2) {
            AS(Constraint, row)->position[0] -= scalars(M)->plane[0] * way[0] + scalars(M)->plane[1] * way[1];
            AS(Constraint, row)->position[1] -= way[2];
        } else {
            for (int i = 0; i < 3; i++) AS(Constraint, row)->position[i] -= way[i];
        }
    }
    if (velocity_changed(cable)) {
        double *live = M + header(I)->pieces;
        memset(live, 0, PIECE_WORDS * sizeof(double));
        memcpy(live + WORD(Piece, data), start, VR_STARTS * sizeof(double));
        header(I)->live = 1;
    }
}

/* An anchor that the line cannot reach, however much it stretches; see scene/schema.py. */
static int out_of_reach(Cable *cable) {
    const double *anchor = NULL, *vessel = cable->M + header(cable->I)->position;
    const int64_t *I = cable->I;
    for (int64_t n = 0; n < header(I)->constraint_count; n++) {
        const double *row = cable->M + header(I)->constraints + n * CONSTRAINT_WORDS;
        if (AS(Constraint, row)->kind == (double)HELD_BY_ANCHOR) anchor = row + WORD(Constraint, position);
    }
    if (anchor == NULL) return 0;
    double length = 0.0, reach = 0.0, square = 0.0;
    for (int64_t n = 0; n < header(I)->body_count; n++) {
        const double *row = cable->M + header(I)->bodies + n * BODY_WORDS;
        if (AS(Body, row)->node >= 0.0) length += AS(Body, row)->length, reach += AS(Body, row)->length;
    }
    for (int64_t n = 0; n < cable->parameter_count; n++) {
        if (cable->parameters[n].kind != OF_LINE) continue;
        length += cable->values[n];
        reach += cable->values[n] * cable->parameters[n].reach;
    }
    const double *scene = (const double *)cable->file + F_INPUTS, *plane = scalars(cable->M)->plane;
    double away[3];
    for (int i = 0; i < 3; i++) away[i] = scene[VR_POSITION + i] - cable->now.start[i];
    if (header(I)->dimension == 2) {
        for (int i = 0; i < 2; i++) away[i] += plane[i] * (anchor[0] - vessel[0]);
        away[2] += anchor[1] - vessel[1];
    } else {
        for (int i = 0; i < 3; i++) away[i] += anchor[i] - vessel[i];
    }
    for (int i = 0; i < 3; i++) square += away[i] * away[i];
    if (sqrt(square) <= reach) return 0;
    snprintf(cable->message, sizeof cable->message,
             "the anchor is %g m from the vessel, out of reach of %g m of line", sqrt(square),
             length);
    return 1;
}

/* Scale the chords of the elements: the line keeps its strains, its far end moves. */
static void scale_elements(Cable *cable, double from, double to) {
    const int64_t *I = cable->I, *parent = I + header(I)->parent, *joint = I + header(I)->joint;
    const int64_t nodes = header(I)->nodes, dimension = header(I)->dimension, size = 2 * dimension;
    double *q = cable->M + header(I)->position;
    for (int64_t node = nodes - 1; node > 0; node--) {
        double ratio = 1.0;
        for (int64_t n = 0; n < cable->parameter_count; n++) {
            const Parameter *p = &cable->parameters[n];
            if (joint[node] == JOINT_NONE && p->kind == OF_LINE &&
                (double)p->index == edge_of(cable->I, node)->segment)
                ratio = length_at(cable, n, to) / length_at(cable, n, from);
        }
        edge_of(cable->I, node)->length *= ratio;
        edge_of(cable->I, node)->nominal *= ratio;
        for (int64_t i = 0; i < dimension; i++)
            q[size * node + i] = ratio * (q[size * node + i] - q[size * parent[node] + i]);
    }
    double arc = 0.0;
    for (int64_t node = 1; node < nodes; node++) {
        edge_of(cable->I, node)->start = arc;
        arc += edge_of(cable->I, node)->length;
        for (int64_t i = 0; i < dimension; i++)
            q[size * node + i] += q[size * parent[node] + i];
    }
}

/* An anchored end back to its anchor: the way to it is shared out along the cable. */
static void back_to_the_anchor(Cable *cable) {
    const int64_t *I = cable->I, dimension = header(I)->dimension, size = 2 * dimension;
    double *q = cable->M + header(I)->position;
    for (int64_t c = 0; c < header(I)->constraint_count; c++) {
        const double *row = cable->M + header(I)->constraints + c * CONSTRAINT_WORDS;
        if (AS(Constraint, row)->kind != (double)HELD_BY_ANCHOR) continue;
        double way[3] = {0};
        for (int64_t i = 0; i < dimension; i++)
            way[i] = AS(Constraint, row)->position[i] - q[size * (int64_t)AS(Constraint, row)->node + i];
        for (int64_t node = 1; node < header(I)->nodes; node++) {
            const Edge *edge = edge_of(cable->I, node);
            const double share = (edge->start + edge->length) / scalars(cable->M)->length;
            for (int64_t i = 0; i < dimension; i++) {
                q[size * node + i] += share * way[i];
                q[size * node + dimension + i] += way[i] / scalars(cable->M)->length;
            }
        }
    }
}

/* Length of the body at the lower end of a cable of the winch; 0: none, or a point. */
static double body_below(const Cable *cable, int64_t index) {
    const double body = cable_of(cable->I, index)->body;
    if (body < 0.0) return 0.0;
    return cable->M[header(cable->I)->bodies + (int64_t)body * BODY_WORDS + WORD(Body, length)];
}

/* The cables as they pass the tow point: see cablemodel/solvers/finite_element/start/winch.py. */
static void arrange_winch(Cable *cable, double from, double to, double growth) {
    double below = 0.0, most = 0.0, travel = 0.0;
    double left = SHORTEST_LINE * scalars(cable->M)->length, above = 0.0; /* at the end of reel-in */
    int64_t last = 0;
    for (int64_t n = cable->parameter_count - 1; n >= 0; n--)
        if (cable->parameters[n].kind == OF_LINE)
            below += length_at(cable, n, to) + body_below(cable, cable->parameters[n].index);
    for (int64_t n = cable->parameter_count - 1; n >= 0; n--) {
        if (cable->parameters[n].kind != OF_LINE) continue;
        const double length = length_at(cable, n, to);
        last = cable->parameters[n].index;
        CableRow *row = cable_of(cable->I, last);
        if (left <= 0.0) above += body_below(cable, last);
        left -= length;
        below -= body_below(cable, last) + length;
        row->leaves = -below;
        row->nominal *= length / length_at(cable, n, from);
    }
    for (int64_t n = 0; n < cable->parameter_count; n++) {
        if (cable->parameters[n].kind != OF_DRUM) continue;
        CableRow *row = cable_of(cable->I, cable->parameters[n].index);
        const double longer = length_at(cable, n, to) / length_at(cable, n, from);
        most += length_at(cable, n, to);
        if (cable->parameters[n].index != last) {
            last = cable->parameters[n].index;
            travel += body_below(cable, last);
        }
        travel += length_at(cable, n, to);
        /* A cable of its own row has elements of the line's mean length, no more than there is
           room for. */
        const int own = row->leaves > 0.0;
        const double least = row->edge.nominal * longer / DRUM_ROOM;
        if (own) row->nominal *= growth;
        if (row->nominal < least) row->nominal = least;
        row->leaves = travel;
    }
    for (int64_t index = 0; index < header(cable->I)->cable_count; index++) {
        CableRow *row = cable_of(cable->I, index);
        double length = row->nominal;
        const double body = body_below(cable, index);
        if (index > 0) length = fmin(length, row->leaves - cable_of(cable->I, index - 1)->leaves - body);
        row->shortest = SHORTEST_PIECE * length;
        if (body > 0.0)
            row->shortest =
                fmin(row->shortest, fmax(FIRST_PIECE * body, LEAST_PIECE * row->nominal));
        row->edge.nominal = row->nominal;
    }
    double *M = cable->M;
    Winch *winch = winch_of(cable->I, 0);
    winch->top_length = edge_of(cable->I, 1)->length;
    winch->paid_most = most;
    winch->travel_most = travel;
    winch->travel_least = -above - (1.0 - SHORTEST_LINE) * scalars(M)->length;
}

/* What follows from the lengths of the line as a whole: facts_of of cablemodel/solvers/finite_element/start/tables.py. */
static void measure_line(Cable *cable, double share) {
    LineFacts facts;
    double drag = 0.0, mass = 0.0;
    const int64_t *I = cable->I;
    double *M = cable->M;
    memcpy(&facts, cable->file + F_FACTS, sizeof facts);
    for (int64_t n = 0; n < cable->parameter_count; n++) {
        const Parameter *p = &cable->parameters[n];
        if (p->kind != OF_LINE) continue;
        const double length = length_at(cable, n, share), longer = length - p->start;
        const Edge *edge = &cable_of(cable->I, p->index)->edge;
        const double dry = edge->mass - edge->added_mass;
        facts.length += longer;
        facts.softness += edge->compliance * longer;
        facts.mass += dry * longer;
        facts.tension += p->factor * longer;
        mass += dry * length;
        drag += 2.0 * edge->drag_normal * length;
    }
    facts.damping = drag * facts.length / mass;
    cablemodel_measure(cable->I, cable->block_words, (double *)&facts, FACT_WORDS);
    for (int64_t n = 0; n < header(I)->body_count; n++) {
        double *row = M + header(I)->bodies + n * BODY_WORDS;
        if (AS(Body, row)->length == 0.0) continue;
        AS(Body, row)->clamp_tension[0] = AS(Body, row)->clamp_tension[1] = scalars(M)->tension_scale;
        AS(Body, row)->clamp[0] = AS(Body, row)->clamp[1] = 0.0;
        if (AS(Body, row)->tie != 0.0) AS(Body, row)->tie = scalars(M)->tension_scale * AS(Body, row)->length;
        AS(Body, row)->compliance =
            fmin(AS(Body, row)->length / (RIGID * scalars(M)->tension_scale), SOFTEST * facts.softness);
    }
    scalars(M)->clamp_tension = scalars(M)->tension_scale;
    for (int64_t n = 0; n < header(I)->constraint_count; n++) { /* a clamp past which cable runs */
        double *row = M + header(I)->constraints + n * CONSTRAINT_WORDS;
        if (AS(Constraint, row)->clamped == (double)BY_SPRING)
            memset(row + WORD(Constraint, spring), 0, (CONSTRAINT_WORDS - WORD(Constraint, spring)) * sizeof(double));
    }
}

/* Every element as it was before a tension was known. */
void forget_stabilisation(Cable *cable) {
    const int64_t nodes = header(cable->I)->nodes, rows = header(cable->I)->cable_count;
    for (int64_t n = 1; n < nodes + rows; n++) {
        Edge *edge = n < nodes ? edge_of(cable->I, n) : &cable_of(cable->I, n - nodes)->edge;
        if (!(edge->compliance > 0.0)) continue;
        edge->stabilisation =
            fmin(STABILISATION * scalars(cable->M)->tension_scale, 1.0 / edge->compliance);
    }
}

void rest_here(Cable *cable) {
    const int64_t *I = cable->I, words = header(I)->nodes * 2 * header(I)->dimension;
    memcpy(cable->M + header(I)->rest, cable->M + header(I)->position, sizeof(double) * (size_t)words);
}

/* The frame in which a static shape is at rest: its velocity in the block's coordinates. */
static void frame_of(const Cable *cable, double frame[3]) {
    const double *velocity = cable->now.start + 3, *plane = scalars(cable->M)->plane;
    memcpy(frame, cable->file + F_FRAME, 3 * sizeof(double));
    if (!velocity_changed(cable)) return;
    memcpy(frame, velocity, 3 * sizeof(double));
    if (header(cable->I)->dimension == 3) return;
    frame[0] = plane[0] * velocity[0] + plane[1] * velocity[1];
    frame[1] = velocity[2];
}

/* What holds the ends, at the start of a motion, but for accelerations: they begin after t = 0. */
static void keep_accelerations(Cable *cable, int64_t (*place)(void *, int64_t)) {
    const int64_t *I = cable->I, size = 2 * header(I)->dimension;
    double kept[2][6];
    for (int after = 0; after < 2; after++) {
        for (int64_t n = 0; n < header(I)->constraint_count && n < 2; n++) {
            const double *row = cable->M + header(I)->constraints + n * CONSTRAINT_WORDS;
            double *a = cable->M + header(I)->acceleration + size * (int64_t)AS(Constraint, row)->node;
            memcpy(after ? a : kept[n], after ? kept[n] : a, (size_t)size * sizeof(double));
        }
        if (!after) place(cable->I, cable->block_words);
    }
}

static int64_t solve_static(Cable *cable) {
    double frame[3];
    frame_of(cable, frame);
    const int held = header(cable->I)->constraint_count > 1;
    const double friction = scalars(cable->M)->friction;
    /* A free end comes to rest without friction; it holds the line from there. */
    if (!held) scalars(cable->M)->friction = 0.0;
    const int64_t status =
        cablemodel_equilibrium(cable->I, cable->block_words, frame, header(cable->I)->dimension);
    scalars(cable->M)->friction = friction;
    if (!held) rest_here(cable);
    if (status == OK) keep_accelerations(cable, cablemodel_place_supports);
    return status;
}

/* Every element as stiff in bending as it may be: it is chosen anew. */
void restore_bending(Cable *cable) {
    for (int64_t node = 1; node < header(cable->I)->nodes; node++)
        edge_of(cable->I, node)->bending = edge_of(cable->I, node)->bending_full;
}

/* Counters, factorisation and history begin with a run. */
void count_from_zero(Cable *cable) {
    header(cable->I)->steps = header(cable->I)->rejected = 0;
    header(cable->I)->factorisations = header(cable->I)->iterations = 0;
    header(cable->I)->factored = header(cable->I)->has_history = 0;
}

/* The calls of find_initial_state and refine_touchdown in cablemodel/solvers/finite_element/start. */
static int64_t find_initial_state(Cable *cable) {
    const int64_t words = cable->block_words;
    const int is_static = (cable->flags & FLAG_STATIC) != 0;
    int64_t status = OK;
    restore_bending(cable);
    cablemodel_place_supports(cable->I, words);
    if (!is_static) rest_here(cable);
    if (is_static) status = solve_static(cable);
    else cablemodel_tension_from_stretch(cable->I, words);
    if (status == OK && cablemodel_stabilise(cable->I, words) && is_static) status = solve_static(cable);
    if (header(cable->I)->hybrid || header(cable->I)->rigid > 0 || header(cable->I)->payout)
        cablemodel_choose_bending(cable->I, words);
    for (int round = 0; round < REFINEMENTS && status == OK && is_static; round++) {
        const int64_t found = cablemodel_refine_at_floor(cable->I, words);
        if (found == NOTHING) break;
        status = found == CHANGED ? solve_static(cable) : found;
    }
    count_from_zero(cable);
    return status;
}

/* By how much a static shape bends at each of its elements, in what that can follow: by the rule by
   which refined of cablemodel/solvers/finite_element/start/refinement.py, or of
   cablemodel/systems/places.py, would halve it. One for each node; NULL: no memory. */
double *bends_of(const Cable *cable) {
    const int64_t nodes = header(cable->I)->nodes;
    double *bends = malloc(8 * (size_t)nodes);
    if (bends == NULL) return NULL;
    cablemodel_measure_bends(cable->I, cable->block_words, bends, nodes);
    for (int64_t node = 1; node < nodes; node++) {
        double length = scalars(cable->M)->length;
        if (bends[node] == 0.0) continue;
        if (is_system(cable->I))
            length = cable_of(cable->I, (int64_t)edge_of(cable->I, node)->segment)->line;
        bends[node] /= BENT * scalars(cable->M)->tolerance * length;
    }
    return bends;
}

/* The most of that. */
double most_bent(const Cable *cable) {
    double most = 0.0, *bends = bends_of(cable);
    if (bends == NULL) return 0.0;
    for (int64_t node = 1; node < header(cable->I)->nodes; node++) most = fmax(most, bends[node]);
    free(bends);
    return most;
}

/* The largest strain of an element, by the chord between its nodes. */
double most_stretched(const Cable *cable) {
    const int64_t *I = cable->I, *joint = I + header(I)->joint, *parent = I + header(I)->parent;
    const int64_t words = 2 * header(I)->dimension;
    const double *q = cable->M + header(I)->position;
    double most = 0.0;
    for (int64_t node = 1; node < header(I)->nodes; node++) {
        double square = 0.0;
        if (joint[node] != JOINT_NONE) continue;
        for (int64_t i = 0; i < words / 2; i++)
            square += pow(q[words * node + i] - q[words * parent[node] + i], 2.0);
        most = fmax(most, sqrt(square) / edge_of(cable->I, node)->length - 1.0);
    }
    return most;
}

/* What is to be told of a start that was found anew, of `bent` and `stretched`, where the exported one
   was not like that. */
void judge_shape(Cable *cable, double bent, double stretched) {
    cable->bent = most_bent(cable);
    if (!(cable->bent > fmax(FAR_TOO_BENT, bent))) cable->bent = 0.0;
    cable->stretched = most_stretched(cable);
    if (!(cable->stretched > fmax(LARGE_STRAIN, stretched))) cable->stretched = 0.0;
}

int64_t *copy_of_image(const Cable *cable) {
    int64_t *copy = malloc(8 * (size_t)cable->image_words);
    if (copy != NULL) memcpy(copy, cable->I, 8 * (size_t)cable->image_words);
    return copy;
}

void give_back(Cable *cable, const int64_t *image) {
    memcpy(cable->I, image, 8 * (size_t)cable->image_words);
}

/* The cable as it stands in its shape, where a winch pays out: a shape that turns takes its flow along. */
static void stop_flow(Cable *cable) {
    const int64_t *I = cable->I, dimension = header(I)->dimension, size = 2 * dimension;
    double frame[3];
    if (is_system(I) || !header(I)->payout || winch_of(I, 0)->rate == 0.0) return;
    frame_of(cable, frame);
    for (int64_t node = 0; node < header(I)->nodes; node++) {
        double *v = cable->M + header(I)->velocity + size * node;
        int moves = 0;
        for (int64_t i = 0; i < dimension; i++) moves |= v[i] != 0.0;
        memset(v, 0, sizeof(double) * (size_t)size);
        if (moves) memcpy(v, frame, sizeof(double) * (size_t)dimension);
    }
    memset(cable->M + header(I)->acceleration, 0, sizeof(double) * (size_t)(size * header(I)->nodes));
    winch_of(I, 0)->rate = 0.0;
}

/* How many small motions about a start grow by themselves: `instability` of
   cablemodel/systems/stability.py, `stays` of cablemodel/solvers/finite_element/start/unstable_start.py.
   0: none; -1: it cannot be told. */
static int64_t count_growing(Cable *cable) {
    const double rate = SLOWEST / scalars(cable->M)->period;
    int64_t *kept = copy_of_image(cable);
    if (kept == NULL) return -1;
    stop_flow(cable);
    int64_t found = cablemodel_count_growing(cable->I, cable->block_words, rate);
    give_back(cable, kept);
    if (is_system(cable->I) && (found != 0 || header(cable->I)->foil_count > 0)) {
        double none[1];
        const int64_t words = cablemodel_count_swinging(cable->I, cable->block_words, rate, none, 1);
        double *work = malloc(sizeof(double) * (size_t)words);
        found = work == NULL ? -1 : cablemodel_count_swinging(cable->I, cable->block_words, rate, work, words);
        free(work);
        give_back(cable, kept);
    }
    free(kept);
    return found;
}

/* Why a start that was found anew is none to begin with, where the exported one is: NULL: it is one, or
   is warned of. */
const char *judge_growth(Cable *cable, const char *changed) {
    if (count_growing(cable) == 0) return NULL;
    cable->leaves = (cable->flags & FLAG_LEAVES) != 0;
    if (cable->leaves) return NULL;
    snprintf(cable->message, sizeof cable->message,
             "%s is not the scene's: the start that is found with it falls or swings up by itself; export the "
             "scene with this value, where another one is looked for", changed);
    return cable->message;
}

/* The lengths at `to` from those at `from`, in shares of the way from the scene's to those set; and
   the start that was set. */
static int64_t stretch_line(Cable *cable, double from, double to) {
    double before = 0.0, after = 0.0;
    const int resized = lengths_changed(cable);
    for (int64_t n = 0; n < cable->parameter_count; n++) {
        if (cable->parameters[n].kind != OF_LINE) continue;
        before += length_at(cable, n, from);
        after += length_at(cable, n, to);
    }
    if (resized) scale_elements(cable, from, to);
    measure_line(cable, to);
    if (from == 0.0) move_start(cable);
    if (resized || position_changed(cable)) back_to_the_anchor(cable);
    if (resized) arrange_winch(cable, from, to, after / before);
    forget_stabilisation(cable);
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
    double bent, stretched;
    int on_floor;
} Exported;

static Exported exported(Cable *cable) {
    Exported found = {0};
    take_exported(cable);
    outputs_changed(cable);
    found.bent = most_bent(cable);
    found.stretched = most_stretched(cable);
    found.on_floor = touches_floor(cable);
    outputs_changed(cable);
    return found;
}

/* What is to be told of a static start that was found anew: its shape, and that it presses the line. */
static void judge(Cable *cable, const Exported *before) {
    const Summary *found = summary(cable);
    const double wrong = 10.0 * scalars(cable->M)->tolerance * fmax(fabs(found->tension_min), fabs(found->tension_max));
    judge_shape(cable, before->bent, before->stretched);
    cable->pressed = found->tension_min < -wrong ? found->tension_min : 0.0;
    outputs_changed(cable);
}

/* From the exported state, so that it does not matter in which order values were set; in one leap or,
   where that fails, in steps. */
static const char *settle(Cable *cable) {
    int64_t status = STATICS_FAILED;
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
    }
    if (status == OK) {
        if (!judged) return NULL;
        outputs_changed(cable);
        if (touches_floor(cable)) return refuse_on_floor(cable);
        judge(cable, &before);
        const Parameter *changed = first_changed(cable);
        return judge_growth(cable, changed != NULL           ? changed->name
                                   : position_changed(cable) ? "vessel.start_position"
                                                             : "vessel.start_velocity");
    }
    if (status == NO_CAPACITY) return refuse_on_floor(cable); /* elements follow a line down to it */
    return "no static equilibrium was found for these lengths, coefficients and start";
}

static const char *find_start(Cable *cable) {
    return cable->system != NULL ? settle_system(cable) : settle(cable);
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
