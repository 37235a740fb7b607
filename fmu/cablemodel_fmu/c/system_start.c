/* Starts of a system's vessels, lengths and coefficients, set before the run, and the state that
   belongs to them.

   It is sought as cablemodel/systems/equilibrium.py does, by the same kernels: along a first shape, and
   along those of lines that are drawn aside. Where that finds none that stays, and before the latter
   where lines are clamped to bodies, vessels go from where the scene has them to where they are
   wanted, in one part or in several, and lines and bodies follow from the exported start. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "system.h"

#define SMALLEST_PART (1.0 / 64.0) /* of the way, where larger ones fail */
#define ROUNDING 4e-16             /* of the numbers of a difference that is made twice */

static double *node_of(const Cable *cable, int64_t array, int64_t node) {
    return cable->M + cable->I[array] + 6 * node;
}
#define POSITION_OF(cable, node) node_of(cable, WORD(Header, position), node)

static Frame *frame_of(const Cable *cable, int64_t n) {
    return AS(Frame, cable->M + header(cable->I)->frames + n * FRAME_WORDS);
}

static Constraint *constraint_of(const Cable *cable, int64_t n) {
    return AS(Constraint, cable->M + header(cable->I)->constraints + n * CONSTRAINT_WORDS);
}

static double norm(const double *vector) {
    return sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
}

/* -- what is asked for ---------------------------------------------------------------------------- */

/* Whether a line ends at a vessel. */
static int is_used(const Cable *cable, int64_t vessel) {
    for (int64_t n = 0; n < header(cable->I)->constraint_count; n++) {
        const Constraint *row = constraint_of(cable, n);
        if (row->kind == (double)HELD_BY_FRAME && row->frame == (double)vessel) return 1;
    }
    return 0;
}

static int is_anchored(const Cable *cable) {
    for (int64_t n = 0; n < header(cable->I)->constraint_count; n++)
        if (constraint_of(cable, n)->kind == (double)HELD_BY_ANCHOR) return 1;
    return 0;
}

static int is_changed(const Cable *cable, int64_t vessel) {
    const VesselStart scene = scene_start(cable, vessel);
    return memcmp(&scene, vessel_starts(cable) + vessel, sizeof scene) != 0;
}

/* The first vessel at which a line ends, or -1. */
static int64_t first_used(const Cable *cable) {
    for (int64_t n = 0; n < header(cable->I)->frame_count; n++)
        if (is_used(cable, n)) return n;
    return -1;
}

/* Why there is no steady state at these starts, as the scene would say; NULL: there may be one. */
static const char *unsteady(Cable *cable) {
    const int64_t first = first_used(cable);
    const VesselStart *starts = vessel_starts(cable);
    char name[96], other[96];
    if (first < 0) return NULL;
    name_vessel(cable, first, name, sizeof name);
    for (int64_t n = first + 1; n < header(cable->I)->frame_count; n++) {
        if (!is_used(cable, n)) continue;
        double off[3];
        for (int i = 0; i < 3; i++) off[i] = starts[n].velocity[i] - starts[first].velocity[i];
        if (!(norm(off) > AT_REST * (1.0 + norm(starts[n].velocity)))) continue;
        name_vessel(cable, n, other, sizeof other);
        snprintf(cable->message, sizeof cable->message,
                 "%s.start_velocity is not that of %s: there is no steady state", other, name);
        return cable->message;
    }
    if (is_anchored(cable) && norm(starts[first].velocity) != 0.0) {
        snprintf(cable->message, sizeof cable->message,
                 "anchored, there is no steady state: %s.start_velocity must be 0", name);
        return cable->message;
    }
    return NULL;
}

/* Whether all vessels at which lines end are moved alike along level water that is the same
   everywhere, and what hangs there moves along as it is. */
static int moves_as_a_whole(const Cable *cable, double way[3]) {
    const int64_t *I = cable->I, first = first_used(cable);
    const double *plane = scalars(cable->M)->floor_plane;
    if (is_anchored(cable) || header(I)->wave_count != 0 || header(I)->floor_kind == FLOOR_TABLE) return 0;
    if (header(I)->floor_kind == FLOOR_PLANE && (plane[1] != 0.0 || plane[2] != 0.0)) return 0;
    for (int64_t n = first; n < header(I)->frame_count; n++) {
        if (!is_used(cable, n)) continue;
        const VesselStart scene = scene_start(cable, n), *start = vessel_starts(cable) + n;
        if (n == first)
            for (int i = 0; i < 3; i++) way[i] = start->position[i] - scene.position[i];
        for (int i = 0; i < 3; i++) {
            const double off = start->position[i] - scene.position[i] - way[i];
            if (fabs(off) > ROUNDING * (fabs(start->position[i]) + fabs(scene.position[i]) + fabs(way[i]))) return 0;
        }
        if (way[2] != 0.0 || differs(start->velocity, scene.velocity) ||
            differs(start->attitude, scene.attitude))
            return 0;
    }
    return 1;
}

/* -- on the way ------------------------------------------------------------------------------------ */

/* Angles go the shorter way. */
static double turn_to(double to, double from) {
    return remainder(to - from, 2.0 * PI);
}

/* How the water flows at the start, the mean over the depths of the current's table. */
static void mean_current(const Cable *cable, double out[3]) {
    const int64_t *I = cable->I, depths = header(I)->depth_count;
    memset(out, 0, 3 * sizeof *out);
    if (header(I)->current_kind == 0) return;
    for (int64_t k = 0; k < depths; k++)
        for (int i = 0; i < 3; i++) out[i] += cable->M[header(I)->current + 3 * k + i] / (double)depths;
}

/* What a way from the scene's start to the one that was set is like. */
typedef struct {
    double current[3], from[3], to[3]; /* velocities of the water and of the vessels */
    double turn; /* by which the system turns about the vertical, as a first guess [rad] */
    int by_angle; /* the vessels' velocity through the water turns with it */
} Way;

static Way way_of(const Cable *cable) {
    Way way = {0};
    const int64_t first = first_used(cable);
    if (first < 0) { /* only coefficients are other ones */
        memcpy(way.from, file_header(cable->file)->frame, sizeof way.from);
        memcpy(way.to, way.from, sizeof way.to);
        return way;
    }
    const VesselStart scene = scene_start(cable, first), *start = vessel_starts(cable) + first;
    mean_current(cable, way.current);
    memcpy(way.from, scene.velocity, sizeof way.from);
    memcpy(way.to, start->velocity, sizeof way.to);
    const double *w = way.current;
    const double before[2] = {way.from[0] - w[0], way.from[1] - w[1]}, after[2] = {way.to[0] - w[0], way.to[1] - w[1]};
    way.by_angle = hypot(before[0], before[1]) > 0.0 && hypot(after[0], after[1]) > 0.0;
    if (way.by_angle) {
        way.turn = atan2(before[0] * after[1] - before[1] * after[0], before[0] * after[0] + before[1] * after[1]);
    } else {
        int alone = !is_anchored(cable);
        for (int64_t n = first + 1; n < header(cable->I)->frame_count; n++) alone &= !is_used(cable, n);
        if (alone) way.turn = turn_to(start->attitude[2], scene.attitude[2]);
    }
    if (is_anchored(cable)) way.turn = 0.0;
    return way;
}

/* The vessels' velocity at a share of the way. */
static void velocity_at(const Way *way, double share, double out[3]) {
    for (int i = 0; i < 3; i++) out[i] = way->from[i] + share * (way->to[i] - way->from[i]);
    if (share == 1.0) memcpy(out, way->to, sizeof way->to);
    if (!way->by_angle || share == 1.0) return;
    const double x = way->from[0] - way->current[0], y = way->from[1] - way->current[1];
    const double last = hypot(way->to[0] - way->current[0], way->to[1] - way->current[1]), first = hypot(x, y);
    const double longer = (first + share * (last - first)) / first;
    const double c = longer * cos(share * way->turn), s = longer * sin(share * way->turn);
    out[0] = way->current[0] + c * x - s * y;
    out[1] = way->current[1] + s * x + c * y;
}

/* A piece of motion that goes on from its start. */
static void go_straight_on(Piece *piece, const double position[3], const double velocity[3]) {
    memset(piece, 0, sizeof *piece);
    piece->end = INFINITY;
    memcpy(piece->data, position, 3 * sizeof *position);
    memcpy(piece->data + 3, velocity, 3 * sizeof *velocity);
}

/* Vessels to a share of the way, where they move at a velocity. */
static void place_vessels(Cable *cable, double share, const double velocity[3]) {
    const double none[3] = {0};
    for (int64_t n = 0; n < header(cable->I)->frame_count; n++) {
        if (!is_changed(cable, n)) continue;
        const VesselStart scene = scene_start(cable, n), *wanted = vessel_starts(cable) + n;
        Frame *row = frame_of(cable, n);
        double place[3], angles[3];
        for (int i = 0; i < 3; i++) {
            const double way = wanted->position[i] - scene.position[i];
            const double turn = turn_to(wanted->attitude[i], scene.attitude[i]);
            place[i] = wanted->position[i] - (1.0 - share) * way;
            angles[i] = wanted->attitude[i] - (1.0 - share) * turn;
            if (velocity_set(cable, n)) continue;
            row->shift[i] = share * way;
            row->shift[3 + i] = share * turn;
        }
        if (!velocity_set(cable, n)) continue;
        go_straight_on(&row->piece, place, is_used(cable, n) ? velocity : wanted->velocity);
        go_straight_on(&row->turn_piece, angles, none);
        row->live = row->turn_live = (double)LIVE;
    }
}

/* -- what hangs on vessels follows them ------------------------------------------------------------- */

/* The whole system about the vertical through the first vessel. */
static void turn_system(Cable *cable, double angle) {
    double axis[2];
    if (angle == 0.0) return;
    for (int i = 0; i < 2; i++)
        axis[i] = frame_of(cable, first_used(cable))->motion.position[i] - scalars(cable->M)->origin[i];
    cablemodel_rotate_system(cable->I, cable->block_words, axis[0], axis[1], angle);
}

/* Lines and bodies after the ends that are held, which have moved since `before` (6 words of each node),
   and after lines whose elements have `grown` (3 words). Returns 0 if there is no memory. */
static int follow_supports(Cable *cable, double *before, double *grown) {
    const int64_t nodes = header(cable->I)->nodes;
    double none[1];
    const int64_t words =
        cablemodel_follow_supports(cable->I, cable->block_words, before, 6 * nodes, grown, 3 * nodes, none, 1);
    double *work = malloc(sizeof(double) * (size_t)words);
    if (work == NULL) return 0;
    cablemodel_follow_supports(cable->I, cable->block_words, before, 6 * nodes, grown, 3 * nodes, work, words);
    free(work);
    return 1;
}

/* -- equilibrium ------------------------------------------------------------------------------------ */

/* An equilibrium, in as many steps as there is work left for. */
static int64_t find_equilibrium(Cable *cable, double velocity[3]) {
    const double nodes = (double)header(cable->I)->nodes;
    const int64_t most = header(cable->I)->maximum_steps, before = header(cable->I)->iterations;
    if (!(cable->left > 0.0)) return STATICS_FAILED;
    header(cable->I)->maximum_steps =
        (int64_t)fmin((double)most, fmax(SEARCH_FEWEST, cable->left / (SEARCH_STEP * nodes)));
    const int64_t status = cablemodel_equilibrium(cable->I, cable->block_words, velocity, 3);
    header(cable->I)->maximum_steps = most;
    cable->left -= nodes * (double)(header(cable->I)->iterations - before);
    return status;
}

/* At rest, on elements that are fine enough: as Equilibria._settle of
   cablemodel/systems/equilibrium.py. */
static int64_t settle(Cable *cable, double velocity[3]) {
    double at[SETTLING_WORDS] = {0}, *kept = NULL;
    int64_t status = OK;
    do {
        if (status == NO_CAPACITY && !grow(cable)) break;
        if (kept == NULL || status == NO_CAPACITY) {
            free(kept);
            kept = malloc(16 * (size_t)cable->image_words);
            if (kept == NULL) return NO_CAPACITY;
        }
        if (status == SEARCH) status = find_equilibrium(cable, velocity);
        status = cablemodel_go_on_settling(cable->I, cable->block_words, status, at, SETTLING_WORDS, kept,
                                           2 * cable->image_words);
    } while (status == SEARCH || status == NO_CAPACITY);
    free(kept);
    return status;
}

/* The start as it is where there is none with friction. */
static int64_t let_friction_hold(Cable *cable) {
    double hold[FIRM_HOLD_WORDS], none[3] = {0};
    if (cablemodel_begin_to_hold(cable->I, cable->block_words, hold, FIRM_HOLD_WORDS) == NOTHING) return OK;
    int64_t status = OK, *before = copy_of_image(cable);
    if (before == NULL) return NO_CAPACITY;
    double *tensions = (double *)before + header(before)->tension;
    while ((status = cablemodel_go_on_holding(cable->I, cable->block_words, status, hold, FIRM_HOLD_WORDS, tensions,
                                              2 * header(before)->nodes)) == SEARCH)
        status = cablemodel_equilibrium(cable->I, cable->block_words, none, 3);
    if (status != OK) give_back(cable, before);
    free(before);
    return OK;
}

/* From a share of the way to another one. */
static int64_t go_on(Cable *cable, const Way *way, double from, double to) {
    const int64_t nodes = header(cable->I)->nodes;
    double velocity[3], *before = calloc((size_t)(9 * nodes), sizeof(double));
    if (before == NULL) return NO_CAPACITY;
    double *grown = before + 6 * nodes;
    velocity_at(way, to, velocity);
    turn_system(cable, (to - from) * way->turn);
    memcpy(before, POSITION_OF(cable, 0), sizeof(double) * (size_t)(6 * nodes));
    place_vessels(cable, to, velocity);
    cablemodel_place_supports(cable->I, cable->block_words);
    cablemodel_resize_lines(cable->I, cable->block_words, lengths_between(cable, from, to), cable->length_words, before,
                            6 * nodes, grown, 3 * nodes);
    const int followed = follow_supports(cable, before, grown);
    cablemodel_place_supports(cable->I, cable->block_words); /* clamps do not turn with the line */
    free(before);
    cablemodel_restore_bending(cable->I, cable->block_words);
    return followed ? settle(cable, velocity) : NO_CAPACITY;
}

/* Rates of winches: 0, as a start is sought, or those of the exported state. */
static void run_winches(Cable *cable, int runs) {
    for (int64_t n = 0; n < header(cable->I)->winch_count; n++)
        winch_of(cable->I, n)->rate = runs ? winch_of(initial_image(cable), n)->rate : 0.0;
}

/* What is to be told of such a start: as `judge` of lengths.c. */
static void judge(Cable *cable, const Shape *before) {
    judge_shape(cable, before, 0.0);
    cable->pressed = shape_of(cable).pressed;
}

/* What is asked for that is not as the scene has it, by name. */
static const char *name_changed(const Cable *cable, char *name, size_t size) {
    const Parameter *tuned = first_changed(cable);
    char vessel[96];
    if (tuned != NULL) return tuned->name;
    for (int64_t n = 0; n < header(cable->I)->frame_count; n++) {
        if (!is_changed(cable, n) || !is_used(cable, n)) continue;
        const VesselStart scene = scene_start(cable, n), *start = vessel_starts(cable) + n;
        name_vessel(cable, n, vessel, sizeof vessel);
        snprintf(name, size, "%s.start_%s", vessel,
                 differs(start->velocity, scene.velocity) ? "velocity"
                 : differs(start->position, scene.position) ? "position" : "attitude");
        break;
    }
    return name;
}

/* What follows from the lengths that are set, in a block with the scene's. */
static void measure(Cable *cable) {
    LineFacts facts;
    memcpy(&facts, file_header(cable->file)->facts, sizeof facts);
    if (lengths_changed(cable))
        cablemodel_measure(cable->I, cable->block_words, lengths_between(cable, 0.0, 1.0), cable->length_words,
                           (double *)&facts, FACT_WORDS);
    cablemodel_forget_stabilisation(cable->I, cable->block_words);
}

/* The first shape for what is set, into its words. Returns 0 if there is no memory. */
static int find_first_shape(Cable *cable, double *shape, const double velocity[3], int aside) {
    const int64_t words = file_header(cable->file)->shape_words;
    const CableLength *length = (const CableLength *)lengths_between(cable, 0.0, 1.0);
    memcpy(shape, first_shape(cable), 8 * (size_t)words);
    for (StringItem *item = string_items(shape); item < (StringItem *)string_bodies(shape); item++)
        if (item->body == 0.0) item->length = length++->length;
    for (StringEnd *end = string_ends(shape); end < string_ends(shape) + 2 * header(cable->I)->line_count; end++)
        if (end->kind == STRING_HELD)
            memcpy(end->place, POSITION_OF(cable, (int64_t)constraint_of(cable, (int64_t)end->other)->node),
                   sizeof end->place);
    memcpy(AS(FirstShape, shape)->velocity, velocity, 3 * sizeof *velocity);
    for (int drawn = 0; drawn <= aside; drawn++) {
        int64_t needed = 0;
        double none[1], *work = NULL;
        AS(FirstShape, shape)->aside = drawn;
        do {
            free(work);
            work = malloc(8 * (size_t)needed + 8);
            if (work == NULL) return 0;
            needed = cablemodel_find_first_shape(cable->I, cable->block_words, shape, words, needed ? work : none, needed);
        } while (needed != 0);
        free(work);
    }
    return 1;
}

/* All elements into two. */
static int64_t halve_all(Cable *cable) {
    int64_t status = NO_CAPACITY;
    for (int more = 1; more && status == NO_CAPACITY; more = status != NO_CAPACITY || grow(cable)) {
        const int64_t nodes = header(cable->I)->nodes;
        int64_t *kept = copy_of_image(cable);
        double *bends = malloc(8 * (size_t)nodes);
        if (kept != NULL && bends != NULL) {
            for (int64_t n = 0; n < nodes; n++) bends[n] = 1.0;
            status = cablemodel_halve_bent(cable->I, cable->block_words, bends, nodes, 0.0);
            if (status == NO_CAPACITY) give_back(cable, kept);
        }
        free(kept);
        free(bends);
        if (kept == NULL || bends == NULL) return NO_CAPACITY;
    }
    return status;
}

/* From a first shape, as the library begins with these lengths and starts: Equilibria._at_rest. parts: of
   each element, of lines that are drawn aside; 0: of plain ones. */
static int64_t begin_anew(Cable *cable, double velocity[3], int parts) {
    const int64_t *first = first_image(cable);
    if (!reserve(cable, header(first)->byte_count / 8, header(first)->capacity)) return NO_CAPACITY;
    double *shape = malloc(8 * (size_t)file_header(cable->file)->shape_words);
    take_image(cable, first);
    tune_all(cable);
    measure(cable);
    const int64_t nodes = header(cable->I)->nodes;
    double *unused = calloc((size_t)(9 * nodes), sizeof(double));
    int64_t status = shape != NULL && unused != NULL ? OK : NO_CAPACITY;
    if (status == OK) {
        cablemodel_resize_lines(cable->I, cable->block_words, lengths_between(cable, 0.0, 1.0), cable->length_words,
                                unused, 6 * nodes, unused + 6 * nodes, 3 * nodes);
        for (int64_t n = 0; n < header(cable->I)->closure_count; n++) { /* until it is known */
            Closure *tie = AS(Closure, cable->M + header(cable->I)->closures + n * CLOSURE_WORDS);
            if (tie->clamp != 0.0) tie->tension = scalars(cable->M)->tension_scale;
        }
        place_vessels(cable, 1.0, velocity);
        cablemodel_place_supports(cable->I, cable->block_words);
        if (!find_first_shape(cable, shape, velocity, parts > 0)) status = NO_CAPACITY;
    }
    for (int n = 1; status == OK && n < parts; n *= 2)
        if (halve_all(cable) == NO_CAPACITY) status = NO_CAPACITY;
    if (status == OK)
        do
            status = cablemodel_place_on_shape(cable->I, cable->block_words, shape, file_header(cable->file)->shape_words);
        while (status == NO_CAPACITY && grow(cable));
    if (status == OK) {
        cablemodel_place_supports(cable->I, cable->block_words);
        status = settle(cable, velocity);
    }
    free(shape);
    free(unused);
    return status;
}

/* From the exported start, in one part or in several. */
static int64_t go_on_from_there(Cable *cable, const Way *way) {
    int64_t status = OK, *kept = NULL;
    restore_exported(cable);
    run_winches(cable, 0);
    measure(cable);
    double done = 0.0, part = 1.0;
    while (done < 1.0) {
        const double next = fmin(1.0, done + part);
        if (!(kept = copy_of_image(cable))) return NO_CAPACITY;
        const int64_t capacity = header(kept)->capacity;
        if (part < 1.0) header(cable->I)->maximum_steps = FEW_STEPS; /* what is near is soon found */
        status = go_on(cable, way, done, next);
        header(cable->I)->maximum_steps = header(initial_image(cable))->maximum_steps;
        if (status != OK) {
            if (header(cable->I)->capacity != capacity) lay_out_as(cable, kept);
            give_back(cable, kept);
            part *= 0.5;
        } else {
            done = next;
        }
        free(kept);
        if (status == NO_CAPACITY || part < SMALLEST_PART) break;
    }
    return status;
}

/* Whether ends of lines are clamped: bodies turn along them, which a first shape does not know. */
static int has_clamps(const Cable *cable) {
    for (int64_t n = 0; n < header(cable->I)->closure_count; n++)
        if (AS(Closure, cable->M + header(cable->I)->closures + n * CLOSURE_WORDS)->clamp != 0.0) return 1;
    return 0;
}

/* The ways in which a start is sought in turn. */
enum { PLAIN = 0, PARTS_ASIDE = 32, GO_ON = 64 };

static int64_t find_by(Cable *cable, const Way *way, double velocity[3], int how) {
    return how == GO_ON ? go_on_from_there(cable, way) : begin_anew(cable, velocity, how);
}

static const char *search(Cable *cable) {
    const Way way = way_of(cable);
    const Shape before = shape_of(cable);
    const int clamped = has_clamps(cable);
    double velocity[3];
    char name[128] = "";
    int64_t status = STATICS_FAILED, growing = 1;
    int first = -1, pressed = 0;
    velocity_at(&way, 1.0, velocity);
    cable->left = file_header(cable->file)->search;
    for (int how = PLAIN; how <= GO_ON && growing != 0 && cable->left > 0.0;) {
        const int aside = how != PLAIN && how != GO_ON;
        if (!aside || first < 0 || pressed) {
            status = find_by(cable, &way, velocity, how);
            if (status == NO_CAPACITY) return "out of memory";
            if (status == OK) {
                growing = count_growing(cable);
                if (first < 0) first = how, pressed = shape_of(cable).pressed != 0.0;
            }
        }
        how = how == PLAIN ? (clamped ? GO_ON : 1) : how == GO_ON && clamped ? 1 : 2 * how;
        if (clamped && how == GO_ON && aside) break;
    }
    if (first < 0)
        return cable->left > 0.0
                   ? NO_EQUILIBRIUM
                   : NO_EQUILIBRIUM " (the search ended with "
                     "the scene's solver.start_time_limit)";
    if (growing != 0) {
        cable->left = INFINITY; /* it was found before */
        status = find_by(cable, &way, velocity, first);
        const char *left = refuse_growth(cable, name_changed(cable, name, sizeof name));
        if (left != NULL) return left;
    }
    if (!differs(velocity, (const double[3]){0})) status = let_friction_hold(cable);
    if (status == NO_CAPACITY) return "out of memory";
    run_winches(cable, 1);
    judge(cable, &before);
    if (cablemodel_start_flowing(cable->I, cable->block_words) < 0) return NULL;
    return "a winch runs at the start, and what touches the sea floor does not move along";
}

/* Vessels to their starts, and the origin of the block's coordinates, in which nothing moves, with
   them: not even by rounding. */
static const char *move_origin(Cable *cable, const double way[3]) {
    const size_t bytes = sizeof(double) * (size_t)(6 * header(cable->I)->nodes);
    double *kept = malloc(bytes);
    if (kept == NULL) return "out of memory";
    memcpy(kept, POSITION_OF(cable, 0), bytes);
    place_vessels(cable, 1.0, NULL);
    for (int i = 0; i < 3; i++) scalars(cable->M)->origin[i] += way[i];
    cablemodel_hold_supports(cable->I, cable->block_words);
    memcpy(POSITION_OF(cable, 0), kept, bytes);
    free(kept);
    return NULL;
}

/* Why a system cannot have the lengths that are set, with vessels where they are to begin; NULL: it may. */
static const char *refuse_lengths(Cable *cable) {
    double velocity[3], length, apart;
    const System *s = cable->system;
    if (!lengths_changed(cable)) return NULL;
    const Way way = way_of(cable);
    velocity_at(&way, 1.0, velocity);
    place_vessels(cable, 1.0, velocity);
    const int64_t line = line_out_of_reach(cable, &length, &apart);
    restore_exported(cable);
    for (int64_t n = 0; n < header(cable->I)->cut_count; n++) {
        const Cut *cut = AS(Cut, cable->M + header(cable->I)->cuts + n * CUT_WORDS);
        const double number = cable_of(cable->I, (int64_t)cut->segment)->row;
        double own = 0.0;
        for (int64_t k = 0; k < cable->parameter_count; k++) {
            const Parameter *p = &cable->parameters[k];
            if (p->kind == OF_LINE && cable_of(cable->I, p->index)->row == number) own += cable->values[k];
        }
        if (cut->side != CUT_WITHIN || fabs(cut->arc) < own) continue;
        snprintf(cable->message, sizeof cable->message, "a cut at %g m is beyond %s, which has %g m",
                 fabs(cut->arc), s->rows[first_line(s) + (int64_t)number].name, own);
        return cable->message;
    }
    if (line < 0) return NULL;
    snprintf(cable->message, sizeof cable->message, "%s ends %g m apart, out of reach of its %g m",
             s->rows[first_line(s) + line].name, apart, length);
    return cable->message;
}

/* From the exported state, so that it does not matter in which order values were set. */
const char *settle_system(Cable *cable) {
    int changed = 0, moved = 0;
    double way[3] = {0};
    cable->bent = cable->stretched = cable->pressed = 0.0;
    cable->leaves = 0;
    const Parameter *tuned = first_changed(cable);
    restore_exported(cable);
    for (int64_t n = 0; n < header(cable->I)->frame_count; n++) {
        changed |= is_changed(cable, n);
        moved |= is_changed(cable, n) && is_used(cable, n);
    }
    if (!changed && tuned == NULL) return NULL;
    if (tuned != NULL && !(cable->flags & FLAG_MOVABLE)) {
        snprintf(cable->message, sizeof cable->message,
                 "%s is not the scene's %g: friction holds bodies, or what was laid, at this start; export the scene "
                 "with it, or set it after the initialization", tuned->name, tuned->start);
        return cable->message;
    }
    const char *problem = unsteady(cable);
    if (problem != NULL) return problem;
    if (tuned == NULL && (!moved || moves_as_a_whole(cable, way))) return move_origin(cable, way);
    problem = refuse_lengths(cable);
    if (problem == NULL) problem = search(cable);
    if (problem != NULL) take_exported(cable);
    return problem;
}
