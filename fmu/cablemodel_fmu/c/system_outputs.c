/* What is read of a system: its lines, bodies, vessels, winches and cuts, in the order of the table
   of variables. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "system.h"

static int64_t segment_of(const Cable *cable, int64_t node) {
    return (int64_t)edge_of(cable->I, node)->segment;
}

static double length_of(const Cable *cable, int64_t node) {
    return edge_of(cable->I, node)->length;
}

static int is_backward(const Cable *cable, int64_t node) {
    return (int)(cable->system->segments[segment_of(cable, node)] & 1);
}

/* What winches have paid out at the beginning and at the end of a line, as Built.paid. */
static void paid_at(const Cable *cable, int64_t line, double paid[2]) {
    paid[0] = paid[1] = 0.0;
    for (int64_t n = 0; n < cable->system->winches; n++) {
        const Winch *winch = winch_of(cable->I, n);
        const int64_t segment = cable->system->segments[(int64_t)winch->cable];
        const int at_end = (winch->way > 0.0) == (int)(segment & 1);
        if (segment >> 1 == line) paid[at_end] += winch->paid;
    }
}

/* The element of a node, as Built.elements of cablemodel/systems/built.py has it. */
static Element element_of(const Cable *cable, int64_t node) {
    const double own = edge_of(cable->I, node)->start;
    const double start = is_backward(cable, node) ? -own - length_of(cable, node) : own;
    const int64_t line = cable->system->segments[segment_of(cable, node)] >> 1;
    double paid[2];
    paid_at(cable, line, paid);
    return (Element){start + paid[0], node, line};
}

static int by_line_and_place(const void *one, const void *other) {
    const Element *a = one, *b = other;
    if (a->line != b->line) return a->line < b->line ? -1 : 1;
    if (a->start != b->start) return a->start < b->start ? -1 : 1;
    return a->node < b->node ? -1 : a->node > b->node;
}

static int64_t gather_elements(Cable *cable) {
    const int64_t *joint = cable->I + header(cable->I)->joint;
    Element *elements = cable->system->elements;
    int64_t count = 0;
    for (int64_t node = 1; node < header(cable->I)->nodes; node++)
        if (joint[node] == JOINT_NONE) elements[count++] = element_of(cable, node);
    qsort(elements, (size_t)count, sizeof *elements, by_line_and_place);
    return count;
}

/* Of the line of an element [m]; and what was paid out at its beginning. */
static double line_length(const Cable *cable, const Element *first, double *before) {
    double paid[2];
    paid_at(cable, first->line, paid);
    *before = paid[0];
    return cable_of(cable->I, segment_of(cable, first->node))->line + paid[0] + paid[1];
}

/* Where along a line: the element and the fraction of it, as LineView.sample. */
static void place_sample(const Cable *cable, const Element *elements, int64_t count, int64_t *which,
                         double s, double *node, double *fraction) {
    while (*which + 1 < count && elements[*which + 1].start <= s) ++*which;
    const Element *found = elements + *which;
    double x = (s - found->start) / length_of(cable, found->node);
    x = x < 0.0 ? 0.0 : x > 1.0 ? 1.0 : x;
    *node = (double)found->node;
    *fraction = is_backward(cable, found->node) ? 1.0 - x : x;
}

/* Places to sample of all lines: of each its beginning, its end, then stations. */
static int64_t place_samples(const Cable *cable, int64_t elements) {
    const System *s = cable->system;
    int64_t placed = 0;
    for (int64_t first = 0, next; first < elements; first = next) {
        const Element *own = s->elements + first;
        next = first;
        while (next < elements && s->elements[next].line == own->line) next++;
        const int64_t count = next - first;
        double before_it = 0.0;
        const double length = line_length(cable, own, &before_it);
        s->nodes[placed] = (double)own->node;
        s->fractions[placed++] = is_backward(cable, own->node) ? 1.0 : 0.0;
        int64_t which = 0;
        place_sample(cable, own, count, &which, length, s->nodes + placed, s->fractions + placed);
        placed++;
        s->counts[own->line] = count;
        which = 0;
        for (int64_t k = 0; k < cable->stations; k++, placed++)
            place_sample(cable, own, count, &which,
                         length * (double)k / (double)(cable->stations - 1), s->nodes + placed,
                         s->fractions + placed);
    }
    return placed;
}

/* Outputs of a line from the rows of its samples, which `place_samples` put in order, and from the
   lowest and highest tensions of its elements. */
static double *line_outputs(const Cable *cable, int64_t number, const Station *rows, const double *ranges,
                            int64_t count, double *out) {
    double low = ranges[0], high = ranges[1];
    for (int64_t n = 1; n < count; n++) {
        if (!(ranges[2 * n] >= low)) low = ranges[2 * n];
        if (!(ranges[2 * n + 1] <= high)) high = ranges[2 * n + 1];
    }
    *out++ = rows[0].tension;
    *out++ = rows[1].tension;
    *out++ = low;
    *out++ = high;
    const Line *line = line_of(cable->I, number);
    *out++ = line->total;
    *out++ = line->longest;
    *out++ = line->since + cable->now.start_time;
    *out++ = line->first;
    *out++ = line->last;
    const int64_t stations = cable->stations;
    rows += 2;
    for (int64_t k = 0; k < stations; k++, out += 3)
        memcpy(out, rows[k].position, sizeof rows[k].position);
    for (int64_t k = 0; k < stations; k++) *out++ = rows[k].tension;
    for (int64_t k = 0; k < stations; k++) *out++ = rows[k].curvature;
    return out;
}

/* How all bodies and vessels move, of the block or a copy of it, into `parts`. */
static void read_parts(Cable *cable, int64_t *block) {
    System *s = cable->system;
    cablemodel_parts(block, cable->block_words, (double *)s->parts, PART_WORDS * s->bodies,
                     (double *)(s->parts + s->bodies), PART_WORDS * s->vessels);
}

/* Position, attitude, velocity, angular velocity; of a vessel also force and moment. */
static double *part_outputs(const PartMotion *part, int with_wrench, double *out) {
    const double *const vectors[] = {part->position, part->attitude, part->velocity,
                                     part->angular_velocity};
    for (int n = 0; n < 4; n++, out += 3) memcpy(out, vectors[n], 3 * sizeof(double));
    if (!with_wrench) return out;
    memcpy(out, part->wrench, sizeof part->wrench);
    return out + WRENCH_WORDS;
}

/* The elements of a line among all, in order: how many from the first. */
static int64_t elements_of(const System *s, int64_t elements, int64_t line, int64_t *first) {
    int64_t next = 0;
    while (next < elements && s->elements[next].line != line) next++;
    *first = next;
    while (next < elements && s->elements[next].line == line) next++;
    return next - *first;
}

/* Rows of a line at the places where errors are looked for, of one that is as long [m]. */
static void sample_errors(Cable *cable, int64_t first, int64_t count, double length, Station *rows) {
    double nodes[ERROR_PLACES], fractions[ERROR_PLACES];
    int64_t which = 0;
    for (int k = 0; k < ERROR_PLACES; k++)
        place_sample(cable, cable->system->elements + first, count, &which,
                     (0.5 - 0.5 * cos(PI * k / (ERROR_PLACES - 1))) * length, nodes + k, fractions + k);
    cablemodel_sample_elements(cable->I, cable->block_words, nodes, ERROR_PLACES, fractions,
                               ERROR_PLACES, (double *)rows, STATION_WORDS * ERROR_PLACES);
}

static double apart(const double *one, const double *other) {
    double square = 0.0;
    for (int i = 0; i < 3; i++) square += (one[i] - other[i]) * (one[i] - other[i]);
    return sqrt(square);
}

/* What the floor does to each line: LineView.on_floor. Uses the nodes in `ranges` up. */
static double *floor_outputs(Cable *cable, int64_t elements, double *out) {
    System *s = cable->system;
    Summary found;
    for (int64_t line = 0; line < s->lines; line++) {
        int64_t first = 0;
        const int64_t count = elements_of(s, elements, line, &first);
        cablemodel_floor_of_line(cable->I, cable->block_words, s->ranges + first, count, (double *)&found,
                                 SUMMARY_WORDS);
        memcpy(out, found.touchdown_position, 3 * sizeof(double));
        out[3] = found.touchdown_reaction;
        memcpy(out + 4, found.floor_force, 3 * sizeof(double));
        out[7] = found.floor_length;
        out += FLOOR_OUTPUTS;
    }
    return out;
}

/* What lines and bodies may be wrong by: SystemModel.errors; bodies: rows of the parts of this run. */
static void error_outputs(Cable *cable, int64_t elements, const PartMotion *bodies, double *out) {
    System *s = cable->system;
    for (int64_t n = 0; n < s->lines * LINE_ERRORS + s->bodies * BODY_ERRORS; n++) out[n] = NAN;
    if (!is_beside(cable)) return;
    Cable *finer = cable->finer;
    System *other = finer->system;
    const int64_t others = gather_elements(finer);
    Station shapes[2][ERROR_PLACES];
    double unused;
    for (int64_t line = 0; line < s->lines; line++, out += LINE_ERRORS) {
        int64_t first = 0, finest = 0;
        const int64_t count = elements_of(s, elements, line, &first);
        const int64_t more = elements_of(other, others, line, &finest);
        const double length = fmin(line_length(cable, s->elements + first, &unused),
                                   line_length(finer, other->elements + finest, &unused));
        sample_errors(cable, first, count, length, shapes[0]);
        sample_errors(finer, finest, more, length, shapes[1]);
        double largest = 0.0, pull = 0.0;
        for (int k = 0; k < ERROR_PLACES; k++) {
            const double off = apart(shapes[0][k].position, shapes[1][k].position);
            if (!(off <= largest)) largest = off; /* NaN, too */
        }
        for (int k = 0; k < ERROR_PLACES; k += ERROR_PLACES - 1) {
            const double off = fabs(shapes[0][k].tension - shapes[1][k].tension);
            if (!(off <= pull)) pull = off;
        }
        out[0] = ERROR_FACTOR * largest;
        out[1] = ERROR_FACTOR * pull;
    }
    read_parts(finer, finer->I);
    for (int64_t n = 0; n < s->bodies; n++)
        out[n] = ERROR_FACTOR * apart(bodies[n].position, other->parts[n].position);
}

/* Whether the finer run is of a system with the same parts. */
int same_parts(const Cable *cable, const Cable *finer) {
    const System *one = cable->system, *other = finer->system;
    if (one == NULL || other == NULL) return one == other;
    return one->lines == other->lines && one->vessels == other->vessels && one->bodies == other->bodies &&
           one->foils == other->foils && one->winches == other->winches && one->cuts == other->cuts;
}

/* All outputs in the order of the table of variables. */
const double *system_outputs(Cable *cable) {
    System *s = cable->system;
    if (s->current) return s->values;
    const int64_t elements = gather_elements(cable), samples = place_samples(cable, elements);
    cablemodel_sample_elements(cable->I, cable->block_words, s->nodes, samples, s->fractions,
                               samples, (double *)s->samples, STATION_WORDS * samples);
    double *out = s->values, *ranges = s->ranges + elements;
    for (int64_t n = 0; n < elements; n++) s->ranges[n] = (double)s->elements[n].node;
    cablemodel_tension_ranges(cable->I, cable->block_words, s->ranges, elements, ranges, 2 * elements);
    const Station *rows = s->samples;
    for (int64_t first = 0, next; first < elements; first = next) {
        next = first;
        while (next < elements && s->elements[next].line == s->elements[first].line) next++;
        const int64_t line = s->elements[first].line, count = s->counts[line];
        out = line_outputs(cable, line, rows, ranges + 2 * first, count, out);
        rows += 2 + cable->stations;
    }
    read_parts(cable, cable->I);
    for (int64_t n = 0; n < s->bodies + s->vessels; n++)
        out = part_outputs(s->parts + n, n >= s->bodies, out);
    for (int64_t n = 0; n < s->winches; n++) {
        const Winch *winch = winch_of(cable->I, n);
        double paid[2];
        paid_at(cable, s->segments[(int64_t)winch->cable] >> 1, paid);
        *out++ = winch->rate;
        *out++ = cable_of(cable->I, (int64_t)winch->cable)->line + paid[0] + paid[1];
        *out++ = winch->paid_most - winch->paid;
    }
    for (int64_t n = 0; n < s->cuts; n++) {
        const double time = cable->M[header(cable->I)->cuts + n * CUT_WORDS + WORD(Cut, done)];
        *out++ = time < 1e300 ? time + cable->now.start_time : NAN;
    }
    if (header(cable->I)->floor_kind != 0) out = floor_outputs(cable, elements, out);
    if (cable->flags & FLAG_ESTIMATE) error_outputs(cable, elements, s->parts, out);
    s->current = 1;
    return s->values;
}

/* Where an output is among the forces and moments on vessels, WRENCH_WORDS of each; -1: elsewhere. */
int64_t wrench_of(const Cable *cable, unsigned vr) {
    const System *s = cable->system;
    const int64_t first = s->lines * (LINE_OUTPUTS + STATION_OUTPUTS * cable->stations) + s->bodies * BODY_OUTPUTS;
    const int64_t n = (int64_t)vr - VR_SYSTEM_OUTPUT - first;
    if (!within(n, 0, s->vessels * VESSEL_OUTPUTS - 1)) return -1;
    const int64_t word = n % VESSEL_OUTPUTS - (VESSEL_OUTPUTS - WRENCH_WORDS);
    return word < 0 ? -1 : n / VESSEL_OUTPUTS * WRENCH_WORDS + word;
}

/* The forces and moments of all vessels, of the block or a copy of it. */
void read_wrenches(Cable *cable, int64_t *block, double *to) {
    System *s = cable->system;
    read_parts(cable, block);
    for (int64_t n = 0; n < s->vessels; n++)
        memcpy(to + WRENCH_WORDS * n, s->parts[s->bodies + n].wrench, WRENCH_WORDS * sizeof(double));
}

/* Where a step failed: Built.where of cablemodel/systems/built.py. */
void explain_in_system(const Cable *cable, const char *problem, const char *advice, char *message,
                       size_t size) {
    const System *s = cable->system;
    const int64_t *I = cable->I, *joint = I + header(I)->joint;
    const int64_t last = header(I)->nodes - 1, failed = I[header(I)->failed];
    const int64_t node = failed < last ? failed : last;
    const PartRow *lines = s->rows + first_line(s), *bodies = lines + s->lines;
    for (int64_t n = 0; n < s->bodies; n++)
        if (cable->M[header(I)->free_bodies + n * FREE_WORDS + WORD(FreeBody, node)] == (double)node) {
            snprintf(message, size, "at t = %g s, %s: %s; %s", cable_time(cable), bodies[n].name,
                     problem, advice);
            return;
        }
    int64_t place = 0;
    for (int64_t k = 1; k <= last && (place == 0 || place < node); k++)
        if (joint[k] == JOINT_NONE) place = k;
    const Element found = element_of(cable, place);
    double arc = found.start;
    if ((place == node) != is_backward(cable, place)) arc += length_of(cable, place);
    snprintf(message, size, "at t = %g s, %s at %g m: %s; %s", cable_time(cable),
             lines[found.line].name, arc, problem, advice);
}
