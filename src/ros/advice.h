#pragma once

#include <map>
#include <string>

namespace tccm {

/// The text of docs/failures.md, generated.
[[nodiscard]] const char* failuresPage();

/// What to do about a reason, as docs/failures.md has it.
class Advice {
 public:
  Advice() = default;
  /// @param page the text of docs/failures.md.
  explicit Advice(const std::string& page);

  /// Of the page as it was when this was built.
  [[nodiscard]] static Advice ofThePage();

  /// Empty where the page has nothing of it. @param level as it is called there, such as STOP.
  [[nodiscard]] std::string about(const std::string& reason, const std::string& level) const;

 private:
  std::map<std::string, std::string> by_reason_;  ///< by reason and level
};

}  // namespace tccm
