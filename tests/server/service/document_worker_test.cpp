#include "server/service/document_worker.h"

#include <gmock/gmock.h>

#include <atomic>
#include <future>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

class DocumentWorkerTest : public ::testing::Test {
 protected:
  /// Orders a document that is made only once the gate is open.
  std::future<DocumentWorker::Answer> order(const std::string& key, const std::string& text) {
    return submit(key, [this, text]() -> Result<Document> {
      ++made_;
      gate_.wait();
      return Document{"text/plain", text};
    });
  }
  std::future<DocumentWorker::Answer> submit(const std::string& key, DocumentWorker::Make make) {
    auto promise = std::make_shared<std::promise<DocumentWorker::Answer>>();
    auto answer = promise->get_future();
    worker_->submit(dataset_, key, std::move(make), [promise](DocumentWorker::Answer made) {
      promise->set_value(std::move(made));
    });
    return answer;
  }
  static std::string text_of(std::future<DocumentWorker::Answer> answer) {
    const DocumentWorker::Answer made = answer.get();
    return made ? (*made)->bytes : made.problem().detail;
  }

  std::promise<void> opener_;
  const std::shared_future<void> gate_ = opener_.get_future().share();
  std::atomic<int> made_ = 0;
  std::shared_ptr<const Dataset> dataset_ = testing::sample_dataset();
  std::unique_ptr<DocumentWorker> worker_ = std::make_unique<DocumentWorker>();
};

TEST_F(DocumentWorkerTest, MakesADocumentOnceAndKeepsItForItsDataset) {
  auto first = order("a", "one");
  auto second = order("a", "another");
  opener_.set_value();
  EXPECT_EQ(text_of(std::move(first)), "one");
  EXPECT_EQ(text_of(std::move(second)), "one");
  EXPECT_EQ(made_, 1);
  ASSERT_NE(worker_->find(dataset_, "a"), nullptr);
  EXPECT_EQ(worker_->find(dataset_, "a")->bytes, "one");
  EXPECT_EQ(worker_->find(dataset_, "b"), nullptr);
  EXPECT_EQ(worker_->find(testing::sample_dataset(), "a"), nullptr);
}

TEST_F(DocumentWorkerTest, TurnsAwayWhatWouldWaitTooLong) {
  std::vector<std::future<DocumentWorker::Answer>> answers;
  answers.push_back(order("first", ""));
  while (made_ == 0) std::this_thread::yield();
  for (std::size_t i = 0; i < DocumentWorker::kMostWaiting; ++i) {
    answers.push_back(order(std::to_string(i), ""));
  }
  EXPECT_THAT(text_of(order("one more", "")), ::testing::HasSubstr("more documents"));
  opener_.set_value();
  for (auto& answer : answers) EXPECT_TRUE(answer.get());
}

TEST_F(DocumentWorkerTest, AFailureIsAnswered) {
  auto failing =
      submit("a", []() -> Result<Document> { throw std::runtime_error("there is no ink"); });
  EXPECT_EQ(failing.get().problem().status, 500);
  opener_.set_value();
  EXPECT_EQ(text_of(order("a", "now")), "now");
}

TEST_F(DocumentWorkerTest, OutlivesACallbackThatFails) {
  opener_.set_value();
  worker_->submit(
      dataset_, "a",
      []() -> Result<Document> {
        return Document{"text/plain", "one"};
      },
      [](const DocumentWorker::Answer&) { throw std::bad_alloc(); });
  EXPECT_EQ(text_of(order("b", "two")), "two");
}

TEST_F(DocumentWorkerTest, EndingAnswersWhatWaits) {
  auto first = order("first", "one");
  while (made_ == 0) std::this_thread::yield();
  auto waiting = order("second", "two");
  std::thread ending([worker = std::move(worker_)]() mutable { worker.reset(); });
  opener_.set_value();
  ending.join();
  EXPECT_EQ(text_of(std::move(first)), "one");
  EXPECT_THAT(text_of(std::move(waiting)),
              ::testing::AnyOf("two", ::testing::HasSubstr("more documents")));
}

}  // namespace
}  // namespace trapeze
