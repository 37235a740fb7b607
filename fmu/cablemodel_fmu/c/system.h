/* A system as system.c and system_outputs.c know it. */
#ifndef SYSTEM_H
#define SYSTEM_H

#include "cable.h"

enum { OF_VESSEL = 12, OF_FREE_BODY = 6 };
/* Groups of three among a vessel's inputs, and their bits. */
enum { AT_POSITION = 0, AT_VELOCITY = 3, AT_ATTITUDE = 6, AT_RATE = 9 };
enum { GIVEN_ALL = GIVEN_POSITION | GIVEN_VELOCITY | GIVEN_ATTITUDE | GIVEN_RATE };
/* Outputs of a line, but for those of its stations, and of each station; of a body, of a vessel. */
enum { LINE_OUTPUTS = 9, STATION_OUTPUTS = 5, BODY_OUTPUTS = 12, VESSEL_OUTPUTS = 18, WINCH_OUTPUTS = 3, FLOOR_OUTPUTS = 8 };
enum { LINE_ERRORS = 2, BODY_ERRORS = 1 }; /* the last ones, where errors are estimated */

enum { TOLD_IGNORED = 1, TOLD_IDLE = 2, TOLD_SHORTEST = 4 };
enum { ROW_WORDS = sizeof(PartRow) / 8 };

typedef struct {
    int64_t by, given; /* which inputs move a vessel, and whether the master has said so */
} Choice;

typedef struct {
    double start; /* arc length along its line [m] */
    int64_t node, line;
} Element;

struct System {
    int64_t lines, inputs, vessels, bodies, foils, winches, cuts, outputs;
    const PartRow *rows;
    const int64_t *segments;
    char *told; /* of each input: TOLD_IGNORED: it is set and does nothing; TOLD_IDLE: its drum is empty, ... */
    int current; /* the numbers below are those of the state */
    double *values;
    Element *elements;
    int64_t *counts; /* elements of each line */
    double *nodes, *fractions;
    PartMotion *parts; /* of bodies, then of vessels */
    Station *samples;
    double *motion, *forces, *angles, *rates, *orders, *kept; /* of a step */
    double *ranges; /* of elements in order: their nodes, then lowest and highest tension of each */
    double *own; /* how vessels move as it begins: FRAME_INPUTS of each */
    int64_t applied;                                          /* words of `applied_in` */
};

/* Rows of what moves vessels, of their starts, of lines, of bodies. */
static inline int64_t first_start(const System *s) { return s->inputs + s->vessels; }
static inline int64_t first_line(const System *s) { return first_start(s) + START_WORDS * s->vessels; }
static inline int64_t named_rows(const System *s) { return first_line(s) + s->lines + s->bodies; }

/* Rows of a first shape. */
static inline StringItem *string_items(const double *shape) {
    return AS(StringItem, shape + SHAPE_WORDS + STRING_LINE_WORDS * (int64_t)AS(FirstShape, shape)->lines);
}
static inline StringBody *string_bodies(const double *shape) {
    return AS(StringBody, string_items(shape) + (int64_t)AS(FirstShape, shape)->items);
}
static inline StringEnd *string_ends(const double *shape) {
    return AS(StringEnd, string_bodies(shape) + (int64_t)AS(FirstShape, shape)->bodies);
}

/* All outputs in the order of the table of variables; system_outputs.c. */
const double *system_outputs(Cable *cable);

#endif
