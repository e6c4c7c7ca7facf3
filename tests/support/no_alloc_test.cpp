// Test of the heap guard that other tests rely on.

#include "tests/support/no_alloc.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace flexarm {
namespace {

class NoAllocDeathTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!kNoAllocWorks) GTEST_SKIP() << "the sanitizer has its own allocator";
  }
};

// Keeps the compiler from removing an allocation whose result is not used.
void Use(const void* block) { asm volatile("" : : "g"(block) : "memory"); }

TEST_F(NoAllocDeathTest, DetectsEveryAllocationFunction) {
  EXPECT_DEATH(
      {
        NoAlloc armed;
        Use(std::malloc(24));
      },
      "no_alloc: malloc of 24 bytes");
  EXPECT_DEATH(
      {
        NoAlloc armed;
        Use(std::calloc(3, 8));
      },
      "no_alloc: calloc of 24 bytes");
  EXPECT_DEATH(
      {
        NoAlloc armed;
        Use(std::aligned_alloc(64, 128));
      },
      "no_alloc: aligned_alloc of 128 bytes");
  EXPECT_DEATH(
      {
        NoAlloc armed;
        Use(new int(1));
      },
      "no_alloc: malloc of 4 bytes");
  EXPECT_DEATH(
      {
        NoAlloc armed;
        Use(std::vector<double>(100).data());
      },
      "no_alloc: malloc of 800 bytes");
  EXPECT_DEATH(
      {
        NoAlloc armed;
        Use(std::string(100, 'x').data());
      },
      "no_alloc: malloc of 101");
}

TEST_F(NoAllocDeathTest, DetectsFreeAndRealloc) {
  void* block = std::malloc(24);
  EXPECT_DEATH(
      {
        NoAlloc armed;
        std::free(block);
      },
      "no_alloc: free");
  EXPECT_DEATH(
      {
        NoAlloc armed;
        Use(std::realloc(block, 48));
      },
      "no_alloc: realloc of 48 bytes");
  std::free(block);
}

// Eigen's own assertion against this is disabled by NDEBUG; the replaced allocator is not.
TEST_F(NoAllocDeathTest, DetectsTheTemporaryOfADynamicProduct) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(12, 12);
  EXPECT_DEATH(
      {
        NoAlloc armed;
        a = a * a;
      },
      "no_alloc: .*malloc of 1[0-9]+ bytes");
}

TEST_F(NoAllocDeathTest, AllowsFixedSizes) {
  Eigen::Matrix<double, 12, 12> a = Eigen::Matrix<double, 12, 12>::Identity();
  const NoAlloc armed;
  a = a * a;
  Use(a.data());
}

TEST_F(NoAllocDeathTest, EndsWithItsScopeAndNests) {
  {
    const NoAlloc outer;
    const NoAlloc inner;
  }
  Use(std::make_unique<int>(1).get());
  EXPECT_DEATH(
      {
        const NoAlloc outer;
        {
          const NoAlloc inner;
        }
        Use(std::malloc(24));
      },
      "no_alloc: malloc");
}

TEST_F(NoAllocDeathTest, ChecksItsOwnThreadOnly) {
  bool done = false;
  {
    std::thread worker([&done] {
      const NoAlloc armed;
      done = true;
    });
    Use(std::make_unique<int>(1).get());
    worker.join();
  }
  EXPECT_TRUE(done);
}

}  // namespace
}  // namespace flexarm
