// Boost odeint's Runge-Kutta-Fehlberg 7(8) on rows from stdin: tolerance and span, then of each row n, H, Ω and c.
// Prints the CPU seconds, then n of each row at the end.
#include <array>
#include <boost/numeric/odeint.hpp>
#include <cstdio>
#include <ctime>
#include <vector>

using State = std::array<double, 6>;
using Row = std::array<double, 10>;

int main() {
    double tolerance, span;
    if (std::scanf("%lf %lf", &tolerance, &span) != 2) return 1;
    std::vector<Row> rows;
    for (Row row;;) {
        bool whole = true;
        for (double &value : row) whole = whole && std::scanf("%lf", &value) == 1;
        if (!whole) break;
        rows.push_back(row);
    }
    std::vector<State> ends;
    const std::clock_t start = std::clock();
    for (const Row &row : rows) {
        State state{row[0], row[1], row[2], row[3], row[4], row[5]};
        const double on = row[6], ou = row[7], cn = row[8], cu = row[9];
        auto rates = [=](const State &s, State &d, double) {
            const double x = s[0], y = s[1], z = s[2], hx = s[3], hy = s[4], hz = s[5], wy = hy - on, wz = hz - ou;
            d = {wy * z - wz * y,           wz * x - hx * z,   hx * y - wy * x,
                 y * cu - z * cn + hy * ou - hz * on, -x * cu - hx * ou, x * cn + hx * on};
        };
        using namespace boost::numeric::odeint;
        auto stepper = make_controlled(tolerance, tolerance, runge_kutta_fehlberg78<State>());
        integrate_adaptive(stepper, rates, state, 0.0, span, 0.1);
        ends.push_back(state);
    }
    std::printf("%.6f\n", double(std::clock() - start) / CLOCKS_PER_SEC);
    for (const State &end : ends) std::printf("%.17g %.17g %.17g\n", end[0], end[1], end[2]);
}
