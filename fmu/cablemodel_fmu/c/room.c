/* Memory of a block: it grows with the mesh, by the rule of Block.make_room in cablemodel/solvers/finite_element/block.py.
   How much there is room for is seen in no result. */
#include <stdlib.h>
#include <string.h>

#include "cable.h"

/* Words of the image and of the whole block, with offsets, of one with room for so many nodes. */
static void measure(const int64_t *I, int64_t capacity, int64_t offset[HEADER_WORDS], int64_t *image,
                    int64_t *words) {
    int64_t own[HEADER_WORDS];
    memcpy(own, I, sizeof own);
    header(own)->capacity = capacity;
    arrange(own, offset, image, words);
}

/* Memory for a block of so many words and nodes; the block stays as it is. Returns 0 if there is
   none. */
int reserve(Cable *cable, int64_t words, int64_t capacity) {
    if (words <= cable->room) return 1;
    if (capacity > LARGEST_COUNT || words > LARGEST_FILE / 8) return 0;
    if (cable->system != NULL && !reserve_elements(cable, capacity)) return 0;
    int64_t *larger = realloc(cable->I, 8 * (size_t)words);
    if (larger == NULL) return 0;
    cable->I = larger;
    cable->M = (double *)larger;
    cable->room = words;
    return 1;
}

static void set_sizes(Cable *cable, int64_t image, int64_t words) {
    cable->image_words = image;
    cable->block_words = words;
    free(cable->copy);
    cable->copy = NULL;
}

/* Room for so many nodes, no fewer than now; all else of the image stays. Returns 0 if there is no
   memory: then nothing changes. */
int make_room(Cable *cable, int64_t capacity) {
    static const int64_t arrays[] = {IMAGE_ARRAYS};
    enum { ARRAYS = sizeof arrays / sizeof arrays[0] };
    int64_t before[HEADER_WORDS] = {0}, after[HEADER_WORDS] = {0}, image = 0, words = 0;
    measure(cable->I, capacity, after, &image, &words);
    if (!reserve(cable, words, capacity)) return 0;
    int64_t *I = cable->I, end = cable->image_words, next = words;
    memcpy(before, I, sizeof before);
    /* Up in memory, from the last one: what belongs to nodes is stored node by node. */
    for (int n = ARRAYS - 1; n >= 0; n--) {
        const int64_t from = before[arrays[n]], to = after[arrays[n]], length = end - from;
        memmove(I + to, I + from, 8 * (size_t)length);
        memset(I + to + length, 0, 8 * (size_t)(next - to - length));
        end = from;
        next = to;
    }
    header(I)->capacity = capacity;
    header(I)->image_words = image;
    header(I)->byte_count = 8 * words;
    for (int n = 0; n < HEADER_WORDS; n++)
        if (after[n] != 0) I[n] = after[n];
    set_sizes(cable, image, words);
    return 1;
}

/* Room for twice as many nodes, as Python has it. Returns 0 if there is no memory. */
int grow(Cable *cable) {
    return !is_direct(cable->I) && make_room(cable, 2 * header(cable->I)->capacity);
}

/* Lay the block out as an image has it, for which there is memory, where it is of another room: then
   the tables of the scene, which lie before all that there is of each node, stay, and all else is 0. */
void lay_out_as(Cable *cable, const int64_t *image) {
    if (is_direct(image) || header(image)->capacity == header(cable->I)->capacity) return;
    const int64_t first = header(image)->parent;
    set_sizes(cable, header(image)->image_words, header(image)->byte_count / 8);
    memset(cable->I + first, 0, 8 * (size_t)(cable->block_words - first));
}

/* The block as an image has it, for which there is memory. */
void take_image(Cable *cable, const int64_t *image) {
    lay_out_as(cable, image);
    memcpy(cable->I, image, 8 * (size_t)cable->image_words);
}

void take_exported(Cable *cable) { take_image(cable, initial_image(cable)); }

/* A step of the block; memory grows where it must, and the step is made again. On failure the state is
   as it was. */
int64_t step_block(Cable *cable, double t_end, double *inputs) {
    int64_t status;
    do status = cablemodel_step(cable->I, cable->block_words, t_end, inputs, INPUT_WORDS);
    while (status == NO_CAPACITY && grow(cable));
    return status;
}
