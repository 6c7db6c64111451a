// The Foucault pendulum from Newton's law, in many digits: what tests/bench/sweep_truth.py compares sweeps with.
//
//     g++ -O2 -o sweep_truth sweep_truth.cpp -lmpfr -lgmpxx -lgmp && ./sweep_truth DIGITS < rows.csv > truth.jsonl
//
// A row is kind,length,drag,latitude,altitude,gravity,gravity_is,rotation_rate,equatorial_radius,inverse_flattening,t_end
// and x,y,vx,vy (kind xy) or angle,azimuth,angle_rate,azimuth_rate (kind angle); metres, seconds, degrees, as decimals.
//
// In axes that do not turn, the bob is at S + E r: S the suspension and E the axes east, north and up, both carried
// round by the Earth. Newton's law for it is r'' = f - λ r, λ r the pull of the cord and
//     f = gravity - W × (W × (s + r)) - 2 W × r' - drag r',    W the Earth's rotation, s from its axis to the suspension.
// The cord keeps its length, r·r = l²; twice differentiated, λ l² = r'·r' + r·f. One step is a Taylor polynomial, after
// which r and r' are put back on the sphere; the zeros of xdot and of the height's rate are isolated on it by its
// Bernstein coefficients: no change of sign among them, no zero; one, exactly one zero; else the step is halved. The
// series are integers: over the length, times 2^bits, time in units of 2^unit seconds, about a step, so that no
// coefficient is large; bits are more where a small swing, or one that dies away, would lose them.
#include <boost/multiprecision/mpfr.hpp>
#include <gmpxx.h>
#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

namespace mp = boost::multiprecision;
using Real = mp::number<mp::mpfr_float_backend<0>, mp::et_off>;
using Vector = std::array<Real, 3>;
using Series = std::vector<mpz_class>;
using Found = std::function<void(const mpz_class&)>;

int order, bits;
std::vector<Series> share;  // C(i, j)/C(order, j): the part of a power's coefficient in the i-th Bernstein coefficient
Real pi;

mpz_class fixed(const Real& x) {
  mpz_class n;
  Real scaled = ldexp(x, bits);
  mpfr_get_z(n.get_mpz_t(), scaled.backend().data(), MPFR_RNDN);
  return n;
}

Real real(const mpz_class& n) {
  Real x = 0;
  mpfr_set_z_2exp(x.backend().data(), n.get_mpz_t(), -bits, MPFR_RNDN);
  return x;
}

void set_digits(int digits) {
  Real::default_precision(digits + 3);
  bits = int(digits * 3.33);
  order = int(0.36 * bits);
  pi = boost::math::constants::pi<Real>();
  share.assign(order + 1, Series(order + 1));
  for (int i = 0; i <= order; i++) {
    Real part = 1;
    for (int j = 0; j <= i; j++) share[i][j] = fixed(part), part *= Real(i - j) / (order - j ? order - j : 1);
  }
}

Real dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Adds the k-th coefficient of the product of two series to `sum`, which has twice the bits
void add_product(mpz_class& sum, const Series& a, const Series& b, int k) {
  for (int i = 0; i <= k; i++) mpz_addmul(sum.get_mpz_t(), a[i].get_mpz_t(), b[k - i].get_mpz_t());
}

void add_square(mpz_class& sum, const Series& a, int k) {
  mpz_class half;
  for (int i = 0; 2 * i < k; i++) mpz_addmul(half.get_mpz_t(), a[i].get_mpz_t(), a[k - i].get_mpz_t());
  sum += 2 * half;
  if (k % 2 == 0) mpz_addmul(sum.get_mpz_t(), a[k / 2].get_mpz_t(), a[k / 2].get_mpz_t());
}

mpz_class value(const Series& a, const mpz_class& at) {
  mpz_class sum = a.back();
  for (int k = int(a.size()) - 2; k >= 0; k--) sum = ((sum * at) >> bits) + a[k];
  return sum;
}

Series derivative(const Series& a) {
  Series b;
  for (size_t k = 1; k < a.size(); k++) b.push_back(a[k] * int(k));
  return b;
}

// Sine and cosine of degrees, exact at multiples of 90
void turn(const Real& degrees, Real& sine, Real& cosine) {
  Real quarter = round(degrees / 90), rest = (degrees - quarter * 90) * pi / 180, s = sin(rest), c = cos(rest);
  int which = int(quarter.convert_to<long>() % 4 + 4) % 4;
  sine = which == 0 ? s : which == 1 ? c : which == 2 ? Real(-s) : Real(-c);
  cosine = which == 0 ? c : which == 1 ? Real(-s) : which == 2 ? Real(-c) : s;
}

struct Motion {
  Real length, drag, rate, t_end;
  Vector still, turning, r, v;  // f at the suspension without motion; W; position and velocity
  int unit = 0;
  std::array<Series, 3> rs, vs;

  // Fills the Taylor series of r and v from their values; returns a step, in units, with an error below the precision
  double expand() {
    std::array<Series, 3> f;
    Series lambda(order + 1);
    mpz_class constant[3], w[3], square = fixed(ldexp(rate * rate, 2 * unit)), slow = fixed(ldexp(drag, unit));
    for (int i = 0; i < 3; i++) {
      f[i].resize(order + 1), rs[i].resize(order + 1), vs[i].resize(order + 1);
      rs[i][0] = fixed(r[i] / length), vs[i][0] = fixed(ldexp(v[i] / length, unit));
      constant[i] = fixed(ldexp(still[i] / length, 2 * unit)), w[i] = fixed(ldexp(turning[i], unit));
    }
    for (int k = 0; k <= order; k++) {
      const mpz_class a[3] = {rs[0][k], rs[1][k], rs[2][k]}, b[3] = {vs[0][k], vs[1][k], vs[2][k]};
      mpz_class along = (w[1] * a[1] + w[2] * a[2]) >> bits, pull = 0;
      const mpz_class coriolis[3] = {w[1] * b[2] - w[2] * b[1], w[2] * b[0], -w[1] * b[0]};
      for (int i = 0; i < 3; i++) {
        f[i][k] = (square * a[i] - w[i] * along - 2 * coriolis[i] - slow * b[i]) >> bits;
        if (k == 0) f[i][k] += constant[i];
        add_square(pull, vs[i], k), add_product(pull, rs[i], f[i], k);
      }
      lambda[k] = pull >> bits;
      for (int i = 0; i < 3 && k < order; i++) {
        mpz_class cord = 0;
        add_product(cord, rs[i], lambda, k);
        vs[i][k + 1] = (f[i][k] - (cord >> bits)) / (k + 1), rs[i][k + 1] = b[i] / (k + 1);
      }
    }
    double step = 1;  // beyond it, coefficients too small to be seen may count
    for (int k : {order - 1, order})
      for (int i = 0; i < 3; i++)
        if (rs[i][k] != 0) {
          long exponent;
          double size = std::abs(mpz_get_d_2exp(&exponent, rs[i][k].get_mpz_t()));
          step = std::min(step, std::exp2(-(std::log2(size) + exponent) / k));
        }
    return step;
  }

  void advance(const mpz_class& step) {
    for (int i = 0; i < 3; i++) {
      r[i] = length * real(value(rs[i], step)), v[i] = length * ldexp(real(value(vs[i], step)), -unit);
    }
    Real longer = sqrt(dot(r, r)) / length;
    for (int i = 0; i < 3; i++) r[i] /= longer;
    Real along = dot(r, v) / (length * length);
    for (int i = 0; i < 3; i++) v[i] -= along * r[i];
  }
};

int changes(const Series& b) {
  int count = 0, last = 0;
  for (const mpz_class& value : b)
    if (int s = sgn(value)) count += last && s != last, last = s;
  return count;
}

// Calls `found` at each zero in (low, high], in order; returns false where it cannot tell
bool zeros(const Series& f, const Series& b, const mpz_class& low, const mpz_class& high, const Found& found) {
  int count = changes(b);
  if (count == 0) return true;
  if (count == 1 && sgn(b.front()) && sgn(b.back())) {
    Series slope = derivative(f);
    mpz_class left = low, right = high, at = (low + high) / 2;
    while (right - left > 1) {
      mpz_class height = value(f, at), steep = value(slope, at), next = at;
      (sgn(height) == sgn(b.front()) ? left : right) = at;
      if (steep != 0) next -= (height << bits) / steep;
      if (next == at) break;
      if (next <= left || next >= right) next = (left + right) / 2;
      at = next;
    }
    found(at);
    return true;
  }
  if (high - low < 4) return false;
  Series left = b, right = b;  // de Casteljau at the middle
  for (int k = 1; k <= order; k++) {
    for (int i = 0; i <= order - k; i++) right[i] = (right[i] + right[i + 1]) >> 1;
    left[k] = right[0];
  }
  mpz_class middle = (low + high) / 2;
  bool sure = zeros(f, left, low, middle, found);
  return zeros(f, right, middle, high, found) && sure;
}

// The same for (0, step]; `start` says that this is the release, where a zero is none
bool zeros_of_step(Series f, const mpz_class& step, bool start, const Found& found) {
  mpz_class power = mpz_class(1) << bits, noise = 1 << 12, largest;
  for (int j = 0; j <= order; j++) largest = std::max<mpz_class>(largest, abs(f[j]));
  if (largest <= noise) return true;  // zero at all times, or not to be told from it
  while (start && abs(f[0]) <= noise) f.erase(f.begin()), f.push_back(0);
  Series b(order + 1), scaled = f;
  for (int j = 0; j <= order; j++) scaled[j] = (f[j] * power) >> bits, power = (power * step) >> bits;
  for (int i = 0; i <= order; i++) {
    for (int j = 0; j <= i; j++) mpz_addmul(b[i].get_mpz_t(), share[i][j].get_mpz_t(), scaled[j].get_mpz_t());
    b[i] >>= bits;
  }
  return zeros(f, b, 0, step, found);
}

void solve(const std::string& line, const std::vector<std::string>& word, int digits) {
  auto number = [&](int i) { return Real(word[i]); };
  for (int pass = 0; pass < 2; pass++) {  // the second with more digits, as many as a small swing loses
    if (pass == 0) set_digits(digits);
    Real s, c, degree = pi / 180, n = 0;
    Motion m{number(1), number(2), number(7), number(10), {}, {}, {}, {}, 0, {}, {}};
    turn(number(3), s, c);
    if (word[6] == "ellipsoid") {
      Real f = word[9] == "inf" ? Real(0) : 1 / number(9);
      n = (number(8) / sqrt(1 - f * (2 - f) * s * s) + number(4)) * c;  // from the Earth's axis
    }
    m.turning = {Real(0), m.rate * c, m.rate * s};
    m.still = {Real(0), -m.rate * m.rate * n * s, m.rate * m.rate * n * c - number(5)};
    if (word[0] == "xy") {
      Real x = number(11), y = number(12), z = -sqrt(m.length * m.length - x * x - y * y);
      m.r = {x, y, z}, m.v = {number(13), number(14), -(x * number(13) + y * number(14)) / z};
    } else {
      Real st, ct, sa, ca, up = number(13) * degree, round = number(14) * degree;
      turn(number(11), st, ct), turn(number(12), sa, ca);
      m.r = {m.length * st * ca, m.length * st * sa, -m.length * ct};
      m.v = {up * ct * ca - round * st * sa, up * ct * sa + round * st * ca, up * st};
      for (Real& part : m.v) part *= m.length;
    }
    Real force = sqrt(dot(m.still, m.still)), period = 2 * pi * sqrt(m.length / force);
    Vector up{Real(0), -m.still[1] / force, -m.still[2] / force};  // along the plumb line
    mpz_class north = fixed(up[1]), above = fixed(up[2]);
    auto across = [&](const Vector& r) { return Vector{r[0], r[1] * up[2] - r[2] * up[1], dot(r, up)}; };
    auto angle = [&](const Vector& d) { return Real(atan2(sqrt(d[0] * d[0] + d[1] * d[1]), -d[2]) / degree); };
    Real speed = sqrt(dot(m.v, m.v)), largest = angle(across(m.r));
    if (pass == 0) {
      double reach = Real(largest * degree + speed * period / 6 / m.length).convert_to<double>();
      double decay = (m.t_end * std::min<Real>(m.drag / 2, 2 * pi / period)).convert_to<double>();
      int lost = int(-2 * std::log10(std::min(std::max(reach, 1e-30), 1.0)) + 0.9 * decay);
      if (lost > 3) { set_digits(digits + std::min(lost, 80)); continue; }
      pass = 1;
    }
    std::vector<Real> transits;
    std::vector<int> directions;
    bool sure = true;
    int close = 0, highest = 0;
    Real t = 0, first, last, azimuth, turned = 0, least_bend = 1;
    m.unit = ilogb(std::min<Real>(period / 8, m.t_end).convert_to<double>());
    while (t < m.t_end) {
      double wished = m.expand();
      Real length_left = ldexp(m.t_end - t, -m.unit);
      bool at_end = length_left <= wished;
      mpz_class step = fixed(at_end ? length_left : Real(wished));
      Series rise(order + 1);
      for (int k = 0; k <= order; k++) rise[k] = (north * m.vs[1][k] + above * m.vs[2][k]) >> bits;
      Series ax = derivative(m.vs[0]), bend = derivative(rise);
      auto time = [&](const mpz_class& at) { return Real(t + ldexp(real(at), m.unit)); };
      sure &= zeros_of_step(m.vs[0], step, t == 0, [&](const mpz_class& at) {
        close += transits.size() && time(at) - transits.back() < period / 4;
        transits.push_back(time(at)), directions.push_back(sgn(value(ax, at)));
      });
      sure &= zeros_of_step(rise, step, t == 0, [&](const mpz_class& at) {
        mpz_class curve = value(bend, at);
        if (curve >= 0) return;
        Vector d = across({real(value(m.rs[0], at)), real(value(m.rs[1], at)), real(value(m.rs[2], at))});
        Real wide = d[0] * d[0] + d[1] * d[1], now = atan2(d[1], d[0]);
        largest = std::max<Real>(largest, angle(d));
        least_bend = std::min<Real>(least_bend, -ldexp(real(curve), -2 * m.unit) * m.length / force / wide);
        if (highest++) turned += now - azimuth - pi * round((now - azimuth) / pi);
        else first = time(at);
        azimuth = now, last = time(at);
      });
      m.advance(step);
      t = at_end ? m.t_end : time(step);
      m.unit += wished < 1 ? int(std::round(std::log2(wished))) : 1;
    }
    largest = std::max<Real>(largest, angle(across(m.r)));
    auto text = [](const Real& x) { return "\"" + x.str(34, std::ios_base::scientific) + "\""; };
    auto say = [](const std::string& name, const auto& said) { std::cout << ", \"" << name << "\": " << said; };
    auto list = [](int count, const std::function<std::string(int)>& item) {
      std::string all = "[";
      for (int i = 0; i < count; i++) all += (i ? ", " : "") + item(i);
      return all + "]";
    };
    std::cout << "{\"row\": \"" << line << "\"";
    say("sure", sure ? "true" : "false"), say("close_pairs", close), say("highest", highest);
    say("least_bend", text(least_bend)), say("max_angle_deg", text(largest));
    say("state", list(6, [&](int i) { return text(i < 3 ? m.r[i] : m.v[i - 3]); }));
    if (highest > 1) {
      Real turning = turned / (last - first) / degree * 3600;
      say("swing_hz", text((highest - 1) / (2 * (last - first)))), say("precession_deg_per_h", text(turning));
      if (m.turning[2] != 0) say("precession_ratio", text(-turning * degree / 3600 / m.turning[2]));
    }
    int count = transits.size();
    if (count > 1) say("frequency_hz", text((count - 1) / (2 * (transits.back() - transits[0]))));
    say("t", list(count, [&](int i) { return text(transits[i]); }));
    say("direction", list(count, [&](int i) { return std::to_string(directions[i]); }));
    std::cout << "}" << std::endl;
  }
}

int main(int count, char** words) {
  int digits = count > 1 ? std::stoi(words[1]) : 37;
  for (std::string line, word; std::getline(std::cin, line);) {
    std::vector<std::string> row;
    for (std::istringstream cells(line); std::getline(cells, word, ',');) row.push_back(word);
    solve(line, row, digits);
  }
}
