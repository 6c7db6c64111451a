// What the programs share: a problem from the file that is named, the right-hand side with a count of its calls, and
// the answer on stdout, all of it doubles. A library's part defines `integrate`, which alone is timed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <string>
#include <vector>

struct Run {
    double tolerance;             // relative; the absolute one is this times the sizes
    const double *sizes;          // of each variable's swing
    const double *times;          // of output, from 0
    int rows;                     // number of these
    double *states;               // row by row; the first is given
    int reached = 1;              // rows that are filled
    long steps = 0;
    std::string reason;           // why it stopped early
    double first_step() const { return std::min(1e-3, times[1] / 8); }
    double *row(int i) const { return states + static_cast<long>(i) * VARIABLES; }
};

static const double *k;           // parameters of the equations
static long calls = 0;

static void integrate(Run &run);

int main(int count, char **words) {
    std::FILE *file = count == 2 ? std::fopen(words[1], "rb") : nullptr;
    if (!file) return 2;
    std::vector<double> numbers;
    for (double one; std::fread(&one, sizeof one, 1, file) == 1;) numbers.push_back(one);
    std::fclose(file);
    const double *from = numbers.data();
    Run run{};
    run.tolerance = *from++;
    run.rows = static_cast<int>(*from++);
    run.sizes = from, from += VARIABLES;
    std::vector<double> states(static_cast<size_t>(run.rows) * VARIABLES);
    std::copy_n(from, VARIABLES, states.begin()), from += VARIABLES;
    k = from, run.times = from + PARAMETERS, run.states = states.data(), run.reached = 1;
    const std::clock_t start = std::clock();
    try {
        integrate(run);
    } catch (const std::exception &error) {
        run.reason = error.what();
    }
    const double cpu_s = double(std::clock() - start) / CLOCKS_PER_SEC;
    const double head[] = {cpu_s, double(run.steps), double(calls), double(run.reached)};
    std::fwrite(head, sizeof(double), 4, stdout);
    std::fwrite(run.states, sizeof(double), static_cast<size_t>(run.reached) * VARIABLES, stdout);
    std::fwrite(run.reason.data(), 1, run.reason.size(), stdout);
    return 0;
}
