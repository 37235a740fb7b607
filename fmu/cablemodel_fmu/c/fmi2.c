/* FMI 2.0 for co-simulation around one cable or system (see cable.h): order of calls, messages, states.

   A refused call changes nothing and leaves the instance usable: fmi2Error says that the call was
   wrong, fmi2Discard that this step cannot be made but a shorter one or other inputs may do. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cable.h"
#include "fmi2Functions.h"

enum { LOG_ERROR = 1, LOG_WARNING = 2, LOG_DISCARD = 4, LOG_EVENTS = 8 };
static const struct {
    const char *name;
    int bit;
} categories[] = {{"logStatusError", LOG_ERROR},
                  {"logStatusFatal", LOG_ERROR},
                  {"logStatusWarning", LOG_WARNING},
                  {"logStatusDiscard", LOG_DISCARD},
                  {"logEvents", LOG_EVENTS},
                  {"logAll", LOG_ERROR | LOG_WARNING | LOG_DISCARD | LOG_EVENTS}};
enum { CATEGORIES = sizeof categories / sizeof categories[0] };
enum { JUMP_SAID = ALL_SET + 1, DRUM_SAID = 2 * JUMP_SAID, SHORTEST_SAID = 2 * DRUM_SAID, PLACE_SAID = 2 * SHORTEST_SAID };
enum { ZERO_STEPS = 10 }; /* in which an input that is set stays 0, before a warning */
#define TIME_ROUNDED 1e-9 /* of times: a step that begins or ends beside where it may, by rounding */
#define STEP_ROUNDED 1e-6 /* of a step: the same */
enum { QUIET = LOG_ERROR | LOG_WARNING | LOG_DISCARD };

typedef struct {
    Cable cable;
    fmi2CallbackLogger logger;
    fmi2ComponentEnvironment environment;
    char *name;
    int logged;
    double stop_time;
    int has_stop_time;
    int64_t warned; /* of which inputs that are set and do nothing, and ..._SAID */
    int watched; /* steps at which zero_input was looked at, of the first ones, */
    uint64_t zeros; /* and the first 64 inputs for which it held at all of them */
} Instance;

static void say(fmi2CallbackLogger logger, fmi2ComponentEnvironment environment, const char *name,
                fmi2Status status, const char *category, const char *format, va_list list) {
    char text[512];
    if (logger == NULL) return;
    vsnprintf(text, sizeof text, format, list);
    for (char *c = text; *c != 0; c++)
        if (*c == '%') *c = ' '; /* the text is a format to the logger */
    logger(environment, name, status, category, text);
}

static fmi2Status report(Instance *in, fmi2Status status, const char *format, ...) {
    const int bit = status == fmi2OK        ? LOG_EVENTS
                    : status == fmi2Warning ? LOG_WARNING
                    : status == fmi2Discard ? LOG_DISCARD
                                            : LOG_ERROR;
    if (in->logged & bit) {
        const char *category = "logEvents";
        for (int n = 0; n < CATEGORIES && status != fmi2OK; n++)
            if (categories[n].bit == bit) {
                category = categories[n].name;
                break;
            }
        va_list list;
        va_start(list, format);
        say(in->logger, in->environment, in->name, status, category, format, list);
        va_end(list);
    }
    return status;
}

static void refuse(const fmi2CallbackFunctions *to, const char *name, const char *format, ...) {
    if (to == NULL) return;
    va_list list;
    va_start(list, format);
    say(to->logger, to->componentEnvironment, name == NULL ? "" : name, fmi2Error,
        "logStatusError", format, list);
    va_end(list);
}

/* Which calls are allowed in which phase. */
enum {
    P1 = 1 << INSTANTIATED, P2 = 1 << INITIALISING, P3 = 1 << STEPPING, P4 = 1 << TERMINATED,
    ANY = P1 | P2 | P3 | P4
};

static int allowed(Instance *in, int phases, const char *call) {
    if (in == NULL) return 0;
    if ((1 << in->cable.now.phase) & phases) return 1;
    static const char *const names[] = {"", "instantiated", "in initialization mode",
                                        "initialized", "terminated"};
    report(in, fmi2Error, "%s: not allowed while %s", call, names[in->cable.now.phase]);
    return 0;
}
#define ALLOW(c, phases) \
    Instance *in = (c);  \
    if (!allowed(in, phases, __func__)) return fmi2Error

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count,
                               const fmi2String names[]) {
    ALLOW(c, ANY);
    int chosen = count == 0 ? categories[CATEGORIES - 1].bit : 0;
    if (count > 0 && names == NULL)
        return report(in, fmi2Error, "fmi2SetDebugLogging: no categories given");
    for (size_t k = 0; k < count; k++) {
        int known = 0;
        for (int n = 0; n < CATEGORIES; n++)
            if (names[k] != NULL && strcmp(names[k], categories[n].name) == 0) {
                chosen |= categories[n].bit;
                known = 1;
            }
        if (!known)
            return report(in, fmi2Error, "fmi2SetDebugLogging: unknown category %s",
                          names[k] == NULL ? "(null)" : names[k]);
    }
    in->logged = on ? chosen : QUIET;
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid,
                              fmi2String resources, const fmi2CallbackFunctions *callbacks,
                              fmi2Boolean visible, fmi2Boolean logging) {
    (void)visible;
    if (name == NULL || name[0] == 0) {
        refuse(callbacks, name, "fmi2Instantiate: the instance needs a name");
        return NULL;
    }
    if (type != fmi2CoSimulation) {
        refuse(callbacks, name, "fmi2Instantiate: this FMU is for co-simulation only");
        return NULL;
    }
    Instance *in = calloc(1, sizeof *in);
    const char *problem = "out of memory";
    if (in != NULL) {
        in->name = malloc(strlen(name) + 1);
        if (in->name != NULL) {
            strcpy(in->name, name);
            problem = load_cable(&in->cable, resources, guid);
        }
    }
    if (problem != NULL) {
        refuse(callbacks, name, "fmi2Instantiate: %s", problem);
        fmi2FreeInstance(in);
        return NULL;
    }
    if (callbacks != NULL) {
        in->logger = callbacks->logger;
        in->environment = callbacks->componentEnvironment;
    }
    in->logged = logging ? categories[CATEGORIES - 1].bit : QUIET;
    report(in, fmi2OK, "instantiated: %lld nodes, %lld stations",
           (long long)(is_direct(in->cable.I) ? direct_nodes(in->cable.I) : header(in->cable.I)->nodes),
           (long long)in->cable.stations);
    return in;
}

void fmi2FreeInstance(fmi2Component c) {
    Instance *in = c;
    if (in == NULL) return;
    free_cable(&in->cable);
    free(in->name);
    free(in);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                               fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
    ALLOW(c, P1);
    (void)tolerance; /* that of the scene holds: the mesh was made for it */
    if (!(fabs(start) < 1e300) || (has_stop && !(stop > start)))
        return report(in, fmi2Error, "fmi2SetupExperiment: start %g and stop %g are not allowed",
                      start, stop);
    if (has_tolerance)
        report(in, fmi2OK, "fmi2SetupExperiment: the tolerance is that of the scene");
    in->cable.now.start_time = start;
    in->has_stop_time = has_stop;
    in->stop_time = stop;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    ALLOW(c, P1);
    in->cable.now.phase = INITIALISING;
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    ALLOW(c, P2);
    const char *problem = settle_cable(&in->cable);
    if (problem != NULL) return report(in, fmi2Error, "fmi2ExitInitializationMode: %s", problem);
    const char *odd = in->cable.system == NULL ? NULL : more_than_a_turn(&in->cable);
    if (odd != NULL) report(in, fmi2Warning, "fmi2ExitInitializationMode: %s", odd);
    if (in->cable.bent > 0.0)
        report(in, fmi2Warning, "fmi2ExitInitializationMode: at this start the line bends %.3g times as "
               "much as the exported elements can follow at the scene's tolerance, and its shape may not be "
               "the scene's: export the scene with these values", in->cable.bent);
    if (in->cable.stretched > 0.0)
        report(in, fmi2Warning, "fmi2ExitInitializationMode: at this start a line is stretched by %.3g per cent: are "
               "places and lengths right?", 100.0 * in->cable.stretched);
    if (in->cable.pressed < 0.0)
        report(in, fmi2Warning, "fmi2ExitInitializationMode: this start presses the line (lowest tension "
               "%g N): it may not be the one that the line stays in; export the scene with these values",
               in->cable.pressed);
    if (in->cable.leaves)
        report(in, fmi2Warning, "fmi2ExitInitializationMode: %s", in->cable.leaves == SWINGS_UP
               ? "this start swings up by itself, as that of a scene with these values does"
               : "this start may fall or swing up by itself, as the scene's own may: export the scene with these "
                 "values, where another one is looked for");
    in->cable.now.phase = STEPPING;
    return report(in, fmi2OK, "initialized at t = %g s", cable_time(&in->cable));
}

fmi2Status fmi2Terminate(fmi2Component c) {
    ALLOW(c, P3);
    in->cable.now.phase = TERMINATED;
    return report(in, fmi2OK, "terminated after %lld steps, %lld rejected",
                  (long long)header(in->cable.I)->steps, (long long)header(in->cable.I)->rejected);
}

fmi2Status fmi2Reset(fmi2Component c) {
    ALLOW(c, ANY);
    restart_cable(&in->cable);
    in->has_stop_time = 0;
    in->warned = 0;
    in->watched = 0;
    return fmi2OK;
}

/* -- values ------------------------------------------------------------------------------------ */

static int given(Instance *in, const char *call, const void *vr, size_t count, const void *value) {
    if (count == 0 || (vr != NULL && value != NULL)) return 1;
    report(in, fmi2Error, "%s: an argument is missing", call);
    return 0;
}
#define GIVEN(vr, count, value) \
    if (!given(in, __func__, vr, count, value)) return fmi2Error

static fmi2Status unknown(Instance *in, const char *call, fmi2ValueReference vr) {
    return report(in, fmi2Error, "%s: unknown value reference %u", call, vr);
}

static fmi2Status refused(Instance *in, const char *call, fmi2ValueReference vr, const char *given,
                          const char *problem) {
    const char *name = name_of(&in->cable, vr);
    return report(in, fmi2Error, "%s: %s%svalue reference %u%s%s: %s", call,
                  name == NULL ? "" : name, name == NULL ? "" : " (", vr, name == NULL ? "" : ")",
                  given, problem);
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                       fmi2Real value[]) {
    ALLOW(c, ANY);
    GIVEN(vr, count, value);
    for (size_t n = 0; n < count; n++) {
        const char *problem = read_value(&in->cable, vr[n], &value[n]);
        if (problem != NULL) return refused(in, __func__, vr[n], "", problem);
    }
    return fmi2OK;
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          fmi2Integer value[]) {
    ALLOW(c, ANY);
    GIVEN(vr, count, value);
    for (size_t n = 0; n < count; n++) {
        const int64_t *choice = choice_of(&in->cable, vr[n]);
        if (choice == NULL) return unknown(in, __func__, vr[n]);
        value[n] = (fmi2Integer)*choice;
    }
    return fmi2OK;
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          fmi2Boolean value[]) {
    ALLOW(c, ANY);
    GIVEN(vr, count, value);
    for (size_t n = 0; n < count; n++) {
        if (vr[n] != VR_USE_SCENE_INPUTS) return unknown(in, __func__, vr[n]);
        value[n] = in->cable.now.use_scene_inputs ? fmi2True : fmi2False;
    }
    return fmi2OK;
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                         fmi2String value[]) {
    ALLOW(c, ANY);
    (void)value;
    return count == 0 ? fmi2OK : unknown(in, __func__, vr == NULL ? 0 : vr[0]);
}

/* Say once of a group of inputs that it is set and does nothing. What moves a vessel may still be
   chosen before the run: that is judged as the run begins. */
static void warn_of_ignored(Instance *in, unsigned vr) {
    static const char *const names[] = {"vessel.velocity", "vessel.position", "payout.rate",
                                        "current.velocity"};
    static const char *const scene_drives =
        "use_scene_inputs is true, and was set so or exported to ignore inputs; set it to false, or "
        "leave it";
    Cable *cable = &in->cable;
    if (cable->system != NULL) {
        const char *by = ignored_part_input(cable, vr);
        if (by != NULL)
            report(in, fmi2Warning, "%s is set but ignored: %s%s", name_of(cable, vr),
                   by[0] != 0 ? by : scene_drives, by[0] != 0 ? " says what moves it" : "");
        return;
    }
    const int64_t group = inputs_of(vr);
    if (!(group & connected(cable) & ~in->warned)) return;
    int64_t used = driven(cable);
    const int64_t by = vessel_input(cable);
    const int motion = VELOCITY_SET | POSITION_SET, moves = (used & motion) != 0;
    used &= ~motion;
    if (moves && by != BY_POSITION) used |= VELOCITY_SET;
    if (moves && by != BY_VELOCITY) used |= POSITION_SET;
    if (group & used) return;
    if (moves && (group & motion) && cable->now.phase != STEPPING) return;
    int n = 0;
    while (!(group >> n & 1)) n++;
    in->warned |= group;
    report(in, fmi2Warning, "%s is set but ignored: %s", names[n],
           moves && (group & motion) ? "vessel.input says what moves the tow point" : scene_drives);
}

/* Of the first step: what was set before it and does nothing, and whether it begins with a jump. */
static void warn_at_first(Instance *in, double dt) {
    Cable *cable = &in->cable;
    if (cable->now.last_step > 0.0) return;
    for (unsigned vr = first_input(cable); input_of(cable, vr) != NULL; vr++) warn_of_ignored(in, vr);
    const char *problem = in->warned & JUMP_SAID ? NULL : first_jump(cable, dt);
    if (problem == NULL) return;
    in->warned |= JUMP_SAID;
    report(in, fmi2Warning, "fmi2DoStep: %s", problem);
}

/* Of what was 0 in all of the first steps, and takes the place of the scene's schedule. */
static void warn_of_zeros(Instance *in) {
    uint64_t zeros = 0;
    const char *name;
    if (in->watched == ZERO_STEPS) return;
    for (int n = 0; n < 64; n++)
        if (zero_input(&in->cable, n) != NULL) zeros |= UINT64_C(1) << n;
    in->zeros = in->watched == 0 ? zeros : in->zeros & zeros;
    if (++in->watched < ZERO_STEPS) return;
    for (int n = 0; n < 64; n++)
        if ((in->zeros >> n & 1) && (name = zero_input(&in->cable, n)) != NULL)
            report(in, fmi2Warning, "fmi2DoStep: %s has been 0 for %d steps, and takes the place of what the scene "
                   "schedules: is it connected? If not, set use_scene_inputs to true, or export with inputs 'scene'",
                   name, ZERO_STEPS);
}

static void warn_of_idle_winch(Instance *in, const char *name, int inward) {
    report(in, fmi2Warning, "%s asks for %s", name,
           inward ? "less line, and it is as short as it gets: the winch stands"
                  : "cable, and there is none on the drum");
}

/* Once of each winch that a step was asked to pay out by, and that had nothing to pay out; and of one
   that was asked to reel in, and could not. */
static void warn_of_idle_winches(Instance *in) {
    Cable *cable = &in->cable;
    const char *name;
    int inward = 0;
    if (cable->system != NULL) {
        while ((name = idle_winch(cable, &inward)) != NULL) warn_of_idle_winch(in, name, inward);
        return;
    }
    for (inward = 0; inward < 2; inward++) {
        const int64_t said = inward ? SHORTEST_SAID : DRUM_SAID;
        if ((in->warned & said) || !(inward ? is_shortest(cable) : is_idle(cable))) continue;
        in->warned |= said;
        warn_of_idle_winch(in, "payout.rate", inward);
    }
}

/* All or nothing. */
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                       const fmi2Real value[]) {
    ALLOW(c, P1 | P2 | P3);
    GIVEN(vr, count, value);
    for (size_t n = 0; n < count; n++) {
        const char *problem = check_value(&in->cable, vr[n], value[n]);
        if (problem != NULL) {
            char given[40];
            snprintf(given, sizeof given, ", value %g", value[n]);
            return refused(in, __func__, vr[n], given, problem);
        }
    }
    for (size_t n = 0; n < count; n++) write_value(&in->cable, vr[n], value[n]);
    for (size_t n = 0; n < count; n++) warn_of_ignored(in, vr[n]);
    return fmi2OK;
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          const fmi2Integer value[]) {
    ALLOW(c, P1 | P2);
    GIVEN(vr, count, value);
    for (size_t n = 0; n < count; n++) {
        if (choice_of(&in->cable, vr[n]) == NULL) return unknown(in, __func__, vr[n]);
        const int most = vr[n] == VR_INPUT_TIMING ? AT_START : BY_BOTH;
        if (value[n] < 1 || value[n] > most)
            return report(in, fmi2Error, "fmi2SetInteger: %s is %d, not 1 to %d",
                          name_of(&in->cable, vr[n]), value[n], most);
    }
    for (size_t n = 0; n < count; n++) choose(&in->cable, vr[n], value[n]);
    return fmi2OK;
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          const fmi2Boolean value[]) {
    ALLOW(c, P1 | P2);
    GIVEN(vr, count, value);
    for (size_t n = 0; n < count; n++) {
        if (vr[n] != VR_USE_SCENE_INPUTS) return unknown(in, __func__, vr[n]);
        in->cable.now.use_scene_inputs = value[n] != fmi2False;
        in->cable.now.scene_inputs_given = 1;
    }
    return fmi2OK;
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                         const fmi2String value[]) {
    ALLOW(c, P1 | P2 | P3);
    (void)value;
    return count == 0 ? fmi2OK : unknown(in, __func__, vr == NULL ? 0 : vr[0]);
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                       const fmi2Integer order[], const fmi2Real value[]) {
    ALLOW(c, P2 | P3);
    GIVEN(vr, count, value);
    GIVEN(vr, count, order);
    for (size_t n = 0; n < count; n++) {
        if (slope_of(&in->cable, vr[n]) == NULL)
            return input_of(&in->cable, vr[n]) == NULL
                       ? unknown(in, __func__, vr[n])
                       : refused(in, __func__, vr[n], "", "a command has no derivatives");
        if (order[n] < 1 || order[n] > 3)
            return report(in, fmi2Error, "%s: order %d, not 1 to 3", __func__, order[n]);
        if (!(fabs(value[n]) < 1e100))
            return report(in, fmi2Error, "%s: a value is not finite", __func__);
    }
    Controls *now = &in->cable.now;
    if (!now->has_slope) clear_slopes(&in->cable);
    now->has_slope = count > 0;
    for (size_t n = 0; n < count; n++) {
        slope_of(&in->cable, vr[n])[order[n] - 1] = value[n];
        if (now->phase == STEPPING || value[n] != 0.0) mark_set(&in->cable, vr[n], 1);
    }
    for (size_t n = 0; n < count; n++) warn_of_ignored(in, vr[n]);
    return fmi2OK;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[],
                                        size_t count, const fmi2Integer order[],
                                        fmi2Real value[]) {
    ALLOW(c, P3 | P4);
    GIVEN(vr, count, value);
    GIVEN(vr, count, order);
    for (size_t n = 0; n < count; n++) {
        if (order[n] != 1)
            return report(in, fmi2Error, "%s: order %d, not 1", __func__, order[n]);
        const char *problem = rate_of(&in->cable, vr[n], &value[n]);
        if (problem != NULL) return refused(in, __func__, vr[n], "", problem);
    }
    return fmi2OK;
}

/* -- steps ------------------------------------------------------------------------------------- */

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real point, fmi2Real size, fmi2Boolean no_set_state) {
    ALLOW(c, P3);
    (void)no_set_state;
    Cable *cable = &in->cable;
    const double time = cable_time(cable);
    if (!(fabs(point) < 1e300) || !(fabs(size) < 1e300))
        return report(in, fmi2Error, "fmi2DoStep: the step is not finite");
    if (size > LONGEST_STEP)
        return report(in, fmi2Error,
                      "fmi2DoStep: at t = %g s: a step of %g s is longer than any that is made (%g s)",
                      time, size, (double)LONGEST_STEP);
    if (!(size > 0.0))
        return report(in, fmi2Error, "fmi2DoStep: at t = %g s: a step must go forward, not by %g s",
                      time, size);
    if (fabs(point - time) > TIME_ROUNDED * (fabs(time) + fabs(point)) + STEP_ROUNDED * size)
        return report(in, fmi2Error, "fmi2DoStep: the step starts at %.17g s, the cable is at %.17g s",
                      point, time);
    const double end = point + size - cable->now.start_time;
    if (!(end > scalars(cable->M)->time))
        return report(in, fmi2Error, "fmi2DoStep: at t = %g s: a step of %g s is lost in rounding",
                      time, size);
    if (in->has_stop_time && point + size > in->stop_time + TIME_ROUNDED * fabs(in->stop_time) + STEP_ROUNDED * size)
        return report(in, fmi2Error, "fmi2DoStep: a step to %g s goes beyond the stop time %g s",
                      point + size, in->stop_time);
    warn_at_first(in, size);
    warn_of_zeros(in);
    char message[400];
    if (step_cable(cable, end, size, message, sizeof message) != OK)
        return report(in, fmi2Discard, "fmi2DoStep: %s", message);
    warn_of_idle_winches(in);
    return fmi2OK;
}

fmi2Status fmi2CancelStep(fmi2Component c) {
    ALLOW(c, ANY);
    return report(in, fmi2Error, "fmi2CancelStep: steps are not asynchronous");
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) {
    ALLOW(c, ANY);
    (void)value;
    return report(in, fmi2Discard, "fmi2GetStatus: no status of kind %d", (int)kind);
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    ALLOW(c, ANY);
    if (kind != fmi2LastSuccessfulTime || value == NULL)
        return report(in, fmi2Discard, "fmi2GetRealStatus: no status of kind %d", (int)kind);
    *value = cable_time(&in->cable);
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value) {
    ALLOW(c, ANY);
    (void)value;
    return report(in, fmi2Discard, "fmi2GetIntegerStatus: no status of kind %d", (int)kind);
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    ALLOW(c, ANY);
    if (kind != fmi2Terminated || value == NULL)
        return report(in, fmi2Discard, "fmi2GetBooleanStatus: no status of kind %d", (int)kind);
    *value = fmi2False; /* a discarded step may be tried again */
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value) {
    ALLOW(c, ANY);
    (void)value;
    return report(in, fmi2Discard, "fmi2GetStringStatus: no status of kind %d", (int)kind);
}

/* -- states ------------------------------------------------------------------------------------ */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    ALLOW(c, ANY);
    if (state == NULL) return report(in, fmi2Error, "fmi2GetFMUstate: an argument is missing");
    /* One that is given is overwritten; it has grown, or shrunk, where the instance's memory has. */
    void *place = realloc(*state, state_bytes(&in->cable));
    if (place == NULL) return report(in, fmi2Error, "fmi2GetFMUstate: out of memory");
    *state = place;
    save_state(&in->cable, *state);
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    ALLOW(c, ANY);
    if (state == NULL) return report(in, fmi2Error, "fmi2SetFMUstate: an argument is missing");
    /* It is in memory, as it was saved: what comes from elsewhere is checked as it comes in. */
    const char *problem = restore_state(&in->cable, state);
    return problem == NULL ? fmi2OK : report(in, fmi2Error, "fmi2SetFMUstate: %s", problem);
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    ALLOW(c, ANY);
    if (state != NULL) {
        free(*state);
        *state = NULL;
    }
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    ALLOW(c, ANY);
    if (state == NULL || size == NULL)
        return report(in, fmi2Error, "fmi2SerializedFMUstateSize: an argument is missing");
    *size = bytes_of_state(state);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[],
                                 size_t size) {
    ALLOW(c, ANY);
    if (state == NULL || bytes == NULL || size < bytes_of_state(state))
        return report(in, fmi2Error, "fmi2SerializeFMUstate: an argument is missing or too small");
    write_state(&in->cable, state, bytes);
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                   fmi2FMUstate *state) {
    ALLOW(c, ANY);
    if (bytes == NULL || state == NULL)
        return report(in, fmi2Error, "fmi2DeSerializeFMUstate: an argument is missing");
    void *copy = malloc(size + 1); /* of no bytes, too */
    if (copy == NULL) return report(in, fmi2Error, "fmi2DeSerializeFMUstate: out of memory");
    memcpy(copy, bytes, size);
    const char *problem = check_state(&in->cable, copy, size);
    if (problem != NULL) {
        free(copy);
        return report(in, fmi2Error, "fmi2DeSerializeFMUstate: %s", problem);
    }
    *state = copy;
    return fmi2OK;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknowns[],
                                        size_t unknown_count, const fmi2ValueReference known[],
                                        size_t known_count, const fmi2Real dv_known[],
                                        fmi2Real dv_unknown[]) {
    ALLOW(c, P2 | P3 | P4);
    GIVEN(unknowns, unknown_count, dv_unknown);
    GIVEN(known, known_count, dv_known);
    for (size_t n = 0; n < known_count; n++)
        if (!(fabs(dv_known[n]) < 1e100))
            return report(in, fmi2Error, "%s: a value is not finite", __func__);
    const char *problem = response_of(&in->cable, unknowns, unknown_count, known, known_count,
                                      dv_known, dv_unknown);
    if (problem != NULL) return report(in, fmi2Error, "%s: %s", __func__, problem);
    if (in->cable.by_place && !(in->warned & PLACE_SAID)) {
        in->warned |= PLACE_SAID;
        report(in, fmi2Warning, "%s: where places drive, derivatives are right along taut lines alone: elsewhere "
               "drive by velocity", __func__);
    }
    return fmi2OK;
}
