/* Steps a model's block with the library of kernels, for counting instructions under valgrind.

   count_steps LIBRARY BLOCK TIME...
   BLOCK: the block's words as Block.ints.tofile wrote them. Only counted_step
   should be counted (callgrind's --toggle-collect): the library exports no kernel by name. Prints the status of the last step. */
#include <dlfcn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

typedef int64_t (*step_function)(void *, int64_t, double, double *, int64_t);
typedef void *(*kernel_function)(const char *);

__attribute__((noinline)) int64_t counted_step(step_function step, void *block, int64_t words,
                                               double time, double *inputs)
{
    return step(block, words, time, inputs, 14);
}

int main(int argc, char **argv)
{
    if (argc < 4) {
        fprintf(stderr, "usage: %s LIBRARY BLOCK TIME...\n", argv[0]);
        return 2;
    }
    void *library = dlopen(argv[1], RTLD_NOW);
    kernel_function kernel = library ? (kernel_function)dlsym(library, "cablemodel_kernel") : NULL;
    step_function step = kernel ? (step_function)kernel("step") : NULL;
    FILE *file = fopen(argv[2], "rb");
    if (!step || !file) {
        fprintf(stderr, "cannot open %s\n", step ? argv[2] : argv[1]);
        return 2;
    }
    fseek(file, 0, SEEK_END);
    int64_t words = ftell(file) / 8;
    rewind(file);
    void *block = malloc((size_t)words * 8);
    if (!block || fread(block, 8, (size_t)words, file) != (size_t)words)
        return 2;
    double inputs[14] = {0};
    int64_t status = 0;
    for (int k = 3; k < argc && status == 0; k++)
        status = counted_step(step, block, words, strtod(argv[k], NULL), inputs);
    printf("%lld\n", (long long)status);
    return status != 0;
}
