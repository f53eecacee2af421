/// @file film.h  Pictures into a film, by ffmpeg as a program of its own.
#pragma once
#include <filesystem>

#include "viz_export/view/image.h"

namespace epafi {

class Film {
 public:
  /// 25 pictures a second; .webm is VP9, everything else H.264. Throws FileError where ffmpeg is not installed.
  Film(std::filesystem::path target, int width, int height);
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
