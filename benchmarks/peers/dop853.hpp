// SciPy's DOP853, tableau and step control, for six numbers. Events are looked for at the ends of steps and located on
// the dense output.

#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

#include "tableau.hpp"  // written by the benchmark from SciPy's

using V6 = Eigen::Matrix<double, 6, 1>;

struct Dop853 {
  double rtol, atol;

  static double norm(const V6& x) { return std::sqrt(x.squaredNorm() / 6.0); }

  // to a time, or to where a guard falls through zero; returns the time
  template <class F, class G> double advance(F f, G guard, V6& y, double t, double end) {
    V6 k[16], x;
    f(y, k[0]);
    V6 scale = (rtol * y.array().abs() + atol).matrix();
    const double d0 = norm(y.cwiseQuotient(scale)), d1 = norm(k[0].cwiseQuotient(scale));
    double h = d0 < 1e-5 || d1 < 1e-5 ? 1e-6 : 0.01 * d0 / d1;
    h = std::min(h, end - t);
    x = y + h * k[0];
    f(x, k[1]);
    const double d2 = norm((k[1] - k[0]).cwiseQuotient(scale)) / h;
    const double most = std::max(d1, d2);
    const double first = most <= 1e-15 ? std::max(1e-6, 1e-3 * h) : std::pow(0.01 / most, 1.0 / 8);
    h = std::min({100 * h, first, end - t});
    double before = guard(y);
    while (t < end) {
      V6 next;
      for (bool rejected = false;; rejected = true) {
        h = std::min(h, end - t);
        for (int s = 1; s < 12; ++s) {
          x.setZero();
          for (int j = 0; j < s; ++j) if (A[s][j] != 0.0) x += A[s][j] * k[j];
          x = y + h * x;
          f(x, k[s]);
        }
        x.setZero();
        for (int j = 0; j < 12; ++j) x += B[j] * k[j];
        next = y + h * x;
        f(next, k[12]);
        scale = (rtol * y.array().abs().max(next.array().abs()) + atol).matrix();
        V6 e5 = V6::Zero(), e3 = V6::Zero();
        for (int j = 0; j < 13; ++j) { e5 += E5[j] * k[j]; e3 += E3[j] * k[j]; }
        const double n5 = e5.cwiseQuotient(scale).squaredNorm(), n3 = e3.cwiseQuotient(scale).squaredNorm();
        const double error = n5 == 0.0 && n3 == 0.0 ? 0.0 : h * n5 / std::sqrt((n5 + 0.01 * n3) * 6.0);
        const double factor = 0.9 * std::pow(error, -1.0 / 8);
        if (error < 1.0) {
          const double grow = error == 0.0 ? 10.0 : std::min(10.0, factor), used = h;
          h *= rejected ? std::min(1.0, grow) : grow;
          const double after = guard(next);
          if (before > 0.0 && after <= 0.0) return locate(f, guard, k, y, next, t, used);
          before = after;
          y = next; k[0] = k[12]; t = end - t - used < 1e-15 ? end : t + used;
          break;
        }
        h *= std::max(0.2, factor);
      }
    }
    return t;
  }

  // the event on the step's dense output, by the Illinois method
  template <class F, class G> double locate(F f, G guard, V6* k, V6& y, const V6& next, double t, double h) {
    V6 x, c[7];
    for (int s = 13; s < 16; ++s) {
      x.setZero();
      for (int j = 0; j < s; ++j) if (A[s][j] != 0.0) x += A[s][j] * k[j];
      x = y + h * x;
      f(x, k[s]);
    }
    c[0] = next - y; c[1] = h * k[0] - c[0]; c[2] = 2 * c[0] - h * (k[12] + k[0]);
    for (int i = 0; i < 4; ++i) {
      c[3 + i].setZero();
      for (int j = 0; j < 16; ++j) c[3 + i] += h * D[i][j] * k[j];
    }
    const V6 start = y;
    const auto at = [&](double u) {
      V6 sum = V6::Zero();
      for (int i = 6; i >= 0; --i) sum = (sum + c[i]) * ((6 - i) % 2 == 0 ? u : 1.0 - u);
      return V6(start + sum);
    };
    double a = 0, b = 1, ga = guard(at(a)), gb = guard(at(b));
    for (int i = 0, last = 0; i < 60 && b - a > 1e-15; ++i) {
      const double u = (a * gb - b * ga) / (gb - ga), g = guard(at(u));
      if (g == 0.0) { a = b = u; break; }
      if (g > 0.0) { a = u; ga = g; if (last == 1) gb *= 0.5; last = 1; }
      else { b = u; gb = g; if (last == -1) ga *= 0.5; last = -1; }
    }
    y = at(b);
    return t + b * h;
  }
};
