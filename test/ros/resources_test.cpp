#include "ros/resources.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <optional>

#include "support/temporary_folder.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

namespace fs = std::filesystem;

/// Sets an environment variable, or takes it away, until the end of its scope.
class Environment {
 public:
  Environment(std::string name, const std::optional<std::string>& value) : name_(std::move(name)) {
    if (const char* before = std::getenv(name_.c_str())) before_ = before;
    set(value);
  }
  ~Environment() { set(before_); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  void set(const std::optional<std::string>& value) {
    if (value) setenv(name_.c_str(), value->c_str(), 1);
    if (!value) unsetenv(name_.c_str());
  }
  std::string name_;
  std::optional<std::string> before_;
};

class ResourcesTest : public ::testing::Test {
 protected:
  ResourcesTest() {
    test::writeFile(packages() / "arm" / "meshes" / "a.stl", "arm's a");
    test::writeFile(packages() / "arm" / "a b%.stl", "with a space");
    test::writeFile(packages() / "arm" / "c%20d.stl", "with a percent sign");
    test::writeFile(packages() / "roscpp" / "package.xml", "not ROS's");
    test::writeFile(packages() / "secret", "outside of packages");
  }

  [[nodiscard]] fs::path packages() const { return folder_.path() / "packages"; }
  [[nodiscard]] std::string read(const std::string& uri) const {
    return resourceReader(packages())(uri);
  }
  /// The error's text, which has to be one line that begins with the URI; nothing else is written.
  [[nodiscard]] std::string errorOf(const std::string& uri) const {
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    std::string text;
    try {
      (void)read(uri);
      ADD_FAILURE() << uri << ": nothing was thrown";
    } catch (const ConfigError& error) {
      text = error.what();
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << uri;
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "") << uri;
    EXPECT_EQ(text.rfind(uri.substr(0, 50), 0), 0U) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    return text;
  }
  void expectRefused(const std::string& uri, const std::string& part) const {
    const std::string error = errorOf(uri);
    EXPECT_NE(error.find(part), std::string::npos) << error;
  }

  test::TemporaryFolder folder_;
};

TEST_F(ResourcesTest, APackageInTheGivenFolderComesFirst) {
  EXPECT_EQ(read("package://arm/meshes/a.stl"), "arm's a");
  EXPECT_EQ(read("package://arm//meshes/./a.stl"), "arm's a");
  EXPECT_EQ(read("package://arm/meshes/../meshes/a.stl"), "arm's a");
  EXPECT_EQ(read("package://roscpp/package.xml"), "not ROS's");
}

TEST_F(ResourcesTest, OtherPackagesAreThoseThatRosKnows) {
  EXPECT_NE(read("package://roslib/package.xml").find("<name>roslib</name>"), std::string::npos);
  EXPECT_NE(resourceReader("")("package://roscpp/package.xml").find("<name>roscpp</name>"),
            std::string::npos);
  expectRefused("package://no_such_package/a.stl", "no_such_package");
  // The folder is there and the file is not: ROS's package of that name is another one.
  expectRefused("package://roscpp/CMakeLists.txt", "no file");
}

TEST_F(ResourcesTest, FilesAreReadByUriAndByPath) {
  const std::string path = packages() / "arm" / "meshes" / "a.stl";
  EXPECT_EQ(read(path), "arm's a");
  EXPECT_EQ(read("file://" + path), "arm's a");
  EXPECT_EQ(read("file://localhost" + path), "arm's a");
  std::string bytes("\0\r\n\xff", 4);
  test::writeFile(folder_.path() / "bytes", bytes);
  EXPECT_EQ(read(folder_.path() / "bytes"), bytes);
  test::writeFile(folder_.path() / "empty", "");
  EXPECT_EQ(read(folder_.path() / "empty"), "");
}

TEST_F(ResourcesTest, PercentEncodingIsUnderstood) {
  EXPECT_EQ(read("package://arm/a%20b%25.stl"), "with a space");
  EXPECT_EQ(read("package://arm/a b%.stl"), "with a space");
  EXPECT_EQ(read("package://arm/m%65sh%65s%2Fa.stl"), "arm's a");
  EXPECT_EQ(read("package://arm/c%20d.stl"), "with a percent sign");
  EXPECT_EQ(read("file://" + (packages() / "arm" / "a%20b%25.stl").string()), "with a space");
  EXPECT_EQ(read(packages() / "arm" / "c%20d.stl"), "with a percent sign");
}

TEST_F(ResourcesTest, NothingIsReadFromOutsideOfAPackage) {
  for (const char* uri :
       {"package://arm/../secret", "package://arm/meshes/../../secret", "package://../secret",
        "package://./secret", "package://arm/%2e%2e/secret", "package://arm/..%2fsecret",
        "package://arm/%2fetc%2fpasswd", "package://arm/..",
        "package://roslib/../roscpp/package.xml"}) {
    (void)errorOf(uri);
  }
}

TEST_F(ResourcesTest, TheNetworkAndUnknownSchemesAreRefused) {
  expectRefused("http://localhost/a.stl", "not fetched: a robot must not depend on a network");
  expectRefused("https://localhost/a.stl", "not fetched");
  for (const char* uri :
       {"relative.stl", "./a.stl", "~/a.stl", "", "model://a/b.stl",
        "package:", "package:/arm/meshes/a.stl", "PACKAGE://arm/meshes/a.stl", "file:a.stl"}) {
    expectRefused(uri, "has to begin");
  }
  expectRefused("file://a.stl", "absolute");
  expectRefused("file://host/a.stl", "absolute");
}

TEST_F(ResourcesTest, WhatIsNoReadableFileIsRefused) {
  expectRefused("package://arm/meshes", "folder");
  expectRefused("package://arm/", "file in it");
  expectRefused("package://arm", "file in it");
  expectRefused("package:///a.stl", "file in it");
  expectRefused("package://", "file in it");
  expectRefused("package://arm/none.stl", "no file");
  expectRefused("package://arm/meshes/a.stl/b", "no file");
  expectRefused("file:///", "folder");
  expectRefused("/", "folder");
  expectRefused("/dev/zero", "no file");
  expectRefused("package://arm/a%00b", "NUL");
  expectRefused("package://arm/" + std::string(10000, 'x'), "no file");
  ASSERT_EQ(mkfifo((folder_.path() / "pipe").c_str(), 0600), 0);
  expectRefused(folder_.path() / "pipe", "no file");
}

TEST_F(ResourcesTest, AFileWithoutPermissionIsRefused) {
  if (geteuid() == 0) GTEST_SKIP() << "root may read every file";
  const fs::path path = packages() / "secret";
  fs::permissions(path, fs::perms::none);
  expectRefused(path, "cannot be read");
}

TEST_F(ResourcesTest, VeryLargeFilesAreRefused) {
  const fs::path path = folder_.path() / "large";
  test::writeFile(path, "");
  fs::resize_file(path, (std::uintmax_t{256} << 20U) + 1);
  expectRefused(path, "256 MB");
}

TEST_F(ResourcesTest, FitsAreRememberedBelowRosHome) {
  const Environment home("HOME", "/home/robot");
  {
    const Environment ros_home("ROS_HOME", "/var/ros");
    EXPECT_EQ(fitCacheFolder(), "/var/ros/tccm_monitor/fits");
  }
  const Environment ros_home("ROS_HOME", std::nullopt);
  EXPECT_EQ(fitCacheFolder(), "/home/robot/.ros/tccm_monitor/fits");
  const Environment no_home("HOME", std::nullopt);
  EXPECT_EQ(fitCacheFolder(), "");
}

}  // namespace
}  // namespace tccm
