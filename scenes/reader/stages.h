/// @file stages.h  [[stage]] tables before their keys are read: a stage is the scene with the changed keys of this and
/// all earlier stages.
#pragma once
#include <string>
#include <vector>

#include "scenes/reader/document.h"

namespace epafi {

/// A stage that a resumed run has inserted, with the changes of `epafi resume DIR --set ...`.
struct InsertedStage {
  std::size_t after = 0;               ///< index of the stage that it ends early
  double duration = 0.0;               ///< [s]
  double output_interval = 0.0;        ///< of the stage it follows [s]
  std::vector<std::string> overrides;  ///< "KEY.PATH=VALUE"
};

/// body.NAME = { ... } of a stage, to be applied when the bodies are there.
struct ChangeOfBodies {
  std::string name;
  const Node* table = nullptr;
  std::size_t stage = 0;
  std::string label;
};

/// The stages of a document, inserted ones among them; empty where the scene has none. Problems are appended.
std::vector<Node> list_stages(const Node& root, const std::vector<InsertedStage>& inserted,
                              std::vector<Problem>& problems);

/// The scene of one stage as tables, with the changes of this and earlier stages; changes of bodies are listed
/// separately.
struct StageDocument {
  Node root;
  std::vector<ChangeOfBodies> bodies;  ///< they point into `stages`
};
StageDocument document_of_stage(const Node& root, const std::vector<Node>& stages, std::size_t stage,
                                std::vector<Problem>& problems);

/// "[[stage]] 'tilt'"
std::string stage_label(const Node& stage, std::size_t number);

}  // namespace epafi
