/// @file raster.h  Draws balls and triangles in software, as the page's shaders do: perspective, one lamp near the eye,
/// four samples per pixel. First the nearest thing of each sample is found, then each is lit once; what is
/// translucent is laid over afterwards. Any unit of length: nothing nearer to the eye than 1e-4 of its distance to what
/// it looks at is drawn.
#pragma once
#include <vector>

#include "viz_export/view/camera.h"
#include "viz_export/view/image.h"

namespace epafi {

struct DrawnBall {
  Eigen::Vector3f centre;
  float radius;
  Rgb colour;
  float opacity = 1;  ///< 1 hides what is behind it
};

struct DrawnTriangle {
  Eigen::Vector3f corner[3], normal[3];  ///< world axes
  Rgb colour;
  float opacity = 1;  ///< 1 hides what is behind it
};

/// A ribbon that faces the eye.
struct DrawnLine {
  Eigen::Vector3f from, to;
  float width;  ///< half of it
  Rgb colour;
  float opacity = 1;  ///< 1 hides what is behind it
};

struct DrawnScene {
  std::vector<DrawnBall> balls;
  std::vector<DrawnTriangle> triangles;
  std::vector<DrawnLine> lines;
};

[[nodiscard]] Image draw_scene(const DrawnScene& scene, const Camera& camera, int width, int height,
                               const Rgb& background);

}  // namespace epafi
