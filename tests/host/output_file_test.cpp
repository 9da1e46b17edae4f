#include "host_sim/io/output_file.hpp"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <memory>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/map/map_file.hpp"

#include "map/map_fixture.hpp"
#include "temporary_folder.hpp"

namespace cairn::host {
namespace {

namespace fs = std::filesystem;
using Library = MapLibrary<test::SmallConfig>;

std::string contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::size_t files_in(const fs::path& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

/// Runs `action` in a process that may write files of at most `limit` bytes: a full disk. Its exit
/// code: 0 done, 1 an OutputError.
template <class Action>
int with_room_for(rlim_t limit, Action action) {
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit size{limit, limit};
    setrlimit(RLIMIT_FSIZE, &size);
    int code = 0;
    try {
      action();
    } catch (const OutputError&) {
      code = 1;
    }
    std::_Exit(code);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// WHEN what is there is no file, THEN it is written to and no file takes its place: with a
/// superuser's rights that would be the end of /dev/null.
TEST(OutputFile, ADeviceOrAPipeStaysWhatItIs) {
  const TemporaryFolder folder;
  const fs::path pipe = folder.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  ASSERT_GE(reader, 0);
  write_text(pipe, "some text");
  char text[32] = {};
  EXPECT_EQ(read(reader, text, sizeof text), 9);
  EXPECT_STREQ(text, "some text");
  close(reader);
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_EQ(files_in(folder.path()), 1U);
  write_text("/dev/null", "nothing");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  if (fs::is_character_file("/dev/full")) {
    EXPECT_THROW(write_text("/dev/full", "too much"), OutputError);
    EXPECT_TRUE(fs::is_character_file("/dev/full"));
  }
}

TEST(OutputFile, HasItsNameOnlyWhenItIsComplete) {
  const TemporaryFolder folder;
  const fs::path path = folder.write("a.csv", "old");
  {
    OutputFile file(path);
    file.print("{},{}\n", 1, "two");
    EXPECT_EQ(contents(path), "old");
    file.finish();
    EXPECT_EQ(contents(path), "1,two\n");
  }
  {
    OutputFile abandoned(path);
    abandoned.write("half");
  }
  EXPECT_EQ(contents(path), "1,two\n");
  EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(OutputFile, NamesTheFileThatCannotBeWritten) {
  const TemporaryFolder folder;
  try {
    OutputFile file(folder.path() / "nowhere" / "b.csv");
    FAIL();
  } catch (const OutputError& error) {
    EXPECT_NE(std::string(error.what()).find("nowhere/b.csv: cannot be written"), std::string::npos)
        << error.what();
  }
}

TEST(OutputFile, AFullDiskLeavesTheOldFileAndSaysSo) {
  const TemporaryFolder folder;
  const fs::path path = folder.write("a.txt", "old");
  const std::string large(300000, 'x');
  EXPECT_EQ(with_room_for(100000, [&] { write_text(path, large); }), 1);
  EXPECT_EQ(contents(path), "old");
  EXPECT_EQ(files_in(folder.path()), 1U);
  EXPECT_EQ(with_room_for(300000, [&] { write_text(path, large); }), 0);
  EXPECT_EQ(contents(path), large);
}

Library library_of(unsigned seed, int count) {
  test::LandmarkMaker maker(seed);
  Library library;
  Health health;
  for (int i = 0; i < count; ++i) {
    EXPECT_TRUE(ok(library.insert(maker.landmark(static_cast<LandmarkId>(i + 1)), health)));
  }
  return library;
}

void save(const Library& library, const fs::path& path) {
  OutputFile file(path);
  const ByteSink sink{
      [](void* context, const std::uint8_t* bytes, int count) {
        static_cast<OutputFile*>(context)->write(
            {reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(count)});
        return true;
      },
      &file};
  EXPECT_TRUE(ok(save_map(library, LandmarkId{100}, sink)));
  file.finish();
}

/// Number of landmarks of the map in `path`, -1 where it is none.
int landmarks_in(const fs::path& path) {
  std::string bytes = contents(path);
  const ByteSource source{[](void* context, std::uint32_t offset, std::uint8_t* to, int count) {
                            const auto& from = *static_cast<std::string*>(context);
                            if (offset + static_cast<std::size_t>(count) > from.size())
                              return false;
                            std::copy_n(from.begin() + offset, count, to);
                            return true;
                          },
                          &bytes, static_cast<std::uint32_t>(bytes.size())};
  Library library;
  MapFileInfo info;
  return ok(load_map(source, library, info)) ? library.size() : -1;
}

TEST(OutputFile, AMapCutAfterAnyByteIsTheOldOneOrTheNew) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "hall.map";
  const Library old_map = library_of(1, 1);
  const Library new_map = library_of(2, 2);
  const auto size = static_cast<int>(map_file_bytes(2, 1));
  save(old_map, path);
  for (int cut = 0; cut < size; ++cut) {
    ASSERT_EQ(with_room_for(static_cast<rlim_t>(cut), [&] { save(new_map, path); }), 1) << cut;
    ASSERT_EQ(landmarks_in(path), 1) << "cut after " << cut;
  }
  EXPECT_EQ(with_room_for(static_cast<rlim_t>(size), [&] { save(new_map, path); }), 0);
  EXPECT_EQ(landmarks_in(path), 2);
}

/// A kill leaves the part, which is no map, and the old map.
TEST(OutputFile, AKilledProcessLeavesTheOldFile) {
  const TemporaryFolder folder;
  const fs::path path = folder.write("a.txt", "old");
  const pid_t child = fork();
  if (child == 0) {
    OutputFile file(path);
    file.write(std::string(200000, 'x'));
    std::raise(SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(contents(path), "old");
}

}  // namespace
}  // namespace cairn::host
