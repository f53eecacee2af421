/// @file stages.h  [[stage]] tables before anything in them is read: a stage is the scene with keys changed, and that
/// of the stages before it.
#pragma once
#include <string>
#include <vector>

#include "scenes/reader/document.h"

namespace epafi {

/// A stage that a resumed run has put in: what `epafi resume DIR --set ...` changed.
struct InsertedStage {
  std::size_t after = 0;               ///< index of the stage that it cuts short
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

/// The whole scene of one stage as tables: what it and those before it change is in it, but bodies' changes are listed.
struct StageDocument {
  Node root;
  std::vector<ChangeOfBodies> bodies;  ///< they point into `stages`
};
StageDocument document_of_stage(const Node& root, const std::vector<Node>& stages, std::size_t stage,
                                std::vector<Problem>& problems);

/// "[[stage]] 'tilt'"
std::string stage_label(const Node& stage, std::size_t number);

}  // namespace epafi
