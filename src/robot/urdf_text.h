#pragma once

#include <map>
#include <string>

namespace tccm {

/// A robot description that holds no surprise for the parsers behind urdfdom.
struct CheckedUrdf {
  /// The robot written anew, so that these find in it what was checked: they read beyond a text
  /// that ends within a character, and take many things for tags.
  std::string xml;
  /// By link why not all of its visual elements would be taken; links of which all would be are
  /// left out.
  std::map<std::string, std::string> visual_defects;
};

/// @throws ConfigError in one line, naming the line where there is one: where the text is no XML,
/// or larger than any robot, its joints form no tree, or a link or collision element of it would be
/// passed over.
[[nodiscard]] CheckedUrdf checkedUrdf(const std::string& text);

}  // namespace tccm
