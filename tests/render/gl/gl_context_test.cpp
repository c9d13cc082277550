#include "render/gl/gl_context.h"

#include <gtest/gtest.h>

#include <cctype>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "render/gl/context_search.h"

namespace trapeze {
namespace {

using Contexts = std::vector<std::unique_ptr<GlContext>>;

Contexts open_all(std::string& failures) {
  Contexts contexts;
  for (const ContextCandidate& candidate : list_context_candidates()) {
    try {
      contexts.push_back(open_context(candidate));
    } catch (const std::runtime_error& error) {
      failures += candidate.text() + ": " + error.what() + "\n";
    }
  }
  return contexts;
}

TEST(GlContextTest, CandidatesComeHardwareFirstAndOsmesaLast) {
  const std::vector<ContextCandidate> candidates = list_context_candidates();
  for (std::size_t i = 1; i < candidates.size(); ++i) {
    EXPECT_LE(candidates[i - 1].path, candidates[i].path);
  }
}

TEST(GlContextTest, EveryContextThatOpensSaysWhatItIs) {
  std::string failures;
  const Contexts contexts = open_all(failures);
  if (contexts.empty()) GTEST_SKIP() << "no OpenGL here:\n" << failures;
  for (const auto& context : contexts) {
    EXPECT_FALSE(context->info().renderer.empty());
    EXPECT_FALSE(context->info().version.empty());
    EXPECT_NE(context->info().text().find(name_of(context->info().candidate.path)),
              std::string::npos);
  }
}

TEST(GlContextTest, ContextsMoveBetweenThreads) {
  std::string failures;
  const Contexts contexts = open_all(failures);
  if (contexts.empty()) GTEST_SKIP() << "no OpenGL here:\n" << failures;
  for (const auto& context : contexts) {
    for (int i = 0; i < 2; ++i) {
      std::string version;
      std::thread([&] {
        const CurrentContext current(*context);
        version = reinterpret_cast<const char*>(context->gl().GetString(GL_VERSION));
      }).join();
      EXPECT_EQ(version, context->info().version);
    }
  }
}

TEST(GlContextTest, SharedContextsSeeEachOthersBuffersInAnyOrderOfDeath) {
  std::string failures;
  Contexts contexts = open_all(failures);
  if (contexts.empty()) GTEST_SKIP() << "no OpenGL here:\n" << failures;
  for (auto& first : contexts) {
    SCOPED_TRACE(first->info().text());
    const std::unique_ptr<GlContext> second = first->create_shared();
    GLuint buffer = 0;
    {
      const CurrentContext current(*first);
      first->gl().GenBuffers(1, &buffer);
      first->gl().BindBuffer(GL_TEXTURE_BUFFER, buffer);
      const int value = 4711;
      first->gl().BufferData(GL_TEXTURE_BUFFER, sizeof value, &value, GL_STATIC_DRAW);
      first->gl().Finish();
    }
    first.reset();
    const CurrentContext current(*second);
    second->gl().BindBuffer(GL_TEXTURE_BUFFER, buffer);
    const void* mapped =
        second->gl().MapBufferRange(GL_TEXTURE_BUFFER, 0, sizeof(int), GL_MAP_READ_BIT);
    ASSERT_NE(mapped, nullptr);
    EXPECT_EQ(*static_cast<const int*>(mapped), 4711);
    second->gl().UnmapBuffer(GL_TEXTURE_BUFFER);
  }
}

TEST(GlContextTest, ADeviceThatIsNotThereIsReportedAndTheOthersAreTried) {
  std::string failures;
  if (open_all(failures).empty()) GTEST_SKIP() << "no OpenGL here:\n" << failures;
  for (const char* device : {"99", "no such card"}) {
    std::unique_ptr<GlContext> taken;
    const ContextSearch search =
        use_first_context({.device = device},
                          [&](std::unique_ptr<GlContext> context) { taken = std::move(context); });
    EXPECT_TRUE(search.found);
    EXPECT_NE(taken, nullptr);
    ASSERT_FALSE(search.failures.empty());
    EXPECT_NE((search.failures[0].candidate + search.failures[0].reason).find(device),
              std::string::npos);
  }
}

TEST(GlContextTest, ADeviceIsFoundByAPartOfItsNameInAnyCase) {
  std::string failures;
  const Contexts contexts = open_all(failures);
  if (contexts.empty()) GTEST_SKIP() << "no OpenGL here:\n" << failures;
  std::string name = contexts.back()->info().renderer.substr(0, 5);
  for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::string renderer;
  const auto use = [&](std::unique_ptr<GlContext> context) { renderer = context->info().renderer; };
  EXPECT_TRUE(use_first_context({.device = name}, use).found);
  EXPECT_EQ(renderer.substr(0, 5), contexts.back()->info().renderer.substr(0, 5));
}

TEST(GlContextTest, AContextThatIsOfNoUseFallsThroughToTheNext) {
  std::string failures;
  const std::size_t working = open_all(failures).size();
  std::size_t offered = 0;
  const ContextSearch search = use_first_context({}, [&](std::unique_ptr<GlContext>) {
    ++offered;
    throw std::runtime_error("too slow");
  });
  EXPECT_FALSE(search.found);
  EXPECT_EQ(offered, working);
  EXPECT_EQ(search.failures.size(), list_context_candidates().size());
}

TEST(GlContextTest, ADeviceNumberOutOfTheListThrows) {
  EXPECT_THROW(open_context({ContextPath::egl_device, 1000, {}}), std::runtime_error);
  EXPECT_THROW(open_context({ContextPath::egl_device, -1, {}}), std::runtime_error);
}

}  // namespace
}  // namespace trapeze
