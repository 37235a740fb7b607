/* resources/model.bin, and finer.bin beside it: found, read, and not believed until every size and
   offset is checked. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cable.h"

#ifdef _WIN32
#define WIN32_LEAN_AND_MEAN
#include <windows.h>
#endif

/* CRC-32 of IEEE 802.3, as zlib computes it. */
uint32_t checksum(const void *data, size_t bytes) {
    static const uint32_t table[16] = {
        0x00000000, 0x1db71064, 0x3b6e20c8, 0x26d930ac, 0x76dc4190, 0x6b6b51f4, 0x4db26158,
        0x5005713c, 0xedb88320, 0xf00f9344, 0xd6d6a3e8, 0xcb61b38c, 0x9b64c2b0, 0x86d3d2d4,
        0xa00ae278, 0xbdbdf21c};
    const unsigned char *byte = data;
    uint32_t crc = 0xffffffffu;
    for (size_t n = 0; n < bytes; n++) {
        crc ^= byte[n];
        crc = table[crc & 15] ^ (crc >> 4);
        crc = table[crc & 15] ^ (crc >> 4);
    }
    return ~crc;
}

static int hex(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

/* Path of a file in the folder that a file URI (or, leniently, a path) names; to be freed. */
static char *path_of(const char *location, const char *name) {
    const int uri = strncmp(location, "file:", 5) == 0;
    const char *from = uri ? location + 5 : location;
    if (uri && strncmp(from, "//", 2) == 0) {
        from += 2;
        if (strncmp(from, "localhost/", 10) == 0) from += 9;
    }
#ifdef _WIN32
    if (from[0] == '/' && from[1] != 0 && from[2] == ':') from++;
#endif
    char *path = malloc(strlen(from) + strlen(name) + 2);
    if (path == NULL) return NULL;
    size_t length = 0;
    while (*from != 0) {
        if (uri && from[0] == '%' && hex(from[1]) >= 0 && hex(from[2]) >= 0) {
            path[length++] = (char)(16 * hex(from[1]) + hex(from[2]));
            from += 3;
        } else {
            path[length++] = *from++;
        }
    }
    while (length > 1 && path[length - 1] == '/') length--;
    path[length] = '/';
    strcpy(path + length + 1, name);
    return path;
}

static FILE *open_file(const char *path) {
#ifdef _WIN32
    const int count = MultiByteToWideChar(CP_UTF8, 0, path, -1, NULL, 0);
    wchar_t *wide = malloc(sizeof(wchar_t) * (size_t)(count > 0 ? count : 1));
    if (wide == NULL) return NULL;
    FILE *file = NULL;
    if (MultiByteToWideChar(CP_UTF8, 0, path, -1, wide, count) > 0) file = _wfopen(wide, L"rb");
    free(wide);
    return file;
#else
    return fopen(path, "rb");
#endif
}

static const char *read_file(const char *path, int64_t **words, int64_t *count) {
    FILE *file = open_file(path);
    if (file == NULL) return "cannot be opened";
    const char *problem = "cannot be read";
    if (fseek(file, 0, SEEK_END) == 0) {
        const int64_t size = ftell(file);
        if (size < (int64_t)sizeof(FileHeader) || size % 8 != 0 || size > LARGEST_FILE) {
            problem = "truncated or not a model";
        } else if (fseek(file, 0, SEEK_SET) == 0) {
            *words = malloc((size_t)size);
            *count = size / 8;
            if (*words == NULL) problem = "out of memory";
            else if (fread(*words, 1, (size_t)size, file) == (size_t)size) problem = NULL;
        }
    }
    fclose(file);
    return problem;
}

/* Whether a real of the block holds a whole number from low to high. */
static int all_finite(const double *values, int count) {
    for (int n = 0; n < count; n++)
        if (!(fabs(values[n]) < 1e100)) return 0;
    return 1;
}

/* The strain curve of a row of the edge table lies in its table, its cable in the cable table. */
static int check_edge(const int64_t *I, const double *edge) {
    const double first = (double)header(I)->strain, last = (double)(header(I)->strain + header(I)->strain_words);
    return whole(AS(Edge, edge)->strain_terms, 1, header(I)->strain_words) &&
           whole(AS(Edge, edge)->strain_offset, header(I)->strain, header(I)->strain + header(I)->strain_words) &&
           AS(Edge, edge)->strain_offset >= first &&
           AS(Edge, edge)->strain_offset + AS(Edge, edge)->strain_terms <= last &&
           whole(AS(Edge, edge)->segment, 0, header(I)->cable_count - 1);
}

/* Whether two images are of one scene, by what there is in them, with whatever room for nodes. */
int same_sizes(const int64_t *image, const int64_t *own) {
    static const int64_t sizes[] = {SIZE_WORDS};
    for (size_t n = 0; n < sizeof sizes / sizeof sizes[0]; n++)
        if (sizes[n] != WORD(Header, capacity) && image[sizes[n]] != own[sizes[n]]) return 0;
    return 1;
}

int check_winches(const int64_t *I, int64_t cables, int64_t nodes) {
    for (int64_t n = 0; n < header(I)->winch_count; n++) {
        const Winch *row = winch_of(I, n);
        if (!whole(row->node, is_system(I) ? -1 : 0, nodes - 1) || !(row->way == 1.0 || row->way == -1.0) ||
            !whole(row->cable, 0, cables - 1) || !whole(row->at_limit, -1, 1) ||
            !whole(row->live, LIVE_NOT, LIVE_RETURNS) || !whole(row->first_rate, 0, header(I)->rate_count) ||
            !whole(row->rates, 0, header(I)->rate_count) ||
            row->first_rate + row->rates > (double)header(I)->rate_count)
            return 0;
        const int64_t top = (int64_t)row->node + (row->way > 0.0);
        if (row->node >= 0.0 && (top < 1 || top >= nodes)) return 0;
    }
    return is_system(I) || header(I)->winch_count == 1;
}

const char *check_block(const int64_t *I, int64_t image_words, int64_t block_words) {
    const double *M = (const double *)I;
    int64_t expected[HEADER_WORDS] = {0};
    int64_t image = 0, words = 0;
    if (image_words < HEADER_WORDS + SCALAR_WORDS) return "the model's image is too short";
    if (is_direct(I)) return check_direct_block(I, image_words, block_words);
    if (header(I)->magic != MAGIC || header(I)->version != VERSION) return "not a model of this version";
    if (!sizes_within(I, LARGEST_COUNT)) return "a size in the model is out of range";
    if (header(I)->capacity < 2 || header(I)->piece_count < 2 || header(I)->depth_count < 1 || header(I)->time_count < 1 ||
        header(I)->cable_count < 1 || header(I)->line_count < 1)
        return "a size in the model is out of range";
    arrange(I, expected, &image, &words);
    if (image != image_words || words != block_words || header(I)->image_words != image ||
        header(I)->byte_count != 8 * words)
        return "the model's sizes do not agree";
    for (int n = 0; n < HEADER_WORDS; n++)
        if (expected[n] != 0 && I[n] != expected[n]) return "an offset in the model is wrong";

    const int64_t nodes = header(I)->nodes;
    if (!within(nodes, 2, header(I)->capacity) || !within(header(I)->dimension, 2, 3) ||
        !within(header(I)->piece, 1, header(I)->piece_count - 1) || !within(header(I)->live, 0, 1) ||
        !within(header(I)->current_kind, 0, 2) || !within(header(I)->order, 3, 4) ||
        !within(header(I)->payout, 0, 1) || !check_winches(I, header(I)->cable_count, nodes) ||
        !within(header(I)->maximum_steps, 1, 10000000) || !within(header(I)->sleep, 0, 1) ||
        !within(header(I)->slack, SLACK_UNKNOWN, SLACK_SOMEWHERE) ||
        !within(header(I)->asleep, 0, nodes - 2) || header(I)->left_out != 0)
        return "a counter in the model is out of range";
    if (header(I)->current_kind == 1 && header(I)->depth_count != 1) return "a counter in the model is out of range";
    if (!within(header(I)->floor_kind, FLOOR_NONE, FLOOR_TABLE) ||
        !within(header(I)->floor_state, FLOOR_FAR, header(I)->floor_kind ? FLOOR_TOUCHED : FLOOR_FAR) || !within(header(I)->floor_columns, 0, LARGEST_COUNT) ||
        !within(header(I)->floor_rows, 0, LARGEST_COUNT) ||
        (header(I)->floor_kind == FLOOR_TABLE &&
         (header(I)->floor_columns < 2 || header(I)->floor_rows < 1 ||
          header(I)->floor_columns + header(I)->floor_rows + 4 * header(I)->floor_columns * header(I)->floor_rows != header(I)->floor_words)))
        return "the model's floor is out of range";
    if (!(fabs(scalars(M)->time) < 1e300) || !(scalars(M)->step > 0.0) || !(scalars(M)->smallest_step > 0.0) ||
        !(scalars(M)->time_tolerance > 0.0))
        return "a time in the model is out of range";
    const int64_t *parent = I + header(I)->parent, *joint = I + header(I)->joint;
    for (int64_t node = 1; node < nodes; node++) {
        const double *edge = M + header(I)->edges + node * EDGE_WORDS;
        const int64_t last = is_system(I) ? JOINT_ROOT_FREE : JOINT_BODY;
        if (!within(parent[node], 0, node - 1) || !within(joint[node], JOINT_NONE, last))
            return "the model's line is not connected";
        if (joint[node] != 0) continue;
        if (!(AS(Edge, edge)->length > 0.0) || !check_edge(I, edge)) return "an element is out of range";
    }
    for (int64_t n = 0; n < header(I)->cable_count; n++) {
        const double *row = M + header(I)->cables + n * CABLE_WORDS;
        const int runs = !is_system(I); /* of a system, cable does not pass a tow point */
        if ((runs && (!whole(AS(CableRow, row)->body, -1, header(I)->body_count - 1) || !(AS(CableRow, row)->nominal > 0.0))) ||
            !whole(AS(CableRow, row)->row, 0, header(I)->line_count - 1) || !check_edge(I, row + WORD(CableRow, edge)))
            return "a cable is out of range";
    }
    for (int64_t n = 0; n < header(I)->line_count; n++)
        if (!whole(line_of(I, n)->winch, -1, header(I)->winch_count - 1))
            return "a line is out of range";
    for (int64_t n = 0; n < header(I)->body_count; n++)
        if (!whole(M[header(I)->bodies + n * BODY_WORDS + WORD(Body, node)], -1, nodes - 1))
            return "a body is at no node";
    int64_t rigid = 0;
    const double head_passing = header(I)->winch_count > 0 ? winch_of(I, 0)->passing_body : 0.0;
    for (int64_t n = 0; n < header(I)->body_count; n++) {
        const double *row = M + header(I)->bodies + n * BODY_WORDS;
        if (AS(Body, row)->length == 0.0) continue;
        const int64_t node = (int64_t)AS(Body, row)->node;
        rigid++;
        if (!(AS(Body, row)->length > 0.0) || !(AS(Body, row)->compliance > 0.0))
            return "a body of finite length is out of range";
        if (node < 0) continue; /* on the drum */
        /* Its clamps read the elements on both sides, but where the line ends with it, or where it
           passes the tow point. */
        const int passing = head_passing == (double)(n + 1);
        if (node < (passing ? 1 : 2) || (passing && node > 1) || joint[node] != JOINT_BODY ||
            parent[node] != node - 1 || (AS(Body, row)->tie == 0.0 && node + 1 >= nodes))
            return "a body of finite length is out of range";
        if (!passing && (joint[node - 1] != JOINT_NONE || parent[node - 1] != node - 2))
            return "a body of finite length is out of range";
    }
    if (header(I)->rigid != rigid || !whole(head_passing, 0, header(I)->body_count))
        return "a body of finite length is out of range";
    if (head_passing != 0.0 &&
        !(M[header(I)->bodies + ((int64_t)head_passing - 1) * BODY_WORDS + WORD(Body, length)] > 0.0 &&
          M[header(I)->bodies + ((int64_t)head_passing - 1) * BODY_WORDS + WORD(Body, node)] == 1.0))
        return "a body of finite length is out of range";
    for (int64_t n = 0; n < header(I)->constraint_count; n++) {
        const double *row = M + header(I)->constraints + n * CONSTRAINT_WORDS;
        if (!whole(AS(Constraint, row)->node, 0, nodes - 1) ||
            !whole(AS(Constraint, row)->kind, HELD_BY_VESSEL, is_system(I) ? HELD_BY_FRAME : HELD_BY_ANCHOR))
            return "a constraint is at no node";
    }
    return is_system(I) ? check_parts(I) : NULL;
}

static const char *check_parameters(const Cable *cable, const int64_t *I) {
    for (int64_t n = 0; n < cable->parameter_count; n++) {
        const Parameter *p = &cable->parameters[n];
        if (p->name[sizeof p->name - 1] != 0) return "a parameter's name is too long";
        if (is_direct(I) && direct_word(I, p) != 0 && fabs(p->factor) < 1e300 &&
            p->minimum <= p->start && p->start <= p->maximum)
            continue;
        if (is_direct(I)) return "a parameter is out of range";
        const int64_t rows[] = {INT64_MAX, header(I)->body_count, header(I)->free_count, header(I)->cable_count, header(I)->cable_count};
        if (!within(p->kind, OF_CABLES, OF_DRUM) || !(fabs(p->factor) < 1e300) ||
            !within(p->index, 0, rows[p->kind] - 1) || !(fabs(p->reach) < 1e300) ||
            !(p->minimum <= p->start && p->start <= p->maximum))
            return "a parameter is out of range";
        if (p->kind >= OF_LINE) {
            if (!(p->minimum > 0.0) || !(p->maximum < 1e300) ||
                (is_system(I) && p->kind == OF_DRUM && !within(p->word, 0, header(I)->winch_count - 1)))
                return "a parameter is out of range";
            continue;
        }
        /* What is no coefficient, such as a length or an index, must stay out of reach. */
        const int coefficient =
            p->kind == OF_FREE
                ? p->word == WORD(FreeBody, buoyancy) || within(p->word, WORD(FreeBody, drag), WORD(FreeBody, drag) + 2)
            : p->kind == OF_BODY
                ? p->word == WORD(Body, drag) || p->word == WORD(Body, drag_axial) || p->word == WORD(Body, weight)
                : p->word == WORD(Edge, drag_normal) || p->word == WORD(Edge, drag_tangential) || p->word == WORD(Edge, weight) ||
                      p->word == WORD(Edge, added_mass);
        if (!coefficient) return "a parameter is out of range";
    }
    return NULL;
}

static const char *check_file(Cable *cable, int64_t count, const char *guid) {
    const FileHeader *file = file_header(cable->file);
    if (file->magic != FILE_MAGIC || file->format != FILE_FORMAT || count < (int64_t)(sizeof *file / 8))
        return "not a model of this version";
    if (file->words != count) return "truncated or too long";
    if ((uint32_t)file->checksum != checksum(&file->kernels, 8 * (size_t)count - offsetof(FileHeader, kernels)))
        return "corrupted (checksum)";
    if (file->kernels != KERNEL_HASH)
        return "made for another version of this library";
    if (guid == NULL || strlen(guid) >= sizeof file->guid || strncmp(file->guid, guid, sizeof file->guid) != 0)
        return "the GUID is not that of this FMU";
    cable->flags = file->flags;
    cable->stations = file->stations;
    cable->parameter_count = file->parameter_count;
    cable->image_words = file->image_words;
    cable->block_words = file->block_words;
    const int64_t most = file->system_words != 0 ? VR_SYSTEM_INPUT : VR_ZERO;
    if (!within(cable->stations, 2, 100000) || !within(cable->parameter_count, 0, most - VR_PARAMETER) ||
        !within(cable->image_words, 1, count) || !within(cable->block_words, 1, LARGEST_FILE / 8))
        return "a size is out of range";
    const int64_t row = (int64_t)(sizeof(Parameter) / 8);
    if (!within(file->system_words, 0, count) || !within(file->shape_words, 0, count) ||
        !within(file->first_words, 0, count) || (file->shape_words > 0) != (file->first_words > 0) ||
        (int64_t)(sizeof *file / 8) + row * cable->parameter_count + file->system_words +
                cable->image_words + file->shape_words + file->first_words != count)
        return "the sizes do not agree";
    if (!all_finite(file->inputs, VR_INPUTS) || !all_finite(file->frame, 3))
        return "a start value is not finite";
    if (!(file->search >= 0.0)) return "a size is out of range";
    if (!all_finite(file->facts, FACT_WORDS)) return "a number of the line as a whole is not finite";
    if (!within((cable->flags & FLAG_VESSEL_INPUT) / FLAG_VESSEL_INPUT_UNIT, BY_VELOCITY, BY_BOTH))
        return "a start value is out of range";
    cable->parameters = (const Parameter *)(file + 1);
    const int64_t *image = initial_image(cable);
    const char *problem = check_block(image, cable->image_words, cable->block_words);
    if (problem != NULL) return problem;
    cable->inputs = VR_INPUTS;
    cable->value_words = cable->parameter_count + WORDS_OF_INPUT * cable->inputs;
    problem = check_parameters(cable, image);
    if (problem != NULL) return problem;
    if (is_system(image) != (file->system_words > 0)) return "the sizes do not agree";
    if (file->shape_words > 0) {
        problem = is_system(image) ? check_first_shape(cable) : "the sizes do not agree";
        if (problem != NULL) return problem;
    }
    if (is_system(image))
        return load_system(cable, image - file->system_words, file->system_words, image);
    cable->bodies = is_direct(image) ? own_header(image)->body_count : header(image)->body_count;
    return NULL;
}

static const char *load_block(Cable *cable, const char *resource_location, const char *name,
                              const char *guid) {
    char *path = path_of(resource_location, name);
    if (path == NULL) return "out of memory";
    int64_t count = 0;
    const char *problem = read_file(path, &cable->file, &count);
    free(path);
    if (problem == NULL) problem = check_file(cable, count, guid);
    if (problem != NULL) {
        snprintf(cable->message, sizeof cable->message, "resources/%s: %s", name, problem);
        return cable->message;
    }
    const size_t samples = (size_t)(cable->stations + cable->bodies);
    cable->I = calloc((size_t)cable->block_words, 8);
    cable->M = (double *)cable->I;
    cable->room = cable->block_words;
    cable->values = calloc((size_t)cable->value_words + 1, sizeof(double));
    for (int64_t n = 0; n < cable->parameter_count; n++)
        if (cable->parameters[n].kind >= OF_LINE) cable->length_words += LENGTH_WORDS;
    cable->lengths = calloc((size_t)cable->length_words + 1, sizeof(double));
    const int64_t *image = initial_image(cable);
    cable->gaps = calloc(is_direct(image) ? 1 : (size_t)header(image)->line_count, sizeof(double));
    cable->arcs = calloc(samples, sizeof(double));
    cable->rows = calloc(samples * STATION_WORDS, sizeof(double));
    if (cable->I == NULL || cable->values == NULL || cable->lengths == NULL || cable->gaps == NULL || cable->arcs == NULL || cable->rows == NULL)
        return "out of memory";
    return NULL;
}

/* The run that errors are estimated by: of the same line, with the same parameters. */
static const char *load_finer(Cable *cable, const char *resource_location, const char *guid) {
    Cable *finer = cable->finer = calloc(1, sizeof *finer);
    if (finer == NULL) return "out of memory";
    const char *problem = load_block(finer, resource_location, "finer.bin", guid);
    if (problem != NULL) return problem;
    if (is_direct(initial_image(cable)) || is_direct(initial_image(finer)) ||
        cable->flags != (finer->flags | FLAG_ESTIMATE) || (finer->flags & FLAG_ESTIMATE) ||
        cable->parameter_count != finer->parameter_count || !same_parts(cable, finer) ||
        cable->value_words != finer->value_words ||
        memcmp(cable->parameters, finer->parameters,
               sizeof(Parameter) * (size_t)cable->parameter_count) != 0)
        return "resources/finer.bin: not of the scene of resources/model.bin";
    return NULL;
}

const char *load_cable(Cable *cable, const char *resource_location, const char *guid) {
    memset(cable, 0, sizeof *cable);
    if (resource_location == NULL) return "the resource location is missing";
    const char *problem = load_block(cable, resource_location, "model.bin", guid);
    if (problem == NULL && (cable->flags & FLAG_ESTIMATE))
        problem = load_finer(cable, resource_location, guid);
    if (problem != NULL) return problem;
    cable->now.magic = STATE_MAGIC;
    cable->now.kernels = KERNEL_HASH;
    memcpy(cable->now.guid, file_header(cable->file)->guid, sizeof cable->now.guid);
    restart_cable(cable);
    return NULL;
}

void free_cable(Cable *cable) {
    if (cable->finer != NULL) free_cable(cable->finer);
    free(cable->finer);
    free(cable->file);
    free(cable->I);
    free(cable->values);
    free(cable->lengths);
    free(cable->gaps);
    free(cable->arcs);
    free(cable->rows);
    free(cable->copy);
    free(cable->wrenches);
    free_system(cable->system);
}
