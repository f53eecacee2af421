/// @file film.h  Pictures into a film, by ffmpeg as a program of its own.
#pragma once
#include <cstddef>
#include <filesystem>

#include "viz_export/view/image.h"

namespace epafi {

/// Pictures a second: 25, fewer of those that would be over in less than 3 s.
constexpr double film_rate(std::size_t pictures) {
  constexpr double usual = 25, least_seconds = 3;
  const auto many = static_cast<double>(pictures);
  return many >= usual * least_seconds || pictures == 0 ? usual : many / least_seconds;
}

class Film {
 public:
  /// rate: pictures a second; .webm is VP9, everything else H.264. Throws FileError where ffmpeg is not installed.
  Film(std::filesystem::path target, int width, int height, double rate);
  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;
  void add(const Image& image);
  /// Waits for ffmpeg; throws FileError where it failed.
  void finish();

 private:
  std::filesystem::path target_;
  int pipe_ = -1, process_ = -1;
};

}  // namespace epafi
