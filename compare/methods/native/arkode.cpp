// ARKODE of SUNDIALS: explicit Runge-Kutta; steps end on the times of output, because its dense output has order 5.
#include <arkode/arkode_erkstep.h>

static void integrate(Run &run) {
    SUNContext context = context_of();
    N_Vector state = vector_of(run.row(0), 1.0, context);
    void *memory = ERKStepCreate(right, 0.0, state, context);
    ERKStepSVtolerances(memory, run.tolerance, vector_of(run.sizes, run.tolerance, context));
    ERKStepSetOrder(memory, 8);
    ERKStepSetMaxNumSteps(memory, -1);
    for (double t; run.reached < run.rows; run.reached++) {
        ERKStepSetStopTime(memory, run.times[run.reached]);
        const int status = ERKStepEvolve(memory, run.times[run.reached], state, &t, ARK_NORMAL);
        if (status < 0) {
            char *name = ERKStepGetReturnFlagName(status);
            run.reason = name;
            break;
        }
        std::copy_n(N_VGetArrayPointer(state), VARIABLES, run.row(run.reached));
    }
    ERKStepGetNumSteps(memory, &run.steps);
}
