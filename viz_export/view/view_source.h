/// @file view_source.h  What can be looked at: a run's folder, during the run or afterwards, or the first state of a
/// scene. Frames are read one by one.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "viz_export/hdf5/stored_run.h"
#include "viz_export/view/contact_file.h"
#include "viz_export/view/settings.h"

namespace epafi {

/// Relative to the box of the picture: positions on the page are multiples of this step.
inline constexpr double finest_step = 1e-5;

struct ViewFrame {
  double time = 0.0;                    ///< [s]
  bool rotates = false;                 ///< angular velocities are known
  bool has_orientation = false;         ///< orientations are known
  std::vector<BodyRecord> bodies;       ///< in the order of ids
  std::vector<StoredContact> contacts;  ///< in the order of ids a, b
};

class ViewSource {
 public:
  virtual ~ViewSource() = default;
  virtual std::string title() const = 0;
  virtual const RunAbout& about() const = 0;
  virtual const std::vector<double>& times() const = 0;  ///< of the frames [s]
  virtual ViewFrame frame(std::size_t k) const = 0;
  /// All bodies that ever existed, by id; without motion.
  virtual const std::vector<BodyRecord>& bodies() const = 0;
  virtual std::vector<StoredMeasure> measures() const = 0;
  virtual bool has_contacts() const = 0;
  virtual bool has_residuals() const = 0;  ///< of contacts
  virtual bool is_running() const = 0;
  /// Tells this run from another one in the same folder; empty: it cannot change.
  virtual std::string identity() const { return {}; }
  /// Hash of the state at each frame; empty where no file has them.
  virtual std::vector<std::string> state_hashes() const { return {}; }
  /// Text that the run was killed, and at which time; empty for other runs.
  virtual std::string cut_text() const { return {}; }
  /// Text on an early end, as "interrupted at 2.3 of 60 s"; empty for other runs.
  virtual std::string stop_text() const { return {}; }
  /// Warnings of unreadable parts of the run's files, each once, as far as the files have been read.
  virtual std::vector<std::string> warnings() const { return {}; }
  virtual double last_time() const { return times().empty() ? 0.0 : times().back(); }  ///< last time with data [s]
};

/// Reads run.h5, and the contacts from frames/. Throws FileError. command: who asks, for the message of a folder that
/// holds no run.
[[nodiscard]] std::unique_ptr<ViewSource> open_run(const std::filesystem::path& folder,
                                                   const std::string& command = "view");

/// One state; the surfaces of the records must stay.
[[nodiscard]] std::unique_ptr<ViewSource> still_source(std::string title, RunAbout about, ViewFrame frame);

}  // namespace epafi
