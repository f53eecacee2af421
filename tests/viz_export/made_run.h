/// @file made_run.h  Frames that a test makes, as a run.
#pragma once
#include <algorithm>
#include <string>
#include <vector>

#include "viz_export/view/render_run.h"

namespace epafi {

inline constexpr double ball_radius = 0.05;

inline BodyRecord ball_at(std::uint32_t id, const Vec3& place, const Vec3& velocity = Vec3::Zero()) {
  BodyRecord b;
  b.id = id;
  b.mass = 1;
  b.radius = ball_radius;
  b.pose.position = place;
  b.velocity = velocity;
  return b;
}

inline ViewFrame frame_of(std::vector<BodyRecord> bodies) {
  ViewFrame frame;
  frame.bodies = std::move(bodies);
  return frame;
}

inline RunAbout about_with(const Vec3& gravity) {
  RunAbout about;
  about.gravity = gravity;
  return about;
}

/// Frames that a test makes.
class MadeRun final : public ViewSource {
 public:
  MadeRun(std::vector<ViewFrame> frames, RunAbout about) : frames_(std::move(frames)), about_(std::move(about)) {
    for (std::size_t k = 0; k < frames_.size(); ++k) {
      frames_[k].time = static_cast<double>(k);
      times_.push_back(frames_[k].time);
      for (const BodyRecord& b : frames_[k].bodies) {
        if (b.id >= bodies_.size()) bodies_.resize(b.id + 1u);
        bodies_[b.id] = b;
      }
    }
  }
  std::string title() const override { return "made"; }
  const RunAbout& about() const override { return about_; }
  const std::vector<double>& times() const override { return times_; }
  ViewFrame frame(std::size_t k) const override { return frames_.at(k); }
  const std::vector<BodyRecord>& bodies() const override { return bodies_; }
  std::vector<StoredMeasure> measures() const override { return {}; }
  bool has_contacts() const override { return !frames_.back().contacts.empty(); }
  bool has_residuals() const override { return false; }
  bool is_running() const override { return false; }

 private:
  std::vector<ViewFrame> frames_;
  RunAbout about_;
  std::vector<double> times_;
  std::vector<BodyRecord> bodies_;  ///< of all frames, by id
};

inline RenderOptions plain_options(bool contacts) {
  RenderOptions options;
  options.width = 640;
  options.height = 480;
  options.camera = "front";
  options.labels = false;
  options.contacts = contacts;
  return options;
}

inline std::size_t unlike_pixels(Image& a, Image& b) {
  std::size_t out = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) out += std::equal(a.at(x, y), a.at(x, y) + 3, b.at(x, y)) ? 0 : 1;
  return out;
}

}  // namespace epafi
