/* The kernels by name, for the Python library: they are not exported, so that no other library in
   the process can take the place of one. */
#include <string.h>

#include "kernels.h" /* generated: KERNELS(K) is K(name) for every kernel */

#ifdef _WIN32
#define EXPORTED __declspec(dllexport)
#else
#define EXPORTED __attribute__((visibility("default")))
#endif

typedef void Kernel(void);
#define DECLARED(name) void cablemodel_##name(void);
KERNELS(DECLARED)

EXPORTED Kernel *cablemodel_kernel(const char *name) {
#define NAMED(name) {#name, cablemodel_##name},
    static const struct {
        const char *name;
        Kernel *kernel;
    } kernels[] = {KERNELS(NAMED)};
    for (size_t n = 0; n < sizeof kernels / sizeof kernels[0]; n++)
        if (strcmp(name, kernels[n].name) == 0) return kernels[n].kernel;
    return NULL;
}
