// What programs for SUNDIALS share: its context, vectors over rows of the run, and the right-hand side.
#include <nvector/nvector_serial.h>
#include <sundials/sundials_config.h>
#include <sundials/sundials_context.h>

static SUNContext context_of() {
    SUNContext context = nullptr;
#if SUNDIALS_VERSION_MAJOR >= 7
    SUNContext_Create(SUN_COMM_NULL, &context);
#else
    SUNContext_Create(nullptr, &context);
#endif
    return context;
}

static N_Vector vector_of(const double *values, double factor, SUNContext context) {
    N_Vector vector = N_VNew_Serial(VARIABLES, context);
    for (int i = 0; i < VARIABLES; i++) N_VGetArrayPointer(vector)[i] = factor * values[i];
    return vector;
}

static int right(double, N_Vector x, N_Vector d, void *) {
    rates(N_VGetArrayPointer(x), N_VGetArrayPointer(d));
    return 0;
}
