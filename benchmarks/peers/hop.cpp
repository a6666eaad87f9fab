// The hop by Pinocchio in C++, as one writes it for a single robot: matrices of fixed size, closed forms for the force
// of the ground, the integrator in dop853.hpp. Numbers come on stdin; then, for each line "n", the hop is run n times
// from every state, and the CPU time and the end states are printed.

#include <pinocchio/multibody.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/rnea.hpp>

#include <cmath>
#include <cstdio>
#include <ctime>
#include <iostream>
#include <string>
#include <vector>

#include "dop853.hpp"

namespace pin = pinocchio;

// the joints of this robot only: the compiler has a tenth of the work, and the choice at run time is among fewer
template <typename Scalar_, int Options_> struct Joints {
  typedef Scalar_ Scalar;
  enum { Options = Options_ };
  typedef boost::variant<pin::JointModelPZ, pin::JointModelRevoluteUnaligned, pin::JointModelRY> JointModelVariant;
  typedef boost::variant<pin::JointDataPZ, pin::JointDataRevoluteUnaligned, pin::JointDataRY> JointDataVariant;
};
using Model = pin::ModelTpl<double, 0, Joints>;
using Data = pin::DataTpl<double, 0, Joints>;
using V3 = Eigen::Vector3d;
using J23 = Eigen::Matrix<double, 2, 3>;

static double number() { double x; std::cin >> x; return x; }

struct Hopper : Dop853 {
  Model model;
  Data data;
  pin::FrameIndex toe;
  double torque, hip, knee, frequency, hip_gain, hip_damping, knee_gain, knee_damping, hip_stance;
  double stiffness, damping, friction, latched = 0, sign = 1, side = 1;
  const V3 zero = V3::Zero();

  Hopper() : toe(0) {
    pin::JointIndex parent = 0;
    for (int i = 0; i < 3; ++i) {
      const double axis = number();
      V3 offset, com, inertia;
      for (int k = 0; k < 3; ++k) offset[k] = number();
      const double mass = number();
      for (int k = 0; k < 3; ++k) com[k] = number();
      for (int k = 0; k < 3; ++k) inertia[k] = number();
      const pin::SE3 placement(Eigen::Matrix3d::Identity(), offset);
      if (i == 0) parent = model.addJoint(parent, pin::JointModelPZ(), placement, "z");
      else if (axis < 0) parent = model.addJoint(parent, pin::JointModelRevoluteUnaligned(0, -1, 0), placement, "hip");
      else parent = model.addJoint(parent, pin::JointModelRY(), placement, "knee");
      model.appendBodyToJoint(parent, pin::Inertia(mass, com, Eigen::Matrix3d(inertia.asDiagonal())));
      model.armature[i] = number();
    }
    V3 offset;
    for (int k = 0; k < 3; ++k) offset[k] = number();
    toe = model.addFrame(pin::Frame("toe", parent, pin::SE3(Eigen::Matrix3d::Identity(), offset), pin::OP_FRAME));
    data = Data(model);
    rtol = number(); atol = 0.01 * rtol;
    torque = number(); hip = number(); knee = number(); frequency = number(); hip_gain = number();
    hip_damping = number(); knee_gain = number(); knee_damping = number(); hip_stance = number();
    stiffness = number(); damping = number(); friction = number();
  }

  // M, bias, J and the toe's acceleration at zero joint acceleration, then the free acceleration
  void ground(const V6& y, J23& rows, Eigen::LLT<Eigen::Matrix3d>& mass, V3& free, Eigen::Vector2d& rest) {
    const V3 q = y.head<3>(), v = y.tail<3>();
    pin::crba(model, data, q, pin::Convention::WORLD);
    data.M.triangularView<Eigen::StrictlyLower>() = data.M.transpose();
    const V3 bias = pin::rnea(model, data, q, v, zero);
    pin::forwardKinematics(model, data, q, v, zero);
    pin::computeJointJacobians(model, data, q);
    pin::updateFramePlacement(model, data, toe);
    Eigen::Matrix<double, 6, 3> jacobian = Eigen::Matrix<double, 6, 3>::Zero();
    pin::getFrameJacobian(model, data, toe, pin::LOCAL_WORLD_ALIGNED, jacobian);
    rows.row(0) = jacobian.row(0); rows.row(1) = jacobian.row(2);
    const V3 drift = pin::getFrameClassicalAcceleration(model, data, toe, pin::LOCAL_WORLD_ALIGNED).linear();
    V3 tau(0.0, hip_stance, sign * torque - damping * v[2]);
    if (q[2] > latched) tau[2] -= stiffness * (q[2] - latched);
    mass.compute(Eigen::Matrix3d(data.M));
    free = mass.solve(tau - bias);
    rest = rows * free + Eigen::Vector2d(drift[0], drift[2]);
  }

  Eigen::Vector2d stick(const V6& y, V6& f) {
    J23 rows; Eigen::LLT<Eigen::Matrix3d> mass; V3 free; Eigen::Vector2d rest;
    ground(y, rows, mass, free, rest);
    const Eigen::Matrix<double, 3, 2> response = mass.solve(rows.transpose());
    const Eigen::Vector2d force = -(rows * response).inverse() * rest;
    f << y.tail<3>(), free + response * force;
    return force;
  }

  double slip(const V6& y, V6& f) {
    J23 rows; Eigen::LLT<Eigen::Matrix3d> mass; V3 free; Eigen::Vector2d rest;
    ground(y, rows, mass, free, rest);
    const V3 push = mass.solve((rows.row(1) - side * friction * rows.row(0)).transpose());
    const double normal = -rest[1] / rows.row(1).dot(push);
    f << y.tail<3>(), free + normal * push;
    return normal;
  }

  void fly(const V6& y, V6& f) {
    const V3 tau(0.0, hip_gain * (hip - y[1]) - hip_damping * y[4], knee_gain * (knee - y[2]) - knee_damping * y[5]);
    const V3 q = y.head<3>(), v = y.tail<3>();
    f << v, pin::aba(model, data, q, v, tau);
  }

  double height(const V6& y) {
    pin::forwardKinematics(model, data, V3(y.head<3>()));
    return pin::updateFramePlacement(model, data, toe).translation()[2];
  }

  V3 strike(const V6& y) {
    J23 rows; Eigen::LLT<Eigen::Matrix3d> mass; V3 free; Eigen::Vector2d rest;
    ground(y, rows, mass, free, rest);
    const Eigen::Matrix<double, 3, 2> response = mass.solve(rows.transpose());
    const Eigen::Vector2d impulse = (rows * response).inverse() * (rows * y.tail<3>());
    return y.tail<3>() - response * impulse;
  }

  V6 hop(V6 y) {
    const double half = 0.5 / frequency;
    V6 scratch;
    const auto sticking = [&](const V6& y, V6& f) { stick(y, f); };
    const auto flying = [&](const V6& y, V6& f) { fly(y, f); };
    const auto cone = [&](const V6& y) {
      const Eigen::Vector2d force = stick(y, scratch);
      return friction * force[1] - std::abs(force[0]);
    };
    latched = y[2]; sign = 1.0;
    double t = advance(sticking, cone, y, 0.0, half);
    sign = -1.0;
    t = advance(sticking, cone, y, t, 2 * half);
    side = stick(y, scratch)[0] < 0 ? 1.0 : -1.0;
    t = advance([&](const V6& y, V6& f) { slip(y, f); }, [&](const V6& y) { return slip(y, scratch); }, y, t, 2 * half);
    t = advance(flying, [](const V6& y) { return y[3]; }, y, t, 5.0);
    advance(flying, [&](const V6& y) { return height(y); }, y, t, 5.0);
    y.tail<3>() = strike(y);
    return y;
  }
};

int main() {
  Hopper hopper;
  std::vector<V6, Eigen::aligned_allocator<V6>> states(static_cast<size_t>(number()));
  for (auto& y : states) for (int i = 0; i < 6; ++i) y[i] = number();
  auto ends = states;
  for (int n; std::cin >> n;) {
    const std::clock_t begin = std::clock();
    for (int i = 0; i < n; ++i) for (size_t j = 0; j < states.size(); ++j) ends[j] = hopper.hop(states[j]);
    std::printf("%.9f", double(std::clock() - begin) / CLOCKS_PER_SEC);
    for (const auto& y : ends) for (int i = 0; i < 6; ++i) std::printf(" %.17g", y[i]);
    std::printf("\n");
    std::fflush(stdout);
  }
}
