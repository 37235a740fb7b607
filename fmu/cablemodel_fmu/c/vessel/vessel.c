/* The vessel of an exported system (cablemodel_fmu/system.py): mass, thrust along x, quadratic
   resistance; cable force in, velocity and position out. It floats: no heave. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

/* References: 0-2 force on the vessel, 3-5 velocity, 6-8 position, 9 mass, 10 thrust, 11 resistance,
   12-14 velocity and 15-17 position at the start. */
enum { WORDS = 18 };
typedef struct { double value[WORDS]; } Vessel;
static const double start[WORDS] = {[9] = 5000.0, [10] = 300.0, [11] = 200.0};

fmi2Component fmi2Instantiate(fmi2String a, fmi2Type b, fmi2String c, fmi2String d,
                              const fmi2CallbackFunctions *e, fmi2Boolean f, fmi2Boolean g) {
    (void)a, (void)b, (void)c, (void)d, (void)e, (void)f, (void)g;
    Vessel *vessel = malloc(sizeof *vessel);
    if (vessel != NULL) memcpy(vessel->value, start, sizeof start);
    return vessel;
}
void fmi2FreeInstance(fmi2Component c) { free(c); }
const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }
fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean b, fmi2Real d, fmi2Real e, fmi2Boolean f,
                               fmi2Real g) {
    (void)c, (void)b, (void)d, (void)e, (void)f, (void)g;
    return fmi2OK;
}
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String names[]) {
    (void)c, (void)on, (void)n, (void)names;
    return fmi2OK;
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) { return c ? fmi2OK : fmi2Error; }
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { return c ? fmi2OK : fmi2Error; }
fmi2Status fmi2Terminate(fmi2Component c) { return c ? fmi2OK : fmi2Error; }
fmi2Status fmi2Reset(fmi2Component c) {
    memcpy(((Vessel *)c)->value, start, sizeof start);
    return fmi2OK;
}
fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    for (size_t k = 0; k < n; k++) {
        if (vr[k] >= WORDS) return fmi2Error;
        value[k] = ((Vessel *)c)->value[vr[k]];
    }
    return fmi2OK;
}
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                       const fmi2Real value[]) {
    for (size_t k = 0; k < n; k++) {
        if (vr[k] >= WORDS) return fmi2Error;
        ((Vessel *)c)->value[vr[k]] = value[k];
        if (vr[k] >= 12) ((Vessel *)c)->value[vr[k] - 9] = value[k];
    }
    return fmi2OK;
}
#define NONE(name, type) \
    fmi2Status name(fmi2Component c, const fmi2ValueReference vr[], size_t n, type value[]) { \
        (void)c, (void)vr, (void)value; \
        return n == 0 ? fmi2OK : fmi2Error; \
    }
NONE(fmi2GetInteger, fmi2Integer)
NONE(fmi2SetInteger, const fmi2Integer)
NONE(fmi2GetBoolean, fmi2Boolean)
NONE(fmi2SetBoolean, const fmi2Boolean)
NONE(fmi2GetString, fmi2String)
NONE(fmi2SetString, const fmi2String)

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real dt, fmi2Boolean b) {
    (void)t, (void)b;
    double *x = ((Vessel *)c)->value;
    const int parts = 10;
    const double h = dt / parts;
    for (int n = 0; n < parts; n++) {
        const double speed = sqrt(x[3] * x[3] + x[4] * x[4]);
        for (int i = 0; i < 2; i++) {
            const double thrust = i == 0 ? x[10] : 0.0;
            x[3 + i] += h * (thrust + x[i] - x[11] * speed * x[3 + i]) / x[9];
            x[6 + i] += h * x[3 + i];
        }
    }
    return fmi2OK;
}
fmi2Status fmi2CancelStep(fmi2Component c) { (void)c; return fmi2Error; }
fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind k, fmi2Status *v) {
    (void)c, (void)k, (void)v;
    return fmi2Discard;
}
fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind k, fmi2Real *v) {
    (void)c, (void)k, (void)v;
    return fmi2Discard;
}
fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind k, fmi2Integer *v) {
    (void)c, (void)k, (void)v;
    return fmi2Discard;
}
fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind k, fmi2Boolean *v) {
    (void)c, (void)k, (void)v;
    return fmi2Discard;
}
fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind k, fmi2String *v) {
    (void)c, (void)k, (void)v;
    return fmi2Discard;
}
fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                       const fmi2Integer o[], const fmi2Real v[]) {
    (void)c, (void)vr, (void)o, (void)v;
    return n == 0 ? fmi2OK : fmi2Error;
}
fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                        const fmi2Integer o[], fmi2Real v[]) {
    (void)c, (void)vr, (void)o, (void)v;
    return n == 0 ? fmi2OK : fmi2Error;
}
fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *s) { (void)c, (void)s; return fmi2Error; }
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate s) { (void)c, (void)s; return fmi2Error; }
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *s) { (void)c, (void)s; return fmi2Error; }
fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate s, size_t *n) {
    (void)c, (void)s, (void)n;
    return fmi2Error;
}
fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate s, fmi2Byte b[], size_t n) {
    (void)c, (void)s, (void)b, (void)n;
    return fmi2Error;
}
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte b[], size_t n, fmi2FMUstate *s) {
    (void)c, (void)b, (void)n, (void)s;
    return fmi2Error;
}
fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference a[], size_t n,
                                        const fmi2ValueReference b[], size_t m, const fmi2Real d[],
                                        fmi2Real e[]) {
    (void)c, (void)a, (void)n, (void)b, (void)m, (void)d, (void)e;
    return fmi2Error;
}
