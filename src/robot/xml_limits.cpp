#include "xml_limits.h"

#include <cctype>
#include <cstddef>

namespace tccm {
namespace {

constexpr std::size_t kSizeMax = 32U << 20U;  // bytes; a URDF has some hundred thousand
constexpr std::size_t kDepthMax = 100;        // elements within elements; a URDF has ten
constexpr std::size_t kTagMax = 64U << 10U;   // bytes of one tag with its attributes

/// Walks over the tags of an XML text, as leniently as the parser does.
class TagScanner {
 public:
  explicit TagScanner(const std::string& text) : text_(text) {}

  [[nodiscard]] std::string defect() {
    std::size_t depth = 0;
    for (at_ = text_.find('<'); at_ != std::string::npos; at_ = text_.find('<', at_)) {
      if (skipIf("<!--", "-->") || skipIf("<![CDATA[", "]]>")) continue;
      const char next = at_ + 1 < text_.size() ? text_[at_ + 1] : '\0';
      if (next == '/') {
        if (depth > 0) --depth;
        ++at_;
      } else if (std::isalpha(static_cast<unsigned char>(next)) != 0 || next == '_' ||
                 static_cast<unsigned char>(next) >= 127) {
        const std::size_t begin = at_;
        if (!skipTag()) ++depth;
        if (at_ - begin > kTagMax) return "a tag of it is longer than 64 kB";
        if (depth > kDepthMax) return "its elements are nested more than 100 deep";
      } else {
        ++at_;
      }
    }
    return {};
  }

 private:
  /// Moves behind `end` where the text goes on with `begin`.
  bool skipIf(const char* begin, const char* end) {
    if (text_.compare(at_, std::char_traits<char>::length(begin), begin) != 0) return false;
    const std::size_t found = text_.find(end, at_);
    at_ = found == std::string::npos ? text_.size() : found;
    return true;
  }
  /// Moves behind the tag. @return whether it closes itself.
  bool skipTag() {
    char quote = '\0';
    for (++at_; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (quote != '\0') {
        if (c == quote) quote = '\0';
      } else if (c == '"' || c == '\'') {
        quote = c;
      } else if (c == '>') {
        return text_[at_++ - 1] == '/';
      }
    }
    return false;
  }

  const std::string& text_;
  std::size_t at_ = 0;
};

}  // namespace

std::string xmlDefect(const std::string& text) {
  if (text.size() > kSizeMax) return "it is larger than 32 MB";
  return TagScanner(text).defect();
}

}  // namespace tccm
