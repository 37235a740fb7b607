/* Lengths of the cables of a system's lines, and on its drums, set before the start.

   What cablemodel/systems/tables.py makes of a scene's lengths is made of new ones here: elements keep
   their number and are scaled with their cable, from one share of the way to another one, as
   system_start.c goes along it. Parameters are in the order of the cables of each line, from its
   beginning, and in that in which they leave a drum, whose winch is their word. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "system.h"

static int64_t line_of_row(const Cable *cable, int64_t row) { return cable->system->segments[row] >> 1; }
static int is_backward(const Cable *cable, int64_t row) { return (int)(cable->system->segments[row] & 1); }

static int is_of_line(const Cable *cable, int64_t n, int64_t line) {
    const Parameter *p = &cable->parameters[n];
    return p->kind == OF_LINE && line_of_row(cable, p->index) == line;
}

static double line_length(const Cable *cable, int64_t line, double share) {
    double sum = 0.0;
    for (int64_t n = 0; n < cable->parameter_count; n++)
        if (is_of_line(cable, n, line)) sum += length_at(cable, n, share);
    return sum;
}

/* Whether a winch is at the beginning of its line. */
static int is_at_start(const Cable *cable, int64_t winch) {
    const Winch *row = winch_of(cable->I, winch);
    return (row->way > 0.0) != is_backward(cable, (int64_t)row->cable);
}

/* Whether a parameter is of a line's cable, or of one on the drum at an end of it. */
static int is_on(const Cable *cable, int64_t n, int64_t line, int drum, int at_start) {
    const Parameter *p = &cable->parameters[n];
    if (!drum) return is_of_line(cable, n, line);
    return p->kind == OF_DRUM && line_of_row(cable, p->index) == line &&
           is_at_start(cable, p->word) == at_start;
}

/* Where a place among those, from the first one on, goes from one share of the way to another one. */
static double moved_along(const Cable *cable, int64_t line, int drum, int at_start, double place, double from,
                          double to) {
    double before = 0.0, after = 0.0;
    for (int64_t n = 0; n < cable->parameter_count; n++) {
        if (!is_on(cable, n, line, drum, at_start)) continue;
        const double one = length_at(cable, n, from), other = length_at(cable, n, to);
        if (place <= before + one * (1.0 + SAME_PLACE))
            return one == other ? after + (place - before) : after + other * ((place - before) / one);
        before += one;
        after += other;
    }
    return after + (place - before);
}

/* Where an arc length along a line, or beyond its ends on drums, goes. */
static double moved(const Cable *cable, int64_t line, double arc, double from, double to) {
    const double before = line_length(cable, line, from);
    if (arc < 0.0) return -moved_along(cable, line, 1, 1, -arc, from, to);
    if (arc <= before * (1.0 + SAME_PLACE)) return moved_along(cable, line, 0, 0, arc, from, to);
    return line_length(cable, line, to) + moved_along(cable, line, 1, 0, arc - before, from, to);
}

/* The same as the tree counts it: negative where it goes backward along the line. */
static double moved_in_tree(const Cable *cable, int64_t row, double place, double from, double to) {
    const int64_t line = line_of_row(cable, row);
    return is_backward(cable, row) ? -moved(cable, line, -place, from, to) : moved(cable, line, place, from, to);
}

/* The first parameter of a row of the cable table: of the line's cable, or of the drum's; -1: none. */
static int64_t length_of_row(const Cable *cable, int64_t row) {
    for (int64_t n = 0; n < cable->parameter_count; n++)
        if (cable->parameters[n].kind >= OF_LINE && cable->parameters[n].index == row) return n;
    return -1;
}

static double growth_of_row(const Cable *cable, int64_t row, double from, double to) {
    const int64_t n = length_of_row(cable, row);
    return n < 0 ? 1.0 : length_at(cable, n, to) / length_at(cable, n, from);
}

/* Elements as they pass the winches of a chain: fill_chain of cablemodel/systems/tables.py. Returns how
   much cable is out. */
static double arrange_chain(Cable *cable, double chain, double from, double to) {
    const int64_t *I = cable->I, *joint = I + header(I)->joint;
    double out = 0.0;
    for (int64_t index = 0; index < header(I)->cable_count; index++) {
        CableRow *row = cable_of(cable->I, index);
        const int64_t line = line_of_row(cable, index), n = length_of_row(cable, index);
        double own = 0.0;
        if (row->chain != chain) continue;
        for (int64_t node = 1; node < header(I)->nodes; node++)
            if (joint[node] == JOINT_NONE && edge_of(cable->I, node)->segment == (double)index)
                own += edge_of(cable->I, node)->length;
        out += own;
        if (n < 0) continue;
        /* Cable on a drum leaves it in elements of the line's mean length, unless the scene counts its. */
        const int usual = own == 0.0 && cable->parameters[n].reach == 0.0;
        row->nominal *= usual ? line_length(cable, line, to) / line_length(cable, line, from)
                              : growth_of_row(cable, index, from, to);
        row->edge.nominal = row->nominal;
        row->shortest = SHORTEST_PIECE * fmin(row->nominal, length_at(cable, n, to));
    }
    return out;
}

/* fill_winches of cablemodel/systems/tables.py. */
static void arrange_winches(Cable *cable, double from, double to) {
    const int64_t *I = cable->I;
    for (int64_t winch = 0; winch < header(I)->winch_count; winch++) {
        Winch *row = winch_of(I, winch);
        const double chain = cable_of(cable->I, (int64_t)row->cable)->chain;
        int done = 0; /* both ends of a line pass the same cable */
        for (int64_t n = 0; n < winch; n++) done |= cable_of(cable->I, (int64_t)winch_of(I, n)->cable)->chain == chain;
        const double out = arrange_chain(cable, chain, done ? to : from, to);
        const Edge *top = edge_of(cable->I, (int64_t)row->node + (row->way > 0.0));
        double drum = 0.0;
        for (int64_t n = 0; n < cable->parameter_count; n++)
            if (cable->parameters[n].kind == OF_DRUM && cable->parameters[n].word == winch) drum += length_at(cable, n, to);
        row->start = row->way > 0.0 ? top->start : top->start + top->length;
        row->top_length = top->length;
        row->travel_most = row->paid_most = drum;
        row->shortest = SHORTEST_LINE * line_length(cable, line_of_row(cable, (int64_t)row->cable), to);
        row->travel_least = row->paid_least = fmin(0.0, row->shortest - out);
    }
}

/* All that is counted along the lines, from one share of the way to another one; by how much chords
   between nodes at `places` (6 words of each) grow: 3 words of each node. */
void resize_lines(Cable *cable, double from, double to, const double *places, double *grown) {
    const int64_t *I = cable->I, *joint = I + header(I)->joint, *parent = I + header(I)->parent;
    if (!lengths_changed(cable)) return;
    for (int64_t node = 1; node < header(I)->nodes; node++) {
        Edge *edge = edge_of(cable->I, node);
        if (joint[node] != JOINT_NONE) continue;
        const int64_t row = (int64_t)edge->segment;
        const double growth = growth_of_row(cable, row, from, to);
        for (int i = 0; i < 3; i++)
            grown[3 * node + i] = (growth - 1.0) * (places[6 * node + i] - places[6 * parent[node] + i]);
        edge->start = moved_in_tree(cable, row, edge->start, from, to);
        edge->length *= growth;
        edge->nominal *= growth;
    }
    for (int64_t index = 0; index < header(I)->cable_count; index++) {
        CableRow *row = cable_of(cable->I, index);
        row->leaves = moved_in_tree(cable, index, row->leaves, from, to);
        row->line = line_length(cable, line_of_row(cable, index), to);
    }
    arrange_winches(cable, from, to);
}

/* What perfectly flexible cable bends by where it is slack over a floor: least_bending of
   cablemodel/solvers/finite_element/start/sea_floor.py. */
static void bend_flexible(Cable *cable, double longer) {
    const int64_t *I = cable->I, nodes = header(I)->nodes;
    const double density = scalars(cable->M)->water_density;
    for (int64_t n = 1; n < nodes + header(I)->cable_count; n++) {
        Edge *edge = n < nodes ? edge_of(cable->I, n) : &cable_of(cable->I, n - nodes)->edge;
        if (edge->flexible == 0.0 || !(edge->bending_full > 0.0)) continue;
        const double displaced = cable_of(cable->I, (int64_t)edge->segment)->displaced;
        const double thick = density > 0.0 ? sqrt(displaced / (density * 0.25 * PI)) : 0.0;
        const double layer = pow(edge->bending_full / edge->contact, 1.0 / 3.0);
        edge->bending_full = edge->contact * pow(fmax(layer * longer, thick), 3.0);
        edge->bending = edge->bending_full;
    }
}

/* What follows from the lengths that are set: fill_settings_of of cablemodel/systems/tables.py. */
void measure_lines(Cable *cable) {
    LineFacts facts;
    Scalars *state = scalars(cable->M);
    double shortest = INFINITY;
    const double memory = state->memory, before = state->length;
    if (!lengths_changed(cable)) return;
    memcpy(&facts, cable->file + F_FACTS, sizeof facts);
    facts.damping = INFINITY;
    facts.length = facts.softness = 0.0;
    for (int64_t line = 0; line < cable->system->lines; line++) {
        double length = 0.0, softness = 0.0, drag = 0.0, mass = 0.0, weight = 0.0;
        for (int64_t n = 0; n < cable->parameter_count; n++) {
            const Parameter *p = &cable->parameters[n];
            if (!is_of_line(cable, n, line)) continue;
            const double own = length_at(cable, n, 1.0), longer = own - p->start;
            const Edge *edge = &cable_of(cable->I, p->index)->edge;
            const double dry = edge->mass - edge->added_mass;
            length += own;
            softness += edge->compliance * own;
            drag += 2.0 * edge->drag_normal * own;
            mass += dry * own;
            weight += p->factor * own;
            facts.mass += dry * longer;
            facts.tension += p->factor * longer;
        }
        facts.length = fmax(facts.length, length);
        facts.softness = fmax(facts.softness, softness);
        facts.damping = fmin(facts.damping, drag * length / mass);
        shortest = fmin(shortest, length);
        for (int64_t index = 0; index < header(cable->I)->cable_count; index++)
            if (line_of_row(cable, index) == line) cable_of(cable->I, index)->tension = weight;
    }
    cablemodel_measure(cable->I, cable->block_words, (double *)&facts, FACT_WORDS);
    const double longer = facts.length / before;
    state->time_tolerance *= shortest / facts.length;
    state->memory = memory * sqrt(longer);
    if (header(cable->I)->floor_kind == FLOOR_NONE) return;
    state->floor_depth *= longer;
    state->bristle *= longer;
    bend_flexible(cable, longer);
}

/* The line at whose end a node is that is held, or -1. */
static int64_t line_held_at(const Cable *cable, int64_t node) {
    const int64_t *I = cable->I, *joint = I + header(I)->joint;
    if (node == 0 || joint[node] != JOINT_NONE) node++;
    if (node >= header(I)->nodes || joint[node] != JOINT_NONE) return -1;
    return line_of_row(cable, (int64_t)edge_of(cable->I, node)->segment);
}

static Constraint *held(const Cable *cable, int64_t n) {
    return AS(Constraint, cable->M + header(cable->I)->constraints + n * CONSTRAINT_WORDS);
}

/* Why a system cannot have the lengths that are set; NULL: it may. Vessels are where they begin. */
const char *check_lengths(Cable *cable) {
    const int64_t *I = cable->I;
    const System *s = cable->system;
    for (int64_t n = 0; n < header(I)->cut_count; n++) {
        const Cut *cut = AS(Cut, cable->M + header(I)->cuts + n * CUT_WORDS);
        const int64_t line = line_of_row(cable, (int64_t)cut->segment);
        const double length = line_length(cable, line, 1.0);
        if (cut->side != CUT_WITHIN || fabs(cut->arc) < length) continue;
        snprintf(cable->message, sizeof cable->message, "a cut at %g m is beyond %s, which has %g m",
                 fabs(cut->arc), s->rows[first_line(s) + line].name, length);
        return cable->message;
    }
    for (int64_t n = 1; n < header(I)->constraint_count; n++)
        for (int64_t other = 0; other < n; other++) {
            const int64_t ends[] = {(int64_t)held(cable, n)->node, (int64_t)held(cable, other)->node};
            const int64_t line = line_held_at(cable, ends[0]);
            double reach = 0.0, square = 0.0;
            if (line < 0 || line_held_at(cable, ends[1]) != line) continue;
            for (int64_t k = 0; k < cable->parameter_count; k++)
                if (is_of_line(cable, k, line)) reach += cable->values[k] * cable->parameters[k].reach;
            for (int i = 0; i < 3; i++)
                square += pow(cable->M[header(I)->position + 6 * ends[0] + i] -
                              cable->M[header(I)->position + 6 * ends[1] + i], 2.0);
            if (sqrt(square) <= reach) continue;
            snprintf(cable->message, sizeof cable->message, "%s ends %g m apart, out of reach of its %g m",
                     s->rows[first_line(s) + line].name, sqrt(square), line_length(cable, line, 1.0));
            return cable->message;
        }
    return NULL;
}
