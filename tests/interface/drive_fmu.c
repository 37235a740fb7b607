/* Drive an unpacked FMU with nothing but the FMI headers and the system's loader.

   drive_fmu LIBRARY RESOURCES GUID STEPS DT REPEAT VR...

   The vessel gets under way to the side and back; with REPEAT > 1 the run is made again (reset) and
   the processor time per step of the fastest one is printed. Values of the VRs after each step, one line each. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "fmi2Functions.h"

#ifdef _WIN32
#include <windows.h>
#define FIND(library, name) (void *)GetProcAddress((HMODULE)(library), name)
#else
#include <dlfcn.h>
#define FIND(library, name) dlsym(library, name)
#endif

static void logger(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                   fmi2String category, fmi2String message, ...) {
    (void)environment;
    fprintf(stderr, "%s %d %s: %s\n", instance, (int)status, category, message);
}

static void check(int ok, const char *what) {
    if (ok) return;
    fprintf(stderr, "failed: %s\n", what);
    exit(1);
}

static double seconds(void) {
    return (double)clock() / CLOCKS_PER_SEC;
}

#define GET(name) fmi2##name##TYPE *name = (fmi2##name##TYPE *)FIND(library, "fmi2" #name); \
    check(name != NULL, "fmi2" #name)

int main(int argc, char **argv) {
    check(argc > 7, "arguments");
#ifdef _WIN32
    void *library = (void *)LoadLibraryA(argv[1]);
#else
    void *library = dlopen(argv[1], RTLD_NOW | RTLD_LOCAL);
#endif
    check(library != NULL, argv[1]);
    GET(Instantiate);
    GET(SetupExperiment);
    GET(EnterInitializationMode);
    GET(ExitInitializationMode);
    GET(SetReal);
    GET(GetReal);
    GET(DoStep);
    GET(Terminate);
    GET(Reset);
    GET(FreeInstance);
    const fmi2CallbackFunctions callbacks = {logger, NULL, NULL, NULL, NULL};
    fmi2Component c =
        Instantiate("cable", fmi2CoSimulation, argv[3], argv[2], &callbacks, fmi2False, fmi2False);
    check(c != NULL, "fmi2Instantiate");
    const int steps = atoi(argv[4]), repeat = atoi(argv[6]);
    const double dt = atof(argv[5]);
    const fmi2ValueReference velocity[3] = {0, 1, 2};
    double best = 1e300;
    for (int run = 0; run < repeat; run++) {
        double spent = 0.0;
        if (run > 0) check(Reset(c) == fmi2OK, "fmi2Reset");
        check(SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0) == fmi2OK, "setup");
        check(EnterInitializationMode(c) == fmi2OK, "fmi2EnterInitializationMode");
        check(ExitInitializationMode(c) == fmi2OK, "fmi2ExitInitializationMode");
        const double before = seconds();
        for (int n = 0; n < steps; n++) {
            const double t = n * dt, end = t + dt;
            const double ramp = end < 30.0 ? end / 30.0 : 1.0;
            const fmi2Real value[3] = {0.8 * ramp, 0.0, 0.0};
            check(SetReal(c, velocity, 3, value) == fmi2OK, "fmi2SetReal");
            check(DoStep(c, t, dt, fmi2True) == fmi2OK, "fmi2DoStep");
            if (repeat > 1) continue;
            printf("%.17g", end);
            for (int k = 7; k < argc; k++) {
                const fmi2ValueReference vr = (fmi2ValueReference)strtoul(argv[k], NULL, 10);
                fmi2Real got;
                check(GetReal(c, &vr, 1, &got) == fmi2OK, "fmi2GetReal");
                printf(" %.17g", got);
            }
            printf("\n");
        }
        spent = seconds() - before;
        if (spent < best) best = spent;
    }
    if (repeat > 1) printf("%.17g\n", best / steps);
    check(Terminate(c) == fmi2OK, "fmi2Terminate");
    FreeInstance(c);
    return 0;
}
