#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <map>
#include <thread>

#include "engine/units/error.h"
#include "viz_export/files/run_mark.h"
#include "viz_export/view/pack.h"
#include "viz_export/view/page.h"
#include "viz_export/view/server.h"

namespace epafi {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_kept = 32;  // encoded chunks

/// Changes when the run writes, ends, is killed or is removed.
struct FolderMark {
  bool is_there = false;
  std::uintmax_t bytes = 0;
  fs::file_time_type written{};
  RunLife life = RunLife::over;
  bool operator==(const FolderMark&) const = default;
};

FolderMark mark_of(const fs::path& folder) {
  std::error_code none;
  return {fs::exists(folder / "run.h5", none), fs::file_size(folder / "run.h5", none),
          fs::last_write_time(folder / "run.h5", none), run_state(folder).life};
}

std::string text_of(const FolderMark& mark) {
  return fmt::format("{} {} {} {}", mark.is_there, mark.bytes, mark.written.time_since_epoch().count(),
                     static_cast<int>(mark.life));
}

/// True where the common part of two lists of frames is equal; a resumed run drops some at its end.
bool go_on(const std::vector<std::string>& before, const std::vector<std::string>& after) {
  const auto both = static_cast<std::ptrdiff_t>(std::min(before.size(), after.size()));
  return std::equal(before.begin(), before.begin() + both, after.begin());
}

}  // namespace

struct RunServer::State {
  fs::path folder;  ///< empty: a still
  std::unique_ptr<ViewSource> source;
  Overview overview;
  std::size_t looked_at = 0;  ///< frames that there were at the last look over all
  FolderMark mark;
  std::size_t runs = 0;             ///< that the folder has held
  std::string identity;             ///< of the run that is shown
  std::vector<std::string> hashes;  ///< of its frames
  std::unique_ptr<Packer> packer;
  std::map<std::size_t, std::string> chunks;  ///< encoded, of whole chunks

  /// Renews the overview after each growth of the run by 5 %, and at its end: it takes seconds for a large run.
  void look() {
    const std::size_t frames = source->times().size();
    if (overview.box.is_empty() || frames < looked_at || frames > looked_at + looked_at / 20 || !source->is_running()) {
      overview = look_over(*source);
      looked_at = frames;
    }
    packer = std::make_unique<Packer>(*source, overview);
  }

  /// Reads changed files again. A file that is being written is read at the next request.
  void read_again() {
    if (folder.empty()) return;
    const auto now = mark_of(folder);
    if (now == mark) return;
    auto fresh = open_run(folder);
    std::vector<std::string> now_hashes = fresh->state_hashes();
    const bool same = source != nullptr && identity == fresh->identity() && go_on(hashes, now_hashes);
    if (!same || now_hashes.size() < hashes.size()) chunks.clear();
    if (!same) {
      ++runs;
      overview = {};
    }
    identity = fresh->identity();
    hashes = std::move(now_hashes);
    packer.reset();
    source = std::move(fresh);
    look();
    mark = now;
  }

  HttpAnswer answer(const std::string& path);

  /// Identity of the shown run: the page reloads where it changes. Empty: unknown.
  std::string shown_run() const { return folder.empty() ? "" : fmt::format("{}-{}", identity, runs); }

  std::string chunk(std::size_t k) {
    const auto kept = chunks.find(k);
    if (kept != chunks.end()) return kept->second;
    std::string bytes = bytes_of(packer->chunk(k, packer->columns()));
    const bool whole = (k + 1) * chunk_frames <= packer->frames();
    if (!whole) return bytes;
    if (chunks.size() >= most_kept) chunks.erase(chunks.begin());
    return chunks[k] = std::move(bytes);
  }
};

RunServer::RunServer(fs::path folder) : state_(std::make_unique<State>()) {
  require_page_library();
  state_->folder = std::move(folder);
  state_->read_again();
}

RunServer::RunServer(std::unique_ptr<ViewSource> still) : state_(std::make_unique<State>()) {
  require_page_library();
  state_->source = std::move(still);
  state_->look();
}

RunServer::~RunServer() = default;

/// The file of a live run may have changed since it was opened, or be partly written: it is reopened, for two seconds
/// at most.
HttpAnswer RunServer::answer(const std::string& path) {
  constexpr int tries = 40;
  for (int k = 1;; ++k) {
    try {
      if (k > 1 || !state_->packer) state_->read_again();
      return state_->answer(path);
    } catch (const FileError&) {
      if (k == tries || state_->folder.empty() || run_state(state_->folder).life != RunLife::running) throw;
    }
    state_->mark = {};
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

HttpAnswer RunServer::State::answer(const std::string& path) {
  if (path == "/") return {200, "text/html; charset=utf-8", served_page(source->title())};
  if (path == "/manifest") {
    read_again();
    return {200, "application/json", packer->manifest(packer->columns(), {}, shown_run())};
  }
  if (path == "/mark") return {200, "text/plain", folder.empty() ? "" : text_of(mark_of(folder))};
  const char* binary = "application/octet-stream";
  if (path == "/bodies") return {200, binary, packer->bodies()};
  const std::string word = "/chunk-";
  std::size_t k = 0;
  const char* end = path.data() + path.size();
  if (path.starts_with(word)) {
    const auto number = std::from_chars(path.data() + word.size(), end, k);
    if (number.ec == std::errc() && number.ptr == end && k < packer->chunks()) return {200, binary, chunk(k)};
  }
  return {404, "text/plain", "there is no " + path};
}

}  // namespace epafi
