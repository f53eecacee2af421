/// @file predicted_time.h  Prediction of the processor time of a run: from the measured first steps, the cost of its
/// bodies in a settled packing, and its output. Based on processor time and counts, so other programs have no
/// influence.
///
/// Unit costs were measured on one machine (Zen 5) and are scaled by the speed of this one in a short loop. Right to a
/// factor of two for bodies that settle under gravity; solvers with unusually many iterations are not predicted.
#pragma once
#include <algorithm>
#include <cmath>

#include "scenes/processor_time.h"

namespace epafi {

namespace predicted {

// seconds by one thread of the machine of the prices; pile/polyhedra, bed/bed, stability/*, impact/*, and settled beds
// of 60 of each shape in smooth contact
inline constexpr double start_of_run = 0.02;      // folder, run.h5, first and last state
inline constexpr double output_itself = 2e-3;     // frame, snapshot, list of frames
inline constexpr double output_body = 0.5e-6;     // a body in them
inline constexpr double output_point = 1.2e-6;    // and a point of its surface: shapes differ by a factor of 60
inline constexpr double smooth_sphere = 0.06e-6;  // in a packing, a step
inline constexpr double smooth_clump = 0.5e-6;
inline constexpr double smooth_capsule = 0.8e-6;
inline constexpr double smooth_round = 3.5e-6;  // cylinder, ellipsoid
inline constexpr double smooth_superquadric = 11e-6;
inline constexpr double smooth_polyhedron = 3e-6;
inline constexpr double nonsmooth_sphere = 0.5e-6;
inline constexpr double nonsmooth_polyhedron = 5e-6;
inline constexpr double sweep_sphere = 0.12e-6;  // with its three contacts
inline constexpr double sweep_polyhedron = 0.16e-6;
inline constexpr double read_contacts = 0.4e-6;    // a measure that reads all contacts of a packing, a body
inline constexpr double loop_time = 0.70e-3;       // of machine_speed()
inline constexpr double bodies_of_a_thread = 512;  // loops of fewer are not shared out

}  // namespace predicted

/// Input of the prediction: amounts of work of a run.
struct RunCounts {
  double steps = 0.0;                       ///< of the whole run
  double bodies = 0.0;                      ///< free ones, those that come later too
  double polyhedra = 0.0;                   ///< of them: boxes, polyhedra, solids; with a solver all that are no balls
  double other = predicted::smooth_sphere;  ///< one of the others in a smooth packing, a step [s]
  double outputs = 0.0;                     ///< frames and snapshots
  double points = 0.0;                      ///< of the surfaces that a frame draws, of all bodies
  double sweeps = 0.0;                      ///< of a non-smooth solver in a step of a packing; 0: smooth
  double loose = 0.0;                       ///< share of the contacts of a packing that are still to come, in [0, 1]
  double falling = 0.0;                     ///< share of the run until they have come, in [0, 1]
  double reading = 0.0;                     ///< measures that read contacts in a step, on average
};

/// Measured times of the first steps.
struct FirstSteps {
  double start = 0.0;    ///< until the first step: reading, shapes, memory [s]
  double seconds = 0.0;  ///< of all that were made
  double made = 0.0;     ///< number of steps
  double present = 0.0;  ///< share of the free bodies that were there, in (0, 1]
  double later = 0.0;    ///< seconds of one of the last of them
};

/// Seconds by the processor.
struct PredictedTime {
  double start = 0.0, steps = 0.0, output = 0.0;
  double total() const { return start + steps + output; }
};

namespace predicted {

/// Time of one step of all bodies in a packing [s].
inline double packed_step(const RunCounts& run) {
  const double others = run.bodies - run.polyhedra, read = run.reading * run.bodies * read_contacts;
  if (!(run.sweeps > 0.0)) return read + others * run.other + run.polyhedra * smooth_polyhedron;
  return read + others * (nonsmooth_sphere + run.sweeps * sweep_sphere) +
         run.polyhedra * (nonsmooth_polyhedron + run.sweeps * sweep_polyhedron);
}

/// Time of a chain of arithmetic (multiply, add, root), for the other work of a step [s].
inline double loop_seconds() {
  const double start = process_seconds();
  double x = 1.0;
  for (int k = 0; k < 60'000; ++k) x = std::sqrt(x * 1.0000001 + 1e-9);
  volatile double keep = x;
  (void)keep;
  return process_seconds() - start;
}

}  // namespace predicted

/// Speed of this machine over that of the unit costs: the same loop, the best of five.
inline double machine_speed() {
  double best = predicted::loop_seconds();
  for (int k = 0; k < 4; ++k) best = std::min(best, predicted::loop_seconds());
  return best > 0.0 ? std::clamp(predicted::loop_time / best, 0.05, 20.0) : 1.0;
}

/// Predicted time with this number of threads on idle processors.
inline double wall_seconds(double processor, double bodies, double threads) {
  return processor / std::clamp(bodies / predicted::bodies_of_a_thread, 1.0, std::max(1.0, threads));
}

/// Share of a run of `duration` [s] until bodies that start up to `height` [m] above the lowest lie, half of them: a
/// fall from half of it and all bounces that follow, (1 + e)/(1 - e) of its time; 0 without gravity [m/s^2].
inline double falling_share(double height, double gravity, double duration, double restitution) {
  if (!(gravity > 0.0 && duration > 0.0 && height > 0.0)) return 0.0;
  const double bounces = (1.0 + restitution) / std::max(1e-12, 1.0 - restitution);
  return std::min(1.0, std::sqrt(height / gravity) * bounces / duration);
}

/// speed: of this machine over that of the prices.
inline PredictedTime predict_time(const RunCounts& run, const FirstSteps& first, double speed) {
  PredictedTime out;
  out.start = first.start + predicted::start_of_run / speed;
  out.output = run.outputs *
               (predicted::output_itself + predicted::output_body * run.bodies + predicted::output_point * run.points) /
               speed;
  const double rest = std::max(0.0, run.steps - first.made), present = std::clamp(first.present, 1e-3, 1.0);
  const double packed = run.loose * predicted::packed_step(run) / speed;
  out.steps = first.seconds + rest * (first.later / present + packed * (1.0 - run.falling));
  return out;
}

}  // namespace epafi
