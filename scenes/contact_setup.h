/// @file contact_setup.h  From the [contact] tables to the contact model and what it needs.
#pragma once
#include <memory>

#include "engine/step/pipeline.h"
#include "laws/smooth/make_smooth_contact.h"
#include "scenes/scene.h"

namespace epafi {

/// The smooth law of the scene with its materials.
SmoothSetup smooth_setup(const Scene& scene);

/// Needs of the chosen law or solver.
Needs contact_needs(const Scene& scene);

/// The chosen law or solver; throws SceneError where parts do not fit together.
std::unique_ptr<ContactModel> make_contact_model(const Scene& scene);

}  // namespace epafi
