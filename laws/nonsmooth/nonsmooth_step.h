/// @file nonsmooth_step.h  One step of non-smooth contact, as nonsmooth_contact.cpp takes it and step_trouble.cpp tells
/// of it; others see the ContactModel of nonsmooth_contact.h.
#pragma once
#include <algorithm>
#include <functional>

#include "laws/nonsmooth/displacement.h"
#include "laws/nonsmooth/driven_motion.h"
#include "laws/nonsmooth/even_pressure.h"
#include "laws/nonsmooth/impact.h"
#include "laws/nonsmooth/nonsmooth_contact.h"
#include "laws/nonsmooth/position_correction.h"
#include "laws/nonsmooth/residual.h"
#include "laws/nonsmooth/solvers/all_solvers.h"
#include "laws/nonsmooth/warm_start.h"

namespace epafi {

inline bool bounces(const MaterialTable& materials) {
  return std::any_of(materials.pairs.begin(), materials.pairs.end(),
                     [](const MaterialPair& pair) { return pair.restitution > 0.0; });
}

class NonsmoothContact final : public ContactModel {
 public:
  NonsmoothContact(const NonsmoothSetup& setup, const SolverEntry& solver)
      : name_(solver.entry.name),
        materials_(setup.materials),
        solver_(solver.make(setup.parameters)),
        tolerance_(setup.parameters.number_or("tolerance", 1e-6)),
        impacts_(impact_law(setup.parameters)),
        balances_(impacts_.law() == ImpactLaw::energetic && bounces(setup.materials)),
        warm_start_(!setup.parameters.has("warm_start") || setup.parameters.boolean("warm_start")),
        correction_({.share = setup.parameters.number_or("correction", CorrectionSettings{}.share),
                     .slop = setup.parameters.number_or("slop", CorrectionSettings{}.slop)}) {}

  const char* name() const override { return name_.c_str(); }
  void act(World& world, ContactSet& contacts, const StepClock& clock, StepReport& report) override;
  void reorder(const Reordering& change) override {
    memory_.reorder(change);
    solver_->forget();
  }
  void visit(StateVisitor& visitor) override {
    memory_.visit(visitor);
    driven_.visit(visitor);
    visitor.value("nonsmooth/unconverged", unconverged_);
    solver_->visit(visitor);
  }
  void add(std::shared_ptr<NonsmoothServo> wall) { walls_.push_back(std::move(wall)); }
  const ContactProblem& problem() const { return problem_; }
  const Impacts& impacts() const { return impacts_; }
  std::vector<float> residuals() const;
  std::string advice() const;

 private:
  void guide(const World& world);
  void load(const World& world, const ContactSet& contacts, const StepClock& clock);
  void start(const World& world, const ContactSet& contacts, double dt);
  SolverReport solve(const World& world, const ContactSet& contacts, double dt);
  void even_pressure(const ContactSet& contacts, double dt, const std::function<void()>& solve);
  bool release_induced(const World& world, const ContactSet& contacts, double dt);
  void balance(const ContactSet& contacts, double dt, const std::function<void()>& solve);
  void account(const World& world, ContactSet& contacts, double dt, StepReport& report) const;
  Vec3 driven_change(std::size_t i) const;
  SolverTrouble look_for_trouble(const SolverReport& report);
  void predict(const ContactSet& contacts, double dt);
  void predict_displacement();
  void see_strikes();
  void add_impacts();
  void write_back(World& world, const StepClock& clock) const;
  void move_walls(World& world, double dt) const;
  const Impulses& calmest(double creep);
  double predicted_residual(const Impulses& r, const BodyVelocities* v);

  std::string name_;
  MaterialTable materials_;
  std::vector<std::shared_ptr<NonsmoothServo>> walls_;
  std::unique_ptr<ContactSolver> solver_;
  double tolerance_;
  Impacts impacts_;
  bool balances_;  ///< impacts are to gain no energy
  ImpactBalance balance_;
  bool warm_start_;
  PositionCorrection correction_;

  ContactProblem problem_;
  double rho_ = 1.0;  ///< scale of the residual [kg]
  FreeMotion free_motion_;
  Impulses r_, start_, calmed_;
  bool with_impacts_ = false;  ///< r_ holds those of located impacts too, which are no part of the problem
  double start_residual_ = infinity;
  bool solved_ = true;  ///< the start was not good enough
  std::vector<Vec3> u_start_, u_, u_before_, u_after_, u_next_;
  std::vector<Vec3> u_struck_;  ///< u_before_ with the impacts before the problem: its energy begins with it
  BodyVelocities before_, after_, calmed_velocities_;
  std::vector<Vec3> moments_;  ///< of r_ on the bodies
  UnwrittenStream<double> next_gap_, restitution_;
  EvenPressure even_pressure_;
  WarmStart memory_;
  DrivenMotion driven_;
  ConeProblem blocks_;             ///< of a step that was not solved
  bool unsolvable_ = false;        ///< that step has no solution
  std::uint64_t unconverged_ = 0;  ///< steps so far
};

}  // namespace epafi
