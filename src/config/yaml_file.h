#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

namespace tccm {

/// Reads a file that says one thing, whoever reads it. A key given twice, a merge key, a tab or a
/// second document is taken by some readers in one way, by others in another, without a word:
/// roslaunch takes the last of two keys, yaml-cpp the first.
/// @throws ConfigError naming path and line, also for NaN and infinity, and where it is no YAML.
[[nodiscard]] YAML::Node loadYamlFile(const std::string& path);

/// The same of a text. @param name stands for it in errors. @throws ConfigError
void requireUnambiguous(const std::string& text, const std::string& name);

/// Older versions of yaml-cpp overflow the stack on deep nesting: such a text is to be refused
/// beforehand.
[[nodiscard]] bool isNestedDeeply(const std::string& text);

/// "line 3: ", for errors; empty of what stands in no text, such as parameters of the server.
[[nodiscard]] std::string lineText(const YAML::Node& node);

}  // namespace tccm
