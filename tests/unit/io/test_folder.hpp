// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <unistd.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

namespace spheretree::tests {

/// A fixture with an empty folder of its own, gone after the test.
class InFolder : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo& info = *testing::UnitTest::GetInstance()->current_test_info();
    std::string name =
        std::string(info.test_suite_name()) + "." + info.name() + "." + std::to_string(::getpid());
    for (char& letter : name)
      if (letter == '/') letter = '_';
    folder_ = std::filesystem::path(testing::TempDir()) / ("spheretree-" + name);
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::filesystem::path in(const std::string& name) const { return folder_ / name; }

  std::filesystem::path put(const std::string& name, std::string_view bytes) const {
    std::ofstream(in(name), std::ios::binary) << bytes;
    return in(name);
  }

  [[nodiscard]] static std::string contentOf(const std::filesystem::path& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }

  [[nodiscard]] std::size_t filesInFolder() const {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder_)) ++count;
    return count;
  }

  std::filesystem::path folder_;
};

}  // namespace spheretree::tests
