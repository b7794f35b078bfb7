// Grids around an airfoil whose steps grow outwards, and flows there.
#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>

#include "volume/volume_grids.h"

namespace sansmesh::test {

/// Maps a cylinder around the z axis to a Joukowski airfoil four units long with its far field.
inline constexpr double kAirfoilFocus = 0.9;
inline const std::complex<double> kAirfoilMiddle{-0.08, 0.06};
inline std::complex<double> airfoil_map(std::complex<double> zeta) {
  const std::complex<double> s = zeta + kAirfoilMiddle;
  return s + kAirfoilFocus * kAirfoilFocus / s;
}

/// An O-grid: around, outwards with steps that grow by `growth` from a fiftieth of the radius to twenty, four planes.
inline GridBlock airfoil_block(double growth, std::size_t around = 64) {
  constexpr double kFirst = 0.02, kFarthest = 20;
  const auto outwards =
      static_cast<std::size_t>(std::ceil(std::log(1 + kFarthest * (growth - 1) / kFirst) / std::log(growth)));
  GridBlock cylinder = lattice_block({around + 1, outwards + 1, 4}, {0, 0, 0}, {2 * std::numbers::pi, 1, 1.5});
  cylinder.axes[1] = axis_steps(outwards + 1, 1.01, 1.01 + kFarthest, growth);
  return curvilinear_block(cylinder, [](const Vec3& x) {
    const std::complex<double> z = airfoil_map(std::polar(x.y, x.x));
    return Vec3{z.real(), z.imag(), x.z};
  });
}

/// The velocity of the potential flow around the airfoil at an angle of attack, with circulation.
inline std::complex<double> airfoil_flow(const Vec3& x) {
  // The map is inverted by the root outside of the cylinder.
  const std::complex<double> z(x.x, x.y), root = std::sqrt(z * z - 4 * kAirfoilFocus * kAirfoilFocus);
  const std::complex<double> one = 0.5 * (z + root), other = 0.5 * (z - root);
  const std::complex<double> s = std::abs(one - kAirfoilMiddle) > std::abs(other - kAirfoilMiddle) ? one : other;
  const std::complex<double> zeta = s - kAirfoilMiddle, turn = std::polar(1.0, 0.15), i(0, 1);
  const double circulation = 2.2;
  const std::complex<double> by_zeta =
      std::conj(turn) - turn / (zeta * zeta) + i * circulation / (2 * std::numbers::pi * zeta);
  return std::conj(by_zeta / (1.0 - kAirfoilFocus * kAirfoilFocus / (s * s)));
}
inline double airfoil_velocity(const Vec3& x) { return airfoil_flow(x).imag(); }
inline double airfoil_pressure(const Vec3& x) { return 1 - std::norm(airfoil_flow(x)); }
/// The speed along y of a vortex above the airfoil that decays with its age.
inline double decaying_vortex(const Vec3& x) {
  const double dx = x.x - 3, dy = x.y - 2, r = dx * dx + dy * dy;
  return dx * (r < 1e-9 ? 1 / 4.0 : (1 - std::exp(-r / 4)) / r);
}

inline GridData airfoil_grid(double growth, const VolumeFunction& f) { return one_block(airfoil_block(growth), f); }

}  // namespace sansmesh::test
