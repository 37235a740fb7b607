/* The cable, or the system, behind the FMI functions: one instance block, its inputs, parameters and
   outputs. */
#ifndef CABLE_H
#define CABLE_H

#include <stddef.h>
#include <stdint.h>

#include "layout.h" /* generated from cablemodel/solvers/shared/layout.py and cablemodel/solvers/finite_element/block.py */

/* Value references, of all types: no two variables have the same, for there are masters that keep
   them in one table. See cablemodel_fmu/signals.py, which writes them. */
enum {
    VR_VELOCITY = 0, VR_POSITION = 3, VR_PAYOUT = 6, VR_CURRENT = 7, VR_INPUTS = 10,
    VR_USE_SCENE_INPUTS = 10, /* the only Boolean */
    VR_VESSEL_INPUT = 11, VR_INPUT_TIMING = 12, /* the Integers, enumerations */
    VR_START = 20, VR_START_VELOCITY = 23, VR_STARTS = 6, /* of the tow point: position, velocity */
    VR_PARAMETER = 100,
    VR_ZERO = 900,
    VR_ERROR = 950,
    VR_SUMMARY = 1000,
    VR_STATION = 10000,
    VR_BODY = 20000000,
    /* Of a system: inputs of its parts, what moves each vessel (Integers), outputs, starts. */
    VR_SYSTEM_INPUT = 100000000, VR_SYSTEM_CHOICE = 200000000, VR_SYSTEM_OUTPUT = 300000000,
    VR_SYSTEM_START = 400000000 /* VesselStart of each vessel */
};
enum { BY_VELOCITY = 1, BY_POSITION = 2, BY_BOTH = 3 };
enum { AT_END = 1, AT_START = 2 }; /* of a step: when a value that is set holds */
/* Inputs that go together. */
enum { VELOCITY_SET = 1, POSITION_SET = 2, PAYOUT_SET = 4, CURRENT_SET = 8, ALL_SET = 15 };
enum { INSTANTIATED = 1, INITIALISING, STEPPING, TERMINATED };

/* Words of resources/model.bin and of finer.bin, all 64 bits, little endian; see
   cablemodel_fmu/model_file.py. */
enum {
    F_MAGIC, F_FORMAT, F_WORDS, F_CHECKSUM, F_KERNELS,
    F_GUID, /* 40 characters, padded with zeros */
    F_FLAGS = F_GUID + 5, F_IMAGE_WORDS, F_BLOCK_WORDS, F_STATIONS, F_PARAMETERS,
    F_SYSTEM_WORDS, /* between parameters and image; see system.c */
    F_INPUTS = 16,
    F_FRAME = F_INPUTS + VR_INPUTS,
    F_FACTS = 32, /* of the line as a whole: FACT_WORDS */
    F_HEADER_WORDS = 48
};
enum {
    FLAG_SCENE_INPUTS = 1, FLAG_STATIC = 2, FLAG_PINNED = 4, FLAG_ESTIMATE = 8,
    FLAG_IGNORE = 16, /* inputs, while use_scene_inputs is true */
    FLAG_MOVABLE = 32, /* the start of the tow point, or of vessels, may be set */
    FLAG_AT_START = 64, /* input.timing begins as 2 */
    FLAG_VESSEL_INPUT_UNIT = 128, FLAG_VESSEL_INPUT = 3 * 128, /* what vessel.input begins as */
    FLAG_LEVEL = 512, /* the tow point's start may be moved along a level floor, and all that lies with it */
    FLAG_LEAVES = 1024 /* small motions about the exported start may grow by themselves */
};
#define FILE_MAGIC INT64_C(0x554d46454c424143) /* "CABLEFMU" */
#define STATE_MAGIC INT64_C(0x5441545346434244)
#define FILE_FORMAT 4
#define LARGEST_COUNT (INT64_C(1) << 22) /* of anything in a block */
#define LARGEST_FILE (INT64_C(1) << 33)  /* and of a block [bytes] */
#define PI 3.14159265358979323846
#define FURTHEST 1e7 /* of positions [m] */
#define FASTEST 1e3  /* of velocities and rates [m/s] */
/* What a first step by position may change of a vessel's speed and of its rates of turn, on the
   average, without a warning: more than that is a start elsewhere. As limits.speed and
   limits.turn_rate of the ROS 2 node. */
#define JUMP_SPEED 10.0 /* [m/s] */
#define JUMP_RATE 1.0   /* [rad/s] */

/* A tunable coefficient: word = factor * value in the edges of a cable type, in a body of a line or in a
   free body, whose buoyancy is its weight in air and that. Or a
   length that is fixed at the start, of a cable of the line or on the drum: from the vessel outwards,
   and in the order in which they leave the drum. */
enum { OF_CABLES, OF_BODY, OF_FREE, OF_LINE, OF_DRUM };
typedef struct {
    int64_t kind, word; /* of a length on a drum of a system, the winch */
    int64_t index; /* of the cable type, row of the table of bodies, free bodies or cables */
    double factor; /* of a length of the line: its part in the typical tension [N/m] */
    double start, minimum, maximum;
    /* Of a length of the line: how far it can reach when stretched, in lengths. Of one on a drum of a
       system: 1 where the scene counts its elements. */
    double reach;
    char name[96]; /* of the variable, ended by zeros */
} Parameter;

/* One input of a part of a system: its value, that of the last step, derivatives for the next one,
   whether the master has set it: SET_EVER, SET_IN_RUN; and whether it drove in the last step, and in
   the one before that, too: DROVE, WENT_ON. */
enum { SET_EVER = 1, SET_IN_RUN = 2, DROVE = 1, WENT_ON = 2 };
typedef struct {
    double value, before, slope[3];
    int64_t set, driving;
} PartInput;
/* Where a vessel of a system begins, and how fast; its inputs begin with the same. */
typedef struct {
    double position[3], velocity[3], attitude[3];
} VesselStart;
enum { START_WORDS = sizeof(VesselStart) / 8 };
typedef struct System System; /* system.h; NULL: a scene of one line */
enum { WRENCH_WORDS = 6 };
/* An input of a vessel's motion; by: what moved that in the last step, 0: the scene; went_on: it drove
   the step before that, too. */
typedef struct {
    int64_t vessel, axis, by;
    int turning, is_position, went_on;
} MotionInput;

/* Everything of an instance that a saved state holds, apart from the block's image and `values`. */
typedef struct {
    int64_t magic, words, checksum, kernels;
    char guid[40];
    int64_t phase;
    /* What the kernels were given in the last step, and its length [s], 0: none; recording.py. */
    StepInputs applied;
    double last_step;
    int64_t use_scene_inputs, scene_inputs_given, vessel_input, vessel_input_given;
    int64_t input_timing, unsettled;
    int64_t set, position_set_in_run; /* which inputs the master has set: ..._SET */
    double start_time;
    double input[VR_INPUTS];
    double start[VR_STARTS]; /* of the tow point */
    /* Derivatives of the inputs that the master has set, for the next step only. */
    int64_t has_slope;
    double slope[VR_INPUTS][3];
    /* How much longer the last step was than the one before, and the inputs set for it. */
    double growth, before[VR_INPUTS];
    int64_t last_mode, last_driven, last_sloped; /* and what drove it */
    int64_t went_on; /* of a line: which inputs drove the step before it, too: ..._SET */
} Controls;

typedef struct Cable {
    int64_t *file; /* model.bin as read */
    int64_t *I;    /* the block, as integers and as reals */
    double *M;
    const Parameter *parameters;
    double *lengths; /* CableLength of each parameter that is one: lengths_between */
    int64_t length_words;
    double *values; /* of the parameters, then what a system's inputs and starts are */
    int64_t value_words;
    System *system;
    int64_t stations, bodies, parameter_count, image_words, block_words, flags;
    int64_t room; /* words of memory behind the block, which grows: see room.c */
    Controls now;
    int summary_current, stations_current;
    int64_t *copy; /* of the block, for what uses it up; NULL until it is needed */
    int rate_current;
    double rate[3]; /* of the force on the vessel */
    double *wrenches; /* of a system: rates of forces and moments on vessels, and room for two of them */
    double bent; /* times as much as the exported elements can follow, of the shape at the start; or 0 */
    double stretched; /* strain at such a start, where it is a large one and was not exported; or 0 */
    int leaves; /* such a start may be left by itself, as the exported one may */
    double pressed; /* lowest tension of a start that was found anew, where it presses the line; or 0 */
    /* The run that the errors of this one are estimated by; NULL where that is not asked for. Its
       block counts: inputs, parameters and phase are those of this one. */
    struct Cable *finer;
    int errors_current;
    double errors[2];
    Summary summary;
    double *arcs, *rows;
    char message[300]; /* where a message has numbers in it */
} Cable;

/* The kernels, compiled ahead of time. */
int64_t cablemodel_step(void *block, int64_t words, double t_end, double *inputs, int64_t n);
int64_t cablemodel_equilibrium(void *block, int64_t words, double *frame, int64_t n);
int64_t cablemodel_tension_from_stretch(void *block, int64_t words);
int64_t cablemodel_refine_at_floor(void *block, int64_t words);
int64_t cablemodel_halve_at_rest(void *block, int64_t words, int64_t node);
int64_t cablemodel_measure_bends(void *block, int64_t words, double *out, int64_t n);
int64_t cablemodel_settle(void *block, int64_t words);
int64_t cablemodel_lengths_of_bristles(void *block, int64_t words, double *lengths, int64_t n);
int64_t cablemodel_lay_to_anchors(void *block, int64_t words);
int64_t cablemodel_draw_alike(void *block, int64_t words, double bristle);
int64_t cablemodel_stabilise(void *block, int64_t words);
int64_t cablemodel_choose_bending(void *block, int64_t words);
int64_t cablemodel_place_supports(void *block, int64_t words);
int64_t cablemodel_bodies(void *block, int64_t words, double *out, int64_t m);
int64_t cablemodel_sample(void *block, int64_t words, double *s, int64_t n, double *out, int64_t m);
int64_t cablemodel_summary(void *block, int64_t words, double *out, int64_t n);
int64_t cablemodel_count_growing(void *block, int64_t words, double rate);
int64_t cablemodel_count_swinging(void *block, int64_t words, double rate, double *work, int64_t n);
int64_t cablemodel_measure(void *block, int64_t words, double *lengths, int64_t n, double *facts, int64_t m);
int64_t cablemodel_forget_stabilisation(void *block, int64_t words);
int64_t cablemodel_move_start(void *block, int64_t words, double *move, int64_t n);
int64_t cablemodel_resize_line(void *block, int64_t words, double *lengths, int64_t n, double *facts, int64_t m,
                               double *move, int64_t k);
int64_t cablemodel_resize_lines(void *block, int64_t words, double *lengths, int64_t n, double *places, int64_t m,
                                double *grown, int64_t k);
int64_t cablemodel_worst_of_shape(void *block, int64_t words, double *out, int64_t n);
int64_t cablemodel_ends_apart(void *block, int64_t words, double *out, int64_t n);
int64_t cablemodel_hold_supports(void *block, int64_t words);
int64_t cablemodel_rest_here(void *block, int64_t words);
int64_t cablemodel_count_from_zero(void *block, int64_t words);
int64_t cablemodel_restore_bending(void *block, int64_t words);
int64_t cablemodel_stop_flow(void *block, int64_t words, double *frame, int64_t n);
int64_t cablemodel_to_three_dimensions(void *block, int64_t words);
int64_t cablemodel_drive(void *block, int64_t words, double t_end, double *motion, int64_t n,
                         double *forces, int64_t m, double *angles, int64_t k, double *rates, int64_t r,
                         double *orders, int64_t cuts);
int64_t cablemodel_sample_elements(void *block, int64_t words, double *elements, int64_t n,
                                   double *fractions, int64_t k, double *out, int64_t m);
int64_t cablemodel_frame_motion(void *block, int64_t words, double *motion, int64_t n);
int64_t cablemodel_tension_ranges(void *block, int64_t words, double *elements, int64_t n, double *out,
                                  int64_t m);
int64_t cablemodel_floor_of_line(void *block, int64_t words, double *elements, int64_t n, double *out,
                                 int64_t m);
int64_t cablemodel_parts(void *block, int64_t words, double *bodies, int64_t n, double *frames,
                         int64_t m);
int64_t cablemodel_force_rate(void *block, int64_t words, double last_step, double *out,
                              int64_t n);
int64_t cablemodel_force_response(void *block, int64_t words, double *motion, int64_t n, double *out,
                                  int64_t m);
int64_t cablemodel_wrenches_when_moved(void *block, int64_t words, double length, double *out,
                                       int64_t n);

/* Those of the direct solver, whose block has another magic number. */
int64_t cablemodel_direct_work(void *block, int64_t words, int64_t task, double number,
                               double *inputs, int64_t n);
int64_t cablemodel_direct_bodies(void *block, int64_t words, double *out, int64_t m);
int64_t cablemodel_direct_sample(void *block, int64_t words, double *s, int64_t n, double *out,
                                 int64_t m);
int64_t cablemodel_direct_summary(void *block, int64_t words, double *out, int64_t n);

/* direct.c */
static inline int is_direct(const int64_t *I) { return header(I)->magic == DIRECT_MAGIC; }
const char *check_direct_block(const int64_t *I, int64_t image_words, int64_t block_words);
int64_t direct_nodes(const int64_t *I);
int64_t direct_word(const int64_t *I, const Parameter *p);
int64_t direct_step(Cable *cable, double t_end, double *inputs);
int64_t direct_settle(Cable *cable);
void direct_rows(Cable *cable);
typedef struct { /* what a status means, and what to do about it */
    int64_t status;
    const char *problem, *advice;
} Failure;
void look_up(const Failure *failures, int64_t status, const char **problem, const char **advice);
double direct_failure(const Cable *cable, int64_t status, const char **problem,
                      const char **advice);

/* system.c */
static inline int is_system(const int64_t *I) { return !is_direct(I) && header(I)->parts != 0; }
const char *check_parts(const int64_t *I);
const char *load_system(Cable *cable, const int64_t *section, int64_t words, const int64_t *image);
void free_system(System *system);
int reserve_elements(Cable *cable, int64_t capacity);
void restart_system(Cable *cable);
void system_changed(System *system);
const char *check_part_inputs(const Cable *cable, void *values);
PartInput *part_input(const Cable *cable, unsigned vr);
double *part_slope(const Cable *cable, unsigned vr);
int64_t *part_choice(const Cable *cable, unsigned vr);
void choose_for_part(Cable *cable, unsigned vr, int64_t value);
const char *name_in_system(const Cable *cable, unsigned vr);
const char *read_part(Cable *cable, unsigned vr, double *value);
const char *check_part_value(const Cable *cable, unsigned vr, double value, double *minimum,
                             double *maximum);
void mark_part_set(Cable *cable, unsigned vr, int derivative);
VesselStart *vessel_starts(const Cable *cable);
VesselStart scene_start(const Cable *cable, int64_t vessel);
int set_system_start(Cable *cable, unsigned vr, double value);
const char *more_than_a_turn(Cable *cable);
void name_vessel(const Cable *cable, int64_t vessel, char *name, size_t size);
int velocity_set(const Cable *cable, int64_t vessel);
const char *ignored_part_input(Cable *cable, unsigned vr);
const char *idle_winch(Cable *cable, int *inward);
const char *first_jump_of_parts(Cable *cable, double dt);
const char *zero_part_input(const Cable *cable, int64_t n);
int64_t step_system(Cable *cable, double t_end, double dt);
int64_t vessels_of(const Cable *cable);
int motion_of(const Cable *cable, unsigned vr, MotionInput *found);

/* system_outputs.c */
int same_parts(const Cable *cable, const Cable *finer);
int64_t wrench_of(const Cable *cable, unsigned vr);
void read_wrenches(Cable *cable, int64_t *block, double *to);
void explain_in_system(const Cable *cable, const char *problem, const char *advice, char *message,
                       size_t size);

/* model_file.c: every function returns NULL or a message. */
const char *load_cable(Cable *cable, const char *resource_location, const char *guid);
void free_cable(Cable *cable);
const char *check_block(const int64_t *I, int64_t image_words, int64_t block_words);
int check_winches(const int64_t *I, int64_t cables, int64_t nodes);
uint32_t checksum(const void *data, size_t bytes);

/* room.c */
int reserve(Cable *cable, int64_t words, int64_t capacity);
int make_room(Cable *cable, int64_t capacity);
int grow(Cable *cable);
void lay_out_as(Cable *cable, const int64_t *image);
void take_exported(Cable *cable);
int64_t step_block(Cable *cable, double t_end, double *inputs);

/* cable.c */
const int64_t *initial_image(const Cable *cable);
void outputs_changed(Cable *cable);
void restart_cable(Cable *cable);
void restore_exported(Cable *cable);
double cable_time(const Cable *cable);
int is_beside(const Cable *cable);
const char *first_jump(Cable *cable, double dt);
int is_zero(const double *vector);
int turns(const Cable *cable, int64_t winch);
const char *zero_input(const Cable *cable, int64_t n);
int is_idle(Cable *cable);
int is_shortest(const Cable *cable);
const Summary *summary(Cable *cable);
int64_t step_cable(Cable *cable, double t_end, double dt, char *message, size_t size);
const char *name_of(const Cable *cable, unsigned vr);
const int64_t *choice_of(Cable *cable, unsigned vr);
void choose(Cable *cable, unsigned vr, int64_t value);
double *slope_of(Cable *cable, unsigned vr);
void clear_slopes(Cable *cable);
double value_at_end(const Controls *now, const double *slope, double value, const double *before,
                    double dt);
double distance_from(const double *start, const double *velocity, const double *reached, double dt);
double place_at_end(const Controls *now, const double *slope, double value, double rate,
                    const double *rate_before, double dt);
const char *read_value(Cable *cable, unsigned vr, double *value);
int64_t driven(const Cable *cable);
int64_t vessel_input(const Cable *cable);
int64_t inputs_of(unsigned vr);
void mark_set(Cable *cable, unsigned vr, int derivative);
const char *check_value(Cable *cable, unsigned vr, double value);
void write_value(Cable *cable, unsigned vr, double value);

/* derivatives.c */
const char *rate_of(Cable *cable, unsigned vr, double *value);
const char *response_of(Cable *cable, const unsigned unknown[], size_t unknowns,
                        const unsigned known[], size_t knowns, const double change[],
                        double response[]);

/* lengths.c */
int lengths_changed(const Cable *cable);
double *lengths_between(const Cable *cable, double from, double to);
int64_t line_out_of_reach(Cable *cable, double *length, double *apart);
const Parameter *first_changed(const Cable *cable);
int differs(const double *a, const double *b);
void frame_of_rest(const Cable *cable, double frame[3]);
const char *settle_line(Cable *cable);

/* start.c */
typedef struct { /* the most that an element bends, in what it can follow, and stretches */
    double bent, stretched;
} Shape;
Shape shape_of(const Cable *cable);
void judge_shape(Cable *cable, const Shape *before);
int64_t *copy_of_image(const Cable *cable);
void give_back(Cable *cable, const int64_t *image);
const char *judge_growth(Cable *cable, const char *changed);
const char *settle_cable(Cable *cable);

/* system_start.c */
const char *settle_system(Cable *cable);

/* saved_state.c */
size_t state_bytes(const Cable *cable);
size_t bytes_of_state(const void *state);
void save_state(const Cable *cable, void *to);
void write_state(const Cable *cable, const void *state, char *bytes);
const char *check_state(const Cable *cable, const void *from, size_t bytes);
const char *restore_state(Cable *cable, const void *from);

#endif
