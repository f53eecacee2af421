#include "viz_export/files/write_at_once.h"

#include <string>

#include "engine/units/error.h"
#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"
#include "tests/viz_export/small_scene.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/files/side_file.h"
#include "viz_export/vtk/frame_writer.h"

using namespace epafi;

TEST_CASE("of files written at once all are tried, and the first failure is reported", "[viz_export][write]") {
  const support::KeepThreads keep;
  for (const int threads : {1, 2, 4}) {
    set_thread_count(threads);
    std::vector<int> tried(5, 0);
    const auto write = [&](std::size_t k) {
      ++tried[k];
      if (k % 2 == 1) throw FileError("file " + std::to_string(k));
    };
    CHECK_THROWS_WITH(write_at_once(5, write), "file 1");
    CHECK(tried == std::vector<int>(5, 1));
    CHECK_NOTHROW(write_at_once(1, write));
    CHECK_NOTHROW(write_at_once(0, write));
  }
}

TEST_CASE("a frame has the same bytes for every thread count, beside another file", "[viz_export][write]") {
  const support::KeepThreads keep;
  SmallScene scene(20000);  // long enough to be shared out
  SurfaceCache surfaces(scene.shapes);
  const BodyList bodies(scene.world, surfaces);
  std::vector<std::string> first;
  for (const int threads : {1, 4}) {
    set_thread_count(threads);
    const TemporaryFolder folder;
    FrameWriter frames(folder.path());
    frames.write(0.5, bodies, ContactList(scene.world, {scene.world, scene.contacts}),
                 [&] { write_whole_file(folder / "other", {"beside them"}); });
    std::vector<std::string> files;
    for (const char* name :
         {"other", "frames.pvd", "frames/spheres_000000.vtp", "frames/contacts_000000.vtp", "frames/walls_000000.vtp"})
      files.push_back(read_whole_file(folder / name));
    if (first.empty()) first = files;
    CHECK(files == first);
  }
  CHECK(first[2].size() > 20000 * 4 * 8);
}

TEST_CASE("a frame is listed once all its files are written, and what failed beside it goes first",
          "[viz_export][write]") {
  const support::KeepThreads keep;
  SmallScene scene(100);
  SurfaceCache surfaces(scene.shapes);
  const BodyList bodies(scene.world, surfaces);
  const ContactList contacts(scene.world, {scene.world, scene.contacts});
  for (const int threads : {1, 3}) {
    set_thread_count(threads);
    const TemporaryFolder folder;
    FrameWriter frames(folder.path());
    CHECK_THROWS_WITH(frames.write(0.0, bodies, contacts, [] { throw FileError("run.h5: disk full"); }),
                      "run.h5: disk full");
    std::filesystem::create_directories(folder / "frames/spheres_000000.vtp.part");  // cannot be opened to write
    CHECK_THROWS_WITH(frames.write(0.0, bodies, contacts), Catch::Contains("spheres_000000.vtp: cannot write"));
    CHECK((frames.frames() == 0 && !std::filesystem::exists(folder / "frames.pvd")));
    std::filesystem::remove(folder / "frames/spheres_000000.vtp.part");
    frames.write(0.0, bodies, contacts);  // the same time again: none was written
    CHECK(frames.frames() == 1);
    PvdFile list(folder / "frames.pvd");
    list.keep_until(1.0);
    CHECK(list.entries().size() == 3);
  }
}
