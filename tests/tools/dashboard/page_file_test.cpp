#include "tools/dashboard/page_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <regex>
#include <string>

namespace flexarm {
namespace {

std::string TextOf(std::string_view path) {
  const PageFile* file = FindPageFile(path);
  return file == nullptr ? "" : std::string(file->text);
}

TEST(PageFile, IsTheFileOfTheSourceTreeToTheByte) {
  for (const char* name : {"dashboard.css", "main.js", "icon.svg"}) {
    std::ifstream in(FLEXARM_SOURCE_DIR "/tools/dashboard/page/" + std::string(name));
    const std::string there((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    EXPECT_EQ(TextOf("/" + std::string(name)), there);
  }
}

TEST(PageFile, ThereIsNothingAtOtherPaths) {
  for (const char* path : {"", "/index.html", "//", "/main.js/", "/../main.js", "main.js"}) {
    EXPECT_EQ(FindPageFile(path), nullptr) << path;
  }
}

// A module or a style that is missing would leave a page without values.
TEST(PageFile, EverythingThatThePageLoadsIsThere) {
  const std::regex named(R"re((?:(?:href|src)="|from "\.)(/[\w.-]+)")re");
  int found = 0;
  for (const char* path :
       {"/", "/main.js", "/arm.js", "/plots.js", "/panels.js", "/trips.js", "/controls.js"}) {
    const std::string text = TextOf(path);
    for (std::sregex_iterator match(text.begin(), text.end(), named), end; match != end; ++match) {
      EXPECT_NE(FindPageFile((*match)[1].str()), nullptr) << path << ": " << (*match)[1];
      ++found;
    }
  }
  EXPECT_GT(found, 10);
}

// The Content-Security-Policy forbids both, and nothing may need a network.
TEST(PageFile, HasNoInlineCodeAndNoAddressOfAnotherSite) {
  const std::string page = TextOf("/");
  EXPECT_FALSE(
      std::regex_search(page, std::regex(R"re(<script(?![^>]*src=)|\son\w+=|\sstyle=|<style)re")));
  for (const char* path : {"/", "/dashboard.css", "/main.js", "/stream.js", "/controls.js"}) {
    EXPECT_THAT(TextOf(path), testing::Not(testing::HasSubstr("https://"))) << path;
  }
}

}  // namespace
}  // namespace flexarm
