/* A muscle between pressure and length as an FMU 2.0 for co-simulation, without states.
 *
 * Written by workflow/answers/maps/fmu.py, which puts the tables where TABLES stands below: grids p
 * [MPa] and e [1], and of force [N] and volume [mm3] the value, both derivatives and the mixed one.
 * In a cell a quantity is the bicubic that has these at its corners, as in table.py beside it. Beyond
 * the grid it is that of the nearest state, `valid` is 0, and the simulator's log says so. Outside
 * everything is in SI units. SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef __GNUC__ /* the standard says what functions are given; most need little of it */
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

/*TABLES*/

typedef void *fmi2Component;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer, fmi2Boolean;
typedef const char *fmi2String;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;

enum { PRESSURE, LENGTH, FORCE, VOLUME, FORCE_BY_LENGTH, FORCE_BY_PRESSURE, VALID, VARIABLES };

static const double MEGA = 1e6, MILLI = 1e-3;

typedef struct { /* what a simulator gives; of it the logger alone is called */
    void (*logger)(void *environment, fmi2String name, fmi2Status, fmi2String category, fmi2String message, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, fmi2Status);
    void *environment;
} Callbacks;

typedef struct {
    double value[VARIABLES];
    const Callbacks *callbacks;
    char name[80];
    int warned; /* that it is outside of the table, where it still is */
} Muscle;

static int cell(const double *grid, int count, double x) {
    int low = 0, high = count - 1;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (x >= grid[middle]) low = middle; else high = middle;
    }
    return low;
}

/* Hermite's cubics on (0, 1): of both values, then of both derivatives; or their derivatives. */
static void basis(double s, double size, int derivative, double *b) {
    if (derivative) {
        b[1] = 6*s*(1 - s)/size;
        b[0] = -b[1];
        b[2] = (1 - s)*(1 - 3*s);
        b[3] = s*(3*s - 2);
    } else {
        b[0] = (1 + 2*s)*(1 - s)*(1 - s);
        b[1] = s*s*(3 - 2*s);
        b[2] = size*s*(1 - s)*(1 - s);
        b[3] = size*s*s*(s - 1);
    }
}

static double at(const double *table, int i, int j, double p, double e, int by_p, int by_e) {
    double a[4], b[4], total = 0, dp = P[i + 1] - P[i], de = E[j + 1] - E[j];
    basis((p - P[i])/dp, dp, by_p, a);
    basis((e - E[j])/de, de, by_e, b);
    for (int k = 0; k < 2; ++k)
        for (int m = 0; m < 2; ++m) {
            const double *of = table + 4*((i + k)*NE + j + m); /* value, by p, by e, mixed */
            total += a[k]*b[m]*of[0] + a[2 + k]*b[m]*of[1] + a[k]*b[2 + m]*of[2] + a[2 + k]*b[2 + m]*of[3];
        }
    return total;
}

static double clamp(double x, double low, double high) { return x < low ? low : x > high ? high : x; }

static void evaluate(Muscle *muscle) {
    double *v = muscle->value, length = LENGTH_AT_REST*MILLI;
    double p = v[PRESSURE]/MEGA, e = 1 - v[LENGTH]/length;
    double q = clamp(p, P[0], P[NP - 1]), f = clamp(e, E[0], E[NE - 1]);
    int i = cell(P, NP, q), j = cell(E, NE, f);
    v[FORCE] = at(FORCES, i, j, q, f, 0, 0);
    v[VOLUME] = at(VOLUMES, i, j, q, f, 0, 0)*MILLI*MILLI*MILLI;
    v[FORCE_BY_LENGTH] = -at(FORCES, i, j, q, f, 0, 1)/length;
    v[FORCE_BY_PRESSURE] = at(FORCES, i, j, q, f, 1, 0)/MEGA;
    v[VALID] = q == p && f == e && FOUND[i*NE + j] && FOUND[(i + 1)*NE + j]
               && FOUND[i*NE + j + 1] && FOUND[(i + 1)*NE + j + 1];
}

/* Say that a state has left the table, once each time that it does. */
static void warn(Muscle *muscle) {
    double *v = muscle->value, length = LENGTH_AT_REST*MILLI;
    double shortest = length*(1 - E[NE - 1]), longest = length*(1 - E[0]);
    int is_new = !v[VALID] && !muscle->warned;
    muscle->warned = !v[VALID];
    if (!is_new || !muscle->callbacks || !muscle->callbacks->logger) return;
    char said[300];
    snprintf(said, sizeof said,
             "no state of the table: pressure %g Pa (it has %g to %g), length %g m (it has %g to %g, "
             "not all of them at every pressure); the force is that of the nearest state, valid is 0",
             v[PRESSURE], P[0]*MEGA, P[NP - 1]*MEGA, v[LENGTH], shortest, longest);
    muscle->callbacks->logger(muscle->callbacks->environment, muscle->name, fmi2Warning, "outside", "%s", said);
}

static void start(Muscle *muscle) {
    muscle->value[PRESSURE] = P[0]*MEGA;
    muscle->value[LENGTH] = LENGTH_AT_REST*MILLI;
    muscle->warned = 0;
    evaluate(muscle);
}

const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String *names) {
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, int type, fmi2String guid, fmi2String resources,
                              const void *functions, fmi2Boolean visible, fmi2Boolean logging) {
    if (!guid || strcmp(guid, GUID)) return NULL;
    Muscle *muscle = calloc(1, sizeof *muscle);
    if (!muscle) return NULL;
    muscle->callbacks = functions;
    if (name) strncpy(muscle->name, name, sizeof muscle->name - 1);
    start(muscle);
    return muscle;
}
void fmi2FreeInstance(fmi2Component c) { free(c); }
fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean defined, fmi2Real tolerance, fmi2Real begin,
                               fmi2Boolean ends, fmi2Real end) { return fmi2OK; }
fmi2Status fmi2EnterInitializationMode(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2Terminate(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2Reset(fmi2Component c) { start(c); return fmi2OK; }

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference *which, size_t n, fmi2Real *value) {
    evaluate(c);
    for (size_t k = 0; k < n; ++k) {
        if (which[k] >= VARIABLES) return fmi2Error;
        value[k] = ((Muscle *)c)->value[which[k]];
    }
    return fmi2OK;
}
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference *which, size_t n, const fmi2Real *value) {
    for (size_t k = 0; k < n; ++k) {
        if (which[k] > LENGTH) return fmi2Error;
        ((Muscle *)c)->value[which[k]] = value[k];
    }
    return fmi2OK;
}
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real now, fmi2Real step, fmi2Boolean keep) {
    evaluate(c);
    warn(c);
    return fmi2OK;
}

/* What there is none of: other types, states, derivatives of signals. */
#define NONE(type, name) \
    fmi2Status fmi2Get##name(fmi2Component c, const fmi2ValueReference *w, size_t n, type *v) { \
        return n ? fmi2Error : fmi2OK; } \
    fmi2Status fmi2Set##name(fmi2Component c, const fmi2ValueReference *w, size_t n, const type *v) { \
        return n ? fmi2Error : fmi2OK; }
NONE(fmi2Integer, Integer)
NONE(fmi2Boolean, Boolean)
NONE(fmi2String, String)
fmi2Status fmi2GetFMUstate(fmi2Component c, void **s) { return fmi2Error; }
fmi2Status fmi2SetFMUstate(fmi2Component c, void *s) { return fmi2Error; }
fmi2Status fmi2FreeFMUstate(fmi2Component c, void **s) { return fmi2Error; }
fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, void *s, size_t *n) { return fmi2Error; }
fmi2Status fmi2SerializeFMUstate(fmi2Component c, void *s, char *b, size_t n) { return fmi2Error; }
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const char *b, size_t n, void **s) { return fmi2Error; }
fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference *of, size_t m,
    const fmi2ValueReference *by, size_t n, const fmi2Real *seed, fmi2Real *d) { return fmi2Error; }
fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference *w, size_t n,
    const fmi2Integer *order, const fmi2Real *v) { return fmi2Error; }
fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference *w, size_t n,
    const fmi2Integer *order, fmi2Real *v) { return fmi2Error; }
fmi2Status fmi2CancelStep(fmi2Component c) { return fmi2Error; }
fmi2Status fmi2GetStatus(fmi2Component c, int kind, fmi2Status *s) { return fmi2Discard; }
fmi2Status fmi2GetRealStatus(fmi2Component c, int kind, fmi2Real *v) { return fmi2Discard; }
fmi2Status fmi2GetIntegerStatus(fmi2Component c, int kind, fmi2Integer *v) { return fmi2Discard; }
fmi2Status fmi2GetBooleanStatus(fmi2Component c, int kind, fmi2Boolean *v) { return fmi2Discard; }
fmi2Status fmi2GetStringStatus(fmi2Component c, int kind, fmi2String *v) { return fmi2Discard; }
