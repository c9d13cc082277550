#include "core/io/source/source_selection.h"

#include <utility>

namespace trapeze {
namespace {

std::string problems_in_words(const std::string& source,
                              const std::vector<SelectionProblem>& problems) {
  std::string words = source + ": ";
  for (const SelectionProblem& problem : problems) {
    if (&problem != &problems.front()) words += "; ";
    words += problem.what;
  }
  return words;
}

}  // namespace

SelectionError::SelectionError(const std::string& source, std::vector<SelectionProblem> problems)
    : std::runtime_error(problems_in_words(source, problems)), problems_(std::move(problems)) {}

}  // namespace trapeze
