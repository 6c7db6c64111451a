// Boost odeint: steps end on the times of output.
#include <array>
#include <boost/numeric/odeint.hpp>

using State = std::array<double, VARIABLES>;

static void integrate(Run &run) {
    namespace odeint = boost::numeric::odeint;
    const double absolute = run.tolerance * *std::min_element(run.sizes, run.sizes + VARIABLES);
#ifdef BULIRSCH_STOER
    auto stepper = odeint::bulirsch_stoer<State>(absolute, run.tolerance);
#else
    auto stepper = odeint::make_controlled(absolute, run.tolerance, odeint::runge_kutta_fehlberg78<State>());
#endif
    State state;
    std::copy_n(run.row(0), VARIABLES, state.begin());
    run.reached = 0;
    auto system = [](const State &x, State &d, double) { rates(x.data(), d.data()); };
    auto keep = [&](const State &x, double) { std::copy_n(x.begin(), VARIABLES, run.row(run.reached++)); };
    run.steps = odeint::integrate_times(stepper, system, state, run.times, run.times + run.rows, run.first_step(), keep);
}
