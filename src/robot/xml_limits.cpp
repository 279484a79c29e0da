#include "robot/xml_limits.h"

#include <algorithm>
#include <cctype>
#include <cstddef>

namespace tccm {
namespace {

constexpr std::size_t kSizeMax = 32U << 20U;  // bytes; a URDF has some hundred thousand
constexpr std::size_t kDepthMax = 100;        // elements within elements; a URDF has ten
constexpr std::size_t kTagMax = 64U << 10U;   // bytes of one tag with its attributes
constexpr std::size_t kAttributesMax = 100;   // of one element; a URDF has six
constexpr std::size_t kPartsMax = 10'000;     // links and joints; a URDF has a hundred
constexpr std::size_t kNone = std::string::npos;

unsigned char byteAt(const std::string& text, std::size_t at) {
  return at < text.size() ? static_cast<unsigned char>(text[at]) : 0;
}

/// How many bytes the character has that begins there; 0 where it is none of UTF-8.
std::size_t characterLength(const std::string& text, std::size_t at) {
  const unsigned char lead = byteAt(text, at);
  if (lead < 0x80U) return 1;
  const std::size_t length = lead < 0xc2U ? 0 : lead < 0xe0U ? 2 : lead < 0xf0U ? 3 : 4;
  if (lead > 0xf4U) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byteAt(text, at + i) & 0xc0U) != 0x80U) return 0;
  }
  return length;
}

bool isOfName(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte >= 0x7fU || std::isalnum(byte) != 0 || std::string("_-.:").find(c) != kNone;
}

/// Walks over the tags of an XML text and refuses what the parser would take apart in another way.
class TagScanner {
 public:
  explicit TagScanner(const std::string& text) : text_(text) {}

  [[nodiscard]] std::string defect() {
    while (at_ < text_.size() && defect_.empty()) {
      begin_ = at_;
      if (!startsWith("<")) {
        skipCharacter();
      } else if (startsWith("<!--")) {
        skipBeyond(4, "-->", "a comment");
      } else if (startsWith("<![CDATA[")) {
        skipBeyond(9, "]]>", "a CDATA section");
      } else {
        skipMarkup();
      }
    }
    return defect_.empty() ? "" : "line " + std::to_string(line()) + ": " + defect_;
  }

 private:
  [[nodiscard]] bool startsWith(const char* begin) const {
    return text_.compare(at_, std::char_traits<char>::length(begin), begin) == 0;
  }
  [[nodiscard]] std::ptrdiff_t line() const {
    return 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(begin_), '\n');
  }

  /// Of what is no whole character the parser reads beyond the end.
  void skipCharacter() {
    const std::size_t length = characterLength(text_, at_);
    if (length == 0 || text_[at_] == '\0') defect_ = "a byte of it is no text in UTF-8";
    at_ += length;
  }
  void skipBeyond(std::size_t begin, const char* end, const std::string& what) {
    const std::size_t found = text_.find(end, at_ + begin);
    if (found == kNone) {
      defect_ = what + " has no end";
    } else {
      at_ = found + std::char_traits<char>::length(end);
    }
  }

  void skipMarkup() {
    const unsigned char next = byteAt(text_, at_ + 1);
    if (next >= 0x7fU) {
      defect_ = "a tag's name does not begin with a letter";
    } else if (std::isalpha(next) != 0 || next == '_') {
      skipElement();
    } else if (next == '?') {
      skipDeclaration();
    } else {
      if (next == '/' && depth_ > 0) --depth_;
      skipBeyond(1, ">", "a tag");
    }
  }

  /// Its end is where quotes say, if the parser finds the same quotes: those behind an = only.
  void skipDeclaration() {
    const Tag tag = skipTag();
    const std::size_t end = text_.find('>', begin_);
    if (defect_.empty() && (at_ != end + 1 || tag.quoted_equal_signs > 0)) {
      defect_ = "its declaration is not valid";
    }
  }

  void skipElement() {
    const Tag tag = skipTag();
    if (!tag.closes_itself) ++depth_;
    const std::string text = text_.substr(begin_, std::min(at_ - begin_, kTagMax));
    const std::string name(text.begin() + 1,
                           std::find_if_not(text.begin() + 1, text.end(), isOfName));
    if (name == "link" || name == "joint") ++parts_;
    if (at_ - begin_ > kTagMax) defect_ = "a tag of it is longer than 64 kB";
    if (depth_ > kDepthMax) defect_ = "its elements are nested more than 100 deep";
    if (parts_ > kPartsMax) defect_ = "it has more than 10000 links and joints";
    if (!defect_.empty()) return;
    const std::string owner = "the element <" + name.substr(0, 100) + "> ";
    if (tag.equal_signs > kAttributesMax) defect_ = owner + "has more than 100 attributes";
    // What an attribute says is a format string for the parser where it is wrong.
    const bool names_file = name == "mesh" || name == "texture";
    if (!names_file && (text.find('%') != kNone || text.find("&#") != kNone)) {
      defect_ = owner + "has a percent sign or a character reference in an attribute";
    }
  }

  struct Tag {
    bool closes_itself = false;
    std::size_t equal_signs = 0;  ///< outside quotes: each attribute has one
    std::size_t quoted_equal_signs = 0;
  };
  /// Moves behind the tag's end outside quotes.
  Tag skipTag() {
    Tag tag;
    char quote = '\0';
    while (at_ < text_.size() && defect_.empty()) {
      const char c = text_[at_];
      skipCharacter();
      if (c == '=') ++(quote == '\0' ? tag.equal_signs : tag.quoted_equal_signs);
      if (quote != '\0') {
        if (c == quote) quote = '\0';
      } else if (c == '"' || c == '\'') {
        quote = c;
      } else if (c == '>') {
        tag.closes_itself = text_[at_ - 2] == '/';
        return tag;
      }
    }
    if (defect_.empty()) defect_ = "a tag has no end";
    return tag;
  }

  const std::string& text_;
  std::size_t begin_ = 0;  ///< of what is looked at
  std::size_t at_ = 0;
  std::size_t depth_ = 0;
  std::size_t parts_ = 0;
  std::string defect_;
};

}  // namespace

std::string xmlDefect(const std::string& text) {
  if (text.size() > kSizeMax) return "it is larger than 32 MB";
  return TagScanner(text).defect();
}

}  // namespace tccm
