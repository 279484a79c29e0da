#include "config_draft.h"

#include <algorithm>

#include "tools/program.h"

namespace tccm {
std::vector<std::string> partsOf(const std::string& path) {
  std::vector<std::string> parts;
  std::string part;
  for (const char c : path + "/") {
    if (c != '/') {
      part += c;
    } else if (!part.empty()) {
      parts.push_back(std::move(part));
      part.clear();
    }
  }
  return parts;
}

ConfigDraft::Section& ConfigDraft::section(const std::string& name) {
  auto found = std::lower_bound(
      sections_.begin(), sections_.end(), name,
      [](const Section& section, const std::string& other) { return section.name < other; });
  if (found == sections_.end() || found->name != name) found = sections_.insert(found, {name, {}});
  return *found;
}

void ConfigDraft::set(const std::string& section_name, const std::string& key,
                      const std::string& value, const std::string& why) {
  std::vector<Entry>& entries = section(section_name).entries;
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&key](const Entry& entry) { return entry.key == key; });
  if (found == entries.end()) {
    entries.push_back({key, value, why});
  } else {
    *found = {key, value, why};
  }
}

void ConfigDraft::set(const std::string& section_name, const std::string& key, double value,
                      const std::string& why) {
  set(section_name, key, formatted("%.6g", value), why);
}

void ConfigDraft::remove(const std::string& section_name, const std::string& key) {
  std::vector<Entry>& entries = section(section_name).entries;
  entries.erase(std::remove_if(entries.begin(), entries.end(),
                               [&key](const Entry& entry) { return entry.key == key; }),
                entries.end());
}

std::string ConfigDraft::yaml() const {
  std::string text;
  for (const std::string& remark : remarks_) text += "# " + remark + "\n";
  std::vector<std::string> open;
  for (const Section& section : sections_) {
    if (section.entries.empty()) continue;
    const std::vector<std::string> parts = partsOf(section.name);
    const auto [of_open, of_parts] =
        std::mismatch(open.begin(), open.end(), parts.begin(), parts.end());
    auto depth = static_cast<std::size_t>(of_parts - parts.begin());
    for (; depth < parts.size(); ++depth) {
      if (depth == 0) text += "\n";
      text += std::string(2 * depth, ' ') + parts[depth] + ":\n";
    }
    open = parts;
    for (const Entry& entry : section.entries) {
      text += std::string(2 * parts.size(), ' ') + entry.key + ": " + entry.value;
      text += entry.why.empty() ? "\n" : "  # " + entry.why + "\n";
    }
  }
  return text;
}

std::string yamlList(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return "[" + list + "]";
}

}  // namespace tccm
