// CVODE of SUNDIALS: Newton's method with the dense Jacobian, its own dense output.
#include <cvode/cvode.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

static int slopes_of(double, N_Vector x, N_Vector, SUNMatrix matrix, void *, N_Vector, N_Vector, N_Vector) {
    double j[VARIABLES * VARIABLES];
    slopes(N_VGetArrayPointer(x), j);
    for (int row = 0; row < VARIABLES; row++)
        for (int column = 0; column < VARIABLES; column++)
            SM_ELEMENT_D(matrix, row, column) = j[row * VARIABLES + column];
    return 0;
}

static void integrate(Run &run) {
    SUNContext context = context_of();
    N_Vector state = vector_of(run.row(0), 1.0, context);
    void *memory = CVodeCreate(MULTISTEP, context);
    CVodeInit(memory, right, 0.0, state);
    CVodeSVtolerances(memory, run.tolerance, vector_of(run.sizes, run.tolerance, context));
    SUNMatrix matrix = SUNDenseMatrix(VARIABLES, VARIABLES, context);
    CVodeSetLinearSolver(memory, SUNLinSol_Dense(state, matrix, context), matrix);
    CVodeSetJacFn(memory, slopes_of);
    CVodeSetMaxNumSteps(memory, -1);
    for (double t; run.reached < run.rows; run.reached++) {
        const int status = CVode(memory, run.times[run.reached], state, &t, CV_NORMAL);
        if (status < 0) {
            run.reason = CVodeGetReturnFlagName(status);
            break;
        }
        std::copy_n(N_VGetArrayPointer(state), VARIABLES, run.row(run.reached));
    }
    CVodeGetNumSteps(memory, &run.steps);
}
