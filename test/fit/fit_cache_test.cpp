#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <thread>

#include "fit/primitive_fit.h"
#include "support/random.h"
#include "support/temporary_folder.h"

namespace tccm {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

PrimitiveFit randomFit(unsigned seed) {
  test::Random random(seed);
  PrimitiveFit fit;
  for (int i = random.integer(1, 5); i > 0; --i) {
    const auto kind = static_cast<std::size_t>(random.integer(0, 3));
    fit.primitives.push_back({random.shape(kind), random.pose(2.0)});
  }
  fit.hull_volume_m3 = random.uniform(0.0, 1.0);
  fit.overhang_m = random.uniform(0.0, 0.1);
  return fit;
}

std::vector<double> sizesOf(const Shape& shape) {
  if (const auto* box = std::get_if<Box>(&shape)) {
    return {box->half_extents.x(), box->half_extents.y(), box->half_extents.z()};
  }
  if (const auto* c = std::get_if<Cylinder>(&shape)) return {c->radius, c->half_length};
  if (const auto* c = std::get_if<Capsule>(&shape)) return {c->radius, c->half_length};
  return {std::get<Sphere>(shape).radius};
}

/// To the bit.
void expectSame(const PrimitiveFit& a, const PrimitiveFit& b) {
  ASSERT_EQ(a.primitives.size(), b.primitives.size());
  EXPECT_EQ(a.hull_volume_m3, b.hull_volume_m3);
  EXPECT_EQ(a.overhang_m, b.overhang_m);
  for (std::size_t i = 0; i < a.primitives.size(); ++i) {
    const PlacedShape& p = a.primitives[i];
    const PlacedShape& q = b.primitives[i];
    EXPECT_EQ(p.shape.index(), q.shape.index());
    EXPECT_EQ(sizesOf(p.shape), sizesOf(q.shape));
    EXPECT_EQ(p.pose.matrix(), q.pose.matrix());
  }
}

/// Asks a cache of its own, as a process that starts would. @return whether it had to compute.
bool computes(const fs::path& folder, const std::string& content, const std::string& key,
              const PrimitiveFit& fit) {
  bool computed = false;
  FitCache cache(folder);
  expectSame(cache.fit(content, key,
                       [&] {
                         computed = true;
                         return fit;
                       }),
             fit);
  return computed;
}

fs::path onlyFile(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  EXPECT_EQ(files.size(), 1U);
  return files.empty() ? fs::path() : files.front();
}

TEST(FitCacheTest, OneMeshIsComputedOnceAProcessAlsoWithoutFiles) {
  FitCache cache("");
  int computed = 0;
  for (int i = 0; i < 3; ++i) {
    expectSame(cache.fit("mesh", "key", [&] { return ++computed, randomFit(1); }), randomFit(1));
  }
  EXPECT_EQ(computed, 1);
  EXPECT_EQ(cache.saveProblem(), "");
}

TEST(FitCacheTest, TheNextProcessFindsEveryFitAgainToTheBit) {
  const TemporaryFolder folder;
  const fs::path fits = folder.path() / "made" / "when needed";
  for (unsigned seed = 0; seed < 50; ++seed) {
    const std::string content = "mesh " + std::to_string(seed);
    EXPECT_TRUE(computes(fits, content, "key", randomFit(seed)));
    EXPECT_FALSE(computes(fits, content, "key", randomFit(seed)));
  }
}

TEST(FitCacheTest, OtherContentAndOtherKeysAreOtherFits) {
  const TemporaryFolder folder;
  EXPECT_TRUE(computes(folder.path(), "ab", "c", randomFit(1)));
  EXPECT_TRUE(computes(folder.path(), "ab", "d", randomFit(2)));
  EXPECT_TRUE(computes(folder.path(), "a", "cb", randomFit(3)));
  EXPECT_TRUE(computes(folder.path(), "a", "bc", randomFit(4)));
  EXPECT_TRUE(computes(folder.path(), "", "abc", randomFit(5)));
  EXPECT_TRUE(computes(folder.path(), std::string("ab\0", 3), "c", randomFit(6)));
  EXPECT_FALSE(computes(folder.path(), "ab", "c", randomFit(1)));
}

TEST(FitCacheTest, WhatCannotBeComputedIsNotRemembered) {
  const TemporaryFolder folder;
  FitCache cache(folder.path());
  EXPECT_THROW(
      (void)cache.fit("mesh", "key", []() -> PrimitiveFit { throw std::runtime_error("no fit"); }),
      std::runtime_error);
  expectSame(cache.fit("mesh", "key", [] { return randomFit(1); }), randomFit(1));
}

TEST(FitCacheTest, ADamagedFileIsComputedAnewAndMended) {
  const TemporaryFolder folder;
  const PrimitiveFit fit = randomFit(7);
  computes(folder.path(), "mesh", "key", fit);
  const fs::path file = onlyFile(folder.path());
  const std::string whole = test::readFile(file);
  test::Random random(8);
  for (int i = 0; i < 3000; ++i) {
    std::string damaged = whole;
    const int last = static_cast<int>(whole.size()) - 1;
    const auto place = static_cast<std::size_t>(random.integer(0, last));
    if (random.chance(0.3))
      damaged.resize(place);
    else
      damaged[place] = static_cast<char>(damaged[place] ^ (1 << random.integer(0, 7)));
    test::writeFile(file, damaged);
    ASSERT_TRUE(computes(folder.path(), "mesh", "key", fit)) << "byte " << place;
    ASSERT_EQ(test::readFile(file), whole);
  }
  for (const std::string& foreign : {whole + "x", whole + whole, std::string(2'000'000, 'x')}) {
    test::writeFile(file, foreign);
    EXPECT_TRUE(computes(folder.path(), "mesh", "key", fit));
  }
}

TEST(FitCacheTest, AFileOfAnotherFitIsNotTakenForThisOne) {
  const TemporaryFolder folder;
  computes(folder.path(), "mesh", "key", randomFit(1));
  const fs::path file = onlyFile(folder.path());
  const TemporaryFolder other;
  computes(other.path(), "other mesh", "key", randomFit(2));
  fs::copy_file(onlyFile(other.path()), file, fs::copy_options::overwrite_existing);
  EXPECT_TRUE(computes(folder.path(), "mesh", "key", randomFit(1)));
}

TEST(FitCacheTest, WhatIsNoFileInAFitsPlaceMeansNoCache) {
  const TemporaryFolder folder;
  computes(folder.path(), "mesh", "key", randomFit(1));
  const fs::path file = onlyFile(folder.path());
  fs::remove(file);
  fs::create_directories(file / "sub");
  FitCache cache(folder.path());
  expectSame(cache.fit("mesh", "key", [] { return randomFit(1); }), randomFit(1));
  EXPECT_NE(cache.saveProblem(), "");
  fs::remove_all(file);
  ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
  EXPECT_TRUE(computes(folder.path(), "mesh", "key", randomFit(1)));
}

TEST(FitCacheTest, AFolderThatCannotBeWrittenIsReportedInOneLine) {
  const TemporaryFolder folder;
  test::writeFile(folder.path() / "file", "no folder");
  FitCache cache(folder.path() / "file" / "fits");
  expectSame(cache.fit("mesh", "key", [] { return randomFit(1); }), randomFit(1));
  const std::string problem = cache.saveProblem();
  EXPECT_NE(problem.find("file/fits"), std::string::npos) << problem;
  EXPECT_EQ(problem.find('\n'), std::string::npos);
}

TEST(FitCacheTest, ProcessesAndThreadsMayShareAFolder) {
  const TemporaryFolder folder;
  std::vector<pid_t> children;
  for (int child = 0; child < 4; ++child) {
    children.push_back(fork());
    if (children.back() != 0) continue;
    for (unsigned i = 0; i < 100; ++i)
      computes(folder.path(), std::to_string(i), "k", randomFit(i));
    _exit(testing::Test::HasFailure() ? 1 : 0);
  }
  for (const pid_t child : children) {
    int status = 1;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
  }
  for (unsigned i = 0; i < 100; ++i) {
    EXPECT_FALSE(computes(folder.path(), std::to_string(i), "k", randomFit(i)));
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 100);
}

TEST(FitCacheTest, ThreadsThatAskForOneMeshComputeItOnce) {
  FitCache cache("");
  int computed = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (unsigned mesh = 0; mesh < 50; ++mesh) {
        (void)cache.fit(std::to_string(mesh), "k", [&] { return ++computed, randomFit(mesh); });
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(computed, 50);
}

}  // namespace
}  // namespace tccm
