// GSL's odeiv2: Prince-Dormand 8(9); steps end on the times of output.
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

static int right(double, const double *x, double *d, void *) {
    rates(x, d);
    return GSL_SUCCESS;
}

static void integrate(Run &run) {
    gsl_set_error_handler_off();
    gsl_odeiv2_system system{right, nullptr, VARIABLES, nullptr};
    gsl_odeiv2_driver *driver = gsl_odeiv2_driver_alloc_scaled_new(
        &system, gsl_odeiv2_step_rk8pd, run.first_step(), run.tolerance, run.tolerance, 1.0, 0.0, run.sizes);
    std::vector<double> state(run.row(0), run.row(1));
    double t = 0.0;
    for (; run.reached < run.rows; run.reached++) {
        const int status = gsl_odeiv2_driver_apply(driver, &t, run.times[run.reached], state.data());
        if (status != GSL_SUCCESS) {
            run.reason = std::string("GSL: ") + gsl_strerror(status);
            break;
        }
        std::copy(state.begin(), state.end(), run.row(run.reached));
    }
    run.steps = static_cast<long>(driver->e->count);
    gsl_odeiv2_driver_free(driver);
}
